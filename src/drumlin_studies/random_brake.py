"""Random brakes with shoes and drums of every shape that a brake file can express.

A seed determines a brake. Sizes are drawn on logarithmic scales: drums of radius R from 20 mm to
2.8 m, linings with thicknesses of R/1000 to R/3 and arcs of 1 to 163 degrees, moduli over several
powers of ten. The actuation forces follow from usual pressures of linings. Clearances and misfits
are about as large as the compression of the lining by the forces. So in some brakes the whole
lining touches the drum, and in others a part of the lining.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.file import make_drum_brake_from_data, vary
from drumlin.fem.solve import solve
from drumlin.laws import self_locking_friction_of_hinged_shoe, solve_brake_by_sine_law

ELEMENTS_PER_LINING_OF_FRICTIONLESS_TEST = 4
"""Number of elements along a lining, on the mesh on which a drawn brake is tested for contact
without friction.
"""
ELEMENTS_PER_LINING_OF_SHAPE_KIND_CONTACT_TEST = 16
"""Number of elements along a lining, on the mesh on which a drawn brake is tested for contact with
friction.
"""
LARGEST_FRICTION_OVER_LOCKING_FRICTION = 0.7
"""Largest friction of a random brake, relative to the friction at which it locks itself by the sine
law.

The value is a judgement. Nearer to self-locking a small error of the friction causes a large error
of the torque, which grows without bound.
"""
FRICTION_FACTOR_OF_SHAPE_KIND_CONTACT_TEST = 1.2
"""Factor by which a random brake's friction is raised for a test, in which all shoes must touch the
drum.

The test uses finite elements, because the elastic brake may lock itself at a lower friction than
the rigid brake of the sine law. A brake that fails this test is drawn again.
"""
MOST_BRAKES_OF_SHAPE_KIND_DRAWN_PER_SEED = 400
"""Number of brakes that are drawn for one seed before the generator gives up with NoAnswer.

Extreme sizes make many draws impossible.
"""
DRAWN_SENSES_OF_ROTATION = ("clockwise", "counter-clockwise")
"""Senses of rotation to draw from. `_draw_self_locking_or_opposed_brake` tries them in this order.
"""

FunctionThatDrawsShapeKindData = Callable[[np.random.Generator], dict[str, Any]]
"""A function that draws the data of a brake file, without title, rotation and friction."""


def draw_random_brake(seed: int, kind: str | None = None) -> Brake:
    """The random brake of a seed.

    All shoes of a brake of FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND press on the drum, and its
    friction is zero or below the friction at which it locks itself. A brake of
    KINDS_THAT_LOCK_OR_NEVER_LOCK_WITH_FRICTION has one shoe, and its friction is 0.3, which the
    caller replaces. By the sine law a "locking" brake locks itself at a friction below 1.5, and an
    "opposed" brake never does.

    Parameters
    ----------
    seed : int
        The same seed always gives the same brake.
    kind : str, optional
        One of FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND or
        KINDS_THAT_LOCK_OR_NEVER_LOCK_WITH_FRICTION. By default the seed modulo the number of
        FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND chooses the kind.

    Raises
    ------
    NoAnswer
        No brake of the kind passes in MOST_BRAKES_OF_SHAPE_KIND_DRAWN_PER_SEED draws.
    """
    if kind in KINDS_THAT_LOCK_OR_NEVER_LOCK_WITH_FRICTION:
        return _draw_self_locking_or_opposed_brake(seed, str(kind))
    names = list(FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND)
    kind = names[seed % len(names)] if kind is None else kind
    for attempt in range(MOST_BRAKES_OF_SHAPE_KIND_DRAWN_PER_SEED):
        rng = np.random.default_rng([seed, names.index(kind), attempt])
        brake = _draw_brake_or_none(rng, kind, f"random {kind} {seed}")
        if brake is not None:
            return brake
    raise NoAnswer(
        f"no brake of kind {kind} from seed {seed} in "
        f"{MOST_BRAKES_OF_SHAPE_KIND_DRAWN_PER_SEED} attempts"
    )


def _draw_brake_or_none(rng: np.random.Generator, kind: str, title: str) -> Brake | None:
    """A random brake of a kind, or None if it is impossible or a shoe does not touch the drum.

    rng : generator of the random numbers; kind : one of
        FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND; title : title of the brake.
    """
    data = FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND[kind](rng)
    drawn_friction, rotation = rng.uniform(0.02, 0.6), str(rng.choice(DRAWN_SENSES_OF_ROTATION))
    data |= {"title": title, "rotation": rotation, "friction": 0.1}
    without_friction = rng.random() < 0.12
    try:
        brake = make_drum_brake_from_data(data)
        locking = min(self_locking_friction_of_hinged_shoe(brake, shoe) for shoe in brake.shoes)
        friction = (
            0.0
            if without_friction
            else min(drawn_friction, LARGEST_FRICTION_OVER_LOCKING_FRICTION * locking)
        )
        brake = vary(brake, {"friction": float(f"{friction:.4g}")})
        presses = _has_all_shoes_in_contact(
            brake, FRICTION_FACTOR_OF_SHAPE_KIND_CONTACT_TEST
        ) and _has_all_shoes_in_contact(brake, 1.0)
    except (BadInput, NoAnswer):
        return None
    return brake if presses else None


def _has_all_shoes_in_contact(brake: Brake, factor: float) -> bool:
    """Whether all shoes of a brake touch the drum if its friction is multiplied by a factor."""
    varied = vary(brake, {"friction": factor * brake.friction})
    response = solve(varied, elements=ELEMENTS_PER_LINING_OF_SHAPE_KIND_CONTACT_TEST)
    return all(shoe.contact_arcs for shoe in response.shoes)


def _draw_number_between_powers_of_ten(rng: np.random.Generator, low: float, high: float) -> float:
    """A random number between 10^low and 10^high, uniform in its logarithm, of four digits."""
    return float(f"{10 ** rng.uniform(low, high):.4g}")


def _draw_material_data(rng: np.random.Generator, low: float, high: float) -> dict[str, float]:
    """A random material whose Young's modulus lies between 10^low and 10^high Pa."""
    return {
        "E": _draw_number_between_powers_of_ten(rng, low, high),
        "nu": round(float(rng.uniform(0.0, 0.45)), 3),
    }


class RangesOfRandomArcShoe(NamedTuple):
    """Ranges from which a shoe is drawn whose body is an arc along the drum.

    Attributes
    ----------
    body, backing : bool
        Whether the shoe has an elastic body, and a backing behind its lining.
    arc : tuple of float
        Smallest and largest arc of the lining [rad].
    thickness, body_thickness : tuple of float
        Smallest and largest decimal logarithm of the thickness of lining and body, divided by the
        drum's radius.
    modulus, body_modulus : tuple of float
        Smallest and largest decimal logarithm of Young's modulus [Pa] of the lining and of the
        body.
    largest_angle_from_hinge : float
        Largest angle [rad] from the hinge to the far end of the lining.
    """

    body: bool = True
    backing: bool = False
    arc: tuple[float, float] = (0.35, 2.6)
    thickness: tuple[float, float] = (-2.0, -1.0)
    modulus: tuple[float, float] = (7.7, 9.5)
    body_modulus: tuple[float, float] = (10.0, 11.5)
    body_thickness: tuple[float, float] = (-1.3, -0.6)
    largest_angle_from_hinge: float = 2.9


def _draw_arc_shoe_data(
    rng: np.random.Generator, R: float, ranges: RangesOfRandomArcShoe
) -> dict[str, Any]:
    """The data of a random hinged shoe whose body is an arc along the drum.

    R : radius of the drum [m]; ranges : ranges of the shoe's sizes.
    """
    u = rng.uniform
    inside = bool(rng.random() < 0.6)
    hinge_angle = u(-3, 3)
    # 1 if the lining lies at larger angles than the hinge, -1 if it lies at smaller angles.
    hand = int(rng.choice([-1, 1]))
    gap = u(0.05, 0.35)
    span = min(math.exp(u(*np.log(ranges.arc))), ranges.largest_angle_from_hinge - gap)
    far = hinge_angle + hand * (gap + span)
    start, end = sorted([hinge_angle + hand * gap, far])
    # Width and thickness of the lining are random fractions of the drum's radius.
    width = R * _draw_number_between_powers_of_ten(rng, -0.9, -0.2)
    thickness = R * _draw_number_between_powers_of_ten(rng, *ranges.thickness)
    shoe: dict[str, Any] = {
        "name": "shoe",
        "side": "internal" if inside else "external",
        "hinge": {"radius": R * (u(0.5, 0.9) if inside else u(1.1, 1.5)), "angle": hinge_angle},
        "lining": {
            "start": start,
            "end": end,
            "thickness": thickness,
            "width": width,
            "material": _draw_material_data(rng, *ranges.modulus),
        },
        "actuation": _draw_point_and_direction_of_actuation_force(rng, R, far, hand, inside=inside),
    }
    if ranges.backing:
        shoe["backing"] = {
            "thickness": R * _draw_number_between_powers_of_ten(rng, -2.3, -1.0),
            "material": _draw_material_data(rng, 8.7, 11.3),
        }
    if ranges.body:
        # The body is longer than the lining at both ends. Towards the hinge it extends over 0.1 to
        # 0.9 of the angle between lining and hinge.
        overhang = [gap * u(0.1, 0.9), u(0.005, 0.12)][::hand]
        ends = {"start": start - overhang[0], "end": end + overhang[1]}
        shoe["body"] = ends | _draw_section_data_of_arc_body(rng, R, width, ranges)
    shoe["actuation"]["force"] = _draw_actuation_force(rng, shoe, R)
    return shoe


def _draw_section_data_of_arc_body(
    rng: np.random.Generator, R: float, width: float, ranges: RangesOfRandomArcShoe
) -> dict[str, Any]:
    """The thickness, width and material of a random body along the drum.

    Parameters
    ----------
    rng : Generator
        Generator of random numbers.
    R : float
        Radius of the drum [m].
    width : float
        Width of the lining [m].
    ranges : RangesOfRandomArcShoe
        Ranges of the shoe's sizes.
    """
    return {
        "thickness": R * _draw_number_between_powers_of_ten(rng, *ranges.body_thickness),
        "width": width * _draw_number_between_powers_of_ten(rng, -0.8, 0.2),
        "material": _draw_material_data(rng, *ranges.body_modulus),
    }


def _draw_point_and_direction_of_actuation_force(
    rng: np.random.Generator, R: float, far: float, hand: int, *, inside: bool
) -> dict[str, Any]:
    """Direction and point of a random actuation force at an arc shoe's end, far from the hinge.

    Parameters
    ----------
    rng : Generator
        Generator of random numbers.
    R : float
        Radius of the drum [m].
    far : float
        Angle of the lining's end away from the hinge [rad].
    hand : int
        1 if this end lies at the larger angle, -1 if it lies at the smaller one.
    inside : bool
        Whether the shoe lies inside the drum.
    """
    u = rng.uniform
    return {
        "direction": far + (0 if inside else math.pi) + u(-0.6, 0.6),
        "point": {
            "radius": R * (u(0.6, 0.95) if inside else u(1.05, 1.5)),
            "angle": far + hand * u(0.0, 0.15),
        },
    }


def _draw_actuation_force(rng: np.random.Generator, shoe: dict[str, Any], R: float) -> float:
    """A random actuation force [N] for the data of a shoe on a drum of radius R [m].

    If a third of the lining carried the force alone, the pressure there would be 1e-4 to 1e-2 of
    the lining's modulus.
    """
    lining = shoe["lining"]
    pressure = lining["material"]["E"] * _draw_number_between_powers_of_ten(rng, -4, -2)
    return float(f"{pressure * R * (lining['end'] - lining['start']) * lining['width'] / 3:.4g}")


def _mean_lining_compression_due_to_force(shoe: dict[str, Any], R: float) -> float:
    """The mean compression [m] of a lining of thickness t by the actuation force F: F t/(E area).

    shoe : data of the shoe; R : radius of the drum [m].
    """
    lining = shoe["lining"]
    area = R * (lining["end"] - lining["start"]) * lining["width"]
    return shoe["actuation"]["force"] / area * lining["thickness"] / lining["material"]["E"]


class _RandomBeamAxis(NamedTuple):
    """The axis of a straight beam outside the drum.

    Attributes
    ----------
    turn : float
        Angle [rad] of the normal of the beam that goes through the centre of the drum.
    hand : int
        1 if the axis runs from the hinge towards growing angles, -1 if towards falling angles.
    distance : float
        Distance of the axis from the centre of the drum [m].
    """

    turn: float
    hand: int
    distance: float

    def point_on_beam_axis_at_distance(self, along: float) -> dict[str, float]:
        """The axis point at a distance [m] from the axis point nearest to the drum's centre."""
        c, s = math.cos(self.turn), math.sin(self.turn)
        x = self.distance * c - self.hand * along * s
        return {"x": x, "y": self.distance * s + self.hand * along * c}


def _draw_straight_beam_shoe_data(rng: np.random.Generator, R: float) -> dict[str, Any]:
    """The data of the shoe of a random post brake.

    The shoe is a straight beam outside the drum, with a block between beam and lining.

    R : radius of the drum [m].
    """
    u = rng.uniform
    turn, hand = u(-math.pi, math.pi), int(rng.choice([-1, 1]))
    thickness = R * _draw_number_between_powers_of_ten(rng, -2.2, -1.1)
    depth = R * _draw_number_between_powers_of_ten(rng, -0.9, -0.35)
    back = R + thickness
    axis = _RandomBeamAxis(turn, hand, back + R * u(0.04, 0.3) + depth / 2)
    half = u(0.25, 0.85)
    first, last = -half * u(0.6, 1.0), half * u(0.6, 1.0)
    # Distances [m] along the beam of the hinge and of the actuation, on both sides of the beam's
    # point nearest to the drum's centre.
    to_hinge = back * math.sin(-first) + R * u(0.15, 0.8)
    to_actuation = back * math.sin(last) + R * u(0.15, 0.8)
    # The arc of the lining contains the angle of the beam's normal.
    start, end = sorted([turn + hand * first, turn + hand * last])
    width = R * _draw_number_between_powers_of_ten(rng, -0.9, -0.3)
    shoe: dict[str, Any] = {
        "name": "shoe",
        "side": "external",
        "hinge": axis.point_on_beam_axis_at_distance(-to_hinge),
        "lining": {
            "start": start,
            "end": end,
            "thickness": thickness,
            "width": width,
            "material": _draw_material_data(rng, 7.7, 9.3),
        },
        "backing": {"thickness": 0.2 * R, "material": _draw_material_data(rng, 8.5, 11.0)},
        "body": {
            "shape": "beam",
            "thickness": depth,
            "width": width * _draw_number_between_powers_of_ten(rng, -0.9, 0.2),
            "material": _draw_material_data(rng, 9.8, 11.4),
        },
        "actuation": {
            "direction": turn + math.pi + u(-0.4, 0.4),
            "point": axis.point_on_beam_axis_at_distance(to_actuation),
        },
    }
    shoe["actuation"]["force"] = _draw_actuation_force(rng, shoe, R)
    return shoe


def _mirror_shoe_data(shoe: dict[str, Any], about: float) -> dict[str, Any]:
    """The data of the mirror image of a shoe.

    about : angle [rad] of the mirror line, which goes through the centre of the drum.
    """
    c, s = math.cos(2 * about), math.sin(2 * about)

    def mirror_point_about_drum_diameter(point: dict[str, float]) -> dict[str, float]:
        """The mirror image of a point, in the same kind of coordinates as the point."""
        if "radius" in point:
            return {"radius": point["radius"], "angle": 2 * about - point["angle"]}
        return {"x": c * point["x"] + s * point["y"], "y": s * point["x"] - c * point["y"]}

    def mirror_start_and_end_of_lining_or_body(part: dict[str, Any]) -> dict[str, Any]:
        """The data of a lining or body with its start and end angles mirrored."""
        if "start" not in part:
            return part
        return part | {"start": 2 * about - part["end"], "end": 2 * about - part["start"]}

    actuation = shoe["actuation"]
    other = shoe | {
        "name": "other",
        "hinge": mirror_point_about_drum_diameter(shoe["hinge"]),
        "lining": mirror_start_and_end_of_lining_or_body(shoe["lining"]),
        "actuation": actuation
        | {
            "direction": 2 * about - actuation["direction"],
            "point": mirror_point_about_drum_diameter(actuation["point"]),
        },
    }
    return other | (
        {"body": mirror_start_and_end_of_lining_or_body(shoe["body"])} if "body" in shoe else {}
    )


def _draw_drum_ring_data(rng: np.random.Generator, R: float, width: float) -> dict[str, Any]:
    """The data of a random elastic drum ring, for a drum radius R [m] and a lining width [m]."""
    return {
        "thickness": R * _draw_number_between_powers_of_ten(rng, -1.5, -0.7),
        "width": width * _draw_number_between_powers_of_ten(rng, -0.2, 0.3),
        "material": _draw_material_data(rng, 10.0, 11.4),
        "support": str(rng.choice(["fixed", "free"])),
    }


def _draw_drum_radius(rng: np.random.Generator) -> float:
    """A random radius of a drum [m], between 20 mm and 2.8 m."""
    return _draw_number_between_powers_of_ten(rng, -1.7, 0.45)


def _draw_data_of_brake_with_elastic_arc_shoe(rng: np.random.Generator) -> dict[str, Any]:
    """The data of a brake with one hinged shoe whose elastic body is an arc along the drum."""
    R = _draw_drum_radius(rng)
    return {"drum": {"radius": R}, "shoe": [_draw_arc_shoe_data(rng, R, RangesOfRandomArcShoe())]}


def _draw_data_of_brake_with_backed_shoe(rng: np.random.Generator) -> dict[str, Any]:
    """The data of a brake with one shoe that has a backing and an elastic body along the drum."""
    R = _draw_drum_radius(rng)
    return {
        "drum": {"radius": R},
        "shoe": [_draw_arc_shoe_data(rng, R, RangesOfRandomArcShoe(backing=True))],
    }


def _draw_data_of_brake_with_rigid_shoe(rng: np.random.Generator) -> dict[str, Any]:
    """The data of a brake with one rigid shoe, which has a backing with probability 1/2."""
    R = _draw_drum_radius(rng)
    ranges = RangesOfRandomArcShoe(body=False, backing=rng.random() < 0.5)
    return {"drum": {"radius": R}, "shoe": [_draw_arc_shoe_data(rng, R, ranges)]}


def _draw_data_of_brake_with_straight_beam(rng: np.random.Generator) -> dict[str, Any]:
    """The data of a brake with one post, a straight beam with a block."""
    R = _draw_drum_radius(rng)
    return {"drum": {"radius": R}, "shoe": [_draw_straight_beam_shoe_data(rng, R)]}


def _draw_data_of_brake_with_beams_on_elastic_ring(rng: np.random.Generator) -> dict[str, Any]:
    """The data of a brake with one post, or two opposite posts, on an elastic drum ring."""
    R = _draw_drum_radius(rng)
    shoe = _draw_straight_beam_shoe_data(rng, R)
    middle = 0.5 * (shoe["lining"]["start"] + shoe["lining"]["end"])
    shoes = [shoe, _mirror_shoe_data(shoe, middle + math.pi / 2)] if rng.random() < 0.4 else [shoe]
    return {
        "drum": {"radius": R, "ring": _draw_drum_ring_data(rng, R, shoe["lining"]["width"])},
        "shoe": shoes,
    }


def _draw_data_of_brake_with_shoe_on_elastic_ring(rng: np.random.Generator) -> dict[str, Any]:
    """The data of a brake with one elastic shoe along an elastic drum ring."""
    R = _draw_drum_radius(rng)
    shoe = _draw_arc_shoe_data(rng, R, RangesOfRandomArcShoe())
    return {
        "drum": {"radius": R, "ring": _draw_drum_ring_data(rng, R, shoe["lining"]["width"])},
        "shoe": [shoe],
    }


def _draw_data_of_brake_with_two_shoes_on_elastic_ring(rng: np.random.Generator) -> dict[str, Any]:
    """The data of a brake with two shoes on an elastic drum ring.

    The shoes share their hinge and are mirror images of each other.
    """
    R = _draw_drum_radius(rng)
    shoe = _draw_arc_shoe_data(
        rng, R, RangesOfRandomArcShoe(arc=(0.3, 2.2), largest_angle_from_hinge=2.6)
    )
    shoes = [shoe, _mirror_shoe_data(shoe, shoe["hinge"]["angle"])]
    return {
        "drum": {"radius": R, "ring": _draw_drum_ring_data(rng, R, shoe["lining"]["width"])},
        "shoe": shoes,
    }


def _draw_shoe_data_sometimes_with_backing(rng: np.random.Generator, R: float) -> dict[str, Any]:
    """The data of a shoe along a drum of radius R [m], with a backing with probability 0.3."""
    return _draw_arc_shoe_data(rng, R, RangesOfRandomArcShoe(backing=rng.random() < 0.3))


def _draw_data_of_brake_with_lining_misfit(rng: np.random.Generator) -> dict[str, Any]:
    """The data of a brake whose lining does not fit the drum.

    The misfit of the lining is an even clearance, a table of clearances, a taper, another radius
    with an offset, or blocks of different heights.
    """
    R, u = _draw_drum_radius(rng), rng.uniform
    on_post = rng.random() < 0.25
    shoe = (
        _draw_straight_beam_shoe_data(rng, R)
        if on_post
        else _draw_shoe_data_sometimes_with_backing(rng, R)
    )
    lining, size = shoe["lining"], _mean_lining_compression_due_to_force(shoe, R)
    how = rng.integers(5)
    if how == 0:
        lining["clearance"] = size * u(0.0, 2.0)
    elif how == 1:
        angles = np.linspace(lining["start"], lining["end"], int(rng.integers(2, 6)))
        lining["clearance"] = [[float(x), float(size * u(0, 2))] for x in angles]
    elif how == 2:
        lining["misfit"] = {"taper": float(size * u(-2, 2))}
    elif how == 3:
        lining["misfit"] = {
            "radius": float(R + size * u(-4, 4)),
            "offset": {"x": float(size * u(-1, 1)), "y": 0.0},
        }
    else:
        places = np.linspace(lining["start"], lining["end"], 4)[1:-1]
        lining["misfit"] = {"blocks": [[float(x), float(size * u(0, 1))] for x in places]}
    return {"drum": {"radius": R}, "shoe": [shoe]}


def _draw_data_of_brake_with_drum_out_of_round(rng: np.random.Generator) -> dict[str, Any]:
    """The data of a brake whose drum is out of round by one to three harmonics of random orders."""
    R, u = _draw_drum_radius(rng), rng.uniform
    shoe = _draw_shoe_data_sometimes_with_backing(rng, R)
    size = _mean_lining_compression_due_to_force(shoe, R)
    lobes = []
    for _ in range(int(rng.integers(1, 4))):
        lobe = {
            "order": int(rng.integers(0, 9)),
            "amplitude": float(size * u(-1, 1)),
            "phase": float(u(0, 6)),
        }
        lobes.append(lobe)
    return {"drum": {"radius": R, "out_of_round": lobes, "angle": float(u(0, 6))}, "shoe": [shoe]}


def _draw_data_of_brake_with_short_contact(rng: np.random.Generator) -> dict[str, Any]:
    """The data of a brake with a short contact: about 0.4 to 8 degrees by Hertz's formula.

    The lining has another radius than the drum.
    """
    R, u = _draw_drum_radius(rng), rng.uniform
    ranges = RangesOfRandomArcShoe(arc=(0.35, 1.2), thickness=(-1.3, -0.6), body=rng.random() < 0.6)
    shoe = _draw_arc_shoe_data(rng, R, ranges)
    lining, inside = shoe["lining"], shoe["side"] == "internal"
    r = R * (1 - u(0.003, 0.04)) if inside else R * (1 + u(0.003, 0.04))
    lining["misfit"] = {"radius": float(r)}
    # Half of a contact's length [m]. Hertz's formula gives the force that causes this length. The
    # force of the brake is 0.5 to 1 times as large.
    half = R * math.radians(0.5 * _draw_number_between_powers_of_ten(rng, -0.3, 0.9))
    E = lining["material"]["E"]
    load = math.pi / 4 * half**2 * E * abs(1 / r - 1 / R) * lining["width"]
    shoe["actuation"]["force"] = float(f"{load * u(0.5, 1.0):.4g}")
    return {"drum": {"radius": R}, "shoe": [shoe]}


def _draw_data_of_brake_with_extreme_dimensions(rng: np.random.Generator) -> dict[str, Any]:
    """The data of a brake whose shoe is drawn from very wide ranges.

    Stiffnesses, thicknesses and arcs may be extremely small or large.
    """
    R = _draw_drum_radius(rng)
    ranges = RangesOfRandomArcShoe(
        backing=rng.random() < 0.4,
        arc=(0.02, 2.85),
        thickness=(-3.0, -0.48),
        modulus=(6.0, 12.0),
        body_modulus=(7.0, 13.0),
        body_thickness=(-2.5, -0.5),
    )
    return {"drum": {"radius": R}, "shoe": [_draw_arc_shoe_data(rng, R, ranges)]}


FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND: dict[str, FunctionThatDrawsShapeKindData] = {
    "arc": _draw_data_of_brake_with_elastic_arc_shoe,
    "backed": _draw_data_of_brake_with_backed_shoe,
    "rigid": _draw_data_of_brake_with_rigid_shoe,
    "post": _draw_data_of_brake_with_straight_beam,
    "post on ring": _draw_data_of_brake_with_beams_on_elastic_ring,
    "arc on ring": _draw_data_of_brake_with_shoe_on_elastic_ring,
    "linings on ring": _draw_data_of_brake_with_two_shoes_on_elastic_ring,
    "misfit": _draw_data_of_brake_with_lining_misfit,
    "out of round": _draw_data_of_brake_with_drum_out_of_round,
    "small contact": _draw_data_of_brake_with_short_contact,
    "extreme": _draw_data_of_brake_with_extreme_dimensions,
}
"""Function that draws the data of a brake, by the kind of the brake.

The order of the kinds decides which seed draws which kind.
"""
KINDS_THAT_LOCK_OR_NEVER_LOCK_WITH_FRICTION = ("locking", "opposed")
"""Kinds of brakes with one shoe: the shoe locks itself at some friction, or at no friction."""


def _draw_self_locking_or_opposed_brake(seed: int, kind: str, attempt: int = 0) -> Brake:
    """A random brake of one of KINDS_THAT_LOCK_OR_NEVER_LOCK_WITH_FRICTION.

    Brakes are drawn until a brake is of this kind in one of the two senses of rotation.

    attempt : number of draws so far.
    """
    rng = np.random.default_rng([seed, attempt])
    data = _draw_brake_data_with_one_shoe(rng, seed)
    try:
        for rotation in DRAWN_SENSES_OF_ROTATION:
            brake = make_drum_brake_from_data(data | {"rotation": rotation})
            locking = self_locking_friction_of_hinged_shoe(brake, brake.shoes[0])
            is_of_kind = locking < 1.5 if kind == "locking" else math.isinf(locking)
            if is_of_kind and _has_contact_without_friction(brake, locking):
                return brake
    except (BadInput, NoAnswer):
        pass
    return _draw_self_locking_or_opposed_brake(seed, kind, attempt + 1)


def _has_contact_without_friction(brake: Brake, locking: float) -> bool:
    """Whether the shoe of a brake touches the drum without friction, by finite elements.

    locking : friction at which the brake locks itself by the sine law. Raises NoAnswer if the sine
    law has no answer.
    """
    # The sine law raises NoAnswer if the shoe is not pressed on the drum or the clearance is
    # uneven.
    solve_brake_by_sine_law(vary(brake, {"friction": 0.1 * min(locking, 1.0)}))
    frictionless = brake.model_copy(update={"friction_as_written": 0.0})
    response = solve(frictionless, elements=ELEMENTS_PER_LINING_OF_FRICTIONLESS_TEST)
    return bool(response.shoes[0].contact_arcs)


def _draw_brake_data_with_one_shoe(rng: np.random.Generator, seed: int) -> dict[str, Any]:
    """The data of a random brake with one shoe on a drum of radius 150 mm.

    The data have no sense of rotation.
    """
    u, R, inside = rng.uniform, 0.15, bool(rng.random() < 0.6)
    hinge_angle, hand = u(-3, 3), rng.choice([-1, 1])
    gap, arc = u(0.05, 0.4), u(0.4, 2.4)
    start, end = sorted([hinge_angle + hand * gap, hinge_angle + hand * (gap + arc)])
    far = hinge_angle + hand * (gap + arc)
    even_clearance = u(-2e-4, 1e-3) * R
    # A table of clearances. The lining gets no clearance, an even clearance or this table, by
    # chance.
    table = [[x, u(-2e-4, 1e-3) * R] for x in np.linspace(start, end, 5).tolist()]
    shoe: dict[str, Any] = {
        "name": "shoe",
        "side": "internal" if inside else "external",
        "hinge": {"radius": R * (u(0.25, 0.95) if inside else u(1.05, 1.6)), "angle": hinge_angle},
        "lining": {
            "start": start,
            "end": end,
            "thickness": R * 10 ** u(-2, -0.7),
            "width": 0.04,
            "material": {"E": 10 ** u(7.7, 9.7), "nu": u(0, 0.45)},
            "clearance": [0.0, even_clearance, table][rng.integers(3)],
        },
        "actuation": {
            "force": 10 ** u(2, 5),
            "direction": far + (0 if inside else math.pi) + u(-0.9, 0.9),
            "point": {"radius": R * (u(0.5, 1) if inside else u(1, 1.6)), "angle": far},
        },
    }
    if rng.random() < 0.75:
        shoe["body"] = {
            "thickness": R * u(0.03, 0.25),
            "width": 0.04,
            "start": start - gap / 2,
            "end": end + gap / 2,
            "material": {"E": 10 ** u(9.7, 11.5), "nu": 0.3},
        }
    return {"title": f"random {seed}", "friction": 0.3, "drum": {"radius": R}, "shoe": [shoe]}
