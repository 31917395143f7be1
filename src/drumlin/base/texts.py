"""Texts from outside, limited before they are parsed and cleaned before they are printed."""

import difflib
import re
import shlex
from collections.abc import Iterable, Sequence
from pathlib import PurePath

LONGEST_LINE = 600
"""Characters of a line about a fault. A longer line is printed without its middle."""
LONGEST_QUANTITY = 100
"""Characters of a number and its unit in a brake file. Longer texts are refused as no quantity."""
MOST_DIGITS = 400
"""Digits in a row that a number in a file may have. Doubles end at 1e308, and the time to parse a
number grows with the square of its digits.
"""
MOST_KEY_PARTS = 16
"""Parts of a dotted key a.b.c that a file may have. The parser walks through all parts for each key
below, so that keys of many parts take long.
"""

# A number below ten millions is printed without exponent.
_THOUSANDS = re.compile(r"e\+0[0-6]$")
# A zero with a sign is printed without the sign.
_NOTHING = re.compile(r"[-+]0(\.0*)?%?")
_DIGITS = re.compile(rf"[0-9_]{{{MOST_DIGITS + 1}}}")
# A part of a TOML key is bare or in quotes. The second pattern also matches comments, so that a
# text in a comment does not count as a key.
_PART = r"""(?:[A-Za-z0-9_-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""
_KEY = re.compile(rf"#[^\n]*+|{_PART}(?:[ \t]*+\.[ \t]*+{_PART})*+")


def one_line(text: str, most: int = LONGEST_LINE) -> str:
    """The text in one line of printable characters; other characters are escaped.

    A text of more than `most` characters loses its middle.
    """
    if len(text) > most:
        text = f"{text[: most // 2]} ... {text[-most // 2 :]}"
    return text if text.isprintable() else "".join(map(_printable, text))


def _printable(character: str) -> str:
    """The character, or its escape."""
    return character if character.isprintable() else character.encode("unicode_escape").decode()


def typed(words: Sequence[str]) -> str:
    """The text of a command line for a page of a report.

    Of absolute paths only the names stay, since folders tell of the machine.
    """
    return one_line(shlex.join(map(_without_folder, words)))


def _without_folder(word: str) -> str:
    """A word of a command line; of an absolute path, or of an option's one, the name alone."""
    option, equals, path = word.rpartition("=") if word.startswith("-") else ("", "", word)
    name = PurePath(path).name if PurePath(path).is_absolute() else path
    return option + equals + name


def formatted(value: float, form: str) -> str:
    """A number for people, as format() gives it, with a space before %.

    A number that rounds to zero has no sign. In a general form ("g") a number below ten millions
    has no exponent.
    """
    text = format(value, form)
    if form.endswith("g") and _THOUSANDS.search(text):
        text = format(float(text), "+.0f" if text.startswith("+") else ".0f")
    text = text.lstrip("+-") if _NOTHING.fullmatch(text) else text
    return f"{text[:-1]} %" if text.endswith("%") else text


def nearest(name: str, names: Iterable[str]) -> str:
    """A hint for a refusal: the name that was probably meant, or an empty text."""
    close = difflib.get_close_matches(name, list(names), n=1)
    return f" (did you mean {close[0]!r}?)" if close else ""


def check_digits(text: str) -> None:
    """Raise ValueError for a number with more than MOST_DIGITS digits in a row."""
    if _DIGITS.search(text):
        raise ValueError(f"has a number of more than {MOST_DIGITS} digits")


def check_toml(text: str) -> None:
    """Raise ValueError for numbers of many digits or keys of many parts in a TOML text.

    Both would keep the parser busy for long.
    """
    check_digits(text)
    for match in _KEY.finditer(text):
        key = match.group()
        # A part in quotes may hold dots, so that the parts are counted only where dots are many.
        if key.count(".") >= MOST_KEY_PARTS and not key.startswith("#"):
            parts = len(re.findall(_PART, key))
            if parts > MOST_KEY_PARTS:
                raise ValueError(f"has a key of {parts} parts; allowed: {MOST_KEY_PARTS}")
