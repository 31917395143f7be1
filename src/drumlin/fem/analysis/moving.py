"""How the nodes of a shoe's body move with the points that hold and push it, and what that changes
at its contact.

A straight beam runs from the hinge to the point of the actuation: it turns, and its block fills the
space up to the lining, which stays. The back of an arc is gripped where the pivot is, and the
elements end where the grip does. A mesh in the shoe's own frame turns with it. All other bodies
stay in their places on the drum or the plane.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.beam_axis import axis_of
from drumlin.brake.brake import Shoe
from drumlin.brake.components import Beam
from drumlin.brake.fields import Point
from drumlin.fem.preparation.bodies import BodyNodes, ShoeSubstructure
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.substructure.interface import ContactLine

STEP = 1e-5
"""Step of the central differences of places and of what hangs on places alone, in radii of the
drum. The places are smooth functions of the points over a length of some radii: the difference is
off by STEP^2 = 1e-10, and by some 1e-11 of round-off."""
FARTHEST = 1e3
"""Steps beyond which no node goes in one step of a point. A node that goes farther belongs to
another division: a column or a layer more, or another column that ends where the grip does."""
STILL = 1e-6
"""Part of a step below which a node of the contact stays: round-off."""


BEAM_POINTS = ("hinge", "actuation.point")
"""The two points between which the axis of a straight beam runs."""


class Moves(NamedTuple):
    """How the nodes of a body go as a point goes by a unit: `nodes` (2 nodes,), x and y of a node
    together, and those of the contact line, `line` (2, n); and how the force per newton of the
    actuation on each changes, `load` (2 nodes,) [1/m]; how far the axis of a straight beam turns,
    `axis` [rad/m], else 0. All in the shoe's frame, as it is before it moves."""

    nodes: Floats
    line: Floats
    load: Floats
    axis: float

    @property
    def contact_stays(self) -> bool:
        """Whether no node of the contact moves."""
        return float(np.abs(self.line).max()) < STILL


def moves_by(scene: PreparedModel, i: int, shoe: Shoe, key: str) -> list[Moves]:
    """How the nodes of shoe `i` go as one of its points goes along x and along y of the brake.

    key: "hinge", "pivot", "abutment.point" or "actuation.point". Empty where no node moves. Raises
    NoAnswer where the division into elements changes within a step on both sides.
    """
    radius = scene.brake.size
    if shoe.mesh is not None:
        moving = shoe.mesh_frame == "shoe" and key == (
            "actuation.point"
            if shoe.guide is not None
            else "hinge"
            if shoe.hinge is not None
            else "abutment.point"
        )
    else:
        beam = isinstance(shoe.body, Beam) and key in BEAM_POINTS
        moving = beam or (key == "pivot" and shoe.grip(radius) is not None)
    if shoe.mesh is not None and not moving and isinstance(shoe.body, Beam) and key in BEAM_POINTS:
        return [_only_turned(scene.bodies[i], _axis_turn(shoe, key, way)) for way in np.eye(2)]
    if scene.nodes_of is None or not moving:
        return []
    h, found = STEP * radius, []
    here = _in_brake(scene, i, shoe)
    for way in np.eye(2):
        sides = []
        for step in (h, -h):
            there = _in_brake(scene, i, _with_point(shoe, key, step * way))
            if there.xy.shape == here.xy.shape and np.abs(there.xy - here.xy).max() < FARTHEST * h:
                sides.append(BodyNodes(*((a - b) / step for a, b in zip(there, here, strict=True))))
        if not sides:
            raise NoAnswer(
                f"shoe {shoe.name!r}: no slope along its {key}, there its division into elements changes"
            )
        nodes, load = (
            shoe.frame.to_shoe(np.mean(part, axis=0).T) for part in zip(*sides, strict=True)
        )
        line = nodes[scene.bodies[i].line.nodes].T
        found.append(Moves(nodes.ravel(), line, load.ravel(), _axis_turn(shoe, key, way)))
    return found


def _only_turned(body: ShoeSubstructure, axis: float) -> Moves:
    """No node of a mesh in the brake's frame moves, but the directions of a straight beam turn."""
    still = np.zeros(2 * body.basis.N)
    return Moves(still, np.zeros(body.line.xy.shape), still, axis)


def _axis_turn(shoe: Shoe, key: str, way: Floats) -> float:
    """How far the axis of a straight beam turns in the shoe's frame as the point `key` goes by a
    unit along `way` [rad/m]; 0 of other bodies."""
    if not isinstance(shoe.body, Beam):
        return 0.0
    beam = axis_of(shoe.pin.xy, shoe.actuation.point.xy)
    sideways = (
        shoe.frame.sense * float(beam.along[0] * way[1] - beam.along[1] * way[0]) / beam.length
    )
    return {"hinge": -sideways, "actuation.point": sideways}.get(key, 0.0)


def _in_brake(scene: PreparedModel, i: int, shoe: Shoe) -> BodyNodes:
    """The nodes of shoe `i` as another shoe, in the brake's frame."""
    assert scene.nodes_of is not None
    found = scene.nodes_of(i, shoe)
    return BodyNodes(shoe.points(found.xy), shoe.frame.to_brake(found.load.T).T)


def _with_point(shoe: Shoe, key: str, step: Floats) -> Shoe:
    """The shoe with one of its points moved by a step (2,) [m]."""
    for part in ("actuation", "abutment"):
        if key == f"{part}.point":
            whole = getattr(shoe, part)
            return shoe.model_copy(
                update={part: whole.model_copy(update={"point": _moved(whole.point, step)})}
            )
    return shoe.model_copy(update={key: _moved(getattr(shoe, key), step)})


def _moved(point: Point, step: Floats) -> Point:
    x, y = (point.xy + step).tolist()
    return Point(x=x, y=y)


def lines_at(
    body: ShoeSubstructure, shoe: Shoe, radius: float, moves: Moves
) -> Iterator[tuple[float, ContactLine]]:
    """The contact line a step ahead and a step behind, with the step [m]."""
    line = body.line
    for step in (STEP * radius, -STEP * radius):
        xy = line.xy + step * moves.line
        yield step, replace(line, xy=xy, phi=shoe.phi_of(xy, radius))
