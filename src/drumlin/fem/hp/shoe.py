"""A parametric shoe of columns: its geometry, and its condensation to contact, frame and actuation."""

from collections.abc import Callable
from functools import cache, partial
from typing import NamedTuple

import numpy as np

from drumlin.arrays import Floats, Ints
from drumlin.brake.beam_axis import axis_of
from drumlin.brake.components import Beam
from drumlin.brake.drum_brake import Shoe
from drumlin.brake.fields import Material
from drumlin.fem.body import FRAME
from drumlin.fem.hp.columns import columns, merge, merged, stack, turned, turned_rows
from drumlin.fem.hp.division import Division
from drumlin.fem.hp.element import condensed_elements, element, eliminate
from drumlin.fem.shapes import plane_stress
from drumlin.response.resultants import GAUSS, WEIGHTS, lobatto, shape

LOADS, HELD, EXTRA = slice(FRAME), slice(FRAME, 2 * FRAME), 2 * FRAME  # unknowns of a piece before its own

Map = Callable[[Floats, Floats], Floats]  # depth, place along -> points (2, ...) [m] in the shoe's frame


class Condensed(NamedTuple):
    """Stiffness `S` (3 + 2n, 3 + 2n) on [frame | contact nodes x, y], unit actuations `loads` (3 + 2n, 3) on them,
    their
    `work` (3, 3) with both held, and the centre (2,) [m] that they act on. `lost`: what the elimination missed the
    balance of a unit force by, before the frame's rows were made to balance."""

    S: Floats
    loads: Floats
    work: Floats
    centre: Floats
    lost: float


def map_of(shoe: Shoe, radius: float) -> Map:
    """Where the points of a division lie."""
    return _beam_map(shoe, radius) if isinstance(shoe.body, Beam) else partial(shoe.at, radius=radius)


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
    half = 0.5 * np.diff(ends)[:, None]
    return np.asarray(0.5 * (ends[1:] + ends[:-1])[:, None] + half * lobatto(p))


def line_of(ends: Floats, p: int) -> Floats:
    """The nodes of all pieces between ends (m + 1,), those in common once: (m p + 1,)."""
    return np.append(within(ends, p)[:, :-1].ravel(), ends[-1])


def nodes_of(place: Map, depths: Floats, along: Floats, p: int) -> Floats:
    """Nodes (layers, columns, 2, a) of elements between depths (l + 1,) and at the places `along` (c, p + 1)."""
    xy = place(within(depths, p)[:, None, :, None], along[:, None, :])  # (2, layers, columns, i, j)
    xy = xy.reshape(*xy.shape[:3], -1).transpose(1, 2, 0, 3)
    return np.ascontiguousarray(xy[..., element(p).order])


def distinct(sizes: Floats) -> tuple[Floats, Ints]:
    """The different ones of sizes (m,), equal up to round-off, and which of them each is (m,)."""
    found: dict[float, int] = {}
    which = [found.setdefault(float(f"{size:.11e}"), len(found)) for size in sizes.tolist()]
    return np.array(list(found)), np.array(which)


def lame_of(materials: dict[str, tuple[Material, float]], part: tuple[str, ...]) -> Floats:
    """lambda and mu of plane stress times the width of each layer (l, 2) [N/m]."""
    found = {name: width * np.array(plane_stress(m.E, m.nu)) for name, (m, width) in materials.items()}
    return np.array([found[name] for name in part])


def rigid(xy: Floats, pin: Floats) -> Floats:
    """Displacements (2n, 3) of nodes xy (2, n) per dx, dy and turn about the pin."""
    R = np.zeros((xy.shape[1], 2, FRAME))
    R[:, 0, 0] = R[:, 1, 1] = 1.0
    R[:, 0, 2], R[:, 1, 2] = pin[1] - xy[1], xy[0] - pin[0]
    return R.reshape(-1, FRAME)


class _Columns(NamedTuple):
    """Columns in directions of their own at each node: those under the lining, before and behind it, in their order;
    `gripped` (k, ...): those under the lining from number `first` on, with their back held."""

    under: Floats
    before: Floats
    after: Floats
    gripped: Floats
    first: int


def _columns(
    shoe: Shoe,
    place: Map,
    div: Division,
    materials: dict[str, tuple[Material, float]],
    grip: tuple[float, float] | None = None,
) -> _Columns:
    p, straight = div.degree, isinstance(shoe.body, Beam) or shoe.flat
    beyond = [np.sort(div.before), np.sort(div.after)]
    parts = [div.angles, *beyond] if div.first < div.layers else [div.angles]
    counts = [len(ends) - 1 for ends in parts]
    along = np.concatenate([within(ends, p) for ends in parts])  # (columns, p + 1)
    which = np.arange(len(along))
    if not straight:
        sizes, which = distinct(np.concatenate([np.diff(ends) for ends in parts]))
        along = 0.5 * sizes[:, None] * lobatto(p)
    under, over = (np.flatnonzero(np.bincount(part)) for part in np.split(which, counts[:1]))  # np.unique loads np.ma
    lame = lame_of(materials, div.part)
    xy = [nodes_of(place, div.depths, along[under], p)]
    if len(over):
        xy.append(nodes_of(place, div.depths[div.first :], along[over], p))
    lames = [np.broadcast_to(lame[-len(x) :, None], (*x.shape[:2], 2)).reshape(-1, 2) for x in xy]
    K = condensed_elements(np.concatenate([x.reshape(-1, *x.shape[2:]) for x in xy]), np.concatenate(lames), p)
    split = xy[0].shape[0] * xy[0].shape[1]
    held = div.first == div.layers
    of = stack(p, div.layers, contact=True, held=held)
    stacks = K[:split].reshape(div.layers, -1, *K.shape[1:])
    made = columns(stacks, of)
    if not straight:
        made = turned(made, directions(along[under], of.line // 2, contact=True))
    place_of = np.zeros(len(along), dtype=np.int64)
    place_of[under] = np.arange(len(under))
    lining = made[place_of[which[: counts[0]]]]
    gripped, first = lining[:0], 0
    if grip is not None:
        of = stack(p, div.layers, contact=True, held=True)
        back = columns(stacks, of)
        if not straight:
            back = turned(back, directions(along[under], of.line // 2, contact=True))
        first, last = (int(np.abs(div.angles - x).argmin()) for x in grip)
        gripped = back[place_of[which[first:last]]]
    sides = [np.zeros((0, 0, 0))] * 2
    if len(over):
        of = stack(p, div.layers - div.first, contact=False, held=False)
        made = columns(K[split:].reshape(div.layers - div.first, -1, *K.shape[1:]), of)
        if not straight:
            made = turned(made, directions(along[over], of.line // 2, contact=False))
        place_of[over] = np.arange(len(over))
        at = np.cumsum(counts)
        sides = [made[place_of[which[at[k] : at[k + 1]]]] for k in range(2)]
    return _Columns(lining, sides[0], sides[1], gripped, first)


def directions(along: Floats, line: int, *, contact: bool) -> Floats:
    """Angles (c, nodes) of the nodes of columns' sides and inner contact."""
    inner = along[:, 1:-1] if contact else along[:, :0]
    return np.hstack([np.repeat(along[:, :1], line, axis=1), inner, np.repeat(along[:, -1:], line, axis=1)])


def condense(shoe: Shoe, radius: float, div: Division, materials: dict[str, tuple[Material, float]]) -> Condensed:
    """The shoe on its frame and its contact nodes, by growing angle. Raises NoAnswer for a singular stiffness."""
    p, place, pin = div.degree, map_of(shoe, radius), shoe.own_pin
    straight, held = isinstance(shoe.body, Beam) or shoe.flat, div.first == div.layers
    grip = shoe.grip(radius)
    found = _columns(shoe, place, div, materials, grip)
    line = stack(p, div.layers, contact=True, held=held).line
    S = merged(found.under, line, 2) if grip is None else _on_grip(found, line)
    phi = line_of(div.angles, p)
    back = np.zeros_like(phi) if straight else phi  # directions of the contact nodes
    R = rigid(place(np.zeros(1), phi), pin)
    if held or grip is not None:  # its back is held, by a grip or as a rigid shoe, and the force acts on what holds it
        S = turned(eliminate(_contact_first(S, line, 0)[None], 2 * len(phi))[0], -back)
        none = np.zeros((FRAME, FRAME))
        return Condensed(_balanced(S, R), np.vstack([np.eye(FRAME), np.zeros((len(R), FRAME))]), none, pin, 0.0)
    d = line_of(div.depths[div.first :], p)
    near, far = div.before[-1], div.after[-1]
    held_line = _local(rigid(place(d, near), pin), 0.0 if straight else near)
    f, centre = end_load(place(d, far), d, p)
    f = _local(f, 0.0 if straight else far)
    A = _contact_first(_with_ends(S, line, found, held_line, f), line, EXTRA)
    if not len(found.before):  # the hinge holds the body where the lining begins
        part = len(held_line)
        A = _tied(A, EXTRA + 2 * len(phi) + line - 2 - part + np.arange(part), held_line)
    A = eliminate(A[None], EXTRA + 2 * len(phi))[0]
    contact = slice(EXTRA, None)
    S, load = turned(A[contact, contact], -back), -turned_rows(A[LOADS, contact], -back).T
    arm = centre - pin
    unit = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-arm[1], arm[0], 1.0]])
    on_frame = unit - R.T @ load
    lost = float(np.abs(on_frame + A[HELD, LOADS])[:2, :2].max())
    return Condensed(_balanced(S, R), np.vstack([on_frame, load]), -A[LOADS, LOADS], centre, lost)


def _on_grip(found: _Columns, line: int) -> Floats:
    """The piece under the lining, its back held by a grip, with what the body is beyond the lining: both ends free."""
    last = found.first + len(found.gripped)
    left, right = merged(found.under[: found.first], line, 2), merged(found.under[last:], line, 2)
    left, right = left[:-2, :-2], np.delete(np.delete(right, [line - 2, line - 1], 0), [line - 2, line - 1], 1)
    S = merge(left[None], merged(found.gripped, line - 2, 2)[None], line - 2, 2)
    S = merge(S, right[None], line - 2, 2)[0]
    for beyond, far in ((found.before, False), (found.after, True)):
        if len(beyond):
            part = beyond.shape[1] // 2
            K = merged(beyond, part, 0)
            order = np.arange(2 * part) if far else np.roll(np.arange(2 * part), part)  # the lining's side first
            own = len(S) - part + np.arange(part) if far else line - part + np.arange(part)
            S[own[:, None], own] += eliminate(K[order[:, None], order][None], part)[0]
    return S


def _with_ends(S: Floats, line: int, found: _Columns, held: Floats, load: Floats) -> Floats:
    """The piece S under the lining on [loads | frame | S's own], with what the body is beyond it.

    held (n, 3): motions of the line at the hinge per dx, dy and turn; load (n, 3): unit loads on the line at the end.
    """
    part, n = len(held), len(S)
    A = np.zeros((EXTRA + n, EXTRA + n))
    A[EXTRA:, EXTRA:] = S
    left, right = slice(EXTRA + line - part, EXTRA + line), slice(EXTRA + n - part, EXTRA + n)
    if len(found.before):  # from the hinge to the lining
        K = merged(found.before, part, 0)
        RK = held.T @ K[:part]
        A[HELD, HELD] += RK[:, :part] @ held
        A[HELD, left] += RK[:, part:]
        A[left, HELD] += RK[:, part:].T
        A[left, left] += K[part:, part:]
    if len(found.after):
        K = eliminate(_bordered(merged(found.after, part, 0), load), FRAME + part)[0]
        A[LOADS, LOADS] += K[:FRAME, :FRAME]
        A[LOADS, right] += K[:FRAME, FRAME:]
        A[right, LOADS] += K[FRAME:, :FRAME]
        A[right, right] += K[FRAME:, FRAME:]
    else:
        A[LOADS, right] -= load.T
        A[right, LOADS] -= load
    return A


def _tied(A: Floats, at: Ints, held: Floats) -> Floats:
    """A whose unknowns `at` move with the frame by `held` (n, 3)."""
    A = A.copy()
    A[:, HELD] += A[:, at] @ held
    A[HELD] += held.T @ A[at]
    others = np.delete(np.arange(len(A)), at)
    return A[others[:, None], others]


def _balanced(S: Floats, R: Floats) -> Floats:
    """Stiffness on [frame | contact nodes] from that of the contact nodes: rigid motions R (2n, 3) strain nothing."""
    SR = S @ R
    return np.block([[R.T @ SR, -SR.T], [-SR, S]])


def _local(V: Floats, angle: float) -> Floats:
    """Vectors V (2n, m) in directions turned by one angle."""
    return turned_rows(V.T, np.full(len(V) // 2, angle)).T


def _bordered(K: Floats, loads: Floats) -> Floats:
    """(1, l + n, l + n) of a piece K (2 n', 2 n') [near | far] with loads (n', l) on its far line, as extra
    unknowns.
    """
    count, n = loads.shape[1], len(K)
    A = np.zeros((1, count + n, count + n))
    A[0, count:, count:] = K
    A[0, count + n - len(loads) :, :count] = -loads
    A[0, :count, count + n - len(loads) :] = -loads.T
    return A


def _contact_first(A: Floats, line: int, extra: int) -> Floats:
    """A on [extra | left line | inner contact | right line] in the order [extra | contact | rest]."""
    order = contact_order(len(A), line, extra)
    return A[order[:, None], order]


@cache
def contact_order(n: int, line: int, extra: int) -> Ints:
    """The unknowns of a piece, first the extra ones and its contact nodes, then the rest of its left and right line."""
    contact = np.r_[:extra, extra : extra + 2, extra + line : n - line + 2]
    return np.concatenate([contact, np.arange(extra + 2, extra + line), np.arange(n - line + 2, n)])


def end_load(xy: Floats, depths: Floats, p: int) -> tuple[Floats, Floats]:
    """Nodal forces (2n, 3) [1, 1, 1/m] of unit force x, y and couple on the straight loaded end, and its centre (2,)
    [m].

    The force is spread evenly, the couple as a traction that grows linearly from the centre. xy (2, n) [m]: nodes of
    the end at the `depths` (n,), which are in proportion to the distance along it.
    """
    ends = (depths[::p] - depths[0]) / (depths[-1] - depths[0]) - 0.5  # from -1/2 to 1/2
    at = np.arange(len(ends) - 1)[:, None] * p + np.arange(p + 1)
    psi, half = shape(p, GAUSS), 0.5 * np.diff(ends)[:, None]
    where = ends[:-1, None] + half * (1 + GAUSS)
    even = np.bincount(at.ravel(), ((half * WEIGHTS) @ psi.T).ravel())
    turning = np.bincount(at.ravel(), ((half * WEIGHTS * where) @ psi.T).ravel()) * 12
    end, centre = xy[:, -1] - xy[:, 0], 0.5 * (xy[:, -1] + xy[:, 0])
    load = np.zeros((xy.shape[1], 2, FRAME))
    load[:, 0, 0] = load[:, 1, 1] = even
    load[:, :, 2] = turning[:, None] * np.array([-end[1], end[0]]) / (end @ end)
    return load.reshape(-1, FRAME), centre
