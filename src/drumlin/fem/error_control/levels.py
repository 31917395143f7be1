"""The levels of a solve: a brake solved on finer and finer divisions into hp elements.

Each division has small elements at the ends of the contact, whose positions are known from the
response on the division before.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain
from typing import NamedTuple, Protocol

from drumlin.base.errors import AnswerLostToRoundOff, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.short_contact import (
    SHORTEST_CONTACT_WITH_KNOWN_PRESSURE,
    TooShortContact,
    contacts_too_short_by_formula,
    response_with_ends_of_too_short_contacts,
    too_short_contacts_expected_of_rigid_shoes,
)
from drumlin.fem.error_control.singular_points import singular_points_of_each_shoe_shape
from drumlin.fem.hp.division import (
    UNRESOLVED_LENGTH_OVER_CONTACT_LENGTH,
    KindOfSingularPoint,
    RefinementLevel,
    SingularPoint,
)
from drumlin.fem.preparation.cache import CacheOfCondensedBodies
from drumlin.fem.preparation.cache import indices_of_first_shoes_of_equal_shape as equal_shapes
from drumlin.fem.preparation.meshes import DEFAULT_ELEMENTS_ALONG_LINING
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.preparation.scene import (
    LockingFrictionsOfRigidShoes,
    PreparedModel,
    SingularPointsByShoeShape,
)
from drumlin.response.response import Response

DEGREE_IN_RADIANS = math.pi / 180
"""One degree [rad]."""


class RuleOfDegreeAndGradingByLevel(NamedTuple):
    """The rule that gives the degree and the grading of the hp elements on each level of a solve.

    On level k = 1, 2, ... the displacements are polynomials of degree p. The element sizes are
    chosen so that the pressure p(theta) has the relative error e in the L2 norm:

        p = first_degree + k - 1
        e = first_error / fall^(k - 1)

    From p and e follow the ratio q of the sizes of neighbouring elements, and the sizes of the
    elements at singular points, relative to lengths that are explained in `RefinementLevel`:

        sqrt q(e) = (1 - e^(1/p)) / (1 + e^(1/p))

        column_size_ratio = q(e)                   along the lining
        size_ratio_at_short_contacts = q(e^sizes)  along the lining, from an end of a short contact
        layer_size_ratio = q(e^layers)             through the layers
        contact_end_column_size = end e^sizes
        lining_end_column_size = face_layer_size = interface_layer_size = hinge_column_size
            = corner e^sizes

    If the elements grow by the factor 1/q from one to the next, away from a singular point, the
    best polynomials of degree p have the error ((1 - sqrt q)/(1 + sqrt q))^p there (Gui & Babuska,
    Numer. Math. 49, 1986). The formula for q sets this error equal to e.

    Two kinds of element sizes may be coarser, because they change p(theta) less. The sizes through
    the thickness of the layers influence p only by the compliance of the layers, and the error of a
    compliance is the square of the error of the stresses. The sizes at the ends of a short contact
    influence p only in a few columns of elements.

    Attributes
    ----------
    first_degree : degree of the first level
    first_error : error of p that the first level may leave
    fall : error of a level, divided by the error of the next level
    sizes : exponent of e in the sizes of elements at singular points
    layers : exponent of e in the error by the element sizes through the thickness of the layers
    end : size of the elements at the ends of the contact, divided by e^sizes
    corner : size of the elements at corners, divided by e^sizes
    largest : largest width of a column of elements [rad]
    """

    first_degree: int
    first_error: float
    fall: float
    sizes: float
    layers: float
    end: float
    corner: float
    largest: float

    def refinement_level_with_number(self, k: int) -> RefinementLevel:
        """The degree and grading of the level with the number k, counted from 1."""
        p = self.first_degree + k - 1
        e = self.first_error / self.fall ** (k - 1)
        corner = self.corner * e**self.sizes
        return RefinementLevel(
            degree=p,
            face_layer_size=corner,
            lining_end_column_size=corner,
            contact_end_column_size=self.end * e**self.sizes,
            column_size_ratio=_element_size_ratio_for_error(e, p),
            size_ratio_at_short_contacts=_element_size_ratio_for_error(e**self.sizes, p),
            largest_column=self.largest,
            interface_layer_size=corner,
            hinge_column_size=corner,
            layer_size_ratio=_element_size_ratio_for_error(e**self.layers, p),
        )


def _element_size_ratio_for_error(error: float, p: int) -> float:
    """The ratio q of the sizes of neighbouring elements, smaller to larger.

    Elements of degree p that grow by the factor 1/q from one to the next, away from a singular
    point, leave the relative error `error`. The formula is explained in
    `RuleOfDegreeAndGradingByLevel`.
    """
    root = error ** (1 / p)
    return ((1 - root) / (1 + root)) ** 2


RULE_OF_DEGREE_AND_GRADING = RuleOfDegreeAndGradingByLevel(
    first_degree=3,
    first_error=0.02,
    fall=5.0,
    sizes=0.75,
    layers=0.6,
    end=0.9,
    corner=12.0,
    largest=15.0 * DEGREE_IN_RADIANS,
)
"""The eight numbers of the rule for degree and element sizes, found by experiment on random brakes.

`make levels ARGS="fall=6"` finds the figures below again, for any values of the numbers. It runs
the brakes on which `make calibrate` fits the error estimate. It reports the factors of the estimate
on four levels, the processor time of solves, and the medians of stated over true errors. "The
factor of forces" below is the factor for torques and reactions; a larger factor makes stated errors
larger.

- first_degree: the first level only has to find the contact. The degree 3 is a judgement.
- first_error: with 0.03 the factor of forces rises from 0.57 to 0.75, with 0.04 to 1.3, because the
  difference between a coarse first level and the second level may be small by chance. With smaller
  values every level has more unknowns.
- fall: with 6 a solve to the default tolerance takes 9 % more time. With 4.5 some brakes need one
  more level for an error of 1e-4, which doubles the time.
- sizes: with 0.667 the factor of forces is twice as large, since elements at supports shrink more
  slowly than p converges. With 0.8 a solve to the default tolerance takes 19 % more time.
- layers: with 0.5 the factor of forces is 1.5 times as large. With 0.667 solves to 1e-4 take 5 %
  more time, and nothing is more accurate.
- end, corner: with 0.6 and 6 the second level of the double-shoe brake has 1.2 times as many
  unknowns, and stated errors are no nearer to the true ones.
- largest: with 60 deg the torque was three times as far off on the first level.
"""
REFINEMENT_LEVELS_FROM_COARSE_TO_FINE = tuple(
    RULE_OF_DEGREE_AND_GRADING.refinement_level_with_number(k) for k in range(1, 7)
)
"""The six levels of a solve, from coarse to fine: degree and grading of their hp elements."""
MAX_DIVISIONS_OF_BRAKE_PER_LEVEL = 8
"""Largest number of divisions of a brake on one level of a solve; each division is a pass.

The first response on a level shows where the contact ends. The next pass divides the brake again,
with small elements at these ends. If the ends still move in the last pass, its response is taken
nevertheless.
"""
ALLOWED_END_MOTION_ON_FIRST_LEVEL = 0.05
"""Motion of a contact's end from one pass of the first level to the next that needs no third pass.

It is relative to the length of the contact. The next level divides the brake at the new position
anyway, and its own passes end at UNRESOLVED_LENGTH_OVER_CONTACT_LENGTH. An end beside the smallest
elements of the first level only makes the distance of the first two levels larger, and with it the
stated errors. With 0.02 in place of 0.05, 13 of 60 random brakes (seeds 100 to 159 of the
calibration) take a pass more and 1.14 times the time; their stated errors are down to 0.7 times as
large. On 47 other brakes whose contact ends within the lining (`draw_random_brake`, ten kinds) the
largest ratio of true to stated error is 0.80 with both values. With 0.1 six of these state 0.5 %
for the pressure, the default tolerance, which some brakes would then miss on the second level.
"""


class FunctionThatComputesResponse(Protocol):
    """The type of a function that computes the response of a brake on its prepared model."""

    def __call__(
        self, scene: PreparedModel, brake: Brake, *, start: Response | None = None
    ) -> Response:
        """Return the response of a brake on its prepared model `scene`.

        The contact of the earlier response `start` is the first guess.
        """


FunctionThatPreparesModelOfLevel = Callable[
    [RefinementLevel, SingularPointsByShoeShape], PreparedModel
]
"""Function that makes a prepared model from a level and the singular points of each shoe shape."""


class SolvedLevel(NamedTuple):
    """The prepared model of one level of a solve, and the response of the brake on this model."""

    prepared_model: PreparedModel
    response: Response


def solve_brake_on_finer_and_finer_mesh_levels(
    brake: Brake,
    respond: FunctionThatComputesResponse,
    cache: CacheOfCondensedBodies | None = None,
    levels: Sequence[RefinementLevel] = (),
    *,
    prepare: FunctionThatPreparesModelOfLevel | None = None,
    start: Response | None = None,
    first_level_is_an_answer: bool = False,
) -> Iterator[SolvedLevel]:
    """Solve a brake on one level after the other, finer and finer, and yield each solved level.

    The contact is found in steps of growing friction. At a lower friction the contact may lie where
    the elements are large, and a short contact on nodes far apart may have no solution. A level
    without a solution is therefore solved once more with narrower columns of elements: at least as
    many along the lining as a uniform mesh has (DEFAULT_ELEMENTS_ALONG_LINING). All later levels
    keep this largest width of a column. If a solution has lost too many digits to round-off, the
    level is not solved again, because other elements would not restore the digits.

    Parameters
    ----------
    brake : the brake
    respond : function that computes the response on a prepared model
    cache : keeps the stiffness matrices of bodies from earlier solves
    levels : the levels; REFINEMENT_LEVELS_FROM_COARSE_TO_FINE if it is empty
    prepare : function that makes the prepared model of a level; None for plane stress
    start : an earlier response; the first division has small elements at the ends of its contact
    first_level_is_an_answer : whether the response on the first level is used as an answer itself.
        Its contact is then found as exactly as that of all other levels. A single level, and levels
        with a function `prepare`, are always solved in this way.

    Raises
    ------
    NoAnswer
        if the first level has no solution even with narrower columns, or if two later levels have
        no solution
    """
    last: Response | None = start
    alike = equal_shapes(brake)
    rigid_limits = LockingFrictionsOfRigidShoes(brake)
    refusals, column_limit = 0, math.inf
    shortest_arc = min(end - start for shoe in brake.shoes for start, end in shoe.arcs)
    end_motion = UNRESOLVED_LENGTH_OVER_CONTACT_LENGTH
    if prepare is None and len(levels) != 1 and not first_level_is_an_answer:
        end_motion = ALLOWED_END_MOTION_ON_FIRST_LEVEL
    prepare = prepare or partial(make_prepared_model, brake, alike=alike, cache=cache)
    too_short = _too_short_contacts_before_first_pass(brake, start)
    for level in levels or REFINEMENT_LEVELS_FROM_COARSE_TO_FINE:
        error = level.pressure_error_due_to_column_size_ratio
        points_after = partial(singular_points_of_each_shoe_shape, brake, alike=alike, error=error)
        points = points_after(last, too_short=too_short)
        points_of_passes: list[SingularPointsByShoeShape] = []
        for _ in range(MAX_DIVISIONS_OF_BRAKE_PER_LEVEL):
            # The brake is divided with small elements at the singular points of the earlier pass,
            # and solved. The model of the earlier pass may take hundreds of megabytes. It is
            # dropped before the next one is made.
            solved: SolvedLevel | None = None
            model: PreparedModel | None = None
            limited = replace(level, largest_column=min(level.largest_column, column_limit))
            model = replace(prepare(limited, points), rigid_limits=rigid_limits)
            try:
                response = respond(model, brake, start=last)
            except NoAnswer as refusal:
                if math.isinf(column_limit) and not isinstance(refusal, AnswerLostToRoundOff):
                    column_limit = shortest_arc / DEFAULT_ELEMENTS_ALONG_LINING
                    continue
                refusals += 1
                if refusals == 2 or (last is start and math.isfinite(column_limit)):
                    raise
                break
            too_short = contacts_too_short_by_formula(brake, response)
            last = response_with_ends_of_too_short_contacts(brake, response, too_short)
            solved = SolvedLevel(model, last)
            points_of_passes.append(points)
            points = points_after(last, too_short=too_short)
            # The passes end when the new points agree with the points of any earlier pass. Ends of
            # the contact that return to an earlier position would otherwise alternate for ever.
            if _do_singular_points_repeat_earlier_pass(brake, points_of_passes, points, end_motion):
                break
        end_motion = UNRESOLVED_LENGTH_OVER_CONTACT_LENGTH
        if solved is not None:
            yield solved


def _too_short_contacts_before_first_pass(
    brake: Brake, start: Response | None
) -> tuple[TooShortContact | None, ...]:
    """For each shoe the contact that is too short by an earlier response, or if it is rigid."""
    if start is None:
        return too_short_contacts_expected_of_rigid_shoes(brake)
    return contacts_too_short_by_formula(brake, start)


def _do_singular_points_repeat_earlier_pass(
    brake: Brake,
    points_of_passes: Sequence[SingularPointsByShoeShape],
    points: SingularPointsByShoeShape,
    end_motion: float,
) -> bool:
    """Whether the singular points agree with the points of an earlier pass on the level.

    Ends of the contact agree if they differ by at most `end_motion` times the contact's length.
    """
    return any(
        not has_any_lining_new_singular_points(brake, earlier, points, end_motion)
        for earlier in points_of_passes
    )


def has_any_lining_new_singular_points(
    brake: Brake,
    before: SingularPointsByShoeShape,
    now: SingularPointsByShoeShape,
    end_motion: float = UNRESOLVED_LENGTH_OVER_CONTACT_LENGTH,
) -> bool:
    """Whether the pressure has singular points where the elements on which it was solved are large.

    Such a point is an end of the contact that has moved by more than `end_motion`, or a kink of the
    gap that has not been a point before. Ends of contacts below
    SHORTEST_CONTACT_WITH_KNOWN_PRESSURE do not count, because no division resolves them. The keys
    of the points are the first shoes of each shape.

    Parameters
    ----------
    brake : the brake
    before : singular points at which the division has small elements
    now : singular points of the response on this division
    end_motion : motion of an end of the contact that does not count, relative to the length of the
        contact or opening that it bounds
    """
    for i, points in now.items():
        shoe = brake.shoes[i]
        shortest = SHORTEST_CONTACT_WITH_KNOWN_PRESSURE * shoe.lining.thickness / brake.size
        if _has_lining_new_singular_points(shoe.arcs, before[i], points, shortest, end_motion):
            return True
    return False


def _has_lining_new_singular_points(
    arcs: Sequence[tuple[float, float]],
    before: Sequence[SingularPoint],
    now: Sequence[SingularPoint],
    shortest: float,
    end_motion: float,
) -> bool:
    """Whether one of the singular points `now` of a shoe lies away from all points `before`.

    The elements are always small at the ends of the linings, which are the ends of `arcs`. An end
    of the contact may move by `end_motion` times the length of the contact or opening that it
    bounds. Ends of contacts and openings of less than the length `shortest` [rad] do not count.
    """
    known = [*chain(*arcs), *(point.position for point in before)]
    for point in now:
        if (
            point.kind in {KindOfSingularPoint.KINK, KindOfSingularPoint.TIP}
            and point.position not in known
        ):
            return True
        if point.kind == KindOfSingularPoint.END and point.length >= shortest:
            moved = min(abs(point.position - at) for at in known)
            if moved > end_motion * point.length:
                return True
    return False
