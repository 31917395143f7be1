"""Shoes on a rigid drum that share forces, by a cam or by struts.

The force on a shoe depends on the answers of the other shoes. It is found by solving shoe after
shoe.
"""

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from drumlin.base.arrays import Bools
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.verification.triangles.contact import (
    ContactForces,
    solve_contact_forces,
    tip_displacement,
)
from drumlin.verification.triangles.face import CondensedFace


def solve_shoes_that_share_forces(
    brake: Brake, faces: list[CondensedFace], first: list[Bools]
) -> tuple[list[Shoe], list[ContactForces]]:
    """The shoes under the forces that they share, and the contact forces of each shoe.

    A strut pushes the next shoe with the force by which the foot of the shoe before bears on it. A
    cam moves the tips of both shoes by the same length, and its two forces have a given sum.

    Parameters
    ----------
    brake : shoes and the cam or the struts between them
    faces : lining faces of the shoes, each under an actuation of 1 N
    first : for each shoe the nodes (n,) that are in contact to begin with

    Raises
    ------
    NoAnswer
        If a shoe has no answer under a force.
    """
    names = [shoe.name for shoe in brake.shoes]
    shoes, found = list(brake.shoes), dict[int, ContactForces]()

    def solve_under(i: int, force: float) -> float:
        """Solve shoe i under a force [N]; the displacement of its tip along the force [m]."""
        one, shoe = faces[i], shoes[i].under(force)
        one = replace(one, loaded=force * one.loaded, yields=force**2 * one.yields)
        failure: NoAnswer | None = None
        for sense in shoe.senses:
            try:
                (found[i],) = solve_contact_forces(brake, [one], [shoe], None, [first[i]], (sense,))
            except NoAnswer as error:
                failure = failure or error
                continue
            shoes[i] = shoe
            return tip_displacement(brake, one, shoe, found[i], sense)
        assert failure is not None
        raise failure

    behind = {names.index(link.to) for link in brake.links}
    free = [i for i in range(len(names)) if i not in behind]
    if brake.actuation is not None and brake.actuation.is_cam:
        a, b, total = free[0], free[1], brake.actuation.total
        brentq(
            lambda force: solve_under(a, force) - solve_under(b, total - force),
            1e-3 * total,
            0.999 * total,
            xtol=1e-12 * total,
        )
    else:
        for i in free:
            solve_under(i, shoes[i].actuation.force)
    left = list(brake.links)
    # A chain of links goes from shoe to shoe: the link whose first shoe is solved comes next.
    while left:
        link = next(one for one in left if names.index(one.source) in found)
        left.remove(link)
        i = names.index(link.source)
        drum = brake.friction * brake.spin * faces[i].tangent - faces[i].normal
        reaction = -(found[i].force[:, None] * drum).sum(axis=0) - shoes[i].actuation.vector
        solve_under(names.index(link.to), float(np.hypot(*reaction)))
    return shoes, [found[i] for i in range(len(names))]
