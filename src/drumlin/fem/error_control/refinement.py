"""The full system of a group of shoes, solved by another elimination and refined in long double.

The unknowns that static condensation eliminates stay in the system: all displacements of the shoes
and of the ring, the generalised coordinates y, and the pressures p on the contact set, together. A
shoe moves by u = v + r y, with v the displacements while its frame is held and r its rigid-body
modes. These strain nothing, so that K r = 0 never meets the round-off of K. Per newton of the
largest force:

    K v + (N - drag T)^T p = f,    r^T (N - drag T)^T p = moment,
    M (g + p/eps) - N v - N r y + N_ring u_ring = 0  on the contact set

The stiffness is assembled in long double. LU factors of the rounded system (SuperLU, pivoted, in an
order of its own) are the preconditioner of an iterative refinement whose residuals are long double,
too (Wilkinson; Higham, Accuracy and Stability of Numerical Algorithms, ch. 12). Where it converges,
the answer is that of the discrete brake to all digits of double precision. It tells how many digits
another answer has, by different arithmetic in another order.

The condition of the torque is that of the linear functional T = l . x of a system A x = b under
changes of each entry by a fraction of the entry (Skeel; Higham, ch. 7):

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
from drumlin.contact.active_set import SET_ROUND_OFF
from drumlin.fem.equilibrium.group import ShoeGroup
from drumlin.fem.preparation.bodies import acting_loads
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.substructure.body import FRAME, stiffness
from drumlin.fem.substructure.elasticity import layers_of
from drumlin.fem.substructure.ring import ring_stiffness

LONG_DOUBLE = np.longdouble
EPSILON = float(np.finfo(float).eps)
"""Relative spacing of double-precision numbers."""
MOST_CORRECTIONS = 30
"""Number of corrections after which a refinement ends, whether it has converged or not."""
CONVERGED_CORRECTION = 1e-14
"""Largest correction of the pressures, relative to the largest pressure, at which the refinement
ends: some 45 times the spacing of double-precision numbers. Above it a further correction follows.
"""
SLOWEST = 0.5
"""Factor by which each correction from the third on must be smaller than the one before. Above it
the refinement has come to its end, and `Refined.correction` tells how well it has converged.
"""
MOST_REFINED_SETS = 40
"""Number of contact sets that are tried, from the given set on, before the answer is refused. In a
solve the given set is that of the condensed answer.
"""


class Refined(NamedTuple):
    """The solution of the full system for a group of shoes, per newton of their largest force.

    Attributes
    ----------
    p : pressures (n_i,) of each shoe
    last : last correction (n_i,) of the pressures of each shoe
    coordinates : generalised coordinates (k_i,) of each shoe
    torque : of all shoes [m]
    gap : weighted gaps (n,) of all nodes, relative to the largest term in them
    correction : largest part of the last correction, relative to the largest pressure
    corrections : number of corrections
    sets : number of contact sets that were tried
    condition : of the torque, relative to each entry of the assembled system
    """

    p: tuple[Floats, ...]
    last: tuple[Floats, ...]
    coordinates: tuple[Floats, ...]
    torque: float
    gap: Floats
    correction: float
    corrections: int
    sets: int
    condition: float


@dataclass(frozen=True)
class FullSystem:
    """The full system of a group of shoes: matrix and right side in long double.

    Attributes
    ----------
    matrix : sparse matrix (unknowns, unknowns); the rows of the pressures come last
    right : right side (unknowns,)
    pressures : place of each shoe's pressures
    coordinates : place of each shoe's generalised coordinates
    lever : (unknowns,), with torque = lever . x
    scale : factors (unknowns,) of the unknowns, and of the rows
    """

    matrix: Any
    right: Any
    pressures: tuple[slice, ...]
    coordinates: tuple[slice, ...]
    lever: Floats
    scale: Floats

    @property
    def first(self) -> int:
        """Place of the first pressure."""
        return self.pressures[0].start


# The system is assembled


class _ShoeBlock(NamedTuple):
    """The part of one shoe in the full system, in long double.

    Its unknowns are the inner displacements, those of the contact nodes, and the generalised
    coordinates, to which no stiffness belongs.

    Attributes
    ----------
    K : stiffness (unknowns, unknowns)
    pushed : forces (unknowns, n) per pressure
    closed : closing (n, unknowns) of the weighted gaps per unknown
    load : actuation (unknowns,)
    """

    K: Any
    pushed: Any
    closed: Any
    load: Any


class _RingCoupling(NamedTuple):
    """N and T (n, unknowns of the ring) of one shoe's contact with the ring."""

    N: Any
    T: Any


class _RingBlock(NamedTuple):
    """The part of the ring in the full system: its stiffness, and its coupling with each shoe.

    The unknowns of a free ring are its displacements and the forces on its rim.
    """

    K: Any
    couplings: list[_RingCoupling]


@dataclass(frozen=True)
class _Layout:
    """The places of the unknowns: those of each shoe, those of the ring, then all pressures.

    `starts`: of each block of displacements, with the end; `firsts`: of each shoe's pressures, with
    the end.
    """

    starts: Any
    firsts: Any


def full_system(group: ShoeGroup, *, carried: bool = True) -> FullSystem:
    """The full system of a group of shoes, all of its nodes in contact.

    carried: whether displacements are counted from where the rigid-body modes carry the shoes.
    Otherwise they are counted from the undeformed shoes, which keeps more digits where the drum
    holds the lining and a soft shoe turns behind it.
    """
    members = range(len(group.members))
    shoe_blocks = [_shoe_block(group, k, carried) for k in members]
    ring = _ring_block(group.scene, group.brake) if group.scene.ring is not None else None
    stiffnesses = [block.K for block in shoe_blocks] + ([ring.K] if ring else [])
    sizes = [int(block.shape[0]) for block in stiffnesses]
    counts = [len(gap) for gap in group.initial_gaps]
    starts = np.cumsum([0, *sizes])
    layout = _Layout(starts, np.cumsum([starts[-1], *counts]))
    blocks = _all_blocks(group, shoe_blocks, ring, stiffnesses)
    matrix = _joined(blocks, [*sizes, *counts])
    ends = layout.starts[1 : len(members) + 1]
    return FullSystem(
        matrix=matrix,
        right=_right_side(group, shoe_blocks, layout),
        pressures=tuple(slice(int(a), int(b)) for a, b in pairwise(layout.firsts)),
        coordinates=tuple(
            slice(int(end) - modes.actuation_work.size, int(end))
            for end, modes in zip(ends, group.rigid_body_modes, strict=True)
        ),
        lever=_torque_lever(group, layout),
        scale=_scale(matrix, int(layout.firsts[0])),
    )


def _all_blocks(
    group: ShoeGroup,
    shoe_blocks: list[_ShoeBlock],
    ring: _RingBlock | None,
    stiffnesses: list[Any],
) -> list[list[Any]]:
    """The full matrix by blocks, None where zero: shoes, ring, and then pressures of each shoe."""
    count = len(stiffnesses) + len(shoe_blocks)
    blocks: list[list[Any]] = [[None] * count for _ in range(count)]
    for k, block in enumerate(stiffnesses):
        blocks[k][k] = block
    ring_row = len(stiffnesses) - 1
    drag = group.brake.drag
    for k, shoe_block in enumerate(shoe_blocks):
        M = group.bodies[k].coupling.M
        at = len(stiffnesses) + k
        blocks[k][at], blocks[at][k] = shoe_block.pushed, -shoe_block.closed
        blocks[at][at] = sp.csr_matrix((M / group.contact_stiffnesses[k]).astype(LONG_DOUBLE))
        if ring is not None:
            N, T = ring.couplings[group.members[k]]
            blocks[ring_row][at], blocks[at][ring_row] = -(N - drag * T).T, N
    return blocks


def _right_side(group: ShoeGroup, shoe_blocks: list[_ShoeBlock], layout: _Layout) -> Any:
    """The right side of the full system: loads, and weighted gaps of the unloaded linings."""
    right = np.zeros(int(layout.firsts[-1]), dtype=LONG_DOUBLE)
    for k, shoe_block in enumerate(shoe_blocks):
        right[layout.starts[k] : layout.starts[k + 1]] = shoe_block.load
        M = group.bodies[k].coupling.M.astype(LONG_DOUBLE)
        gap = group.initial_gaps[k].astype(LONG_DOUBLE) / group.unit_force
        right[layout.firsts[k] : layout.firsts[k + 1]] = -(M @ gap)
    return right


def _torque_lever(group: ShoeGroup, layout: _Layout) -> Floats:
    """The torque (unknowns,) per unknown of the full system."""
    lever = np.zeros(int(layout.firsts[-1]))
    for k, body in enumerate(group.bodies):
        at = slice(layout.firsts[k], layout.firsts[k + 1])
        lever[at] = group.brake.friction * body.coupling.lever
    return lever


def _shoe_block(group: ShoeGroup, k: int, carried: bool) -> _ShoeBlock:
    """The part of shoe `k` in the full system; carried: see `full_system`."""
    body, shoe, modes = group.bodies[k], group.shoes[k], group.rigid_body_modes[k]
    constraints = body.condensed.constraints.matrix.astype(LONG_DOUBLE)
    K = stiffness(body.basis, layers_of(shoe), precise=True)
    constrained = (constraints.T @ K @ constraints).tocsr()
    inside, n = constrained.shape[0] - FRAME, len(body.line.nodes)
    share = LONG_DOUBLE(abs(shoe.actuation.force)) / group.unit_force
    acting = acting_loads(body, shoe, shoe.actuation.force).astype(LONG_DOUBLE)
    load = body.condensed.loads.astype(LONG_DOUBLE) @ (acting / group.unit_force)
    N, T = body.coupling.N.astype(LONG_DOUBLE), body.coupling.T.astype(LONG_DOUBLE)
    drag = LONG_DOUBLE(group.brake.drag_on(shoe))
    pushing = (N - drag * T).T
    contact_modes = modes.contact_modes.astype(LONG_DOUBLE)
    test_modes = modes.test_modes.astype(LONG_DOUBLE)
    pin_motion = modes.pin_motion.astype(LONG_DOUBLE)
    count = contact_modes.shape[1]
    # The contact nodes are the last of the displacements, two degrees of freedom each.
    first, shape = inside - 2 * n, (inside + count, n)
    closed = _placed(N.T, shape, row=first)
    if carried:
        closed = closed + _placed((N @ contact_modes).T, shape, row=inside)
        along = None
    else:
        along = (constrained[:inside, inside:] @ sp.csr_matrix(pin_motion)).tocsr()
    on_modes = _placed(test_modes.T @ pushing, shape, row=inside)
    return _ShoeBlock(
        K=_joined([[constrained[:inside, :inside], along], [None, None]], [inside, count]),
        pushed=_placed(pushing, shape, row=first) + on_modes,
        closed=closed.T.tocsr(),
        load=np.append(load[:inside], share * modes.actuation_work.astype(LONG_DOUBLE)),
    )


def _ring_block(scene: PreparedModel, brake: Brake) -> _RingBlock:
    """The part of the ring in the full system."""
    ring, part = scene.ring, brake.ring
    # A model without a ring, or with a ring that has no section, never comes here.
    assert ring is not None and part is not None
    basis = ring.basis
    K = ring_stiffness(basis, part, precise=True).tocsr()
    keep = np.ones(2 * basis.N, dtype=bool)
    keep[2 * ring.held] = keep[2 * ring.held + 1] = False
    K = K[keep][:, keep]
    if ring.free is not None:
        forces = ring.free.rim.transpose(1, 0, 2).reshape(-1, FRAME)
        rim = sp.csr_matrix(forces.astype(LONG_DOUBLE))
        K = _joined([[K, rim], [rim.T.tocsr(), None]], [2 * basis.N, FRAME])
    place = np.cumsum(keep) - 1
    nodes = ring.line.nodes
    dofs = place[np.column_stack([2 * nodes, 2 * nodes + 1]).ravel()]
    couplings = []
    for normal, tangential in ring.coupled:
        N, T = (_spread(matrix, dofs, K.shape[0]) for matrix in (normal, tangential))
        couplings.append(_RingCoupling(N, T))
    return _RingBlock(K, couplings)


def _spread(values: Floats, dofs: Any, count: int) -> Any:
    """A sparse matrix of `count` columns: at `dofs` the columns of `values`, 0 elsewhere."""
    entries = sp.coo_matrix(values.astype(LONG_DOUBLE))
    places = (entries.row, dofs[entries.col])
    return sp.csr_matrix((entries.data, places), shape=(entries.shape[0], count))


def _placed(values: Any, size: tuple[int, int], row: int) -> Any:
    """A sparse matrix of this size that holds the dense `values` from a row on."""
    i, j = np.nonzero(values)
    return sp.csr_matrix((values[i, j], (i + row, j)), shape=size)


def _joined(blocks: list[list[Any]], sizes: list[int]) -> Any:
    """Sparse blocks, None where zero, as one matrix in long double; `sizes` of the block rows."""
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
    values = np.concatenate(data).astype(LONG_DOUBLE)
    return sp.csr_matrix((values, places), shape=(starts[-1], starts[-1]))


def _scale(matrix: Any, first: int) -> Floats:
    """Factors (unknowns,) by which the full system is equilibrated; `first`: first pressure.

    They give the stiffness a unit diagonal, and rows of length one to the unknowns that are coupled
    with it: first to the pressures, then to the turns and to the forces on the rim of a free ring.
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


# The system is solved


def refine(system: FullSystem, active: Bools, order: str = "COLAMD") -> Refined:
    """The refined solution of a full system, from a contact set that it corrects.

    Parameters
    ----------
    system : the full system
    active : the contact set, nodes (n,) of all shoes
    order : of the elimination, by SuperLU's names

    Raises
    ------
    NoAnswer
        for a singular system, and where the contact set does not settle; a refinement that does not
        converge is returned, and its `correction` tells how far it is
    """
    first = system.first
    active = active.copy()
    rows, right = system.matrix[first:], system.right[first:]
    for sets in range(1, MOST_REFINED_SETS + 1):
        on = np.concatenate([np.ones(first, dtype=bool), active])
        solution = _solution(system, on, order)
        x = solution.x
        p = x[first:]
        w = (rows @ x - right).astype(float)
        bound = (abs(rows) @ np.abs(x) + np.abs(right)).astype(float)
        # Nodes leave the contact set under tension, and join it where they penetrate.
        tension = p < -SET_ROUND_OFF * np.abs(p).max(initial=0)
        penetrates = w < -SET_ROUND_OFF * bound
        change = np.where(active, tension, penetrates)
        if not change.any():
            gap = w / (bound.max(initial=0.0) or 1.0)
            return _refined(system, on, solution, gap, sets)
        active ^= change
    raise NoAnswer(
        f"not converged: the contact set still changes after {MOST_REFINED_SETS} refined solutions"
    )


class _Solution(NamedTuple):
    """The refined solution on one contact set.

    Attributes
    ----------
    x : unknowns (unknowns,) in long double
    last : last correction (unknowns,) of x
    correction : largest correction of a pressure, relative to the largest pressure
    corrections : number of corrections
    factors : LU factors of the equilibrated system
    """

    x: Any
    last: Any
    correction: float
    corrections: int
    factors: Any


def _refined(system: FullSystem, on: Bools, solution: _Solution, gap: Floats, sets: int) -> Refined:
    """The solution on the settled contact set, by shoes."""
    x = solution.x
    torque = float(system.lever @ x)
    return Refined(
        p=tuple(np.maximum(x[part].astype(float), 0.0) for part in system.pressures),
        last=tuple(solution.last[part].astype(float) for part in system.pressures),
        coordinates=tuple(x[part].astype(float) for part in system.coordinates),
        torque=torque,
        gap=gap,
        correction=solution.correction,
        corrections=solution.corrections,
        sets=sets,
        condition=_condition(system, on, solution, torque),
    )


def _solution(system: FullSystem, on: Bools, order: str) -> _Solution:
    """The refined solution with the unknowns `on` (unknowns,), the others zero."""
    at = np.flatnonzero(on)
    A, b, scale = system.matrix[at][:, at], system.right[at], system.scale[at]
    D = sp.diags(scale.astype(LONG_DOUBLE))
    A, b = (D @ A @ D).tocsr(), scale * b
    try:
        factors = splu(A.astype(float).tocsc(), permc_spec=order)
    except RuntimeError as error:
        raise NoAnswer("no equilibrium: the whole system is singular") from error
    x = np.zeros(len(at), dtype=LONG_DOUBLE)
    first = np.count_nonzero(on[: system.first])
    residual, last = b, math.inf
    for corrections in range(1, MOST_CORRECTIONS + 1):
        # A residual of unit size keeps its digits as it is rounded to double precision.
        largest = float(np.abs(residual).max()) or 1.0
        dx = factors.solve((residual / largest).astype(float)) * LONG_DOUBLE(largest)
        x += dx
        residual = b - A @ x
        p = scale[first:] * x[first:]
        change = scale[first:] * dx[first:]
        correction = float(np.abs(change).max() / (np.abs(p).max() or 1))
        stalls = corrections > 2 and correction > SLOWEST * last
        if correction < CONVERGED_CORRECTION or stalls:
            break
        last = correction
    found = np.zeros((2, len(on)), dtype=LONG_DOUBLE)
    found[:, at] = scale * x, scale * dx
    return _Solution(found[0], found[1], correction, corrections, factors)


def _condition(system: FullSystem, on: Bools, solution: _Solution, torque: float) -> float:
    """The condition of the torque, relative to each entry of the system; nan for no torque."""
    if torque == 0:
        return math.nan
    at = np.flatnonzero(on)
    scale = system.scale[at]
    z = scale * solution.factors.solve(scale * system.lever[at], trans="T")
    A = abs(system.matrix[at][:, at])
    terms = A @ np.abs(solution.x[at]) + np.abs(system.right[at])
    return float(np.abs(z) @ terms / abs(torque))
