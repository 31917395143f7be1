"""The drum's ring of columns: a closed row, in contact under the linings."""

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
SAME_ANGLE = 1e-9  # rad: ends of columns that are nearer to each other are one


class RingDivision(NamedTuple):
    """Columns of a ring: their ends `angles` (m + 1,), the last a whole turn after the first; which
    of them lie under a lining, `contact` (m,); `depths` (l + 1,) [m] of the ends of the layers from
    the friction surface on.
    """

    degree: int
    angles: Floats
    contact: Bools
    depths: Floats


def divide(
    section: Section, radius: float, linings: list[Floats], level: Level, sharp: float = math.inf
) -> RingDivision:
    """The division of a ring; `linings`: ends of the columns of each, growing, in the brake's
    angles [rad]; sharp [m]: as of the linings' `division.RingDivision`, that of the thinnest layer.
    """
    origin = min(float(ends[0]) % FULL_TURN for ends in linings)
    parts = [ends - ends[0] + (float(ends[0]) - origin) % FULL_TURN for ends in linings]
    places = np.sort(np.concatenate([part % FULL_TURN for part in parts]))
    places = places[np.append(True, np.diff(places) > SAME_ANGLE)]
    places = np.append(places[places < FULL_TURN - SAME_ANGLE], FULL_TURN)
    under = [
        any(_within(0.5 * (a + b), part) for part in parts) for a, b in pairwise(places.tolist())
    ]
    angles, contact = [places[:1]], []
    sizes = np.diff(places)
    for k, (a, b, covered) in enumerate(zip(places[:-1], places[1:], under, strict=True)):
        pieces = (
            [b - a]
            if covered
            else graded(
                b - a, sizes[k - 1], sizes[(k + 1) % len(sizes)], level.ratio, level.largest
            )
        )
        angles.append(ends_of(pieces, a, b)[1:])
        contact += [covered] * len(pieces)
    t = section.thickness
    layers = graded(t, min(level.back * t, sharp), t, level.through, t)
    return RingDivision(
        level.degree, origin + np.concatenate(angles), np.array(contact), ends_of(layers, 0.0, t)
    )


def _within(angle: float, ends: Floats) -> bool:
    return any(ends[0] < angle + turn < ends[-1] for turn in (0.0, FULL_TURN))


def ring_body(
    brake: Brake, level: Level, linings: tuple[ContactLine, ...], *, sharp: float = math.inf
) -> RingSubstructure:
    """The ring condensed under the linings, given by their contact lines in the shoes' frames;
    sharp: see `divide`.
    """
    ring, radius, sign = brake.ring, brake.size, brake.shoes[0].sign
    assert ring is not None and ring.section is not None  # scene.why_not
    ends = [
        np.sort(shoe.frame.theta(line.phi[:: line.order]))
        for shoe, line in zip(brake.shoes, linings, strict=True)
    ]
    div = divide(ring.section, radius, ends, level, sharp)
    free = ring.support == "free"
    made, line = _columns(ring.section, radius, sign, div, free=free)
    grid = grid_of(radius, sign, div)
    contact = ContactLine(
        grid.sets["contact"], grid.doflocs[:, grid.sets["contact"]], *_pieces(div)
    )
    n, extra = 2 * len(contact.nodes), FRAME * free
    A = _closed(made, div, line, extra)
    if free:  # three unknowns of the rim hold it, statically determinate
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
    inside, recover = partial(_inside, brake, grid, rim), partial(_recovered, brake, grid, rim)
    to_frame, on_frame = np.zeros((FRAME, n)), np.zeros((FRAME, extra))
    named = LoadColumns((("rim", extra),))
    condensed = CondensedBody(L, to_frame, -load, on_frame, work, inside, recover, named)
    held = None
    if free:
        held = FreeRing.of(grid, rim, condensed, contact)
    return coupled_ring(brake, linings, grid, grid, contact, condensed, grid.sets["support"], held)


def _columns(
    section: Section, radius: float, sign: int, div: RingDivision, *, free: bool
) -> tuple[list[tuple[bool, Floats]], int]:
    """Pieces of columns, in contact and not, merged, in their order from the first angle on;
    unknowns of a line.
    """
    p, layers = div.degree, len(div.depths) - 1
    sizes, which = distinct(np.diff(div.angles))
    along = 0.5 * sizes[:, None] * lobatto(p)
    elasticity = stacked(ring_layers(section), ("drum",) * layers)
    A = angular(along, p, directed=bool(has_directions(elasticity).any()))
    K = elements(radius + sign * div.depths, A, elasticity, p)
    loads = None
    if free:
        loads = _rim_loads(radius + sign * section.thickness, along, p)
        for at, k in (
            (slice(2), 0),
            (slice(-2, None), -1),
        ):  # in the directions of the columns' sides
            loads[:, at] = turned_rows(
                loads[:, at].transpose(0, 2, 1), along[:, k, None]
            ).transpose(0, 2, 1)
    extra = FRAME * free
    pieces = []
    middle = 0.5 * (div.angles[1:] + div.angles[:-1])
    runs = _runs(div)
    for first, last in zip(runs, [*runs[1:], len(which)], strict=True):
        touching = bool(div.contact[first])
        kinds, place_of = np.unique(which[first:last], return_inverse=True)
        of, own = (
            stack(p, layers, contact=touching, held=not free),
            None if loads is None else loads[kinds],
        )
        made = arc_columns(K[:, :, kinds], p, contact=touching, held=not free, loads=own)
        if free:
            made, place_of = (
                _turned_loads(made[place_of], middle[first:last]),
                np.arange(last - first),
            )
        row = [ColumnSubstructure(each, of.line, of.line) for each in made]
        pieces.append((touching, assembled([row[k] for k in place_of], 2 * touching, extra).K))
    return pieces, stack(p, layers, contact=True, held=not free).line


def _rim_loads(radius: float, along: Floats, p: int) -> Floats:
    """Forces (c, 2 (p + 1), 3) on the rim's nodes of columns at the angles `along`, as the rigid
    motions, in the columns' frames; all over the rim's length of a round ring.
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
    """Columns (c, n, n) in place: their extra unknowns, loads in the column's own frame, in the
    brake's.
    """
    T = np.zeros((len(angle), FRAME, FRAME))
    T[:, 0, 0] = T[:, 1, 1] = np.cos(angle)
    T[:, 0, 1], T[:, 1, 0], T[:, 2, 2] = np.sin(angle), -np.sin(angle), 1.0
    K = K.copy()
    K[:, :FRAME] = T.transpose(0, 2, 1) @ K[:, :FRAME]
    K[:, :, :FRAME] = K[:, :, :FRAME] @ T
    return K


def _closed(pieces: list[tuple[bool, Floats]], div: RingDivision, line: int, extra: int) -> Floats:
    """The ring on [extra | contact nodes by growing angle | inner part of the lines between the
    pieces].

    The first node of a line touches, since one side of it at least does; `line`: the unknowns of
    its inner part.
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
    """Without three unknowns at the rim that hold it against rigid motion: a node, and another one
    that turns about it.
    """
    angles = div.angles[_runs(div)]
    away = 0.5 * (angles - angles[0])
    k = int(np.abs(np.sin(away)).argmax())
    along = abs(math.sin(away[k])) > abs(
        math.cos(away[k])
    )  # a turn moves it rather around than along the radius
    node = extra + contact + line - 2
    other = extra + contact + (k + 1) * line - 2 + along
    keep = np.setdiff1d(np.arange(len(A)), [node, node + 1, other])
    return A[keep[:, None], keep]


def _runs(div: RingDivision) -> Ints:
    """The first columns of the pieces, each under one lining or between two."""
    runs = np.flatnonzero(np.diff(div.contact, prepend=not div.contact[0]))
    return runs if len(runs) > 1 else np.array([0, 1])  # in contact all around


def _pieces(div: RingDivision) -> tuple[Floats, Ints]:
    """Angles of the contact nodes and their positions in each piece under a lining (p + 1, m)."""
    touching = _touching(div)
    place = np.full(len(div.contact) * div.degree, -1)
    place[touching] = np.arange(len(touching))
    at = np.flatnonzero(div.contact) * div.degree + np.arange(div.degree + 1)[:, None]
    return line_of(div.angles, div.degree)[touching], place[at % len(place)]


def _touching(div: RingDivision) -> Ints:
    """The nodes of the friction surface that lie under a lining, of all of them from the first
    angle on.
    """
    at = np.flatnonzero(div.contact) * div.degree + np.arange(div.degree + 1)[:, None]
    return np.unique(at % (len(div.contact) * div.degree))


def grid_of(radius: float, sign: int, div: RingDivision) -> ColumnGrid:
    """All nodes and elements of a ring; sets "contact", by growing angle, "surface" and "support"."""
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
    """Nodal forces (2 N, 3) spread over the rim as the rigid motions are."""
    p, found = div.degree, np.zeros((grid.N, 2, FRAME))
    pieces = _rim_loads(radius, within(div.angles, p), p).reshape(len(div.contact), p + 1, 2, FRAME)
    rim = np.append(grid.sets["support"], grid.sets["support"][0])
    at = rim[np.arange(len(div.contact))[:, None] * p + np.arange(p + 1)]
    np.add.at(found, at, pieces)
    return found.reshape(-1, FRAME)


def _inside(brake: Brake, grid: ColumnGrid, rim: Floats) -> InnerSystem:
    return _reduced(brake, grid, grid.sets["support"], grid.sets["contact"], rim)


def _recovered(
    brake: Brake, grid: ColumnGrid, rim: Floats, nodal: Floats, frame: Floats, loads: Floats
) -> Floats:
    """What `CondensedBody.displacements` returns, with the elements' insides eliminated one by one."""
    sides = grid.skeleton
    support, contact = (sides.place[grid.sets[name]] for name in ("support", "contact"))
    inside = _reduced(brake, sides, support, contact, rim[sides.dofs])
    return sides.everywhere(_layers(brake), inside.displacements(nodal, frame, loads))


def _layers(brake: Brake) -> dict[str, ElasticLayer]:
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
