"""The elastic drum ring: its mesh, its condensation, and how the linings of all shoes load it.

The ring is met by the same pressures as the linings, on meshes that need not match: the pressure's shape
functions psi_i of a lining and the ring's phi_j are integrated on the common refinement of both angle grids,

    N_i,jc = b Int psi_i phi_j n_c ds,    T_i,jc = b Int psi_i phi_j (r / r_ring) e_c ds,

with the lining's ds and radius r, so that the forces on both sides cancel, and their torques too.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg
import skfem

from drumlin.arrays import Floats, Ints
from drumlin.brake import Brake, Ring, Section, Shoe
from drumlin.fem.body import FRAME, Condensed, condense, scalar_basis, stiffness, tie
from drumlin.fem.interface import ContactLine, contact_line
from drumlin.fem.mesh import FACE_SIZE, graded, lining_angles, lining_layers
from drumlin.statics import GAUSS, WEIGHTS, shape


@dataclass(frozen=True)
class RingBody:
    """The ring, condensed to its nodes under the linings, in the brake's frame.

    `pressed[i]`, `dragged[i]` (m, n_i): for shoe i the half flexibilities under the nodal forces N^T and -T^T of
    its pressure: the weighted gap of shoe i opens under the pressure of shoe j by
    pressed[i]^T (pressed[j] + drag dragged[j]) p_j.
    """

    mesh: Any
    basis: Any
    line: ContactLine
    condensed: Condensed
    pressed: tuple[Floats, ...]
    dragged: tuple[Floats, ...]


def ring_mesh(ring: Section, radius: float, shoes: tuple[Shoe, ...], elements: int) -> Any:
    """Quadratic quadrilateral mesh of the whole ring, away from the shoes; finer where linings end.

    `elements`: number along each lining. Boundaries: "contact" (all of the friction surface), "support".
    """
    sign = shoes[0].sign
    arcs = sorted((s.lining.start % (2 * math.pi), s.lining.end - s.lining.start, s) for s in shoes)
    step = min(arc for _, arc, _ in arcs) / elements
    parts = [start + lining_angles(arc, shoe, radius, elements) for start, arc, shoe in arcs]
    angles = np.unique(np.concatenate(parts) % (2 * math.pi))
    angles = angles[np.append(True, np.diff(angles) > 0.01 * step)] if len(arcs) > 1 else angles
    gaps = np.diff(np.append(angles, angles[0] + 2 * math.pi))
    filled = [a + g * np.arange(k := max(1, round(g / (1.5 * step)))) / k for a, g in zip(angles, gaps, strict=True)]
    angles = np.concatenate(filled)
    m = len(angles)
    depths = graded(0, ring.thickness, lining_layers(elements), ring.thickness / 2, FACE_SIZE)
    depth, theta = np.repeat(depths, m), np.tile(angles, len(depths))
    corner = np.arange(len(depths) * m).reshape(len(depths), m)
    after = np.roll(corner, -1, axis=1)
    cells = np.array([corner[:-1], corner[1:], after[1:], after[:-1]]).reshape(4, -1)
    grid = skfem.MeshQuad(np.array([np.cos(theta), np.sin(theta)]), cells)
    direction = skfem.MeshQuad2.from_mesh(grid).doflocs  # of a midside node: that of its edge's middle
    height = skfem.MeshQuad2.from_mesh(skfem.MeshQuad(np.array([depth, theta]), cells, validate=False)).doflocs[0]
    r = radius + sign * height
    inner = np.isin(np.arange(grid.nfacets), grid.boundary_facets())
    middle = depth[grid.facets].mean(axis=0)
    return skfem.MeshQuad2(
        r * direction / np.hypot(*direction),
        grid.t,
        _subdomains={"drum": np.arange(grid.nelements)},
        _boundaries={
            "contact": np.flatnonzero(inner & (middle < 0.5 * ring.thickness)),
            "support": np.flatnonzero(inner & (middle > 0.5 * ring.thickness)),
        },
    )


def ring_body(brake: Brake, ring: Ring, linings: tuple[ContactLine, ...], elements: int) -> RingBody:
    """Mesh and condense the ring under the linings, given by their contact lines in the shoes' frames."""
    section = ring.section
    assert section is not None  # scene.why_not
    mesh = ring_mesh(section, brake.drum.radius, brake.shoes, elements)
    basis = scalar_basis(mesh)
    K = stiffness(basis, {"drum": (section.material, section.width)})
    angles = [shoe.frame.theta(line.phi) for shoe, line in zip(brake.shoes, linings, strict=True)]
    under = _facets_under(mesh, [(float(a.min()), float(a.max())) for a in angles])
    line = contact_line(basis, under, math.pi)
    n = 2 * len(line.nodes)
    support = basis.get_dofs(mesh.boundaries["support"]).flatten()
    if ring.support == "fixed":
        ties = tie(basis, line.nodes, support, np.zeros(2))
        condensed = condense(K, ties, np.zeros((ties.shape[1], 0)), n)
        free = None
    else:
        ties = tie(basis, line.nodes, support[:0], np.zeros(2), determinate(basis, support))
        rim = rim_loads(basis, mesh.boundaries["support"])
        condensed = condense(K, ties, ties.T @ rim, n)
        free = _Free.of(basis, rim, condensed, line)
    halves = []
    for shoe, lining, theta in zip(brake.shoes, linings, angles, strict=True):
        N, T = couple_ring(lining, theta, line, shoe.lining.width, shoe.sign)
        halves.append([_half(condensed, forces.T, free) for forces in (N, -T)])
    pressed, dragged = zip(*halves, strict=True)
    return RingBody(mesh, basis, line, condensed, tuple(pressed), tuple(dragged))


def _facets_under(mesh: Any, arcs: list[tuple[float, float]]) -> Ints:
    """Facets of the friction surface that lie under one of the arcs [rad], at least in part."""
    facets = mesh.boundaries["contact"]
    x, y = mesh.p[:, mesh.facets[:, facets]]
    first, second = np.arctan2(y, x)
    half = 0.5 * np.abs((second - first + math.pi) % (2 * math.pi) - math.pi)
    middle = np.arctan2(y.sum(axis=0), x.sum(axis=0))
    under = np.zeros(len(facets), dtype=bool)
    for start, end in arcs:
        away = np.abs((middle - 0.5 * (start + end) + math.pi) % (2 * math.pi) - math.pi)
        under |= away < 0.5 * (end - start) + half * (1 - 1e-9)
    return facets[under]


def couple_ring(
    lining: ContactLine, theta: Floats, ring: ContactLine, width: float, sign: int
) -> tuple[Floats, Floats]:
    """N and T (n, 2 n_ring) of a lining's pressure on the ring, in the brake's frame; n = sign e_r.

    lining: in the shoe's frame, `theta` (n,) its nodes' angles in the brake's. Integrated on the common
    refinement of both angle grids.
    """
    radius = np.hypot(*lining.xy)
    xy = radius * np.array([np.cos(theta), np.sin(theta)])
    order = lining.order
    starts, ends = np.sort(theta[lining.pieces[[0, -1]]], axis=0)
    pieces, a, b = _pieces_near(ring, 0.5 * (starts.min() + ends.max()))
    i, j = np.nonzero(np.maximum.outer(starts, a) < np.minimum.outer(ends, b) - 1e-13)
    low, high = np.maximum(starts[i], a[j]), np.minimum(ends[i], b[j])
    angle = low[:, None] + 0.5 * (high - low)[:, None] * (1 + GAUSS)
    xi = _local(xy[:, lining.pieces[:, i]], angle)
    eta = _local(ring.xy[:, pieces[:, j]], angle)
    psi, slope = shape(order, xi.ravel()).reshape(-1, *xi.shape), _slopes(order, xi)
    phi = shape(ring.order, eta.ravel()).reshape(-1, *eta.shape)
    x = np.einsum("cki,kiq->ciq", xy[:, lining.pieces[:, i]], psi)
    dx = np.einsum("cki,kiq->ciq", xy[:, lining.pieces[:, i]], slope)
    r = np.hypot(*x)
    turning = np.abs(x[0] * dx[1] - x[1] * dx[0]) / r**2  # d angle / d xi
    ds = np.hypot(*dx) / turning * 0.5 * (high - low)[:, None] * WEIGHTS * width
    r_ring = np.hypot(*np.einsum("cki,kiq->ciq", ring.xy[:, pieces[:, j]], phi))
    normal, tangent = sign * x / r, np.array([-x[1], x[0]]) / r * (r / r_ring)
    n, m = len(theta), len(ring.nodes)
    result = []
    for vectors in (normal, tangent):
        matrix = np.zeros((n, m, 2))
        values = np.einsum("aiq,biq,ciq,iq->abic", psi, phi, vectors, ds)
        np.add.at(matrix, (lining.pieces[:, None, i], pieces[None][:, :, j]), values)
        result.append(matrix.reshape(n, 2 * m))
    return result[0], result[1]


def _pieces_near(ring: ContactLine, middle: float) -> tuple[Ints, Floats, Floats]:
    """The ring's edges (order + 1, m) by growing angle, and the angles of their ends within 180 deg of `middle`."""
    z = ring.xy[0] + 1j * ring.xy[1]
    first, last = z[ring.pieces[0]], z[ring.pieces[-1]]
    turn = np.angle(last / first)
    pieces = np.where(turn > 0, ring.pieces, ring.pieces[::-1])
    start = np.angle(np.where(turn > 0, first, last))
    centre = start + 0.5 * np.abs(turn)
    start = start + 2 * math.pi * np.round((middle - centre) / (2 * math.pi))
    return pieces, start, start + np.abs(turn)


def _local(xy: Floats, angle: Floats) -> Floats:
    """Local coordinates xi in [-1, 1] where the pieces with nodes xy (2, k, m) cross the rays `angle` (m, points)."""
    order = xy.shape[1] - 1
    ray = np.array([-np.sin(angle), np.cos(angle)])  # normal of the ray: x . ray = 0 on it
    side = np.einsum("cki,ciq->kiq", xy, ray)
    xi = (side[0] + side[-1]) / (side[0] - side[-1])
    for _ in range(8 if order > 1 else 0):
        value = np.einsum("kiq,kiq->iq", shape(order, xi.ravel()).reshape(-1, *xi.shape), side)
        xi = xi - value / np.einsum("kiq,kiq->iq", _slopes(order, xi), side)
    return np.clip(xi, -1.0, 1.0)


def _slopes(order: int, xi: Floats) -> Floats:
    """Derivatives of the shape functions at xi (any shape): (order + 1, *xi.shape)."""
    nodes = np.linspace(-1, 1, order + 1)
    return np.array([np.polyval(np.polyder(np.polyfit(nodes, row, order)), xi) for row in np.eye(order + 1)])


def rim_loads(basis: Any, facets: Ints) -> Floats:
    """Nodal forces (2 nodes, 3) spread over the rim as the rigid motions are: the mean motions are their work."""
    edge = basis.boundary(facets)
    x, weight = np.asarray(edge.global_coordinates()), edge.dx / edge.dx.sum()
    modes = np.array([[np.ones_like(x[0]), 0 * x[0]], [0 * x[0], np.ones_like(x[0])], [-x[1], x[0]]])
    loads = np.zeros((basis.N, 2, FRAME))
    for psi, dofs in zip(edge.basis, edge.element_dofs, strict=True):
        for k in range(FRAME):
            for c in range(2):
                np.add.at(loads[:, c, k], dofs, (psi[0] * modes[k, c] * weight).sum(axis=1))
    return loads.reshape(-1, FRAME)


def determinate(basis: Any, support: Ints) -> Ints:
    """Three unknowns of rim nodes that hold the body against rigid motion, statically determinate: (3,)."""
    angle = np.arctan2(basis.doflocs[1, support], basis.doflocs[0, support])
    right = support[np.argmin(np.abs(angle))]
    left = support[np.argmax(np.abs(angle))]
    return np.array([2 * right, 2 * right + 1, 2 * left + 1])


@dataclass(frozen=True)
class _Free:
    """A free ring: contact forces f are met by rim forces -B lambda, and the mean motion of the rim is zero.

    With R the rigid motions,  lambda = (R^T B)^-1 R^T f;  held at three determinate unknowns, which then carry
    nothing, the work of the displacements is (Y - Y_B lambda)^T D^-1 (Y - Y_B lambda) + lambda^T beta lambda,
    where beta is the work of B with the contact nodes held too.
    """

    balance: Floats
    half_rim: Floats
    root: Floats

    @classmethod
    def of(cls, basis: Any, rim: Floats, condensed: Condensed, line: ContactLine) -> "_Free":
        x, y = basis.doflocs
        rigid = np.zeros((basis.N, 2, FRAME))
        rigid[:, 0, 0] = rigid[:, 1, 1] = 1.0
        rigid[:, 0, 2], rigid[:, 1, 2] = -y, x
        balance = np.linalg.solve(rigid.reshape(-1, FRAME).T @ rim, rigid[line.nodes].reshape(-1, FRAME).T)
        V = condensed.factors.solve(condensed.loads)
        kept = np.vstack([condensed.load_c, condensed.load_f])
        beta = condensed.loads.T @ V - kept.T @ V[-len(kept) :]
        root = scipy.linalg.sqrtm(0.5 * (beta + beta.T)).real
        return cls(np.asarray(balance), condensed.half(condensed.load_c), root)


def _half(condensed: Condensed, forces: Floats, free: _Free | None) -> Floats:
    """W (m, k) with W^T W the work of the displacements under nodal forces (2n, k)."""
    Y = condensed.half(forces)
    if free is None:
        return Y / np.sqrt(condensed.D_c)[:, None]
    reaction = free.balance @ forces
    return np.vstack([(Y - free.half_rim @ reaction) / np.sqrt(condensed.D_c)[:, None], free.root @ reaction])
