"""A parametric shoe in hp elements: the coordinates of its nodes, and its static condensation.

An element column is a stack of elements through the thickness of the shoe. The columns are
condensed one by one, and joined side by side along the shoe. The result is the stiffness of the
shoe on three groups of unknowns: the frame (the three rigid-body motions of the face that the hinge
holds), the contact nodes, and the factors of the unit loads.
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.brake.beam_axis import make_beam_axis
from drumlin.brake.brake import Shoe
from drumlin.brake.components import BeamBody
from drumlin.brake.elasticity import ElasticLayer, which_elasticity_matrices_are_orthotropic
from drumlin.fem.hp.arc import (
    angular_factors_of_column_stiffness,
    condensed_arc_column_stiffness,
    condensed_arc_element_stiffness,
)
from drumlin.fem.hp.columns import (
    AnyColumnSubstructure,
    ColumnSubstructure,
    ColumnSubstructureMadeWhenNeeded,
    NumberingOfElementColumnUnknowns,
    assemble_and_condense_row_of_element_columns,
    condensed_element_column_stiffness,
    eliminate_nodes_on_column_side,
    numbering_of_element_column_unknowns,
    rotate_node_axes_of_matrix,
    rotate_node_axes_of_vectors,
)
from drumlin.fem.hp.division import ShoeElementDivision
from drumlin.fem.hp.element import (
    condensed_element_stiffness,
    gauss_points_of_elements,
    reference_element_of_degree,
)
from drumlin.fem.substructure.body import (
    DEGREES_OF_FREEDOM_OF_BODY_FRAME,
    rigid_body_displacements_of_nodes,
)
from drumlin.fem.substructure.elasticity import elasticity_times_width_of_layers
from drumlin.fem.substructure.loads import ACTUATION_LOAD_NAME, ColumnsOfUnitLoads
from drumlin.response.resultants import (
    GAUSS,
    WEIGHTS,
    gauss_lobatto_points,
    shape_functions_and_derivatives_at_gauss_points,
)

STRAIGHT_BEAM_COLUMNS_PER_BATCH = 8
"""Number of element columns of a straight beam that are condensed together.

More columns together take more memory. Fewer columns take more time, because each batch is a call
of each step. The stiffness is the same for every number.
"""
CONTACT_STIFFNESS_ROWS_CHANGED_TOGETHER = 256
"""Number of rows of a contact stiffness that are corrected for round-off at the same time.

With more rows the correction takes more memory; with fewer rows it takes more time. The stiffness
is the same for every number.
"""
PointAtDepthAndAngleFunction = Callable[[Floats, Floats], Floats]
"""A function from depths behind the lining's face and positions phi [rad] to points (2, ...) [m].

The points are in the frame of the shoe.
"""


class UnitLoadsOnLoadedEndFace(NamedTuple):
    """The unit loads on the end face of a shoe's body where the actuation force acts.

    Attributes
    ----------
    forces : (2n, l) nodal forces of each of l unit loads on the n nodes of the end face
    columns : which columns of `forces` belong to which load, by the load's name
    centre : (2,) point that the unit actuations act at [m]
    moments : (3, l) resultants of each unit load: force along x, force along y, and moment about
        the centre
    """

    forces: Floats
    columns: ColumnsOfUnitLoads
    centre: Floats
    moments: Floats

    def forces_and_moments_of_unit_loads_about_pin(self, pin: Floats) -> Floats:
        """The force x, force y and moment about the `pin` (2,) [m] of each unit load (3, l)."""
        arm = self.centre - pin
        resultants = self.moments.copy()
        resultants[2] += arm[0] * self.moments[1] - arm[1] * self.moments[0]
        return resultants


def unit_actuation_loads_on_end_face(
    xy: Floats, depths: Floats, p: int, share: Floats | float = 1.0
) -> UnitLoadsOnLoadedEndFace:
    """The unit actuations on the straight end face of a shoe: force x, force y and couple.

    The forces are spread evenly over the end face. The couple is a traction that grows linearly
    from the centre of the face. The nodal forces of a unit force have the unit [1], those of a unit
    couple [1/m].

    Parameters
    ----------
    xy : (2, n) nodes of the end face [m]
    depths : (n,) depths of the nodes; only their relative positions along the face are used
    p : degree of the elements
    share : (e,) factor by which the traction on each element of the end face is multiplied
    """
    # `ends` are the ends of the elements along the end face, as positions from -1/2 to 1/2.
    ends = (depths[::p] - depths[0]) / (depths[-1] - depths[0]) - 0.5
    at = np.arange(len(ends) - 1)[:, None] * p + np.arange(p + 1)
    psi, _ = shape_functions_and_derivatives_at_gauss_points(p)
    half = 0.5 * (ends[1:] - ends[:-1])[:, None]
    where = ends[:-1, None] + half * (1 + GAUSS)
    weights = half * WEIGHTS * np.reshape(share, (-1, 1))
    even = np.bincount(at.ravel(), (weights @ psi.T).ravel())
    # On an end face of length 1 the traction of a unit couple is 12 times the position, counted
    # from the centre of the face.
    linear = np.bincount(at.ravel(), ((weights * where) @ psi.T).ravel()) * 12
    end = xy[:, -1] - xy[:, 0]
    centre = 0.5 * (xy[:, -1] + xy[:, 0])
    load = np.zeros((xy.shape[1], 2, DEGREES_OF_FREEDOM_OF_BODY_FRAME))
    load[:, 0, 0] = load[:, 1, 1] = even
    load[:, :, 2] = linear[:, None] * np.array([-end[1], end[0]]) / (end @ end)
    columns = ColumnsOfUnitLoads(((ACTUATION_LOAD_NAME, DEGREES_OF_FREEDOM_OF_BODY_FRAME),))
    return UnitLoadsOnLoadedEndFace(
        load.reshape(-1, DEGREES_OF_FREEDOM_OF_BODY_FRAME),
        columns,
        centre,
        np.eye(DEGREES_OF_FREEDOM_OF_BODY_FRAME),
    )


class CondensedShoe(NamedTuple):
    """A shoe condensed to its frame and its n contact nodes, with estimates of round-off.

    The frame is the rigid face that the hinge holds, with three rigid-body motions as unknowns.
    Each contact node has the unknowns x and y. For a shoe whose back is fixed to a rigid grip or
    body the estimates of round-off are unknown and set to zero.

    Attributes
    ----------
    S : (3 + 2n, 3 + 2n) stiffness on the frame and the contact nodes
    loads : (3 + 2n, l) condensed unit loads
    work : (l, l) work of each unit load on the displacements that each unit load causes while frame
        and contact nodes are fixed
    centre : (2,) point that the unit actuations act at [m]
    rigid_mode_forces : (2n, 3) forces on the contact nodes due to rigid-body motions of the shoe;
        they would be zero without round-off
    force_imbalance : largest component x or y of the sum of a unit actuation force and its
        reactions [1]; it would be zero without round-off
    columns : which columns of `loads` belong to which unit load, by the load's name
    """

    S: Floats
    loads: Floats
    work: Floats
    centre: Floats
    rigid_mode_forces: Floats
    force_imbalance: float
    columns: ColumnsOfUnitLoads


def function_from_depth_and_angle_to_point(
    shoe: Shoe, radius: float
) -> PointAtDepthAndAngleFunction:
    """The function from depths and positions along the lining to points in the shoe's frame [m].

    `radius` is the radius of the drum [m].
    """
    return (
        _function_from_depth_and_angle_to_beam_shoe_point(shoe, radius)
        if isinstance(shoe.body, BeamBody)
        else partial(shoe.points_at_depth_and_coordinate_phi, size=radius)
    )


def _function_from_depth_and_angle_to_beam_shoe_point(
    shoe: Shoe, radius: float
) -> PointAtDepthAndAngleFunction:
    """The function from depths and positions to points [m] of a shoe with a straight beam.

    Depths from 0 to 1 are in the lining, from 1 to 2 in the block between lining and beam, and from
    2 to 3 in the beam. The ends of the block are cut square to the beam.
    """
    # `reason_against_finite_element_model` refuses shoes without a section before, so that the
    # assertion holds.
    assert isinstance(shoe.body, BeamBody) and shoe.body.section is not None
    axis = make_beam_axis(shoe.pin.xy, shoe.actuation.point.xy)
    thickness = shoe.lining.thickness
    back, beam = radius + thickness, shoe.body.section.thickness
    s, e = shoe.arc
    ends = axis.angle(shoe.frame.surface_coordinates_of_phi(np.array([s, e])))
    start = float(np.min(ends))

    def beam_shoe_points_at_depth_and_angle(depth: Floats, phi: Floats) -> Floats:
        """The points (2, ...) [m] of a straight-beam shoe at depths and positions phi [rad]."""
        depth, phi = np.broadcast_arrays(depth, phi)
        # In the axes of the beam, x runs along the beam. Under the lining the angle `a` is counted
        # from the perpendicular from the drum's centre to the beam's axis; `beyond` is the distance
        # along x beyond the lining.
        a = np.clip(phi, s, e) - s + start
        beyond = back * (np.minimum(phi - s, 0) + np.maximum(phi - e, 0))
        r = radius + thickness * np.minimum(depth, 1)
        x = axis.x_of_perpendicular_foot + r * np.sin(a) + beyond
        y = axis.distance_from_drum_centre - r * np.cos(a)
        in_block = y + np.minimum(depth - 1, 1) * (beam / 2 - y)
        y = np.where(depth > 1, in_block, y)
        in_beam = beam / 2 - (depth - 2) * beam
        y = np.where(depth > 2, in_beam, y)
        return np.moveaxis(
            shoe.frame.convert_vectors_to_shoe_frame(
                axis.convert_beam_coordinates_to_brake_points(x, y)
            ),
            -1,
            0,
        )

    return beam_shoe_points_at_depth_and_angle


def node_positions_in_each_element_of_row(ends: Floats, p: int) -> Floats:
    """The positions (m, p + 1) of the nodes of m elements of degree p in a row.

    `ends` (m + 1,) are the positions of the ends of the elements.
    """
    first, last = ends[:-1, None], ends[1:, None]
    return np.asarray(0.5 * (last + first) + 0.5 * (last - first) * gauss_lobatto_points(p))


def node_positions_of_element_row(ends: Floats, p: int) -> Floats:
    """The positions (m p + 1,) of the nodes of m elements of degree p in a row, each node once.

    `ends` (m + 1,) are the positions of the ends of the elements.
    """
    return np.append(node_positions_in_each_element_of_row(ends, p)[:, :-1].ravel(), ends[-1])


def node_coordinates_of_layers_and_columns(
    place: PointAtDepthAndAngleFunction, depths: Floats, along: Floats, p: int
) -> Floats:
    """The coordinates (l, c, 2, a) [m] of the a nodes of each element in l layers and c columns.

    The nodes of an element are in the order of `ReferenceElement`.

    Parameters
    ----------
    place : function from depths and positions along the lining to points of the shoe
    depths : (l + 1,) depths of the faces of the layers
    along : (c, p + 1) positions of the columns' nodes along the lining
    p : degree of the elements
    """
    # `xy` (2, layers, columns, p + 1, p + 1) are the nodes of all elements.
    xy = place(
        node_positions_in_each_element_of_row(depths, p)[:, None, :, None], along[:, None, :]
    )
    xy = xy.reshape(*xy.shape[:3], -1).transpose(1, 2, 0, 3)
    return np.ascontiguousarray(xy[..., reference_element_of_degree(p).order])


def distinct_sizes_and_index_of_each_size(sizes: Floats) -> tuple[Floats, Ints]:
    """The k distinct values (k,) among `sizes` (m,), and for each size the index (m,) of its value.

    Sizes that agree in twelve digits count as equal.
    """
    numbers: dict[float, int] = {}
    which = []
    for size in sizes.tolist():
        rounded = float(f"{size:.11e}")
        which.append(numbers.setdefault(rounded, len(numbers)))
    return np.array(list(numbers)), np.array(which)


def _unit_vectors_along_shoe_layers(
    layers: dict[str, ElasticLayer], part: tuple[str, ...], xy: Floats, p: int
) -> Floats:
    """The unit vectors (l, c, 2, q) along the layers of a shoe at the Gauss points of elements.

    There are l layers of c elements with the nodes xy (l, c, 2, a) [m]. `part` (l,) names the part
    of the shoe ("lining", "shoe", ...) that each layer of elements belongs to.
    """
    points = np.moveaxis(gauss_points_of_elements(xy, p), 2, 1)  # (l, 2, c, q)
    vectors = [
        layers[name].unit_vectors_along_layer(own) for name, own in zip(part, points, strict=True)
    ]
    return np.moveaxis(np.array(vectors), 1, 2)


class _CondensedElementColumnsOfShoe(NamedTuple):
    """The condensed element columns of a shoe, in the order of their positions.

    Columns of equal shape and material are the same Python object.

    Attributes
    ----------
    under : columns under the linings and in the slots between them
    before, after : columns of the body before and behind all linings
    grip : a grip holds the back of the columns grip[0] to grip[1] - 1 under the lining; both
        numbers are 0 without a grip
    """

    under: list[AnyColumnSubstructure]
    before: list[AnyColumnSubstructure]
    after: list[AnyColumnSubstructure]
    grip: tuple[int, int]


class _ElementColumnKinds(NamedTuple):
    """The kinds of element columns of a shoe; columns of one kind have the same stiffness.

    Attributes
    ----------
    along : (kinds, p + 1) positions of the nodes of each kind along the lining
    angular : integrals along the columns of each kind on an arc or a plane, see
        `angular_factors_of_column_stiffness`; None for a straight beam
    which : (columns,) index of each column's kind: first the columns under the lining, then the
        columns before the lining, then the columns behind the lining
    """

    along: Floats
    angular: Floats | None
    which: Ints


def group_equal_element_columns_of_shoe(
    shoe: Shoe, div: ShoeElementDivision, *, directed: bool
) -> _ElementColumnKinds:
    """The kinds of element columns of a shoe; the stiffness is computed once for each kind.

    On an arc or a plane, columns of equal width are of one kind. In a straight beam each column is
    of its own kind.

    Parameters
    ----------
    shoe, div : the shoe and its division into elements
    directed : whether a layer of the shoe is orthotropic
    """
    p = div.degree
    rows = [div.angles]
    if div.index_of_first_body_layer < div.number_of_element_layers:
        rows += [div.column_ends_before_lining[::-1], div.column_ends_behind_lining]
    if isinstance(shoe.body, BeamBody):
        along = np.concatenate([node_positions_in_each_element_of_row(ends, p) for ends in rows])
        return _ElementColumnKinds(along, None, np.arange(len(along)))
    sizes, which = distinct_sizes_and_index_of_each_size(
        np.concatenate([ends[1:] - ends[:-1] for ends in rows])
    )
    along = 0.5 * sizes[:, None] * gauss_lobatto_points(p)
    A = angular_factors_of_column_stiffness(along, p, flat=shoe.is_on_plane, directed=directed)
    return _ElementColumnKinds(along, A, which)


class _ShoeDividedIntoHpElements(NamedTuple):
    """A shoe divided into elements, before its element columns are condensed.

    Attributes
    ----------
    shoe : a parametric shoe
    radius : radius of the drum [m]
    div : division of the shoe into columns and layers of elements
    layers : elasticity of the layers by name
    elasticity : (l, 3, 3) elasticity matrix times the width of each layer of elements [N/m]
    directed : whether a layer of the shoe is orthotropic
    kinds : the kinds of element columns
    """

    shoe: Shoe
    radius: float
    div: ShoeElementDivision
    layers: dict[str, ElasticLayer]
    elasticity: Floats
    directed: bool
    kinds: _ElementColumnKinds


def _condensed_hp_columns_of_shoe(
    shoe: Shoe, radius: float, div: ShoeElementDivision, layers: dict[str, ElasticLayer]
) -> _CondensedElementColumnsOfShoe:
    """The element columns of a shoe, each condensed to its two sides and its contact nodes.

    `div` divides the shoe into columns and layers of elements. `layers` has the elasticity of the
    layers by name, and `radius` [m] is the drum's radius.
    """
    elasticity = elasticity_times_width_of_layers(layers, div.part)
    directed = bool(which_elasticity_matrices_are_orthotropic(elasticity).any())
    kinds = group_equal_element_columns_of_shoe(shoe, div, directed=directed)
    whole = _ShoeDividedIntoHpElements(shoe, radius, div, layers, elasticity, directed, kinds)
    # The columns inside a grip are fixed at their back, the edge farthest from the contact. All
    # other columns are free there.
    which = kinds.which
    under, before = len(div.angles) - 1, len(div.column_ends_before_lining) - 1
    ends = shoe.interval_of_body_back_held_by_support(radius)
    a, b = (0, 0) if ends is None else (int(np.abs(div.angles - x).argmin()) for x in ends)
    body = div.index_of_first_body_layer
    rigid = body == div.number_of_element_layers
    # In the slots between linings the columns consist of the body's layers alone, as beyond the
    # linings. A rigid body has no columns there.
    in_slot = np.zeros(under, dtype=bool)
    for first, last in div.slots:
        in_slot[first:last] = True
    in_grip = (np.arange(under) >= a) & (np.arange(under) < b)
    columns: dict[int, AnyColumnSubstructure] = {}
    for slot, held in ((False, False), (False, True), (True, False), (True, True)):
        where = np.flatnonzero((in_slot == slot) & (in_grip == held))
        made = _condensed_hp_columns_of_row(
            whole, which[where], body * slot, contact=not slot, held=held or rigid
        )
        columns |= dict(zip(where.tolist(), made, strict=False))
    rest = _condensed_hp_columns_of_row(whole, which[under:], body, contact=False, held=False)
    row = [columns[k] for k in sorted(columns)]
    return _CondensedElementColumnsOfShoe(row, rest[:before], rest[before:], (a, b))


def _condensed_hp_columns_of_row(
    whole: _ShoeDividedIntoHpElements, row: Ints, layer: int, *, contact: bool, held: bool
) -> list[AnyColumnSubstructure]:
    """The condensed element columns of one row of a shoe, with the layers from number `layer` on.

    Parameters
    ----------
    whole : the shoe
    row : (c,) index of the kind of each column
    layer : index of the columns' first layer of elements; 0 is the layer at the lining's face
    contact : whether the columns' edge at the lining's face is in contact
    held : whether the nodes on the edge farthest from the contact are fixed
    """
    div = whole.div
    if not len(row) or layer == div.number_of_element_layers:
        return []
    # numpy.unique would load numpy's masked arrays, which takes time; bincount does not load them.
    kinds = np.flatnonzero(np.bincount(row))
    unknowns = numbering_of_element_column_unknowns(
        div.degree, div.number_of_element_layers - layer, contact=contact, held=held
    )
    if whole.kinds.angular is None:
        columns = _columns_of_straight_beam_made_in_batches(whole, kinds, layer, unknowns)
        return [columns[kind] for kind in row.tolist()]
    radii = whole.radius - whole.shoe.sign_internal_plus_external_minus * div.depths[layer:]
    parts = condensed_arc_element_stiffness(
        radii,
        whole.kinds.angular[:, kinds],
        whole.elasticity[layer:],
        div.degree,
        whole.radius if whole.shoe.is_on_plane else None,
    )
    stiffness = condensed_arc_column_stiffness(parts, div.degree, contact=contact, held=held)
    made = {}
    for kind, K in zip(kinds.tolist(), stiffness, strict=True):
        made[kind] = ColumnSubstructure(
            K, unknowns.number_of_side_unknowns, unknowns.number_of_side_unknowns
        )
    return [made[kind] for kind in row.tolist()]


def _columns_of_straight_beam_made_in_batches(
    whole: _ShoeDividedIntoHpElements,
    kinds: Ints,
    layer: int,
    unknowns: NumberingOfElementColumnUnknowns,
) -> dict[int, ColumnSubstructureMadeWhenNeeded]:
    """The element columns of a straight beam by their kind, made a few at a time when needed.

    In a straight beam all columns are of different kinds, which would fill the memory. A row is
    joined from one end to the other, so that few of its columns are needed at a time. A column is
    dropped after its use. If it is needed again, its batch is made again.

    Parameters
    ----------
    whole : the shoe
    kinds : (c,) indices of the kinds, in the order of the columns along the shoe
    layer : index of the columns' first layer of elements; 0 is the layer at the lining's face
    unknowns : the kept and the eliminated unknowns of a column
    """
    line = unknowns.number_of_side_unknowns
    waiting: dict[int, Floats] = {}

    def column_with_number(number: int) -> ColumnSubstructure:
        """The column with a number in the list of kinds; others of its batch wait for their use."""
        if number not in waiting:
            first = number - number % STRAIGHT_BEAM_COLUMNS_PER_BATCH
            along = whole.kinds.along[kinds[first : first + STRAIGHT_BEAM_COLUMNS_PER_BATCH]]
            parts = _condensed_elements_of_straight_beam_shoe(whole, along, layer)
            batch = condensed_element_column_stiffness(parts, unknowns)
            waiting.update(enumerate(batch, first))
        return ColumnSubstructure(waiting.pop(number), line, line)

    return {
        kind: ColumnSubstructureMadeWhenNeeded(
            unknowns.number_of_kept_unknowns, line, line, partial(column_with_number, number)
        )
        for number, kind in enumerate(kinds.tolist())
    }


def _condensed_elements_of_straight_beam_shoe(
    whole: _ShoeDividedIntoHpElements, along: Floats, layer: int
) -> Floats:
    """The stiffness (l, c, 8 p, 8 p) of elements of a straight beam, condensed to their boundary.

    Parameters
    ----------
    whole : the shoe
    along : (c, p + 1) positions of the nodes of each column along the lining
    layer : index of the first layer of elements; 0 is the layer at the lining's face
    """
    p = whole.div.degree
    place = function_from_depth_and_angle_to_point(whole.shoe, whole.radius)
    xy = node_coordinates_of_layers_and_columns(place, whole.div.depths[layer:], along, p)
    directions = None
    if whole.directed:
        part = whole.div.part[layer:]
        directions = _unit_vectors_along_shoe_layers(whole.layers, part, xy, p)
    return condensed_element_stiffness(xy, whole.elasticity[layer:], p, directions)


def displacement_axis_angles_at_contact_nodes(ends: Floats, p: int) -> Floats:
    """The angles (m p + 1,) of the axes in which displacements of contact nodes are measured.

    A node at an end of an element column has the angle of this end. A node inside a column has the
    angle of the column's middle. `ends` (m + 1,) are the angles of the ends of m columns, and p is
    the degree of the elements.
    """
    angles = np.append(np.repeat(0.5 * (ends[1:] + ends[:-1]), p), 0.0)
    angles[::p] = ends
    return angles


def displacement_axis_angles_of_shoe_at_positions(shoe: Shoe, phi: Floats) -> Floats:
    """The angles [rad] of the axes in which a shoe's displacements at positions phi are measured.

    The first axis is the radius on an arc and the plane's normal on a pad. A shoe with a straight
    beam has the axes of the shoe's frame, with the angle 0.
    """
    if isinstance(shoe.body, BeamBody):
        return np.zeros_like(phi)
    return np.full_like(phi, -0.5 * np.pi) if shoe.is_on_plane else phi


def rotation_angles_of_contact_nodes_to_shoe_frame(shoe: Shoe, div: ShoeElementDivision) -> Floats:
    """The angles (n,) [rad] that rotate the contact nodes' displacements to the shoe's frame.

    In the element columns the displacements are measured along the radius and around the drum.
    """
    angles = [
        displacement_axis_angles_at_contact_nodes(ends, div.degree)
        for ends in div.element_column_ends_on_each_lining
    ]
    return -displacement_axis_angles_of_shoe_at_positions(shoe, np.concatenate(angles))


def angles_of_contact_nodes_on_each_lining(div: ShoeElementDivision) -> list[Floats]:
    """The positions phi (n_k,) [rad] of the contact nodes on each lining."""
    return [
        node_positions_of_element_row(ends, div.degree)
        for ends in div.element_column_ends_on_each_lining
    ]


def condense_shoe_to_contact_nodes(
    shoe: Shoe,
    radius: float,
    div: ShoeElementDivision,
    layers: dict[str, ElasticLayer],
) -> CondensedShoe:
    """The shoe condensed to the rigid face at its hinge, and to its contact nodes by angle.

    Parameters
    ----------
    shoe : a parametric shoe
    radius : radius of the drum [m]
    div : division of the shoe into columns and layers of elements
    layers : elasticity of the layers by name

    Raises
    ------
    NoAnswer
        for a singular stiffness
    """
    phi = np.concatenate(angles_of_contact_nodes_on_each_lining(div))
    R = rigid_body_displacements_of_nodes(
        function_from_depth_and_angle_to_point(shoe, radius)(np.zeros(1), phi),
        shoe.pin_position_in_shoe_frame,
    )
    row = _condensed_hp_columns_of_shoe(shoe, radius, div, layers)
    if div.index_of_first_body_layer < div.number_of_element_layers and not any(row.grip):
        return _condense_shoe_that_hinge_holds(shoe, radius, div, row, R)
    S = (
        _contact_stiffness_of_shoe_with_back_in_grip(row, div)
        if any(row.grip)
        else _contact_stiffness_of_linings_on_rigid_body(row.under, div)
    )
    return condensed_shoe_with_gripped_or_bonded_back(
        shoe,
        rotate_node_axes_of_matrix(S, rotation_angles_of_contact_nodes_to_shoe_frame(shoe, div)),
        R,
    )


def condensed_shoe_with_gripped_or_bonded_back(shoe: Shoe, S: Floats, R: Floats) -> CondensedShoe:
    """The condensed shoe whose back is held by a grip, or is bonded to a rigid body.

    The actuation force then acts on the frame, which is the rigid grip or the rigid body. `S` (2n,
    2n) is the stiffness of the contact nodes while the frame is fixed, and `R` (2n, 3) are the
    rigid-body modes of the contact nodes.
    """
    zeros = np.zeros((len(R), DEGREES_OF_FREEDOM_OF_BODY_FRAME))
    return CondensedShoe(
        S=stiffness_of_hinge_face_and_contact_nodes(S, R),
        loads=np.vstack([np.eye(DEGREES_OF_FREEDOM_OF_BODY_FRAME), zeros]),
        work=np.zeros((DEGREES_OF_FREEDOM_OF_BODY_FRAME, DEGREES_OF_FREEDOM_OF_BODY_FRAME)),
        centre=shoe.pin_position_in_shoe_frame,
        rigid_mode_forces=zeros,
        force_imbalance=0.0,
        columns=ColumnsOfUnitLoads(((ACTUATION_LOAD_NAME, DEGREES_OF_FREEDOM_OF_BODY_FRAME),)),
    )


def _condense_shoe_that_hinge_holds(
    shoe: Shoe,
    radius: float,
    div: ShoeElementDivision,
    row: _CondensedElementColumnsOfShoe,
    R: Floats,
) -> CondensedShoe:
    """The condensed elastic shoe that is held by the hinge at one end and loaded at the other end.

    Parameters
    ----------
    shoe : a parametric shoe
    radius : radius of the drum [m]
    div : division of the shoe into columns and layers of elements
    row : element columns of the shoe
    R : (2n, 3) rigid-body modes of the contact nodes
    """
    faces = _hinge_face_modes_and_end_face_loads(shoe, radius, div)
    # The parts of the body before and behind the lining are attached to the first and the last
    # column under the lining. The assembled columns have the unknowns [rigid face at the hinge |
    # contact nodes | unit loads].
    columns = row.under.copy()
    columns[0] = _join_first_lining_column_with_body_at_hinge(
        columns[0], row.before, faces.hinge_modes
    )
    loaded = condensed_stiffness_of_body_beyond_lining_end(row.after, faces.end_forces)
    columns[-1] = eliminate_nodes_on_column_side(
        columns[-1], loaded, len(faces.end_forces), right=True
    )
    A = _contact_node_stiffness_from_element_columns(columns, div)
    back = rotation_angles_of_contact_nodes_to_shoe_frame(shoe, div)

    def contact_forces_converted_to_shoe_frame(V: Floats) -> Floats:
        """The forces (m, 2n) on the contact nodes, with their components in the shoe's frame."""
        return rotate_node_axes_of_vectors(V, back)

    def contact_stiffness_converted_to_shoe_frame(S: Floats) -> Floats:
        """The stiffness (2n, 2n) of the contact nodes, with components in the shoe's frame."""
        return rotate_node_axes_of_matrix(S, back)

    return condensed_shoe_corrected_for_round_off(
        A,
        faces.end,
        R,
        shoe.pin_position_in_shoe_frame,
        contact_forces_converted_to_shoe_frame,
        contact_stiffness_converted_to_shoe_frame,
    )


class _EndFaceModesAndUnitLoads(NamedTuple):
    """The rigid-body modes and the unit loads on the two end faces of a shoe's body.

    Attributes
    ----------
    hinge_modes : (2n, 3) rigid-body modes of the n nodes on the face that the hinge holds
    end : the unit loads on the loaded end face
    end_forces : (2n, l) nodal forces of these unit loads, in the axes of the element columns
    """

    hinge_modes: Floats
    end: UnitLoadsOnLoadedEndFace
    end_forces: Floats


def _hinge_face_modes_and_end_face_loads(
    shoe: Shoe, radius: float, div: ShoeElementDivision
) -> _EndFaceModesAndUnitLoads:
    """The rigid-body modes of the face at the hinge, and the unit loads on the loaded end face.

    Modes and nodal forces are measured in the axes of the element columns. `div` divides the shoe
    into columns and layers of elements, and `radius` [m] is the drum's radius.
    """
    place = function_from_depth_and_angle_to_point(shoe, radius)
    depths = node_positions_of_element_row(div.depths[div.index_of_first_body_layer :], div.degree)
    near, far = div.column_ends_before_lining[-1], div.column_ends_behind_lining[-1]
    end = unit_actuation_loads_on_end_face(place(depths, far), depths, div.degree)
    return _EndFaceModesAndUnitLoads(
        rotate_axes_of_all_nodes_by_one_angle(
            rigid_body_displacements_of_nodes(place(depths, near), shoe.pin_position_in_shoe_frame),
            displacement_axis_angles_of_shoe_at_positions(shoe, near),
        ),
        end,
        rotate_axes_of_all_nodes_by_one_angle(
            end.forces, displacement_axis_angles_of_shoe_at_positions(shoe, far)
        ),
    )


def condensed_shoe_corrected_for_round_off(
    A: Floats,
    end: UnitLoadsOnLoadedEndFace,
    R: Floats,
    pin: Floats,
    forces_in_frame: Callable[[Floats], Floats],
    stiffness_in_frame: Callable[[Floats], Floats],
) -> CondensedShoe:
    """The condensed shoe from its assembled element columns, with round-off errors corrected.

    Because of round-off the condensed loads are not quite in equilibrium with their reactions, and
    rigid-body motions cause small forces. Both errors are corrected.

    Parameters
    ----------
    A : stiffness of the assembled columns, with the unknowns [rigid face at the hinge | contact |
        unit loads]
    end : the unit loads on the loaded end face
    R : (2n, 3) rigid-body modes of the contact nodes
    pin : (2,) point about which the rigid face at the hinge turns [m]
    forces_in_frame : function that converts forces (m, .) on the contact's unknowns in `A` to
        forces (m, 2n) on the contact nodes along the axes of the shoe
    stiffness_in_frame : function that converts the stiffness on the contact's unknowns to the
        stiffness (2n, 2n) along the axes of the shoe
    """
    extra = end.columns.number_of_load_columns
    frame, contact, loads = (
        slice(DEGREES_OF_FREEDOM_OF_BODY_FRAME),
        slice(DEGREES_OF_FREEDOM_OF_BODY_FRAME, -extra),
        slice(-extra, None),
    )
    load = -forces_in_frame(A[loads, contact]).T
    held = forces_in_frame(A[frame, contact]).T
    on_frame, work = -A[frame, loads], -A[loads, loads]
    # The stiffness of a shoe with a width takes hundreds of megabytes. It is converted and
    # corrected in its place, so that no second matrix of its size exists at any time.
    S = A[contact, contact]
    S[:] = stiffness_in_frame(S)

    # Small forces on the contact nodes are added to the loads. Loads and reactions are then in
    # equilibrium.
    imbalance = end.forces_and_moments_of_unit_loads_about_pin(pin) - on_frame - R.T @ load
    load += R @ np.linalg.solve(R.T @ R, imbalance)
    round_off_forces = correct_strain_in_rigid_motion_of_contact_stiffness(S, R, held)
    actuation = end.columns.column_slice_of_each_load[ACTUATION_LOAD_NAME]
    whole = A[:-extra, :-extra]
    write_stiffness_of_hinge_face(whole, R)
    return CondensedShoe(
        S=whole,
        loads=np.concatenate([on_frame, load]),
        work=work,
        centre=end.centre,
        rigid_mode_forces=round_off_forces,
        force_imbalance=float(np.abs(imbalance[:2, actuation][:, :2]).max()),
        columns=end.columns,
    )


def _contact_stiffness_of_lining_with_back_in_grip(
    row: list[AnyColumnSubstructure],
    div: ShoeElementDivision,
    left: Floats | None = None,
    right: Floats | None = None,
) -> Floats:
    """The stiffness of the contact nodes of a lining whose back is held by a grip.

    Parameters
    ----------
    row : element columns under the lining, or under several linings and in the slots between them
    div : division of the shoe into columns and layers of elements
    left, right : condensed stiffness of the parts of the body beyond the lining's start and end;
        None if the body ends there
    """
    row = row.copy()
    row[0] = eliminate_nodes_on_column_side(row[0], left, 0 if left is None else len(left))
    row[-1] = eliminate_nodes_on_column_side(
        row[-1], right, 0 if right is None else len(right), right=True
    )
    return _contact_node_stiffness_from_element_columns(row, div)


def _contact_stiffness_of_linings_on_rigid_body(
    row: list[AnyColumnSubstructure], div: ShoeElementDivision
) -> Floats:
    """The stiffness of the contact nodes of one or several linings on a rigid body.

    The linings do not touch each other, so that no stiffness couples their nodes. `row` are the
    element columns under all linings, and `div` is the division of the shoe.
    """
    blocks, count = [], 0
    for first, last in div.element_column_range_of_each_lining:
        own = row[count : count + last - first]
        count += last - first
        own[0] = eliminate_nodes_on_column_side(own[0])
        own[-1] = eliminate_nodes_on_column_side(own[-1], right=True)
        blocks.append(assemble_and_condense_row_of_element_columns(own, 2).K)
    S = np.zeros((sum(map(len, blocks)),) * 2)
    count = 0
    for block in blocks:
        own_unknowns = slice(count, count + len(block))
        S[own_unknowns, own_unknowns] = block
        count += len(block)
    return S


def _contact_node_stiffness_from_element_columns(
    columns: list[AnyColumnSubstructure], div: ShoeElementDivision
) -> Floats:
    """The stiffness of all contact nodes, assembled from the columns under linings and in slots.

    The body in a slot between two linings is attached to the last column of the lining before the
    slot. The linings and slots before a lining, already assembled, are attached to its first
    column.

    Parameters
    ----------
    columns : element columns in the order of their positions. The nodes on the left side of the
        first column and on the right side of the last column are eliminated already; other
        unknowns, such as the motions of the rigid face at the hinge, may stand in their place.
    div : division of the shoe into columns and layers of elements
    """
    before: ColumnSubstructure | None = None
    for k, (first, last) in enumerate(div.element_column_range_of_each_lining):
        own = columns[first:last]
        if before is not None:
            own[0] = eliminate_nodes_on_column_side(own[0], before.K, before.right)
        if k < len(div.slots):
            slot = assemble_and_condense_row_of_element_columns(columns[slice(*div.slots[k])], 0)
            last_column = eliminate_nodes_on_column_side(own[-1], slot.K, slot.left, right=True)
            own[-1] = last_column._replace(right=slot.right)
        before = assemble_and_condense_row_of_element_columns(own, 2)
    assert before is not None
    return before.K


def _contact_stiffness_of_shoe_with_back_in_grip(
    columns: _CondensedElementColumnsOfShoe, div: ShoeElementDivision
) -> Floats:
    """The stiffness of the contact nodes of a shoe whose body is held by a grip on its back.

    The parts of the body beyond the lining are free.
    """
    row, (first, last) = columns.under.copy(), columns.grip
    # At each end of the grip the node at the shoe's back is fixed. The neighbouring column outside
    # the grip loses the two unknowns of this node, the last ones on its side.
    if first > 0:
        K, left, right = row[first - 1].made
        row[first - 1] = ColumnSubstructure(K[:-2, :-2], left, right - 2)
    if last < len(row):
        K, left, right = row[last].made
        line = left - 2
        free = np.delete(np.arange(len(K)), [line, line + 1])
        row[last] = ColumnSubstructure(K[free[:, None], free], line, right)
    # The parts of the body beyond the lining are condensed to the nodes at the end of the lining.
    before, after = columns.before, columns.after
    body_before = (
        eliminate_nodes_on_column_side(assemble_and_condense_row_of_element_columns(before, 0)).K
        if before
        else None
    )
    body_after = (
        eliminate_nodes_on_column_side(
            assemble_and_condense_row_of_element_columns(after, 0), right=True
        ).K
        if after
        else None
    )
    return _contact_stiffness_of_lining_with_back_in_grip(row, div, body_before, body_after)


def _join_first_lining_column_with_body_at_hinge(
    first: AnyColumnSubstructure, before: list[AnyColumnSubstructure], held: Floats
) -> ColumnSubstructure:
    """The first element column under the lining, joined with the body between lining and hinge.

    The unknowns on the left side of the column are replaced by the unknowns of the frame, the rigid
    face that the hinge holds. The result has the unknowns [frame | contact | right side].

    Parameters
    ----------
    first : the first column under the lining
    before : columns of the body before the lining, from the hinge on
    held : (n, 3) rigid-body modes of the nodes on the face that the hinge holds
    """
    if not before:
        return eliminate_nodes_on_column_side(_constrain_element_column_side_to_hinge(first, held))
    body = assemble_and_condense_row_of_element_columns(
        [_constrain_element_column_side_to_hinge(before[0], held), *before[1:]], 0
    )
    return eliminate_nodes_on_column_side(first, body.K, len(held))


def condensed_stiffness_of_body_beyond_lining_end(
    after: Sequence[AnyColumnSubstructure], load: Floats
) -> Floats:
    """The condensed stiffness of the part of a shoe's body behind the lining, with its unit loads.

    It is the stiffness on the nodes at the lining's end and on the factors of the unit loads.
    `after` are the element columns of this part of the body, and `load` (n, l) the unit loads on
    the nodes of its end face.
    """
    part, count = load.shape
    end = np.zeros((part + count, part + count))
    end[:part, part:], end[part:, :part] = -load, -load.T
    if not after:
        return end
    last = eliminate_nodes_on_column_side(after[-1], end, part, right=True)
    return assemble_and_condense_row_of_element_columns([*after[:-1], last], 0).K


def _constrain_element_column_side_to_hinge(
    piece: AnyColumnSubstructure, held: Floats
) -> ColumnSubstructure:
    """The element column next to the hinge, with its nodes on the hinge face tied to the frame.

    The frame is the rigid face that the hinge holds. Of the unknowns on the column's left side the
    first belong to the lining and stay. The last n belong to the body and move with the frame, by
    the rigid-body modes `held` (n, 3). The unknowns of the result are [lining part of the left side
    | frame | other unknowns].
    """
    piece = piece.made
    left = piece.left - len(held)
    at, frame = slice(left, piece.left), slice(left, left + DEGREES_OF_FREEDOM_OF_BODY_FRAME)
    rest = np.arange(len(piece.K) - len(held))
    others, n = rest.copy(), len(rest) + DEGREES_OF_FREEDOM_OF_BODY_FRAME
    rest[left:] += len(held)
    others[left:] += DEGREES_OF_FREEDOM_OF_BODY_FRAME
    K = np.empty((n, n))
    K[others[:, None], others] = piece.K[rest[:, None], rest]
    K[frame, frame] = held.T @ piece.K[at, at] @ held
    K[frame, others] = held.T @ piece.K[at][:, rest]
    K[others, frame] = K[frame, others].T
    return ColumnSubstructure(K, left, piece.right)


def correct_strain_in_rigid_motion_of_contact_stiffness(
    S: Floats, R: Floats, held: Floats
) -> Floats:
    """Correct the stiffness of the contact nodes in place: rigid-body modes then cause no strain.

    Returns an estimate (2n, 3) of the forces on the contact nodes that the three rigid-body modes
    of the shoe cause by round-off alone.

    The frame is the rigid face that the hinge holds. If the frame makes a unit motion while the
    contact nodes are fixed, the forces `held` act on the contact nodes. If the contact nodes move
    with the frame by the modes R, no force acts on them: S R + held = 0.

    The forces `held` are small compared with the stiffness of thin columns, and have more correct
    digits. The first correction changes the 2 x 2 block of each node, which has the fewest correct
    digits. The second correction is the least symmetric change after which S R + held = 0 exactly.
    The rest of the stiffness is likely to be wrong by as much as the residual S R + held before
    both corrections. This residual is therefore the estimate of the forces due to round-off.

    Parameters
    ----------
    S : (2n, 2n) stiffness of the contact nodes
    R : (2n, 3) rigid-body modes of the contact nodes
    held : (2n, 3) forces on the contact nodes due to unit motions of the frame, while the contact
        nodes are fixed
    """
    # The first correction changes the 2 x 2 block of each node.
    own = np.arange(len(S)).reshape(-1, 2)
    before = S @ R + held
    node = before[:, :2].reshape(-1, 2, 2)
    S[own[:, :, None], own[:, None]] -= 0.5 * (node + node.swapaxes(1, 2))
    # The second correction is a symmetric change of the whole matrix. With the matrices
    # `back` = R (R^T R)^-1, `after` and Z = after - back (R^T after + after^T R) / 4 it is
    # back Z^T + Z back^T.
    after = S @ R + held
    back = R @ np.linalg.inv(R.T @ R)
    moment = R.T @ after
    part = after - 0.25 * back @ (moment + moment.T)
    left, right = np.hstack([back, part]), np.hstack([part, back])
    for start in range(0, len(S), CONTACT_STIFFNESS_ROWS_CHANGED_TOGETHER):
        rows = slice(start, start + CONTACT_STIFFNESS_ROWS_CHANGED_TOGETHER)
        S[rows] -= left[rows] @ right.T
    return before


def stiffness_of_hinge_face_and_contact_nodes(S: Floats, R: Floats) -> Floats:
    """The stiffness on the frame and the contact nodes, from the stiffness S on the contact nodes.

    The frame is the rigid face that the hinge holds; its three motions are the first unknowns. S
    (2n, 2n) alone is enough: no forces arise if frame and contact nodes move together as a rigid
    body, by the modes R (2n, 3).
    """
    count = DEGREES_OF_FREEDOM_OF_BODY_FRAME + len(S)
    whole = np.empty((count, count))
    whole[DEGREES_OF_FREEDOM_OF_BODY_FRAME:, DEGREES_OF_FREEDOM_OF_BODY_FRAME:] = S
    write_stiffness_of_hinge_face(whole, R)
    return whole


def write_stiffness_of_hinge_face(whole: Floats, R: Floats) -> None:
    """Write the rows and columns of the frame into a stiffness on the frame and the contact nodes.

    `whole` (3 + 2n, 3 + 2n) has the stiffness on the contact nodes in its last rows and columns.
    `R` (2n, 3) and the frame are those of `stiffness_of_hinge_face_and_contact_nodes`.
    """
    frame, contact = (
        slice(DEGREES_OF_FREEDOM_OF_BODY_FRAME),
        slice(DEGREES_OF_FREEDOM_OF_BODY_FRAME, None),
    )
    SR = whole[contact, contact] @ R
    whole[frame, frame] = R.T @ SR
    whole[frame, contact] = -SR.T
    whole[contact, frame] = -SR


def rotate_axes_of_all_nodes_by_one_angle(V: Floats, angle: Floats) -> Floats:
    """The vectors V (2n, m), with the components of all nodes in axes turned by `angle` [rad]."""
    return rotate_node_axes_of_vectors(V.T, np.reshape(angle, 1)).T
