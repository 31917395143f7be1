"""A brake on finer and finer divisions, the levels of a solve.

Each division is moved to the ends of the contact that the division before it found.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple, Protocol

from drumlin.base.errors import LostDigits, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.singular_points import singular_points_of
from drumlin.fem.hp.division import UNRESOLVED_LENGTH, Level, Singularity, SingularPoint
from drumlin.fem.preparation.cache import Cache
from drumlin.fem.preparation.cache import first_shoes_of_equal_shape as equal_shapes
from drumlin.fem.preparation.meshes import ELEMENTS
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
    fall=5.0,
    sizes=0.75,
    layers=0.6,
    end=0.9,
    corner=12.0,
    largest=15.0 * DEG,
)
"""The eight numbers of the levels, found by experiment on random brakes of all kinds.

`make levels ARGS="fall=6"` finds the figures below again, for any values: on the brakes that
`make calibrate` fits on, the factors of the error estimate on four levels, the processor time of
answers, and the medians of stated over true errors. A force is a torque or a reaction.

- first_degree: the degree of the first level, which only finds the contact (judgement).
- first_error: the error of p that the first level leaves. With 0.03 the factor of forces rises from
  0.57 to 0.75, with 0.04 to 1.3: what a coarse first level and the second one have in common is
  chance. Smaller, every level has more unknowns.
- fall: the error of a level over that of the next. With 6 default answers take 9 % more time. With
  4.5 some brakes need one more level for 1e-4, which takes twice the time.
- sizes: the power of e by which sizes at singular places shrink from level to level. With 0.667 the
  factor of forces is twice as large, since sizes at supports shrink more slowly than p converges.
  With 0.8 default answers take 19 % more time.
- layers: the power of e that the layers leave. With 0.5 the factor of forces is 1.5 times as
  large. With 0.667 answers to 1e-4 take a twentieth more time, and nothing is more accurate.
- end, corner: sizes over e^sizes, at the ends of the contact and at corners. With 0.6 and 6 the
  second level of the double-shoe brake has 1.2 times as many unknowns, and stated errors are no
  sharper.
- largest: size of a column. With 60 deg the torque was three times as far off on the first level.
"""
LEVELS = tuple(RULE.level(k) for k in range(1, 7))
MOST_PASSES = 8


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
    find no way. So a refusal is asked for once more on an even division of the same level, of as
    many columns as a mesh has elements, and all levels from there on are so. Lost digits are not:
    no division of a level brings them back.

    Raises NoAnswer where neither division of the first level has an answer, or two later levels
    have none.
    """
    last: Response | None = None
    alike = equal_shapes(brake)
    refused, even = 0, math.inf
    arcs = [shoe.arc for shoe in brake.shoes]
    for level in levels or LEVELS:
        step: Step | None = None
        places = singular_points_of(brake, last, alike, level.error)
        tried: list[Mapping[int, Sequence[SingularPoint]]] = []
        for _ in range(MOST_PASSES):
            made = prepare(brake, _evened(level, even), places, alike=alike, cache=cache)
            try:
                found = respond(made, brake, start=last)
            except NoAnswer as refusal:
                step = None
                if math.isinf(even) and not isinstance(refusal, LostDigits):
                    even = min(end - start for start, end in arcs) / ELEMENTS
                    continue
                refused += 1
                if refused == 2 or (last is None and math.isfinite(even)):
                    raise
                break
            step = Step(made, found)
            tried.append(places)
            last, places = found, singular_points_of(brake, found, alike, level.error)
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
    """Whether a singular point of any shape of shoe lies where no columns end yet.

    It is an end of the contact that moved by more than UNRESOLVED_LENGTH, or a kink of the gap.
    """
    return any(_off(brake.shoes[i].arc, meant[i], places) for i, places in now.items())


def _off(
    arc: tuple[float, float], places: Sequence[SingularPoint], now: Sequence[SingularPoint]
) -> bool:
    """Whether a singular point `now` of one shoe lies where no columns ended on the last pass.

    An end of the contact may move by UNRESOLVED_LENGTH of the length that it bounds.
    """
    meant = [*arc, *(place.at for place in places)]
    for point in now:
        if point.kind in {Singularity.KINK, Singularity.TIP} and point.at not in meant:
            return True
        if point.kind == Singularity.END:
            distance = min(abs(point.at - x) for x in meant)
            if distance > UNRESOLVED_LENGTH * point.length:
                return True
    return False
