"""The whole brake as one sparse system, solved by another elimination and refined in long double.

What condensation leaves out stays in: all displacements of the shoes (and of the ring), the free
motions y, the pressures p on the contact set, together. A shoe moves by u = v + r y: v with its
frame held, r its free motions, which strain nothing, so that K r = 0 never meets the round-off of
K. Per newton of the largest force:

    K v + (N - drag T)^T p = f,    r^T (N - drag T)^T p = moment,
    M (g + p/eps) - N v - N r y + N_ring u_ring = 0  on the contact set

The stiffness is assembled in long double; LU factors of the rounded system (SuperLU, pivoted, in an
order of its own) are the preconditioner of an iterative refinement whose residuals are long double,
too (Wilkinson; Higham, Accuracy and Stability of Numerical Algorithms, ch. 12). Where it converges
the answer is that of the discrete brake to all digits of double precision, so that it tells how
many digits another answer has: by different arithmetic in another order.

The torque's own condition is that of the linear functional T = l . x of a system A x = b under
changes of each
entry by a fraction of it (Skeel; Higham, ch. 7):  |z|^T (|A| |x| + |b|) / |T|  with  A^T z = l.
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
from drumlin.contact.active_set import SLACK
from drumlin.fem.equilibrium.group import ShoeGroup
from drumlin.fem.equilibrium.motions import Motions
from drumlin.fem.preparation.bodies import actuation
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.substructure.body import FRAME, stiffness
from drumlin.fem.substructure.elasticity import layers_of, ring_layers

LONG = np.longdouble
EPSILON = float(np.finfo(float).eps)
MOST_CORRECTIONS = 30
SETTLED = 1e-14  # relative correction of the pressures at which the refinement ends
SLOWEST = 0.5  # factor by which corrections must shrink
MOST_SETS = 40  # contact sets tried from the one that is given


class Refined(NamedTuple):
    """Solution of the whole system for a group of shoes, per newton of their largest force.

    `p`: pressures (n_i,) of each shoe; `motions` (k_i,); `torque` [m]: of all shoes. `gap` (n,):
    weighted gaps of all nodes over the largest term in them. `last`: the last correction of the
    pressures (n_i,), `correction` the largest part of it, relative to the largest pressure;
    `corrections` their number; `sets`: contact sets tried. `condition`: the torque's own, relative
    to each entry of the assembled system.
    """

    p: tuple[Floats, ...]
    last: tuple[Floats, ...]
    motions: tuple[Floats, ...]
    torque: float
    gap: Floats
    correction: float
    corrections: int
    sets: int
    condition: float


@dataclass(frozen=True)
class Whole:
    """The system of a group of shoes: `matrix` and `right` in long double, rows of the pressures
    last.

    `pressures`: place of each shoe's pressures; `motions`: places of its free motions; `lever`
    (unknowns,): torque = lever . x; `scale` (unknowns,): of the unknowns, and of the rows.
    """

    matrix: Any
    right: Any
    pressures: tuple[slice, ...]
    motions: tuple[slice, ...]
    lever: Floats
    scale: Floats

    @property
    def first(self) -> int:
        """Place of the first pressure."""
        return self.pressures[0].start


def whole(group: ShoeGroup, *, carried: bool = True) -> Whole:
    """Assemble the whole system of a group of shoes, all nodes in contact.

    carried: displacements are counted from where the turns carry the shoes; otherwise from where
    they were, which keeps more digits where the drum holds the lining and a soft shoe turns behind
    it.
    """
    scene, brake, size, members = group.scene, group.brake, group.unit_force, group.members
    sections = [
        _shoe_block(scene, brake, i, size, group.motions[k], carried) for k, i in enumerate(members)
    ]
    ring = _ring_block(scene, brake) if scene.ring is not None else None
    blocks = [part.K for part in sections] + ([ring.K] if ring else [])
    starts = np.cumsum([0, *(block.shape[0] for block in blocks)])
    counts = [len(gap) for gap in group.gaps]
    firsts = np.cumsum([starts[-1], *counts])
    total = int(firsts[-1])
    rows: list[list[Any]] = [
        [None] * (len(blocks) + len(members)) for _ in range(len(blocks) + len(members))
    ]
    right = np.zeros(total, dtype=LONG)
    lever = np.zeros(total)
    for k, block in enumerate(blocks):
        rows[k][k] = block
    for k, (i, part) in enumerate(zip(members, sections, strict=True)):
        coupling = group.bodies[k].coupling
        at = len(blocks) + k
        rows[k][at], rows[at][k] = part.pushed, -part.closed
        rows[at][at] = sp.csr_matrix((coupling.M / group.stiffnesses[k]).astype(LONG))
        if ring is not None:
            N, T = ring.coupled[i]
            drag = brake.drag
            rows[-len(members) - 1][at], rows[at][-len(members) - 1] = -(N - drag * T).T, N
        right[starts[k] : starts[k + 1]] = part.load
        right[firsts[k] : firsts[k + 1]] = -(
            coupling.M.astype(LONG) @ (group.gaps[k].astype(LONG) / size)
        )
        lever[firsts[k] : firsts[k + 1]] = brake.friction * coupling.lever
    matrix = _joined(rows, [*(b.shape[0] for b in blocks), *counts])
    return Whole(
        matrix=matrix,
        right=right,
        pressures=tuple(slice(int(a), int(b)) for a, b in pairwise(firsts)),
        motions=tuple(
            slice(int(end) - motions.work.size, int(end))
            for end, motions in zip(starts[1 : len(members) + 1], group.motions, strict=True)
        ),
        lever=lever,
        scale=_scale(matrix, int(firsts[0])),
    )


class _ShoeBlock(NamedTuple):
    """One shoe: stiffness on (inner, contact, free motions), pressures -> its rows, displacements
    -> closing (n, .), load. The free motions have no stiffness.
    """

    K: Any
    pushed: Any
    closed: Any
    load: Any


def _shoe_block(
    scene: PreparedModel, brake: Brake, index: int, size: float, motions: Motions, carried: bool
) -> _ShoeBlock:
    body, shoe = scene.bodies[index], brake.shoes[index]
    ties = body.condensed.constraints.matrix.astype(LONG)
    K = stiffness(body.basis, layers_of(shoe), precise=True)
    A = (ties.T @ K @ ties).tocsr()
    inside, n = A.shape[0] - FRAME, len(body.line.nodes)
    unit, _ = actuation(body, shoe)
    share = LONG(abs(shoe.actuation.force)) / size
    load = share * (body.condensed.loads.astype(LONG) @ unit.astype(LONG))
    N, T = body.coupling.N.astype(LONG), body.coupling.T.astype(LONG)
    drag = LONG(brake.drag_on(shoe))
    pushing = (N - drag * T).T
    moved, tested, of = (part.astype(LONG) for part in (motions.moved, motions.tested, motions.of))
    free = moved.shape[1]
    first, shape = inside - 2 * n, (inside + free, n)
    closed = _placed(N.T, shape, row=first)
    if carried:
        closed = closed + _placed((N @ moved).T, shape, row=inside)
    along = None if carried else (A[:inside, inside:] @ sp.csr_matrix(of)).tocsr()
    return _ShoeBlock(
        K=_joined([[A[:inside, :inside], along], [None, None]], [inside, free]),
        pushed=_placed(pushing, shape, row=first) + _placed(tested.T @ pushing, shape, row=inside),
        closed=closed.T.tocsr(),
        load=np.append(load[:inside], share * motions.work.astype(LONG)),
    )


class _RingBlock(NamedTuple):
    """The ring: stiffness on its free unknowns, with the rim's forces where it is free; N and T of
    each shoe.
    """

    K: Any
    coupled: list[tuple[Any, Any]]


def _ring_block(scene: PreparedModel, brake: Brake) -> _RingBlock:
    ring, part = scene.ring, brake.ring
    assert ring is not None and part is not None and part.section is not None  # scene.why_not
    basis = ring.basis
    K = stiffness(basis, ring_layers(part.section), precise=True).tocsr()
    keep = np.ones(2 * basis.N, dtype=bool)
    if part.support == "fixed":
        keep[2 * ring.support] = keep[2 * ring.support + 1] = False
        K = K[keep][:, keep]
    else:
        assert ring.free is not None
        rim = sp.csr_matrix(ring.free.rim.transpose(1, 0, 2).reshape(-1, FRAME).astype(LONG))
        K = _joined([[K, rim], [rim.T.tocsr(), None]], [2 * basis.N, FRAME])
    place = np.cumsum(keep) - 1
    dofs = place[np.column_stack([2 * ring.line.nodes, 2 * ring.line.nodes + 1]).ravel()]
    coupled = []
    for pair in ring.coupled:
        spread = [sp.coo_matrix(matrix.astype(LONG)) for matrix in pair]
        N, T = (
            sp.csr_matrix((m.data, (m.row, dofs[m.col])), shape=(m.shape[0], K.shape[0]))
            for m in spread
        )
        coupled.append((N, T))
    return _RingBlock(K, coupled)


def _placed(values: Any, size: tuple[int, int], row: int) -> Any:
    """A sparse matrix of this size that holds the dense `values` from a row on."""
    i, j = np.nonzero(values)
    return sp.csr_matrix((values[i, j], (i + row, j)), shape=size)


def _joined(blocks: list[list[Any]], sizes: list[int]) -> Any:
    """Sparse blocks, None where zero, as one matrix in long double; `sizes` of the block rows."""
    starts = np.cumsum([0, *sizes])
    entries = [
        (block.data, block.row + starts[a], block.col + starts[b])
        for a, line in enumerate(blocks)
        for b, block in ((b, block.tocoo()) for b, block in enumerate(line) if block is not None)
    ]
    data, rows, columns = (np.concatenate(parts) for parts in zip(*entries, strict=True))
    return sp.csr_matrix((data.astype(LONG), (rows, columns)), shape=(starts[-1], starts[-1]))


def _scale(matrix: Any, first: int) -> Floats:
    """Factors (unknowns,) that give the stiffness a unit diagonal, and rows of length one to what
    is coupled to it.

    The latter are first the pressures, then the turns and the forces on the rim of a free ring.
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


def refine(system: Whole, active: Bools, order: str = "COLAMD") -> Refined:
    """Solve the system from the contact set `active` (nodes of all shoes,), which changes where it
    is wrong.

    order: of the elimination, by SuperLU's names. Raises NoAnswer for a singular system and where
    the contact set does not settle; how well the refinement has settled is told by `correction`.
    """
    first = system.first
    active = active.copy()
    for sets in range(1, MOST_SETS + 1):
        on = np.concatenate([np.ones(first, dtype=bool), active])
        solution = _solution(system, on, order)
        x = solution.x
        p = x[first:]
        w = (system.matrix[first:] @ x - system.right[first:]).astype(float)
        bound = (abs(system.matrix[first:]) @ np.abs(x) + np.abs(system.right[first:])).astype(
            float
        )
        change = np.where(active, p < -SLACK * np.abs(p).max(initial=0), w < -SLACK * bound)
        if not change.any():
            return _refined(system, on, solution, w / (bound.max(initial=0.0) or 1.0), sets)
        active ^= change
    raise NoAnswer(
        f"not converged: the contact set still changes after {MOST_SETS} refined solutions"
    )


class _Solution(NamedTuple):
    """x (unknowns,) in long double, its last correction, that of the pressures, relative, and how
    many there were, the factors on the scaled unknowns.
    """

    x: Any
    last: Any
    correction: float
    corrections: int
    factors: Any


def _refined(system: Whole, on: Bools, solution: _Solution, gap: Floats, sets: int) -> Refined:
    x = solution.x
    torque = float(system.lever @ x)
    return Refined(
        p=tuple(np.maximum(x[part].astype(float), 0.0) for part in system.pressures),
        last=tuple(solution.last[part].astype(float) for part in system.pressures),
        motions=tuple(x[part].astype(float) for part in system.motions),
        torque=torque,
        gap=gap,
        correction=solution.correction,
        corrections=solution.corrections,
        sets=sets,
        condition=_condition(system, on, solution, torque),
    )


def _solution(system: Whole, on: Bools, order: str) -> _Solution:
    """Solve with the unknowns `on` (unknowns,), the others zero."""
    at = np.flatnonzero(on)
    A, b, scale = system.matrix[at][:, at], system.right[at], system.scale[at]
    D = sp.diags(scale.astype(LONG))
    A, b = (D @ A @ D).tocsr(), scale * b
    try:
        factors = splu(A.astype(float).tocsc(), permc_spec=order)
    except RuntimeError as error:
        raise NoAnswer("no equilibrium: the whole system is singular") from error
    x = np.zeros(len(at), dtype=LONG)
    first = np.count_nonzero(on[: system.first])
    residual, last = b, math.inf
    for corrections in range(1, MOST_CORRECTIONS + 1):
        largest = float(np.abs(residual).max()) or 1.0
        dx = factors.solve((residual / largest).astype(float)) * LONG(largest)
        x += dx
        residual = b - A @ x
        p = scale[first:] * x[first:]
        correction = float(np.abs(scale[first:] * dx[first:]).max() / (np.abs(p).max() or 1))
        if correction < SETTLED or (corrections > 2 and correction > SLOWEST * last):
            break
        last = correction
    found = np.zeros((2, len(on)), dtype=LONG)
    found[:, at] = scale * x, scale * dx
    return _Solution(found[0], found[1], correction, corrections, factors)


def _condition(system: Whole, on: Bools, solution: _Solution, torque: float) -> float:
    """The torque's condition relative to each entry of matrix and right side; nan for no torque."""
    if torque == 0:
        return math.nan
    at = np.flatnonzero(on)
    scale = system.scale[at]
    z = scale * solution.factors.solve(scale * system.lever[at], trans="T")
    A = abs(system.matrix[at][:, at])
    return float(np.abs(z) @ (A @ np.abs(solution.x[at]) + np.abs(system.right[at])) / abs(torque))
