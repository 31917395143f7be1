"""The parts of a brake: drum and its ring, lining, backing, shoe bodies, actuation.

All quantities are in SI units.
"""

import math
from abc import abstractmethod
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, NamedTuple, Self

import numpy as np
from pydantic import (
    Discriminator,
    Field,
    SerializerFunctionWrapHandler,
    Tag,
    model_serializer,
    model_validator,
)

from drumlin.base.arrays import Floats, Ints
from drumlin.brake.fields import (
    Angle,
    AngularSpeed,
    BendingStiffness,
    CartesianOrPolarPoint,
    Force,
    InterpolationTable,
    IsotropicOrOrthotropicMaterial,
    Length,
    Material,
    PartOfInputFile,
    Point,
    TemperatureRise,
    ThermalExpansionCoefficient,
    Thickness,
    interpolate_number_or_table,
    make_validator_of_number_or_table,
    make_validator_of_table_with_growing_coordinates,
    make_validator_that_tabulates_function_along_lining,
)
from drumlin.brake.friction import FrictionOrTable, FrictionTable
from drumlin.brake.units import angle_as_text_in_degrees, length_as_text_in_mm


class RectangularCrossSection(NamedTuple):
    """A rectangular cross-section of a ring, a beam or an arc.

    Attributes
    ----------
    thickness : thickness in the plane of the brake [m]
    width : width normal to the plane of the brake [m]
    material : material of the section
    """

    thickness: float
    width: float
    material: IsotropicOrOrthotropicMaterial

    @property
    def bending_stiffness(self) -> float:
        """Bending stiffness EI [N m^2] of the section in the plane of the brake."""
        return self.material.E_along * self.width * self.thickness**3 / 12


class BondedPlateStiffnesses(NamedTuple):
    """The neutral axis and the stiffnesses of bonded plates that bend as one beam.

    Attributes
    ----------
    depth_of_neutral_axis : depth of the neutral axis below the outer face of the first plate [m]
    EI : bending stiffness of all plates together, about the neutral axis [N m^2]
    EA : stiffness in tension, the sum over the plates [N]
    GA : stiffness in shear, the sum over the plates [N]
    """

    depth_of_neutral_axis: float
    EI: float
    EA: float
    GA: float


def stiffnesses_of_bonded_plates(
    plates: Sequence[RectangularCrossSection],
) -> BondedPlateStiffnesses:
    """The stiffnesses of plates that are bonded to each other and bend as one beam.

    `plates` are the cross-sections in the order in which they lie on each other.
    """
    t = np.array([plate.thickness for plate in plates])
    width = np.array([plate.width for plate in plates])
    E = np.array([plate.material.E_along for plate in plates])
    G = np.array([plate.material.G_along_through for plate in plates])
    # The neutral axis is the mean of the plates' middles, weighted by stiffness in tension.
    EA, GA = E * width * t, G * width * t
    own = np.array([plate.bending_stiffness for plate in plates])
    # Distances of the plates' middles from the outer face of the first plate.
    middle = np.cumsum(t) - t / 2
    depth = float(EA @ middle / EA.sum())
    # By Steiner's theorem a plate off the neutral axis adds EA times the square of its distance.
    EI = own + EA * (middle - depth) ** 2
    return BondedPlateStiffnesses(depth, float(EI.sum()), float(EA.sum()), float(GA.sum()))


STEEL_OF_PARTS_WITHOUT_GIVEN_MATERIAL = Material(E=210e9, nu=0.3)
"""Material of a part for which a brake file gives the bending stiffness but no material.

The width is then chosen to give the bending stiffness. Young's modulus itself does not matter,
because plane stress depends only on its product with the width.
"""


def _cross_section_or_none_if_unknown(
    part: "DrumRing | BeamBody | ShoeBodyOfConstantSection", EI: float | None
) -> RectangularCrossSection | None:
    """The cross-section of a ring, a beam or an arc; None if it is unknown.

    If the bending stiffness `EI` [N m^2] is given, the width of the section is chosen to give it.
    """
    if part.thickness is None:
        return None
    if EI is None:
        if part.width is None or part.material is None:
            return None
        return RectangularCrossSection(part.thickness, part.width, part.material)
    # The width and material may be arbitrary, since the width is scaled to the bending stiffness.
    section = RectangularCrossSection(
        part.thickness, part.width or 1.0, part.material or STEEL_OF_PARTS_WITHOUT_GIVEN_MATERIAL
    )
    return section._replace(width=section.width * EI / section.bending_stiffness)


def _check_section_or_stiffness_is_given(part: "DrumRing | BeamBody") -> None:
    """Raise ValueError unless a part has a complete cross-section or a bending stiffness.

    A cross-section is thickness, width and material. With a bending stiffness the part may also
    have the thickness alone.
    """
    given = {key for key in ("thickness", "width", "material") if getattr(part, key) is not None}
    if len(given) < 3 and (part.bending_stiffness is None or given - {"thickness"}):
        raise ValueError(
            "needs thickness, width and material, or bending_stiffness, "
            "or that and thickness, or all four"
        )


RING_EDGE_SUPPORTS_THAT_ALL_MODELS_TAKE = ("fixed", "free")
"""Supports of the ring's far edge (away from the shoes) that every model can take."""


class DrumRing(PartOfInputFile):
    """The elastic rim of the drum, which lies behind its friction surface as seen from the shoe.

    It has a cross-section (thickness, width and material), or a `bending_stiffness` EI [N m^2], or
    both: the width then becomes the width that gives this EI. A mesh needs the thickness and EI at
    least. `support` says whether the rim's edge away from the shoes is fixed or free.
    """

    thickness: Thickness | None = None
    width: Thickness | None = None
    material: IsotropicOrOrthotropicMaterial | None = None
    bending_stiffness: BendingStiffness | None = None
    support: Literal["fixed", "free"] = "fixed"

    @model_validator(mode="after")
    def _check_ring_section_is_known(self) -> Self:
        """Raise ValueError unless a complete cross-section or a bending stiffness is given."""
        _check_section_or_stiffness_is_given(self)
        return self

    @property
    def has_fixed_or_free_far_edge(self) -> bool:
        """Whether the ring's edge away from the shoes is simply fixed or free.

        Some models refuse a ring with any other support, see
        `ring_support.reason_if_ring_edge_is_not_fixed_or_free`.
        """
        return self.support in RING_EDGE_SUPPORTS_THAT_ALL_MODELS_TAKE

    @property
    def section(self) -> RectangularCrossSection | None:
        """The cross-section of the ring, with a width that gives the bending stiffness.

        The result is None if the brake file has the bending stiffness but no thickness.
        """
        return _cross_section_or_none_if_unknown(self, self.bending_stiffness)

    @property
    def EI(self) -> float:
        """Bending stiffness of the ring [N m^2]."""
        section = self.section
        return section.bending_stiffness if section else float(self.bending_stiffness or 0.0)


class OutOfRoundHarmonic(PartOfInputFile):
    """One harmonic of the deviation of a drum's friction surface from its circle.

    The surface lies outside its circle by amplitude cos(order (theta - phase)) [m]. Order 0 is
    growth of the radius (a hot drum), order 1 is run-out, order 2 is ovality.
    """

    order: Annotated[int, Field(ge=0, le=100)]
    amplitude: Length
    phase: Angle = 0.0


class Drum(PartOfInputFile):
    """The drum with the radius R [m] of its friction surface. A drum without `ring` is rigid.

    `out_of_round` has the harmonics of the deviation of the surface from its circle. They turn with
    the drum: `angle` [rad] is the angular position of the drum, and the harmonics are given for
    `angle` = 0. A heated drum grows, see `drumlin.brake.heat`: the temperature rises [K] are
    `temperature_rise` at the friction surface and `back_temperature_rise` at the far edge of the
    ring, and `expansion` [1/K] is the coefficient of thermal expansion. `speed` [rad/s] is the
    angular speed of the drum, on which a friction coefficient may depend.
    """

    hints_on_other_keys: ClassVar[Mapping[str, str]] = {
        "diameter": " (write 'radius', half of the diameter)"
    }

    radius: Thickness
    ring: DrumRing | None = None
    out_of_round: tuple[OutOfRoundHarmonic, ...] = ()
    angle: Angle = 0.0
    temperature_rise: TemperatureRise = 0.0
    back_temperature_rise: TemperatureRise | None = None
    expansion: ThermalExpansionCoefficient | None = None
    speed: AngularSpeed | None = None


# Types of quantities that are a number or a table: for a beam a table over the distance from the
# hinge, for a lining a table over the angle.
BendingStiffnessOrTableAlongBeam = Annotated[
    float | InterpolationTable,
    make_validator_of_number_or_table("distance", "m", "bending stiffness", "N m^2"),
]
AxisOffsetOrTableAlongBeam = Annotated[
    float | InterpolationTable, make_validator_of_number_or_table("distance", "m", "offset", "m")
]
ClearanceOrTableAlongLining = Annotated[
    float | InterpolationTable,
    make_validator_of_number_or_table("angle", "rad", "clearance", "m"),
    make_validator_that_tabulates_function_along_lining(),
]


LARGEST_ALLOWED_RELATIVE_MISFIT = 0.05
"""Largest misfit, relative to the drum's radius or a pad's length; a larger misfit is refused.

A misfit is added to the gap along the drum's radii, which is right for small misfits only.
"""

ANGLE_OF_ROUNDED_STEP_BETWEEN_BLOCKS = math.radians(1.0)
"""Length [rad] over which the face of a lining rises smoothly from one block to the next.

On a plane the length is this number times the lining's length. The edges of blocks are rounded
because under a sharp edge the pressure would be infinite: its peak would grow with every refinement
of the mesh.
"""


class Misfit(PartOfInputFile):
    """Deviation of a lining's surface from the drum's circle, besides its clearance.

    `radius` [m] is the radius of the circle to which the lining is ground, by default the drum's.
    This circle touches the drum's circle at the middle of the lining, and is then moved by `offset`
    [m]. `taper` [m] is the gap at the lining's end away from the hinge minus the gap at its end
    near the hinge. `blocks` are rows (angle, depth) [rad, m]: from each angle on, the surface of
    the lining lies back by the depth. Before the first angle it does not lie back.
    """

    radius: Thickness | None = None
    offset: CartesianOrPolarPoint = Point(x=0.0, y=0.0)
    taper: Length = 0.0
    blocks: Annotated[
        InterpolationTable,
        make_validator_of_table_with_growing_coordinates("angle", "rad", "depth", "m"),
    ] = ()

    def check_misfit_size_and_blocks(
        self,
        key: str,
        ends: tuple[float, float],
        step: float,
        text: Callable[[float], str],
        most: float,
        allowed: str,
    ) -> None:
        """Raise ValueError if the misfit is too large or its blocks are not on the lining.

        Parameters
        ----------
        key : key of the misfit in the message
        ends : coordinates along the surface where the lining begins and ends
        step : length of the rounded step between two blocks, in the surface's coordinate
        text : function that writes a coordinate with its unit
        most : largest allowed misfit [m]
        allowed : text for the largest allowed misfit in the message
        """
        deepest = max((abs(depth) for _, depth in self.blocks), default=0.0)
        sizes = {"offset": self.offset.radius, "taper": self.taper, "blocks": deepest}
        for name, size in sizes.items():
            if abs(size) > most:
                raise ValueError(
                    f"{key}.{name} = {length_as_text_in_mm(size)}: must be at most {allowed}"
                )
        # Two rounded steps must not overlap or extend beyond an end of the lining.
        edges = [ends[0], *(place for place, _ in self.blocks), ends[1]]
        if self.blocks and min(b - a for a, b in pairwise(edges)) <= step:
            places = ", ".join(text(place) for place, _ in self.blocks)
            raise ValueError(
                f"{key}.blocks at {places}: must begin on the lining, "
                f"{text(ends[0])} to {text(ends[1])}, more than {text(step)} from its ends and "
                f"from each other"
            )


class Lining(PartOfInputFile):
    """The friction lining from the coordinate `start` to `end` along the surface.

    It is the common base class of linings on a drum and on a plane.
    """

    # `DrumLining` and `FlatLining` define these as fields, each in the order of its brake file.
    if TYPE_CHECKING:

        @property
        def start(self) -> float: ...
        @property
        def end(self) -> float: ...
        @property
        def thickness(self) -> float: ...
        @property
        def width(self) -> float: ...
        @property
        def material(self) -> IsotropicOrOrthotropicMaterial: ...
        @property
        def clearance(self) -> float | InterpolationTable: ...
        @property
        def misfit(self) -> Misfit: ...
        @property
        def friction(self) -> float | FrictionTable | None: ...
        @property
        def temperature_rise(self) -> float: ...

    @property
    def linings(self) -> "tuple[Lining, ...]":
        """All linings on the shoe by growing coordinate: this lining, or several side by side."""
        return (self,)

    @property
    def linings_with_touching_ones_joined(self) -> "tuple[Lining, ...]":
        """The linings by growing coordinate, where linings that touch are joined to one lining."""
        return self.linings

    @property
    def arcs(self) -> tuple[tuple[float, float], ...]:
        """Coordinates at which each lining on the shoe begins and ends, by growing coordinate.

        Linings that touch count as one. Between two linings is a slot.
        """
        return tuple((part.start, part.end) for part in self.linings_with_touching_ones_joined)

    @property
    def slots(self) -> tuple[tuple[float, float], ...]:
        """Begin and end of each slot between two linings; empty for a single lining."""
        return tuple((one[1], other[0]) for one, other in pairwise(self.arcs))

    @property
    def length_of_shortest_lining(self) -> float:
        """Length of the shortest lining, in the coordinate along the surface (rad on a drum)."""
        return min(end - start for start, end in self.arcs)

    @property
    def middle(self) -> float:
        """Coordinate of the lining's middle along the surface (an angle on a drum)."""
        return 0.5 * (self.start + self.end)

    @property
    @abstractmethod
    def length_of_step_between_blocks(self) -> float:
        """Length of the rounded step between two blocks, in the surface's coordinate."""

    def copy_of_lining_with_changed_fields(self, changes: Mapping[str, object]) -> Self:
        """A copy with other values of some fields: `changes` has them by the names of the fields.

        If a shoe has several linings, each of them gets the values.
        """
        return self.model_copy(update=dict(changes))

    def copy_of_lining_with_other_clearances(
        self, clearances: "Sequence[float | InterpolationTable]"
    ) -> Self:
        """A copy with other clearances, one for each lining; linings that touch count as one.

        A clearance is a length [m] or a table of rows (coordinate, clearance).
        """
        (clearance,) = clearances
        return self.model_copy(update={"clearance": clearance})

    def clearances_at_surface_coordinates(self, theta: Floats) -> Floats:
        """Clearance [m] at the surface coordinates `theta`, same shape; without the misfit."""
        return interpolate_number_or_table(self.clearance, theta)


def did_you_mean_hint_for_angles_of_arc(start: float, end: float) -> str:
    """The hint "(did you mean -70 deg to 55 deg?)" for an arc whose end does not follow its start.

    `start` and `end` are the angles [rad] as the user wrote them. An angle of more than two turns
    is taken as degrees that were written as radians. One turn is subtracted from the start if the
    arc is then less than half a turn, as from 290 deg to 55 deg. In all other cases the hint is "".
    """
    meant = [math.radians(angle) if abs(angle) > 4 * math.pi else angle for angle in (start, end)]
    if meant != [start, end] and 0 < meant[1] - meant[0] < 2 * math.pi:
        return (
            f" (did you mean {angle_as_text_in_degrees(meant[0])} to "
            f"{angle_as_text_in_degrees(meant[1])}?)"
        )
    before = start - 2 * math.pi
    if 0 < end - before < math.pi:
        return (
            f" (did you mean {angle_as_text_in_degrees(before)} to "
            f"{angle_as_text_in_degrees(end)}?)"
        )
    return ""


class DrumLining(Lining):
    """The friction lining on a drum from the angle `start` to the angle `end` [rad].

    `clearance` [m] is the gap between unloaded lining and drum, positive if open: a number, or a
    table of rows (angle, clearance) with linear interpolation. The gap due to the `misfit` is added
    to it. `friction` is the friction coefficient of this lining, or a table of coefficients; by
    default the lining has the friction of the brake.
    """

    hints_on_other_keys: ClassVar[Mapping[str, str]] = {
        "radius": " (write 'misfit.radius', the radius to which the lining is ground)"
    }

    start: Angle
    end: Angle
    thickness: Thickness
    width: Thickness
    material: IsotropicOrOrthotropicMaterial
    clearance: ClearanceOrTableAlongLining = 0.0
    misfit: Misfit = Misfit()
    friction: FrictionOrTable | None = None
    temperature_rise: TemperatureRise = 0.0
    back_temperature_rise: TemperatureRise | None = None

    @property
    def length_of_step_between_blocks(self) -> float:
        """Angle [rad] over which the face rises smoothly from one block's height to the next."""
        return ANGLE_OF_ROUNDED_STEP_BETWEEN_BLOCKS

    @model_validator(mode="after")
    def _check_end_follows_start(self) -> Self:
        """Raise ValueError unless the lining's end follows its start within one turn."""
        if not 0 < self.end - self.start < 2 * math.pi:
            raise ValueError(
                f"end = {angle_as_text_in_degrees(self.end)} must be greater than start = "
                f"{angle_as_text_in_degrees(self.start)}, "
                f"by less than 360 deg"
                f"{did_you_mean_hint_for_angles_of_arc(self.start, self.end)}"
            )
        return self

    @model_validator(mode="after")
    def _check_clearance_table_lies_within_turn_of_lining(self) -> Self:
        """Raise ValueError for a row of the clearance table more than a turn beyond the lining.

        In Python numbers are in rad. An angle beyond this bound was given in degrees.
        """
        rows = self.clearance if isinstance(self.clearance, tuple) else ()
        for angle, _ in rows:
            if self.start - 2 * math.pi <= angle <= self.end + 2 * math.pi:
                continue
            raise ValueError(
                f"clearance: the row at {angle:.6g} rad is more than a turn beyond the lining from "
                f"{angle_as_text_in_degrees(self.start)} to {angle_as_text_in_degrees(self.end)} "
                f"(did you mean {angle:.6g} deg?)"
            )
        return self


SMALLEST_ANGLE_OF_SLOT_BETWEEN_LININGS = 1e-3
"""Smallest allowed length [rad] of a slot between two linings: 0.15 mm on a drum of radius 150 mm.

A shorter slot is narrower than a saw cut. The two linings could touch each other under load, which
no model computes. The value is a judgement.
"""
LARGEST_ANGLE_BETWEEN_TOUCHING_LININGS = 1e-9
"""Largest distance [rad] between two linings that touch and count as one lining.

Equal angles that a file gives in degrees differ by less, due to round-off.
"""


class DrumLiningRow(Lining):
    """Several linings side by side on one shoe of a drum, by growing angle, with slots between.

    The linings have the same thickness, width, material and temperatures. Each has its own ends,
    clearance and misfit. A brake file has them as `[[shoe.lining]]`, one table for each.
    """

    parts: Annotated[tuple[DrumLining, ...], Field(min_length=1)]

    @model_validator(mode="before")
    @classmethod
    def _wrap_list_of_lining_tables_in_dictionary(cls, data: object) -> object:
        """Return the data as {"parts": data} if they are a list of tables, as in a brake file.

        Other data are returned unchanged.
        """
        return {"parts": data} if isinstance(data, list | tuple) else data

    @model_serializer(mode="wrap")
    def _linings_as_list_of_tables(self, handler: SerializerFunctionWrapHandler) -> object:
        """The linings as plain data: a list of tables, as a brake file has them."""
        return handler(self)["parts"]

    @model_validator(mode="after")
    def _check_linings_stand_side_by_side(self) -> Self:
        """Raise ValueError for linings that overlap or are unlike each other."""
        first = self.parts[0]
        for k, (before, part) in enumerate(pairwise(self.parts), start=1):
            _check_lining_is_like_first_one(f"lining[{k}]", part, first)
            apart = part.start - before.end
            if apart < -LARGEST_ANGLE_BETWEEN_TOUCHING_LININGS:
                raise ValueError(
                    f"lining[{k}].start = {angle_as_text_in_degrees(part.start)}: must not be "
                    f"less than "
                    f"lining[{k - 1}].end = {angle_as_text_in_degrees(before.end)}; "
                    "linings stand side by side in the order of growing angles"
                )
            fits = before.clearance == part.clearance and before.misfit == part.misfit == Misfit()
            if apart <= LARGEST_ANGLE_BETWEEN_TOUCHING_LININGS and not fits:
                raise ValueError(
                    f"lining[{k}].start = {angle_as_text_in_degrees(part.start)}: linings "
                    f"that touch are "
                    "one "
                    "lining, and must have the same clearance and no misfit"
                )
        if not self.end - self.start < 2 * math.pi:
            raise ValueError(
                f"linings from {angle_as_text_in_degrees(self.start)} to "
                f"{angle_as_text_in_degrees(self.end)}: "
                "must cover less than 360 deg"
            )
        return self

    @property
    def linings(self) -> tuple[Lining, ...]:
        """The linings by growing angle."""
        return self.parts

    @property
    def linings_with_touching_ones_joined(self) -> tuple[Lining, ...]:
        """The linings by growing angle, where linings that touch are joined to one lining."""
        found = [self.parts[0]]
        for part in self.parts[1:]:
            if part.start - found[-1].end <= LARGEST_ANGLE_BETWEEN_TOUCHING_LININGS:
                found[-1] = found[-1].model_copy(update={"end": part.end})
            else:
                found.append(part)
        return tuple(found)

    @property
    def start(self) -> float:
        """Angle at which the first lining begins [rad]."""
        return self.parts[0].start

    @property
    def end(self) -> float:
        """Angle at which the last lining ends [rad]."""
        return self.parts[-1].end

    @property
    def thickness(self) -> float:
        """Thickness of all linings [m]."""
        return self.parts[0].thickness

    @property
    def width(self) -> float:
        """Width of all linings [m]."""
        return self.parts[0].width

    @property
    def material(self) -> IsotropicOrOrthotropicMaterial:
        """Material of all linings."""
        return self.parts[0].material

    @property
    def friction(self) -> float | FrictionTable | None:
        """Friction coefficient of all linings, or a table; None stands for the brake's friction."""
        return self.parts[0].friction

    @property
    def temperature_rise(self) -> float:
        """Rise of the temperature at the faces of all linings [K]."""
        return self.parts[0].temperature_rise

    @property
    def back_temperature_rise(self) -> float | None:
        """Temperature rise at the backs of the linings [K]; None if it is as at their faces."""
        return self.parts[0].back_temperature_rise

    @property
    def length_of_step_between_blocks(self) -> float:
        """Angle [rad] over which a face rises smoothly from one block's height to the next."""
        return ANGLE_OF_ROUNDED_STEP_BETWEEN_BLOCKS

    def copy_of_lining_with_changed_fields(self, changes: Mapping[str, object]) -> Self:
        """A copy with other values of some fields of every lining, by the names of the fields."""
        parts = tuple(part.model_copy(update=dict(changes)) for part in self.parts)
        return self.model_copy(update={"parts": parts})

    def copy_of_lining_with_other_clearances(
        self, clearances: "Sequence[float | InterpolationTable]"
    ) -> Self:
        """A copy with other clearances, one for each lining; linings that touch count as one.

        A clearance is a length [m] or a table of rows (angle, clearance).
        """
        # Linings that touch are on one arc and have the same clearance.
        starts = [start for start, _ in self.arcs]
        parts = []
        for part in self.parts:
            own = clearances[bisect_right(starts, part.start) - 1]
            parts.append(part.model_copy(update={"clearance": own}))
        return self.model_copy(update={"parts": tuple(parts)})

    def clearances_at_surface_coordinates(self, theta: Floats) -> Floats:
        """Clearance [m] of the linings at the angles `theta`, same shape; without the misfit.

        At an angle in a slot the result is the clearance of the lining before the slot.
        """
        which = indices_of_linings_at_coordinates(self, theta)
        gaps = [part.clearances_at_surface_coordinates(theta) for part in self.parts]
        return np.choose(which, gaps)


def indices_of_linings_at_coordinates(lining: Lining, theta: Floats) -> Ints:
    """For each coordinate `theta` the index, from 0, of the shoe's lining there; same shape.

    A coordinate in a slot belongs to the lining before the slot, and a coordinate before all
    linings to the first lining.
    """
    # A node on the edge of a lining may lie before its start by round-off.
    starts = [part.start - LARGEST_ANGLE_BETWEEN_TOUCHING_LININGS for part in lining.linings[1:]]
    return np.searchsorted(np.array(starts), theta, side="right")


def _check_lining_is_like_first_one(key: str, part: DrumLining, first: DrumLining) -> None:
    """Raise ValueError if a lining of a shoe differs from the shoe's first lining.

    Thickness, width, material, friction and temperature rises must be equal. `key` is the key of
    the lining in the message.
    """
    kelvin = dict.fromkeys(("temperature_rise", "back_temperature_rise"), "{} K".format)
    texts: dict[str, Callable[[Any], str]] = {
        "thickness": length_as_text_in_mm,
        "width": length_as_text_in_mm,
        "material": str,
        "friction": str,
        **kelvin,
    }
    for name, text in texts.items():
        own, of_first = getattr(part, name), getattr(first, name)
        if own != of_first:
            raise ValueError(
                f"{key}.{name} = {text(own)}: must be {text(of_first)}, as of lining[0]; "
                f"linings of one shoe with unlike {name} are not computed"
            )


def _tag_for_one_or_several_linings(data: object) -> str:
    """The tag of the data of a shoe's linings: "one lining" for a table, else "several linings".

    Several linings are a list of tables.
    """
    several = isinstance(data, list | tuple | DrumLiningRow)
    return "several linings" if several else "one lining"


# In a brake file [shoe.lining] is one lining, and a list of tables [[shoe.lining]] is several.
DrumLiningOrDrumLiningRow = Annotated[
    Annotated[DrumLining, Tag("one lining")] | Annotated[DrumLiningRow, Tag("several linings")],
    Discriminator(_tag_for_one_or_several_linings),
]


class Backing(PartOfInputFile):
    """A layer between lining and shoe body, such as a wooden block, as long and wide as the lining.

    If the shoe has several linings, each of them has a backing of its own. If the shoe body is a
    straight beam, the backing fills the space between lining and beam, whatever its thickness.
    """

    thickness: Thickness
    material: IsotropicOrOrthotropicMaterial
    temperature_rise: TemperatureRise = 0.0
    back_temperature_rise: TemperatureRise | None = None


class TableOfTSection(PartOfInputFile):
    """The flange of a shoe body with a T-section; it lies between the lining and the web.

    `thickness` [m] is in the plane of the brake, `width` [m] normal to it.
    """

    thickness: Thickness
    width: Thickness


class ShoeBodyOfConstantSection(PartOfInputFile):
    """An elastic shoe body of constant cross-section behind lining and backing.

    Without a `table` (flange) the section is a rectangle of the `thickness` and `width` [m]. With a
    `table` it is a T-section, whose web has this thickness and width. `bending_stiffness` EI
    [N m^2] may be given in place of width and material or besides them: the width then becomes the
    width that gives this EI. `grip` [m] is the length of the body's back that a pivot or a guide
    holds (by default the thickness), or that is bolted to the lever of a hinge. Without `grip` a
    hinge holds the end face of the body, as an abutment does.
    """

    thickness: Thickness
    width: Thickness | None = None
    material: IsotropicOrOrthotropicMaterial | None = None
    table: TableOfTSection | None = None
    bending_stiffness: BendingStiffness | None = None
    grip: Thickness | None = None
    temperature_rise: TemperatureRise = 0.0
    back_temperature_rise: TemperatureRise | None = None

    # `ArcBody` and `FlatBody` define these as fields: the ends are angles or lengths.
    if TYPE_CHECKING:

        @property
        def shape(self) -> str: ...
        @property
        def start(self) -> float: ...
        @property
        def end(self) -> float: ...

    @model_validator(mode="after")
    def _check_bar_section_and_flange_width(self) -> Self:
        """Raise ValueError unless the section is known and no flange is narrower than its web."""
        if (self.width is None or self.material is None) and (
            self.bending_stiffness is None or self.width
        ):
            raise ValueError("needs width and material, or bending_stiffness, or all three")
        # With a flange it would be unclear whether the stiffness includes the flange.
        if self.table is not None and self.bending_stiffness is not None:
            raise ValueError(
                "table: bending_stiffness is that of the whole body; leave one of them out"
            )
        if self.table is not None and self.width is not None and self.table.width < self.width:
            raise ValueError(
                f"table.width = {length_as_text_in_mm(self.table.width)}: must be at least "
                f"width = {length_as_text_in_mm(self.width)}, the web's"
            )
        return self

    @property
    def plates(self) -> dict[str, RectangularCrossSection]:
        """The rectangles of the cross-section, by the names of their groups of finite elements.

        A T-section has "table", the flange, and then "shoe", the web. Any other section has "shoe"
        only. The order is from the friction surface into the shoe.
        """
        own = _cross_section_or_none_if_unknown(self, self.bending_stiffness)
        # The validator of the body has checked that the section is known.
        assert own is not None
        if self.table is None:
            return {"shoe": own}
        table = RectangularCrossSection(self.table.thickness, self.table.width, own.material)
        return {"table": table, "shoe": own}

    @property
    def total_thickness(self) -> float:
        """Thickness of the body, with the flange of a T-section [m]."""
        return self.thickness + (self.table.thickness if self.table else 0.0)


class ArcBody(ShoeBodyOfConstantSection):
    """An elastic shoe body that is an arc of constant section from angle `start` to `end` [rad]."""

    shape: Literal["arc"] = "arc"
    start: Angle
    end: Angle


class BeamBody(PartOfInputFile):
    """An elastic shoe body that is a straight beam from the hinge to the point of actuation.

    It has a cross-section (thickness, width and material), or a `bending_stiffness` EI [N m^2], or
    both: the width then becomes the width that gives this EI. EI is a number, or a table over the
    distance from the hinge. A mesh needs the thickness and a constant EI at least. If the neutral
    axis is slightly curved, `offset` [m] is a table of its distance from the straight line, over
    the distance from the hinge, positive away from the drum.
    """

    shape: Literal["beam"]
    thickness: Thickness | None = None
    width: Thickness | None = None
    material: IsotropicOrOrthotropicMaterial | None = None
    bending_stiffness: BendingStiffnessOrTableAlongBeam | None = None
    offset: AxisOffsetOrTableAlongBeam = 0.0
    temperature_rise: TemperatureRise = 0.0
    back_temperature_rise: TemperatureRise | None = None

    @model_validator(mode="after")
    def _check_beam_section_and_tables(self) -> Self:
        """Raise ValueError for an incomplete section, EI <= 0, or an offset at the hinge."""
        _check_section_or_stiffness_is_given(self)
        EI = self.bending_stiffness
        if EI is not None:
            values = [value for _, value in EI] if isinstance(EI, tuple) else [EI]
            if min(values) <= 0:
                raise ValueError("bending_stiffness: must be greater than 0")
        # The neutral axis begins at the hinge, on the straight line.
        if float(interpolate_number_or_table(self.offset, np.zeros(1))[0]) != 0:
            raise ValueError(
                "offset: must be a table that starts with 0 at the hinge, "
                'such as [["0 m", "0 mm"], ...]'
            )
        return self

    @property
    def section(self) -> RectangularCrossSection | None:
        """The cross-section of the beam, with a width that gives the bending stiffness.

        The result is None if the bending stiffness varies along the beam, or if the brake file has
        the bending stiffness but no thickness.
        """
        EI = self.bending_stiffness
        return None if isinstance(EI, tuple) else _cross_section_or_none_if_unknown(self, EI)

    @property
    def plates(self) -> dict[str, RectangularCrossSection]:
        """The rectangular cross-section of the beam, by the name "shoe" of its elements' group."""
        assert self.section is not None  # models refuse a beam without section
        return {"shoe": self.section}

    @property
    def total_thickness(self) -> float:
        """Thickness of the beam [m]; 0 if it is unknown."""
        return self.thickness or 0.0

    def bending_stiffness_at_distances_from_hinge(self, x: Floats) -> Floats:
        """Bending stiffness EI [N m^2] at the distances x [m] from the hinge, same shape."""
        if self.bending_stiffness is not None:
            return interpolate_number_or_table(self.bending_stiffness, x)
        section = self.section
        # The validator of the beam has checked that the section is known.
        assert section is not None
        return np.full(np.shape(x), section.bending_stiffness)

    def neutral_axis_offset_at_distances_from_hinge(self, x: Floats) -> Floats:
        """Distance [m] by which the neutral axis lies behind the straight line, away from the drum.

        `x` are distances from the hinge [m]; the result has their shape.
        """
        return interpolate_number_or_table(self.offset, x)


def _tag_for_beam_or_arc_shape_of_shoe_body(data: object) -> str:
    """The value of the key `shape` in the data of a shoe body: "beam" or "arc", the default."""
    if isinstance(data, Mapping):
        return str(data.get("shape", "arc"))
    return getattr(data, "shape", "arc")


# The key `shape` of a body tells whether it is read as an arc or as a beam.
ArcOrBeamShoeBody = Annotated[
    Annotated[ArcBody, Tag("arc")] | Annotated[BeamBody, Tag("beam")],
    Discriminator(
        _tag_for_beam_or_arc_shape_of_shoe_body,
        custom_error_type="shape",
        custom_error_message='shape: must be "arc" (the default) or "beam"',
    ),
]


class Actuation(PartOfInputFile):
    """The actuation of a shoe: a force [N], its direction [rad] and a point on its line of action.

    If the drive of the brake gives the forces (`DriveOfAllShoes`), the file gives no force for the
    shoe.
    """

    hint_if_several_are_given: ClassVar[str] = "; further forces on a shoe are [[shoe.force]]"

    force: Force = 0.0
    direction: Angle
    point: CartesianOrPolarPoint

    @property
    def unit_vector_of_force(self) -> Floats:
        """Unit vector (2,) in the direction of the force."""
        return np.array([math.cos(self.direction), math.sin(self.direction)])

    @property
    def force_vector(self) -> Floats:
        """The force on the shoe as a vector (2,) [N]."""
        return self.force * self.unit_vector_of_force

    def moment_of_force_about_point(self, point: Point) -> float:
        """Moment [N m] of the actuation's force about a point, counter-clockwise positive."""
        arm, force = self.point.xy - point.xy, self.force_vector
        return float(arm[0] * force[1] - arm[1] * force[0])
