"""The paper's own way to the same answer: displacements as unknowns, contact revised until it
agrees.

For every station inside the beam (12), for every sector (17), and M_0 = 0 (19), with k* = k where
the sector is pressed, t = w cos(theta) - z - Delta > 0, and else k* = 0 (20). The terms in z and
Delta have the signs that follow from t; they are printed with that of the terms in w.
"""

from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.foundation.model import ring_of
from drumlin.foundation.post import Post, post

MOST_REVISIONS = 100


class Iterated(NamedTuple):
    """Displacements w (m,) [m] at the stations, z (n,) [m] and forces N (n,) [N] at the sectors;
    rounds taken.
    """

    w: Floats
    z: Floats
    N: Floats
    rounds: int


def iterate(brake: Brake, index: int, sections: int) -> Iterated:
    """Shoe `index` by the paper's iteration, with all of the paper's simplifications.

    Raises NoAnswer where the contact does not settle or the equations are singular.
    """
    p = post(brake, brake.shoes[index], sections, tilt=False, wedge=False, plane_stress=False)
    theta = p.axis.origin + p.axis.sense * p.theta
    c = ring_of(brake, theta, theta, frozenset())
    pressed = np.ones(len(p.theta), dtype=bool)
    for rounds in range(1, MOST_REVISIONS + 1):
        w, z = _displacements(p, c, np.where(pressed, p.k, 0.0))
        t = w[p.under] * np.cos(p.theta) - z - p.gap
        if np.array_equal(t > 0, pressed):
            return Iterated(w, z, np.where(pressed, p.k * t, 0.0), rounds)
        pressed = t > 0
    raise NoAnswer(
        f"shoe {brake.shoes[index].name!r}: not converged: the contact still changes after {rounds} rounds"
    )


def _displacements(p: Post, c: Floats, k: Floats) -> tuple[Floats, Floats]:
    """w (m,) and z (n,) [m] for the spring stiffnesses k* (n,) [N/m] and the ring c (n, n) [m/N]."""
    m, n = p.pressed.shape
    bent = (p.pressed + p.drag * p.dragged) * k  # B of eq. 11, times dx
    matrix, right = np.zeros((m + n, m + n)), np.zeros(m + n)
    inner = np.arange(1, m - 1)
    before, after = np.diff(p.x)[:-1], np.diff(p.x)[1:]
    stiff = p.EI[inner] / p.step[inner]
    matrix[inner, inner - 1] = stiff / before
    matrix[inner, inner] = -stiff * (1 / before + 1 / after)
    matrix[inner, inner + 1] = stiff / after
    matrix[np.ix_(inner, p.under)] += bent[inner] * np.cos(p.theta)
    matrix[inner, m:] -= bent[inner]
    right[inner] = p.loaded[inner] + bent[inner] @ p.gap
    matrix[0, p.under] = bent[0] * np.cos(p.theta)  # M_0 = 0
    matrix[0, m:] = -bent[0]
    right[0] = p.loaded[0] + bent[0] @ p.gap
    matrix[m - 1, 0] = stiff.mean()  # w_0 = 0
    matrix[m:, p.under] = -(c * k) * np.cos(p.theta)
    matrix[m:, m:] = np.eye(n) + c * k
    right[m:] = -(c * k) @ p.gap
    try:
        solution = np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError as error:
        raise NoAnswer("no equilibrium: the contact cannot balance the actuation") from error
    return solution[:m], solution[m:]
