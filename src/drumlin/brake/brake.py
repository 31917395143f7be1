"""A brake and its shoes, as all of drumlin sees them, whatever surface they run on.

Conventions: all numbers are SI (m, N, Pa, rad). On a drum the centre O is the origin and angles run
counter-clockwise from +x. On a plane the sliding surface is y = 0, the body lies below it, the
shoes above. `drumlin.brake.surface` says what differs.
"""

import math
from abc import abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self, cast

import numpy as np

from drumlin.arrays import Floats
from drumlin.brake.components import Backing, Bar, Beam, Lining, Lobes, Ring
from drumlin.brake.drive import Drive, Link, shares
from drumlin.brake.fields import Part, Point
from drumlin.brake.support import MOVES, Meshed
from drumlin.brake.surface import DRUM, PLANE, FrictionSurface
from drumlin.errors import BadInput


class ShoeFrame(NamedTuple):
    """A shoe's own frame: a coordinate phi that counts from the pin (`Held.pin`) towards the
    lining.

    q = origin + sense * unit * phi, with q the coordinate of the surface; see
    `drumlin.brake.surface`. In it a shoe and its mirror image are the same thing. On a drum phi is
    a polar angle at O.
    """

    origin: float
    sense: int
    unit: float = 1.0

    def phi(self, theta: Floats) -> Floats:
        """phi of places theta, same shape."""
        return self.sense * (np.asarray(theta) - self.origin) / self.unit

    def phis(self, theta: Iterable[float]) -> list[float]:
        """phi of a few places theta."""
        return [self.sense * (place - self.origin) / self.unit for place in theta]

    def theta(self, phi: Floats) -> Floats:
        """The places theta of phi, same shape."""
        return self.origin + self.sense * self.unit * np.asarray(phi)

    def distance(self, theta: Floats) -> Floats:
        """How far places theta are from that of the pin, towards the lining, in the surface's
        coordinate.
        """
        return self.sense * (np.asarray(theta) - self.origin)

    def to_brake(self, vectors: Floats) -> Floats:
        """Vectors (..., 2) of the shoe's frame in the brake's."""
        c, s = math.cos(self.origin), math.sin(self.origin)
        return np.asarray(vectors) @ np.array([[c, s], [-self.sense * s, self.sense * c]])

    def to_shoe(self, vectors: Floats) -> Floats:
        """Vectors (..., 2) of the brake's frame in the shoe's."""
        c, s = math.cos(self.origin), math.sin(self.origin)
        return np.asarray(vectors) @ np.array([[c, -self.sense * s], [s, self.sense * c]])


class Shoe(Meshed):
    """One shoe with its lining, held by a hinge or otherwise (`Held`); without `body` the shoe is
    rigid.
    """

    surface: ClassVar[FrictionSurface]

    # Both shapes of file have these fields, each in its own order.
    if TYPE_CHECKING:

        @property
        def side(self) -> str: ...
        @property
        def lining(self) -> Lining: ...
        @property
        def backing(self) -> Backing | None: ...
        @property
        def body(self) -> Bar | Beam | None: ...

    @property
    def sign(self) -> int:
        """Outward normal of the lining n = sign * e_r: +1 internal, -1 external. +1 on a plane."""
        return 1 if self.side == "internal" else -1

    @property
    def depth(self) -> float:
        """Thickness of lining, backing and body together [m]."""
        return (
            self.lining.thickness
            + (self.backing.thickness if self.backing else 0.0)
            + (self.body.depth if self.body else 0.0)
        )

    @property
    def flat(self) -> bool:
        """Whether it presses on a surface that is straight."""
        return self.surface.straight

    @property
    @abstractmethod
    def frame(self) -> ShoeFrame:
        """The shoe's own frame."""

    @cached_property
    def arc(self) -> tuple[float, float]:
        """The lining (phi_1, phi_2) in the shoe's frame."""
        first, last = self.frame.phis((self.lining.start, self.lining.end))
        return min(first, last), max(first, last)

    @property
    @abstractmethod
    def own_pin(self) -> Floats:
        """The pin (2,) [m] in its frame."""

    @abstractmethod
    def own_points(self, xy: Floats) -> Floats:
        """Points (..., 2) [m] of the brake's frame in its own."""

    @abstractmethod
    def points(self, xy: Floats) -> Floats:
        """Points (2, n) [m] of its frame in the brake's."""

    @abstractmethod
    def at(self, depth: Floats, phi: Floats, size: float) -> Floats:
        """Points (2, ...) [m] of its frame, at a depth [m] behind the surface and at phi.

        size [m]: that of the brake, as of all functions that take phi.
        """

    @abstractmethod
    def off(self, xy: Floats, size: float) -> Floats:
        """How far points (2, ...) [m] of its frame lie off the surface [m], positive = open."""

    @abstractmethod
    def phi_of(self, xy: Floats, size: float) -> Floats:
        """phi of points (2, ...) [m] of its frame: the nearest to the lining's middle where there
        are several.
        """

    @abstractmethod
    def place_of(self, point: Point) -> float:
        """The place q of a point: the nearest to the lining's middle where there are several."""

    @abstractmethod
    def back(self, size: float) -> float:
        """Length [m] of the back of its body per unit of phi."""

    @property
    @abstractmethod
    def closing(self) -> float:
        """Direction [rad] in which the middle of the lining moves straight to the surface."""

    @abstractmethod
    def misfit_gap(self, theta: Floats, size: float) -> Floats:
        """Gap [m] of a lining of its own radius, moved by its offset, at the places theta, same
        shape.
        """

    def end_face(self, size: float, *, loaded: bool = False) -> Floats:
        """The middle (2,) [m], in its frame, of the end face by which a hinge or an abutment holds
        an arc, or of that which the actuation pushes.
        """
        assert isinstance(self.body, Bar)
        phi = (max if loaded else min)(self.frame.phis((self.body.start, self.body.end)), key=abs)
        return self.at(np.array(self.depth - 0.5 * self.body.depth), np.array(phi), size)

    @property
    def gripped(self) -> bool:
        """Whether what holds the shoe grips the back of an elastic body, not an end face: the force
        acts on it then.
        """
        return self.held_by in {"pivot", "guide"} or (
            isinstance(self.body, Bar) and self.body.grip is not None
        )

    def grip(self, size: float) -> tuple[float, float] | None:
        """The part (phi_1, phi_2) of the body's back that is held (see `Bar`).

        None where what holds the shoe holds an end face of its body, or all of the back of a rigid
        one.
        """
        if not isinstance(self.body, Bar) or self.mesh is not None or not self.gripped:
            return None
        start, end = self.arc
        place = self.lining.middle if self.pivot is None else self.place_of(self.pivot)
        half = min(
            0.5 * (self.body.grip or self.body.thickness) / self.back(size), 0.3 * (end - start)
        )
        at = float(np.clip(self.frame.phi(np.array(place)), start + 1.5 * half, end - 1.5 * half))
        return at - half, at + half


class Brake(Part):
    """A brake: friction coefficient, direction of motion, surface and shoes."""

    surface: ClassVar[FrictionSurface]
    direction_key: ClassVar[str]
    """The key of the direction of motion, as `vary` takes it."""
    directions: ClassVar[tuple[str, str]]
    """The values of that key, of spin +1 and -1."""

    # Both shapes of file have these fields, each in its own order.
    if TYPE_CHECKING:

        @property
        def title(self) -> str: ...
        @property
        def friction(self) -> float: ...
        @property
        def shoes(self) -> tuple[Shoe, ...]: ...
        @property
        def actuation(self) -> Drive | None: ...
        @property
        def links(self) -> tuple[Link, ...]: ...

    @staticmethod
    def shape_of(data: object) -> "type[Brake]":
        """The class that reads data as a brake file has them: with "plane" that of a brake on a
        plane.
        """
        shapes = {shape.surface.word: shape for shape in Brake.__subclasses__()}
        return shapes[PLANE.word if isinstance(data, Mapping) and PLANE.word in data else DRUM.word]

    @classmethod
    def model_validate(cls, obj: Any, **options: Any) -> Self:
        """A brake from data as a brake file has them. Raises pydantic.ValidationError."""
        if cls is Brake:
            return cast("Self", Brake.shape_of(obj).model_validate(obj, **options))
        return super().model_validate(obj, **options)

    @property
    @abstractmethod
    def direction(self) -> str:
        """The direction of motion, one of `directions`."""

    @property
    @abstractmethod
    def size(self) -> float:
        """The length [m] by which others are measured: the drum's radius, or the length of the
        first lining.
        """

    @property
    def scale_factor(self) -> float:
        """Length of the surface per unit of its coordinate, and effect per friction force: R [m],
        or 1 on a plane.
        """
        return 1.0 if self.surface.straight else self.size

    @property
    def unit(self) -> float:
        """The surface's coordinate per unit of phi, see `ShoeFrame`."""
        return self.size / self.scale_factor

    @property
    def ring(self) -> Ring | None:
        """The elastic ring of a drum, where it has one."""
        return None

    @property
    def motion(self) -> str:
        """What moves, in words."""
        return f"{self.surface.moves} {self.direction}"

    @property
    def sense(self) -> str:
        """The direction of motion, as a table of results has it."""
        return self.surface.sense.format(self.direction)

    @abstractmethod
    def reversed(self) -> Self:
        """The brake with the other direction of motion."""

    @abstractmethod
    def bare(self) -> Self:
        """The brake without title, direction, size of the friction (but for 0), and what the
        surface is off its circle: without what its bodies do not depend on, but for the shoes.
        """

    def without_ring(self) -> Self:
        """The brake on a rigid surface."""
        return self

    def round(self) -> Self:
        """The brake on a surface that is nowhere off its circle."""
        return self

    @property
    def lobes(self) -> tuple[Lobes, ...]:
        """What the surface is off its circle."""
        return ()

    def surface_off(self, theta: Floats) -> Floats | None:
        """How far [m] the surface lies outside its circle at the places theta, same shape; None
        where nowhere.
        """
        return None

    @property
    def other_direction(self) -> str:
        """The direction of motion that it does not have."""
        first, second = self.directions
        return second if self.spin > 0 else first

    @property
    def spin(self) -> int:
        """Sense of the motion: +1 along growing places of the surface's coordinate, else -1."""
        return 1 if self.direction == self.directions[0] else -1

    @property
    def drag(self) -> float:
        """Friction on the lining per pressure along growing places at full slip: mu s."""
        return self.friction * self.spin

    def drag_on(self, shoe: Shoe) -> float:
        """The same along growing phi of the shoe's own frame."""
        return self.drag * shoe.frame.sense

    @property
    def shares(self) -> str | None:
        """That a cam or a strut shares a force among its shoes, in words; None where each shoe has
        its own.
        """
        return shares(self.actuation, self.links)

    def unmeshable(self) -> str | None:
        """Why its shoes cannot be meshed, as data are missing; None where they can."""
        for shoe in self.shoes:
            if shoe.lining.thickness is None or shoe.lining.material is None:
                return f"shoe {shoe.name!r}: its lining has no thickness and material to mesh"
        return None

    def check_meshable(self) -> None:
        """Raise BadInput where data that finite elements need are missing."""
        reason = self.unmeshable()
        if reason is not None:
            raise BadInput(f"fem does not apply to this brake: {reason}")

    def unhinged(self) -> str | None:
        """The first thing that is not plain hinges under forces of their own, in words of a
        refusal; None if all is.
        """
        moving = (
            f"shoe {shoe.name!r}: {MOVES[shoe.held_by]}"
            for shoe in self.shoes
            if shoe.held_by != "hinge"
        )
        return self.shares or next(moving, None)

    def check_hinged(self, what: str) -> None:
        """Raise BadInput for `what` is done with shoes on hinges only, under forces of their own."""
        reason = self.unhinged()
        if reason is not None:
            raise BadInput(f"{what} takes shoes on hinges under forces of their own only: {reason}")

    def names(self, group: Sequence[int]) -> str:
        """The shoes of a group as a refusal names them."""
        return ", ".join(f"shoe {self.shoes[i].name!r}" for i in group)
