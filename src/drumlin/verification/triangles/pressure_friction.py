"""Friction coefficients mu(p) that depend on the pressure, for the solver on curved triangles.

The friction stress mu(p) p is a polynomial on each edge of a triangle, as the pressure is. Both
agree at the nodes. The brake is solved at fixed coefficients of all nodes, again and again, with
the coefficients that belong to the pressures of the solution before (fixed-point iteration).
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.verification.triangles.contact import (
    ContactForcesAndRigidMotions,
    NodesAndSupportsInContactAtStart,
)
from drumlin.verification.triangles.face import ShoeCondensedToLiningFace
from drumlin.verification.triangles.solution import nodal_pressures_equivalent_to_contact_forces

FRICTION_CHANGE_OVER_NORMAL_FORCE_AT_END_OF_SOLVES = 1e-10
"""Change of the friction forces in a solve, relative to the normal force, at which the solves end.

It is far below the error of the meshes, 1e-6 of the torque. A smaller value costs more solves.
"""
MOST_SOLVES_AT_FIXED_NODAL_FRICTION = 60
"""Largest number of solves at fixed friction coefficients before the solver raises NoAnswer.

Each solve multiplies the error of the coefficients by about p mu'(p)/mu times the amplification of
the brake by friction. If this product is 0.6, 45 solves are needed; above 1 they do not settle.
"""


def solve_until_friction_fits_pressures(
    brake: Brake,
    faces: list[ShoeCondensedToLiningFace],
    first: NodesAndSupportsInContactAtStart,
    solve: Callable[
        [list[ShoeCondensedToLiningFace], NodesAndSupportsInContactAtStart],
        tuple[list[Shoe], list[ContactForcesAndRigidMotions]],
    ],
) -> tuple[list[Shoe], list[ShoeCondensedToLiningFace], list[ContactForcesAndRigidMotions]]:
    """Solve a brake until the friction at each node fits the pressure there.

    Returns the shoes under their actuation, their faces with the friction, and the contact forces.
    A brake whose friction does not depend on the pressure is solved once.

    Parameters
    ----------
    brake : the brake
    faces : the shoes, condensed to the faces of their linings
    first : the nodes and the one-sided supports in contact at the start
    solve : function that solves the brake at the friction of the faces

    Raises
    ------
    NoAnswer
        As `solve` does, and if the friction does not settle.
    """
    shoes, found = solve(faces, first)
    curves = [brake.friction_coefficient_curve_of_shoe(shoe) for shoe in brake.shoes]
    if all(len(curve.mu) == 1 for curve in curves):
        return shoes, faces, found
    for _ in range(MOST_SOLVES_AT_FIXED_NODAL_FRICTION):
        faces = [
            replace(one, friction=_friction_forces_at_pressures_of_solution(brake, shoe, one, its))
            for shoe, one, its in zip(brake.shoes, faces, found, strict=True)
        ]
        shoes, found = solve(faces, first)
        changes = [
            _change_of_friction_forces_over_normal_force(brake, shoe, one, its)
            for shoe, one, its in zip(brake.shoes, faces, found, strict=True)
        ]
        if max(changes) <= FRICTION_CHANGE_OVER_NORMAL_FORCE_AT_END_OF_SOLVES:
            return shoes, faces, found
    raise NoAnswer(f"friction and pressure do not agree on triangles: off by {max(changes):.1e}")


def _friction_forces_at_pressures_of_solution(
    brake: Brake, shoe: Shoe, one: ShoeCondensedToLiningFace, found: ContactForcesAndRigidMotions
) -> Floats:
    """The friction forces (n, n) per unit normal force, at the nodal coefficients of a solution.

    The forces are M mu M^-1 f: the nodal forces f give the pressures, their friction stresses at
    the nodes give the friction forces. M is the mass matrix of the nodes in contact. An open node
    has the coefficient at the pressure 0.
    """
    curve = brake.friction_coefficient_curve_of_shoe(shoe)
    p = nodal_pressures_equivalent_to_contact_forces(one, found)
    mu = brake.sign_of_motion * curve.friction_coefficients_at_pressures(p)
    forces, a = np.diag(mu), np.flatnonzero(found.active)
    M = one.mass[np.ix_(a, a)]
    # The transpose of M mu M^-1 is M^-1 mu M, since M is symmetric.
    forces[np.ix_(a, a)] = np.linalg.solve(M, mu[a, None] * M).T
    return forces


def _change_of_friction_forces_over_normal_force(
    brake: Brake, shoe: Shoe, one: ShoeCondensedToLiningFace, found: ContactForcesAndRigidMotions
) -> float:
    """The change of the friction forces from those of a face to those that fit its solution.

    It is the sum of the absolute changes at all nodes, relative to the normal force.
    """
    assert one.friction is not None
    fitting = _friction_forces_at_pressures_of_solution(brake, shoe, one, found)
    change = (fitting - one.friction) @ found.force
    return float(np.abs(change).sum() / np.abs(found.force).sum())
