"""Supports of a shoe (hinge, pivot, abutment, guide, anchors) and the motions that they allow.

A rigid-body motion in the plane has three numbers: dx, dy [m] and turn [rad] about the origin. It
displaces the point (x, y) by (dx - turn y, dy + turn x). The rigid-body modes of a shoe are the
motions that its support allows.

Equilibrium is written with test modes, on which the support reactions do no work. The test modes
are equal to the rigid-body modes unless friction acts at an abutment. With friction the reaction is
not normal to the abutment's face: the shoe still slides along the face, but its test mode is a
translation perpendicular to the reaction.
"""

import math
from pathlib import Path
from typing import Annotated, Literal, NamedTuple, Self

import numpy as np
from pydantic import (
    AfterValidator,
    Field,
    PrivateAttr,
    StrictInt,
    ValidationError,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    model_validator,
)

from drumlin.base.arrays import Floats
from drumlin.base.files import protect_file_from_being_overwritten
from drumlin.brake.components import Actuation
from drumlin.brake.fields import (
    PURE_NUMBER_VALIDATOR,
    Angle,
    CartesianOrPolarPoint,
    Length,
    Name,
    PartOfInputFile,
    Point,
)
from drumlin.brake.further_loads import (
    NO_SPRING_LEVER_AND_MASS_LOADS,
    ForceAtPoint,
    FurtherForceOnShoe,
    ShoeMass,
    SpringLeverAndMassLoads,
    make_force_at_point,
)

KEYS_OF_SUPPORTS_OF_WHICH_ONE_IS_REQUIRED = ("hinge", "abutment", "guide")
"""Keys of the supports of which a shoe without anchors has exactly one.

A pivot is no such support: it lies on a lever, which turns about the hinge.
"""

MOTION_TEXTS_BY_KIND_OF_SUPPORT = {
    "hinge": "it turns about its hinge",
    "pivot": "it turns about a pivot on its lever, not about its hinge",
    "abutment": "its foot slides on an abutment, it has no hinge",
    "guide": "it moves along a guide, it has no hinge",
    "anchor": "it rests on anchors that it can leave, it has no hinge",
}
"""How a shoe moves on each support, for error messages, by `SupportedShoe.kind_of_support`."""

SENSE_VALUE_OF_ABUTMENT_THAT_DOES_NOT_ACT = 2
"""Value of `sense` for a support's rigid-body modes with which the abutment does not act.

The foot of the shoe may then slide along the abutment and leave it.
"""

LARGEST_ROUND_OFF_EXCESS_OF_FOOT_FRICTION = 1e-9
"""Largest excess of a sticking foot's friction over the limit of Coulomb that is round-off.

It is relative to the limit. With a larger excess the foot of the shoe slides on the abutment.
"""


class Abutment(PartOfInputFile):
    """A face on which the foot of a shoe, its end away from the actuation, slides.

    The foot bears at `point`. `direction` [rad] is the direction of the face's normal, in which it
    pushes the foot if there is no friction. `friction` is the friction coefficient between the foot
    and the face.
    """

    point: CartesianOrPolarPoint
    direction: Angle
    friction: Annotated[float, Field(ge=0, le=10, strict=True), PURE_NUMBER_VALIDATOR] = 0.0


class Anchor(PartOfInputFile):
    """A face that pushes on the shoe and cannot pull; the shoe may rest on it or leave it.

    The shoe bears at `point`. `direction` [rad] is the direction of the face's force on the shoe.
    `clearance` [m] is the distance between shoe and face while nothing acts.
    """

    point: CartesianOrPolarPoint
    direction: Angle
    clearance: Annotated[Length, Field(ge=0)] = 0.0


class Guide(PartOfInputFile):
    """A straight guide: the shoe moves only along `direction` [rad] and does not turn."""

    direction: Angle


class SupportRigidBodyModes(NamedTuple):
    """The k rigid-body modes of a shoe: the motions that its support allows.

    Attributes
    ----------
    motions : (k, 3), dx, dy and turn of each mode, for a turn by 1 rad or a slide by 1 m
    test_modes : (k, 3), dx, dy and turn of the test modes, on which the support reactions do no
        work
    actuation_work : (k,), work of the actuation on each test mode [N m for a turn, N for a slide]
    work_of_further_loads : (k,), work of all loads besides the actuation on each test mode [N m or
        N]
    actuation_point_travel : (k,), displacement [m] of the actuation's point along the actuation
        force in each mode
    names : (k,), "turn" (about the pin), "tilt" (about a pivot), "slide" (along an abutment or a
        guide), "off" (away from an abutment), "x" or "y" (translations of a shoe on anchors)
    """

    motions: Floats
    test_modes: Floats
    actuation_work: Floats
    work_of_further_loads: Floats
    actuation_point_travel: Floats
    names: tuple[str, ...]

    @property
    def work_of_all_loads_on_test_modes(self) -> Floats:
        """Work (k,) of the actuation and of all other loads on each test mode [N m or N]."""
        return self.actuation_work + self.work_of_further_loads


def rigid_body_motion_of_turn_about_point(point: Point) -> Floats:
    """Rigid-body motion (3,), dx, dy and turn, of a rotation by 1 rad about a point."""
    return np.array([point.y, -point.x, 1.0])


def rigid_body_motion_of_unit_translation(angle: float) -> Floats:
    """Rigid-body motion (3,), dx, dy and turn, of a unit translation in a direction [rad]."""
    return np.array([math.cos(angle), math.sin(angle), 0.0])


def work_of_force_in_rigid_body_motions(motions: Floats, force: Floats, point: Floats) -> Floats:
    """Work (k,) that a force (2,) [N] at a point (2,) [m] does in k rigid-body motions (k, 3)."""
    (x, y), (fx, fy) = point, force
    return motions @ np.array([fx, fy, x * fy - y * fx])


def resultant_force_and_moment(forces: Floats, points: Floats) -> Floats:
    """Resultant (3,) of forces (..., 2) [N] at points (..., 2) [m].

    It has the components in x and y [N] and the moment about the origin [N m].
    """
    moments = points[..., 0] * forces[..., 1] - points[..., 1] * forces[..., 0]
    return np.array([forces[..., 0].sum(), forces[..., 1].sum(), moments.sum()])


def displacements_in_rigid_body_motions(motions: Floats, xy: Floats) -> Floats:
    """Displacements (2, n, k) of the points xy (2, n) [m] in k rigid-body motions (k, 3)."""
    x, y = xy[..., None]
    dx, dy, turn = motions.T
    return np.array([dx - turn * y, dy + turn * x])


class RigidBodyModeDerivativesByDatum(NamedTuple):
    """Derivatives of a shoe's k modes by one datum of its support, such as the hinge's x.

    Attributes
    ----------
    motions : (k, 3), derivatives of dx, dy and turn of the rigid-body modes
    test_modes : (k, 3), derivatives of dx, dy and turn of the test modes
    """

    motions: Floats
    test_modes: Floats


class SupportedShoe(PartOfInputFile):
    """A shoe with its name, its support and its actuation, on a drum or on a plane.

    There are five supports. A `hinge` is a pin about which the shoe turns. With a `pivot`, the
    hinge is the pin of a lever: the actuation acts on the lever, and the shoe turns about the pivot
    at the lever's end. An `abutment` is a face on which the foot of the shoe slides. A `guide` lets
    the shoe move in one direction without turning. `anchors` are faces that push on the shoe and
    that the shoe can leave. A shoe with anchors can leave its abutment as well.
    """

    name: Name
    hinge: CartesianOrPolarPoint | None = None
    pivot: CartesianOrPolarPoint | None = None
    abutment: Abutment | None = None
    guide: Guide | None = None
    anchors: Annotated[tuple[Anchor, ...], Field(alias="anchor")] = ()
    # This default stands for a shoe that a strut pushes, until the brake sets the strut's line.
    actuation: Actuation = Actuation(force=0.0, direction=0.0, point=Point(x=0.0, y=0.0))
    forces: Annotated[tuple[FurtherForceOnShoe, ...], Field(alias="force")] = ()
    mass: ShoeMass | None = None
    # The loads on this shoe by springs, levers, gravity and rotation. The brake sets them.
    _spring_lever_and_mass_loads: SpringLeverAndMassLoads = PrivateAttr(
        NO_SPRING_LEVER_AND_MASS_LOADS
    )
    # Whether finite elements apply all loads of the shoe where its actuation acts.
    _has_loads_at_actuation: bool = PrivateAttr(False)

    @model_validator(mode="after")
    def _check_shoe_has_exactly_one_support(self) -> Self:
        """Raise ValueError unless the shoe has one support: hinge, abutment, guide or anchors."""
        given = [
            key
            for key in KEYS_OF_SUPPORTS_OF_WHICH_ONE_IS_REQUIRED
            if getattr(self, key) is not None
        ]
        if self.anchors:
            self._check_anchors_fit_other_supports(given)
        elif not given:
            raise ValueError(
                "hinge: is missing; "
                "a shoe is held by one of hinge, hinge and pivot, abutment, guide"
            )
        if len(given) > 1:
            raise ValueError(
                f"{given[1]}: a shoe is held by one of "
                f"{', '.join(KEYS_OF_SUPPORTS_OF_WHICH_ONE_IS_REQUIRED)}, "
                f"not by {' and '.join(given)}"
            )
        # A pivot is no support of its own: it lies on a lever, which turns about the hinge.
        if self.pivot is not None and self.hinge is None:
            raise ValueError("pivot: is on a lever, whose pin is the hinge; hinge is missing")
        return self

    def _check_anchors_fit_other_supports(self, given: list[str]) -> None:
        """Raise ValueError if a shoe with anchors has another support than a smooth abutment.

        `given` are the keys of the shoe's supports besides the anchors.
        """
        other = next((key for key in given if key != "abutment"), None)
        if other is not None:
            raise ValueError(
                f"anchor: a shoe on anchors can leave them, {other} holds it both ways; "
                "leave one of them out"
            )
        if self.abutment is not None and self.abutment.friction > 0:
            raise ValueError(
                f"abutment.friction = {self.abutment.friction:g}: a shoe with anchors takes "
                "abutments without friction; leave it out"
            )

    @property
    def kind_of_support(self) -> str:
        """The kind of the shoe's support: "hinge", "pivot", "abutment", "guide" or "anchor"."""
        if self.anchors:
            return "anchor"
        if self.hinge is not None:
            return "hinge" if self.pivot is None else "pivot"
        return "guide" if self.abutment is None else "abutment"

    @property
    def pin(self) -> Point:
        """The point about which moments of the shoe are taken, and from which its angles count.

        It is the hinge, the point of the abutment, the point of the first anchor, or for a guided
        shoe the point of the actuation.
        """
        if self.hinge is not None:
            return self.hinge
        if self.anchors and self.abutment is None:
            return self.anchors[0].point
        return self.actuation.point if self.abutment is None else self.abutment.point

    def shoe_with_changed_actuation_force(self, force: float) -> Self:
        """A copy of the shoe whose actuation has another force [N]."""
        actuation = self.actuation.model_copy(update={"force": force})
        return self.model_copy(update={"actuation": actuation})

    def shoe_with_spring_lever_and_mass_loads(self, loads: SpringLeverAndMassLoads) -> Self:
        """A copy of the shoe under loads of springs, levers, gravity and rotation."""
        shoe = self.model_copy()
        shoe._spring_lever_and_mass_loads = loads
        return shoe

    def shoe_with_all_loads_moved_to_actuation(self) -> Self:
        """A copy of the shoe on which finite elements apply all loads where the actuation acts.

        The result of a solve then depends on the resultant of the loads only, as on a rigid shoe.
        """
        shoe = self.model_copy()
        shoe._has_loads_at_actuation = True
        return shoe

    @property
    def are_all_loads_moved_to_actuation(self) -> bool:
        """Whether finite elements apply all loads of the shoe where its actuation acts."""
        return self._has_loads_at_actuation

    @property
    def spring_lever_and_mass_loads(self) -> SpringLeverAndMassLoads:
        """The loads on the shoe by springs, levers, gravity and rotation."""
        return self._spring_lever_and_mass_loads

    @property
    def forces_at_points_besides_actuation(self) -> tuple[ForceAtPoint, ...]:
        """The plain forces and the forces of springs and levers on the shoe.

        The actuation, and gravity and centrifugal force on the mass, are not among them.
        """
        of_shoe = [make_force_at_point(each.force_vector, each.point.xy) for each in self.forces]
        return (*of_shoe, *self._spring_lever_and_mass_loads.forces)

    @property
    def _gravity_and_rotation_force_on_mass(self) -> ForceAtPoint | None:
        """The force of gravity and rotation at the centre of mass; None without a mass."""
        if self.mass is None:
            return None
        at = self.mass.point.xy
        return make_force_at_point(
            self.mass.mass
            * self._spring_lever_and_mass_loads.gravity_and_rotation_force_per_mass_at_point(at),
            at,
        )

    @property
    def has_loads_besides_actuation(self) -> bool:
        """Whether forces act on the shoe besides its actuation and its support."""
        acting = (
            *self._spring_lever_and_mass_loads.forces,
            self._gravity_and_rotation_force_on_mass,
        )
        return bool(self.forces) or any(each is not None and any(each.force) for each in acting)

    @property
    def is_any_load_on_shoe(self) -> bool:
        """Whether an actuation force or another load acts on the shoe."""
        return self.actuation.force != 0 or self.has_loads_besides_actuation

    @property
    def largest_force_of_any_load(self) -> float:
        """Largest of the forces [N] on the shoe: actuation, other loads, and force on the mass."""
        forces = [abs(each.force) for each in (self.actuation, *self.forces)]
        of_brake = (
            *self._spring_lever_and_mass_loads.forces,
            self._gravity_and_rotation_force_on_mass,
        )
        of_brake_sizes = [math.hypot(*each.force) for each in of_brake if each is not None]
        return max(*forces, *of_brake_sizes, 0.0)

    @property
    def resultant_of_loads_besides_actuation(self) -> Floats:
        """Resultant (3,) of all loads besides the actuation: force x, y [N], moment [N m].

        The moment is about the origin of the brake.
        """
        total = np.zeros(3)
        for each in (
            *self.forces_at_points_besides_actuation,
            self._gravity_and_rotation_force_on_mass,
        ):
            if each is not None:
                total += each.resultant
        return total

    @property
    def sum_of_forces_of_all_loads(self) -> Floats:
        """Sum (2,) [N] of the actuation force and of the forces of all other loads on the shoe."""
        actuation = self.actuation.force_vector
        return (
            actuation + self.resultant_of_loads_besides_actuation[:2]
            if self.has_loads_besides_actuation
            else actuation
        )

    def moment_of_loads_besides_actuation_about_point(self, point: Point) -> float:
        """Moment [N m] of all loads but the actuation about a point; counter-clockwise positive."""
        fx, fy, moment = self.resultant_of_loads_besides_actuation.tolist()
        return float(moment - (point.x * fy - point.y * fx))

    def moment_of_all_loads_about_point(self, point: Point) -> float:
        """Moment [N m] about a point of actuation and other loads; counter-clockwise positive."""
        moment = self.actuation.moment_of_force_about_point(point)
        if self.has_loads_besides_actuation:
            moment += self.moment_of_loads_besides_actuation_about_point(point)
        return moment

    @property
    def unit_vector_of_smooth_abutment_force(self) -> Floats:
        """Unit vector (2,) of the force that an abutment without friction exerts on the foot."""
        assert self.abutment is not None
        return np.array([math.cos(self.abutment.direction), math.sin(self.abutment.direction)])

    @property
    def senses_of_abutment_friction_to_try(self) -> tuple[int, ...]:
        """Senses of the abutment's friction to try in a solve, in this order.

        `rigid_body_modes_of_support` explains the senses. For a support without friction the sense
        is 1, and has no effect.
        """
        return (1, -1, 0) if self.abutment is not None and self.abutment.friction > 0 else (1,)

    def can_abutment_exert_reaction_on_shoe(
        self, reaction: Floats, sense: int, slide: float
    ) -> bool:
        """Whether an abutment can exert a given reaction on the foot.

        It can if it presses on the foot, and if its friction opposes the slide of the foot or is
        large enough to hold it. The result is always True for a shoe without abutment and for a
        shoe on anchors.

        Parameters
        ----------
        reaction : (2,), force on the foot [N]
        sense : assumed sense of the friction, as in `rigid_body_modes_of_support`
        slide : slide of the foot along the face, in any unit; only its sign counts
        """
        if self.abutment is None or self.anchors:
            return True
        c, s = self.unit_vector_of_smooth_abutment_force
        # These are the components of the reaction normal to the face and along the face.
        bearing, along = float(reaction @ [c, s]), float(reaction @ [-s, c])
        if bearing <= 0 or self.abutment.friction == 0:
            return bearing > 0
        # The foot sticks if the force along the face is at most the limit of Coulomb friction.
        if sense == 0:
            return abs(along) <= self.abutment.friction * bearing * (
                1 + LARGEST_ROUND_OFF_EXCESS_OF_FOOT_FRICTION
            )
        return sense * slide <= 0

    def rigid_body_modes_of_support(self, sense: int = 1) -> SupportRigidBodyModes:
        """The rigid-body modes of the shoe.

        Parameters
        ----------
        sense : sense of the friction of an abutment on the foot. It is +1 in the direction of the
            face's normal turned by +90 deg, -1 in the opposite direction, and 0 if the foot sticks.
            With SENSE_VALUE_OF_ABUTMENT_THAT_DOES_NOT_ACT the abutment is left out: the foot may
            slide and leave the face. For other supports the sense has no effect. A shoe on anchors
            has three modes: its supports are inequalities, see `one_sided.OneSidedSupport`.
        """
        at = self.actuation.point.xy
        # Every shoe except a guided one turns about its pin. A lever or an abutment adds a mode,
        # and anchors add two.
        motions, names = [rigid_body_motion_of_turn_about_point(self.pin)], ["turn"]
        if self.guide is not None:
            motions, names = (
                [rigid_body_motion_of_unit_translation(self.guide.direction)],
                ["slide"],
            )
        elif self.pivot is not None:
            motions.append(rigid_body_motion_of_turn_about_point(self.pivot))
            names.append("tilt")
        elif self.anchors:
            motions += [
                rigid_body_motion_of_unit_translation(angle) for angle in (0.0, math.pi / 2)
            ]
            names += ["x", "y"]
        tests = list(motions)
        on_abutment = self.abutment is not None and not self.anchors
        if on_abutment and sense != 0:
            assert self.abutment is not None
            along = self.abutment.direction + math.pi / 2
            # Friction rotates the test mode by the friction angle, so that it stays perpendicular
            # to the reaction.
            leaning = (
                (sense != SENSE_VALUE_OF_ABUTMENT_THAT_DOES_NOT_ACT)
                * sense
                * math.atan(self.abutment.friction)
            )
            motions.append(rigid_body_motion_of_unit_translation(along))
            tests.append(rigid_body_motion_of_unit_translation(along + leaning))
            names.append("slide")
        # With SENSE_VALUE_OF_ABUTMENT_THAT_DOES_NOT_ACT the foot may also leave the face, along the
        # normal of the face.
        if on_abutment and sense == SENSE_VALUE_OF_ABUTMENT_THAT_DOES_NOT_ACT:
            assert self.abutment is not None
            motions.append(rigid_body_motion_of_unit_translation(self.abutment.direction))
            tests.append(motions[-1])
            names.append("off")
        moved, tested = np.array(motions), np.array(tests)
        work = work_of_force_in_rigid_body_motions(tested, self.actuation.force_vector, at)
        tip = work_of_force_in_rigid_body_motions(moved, self.actuation.unit_vector_of_force, at)
        # With a pivot the actuation acts on the lever, which rests while the shoe tilts about the
        # pivot: the actuation does no work.
        if self.pivot is not None:
            work[1] = tip[1] = 0.0
        return SupportRigidBodyModes(
            moved,
            tested,
            work,
            tested @ self.resultant_of_loads_besides_actuation,
            tip,
            tuple(names),
        )

    def derivatives_of_rigid_body_modes_by_support_data(
        self, sense: int = 1
    ) -> dict[str, tuple[RigidBodyModeDerivativesByDatum, ...]]:
        """Exact derivatives of the rigid-body modes with respect to the data of the support.

        The result has a tuple by the key of each datum: two derivatives, by x and y [per m], for a
        point; one derivative [per rad] for a direction, and one for a friction coefficient. `sense`
        is the sense of the friction, as in `rigid_body_modes_of_support`.
        """
        k = len(self.rigid_body_modes_of_support(sense).names)
        if self.guide is not None:
            # The derivative of a unit vector by its angle is the vector turned by 90 deg.
            turned = rigid_body_motion_of_unit_translation(self.guide.direction + math.pi / 2)
            return {"guide.direction": (_equal_derivatives_of_mode_and_test_mode(k, 0, turned),)}
        if self.abutment is None:
            of_hinge = {"hinge": _mode_derivatives_by_turning_point_position(k, 0)}
            if self.pivot is None:
                return of_hinge
            return {**of_hinge, "pivot": _mode_derivatives_by_turning_point_position(k, 1)}
        found = {"abutment.point": _mode_derivatives_by_turning_point_position(k, 0)}
        # If the foot sticks, the modes do not depend on the direction of the face.
        if sense == 0:
            return found
        # The motion is along the face, and the test mode is rotated from it by the friction angle.
        # The derivative of a unit vector by the face's direction is perpendicular to the vector.
        mu, along = self.abutment.friction, self.abutment.direction + math.pi / 2
        tested = rigid_body_motion_of_unit_translation(along + sense * math.atan(mu) + math.pi / 2)
        of_motion = rigid_body_motion_of_unit_translation(along + math.pi / 2)
        change_of_motion = _derivatives_of_one_rigid_body_mode(k, 1, of_motion)
        change_of_test = _derivatives_of_one_rigid_body_mode(k, 1, tested)
        found["abutment.direction"] = (
            RigidBodyModeDerivativesByDatum(change_of_motion, change_of_test),
        )
        if mu > 0:
            of_test = _derivatives_of_one_rigid_body_mode(k, 1, sense * tested / (1 + mu**2))
            found["abutment.friction"] = (
                RigidBodyModeDerivativesByDatum(np.zeros((k, 3)), of_test),
            )
        return found


def _absolute_mesh_path(mesh: Path | None, info: ValidationInfo) -> Path | None:
    """Make the path of a mesh file absolute; relative paths start from the brake file's folder.

    The mesh file is protected from being overwritten. Without a brake file the path is not changed.
    """
    base = (info.context or {}).get("base")
    if mesh is None or base is None:
        return mesh
    protect_file_from_being_overwritten(base / mesh)
    return Path(base / mesh)


def _read_group_names(value: object, read: ValidatorFunctionWrapHandler) -> object:
    """Read the names or numbers of a group of elements in a mesh file.

    `read` is pydantic's own reader. Raises ValueError with a plain message for other data.
    """
    try:
        return read(value)
    except ValidationError as error:
        raise ValueError(
            "must be the name or the whole number of a group in the mesh file, or a list of these"
        ) from error


NamesOfMeshGroupInMeshFile = Annotated[
    Name | StrictInt | tuple[Name | StrictInt, ...] | None, WrapValidator(_read_group_names)
]
"""How a mesh file calls a group of elements: a name, a number, or several of them.

With None the group has the name that drumlin gives it.
"""


class MeshGroups(PartOfInputFile):
    """The names or numbers of a shoe's groups of elements or nodes in its mesh file.

    A group whose field is None has the name of the field in the mesh file, such as "lining".
    """

    lining: NamesOfMeshGroupInMeshFile = None
    backing: NamesOfMeshGroupInMeshFile = None
    table: NamesOfMeshGroupInMeshFile = None
    shoe: NamesOfMeshGroupInMeshFile = None
    contact: NamesOfMeshGroupInMeshFile = None
    hinge: NamesOfMeshGroupInMeshFile = None
    actuation: NamesOfMeshGroupInMeshFile = None

    def names_of_group_in_mesh_file(self, group: str) -> list[str]:
        """The names or numbers, as texts in lower case, of the group `group` in the mesh file."""
        given = getattr(self, group)
        if given is None:
            return [group]
        several = given if isinstance(given, tuple) else (given,)
        return [str(name).lower() for name in several]

    @property
    def element_groups_named_in_brake_file(self) -> list[str]:
        """The groups for which the brake file gives the name or number in the mesh file."""
        return [group for group in type(self).model_fields if getattr(self, group) is not None]


class ShoeWithOptionalMeshFile(SupportedShoe):
    """A shoe that may have a mesh file, `mesh`, in place of the parametric mesh.

    `mesh_frame` says whether the mesh has the coordinates of the brake or of the shoe's own frame,
    in which a shoe and its mirror image can share a file. `mesh_interference` states that a contact
    line deep inside the drum or the plane is intended. `groups` are the names or numbers of the
    groups of elements in the mesh file.
    """

    mesh: Annotated[Path | None, AfterValidator(_absolute_mesh_path)] = None
    mesh_unit: Literal["m", "mm", "in"] = "m"
    mesh_frame: Literal["brake", "shoe"] = "brake"
    mesh_interference: bool = False
    groups: MeshGroups = MeshGroups()

    @model_validator(mode="after")
    def _check_mesh_keys_have_mesh_file(self) -> Self:
        """Raise ValueError if a shoe without mesh file has a key about a mesh file."""
        for key in ("mesh_unit", "mesh_frame", "mesh_interference", "groups"):
            if self.mesh is None and getattr(self, key) != type(self).model_fields[key].default:
                raise ValueError(
                    f"{key} = {getattr(self, key)!r}: belongs to a mesh file; mesh is missing"
                )
        return self


def _derivatives_of_one_rigid_body_mode(count: int, row: int, change: Floats) -> Floats:
    """Derivatives (count, 3) of `count` modes of which only mode number `row` changes.

    `change` (3,) is the derivative of dx, dy and turn of this mode.
    """
    found = np.zeros((count, 3))
    found[row] = change
    return found


def _equal_derivatives_of_mode_and_test_mode(
    count: int, row: int, change: Floats
) -> RigidBodyModeDerivativesByDatum:
    """Derivatives of `count` modes of which only mode number `row` changes, with its test mode.

    `change` (3,) is the derivative of dx, dy and turn, of the rigid-body mode and of the test mode.
    """
    return RigidBodyModeDerivativesByDatum(
        _derivatives_of_one_rigid_body_mode(count, row, change),
        _derivatives_of_one_rigid_body_mode(count, row, change),
    )


def _mode_derivatives_by_turning_point_position(
    count: int, row: int
) -> tuple[RigidBodyModeDerivativesByDatum, ...]:
    """Derivatives of `count` modes by x and y of the point about which mode number `row` turns."""
    along_x = _equal_derivatives_of_mode_and_test_mode(count, row, np.array([0.0, -1.0, 0.0]))
    along_y = _equal_derivatives_of_mode_and_test_mode(count, row, np.array([1.0, 0.0, 0.0]))
    return along_x, along_y


def check_rigid_body_modes_close_gap_differently(
    key: str, shoe: SupportedShoe, columns: slice
) -> None:
    """Raise ValueError if the two rigid-body modes of a shoe close its gap in the same way.

    Some combination of the two modes would then not change the gap, so that contact could not
    resist this motion. A shoe with another number of modes is not checked.

    Parameters
    ----------
    key : key of the shoe in the message
    shoe : the shoe
    columns : components of a motion that close the gap: dx and dy on a drum, dy and turn on a plane
    """
    closing = shoe.rigid_body_modes_of_support().motions[:, columns]
    # The check is for two modes. They close the gap in the same way if the components that close
    # it are proportional.
    if len(closing) != 2:
        return
    lengths = np.linalg.norm(closing, axis=1)
    # The two rows are parallel if their determinant is small relative to their lengths.
    if abs(np.linalg.det(closing)) <= 1e-6 * np.prod(lengths):
        what = (
            "pivot: the lever's pin"
            if shoe.pivot is not None
            else "abutment: the normal of its face"
        )
        where = "the drum's centre" if columns.start == 0 else "the normal of the plane"
        raise ValueError(
            f"{key}.{what} must not be in line with it and {where}: the shoe would only slide"
        )
