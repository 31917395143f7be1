"""Two elastic bodies pressed together: made from drumlin's parts, without a brake.

The inner body carries the pressure (as a lining does), the outer one is met on the common
refinement of both angle grids. Each is held at its far side; the inner one's holder may move in
`motions`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import skfem

from drumlin.base.arrays import Bools, Floats
from drumlin.brake.elasticity import ElasticLayer
from drumlin.brake.fields import Material
from drumlin.contact import active_set, stick_slip
from drumlin.contact.equations import Problem
from drumlin.fem.substructure.body import (
    CondensedBody,
    condense,
    constrain,
    scalar_basis,
    stiffness,
)
from drumlin.fem.substructure.interface import ContactLine, Coupling, contact_line, couple, radial
from drumlin.fem.substructure.ring import closed_mesh, couple_ring


def towards(fine: float, growth: float, end: float) -> Floats:
    """Points from 0 to end whose steps start at `fine` and grow by the factor `growth`."""
    steps = [fine]
    while sum(steps) < end:
        steps.append(steps[-1] * growth)
    x = np.concatenate([[0.0], np.cumsum(steps)])
    return np.asarray(x / x[-1] * end)


def both_sides(fine_half: float, count: int, growth: float, end: float) -> Floats:
    """Angles from -end to end: `count` even steps within +-fine_half, growing ones outside."""
    inner = np.linspace(-fine_half, fine_half, count + 1)
    outer = fine_half + towards(inner[1] - inner[0], growth, end - fine_half)[1:]
    return np.concatenate([-outer[::-1], inner, outer])


def sector(angles: Floats, depths: Floats, radius: float, sign: int) -> Any:
    """Mesh of a sector from `radius` to radius + sign depth; contact at depth 0, held at the far
    side.
    """
    grid = skfem.MeshQuad.init_tensor(depths, angles)
    middle = grid.p[:, grid.facets].mean(axis=1)
    mesh = skfem.MeshQuad2.from_mesh(grid)
    depth, phi = mesh.doflocs
    r = radius + sign * depth
    return skfem.MeshQuad2(
        np.array([r * np.cos(phi), r * np.sin(phi)]),
        mesh.t,
        _subdomains={"body": np.arange(mesh.nelements)},
        _boundaries={
            "contact": np.flatnonzero(middle[0] < 1e-12 * radius),
            "support": np.flatnonzero(middle[0] > depths[-1] - 1e-9 * radius),
        },
    )


def closed(angles: Floats, depths: Floats, radius: float, sign: int) -> Any:
    """Mesh of a closed ring."""
    return closed_mesh(angles, depths, radius, sign, "body")


@dataclass(frozen=True)
class ContactBody:
    """A body with its contact line, condensed."""

    basis: Any
    line: ContactLine
    condensed: CondensedBody


def body(mesh: Any, material: Material, width: float = 1.0, middle: float = 0.0) -> ContactBody:
    """A condensed body, held at its support."""
    basis = scalar_basis(mesh)
    line = contact_line(basis, mesh.boundaries["contact"], middle)
    ties = constrain(
        basis, line.nodes, basis.get_dofs(mesh.boundaries["support"]).flatten(), np.zeros(2)
    )
    K = stiffness(basis, {"body": ElasticLayer.of(material, width)})
    return ContactBody(basis, line, condense(K, ties, {}, 2 * len(line.nodes)))


@dataclass(frozen=True)
class BodyPair:
    """Flexibilities of both bodies together: P under -N^T (normal), T under T^T (tangential)."""

    inner: ContactBody
    coupling: Coupling
    pressed: Floats
    dragged: Floats
    motions: Floats

    @classmethod
    def of(
        cls, inner: ContactBody, outer: ContactBody | None, sign: int = 1, motions: str = ""
    ) -> "BodyPair":
        """An `inner` body against an outer one, or against a rigid drum; `motions` of the inner
        holder: "x", "xy".
        """
        coupling = couple(inner.line, 1.0, radial(sign))
        halves = [_half(inner, -coupling.N), _half(inner, coupling.T)]
        if outer is not None:
            N, T = couple_ring(inner.line, outer.line, 1.0, sign)
            halves = [
                np.vstack(both)
                for both in zip(halves, [_half(outer, -N), _half(outer, T)], strict=True)
            ]
        x = inner.line.xy[0]
        moves = {
            "x": np.column_stack([np.ones_like(x), 0 * x]),
            "y": np.column_stack([0 * x, np.ones_like(x)]),
        }
        return cls(
            inner,
            coupling,
            halves[0],
            halves[1],
            np.array([moves[m].ravel() for m in motions]).reshape(-1, 2 * len(x)).T,
        )

    def normal(self, gap: Floats, loads: Sequence[float] = ()) -> Problem:
        """Frictionless problem; `loads`: force on the inner body's holder along each motion."""
        B = -self.coupling.N @ self.motions
        return Problem(
            self.pressed.T @ self.pressed,
            self.coupling.M @ gap,
            B,
            B.T.copy(),
            -np.asarray(loads, float),
        )

    def frictional(
        self, gap: Floats, loads: Sequence[float], penalty_compliance: float = 0.0
    ) -> stick_slip.Problem:
        """Stick-slip problem; slip is that of the outer body against the inner one, along e_phi."""
        n, B_s = len(gap), -self.coupling.T @ self.motions
        flat = self.normal(gap, loads)
        return stick_slip.Problem(
            A_wp=flat.A,
            A_wt=self.pressed.T @ self.dragged,
            A_sp=-self.dragged.T @ self.pressed,
            A_st=-self.dragged.T @ self.dragged,
            B_w=flat.B,
            B_s=B_s,
            C_p=flat.C,
            C_t=-B_s.T,
            q_w=flat.q,
            q_s=np.zeros(n),
            h=flat.h,
            Q=penalty_compliance * self.coupling.M,
        )

    @property
    def angle(self) -> Floats:
        """Angles (n,) [rad] of the contact nodes."""
        return self.inner.line.phi


def nested_start(problem: Problem, share: int = 6) -> Bools:
    """A starting contact set from the same problem with every `share`-th node, p linear between
    them.
    """
    n = len(problem.q)
    kept = np.unique(np.round(np.linspace(0, n - 1, max(3, n // share))).astype(int))
    P = np.array([np.interp(np.arange(n), kept, row) for row in np.eye(len(kept))]).T
    coarse = Problem(
        P.T @ problem.A @ P, P.T @ problem.q, P.T @ problem.B, problem.C @ P, problem.h
    )
    start = nested_start(coarse) if len(kept) > 40 else None
    return np.asarray(P @ active_set.solve(coarse, start).p > 0)


def _half(one: ContactBody, forces: Floats) -> Floats:
    return one.condensed.half(forces.T)


LADDER_STEEL = Material(E=210e9, nu=0.3)
