"""The adjoint of the torques of a group of shoes.

On the contact set of the answer the pressures p, the generalised coordinates y, the actuation
forces F and the travel d of a cam's tips solve linear equations, r = 0. The solution (a, b, c) of
the transposed equations for a torque holds the effect of any small change on the torque:
dT = -(a, b, c) . dr, and T/mu dmu besides. The forces are unknowns, so that the forces of struts
and cams are treated as any other force: c is the change of T per given force.
"""

from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.base.errors import NoAnswer
from drumlin.fem.equilibrium.group import ShoeGroup
from drumlin.fem.equilibrium.sharing import full_equations


class ShoeAdjoint(NamedTuple):
    """The part of one shoe in the adjoint of the brake's torque, and in the answer.

    Attributes
    ----------
    a : multipliers (n,) of the weighted gaps
    b : multipliers (k,) of the equilibria
    c : multiplier of the equation that gives the shoe's force
    p : pressures (n,) [Pa] of the answer
    y : generalised coordinates (k,) of the answer
    F : actuation force >= 0 [N] of the answer
    """

    a: Floats
    b: Floats
    c: float
    p: Floats
    y: Floats
    F: float


class GroupAdjoint(NamedTuple):
    """The adjoint of the torques of a group of shoes.

    Attributes
    ----------
    group : the group, with the senses of friction at its abutments that its answer has
    shoes : the part of each shoe
    torque : torque of each shoe (shoes,) [N m]
    friction : change of the torque of each shoe per friction coefficient (shoes,) [N m]
    ring : change of the whole torque by the logarithm of the ring's modulus [N m]
    drive : change of the whole torque by the logarithm of the forces that are given [N m]
    """

    group: ShoeGroup
    shoes: list[ShoeAdjoint]
    torque: Floats
    friction: Floats
    ring: float
    drive: float


def group_adjoint(group: ShoeGroup) -> GroupAdjoint:
    """The adjoint of the sum of a group's torques. Raises NoAnswer as `ShoeGroup.settled` does."""
    group, contact = group.settled()
    size, mu, lever, n = group.unit_force, group.brake.friction, group.levers, len(contact.p)
    without_friction = _equations(group, 0.0)
    per_friction = _equations(group, 1.0) - without_friction
    y, F = group.coordinates(contact), np.abs(group.forces(contact.p))
    coordinates = sum(map(len, y))
    # The travel of a cam's tips stands last. No equation multiplies it by mu, so that it may be 0.
    travel = np.zeros(len(without_friction) - n - coordinates - len(F))
    answer = np.concatenate([contact.p, *y, F, travel])
    weights = np.zeros((len(answer), len(F)))
    weights[:n] = mu * lever
    on = np.concatenate([contact.active, np.ones(len(answer) - n, dtype=bool)])
    each = _transposed_solution(without_friction + mu * per_friction, on, weights)
    a, b, c = np.split(each.sum(axis=1), [n, n + coordinates])
    shoes = []
    for k, (nodes, modes) in enumerate(zip(group.node_ranges, group.mode_ranges, strict=True)):
        p, force = size * contact.p[nodes], size * float(F[k])
        shoes.append(ShoeAdjoint(a[nodes], b[modes], float(c[k]), p, size * y[k], force))
    by_friction = lever.T @ contact.p - each.T @ (per_friction @ answer)
    return GroupAdjoint(
        group=group,
        shoes=shoes,
        torque=size * mu * (lever.T @ contact.p),
        friction=size * by_friction,
        ring=_by_ring(group, a, contact.p),
        drive=size * group.total * float(c[-1]) if group.cam else _by_given_forces(group, shoes),
    )


def _by_ring(group: ShoeGroup, a: Floats, p: Floats) -> float:
    """The change of the torque by the logarithm of the ring's modulus [N m]; 0 for a rigid drum."""
    if group.ring is None:
        return 0.0
    pressed, dragged = group.ring
    return group.unit_force * float((pressed @ a) @ ((pressed + group.brake.drag * dragged) @ p))


def _by_given_forces(group: ShoeGroup, shoes: list[ShoeAdjoint]) -> float:
    """The change of the torque by the logarithm of all forces that no strut gives [N m]."""
    pushed_by_struts = [to for _, to in group.links]
    given = [own.c * own.F for k, own in enumerate(shoes) if k not in pushed_by_struts]
    return float(sum(given))


def _equations(group: ShoeGroup, friction: float) -> Floats:
    """All equations of a group at a friction coefficient, its forces unknowns; linear in it."""
    blocks, effects = group.blocks(friction), group.force_effects(friction)
    return full_equations(blocks, effects, group.links, group.cam)


def _transposed_solution(matrix: Floats, on: Bools, weights: Floats) -> Floats:
    """The solution (m, j) of the transposed equations on the unknowns `on` (m,), 0 elsewhere.

    Raises NoAnswer where the equations are singular.
    """
    K = matrix[np.ix_(on, on)]
    # The equations are equilibrated by rows, and then by columns.
    row = 1 / np.abs(K).max(axis=1)
    column = 1 / np.abs(row[:, None] * K).max(axis=0)
    scaled = (row[:, None] * K * column).T
    solution = np.zeros(weights.shape)
    try:
        solution[on] = row[:, None] * np.linalg.solve(scaled, column[:, None] * weights[on])
    except np.linalg.LinAlgError as error:
        raise NoAnswer("no equilibrium: the contact cannot balance the actuation") from error
    return solution
