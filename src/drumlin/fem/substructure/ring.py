"""The elastic drum ring: its mesh, its condensation, and how the linings of all shoes load it.

The ring is met by the same pressures as the linings, on meshes that need not match: the pressure's
shape functions psi_i of a lining and the ring's phi_j are integrated on the common refinement of
both angle grids,

    N_i,jc = b Int psi_i phi_j n_c ds
    T_i,jc = b Int psi_i [phi_j e_c + (r - r_ring) (k x tau)_c d phi_j/ds_ring] ds

with the lining's ds and radius r and the ring's tangent tau. Both arcs are only nearly round: where
the drag acts at r, off the ring's own arc at r_ring, the bracket moves it by a couple that is exact
for rigid motions. So forces and torques of both sides cancel to round-off.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Section
from drumlin.fem.mesh.edges import edge_nodes
from drumlin.fem.mesh.grading import EDGE_SIZE, graded, lining_angles, lining_layers
from drumlin.fem.substructure.body import (
    FRAME,
    CondensedBody,
    condense,
    constrain,
    scalar_basis,
    stiffness,
)
from drumlin.fem.substructure.elasticity import ring_layers
from drumlin.fem.substructure.interface import ContactLine, contact_line, edge_points
from drumlin.response.resultants import GAUSS, WEIGHTS, shape, slopes


@dataclass(frozen=True)
class RingSubstructure:
    """The ring, condensed to its nodes under the linings, in the brake's frame.

    `pressed[i]`, `dragged[i]` (m, n_i): for shoe i the half flexibilities under the nodal forces
    N^T and -T^T of its pressure: the weighted gap of shoe i opens under the pressure of shoe j by
    pressed[i]^T (pressed[j] + drag dragged[j]) p_j. `coupled[i]`: N and T (n_i, 2n) of shoe i.
    `support`: nodes of the far edge. `free`: what makes a free ring determinate, None where that
    edge is fixed.
    """

    mesh: Any
    basis: Any
    line: ContactLine
    condensed: CondensedBody
    pressed: tuple[Floats, ...]
    dragged: tuple[Floats, ...]
    coupled: tuple[tuple[Floats, Floats], ...]
    support: Ints
    free: "FreeRing | None"

    def displacement(self, pressures: list[Floats], drag: float) -> Floats:
        """Displacement of all nodes (2, nodes) [m] under the pressures (n_i,) [Pa] of the linings,
        drag = mu s.
        """
        forces = sum(
            N.T @ p - drag * (T.T @ p) for (N, T), p in zip(self.coupled, pressures, strict=True)
        )
        nodal = np.asarray(forces)
        frame = np.zeros(FRAME)
        if self.free is None:
            return self.condensed.displacement(nodal, frame, np.zeros(0))
        u = self.condensed.displacement(nodal, frame, -self.free.balance @ nodal)
        x, y = self.basis.doflocs
        rigid = np.array([[1 + 0 * x, 0 * x], [0 * x, 1 + 0 * x], [-y, x]])
        mean = np.einsum("kci,cil->kl", rigid, self.free.rim)
        motion = np.linalg.solve(mean.T, np.einsum("ci,cil->l", u, self.free.rim))
        return np.asarray(u - np.einsum("k,kci->ci", motion, rigid))


def ring_mesh(ring: Section, radius: float, shoes: tuple[Shoe, ...], elements: int) -> Any:
    """Quadratic quadrilateral mesh of the whole ring, away from the shoes; finer where linings end.

    `elements`: number along each lining. Boundaries: "contact" (all of the friction surface),
    "support".
    """
    sign = shoes[0].sign
    arcs = sorted((s.lining.start % (2 * math.pi), s.lining.end - s.lining.start, s) for s in shoes)
    step = min(arc for _, arc, _ in arcs) / elements
    parts = [start + lining_angles(arc, shoe, radius, elements) for start, arc, shoe in arcs]
    angles = np.unique(np.concatenate(parts) % (2 * math.pi))
    angles = angles[np.append(True, np.diff(angles) > 0.01 * step)] if len(arcs) > 1 else angles
    gaps = np.diff(np.append(angles, angles[0] + 2 * math.pi))
    filled = [
        a + g * np.arange(k := max(1, round(g / (1.5 * step)))) / k
        for a, g in zip(angles, gaps, strict=True)
    ]
    angles = np.concatenate(filled)
    depths = graded(0, ring.thickness, lining_layers(elements), ring.thickness / 2, EDGE_SIZE)
    return closed_mesh(angles, depths, radius, sign, "drum")


def closed_mesh(angles: Floats, depths: Floats, radius: float, sign: int, name: str) -> Any:
    """Quadratic quadrilateral mesh of a closed ring from `radius` to radius + sign depth [m].

    `angles` (m,) within one turn and `depths` from 0: the ends of the elements. Subdomain `name`;
    boundaries "contact" at depth 0 and "support" at the other side.
    """
    import skfem  # noqa: PLC0415  (meshes alone load it)

    m = len(angles)
    depth, theta = np.repeat(depths, m), np.tile(angles, len(depths))
    corner = np.arange(len(depths) * m).reshape(len(depths), m)
    after = np.roll(corner, -1, axis=1)
    cells = np.array([corner[:-1], corner[1:], after[1:], after[:-1]]).reshape(4, -1)
    grid = skfem.MeshQuad(np.array([np.cos(theta), np.sin(theta)]), cells, validate=False)
    direction = skfem.MeshQuad2.from_mesh(
        grid
    ).doflocs  # of a midside node: that of its edge's middle
    height = skfem.MeshQuad2.from_mesh(
        skfem.MeshQuad(np.array([depth, theta]), cells, validate=False)
    ).doflocs[0]
    outer = np.isin(np.arange(grid.nfacets), grid.boundary_facets())
    middle = depth[grid.facets].mean(axis=0)
    return skfem.MeshQuad2(
        (radius + sign * height) * direction / np.hypot(*direction),
        grid.t,
        _subdomains={name: np.arange(grid.nelements)},
        _boundaries={
            "contact": np.flatnonzero(outer & (middle < 0.5 * depths[-1])),
            "support": np.flatnonzero(outer & (middle > 0.5 * depths[-1])),
        },
    )


def ring_body(brake: Brake, elements: int, linings: tuple[ContactLine, ...]) -> RingSubstructure:
    """Mesh and condense the ring under the linings, given by their contact lines in the shoes'
    frames.
    """
    ring = brake.ring
    assert ring is not None and ring.section is not None  # scene.why_not
    section = ring.section
    mesh = ring_mesh(section, brake.size, brake.shoes, elements)
    basis = scalar_basis(mesh)
    K = stiffness(basis, ring_layers(section))
    angles = [shoe.frame.theta(line.phi) for shoe, line in zip(brake.shoes, linings, strict=True)]
    under = _facets_under(mesh, [(float(a.min()), float(a.max())) for a in angles])
    line = contact_line(basis, under, math.pi)
    n = 2 * len(line.nodes)
    support = basis.get_dofs(mesh.boundaries["support"]).flatten()
    if ring.support == "fixed":
        constraints = constrain(basis, line.nodes, support, np.zeros(2))
        condensed = condense(K, constraints, {}, n)
        free = None
    else:
        constraints = constrain(
            basis, line.nodes, support[:0], np.zeros(2), determinate(basis, support)
        )
        rim = rim_loads(basis, mesh.boundaries["support"])
        condensed = condense(K, constraints, {"rim": constraints.matrix.T @ rim}, n)
        free = FreeRing.of(basis, rim, condensed, line)
    return coupled_ring(brake, linings, mesh, basis, line, condensed, support, free)


def coupled_ring(
    brake: Brake,
    linings: tuple[ContactLine, ...],
    mesh: Any,
    basis: Any,
    line: ContactLine,
    condensed: CondensedBody,
    support: Ints,
    free: "FreeRing | None",
) -> RingSubstructure:
    """A condensed ring, coupled with the linings, given by their contact lines in the shoes'
    frames.
    """
    coupled = tuple(
        couple_ring(
            replace(lining, xy=shoe.frame.to_brake(lining.xy.T).T),
            line,
            shoe.lining.width,
            shoe.sign,
        )
        for shoe, lining in zip(brake.shoes, linings, strict=True)
    )
    pressed = tuple(_half(condensed, N.T, free) for N, _ in coupled)
    dragged = tuple(_half(condensed, -T.T, free) for _, T in coupled)
    return RingSubstructure(mesh, basis, line, condensed, pressed, dragged, coupled, support, free)


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
    lining: ContactLine, ring: ContactLine, width: float, sign: int
) -> tuple[Floats, Floats]:
    """N and T (n, 2 n_ring) of a lining's pressure on the ring; n = sign e_r.

    Both lines in the brake's frame. Integrated on the common refinement of both angle grids.
    """
    order, xy = lining.order, lining.xy
    pieces_of_lining, starts, ends = _arcs(lining)
    pieces, a, b = _arcs(ring)
    whole_turns = (
        2 * math.pi * np.round(0.5 * np.subtract.outer(starts + ends, a + b) / (2 * math.pi))
    )
    first = np.maximum(starts[:, None], a + whole_turns)
    last = np.minimum(ends[:, None], b + whole_turns)
    i, j = np.nonzero(first < last - 1e-13)
    low, high = first[i, j], last[i, j]
    angle = low[:, None] + 0.5 * (high - low)[:, None] * (1 + GAUSS)
    xi = _local(xy[:, pieces_of_lining[:, i]], angle)
    eta = _local(ring.xy[:, pieces[:, j]], angle)
    psi, slope = shape(order, xi.ravel()).reshape(-1, *xi.shape), slopes(order, xi)
    phi = shape(ring.order, eta.ravel()).reshape(-1, *eta.shape)
    x = np.einsum("cki,kiq->ciq", xy[:, pieces_of_lining[:, i]], psi)
    dx = np.einsum("cki,kiq->ciq", xy[:, pieces_of_lining[:, i]], slope)
    r = np.hypot(*x)
    turning = np.abs(x[0] * dx[1] - x[1] * dx[0]) / r**2  # d angle / d xi
    ds = np.hypot(*dx) / turning * 0.5 * (high - low)[:, None] * WEIGHTS * width
    nodes = ring.xy[:, pieces[:, j]]
    r_ring = np.hypot(*np.einsum("cki,kiq->ciq", nodes, phi))
    tau = np.einsum("cki,kiq->ciq", nodes, slopes(ring.order, eta))
    length = np.hypot(*tau)
    aside = np.array([-tau[1], tau[0]]) / length * (r - r_ring)
    n, m = len(lining.nodes), len(ring.nodes)
    N, T = np.zeros((n, m, 2)), np.zeros((n, m, 2))
    where = (pieces_of_lining[:, None, i], pieces[None][:, :, j])
    normal, tangent = sign * x / r, np.array([-x[1], x[0]]) / r
    np.add.at(N, where, np.einsum("aiq,biq,ciq,iq->abic", psi, phi, normal, ds))
    np.add.at(T, where, np.einsum("aiq,biq,ciq,iq->abic", psi, phi, tangent, ds))
    np.add.at(
        T,
        where,
        np.einsum("aiq,biq,ciq,iq->abic", psi, slopes(ring.order, eta) / length, aside, ds),
    )
    return N.reshape(n, 2 * m), T.reshape(n, 2 * m)


def _arcs(line: ContactLine) -> tuple[Ints, Floats, Floats]:
    """The edges of a line (order + 1, m), each by growing angle, and the angles of their ends (m,)."""
    z = line.xy[0] + 1j * line.xy[1]
    first, last = z[line.pieces[0]], z[line.pieces[-1]]
    turn = np.angle(last / first)
    pieces = np.where(turn > 0, line.pieces, line.pieces[::-1])
    start = np.angle(np.where(turn > 0, first, last))
    return pieces, start, start + np.abs(turn)


def _local(xy: Floats, angle: Floats) -> Floats:
    """Local coordinates xi in [-1, 1] where the pieces with nodes xy (2, k, m) cross the rays
    `angle` (m, points).
    """
    order = xy.shape[1] - 1
    ray = np.array([-np.sin(angle), np.cos(angle)])  # normal of the ray: x . ray = 0 on it
    side = np.einsum("cki,ciq->kiq", xy, ray)
    xi = (side[0] + side[-1]) / (side[0] - side[-1])
    for _ in range(8 if order > 1 else 0):
        value = np.einsum("kiq,kiq->iq", shape(order, xi.ravel()).reshape(-1, *xi.shape), side)
        xi = xi - value / np.einsum("kiq,kiq->iq", slopes(order, xi), side)
    return np.clip(xi, -1.0, 1.0)


def rim_loads(basis: Any, facets: Ints) -> Floats:
    """Nodal forces (2 nodes, 3) spread over the rim as the rigid motions are: the mean motions are
    their work.
    """
    nodes = edge_nodes(basis, facets)
    psi, x, ds = edge_points(basis.doflocs[:, nodes])
    weight = ds / ds.sum()
    modes = np.array([[np.ones_like(ds), 0 * ds], [0 * ds, np.ones_like(ds)], [-x[1], x[0]]])
    loads = np.zeros((basis.N, 2, FRAME))
    np.add.at(loads, nodes, np.einsum("aq,lciq,iq->aicl", psi, modes, weight))
    return loads.reshape(-1, FRAME)


def determinate(basis: Any, support: Ints) -> Ints:
    """Three unknowns of rim nodes that hold the body against rigid motion, statically determinate:
    (3,).
    """
    angle = np.arctan2(basis.doflocs[1, support], basis.doflocs[0, support])
    right = support[np.argmin(np.abs(angle))]
    left = support[np.argmax(np.abs(angle))]
    return np.array([2 * right, 2 * right + 1, 2 * left + 1])


@dataclass(frozen=True)
class FreeRing:
    """A free ring: contact forces f are met by rim forces -B lambda, and the mean motion of the rim
    is zero.

    With R the rigid motions,  lambda = (R^T B)^-1 R^T f;  held at three determinate unknowns, which then carry
    nothing, the work of the displacements is (Y - Y_B lambda)^T (Y - Y_B lambda) + lambda^T beta
    lambda, where beta is the work of B with the contact nodes held too.
    """

    rim: Floats
    balance: Floats
    half_rim: Floats
    root: Floats

    @classmethod
    def of(cls, basis: Any, rim: Floats, condensed: CondensedBody, line: ContactLine) -> "FreeRing":
        """From the rim's forces B (2 nodes, FRAME) `rim`, and the ring condensed with B as its
        loads.
        """
        x, y = basis.doflocs
        rigid = np.zeros((basis.N, 2, FRAME))
        rigid[:, 0, 0] = rigid[:, 1, 1] = 1.0
        rigid[:, 0, 2], rigid[:, 1, 2] = -y, x
        balance = np.linalg.solve(
            rigid.reshape(-1, FRAME).T @ rim, rigid[line.nodes].reshape(-1, FRAME).T
        )
        from scipy.linalg import sqrtm  # noqa: PLC0415  (rings alone load it)

        root = sqrtm(condensed.load_work).real
        return cls(
            rim.reshape(-1, 2, FRAME).transpose(1, 0, 2),
            np.asarray(balance),
            condensed.half(condensed.load_on_contact),
            root,
        )


def _half(condensed: CondensedBody, forces: Floats, free: FreeRing | None) -> Floats:
    """W (m, k) with W^T W the work of the displacements under nodal forces (2n, k)."""
    Y = condensed.half(forces)
    if free is None:
        return Y
    reaction = free.balance @ forces
    return np.vstack([Y - free.half_rim @ reaction, free.root @ reaction])
