"""The brake on a drum: classes that read and check the data of a brake file with [drum].

Conventions: the drum's centre O is the origin, angles run counter-clockwise from +x, and all
numbers are SI (m, N, Pa, rad). The lining lies against the drum's friction surface of radius R.
"""

import math
from functools import cached_property
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import (
    Field,
    ValidationInfo,
    model_validator,
)

from drumlin.base.arrays import Floats, polar_angles_within_half_turn_of_angle
from drumlin.brake.beam_axis import make_beam_axis
from drumlin.brake.brake import Brake, Shoe, ShoeFrame
from drumlin.brake.components import (
    LARGEST_ALLOWED_RELATIVE_MISFIT,
    SMALLEST_ANGLE_OF_SLOT_BETWEEN_LININGS,
    ArcBody,
    ArcOrBeamShoeBody,
    Backing,
    BeamBody,
    Drum,
    DrumLiningOrDrumLiningRow,
    DrumRing,
    Lining,
    OutOfRoundHarmonic,
    ShoeBodyOfConstantSection,
    TableOfTSection,
    did_you_mean_hint_for_angles_of_arc,
)
from drumlin.brake.drive import (
    DriveOfAllShoes,
    StrutOrStrapBetweenShoes,
    shoes_with_forces_of_drive_and_struts,
)
from drumlin.brake.fields import AngularSpeed, Point, Title, check_shoe_names_differ
from drumlin.brake.friction import FrictionOrTable, check_friction_tables_have_sliding_speed
from drumlin.brake.further_loads import Gravity, Lever, Spring, brake_with_loads_assigned_to_shoes
from drumlin.brake.heat import (
    check_thermal_expansion_of_drum_is_known,
    check_thermal_expansion_of_shoes_is_known,
    radial_growth_of_heated_drum,
)
from drumlin.brake.off_circle import gaps_of_lining_ground_to_circle, radial_deviation_of_drum
from drumlin.brake.pattern import (
    DrumPattern,
    brake_data_with_patterned_shoes_repeated,
    shoe_motion_of_turn_about_drum_centre,
)
from drumlin.brake.support import SupportedShoe, check_rigid_body_modes_close_gap_differently
from drumlin.brake.surface import FRICTION_SURFACE_OF_DRUM
from drumlin.brake.units import angle_as_text_in_degrees, length_as_text_in_mm


class DrumShoe(Shoe):
    """A shoe on a drum with its lining, support and actuation. Without `body` it is rigid."""

    surface = FRICTION_SURFACE_OF_DRUM
    side: Literal["internal", "external"]
    lining: DrumLiningOrDrumLiningRow
    backing: Backing | None = None
    body: ArcOrBeamShoeBody | None = None
    pattern: DrumPattern | None = None

    @cached_property
    def frame(self) -> ShoeFrame:
        """The frame of the shoe, in which phi of the lining's middle is from 0 to pi."""
        middle = 0.5 * (self.lining.start + self.lining.end)
        offset = math.remainder(middle - self.pin.angle, 2 * math.pi)
        # This sense gives a shoe and its mirror image the same coordinates phi.
        sense = 1 if offset >= 0 else -1
        return ShoeFrame(middle - offset, sense)

    @property
    def pin_position_in_shoe_frame(self) -> Floats:
        """Position (2,) [m] of the pin (`SupportedShoe.pin`) in the frame of the shoe."""
        return np.array([self.pin.radius, 0.0])

    def convert_points_to_shoe_frame(self, xy: Floats) -> Floats:
        """Convert points (..., 2) [m] from the frame of the brake to the frame of the shoe."""
        return self.frame.convert_vectors_to_shoe_frame(xy)

    def convert_points_to_brake_frame(self, xy: Floats) -> Floats:
        """Convert points (2, n) [m] from the frame of the shoe to the frame of the brake."""
        return np.asarray(self.frame.convert_vectors_from_shoe_to_brake_frame(xy.T).T)

    def points_at_depth_and_coordinate_phi(self, depth: Floats, phi: Floats, size: float) -> Floats:
        """Points (2, ...) [m] at a depth behind the friction surface and at angles phi.

        The points are in the frame of the shoe.

        Parameters
        ----------
        depth : distance behind the friction surface, into the shoe [m], any shape
        phi : angles [rad] in the frame of the shoe, any shape
        size : radius of the drum [m]
        """
        # An internal shoe lies inside the friction surface, an external shoe outside it.
        r = size - self.sign_internal_plus_external_minus * depth
        return np.array([r * np.cos(phi), r * np.sin(phi)])

    def distances_from_friction_surface(self, xy: Floats, size: float) -> Floats:
        """Distance [m] of points from the friction surface, positive on the side of the shoe.

        The points (2, ...) [m] are in the frame of the shoe; `size` [m] is the drum's radius.
        """
        return self.sign_internal_plus_external_minus * (size - np.hypot(*xy))

    def surface_coordinates_of_points_in_shoe_frame(self, xy: Floats, size: float) -> Floats:
        """Polar angles [rad] of points (2, ...) [m], within half a turn of the lining's middle.

        Points and angles are in the frame of the shoe.
        """
        return polar_angles_within_half_turn_of_angle(0.5 * sum(self.arc), xy)

    def drum_angle_or_plane_x_of_point(self, point: Point) -> float:
        """Polar angle [rad] of a point, within half a turn of the middle of the lining."""
        return self.surface.coordinate_plus_turns_nearest_to_middle(point.angle, self.lining.middle)

    def length_along_shoe_back_per_unit_of_phi(self, size: float) -> float:
        """Radius [m] of the back of the shoe's body, which is its arc length per radian of phi."""
        return size - self.sign_internal_plus_external_minus * self.total_thickness

    @property
    def angle_of_direction_in_which_lining_closes_gap(self) -> float:
        """Angle [rad] of the normal from the middle of the lining towards the drum.

        For an internal lining the result is the polar angle of the lining's middle, and for an
        external lining this angle plus pi.
        """
        return self.lining.middle + (self.sign_internal_plus_external_minus < 0) * math.pi

    def gaps_due_to_ground_lining_radius_and_offset(self, theta: Floats, size: float) -> Floats:
        """Gap [m] of a lining that is ground to a circle, at the angles theta [rad], same shape."""
        misfit = self.lining.misfit
        return gaps_of_lining_ground_to_circle(
            size,
            misfit.radius,
            misfit.offset,
            self.lining.middle,
            self.sign_internal_plus_external_minus,
            theta,
        )


class DrumBrake(Brake):
    """A brake on a drum with its friction coefficient, sense of rotation, drum and shoes."""

    surface = FRICTION_SURFACE_OF_DRUM
    direction_key = "rotation"
    directions = ("counter-clockwise", "clockwise")

    title: Title
    rotation: Literal["counter-clockwise", "clockwise"]
    friction_as_written: Annotated[FrictionOrTable, Field(alias="friction")]
    drum: Drum
    shoes: Annotated[tuple[DrumShoe, ...], Field(alias="shoe", min_length=1)]
    actuation: DriveOfAllShoes | None = None
    links: Annotated[tuple[StrutOrStrapBetweenShoes, ...], Field(alias="link")] = ()
    springs: Annotated[tuple[Spring, ...], Field(alias="spring")] = ()
    levers: Annotated[tuple[Lever, ...], Field(alias="lever")] = ()
    gravity: Gravity | None = None
    shoe_speed: AngularSpeed | None = None

    @property
    def sliding_speed(self) -> float | None:
        """Speed [m/s] at which the drum slides over the linings; None if no speed is given.

        Shoes may turn about the drum's centre too, in the sense of the drum (centrifugal clutch).
        """
        if self.drum.speed is None and self.shoe_speed is None:
            return None
        return self.drum.radius * abs((self.drum.speed or 0.0) - (self.shoe_speed or 0.0))

    @property
    def direction(self) -> str:
        """The sense of the drum's rotation."""
        return self.rotation

    @property
    def size(self) -> float:
        """Reference length of the brake [m]: the radius of the drum's friction surface."""
        return self.drum.radius

    @property
    def ring(self) -> DrumRing | None:
        """The elastic ring of the drum; None for a rigid drum."""
        return self.drum.ring

    def brake_with_reversed_motion(self) -> Self:
        """A copy of the brake whose drum turns in the opposite direction."""
        return self.model_copy(update={"rotation": self.opposite_direction_of_motion})

    def brake_reduced_to_stiffness_data(self) -> Self:
        """The brake reduced to data that change the condensed stiffness of its shoes and ring.

        Title, rotation, and the drum's deviation from its circle, angle and temperatures get fixed
        values. A friction coefficient above 0 becomes 1. Springs, levers, gravity and speeds are
        removed.
        """
        plain = {"out_of_round": (), "angle": 0.0, "temperature_rise": 0.0}
        absent = {"back_temperature_rise": None, "speed": None}
        drum = self.drum.model_copy(update=plain | absent)
        # The condensed stiffness depends on whether there is friction, not on its coefficient.
        changes = {
            "title": "-",
            "rotation": self.directions[0],
            "friction_as_written": float(self.friction > 0),
            "drum": drum,
            "springs": (),
            "levers": (),
            "gravity": None,
            "shoe_speed": None,
        }
        return self.model_copy(update=changes)

    def brake_without_ring(self) -> Self:
        """A copy of the brake with a rigid drum."""
        return self.model_copy(update={"drum": self.drum.model_copy(update={"ring": None})})

    def brake_with_perfectly_round_drum(self) -> Self:
        """A copy of the brake with a drum that is not out of round."""
        return self.model_copy(update={"drum": self.drum.model_copy(update={"out_of_round": ()})})

    @property
    def out_of_round_harmonics(self) -> tuple[OutOfRoundHarmonic, ...]:
        """Harmonics of the deviation of the drum's surface from its circle.

        The growth of a heated drum is a harmonic of order 0.
        """
        growth = radial_growth_of_heated_drum(
            self.drum, self.shoes[0].sign_internal_plus_external_minus
        )
        heat = (OutOfRoundHarmonic(order=0, amplitude=growth),) if growth else ()
        return self.drum.out_of_round + heat

    def radial_deviation_of_drum_surface(self, theta: Floats) -> Floats | None:
        """Radial deviation [m] of a drum that is out of round, at angles theta [rad], same shape.

        The deviation is positive where the friction surface lies outside the drum's circle. The
        result is None for a round drum.
        """
        harmonics = self.out_of_round_harmonics
        return radial_deviation_of_drum(harmonics, self.drum.angle, theta) if harmonics else None

    @model_validator(mode="before")
    @classmethod
    def _repeat_shoes_that_have_pattern(cls, data: object, info: ValidationInfo) -> object:
        """Return the data with several shoes in place of each shoe that has a pattern."""
        return brake_data_with_patterned_shoes_repeated(
            data, DrumShoe, shoe_motion_of_turn_about_drum_centre, info
        )

    @model_validator(mode="after")
    def _check_shoes_and_set_drive_forces(self, info: ValidationInfo) -> Self:
        """Check drum and shoes, and give the shoes the forces of the drive and of the struts.

        Returns the brake with these forces. Raises ValueError if the parts do not fit together.
        """
        check_shoe_names_differ([shoe.name for shoe in self.shoes])
        check_friction_tables_have_sliding_speed(self, "drum.speed", self.drum.speed is not None)
        self.check_brake_has_friction_if_lining_has()
        # Numbers of a brake file need a unit, and numbers that a program gives do not. The entry
        # `unit_required` of the context is true for a brake file.
        from_file = bool((info.context or {}).get("unit_required"))
        shoes = shoes_with_forces_of_drive_and_struts(self, file=from_file)
        _check_part_is_thick_enough("drum.ring", self.drum.ring, self.drum.radius)
        check_thermal_expansion_of_drum_is_known(self.drum)
        check_thermal_expansion_of_shoes_is_known(shoes)
        _check_drum_is_round_enough(self.drum, shoes[0].sign_internal_plus_external_minus)
        for i, shoe in enumerate(shoes):
            _check_shoe_fits_drum(f"shoe[{i}]", shoe, self.drum.radius)
            several = len(shoe.lining.linings) > 1
            for k, part in enumerate(shoe.lining.linings):
                key = f"shoe[{i}].lining[{k}].misfit" if several else f"shoe[{i}].lining.misfit"
                _check_lining_misfit_is_small(key, part, self.drum.radius)
        return brake_with_loads_assigned_to_shoes(self.model_copy(update={"shoes": shoes}))


def _check_drum_is_round_enough(drum: Drum, sign: int) -> None:
    """Raise ValueError if a drum deviates from its circle by too much.

    The limit is LARGEST_ALLOWED_RELATIVE_MISFIT times the radius.

    A drum deviates by its harmonics, and by its growth when it is heated. `sign` is +1 for a drum
    around its shoes and -1 for a drum within its shoes.
    """
    # In the worst case the amplitudes of all harmonics add up at some angle.
    off = sum(abs(lobes.amplitude) for lobes in drum.out_of_round)
    most = LARGEST_ALLOWED_RELATIVE_MISFIT * drum.radius
    if off > most:
        raise ValueError(
            f"drum.out_of_round = {length_as_text_in_mm(off)} in all: "
            f"must be at most {LARGEST_ALLOWED_RELATIVE_MISFIT:g} R = {length_as_text_in_mm(most)}"
        )
    growth = radial_growth_of_heated_drum(drum, sign)
    if abs(growth) > most:
        raise ValueError(
            f"drum.temperature_rise = {drum.temperature_rise:g} K: the radius grows by "
            f"{length_as_text_in_mm(growth)}; must be at most "
            f"{LARGEST_ALLOWED_RELATIVE_MISFIT:g} R = {length_as_text_in_mm(most)}"
        )


def _check_lining_misfit_is_small(key: str, lining: Lining, radius: float) -> None:
    """Raise ValueError if a lining's misfit is too large, or its blocks are not on the lining.

    `radius` [m] is the drum's radius, to which the largest misfit is proportional. `key` is the key
    of the misfit in the message.
    """
    misfit, most = lining.misfit, LARGEST_ALLOWED_RELATIVE_MISFIT * radius
    allowed = f"{LARGEST_ALLOWED_RELATIVE_MISFIT:g} R = {length_as_text_in_mm(most)}"
    if misfit.radius is not None and abs(misfit.radius - radius) > most:
        raise ValueError(
            f"{key}.radius = {length_as_text_in_mm(misfit.radius)}: "
            f"must be within {allowed} of drum.radius = {length_as_text_in_mm(radius)}"
        )
    misfit.check_misfit_size_and_blocks(
        key,
        (lining.start, lining.end),
        lining.length_of_step_between_blocks,
        angle_as_text_in_degrees,
        most,
        allowed,
    )


SMALLEST_PART_THICKNESS_OVER_DRUM_RADIUS = 1e-9
"""Smallest allowed thickness of a part in the brake's plane, relative to the drum's radius.

A thinner part is refused, because round-off would distort its finite elements.
"""


def _check_part_is_thick_enough(
    key: str,
    part: "Lining | Backing | ArcBody | BeamBody | DrumRing | TableOfTSection | None",
    radius: float,
) -> None:
    """Raise ValueError for a part that is too thin for the drum's radius [m].

    The limit is SMALLEST_PART_THICKNESS_OVER_DRUM_RADIUS times the radius.
    """
    thickness = None if part is None else part.thickness
    if thickness is not None and thickness < SMALLEST_PART_THICKNESS_OVER_DRUM_RADIUS * radius:
        raise ValueError(
            f"{key}.thickness = {length_as_text_in_mm(thickness)}: "
            f"must be at least {SMALLEST_PART_THICKNESS_OVER_DRUM_RADIUS:g} of drum.radius = "
            f"{length_as_text_in_mm(radius)}"
        )


def _check_shoe_fits_drum(key: str, shoe: DrumShoe, radius: float) -> None:
    """Raise ValueError if parts of a shoe do not fit each other or a drum of this radius [m]."""
    table = shoe.body.table if isinstance(shoe.body, ArcBody) else None
    parts = {"lining": shoe.lining, "backing": shoe.backing, "body": shoe.body, "body.table": table}
    for name, part in parts.items():
        _check_part_is_thick_enough(f"{key}.{name}", part, radius)
    if shoe.hinge is not None and shoe.hinge.radius < 1e-9 * radius:
        raise ValueError(
            f"{key}.hinge = (0, 0): must not be the drum's centre, "
            "about which the shoe would only slide"
        )
    for first, last in shoe.lining.slots:
        if last - first < SMALLEST_ANGLE_OF_SLOT_BETWEEN_LININGS:
            raise ValueError(
                f"{key}.lining: the slot from {angle_as_text_in_degrees(first)} to "
                f"{angle_as_text_in_degrees(last)} "
                "must be at "
                f"least {angle_as_text_in_degrees(SMALLEST_ANGLE_OF_SLOT_BETWEEN_LININGS)} "
                f"wide; linings that touch are one lining"
            )
    check_shoe_on_abutment_has_no_grip(key, shoe)
    _check_support_lets_shoe_press_on_drum(key, shoe, radius)
    # The layers of an internal shoe must end before the drum's centre.
    if shoe.sign_internal_plus_external_minus > 0 and shoe.total_thickness >= radius:
        raise ValueError(
            f"{key}: lining, backing and body are "
            f"{length_as_text_in_mm(shoe.total_thickness)} thick "
            f"together; must be less than drum.radius = {length_as_text_in_mm(radius)}"
        )
    if isinstance(shoe.body, BeamBody):
        _check_beam_fits_outside_drum(key, shoe, radius)
    if isinstance(shoe.body, ArcBody):
        _check_arc_carries_lining(key, shoe.body, shoe.lining)


def _check_arc_carries_lining(key: str, body: ArcBody, lining: Lining) -> None:
    """Raise ValueError if an arc body has no length, or if its lining extends beyond it."""
    if not 0 < body.end - body.start < 2 * math.pi:
        raise ValueError(
            f"{key}.body.end = {angle_as_text_in_degrees(body.end)}: must be greater than "
            f"body.start = "
            f"{angle_as_text_in_degrees(body.start)}, "
            f"by less than 360 deg{did_you_mean_hint_for_angles_of_arc(body.start, body.end)}"
        )
    # Equal angles that a file gives in degrees may differ by round-off.
    slack = 1e-9  # rad
    if lining.start < body.start - slack or lining.end > body.end + slack:
        hint = "; angles count counter-clockwise from +x, not from the hinge"
        # The file may give the angles of lining and body some whole turns apart.
        middle = 0.5 * (body.start + body.end)
        turns = 2 * math.pi * round((middle - lining.middle) / (2 * math.pi))
        start, end = lining.start + turns, lining.end + turns
        if body.start - slack <= start and end <= body.end + slack:
            hint = (
                f" (did you mean {angle_as_text_in_degrees(start)} to "
                f"{angle_as_text_in_degrees(end)}?)"
            )
        raise ValueError(
            f"{key}.lining = {angle_as_text_in_degrees(lining.start)} to "
            f"{angle_as_text_in_degrees(lining.end)}: "
            f"must lie within the body, {angle_as_text_in_degrees(body.start)} to "
            f"{angle_as_text_in_degrees(body.end)}{hint}"
        )


def check_shoe_on_abutment_has_no_grip(key: str, shoe: SupportedShoe) -> None:
    """Raise ValueError if a shoe on an abutment has a `grip`, which only other supports use.

    An abutment holds the end face of the shoe's body, and a grip is a length of its back.
    """
    body = getattr(shoe, "body", None)
    if (
        shoe.abutment is not None
        and isinstance(body, ShoeBodyOfConstantSection)
        and body.grip is not None
    ):
        raise ValueError(
            f"{key}.body.grip = {length_as_text_in_mm(body.grip)}: "
            "an abutment holds the body's end face; leave it out"
        )


def _check_beam_fits_outside_drum(key: str, shoe: DrumShoe, radius: float) -> None:
    """Raise ValueError if a straight shoe beam does not fit outside a drum of this radius [m]."""
    shown = f'{key}.body.shape = "beam"'
    if shoe.sign_internal_plus_external_minus > 0 or shoe.kind_of_support != "hinge":
        raise ValueError(f"{shown}: only for an external shoe that turns about its hinge")
    if math.dist(shoe.actuation.point.xy, shoe.pin.xy) < 1e-6 * radius:
        raise ValueError(
            f"{shown}: the actuation's point is the beam's loaded end and must not be the hinge"
        )
    # The axis of the beam, from the hinge to the point of actuation, must pass outside the drum.
    axis = make_beam_axis(shoe.pin.xy, shoe.actuation.point.xy)
    if axis.distance_from_drum_centre <= radius:
        raise ValueError(
            f"{shown}: the line from the hinge to the actuation's point passes "
            f"{length_as_text_in_mm(axis.distance_from_drum_centre)} from the drum's centre; "
            f"must be more than drum.radius = {length_as_text_in_mm(radius)}"
        )
    # The rays from the drum's centre through the lining's ends must meet the beam.
    ends = axis.angle(np.array([shoe.lining.start, shoe.lining.end]))
    x = axis.x_of_perpendicular_foot + radius * np.sin(ends)
    if np.abs(ends).max() >= 0.5 * math.pi or x.min() < 0 or x.max() > axis.length:
        raise ValueError(
            f"{key}.lining = {angle_as_text_in_degrees(shoe.lining.start)} to "
            f"{angle_as_text_in_degrees(shoe.lining.end)}: "
            "must lie between the beam's ends and less than 90 deg from where the beam is "
            "nearest to the drum"
        )


def _check_support_lets_shoe_press_on_drum(key: str, shoe: DrumShoe, radius: float) -> None:
    """Raise ValueError if the support of a shoe does not let it press on the drum.

    A guide must lead the lining to the drum. Abutment and pivot must not lie at the drum's centre.
    If a shoe has two rigid-body modes, they must not close its gap in the same way.
    """
    if shoe.guide is not None:
        # The component of the guide's direction along the lining's normal must point to the drum.
        away = shoe.sign_internal_plus_external_minus * math.cos(
            shoe.guide.direction - shoe.lining.middle
        )
        if away <= 0:
            shown = f"{key}.guide.direction = {angle_as_text_in_degrees(shoe.guide.direction)}"
            raise ValueError(f"{shown}: must lead the middle of the lining towards the drum")
    if shoe.abutment is not None and shoe.abutment.point.radius < 1e-9 * radius:
        raise ValueError(f"{key}.abutment.point = (0, 0): must not be the drum's centre")
    # `slice(0, 2)` takes the translations dx and dy of each rigid-body mode: a turn about the
    # drum's centre closes no gap.
    if shoe.pivot is None:
        check_rigid_body_modes_close_gap_differently(key, shoe, slice(0, 2))
        return
    shown = (
        f"{key}.pivot = ({length_as_text_in_mm(shoe.pivot.x)}, "
        f"{length_as_text_in_mm(shoe.pivot.y)})"
    )
    if shoe.pivot.radius < 1e-9 * radius:
        raise ValueError(
            f"{shown}: must not be the drum's centre, about which the shoe would only slide"
        )
    if math.dist(shoe.pivot.xy, shoe.pin.xy) < 1e-9 * radius:
        raise ValueError(
            f"{shown}: must not be the hinge; leave it out for a shoe that turns about its hinge"
        )
    check_rigid_body_modes_close_gap_differently(key, shoe, slice(0, 2))
