"""Brakes of every kind by finite elements and by their rigid-shoe law, new and worn in, in both senses of motion."""

import math
from typing import Any, NamedTuple

import numpy as np

from drumlin.brake.file import vary
from drumlin.brake.plane_brake import AnyBrake, FlatBrake
from drumlin.brake.unrolled import on_drum
from drumlin.comparison import edge_of, motion_of
from drumlin.errors import NoAnswer
from drumlin.fem.assembly import prepare
from drumlin.fem.self_locking import limits
from drumlin.fem.solve import solve
from drumlin.laws import law
from drumlin.response.balance import loaded
from drumlin.response.merit import effect
from drumlin.response.norms import pressure_distance, relative
from drumlin.response.response import Response
from drumlin.wear import worn_in

TRUSTED, ROUGH = 0.05, 0.15  # relative errors of the effect up to which a law is trusted, and is an estimate


class Case(NamedTuple):
    """A brake in one sense of motion: by its law, new, and worn in."""

    file: str
    brake: AnyBrake
    law: Response
    new: Response
    worn: Response


def both_ways(brake: AnyBrake) -> tuple[AnyBrake, AnyBrake]:
    """The brake as its file says, and with the drum or the body moving the other way."""
    if isinstance(brake, FlatBrake):
        return brake, vary(brake, {"plane.sliding": "-x" if brake.spin > 0 else "+x"})
    return brake, vary(brake, {"rotation": "clockwise" if brake.spin > 0 else "counter-clockwise"})


def case(file: str, brake: AnyBrake, elements: int) -> Case:
    """A brake by law and finite elements; elements: along the worn-in linings. Raises NoAnswer."""
    return Case(file, brake, law(brake), solve(brake), worn_in.solve(brake, elements=elements))


def mu_lock(brake: AnyBrake, most: float = 2.0, elements: int = 20) -> float:
    """The friction [1] up to which the elastic brake has an answer; inf where there is one up to `most`."""
    own = on_drum(brake)
    try:
        found = limits(prepare(own, elements=elements), own, most, penalty=1e6)
    except NoAnswer:
        return math.nan
    return min((end.friction for end in found.values()), default=math.inf)


def row_of(found: Case, limit: float | None) -> dict[str, Any]:
    """One row of the table of brakes; `factor`: effect over the sum of the actuation forces, times the radius."""
    brake, new = found.brake, found.new
    under = loaded(brake, new)
    actuated = math.fsum(
        abs(shoe.actuation.force) for shoe in under.shoes if shoe.name not in {link.to for link in brake.links}
    )
    radius = 1.0 if isinstance(brake, FlatBrake) else brake.drum.radius
    size = effect(new)
    worst = max(
        pressure_distance(a, b, edge_of(brake))
        for a, b in zip(found.law.shoes, new.shoes, strict=True)
        if b.contact_arcs
    )
    return {
        "file": found.file,
        "motion": motion_of(brake),
        "law": found.law.model,
        "effect": size,
        "unit": "N" if isinstance(brake, FlatBrake) else "N m",
        "factor": size / (radius * actuated),
        "peak": max(shoe.peak_pressure for shoe in new.shoes),
        "reaction": max(float(np.linalg.norm(shoe.hinge_reaction)) for shoe in new.shoes),
        "mu_lock": limit,
        "new": relative(effect(found.law), size),
        "worn": relative(effect(found.law), effect(found.worn)),
        "pressure": worst,
        "balance": max(new.balance.force, new.balance.moment),
    }


def verdict(rows: list[dict[str, Any]]) -> str:
    """Whether the law of a brake can be trusted, from its rows of both senses of motion."""

    def said(key: str) -> str:
        error = max(abs(row[key]) for row in rows)
        word = "can be trusted" if error <= TRUSTED else "is an estimate" if error <= ROUGH else "cannot be trusted"
        return f"{word} (off by up to {100 * error:.2g} %)"

    (first, *_) = rows
    effect_ = "braking force" if first["unit"] == "N" else "torque"
    return f"New, the law {first['law']!r} of the {effect_} {said('new')}; worn in it {said('worn')}."
