"""The parts of drums and shoes: ring, drum, lining, backing, bodies, actuation. Units are SI."""

import math
from abc import abstractmethod
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple, Self

import numpy as np
from pydantic import (
    AfterValidator,
    Discriminator,
    Field,
    Tag,
    model_validator,
)

from drumlin.base.arrays import Floats
from drumlin.brake.fields import (
    Angle,
    AnyMaterial,
    BendingStiffness,
    Force,
    Length,
    Material,
    Part,
    Place,
    Point,
    Rows,
    Thickness,
    number_or_table,
    table,
    value_at,
)
from drumlin.brake.units import SMALLEST, deg, mm

Friction = Annotated[
    float,
    Field(ge=0, le=1e6, strict=True),
    AfterValidator(lambda mu: mu if mu >= SMALLEST else 0.0),
]
"""A friction coefficient. Below SMALLEST it counts as 0, as every quantity does."""


class Section(NamedTuple):
    """A rectangular section.

    Attributes
    ----------
    thickness : in the plane of the brake [m]
    width : across that plane [m]
    material : its material
    """

    thickness: float
    width: float
    material: AnyMaterial

    @property
    def bending_stiffness(self) -> float:
        """Bending stiffness EI [N m^2] of the section in the plane of the brake."""
        return self.material.E_along * self.width * self.thickness**3 / 12


class Bonded(NamedTuple):
    """Stiffnesses of plates that bend together.

    Attributes
    ----------
    depth : of the neutral axis from the outer face of the first plate [m]
    EI : bending stiffness [N m^2]
    EA : stiffness in tension [N]
    GA : stiffness in shear [N]
    """

    depth: float
    EI: float
    EA: float
    GA: float


def bonded(plates: Sequence[Section]) -> Bonded:
    """The stiffnesses of plates that lie on each other in this order."""
    t = np.array([plate.thickness for plate in plates])
    width = np.array([plate.width for plate in plates])
    E = np.array([plate.material.E_along for plate in plates])
    G = np.array([plate.material.G_along_through for plate in plates])
    # The neutral axis is the centre of the plates, each weighted by its stiffness in tension.
    EA, GA = E * width * t, G * width * t
    own = np.array([plate.bending_stiffness for plate in plates])
    # Distances of the plates' middles from the outer face of the first plate.
    middle = np.cumsum(t) - t / 2
    depth = float(EA @ middle / EA.sum())
    # Steiner's theorem: a plate off the neutral axis is stretched as well as bent.
    EI = own + EA * (middle - depth) ** 2
    return Bonded(depth, float(EI.sum()), float(EA.sum()), float(GA.sum()))


ASSUMED_STEEL = Material(E=210e9, nu=0.3)
"""Material of a part of which only the bending stiffness is known.

The width then follows from the bending stiffness. Plane stress depends on the product of both only.
"""


def _section(part: "Ring | Beam | Bar", EI: float | None) -> Section | None:
    """The section of a ring, beam or arc, or None if it is unknown.

    If `EI` [N m^2] is given, the width is such that the section bends with it.
    """
    if part.thickness is None:
        return None
    if EI is None:
        known = part.width is not None and part.material is not None
        return Section(part.thickness, part.width, part.material) if known else None  # type: ignore[arg-type]
    # Any width and material do, since the width is then scaled to the bending stiffness.
    section = Section(part.thickness, part.width or 1.0, part.material or ASSUMED_STEEL)
    return section._replace(width=section.width * EI / section.bending_stiffness)


def _check_section(part: "Ring | Beam") -> None:
    """Raise ValueError if a part has neither a whole section nor a bending stiffness."""
    given = {key for key in ("thickness", "width", "material") if getattr(part, key) is not None}
    if len(given) < 3 and (part.bending_stiffness is None or given - {"thickness"}):
        raise ValueError(
            "needs thickness, width and material, or bending_stiffness, "
            "or that and thickness, or all four"
        )


PLAIN_SUPPORTS = ("fixed", "free")
"""Supports of a ring's far edge that all models and the verification know, see `Ring.is_plain`."""


class Ring(Part):
    """The elastic rim of the drum, behind its friction surface as seen from the shoe.

    It has a section, or a `bending_stiffness` EI [N m^2], or both; then the section bends with this
    EI. With thickness and bending stiffness it can be meshed.
    """

    thickness: Thickness | None = None
    width: Thickness | None = None
    material: AnyMaterial | None = None
    bending_stiffness: BendingStiffness | None = None
    support: Literal["fixed", "free"] = "fixed"

    @model_validator(mode="after")
    def _check_whole_section(self) -> Self:
        """Raise ValueError where neither section nor bending stiffness is given."""
        _check_section(self)
        return self

    @property
    def is_plain(self) -> bool:
        """Whether the far edge is fixed or free, and nothing else acts on it.

        Models that know no other support refuse a ring that is not plain, see
        `ring_support.plain_ring_only`.
        """
        return self.support in PLAIN_SUPPORTS

    @property
    def section(self) -> Section | None:
        """The section, with a width that gives the bending stiffness.

        It is None if the file has only the bending stiffness.
        """
        return _section(self, self.bending_stiffness)

    @property
    def EI(self) -> float:
        """Bending stiffness [N m^2]."""
        section = self.section
        return section.bending_stiffness if section else float(self.bending_stiffness or 0.0)


class Lobes(Part):
    """One harmonic of a drum's surface off its circle.

    The surface lies outwards by amplitude cos(order (theta - phase)) [m]. Order 0 is growth (a hot
    drum), 1 run-out, 2 ovality.
    """

    order: Annotated[int, Field(ge=0, le=100)]
    amplitude: Length
    phase: Angle = 0.0


class Drum(Part):
    """The drum with its friction radius R [m]. A drum without `ring` is rigid.

    `out_of_round` holds the harmonics of its surface off the circle at `angle` = 0 [rad]; the
    harmonics turn with the drum.
    """

    radius: Thickness
    ring: Ring | None = None
    out_of_round: tuple[Lobes, ...] = ()
    angle: Angle = 0.0


StiffnessAlong = Annotated[
    float | Rows, number_or_table("distance", "m", "bending stiffness", "N m^2")
]
OffsetAlong = Annotated[float | Rows, number_or_table("distance", "m", "offset", "m")]
Clearance = Annotated[float | Rows, number_or_table("angle", "rad", "clearance", "m")]


LARGEST_MISFIT = 0.05
"""Largest misfit, relative to the drum's radius or to a pad's length; a larger misfit is refused.

Beyond it normals along the drum's radii are no longer a good model.
"""

ROUNDED_STEP = math.radians(1.0)
"""Arc [rad] of the rounded step from one block's height to the next.

A sharp edge, and the corner of a straight chamfer, carry an unbounded pressure, on which no mesh
would settle.
"""


class Misfit(Part):
    """Deviation of a lining's surface from the drum's circle, besides its clearance.

    `drumlin.brake.off_circle` computes the gap that results. `radius` [m] is that of the lining's
    own circle, by default the drum's. The circle meets the drum's in the lining's middle and is
    moved from there by `offset` [m]. `taper` [m] is how much farther the lining stands back at its
    end away from the hinge than at its end near the hinge. `blocks` are rows (angle, depth) [rad,
    m]: from each angle on the lining stands back by this depth, before the first angle by 0.
    """

    radius: Thickness | None = None
    offset: Place = Point(x=0.0, y=0.0)
    taper: Length = 0.0
    blocks: Annotated[Rows, table("angle", "rad", "depth", "m")] = ()

    def check(
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
        key : of the misfit in the message
        ends : places where the lining begins and ends
        step : length of a rounded step between blocks, in the unit of places
        text : function that writes a place
        most : largest misfit [m]
        allowed : text for the largest misfit
        """
        deepest = max((abs(depth) for _, depth in self.blocks), default=0.0)
        sizes = {"offset": self.offset.radius, "taper": self.taper, "blocks": deepest}
        for name, size in sizes.items():
            if abs(size) > most:
                raise ValueError(f"{key}.{name} = {mm(size)}: must be at most {allowed}")
        # Two rounded steps must not overlap, nor reach over an end of the lining.
        edges = [ends[0], *(place for place, _ in self.blocks), ends[1]]
        if self.blocks and min(b - a for a, b in pairwise(edges)) <= step:
            places = ", ".join(text(place) for place, _ in self.blocks)
            raise ValueError(
                f"{key}.blocks at {places}: must begin on the lining, "
                f"{text(ends[0])} to {text(ends[1])}, more than {text(step)} from its ends and "
                f"from each other"
            )


class Lining(Part):
    """The friction lining from place `start` to `end` on the surface.

    All of drumlin sees this class; each shape of brake file has its own subclass.
    """

    # Linings of a drum and of a plane have these fields, each in the order of its own file.
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
        def material(self) -> AnyMaterial: ...
        @property
        def clearance(self) -> float | Rows: ...
        @property
        def misfit(self) -> Misfit: ...

    @property
    def middle(self) -> float:
        """Place of the lining's middle."""
        return 0.5 * (self.start + self.end)

    @property
    @abstractmethod
    def step(self) -> float:
        """Length of the rounded step between blocks, in the surface's coordinate."""

    def clearance_at(self, theta: Floats) -> Floats:
        """Clearance [m] at the places `theta`, same shape, without the misfit."""
        return value_at(self.clearance, theta)


class DrumLining(Lining):
    """The friction lining from angle `start` to `end` on the friction surface.

    `clearance` [m] is the gap of the unloaded lining, positive = open: a number, or a table of
    (angle, clearance) with straight lines between. The gap of the `misfit` is added.
    """

    start: Angle
    end: Angle
    thickness: Thickness
    width: Thickness
    material: AnyMaterial
    clearance: Clearance = 0.0
    misfit: Misfit = Misfit()

    @property
    def step(self) -> float:
        """Arc [rad] of the rounded step from one block's height to the next."""
        return ROUNDED_STEP

    @model_validator(mode="after")
    def _check_ends(self) -> Self:
        """Raise ValueError unless the lining's end follows its start within one turn."""
        if not 0 < self.end - self.start < 2 * math.pi:
            raise ValueError(
                f"end = {deg(self.end)} must be greater than start = {deg(self.start)}, "
                "by less than 360 deg"
            )
        return self


class Backing(Part):
    """A layer between lining and shoe body, over the lining's arc and width (the wooden block).

    In a mesh with a straight beam the backing is a block that fills the space up to the beam,
    whatever its thickness.
    """

    thickness: Thickness
    material: AnyMaterial


class Table(Part):
    """The plate of a T-section, between the lining and the web.

    `thickness` [m] lies in the brake's plane, `width` [m] across it.
    """

    thickness: Thickness
    width: Thickness


class Bar(Part):
    """A body of constant section behind lining and backing.

    `thickness` and `width` [m] are those of its rectangle; with a `table` they are those of the
    T-section's web. `bending_stiffness` EI [N m^2] may stand in place of width and material, or
    besides them; then the width is such that the body bends with EI. `grip` [m] is the length of
    its back that a pivot or a guide holds, by default the thickness. With a hinge it is the length
    that is bolted to the lever. Without grip a hinge holds the end face, as an abutment does.
    """

    thickness: Thickness
    width: Thickness | None = None
    material: AnyMaterial | None = None
    table: Table | None = None
    bending_stiffness: BendingStiffness | None = None
    grip: Thickness | None = None

    # Bars on a drum and on a plane have these fields, as angles and as lengths.
    if TYPE_CHECKING:

        @property
        def shape(self) -> str: ...
        @property
        def start(self) -> float: ...
        @property
        def end(self) -> float: ...

    @model_validator(mode="after")
    def _check_section_and_table(self) -> Self:
        """Raise ValueError unless the section is known and its table is as wide as its web."""
        if (self.width is None or self.material is None) and (
            self.bending_stiffness is None or self.width
        ):
            raise ValueError("needs width and material, or bending_stiffness, or all three")
        if self.table is not None and self.bending_stiffness is not None:
            raise ValueError(
                "table: bending_stiffness is that of the whole body; leave one of them out"
            )
        if self.table is not None and self.width is not None and self.table.width < self.width:
            raise ValueError(
                f"table.width = {mm(self.table.width)}: must be at least "
                f"width = {mm(self.width)}, the web's"
            )
        return self

    @property
    def plates(self) -> dict[str, Section]:
        """Plates of the section by the names of their groups, from the friction surface inwards.

        They are "table", if the body has a table, and "shoe", its rectangle or web.
        """
        own = _section(self, self.bending_stiffness)
        # The validator of the body has checked that the section is known.
        assert own is not None
        if self.table is None:
            return {"shoe": own}
        table = Section(self.table.thickness, self.table.width, own.material)
        return {"table": table, "shoe": own}

    @property
    def depth(self) -> float:
        """Whole thickness of the body [m]."""
        return self.thickness + (self.table.thickness if self.table else 0.0)


class ArcBody(Bar):
    """The elastic shoe behind the lining: an arc of constant section from `start` to `end`."""

    shape: Literal["arc"] = "arc"
    start: Angle
    end: Angle


class Beam(Part):
    """The elastic shoe as a straight beam from the hinge to the point of the actuation.

    It has a section, or a `bending_stiffness` EI [N m^2], or both; then the section bends with this
    EI. EI is a number, or a table over the distance from the hinge. With thickness and a constant
    bending stiffness the beam can be meshed. A weakly curved neutral axis has an `offset` [m], a
    table over the distance from the hinge: how far the axis lies behind the straight line, away
    from the drum.
    """

    shape: Literal["beam"]
    thickness: Thickness | None = None
    width: Thickness | None = None
    material: AnyMaterial | None = None
    bending_stiffness: StiffnessAlong | None = None
    offset: OffsetAlong = 0.0

    @model_validator(mode="after")
    def _check_section_and_tables(self) -> Self:
        """Raise ValueError where the section or a table along the beam does not fit."""
        _check_section(self)
        EI = self.bending_stiffness
        if EI is not None:
            values = [value for _, value in EI] if isinstance(EI, tuple) else [EI]
            if min(values) <= 0:
                raise ValueError("bending_stiffness: must be greater than 0")
        if float(value_at(self.offset, np.zeros(1))[0]) != 0:
            raise ValueError(
                "offset: must be a table that starts with 0 at the hinge, "
                'such as [["0 m", "0 mm"], ...]'
            )
        return self

    @property
    def section(self) -> Section | None:
        """The section, with a width that gives the bending stiffness.

        It is None if the bending stiffness varies, or if the file has only the bending stiffness.
        """
        EI = self.bending_stiffness
        return None if isinstance(EI, tuple) else _section(self, EI)

    @property
    def plates(self) -> dict[str, Section]:
        """The plates of its section by the names of their groups: only "shoe"."""
        assert self.section is not None  # models refuse a beam without section
        return {"shoe": self.section}

    @property
    def depth(self) -> float:
        """Thickness of the beam [m]; 0 if it is unknown."""
        return self.thickness or 0.0

    def bending_stiffness_at(self, x: Floats) -> Floats:
        """EI [N m^2] at the distances x [m] from the hinge, same shape."""
        if self.bending_stiffness is not None:
            return value_at(self.bending_stiffness, x)
        section = self.section
        # The validator of the beam has checked that the section is known.
        assert section is not None
        return np.full(np.shape(x), section.bending_stiffness)

    def offset_at(self, x: Floats) -> Floats:
        """Offset of the neutral axis [m] at the distances x [m] from the hinge, same shape."""
        return value_at(self.offset, x)


def _shape(data: object) -> str:
    """The shape of a body, "arc" by default."""
    if isinstance(data, Mapping):
        return str(data.get("shape", "arc"))
    return getattr(data, "shape", "arc")


AnyBody = Annotated[
    Annotated[ArcBody, Tag("arc")] | Annotated[Beam, Tag("beam")],
    Discriminator(
        _shape,
        custom_error_type="shape",
        custom_error_message='shape: must be "arc" (the default) or "beam"',
    ),
]


class Actuation(Part):
    """The force on the shoe [N], its direction [rad] and a point of its line of action.

    If the brake gives the force of all its shoes (`Drive`), a shoe has no force of its own.
    """

    force: Force = 0.0
    direction: Angle
    point: Place

    @property
    def direction_vector(self) -> Floats:
        """The direction of the force (2,), of length 1."""
        return np.array([math.cos(self.direction), math.sin(self.direction)])

    @property
    def vector(self) -> Floats:
        """The force on the shoe (2,) [N]."""
        return self.force * self.direction_vector

    def moment_about(self, point: Point) -> float:
        """Moment of the force about `point` [N m], counter-clockwise positive."""
        arm, force = self.point.xy - point.xy, self.vector
        return float(arm[0] * force[1] - arm[1] * force[0])
