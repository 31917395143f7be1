"""The text of an Abaqus or CalculiX input file, split into sections.

A section is a keyword line (a keyword with a star and its options) and the data lines after it.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from drumlin.mesh_files.content import LARGEST_INCLUDE_DEPTH, read_bytes_of_mesh_file

FIRST_CHARACTERS_OF_KEYWORD_AND_NUMBER_LINES = frozenset("*+-.0123456789")
"""First characters of lines of an Abaqus input file that begin with a keyword or a number.

If a keyword line ends with a comma, the next line continues its options, unless the next line
begins with one of these characters.
"""


class KeywordSectionOfDeck(NamedTuple):
    """A section of an Abaqus input file.

    Attributes
    ----------
    keyword : keyword in upper case, without its star
    options : values of the options; their keys are in upper case
    rows : words of each data line
    """

    keyword: str
    options: dict[str, str]
    rows: list[list[str]]

    def value_of_option_in_keyword_line(self, key: str) -> str:
        """The value of an option in upper case; "" if the option is not given."""
        return self.options.get(key, "").upper()


def split_input_file_into_sections(
    text: str, folder: Path | None, depth: int = 0
) -> Iterator[KeywordSectionOfDeck]:
    """Yield the sections of an Abaqus input file in order, and the sections of included files.

    Quotes around names are removed. A data line of *ELEMENT that ends with a comma continues in the
    next line.

    Parameters
    ----------
    text : text of the file
    folder : folder of the file, where included files are looked for
    depth : 0 for the mesh file itself, 1 for a file that it includes, and so on

    Raises
    ------
    ValueError
        for an included file that cannot be read
    """
    section, goes_on = KeywordSectionOfDeck("", {}, []), False
    for line in _lines_with_continuations_joined(text):
        # A line without a star is a data line of the section that the last keyword line began.
        if not line.startswith("*"):
            row = [word for word in map(_word_without_blanks_and_quotes, line.split(",")) if word]
            if goes_on:
                section.rows[-1].extend(row)
            else:
                section.rows.append(row)
            goes_on = line.endswith(",") and section.keyword == "ELEMENT"
            continue
        yield section
        section, goes_on = _section_from_keyword_line(line), False
        if section.keyword == "INCLUDE":
            yield from split_input_file_into_sections(
                *_read_text_and_folder_of_included_file(section, folder, depth), depth + 1
            )
            section = KeywordSectionOfDeck("", {}, [])
    yield section


def _lines_with_continuations_joined(text: str) -> Iterator[str]:
    """Yield the lines of a text that are neither empty nor comments.

    A keyword line that ends with a comma is joined with the line that continues it.
    """
    begun = ""
    for raw in text.splitlines():
        line = raw.strip()
        if not line or line.startswith("**"):
            continue
        if begun and line[0] in FIRST_CHARACTERS_OF_KEYWORD_AND_NUMBER_LINES:
            yield begun
            begun = ""
        line = begun + line
        # The options of this keyword line continue in the next line.
        if line.startswith("*") and line.endswith(","):
            begun = line
            continue
        begun = ""
        yield line
    if begun:
        yield begun


def _word_without_blanks_and_quotes(word: str) -> str:
    """The word without blanks and quotes around it."""
    return word.strip().strip("\"'").strip()


def _section_from_keyword_line(line: str) -> KeywordSectionOfDeck:
    """The section that a keyword line begins, with its options and without data lines."""
    first, *words = line[1:].split(",")
    pairs = [word.partition("=") for word in words if word.strip()]
    options = {
        key.strip().upper(): _word_without_blanks_and_quotes(value) for key, _, value in pairs
    }
    return KeywordSectionOfDeck(" ".join(first.upper().split()), options, [])


def _read_text_and_folder_of_included_file(
    section: KeywordSectionOfDeck, folder: Path | None, depth: int
) -> tuple[str, Path | None]:
    """The text and the folder of the file that an *INCLUDE section names.

    `folder` is the folder of the including file. `depth` is 0 if the including file is the mesh
    file itself, 1 if the mesh file includes the including file, and so on. ValueError is raised for
    a file that cannot be found, and for a depth of LARGEST_INCLUDE_DEPTH.
    """
    name = section.options.get("INPUT", "")
    if not name or folder is None:
        raise ValueError("*INCLUDE names no file that can be found; its option INPUT must name one")
    if depth >= LARGEST_INCLUDE_DEPTH:
        raise ValueError(
            f"*INCLUDE, INPUT={name}: files include each other over {LARGEST_INCLUDE_DEPTH} deep"
        )
    path = folder / name.replace("\\", "/")
    if not path.is_file():
        raise ValueError(f"*INCLUDE, INPUT={name}: there is no such file beside the mesh file")
    return read_bytes_of_mesh_file(path).decode(errors="replace"), path.parent
