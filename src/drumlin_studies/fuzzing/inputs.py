"""What a broken input is, the sound brake files that inputs are made of, and how bytes get broken."""

import random
from collections.abc import Mapping, Sequence
from functools import cache
from types import MappingProxyType
from typing import Any, NamedTuple

from drumlin.studies import REPOSITORY

FEW_ELEMENTS = "6"
"""Number of elements along a lining in the commands of inputs, so that a solve takes some 20 ms."""
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
    """Files by name and the words of a command line that is run in their folder.

    `right` is the content that files of an answer must have, where that content is known. An input
    that `must_fail` has no answer, whatever model it is given to.
    """

    kind: str
    files: dict[str, bytes]
    words: list[str]
    right: Mapping[str, bytes] = MappingProxyType({})
    must_fail: bool = False


class Raw(NamedTuple):
    """A text that `toml` writes into a file without quotes."""

    text: str


@cache
def brake_text(name: str) -> bytes:
    """The text of a brake file of the studies."""
    return (REPOSITORY / "studies" / f"{name}.toml").read_bytes()


def noise(rng: random.Random, data: bytes, words: Sequence[str] = ()) -> bytes:
    """Bytes dropped, doubled, inserted, overwritten, turned round, or some of `words` among them."""
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


def toml(data: Any) -> bytes:
    """Nested data as TOML: everything below the top as inline tables."""
    return "".join(
        f"{_quoted(str(key))} = {_inline(value)}\n" for key, value in data.items()
    ).encode(errors="replace")


def _inline(value: Any) -> str:
    if isinstance(value, dict):
        return (
            "{"
            + ", ".join(f"{_quoted(str(key))} = {_inline(item)}" for key, item in value.items())
            + "}"
        )
    if isinstance(value, list):
        return "[" + ", ".join(map(_inline, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Raw):
        return value.text
    return _quoted(value) if isinstance(value, str) else repr(value)


def _quoted(text: str) -> str:
    plain = {'"': '\\"', "\\": "\\\\"}
    return (
        '"'
        + "".join(plain.get(c, c if c.isprintable() else f"\\U{ord(c):08x}") for c in text)
        + '"'
    )
