"""An Abaqus or CalculiX input file (deck), sorted into parts, instances and an assembly.

A part has nodes, elements and sets. An instance is a part in its place in the assembly.
"""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from drumlin.mesh_files.inp_keywords import refuse_or_note_ignored_section
from drumlin.mesh_files.inp_parts import (
    IDENTITY_PLACEMENT,
    DeckInstance,
    DeckPart,
    DeckSetMember,
    parse_node_or_element_label,
    parse_numbers_of_data_line,
    placement_of_instance_in_assembly,
    placement_of_nodes_after_system_section,
)
from drumlin.mesh_files.inp_text import KeywordSectionOfDeck, split_input_file_into_sections

MOST_MEMBERS_OF_ALL_DECK_SETS = 2_000_000
"""Largest number of members of all sets of an Abaqus deck together; a deck with more is refused.

A set may consist of other sets and of ranges of labels, so that it can have far more members than
its text has words.
"""
REASON_TO_REFUSE_DATA_IN_OTHER_FILE = (
    "reads its data lines from another file; use *INCLUDE, or put them into the deck"
)
"""Reason for refusing a keyword of an Abaqus deck whose data lines are in another file."""
REFUSED_KEYWORD_OPTIONS = {
    "NODE": {"INPUT": REASON_TO_REFUSE_DATA_IN_OTHER_FILE},
    "ELEMENT": {
        "INPUT": REASON_TO_REFUSE_DATA_IN_OTHER_FILE,
        "OFFSET": "renumbers elements; write out their labels",
    },
    "INSTANCE": {
        "LIBRARY": "takes the instance from another analysis; write the mesh out in full",
        "INSTANCE": "takes the instance from another analysis; write the mesh out in full",
    },
}
"""Options of Abaqus keywords that change nodes or elements and are refused, with the reason.

The reason also tells what to do instead. The outer key is the keyword, the inner key the option.
"""
REFUSED_SET_OPTIONS = {
    "ELSET": "names the nodes of an element set; write out their labels",
    "COMBINE": "combines other surfaces; write out their elements",
    "CROP": "keeps a part of a surface; write out its elements",
    "INPUT": REASON_TO_REFUSE_DATA_IN_OTHER_FILE,
}
"""Options that change the members of an Abaqus set or surface and are not read, with the reason.

The reason also tells what to do instead. It becomes the error message if the shoe needs the set.
"""


class AbaqusDeck:
    """An Abaqus or CalculiX input file: its parts, instances, sets and ignored keywords."""

    def __init__(self, text: str, folder: Path | None) -> None:
        self.root, self.assembly = DeckPart(), DeckPart()
        self.parts: dict[str, DeckPart] = {}
        self.instances: dict[str, DeckInstance] = {}
        self.unknown: dict[str, None] = {}
        self._scope, self._outer = self.root, self.root
        self._system = IDENTITY_PLACEMENT
        self._room = MOST_MEMBERS_OF_ALL_DECK_SETS
        for section in split_input_file_into_sections(text, folder):
            self._add_section_to_its_part(section)

    @property
    def bodies(self) -> list[DeckInstance]:
        """The bodies that may have nodes: all instances, or all parts of a deck without instances.

        The first body is the deck outside of parts, and the last one is the assembly.
        """
        placed = list(self.instances.values()) or [
            DeckInstance(name, part) for name, part in self.parts.items()
        ]
        return [DeckInstance("", self.root), *placed, DeckInstance("", self.assembly)]

    def _add_section_to_its_part(self, section: KeywordSectionOfDeck) -> None:
        """Add the nodes, elements, sets or surfaces of one section of the deck to its part.

        If a section begins or ends a part, an instance or the assembly, the next sections belong to
        another part.
        """
        keyword, scope = section.keyword, self._scope
        for option, reason in REFUSED_KEYWORD_OPTIONS.get(keyword, {}).items():
            if option in section.options:
                raise ValueError(f"*{keyword}, {option}= {reason}")
        if keyword == "NODE":
            self._add_nodes_of_section(section)
        elif keyword == "ELEMENT":
            self._add_elements_of_section(section)
        elif keyword == "NSET":
            self._add_members_to_named_set(scope.node_sets, section, section.options.get("NSET"))
        elif keyword == "ELSET":
            self._add_members_to_named_set(
                scope.element_sets, section, section.options.get("ELSET")
            )
        elif keyword == "SURFACE":
            self._add_surface_of_section(section)
        elif keyword == "SYSTEM":
            self._system = placement_of_nodes_after_system_section(section.rows)
        elif keyword in METHODS_OF_BEGIN_AND_END_KEYWORDS:
            self._system = IDENTITY_PLACEMENT
            METHODS_OF_BEGIN_AND_END_KEYWORDS[keyword](self, section)
        elif keyword:
            refuse_or_note_ignored_section(section, self.unknown)

    def _add_nodes_of_section(self, section: KeywordSectionOfDeck) -> None:
        """Add the nodes of a *NODE section, shifted or rotated by a *SYSTEM section before it."""
        kind, scope = section.value_of_option_in_keyword_line("SYSTEM") or "R", self._scope
        if kind not in ("R", "C"):
            raise ValueError(f"*NODE, SYSTEM={kind} is not read; write rectangular coordinates")
        scope.turned |= kind == "C" or self._system.has_rotation_of_part_axes
        for row in section.rows:
            label = parse_node_or_element_label(row[0], "*NODE")
            written = parse_numbers_of_data_line(row[1:], f"node {row[0]}")
            xyz = [*written, 0.0, 0.0, 0.0][:3]
            if kind == "C":
                # Cylindrical coordinates are radius, angle in degrees, and height.
                angle = math.radians(xyz[1])
                xyz = [xyz[0] * math.cos(angle), xyz[0] * math.sin(angle), xyz[2]]
            if self._system is not IDENTITY_PLACEMENT:
                xyz = self._system(np.array(xyz)).tolist()
            scope.add_labelled_node_to_part(label, xyz, [*written, 0.0, 0.0][:2])
        # The option NSET of a *NODE section makes a set of these nodes.
        labels = KeywordSectionOfDeck("NSET", {}, [[row[0]] for row in section.rows])
        self._add_members_to_named_set(scope.node_sets, labels, section.options.get("NSET"))

    def _add_elements_of_section(self, section: KeywordSectionOfDeck) -> None:
        """Add the elements of an *ELEMENT section with the labels of their nodes.

        The number of nodes of each element is checked later.
        """
        kind, found = section.value_of_option_in_keyword_line("TYPE"), dict[int, list[int]]()
        for row in section.rows:
            label, *nodes = (parse_node_or_element_label(word, "*ELEMENT") for word in row)
            if label in found:
                raise ValueError(f"element {label} is defined twice")
            found[label] = nodes
        self._scope.add_labelled_elements_to_part(kind, found)
        # The option ELSET of an *ELEMENT section makes a set of these elements.
        labels = KeywordSectionOfDeck("ELSET", {}, [[str(label)] for label in found])
        self._add_members_to_named_set(
            self._scope.element_sets, labels, section.options.get("ELSET")
        )

    def _add_members_to_named_set(
        self, sets: dict[str, list[DeckSetMember]], section: KeywordSectionOfDeck, name: str | None
    ) -> None:
        """Add the data lines of a section to the set `name`; nothing is added without a name.

        A line has labels and names of other sets or, with the option GENERATE, the first label, the
        last label and the step of a range.
        """
        if not name:
            return
        self._note_refused_options_of_set(section, name)
        owner = section.options.get("INSTANCE", "").lower()
        found = sets.setdefault(name.lower(), [])
        for row in section.rows:
            if "GENERATE" in section.options:
                where = f"*{section.keyword}, GENERATE"
                first, last, step = [
                    *(parse_node_or_element_label(word, where) for word in row),
                    1,
                ][:3]
                found.append(DeckSetMember(owner, range(first, last + 1, step)))
            else:
                found += [DeckSetMember(owner, word.lower()) for word in row]

    def _add_surface_of_section(self, section: KeywordSectionOfDeck) -> None:
        """Keep the type and the data lines of a *SURFACE section under the surface's name."""
        name = section.options.get("NAME", "").lower()
        self._note_refused_options_of_set(section, name)
        kind = section.value_of_option_in_keyword_line("TYPE") or "ELEMENT"
        self._scope.surfaces[name] = (kind, section.rows)

    def _note_refused_options_of_set(self, section: KeywordSectionOfDeck, name: str) -> None:
        """Keep the reason why a set or surface cannot be read, if it has such an option."""
        for option, reason in REFUSED_SET_OPTIONS.items():
            if option in section.options and option != section.keyword:
                self._scope.refused[name.lower()] = f"*{section.keyword}, {option}= {reason}"

    def _begin_part_of_input_deck(self, section: KeywordSectionOfDeck) -> None:
        """Begin a new part; the sections up to *END PART belong to it."""
        name = section.options.get("NAME", "").lower()
        if name in self.parts:
            raise ValueError(f"*PART, NAME={name}: there are two parts of this name")
        self._scope = self.parts[name] = DeckPart(name)

    def _begin_assembly_of_input_deck(self, section: KeywordSectionOfDeck) -> None:
        """Begin the assembly; sections between its instances belong to it."""
        self._scope = self._outer = self.assembly

    def _begin_instance_of_part_of_input_deck(self, section: KeywordSectionOfDeck) -> None:
        """Begin an instance of a part, or an instance with nodes and elements of its own."""
        name, of = (section.options.get(key, "") for key in ("NAME", "PART"))
        part = self.parts.get(of.lower())
        if of and part is None:
            raise ValueError(f"*INSTANCE, NAME={name}: there is no *PART, NAME={of} before it")
        if name.lower() in self.instances:
            raise ValueError(f"*INSTANCE, NAME={name}: there are two instances of this name")
        self._scope = DeckPart(name.lower())
        placement = placement_of_instance_in_assembly(section.rows, name)
        placed = DeckInstance(name.lower(), part or self._scope, placement)
        self.instances[placed.name] = placed

    def _end_part_instance_or_assembly(self, section: KeywordSectionOfDeck) -> None:
        """End a part, an instance or the assembly.

        After the end of an instance, later sections belong to the assembly. After the end of a part
        or the assembly, they belong to the deck itself.
        """
        own = self._scope
        named = self.instances.get(own.name)
        # Nodes between *INSTANCE and *END INSTANCE would be added to this instance of the part
        # alone, which is not supported.
        placed = section.keyword == "END INSTANCE" and named is not None and named.part is not own
        if placed and (own.nodes or own.labels):
            raise ValueError(f"*INSTANCE, NAME={own.name} adds nodes or elements to its part")
        if section.keyword == "END ASSEMBLY":
            self._outer = self.root
        self._scope = self._outer

    def members_of_named_set(
        self,
        body: DeckInstance,
        which: str,
        name: str,
        above: tuple[tuple[str, str], ...] = (),
    ) -> Iterator[tuple[DeckInstance, int]]:
        """Yield the instance and the label of each member of a set of nodes or elements.

        If a member is a set itself, its members are yielded.

        Parameters
        ----------
        body : instance or part that the set belongs to
        which : "node_sets" or "element_sets"
        name : name of the set
        above : body and name of each set that this set is a member of

        Raises
        ------
        ValueError
            for a member that is neither a label nor a set, and for a set that contains itself
        """
        if (body.name, name) in above:
            raise ValueError(f"the set {name.upper()} is a member of itself")
        if name in body.part.refused:
            raise ValueError(f"the set {name.upper()}: {body.part.refused[name]}")
        for owner, word in getattr(body.part, which)[name]:
            holder = self.instance_of_given_name(owner) if owner else body
            yield from self.members_named_by_word(
                holder, which, word, f"the set {name.upper()}", (*above, (body.name, name))
            )

    def members_named_by_word(
        self,
        body: DeckInstance,
        which: str,
        word: range | str,
        where: str,
        above: tuple[tuple[str, str], ...] = (),
    ) -> Iterator[tuple[DeckInstance, int]]:
        """Yield the instance and the label of each member that a word of a set or surface names.

        Parameters
        ----------
        body : instance or part that the word belongs to
        which : "node_sets" or "element_sets"
        word : range of labels, one label, or the name of a set
        where : set or surface of the word, for messages
        above : body and name of each set that the word is a member of

        Raises
        ------
        ValueError
            for a word that is neither a label nor a set, and for too many members
        """
        if isinstance(word, str):
            if word not in getattr(body.part, which) and "." in word:
                # An assembly writes Shoe-1.12 or Shoe-1.Contact for label 12 or set Contact of the
                # instance Shoe-1.
                before, _, word = word.rpartition(".")
                body = self.instance_of_given_name(before)
            if word in getattr(body.part, which):
                yield from self.members_of_named_set(body, which, word, above)
                return
            if not word.isdigit():
                raise ValueError(f"{where} names {word!r}, which is no label and no set")
            word = range(int(word), int(word) + 1)
        # There are more labels than allowed if the slice after the allowed number is not empty. The
        # function len would fail for a very long range.
        if word[self._room :]:
            raise ValueError(
                f"the sets have more than {MOST_MEMBERS_OF_ALL_DECK_SETS} members together"
            )
        self._room -= len(word)
        for label in word:
            yield body, label

    def instance_of_given_name(self, name: str) -> DeckInstance:
        """The instance of the given name. ValueError is raised if the deck has none."""
        found = self.instances.get(name.lower().strip())
        if found is None:
            raise ValueError(f"there is no *INSTANCE, NAME={name}, that a set names")
        return found


METHODS_OF_BEGIN_AND_END_KEYWORDS = {
    "PART": AbaqusDeck._begin_part_of_input_deck,
    "ASSEMBLY": AbaqusDeck._begin_assembly_of_input_deck,
    "INSTANCE": AbaqusDeck._begin_instance_of_part_of_input_deck,
    "END PART": AbaqusDeck._end_part_instance_or_assembly,
    "END ASSEMBLY": AbaqusDeck._end_part_instance_or_assembly,
    "END INSTANCE": AbaqusDeck._end_part_instance_or_assembly,
}
"""The method of `AbaqusDeck` for each keyword that begins or ends a part or an instance.

The keywords of the assembly are among them.
"""
