"""The friction surface of a lining with a width: its contact line times nodes across the width.

Pressure and displacement are products of the line's shape functions and polynomials of z between
the breaks of the width. So every matrix of the weak coupling is that of a line of width 1 times
m_kl = Int zeta_k zeta_l dz  over the width. The polynomial zeta_k is 1 at the node k across the
width and 0 at the other nodes.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.fem.substructure.interface import (
    ContactLine,
    Coupling,
    Directions,
    weak_coupling_of_contact_line,
)
from drumlin.fem.width.functions import (
    WidthFunctions,
    integrals_over_width_of_part,
    matrix_from_node_values_to_function_factors,
)
from drumlin.response.response import PressureOverWidth

FACE_STEPS = 8
"""Number of even steps of z in each piece at which the pressure on the contact face is written.

Parabolas over two steps then follow polynomials of degree 6 with an error of 1e-3 of their size.
"""


@dataclass(frozen=True)
class WidthFace(ContactLine):
    """The friction surface of a lining with a width, its contact face.

    It has the n nodes of the section's contact line times m nodes over half the width. Nodes stand
    by growing angle, and at each angle from the mid-plane outwards.

    Attributes
    ----------
    nodes : (n m,) numbers of the nodes
    xy : (2, n m) places of the nodes in the section [m]
    phi : (n m,) angles of the nodes [rad]
    pieces : nodes of each edge of `line`, as positions in the nodes of `line`
    line : the contact line of the section
    functions : functions across the width
    half : half the width of the lining [m]
    """

    line: ContactLine
    functions: WidthFunctions
    half: float

    @cached_property
    def node_distances_from_mid_plane(self) -> Floats:
        """Distances (m,) [m] of the nodes across the width from the mid-plane."""
        return self.functions.node_distances_across_part(self.half)

    @cached_property
    def mass_matrix_across_width(self) -> Floats:
        """The mass matrix Int zeta_k zeta_l dz (m, m) [m] over the whole width.

        zeta_k is the polynomial of z that is 1 at the node k across the width.
        """
        to_functions = matrix_from_node_values_to_function_factors(self.functions, self.half)
        even = integrals_over_width_of_part(self.functions, self.half).even
        return np.asarray(to_functions.T @ even @ to_functions)

    @property
    def tributary_widths_of_nodes_across_width(self) -> Floats:
        """The width Int zeta_k dz (m,) [m] that each node across the width stands for.

        The sum of all is the whole width.
        """
        return self.mass_matrix_across_width.sum(axis=1)

    @property
    def width_shares_of_nodes_across_width(self) -> Floats:
        """The share (m,) of the whole width that each node across the width stands for."""
        widths = self.tributary_widths_of_nodes_across_width
        return np.asarray(widths / widths.sum())

    def couple_lining_with_drum_or_plane(self, width: float, directions: Directions) -> Coupling:
        """The coupling of the face with the drum or the plane.

        The width is that of the face, and the argument `width` has no effect.
        """
        line, m = (
            weak_coupling_of_contact_line(self.line, 1.0, directions),
            self.mass_matrix_across_width,
        )
        n, count = len(self.line.nodes), len(self.node_distances_from_mid_plane)

        def face_matrix_from_line_matrix(vectors: Floats) -> Floats:
            """The coupling matrix (n m, 2 n m) of the face from the matrix of its line (n, 2n)."""
            by_node = vectors.reshape(n, 1, n, 1, 2) * m[:, None, :, None]
            return np.asarray(by_node.reshape(n * count, -1))

        M = np.asarray(np.kron(line.M, m), dtype=float)
        lever = np.asarray(
            np.kron(line.lever, self.tributary_widths_of_nodes_across_width), dtype=float
        )
        return Coupling(
            M, face_matrix_from_line_matrix(line.N), face_matrix_from_line_matrix(line.T), lever
        )

    def angles_and_mean_pressures(self, p: Floats) -> tuple[Floats, Floats]:
        """Angles (n,) [rad] of the line's nodes, and their pressure (n,) [Pa], averaged over z."""
        return (
            self.line.phi,
            p.reshape(-1, len(self.node_distances_from_mid_plane))
            @ self.width_shares_of_nodes_across_width,
        )

    def pressure_over_arc_and_width(self, p: Floats) -> PressureOverWidth:
        """The pressure over arc and whole width of the lining, at even steps of z in each piece.

        z is the distance from the mid-plane, and a piece is a part of the half width between
        breaks.
        """
        ends = np.array(self.functions.breaks)
        ends = ends[: self.functions.number_of_pieces_in_part(self.half) + 1]
        if len(ends) == 1:
            ends = np.array([0.0, self.half])
        steps = np.arange(FACE_STEPS) / FACE_STEPS
        z = np.append((ends[:-1, None] + np.diff(ends)[:, None] * steps).ravel(), ends[-1])
        # The nodal pressures become factors of the even functions, which are evaluated at all z.
        own = self.functions.even_functions_across_width[
            : self.functions.numbers_of_even_and_odd_functions(self.half)[0]
        ]
        values, _ = self.functions.function_values_and_slopes(own, z)
        to_functions = matrix_from_node_values_to_function_factors(self.functions, self.half)
        half = p.reshape(-1, len(self.node_distances_from_mid_plane)) @ to_functions.T @ values
        # The pressure is symmetric about the mid-plane.
        both = np.concatenate([-z[:0:-1], z])
        return PressureOverWidth(both, np.hstack([half[:, :0:-1], half]))
