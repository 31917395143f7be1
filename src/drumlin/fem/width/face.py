"""The friction surface of a lining with a width: nodes on its arc times nodes across the width.

The nodes on the arc are the nodes of the section's contact line. Pressure and displacement are
products of the line's shape functions and piecewise polynomials of z, the distance from the
mid-plane. So every coupling matrix of the face is a Kronecker product: the matrix of a contact line
of width 1, times the matrix m_kl = Int zeta_k zeta_l dz over the width. The piecewise polynomial
zeta_k is 1 at the node k across the width and 0 at the other nodes.

The face of a column that is expected to stay open has only the nodes at the ends of the column.
Between these pressure and displacement are linear along the arc. As long as the open columns and
their neighbours stay open, both are the same as with all nodes (`open_columns`).
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.fem.substructure.interface import (
    ContactCouplingMatrices,
    ContactLine,
    NormalsAndTangentsFunction,
    coupling_matrices_of_contact_line,
)
from drumlin.fem.width.functions import (
    FunctionsAcrossWidth,
    integrals_of_function_products_over_width,
    matrix_from_node_values_to_function_factors,
)
from drumlin.response.response import PressureOverArcAndWidth

WRITTEN_PRESSURE_INTERVALS_PER_WIDTH_PIECE = 10
"""Number of equal intervals of z, in each piece of the half width, for written pressures.

A file has the pressure on the contact face at the ends of these intervals. The number is even,
since readers draw a parabola over every two intervals. It is not smaller than the largest degree
across the width, so that the written values determine the polynomial.
"""


class CouplingMatrixAsKroneckerProduct(NamedTuple):
    """A coupling matrix (n m, 2 n m) of a face, kept as its two factors.

    Attributes
    ----------
    line : (n, 2n) coupling matrix of the section's contact line, for the width 1
    across : (m, m) mass matrix [m] of the nodes across the width
    """

    line: Floats
    across: Floats

    def __matmul__(self, X: Floats, /) -> Floats:
        """The product (n m, k) of the matrix with a matrix X (2 n m, k).

        A product takes m times fewer multiplications than with the matrix itself.
        """
        count, m = len(self.line), len(self.across)
        # The rows of X are sorted by node of the line, node across the width, and component.
        by_width = X.reshape(count, m, 2, -1).swapaxes(1, 2).reshape(2 * count, -1)
        by_line = (self.line @ by_width).reshape(count, m, -1)
        return np.asarray((self.across @ by_line).reshape(count * m, -1))


class CouplingMatricesOfFaceWithWidth(ContactCouplingMatrices):
    """The coupling matrices of a face with a width, of which only the factors are kept.

    The dense matrices N and T are computed at each access. They would take more memory than all
    other matrices of the shoe together, and a solve needs them only a few times. The mass matrix M
    is computed at the first access, when the matrices of the condensation are no longer needed.

    Attributes
    ----------
    line : coupling matrices of the section's contact line, for the width 1
    mass_across_width : mass matrix (m, m) [m] of the nodes across the width
    """

    line: ContactCouplingMatrices
    mass_across_width: Floats

    def __init__(self, line: ContactCouplingMatrices, mass_across_width: Floats) -> None:
        own = {
            "line": line,
            "mass_across_width": mass_across_width,
            "lever": np.asarray(np.kron(line.lever, mass_across_width.sum(axis=1)), dtype=float),
        }
        for name, value in own.items():
            object.__setattr__(self, name, value)

    @cached_property
    def M(self) -> Floats:
        """The mass matrix (n m, n m) [m^2] of the face's nodes."""
        return np.asarray(np.kron(self.line.M, self.mass_across_width), dtype=float)

    @property
    def N(self) -> Floats:
        """The normal coupling (n m, 2 n m) [m^2] of the face's nodes."""
        return self._coupling_matrix_of_face_from_matrix_of_line(self.line.N)

    def write_normal_coupling(self, out: Floats) -> None:
        """Write the matrix N into a contiguous array (n m, 2 n m) of the caller.

        No second matrix of this size exists at any time.
        """
        assert out.flags.c_contiguous
        self._coupling_matrix_of_face_from_matrix_of_line(self.line.N, out)

    @property
    def T(self) -> Floats:
        """The tangential coupling (n m, 2 n m) [m^2] of the face's nodes."""
        return self._coupling_matrix_of_face_from_matrix_of_line(self.line.T)

    @property
    def tangential_coupling_for_products(self) -> "CouplingMatrixAsKroneckerProduct":
        """The tangential coupling (n m, 2 n m) of the face, whose products take little time."""
        return CouplingMatrixAsKroneckerProduct(self.line.T, self.mass_across_width)

    def _coupling_matrix_of_face_from_matrix_of_line(
        self, vectors: Floats, out: Floats | None = None
    ) -> Floats:
        """The coupling matrix (n m, 2 n m) of the face, from the matrix (n, 2n) of the line.

        It is written into `out` if this array is given.
        """
        n, m = len(vectors), self.mass_across_width
        found = np.empty((n * len(m), 2 * n * len(m))) if out is None else out
        by_node = found.reshape(n, len(m), n, len(m), 2)
        np.multiply(vectors.reshape(n, 1, n, 1, 2), m[:, None, :, None], out=by_node)
        return found


@dataclass(frozen=True)
class ContactFaceWithWidth(ContactLine):
    """The friction surface of a lining with a width, also called its contact face.

    The face has k m nodes: k of the n nodes of the section's contact line, times m nodes over half
    the width. The nodes are sorted by angle, and at each angle by distance from the mid-plane.
    Without open columns k = n.

    Attributes
    ----------
    nodes : (k m,) indices of the nodes
    xy : (2, k m) coordinates of the nodes in the section [m]
    phi : (k m,) angles of the nodes [rad]
    pieces : nodes of each edge of `line`, as indices into the nodes of `line`
    line : the contact line of the section
    functions : functions across the width
    half : half the width of the lining [m]
    kept : (k,) indices of the line's nodes that the face has: all nodes, except those between the
        ends of an open column
    """

    line: ContactLine
    functions: FunctionsAcrossWidth
    half: float
    kept: Ints

    @cached_property
    def node_distances_from_mid_plane(self) -> Floats:
        """Distances (m,) [m] of the nodes across the width from the mid-plane."""
        return self.functions.node_distances_across_half_width_of_part(self.half)

    @cached_property
    def mass_matrix_across_width(self) -> Floats:
        """The mass matrix Int zeta_k zeta_l dz (m, m) [m] over the whole width.

        zeta_k is the polynomial of z that is 1 at the node k across the width.
        """
        to_functions = matrix_from_node_values_to_function_factors(self.functions, self.half)
        even = integrals_of_function_products_over_width(self.functions, self.half).even
        return np.asarray(to_functions.T @ even @ to_functions)

    @property
    def tributary_widths_of_nodes_across_width(self) -> Floats:
        """The width Int zeta_k dz (m,) [m] that each node across the width stands for.

        The sum of all is the whole width.
        """
        return self.mass_matrix_across_width.sum(axis=1)

    @property
    def width_fraction_of_each_node_across_width(self) -> Floats:
        """The fraction (m,) of the whole width that each node across the width stands for."""
        widths = self.tributary_widths_of_nodes_across_width
        return np.asarray(widths / widths.sum())

    def coupling_matrices_with_drum_or_plane(
        self, width: float, directions: NormalsAndTangentsFunction
    ) -> ContactCouplingMatrices:
        """The matrices that couple the face with the drum or the plane (mortar method).

        The argument `width` has no effect: the face has its own width. `directions` gives the unit
        normals and tangents of the drum or the plane.
        """
        is_open, pieces = self._which_pieces_of_line_are_open, self.line.pieces
        closed = self._line_of_kept_nodes_with_pieces(pieces[:, ~is_open])
        line = coupling_matrices_of_contact_line(closed, 1.0, directions)
        if is_open.any():
            linear = self._line_of_kept_nodes_with_pieces(pieces[[0, -1]][:, is_open])
            other = coupling_matrices_of_contact_line(linear, 1.0, directions)
            line = ContactCouplingMatrices(
                line.M + other.M, line.N + other.N, line.T + other.T, line.lever + other.lever
            )
        return CouplingMatricesOfFaceWithWidth(line, self.mass_matrix_across_width)

    @property
    def _which_pieces_of_line_are_open(self) -> Bools:
        """A mask (pieces,), True for the pieces of which the face has only the nodes at both ends.

        Each of them belongs to an open column.
        """
        return np.asarray(~np.isin(self.line.pieces, self.kept).all(axis=0))

    def _line_of_kept_nodes_with_pieces(self, pieces: Ints) -> ContactLine:
        """The face's nodes along the arc, with pieces given by indices of nodes of `line`."""
        return replace(
            self.line,
            nodes=np.arange(len(self.kept)),
            xy=self.line.xy[:, self.kept],
            phi=self.line.phi[self.kept],
            pieces=np.searchsorted(self.kept, pieces),
        )

    def _values_at_all_nodes_of_line(self, values: Floats) -> Floats:
        """Values (n, m) at all nodes of the line, from values (k, m) at the face's nodes.

        Within open columns they are linear along the arc.
        """
        if len(self.kept) == len(self.line.nodes):
            return values
        phi = self.line.phi
        return np.array([np.interp(phi, phi[self.kept], own) for own in values.T]).T

    def angles_and_pressures_averaged_over_width(self, p: Floats) -> tuple[Floats, Floats]:
        """Angles (n,) [rad] of the line's nodes, and their pressure (n,) [Pa], averaged over z."""
        by_node = p.reshape(-1, len(self.node_distances_from_mid_plane))
        mean = by_node @ self.width_fraction_of_each_node_across_width
        return self.line.phi, self._values_at_all_nodes_of_line(mean[:, None])[:, 0]

    @cached_property
    def _mid_plane_distances_of_written_pressures(self) -> Floats:
        """The distances (k,) [m] from the mid-plane at which pressures are written to a file."""
        ends = np.array(self.functions.breaks)
        ends = ends[: self.functions.number_of_width_pieces_in_part(self.half) + 1]
        if len(ends) == 1:
            ends = np.array([0.0, self.half])
        steps = (
            np.arange(WRITTEN_PRESSURE_INTERVALS_PER_WIDTH_PIECE)
            / WRITTEN_PRESSURE_INTERVALS_PER_WIDTH_PIECE
        )
        return np.append((ends[:-1, None] + np.diff(ends)[:, None] * steps).ravel(), ends[-1])

    @cached_property
    def _half_width_integration_weights_of_written_pressures(self) -> Floats:
        """The weights (k,) [m] by which pressures are integrated over half the width.

        The pressures are those at the distances `_mid_plane_distances_of_written_pressures`.
        """
        values = self._values_of_node_polynomials(self._mid_plane_distances_of_written_pressures)
        half_widths = 0.5 * self.tributary_widths_of_nodes_across_width
        return np.asarray(np.linalg.lstsq(values, half_widths)[0], dtype=float)

    def _values_of_node_polynomials(self, z: Floats) -> Floats:
        """Values (m, k) of the m polynomials zeta at k distances z (k,) [m] from the mid-plane.

        Each polynomial is 1 at one of the m nodes across the width and 0 at the other nodes.
        """
        own = self.functions.even_functions_across_width[
            : self.functions.counts_of_even_and_odd_functions_on_part(self.half)[0]
        ]
        values, _ = self.functions.function_values_and_slopes(own, z)
        to_functions = matrix_from_node_values_to_function_factors(self.functions, self.half)
        return np.asarray(to_functions.T @ values)

    def pressure_at_distances_from_mid_plane(self, p: Floats, z: Floats) -> Floats:
        """The pressure (n, j) [Pa] at the n angles of the line's nodes and at j distances z [m].

        `p` (k m,) [Pa] are the pressures at the nodes of the face, at k angles and m distances from
        the mid-plane. `z` (j,) are distances from the mid-plane, too.
        """
        by_node = p.reshape(-1, len(self.node_distances_from_mid_plane))
        return self._values_at_all_nodes_of_line(by_node @ self._values_of_node_polynomials(z))

    def pressure_distribution_over_arc_and_width(self, p: Floats) -> PressureOverArcAndWidth:
        """The pressure over the arc and the whole width of the lining, as a file has it.

        The distances z from the mid-plane divide each piece of the half width into
        WRITTEN_PRESSURE_INTERVALS_PER_WIDTH_PIECE equal intervals. The ends of the pieces are the
        breaks of `functions`.
        """
        z = self._mid_plane_distances_of_written_pressures
        half = self.pressure_at_distances_from_mid_plane(p, z)
        # The pressure is symmetric about the mid-plane.
        both, own = (
            np.concatenate([-z[:0:-1], z]),
            self._half_width_integration_weights_of_written_pressures,
        )
        widths = np.concatenate([own[:0:-1], [2 * own[0]], own[1:]])
        return PressureOverArcAndWidth(both, np.hstack([half[:, :0:-1], half]), widths)

    def nodal_pressures_from_pressures_of_file(self, surface: PressureOverArcAndWidth) -> Floats:
        """The pressures (k m,) [Pa] at the nodes of the face, from pressures that a file has.

        The rows of `surface` are sorted by angle, as the nodes of `line` are.
        """
        half = surface.pressure[self.kept, len(surface.z) // 2 :]
        values = self._values_of_node_polynomials(self._mid_plane_distances_of_written_pressures)
        return np.asarray(np.linalg.lstsq(values.T, half.T)[0].T.ravel(), dtype=float)
