"""Scale and factorise the linear equations of a contact set.

The contact problem has n nodes and k rigid-body modes. At a node of the contact set the weighted
gap vanishes, w = q + A p + B y = 0. At all other nodes the pressure vanishes, p = 0. The pressures
balance the actuation, C p = h. The gaps and the balance together are one linear system with the
matrix [[A, B], [C, 0]], restricted to the rows and columns of the contact set.

The system is equilibrated and factorised once. A contact set that differs by a few nodes reuses the
factors through a bordered system.
"""

from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.base.lapack import dgecon, dgetrf, dgetrs

TINY = np.finfo(float).tiny
"""Smallest normal double. Divisors are at least TINY, so that an empty row does not divide by 0."""

BORDERED_ABOVE_UNKNOWNS = 100
"""Number of unknowns above which the equations of a changed contact set are bordered.

Bordering reuses the factors of the contact set before. Smaller systems are factorised anew.
 With
fewer unknowns a factorisation is as fast as bordering. Measured by trials: with 50 to 400 the
time of a solve stays within 4 %. Without bordering, solves of 300 and 700 elements take 1.15 and
1.24 times as long.
"""


class ContactProblem(NamedTuple):
    """A contact problem: w = q + A p + B y and C p = h.

    Attributes
    ----------
    A : weighted gaps (n, n) that open per pressure, the compliance; unsymmetric with friction
    q : weighted gaps (n,) of the unloaded contact
    B : weighted gaps (n, k) that open per unit of a rigid-body mode
    C : generalised forces (k, n) of pressures in the equilibria of the modes
    h : generalised forces (k,) of the actuation
    """

    A: Floats
    q: Floats
    B: Floats
    C: Floats
    h: Floats


class EquilibratedSystem(NamedTuple):
    """A scaled contact problem r + K x with x = (p, y), K = [[A, B], [C, 0]] and r = (q, -h).

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
    def problem(self) -> ContactProblem:
        """The scaled contact problem, as views of K and r."""
        K, r, n = self.K, self.r, self.n
        return ContactProblem(K[:n, :n], r[:n], K[:n, n:], K[n:, :n], -r[n:])

    def free_unknowns(self, active: Bools) -> Bools:
        """Mark the free unknowns (n + k,) of a contact set (n,): its pressures and all modes."""
        unknowns = np.empty(len(self.r), dtype=bool)
        unknowns[: self.n] = active
        unknowns[self.n :] = True
        return unknowns


def equilibrate_problem(
    problem: ContactProblem, scales_of: EquilibratedSystem | None = None
) -> EquilibratedSystem:
    """Scale a problem so that A has a unit diagonal, B unit columns and C unit rows.

    The factors are positive, so that neither signs nor the contact set change. If a system
    `scales_of` is given, the factors of this system are used.
    """
    A, q, B, C, h = problem
    n, k = B.shape
    rows, columns = (
        _row_and_column_scales(problem)
        if scales_of is None
        else (scales_of.row_scales, scales_of.column_scales)
    )
    K = np.zeros((n + k, n + k))
    np.multiply(A, rows[:n, None], out=K[:n, :n])
    K[:n, n:] = B * rows[:n, None]
    K[n:, :n] = C * columns[:n] * rows[n:, None]
    # The columns are scaled in place: with many nodes half of the time would go into new memory.
    gap_rows = K[:n]
    gap_rows *= columns
    r = rows * np.concatenate([q, -h])
    return EquilibratedSystem(K, r, rows, columns, n)


def _row_and_column_scales(problem: ContactProblem) -> tuple[Floats, Floats]:
    """The factors (n + k,) of the rows and of the columns that equilibrate a problem."""
    A, _, B, C, _ = problem
    k = B.shape[1]
    # A has a unit diagonal, and the largest entry of each mode is 1.
    of_nodes = 1 / np.sqrt(np.maximum(np.abs(A.diagonal()), TINY))
    modes = np.concatenate([B, C.T], axis=1)
    largest = np.abs(modes * of_nodes[:, None]).max(axis=0)
    of_modes = 1 / np.maximum(largest, TINY)
    rows = np.concatenate([of_nodes, of_modes[k:]])
    return rows, np.concatenate([of_nodes, of_modes[:k]])


def condition_number(problem: ContactProblem, active: Bools) -> float:
    """The condition number, in the 1-norm, of the equilibrated equations on a contact set (n,).

    LAPACK's gecon estimates the condition number from the factors.
    """
    system = equilibrate_problem(problem)
    unknowns = np.flatnonzero(system.free_unknowns(active))
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
        self._factors = _factorise_transposed(matrix)

    def solve(self, r: Floats) -> Floats:
        """Solve r + K x = 0 for the free unknowns; r and x are (n + k,) or (n + k, m)."""
        x = np.zeros(r.shape)
        x[self._free_numbers] = self._solve_free_unknowns(-r[self._free_numbers])
        return x

    @property
    def determinant_sign(self) -> int:
        """The sign of the determinant, +1 or -1."""
        return _determinant_sign(self._factors)

    def _solve_free_unknowns(self, right: Floats) -> Floats:
        """Solve for the free unknowns alone, under a right-hand side with a row for each."""
        return _solve_with_factors(self._factors, right)


class BorderedEquations(ContactSetEquations):
    """The equations of a contact set that differs by a few nodes from a factorised `base`.

    A bordered system adds two kinds of unknowns to the base. The weighted gaps of the released
    nodes make the pressures of these nodes vanish. The pressures of the added nodes make the
    weighted gaps of these nodes vanish. Only the small Schur complement of the border is
    factorised.
    """

    def __init__(self, base: ContactSetEquations, K: Floats, free: Bools) -> None:
        self.free = free
        self._base_equations = base
        self._released = np.flatnonzero(~free[base._free_numbers])
        added = np.flatnonzero(free & ~base.free)
        self._free_numbers = np.concatenate([base._free_numbers, added])
        released = len(self._released)
        # The border's columns: a unit gap at each released node, then the added pressures.
        border = np.zeros((len(base._free_numbers), released + len(added)))
        border[self._released, np.arange(released)] = -1.0
        border[:, released:] = K[base._free_numbers[:, None], added]
        self._base_solution_per_border_unknown = -base._solve_free_unknowns(border)
        self._rows_of_added_nodes = K[added[:, None], base._free_numbers]
        schur = self._pressures_and_gaps_at_border(self._base_solution_per_border_unknown)
        schur[released:, released:] += K[added[:, None], added]
        self._schur_factors = _factorise_transposed(schur)

    @property
    def determinant_sign(self) -> int:
        """The sign of the determinant: the product of the signs of base and Schur complement.

        The product holds for released nodes too, by Jacobi's complementary minor.
        """
        return self._base_equations.determinant_sign * _determinant_sign(self._schur_factors)

    def _pressures_and_gaps_at_border(self, solution: Floats) -> Floats:
        """The pressures of released nodes and then the weighted gaps of added nodes.

        `solution` is a solution of the base.
        """
        return np.concatenate([solution[self._released], self._rows_of_added_nodes @ solution])

    def _solve_free_unknowns(self, right: Floats) -> Floats:
        size, released = len(self._base_equations._free_numbers), len(self._released)
        solution = self._base_equations._solve_free_unknowns(right[:size])
        # The border's unknowns bring pressures to zero and gaps to the wanted right-hand side.
        no_pressure = np.zeros((released, *right.shape[1:]))
        wanted = np.concatenate([no_pressure, right[size:]])
        border = _solve_with_factors(
            self._schur_factors, wanted - self._pressures_and_gaps_at_border(solution)
        )
        solution += self._base_solution_per_border_unknown @ border
        solution[self._released] = 0.0
        return np.concatenate([solution, border[released:]])


def resists_all_rigid_body_modes(
    equations: ContactSetEquations, system: EquilibratedSystem
) -> bool:
    """Whether the contact resists every rigid-body mode.

    The contact resists if det A > 0 and C A^-1 B has no negative real eigenvalue. Contact without
    friction always resists.
    """
    n = system.n
    k = len(system.r) - n
    if equations.determinant_sign != (-1) ** k:
        return False
    if k < 2:
        return True
    # The modes' motions under unit generalised forces are (C A^-1 B)^-1.
    unit_forces = np.vstack([np.zeros((n, k)), np.diag(system.row_scales[n:])])
    motions = equations.solve(unit_forces)[n:]
    yielding = system.column_scales[n:, None] * motions
    # Each mode has a unit of its own. Scaling makes the eigenvalues independent of the units and
    # leaves their signs; a mode with a vanishing diagonal needs no scale.
    size = np.sqrt(np.abs(np.diagonal(yielding)))
    size[size == 0] = 1.0
    values = np.linalg.eigvals(yielding / np.outer(size, size))
    return not ((values.imag == 0) & (values.real < 0)).any()


def _factorise_transposed(matrix: Floats) -> tuple[Floats, Ints]:
    """Factorise the transposed matrix into LU factors and pivots, and overwrite the matrix.

    The transposed matrix lies column by column in memory, as LAPACK wants a matrix. Raises NoAnswer
    for a singular matrix.
    """
    if not matrix.size:
        return matrix, np.zeros(0, dtype=np.int32)
    lu, pivots, info = dgetrf(matrix.T, overwrite_a=True)
    if info or not np.isfinite(lu.diagonal()).all():
        raise NoAnswer("no equilibrium: the contact cannot balance the actuation")
    return lu, pivots


def _solve_with_factors(factors: tuple[Floats, Ints], right: Floats) -> Floats:
    """Solve the equations with LU factors and pivots for a right-hand side."""
    # LAPACK is called directly, since scipy's checks cost more than these small systems.
    return dgetrs(*factors, right, trans=1)[0] if len(right) else right


def _determinant_sign(factors: tuple[Floats, Ints]) -> int:
    """The sign of the determinant, which each negative pivot and each swap of rows changes."""
    lu, pivots = factors
    swaps = np.count_nonzero(pivots != np.arange(len(pivots)))
    negative = np.count_nonzero(lu.diagonal() < 0)
    return 1 if (negative + swaps) % 2 == 0 else -1


def is_bordering_cheaper(base: ContactSetEquations, free: Bools) -> bool:
    """Whether bordering `base` costs less than factorising the free unknowns `free` (n + k,)."""
    size = len(base._free_numbers)
    changed = np.count_nonzero(base.free ^ free)
    # Bordering pays up to a change of one unknown in eight.
    return size > BORDERED_ABOVE_UNKNOWNS and bool(8 * changed < size)
