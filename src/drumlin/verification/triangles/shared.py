"""Shoes on a rigid drum that a common cam actuates or that push each other by struts.

The force on one shoe depends on the solution of another shoe. Struts are followed from shoe to
shoe; the two forces of a cam are the root of an equation.
"""

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from drumlin.base.arrays import Bools
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.verification.triangles.contact import (
    ContactForces,
    contact_forces_of_shoes_in_one_system,
    tip_displacement_along_force,
)
from drumlin.verification.triangles.face import CondensedFace


def solve_shoes_that_share_forces(
    brake: Brake, faces: list[CondensedFace], first: list[Bools]
) -> tuple[list[Shoe], list[ContactForces]]:
    """Find the forces of a cam or of struts; returns the shoes under them, and the contact forces.

    A strut pushes the next shoe with the force by which the foot of the shoe before presses on the
    strut. A cam moves the tips of both shoes by the same length, and its two forces have a given
    sum.

    Parameters
    ----------
    brake : the brake, with its shoes and the cam or the struts between them
    faces : the shoes, condensed to the faces of their linings, each under an actuation of 1 N
    first : for each shoe, whether each node (n,) is in contact at the start

    Raises
    ------
    NoAnswer
        If a shoe has no answer under a force.
    """
    names = [shoe.name for shoe in brake.shoes]
    shoes, found = list(brake.shoes), dict[int, ContactForces]()

    def solve_shoe_under_force(i: int, force: float) -> float:
        """Solve shoe i under a force [N]; returns the displacement [m] of its tip along the force.

        The solved shoe and its contact forces are stored in `shoes` and `found`.
        """
        # The elastic response to the actuation is in proportion to the force.
        one, shoe = faces[i], shoes[i].shoe_with_changed_actuation_force(force)
        one = replace(
            one,
            loaded=force * one.loaded,
            elastic_actuation_work=force**2 * one.elastic_actuation_work,
        )
        failure: NoAnswer | None = None
        for sense in shoe.senses_of_abutment_friction_to_try:
            try:
                (found[i],) = contact_forces_of_shoes_in_one_system(
                    brake, [one], [shoe], None, [first[i]], (sense,)
                )
            except NoAnswer as error:
                failure = failure or error
                continue
            shoes[i] = shoe
            return tip_displacement_along_force(brake, one, shoe, found[i], sense)
        assert failure is not None
        raise failure

    # Shoes that no strut pushes have a known force, or share that of the cam.
    behind = {names.index(link.to) for link in brake.links}
    free = [i for i in range(len(names)) if i not in behind]
    if brake.actuation is not None and brake.actuation.is_cam:
        a, b, total = free[0], free[1], brake.actuation.force_of_cylinder_or_sum_of_cam_forces
        brentq(
            lambda force: (
                solve_shoe_under_force(a, force) - solve_shoe_under_force(b, total - force)
            ),
            1e-3 * total,
            0.999 * total,
            xtol=1e-12 * total,
        )
    else:
        for i in free:
            solve_shoe_under_force(i, shoes[i].actuation.force)
    left = list(brake.links)
    # Struts form a chain from shoe to shoe: the next strut is one whose first shoe is solved.
    while left:
        link = next(one for one in left if names.index(one.source) in found)
        left.remove(link)
        i = names.index(link.source)
        drum = brake.friction * brake.sign_of_motion * faces[i].tangent - faces[i].normal
        reaction = -(found[i].force[:, None] * drum).sum(axis=0) - shoes[i].actuation.force_vector
        solve_shoe_under_force(names.index(link.to), float(np.hypot(*reaction)))
    return shoes, [found[i] for i in range(len(names))]
