"""The drum's elastic ring in hp elements: a closed row of columns, in contact under the linings."""

import math
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.base.lapack import dpotrf
from drumlin.brake.brake import Brake
from drumlin.brake.components import Ring, Section
from drumlin.brake.elasticity import has_directions
from drumlin.fem.hp.arc import (
    angular_integrals,
    arc_column_stiffness,
    condensed_arc_element_stiffness,
)
from drumlin.fem.hp.columns import (
    ColumnSubstructure,
    assemble_column_row,
    eliminate_side_line,
    order_of_column_unknowns,
    rotate_matrix_components,
    rotate_vector_components,
)
from drumlin.fem.hp.division import Level, graded_sizes, piece_ends
from drumlin.fem.hp.grid import ColumnGrid, ElementBlock, GridUnknowns, Skeleton
from drumlin.fem.hp.shoe import (
    axis_angles_of_contact_nodes,
    distinct_sizes,
    node_positions_of_elements,
    node_positions_of_row,
)
from drumlin.fem.substructure.body import FRAME, CondensedBody, InnerSystem, body_constraints
from drumlin.fem.substructure.elasticity import elastic_layers_of_ring, elasticity_of_layers
from drumlin.fem.substructure.elimination import SINGULAR_BODY
from drumlin.fem.substructure.interface import ContactLine
from drumlin.fem.substructure.loads import LoadColumns
from drumlin.fem.substructure.ring import (
    RIM,
    RimBalance,
    RingSubstructure,
    couple_ring_with_linings,
    nodes_held,
    ring_stiffness,
    statically_determinate_unknowns,
)
from drumlin.response.resultants import WEIGHTS, at_gauss, lobatto

FULL_TURN = 2 * math.pi
"""A whole turn [rad]."""
SAME_ANGLE = 1e-9
"""Distance [rad] of two ends of columns below which they differ by round-off only."""


class RingDivision(NamedTuple):
    """The division of a ring into m columns of elements and l layers.

    Attributes
    ----------
    degree : degree p of the elements
    angles : (m + 1,) ends of the columns [rad], the last end a whole turn after the first
    contact : (m,) whether each column lies under a lining
    depths : (l + 1,) ends of the layers from the friction surface on [m]
    """

    degree: int
    angles: Floats
    contact: Bools
    depths: Floats

    @property
    def contact_edges(self) -> Ints:
        """Nodes (p + 1, c) of the friction surface on each of the c columns in contact.

        The nodes are counted from the first angle. Where the ring closes, node 0 follows the last.
        """
        p, count = self.degree, len(self.contact)
        edges = np.flatnonzero(self.contact) * p + np.arange(p + 1)[:, None]
        return edges % (count * p)

    @property
    def contact_nodes(self) -> Ints:
        """Nodes of the friction surface under linings, counted from the first angle."""
        return np.unique(self.contact_edges)

    @property
    def first_columns_of_runs(self) -> Ints:
        """The first column of each run; a run is all columns under one lining or between two."""
        runs = np.flatnonzero(np.diff(self.contact, prepend=not self.contact[0]))
        # A ring in contact all around has two runs, so that a line between them closes it.
        return runs if len(runs) > 1 else np.array([0, 1])


def divide_ring(
    section: Section,
    radius: float,
    linings: list[Floats],
    level: Level,
    singular_layer_size: float = math.inf,
) -> RingDivision:
    """The division of a ring under linings.

    Parameters
    ----------
    section : section of the ring
    radius : radius of the friction surface [m]
    linings : ends of the columns of each lining, growing, in the brake's angles [rad]
    level : degree and grading
    singular_layer_size : upper bound of the size of the thinnest layer [m], as of
        `division.ShoeDivision`
    """
    # Within one turn from the first lining on: the ends of the columns of all linings.
    origin = min(float(ends[0]) % FULL_TURN for ends in linings)
    parts = [ends - ends[0] + (float(ends[0]) - origin) % FULL_TURN for ends in linings]
    places = np.sort(np.concatenate([part % FULL_TURN for part in parts]))
    places = places[np.append(True, np.diff(places) > SAME_ANGLE)]
    places = np.append(places[places < FULL_TURN - SAME_ANGLE], FULL_TURN)

    # Between two linings the columns grow from the size of their neighbours to the middle.
    angles, contact = [places[:1]], []
    sizes = np.diff(places)
    for k, (a, b) in enumerate(pairwise(places)):
        middle = 0.5 * (float(a) + float(b))
        covered = any(_lies_under_lining(middle, part) for part in parts)
        pieces = [b - a]
        if not covered:
            before, after = sizes[k - 1], sizes[(k + 1) % len(sizes)]
            pieces = graded_sizes(b - a, before, after, level.ratio, level.largest)
        angles.append(piece_ends(pieces, a, b)[1:])
        contact += [covered] * len(pieces)

    t = section.thickness
    layers = graded_sizes(t, min(level.back * t, singular_layer_size), t, level.through, t)
    ends = origin + np.concatenate(angles)
    return RingDivision(level.degree, ends, np.array(contact), piece_ends(layers, 0.0, t))


def _lies_under_lining(angle: float, ends: Floats) -> bool:
    """Whether an `angle` [rad] lies between the `ends` of a lining; whole turns do not count."""
    return any(ends[0] < angle + turn < ends[-1] for turn in (0.0, FULL_TURN))


def condensed_hp_ring(
    brake: Brake,
    level: Level,
    linings: tuple[ContactLine, ...],
    *,
    singular_layer_size: float = math.inf,
) -> RingSubstructure:
    """The ring of a brake in hp elements, condensed to its nodes under the linings.

    Parameters
    ----------
    brake : the brake, which has a ring with a section
    level : degree and grading
    linings : contact line of each lining, in its shoe's frame
    singular_layer_size : upper bound of the size of the thinnest layer [m], as of
        `division.ShoeDivision`
    """
    # The assertion holds of every brake that `scene.why_not` lets pass.
    ring, radius, sign = brake.ring, brake.size, brake.shoes[0].sign
    assert ring is not None and ring.section is not None
    ends = []
    for shoe, line in zip(brake.shoes, linings, strict=True):
        ends.append(np.sort(shoe.frame.theta(line.phi[:: line.order])))
    div = divide_ring(ring.section, radius, ends, level, singular_layer_size)
    free = ring.support == "free"
    grid = ring_grid(radius, sign, div)
    rim = np.zeros((2 * grid.N, 0))
    if free:
        rim = rim_forces_on_grid(radius + sign * ring.section.thickness, div, grid)

    contact = _ring_contact_line(div, grid)
    condensed = _condense_ring(ring, radius, sign, div, grid, rim)
    balance = RimBalance.of(grid, rim, condensed, contact) if free else None
    held = nodes_held(ring, grid.sets["support"])
    return couple_ring_with_linings(brake, linings, grid, grid, contact, condensed, held, balance)


def _ring_contact_line(div: RingDivision, grid: ColumnGrid) -> ContactLine:
    """The contact line of the ring: the nodes under all linings."""
    nodes, touching = grid.sets["contact"], div.contact_nodes
    place = np.full(len(div.contact) * div.degree, -1)
    place[touching] = np.arange(len(touching))
    angles = node_positions_of_row(div.angles, div.degree)[touching]
    return ContactLine(nodes, grid.doflocs[:, nodes], angles, place[div.contact_edges])


def _condense_ring(
    ring: Ring, radius: float, sign: int, div: RingDivision, grid: ColumnGrid, rim: Floats
) -> CondensedBody:
    """The ring condensed to its contact nodes, with the loads on its rim.

    Parameters
    ----------
    ring : the ring, which has a section
    radius, sign, div : as of `_stiffness_of_runs`
    grid : all nodes and elements of the ring
    rim : (2 N, l) unit loads on the rim; l is 0 where the rim is fixed
    """
    section = ring.section
    assert section is not None
    extra = rim.shape[1]
    free = extra > 0
    layers = len(div.depths) - 1
    line = order_of_column_unknowns(div.degree, layers, contact=True, held=not free).line
    n = 2 * len(div.contact_nodes)
    A = _closed_ring_stiffness(
        _stiffness_of_runs(section, radius, sign, div, free=free), div, line, extra
    )
    # Three unknowns of the rim hold a free ring; the support is statically determinate.
    if free:
        A = _hold_against_rigid_motion(A, extra, n, line, div)
    A = eliminate_side_line(ColumnSubstructure(A, 0, len(A) - extra - n), right=True).K
    back = -axis_angles_of_contact_nodes(div.angles, div.degree)[div.contact_nodes]
    L, info = dpotrf(rotate_matrix_components(A[extra:, extra:], back), lower=1)
    if info:
        raise NoAnswer(SINGULAR_BODY)
    system = partial(_uncondensed_ring_system, ring, grid, rim)
    return CondensedBody(
        L,
        L_fc=np.zeros((FRAME, n)),
        load_on_contact=-rotate_vector_components(A[:extra, extra:], back).T,
        load_on_frame=np.zeros((FRAME, extra)),
        load_work=-A[:extra, :extra],
        inner=GridUnknowns.of(grid, elastic_layers_of_ring(section), system),
        columns=LoadColumns(((RIM, extra),)),
    )


def _stiffness_of_runs(
    section: Section, radius: float, sign: int, div: RingDivision, *, free: bool
) -> list[Floats]:
    """The stiffness (n, n) of each run of element columns of a ring, from the first angle on.

    A run is all columns under one lining, or all columns between two linings.

    Parameters
    ----------
    section : section of the ring
    radius : radius of the friction surface [m]
    sign : 1 where the ring's depth grows outwards, -1 where it grows inwards
    div : division of the ring
    free : whether the far edge is free; its unit loads are then extra unknowns
    """
    p, layers = div.degree, len(div.depths) - 1
    sizes, which = distinct_sizes(np.diff(div.angles))
    along = 0.5 * sizes[:, None] * lobatto(p)
    elasticity = elasticity_of_layers(elastic_layers_of_ring(section), ("drum",) * layers)
    A = angular_integrals(along, p, directed=bool(has_directions(elasticity).any()))
    K = condensed_arc_element_stiffness(radius + sign * div.depths, A, elasticity, p)
    loads = _rim_loads_in_side_axes(radius + sign * section.thickness, along, p) if free else None
    middle = 0.5 * (div.angles[1:] + div.angles[:-1])
    runs = []
    for first, last in pairwise([*div.first_columns_of_runs, len(which)]):
        contact = bool(div.contact[first])
        kinds, kind_of = np.unique(which[first:last], return_inverse=True)
        line = order_of_column_unknowns(p, layers, contact=contact, held=not free).line
        own = None if loads is None else loads[kinds]
        made = arc_column_stiffness(K[:, :, kinds], p, contact=contact, held=not free, loads=own)
        if free:
            # The loads have their own direction in each column: no two columns are equal.
            made = _rotate_loads_to_brake_frame(made[kind_of], middle[first:last])
            kind_of = np.arange(last - first)
        kinds_made = [ColumnSubstructure(each, line, line) for each in made]
        row = [kinds_made[k] for k in kind_of]
        runs.append(assemble_column_row(row, 2 * contact, FRAME * free).K)
    return runs


def _rim_loads_in_side_axes(radius: float, along: Floats, p: int) -> Floats:
    """The rim loads of `_column_rim_loads`, with end nodes measured in the axes of column sides.

    Parameters
    ----------
    radius : radius of the rim [m]
    along : (c, p + 1) angles of the nodes about the middle of their column [rad]
    p : degree
    """
    loads = _column_rim_loads(radius, along, p)
    for at, k in ((slice(2), 0), (slice(-2, None), -1)):
        nodal = loads[:, at].transpose(0, 2, 1)
        rotated = rotate_vector_components(nodal, along[:, k, None])
        loads[:, at] = rotated.transpose(0, 2, 1)
    return loads


def _column_rim_loads(radius: float, along: Floats, p: int) -> Floats:
    """Forces (c, 2 (p + 1), 3) on the rim of columns, spread like the rigid-body modes.

    The forces are in the columns' frames, for unit loads on the whole rim of a round ring. `along`
    (c, p + 1) are the angles of the nodes about the columns' middle [rad].
    """
    xy = radius * np.array([np.cos(along), np.sin(along)])  # (2, c, p + 1)
    psi, slope = at_gauss(p)
    x = xy @ psi
    ds = np.hypot(*(xy @ slope)) * WEIGHTS / (FULL_TURN * radius)
    one, zero = np.ones_like(ds), np.zeros_like(ds)
    modes = np.array([[one, zero], [zero, one], [-x[1], x[0]]])  # (3, 2, c, q)
    found = np.einsum("aq,kicq,cq->caik", psi, modes, ds)
    return found.reshape(len(along), -1, FRAME)


def _rotate_loads_to_brake_frame(K: Floats, angle: Floats) -> Floats:
    """Columns (c, n, n) with their loads rotated from the columns' frames to the brake's frame.

    `angle` (c,) [rad] is that of each column's middle.
    """
    T = np.zeros((len(angle), FRAME, FRAME))
    T[:, 0, 0] = T[:, 1, 1] = np.cos(angle)
    T[:, 0, 1], T[:, 1, 0], T[:, 2, 2] = np.sin(angle), -np.sin(angle), 1.0
    K = K.copy()
    K[:, :FRAME] = T.transpose(0, 2, 1) @ K[:, :FRAME]
    K[:, :, :FRAME] = K[:, :, :FRAME] @ T
    return K


def _closed_ring_stiffness(runs: list[Floats], div: RingDivision, line: int, extra: int) -> Floats:
    """Stiffness of the closed ring on [extra | contact nodes by growing angle | inner lines].

    The lines stand between the runs. The first node of a line is in contact, since one of both runs
    is.

    Parameters
    ----------
    runs : stiffness of each run of columns
    div : division of the ring
    line : number of unknowns of a line without its first node
    extra : number of extra unknowns
    """
    starts, count = div.first_columns_of_runs, len(runs)
    # Number of contact unknowns of each run without its last node. A run between two linings has
    # those of its first node only.
    p = div.degree
    columns = np.diff([*starts, len(div.contact)])
    own = np.where(div.contact[starts], 2 * p * columns, 2)
    tops = extra + np.concatenate([[0], np.cumsum(own)])
    first = int(tops[-1])
    A = np.zeros((first + count * line,) * 2)
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


def _hold_against_rigid_motion(
    A: Floats, extra: int, contact: int, line: int, div: RingDivision
) -> Floats:
    """The stiffness without three unknowns at the rim, which are held against rigid-body motion.

    Two of them are the displacements of one node. The third is a displacement of another node, in
    a direction in which a rotation about the first node moves it.

    Parameters
    ----------
    A : (n, n) stiffness of the closed ring
    extra, contact, line : numbers of unknowns of the loads, of the contact, and of a line
    div : division of the ring
    """
    angles = div.angles[div.first_columns_of_runs]
    away = 0.5 * (angles - angles[0])
    k = int(np.abs(np.sin(away)).argmax())
    # Whether a rotation moves the other node more around the drum than along the radius.
    along = abs(math.sin(away[k])) > abs(math.cos(away[k]))
    node = extra + contact + line - 2
    other = extra + contact + (k + 1) * line - 2 + along
    keep = np.setdiff1d(np.arange(len(A)), [node, node + 1, other])
    return A[keep[:, None], keep]


def ring_grid(radius: float, sign: int, div: RingDivision) -> ColumnGrid:
    """All nodes and elements of a ring, with the sets "contact", "surface" and "support".

    Parameters
    ----------
    radius, sign, div : as of `_stiffness_of_runs`
    """
    p = div.degree
    depth, along = node_positions_of_row(div.depths, p), node_positions_of_row(div.angles, p)
    rows, n = len(depth), len(along) - 1
    nodes = np.arange(rows * n).reshape(rows, n)
    # The ring closes: the last column of nodes is the first column again.
    closed = np.column_stack([nodes, nodes[:, 0]])

    def point_at(depth: Floats, phi: Floats) -> Floats:
        r = radius + sign * depth
        return np.stack([r * np.cos(phi), r * np.sin(phi)])

    contact = nodes[0, div.contact_nodes]
    sets = {"contact": contact, "surface": nodes[0], "support": nodes[-1]}
    block = ElementBlock(closed, depth, along, ("drum",) * (len(div.depths) - 1))
    return ColumnGrid(p, (block,), point_at, sets, rows * n)


def rim_forces_on_grid(radius: float, div: RingDivision, grid: ColumnGrid) -> Floats:
    """Nodal forces (2 N, 3) that are spread over the rim like the rigid-body modes.

    Parameters
    ----------
    radius : radius of the rim [m]
    div : division of the ring
    grid : all nodes and elements of the ring
    """
    p, count = div.degree, len(div.contact)
    forces = np.zeros((grid.N, 2, FRAME))
    pieces = _column_rim_loads(radius, node_positions_of_elements(div.angles, p), p)
    edges = (np.arange(count)[:, None] * p + np.arange(p + 1)) % (count * p)
    np.add.at(forces, grid.sets["support"][edges], pieces.reshape(count, p + 1, 2, FRAME))
    return forces.reshape(-1, FRAME)


def _uncondensed_ring_system(
    ring: Ring, grid: ColumnGrid, rim: Floats, basis: ColumnGrid | Skeleton
) -> InnerSystem:
    """The stiffness, constraints and loads of a ring on all nodes of its grid or its skeleton.

    Parameters
    ----------
    ring : the ring, which has a section
    grid : all nodes and elements of the ring
    rim : (2 N, l) unit loads on the rim; l is 0 where the rim is fixed
    basis : the grid or its skeleton
    """
    contact = basis.numbers_of(grid.sets["contact"])
    far_edge = basis.numbers_of(grid.sets["support"])
    # The rim of a free ring has loads, and three of its unknowns are held.
    alone = statically_determinate_unknowns(basis, far_edge) if rim.shape[1] else None
    constraints = body_constraints(basis, contact, nodes_held(ring, far_edge), np.zeros(2), alone)
    loads = constraints.matrix.T @ rim[basis.dofs]
    return InnerSystem.of(ring_stiffness(basis, ring), constraints, loads)
