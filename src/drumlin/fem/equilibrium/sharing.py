"""The contact problem of shoes whose actuation forces come from struts or a cam.

These forces depend on the pressures. Each shoe i of a group has its own equations. Under its
actuation force F_i the weighted gap (the integral of the gap times each node's shape function)
opens by G_i F_i, and the equilibria read C_i p = -W_i F_i. The tip of the shoe is the point where
F_i acts. It travels along F_i by t_i p + s_i F_i elastically, and by r_i y_i with the generalised
coordinates y_i of the rigid-body modes.

A strut pushes shoe j with the force on the foot of shoe i: F_j = b_i p + e_i F_i. A cam moves two
tips by the same travel d, and the sum of the cam's forces is given. Each shoe under a cam has a
main mode, on which F_i does most work. The equilibrium in the main mode gives F_i as a function of
p, and the travel of the tip gives the coordinate of the main mode. The travel d then replaces the
coordinates of the two main modes, and the sum of the forces replaces their equilibria.

The foot of the shoe i that pushes a strut travels with the tip of the shoe j that the strut pushes.
The shoe i follows by the motion x_i along the friction surface, a turn about the centre of the drum
or a slide along the plane, which changes no gap: x_i = f_i d_j with the travel d_j of the tip. This
motion changes slips and stretches springs, which stand among the gaps: they open by V_i x_i.

In `EffectsOfActuationForceOnShoe` the symbols have these names: G_i is `gap_by_force` and W_i
`work`; t_i, s_i and r_i are `load_point_travel_by_pressure`, `load_point_travel_by_force` and
`load_point_travel_by_modes`; b_i and e_i are `foot_force_by_pressure` and `foot_force_by_force`;
f_i is `surface_motion_by_foot_travel` and V_i `gap_by_surface_motion`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.contact.equations import ContactProblem

LARGEST_STRUT_OR_CAM_FORCE_COUNTED_AS_ZERO = 1e-9
"""Force of a strut or a cam, relative to the largest force of the group, that counts as zero.

A smaller force is the round-off of a force that has fallen to zero, and a negative force would
pull. In both cases the solution is refused. The value is far above round-off and far below the
force of any strut or cam that pushes.
"""
ERROR_TEXT_ON_CAM_OR_STRUT_THAT_WOULD_PULL = "no equilibrium, what pushes it would have to pull"
"""Text of the refusal of a shoe whose cam or strut would have to pull it."""


class EffectsOfActuationForceOnShoe(NamedTuple):
    """The effects of a shoe's actuation force, and what moves its tip and loads its foot.

    The tip is the point of the shoe where the force acts. The foot is the end of the shoe that
    stands on an abutment or pushes a strut. All values hold per newton of the force or per pascal
    of the pressures.

    Attributes
    ----------
    nodes : indices of the shoe's n pressures among the pressures of the group
    modes : indices of the shoe's k generalised coordinates among the coordinates of the group
    gap_by_force : opening (n,) of the weighted gaps, the integrals of the gap times each node's
        shape function, by the force
    load_point_travel_by_pressure : elastic travel (n,) of the tip along the force, by the pressures
    load_point_travel_by_force : elastic travel of the tip along the force, by the force
    load_point_travel_by_further_loads : elastic travel of the tip by springs, weight and additional
        forces
    work : work (k,) of the force on the test modes
    load_point_travel_by_modes : travel (k,) of the tip along the force, by the rigid-body modes
    foot_force_by_pressure : force (n,) along the strut that the foot transmits, by the pressures
    foot_force_by_force : force along the strut that the foot transmits, by the actuation force
    foot_force_by_further_loads : force along the strut that the foot transmits, by springs, weight
        and additional forces
    surface_motion_by_foot_travel : motion of the shoe along the friction surface, per travel of its
        foot along the force of the strut on the next shoe; 0 for a shoe without an abutment
    load_point_travel_by_surface_motion : travel of the tip along the force, per motion of the shoe
        along the friction surface
    gap_by_surface_motion : opening (n,) of the weighted gaps per motion of the shoe along the
        friction surface; only slips and springs among the gaps have one
    """

    nodes: slice | Ints
    modes: slice
    gap_by_force: Floats
    load_point_travel_by_pressure: Floats
    load_point_travel_by_force: float
    load_point_travel_by_further_loads: float
    work: Floats
    load_point_travel_by_modes: Floats
    foot_force_by_pressure: Floats
    foot_force_by_force: float
    foot_force_by_further_loads: float
    surface_motion_by_foot_travel: float
    load_point_travel_by_surface_motion: float
    gap_by_surface_motion: Floats


@dataclass(frozen=True)
class ContactProblemWithStrutAndCamForces:
    """The contact problem of m shoes under strut and cam forces, which follow from its solution.

    Attributes
    ----------
    problem : the contact problem; under a cam the first of its motions y' (k',) is the travel that
        the cam gives the shoes' points of actuation, in place of the coordinates of two modes
    forces_without_pressure : actuation forces (m,) at zero pressure
    forces_by_pressure : actuation forces (m, n) per pressure
    coordinates_by_unknown : generalised coordinates (k, k') of all shoes per unknown y'
    coordinates_by_pressure : generalised coordinates (k, n) of all shoes per pressure
    coordinates_of_loads : generalised coordinates (k,) of all shoes at zero pressure and y' = 0
    """

    problem: ContactProblem
    forces_without_pressure: Floats
    forces_by_pressure: Floats
    coordinates_by_unknown: Floats
    coordinates_by_pressure: Floats
    coordinates_of_loads: Floats

    def actuation_forces_under_contact_pressures(self, p: Floats) -> Floats:
        """The actuation forces (m,) under the pressures p (n,)."""
        return self.forces_without_pressure + self.forces_by_pressure @ p

    def rigid_body_coordinates_from_contact_solution(self, p: Floats, y: Floats) -> Floats:
        """The generalised coordinates (k,) of all shoes, from a solution p, y of `problem`.

        p (n,) are pressures and y (k',) motions. Under a cam, y has the travel of the cam in place
        of two of the coordinates.
        """
        by_unknowns = self.coordinates_by_unknown @ y + self.coordinates_by_pressure @ p
        return by_unknowns + self.coordinates_of_loads


class _ActuationForcesLinearInPressures(NamedTuple):
    """The actuation forces (m,) of a group as a linear function of the pressures p (n,).

    The forces are without_pressure + by_pressure p, with `without_pressure` (m,) and `by_pressure`
    (m, n).
    """

    without_pressure: Floats
    by_pressure: Floats


def make_contact_problem_with_strut_and_cam_forces(
    problem: ContactProblem,
    effects: list[EffectsOfActuationForceOnShoe],
    own_forces: Floats,
    struts: list[tuple[int, int]],
    cam_shoes: list[int],
    cam_force_sum: float,
) -> ContactProblemWithStrutAndCamForces:
    """Make the contact problem of shoes under strut and cam forces.

    The problem stays a linear function of the friction coefficient.

    Parameters
    ----------
    problem : the contact problem of the group in which each shoe has its own, given force
    effects : the effects of the m actuation forces
    own_forces : the actuation forces (m,) in `problem`
    struts : for each strut the indices of the pushing and of the pushed shoe
    cam_shoes : indices of the two shoes under a cam; empty without a cam
    cam_force_sum : sum of the cam's forces
    """
    forces = _actuation_forces_linear_in_pressures(problem, effects, own_forces, struts, cam_shoes)
    with_forces = _replace_actuation_forces_in_contact_problem(problem, effects, own_forces, forces)
    with_forces = _add_motion_of_pushing_shoes_with_their_struts(
        with_forces, effects, forces, struts
    )
    n, k = problem.B.shape
    if not cam_shoes:
        return ContactProblemWithStrutAndCamForces(
            with_forces, *forces, np.eye(k), np.zeros((k, n)), np.zeros(k)
        )
    return _contact_problem_with_cam_travel_as_unknown(
        problem, with_forces, effects, forces, cam_shoes, cam_force_sum
    )


def _actuation_forces_linear_in_pressures(
    problem: ContactProblem,
    effects: list[EffectsOfActuationForceOnShoe],
    own_forces: Floats,
    struts: list[tuple[int, int]],
    cam_shoes: list[int],
) -> _ActuationForcesLinearInPressures:
    """The actuation force of each shoe as a linear function of the pressures.

    The forces of a cam and of struts depend on the pressures; other shoes keep their own forces.
    """
    fixed = np.array(own_forces, dtype=float)
    by_pressure = np.zeros((len(effects), problem.B.shape[0]))
    # The force of the cam on each shoe follows from the equilibrium in the shoe's main mode, on
    # which the force does most work.
    for i in cam_shoes:
        shoe = effects[i]
        main = _index_of_mode_replaced_by_cam_travel(problem, shoe)
        by_pressure[i] = -problem.C[shoe.modes][main] / shoe.work[main]
        # Springs, weight and additional forces also do work on the main mode. The cam has to
        # balance this work.
        of_loads = problem.h[shoe.modes][main] + own_forces[i] * shoe.work[main]
        fixed[i] = of_loads / shoe.work[main]
    # A strut pushes the next shoe with the force on the foot of the pushing shoe.
    for source, to in struts:
        pushing = effects[source]
        by_pressure[to, pushing.nodes] = pushing.foot_force_by_pressure
        by_pressure[to] += pushing.foot_force_by_force * by_pressure[source]
        fixed[to] = pushing.foot_force_by_force * fixed[source]
        fixed[to] += pushing.foot_force_by_further_loads
    return _ActuationForcesLinearInPressures(fixed, by_pressure)


def _replace_actuation_forces_in_contact_problem(
    problem: ContactProblem,
    effects: list[EffectsOfActuationForceOnShoe],
    own_forces: Floats,
    forces: _ActuationForcesLinearInPressures,
) -> ContactProblem:
    """Return a contact problem with strut and cam forces in place of the shoes' own forces (m,).

    `forces` are the new forces, linear in the pressures. The part of the forces that depends on
    pressures changes the matrices A and C. Their constant part changes the vectors q and h.
    """
    A, q, B, C, h = (np.array(part) for part in problem)
    for i, shoe in enumerate(effects):
        extra = forces.without_pressure[i] - own_forces[i]
        A[shoe.nodes] += np.outer(shoe.gap_by_force, forces.by_pressure[i])
        q[shoe.nodes] += extra * shoe.gap_by_force
        C[shoe.modes] += np.outer(shoe.work, forces.by_pressure[i])
        h[shoe.modes] -= extra * shoe.work
    return ContactProblem(A, q, B, C, h)


def surface_motions_by_load_point_travels(
    effects: Sequence[EffectsOfActuationForceOnShoe], struts: Sequence[tuple[int, int]]
) -> Floats:
    """The motion of each of m shoes along the friction surface with its strut (m, m).

    The motion is a turn about the centre of the drum, or a slide along the plane. The columns stand
    for the travel of each shoe's point of actuation by its strain and its rigid-body modes.
    `struts` are pairs of the pushing and the pushed shoe. A strut that pushes a shoe comes before
    the strut that this shoe pushes.
    """
    motions = np.zeros((len(effects), len(effects)))
    # The last strut comes first, because the pushed shoe itself may follow a further strut.
    for source, to in reversed(struts):
        travel = effects[to].load_point_travel_by_surface_motion * motions[to]
        travel[to] += 1.0
        motions[source] = effects[source].surface_motion_by_foot_travel * travel
    return motions


def _add_motion_of_pushing_shoes_with_their_struts(
    problem: ContactProblem,
    effects: list[EffectsOfActuationForceOnShoe],
    forces: _ActuationForcesLinearInPressures,
    struts: list[tuple[int, int]],
) -> ContactProblem:
    """A contact problem in which slips and springs follow the motion of struts.

    A shoe that pushes a strut moves along the friction surface as the strut's other end travels.

    Parameters
    ----------
    problem : the contact problem in which the foot of each pushing shoe does not travel
    effects : the effects of the m actuation forces
    forces : the actuation forces as functions of the pressures
    struts : for each strut the indices of the pushing and of the pushed shoe
    """
    if not any(effects[source].gap_by_surface_motion.any() for source, _ in struts):
        return problem
    A, q, B, C, h = (np.array(part) for part in problem)
    n, k = B.shape
    by_pressure, by_mode = np.zeros((len(effects), n)), np.zeros((len(effects), k))
    constant = np.zeros(len(effects))
    for i, shoe in enumerate(effects):
        by_pressure[i] = _elastic_actuation_point_travel_per_pressure(shoe, forces.by_pressure[i])
        by_mode[i, shoe.modes] = shoe.load_point_travel_by_modes
        constant[i] = shoe.load_point_travel_by_force * forces.without_pressure[i]
        constant[i] += shoe.load_point_travel_by_further_loads
    motions = surface_motions_by_load_point_travels(effects, struts)
    for i, shoe in enumerate(effects):
        A[shoe.nodes] += np.outer(shoe.gap_by_surface_motion, motions[i] @ by_pressure)
        B[shoe.nodes] += np.outer(shoe.gap_by_surface_motion, motions[i] @ by_mode)
        q[shoe.nodes] += shoe.gap_by_surface_motion * (motions[i] @ constant)
    return ContactProblem(A, q, B, C, h)


def _contact_problem_with_cam_travel_as_unknown(
    blocks: ContactProblem,
    with_forces: ContactProblem,
    effects: list[EffectsOfActuationForceOnShoe],
    forces: _ActuationForcesLinearInPressures,
    cam_shoes: list[int],
    cam_force_sum: float,
) -> ContactProblemWithStrutAndCamForces:
    """Return the contact problem under a cam, with the travel of the cam as an unknown.

    The cam moves the points of actuation of its two shoes by the same travel. The travel replaces
    the coordinates of both shoes' main modes, on which the cam's forces do most work. The sum of
    the cam's forces replaces the equilibria in these modes.

    Parameters
    ----------
    blocks : the contact problem of the group in which each shoe has its own, given force
    with_forces : the problem with the strut and cam forces as functions of the pressures
    effects : the effects of the actuation forces
    forces : the actuation forces as functions of the pressures
    cam_shoes : indices of the two shoes under the cam
    cam_force_sum : sum of the cam's forces
    """
    A, q, B, C, h = with_forces
    n, k = B.shape
    of_coordinates = np.eye(k)
    by_pressure = np.zeros((k, n))
    of_loads = np.zeros(k)
    # `per_travel` is the change of each generalised coordinate per travel of the points of
    # actuation.
    per_travel = np.zeros(k)
    mains = []
    for i in cam_shoes:
        shoe = effects[i]
        mode = _index_of_mode_replaced_by_cam_travel(blocks, shoe)
        main = shoe.modes.start + mode
        mains.append(main)
        size = shoe.load_point_travel_by_modes[mode]
        # The main mode gives the tip (the point of actuation) the travel of the cam, less the
        # elastic travel and the travel by all other modes.
        by_pressure[main] = (
            -_elastic_actuation_point_travel_per_pressure(shoe, forces.by_pressure[i]) / size
        )
        elastic = shoe.load_point_travel_by_force * forces.without_pressure[i]
        of_loads[main] = -(elastic + shoe.load_point_travel_by_further_loads) / size
        # The subtraction also makes the entry of the main mode itself zero, because the coordinate
        # of this mode is no longer an unknown.
        of_coordinates[main, shoe.modes] -= shoe.load_point_travel_by_modes / size
        per_travel[main] = 1 / size
    # The travel of the cam replaces the coordinates of the main modes, and is the first unknown.
    kept = np.delete(np.arange(k), mains)
    of_coordinates = np.column_stack([per_travel, of_coordinates[:, kept]])
    sum_of_forces = -forces.by_pressure[cam_shoes].sum(axis=0)
    problem = ContactProblem(
        A=A + B @ by_pressure,
        q=q + B @ of_loads,
        B=B @ of_coordinates,
        C=np.vstack([sum_of_forces, C[kept]]),
        h=np.append(forces.without_pressure[cam_shoes].sum() - cam_force_sum, h[kept]),
    )
    return ContactProblemWithStrutAndCamForces(
        problem, *forces, of_coordinates, by_pressure, of_loads
    )


def _elastic_actuation_point_travel_per_pressure(
    shoe: EffectsOfActuationForceOnShoe, force_by_pressure: Floats
) -> Floats:
    """The elastic travel (n,) of a shoe's point of actuation per pressure on each contact node.

    The n contact nodes are those of the group. `force_by_pressure` (n,) is the shoe's actuation
    force per pressure at each of these nodes.
    """
    elastic = shoe.load_point_travel_by_force * force_by_pressure
    elastic[shoe.nodes] += shoe.load_point_travel_by_pressure
    return elastic


def contact_matrix_with_forces_as_unknowns(
    problem: ContactProblem,
    effects: list[EffectsOfActuationForceOnShoe],
    struts: list[tuple[int, int]],
    cam_shoes: list[int],
) -> Floats:
    """The matrix of the contact equations in which strut and cam forces are unknowns.

    The sensitivities of a solution are computed from this matrix. Its columns stand for the
    pressures p (n,), the coordinates y (k,) of the modes, the m forces F, and the travel d under a
    cam. The rows stand for the weighted gaps, the equilibria C p + W F = 0 with the work W of the
    forces on the modes, the equation for the force of each shoe, and under a cam the sum of the
    cam's forces. The equation for the force of a shoe takes the force from the brake file or from a
    strut. Under a cam it states that the shoe's point of actuation travels by d.

    Parameters
    ----------
    problem : the contact problem of the group in which each shoe has its own, given force
    effects : the effects of the m actuation forces
    struts : for each strut the indices of the pushing and of the pushed shoe
    cam_shoes : indices of the two shoes under a cam; empty without a cam
    """
    n, k = problem.B.shape
    count = len(effects)
    # `force` is the index of the first force among the rows and columns.
    force = n + k
    size = force + count + (1 if cam_shoes else 0)
    matrix = np.zeros((size, size))
    matrix[:n, :n] = problem.A
    matrix[:n, n:force] = problem.B
    matrix[n:force, :n] = problem.C
    matrix[force : force + count, force : force + count] = np.eye(count)
    for i, shoe in enumerate(effects):
        matrix[shoe.nodes, force + i] = shoe.gap_by_force
        matrix[n + shoe.modes.start : n + shoe.modes.stop, force + i] = shoe.work
    # A strut pushes the next shoe with the force on the foot of the pushing shoe.
    for source, to in struts:
        matrix[force + to, effects[source].nodes] = -effects[source].foot_force_by_pressure
        matrix[force + to, force + source] = -effects[source].foot_force_by_force
    # Under a cam the tip of each shoe, its point of actuation, travels by d. The last row is the
    # sum of the cam's forces.
    for i in cam_shoes:
        shoe, row = effects[i], matrix[force + i]
        row[shoe.nodes] = shoe.load_point_travel_by_pressure
        row[n + shoe.modes.start : n + shoe.modes.stop] = shoe.load_point_travel_by_modes
        row[force + i] = shoe.load_point_travel_by_force
        row[-1] = -1.0
        matrix[-1, force + i] = 1.0
    return matrix


def _index_of_mode_replaced_by_cam_travel(
    blocks: ContactProblem, shoe: EffectsOfActuationForceOnShoe
) -> int:
    """The index, within a shoe, of the rigid-body mode that the travel of a cam replaces.

    On this main mode the force does most work, relative to the squared effect of the mode on the
    gaps. The choice is the same at every friction coefficient.
    """
    # A rotation and a translation have different units. The work and the travel of the load point
    # are both proportional to the size of the mode. Their product is comparable after division by
    # the squared effect of the mode on the gaps.
    size = np.linalg.norm(blocks.B[:, shoe.modes], axis=0)
    return int((shoe.work * shoe.load_point_travel_by_modes / size**2).argmax())
