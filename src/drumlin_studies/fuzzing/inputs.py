"""The class of broken inputs, the valid brake files that are broken, and random noise."""

import random
from collections.abc import Mapping, Sequence
from functools import cache
from types import MappingProxyType
from typing import Any, NamedTuple

from drumlin.studies import FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES

WORD_FOR_FEW_ELEMENTS_PER_LINING = "6"
"""Number of elements along a lining, as a word of command lines. It is small, so that a solve takes
some 20 ms.
"""
NAMES_OF_VALID_BRAKE_FILES_TO_BREAK = (
    "double_shoe/brake",
    "post_brake/brake",
    "laws/pad",
    "laws/pivoted_block",
    "laws/block",
    "laws/shigley_16_2",
)
"""Valid brake files from which broken inputs are made, in studies/ and without their suffix."""


class FilesAndCommandLineOfBrokenInput(NamedTuple):
    """Files of a folder, and a command line of drumlin that runs in the folder.

    Attributes
    ----------
    kind : str
        Kind of the input in tables.
    files : dict
        Contents of the files, by name.
    words : list of str
        Words of the command line after "drumlin".
    right : mapping
        Contents that written files must have after the run, by name; empty if they are not known.
    must_fail : bool
        Whether drumlin must refuse the input.
    undamaged_files : mapping
        Contents of the files without the damage, by name. drumlin may understand the damaged files,
        but its answer must then be the answer of these files. Empty if no answer can be right, or
        if any answer may be.
    """

    kind: str
    files: dict[str, bytes]
    words: list[str]
    right: Mapping[str, bytes] = MappingProxyType({})
    must_fail: bool = False
    undamaged_files: Mapping[str, bytes] = MappingProxyType({})


class UnquotedTomlText(NamedTuple):
    """A text that `data_as_toml` writes without quotes, such as an invalid value."""

    text: str


@cache
def content_of_brake_file(name: str) -> bytes:
    """The content of the brake file `name` of the studies."""
    return (
        FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES / "studies" / f"{name}.toml"
    ).read_bytes()


def bytes_with_random_noise(rng: random.Random, data: bytes, words: Sequence[str] = ()) -> bytes:
    """A copy of the data with random bytes dropped, doubled, overwritten, reversed or inserted.

    `words` are texts that may be inserted, too.
    """
    found = bytearray(data)
    for _ in range(rng.choice([1, 1, 2, 5, 40])):
        # Each change concerns the bytes from `at` to `end`.
        at = rng.randrange(len(found) + 1)
        end = min(len(found), at + rng.choice([1, 1, 3, 20, 200]))
        what = rng.randrange(6 if words else 5)
        if what == 0:
            del found[at:end]
        elif what == 1:
            found[at:at] = found[at:end] * rng.choice([1, 1, 50])
        elif what == 2:
            found[at:at] = bytes([rng.randrange(256)])
        elif what == 3 and at < len(found):
            found[at] = rng.choice(b'0123456789.-e"[]{}=\n ,nafi\0\x1b')
        elif what == 5:
            found[at:at] = rng.choice(words).encode(errors="replace")
        else:
            found[at:end] = found[at:end][::-1]
    return bytes(found)


def data_as_toml(data: Any) -> bytes:
    """Nested data as the text of a TOML file, a line for each key of the top level."""
    lines = (
        f"{_text_as_toml(str(key))} = {_value_as_toml(value)}\n" for key, value in data.items()
    )
    return "".join(lines).encode(errors="replace")


def _value_as_toml(value: Any) -> str:
    """A value in the syntax of TOML, on one line; a table becomes an inline table."""
    if isinstance(value, dict):
        items = (
            f"{_text_as_toml(str(key))} = {_value_as_toml(item)}" for key, item in value.items()
        )
        return "{" + ", ".join(items) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value_as_toml, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, UnquotedTomlText):
        return value.text
    return _text_as_toml(value) if isinstance(value, str) else repr(value)


def _text_as_toml(text: str) -> str:
    """A text in the syntax of TOML, in quotes and with odd letters escaped."""
    # Quotes and backslashes are escaped, and so are letters that cannot be printed.
    plain = {'"': '\\"', "\\": "\\\\"}
    letters = (plain.get(c, c if c.isprintable() else f"\\U{ord(c):08x}") for c in text)
    return '"' + "".join(letters) + '"'
