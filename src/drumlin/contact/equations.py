"""The linear equations of a contact set: equilibrated, factorised once, bordered where a set
changes by few nodes.

On the nodes that touch w = q + A p + B y = 0, off them p = 0, and C p = h: one matrix [[A, B], [C,
0]] on the set.
"""

from typing import NamedTuple

import numpy as np

from drumlin.arrays import Bools, Floats, Ints
from drumlin.errors import NoAnswer
from drumlin.lapack import dgecon, dgetrf, dgetrs

TINY = np.finfo(float).tiny
BORDERED_ABOVE = 100
"""Unknowns of a set up to which factorising another one is as fast as bordering: with 50 to 400
solves take the same time to 4 %. Without bordering those of 300 and 700 elements take 1.15 and 1.24
times it.
"""


class Problem(NamedTuple):
    """A contact problem: the matrices and vectors of the equations above."""

    A: Floats
    q: Floats
    B: Floats
    C: Floats
    h: Floats


class EquilibratedSystem(NamedTuple):
    """A problem as w = r + K x with x = (p, y), K = [[A, B], [C, 0]], r = (q, -h), equilibrated.

    Its rows and columns are multiplied by `down` and `across` (n + k,): w = w'/down, x = across x'.
    """

    K: Floats
    r: Floats
    down: Floats
    across: Floats
    n: int

    @property
    def problem(self) -> Problem:
        """Its parts."""
        K, r, n = self.K, self.r, self.n
        return Problem(K[:n, :n], r[:n], K[:n, n:], K[n:, :n], -r[n:])

    def on(self, active: Bools) -> Bools:
        """The unknowns (n + k,) of a contact set (n,): its pressures and all motions."""
        on = np.empty(len(self.r), dtype=bool)
        on[: self.n], on[self.n :] = active, True
        return on


def equilibrated(problem: Problem, like: EquilibratedSystem | None = None) -> EquilibratedSystem:
    """The problem with unit diagonal of A, unit columns of B and rows of C, or with the scales that
    these have in a problem `like` it. Signs, and so the answer, stay.
    """
    A, q, B, C, h = problem
    n, k = B.shape
    down, across = _scales(problem) if like is None else (like.down, like.across)
    K = np.zeros((n + k, n + k))
    np.multiply(A, down[:n, None], out=K[:n, :n])
    K[:n, n:], K[n:, :n] = B * down[:n, None], C * across[:n] * down[n:, None]
    rows = K[:n]
    rows *= across  # in place: where there are many nodes, half of the time is that of new memory
    return EquilibratedSystem(K, down * np.concatenate([q, -h]), down, across, n)


def _scales(problem: Problem) -> tuple[Floats, Floats]:
    """By what the rows and the columns of a problem are multiplied (n + k,), `down` and `across` of
    System.
    """
    A, _, B, C, _ = problem
    d = 1 / np.sqrt(np.maximum(np.abs(A.diagonal()), TINY))
    size = 1 / np.maximum(np.abs(np.concatenate([B, C.T], axis=1) * d[:, None]).max(axis=0), TINY)
    k = B.shape[1]
    return np.concatenate([d, size[k:]]), np.concatenate([d, size[:k]])


def condition(problem: Problem, active: Bools) -> float:
    """Condition in the 1-norm, estimated by LAPACK's gecon, of the equilibrated equations on a
    contact set (n,).
    """
    system = equilibrated(problem)
    on = np.flatnonzero(system.on(active))
    matrix = system.K[on[:, None], on]
    if not matrix.size:
        return 1.0
    lu, _, _ = dgetrf(matrix)
    reciprocal, _ = dgecon(lu, np.abs(matrix).sum(axis=0).max())
    return float(1 / reciprocal) if reciprocal else np.inf


class Equations:
    """The linear equations of the unknowns `on` (n + k,) of K, the others being 0: factorised once.

    Unknowns that differ from factorised ones by a few need no factorisation of their own, see
    `Changed`.
    """

    def __init__(self, K: Floats, on: Bools) -> None:
        self.on, self._at = on, on.nonzero()[0]
        self._factors = _factorised(
            K.copy() if len(self._at) == len(K) else K.take(self._at, 0).take(self._at, 1)
        )

    def solve(self, r: Floats) -> Floats:
        """x of r + K x = 0 on the unknowns; r, x (n + k,) or (n + k, m)."""
        x = np.zeros(r.shape)
        x[self._at] = self._solution(-r[self._at])
        return x

    @property
    def sign(self) -> int:
        """The determinant's."""
        return _determinant_sign(self._factors)

    def _solution(self, right: Floats) -> Floats:
        return _back(self._factors, right)


class Changed(Equations):
    """The equations of factorised unknowns with a few of them released and a few others added, by a
    bordered system.

    Its further unknowns are the weighted gaps of the released nodes, which make their pressures
    vanish, and the pressures of the added ones, which make their weighted gaps vanish.
    """

    def __init__(self, base: Equations, K: Floats, on: Bools) -> None:
        self.on, self._base = on, base
        self._out = np.flatnonzero(~on[base._at])
        added = np.flatnonzero(on & ~base.on)
        self._at = np.concatenate([base._at, added])
        out = len(self._out)
        border = np.zeros((len(base._at), out + len(added)))
        border[self._out, np.arange(out)] = -1.0
        border[:, out:] = K[base._at[:, None], added]
        self._spread = -base._solution(border)
        self._rows = K[added[:, None], base._at]
        inner = self._across(self._spread)
        inner[out:, out:] += K[added[:, None], added]
        self._inner = _factorised(inner)

    @property
    def sign(self) -> int:
        """The determinant's, by Schur, and Jacobi's complementary minor."""
        return self._base.sign * _determinant_sign(self._inner)

    def _across(self, solution: Floats) -> Floats:
        """Pressures of the released nodes and weighted gaps of the added ones, of unknowns of the
        base.
        """
        return np.concatenate([solution[self._out], self._rows @ solution])

    def _solution(self, right: Floats) -> Floats:
        size, out = len(self._base._at), len(self._out)
        solution = self._base._solution(right[:size])
        wanted = np.concatenate([np.zeros((out, *right.shape[1:])), right[size:]])
        border = _back(self._inner, wanted - self._across(solution))
        solution += self._spread @ border
        solution[self._out] = 0.0
        return np.concatenate([solution, border[out:]])


def regular(equations: Equations, system: EquilibratedSystem) -> bool:
    """Whether no motion has lost its resistance: det A > 0 and C A^-1 B without negative
    eigenvalue.
    """
    n = system.n
    k = len(system.r) - n
    if equations.sign != (-1) ** k:
        return False
    if k < 2:
        return True
    unit = np.vstack([np.zeros((n, k)), np.diag(system.down[n:])])
    yielding = system.across[n:, None] * equations.solve(unit)[n:]  # (C A^-1 B)^-1
    size = np.sqrt(
        np.abs(np.diagonal(yielding))
    )  # motions have units of their own: nothing may hang on these
    # scaling leaves the signs of eigenvalues as they are, so that a motion without a size of its
    # own needs none
    size[size == 0] = 1.0
    values = np.linalg.eigvals(yielding / np.outer(size, size))
    return not ((values.imag == 0) & (values.real < 0)).any()


def _factorised(matrix: Floats) -> tuple[Floats, Ints]:
    """LU factors and pivots of the transposed matrix, row by row in memory, in its place; raises
    NoAnswer for a singular one.
    """
    if not matrix.size:
        return matrix, np.zeros(0, dtype=np.int32)
    lu, pivots, info = dgetrf(matrix.T, overwrite_a=True)
    if info or not np.isfinite(lu.diagonal()).all():
        raise NoAnswer("no equilibrium: the contact cannot balance the actuation")
    return lu, pivots


def _back(factors: tuple[Floats, Ints], right: Floats) -> Floats:
    """Back-substitution; LAPACK directly, since scipy's checks cost more than these small systems."""
    return dgetrs(*factors, right, trans=1)[0] if len(right) else right


def _determinant_sign(factors: tuple[Floats, Ints]) -> int:
    lu, pivots = factors
    swaps = np.count_nonzero(pivots != np.arange(len(pivots)))
    return 1 if (np.count_nonzero(lu.diagonal() < 0) + swaps) % 2 == 0 else -1


def few_changed(base: Equations, on: Bools) -> bool:
    """Whether unknowns differ from factorised ones by few, and are many: then it is cheaper to
    border those.
    """
    return len(base._at) > BORDERED_ABOVE and bool(
        8 * np.count_nonzero(base.on ^ on) < len(base._at)
    )
