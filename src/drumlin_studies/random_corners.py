"""Random brakes that press on the drum only with a corner of the lining or under a tip of the gap.

A seed determines a brake. The pressure is singular at a corner of a lining. It is singular as well
under a tip, which is a kink of the lining's surface that points to the drum. In most brakes these
singular pressures have little effect: a corner lies in the edge zone, which comparisons of
pressures leave out, and a tip bears a small part of the force. In the brakes of this module the
corner or the tip bears nearly all of the force, because a taper, a table of clearances or another
radius keeps the rest of the lining off the drum.

The contact depends only on the ratio of force to gap. Therefore the force has an ordinary size, and
the gap is scaled until the contact has the length that was drawn for it.
"""

import math
from collections.abc import Callable, Mapping
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import make_drum_brake_from_data, vary
from drumlin.fem.error_control.levels import solve_brake_on_finer_and_finer_mesh_levels
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.solve import solve
from drumlin.response.response import Response, ShoeResponse
from drumlin_studies.random_brake import FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND as OF_SHAPE
from drumlin_studies.random_kinds import (
    FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND as OF_HOLDING,
)

MOST_BRAKES_OF_CORNER_KIND_DRAWN_PER_SEED = 200
"""Number of brakes that are drawn for one seed before the generator gives up with NoAnswer."""
FRICTION_FACTOR_OF_PRESSING_TEST = 1.2
"""Factor by which a brake's friction is raised for a test, in which all shoes must still press on
the drum.

The test keeps the brake away from the friction at which it would lock itself.
"""
MOST_SOLVES_TO_SCALE_GAP_TO_CONTACT_LENGTH = 8
"""Largest number of solves in which the gap of a brake is scaled, until the contact has the drawn
length. After these solves the brake is given up.
"""
SIGNIFICANT_DIGITS_OF_GAP_FACTOR = 2
"""Significant digits of the factor by which a gap is scaled.

With two digits the brake of a seed stays the same, even if a change of the solver changes the
length of the contact by some percent.
"""
CONTACT_LENGTH_TOLERANCE_FACTOR = 1.25
"""Factor by which the length of the contact may be larger or smaller than the drawn length."""
NUMBER_OF_LEVELS_FOR_CONTACT_LENGTH = 2
"""Number of refinement levels after which a solve knows the contact's length to some percent."""
RANGE_OF_SHORT_CONTACT_LENGTH = math.radians(0.1), math.radians(0.8)
"""Smallest and largest length of a short contact [rad].

At a corner more than half of a short contact lies in the edge zone at the lining's end.
"""
RANGE_OF_LONG_CONTACT_LENGTH = math.radians(0.8), math.radians(8.0)
"""Smallest and largest length of a long contact [rad]."""
PROBABILITY_OF_SHORT_CONTACT = 0.7
"""Probability with which a brake gets a short contact rather than a long one."""
ANGLE_FROM_LINING_END_COUNTED_AS_CONTACT_THERE = 1e-9
"""Angle [rad] between the ends of contact and lining, below which the contact reaches the lining's
end.
"""

RandomNumberGenerator = np.random.Generator
"""The generator from which random numbers are drawn."""
LiningGapData = dict[str, Any]
"""The part of a lining's data that determines its gap: the keys `clearance` or `misfit`."""


class HowBrakesOfCornerKindAreDrawn(NamedTuple):
    """How the brakes of a kind of this module are drawn.

    Attributes
    ----------
    shapes : tuple of str
        Kinds of FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND or
        FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND; one of them gives the shoes and the drum.
    presses : str
        The part of the lining that bears the force: "corner", or "tip", a kink that points to the
        drum. "table" stands for a random table of clearances, with which a corner or a tip may bear
        the force.
    """

    shapes: tuple[str, ...]
    presses: str


# Names of kinds of random brakes, grouped by their shoes: rigid shoes, elastic shoes along the
# drum, shoes on an elastic ring, and shoes without a hinge as their only support.
RIGID_SHAPES, ARC_SHAPES = ("rigid",), ("arc", "backed")
SHAPE_KINDS_WITH_ELASTIC_RING = ("arc on ring", "linings on ring", "post on ring")
SUPPORT_KINDS_WITHOUT_HINGE = ("guide", "abutment", "rough abutment", "pivot")
WAYS_TO_DRAW_BRAKES_BY_CORNER_KIND: dict[str, HowBrakesOfCornerKindAreDrawn] = {
    "corner": HowBrakesOfCornerKindAreDrawn(ARC_SHAPES, "corner"),
    "corner of a rigid shoe": HowBrakesOfCornerKindAreDrawn(RIGID_SHAPES, "corner"),
    "corner of a post": HowBrakesOfCornerKindAreDrawn(("post",), "corner"),
    "corner on a ring": HowBrakesOfCornerKindAreDrawn(SHAPE_KINDS_WITH_ELASTIC_RING, "corner"),
    "corner of a shoe without hinge": HowBrakesOfCornerKindAreDrawn(
        SUPPORT_KINDS_WITHOUT_HINGE, "corner"
    ),
    "tip": HowBrakesOfCornerKindAreDrawn(ARC_SHAPES, "tip"),
    "tip of a rigid shoe": HowBrakesOfCornerKindAreDrawn(RIGID_SHAPES, "tip"),
    "tip on a ring": HowBrakesOfCornerKindAreDrawn(SHAPE_KINDS_WITH_ELASTIC_RING, "tip"),
    "tip of a shoe without hinge": HowBrakesOfCornerKindAreDrawn(
        SUPPORT_KINDS_WITHOUT_HINGE, "tip"
    ),
    "table": HowBrakesOfCornerKindAreDrawn(
        (*ARC_SHAPES, *RIGID_SHAPES, "post", *SUPPORT_KINDS_WITHOUT_HINGE), "table"
    ),
}
"""The kinds of brakes of this module, and how each is drawn."""


def draw_random_brake_pressing_with_corner_or_kink(seed: int, kind: str | None = None) -> Brake:
    """The random brake of a seed, in which at least one shoe presses with a corner or a tip.

    A corner is an end of the lining's surface; a tip is a kink of this surface that points to the
    drum. All shoes press on the drum, even at FRICTION_FACTOR_OF_PRESSING_TEST times the friction
    of the brake. The first NUMBER_OF_LEVELS_FOR_CONTACT_LENGTH levels of a solve decide whether a
    corner or a tip presses. On finer levels friction may lift the corner a little off the drum.

    Parameters
    ----------
    seed : int
        The same seed always gives the same brake.
    kind : str, optional
        One of WAYS_TO_DRAW_BRAKES_BY_CORNER_KIND. By default the seed modulo their number chooses
        the kind.

    Raises
    ------
    NoAnswer
        No brake of the kind passes in MOST_BRAKES_OF_CORNER_KIND_DRAWN_PER_SEED draws.
    """
    names = list(WAYS_TO_DRAW_BRAKES_BY_CORNER_KIND)
    kind = names[seed % len(names)] if kind is None else kind
    for attempt in range(MOST_BRAKES_OF_CORNER_KIND_DRAWN_PER_SEED):
        rng = np.random.default_rng([seed, names.index(kind), attempt])
        try:
            brake = _scale_gaps_to_random_contact_length(
                rng,
                _draw_brake_as_function_of_gap_factor(rng, kind, seed),
                WAYS_TO_DRAW_BRAKES_BY_CORNER_KIND[kind].presses,
            )
        except (BadInput, NoAnswer):
            continue
        if brake is not None:
            return brake
    raise NoAnswer(
        f"no brake of kind {kind} from seed {seed} in "
        f"{MOST_BRAKES_OF_CORNER_KIND_DRAWN_PER_SEED} attempts"
    )


def _draw_brake_as_function_of_gap_factor(
    rng: RandomNumberGenerator, kind: str, seed: int
) -> Callable[[float], Brake]:
    """A random brake as a function of a factor on its gaps between linings and drum.

    The result is a function that returns the brake for a factor, with all gaps multiplied by the
    factor. Each shoe of the brake has a random direction of its force and a random gap.

    kind : one of WAYS_TO_DRAW_BRAKES_BY_CORNER_KIND; seed : seed of the brake, for its title.
    """
    shape = str(rng.choice(WAYS_TO_DRAW_BRAKES_BY_CORNER_KIND[kind].shapes))
    data = (OF_SHAPE | OF_HOLDING)[shape](rng)
    rotation = str(rng.choice(["clockwise", "counter-clockwise"]))
    friction = 0.0 if rng.random() < 0.12 else float(f"{rng.uniform(0.01, 0.6):.4g}")
    data |= {"title": f"random {kind} {seed}", "rotation": rotation, "friction": friction}
    data["shoe"] = [_shoe_data_with_randomly_turned_force(rng, shoe) for shoe in data["shoe"]]
    radius, presses = data["drum"]["radius"], WAYS_TO_DRAW_BRAKES_BY_CORNER_KIND[kind].presses
    gaps = [_draw_gap_as_function_of_factor(rng, shoe, radius, presses) for shoe in data["shoe"]]

    def brake_with_scaled_gaps(factor: float) -> Brake:
        """The brake with the gaps of all linings multiplied by a factor."""
        shoes = []
        for shoe, gap in zip(data["shoe"], gaps, strict=True):
            shoes.append(shoe | {"lining": shoe["lining"] | gap(factor)})
        return make_drum_brake_from_data(data | {"shoe": shoes})

    return brake_with_scaled_gaps


def _shoe_data_with_randomly_turned_force(
    rng: RandomNumberGenerator, shoe: dict[str, Any]
) -> dict[str, Any]:
    """The data of a shoe with the direction of its force turned by a random angle up to +-1 rad."""
    push = shoe["actuation"]
    return shoe | {"actuation": push | {"direction": push["direction"] + rng.uniform(-1.0, 1.0)}}


def _draw_gap_as_function_of_factor(
    rng: RandomNumberGenerator, shoe: Mapping[str, Any], radius: float, presses: str
) -> Callable[[float], LiningGapData]:
    """A random gap of a lining as a function of a factor on this gap.

    The result is a function that returns the gap, multiplied by the factor, as data of a lining. At
    a factor of 1 the gap is about as large as the compression of the lining by the actuation force.

    Parameters
    ----------
    rng : numpy.random.Generator
        Generator of the random numbers.
    shoe : dict
        Data of the shoe, as in a brake file.
    radius : float
        Radius of the drum [m].
    presses : str
        The part of the lining that bears the force: "corner", "tip" (a kink that points to the
        drum), or "table" for either of them.
    """
    lining = shoe["lining"]
    area = radius * (lining["end"] - lining["start"]) * lining["width"]
    size = shoe["actuation"]["force"] / area * lining["thickness"] / lining["material"]["E"]
    if presses == "corner":
        return _draw_gap_smallest_at_corner_as_function_of_factor(rng, lining, radius, size)
    if presses == "tip":
        return _draw_gap_with_kink_to_drum_as_function_of_factor(rng, lining, size)
    return _draw_clearance_table_as_function_of_factor(rng, lining, size)


def _draw_gap_smallest_at_corner_as_function_of_factor(
    rng: RandomNumberGenerator, lining: Mapping[str, Any], radius: float, size: float
) -> Callable[[float], LiningGapData]:
    """A random gap, smallest at a corner of the lining, as a function of a factor on the gap.

    The result is a function from the factor to the data of a lining with a taper, another radius,
    an even clearance or a table of clearances.

    lining : data of the lining; radius : radius of the drum [m]; size : size of the gap at a factor
    of 1 [m].
    """
    way, sign = rng.random(), float(rng.choice([-1, 1]))
    if way < 0.4:
        return lambda factor: {"misfit": {"taper": sign * factor * size}}
    if way < 0.5:
        return lambda factor: {"misfit": {"radius": radius + sign * factor * size}}
    if way < 0.6:
        return lambda factor: {"clearance": factor * size}
    # In these cases the gap is a table of clearances that grow from one corner to the other.
    rises = np.cumsum([0.0, *rng.uniform(0.2, 1.0, int(rng.integers(1, 4)))])
    rises = rises[:: int(sign)] / rises.max()
    return lambda factor: {
        "clearance": _clearance_table_at_even_angles(lining, factor * size * rises)
    }


def _draw_gap_with_kink_to_drum_as_function_of_factor(
    rng: RandomNumberGenerator, lining: Mapping[str, Any], size: float
) -> Callable[[float], LiningGapData]:
    """A random gap with a tip (a kink towards the drum), as a function of a factor on the gap.

    The gap is zero at the tip and grows to both sides. The result is a function from the factor to
    the data of the lining.

    lining : data of the lining; size : largest gap at a factor of 1 [m].
    """
    start, end = lining["start"], lining["end"]
    at = start + rng.uniform(0.1, 0.9) * (end - start)
    left, right = rng.uniform(0.2, 1.0, 2)
    return lambda factor: {
        "clearance": [[start, factor * size * left], [at, 0.0], [end, factor * size * right]]
    }


def _draw_clearance_table_as_function_of_factor(
    rng: RandomNumberGenerator, lining: Mapping[str, Any], size: float
) -> Callable[[float], LiningGapData]:
    """A random table of three to seven clearances, as a function of a factor on all of them.

    The result is a function from the factor to the data of the lining.

    lining : data of the lining; size : largest gap at a factor of 1 [m].
    """
    rows = rng.uniform(0.0, 1.0, int(rng.integers(3, 8)))
    return lambda factor: {
        "clearance": _clearance_table_at_even_angles(lining, factor * size * rows)
    }


def _clearance_table_at_even_angles(lining: Mapping[str, Any], gaps: Floats) -> list[list[float]]:
    """A table of clearances: rows of an angle [rad] and a gap [m].

    lining : data of the lining; gaps : clearances [m] at even distances from its start to its end.
    """
    angles = np.linspace(lining["start"], lining["end"], len(gaps))
    return np.stack([angles, gaps], axis=1).tolist()


def _scale_gaps_to_random_contact_length(
    rng: RandomNumberGenerator, drawn: Callable[[float], Brake], presses: str
) -> Brake | None:
    """The brake with its gaps scaled so that its shortest contact has a random length.

    The contact of a shoe is the sum of its contact arcs. The result is None where no factor gives
    this length within CONTACT_LENGTH_TOLERANCE_FACTOR, or where the wrong part of the lining
    presses. After each solve the factor on the gaps is multiplied by (length/wanted length)^0.8.
    The exact power is 1 for a gap in the form of a wedge and 2 for a curved gap. The smaller power
    0.8 does not overshoot.

    Parameters
    ----------
    rng : numpy.random.Generator
        Generator of the random length.
    drawn : function
        Returns the brake for a factor on its gaps.
    presses : str
        The part of the lining that bears the force: "corner", "tip" (a kink that points to the
        drum), or "table" for either of them.
    """
    # The wanted length of the contact is drawn uniformly in its logarithm. The first factor on the
    # gaps is 3.
    low, high = (
        RANGE_OF_SHORT_CONTACT_LENGTH
        if rng.random() < PROBABILITY_OF_SHORT_CONTACT
        else RANGE_OF_LONG_CONTACT_LENGTH
    )
    wanted, factor = math.exp(rng.uniform(math.log(low), math.log(high))), 3.0
    for _ in range(MOST_SOLVES_TO_SCALE_GAP_TO_CONTACT_LENGTH):
        factor = float(f"{factor:.{SIGNIFICANT_DIGITS_OF_GAP_FACTOR}g}")
        brake = drawn(factor)
        found = _solve_on_first_refinement_levels(brake)
        length = min((_total_contact_angle_of_shoe(shoe) for shoe in found.shoes), default=0.0)
        if not length > 0:
            return None
        if 1 / CONTACT_LENGTH_TOLERANCE_FACTOR < length / wanted < CONTACT_LENGTH_TOLERANCE_FACTOR:
            return brake if _is_contact_at_drawn_lining_part(brake, found, presses) else None
        factor *= min(max(length / wanted, 0.1), 10.0) ** 0.8
    return None


def _solve_on_first_refinement_levels(brake: Brake) -> Response:
    """The response of a brake on the refinement level that decides on the contact's length.

    This level has the number NUMBER_OF_LEVELS_FOR_CONTACT_LENGTH.

    Raises NoAnswer where a level has no answer.
    """
    *_, last = islice(
        solve_brake_on_finer_and_finer_mesh_levels(brake, solve_prepared_model),
        NUMBER_OF_LEVELS_FOR_CONTACT_LENGTH,
    )
    return last.response


def _total_contact_angle_of_shoe(shoe: ShoeResponse) -> float:
    """The sum of the lengths of all contact arcs of a shoe [rad]."""
    return math.fsum(end - start for start, end in shoe.contact_arcs)


def _is_contact_at_drawn_lining_part(brake: Brake, found: Response, presses: str) -> bool:
    """Whether all shoes press, and at least one shoe with the part of its lining named `presses`.

    The shoes must press on the drum also at FRICTION_FACTOR_OF_PRESSING_TEST times the friction.

    found : response of the brake; presses : the part of the lining that must bear the force:
        "corner", "tip" (a kink that points to the drum), or "table" for either of them.
    """
    more = solve(
        vary(brake, {"friction": FRICTION_FACTOR_OF_PRESSING_TEST * brake.friction}), elements=16
    )
    if not all(shoe.contact_arcs for shoe in (*found.shoes, *more.shoes)):
        return False
    # At least one shoe must press with the part of its lining that `presses` names.
    pairs = list(zip(brake.shoes, found.shoes, strict=True))
    corner = any(is_lining_corner_in_contact(shoe, response) for shoe, response in pairs)
    tip = any(is_kink_towards_drum_in_contact(shoe, response) for shoe, response in pairs)
    return {"corner": corner, "tip": tip, "table": corner or tip}[presses]


def is_lining_corner_in_contact(shoe: Shoe, found: ShoeResponse) -> bool:
    """Whether the contact of a shoe reaches an end of its lining."""
    # `distances` are those between all ends of contact arcs and both ends of the lining.
    ends = np.array(found.contact_arcs).ravel()
    corners = np.array([shoe.lining.start, shoe.lining.end])
    distances = np.abs(ends[:, None] - corners)
    return bool((distances < ANGLE_FROM_LINING_END_COUNTED_AS_CONTACT_THERE).any())


def is_kink_towards_drum_in_contact(shoe: Shoe, found: ShoeResponse) -> bool:
    """Whether a lining's kink that points to the drum (tip) lies inside a contact arc."""
    for angle, _ in clearance.gap_kinks_that_point_to_drum(shoe.lining):
        if any(start < angle < end for start, end in found.contact_arcs):
            return True
    return False
