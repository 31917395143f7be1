"""One-sided supports in the contact problem of a group of shoes.

A support with the force f >= 0 opens by v >= 0, and f v = 0, as a contact node of a lining. On the
condensed bodies of a group, v = v0 + V_p p + V_f f + V_y y, with the pressures p and the
rigid-body motions y. The forces of the supports open the weighted gaps by G f and do the work V_y^T
on the motions, so that w = q + A p + B y + G f and C p + V_y^T f = h.

Supports that bear have v = 0. They are eliminated: the equilibria in the motions that they hold
give their forces, and v = 0 gives these motions. The contact problem that remains has the motions
that the bearing supports leave free. Which of them bear is found by trying each choice on the same
condensed bodies; there are finitely many.
"""

from dataclasses import dataclass

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.one_sided import (
    LARGEST_PULL,
    Bearing,
    are_motions_resisted,
    divide_motions_by_supports,
)
from drumlin.contact.equations import ContactProblem


@dataclass(frozen=True)
class SupportMatrices:
    """The effects of m one-sided supports on n pressures and k rigid-body motions of a group.

    Forces and displacements are per newton of the group's actuation force.

    Attributes
    ----------
    opening : opening (m,) of each support by its clearance and by the actuation
    opening_by_pressure : opening (m, n) per pressure
    opening_by_force : opening (m, m) per force of a support
    opening_by_motion : opening (m, k) per rigid-body motion
    gap_by_force : weighted gaps (n, m) that open per force of a support
    sizes : amount (k,) of each motion that displaces points of the brake by about 1 m
    """

    opening: Floats
    opening_by_pressure: Floats
    opening_by_force: Floats
    opening_by_motion: Floats
    gap_by_force: Floats
    sizes: Floats


@dataclass(frozen=True)
class BearingSupports:
    """The contact problem of a group on the supports that bear, and what its solution gives.

    Attributes
    ----------
    problem : the contact problem, with k' free motions y'
    bearing : whether each of the m supports bears
    matrices : the effects of the supports
    forces_without_pressure : part (m,) of the forces of the supports that no pressure changes
    forces_by_pressure : forces (m, n) of the supports per pressure
    motions_without_pressure : part (k,) of the rigid-body motions that no pressure changes
    motions_by_pressure : rigid-body motions (k, n) per pressure
    motions_by_unknown : rigid-body motions (k, k') per unknown y'
    """

    problem: ContactProblem
    bearing: Bearing
    matrices: SupportMatrices
    forces_without_pressure: Floats
    forces_by_pressure: Floats
    motions_without_pressure: Floats
    motions_by_pressure: Floats
    motions_by_unknown: Floats

    def forces_of_supports(self, p: Floats) -> Floats:
        """The forces (m,) of the supports under pressures p (n,); 0 where a support is open."""
        return self.forces_without_pressure + self.forces_by_pressure @ p

    def rigid_body_motions(self, p: Floats, y: Floats) -> Floats:
        """The rigid-body motions (k,) of all shoes under pressures p (n,) and unknowns y (k',)."""
        by_pressure = self.motions_without_pressure + self.motions_by_pressure @ p
        return by_pressure + self.motions_by_unknown @ y

    def is_bearing_as_assumed(self, p: Floats, y: Floats) -> bool:
        """Whether no bearing support pulls, and no open support overlaps its shoe.

        p (n,) and y (k',) are the solution of the contact problem.
        """
        of, forces = self.matrices, self.forces_of_supports(p)
        parts = [
            of.opening,
            of.opening_by_pressure @ p,
            of.opening_by_force @ forces,
            of.opening_by_motion @ self.rigid_body_motions(p, y),
        ]
        opening, largest = np.sum(parts, axis=0), float(np.abs(parts).max())
        on = np.array(self.bearing)
        # The forces are relative to the largest actuation force, which is 1.
        pulls = forces[on] < -LARGEST_PULL * max(1.0, float(np.abs(forces).max()))
        overlaps = opening[~on] < -LARGEST_PULL * largest
        return not (pulls.any() or overlaps.any())


def contact_problem_on_bearing_supports(
    problem: ContactProblem, matrices: SupportMatrices, bearing: Bearing
) -> BearingSupports | None:
    """Make the contact problem of a group of shoes on the supports that bear.

    The result is None if the bearing supports are redundant, or leave a motion free that the
    linings do not resist. The problem stays a linear function of the friction coefficient.

    Parameters
    ----------
    problem : the contact problem without supports
    matrices : the effects of the m supports
    bearing : whether each of the m supports bears
    """
    A, q, B, C, h = problem
    on = np.flatnonzero(bearing)
    motions = divide_motions_by_supports(matrices.opening_by_motion[on], matrices.sizes)
    if motions is None:
        return None
    free, held = motions
    scale = float(np.linalg.norm(B * matrices.sizes, axis=0).max())
    if not are_motions_resisted(B @ free, scale):
        return None
    # The equilibria in the held motions give the forces of the bearing supports.
    constant, by_pressure = np.zeros(len(bearing)), np.zeros((len(bearing), len(q)))
    constant[on], by_pressure[on] = held.T @ h, -held.T @ C
    # The openings of the bearing supports vanish, which gives the held motions.
    by_force = matrices.opening_by_force[on]
    motion = -held @ (matrices.opening[on] + by_force @ constant)
    motion_by_pressure = -held @ (matrices.opening_by_pressure[on] + by_force @ by_pressure)
    reduced = ContactProblem(
        A=A + matrices.gap_by_force @ by_pressure + B @ motion_by_pressure,
        q=q + matrices.gap_by_force @ constant + B @ motion,
        B=B @ free,
        C=free.T @ C,
        h=free.T @ h,
    )
    return BearingSupports(
        reduced, bearing, matrices, constant, by_pressure, motion, motion_by_pressure, free
    )
