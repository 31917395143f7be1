"""A parametric shoe of columns: its geometry, and its condensation to contact, frame and actuation."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.brake.beam_axis import axis_of
from drumlin.brake.brake import Shoe
from drumlin.brake.components import Beam
from drumlin.brake.elasticity import ElasticLayer, has_directions
from drumlin.fem.hp.arc import angular, arc_columns, elements
from drumlin.fem.hp.columns import (
    ColumnSubstructure,
    assembled,
    columns,
    stack,
    turned,
    turned_rows,
    without_line,
)
from drumlin.fem.hp.division import ShoeDivision
from drumlin.fem.hp.element import condensed_elements, element, gauss_points
from drumlin.fem.substructure.body import FRAME
from drumlin.fem.substructure.elasticity import stacked
from drumlin.fem.substructure.loads import ACTUATION, LoadColumns
from drumlin.response.resultants import GAUSS, WEIGHTS, at_gauss, lobatto

LEFT = 0.02
"""Fraction of the uncorrected rigid-body residual that the round-off estimate still assumes after
the correction that takes it off. 0 would call corrected answers exact; 1 would refuse what is
right.
"""
Map = Callable[
    [Floats, Floats], Floats
]  # depth, place along -> points (2, ...) [m] in the shoe's frame


def end_load(xy: Floats, depths: Floats, p: int) -> tuple[Floats, Floats]:
    """Nodal forces (2n, 3) [1, 1, 1/m] of unit force x, y and couple on the straight loaded end,
    and its centre (2,) [m].

    The force is spread evenly, the couple as a traction that grows linearly from the centre. xy (2,
    n) [m]: nodes of the end at the `depths` (n,), which are in proportion to the distance along it.
    """
    ends = (depths[::p] - depths[0]) / (depths[-1] - depths[0]) - 0.5  # from -1/2 to 1/2
    at = np.arange(len(ends) - 1)[:, None] * p + np.arange(p + 1)
    (psi, _), half = at_gauss(p), 0.5 * (ends[1:] - ends[:-1])[:, None]
    where = ends[:-1, None] + half * (1 + GAUSS)
    even = np.bincount(at.ravel(), ((half * WEIGHTS) @ psi.T).ravel())
    turning = np.bincount(at.ravel(), ((half * WEIGHTS * where) @ psi.T).ravel()) * 12
    end, centre = xy[:, -1] - xy[:, 0], 0.5 * (xy[:, -1] + xy[:, 0])
    load = np.zeros((xy.shape[1], 2, FRAME))
    load[:, 0, 0] = load[:, 1, 1] = even
    load[:, :, 2] = turning[:, None] * np.array([-end[1], end[0]]) / (end @ end)
    return load.reshape(-1, FRAME), centre


class LoadedEnd(NamedTuple):
    """Unit loads on the loaded end: nodal `forces` (2n, l) by `columns`, the `centre` (2,) [m] of the
    unit actuations, and the `moments` (3, l) of all loads: force x, y and couple about the centre.
    """

    forces: Floats
    columns: LoadColumns
    centre: Floats
    moments: Floats

    def resultants(self, pin: Floats) -> Floats:
        """Force x, y and moment (3, l) about the `pin` (2,) [m]."""
        arm = self.centre - pin
        found = self.moments.copy()
        found[2] += arm[0] * self.moments[1] - arm[1] * self.moments[0]
        return found


EndLoads = Callable[[Floats, Floats, int], LoadedEnd]
"""Makes the loads of the loaded end from its nodes (2, n) [m], their depths (n,) and the degree."""


def unit_actuations(xy: Floats, depths: Floats, p: int) -> LoadedEnd:
    """The three unit actuations on the loaded end, see `end_load`."""
    forces, centre = end_load(xy, depths, p)
    return LoadedEnd(forces, LoadColumns(((ACTUATION, FRAME),)), centre, np.eye(FRAME))


class CondensedShoe(NamedTuple):
    """Stiffness `S` (3 + 2n, 3 + 2n) on [frame | contact nodes x, y], the unit `loads` (3 + 2n, l)
    on them, named by `columns`, their `work` (l, l) with both held, and the centre (2,) [m] that
    the unit actuations act about.

    What round-off left: about the forces `missed` (2n, 3) on the contact by rigid motions, which
    strain nothing; and `lost`, by how much a unit force was out of balance. Where the frame is the
    back itself they are not known, and zero.
    """

    S: Floats
    loads: Floats
    work: Floats
    centre: Floats
    rigid_mode_forces: Floats
    force_imbalance: float
    columns: LoadColumns


def map_of(shoe: Shoe, radius: float) -> Map:
    """Where the points of a division lie."""
    return _beam_map(shoe, radius) if isinstance(shoe.body, Beam) else partial(shoe.at, size=radius)


def _beam_map(shoe: Shoe, radius: float) -> Map:
    """Depth 0 to 1: the lining, to 2: the block, cut square to the beam, to 3: the beam."""
    assert isinstance(shoe.body, Beam) and shoe.body.section is not None  # why_not
    axis, thickness = axis_of(shoe.pin.xy, shoe.actuation.point.xy), shoe.lining.thickness
    back, beam = radius + thickness, shoe.body.section.thickness
    s, e = shoe.arc
    start = float(np.min(axis.angle(shoe.frame.theta(np.array([s, e])))))

    def place(depth: Floats, phi: Floats) -> Floats:
        depth, phi = np.broadcast_arrays(depth, phi)
        a = np.clip(phi, s, e) - s + start  # the angle under the lining from the axis's foot
        beyond = back * (np.minimum(phi - s, 0) + np.maximum(phi - e, 0))
        r = radius + thickness * np.minimum(depth, 1)
        x, y = axis.foot + r * np.sin(a), axis.distance - r * np.cos(a)
        x, y = x + beyond, np.where(depth > 1, y + np.minimum(depth - 1, 1) * (beam / 2 - y), y)
        y = np.where(depth > 2, beam / 2 - (depth - 2) * beam, y)
        return np.moveaxis(shoe.frame.to_shoe(axis.to_brake(x, y)), -1, 0)

    return place


def within(ends: Floats, p: int) -> Floats:
    """The nodes (m, p + 1) of the pieces between ends (m + 1,)."""
    first, last = ends[:-1, None], ends[1:, None]
    return np.asarray(0.5 * (last + first) + 0.5 * (last - first) * lobatto(p))


def line_of(ends: Floats, p: int) -> Floats:
    """The nodes of all pieces between ends (m + 1,), those in common once: (m p + 1,)."""
    found = np.empty((len(ends) - 1) * p + 1)
    found[:-1] = within(ends, p)[:, :-1].ravel()
    found[-1] = ends[-1]
    return found


def nodes_of(place: Map, depths: Floats, along: Floats, p: int) -> Floats:
    """Nodes (layers, columns, 2, a) of elements between depths (l + 1,) and at the places `along`
    (c, p + 1).
    """
    xy = place(within(depths, p)[:, None, :, None], along[:, None, :])  # (2, layers, columns, i, j)
    xy = xy.reshape(*xy.shape[:3], -1).transpose(1, 2, 0, 3)
    return np.ascontiguousarray(xy[..., element(p).order])


def distinct(sizes: Floats) -> tuple[Floats, Ints]:
    """The different ones of sizes (m,), equal up to round-off, and which of them each is (m,)."""
    found: dict[float, int] = {}
    which = [found.setdefault(float(f"{size:.11e}"), len(found)) for size in sizes.tolist()]
    return np.array(list(found)), np.array(which)


def _along(layers: dict[str, ElasticLayer], part: tuple[str, ...], xy: Floats, p: int) -> Floats:
    """Unit vectors along the layers (l, c, 2, q) at the Gauss points of their elements with nodes
    xy (l, c, 2, a)."""
    points = np.moveaxis(gauss_points(xy, p), 2, 1)  # (l, 2, c, q)
    found = [layers[name].directions(own) for name, own in zip(part, points, strict=True)]
    return np.moveaxis(np.array(found), 1, 2)


def rigid(xy: Floats, pin: Floats) -> Floats:
    """Displacements (2n, 3) of nodes xy (2, n) per dx, dy and turn about the pin."""
    R = np.zeros((xy.shape[1], 2, FRAME))
    R[:, 0, 0] = R[:, 1, 1] = 1.0
    R[:, 0, 2], R[:, 1, 2] = pin[1] - xy[1], xy[0] - pin[0]
    return R.reshape(-1, FRAME)


class _Columns(NamedTuple):
    """Columns under the lining, before and behind it, in their order, equal ones the same object;
    `grip`: the first one under the lining whose back is held, and the first one after those that is
    free again; 0, 0 where none is.
    """

    under: list[ColumnSubstructure]
    before: list[ColumnSubstructure]
    after: list[ColumnSubstructure]
    grip: tuple[int, int]


def _columns(
    shoe: Shoe, radius: float, div: ShoeDivision, layers: dict[str, ElasticLayer]
) -> _Columns:
    p, beyond, beam = div.degree, [div.before[::-1], div.after], isinstance(shoe.body, Beam)
    parts = [div.angles, *beyond] if div.first < div.layers else [div.angles]
    under, before = len(div.angles) - 1, len(div.before) - 1
    elasticity, plane = stacked(layers, div.part), radius if shoe.flat else None
    directed = bool(has_directions(elasticity).any())
    if beam:
        along = np.concatenate([within(ends, p) for ends in parts])  # (columns, p + 1)
        which = np.arange(len(along))
    else:
        sizes, which = distinct(np.concatenate([ends[1:] - ends[:-1] for ends in parts]))
        A = angular(0.5 * sizes[:, None] * lobatto(p), p, flat=shoe.flat, directed=directed)

    def made(row: Ints, layer: int, *, contact: bool, held: bool) -> list[ColumnSubstructure]:
        """The columns of a row of kinds, of the layers from `layer` on."""
        if not len(row):
            return []
        kinds = np.flatnonzero(np.bincount(row))  # np.unique loads np.ma
        depths, of = div.depths[layer:], stack(p, div.layers - layer, contact=contact, held=held)
        if beam:
            xy = nodes_of(map_of(shoe, radius), depths, along[kinds], p)
            along_layers = _along(layers, div.part[layer:], xy, p) if directed else None
            found = columns(condensed_elements(xy, elasticity[layer:], p, along_layers), of)
        else:
            own = elements(radius - shoe.sign * depths, A[:, kinds], elasticity[layer:], p, plane)
            found = arc_columns(own, p, contact=contact, held=held)
        pieces = {
            kind: ColumnSubstructure(K, of.line, of.line)
            for kind, K in zip(kinds.tolist(), found, strict=True)
        }
        return [pieces[kind] for kind in row.tolist()]

    ends = shoe.grip(radius)
    a, b = (0, 0) if ends is None else (int(np.abs(div.angles - x).argmin()) for x in ends)
    free = made(
        np.concatenate([which[:a], which[b:under]]), 0, contact=True, held=div.first == div.layers
    )
    gripped = made(which[a:b], 0, contact=True, held=True)
    rest = made(which[under:], div.first, contact=False, held=False)
    return _Columns([*free[:a], *gripped, *free[a:]], rest[:before], rest[before:], (a, b))


def directions(ends: Floats, p: int) -> Floats:
    """Angles (m p + 1,) of the directions of contact nodes: of those between the ends (m + 1,) of
    columns, in their column's middle.
    """
    found = np.append(np.repeat(0.5 * (ends[1:] + ends[:-1]), p), 0.0)
    found[::p] = ends
    return found


def _angle_at(shoe: Shoe, phi: Floats) -> Floats:
    """The angles [rad] at which unknowns count at the places phi of columns: of an arc along its
    radius, of a pad along the normal, which has the plane's x as its tangent.
    """
    if isinstance(shoe.body, Beam):
        return np.zeros_like(phi)
    return np.full_like(phi, -0.5 * np.pi) if shoe.flat else phi


def condense(
    shoe: Shoe,
    radius: float,
    div: ShoeDivision,
    layers: dict[str, ElasticLayer],
    end_loads: EndLoads = unit_actuations,
) -> CondensedShoe:
    """The shoe on its frame and its contact nodes, by growing angle.

    Parameters
    ----------
    radius : of the drum [m]
    layers : elasticity of the layers by name
    end_loads : the unit loads on the loaded end; a shoe whose back is held has the three unit
        actuations on its frame and no others

    Raises
    ------
    NoAnswer
        for a singular stiffness
    """
    p, place, pin = div.degree, map_of(shoe, radius), shoe.own_pin
    found, held = _columns(shoe, radius, div, layers), div.first == div.layers
    phi, back = line_of(div.angles, p), -_angle_at(shoe, directions(div.angles, p))
    R = rigid(place(np.zeros(1), phi), pin)
    if held or any(
        found.grip
    ):  # its back is held, by a grip or as a rigid shoe, and the force acts on what holds it
        S = turned(_on_grip(found) if any(found.grip) else _between(found.under), back)
        none, still = np.zeros((FRAME, FRAME)), np.zeros((len(R), FRAME))
        on_frame = np.vstack([np.eye(FRAME), still])
        named = LoadColumns(((ACTUATION, FRAME),))
        return CondensedShoe(_balanced(S, R), on_frame, none, pin, still, 0.0, named)
    d = line_of(div.depths[div.first :], p)
    near, far = div.before[-1], div.after[-1]
    held_line = _local(rigid(place(d, near), pin), _angle_at(shoe, near))
    end = end_loads(place(d, far), d, p)
    f = _local(end.forces, _angle_at(shoe, far))
    row = found.under.copy()
    row[0] = _held(row[0], found.before, held_line)
    row[-1] = without_line(row[-1], _loaded(found.after, f), len(f), right=True)
    A = assembled(row, 2).K
    extra = end.columns.count
    frame, contact, loads = slice(FRAME), slice(FRAME, -extra), slice(-extra, None)
    S, load = turned(A[contact, contact], back), -turned_rows(A[loads, contact], back).T
    on_frame = -A[frame, loads]
    off = end.resultants(pin) - on_frame - R.T @ load
    load += R @ np.linalg.solve(R.T @ R, off)
    S, missed = _still(S, R, turned_rows(A[frame, contact], back).T)
    lost = float(np.abs(off[:2, end.columns.places[ACTUATION]][:, :2]).max())
    return CondensedShoe(
        _balanced(S, R),
        np.concatenate([on_frame, load]),
        -A[loads, loads],
        end.centre,
        missed,
        lost,
        end.columns,
    )


def _between(
    row: list[ColumnSubstructure], left: Floats | None = None, right: Floats | None = None
) -> Floats:
    """Columns under the lining on their contact nodes; left, right: stiffness of what hangs on the
    ends' back.
    """
    row = row.copy()
    row[0] = without_line(row[0], left, 0 if left is None else len(left))
    row[-1] = without_line(row[-1], right, 0 if right is None else len(right), right=True)
    return assembled(row, 2).K


def _on_grip(found: _Columns) -> Floats:
    """The contact nodes of a lining whose body's back is held by a grip: what the body is beyond
    the lining is free.
    """
    row, (first, last) = found.under.copy(), found.grip
    line = row[first].left  # without the last node of the others' lines, which is held
    if first > 0:
        K, left, _ = row[first - 1]
        row[first - 1] = ColumnSubstructure(K[:-2, :-2], left, line)
    if last < len(row):
        K, _, right = row[last]
        free = np.delete(np.arange(len(K)), [line, line + 1])
        row[last] = ColumnSubstructure(K[free[:, None], free], line, right)
    ends = (
        without_line(assembled(beyond, 0), right=far).K if beyond else None
        for beyond, far in ((found.before, False), (found.after, True))
    )
    return _between(row, *ends)


def _held(
    first: ColumnSubstructure, before: list[ColumnSubstructure], held: Floats
) -> ColumnSubstructure:
    """The first column under the lining closed by the body before it, down to the hinge: [frame |
    its own].

    held (n, 3): motions of the line at the hinge per dx, dy and turn.
    """
    part = len(held)
    if before:
        return without_line(first, assembled([_tied(before[0], held), *before[1:]], 0).K, part)
    return without_line(_tied(first, held))  # it is held where the lining begins


def _loaded(after: list[ColumnSubstructure], load: Floats) -> Floats:
    """Stiffness on [line at the lining's end | loads] of the body behind the lining; load (n, l):
    unit loads on the line at its end.
    """
    part, count = load.shape
    end = np.zeros((part + count, part + count))
    end[:part, part:], end[part:, :part] = -load, -load.T
    if not after:
        return end
    return assembled([*after[:-1], without_line(after[-1], end, part, right=True)], 0).K


def _tied(piece: ColumnSubstructure, held: Floats) -> ColumnSubstructure:
    """A piece the last unknowns of whose left line move with the frame by `held` (n, 3): [left line
    | frame | ...].
    """
    left = piece.left - len(held)
    at, frame = slice(left, piece.left), slice(left, left + FRAME)
    rest = np.arange(len(piece.K) - len(held))
    others, n = rest.copy(), len(rest) + FRAME
    rest[left:] += len(held)
    others[left:] += FRAME
    K = np.empty((n, n))
    K[others[:, None], others] = piece.K[rest[:, None], rest]
    K[frame, frame] = held.T @ piece.K[at, at] @ held
    K[frame, others] = held.T @ piece.K[at][:, rest]
    K[others, frame] = K[frame, others].T
    return ColumnSubstructure(K, left, piece.right)


def _still(S: Floats, R: Floats, held: Floats) -> tuple[Floats, Floats]:
    """The stiffness S (2n, 2n) of the contact nodes without what round-off made of it, and about
    the forces (2n, 3) that this leaves: those half way, and LEFT of those before.

    The forces `held` (2n, 3) on the contact by motions of the frame are small beside the stiffness
    of thin columns, and have more digits: moved with the frame by R (2n, 3) the contact strains
    nothing, S R = -held. First each node's own part is corrected, where most was lost; then all by
    the least change, symmetric, that leaves nothing.
    """
    S, own = S.copy(), np.arange(len(S)).reshape(-1, 2)
    before = S @ R + held
    node = before[:, :2].reshape(-1, 2, 2)
    S[own[:, :, None], own[:, None]] -= 0.5 * (node + node.swapaxes(1, 2))
    after = S @ R + held
    back = R @ np.linalg.inv(R.T @ R)
    change, moment = back @ after.T, R.T @ after
    return S - change - change.T + back @ (
        0.5 * (moment + moment.T)
    ) @ back.T, after + LEFT * before


def _balanced(S: Floats, R: Floats) -> Floats:
    """Stiffness on [frame | contact nodes] from that of the contact nodes: rigid motions R (2n, 3)
    strain nothing.
    """
    SR = S @ R
    whole = np.empty((FRAME + len(S), FRAME + len(S)))
    whole[:FRAME, :FRAME], whole[:FRAME, FRAME:], whole[FRAME:, :FRAME], whole[FRAME:, FRAME:] = (
        R.T @ SR,
        -SR.T,
        -SR,
        S,
    )
    return whole


def _local(V: Floats, angle: Floats) -> Floats:
    """Vectors V (2n, m) in directions turned by one angle."""
    return turned_rows(V.T, np.reshape(angle, 1)).T
