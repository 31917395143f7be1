"""Shoes that share a force, by struts or under a cam, as one contact problem.

Each shoe i of a group is known by itself: pushed by F_i its weighted gap opens by opened_i F_i, and
C_i p = -work_i F_i. Its tip goes by tip_i p + yields_i F_i elastically along that force, and with
its free motions by moves_i y_i.

A strut pushes with what a foot bears on, F_to = bearing p + direct F_from. A cam moves two tips by
the same way d, and its forces have a given sum: of each shoe the equilibrium that its force works
most on gives F_i by p, and the way of its tip the motion that goes with it. Then d is the one
motion left of the two, and the sum of the forces its equilibrium.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.contact.equations import Problem

PULLED = 1e-9
"""Fraction of the largest force below which a shared force does not push: it is round-off of one
that has fallen to nothing, or pulls.
"""
WOULD_PULL = "no equilibrium, what pushes it would have to pull"


class Pushed(NamedTuple):
    """A shoe as above: its pressures `part` and motions `rows` among those of the group; `opened`,
    `tip`, `bearing` (n,), `work`, `moves` (k,).
    """

    part: slice | Ints
    rows: slice
    opened: Floats
    tip: Floats
    yields: float
    work: Floats
    moves: Floats
    bearing: Floats
    direct: float


@dataclass(frozen=True)
class Sharing:
    """The `problem` of shoes that share forces F = fixed + by p, and their motions y = of y' + also
    p of its own y'.
    """

    problem: Problem
    fixed: Floats
    by: Floats
    of: Floats
    also: Floats

    def forces(self, p: Floats) -> Floats:
        """The forces (shoes,) under pressures p (n,)."""
        return self.fixed + self.by @ p

    def amounts(self, p: Floats, y: Floats) -> Floats:
        """The free motions of all shoes."""
        return self.of @ y + self.also @ p


def share(
    blocks: Problem,
    shoes: list[Pushed],
    own: Floats,
    links: list[tuple[int, int]],
    cam: list[int],
    total: float,
) -> Sharing:
    """The problem of shoes with the forces `own` (shoes,), in the problem `blocks` already, but for
    what they share.

    links: (from, to); cam: the two shoes of a cam whose forces have the sum `total`. Linear in the
    friction coefficient.
    """
    A, q, B, C, h = (np.array(part) for part in blocks)
    (n, k), count = B.shape, len(shoes)
    fixed, by = np.array(own, dtype=float), np.zeros((count, n))
    for i in cam:
        shoe, main = shoes[i], _main(blocks, shoes[i])
        by[i] = -C[shoe.rows][main] / shoe.work[main]
        fixed[i] = 0.0
    for source, to in links:
        by[to, shoes[source].part] = shoes[source].bearing
        by[to] += shoes[source].direct * by[source]
        fixed[to] = shoes[source].direct * fixed[source]
    for i, shoe in enumerate(
        shoes
    ):  # what the block has of its own force goes, what it shares comes
        extra = fixed[i] - own[i]
        A[shoe.part] += np.outer(shoe.opened, by[i])
        q[shoe.part] += extra * shoe.opened
        C[shoe.rows] += np.outer(shoe.work, by[i])
        h[shoe.rows] -= extra * shoe.work
    of, also = np.eye(k), np.zeros((k, n))
    if not cam:
        return Sharing(Problem(A, q, B, C, h), fixed, by, of, also)
    way = np.zeros(k)  # of the motions per way of the tips
    mains = []
    for i in cam:
        shoe = shoes[i]
        row = _main(blocks, shoe)
        main = shoe.rows.start + row
        mains.append(main)
        size = shoe.moves[row]
        elastic = shoe.yields * by[i]
        elastic[shoe.part] += shoe.tip
        also[main] = -elastic / size
        of[main, shoe.rows] -= shoe.moves / size  # its own entry becomes 0
        way[main] = 1 / size
    kept = np.delete(np.arange(k), mains)
    of = np.column_stack([way, of[:, kept]])
    rows = np.vstack([-by[cam].sum(axis=0), C[kept]])
    return Sharing(
        Problem(A + B @ also, q, B @ of, rows, np.append(-total, h[kept])), fixed, by, of, also
    )


def unreduced(
    blocks: Problem, shoes: list[Pushed], links: list[tuple[int, int]], cam: list[int]
) -> Floats:
    """The matrix of all equations with the forces F as unknowns besides, and the way d of the tips
    under a cam.

    Unknowns p (n,), y (k,), F (shoes,), and with a cam d. Rows: the weighted gaps; C p + work F =
    0; of each shoe's force what gives it (F itself, the strut, its tip's way less d); with a cam
    the sum of its forces.
    """
    (n, k), count = blocks.B.shape, len(shoes)
    force = n + k
    size = force + count + (1 if cam else 0)
    matrix = np.zeros((size, size))
    matrix[:n, :n], matrix[:n, n:force], matrix[n:force, :n] = blocks.A, blocks.B, blocks.C
    matrix[force : force + count, force : force + count] = np.eye(count)
    for i, shoe in enumerate(shoes):
        matrix[shoe.part, force + i] = shoe.opened
        matrix[n + shoe.rows.start : n + shoe.rows.stop, force + i] = shoe.work
    for source, to in links:
        matrix[force + to, shoes[source].part] = -shoes[source].bearing
        matrix[force + to, force + source] = -shoes[source].direct
    for i in cam:
        shoe, row = shoes[i], matrix[force + i]
        row[shoe.part], row[n + shoe.rows.start : n + shoe.rows.stop] = shoe.tip, shoe.moves
        row[force + i], row[-1] = shoe.yields, -1.0
        matrix[-1, force + i] = 1.0
    return matrix


def _main(blocks: Problem, shoe: Pushed) -> int:
    """The motion that the force works most on and its tip goes with, over how far the lining goes
    with it, for motions are turns and slides. The same at every friction coefficient.
    """
    return int(
        (shoe.work * shoe.moves / np.linalg.norm(blocks.B[:, shoe.rows], axis=0) ** 2).argmax()
    )
