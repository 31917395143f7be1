"""The drum's ring in hp elements: a closed row of columns, in contact under the linings."""

import math
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.base.lapack import dpotrf
from drumlin.brake.brake import Brake
from drumlin.brake.components import Section
from drumlin.brake.elasticity import ElasticLayer, has_directions
from drumlin.fem.hp.arc import angular, arc_columns, elements
from drumlin.fem.hp.columns import (
    ColumnSubstructure,
    assembled,
    stack,
    turned,
    turned_rows,
    without_line,
)
from drumlin.fem.hp.division import Level, ends_of, graded
from drumlin.fem.hp.grid import Block, ColumnGrid, Skeleton
from drumlin.fem.hp.shoe import directions, distinct, line_of, within
from drumlin.fem.substructure.body import FRAME, CondensedBody, InnerSystem, constrain
from drumlin.fem.substructure.elasticity import ring_layers, stacked
from drumlin.fem.substructure.elimination import SINGULAR_BODY
from drumlin.fem.substructure.interface import ContactLine
from drumlin.fem.substructure.loads import LoadColumns
from drumlin.fem.substructure.ring import FreeRing, RingSubstructure, coupled_ring, determinate
from drumlin.response.resultants import WEIGHTS, at_gauss, lobatto

FULL_TURN = 2 * math.pi
"""A whole turn [rad]."""
SAME_ANGLE = 1e-9
"""Distance of two ends of columns [rad] below which they count as one: they differ by round-off."""


class RingDivision(NamedTuple):
    """The columns of a ring.

    Attributes
    ----------
    degree : of the elements
    angles : (m + 1,) ends of the columns [rad], the last one a whole turn after the first
    contact : (m,) whether each column lies under a lining
    depths : (l + 1,) ends of the layers from the friction surface on [m]
    """

    degree: int
    angles: Floats
    contact: Bools
    depths: Floats


def divide(
    section: Section, radius: float, linings: list[Floats], level: Level, sharp: float = math.inf
) -> RingDivision:
    """The division of a ring under linings.

    Parameters
    ----------
    section : of the ring
    radius : of the friction surface [m]
    linings : ends of the columns of each lining, growing, in the brake's angles [rad]
    level : degree and grading
    sharp : size of the thinnest layer [m], as of `division.ShoeDivision`
    """
    # The ends of all linings' columns within one turn from the first lining on.
    origin = min(float(ends[0]) % FULL_TURN for ends in linings)
    parts = [ends - ends[0] + (float(ends[0]) - origin) % FULL_TURN for ends in linings]
    places = np.sort(np.concatenate([part % FULL_TURN for part in parts]))
    places = places[np.append(True, np.diff(places) > SAME_ANGLE)]
    places = np.append(places[places < FULL_TURN - SAME_ANGLE], FULL_TURN)

    # Between linings the columns grow away from both neighbours.
    angles, contact = [places[:1]], []
    sizes = np.diff(places)
    for k, (a, b) in enumerate(pairwise(places)):
        middle = 0.5 * (float(a) + float(b))
        covered = any(_within(middle, part) for part in parts)
        pieces = [b - a]
        if not covered:
            before, after = sizes[k - 1], sizes[(k + 1) % len(sizes)]
            pieces = graded(b - a, before, after, level.ratio, level.largest)
        angles.append(ends_of(pieces, a, b)[1:])
        contact += [covered] * len(pieces)

    t = section.thickness
    layers = graded(t, min(level.back * t, sharp), t, level.through, t)
    ends = origin + np.concatenate(angles)
    return RingDivision(level.degree, ends, np.array(contact), ends_of(layers, 0.0, t))


def _within(angle: float, ends: Floats) -> bool:
    """Whether an angle of the first turn lies between the ends of a lining, whatever the turn."""
    return any(ends[0] < angle + turn < ends[-1] for turn in (0.0, FULL_TURN))


def ring_body(
    brake: Brake, level: Level, linings: tuple[ContactLine, ...], *, sharp: float = math.inf
) -> RingSubstructure:
    """The ring condensed under the linings.

    Parameters
    ----------
    brake : the brake, which has a ring with a section
    level : degree and grading
    linings : contact line of each lining, in its shoe's frame
    sharp : see `divide` [m]
    """
    ring, radius, sign = brake.ring, brake.size, brake.shoes[0].sign
    assert ring is not None and ring.section is not None  # scene.why_not
    ends = [
        np.sort(shoe.frame.theta(line.phi[:: line.order]))
        for shoe, line in zip(brake.shoes, linings, strict=True)
    ]
    div = divide(ring.section, radius, ends, level, sharp)
    free = ring.support == "free"
    made = _columns(ring.section, radius, sign, div, free=free)
    line = stack(level.degree, len(div.depths) - 1, contact=True, held=not free).line
    grid = grid_of(radius, sign, div)
    contact = ContactLine(
        grid.sets["contact"], grid.doflocs[:, grid.sets["contact"]], *_pieces(div)
    )
    n, extra = 2 * len(contact.nodes), FRAME * free
    A = _closed(made, div, line, extra)
    # Three unknowns of the rim hold a free ring, statically determinate.
    if free:
        A = _held(A, extra, n, line, div)
    A = without_line(ColumnSubstructure(A, 0, len(A) - extra - n), right=True).K
    back = -directions(div.angles, div.degree)[_touching(div)]
    S = turned(A[extra:, extra:], back)
    L, info = dpotrf(S, lower=1)
    if info:
        raise NoAnswer(SINGULAR_BODY)
    load = turned_rows(A[:extra, extra:], back).T
    work = -A[:extra, :extra]
    rim = np.zeros((2 * grid.N, 0))
    if free:
        rim = rim_of(radius + sign * ring.section.thickness, div, grid)
    condensed = CondensedBody(
        L,
        L_fc=np.zeros((FRAME, n)),
        load_on_contact=-load,
        load_on_frame=np.zeros((FRAME, extra)),
        load_work=work,
        inside=partial(_inside, brake, grid, rim),
        recover=partial(_recovered, brake, grid, rim),
        columns=LoadColumns((("rim", extra),)),
    )
    balance = FreeRing.of(grid, rim, condensed, contact) if free else None
    support = grid.sets["support"]
    return coupled_ring(brake, linings, grid, grid, contact, condensed, support, balance)


def _columns(
    section: Section, radius: float, sign: int, div: RingDivision, *, free: bool
) -> list[tuple[bool, Floats]]:
    """The assembled runs of columns, from the first angle on: whether in contact, and stiffness.

    Parameters
    ----------
    section : of the ring
    radius : of the friction surface [m]
    sign : 1 where the ring's depth grows outwards, -1 where it grows inwards
    div : division of the ring
    free : whether the far edge is free; its unit loads are then extra unknowns
    """
    p, layers = div.degree, len(div.depths) - 1
    sizes, which = distinct(np.diff(div.angles))
    along = 0.5 * sizes[:, None] * lobatto(p)
    elasticity = stacked(ring_layers(section), ("drum",) * layers)
    A = angular(along, p, directed=bool(has_directions(elasticity).any()))
    K = elements(radius + sign * div.depths, A, elasticity, p)
    loads = _side_loads(radius + sign * section.thickness, along, p) if free else None
    extra = FRAME * free
    middle = 0.5 * (div.angles[1:] + div.angles[:-1])
    runs = _runs(div)
    pieces = []
    for first, last in pairwise([*runs, len(which)]):
        touching = bool(div.contact[first])
        kinds, kind_of = np.unique(which[first:last], return_inverse=True)
        of = stack(p, layers, contact=touching, held=not free)
        own = None if loads is None else loads[kinds]
        made = arc_columns(K[:, :, kinds], p, contact=touching, held=not free, loads=own)
        if free:
            # The loads have their own direction in each column: no two columns are equal.
            made = _turned_loads(made[kind_of], middle[first:last])
            kind_of = np.arange(last - first)
        row = [ColumnSubstructure(each, of.line, of.line) for each in made]
        run = assembled([row[k] for k in kind_of], 2 * touching, extra)
        pieces.append((touching, run.K))
    return pieces


def _side_loads(radius: float, along: Floats, p: int) -> Floats:
    """The loads of `_rim_loads` with the end nodes in the directions of the columns' sides."""
    loads = _rim_loads(radius, along, p)
    for at, k in ((slice(2), 0), (slice(-2, None), -1)):
        nodal = loads[:, at].transpose(0, 2, 1)
        loads[:, at] = turned_rows(nodal, along[:, k, None]).transpose(0, 2, 1)
    return loads


def _rim_loads(radius: float, along: Floats, p: int) -> Floats:
    """Forces (c, 2 (p + 1), 3) on the rim's nodes of columns, spread like the rigid-body modes.

    They are in the columns' frames, for unit loads on the whole rim of a round ring. `along`
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


def _turned_loads(K: Floats, angle: Floats) -> Floats:
    """Columns (c, n, n) with their loads turned from the columns' frames to the brake's.

    `angle` (c,) [rad] is that of each column's middle.
    """
    T = np.zeros((len(angle), FRAME, FRAME))
    T[:, 0, 0] = T[:, 1, 1] = np.cos(angle)
    T[:, 0, 1], T[:, 1, 0], T[:, 2, 2] = np.sin(angle), -np.sin(angle), 1.0
    K = K.copy()
    K[:, :FRAME] = T.transpose(0, 2, 1) @ K[:, :FRAME]
    K[:, :, :FRAME] = K[:, :, :FRAME] @ T
    return K


def _closed(pieces: list[tuple[bool, Floats]], div: RingDivision, line: int, extra: int) -> Floats:
    """Stiffness of the closed ring on [extra | contact nodes by growing angle | inner lines].

    The lines stand between the runs of columns `pieces`. The first node of a line is in contact,
    since one of both runs is. `line` is the number of unknowns of the rest of a line, and `extra`
    that of the extra unknowns.
    """
    count = len(pieces)
    inner = [len(K) - extra - 2 * line - 4 if touching else 0 for touching, K in pieces]
    tops = extra + np.cumsum([0, *(2 + n for n in inner)])
    first = int(tops[-1])
    A = np.zeros((first + count * line,) * 2)
    for k, (touching, K) in enumerate(pieces):
        after = (k + 1) % count
        nodes = [np.arange(tops[j], tops[j] + 2) for j in (k, after)]
        lines = [np.arange(first + j * line, first + (j + 1) * line) for j in (k, after)]
        between = np.arange(tops[k] + 2, tops[k] + 2 + inner[k])
        own = (
            [lines[0], nodes[0], between, nodes[1], lines[1]]
            if touching
            else [nodes[0], lines[0], nodes[1], lines[1]]
        )
        place = np.concatenate([np.arange(extra), *own])
        np.add.at(A, (place[:, None], place), K)
    return A


def _held(A: Floats, extra: int, contact: int, line: int, div: RingDivision) -> Floats:
    """The stiffness without three unknowns at the rim, which hold the ring against rigid motion.

    They are both displacements of one node, and one displacement of another node that turns about
    the first.
    """
    angles = div.angles[_runs(div)]
    away = 0.5 * (angles - angles[0])
    k = int(np.abs(np.sin(away)).argmax())
    # A rotation moves the other node rather around the drum than along the radius.
    along = abs(math.sin(away[k])) > abs(math.cos(away[k]))
    node = extra + contact + line - 2
    other = extra + contact + (k + 1) * line - 2 + along
    keep = np.setdiff1d(np.arange(len(A)), [node, node + 1, other])
    return A[keep[:, None], keep]


def _runs(div: RingDivision) -> Ints:
    """The first columns of the runs, each of which is under one lining or between two."""
    runs = np.flatnonzero(np.diff(div.contact, prepend=not div.contact[0]))
    # A ring in contact all around has two runs, so that a line between them closes it.
    return runs if len(runs) > 1 else np.array([0, 1])


def _pieces(div: RingDivision) -> tuple[Floats, Ints]:
    """Angles of the contact nodes, and their positions (p + 1, m) in each column in contact."""
    touching = _touching(div)
    place = np.full(len(div.contact) * div.degree, -1)
    place[touching] = np.arange(len(touching))
    at = np.flatnonzero(div.contact) * div.degree + np.arange(div.degree + 1)[:, None]
    return line_of(div.angles, div.degree)[touching], place[at % len(place)]


def _touching(div: RingDivision) -> Ints:
    """The nodes of the friction surface that lie under a lining, counted from the first angle on."""
    at = np.flatnonzero(div.contact) * div.degree + np.arange(div.degree + 1)[:, None]
    return np.unique(at % (len(div.contact) * div.degree))


def grid_of(radius: float, sign: int, div: RingDivision) -> ColumnGrid:
    """All nodes and elements of a ring, with the sets "contact", "surface" and "support"."""
    p = div.degree
    depth, along = line_of(div.depths, p), line_of(div.angles, p)
    rows, n = len(depth), len(along) - 1
    under = np.arange(rows * n).reshape(rows, n)
    under = np.column_stack([under, under[:, 0]])

    def place(depth: Floats, phi: Floats) -> Floats:
        r = radius + sign * depth
        return np.stack([r * np.cos(phi), r * np.sin(phi)])

    sets = {
        "contact": under[0, _touching(div)],
        "surface": under[0, :-1],
        "support": under[-1, :-1],
    }
    return ColumnGrid(
        p, (Block(under, depth, along, ("drum",) * (len(div.depths) - 1)),), place, sets, rows * n
    )


def rim_of(radius: float, div: RingDivision, grid: ColumnGrid) -> Floats:
    """Nodal forces (2 N, 3) that are spread over the rim like the rigid-body modes."""
    p, found = div.degree, np.zeros((grid.N, 2, FRAME))
    pieces = _rim_loads(radius, within(div.angles, p), p).reshape(len(div.contact), p + 1, 2, FRAME)
    rim = np.append(grid.sets["support"], grid.sets["support"][0])
    at = rim[np.arange(len(div.contact))[:, None] * p + np.arange(p + 1)]
    np.add.at(found, at, pieces)
    return found.reshape(-1, FRAME)


def _inside(brake: Brake, grid: ColumnGrid, rim: Floats) -> InnerSystem:
    """The whole system of a ring."""
    return _reduced(brake, grid, grid.sets["support"], grid.sets["contact"], rim)


def _recovered(
    brake: Brake, grid: ColumnGrid, rim: Floats, nodal: Floats, frame: Floats, loads: Floats
) -> Floats:
    """The displacements of `CondensedBody`, with the insides of elements eliminated one by one."""
    sides = grid.skeleton
    support, contact = (sides.place[grid.sets[name]] for name in ("support", "contact"))
    inside = _reduced(brake, sides, support, contact, rim[sides.dofs])
    return sides.everywhere(_layers(brake), inside.displacements(nodal, frame, loads))


def _layers(brake: Brake) -> dict[str, ElasticLayer]:
    """The one layer of the brake's ring, by the name of its subdomain."""
    ring = brake.ring
    assert ring is not None and ring.section is not None  # scene.why_not
    return ring_layers(ring.section)


def _reduced(
    brake: Brake, basis: ColumnGrid | Skeleton, support: Ints, contact: Ints, rim: Floats
) -> InnerSystem:
    """The stiffness of a ring and the unit loads `rim` (2 nodes, l) on its reduced unknowns."""
    K, ring = basis.stiffness(_layers(brake)), brake.ring
    if ring is not None and ring.support == "fixed":
        constraints = constrain(basis, contact, support, np.zeros(2))
        loads = np.zeros((constraints.matrix.shape[1], 0))
    else:
        constraints = constrain(
            basis, contact, support[:0], np.zeros(2), determinate(basis, support)
        )
        loads = constraints.matrix.T @ rim
    return InnerSystem((constraints.matrix.T @ K @ constraints.matrix).tocsc(), constraints, loads)
