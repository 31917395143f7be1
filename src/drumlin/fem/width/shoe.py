"""A parametric shoe with a width, condensed to its frame, its contact face and its unit loads.

The frame is the rigid line of the shoe that its hinge holds. The section is divided into columns,
stacks of hp elements from the contact inwards (hp.columns).
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.brake.brake import Shoe
from drumlin.brake.fields import Material
from drumlin.fem.hp.columns import (
    ColumnSubstructure,
    assemble_column_row,
    eliminate_side_line,
    rotate_matrix_components,
    rotate_vector_components,
)
from drumlin.fem.hp.division import ShoeDivision
from drumlin.fem.hp.element import schur_complement
from drumlin.fem.hp.shoe import (
    CondensedShoe,
    column_kinds,
    condense_back_held_shoe,
    condensed_shoe_in_balance,
    element_nodes,
    loaded_body_stiffness,
    measuring_axis_angles,
    node_positions_of_row,
    point_map,
    rotate_all_nodes,
    rotations_to_shoe_frame,
    unit_actuation_loads,
)
from drumlin.fem.preparation.meshes import materials_of_parts
from drumlin.fem.substructure.body import FRAME, rigid_body_modes
from drumlin.fem.width.columns import (
    BackEdge,
    Stack,
    half_row,
    mirrored_columns,
    restrict_back,
    stack_of,
    whole_columns,
)
from drumlin.fem.width.functions import (
    WidthFunctions,
    WidthIntegrals,
    half_widths_of,
    nodes_to_functions,
    width_integrals,
)
from drumlin.fem.width.integrals import (
    SYMMETRIES,
    LameConstants,
    SectionIntegrals,
    angular_factors,
    arc_integrals,
    cell_integrals,
)


class WidthLayers(NamedTuple):
    """The layers of a divided shoe, from the contact inwards, with functions across the width.

    Attributes
    ----------
    functions : the functions across the width
    halves : (l,) half width of each layer [m]
    lame : (l,) Lame constants of each layer
    """

    functions: WidthFunctions
    halves: tuple[float, ...]
    lame: tuple[LameConstants, ...]

    def integrals(self, first: int) -> list[WidthIntegrals]:
        """The integrals over the width, of each layer from number `first` inwards."""
        return [width_integrals(self.functions, half) for half in self.halves[first:]]

    def stack(self, p: int, first: int, *, contact: bool, back: BackEdge) -> Stack:
        """The unknowns of a column of the layers from number `first` inwards.

        The other parameters are those of `stack_of`.
        """
        return stack_of(self.functions, self.halves[first:], p, contact=contact, back=back)

    def body_line(self, div: ShoeDivision) -> "BodyLine":
        """The unknowns across the body's thickness, of layers that continue beyond the lining."""
        stack = self.stack(div.degree, div.first_body_layer, contact=False, back=BackEdge.FREE)
        line = stack.line(half_row(div.degree, 0).left)
        z, component, row, function = np.array(line, dtype=int).reshape(-1, 4).T
        return BodyLine(z, component, row, function, self.halves[div.first_body_layer])


class BodyLine(NamedTuple):
    """The unknowns (n,) on a line of nodes across the thickness of a shoe's body.

    Attributes
    ----------
    z : 1 for a displacement along z, across the width; 0 for a displacement in the section
    component : 0 for a displacement along the radius, 1 for a displacement around the drum
    row : row of nodes, counted from the outer face of the body
    function : number of the function across the width
    half : half width of the body's first layer [m]
    """

    z: Ints
    component: Ints
    row: Ints
    function: Ints
    half: float

    def spread(self, vectors: Floats, share: Floats) -> Floats:
        """Vectors (n, m) on the unknowns of the line from vectors of the plane section (2 rows, m).

        Displacements or forces along z are zero. `share` (functions,) is the factor of each even
        function.
        """
        by_row = vectors.reshape(-1, 2, vectors.shape[1])
        spread = by_row[self.row, self.component] * share[self.function * (1 - self.z), None]
        spread[self.z == 1] = 0.0
        return np.asarray(spread)


def width_layers(shoe: Shoe, div: ShoeDivision, functions: WidthFunctions) -> WidthLayers:
    """The layers of a divided shoe of isotropic parts, with functions across the width."""
    halves, lame = half_widths_of(shoe), {}
    for name, (material, _) in materials_of_parts(shoe).items():
        # `prepare.width_why_not` lets only brakes of isotropic materials pass.
        assert isinstance(material, Material)
        E, nu = material.E, material.nu
        # Degree 0 takes the lambda of plane stress, all other degrees that of the solid.
        free = E * nu / (1 - nu**2)
        solid = E * nu / ((1 + nu) * (1 - 2 * nu)) if functions.degree > 0 else free
        lame[name] = LameConstants(solid, E / (2 * (1 + nu)))
    return WidthLayers(
        functions,
        tuple(halves[name] for name in div.part),
        tuple(lame[name] for name in div.part),
    )


class _WidthColumns(NamedTuple):
    """The columns of elements of a shoe: under the lining, before the lining and behind the lining.

    `grip` are the numbers of the first column in the grip and of the first one behind the grip,
    both 0 without a grip.
    """

    under: list[ColumnSubstructure]
    before: list[ColumnSubstructure]
    after: list[ColumnSubstructure]
    grip: tuple[int, int]


ColumnsFrom = Callable[[Ints, int, Stack], list[ColumnSubstructure]]
"""A function that makes the columns of elements of given kinds.

A kind is a shape of column. The arguments are the kinds (c,), the number of the first layer and the
stack of layers.
"""


def _column_maker(
    shoe: Shoe, radius: float, div: ShoeDivision, layers: WidthLayers
) -> tuple[ColumnsFrom, Ints]:
    """The function that makes the columns of a shoe's elements, and the kind of each column.

    Columns of one kind have equal shape and equal stiffness.
    """
    p = div.degree
    kinds_of_columns = column_kinds(shoe, div, directed=False)
    along = kinds_of_columns.along
    plane = radius if shoe.flat else None
    radii = radius - shoe.sign * div.depths

    def on_arc(kinds: Ints, first: int, stack: Stack) -> list[ColumnSubstructure]:
        """Columns of elements between two circles, or between two planes.

        They are their own mirror images, so that symmetric and antisymmetric halves are condensed.
        """
        parts: list[list[SectionIntegrals]] = []
        for symmetry in SYMMETRIES:
            angular = angular_factors(along[kinds], p, symmetry, flat=shoe.flat)
            parts.append(
                [
                    arc_integrals(radii[k], radii[k + 1], layers.lame[k], angular, p, plane)
                    for k in range(first, div.layers)
                ]
            )
        return mirrored_columns(parts, layers.integrals(first), stack)

    def of_cells(kinds: Ints, first: int, stack: Stack) -> list[ColumnSubstructure]:
        """Columns of elements of any shape, such as those of a block under a straight beam."""
        xy = element_nodes(point_map(shoe, radius), div.depths[first:], along[kinds], p)
        lame = layers.lame[first:]
        parts = [cell_integrals(own, each, p) for own, each in zip(xy, lame, strict=True)]
        return whole_columns(parts, layers.integrals(first), stack)

    made = of_cells if kinds_of_columns.angular is None else on_arc
    return made, kinds_of_columns.which


def _width_columns(
    shoe: Shoe, radius: float, div: ShoeDivision, layers: WidthLayers
) -> _WidthColumns:
    """The condensed columns of elements of a shoe; the parameters are those of `condense_width`."""
    p = div.degree
    make, which = _column_maker(shoe, radius, div, layers)

    def columns_of(
        row: Ints, first: int, *, contact: bool, back: BackEdge
    ) -> list[ColumnSubstructure]:
        """The condensed columns of a row of kinds, with the layers from number `first` inwards.

        `contact` and `back` are attributes of `Stack`.
        """
        if not len(row):
            return []
        # Each kind of column is condensed once.
        kinds = np.flatnonzero(np.bincount(row))
        columns = make(kinds, first, layers.stack(p, first, contact=contact, back=back))
        made = dict(zip(kinds.tolist(), columns, strict=True))
        return [made[kind] for kind in row.tolist()]

    under, before = len(div.angles) - 1, len(div.before) - 1
    # A grip on the back of a shoe begins at column a and ends before column b.
    ends = shoe.grip(radius)
    a, b = (0, 0) if ends is None else (int(np.abs(div.angles - x).argmin()) for x in ends)
    back = BackEdge.BONDED if div.first_body_layer == div.layers else BackEdge.FREE
    free = columns_of(np.concatenate([which[:a], which[b:under]]), 0, contact=True, back=back)
    gripped = columns_of(which[a:b], 0, contact=True, back=BackEdge.GRIPPED)
    rest = columns_of(which[under:], div.first_body_layer, contact=False, back=BackEdge.FREE)
    row = [*free[:a], *gripped, *free[a:]]
    # A column beside the grip shares its side with a gripped column. The innermost nodes of this
    # side are held.
    stack = layers.stack(p, 0, contact=True, back=BackEdge.FREE)
    if a < b and a > 0:
        row[a - 1] = restrict_back(row[a - 1], stack, right=True)
    if a < b < under:
        row[b] = restrict_back(row[b], stack, right=False)
    return _WidthColumns(row, rest[:before], rest[before:], (a, b))


def condense_width(
    shoe: Shoe,
    radius: float,
    div: ShoeDivision,
    functions: WidthFunctions,
) -> CondensedShoe:
    """The shoe condensed to its frame and to the nodes of its contact face.

    The nodes of the face stand by growing angle, and at each angle from the mid-plane outwards, at
    the distances `WidthFunctions.face_nodes`. x and y of a node stand together.

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
    layers = width_layers(shoe, div, functions)
    row = _width_columns(shoe, radius, div, layers)
    count = layers.functions.counts(layers.halves[0])[0]
    phi = node_positions_of_row(div.angles, div.degree)
    xy = np.repeat(point_map(shoe, radius)(np.zeros(1), phi), count, axis=1)
    R = rigid_body_modes(xy, shoe.own_pin)
    if div.first_body_layer < div.layers and not any(row.grip):
        return _hinged_width(shoe, radius, div, layers, row, R)
    # Beside a grip the body's parts before and behind the lining bear no load. Each part is
    # condensed to the side at which it joins the columns under the lining.
    ends: list[Floats | None] = [None, None]
    if any(row.grip):
        before, after = row.before, row.after
        ends = [
            eliminate_side_line(assemble_column_row(before, 0)).K if before else None,
            eliminate_side_line(assemble_column_row(after, 0), right=True).K if after else None,
        ]
    columns = row.under.copy()
    first, last = (0 if end is None else len(end) for end in ends)
    columns[0] = eliminate_side_line(columns[0], ends[0], first)
    columns[-1] = eliminate_side_line(columns[-1], ends[1], last, right=True)
    S = assemble_column_row(columns, 2 * count).K
    face = _FaceAxes.of(shoe, div, layers)
    return condense_back_held_shoe(shoe, face.stiffness(S), R)


class _FaceAxes(NamedTuple):
    """The change from unknowns of the columns to displacements of the contact face's nodes.

    The columns have functions across the width in axes along the radius and around the drum. The
    nodes of the face have displacements in the shoe's frame.

    Attributes
    ----------
    angles : (n functions,) angles by which the axes are turned back to the frame [rad]
    inverse : matrix (functions, nodes) from values at the nodes across the width to factors of the
        functions
    """

    angles: Floats
    inverse: Floats

    @classmethod
    def of(cls, shoe: Shoe, div: ShoeDivision, layers: WidthLayers) -> "_FaceAxes":
        """The change of unknowns for the contact face of a divided shoe."""
        inverse = nodes_to_functions(layers.functions, layers.halves[0])
        angles = np.repeat(rotations_to_shoe_frame(shoe, div), len(inverse))
        return cls(angles, inverse)

    def rows(self, V: Floats) -> Floats:
        """Forces (m, 2 n nodes) on nodes in the shoe's frame from forces V (m, 2 n functions).

        The forces V belong to the functions across the width, in the axes of the columns.
        """
        turned = rotate_vector_components(V, self.angles)
        count = len(self.inverse)
        if count == 1:
            return turned
        by_function = turned.reshape(len(V), -1, count, 2).swapaxes(2, 3)
        return np.ascontiguousarray((by_function @ self.inverse).swapaxes(2, 3)).reshape(len(V), -1)

    def stiffness(self, S: Floats) -> Floats:
        """The stiffness (2 n nodes, 2 n nodes) of the face's nodes in the shoe's frame.

        `S` (2 n functions, 2 n functions) is the stiffness on the unknowns of the columns.
        """
        S = np.ascontiguousarray(S)
        if len(self.inverse) == 1:
            return rotate_matrix_components(S, self.angles)
        return self.rows(np.ascontiguousarray(self.rows(S).T))


def _hinged_width(
    shoe: Shoe,
    radius: float,
    div: ShoeDivision,
    layers: WidthLayers,
    row: _WidthColumns,
    R: Floats,
) -> CondensedShoe:
    """A condensed elastic shoe that is held at its hinge and loaded at its other end.

    The hinge holds the displacements in the section over the whole width and leaves u_z free. The
    unit loads on the loaded end are even over the width.

    Parameters
    ----------
    shoe, radius, div : as of `condense_width`
    layers : layers with functions across the width
    row : columns of the shoe
    R : (2n, 3) rigid-body modes of the face's nodes
    """
    p, place, pin = div.degree, point_map(shoe, radius), shoe.own_pin
    depths = node_positions_of_row(div.depths[div.first_body_layer :], p)
    near, far = div.before[-1], div.after[-1]
    line = layers.body_line(div)
    even = width_integrals(layers.functions, line.half).even
    # A rigid-body motion is the function 1 alone. A load even over the width acts on each even
    # function in proportion to the function's integral over the width.
    only_first, evenly = np.zeros(len(even)), even[0] / even[0, 0]
    only_first[0] = 1.0
    modes = rotate_all_nodes(
        rigid_body_modes(place(depths, near), pin), measuring_axis_angles(shoe, near)
    )
    end = unit_actuation_loads(place(depths, far), depths, p)
    end_forces = line.spread(rotate_all_nodes(end.forces, measuring_axis_angles(shoe, far)), evenly)

    # The assembled columns have the unknowns [frame | face | loads].
    columns = row.under.copy()
    tied, modes = np.flatnonzero(line.z == 0), line.spread(modes, only_first)[line.z == 0]
    if row.before:
        held = _on_frame(row.before[0], tied, modes)
        body = assemble_column_row([held, *row.before[1:]], 0)
        columns[0] = eliminate_side_line(columns[0], body.K, len(line.z))
    else:
        own = columns[0].left - len(line.z)
        columns[0] = _on_frame(columns[0], own + tied, modes)._replace(left=0)
    loaded = loaded_body_stiffness(row.after, end_forces)
    columns[-1] = eliminate_side_line(columns[-1], loaded, len(end_forces), right=True)
    count = layers.functions.counts(layers.halves[0])[0]
    A = assemble_column_row(columns, 2 * count).K
    face = _FaceAxes.of(shoe, div, layers)
    return condensed_shoe_in_balance(A, end, R, pin, face.rows, face.stiffness)


def _on_frame(piece: ColumnSubstructure, tied: Ints, modes: Floats) -> ColumnSubstructure:
    """A column of elements with its left side tied to the frame; its unknowns are [frame | others].

    Parameters
    ----------
    piece : the column
    tied : (n,) unknowns of the left side that move with the frame; the other unknowns of this side
        are eliminated
    modes : (n, 3) displacement of each tied unknown per degree of freedom of the frame
    """
    n = len(piece.K)
    free = np.setdiff1d(np.arange(piece.left), tied)
    rest = np.arange(piece.left, n)
    T = np.zeros((n, FRAME + len(rest)))
    T[tied, :FRAME] = modes
    T[rest, FRAME + np.arange(len(rest))] = 1.0
    KT = piece.K @ T
    K = np.ascontiguousarray(T.T @ KT)
    if len(free):
        inner = np.ascontiguousarray(piece.K[np.ix_(free, free)])
        schur_complement(K, np.ascontiguousarray(KT[free]), inner)
    return ColumnSubstructure(K, FRAME, piece.right)
