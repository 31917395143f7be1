"""The condensed body of a parametric shoe in hp elements, and the grid of all of its nodes.

The condensed body has only the unknowns that the contact problem needs: the displacements of the
contact nodes, and the three rigid-body motions of the face that the hinge holds (the frame).
"""

import math
from functools import partial

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.base.lapack import dpotrf, dtrtrs, solve_lower_triangular_system
from drumlin.brake.brake import Shoe
from drumlin.fem.hp.division import ShoeElementDivision
from drumlin.fem.hp.grid import (
    ElementBoundaryGrid,
    EliminatedUnknownsOfHpElementBody,
    HpElementGrid,
    RectangularElementBlock,
)
from drumlin.fem.hp.shoe import (
    CondensedShoe,
    UnitLoadsOnLoadedEndFace,
    angles_of_contact_nodes_on_each_lining,
    function_from_depth_and_angle_to_point,
    node_positions_of_element_row,
    unit_actuation_loads_on_end_face,
)
from drumlin.fem.substructure.body import (
    DEGREES_OF_FREEDOM_OF_BODY_FRAME,
    CondensedBody,
    EliminatedUnknownsOfAnyBody,
    UncondensedBodySystem,
    multi_point_constraints_of_body,
)
from drumlin.fem.substructure.elasticity import elastic_layers_of_shoe
from drumlin.fem.substructure.elimination import SINGULAR_BODY_MESSAGE
from drumlin.fem.substructure.interface import ContactLine
from drumlin.response.response import angle_of_edge_zone_left_out_of_peak_search


def element_grid_of_whole_shoe(
    shoe: Shoe, radius: float, div: ShoeElementDivision
) -> HpElementGrid:
    """The grid of all nodes and hp elements of a shoe.

    Its node set "hinge" is the face that the hinge holds. An elastic shoe also has the node set
    "actuation", the face that the actuation force acts on. The nodes of both sets are in order of
    their depth, the nearest to the lining first.

    Parameters
    ----------
    shoe : a parametric shoe
    radius : radius of the drum [m]
    div : division of the shoe into columns and layers of elements
    """
    # The nodes under the linings are numbered first, one row of equal depth after the other, from
    # the contact to the shoe's back. In a slot between two linings only the body has nodes.
    p, first = div.degree, div.index_of_first_body_layer
    depth, along = (
        node_positions_of_element_row(div.depths, p),
        node_positions_of_element_row(div.angles, p),
    )
    exists = np.ones((len(depth), len(along)), dtype=bool)
    for start, end in div.slots:
        exists[: _number_of_node_rows_outside_body(div), start * p + 1 : end * p] = False
    under = np.where(exists, np.cumsum(exists).reshape(exists.shape) - 1, -1)
    blocks = _element_blocks_under_linings_and_in_slots(div, depth, along, under)
    count = int(exists.sum())
    # The body continues beyond the lining from these nodes: `faces` are the nodes through its
    # thickness under the lining's start and end.
    faces = [under[first * p :, 0], under[first * p :, -1]]
    for k, ends in enumerate((div.column_ends_before_lining, div.column_ends_behind_lining)):
        if first == div.number_of_element_layers or len(ends) == 1:
            continue
        # The block of nodes beyond the lining shares the nodes through the thickness at the
        # lining's end with the block under the lining.
        places = node_positions_of_element_row(ends, p)
        shape = (len(faces[k]), len(places) - 1)
        inner = count + np.arange(math.prod(shape)).reshape(shape)
        count += inner.size
        nodes = np.concatenate([faces[k][:, None], inner], axis=1)
        blocks.append(RectangularElementBlock(nodes, depth[first * p :], places, div.part[first:]))
        faces[k] = inner[:, -1]
    sets = _node_sets_of_hinge_and_actuation(shoe, radius, div, along, under[-1], faces)
    return HpElementGrid(
        p, tuple(blocks), function_from_depth_and_angle_to_point(shoe, radius), sets, count
    )


def _number_of_node_rows_outside_body(div: ShoeElementDivision) -> int:
    """The number of rows of nodes, counted from the contact, before the shoe's body begins.

    A row holds the nodes at one depth. If the shoe is rigid, its body has no elements, and the
    result is the number of all rows.
    """
    rigid = div.index_of_first_body_layer == div.number_of_element_layers
    return div.index_of_first_body_layer * div.degree + rigid


def _element_blocks_under_linings_and_in_slots(
    div: ShoeElementDivision, depth: Floats, along: Floats, under: Ints
) -> list[RectangularElementBlock]:
    """The blocks of elements: one under each lining, and one in each slot between two linings.

    Parameters
    ----------
    div : division of the shoe into columns and layers of elements
    depth, along : (r,) depths of the rows of nodes, and (n,) positions of the nodes in each row
        along the shoe
    under : (r, n) numbers of the nodes; -1 where a slot has no node
    """
    p, first = div.degree, div.index_of_first_body_layer
    blocks = []
    for start, end in div.element_column_range_of_each_lining:
        columns = slice(start * p, end * p + 1)
        blocks.append(RectangularElementBlock(under[:, columns], depth, along[columns], div.part))
    for start, end in div.slots if first < div.number_of_element_layers else ():
        columns, rows = slice(start * p, end * p + 1), slice(first * p, None)
        own = RectangularElementBlock(
            under[rows, columns], depth[rows], along[columns], div.part[first:]
        )
        blocks.append(own)
    return blocks


def _node_sets_of_hinge_and_actuation(
    shoe: Shoe,
    radius: float,
    div: ShoeElementDivision,
    along: Floats,
    back: Ints,
    faces: list[Ints],
) -> dict[str, Ints]:
    """The node sets of a shoe by name: "hinge" moves rigidly with the hinge, "actuation" is loaded.

    The set "actuation" is missing if the back of the shoe is held by a grip or bonded to a rigid
    body.

    Parameters
    ----------
    shoe : a parametric shoe
    radius : radius of the drum [m]
    div : division of the shoe into columns and layers of elements
    along : (n,) positions along the lining of the nodes on the shoe's back
    back : (n,) nodes on the shoe's back under the lining
    faces : nodes of the body's two end faces, at the hinge and at the actuation
    """
    if div.index_of_first_body_layer == div.number_of_element_layers:
        return {"hinge": back[back >= 0]}
    grip = shoe.interval_of_body_back_held_by_support(radius)
    if grip is None:
        return {"hinge": faces[0], "actuation": faces[1]}
    return {"hinge": back[(along > grip[0] - 1e-9) & (along < grip[1] + 1e-9)]}


def condensed_shoe_body(
    shoe: Shoe,
    div: ShoeElementDivision,
    found: CondensedShoe,
    grid: HpElementGrid,
) -> CondensedBody:
    """The condensed body of a shoe, with the Cholesky factor of its contact stiffness.

    Displacements of eliminated nodes, which pictures need, can be computed later on `grid`.

    Parameters
    ----------
    shoe, div : the shoe and its division into elements
    found : the shoe's stiffness and unit loads, condensed to its contact nodes and to the rigid
        face that the hinge holds
    grid : all nodes and elements of the shoe

    Raises
    ------
    NoAnswer
        for a singular stiffness
    """
    system = partial(_equations_of_shoe_before_condensation, shoe, div, grid)
    return condensed_body_with_cholesky_factor(
        found,
        EliminatedUnknownsOfHpElementBody.eliminated_unknowns_with_system_loads_only(
            grid, elastic_layers_of_shoe(shoe), system
        ),
    )


def condensed_body_with_cholesky_factor(
    found: CondensedShoe, inner: EliminatedUnknownsOfAnyBody
) -> CondensedBody:
    """The condensed body of a shoe, with the Cholesky factor of its contact stiffness.

    Parameters
    ----------
    found : the shoe's stiffness and unit loads, condensed to its contact nodes and to the rigid
        face that the hinge holds
    inner : the equations that give the displacements of the eliminated nodes

    Raises
    ------
    NoAnswer
        for a singular stiffness
    """
    S, loads = found.S, found.loads
    L, info = dpotrf(
        S[DEGREES_OF_FREEDOM_OF_BODY_FRAME:, DEGREES_OF_FREEDOM_OF_BODY_FRAME:], lower=1
    )
    if info:
        raise NoAnswer(SINGULAR_BODY_MESSAGE)
    # Without round-off, rigid-body motions would cause no forces on the contact nodes. The
    # displacements under the forces that they do cause are an estimate of the round-off error.
    half_error = solve_lower_triangular_system(L, found.rigid_mode_forces)
    return CondensedBody(
        L,
        L_fc=solve_lower_triangular_system(
            L, S[DEGREES_OF_FREEDOM_OF_BODY_FRAME:, :DEGREES_OF_FREEDOM_OF_BODY_FRAME]
        ).T,
        load_on_contact=loads[DEGREES_OF_FREEDOM_OF_BODY_FRAME:],
        load_on_frame=loads[:DEGREES_OF_FREEDOM_OF_BODY_FRAME],
        load_work=found.work,
        inner=inner,
        columns=found.columns,
        force_imbalance=found.force_imbalance,
        rigid_mode_error=dtrtrs(L, half_error, lower=1, trans=1)[0],
    )


def _equations_of_shoe_before_condensation(
    shoe: Shoe,
    div: ShoeElementDivision,
    grid: HpElementGrid,
    basis: HpElementGrid | ElementBoundaryGrid,
) -> UncondensedBodySystem:
    """The stiffness, constraints and loads of a shoe before condensation.

    Parameters
    ----------
    shoe, div : the shoe and its division into elements
    grid : all nodes and elements of the shoe
    basis : nodes whose displacements are unknowns of the system: all nodes of the grid, or only
        those on the sides of elements (the skeleton)
    """
    contact = basis.indices_in_this_basis_of_grid_nodes(np.arange(div.contact_nodes))
    constraints = multi_point_constraints_of_body(
        basis,
        contact,
        basis.indices_in_this_basis_of_grid_nodes(grid.sets["hinge"]),
        shoe.pin_position_in_shoe_frame,
    )
    if "actuation" in grid.sets:
        forces = _nodal_forces_on_all_nodes_from_end_face_forces(
            grid, _unit_loads_on_loaded_end_face(div, grid).forces
        )
        loads = constraints.matrix.T @ forces[basis.dofs]
    else:
        # The back of the shoe is fixed to a rigid grip or a rigid body, the frame. The three unit
        # loads are a force along x, a force along y and a couple on the frame.
        loads = np.zeros((constraints.matrix.shape[1], DEGREES_OF_FREEDOM_OF_BODY_FRAME))
        loads[-DEGREES_OF_FREEDOM_OF_BODY_FRAME:] = np.eye(DEGREES_OF_FREEDOM_OF_BODY_FRAME)
    return UncondensedBodySystem.body_system_from_stiffness_of_all_nodes(
        basis.stiffness(elastic_layers_of_shoe(shoe)), constraints, loads
    )


def nodal_forces_of_unit_actuations_and_their_centre(
    div: ShoeElementDivision, grid: HpElementGrid
) -> tuple[Floats, Floats]:
    """The nodal forces of unit actuations on a shoe's loaded end face, and the face's centre.

    The columns of the nodal forces (2 N, 3), on all N nodes of the grid, are for a unit force along
    x, a unit force along y and a unit couple. The centre of the end face is (2,) [m].
    """
    end = _unit_loads_on_loaded_end_face(div, grid)
    return _nodal_forces_on_all_nodes_from_end_face_forces(grid, end.forces), end.centre


def _unit_loads_on_loaded_end_face(
    div: ShoeElementDivision, grid: HpElementGrid
) -> UnitLoadsOnLoadedEndFace:
    """The unit loads on the end face of a shoe that the actuation force acts on."""
    depths = node_positions_of_element_row(div.depths[div.index_of_first_body_layer :], div.degree)
    nodes = grid.doflocs[:, grid.sets["actuation"]]
    return unit_actuation_loads_on_end_face(nodes, depths, div.degree)


def _nodal_forces_on_all_nodes_from_end_face_forces(grid: HpElementGrid, forces: Floats) -> Floats:
    """The nodal forces (2 N, l) on all N nodes, from the forces (2n, l) on the loaded end face.

    The forces are zero on all other nodes.
    """
    nodes, count = grid.sets["actuation"], forces.shape[1]
    full = np.zeros((grid.N, 2, count))
    full[nodes] = forces.reshape(-1, 2, count)
    return full.reshape(-1, count)


def contact_line_of_lining_face_nodes(
    shoe: Shoe, radius: float, div: ShoeElementDivision
) -> ContactLine:
    """The contact line of a shoe: the nodes on the lining's face, which come first in the grid.

    Parameters
    ----------
    shoe : a parametric shoe
    radius : radius of the drum [m]
    div : division of the shoe into columns and layers of elements
    """
    p = div.degree
    of_linings = angles_of_contact_nodes_on_each_lining(div)
    firsts = np.cumsum([0, *map(len, of_linings)])[:-1]
    pieces = []
    for first, nodes in zip(firsts, of_linings, strict=True):
        pieces.append(first + np.arange((len(nodes) - 1) // p) * p + np.arange(p + 1)[:, None])
    phi = np.concatenate(of_linings)
    return ContactLine(
        np.arange(len(phi)),
        shoe.points_at_depth_and_coordinate_phi(np.zeros(1), phi, radius),
        phi,
        np.concatenate(pieces, axis=1),
        edge=angle_of_edge_zone_left_out_of_peak_search(shoe, radius),
        further_linings=tuple(firsts[1:].tolist()),
    )
