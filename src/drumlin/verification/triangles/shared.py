"""Shoes on a rigid drum that a common cam actuates or that push each other by struts.

The force on one shoe depends on the solution of another shoe. Shoes between which struts stand are
solved one after the other; the two forces of a cam follow from an equation, by root finding.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.verification.triangles.contact import (
    ContactForcesAndRigidMotions,
    NodesAndSupportsInContactAtStart,
    contact_forces_of_shoes_in_one_system,
    forces_of_drum_on_lining_nodes,
    loaded_point_displacement_along_force,
)
from drumlin.verification.triangles.face import ShoeCondensedToLiningFace


class _SolvedShoeUnderKnownActuationForce(NamedTuple):
    """A shoe under a known actuation force, with its solution.

    Attributes
    ----------
    shoe : the shoe, with the known force as its actuation
    forces : its contact forces and rigid-body motion
    load_point_travel : displacement of the point at which the force acts, along the force [m]
    """

    shoe: Shoe
    forces: ContactForcesAndRigidMotions
    load_point_travel: float


def solve_shoes_with_cam_or_strut_forces(
    brake: Brake, faces: list[ShoeCondensedToLiningFace], first: NodesAndSupportsInContactAtStart
) -> tuple[list[Shoe], list[ContactForcesAndRigidMotions]]:
    """Find the forces of a cam or struts; returns shoes under these forces, and contact forces.

    The foot of a shoe presses on a strut, and the strut pushes the next shoe with the same force. A
    cam displaces the loaded points of two shoes by the same length, and its two forces have a given
    sum.

    Parameters
    ----------
    brake : the brake, with its shoes and the cam or the struts between them
    faces : the shoes, condensed to the faces of their linings, each under an actuation of 1 N
    first : for each shoe, the nodes in contact when the contact solver starts

    Raises
    ------
    NoAnswer
        If a shoe has no solution under the force on it.
    """
    names = [shoe.name for shoe in brake.shoes]

    def solve_numbered_shoe_under_force(
        i: int, force: float
    ) -> _SolvedShoeUnderKnownActuationForce:
        """Solve shoe i under a force [N]."""
        return _solve_shoe_under_force(
            brake, brake.shoes[i], faces[i], first.contact_at_start_of_some_shoes([i]), force
        )

    # Shoes that no strut pushes have a known actuation force, or are the two shoes at the cam.
    behind = {names.index(link.to) for link in brake.links}
    free = [i for i in range(len(names)) if i not in behind]
    if brake.actuation is not None and brake.actuation.is_cam_or_wedge:
        a, b, total = free[0], free[1], brake.actuation.force_of_cylinder_or_sum_of_cam_forces
        force = brentq(
            lambda force: (
                solve_numbered_shoe_under_force(a, force).load_point_travel
                - solve_numbered_shoe_under_force(b, total - force).load_point_travel
            ),
            1e-3 * total,
            0.999 * total,
            xtol=1e-12 * total,
        )
        found = {
            a: solve_numbered_shoe_under_force(a, force),
            b: solve_numbered_shoe_under_force(b, total - force),
        }
    else:
        found = {
            i: solve_numbered_shoe_under_force(i, brake.shoes[i].actuation.force) for i in free
        }
    left = list(brake.links)
    # Struts form a chain from shoe to shoe. The next strut to follow is one that starts at a solved
    # shoe.
    while left:
        link = next(one for one in left if names.index(one.source) in found)
        left.remove(link)
        source = names.index(link.source)
        force = _force_of_foot_on_strut(brake, faces[source], found[source])
        found[names.index(link.to)] = solve_numbered_shoe_under_force(names.index(link.to), force)
    solved = [found[i] for i in range(len(names))]
    return [one.shoe for one in solved], [one.forces for one in solved]


def _solve_shoe_under_force(
    brake: Brake,
    shoe: Shoe,
    face: ShoeCondensedToLiningFace,
    first: NodesAndSupportsInContactAtStart,
    force: float,
) -> _SolvedShoeUnderKnownActuationForce:
    """Solve one shoe under an actuation force.

    Parameters
    ----------
    brake : the brake, for its friction, sense of rotation and drum
    shoe : the shoe
    face : the shoe, condensed to the face of its lining, under an actuation of 1 N
    first : the nodes in contact at the start
    force : the actuation force [N]

    Raises
    ------
    NoAnswer
        If the shoe has no solution for any sense of the friction at its abutment.
    """
    shoe = shoe.shoe_with_changed_actuation_force(force)
    # The face is condensed under 1 N: displacements grow in proportion to the force, and work grows
    # with its square.
    face = replace(
        face,
        loaded=force * face.loaded,
        elastic_actuation_work=force**2 * face.elastic_actuation_work,
    )
    failure: NoAnswer | None = None
    for sense in shoe.senses_of_abutment_friction_to_try:
        try:
            (found,) = contact_forces_of_shoes_in_one_system(
                brake, [face], [shoe], None, first, (sense,)
            )
        except NoAnswer as error:
            failure = failure or error
            continue
        travel = loaded_point_displacement_along_force(brake, face, shoe, found, sense)
        return _SolvedShoeUnderKnownActuationForce(shoe, found, travel)
    assert failure is not None
    raise failure


def _force_of_foot_on_strut(
    brake: Brake, face: ShoeCondensedToLiningFace, solved: _SolvedShoeUnderKnownActuationForce
) -> float:
    """The force [N] with which the foot of a solved shoe presses on the strut behind the foot."""
    drum = forces_of_drum_on_lining_nodes(brake, solved.shoe, face, solved.forces.force)
    reaction = -drum.sum(axis=0) - solved.shoe.sum_of_forces_of_all_loads
    return float(np.hypot(*reaction))
