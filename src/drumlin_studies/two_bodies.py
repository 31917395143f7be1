"""Two elastic bodies in contact, made from drumlin's parts without a brake.

The pressure has its unknowns at the nodes of the inner body, as at those of a lining. The outer
body is coupled on the common refinement of both grids of angles. Each body is held at its far side.
The holder of the inner body may move.
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
from drumlin.contact.equations import ContactProblem
from drumlin.fem.substructure.body import (
    CondensedBody,
    body_constraints,
    condense_body,
    scalar_basis,
    stiffness,
)
from drumlin.fem.substructure.interface import (
    ContactLine,
    Coupling,
    couple_with_counterface,
    drum_directions,
    make_contact_line,
)
from drumlin.fem.substructure.ring import quadratic_ring_mesh, ring_coupling_matrices


def growing_steps_to(fine: float, growth: float, end: float) -> Floats:
    """Points from 0 to `end`, whose steps begin with about `fine` and grow by a factor."""
    steps = [fine]
    while sum(steps) < end:
        steps.append(steps[-1] * growth)
    x = np.concatenate([[0.0], np.cumsum(steps)])
    return np.asarray(x / x[-1] * end)


def symmetric_angles(fine_half: float, count: int, growth: float, end: float) -> Floats:
    """Angles from -end to end: `count` even steps within +-fine_half, growing steps outside."""
    inner = np.linspace(-fine_half, fine_half, count + 1)
    outer = fine_half + growing_steps_to(inner[1] - inner[0], growth, end - fine_half)[1:]
    return np.concatenate([-outer[::-1], inner, outer])


def sector_mesh(angles: Floats, depths: Floats, radius: float, sign: int) -> Any:
    """Mesh of a sector of a ring, in contact at depth 0 and held at the greatest depth.

    Parameters
    ----------
    angles : array
        Angles of the element corners [rad].
    depths : array
        Depths of the element corners [m], from 0 on.
    radius : float
        Radius of the contact [m].
    sign : int
        1 where the body lies outside the contact, -1 inside.
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


def closed_ring_mesh(angles: Floats, depths: Floats, radius: float, sign: int) -> Any:
    """Mesh of a closed ring; parameters as of `sector_mesh`."""
    return quadratic_ring_mesh(angles, depths, radius, sign, "body")


@dataclass(frozen=True)
class ContactBody:
    """A body after static condensation to the nodes of its contact line."""

    basis: Any
    line: ContactLine
    condensed: CondensedBody


def condense_contact_body(
    mesh: Any, material: Material, width: float = 1.0, middle: float = 0.0
) -> ContactBody:
    """The condensed body of a mesh, held at its support.

    Parameters
    ----------
    mesh : skfem mesh
        With the boundaries "contact" and "support".
    material : Material
        Isotropic material.
    width : float
        Width of the body [m].
    middle : float
        Angle in the middle of the contact [rad].
    """
    basis = scalar_basis(mesh)
    line = make_contact_line(basis, mesh.boundaries["contact"], middle)
    ties = body_constraints(
        basis, line.nodes, basis.get_dofs(mesh.boundaries["support"]).flatten(), np.zeros(2)
    )
    K = stiffness(basis, {"body": ElasticLayer.of(material, width)})
    return ContactBody(basis, line, condense_body(K, ties, {}, 2 * len(line.nodes)))


@dataclass(frozen=True)
class BodyPair:
    """An inner body against an outer body or a rigid drum.

    Attributes
    ----------
    inner : ContactBody
        The body whose nodes carry the pressure.
    coupling : Coupling
        From displacements of the inner nodes to gaps and slips at the contact.
    pressed, dragged : array (m, n)
        Square roots of the flexibility of both bodies: their responses to unit pressures and to
        unit tractions at the n nodes. Products such as pressed.T @ dragged are flexibilities.
    motions : array (2 n, motions)
        Displacements of the contact nodes as the holder of the inner body moves.
    """

    inner: ContactBody
    coupling: Coupling
    pressed: Floats
    dragged: Floats
    motions: Floats

    @classmethod
    def of(
        cls, inner: ContactBody, outer: ContactBody | None, sign: int = 1, motions: str = ""
    ) -> "BodyPair":
        """The pair of an inner and an outer body.

        Parameters
        ----------
        inner : ContactBody
            The body whose nodes carry the pressure.
        outer : ContactBody or None
            The other body; None for a rigid drum.
        sign : int
            1 where the outer body lies outside the contact, -1 inside.
        motions : str
            Directions in which the holder of the inner body moves: "", "x", "y" or "xy".
        """
        coupling = couple_with_counterface(inner.line, 1.0, drum_directions(sign))
        halves = [
            _flexibility_root_times(inner, -coupling.N),
            _flexibility_root_times(inner, coupling.T),
        ]
        if outer is not None:
            N, T = ring_coupling_matrices(inner.line, outer.line, 1.0, sign)
            # The flexibilities of both bodies add up: their square roots are stacked.
            pressed, dragged = halves
            halves = [
                np.vstack([pressed, _flexibility_root_times(outer, -N)]),
                np.vstack([dragged, _flexibility_root_times(outer, T)]),
            ]
        # Displacements of the contact nodes as the holder moves by 1 m.
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

    def normal(self, gap: Floats, loads: Sequence[float] = ()) -> ContactProblem:
        """The frictionless contact problem.

        Parameters
        ----------
        gap : array (n,)
            Gap between the undeformed bodies [m].
        loads : sequence of float
            Force on the holder of the inner body along each motion [N].
        """
        B = -self.coupling.N @ self.motions
        return ContactProblem(
            self.pressed.T @ self.pressed,
            self.coupling.M @ gap,
            B,
            B.T.copy(),
            -np.asarray(loads, float),
        )

    def frictional(
        self, gap: Floats, loads: Sequence[float], penalty_compliance: float = 0.0
    ) -> stick_slip.FrictionalProblem:
        """The contact problem with friction.

        The slip is that of the outer body against the inner body, along growing angles.

        Parameters
        ----------
        gap : array (n,)
            Gap between the undeformed bodies [m].
        loads : sequence of float
            Force on the holder of the inner body along each motion [N].
        penalty_compliance : float
            Closure of the gap per pressure [m/Pa].
        """
        n, B_s = len(gap), -self.coupling.T @ self.motions
        flat = self.normal(gap, loads)
        return stick_slip.FrictionalProblem(
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
        """Angles of the contact nodes (n,) [rad]."""
        return self.inner.line.phi


def coarse_contact_set(problem: ContactProblem, share: int = 6) -> Bools:
    """A contact set to start from: the set of the same problem on fewer nodes.

    The coarse problem keeps every `share`-th node, with p linear between the nodes. It starts in
    the same way itself.
    """
    n = len(problem.q)
    kept = np.unique(np.round(np.linspace(0, n - 1, max(3, n // share))).astype(int))
    P = np.array([np.interp(np.arange(n), kept, row) for row in np.eye(len(kept))]).T
    coarse = ContactProblem(
        P.T @ problem.A @ P, P.T @ problem.q, P.T @ problem.B, problem.C @ P, problem.h
    )
    start = coarse_contact_set(coarse) if len(kept) > 40 else None
    return np.asarray(P @ active_set.solve_contact_problem(coarse, start).p > 0)


def _flexibility_root_times(one: ContactBody, forces: Floats) -> Floats:
    """Square root of the flexibility of a body times nodal forces (n, 2 nodes)."""
    return one.condensed.half_flexibility(forces.T)


LADDER_STEEL = Material(E=210e9, nu=0.3)
