"""The tables on self-locking of elastic brakes: limits, torques, random brakes and slopes."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.journal import JournalOfCaseResults
from drumlin.brake.file import read_brake, vary
from drumlin.fem.model import DEFAULT_PENALTY_FACTOR
from drumlin_studies.self_locking import (
    row_of_self_locking_friction,
    row_of_torque_curves_by_friction,
    row_on_uniqueness_of_contact_solutions,
    rows_of_torque_slopes_and_differences,
)
from drumlin_studies.tables import rows_with_given_values

FILE = Path(__file__).parents[1] / "double_shoe" / "brake.toml"
THICKNESSES = (8e-3, 3e-3, 1e-3)
"""Thicknesses of the lining over which limits are computed [m]."""
RING = {"thickness": 0.015, "width": 0.04, "material": {"E": 120e9, "nu": 0.25}, "support": "free"}
WAYS = ("locking", "opposed")
SLOPES: dict[str, tuple[dict[str, Any], float]] = {
    "stiff shoes": ({}, DEFAULT_PENALTY_FACTOR),
    "clockwise": ({"rotation": "clockwise"}, DEFAULT_PENALTY_FACTOR),
    "with a free ring": ({"drum.ring": RING}, DEFAULT_PENALTY_FACTOR),
    "clearance, soft contact": ({"shoe.lining.clearance": 1e-5}, 100.0),
    "friction 0.6": ({"friction": 0.6}, DEFAULT_PENALTY_FACTOR),
}
"""Changes of the brake and penalty factor of each table of slopes, by name."""

Row = dict[str, Any]


class Result(NamedTuple):
    """Rows of all tables.

    Attributes
    ----------
    shoe, ring : list of dict
        Limits over the stiffness of the shoe and of the ring.
    rigid, mesh : list of dict
        Limits of a rigid shoe over the thickness of its lining, and over the mesh.
    torque : list of dict
        Torque over friction.
    unique : list of dict
        Uniqueness of the answers of random brakes.
    slopes : list of dict
        Slopes against differences.
    """

    shoe: list[Row]
    ring: list[Row]
    rigid: list[Row]
    mesh: list[Row]
    torque: list[Row]
    unique: list[Row]
    slopes: list[Row]


def study(
    journal: JournalOfCaseResults,
    *,
    short: bool = False,
    say: Callable[[str], None] = lambda _: None,
) -> Result:
    """Compute all rows, each a case of the journal.

    short : whether fewer rows on coarser meshes are enough.
    """
    elements = 16 if short else 40
    brake, every = read_brake(FILE), 4 if short else 1

    def limit_row_of_case(**case: Any) -> Row:
        """The row of the limit of self-locking of a case; keys with a dot change the brake."""
        changes = {}
        # Names of keys of the brake file contain a dot; other words only name the case.
        for key, value in case.items():
            if "." in key:
                changes[key] = value
        return journal.get_or_compute_case_result(
            {"of": "limit", **case},
            lambda: (
                row_of_self_locking_friction(vary(brake, changes), case.get("n", elements)) | case
            ),
        )

    say("limits of self-locking")
    E = brake.shoes[0].body.material.E  # type: ignore[union-attr]
    shoe, ring = [], []
    for t in THICKNESSES:
        for k in np.arange(-3.0, 6.5, 0.5)[::every].tolist():
            changes = {"shoe.body.material.E": E * 10**k, "shoe.lining.thickness": t}
            shoe.append(limit_row_of_case(**changes, factor=10**k))
    for support in ("free", "fixed"):
        for k in np.arange(-4.0, 4.5, 0.5)[::every].tolist():
            changes = {
                "drum.ring": RING | {"support": support},
                "drum.ring.material.E": 120e9 * 10**k,
            }
            ring.append(limit_row_of_case(**changes, factor=10**k, support=support))
    rigid = [
        limit_row_of_case(
            **{"shoe.body": None, "shoe.lining.thickness": 8e-3 / 2**k, "n": 2 * elements}
        )
        for k in range(3 if short else 6)
    ]
    mesh = []
    for n in (10, 20, 40) if short else (20, 40, 80, 160):
        mesh.append(limit_row_of_case(**{"friction": 0.3, "n": n}))
    say("torque up to the limit")
    drums = {"rigid drum": brake, "with a free ring": vary(brake, {"drum.ring": RING})}
    torque = [
        journal.get_or_compute_case_result(
            {"of": "torque", "ring": name != "rigid drum", "n": elements},
            partial(row_of_torque_curves_by_friction, drum, name, elements),
        )
        for name, drum in drums.items()
    ]
    # Random brakes from many starts: one answer below the limit, none above it.
    say("uniqueness")
    unique = []
    for k in range(3 if short else 30):
        for way in WAYS:
            case = {"of": "unique", "seed": k, "way": way, "n": elements}
            unique.append(
                journal.get_or_compute_case_result(
                    case, partial(row_on_uniqueness_of_contact_solutions, k, way)
                )
            )
    say("sensitivities against differences")
    slopes = []
    for name, (changes, penalty) in list(SLOPES.items())[: 1 if short else None]:
        compute = partial(
            rows_of_torque_slopes_and_differences, vary(brake, changes), name, penalty
        )
        computed = partial(_rows_for_journal, compute)
        slopes += journal.get_or_compute_case_result({"of": "slopes", "name": name}, computed)[
            "rows"
        ]
    return Result(shoe, ring, rigid, mesh, torque, unique, slopes)


def _rows_for_journal(compute: Callable[[], list[Row]]) -> dict[str, list[Row]]:
    """Rows in the form that a journal keeps."""
    return {"rows": compute()}


def rows_by_thickness(rows: list[Row]) -> dict[float, list[Row]]:
    """The rows over the stiffness of the shoe, by the thickness of its lining [m]."""
    found: dict[float, list[Row]] = {}
    for t in THICKNESSES:
        found[t] = rows_with_given_values(rows, **{"shoe.lining.thickness": t})
    return found
