"""The coordinate systems of a Nastran bulk data file, in which its grid points have coordinates."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.mesh_files.nastran_cards import NastranBulkCard

CARDS_OF_COORDINATE_SYSTEMS = ("CORD1R", "CORD1C", "CORD2R", "CORD2C")
"""Cards of the coordinate systems that are read: R is rectangular, and C cylindrical.

The origin, a point on z and a point in the plane xz are grid points (1) or coordinates (2).
"""


class PlacedNastranSystem(NamedTuple):
    """A coordinate system in the basic system of a Nastran file.

    Attributes
    ----------
    origin : (3,) its origin
    axes : (3, 3) its unit vectors x, y, z as rows
    is_cylindrical : whether its coordinates are radius, angle in degrees, and z
    """

    origin: Floats
    axes: Floats
    is_cylindrical: bool

    def point_in_basic_system(self, xyz: Floats) -> Floats:
        """The point (3,) in the basic system with given coordinates (3,) in this system."""
        if self.is_cylindrical:
            radius, angle = xyz[0], np.radians(xyz[1])
            xyz = np.array([radius * np.cos(angle), radius * np.sin(angle), xyz[2]])
        return np.asarray(self.origin + xyz @ self.axes)


BASIC_NASTRAN_SYSTEM = PlacedNastranSystem(np.zeros(3), np.eye(3), is_cylindrical=False)
"""The system 0, in which the coordinates of all other systems end."""


def systems_of_cards(cards: list[NastranBulkCard]) -> dict[int, NastranBulkCard]:
    """The card of each coordinate system, by the system's number.

    A card CORD1R or CORD1C may define two systems, which become two cards. ValueError is raised for
    a number that is used twice.
    """
    found: dict[int, NastranBulkCard] = {}
    for card in cards:
        parts = [card]
        if card.name.startswith("CORD1"):
            halves = [card.fields[:4], card.fields[4:8]]
            parts = [NastranBulkCard(card.name, half) for half in halves if any(half)]
        for part in parts:
            number = part.integer_of_field(0)
            if number in found:
                raise ValueError(f"{part.words_of_card()}: the system is defined twice")
            found[number] = part
    return found


def place_system_in_basic_system(
    number: int,
    cards: Mapping[int, NastranBulkCard],
    point_of_grid: Callable[[int, tuple[int, ...]], Floats],
    above: tuple[int, ...] = (),
) -> PlacedNastranSystem:
    """The coordinate system of a given number, placed in the basic system.

    Parameters
    ----------
    number : number of the system; 0 is the basic system
    cards : card of each system by its number
    point_of_grid : function of the label of a grid point and of `above`, which returns its
        coordinates (3,) in the basic system
    above : numbers of the systems that are defined in this one

    Raises
    ------
    ValueError
        for a system that is missing, of another kind, without directions, or defined in itself
    """
    if number == 0:
        return BASIC_NASTRAN_SYSTEM
    if number not in cards:
        raise ValueError(f"the coordinate system {number} is not defined")
    card = cards[number]
    where = card.words_of_card()
    if card.name not in CARDS_OF_COORDINATE_SYSTEMS:
        raise ValueError(
            f"{where} is not read; allowed: {', '.join(CARDS_OF_COORDINATE_SYSTEMS)}, "
            "or write the grid points in the basic system"
        )
    if number in above:
        raise ValueError(f"{where}: the system is defined in itself")
    above = (*above, number)
    if card.name.startswith("CORD1"):
        points = [point_of_grid(card.integer_of_field(i), above) for i in (1, 2, 3)]
    else:
        outer = place_system_in_basic_system(
            card.integer_of_field(1, default=0), cards, point_of_grid, above
        )
        rows = np.array([card.real_of_field(i) for i in range(2, 11)]).reshape(3, 3)
        points = [outer.point_in_basic_system(row) for row in rows]
    return _system_from_three_points(points, where, is_cylindrical=card.name.endswith("C"))


def _system_from_three_points(
    points: list[Floats], where: str, *, is_cylindrical: bool
) -> PlacedNastranSystem:
    """The system with its origin in the first of three points (3,), and z towards the second one.

    The third point lies in the plane xz. ValueError is raised for three points on one line; its
    message begins with `where`.
    """
    origin, on_z, in_xz = points
    z, x = on_z - origin, in_xz - origin
    y = np.cross(z, x)
    lengths = np.linalg.norm(z), np.linalg.norm(y)
    if not min(lengths) > np.finfo(float).eps * np.linalg.norm(z) * np.linalg.norm(x):
        raise ValueError(f"{where}: its three points lie on one line")
    z, y = z / lengths[0], y / lengths[1]
    return PlacedNastranSystem(origin, np.array([np.cross(y, z), y, z]), is_cylindrical)
