"""A brake on finer and finer divisions, each moved to the ends of the contact that the one before
it found.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple, Protocol

from drumlin.base.errors import LostDigits, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.places import places_of
from drumlin.fem.hp.division import Level, Singularity, SingularPoint
from drumlin.fem.preparation.cache import Cache
from drumlin.fem.preparation.cache import alike as equal_shapes
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.response.response import Response

DEG = math.pi / 180


class LevelRule(NamedTuple):
    """How finely the levels of a solve divide: each by the error that it leaves.

    Level k = 1, 2, ... has the degree p and leaves the error e, of p(theta) in L2, relative:

        p = first_degree + k - 1
        e = first_error / fall^(k - 1)

    From these follow the ratio q of the sizes of neighbours and the sizes at singular places, as
    parts of the lengths that `Level` says:

        sqrt q(e) = (1 - e^(1/p)) / (1 + e^(1/p))

        ratio = q(e)              along the lining
        opening = q(e^sizes)      along the lining, from an end of a short contact
        through = q(e^layers)     through the layers
        end = end e^sizes
        zone = edge = back = hinge = corner e^sizes

    Elements that grow by 1/q from a singular point leave the error ((1 - sqrt q)/(1 + sqrt q))^p of
    the best polynomials of degree p (Gui & Babuska, Numer. Math. 49, 1986), which is e. What is
    coarser than e asks is felt less by p(theta): the layers by their compliance alone, an energy,
    whose error is the square of the stresses' error; a short contact in few columns.
    """

    first_degree: int
    first_error: float
    fall: float
    sizes: float
    layers: float
    end: float
    corner: float
    largest: float

    def level(self, k: int) -> Level:
        """The level k, from 1 on."""
        p = self.first_degree + k - 1
        e = self.first_error / self.fall ** (k - 1)
        corner = self.corner * e**self.sizes
        return Level(
            degree=p,
            zone=corner,
            edge=corner,
            end=self.end * e**self.sizes,
            ratio=_ratio(e, p),
            opening=_ratio(e**self.sizes, p),
            largest=self.largest,
            back=corner,
            hinge=corner,
            through=_ratio(e**self.layers, p),
        )


def _ratio(error: float, p: int) -> float:
    """The ratio of sizes whose growth leaves this error with the degree p, see `LevelRule`."""
    left = error ** (1 / p)
    return ((1 - left) / (1 + left)) ** 2


RULE = LevelRule(
    first_degree=3,
    first_error=0.02,
    fall=6.0,
    sizes=0.667,
    layers=0.5,
    end=0.6,
    corner=6.0,
    largest=15 * DEG,
)
"""The eight numbers of the levels, found by experiment on random brakes of all kinds.

They replace six rows of ten numbers that were tuned by hand. Times and errors below are sums over
10 to 52 brakes of the set that `make calibrate` fits on, some of them with neighbouring values of
the other numbers.

- first_degree: that of the first level, which only finds the contact (judgement).
- first_error: what the first level leaves. Larger, it finds the contact badly; smaller, every level
  has more unknowns (judgement).
- fall: the error of a level over that of the next. With 7 answers to 1e-4 took 1.6 times as long.
- sizes: the power of e by which sizes at singular places shrink. With 1/2 the error over its step
  rose to .6 and .7 in 95 % at the fourth level.
- layers: with .6 the torque of a short contact is three times as accurate on every level, but
  the default answer of a shoe that bends takes a tenth more time. With 2/3 answers to 1e-4 took
  1.2 times as long.
- end, corner: sizes over e^sizes, at the ends of the contact and at corners. With 1 for end p of
  the fourth level was 1.4 times as far off, with .25 answers took a twentieth more time. Corners
  that are a fifth smaller cost a tenth more time; larger ones make the forces worse.
- largest: of a column. With 60 deg the torque was three times as far off on the first level.
"""
LEVELS = tuple(RULE.level(k) for k in range(1, 7))
MOST_PASSES = 8
EVEN = 64
"""Least number of columns under a lining on a division that confirms a refusal. Their nodes are
then a third of a degree apart on most linings, less than on a mesh of 80 elements. Fewer let a
contact that is shorter than a column stand on its ends alone; more cost time and no test brake
needed them.
"""
SETTLED = 0.02
"""Movement of an end of the contact, in parts of its length, below which the columns need not
follow it. Larger, columns end where p does not, and the error of p is that of a coarser level;
smaller, a level takes more passes for an end that it knows.
"""


class Respond(Protocol):
    """What answers for a brake on a scene, from the contact of an earlier response."""

    def __call__(
        self, scene: PreparedModel, brake: Brake, *, start: Response | None = None
    ) -> Response:
        """The response."""


class Step(NamedTuple):
    """A level's scene and response."""

    scene: PreparedModel
    response: Response


def steps(
    brake: Brake,
    respond: Respond,
    cache: Cache | None = None,
    levels: Sequence[Level] = (),
) -> Iterator[Step]:
    """The brake on all levels, or on those given, finer and finer; cache: see `scene`.

    A division is coarse where the contact of the level before does not lie. But what the answer is
    followed through as friction grows lies there too, and a short contact on nodes far apart may
    find no way. So a refusal is asked for once more on an even division of the same level, see
    EVEN, and all levels from there on are so. Lost digits are not: no division of a level brings
    them back.

    Raises NoAnswer where neither division of the first level has an answer, or two later levels
    have none.
    """
    last: Response | None = None
    alike = equal_shapes(brake)
    refused, even = 0, math.inf
    for level in levels or LEVELS:
        step: Step | None = None
        places = places_of(brake, last, alike, level.error)
        tried: list[Mapping[int, Sequence[SingularPoint]]] = []
        for _ in range(MOST_PASSES):
            made = prepare(brake, _evened(level, even), places, alike=alike, cache=cache)
            try:
                found = respond(made, brake, start=last)
            except NoAnswer as refusal:
                step = None
                if math.isinf(even) and not isinstance(refusal, LostDigits):
                    even = (
                        min(end - start for start, end in (shoe.arc for shoe in brake.shoes)) / EVEN
                    )
                    continue
                refused += 1
                if refused == 2 or (last is None and math.isfinite(even)):
                    raise
                break
            step = Step(made, found)
            tried.append(places)
            last, places = found, places_of(brake, found, alike, level.error)
            # Ends that go back to where an earlier pass had them would go to and fro for ever.
            if any(not _moved(brake, meant, places) for meant in tried):
                break
        if step is not None:
            yield step


def _evened(level: Level, largest: float) -> Level:
    """The level with columns of this size [rad] at most."""
    return replace(level, largest=min(level.largest, largest))


def _moved(
    brake: Brake,
    meant: Mapping[int, Sequence[SingularPoint]],
    now: Mapping[int, Sequence[SingularPoint]],
) -> bool:
    """Whether an end of the contact of any shape of shoe is away from where columns end, or a kink
    is no place yet."""
    return any(_off(brake.shoes[i].arc, meant[i], places) for i, places in now.items())


def _off(
    arc: tuple[float, float], places: Sequence[SingularPoint], now: Sequence[SingularPoint]
) -> bool:
    """Whether an end of the contact is away from where columns end, over the length that it bounds,
    or a kink is."""
    meant = [*arc, *(place[0] for place in places)]
    if any(kind in {Singularity.KINK, Singularity.TIP} and x not in meant for x, _, kind in now):
        return True
    return any(
        kind == Singularity.END and min(abs(x - y) for y in meant) > SETTLED * length
        for x, length, kind in now
    )
