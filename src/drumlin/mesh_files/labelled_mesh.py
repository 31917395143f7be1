"""A mesh whose nodes and elements have labels in their file, collected entry by entry.

A label is the number that a file gives a node or an element. Labels may have gaps, and a file may
use a label before the entry that defines it.
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.mesh_files.content_of_file import CellNumbersByGroupAndType, MeshFileContent

MOST_MEMBERS_OF_GROUP_RANGES = 2_000_000
"""Largest number of labels in a range of a group, such as 1 THRU 500; a larger one is refused.

A range is short as text, and its labels could fill the memory.
"""


class CollectedLabelledMesh:
    """The nodes, elements and groups of a mesh file, collected by their labels."""

    def __init__(self) -> None:
        self.points: dict[int, Sequence[float]] = {}
        self._types: dict[int, str | None] = {}
        self._nodes: dict[int, list[int]] = {}
        self._element_groups: dict[str, list[int]] = defaultdict(list)
        self._node_groups: dict[str, list[int]] = defaultdict(list)

    def add_labelled_node(self, label: int, xyz: Sequence[float]) -> None:
        """Add a node. ValueError is raised for a label that is not positive or defined twice."""
        if label < 1:
            raise ValueError(f"node {label}: a label must be positive")
        if label in self.points:
            raise ValueError(f"node {label} is defined twice")
        self.points[label] = xyz

    def add_labelled_element(self, label: int, cell: str | None, nodes: list[int]) -> None:
        """Add an element of meshio's type `cell` with the labels of its nodes.

        The nodes stand in meshio's order. The type None stands for an element that is no part of a
        plane mesh, such as a spring; groups may have it as a member. ValueError is raised for a
        label that is defined twice.
        """
        if label in self._types:
            raise ValueError(f"element {label} is defined twice")
        self._types[label], self._nodes[label] = cell, nodes

    def add_element_group_members(self, name: str, labels: list[int]) -> None:
        """Add elements to the group `name`, which becomes lower case."""
        if labels:
            self._element_groups[name.lower()].extend(labels)

    def add_node_group_members(self, name: str, labels: list[int]) -> None:
        """Add nodes to the group `name`, which becomes lower case."""
        if labels:
            self._node_groups[name.lower()].extend(labels)

    def content_with_nodes_cells_and_groups(
        self, *, rounding: Floats | None, turned: bool = False, notes: tuple[str, ...] = ()
    ) -> MeshFileContent:
        """The content of the file; the other parameters are those of `MeshFileContent`.

        ValueError is raised for an element with a node that the file does not define.
        """
        number = {label: i for i, label in enumerate(self.points)}
        cells, places = self._cells_and_place_of_each_element(number)
        broken: dict[str, str] = {}
        element_groups: dict[str, dict[str, Ints]] = {}
        for name, labels in self._element_groups.items():
            unknown = [label for label in labels if label not in self._types]
            if unknown:
                broken[name] = f"names the element {unknown[0]}, which the file does not define"
            element_groups[name] = _cell_numbers_by_cell_type(labels, places)
        node_groups: dict[str, Ints] = {}
        for name, labels in self._node_groups.items():
            unknown = [label for label in labels if label not in number]
            if unknown:
                broken[name] = f"names the node {unknown[0]}, which the file does not define"
            known = [number[label] for label in labels if label in number]
            node_groups[name] = np.unique(np.array(known, dtype=np.int64))
        return MeshFileContent(
            points=np.array(list(self.points.values()), dtype=float).reshape(-1, 3),
            cells=cells,
            cell_groups=_groups_with_members(element_groups),
            node_groups=node_groups,
            rounding=rounding,
            turned=turned,
            broken=broken,
            notes=notes,
        )

    def _cells_and_place_of_each_element(
        self, number: Mapping[int, int]
    ) -> tuple[dict[str, Ints], dict[int, tuple[str, int]]]:
        """The cells (m, k) of each type, and the type and row of the cell of each element.

        `number` is the index of each node by its label. ValueError is raised for an element with a
        node that the file does not define.
        """
        rows: dict[str, list[list[int]]] = defaultdict(list)
        places: dict[int, tuple[str, int]] = {}
        for label, cell in self._types.items():
            if cell is None:
                continue
            unknown = [node for node in self._nodes[label] if node not in number]
            if unknown:
                raise ValueError(
                    f"element {label} has the node {unknown[0]}, which the file does not define"
                )
            places[label] = (cell, len(rows[cell]))
            rows[cell].append([number[node] for node in self._nodes[label]])
        return {cell: np.array(found, dtype=np.int64) for cell, found in rows.items()}, places


def _cell_numbers_by_cell_type(
    labels: Iterable[int], places: Mapping[int, tuple[str, int]]
) -> dict[str, Ints]:
    """The cells of the elements with some labels: type of cell -> rows of the cells.

    Labels without a cell are left out. `places` has the type and row of the cell of each label.
    """
    rows: dict[str, list[int]] = defaultdict(list)
    for label in labels:
        if label in places:
            cell, row = places[label]
            rows[cell].append(row)
    return {cell: np.array(found, dtype=np.int64) for cell, found in rows.items()}


def _groups_with_members(groups: CellNumbersByGroupAndType) -> CellNumbersByGroupAndType:
    """The groups of elements that have cells; groups of springs, for example, have none."""
    return {name: cells for name, cells in groups.items() if cells}


def labels_from_first_to_last(first: int, last: int) -> range:
    """The labels of a range. ValueError is raised for a range that is too long or runs backwards.

    The longest range has MOST_MEMBERS_OF_GROUP_RANGES labels.
    """
    if last < first:
        raise ValueError(f"has the range {first} THRU {last}, whose end is before its start")
    if last - first >= MOST_MEMBERS_OF_GROUP_RANGES:
        raise ValueError(
            f"has the range {first} THRU {last}, of more than {MOST_MEMBERS_OF_GROUP_RANGES} labels"
        )
    return range(first, last + 1)
