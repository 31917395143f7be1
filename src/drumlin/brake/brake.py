"""A brake and its shoes, on whatever surface they run.

Conventions: all numbers are SI (m, N, Pa, rad). On a drum the centre O is the origin, and angles
run counter-clockwise from +x. On a plane the sliding surface is y = 0, the body lies below it and
the shoes above. `drumlin.brake.surface` describes the differences.
"""

import math
from abc import abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self, cast

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.brake.components import Backing, Bar, Beam, Lining, Lobes, Ring
from drumlin.brake.drive import Drive, Link, shares
from drumlin.brake.fields import Part, Point
from drumlin.brake.support import MOVES, Meshed
from drumlin.brake.surface import DRUM, PLANE, FrictionSurface


class ShoeFrame(NamedTuple):
    """A shoe's own frame, with the coordinate phi that counts from the pin towards the lining.

    The coordinate of the surface is q = origin + sense * unit * phi, see `drumlin.brake.surface`.
    In their frames a shoe and its mirror image are the same. On a drum phi is a polar angle at O.

    Attributes
    ----------
    origin : place q of the pin (`Held.pin`)
    sense : +1 if phi grows with q, -1 if it falls
    unit : q per unit of phi
    """

    origin: float
    sense: int
    unit: float = 1.0

    def phi(self, theta: Floats) -> Floats:
        """Convert places theta to phi, same shape."""
        return self.sense * (np.asarray(theta) - self.origin) / self.unit

    def phis(self, theta: Iterable[float]) -> list[float]:
        """Coordinates phi of a few places theta, as plain numbers."""
        return [self.sense * (place - self.origin) / self.unit for place in theta]

    def theta(self, phi: Floats) -> Floats:
        """Convert phi to places theta, same shape."""
        return self.origin + self.sense * self.unit * np.asarray(phi)

    def distance(self, theta: Floats) -> Floats:
        """Distance of places theta from the pin, in the surface's coordinate, same shape.

        It is positive towards the lining.
        """
        return self.sense * (np.asarray(theta) - self.origin)

    def to_brake(self, vectors: Floats) -> Floats:
        """Convert vectors (..., 2) of the shoe's frame to the brake's."""
        c, s = math.cos(self.origin), math.sin(self.origin)
        # A rotation by the origin; with sense -1 the shoe's y axis is mirrored first.
        return np.asarray(vectors) @ np.array([[c, s], [-self.sense * s, self.sense * c]])

    def to_shoe(self, vectors: Floats) -> Floats:
        """Convert vectors (..., 2) of the brake's frame to the shoe's."""
        c, s = math.cos(self.origin), math.sin(self.origin)
        # The matrix is orthogonal: this one is the transpose of the matrix in `to_brake`.
        return np.asarray(vectors) @ np.array([[c, -self.sense * s], [s, self.sense * c]])


class Shoe(Meshed):
    """One shoe with its lining and its support (`Held`). A shoe without `body` is rigid."""

    surface: ClassVar[FrictionSurface]

    # Shoes on a drum and on a plane have these fields, each in the order of its own file.
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
        """Sign of the lining's outward normal along e_r: +1 internal or on a plane, -1 external."""
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
        """Whether the shoe presses on a plane."""
        return self.surface.straight

    @property
    @abstractmethod
    def frame(self) -> ShoeFrame:
        """The shoe's own frame."""

    @cached_property
    def arc(self) -> tuple[float, float]:
        """Begin and end (phi_1, phi_2) of the lining in the shoe's frame."""
        first, last = self.frame.phis((self.lining.start, self.lining.end))
        # A frame whose phi falls with theta swaps the two ends.
        return min(first, last), max(first, last)

    @property
    @abstractmethod
    def own_pin(self) -> Floats:
        """Position (2,) [m] of the pin in the shoe's frame."""

    @abstractmethod
    def own_points(self, xy: Floats) -> Floats:
        """Convert points (..., 2) [m] of the brake's frame to the shoe's."""

    @abstractmethod
    def points(self, xy: Floats) -> Floats:
        """Convert points (2, n) [m] of the shoe's frame to the brake's."""

    @abstractmethod
    def at(self, depth: Floats, phi: Floats, size: float) -> Floats:
        """Points (2, ...) [m] of the shoe's frame at a depth behind the surface and at phi.

        Parameters
        ----------
        depth : behind the surface [m], any shape
        phi : coordinate along the surface, any shape
        size : of the brake [m], which ties phi to lengths
        """

    @abstractmethod
    def off(self, xy: Floats, size: float) -> Floats:
        """Distance [m] of points (2, ...) [m] of the shoe's frame off the surface, > 0 if open."""

    @abstractmethod
    def phi_of(self, xy: Floats, size: float) -> Floats:
        """Coordinate phi of points (2, ...) [m] of the shoe's frame, near the lining's middle."""

    @abstractmethod
    def place_of(self, point: Point) -> float:
        """Place q of a point; of several places it is the nearest to the lining's middle."""

    @abstractmethod
    def back(self, size: float) -> float:
        """Length [m] of the back of the shoe's body per unit of phi."""

    @property
    @abstractmethod
    def closing(self) -> float:
        """Direction [rad] from the middle of the lining straight to the surface."""

    @abstractmethod
    def misfit_gap(self, theta: Floats, size: float) -> Floats:
        """Gap [m] of the lining's own radius and offset at the places theta, same shape."""

    def end_face(self, size: float, *, loaded: bool = False) -> Floats:
        """Middle (2,) [m], in the shoe's frame, of the end face of an arc that is held.

        With `loaded` it is the middle of the end face that the actuation pushes.
        """
        assert isinstance(self.body, Bar)
        ends = self.frame.phis((self.body.start, self.body.end))
        # phi counts from the pin, so that the held end is the nearer one.
        phi = max(ends, key=abs) if loaded else min(ends, key=abs)
        return self.at(np.array(self.depth - 0.5 * self.body.depth), np.array(phi), size)

    @property
    def gripped(self) -> bool:
        """Whether the support holds the back of an elastic body rather than an end face."""
        has_grip = isinstance(self.body, Bar) and self.body.grip is not None
        return self.held_by in {"pivot", "guide"} or has_grip

    def grip(self, size: float) -> tuple[float, float] | None:
        """The part (phi_1, phi_2) of the body's back that the support holds (see `Bar`).

        It is None if the support holds an end face of the body, or a rigid body.
        """
        if not isinstance(self.body, Bar) or self.mesh is not None or not self.gripped:
            return None
        start, end = self.arc
        place = self.lining.middle if self.pivot is None else self.place_of(self.pivot)
        # The part is at most 60 % of the lining and stays away from its ends.
        wanted = 0.5 * (self.body.grip or self.body.thickness) / self.back(size)
        half = min(wanted, 0.3 * (end - start))
        # The part lies opposite the pivot, or in the lining's middle where there is no pivot.
        phi = self.frame.phi(np.array(place))
        at = float(np.clip(phi, start + 1.5 * half, end - 1.5 * half))
        return at - half, at + half


class Brake(Part):
    """A brake: friction coefficient, direction of motion, surface and shoes."""

    surface: ClassVar[FrictionSurface]
    direction_key: ClassVar[str]
    """Key of the direction of motion, as `vary` takes it."""
    directions: ClassVar[tuple[str, str]]
    """Values of the direction of motion, for spin +1 and -1."""

    # Brakes with a drum and with a plane have these fields, each in the order of its own file.
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
        """The class that reads the data of a brake file: on a plane for data with "plane"."""
        # A drum is the default, so that an error in a file without both keys names the drum.
        shapes = {shape.surface.word: shape for shape in Brake.__subclasses__()}
        return shapes[PLANE.word if isinstance(data, Mapping) and PLANE.word in data else DRUM.word]

    @classmethod
    def model_validate(cls, obj: Any, **options: Any) -> Self:
        """Make a brake from the data of a brake file. Raises pydantic.ValidationError."""
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
        """Length [m] that others are relative to: drum radius or length of the first lining."""

    @property
    def scale_factor(self) -> float:
        """Length of the surface per unit of its coordinate: R [m] on a drum, 1 on a plane.

        It is also the effect of the brake per friction force.
        """
        return 1.0 if self.surface.straight else self.size

    @property
    def unit(self) -> float:
        """Coordinate of the surface per unit of phi, see `ShoeFrame`."""
        return self.size / self.scale_factor

    @property
    def ring(self) -> Ring | None:
        """The elastic ring of a drum, or None."""
        return None

    @property
    def motion(self) -> str:
        """Text that says what moves and in which direction."""
        return f"{self.surface.moves} {self.direction}"

    @property
    def sense(self) -> str:
        """Direction of motion as text of a table of results."""
        return self.surface.sense.format(self.direction)

    @abstractmethod
    def reversed(self) -> Self:
        """The brake with the other direction of motion."""

    @abstractmethod
    def bare(self) -> Self:
        """The brake without data on which its condensed bodies do not depend.

        These are title, direction, the size of a friction above 0, and the surface's deviation from
        its circle. The shoes stay.
        """

    def without_ring(self) -> Self:
        """The brake on a rigid surface."""
        return self

    def round(self) -> Self:
        """The brake on a surface without deviation from its circle."""
        return self

    @property
    def lobes(self) -> tuple[Lobes, ...]:
        """Harmonics of the surface's deviation from its circle."""
        return ()

    def surface_off(self, theta: Floats) -> Floats | None:
        """Distance [m] of the surface outside its circle at the places theta, same shape.

        It is None for a surface without deviation.
        """
        return None

    @property
    def other_direction(self) -> str:
        """The direction opposite to that of the motion."""
        first, second = self.directions
        return second if self.spin > 0 else first

    @property
    def spin(self) -> int:
        """Sense of the motion: +1 along the surface's growing coordinate, -1 against it."""
        return 1 if self.direction == self.directions[0] else -1

    @property
    def drag(self) -> float:
        """Friction on the lining per pressure, along growing places, at full slip: mu s."""
        return self.friction * self.spin

    def drag_on(self, shoe: Shoe) -> float:
        """Friction on a lining per pressure at full slip, along growing phi of the shoe's frame."""
        return self.drag * shoe.frame.sense

    @property
    def shares(self) -> str | None:
        """Text that a cam or a strut shares a force among the shoes; None if each has its own."""
        return shares(self.actuation, self.links)

    def unmeshable(self) -> str | None:
        """Reason why the shoes cannot be meshed: missing data. None if they can."""
        for shoe in self.shoes:
            if shoe.lining.thickness is None or shoe.lining.material is None:
                return f"shoe {shoe.name!r}: its lining has no thickness and material to mesh"
        return None

    def check_meshable(self) -> None:
        """Raise BadInput if data that finite elements need are missing."""
        reason = self.unmeshable()
        if reason is not None:
            raise BadInput(f"fem does not apply to this brake: {reason}")

    def unhinged(self) -> str | None:
        """Text of the first shoe that is not on a plain hinge under a force of its own, or None."""
        if self.shares:
            return self.shares
        for shoe in self.shoes:
            if shoe.held_by != "hinge":
                return f"shoe {shoe.name!r}: {MOVES[shoe.held_by]}"
        return None

    def check_hinged(self, what: str) -> None:
        """Raise BadInput unless all shoes have hinges and forces of their own, as `what` needs."""
        reason = self.unhinged()
        if reason is not None:
            raise BadInput(f"{what} takes shoes on hinges under forces of their own only: {reason}")

    def names(self, group: Sequence[int]) -> str:
        """Names of a group of shoes, for a refusal."""
        return ", ".join(f"shoe {self.shoes[i].name!r}" for i in group)
