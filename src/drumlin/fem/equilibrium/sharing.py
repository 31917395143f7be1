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
from drumlin.contact.equations import Problem

NO_PUSH = 1e-9
"""Fraction of the largest force of a group up to which a shared force does not push.

A smaller force is the round-off of a force that has fallen to zero, and a negative force pulls: the
answer is refused. The fraction is far above round-off and far below any force in a brake file.
"""
WOULD_PULL = "no equilibrium, what pushes it would have to pull"


class ForceEffects(NamedTuple):
    """The effects of a shoe's actuation force, and the effects on the shoe's tip and foot.

    All values hold per newton of the force or per pascal of the pressures.

    Attributes
    ----------
    nodes : places of the shoe's n pressures among the pressures of the group
    modes : places of the shoe's k generalised coordinates among the coordinates of the group
    opened : opening (n,) of the weighted gaps by the force
    tip : elastic travel (n,) of the tip along the force, by the pressures
    yields : elastic travel of the tip along the force, by the force
    work : work (k,) of the force on the test modes
    moves : travel (k,) of the tip along the force, by the rigid-body modes
    bearing : force (n,) that the foot bears along a strut, by the pressures
    direct : force that the foot bears along a strut, by the force
    """

    nodes: slice | Ints
    modes: slice
    opened: Floats
    tip: Floats
    yields: float
    work: Floats
    moves: Floats
    bearing: Floats
    direct: float


@dataclass(frozen=True)
class Sharing:
    """The contact problem of m shoes that share forces, and the forces that its answer gives.

    Attributes
    ----------
    problem : the contact problem, whose last unknowns y' may hold the travel of a cam's tips
    fixed : part (m,) of the actuation forces that no pressure changes
    by_pressure : actuation forces (m, n) per pressure
    of_coordinates : generalised coordinates (k, k') of all shoes per unknown y'
    coordinates_by_pressure : generalised coordinates (k, n) of all shoes per pressure
    """

    problem: Problem
    fixed: Floats
    by_pressure: Floats
    of_coordinates: Floats
    coordinates_by_pressure: Floats

    def forces(self, p: Floats) -> Floats:
        """The actuation forces (m,) under the pressures p (n,)."""
        return self.fixed + self.by_pressure @ p

    def coordinates(self, p: Floats, y: Floats) -> Floats:
        """The generalised coordinates (k,) of all shoes, from pressures p (n,) and unknowns y'."""
        return self.of_coordinates @ y + self.coordinates_by_pressure @ p


class _Forces(NamedTuple):
    """The actuation forces (m,) of a group, fixed + by_pressure p.

    `fixed` (m,) does not depend on pressures, `by_pressure` (m, n) is the force per pressure.
    """

    fixed: Floats
    by_pressure: Floats


def share_forces(
    blocks: Problem,
    shoes: list[ForceEffects],
    own: Floats,
    links: list[tuple[int, int]],
    cam: list[int],
    total: float,
) -> Sharing:
    """Make the contact problem of shoes that share forces by struts or under a cam.

    The problem is linear in the friction coefficient.

    Parameters
    ----------
    blocks : the problem of the group if no shoe shares its force
    shoes : the effects of the m actuation forces
    own : the actuation forces (m,) in `blocks`
    links : numbers of the shoes from which and to which each strut pushes
    cam : numbers of the two shoes under a cam; empty without a cam
    total : sum of the cam's forces
    """
    forces = _shared_forces(blocks, shoes, own, links, cam)
    with_forces = _insert_forces(blocks, shoes, own, forces)
    n, k = blocks.B.shape
    if not cam:
        return Sharing(with_forces, *forces, np.eye(k), np.zeros((k, n)))
    return _replace_main_modes(blocks, with_forces, shoes, forces, cam, total)


def _shared_forces(
    blocks: Problem,
    shoes: list[ForceEffects],
    own: Floats,
    links: list[tuple[int, int]],
    cam: list[int],
) -> _Forces:
    """The actuation forces under a cam and struts; other shoes keep their own forces."""
    fixed = np.array(own, dtype=float)
    by_pressure = np.zeros((len(shoes), blocks.B.shape[0]))
    # The equilibrium in the main mode of a shoe gives the force of the cam.
    for i in cam:
        shoe = shoes[i]
        main = _main_mode(blocks, shoe)
        by_pressure[i] = -blocks.C[shoe.modes][main] / shoe.work[main]
        fixed[i] = 0.0
    # A strut passes on the force that the foot of the pushing shoe bears.
    for source, to in links:
        pushing = shoes[source]
        by_pressure[to, pushing.nodes] = pushing.bearing
        by_pressure[to] += pushing.direct * by_pressure[source]
        fixed[to] = pushing.direct * fixed[source]
    return _Forces(fixed, by_pressure)


def _insert_forces(
    blocks: Problem, shoes: list[ForceEffects], own: Floats, forces: _Forces
) -> Problem:
    """Replace the shoes' own forces (m,) in a contact problem by shared forces."""
    A, q, B, C, h = (np.array(part) for part in blocks)
    for i, shoe in enumerate(shoes):
        extra = forces.fixed[i] - own[i]
        A[shoe.nodes] += np.outer(shoe.opened, forces.by_pressure[i])
        q[shoe.nodes] += extra * shoe.opened
        C[shoe.modes] += np.outer(shoe.work, forces.by_pressure[i])
        h[shoe.modes] -= extra * shoe.work
    return Problem(A, q, B, C, h)


def _replace_main_modes(
    blocks: Problem,
    with_forces: Problem,
    shoes: list[ForceEffects],
    forces: _Forces,
    cam: list[int],
    total: float,
) -> Sharing:
    """Replace the coordinates of the two main modes under a cam by the travel of the cam's tips.

    Parameters
    ----------
    blocks : the problem of the group if no shoe shares its force
    with_forces : the problem with the shared forces
    shoes : the effects of the actuation forces
    forces : the shared forces
    cam : numbers of the two shoes under the cam
    total : sum of the cam's forces
    """
    A, q, B, C, h = with_forces
    n, k = B.shape
    of_coordinates = np.eye(k)
    by_pressure = np.zeros((k, n))
    # The generalised coordinates per travel of the tips.
    per_travel = np.zeros(k)
    mains = []
    for i in cam:
        shoe = shoes[i]
        mode = _main_mode(blocks, shoe)
        main = shoe.modes.start + mode
        mains.append(main)
        size = shoe.moves[mode]
        # The main mode moves the tip by the travel less the elastic travel and all other modes.
        elastic = shoe.yields * forces.by_pressure[i]
        elastic[shoe.nodes] += shoe.tip
        by_pressure[main] = -elastic / size
        # The entry of the main mode itself becomes zero.
        of_coordinates[main, shoe.modes] -= shoe.moves / size
        per_travel[main] = 1 / size
    kept = np.delete(np.arange(k), mains)
    of_coordinates = np.column_stack([per_travel, of_coordinates[:, kept]])
    sum_of_forces = -forces.by_pressure[cam].sum(axis=0)
    problem = Problem(
        A=A + B @ by_pressure,
        q=q,
        B=B @ of_coordinates,
        C=np.vstack([sum_of_forces, C[kept]]),
        h=np.append(-total, h[kept]),
    )
    return Sharing(problem, *forces, of_coordinates, by_pressure)


def full_equations(
    blocks: Problem, shoes: list[ForceEffects], links: list[tuple[int, int]], cam: list[int]
) -> Floats:
    """The matrix of all equations, in which the m forces F and the travel d of a cam are unknowns.

    The columns stand for the unknowns p (n,), y (k,), F (m,), and d under a cam. The rows stand for
    the weighted gaps, the equilibria C p + work F = 0, the equation that gives the force of each
    shoe, and under a cam the sum of the cam's forces. The force of a shoe is given in the brake
    file, by a strut, or under a cam by the travel of the shoe's tip.

    Parameters
    ----------
    blocks : the problem of the group if no shoe shares its force
    shoes : the effects of the m actuation forces
    links : numbers of the shoes from which and to which each strut pushes
    cam : numbers of the two shoes under a cam; empty without a cam
    """
    n, k = blocks.B.shape
    count = len(shoes)
    force = n + k
    size = force + count + (1 if cam else 0)
    matrix = np.zeros((size, size))
    matrix[:n, :n] = blocks.A
    matrix[:n, n:force] = blocks.B
    matrix[n:force, :n] = blocks.C
    matrix[force : force + count, force : force + count] = np.eye(count)
    for i, shoe in enumerate(shoes):
        matrix[shoe.nodes, force + i] = shoe.opened
        matrix[n + shoe.modes.start : n + shoe.modes.stop, force + i] = shoe.work
    for source, to in links:
        matrix[force + to, shoes[source].nodes] = -shoes[source].bearing
        matrix[force + to, force + source] = -shoes[source].direct
    for i in cam:
        shoe, row = shoes[i], matrix[force + i]
        row[shoe.nodes] = shoe.tip
        row[n + shoe.modes.start : n + shoe.modes.stop] = shoe.moves
        row[force + i] = shoe.yields
        row[-1] = -1.0
        matrix[-1, force + i] = 1.0
    return matrix


def _main_mode(blocks: Problem, shoe: ForceEffects) -> int:
    """The number, within a shoe, of the mode on which the force works most and that moves the tip.

    The choice is the same at every friction coefficient.
    """
    # Turns and slides have different units: the squared effect of a mode on the gaps is its scale.
    size = np.linalg.norm(blocks.B[:, shoe.modes], axis=0)
    return int((shoe.work * shoe.moves / size**2).argmax())
