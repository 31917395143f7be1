"""Broken inputs: their form, the sound brake files behind them, and how bytes are broken."""

import random
from collections.abc import Mapping, Sequence
from functools import cache
from types import MappingProxyType
from typing import Any, NamedTuple

from drumlin.studies import REPOSITORY

FEW_ELEMENTS = "6"
"""Elements along a lining in the commands of inputs. A solve then takes some 20 ms."""
SOUND_BRAKES = (
    "double_shoe/brake",
    "post_brake/brake",
    "laws/pad",
    "laws/pivoted_block",
    "laws/block",
    "laws/shigley_16_2",
)
"""The brake files that inputs are made of, in studies/ and without their suffix."""


class BrokenInput(NamedTuple):
    """A folder of files with a command line that runs in it.

    Attributes
    ----------
    kind : str
        What kind of input it is.
    files : dict
        Contents of the files, by name.
    words : list of str
        The words of the command line.
    right : mapping
        Contents that files of an answer must have, by name, where they are known.
    must_fail : bool
        Whether no model may answer the input.
    """

    kind: str
    files: dict[str, bytes]
    words: list[str]
    right: Mapping[str, bytes] = MappingProxyType({})
    must_fail: bool = False


class Raw(NamedTuple):
    """A text that `data_as_toml` writes without quotes."""

    text: str


@cache
def brake_text(name: str) -> bytes:
    """The text of a brake file of the studies."""
    return (REPOSITORY / "studies" / f"{name}.toml").read_bytes()


def add_noise(rng: random.Random, data: bytes, words: Sequence[str] = ()) -> bytes:
    """Data with some bytes dropped, doubled, overwritten, reversed, or with words inserted."""
    found = bytearray(data)
    for _ in range(rng.choice([1, 1, 2, 5, 40])):
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
    """Nested data as TOML: everything below the top as inline tables."""
    lines = (
        f"{_text_as_toml(str(key))} = {_value_as_toml(value)}\n" for key, value in data.items()
    )
    return "".join(lines).encode(errors="replace")


def _value_as_toml(value: Any) -> str:
    """A value in TOML, on one line."""
    if isinstance(value, dict):
        items = (
            f"{_text_as_toml(str(key))} = {_value_as_toml(item)}" for key, item in value.items()
        )
        return "{" + ", ".join(items) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value_as_toml, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Raw):
        return value.text
    return _text_as_toml(value) if isinstance(value, str) else repr(value)


def _text_as_toml(text: str) -> str:
    """A text in TOML, in quotes."""
    plain = {'"': '\\"', "\\": "\\\\"}
    letters = (plain.get(c, c if c.isprintable() else f"\\U{ord(c):08x}") for c in text)
    return '"' + "".join(letters) + '"'
