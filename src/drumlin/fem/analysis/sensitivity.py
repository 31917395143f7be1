"""Exact derivatives of the torque of an elastic brake, computed by the adjoint method.

The adjoint is the solution of the transposed equations of the brake (fem.analysis.adjoint). From
one adjoint follow the derivatives of the torque with respect to all data, so that no differences of
solves are needed.

- If a modulus changes, dT = -v^T dK u. Here u are the displacements under the loads, and v the
  displacements under the adjoint loads. dK is the change of the part of the stiffness that is
  proportional to the modulus.
- The supports of a shoe act through its rigid-body modes. A support also acts through the body if
  nodes of the body move with the support (fem.analysis.moving): a straight beam ends at the hinge,
  and the back of an arc is gripped at the pivot. Then dT = -v^T (dK/dX dX) u. Here dK/dX is the
  exact derivative of the stiffness by the places X of the nodes (fem.analysis.mutual_work).
- If nodes of the contact move too, the coupling and the gap of the contact change. Their changes
  are central differences.

The division into elements does not change with the data. If a node is just about to enter or leave
the contact, the torque has a kink, and the derivatives hold for the present nodes in contact.
The derivatives include the changes of strut and cam forces.

For three-dimensional (solid) shoes the displacements inside the body are not computed. Their
derivatives by moduli therefore contain central differences of the condensed stiffness
(fem.analysis.wide_moduli), whose error is stated. Derivatives by a support whose motion moves nodes
of the body are not given. All other derivatives are exact.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.texts import error_text_in_percent
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import vary
from drumlin.brake.friction import first_key_of_pressure_dependent_friction
from drumlin.brake.further_loads import brake_with_loads_assigned_to_shoes
from drumlin.brake.heat import reason_if_any_shoe_is_heated
from drumlin.brake.orthotropic import names_of_orthotropic_parts
from drumlin.brake.support import RigidBodyModeDerivativesByDatum, resultant_force_and_moment
from drumlin.fem.analysis.adjoint import (
    ShoeAdjoint,
    TorqueDerivativesAndAdjointOfGroup,
    motions_along_surface_with_struts_in_solution,
    solve_adjoint_for_torque_of_shoe_group,
)
from drumlin.fem.analysis.moving import (
    NodeMotionPerPointMotion,
    contact_lines_with_moved_nodes,
    do_nodes_of_shoe_move_with_point,
    node_motions_per_motion_of_shoe_point,
)
from drumlin.fem.analysis.mutual_work import (
    mutual_elastic_work_in_each_part_of_body,
    mutual_work_derivatives_by_node_motions,
)
from drumlin.fem.analysis.wide_moduli import (
    FunctionOfBodiesWithChangedModuli,
    LoadsAndAdjointLoads,
    function_that_condenses_shoes_with_other_moduli,
    torque_slopes_by_moduli_of_solid_shoe,
)
from drumlin.fem.equilibrium.group import ShoeGroup, divide_pressed_shoes_into_groups
from drumlin.fem.equilibrium.state import unloaded_lining_gaps_at_points
from drumlin.fem.model import DEFAULT_PENALTY_FACTOR, require_positive_penalty, solve_prepared_model
from drumlin.fem.preparation.bodies import (
    ShoeSubstructure,
    contact_coupling_matrices_of_shoe,
    unit_load_factors_under_all_loads,
)
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.solve import solve
from drumlin.fem.substructure.body import DEGREES_OF_FREEDOM_OF_BODY_FRAME
from drumlin.fem.substructure.elasticity import elastic_layers_of_shoe
from drumlin.fem.substructure.interface import ContactLine
from drumlin.fem.substructure.loads import ACTUATION_LOAD_NAME
from drumlin.laws import solve_brake_by_its_rigid_shoe_law as rigid_law
from drumlin.laws import solve_brake_by_sine_law
from drumlin.laws.naming import name_of_rigid_shoe_law
from drumlin.response.merit import torque_sensitivity_to_friction_by_differences as by_differences
from drumlin.response.resultants import planar_cross_product

FACTOR_FROM_PER_METRE_TO_PERCENT_PER_MM = 0.1
"""Factor that converts a relative change per metre (1/m) to percent per millimetre."""


@dataclass(frozen=True)
class ShoeSensitivity:
    """Derivatives of a shoe's own torque, and of the brake's torque T by the data of this shoe.

    "dT by x" stands for the derivative of T with respect to x. On a plane T is the braking force
    [N], all units are divided by a length, and `theta` is in m.

    Attributes
    ----------
    name : name of the shoe
    torque : the shoe's own torque [N m]
    friction : change of the shoe's own torque per friction coefficient of the brake [N m]; the
        friction of linings with a coefficient of their own changes in proportion
    S : (mu/torque) d torque/dmu of the shoe at a fixed actuation; None if the torque is 0
    force : dT per actuation force [m]; None if a strut or a cam gives the force
    moduli : dT by the logarithm of the modulus [N m] of each part, "lining", "backing" and "shoe";
        for an orthotropic part by the logarithm of one factor on all its moduli
    bending_stiffness : dT by the logarithm of the body's bending stiffness [N m], which then
        replaces the modulus of "shoe"; None if the brake file gives no bending stiffness
    clearance : dT per clearance that is uniform along the lining [N]
    held : dT by the data of each support: by the points "hinge", "pivot", "abutment.point" (2,) [N]
        along x and y of the brake; by the angles "abutment.direction", "guide.direction" and the
        coefficient "abutment.friction" (1,) [N m]
    penalty : dT by the logarithm of the contact stiffness [N m]
    theta : angles (n,) [rad] of the nodes of the shoe's lining, in increasing order
    density : derivative (n,) [N/m] of T by the clearance at each angle, per length of arc; 0 off
        the contact
    modulus_error : error [N m] of the derivatives by the moduli of a solid shoe; None in plane
        stress, where they are exact
    not_given : keys of supports whose derivatives are not computed, because nodes of the body move
        with the support
    """

    name: str
    torque: float
    friction: float
    S: float | None
    force: float | None
    moduli: dict[str, float]
    bending_stiffness: float | None
    clearance: float
    held: dict[str, Floats]
    penalty: float
    theta: Floats
    density: Floats
    modulus_error: float | None = None
    not_given: tuple[str, ...] = ()


class SpringSensitivity(NamedTuple):
    """The pull of a spring in the solved brake, and the torque's slopes by its preload and rate.

    On a plane the torque is the braking force [N], and the units are divided by a length.

    Attributes
    ----------
    pull : pull of the spring [N]
    preload : dT per preload [m]
    rate : dT per rate [m^2]
    """

    pull: float
    preload: float
    rate: float


@dataclass(frozen=True)
class TorqueSensitivities:
    """The sensitivities of a brake's torque T.

    Attributes
    ----------
    friction_coefficient : friction coefficient mu of the drum
    torque : T [N m]
    friction : dT/dmu [N m]; the friction of linings with a coefficient of their own changes in
        proportion
    S : (mu/T) dT/dmu of the whole brake; None if T is 0
    drive : dT by the logarithm of all actuation forces of the brake [N m]; None if each shoe has
        its own force
    ring : dT by the logarithm of the drum ring's modulus [N m]; None for a rigid drum, for a ring
        whose bending stiffness is given, and for a ring whose far edge is neither fixed nor free
    ring_bending_stiffness : dT by the logarithm of the drum ring's bending stiffness [N m]; None if
        the brake file gives no bending stiffness, and for a ring whose far edge is neither fixed
        nor free
    shoes : the sensitivities of each shoe
    law : S by the rigid-shoe law: for each shoe, and then for the whole brake; None if the law has
        no solution, or does not apply
    springs : the sensitivities by each spring
    brake : the brake
    """

    friction_coefficient: float
    torque: float
    friction: float
    S: float | None
    drive: float | None
    ring: float | None
    ring_bending_stiffness: float | None
    shoes: tuple[ShoeSensitivity, ...]
    law: tuple[float | None, ...] | None
    springs: tuple[SpringSensitivity, ...]
    brake: Brake

    def __repr__(self) -> str:
        """The title of the brake, and the sensitivities as lines of text."""
        return "\n".join([self.brake.title, *sensitivity_as_text_lines(self, self.brake)])

    def as_dict(self) -> dict[str, Any]:
        """Convert the sensitivities of the brake to plain data for JSON, in SI units."""
        shoes = list(map(_shoe_sensitivity_as_dict, self.shoes))
        law = None if self.law is None else list(self.law)
        data = vars(self) | {"shoes": shoes, "law": law}
        del data["springs"], data["brake"]
        if self.springs:
            data["springs"] = [spring._asdict() for spring in self.springs]
        return data


def _shoe_sensitivity_as_dict(shoe: ShoeSensitivity) -> dict[str, Any]:
    """Convert the sensitivities of a shoe to plain data for JSON.

    The derivative by the hinge is given twice: under "held", and under the key "hinge".
    """
    held = {key: value.tolist() for key, value in shoe.held.items()}
    return vars(shoe) | {
        "not_given": list(shoe.not_given),
        "theta": shoe.theta.tolist(),
        "density": shoe.density.tolist(),
        "held": held,
        "hinge": held.get("hinge"),
    }


class WantedSlopes(NamedTuple):
    """Which slopes of the torque are computed besides the slopes by friction, force and clearance.

    The slopes by moduli take nearly all of the time, since they need the displacements of all nodes
    inside the shoes.

    Attributes
    ----------
    moduli : whether the slopes by moduli and bending stiffnesses are computed
    supports : whether the slopes by the data of supports are computed
    """

    moduli: bool = True
    supports: bool = True


ALL_SLOPES = WantedSlopes()
"""The request for all slopes of the torque."""


def compute_torque_sensitivity(
    scene: PreparedModel,
    brake: Brake,
    *,
    penalty: float = DEFAULT_PENALTY_FACTOR,
    wanted: WantedSlopes = ALL_SLOPES,
) -> TorqueSensitivities:
    """Compute the sensitivities of a brake's torque to its data, on a prepared model.

    `wanted` are the slopes that are computed; other slopes are missing in the result. Raises
    NoAnswer and BadInput as `solve_prepared_model` does. Raises NoAnswer also for a brake without
    friction, because this brake has no torque.
    """
    require_positive_penalty(penalty)
    _refuse_brake_whose_torque_has_no_slopes(scene, brake)
    pulls = _pulls_of_springs_in_solved_brake(scene, brake, penalty)
    under = brake_with_loads_assigned_to_shoes(brake, pulls) if pulls else brake
    pressed: dict[int, ShoeSensitivity] = {}
    ring, drive = 0.0, 0.0
    by_preload, approaches = np.zeros(len(pulls)), np.zeros(len(pulls))
    changed = function_that_condenses_shoes_with_other_moduli(scene)
    for group in divide_pressed_shoes_into_groups(scene, under, penalty, springs_join=True):
        adjoint = solve_adjoint_for_torque_of_shoe_group(group)
        for k, i in enumerate(group.members):
            slopes = _TorqueSlopesOfShoe(adjoint, k, changed, wanted)
            pressed[i] = slopes.compute_all_torque_slopes_of_shoe()
        ring += adjoint.torque_slope_by_log_of_ring_modulus
        drive += adjoint.torque_slope_by_given_forces
        by_preload += adjoint.preload_slopes
        approaches += adjoint.approaches
    shoes = []
    for i, shoe in enumerate(brake.shoes):
        shoes.append(
            pressed[i]
            if i in pressed
            else _zero_sensitivity_of_unpressed_shoe(scene.bodies[i], shoe)
        )
    torque = math.fsum(shoe.torque for shoe in shoes)
    friction = math.fsum(shoe.friction for shoe in shoes)
    # The derivative by the ring's modulus assumes that the ring's flexibility is inversely
    # proportional to this modulus. An elastic support of the ring would add a flexibility that does
    # not depend on the modulus.
    scaled = brake.ring is not None and brake.ring.has_fixed_or_free_far_edge
    # A bending stiffness in the brake file takes the place of the ring's modulus.
    given = brake.ring is not None and brake.ring.bending_stiffness is not None
    return TorqueSensitivities(
        friction_coefficient=brake.friction,
        torque=torque,
        friction=friction,
        S=_slope_of_logarithms_or_none(brake.friction, friction, torque),
        drive=None if brake.actuation is None else drive,
        ring=ring if scaled and not given else None,
        ring_bending_stiffness=ring if scaled and given else None,
        shoes=tuple(shoes),
        law=friction_sensitivity_by_rigid_shoe_law(brake),
        springs=tuple(
            map(SpringSensitivity, pulls, by_preload.tolist(), (-by_preload * approaches).tolist())
        ),
        brake=brake,
    )


def _pulls_of_springs_in_solved_brake(
    scene: PreparedModel, brake: Brake, penalty: float
) -> list[float]:
    """The pull [N] of each spring in the solved brake; a spring without a rate has its preload."""
    if any(spring.rate for spring in brake.springs):
        return list(solve_prepared_model(scene, brake, penalty=penalty).spring_pulls)
    return [spring.preload for spring in brake.springs]


def _refuse_brake_whose_torque_has_no_slopes(scene: PreparedModel, brake: Brake) -> None:
    """Raise an error for a brake whose torque derivatives cannot be computed.

    The error is NoAnswer for a frictionless brake. It is BadInput for heated shoes, and for a model
    that was prepared without friction.
    """
    if brake.friction == 0:
        raise NoAnswer("sensitivity: without friction there is no torque")
    heated = reason_if_any_shoe_is_heated(brake, "the analysis of slopes")
    if heated is not None:
        raise BadInput(f"sensitivity: {heated}")
    if scene.brake.friction == 0:
        raise BadInput(
            f"friction = {brake.friction:g}: "
            "the scene was prepared without friction, for mu = 0 only"
        )


def _slope_of_logarithms_or_none(x: float, slope: float, value: float) -> float | None:
    """The slope d ln(value) / d ln(x) = x slope / value; None if the value is 0."""
    return x * slope / value if value else None


def _zero_sensitivity_of_unpressed_shoe(body: ShoeSubstructure, shoe: Shoe) -> ShoeSensitivity:
    """The sensitivities, all zero, of a shoe that does not press on the drum."""
    phi, _ = body.line.angles_and_pressures_averaged_over_width(np.zeros(len(body.line.nodes)))
    theta = shoe.frame.surface_coordinates_of_phi(phi)[:: shoe.frame.sense]
    moduli = dict.fromkeys(map(_material_name_of_part, elastic_layers_of_shoe(shoe)), 0.0)
    given = shoe.body is not None and shoe.body.bending_stiffness is not None
    return ShoeSensitivity(
        name=shoe.name,
        torque=0.0,
        friction=0.0,
        S=None,
        force=0.0,
        bending_stiffness=moduli.pop("shoe") if given else None,
        moduli=moduli,
        clearance=0.0,
        held={},
        penalty=0.0,
        theta=theta,
        density=np.zeros(len(theta)),
    )


def _material_name_of_part(part: str) -> str:
    """The name of the material of a part; the table of a T-section has the material "shoe"."""
    return "shoe" if part == "table" else part


class _DisplacementsUnderLoadsAndAdjointLoads(NamedTuple):
    """Displacements (2 nodes,) of all nodes of a shoe, without its rigid-body motion.

    u are the displacements [m] under the loads of the shoe, and v the displacements under the
    adjoint loads.
    """

    u: Floats
    v: Floats


class _TorqueSlopesByModuli(NamedTuple):
    """The slopes [N m] of the torque by the moduli of a shoe.

    Attributes
    ----------
    moduli : slope by the logarithm of the modulus of each part
    bending_stiffness : slope by the logarithm of the bending stiffness; None if the brake file
        gives no bending stiffness
    error : error of the slopes [N m]; None if the slopes are exact
    """

    moduli: dict[str, float]
    bending_stiffness: float | None
    error: float | None


class _TorqueSlopesOfShoe:
    """Computes the derivatives of the brake's torque by the data of one shoe.

    `adjoint` is the adjoint of the shoe's group, and `k` the index of the shoe in the group.
    `changed` is a function that returns condensed bodies of solid shoes with changed moduli, and
    `wanted` are the slopes that are computed.
    """

    def __init__(
        self,
        adjoint: TorqueDerivativesAndAdjointOfGroup,
        k: int,
        changed: FunctionOfBodiesWithChangedModuli,
        wanted: WantedSlopes = ALL_SLOPES,
    ) -> None:
        """Collect the shoe, its adjoint, and the signs of its rigid-body modes."""
        self.adjoint, self.k, self.changed, self.wanted = adjoint, k, changed, wanted
        self.is_solid = adjoint.group.prepared_model.model == "solid"
        self.group: ShoeGroup = adjoint.group
        self.own: ShoeAdjoint = adjoint.shoes[k]
        self.body, self.shoe = self.group.substructures_of_shoes[k], self.group.shoes[k]
        self.drag = self.group.brake.signed_friction_stress_over_pressure_in_shoe_frame(self.shoe)
        # The friction stress is `drag` times `dragging`. `dragging` equals the pressure, unless
        # friction depends on the pressure.
        self.dragging = self.group.friction_stress_over_friction_coefficient_of_shoe(
            k, self.own.pressures
        )
        # Under a cam the equation of the shoe's force contains the travel of the shoe's tip, the
        # point where the force acts. The tip of a shoe that a strut pushes moves springs on the
        # shoe that pushes the strut.
        under_cam = k in self.group.indices_of_shoes_under_cam
        self.tip_multiplier = self.own.force_multiplier if under_cam else 0.0
        self.spring_tip_multiplier = float(
            self._spring_multipliers
            @ self.group.approach_of_springs_by_load_point_travel(self.adjoint.springs)[:, k]
        )
        self.tip_multiplier += self.spring_tip_multiplier
        names = np.array(
            self.shoe.rigid_body_modes_of_support(
                self.group.abutment_friction_directions_of_shoes[k]
            ).names
        )
        # If the shoe's frame is mirrored, rotations have the opposite sign in the brake's frame.
        self.mode_signs = np.where(names == "turn", float(self.shoe.frame.sense), 1.0)
        # The actuation does no work on the tilt of a shoe on a lever.
        self.works = np.where(names == "tilt", 0.0, 1.0)

    def compute_all_torque_slopes_of_shoe(self) -> ShoeSensitivity:
        """Compute all sensitivities of the torque to data of the shoe."""
        group, k, own = self.group, self.k, self.own
        body, shoe = self.body, self.shoe
        coupling = body.coupling
        torque = float(self.adjoint.torques[k])
        friction = float(self.adjoint.torque_slopes_by_friction[k])
        by_penalty = (
            float(own.gap_multipliers @ (coupling.M @ own.pressures))
            / group.contact_stiffness_per_area_of_shoes[k]
        )
        moduli, bending_stiffness, modulus_error = self._torque_slopes_by_moduli(by_penalty)
        # The brake file does not give the force of a shoe under a cam or of a shoe pushed by a
        # strut.
        shares_force = k in [
            *group.indices_of_shoes_under_cam,
            *(to for _, to in group.indices_of_pushing_and_pushed_shoe_of_struts),
        ]
        sign_of_force = math.copysign(1.0, shoe.actuation.force)
        forward = slice(None, None, shoe.frame.sense)
        phi, multipliers = body.line.angles_and_pressures_averaged_over_width(own.gap_multipliers)
        held, keys = {}, []
        if self.wanted.supports and shoe.anchors:
            keys = ["anchor"] if shoe.abutment is None else ["anchor", "abutment"]
        elif self.wanted.supports:
            held = self._torque_slopes_by_supports()
            keys = list(self._rigid_mode_derivatives_by_support_data())
        return ShoeSensitivity(
            name=shoe.name,
            torque=torque,
            friction=friction,
            S=_slope_of_logarithms_or_none(group.brake.friction, friction, torque),
            force=None if shares_force else sign_of_force * own.force_multiplier,
            moduli=moduli,
            bending_stiffness=bending_stiffness,
            clearance=-float(own.gap_multipliers @ coupling.M.sum(axis=1)),
            held=held,
            penalty=by_penalty,
            theta=shoe.frame.surface_coordinates_of_phi(phi)[forward],
            density=-shoe.lining.width * multipliers[forward],
            modulus_error=modulus_error,
            not_given=tuple(key for key in keys if key not in held),
        )

    def _indices_of_shoes_pushed_by_struts(self) -> list[int]:
        """The indices, within the group, of the shoes that struts from this shoe push."""
        return [
            to
            for source, to in self.group.indices_of_pushing_and_pushed_shoe_of_struts
            if source == self.k
        ]

    # The following methods compute slopes of the torque by moduli.

    @cached_property
    def displacements_due_to_loads_and_adjoint_loads(
        self,
    ) -> _DisplacementsUnderLoadsAndAdjointLoads:
        """The displacements of the shoe's nodes under its loads, and under the adjoint loads."""
        own = self.own
        N, T = self.body.coupling.N, self.body.coupling.T
        nodal = np.column_stack(
            [self.drag * (T.T @ self.dragging) - N.T @ own.pressures, N.T @ own.gap_multipliers]
        )
        loads = np.column_stack([self._load_column_factors_of_shoe(), self._adjoint_load()])
        u, v = self.body.condensed.nodal_displacements_in_load_cases(
            nodal, np.zeros((DEGREES_OF_FREEDOM_OF_BODY_FRAME, 2)), loads
        ).T
        return _DisplacementsUnderLoadsAndAdjointLoads(u, v)

    def _torque_slopes_by_moduli(self, by_penalty: float) -> _TorqueSlopesByModuli:
        """The slopes of the torque by the moduli of each part, and by the bending stiffness.

        The lining's modulus E also changes the contact stiffness alpha E/t. The slope `by_penalty`
        [N m] by the contact stiffness is therefore a part of the slope by the lining's modulus.
        """
        if not self.wanted.moduli:
            return _TorqueSlopesByModuli({}, None, None)
        if self.is_solid:
            return self._torque_slopes_by_solid_shoe_moduli_and_error(by_penalty)
        u, v = self.displacements_due_to_loads_and_adjoint_loads
        effects: dict[str, float] = {}
        layers = elastic_layers_of_shoe(self.shoe)
        for part, work in mutual_elastic_work_in_each_part_of_body(
            self.body.basis, layers, u, v
        ).items():
            name = _material_name_of_part(part)
            more = by_penalty if part == "lining" else 0.0
            effects[name] = effects.get(name, 0.0) - work + more
        bar = self.shoe.body
        given = bar is not None and bar.bending_stiffness is not None
        bending_stiffness = effects.pop("shoe") if given else None
        return _TorqueSlopesByModuli(effects, bending_stiffness, None)

    def _torque_slopes_by_solid_shoe_moduli_and_error(
        self, by_penalty: float
    ) -> _TorqueSlopesByModuli:
        """The slopes of the torque by the moduli of a solid shoe, with their error.

        `by_penalty` is the derivative [N m] of the torque by the logarithm of the contact
        stiffness, which is proportional to the lining's modulus.
        """
        own = self.own
        loads = LoadsAndAdjointLoads(
            own.pressures,
            self.drag,
            self._load_column_factors_of_shoe(),
            own.gap_multipliers,
            self._adjoint_load(),
        )
        found = torque_slopes_by_moduli_of_solid_shoe(
            self.body, self.changed(self.group.members[self.k]), loads
        )
        slopes = found.slopes | {"lining": found.slopes["lining"] + by_penalty}
        return _TorqueSlopesByModuli(slopes, None, found.error)

    @cached_property
    def _spring_multipliers(self) -> Floats:
        """For each spring the slope of the torque by its preload, times its rate (springs,) [N].

        The product is the adjoint multiplier of the approach of the spring's points.
        """
        rates = [spring.rate for spring in self.group.brake.springs]
        return self.adjoint.preload_slopes * np.array(rates)

    def _adjoint_load_of_springs(self) -> Floats:
        """The factors (l,) of the shoe's load columns under the adjoint load of springs.

        The adjoint load of one-sided supports is included.
        """
        load = self.own.adjoint_load_of_supports.copy()
        for multiplier, factors in zip(
            self._spring_multipliers, self.adjoint.springs.load_column_factors, strict=True
        ):
            load -= multiplier * factors[self.k]
        return load

    def _adjoint_load(self) -> Floats:
        """The factors (l,) of the shoe's load columns under all adjoint loads."""
        load = self.group.actuation_of_each_shoe_by_one_newton[self.k].load_column_factors
        return np.asarray(self._adjoint_load_of_springs() - self.tip_multiplier * load)

    def _load_column_factors_of_shoe(self) -> Floats:
        """The factors (l,) by which the load columns make up all loads on the shoe."""
        factors = unit_load_factors_under_all_loads(self.body, self.shoe, self.own.force)
        return np.asarray(factors + self.own.load_of_supports)

    # The following methods compute slopes of the torque by data of supports.

    def _torque_slopes_by_supports(self) -> dict[str, Floats]:
        """The slopes of the brake's torque by the supports of the shoe.

        Keys and units are the same as in `ShoeSensitivity.held`. A motion of a support changes the
        rigid-body modes of the shoe. If nodes of the body move with the support, the stiffness of
        the body changes as well; for solid shoes the result has no slopes by such supports.
        """
        group, k = self.group, self.k
        effects = {}
        for key, changes in self._rigid_mode_derivatives_by_support_data().items():
            if not self._can_torque_slope_by_point_be_computed(key):
                continue
            effects[key] = np.array(
                list(map(self._torque_slope_by_rigid_body_mode_change, changes))
            )
            moves = node_motions_per_motion_of_shoe_point(
                group.prepared_model, group.members[k], self.shoe, key
            )
            if moves:
                effects[key] = effects[key] + self._torque_slopes_by_node_motions(moves)
        for to in self._indices_of_shoes_pushed_by_struts():
            pushed = _TorqueSlopesOfShoe(self.adjoint, to, self.changed)
            if pushed._can_torque_slope_by_point_be_computed("actuation.point"):
                _add_torque_slopes_by_strut_line_of_action(effects, self, pushed)
            else:
                effects.pop("abutment.point", None)
                effects.pop("abutment.direction", None)
        return effects

    def _rigid_mode_derivatives_by_support_data(self) -> Mapping[str, Any]:
        """The derivatives of the shoe's rigid-body modes by data of its supports, by their keys."""
        return self.shoe.derivatives_of_rigid_body_modes_by_support_data(
            self.group.abutment_friction_directions_of_shoes[self.k]
        )

    def _can_torque_slope_by_point_be_computed(self, key: str) -> bool:
        """Whether the derivative of the torque by the point `key` of the shoe can be computed.

        If nodes of the body move with the point, it cannot be computed in two cases: the shoe is
        solid, or springs, weight or forces besides the actuation act on a shoe whose frame turns
        with the point. A pivot does not turn the frame.
        """
        loads_move = self.shoe.has_loads_besides_actuation and key != "pivot"
        return not (
            (self.is_solid or loads_move)
            and do_nodes_of_shoe_move_with_point(self.group.prepared_model, self.shoe, key)
        )

    def _torque_slope_by_rigid_body_mode_change(
        self, change: RigidBodyModeDerivativesByDatum
    ) -> float:
        """The slope of the torque by a change of the shoe's rigid-body modes.

        The equations contain a rigid-body mode only in the work of forces on this mode. This work
        depends only on the resultant force and moment.
        """
        own, shoe, works = self.own, self.shoe, self.works
        N, T = self.body.coupling.N, self.body.coupling.T
        xy = shoe.convert_points_to_brake_frame(self.body.line.xy)
        on_gaps = own.gap_multipliers @ N
        by_drum = self.drag * (self.dragging @ T) - own.pressures @ N
        # `of_gaps` is the resultant of the adjoint contact forces, `of_drum` of the forces of the
        # drum, and `push` of the actuation force.
        of_gaps = resultant_force_and_moment(
            shoe.frame.convert_vectors_from_shoe_to_brake_frame(on_gaps.reshape(-1, 2)), xy.T
        )
        of_drum = resultant_force_and_moment(
            shoe.frame.convert_vectors_from_shoe_to_brake_frame(by_drum.reshape(-1, 2)), xy.T
        )
        sign = math.copysign(1.0, shoe.actuation.force)
        push = resultant_force_and_moment(
            sign * shoe.actuation.unit_vector_of_force, shoe.actuation.point.xy
        )
        y, b = self.mode_signs * own.coordinates, self.mode_signs * own.equilibrium_multipliers
        by_equilibria = change.test_modes @ of_drum + own.force * works * (change.test_modes @ push)
        if shoe.has_loads_besides_actuation:
            by_equilibria = (
                by_equilibria + change.test_modes @ shoe.resultant_of_loads_besides_actuation
            )
        by_tip = self.tip_multiplier * (y * works) @ (change.motions @ push)
        # The points of springs move with the rigid-body modes, too.
        of_springs = self._spring_multipliers @ self.adjoint.springs.resultants[:, self.k]
        by_springs = y @ (change.motions @ of_springs)
        return float(y @ (change.motions @ of_gaps) - b @ by_equilibria - by_tip - by_springs)

    def _torque_slopes_by_node_motions(self, moves: list[NodeMotionPerPointMotion]) -> Floats:
        """The slopes (moves,) of the torque by motions of the body's nodes.

        Motions of nodes change the stiffness and the nodal forces of the actuation. They also
        change the contact if contact nodes move.
        """
        own, body = self.own, self.body
        u, v = self.displacements_due_to_loads_and_adjoint_loads
        nodes = np.array([move.node_motion for move in moves])
        axes = [move.beam_axis_turn_per_metre for move in moves]
        effects = -mutual_work_derivatives_by_node_motions(
            body.basis, elastic_layers_of_shoe(self.shoe), u, v, nodes, axes
        )
        # The product of this vector (2 nodes,) with a change of the nodal forces of one newton of
        # actuation is the change of the torque.
        nodal_factors = own.force * v - self.tip_multiplier * u
        for j, move in enumerate(moves):
            effects[j] += float(move.load_change @ nodal_factors)
            effects[j] += self._torque_slope_by_further_load_changes(move.further_load_changes)
            if not move.do_contact_nodes_stay_unmoved:
                effects[j] += self._torque_slope_by_contact_node_motion(move)
        return effects

    def _torque_slope_by_further_load_changes(self, changes: Mapping[str, Floats]) -> float:
        """The slope of the torque by changes of the nodal forces of unit loads, by their names.

        The nodal forces of a spring act as loads, and give the motion of the spring's point.
        """
        u, v = self.displacements_due_to_loads_and_adjoint_loads
        acting, adjoint = self._load_column_factors_of_shoe(), self._adjoint_load_of_springs()
        columns, slope = self.body.load_matrix_columns_by_load_name, 0.0
        for name, change in changes.items():
            own = columns.column_slice_of_each_load[name]
            slope += float(v @ change @ acting[own] + u @ change @ adjoint[own])
        return slope

    def _torque_slope_by_contact_node_motion(self, move: NodeMotionPerPointMotion) -> float:
        """The slope of the torque by a motion of contact nodes, by central differences.

        Only the initial gap and the matrices that couple pressures with displacements change. The
        pressures, displacements, rigid-body motions and their adjoints stay.
        """
        values = []
        for step, line in contact_lines_with_moved_nodes(
            self.body, self.shoe, self.group.brake.size, move
        ):
            value = self._adjoint_work_of_contact_equations(line, step, move)
            values.append((value - self._adjoint_work_of_gaps_due_to_ring(line)) / step)
        return 0.5 * sum(values)

    def _adjoint_work_of_contact_equations(
        self, line: ContactLine, step: float, move: NodeMotionPerPointMotion
    ) -> float:
        """The contact terms of the torque [N m], with contact nodes that have moved by a step.

        The terms are the equations of gaps and equilibrium, multiplied by their adjoints, and the
        torque of the friction. Their difference between two steps gives the slope by the motion.

        Parameters
        ----------
        line : contact line with moved nodes
        step : distance [m] by which the point has moved
        move : motion of the nodes per motion of the point
        """
        own, shoe, k = self.own, self.shoe, self.k
        group, brake = self.group, self.group.brake
        modes, nodes = group.rigid_body_modes_of_shoes[k], self.body.line.nodes
        contact = np.column_stack([2 * nodes, 2 * nodes + 1]).ravel()
        # With the penalty method the lining penetrates the drum. The depth is the pressure divided
        # by the contact stiffness.
        squeezed = own.pressures / group.contact_stiffness_per_area_of_shoes[k]
        turns = modes.pin_motion[2]
        elastic = self.displacements_due_to_loads_and_adjoint_loads
        u = elastic.u[contact] + modes.contact_modes @ own.coordinates
        v = elastic.v[contact] - modes.test_modes @ own.equilibrium_multipliers
        coupling = contact_coupling_matrices_of_shoe(line, shoe)
        nodal = self.drag * (coupling.T.T @ self.dragging) - coupling.N.T @ own.pressures
        # A rotation of the shoe also rotates the vector by which a node was moved, which displaces
        # the node.
        aside = (
            step * np.array([-move.contact_node_motion[1], move.contact_node_motion[0]]).T.ravel()
        )
        gap = unloaded_lining_gaps_at_points(line.xy, line.phi, brake, shoe)
        value = brake.friction_coefficient_of_shoe_at_zero_pressure(shoe) * float(
            coupling.lever @ self.dragging
        )
        closing = coupling.N @ (u + aside * (turns @ own.coordinates))
        value += float(own.gap_multipliers @ (closing - coupling.M @ (gap + squeezed)))
        value += float(nodal @ (v - aside * (turns @ own.equilibrium_multipliers)))
        # A strut pushes the next shoe with the component of these nodal forces along the strut.
        whole = shoe.frame.convert_vectors_from_shoe_to_brake_frame(
            nodal.reshape(-1, 2).sum(axis=0)
        )
        for to in self._indices_of_shoes_pushed_by_struts():
            value -= self.adjoint.shoes[to].force_multiplier * float(
                whole @ shoe.unit_vector_of_smooth_abutment_force
            )
        return value

    def _adjoint_work_of_gaps_due_to_ring(self, line: ContactLine) -> float:
        """The adjoint work [N m] of the ring's motion at a contact line with moved nodes.

        The motion of the ring opens gaps. The adjoint work is the sum of these weighted gaps times
        their adjoint multipliers. It is 0 for a rigid drum.
        """
        group, scene = self.group, self.group.prepared_model
        if scene.ring is None or scene.ring_under_contact_lines is None:
            return 0.0
        lines = [body.line for body in scene.bodies]
        lines[group.members[self.k]] = line
        ring = scene.ring_under_contact_lines(tuple(lines))
        pressed = np.hstack([ring.normal_half_flexibilities[i] for i in group.members])
        dragged = np.hstack([ring.friction_half_flexibilities[i] for i in group.members])
        a = np.concatenate([shoe.gap_multipliers for shoe in self.adjoint.shoes])
        p = np.concatenate([shoe.pressures for shoe in self.adjoint.shoes])
        return float(
            (pressed @ a)
            @ (pressed @ p + dragged @ (group.friction_stress_over_pressure_at_nodes * p))
        )

    # The following methods compute slopes of the torque by the line of action of a strut's force.

    def torque_slope_by_actuation_line_of_action(
        self, force: Floats, moment: float, *, carried: bool = False
    ) -> float:
        """The slope of the torque by a change of the line along which the actuation force acts.

        Parameters
        ----------
        force : change of the unit force (2,) [1]
        moment : change of the unit force's moment about the origin [m]
        carried : whether the loaded end of the body moves with the force; the force then causes no
            additional couple on the body
        """
        own, shoe, body = self.own, self.shoe, self.body
        centre = shoe.convert_points_to_brake_frame(
            body.application_point_of_actuation_loads[:, None]
        )[:, 0]
        free = shoe.rigid_body_modes_of_support(
            self.group.abutment_friction_directions_of_shoes[self.k]
        )
        couple = (
            0.0
            if carried
            else shoe.frame.sense * (moment - float(planar_cross_product(centre, force)))
        )
        pushing = np.array([*shoe.frame.convert_vectors_to_shoe_frame(force), couple])
        load = body.load_matrix_columns_by_load_name.column_factors_of_all_loads(
            {ACTUATION_LOAD_NAME: pushing}
        )
        change = np.array([*force, moment])
        tested = self.mode_signs * self.works * (free.test_modes @ change)
        by_force = own.force * float(
            own.gap_multipliers @ (body.flexibility.gap_closure_by_load @ load)
            - own.equilibrium_multipliers @ tested
            + self._adjoint_load() @ (body.flexibility.load_point_motion_by_load @ load)
        )
        # The travel of the tip is measured along the changed line.
        elastic = body.flexibility.motion_of_load_points(
            own.pressures, self.drag * self.dragging, self._load_column_factors_of_shoe()
        )
        moved = self.mode_signs * self.works * (free.motions @ change)
        by_travel = float(load @ elastic + own.coordinates @ moved)
        along = change @ self.group.rigid_motion_along_friction_surface
        by_motion = self._motion_along_surface_with_strut * float(along)
        return by_force - self.tip_multiplier * by_travel - self.spring_tip_multiplier * by_motion

    @cached_property
    def _motion_along_surface_with_strut(self) -> float:
        """The motion of the shoe along the drum [rad] or the plane [m] as it follows its strut."""
        motions = motions_along_surface_with_struts_in_solution(self.group, self.adjoint.shoes)
        return float(motions[self.k])

    def torque_slope_by_foot_lever(self, force: Floats, moment: float) -> float:
        """The slope of the torque by a change of the lever with which a strut moves the shoe.

        The motion of the shoe along the drum or the plane is the travel of its foot divided by this
        lever. `force` (2,) and `moment` are the changes of the abutment's unit force, and of the
        moment of this unit force about the origin [m].
        """
        group = self.group
        effects = group.contact_effects_of_each_actuation_force(0.0)[self.k]
        along = group.rigid_motion_along_friction_surface @ np.array([*force, moment])
        multiplier = effects.load_point_travel_by_surface_motion * self.spring_tip_multiplier
        multiplier += float(
            self._spring_multipliers
            @ group.approach_of_springs_by_surface_motion(self.adjoint.springs)[:, self.k]
        )
        # The motion per travel of the foot is -1 over the lever.
        relative = -effects.surface_motion_by_foot_travel * float(along)
        return multiplier * self._motion_along_surface_with_strut * relative

    def torque_slopes_by_strut_force_point(self) -> list[Floats]:
        """The slopes (2,) [N] of the torque by the point at which a strut pushes the shoe.

        The list has one or two parts, whose sum is the slope: first the part by the moment of the
        force, and then the part by motions of the body's nodes if nodes move with the point.
        """
        key, direction = "actuation.point", self.shoe.actuation.unit_vector_of_force
        moves = node_motions_per_motion_of_shoe_point(
            self.group.prepared_model, self.group.members[self.k], self.shoe, key
        )
        effects = []
        for step in np.eye(2):
            moment = float(planar_cross_product(step, direction))
            effects.append(
                self.torque_slope_by_actuation_line_of_action(
                    np.zeros(2), moment, carried=bool(moves)
                )
            )
        by_moment = np.array(effects)
        return [by_moment, self._torque_slopes_by_node_motions(moves)] if moves else [by_moment]

    def torque_slope_by_strut_force_direction(self) -> float:
        """The slope [N m] of the torque by the direction in which a strut pushes the shoe."""
        shoe = self.shoe
        direction, point = shoe.actuation.unit_vector_of_force, shoe.actuation.point.xy
        turned = np.array([-direction[1], direction[0]])
        slope = self.torque_slope_by_actuation_line_of_action(
            turned, float(planar_cross_product(point, turned))
        )
        # If the foot of this shoe pushes another strut, the force of that strut on the next shoe
        # changes too.
        for to in self._indices_of_shoes_pushed_by_struts():
            slope -= (
                self.adjoint.shoes[to].force_multiplier
                * self.own.force
                * float(shoe.unit_vector_of_smooth_abutment_force @ turned)
            )
        return slope


def _add_torque_slopes_by_strut_line_of_action(
    effects: dict[str, Floats], pushing: _TorqueSlopesOfShoe, pushed: _TorqueSlopesOfShoe
) -> None:
    """Add the slopes by a strut's line of action to the slopes by the abutment that it forms.

    The strut is the abutment of one shoe and pushes another shoe along a line that moves and turns
    with this abutment. The size of the strut's force does not change with the direction of the
    abutment: without friction no force acts across the strut.

    Parameters
    ----------
    effects : slopes by the supports of the shoe whose foot stands on the strut; they are changed in
        place
    pushing : slopes of the shoe whose foot stands on the strut
    pushed : slopes of the shoe that the strut pushes
    """
    unit_force = pushing.shoe.unit_vector_of_smooth_abutment_force
    by_point = [
        pushing.torque_slope_by_foot_lever(
            np.zeros(2), float(planar_cross_product(step, unit_force))
        )
        for step in np.eye(2)
    ]
    effects["abutment.point"] = effects["abutment.point"] + np.array(by_point)
    turned = np.array([-unit_force[1], unit_force[0]])
    if pushing.shoe.abutment is not None:
        moment = float(planar_cross_product(pushing.shoe.abutment.point.xy, turned))
        by_turn = pushing.torque_slope_by_foot_lever(turned, moment)
        effects["abutment.direction"] = effects["abutment.direction"] + by_turn
    for part in pushed.torque_slopes_by_strut_force_point():
        effects["abutment.point"] = effects["abutment.point"] + part
    by_direction = pushed.torque_slope_by_strut_force_direction()
    effects["abutment.direction"] = effects["abutment.direction"] + by_direction


# The following functions write the sensitivities as text for people.


def sensitivity_as_text_lines(found: TorqueSensitivities, brake: Brake) -> list[str]:
    """The sensitivities of a brake as lines of text.

    Most slopes are relative: d ln T / d ln x of the whole torque T by a quantity x. `found` holds
    the sensitivities of the brake.
    """
    surface = brake.surface
    symbol, effect, unit = (
        surface.symbol_of_torque_or_brake_force,
        surface.word_for_torque_or_brake_force,
        surface.unit_of_torque_or_brake_force,
    )
    law = found.law or (None,) * (len(found.shoes) + 1)
    of_law = f"{name_of_rigid_shoe_law(brake)} law"
    T, elasticity = found.torque or math.inf, f"d ln {symbol}/d ln"
    own_friction = brake.first_key_that_gives_lining_its_own_friction()
    over_pressure = first_key_of_pressure_dependent_friction(brake)
    scaled = own_friction or over_pressure
    lines = [
        f"{effect} {found.torque:.6g} {unit}, d{symbol}/dmu {found.friction:.6g} {unit}, "
        f"S = (mu/{symbol}) d{symbol}/dmu = {_friction_sensitivity_as_text(found.S)} "
        f"({of_law}: {_friction_sensitivity_as_text(law[-1])})"
        f"{'' if scaled is None else f', all frictions in proportion, {scaled} too'}"
    ]
    of_brake = {
        "actuation": found.drive,
        "E of the drum ring": found.ring,
        "bending_stiffness of the drum ring": found.ring_bending_stiffness,
    }
    for what, slope in of_brake.items():
        if slope is not None:
            lines.append(f"  {elasticity} {what} {slope / T:+.4g}")
    for k, own in enumerate(found.shoes):
        by_law = "" if law[k] is None else f" ({of_law}: {_friction_sensitivity_as_text(law[k])})"
        lines.append(
            f"  shoe {own.name!r}: {effect} {own.torque:.6g} {unit}, "
            f"d{symbol}/dmu {own.friction:.6g} {unit}, "
            f"S {_friction_sensitivity_as_text(own.S)}{by_law}; of the whole {effect}:"
        )
        lines += _torque_slopes_of_shoe_as_text_lines(own, brake.shoes[k], T, elasticity)
    for i, (spring, own_slopes) in enumerate(zip(brake.springs, found.springs, strict=True)):
        by_preload, by_rate = own_slopes.preload * spring.preload, own_slopes.rate * spring.rate
        lines.append(
            f"  spring[{i}]: pull {own_slopes.pull:.6g} N; {elasticity} preload "
            f"{by_preload / T:+.4g}, rate {by_rate / T:+.4g}"
        )
    parts = ", ".join(names_of_orthotropic_parts(brake))
    if parts:
        lines.append(
            f"  {elasticity} E of {parts}: by one factor on all moduli; not given by each of them"
        )
    return lines


def _friction_sensitivity_as_text(S: float | None) -> str:
    """The sensitivity S as text, "none" if S is None."""
    return "none" if S is None else f"{S:.5g}"


def _torque_slopes_of_shoe_as_text_lines(
    own: ShoeSensitivity, shoe: Shoe, T: float, elasticity: str
) -> list[str]:
    """Lines of text with the relative slopes of the whole torque by data of one shoe.

    Parameters
    ----------
    own : the sensitivities of the shoe
    shoe : the shoe
    T : the whole torque [N m]
    elasticity : the words "d ln T/d ln"
    """
    force = shoe.actuation.force
    by_force = (
        ""
        if own.force is None or force == 0
        else f"{elasticity} force {own.force * force / T:+.4g}; "
    )
    moduli = ", ".join(f"{name} {value / T:+.4g}" for name, value in own.moduli.items())
    bent = ""
    if own.bending_stiffness is not None:
        bent = f"; {elasticity} bending_stiffness: shoe {own.bending_stiffness / T:+.4g}"
    held = "; ".join(
        _torque_slopes_by_support_as_text(key, value / T) for key, value in own.held.items()
    )
    # Adding 0.0 turns -0.0 into 0.0, which prints without a sign of minus.
    per_micrometre = own.clearance / T * 1e-3 * FACTOR_FROM_PER_METRE_TO_PERCENT_PER_MM + 0.0
    lines = [
        f"    {by_force}{elasticity} E: {moduli}{bent}; "
        f"{elasticity} penalty {own.penalty / T:+.1e}",
        f"    clearance {per_micrometre:+.4g} %/µm" + (f"; {held}" if held else ""),
    ]
    if own.modulus_error is not None:
        lines.append(
            "    E by central differences, with an error of "
            f"{error_text_in_percent(own.modulus_error / T)}"
        )
    # Beside loads that move, plane stress gives the slope by a pivot alone.
    loaded = [
        key
        for key in own.not_given
        if shoe.has_loads_besides_actuation and key != "pivot" and not shoe.anchors
    ]
    one_sided = [key for key in own.not_given if shoe.anchors]
    for keys, reason in (
        (one_sided, "the shoe can leave them"),
        (loaded, "the body and the places of its springs, weight or forces move with it"),
        (
            [key for key in own.not_given if key not in loaded + one_sided],
            "the body moves with it; --model fem gives it",
        ),
    ):
        if keys:
            lines.append(f"    {' and '.join(keys)}: not given, for {reason}")
    return lines


def _torque_slopes_by_support_as_text(key: str, value: Floats) -> str:
    """The text with the relative slopes of the torque by one support.

    `key` is a key of `ShoeSensitivity.held`, and `value` (1,) or (2,) its slopes divided by the
    torque.
    """
    if len(value) == 2:
        x, y = value * FACTOR_FROM_PER_METRE_TO_PERCENT_PER_MM
        return f"{key} along x {x:+.4g} %/mm, along y {y:+.4g} %/mm"
    if key.endswith("friction"):
        return f"{key} {value[0]:+.4g} % per 0.01"
    return f"{key} {100 * math.radians(value[0]):+.4g} %/deg"


# The following functions compute slopes by rigid-shoe laws and by differences of solves.


def friction_sensitivity_by_rigid_shoe_law(brake: Brake) -> tuple[float | None, ...] | None:
    """The sensitivity S by the rigid-shoe law, for each shoe and then for the whole brake.

    S = (mu/T) dT/dmu is the relative change of the torque T per relative change of friction. By the
    sine law S is exact, since the shape of its pressure is constant (UWA notes, eq. 8). By other
    laws S is None for each shoe, and S of the whole brake comes from differences of the law's
    torque. The result is None if no law has a solution, for a brake with orthotropic parts, and for
    friction that depends on the pressure.
    """
    if any(names_of_orthotropic_parts(brake)) or first_key_of_pressure_dependent_friction(brake):
        return None
    try:
        if name_of_rigid_shoe_law(brake) != "sine":
            return (*[None] * len(brake.shoes), by_differences(brake, rigid_law))
        response = solve_brake_by_sine_law(brake)
    except (BadInput, NoAnswer):
        return None
    each = [merit.sensitivity_at_fixed_shape for merit in response.merits]
    pairs = zip(each, response.shoes, strict=True)
    total = math.fsum((S or 0.0) * shoe.torque for S, shoe in pairs)
    return (*each, total / response.torque if response.torque else None)


class _TorqueSlopeAndDifferenceStep(NamedTuple):
    """A slope of the torque, and the step of the central difference that checks the slope.

    Attributes
    ----------
    name : name of the slope, as "dT/dF"
    unit : unit of the slope
    exact_slope : exact value of the slope
    changes : function of the step that returns the changed keys of the brake file with their values
    step : step of the central difference; relative to the value for force and moduli, in the SI
        unit of the key for all other data
    force_that_divides_logarithmic_slope : actuation force [N] by which a slope by the logarithm of
        the force is divided to give the slope by the force; 1 for all other slopes
    """

    name: str
    unit: str
    exact_slope: float
    changes: Callable[[float], Mapping[str, Any]]
    step: float
    force_that_divides_logarithmic_slope: float = 1.0


def compare_torque_slopes_with_solve_differences(
    brake: Brake, index: int, *, elements: int, penalty: float = DEFAULT_PENALTY_FACTOR
) -> tuple[TorqueSensitivities, list[dict[str, Any]]]:
    """Compare exact slopes of the whole torque with central differences of complete solves.

    Raises NoAnswer and BadInput as `solve` does.

    Parameters
    ----------
    brake : the brake
    index : index of the shoe whose force, moduli, clearance and hinge are changed; its body is
        elastic, and its clearance one number
    elements : finite elements along each lining
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)

    Returns
    -------
    the sensitivities, and for each slope a dictionary with the keys `what`, `unit`, `exact`, `near`
    (by differences of solves) and `difference` (relative)
    """
    slopes = compute_torque_sensitivity(
        make_prepared_model(brake, elements=elements), brake, penalty=penalty
    )
    rows = []
    for probe in _torque_slopes_to_compare_with_differences(brake, index, slopes):
        torques = []
        for step in (probe.step, -probe.step):
            changed = vary(brake, dict(probe.changes(step)))
            torques.append(solve(changed, elements=elements, penalty=penalty).torque)
        up, down = torques
        near = (up - down) / (2 * probe.step * probe.force_that_divides_logarithmic_slope)
        row = {"what": probe.name, "unit": probe.unit, "exact": probe.exact_slope, "near": near}
        rows.append(row | {"difference": abs(probe.exact_slope / near - 1)})
    return slopes, rows


def _torque_slopes_to_compare_with_differences(
    brake: Brake, index: int, slopes: TorqueSensitivities
) -> list[_TorqueSlopeAndDifferenceStep]:
    """The slopes that are compared with differences: by friction, and by data of shoe `index`.

    The data are the actuation force, the moduli of lining and body, the clearance and the hinge.
    """
    shoe, own, key = brake.shoes[index], slopes.shoes[index], f"shoe[{index}]."
    gap, body = shoe.lining.linings[0].clearance, shoe.body
    assert isinstance(gap, float) and body is not None and body.material is not None
    linings, bodies = shoe.lining.material.moduli, body.material.moduli
    force, x, y = shoe.actuation.force, shoe.pin.x, shoe.pin.y
    by_x, by_y = own.held["hinge"].tolist()
    larger_force = partial(
        _brake_file_values_increased_by_fraction, {key + "actuation.force": force}
    )
    larger_lining_moduli = partial(
        _brake_file_values_increased_by_fraction,
        {f"{key}lining.material.{name}": E for name, E in linings.items()},
    )
    larger_body_moduli = partial(
        _brake_file_values_increased_by_fraction,
        {f"{key}body.material.{name}": E for name, E in bodies.items()},
    )
    more_friction = partial(_brake_file_value_increased_by_step, "friction", brake.friction)
    more_clearance = partial(_brake_file_value_increased_by_step, key + "lining.clearance", gap)
    hinge_at_larger_x = partial(_brake_file_value_increased_by_step, key + "hinge.x", x)
    hinge_at_larger_y = partial(_brake_file_value_increased_by_step, key + "hinge.y", y)
    return [
        _TorqueSlopeAndDifferenceStep("dT/dμ", "N m", slopes.friction, more_friction, 1e-5),
        _TorqueSlopeAndDifferenceStep("dT/dF", "m", own.force or 0.0, larger_force, 1e-4, force),
        _TorqueSlopeAndDifferenceStep(
            "dT/d ln E, lining", "N m", own.moduli["lining"], larger_lining_moduli, 1e-4
        ),
        _TorqueSlopeAndDifferenceStep(
            "dT/d ln E, shoe", "N m", own.moduli["shoe"], larger_body_moduli, 1e-4
        ),
        _TorqueSlopeAndDifferenceStep("dT/d clearance", "N", own.clearance, more_clearance, 1e-9),
        _TorqueSlopeAndDifferenceStep("dT/dx, hinge", "N", by_x, hinge_at_larger_x, 1e-6),
        _TorqueSlopeAndDifferenceStep("dT/dy, hinge", "N", by_y, hinge_at_larger_y, 1e-6),
    ]


def _brake_file_values_increased_by_fraction(
    values: Mapping[str, float], step: float
) -> dict[str, float]:
    """The keys of the brake file with their values multiplied by 1 + `step`."""
    return {key: value * (1 + step) for key, value in values.items()}


def _brake_file_value_increased_by_step(key: str, value: float, step: float) -> dict[str, float]:
    """The key of the brake file with its value increased by `step`, in the SI unit of the key."""
    return {key: value + step}
