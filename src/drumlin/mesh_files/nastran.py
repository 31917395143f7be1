"""The reader of meshes in Nastran bulk data files (.bdf, .nas, .dat).

meshio's own reader ignores the coordinate systems of grid points, and fails on elements with
orientation angles or thicknesses at their corners.
"""

import re
from collections.abc import Iterator
from decimal import Decimal

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.mesh_files.content_of_file import (
    FEWEST_DIGITS_OF_EXACT_COORDINATE,
    MeshFileContent,
)
from drumlin.mesh_files.labelled_mesh import CollectedLabelledMesh, labels_from_first_to_last
from drumlin.mesh_files.nastran_cards import (
    REAL_NUMBER_OF_CARD_PATTERN,
    NastranBulkCard,
    bulk_data_of_nastran_file,
    split_bulk_data_into_cards,
)
from drumlin.mesh_files.nastran_systems import (
    PlacedNastranSystem,
    place_system_in_basic_system,
    systems_of_cards,
)

CORNERS_OF_NASTRAN_CARD = {
    **dict.fromkeys(("CTRIA3", "CTRIAR", "CPLSTS3", "CPLSTN3"), (3, 3)),
    **dict.fromkeys(("CTRIA6", "CPLSTS6", "CPLSTN6"), (3, 6)),
    **dict.fromkeys(("CQUAD4", "CQUADR", "CSHEAR", "CPLSTS4", "CPLSTN4"), (4, 4)),
    **dict.fromkeys(("CQUAD8", "CPLSTS8", "CPLSTN8"), (4, 8)),
    "CQUAD": (4, 9),
}
"""Number of corners and largest number of nodes of each card of plane elements and shells.

The corners come first, then the middle nodes of the sides, then the centre.
"""
NODES_OF_NASTRAN_LINE_CARD = dict.fromkeys(("CBAR", "CBEAM", "CROD", "CTUBE", "CBEND"), 2) | {
    "CBEAM3": 3
}
"""Number of nodes of each card of beams and rods; a third node is the one in the middle."""
MESHIO_CELL_OF_CORNERS_AND_NODES = {
    (3, 3): "triangle",
    (3, 6): "triangle6",
    (4, 4): "quad",
    (4, 8): "quad8",
    (4, 9): "quad9",
}
"""meshio's name of the cell with a given number of corners and of nodes."""
REASON_TO_REFUSE_RING = "is axisymmetric, a ring about the axis; a shoe is plane (CTRIA, CQUAD)"
"""Reason for refusing an axisymmetric element of Nastran."""
REASON_TO_REFUSE_SOLID = "is a solid element; a mesh must be plane (CTRIA, CQUAD)"
"""Reason for refusing an element of Nastran that is not plane."""
REASON_TO_REFUSE_GENERATED_CARDS = "makes or moves grid points or elements; write the mesh out"
"""Reason for refusing a card of Nastran that makes or moves grid points or elements."""
REFUSED_NASTRAN_CARDS = {
    **dict.fromkeys(("CTRAX3", "CTRAX6", "CQUADX", "CQUADX4", "CQUADX8"), REASON_TO_REFUSE_RING),
    **dict.fromkeys(("CTRIAX", "CTRIAX6", "CCONEAX", "RINGAX", "POINTAX"), REASON_TO_REFUSE_RING),
    **dict.fromkeys(("CTETRA", "CHEXA", "CPENTA", "CPYRAM", "CPYRA"), REASON_TO_REFUSE_SOLID),
    **dict.fromkeys(
        ("EGRID", "GRIDG", "GRIDMOD", "GRIDD", "GRIDU"), REASON_TO_REFUSE_GENERATED_CARDS
    ),
    **dict.fromkeys(("CGEN", "EQUIV", "DELETE", "DISTORT"), REASON_TO_REFUSE_GENERATED_CARDS),
    **dict.fromkeys(
        ("GRIDB", "GRIDF", "GRIDS", "FEEDGE", "FEFACE"), REASON_TO_REFUSE_GENERATED_CARDS
    ),
    **dict.fromkeys(("SEBULK", "SELOC", "SEMPLN", "CYJOIN"), REASON_TO_REFUSE_GENERATED_CARDS),
}
"""Cards of Nastran that change grid points or elements and are refused, each with the reason."""
IGNORED_NASTRAN_CARD_PATTERN = re.compile(
    # Properties, materials, loads and supports.
    "P[A-Z0-9]*|MAT.*|FORCE.|MOMENT.?|LOAD|GRAV|TEMP.*|SPCADD|SPCD|MPC.*|ASET.*|SUPORT.*|ACCEL.?|"
    "RFORCE|DLOAD|LSEQ|RLOAD.|TLOAD.|"
    # Rigid elements, springs, dampers, masses, fasteners and surfaces of fluids and heat.
    "RBE1|RBE3|RBAR|RROD|CONM.|CMASS.|CELAS.|CDAMP.|CBUSH.*|CVISC|CGAP|CWELD|CFAST|CSEAM|CONROD|"
    "CONV.?|CHBDY.|CAERO.|"
    # Coordinate systems and default values, contact, tables, steps and other settings.
    "CORD.*|GRDSET|SPOINT|BEAMOR|BAROR|BCT.*|BCON.*|BSURF.*|BCPROP.*|BCRPARA|TABLE.*|TSTEP.*|"
    "NLPARM|FREQ.*|EIG.*|D[A-Z]+"
)
"""Pattern of the names of Nastran cards that are ignored without a note.

They are about properties, materials, loads, supports, springs and masses, and change neither grid
points nor elements. Coordinate systems are read with the grid points.
"""
NASTRAN_SET_NAME_OF_CARD = {
    "SET1": "set",
    "SET3": "set",
    "SPC": "spc",
    "SPC1": "spc",
    "RBE2": "rbe2",
    "FORCE": "force",
}
"""The word before the number in the name of a group of nodes, such as "spc=3", by the card."""
PROPERTY_NAME_PATTERNS = (
    re.compile(r'^\$HMNAME\s+PROP\w*\s+(\d+)\s*"([^"\n]+)"', re.MULTILINE),
    re.compile(r"^\$\s*Femap Property\s+(\d+)\s*:([^\n]+)$", re.IGNORECASE | re.MULTILINE),
    re.compile(r"^\$ANSA_NAME(?:_COMMENT)?;(\d+);P\w+;([^;~\n]+);", re.MULTILINE),
)
"""Patterns of comments in which HyperMesh, Femap and ANSA write the names of properties.

Group 1 is the number of the property and group 2 its name.
"""


def read_mesh_in_nastran_bulk_data(text: str) -> MeshFileContent:
    """Read the mesh in the text of a Nastran bulk data file.

    The elements of property 3 are the group "pid=3", and also "3" and the name that a comment of
    HyperMesh, Femap or ANSA gives the property. The grid points of the set SET1 4 are the group
    "set=4"; this also holds for SET3, SPC, SPC1, RBE2 and FORCE. They are the group "4", too, if
    there is neither a property nor another set with the number 4.

    Raises
    ------
    ValueError
        with a line that says what cannot be read
    """
    cards: dict[str, list[NastranBulkCard]] = {}
    for card in split_bulk_data_into_cards(bulk_data_of_nastran_file(text)):
        _refuse_card_that_changes_mesh(card)
        cards.setdefault(card.name, []).append(card)
    if not cards.get("GRID"):
        raise ValueError("has no GRID card: it is no bulk data of Nastran")
    mesh = CollectedLabelledMesh()
    grid = _NastranGridPoints(cards)
    for label in grid.card_of_label:
        mesh.add_labelled_node(label, grid.point_in_basic_system(label).tolist())
    _add_elements_and_property_groups(mesh, cards, _names_of_properties(text))
    _add_groups_of_grid_points(mesh, cards)
    turned = any(number != 0 for number in grid.system_of_label.values())
    return mesh.content_with_nodes_cells_and_groups(
        rounding=grid.largest_rounding_errors(), turned=turned, notes=_notes_on_ignored_cards(cards)
    )


READ_NASTRAN_CARDS = frozenset(
    ("GRID", *CORNERS_OF_NASTRAN_CARD, *NODES_OF_NASTRAN_LINE_CARD, *NASTRAN_SET_NAME_OF_CARD)
)
"""The cards of Nastran that are read as grid points, elements and groups."""
UNKNOWN_CARD_OF_MESH_PATTERN = re.compile("C.*|GRID.+")
"""Pattern of the names of cards that may connect or make grid points: elements begin with a C."""


def _refuse_card_that_changes_mesh(card: NastranBulkCard) -> None:
    """Raise ValueError for a card that changes grid points or elements and is not read."""
    if card.name in REFUSED_NASTRAN_CARDS:
        raise ValueError(f"{card.words_of_card()} {REFUSED_NASTRAN_CARDS[card.name]}")
    is_known = card.name in READ_NASTRAN_CARDS or IGNORED_NASTRAN_CARD_PATTERN.fullmatch(card.name)
    if not is_known and UNKNOWN_CARD_OF_MESH_PATTERN.fullmatch(card.name):
        raise ValueError(
            f"{card.words_of_card()} is not read; the elements of a plane mesh are CTRIA3, CTRIA6, "
            "CQUAD4, CQUAD8, CQUAD, CTRIAR, CQUADR and CPLSTS"
        )


class _NastranGridPoints:
    """The grid points of a Nastran file, with the coordinate systems of their coordinates."""

    def __init__(self, cards: dict[str, list[NastranBulkCard]]) -> None:
        defaults = cards.get("GRDSET", [])
        if len(defaults) > 1:
            raise ValueError("GRDSET: there are two cards with default values of GRID")
        system = defaults[0].integer_of_field(1, default=0) if defaults else 0
        self.card_of_label: dict[int, NastranBulkCard] = {}
        self.system_of_label: dict[int, int] = {}
        for card in cards["GRID"]:
            label = card.integer_of_field(0)
            if label in self.card_of_label:
                raise ValueError(f"GRID {label} is defined twice")
            self.card_of_label[label] = card
            self.system_of_label[label] = card.integer_of_field(1, default=system)
        self._system_cards = systems_of_cards(
            [card for name in cards if name.startswith("CORD") for card in cards[name]]
        )
        self._systems: dict[int, PlacedNastranSystem] = {}

    def point_in_basic_system(self, label: int, above: tuple[int, ...] = ()) -> Floats:
        """The coordinates (3,) of a grid point in the basic system.

        `above` are the numbers of the systems that this grid point defines. ValueError is raised
        for a grid point or a system that cannot be found or read.
        """
        card = self.card_of_label.get(label)
        if card is None:
            raise ValueError(
                f"a coordinate system has the grid point {label}, which is not defined"
            )
        written = np.array([card.real_of_field(i) for i in (2, 3, 4)])
        number = self.system_of_label[label]
        if number not in self._systems:
            try:
                self._systems[number] = place_system_in_basic_system(
                    number, self._system_cards, self.point_in_basic_system, above
                )
            except ValueError as error:
                raise ValueError(f"GRID {label}: {error}") from error
        return self._systems[number].point_in_basic_system(written)

    def largest_rounding_errors(self) -> Floats:
        """The largest rounding errors (n, 2) of x and y of all grid points as they are written.

        A field of eight characters leaves 24.1234 and -.123456 different numbers of decimals.
        Coordinates with the same sign and the same number of digits before the point have the same
        number of decimals, unless zeros at their end were left out. The most decimals among them
        therefore count for all of them.
        """
        values = [
            _decimal_of_text(card.text_of_field(i))
            for card in self.card_of_label.values()
            for i in (2, 3)
        ]
        is_zero = np.array([value == 0 for value in values])
        is_negative = np.array([value.is_signed() for value in values])
        leading = np.array([value.adjusted() for value in values])
        last_written = np.array([value.as_tuple().exponent for value in values])
        # Powers of ten: of the leading digit, and of the last digit among coordinates of one kind.
        _, kind = np.unique(2 * leading + is_negative, return_inverse=True)
        last_of_kind = np.zeros(kind.max() + 1, dtype=np.int64)
        np.minimum.at(last_of_kind, kind, last_written)
        last = last_of_kind[kind]
        is_exact = is_zero | (leading - last + 1 >= FEWEST_DIGITS_OF_EXACT_COORDINATE)
        return np.where(is_exact, 0.0, 0.5 * 10.0**last).reshape(-1, 2)


def _decimal_of_text(word: str) -> Decimal:
    """The number in a field of a card with the decimals that it is written with; "" is 0."""
    found = REAL_NUMBER_OF_CARD_PATTERN.fullmatch(word)
    return Decimal(f"{found[1]}e{found[2] or found[3] or 0}") if found else Decimal(0)


def _names_of_properties(text: str) -> dict[int, str]:
    """The names of properties that comments of HyperMesh, Femap or ANSA give, by their number."""
    found: dict[int, str] = {}
    for pattern in PROPERTY_NAME_PATTERNS:
        for number, name in pattern.findall(text):
            found.setdefault(int(number), name.strip())
    return found


def _add_elements_and_property_groups(
    mesh: CollectedLabelledMesh, cards: dict[str, list[NastranBulkCard]], names: dict[int, str]
) -> None:
    """Add all plane elements, beams and rods to a mesh, and a group for each property.

    `names` are names of properties by their number.
    """
    for name in (*CORNERS_OF_NASTRAN_CARD, *NODES_OF_NASTRAN_LINE_CARD):
        for card in cards.get(name, []):
            label = card.integer_of_field(0)
            # An element without a property has the property of its own number.
            number = card.integer_of_field(1, default=label)
            mesh.add_labelled_element(label, *_cell_and_nodes_of_card(card))
            for group in {f"pid={number}", str(number), names.get(number, str(number))}:
                mesh.add_element_group_members(group, [label])


def _cell_and_nodes_of_card(card: NastranBulkCard) -> tuple[str, list[int]]:
    """meshio's name of the cell of an element, and the labels of its nodes in meshio's order.

    ValueError is raised for an element that has some middle nodes but not all of them.
    """
    if card.name in NODES_OF_NASTRAN_LINE_CARD:
        count = NODES_OF_NASTRAN_LINE_CARD[card.name]
        has_middle = count > 2 and bool(card.text_of_field(4))
        nodes = [card.integer_of_field(2 + i) for i in range(3 if has_middle else 2)]
        return "line3" if has_middle else "line", nodes
    corners, most = CORNERS_OF_NASTRAN_CARD[card.name]
    nodes = [card.integer_of_field(2 + i, default=0) for i in range(most)]
    # Nastran lets middle nodes be left out. An element without any of them is linear.
    while len(nodes) > corners and not nodes[-1]:
        nodes.pop()
    cell = MESHIO_CELL_OF_CORNERS_AND_NODES.get((corners, len(nodes)))
    if cell is None or not all(nodes):
        raise ValueError(
            f"{card.words_of_card()} has some of its {most} nodes; must have all of them, or only "
            "its corners"
        )
    return cell, nodes


def _add_groups_of_grid_points(
    mesh: CollectedLabelledMesh, cards: dict[str, list[NastranBulkCard]]
) -> None:
    """Add the sets, constraints and forces of a Nastran file to a mesh, as groups of nodes."""
    found: dict[tuple[str, int], list[int]] = {}
    for card_name, word in NASTRAN_SET_NAME_OF_CARD.items():
        for card in cards.get(card_name, []):
            number = card.integer_of_field(0)
            found.setdefault((word, number), []).extend(_grid_points_named_by_card(card))
    numbers = [number for _, number in found]
    taken = {
        card.integer_of_field(1, default=0)
        for name in (*CORNERS_OF_NASTRAN_CARD, *NODES_OF_NASTRAN_LINE_CARD)
        for card in cards.get(name, [])
    }
    for (word, number), labels in found.items():
        mesh.add_node_group_members(f"{word}={number}", labels)
        if number not in taken and numbers.count(number) == 1:
            mesh.add_node_group_members(str(number), labels)


def _grid_points_named_by_card(card: NastranBulkCard) -> list[int]:
    """The labels of the grid points that a set, a constraint or a force names."""
    if card.name == "FORCE":
        return [card.integer_of_field(1)]
    if card.name == "SPC":
        return [card.integer_of_field(i) for i in (1, 4) if card.text_of_field(i)]
    if card.name == "SET3" and card.text_of_field(1).upper() not in ("GRID", "POINT"):
        return []
    first = {"SET1": 1, "SET3": 2, "SPC1": 2, "RBE2": 3}[card.name]
    return list(_labels_with_ranges(card, first))


def _labels_with_ranges(card: NastranBulkCard, first: int) -> Iterator[int]:
    """Yield the labels in a card from its field `first` on; 1 THRU 5 stands for five labels.

    ValueError is raised for a range that is incomplete, too long, or has a step.
    """
    words = [word.upper() for word in card.fields[first:]]
    position = first
    while position < len(card.fields):
        word = words[position - first]
        if position + 1 < len(card.fields) and words[position + 1 - first] == "THRU":
            start, end = card.integer_of_field(position), card.integer_of_field(position + 2)
            try:
                yield from labels_from_first_to_last(start, end)
            except ValueError as error:
                raise ValueError(f"{card.words_of_card()} {error}") from error
            position += 3
        elif card.name == "RBE2" and "." in word:
            # The last field of RBE2 is a coefficient of thermal expansion.
            position += 1
        else:
            # Words such as SKIN, BY and EXCEPT are refused as no whole numbers.
            if word:
                yield card.integer_of_field(position)
            position += 1


def _notes_on_ignored_cards(cards: dict[str, list[NastranBulkCard]]) -> tuple[str, ...]:
    """The notes for the user: cards that were ignored, and elements in plane strain."""
    ignored = [
        name
        for name in cards
        if name not in READ_NASTRAN_CARDS and not IGNORED_NASTRAN_CARD_PATTERN.fullmatch(name)
    ]
    notes = [f"passed over: {', '.join(ignored)}"] if ignored else []
    strain = [name for name in cards if name.startswith("CPLSTN")]
    if strain:
        notes.append(f"{', '.join(strain)} is plane strain; it is solved in plane stress")
    return tuple(notes)
