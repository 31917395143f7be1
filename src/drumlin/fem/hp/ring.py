"""The drum's elastic ring in hp elements: a closed row of element columns around the drum.

A column is a stack of elements through the thickness of the ring. The columns under the linings are
in contact.
"""

import math
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.base.lapack import dpotrf
from drumlin.brake.brake import Brake
from drumlin.brake.components import DrumRing, RectangularCrossSection
from drumlin.brake.elasticity import which_elasticity_matrices_are_orthotropic
from drumlin.contact.equations import MAX_NODES_OF_CONTACT_PROBLEM
from drumlin.fem.hp.arc import (
    angular_factors_of_column_stiffness,
    condensed_arc_column_stiffness,
    condensed_arc_element_stiffness,
)
from drumlin.fem.hp.columns import (
    ColumnSubstructure,
    assemble_and_condense_row_of_element_columns,
    eliminate_nodes_on_column_side,
    numbering_of_element_column_unknowns,
    rotate_node_axes_of_matrix,
    rotate_node_axes_of_vectors,
)
from drumlin.fem.hp.division import (
    RefinementLevel,
    element_sizes_growing_from_both_ends,
    interval_ends_from_interval_sizes,
)
from drumlin.fem.hp.grid import (
    ElementBoundaryGrid,
    EliminatedUnknownsOfHpElementBody,
    HpElementGrid,
    RectangularElementBlock,
)
from drumlin.fem.hp.shoe import (
    displacement_axis_angles_at_contact_nodes,
    distinct_sizes_and_index_of_each_size,
    node_positions_in_each_element_of_row,
    node_positions_of_element_row,
)
from drumlin.fem.substructure.body import (
    DEGREES_OF_FREEDOM_OF_BODY_FRAME,
    CondensedBody,
    UncondensedBodySystem,
    multi_point_constraints_of_body,
)
from drumlin.fem.substructure.elasticity import (
    elastic_layers_of_ring,
    elasticity_times_width_of_layers,
)
from drumlin.fem.substructure.elimination import SINGULAR_BODY_MESSAGE
from drumlin.fem.substructure.interface import ContactLine
from drumlin.fem.substructure.loads import ColumnsOfUnitLoads
from drumlin.fem.substructure.ring import (
    RIM_LOAD_NAME,
    FreeRingForceBalance,
    RingSubstructure,
    condensed_ring_coupled_with_linings,
    fixed_nodes_of_ring,
    indices_of_displacements_that_hold_free_ring,
    stiffness_of_drum_ring_without_supports,
)
from drumlin.response.resultants import (
    WEIGHTS,
    gauss_lobatto_points,
    shape_functions_and_derivatives_at_gauss_points,
)

RING_ERROR_OVER_LINING_ERROR = 0.1
"""Displacement error due to the ring's columns that is allowed, over that due to the lining's.

A column of width w on a body of modulus E leaves an error of about p w/E of the displacement under
the pressure p, in proportion to w. The ring's columns may therefore be wider than the lining's
columns by the ratio of the two moduli times the value given here, rounded down to a power of two.
Without the rounding, on 23 random brakes with rings (seeds 0 to 7 of each of the three kinds), the
error of p was at most 1.15 times the error with the lining's columns; with 0.3 it was up to 2.7
times as large. Smaller values give the ring more columns, and the solve takes more time.
"""
FULL_TURN_IN_RADIANS = 2 * math.pi
"""The angle of a whole turn [rad]."""
SAME_ANGLE_TOLERANCE = 1e-9
"""Difference of two angles [rad] below which they are the same end of an element column.

A smaller difference is round-off.
"""


class RingDivision(NamedTuple):
    """The division of the drum's ring into m columns and l layers of hp elements.

    Attributes
    ----------
    degree : degree p of the elements
    angles : (m + 1,) angles of the ends of the columns [rad], the last one a whole turn after the
        first
    contact : (m,) whether each column lies under a lining
    depths : (l + 1,) distances of the faces of the layers from the friction surface [m]
    """

    degree: int
    angles: Floats
    contact: Bools
    depths: Floats

    @property
    def contact_nodes_of_each_column(self) -> Ints:
        """The nodes (p + 1, c) on the friction surface of each of the c columns under linings.

        The nodes are numbered around the drum from the first angle on. After a whole turn node 0
        follows the last node.
        """
        p, count = self.degree, len(self.contact)
        edges = np.flatnonzero(self.contact) * p + np.arange(p + 1)[:, None]
        return edges % (count * p)

    @property
    def contact_nodes(self) -> Ints:
        """The nodes on the friction surface that lie under linings.

        The nodes are numbered around the drum from the first angle on.
        """
        return np.unique(self.contact_nodes_of_each_column)

    @property
    def first_element_column_of_each_contact_and_gap(self) -> Ints:
        """The index of the first column under each lining, and in each gap between two linings.

        The columns under one lining, or between two linings, are called a run.
        """
        runs = np.flatnonzero(np.diff(self.contact, prepend=not self.contact[0]))
        # A ring that is in contact all around is cut into two runs, because each run needs two
        # ends.
        return runs if len(runs) > 1 else np.array([0, 1])


def divide_ring_into_hp_elements(
    section: RectangularCrossSection,
    radius: float,
    linings: list[Floats],
    level: RefinementLevel,
    face_layer_size_at_unbounded_pressure: float = math.inf,
    widening: float = 1.0,
) -> RingDivision:
    """The division of the drum's ring into columns and layers of hp elements.

    Columns of the ring end where the lining's columns are smallest: at the ends of the lining, and
    where its pressure is singular. At these places the ring's columns are wider than the lining's
    columns by the factor `widening`. Away from these places the ring's columns become wider.

    Parameters
    ----------
    section : cross-section of the ring
    radius : radius of the friction surface [m]
    linings : for each lining the angles of the ends of its columns [rad], growing, in the brake's
        frame
    level : degree of the elements, and sizes of columns and layers
    face_layer_size_at_unbounded_pressure : upper limit of the size of the thinnest layer of
        elements [m]
    widening : width of the ring's narrowest columns over that of the lining's, see
        `largest_ratio_of_ring_to_lining_column_widths`
    """
    # `places` are the ends of the ring's columns under all linings. They are angles from 0 to a
    # whole turn, counted from the smallest start of a lining.
    origin = min(float(ends[0]) % FULL_TURN_IN_RADIANS for ends in linings)
    thickness = section.thickness / radius
    wider = [
        _ends_of_ring_columns_under_lining(ends, level, widening, thickness) for ends in linings
    ]
    parts = [ends - ends[0] + (float(ends[0]) - origin) % FULL_TURN_IN_RADIANS for ends in wider]
    places = np.sort(np.concatenate([part % FULL_TURN_IN_RADIANS for part in parts]))
    places = places[np.append(True, np.diff(places) > SAME_ANGLE_TOLERANCE)]
    places = np.append(
        places[places < FULL_TURN_IN_RADIANS - SAME_ANGLE_TOLERANCE], FULL_TURN_IN_RADIANS
    )

    # Between two linings columns are added, which grow from the size of both neighbours to the
    # middle.
    angles, contact = [places[:1]], []
    sizes = np.diff(places)
    under_lining = _which_angles_are_under_linings(0.5 * (places[1:] + places[:-1]), parts)
    for k, ((a, b), covered) in enumerate(zip(pairwise(places), under_lining, strict=True)):
        pieces = [b - a]
        if not covered:
            before, after = sizes[k - 1], sizes[(k + 1) % len(sizes)]
            pieces = element_sizes_growing_from_both_ends(
                b - a, before, after, level.column_size_ratio, level.largest_column
            )
        angles.append(interval_ends_from_interval_sizes(pieces, a, b)[1:])
        contact += [covered] * len(pieces)

    # The layers grow from the friction surface through the thickness.
    t = section.thickness
    layers = element_sizes_growing_from_both_ends(
        t,
        min(level.interface_layer_size * t, face_layer_size_at_unbounded_pressure),
        t,
        level.layer_size_ratio,
        t,
    )
    ends = origin + np.concatenate(angles)
    return RingDivision(
        level.degree, ends, np.array(contact), interval_ends_from_interval_sizes(layers, 0.0, t)
    )


def largest_ratio_of_ring_to_lining_column_widths(
    brake: Brake, section: RectangularCrossSection
) -> float:
    """The largest allowed ratio of the ring's column widths to the lining's, at least 1.

    The stiffest lining decides, see RING_ERROR_OVER_LINING_ERROR. `section` is the cross-section of
    the brake's ring.
    """
    lining = max(
        shoe.lining.width * shoe.lining.material.young_modulus_of_equivalent_half_plane
        for shoe in brake.shoes
    )
    ring = section.width * section.material.young_modulus_of_equivalent_half_plane
    # Powers of two give brakes with nearly equal moduli the same columns.
    return 2.0 ** max(0, math.floor(math.log2(RING_ERROR_OVER_LINING_ERROR * ring / lining)))


def _ends_of_ring_columns_under_lining(
    ends: Floats, level: RefinementLevel, widening: float, thickness: float
) -> Floats:
    """The ends of the ring's columns under a lining [rad], wider than the lining's columns.

    Where the pressure is singular the ring's columns are not made wider than the ring is thick,
    because there the ring's shear and bending change over its thickness.

    Parameters
    ----------
    ends : ends of the lining's columns [rad], growing
    level : sizes of columns
    widening : width of the ring's narrowest columns over that of the lining's
    thickness : thickness of the ring over the drum's radius
    """
    if widening == 1.0:
        return ends
    # The pressure is singular where two columns meet that are smaller than both their neighbours.
    sizes, which = distinct_sizes_and_index_of_each_size(np.diff(ends))
    size = sizes[which]
    is_singular = (size[1:-2] < size[:-3]) & (size[2:-1] < size[3:])
    singular = np.flatnonzero(is_singular) + 2
    # Between two such places the columns grow to the middle, as those of the lining do.
    found = [ends[:1]]
    for first, last in pairwise([0, *singular.tolist(), len(size)]):
        a, b = float(ends[first]), float(ends[last])
        left, right = (
            max(own, min(widening * own, thickness))
            for own in (float(size[first]), float(size[last - 1]))
        )
        # The length is rounded, so that equal linings have equal columns wherever they lie.
        pieces = element_sizes_growing_from_both_ends(
            round(b - a, 12), left, right, level.column_size_ratio, level.largest_column
        )
        found.append(interval_ends_from_interval_sizes(pieces, a, b)[1:])
    return np.concatenate(found)


def _which_angles_are_under_linings(angles: Floats, parts: list[Floats]) -> Bools:
    """Whether each of the `angles` (m,) [rad], or the angle a whole turn larger, is under a lining.

    The first and the last angle of each of the `parts` [rad] are the ends of a lining.
    """
    first, last = np.array([(ends[0], ends[-1]) for ends in parts]).T[:, :, None]
    turned = angles + FULL_TURN_IN_RADIANS
    under = (first < angles) & (angles < last) | (first < turned) & (turned < last)
    return np.asarray(under.any(axis=0))


def condensed_ring_in_hp_elements(
    brake: Brake,
    level: RefinementLevel,
    linings: tuple[ContactLine, ...],
    *,
    face_layer_size_at_unbounded_pressure: float = math.inf,
) -> RingSubstructure:
    """The elastic ring of a brake in hp elements, condensed to its nodes under the linings.

    Parameters
    ----------
    brake : the brake, which has a ring with a section
    level : degree of the elements, and sizes of columns and layers
    linings : contact line of each shoe with all its linings, in the frame of the shoe
    face_layer_size_at_unbounded_pressure : upper limit of the size of the thinnest layer of
        elements [m]

    Raises
    ------
    NoAnswer
        if more than MAX_NODES_OF_CONTACT_PROBLEM of the ring's nodes lie under linings
    """
    # `reason_against_finite_element_model` refuses brakes without a section before, so that the
    # assertion holds.
    ring, radius, sign = brake.ring, brake.size, brake.shoes[0].sign_internal_plus_external_minus
    assert ring is not None and ring.section is not None
    ends = []
    for shoe, line in zip(brake.shoes, linings, strict=True):
        for phi in line.split_nodal_values_by_lining(line.phi):
            at_ends = phi[:: line.interpolation_degree_along_contact_line]
            ends.append(np.sort(shoe.frame.surface_coordinates_of_phi(at_ends)))
    widening = largest_ratio_of_ring_to_lining_column_widths(brake, ring.section)
    div = divide_ring_into_hp_elements(
        ring.section, radius, ends, level, face_layer_size_at_unbounded_pressure, widening
    )
    if len(div.contact_nodes) > MAX_NODES_OF_CONTACT_PROBLEM:
        raise NoAnswer(
            f"the ring has {len(div.contact_nodes)} nodes under the linings, more than the "
            f"{MAX_NODES_OF_CONTACT_PROBLEM} that are allowed: the contact nodes of a mesh "
            f"file are too many"
        )
    # A free ring has no support. Loads spread over its rim balance the forces of the linings.
    free = ring.support == "free"
    grid = element_grid_of_whole_drum_ring(radius, sign, div)
    rim = np.zeros((2 * grid.N, 0))
    if free:
        rim = nodal_forces_of_unit_rim_loads(radius + sign * ring.section.thickness, div, grid)

    contact = _contact_line_of_ring(div, grid)
    condensed = _condense_ring_to_contact_nodes(ring, radius, sign, div, grid, rim)
    balance = (
        FreeRingForceBalance.force_balance_of_free_ring(grid, rim, condensed, contact)
        if free
        else None
    )
    held = fixed_nodes_of_ring(ring, grid.sets["support"])
    return condensed_ring_coupled_with_linings(
        brake, linings, grid, grid, contact, condensed, held, balance
    )


def _contact_line_of_ring(div: RingDivision, grid: HpElementGrid) -> ContactLine:
    """The contact line of the drum's ring: its nodes on the friction surface under all linings."""
    nodes, touching = grid.sets["contact"], div.contact_nodes
    place = np.full(len(div.contact) * div.degree, -1)
    place[touching] = np.arange(len(touching))
    angles = node_positions_of_element_row(div.angles, div.degree)[touching]
    return ContactLine(
        nodes, grid.doflocs[:, nodes], angles, place[div.contact_nodes_of_each_column]
    )


def _condense_ring_to_contact_nodes(
    ring: DrumRing, radius: float, sign: int, div: RingDivision, grid: HpElementGrid, rim: Floats
) -> CondensedBody:
    """The drum's ring, condensed to its contact nodes, with the unit loads on its rim.

    The rim is the ring's edge opposite to the friction surface.

    Parameters
    ----------
    ring : the ring, which has a section
    radius, sign, div : radius of the friction surface [m]; 1 if the ring's depth grows outwards, -1
        if inwards; division of the ring into columns and layers of elements
    grid : all nodes and elements of the ring
    rim : (2 N, l) unit loads on the rim, as nodal forces; l is 0 if the rim is fixed
    """
    section = ring.section
    assert section is not None
    extra, free = rim.shape[1], rim.shape[1] > 0
    layers = len(div.depths) - 1
    line = numbering_of_element_column_unknowns(
        div.degree, layers, contact=True, held=not free
    ).number_of_side_unknowns
    n = 2 * len(div.contact_nodes)
    A = _assemble_stiffness_of_closed_ring(
        _ring_stiffness_under_and_between_linings(section, radius, sign, div, free=free),
        div,
        line,
        extra,
    )
    # A free ring is supported at three unknowns of its rim, which is statically determinate.
    if free:
        A = _ring_stiffness_held_against_rigid_motion(A, extra, n, line, div)
    # A run is all columns under one lining, or between two linings. The nodes inside the ring at
    # the ends of the runs are eliminated. The displacements of the contact nodes are converted from
    # axes along the radius and around the drum to x and y.
    A = eliminate_nodes_on_column_side(ColumnSubstructure(A, 0, len(A) - extra - n), right=True).K
    back = -displacement_axis_angles_at_contact_nodes(div.angles, div.degree)[div.contact_nodes]
    L, info = dpotrf(rotate_node_axes_of_matrix(A[extra:, extra:], back), lower=1)
    if info:
        raise NoAnswer(SINGULAR_BODY_MESSAGE)
    system = partial(_equations_of_ring_before_condensation, ring, grid, rim)
    return CondensedBody(
        L,
        L_fc=np.zeros((DEGREES_OF_FREEDOM_OF_BODY_FRAME, n)),
        load_on_contact=-rotate_node_axes_of_vectors(A[:extra, extra:], back).T,
        load_on_frame=np.zeros((DEGREES_OF_FREEDOM_OF_BODY_FRAME, extra)),
        load_work=-A[:extra, :extra],
        inner=EliminatedUnknownsOfHpElementBody.eliminated_unknowns_with_system_loads_only(
            grid, elastic_layers_of_ring(section), system
        ),
        columns=ColumnsOfUnitLoads(((RIM_LOAD_NAME, extra),)),
    )


def _ring_stiffness_under_and_between_linings(
    section: RectangularCrossSection, radius: float, sign: int, div: RingDivision, *, free: bool
) -> list[Floats]:
    """The condensed stiffness (n, n) of each run of element columns of the drum's ring.

    The columns under one lining, or between two linings, are called a run. The runs are in the
    order of their angles.

    Parameters
    ----------
    section : cross-section of the ring
    radius : radius of the friction surface [m]
    sign : 1 if the ring's depth grows outwards, -1 if it grows inwards
    div : division of the ring into columns and layers of elements
    free : whether the rim (the edge opposite to the friction surface) is free; the factors of its
        unit loads are then extra unknowns
    """
    # The elements of columns of equal size have the same stiffness, which is computed once.
    p, layers = div.degree, len(div.depths) - 1
    sizes, which = distinct_sizes_and_index_of_each_size(np.diff(div.angles))
    along = 0.5 * sizes[:, None] * gauss_lobatto_points(p)
    elasticity = elasticity_times_width_of_layers(
        elastic_layers_of_ring(section), ("drum",) * layers
    )
    A = angular_factors_of_column_stiffness(
        along, p, directed=bool(which_elasticity_matrices_are_orthotropic(elasticity).any())
    )
    K = condensed_arc_element_stiffness(radius + sign * div.depths, A, elasticity, p)
    loads = (
        _nodal_rim_forces_in_axes_of_column_sides(radius + sign * section.thickness, along, p)
        if free
        else None
    )
    # The stiffness of each run is assembled from its columns. A run is all columns under one
    # lining, or between two linings. Runs of equal columns have the same stiffness in the axes of
    # their first column.
    middle = 0.5 * (div.angles[1:] + div.angles[:-1])
    made: dict[tuple[bool, bytes], Floats] = {}
    runs = []
    for first, last in pairwise([*div.first_element_column_of_each_contact_and_gap, len(which)]):
        contact, own = bool(div.contact[first]), which[first:last]
        key = contact, own.tobytes()
        if key not in made:
            kinds, kind_of = np.unique(own, return_inverse=True)
            made[key] = _condensed_stiffness_of_column_run(
                K[:, :, kinds],
                kind_of,
                p,
                contact=contact,
                loads=None if loads is None else loads[kinds],
                turns=middle[first:last] - middle[first],
            )
        run = made[key]
        if free:
            run = _column_stiffness_with_unit_loads_in_brake_frame(
                run[None], middle[first : first + 1]
            )[0]
        runs.append(run)
    return runs


def _condensed_stiffness_of_column_run(
    K: Floats,
    kind_of: Ints,
    p: int,
    *,
    contact: bool,
    loads: Floats | None,
    turns: Floats,
) -> Floats:
    """The condensed stiffness (n, n) of a run of c element columns of k kinds.

    Parameters
    ----------
    K : (l, 2, k, m, m) condensed stiffness of the l elements in each kind of column, see
        `condensed_arc_element_stiffness`
    kind_of : (c,) kind of each column
    p : degree of the elements
    contact : whether the run is in contact
    loads : (k, 2 (p + 1), 3) unit loads on the free rim of each kind of column; None if the rim is
        fixed
    turns : (c,) angle from the middle of the first column to that of each column [rad]
    """
    held = loads is None
    line = numbering_of_element_column_unknowns(
        p, len(K), contact=contact, held=held
    ).number_of_side_unknowns
    made = condensed_arc_column_stiffness(K, p, contact=contact, held=held, loads=loads)
    if not held:
        # The unit loads on the rim have another direction in each column's own frame, so that no
        # two columns are equal.
        made = _column_stiffness_with_unit_loads_in_brake_frame(made[kind_of], turns)
        kind_of = np.arange(len(kind_of))
    kinds_made = [ColumnSubstructure(each, line, line) for each in made]
    row = [kinds_made[k] for k in kind_of]
    return assemble_and_condense_row_of_element_columns(
        row, 2 * contact, 0 if held else DEGREES_OF_FREEDOM_OF_BODY_FRAME
    ).K


def _nodal_rim_forces_in_axes_of_column_sides(radius: float, along: Floats, p: int) -> Floats:
    """The nodal forces (c, 2 (p + 1), 3) of three unit loads on the rim of c columns of the ring.

    They are the forces of `_unit_rim_loads_on_element_columns` in other axes. The forces on the
    first and the last node of each column have components along the radius at this node and square
    to this radius.

    Parameters
    ----------
    radius : radius of the rim [m]
    along : (c, p + 1) angles of the nodes from the middle of their column [rad]
    p : degree of the elements
    """
    loads = _unit_rim_loads_on_element_columns(radius, along, p)
    for at, k in ((slice(2), 0), (slice(-2, None), -1)):
        nodal = loads[:, at].transpose(0, 2, 1)
        rotated = rotate_node_axes_of_vectors(nodal, along[:, k, None])
        loads[:, at] = rotated.transpose(0, 2, 1)
    return loads


def _unit_rim_loads_on_element_columns(radius: float, along: Floats, p: int) -> Floats:
    """The nodal forces (c, 2 (p + 1), 3) on the rim of c columns of the drum's ring.

    Three unit loads are spread over the whole rim like the displacements of the ring's rigid-body
    modes: translation in x and y, and rotation. The result is the part of each load that acts on
    each column. It is given in the frame of the column, whose x axis runs through the column's
    middle. `along` (c, p + 1) are the angles of the nodes from the middle [rad], `radius` is the
    rim's radius [m], and p is the degree of the elements.
    """
    xy = radius * np.array([np.cos(along), np.sin(along)])  # (2, c, p + 1)
    psi, slope = shape_functions_and_derivatives_at_gauss_points(p)
    x = xy @ psi
    ds = np.hypot(*(xy @ slope)) * WEIGHTS / (FULL_TURN_IN_RADIANS * radius)
    one, zero = np.ones_like(ds), np.zeros_like(ds)
    modes = np.array([[one, zero], [zero, one], [-x[1], x[0]]])  # (3, 2, c, q)
    found = np.einsum("aq,kicq,cq->caik", psi, modes, ds)
    return found.reshape(len(along), -1, DEGREES_OF_FREEDOM_OF_BODY_FRAME)


def _column_stiffness_with_unit_loads_in_brake_frame(K: Floats, angle: Floats) -> Floats:
    """The stiffness (c, n, n) of element columns, with unit loads rotated to the brake's frame.

    The first three unknowns of each column are the factors of the unit loads on the rim. They are
    given in the frame of the column. `angle` (c,) [rad] are the angles of the columns' middles.
    """
    T = np.zeros((len(angle), DEGREES_OF_FREEDOM_OF_BODY_FRAME, DEGREES_OF_FREEDOM_OF_BODY_FRAME))
    T[:, 0, 0] = T[:, 1, 1] = np.cos(angle)
    T[:, 0, 1], T[:, 1, 0], T[:, 2, 2] = np.sin(angle), -np.sin(angle), 1.0
    K = K.copy()
    K[:, :DEGREES_OF_FREEDOM_OF_BODY_FRAME] = (
        T.transpose(0, 2, 1) @ K[:, :DEGREES_OF_FREEDOM_OF_BODY_FRAME]
    )
    K[:, :, :DEGREES_OF_FREEDOM_OF_BODY_FRAME] = K[:, :, :DEGREES_OF_FREEDOM_OF_BODY_FRAME] @ T
    return K


def _assemble_stiffness_of_closed_ring(
    runs: list[Floats], div: RingDivision, line: int, extra: int
) -> Floats:
    """The stiffness of the drum's closed ring, assembled from the stiffness of its runs.

    A run is all element columns under one lining, or all columns between two linings. The unknowns
    are [unit loads | contact nodes by growing angle | lines]. A line is the nodes between two runs,
    through the thickness of the ring. Its first node is a contact node and is counted there, since
    one of the two runs is in contact.

    Parameters
    ----------
    runs : stiffness of each run
    div : division of the ring
    line : number of unknowns of a line without its first node
    extra : number of extra unknowns, the factors of unit loads
    """
    starts, count = div.first_element_column_of_each_contact_and_gap, len(runs)
    # `own` is the number of contact unknowns counted for each run, without its last node, which is
    # the first node of the next run. A run between two linings has only its two end nodes in
    # contact.
    p = div.degree
    columns = np.diff([*starts, len(div.contact)])
    own = np.where(div.contact[starts], 2 * p * columns, 2)
    tops = extra + np.concatenate([[0], np.cumsum(own)])
    first = int(tops[-1])
    A = np.zeros((first + count * line,) * 2)
    # The stiffness of each run is added at the numbers of its unknowns in the ring.
    for k, K in enumerate(runs):
        after = (k + 1) % count
        left_node, right_node = tops[k] + np.arange(2), tops[after] + np.arange(2)
        left_line = first + k * line + np.arange(line)
        right_line = first + after * line + np.arange(line)
        between = np.arange(tops[k] + 2, tops[k + 1])
        if div.contact[starts[k]]:
            order = [left_line, left_node, between, right_node, right_line]
        else:
            order = [left_node, left_line, right_node, right_line]
        place = np.concatenate([np.arange(extra), *order])
        np.add.at(A, (place[:, None], place), K)
    return A


def _ring_stiffness_held_against_rigid_motion(
    A: Floats, extra: int, contact: int, line: int, div: RingDivision
) -> Floats:
    """The stiffness of the drum's free ring with three displacements of its rim fixed to zero.

    The fixed displacements hold the ring against rigid-body motion. Two of them are the
    displacements of one node. The third is a displacement of another node, in a direction in which
    a rotation about the first node moves this other node. The three unknowns are removed from the
    matrix.

    Parameters
    ----------
    A : (n, n) stiffness of the closed ring
    extra, contact, line : number of unknowns of the unit loads, of the contact nodes, and of the
        other nodes through the thickness at an end of a lining
    div : division of the ring
    """
    # The other node is the end of a run that is farthest from the first node.
    angles = div.angles[div.first_element_column_of_each_contact_and_gap]
    away = 0.5 * (angles - angles[0])
    k = int(np.abs(np.sin(away)).argmax())
    # A rotation about the first node moves the other node around the drum or along the radius. The
    # larger of these two displacements is fixed.
    along = abs(math.sin(away[k])) > abs(math.cos(away[k]))
    node = extra + contact + line - 2
    other = extra + contact + (k + 1) * line - 2 + along
    keep = np.setdiff1d(np.arange(len(A)), [node, node + 1, other])
    return A[keep[:, None], keep]


def element_grid_of_whole_drum_ring(radius: float, sign: int, div: RingDivision) -> HpElementGrid:
    """The grid of all nodes and hp elements of the drum's ring.

    The node set "surface" is the friction surface, "contact" its part under the linings, and
    "support" the rim: the edge opposite to the friction surface.

    Parameters
    ----------
    radius, sign, div : radius of the friction surface [m]; 1 if the ring's depth grows outwards, -1
        if inwards; division of the ring into columns and layers of elements
    """
    p = div.degree
    depth, along = (
        node_positions_of_element_row(div.depths, p),
        node_positions_of_element_row(div.angles, p),
    )
    rows, n = len(depth), len(along) - 1
    nodes = np.arange(rows * n).reshape(rows, n)
    # The ring is closed: after the last column of nodes comes the first column again.
    closed = np.column_stack([nodes, nodes[:, 0]])

    def ring_points_at_depth_and_angle(depth: Floats, phi: Floats) -> Floats:
        """The points (2, ...) [m] of the ring at depths [m] and angles phi [rad]."""
        r = radius + sign * depth
        return np.stack([r * np.cos(phi), r * np.sin(phi)])

    contact = nodes[0, div.contact_nodes]
    sets = {"contact": contact, "surface": nodes[0], "support": nodes[-1]}
    block = RectangularElementBlock(closed, depth, along, ("drum",) * (len(div.depths) - 1))
    return HpElementGrid(p, (block,), ring_points_at_depth_and_angle, sets, rows * n)


def nodal_forces_of_unit_rim_loads(radius: float, div: RingDivision, grid: HpElementGrid) -> Floats:
    """The nodal forces (2 N, 3) of three unit loads that are spread over the rim of the ring.

    The loads are spread like the displacements of the ring's rigid-body modes: translation in x and
    y, and rotation.

    Parameters
    ----------
    radius : radius of the rim [m]
    div : division of the ring into columns and layers of elements
    grid : all nodes and elements of the ring
    """
    p, count = div.degree, len(div.contact)
    forces = np.zeros((grid.N, 2, DEGREES_OF_FREEDOM_OF_BODY_FRAME))
    pieces = _unit_rim_loads_on_element_columns(
        radius, node_positions_in_each_element_of_row(div.angles, p), p
    )
    edges = (np.arange(count)[:, None] * p + np.arange(p + 1)) % (count * p)
    np.add.at(
        forces,
        grid.sets["support"][edges],
        pieces.reshape(count, p + 1, 2, DEGREES_OF_FREEDOM_OF_BODY_FRAME),
    )
    return forces.reshape(-1, DEGREES_OF_FREEDOM_OF_BODY_FRAME)


def _equations_of_ring_before_condensation(
    ring: DrumRing, grid: HpElementGrid, rim: Floats, basis: HpElementGrid | ElementBoundaryGrid
) -> UncondensedBodySystem:
    """The stiffness, constraints and loads of the drum's ring before condensation.

    Parameters
    ----------
    ring : the ring, which has a section
    grid : all nodes and elements of the ring
    rim : (2 N, l) unit loads on the rim, as nodal forces; l is 0 if the rim is fixed
    basis : nodes whose displacements are unknowns of the system: all nodes of the grid, or only
        those on the boundaries of elements (the skeleton)
    """
    contact = basis.indices_in_this_basis_of_grid_nodes(grid.sets["contact"])
    far_edge = basis.indices_in_this_basis_of_grid_nodes(grid.sets["support"])
    # A free ring has loads on its rim, and three displacements of the rim are fixed to zero.
    alone = indices_of_displacements_that_hold_free_ring(basis, far_edge) if rim.shape[1] else None
    constraints = multi_point_constraints_of_body(
        basis, contact, fixed_nodes_of_ring(ring, far_edge), np.zeros(2), alone
    )
    loads = constraints.matrix.T @ rim[basis.dofs]
    return UncondensedBodySystem.body_system_from_stiffness_of_all_nodes(
        stiffness_of_drum_ring_without_supports(basis, ring), constraints, loads
    )
