"""One-sided supports in the contact problem of a group of shoes.

A one-sided support pushes with a force f >= 0 or opens by v >= 0, and f v = 0, like a contact node
of a lining. For a group with the pressures p and the rigid-body motions y, the openings are v = v0
+ V_p p + V_f f + V_y y. The forces f of the supports open the weighted gaps by G f and have the
generalised forces V_y^T f, so that w = q + A p + B y + G f and C p + V_y^T f = h. In
`OneSidedSupportMatrices` v0 is `opening`, V_p, V_f and V_y are `opening_by_pressure`,
`opening_by_force` and `opening_by_motion`, and G is `gap_by_force`.

Supports that bear have v = 0, and are eliminated. Their forces follow from the equilibria in the
motions that they prevent. These motions follow from v = 0. The remaining contact problem has only
the motions that the bearing supports leave free. Each choice of supports that bear is tried on the
same condensed bodies; there are finitely many choices.
"""

from dataclasses import dataclass

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.one_sided import (
    LARGEST_ROUND_OFF_PULL_OF_SUPPORT,
    BearingFlagsOfOneSidedSupports,
    divide_motions_into_held_and_free,
    do_linings_resist_free_motions,
)
from drumlin.contact.equations import ContactProblem


@dataclass(frozen=True)
class OneSidedSupportMatrices:
    """The effects of m one-sided supports on n pressures and k rigid-body motions of a group.

    Forces and displacements are per newton of the group's actuation force.

    Attributes
    ----------
    opening : opening (m,) of each support by its clearance and by the loads on the shoes
    opening_by_pressure : opening (m, n) per pressure
    opening_by_force : opening (m, m) per force of a support
    opening_by_motion : opening (m, k) per rigid-body motion
    gap_by_force : opening (n, m) of the weighted gaps, the integrals of the gap times each node's
        shape function, per force of a support
    sizes : amount (k,) of each motion by which points of the brake move about 1 m
    """

    opening: Floats
    opening_by_pressure: Floats
    opening_by_force: Floats
    opening_by_motion: Floats
    gap_by_force: Floats
    sizes: Floats


@dataclass(frozen=True)
class ContactProblemOnBearingSupports:
    """The contact problem of a group of shoes on the one-sided supports that bear.

    Attributes
    ----------
    problem : the contact problem; its motions y' (k',) are those that the bearing supports allow
    bearing : whether each of the m supports bears
    matrices : the effects of the supports
    forces_without_pressure : forces (m,) of the supports at zero pressure
    forces_by_pressure : forces (m, n) of the supports per pressure
    motions_without_pressure : rigid-body motions (k,) at zero pressure and y' = 0
    motions_by_pressure : rigid-body motions (k, n) per pressure
    motions_by_unknown : rigid-body motions (k, k') per unknown y'
    """

    problem: ContactProblem
    bearing: BearingFlagsOfOneSidedSupports
    matrices: OneSidedSupportMatrices
    forces_without_pressure: Floats
    forces_by_pressure: Floats
    motions_without_pressure: Floats
    motions_by_pressure: Floats
    motions_by_unknown: Floats

    def forces_of_one_sided_supports(self, p: Floats) -> Floats:
        """The forces (m,) of the supports under pressures p (n,); 0 where a support is open."""
        return self.forces_without_pressure + self.forces_by_pressure @ p

    def rigid_body_motions(self, p: Floats, y: Floats) -> Floats:
        """The rigid-body motions (k,) of all shoes, by a solution p (n,), y (k',) of `problem`."""
        by_pressure = self.motions_without_pressure + self.motions_by_pressure @ p
        return by_pressure + self.motions_by_unknown @ y

    def do_supports_bear_as_assumed(self, p: Floats, y: Floats) -> bool:
        """Whether no support assumed to bear pulls, and no support assumed open overlaps a shoe.

        p (n,) and y (k',) are the solution of the contact problem.
        """
        of, forces = self.matrices, self.forces_of_one_sided_supports(p)
        parts = [
            of.opening,
            of.opening_by_pressure @ p,
            of.opening_by_force @ forces,
            of.opening_by_motion @ self.rigid_body_motions(p, y),
        ]
        opening, largest = np.sum(parts, axis=0), float(np.abs(parts).max())
        on = np.array(self.bearing)
        # The largest actuation force is 1, since forces are relative to it.
        pulls = forces[on] < -LARGEST_ROUND_OFF_PULL_OF_SUPPORT * max(
            1.0, float(np.abs(forces).max())
        )
        overlaps = opening[~on] < -LARGEST_ROUND_OFF_PULL_OF_SUPPORT * largest
        return not (pulls.any() or overlaps.any())


def contact_problem_on_supports_that_bear(
    problem: ContactProblem,
    matrices: OneSidedSupportMatrices,
    bearing: BearingFlagsOfOneSidedSupports,
) -> ContactProblemOnBearingSupports | None:
    """Make the contact problem of a group of shoes on the one-sided supports that bear.

    The result is None if the bearing supports are redundant, or leave a motion free that the
    linings do not resist. The problem stays a linear function of the friction coefficient.

    Parameters
    ----------
    problem : the contact problem without one-sided supports
    matrices : the effects of the m supports
    bearing : whether each of the m supports bears
    """
    A, q, B, C, h = problem
    on = np.flatnonzero(bearing)
    motions = divide_motions_into_held_and_free(matrices.opening_by_motion[on], matrices.sizes)
    if motions is None:
        return None
    free, held = motions
    scale = float(np.linalg.norm(B * matrices.sizes, axis=0).max())
    if not do_linings_resist_free_motions(B @ free, scale):
        return None
    # The equilibria in the motions that the bearing supports prevent give the forces of these
    # supports.
    constant, by_pressure = np.zeros(len(bearing)), np.zeros((len(bearing), len(q)))
    constant[on], by_pressure[on] = held.T @ h, -held.T @ C
    # The openings of the bearing supports vanish, which gives the amounts of the prevented motions.
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
    return ContactProblemOnBearingSupports(
        reduced, bearing, matrices, constant, by_pressure, motion, motion_by_pressure, free
    )
