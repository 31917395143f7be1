"""The classes of a brake and of its shoes, for a drum and for a plane alike.

Conventions: all numbers are SI (m, N, Pa, rad). On a drum the centre O is the origin, and angles
run counter-clockwise from +x. On a plane the sliding surface is y = 0, the body lies below it and
the shoes above. In both cases one coordinate q gives the position along the surface: the angle
theta on a drum, x on a plane. `drumlin.brake.surface` describes q and the differences between drum
and plane.
"""

import math
from abc import abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self, cast

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.brake.components import (
    Backing,
    BeamBody,
    DrumRing,
    Lining,
    OutOfRoundHarmonic,
    ShoeBodyOfConstantSection,
)
from drumlin.brake.drive import (
    DriveOfAllShoes,
    StrutOrStrapBetweenShoes,
    reason_why_forces_follow_from_cam_or_strut,
)
from drumlin.brake.fields import PartOfInputFile, Point
from drumlin.brake.friction import (
    FrictionOverPressureCurve,
    FrictionTable,
    friction_coefficient_as_text,
    friction_coefficient_curve_of_lining,
    multiplied_friction,
)
from drumlin.brake.further_loads import Gravity, Lever, Spring
from drumlin.brake.show import html_table_of_brake, text_of_brake
from drumlin.brake.support import MOTION_TEXTS_BY_KIND_OF_SUPPORT, ShoeWithOptionalMeshFile
from drumlin.brake.surface import (
    FRICTION_SURFACE_OF_DRUM,
    FRICTION_SURFACE_OF_PLANE,
    FrictionSurface,
)


class ShoeFrame(NamedTuple):
    """The frame of a shoe, in which the coordinate phi counts from the pin towards the lining.

    In their own frames a shoe and its mirror image have the same coordinates. On a drum phi is a
    polar angle about O. The coordinate of a point along the surface of drum or plane is
    q = origin + sense * surface_coordinate_per_phi * phi, see `drumlin.brake.surface`.

    Attributes
    ----------
    origin : coordinate q of the pin (`SupportedShoe.pin`)
    sense : +1 if phi grows with q, -1 if phi falls
    surface_coordinate_per_phi : change of q per unit of phi
    """

    origin: float
    sense: int
    surface_coordinate_per_phi: float = 1.0

    def phi_of_surface_coordinates(self, theta: Floats) -> Floats:
        """Convert coordinates of the surface (theta on a drum) to phi, same shape."""
        return self.sense * (np.asarray(theta) - self.origin) / self.surface_coordinate_per_phi

    def phi_coordinates_as_list(self, theta: Iterable[float]) -> list[float]:
        """Convert coordinates of the surface to phi; the result is a list of numbers."""
        return [
            self.sense * (place - self.origin) / self.surface_coordinate_per_phi for place in theta
        ]

    def surface_coordinates_of_phi(self, phi: Floats) -> Floats:
        """Convert phi to coordinates of the surface (theta on a drum), same shape."""
        return self.origin + self.sense * self.surface_coordinate_per_phi * np.asarray(phi)

    def distances_along_surface_from_pin(self, theta: Floats) -> Floats:
        """Signed distances along the surface from the pin's coordinate to the coordinates `theta`.

        The result has the shape of `theta`. The distances are angles [rad] on a drum and lengths
        [m] on a plane, positive towards the lining.
        """
        return self.sense * (np.asarray(theta) - self.origin)

    def convert_vectors_from_shoe_to_brake_frame(self, vectors: Floats) -> Floats:
        """Convert vectors (..., 2) from the frame of the shoe to the frame of the brake."""
        c, s = math.cos(self.origin), math.sin(self.origin)
        # The matrix rotates by the angle `origin`. With sense -1 it first mirrors the shoe's y.
        return np.asarray(vectors) @ np.array([[c, s], [-self.sense * s, self.sense * c]])

    def convert_vectors_to_shoe_frame(self, vectors: Floats) -> Floats:
        """Convert vectors (..., 2) from the frame of the brake to the frame of the shoe."""
        c, s = math.cos(self.origin), math.sin(self.origin)
        # The transpose of the orthogonal matrix of `convert_vectors_from_shoe_to_brake_frame` is
        # its inverse.
        return np.asarray(vectors) @ np.array([[c, -self.sense * s], [s, self.sense * c]])


class Shoe(ShoeWithOptionalMeshFile):
    """A shoe with its lining, support and actuation. A shoe without `body` is rigid."""

    surface: ClassVar[FrictionSurface]

    # `DrumShoe` and `FlatShoe` define these as fields, each in the order of its brake file.
    if TYPE_CHECKING:

        @property
        def side(self) -> str: ...
        @property
        def lining(self) -> Lining: ...
        @property
        def backing(self) -> Backing | None: ...
        @property
        def body(self) -> ShoeBodyOfConstantSection | BeamBody | None: ...

    @property
    def sign_internal_plus_external_minus(self) -> int:
        """+1 for an internal shoe and a shoe on a plane, -1 for an external shoe.

        On a drum the result is the sign of the radial component of the normal from the lining to
        the drum.
        """
        return 1 if self.side == "internal" else -1

    @property
    def total_thickness(self) -> float:
        """Total thickness [m] of lining, backing and body of the shoe."""
        return (
            self.lining.thickness
            + (self.backing.thickness if self.backing else 0.0)
            + (self.body.total_thickness if self.body else 0.0)
        )

    def reason_if_several_linings_are_not_allowed(self, what: str) -> str | None:
        """Why the computation `what` does not take this shoe; None if the shoe has one lining.

        Linings that touch, without a slot between them, count as one lining.
        """
        count = len(self.lining.slots) + 1
        return None if count == 1 else f"lining: {count} with slots between them; {what} takes one"

    @property
    def is_on_plane(self) -> bool:
        """Whether the shoe presses on a plane."""
        return self.surface.is_plane_and_not_drum

    @property
    @abstractmethod
    def frame(self) -> ShoeFrame:
        """The frame of the shoe, in which the coordinate phi counts from the pin."""

    @cached_property
    def arc(self) -> tuple[float, float]:
        """Coordinates (phi_1, phi_2) of the lining's ends in the shoe's frame, phi_1 < phi_2."""
        first, last = self.frame.phi_coordinates_as_list((self.lining.start, self.lining.end))
        # If phi falls with theta, the lining's end in theta has the smaller phi.
        return min(first, last), max(first, last)

    @cached_property
    def arcs(self) -> tuple[tuple[float, float], ...]:
        """Coordinates (phi_1, phi_2) of each lining's ends in the shoe's frame, by growing phi.

        Linings that touch count as one lining, see `Lining.arcs`.
        """
        found = []
        for ends in self.lining.arcs:
            first, last = sorted(self.frame.phi_coordinates_as_list(ends))
            found.append((first, last))
        return tuple(sorted(found))

    @property
    def slots(self) -> tuple[tuple[float, float], ...]:
        """Coordinates (phi_1, phi_2) of the ends of each slot between linings, by growing phi."""
        return tuple((one[1], other[0]) for one, other in pairwise(self.arcs))

    @property
    @abstractmethod
    def pin_position_in_shoe_frame(self) -> Floats:
        """Position (2,) [m] of the pin (`SupportedShoe.pin`) in the frame of the shoe."""

    @abstractmethod
    def convert_points_to_shoe_frame(self, xy: Floats) -> Floats:
        """Convert points (..., 2) [m] from the frame of the brake to the frame of the shoe."""

    @abstractmethod
    def convert_points_to_brake_frame(self, xy: Floats) -> Floats:
        """Convert points (2, n) [m] from the frame of the shoe to the frame of the brake."""

    @abstractmethod
    def points_at_depth_and_coordinate_phi(self, depth: Floats, phi: Floats, size: float) -> Floats:
        """Points (2, ...) [m] at a depth behind the friction surface and a coordinate phi.

        The points are in the frame of the shoe.

        Parameters
        ----------
        depth : distance behind the friction surface, into the shoe [m], any shape
        phi : coordinate along the surface in the shoe's frame, any shape
        size : size of the brake [m], which relates phi to lengths (`Brake.size`)
        """

    @abstractmethod
    def distances_from_friction_surface(self, xy: Floats, size: float) -> Floats:
        """Distance [m] of points from the friction surface, positive on the side of the shoe.

        The points (2, ...) [m] are in the frame of the shoe; `size` is the brake's size [m].
        """

    @abstractmethod
    def surface_coordinates_of_points_in_shoe_frame(self, xy: Floats, size: float) -> Floats:
        """Coordinate phi (...) of points (2, ...) [m] that are in the frame of the shoe.

        On a drum phi is the angle within half a turn of the lining's middle. `size` is the size of
        the brake [m].
        """

    @abstractmethod
    def drum_angle_or_plane_x_of_point(self, point: Point) -> float:
        """Coordinate q of a point along the surface (theta on a drum, x on a plane).

        On a drum whole turns are added to bring the angle nearest to the lining's middle.
        """

    @abstractmethod
    def length_along_shoe_back_per_unit_of_phi(self, size: float) -> float:
        """Length [m] along the back of the shoe's body per unit of phi.

        On a drum the result is the radius of this back. `size` is the size of the brake [m].
        """

    @property
    @abstractmethod
    def angle_of_direction_in_which_lining_closes_gap(self) -> float:
        """Angle [rad] of the normal from the middle of the lining towards the surface.

        A motion of the shoe in this direction closes the gap there.
        """

    @abstractmethod
    def gaps_due_to_ground_lining_radius_and_offset(self, theta: Floats, size: float) -> Floats:
        """Gap [m] of a lining that is ground to a circle, at coordinates theta, same shape.

        This gap follows from the keys `misfit.radius` and `misfit.offset`; the rest of the misfit
        is not included.
        """

    def middle_of_supported_or_loaded_end_face_of_body(
        self, size: float, *, loaded: bool = False
    ) -> Floats:
        """Middle (2,) [m] of the end face of an arc body at its support, in the shoe's frame.

        With `loaded` the result is the middle of the other end face, which the actuation pushes.
        `size` is the size of the brake [m].
        """
        assert isinstance(self.body, ShoeBodyOfConstantSection)
        ends = self.frame.phi_coordinates_as_list((self.body.start, self.body.end))
        # phi counts from the pin, so that the supported end is the nearer one.
        phi = max(ends, key=abs) if loaded else min(ends, key=abs)
        return self.points_at_depth_and_coordinate_phi(
            np.array(self.total_thickness - 0.5 * self.body.total_thickness), np.array(phi), size
        )

    def is_point_nearer_to_loaded_end_than_to_pin(self, point: Point, size: float) -> bool:
        """Whether a point is nearer to the loaded end of the shoe's body than to its pin.

        A one-sided support nearer to the loaded end pushes on this end, as the actuation does. A
        support nearer to the pin pushes on the other end of the body, which is held rigidly. `size`
        is the size of the brake [m].
        """
        # The actuation loads a body of constant section (`ShoeBodyOfConstantSection`) on its end
        # face. On any other shoe the loaded end is the point of the actuation.
        loaded = self.convert_points_to_shoe_frame(self.actuation.point.xy)
        if isinstance(self.body, ShoeBodyOfConstantSection) and self.mesh is None:
            loaded = self.middle_of_supported_or_loaded_end_face_of_body(size, loaded=True)
        at = self.convert_points_to_shoe_frame(point.xy)
        return math.dist(at, loaded) < math.dist(at, self.pin_position_in_shoe_frame)

    @property
    def has_support_on_back_of_body(self) -> bool:
        """Whether the support acts on the back of an elastic body and not on an end face.

        A pivot and a guide act on the back. A hinge acts on the back if the body has a `grip`.
        """
        has_grip = isinstance(self.body, ShoeBodyOfConstantSection) and self.body.grip is not None
        return self.kind_of_support in {"pivot", "guide"} or has_grip

    def interval_of_body_back_held_by_support(self, size: float) -> tuple[float, float] | None:
        """Interval (phi_1, phi_2) of the back of an elastic body that the support holds.

        phi is the coordinate in the frame of the shoe, and `ShoeBodyOfConstantSection.grip` gives
        the interval's length. The result is None if the support holds an end face, or if the shoe
        is rigid, has a mesh file or is a straight beam. `size` is the size of the brake [m].
        """
        if (
            not isinstance(self.body, ShoeBodyOfConstantSection)
            or self.mesh is not None
            or not self.has_support_on_back_of_body
        ):
            return None
        start, end = self.arc
        place = (
            self.lining.middle
            if self.pivot is None
            else self.drum_angle_or_plane_x_of_point(self.pivot)
        )
        # The held interval has at most 60 % of the lining's length.
        wanted = (
            0.5
            * (self.body.grip or self.body.thickness)
            / self.length_along_shoe_back_per_unit_of_phi(size)
        )
        half = min(wanted, 0.3 * (end - start))
        # The middle of the interval has the coordinate of the pivot, or of the lining's middle if
        # there is no pivot. The interval is moved if it would be too near to an end of the lining.
        phi = self.frame.phi_of_surface_coordinates(np.array(place))
        at = float(np.clip(phi, start + 1.5 * half, end - 1.5 * half))
        return at - half, at + half


class Brake(PartOfInputFile):
    """A brake with its friction coefficient, direction of motion, friction surface and shoes."""

    def __repr__(self) -> str:
        """The brake as a line of text and a table of its shoes."""
        return text_of_brake(self)

    def __str__(self) -> str:
        return text_of_brake(self)

    def _repr_html_(self) -> str:
        """The brake as an HTML table, which notebooks display."""
        return html_table_of_brake(self)

    hints_on_other_keys: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("brake", "vary", "cases", "model"),
        " (a key of sweep files; `drumlin sweep` takes a sweep file)",
    )

    surface: ClassVar[FrictionSurface]
    direction_key: ClassVar[str]
    """Key of the direction of motion in a brake file, such as "rotation"."""
    directions: ClassVar[tuple[str, str]]
    """The allowed directions of motion: towards growing, then towards falling coordinates q."""

    # `DrumBrake` and `FlatBrake` define these as fields, each in the order of its brake file.
    if TYPE_CHECKING:

        @property
        def title(self) -> str: ...
        @property
        def friction_as_written(self) -> float | FrictionTable: ...
        @property
        def shoes(self) -> tuple[Shoe, ...]: ...
        @property
        def actuation(self) -> DriveOfAllShoes | None: ...
        @property
        def links(self) -> tuple[StrutOrStrapBetweenShoes, ...]: ...
        @property
        def springs(self) -> tuple[Spring, ...]: ...
        @property
        def levers(self) -> tuple[Lever, ...]: ...
        @property
        def gravity(self) -> Gravity | None: ...
        @property
        def shoe_speed(self) -> float | None: ...

    @staticmethod
    def brake_class_for_file_data(data: object) -> "type[Brake]":
        """The class that reads the data of a brake file.

        The class is `FlatBrake` for data with the key "plane", and `DrumBrake` for all other data.
        """
        # Data with neither "drum" nor "plane" are read by `DrumBrake`, whose error message names
        # the missing drum.
        shapes = {shape.surface.name: shape for shape in Brake.__subclasses__()}
        on_plane = isinstance(data, Mapping) and FRICTION_SURFACE_OF_PLANE.name in data
        return shapes[FRICTION_SURFACE_OF_PLANE.name if on_plane else FRICTION_SURFACE_OF_DRUM.name]

    @classmethod
    def model_validate(cls, obj: Any, **options: Any) -> Self:
        """Make a brake from the data of a brake file. Raises pydantic.ValidationError."""
        if cls is Brake:
            return cast("Self", Brake.brake_class_for_file_data(obj).model_validate(obj, **options))
        return super().model_validate(obj, **options)

    @property
    @abstractmethod
    def direction(self) -> str:
        """The direction of motion, one of `directions`."""

    @property
    @abstractmethod
    def size(self) -> float:
        """Reference length of the brake [m]: the drum's radius, or the first lining's length."""

    @property
    def length_per_surface_coordinate(self) -> float:
        """Length along the surface per unit of its coordinate: R [m] on a drum, 1 on a plane.

        The number is also the lever arm that converts a friction force to the torque on a drum, or
        to the braking force on a plane.
        """
        return 1.0 if self.surface.is_plane_and_not_drum else self.size

    @property
    def surface_coordinate_per_phi(self) -> float:
        """Change of the surface's coordinate q per unit of phi, see `ShoeFrame`."""
        return self.size / self.length_per_surface_coordinate

    @property
    def ring(self) -> DrumRing | None:
        """The elastic ring of the drum; None for a rigid drum and for a plane."""
        return None

    @property
    def motion_as_text(self) -> str:
        """Text about the motion, such as "drum turns counter-clockwise"."""
        return f"{self.surface.words_before_direction} {self.direction}"

    @property
    def direction_as_text_in_tables(self) -> str:
        """Direction of motion as tables of results show it, such as "counter-clockwise"."""
        return self.surface.direction_pattern_for_tables.format(self.direction)

    @abstractmethod
    def brake_with_reversed_motion(self) -> Self:
        """A copy of the brake with the opposite direction of motion."""

    @abstractmethod
    def brake_reduced_to_stiffness_data(self) -> Self:
        """The brake reduced to data that change the condensed stiffness of its shoes and ring.

        Brakes that are equal in this form have the same condensed stiffness. Title, direction of
        motion and the deviation of the drum from its circle get fixed values. A friction
        coefficient above 0 becomes 1. Springs, levers, gravity and speeds are removed, and the
        shoes are not changed.
        """

    def brake_without_ring(self) -> Self:
        """The brake on a rigid drum; a brake on a plane is returned as it is."""
        return self

    def brake_with_perfectly_round_drum(self) -> Self:
        """The brake on a drum that is not out of round; a brake on a plane is returned as it is."""
        return self

    @property
    def out_of_round_harmonics(self) -> tuple[OutOfRoundHarmonic, ...]:
        """Harmonics of a drum that is out of round; empty for a plane."""
        return ()

    def radial_deviation_of_drum_surface(self, theta: Floats) -> Floats | None:
        """Radial deviation [m] of a drum that is out of round, at angles theta, same shape.

        The deviation is positive where the friction surface lies outside the drum's circle. The
        result is None for a round drum and for a plane.
        """
        return None

    @property
    def opposite_direction_of_motion(self) -> str:
        """The direction opposite to the direction of motion."""
        first, second = self.directions
        return second if self.sign_of_motion > 0 else first

    @property
    def sign_of_motion(self) -> int:
        """Sense of the motion: +1 towards growing coordinates of the surface, else -1."""
        return 1 if self.direction == self.directions[0] else -1

    @property
    @abstractmethod
    def sliding_speed(self) -> float | None:
        """Speed [m/s] at which drum or plane slides over the linings; None if it is not given."""

    @property
    def friction(self) -> float:
        """Friction coefficient of the brake.

        If the file gives a table, the result is the coefficient at the brake's sliding speed, for a
        cold lining without pressure.
        """
        return self._friction_coefficient_at_zero_pressure(self.friction_as_written, 0.0)

    def _friction_coefficient_at_zero_pressure(
        self, written: float | FrictionTable, temperature_rise: float
    ) -> float:
        """The friction coefficient at the pressure 0 and a temperature rise [K] of the lining.

        `written` is the value of a key `friction` in the brake file: a coefficient or a table.
        """
        if not isinstance(written, FrictionTable):
            return written
        curve = written.friction_coefficient_curve_at_speed_and_temperature_rise(
            self.sliding_speed or 0.0, temperature_rise
        )
        return float(curve.friction_coefficients_at_pressures(np.zeros(())))

    def friction_coefficient_curve_of_shoe(self, shoe: Shoe) -> FrictionOverPressureCurve:
        """Friction coefficient of a shoe's lining as a function of the pressure.

        A coefficient that does not depend on the pressure is a curve of one point.
        """
        own = shoe.lining.friction
        return friction_coefficient_curve_of_lining(
            self.friction_as_written if own is None else own,
            self.sliding_speed or 0.0,
            shoe.lining.temperature_rise,
        )

    def friction_coefficient_of_shoe_at_zero_pressure(self, shoe: Shoe) -> float:
        """Friction coefficient of a shoe's lining: its own if it has one, else the brake's.

        If the file gives a table, the result is the coefficient at the pressure 0.
        """
        own = shoe.lining.friction
        written = self.friction_as_written if own is None else own
        return self._friction_coefficient_at_zero_pressure(written, shoe.lining.temperature_rise)

    def shoe_friction_over_brake_friction(self, shoe: Shoe) -> float:
        """Friction coefficient of a shoe's lining divided by the friction coefficient of the brake.

        The ratio is 1 for a brake without friction, whose linings have no friction either.
        """
        if not self._has_lining_its_own_friction_coefficient(shoe) or self.friction == 0:
            return 1.0
        return self.friction_coefficient_of_shoe_at_zero_pressure(shoe) / self.friction

    def _has_lining_its_own_friction_coefficient(self, shoe: Shoe) -> bool:
        """Whether the friction coefficient of a shoe's lining may differ from the brake's.

        The coefficient may differ if the lining has a key `friction`, or if the lining is heated
        and the brake's friction is a table over the temperature.
        """
        written = self.friction_as_written
        by_heat = isinstance(written, FrictionTable) and bool(written.temperature_rise)
        return shoe.lining.friction is not None or (by_heat and shoe.lining.temperature_rise != 0)

    def brake_friction_that_gives_shoe_friction(self, shoe: Shoe, friction: float) -> float:
        """Friction coefficient of the brake that gives a shoe's lining the coefficient `friction`.

        The coefficients of brake and linings change in proportion. The result is inf for a lining
        without friction.
        """
        ratio = self.shoe_friction_over_brake_friction(shoe)
        return friction / ratio if ratio else math.inf

    def first_key_that_gives_lining_its_own_friction(self) -> str | None:
        """The first key of the brake file that gives a lining its own friction coefficient.

        The result is the key `friction` or `temperature_rise` of a lining; None if no lining has
        its own coefficient.
        """
        for i, shoe in enumerate(self.shoes):
            if self._has_lining_its_own_friction_coefficient(shoe):
                own = "temperature_rise" if shoe.lining.friction is None else "friction"
                return f"shoe[{i}].lining.{own}"
        return None

    def check_brake_has_friction_if_lining_has(self) -> None:
        """Raise ValueError if a lining has its own friction coefficient and the brake's is 0.

        The search for self-locking, and the slopes of results by friction, scale the coefficients
        of all linings in proportion to the brake's coefficient, which must therefore not be 0.
        """
        key = self.first_key_that_gives_lining_its_own_friction()
        if self.friction == 0 and key is not None:
            raise ValueError(
                f"friction = 0: must be greater than 0 where a lining has its own {key}"
            )

    def brake_with_new_friction_coefficient(self, friction: float) -> Self:
        """A copy of the brake with the friction coefficient `friction`.

        The own friction coefficient of a lining, if it has one, is scaled by the same factor as the
        brake's.
        """
        if self.first_key_that_gives_lining_its_own_friction() is None:
            return self.model_copy(update={"friction_as_written": friction})
        shoes = []
        for shoe in self.shoes:
            own = friction * self.shoe_friction_over_brake_friction(shoe)
            changed = own if self._has_lining_its_own_friction_coefficient(shoe) else None
            lining = shoe.lining.copy_of_lining_with_changed_fields({"friction": changed})
            shoes.append(shoe.model_copy(update={"lining": lining}))
        return self.model_copy(update={"friction_as_written": friction, "shoes": tuple(shoes)})

    def brake_with_multiplied_friction(self, factor: float) -> Self:
        """A copy of the brake with all friction coefficients, also of tables, times a factor."""
        shoes = []
        for shoe in self.shoes:
            own = shoe.lining.friction
            changed = None if own is None else multiplied_friction(own, factor)
            lining = shoe.lining.copy_of_lining_with_changed_fields({"friction": changed})
            shoes.append(shoe.model_copy(update={"lining": lining}))
        written = multiplied_friction(self.friction_as_written, factor)
        return self.model_copy(update={"friction_as_written": written, "shoes": tuple(shoes)})

    @property
    def friction_coefficients_as_text(self) -> str:
        """The friction coefficients as a text, such as "mu = 0.3, 0.4 of shoe 'left'".

        The text names the shoes whose linings have a friction of their own.
        """
        own = [
            f"{friction_coefficient_as_text(self.friction_coefficient_curve_of_shoe(shoe))} of "
            "shoe "
            f"{shoe.name!r}"
            for shoe in self.shoes
            if self._has_lining_its_own_friction_coefficient(shoe)
        ]
        speed, written = self.sliding_speed or 0.0, self.friction_as_written
        of_brake = friction_coefficient_as_text(
            friction_coefficient_curve_of_lining(written, speed, 0.0)
        )
        return ", ".join([f"mu = {of_brake}", *own])

    def signed_friction_stress_over_pressure(self, shoe: Shoe) -> float:
        """Friction stress on a shoe's lining at full slip, divided by the pressure.

        The ratio is the friction coefficient times `sign_of_motion`, and positive towards growing
        coordinates of the surface.
        """
        return self.friction_coefficient_of_shoe_at_zero_pressure(shoe) * self.sign_of_motion

    def signed_friction_stress_over_pressure_in_shoe_frame(self, shoe: Shoe) -> float:
        """Friction stress on a shoe's lining at full slip, divided by the pressure.

        The ratio is positive towards growing phi, the coordinate of the shoe's own frame.
        """
        return self.signed_friction_stress_over_pressure(shoe) * shoe.frame.sense

    @property
    def reason_why_cam_or_strut_sets_forces(self) -> str | None:
        """Text for an error message that the forces on the shoes follow from a cam or a strut.

        The result is None if the force on each shoe is known before the solve.
        """
        return reason_why_forces_follow_from_cam_or_strut(self.actuation, self.links)

    @property
    def names_of_shoes_pushed_by_struts(self) -> set[str]:
        """The names of the shoes whose whole actuation is the force of a strut.

        A strut between two shoes on anchors is a support of both, and pushes neither of them.
        """
        on_anchors = {shoe.name for shoe in self.shoes if shoe.anchors}
        return {link.to for link in self.links} - on_anchors

    def reason_why_shoes_cannot_be_meshed(self) -> str | None:
        """Why the shoes cannot be meshed by finite elements (missing data); None if they can."""
        for shoe in self.shoes:
            if shoe.lining.thickness is None or shoe.lining.material is None:
                return f"shoe {shoe.name!r}: its lining has no thickness and material to mesh"
        return None

    def check_shoes_can_be_meshed(self) -> None:
        """Raise BadInput if data are missing that finite elements need."""
        reason = self.reason_why_shoes_cannot_be_meshed()
        if reason is not None:
            raise BadInput(f"fem does not apply to this brake: {reason}")

    def reason_if_several_linings_are_not_allowed(self, what: str) -> str | None:
        """Why the computation `what` does not take this brake; None if each shoe has one lining."""
        for shoe in self.shoes:
            reason = shoe.reason_if_several_linings_are_not_allowed(what)
            if reason is not None:
                return f"shoe {shoe.name!r}: {reason}"
        return None

    def reason_why_not_all_shoes_are_hinged(self) -> str | None:
        """Why not every shoe turns about a hinge under a known force; None if every shoe does."""
        if self.reason_why_cam_or_strut_sets_forces:
            return self.reason_why_cam_or_strut_sets_forces
        for shoe in self.shoes:
            if shoe.kind_of_support != "hinge":
                return (
                    f"shoe {shoe.name!r}: {MOTION_TEXTS_BY_KIND_OF_SUPPORT[shoe.kind_of_support]}"
                )
        return None

    def check_all_shoes_are_hinged(self, what: str) -> None:
        """Raise BadInput unless every shoe turns about a hinge under a known force.

        `what` names the computation that needs it, for the message.
        """
        reason = self.reason_why_not_all_shoes_are_hinged()
        if reason is not None:
            raise BadInput(f"{what} takes shoes on hinges under forces of their own only: {reason}")

    def text_with_names_of_shoes_at_indices(self, group: Sequence[int]) -> str:
        """Names of the shoes with the indices `group`, for an error message."""
        return ", ".join(f"shoe {self.shoes[i].name!r}" for i in group)
