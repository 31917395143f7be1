"""Scale and factorise the linear equations of a contact set.

The contact set is the set of nodes that touch. The contact problem has n nodes and k rigid-body
modes. The weighted gap of a node is the integral of the gap times the node's shape function. At a
node of the contact set the weighted gap vanishes, w = q + A p + B y = 0. At all other nodes the
pressure vanishes, p = 0. The pressures balance the actuation, C p = h. Both equations together are
one linear system with the matrix [[A, B], [C, 0]], of which only the rows and columns of the
contact set are used.

The system is scaled to entries of similar size and factorised once. A contact set that differs by a
few nodes reuses the factors through a bordered system.
"""

from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.base.lapack import dgecon, dgetrf, dgetrs

MAX_NODES_OF_CONTACT_PROBLEM = 3000
"""Largest number of contact nodes in one contact problem; a brake with more is refused.

On a rigid drum each shoe is a problem of its own. An elastic ring couples the nodes of all shoes.
The dense matrices of a contact problem, and those of the ring, have a row for the pressure of each
node, and in some computations one for its friction. The limit is one of memory: on meshes of files
a solve with 4239 contact nodes takes 2.1 GB, and with 10 606 nodes 14 GB.
"""

SMALLEST_NORMAL_DOUBLE = np.finfo(float).tiny
"""Smallest normal double, 2.2e-308; no scale factor is computed with a smaller divisor.

A row of zeros in a matrix therefore causes no division by 0.
"""

UNKNOWNS_ABOVE_WHICH_BORDERED_SYSTEM_IS_USED = 100
"""Number of unknowns above which a changed contact set is solved by a bordered system.

A bordered system reuses the LU factors of an earlier contact set that differs by a few nodes.
Smaller systems are factorised anew, which is as fast. In trials, limits from 50 to 400 unknowns
changed the time of a solve by less than 4 %. Without bordering, solves of 300 and 700 elements take
1.15 and 1.24 times as long.
"""


class ContactProblem(NamedTuple):
    """A contact problem of n nodes and k rigid-body modes: w = q + A p + B y and C p = h.

    The unknowns are the nodal pressures p (n,) and the rigid-body motions y (k,). The weighted gaps
    are w (n,).

    Attributes
    ----------
    A : compliance (n, n), by which nodal pressures open the weighted gaps; unsymmetric with
        friction
    q : weighted gaps (n,) at zero pressure and without rigid-body motion
    B : changes (n, k) of the weighted gaps per unit of each rigid-body mode
    C : generalised forces (k, n) of unit nodal pressures in the equilibrium of each mode
    h : (k,), minus the generalised forces of the loads, so that C p = h is the equilibrium
    """

    A: Floats
    q: Floats
    B: Floats
    C: Floats
    h: Floats


class ScaledContactSystem(NamedTuple):
    """A contact problem whose rows and columns are scaled to entries of similar size.

    The unknowns x = (p, y) are the nodal pressures p and the rigid-body motions y of the shoes. The
    first n values of r + K x are the weighted gaps of the nodes. The other k values are the forces
    and moments that do not balance. K = [[A, B], [C, 0]] and r = (q, -h) consist of the arrays of
    `ContactProblem`, but scaled.

    Attributes
    ----------
    K : the scaled matrix (n + k, n + k)
    r : the scaled vector (n + k,)
    row_scales : factors (n + k,) of the rows: w = w_scaled / row_scales
    column_scales : factors (n + k,) of the columns: x = column_scales * x_scaled
    n : number of nodes
    """

    K: Floats
    r: Floats
    row_scales: Floats
    column_scales: Floats
    n: int

    @property
    def scaled_contact_problem(self) -> ContactProblem:
        """The scaled contact problem, as views of K and r."""
        K, r, n = self.K, self.r, self.n
        return ContactProblem(K[:n, :n], r[:n], K[:n, n:], K[n:, :n], -r[n:])

    def mask_of_unknowns_of_contact_set(self, active: Bools) -> Bools:
        """Mark the unknowns (n + k,) that a contact set (n,) does not set to zero.

        The marked unknowns are the pressures of the contact set and all rigid-body motions.
        """
        unknowns = np.empty(len(self.r), dtype=bool)
        unknowns[: self.n] = active
        unknowns[self.n :] = True
        return unknowns


def scale_contact_problem(
    problem: ContactProblem, scales_of: ScaledContactSystem | None = None
) -> ScaledContactSystem:
    """Scale a contact problem so that A has a unit diagonal, and B and C entries of at most 1.

    The scale factors are positive, so that neither the signs of pressures and gaps nor the contact
    set change. If an earlier system `scales_of` is given, its scale factors are used.
    """
    A, q, B, C, h = problem
    n, k = B.shape
    rows, columns = (
        _row_and_column_scale_factors_of_contact_problem(problem)
        if scales_of is None
        else (scales_of.row_scales, scales_of.column_scales)
    )
    K = np.zeros((n + k, n + k))
    np.multiply(A, rows[:n, None], out=K[:n, :n])
    K[:n, n:] = B * rows[:n, None]
    K[n:, :n] = C * columns[:n] * rows[n:, None]
    # The columns are scaled in place. A scaled copy would double the time if there are many nodes.
    gap_rows = K[:n]
    gap_rows *= columns
    r = rows * np.concatenate([q, -h])
    return ScaledContactSystem(K, r, rows, columns, n)


def _row_and_column_scale_factors_of_contact_problem(
    problem: ContactProblem,
) -> tuple[Floats, Floats]:
    """Return the scale factors (n + k,) of the rows of K, and the scale factors of its columns."""
    A, _, B, C, _ = problem
    k = B.shape[1]
    # With these factors A gets a unit diagonal. The largest entry of each column of B and of each
    # row of C becomes 1.
    of_nodes = 1 / np.sqrt(np.maximum(np.abs(A.diagonal()), SMALLEST_NORMAL_DOUBLE))
    modes = np.concatenate([B, C.T], axis=1)
    largest = np.abs(modes * of_nodes[:, None]).max(axis=0)
    of_modes = 1 / np.maximum(largest, SMALLEST_NORMAL_DOUBLE)
    rows = np.concatenate([of_nodes, of_modes[k:]])
    return rows, np.concatenate([of_nodes, of_modes[:k]])


def condition_number_on_contact_set(problem: ContactProblem, active: Bools) -> float:
    """Return the condition number, in the 1-norm, of the scaled equations of a contact set (n,).

    LAPACK's routine gecon estimates the condition number from the LU factors.
    """
    system = scale_contact_problem(problem)
    unknowns = np.flatnonzero(system.mask_of_unknowns_of_contact_set(active))
    matrix = system.K[unknowns[:, None], unknowns]
    if not matrix.size:
        return 1.0
    lu, _, _ = dgetrf(matrix)
    norm = np.abs(matrix).sum(axis=0).max()
    reciprocal, _ = dgecon(lu, norm)
    return float(1 / reciprocal) if reciprocal else np.inf


class ContactSetEquations:
    """The linear equations K x = -r of the free unknowns of a contact set, factorised once.

    `free` (n + k,) marks the free unknowns: the pressures of the contact set and all rigid-body
    motions. All other unknowns are 0. The class `BorderedEquations` reuses the factors for a
    contact set that differs by a few nodes.
    """

    def __init__(self, K: Floats, free: Bools) -> None:
        self.free = free
        self._free_numbers = free.nonzero()[0]
        whole = len(self._free_numbers) == len(K)
        matrix = K.copy() if whole else K.take(self._free_numbers, 0).take(self._free_numbers, 1)
        self._factors = _lu_factors_and_pivots_of_transposed_matrix(matrix)

    def solve(self, r: Floats) -> Floats:
        """Return x with r + K x = 0 in the rows of the free unknowns; all other x are 0.

        r and x are (n + k,), or (n + k, m) for m right-hand sides.
        """
        x = np.zeros(r.shape)
        x[self._free_numbers] = self._solve_for_unknowns_of_contact_set(-r[self._free_numbers])
        return x

    @property
    def determinant_sign(self) -> int:
        """The sign, +1 or -1, of the determinant of K in the rows and columns of free unknowns."""
        return _determinant_sign_from_lu_factors(self._factors)

    def _solve_for_unknowns_of_contact_set(self, right: Floats) -> Floats:
        """Return the f free unknowns (f,) for a right-hand side (f,).

        For m right-hand sides both are (f, m).
        """
        return _solve_with_lu_factors(self._factors, right)


class BorderedEquations(ContactSetEquations):
    """The equations of a contact set that differs by a few nodes from a factorised `base`.

    A released node has left the contact set of the base, and an added node has joined it. The
    bordered system has two kinds of unknowns beside the unknowns of the base: the weighted gaps of
    the released nodes, whose pressures must vanish, and the pressures of the added nodes, whose
    weighted gaps must vanish. Only the small Schur complement of the border is factorised.
    """

    def __init__(self, base: ContactSetEquations, K: Floats, free: Bools) -> None:
        self.free = free
        self._base_equations = base
        self._released = np.flatnonzero(~free[base._free_numbers])
        added = np.flatnonzero(free & ~base.free)
        self._free_numbers = np.concatenate([base._free_numbers, added])
        released = len(self._released)
        # The first columns of the border are unit gaps, one for each released node. The other
        # columns are the compliances (columns of K) of the added nodes.
        border = np.zeros((len(base._free_numbers), released + len(added)))
        border[self._released, np.arange(released)] = -1.0
        border[:, released:] = K[base._free_numbers[:, None], added]
        self._base_solution_per_border_unknown = -base._solve_for_unknowns_of_contact_set(border)
        self._rows_of_added_nodes = K[added[:, None], base._free_numbers]
        # The Schur complement (r + a, r + a) holds the pressures of the r released nodes and the
        # weighted gaps of the a added nodes, per unknown of the border.
        schur = self._pressures_of_released_and_gaps_of_added_nodes(
            self._base_solution_per_border_unknown
        )
        schur[released:, released:] += K[added[:, None], added]
        self._schur_factors = _lu_factors_and_pivots_of_transposed_matrix(schur)

    @property
    def determinant_sign(self) -> int:
        """The sign, +1 or -1, of the determinant of K in the rows and columns of free unknowns.

        The result is the sign for the base times the sign of the Schur complement's determinant. By
        Jacobi's theorem on complementary minors the product holds for released nodes too.
        """
        return self._base_equations.determinant_sign * _determinant_sign_from_lu_factors(
            self._schur_factors
        )

    def _pressures_of_released_and_gaps_of_added_nodes(self, solution: Floats) -> Floats:
        """Return the pressures of released nodes, and then the weighted gaps of added nodes.

        `solution` holds the free unknowns of the base.
        """
        return np.concatenate([solution[self._released], self._rows_of_added_nodes @ solution])

    def _solve_for_unknowns_of_contact_set(self, right: Floats) -> Floats:
        """Return the free unknowns of the base, then the pressures of the added nodes.

        The pressures of released nodes are 0. `right` is the right-hand side, in the same order.
        """
        size, released = len(self._base_equations._free_numbers), len(self._released)
        solution = self._base_equations._solve_for_unknowns_of_contact_set(right[:size])
        # The border's unknowns bring the pressures of released nodes to zero, and the gaps of added
        # nodes to their right-hand side.
        no_pressure = np.zeros((released, *right.shape[1:]))
        wanted = np.concatenate([no_pressure, right[size:]])
        border = _solve_with_lu_factors(
            self._schur_factors,
            wanted - self._pressures_of_released_and_gaps_of_added_nodes(solution),
        )
        solution += self._base_solution_per_border_unknown @ border
        solution[self._released] = 0.0
        return np.concatenate([solution, border[released:]])


def do_contact_equations_resist_all_rigid_modes(
    equations: ContactSetEquations, system: ScaledContactSystem
) -> bool:
    """Whether the contact on a contact set resists every rigid-body mode of the shoes.

    With the matrices A, B and C of the contact set, the contact resists if det A > 0 and C A^-1 B
    has no negative real eigenvalue. Contact without friction always resists.
    """
    n = system.n
    k = len(system.r) - n
    if equations.determinant_sign != (-1) ** k:
        return False
    if k < 2:
        return True
    # Column j of the matrix (C A^-1 B)^-1 is the rigid-body motion under a unit generalised force
    # on mode j.
    unit_forces = np.vstack([np.zeros((n, k)), np.diag(system.row_scales[n:])])
    motions = equations.solve(unit_forces)[n:]
    yielding = system.column_scales[n:, None] * motions
    # Each mode has a unit of its own. The scaling makes the eigenvalues independent of the units
    # and keeps their signs. A mode whose diagonal entry is 0 is not scaled.
    size = np.sqrt(np.abs(np.diagonal(yielding)))
    size[size == 0] = 1.0
    values = np.linalg.eigvals(yielding / np.outer(size, size))
    return not ((values.imag == 0) & (values.real < 0)).any()


def _lu_factors_and_pivots_of_transposed_matrix(matrix: Floats) -> tuple[Floats, Ints]:
    """Return LU factors and pivots of the transposed matrix; the matrix itself is overwritten.

    The transposed matrix lies column by column in memory, as LAPACK requires. Raises NoAnswer for a
    singular matrix.
    """
    if not matrix.size:
        return matrix, np.zeros(0, dtype=np.int32)
    lu, pivots, info = dgetrf(matrix.T, overwrite_a=True)
    if info or not np.isfinite(lu.diagonal()).all():
        raise NoAnswer("no equilibrium: the contact cannot balance the actuation")
    return lu, pivots


def _solve_with_lu_factors(factors: tuple[Floats, Ints], right: Floats) -> Floats:
    """Return the solution of a linear system, from LU factors and pivots of the transpose."""
    # LAPACK is called directly, since the checks in scipy take longer than solving small systems.
    return dgetrs(*factors, right, trans=1)[0] if len(right) else right


def _determinant_sign_from_lu_factors(factors: tuple[Floats, Ints]) -> int:
    """Return the sign of the determinant, +1 or -1, from LU factors and pivots.

    Each negative diagonal entry and each swap of rows changes the sign.
    """
    lu, pivots = factors
    swaps = np.count_nonzero(pivots != np.arange(len(pivots)))
    negative = np.count_nonzero(lu.diagonal() < 0)
    return 1 if (negative + swaps) % 2 == 0 else -1


def is_bordered_system_cheaper_than_new_factors(base: ContactSetEquations, free: Bools) -> bool:
    """Whether a bordered system costs less than new LU factors of a contact set.

    `free` (n + k,) marks the free unknowns of the contact set. The bordered system would reuse the
    factors of `base`.
    """
    size = len(base._free_numbers)
    changed = np.count_nonzero(base.free ^ free)
    # A bordered system costs less if fewer than one unknown in eight changes.
    return size > UNKNOWNS_ABOVE_WHICH_BORDERED_SYSTEM_IS_USED and bool(8 * changed < size)
