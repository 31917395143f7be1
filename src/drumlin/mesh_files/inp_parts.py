"""The parts of an Abaqus or CalculiX input file (deck), and their instances in an assembly.

An instance is a part that is translated and rotated to its place in the assembly.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from drumlin.base.arrays import Floats


class DeckSetMember(NamedTuple):
    """An entry of a set of nodes or elements in an Abaqus deck.

    Attributes
    ----------
    owner : name of the instance that the labels belong to; "" for the instance of the set itself
    word : range of labels, or one label or the name of another set as a text
    """

    owner: str
    word: range | str


@dataclass
class DeckElementBlock:
    """The elements of one *ELEMENT section of an Abaqus deck.

    Attributes
    ----------
    kind : type of the elements as the deck writes it
    elements : label of each element -> labels of its nodes
    """

    kind: str
    elements: dict[int, list[int]]


@dataclass
class DeckPart:
    """The nodes, elements, sets and surfaces of a part of an Abaqus deck.

    The part is a *PART, the assembly, or a deck without parts.

    Parameters
    ----------
    name : name of the part; empty for a deck without parts
    nodes : label of each node -> x, y, z in the file's unit
    coordinates_as_written : label of each node -> its first two coordinates as the deck has them,
        before any conversion; they show how the deck's coordinates were rounded
    turned : whether a *SYSTEM section or cylindrical coordinates rotate the coordinates of nodes
    blocks : elements of each *ELEMENT section
    labels : labels of all elements
    node_sets, element_sets : members of each set, by the set's name
    surfaces : type and data lines of each *SURFACE, by the surface's name
    refused : reason why a set or a surface cannot be read, by the name of the set or surface
    """

    name: str = ""
    nodes: dict[int, list[float]] = field(default_factory=dict)
    coordinates_as_written: dict[int, list[float]] = field(default_factory=dict)
    turned: bool = False
    blocks: list[DeckElementBlock] = field(default_factory=list)
    labels: set[int] = field(default_factory=set)
    node_sets: dict[str, list[DeckSetMember]] = field(default_factory=dict)
    element_sets: dict[str, list[DeckSetMember]] = field(default_factory=dict)
    surfaces: dict[str, tuple[str, list[list[str]]]] = field(default_factory=dict)
    refused: dict[str, str] = field(default_factory=dict)

    def names_of_surfaces(self, *, of_nodes: bool) -> list[str]:
        """The names of all surfaces of nodes, or of all other surfaces."""
        return [name for name, (kind, _) in self.surfaces.items() if (kind == "NODE") == of_nodes]

    def add_labelled_node_to_part(
        self, label: int, xyz: Sequence[float], coordinates_as_written: list[float]
    ) -> None:
        """Add a node. ValueError is raised if another node has the same label."""
        if label in self.nodes:
            raise ValueError(f"node {label} is defined twice")
        self.nodes[label] = [*xyz]
        self.coordinates_as_written[label] = coordinates_as_written

    def add_labelled_elements_to_part(self, kind: str, elements: dict[int, list[int]]) -> None:
        """Add elements. ValueError is raised if a label belongs to another element already."""
        taken = self.labels & elements.keys()
        if taken:
            raise ValueError(f"element {min(taken)} is defined twice")
        self.labels |= elements.keys()
        self.blocks.append(DeckElementBlock(kind, elements))


@dataclass(frozen=True)
class PlacementOfPartInAssembly:
    """The rotation and translation that place a part in the assembly of an Abaqus deck.

    The coordinates in the assembly are `turn` (3, 3) times the coordinates in the part, plus
    `shift` (3,).
    """

    turn: Floats
    shift: Floats

    def __call__(self, xyz: Floats) -> Floats:
        """The points (n, 3) in the assembly for points (n, 3) of the part."""
        return xyz @ self.turn.T + self.shift

    @property
    def has_rotation_of_part_axes(self) -> bool:
        """Whether the placement rotates the part's axes."""
        return bool(np.any(self.turn != np.eye(3)))


IDENTITY_PLACEMENT = PlacementOfPartInAssembly(np.eye(3), np.zeros(3))
"""The placement that leaves a part where it is."""


@dataclass(frozen=True)
class DeckInstance:
    """A part of an Abaqus deck in its place in the assembly."""

    name: str
    part: DeckPart
    placement: PlacementOfPartInAssembly = IDENTITY_PLACEMENT


def placement_of_instance_in_assembly(
    rows: list[list[str]], name: str
) -> PlacementOfPartInAssembly:
    """The placement of an *INSTANCE from its data lines: a translation, then a rotation.

    The first line has the translation. The second line has two points on the axis of the rotation
    and the angle in degrees. ValueError is raised for other lines.
    """
    if len(rows) > 2:
        raise ValueError(f"*INSTANCE, NAME={name} has {len(rows)} data lines; must have at most 2")
    # The first line is the translation x, y, z.
    shift = np.zeros(3)
    if rows:
        given = parse_numbers_of_data_line(rows[0], f"*INSTANCE, NAME={name}")
        if len(given) > 3:
            raise ValueError(f"*INSTANCE, NAME={name}: its first data line must be a shift x, y, z")
        shift[: len(given)] = given
    if len(rows) < 2:
        return PlacementOfPartInAssembly(np.eye(3), shift)
    given = parse_numbers_of_data_line(rows[1], f"*INSTANCE, NAME={name}")
    first, second = np.array(given[:3]), np.array(given[3:6])
    if len(given) != 7 or not np.any(second != first):
        raise ValueError(
            f"*INSTANCE, NAME={name}: its second data line must be two points and an angle"
        )
    # The translated part is rotated about the axis, which need not run through the origin.
    axis = (second - first) / np.linalg.norm(second - first)
    turn = Rotation.from_rotvec(math.radians(given[6]) * axis).as_matrix()
    return PlacementOfPartInAssembly(turn, turn @ (shift - first) + first)


def placement_of_nodes_after_system_section(rows: list[list[str]]) -> PlacementOfPartInAssembly:
    """The placement of the nodes after a *SYSTEM section, from its data lines.

    The lines have the origin of the system, a point on its x-axis, and a point in its x-y plane. An
    empty section ends the system. ValueError is raised for other lines.
    """
    if not rows:
        return IDENTITY_PLACEMENT
    given = parse_numbers_of_data_line(rows[0], "*SYSTEM")
    origin, along = np.array(given[:3]), np.array(given[3:6])
    if len(given) == 3:
        return PlacementOfPartInAssembly(np.eye(3), origin)
    third = parse_numbers_of_data_line(rows[1], "*SYSTEM") if len(rows) == 2 else [0.0, 0.0, 1.0]
    if len(given) != 6 or len(rows) > 2 or len(third) not in (2, 3):
        raise ValueError("*SYSTEM needs an origin, a point on its x-axis and one in its x-y plane")
    # The system's axes are x, the cross product of the normal and x, and the x-y plane's normal.
    beside = np.array([*third, 0.0][:3]) - origin
    x = along - origin
    normal = np.cross(x, beside) if len(rows) == 2 else np.array([0.0, 0.0, 1.0])
    if not np.any(x) or not np.any(normal):
        raise ValueError("*SYSTEM: its three points must not lie on one line")
    x, normal = x / np.linalg.norm(x), normal / np.linalg.norm(normal)
    return PlacementOfPartInAssembly(np.column_stack([x, np.cross(normal, x), normal]), origin)


def parse_numbers_of_data_line(words: list[str], where: str) -> list[float]:
    """The numbers in the words of a data line; Fortran's exponents, as in 1.5D-3, are read too.

    ValueError is raised for a word that is no number; its message begins with `where`, the name of
    the section.
    """
    found = []
    for word in words:
        try:
            found.append(float(word.upper().replace("D", "E")))
        except ValueError:
            raise ValueError(f"{where}: {word!r} is not a number") from None
    return found


def parse_node_or_element_label(word: str, where: str) -> int:
    """Convert a word of an Abaqus deck to the label of a node or an element, a whole number.

    ValueError is raised for another word; its message begins with the section `where`.
    """
    try:
        return int(word)
    except ValueError:
        raise ValueError(f"{where}: {word!r} is not a label") from None
