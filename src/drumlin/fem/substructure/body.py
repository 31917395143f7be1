"""An elastic body as a substructure: its stiffness, and its static condensation.

Condensation keeps two groups of degrees of freedom: the displacements c of the contact nodes, and
the displacements f = (dx, dy, rotation) of the frame, a rigid line of the body that its support
holds. All other degrees of freedom are eliminated once, which leaves the Schur complement S on c
and f.

If the frame does not move (f = 0), nodal forces G on the contact nodes do the work G^T S_cc^-1 G =
Y^T Y on the displacements that they cause. Here S_cc = L_cc L_cc^T is the Cholesky factorisation of
the block of S on c, and Y = L_cc^-1 G is called the half flexibility. The forces L_fc Y on the
frame, with L_fc = S_fc L_cc^-T and the block S_fc of S on f and c, keep the frame in its place.
"""

import copy
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple, Protocol, runtime_checkable

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.base.lapack import dpotrf, dtrsm, solve_lower_triangular_system
from drumlin.brake.elasticity import ElasticLayer, which_elasticity_matrices_are_orthotropic
from drumlin.fem.substructure.elasticity import (
    isotropic_and_orthotropic_elastic_constants,
    unit_vectors_through_thickness_of_layers,
)
from drumlin.fem.substructure.elimination import (
    SINGULAR_BODY_MESSAGE,
    CondensedSystem,
    FactorsOfElimination,
    eliminate_inner_unknowns,
    elimination_order_by_nested_dissection,
    factorise_fronts_in_any_order,
)
from drumlin.fem.substructure.flexibility import (
    ContactFlexibility,
    ContactForces,
    EliminatedUnknownsInOrder,
    flexibility_under_contact_forces,
)
from drumlin.fem.substructure.interface import ContactCouplingMatrices, MatrixForProducts
from drumlin.fem.substructure.loads import ColumnsOfUnitLoads, stack_nodal_loads_as_matrix_columns

DEGREES_OF_FREEDOM_OF_BODY_FRAME = 3
"""Number of degrees of freedom of a body's frame, its supported rigid line: dx, dy and rotation."""


COLUMNS_MULTIPLIED_TOGETHER = 256
"""Number of columns of displacements that are multiplied with a coupling matrix at the same time.

With more columns the copies of the columns take more memory; with fewer columns the products take
more time. The value is a judgement.
"""


class MultiPointConstraints(NamedTuple):
    """The multi-point constraints of a body, which leave fewer unknowns than displacements.

    The constraints tie the nodes of the rigid line to the frame. The order of the reduced unknowns
    is: inner nodes, contact nodes as x, y pairs by growing angle, frame.

    Attributes
    ----------
    matrix : sparse matrix (2 nodes, unknowns) from reduced unknowns to displacements of all nodes
    region : number of the region of `elimination_order_by_nested_dissection` in which each inner
        unknown is eliminated, not decreasing
    contact_region : number of the region of each unknown of the contact nodes; the unknown is
        eliminated there if the frame alone is kept
    """

    matrix: Any
    region: Ints
    contact_region: Ints

    @property
    def region_of_all_unknowns_but_frame(self) -> Ints:
        """The number of the region of each unknown except those of the frame."""
        return np.concatenate([self.region, self.contact_region])


class UncondensedBodySystem(NamedTuple):
    """The equations of a body before condensation, on its reduced unknowns.

    Attributes
    ----------
    A : (unknowns, unknowns) sparse stiffness
    constraints : the constraints that define the reduced unknowns
    loads : (unknowns, l) l unit loads, as forces on the reduced unknowns
    factors : Cholesky factors of all unknowns except the frame, with which displacements are cheap
        to compute; None if they are not kept
    """

    A: Any
    constraints: MultiPointConstraints
    loads: Floats
    factors: FactorsOfElimination | None = None

    @classmethod
    def body_system_from_stiffness_of_all_nodes(
        cls, K: Any, constraints: MultiPointConstraints, loads: Floats
    ) -> "UncondensedBodySystem":
        """The equations of a body from the stiffness K (2 nodes, 2 nodes) of all its nodes."""
        # All factors are in CSC format, because products of other formats copy the large matrix K.
        A = constraints.matrix.T.tocsc() @ K @ constraints.matrix
        return cls(A, constraints, loads)

    def equations_of_body_before_condensation(self) -> "UncondensedBodySystem":
        """Return the system itself; the method exists because bodies of all kinds have it."""
        return self

    def condense_loads_and_stiffness(self) -> CondensedSystem:
        """The stiffness and the unit loads of the body, condensed to contact nodes and frame."""
        return eliminate_inner_unknowns(self.A, self.constraints.region, self.loads)

    def copy_with_further_unit_loads(self, forces: Floats) -> "UncondensedBodySystem":
        """A copy of the system with k more unit loads, in the last columns of `loads`.

        `forces` (2 nodes, k) are the nodal forces of these unit loads on all nodes.
        """
        further = self.constraints.matrix.T @ forces
        return self._replace(loads=np.hstack([self.loads, further]))

    def nodal_displacements_in_load_cases(
        self, nodal: Floats, frame: Floats, loads: Floats
    ) -> Floats:
        """Displacements (2 nodes, m) of all nodes [m] in m load cases.

        In each load case, forces `nodal` (2n, m) [N] act on the n contact nodes, the unit loads act
        with the factors `loads` (l, m), and the frame moves by `frame` (3, m).
        """
        right = self.loads @ loads
        # The contact nodes are the last unknowns before the frame.
        first = len(right) - DEGREES_OF_FREEDOM_OF_BODY_FRAME - len(nodal)
        right[first:-DEGREES_OF_FREEDOM_OF_BODY_FRAME] += nodal
        free = self._solve_with_given_frame(right, frame)
        return np.asarray(self.constraints.matrix @ free)

    def _solve_with_given_frame(self, right: Floats, frame: Floats) -> Floats:
        """The unknowns (unknowns, m) under forces `right` on them, and frame motions (3, m)."""
        factors = self.factors or FactorsOfElimination.factors_of_sparse_matrix(
            self.A, self.constraints.region_of_all_unknowns_but_frame
        )
        return factors.solve_with_given_last_unknowns(right, frame)

    def contact_displacements_and_load_travel(self, column: slice) -> tuple[Floats, Floats]:
        """The motion of a body whose frame does not move, under some of its unit loads.

        Returns the displacements (2n, k) of the n contact nodes, and the work (l, k) of each unit
        load on the displacements. The load columns in `column` are the k acting loads.
        """
        acting = self.loads[:, column]
        frame = np.zeros((DEGREES_OF_FREEDOM_OF_BODY_FRAME, acting.shape[1]))
        free = self._solve_with_given_frame(acting, frame)
        first = len(self.constraints.region)
        return free[first:-DEGREES_OF_FREEDOM_OF_BODY_FRAME], self.loads.T @ free

    def flexibility_under_contact_loads(self, N: Floats, T: Floats | None) -> ContactFlexibility:
        """How the body moves under unit loads, and under pressures and friction on its contact.

        N and T (n, 2n) couple the contact nodes with the drum or the plane; T is None without
        friction. Raises NoAnswer for a singular stiffness.
        """
        region = self.constraints.region_of_all_unknowns_but_frame
        if self.factors is None:
            fronts, order = factorise_fronts_in_any_order(self.A, region)
        else:
            fronts, order = iter(self.factors.fronts), self.factors.order
        contact = np.full(len(self.loads), -1)
        first = len(self.constraints.region)
        contact[first:-DEGREES_OF_FREEDOM_OF_BODY_FRAME] = np.arange(N.shape[1])
        unknowns = EliminatedUnknownsInOrder(
            region[order[: len(region)]], contact[order], self.loads[order]
        )
        forces = ContactForces.contact_forces_of_coupling_matrices(N, T)
        return flexibility_under_contact_forces(fronts, unknowns, forces)


class EliminatedUnknownsOfAnyBody(Protocol):
    """The interface to the eliminated unknowns of a body, which bodies of all kinds have."""

    def nodal_displacements_in_load_cases(
        self, nodal: Floats, frame: Floats, loads: Floats
    ) -> Floats:
        """Displacements (2 nodes, m) of all nodes [m] in m load cases.

        In each load case, forces `nodal` (2n, m) [N] act on the n contact nodes, the unit loads act
        with the factors `loads` (l, m), and the frame moves by `frame` (3, m).
        """


@runtime_checkable
class EliminatedUnknownsAndEquationsOfAnyBody(EliminatedUnknownsOfAnyBody, Protocol):
    """The interface to the eliminated unknowns, equations and loads of a body in plane stress.

    An `UncondensedBodySystem` holds the whole stiffness. A body of hp elements assembles its
    stiffness only when a method needs it, see `hp.grid.EliminatedUnknownsOfHpElementBody`.
    """

    def equations_of_body_before_condensation(self) -> UncondensedBodySystem:
        """The equations of the body before its inner unknowns are eliminated."""

    def condense_loads_and_stiffness(self) -> CondensedSystem:
        """The stiffness and the unit loads of the body, condensed to contact nodes and frame."""

    def copy_with_further_unit_loads(
        self, forces: Floats
    ) -> "EliminatedUnknownsAndEquationsOfAnyBody":
        """A copy of the body with k more unit loads, in the columns after its present unit loads.

        `forces` (2 nodes, k) are the nodal forces of these unit loads on all nodes.
        """


@dataclass(frozen=True, kw_only=True)
class BodyWithUnitLoads:
    """An elastic body with its eliminated unknowns and its unit loads.

    Attributes
    ----------
    inner : the eliminated unknowns, from which displacements inside the body are recovered
    columns : the names of the l unit loads, and which columns of the load arrays belong to each
        load
    force_imbalance : estimate of the imbalance that round-off of the elimination causes, relative
        to the acting force; 0 if it is not known
    rigid_mode_error : (2n, 3) estimate of the contact displacement [m] that round-off adds to each
        rigid-body mode of the frame; None if it is not known
    """

    inner: EliminatedUnknownsOfAnyBody
    columns: ColumnsOfUnitLoads
    force_imbalance: float = 0.0
    rigid_mode_error: Floats | None = None

    @property
    def eliminated_unknowns_with_equations(self) -> EliminatedUnknownsAndEquationsOfAnyBody:
        """The eliminated unknowns with their equations."""
        # The unknowns of shoes with widths recover displacements only and have no equations. The
        # callers of this property refuse such shoes.
        assert isinstance(self.inner, EliminatedUnknownsAndEquationsOfAnyBody)
        return self.inner

    def assemble_equations_of_whole_body(self) -> UncondensedBodySystem:
        """Assemble and return the equations of the body on all its nodes, before condensation."""
        return self.eliminated_unknowns_with_equations.equations_of_body_before_condensation()

    @property
    def multi_point_constraints(self) -> MultiPointConstraints:
        """The multi-point constraints of the body.

        Each access assembles the whole system.
        """
        return self.assemble_equations_of_whole_body().constraints

    @property
    def unit_loads_on_reduced_unknowns(self) -> Floats:
        """The unit loads (unknowns, l) on the reduced unknowns.

        Each access assembles the whole system.
        """
        return self.assemble_equations_of_whole_body().loads

    def nodal_displacements_in_one_case(
        self, nodal: Floats, frame: Floats, loads: Floats
    ) -> Floats:
        """Displacement (2, nodes) of all nodes [m], eliminated nodes included, in one load case.

        Parameters
        ----------
        nodal : (2n,) forces on the contact nodes [N]
        frame : (3,) displacements dx, dy [m] and rotation [rad] of the frame
        loads : (l,) factors of the unit loads
        """
        u = self.nodal_displacements_in_load_cases(nodal[:, None], frame[:, None], loads[:, None])
        return np.asarray(u.reshape(-1, 2).T)

    def nodal_displacements_in_load_cases(
        self, nodal: Floats, frame: Floats, loads: Floats
    ) -> Floats:
        """Displacements (2 nodes, m) of all nodes [m] in m load cases, eliminated nodes included.

        The parameters are those of `nodal_displacements_in_one_case` with one column for each case:
        nodal (2n, m), frame (3, m), loads (l, m).
        """
        return self.inner.nodal_displacements_in_load_cases(nodal, frame, loads)

    def _columns_with_further_loads(self, loads: Mapping[str, Floats]) -> ColumnsOfUnitLoads:
        """The load columns of the body and of additional loads; ValueError for a name twice."""
        if taken := self.columns.column_slice_of_each_load.keys() & loads.keys():
            raise ValueError(f"the body has loads of these names already: {sorted(taken)}")
        return ColumnsOfUnitLoads(
            self.columns.sizes + ColumnsOfUnitLoads.columns_of_named_unit_loads(loads).sizes
        )


@dataclass(frozen=True)
class CondensedBody(BodyWithUnitLoads):
    """A body reduced by static condensation to its 2n contact displacements and its frame.

    The frame is the rigid line of the body that its support holds, with the displacements dx, dy
    and rotation.

    Attributes
    ----------
    L_cc : (2n, 2n) lower Cholesky factor of the stiffness on the contact nodes, without motion of
        the frame
    L_fc : (3, 2n) matrix S_fc L_cc^-T; contact forces G, with the half flexibility Y = L_cc^-1 G,
        need the forces L_fc Y to keep the frame in its place
    load_on_contact, load_on_frame : (2n, l) and (3, l) the l unit loads, condensed to the contact
        nodes and to the frame
    load_work : (l, l) work of each unit load on the displacements due to each unit load, while
        contact nodes and frame are fixed
    """

    L_cc: Floats
    L_fc: Floats
    load_on_contact: Floats
    load_on_frame: Floats
    load_work: Floats

    def flexibility_under_contact_loads(
        self, coupling: ContactCouplingMatrices, *, friction: bool
    ) -> ContactFlexibility:
        """How the body moves under unit loads, and under pressures and friction on its contact.

        The matrices N and T of `coupling` couple the contact nodes with the drum or the plane. If
        `friction` is False, T is not used.

        With the forces P of unit pressures and loads and the forces Q = T^T of unit friction, the
        matrices are P^T S_cc^-1 P = Y^T Y and Q^T S_cc^-1 P = T X, where Y = L_cc^-1 P is the half
        flexibility and X = L_cc^-T Y are displacements. X takes the place of Y. The half
        flexibility of the friction, which would be as large as Y, is not needed.
        """
        n = len(coupling.lever)
        end = n + self.columns.number_of_load_columns
        pressed, loaded, held = slice(n), slice(n, end), slice(end, None)
        # The columns stand for pressures, unit loads and the three motions of the frame, in this
        # order. They lie column by column in memory, so that Y and X take the place of the forces.
        columns = np.empty((2 * n, end + len(self.L_fc)), order="F")
        coupling.write_normal_coupling(columns[:, pressed].T)
        np.negative(columns[:, pressed], out=columns[:, pressed])
        columns[:, loaded] = self.load_on_contact
        Y = self.half_flexibility_under_nodal_forces(columns[:, :end], in_place=True)
        closure = Y[:, pressed].T @ Y
        np.negative(closure, out=closure)
        reaction = self.L_fc @ Y
        motion = Y[:, loaded].T @ Y[:, loaded] + self.load_work
        by_friction: Floats | None = None
        if friction:
            columns[:, held] = self.L_fc.T
            X = dtrsm(1.0, self.L_cc, columns, lower=1, trans_a=1, overwrite_b=1)
            by_friction = _products_of_columns_with_matrix(
                X, coupling.tangential_coupling_for_products, n
            )
            # The matrix is large for a shoe with a width, and is not copied.
            np.negative(by_friction[pressed], out=by_friction[pressed])
        return ContactFlexibility(
            gap_closure_by_pressure=closure[:, pressed],
            gap_closure_by_friction=None if by_friction is None else by_friction[pressed],
            gap_closure_by_load=closure[:, loaded],
            load_point_motion_by_friction=None if by_friction is None else by_friction[loaded],
            load_point_motion_by_load=motion,
            reaction_to_pressure=reaction[:, pressed],
            reaction_to_friction=None if by_friction is None else by_friction[held],
            reaction_to_load=reaction[:, loaded] - self.load_on_frame,
        )

    def contact_displacements_and_load_travel(self, column: slice) -> tuple[Floats, Floats]:
        """The motion of a body whose frame does not move, under some of its unit loads.

        Returns the displacements (2n, k) of the n contact nodes, and the work (l, k) of each unit
        load on the displacements. The load columns in `column` are the k acting loads.
        """
        half = self.half_flexibility_under_nodal_forces(self.load_on_contact[:, column])
        u = dtrsm(1.0, self.L_cc, half, lower=1, trans_a=1)
        return u, self.load_on_contact.T @ u + self.load_work[:, column]

    def half_flexibility_under_nodal_forces(
        self, forces: Floats, *, in_place: bool = False
    ) -> Floats:
        """The half flexibility Y = L_cc^-1 G of nodal forces G (2n, m) on the contact nodes.

        L_cc is the Cholesky factor of the condensed stiffness. Y^T Y (m, m) is a flexibility: the
        work of the forces of each load case on the displacements of each load case. If `in_place`
        is True and the forces lie column by column in memory, Y is written into them.
        """
        return solve_lower_triangular_system(self.L_cc, forces, in_place=in_place)

    def body_with_further_loads(self, loads: Mapping[str, Floats]) -> "CondensedBody":
        """A copy of the body with more unit loads, in the columns after its present unit loads.

        The condensed stiffness stays. The inner unknowns are eliminated once more to condense the
        loads.

        Parameters
        ----------
        loads : nodal forces (2 nodes, k) of each additional load on all nodes, by the load's name,
            in the body's own frame; for thermal strain see
            `expansion.nodal_forces_of_thermal_expansion`

        Raises
        ------
        ValueError
            for a name that a load of the body has already
        """
        columns = self._columns_with_further_loads(loads)
        inner = self.eliminated_unknowns_with_equations.copy_with_further_unit_loads(
            np.concatenate(list(loads.values()), axis=1)
        )
        eliminated = inner.condense_loads_and_stiffness()
        contact, present = len(self.L_cc), self.columns.number_of_load_columns
        further = eliminated.loads[:, present:]
        # The results of the present loads are kept, so that no digit of them changes.
        work = eliminated.work.copy()
        work[:present, :present] = self.load_work
        return replace(
            self,
            load_on_contact=np.hstack([self.load_on_contact, further[:contact]]),
            load_on_frame=np.hstack([self.load_on_frame, further[contact:]]),
            load_work=work,
            inner=inner,
            columns=columns,
        )


def _products_of_columns_with_matrix(X: Floats, T: MatrixForProducts, count: int) -> Floats:
    """The products X^T T^T (m, n) of the columns of X (k, m) with the n rows of a matrix T (n, k).

    `count` is the number n. COLUMNS_MULTIPLIED_TOGETHER columns are multiplied at a time, because a
    product of all columns would be copied to its place in the result.
    """
    found = np.empty((X.shape[1], count))
    for start in range(0, len(found), COLUMNS_MULTIPLIED_TOGETHER):
        own = slice(start, start + COLUMNS_MULTIPLIED_TOGETHER)
        found[own] = (T @ X[:, own]).T
    return found


@dataclass(frozen=True, kw_only=True)
class MeshedBody(BodyWithUnitLoads):
    """A body on a mesh, all of whose unknowns except the frame are eliminated.

    It keeps no stiffness on the contact nodes. The few analyses that need this stiffness get it
    from `condensed`, which computes it at the first access.

    Attributes
    ----------
    inner : the equations of the body before condensation
    """

    inner: UncondensedBodySystem

    def flexibility_under_contact_loads(
        self, coupling: ContactCouplingMatrices, *, friction: bool
    ) -> ContactFlexibility:
        """How the body moves under unit loads, and under pressures and friction on its contact.

        Parameters and errors are those of `UncondensedBodySystem.flexibility_under_contact_loads`,
        with the matrices N and T of `coupling`. If `friction` is False, T is not used.
        """
        return self.inner.flexibility_under_contact_loads(
            coupling.N, coupling.T if friction else None
        )

    def contact_displacements_and_load_travel(self, column: slice) -> tuple[Floats, Floats]:
        """The motion of a body whose frame does not move, under some of its unit loads.

        See `UncondensedBodySystem.contact_displacements_and_load_travel`.
        """
        return self.inner.contact_displacements_and_load_travel(column)

    def body_with_further_loads(self, loads: Mapping[str, Floats]) -> "MeshedBody":
        """A copy of the body with more unit loads, in the columns after its present unit loads.

        Parameters and errors are those of `CondensedBody.body_with_further_loads`.
        """
        columns = self._columns_with_further_loads(loads)
        inner = self.inner.copy_with_further_unit_loads(
            np.concatenate(list(loads.values()), axis=1)
        )
        return replace(self, inner=inner, columns=columns)

    @cached_property
    def condensed(self) -> CondensedBody:
        """The body condensed to its contact nodes and its frame.

        Raises NoAnswer for a singular stiffness.
        """
        contact = len(self.inner.constraints.contact_region)
        return condense_body_system_to_contact_and_hinge_face(self.inner, self.columns, contact)

    @property
    def L_cc(self) -> Floats:
        """The matrix `CondensedBody.L_cc`."""
        return self.condensed.L_cc

    @property
    def load_on_contact(self) -> Floats:
        """The unit loads `CondensedBody.load_on_contact`."""
        return self.condensed.load_on_contact

    def half_flexibility_under_nodal_forces(self, forces: Floats) -> Floats:
        """See `CondensedBody.half_flexibility_under_nodal_forces`."""
        return self.condensed.half_flexibility_under_nodal_forces(forces)


def sparse_stiffness_of_body(
    basis: Any, layers: Mapping[str, ElasticLayer], *, precise: bool = False
) -> Any:
    """Sparse stiffness (2 nodes, 2 nodes) of plane stress [N/m].

    Unknown 2 i + c is component c of node i. The isotropic part of the layers is

        K_ai,bj = b Int lambda psi_a,i psi_b,j + mu psi_a,j psi_b,i + mu delta_ij psi_a,k psi_b,k dA

    where b is the width, lambda and mu are the Lame constants of plane stress, and psi_a,i is the
    derivative of the shape function of node a by coordinate i. Orthotropic layers add the terms of
    `hp.element.plane_stress_stiffness_of_elements`. One matrix product for each element multiplies
    the gradients of all shape functions. scikit-fem would evaluate the integrand once for each pair
    of shape functions.

    Parameters
    ----------
    basis : scalar basis of a mesh, or a grid of hp elements, which computes its own stiffness
    layers : elastic layers by subdomain
    precise : whether everything is computed in long double, beginning with the node coordinates
    """
    if hasattr(basis, "stiffness"):
        # The basis is a grid of hp elements, or its skeleton (the nodes on the boundaries of
        # elements). The skeleton's stiffness exists in double precision only and has no option
        # `precise`.
        return basis.stiffness(layers, precise=True) if precise else basis.stiffness(layers)
    K = _isotropic_stiffness_of_elements(basis, layers, precise=precise)
    orthotropic = {
        name: members
        for name, members in basis.mesh.subdomains.items()
        if which_elasticity_matrices_are_orthotropic(layers[name].elasticity)
    }
    if orthotropic:
        gradients, dx = _shape_gradients_and_quadrature_areas(basis, precise=precise)
        points = quadrature_points_of_elements(basis, precise=precise)
        for name, members in orthotropic.items():
            K[members] += _orthotropic_part_of_element_stiffness(
                layers[name], gradients[:, :, members], dx[members], points[:, members]
            )
    return assemble_sparse_stiffness(K, basis.element_dofs.T, basis.N)


def _isotropic_stiffness_of_elements(
    basis: Any, layers: Mapping[str, ElasticLayer], *, precise: bool
) -> Any:
    """The isotropic part (elements, a, 2, a, 2) of the element stiffness [N/m].

    The parameters are those of `sparse_stiffness_of_body`.
    """
    lame = np.zeros((2, basis.mesh.nelements))
    for name, members in basis.mesh.subdomains.items():
        matrix = layers[name].elasticity_times_width
        lame[:, members] = np.array([matrix[0, 1], matrix[-1, -1]])[:, None]
    straight = np.zeros(0, dtype=np.int64)
    if hasattr(basis, "numbers_of_straight_triangles") and not precise:
        straight = basis.numbers_of_straight_triangles()
    if not len(straight):
        gradients, dx = _shape_gradients_and_quadrature_areas(basis, precise=precise)
        return _isotropic_stiffness_by_quadrature(lame, gradients, dx)
    a = len(basis.element_dofs)
    K = np.empty((basis.mesh.nelements, a, 2, a, 2))
    K[straight] = _isotropic_stiffness_of_straight_triangles(basis, straight, lame[:, straight])
    curved = np.setdiff1d(np.arange(len(K)), straight)
    if len(curved):
        gradients, dx = _shape_gradients_and_quadrature_areas(basis.basis_of_some_elements(curved))
        K[curved] = _isotropic_stiffness_by_quadrature(lame[:, curved], gradients, dx)
    return K


def _isotropic_stiffness_of_straight_triangles(basis: Any, elements: Ints, lame: Floats) -> Floats:
    """The isotropic part (m, a, 2, a, 2) of the stiffness of straight triangles [N/m].

    The map of a straight triangle from the reference triangle is linear. The integrals of products
    of slopes are then the integrals over the reference triangle times constants of the element.

    Parameters
    ----------
    basis : basis with the attributes of `mesh.degree.NodalBasis`
    elements : (m,) indices of the triangles
    lame : (2, m) Lame constants of plane stress times the width [N/m] in each triangle
    """
    at = basis.X.astype(np.longdouble)
    a = len(basis.element_dofs)
    slopes = np.array([basis.elem.lbasis(at, i)[1] for i in range(a)])
    # The integrals R_de,ab of d_d psi_a d_e psi_b over the reference triangle, without its area.
    R = np.einsum("adq,beq,q->deab", slopes, slopes, basis.W).astype(float)
    first, second, third = basis.doflocs[:, basis.element_dofs[:3, elements]].transpose(1, 0, 2)
    (xa, ya), (xb, yb) = second - first, third - first
    determinant = xa * yb - xb * ya
    inverse = np.array([[yb, -xb], [-ya, xa]]) / determinant
    # H_ij,de are the constants of the integral of psi_a,i psi_b,j.
    H = np.abs(determinant) * np.einsum("dim,ejm->ijdem", inverse, inverse)
    lam, mu = lame
    factors = lam * H + mu * H.transpose(1, 0, 2, 3, 4)
    for i in range(2):
        factors[i, i] += mu * (H[0, 0] + H[1, 1])
    K = factors.reshape(4, 4, -1).transpose(2, 0, 1) @ R.reshape(4, -1)
    return np.asarray(K.reshape(-1, 2, 2, a, a).transpose(0, 3, 1, 4, 2))


def _isotropic_stiffness_by_quadrature(lame: Any, gradients: Any, dx: Any) -> Any:
    """The isotropic part (elements, a, 2, a, 2) of the element stiffness [N/m].

    Parameters
    ----------
    lame : (2, elements) Lame constants of plane stress times the width [N/m]
    gradients : (a, 2, elements, points) gradients of the shape functions [1/m]
    dx : (elements, points) weights of the quadrature [m^2]
    """
    a, _, elements, points = gradients.shape
    lam, mu = lame[:, :, None, None, None, None]

    # G holds the derivatives psi_a,i at the points of each element, and H the integrals of
    # psi_a,i psi_b,j over each element.
    G = np.ascontiguousarray(gradients.transpose(2, 0, 1, 3)).reshape(elements, 2 * a, points)
    H = (G * dx[:, None, :] @ G.transpose(0, 2, 1)).reshape(elements, a, 2, a, 2)
    K = lam * H + mu * H.transpose(0, 1, 4, 3, 2)
    for i in range(2):
        K[:, :, i, :, i] += mu[:, :, 0, :, 0] * np.trace(H, axis1=2, axis2=4)
    return K


def assemble_sparse_stiffness(K: Any, nodes: Ints, N: int) -> Any:
    """The sparse stiffness (2 N, 2 N) of a mesh of N nodes, assembled from its elements.

    Parameters
    ----------
    K : (e, a, 2, a, 2) or (e, 2 a, 2 a) stiffness of elements; x and y of a node are neighbours
    nodes : (e, a) nodes of the elements
    N : number of nodes
    """
    # The import of scipy.sparse takes time, and condensed hp elements do without it.
    import scipy.sparse as sp  # noqa: PLC0415

    dofs = (2 * nodes[:, :, None] + np.arange(2)).reshape(len(nodes), -1).astype(np.int32)
    rows = np.broadcast_to(dofs[:, :, None], (*dofs.shape, dofs.shape[1]))
    entries = K.ravel(), (rows.ravel(), rows.swapaxes(1, 2).ravel())
    return sp.coo_matrix(entries, shape=(2 * N, 2 * N)).tocsc()


def shape_function_values_at_quadrature_points(basis: Any, *, precise: bool = False) -> Any:
    """Values (a, points) of a basis's shape functions at its quadrature points.

    With `precise` the values are computed in long double.
    """
    at = basis.X.astype(np.longdouble) if precise else basis.X
    return np.array([basis.elem.lbasis(at, i)[0] for i in range(len(basis.element_dofs))])


def quadrature_points_of_elements(basis: Any, *, precise: bool = False) -> Any:
    """The quadrature points (2, elements, points) [m] of all elements of a basis.

    With `precise` the coordinates are computed in long double.
    """
    nodes = basis.doflocs[:, basis.element_dofs]
    return np.einsum(
        "cae,aq->ceq", nodes, shape_function_values_at_quadrature_points(basis, precise=precise)
    )


class ElementQuadrature(NamedTuple):
    """The quadrature of all elements of a body.

    Attributes
    ----------
    xy : (2, e, q) quadrature points [m]
    shapes : (a, q) values of the shape functions at the q points
    areas : (e, q) areas that the points stand for [m^2]
    nodes : (e, a) indices of the nodes of each element
    parts : indices of the elements of each part of the body, by the name of the part
    """

    xy: Floats
    shapes: Floats
    areas: Floats
    nodes: Ints
    parts: Mapping[str, Ints]


def quadrature_of_elements(basis: Any) -> ElementQuadrature:
    """The quadrature of all elements of a basis of scikit-fem or of a grid of hp elements."""
    if hasattr(basis, "element_quadrature"):
        found: ElementQuadrature = basis.element_quadrature
        return found
    return ElementQuadrature(
        xy=quadrature_points_of_elements(basis),
        shapes=shape_function_values_at_quadrature_points(basis),
        areas=basis.dx,
        nodes=basis.element_dofs.T,
        parts=basis.mesh.subdomains,
    )


def _orthotropic_part_of_element_stiffness(
    layer: ElasticLayer, gradients: Any, dx: Any, points: Any
) -> Any:
    """Stiffness (e, a, 2, a, 2) [N/m] that orthotropy adds to the isotropic stiffness of elements.

    Parameters
    ----------
    layer : the orthotropic layer that the e elements belong to
    gradients : (a, 2, e, q) gradients of the shape functions [1/m]
    dx : (e, q) areas of the quadrature points [m^2]
    points : (2, e, q) quadrature points [m]
    """
    a, d, elements, _ = gradients.shape
    along = layer.unit_vectors_along_layer(points)

    def integrals_of_products_of_strains_in_direction(direction: Any) -> Any:
        """The integrals (e, d a, d a) over e elements of products of two normal strains.

        Both strains are in the direction `direction` (2, e, q), due to unit displacements of the a
        nodes in d components.
        """
        grown = np.einsum("ceq,aceq->aeq", direction, gradients)
        stretch = np.einsum("ceq,aeq->eacq", direction, grown).reshape(elements, d * a, -1)
        return (stretch * dx[:, None]) @ stretch.transpose(0, 2, 1)

    _, _, by_along, by_through = isotropic_and_orthotropic_elastic_constants(
        layer.elasticity_times_width
    )
    added = by_along * integrals_of_products_of_strains_in_direction(
        along
    ) + by_through * integrals_of_products_of_strains_in_direction(
        unit_vectors_through_thickness_of_layers(along)
    )
    return added.reshape(elements, a, d, a, d)


def _shape_gradients_and_quadrature_areas(basis: Any, *, precise: bool = False) -> tuple[Any, Any]:
    """Shape-function gradients (a, 2, elements, points) [1/m] and areas (elements, points) [m^2].

    With `precise` they are computed in long double.
    """
    if precise:
        return _shape_gradients_and_quadrature_areas_in_long_double(basis)
    # A basis keeps its gradients, which are large and needed once. The copy is dropped with them.
    own = copy.copy(basis)
    return np.array([psi[0].grad for psi in own.basis]), own.dx


def _shape_gradients_and_quadrature_areas_in_long_double(basis: Any) -> tuple[Any, Any]:
    """Shape-function gradients (a, 2, elements, points) and quadrature areas, in long double.

    The areas are (elements, points). The elements are isoparametric: the same shape functions
    interpolate coordinates and displacements.
    """
    at = basis.X.astype(np.longdouble)
    count = basis.element_dofs.shape[0]
    slopes = np.array([basis.elem.lbasis(at, i)[1] for i in range(count)])  # (a, 2, points)
    nodes = basis.doflocs.astype(np.longdouble)[:, basis.element_dofs]  # (2, a, elements)
    J = np.einsum("caj,adq->cdjq", nodes, slopes)
    det = J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0]
    inverse = np.array([[J[1, 1], -J[0, 1]], [-J[1, 0], J[0, 0]]]) / det
    return np.einsum("adq,dcjq->acjq", slopes, inverse), np.abs(det) * basis.W


def rigid_body_displacements_of_nodes(xy: Floats, pin: Floats) -> Floats:
    """The displacements (2n, 3) of nodes in three rigid-body modes; `xy` (2, n) are the nodes.

    The columns belong to unit motions dx and dy, and to a unit rotation about the point `pin` (2,).
    """
    modes = np.zeros((xy.shape[1], 2, DEGREES_OF_FREEDOM_OF_BODY_FRAME))
    modes[:, 0, 0] = modes[:, 1, 1] = 1.0
    modes[:, 0, 2], modes[:, 1, 2] = pin[1] - xy[1], xy[0] - pin[0]
    return modes.reshape(-1, DEGREES_OF_FREEDOM_OF_BODY_FRAME)


def multi_point_constraints_of_body(
    basis: Any, contact: Ints, rigid: Ints, pin: Floats, alone: Ints | None = None
) -> MultiPointConstraints:
    """The multi-point constraints of a body, which tie its rigid line to the frame.

    The inner nodes are in the order of a nested dissection.

    Parameters
    ----------
    basis : scalar basis of the mesh
    contact : (n,) contact nodes by growing angle
    rigid : nodes of the rigid line, which move with u = (dx, dy) + rotation k x (x - pin)
    pin : (2,) point of the pin [m]
    alone : (3,) indices of three displacements that hold a body without rigid nodes, in place of
        the frame; None for a body with rigid nodes
    """
    order = elimination_order_by_nested_dissection(basis.doflocs, basis.element_dofs)
    inner = np.ones(basis.N, dtype=bool)
    inner[contact] = inner[rigid] = False
    is_inner = inner[order.nodes]
    nodes = np.concatenate([order.nodes[is_inner], contact])
    region = np.repeat(order.region[is_inner], 2)
    region_of_node = np.empty(basis.N, dtype=np.int64)
    region_of_node[order.nodes] = order.region
    contact_region = np.repeat(region_of_node[contact], 2)
    dofs = np.column_stack([2 * nodes, 2 * nodes + 1]).ravel()

    # In a body without rigid nodes, three displacements take the place of the frame. They are the
    # last of the unknowns.
    if alone is not None:
        others = ~np.isin(dofs, alone)
        free = np.concatenate([dofs[others], alone])
        return MultiPointConstraints(
            matrix_from_unknowns_to_displacements(free, 2 * basis.N),
            region[others[: len(region)]],
            contact_region[others[len(region) :]],
        )
    arm = basis.doflocs[:, rigid] - pin[:, None]
    return MultiPointConstraints(
        matrix_from_unknowns_to_displacements(dofs, 2 * basis.N, 2 * rigid, arm),
        region,
        contact_region,
    )


def matrix_from_unknowns_to_displacements(
    dofs: Ints, count: int, rigid: Ints | None = None, arm: Floats | None = None
) -> Any:
    """The sparse matrix (count, unknowns) from the reduced unknowns to all displacements of a body.

    Parameters
    ----------
    dofs : indices of the displacements that are themselves unknowns, in the order of the unknowns
    count : number of all displacements
    rigid : (n,) for each node that moves with the frame, the number of its x displacement; y has
        the next number; None for a body without a frame
    arm : (2, n) vectors [m] from the pin to the nodes that move with the frame
    """
    # The import of scipy.sparse takes time, and condensed hp elements do without it.
    import scipy.sparse as sp  # noqa: PLC0415

    free = len(dofs)
    rows, columns = [dofs], [np.arange(free)]
    values = [np.ones(free)]
    if rigid is not None and arm is not None:
        # A rigid node has four entries: its x depends on dx and the rotation, and its y on dy and
        # the rotation.
        ones = np.ones(len(rigid))
        rows += [rigid, rigid, rigid + 1, rigid + 1]
        columns += list(np.repeat([[free], [free + 2], [free + 1], [free + 2]], len(rigid), axis=1))
        values += [ones, -arm[1], ones, arm[0]]
    unknowns = free + (0 if rigid is None else DEGREES_OF_FREEDOM_OF_BODY_FRAME)
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return sp.csc_matrix(entries, shape=(count, unknowns))


def body_system_with_named_loads(
    K: Any, constraints: MultiPointConstraints, loads: Mapping[str, Floats]
) -> UncondensedBodySystem:
    """The equations of a body with named unit loads.

    Parameters
    ----------
    K : (2 nodes, 2 nodes) stiffness [N/m]
    constraints : the multi-point constraints that define the reduced unknowns
    loads : unit loads (unknowns, k) on the reduced unknowns, by name
    """
    return UncondensedBodySystem.body_system_from_stiffness_of_all_nodes(
        K, constraints, stack_nodal_loads_as_matrix_columns(loads, constraints.matrix.shape[1])
    )


def meshed_body_with_eliminated_contact(
    K: Any,
    constraints: MultiPointConstraints,
    loads: Mapping[str, Floats],
    *,
    keep_factors: bool = False,
) -> MeshedBody:
    """The body of a mesh, without a stiffness on its contact nodes.

    The first three parameters are those of `body_system_with_named_loads`. `keep_factors` tells
    whether the factors of the eliminated unknowns are kept. Raises NoAnswer for a singular
    stiffness whose factors are kept.
    """
    system = body_system_with_named_loads(K, constraints, loads)
    if keep_factors:
        factors = FactorsOfElimination.factors_of_sparse_matrix(
            system.A, constraints.region_of_all_unknowns_but_frame
        )
        system = system._replace(factors=factors)
    return MeshedBody(inner=system, columns=ColumnsOfUnitLoads.columns_of_named_unit_loads(loads))


def condense_body_to_contact_and_hinge_face(
    K: Any, constraints: MultiPointConstraints, loads: Mapping[str, Floats], contact: int
) -> CondensedBody:
    """The body reduced to its contact nodes and its frame by static condensation.

    The first three parameters are those of `body_system_with_named_loads`. `contact` is the number
    of displacements of the contact nodes, two for each node. Raises NoAnswer for a singular
    stiffness.
    """
    return condense_body_system_to_contact_and_hinge_face(
        body_system_with_named_loads(K, constraints, loads),
        ColumnsOfUnitLoads.columns_of_named_unit_loads(loads),
        contact,
    )


def condense_body_system_to_contact_and_hinge_face(
    system: UncondensedBodySystem, columns: ColumnsOfUnitLoads, contact: int
) -> CondensedBody:
    """The body of a system of equations, reduced to its contact nodes and its frame.

    `columns` are the columns of the system's unit loads, and `contact` is the number of
    displacements of the contact nodes. Raises NoAnswer for a singular stiffness.
    """
    S, loads, work = system.condense_loads_and_stiffness()
    L_cc, info = dpotrf(S[:contact, :contact], lower=1)
    if info:
        raise NoAnswer(SINGULAR_BODY_MESSAGE)
    return CondensedBody(
        L_cc,
        L_fc=solve_lower_triangular_system(L_cc, S[:contact, contact:]).T,
        load_on_contact=loads[:contact],
        load_on_frame=loads[contact:],
        load_work=work,
        inner=system,
        columns=columns,
    )
