"""The reader of meshes in Abaqus and CalculiX input files, with parts, instances and sets.

meshio's own reader knows neither quadratic plane-stress elements nor parts, and ignores keywords
that move nodes.
"""

from collections import defaultdict
from collections.abc import Callable, Collection
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
from drumlin.mesh_files.inp_parts import DeckInstance

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
        nodes, cells = (
            self._members_of_each_set("node_sets"),
            self._members_of_each_set("element_sets"),
        )
        surfaces = self._edges_and_nodes_of_surfaces()
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
                for name, keys in (nodes | surfaces.nodes).items()
            },
            edge_groups={
                name: _integer_array_of_rows(edges, 2) for name, edges in surfaces.edges.items()
            },
            outline_edge_groups={
                name: _integer_array_of_rows(edges, 2) for name, edges in surfaces.outlines.items()
            },
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

    def _members_of_each_set(self, which: str) -> dict[str, list[NodeOrElementKey]]:
        """The members of each node set or element set of the deck, by the set's name.

        `which` is "node_sets" or "element_sets". A set of the assembly replaces sets of the same
        name in parts.
        """
        known = self.number if which == "node_sets" else self.place
        what = "node" if which == "node_sets" else "element"

        def members_of_one_set(body: DeckInstance, name: str) -> list[NodeOrElementKey]:
            """The members of the set `name` of a body that are in the mesh.

            ValueError is raised for a member that the file does not define.
            """
            keys = [
                (owner.name, label)
                for owner, label in self.deck.members_of_named_set(body, which, name)
            ]
            strange = next((key for key in keys if key not in known), None)
            if strange is not None and self._is_chosen_instance(strange[0]):
                raise ValueError(
                    f"the set {name.upper()} names the {what} {strange[1]}, "
                    "which the file does not define"
                )
            return [key for key in keys if key in known]

        return self._collect_members_by_group_name(
            lambda body: getattr(body.part, which), members_of_one_set
        )

    def _is_chosen_instance(self, owner: str) -> bool:
        """Whether `owner` is the name of a chosen body, or "", which stands for no instance."""
        return owner == "" or any(body.name == owner for body in self.bodies)

    def _collect_members_by_group_name(
        self,
        named: Callable[[DeckInstance], Collection[str]],
        found: Callable[[DeckInstance, str], list[ParsedMemberTypeVariable]],
    ) -> dict[str, list[ParsedMemberTypeVariable]]:
        """The members of each named group of the deck, by the group's name.

        A group of the assembly replaces groups of the same name in other bodies. If the assembly
        has no group of this name, the members in all bodies are collected. If a group cannot be
        read, the reason is kept in `broken`.

        Parameters
        ----------
        named : function that returns the names of the groups of a body
        found : function that returns the members of a group of a body
        """
        # The assembly is first, so that its groups are known before the groups of parts.
        groups: dict[str, list[ParsedMemberTypeVariable]] = {}
        assembly = self.deck.bodies[-1]
        bodies = [body for body in self.bodies if body.part is not assembly.part]
        for body in [assembly, *bodies]:
            for name in named(body):
                if body is not assembly and name in named(assembly):
                    continue
                try:
                    groups.setdefault(name, []).extend(found(body, name))
                except ValueError as error:
                    self.broken[name] = str(error)
        return groups

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

    def _edges_and_nodes_of_surfaces(self) -> "_EdgesAndNodesOfDeckSurfaces":
        """The edges and nodes of all *SURFACE sections of the deck."""
        found = _EdgesAndNodesOfDeckSurfaces({}, {}, {})

        def add_edges_and_nodes_of_one_surface(body: DeckInstance, name: str) -> list[None]:
            """Add the edges or nodes of the surface `name` of a body to `found`; return no members.

            The empty list is what `_collect_members_by_group_name` collects in place of members.
            """
            if name in body.part.refused:
                raise ValueError(f"the surface {name.upper()}: {body.part.refused[name]}")
            kind, rows = body.part.surfaces[name]
            # A line of a surface of nodes has a label or a set of nodes. A line of a surface of
            # elements has a label or a set of elements, and may have a face (S1 to S4).
            if kind == "NODE":
                keys = [
                    key
                    for row in rows
                    for key in self._nodes_or_elements_named_by_word_of_surface(
                        body, "node_sets", row[0]
                    )
                ]
                found.nodes.setdefault(name, []).extend(keys)
            elif kind == "ELEMENT":
                for row in rows:
                    face = row[1].upper() if len(row) > 1 else ""
                    edges = self._edges_named_by_line_of_surface(body, row[0], face, name)
                    (found.edges if face else found.outlines).setdefault(name, []).extend(edges)
            else:
                raise ValueError(f"the surface {name.upper()}: TYPE={kind} is not read")
            return []

        self._collect_members_by_group_name(
            lambda body: body.part.surfaces, add_edges_and_nodes_of_one_surface
        )
        return found

    def _nodes_or_elements_named_by_word_of_surface(
        self, body: DeckInstance, which: str, word: str
    ) -> list[NodeOrElementKey]:
        """The nodes or elements that a word on a line of *SURFACE stands for.

        The word is the name of a set or the label of one node or element. `which` is "node_sets" or
        "element_sets".
        """
        # In an assembly the word may begin with the name of an instance, as in Shoe-1.Contact.
        name = word.lower()
        holder = body
        if "." in name and name not in getattr(body.part, which):
            before, _, name = name.rpartition(".")
            holder = self.deck.instance_of_given_name(before)
        known = self.number if which == "node_sets" else self.place
        if name in getattr(holder.part, which):
            keys = [
                (owner.name, label)
                for owner, label in self.deck.members_of_named_set(holder, which, name)
            ]
            return [key for key in keys if key in known]
        if not name.isdigit() or (holder.name, int(name)) not in known:
            raise ValueError(f"a surface names {word!r}, which is no label and no set")
        return [(holder.name, int(name))]

    def _edges_named_by_line_of_surface(
        self, body: DeckInstance, word: str, face: str, name: str
    ) -> list[list[int]]:
        """The corner nodes of the edges that a line of a *SURFACE section stands for.

        Parameters
        ----------
        body : body of the surface
        word : name of an element set or label of an element
        face : S1 to S4 for one edge of each element; "" for all edges
        name : name of the surface, for messages
        """
        edges = []
        # Elements without a cell are springs and masses, which have no edges.
        for key in self._nodes_or_elements_named_by_word_of_surface(body, "element_sets", word):
            place = self.place[key]
            if place is None:
                continue
            corners = self.cells[place.cell][place.row][: 3 if "triangle" in place.cell else 4]
            if place.cell.startswith("line"):
                edges.append(corners[:2])
                continue
            sides = range(len(corners))
            if face:
                if face[:1] not in "SE" or face[1:] not in {str(side + 1) for side in sides}:
                    raise ValueError(
                        f"the surface {name.upper()}: {face} is no edge of a plane element; "
                        f"must be S1 to S{len(corners)}"
                    )
                sides = range(int(face[1:]) - 1, int(face[1:]))
            edges += [[corners[i], corners[(i + 1) % len(corners)]] for i in sides]
        return edges


class _EdgesAndNodesOfDeckSurfaces(NamedTuple):
    """The edges and nodes of the surfaces of a deck, by the name of the surface.

    Attributes
    ----------
    edges : corner nodes of the edges that a surface names as elements with a face (S1 to S4)
    outlines : corner nodes of all edges of the elements that a surface names without a face; only
        edges on the outline of the mesh are used
    nodes : nodes of surfaces of TYPE=NODE
    """

    edges: dict[str, list[list[int]]]
    outlines: dict[str, list[list[int]]]
    nodes: dict[str, list[NodeOrElementKey]]


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
