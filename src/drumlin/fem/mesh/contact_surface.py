"""The contact line of a mesh file, put on the drum or the plane where only the mesh keeps it off.

A lining is round, and its mesh is not quite round. Nodes with coordinates of few digits lie off the
circle by up to half a digit, and the middle node of a straight side by the height of the arc over
that side. Both offsets are often larger than the compression p t/E of the lining, so that they
would change the pressure. A larger offset is the lining's own shape and counts as a gap.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.brake.brake import Shoe
from drumlin.fem.mesh.from_file import ContactOnSurface

STRAIGHT = 0.1
"""Distance of a side's middle node from its chord up to which the side counts as straight.

The distance is relative to the height of the arc over the chord; a side that follows the arc has
the distance 1. The rounding of the coordinates is added to the limit.
"""
STRAIGHT_SIDES = 0.9
"""Smallest share of straight sides on the contact at which their middle nodes are moved.

Mesh generators make all sides straight or none of them. A lining with one worn flat has curved
sides elsewhere, and its flat must stay.
"""
SMOOTHING_NODES = 8
"""Number of nodes to each side of a node over which the rounding errors are averaged.

The mean rounding error of the 17 nodes is a quarter of a single one, so that a lining's shape is
seen even where its height is less than the rounding.
"""
SIGNIFICANT = 4.0
"""Mean offset of the nodes around a node above which the offset is the lining's shape.

The offset is in standard deviations of the mean rounding error. Chance alone exceeds the limit at
one of 16 000 nodes.
"""
MOST_NOISE = 1.5
"""Scatter of the nodes about a smooth line above which the nodes stay where they are.

The scatter is in standard deviations of one rounding error. A larger scatter shows a step or a
corner in the lining, which a smooth line would wipe out.
"""
COORDINATE_ROUND_OFF = 1e-12
"""Offset of a node from the drum, in drum radii, up to which the offset is round-off alone."""


@dataclass(frozen=True)
class _ContactNodes:
    """The nodes of the contact line, sorted along it.

    Parameters
    ----------
    nodes : numbers of the nodes (n,) in the mesh
    middle : whether each node (n,) is the middle of a side
    phi : place (n,) [rad] of each node
    off : distance (n,) [m] from the surface
    slack : how far the coordinates' rounding may hold each node (n,) off the surface [m]
    """

    nodes: Ints
    middle: Bools
    phi: Floats
    off: Floats
    slack: Floats


def move_contact_nodes_onto_surface(
    mesh: Any, rounding: Floats, shoe: Shoe, radius: float
) -> ContactOnSurface:
    """The mesh with its contact nodes moved onto the drum or the plane, and what was moved.

    Only offsets by the rounding of the file's coordinates and by straight sides are removed.

    Parameters
    ----------
    mesh : skfem's mesh in the shoe's frame [m], with the group contact
    rounding : (2, nodes), how far x and y of each node may have been rounded [m]
    shoe, radius : whose mesh it is, and the drum's radius [m] or the pad's length
    """
    line = _contact_nodes_of(mesh, rounding, shoe, radius)
    straight = _find_straight_middles(mesh, line, shoe, radius)
    target = line.off.copy()
    free = ~(straight & line.middle)
    target[free] = _smooth_offsets(line, free, shoe, radius)
    # The middle of a straight side stands on the smooth line through the corners.
    if straight.any():
        corners = ~line.middle
        smooth = PchipInterpolator(line.phi[corners], target[corners])
        target[straight] = smooth(line.phi[straight])
    target[np.abs(target) < COORDINATE_ROUND_OFF * radius] = 0.0
    moves = target - line.off
    moves[np.abs(moves) <= COORDINATE_ROUND_OFF * radius] = 0.0
    if not moves.any():
        return ContactOnSurface(mesh)
    by_rounding = free & (moves != 0)
    return ContactOnSurface(
        _move_contact_nodes(mesh, line, moves, shoe),
        rounded=int(np.count_nonzero(by_rounding)),
        rounded_by=float(np.abs(moves[by_rounding]).max(initial=0.0)),
        straight=int(np.count_nonzero(straight & (moves != 0))),
        straight_by=float(np.abs(moves[straight]).max(initial=0.0)),
    )


def _contact_nodes_of(mesh: Any, rounding: Floats, shoe: Shoe, radius: float) -> _ContactNodes:
    """The nodes of a mesh's contact line, sorted by their angle phi, with offsets and roundings."""
    facets = mesh.boundaries["contact"]
    corners = np.unique(mesh.facets[:, facets])
    has_middles = len(mesh.dofs.facet_dofs) > 0 and mesh.doflocs.shape[1] > mesh.nvertices
    middles = mesh.dofs.facet_dofs[0, facets] if has_middles else np.zeros(0, dtype=np.int64)
    nodes = np.concatenate([corners, middles])
    xy = mesh.doflocs[:, nodes]
    phi = shoe.phi_of(xy, radius)
    order = np.argsort(phi)
    nodes, xy = nodes[order], xy[:, order]
    normal = np.abs(_outward_normals(xy, shoe))
    # Coordinates that were turned mix the roundings of x and y, and so does the shoe's own frame.
    slack = np.hypot(*rounding[:, nodes]) if not shoe.flat else (normal * rounding[:, nodes]).sum(0)
    return _ContactNodes(
        nodes=nodes,
        middle=(np.arange(len(nodes)) >= len(corners))[order],
        phi=phi[order],
        off=shoe.off(xy, radius),
        slack=slack,
    )


def _outward_normals(xy: Floats, shoe: Shoe) -> Floats:
    """Unit vectors (2, n) at points (2, n) that point away from the drum or the plane."""
    if shoe.flat:
        return np.array([np.zeros(xy.shape[1]), np.ones(xy.shape[1])])
    return -shoe.sign * xy / np.hypot(*xy)


def _find_straight_middles(mesh: Any, line: _ContactNodes, shoe: Shoe, radius: float) -> Bools:
    """Which nodes (n,) are middle nodes that straight sides keep off the drum."""
    found = np.zeros(len(line.nodes), dtype=bool)
    at = np.flatnonzero(line.middle)
    if shoe.flat or not len(at) or at[0] == 0 or at[-1] == len(found) - 1:
        return found
    xy = mesh.doflocs[:, line.nodes]
    first, last = xy[:, at - 1], xy[:, at + 1]
    chord = np.hypot(*(last - first))
    height = chord**2 / (8 * radius)
    beside = np.hypot(*(xy[:, at] - (first + last) / 2))
    # Where the arc is lower than a rounding, a straight side cannot be told and does no harm.
    seen = height > 2 * line.slack[at] + COORDINATE_ROUND_OFF * radius
    straight = seen & (beside <= STRAIGHT * height + 2 * line.slack[at])
    counted = max(int(np.count_nonzero(seen)), 1)
    if np.count_nonzero(straight) >= STRAIGHT_SIDES * counted:
        found[at[straight]] = True
    return found


def _smooth_offsets(line: _ContactNodes, free: Bools, shoe: Shoe, radius: float) -> Floats:
    """Offsets (k,) of the free nodes without the rounding of their coordinates.

    They are 0 where the offset is no more than the roundings explain; elsewhere they follow the
    smooth line through the nodes, or stay.
    """
    off, slack, place = line.off[free], line.slack[free], line.phi[free] * radius
    shape = _offsets_beyond_rounding(off, slack, place, radius)
    found = off.copy()
    on = np.abs(off) <= slack * (1 + 1e-6) + COORDINATE_ROUND_OFF * radius
    found[on & np.isnan(shape)] = 0.0
    # A plane's nodes are off by whole steps of the last digit: there is no scatter to smooth.
    smooth = ~np.isnan(shape) & (np.abs(shape - off) <= slack)
    if not shoe.flat:
        found[smooth] = shape[smooth]
    return found


def _offsets_beyond_rounding(off: Floats, slack: Floats, place: Floats, radius: float) -> Floats:
    """The shape (k,) [m] of the lining at each node; nan where rounding explains the offset.

    The shape is a parabola through the offsets `off` (k,) [m] of the nodes around a node. Where a
    parabola does not describe these offsets, the shape is the offset of the node itself.
    """
    shape = np.full(len(off), np.nan)
    if len(off) < 3 or not slack.any():
        shape[np.abs(off) > slack] = off[np.abs(off) > slack]
        return shape
    # Each node is judged by the mean offset of its neighbours, in which rounding errors cancel.
    step = float(np.median(np.diff(place)))
    for i in range(len(off)):
        # Where the circle runs along an axis, nodes closer than sqrt(2 R d) are rounded alike.
        apart = max(step, float(np.sqrt(2 * radius * slack[i])))
        near = np.flatnonzero(np.abs(place - place[i]) <= SMOOTHING_NODES * apart)
        scatter = float(slack[near].mean()) / np.sqrt(6.0)
        independent = max(len(near) * min(1.0, step / apart), 1.0)
        mean = float(off[near].mean())
        beyond = np.abs(off[near]) > slack[near] * (1 + 1e-6) + COORDINATE_ROUND_OFF * radius
        if abs(mean) <= SIGNIFICANT * scatter / np.sqrt(independent) and not beyond.any():
            continue
        if abs(off[i]) <= slack[i] and abs(mean) <= SIGNIFICANT * scatter / np.sqrt(independent):
            continue
        fit = np.polynomial.Polynomial.fit(place[near], off[near], min(2, len(near) - 1))
        rest = off[near] - fit(place[near])
        rough = float(np.sqrt(np.mean(rest**2))) > MOST_NOISE * scatter
        shape[i] = off[i] if rough else fit(place[i])
    return shape


def _move_contact_nodes(mesh: Any, line: _ContactNodes, moves: Floats, shoe: Shoe) -> Any:
    """The mesh with the nodes of the contact line moved off the surface by `moves` (n,) [m].

    The centre of a quadrilateral follows its sides, so that the element keeps its shape.
    """
    doflocs = mesh.doflocs.copy()
    doflocs[:, line.nodes] += moves * _outward_normals(doflocs[:, line.nodes], shoe)
    inner = mesh.dofs.interior_dofs
    if doflocs.shape[1] > mesh.nvertices and len(inner):
        change = doflocs - mesh.doflocs
        corners = change[:, mesh.t].sum(axis=1)
        middles = change[:, mesh.dofs.facet_dofs[0, mesh.t2f]].sum(axis=1)
        doflocs[:, inner[0]] += middles / 2 - corners / 4
    return replace(mesh, doflocs=doflocs)
