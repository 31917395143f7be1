"""Shoes that share a force, by struts or under a cam, as one contact problem.

Each shoe i of a group has its own equations. Under its actuation force F_i the weighted gap opens
by opened_i F_i, and the equilibria read C_i p = -work_i F_i. The tip of the shoe is the point where
the force acts. The tip travels along the force by tip_i p + yields_i F_i elastically, and by
moves_i y_i with the generalised coordinates y_i of the rigid-body modes.

A strut pushes with the force that a foot bears: F_to = bearing p + direct F_from. A cam moves two
tips by the same travel d, and the sum of the cam's forces is given. Each shoe under a cam has a
main mode, on which the force works most. The equilibrium in the main mode gives F_i as a function
of p, and the travel of the tip gives the coordinate of the main mode. The travel d then remains as
the single coordinate of the two main modes, and the sum of the forces as its equilibrium.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.contact.equations import ContactProblem

LARGEST_FORCE_THAT_DOES_NOT_PUSH = 1e-9
"""Force of a strut or a cam, relative to the largest force of the group, that counts as zero.

A smaller force is the round-off of a force that has fallen to zero, and a negative force would
pull. In both cases the solution is refused. The value is far above round-off and far below any
force in a brake file.
"""
WOULD_PULL_TEXT = "no equilibrium, what pushes it would have to pull"
"""Text of the refusal of a shoe whose cam or strut would have to pull it."""


class ForceEffects(NamedTuple):
    """The effects of a shoe's actuation force on its gaps, and what moves its tip and its foot.

    The tip is the point of the shoe where the force acts. The foot is the end of the shoe that
    stands on an abutment or pushes a strut. All values hold per newton of the force or per pascal
    of the pressures.

    Attributes
    ----------
    nodes : places of the shoe's n pressures among the pressures of the group
    modes : places of the shoe's k generalised coordinates among the coordinates of the group
    gap_by_force : opening (n,) of the weighted gaps by the force
    tip_travel_by_pressure : elastic travel (n,) of the tip along the force, by the pressures
    tip_travel_by_force : elastic travel of the tip along the force, by the force
    tip_travel_by_further_loads : elastic travel of the tip by the further loads on the shoe
    work : work (k,) of the force on the test modes
    tip_travel_by_modes : travel (k,) of the tip along the force, by the rigid-body modes
    foot_force_by_pressure : force (n,) that the foot bears along a strut, by the pressures
    foot_force_by_force : force that the foot bears along a strut, by the force
    foot_force_by_further_loads : force that the foot bears by the further loads on the shoe
    """

    nodes: slice | Ints
    modes: slice
    gap_by_force: Floats
    tip_travel_by_pressure: Floats
    tip_travel_by_force: float
    tip_travel_by_further_loads: float
    work: Floats
    tip_travel_by_modes: Floats
    foot_force_by_pressure: Floats
    foot_force_by_force: float
    foot_force_by_further_loads: float


@dataclass(frozen=True)
class ForceSharing:
    """The contact problem of m shoes that share forces, and the forces that its solution gives.

    Attributes
    ----------
    problem : the contact problem; under a cam the first of its motions y' (k',) is the travel of
        the tips, in place of the coordinates of two modes
    forces_without_pressure : part (m,) of the actuation forces that no pressure changes
    forces_by_pressure : actuation forces (m, n) per pressure
    coordinates_by_unknown : generalised coordinates (k, k') of all shoes per unknown y'
    coordinates_by_pressure : generalised coordinates (k, n) of all shoes per pressure
    coordinates_of_loads : part (k,) of the generalised coordinates that no unknown changes
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
        """The generalised coordinates (k,) of all shoes, from pressures p (n,) and motions y (k',).

        y are the motions of the contact problem with shared forces.
        """
        by_unknowns = self.coordinates_by_unknown @ y + self.coordinates_by_pressure @ p
        return by_unknowns + self.coordinates_of_loads


class _LinearForces(NamedTuple):
    """The actuation forces (m,) of a group as a linear function of the pressures p (n,).

    The forces are without_pressure + by_pressure p, with `without_pressure` (m,) and `by_pressure`
    (m, n).
    """

    without_pressure: Floats
    by_pressure: Floats


def make_contact_problem_with_shared_forces(
    problem: ContactProblem,
    effects: list[ForceEffects],
    own_forces: Floats,
    struts: list[tuple[int, int]],
    cam_shoes: list[int],
    cam_force_sum: float,
) -> ForceSharing:
    """Make the contact problem of shoes that share forces by struts or under a cam.

    The problem stays a linear function of the friction coefficient.

    Parameters
    ----------
    problem : the problem of the group if no shoe shares its force
    effects : the effects of the m actuation forces
    own_forces : the actuation forces (m,) in `problem`
    struts : numbers of the shoes from which and to which each strut pushes
    cam_shoes : numbers of the two shoes under a cam; empty without a cam
    cam_force_sum : sum of the cam's forces
    """
    forces = _actuation_forces_linear_in_pressures(problem, effects, own_forces, struts, cam_shoes)
    with_forces = _contact_problem_with_forces_replaced(problem, effects, own_forces, forces)
    n, k = problem.B.shape
    if not cam_shoes:
        return ForceSharing(with_forces, *forces, np.eye(k), np.zeros((k, n)), np.zeros(k))
    return _contact_problem_with_cam_travel_as_unknown(
        problem, with_forces, effects, forces, cam_shoes, cam_force_sum
    )


def _actuation_forces_linear_in_pressures(
    problem: ContactProblem,
    effects: list[ForceEffects],
    own_forces: Floats,
    struts: list[tuple[int, int]],
    cam_shoes: list[int],
) -> _LinearForces:
    """The actuation force of each shoe as a linear function of the pressures.

    A cam or a strut gives the force of its shoes; other shoes keep their own forces.
    """
    fixed = np.array(own_forces, dtype=float)
    by_pressure = np.zeros((len(effects), problem.B.shape[0]))
    # The force of the cam follows from the equilibrium in the main mode of each shoe.
    for i in cam_shoes:
        shoe = effects[i]
        main = _index_of_main_rigid_body_mode(problem, shoe)
        by_pressure[i] = -problem.C[shoe.modes][main] / shoe.work[main]
        # Further loads on the shoe leave a part of the equilibrium to the force of the cam.
        of_loads = problem.h[shoe.modes][main] + own_forces[i] * shoe.work[main]
        fixed[i] = of_loads / shoe.work[main]
    # A strut passes on the force that the foot of the pushing shoe bears.
    for source, to in struts:
        pushing = effects[source]
        by_pressure[to, pushing.nodes] = pushing.foot_force_by_pressure
        by_pressure[to] += pushing.foot_force_by_force * by_pressure[source]
        fixed[to] = pushing.foot_force_by_force * fixed[source]
        fixed[to] += pushing.foot_force_by_further_loads
    return _LinearForces(fixed, by_pressure)


def _contact_problem_with_forces_replaced(
    problem: ContactProblem, effects: list[ForceEffects], own_forces: Floats, forces: _LinearForces
) -> ContactProblem:
    """Return a contact problem with shared forces in place of the shoes' own forces (m,).

    `forces` are the shared forces as linear functions of the pressures. Their part that depends on
    pressures changes the matrices A and C, the other part changes the vectors q and h.
    """
    A, q, B, C, h = (np.array(part) for part in problem)
    for i, shoe in enumerate(effects):
        extra = forces.without_pressure[i] - own_forces[i]
        A[shoe.nodes] += np.outer(shoe.gap_by_force, forces.by_pressure[i])
        q[shoe.nodes] += extra * shoe.gap_by_force
        C[shoe.modes] += np.outer(shoe.work, forces.by_pressure[i])
        h[shoe.modes] -= extra * shoe.work
    return ContactProblem(A, q, B, C, h)


def _contact_problem_with_cam_travel_as_unknown(
    blocks: ContactProblem,
    with_forces: ContactProblem,
    effects: list[ForceEffects],
    forces: _LinearForces,
    cam_shoes: list[int],
    cam_force_sum: float,
) -> ForceSharing:
    """Return the contact problem under a cam, with the travel of the shoes' tips as an unknown.

    The cam moves the tips of its two shoes by the same travel. The travel replaces the coordinates
    of the main modes of both shoes, and the sum of the cam's forces replaces their equilibria.

    Parameters
    ----------
    blocks : the problem of the group if no shoe shares its force
    with_forces : the problem with the shared forces
    effects : the effects of the actuation forces
    forces : the shared forces
    cam_shoes : numbers of the two shoes under the cam
    cam_force_sum : sum of the cam's forces
    """
    A, q, B, C, h = with_forces
    n, k = B.shape
    of_coordinates = np.eye(k)
    by_pressure = np.zeros((k, n))
    of_loads = np.zeros(k)
    # These are the changes of the generalised coordinates per travel of the tips.
    per_travel = np.zeros(k)
    mains = []
    for i in cam_shoes:
        shoe = effects[i]
        mode = _index_of_main_rigid_body_mode(blocks, shoe)
        main = shoe.modes.start + mode
        mains.append(main)
        size = shoe.tip_travel_by_modes[mode]
        # The main mode moves the tip by the travel, less the elastic travel and the travel by all
        # other modes.
        by_pressure[main] = -_elastic_tip_travel_by_pressures(shoe, forces.by_pressure[i]) / size
        elastic = shoe.tip_travel_by_force * forces.without_pressure[i]
        of_loads[main] = -(elastic + shoe.tip_travel_by_further_loads) / size
        # The entry of the main mode itself becomes zero.
        of_coordinates[main, shoe.modes] -= shoe.tip_travel_by_modes / size
        per_travel[main] = 1 / size
    # The coordinates of the main modes give way to the travel, which comes first.
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
    return ForceSharing(problem, *forces, of_coordinates, by_pressure, of_loads)


def _elastic_tip_travel_by_pressures(shoe: ForceEffects, force_by_pressure: Floats) -> Floats:
    """The elastic travel (n,) of a shoe's tip per pressure on each contact node of the group.

    `force_by_pressure` (n,) is the shoe's actuation force per pressure.
    """
    elastic = shoe.tip_travel_by_force * force_by_pressure
    elastic[shoe.nodes] += shoe.tip_travel_by_pressure
    return elastic


def contact_matrix_with_forces_as_unknowns(
    problem: ContactProblem,
    effects: list[ForceEffects],
    struts: list[tuple[int, int]],
    cam_shoes: list[int],
) -> Floats:
    """The matrix of the contact with shared forces, in which the forces themselves are unknowns.

    The sensitivities of a solution are computed from this matrix. Its columns stand for the
    pressures p (n,), the coordinates y (k,) of the modes, the m forces F, and the travel d under a
    cam. The rows stand for the weighted gaps, the equilibria C p + work F = 0, the equation that
    gives the force of each shoe, and under a cam the sum of the cam's forces. The force of a shoe
    is given in the brake file, by a strut, or under a cam by the travel of the shoe's tip.

    Parameters
    ----------
    problem : the problem of the group if no shoe shares its force
    effects : the effects of the m actuation forces
    struts : numbers of the shoes from which and to which each strut pushes
    cam_shoes : numbers of the two shoes under a cam; empty without a cam
    """
    n, k = problem.B.shape
    count = len(effects)
    # `force` is the first row and the first column of the forces.
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
    # A strut passes on the force that the foot of the pushing shoe bears.
    for source, to in struts:
        matrix[force + to, effects[source].nodes] = -effects[source].foot_force_by_pressure
        matrix[force + to, force + source] = -effects[source].foot_force_by_force
    # Under a cam the tip of each shoe travels by d. The last row is the sum of the cam's forces.
    for i in cam_shoes:
        shoe, row = effects[i], matrix[force + i]
        row[shoe.nodes] = shoe.tip_travel_by_pressure
        row[n + shoe.modes.start : n + shoe.modes.stop] = shoe.tip_travel_by_modes
        row[force + i] = shoe.tip_travel_by_force
        row[-1] = -1.0
        matrix[-1, force + i] = 1.0
    return matrix


def _index_of_main_rigid_body_mode(blocks: ContactProblem, shoe: ForceEffects) -> int:
    """The number, within a shoe, of the rigid-body mode that gives way to the travel of a cam.

    On this main mode the force does most work, and the mode moves the tip. The choice is the same
    at every friction coefficient.
    """
    # Turns and slides have different units. The squared effect of a mode on the gaps scales its
    # work.
    size = np.linalg.norm(blocks.B[:, shoe.modes], axis=0)
    return int((shoe.work * shoe.tip_travel_by_modes / size**2).argmax())
