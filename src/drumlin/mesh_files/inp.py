"""The reader of meshes in Abaqus and CalculiX input files, with parts, instances and sets.

meshio's own reader knows neither quadratic plane-stress elements nor parts, and ignores keywords
that move nodes.
"""

from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Iterator
from functools import cached_property
from itertools import chain, pairwise
from pathlib import Path
from typing import NamedTuple, TypeVar

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.mesh_files.abaqus import MESHIO_CELL_OF_ABAQUS_TYPE, NODES_PER_MESHIO_CELL
from drumlin.mesh_files.content_of_file import (
    MeshFileContent,
    largest_rounding_errors_of_coordinates,
)
from drumlin.mesh_files.inp_deck import AbaqusDeck
from drumlin.mesh_files.inp_parts import DeckInstance, DeckPart
from drumlin.mesh_files.plane_cells import CORNERS_PER_PLANE_CELL, ends_of_each_side

IGNORED_ABAQUS_ELEMENT_PREFIXES = (
    *("SPRING", "DASHPOT", "MASS", "ROTARYI", "CONN", "GAP", "JOINT", "ITS", "DCOUP", "HEATCAP"),
    *("R2D", "R3D", "RAX", "RB2D", "RB3D", "DIST", "FRAME", "PIPE", "TUBE", "SLIDE"),
)
"""Beginnings of the names of Abaqus element types that are no part of a shoe's mesh.

They are springs, masses, connectors, gaps and rigid bodies. The reader ignores them.
"""

ParsedMemberTypeVariable = TypeVar("ParsedMemberTypeVariable")
NodeOrElementKey = tuple[str, int]
"""The key of a node or an element of an Abaqus deck: name of its instance, and its label there."""


class CellTypeAndRowOfElement(NamedTuple):
    """The cell of the mesh that an element of an Abaqus deck becomes.

    Attributes
    ----------
    cell : meshio's name of the type of its cell
    row : position of its cell among the cells of this type
    """

    cell: str
    row: int


def read_mesh_from_inp_text(
    text: str, folder: Path | None = None, wanted: Collection[str] = ()
) -> MeshFileContent:
    """Read the mesh in the text of an Abaqus or CalculiX input file.

    Names of groups become lower case.

    Parameters
    ----------
    text : text of the file
    folder : folder in which files that it includes are looked for
    wanted : names of the groups of elements of the shoe. If only some instances of an assembly have
        elements in these groups, the instances without such elements are ignored.

    Raises
    ------
    ValueError
        with a line that says what cannot be read
    """
    deck = AbaqusDeck(text, folder)
    return _AssembledDeckMesh(
        deck, _choose_bodies_that_make_up_shoe(deck, wanted)
    ).nodes_cells_and_groups()


def _choose_bodies_that_make_up_shoe(
    deck: AbaqusDeck, wanted: Collection[str]
) -> list[DeckInstance]:
    """The instances and parts of a deck that make up the shoe.

    These are the bodies with elements in the wanted groups, and bodies without any elements. If no
    wanted group has elements, all bodies are chosen.
    """
    # The owners are the instances that have an element in one of the wanted groups.
    bodies = [body for body in deck.bodies if body.part.nodes]
    owners = set()
    for body in deck.bodies:
        for name in wanted:
            if name in body.part.element_sets:
                owners |= _names_of_instances_in_element_set(deck, body, name)
    found = [body for body in bodies if body.name in owners or not body.part.blocks]
    return found if owners else bodies


def _names_of_instances_in_element_set(deck: AbaqusDeck, body: DeckInstance, name: str) -> set[str]:
    """The names of the instances whose elements are members of an element set of a body.

    The result is empty for a set that cannot be read.
    """
    try:
        return {owner.name for owner, _ in deck.members_of_named_set(body, "element_sets", name)}
    except ValueError:
        return set()


class _AssembledDeckMesh:
    """The mesh made of the chosen instances and parts of a deck.

    Each part of a deck numbers its own nodes and elements. The mesh numbers all of them anew.
    """

    def __init__(self, deck: AbaqusDeck, bodies: list[DeckInstance]) -> None:
        self.deck, self.bodies = deck, bodies
        self.number: dict[NodeOrElementKey, int] = {}
        self.place: dict[NodeOrElementKey, CellTypeAndRowOfElement | None] = {}
        self.cells: dict[str, list[list[int]]] = {}
        self.plane_strain: dict[str, None] = {}
        self.broken: dict[str, str] = {}
        self.points, self.rounding = self._number_all_nodes_and_return_points_and_rounding()
        for body in bodies:
            for block in body.part.blocks:
                self._add_elements_of_one_type(body, block.kind, block.elements)

    def _number_all_nodes_and_return_points_and_rounding(self) -> tuple[Floats, Floats]:
        """Give each node of all instances a number; return the nodes' points and rounding errors.

        The points (n, 3) are in their places in the assembly. The rounding errors (n, 2) are the
        largest possible ones of x and y in the file.
        """
        points, rounding = [np.zeros((0, 3))], [np.zeros((0, 2))]
        for body in self.bodies:
            part, start = body.part, len(self.number)
            for i, label in enumerate(part.nodes, start=start):
                self.number[body.name, label] = i
            if part.nodes:
                points.append(body.placement(np.array(list(part.nodes.values()))))
                rounding.append(
                    largest_rounding_errors_of_coordinates(
                        np.array(list(part.coordinates_as_written.values()))
                    )
                )
        return np.vstack(points), np.vstack(rounding)

    def _add_elements_of_one_type(
        self, body: DeckInstance, kind: str, elements: dict[int, list[int]]
    ) -> None:
        """Add the elements of one *ELEMENT section to the cells, but not springs or masses.

        `kind` is the type of the elements in Abaqus, and `elements` are the labels of the nodes of
        each element.
        """
        cell = meshio_cell_name_of_abaqus_element(kind)
        if kind.startswith("CPE"):
            self.plane_strain[kind] = None
        rows = self.cells.setdefault(cell, []) if cell else []
        for label, nodes in elements.items():
            if cell is None:
                self.place[body.name, label] = None
                continue
            if len(nodes) != NODES_PER_MESHIO_CELL[cell]:
                raise ValueError(
                    f"*ELEMENT, TYPE={kind} needs a label "
                    f"and {NODES_PER_MESHIO_CELL[cell]} nodes on each line"
                )
            self.place[body.name, label] = CellTypeAndRowOfElement(cell, len(rows))
            found = [
                self._node_number_of_label(body.name, node, f"element {label}") for node in nodes
            ]
            # Of the three nodes of a quadratic line, the middle node is the second node in Abaqus
            # and the last node in meshio.
            if cell == "line3":
                first, middle, last = found
                found = [first, last, middle]
            rows.append(found)

    def _node_number_of_label(self, owner: str, label: int, where: str) -> int:
        """The number in the mesh of the node with a label of the instance `owner`.

        ValueError is raised for a node that is not defined; its message begins with `where`.
        """
        found = self.number.get((owner, label))
        if found is None:
            raise ValueError(f"{where} has the node {label}, which the file does not define")
        return found

    def nodes_cells_and_groups(self) -> MeshFileContent:
        """The content of the deck as the reader returns it: nodes, cells, groups and notes."""
        cells = self._members_of_each_group(
            lambda part: part.element_sets,
            lambda body, name: self._keys_named_in_set(body, "element_sets", name),
        )
        nodes = self._members_of_each_group(
            lambda part: part.node_sets,
            lambda body, name: self._keys_named_in_set(body, "node_sets", name),
        )
        surfaces = self._members_of_each_group(
            lambda part: part.names_of_surfaces(of_nodes=True), self._keys_of_surface_of_nodes
        )
        edges = self._members_of_each_group(
            lambda part: part.names_of_surfaces(of_nodes=False), self._edges_of_surface_of_elements
        )
        return MeshFileContent(
            points=self.points,
            cells={
                cell: _integer_array_of_rows(rows, NODES_PER_MESHIO_CELL[cell])
                for cell, rows in self.cells.items()
            },
            cell_groups={
                name: self._cell_numbers_of_elements_by_cell_type(keys)
                for name, keys in cells.items()
            },
            node_groups={
                name: np.unique(np.array([self.number[key] for key in keys], dtype=np.int64))
                for name, keys in (nodes | surfaces).items()
            },
            edge_groups={name: _integer_array_of_rows(ends, 2) for name, ends in edges.items()},
            rounding=self.rounding,
            turned=any(
                body.placement.has_rotation_of_part_axes or body.part.turned for body in self.bodies
            ),
            broken=self.broken,
            notes=self._notes_on_ignored_parts(),
        )

    def _notes_on_ignored_parts(self) -> tuple[str, ...]:
        """The notes for the user: ignored keywords and instances, and plane-strain elements."""
        notes = []
        if self.deck.unknown:
            notes.append(f"passed over: {', '.join(self.deck.unknown)}")
        names = {body.name for body in self.bodies}
        for body in self.deck.bodies:
            if body.name not in names and body.part.blocks:
                notes.append(
                    f"passed over: the instance {body.name}, which holds no group of the shoe"
                )
        if self.plane_strain:
            kinds = ", ".join(self.plane_strain)
            notes.append(f"TYPE={kinds} is plane strain; it is solved in plane stress")
        return tuple(notes)

    def _members_of_each_group(
        self,
        named: Callable[[DeckPart], Collection[str]],
        found: Callable[[DeckInstance, str], list[ParsedMemberTypeVariable]],
    ) -> dict[str, list[ParsedMemberTypeVariable]]:
        """The members of each named group of the deck, by the group's name.

        A group of the assembly replaces groups of the same name in other bodies. If the assembly
        has no group of this name, the members in all bodies are collected. If a group cannot be
        read, the reason is kept in `broken`.

        Parameters
        ----------
        named : function that returns the names of the groups of a part
        found : function that returns the members of a group of a body
        """
        # The assembly is first, so that its groups are known before the groups of parts.
        groups: dict[str, list[ParsedMemberTypeVariable]] = {}
        assembly = self.deck.bodies[-1]
        bodies = [body for body in self.bodies if body.part is not assembly.part]
        for body in [assembly, *bodies]:
            for name in named(body.part):
                if body is not assembly and name in named(assembly.part):
                    continue
                try:
                    groups.setdefault(name, []).extend(found(body, name))
                except ValueError as error:
                    self.broken[name] = str(error)
        return groups

    def _keys_named_in_set(
        self, body: DeckInstance, which: str, name: str
    ) -> list[NodeOrElementKey]:
        """The members of the set `name` of a body that are in the mesh.

        `which` is "node_sets" or "element_sets".
        """
        members = self.deck.members_of_named_set(body, which, name)
        return self._keys_in_mesh(members, which, f"the set {name.upper()}")

    def _keys_in_mesh(
        self, members: Iterable[tuple[DeckInstance, int]], which: str, where: str
    ) -> list[NodeOrElementKey]:
        """The keys of those members of a set or surface that are in the mesh.

        ValueError is raised for a member that the file does not define; its message begins with
        `where`. Members of instances that were not chosen are left out.
        """
        known = self.number if which == "node_sets" else self.place
        chosen = {"", *(body.name for body in self.bodies)}
        keys = [(owner.name, label) for owner, label in members]
        for owner, label in keys:
            if (owner, label) not in known and owner in chosen:
                what = which.removesuffix("_sets")
                raise ValueError(
                    f"{where} names the {what} {label}, which the file does not define"
                )
        return [key for key in keys if key in known]

    def _cell_numbers_of_elements_by_cell_type(
        self, keys: list[NodeOrElementKey]
    ) -> dict[str, Ints]:
        """The cells of the elements of a group: type of cell -> indices of the cells.

        `keys` are the elements of the group. Elements without a cell, such as springs, are left
        out.
        """
        rows = defaultdict(list)
        for key in keys:
            place = self.place[key]
            if place is not None:
                rows[place.cell].append(place.row)
        return {cell: np.array(found, dtype=np.int64) for cell, found in rows.items()}

    def _keys_of_surface_of_nodes(self, body: DeckInstance, name: str) -> list[NodeOrElementKey]:
        """The nodes of a *SURFACE of nodes; each line has a label or a set of nodes."""
        return list(chain.from_iterable(keys for _, keys in self._rows_of_surface(body, name)))

    def _rows_of_surface(
        self, body: DeckInstance, name: str
    ) -> Iterator[tuple[list[str], list[NodeOrElementKey]]]:
        """Yield each line of a *SURFACE, and the nodes or elements that its first word names."""
        where = f"the surface {name.upper()}"
        if name in body.part.refused:
            raise ValueError(f"{where}: {body.part.refused[name]}")
        kind, rows = body.part.surfaces[name]
        if kind not in ("NODE", "ELEMENT"):
            raise ValueError(f"{where}: TYPE={kind} is not read")
        which = "node_sets" if kind == "NODE" else "element_sets"
        for row in rows:
            members = self.deck.members_named_by_word(body, which, row[0].lower(), where)
            yield row, self._keys_in_mesh(members, which, where)

    def _edges_of_surface_of_elements(self, body: DeckInstance, name: str) -> list[list[int]]:
        """The corner nodes of the edges of a *SURFACE of elements.

        A line has a label or a set of elements, and may have a face, S1 to S4. Without a face it
        stands for the edges of these elements on the outline of the mesh.
        """
        edges = []
        for row, keys in self._rows_of_surface(body, name):
            face = row[1].upper() if len(row) > 1 else ""
            # Elements without a cell are springs and masses, which have no edges.
            for place in filter(None, map(self.place.get, keys)):
                nodes = self.cells[place.cell][place.row]
                if place.cell.startswith("line"):
                    edges.append(nodes[:2])
                    continue
                corners = nodes[: CORNERS_PER_PLANE_CELL[place.cell]]
                sides = dict(enumerate(map(list, pairwise([*corners, corners[0]])), start=1))
                if not face:
                    edges += [
                        side for side in sides.values() if tuple(sorted(side)) in self._outline
                    ]
                elif face[0] in "SE" and face[1:] in map(str, sides):
                    edges.append(sides[int(face[1:])])
                else:
                    raise ValueError(
                        f"the surface {name.upper()}: {face} is no edge of a plane element; "
                        f"must be S1 to S{len(corners)}"
                    )
        return edges

    @cached_property
    def _outline(self) -> set[tuple[int, ...]]:
        """The corner nodes of the edges on the outline of the mesh, the smaller number first."""
        sides = [np.zeros((0, 2), dtype=np.int64)]
        for cell in set(self.cells) & set(CORNERS_PER_PLANE_CELL):
            rows = _integer_array_of_rows(self.cells[cell], NODES_PER_MESHIO_CELL[cell])
            sides.append(ends_of_each_side(rows, CORNERS_PER_PLANE_CELL[cell]).reshape(-1, 2))
        edges, count = np.unique(np.sort(np.concatenate(sides)), axis=0, return_counts=True)
        return set(map(tuple, edges[count == 1].tolist()))


def meshio_cell_name_of_abaqus_element(kind: str) -> str | None:
    """meshio's name of the cells for an Abaqus element type; None for springs or masses.

    ValueError is raised for elements that are not plane or are axisymmetric.
    """
    if kind.startswith(IGNORED_ABAQUS_ELEMENT_PREFIXES):
        return None
    if kind.startswith(("CAX", "CGAX", "SAX", "MAX")):
        raise ValueError(
            f"*ELEMENT, TYPE={kind} is axisymmetric, a ring about the axis; a shoe is plane (CPS)"
        )
    # Letters at the end (R: reduced, H: hybrid) change the formulation and not the shape.
    plain = kind[:-2] if kind.endswith("R5") else kind.rstrip("HIRMSTW")
    if plain not in MESHIO_CELL_OF_ABAQUS_TYPE:
        raise ValueError(
            f"*ELEMENT, TYPE={kind} is not an element of a plane mesh; "
            f"allowed: {', '.join(MESHIO_CELL_OF_ABAQUS_TYPE)}"
        )
    return MESHIO_CELL_OF_ABAQUS_TYPE[plain]


def _integer_array_of_rows(rows: list[list[int]], width: int) -> Ints:
    """The array (n, width) of n rows of whole numbers; n may be 0."""
    return np.array(rows, dtype=np.int64).reshape(-1, width)
