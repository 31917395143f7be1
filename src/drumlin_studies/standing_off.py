"""Random brakes whose linings stand off the drum by far more than their force compresses them.

The contact of such a brake is short, and it wanders along the lining as friction grows. The brakes
are those of `random_kinds` with a stiffer lining, a clearance and a smaller force.
"""

from typing import Any

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.plane_brake import any_from
from drumlin.laws import law
from drumlin_studies.random_kinds import ATTEMPTS, KINDS, Rng, facing, log_between, placed

STIFFNESS = 3e8, 1e11
"""Least and largest Young's modulus of the linings [Pa]."""
CLEARANCE = 1e-4, 1 / 300
"""Least and largest clearance, as a fraction of the drum's radius or of the length of a pad."""
CUT = 1.0, 300.0
"""Least and largest factor by which the force of a brake of `random_kinds` is divided."""


def standing_off(seed: int, kind: str | None = None) -> Brake:
    """The brake of a seed.

    kind: one of the kinds of `random_kinds`, by default the seed modulo their number. The
    rigid-shoe law has an answer in which all shoes press. Nothing is solved by finite elements, so
    some brakes may have no answer there.
    """
    names = list(KINDS)
    kind = names[seed % len(names)] if kind is None else kind
    for attempt in range(ATTEMPTS):
        rng = np.random.default_rng([seed, names.index(kind), attempt, 1])
        data = _off(rng, KINDS[kind](rng)) | {"title": f"standing off {kind} {seed}"}
        data["friction"] = round(float(rng.uniform(0.03, 0.5)), 4)
        turn, mirrored = float(rng.uniform(-3, 3)), bool(rng.random() < 0.5)
        try:
            brake = any_from(data)
            turn = 0.0 if brake.surface.straight else turn
            brake = placed(brake, turn=turn, mirrored=mirrored)
            if all(shoe.contact_arcs for shoe in law(brake).shoes):
                return brake
        except (BadInput, NoAnswer):
            continue
    raise NoAnswer(f"no brake of kind {kind} from seed {seed} in {ATTEMPTS} attempts")


def _off(rng: Rng, data: dict[str, Any]) -> dict[str, Any]:
    """The data of a brake with a clearance, other moduli of the linings and smaller forces.

    The shoes of a cam are mirror images: it moves both tips alike, and of shoes that stand off
    differently it would press one only.
    """
    cut = log_between(rng, *CUT)
    shoes = [_shoe_off(rng, shoe, data.get("drum"), cut) for shoe in data["shoe"]]
    found = data | {"shoe": shoes}
    if "actuation" in data:
        found["actuation"] = _cut(data["actuation"], cut)
        if "force" in data["actuation"]:
            found["shoe"] = [shoes[0], facing(shoes[0])]
    return found


def _shoe_off(
    rng: Rng, shoe: dict[str, Any], drum: dict[str, Any] | None, cut: float
) -> dict[str, Any]:
    lining = {key: value for key, value in shoe["lining"].items() if key != "misfit"}
    size = lining["end"] - lining["start"] if drum is None else drum["radius"]
    lining["clearance"] = size * log_between(rng, *CLEARANCE)
    lining["material"] = lining["material"] | {"E": log_between(rng, *STIFFNESS)}
    found = shoe | {"lining": lining}
    if "actuation" in shoe:
        found["actuation"] = _cut(shoe["actuation"], cut)
    return found


def _cut(actuation: dict[str, Any], cut: float) -> dict[str, Any]:
    """An actuation whose force or pressure is divided by a factor."""
    return {
        key: value / cut if key in {"force", "pressure"} else value
        for key, value in actuation.items()
    }
