"""The text of an Abaqus or CalculiX input file as sections: keyword, options and data lines."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from drumlin.fem.mesh.content import MOST_NESTED, read_mesh_bytes

DATA_STARTS = frozenset("*+-.0123456789")
"""First characters of a line that does not continue the options of the keyword line before it.

The line begins with a keyword or a number.
"""


class InputSection(NamedTuple):
    """A keyword, upper case without its star; its options, keys in upper case; its data lines."""

    keyword: str
    options: dict[str, str]
    rows: list[list[str]]

    def option(self, key: str) -> str:
        """The value of an option in upper case; "" where it is not given."""
        return self.options.get(key, "").upper()


def read_deck_sections(text: str, folder: Path | None, depth: int = 0) -> Iterator[InputSection]:
    """The sections of a deck in order; included files stand where they are included.

    Names in quotes lose them. A data line of *ELEMENT that ends with a comma goes on in the next.
    folder: that of the file, where included files are looked for.

    Raises ValueError for a file that is included and cannot be read.
    """
    section, goes_on = InputSection("", {}, []), False
    for line in _join_continued_lines(text):
        if not line.startswith("*"):
            row = [word for word in map(_strip_quotes, line.split(",")) if word]
            if goes_on:
                section.rows[-1].extend(row)
            else:
                section.rows.append(row)
            goes_on = line.endswith(",") and section.keyword == "ELEMENT"
            continue
        yield section
        section, goes_on = _section_of_keyword(line), False
        if section.keyword == "INCLUDE":
            yield from read_deck_sections(*_read_included(section, folder, depth), depth + 1)
            section = InputSection("", {}, [])
    yield section


def _join_continued_lines(text: str) -> Iterator[str]:
    """The lines that are not empty and no comments; keyword lines that go on are joined."""
    begun = ""
    for raw in text.splitlines():
        line = raw.strip()
        if not line or line.startswith("**"):
            continue
        if begun and line[0] in DATA_STARTS:
            yield begun
            begun = ""
        line = begun + line
        # A keyword line that ends with a comma goes on in the next line.
        if line.startswith("*") and line.endswith(","):
            begun = line
            continue
        begun = ""
        yield line
    if begun:
        yield begun


def _strip_quotes(word: str) -> str:
    """A word of a data line or an option without blanks and quotes around it."""
    return word.strip().strip("\"'").strip()


def _section_of_keyword(line: str) -> InputSection:
    """The section that a keyword line begins."""
    first, *words = line[1:].split(",")
    pairs = [word.partition("=") for word in words if word.strip()]
    options = {key.strip().upper(): _strip_quotes(value) for key, _, value in pairs}
    return InputSection(" ".join(first.upper().split()), options, [])


def _read_included(
    section: InputSection, folder: Path | None, depth: int
) -> tuple[str, Path | None]:
    """Text and folder of the file that an *INCLUDE names."""
    name = section.options.get("INPUT", "")
    if not name or folder is None:
        raise ValueError("*INCLUDE names no file that can be found; its option INPUT must name one")
    if depth >= MOST_NESTED:
        raise ValueError(
            f"*INCLUDE, INPUT={name}: files include each other over {MOST_NESTED} deep"
        )
    path = folder / name.replace("\\", "/")
    if not path.is_file():
        raise ValueError(f"*INCLUDE, INPUT={name}: there is no such file beside the mesh file")
    return read_mesh_bytes(path).decode(errors="replace"), path.parent
