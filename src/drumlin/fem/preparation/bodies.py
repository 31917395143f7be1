"""Condensed bodies of shoes, coupled with the drum or the plane along their contact lines."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any, NamedTuple, Protocol

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Shoe
from drumlin.brake.components import Actuation, BeamBody
from drumlin.brake.further_loads import ForceAtPoint
from drumlin.brake.heat import HeatedLayer, heated_layers_of_shoe
from drumlin.fem.mesh.beam import relative_depth_in_block_of_beam_shoe
from drumlin.fem.mesh.from_file import ShoeMeshReadFromFile
from drumlin.fem.preparation.load_places import (
    has_unit_loads_of_forces_at_points_or_mass,
    unit_load_factors_of_forces_at_points_and_mass,
    unit_loads_at_points_and_mass,
)
from drumlin.fem.substructure.body import (
    DEGREES_OF_FREEDOM_OF_BODY_FRAME,
    CondensedBody,
    MeshedBody,
)
from drumlin.fem.substructure.elasticity import elastic_layers_of_shoe
from drumlin.fem.substructure.expansion import (
    FreeStrainFunctionByLayer,
    nodal_forces_of_thermal_expansion,
)
from drumlin.fem.substructure.flexibility import ContactFlexibility
from drumlin.fem.substructure.interface import (
    ContactCouplingMatrices,
    ContactLine,
    function_that_returns_drum_normals_and_tangents,
    plane_normals_and_tangents,
)
from drumlin.fem.substructure.loads import (
    ACTUATION_LOAD_NAME,
    CHANGED_SHAPE_LOAD_NAME,
    FURTHER_FORCE_LOAD_NAME,
    HEAT_LOAD_NAME,
    ColumnsOfUnitLoads,
)


class BodyWithActuationLoads(Protocol):
    """The type of a body on which unit loads of an actuation act: force x, force y and couple.

    The forces act at a centre (2,) [m] in the shoe's frame, about which the couple acts.
    """

    @property
    def application_point_of_actuation_loads(self) -> Floats:
        """The point (2,) [m] in the shoe's frame at which the unit loads of the actuation act."""

    @property
    def load_matrix_columns_by_load_name(self) -> ColumnsOfUnitLoads:
        """Which columns of the body's load matrix belong to each load, by the load's name."""


@dataclass(frozen=True)
class ShoeSubstructure:
    """One shoe with its lining as a condensed body, coupled with the drum or the plane.

    All vectors are in the frame of the shoe. The condensed body is supported at its frame, the face
    that the hinge holds. With the matrices N and T (see `ContactCouplingMatrices`) the
    displacements u of the n contact nodes give the weighted gap closure N u and the weighted slip T
    u [m^3]. Entry i is the closure or slip times the shape function of contact node i, integrated
    over the lining's face. The forces on the contact nodes are -N^T p due to nodal pressures p and
    T^T t due to friction per area t; l unit loads act as well.

    Attributes
    ----------
    mesh, basis : the elements of the body, and its nodes
    line : the contact line, with the n contact nodes
    coupling : the matrices that couple the contact line with the drum or the plane
    condensed : the statically condensed body
    application_point_of_actuation_loads : (2,) point [m] at which unit force x, unit force y and
        unit couple of the actuation act
    rotation_mode : (2n,) displacement of the contact nodes per radian of a rotation about the pin
        [m]
    flexibility : how the contact nodes and the load points move under all loads
    mesh_read_from_file : the mesh that was read from a file, with notes on changes to it; None
        without a mesh file
    """

    mesh: Any
    basis: Any
    line: ContactLine
    coupling: ContactCouplingMatrices
    condensed: CondensedBody | MeshedBody
    application_point_of_actuation_loads: Floats
    rotation_mode: Floats
    flexibility: ContactFlexibility
    mesh_read_from_file: ShoeMeshReadFromFile | None = field(default=None, kw_only=True)

    @property
    def load_matrix_columns_by_load_name(self) -> ColumnsOfUnitLoads:
        """Which columns of the body's load matrix belong to each load, by the load's name."""
        return self.condensed.columns

    @property
    def unknowns(self) -> int:
        """Number of displacements of the body's nodes, two for each node."""
        return int(2 * self.basis.N)

    @cached_property
    def gap_closure_and_slip_per_turn_about_pin(self) -> tuple[Floats, Floats]:
        """Weighted gap closure N u and slip T u (n, 1) [m^3] per radian of rotation about the pin.

        The weights are the shape functions of the contact nodes.
        """
        mode = self.rotation_mode[:, None]
        return self.coupling.N @ mode, self.coupling.T @ mode

    @cached_property
    def resultants_of_unit_nodal_pressures_and_tractions(self) -> Floats:
        """Resultants (2, 3, n) of the nodal forces N^T p and T^T p due to each unit nodal pressure.

        The first index is 0 for N^T p and 1 for T^T p. The second index is 0 for force x, 1 for
        force y and 2 for the moment about the drum's centre.
        """
        x, y = self.line.xy
        count = self.line.xy.shape[1]
        zeros = np.zeros(count)
        ones = np.ones(count)
        # The work of the nodal forces on a unit translation is their resultant force, and the work
        # on a unit rotation is their moment.
        modes = np.array([[ones, zeros], [zeros, ones], [-y, x]])
        modes = modes.transpose(0, 2, 1).reshape(3, -1)
        return np.array([modes @ self.coupling.N.T, modes @ self.coupling.T.T])


class ShoeBodyElements(NamedTuple):
    """The finite elements of a shoe's body, as a `ShoeSubstructure` keeps them.

    `mesh` has the elements, `basis` the nodes, and `line` is the contact line.
    `mesh_read_from_file` is the mesh that was read from a file, with notes on how it was adapted;
    it is None for all other bodies.
    """

    mesh: Any
    basis: Any
    line: ContactLine
    mesh_read_from_file: ShoeMeshReadFromFile | None = None


class NodePositionsAndActuationForces(NamedTuple):
    """The nodes of a body and the nodal forces of its loads, in the shoe's frame.

    `xy` (2, nodes) [m] are the coordinates of the nodes. `load` (2, nodes) [1] is the force on each
    node per newton of the actuation force. It is zero if the actuation acts on the rigid frame of
    the shoe instead of the elastic body. `further_loads` are the unit loads of
    `unit_loads_at_points_and_mass`.
    """

    xy: Floats
    load: Floats
    further_loads: Mapping[str, Floats]


def contact_coupling_matrices_of_shoe(line: ContactLine, shoe: Shoe) -> ContactCouplingMatrices:
    """The coupling matrices between a shoe's contact line and the drum or the plane."""
    directions = (
        plane_normals_and_tangents
        if shoe.is_on_plane
        else function_that_returns_drum_normals_and_tangents(shoe.sign_internal_plus_external_minus)
    )
    return line.coupling_matrices_with_drum_or_plane(shoe.lining.width, directions)


def make_shoe_substructure(
    kind: type[ShoeSubstructure],
    shoe: Shoe,
    division: ShoeBodyElements,
    condensed: CondensedBody | MeshedBody,
    centre: Floats,
    *,
    friction: bool,
) -> ShoeSubstructure:
    """Make a shoe's substructure: couple its condensed body with the drum or the plane.

    Parameters
    ----------
    kind : class of the substructure that is made
    shoe : the shoe
    division : the elements, nodes and contact line of the shoe's body
    condensed : the condensed body of the shoe
    centre : (2,) point at which the unit loads of the actuation act [m]
    friction : whether the brake has friction
    """
    line = division.line
    coupling = contact_coupling_matrices_of_shoe(line, shoe)
    flexibility = _flexibility_of_coupled_body(condensed, coupling, friction=friction)
    x, y = line.xy - shoe.pin_position_in_shoe_frame[:, None]
    return kind(
        mesh=division.mesh,
        basis=division.basis,
        line=line,
        coupling=coupling,
        condensed=condensed,
        application_point_of_actuation_loads=centre,
        rotation_mode=np.array([-y, x]).T.ravel(),
        flexibility=flexibility,
        mesh_read_from_file=division.mesh_read_from_file,
    )


def _flexibility_of_coupled_body(
    condensed: CondensedBody | MeshedBody, coupling: ContactCouplingMatrices, *, friction: bool
) -> ContactFlexibility:
    """The flexibility of a body under the loads of its coupling with the drum or the plane."""
    flexibility = condensed.flexibility_under_contact_loads(coupling, friction=friction)
    # The nodal forces of free thermal strains have no resultant, and the frame alone supports the
    # body in a statically determinate way. So heat causes no reaction, and the computed reaction is
    # round-off, which is set to zero.
    if HEAT_LOAD_NAME in condensed.columns.column_slice_of_each_load:
        heat = condensed.columns.column_slice_of_each_load[HEAT_LOAD_NAME]
        flexibility.reaction_to_load[:, heat] = 0.0
    return flexibility


def substructure_with_flexibility_of_condensed_stiffness(
    body: ShoeSubstructure,
) -> ShoeSubstructure:
    """A shoe's substructure whose flexibility follows from the condensed stiffness.

    On a mesh the flexibility is summed during the elimination of the nodes, and differs from that
    of the condensed stiffness by round-off. Analyses that need both must take both from the
    stiffness: a pair of shoes that floats at rest has an equilibrium only if they agree to the last
    digits. Substructures of other bodies are returned as they are.
    """
    if not isinstance(body.condensed, MeshedBody):
        return body
    flexibility = _flexibility_of_coupled_body(
        body.condensed.condensed,
        body.coupling,
        friction=body.flexibility.gap_closure_by_friction is not None,
    )
    return replace(body, flexibility=flexibility)


def substructure_with_load_of_changed_shape(
    body: ShoeSubstructure, forces: Floats
) -> ShoeSubstructure:
    """A copy of a shoe's substructure with a load that stands for a small change of its shape.

    The load acts in addition to all other loads, with the factor one. Its nodal forces have no
    resultant, so that the support reaction on the frame is zero.

    Parameters
    ----------
    body : the substructure
    forces : (2 nodes,) nodal forces [N] on all nodes, in the frame of the shoe
    """
    condensed = body.condensed.body_with_further_loads({CHANGED_SHAPE_LOAD_NAME: forces[:, None]})
    own = condensed.columns.column_slice_of_each_load[CHANGED_SHAPE_LOAD_NAME]
    # The displacements of the contact nodes under the load, while the frame does not move.
    u, travel = condensed.contact_displacements_and_load_travel(own)
    beside = travel[: own.start]
    flexibility = body.flexibility
    motion = np.block([[flexibility.load_point_motion_by_load, beside], [beside.T, travel[own]]])
    dragged = flexibility.load_point_motion_by_friction
    no_reaction = np.zeros((DEGREES_OF_FREEDOM_OF_BODY_FRAME, 1))
    changed = flexibility._replace(
        gap_closure_by_load=np.hstack([flexibility.gap_closure_by_load, body.coupling.N @ u]),
        load_point_motion_by_load=motion,
        load_point_motion_by_friction=(
            None if dragged is None else np.vstack([dragged, (body.coupling.T @ u).T])
        ),
        reaction_to_load=np.hstack([flexibility.reaction_to_load, no_reaction]),
    )
    return replace(body, condensed=condensed, flexibility=changed)


def functions_of_free_thermal_strain_by_layer(
    shoe: Shoe, radius: float
) -> FreeStrainFunctionByLayer:
    """The free thermal strains of each heated layer of a shoe, as functions of points.

    The result has a function from points to strains by the name of each heated layer, in the shoe's
    frame. `radius` [m] is the radius of the drum. The strains depend on the depth behind the
    friction surface. In the block between lining and straight beam, the depth of a point follows
    from its relative depth in the block. A body has the layer "shoe", and the layer "table" if it
    has a flange.
    """
    strains = {}
    for heated in heated_layers_of_shoe(shoe):
        names = heated.part.plates if heated.key == "body" else (heated.key,)
        for name in names:
            strains[name] = partial(_free_thermal_strains_at_points, shoe, radius, heated)
    return strains


def _free_thermal_strains_at_points(
    shoe: Shoe, radius: float, heated: HeatedLayer, points: Floats
) -> Floats:
    """The free thermal strains (2, ...) of a heated layer of a shoe at points (2, ...) [m]."""
    if heated.key == "backing" and isinstance(shoe.body, BeamBody) and not shoe.mesh:
        # The block between lining and beam is not as thick everywhere as its key `thickness`.
        near, far = heated.depths
        share = relative_depth_in_block_of_beam_shoe(shoe, radius, points)
        depth = near + share * (far - near)
    else:
        depth = shoe.distances_from_friction_surface(points, radius)
    return np.asarray(heated.free_thermal_strains_at_depths(depth))


def nodal_forces_of_unit_loads_besides_actuation(
    basis: Any, shoe: Shoe, radius: float
) -> dict[str, Floats]:
    """The nodal forces (2 nodes, l) of all unit loads of a shoe except its actuation, by name.

    The unit loads are the load of free thermal strains, unit forces at the points of all forces
    besides the actuation, and unit loads on the shoe's mass. Loads that the shoe does not have are
    left out.

    Parameters
    ----------
    basis : scalar basis of the shoe's mesh, or its grid of hp elements
    shoe : the shoe
    radius : radius of the drum [m]; on a plane the length of phi = 1
    """
    loads = unit_loads_at_points_and_mass(basis, shoe, radius)
    strains = functions_of_free_thermal_strain_by_layer(shoe, radius)
    if strains:
        loads[HEAT_LOAD_NAME] = nodal_forces_of_thermal_expansion(
            basis, elastic_layers_of_shoe(shoe), strains
        )[:, None]
    return loads


def unit_load_factors_under_all_loads(
    body: BodyWithActuationLoads, shoe: Shoe, force: float
) -> Floats:
    """The factors (l,) of a body's load columns under an actuation force [N] and all other loads.

    A load column is the vector of nodal forces of a unit load. The load on the body is the sum of
    all columns, each times its factor. The computations of contact, reactions, stresses and
    refinement all take the loads of a shoe from this function. The loads of heat and of a changed
    shape do not depend on the actuation force, and their factors are one.
    """
    factors, _ = actuation_factors_and_pin_moment_per_newton(body, shoe)
    acting = abs(force) * factors
    if shoe.has_loads_besides_actuation:
        acting = acting + unit_load_factors_of_loads_besides_actuation(body, shoe)
    columns = body.load_matrix_columns_by_load_name
    for name in (HEAT_LOAD_NAME, CHANGED_SHAPE_LOAD_NAME):
        if name in columns.column_slice_of_each_load:
            acting = acting + columns.column_factors_of_all_loads({name: np.ones(1)})
    return acting


def unit_load_factors_of_loads_besides_actuation(
    body: BodyWithActuationLoads, shoe: Shoe
) -> Floats:
    """The factors (l,) of a body's unit loads that make up all loads besides the actuation.

    These loads are forces at points of the shoe, its weight and its inertia. If the body has unit
    loads for them, each load acts at its own place. A rigid body and some models have no such unit
    loads. The resultant of the loads then acts where the actuation acts.
    """
    columns = body.load_matrix_columns_by_load_name
    if not has_unit_loads_of_forces_at_points_or_mass(columns):
        return unit_load_factors_of_load_at_actuation_point(
            body, shoe, shoe.resultant_of_loads_besides_actuation
        )
    return columns.column_factors_of_all_loads(unit_load_factors_of_forces_at_points_and_mass(shoe))


def unit_load_factors_of_force_at_point(
    body: BodyWithActuationLoads, shoe: Shoe, index: int, force: ForceAtPoint
) -> Floats:
    """The factors (l,) of a body's load columns under one force on a shoe besides its actuation.

    `force` has the force and its point, in the frame of the brake. `index` is the position of this
    force among all forces besides the actuation, counted from 0.
    """
    columns = body.load_matrix_columns_by_load_name
    at_place = columns.column_slice_of_each_load.get(FURTHER_FORCE_LOAD_NAME)
    if at_place is None:
        return unit_load_factors_of_load_at_actuation_point(body, shoe, force.resultant)
    factors = np.zeros(columns.number_of_load_columns)
    first = at_place.start + 2 * index
    factors[first : first + 2] = shoe.frame.convert_vectors_to_shoe_frame(np.array(force.force))
    return factors


def force_resultant_of_unit_load_factors(
    body: BodyWithActuationLoads, shoe: Shoe, load: Floats
) -> Floats:
    """The resultant force (2,) [N] of a shoe's loads with the factors `load` (l,).

    The resultant is in the frame of the shoe. It contains neither contact nor support forces.
    """
    columns = body.load_matrix_columns_by_load_name
    force = columns.column_factors_of_one_named_load(ACTUATION_LOAD_NAME, load)[:2]
    if has_unit_loads_of_forces_at_points_or_mass(columns):
        force = force + shoe.frame.convert_vectors_to_shoe_frame(
            shoe.resultant_of_loads_besides_actuation[:2]
        )
    return np.asarray(force)


def unit_load_factors_of_load_at_actuation_point(
    body: BodyWithActuationLoads, shoe: Shoe, resultant: Floats
) -> Floats:
    """The factors (l,) of a body's load columns under a load that acts where the actuation acts.

    `resultant` (3,) has the force x, force y [N] and the moment about the brake's origin [N m].
    """
    centre_x, centre_y = shoe.convert_points_to_brake_frame(
        body.application_point_of_actuation_loads[:, None]
    )[:, 0].tolist()
    fx, fy, moment = resultant.tolist()
    couple = shoe.frame.sense * (moment - (centre_x * fy - centre_y * fx))
    own = np.array([*shoe.frame.convert_vectors_to_shoe_frame(np.array([fx, fy])), couple])
    return body.load_matrix_columns_by_load_name.column_factors_of_all_loads(
        {ACTUATION_LOAD_NAME: own}
    )


def moment_of_loads_besides_actuation_about_pin(shoe: Shoe) -> float:
    """Moment [N m] about the pin of all loads except the actuation, in the shoe's frame."""
    return shoe.frame.sense * shoe.moment_of_loads_besides_actuation_about_point(shoe.pin)


def actuation_factors_and_pin_moment_per_newton(
    body: BodyWithActuationLoads, shoe: Shoe
) -> tuple[Floats, float]:
    """The factors (l,) of a body's load columns under its actuation, and the moment about the pin.

    Both are for an actuation force of 1 N and in the shoe's frame. The moment per newton [m] is
    thus a lever arm. If the actuation force of the shoe is negative, the force of 1 N acts in the
    opposite direction. Columns of other loads have the factor zero.
    """
    own, moment = actuation_force_and_moments_per_newton(
        body.application_point_of_actuation_loads, shoe
    )
    return body.load_matrix_columns_by_load_name.column_factors_of_all_loads(
        {ACTUATION_LOAD_NAME: own}
    ), moment


def unit_load_factors_of_one_sided_support_push(
    body: BodyWithActuationLoads, shoe: Shoe, push: Actuation, size: float
) -> Floats:
    """The factors (l,) of a body's load columns under the push of a one-sided support.

    A support that is nearer to the loaded end than to the hinge pushes at the loaded end, as the
    actuation does. A support that is nearer to the hinge pushes on the rigid frame, and all factors
    are 0.

    Parameters
    ----------
    body : the body
    shoe : the shoe
    push : force of the support [N] with its line of action
    size : size of the brake [m], on a drum its radius
    """
    factors, _ = actuation_factors_and_pin_moment_per_newton(
        body, shoe.model_copy(update={"actuation": push})
    )
    on_loaded_end = shoe.is_point_nearer_to_loaded_end_than_to_pin(push.point, size)
    return push.force * factors if on_loaded_end else np.zeros_like(factors)


def actuation_force_and_moments_per_newton(centre: Floats, shoe: Shoe) -> tuple[Floats, float]:
    """Force x, force y and couple (3,) of a shoe's actuation, and its moment about the pin.

    The couple [m] is the moment of the force about `centre` (2,) [m] in the shoe's frame. All
    values are per newton of the actuation force.
    """
    # A negative force acts against the direction that the brake file gives.
    direction = math.copysign(1.0, shoe.actuation.force) * shoe.actuation.unit_vector_of_force
    fx, fy = shoe.frame.convert_vectors_to_shoe_frame(direction).tolist()
    x, y = shoe.convert_points_to_shoe_frame(shoe.actuation.point.xy).tolist()
    centre_x, centre_y = centre.tolist()
    pin_x, pin_y = shoe.pin_position_in_shoe_frame.tolist()
    couple = (x - centre_x) * fy - (y - centre_y) * fx
    moment = (x - pin_x) * fy - (y - pin_y) * fx
    return np.array([fx, fy, couple]), moment


def penalty_stiffness_of_contact_per_area(shoe: Shoe, penalty: float) -> float:
    """The penalty stiffness of the contact per area [Pa/m]: `penalty` times E/t of the lining.

    E is the modulus through the lining's thickness t.
    """
    return penalty * shoe.lining.material.E_through / shoe.lining.thickness
