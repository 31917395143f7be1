"""Table rows on worked examples: a number from a source beside the number that a law computes."""

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.brake.plane_brake import read_drum_or_plane_brake
from drumlin.brake.units import quantity_in_si
from drumlin.laws import self_locking_friction_of_hinged_shoe
from drumlin.laws.shapes import ratio_of_equivalent_to_lining_friction
from drumlin.laws.simscape import DoubleShoe
from drumlin.models import MODELS
from drumlin.response.merit import brake_scaled_to_peak_pressure
from drumlin.response.response import Response

PrintedNumberRow = dict[str, Any]
"""A row of a table: its values by the names of the columns."""


def _lowest_locking_friction_of_shoes(brake: Brake) -> float:
    """The lowest friction coefficient at which any shoe locks itself by the sine law."""
    return min(self_locking_friction_of_hinged_shoe(brake, shoe) for shoe in brake.shoes)


def _size_of_pivot_reaction_component_of_first_shoe(response: Response, axis: int) -> float:
    """The absolute value of a component of the first shoe's pivot reaction [N].

    `axis` is 0 for the component along x and 1 for the component along y. The result is nan for a
    shoe without a pivot.
    """
    reaction = response.shoes[0].pivot_reaction
    return math.nan if reaction is None else abs(float(reaction[axis]))


FUNCTIONS_OF_PRINTED_QUANTITIES_BY_NAME: dict[str, Callable[[Brake, Response], float]] = {
    "force [N]": lambda b, r: b.shoes[0].actuation.force,
    "torque [N m]": lambda b, r: r.torque,
    "torque [N mm]": lambda b, r: r.torque * 1e3,
    "torque, helped shoe [N m]": lambda b, r: r.shoes[0].torque,
    "torque, opposed shoe [N m]": lambda b, r: r.shoes[1].torque,
    "peak pressure, helped shoe [kPa]": lambda b, r: r.shoes[0].peak_pressure * 1e-3,
    "peak pressure, opposed shoe [kPa]": lambda b, r: r.shoes[1].peak_pressure * 1e-3,
    "hinge reaction, helped shoe [N]": lambda b, r: float(
        np.linalg.norm(r.shoes[0].hinge_reaction)
    ),
    "hinge reaction, opposed shoe [N]": lambda b, r: float(
        np.linalg.norm(r.shoes[1].hinge_reaction)
    ),
    "normal force [N]": lambda b, r: r.shoes[0].normal_force,
    "pivot reaction, along [N]": lambda b, r: _size_of_pivot_reaction_component_of_first_shoe(r, 0),
    "pivot reaction, across [N]": lambda b, r: _size_of_pivot_reaction_component_of_first_shoe(
        r, 1
    ),
    "force [kN]": lambda b, r: b.shoes[0].actuation.force * 1e-3,
    "mu_lock": lambda b, r: _lowest_locking_friction_of_shoes(b),
}
"""Functions of (brake, response) that compute the quantities that sources print, by name."""


def rows_of_printed_and_computed_numbers(
    example: Mapping[str, Any], folder: Path
) -> list[PrintedNumberRow]:
    """Solve a worked example by a law, and make a row for each of its printed numbers.

    Parameters
    ----------
    example : mapping
        `law`: name of the law; `file`: brake file in the folder; `changes` (optional): values that
        replace values of the file; `peak` (optional): peak pressure to which the actuation force is
        scaled; `given`: printed numbers as text, by the names in
        FUNCTIONS_OF_PRINTED_QUANTITIES_BY_NAME; `source`, `origin`, `remark` (optional): texts for
        the rows.
    folder : Path
        Folder of the brake files.
    """
    law, source = example["law"], example["source"]
    solve = MODELS[law].solve
    brake = vary(read_drum_or_plane_brake(folder / example["file"]), example.get("changes", {}))
    if "peak" in example:
        brake = brake_scaled_to_peak_pressure(
            brake, solve, quantity_in_si(example["peak"], "Pa", unit_required=True)
        )
    response = solve(brake)
    origin, remark = example["origin"], example.get("remark", "")
    rows = []
    for quantity, text in example["given"].items():
        value = FUNCTIONS_OF_PRINTED_QUANTITIES_BY_NAME[quantity](brake, response)
        rows.append(
            row_of_printed_and_computed_number(law, source, quantity, text, value, origin, remark)
        )
    return rows


def row_of_printed_and_computed_number(
    law: str,
    source: str,
    quantity: str,
    given: str,
    value: float,
    origin: str = "formula",
    remark: str = "",
) -> PrintedNumberRow:
    """The row of a printed number beside a computed value.

    The `status` is "agrees" if they differ by at most half a unit of the last printed digit.

    Parameters
    ----------
    law, source, quantity : str
        Name of the law, of the source and of the quantity.
    given : str
        The number as it is printed.
    value : float
        The computed value.
    origin : str
        Whether the source prints the number ("printed") or a formula for it ("formula").
    remark : str
        Text for the `status` of a row that does not agree; by default "differs".
    """
    # Half a unit of the last printed digit, with a margin for binary round-off.
    decimals = len(given.partition(".")[2])
    agrees = abs(value - float(given)) <= 0.5 * 10.0**-decimals * (1 + 1e-6)
    return {
        "law": law,
        "source": source,
        "quantity": quantity,
        "origin": origin,
        "given": given,
        "computed": f"{value:.{decimals + 2}f}",
        "difference": value / float(given) - 1,
        "status": "agrees" if agrees else remark or "differs",
    }


def rows_of_simscape_double_shoe_brake() -> list[PrintedNumberRow]:
    """Rows on Simscape's Double-Shoe Brake block, with its default parameters and a force of 1 N.

    The angle theta_s in the manual of Simscape may mean the end angle or the span of the lining.
    The rows cover both meanings.
    """
    rows = []
    for reading, torque, mu_lock in (
        ("end", "0.2176081", "0.823082"),
        ("span", "0.2211397", "0.794253"),
    ):
        block = DoubleShoe(reading="end" if reading == "end" else "span")
        source = f"Simscape defaults, theta_s as {reading}"
        leading, trailing = (float(T) for T in block.torques_of_leading_and_trailing_shoe(1.0, 1.0))
        p_a, p_b = block.peak_line_loads_of_leading_and_trailing_shoe(1.0, 1.0)
        # The torques of single shoes and the ratio of pressures are compared only if theta_s means
        # the end angle of the lining.
        if reading == "end":
            rows.append(
                row_of_printed_and_computed_number(
                    "sine", source, "T/F, leading shoe [m]", "0.1484614", leading
                )
            )
            rows.append(
                row_of_printed_and_computed_number(
                    "sine", source, "T/F, trailing shoe [m]", "0.0691468", trailing
                )
            )
            rows.append(
                row_of_printed_and_computed_number(
                    "sine", source, "p_b/p_a", "0.465756", float(p_b / p_a)
                )
            )
        rows.append(
            row_of_printed_and_computed_number(
                "sine", source, "T/F [m]", torque, leading + trailing
            )
        )
        rows.append(
            row_of_printed_and_computed_number("sine", source, "mu_lock", mu_lock, block.mu_lock)
        )
    return rows


def rows_of_equivalent_block_friction() -> list[PrintedNumberRow]:
    """Rows on the ratio mu'/mu of equivalent to real friction of a block, for several half-arcs.

    A short block with the friction coefficient mu' has the same torque as the long block with the
    coefficient mu, under the same normal force.
    """
    printed = {15: "1.011408", 30: "1.045356", 45: "1.100214", 60: "1.170138", 90: "1.273240"}
    rows = []
    for angle, text in printed.items():
        value = float(ratio_of_equivalent_to_lining_friction(math.radians(angle)))
        rows.append(
            row_of_printed_and_computed_number(
                "block", "mu'/mu", f"half-arc {angle} deg", text, value
            )
        )
    return rows
