"""Barecki's iteration, which finds the contact and the displacements of a post brake.

A post is a beam whose lining is divided into sectors; each sector is a spring between the beam and
the elastic ring of the drum. The stations are the places along the beam at which its deflection is
computed. The unknowns are the deflection w of the beam and the displacement z of the ring's rim.
The equations are (12) for each station inside the beam, (17) for each sector, and M_0 = 0 (19), the
moment about the hinge. By (20) a sector has the stiffness k* = k if it is compressed, t = w
cos(theta) - z - Delta > 0 with the gap Delta, and else k* = 0. This module gives the terms in z and
Delta the signs that follow from t; the paper prints them with the sign of the terms in w. The set
of compressed sectors is revised until it agrees with the displacements.
"""

from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.foundation.model import inward_ring_displacement_per_normal_force
from drumlin.foundation.post import ShoeInStationsAndSectors, divide_shoe_into_stations_and_sectors

MOST_REVISIONS_OF_BARECKI_CONTACT = 100
"""Number of revisions of the contact after which the iteration counts as not converged."""


class ResultOfBareckiIteration(NamedTuple):
    """Result of Barecki's iteration for a post with m stations and n sectors.

    Attributes
    ----------
    w : array (m,)
        Deflection of the beam at its stations [m].
    z, N : array (n,)
        Displacement of the drum's rim [m], and force of the lining [N], at each sector.
    rounds : int
        Number of sets of compressed sectors that were tried.
    """

    w: Floats
    z: Floats
    N: Floats
    rounds: int


def solve_post_brake_by_paper_iteration(
    brake: Brake, index: int, sections: int
) -> ResultOfBareckiIteration:
    """Solve a shoe of a post brake by Barecki's iteration, with all simplifications of his paper.

    Parameters
    ----------
    brake : Brake
        The brake.
    index : int
        Number of the shoe.
    sections : int
        Number of sectors along the lining.

    Raises
    ------
    NoAnswer
        If the contact does not converge or the equations are singular.
    """
    # The beam with its sectors, and the flexibility matrix of the ring.
    p = divide_shoe_into_stations_and_sectors(
        brake, brake.shoes[index], sections, tilt=False, wedge=False, plane_stress=False
    )
    theta = p.axis.polar_angle_of_perpendicular_foot + p.axis.sense * p.theta
    c = inward_ring_displacement_per_normal_force(brake, theta, theta, frozenset())
    # The first guess of the contact is the whole lining.
    pressed = np.ones(len(p.theta), dtype=bool)
    for rounds in range(1, MOST_REVISIONS_OF_BARECKI_CONTACT + 1):
        # The displacements follow from the last guess of the contact. A sector is then in contact
        # if these displacements compress it.
        w, z = _beam_and_rim_displacements(p, c, np.where(pressed, p.k, 0.0))
        t = w[p.under] * np.cos(p.theta) - z - p.gap
        if np.array_equal(t > 0, pressed):
            return ResultOfBareckiIteration(w, z, np.where(pressed, p.k * t, 0.0), rounds)
        pressed = t > 0
    raise NoAnswer(
        f"shoe {brake.shoes[index].name!r}: not converged: "
        f"the contact still changes after {rounds} rounds"
    )


def _beam_and_rim_displacements(
    p: ShoeInStationsAndSectors, c: Floats, k: Floats
) -> tuple[Floats, Floats]:
    """Displacements of the beam, w (m,), and of the drum's rim, z (n,) [m], for a given contact.

    Parameters
    ----------
    p : ShoeInStationsAndSectors
        The beam with its m stations and n sectors.
    c : array (n, n)
        Flexibility of the drum's ring at the sectors [m/N].
    k : array (n,)
        Stiffness k* of the sectors [N/m], 0 for those without contact.
    """
    m, n = p.pressed.shape
    # The bending moments (m, n) at the stations by a compression of 1 m of each sector: the matrix
    # B of eq. 11, times the length dx of a sector.
    bent = (p.pressed + p.drag * p.dragged) * k
    matrix, right = np.zeros((m + n, m + n)), np.zeros(m + n)
    # Equilibrium of bending at the stations inside the beam (eq. 12), with second differences of w.
    inner = np.arange(1, m - 1)
    before, after = np.diff(p.x)[:-1], np.diff(p.x)[1:]
    stiff = p.EI[inner] / p.station_weights[inner]
    matrix[inner, inner - 1] = stiff / before
    matrix[inner, inner] = -stiff * (1 / before + 1 / after)
    matrix[inner, inner + 1] = stiff / after
    matrix[np.ix_(inner, p.under)] += bent[inner] * np.cos(p.theta)
    matrix[inner, m:] -= bent[inner]
    right[inner] = p.loaded[inner] + bent[inner] @ p.gap
    # The first equation is M_0 = 0: the moment about the hinge vanishes.
    matrix[0, p.under] = bent[0] * np.cos(p.theta)
    matrix[0, m:] = -bent[0]
    right[0] = p.loaded[0] + bent[0] @ p.gap
    # The last equation of the beam says that the hinge does not move, w_0 = 0. Its coefficient has
    # the size of the other equations' coefficients, so that the matrix is well conditioned.
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
