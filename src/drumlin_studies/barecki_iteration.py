"""The paper's own iteration on displacements, in which the contact is revised until it agrees.

The equations are (12) for each station inside the beam, (17) for each sector, and M_0 = 0 (19). By
(20) a sector has the stiffness k* = k where it is pressed, t = w cos(theta) - z - Delta > 0, and
k* = 0 elsewhere. The terms in z and Delta have the signs that follow from t. The paper prints them
with the sign of the terms in w.
"""

from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.foundation.model import ring_of
from drumlin.foundation.post import Post, post

MOST_REVISIONS = 100
"""Revisions of the contact after which the iteration counts as not converged."""


class IterationAnswer(NamedTuple):
    """The answer of the iteration.

    Attributes
    ----------
    w : array (m,)
        Deflection of the beam at its stations [m].
    z, N : array (n,)
        Displacement of the rim [m] and force [N] at the sectors.
    rounds : int
        Number of revisions.
    """

    w: Floats
    z: Floats
    N: Floats
    rounds: int


def solve_by_paper_iteration(brake: Brake, index: int, sections: int) -> IterationAnswer:
    """The answer of a shoe by the paper's iteration, with all of the paper's simplifications.

    index : number of the shoe; sections : number of sectors along the lining.

    Raises NoAnswer where the contact does not settle or the equations are singular.
    """
    p = post(brake, brake.shoes[index], sections, tilt=False, wedge=False, plane_stress=False)
    theta = p.axis.origin + p.axis.sense * p.theta
    c = ring_of(brake, theta, theta, frozenset())
    # The first guess of the contact is the whole lining.
    pressed = np.ones(len(p.theta), dtype=bool)
    for rounds in range(1, MOST_REVISIONS + 1):
        w, z = _beam_and_rim_displacements(p, c, np.where(pressed, p.k, 0.0))
        t = w[p.under] * np.cos(p.theta) - z - p.gap
        if np.array_equal(t > 0, pressed):
            return IterationAnswer(w, z, np.where(pressed, p.k * t, 0.0), rounds)
        pressed = t > 0
    raise NoAnswer(
        f"shoe {brake.shoes[index].name!r}: not converged: "
        f"the contact still changes after {rounds} rounds"
    )


def _beam_and_rim_displacements(p: Post, c: Floats, k: Floats) -> tuple[Floats, Floats]:
    """Displacements w (m,) and z (n,) [m] for a contact.

    Parameters
    ----------
    p : Post
        The post.
    c : array (n, n)
        Flexibility of the ring [m/N].
    k : array (n,)
        Stiffness k* of the sectors [N/m].
    """
    m, n = p.pressed.shape
    # B of eq. 11, times dx.
    bent = (p.pressed + p.drag * p.dragged) * k
    matrix, right = np.zeros((m + n, m + n)), np.zeros(m + n)
    # Bending of the beam, by second differences of w at the stations inside the beam (eq. 12).
    inner = np.arange(1, m - 1)
    before, after = np.diff(p.x)[:-1], np.diff(p.x)[1:]
    stiff = p.EI[inner] / p.step[inner]
    matrix[inner, inner - 1] = stiff / before
    matrix[inner, inner] = -stiff * (1 / before + 1 / after)
    matrix[inner, inner + 1] = stiff / after
    matrix[np.ix_(inner, p.under)] += bent[inner] * np.cos(p.theta)
    matrix[inner, m:] -= bent[inner]
    right[inner] = p.loaded[inner] + bent[inner] @ p.gap
    # The first row says that the moment M_0 about the hinge vanishes.
    matrix[0, p.under] = bent[0] * np.cos(p.theta)
    matrix[0, m:] = -bent[0]
    right[0] = p.loaded[0] + bent[0] @ p.gap
    # w_0 = 0, scaled to the size of the other equations.
    matrix[m - 1, 0] = stiff.mean()
    # Displacement z of the rim under the forces of all sectors (eq. 17).
    matrix[m:, p.under] = -(c * k) * np.cos(p.theta)
    matrix[m:, m:] = np.eye(n) + c * k
    right[m:] = -(c * k) @ p.gap
    try:
        solution = np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError as error:
        raise NoAnswer("no equilibrium: the contact cannot balance the actuation") from error
    return solution[:m], solution[m:]
