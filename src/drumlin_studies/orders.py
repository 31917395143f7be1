"""Observed orders of convergence, error estimates against true errors, and the limit of a rigid
shoe.
"""

import math
import time
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.comparison import Convergence
from drumlin.fem.error_control.levels import LEVELS
from drumlin.fem.error_control.places import places_of
from drumlin.fem.hp.division import Level
from drumlin.fem.model import respond
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.solve import solve
from drumlin.laws import sine
from drumlin.response.norms import pressure_distance, relative
from drumlin.response.response import Response, ShoeResponse
from drumlin.verification.reference import Refinement, responses

RIGID_CHANGES = {
    "shoe.body.material.E": 2.1e15,
    "shoe.lining.thickness": 3e-3,
}  # E x 10^4 of steel, lining of R/50
Row = dict[str, Any]


def distance(response: Response, reference: Response) -> float:
    """The largest of the shoes' relative L2 distances of p, outside the edge zones."""
    return max(
        pressure_distance(a, b) for a, b in zip(response.shoes, reference.shoes, strict=True)
    )


def order_rows(
    brake: Brake, case: str, kind: str, sizes: Sequence[int], reference: Response
) -> list[Row]:
    """Errors on meshes that double, with the observed orders between each and the one before; exact
    contact.
    """
    rows: list[Row] = []
    for n in sizes:
        response = solve(brake, elements=n, kind=kind, penalty=math.inf)
        row = {
            "case": case,
            "kind": kind,
            "elements": n,
            "pressure": distance(response, reference),
            "torque": abs(relative(response.torque, reference.torque)),
            "steps": response.iterations,
        }
        if rows:
            row["order"] = math.log(rows[-1]["pressure"] / row["pressure"]) / math.log(
                n / rows[-1]["elements"]
            )
        rows.append(row)
    return rows


COARSE_LEVEL = Level(2, 0.9, 0.3, 0.4, 0.15, 0.15, math.radians(30), 1.0, 1.0, 0.1)
"""Columns so coarse that they are off by some per cent: where the row of levels begins."""


LEVEL_REFERENCE = Refinement(
    3,
    (
        Level(8, 0.002, 0.0015, 3e-4, 0.5, 0.5, math.radians(12), 0.003, 0.0015, 0.4),
        Level(9, 0.001, 7e-4, 1e-4, 0.5, 0.5, math.radians(12), 0.0015, 7e-4, 0.4),
    ),
    (),
)
"""Columns against which the errors of the first four levels are known to within a half."""


def level_rows(brake: Brake, refinement: Refinement = LEVEL_REFERENCE) -> list[Row]:
    """Errors of columns, level by level, their ends of the contact known from the reference; exact
    contact.

    `root`: the cube root of the unknowns of a shoe, over which the logarithm of the error falls
    straight where every singular point is graded (Babuska & Guo 1986). Nothing is shown below twice
    the distance of the two divisions of the reference, of which the finer one counts: there an
    error is known to within a half.
    """
    found = responses(brake, refinement)
    true, places = found.value, places_of(brake, found.value)
    floor = 2 * distance(found.before, true)
    rows = []
    for level in (COARSE_LEVEL, *LEVELS):
        made = prepare(brake, level, places)
        response = respond(made, brake, penalty=math.inf, start=true)
        unknowns = max(body.unknowns for body in made.bodies)
        error = distance(response, true)
        torque = abs(relative(response.torque, true.torque))
        if error < floor:
            break
        rows.append(
            {
                "degree": level.degree,
                "unknowns": unknowns,
                "root": unknowns ** (1 / 3),
                "pressure": error,
                "torque": torque,
            }
        )
    return rows


class FittedLine(NamedTuple):
    """log10 of the error = a - fall (unknowns)^(1/3), fitted, its correlation, and the `decades`
    that it spans.
    """

    fall: float
    correlation: float
    decades: float


def line(rows: Sequence[Row]) -> FittedLine:
    """The straight line of `level_rows`."""
    x, y = (
        np.array(values)
        for values in zip(
            *((row["root"], math.log10(row["pressure"])) for row in rows), strict=True
        )
    )
    return FittedLine(
        -float(np.polyfit(x, y, 1)[0]), -float(np.corrcoef(x, y)[0, 1]), float(np.ptp(y))
    )


def estimate_row(
    brake: Brake, case: str, tolerance: float, reference: Response, floor: float
) -> Row:
    """What was asked for, what was estimated, what is true as far as the reference knows, and the
    time of it.
    """
    start = time.perf_counter()
    row: Row = {"case": case, "tolerance": tolerance}
    try:
        response = solve(brake, tolerance=tolerance, penalty=math.inf)
    except NoAnswer as error:
        return {**row, "seconds": time.perf_counter() - start, "status": f"failed: {error}"}
    seconds = time.perf_counter() - start
    assert response.error is not None  # a tolerance was asked for
    true = distance(response, reference)
    return {
        **row,
        "estimate": response.error["pressure"],
        "true": true,
        "ratio": response.error["pressure"] / true,
        "torque_estimate": response.error["torque"],
        "torque_true": abs(relative(response.torque, reference.torque)),
        "seconds": seconds,
        "status": "converged"
        if true > floor
        else "converged; truth below what the reference knows",
    }


def convergence_rows(convergence: Convergence) -> list[Row]:
    """Meshes that double: torque [N m] and its distance from the limit, and for each shoe, by its
    place in the brake, the step of p to the next finer mesh; relative.
    """
    limit = convergence.torque.value
    steps = [convergence.pressure_steps(i) for i in range(len(convergence.responses[0].shoes))]
    names = [shoe.name for shoe in convergence.responses[0].shoes]
    return [
        {
            "elements": n,
            "unknowns_torque": response.torque,
            "torque_error": relative(response.torque, limit),
            **{name: of[k] if k < len(of) else None for name, of in zip(names, steps, strict=True)},
            "steps": response.iterations,
        }
        for k, (n, response) in enumerate(
            zip(convergence.elements, convergence.responses, strict=True)
        )
    ]


def rigid_limit(brake: Brake, elements: int) -> list[Row]:
    """Sine law against finite elements with a nearly rigid shoe and a thin lining: torque, and p /
    sin(phi).
    """
    rigid = vary(brake, RIGID_CHANGES)
    law, fem = sine(rigid), solve(rigid, elements=elements)
    rows: list[Row] = []
    for spec, a, b in zip(rigid.shoes, law.shoes, fem.shoes, strict=True):
        edge = 5 * spec.lining.thickness / rigid.size
        ratio = amplitude(spec.frame.phi(b.theta), b, edge)
        rows.append(
            {
                "rotation": brake.direction,
                "shoe": spec.name,
                "law": a.torque,
                "fem": b.torque,
                "difference": relative(b.torque, a.torque),
                "spread": float(np.ptp(ratio) / np.mean(ratio)),
            }
        )
    rows.append(
        {
            "rotation": brake.direction,
            "shoe": "all",
            "law": law.torque,
            "fem": fem.torque,
            "difference": relative(fem.torque, law.torque),
        }
    )
    return rows


def amplitude(phi: Floats, shoe: ShoeResponse, edge: float) -> Floats:
    """p / sin(phi) at the nodes farther than `edge` [rad] from the ends."""
    inside = (phi > phi.min() + edge) & (phi < phi.max() - edge)
    return np.asarray(shoe.pressure[inside] / np.sin(phi[inside]))


def largest_residual(responses: Sequence[Response]) -> float:
    """The largest relative force or moment residual of some responses; those without one are passed
    over.
    """
    return max(
        max(r.balance.force, r.balance.moment) for r in responses if not math.isnan(r.balance.force)
    )
