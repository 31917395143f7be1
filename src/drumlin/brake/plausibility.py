"""Notes on values of a brake that can hardly be meant, such as a friction coefficient of 30.

Such a value usually has the wrong unit. The brake is solved all the same, since the value may be
meant. The limits are judgements: the values of all brakes in the studies and in
`drumlin_studies.random_brake` are several times smaller or larger than the limits.
"""

import functools
import math
import re
from collections.abc import Iterator
from typing import Annotated, Any, NamedTuple

from drumlin.base.texts import number_as_text
from drumlin.brake.brake import Brake
from drumlin.brake.drum_brake import DrumBrake
from drumlin.brake.fields import (
    Material,
    OrthotropicMaterial,
    PartOfInputFile,
    Point,
    si_unit_of_field_type,
)
from drumlin.brake.units import (
    angle_as_text_in_degrees,
    length_as_text_in_mm,
    quantity_with_usual_unit,
)

LARGEST_USUAL_DISTANCE_OVER_BRAKE_SIZE = 20.0
"""Distance or length, relative to the brake's size, above which a note questions its unit.

The size is the drum's radius, or on a plane the length of the longest lining. Points of random
brakes are at most 3 radii from the drum's centre, or 9 lengths from the nearest pad.
"""
SMALLEST_USUAL_WIDTH_OVER_BRAKE_SIZE = 1e-3
"""Width or diameter, relative to the brake's size, below which a note questions its unit.

The widths of random brakes are at least 0.02 of the size.
"""
SMALLEST_USUAL_THICKNESS_OVER_BRAKE_SIZE = 1e-4
"""Thickness, relative to the brake's size, below which a note questions its unit.

The thicknesses of random brakes are at least 0.001 of the size.
"""
USUAL_RANGE_OF_DRUM_RADIUS = (1e-3, 30.0)
"""Smallest and largest usual radius of a drum [m]; outside them a note questions the unit.

Drums have radii of some 20 mm to 5 m.
"""
LARGEST_USUAL_FRICTION_COEFFICIENT = 2.0
"""Friction coefficient above which a note asks whether the number is in per cent.

Brake linings reach 0.7, and dry rubber 1.5.
"""
LARGEST_USUAL_NUMBER_OF_TURNS_OF_ANGLE = 2.0
"""Number of turns of an angle above which a note asks whether its unit should be degrees.

An angle of 75 deg that is written as 75 rad is 12 turns.
"""
SOFTEST_LINING, SOFTEST_BODY, STIFFEST_PART = 1e5, 1e6, 3e13
"""Limits of moduli [Pa]: a note questions the unit of a modulus beyond its limit.

The three limits are the smallest modulus of a lining, the smallest modulus of a body, and the
largest modulus of any part. Foams have 1e5 Pa, wood across its grain 1e8 Pa, steel 2e11 Pa and
diamond 1e12 Pa. A modulus in N/m^2 that was meant in N/mm^2 is a million times too small.
"""
MODULUS_RANGE_OF_SHOE_METALS = (6e10, 2.2e11)
"""Moduli [Pa] of the metals of shoes, from aluminium (7e10 Pa) to steel (2.1e11 Pa).

A note questions the modulus of a lining that is stiffer than a shoe of such a metal.
"""
LARGEST_USUAL_LINING_MODULUS = 2e10
"""Largest usual modulus [Pa] of a lining's material; organic linings have 1e8 to 5e9 Pa.

If a lining has the modulus of a metal, and its shoe at most LARGEST_USUAL_LINING_MODULUS, a note
asks whether the two materials were exchanged.
"""
LARGEST_USUAL_TEMPERATURE_RISE = 1200.0
"""Temperature rise [K] above which a note says that the materials of a brake do not bear it.

Cast iron melts at 1400 K.
"""
LARGEST_USUAL_THERMAL_EXPANSION = 1e-3
"""Coefficient of thermal expansion [1/K] above which a note questions its unit.

Steel has 1.2e-5 1/K, rubber 2e-4 1/K. A coefficient in 1e-6/K that was written in 1/K is a million
times too large.
"""
LARGEST_USUAL_UNIFORM_CLEARANCE_OVER_RADIUS = 1e-3
"""Clearance along a whole lining over the drum's radius, above which a note explains the key.

Linings that do not fit are some 50 micrometres off drums of radius 150 mm, 3e-4 of the radius.
Adjusters leave gaps of 0.2 to 0.5 mm, more than 1e-3 of the radius. The key `clearance` does not
mean the gap that an adjuster leaves.
"""
LARGEST_USUAL_REACH_OF_SHOES_OVER_WRONG_RADIUS = 0.5
"""Reach of internal shoes over the drum's radius up to which a note asks for half of the radius.

The reach is the largest distance of a pin or of an actuation's point from the drum's centre. Shoes
fill their drum: of 970 brakes of the studies, random brakes and brakes after drawings the smallest
reach is 0.61 of the radius. Up to 0.5 all pins and forces would also lie within a drum of half the
radius, as where a diameter was written as the radius.
"""
LARGEST_USUAL_ANGLE_OF_LINING_FROM_HINGE = math.pi
"""Angle [rad] from the hinge to the far end of a lining above which a note explains the angles.

A turn about the pin moves the part of the lining beyond half a turn away from the drum, so that the
part never presses. The largest angle of the 970 brakes is 153 degrees.
"""
LARGEST_USUAL_LINING_THICKNESS_OVER_DRUM_RADIUS = 0.3
"""Thickness of a lining over the drum's radius above which a note questions its unit.

The largest thickness of the 970 brakes is 0.26 of the radius. A thickness in mm that was written in
cm is ten times too large.
"""
USUAL_RANGE_OF_CYLINDER_PRESSURE = (1e4, 1e9)
"""Smallest and largest usual pressure of a cylinder [Pa]; outside them a note questions the unit.

Wheel cylinders have some 1 to 20 MPa, and vacuum brakes 5e4 Pa.
"""
LARGEST_USUAL_SURFACE_SPEED = 100.0
"""Speed [m/s] of the friction surface above which a note questions the unit of a speed.

The drum of a car at 200 km/h has some 25 m/s, a clutch of a chain saw at 13 000 rpm some 50 m/s. A
speed in rpm that was written in rad/s is ten times too large. The value is a judgement.
"""
LARGEST_USUAL_MASS_OVER_CUBED_RADIUS = 6e4
"""Mass of a shoe over the cube of the drum's radius [kg/m^3] above which a note questions its unit.

A cube of steel that is as large as the drum has 8 x 7850 kg/m^3.
"""


def notes_on_implausible_brake_values(brake: Brake) -> tuple[str, ...]:
    """A line for each value of a brake that is probably a mistake, often with the likely value.

    Each line begins with "note:" and names the key of the brake file.
    """
    size = brake.size
    if brake.surface.is_plane_and_not_drum:
        size = max(shoe.lining.end - shoe.lining.start for shoe in brake.shoes)
    lines = [*_notes_on_too_high_friction(brake), *_notes_on_too_stiff_linings(brake)]
    lines += _notes_on_large_uniform_clearance(brake)
    # If the drum's radius itself is probably a mistake, no length is compared with it.
    on_drum = list(_notes_on_unusual_drum_radius(brake))
    lines += on_drum or [
        *_notes_on_far_points(brake, size),
        *_notes_on_thick_linings(brake),
        *_notes_on_diameter_as_radius(brake),
    ]
    for value in _quantities_of_brake_part(brake, ""):
        lines += [] if on_drum else _notes_on_unusual_length(value, brake, size)
        lines += [
            *_notes_on_angle_of_many_turns(value),
            *_notes_on_unit_of_modulus_or_pressure(value),
        ]
        lines += _notes_on_temperature_or_expansion(value)
        lines += [] if on_drum else _notes_on_speed_or_mass(value, brake)
    # A value with a wrong unit may move a pin or a force. Only without such a value, directions and
    # angles are judged.
    lines = lines or [
        *_notes_on_forces_that_turn_shoes_off_drum(brake),
        *_notes_on_linings_far_around_from_hinge(brake),
    ]
    return tuple(f"note: {line}" for line in _merge_equal_notes_on_several_shoes(lines))


def _merge_equal_notes_on_several_shoes(lines: list[str]) -> Iterator[str]:
    """Yield each note once; notes that differ only in the shoe's index become one with a count."""
    counts: dict[str, int] = {}
    firsts: dict[str, str] = {}
    for line in lines:
        alike = re.sub(r"shoe\[\d+\]", "shoe[]", line)
        counts[alike] = counts.get(alike, 0) + 1
        firsts.setdefault(alike, line)
    for alike, line in firsts.items():
        more = counts[alike] - 1
        yield f"{line} ({more} more shoe{'s' * (more > 1)} alike)" if more else line


class _BrakeQuantityWithKey(NamedTuple):
    """A quantity of a brake: its key in the brake file, its part, its SI unit and its value."""

    key: str
    part: PartOfInputFile
    unit: str
    value: float

    @property
    def name(self) -> str:
        """The last word of the key, such as "thickness"."""
        return self.key.rpartition(".")[2]


def _quantities_of_brake_part(part: PartOfInputFile, key: str) -> Iterator[_BrakeQuantityWithKey]:
    """Yield the quantities of a part and of the parts within it; tables of quantities are left out.

    `key` is the key of the part itself in the brake file, "" for the whole brake.
    """
    for name, field in type(part).model_fields.items():
        value, below = getattr(part, name), f"{key}.{field.alias or name}".removeprefix(".")
        if isinstance(value, PartOfInputFile):
            yield from _quantities_of_brake_part(value, below)
        elif isinstance(value, tuple):
            for i, each in enumerate(value):
                if isinstance(each, PartOfInputFile):
                    yield from _quantities_of_brake_part(each, f"{below}[{i}]")
        elif isinstance(value, float):
            yield _BrakeQuantityWithKey(
                below, part, _si_unit_of_part_field(type(part), name), value
            )


@functools.cache
def _si_unit_of_part_field(kind: type[PartOfInputFile], name: str) -> str:
    """The SI unit of a field of a class of parts; "" for a number without unit."""
    field = kind.model_fields[name]
    annotation: Any = field.annotation
    if field.metadata:
        annotation = Annotated[annotation, *field.metadata]
    return si_unit_of_field_type(annotation) or ""


def _notes_on_too_high_friction(brake: Brake) -> Iterator[str]:
    """Yield a note for each friction coefficient above LARGEST_USUAL_FRICTION_COEFFICIENT."""
    frictions = {"friction": brake.friction}
    for i, shoe in enumerate(brake.shoes):
        if shoe.lining.friction is not None:
            frictions[f"shoe[{i}].lining.friction"] = (
                brake.friction_coefficient_of_shoe_at_zero_pressure(shoe)
            )
    for key, friction in frictions.items():
        if friction > LARGEST_USUAL_FRICTION_COEFFICIENT:
            meant = f"; did you mean {friction / 100:g}, which is {friction:g} %?"
            yield (
                f"{key} = {friction:g} is more than any lining has"
                f"{meant if friction <= 100 else ''}"
            )


def _notes_on_unusual_drum_radius(brake: Brake) -> Iterator[str]:
    """Yield a note if the drum's radius is outside USUAL_RANGE_OF_DRUM_RADIUS."""
    low, high = USUAL_RANGE_OF_DRUM_RADIUS
    if isinstance(brake, DrumBrake) and not low <= brake.drum.radius <= high:
        meant = _text_of_length_with_unit_that_may_be_meant(
            brake.drum.radius, small=brake.drum.radius < low
        )
        yield (
            f"drum.radius = {length_as_text_in_mm(brake.drum.radius)} is not usual, "
            f"20 mm to 5 m are; "
            f"did you mean {meant}?"
        )


def _notes_on_far_points(brake: Brake, size: float) -> Iterator[str]:
    """Yield a note for each point of a support or load far from the drum's centre or all pads.

    `size` is the drum's radius [m], or on a plane the length of the longest lining.
    """
    for key, point in _points_of_supports_and_loads(brake):
        away = 0.0 if point is None else _distance_from_drum_centre_or_nearest_pad(brake, point)
        if away > LARGEST_USUAL_DISTANCE_OVER_BRAKE_SIZE * size:
            words = _text_of_brake_size_with_its_key(brake, size)
            meant = _text_of_length_with_unit_that_may_be_meant(away, small=False)
            yield (
                f"{key} is {away:.4g} m away, {away / size:.3g} times {words}; "
                f"did you mean {meant}?"
            )


def _points_of_supports_and_loads(brake: Brake) -> Iterator[tuple[str, Point | None]]:
    """Yield the points of all supports and loads of a brake, each with its key.

    The point of a support that a shoe does not have is None.
    """
    for i, shoe in enumerate(brake.shoes):
        key = f"shoe[{i}]"
        yield f"{key}.hinge", shoe.hinge
        yield f"{key}.pivot", shoe.pivot
        yield f"{key}.abutment.point", None if shoe.abutment is None else shoe.abutment.point
        yield f"{key}.actuation.point", shoe.actuation.point
        yield f"{key}.mass.point", None if shoe.mass is None else shoe.mass.point
        for j, anchor in enumerate(shoe.anchors):
            yield f"{key}.anchor[{j}].point", anchor.point
        for j, force in enumerate(shoe.forces):
            yield f"{key}.force[{j}].point", force.point
    for part, joints, names in (
        ("spring", brake.springs, ("point", "end")),
        ("lever", brake.levers, ("point", "pivot", "strut", "end")),
    ):
        for j, joint in enumerate(joints):
            yield from ((f"{part}[{j}].{name}", getattr(joint, name)) for name in names)


def _distance_from_drum_centre_or_nearest_pad(brake: Brake, point: Point) -> float:
    """Distance [m] of a point from the drum's centre, or from the nearest pad's middle."""
    if not brake.surface.is_plane_and_not_drum:
        return point.radius
    return min(math.dist(point.xy, (shoe.lining.middle, 0.0)) for shoe in brake.shoes)


def _text_of_brake_size_with_its_key(brake: Brake, size: float) -> str:
    """Words for the brake's size with its value, such as "drum.radius = 150 mm"."""
    name = "the lining's length" if brake.surface.is_plane_and_not_drum else "drum.radius"
    return f"{name} = {length_as_text_in_mm(size)}"


def _text_of_length_with_unit_that_may_be_meant(length: float, *, small: bool) -> str:
    """Text of the length that may be meant by a length [m]: the same number with another unit.

    A `small` length was perhaps written in mm and meant in m. A large length was perhaps written in
    m and meant in mm or cm.
    """
    if small:
        return f"{length * 1e3:.4g} m"
    return f"{length:.4g} mm or {length:.4g} cm"


def _notes_on_unusual_length(
    value: _BrakeQuantityWithKey, brake: Brake, size: float
) -> Iterator[str]:
    """Yield a note on a width, thickness, grip, diameter or lever unlike the brake's size.

    `size` is the drum's radius [m], or on a plane the length of the longest lining.
    """
    least = {
        "thickness": SMALLEST_USUAL_THICKNESS_OVER_BRAKE_SIZE,
        "width": SMALLEST_USUAL_WIDTH_OVER_BRAKE_SIZE,
        "grip": SMALLEST_USUAL_THICKNESS_OVER_BRAKE_SIZE,
        "diameter": SMALLEST_USUAL_WIDTH_OVER_BRAKE_SIZE,
        "lever": SMALLEST_USUAL_WIDTH_OVER_BRAKE_SIZE,
    }.get(value.name)
    if least is None or value.unit != "m":
        return
    words = _text_of_brake_size_with_its_key(brake, size)
    if value.value > LARGEST_USUAL_DISTANCE_OVER_BRAKE_SIZE * size:
        yield (
            f"{value.key} = {value.value:.4g} m is {value.value / size:.3g} times {words}; "
            f"did you mean {_text_of_length_with_unit_that_may_be_meant(value.value, small=False)}?"
        )
    elif 0 < value.value < least * size:
        yield (
            f"{value.key} = {length_as_text_in_mm(value.value)} is {value.value / size:.2g} "
            f"of {words}; "
            f"did you mean {_text_of_length_with_unit_that_may_be_meant(value.value, small=True)}?"
        )


def _notes_on_angle_of_many_turns(value: _BrakeQuantityWithKey) -> Iterator[str]:
    """Yield a note on an angle of several turns, probably degrees that were written as radians.

    The angular position of the drum, `drum.angle`, may be many turns.
    """
    if value.unit == "rad" and value.key != "drum.angle":
        yield from _note_if_angle_has_many_turns(value.key, value.value)
    if (
        isinstance(value.part, Point)
        and value.name == "x"
        and value.part.angle_in_file_if_beyond_one_turn is not None
    ):
        yield from _note_if_angle_has_many_turns(
            f"{value.key.removesuffix('.x')}.angle", value.part.angle_in_file_if_beyond_one_turn
        )


def _note_if_angle_has_many_turns(key: str, angle: float) -> Iterator[str]:
    """Yield a note if an angle [rad] has more turns than allowed; `key` is its key in the file."""
    if abs(angle) > LARGEST_USUAL_NUMBER_OF_TURNS_OF_ANGLE * 2 * math.pi:
        turns = abs(angle) / (2 * math.pi)
        yield f"{key} = {angle:.6g} rad is {turns:.3g} turns; did you mean {angle:.6g} deg?"


def _notes_on_unit_of_modulus_or_pressure(value: _BrakeQuantityWithKey) -> Iterator[str]:
    """Yield a note on a modulus or pressure if N/m^2 and N/mm^2 were probably confused."""
    if value.unit != "Pa":
        return
    low, high = USUAL_RANGE_OF_CYLINDER_PRESSURE
    what = "a wheel cylinder"
    if isinstance(value.part, Material | OrthotropicMaterial):
        of_lining = ".lining." in value.key or ".backing." in value.key
        low, high = SOFTEST_LINING if of_lining else SOFTEST_BODY, STIFFEST_PART
        what = "a lining" if of_lining else "a shoe or a ring"
    if value.value < low:
        yield (
            f"{value.key} = {number_as_text(value.value, '.4g')} Pa (N/m^2) is low for {what}; "
            f"did you mean {_stress_as_text_in_mpa(value.value * 1e6)} (N/mm^2)?"
        )
    elif value.value > high:
        yield (
            f"{value.key} = {_stress_as_text_in_mpa(value.value)} (N/mm^2) is high for {what}; "
            f"did you mean N/m^2, which gives {_stress_as_text_in_mpa(value.value * 1e-6)}?"
        )


def _notes_on_temperature_or_expansion(value: _BrakeQuantityWithKey) -> Iterator[str]:
    """Yield a note on a too large temperature rise or coefficient of thermal expansion."""
    if value.unit == "K" and abs(value.value) > LARGEST_USUAL_TEMPERATURE_RISE:
        yield f"{value.key} = {value.value:.4g} K is more than the materials of a brake bear"
    if value.unit == "1/K" and abs(value.value) > LARGEST_USUAL_THERMAL_EXPANSION:
        yield (
            f"{value.key} = {value.value:.4g} 1/K is large for a solid; "
            f"did you mean {value.value * 1e-6:.4g} 1/K?"
        )


def _notes_on_speed_or_mass(value: _BrakeQuantityWithKey, brake: Brake) -> Iterator[str]:
    """Yield a note on a speed or on the mass of a shoe that is too large for a drum."""
    if brake.surface.is_plane_and_not_drum:
        return
    surface_speed = abs(value.value) * brake.size
    if value.unit == "rad/s" and surface_speed > LARGEST_USUAL_SURFACE_SPEED:
        yield (
            f"{value.key} = {value.value:.4g} rad/s gives the drum's surface "
            f"{surface_speed:.4g} m/s; did you mean {value.value:.4g} rpm?"
        )
    if value.unit == "kg" and value.value > LARGEST_USUAL_MASS_OVER_CUBED_RADIUS * brake.size**3:
        yield (
            f"{value.key} = {value.value:.4g} kg is more than a steel cube as large as the drum; "
            f"did you mean {value.value:.4g} g?"
        )


def _stress_as_text_in_mpa(modulus: float) -> str:
    """A modulus or a pressure [Pa] as text in MPa."""
    return f"{number_as_text(modulus * 1e-6, '.4g')} MPa"


def _notes_on_too_stiff_linings(brake: Brake) -> Iterator[str]:
    """Yield a note on each lining that is stiffer than a metal shoe, or of metal on a soft shoe."""
    softest_metal, stiffest_metal = MODULUS_RANGE_OF_SHOE_METALS
    for i, shoe in enumerate(brake.shoes):
        body = None if shoe.body is None else shoe.body.material
        if body is None or shoe.lining.material is None:
            continue
        E_lining, E_body = shoe.lining.material.E_through, body.E_along
        moduli = f"E = {_stress_as_text_in_mpa(E_lining)} beside {_stress_as_text_in_mpa(E_body)}"
        # A modulus that is itself doubtful has a note by `_notes_on_unit_of_modulus_or_pressure`.
        if E_lining <= E_body or E_lining > STIFFEST_PART or E_body < SOFTEST_BODY:
            continue
        key = f"shoe[{i}].lining.material is stiffer than shoe[{i}].body.material, {moduli}"
        if softest_metal <= E_body <= stiffest_metal:
            yield f"{key}; did you mean {_stress_as_text_in_mpa(E_lining * 1e-3)}?"
        elif softest_metal <= E_lining <= stiffest_metal and E_body <= LARGEST_USUAL_LINING_MODULUS:
            yield f"{key}; were the two exchanged?"


def _notes_on_large_uniform_clearance(brake: Brake) -> Iterator[str]:
    """Yield a note on each lining of a hinged shoe with a large clearance that is one number.

    Such a number is often the gap that an adjuster leaves at rest, written under the wrong key. A
    hinged shoe closes the adjuster's gap by a turn about its pin. A clearance along the whole
    lining, in contrast, describes a lining of another radius.
    """
    if brake.surface.is_plane_and_not_drum:
        return
    for i, shoe in enumerate(brake.shoes):
        for lining in shoe.lining.linings:
            gap = lining.clearance
            if shoe.hinge is None or not isinstance(gap, float):
                continue
            if gap > LARGEST_USUAL_UNIFORM_CLEARANCE_OVER_RADIUS * brake.size:
                yield (
                    f"shoe[{i}].lining.clearance = {length_as_text_in_mm(gap)} is a gap along "
                    f"the whole "
                    "lining, "
                    "as of a lining ground to another radius; leave it out for the gap that an "
                    "adjuster leaves, which the shoe closes by a turn about its pin"
                )


def _notes_on_forces_that_turn_shoes_off_drum(brake: Brake) -> Iterator[str]:
    """Yield a note for each hinged shoe that its force alone turns away from the drum.

    The note names the sign or the direction of the force. A shoe with other loads, and a shoe whose
    force follows from a cam or a strut, may be pressed on the drum nevertheless, and has no note.
    """
    if brake.surface.is_plane_and_not_drum or brake.reason_why_cam_or_strut_sets_forces:
        return
    for i, shoe in enumerate(brake.shoes):
        actuation = shoe.actuation
        if shoe.kind_of_support != "hinge" or shoe.has_loads_besides_actuation:
            continue
        offset = shoe.lining.middle - shoe.pin.angle
        # The moment moves the middle of the lining outwards where this number is positive.
        outwards = -actuation.moment_of_force_about_point(shoe.pin) * math.sin(offset)
        if not actuation.force or outwards * shoe.sign_internal_plus_external_minus >= 0:
            continue
        key = f"shoe[{i}].actuation"
        turns = f"force turns shoe {shoe.name!r} away from the drum; did you mean"
        if actuation.force < 0:
            force = quantity_with_usual_unit(actuation.force, "N")
            meant = quantity_with_usual_unit(-actuation.force, "N")
            yield f"{key}.force = {force}: with this minus the {turns} {meant}?"
        else:
            # The opposite direction is shown as an angle above -180 deg and up to 180 deg.
            opposite = 180 - -math.degrees(actuation.direction) % 360
            direction = angle_as_text_in_degrees(actuation.direction)
            yield f"{key}.direction = {direction}: the {turns} {opposite + 0.0:.6g} deg?"


def _notes_on_diameter_as_radius(brake: Brake) -> Iterator[str]:
    """Yield a note if all pins and forces of internal shoes are within half the drum's radius."""
    if not isinstance(brake, DrumBrake) or any(shoe.side != "internal" for shoe in brake.shoes):
        return
    reach = max(max(shoe.pin.radius, shoe.actuation.point.radius) for shoe in brake.shoes)
    radius = brake.drum.radius
    if 0 < reach <= LARGEST_USUAL_REACH_OF_SHOES_OVER_WRONG_RADIUS * radius:
        yield (
            f"drum.radius = {length_as_text_in_mm(radius)}, but every pin and every force is at "
            f"most {length_as_text_in_mm(reach)} from the drum's centre; is "
            f"{length_as_text_in_mm(radius)} the diameter, and the radius "
            f"{length_as_text_in_mm(radius / 2)}?"
        )


def _notes_on_linings_far_around_from_hinge(brake: Brake) -> Iterator[str]:
    """Yield a note on each lining of an internal shoe that reaches far around from its hinge.

    The angles of such a lining often count from the hinge.
    """
    if brake.surface.is_plane_and_not_drum:
        return
    for i, shoe in enumerate(brake.shoes):
        if shoe.kind_of_support != "hinge" or shoe.side != "internal":
            continue
        lining, hinge = shoe.lining, shoe.pin.angle
        offset = abs(math.remainder(lining.middle - hinge, 2 * math.pi))
        far = offset + 0.5 * (lining.end - lining.start)
        if far > LARGEST_USUAL_ANGLE_OF_LINING_FROM_HINGE:
            start, end = map(angle_as_text_in_degrees, (lining.start, lining.end))
            yield (
                f"shoe[{i}].lining = {start} to {end} ends {math.degrees(far):.4g} deg from the "
                f"hinge at {angle_as_text_in_degrees(hinge)}; angles count counter-clockwise from "
                "+x about the drum's centre, not from the hinge"
            )


def _notes_on_thick_linings(brake: Brake) -> Iterator[str]:
    """Yield a note on each lining that is thick beside the drum's radius."""
    if not isinstance(brake, DrumBrake):
        return
    radius = brake.drum.radius
    for i, shoe in enumerate(brake.shoes):
        thickness = shoe.lining.thickness
        share = thickness / radius
        if (
            LARGEST_USUAL_LINING_THICKNESS_OVER_DRUM_RADIUS
            < share
            <= LARGEST_USUAL_DISTANCE_OVER_BRAKE_SIZE
        ):
            yield (
                f"shoe[{i}].lining.thickness = {length_as_text_in_mm(thickness)} is {share:.2g} of "
                f"drum.radius = {length_as_text_in_mm(radius)}; did you mean "
                f"{length_as_text_in_mm(thickness / 10)}?"
            )
