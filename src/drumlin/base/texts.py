"""Texts from outside: limited before a parser sees them, cleaned before a person does."""

import difflib
import re
import shlex
from collections.abc import Iterable, Sequence
from pathlib import PurePath

LONGEST_LINE = 600  # characters of a line about a fault
LONGEST_QUANTITY = 100  # characters of a number and its unit
MOST_DIGITS = (
    400  # in a row: what lies beyond 1e308 is no quantity, and long ones take their square in time
)
MOST_PARTS = 16  # of a key a.b.c: each key below it takes as many steps again

_THOUSANDS = re.compile(r"e\+0[0-6]$")
_NOTHING = re.compile(r"[-+]0(\.0*)?%?")
_DIGITS = re.compile(rf"[0-9_]{{{MOST_DIGITS + 1}}}")
_PART = r"""(?:[A-Za-z0-9_-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""
_KEY = re.compile(rf"#[^\n]*+|{_PART}(?:[ \t]*+\.[ \t]*+{_PART})*+")


def one_line(text: str, most: int = LONGEST_LINE) -> str:
    """The text in one line of printable characters, with other characters escaped.

    A text of more than `most` characters loses its middle.
    """
    if len(text) > most:
        text = f"{text[: most // 2]} ... {text[-most // 2 :]}"
    return text if text.isprintable() else "".join(map(_shown, text))


def _shown(character: str) -> str:
    return character if character.isprintable() else character.encode("unicode_escape").decode()


def typed(words: Sequence[str]) -> str:
    """A command line as a page shows it, with the names of absolute paths alone.

    The folders of an absolute path would tell of the machine.
    """
    return one_line(shlex.join(map(_without_folder, words)))


def _without_folder(word: str) -> str:
    option, equals, path = word.rpartition("=") if word.startswith("-") else ("", "", word)
    return option + equals + (PurePath(path).name if PurePath(path).is_absolute() else path)


def formatted(value: float, form: str) -> str:
    """A number for people, as format() has it, with a space before %.

    A number that rounds to zero has no sign. In a general form ("g") a number below ten millions
    has no exponent.
    """
    text = format(value, form)
    if form.endswith("g") and _THOUSANDS.search(text):
        text = format(float(text), "+.0f" if text.startswith("+") else ".0f")
    text = text.lstrip("+-") if _NOTHING.fullmatch(text) else text
    return f"{text[:-1]} %" if text.endswith("%") else text


def nearest(name: str, names: Iterable[str]) -> str:
    """A hint for a refusal: which of the names was probably meant, or nothing."""
    close = difflib.get_close_matches(name, list(names), n=1)
    return f" (did you mean {close[0]!r}?)" if close else ""


def check_digits(text: str) -> None:
    """Raise ValueError for a number with more than MOST_DIGITS digits in a row."""
    if _DIGITS.search(text):
        raise ValueError(f"has a number of more than {MOST_DIGITS} digits")


def check_toml(text: str) -> None:
    """Raise ValueError for a text that would keep a TOML parser busy.

    These are texts with numbers of many digits or with keys of many parts.
    """
    check_digits(text)
    for match in _KEY.finditer(text):
        key = match.group()
        if key.count(".") >= MOST_PARTS and not key.startswith("#"):
            parts = len(re.findall(_PART, key))
            if parts > MOST_PARTS:
                raise ValueError(f"has a key of {parts} parts; allowed: {MOST_PARTS}")
