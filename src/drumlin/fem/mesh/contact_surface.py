"""The contact nodes of a mesh file, moved onto the drum or the plane where the file is inexact.

A lining is round, and its mesh is not quite round. A node whose coordinates have few digits lies
off the circle by up to half of the last digit. The middle node of a straight edge lies off the
circle by the height of the arc over this edge. Both offsets are often larger than the compression
p t/E of the lining and would change the pressure, so that they are removed. A larger offset is the
lining's own shape and counts as a gap.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.brake.brake import Shoe
from drumlin.fem.mesh.from_file import MeshWithMovedContactNodes

LARGEST_STRAIGHT_EDGE_OFFSET_OVER_ARC_HEIGHT = 0.1
"""Largest distance of an edge's middle node from its chord at which the edge counts as straight.

The edge lies on the lining's face. The distance is relative to the height of the drum's arc over
the chord; an edge that follows the arc has the distance 1. The possible rounding of the coordinates
is added to the limit.
"""
LEAST_STRAIGHT_EDGE_FRACTION = 0.9
"""Fraction of the edges on a lining's face that must be straight for their nodes to be moved.

The middle nodes of the straight edges are then moved onto the drum: mesh generators make all edges
straight or none of them. A lining with one worn flat has curved edges elsewhere, and its flat must
stay.
"""
SMOOTHING_NODES_ON_EACH_SIDE = 8
"""Distance on each side of a node over which the offsets from the drum are averaged.

The distance is relative to the longer of two lengths: the median distance of neighbouring contact
nodes, and the length within which nodes have about the same rounding error. On an even mesh 17
nodes are averaged. The mean rounding error of 17 nodes is a quarter of the rounding error of one
node. The shape of a lining is then seen even if its height is less than the rounding of
coordinates.
"""
LINING_SHAPE_OFFSET_IN_STANDARD_ERRORS = 4.0
"""Ratio of a mean offset to its standard error above which the lining has a shape of its own.

The offset is the distance of neighbouring contact nodes from the drum. The standard error of its
mean comes from the rounding of coordinates alone. By rounding alone the ratio exceeds the limit at
one of 16 000 nodes.
"""
LARGEST_SCATTER_OVER_ROUNDING_SCATTER = 1.5
"""Ratio of a scatter to rounding errors above which contact nodes are not moved onto a smooth line.

The scatter is the root mean square distance of the nodes from the line, and the ratio relates it to
the standard deviation of one rounding error. A larger scatter shows a step or a corner in the
lining, which a smooth line would wipe out.
"""
NODE_ON_DRUM_TOLERANCE = 1e-12
"""Offset from the drum, relative to its radius, below which a contact node lies on the drum.

So small an offset is round-off of the computer's arithmetic.
"""


@dataclass(frozen=True)
class _ContactNodes:
    """The n nodes on the lining's face in a mesh, in the order of their angle.

    Parameters
    ----------
    nodes : (n,) indices of the nodes in the mesh
    middle : (n,) whether each node is the middle node of an element's edge
    phi : (n,) angle of each node [rad]
    off : (n,) offset of each node from the drum or the plane [m], positive for an open gap
    offset_bound_by_rounding : (n,) largest offset [m] that the rounding of the coordinates can
        cause
    """

    nodes: Ints
    middle: Bools
    phi: Floats
    off: Floats
    offset_bound_by_rounding: Floats


def move_contact_nodes_onto_drum_or_plane(
    mesh: Any, rounding: Floats, shoe: Shoe, radius: float
) -> MeshWithMovedContactNodes:
    """The mesh with its contact nodes moved onto the drum or the plane, and counts of moved nodes.

    Only those offsets are removed that come from the rounding of the file's coordinates or from
    straight edges of elements.

    Parameters
    ----------
    mesh : scikit-fem's mesh in the shoe's frame [m], with the group "contact"
    rounding : (2, nodes) largest rounding error of x and y of each node [m]
    shoe : the shoe of the mesh
    radius : radius of the drum [m]; on a plane the length of the pad
    """
    # The array `target` (n,) has the offset from the drum or the plane that each contact node will
    # have after the move [m].
    line = _contact_nodes_in_order_of_angle(mesh, rounding, shoe, radius)
    straight, largest = _middles_of_straight_edges_and_largest_unseen_offsets(
        mesh, line, shoe, radius
    )
    target = line.off.copy()
    free = ~(straight & line.middle) & (largest == 0)
    target[free] = _contact_offsets_without_rounding(line, free, shoe, radius)
    # The middle node of a straight edge is moved onto the smooth line through the corner nodes.
    if straight.any() or largest.any():
        corners = ~line.middle
        smooth = PchipInterpolator(line.phi[corners], target[corners])(line.phi)
        moved = straight | (np.abs(line.off - smooth) < largest)
        target[moved] = smooth[moved]
    target[np.abs(target) < NODE_ON_DRUM_TOLERANCE * radius] = 0.0
    moves = target - line.off
    moves[np.abs(moves) <= NODE_ON_DRUM_TOLERANCE * radius] = 0.0
    if not moves.any():
        return MeshWithMovedContactNodes(mesh)
    by_rounding = ~straight & (moves != 0)
    return MeshWithMovedContactNodes(
        _mesh_with_moved_contact_nodes(mesh, line, moves, shoe),
        rounded=int(np.count_nonzero(by_rounding)),
        largest_rounding_offset=float(np.abs(moves[by_rounding]).max(initial=0.0)),
        straight=int(np.count_nonzero(straight & (moves != 0))),
        largest_move_of_straight_edge_middle=float(np.abs(moves[straight]).max(initial=0.0)),
    )


def mesh_without_gaps_below_rounding(
    mesh: Any, largest_rounding_offset: float, shoe: Shoe, radius: float
) -> Any:
    """The mesh with contact nodes put on the drum or the plane if rounding may have moved them off.

    Parameters
    ----------
    mesh : scikit-fem's mesh in the shoe's frame [m], with the group "contact"
    largest_rounding_offset : largest offset [m] that rounding may have caused
    shoe : the shoe of the mesh
    radius : radius of the drum [m]; on a plane the length of the pad
    """
    exact = np.zeros(mesh.doflocs.shape)
    line = _contact_nodes_in_order_of_angle(mesh, exact, shoe, radius)
    moves = np.where(np.abs(line.off) <= largest_rounding_offset, -line.off, 0.0)
    return _mesh_with_moved_contact_nodes(mesh, line, moves, shoe)


def contact_offsets_in_order_of_angle(mesh: Any, shoe: Shoe, radius: float) -> Floats:
    """The distances (n,) [m] of a mesh's contact nodes off the drum or the plane, along the lining.

    Parameters
    ----------
    mesh : scikit-fem's mesh in the shoe's frame [m], with the group "contact"
    shoe : the shoe of the mesh
    radius : radius of the drum [m]; on a plane the length of the pad
    """
    exact = np.zeros(mesh.doflocs.shape)
    off = _contact_nodes_in_order_of_angle(mesh, exact, shoe, radius).off
    # Nodes that were put on the drum lie off it by round-off, which is no gap.
    return np.where(np.abs(off) <= NODE_ON_DRUM_TOLERANCE * radius, 0.0, off)


def _contact_nodes_in_order_of_angle(
    mesh: Any, rounding: Floats, shoe: Shoe, radius: float
) -> _ContactNodes:
    """The nodes on the lining's face in a mesh, in the order of their angle phi.

    The parameters are those of `move_contact_nodes_onto_drum_or_plane`.
    """
    facets = mesh.boundaries["contact"]
    corners = np.unique(mesh.facets[:, facets])
    has_middles = len(mesh.dofs.facet_dofs) > 0 and mesh.doflocs.shape[1] > mesh.nvertices
    middles = mesh.dofs.facet_dofs[0, facets] if has_middles else np.zeros(0, dtype=np.int64)
    nodes = np.concatenate([corners, middles])
    xy = mesh.doflocs[:, nodes]
    phi = shoe.surface_coordinates_of_points_in_shoe_frame(xy, radius)
    order = np.argsort(phi)
    nodes, xy = nodes[order], xy[:, order]
    normal = np.abs(_unit_normals_away_from_drum(xy, shoe))
    # On a drum the rounding errors of x and y both count: turning the coordinates into the shoe's
    # frame mixes them. On a plane only the coordinate square to the plane counts.
    offset_bound_by_rounding = (
        np.hypot(*rounding[:, nodes])
        if not shoe.is_on_plane
        else (normal * rounding[:, nodes]).sum(0)
    )
    return _ContactNodes(
        nodes=nodes,
        middle=(np.arange(len(nodes)) >= len(corners))[order],
        phi=phi[order],
        off=shoe.distances_from_friction_surface(xy, radius),
        offset_bound_by_rounding=offset_bound_by_rounding,
    )


def _unit_normals_away_from_drum(xy: Floats, shoe: Shoe) -> Floats:
    """The unit vectors (2, n) at points (2, n) that point away from the drum or the plane."""
    if shoe.is_on_plane:
        return np.array([np.zeros(xy.shape[1]), np.ones(xy.shape[1])])
    return -shoe.sign_internal_plus_external_minus * xy / np.hypot(*xy)


def _middles_of_straight_edges_and_largest_unseen_offsets(
    mesh: Any, line: _ContactNodes, shoe: Shoe, radius: float
) -> tuple[Bools, Floats]:
    """Which contact nodes (n,) are middles of straight edges, and how far others may be off (n,).

    On a straight edge of a quadratic element the middle node lies off the drum. No edge counts as
    straight if less than LEAST_STRAIGHT_EDGE_FRACTION of the edges on the lining's face are. If the
    arc over an edge is lower than twice the rounding of the coordinates, the coordinates do not
    show whether the edge is straight. Its middle node may then lie off the drum by up to the sum of
    the arc's height and the rounding [m], the second result. This is 0 for all other nodes.
    """
    straight, largest = np.zeros(len(line.nodes), dtype=bool), np.zeros(len(line.nodes))
    at = np.flatnonzero(line.middle)
    if shoe.is_on_plane or not len(at) or at[0] == 0 or at[-1] == len(line.nodes) - 1:
        return straight, largest
    xy, bound = mesh.doflocs[:, line.nodes], line.offset_bound_by_rounding[at]
    before, middle, after = xy[:, at - 1], xy[:, at], xy[:, at + 1]
    height = ((after - before) ** 2).sum(axis=0) / (8 * radius)
    beside = np.hypot(*(middle - (before + after) / 2))
    seen = height > 2 * bound + NODE_ON_DRUM_TOLERANCE * radius
    is_chord = seen & (beside <= LARGEST_STRAIGHT_EDGE_OFFSET_OVER_ARC_HEIGHT * height + 2 * bound)
    if is_chord.sum() >= LEAST_STRAIGHT_EDGE_FRACTION * max(seen.sum(), 1):
        straight[at] = is_chord
    unseen = (height <= 2 * bound) & (bound > NODE_ON_DRUM_TOLERANCE * radius)
    largest[at] = np.where(unseen, height + bound, 0.0)
    return straight, largest


def _contact_offsets_without_rounding(
    line: _ContactNodes, free: Bools, shoe: Shoe, radius: float
) -> Floats:
    """The offsets (k,) [m] of contact nodes from the drum or the plane, freed from rounding errors.

    The result has an entry for each node marked in `free`. An offset becomes 0 if rounding of the
    file's coordinates can explain it. Other offsets follow the smooth line through the nodes, or
    stay if no smooth line fits.
    """
    off, offset_bound_by_rounding, place = (
        line.off[free],
        line.offset_bound_by_rounding[free],
        line.phi[free] * radius,
    )
    shape = _lining_offsets_beyond_rounding(off, offset_bound_by_rounding, place, radius)
    found = off.copy()
    on = np.abs(off) <= offset_bound_by_rounding * (1 + 1e-6) + NODE_ON_DRUM_TOLERANCE * radius
    found[on & np.isnan(shape)] = 0.0
    # On a plane, rounding moves all nodes by whole multiples of the last digit. This is no random
    # scatter, so that these nodes are not moved onto a smooth line.
    smooth = ~np.isnan(shape) & (np.abs(shape - off) <= offset_bound_by_rounding)
    if not shoe.is_on_plane:
        found[smooth] = shape[smooth]
    return found


def _lining_offsets_beyond_rounding(
    off: Floats, offset_bound_by_rounding: Floats, place: Floats, radius: float
) -> Floats:
    """The lining's own offset (k,) [m] from the drum at each node; nan if rounding can explain it.

    A parabola is fitted to the offsets of the nodes around a node, and its value at the node is the
    offset. If no parabola fits, the given offset of the node is kept.

    Parameters
    ----------
    off : (k,) offsets of the nodes from the drum or the plane [m]
    offset_bound_by_rounding : (k,) largest offsets that the rounding of coordinates can cause [m]
    place : (k,) positions of the nodes along the lining [m]
    radius : radius of the drum [m]; on a plane the length of the pad
    """
    shape = np.full(len(off), np.nan)
    if len(off) < 3 or not offset_bound_by_rounding.any():
        shape[np.abs(off) > offset_bound_by_rounding] = off[np.abs(off) > offset_bound_by_rounding]
        return shape
    # Whether the offset of a node is more than rounding is judged by the mean offset of its
    # neighbours, in which rounding errors cancel.
    step = float(np.median(np.diff(place)))
    for i in range(len(off)):
        # Where the circle is parallel to x or y, all nodes within sqrt(2 R d) have about the same
        # rounding error, with the radius R and the largest error d. Fewer errors are independent.
        apart = max(step, float(np.sqrt(2 * radius * offset_bound_by_rounding[i])))
        near = np.flatnonzero(np.abs(place - place[i]) <= SMOOTHING_NODES_ON_EACH_SIDE * apart)
        scatter = float(offset_bound_by_rounding[near].mean()) / np.sqrt(6.0)
        independent = max(len(near) * min(1.0, step / apart), 1.0)
        standard_error = scatter / np.sqrt(independent)
        most = offset_bound_by_rounding[i] * (1 + 1e-6) + NODE_ON_DRUM_TOLERANCE * radius
        mean = abs(float(off[near].mean()))
        if mean <= LINING_SHAPE_OFFSET_IN_STANDARD_ERRORS * standard_error and abs(off[i]) <= most:
            continue
        fit = np.polynomial.Polynomial.fit(place[near], off[near], min(2, len(near) - 1))
        rest = off[near] - fit(place[near])
        rough = float(np.sqrt(np.mean(rest**2))) > LARGEST_SCATTER_OVER_ROUNDING_SCATTER * scatter
        shape[i] = off[i] if rough else fit(place[i])
    return shape


def _mesh_with_moved_contact_nodes(
    mesh: Any, line: _ContactNodes, moves: Floats, shoe: Shoe
) -> Any:
    """The mesh with its contact nodes moved by `moves` (n,) [m], square to the drum or the plane.

    A positive value of `moves` is a displacement away from the drum. The centre node of a
    quadrilateral follows its edges, so that the element keeps its shape.
    """
    doflocs = mesh.doflocs.copy()
    doflocs[:, line.nodes] += moves * _unit_normals_away_from_drum(doflocs[:, line.nodes], shoe)
    inner = mesh.dofs.interior_dofs
    if doflocs.shape[1] > mesh.nvertices and len(inner):
        change = doflocs - mesh.doflocs
        corners = change[:, mesh.t].sum(axis=1)
        middles = change[:, mesh.dofs.facet_dofs[0, mesh.t2f]].sum(axis=1)
        doflocs[:, inner[0]] += middles / 2 - corners / 4
    return replace(mesh, doflocs=doflocs)
