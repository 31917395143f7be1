"""The complementarity problem of unilateral contact, solved by an active-set (semismooth Newton) method.

Find pressures p and free motions y such that

    w = q + A p + B y,    p >= 0,  w >= 0,  p w = 0,       C p = h

p (n,): nodal pressures; w (n,): weighted gaps; A (n, n): compliance, unsymmetric with friction, the penalty
included as a compliance M/eps (zero for an infinite penalty); y (k,): what equilibrium leaves free, for a
hinged shoe its rotation; C p = h: the equilibrium in these motions.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from drumlin.brake import Floats
from drumlin.errors import NoAnswer

Bools = np.ndarray[tuple[int], np.dtype[np.bool_]]

MOST_STEPS = 60
SLACK = 1e-12  # relative: a pressure or gap below it is round-off, and does not change the contact set


@dataclass(frozen=True)
class Contact:
    """Solution of a contact problem. `p` (n,), `w` (n,), `y` (k,), `active` (n,): the contact set.

    `regular`: the determinant on the contact set has the sign that it has without friction. Followed from
    mu = 0 it changes where the brake locks itself.
    """

    p: Floats
    w: Floats
    y: Floats
    active: Bools
    steps: int
    regular: bool


def solve(A: Floats, q: Floats, B: Floats, C: Floats, h: Floats, start: Bools | None = None) -> Contact:
    """Solve the complementarity problem above from the contact set `start` (all nodes if None).

    Raises NoAnswer where no contact set is consistent: nothing balances the actuation, or not converged.
    """
    n, k = B.shape
    d, column, row = _scales(A, B, C)
    A, q, B = d[:, None] * A * d, d * q, d[:, None] * B * column
    C, h = row[:, None] * C * d, row * h

    active = np.ones(n, dtype=bool) if start is None else start.copy()
    seen: set[bytes] = set()
    for step in range(1, MOST_STEPS + 1):
        if not active.any():
            active = _first_touch(q, B, C, h)
        p, y, sign = _balance(A, q, B, C, h, active)
        w = q + A @ p + B @ y
        w[active] = 0.0
        p_slack = SLACK * np.abs(p).max(initial=0.0)
        w_slack = SLACK * max(np.abs(q).max(), np.abs(B @ y).max(initial=0.0), np.abs(A @ p).max())
        leave, enter = active & (p < -p_slack), ~active & (w < -w_slack)
        if not (leave | enter).any():
            return Contact(np.maximum(p, 0.0) * d, w / d, y * column, active, step, sign == (-1) ** k)
        change = leave | enter
        if active.tobytes() in seen:  # a cycle: exchange one node at a time, the first (Murty's rule)
            change = np.arange(n) == np.flatnonzero(change)[0]
        seen.add(active.tobytes())
        active = active ^ change
    raise NoAnswer(f"not converged: the contact set still changes after {MOST_STEPS} steps")


def tangent(A: Floats, q: Floats, B: Floats, C: Floats, active: Bools) -> Floats:
    """Change of p (n,) where the contact set stays and the weighted gaps change by `q` (n,)."""
    d, column, row = _scales(A, B, C)
    scaled = d[:, None] * A * d, d * q, d[:, None] * B * column, row[:, None] * C * d
    return _balance(*scaled, np.zeros(len(row)), active)[0] * d


def _scales(A: Floats, B: Floats, C: Floats) -> tuple[Floats, Floats, Floats]:
    """Equilibration: A gets a unit diagonal, B unit columns, C unit rows. Signs, and so the answer, stay."""
    tiny = np.finfo(float).tiny
    d = 1 / np.sqrt(np.diagonal(A))
    column = 1 / np.maximum(np.abs(d[:, None] * B).max(axis=0), tiny)
    row = 1 / np.maximum(np.abs(C * d).max(axis=1), tiny)
    return d, column, row


def _balance(
    A: Floats, q: Floats, B: Floats, C: Floats, h: Floats, active: Bools
) -> tuple[Floats, Floats, int]:
    """p and y with w = 0 on the active set, p = 0 off it, and equilibrium; and the determinant's sign."""
    on = np.flatnonzero(active)
    k = B.shape[1]
    matrix = np.zeros((len(on) + k, len(on) + k))
    matrix[: len(on), : len(on)] = A[np.ix_(on, on)]
    matrix[: len(on), len(on) :] = B[on]
    matrix[len(on) :, : len(on)] = C[:, on]
    lu, pivots = scipy.linalg.lu_factor(matrix, check_finite=False)
    diagonal = np.diagonal(lu)
    if not np.all(np.isfinite(diagonal)) or not diagonal.all():
        raise NoAnswer("no equilibrium: the contact cannot balance the actuation")
    sign = int(np.prod(np.sign(diagonal)) * (-1) ** np.count_nonzero(pivots != np.arange(len(pivots))))
    solution = scipy.linalg.lu_solve((lu, pivots), np.concatenate([-q[on], h]), check_finite=False)
    p = np.zeros(len(q))
    p[on] = solution[: len(on)]
    return p, solution[len(on) :], sign


def _first_touch(q: Floats, B: Floats, C: Floats, h: Floats) -> Bools:
    """The node that the actuation closes first when nothing touches: one freedom, or none."""
    if B.shape[1] == 0:
        return np.asarray(q <= q.min())
    if B.shape[1] > 1:
        raise NoAnswer("no equilibrium: nothing touches, and more than one motion is free")
    bearing = C[0] * h[0] > 0  # nodes whose pressure resists the actuation
    if not bearing.any():
        raise NoAnswer("no equilibrium: contact pressure cannot balance the actuation anywhere (self-locking)")
    reach = np.where(bearing, q / np.maximum(np.abs(B[:, 0]), np.finfo(float).tiny), np.inf)
    return np.asarray(reach <= reach.min())
