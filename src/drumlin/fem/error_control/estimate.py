"""How far the answer of a level is from the exact one, from how far the level moved it.

The a posteriori error estimate. Let e_k be the error of level k, relative, and d_k the distance of
its answer from that of the level before. If a level has at most 1/r of the error of the level
before, then d_k >= e_(k-1) - e_k >= (r - 1) e_k, so that

    e_k <= c d_k,   c = 1/(r - 1).

The factor c of each quantity comes from random brakes of every kind, see `FACTORS`. Two quantities
need more than their own distance, since the difference of two numbers may be small by accident:

- A force (torque, reaction) is an integral of p, in which what two levels differ by may cancel. So
  a fraction, `cancelled`, of what the force would move by is added, were the signs of the columns'
  contributions chance: of the root of the sum of their squares.
- The distance of two peaks is at least the geometric mean of the distance of p in the column of the
  peak and of its distance in L2.

To all are added the penalty error and the round-off error of the elimination, by
`ShoeResponse.softness` and `lost`.
"""

import json
import math
from collections.abc import Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake
from drumlin.response.norms import Difference
from drumlin.response.response import (
    Response,
    ShoeResponse,
    edge_zone,
    reaction_size,
    singular_zone,
)
from drumlin.response.resultants import edge_left_out

QUANTITIES = ("pressure", "torque", "peak", "reaction")
"""What has a stated error: p in L2 outside the zones at the lining's ends, torque, peak pressure,
reaction."""


class Factors(NamedTuple):
    """The numbers of the estimate.

    `pressure`, `force`, `peak`: error over the distance of the last two levels; `cancelled`:
    fraction of what chance signs of the columns would move a force by.
    """

    pressure: float
    force: float
    cancelled: float
    peak: float

    def of_distances(self, shoes: int) -> Floats:
        """The factor (1 + 4 shoes,) of each distance, in the order of `Distances`."""
        own = (self.pressure, self.force, self.peak, self.force)
        return np.array([self.force, *own * shoes])


def read_factors(path: Path) -> Factors:
    """The factors of a file that the calibration wrote."""
    data = json.loads(path.read_text(encoding="utf-8"))
    return Factors(**{name: data[name]["value"] for name in Factors._fields})


FACTORS = read_factors(Path(__file__).with_name("factors.json"))
"""The numbers of the estimate, fitted by `make calibrate`; the file says on what, and what each
does.
"""

SOFTER = 2.0
"""Factor on the penalty error. `softness` is of first order in 1/alpha, and what the penalty
changes is at most twice that while the lining penetrates less than it is compressed.
"""


class Errors(NamedTuple):
    """Relative errors of a brake and of each of its shoes, by the names of QUANTITIES.

    `brake` has the error of the brake's torque, and of each other quantity that of the worst shoe.
    """

    brake: Mapping[str, float]
    shoes: tuple[Mapping[str, float], ...]

    @classmethod
    def worst(cls, torque: float, shoes: Sequence[Mapping[str, float]]) -> "Errors":
        """The errors of the shoes, the worst of them, and that of the brake's torque."""
        most = {name: max(shoe[name] for shoe in shoes) for name in QUANTITIES}
        return cls(most | {"torque": torque}, tuple(shoes))


class Distances(NamedTuple):
    """Relative distances of two levels' answers, and what chance signs of the columns would move.

    Each (1 + 4 shoes,): of the brake's torque, shoes not cancelling, then of each shoe QUANTITIES.
    """

    steps: Floats
    chance: Floats


def estimate(brake: Brake, before: Response, last: Response, factors: Factors = FACTORS) -> Errors:
    """Upper values of the errors of a level's response `last`, from that of the level before."""
    moved = distances(brake, before, last)
    found = factors.of_distances(len(last.shoes)) * moved.steps + factors.cancelled * moved.chance
    found = np.where(found > 0, found + beside(last.shoes), found)
    shoes = np.reshape(found[1:], (-1, len(QUANTITIES))).tolist()
    return Errors.worst(float(found[0]), [dict(zip(QUANTITIES, own, strict=True)) for own in shoes])


def beside(shoes: Sequence[ShoeResponse]) -> Floats:
    """Penalty and round-off errors (1 + 4 shoes,), in the order of `Distances`."""
    return SOFTER * _of_quantities(shoes, "softness") + _of_quantities(shoes, "lost")


def _of_quantities(shoes: Sequence[ShoeResponse], name: str) -> Floats:
    """A Change of each shoe, by its name, in the order of `Distances`."""
    every = [getattr(shoe, name) for shoe in shoes]
    changes = [(of.pressure, of.torque, max(of.pressure, of.peak), of.reaction) for of in every]
    return np.array([max(of[1] for of in changes), *chain(*changes)])


def distances(brake: Brake, a: Response, b: Response) -> Distances:
    """Relative distances of response a from b, and what chance would move the forces by.

    Chance means that the contributions of the columns had signs by chance.
    """
    total = b.torque or a.torque or 1.0
    pairs = list(zip(a.shoes, b.shoes, strict=True))
    zones = [edge_zone(shoe, brake.scale_factor) for shoe in brake.shoes]
    own = np.array([_of(zone, brake.unit, x, y) for zone, (x, y) in zip(zones, pairs, strict=True)])
    shares = np.array([y.torque or x.torque for x, y in pairs]) / total
    each = [
        np.array([float(part[:, 1] @ shares), *part.ravel()]) for part in (own[:, 0], own[:, 1])
    ]
    return Distances(*each)


def _of(
    zone: float, unit: float, a: ShoeResponse, b: ShoeResponse
) -> tuple[tuple[float, ...], ...]:
    """The distances of one shoe and what chance would move its forces by, (2, 4) by QUANTITIES.

    zone : at the lining's ends, in which no peak is looked for
    unit : see `Frame`
    """
    held = reaction_size(b.hinge_reaction, b.normal_force)
    torque = abs(a.torque - b.torque) / (b.torque or a.torque or 1.0)
    peak = abs(a.peak_pressure - b.peak_pressure) / (b.peak_pressure or a.peak_pressure or 1.0)
    reaction = math.dist(a.hinge_reaction, b.hinge_reaction) / held
    if not b.pressure.any():
        return (float(a.pressure.any()), torque, peak, reaction), (0.0,) * len(QUANTITIES)
    singular = singular_zone(float(b.theta[-1] - b.theta[0]), unit)
    edge, zone = (edge_left_out(b.theta, b.pressure, b.order, x) for x in (singular, zone))
    step = Difference.of(a, b, edge, zone)
    # Forces change only by what balances within the arc of the contact, a fraction of them like its
    # angle.
    reach = (b.contact_arcs[-1][1] - b.contact_arcs[0][0]) / unit
    p, chance = step.distance(edge), min(step.by_chance(), reach)
    by_chance = 0.0, chance if b.torque else 0.0, 0.0, chance * b.normal_force / held
    return (p, torque, max(peak, math.sqrt(p * step.at_peak(zone))), reaction), by_chance
