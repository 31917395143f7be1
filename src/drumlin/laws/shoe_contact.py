"""The contact of a rigid shoe: its equilibria on given arcs, and the friction at which it locks."""

import math
from itertools import chain
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.support import SupportRigidBodyModes
from drumlin.laws.face import ContactArcsOfRigidShoe, FrictionSurfaceOfRigidShoe

MOST_ITERATIONS_FOR_CONTACT_ARCS = 200
"""Largest number of iterations in search of the arcs in contact.

If the arcs still change after so many iterations, the shoe counts as without equilibrium.
"""


class RigidShoeContact(NamedTuple):
    """The contact of a rigid shoe in equilibrium.

    Attributes
    ----------
    face : surface on which the shoe presses
    c : (2,) [Pa] factors of the two shape functions of `face` in the pressure
    rigid_body_mode_factors : (k,) [Pa per m of gap closing] factors of the rigid-body modes in the
        pressure
    arcs : begin and end of each arc of the lining in contact
    freedoms : rigid-body modes and test modes of the shoe
    sense : sense, +1 or -1, in which friction acts on the foot at an abutment
    """

    face: FrictionSurfaceOfRigidShoe
    c: Floats
    rigid_body_mode_factors: Floats
    arcs: ContactArcsOfRigidShoe
    freedoms: SupportRigidBodyModes
    sense: int

    @property
    def loaded_point_motion_over_compliance(self) -> float:
        """Displacement [m] of the loaded point along its force, divided by the lining's compliance.

        The quotient is in Pa, because the compliance is the lining's compression per pressure.
        """
        return float(self.freedoms.actuation_point_travel @ self.rigid_body_mode_factors)


def equilibrium_matrices_of_rigid_shoe(
    face: FrictionSurfaceOfRigidShoe,
    free: SupportRigidBodyModes,
    width: float,
    arcs: ContactArcsOfRigidShoe,
) -> tuple[Floats, Floats]:
    """Matrices N and F (k, k) of the equilibria (N - mu s F) a = Q of a rigid shoe.

    The entry of N in row j and column i is the work, on the test mode j, of the pressure that the
    rigid-body mode i causes. F has the work of the friction at mu = 1 in the same way. The unknowns
    a are the factors of the k rigid-body modes in the pressure. Q is the work of the actuation and
    other loads on the test modes, and s is the sense of the motion, +1 or -1.

    Parameters
    ----------
    face : surface on which the shoe presses
    free : rigid-body modes and test modes of the shoe
    width : width of the lining [m]
    arcs : arcs of the lining in contact
    """
    products, shapes = (
        width * face.integrals_of_shape_products(arcs),
        face.gap_closing_factors_of_rigid_body_motions(free.motions),
    )
    N = face.gap_closing_factors_of_rigid_body_motions(free.test_modes) @ products[:2] @ shapes.T
    return N, face.slide_factors_of_rigid_body_motions(free.test_modes) @ products @ shapes.T


def self_locking_friction_on_arcs(
    face: FrictionSurfaceOfRigidShoe,
    free: SupportRigidBodyModes,
    width: float,
    arcs: ContactArcsOfRigidShoe,
    spin: int,
) -> float:
    """Friction coefficient mu_lock at which a rigid shoe locks itself; inf if it never does.

    It is the smallest mu > 0 at which the matrix of the equilibria (N - mu s F) a = Q is singular.

    Parameters
    ----------
    face : surface on which the shoe presses
    free : rigid-body modes and test modes of the shoe
    width : width of the lining [m]
    arcs : arcs of the lining in contact
    spin : sense s in which the drum or the sliding body moves, +1 or -1
    """
    return smallest_friction_with_singular_equilibrium(
        *equilibrium_matrices_of_rigid_shoe(face, free, width, arcs), spin
    )


def smallest_friction_with_singular_equilibrium(N: Floats, F: Floats, spin: int) -> float:
    """The smallest friction coefficient mu > 0 at which N - mu s F is singular; inf if none is.

    N and F (k, k) are the matrices of `equilibrium_matrices_of_rigid_shoe`, and `spin` is the sense
    s of the motion, +1 or -1.
    """
    # With one rigid-body mode the matrices are numbers, and N - mu s F is zero at mu = N/(s F).
    if len(N) == 1:
        drags = spin * float(F[0, 0]) / float(N[0, 0]) if N[0, 0] else 0.0
        return 1 / drags if drags > 1e-14 else math.inf
    # The modes have different units, so rows and columns are scaled to a diagonal of ones.
    size = np.sqrt(np.abs(np.diagonal(N))) + 1e-300
    N, F = N / np.outer(size, size), F / np.outer(size, size)
    # N - mu s F is singular where 1/mu is an eigenvalue of s N^-1 F.
    try:
        found = np.linalg.eigvals(np.linalg.solve(N, spin * F))
    except np.linalg.LinAlgError:
        return math.inf
    # Complex and negative eigenvalues belong to no friction coefficient.
    real = found.real[np.abs(found.imag) <= 1e-9 * np.abs(found)]
    return min((1 / float(x) for x in real if x > 1e-14), default=math.inf)


def arcs_of_positive_pressure_on_linings(
    face: FrictionSurfaceOfRigidShoe, c: Floats, linings: ContactArcsOfRigidShoe
) -> ContactArcsOfRigidShoe:
    """The arcs of a shoe's linings on which the pressure with the factors c (2,) is positive."""
    return tuple(chain(*(face.arcs_of_positive_pressure(c, *ends) for ends in linings)))


def are_contact_arcs_equal(a: ContactArcsOfRigidShoe, b: ContactArcsOfRigidShoe) -> bool:
    """Whether two sets of contact arcs are equal up to round-off."""
    if len(a) != len(b):
        return False
    # Contact iterations compare a few numbers many times. Lists are faster for this than arrays.
    ends_of_a, ends_of_b = list(chain(*a)), list(chain(*b))
    round_off = 1e-13 * max([1.0, *map(abs, ends_of_b)])
    return all(abs(x - y) <= round_off for x, y in zip(ends_of_a, ends_of_b, strict=True))
