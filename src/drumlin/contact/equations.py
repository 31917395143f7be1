"""The linear equations of a contact set: equilibrated, factorised once, bordered where a set changes by few nodes.

On the nodes that touch w = q + A p + B y = 0, off them p = 0, and C p = h: one matrix [[A, B], [C, 0]] on the set.
"""

from typing import NamedTuple

import numpy as np

from drumlin.arrays import Bools, Floats, Ints
from drumlin.errors import NoAnswer
from drumlin.lapack import dgecon, dgetrf, dgetrs


class Problem(NamedTuple):
    """A contact problem: the matrices and vectors of the equations above."""

    A: Floats
    q: Floats
    B: Floats
    C: Floats
    h: Floats


class Scales(NamedTuple):
    """What undoes the equilibration: p = pressure p', y = motion y'; C p = h was multiplied by `balance` (k,)."""

    pressure: Floats
    motion: Floats
    balance: Floats


def equilibrated(problem: Problem) -> tuple[Problem, Scales]:
    """The problem with unit diagonal of A, unit columns of B and rows of C. Signs, and so the answer, stay."""
    A, q, B, C, h = problem
    tiny = np.finfo(float).tiny
    d = 1 / np.sqrt(np.maximum(np.abs(np.diagonal(A)), tiny))
    column = 1 / np.maximum(np.abs(d[:, None] * B).max(axis=0), tiny)
    row = 1 / np.maximum(np.abs(C * d).max(axis=1), tiny)
    even = d[:, None] * A
    even *= d  # in place: where there are many nodes, half of the time is that of new memory
    scaled = Problem(even, d * q, d[:, None] * B * column, row[:, None] * C * d, row * h)
    return scaled, Scales(d, column, row)


def matrix_on(problem: Problem, active: Bools) -> Floats:
    """The matrix (m + k, m + k) of w = 0 on the m nodes of a contact set and of C p = h, column by column in memory."""
    A, _, B, C, _ = problem
    on = np.flatnonzero(active)
    size, k = len(on), B.shape[1]
    matrix = np.zeros((size + k, size + k), order="F")
    matrix[:size, :size] = A if size == len(A) else A[np.ix_(on, on)]
    matrix[:size, size:] = B[on]
    matrix[size:, :size] = C[:, on]
    return matrix


def condition(problem: Problem, active: Bools) -> float:
    """Condition in the 1-norm, estimated by LAPACK's gecon, of the equilibrated equations on a contact set (n,)."""
    matrix = matrix_on(equilibrated(problem)[0], active)
    if not matrix.size:
        return 1.0
    lu, _, _ = dgetrf(matrix)
    reciprocal, _ = dgecon(lu, np.abs(matrix).sum(axis=0).max())
    return float(1 / reciprocal) if reciprocal else np.inf


class Equations:
    """The linear equations w = 0 on a contact set, p = 0 off it, C p = h: factorised once.

    A set that differs from a factorised one by a few nodes needs no factorisation of its own, see `Changed`.
    """

    def __init__(self, problem: Problem, active: Bools) -> None:
        self.active, self._on, self._n = active, np.flatnonzero(active), len(problem.q)
        self._factors = _factorised(matrix_on(problem, active))
        self.sign = _determinant_sign(self._factors)

    def solve(self, q: Floats, h: Floats) -> tuple[Floats, Floats]:
        """p (n,) and y (k,)."""
        solution = self._solution(np.concatenate([-q[self._on], h]))
        p = np.zeros(self._n)
        p[self._on] = solution[: len(self._on)]
        return p, solution[len(self._on) :]

    def regular(self, scales: "Scales") -> bool:
        """Whether no motion has lost its resistance: det A > 0 and C A^-1 B without negative eigenvalue."""
        k = len(scales.motion)
        if self.sign != (-1) ** k:
            return False
        if k < 2:
            return True
        unit = np.vstack([np.zeros((len(self._on), k)), np.diag(scales.balance)])
        yielding = scales.motion[:, None] * -self._solution(unit)[-k:]  # (C A^-1 B)^-1
        size = np.sqrt(np.abs(np.diagonal(yielding)))  # motions have units of their own: nothing may hang on these
        values = np.linalg.eigvals(yielding / np.outer(size, size))
        return not ((values.imag == 0) & (values.real < 0)).any()

    def _solution(self, right: Floats) -> Floats:
        return _back(self._factors, right)


class Changed(Equations):
    """The equations of a factorised set with a few of its nodes released and a few others added, by a bordered system.

    Its further unknowns are the weighted gaps of the released nodes, which make their pressures vanish, and the
    pressures of the added ones, which make their weighted gaps vanish.
    """

    def __init__(self, base: Equations, problem: Problem, active: Bools) -> None:
        self.active, self._base, self._n = active, base, base._n
        self._out = np.flatnonzero(~active[base._on])
        self._in = np.flatnonzero(active & ~base.active)
        self._on = np.concatenate([base._on, self._in])
        size, out, added = len(base._on), len(self._out), self._in
        border = np.zeros((len(base._factors[0]), out + len(added)))
        border[self._out, np.arange(out)] = -1.0
        border[:size, out:] = problem.A[np.ix_(base._on, added)]
        border[size:, out:] = problem.C[:, added]
        self._spread = -base._solution(border)
        self._rows = np.hstack([problem.A[np.ix_(added, base._on)], problem.B[added]])
        inner = self._across(self._spread)
        inner[out:, out:] += problem.A[np.ix_(added, added)]
        self._inner = _factorised(inner)
        self.sign = base.sign * _determinant_sign(self._inner)  # Schur; Jacobi's complementary minor

    def _across(self, solution: Floats) -> Floats:
        """Pressures of the released nodes and weighted gaps of the added ones, of pressures in the base."""
        return np.concatenate([solution[self._out], self._rows @ solution])

    def _solution(self, right: Floats) -> Floats:
        size, added = len(self._base._on), len(self._in)
        solution = self._base._solution(np.concatenate([right[:size], right[size + added :]]))
        wanted = np.concatenate([np.zeros((len(self._out), *right.shape[1:])), right[size : size + added]])
        border = _back(self._inner, wanted - self._across(solution))
        solution += self._spread @ border
        solution[self._out] = 0.0
        return np.concatenate([solution[:size], border[len(self._out) :], solution[size:]])


def _factorised(matrix: Floats) -> tuple[Floats, Ints]:
    """LU factors and pivots, in the place of the matrix where LAPACK can; raises NoAnswer for a singular one."""
    if not matrix.size:
        return matrix, np.zeros(0, dtype=np.int32)
    lu, pivots, info = dgetrf(matrix, overwrite_a=True)
    if info or not np.isfinite(np.diagonal(lu)).all():
        raise NoAnswer("no equilibrium: the contact cannot balance the actuation")
    return lu, pivots


def _back(factors: tuple[Floats, Ints], right: Floats) -> Floats:
    """Back-substitution; LAPACK directly, since scipy's checks cost more than these small systems."""
    return dgetrs(*factors, right)[0] if len(right) else right


def _determinant_sign(factors: tuple[Floats, Ints]) -> int:
    lu, pivots = factors
    swaps = np.count_nonzero(pivots != np.arange(len(pivots)))
    return int(np.prod(np.sign(np.diagonal(lu))) * (-1) ** swaps)


def few_changed(base: Equations, active: Bools) -> bool:
    """Whether a set differs from a factorised one by few nodes: then it is cheaper to border that one."""
    return bool(8 * np.count_nonzero(base.active ^ active) < np.count_nonzero(base.active))
