"""A shoe's mesh from a file, the changes made to the mesh, and the notes of an answer on them."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Shoe
from drumlin.response.response import ShoeResponse

SMALLEST_REPORTED_MOVE = 1e-3
"""Distance above which a note tells of a moved node, or of a contact line off the surface.

The distance is relative to the lining's mean compression p t/E. The pressure changes by about the
same fraction.
"""
ZIGZAG = 0.2
"""Height above which the ups and downs of a contact line count as turns.

The height is relative to the lining's mean compression p t/E. A zigzag of this height makes the
pressure go up and down by a tenth of its mean.
"""
FEW_TURNS = 5
"""Number of turns that the contact line of any lining may have: flats, steps, a worn end."""
NODES_PER_TURN = 8
"""Smallest number of nodes per turn of the contact line on a mesh that resolves a lining's shape.

A line with more than FEW_TURNS turns and fewer nodes per turn is a zigzag of the mesh, or its
straight sides were split.
"""
MOST_TURNS = 12
"""Number of turns above which a contact line is a polygon, however many nodes resolve each turn.

Turns count here from a height of half the lining's mean compression p t/E on.
"""


@dataclass(frozen=True)
class ContactOnSurface:
    """A mesh with its contact line put on the lining's surface, and what was moved.

    Parameters
    ----------
    mesh : skfem's mesh in the shoe's frame [m]
    rounded : number of nodes that were moved by no more than the rounding of their coordinates
    rounded_by : the largest of these moves [m]
    straight : number of middle nodes of straight sides that were moved
    straight_by : the largest of these moves [m]
    """

    mesh: Any
    rounded: int = 0
    rounded_by: float = 0.0
    straight: int = 0
    straight_by: float = 0.0


@dataclass(frozen=True)
class ShoeMesh:
    """A shoe's mesh from a file, in the shoe's frame [m], and what the file was taken for.

    `contact` says which nodes of the contact line were put on the lining's surface; `notes` what
    was passed over and changed.
    """

    mesh: Any
    contact: ContactOnSurface
    notes: tuple[str, ...]


def notes_on_mesh_file(
    shoe: Shoe, made: ShoeMesh, xy: Floats, radius: float, response: ShoeResponse
) -> Iterator[str]:
    """Lines about a shoe's mesh file: what was passed over, what was moved, and what counts as gap.

    Parameters
    ----------
    shoe, radius : the shoe, and the drum's radius [m] or the pad's length
    made : its mesh
    xy : nodes (2, n) [m] of the contact line, sorted along it
    response : the shoe's answer, for its mean pressure

    Raises
    ------
    BadInput
        for a contact line in zigzag, and for a polygon
    """
    lead = f"shoe {shoe.name!r}: its mesh"
    yield from (f"{lead}: {note}" for note in made.notes)
    compression = mean_compression(shoe, response)
    if compression <= 0:
        return
    contact, surface = made.contact, shoe.surface.word
    moves = (
        (contact.rounded, contact.rounded_by, "nodes", "the rounding of the file's coordinates"),
        (contact.straight, contact.straight_by, "middle nodes", "sides that are straight"),
    )
    for count, by, nodes, cause in moves:
        if by > SMALLEST_REPORTED_MOVE * compression:
            yield (
                f"{lead}: {count} {nodes} of the contact line were put on the {surface}, "
                f"by up to {_distance_in_words(by, compression)}: {cause}"
            )
    off = shoe.off(xy, radius)
    _check_smooth(off, compression, lead, surface)
    most = float(np.abs(off).max())
    if most > SMALLEST_REPORTED_MOVE * compression:
        yield (
            f"{lead}: the contact line lies up to {_distance_in_words(most, compression)} off the "
            f"{surface}; this counts as the lining's shape, a gap"
        )


def mean_compression(shoe: Shoe, response: ShoeResponse) -> float:
    """The lining's mean compression p t/E [m] under the mean pressure over its whole length."""
    theta, pressure = response.theta, response.pressure
    length = float(theta[-1] - theta[0])
    mean = float(np.sum((pressure[1:] + pressure[:-1]) / 2 * np.diff(theta))) / length
    return mean * shoe.lining.thickness / shoe.lining.material.E_through


def _distance_in_words(distance: float, compression: float) -> str:
    """A distance [m] in words, beside the lining's mean compression [m]."""
    ratio = f"{distance / compression:.2g}"
    return f"{distance * 1e6:.3g} um ({ratio} of the lining's mean compression p t/E)"


def _check_smooth(off: Floats, compression: float, lead: str, surface: str) -> None:
    """Refuse a contact line whose offsets (n,) [m] are no shape of a lining."""
    turns, high = (
        count_turns_of_offsets(off, ZIGZAG * compression),
        count_turns_of_offsets(off, compression / 2),
    )
    unresolved = turns > FEW_TURNS and len(off) < NODES_PER_TURN * turns
    if unresolved or high > MOST_TURNS:
        raise BadInput(
            f"{lead}: the contact line goes off the {surface} and back {turns} times on "
            f"{len(off)} nodes, by up to "
            f"{_distance_in_words(float(np.abs(off).max()), compression)}: "
            f"a zigzag or a polygon is no lining; put its nodes on the {surface}, "
            "write more digits, or curve its sides"
        )


def count_turns_of_offsets(off: Floats, height: float) -> int:
    """How often a line of offsets (n,) turns after it went up or down by more than `height`."""
    turns, direction = 0, 0
    # The last extreme is the highest value while the line rises, the lowest while it falls.
    extreme = float(off[0])
    for value in off.tolist():
        if direction * (value - extreme) > 0:
            extreme = value
        elif abs(value - extreme) > height:
            turns += direction != 0
            direction = 1 if value > extreme else -1
            extreme = value
    return turns
