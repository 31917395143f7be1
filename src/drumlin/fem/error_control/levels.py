"""The levels of a solve: a brake solved on finer and finer divisions into hp elements.

Each division has its grading points at the ends of the contact that the division before has found.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple, Protocol

from drumlin.base.errors import LostDigits, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.singular_points import singular_points_of
from drumlin.fem.hp.division import UNRESOLVED_LENGTH, Level, Singularity, SingularPoint
from drumlin.fem.preparation.cache import Cache
from drumlin.fem.preparation.cache import first_shoes_of_equal_shape as equal_shapes
from drumlin.fem.preparation.columns import PointsByShape
from drumlin.fem.preparation.meshes import ELEMENTS
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.response.response import Response

DEG = math.pi / 180
"""A degree [rad]."""


class LevelRule(NamedTuple):
    """The rule that makes the levels of a solve: each level from the error of p that it may leave.

    Level k = 1, 2, ... has the degree p, and its grading leaves the error e of p(theta) in L2,
    relative:

        p = first_degree + k - 1
        e = first_error / fall^(k - 1)

    From both follow the ratio q of the sizes of neighbouring elements, and the sizes at singular
    points as parts of the lengths that `Level` names:

        sqrt q(e) = (1 - e^(1/p)) / (1 + e^(1/p))

        ratio = q(e)              along the lining
        opening = q(e^sizes)      along the lining, from an end of a short contact
        through = q(e^layers)     through the layers
        end = end e^sizes
        zone = edge = back = hinge = corner e^sizes

    Elements that grow by 1/q from a singular point leave the error ((1 - sqrt q)/(1 + sqrt q))^p of
    the best polynomials of degree p (Gui & Babuska, Numer. Math. 49, 1986), which is e. Where the
    division is coarser than e asks, p(theta) feels it less. The layers are felt by their compliance
    alone, an energy, whose error is the square of the error of the stresses. A short contact is
    felt in few columns.

    Attributes
    ----------
    first_degree : degree of the first level
    first_error : error of p that the first level may leave
    fall : error of a level over that of the next level
    sizes : power of e by which sizes at singular points shrink from level to level
    layers : power of e that the grading through the layers leaves
    end : size at the ends of the contact over e^sizes
    corner : sizes at corners over e^sizes
    largest : largest size of a column [rad]
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
        """The level with the number k, which counts from 1."""
        p = self.first_degree + k - 1
        e = self.first_error / self.fall ** (k - 1)
        corner = self.corner * e**self.sizes
        return Level(
            degree=p,
            zone=corner,
            edge=corner,
            end=self.end * e**self.sizes,
            ratio=_size_ratio_for_error(e, p),
            opening=_size_ratio_for_error(e**self.sizes, p),
            largest=self.largest,
            back=corner,
            hinge=corner,
            through=_size_ratio_for_error(e**self.layers, p),
        )


def _size_ratio_for_error(error: float, p: int) -> float:
    """The ratio q of neighbouring sizes whose growth leaves this error with elements of degree p.

    The formula is that of `LevelRule`.
    """
    root = error ** (1 / p)
    return ((1 - root) / (1 + root)) ** 2


LEVEL_RULE = LevelRule(
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

`make levels ARGS="fall=6"` finds the figures below again, for any values. It reports, for the
brakes that `make calibrate` fits on, the factors of the error estimate on four levels, the
processor time of answers, and the medians of stated over true errors. A force is a torque or a
reaction.

- first_degree: the first level only finds the contact. The degree 3 is a judgement.
- first_error: with 0.03 the factor of forces rises from 0.57 to 0.75, with 0.04 to 1.3, because a
  coarse first level resembles the second level only by chance. With smaller values every level has
  more unknowns.
- fall: with 6 default answers take 9 % more time. With 4.5 some brakes need one more level for
  1e-4, which takes twice the time.
- sizes: with 0.667 the factor of forces is twice as large, since sizes at supports shrink more
  slowly than p converges. With 0.8 default answers take 19 % more time.
- layers: with 0.5 the factor of forces is 1.5 times as large. With 0.667 answers to 1e-4 take a
  twentieth more time, and nothing is more accurate.
- end, corner: with 0.6 and 6 the second level of the double-shoe brake has 1.2 times as many
  unknowns, and stated errors are no sharper.
- largest: with 60 deg the torque was three times as far off on the first level.
"""
LEVELS = tuple(LEVEL_RULE.level(k) for k in range(1, 7))
"""The levels of a solve, from coarse to fine."""
MOST_PASSES = 8
"""Largest number of divisions on one level. Each pass follows the ends of the contact that the pass
before has found, and the last pass stands even if the ends still move.
"""


class ResponseFunction(Protocol):
    """A function that computes the response of a brake on its prepared model."""

    def __call__(
        self, scene: PreparedModel, brake: Brake, *, start: Response | None = None
    ) -> Response:
        """The response; `start` is an earlier response, whose contact is the first guess."""


class SolvedLevel(NamedTuple):
    """The prepared model of a level, `scene`, and the response on it."""

    scene: PreparedModel
    response: Response


def solved_levels(
    brake: Brake,
    respond: ResponseFunction,
    cache: Cache | None = None,
    levels: Sequence[Level] = (),
) -> Iterator[SolvedLevel]:
    """The brake solved on one level after the other, finer and finer.

    The contact is found by following it as the friction grows. On the way the contact may lie where
    the division is coarse, and a short contact on nodes far apart may have no solution. A level
    without an answer is therefore solved once more with an upper limit of the size of columns, as
    many along the lining as a mesh has elements. All later levels keep this limit. A level whose
    answer has lost its digits is not solved again: no division of the level restores them.

    Parameters
    ----------
    brake : the brake
    respond : computes the response on a prepared model
    cache : keeps condensed bodies, see `prepare`
    levels : the levels; LEVELS if it is empty

    Raises
    ------
    NoAnswer
        where neither division of the first level has an answer, or two later levels have none
    """
    last: Response | None = None
    alike = equal_shapes(brake)
    refusals, column_limit = 0, math.inf
    shortest_arc = min(end - start for start, end in (shoe.arc for shoe in brake.shoes))
    for level in levels or LEVELS:
        solved: SolvedLevel | None = None
        points = singular_points_of(brake, last, alike, level.error)
        points_of_passes: list[PointsByShape] = []
        for _ in range(MOST_PASSES):
            limited = replace(level, largest=min(level.largest, column_limit))
            model = prepare(brake, limited, points, alike=alike, cache=cache)
            try:
                response = respond(model, brake, start=last)
            except NoAnswer as refusal:
                solved = None
                if math.isinf(column_limit) and not isinstance(refusal, LostDigits):
                    column_limit = shortest_arc / ELEMENTS
                    continue
                refusals += 1
                if refusals == 2 or (last is None and math.isfinite(column_limit)):
                    raise
                break
            solved = SolvedLevel(model, response)
            points_of_passes.append(points)
            last, points = response, singular_points_of(brake, response, alike, level.error)
            # The passes end when the new points are those of any earlier pass: ends of the contact
            # that return to an earlier position would alternate forever.
            if any(not _has_new_points(brake, earlier, points) for earlier in points_of_passes):
                break
        if solved is not None:
            yield solved


def _has_new_points(brake: Brake, before: PointsByShape, now: PointsByShape) -> bool:
    """Whether a singular point of any shape of shoe lies where a division has no grading point.

    Such a point is an end of the contact that moved by more than UNRESOLVED_LENGTH, or a kink of
    the gap.

    Parameters
    ----------
    brake : the brake
    before : singular points that the division was made for
    now : singular points of the response on this division
    """
    return any(
        _has_new_points_on_lining(brake.shoes[i].arc, before[i], points)
        for i, points in now.items()
    )


def _has_new_points_on_lining(
    arc: tuple[float, float], before: Sequence[SingularPoint], now: Sequence[SingularPoint]
) -> bool:
    """Whether a singular point `now` of one lining lies away from all points `before`.

    The ends of the lining, `arc`, always are grading points. An end of the contact may move by
    UNRESOLVED_LENGTH of the length that it bounds.
    """
    known = [*arc, *(point.at for point in before)]
    for point in now:
        if point.kind in {Singularity.KINK, Singularity.TIP} and point.at not in known:
            return True
        if point.kind == Singularity.END:
            moved = min(abs(point.at - at) for at in known)
            if moved > UNRESOLVED_LENGTH * point.length:
                return True
    return False
