"""The equations of a group of shoes without static condensation, refined in long double.

A solve usually eliminates the displacements inside the bodies (static condensation). The full
system keeps them. Its unknowns are all displacements of the shoes and of the drum ring, the
generalised coordinates y (sizes of the rigid-body motions), and the pressures p of the nodes in
contact, the contact set. The displacements of a shoe are u = v + r y with its rigid-body modes r
and the displacements v by deformation. Rigid-body modes cause no strain. The product K r of the
stiffness and the modes is therefore zero apart from round-off, and the system omits it. All
quantities are per newton of the largest force:

    K v + (N - drag T)^T p = f,    r^T (N - drag T)^T p = moment,
    M (g + p/eps) - N v - N r y + N_ring u_ring = 0  on the contact set

The stiffness is assembled in long double. LU factors of the system in double precision (SuperLU,
with pivoting) are the preconditioner of an iterative refinement, whose residuals are computed in
long double (Wilkinson; Higham, Accuracy and Stability of Numerical Algorithms, ch. 12). If the
refinement converges, its solution satisfies the finite-element equations to all digits of double
precision. The difference from a solution by static condensation then shows how many digits of the
latter are right, because the two use different arithmetic and different orders of operations.

The condition number of the torque is the condition number of the linear functional T = l . x of a
system A x = b, for changes of each entry by a fraction of the entry (Skeel; Higham, ch. 7):

    |z|^T (|A| |x| + |b|) / |T|  with  A^T z = l
"""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from drumlin.base.arrays import Bools, Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.contact.active_set import LARGEST_ROUND_OFF_OF_PRESSURE_OR_GAP
from drumlin.fem.equilibrium.group import ShoeGroup
from drumlin.fem.preparation.bodies import unit_load_factors_under_all_loads
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.substructure.body import DEGREES_OF_FREEDOM_OF_BODY_FRAME, sparse_stiffness_of_body
from drumlin.fem.substructure.elasticity import elastic_layers_of_shoe
from drumlin.fem.substructure.ring import stiffness_of_drum_ring_without_supports

LONG_DOUBLE_TYPE = np.longdouble
"""Floating-point type with more digits than double, in which residuals are computed."""
MAX_CORRECTIONS_OF_ITERATIVE_REFINEMENT = 30
"""Number of corrections after which iterative refinement ends even if it has not converged."""
RELATIVE_PRESSURE_CORRECTION_AT_CONVERGENCE = 1e-14
"""Correction of the pressures, relative to the largest pressure, below which refinement ends.

The value is some 45 times the relative spacing of double-precision numbers. After a larger
correction another correction follows.
"""
LARGEST_RATIO_OF_SUCCESSIVE_CORRECTIONS = 0.5
"""Ratio of a correction to the correction before, above which iterative refinement ends.

The ratio counts from the third correction on. The size of the last correction,
`RefinedSolutionOfShoeGroup.correction`, tells how well the refinement has converged.
"""
MAX_CONTACT_SETS_OF_REFINEMENT = 40
"""Largest number of contact sets on which the full system of a group is solved and refined.

A contact set is a set of nodes in contact. If the set still changes after this number of solutions,
the brake is refused. The first set is the contact set of the solution by static condensation.
"""


class RefinedSolutionOfShoeGroup(NamedTuple):
    """The refined solution of the full system of a group of shoes, per newton of the largest force.

    Attributes
    ----------
    p : pressures (n_i,) of each shoe [1/m^2]
    last_correction : last correction (n_i,) of the pressures of each shoe [1/m^2]
    coordinates : generalised coordinates (k_i,) of each shoe, the sizes of its rigid-body motions
    torque : torque of all shoes per newton [m]
    scaled_weighted_gaps : weighted gaps (n,) of all nodes, the integrals of the gap times each
        node's shape function. Each weighted gap is a sum of terms; all gaps are divided by the
        largest sum of the absolute values of these terms.
    correction : largest entry of the last correction, relative to the largest pressure
    corrections : number of corrections
    contact_sets : number of contact sets that were tried
    condition_number_of_torque : condition number of the torque for relative changes of each entry
        of the system
    """

    p: tuple[Floats, ...]
    last_correction: tuple[Floats, ...]
    coordinates: tuple[Floats, ...]
    torque: float
    scaled_weighted_gaps: Floats
    correction: float
    corrections: int
    contact_sets: int
    condition_number_of_torque: float


@dataclass(frozen=True)
class FullEquationSystemOfShoeGroup:
    """The full system of a group of shoes: matrix and right side in long double.

    No unknown is eliminated by static condensation.

    Attributes
    ----------
    matrix : sparse matrix (unknowns, unknowns); the rows of the pressures come last
    right_side : right side (unknowns,)
    pressures : slice of each shoe's pressures among the unknowns
    coordinates : slice of each shoe's generalised coordinates (rigid-body motion) among the
        unknowns
    torque_factors_of_unknowns : (unknowns,) torque per unknown; the torque is the scalar product of
        these factors with the unknowns
    scale_factors : (unknowns,) factors that give rows and columns similar sizes, see
        `_scale_factors_of_full_system`
    """

    matrix: Any
    right_side: Any
    pressures: tuple[slice, ...]
    coordinates: tuple[slice, ...]
    torque_factors_of_unknowns: Floats
    scale_factors: Floats

    @property
    def index_of_first_pressure_unknown(self) -> int:
        """Index of the first pressure among the unknowns."""
        return self.pressures[0].start


# The following functions assemble the full system.


class _ShoeBlockOfFullSystem(NamedTuple):
    """The rows and columns of one shoe in the full system of its group, in long double.

    The unknowns of the shoe are the displacements of its inner nodes, then of its n contact nodes,
    and its generalised coordinates, which have no stiffness.

    Attributes
    ----------
    K : stiffness (unknowns, unknowns)
    pressure_forces : forces (unknowns, n) on the unknowns per nodal pressure
    gap_closures : closure (n, unknowns) of the weighted gap at each contact node per unknown
    load : force (unknowns,) of all loads on the shoe on each unknown
    """

    K: Any
    pressure_forces: Any
    gap_closures: Any
    load: Any


class _RingCouplingMatricesOfShoe(NamedTuple):
    """The normal and tangential coupling matrices N and T of one shoe's n nodes with the ring."""

    N: Any
    T: Any


class _RingBlockOfFullSystem(NamedTuple):
    """The drum's ring in the full system: its stiffness `K`, and its coupling with each shoe.

    The unknowns are the displacements of the ring's nodes. A ring whose far edge is free also has
    the three forces on this edge as unknowns.
    """

    K: Any
    couplings: list[_RingCouplingMatricesOfShoe]


@dataclass(frozen=True)
class _OrderOfFullSystemUnknowns:
    """The order of the unknowns in a full system.

    The unknowns of each shoe come first, then those of the ring, then all pressures.

    Attributes
    ----------
    first_unknown_of_each_block : index of the first unknown of each shoe and of the ring; the last
        entry is the total number of these unknowns
    first_pressure_unknown_of_each_shoe : index of the first pressure of each shoe; the last entry
        is the number of all unknowns
    """

    first_unknown_of_each_block: Any
    first_pressure_unknown_of_each_shoe: Any


def assemble_full_system_of_group(
    group: ShoeGroup, *, relative_to_rigid_motion: bool = True
) -> FullEquationSystemOfShoeGroup:
    """Assemble the full system of a group of shoes, with equations for all nodes as if in contact.

    Parameters
    ----------
    group : the group of shoes
    relative_to_rigid_motion : whether the unknown displacements are due to deformation alone,
        without the rigid-body motion of the shoe. If False, they are measured from the unloaded
        shoe, which keeps more digits if the drum holds the lining and a soft shoe turns behind it.
    """
    members = range(len(group.members))
    shoe_blocks = [
        _assemble_shoe_block_of_full_system(group, k, relative_to_rigid_motion) for k in members
    ]
    ring = (
        _assemble_ring_block_of_full_system(group.prepared_model, group.brake)
        if group.prepared_model.ring is not None
        else None
    )
    stiffnesses = [block.K for block in shoe_blocks] + ([ring.K] if ring else [])
    # The numbers of unknowns of the bodies give the position of each unknown in the full system.
    sizes = [int(block.shape[0]) for block in stiffnesses]
    counts = [len(gap) for gap in group.gaps_of_unloaded_linings]
    starts = np.cumsum([0, *sizes])
    layout = _OrderOfFullSystemUnknowns(starts, np.cumsum([starts[-1], *counts]))
    blocks = _blocks_of_full_system_matrix(group, shoe_blocks, ring, stiffnesses)
    matrix = _sparse_matrix_from_blocks(blocks, [*sizes, *counts])
    ends = layout.first_unknown_of_each_block[1 : len(members) + 1]
    return FullEquationSystemOfShoeGroup(
        matrix=matrix,
        right_side=_right_side_of_full_system(group, shoe_blocks, layout),
        pressures=tuple(
            slice(int(a), int(b)) for a, b in pairwise(layout.first_pressure_unknown_of_each_shoe)
        ),
        coordinates=tuple(
            slice(int(end) - modes.actuation_work.size, int(end))
            for end, modes in zip(ends, group.rigid_body_modes_of_shoes, strict=True)
        ),
        torque_factors_of_unknowns=_torque_factors_of_full_system_unknowns(group, layout),
        scale_factors=_scale_factors_of_full_system(
            matrix, int(layout.first_pressure_unknown_of_each_shoe[0])
        ),
    )


def _blocks_of_full_system_matrix(
    group: ShoeGroup,
    shoe_blocks: list[_ShoeBlockOfFullSystem],
    ring: _RingBlockOfFullSystem | None,
    stiffnesses: list[Any],
) -> list[list[Any]]:
    """The blocks of the full system's matrix, by block rows and block columns; None for zeros.

    There is a block row for each shoe, one for the ring, and one for the pressures of each shoe.

    Parameters
    ----------
    group : the group of shoes
    shoe_blocks : the part of each shoe in the system
    ring : the part of the ring in the system; None for a rigid drum
    stiffnesses : stiffness matrix of each shoe, and of the ring if there is one
    """
    count = len(stiffnesses) + len(shoe_blocks)
    blocks: list[list[Any]] = [[None] * count for _ in range(count)]
    for k, block in enumerate(stiffnesses):
        blocks[k][k] = block
    ring_row = len(stiffnesses) - 1
    for k, shoe_block in enumerate(shoe_blocks):
        M = group.substructures_of_shoes[k].coupling.M
        at = len(stiffnesses) + k
        blocks[k][at], blocks[at][k] = shoe_block.pressure_forces, -shoe_block.gap_closures
        blocks[at][at] = sp.csr_matrix(
            (M / group.contact_stiffness_per_area_of_shoes[k]).astype(LONG_DOUBLE_TYPE)
        )
        if ring is not None:
            N, T = ring.couplings[group.members[k]]
            drag = group.brake.signed_friction_stress_over_pressure(group.shoes[k])
            drags = drag * group.node_friction_over_shoe_friction(k)[:, None]
            blocks[ring_row][at], blocks[at][ring_row] = -(N - T.multiply(drags)).T, N
    return blocks


def _right_side_of_full_system(
    group: ShoeGroup, shoe_blocks: list[_ShoeBlockOfFullSystem], layout: _OrderOfFullSystemUnknowns
) -> Any:
    """The right side (unknowns,) of the full system.

    The right side consists of the loads on the shoes and the negative weighted gaps of the unloaded
    linings.
    """
    right = np.zeros(int(layout.first_pressure_unknown_of_each_shoe[-1]), dtype=LONG_DOUBLE_TYPE)
    for k, shoe_block in enumerate(shoe_blocks):
        right[layout.first_unknown_of_each_block[k] : layout.first_unknown_of_each_block[k + 1]] = (
            shoe_block.load
        )
        M = group.substructures_of_shoes[k].coupling.M.astype(LONG_DOUBLE_TYPE)
        gap = (
            group.gaps_of_unloaded_linings[k].astype(LONG_DOUBLE_TYPE)
            / group.largest_actuation_force
        )
        right[
            layout.first_pressure_unknown_of_each_shoe[
                k
            ] : layout.first_pressure_unknown_of_each_shoe[k + 1]
        ] = -(M @ gap)
    return right


def _torque_factors_of_full_system_unknowns(
    group: ShoeGroup, layout: _OrderOfFullSystemUnknowns
) -> Floats:
    """The factors (unknowns,) that give the torque of the group as a sum over the unknowns.

    The factor of a pressure [m^3] contains the friction coefficient. The factors of all other
    unknowns are 0.
    """
    lever = np.zeros(int(layout.first_pressure_unknown_of_each_shoe[-1]))
    for k, body in enumerate(group.substructures_of_shoes):
        at = slice(
            layout.first_pressure_unknown_of_each_shoe[k],
            layout.first_pressure_unknown_of_each_shoe[k + 1],
        )
        friction = group.brake.friction_coefficient_of_shoe_at_zero_pressure(group.shoes[k])
        lever[at] = friction * body.coupling.lever * group.node_friction_over_shoe_friction(k)
    return lever


def _assemble_shoe_block_of_full_system(
    group: ShoeGroup, k: int, relative_to_rigid_motion: bool
) -> _ShoeBlockOfFullSystem:
    """The part of shoe `k` of a group in the full system, in long double.

    With `relative_to_rigid_motion` the unknown displacements are due to deformation alone, without
    the rigid-body motion of the shoe.
    """
    body, shoe = group.substructures_of_shoes[k], group.shoes[k]
    modes = group.rigid_body_modes_of_shoes[k]
    constraints = body.condensed.multi_point_constraints.matrix.astype(LONG_DOUBLE_TYPE)
    # The prepared model has the stiffness in double precision only, so that it is assembled again
    # in long double.
    K = sparse_stiffness_of_body(body.basis, elastic_layers_of_shoe(shoe), precise=True)
    constrained = (constraints.T @ K @ constraints).tocsr()
    inside, n = constrained.shape[0] - DEGREES_OF_FREEDOM_OF_BODY_FRAME, len(body.line.nodes)
    N, T = body.coupling.N.astype(LONG_DOUBLE_TYPE), body.coupling.T.astype(LONG_DOUBLE_TYPE)
    drag = LONG_DOUBLE_TYPE(group.brake.signed_friction_stress_over_pressure_in_shoe_frame(shoe))
    drags = drag * group.node_friction_over_shoe_friction(k)[:, None].astype(LONG_DOUBLE_TYPE)
    pushing = (N - drags * T).T
    contact_modes = modes.contact_modes.astype(LONG_DOUBLE_TYPE)
    test_modes = modes.test_modes.astype(LONG_DOUBLE_TYPE)
    pin_motion = modes.pin_motion.astype(LONG_DOUBLE_TYPE)
    count = contact_modes.shape[1]
    # The displacements of the contact nodes come last, two for each node. `first` is the index of
    # the first of these displacements.
    first, shape = inside - 2 * n, (inside + count, n)
    closures = _sparse_matrix_with_values_from_row(N.T, shape, row=first)
    modes_to_nodes = None
    if relative_to_rigid_motion:
        by_modes = (N @ contact_modes).T
        closures = closures + _sparse_matrix_with_values_from_row(by_modes, shape, row=inside)
    else:
        # The generalised coordinates move the supports of the body, and the supports deform the
        # body.
        modes_to_nodes = (constrained[:inside, inside:] @ sp.csr_matrix(pin_motion)).tocsr()
    on_nodes = _sparse_matrix_with_values_from_row(pushing, shape, row=first)
    on_modes = _sparse_matrix_with_values_from_row(test_modes.T @ pushing, shape, row=inside)
    stiffness_blocks = [[constrained[:inside, :inside], modes_to_nodes], [None, None]]
    return _ShoeBlockOfFullSystem(
        K=_sparse_matrix_from_blocks(stiffness_blocks, [inside, count]),
        pressure_forces=on_nodes + on_modes,
        gap_closures=closures.T.tocsr(),
        load=_loads_on_unknowns_of_shoe(group, k, inside),
    )


def _loads_on_unknowns_of_shoe(group: ShoeGroup, k: int, inside: int) -> Floats:
    """The loads on shoe `k` as forces on its unknowns in the full system, in long double.

    They are nodal forces on the first `inside` unknowns, the displacements, and generalised forces
    on the rigid-body modes. All are per newton of `largest_actuation_force`.
    """
    body, shoe = group.substructures_of_shoes[k], group.shoes[k]
    share = LONG_DOUBLE_TYPE(abs(shoe.actuation.force)) / group.largest_actuation_force
    acting = unit_load_factors_under_all_loads(body, shoe, shoe.actuation.force).astype(
        LONG_DOUBLE_TYPE
    )
    load = body.condensed.unit_loads_on_reduced_unknowns.astype(LONG_DOUBLE_TYPE) @ (
        acting / group.largest_actuation_force
    )
    work = group.rigid_body_modes_of_shoes[k].actuation_work.astype(LONG_DOUBLE_TYPE)
    modes = group.rigid_body_modes_of_shoes[k]
    further = modes.work_of_further_loads.astype(LONG_DOUBLE_TYPE) / group.largest_actuation_force
    return np.append(load[:inside], share * work + further)


def _assemble_ring_block_of_full_system(
    scene: PreparedModel, brake: Brake
) -> _RingBlockOfFullSystem:
    """The rows and columns of the drum's elastic ring in the full system, in long double."""
    ring, part = scene.ring, brake.ring
    # The function is called only for models with an elastic ring.
    assert ring is not None and part is not None
    basis = ring.basis
    K = stiffness_of_drum_ring_without_supports(basis, part, precise=True).tocsr()
    # Nodes on a fixed edge of the ring do not move, so that their displacements are no unknowns.
    keep = np.ones(2 * basis.N, dtype=bool)
    keep[2 * ring.held] = keep[2 * ring.held + 1] = False
    K = K[keep][:, keep]
    if ring.rim_balance is not None:
        forces = ring.rim_balance.forces.transpose(1, 0, 2).reshape(
            -1, DEGREES_OF_FREEDOM_OF_BODY_FRAME
        )
        rim = sp.csr_matrix(forces.astype(LONG_DOUBLE_TYPE))
        K = _sparse_matrix_from_blocks(
            [[K, rim], [rim.T.tocsr(), None]], [2 * basis.N, DEGREES_OF_FREEDOM_OF_BODY_FRAME]
        )
    # `place` has the number of each displacement among the displacements that are kept.
    place = np.cumsum(keep) - 1
    nodes = ring.line.nodes
    dofs = place[np.column_stack([2 * nodes, 2 * nodes + 1]).ravel()]
    couplings = []
    for normal, tangential in ring.coupling_matrices:
        N, T = (
            _sparse_matrix_with_columns_at_indices(part, dofs, K.shape[0])
            for part in (normal, tangential)
        )
        couplings.append(_RingCouplingMatricesOfShoe(N, T))
    return _RingBlockOfFullSystem(K, couplings)


def _sparse_matrix_with_columns_at_indices(values: Floats, dofs: Any, count: int) -> Any:
    """A sparse matrix with `count` columns: column dofs[j] is column j of `values`, the rest 0."""
    entries = sp.coo_matrix(values.astype(LONG_DOUBLE_TYPE))
    places = (entries.row, dofs[entries.col])
    return sp.csr_matrix((entries.data, places), shape=(entries.shape[0], count))


def _sparse_matrix_with_values_from_row(values: Any, size: tuple[int, int], row: int) -> Any:
    """A sparse matrix of a given size, with the dense `values` in the rows from `row` on."""
    i, j = np.nonzero(values)
    return sp.csr_matrix((values[i, j], (i + row, j)), shape=size)


def _sparse_matrix_from_blocks(blocks: list[list[Any]], sizes: list[int]) -> Any:
    """The sparse matrix in long double that consists of the given blocks; None is a zero block.

    `sizes` are the numbers of rows of the block rows, and of columns of the block columns.
    """
    starts = np.cumsum([0, *sizes])
    data, rows, columns = [], [], []
    for a, line in enumerate(blocks):
        for b, block in enumerate(line):
            if block is None:
                continue
            entries = block.tocoo()
            data.append(entries.data)
            rows.append(entries.row + starts[a])
            columns.append(entries.col + starts[b])
    places = (np.concatenate(rows), np.concatenate(columns))
    values = np.concatenate(data).astype(LONG_DOUBLE_TYPE)
    return sp.csr_matrix((values, places), shape=(starts[-1], starts[-1]))


def _scale_factors_of_full_system(matrix: Any, first: int) -> Floats:
    """Scale factors (unknowns,) that give the rows and columns of the full system similar sizes.

    The scaled matrix has a unit diagonal for unknowns with stiffness. All other rows get the length
    one: first the rows of the pressures, then the rows of the generalised coordinates and of the
    forces on the far edge of a free ring. `first` is the number of the first pressure.
    """
    diagonal = np.abs(matrix.diagonal()).astype(float)
    stiff = diagonal > 0
    stiff[first:] = False
    pressures = np.arange(len(diagonal)) >= first
    scale = np.zeros(len(diagonal))
    scale[stiff] = 1 / np.sqrt(diagonal[stiff])
    squares = matrix.multiply(matrix).astype(float)
    scale[pressures] = 1 / np.sqrt((squares @ scale**2 + diagonal)[pressures])
    rest = ~(stiff | pressures)
    scale[rest] = 1 / np.sqrt(np.maximum(squares @ scale**2, np.finfo(float).tiny)[rest])
    return scale


# The following functions solve the full system.


def solve_full_system_by_iterative_refinement(
    system: FullEquationSystemOfShoeGroup, active: Bools, order: str = "COLAMD"
) -> RefinedSolutionOfShoeGroup:
    """Solve a full system by iterative refinement, and find its contact set.

    Nodes leave or join the given first set until no node in contact has a tension and no other node
    penetrates the drum.

    Parameters
    ----------
    system : the full system
    active : (n,) whether each node of all shoes touches at the start
    order : SuperLU's name for the order in which the unknowns are eliminated

    Raises
    ------
    NoAnswer
        for a singular system, and if the contact set still changes after
        MAX_CONTACT_SETS_OF_REFINEMENT sets. A refinement that does not converge raises nothing; the
        `correction` of the result tells how far it has converged.
    """
    first = system.index_of_first_pressure_unknown
    active = active.copy()
    rows, right = system.matrix[first:], system.right_side[first:]
    for contact_sets in range(1, MAX_CONTACT_SETS_OF_REFINEMENT + 1):
        on = np.concatenate([np.ones(first, dtype=bool), active])
        solution = _refined_solution_on_contact_set(system, on, order)
        x = solution.x
        p = x[first:]
        w = (rows @ x - right).astype(float)
        bound = (abs(rows) @ np.abs(x) + np.abs(right)).astype(float)
        # Nodes under tension leave the contact set, and nodes that penetrate the drum join it.
        tension = p < -LARGEST_ROUND_OFF_OF_PRESSURE_OR_GAP * np.abs(p).max(initial=0)
        penetrates = w < -LARGEST_ROUND_OFF_OF_PRESSURE_OR_GAP * bound
        change = np.where(active, tension, penetrates)
        if not change.any():
            gap = w / (bound.max(initial=0.0) or 1.0)
            return _divide_refined_solution_into_shoes(system, on, solution, gap, contact_sets)
        active ^= change
    raise NoAnswer(
        f"not converged: the contact set still changes after {MAX_CONTACT_SETS_OF_REFINEMENT} "
        f"refined solutions"
    )


class _RefinedSolutionOnContactSet(NamedTuple):
    """The refined solution of the full system on one contact set.

    Attributes
    ----------
    x : unknowns (unknowns,) in long double
    last_correction : last correction (unknowns,) of x
    correction : largest entry of the last correction among the pressures, relative to the largest
        pressure
    corrections : number of corrections
    factors : LU factors of the scaled system
    """

    x: Any
    last_correction: Any
    correction: float
    corrections: int
    factors: Any


def _divide_refined_solution_into_shoes(
    system: FullEquationSystemOfShoeGroup,
    on: Bools,
    solution: _RefinedSolutionOnContactSet,
    gap: Floats,
    contact_sets: int,
) -> RefinedSolutionOfShoeGroup:
    """The refined solution of a group on its final contact set, divided into shoes.

    Parameters
    ----------
    system : the full system
    on : (unknowns,) whether each unknown is part of the system on this contact set
    solution : the refined solution
    gap : (n,) weighted gaps of all nodes, as in `RefinedSolutionOfShoeGroup`
    contact_sets : number of contact sets that were tried
    """
    x = solution.x
    torque = float(system.torque_factors_of_unknowns @ x)
    return RefinedSolutionOfShoeGroup(
        p=tuple(np.maximum(x[part].astype(float), 0.0) for part in system.pressures),
        last_correction=tuple(
            solution.last_correction[part].astype(float) for part in system.pressures
        ),
        coordinates=tuple(x[part].astype(float) for part in system.coordinates),
        torque=torque,
        scaled_weighted_gaps=gap,
        correction=solution.correction,
        corrections=solution.corrections,
        contact_sets=contact_sets,
        condition_number_of_torque=_condition_number_of_torque(system, on, solution, torque),
    )


def _refined_solution_on_contact_set(
    system: FullEquationSystemOfShoeGroup, on: Bools, order: str
) -> _RefinedSolutionOnContactSet:
    """The refined solution of a full system on one contact set.

    `on` (unknowns,) marks the unknowns that are solved for. The other unknowns, the pressures of
    open nodes, are zero. `order` is SuperLU's name for the order of elimination.
    """
    at = np.flatnonzero(on)
    A, b, scale = system.matrix[at][:, at], system.right_side[at], system.scale_factors[at]
    D = sp.diags(scale.astype(LONG_DOUBLE_TYPE))
    A, b = (D @ A @ D).tocsr(), scale * b
    try:
        factors = splu(A.astype(float).tocsc(), permc_spec=order)
    except RuntimeError as error:
        raise NoAnswer("no equilibrium: the whole system is singular") from error
    x = np.zeros(len(at), dtype=LONG_DOUBLE_TYPE)
    first = np.count_nonzero(on[: system.index_of_first_pressure_unknown])
    residual, previous = b, math.inf
    for corrections in range(1, MAX_CORRECTIONS_OF_ITERATIVE_REFINEMENT + 1):
        # The residual is divided by its largest entry before it is rounded to double precision, so
        # that no small entry is lost.
        largest = float(np.abs(residual).max()) or 1.0
        dx = factors.solve((residual / largest).astype(float)) * LONG_DOUBLE_TYPE(largest)
        x += dx
        residual = b - A @ x
        p = scale[first:] * x[first:]
        change = scale[first:] * dx[first:]
        correction = float(np.abs(change).max() / (np.abs(p).max() or 1))
        stalls = corrections > 2 and correction > LARGEST_RATIO_OF_SUCCESSIVE_CORRECTIONS * previous
        if correction < RELATIVE_PRESSURE_CORRECTION_AT_CONVERGENCE or stalls:
            break
        previous = correction
    solution, last_correction = np.zeros((2, len(on)), dtype=LONG_DOUBLE_TYPE)
    solution[at], last_correction[at] = scale * x, scale * dx
    return _RefinedSolutionOnContactSet(solution, last_correction, correction, corrections, factors)


def _condition_number_of_torque(
    system: FullEquationSystemOfShoeGroup,
    on: Bools,
    solution: _RefinedSolutionOnContactSet,
    torque: float,
) -> float:
    """The condition number of the torque for relative changes of each entry of the full system.

    If all entries change by a small fraction, the torque changes at most by this number times the
    fraction. The number is nan for a torque of 0.
    """
    if torque == 0:
        return math.nan
    at = np.flatnonzero(on)
    scale = system.scale_factors[at]
    z = scale * solution.factors.solve(scale * system.torque_factors_of_unknowns[at], trans="T")
    A = abs(system.matrix[at][:, at])
    terms = A @ np.abs(solution.x[at]) + np.abs(system.right_side[at])
    return float(np.abs(z) @ terms / abs(torque))
