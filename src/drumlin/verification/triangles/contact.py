"""Contact node by node: each node of a face is open, or carries a force with Coulomb's friction at full slip."""

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from drumlin.arrays import Bools, Floats, Ints
from drumlin.brake import Brake, Shoe
from drumlin.errors import NoAnswer
from drumlin.verification.triangles.face import Face

SETTLED = 600  # contact sets that are tried
SPARE = 8  # of them in a row without fewer wrong nodes, until they are changed one node at a time (Judice & Pires 1994)
NOISE = 1e-13  # of the normal force, in tractions and overlaps at all wrong nodes
PATIENCE, NEARLY = 40, 1e-9  # contact sets after which that much is enough


class Rim(NamedTuple):
    """The ring's side: `compliance` (2m, 2m) of its nodes under the linings, `of` for each face theirs (n,)."""

    compliance: Floats
    of: list[Ints]


class Found(NamedTuple):
    """Nodal forces (n,) [N] along the normals and the turn of each shoe about its pin [rad], and what is active."""

    force: Floats
    turn: Floats
    active: Bools


def settle(A: Floats, q: Floats, B: Floats, C: Floats, h: Floats, weight: Floats, first: Bools) -> Found:
    """w = q + A f + B y >= 0, f >= 0, w f = 0, C f = h: by sets of active nodes, changed all at once or one by one.

    weight (n,): area of each node, which makes forces comparable. Raises NoAnswer where no set settles.
    """
    n, k = len(q), len(h)
    active = first.copy()
    scale = float(np.median(np.abs(np.diag(A)) * weight))
    fewest, spare, least = n + 1, SPARE, math.inf
    best: Found | None = None
    for step in range(SETTLED):
        a = np.flatnonzero(active)
        if not len(a):
            raise NoAnswer("no node in contact")
        system = np.block([[A[np.ix_(a, a)], B[a]], [C[:, a], np.zeros((k, k))]])
        size = np.concatenate([np.sqrt(weight[a]), np.ones(k)])
        try:
            x = size * np.linalg.solve(system * np.outer(size, size), size * np.concatenate([-q[a], h]))
        except np.linalg.LinAlgError as error:
            raise NoAnswer("a contact set is singular") from error
        f, y = np.zeros(n), x[len(a) :]
        f[a] = x[: len(a)]
        w = (q + A @ f + B @ y) * weight / scale  # a force, as f is
        size_of = float(np.abs(f).sum())
        off = np.where(active, f, w)
        wrong = np.flatnonzero(off < 0)
        wrongness = -float(off[wrong].sum()) / size_of
        if wrongness < least:
            least, best = wrongness, Found(f, y, active.copy())
        if wrongness < NOISE or (step > PATIENCE and least < NEARLY):
            assert best is not None
            return best
        if len(wrong) < fewest:
            fewest, spare = len(wrong), SPARE
        else:
            spare -= 1
        chosen = wrong if spare > 0 else wrong[-1:]
        active[chosen] = ~active[chosen]
    raise NoAnswer(f"no contact set settles: wrong by {least:.1e}")


def contact(brake: Brake, faces: list[Face], shoes: list[Shoe], rim: Rim | None, first: list[Bools]) -> list[Found]:
    """The forces on the nodes of the faces of shoes that meet the drum together."""
    drag = brake.friction * brake.spin
    counts = [len(face.theta) for face in faces]
    begin = np.concatenate([[0], np.cumsum(counts)])
    n, k = int(begin[-1]), len(faces)
    A, B, C = np.zeros((n, n)), np.zeros((n, k)), np.zeros((k, n))
    q, h, weight = np.zeros(n), np.zeros(k), np.zeros(n)
    spread = []
    for i, (one, shoe) in enumerate(zip(faces, shoes, strict=True)):
        part = slice(begin[i], begin[i + 1])
        m = counts[i]
        normal, pull = np.zeros((m, 2 * m)), np.zeros((2 * m, m))
        for c in range(2):
            normal[np.arange(m), 2 * np.arange(m) + c] = one.normal[:, c]
            pull[2 * np.arange(m) + c, np.arange(m)] = -one.normal[:, c] + drag * one.tangent[:, c]
        A[part, part] = -normal @ one.compliance @ pull
        B[part, i] = -normal @ one.turned
        C[i, part] = one.turned @ pull
        q[part] = one.gap - normal @ one.loaded
        h[i] = -shoe.actuation.moment_about(shoe.pin)
        weight[part] = one.mass.sum(axis=1)
        spread.append((normal, pull))
    if rim is not None:
        for i, j in np.ndindex(k, k):
            rows, columns = ((2 * rim.of[x][:, None] + np.arange(2)).ravel() for x in (i, j))
            A[begin[i] : begin[i + 1], begin[j] : begin[j + 1]] -= (
                spread[i][0] @ rim.compliance[np.ix_(rows, columns)] @ spread[j][1]
            )
    found = settle(A, q, B, C, h, weight, np.concatenate(first))
    return [
        Found(found.force[a:b], found.turn[i : i + 1], found.active[a:b]) for i, (a, b) in enumerate(pairwise(begin))
    ]
