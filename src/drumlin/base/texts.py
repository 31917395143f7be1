"""Limit the length of users' texts before they are parsed, and make texts printable.

In a printable text, line breaks and control characters are replaced by escape sequences.
"""

import difflib
import re
import shlex
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import PurePath

MAX_CHARACTERS_OF_ERROR_MESSAGE = 600
"""Longest error message in characters. A longer message is printed without its middle."""
MAX_CHARACTERS_OF_QUANTITY_TEXT = 100
"""Longest text of a number with its unit in a brake file, in characters; longer is refused."""
MAX_CONSECUTIVE_DIGITS_OF_NUMBER = 308
"""Largest number of consecutive digits of a number in a file, and of an integer in Python.

A number with more digits is refused. The largest floating-point number is about 1.8e308: an integer
of 308 digits can be converted to it, one of 310 digits cannot. The time to parse a number grows
with the square of its digits.
"""
MAX_PARTS_OF_DOTTED_KEY = 16
"""Largest number of parts of a dotted key a.b.c in a file; a key with more is refused.

The TOML parser walks through all parts of every key: files with long dotted keys would take long.
"""

# The pattern matches the exponent of a number below ten millions, such as e+05.
_PATTERN_OF_EXPONENT_BELOW_TEN_MILLIONS = re.compile(r"e\+0[0-6]$")
# The pattern matches a zero with a sign, such as -0.00 or +0%.
_PATTERN_OF_SIGNED_ZERO = re.compile(r"[-+]0(\.0*)?%?")
# The pattern matches a number with too many digits; TOML allows _ between digits.
_PATTERN_OF_TOO_MANY_DIGITS = re.compile(rf"[0-9_]{{{MAX_CONSECUTIVE_DIGITS_OF_NUMBER + 1}}}")
# The smallest integer with too many digits.
_SMALLEST_TOO_LARGE_INTEGER = 10**MAX_CONSECUTIVE_DIGITS_OF_NUMBER
# The pattern matches one part of a dotted TOML key: a bare word, or a text in quotes.
_PATTERN_OF_TOML_KEY_PART = r"""(?:[A-Za-z0-9_-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""
# The pattern matches a dotted key with any number of parts, or a whole comment, so that words in a
# comment are not taken for keys.
_PATTERN_OF_TOML_KEY_OR_COMMENT = re.compile(
    rf"#[^\n]*+|{_PATTERN_OF_TOML_KEY_PART}(?:[ \t]*+\.[ \t]*+{_PATTERN_OF_TOML_KEY_PART})*+"
)


def printable_single_line(text: str, most: int = MAX_CHARACTERS_OF_ERROR_MESSAGE) -> str:
    """The text as one line; line breaks and other unprintable characters become escape sequences.

    A text of more than `most` characters loses its middle.
    """
    if len(text) > most:
        text = f"{text[: most // 2]} ... {text[-most // 2 :]}"
    return text if text.isprintable() else "".join(map(_printable_or_escaped_character, text))


def _printable_or_escaped_character(character: str) -> str:
    """The character, or its escape sequence if it cannot be printed."""
    return character if character.isprintable() else character.encode("unicode_escape").decode()


def command_text_without_folders(words: Sequence[str]) -> str:
    """The words of a command as one line of text, for a page of a report.

    Absolute paths are shortened to the file's name, because folders reveal the user's machine.
    """
    return printable_single_line(shlex.join(map(_command_word_with_path_cut_to_file_name, words)))


def _command_word_with_path_cut_to_file_name(word: str) -> str:
    """A word of a command, with an absolute path in it shortened to the file's name.

    The word is a path itself, or an option such as --output=/folder/name.
    """
    option, equals, path = word.rpartition("=") if word.startswith("-") else ("", "", word)
    name = PurePath(path).name if PurePath(path).is_absolute() else path
    return option + equals + name


def value_as_text(value: object) -> str:
    """A value as the text of an error line; an integer that Python cannot write is described."""
    try:
        return repr(value)
    except ValueError:
        # Python refuses to write integers of more than some 4300 digits, which takes it long.
        return f"(more than {sys.get_int_max_str_digits()} digits)"


def number_as_text(value: float, form: str) -> str:
    """A number as text for people: the text of `format(value, form)` with three changes.

    A space precedes the percent sign. A number that rounds to zero has no sign. With a format that
    ends in "g", a number below ten millions has no exponent.
    """
    text = format(value, form)
    if form.endswith("g") and _PATTERN_OF_EXPONENT_BELOW_TEN_MILLIONS.search(text):
        text = format(float(text), "+.0f" if text.startswith("+") else ".0f")
    text = text.lstrip("+-") if _PATTERN_OF_SIGNED_ZERO.fullmatch(text) else text
    return f"{text[:-1]} %" if text.endswith("%") else text


def error_text_in_percent(error: float) -> str:
    """A relative error or imbalance as text for people, in per cent with two digits: "0.058 %".

    From 100 % on all digits before the point are shown.
    """
    return f"{100 * error:.2g} %" if error < 0.995 else f"{100 * error:.0f} %"


def did_you_mean_hint(name: str, names: Iterable[str]) -> str:
    """The hint "(did you mean ...?)" for an error message about an unknown name.

    The hint shows the allowed name, out of `names`, that is most like the unknown `name`. It is
    empty if no allowed name is similar.
    """
    close = difflib.get_close_matches(name, list(names), n=1)
    return f" (did you mean {close[0]!r}?)" if close else ""


def check_numbers_have_few_digits(text: str) -> None:
    """Raise ValueError if the text has a number with too many consecutive digits.

    The limit is MAX_CONSECUTIVE_DIGITS_OF_NUMBER.
    """
    if _PATTERN_OF_TOO_MANY_DIGITS.search(text):
        raise ValueError(f"has a number of more than {MAX_CONSECUTIVE_DIGITS_OF_NUMBER} digits")


def check_integers_have_few_digits(where: str, value: object) -> None:
    """Raise ValueError if a value, or a value in its lists and tables, is too large an integer.

    An integer may have MAX_CONSECUTIVE_DIGITS_OF_NUMBER digits. `where` is the name of the value in
    the message.
    """
    if isinstance(value, int):
        if abs(value) >= _SMALLEST_TOO_LARGE_INTEGER:
            raise ValueError(
                f"{where} = {value_as_text(value)}: must have at most "
                f"{MAX_CONSECUTIVE_DIGITS_OF_NUMBER} digits"
            )
    elif isinstance(value, Mapping):
        for key, entry in value.items():
            check_integers_have_few_digits(f"{where}[{key!r}]", entry)
    elif isinstance(value, list | tuple):
        for entry in value:
            check_integers_have_few_digits(where, entry)
    elif str(getattr(value, "dtype", "")) == "object":
        # numpy keeps integers that fit into none of its types as objects of Python.
        check_integers_have_few_digits(where, value.tolist())  # type: ignore[attr-defined]


def check_toml_parses_quickly(text: str) -> None:
    """Raise ValueError if a TOML text has a number or a dotted key that takes long to parse.

    A number may have MAX_CONSECUTIVE_DIGITS_OF_NUMBER digits, and a key MAX_PARTS_OF_DOTTED_KEY
    parts.
    """
    check_numbers_have_few_digits(text)
    for match in _PATTERN_OF_TOML_KEY_OR_COMMENT.finditer(text):
        key = match.group()
        # Counting the parts exactly takes time, since a part in quotes may have dots itself. The
        # parts are therefore counted only if a key has many dots.
        if key.count(".") >= MAX_PARTS_OF_DOTTED_KEY and not key.startswith("#"):
            parts = len(re.findall(_PATTERN_OF_TOML_KEY_PART, key))
            if parts > MAX_PARTS_OF_DOTTED_KEY:
                raise ValueError(f"has a key of {parts} parts; allowed: {MAX_PARTS_OF_DOTTED_KEY}")
