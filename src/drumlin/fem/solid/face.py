"""The lining's friction surface: the contact line of the section times the width.

Pressure and displacement are products of the line's shape functions and those over the width,
zeta_k(z). So every matrix of the weak coupling is that of a line of width 1 times
m_kl = 2 Int zeta_k zeta_l dz  over half the width. The weights of the quadratic functions are all
positive; those of serendipity elements are not.
"""

from dataclasses import dataclass

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.fem.substructure.interface import (
    ContactLine,
    Coupling,
    Directions,
    edge_quadrature_points,
)
from drumlin.fem.substructure.interface import weak_coupling_of_contact_line as couple_line
from drumlin.response.response import PressureOverWidth


@dataclass(frozen=True)
class ContactFace(ContactLine):
    """The friction surface of a solid lining: a contact line, repeated at m distances z.

    z is the distance from the mid-plane of the shoe.

    The contact nodes stand by growing angle, and at each angle from the mid-plane outwards.

    Attributes
    ----------
    nodes : (n m,) numbers of the contact nodes
    xy : (2, n m) places of the contact nodes in the section [m]
    phi : (n m,) angles of the contact nodes [rad]
    pieces : the nodes of each element edge on `line`
    line : the contact line of the section, with n nodes
    z : (m,) distances of the nodes from the mid-plane [m]
    """

    line: ContactLine
    z: Floats

    @property
    def width(self) -> Floats:
        """The widths 2 Int zeta_k dz (m,) [m] of the levels; their sum is the whole width."""
        return integrals_of_products_of_width_functions(self.z).sum(axis=1)

    @property
    def node_distances_from_mid_plane(self) -> Floats:
        """Distances (m,) [m] of the levels from the mid-plane."""
        return self.z

    @property
    def width_shares_of_nodes_across_width(self) -> Floats:
        """The share (m,) of the whole width that each level stands for."""
        return np.asarray(self.width / self.width.sum())

    def couple_lining_with_drum_or_plane(self, width: float, directions: Directions) -> Coupling:
        """The coupling with a counterface; its width is that of the face, not `width`."""
        line, m = (
            couple_line(self.line, 1.0, directions),
            integrals_of_products_of_width_functions(self.z),
        )
        n = len(self.line.nodes)

        def matrix_over_width_from_line_vectors(vectors: Floats) -> Floats:
            """Matrix (n m, 2 n m) of the face from that of the line (n, 2n)."""
            whole = np.einsum("ijc,kl->ikjlc", vectors.reshape(n, n, 2), m)
            return np.ascontiguousarray(whole).reshape(n * len(m), -1)

        M = np.asarray(np.kron(line.M, m), dtype=float)
        lever = np.asarray(np.kron(line.lever, m.sum(axis=1)), dtype=float)
        return Coupling(
            M,
            matrix_over_width_from_line_vectors(line.N),
            matrix_over_width_from_line_vectors(line.T),
            lever,
        )

    def angles_and_mean_pressures(self, p: Floats) -> tuple[Floats, Floats]:
        """Angles (n,) [rad] and mean pressure over the width (n,) [Pa]."""
        return self.line.phi, p.reshape(-1, len(self.z)) @ self.width / self.width.sum()

    def pressure_over_arc_and_width(self, p: Floats) -> PressureOverWidth:
        """The pressure over arc and whole width."""
        half = p.reshape(-1, len(self.z))
        z = np.concatenate([-self.z[:0:-1], self.z])
        widths = 0.5 * np.concatenate([self.width[:0:-1], self.width])
        # The level of the mid-plane stands for a strip on both sides of it.
        widths[len(self.z) - 1] *= 2.0
        return PressureOverWidth(z, np.hstack([half[:, :0:-1], half]), widths)


def integrals_of_products_of_width_functions(z: Floats) -> Floats:
    """The matrix 2 Int zeta_k zeta_l dz (m, m) [m] of quadratic functions over levels z (m,)."""
    pieces = np.arange(3)[:, None] + np.arange(0, len(z) - 2, 2)
    psi, _, dz = edge_quadrature_points(np.array([z, np.zeros_like(z)])[:, pieces])
    matrix = np.zeros((len(z), len(z)))
    np.add.at(matrix, (pieces[:, None], pieces[None]), 2 * np.einsum("aq,bq,iq->abi", psi, psi, dz))
    return matrix


def contact_surface_over_shoe_width(line: ContactLine, node: Ints, z: Floats) -> ContactFace:
    """The friction surface over the contact line of a section.

    Parameters
    ----------
    line : contact line of the section
    node : (nodes, m) nodes of the solid above each node of the section
    z : (m,) levels of the nodes over half the width [m]
    """
    return ContactFace(
        nodes=node[line.nodes, : len(z)].ravel(),
        xy=np.repeat(line.xy, len(z), axis=1),
        phi=np.repeat(line.phi, len(z)),
        pieces=line.pieces,
        edge=line.edge,
        line=line,
        z=z,
    )
