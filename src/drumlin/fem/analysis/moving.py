"""The motion of the nodes of a shoe's body with the points that hold and push it, and its effects.

A straight beam runs from the hinge to the point of the actuation. As either point moves, the beam
turns, and its block fills the space up to the lining, which stays. The back of an arc is gripped at
the pivot, and elements end where the grip ends. A mesh in the shoe's own frame turns with the
frame. All other bodies stay in their places on the drum or the plane.
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
from drumlin.fem.preparation.bodies import Body, BodyNodes
from drumlin.fem.preparation.scene import Scene
from drumlin.fem.substructure.interface import ContactLine

NODE_STEP = 1e-5
"""Step of the central differences of places and of quantities that depend on places alone, in radii
of the drum. The places are smooth functions of the points over a length of some radii, so that the
difference is off by NODE_STEP^2 = 1e-10, and by some 1e-11 of round-off. A larger step is less
exact, and a smaller step loses digits.
"""
FARTHEST = 1e3
"""Distance, in steps of a point, beyond which no node moves in one step. A node that moves farther
belongs to another division: an hp element or a layer more, or another element that ends where the
grip does.
"""
STILL = 1e-6
"""Motion of a contact node per motion of a point, below which the contact counts as unmoved.

Smaller motions are taken for round-off, which is some 1e-11 in the central differences.
"""


BEAM_POINTS = ("hinge", "actuation.point")
"""The two points between which the axis of a straight beam runs."""


class Moves(NamedTuple):
    """The motion of a body's nodes per unit motion of a point, in the frame of the shoe.

    Attributes
    ----------
    nodes : motion (2 nodes,), x and y of a node together
    line : motion (2, n) of the nodes of the contact line
    load : change (2 nodes,) [1/m] of the force on each node per newton of the actuation
    axis : turn of the axis of a straight beam [rad/m]; 0 for other bodies
    """

    nodes: Floats
    line: Floats
    load: Floats
    axis: float

    @property
    def contact_stays(self) -> bool:
        """Whether no node of the contact moves."""
        return float(np.abs(self.line).max()) < STILL


class LineAtStep(NamedTuple):
    """A contact line moved by a `step` [m] of a point."""

    step: float
    line: ContactLine


def moves_by(scene: Scene, i: int, shoe: Shoe, key: str) -> list[Moves]:
    """The motion of the nodes of shoe `i` as one of its points moves along x and along y.

    The list is empty where no node moves. The axes are those of the brake.

    Parameters
    ----------
    scene : the prepared model
    i : position of the shoe in the brake
    shoe : the shoe
    key : "hinge", "pivot", "abutment.point" or "actuation.point"

    Raises
    ------
    NoAnswer
        where the division into elements changes within a step on both sides
    """
    moving = _nodes_move(scene, shoe, key)
    turns_axis = isinstance(shoe.body, Beam) and key in BEAM_POINTS
    if shoe.mesh is not None and not moving and turns_axis:
        turns = [_axis_turn(shoe, key, direction) for direction in np.eye(2)]
        return [_only_turned(scene.bodies[i], turn) for turn in turns]
    if scene.nodes_of is None or not moving:
        return []
    return [_moves_along(scene, i, shoe, key, direction) for direction in np.eye(2)]


def _nodes_move(scene: Scene, shoe: Shoe, key: str) -> bool:
    """Whether nodes of a shoe's body move with the point `key`."""
    if shoe.mesh is None:
        beam = isinstance(shoe.body, Beam) and key in BEAM_POINTS
        return beam or (key == "pivot" and shoe.grip(scene.brake.size) is not None)
    # A mesh in the frame of the shoe moves with the point that holds the frame.
    if shoe.guide is not None:
        holds_frame = "actuation.point"
    elif shoe.hinge is not None:
        holds_frame = "hinge"
    else:
        holds_frame = "abutment.point"
    return shoe.mesh_frame == "shoe" and key == holds_frame


def _moves_along(scene: Scene, i: int, shoe: Shoe, key: str, direction: Floats) -> Moves:
    """The motion of the nodes of shoe `i` as a point moves along a direction (2,), by differences.

    Raises NoAnswer as `moves_by` does.
    """
    h = NODE_STEP * scene.brake.size
    here = _in_brake(scene, i, shoe)
    places, loads = [], []
    for step in (h, -h):
        there = _in_brake(scene, i, _with_point(shoe, key, step * direction))
        same_division = there.xy.shape == here.xy.shape
        if same_division and np.abs(there.xy - here.xy).max() < FARTHEST * h:
            places.append((there.xy - here.xy) / step)
            loads.append((there.load - here.load) / step)
    if not places:
        raise NoAnswer(
            f"shoe {shoe.name!r}: no slope along its {key}, there its division into elements changes"
        )
    nodes = shoe.frame.to_shoe(np.mean(places, axis=0).T)
    load = shoe.frame.to_shoe(np.mean(loads, axis=0).T)
    line = nodes[scene.bodies[i].line.nodes].T
    return Moves(nodes.ravel(), line, load.ravel(), _axis_turn(shoe, key, direction))


def _only_turned(body: Body, axis: float) -> Moves:
    """The motion of a mesh in the brake's frame: no node moves, but a beam's directions turn."""
    still = np.zeros(2 * body.basis.N)
    return Moves(still, np.zeros(body.line.xy.shape), still, axis)


def _axis_turn(shoe: Shoe, key: str, direction: Floats) -> float:
    """The turn of a straight beam's axis in the shoe's frame per motion of a point [rad/m].

    The point `key` moves along `direction` (2,). Other bodies have the turn 0.
    """
    if not isinstance(shoe.body, Beam):
        return 0.0
    beam = axis_of(shoe.pin.xy, shoe.actuation.point.xy)
    across = float(beam.along[0] * direction[1] - beam.along[1] * direction[0])
    sideways = shoe.frame.sense * across / beam.length
    return {"hinge": -sideways, "actuation.point": sideways}.get(key, 0.0)


def _in_brake(scene: Scene, i: int, shoe: Shoe) -> BodyNodes:
    """The nodes of shoe `i`, replaced by another shoe, in the frame of the brake."""
    assert scene.nodes_of is not None
    nodes = scene.nodes_of(i, shoe)
    return BodyNodes(shoe.points(nodes.xy), shoe.frame.to_brake(nodes.load.T).T)


def _with_point(shoe: Shoe, key: str, step: Floats) -> Shoe:
    """The shoe with one of its points moved by a step (2,) [m]."""
    for part in ("actuation", "abutment"):
        if key == f"{part}.point":
            whole = getattr(shoe, part)
            other = whole.model_copy(update={"point": _moved_point(whole.point, step)})
            return shoe.model_copy(update={part: other})
    return shoe.model_copy(update={key: _moved_point(getattr(shoe, key), step)})


def _moved_point(point: Point, step: Floats) -> Point:
    """The point moved by a step (2,) [m]."""
    x, y = (point.xy + step).tolist()
    return Point(x=x, y=y)


def lines_at(body: Body, shoe: Shoe, radius: float, moves: Moves) -> Iterator[LineAtStep]:
    """The contact line of a body a step ahead and a step behind; radius: of the drum [m]."""
    line = body.line
    for step in (NODE_STEP * radius, -NODE_STEP * radius):
        xy = line.xy + step * moves.line
        yield LineAtStep(step, replace(line, xy=xy, phi=shoe.phi_of(xy, radius)))
