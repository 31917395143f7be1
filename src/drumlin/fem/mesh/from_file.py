"""A shoe's mesh from a file, what was done to it, and what an answer says about that."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Shoe
from drumlin.response.response import ShoeResponse

SAID_MOVE = 1e-3
"""Distance of a node that was moved, or of the contact line from the surface, in mean compressions
p t/E of the lining, from which on a note says it. It changes the pressure by about as much."""
ZIGZAG = 0.2
"""Height, in mean compressions p t/E, from which on the contact line's ups and downs count as turns.
A zigzag of this height makes the pressure go up and down by a tenth of its mean."""
FEW_TURNS = 5
"""Turns of the contact line that any lining may have: flats, steps, a groove, a worn end."""
NODES_PER_TURN = 8
"""Nodes from one turn to the next that a mesh has at least where it resolves the lining's shape.
Fewer, more than FEW_TURNS times, are the mesh's own: a zigzag, or straight sides that were split."""
MOST_TURNS = 12
"""Turns, of half a compression and more, beyond which even a resolved line is a polygon."""


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


def mesh_notes(
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
        if by > SAID_MOVE * compression:
            yield (
                f"{lead}: {count} {nodes} of the contact line were put on the {surface}, "
                f"by up to {_size(by, compression)}: {cause}"
            )
    off = shoe.off(xy, radius)
    _check_smooth(off, compression, lead, surface)
    most = float(np.abs(off).max())
    if most > SAID_MOVE * compression:
        yield (
            f"{lead}: the contact line lies up to {_size(most, compression)} off the {surface}; "
            "this counts as the lining's shape, a gap"
        )


def mean_compression(shoe: Shoe, response: ShoeResponse) -> float:
    """The lining's mean compression p t/E [m] under the mean pressure over its whole length."""
    theta, pressure = response.theta, response.pressure
    length = float(theta[-1] - theta[0])
    mean = float(np.sum((pressure[1:] + pressure[:-1]) / 2 * np.diff(theta))) / length
    return mean * shoe.lining.thickness / shoe.lining.material.E_through


def _size(distance: float, compression: float) -> str:
    """A distance [m] in words, beside the lining's mean compression [m]."""
    ratio = f"{distance / compression:.2g}"
    return f"{distance * 1e6:.3g} um ({ratio} of the lining's mean compression p t/E)"


def _check_smooth(off: Floats, compression: float, lead: str, surface: str) -> None:
    """Refuse a contact line whose offsets (n,) [m] are no shape of a lining."""
    turns, high = turns_of(off, ZIGZAG * compression), turns_of(off, compression / 2)
    unresolved = turns > FEW_TURNS and len(off) < NODES_PER_TURN * turns
    if unresolved or high > MOST_TURNS:
        raise BadInput(
            f"{lead}: the contact line goes off the {surface} and back {turns} times on "
            f"{len(off)} nodes, by up to {_size(float(np.abs(off).max()), compression)}: a zigzag or a "
            f"polygon is no lining; put its nodes on the {surface}, write more digits, or curve its sides"
        )


def turns_of(off: Floats, height: float) -> int:
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
