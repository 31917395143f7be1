"""The reader of meshes in universal files (.unv) of I-DEAS, as Salome and Gmsh write them.

A universal file consists of datasets. A dataset has a number, which says what its lines hold, and
stands between two lines with -1.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from drumlin.mesh_files.content_of_file import MeshFileContent
from drumlin.mesh_files.labelled_mesh import CollectedLabelledMesh

NODE_DATASETS = (781, 2411)
"""Numbers of the datasets of nodes: label and systems on one line, coordinates on the next one."""
ELEMENT_DATASET = 2412
"""Number of the dataset of elements."""
GROUP_DATASETS_AND_NUMBERS_PER_MEMBER = {
    **dict.fromkeys((2417, 2429, 2430, 2432), 2),
    **dict.fromkeys((2435, 2452, 2467, 2477), 4),
}
"""Numbers of the datasets of groups, and how many whole numbers each of a group's members has.

The first number is the type of the member, 7 for a node and 8 for an element. The second number is
its label.
"""
SYSTEM_DATASETS = (18, 2420)
"""Numbers of the datasets of coordinate systems."""
UNITS_DATASET = 164
"""Number of the dataset of units."""
REFUSED_UNV_DATASETS = {15: "nodes", 71: "elements", 780: "elements", 2413: "elements"}
"""Numbers of old datasets with parts of a mesh, which are refused, and what they hold."""
LINE_FE_DESCRIPTORS = (11, 21, 22, 23, 24)
"""Numbers of the types of rods and beams in a universal file."""
PLANE_FE_DESCRIPTOR_TENS = {4: "", 5: "plane strain", 6: "", 7: "", 9: ""}
"""The tens of the types of plane elements, and what a note says of them.

They are plane stress, plane strain, plates, membranes and thin shells.
"""
AXISYMMETRIC_FE_DESCRIPTOR_TENS = 8
"""The tens of the types of axisymmetric elements."""
LAST_SHELL_FE_DESCRIPTOR = 99
"""The largest type of a thin shell; larger types are solids, rigid elements, springs and masses."""
FIRST_SPRING_FE_DESCRIPTOR = 121
"""The smallest type of rigid elements, springs, dampers, masses and gaps.

Such elements are no part of the mesh. The types below are solids.
"""
CELL_AND_ORDER_OF_UNV_NODES = {
    3: ("triangle", (0, 1, 2)),
    4: ("quad", (0, 1, 2, 3)),
    6: ("triangle6", (0, 2, 4, 1, 3, 5)),
    8: ("quad8", (0, 2, 4, 6, 1, 3, 5, 7)),
}
"""meshio's cell for each number of nodes of a plane element, and the order of meshio's nodes.

A universal file goes round the element: corner, middle of a side, next corner. meshio has the
corners first.
"""
NODES_OF_ROD = 2
"""Number of nodes of a linear rod or beam."""
NODES_PER_UNV_LINE = 8
"""Number of labels of nodes on a line of a universal file."""
UNV_NODE_TYPE = 7
"""Type of the members of a group that are nodes."""
UNV_ELEMENT_TYPE = 8
"""Type of the members of a group that are elements."""


def read_mesh_in_universal_file(text: str) -> MeshFileContent:
    """Read the mesh in the text of a universal file.

    A group can be found by its name and its number. The elements with the physical property 3 are
    the group "property=3", and those with the material 3 the group "material=3".

    Raises
    ------
    ValueError
        with a line that says what cannot be read
    """
    mesh = CollectedLabelledMesh()
    notes: dict[str, None] = {}
    datasets = list(_datasets_of_universal_file(text))
    systems = _systems_that_are_not_global(datasets)
    for number, lines in datasets:
        if number in REFUSED_UNV_DATASETS:
            raise ValueError(
                f"dataset {number} has {REFUSED_UNV_DATASETS[number]} in an old form; write nodes "
                "in dataset 2411 and elements in dataset 2412"
            )
        if number in NODE_DATASETS:
            _add_nodes_of_dataset(mesh, lines, number, systems)
        elif number == ELEMENT_DATASET:
            _add_elements_of_dataset(mesh, lines, notes)
        elif number in GROUP_DATASETS_AND_NUMBERS_PER_MEMBER:
            _add_groups_of_dataset(mesh, lines, number)
        elif number == UNITS_DATASET:
            notes |= dict.fromkeys(_notes_on_units(lines))
    if not mesh.points:
        raise ValueError("has no nodes in a dataset 2411: it is no universal file with a mesh")
    return mesh.content_with_nodes_cells_and_groups(rounding=None, notes=tuple(notes))


def _datasets_of_universal_file(text: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the number and the lines of each dataset.

    ValueError is raised for a dataset that does not end, which shows that the file was cut off.
    """
    begun: list[str] | None = None
    for line in text.splitlines():
        if line.strip() != "-1":
            if begun is not None:
                begun.append(line)
        elif begun is None:
            begun = []
        else:
            if not begun or not begun[0].split():
                raise ValueError("has a dataset without a number")
            # A letter b after the number 58 marks a binary dataset of measurements.
            yield (
                _whole_numbers_of_words(begun[0].rstrip("bB ").split()[:1], "a dataset")[0],
                begun[1:],
            )
            begun = None
    if begun:
        raise ValueError(f"dataset {begun[0].strip()} does not end with -1: the file was cut off")


def _whole_numbers_of_words(words: Sequence[str], where: str) -> list[int]:
    """The whole numbers in words of a line; ValueError for a word that is none."""
    try:
        return [int(word) for word in words]
    except ValueError as error:
        raise ValueError(f"{where} has a word that is no whole number: {words}") from error


class _LinesOfDataset:
    """The lines of a dataset, read one after the other."""

    def __init__(self, lines: list[str], number: int) -> None:
        self._lines, self._next, self.where = lines, 0, f"dataset {number}"

    @property
    def has_more(self) -> bool:
        """Whether lines are left that are not empty."""
        while self._next < len(self._lines) and not self._lines[self._next].strip():
            self._next += 1
        return self._next < len(self._lines)

    def next_line(self) -> str:
        """The next line; ValueError if there is none."""
        if self._next >= len(self._lines):
            raise ValueError(f"{self.where} ends in the middle of an entry")
        self._next += 1
        return self._lines[self._next - 1]

    def next_whole_numbers(self, count: int) -> list[int]:
        """The first `count` whole numbers of the next line; ValueError for fewer ones."""
        words = self.next_line().split()
        if len(words) < count:
            raise ValueError(f"{self.where} has {len(words)} numbers on a line in place of {count}")
        return _whole_numbers_of_words(words[:count], self.where)

    def next_labels(self, count: int) -> list[int]:
        """The next `count` labels, eight on a line; ValueError for another number of labels."""
        labels: list[int] = []
        while len(labels) < count:
            wanted = min(NODES_PER_UNV_LINE, count - len(labels))
            words = self.next_line().split()
            if len(words) != wanted:
                raise ValueError(
                    f"{self.where} has {len(words)} numbers on a line in place of {wanted}"
                )
            labels += _whole_numbers_of_words(words, self.where)
        return labels


class LabelAndTypeOfUnvElement(NamedTuple):
    """The first line of an element in a universal file.

    Attributes
    ----------
    label : label of the element
    descriptor : number of the element's type
    physical, material : numbers of its tables of physical and material properties
    number_of_nodes : number of its nodes
    """

    label: int
    descriptor: int
    physical: int
    material: int
    number_of_nodes: int


def _systems_that_are_not_global(datasets: list[tuple[int, list[str]]]) -> dict[int, str]:
    """The coordinate systems of a universal file that differ from the global one, by number.

    The value is what a message says of the system.
    """
    found: dict[int, str] = {}
    for number, lines in datasets:
        if number == 18:
            # Each system takes a line of whole numbers, a name, and two lines of coordinates.
            found |= {
                _whole_numbers_of_words(line.split()[:1], "dataset 18")[0]: "dataset 18"
                for line in lines[::4]
            }
        elif number in SYSTEM_DATASETS:
            rest = _LinesOfDataset(lines, number)
            rest.next_line()
            rest.next_line()
            while rest.has_more:
                label, kind, _ = rest.next_whole_numbers(3)
                rest.next_line()
                rows = [_reals_of_line(rest.next_line(), rest.where) for _ in range(4)]
                identity = np.vstack([np.eye(3), np.zeros(3)])
                if kind != 0 or not np.array_equal(np.array(rows), identity):
                    found[label] = rest.where
    return found


def _reals_of_line(line: str, where: str) -> list[float]:
    """The three numbers of a line, whose exponents may follow a D; ValueError for others."""
    words = line.upper().replace("D", "E").split()
    try:
        x, y, z = map(float, words)
    except ValueError as error:
        raise ValueError(f"{where} needs three numbers in place of {line.strip()!r}") from error
    return [x, y, z]


def _add_nodes_of_dataset(
    mesh: CollectedLabelledMesh, lines: list[str], number: int, systems: dict[int, str]
) -> None:
    """Add the nodes of a dataset to a mesh.

    ValueError is raised for a node in one of the `systems` that are not the global system.
    """
    rest = _LinesOfDataset(lines, number)
    while rest.has_more:
        label, system = rest.next_whole_numbers(2)
        if system in systems:
            raise ValueError(
                f"node {label} lies in the coordinate system {system} ({systems[system]}), which "
                "is not the global one; write the nodes in the global system"
            )
        mesh.add_labelled_node(label, _reals_of_line(rest.next_line(), rest.where))


def _add_elements_of_dataset(
    mesh: CollectedLabelledMesh, lines: list[str], notes: dict[str, None]
) -> None:
    """Add the elements of a dataset 2412 to a mesh, with groups by property and material.

    A note on plane strain is added to `notes`.
    """
    rest = _LinesOfDataset(lines, ELEMENT_DATASET)
    while rest.has_more:
        label, descriptor, physical, material, _, count = rest.next_whole_numbers(6)
        element = LabelAndTypeOfUnvElement(label, descriptor, physical, material, count)
        cell, nodes = _cell_and_nodes_of_unv_element(element, rest)
        mesh.add_labelled_element(label, cell, nodes)
        mesh.add_element_group_members(f"property={physical}", [label])
        mesh.add_element_group_members(f"material={material}", [label])
        if cell and PLANE_FE_DESCRIPTOR_TENS.get(descriptor // 10):
            notes["its elements are plane strain; they are solved in plane stress"] = None


def _cell_and_nodes_of_unv_element(
    element: LabelAndTypeOfUnvElement, rest: _LinesOfDataset
) -> tuple[str | None, list[int]]:
    """meshio's name of an element's cell, and the labels of its nodes in meshio's order.

    The name is None for springs and masses. `rest` are the lines after the element's first line.
    ValueError is raised for elements that are not plane.
    """
    count, descriptor = element.number_of_nodes, element.descriptor
    if not 1 <= count <= 100:
        raise ValueError(f"element {element.label} has {count} nodes")
    if descriptor in LINE_FE_DESCRIPTORS:
        # The line before the nodes of a beam has three numbers on the orientation of its section.
        # Some programs leave it out for rods, which have two nodes.
        words = rest.next_line().split()
        is_rod = len(words) == count == NODES_OF_ROD
        nodes = _whole_numbers_of_words(words, rest.where) if is_rod else rest.next_labels(count)
        # The middle node of a parabolic beam is the second one, and the last one in meshio.
        return ("line", nodes) if count == 2 else ("line3", [nodes[0], nodes[-1], *nodes[1:-1]])
    nodes = rest.next_labels(count)
    if descriptor >= FIRST_SPRING_FE_DESCRIPTOR:
        return None, nodes
    tens = descriptor // 10
    known = CELL_AND_ORDER_OF_UNV_NODES.get(count)
    if tens not in PLANE_FE_DESCRIPTOR_TENS or known is None:
        if tens == AXISYMMETRIC_FE_DESCRIPTOR_TENS:
            reason = "axisymmetric, a ring about the axis; a shoe is plane"
        elif descriptor > LAST_SHELL_FE_DESCRIPTOR:
            reason = "solid; a mesh must be plane"
        else:
            reason = f"not read with {count} nodes; must be triangles or quadrilaterals, linear or "
            reason += "parabolic"
        raise ValueError(f"element {element.label} of type {descriptor} is {reason}")
    cell, order = known
    return cell, [nodes[i] for i in order]


def _add_groups_of_dataset(mesh: CollectedLabelledMesh, lines: list[str], number: int) -> None:
    """Add the groups of a dataset to a mesh: elements and nodes by the group's name and number."""
    rest = _LinesOfDataset(lines, number)
    width = GROUP_DATASETS_AND_NUMBERS_PER_MEMBER[number]
    while rest.has_more:
        group, *_, count = rest.next_whole_numbers(8)
        name = rest.next_line().strip()
        numbers: list[int] = []
        # Without a limit a false count would only be found at the end of the dataset.
        while len(numbers) < width * count:
            numbers += _whole_numbers_of_words(rest.next_line().split(), rest.where)
        if len(numbers) != width * count:
            raise ValueError(f"{rest.where}: the group {name} has more members than it says")
        members = list(zip(numbers[::width], numbers[1::width], strict=True))
        for alias in {name, str(group)}:
            mesh.add_element_group_members(
                alias, [label for kind, label in members if kind == UNV_ELEMENT_TYPE]
            )
            mesh.add_node_group_members(
                alias, [label for kind, label in members if kind == UNV_NODE_TYPE]
            )


def _notes_on_units(lines: list[str]) -> list[str]:
    """The note on the unit of length that a file states in dataset 164; none for metres.

    Programs often state metres for coordinates in other units, so that the unit in the brake file
    counts.
    """
    numbers = [word for line in lines[1:] for word in line.upper().replace("D", "E").split()]
    try:
        units_per_metre = float(numbers[0])
    except (IndexError, ValueError) as error:
        raise ValueError("dataset 164 has no factor for lengths") from error
    if units_per_metre == 1:
        return []
    return [
        f"the file says that a metre is {units_per_metre:g} of its units of length; the key "
        "mesh_unit counts"
    ]
