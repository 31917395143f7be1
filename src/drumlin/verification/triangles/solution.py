"""Pressure, torque and hinge reaction of a shoe, from the nodal forces on its lining's face."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.one_sided import OneSidedSupportForce
from drumlin.verification.triangles import lagrange
from drumlin.verification.triangles.contact import (
    ContactForcesAndRigidMotions,
    friction_forces_per_contact_force,
)
from drumlin.verification.triangles.face import (
    FACE_GAUSS,
    FACE_WEIGHTS,
    ShoeCondensedToLiningFace,
    edge_shape_function_values_and_derivatives,
)

TRIANGLE_PRESSURE_DROP_LENGTH_AT_SLOT = 1e-12
"""Length [rad] of the polynomial pieces on which the pressure falls to 0 at a slot.

A slot is the space between two linings of a shoe. The force on such a piece is 1e-12 of the force
on a radian of lining."""


@dataclass(frozen=True)
class ShoeSolution:
    """The solution of one shoe on a mesh of curved triangles.

    The pressure p is a piecewise polynomial: a piece is an edge of a triangle on the lining's face.

    Attributes
    ----------
    theta : (n,) growing angles [rad] of the nodes of p, the Gauss-Lobatto points of the pieces
    pressure : (n,) p at these angles, 0 where the lining is open [Pa]
    order : polynomial degree of the pieces of p
    torque : brake torque of the shoe on the drum [N m]
    normal_force : magnitude of the resultant of the pressure [N]
    hinge_reaction : (2,) force of the pin on the shoe [N]; for a shoe on anchors, the sum of the
        forces in `supports`
    arcs : (k, 2) first and last angle of each part of the lining in contact [rad]
    unknowns : number of unknowns of the shoe's mesh
    supports : forces of the one-sided supports of a shoe on anchors
    """

    theta: Floats
    pressure: Floats
    order: int
    torque: float
    normal_force: float
    hinge_reaction: Floats
    arcs: Floats
    unknowns: int
    supports: tuple[OneSidedSupportForce, ...] = ()

    @cached_property
    def _barycentric_interpolation_weights(self) -> Floats:
        """Weights (order + 1,) of the barycentric formula of Lagrange interpolation on a piece."""
        x = lagrange.lobatto_points_on_unit_interval(self.order)
        weights = []
        for node in x:
            distances = node - x[x != node]
            weights.append(1 / np.prod(distances))
        return np.array(weights)

    def pressure_at(self, theta: Floats) -> Floats:
        """Pressure [Pa] at angles `theta` [rad] of any array shape; 0 beyond the lining."""
        # `nodes` are the nodes of the piece of p in which each angle lies, and `off` the distances
        # of the angle from these nodes.
        at = np.asarray(theta, dtype=float)
        ends = self.theta[:: self.order]
        piece = np.clip(np.searchsorted(ends, at, side="right") - 1, 0, len(ends) - 2)
        nodes = piece[..., None] * self.order + np.arange(self.order + 1)
        off = at[..., None] - self.theta[nodes]
        with np.errstate(divide="ignore", invalid="ignore"):
            weight = self._barycentric_interpolation_weights / off
            value = (weight * self.pressure[nodes]).sum(axis=-1) / weight.sum(axis=-1)
        # At a node the formula would divide by zero, and p is the nodal value.
        hit = np.abs(off) < 1e-15
        value = np.where(hit.any(axis=-1), (hit * self.pressure[nodes]).sum(axis=-1), value)
        return np.where((at >= ends[0]) & (at <= ends[-1]), value, 0.0)


def shoe_solution_from_contact_forces(
    brake: Brake, shoe: Shoe, one: ShoeCondensedToLiningFace, found: ContactForcesAndRigidMotions
) -> ShoeSolution:
    """The solution of a shoe, computed from its nodal contact forces.

    The pressure is equivalent to the nodal forces: on the shape function of every node in contact
    both do the same work.
    """
    p = nodal_pressures_equivalent_to_contact_forces(one, found)
    theta, p, active = _insert_open_nodes_in_slots(shoe, one, p, found.active)
    along = friction_forces_per_contact_force(brake, shoe, one) @ found.force
    on_normal = -(found.force[:, None] * one.normal).sum(axis=0)
    on_tangent = (along[:, None] * one.tangent).sum(axis=0)
    return ShoeSolution(
        theta=theta,
        pressure=p,
        order=one.degree,
        torque=brake.size * abs(float(along.sum())),
        normal_force=float(np.hypot(*on_normal)),
        hinge_reaction=-(on_normal + on_tangent + shoe.sum_of_forces_of_all_loads),
        arcs=_first_and_last_angles_of_contacts(theta, p, active, one.degree),
        unknowns=one.unknowns,
        supports=found.supports,
    )


def nodal_pressures_equivalent_to_contact_forces(
    one: ShoeCondensedToLiningFace, found: ContactForcesAndRigidMotions
) -> Floats:
    """The nodal pressures (n,) [Pa] of a face that do the same work as its contact forces.

    The pressure is 0 at open nodes.
    """
    a = np.flatnonzero(found.active)
    p = np.zeros(len(one.theta))
    p[a] = np.linalg.solve(one.mass[np.ix_(a, a)], found.force[a])
    return p


def _insert_open_nodes_in_slots(
    shoe: Shoe, one: ShoeCondensedToLiningFace, p: Floats, active: Bools
) -> tuple[Floats, Floats, Bools]:
    """Angles, pressures and contact (n,) of a face's nodes, with nodes added in the slots.

    In each slot between two linings there are three pieces. On the first piece p falls to 0, on the
    second it is 0, and on the third it rises to its value on the next lining. The first and the
    third piece are TRIANGLE_PRESSURE_DROP_LENGTH_AT_SLOT long. The added nodes are open.

    Parameters
    ----------
    shoe : the shoe
    one : its condensed face
    p : pressures at the nodes of the face [Pa]
    active : whether each node of the face is in contact
    """
    theta, points = one.theta, lagrange.lobatto_points_on_unit_interval(one.degree)
    for first, last in reversed(shoe.lining.slots):
        ends = np.array(
            [
                first,
                first + TRIANGLE_PRESSURE_DROP_LENGTH_AT_SLOT,
                last - TRIANGLE_PRESSURE_DROP_LENGTH_AT_SLOT,
                last,
            ]
        )
        inner = (ends[:-1, None] + np.diff(ends)[:, None] * points[:-1]).ravel()[1:]
        at = int(np.searchsorted(theta, 0.5 * (first + last)))
        theta, p = np.insert(theta, at, inner), np.insert(p, at, 0 * inner)
        active = np.insert(active, at, np.zeros(len(inner), dtype=bool))
    return theta, p, active


def _first_and_last_angles_of_contacts(
    theta: Floats, p: Floats, active: Bools, degree: int
) -> Floats:
    """First and last angle (k, 2) [rad] of each part of the lining in contact.

    An end of the contact inside the lining is extrapolated. The pressure rises there as the square
    root of the distance from the end, so that the force F between the end and a point grows as the
    distance to the power 3/2. The end is where the straight line through F^(2/3) at the next two
    ends of pieces vanishes.
    """
    # Neighbouring nodes in contact form one part of the contact.
    steps = np.diff(np.concatenate([[0], active.astype(int), [0]]))
    firsts, lasts = np.flatnonzero(steps == 1), np.flatnonzero(steps == -1) - 1
    last = len(theta) - 1
    return np.array(
        [
            (
                _angle_at_which_contact_arc_begins(theta, p, i, degree),
                -_angle_at_which_contact_arc_begins(-theta[::-1], p[::-1], last - j, degree),
            )
            for i, j in zip(firsts.tolist(), lasts.tolist(), strict=True)
        ]
    ).reshape(-1, 2)


def _angle_at_which_contact_arc_begins(theta: Floats, p: Floats, node: int, degree: int) -> float:
    """The angle [rad] at which a contact begins; `node` is its first node in contact."""
    if node == 0:
        return float(theta[0])
    # `near` is the last node of the piece (edge of a triangle) in which the contact begins, and
    # `far` the last node of the next piece.
    near = (node - 1) // degree * degree + degree
    far = near + degree
    if far >= len(theta):
        return float(theta[node])
    psi, _ = edge_shape_function_values_and_derivatives(degree, 0.5 + 0.5 * FACE_GAUSS)
    weight = psi @ (0.5 * FACE_WEIGHTS)
    # F are the forces per width [N/m] from the beginning of the contact up to the nodes near and
    # far.
    F = np.cumsum(
        [
            (theta[b] - theta[b - degree]) * float(weight @ p[b - degree : b + 1])
            for b in (near, far)
        ]
    )
    if not 0 < F[0] < F[1]:
        return float(theta[node])
    f = F ** (2 / 3)
    end = theta[near] - f[0] * (theta[far] - theta[near]) / (f[1] - f[0])
    return float(np.clip(end, theta[node - 1], theta[node]))
