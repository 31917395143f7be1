"""A second way to the same answer: curved triangles of high degree, contact node by node, one factorisation a body.

Shares nothing with drumlin's finite elements but the brake. The triangles are graded geometrically to every corner of
lining, backing, shoe and beam, to the ring below the lining's ends, to the kinks of the gap and to the ends of the
contact, which earlier meshes found. Contact is Lagrange's, node by node: each node of the lining's face is open, or
lies on the drum (on the ring's node opposite) and carries a force with Coulomb's friction at full slip. A sequence of
meshes of growing degree and grading gives each value and how far the last step still moved it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from drumlin.arrays import Bools, Floats, Ints
from drumlin.brake import Brake, Shoe, clearance
from drumlin.brake.beam_axis import axis_of
from drumlin.brake.components import Beam
from drumlin.errors import BadInput, NoAnswer
from drumlin.verification import lagrange
from drumlin.verification.lagrange import Compliance, Nodes
from drumlin.verification.triangulation import Layer, Map, Triangles, graded, matched, spaced, start

GAUSS, WEIGHTS = np.polynomial.legendre.leggauss(8)
SLENDER = 12.0  # length of triangles far from all corners over the thinnest layer
SETTLED = 600  # contact sets that are tried
SPARE = 8  # of them in a row without fewer wrong nodes, until they are changed one node at a time (Judice & Pires 1994)
NOISE = 1e-13  # of the normal force, in tractions and overlaps at all wrong nodes
PATIENCE, NEARLY = 40, 1e-9  # contact sets after which that much is enough
ENDS = 11  # halvings towards an end of the contact, where p is small, and a kink of the gap


class Level(NamedTuple):
    """A mesh: degree of its triangles, `halvings` towards each corner, length of triangles over their distance from
    it, and factor on all lengths elsewhere."""

    degree: int
    halvings: int
    steep: float
    size: float


FINDING = (Level(3, 6, 1.4, 1.0), Level(3, 12, 1.2, 1.0))  # the contact's ends
LEVELS = (Level(3, 12, 1.0, 1.0), Level(4, 14, 1.0, 0.8), Level(5, 16, 1.0, 0.8))


@dataclass(frozen=True)
class Outline:
    """A layered body in the coordinates s, d: `place` maps them; `s` are the ends of its parts, `thickness` (layers,)
    [m]; `corners` (k, 2) the s, d of the points to which triangles are graded; `held` s, or None where the back is;
    `loaded` s or None; `turn`: theta = origin + turn s; `length` [m] per s."""

    place: Map
    layers: list[Layer]
    thickness: Floats
    s: Floats
    corners: Floats
    held: float | None
    loaded: float | None
    origin: float
    turn: int
    length: float


def outline(shoe: Shoe, R: float) -> Outline:
    """The outline of a shoe. Raises BadInput for what has no section to mesh, or a mesh of its own."""
    lining, backing, body = shoe.lining, shoe.backing, shoe.body
    if shoe.mesh is not None:
        raise BadInput(f"shoe {shoe.name!r} has a mesh of its own")
    if isinstance(body, Beam):
        return _post(shoe, R)
    parts = [(lining.thickness, lining.material)] + ([(backing.thickness, backing.material)] if backing else [])
    layers = [Layer(lining.start, lining.end, m.E, m.nu, lining.width) for _, m in parts]
    thickness = [t for t, _ in parts]
    held = loaded = None
    s = [lining.start, lining.end]
    corners = [(end, float(d)) for end in s for d in range(len(parts) + 1)]
    if body is not None:
        layers.append(Layer(body.start, body.end, body.material.E, body.material.nu, body.width))
        thickness.append(body.thickness)
        s += [body.start, body.end]
        corners += [(end, float(d)) for end in (body.start, body.end) for d in (len(parts), len(parts) + 1)]
        held, loaded = sorted((body.start, body.end), key=lambda end: abs(float(shoe.frame.phi(np.array(end)))))
    depths = np.concatenate([[0.0], np.cumsum(thickness)])

    def place(s: Floats, d: Floats) -> Floats:
        r = R - shoe.sign * np.interp(d, np.arange(len(depths)), depths)
        return np.stack([r * np.cos(s), r * np.sin(s)], axis=-1)

    return Outline(
        place, layers, np.array(thickness), _distinct(s), np.unique(corners, axis=0), held, loaded, 0.0, 1, R
    )


def _post(shoe: Shoe, R: float) -> Outline:
    """A straight beam with a block cut square to it; s is the beam's angle under the lining's back."""
    lining, backing, body = shoe.lining, shoe.backing, shoe.body
    assert isinstance(body, Beam)
    section = body.section
    if section is None or backing is None:
        raise BadInput(f"shoe {shoe.name!r}: its beam has no constant section, or nothing before it")
    axis = axis_of(shoe.hinge.xy, shoe.actuation.point.xy)
    first, last = np.sort(axis.angle(np.array([lining.start, lining.end]))).tolist()
    t, back = lining.thickness, R + lining.thickness
    low = first - (axis.foot + back * math.sin(first)) / back
    high = last + (axis.length - axis.foot - back * math.sin(last)) / back
    face = section.thickness / 2

    def place(s: Floats, d: Floats) -> Floats:
        inside = np.clip(s, first, last)
        along = axis.foot + back * (np.sin(inside) + (s - inside))
        r = R + t * np.minimum(d, 1)
        x = np.where(d < 1, axis.foot + r * np.sin(s), along)
        y = axis.distance - r * np.cos(inside)
        y = y + np.clip(d - 1, 0, 1) * (face - y)
        y = np.where(d >= 2, face - (d - 2) * section.thickness, y)
        return axis.to_brake(x, y)

    block = axis.distance - face - back * min(math.cos(first), math.cos(last))
    layers = [
        Layer(first, last, lining.material.E, lining.material.nu, lining.width),
        Layer(first, last, backing.material.E, backing.material.nu, lining.width),
        Layer(low, high, section.material.E, section.material.nu, section.width),
    ]
    corners = [(s, d) for s in (first, last) for d in (0.0, 1.0, 2.0)] + [(s, d) for s in (low, high) for d in (2.0, 3.0)]
    thickness = np.array([t, block, section.thickness])
    origin = lining.middle - axis.sense * float(axis.angle(np.array(lining.middle)))
    s = _distinct([low, first, last, high])
    return Outline(place, layers, thickness, s, np.unique(corners, axis=0), low, high, origin, axis.sense, back)


def _distinct(values: Sequence[float]) -> Floats:
    """Growing values, those that are equal to round-off once."""
    grown = np.unique(values)
    return grown[np.append(True, np.diff(grown) > 1e-9)]


def grid(shape: Outline, size: float, wavelength: float, points: Sequence[float]) -> tuple[Floats, list[Floats]]:
    """The first lines of a mesh in s, and in d for each layer: nearly square cells at the corners and at `points` (s) on
    the face, slender ones elsewhere; wavelength [m] of what the gap does."""
    face = shape.layers[0]
    arc = (face.end - face.start) * shape.length
    thinnest = float(shape.thickness[: len(shape.layers) - (shape.held is not None)].min())
    least = min(thinnest, arc / 4) * size
    most = max(least, min(SLENDER * float(shape.thickness.min()), arc / 8, wavelength / 4) * size)
    dense = np.concatenate([shape.s, points])
    ends = (dense > face.start - 1e-9) & (dense < face.end + 1e-9)
    near = np.where(ends, least, max(least, float(shape.thickness[-1]) / 4 * size))

    def along(s: float) -> float:
        return min(most, float((near + 0.5 * shape.length * np.abs(dense - s)).min())) / shape.length

    s = spaced(shape.s, along)
    d = []
    for j, t in enumerate(shape.thickness.tolist()):
        coarsest = t * (1.0 if j == 0 else 0.5) * min(1.0, 1.25 * size)

        def across(x: float, t: float = t, coarsest: float = coarsest) -> float:
            return min(coarsest / t, least / t + min(x, 1 - x))

        d.append(j + spaced(np.array([0.0, 1.0]), across))
    return s, d


class Shaped(NamedTuple):
    """A meshed body: triangles, nodes, stiffness, and the numbers of the nodes on its surface by growing s."""

    shape: Outline
    mesh: Triangles
    nodes: Nodes
    K: Any
    surface: Ints
    degree: int


def shaped(shape: Outline, mesh: Triangles, degree: int) -> Shaped:
    """The body on a triangulation."""
    nodes = lagrange.nodes_of(mesh, shape.place, degree)
    K = lagrange.stiffness(mesh, nodes, shape.layers, degree)
    surface = np.flatnonzero(nodes.at[:, 1] == 0)
    return Shaped(shape, mesh, nodes, K, surface[np.argsort(nodes.at[surface, 0])], degree)


@dataclass(frozen=True)
class Face:
    """A lining's face: angles `theta` (n,) [rad] of its nodes, growing, normals and tangents (n, 2), `mass` (n, n) =
    b Int psi_i psi_j ds [m^2]; forces on its nodes move it by `compliance` (2n, 2n), its actuation by `loaded` (2n,),
    a turn about the pin by `turned` (2n,)."""

    theta: Floats
    xy: Floats
    normal: Floats
    tangent: Floats
    mass: Floats
    compliance: Floats
    loaded: Floats
    turned: Floats
    gap: Floats
    degree: int
    unknowns: int


def _edge(nodes: Nodes, tri: Ints, edge: Ints, degree: int) -> Ints:
    """Node numbers (k, degree + 1) along edges of triangles."""
    inner = 3 + edge[:, None] * (degree - 1) + np.arange(degree - 1)
    local = np.concatenate([edge[:, None], inner, ((edge + 1) % 3)[:, None]], axis=1)
    return nodes.of[tri[:, None], local]


def trace(degree: int, at: Floats) -> tuple[Floats, Floats]:
    """Lagrange's polynomials on the nodes of an edge and their slopes at `at` (q,) in [0, 1]: (degree + 1, q)."""
    nodes = lagrange.lobatto(degree)
    V = np.linalg.inv(np.polynomial.legendre.legvander(2 * nodes - 1, degree))
    value = np.polynomial.legendre.legvander(2 * at - 1, degree)
    slope = np.stack([2 * np.polynomial.legendre.legval(2 * at - 1, np.polynomial.legendre.legder(e)) for e in np.eye(degree + 1)], 1)
    return (value @ V).T, (slope @ V).T


def _end_load(body: Shaped, force: Floats, point: Floats) -> Floats:
    """Nodal forces (2N,) of a force (2,) whose line passes through `point` (2,): evenly spread over the loaded end, and
    a couple that grows linearly from its centre."""
    at = body.mesh.at
    assert body.shape.loaded is not None
    on = (np.abs(at[..., 0] - body.shape.loaded) < 1e-12) & (at[..., 1] >= len(body.shape.layers) - 1 - 1e-12)
    tri, edge = np.nonzero(on & np.roll(on, -1, axis=1))
    of = _edge(body.nodes, tri, edge, body.degree)
    psi, slope = trace(body.degree, 0.5 + 0.5 * GAUSS)
    x = np.einsum("kac,aq->kqc", body.nodes.xy[of], psi)
    ds = np.hypot(*np.moveaxis(np.einsum("kac,aq->kqc", body.nodes.xy[of], slope), 2, 0)) * 0.5 * WEIGHTS
    centre = np.einsum("kqc,kq->c", x, ds) / ds.sum()
    arm = x - centre
    lever = point - centre
    couple = lever[0] * force[1] - lever[1] * force[0]
    turning = np.stack([-arm[..., 1], arm[..., 0]], axis=-1) * couple / float(np.einsum("kqc,kqc,kq->", arm, arm, ds))
    nodal = np.einsum("aq,kqc,kq->kac", psi, force / ds.sum() + turning, ds)
    loads = np.zeros_like(body.nodes.xy)
    np.add.at(loads, of, nodal)
    return loads.ravel()


def face(brake: Brake, shoe: Shoe, body: Shaped) -> Face:
    """A shoe condensed to its lining's face."""
    shape, nodes, kept = body.shape, body.nodes, body.surface
    if shape.held is None:
        fixed = nodes.at[:, 1] > len(shape.layers) - 1e-12
        loads = np.zeros((2 * len(nodes.xy), 1))
    else:
        fixed = (np.abs(nodes.at[:, 0] - shape.held) < 1e-12) & (nodes.at[:, 1] > len(shape.layers) - 1 - 1e-12)
        loads = _end_load(body, shoe.actuation.vector, shoe.actuation.point.xy)[:, None]
    theta = shape.origin + shape.turn * nodes.at[kept, 0]
    kept, theta = kept[:: shape.turn], theta[:: shape.turn]
    compliance = lagrange.condense(body.K, nodes, np.repeat(fixed, 2), kept, loads)
    er = np.stack([np.cos(theta), np.sin(theta)], axis=1)
    place = np.empty(len(nodes.xy), dtype=np.int64)
    place[kept] = np.arange(len(kept))
    of = place[_edge(nodes, *body.mesh.surface, body.degree)]
    psi, slope = trace(body.degree, 0.5 + 0.5 * GAUSS)
    ds = np.hypot(*np.moveaxis(np.einsum("kac,aq->kqc", nodes.xy[kept][of], slope), 2, 0)) * 0.5 * WEIGHTS
    mass = np.zeros((len(kept), len(kept)))
    np.add.at(mass, (of[:, :, None], of[:, None, :]), shoe.lining.width * np.einsum("aq,bq,kq->kab", psi, psi, ds))
    arm = nodes.xy[kept] - shoe.hinge.xy
    return Face(
        theta=theta,
        xy=nodes.xy[kept],
        normal=shoe.sign * er,
        tangent=np.stack([-er[:, 1], er[:, 0]], axis=1),
        mass=mass,
        compliance=compliance.of,
        loaded=compliance.loaded[:, 0],
        turned=np.stack([-arm[:, 1], arm[:, 0]], axis=1).ravel(),
        gap=clearance.gap(brake, shoe, theta),
        degree=body.degree,
        unknowns=2 * len(nodes.xy),
    )


@dataclass(frozen=True)
class ShoeSolution:
    """What one shoe does: `theta` (n,) [rad], growing, `pressure` (n,) [Pa] at the nodes of Gauss and Lobatto of pieces
    of degree `order`, 0 where it is open; `torque` [N m]; `hinge_reaction` (2,) [N] of the pin on the shoe; `arcs`
    (k, 2) [rad] in contact; `unknowns` of its mesh."""

    theta: Floats
    pressure: Floats
    order: int
    torque: float
    normal_force: float
    hinge_reaction: Floats
    arcs: Floats
    unknowns: int

    @cached_property
    def _barycentric(self) -> Floats:
        x = lagrange.lobatto(self.order)
        return np.array([1 / np.prod([a - b for b in x if b != a]) for a in x])

    def pressure_at(self, theta: Floats) -> Floats:
        """Pressure [Pa] at the angles `theta` [rad], same shape; 0 beyond the lining."""
        at = np.asarray(theta, dtype=float)
        ends = self.theta[:: self.order]
        piece = np.clip(np.searchsorted(ends, at, side="right") - 1, 0, len(ends) - 2)
        nodes = piece[..., None] * self.order + np.arange(self.order + 1)
        off = at[..., None] - self.theta[nodes]
        with np.errstate(divide="ignore", invalid="ignore"):
            weight = self._barycentric / off
            value = (weight * self.pressure[nodes]).sum(axis=-1) / weight.sum(axis=-1)
        hit = np.abs(off) < 1e-15
        value = np.where(hit.any(axis=-1), (hit * self.pressure[nodes]).sum(axis=-1), value)
        return np.where((at >= ends[0]) & (at <= ends[-1]), value, 0.0)


class Rim(NamedTuple):
    """The ring's side: `compliance` (2m, 2m) of its nodes under the linings, `of` for each face theirs (n,)."""

    compliance: Floats
    of: list[Ints]


class Found(NamedTuple):
    """Nodal forces (n,) [N] along the normals and the turn of each shoe about its pin [rad], and what is active."""

    force: Floats
    turn: Floats
    active: Bools


def settle(A: Floats, q: Floats, B: Floats, C: Floats, h: Floats, weight: Floats, first: Bools) -> Found:
    """w = q + A f + B y >= 0, f >= 0, w f = 0, C f = h: by sets of active nodes, changed all at once or one by one.

    weight (n,): area of each node, which makes forces comparable. Raises NoAnswer where no set settles.
    """
    n, k = len(q), len(h)
    active = first.copy()
    scale = float(np.median(np.abs(np.diag(A)) * weight))
    fewest, spare, best = n + 1, SPARE, (math.inf, None)
    for step in range(SETTLED):
        a = np.flatnonzero(active)
        if not len(a):
            raise NoAnswer("no node in contact")
        system = np.block([[A[np.ix_(a, a)], B[a]], [C[:, a], np.zeros((k, k))]])
        size = np.concatenate([np.sqrt(weight[a]), np.ones(k)])
        try:
            x = size * np.linalg.solve(system * np.outer(size, size), size * np.concatenate([-q[a], h]))
        except np.linalg.LinAlgError as error:
            raise NoAnswer("a contact set is singular") from error
        f, y = np.zeros(n), x[len(a) :]
        f[a] = x[: len(a)]
        w = (q + A @ f + B @ y) * weight / scale  # a force, as f is
        size_of = float(np.abs(f).sum())
        off = np.where(active, f, w)
        wrong = np.flatnonzero(off < 0)
        wrongness = -float(off[wrong].sum()) / size_of
        if wrongness < best[0]:
            best = wrongness, Found(f, y, active.copy())
        if wrongness < NOISE or (step > PATIENCE and best[0] < NEARLY):
            assert best[1] is not None
            return best[1]
        if len(wrong) < fewest:
            fewest, spare = len(wrong), SPARE
        else:
            spare -= 1
        chosen = wrong if spare > 0 else wrong[-1:]
        active[chosen] = ~active[chosen]
    raise NoAnswer(f"no contact set settles: wrong by {best[0]:.1e}")


def contact(brake: Brake, faces: list[Face], shoes: list[Shoe], rim: Rim | None, first: list[Bools]) -> list[Found]:
    """The forces on the nodes of the faces of shoes that meet the drum together."""
    drag = brake.friction * brake.spin
    counts = [len(face.theta) for face in faces]
    begin = np.concatenate([[0], np.cumsum(counts)])
    n, k = int(begin[-1]), len(faces)
    A, B, C = np.zeros((n, n)), np.zeros((n, k)), np.zeros((k, n))
    q, h, weight = np.zeros(n), np.zeros(k), np.zeros(n)
    spread = []
    for i, (one, shoe) in enumerate(zip(faces, shoes, strict=True)):
        part = slice(begin[i], begin[i + 1])
        m = counts[i]
        normal, pull = np.zeros((m, 2 * m)), np.zeros((2 * m, m))
        for c in range(2):
            normal[np.arange(m), 2 * np.arange(m) + c] = one.normal[:, c]
            pull[2 * np.arange(m) + c, np.arange(m)] = -one.normal[:, c] + drag * one.tangent[:, c]
        A[part, part] = -normal @ one.compliance @ pull
        B[part, i] = -normal @ one.turned
        C[i, part] = one.turned @ pull
        q[part] = one.gap - normal @ one.loaded
        h[i] = -shoe.actuation.moment_about(shoe.hinge)
        weight[part] = one.mass.sum(axis=1)
        spread.append((normal, pull))
    if rim is not None:
        for i, j in np.ndindex(k, k):
            rows, columns = ((2 * rim.of[x][:, None] + np.arange(2)).ravel() for x in (i, j))
            A[begin[i] : begin[i + 1], begin[j] : begin[j + 1]] -= (
                spread[i][0] @ rim.compliance[np.ix_(rows, columns)] @ spread[j][1]
            )
    found = settle(A, q, B, C, h, weight, np.concatenate(first))
    return [
        Found(found.force[a:b], found.turn[i : i + 1], found.active[a:b]) for i, (a, b) in enumerate(pairwise(begin))
    ]


def _solution(brake: Brake, shoe: Shoe, one: Face, found: Found) -> ShoeSolution:
    a = np.flatnonzero(found.active)
    p = np.zeros(len(one.theta))
    p[a] = np.linalg.solve(one.mass[np.ix_(a, a)], found.force[a])
    drag = brake.friction * brake.spin
    on_normal = -(found.force[:, None] * one.normal).sum(axis=0)
    on_tangent = drag * (found.force[:, None] * one.tangent).sum(axis=0)
    return ShoeSolution(
        theta=one.theta,
        pressure=p,
        order=one.degree,
        torque=brake.friction * brake.drum.radius * float(found.force.sum()),
        normal_force=float(np.hypot(*on_normal)),
        hinge_reaction=-(on_normal + on_tangent + shoe.actuation.vector),
        arcs=_arcs(one.theta, p, found.active, one.degree),
        unknowns=one.unknowns,
    )


def _arcs(theta: Floats, p: Floats, active: Bools, degree: int) -> Floats:
    """Arcs [rad] of contact (k, 2). An end inside the lining is where F^(2/3) vanishes, F the force between it and the
    next two ends of pieces: p rises there as the root of the distance."""
    steps = np.diff(np.concatenate([[0], active.astype(int), [0]]))
    firsts, lasts = np.flatnonzero(steps == 1), np.flatnonzero(steps == -1) - 1
    last = len(theta) - 1
    return np.array(
        [
            (_end(theta, p, i, degree), -_end(-theta[::-1], p[::-1], last - j, degree))
            for i, j in zip(firsts, lasts, strict=True)
        ]
    ).reshape(-1, 2)


def _end(theta: Floats, p: Floats, node: int, degree: int) -> float:
    if node == 0:
        return float(theta[0])
    near = (node - 1) // degree * degree + degree  # the end of the piece in which contact begins
    far = near + degree
    if far >= len(theta):
        return float(theta[node])
    psi, _ = trace(degree, 0.5 + 0.5 * GAUSS)
    weight = psi @ (0.5 * WEIGHTS)
    F = np.cumsum([(theta[b] - theta[b - degree]) * float(weight @ p[b - degree : b + 1]) for b in (near, far)])
    if not 0 < F[0] < F[1]:
        return float(theta[node])
    f = F ** (2 / 3)
    end = theta[near] - f[0] * (theta[far] - theta[near]) / (f[1] - f[0])
    return float(np.clip(end, theta[node - 1], theta[node]))


def pressed(brake: Brake) -> list[int]:
    """Shoes that their actuation turns towards the drum."""
    found = []
    for i, shoe in enumerate(brake.shoes):
        theta = np.linspace(shoe.lining.start, shoe.lining.end, 41)
        e = np.stack([np.cos(theta), np.sin(theta)], axis=1)
        arm = brake.drum.radius * e - shoe.hinge.xy
        closing = shoe.sign * (-arm[:, 1] * e[:, 0] + arm[:, 0] * e[:, 1])
        if (closing * shoe.actuation.moment_about(shoe.hinge) > 0).any():
            found.append(i)
    return found


def _wavelength(brake: Brake) -> float:
    highest = max((part.order for part in brake.drum.out_of_round if part.amplitude), default=0)
    return 2 * math.pi * brake.drum.radius / max(highest, 1)


def solve(brake: Brake, level: Level, before: Sequence[ShoeSolution] | None = None) -> list[ShoeSolution]:
    """The solution of each shoe on meshes of one level, graded to the contact's ends of an earlier solution.

    Raises BadInput for what is not meshed, NoAnswer where a shoe does not touch or no contact settles.
    """
    R, shoes = brake.drum.radius, list(brake.shoes)
    if len(pressed(brake)) < len(shoes):
        raise NoAnswer("a shoe that is not turned towards the drum")
    shapes = [outline(shoe, R) for shoe in shoes]
    points = [_points(shoe, None if before is None else before[i]) for i, shoe in enumerate(shoes)]
    lines, meshes = [], []
    for shape, more in zip(shapes, points, strict=True):
        inner = [(theta - shape.origin) * shape.turn for theta in more]
        own = np.concatenate([shape.corners, np.reshape([(s, 0.0) for s in inner], (-1, 2))])
        s, d = grid(shape, level.size, _wavelength(brake), inner)
        lines.append((s, d))
        mesh = start(s, d, shape.layers)
        at = shape.place(own[:, 0], own[:, 1])
        meshes.append(graded(mesh, shape.place, at, _smallest(shape, level, len(more)), level.steep, math.inf))
    rim, firsts = None, []
    if brake.drum.ring is None:
        bodies = [shaped(shape, mesh, level.degree) for shape, mesh in zip(shapes, meshes, strict=True)]
        faces = [face(brake, shoe, body) for shoe, body in zip(shoes, bodies, strict=True)]
    else:
        meshes, ring = _ring(brake, shapes, meshes, lines, points, level)
        bodies = [shaped(shape, mesh, level.degree) for shape, mesh in zip(shapes, meshes, strict=True)]
        faces = [face(brake, shoe, body) for shoe, body in zip(shoes, bodies, strict=True)]
        rim = _rim(brake, ring, faces)
    for i, one in enumerate(faces):
        first = np.ones(len(one.theta), dtype=bool)
        if before is not None:
            first = np.any([(one.theta > a - 1e-12) & (one.theta < b + 1e-12) for a, b in before[i].arcs], axis=0)
        firsts.append(first)
    if rim is not None:
        found = contact(brake, faces, shoes, rim, firsts)
    else:
        found = [contact(brake, [faces[i]], [shoes[i]], None, [firsts[i]])[0] for i in range(len(shoes))]
    return [_solution(brake, shoe, one, its) for shoe, one, its in zip(shoes, faces, found, strict=True)]


def _smallest(shape: Outline, level: Level, more: int) -> Floats:
    """Lengths [m] of the triangles at the corners of an outline and at so many further points on its face."""
    halvings = [level.halvings] * len(shape.corners) + [min(ENDS, level.halvings)] * more
    return _least(shape) * 0.5 ** np.array(halvings)


def _least(shape: Outline) -> float:
    """The length from which the halvings towards a corner count [m]."""
    arc = (shape.layers[0].end - shape.layers[0].start) * shape.length
    return min(float(shape.thickness.min()), arc / 4)


def _points(shoe: Shoe, before: ShoeSolution | None) -> list[float]:
    """Angles within the lining at which p is not smooth."""
    theta = clearance.kinks(shoe.lining) + ([] if before is None else before.arcs.ravel().tolist())
    slack = 1e-9 * (shoe.lining.end - shoe.lining.start)
    return [angle for angle in theta if shoe.lining.start + slack < angle < shoe.lining.end - slack]


def _ring(
    brake: Brake,
    shapes: list[Outline],
    meshes: list[Triangles],
    lines: list[tuple[Floats, list[Floats]]],
    points: list[list[float]],
    level: Level,
) -> tuple[list[Triangles], Shaped]:
    """The linings' meshes and the ring's, whose edges match."""
    ring, R = brake.drum.ring, brake.drum.radius
    section = None if ring is None else ring.section
    if section is None:
        raise BadInput("its ring has no section to mesh")
    sign = brake.shoes[0].sign
    if any(shoe.sign != sign for shoe in brake.shoes):
        raise BadInput("shoes inside and outside of one ring")
    zero = min(shoe.lining.start for shoe in brake.shoes)
    turns = [2 * math.pi * math.floor((shoe.lining.start - zero) / (2 * math.pi) + 1e-12) for shoe in brake.shoes]

    def on_ring(i: int, s: Floats) -> Floats:
        return shapes[i].origin + shapes[i].turn * s - turns[i]

    parts = []
    for i, (shape, (s, _)) in enumerate(zip(shapes, lines, strict=True)):
        slack = 1e-12
        under = s[(s > shape.layers[0].start - slack) & (s < shape.layers[0].end + slack)]
        parts.append(np.sort(on_ring(i, under)))
    parts.sort(key=lambda part: float(part[0]))
    least = min(_least(shape) for shape in shapes) * level.size
    full = []
    for part, after in zip(parts, [*parts[1:], parts[0] + 2 * math.pi], strict=True):
        gap = np.array([part[-1], after[0]])
        between = spaced(gap, lambda x, gap=gap: (max(least, 0.5 * section.thickness * level.size) + 0.5 * R * float(np.abs(gap - x).min())) / R if float(np.abs(gap - x).min()) * R < 4 * section.thickness else 2.5 * section.thickness / R * level.size)
        full += [part, between[1:-1]]
    s = np.concatenate([*full, [parts[0][0] + 2 * math.pi]])
    t = section.thickness

    def place(s: Floats, d: Floats) -> Floats:
        r = R + sign * t * d
        return np.stack([r * np.cos(s), r * np.sin(s)], axis=-1)

    layer = Layer(-math.inf, math.inf, section.material.E, section.material.nu, section.width)
    depth = spaced(np.array([0.0, 1.0]), lambda x: min(0.5, max(least / t, 0.1) + 0.7 * min(x, 1 - x)))
    shape = Outline(place, [layer], np.array([t]), s[[0, -1]], np.zeros((0, 2)), None, None, 0.0, 1, R)
    at = np.concatenate(
        [
            on_ring(i, np.array([one.layers[0].start, one.layers[0].end]))
            for i, one in enumerate(shapes)
        ]
        + [np.array(more) - turn for more, turn in zip(points, turns, strict=True)]
    )
    halvings = [level.halvings] * (2 * len(shapes)) + [min(ENDS, level.halvings)] * sum(map(len, points))
    smallest = min(min(_least(one) for one in shapes), t) * 0.5 ** np.array(halvings)
    at_xy = place(at, np.zeros(len(at)))
    mesh = graded(start(s, [depth], [layer], 2 * math.pi), place, at_xy, smallest, level.steep, math.inf)
    slack = 1e-12
    for _ in range(20):
        before = len(mesh.layer), [len(one.layer) for one in meshes]
        above = np.unique(np.concatenate([on_ring(i, np.unique(one.surface_spans())) for i, one in enumerate(meshes)]))
        mesh = matched(mesh, above, slack)
        spans = np.unique(mesh.surface_spans())
        meshes = [
            matched(one, np.sort((spans + turns[i] - shapes[i].origin) * shapes[i].turn), slack)
            for i, one in enumerate(meshes)
        ]
        if before == (len(mesh.layer), [len(one.layer) for one in meshes]):
            return meshes, shaped(shape, mesh, level.degree)
    raise AssertionError("ring and linings do not match")


def _rim(brake: Brake, ring: Shaped, faces: list[Face]) -> Rim:
    """The ring condensed to the nodes opposite to those of the faces. A free ring's rim carries what balances the
    contact, spread as its rigid motions are, and does not move in the mean."""
    nodes = ring.nodes
    theta = nodes.at[ring.surface, 0]
    xy = nodes.xy[ring.surface]
    chosen, of, count = [], [], 0
    for one in faces:
        away = np.angle((xy[:, 0] + 1j * xy[:, 1]) * np.exp(-1j * 0.5 * (one.theta[0] + one.theta[-1])))
        half = 0.5 * (one.theta[-1] - one.theta[0])
        under = np.flatnonzero(np.abs(away) < half + 1e-12)
        under = under[np.argsort(away[under])]
        if len(under) != len(one.theta) or np.abs(xy[under] - one.xy).max() > 1e-9 * brake.drum.radius:
            raise AssertionError("ring and lining do not match")
        chosen.append(ring.surface[under])
        of.append(count + np.arange(len(under)))
        count += len(under)
    del theta
    kept = np.concatenate(chosen)
    outer = np.flatnonzero(nodes.at[:, 1] > 1 - 1e-12)
    assert brake.drum.ring is not None
    held = np.zeros(2 * len(nodes.xy), dtype=bool)
    if brake.drum.ring.support == "fixed":
        held[2 * outer], held[2 * outer + 1] = True, True
        found: Compliance = lagrange.condense(ring.K, nodes, held, kept, np.zeros((len(held), 0)))
        return Rim(found.of, of)
    on = ring.mesh.at[..., 1] > 1 - 1e-12
    tri, edge = np.nonzero(on & np.roll(on, -1, axis=1))
    along = _edge(nodes, tri, edge, ring.degree)
    psi, slope = trace(ring.degree, 0.5 + 0.5 * GAUSS)
    x = np.einsum("kac,aq->kqc", nodes.xy[along], psi)
    ds = np.hypot(*np.moveaxis(np.einsum("kac,aq->kqc", nodes.xy[along], slope), 2, 0)) * 0.5 * WEIGHTS
    rims = np.zeros((len(nodes.xy), 2, 3))
    motions = np.stack([np.stack([1 + 0 * x[..., 0], 0 * x[..., 0]], -1), np.stack([0 * x[..., 0], 1 + 0 * x[..., 0]], -1), np.stack([-x[..., 1], x[..., 0]], -1)])
    np.add.at(rims, along, np.einsum("aq,lkqc,kq->kacl", psi, motions, ds / ds.sum()))
    rims = rims.reshape(-1, 3)
    X, Y = nodes.xy.T
    rigid = np.stack([np.stack([1 + 0 * X, 0 * X], 1).ravel(), np.stack([0 * X, 1 + 0 * X], 1).ravel(), np.stack([-Y, X], 1).ravel()], 1)
    right, left = outer[np.argmax(X[outer])], outer[np.argmin(X[outer])]
    held[[2 * right, 2 * right + 1, 2 * left + 1]] = True
    found = lagrange.condense(ring.K, nodes, held, kept, rims)
    dofs = (2 * kept[:, None] + np.arange(2)).ravel()
    # forces f on the kept nodes, -rims l on the rim, l = (R^T rims)^-1 R_c^T f; then the rim's mean motion taken away
    share = np.linalg.solve(rigid.T @ rims, rigid[dofs].T)
    moved = found.of - found.loaded @ share
    mean = found.loaded.T - found.work @ share
    return Rim(moved - rigid[dofs] @ np.linalg.solve(rims.T @ rigid, mean), of)
