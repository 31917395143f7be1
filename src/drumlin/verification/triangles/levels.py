"""Solutions of a brake on a sequence of ever finer meshes of triangles."""

import math
from collections.abc import Sequence
from contextlib import suppress

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import vary
from drumlin.brake.ring_support import plain_ring_only
from drumlin.verification.triangles.contact import solve_contact_forces
from drumlin.verification.triangles.face import CondensedFace, condense_to_face, mesh_body
from drumlin.verification.triangles.outline import (
    Outline,
    SingularPlaces,
    TriangleLevel,
    draft_mesh,
    make_outline,
)
from drumlin.verification.triangles.ring import condense_ring, mesh_linings_and_ring
from drumlin.verification.triangles.shared import solve_shoes_that_share_forces
from drumlin.verification.triangles.solution import ShoeSolution, shoe_solution

ENDS = 13
"""Largest number of halvings of triangles towards an end of the contact, where p is small, and
towards a kink of the gap that does not point to the drum."""
END_SLACK = 1e-9
"""Distance from an end of the lining, relative to the lining's length, up to which a place counts
as this end."""
NARROWEST = 1e-4
"""Width of a contact, relative to `Outline.least`, below which triangles become no smaller."""

FINDING = TriangleLevel(3, 8, 1.4, 1.0)
"""The coarse mesh on which the ends of the contact are found."""
PASSES = 6
"""Largest number of solutions on the mesh FINDING. Each mesh is graded to the ends of the contact
in the solution before."""
LESS = (0.0, 0.5)
"""Fractions of the coefficient of friction that are solved first. With much friction a brake may
have several answers. The answer that grows from the frictionless one is the answer sought."""
SETTLED_ENDS = 2e-3
"""Movement of the ends of a contact between two solutions, relative to the contact's length, below
which the ends count as found."""
TRIANGLE_LEVELS = (
    TriangleLevel(3, 10, 1.2, 1.0),
    TriangleLevel(4, 13, 0.7, 0.8),
    TriangleLevel(5, 15, 0.7, 0.8),
)
"""The meshes of `solve_sequence`, from coarse to fine."""


def pressed_shoes(brake: Brake) -> list[int]:
    """Numbers of the shoes without a hinge and of those that the actuation turns to the drum."""
    found = []
    for i, shoe in enumerate(brake.shoes):
        if shoe.held_by != "hinge" or brake.shares:
            found.append(i)
            continue
        theta = np.linspace(shoe.lining.start, shoe.lining.end, 41)
        e = np.stack([np.cos(theta), np.sin(theta)], axis=1)
        arm = brake.size * e - shoe.pin.xy
        closing = shoe.sign * (-arm[:, 1] * e[:, 0] + arm[:, 0] * e[:, 1])
        if (closing * shoe.actuation.moment_about(shoe.pin) > 0).any():
            found.append(i)
    return found


def _shortest_wavelength(brake: Brake) -> float:
    """Shortest wavelength of the drum's out-of-roundness along its circumference [m]."""
    highest = max((part.order for part in brake.lobes if part.amplitude), default=0)
    return 2 * math.pi * brake.size / max(highest, 1)


def solve(
    brake: Brake, level: TriangleLevel, before: Sequence[ShoeSolution] | None = None
) -> list[ShoeSolution]:
    """The solution of each shoe on meshes of one level.

    Parameters
    ----------
    brake : the brake
    level : degree and grading of the triangles
    before : an earlier solution of each shoe, to whose contact's ends the triangles are graded;
        without it the whole lining is taken to be in contact at first

    Raises
    ------
    BadInput
        If triangles cannot mesh the brake, or for a ring that is not plain.
    NoAnswer
        If a shoe does not touch the drum or no contact set solves the equations.
    """
    refusal = plain_ring_only(brake, "the verification by triangles")
    if refusal is not None:
        raise BadInput(refusal)
    shoes = list(brake.shoes)
    if len(pressed_shoes(brake)) < len(shoes):
        raise NoAnswer("a shoe that is not turned towards the drum")
    earlier = [None] * len(shoes) if before is None else list(before)
    drafts = []
    for shoe, its in zip(shoes, earlier, strict=True):
        shape = make_outline(shoe, brake.size)
        drafts.append(
            draft_mesh(
                shape, _singular_places(shoe, shape, its, level), level, _shortest_wavelength(brake)
            )
        )
    meshes, opposite = [one.mesh for one in drafts], None
    if brake.ring is not None:
        meshes, opposite = mesh_linings_and_ring(brake, drafts, level)
    faces = [
        condense_to_face(
            brake,
            shoe.under(1.0) if brake.shares else shoe,
            mesh_body(one.shape, mesh, level.degree),
        )
        for shoe, one, mesh in zip(shoes, drafts, meshes, strict=True)
    ]
    firsts = [_initial_contact(one, its) for one, its in zip(faces, earlier, strict=True)]
    if brake.shares:
        if opposite is not None:
            raise BadInput(f"{brake.shares}, on an elastic ring")
        shoes, found = solve_shoes_that_share_forces(brake, faces, firsts)
    elif opposite is not None:
        found = solve_contact_forces(
            brake, faces, shoes, condense_ring(brake, opposite, faces), firsts
        )
    else:
        found = [
            solve_contact_forces(brake, [faces[i]], [shoes[i]], None, [firsts[i]])[0]
            for i in range(len(shoes))
        ]
    return [
        shoe_solution(brake, shoe, one, its)
        for shoe, one, its in zip(shoes, faces, found, strict=True)
    ]


def _singular_places(
    shoe: Shoe, shape: Outline, before: ShoeSolution | None, level: TriangleLevel
) -> SingularPlaces:
    """Kinks of a lining's gap and ends of its contact inside the lining, with lengths of triangles.

    Triangles at the ends of a contact are the smaller the shorter the contact is.
    """
    lining, tips = shoe.lining, {angle for angle, _ in clearance.tips(shoe.lining)}
    most = min(ENDS, level.halvings)
    beyond = 0.5 ** (level.halvings - most)  # under a tip p has no bound
    places = [
        (angle, shape.least * (beyond if angle in tips else 1.0))
        for angle in clearance.kinks(lining)
    ]
    for arc in [] if before is None else before.arcs:
        width = max((arc[1] - arc[0]) * shape.length, NARROWEST * shape.least)
        places += [(float(end), min(shape.least, width / 4)) for end in arc]
    slack = END_SLACK * (lining.end - lining.start)
    inside = [one for one in places if lining.start + slack < one[0] < lining.end - slack]
    angle, length = np.reshape(inside, (-1, 2)).T
    return SingularPlaces((angle - shape.origin) * shape.turn, length * 0.5**most)


def _initial_contact(one: CondensedFace, before: ShoeSolution | None) -> Bools:
    """Whether each node (n,) of a face is in contact at first.

    All nodes are, or with an earlier solution those on the arcs of its contacts.
    """
    if before is None:
        return np.ones(len(one.theta), dtype=bool)
    inside = [(one.theta > a - END_SLACK) & (one.theta < b + END_SLACK) for a, b in before.arcs]
    return np.any(inside, axis=0)


def solve_sequence(
    brake: Brake, levels: Sequence[TriangleLevel] = TRIANGLE_LEVELS
) -> list[list[ShoeSolution]]:
    """The solutions of all shoes on each of a sequence of meshes.

    Every mesh is graded to the ends of the contact that the mesh before has found. Solutions on the
    coarse mesh FINDING come first, until these ends settle. They begin with the parts LESS of the
    coefficient of friction, because with much friction a brake may have several answers and the
    answer that grows from the frictionless one is sought.

    Raises BadInput and NoAnswer as `solve` does.
    """
    before = None
    for part in LESS:
        with suppress(NoAnswer):
            before = solve(vary(brake, {"friction": part * brake.friction}), FINDING, before)
    for _ in range(PASSES):
        after = solve(brake, FINDING, before)
        same = before is not None and all(
            _have_same_contact_arcs(a.arcs, b.arcs) for a, b in zip(before, after, strict=True)
        )
        before = after
        if same:
            break
    found: list[list[ShoeSolution]] = []
    for level in levels:
        found.append(solve(brake, level, found[-1] if found else before))
    return found


def _have_same_contact_arcs(a: Floats, b: Floats) -> bool:
    """Whether two solutions have the same contacts, up to SETTLED_ENDS."""
    return a.shape == b.shape and bool(
        (np.abs(a - b).max(axis=1) < SETTLED_ENDS * np.diff(b, axis=1)[:, 0]).all()
    )
