"""Loads on a shoe besides its actuation: plain forces, springs, weight and centrifugal forces.

The brake file gives plain forces and masses for each shoe. Springs, levers, gravity and the speed
of rotating shoes are keys of the whole brake. `brake_with_loads_assigned_to_shoes` hands them to
the shoes as forces at points and accelerations of masses. The resultant (3,) of a load has force x,
force y [N] and the moment [N m] about the origin of the brake, counter-clockwise positive.
"""

import math
from collections.abc import Sequence
from typing import Annotated, Any, NamedTuple, Self

import numpy as np
from pydantic import Field, model_validator

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.brake.components import Actuation
from drumlin.brake.fields import (
    Acceleration,
    Angle,
    CartesianOrPolarPoint,
    Force,
    Mass,
    Name,
    PartOfInputFile,
    SpringRate,
)

STANDARD_GRAVITY = 9.80665
"""Standard acceleration of free fall [m/s^2], by definition of the CGPM of 1901."""


class ForceAtPoint(NamedTuple):
    """A force `force` (2,) [N] that acts on a shoe at a `point` (2,) [m]."""

    force: tuple[float, float]
    point: tuple[float, float]

    @property
    def resultant(self) -> Floats:
        """The resultant (3,): force x [N], force y [N] and moment about the origin [N m]."""
        fx, fy = self.force
        return np.array([fx, fy, self.point[0] * fy - self.point[1] * fx])


class SpringLeverAndMassLoads(NamedTuple):
    """The loads on a shoe that follow from keys of the whole brake.

    Attributes
    ----------
    forces : force of each spring and lever that acts on the shoe; 0 for a spring without pull
    gravity : (2,) acceleration of free fall [m/s^2]
    squared_angular_velocity : square of the angular velocity of the shoe about the origin
        [rad^2/s^2]
    """

    forces: tuple[ForceAtPoint, ...] = ()
    gravity: tuple[float, float] = (0.0, 0.0)
    squared_angular_velocity: float = 0.0

    def gravity_and_rotation_force_per_mass_at_point(self, point: Floats) -> Floats:
        """Force (2,) per mass [m/s^2] of gravity and rotation on a mass at a point (2,) [m]."""
        return np.array(self.gravity) + self.squared_angular_velocity * point


NO_SPRING_LEVER_AND_MASS_LOADS = SpringLeverAndMassLoads()
"""The loads of a shoe without springs, levers, weight and centrifugal force."""


class FurtherForceOnShoe(Actuation):
    """A further force [N] on a shoe, its direction [rad] and a point on its line of action."""

    force: Force


class ShoeMass(PartOfInputFile):
    """The mass [kg] of a shoe with its lining, and its centre of mass."""

    mass: Mass
    point: CartesianOrPolarPoint


class Gravity(PartOfInputFile):
    """The direction [rad] in which weight acts, and the acceleration of free fall [m/s^2]."""

    direction: Angle
    acceleration: Acceleration = STANDARD_GRAVITY


class Spring(PartOfInputFile):
    """A spring between a point of a shoe and a point of another shoe, or of the frame.

    Attributes
    ----------
    shoe : name of the shoe at which the spring begins
    point : point [m] of this shoe
    to : name of the shoe at which the spring ends; None for the frame of the brake
    end : point [m] of that shoe or of the frame
    preload : force [N] of the spring while the shoes stand as the file has them; a positive force
        pulls the two points together, a negative force pushes them apart
    rate : increase [N/m] of the pull per distance by which the points move apart
    """

    shoe: Name
    point: CartesianOrPolarPoint
    to: Name | None = None
    end: CartesianOrPolarPoint
    preload: Force
    rate: Annotated[SpringRate, Field(ge=0)] = 0.0

    @model_validator(mode="after")
    def _check_spring_ends_differ(self) -> Self:
        """Raise ValueError for a spring without length, or from a shoe to the same shoe."""
        if self.to == self.shoe:
            raise ValueError(f"to = {self.to!r}: must be another shoe; leave it out for the frame")
        if math.dist(self.point.xy, self.end.xy) == 0:
            raise ValueError("end: must not be the spring's point, it gives the direction")
        return self

    @property
    def unit_vector_along_spring_to_its_end(self) -> Floats:
        """Unit vector (2,) from the point to the end, the direction of a pull on `shoe`."""
        along = self.end.xy - self.point.xy
        return np.asarray(along / np.linalg.norm(along))

    def spring_or_lever_force_on_shoe(self, name: str, pull: float) -> ForceAtPoint | None:
        """Force on the shoe `name` of the spring with this pull [N].

        It is None if the spring does not begin or end at this shoe.
        """
        if name not in (self.shoe, self.to):
            return None
        sign, at = (1, self.point) if name == self.shoe else (-1, self.end)
        return make_force_at_point(sign * pull * self.unit_vector_along_spring_to_its_end, at.xy)


class Lever(FurtherForceOnShoe):
    """A lever on a shoe that pushes another shoe by a strut, as the lever of a parking brake.

    Attributes
    ----------
    force, direction, point : pull of the cable [N], its direction [rad] and a point of its line [m]
    shoe : name of the shoe on which the lever turns
    pivot : pin [m] of the lever on this shoe
    to : name of the shoe that the strut pushes
    strut, end : points [m] at which the strut bears on the lever, and on the shoe `to`
    """

    shoe: Name
    pivot: CartesianOrPolarPoint
    to: Name
    strut: CartesianOrPolarPoint
    end: CartesianOrPolarPoint

    @model_validator(mode="after")
    def _check_strut_of_lever_pushes(self) -> Self:
        """Raise ValueError if a lever's strut leads to its own shoe or would have to pull."""
        if self.to == self.shoe:
            raise ValueError(f"to = {self.to!r}: must be another shoe")
        if math.dist(self.strut.xy, self.end.xy) == 0:
            raise ValueError("end: must not be the strut's point on the lever")
        if not self.pushing_force_of_strut > 0:
            raise ValueError("force: turns the lever away from its strut, which can only push")
        return self

    @property
    def _unit_vector_along_strut(self) -> Floats:
        """Unit vector (2,) from the lever along the strut to the shoe that the strut pushes."""
        along = self.end.xy - self.strut.xy
        return np.asarray(along / np.linalg.norm(along))

    @property
    def pushing_force_of_strut(self) -> float:
        """Force [N] by which the strut pushes; negative if it would have to pull.

        The moments of the cable and of the strut about the lever's pin balance. The force is nan if
        the strut points at the pin.
        """
        arm, along = self.strut.xy - self.pivot.xy, self._unit_vector_along_strut
        per_newton = float(arm[0] * along[1] - arm[1] * along[0])
        about_pin = self.moment_of_force_about_point(self.pivot)
        return about_pin / per_newton if per_newton else math.nan

    def spring_or_lever_force_on_shoe(self, name: str) -> ForceAtPoint | None:
        """The force of the lever's pin, or of its strut, on the shoe `name`.

        It is None if the lever neither turns on this shoe nor pushes it by the strut.
        """
        strut = self.pushing_force_of_strut * self._unit_vector_along_strut
        if name == self.shoe:
            return make_force_at_point(self.force_vector - strut, self.pivot.xy)
        return make_force_at_point(strut, self.end.xy) if name == self.to else None


def make_force_at_point(force: Floats, point: Floats) -> ForceAtPoint:
    """Make a ForceAtPoint from the arrays of a force (2,) [N] and of its point (2,) [m]."""
    return ForceAtPoint((float(force[0]), float(force[1])), (float(point[0]), float(point[1])))


def brake_with_loads_assigned_to_shoes(brake: Any, pulls: Sequence[float] | None = None) -> Any:
    """Return a copy of the brake whose shoes have the loads of springs, levers, weight, rotation.

    Parameters
    ----------
    brake : the brake
    pulls : pull [N] of each spring; None for the preloads

    Raises
    ------
    ValueError
        if a spring or lever names no shoe of the brake, for gravity or a speed without masses, or
        for masses without both
    """
    _check_loads_have_known_shoes_and_masses(brake)
    if pulls is None:
        pulls = [spring.preload for spring in brake.springs]
    gravity = brake.gravity and brake.gravity.acceleration * np.array(
        [math.cos(brake.gravity.direction), math.sin(brake.gravity.direction)]
    )
    shoes = []
    for shoe in brake.shoes:
        acting = [
            spring.spring_or_lever_force_on_shoe(shoe.name, pull)
            for spring, pull in zip(brake.springs, pulls, strict=True)
        ]
        acting += [lever.spring_or_lever_force_on_shoe(shoe.name) for lever in brake.levers]
        loads = SpringLeverAndMassLoads(tuple(force for force in acting if force is not None))
        if shoe.mass is not None:
            loads = loads._replace(
                gravity=(0.0, 0.0) if gravity is None else tuple(gravity.tolist()),
                squared_angular_velocity=(brake.shoe_speed or 0.0) ** 2,
            )
        shoes.append(shoe.shoe_with_spring_lever_and_mass_loads(loads))
    return brake.model_copy(update={"shoes": tuple(shoes)})


def brake_with_springs_of_constant_pull(brake: Any, pulls: Sequence[float]) -> Any:
    """A copy of the brake in which the pull of each spring is constant, one of `pulls` [N].

    They are the pulls in a solved brake, which depend on the motions of the shoes. Without pulls
    the brake itself is returned.
    """
    if not pulls:
        return brake
    springs = tuple(
        spring.model_copy(update={"preload": pull, "rate": 0.0})
        for spring, pull in zip(brake.springs, pulls, strict=True)
    )
    return brake_with_loads_assigned_to_shoes(brake.model_copy(update={"springs": springs}))


def brake_with_all_loads_moved_to_actuation(brake: Any) -> Any:
    """A copy of the brake on which finite elements let all loads act where the actuations act.

    Elements in three dimensions can load the nodes of the actuation only.
    """
    shoes = tuple(shoe.shoe_with_all_loads_moved_to_actuation() for shoe in brake.shoes)
    return brake.model_copy(update={"shoes": shoes})


def _check_loads_have_known_shoes_and_masses(brake: Any) -> None:
    """Raise ValueError if loads name unknown shoes, or if masses or accelerations are missing.

    Gravity and the speed of the shoes need a mass, and a mass needs one of the two.
    """
    names = [shoe.name for shoe in brake.shoes]
    for part, each in (("spring", brake.springs), ("lever", brake.levers)):
        for i, joined in enumerate(each):
            for key, name in (("shoe", joined.shoe), ("to", joined.to)):
                if name is not None and name not in names:
                    known = ", ".join(names)
                    raise ValueError(
                        f"{part}[{i}].{key} = {name!r}: must be the name of a shoe: {known}"
                    )
    for key in ("gravity", "shoe_speed"):
        if getattr(brake, key) is not None and all(shoe.mass is None for shoe in brake.shoes):
            raise ValueError(f"{key}: acts on masses; give shoe.mass, or leave it out")
    if brake.gravity is None and brake.shoe_speed is None:
        for i, shoe in enumerate(brake.shoes):
            if shoe.mass is not None:
                raise ValueError(
                    f"shoe[{i}].mass: has no effect without [gravity] or shoe_speed; give one"
                )


def reason_if_loads_besides_actuation_act(brake: Any, what: str) -> str | None:
    """Why a computation that takes actuation forces only does not apply; None if it applies.

    The text names the computation (`what`) and the first key of a load that is no actuation force.
    """
    key = first_key_of_loads_besides_actuation(brake)
    return None if key is None else f"{key}: {what} takes forces of the actuation only"


def first_key_of_loads_besides_actuation(brake: Any) -> str | None:
    """The first key of the brake file with a load besides the actuation; None if there is none."""
    for i, shoe in enumerate(brake.shoes):
        if shoe.forces:
            return f"shoe[{i}].force"
    if brake.springs or brake.levers:
        return "spring[0]" if brake.springs else "lever[0]"
    return next((key for key in ("gravity", "shoe_speed") if getattr(brake, key) is not None), None)


def require_springs_with_constant_pull(brake: Any, what: str) -> None:
    """Raise BadInput if a spring of the brake has a rate; `what` names the computation."""
    for i, spring in enumerate(brake.springs):
        if spring.rate > 0:
            raise BadInput(
                f"spring[{i}].rate = {spring.rate * 1e-3:g} N/mm: {what} takes springs of constant "
                "pull; leave out rate and give the pull as preload"
            )
