"""What drums and shoes are made of: ring, drum, lining, backing, bodies, actuation. Every number is
SI.
"""

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
"""A friction coefficient; one below SMALLEST is none, as with every quantity."""


class Section(NamedTuple):
    """A rectangular section: thickness in the brake's plane and width across it [m], and its
    material.
    """

    thickness: float
    width: float
    material: AnyMaterial

    @property
    def bending_stiffness(self) -> float:
        """EI [N m^2]."""
        return self.material.E_along * self.width * self.thickness**3 / 12


class Bonded(NamedTuple):
    """Plates that bend as one: `depth` of the neutral axis from the first one's outer face [m], EI
    [N m^2], EA [N], GA [N].
    """

    depth: float
    EI: float
    EA: float
    GA: float


def bonded(plates: Sequence[Section]) -> Bonded:
    """The stiffnesses of plates that lie on each other in this order."""
    t = np.array([plate.thickness for plate in plates])
    EA = np.array([plate.material.E_along * plate.width * plate.thickness for plate in plates])
    GA = np.array(
        [plate.material.G_along_through * plate.width * plate.thickness for plate in plates]
    )
    own = np.array([plate.bending_stiffness for plate in plates])
    middle = np.cumsum(t) - t / 2
    depth = float(EA @ middle / EA.sum())
    return Bonded(
        depth, float((own + EA * (middle - depth) ** 2).sum()), float(EA.sum()), float(GA.sum())
    )


STEEL = Material(E=210e9, nu=0.3)
"""The material of what is known by its bending stiffness alone: then its width follows, and plane
stress feels only the product of both.
"""


def _section(part: "Ring | Beam | Bar", EI: float | None) -> Section | None:
    """The section of a ring, beam or arc; its width is such that it bends with `EI` where that is
    given.
    """
    if part.thickness is None:
        return None
    if EI is None:
        known = part.width is not None and part.material is not None
        return Section(part.thickness, part.width, part.material) if known else None  # type: ignore[arg-type]
    section = Section(part.thickness, part.width or 1.0, part.material or STEEL)
    return section._replace(width=section.width * EI / section.bending_stiffness)


def _check_section(part: "Ring | Beam") -> None:
    given = {key for key in ("thickness", "width", "material") if getattr(part, key) is not None}
    if len(given) < 3 and (part.bending_stiffness is None or given - {"thickness"}):
        raise ValueError(
            "needs thickness, width and material, or bending_stiffness, or that and thickness, or all four"
        )


class Ring(Part):
    """The elastic rim of the drum, behind its friction surface as seen from the shoe.

    Its section, or its `bending_stiffness` EI [N m^2] alone, or both: then the section bends with
    this EI. With thickness and bending stiffness it can be meshed.
    """

    thickness: Thickness | None = None
    width: Thickness | None = None
    material: AnyMaterial | None = None
    bending_stiffness: BendingStiffness | None = None
    support: Literal["fixed", "free"] = "fixed"

    @model_validator(mode="after")
    def _whole(self) -> Self:
        _check_section(self)
        return self

    @property
    def section(self) -> Section | None:
        """The section, of a width that gives the bending stiffness; None where the file has only
        that.
        """
        return _section(self, self.bending_stiffness)

    @property
    def EI(self) -> float:
        """Bending stiffness [N m^2]."""
        section = self.section
        return section.bending_stiffness if section else float(self.bending_stiffness or 0.0)


class Lobes(Part):
    """One harmonic of a drum's surface off its circle: outwards by amplitude cos(order (theta -
    phase)) [m].

    Order 0 is growth (a hot drum), 1 run-out, 2 ovality.
    """

    order: Annotated[int, Field(ge=0, le=100)]
    amplitude: Length
    phase: Angle = 0.0


class Drum(Part):
    """The drum: friction radius R [m]; without `ring` it is rigid.

    `out_of_round`: what its surface is off the circle, as it stands when turned to `angle` = 0
    [rad].
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
"""Of the drum's radius, or a pad's length; beyond it normals along the drum's radii are no longer a
model.
"""
STEP = math.radians(1.0)  # rad
"""Arc of the rounded step from one block's height to the next. A sharp edge, and the corner of a
straight chamfer, carry a pressure without bound, and no mesh would settle.
"""


class Misfit(Part):
    """How a lining's surface differs from the drum's circle, besides its clearance.

    `drumlin.brake.off_circle` computes the gap that results.

    `radius` [m] of the lining's own circle, by default the drum's: the circle meets the drum's in
    the lining's middle, and is moved from there by `offset` [m]. `taper` [m]: how much farther the
    lining stands back at its end away from the hinge than at its end near it. `blocks`: rows
    (angle, depth) [rad, m]: from each angle on the lining stands back by this depth, before the
    first by none.
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
        """Raise ValueError where it is larger than `most` [m], or its blocks are not on the lining.

        ends: places where the lining begins and ends; step: length of a rounded step between
        blocks, of the same kind; text: a place in words; allowed: `most` in words.
        """
        deepest = max((abs(depth) for _, depth in self.blocks), default=0.0)
        for name, size in (
            ("offset", self.offset.radius),
            ("taper", self.taper),
            ("blocks", deepest),
        ):
            if abs(size) > most:
                raise ValueError(f"{key}.{name} = {mm(size)}: must be at most {allowed}")
        edges = [ends[0], *(place for place, _ in self.blocks), ends[1]]
        if self.blocks and min(b - a for a, b in pairwise(edges)) <= step:
            places = ", ".join(text(place) for place, _ in self.blocks)
            raise ValueError(
                f"{key}.blocks at {places}: must begin on the lining, {text(ends[0])} to {text(ends[1])}, "
                f"more than {text(step)} from its ends and from each other"
            )


class Lining(Part):
    """The friction lining, as all of drumlin sees it, from place `start` to `end` on the surface.

    `step`: length of the rounded step from one block's height to the next, in the surface's
    coordinate.
    """

    # Both shapes of file have these fields, each in its own order.
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
        """The place of its middle."""
        return 0.5 * (self.start + self.end)

    @property
    @abstractmethod
    def step(self) -> float:
        """Length of the rounded step from one block's height to the next."""

    def clearance_at(self, theta: Floats) -> Floats:
        """Clearance [m] at the places `theta`, same shape, without the misfit."""
        return value_at(self.clearance, theta)


class DrumLining(Lining):
    """The friction lining, from angle `start` to `end` on the friction surface.

    `clearance` [m] is the gap of the unloaded lining, positive = open: one value, or a table of
    (angle, clearance) with straight lines between. What `misfit` makes of it comes on top.
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
        return STEP

    @model_validator(mode="after")
    def _arc(self) -> Self:
        if not 0 < self.end - self.start < 2 * math.pi:
            raise ValueError(
                f"end = {deg(self.end)} must be greater than start = {deg(self.start)}, by less than 360 deg"
            )
        return self


class Backing(Part):
    """A layer between lining and shoe body, over the lining's arc and width (the wooden block).

    Meshed behind a straight beam it is the block that fills the space up to the beam, whatever its
    thickness.
    """

    thickness: Thickness
    material: AnyMaterial


class Table(Part):
    """The plate of a T-section, between the lining and the web: `thickness` in the brake's plane,
    `width` across it.
    """

    thickness: Thickness
    width: Thickness


class Bar(Part):
    """A body of constant section behind lining and backing.

    `thickness`, `width`: of its rectangle; with a `table` of the T-section's web.
    `bending_stiffness` EI [N m^2]: in place of width and material, or besides them; then the width
    is such that the body bends with it. `grip` [m]: the length of its back that a pivot or a guide
    holds, by default its thickness; with a hinge, that which is bolted to the lever. Without it a
    hinge holds the end face, as an abutment does.
    """

    thickness: Thickness
    width: Thickness | None = None
    material: AnyMaterial | None = None
    table: Table | None = None
    bending_stiffness: BendingStiffness | None = None
    grip: Thickness | None = None

    # Both shapes of file have these fields, from place to place on the surface.
    if TYPE_CHECKING:

        @property
        def shape(self) -> str: ...
        @property
        def start(self) -> float: ...
        @property
        def end(self) -> float: ...

    @model_validator(mode="after")
    def _whole(self) -> Self:
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
                f"table.width = {mm(self.table.width)}: must be at least width = {mm(self.width)}, the web's"
            )
        return self

    @property
    def plates(self) -> dict[str, Section]:
        """The plates of its section by the names of their groups, from the friction surface
        inwards: "table" if it has one, and "shoe", its rectangle or web.
        """
        own = _section(self, self.bending_stiffness)
        assert own is not None  # checked at the door
        table = (
            {}
            if self.table is None
            else {"table": Section(self.table.thickness, self.table.width, own.material)}
        )
        return table | {"shoe": own}

    @property
    def depth(self) -> float:
        """Its whole thickness [m]."""
        return self.thickness + (self.table.thickness if self.table else 0.0)


class Body(Bar):
    """The elastic shoe behind lining and backing: an arc of constant section from `start` to `end`."""

    shape: Literal["arc"] = "arc"
    start: Angle
    end: Angle


class Beam(Part):
    """The elastic shoe as a straight beam: its axis runs from the hinge to the point of the
    actuation.

    Its section, or its `bending_stiffness` EI [N m^2], one value or a table over the distance from
    the hinge, or both: then the section bends with this EI. With thickness and one bending
    stiffness it can be meshed. `offset` [m]: where the neutral axis is weakly curved, a table over
    the distance from the hinge of how far it lies behind the straight line, away from the drum.
    """

    shape: Literal["beam"]
    thickness: Thickness | None = None
    width: Thickness | None = None
    material: AnyMaterial | None = None
    bending_stiffness: StiffnessAlong | None = None
    offset: OffsetAlong = 0.0

    @model_validator(mode="after")
    def _whole(self) -> Self:
        _check_section(self)
        EI = self.bending_stiffness
        if (
            EI is not None
            and min([value for _, value in EI] if isinstance(EI, tuple) else [EI]) <= 0
        ):
            raise ValueError("bending_stiffness: must be greater than 0")
        if float(value_at(self.offset, np.zeros(1))[0]) != 0:
            raise ValueError(
                'offset: must be a table that starts with 0 at the hinge, such as [["0 m", "0 mm"], ...]'
            )
        return self

    @property
    def section(self) -> Section | None:
        """The section, of a width that gives the bending stiffness; None where that varies or
        stands alone.
        """
        EI = self.bending_stiffness
        return None if isinstance(EI, tuple) else _section(self, EI)

    @property
    def plates(self) -> dict[str, Section]:
        """As of an arc: its section."""
        assert self.section is not None  # why_not
        return {"shoe": self.section}

    @property
    def depth(self) -> float:
        """Its thickness [m], 0 where that is not known."""
        return self.thickness or 0.0

    def bending_stiffness_at(self, x: Floats) -> Floats:
        """EI [N m^2] at the distances x [m] from the hinge, same shape."""
        if self.bending_stiffness is not None:
            return value_at(self.bending_stiffness, x)
        section = self.section
        assert section is not None  # checked at the door
        return np.full(np.shape(x), section.bending_stiffness)

    def offset_at(self, x: Floats) -> Floats:
        """Offset of the neutral axis [m] at the distances x [m] from the hinge, same shape."""
        return value_at(self.offset, x)


def _shape(data: object) -> str:
    return (
        str(data.get("shape", "arc"))
        if isinstance(data, Mapping)
        else getattr(data, "shape", "arc")
    )


AnyBody = Annotated[
    Annotated[Body, Tag("arc")] | Annotated[Beam, Tag("beam")],
    Discriminator(
        _shape,
        custom_error_type="shape",
        custom_error_message='shape: must be "arc" (the default) or "beam"',
    ),
]


class Actuation(Part):
    """The force on the shoe [N], its direction [rad] and a point of its line of action.

    A brake may give the force of all its shoes (`Drive`): then a shoe's own has none.
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
