"""The adjoint of the torques of shoes that meet the drum together.

On the contact set of the answer pressures p, free motions y, forces F and the way of a cam's tips
solve linear equations, r = 0. The solution (a, b, c) of their transpose for a torque holds what it
feels of any small change: dT = -(a, b, c) . dr, and besides T/mu dmu. The forces are unknowns, so
that those of struts and cams are as any other: c is dT by a force that is given.
"""

from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.base.errors import NoAnswer
from drumlin.fem.equilibrium.group import ShoeGroup
from drumlin.fem.equilibrium.sharing import full_equations


class Adjoint(NamedTuple):
    """A shoe's part of the adjoint of the brake's torque: a (n,), b (k,), c of what gives its
    force; and of the answer: p (n,) [Pa], motions y (k,), force F >= 0 [N].
    """

    a: Floats
    b: Floats
    c: float
    p: Floats
    y: Floats
    F: float


class Adjoints(NamedTuple):
    """Of the shoes of a `group` with the friction at its abutments as its answer has it: the parts
    `of` each; their own `torque` and `friction`, d torque/dmu (shoes,) [N m]; dT by the logarithms
    of the modulus of the `ring` and of what drives all of them, `drive` [N m].
    """

    group: ShoeGroup
    of: list[Adjoint]
    torque: Floats
    friction: Floats
    ring: float
    drive: float


def adjoints(group: ShoeGroup) -> Adjoints:
    """The adjoint of the sum of a group's torques. Raises NoAnswer as `ShoeGroup.settled` does."""
    group, found = group.settled()
    size, mu, lever, n = group.unit_force, group.brake.friction, group.levers, len(found.p)
    still = _equations(group, 0.0)
    per_mu = _equations(group, 1.0) - still
    y, F = group.coordinates(found), np.abs(group.forces(found.p))
    answer = np.concatenate(
        [found.p, *y, F, np.zeros(len(still) - n - sum(map(len, y)) - len(F))]
    )  # no d feels mu
    weights = np.zeros((len(answer), len(F)))
    weights[:n] = mu * lever
    on = np.concatenate([found.active, np.ones(len(answer) - n, dtype=bool)])
    each = _transposed(still + mu * per_mu, on, weights)
    all_ = each.sum(axis=1)
    a, b, c = np.split(all_, [n, n + sum(map(len, y))])
    of = [
        Adjoint(
            a[part], b[rows], float(c[k]), size * found.p[part], size * y[k], size * float(F[k])
        )
        for k, (part, rows) in enumerate(zip(group.node_ranges, group.mode_ranges, strict=True))
    ]
    ring = 0.0
    if group.ring is not None:
        pressed, dragged = group.ring
        ring = size * float((pressed @ a) @ ((pressed + group.brake.drag * dragged) @ found.p))
    given = [own.c * own.F for k, own in enumerate(of) if k not in [to for _, to in group.links]]
    return Adjoints(
        group=group,
        of=of,
        torque=size * mu * (lever.T @ found.p),
        friction=size * (lever.T @ found.p - each.T @ (per_mu @ answer)),
        ring=ring,
        drive=size * group.total * float(c[-1]) if group.cam else float(sum(given)),
    )


def _equations(group: ShoeGroup, friction: float) -> Floats:
    """All equations of a group at a friction coefficient, with its forces as unknowns; linear in
    it.
    """
    return full_equations(
        group.blocks(friction), group.force_effects(friction), group.links, group.cam
    )


def _transposed(matrix: Floats, on: Bools, weights: Floats) -> Floats:
    """The solution (m, j) of the transposed equations on the unknowns that are `on` (m,), 0
    elsewhere.

    Raises NoAnswer where they are singular.
    """
    K = matrix[np.ix_(on, on)]
    row = 1 / np.abs(K).max(axis=1)
    column = 1 / np.abs(row[:, None] * K).max(axis=0)
    found = np.zeros(weights.shape)
    try:
        found[on] = row[:, None] * np.linalg.solve(
            (row[:, None] * K * column).T, column[:, None] * weights[on]
        )
    except np.linalg.LinAlgError as error:
        raise NoAnswer("no equilibrium: the contact cannot balance the actuation") from error
    return found
