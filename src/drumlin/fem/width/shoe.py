"""A parametric shoe with a width, condensed to its frame, its contact face and its unit loads.

The frame is the face of the shoe that its hinge holds; it moves as a rigid body. The section is
divided into columns, which are stacks of hp elements from the contact through the thickness of the
shoe (hp.columns).
"""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.brake.brake import Shoe
from drumlin.brake.fields import Material
from drumlin.fem.hp.columns import (
    AnyColumnSubstructure,
    ColumnSubstructure,
    ColumnSubstructureMadeWhenNeeded,
    assemble_and_condense_row_of_element_columns,
    column_with_contact_nodes_at_its_ends_only,
    eliminate_nodes_on_column_side,
    rotate_node_axes_of_matrix,
    rotate_node_axes_of_vectors,
)
from drumlin.fem.hp.division import ShoeElementDivision
from drumlin.fem.hp.element import replace_matrix_by_schur_complement
from drumlin.fem.hp.shoe import (
    CondensedShoe,
    UnitLoadsOnLoadedEndFace,
    condensed_shoe_corrected_for_round_off,
    condensed_shoe_with_gripped_or_bonded_back,
    condensed_stiffness_of_body_beyond_lining_end,
    displacement_axis_angles_of_shoe_at_positions,
    function_from_depth_and_angle_to_point,
    group_equal_element_columns_of_shoe,
    node_coordinates_of_layers_and_columns,
    node_positions_of_element_row,
    rotate_axes_of_all_nodes_by_one_angle,
    rotation_angles_of_contact_nodes_to_shoe_frame,
    unit_actuation_loads_on_end_face,
)
from drumlin.fem.preparation.meshes import materials_and_widths_of_shoe_parts
from drumlin.fem.substructure.body import (
    DEGREES_OF_FREEDOM_OF_BODY_FRAME,
    rigid_body_displacements_of_nodes,
)
from drumlin.fem.width.columns import (
    ConditionAtEdgeFarthestFromContact,
    LayersOfElementColumn,
    column_beside_grip_with_shared_node_held,
    condense_element_columns_of_any_shape,
    condense_mirror_symmetric_columns,
    indices_of_unknowns_along_symmetric_half_row,
    layers_of_element_column_from_half_widths,
)
from drumlin.fem.width.functions import (
    FunctionsAcrossWidth,
    IntegralsOverWidth,
    half_widths_of_parts,
    integrals_of_function_products_over_width,
    matrix_from_node_values_to_function_factors,
)
from drumlin.fem.width.integrals import (
    SYMMETRY_NUMBERS_OF_COLUMN_DISPLACEMENTS,
    ElementIntegralsOverShoeSection,
    LameConstants,
    angular_factors_of_section_integrals,
    cross_section_integrals_between_circles,
    cross_section_integrals_of_any_shape,
)

MOST_BYTES_OF_COLUMNS_MADE_TOGETHER = 32_000_000
"""Largest memory [bytes] of condensed columns under a lining that are computed all at once.

If the columns need more, each one is computed when it is joined with its neighbours. All at once
takes less time for small columns, and it takes two to three times this memory while it lasts.
"""


FACE_STIFFNESS_ROWS_CONVERTED_TOGETHER = 256
"""Number of rows of a face's stiffness that are converted to other unknowns at the same time."""


class ElementLayersWithWidthFunctions(NamedTuple):
    """The element layers of a shoe, counted from the contact, with functions across the width.

    Attributes
    ----------
    functions : the functions across the width of the shoe
    halves : (l,) half width of each layer [m]
    lame : (l,) Lame constants of each layer
    """

    functions: FunctionsAcrossWidth
    halves: tuple[float, ...]
    lame: tuple[LameConstants, ...]

    def width_function_integrals_of_layers(self, first: int) -> list[IntegralsOverWidth]:
        """Integrals over the width for each layer from number `first` on.

        Layers are counted from the contact.
        """
        return [
            integrals_of_function_products_over_width(self.functions, half)
            for half in self.halves[first:]
        ]

    def layers_of_element_column_from_given_layer(
        self, p: int, first: int, *, contact: bool, back: ConditionAtEdgeFarthestFromContact
    ) -> LayersOfElementColumn:
        """The layers of an element column whose first layer is the shoe's layer `first`.

        Layers are counted from the contact. The other parameters are those of
        `layers_of_element_column_from_half_widths`.
        """
        return layers_of_element_column_from_half_widths(
            self.functions, self.halves[first:], p, contact=contact, back=back
        )

    def unknowns_across_body_thickness(
        self, div: ShoeElementDivision
    ) -> "UnknownsAcrossBodyThickness":
        """The unknowns on a line of nodes through the thickness of the body."""
        stack = self.layers_of_element_column_from_given_layer(
            div.degree,
            div.index_of_first_body_layer,
            contact=False,
            back=ConditionAtEdgeFarthestFromContact.FREE,
        )
        line = stack.unknowns_on_left_or_right_side_of_column(
            indices_of_unknowns_along_symmetric_half_row(div.degree, 0).left
        )
        z, component, row, function = np.array(line, dtype=int).reshape(-1, 4).T
        return UnknownsAcrossBodyThickness(z, component, row, function)

    def unit_loads_on_end_face(
        self, div: ShoeElementDivision, xy: Floats, angle: Floats
    ) -> "UnitLoadsOnEndFaceWithWidth":
        """The unit loads on the loaded end face of the body, uniform over the width of each layer.

        Parameters
        ----------
        div : division of the shoe
        xy : (2, rows) coordinates of the nodes of the end face [m]
        angle : angle by which the axes of the face's displacements are turned from the shoe's frame
            [rad]
        """
        first, p, line = (
            div.index_of_first_body_layer,
            div.degree,
            self.unknowns_across_body_thickness(div),
        )
        depths = node_positions_of_element_row(div.depths[first:], p)
        # A load acts on each even function in proportion to the function's integral over the width
        # of the layer. Functions that belong to wider layers only are zero there.
        share = np.zeros((len(self.halves) - first, line.function[line.z == 0].max() + 1))
        for row, half in zip(share, self.halves[first:], strict=True):
            even = integrals_of_function_products_over_width(self.functions, half).even[0]
            row[: len(even)] = even / even[0]
        forces = [unit_actuation_loads_on_end_face(xy, depths, p, own).forces for own in share.T]
        turned = [rotate_axes_of_all_nodes_by_one_angle(own, angle) for own in forces]
        return UnitLoadsOnEndFaceWithWidth(
            unit_actuation_loads_on_end_face(xy, depths, p),
            line.values_on_unknowns_of_thickness_line(turned),
        )


class UnitLoadsOnEndFaceWithWidth(NamedTuple):
    """The unit loads on the end face of a shoe with a width.

    `end` has the unit loads on the end face of the plane section: force x, force y and couple.
    `forces` (n, 3) are the same three loads as forces on the n unknowns of the shoe's
    `UnknownsAcrossBodyThickness`.
    """

    end: UnitLoadsOnLoadedEndFace
    forces: Floats


class UnknownsAcrossBodyThickness(NamedTuple):
    """The n unknowns on a line of nodes through the thickness of a shoe's body, as arrays (n,).

    Attributes
    ----------
    z : 1 for a displacement along z, across the width; 0 for a displacement in the section
    component : 0 for a displacement along the radius, 1 for a displacement around the drum
    row : index of the row of nodes, counted from the body's face towards the lining
    function : index of the function across the width
    """

    z: Ints
    component: Ints
    row: Ints
    function: Ints

    def values_on_unknowns_of_thickness_line(self, by_function: Sequence[Floats]) -> Floats:
        """Values (n, m) on the unknowns of the line from values on nodes for each even function.

        `by_function` has an array (2 rows, m) for each of the first even functions, with the values
        x and y at the line's nodes. The values of all other functions, and all values along z, are
        0.
        """
        found = np.zeros((len(self.z), by_function[0].shape[1]))
        for function, vectors in enumerate(by_function):
            of = (self.z == 0) & (self.function == function)
            found[of] = vectors[2 * self.row[of] + self.component[of]]
        return found


def layers_with_width_functions(
    shoe: Shoe, div: ShoeElementDivision, functions: FunctionsAcrossWidth
) -> ElementLayersWithWidthFunctions:
    """The element layers of a divided shoe, with their Lame constants and functions of z.

    All parts of the shoe are isotropic.
    """
    halves, lame = half_widths_of_parts(shoe), {}
    for name, (material, _) in materials_and_widths_of_shoe_parts(shoe).items():
        # `prepare.reason_why_width_model_does_not_apply` refuses brakes with orthotropic materials.
        assert isinstance(material, Material)
        E, nu = material.E, material.nu
        # With degree 0 across the width, lambda has its value for plane stress. With higher degrees
        # it has its value for a solid.
        free = E * nu / (1 - nu**2)
        solid = E * nu / ((1 + nu) * (1 - 2 * nu)) if functions.degree > 0 else free
        lame[name] = LameConstants(solid, E / (2 * (1 + nu)))
    return ElementLayersWithWidthFunctions(
        functions,
        tuple(halves[name] for name in div.part),
        tuple(lame[name] for name in div.part),
    )


class _CondensedColumnsUnderAndBesideLining(NamedTuple):
    """The columns of elements of a shoe: under the lining, before the lining and behind the lining.

    `grip` has the indices of the first column in the grip and of the first column behind it,
    counted from the first column under the lining. Both are 0 without a grip.
    """

    under: list[AnyColumnSubstructure]
    before: list[ColumnSubstructure]
    after: list[ColumnSubstructure]
    grip: tuple[int, int]

    @property
    def first_and_last_column_under_lining(self) -> tuple[ColumnSubstructure, ColumnSubstructure]:
        """The first and the last column under the lining; equal columns are computed once."""
        first, last = self.under[0], self.under[-1]
        made = first.made
        return made, (made if last is first else last.made)


MakeCondensedColumnsFunction = Callable[
    [Ints, int, LayersOfElementColumn], list[ColumnSubstructure]
]
"""The type of a function that makes one condensed column of elements for each given kind.

Columns of one kind have equal shape. The arguments are the kinds (c,), the index of the columns'
first layer, counted from the contact, and the layers of the columns.
"""


def _function_that_makes_columns_and_kind_of_each_column(
    shoe: Shoe, radius: float, div: ShoeElementDivision, layers: ElementLayersWithWidthFunctions
) -> tuple[MakeCondensedColumnsFunction, Ints]:
    """The function that makes the columns of a shoe's elements, and the kind of each column.

    Columns of one kind have equal shape and equal stiffness.
    """
    p = div.degree
    kinds_of_columns = group_equal_element_columns_of_shoe(shoe, div, directed=False)
    along = kinds_of_columns.along
    plane = radius if shoe.is_on_plane else None
    radii = radius - shoe.sign_internal_plus_external_minus * div.depths

    def condense_columns_on_arc(
        kinds: Ints, first: int, stack: LayersOfElementColumn
    ) -> list[ColumnSubstructure]:
        """One condensed column of elements for each of `kinds`, with the layers from `first` on.

        `MakeCondensedColumnsFunction` explains the parameters. The layers lie between circles or,
        in a flat shoe, between planes.

        Each column is its own mirror image, so that its symmetric and its antisymmetric
        displacements are condensed separately.
        """
        parts: list[list[ElementIntegralsOverShoeSection]] = []
        for symmetry in SYMMETRY_NUMBERS_OF_COLUMN_DISPLACEMENTS:
            angular = angular_factors_of_section_integrals(
                along[kinds], p, symmetry, flat=shoe.is_on_plane
            )
            parts.append(
                [
                    cross_section_integrals_between_circles(
                        radii[k], radii[k + 1], layers.lame[k], angular, p, plane
                    )
                    for k in range(first, div.number_of_element_layers)
                ]
            )
        return condense_mirror_symmetric_columns(
            parts, layers.width_function_integrals_of_layers(first), stack
        )

    def condense_columns_of_any_cell_shape(
        kinds: Ints, first: int, stack: LayersOfElementColumn
    ) -> list[ColumnSubstructure]:
        """Condensed columns of elements of any shape, for example under a straight beam.

        `MakeCondensedColumnsFunction` explains the parameters.
        """
        xy = node_coordinates_of_layers_and_columns(
            function_from_depth_and_angle_to_point(shoe, radius),
            div.depths[first:],
            along[kinds],
            p,
        )
        lame = layers.lame[first:]
        parts = [
            cross_section_integrals_of_any_shape(own, each, p)
            for own, each in zip(xy, lame, strict=True)
        ]
        return condense_element_columns_of_any_shape(
            parts, layers.width_function_integrals_of_layers(first), stack
        )

    made = (
        condense_columns_of_any_cell_shape
        if kinds_of_columns.angular is None
        else condense_columns_on_arc
    )
    return made, kinds_of_columns.which


def _columns_made_at_once(
    make: MakeCondensedColumnsFunction, row: Ints, first: int, stack: LayersOfElementColumn
) -> list[ColumnSubstructure]:
    """The condensed columns of a row, each kind of column condensed once.

    `row` has the kind of each column. The other parameters are those of `make`.
    """
    if not len(row):
        return []
    kinds = np.flatnonzero(np.bincount(row))
    made = dict(zip(kinds.tolist(), make(kinds, first, stack), strict=True))
    return [made[kind] for kind in row.tolist()]


def _columns_made_at_once_or_when_needed(
    make: MakeCondensedColumnsFunction, row: Ints, stack: LayersOfElementColumn
) -> Sequence[AnyColumnSubstructure]:
    """The condensed columns of a row under the lining, of which large ones are not computed yet.

    `row` has the kind of each column. The other parameters are those of `make`.
    """
    line = stack.number_of_unknowns_on_each_side
    unknowns = 2 * line + stack.number_of_unknowns_of_contact
    kinds = np.unique(row).tolist()
    if 8 * unknowns**2 * len(kinds) <= MOST_BYTES_OF_COLUMNS_MADE_TOGETHER:
        return _columns_made_at_once(make, row, 0, stack)

    def make_column_of_kind(kind: int) -> ColumnSubstructure:
        """The condensed column of a kind."""
        return make(np.array([kind]), 0, stack)[0]

    later = {
        kind: ColumnSubstructureMadeWhenNeeded(
            unknowns, line, line, partial(make_column_of_kind, kind)
        )
        for kind in kinds
    }
    return [later[kind] for kind in row.tolist()]


def _condensed_element_columns_of_shoe(
    shoe: Shoe, radius: float, div: ShoeElementDivision, layers: ElementLayersWithWidthFunctions
) -> _CondensedColumnsUnderAndBesideLining:
    """The condensed columns of elements of a shoe.

    The parameters are those of `condense_shoe_with_width`, and `layers` are the shoe's layers.
    """
    p = div.degree
    make, which = _function_that_makes_columns_and_kind_of_each_column(shoe, radius, div, layers)

    def layers_of_column(
        first: int, *, contact: bool, back: ConditionAtEdgeFarthestFromContact
    ) -> LayersOfElementColumn:
        """The layers from index `first` on of a column, see `LayersOfElementColumn`."""
        return layers.layers_of_element_column_from_given_layer(
            p, first, contact=contact, back=back
        )

    under, before = len(div.angles) - 1, len(div.column_ends_before_lining) - 1
    # A grip on the back of a shoe holds the columns a to b - 1; without a grip a = b = 0.
    ends = shoe.interval_of_body_back_held_by_support(radius)
    a, b = (0, 0) if ends is None else (int(np.abs(div.angles - x).argmin()) for x in ends)
    back = (
        ConditionAtEdgeFarthestFromContact.BONDED
        if div.index_of_first_body_layer == div.number_of_element_layers
        else ConditionAtEdgeFarthestFromContact.FREE
    )
    free = _columns_made_at_once_or_when_needed(
        make,
        np.concatenate([which[:a], which[b:under]]),
        layers_of_column(0, contact=True, back=back),
    )
    gripped = _columns_made_at_once_or_when_needed(
        make,
        which[a:b],
        layers_of_column(0, contact=True, back=ConditionAtEdgeFarthestFromContact.GRIPPED),
    )
    first = div.index_of_first_body_layer
    rest = _columns_made_at_once(
        make,
        which[under:],
        first,
        layers_of_column(first, contact=False, back=ConditionAtEdgeFarthestFromContact.FREE),
    )
    row = [*free[:a], *gripped, *free[a:]]
    # A column beside the grip shares one of its sides with a gripped column. The grip holds the
    # node of this side that is farthest from the contact.
    stack = layers_of_column(0, contact=True, back=ConditionAtEdgeFarthestFromContact.FREE)
    if a < b and a > 0:
        row[a - 1] = column_beside_grip_with_shared_node_held(row[a - 1].made, stack, right=True)
    if a < b < under:
        row[b] = column_beside_grip_with_shared_node_held(row[b].made, stack, right=False)
    row = _columns_of_which_some_keep_end_nodes_only(row, div.open_columns, stack)
    return _CondensedColumnsUnderAndBesideLining(row, rest[:before], rest[before:], (a, b))


def _columns_of_which_some_keep_end_nodes_only(
    row: Sequence[AnyColumnSubstructure], chosen: Sequence[int], stack: LayersOfElementColumn
) -> list[AnyColumnSubstructure]:
    """The columns of a row, of which those with the indices `chosen` keep fewer contact nodes.

    Of their contact nodes these columns keep the two at their ends. `stack` has the layers of the
    columns. Columns that are the same object in `row` are the same object in the result.
    """
    found = list(row)
    shared = stack.number_of_unknowns_of_contact // (stack.p + 1)
    by_identity: dict[int, AnyColumnSubstructure] = {}
    for column in chosen:
        key = id(row[column])
        if key not in by_identity:
            by_identity[key] = column_with_contact_nodes_at_its_ends_only(row[column], shared)
        found[column] = by_identity[key]
    return found


def condense_shoe_with_width(
    shoe: Shoe,
    radius: float,
    div: ShoeElementDivision,
    functions: FunctionsAcrossWidth,
) -> CondensedShoe:
    """Condense a shoe with a width to its frame and to the nodes of its contact face.

    The nodes of the face are sorted by angle, and at each angle by distance from the mid-plane; the
    distances are `FunctionsAcrossWidth.node_distances_across_half_width_of_part`. x and y of a node
    are neighbours. The angles are those of the nodes
    `ShoeElementDivision.indices_of_kept_contact_nodes`.

    Parameters
    ----------
    shoe : a parametric shoe
    radius : radius of the drum [m]
    div : division of the section into hp elements
    functions : functions across the width

    Raises
    ------
    NoAnswer
        for a singular stiffness
    """
    layers = layers_with_width_functions(shoe, div, functions)
    row = _condensed_element_columns_of_shoe(shoe, radius, div, layers)
    count = layers.functions.counts_of_even_and_odd_functions_on_part(layers.halves[0])[0]
    phi = node_positions_of_element_row(div.angles, div.degree)[div.indices_of_kept_contact_nodes]
    xy = np.repeat(
        function_from_depth_and_angle_to_point(shoe, radius)(np.zeros(1), phi), count, axis=1
    )
    R = rigid_body_displacements_of_nodes(xy, shoe.pin_position_in_shoe_frame)
    if div.index_of_first_body_layer < div.number_of_element_layers and not any(row.grip):
        return _condense_hinged_shoe_with_width(shoe, radius, div, layers, row, R)
    # If a grip holds the back, the body's parts before and behind the lining bear no load. Each
    # part is condensed to the nodes at which it joins the columns under the lining.
    ends: list[Floats | None] = [None, None]
    if any(row.grip):
        if row.before:
            joined = assemble_and_condense_row_of_element_columns(row.before, 0)
            ends[0] = eliminate_nodes_on_column_side(joined).K
        if row.after:
            joined = assemble_and_condense_row_of_element_columns(row.after, 0)
            ends[1] = eliminate_nodes_on_column_side(joined, right=True).K
    columns = row.under.copy()
    first, last = (0 if end is None else len(end) for end in ends)
    at_start, at_end = row.first_and_last_column_under_lining
    columns[0] = eliminate_nodes_on_column_side(at_start, ends[0], first)
    columns[-1] = eliminate_nodes_on_column_side(at_end, ends[1], last, right=True)
    del at_start, at_end
    S = assemble_and_condense_row_of_element_columns(columns, 2 * count).K
    face = _ConversionFromColumnsToContactFace.conversion_to_displacements_of_face_nodes(
        shoe, div, layers
    )
    return condensed_shoe_with_gripped_or_bonded_back(shoe, face.stiffness_of_face_nodes(S), R)


class _ConversionFromColumnsToContactFace(NamedTuple):
    """The conversion between the contact unknowns of columns and the nodes of the contact face.

    The contact unknowns of columns are factors of functions of z, for displacements along the
    radius and around the drum. The nodes of the face have displacements x and y in the shoe's
    frame.

    Attributes
    ----------
    angles : (n functions,) angles [rad] from the axes of the columns to the axes of the frame
    inverse : matrix (functions, nodes) that converts values at the nodes across the width to
        factors of the functions
    """

    angles: Floats
    inverse: Floats

    @classmethod
    def conversion_to_displacements_of_face_nodes(
        cls, shoe: Shoe, div: ShoeElementDivision, layers: ElementLayersWithWidthFunctions
    ) -> "_ConversionFromColumnsToContactFace":
        """The conversion for the contact face of a divided shoe."""
        inverse = matrix_from_node_values_to_function_factors(layers.functions, layers.halves[0])
        angles = rotation_angles_of_contact_nodes_to_shoe_frame(shoe, div)
        return cls(np.repeat(angles[div.indices_of_kept_contact_nodes], len(inverse)), inverse)

    def forces_on_face_nodes(self, V: Floats) -> Floats:
        """Forces (m, 2 n nodes) on the nodes of the face, in the shoe's frame.

        The argument V (m, 2 n functions) are the forces on the contact unknowns of the columns.
        """
        turned = rotate_node_axes_of_vectors(V, self.angles)
        count = len(self.inverse)
        if count == 1:
            return turned
        by_function = turned.reshape(len(V), -1, count, 2).swapaxes(2, 3)
        return np.ascontiguousarray((by_function @ self.inverse).swapaxes(2, 3)).reshape(len(V), -1)

    def stiffness_of_face_nodes(self, S: Floats) -> Floats:
        """The stiffness (2 n nodes, 2 n nodes) of the face's nodes in the shoe's frame.

        `S` (2 n functions, 2 n functions) is the stiffness on the contact unknowns of the columns.
        The result is written into `S`, which may take 250 MB.
        """
        if len(self.inverse) == 1:
            return rotate_node_axes_of_matrix(np.ascontiguousarray(S), self.angles)
        # The conversion of a few rows or columns at a time needs little memory besides the matrix.
        for rows in _slices_of_face_stiffness_rows(len(S)):
            S[rows] = self.forces_on_face_nodes(S[rows])
        for columns in _slices_of_face_stiffness_rows(len(S)):
            S[:, columns] = self.forces_on_face_nodes(S[:, columns].T).T
        return S


def _slices_of_face_stiffness_rows(count: int) -> Iterator[slice]:
    """Yield the slices of `count` rows that are converted together."""
    for start in range(0, count, FACE_STIFFNESS_ROWS_CONVERTED_TOGETHER):
        yield slice(start, start + FACE_STIFFNESS_ROWS_CONVERTED_TOGETHER)


def _condense_hinged_shoe_with_width(
    shoe: Shoe,
    radius: float,
    div: ShoeElementDivision,
    layers: ElementLayersWithWidthFunctions,
    row: _CondensedColumnsUnderAndBesideLining,
    R: Floats,
) -> CondensedShoe:
    """Condense an elastic shoe that is held at its hinge and loaded at its other end.

    The hinge fixes the displacements in the section over the whole width of the body and leaves u_z
    free. The unit loads on the loaded end are uniform over the width.

    Parameters
    ----------
    shoe, radius, div : as in `condense_shoe_with_width`
    layers : layers of the shoe, with functions across the width
    row : condensed columns of the shoe
    R : (2n, 3) rigid-body modes of the face's nodes
    """
    p, place, pin = (
        div.degree,
        function_from_depth_and_angle_to_point(shoe, radius),
        shoe.pin_position_in_shoe_frame,
    )
    depths = node_positions_of_element_row(div.depths[div.index_of_first_body_layer :], p)
    near, far = div.column_ends_before_lining[-1], div.column_ends_behind_lining[-1]
    line = layers.unknowns_across_body_thickness(div)
    modes = rotate_axes_of_all_nodes_by_one_angle(
        rigid_body_displacements_of_nodes(place(depths, near), pin),
        displacement_axis_angles_of_shoe_at_positions(shoe, near),
    )
    end, end_forces = layers.unit_loads_on_end_face(
        div, place(depths, far), displacement_axis_angles_of_shoe_at_positions(shoe, far)
    )

    # The assembled columns have the unknowns [frame | face | loads].
    columns = row.under.copy()
    at_start, at_end = row.first_and_last_column_under_lining
    # In a rigid-body motion the displacements are constant over z: only the function 1 has factors.
    tied, modes = (
        np.flatnonzero(line.z == 0),
        line.values_on_unknowns_of_thickness_line([modes])[line.z == 0],
    )
    if row.before:
        held = _column_with_left_side_tied_to_hinge_face(row.before[0], tied, modes)
        body = assemble_and_condense_row_of_element_columns([held, *row.before[1:]], 0)
        columns[0] = eliminate_nodes_on_column_side(at_start, body.K, len(line.z))
    else:
        own = at_start.left - len(line.z)
        columns[0] = _column_with_left_side_tied_to_hinge_face(
            at_start, own + tied, modes
        )._replace(left=0)
    loaded = condensed_stiffness_of_body_beyond_lining_end(row.after, end_forces)
    columns[-1] = eliminate_nodes_on_column_side(at_end, loaded, len(end_forces), right=True)
    del at_start, at_end
    count = layers.functions.counts_of_even_and_odd_functions_on_part(layers.halves[0])[0]
    face = _ConversionFromColumnsToContactFace.conversion_to_displacements_of_face_nodes(
        shoe, div, layers
    )
    # No name refers to the assembled stiffness here, so that its memory is free after its use.
    return condensed_shoe_corrected_for_round_off(
        assemble_and_condense_row_of_element_columns(columns, 2 * count).K,
        end,
        R,
        pin,
        face.forces_on_face_nodes,
        face.stiffness_of_face_nodes,
    )


def _column_with_left_side_tied_to_hinge_face(
    piece: ColumnSubstructure, tied: Ints, modes: Floats
) -> ColumnSubstructure:
    """A column of elements with its left side tied to the frame; its unknowns are [frame | others].

    Parameters
    ----------
    piece : the column
    tied : (n,) unknowns of the left side that move with the frame; the other unknowns of this side
        are eliminated
    modes : (n, 3) value of each tied unknown in each of the three unit motions of the frame
    """
    n = len(piece.K)
    free = np.setdiff1d(np.arange(piece.left), tied)
    rest = np.arange(piece.left, n)
    T = np.zeros((n, DEGREES_OF_FREEDOM_OF_BODY_FRAME + len(rest)))
    T[tied, :DEGREES_OF_FREEDOM_OF_BODY_FRAME] = modes
    T[rest, DEGREES_OF_FREEDOM_OF_BODY_FRAME + np.arange(len(rest))] = 1.0
    KT = piece.K @ T
    K = np.ascontiguousarray(T.T @ KT)
    if len(free):
        inner = np.ascontiguousarray(piece.K[np.ix_(free, free)])
        replace_matrix_by_schur_complement(K, np.ascontiguousarray(KT[free]), inner)
    return ColumnSubstructure(K, DEGREES_OF_FREEDOM_OF_BODY_FRAME, piece.right)
