"""A shoe's mesh that was read from a file, and the notes on it that go with the shoe's result."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Shoe
from drumlin.brake.units import length_as_text_in_mm
from drumlin.response.response import ShoeResponse

SMALLEST_REPORTED_MOVE_OVER_LINING_COMPRESSION = 1e-3
"""Distance above which a note reports that contact nodes were moved, or lie off the surface.

The distance is relative to the lining's mean compression p t/E. The pressure changes by about the
same fraction.
"""
ZIGZAG_WAVE_HEIGHT_OVER_LINING_COMPRESSION = 0.2
"""Height of a wave in a lining's meshed face above which its top and its bottom are counted.

A top or a bottom is called a turn: the face changes there between rise and fall. The height is
relative to the lining's mean compression p t/E. A zigzag of this height makes the pressure go up
and down by a tenth of its mean.
"""
LARGEST_PIN_OFFSET_OVER_HOLE_RADIUS = 0.1
"""Distance of a pin from the centre of the hole of its mesh above which a note states it.

It is relative to the hole's radius. A drawing has the pin in the middle of its hole.
"""
LARGEST_HOLE_RADIUS_SCATTER = 0.02
"""Largest relative scatter of the distances from their centre of nodes that lie on a round hole.

The middles of the sides of a regular polygon with 16 sides are nearer to its centre by 0.02.
"""
LARGEST_ANGLE_BETWEEN_NODES_OF_HOLE = 2 * math.pi / 3
"""Angle [rad] between two neighbouring nodes, seen from their centre, from which no hole is round.

An equilateral triangle has this angle. The two ends of a straight line are half a turn apart.
"""
LARGEST_FORCE_LINE_OFFSET_OVER_BRAKE_SIZE = 0.25
"""Distance of a force's line from its group of edges above which a note states the distance.

It is relative to the brake's size, and measured from the middle of the group `actuation`. A line
is at most 0.1 of the size off on the examples.
"""
LARGEST_LINING_THICKNESS_DIFFERENCE_OF_MESH = 0.1
"""Relative difference of a lining's thickness in the brake file from the mesh that a note states.

The thickness of the mesh follows from the area of the lining and the length of the contact.
"""
MOST_RISE_FALL_CHANGES_ON_ANY_MESH = 5
"""Largest number of turns between rise and fall that a lining's face may have on any mesh.

Real linings have flats, steps or a worn end, which cause a few turns. A face with more turns is
accepted only if the mesh has at least FEWEST_NODES_PER_RISE_FALL_CHANGE contact nodes per turn.
"""
FEWEST_NODES_PER_RISE_FALL_CHANGE = 8
"""Smallest number of contact nodes per turn between rise and fall that shows a real shape.

A meshed face with more than MOST_RISE_FALL_CHANGES_ON_ANY_MESH turns and fewer nodes per turn is
refused. Its nodes are inexact and form a zigzag, or each straight edge was split into several.
"""
MOST_RISE_FALL_CHANGES_OF_LINING_FACE = 12
"""Number of turns between rise and fall above which a lining's face is refused as a polygon.

The number of nodes per turn does not matter. Turns are counted here if their height is above half
the lining's mean compression p t/E.
"""


@dataclass(frozen=True)
class MeshWithMovedContactNodes:
    """A mesh whose contact nodes were moved onto the drum or the plane, with counts of moved nodes.

    Parameters
    ----------
    mesh : scikit-fem's mesh in the shoe's frame [m]
    rounded : number of nodes that were moved to undo the rounding of their coordinates
    largest_rounding_offset : largest distance that these nodes were moved [m]
    straight : number of middle nodes of straight edges that were moved
    largest_move_of_straight_edge_middle : largest distance that these middle nodes were moved [m]
    """

    mesh: Any
    rounded: int = 0
    largest_rounding_offset: float = 0.0
    straight: int = 0
    largest_move_of_straight_edge_middle: float = 0.0


@dataclass(frozen=True)
class ShoeMeshReadFromFile:
    """A shoe's mesh that was read from a file, with notes on what was ignored or changed.

    Attributes
    ----------
    mesh : scikit-fem's mesh in the shoe's frame [m]
    contact : the mesh with counts of the contact nodes that were moved onto the drum or the plane
    in_file : the same mesh with the contact nodes where the file has them [m]
    off : (n,) distances of the mesh's contact nodes off the drum or the plane, along the lining [m]
    notes : lines that tell which parts of the file were ignored or changed
    """

    mesh: Any
    contact: MeshWithMovedContactNodes
    in_file: Any
    off: Floats
    notes: tuple[str, ...]


def notes_on_mesh_file(
    shoe: Shoe, made: ShoeMeshReadFromFile, response: ShoeResponse, size: float
) -> Iterator[str]:
    """Yield the notes on a shoe's mesh file that go with the shoe's result, one line each.

    The notes report parts of the file that were ignored, contact nodes that were moved, and offsets
    of the contact that count as a gap.

    Parameters
    ----------
    shoe : the shoe
    made : mesh of the shoe
    response : result of the shoe, which gives the mean pressure
    size : size of the brake [m] (`Brake.size`)

    Raises
    ------
    BadInput
        if the contact nodes form a zigzag or a polygon
    """
    lead = f"shoe {shoe.name!r}: its mesh"
    yield from (f"{lead}: {note}" for note in made.notes)
    yield from (
        f"{lead}: {note}" for note in notes_on_file_that_differs_from_mesh(shoe, made.mesh, size)
    )
    compression = mean_compression_of_lining(shoe, response)
    if compression <= 0:
        return
    # Nodes that were moved farther than a small part of the compression are reported.
    contact, surface = made.contact, shoe.surface.name
    moves = (
        (
            contact.rounded,
            contact.largest_rounding_offset,
            "nodes",
            "the rounding of the file's coordinates",
        ),
        (
            contact.straight,
            contact.largest_move_of_straight_edge_middle,
            "middle nodes",
            "sides that are straight",
        ),
    )
    for count, by, nodes, cause in moves:
        if by > SMALLEST_REPORTED_MOVE_OVER_LINING_COMPRESSION * compression:
            yield (
                f"{lead}: {count} {nodes} of the contact line were put on the {surface}, "
                f"by up to {_text_of_distance_and_ratio_to_compression(by, compression)}: {cause}"
            )
    # Offsets that remain count as a gap, unless they are a zigzag.
    _check_contact_is_no_zigzag(made.off, compression, lead, surface)
    most = float(np.abs(made.off).max())
    if most > SMALLEST_REPORTED_MOVE_OVER_LINING_COMPRESSION * compression:
        distance = _text_of_distance_and_ratio_to_compression(most, compression)
        yield (
            f"{lead}: the contact line lies up to {distance} off the {surface}; "
            "this counts as the lining's shape, a gap"
        )


def notes_on_file_that_differs_from_mesh(shoe: Shoe, mesh: Any, size: float) -> Iterator[str]:
    """Yield a note for each place or length of the brake file that the mesh hardly agrees with.

    These are the thickness of the lining, the pin and the line of the actuation force. `mesh` is in
    the frame of the shoe, and `size` [m] is the size of the brake.
    """
    thickness = _thickness_of_meshed_lining(shoe, mesh, size)
    if abs(thickness / shoe.lining.thickness - 1) > LARGEST_LINING_THICKNESS_DIFFERENCE_OF_MESH:
        yield (
            f"lining.thickness = {length_as_text_in_mm(shoe.lining.thickness)} in the brake file, "
            f"but the lining of the mesh is {1e3 * thickness:.3g} mm thick; the mesh has the shape"
        )
    hole = mesh.p[:, np.unique(mesh.facets[:, mesh.boundaries["hinge"]])]
    pin = shoe.pin_position_in_shoe_frame
    centre = 0.5 * (hole.max(axis=1) + hole.min(axis=1))
    radii = np.hypot(*(hole - centre[:, None]))
    away = math.dist(pin, centre)
    # The nodes of a round hole have one distance from its centre and lie all around it.
    angles = np.sort(np.arctan2(hole[1] - centre[1], hole[0] - centre[0]))
    widest = float(np.diff(angles, append=angles[0] + 2 * math.pi).max())
    is_round = widest < LARGEST_ANGLE_BETWEEN_NODES_OF_HOLE and (
        float(np.ptp(radii)) <= LARGEST_HOLE_RADIUS_SCATTER * float(radii.mean())
    )
    if is_round and away > LARGEST_PIN_OFFSET_OVER_HOLE_RADIUS * float(radii.mean()):
        yield (
            f"the pin is {1e3 * away:.3g} mm from the centre of the round group hinge, whose "
            f"radius is {1e3 * float(radii.mean()):.3g} mm"
        )
    if "actuation" in mesh.boundaries and shoe.actuation.force:
        yield from _note_on_force_line_off_its_group(shoe, mesh, size)


def _thickness_of_meshed_lining(shoe: Shoe, mesh: Any, size: float) -> float:
    """The thickness [m] of a lining by the area of its elements and the length of its contact.

    `mesh` is in the frame of the shoe, and `size` [m] is the size of the brake.
    """
    x, y = mesh.p[:, mesh.t]
    # The area of a polygon by its corners (shoelace formula).
    areas = 0.5 * np.abs((x * np.roll(y, -1, axis=0) - np.roll(x, -1, axis=0) * y).sum(axis=0))
    sides = mesh.p[:, mesh.facets[:, mesh.boundaries["contact"]]]
    length = float(np.hypot(*(sides[:, 1] - sides[:, 0])).sum())
    thickness = float(areas[mesh.subdomains["lining"]].sum()) / length
    if not shoe.is_on_plane:
        # The area of a ring's sector over the length L of its face on a circle of radius R is
        # t - t^2/(2 R) for a lining within the circle, and t + t^2/(2 R) outside of it.
        sign = shoe.sign_internal_plus_external_minus
        thickness = sign * size * (1 - math.sqrt(max(1 - 2 * sign * thickness / size, 0.0)))
    return thickness


def _note_on_force_line_off_its_group(shoe: Shoe, mesh: Any, size: float) -> Iterator[str]:
    """Yield a note if the line of the actuation force passes far from the group `actuation`.

    `mesh` is in the frame of the shoe, and `size` [m] is the size of the brake.
    """
    nodes = np.unique(mesh.facets[:, mesh.boundaries["actuation"]])
    middle = shoe.convert_points_to_brake_frame(mesh.p[:, nodes].mean(axis=1, keepdims=True))[:, 0]
    along = shoe.actuation.unit_vector_of_force
    to_middle = middle - np.array(shoe.actuation.point.xy)
    away = abs(float(along[0] * to_middle[1] - along[1] * to_middle[0]))
    if away > LARGEST_FORCE_LINE_OFFSET_OVER_BRAKE_SIZE * size:
        yield (
            f"the line of the force passes {1e3 * away:.3g} mm from the middle of the group "
            "actuation, on which the force then acts together with its moment"
        )


def mean_compression_of_lining(shoe: Shoe, response: ShoeResponse) -> float:
    """The lining's mean compression p t/E [m].

    The pressure p is the mean over the whole length of the lining, t is its thickness, and E its
    modulus through the thickness.
    """
    theta, pressure = response.theta, response.pressure
    length = float(theta[-1] - theta[0])
    mean = float(np.sum((pressure[1:] + pressure[:-1]) / 2 * np.diff(theta))) / length
    return mean * shoe.lining.thickness / shoe.lining.material.E_through


def _text_of_distance_and_ratio_to_compression(distance: float, compression: float) -> str:
    """The text of a distance [m], with its ratio to the lining's mean compression [m]."""
    ratio = f"{distance / compression:.2g}"
    return f"{distance * 1e6:.3g} um ({ratio} of the lining's mean compression p t/E)"


def _check_contact_is_no_zigzag(off: Floats, compression: float, lead: str, surface: str) -> None:
    """Refuse a mesh whose contact nodes form a zigzag or a polygon.

    Parameters
    ----------
    off : (n,) offsets of the contact nodes from the drum or the plane, along the lining [m]
    compression : mean compression of the lining [m]
    lead : beginning of the message
    surface : word for the surface in the message: drum or plane
    """
    turns, high = (
        count_changes_between_rise_and_fall(
            off, ZIGZAG_WAVE_HEIGHT_OVER_LINING_COMPRESSION * compression
        ),
        count_changes_between_rise_and_fall(off, compression / 2),
    )
    unresolved = (
        turns > MOST_RISE_FALL_CHANGES_ON_ANY_MESH
        and len(off) < FEWEST_NODES_PER_RISE_FALL_CHANGE * turns
    )
    if unresolved or high > MOST_RISE_FALL_CHANGES_OF_LINING_FACE:
        raise BadInput(
            f"{lead}: the contact line goes off the {surface} and back {turns} times on "
            f"{len(off)} nodes, by up to "
            f"{_text_of_distance_and_ratio_to_compression(float(np.abs(off).max()), compression)}: "
            f"a zigzag or a polygon is no lining; put its nodes on the {surface}, "
            "write more digits, or curve its sides"
        )


def count_changes_between_rise_and_fall(off: Floats, height: float) -> int:
    """The number of times that offsets (n,) turn from rising to falling or from falling to rising.

    A turn is counted only after a rise or fall by more than `height`.
    """
    turns, direction = 0, 0
    # While the offsets rise, `extreme` is the highest value so far; while they fall, the lowest.
    extreme = float(off[0])
    for value in off.tolist():
        if direction * (value - extreme) > 0:
            extreme = value
        elif abs(value - extreme) > height:
            turns += direction != 0
            direction = 1 if value > extreme else -1
            extreme = value
    return turns
