"""Scale and factorise the linear equations of a contact set.

The contact problem has n nodes and k rigid-body modes. In a node of the contact set the weighted
gap vanishes, w = q + A p + B y = 0. In all other nodes the pressure vanishes, p = 0. The pressures
balance the actuation, C p = h. On a contact set both are one linear system with the matrix
[[A, B], [C, 0]], restricted to the rows and columns of the set.

The system is equilibrated and factorised once. A set that differs by a few nodes reuses the factors
through a bordered system.
"""

from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.base.lapack import dgecon, dgetrf, dgetrs

TINY = np.finfo(float).tiny
"""Smallest normal double. Divisors are at least TINY, so that an empty row does not divide by 0."""

BORDERED_ABOVE = 100
"""Unknowns of a contact set above which a changed set is bordered rather than factorised anew.

Below it a factorisation is as fast as bordering. Measured by trials: with 50 to 400 the time of a
solve stays within 4 %. Without bordering, solves of 300 and 700 elements take 1.15 and 1.24 times
as long.
"""


class Problem(NamedTuple):
    """A contact problem: w = q + A p + B y and C p = h.

    Attributes
    ----------
    A : (n, n), gap that closes per pressure (compliance); unsymmetric with friction
    q : (n,), weighted gaps of the unloaded contact
    B : (n, k), gap that opens per unit of a rigid-body mode
    C : (k, n), generalised force of a pressure in a mode's equilibrium
    h : (k,), generalised force of the actuation
    """

    A: Floats
    q: Floats
    B: Floats
    C: Floats
    h: Floats


class EquilibratedSystem(NamedTuple):
    """A contact problem as r + K x with x = (p, y), K = [[A, B], [C, 0]] and r = (q, -h), scaled.

    Attributes
    ----------
    K : (n + k, n + k), the scaled matrix
    r : (n + k,), the scaled right-hand side
    row_scales : (n + k,), factors of the rows: w = w_scaled / row_scales
    column_scales : (n + k,), factors of the columns: x = column_scales * x_scaled
    n : number of nodes
    """

    K: Floats
    r: Floats
    row_scales: Floats
    column_scales: Floats
    n: int

    @property
    def problem(self) -> Problem:
        """The scaled contact problem, as views of K and r."""
        K, r, n = self.K, self.r, self.n
        return Problem(K[:n, :n], r[:n], K[:n, n:], K[n:, :n], -r[n:])

    def on(self, active: Bools) -> Bools:
        """The unknowns (n + k,) of a contact set (n,): its pressures and all rigid-body modes."""
        unknowns = np.empty(len(self.r), dtype=bool)
        unknowns[: self.n] = active
        unknowns[self.n :] = True
        return unknowns


class Scales(NamedTuple):
    """Factors (n + k,) by which the `rows` and the `columns` of a problem are multiplied."""

    rows: Floats
    columns: Floats


def equilibrated(problem: Problem, like: EquilibratedSystem | None = None) -> EquilibratedSystem:
    """Scale a problem so that A has a unit diagonal, B unit columns and C unit rows.

    With `like` the factors of that system are used instead. The factors are positive, so that
    neither the signs nor the contact set change.
    """
    A, q, B, C, h = problem
    n, k = B.shape
    rows, columns = _scales(problem) if like is None else (like.row_scales, like.column_scales)
    K = np.zeros((n + k, n + k))
    np.multiply(A, rows[:n, None], out=K[:n, :n])
    K[:n, n:] = B * rows[:n, None]
    K[n:, :n] = C * columns[:n] * rows[n:, None]
    # The columns are scaled in place: with many nodes half of the time would go into new memory.
    gap_rows = K[:n]
    gap_rows *= columns
    r = rows * np.concatenate([q, -h])
    return EquilibratedSystem(K, r, rows, columns, n)


def _scales(problem: Problem) -> Scales:
    """The factors that equilibrate a problem."""
    A, _, B, C, _ = problem
    k = B.shape[1]
    of_nodes = 1 / np.sqrt(np.maximum(np.abs(A.diagonal()), TINY))
    modes = np.concatenate([B, C.T], axis=1)
    largest = np.abs(modes * of_nodes[:, None]).max(axis=0)
    of_modes = 1 / np.maximum(largest, TINY)
    return Scales(
        rows=np.concatenate([of_nodes, of_modes[k:]]),
        columns=np.concatenate([of_nodes, of_modes[:k]]),
    )


def condition(problem: Problem, active: Bools) -> float:
    """Condition number, in the 1-norm, of the equilibrated equations on a contact set (n,).

    LAPACK's gecon estimates it from the factors.
    """
    system = equilibrated(problem)
    unknowns = np.flatnonzero(system.on(active))
    matrix = system.K[unknowns[:, None], unknowns]
    if not matrix.size:
        return 1.0
    lu, _, _ = dgetrf(matrix)
    norm = np.abs(matrix).sum(axis=0).max()
    reciprocal, _ = dgecon(lu, norm)
    return float(1 / reciprocal) if reciprocal else np.inf


class Equations:
    """The linear equations of the unknowns `on` (n + k,) of K, factorised once.

    All other unknowns are 0. `Changed` solves for unknowns that differ from these by a few.
    """

    def __init__(self, K: Floats, on: Bools) -> None:
        self.on = on
        self._at = on.nonzero()[0]
        whole = len(self._at) == len(K)
        matrix = K.copy() if whole else K.take(self._at, 0).take(self._at, 1)
        self._factors = _factorised(matrix)

    def solve(self, r: Floats) -> Floats:
        """Solve r + K x = 0 for the unknowns; r and x are (n + k,) or (n + k, m)."""
        x = np.zeros(r.shape)
        x[self._at] = self._solution(-r[self._at])
        return x

    @property
    def sign(self) -> int:
        """Sign of the determinant, +1 or -1."""
        return _determinant_sign(self._factors)

    def _solution(self, right: Floats) -> Floats:
        """Solve for the unknowns alone, under a right-hand side of as many rows."""
        return _back(self._factors, right)


class Changed(Equations):
    """The equations of a contact set that differs by a few nodes from a factorised `base`.

    A bordered system adds two kinds of unknowns to the base. The weighted gaps of the released
    nodes make their pressures vanish. The pressures of the added nodes make their weighted gaps
    vanish. Only the small Schur complement of the border is factorised.
    """

    def __init__(self, base: Equations, K: Floats, on: Bools) -> None:
        self.on = on
        self._base = base
        self._released = np.flatnonzero(~on[base._at])
        added = np.flatnonzero(on & ~base.on)
        self._at = np.concatenate([base._at, added])
        released = len(self._released)
        # The border's columns: a unit gap at each released node, then the added pressures.
        border = np.zeros((len(base._at), released + len(added)))
        border[self._released, np.arange(released)] = -1.0
        border[:, released:] = K[base._at[:, None], added]
        self._spread = -base._solution(border)
        self._rows = K[added[:, None], base._at]
        schur = self._across(self._spread)
        schur[released:, released:] += K[added[:, None], added]
        self._schur = _factorised(schur)

    @property
    def sign(self) -> int:
        """Sign of the determinant: the base's times the Schur complement's.

        For released nodes it follows from Jacobi's complementary minor.
        """
        return self._base.sign * _determinant_sign(self._schur)

    def _across(self, solution: Floats) -> Floats:
        """Pressures of the released nodes, then weighted gaps of the added nodes.

        Both follow from a solution of the base.
        """
        return np.concatenate([solution[self._released], self._rows @ solution])

    def _solution(self, right: Floats) -> Floats:
        size, released = len(self._base._at), len(self._released)
        solution = self._base._solution(right[:size])
        # The border's unknowns bring pressures to zero and gaps to the wanted right-hand side.
        no_pressure = np.zeros((released, *right.shape[1:]))
        wanted = np.concatenate([no_pressure, right[size:]])
        border = _back(self._schur, wanted - self._across(solution))
        solution += self._spread @ border
        solution[self._released] = 0.0
        return np.concatenate([solution, border[released:]])


def regular(equations: Equations, system: EquilibratedSystem) -> bool:
    """Whether the contact resists every rigid-body mode.

    It does where det A > 0 and C A^-1 B has no negative real eigenvalue. Without friction this
    always holds.
    """
    n = system.n
    k = len(system.r) - n
    if equations.sign != (-1) ** k:
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


def _factorised(matrix: Floats) -> tuple[Floats, Ints]:
    """LU factors and pivots of the transposed matrix, written over the matrix.

    The transposed matrix is the one that lies column by column in memory, as LAPACK wants it.
    Raises NoAnswer for a singular matrix.
    """
    if not matrix.size:
        return matrix, np.zeros(0, dtype=np.int32)
    lu, pivots, info = dgetrf(matrix.T, overwrite_a=True)
    if info or not np.isfinite(lu.diagonal()).all():
        raise NoAnswer("no equilibrium: the contact cannot balance the actuation")
    return lu, pivots


def _back(factors: tuple[Floats, Ints], right: Floats) -> Floats:
    """Solve by back-substitution.

    LAPACK is called directly, since scipy's checks cost more than these small systems.
    """
    return dgetrs(*factors, right, trans=1)[0] if len(right) else right


def _determinant_sign(factors: tuple[Floats, Ints]) -> int:
    """Sign of the determinant: each negative pivot and each swap of rows changes it."""
    lu, pivots = factors
    swaps = np.count_nonzero(pivots != np.arange(len(pivots)))
    negative = np.count_nonzero(lu.diagonal() < 0)
    return 1 if (negative + swaps) % 2 == 0 else -1


def few_changed(base: Equations, on: Bools) -> bool:
    """Whether bordering is cheaper than factorising the unknowns `on` (n + k,) anew."""
    size = len(base._at)
    changed = np.count_nonzero(base.on ^ on)
    # Bordering pays up to a change of one unknown in eight.
    return size > BORDERED_ABOVE and bool(8 * changed < size)
