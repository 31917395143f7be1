"""The reader of mesh files in Gmsh's text formats 4.0 and 4.1, with all physical groups.

An entity is a point, curve, surface or volume of Gmsh's geometry. meshio cannot read text files of
format 4.0, nor files of format 4.1 in which some entities have no physical group. Gmsh writes such
entities with its option Mesh.SaveAll.
"""

from collections import defaultdict
from collections.abc import Iterator
from itertools import islice

import numpy as np

from drumlin.base.arrays import Ints
from drumlin.mesh_files.content_of_file import MeshFileContent

CELL_NAME_AND_NODE_COUNT_OF_GMSH_TYPE = {
    1: ("line", 2),
    2: ("triangle", 3),
    3: ("quad", 4),
    8: ("line3", 3),
    9: ("triangle6", 6),
    10: ("quad9", 9),
    15: ("vertex", 1),
    16: ("quad8", 8),
    21: ("triangle10", 10),
    26: ("line4", 4),
    36: ("quad16", 16),
}
"""The name in meshio and the number of nodes of each of Gmsh's element types that are read.

A file with an element of another type is refused.
"""

DimensionAndTagOfGmshEntity = tuple[int, int]
"""The dimension (0 to 3) and the tag of a point, curve, surface or volume of Gmsh's geometry."""


def is_text_in_gmsh_format_4(data: bytes) -> bool:
    """Whether a file is text in Gmsh's format 4.0 or 4.1."""
    words = data[:256].split()[:3]
    return (
        len(words) == 3 and words[0] == b"$MeshFormat" and words[1][:1] == b"4" and words[2] == b"0"
    )


def read_mesh_in_gmsh_format_4(text: str) -> MeshFileContent:
    """Read the mesh in the text of an .msh file of format 4.0 or 4.1.

    Each physical group can be found by its name, in lower case, and by its number. ValueError is
    raised for a text that cannot be read.
    """
    blocks = _lines_of_each_named_block(text)
    old = blocks["MeshFormat"][0].startswith(("4 ", "4.0"))
    names = _read_names_of_physical_groups(blocks.get("PhysicalNames", []))
    groups = _read_physical_groups_of_entities(blocks.get("Entities", []), old)
    number, points = _read_node_numbers_and_points(blocks["Nodes"], old)
    tags_in_order, index = _sorted_node_tags_with_indices(number)
    rows: dict[str, list[Ints]] = defaultdict(list)
    found_cells: dict[str, int] = defaultdict(int)
    members: dict[str, dict[str, list[int]]] = defaultdict(lambda: defaultdict(list))
    for entity, kind, lines in _read_elements_of_each_entity(blocks["Elements"], old):
        if kind not in CELL_NAME_AND_NODE_COUNT_OF_GMSH_TYPE:
            raise ValueError(f"has elements of Gmsh's type {kind}, which make no plane mesh")
        cell, count = CELL_NAME_AND_NODE_COUNT_OF_GMSH_TYPE[kind]
        if lines.shape[1] <= count:
            raise ValueError(f"$Elements has a {cell} with fewer than {count} nodes")
        start = found_cells[cell]
        found_cells[cell] += len(lines)
        rows[cell].append(_indices_of_nodes(lines[:, 1 : count + 1], tags_in_order, index))
        for tag in groups.get(entity, ()):
            for name in {str(tag), names.get((entity[0], tag), str(tag))}:
                members[name][cell] += range(start, start + len(lines))
    return MeshFileContent(
        points=np.array(points, dtype=float).reshape(-1, 3),
        cells={cell: np.concatenate(found) for cell, found in rows.items()},
        cell_groups={
            name: {cell: np.array(found, dtype=np.int64) for cell, found in by_cell.items()}
            for name, by_cell in members.items()
        },
    )


def _lines_of_each_named_block(text: str) -> dict[str, list[str]]:
    """The lines of each block $Name ... $EndName of an .msh file, by the block's name.

    ValueError is raised if a block that every mesh needs is missing.
    """
    found: dict[str, list[str]] = {}
    name = ""
    for raw in text.splitlines():
        line = raw.strip()
        if line[:1] != "$":
            if name and line:
                found[name].append(line)
        elif line.startswith("$End"):
            name = ""
        else:
            name = line[1:]
            found[name] = []
    missing = [name for name in ("MeshFormat", "Nodes", "Elements") if not found.get(name)]
    if missing:
        raise ValueError(f"has no ${missing[0]}")
    return found


def _read_names_of_physical_groups(lines: list[str]) -> dict[DimensionAndTagOfGmshEntity, str]:
    """The names of the physical groups, in lower case, by their dimension and tag.

    `lines` are the lines of the block $PhysicalNames.
    """
    found = {}
    for line in lines[1:]:
        dim, tag, name = line.split(maxsplit=2)
        found[int(dim), int(tag)] = name.strip('"').lower()
    return found


def _read_physical_groups_of_entities(
    lines: list[str], old: bool
) -> dict[DimensionAndTagOfGmshEntity, list[int]]:
    """The tags of the physical groups that each entity belongs to.

    `lines` are the lines of the block $Entities, and `old` tells whether the file has format 4.0.
    """
    found: dict[DimensionAndTagOfGmshEntity, list[int]] = {}
    if not lines:
        return found
    rest = iter(lines[1:])
    for dim, count in enumerate(lines[0].split()):
        # A line has the entity's tag, coordinates, the number of groups and their tags. A point has
        # three coordinates in format 4.1. In all other cases a line has six coordinates: the lowest
        # and the highest x, y, z of the entity.
        start = 4 if dim == 0 and not old else 7
        for _ in range(int(count)):
            words = _next_lines_of_block(rest, 1, "$Entities")[0].split()
            tags = words[start + 1 : start + 1 + int(words[start])]
            # The sign of a tag only tells the direction of the entity in its group.
            found[dim, int(words[0])] = [abs(int(tag)) for tag in tags]
    return found


def _read_node_numbers_and_points(
    lines: list[str], old: bool
) -> tuple[dict[int, int], list[list[float]]]:
    """The index of each node by its tag (its label in the file), and the points [x, y, z].

    `lines` are the lines of the block $Nodes, and `old` tells whether the file has format 4.0.
    """
    number: dict[int, int] = {}
    points: list[list[float]] = []
    rest = iter(lines[1:])
    for _ in range(int(lines[0].split()[0])):
        count = int(_next_lines_of_block(rest, 1, "$Nodes")[0].split()[3])
        # Format 4.1 lists the tags of all nodes of an entity first. Format 4.0 has the tag of each
        # node on the line of its point.
        tags = [] if old else _next_lines_of_block(rest, count, "$Nodes")
        for i, line in enumerate(_next_lines_of_block(rest, count, "$Nodes")):
            words = line.split()
            tag = int(words.pop(0) if old else tags[i])
            if tag in number:
                raise ValueError(f"node {tag} is defined twice")
            number[tag] = len(points)
            points.append([float(word) for word in words[:3]])
    return number, points


def _sorted_node_tags_with_indices(number: dict[int, int]) -> tuple[Ints, Ints]:
    """The tags of all nodes, sorted, and the index of the node of each tag."""
    tags = np.fromiter(number, dtype=np.int64, count=len(number))
    order = np.argsort(tags)
    indices = np.fromiter(number.values(), dtype=np.int64, count=len(number))
    return tags[order], indices[order]


def _indices_of_nodes(tags: Ints, tags_in_order: Ints, index: Ints) -> Ints:
    """The indices of the nodes with the given tags; ValueError for a tag without a node.

    `tags_in_order` and `index` are those of `_sorted_node_tags_with_indices`.
    """
    if not len(tags_in_order):
        raise ValueError("$Nodes has no nodes")
    place = np.minimum(np.searchsorted(tags_in_order, tags), len(tags_in_order) - 1)
    unknown = tags_in_order[place] != tags
    if unknown.any():
        raise ValueError(
            f"$Elements has the node {tags[unknown][0]}, which the file does not define"
        )
    return np.asarray(index[place])


def _read_elements_of_each_entity(
    lines: list[str], old: bool
) -> Iterator[tuple[DimensionAndTagOfGmshEntity, int, Ints]]:
    """Yield the elements of each entity: the entity, Gmsh's element type, and rows of numbers.

    A row has the tag of an element and the tags of its nodes. `lines` are the lines of the block
    $Elements, and `old` tells whether the file has format 4.0.
    """
    rest = iter(lines[1:])
    for _ in range(int(lines[0].split()[0])):
        (line,) = _next_lines_of_block(rest, 1, "$Elements")
        first, second, kind, count = map(int, line.split())
        rows = _next_lines_of_block(rest, count, "$Elements")
        if not rows:
            continue
        try:
            found = np.loadtxt(rows, dtype=np.int64, comments=None, ndmin=2)
        except ValueError as error:
            raise ValueError(
                "$Elements has a line with a wrong number of numbers, or with a word that is no "
                "whole number"
            ) from error
        yield ((second, first) if old else (first, second)), kind, found


def _next_lines_of_block(lines: Iterator[str], count: int, block: str) -> list[str]:
    """The next `count` lines of a block in an .msh file.

    ValueError is raised if the block has fewer lines.
    """
    found = list(islice(lines, count))
    if len(found) < count:
        raise ValueError(f"{block} has fewer lines than it says")
    return found
