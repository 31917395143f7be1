"""The displacements of all nodes of a shoe with a width, recovered from the forces on the shoe.

Condensation has eliminated all displacements except the displacements of the contact. If a picture
or a file needs the others, the columns of elements are condensed once more, to the nodes on their
two sides: a left and a right line of nodes. Here the nodes of the contact are eliminated as well.
The lines are eliminated one after another from the hinge to the far end of the shoe. From the far
end back to the hinge, the displacements of the lines are computed. The displacements between the
lines follow. All displacements are in the axes of the shoe's frame.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.base.lapack import dpotrf, dtrsm
from drumlin.brake.brake import Shoe
from drumlin.fem.hp.body import element_grid_of_whole_shoe
from drumlin.fem.hp.division import ShoeElementDivision
from drumlin.fem.hp.element import reference_element_of_degree
from drumlin.fem.hp.grid import HpElementGrid
from drumlin.fem.substructure.body import rigid_body_displacements_of_nodes
from drumlin.fem.substructure.elimination import SINGULAR_BODY_MESSAGE
from drumlin.fem.width.columns import (
    AssembledStiffnessOfColumns,
    ColumnCondensationPlan,
    ColumnDisplacementUnknown,
    ConditionAtEdgeFarthestFromContact,
    column_stiffnesses_without_inner_element_unknowns,
    condensation_plan_of_column,
    displacements_inside_elements,
    indices_of_unknowns_along_node_row,
    unknowns_of_element_column_by_role_in_condensation,
)
from drumlin.fem.width.functions import (
    FunctionsAcrossWidth,
    matrix_from_node_values_to_function_factors,
)
from drumlin.fem.width.integrals import (
    ElementIntegralsOverShoeSection,
    cross_section_integrals_of_any_shape,
)
from drumlin.fem.width.shoe import ElementLayersWithWidthFunctions, layers_with_width_functions


class _CholeskyFactorOfNodeLine(NamedTuple):
    """The part of the Cholesky factor that belongs to a line of nodes between two element columns.

    Attributes
    ----------
    own : (n,) indices of the line's unknowns among the unknowns of the shoe
    later : (k,) indices of the unknowns of the next line
    L : (n, n) lower Cholesky factor of the line's stiffness
    rows_of_later_unknowns : (k, n) rows of the factor for the unknowns of the next line
    forces : (n, m) L^-1 f with the forces f on the line in m load cases
    """

    own: Ints
    later: Ints
    L: Floats
    rows_of_later_unknowns: Floats
    forces: Floats


class _ElementColumnWithNumbersOfUnknowns(NamedTuple):
    """A column of elements: its nodes, and the indices of its unknowns.

    The index of an unknown is its position among all unknowns of the shoe.

    Attributes
    ----------
    nodes : (rows, p + 1) indices of the nodes in the section
    first : index of the column's first layer of elements, counted from the contact
    plan : the plan that condenses the column to the nodes on its two sides
    kept, rest : (k,), (r,) indices of the unknowns on the two sides, and on the other edges of
        elements
    boundary, within : for each layer, the indices of the unknowns on the boundary of its element
        and inside the element
    """

    nodes: Ints
    first: int
    plan: ColumnCondensationPlan
    kept: Ints
    rest: Ints
    boundary: tuple[Ints, ...]
    within: tuple[Ints, ...]


@dataclass(frozen=True)
class EliminatedUnknownsOfShoeWithWidth:
    """The displacements that the condensation of a three-dimensional shoe has eliminated.

    The class fulfils the protocol `substructure.body.EliminatedUnknownsOfAnyBody`. Each node of the
    section has several unknowns. An unknown is the factor of one function of z: the factor of an
    even function in the displacement u_x or u_y, or the factor of an odd function in u_z. The
    factor is zero if the function is zero over the width of the parts at the node.

    Attributes
    ----------
    shoe : a parametric shoe
    radius : radius of the drum [m]
    division : division of the section into hp elements
    functions : functions across the width
    """

    shoe: Shoe
    radius: float
    division: ShoeElementDivision
    functions: FunctionsAcrossWidth

    @cached_property
    def grid(self) -> HpElementGrid:
        """All nodes and elements of the section."""
        return element_grid_of_whole_shoe(self.shoe, self.radius, self.division)

    @cached_property
    def layers(self) -> ElementLayersWithWidthFunctions:
        """The layers of elements of the shoe, counted from the contact."""
        return layers_with_width_functions(self.shoe, self.division, self.functions)

    @property
    def unknowns_per_node(self) -> int:
        """Number of unknowns of a node: two for each even function, one for each odd function."""
        functions = self.functions
        even, odd = functions.even_functions_across_width, functions.odd_functions_across_width
        return 2 * len(even) + len(odd)

    def nodal_displacements_in_load_cases(
        self, nodal: Floats, frame: Floats, loads: Floats
    ) -> Floats:
        """The unknowns (nodes unknowns_per_node, m) of all nodes of the section in m load cases.

        The unknowns are sorted by node; `factors_of_even_and_odd_functions_at_nodes` splits them by
        function.

        Parameters
        ----------
        nodal : (2n, m) forces on the n nodes of the contact face [N], whose positions along the arc
            are `ShoeElementDivision.indices_of_kept_contact_nodes`
        frame : (3, m) rigid-body displacements of the frame
        loads : (l, m) factors of the unit loads

        Raises
        ------
        NoAnswer
            for a singular stiffness
        """
        forces = self._forces_on_contact_face(nodal)
        if "actuation" in self.grid.sets:
            at, unit = self._indices_of_unknowns_and_unit_loads_on_loaded_end()
            forces[at] += unit @ loads
        u = self._displacements_with_hinge_face_held(forces)
        # A motion of the frame moves the whole shoe as a rigid body and causes no strain.
        modes = rigid_body_displacements_of_nodes(
            self.grid.doflocs, self.shoe.pin_position_in_shoe_frame
        )
        by_node = u.reshape(self.grid.N, self.unknowns_per_node, -1)
        by_node[:, :2] += (modes @ frame).reshape(self.grid.N, 2, -1)
        return u

    def factors_of_even_and_odd_functions_at_nodes(self, u: Floats) -> tuple[Floats, Floats]:
        """Split the unknowns u of all nodes into factors of even and factors of odd functions of z.

        The first result (nodes, even functions, 2) [m] has the factors for the displacements x and
        y, and the second result (nodes, odd functions) [m] the factors for the displacements along
        z. u (nodes unknowns_per_node,) [m] are the unknowns in one load case.
        """
        by_node = u.reshape(self.grid.N, self.unknowns_per_node)
        even = 2 * len(self.functions.even_functions_across_width)
        return by_node[:, :even].reshape(self.grid.N, -1, 2), by_node[:, even:]

    def _indices_of_displacements_among_unknowns(
        self, nodes: Ints, function: Ints, component: Ints, along_z: Ints
    ) -> Ints:
        """The indices (n,) of n displacements among the unknowns of the shoe.

        Parameters
        ----------
        nodes : (n,) nodes of the section
        function : (n,) indices of their functions across the width
        component : (n,) 0 for x and 1 for y
        along_z : (n,) 1 for a displacement along z, for which the component is ignored; 0 for
            others
        """
        even = 2 * len(self.functions.even_functions_across_width)
        within = np.where(along_z == 1, even + function, 2 * function + component)
        return np.asarray(nodes * self.unknowns_per_node + within)

    def _forces_on_contact_face(self, nodal: Floats) -> Floats:
        """Forces (unknowns, m) on the shoe's unknowns, from forces (2n, m) on the face's nodes."""
        half = self.layers.halves[0]
        to_functions = matrix_from_node_values_to_function_factors(self.functions, half)
        values, count = np.linalg.inv(to_functions).T, len(to_functions)
        contact, cases = self.division.indices_of_kept_contact_nodes, nodal.shape[1]
        by_node = nodal.reshape(len(contact), count, 2, cases)
        by_function = np.einsum("kj,njcm->nkcm", values, by_node)
        forces = np.zeros((self.grid.N, self.unknowns_per_node, cases))
        forces[contact, : 2 * count] = by_function.reshape(len(contact), 2 * count, cases)
        return forces.reshape(-1, cases)

    def _indices_of_unknowns_and_unit_loads_on_loaded_end(self) -> tuple[Ints, Floats]:
        """The indices (n,) of unknowns on the loaded end face, and the unit loads (n, 3) on them.

        The unit loads are the same as in `shoe.condense_shoe_with_width`.
        """
        div, nodes = self.division, self.grid.sets["actuation"]
        loads = self.layers.unit_loads_on_end_face(
            div, self.grid.doflocs[:, nodes], np.zeros(1)
        ).forces
        line = self.layers.unknowns_across_body_thickness(div)
        at = self._indices_of_displacements_among_unknowns(
            nodes[line.row], line.function, line.component, line.z
        )
        return at, loads

    def _which_unknowns_are_zero_with_hinge_face_held(self) -> Bools:
        """A mask (unknowns,), True for each unknown that is zero while the shoe's frame is held."""
        div, nodes = self.division, self.grid.sets["hinge"]
        held = np.zeros(self.grid.N * self.unknowns_per_node, dtype=bool)
        by_node = held.reshape(self.grid.N, -1)
        if div.index_of_first_body_layer == div.number_of_element_layers:
            # The back of the lining or of its backing is bonded to a rigid shoe.
            by_node[nodes] = True
        elif "actuation" not in self.grid.sets:
            # A grip leaves the nodes free along z.
            by_node[nodes, : 2 * len(self.functions.even_functions_across_width)] = True
        else:
            line = self.layers.unknowns_across_body_thickness(div)
            numbers = self._indices_of_displacements_among_unknowns(
                nodes[line.row], line.function, line.component, line.z
            )
            held[numbers[line.z == 0]] = True
        return held

    def element_columns_from_hinge_to_far_end(self) -> list[_ElementColumnWithNumbersOfUnknowns]:
        """All columns of elements of the shoe, from the end at its hinge to the other end."""
        p, div = self.division.degree, self.division
        under, *beyond = (block.number for block in self.grid.blocks)
        first, columns = (
            div.index_of_first_body_layer,
            [self._element_columns_of_one_block(under, 0)],
        )
        if beyond and len(div.column_ends_before_lining) > 1:
            # The nodes of this block go from the lining to the hinge, so that they are put into
            # reverse order.
            columns.insert(0, self._element_columns_of_one_block(beyond.pop(0)[:, ::-1], first))
        if beyond:
            columns.append(self._element_columns_of_one_block(beyond.pop(0), first))
        assert all(column.nodes.shape[1] == p + 1 for block in columns for column in block)
        return [column for block in columns for column in block]

    def _element_columns_of_one_block(
        self, number: Ints, first: int
    ) -> list[_ElementColumnWithNumbersOfUnknowns]:
        """The element columns of a block of elements, from left to right.

        `number` (rows, nodes of a row) are the indices of the block's nodes. `first` is the index
        of the block's first layer of elements, counted from the contact.
        """
        p = self.division.degree
        stack = self.layers.layers_of_element_column_from_given_layer(
            p, first, contact=False, back=ConditionAtEdgeFarthestFromContact.FREE
        )
        along = indices_of_unknowns_along_node_row(p)
        plan, names = (
            condensation_plan_of_column(stack, along),
            unknowns_of_element_column_by_role_in_condensation(stack, along),
        )
        found = []
        for start in range(0, number.shape[1] - 1, p):
            nodes = number[:, start : start + p + 1]

            def indices_of_column_unknowns(
                unknowns: list[ColumnDisplacementUnknown], nodes: Ints = nodes
            ) -> Ints:
                """The indices of a column's unknowns among the unknowns of the shoe."""
                z, place, row, function = np.array(unknowns, dtype=int).reshape(-1, 4).T
                node = nodes[row, np.where(z == 1, place, place // 2)]
                return self._indices_of_displacements_among_unknowns(node, function, place % 2, z)

            boundary = tuple(indices_of_column_unknowns(own) for own in names.boundary)
            within = tuple(indices_of_column_unknowns(own) for own in names.within)
            kept, rest = (
                indices_of_column_unknowns(names.kept),
                indices_of_column_unknowns(names.rest),
            )
            found.append(
                _ElementColumnWithNumbersOfUnknowns(
                    nodes, first, plan, kept, rest, boundary, within
                )
            )
        return found

    def _cross_section_integrals_of_layers(
        self, column: _ElementColumnWithNumbersOfUnknowns
    ) -> list[ElementIntegralsOverShoeSection]:
        """For each layer of a column, the integrals over the section of the layer's element."""
        p, order = self.division.degree, reference_element_of_degree(self.division.degree).order
        found = []
        for k, lame in enumerate(self.layers.lame[column.first :]):
            nodes = column.nodes[k * p : (k + 1) * p + 1].ravel()[order]
            found.append(
                cross_section_integrals_of_any_shape(self.grid.doflocs[:, nodes][None], lame, p)
            )
        return found

    def _assembled_stiffness_of_element_column(
        self, column: _ElementColumnWithNumbersOfUnknowns, held: Bools
    ) -> AssembledStiffnessOfColumns:
        """The assembled stiffness of one column, with held unknowns decoupled from free ones.

        The three blocks have no first axis, since they belong to a single column.
        """
        widths = self.layers.width_function_integrals_of_layers(column.first)
        parts = self._cross_section_integrals_of_layers(column)
        made = column_stiffnesses_without_inner_element_unknowns(parts, widths, column.plan)
        kept, rest = ~held[column.kept], ~held[column.rest]
        own = made.rest[0] * np.outer(rest, rest)
        # A held unknown gets the stiffness 1, coupled with no other unknown, so that it becomes
        # zero.
        own[np.diag_indices(len(own))] += np.where(rest, 0.0, 1.0)
        return AssembledStiffnessOfColumns(
            made.kept[0] * np.outer(kept, kept), made.coupling[0] * np.outer(rest, kept), own
        )

    def _displacements_with_hinge_face_held(self, forces: Floats) -> Floats:
        """The displacements (unknowns, m) due to forces (unknowns, m) [N] while the frame is held.

        Raises NoAnswer for a singular stiffness.
        """
        held = self._which_unknowns_are_zero_with_hinge_face_held()
        forces = np.where(held[:, None], 0.0, forces)
        columns = self.element_columns_from_hinge_to_far_end()
        u = np.zeros(forces.shape)
        for line in reversed(self._cholesky_factors_of_node_lines(columns, held, forces.copy())):
            rest = line.forces - line.rows_of_later_unknowns.T @ u[line.later]
            u[line.own] = dtrsm(1.0, line.L, rest, lower=1, trans_a=1)
        for column in columns:
            # The displacements of both sides give the displacements of the other edges of elements,
            # and all of these give the displacements inside the elements.
            made = self._assembled_stiffness_of_element_column(column, held)
            right = forces[column.rest] - made.coupling @ u[column.kept]
            u[column.rest] = np.linalg.solve(made.rest, right)
            parts = self._cross_section_integrals_of_layers(column)
            widths = self.layers.width_function_integrals_of_layers(column.first)
            for k, layer in enumerate(column.plan.layers):
                if len(column.within[k]):
                    on_boundary = u[column.boundary[k]][None]
                    inside = displacements_inside_elements(parts[k], widths[k], layer, on_boundary)
                    u[column.within[k]] = inside[0]
        return u

    def _cholesky_factors_of_node_lines(
        self, columns: list[_ElementColumnWithNumbersOfUnknowns], held: Bools, forces: Floats
    ) -> list[_CholeskyFactorOfNodeLine]:
        """The Cholesky factors of all lines of nodes between element columns, from the hinge on.

        Parameters
        ----------
        columns : columns of the shoe, from the hinge to the far end
        held : (unknowns,) True for unknowns that are zero while the frame is held
        forces : (unknowns, m) forces on the unknowns [N], which are changed in place

        Raises
        ------
        NoAnswer
            for a singular stiffness
        """
        # `earlier` are the unknowns of the line that the last column ends at, and `S` is the
        # stiffness on them of all columns so far.
        earlier, S = np.zeros(0, dtype=int), np.zeros((0, 0))
        found = []
        for column in columns:
            line = column.plan.line
            left, right = column.kept[:line], column.kept[line:]
            made = self._assembled_stiffness_of_element_column(column, held)
            L = _cholesky_factor(made.rest)
            coupling = dtrsm(1.0, L, made.coupling, lower=1)
            K = made.kept - coupling.T @ coupling
            forces[column.kept] -= coupling.T @ dtrsm(1.0, L, forces[column.rest], lower=1)
            # At an end of the lining, one of the two columns at the line has the body's layers
            # only, and so only a part of the line's unknowns.
            own = np.union1d(earlier, left)
            D = np.diag(held[own].astype(float))
            before, at = np.searchsorted(own, earlier), np.searchsorted(own, left)
            D[np.ix_(before, before)] += S
            D[np.ix_(at, at)] += K[:line, :line]
            to_next = np.zeros((len(own), len(right)))
            to_next[at] = K[:line, line:]
            factor = _cholesky_factor_of_node_line(own, right, D, to_next, forces)
            forces[right] -= factor.rows_of_later_unknowns @ factor.forces
            found.append(factor)
            earlier, S = (
                right,
                K[line:, line:] - factor.rows_of_later_unknowns @ factor.rows_of_later_unknowns.T,
            )
        S += np.diag(held[earlier].astype(float))
        none = np.zeros((len(earlier), 0))
        return [
            *found,
            _cholesky_factor_of_node_line(earlier, np.zeros(0, dtype=int), S, none, forces),
        ]


def _cholesky_factor(K: Floats) -> Floats:
    """The lower Cholesky factor of a stiffness; raises NoAnswer where it is singular."""
    L, info = dpotrf(K, lower=1)
    if info:
        raise NoAnswer(SINGULAR_BODY_MESSAGE)
    return np.asarray(L)


def _cholesky_factor_of_node_line(
    own: Ints, later: Ints, D: Floats, to_next: Floats, forces: Floats
) -> _CholeskyFactorOfNodeLine:
    """The part of the Cholesky factor that belongs to a line of nodes.

    Parameters
    ----------
    own, later : numbers (n,) and (k,) of the unknowns of the line and of the next line
    D : (n, n) stiffness of the line
    to_next : (n, k) stiffness that couples the line with the next line
    forces : (unknowns, m) forces on all unknowns of the shoe
    """
    L = _cholesky_factor(D)
    return _CholeskyFactorOfNodeLine(
        own,
        later,
        L,
        np.asarray(dtrsm(1.0, L, to_next, lower=1)).T,
        np.asarray(dtrsm(1.0, L, forces[own], lower=1)),
    )
