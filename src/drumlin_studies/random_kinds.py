"""Random brakes whose shoes are supported and actuated in every possible way.

A seed determines a brake. A shoe is drawn with its middle near the x axis. Then the whole brake is
turned and mirrored at random. Linings, bodies and forces have the sizes of real brakes: drums of
radius R = 60 mm to 1.2 m, linings with thicknesses of R/60 to R/8, moduli from 1e8 to 1e9 Pa.
`mirror_turn_and_shift_brake` and `brake_with_scaled_lengths_and_moduli` turn, mirror, shift and
scale a given brake.
"""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.file import make_validated_brake_part, vary
from drumlin.brake.plane_brake import make_drum_or_plane_brake_from_data
from drumlin.fem.solve import solve
from drumlin.laws import solve_brake_by_its_rigid_shoe_law
from drumlin_studies.random_brake import (
    FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND,
    draw_random_brake,
)

MOST_BRAKES_OF_SUPPORT_KIND_DRAWN_PER_SEED = 200
"""Number of brakes that are drawn for one seed before the generator gives up with NoAnswer."""
FRICTION_FACTOR_OF_SUPPORT_KIND_CONTACT_TEST = 1.2
"""Factor by which a random brake's friction is raised for a test, in which all shoes must touch the
drum.

A brake that locks itself below the raised friction is drawn again.
"""
ELEMENTS_PER_LINING_OF_SUPPORT_KIND_TEST = 10
"""Number of elements along a lining, on the mesh on which a drawn brake is tested for contact."""
RandomNumberGenerator = np.random.Generator
"""The generator from which random numbers are drawn."""
FunctionThatDrawsSupportKindData = Callable[[RandomNumberGenerator], dict[str, Any]]
"""A function that draws the data of a brake file, without title and friction."""


def draw_random_brake_of_support_kind(
    seed: int, kind: str | None = None, *, rigid: bool = False
) -> Brake:
    """The random brake of a seed and a kind of support and actuation.

    All shoes press on the drum, even at FRICTION_FACTOR_OF_SUPPORT_KIND_CONTACT_TEST times the
    friction of the brake.

    Parameters
    ----------
    seed : int
        The same seed always gives the same brake.
    kind : str, optional
        One of FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND. By default the seed modulo their
        number chooses the kind.
    rigid : bool
        Whether the shoes are rigid, with thin linings of the same thickness and material.

    Raises
    ------
    NoAnswer
        No brake of the kind passes in MOST_BRAKES_OF_SUPPORT_KIND_DRAWN_PER_SEED draws.
    """
    names = list(FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND)
    kind = names[seed % len(names)] if kind is None else kind
    for attempt in range(MOST_BRAKES_OF_SUPPORT_KIND_DRAWN_PER_SEED):
        rng = np.random.default_rng([seed, names.index(kind), attempt])
        data = FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND[kind](rng) | {
            "title": f"random {kind} {seed}"
        }
        data["friction"] = round(float(rng.uniform(0.03, 0.5)), 4)
        turn, mirrored = float(rng.uniform(-3, 3)), bool(rng.random() < 0.5)
        try:
            brake = make_drum_or_plane_brake_from_data(
                _brake_data_with_rigid_shoes(data) if rigid else data
            )
            brake = mirror_turn_and_shift_brake(
                brake, turn=0.0 if brake.surface.is_plane_and_not_drum else turn, mirrored=mirrored
            )
            for friction in (
                brake.friction,
                FRICTION_FACTOR_OF_SUPPORT_KIND_CONTACT_TEST * brake.friction,
            ):
                _require_contact_of_all_shoes(vary(brake, {"friction": friction}))
            return brake
        except (BadInput, NoAnswer):
            continue
    raise NoAnswer(
        f"no brake of kind {kind} from seed {seed} in "
        f"{MOST_BRAKES_OF_SUPPORT_KIND_DRAWN_PER_SEED} attempts"
    )


def draw_random_brake_of_kind(seed: int, kind: str) -> Brake:
    """The random brake of a seed and a kind.

    The kind is one of FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND or of
    FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND.

    Raises NoAnswer if no brake of the kind can be drawn from the seed.
    """
    if kind in FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND:
        return draw_random_brake(seed, kind)
    return draw_random_brake_of_support_kind(seed, kind)


def _require_contact_of_all_shoes(brake: Brake) -> None:
    """Raise NoAnswer unless all shoes touch by the rigid-shoe law and by finite elements."""
    by_law = solve_brake_by_its_rigid_shoe_law(brake)
    by_elements = solve(brake, elements=ELEMENTS_PER_LINING_OF_SUPPORT_KIND_TEST)
    if not all(shoe.contact_arcs for shoe in (*by_law.shoes, *by_elements.shoes)):
        raise NoAnswer("a shoe does not press")


def _brake_data_with_rigid_shoes(data: dict[str, Any]) -> dict[str, Any]:
    """The data of a brake, changed to rigid shoes with thin linings that fit the drum."""
    size = data.get("drum", {"radius": 0.1})["radius"]
    # All linings get one thickness and one material, because the rigid-shoe law of a cam needs
    # equal linings.
    equal = {"thickness": size / 300, "material": data["shoe"][0]["lining"]["material"]}
    fits = {"clearance": 0.0, "misfit": {}}
    shoes = []
    for shoe in data["shoe"]:
        without_body = {key: part for key, part in shoe.items() if key != "body"}
        shoes.append(without_body | {"lining": shoe["lining"] | equal | fits})
    return data | {"shoe": shoes}


def draw_number_uniform_in_logarithm(rng: RandomNumberGenerator, low: float, high: float) -> float:
    """A random number between low and high, uniform in its logarithm, of four digits."""
    return float(f"{math.exp(rng.uniform(math.log(low), math.log(high))):.4g}")


def _draw_drum_brake_data(
    rng: RandomNumberGenerator,
    shoes: Callable[[RandomNumberGenerator, float], list[dict[str, Any]]],
    **more: Any,
) -> dict[str, Any]:
    """The data of a brake with a drum of random radius and a random sense of rotation.

    Parameters
    ----------
    rng : numpy.random.Generator
        Generator of the random numbers.
    shoes : function
        Draws the data of the shoes for a generator and the radius of the drum [m].
    **more
        Further keys of the brake file.
    """
    R = draw_number_uniform_in_logarithm(rng, 0.06, 1.2)
    rotation = str(rng.choice(["clockwise", "counter-clockwise"]))
    return {"rotation": rotation, "drum": {"radius": R}, "shoe": shoes(rng, R)} | more


def _draw_unsupported_shoe_data(
    rng: RandomNumberGenerator, R: float, *, inside: bool = True
) -> dict[str, Any]:
    """The data of a random shoe near the x axis, without support and actuation.

    The middle of the lining is at most 0.1 rad from the x axis. The shoe has an elastic body with
    probability 0.7; without a body it is rigid.

    R : radius of the drum [m]; inside : whether the shoe lies inside the drum.
    """
    u = rng.uniform
    half, middle, width = u(0.45, 1.0), u(-0.1, 0.1), R * u(0.2, 0.6)
    thickness = R * draw_number_uniform_in_logarithm(rng, 1 / 60, 1 / 8)
    material = {
        "E": draw_number_uniform_in_logarithm(rng, 1e8, 1e9),
        "nu": round(float(u(0.1, 0.4)), 3),
    }
    shoe: dict[str, Any] = {
        "name": "first",
        "side": "internal" if inside else "external",
        "lining": {
            "start": middle - half,
            "end": middle + half,
            "thickness": thickness,
            "width": width,
            "material": material,
        },
    }
    if rng.random() < 0.7:
        shoe["body"] = {
            "thickness": R * u(0.06, 0.2),
            "width": width,
            "start": middle - half - u(0.03, 0.2),
            "end": middle + half + u(0.03, 0.2),
            "material": {"E": draw_number_uniform_in_logarithm(rng, 7e10, 2.1e11), "nu": 0.3},
        }
    return shoe


def _draw_actuation_data(
    rng: RandomNumberGenerator,
    shoe: dict[str, Any],
    R: float,
    direction: float,
    at: tuple[float, float],
) -> dict[str, Any]:
    """The data of a random actuation force, which would strain the whole lining by 1e-4 to 3e-3.

    Parameters
    ----------
    rng : numpy.random.Generator
        Generator of the random numbers.
    shoe : dict
        The data of the shoe, with its lining.
    R : float
        Radius of the drum [m].
    direction : float
        Direction of the force [rad].
    at : tuple of float
        Coordinates x and y of the point where the force acts, divided by the drum's radius.
    """
    lining = shoe["lining"]
    area = R * (lining["end"] - lining["start"]) * lining["width"]
    force = float(
        f"{lining['material']['E'] * area * draw_number_uniform_in_logarithm(rng, 1e-4, 3e-3):.4g}"
    )
    return {"force": force, "direction": direction, "point": {"x": R * at[0], "y": R * at[1]}}


def _point_at_fractions_of_drum_radius(R: float, x: float, y: float) -> dict[str, float]:
    """The data of the point (R x, R y), for fractions x and y of the drum's radius R [m]."""
    return {"x": R * x, "y": R * y}


def _draw_data_of_shoe_on_abutment(
    rng: RandomNumberGenerator, R: float, *, rough: bool
) -> dict[str, Any]:
    """The data of a random internal shoe whose foot (the end of the shoe) slides on an abutment.

    R : radius of the drum [m]; rough : whether the abutment has friction.
    """
    u, shoe = rng.uniform, _draw_unsupported_shoe_data(rng, R)
    face = {
        "point": _point_at_fractions_of_drum_radius(R, u(0.1, 0.4), -u(0.65, 0.85)),
        "direction": u(-0.3, 0.3),
    }
    face |= {"friction": round(float(u(0.05, 0.4)), 3)} if rough else {}
    push = _draw_actuation_data(rng, shoe, R, u(-0.2, 0.2), (u(0.1, 0.4), u(0.65, 0.85)))
    return shoe | {"abutment": face, "actuation": push}


def _draw_data_of_hinged_shoe(rng: RandomNumberGenerator, R: float) -> dict[str, Any]:
    """The data of a random internal shoe on a hinge; R : radius of the drum [m]."""
    u, shoe = rng.uniform, _draw_unsupported_shoe_data(rng, R)
    push = _draw_actuation_data(rng, shoe, R, u(-0.2, 0.2), (u(0.1, 0.4), u(0.65, 0.85)))
    return shoe | {
        "hinge": _point_at_fractions_of_drum_radius(R, u(0.05, 0.3), -u(0.65, 0.85)),
        "actuation": push,
    }


def _draw_data_of_pivoted_shoe(rng: RandomNumberGenerator, R: float) -> dict[str, Any]:
    """The data of a random shoe on the pivot of a hinged lever; R : radius of the drum [m]."""
    u, inside = rng.uniform, bool(rng.random() < 0.3)
    shoe = _draw_unsupported_shoe_data(rng, R, inside=inside)
    if inside:
        lever = _point_at_fractions_of_drum_radius(R, u(-0.3, 0.3), -u(0.6, 0.9))
        pivot = _point_at_fractions_of_drum_radius(R, u(0.55, 0.85), u(-0.1, 0.1))
        push = _draw_actuation_data(rng, shoe, R, u(-0.2, 0.2), (u(0.0, 0.3), u(0.6, 0.85)))
    else:
        lever = _point_at_fractions_of_drum_radius(R, u(1.1, 1.3), -u(1.1, 1.5))
        pivot = _point_at_fractions_of_drum_radius(R, u(1.1, 1.3), u(-0.1, 0.1))
        push = _draw_actuation_data(
            rng, shoe, R, math.pi + u(-0.2, 0.2), (u(1.1, 1.4), u(1.2, 1.7))
        )
    return shoe | {"hinge": lever, "pivot": pivot, "actuation": push}


def _draw_data_of_guided_shoe(rng: RandomNumberGenerator, R: float) -> dict[str, Any]:
    """The data of a random shoe that can only move along a guide.

    R : radius of the drum [m].
    """
    u, inside = rng.uniform, bool(rng.random() < 0.5)
    shoe = _draw_unsupported_shoe_data(rng, R, inside=inside)
    guide = (0.0 if inside else math.pi) + u(-0.3, 0.3)
    direction = guide + u(-0.2, 0.2)
    at = u(0.7, 0.9) if inside else u(1.1, 1.3), u(-0.15, 0.15)
    push = _draw_actuation_data(rng, shoe, R, direction, at)
    return shoe | {"guide": {"direction": guide}, "actuation": push}


def _shoe_data_without_actuation_force(shoe: dict[str, Any]) -> dict[str, Any]:
    """The data of a shoe without its actuation force; point and direction of the force stay."""
    actuation = {key: value for key, value in shoe["actuation"].items() if key != "force"}
    return shoe | {"actuation": actuation}


def mirror_shoe_data_to_other_drum_side(shoe: dict[str, Any]) -> dict[str, Any]:
    """The data of a shoe mirrored about the y axis of the drum, with the name "second".

    The mirror image lies on the other side of the drum.
    """
    return _mirror_turn_and_shift_shoe_data(shoe | {"name": "second"}, math.pi, mirrored=True)


def _draw_data_of_cam_brake(rng: RandomNumberGenerator) -> dict[str, Any]:
    """The data of a brake whose two shoes a cam spreads, both on hinges or both on abutments."""
    on_hinges = rng.random() < 0.6

    def draw_data_of_hinged_or_abutting_shoe(
        rng: RandomNumberGenerator, R: float
    ) -> dict[str, Any]:
        """The data of one shoe, on a hinge or on an abutment, for a drum of radius R [m]."""
        if on_hinges:
            return _draw_data_of_hinged_shoe(rng, R)
        return _draw_data_of_shoe_on_abutment(rng, R, rough=bool(rng.random() < 0.5))

    data = _draw_drum_brake_data(
        rng,
        lambda rng, R: [
            draw_data_of_hinged_or_abutting_shoe(rng, R),
            mirror_shoe_data_to_other_drum_side(draw_data_of_hinged_or_abutting_shoe(rng, R)),
        ],
    )
    # The cam actuates both shoes. The forces that were drawn for the shoes are removed.
    force = 2 * min(shoe["actuation"]["force"] for shoe in data["shoe"])
    shoes = [_shoe_data_without_actuation_force(shoe) for shoe in data["shoe"]]
    return data | {"shoe": shoes, "actuation": {"force": force}}


def _draw_data_of_cylinder_brake(rng: RandomNumberGenerator) -> dict[str, Any]:
    """The data of a brake whose two shoes a hydraulic cylinder spreads.

    One shoe slides on an abutment with friction, the other has a hinge.
    """
    data = _draw_drum_brake_data(
        rng,
        lambda rng, R: [
            _draw_data_of_shoe_on_abutment(rng, R, rough=True),
            mirror_shoe_data_to_other_drum_side(_draw_data_of_hinged_shoe(rng, R)),
        ],
    )
    # The cylinder pushes both shoes with the smaller of the two forces that were drawn for them.
    force = min(shoe["actuation"]["force"] for shoe in data["shoe"])
    bore, efficiency = data["drum"]["radius"] / 5, 0.95
    drive = {
        "pressure": force / (math.pi * bore**2 / 4) / efficiency,
        "diameter": bore,
        "efficiency": efficiency,
    }
    return data | {
        "shoe": [_shoe_data_without_actuation_force(shoe) for shoe in data["shoe"]],
        "actuation": drive,
    }


def _draw_data_of_strut_brake(rng: RandomNumberGenerator) -> dict[str, Any]:
    """The data of a brake whose first shoe pushes the second, hinged shoe through a strut."""

    def draw_data_of_both_shoes(rng: RandomNumberGenerator, R: float) -> list[dict[str, Any]]:
        """The data of both shoes, for a drum of radius R [m]; only the first has an actuation."""
        # The second shoe is mirrored together with an actuation, which is then removed: the strut
        # pushes this shoe.
        u, second = rng.uniform, _draw_unsupported_shoe_data(rng, R)
        second |= {
            "hinge": _point_at_fractions_of_drum_radius(R, u(0.05, 0.3), u(0.65, 0.85)),
            "actuation": _draw_actuation_data(rng, second, R, 0.0, (0.0, 0.0)),
        }
        other = mirror_shoe_data_to_other_drum_side(second)
        del other["actuation"]
        return [_draw_data_of_shoe_on_abutment(rng, R, rough=False), other]

    return _draw_drum_brake_data(
        rng, draw_data_of_both_shoes, link=[{"from": "first", "to": "second"}]
    )


def _draw_until_shoe_has_elastic_body(
    rng: RandomNumberGenerator,
    R: float,
    makes: Sequence[Callable[[RandomNumberGenerator, float], dict[str, Any]]],
) -> dict[str, Any]:
    """The data of a random shoe with an elastic body; shoes are drawn until one has a body.

    R : radius of the drum [m]; makes : functions that draw a shoe, one of them chosen at random.
    """
    make = makes[int(rng.integers(len(makes)))]
    while "body" not in (shoe := make(rng, R)):
        pass
    return shoe


def _draw_data_of_shoe_on_rough_abutment(rng: RandomNumberGenerator, R: float) -> dict[str, Any]:
    """The data of a shoe on an abutment with friction; R : radius of the drum [m]."""
    return _draw_data_of_shoe_on_abutment(rng, R, rough=True)


def _draw_data_of_t_section_shoe(rng: RandomNumberGenerator, R: float) -> dict[str, Any]:
    """The data of a shoe whose body has a T-section, a web under a table; R : drum radius [m]."""
    shoe, u = (
        _draw_until_shoe_has_elastic_body(
            rng,
            R,
            (
                _draw_data_of_hinged_shoe,
                _draw_data_of_shoe_on_rough_abutment,
                _draw_data_of_pivoted_shoe,
                _draw_data_of_guided_shoe,
            ),
        ),
        rng.uniform,
    )
    body, width = shoe["body"], shoe["lining"]["width"]
    table = {"thickness": u(0.1, 0.5) * body["thickness"], "width": u(1.0, 1.3) * width}
    return shoe | {"body": body | {"width": u(0.1, 0.6) * width, "table": table}}


def _draw_data_of_gripped_shoe(rng: RandomNumberGenerator, R: float) -> dict[str, Any]:
    """The data of a shoe that is fixed over a length ("grip") of its body's back.

    R : radius of the drum [m].
    """
    shoe = _draw_until_shoe_has_elastic_body(
        rng, R, (_draw_data_of_hinged_shoe, _draw_data_of_pivoted_shoe, _draw_data_of_guided_shoe)
    )
    return shoe | {"body": shoe["body"] | {"grip": R * rng.uniform(0.05, 0.4)}}


def _draw_data_of_linked_blocks_brake(rng: RandomNumberGenerator) -> dict[str, Any]:
    """The data of a brake with two to four blocks outside the drum.

    A strap links each block to the next one.
    """
    names = ("first", "second", "third", "fourth")[: int(rng.integers(2, 5))]

    def draw_data_of_all_blocks(rng: RandomNumberGenerator, R: float) -> list[dict[str, Any]]:
        """The data of all blocks, for a drum of radius R [m]; only the first has an actuation."""
        strap, angle = rng.uniform(1.05, 1.15), float(rng.uniform(-1.5, -0.5))
        blocks: list[dict[str, Any]] = []
        for name in names:
            block, end = _draw_linked_block_and_its_end_angle(rng, R, name, angle, strap)
            # The actuation of the first block is a force along the strap, which pulls at the
            # block's start.
            if not blocks:
                pulled = angle
                point = strap * math.cos(pulled), strap * math.sin(pulled)
                block["actuation"] = _draw_actuation_data(
                    rng, block, R, pulled - math.pi / 2, point
                )
            blocks.append(block)
            angle = end
        return blocks

    return _draw_drum_brake_data(
        rng, draw_data_of_all_blocks, link=[{"from": a, "to": b} for a, b in pairwise(names)]
    )


def _draw_linked_block_and_its_end_angle(
    rng: RandomNumberGenerator, R: float, name: str, angle: float, strap: float
) -> tuple[dict[str, Any], float]:
    """The data of a random block of a chain, and the angle of its end [rad].

    An abutment at the end of the block supports it.

    Parameters
    ----------
    rng : numpy.random.Generator
        Generator of the random numbers.
    R : float
        Radius of the drum [m].
    name : str
        Name of the block.
    angle : float
        Angle at which the block begins [rad].
    strap : float
        Radius of the strap, on which the abutment lies, divided by the drum's radius.
    """
    block, half = _draw_unsupported_shoe_data(rng, R, inside=False), rng.uniform(0.15, 0.35)
    ends = {"start": angle + 0.05, "end": angle + 0.05 + 2 * half}
    block |= {"name": name, "lining": block["lining"] | ends}
    if "body" in block:
        block["body"] |= {"start": ends["start"] - 0.03, "end": ends["end"] + 0.03}
    end = ends["end"] + 0.05
    block["abutment"] = {
        "point": _point_at_fractions_of_drum_radius(
            R, strap * math.cos(end), strap * math.sin(end)
        ),
        "direction": end + math.pi / 2,
    }
    return block, end


def _draw_data_of_pad_brake(rng: RandomNumberGenerator, support: str) -> dict[str, Any]:
    """The data of a brake with one random pad, which is a flat shoe on a sliding plane.

    support : "hinge", "pivot", "guide" or "abutment".
    """
    u = rng.uniform
    length, start = draw_number_uniform_in_logarithm(rng, 0.04, 0.3), float(u(-0.3, 0.3))
    width = length * u(0.2, 0.8)
    thickness = length * draw_number_uniform_in_logarithm(rng, 1 / 40, 1 / 8)
    material = {
        "E": draw_number_uniform_in_logarithm(rng, 1e8, 1e10),
        "nu": round(float(u(0.1, 0.4)), 3),
    }
    lining = {
        "start": start,
        "end": start + length,
        "thickness": thickness,
        "width": width,
        "material": material,
    }
    shoe: dict[str, Any] = {"name": "pad", "lining": lining}
    if rng.random() < 0.7:
        shoe["body"] = {
            "thickness": length * u(0.1, 0.3),
            "width": width,
            "start": start - length * u(0.02, 0.1),
            "end": start + length * u(1.02, 1.1),
            "material": {"E": 2.1e11, "nu": 0.3},
        }
    shoe |= _draw_support_and_line_of_force_of_pad(rng, support, start, length)
    force = float(
        f"{material['E'] * length * width * draw_number_uniform_in_logarithm(rng, 1e-4, 3e-3):.4g}"
    )
    shoe["actuation"] = {"force": force, **shoe["actuation"]}
    compression = force / (material["E"] * length * width) * thickness
    # The misfits have their own generator of random numbers. So all other random numbers of a pad
    # do not depend on the misfits.
    lining |= _draw_clearance_and_misfit_of_pad(rng.spawn(1)[0], lining, compression)
    return {"plane": {"sliding": str(rng.choice(["+x", "-x"]))}, "shoe": [shoe]}


def _draw_support_and_line_of_force_of_pad(
    rng: RandomNumberGenerator, support: str, start: float, length: float
) -> dict[str, Any]:
    """The data of a random support of a pad, and of the line on which its actuation force acts.

    Parameters
    ----------
    rng : RandomNumberGenerator
        Generator of random numbers.
    support : str
        "hinge", "pivot", "guide" or "abutment".
    start, length : float
        Start and length of the lining [m].
    """
    u, middle = rng.uniform, start + length / 2
    # With a hinge or a lever, the pin and the line of force lie on opposite sides of the pad's
    # middle, at equal distances from it.
    away, height = length * u(0.8, 1.5), length * u(0.1, 0.5)
    pin, at = {"x": middle - away, "y": height}, {"x": middle + away, "y": height}
    straight: dict[str, Any] = {"direction": -math.pi / 2, "point": at}
    if support == "pivot":
        pivot = {"x": middle + length * u(-0.1, 0.1), "y": length * u(0.05, 0.3)}
        return {"hinge": pin, "pivot": pivot, "actuation": straight}
    if support == "hinge":
        return {"hinge": pin, "actuation": straight}
    at = {"x": middle + length * u(-0.1, 0.1), "y": height}
    actuation = {"direction": -math.pi / 2 + u(-0.1, 0.1), "point": at}
    # The random numbers of the abutment are also drawn for a guide. So a seed gives the same pad
    # with both supports.
    abutment = {
        "point": {"x": start - 0.1 * length, "y": length * u(0.05, 0.2)},
        "direction": u(-0.2, 0.2),
    }
    abutment["friction"] = round(float(u(0.0, 0.3)), 3)
    if support == "guide":
        return {"guide": {"direction": -math.pi / 2 + u(-0.2, 0.2)}, "actuation": actuation}
    return {"abutment": abutment, "actuation": actuation}


def _draw_clearance_and_misfit_of_pad(
    rng: RandomNumberGenerator, lining: dict[str, Any], size: float
) -> dict[str, Any]:
    """Random values of `clearance` and `misfit` of a pad's lining; empty with probability 0.7.

    lining : data of the lining; size : size of the gaps [m], which is the compression of the lining
    by the pad's force.
    """
    u, length = rng.uniform, lining["end"] - lining["start"]
    way = int(rng.integers(10))
    if way == 0:
        radius = length**2 / (8 * size * u(0.2, 3.0)) * float(rng.choice([-1, 1]))
        offset = {"x": length * u(-0.04, 0.04), "y": size * u(-1, 1)}
        return {"misfit": {"radius": radius, "offset": offset}}
    if way == 1:
        return {"misfit": {"taper": size * u(-2, 2)}, "clearance": size * u(0, 2)}
    if way == 2:
        places = np.linspace(lining["start"], lining["end"], int(rng.integers(2, 5)))
        return {"clearance": [[float(x), float(size * u(0, 2))] for x in places]}
    return {}


FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND: dict[str, FunctionThatDrawsSupportKindData] = {
    "hinge": lambda rng: _draw_drum_brake_data(
        rng, lambda rng, R: [_draw_data_of_hinged_shoe(rng, R)]
    ),
    "abutment": lambda rng: _draw_drum_brake_data(
        rng, lambda rng, R: [_draw_data_of_shoe_on_abutment(rng, R, rough=False)]
    ),
    "rough abutment": lambda rng: _draw_drum_brake_data(
        rng, lambda rng, R: [_draw_data_of_shoe_on_abutment(rng, R, rough=True)]
    ),
    "pivot": lambda rng: _draw_drum_brake_data(
        rng, lambda rng, R: [_draw_data_of_pivoted_shoe(rng, R)]
    ),
    "guide": lambda rng: _draw_drum_brake_data(
        rng, lambda rng, R: [_draw_data_of_guided_shoe(rng, R)]
    ),
    "cylinder": _draw_data_of_cylinder_brake,
    "cam": _draw_data_of_cam_brake,
    "strut": _draw_data_of_strut_brake,
    "pad on a hinge": lambda rng: _draw_data_of_pad_brake(rng, "hinge"),
    "pad on a pivot": lambda rng: _draw_data_of_pad_brake(rng, "pivot"),
    "pad on a guide": lambda rng: _draw_data_of_pad_brake(rng, "guide"),
    "pad on an abutment": lambda rng: _draw_data_of_pad_brake(rng, "abutment"),
    "table": lambda rng: _draw_drum_brake_data(
        rng, lambda rng, R: [_draw_data_of_t_section_shoe(rng, R)]
    ),
    "grip": lambda rng: _draw_drum_brake_data(
        rng, lambda rng, R: [_draw_data_of_gripped_shoe(rng, R)]
    ),
    "chain": _draw_data_of_linked_blocks_brake,
}
"""Function that draws the data of a brake, by the kind of support or actuation.

The order of the kinds decides which seed draws which kind.
"""


def _mirror_turn_and_shift_shoe_data(
    shoe: dict[str, Any], turn: float, *, mirrored: bool, shift: float = 0.0
) -> dict[str, Any]:
    """The data of a shoe after it is mirrored, turned and shifted, in this order.

    Parameters
    ----------
    shoe : dict
        Data of a shoe, as in a brake file.
    turn : float
        Angle by which the shoe is turned [rad].
    mirrored : bool
        Whether the shoe is mirrored about the x axis.
    shift : float
        Distance by which the shoe is shifted along x [m].
    """
    motion = _MirrorTurnAndShift(turn, mirrored, shift, "side" not in shoe)
    moves = {
        "hinge": motion.point_after_mirror_turn_and_shift,
        "pivot": motion.point_after_mirror_turn_and_shift,
        "abutment": motion.support_data_after_mirror_turn_and_shift,
        "guide": motion.support_data_after_mirror_turn_and_shift,
        "actuation": motion.support_data_after_mirror_turn_and_shift,
        "lining": motion.lining_data_after_mirror_turn_and_shift,
        "body": motion.lining_data_after_mirror_turn_and_shift,
    }
    result = dict(shoe)
    for key, move in moves.items():
        if result.get(key) is not None:
            result[key] = move(result[key])
    return result


class _MirrorTurnAndShift(NamedTuple):
    """A motion of a shoe: it is mirrored about the x axis, turned and shifted along x.

    Attributes
    ----------
    turn, mirrored, shift : float, bool, float
        As in `_mirror_turn_and_shift_shoe_data`.
    on_plane : bool
        Whether the shoe presses on a plane; the ends of its lining are then coordinates x [m] and
        no angles.
    """

    turn: float
    mirrored: bool
    shift: float
    on_plane: bool

    @property
    def sign_of_mirrored_angles(self) -> int:
        """Factor on angles and y coordinates: -1 if the shoe is mirrored, else 1."""
        return -1 if self.mirrored else 1

    def vector_after_mirror_and_turn(self, x: float, y: float) -> dict[str, float]:
        """The components x and y of a vector after mirroring and turning."""
        c, s, y = math.cos(self.turn), math.sin(self.turn), self.sign_of_mirrored_angles * y
        return {"x": c * x - s * y, "y": s * x + c * y}

    def point_after_mirror_turn_and_shift(self, point: dict[str, float]) -> dict[str, float]:
        """The point after mirroring, turning and shifting."""
        turned = self.vector_after_mirror_and_turn(point["x"], point["y"])
        return turned | {"x": turned["x"] + self.shift}

    def support_data_after_mirror_turn_and_shift(self, part: dict[str, Any]) -> dict[str, Any]:
        """The data of a support or actuation after mirroring, turning and shifting."""
        moved = part | {"direction": self.turn + self.sign_of_mirrored_angles * part["direction"]}
        return moved | (
            {"point": self.point_after_mirror_turn_and_shift(part["point"])}
            if "point" in part
            else {}
        )

    def lining_place_after_mirror_turn_and_shift(self, place: float) -> float:
        """The coordinate of a place on a lining after the motion: angle, or x on a plane."""
        # On a plane a mirrored shoe is also turned by 180 degrees. Both motions together mirror the
        # shoe about the y axis.
        if self.on_plane:
            return math.cos(self.turn) * place + self.shift
        return self.turn + self.sign_of_mirrored_angles * place

    def lining_data_after_mirror_turn_and_shift(self, part: dict[str, Any]) -> dict[str, Any]:
        """The data of a lining or body, with its ends, clearances and misfit after the motion.

        A mirror exchanges start and end.
        """
        start, end = sorted(
            self.lining_place_after_mirror_turn_and_shift(part[key]) for key in ("start", "end")
        )
        moved = part | {"start": start, "end": end}
        if isinstance(part.get("clearance"), list | tuple):
            moved["clearance"] = sorted(
                [self.lining_place_after_mirror_turn_and_shift(x), gap]
                for x, gap in part["clearance"]
            )
        if "misfit" in part:
            x, y = (part["misfit"]["offset"][key] for key in "xy")
            moved["misfit"] = part["misfit"] | {"offset": self.vector_after_mirror_and_turn(x, y)}
        return moved


def mirror_turn_and_shift_brake(
    brake: Brake, *, turn: float = 0.0, mirrored: bool = False, shift: float = 0.0
) -> Brake:
    """The brake after it is mirrored, turned and shifted, in this order.

    A drum brake is mirrored about the x axis, a brake on a plane about the y axis. The data of
    struts and cams stay as they are. Linings with blocks (`misfit.blocks`) are not covered.

    Parameters
    ----------
    brake : Brake
        The brake to be placed.
    turn : float
        Angle [rad] by which a drum brake is turned; without effect on a plane.
    mirrored : bool
        Whether the brake and its motion are mirrored.
    shift : float
        Distance along x [m] by which a brake on a plane is shifted.
    """
    data = (brake.brake_with_reversed_motion() if mirrored else brake).model_dump(by_alias=True)
    if brake.surface.is_plane_and_not_drum:
        turn = math.pi if mirrored else 0.0
    data["shoe"] = [
        _mirror_turn_and_shift_shoe_data(shoe, turn, mirrored=mirrored, shift=shift)
        for shoe in data["shoe"]
    ]
    return make_validated_brake_part(type(brake), data)


BRAKE_FILE_KEYS_OF_LENGTHS = {
    "x",
    "y",
    "radius",
    "thickness",
    "width",
    "grip",
    "clearance",
    "diameter",
    "taper",
}
"""Keys of a brake file whose numbers are lengths [m]."""
BRAKE_FILE_KEYS_OF_FORCES = {"force"}
"""Keys of a brake file whose numbers are forces [N]."""


def brake_with_scaled_lengths_and_moduli(brake: Brake, length: float, modulus: float) -> Brake:
    """The brake with all lengths and all moduli multiplied by factors, at unchanged strains.

    Forces are multiplied by `modulus` times `length` squared, torques by `modulus` times `length`
    cubed.

    Parameters
    ----------
    brake : Brake
        The brake to be scaled.
    length : float
        Factor that multiplies all lengths.
    modulus : float
        Factor that multiplies all moduli and pressures.
    """
    on_plane = brake.surface.is_plane_and_not_drum
    lengths = BRAKE_FILE_KEYS_OF_LENGTHS | ({"start", "end"} if on_plane else set())
    along = length if on_plane else 1.0

    def scale_lengths_moduli_and_forces_in_data(value: Any) -> Any:
        """A value of the brake's data in which all lengths, moduli and forces are scaled.

        The value may be a table, a list or a single number or text.
        """
        if isinstance(value, dict):
            return {key: scale_value_of_key(key, each) for key, each in value.items()}
        return (
            [scale_lengths_moduli_and_forces_in_data(each) for each in value]
            if isinstance(value, list | tuple)
            else value
        )

    def scale_value_of_key(key: str, value: Any) -> Any:
        """The value of a key, multiplied by the factor that belongs to the key's unit."""
        # A row of a table has two numbers. The first is an angle, or a length x on a plane. The
        # second is a clearance or a depth.
        if key in {"clearance", "blocks"} and isinstance(value, list | tuple):
            return [[place * along, size * length] for place, size in value]
        if isinstance(value, bool | str) or value is None or not isinstance(value, int | float):
            return scale_lengths_moduli_and_forces_in_data(value)
        if key in lengths:
            return value * length
        if key in {"E", "pressure"}:
            return value * modulus
        if key in BRAKE_FILE_KEYS_OF_FORCES:
            return value * modulus * length**2
        return value * modulus * length**3 if key == "torque" else value

    return make_validated_brake_part(
        type(brake), scale_lengths_moduli_and_forces_in_data(brake.model_dump(by_alias=True))
    )
