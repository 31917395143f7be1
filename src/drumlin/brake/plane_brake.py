"""The brake on a plane: classes for a brake file with [plane], and functions that read any brake.

The shoes press on the plane surface of a sliding body. The surface is y = 0, the body lies below it
and the shoes above. A lining reaches from x = start to x = end. The keys are those of a brake on a
drum, with lengths in place of angles.
"""

import math
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, PrivateAttr, ValidationInfo, model_validator

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake, Shoe, ShoeFrame
from drumlin.brake.components import (
    ANGLE_OF_ROUNDED_STEP_BETWEEN_BLOCKS,
    LARGEST_ALLOWED_RELATIVE_MISFIT,
    Backing,
    Lining,
    Misfit,
    ShoeBodyOfConstantSection,
)
from drumlin.brake.drive import (
    DriveOfAllShoes,
    StrutOrStrapBetweenShoes,
    shoes_with_forces_of_drive_and_struts,
)
from drumlin.brake.drum_brake import DrumBrake, check_shoe_on_abutment_has_no_grip
from drumlin.brake.fields import (
    InterpolationTable,
    IsotropicOrOrthotropicMaterial,
    Length,
    PartOfInputFile,
    Point,
    Speed,
    TemperatureRise,
    Thickness,
    Title,
    check_shoe_names_differ,
    make_validator_of_number_or_table,
    make_validator_of_table_with_growing_coordinates,
    make_validator_that_tabulates_function_along_lining,
)
from drumlin.brake.file import (
    make_validated_brake_part,
    name_of_shoe_in_error_line,
    parse_text_of_brake_file,
    read_data_of_brake_file,
)
from drumlin.brake.friction import FrictionOrTable, check_friction_tables_have_sliding_speed
from drumlin.brake.further_loads import Gravity, Lever, Spring, brake_with_loads_assigned_to_shoes
from drumlin.brake.heat import check_thermal_expansion_of_shoes_is_known
from drumlin.brake.off_circle import gaps_of_pad_ground_to_circle
from drumlin.brake.pattern import (
    FlatPattern,
    brake_data_with_patterned_shoes_repeated,
    shoe_motion_of_shift_along_plane,
)
from drumlin.brake.support import check_rigid_body_modes_close_gap_differently
from drumlin.brake.surface import FRICTION_SURFACE_OF_PLANE
from drumlin.brake.units import angle_as_text_in_degrees, length_as_text_in_mm


class Plane(PartOfInputFile):
    """The sliding plane y = 0 and the direction in which the body slides.

    `speed` [m/s] is the sliding speed, on which a friction coefficient may depend.
    """

    sliding: Literal["+x", "-x"]
    speed: Speed | None = None


class FlatMisfit(Misfit):
    """Deviation of a pad's face from the plane, besides its clearance.

    `radius` [m] is the radius of a face that is ground to a circle: positive for a crowned face,
    negative for a hollow face. The circle touches the plane at the middle of the lining. `blocks`
    are rows (x, depth) [m]. The other keys are as in `Misfit`, for a lining on a drum.
    """

    radius: Length | None = None
    blocks: Annotated[
        InterpolationTable,
        make_validator_of_table_with_growing_coordinates("place", "m", "depth", "m"),
    ] = ()


class FlatLining(Lining):
    """The friction lining on a plane from x = `start` to x = `end` [m], with the `width` [m].

    Finite elements need `thickness` [m] and `material`. `clearance` [m] is the gap between unloaded
    lining and plane, positive if open: a number, or a table of rows (x, clearance) with linear
    interpolation. The gap due to the `misfit` is added to it. `friction` is the friction
    coefficient of this lining, or a table of coefficients; by default the lining has the friction
    of the brake.
    """

    start: Length
    end: Length
    width: Thickness
    thickness: Thickness | None = None  # type: ignore[assignment]
    material: IsotropicOrOrthotropicMaterial | None = None  # type: ignore[assignment]
    clearance: Annotated[
        float | InterpolationTable,
        make_validator_of_number_or_table("place", "m", "clearance", "m"),
        make_validator_that_tabulates_function_along_lining(),
    ] = 0.0
    misfit: FlatMisfit = FlatMisfit()
    friction: FrictionOrTable | None = None
    temperature_rise: TemperatureRise = 0.0
    back_temperature_rise: TemperatureRise | None = None

    @model_validator(mode="after")
    def _check_lining_ends_and_misfit_size(self) -> Self:
        """Raise ValueError for ends in the wrong order or a misfit that is too large."""
        long, radius = self.end - self.start, self.misfit.radius
        if long <= 0:
            raise ValueError(
                f"end = {length_as_text_in_mm(self.end)} must be greater than start = "
                f"{length_as_text_in_mm(self.start)}"
            )
        # `least` is the radius with which a face has the largest allowed gap, `most`, at its ends.
        most = LARGEST_ALLOWED_RELATIVE_MISFIT * long
        least = long / (8 * LARGEST_ALLOWED_RELATIVE_MISFIT)
        if radius is not None and abs(radius) < least:
            raise ValueError(
                f"misfit.radius = {length_as_text_in_mm(radius)}: must be at least "
                f"{length_as_text_in_mm(least)} "
                "either way, "
                f"{1 / (8 * LARGEST_ALLOWED_RELATIVE_MISFIT):g} times the lining's length"
            )
        allowed = (
            f"{LARGEST_ALLOWED_RELATIVE_MISFIT:g} of the lining's length, "
            f"{length_as_text_in_mm(most)}"
        )
        self.misfit.check_misfit_size_and_blocks(
            "misfit",
            (self.start, self.end),
            self.length_of_step_between_blocks,
            length_as_text_in_mm,
            most,
            allowed,
        )
        return self

    @property
    def length_of_step_between_blocks(self) -> float:
        """Length [m] over which the face rises smoothly from one block's height to the next."""
        return ANGLE_OF_ROUNDED_STEP_BETWEEN_BLOCKS * (self.end - self.start)


class FlatBody(ShoeBodyOfConstantSection):
    """An elastic shoe body on a plane: a straight bar from x = `start` to x = `end` [m]."""

    start: Length
    end: Length

    @property
    def shape(self) -> str:
        """Always "arc": finite elements treat a straight bar as an arc, in the coordinate phi."""
        return "arc"


class FlatFrame(ShoeFrame):
    """The coordinates of a shoe on a plane, with the origin on the plane at the x of the pin.

    A point has two coordinates [m]: the distance from the origin along the plane, positive towards
    the lining, and the height above the plane.
    """

    def convert_vectors_from_shoe_to_brake_frame(self, vectors: Floats) -> Floats:
        """Convert vectors (..., 2) from the frame of the shoe to the frame of the brake."""
        # If the lining lies towards -x from the pin, the frame of the shoe is mirrored.
        return np.asarray(vectors) * np.array([float(self.sense), 1.0])

    def convert_vectors_to_shoe_frame(self, vectors: Floats) -> Floats:
        """Convert vectors (..., 2) from the frame of the brake to the frame of the shoe."""
        # Mirroring is its own inverse.
        return self.convert_vectors_from_shoe_to_brake_frame(vectors)


class FlatShoe(Shoe):
    """A shoe with a flat lining, its support and its actuation. Without `body` it is rigid."""

    surface = FRICTION_SURFACE_OF_PLANE
    _size: float | None = PrivateAttr(None)

    lining: FlatLining
    backing: Backing | None = None
    body: FlatBody | None = None
    pattern: FlatPattern | None = None

    @model_validator(mode="after")
    def _check_lining_lies_on_body(self) -> Self:
        """Raise ValueError if the lining extends beyond the elastic body of the shoe."""
        lining, body = self.lining, self.body
        # Equal ends that a file gives in different units may differ by round-off.
        slack = 1e-9 * (lining.end - lining.start)
        if body and not body.start - slack <= lining.start < lining.end <= body.end + slack:
            raise ValueError(
                f"lining = {length_as_text_in_mm(lining.start)} to "
                f"{length_as_text_in_mm(lining.end)}: "
                f"must lie within the body, {length_as_text_in_mm(body.start)} to "
                f"{length_as_text_in_mm(body.end)}"
            )
        return self

    @property
    def side(self) -> str:
        """Always "internal": a shoe on a plane is treated like a shoe inside a drum."""
        return "internal"

    @property
    def size(self) -> float:
        """Size [m] of the brake to which the shoe belongs: the length of the first shoe's lining.

        For a shoe without a brake the result is the length of the shoe's own lining.
        """
        return self.lining.end - self.lining.start if self._size is None else self._size

    def copy_of_shoe_for_brake_of_size(self, size: float) -> Self:
        """A copy of the shoe that belongs to a brake of this size [m]."""
        shoe = self.model_copy()
        shoe._size = size
        return shoe

    @cached_property
    def frame(self) -> FlatFrame:
        """The frame of the shoe: its first coordinate grows from the pin towards the lining."""
        sense = 1 if self.lining.middle >= self.pin.x else -1
        return FlatFrame(self.pin.x, sense, self.size)

    @property
    def pin_position_in_shoe_frame(self) -> Floats:
        """Position (2,) [m] of the pin (`SupportedShoe.pin`) in the frame of the shoe."""
        return np.array([0.0, self.pin.y])

    def convert_points_to_shoe_frame(self, xy: Floats) -> Floats:
        """Convert points (..., 2) [m] from the frame of the brake to the frame of the shoe."""
        return self.frame.convert_vectors_to_shoe_frame(
            np.asarray(xy) - np.array([self.pin.x, 0.0])
        )

    def convert_points_to_brake_frame(self, xy: Floats) -> Floats:
        """Convert points (2, n) [m] from the frame of the shoe to the frame of the brake."""
        return np.array([self.pin.x + self.frame.sense * xy[0], xy[1]])

    def points_at_depth_and_coordinate_phi(self, depth: Floats, phi: Floats, size: float) -> Floats:
        """Points (2, ...) [m] at a height `depth` [m] above the plane and a coordinate phi.

        The points are in the frame of the shoe; `size` [m] is the length of phi = 1.
        """
        return np.stack(np.broadcast_arrays(size * phi, depth))

    def distances_from_friction_surface(self, xy: Floats, size: float) -> Floats:
        """Height [m] above the plane of points (2, ...) [m] that are in the frame of the shoe."""
        return np.asarray(xy[1])

    def surface_coordinates_of_points_in_shoe_frame(self, xy: Floats, size: float) -> Floats:
        """Coordinate phi of points (2, ...) [m] that are in the frame of the shoe.

        `size` [m] is the length of phi = 1.
        """
        return np.asarray(xy[0] / size)

    def drum_angle_or_plane_x_of_point(self, point: Point) -> float:
        """Coordinate x [m] of a point, which is its coordinate along the plane."""
        return point.x

    def length_along_shoe_back_per_unit_of_phi(self, size: float) -> float:
        """Length [m] along the back of the shoe's body per unit of phi."""
        return size

    @property
    def angle_of_direction_in_which_lining_closes_gap(self) -> float:
        """Angle [rad] of the normal from the lining towards the plane: -90 deg."""
        return -math.pi / 2

    def gaps_due_to_ground_lining_radius_and_offset(self, theta: Floats, size: float) -> Floats:
        """Gap [m] of a face that is ground to a circle, at the coordinates x [m], same shape."""
        misfit = self.lining.misfit
        return gaps_of_pad_ground_to_circle(
            misfit.radius, misfit.offset, theta - self.lining.middle
        )


class FlatBrake(Brake):
    """A brake on a plane with its friction coefficient, sliding plane and shoes."""

    surface = FRICTION_SURFACE_OF_PLANE
    direction_key = "plane.sliding"
    directions = ("+x", "-x")

    title: Title
    friction_as_written: Annotated[FrictionOrTable, Field(alias="friction")]
    plane: Plane
    shoes: Annotated[tuple[FlatShoe, ...], Field(alias="shoe", min_length=1)]
    actuation: DriveOfAllShoes | None = None
    links: Annotated[tuple[StrutOrStrapBetweenShoes, ...], Field(alias="link")] = ()
    springs: Annotated[tuple[Spring, ...], Field(alias="spring")] = ()
    levers: Annotated[tuple[Lever, ...], Field(alias="lever")] = ()
    gravity: Gravity | None = None

    @property
    def shoe_speed(self) -> float | None:
        """Always None: shoes on a plane do not turn about a drum's centre."""
        return None

    @property
    def sliding_speed(self) -> float | None:
        """Speed [m/s] at which the body slides; None if it is not given."""
        return self.plane.speed

    @property
    def direction(self) -> str:
        """The direction in which the body slides."""
        return self.plane.sliding

    @property
    def size(self) -> float:
        """Reference length of the brake [m]: the length of the first lining."""
        return self.shoes[0].size

    def brake_with_reversed_motion(self) -> Self:
        """A copy of the brake whose body slides in the opposite direction."""
        plane = self.plane.model_copy(update={"sliding": self.opposite_direction_of_motion})
        return self.model_copy(update={"plane": plane})

    def brake_reduced_to_stiffness_data(self) -> Self:
        """The brake reduced to data that change the condensed stiffness of its shoes.

        Title and direction get fixed values, and a friction coefficient above 0 becomes 1. The
        speed, springs, levers and gravity are removed.
        """
        changes = {
            "title": "-",
            "friction_as_written": float(self.friction > 0),
            "plane": Plane(sliding="+x"),
            "springs": (),
            "levers": (),
            "gravity": None,
        }
        return self.model_copy(update=changes)

    @model_validator(mode="before")
    @classmethod
    def _repeat_shoes_that_have_pattern(cls, data: object, info: ValidationInfo) -> object:
        """Return the data with several shoes in place of each shoe that has a pattern."""
        return brake_data_with_patterned_shoes_repeated(
            data, FlatShoe, shoe_motion_of_shift_along_plane, info
        )

    @model_validator(mode="after")
    def _check_shoes_and_set_drive_forces(self, info: ValidationInfo) -> Self:
        """Check the shoes and give them the forces of the drive and of the struts.

        Returns the brake with these forces. Raises ValueError if the parts do not fit together.
        """
        check_shoe_names_differ([shoe.name for shoe in self.shoes])
        check_friction_tables_have_sliding_speed(self, "plane.speed", self.plane.speed is not None)
        self.check_brake_has_friction_if_lining_has()
        # Numbers of a brake file need a unit, and numbers that a program gives do not. The entry
        # `unit_required` of the context is true for a brake file.
        from_file = bool((info.context or {}).get("unit_required"))
        shoes = shoes_with_forces_of_drive_and_struts(self, file=from_file)
        # The length of the first lining is the size of the brake, which all its shoes must know.
        size = shoes[0].lining.end - shoes[0].lining.start
        shoes = tuple(shoe.copy_of_shoe_for_brake_of_size(size) for shoe in shoes)
        check_thermal_expansion_of_shoes_is_known(shoes)
        for i, shoe in enumerate(shoes):
            check_shoe_on_abutment_has_no_grip(f"shoe[{i}]", shoe)
            # `slice(1, 3)` takes dy and the turn of each rigid-body mode: a translation along x
            # does not close the gap to a plane.
            check_rigid_body_modes_close_gap_differently(f"shoe[{i}]", shoe, slice(1, 3))
            if shoe.guide is not None and abs(math.sin(shoe.guide.direction)) < 1e-6:
                shown = (
                    f"shoe[{i}].guide.direction = {angle_as_text_in_degrees(shoe.guide.direction)}"
                )
                raise ValueError(f"{shown}: must lead to the plane, not along it")
        return brake_with_loads_assigned_to_shoes(self.model_copy(update={"shoes": shoes}))


def make_drum_or_plane_brake_from_data(
    data: Mapping[str, Any], *, unit_required: bool = False, base: Path | None = None
) -> Brake:
    """Make a brake from the nested data of a brake file.

    Data with the table [plane] give a brake on a plane, other data a brake on a drum. Raises
    BadInput for wrong data.

    Parameters
    ----------
    data : nested tables of keys and values
    unit_required : whether numbers without unit are refused; otherwise they count as SI
    base : folder from which relative paths of mesh files start
    """
    return make_validated_brake_part(
        Brake.brake_class_for_file_data(data), data, unit_required=unit_required, base=base
    )


def read_drum_or_plane_brake(path: Path | str, text: str | None = None) -> Brake:
    """Read a brake from a TOML file: with the table [plane] a brake on a plane, else on a drum.

    Parameters
    ----------
    path : path of the file, in which every quantity has a unit
    text : content of the file if it has been read already

    Returns
    -------
    Brake
        frozen data in SI units, checked key by key

    Raises
    ------
    BadInput
        for a file that cannot be read or is no brake: one line that names the key, the value and
        what is allowed

    Examples
    --------
    >>> drumlin.read_brake("brake.toml").friction
    0.3
    """
    path = Path(path)
    data = read_data_of_brake_file(path) if text is None else parse_text_of_brake_file(text, path)
    try:
        return make_drum_or_plane_brake_from_data(data, unit_required=True, base=path.parent)
    except BadInput as error:
        raise BadInput(f"{path}: {error}{name_of_shoe_in_error_line(str(error), data)}") from error


def brake_itself_or_read_from_file(brake: Any) -> Brake:
    """The given brake; if the path of a brake file is given, the brake that is read from the file.

    Raises BadInput for any other argument, and for a file that `read_drum_or_plane_brake` refuses.
    """
    if isinstance(brake, str | Path):
        return read_drum_or_plane_brake(brake)
    if not isinstance(brake, Brake):
        raise BadInput(
            f"brake: must be a Brake or the path of a brake file, not {type(brake).__name__}"
        )
    return brake


def read_brake_that_must_be_on_drum(path: Path, what: str, text: str | None = None) -> Brake:
    """Read a brake from a TOML file and require that it is a brake on a drum.

    `text` is the content of the file if it has been read already. Raises BadInput as
    `read_drum_or_plane_brake` does, and for a brake on a plane; `what` names the computation that
    needs a drum.
    """
    brake = read_drum_or_plane_brake(path, text)
    if not isinstance(brake, DrumBrake):
        raise BadInput(f"{path}: is a brake on a plane; {what} takes brakes on a drum")
    return brake
