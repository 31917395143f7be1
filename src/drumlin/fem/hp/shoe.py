"""A parametric shoe of columns: its geometry, and its condensation to contact, frame and loads."""

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

Map = Callable[[Floats, Floats], Floats]
"""From depths and positions along the lining to points (2, ...) in the shoe's frame [m]."""


def end_load(xy: Floats, depths: Floats, p: int) -> tuple[Floats, Floats]:
    """Nodal forces (2n, 3) of unit force x, unit force y and unit couple, and their centre (2,) [m].

    They act on the straight loaded end. The forces are spread evenly; the couple is a traction that
    grows linearly from the centre. The unit of the forces is [1], that of the couple's [1/m].

    Parameters
    ----------
    xy : (2, n) nodes of the end [m]
    depths : (n,) their depths, in proportion to the distance along the end
    p : degree
    """
    # Positions along the end, from -1/2 to 1/2.
    ends = (depths[::p] - depths[0]) / (depths[-1] - depths[0]) - 0.5
    at = np.arange(len(ends) - 1)[:, None] * p + np.arange(p + 1)
    psi, _ = at_gauss(p)
    half = 0.5 * (ends[1:] - ends[:-1])[:, None]
    where = ends[:-1, None] + half * (1 + GAUSS)
    even = np.bincount(at.ravel(), ((half * WEIGHTS) @ psi.T).ravel())
    linear = np.bincount(at.ravel(), ((half * WEIGHTS * where) @ psi.T).ravel()) * 12
    end = xy[:, -1] - xy[:, 0]
    centre = 0.5 * (xy[:, -1] + xy[:, 0])
    load = np.zeros((xy.shape[1], 2, FRAME))
    load[:, 0, 0] = load[:, 1, 1] = even
    load[:, :, 2] = linear[:, None] * np.array([-end[1], end[0]]) / (end @ end)
    return load.reshape(-1, FRAME), centre


class LoadedEnd(NamedTuple):
    """Unit loads on the loaded end.

    Attributes
    ----------
    forces : (2n, l) nodal forces
    columns : the loads by name
    centre : (2,) centre of the unit actuations [m]
    moments : (3, l) force x, force y and couple about the centre of each load
    """

    forces: Floats
    columns: LoadColumns
    centre: Floats
    moments: Floats

    def resultants(self, pin: Floats) -> Floats:
        """Force x, force y and moment (3, l) about the `pin` (2,) [m]."""
        arm = self.centre - pin
        resultants = self.moments.copy()
        resultants[2] += arm[0] * self.moments[1] - arm[1] * self.moments[0]
        return resultants


EndLoads = Callable[[Floats, Floats, int], LoadedEnd]
"""Makes the loads of the loaded end from its nodes (2, n) [m], their depths (n,) and the degree."""


def unit_actuations(xy: Floats, depths: Floats, p: int) -> LoadedEnd:
    """The three unit actuations on the loaded end, see `end_load`."""
    forces, centre = end_load(xy, depths, p)
    return LoadedEnd(forces, LoadColumns(((ACTUATION, FRAME),)), centre, np.eye(FRAME))


class CondensedShoe(NamedTuple):
    """A shoe condensed to [frame | contact nodes x, y], with estimates of round-off.

    The estimates are zero for a shoe whose frame is its back itself, where they are not known.

    Attributes
    ----------
    S : (3 + 2n, 3 + 2n) stiffness on frame and contact nodes
    loads : (3 + 2n, l) condensed unit loads
    work : (l, l) work of the unit loads with frame and contact held
    centre : (2,) point that the unit actuations act about [m]
    rigid_mode_forces : (2n, 3) forces on the contact that round-off leaves on the rigid-body modes,
        which strain nothing
    force_imbalance : force by which round-off puts a unit force out of balance
    columns : the unit loads by name
    """

    S: Floats
    loads: Floats
    work: Floats
    centre: Floats
    rigid_mode_forces: Floats
    force_imbalance: float
    columns: LoadColumns


def map_of(shoe: Shoe, radius: float) -> Map:
    """The map from depths and angles of a division to points in the shoe's frame."""
    return _beam_map(shoe, radius) if isinstance(shoe.body, Beam) else partial(shoe.at, size=radius)


def _beam_map(shoe: Shoe, radius: float) -> Map:
    """The map of a straight beam, whose depth counts in layers.

    Depths from 0 to 1 are in the lining, from 1 to 2 in the block, which is cut square to the beam,
    and from 2 to 3 in the beam.
    """
    assert isinstance(shoe.body, Beam) and shoe.body.section is not None  # why_not
    axis = axis_of(shoe.pin.xy, shoe.actuation.point.xy)
    thickness = shoe.lining.thickness
    back, beam = radius + thickness, shoe.body.section.thickness
    s, e = shoe.arc
    ends = axis.angle(shoe.frame.theta(np.array([s, e])))
    start = float(np.min(ends))

    def place(depth: Floats, phi: Floats) -> Floats:
        depth, phi = np.broadcast_arrays(depth, phi)
        # The angle under the lining counts from the axis's foot, the distance beyond it along x.
        a = np.clip(phi, s, e) - s + start
        beyond = back * (np.minimum(phi - s, 0) + np.maximum(phi - e, 0))
        r = radius + thickness * np.minimum(depth, 1)
        x = axis.foot + r * np.sin(a) + beyond
        y = axis.distance - r * np.cos(a)
        in_block = y + np.minimum(depth - 1, 1) * (beam / 2 - y)
        y = np.where(depth > 1, in_block, y)
        in_beam = beam / 2 - (depth - 2) * beam
        y = np.where(depth > 2, in_beam, y)
        return np.moveaxis(shoe.frame.to_shoe(axis.to_brake(x, y)), -1, 0)

    return place


def within(ends: Floats, p: int) -> Floats:
    """The nodes (m, p + 1) of pieces of degree p between ends (m + 1,)."""
    first, last = ends[:-1, None], ends[1:, None]
    return np.asarray(0.5 * (last + first) + 0.5 * (last - first) * lobatto(p))


def line_of(ends: Floats, p: int) -> Floats:
    """The nodes (m p + 1,) of pieces of degree p between ends (m + 1,), common ones once."""
    found = np.empty((len(ends) - 1) * p + 1)
    found[:-1] = within(ends, p)[:, :-1].ravel()
    found[-1] = ends[-1]
    return found


def nodes_of(place: Map, depths: Floats, along: Floats, p: int) -> Floats:
    """Nodes (layers, columns, 2, a) of elements [m], in the element's order.

    Parameters
    ----------
    place : map of the shoe
    depths : (l + 1,) ends of the layers
    along : (c, p + 1) positions of the columns' nodes along the lining
    p : degree
    """
    xy = place(within(depths, p)[:, None, :, None], along[:, None, :])  # (2, layers, columns, i, j)
    xy = xy.reshape(*xy.shape[:3], -1).transpose(1, 2, 0, 3)
    return np.ascontiguousarray(xy[..., element(p).order])


def distinct(sizes: Floats) -> tuple[Floats, Ints]:
    """The different ones of sizes (m,), equal up to round-off, and the number of each one's (m,)."""
    numbers: dict[float, int] = {}
    which = []
    for size in sizes.tolist():
        rounded = float(f"{size:.11e}")
        which.append(numbers.setdefault(rounded, len(numbers)))
    return np.array(list(numbers)), np.array(which)


def _along(layers: dict[str, ElasticLayer], part: tuple[str, ...], xy: Floats, p: int) -> Floats:
    """Unit vectors along the layers (l, c, 2, q) at the Gauss points of their elements.

    `part` (l,) names the layer of each row of elements with the nodes xy (l, c, 2, a) [m].
    """
    points = np.moveaxis(gauss_points(xy, p), 2, 1)  # (l, 2, c, q)
    found = [layers[name].directions(own) for name, own in zip(part, points, strict=True)]
    return np.moveaxis(np.array(found), 1, 2)


def rigid(xy: Floats, pin: Floats) -> Floats:
    """The rigid-body modes (2n, 3) of nodes xy (2, n): dx, dy and rotation about the pin."""
    modes = np.zeros((xy.shape[1], 2, FRAME))
    modes[:, 0, 0] = modes[:, 1, 1] = 1.0
    modes[:, 0, 2], modes[:, 1, 2] = pin[1] - xy[1], xy[0] - pin[0]
    return modes.reshape(-1, FRAME)


class _Columns(NamedTuple):
    """The columns under the lining, before it and behind it, in their order.

    Equal columns are the same object. The columns grip[0] to grip[1] - 1 under the lining are those
    whose back a grip holds; both are 0 without a grip.
    """

    under: list[ColumnSubstructure]
    before: list[ColumnSubstructure]
    after: list[ColumnSubstructure]
    grip: tuple[int, int]


class _ColumnKinds(NamedTuple):
    """The kinds of columns of a shoe, and the data that makes a column of each.

    `along` (kinds, p + 1) are the positions of the nodes of each kind along the lining, `angular`
    the angular integrals of columns on arcs (None of a straight beam), and `which` (columns,) the
    kind of each column: those under the lining, before it and behind it.
    """

    along: Floats
    angular: Floats | None
    which: Ints


def _kinds_of(shoe: Shoe, div: ShoeDivision, *, directed: bool) -> _ColumnKinds:
    """The kinds of columns; on an arc equal columns are of one kind, wherever they stand."""
    p = div.degree
    rows = [div.angles]
    if div.first < div.layers:
        rows += [div.before[::-1], div.after]
    if isinstance(shoe.body, Beam):
        along = np.concatenate([within(ends, p) for ends in rows])
        return _ColumnKinds(along, None, np.arange(len(along)))
    sizes, which = distinct(np.concatenate([ends[1:] - ends[:-1] for ends in rows]))
    along = 0.5 * sizes[:, None] * lobatto(p)
    A = angular(along, p, flat=shoe.flat, directed=directed)
    return _ColumnKinds(along, A, which)


def _columns(
    shoe: Shoe, radius: float, div: ShoeDivision, layers: dict[str, ElasticLayer]
) -> _Columns:
    """The condensed columns of a shoe."""
    p = div.degree
    elasticity = stacked(layers, div.part)
    directed = bool(has_directions(elasticity).any())
    kinds_of_columns = _kinds_of(shoe, div, directed=directed)
    plane = radius if shoe.flat else None

    def made(row: Ints, layer: int, *, contact: bool, held: bool) -> list[ColumnSubstructure]:
        """The columns of a row of kinds, of the layers from `layer` on."""
        if not len(row):
            return []
        # np.unique would load np.ma.
        kinds = np.flatnonzero(np.bincount(row))
        depths = div.depths[layer:]
        of = stack(p, div.layers - layer, contact=contact, held=held)
        if kinds_of_columns.angular is None:
            xy = nodes_of(map_of(shoe, radius), depths, kinds_of_columns.along[kinds], p)
            along_layers = _along(layers, div.part[layer:], xy, p) if directed else None
            found = columns(condensed_elements(xy, elasticity[layer:], p, along_layers), of)
        else:
            A = kinds_of_columns.angular[:, kinds]
            own = elements(radius - shoe.sign * depths, A, elasticity[layer:], p, plane)
            found = arc_columns(own, p, contact=contact, held=held)
        pieces = {}
        for kind, K in zip(kinds.tolist(), found, strict=True):
            pieces[kind] = ColumnSubstructure(K, of.line, of.line)
        return [pieces[kind] for kind in row.tolist()]

    which = kinds_of_columns.which
    under, before = len(div.angles) - 1, len(div.before) - 1
    ends = shoe.grip(radius)
    a, b = (0, 0) if ends is None else (int(np.abs(div.angles - x).argmin()) for x in ends)
    outside_grip = np.concatenate([which[:a], which[b:under]])
    free = made(outside_grip, 0, contact=True, held=div.first == div.layers)
    gripped = made(which[a:b], 0, contact=True, held=True)
    rest = made(which[under:], div.first, contact=False, held=False)
    return _Columns([*free[:a], *gripped, *free[a:]], rest[:before], rest[before:], (a, b))


def directions(ends: Floats, p: int) -> Floats:
    """Angles (m p + 1,) of the directions in which the displacements of contact nodes count.

    Nodes between the ends (m + 1,) of a column have the direction of the column's middle.
    """
    angles = np.append(np.repeat(0.5 * (ends[1:] + ends[:-1]), p), 0.0)
    angles[::p] = ends
    return angles


def _angle_at(shoe: Shoe, phi: Floats) -> Floats:
    """The angles [rad] of the directions in which displacements count at positions phi of columns.

    On an arc they count along the radius, on a pad along the normal, whose tangent is the plane's x,
    and in a straight beam along the axes of the frame.
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
    """The shoe condensed to its frame and its contact nodes, by growing angle.

    Parameters
    ----------
    shoe : a parametric shoe
    radius : of the drum [m]
    div : its division
    layers : elasticity of the layers by name
    end_loads : the unit loads on the loaded end; a shoe whose back is held has the three unit
        actuations on its frame and no others

    Raises
    ------
    NoAnswer
        for a singular stiffness
    """
    p = div.degree
    phi = line_of(div.angles, p)
    back = -_angle_at(shoe, directions(div.angles, p))
    R = rigid(map_of(shoe, radius)(np.zeros(1), phi), shoe.own_pin)
    found = _columns(shoe, radius, div, layers)
    if any(found.grip):
        return _held_shoe(shoe, turned(_on_grip(found), back), R)
    if div.first == div.layers:
        return _held_shoe(shoe, turned(_between(found.under), back), R)
    return _free_shoe(shoe, radius, div, found, end_loads, R)


def _held_shoe(shoe: Shoe, S: Floats, R: Floats) -> CondensedShoe:
    """A shoe whose back is held, by a grip or as a rigid shoe; the force acts on the frame there.

    `S` (2n, 2n) is the stiffness of the contact nodes, and `R` (2n, 3) their rigid-body modes.
    """
    zeros = np.zeros((len(R), FRAME))
    return CondensedShoe(
        S=_balanced(S, R),
        loads=np.vstack([np.eye(FRAME), zeros]),
        work=np.zeros((FRAME, FRAME)),
        centre=shoe.own_pin,
        rigid_mode_forces=zeros,
        force_imbalance=0.0,
        columns=LoadColumns(((ACTUATION, FRAME),)),
    )


def _free_shoe(
    shoe: Shoe,
    radius: float,
    div: ShoeDivision,
    found: _Columns,
    end_loads: EndLoads,
    R: Floats,
) -> CondensedShoe:
    """An elastic shoe that is held at its hinge and loaded at its other end.

    `found` are its columns, and `R` (2n, 3) the rigid-body modes of the contact nodes.
    """
    p, place, pin = div.degree, map_of(shoe, radius), shoe.own_pin
    back = -_angle_at(shoe, directions(div.angles, p))
    depths = line_of(div.depths[div.first :], p)
    near, far = div.before[-1], div.after[-1]
    hinge_modes = _local(rigid(place(depths, near), pin), _angle_at(shoe, near))
    end = end_loads(place(depths, far), depths, p)
    end_forces = _local(end.forces, _angle_at(shoe, far))

    # All columns as one, on [frame | contact nodes | loads].
    row = found.under.copy()
    row[0] = _held(row[0], found.before, hinge_modes)
    loaded = _loaded(found.after, end_forces)
    row[-1] = without_line(row[-1], loaded, len(end_forces), right=True)
    A = assembled(row, 2).K
    extra = end.columns.count
    frame, contact, loads = slice(FRAME), slice(FRAME, -extra), slice(-extra, None)
    S = turned(A[contact, contact], back)
    load = -turned_rows(A[loads, contact], back).T
    on_frame = -A[frame, loads]

    # Round-off has put the condensed loads out of balance: the contact nodes take the difference.
    imbalance = end.resultants(pin) - on_frame - R.T @ load
    load += R @ np.linalg.solve(R.T @ R, imbalance)
    S, missed = _still(S, R, turned_rows(A[frame, contact], back).T)
    actuation = end.columns.places[ACTUATION]
    return CondensedShoe(
        S=_balanced(S, R),
        loads=np.concatenate([on_frame, load]),
        work=-A[loads, loads],
        centre=end.centre,
        rigid_mode_forces=missed,
        force_imbalance=float(np.abs(imbalance[:2, actuation][:, :2]).max()),
        columns=end.columns,
    )


def _between(
    row: list[ColumnSubstructure], left: Floats | None = None, right: Floats | None = None
) -> Floats:
    """Stiffness of the contact nodes of columns under the lining.

    `left` and `right` are the stiffness of the bodies that hang on the back of both ends.
    """
    row = row.copy()
    row[0] = without_line(row[0], left, 0 if left is None else len(left))
    row[-1] = without_line(row[-1], right, 0 if right is None else len(right), right=True)
    return assembled(row, 2).K


def _on_grip(found: _Columns) -> Floats:
    """Stiffness of the contact nodes of a lining whose body is held by a grip on its back.

    The body beyond the lining is free.
    """
    row, (first, last) = found.under.copy(), found.grip
    # The held columns lack the last node of the others' lines.
    line = row[first].left
    if first > 0:
        K, left, _ = row[first - 1]
        row[first - 1] = ColumnSubstructure(K[:-2, :-2], left, line)
    if last < len(row):
        K, _, right = row[last]
        free = np.delete(np.arange(len(K)), [line, line + 1])
        row[last] = ColumnSubstructure(K[free[:, None], free], line, right)
    before = without_line(assembled(found.before, 0)).K if found.before else None
    after = without_line(assembled(found.after, 0), right=True).K if found.after else None
    return _between(row, before, after)


def _held(
    first: ColumnSubstructure, before: list[ColumnSubstructure], held: Floats
) -> ColumnSubstructure:
    """The first column under the lining with the body before it, down to the hinge.

    Its unknowns are [frame | own]. `held` (n, 3) are the rigid-body modes of the line at the hinge.
    """
    if not before:
        return without_line(_tied(first, held))
    part = len(held)
    body = assembled([_tied(before[0], held), *before[1:]], 0)
    return without_line(first, body.K, part)


def _loaded(after: list[ColumnSubstructure], load: Floats) -> Floats:
    """Stiffness of the body behind the lining on [line at the lining's end | loads].

    `load` (n, l) are the unit loads on the line at the body's end.
    """
    part, count = load.shape
    end = np.zeros((part + count, part + count))
    end[:part, part:], end[part:, :part] = -load, -load.T
    if not after:
        return end
    last = without_line(after[-1], end, part, right=True)
    return assembled([*after[:-1], last], 0).K


def _tied(piece: ColumnSubstructure, held: Floats) -> ColumnSubstructure:
    """A column whose left line is constrained to the frame: [left line | frame | ...].

    The last unknowns of the line move with the frame by the modes `held` (n, 3).
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
    """The stiffness S (2n, 2n) of the contact nodes, corrected for round-off, and what is left.

    Rigid-body modes strain nothing: if the contact moves with the frame by R (2n, 3), then S R =
    -held. The forces `held` (2n, 3) on the contact by motions of the frame are small beside the
    stiffness of thin columns, and have more digits. The first correction changes each node's own
    part, where most digits were lost. The second is the least symmetric change that leaves no
    residual. The corrected stiffness is wrong elsewhere by as much as rigid-body modes showed: the
    estimate (2n, 3) of the forces that round-off adds is the residual before any correction.
    """
    S, own = S.copy(), np.arange(len(S)).reshape(-1, 2)
    before = S @ R + held
    node = before[:, :2].reshape(-1, 2, 2)
    S[own[:, :, None], own[:, None]] -= 0.5 * (node + node.swapaxes(1, 2))
    after = S @ R + held
    back = R @ np.linalg.inv(R.T @ R)
    change, moment = back @ after.T, R.T @ after
    symmetric_moment = 0.5 * (moment + moment.T)
    corrected = S - change - change.T + back @ symmetric_moment @ back.T
    return corrected, before


def _balanced(S: Floats, R: Floats) -> Floats:
    """Stiffness on [frame | contact nodes] from the stiffness S (2n, 2n) of the contact nodes.

    The rigid-body modes R (2n, 3) strain nothing.
    """
    SR = S @ R
    whole = np.empty((FRAME + len(S), FRAME + len(S)))
    whole[:FRAME, :FRAME] = R.T @ SR
    whole[:FRAME, FRAME:] = -SR.T
    whole[FRAME:, :FRAME] = -SR
    whole[FRAME:, FRAME:] = S
    return whole


def _local(V: Floats, angle: Floats) -> Floats:
    """Vectors V (2n, m) in directions that are turned by one angle [rad]."""
    return turned_rows(V.T, np.reshape(angle, 1)).T
