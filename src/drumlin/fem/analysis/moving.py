"""The motion of a shoe's nodes as a hinge, pivot, abutment or actuation point of the shoe moves.

A straight beam runs from the hinge to the actuation point. As either point moves, the beam turns.
The lining keeps its place, and the block between beam and lining changes its shape. The pivot of an
arc holds a part of the arc's back. If the pivot moves, the ends of this part move, and with them
the ends of elements. A mesh file in the shoe's own coordinates moves and turns with the support.
The nodes of all other bodies keep their places.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.beam_axis import make_beam_axis
from drumlin.brake.brake import Shoe
from drumlin.brake.components import BeamBody
from drumlin.brake.fields import Point
from drumlin.fem.preparation.bodies import NodePositionsAndActuationForces, ShoeSubstructure
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.substructure.interface import ContactLine

POINT_STEP_IN_DRUM_RADII_FOR_NODE_MOTION = 1e-5
"""Step, in drum radii, by which a point of a shoe moves in central differences of node positions.

The positions of the nodes are smooth functions of the point over a length of some radii. The
relative error of the difference is therefore POINT_STEP_IN_DRUM_RADII_FOR_NODE_MOTION^2 = 1e-10,
with some 1e-11 of round-off. A larger step is less exact, and a smaller step loses digits.
"""
LARGEST_NODE_MOTION_PER_POINT_MOTION = 1e3
"""Ratio of a node's motion to the motion of a shoe's point above which the mesh counts as changed.

Motions of the point move the nodes by similar distances. If the shoe with the moved point has one
more element or layer, or if another element ends where the held part of its back ends, then nodes
of the same number lie far apart, and their difference is no motion.
"""
LARGEST_NEGLECTED_CONTACT_NODE_MOTION = 1e-6
"""Ratio of a contact node's motion to the motion of a shoe's point below which it counts as zero.

Smaller motions are round-off, which is some 1e-11 in the central differences.
"""


KEYS_OF_POINTS_AT_BEAM_AXIS_ENDS = ("hinge", "actuation.point")
"""The two points between which the axis of a straight beam runs."""


class NodeMotionPerPointMotion(NamedTuple):
    """The motion of a body's nodes per unit motion of a support or of the actuation point.

    Vectors are in the frame of the shoe.

    Attributes
    ----------
    node_motion : motion (2 nodes,) of all nodes: x and y of the first node, then of the next
    contact_node_motion : motion (2, n) of the nodes of the contact line
    load_change : change (2 nodes,) [1/m] of the nodal forces of one newton of actuation, per metre
        by which the point moves
    beam_axis_turn_per_metre : turn [rad/m] of the axis of a straight beam; 0 for other bodies
    further_load_changes : change (2 nodes, l) per metre of the nodal forces of further unit loads,
        by their names; they hold for points whose motion does not turn the frame of the shoe
    """

    node_motion: Floats
    contact_node_motion: Floats
    load_change: Floats
    beam_axis_turn_per_metre: float
    further_load_changes: Mapping[str, Floats]

    @property
    def do_contact_nodes_stay_unmoved(self) -> bool:
        """Whether no contact node moves while the point of the shoe moves."""
        return float(np.abs(self.contact_node_motion).max()) < LARGEST_NEGLECTED_CONTACT_NODE_MOTION


def node_motions_per_motion_of_shoe_point(
    scene: PreparedModel, i: int, shoe: Shoe, key: str
) -> list[NodeMotionPerPointMotion]:
    """The motions of the nodes of a shoe as one of its points moves along x and along y.

    The axes x and y are those of the brake. The list has one motion for each axis. It is empty if
    neither a node nor the axis of a straight beam moves.

    Parameters
    ----------
    scene : the prepared model
    i : index of the shoe in the brake
    shoe : the shoe
    key : the point: "hinge", "pivot", "abutment.point" or "actuation.point"

    Raises
    ------
    NoAnswer
        if the division into elements changes with a small step of the point forwards and also with
        a small step backwards
    """
    moving = do_nodes_of_shoe_move_with_point(scene, shoe, key)
    turns_axis = isinstance(shoe.body, BeamBody) and key in KEYS_OF_POINTS_AT_BEAM_AXIS_ENDS
    if shoe.mesh is not None and not moving and turns_axis:
        return [
            _node_motion_that_only_turns_beam_axis(scene.bodies[i], shoe, key, axis)
            for axis in np.eye(2)
        ]
    if scene.nodes_of_changed_shoe is None or not moving:
        return []
    return [_node_motion_by_central_difference(scene, i, shoe, key, axis) for axis in np.eye(2)]


def do_nodes_of_shoe_move_with_point(scene: PreparedModel, shoe: Shoe, key: str) -> bool:
    """Whether nodes of a shoe's mesh move as the point of the shoe named by `key` moves."""
    # Without a mesh file drumlin divides the shoe into elements itself. The positions of the nodes
    # then depend on the points of the shoe.
    if shoe.mesh is None:
        beam = isinstance(shoe.body, BeamBody) and key in KEYS_OF_POINTS_AT_BEAM_AXIS_ENDS
        return beam or (
            key == "pivot"
            and shoe.interval_of_body_back_held_by_support(scene.brake.size) is not None
        )
    # The coordinates of a mesh in the shoe's own frame begin at one point: the pin, the point where
    # the foot stands, or the point of actuation of a guided shoe. If the key of this point changes,
    # the whole mesh moves with it.
    if shoe.guide is not None:
        holds_frame = "actuation.point"
    elif shoe.hinge is not None:
        holds_frame = "hinge"
    else:
        holds_frame = "abutment.point"
    return shoe.mesh_frame == "shoe" and key == holds_frame


def _node_motion_by_central_difference(
    scene: PreparedModel, i: int, shoe: Shoe, key: str, direction: Floats
) -> NodeMotionPerPointMotion:
    """The motion of a shoe's nodes per motion of a point along `direction` (2,).

    The motion is a central difference, or one-sided if the mesh changes on one of the two steps.
    Raises NoAnswer if the division into elements changes on both steps.
    """
    h = POINT_STEP_IN_DRUM_RADII_FOR_NODE_MOTION * scene.brake.size
    here = _shoe_nodes_and_nodal_forces_in_brake_frame(scene, i, shoe)
    places, loads, further = [], [], []
    for step in (h, -h):
        there = _shoe_nodes_and_nodal_forces_in_brake_frame(
            scene, i, _shoe_with_moved_point(shoe, key, step * direction)
        )
        # If the motion of the point by `step` changes the division into elements, the difference of
        # the node positions is no motion and is left out.
        same_division = there.xy.shape == here.xy.shape
        if (
            same_division
            and np.abs(there.xy - here.xy).max() < LARGEST_NODE_MOTION_PER_POINT_MOTION * h
        ):
            places.append((there.xy - here.xy) / step)
            loads.append((there.load - here.load) / step)
            further.append(
                {
                    name: (load - here.further_loads[name]) / step
                    for name, load in there.further_loads.items()
                }
            )
    if not places:
        raise NoAnswer(
            f"shoe {shoe.name!r}: no slope along its {key}, "
            "there its division into elements changes"
        )
    nodes = shoe.frame.convert_vectors_to_shoe_frame(np.mean(places, axis=0).T)
    load = shoe.frame.convert_vectors_to_shoe_frame(np.mean(loads, axis=0).T)
    line = nodes[scene.bodies[i].line.nodes].T
    return NodeMotionPerPointMotion(
        nodes.ravel(),
        line,
        load.ravel(),
        _rotation_of_beam_axis_per_motion_of_point(shoe, key, direction),
        {name: np.mean([each[name] for each in further], axis=0) for name in further[0]},
    )


def _node_motion_that_only_turns_beam_axis(
    body: ShoeSubstructure, shoe: Shoe, key: str, direction: Floats
) -> NodeMotionPerPointMotion:
    """The `NodeMotionPerPointMotion` of a beam whose mesh stays as an end of its axis moves.

    No node moves, but the directions of orthotropic layers turn with the axis.
    """
    still = np.zeros(2 * body.basis.N)
    return NodeMotionPerPointMotion(
        still,
        np.zeros(body.line.xy.shape),
        still,
        _rotation_of_beam_axis_per_motion_of_point(shoe, key, direction),
        {},
    )


def _rotation_of_beam_axis_per_motion_of_point(shoe: Shoe, key: str, direction: Floats) -> float:
    """The turn [rad/m] of a straight beam's axis per motion of the point `key` along a direction.

    The direction (2,) is a unit vector. Other bodies have the turn 0. The turn counts in the shoe's
    frame.
    """
    if not isinstance(shoe.body, BeamBody):
        return 0.0
    beam = make_beam_axis(shoe.pin.xy, shoe.actuation.point.xy)
    across = float(beam.along[0] * direction[1] - beam.along[1] * direction[0])
    sideways = shoe.frame.sense * across / beam.length
    return {"hinge": -sideways, "actuation.point": sideways}.get(key, 0.0)


def _shoe_nodes_and_nodal_forces_in_brake_frame(
    scene: PreparedModel, i: int, shoe: Shoe
) -> NodePositionsAndActuationForces:
    """The nodes and nodal forces of `shoe`, a changed copy of shoe `i`, in the brake's frame."""
    assert scene.nodes_of_changed_shoe is not None
    nodes = scene.nodes_of_changed_shoe(i, shoe)
    return NodePositionsAndActuationForces(
        shoe.convert_points_to_brake_frame(nodes.xy),
        shoe.frame.convert_vectors_from_shoe_to_brake_frame(nodes.load.T).T,
        nodes.further_loads,
    )


def _shoe_with_moved_point(shoe: Shoe, key: str, step: Floats) -> Shoe:
    """The shoe with the point `key` (as "hinge" or "abutment.point") moved by a step (2,) [m]."""
    part, _, inner = key.partition(".")
    whole = getattr(shoe, part)
    x, y = ((whole.point if inner else whole).xy + step).tolist()
    moved: Any = Point(x=x, y=y)
    if inner:
        moved = whole.model_copy(update={"point": moved})
    return shoe.model_copy(update={part: moved})


def contact_lines_with_moved_nodes(
    body: ShoeSubstructure, shoe: Shoe, radius: float, moves: NodeMotionPerPointMotion
) -> Iterator[tuple[float, ContactLine]]:
    """Yield the contact line after a point of the shoe moves by a step forwards or backwards.

    Each of the two items is the step [m], which is negative if backwards, and the contact line with
    its nodes moved.

    Parameters
    ----------
    body, shoe : the substructure and the shoe
    radius : radius of the drum [m]
    moves : motion of the nodes per motion of the point
    """
    line = body.line
    for step in (
        POINT_STEP_IN_DRUM_RADII_FOR_NODE_MOTION * radius,
        -POINT_STEP_IN_DRUM_RADII_FOR_NODE_MOTION * radius,
    ):
        xy = line.xy + step * moves.contact_node_motion
        yield (
            step,
            replace(line, xy=xy, phi=shoe.surface_coordinates_of_points_in_shoe_frame(xy, radius)),
        )
