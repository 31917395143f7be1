"""Two elastic bodies in contact, modelled by drumlin's equations without a brake.

The inner body takes the place of a lining: the unknown pressures belong to its contact nodes. The
outer body takes the place of the drum. The nodes of both contact lines together divide the contact
into intervals, over which the coupling is integrated. Each body is supported at the side away from
the contact. The support of the inner body may move as a rigid body.
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
from drumlin.fem.mesh.degree import nodal_basis_of_mesh
from drumlin.fem.substructure.body import (
    CondensedBody,
    condense_body_to_contact_and_hinge_face,
    multi_point_constraints_of_body,
    sparse_stiffness_of_body,
)
from drumlin.fem.substructure.interface import (
    ContactCouplingMatrices,
    ContactLine,
    coupling_matrices_of_contact_line,
    function_that_returns_drum_normals_and_tangents,
    make_contact_line_of_lining,
)
from drumlin.fem.substructure.ring import (
    coupling_matrices_of_lining_and_ring,
    quadratic_mesh_of_closed_ring,
)


def points_with_steps_growing_to_end(fine: float, growth: float, end: float) -> Floats:
    """Points from 0 to `end`, with steps that begin with about `fine` and grow by `growth` each."""
    steps = [fine]
    while sum(steps) < end:
        steps.append(steps[-1] * growth)
    x = np.concatenate([[0.0], np.cumsum(steps)])
    return np.asarray(x / x[-1] * end)


def angles_graded_from_middle_to_both_ends(
    fine_half: float, count: int, growth: float, end: float
) -> Floats:
    """Angles from -end to end [rad], symmetric about 0.

    Between -fine_half and fine_half there are `count` equal steps. Towards both ends each further
    step is larger than the step before, by the factor `growth`.
    """
    inner = np.linspace(-fine_half, fine_half, count + 1)
    outer = (
        fine_half
        + points_with_steps_growing_to_end(inner[1] - inner[0], growth, end - fine_half)[1:]
    )
    return np.concatenate([-outer[::-1], inner, outer])


def plane_mesh_of_ring_sector(angles: Floats, depths: Floats, radius: float, sign: int) -> Any:
    """The mesh of a ring sector with the boundaries "contact" at depth 0 and "support" opposite.

    Parameters
    ----------
    angles : array
        Angles of the element corners [rad].
    depths : array
        Distances of the element corners from the contact surface [m], from 0 on.
    radius : float
        Radius of the contact surface [m].
    sign : int
        1 if the body lies outside the contact surface, -1 if it lies inside.
    """
    # A rectangular grid in the coordinates depth and angle is mapped to the sector. The depth tells
    # which edges belong to a boundary.
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


def plane_mesh_of_closed_ring(angles: Floats, depths: Floats, radius: float, sign: int) -> Any:
    """The mesh of a closed ring with the boundaries "contact" at depth 0 and "support" opposite."""
    return quadratic_mesh_of_closed_ring(angles, depths, radius, sign, "body")


def scikit_fem_basis_of_mesh(mesh: Any) -> Any:
    """scikit-fem's basis of the scalar shape functions on a mesh.

    The nodes have the same numbers as in drumlin's basis of the same degree. The quadrature has
    order 4, or 2 on linear elements.
    """
    of_mesh = {
        skfem.MeshQuad2: skfem.ElementQuad2,
        skfem.MeshQuad1: skfem.ElementQuad1,
        skfem.MeshTri2: skfem.ElementTriP2,
        skfem.MeshTri1: skfem.ElementTriP1,
    }
    element = of_mesh[type(mesh)]()
    return skfem.Basis(mesh, element, intorder=4 if element.facet_dofs else 2)


@dataclass(frozen=True)
class BodyCondensedToContactNodes:
    """A body after static condensation to the nodes of its contact line.

    Attributes
    ----------
    basis : skfem basis
        Mesh and shape functions of the body.
    line : ContactLine
        Nodes of the contact surface, in the order of their angles.
    condensed : CondensedBody
        Flexibility of the body at these nodes.
    """

    basis: Any
    line: ContactLine
    condensed: CondensedBody


def condense_body_to_contact_nodes(
    mesh: Any, material: Material, width: float = 1.0, middle: float = 0.0
) -> BodyCondensedToContactNodes:
    """The body of a mesh, fixed at its support and condensed to its contact nodes.

    Parameters
    ----------
    mesh : skfem mesh
        Mesh with the boundaries "contact" and "support".
    material : Material
        Isotropic material of the body.
    width : float
        Width of the body [m].
    middle : float
        Angle of the middle of the contact line [rad].
    """
    basis = nodal_basis_of_mesh(mesh)
    line = make_contact_line_of_lining(basis, mesh.boundaries["contact"], middle)
    ties = multi_point_constraints_of_body(
        basis, line.nodes, basis.get_dofs(mesh.boundaries["support"]).flatten(), np.zeros(2)
    )
    K = sparse_stiffness_of_body(
        basis, {"body": ElasticLayer.make_layer_in_plane_stress(material, width)}
    )
    return BodyCondensedToContactNodes(
        basis, line, condense_body_to_contact_and_hinge_face(K, ties, {}, 2 * len(line.nodes))
    )


@dataclass(frozen=True)
class InnerAndOuterBodyInContact:
    """An inner elastic body in contact with an outer elastic body or with a rigid drum.

    Attributes
    ----------
    inner : BodyCondensedToContactNodes
        The body whose n contact nodes have the unknown pressures.
    coupling : ContactCouplingMatrices
        Matrices that turn displacements of the inner body's nodes into gaps and slips at the
        contact.
    pressed, dragged : array (m, n)
        Square roots of the flexibility of both bodies together: `pressed` under unit pressures and
        `dragged` under unit tangential tractions at the n nodes. Products of two square roots, for
        example pressed.T @ dragged, are flexibilities.
    motions : array (2 n, motions)
        Displacements of the n contact nodes for a unit of each rigid motion of the inner body's
        support.
    """

    inner: BodyCondensedToContactNodes
    coupling: ContactCouplingMatrices
    pressed: Floats
    dragged: Floats
    motions: Floats

    @classmethod
    def couple_two_bodies_at_contact_nodes(
        cls,
        inner: BodyCondensedToContactNodes,
        outer: BodyCondensedToContactNodes | None,
        sign: int = 1,
        motions: str = "",
    ) -> "InnerAndOuterBodyInContact":
        """The pair of two condensed bodies, with the coupling between their contact nodes.

        Parameters
        ----------
        inner : BodyCondensedToContactNodes
            The body whose contact nodes have the unknown pressures.
        outer : BodyCondensedToContactNodes or None
            The body in the place of the drum; None for a rigid drum.
        sign : int
            1 where `outer` lies outside the contact surface (a drum around a shoe), -1 where it
            lies inside the contact surface (a drum under an external shoe).
        motions : str
            Directions in which the support of `inner` can move: "", "x", "y" or "xy".
        """
        coupling = coupling_matrices_of_contact_line(
            inner.line, 1.0, function_that_returns_drum_normals_and_tangents(sign)
        )
        halves = [
            _flexibility_root_times_nodal_forces(inner, -coupling.N),
            _flexibility_root_times_nodal_forces(inner, coupling.T),
        ]
        if outer is not None:
            N, T = coupling_matrices_of_lining_and_ring(inner.line, outer.line, 1.0, sign)
            # The flexibility of both bodies is the sum of their flexibilities S^T S. Its square
            # root is a stack of their square roots S.
            pressed, dragged = halves
            halves = [
                np.vstack([pressed, _flexibility_root_times_nodal_forces(outer, -N)]),
                np.vstack([dragged, _flexibility_root_times_nodal_forces(outer, T)]),
            ]
        # Displacements of the contact nodes as the support of the inner body moves by 1 m.
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

    def frictionless_contact_problem(
        self, gap: Floats, loads: Sequence[float] = ()
    ) -> ContactProblem:
        """The contact problem without friction, whose unknowns are the n nodal pressures.

        Parameters
        ----------
        gap : array (n,)
            Gap between the undeformed bodies at the contact nodes [m].
        loads : sequence of float
            Force on the support of the inner body along each of its motions [N].
        """
        B = -self.coupling.N @ self.motions
        return ContactProblem(
            self.pressed.T @ self.pressed,
            self.coupling.M @ gap,
            B,
            B.T.copy(),
            -np.asarray(loads, float),
        )

    def frictional_contact_problem(
        self, gap: Floats, loads: Sequence[float], penalty_compliance: float = 0.0
    ) -> stick_slip.StickSlipProblem:
        """The contact problem with friction, whose unknowns are nodal pressures and tractions.

        The slip is the tangential motion of the outer body relative to the inner body, positive
        towards growing angles.

        Parameters
        ----------
        gap : array (n,)
            Gap between the undeformed bodies at the contact nodes [m].
        loads : sequence of float
            Force on the support of the inner body along each of its motions [N].
        penalty_compliance : float
            Penetration that the penalty allows per pressure [m/Pa]; 0 for exact contact.
        """
        n, B_s = len(gap), -self.coupling.T @ self.motions
        flat = self.frictionless_contact_problem(gap, loads)
        return stick_slip.StickSlipProblem(
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
    def contact_node_angles(self) -> Floats:
        """Angles (n,) of the inner body's contact nodes [rad]."""
        return self.inner.line.phi


def first_contact_set_from_coarse_problem(problem: ContactProblem, share: int = 6) -> Bools:
    """A first contact set (n,) for a contact problem: whether each node touches.

    The set is the contact set of a coarser problem. The coarser problem keeps every `share`-th
    node, with a linear pressure between the kept nodes. If more than 40 nodes are kept, it starts
    from a still coarser problem.
    """
    n = len(problem.q)
    kept = np.unique(np.round(np.linspace(0, n - 1, max(3, n // share))).astype(int))
    # The matrix P interpolates pressures linearly from the kept nodes to all nodes.
    P = np.array([np.interp(np.arange(n), kept, row) for row in np.eye(len(kept))]).T
    coarse = ContactProblem(
        P.T @ problem.A @ P, P.T @ problem.q, P.T @ problem.B, problem.C @ P, problem.h
    )
    start = first_contact_set_from_coarse_problem(coarse) if len(kept) > 40 else None
    return np.asarray(P @ active_set.solve_contact_problem(coarse, start).p > 0)


def _flexibility_root_times_nodal_forces(
    one: BodyCondensedToContactNodes, forces: Floats
) -> Floats:
    """The square root of a body's flexibility, multiplied by n sets of nodal forces.

    forces : array (n, 2 nodes) [N], in each row a force on each contact node, x and y in turn.
    """
    return one.condensed.half_flexibility_under_nodal_forces(forces.T)


STEEL_OF_KNOWN_ANSWER_CASES = Material(E=210e9, nu=0.3)
"""The steel of the elastic bodies in the benchmark cases with known results (`ladder`)."""
