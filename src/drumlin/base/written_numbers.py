"""Read numbers as people write them: decimal commas, grouped digits, fractions, per cent.

Word processors, spreadsheets and web pages also put typographic spaces and minus signs into a
number. A number that can be read in two ways is refused.
"""

import re

from drumlin.base.texts import MAX_CHARACTERS_OF_QUANTITY_TEXT

_TYPOGRAPHIC_SPACES = (
    "\t\u00a0\u2000\u2001\u2002\u2003\u2004\u2005\u2006\u2007\u2008\u2009\u200a\u202f\u205f"
)
_TYPOGRAPHIC_MINUS_SIGNS = "\u2010\u2011\u2012\u2013\u2212\ufe63\uff0d"
_TRANSLATION_TO_PLAIN_SPACES_AND_MINUS = str.maketrans(
    _TYPOGRAPHIC_SPACES + _TYPOGRAPHIC_MINUS_SIGNS,
    " " * len(_TYPOGRAPHIC_SPACES) + "-" * len(_TYPOGRAPHIC_MINUS_SIGNS),
)

NUMBER_PATTERN = r"[-+]? ?(?:(?:\d+ )?\d+ ?/ ?\d+|[\d.,](?:[\d., ]*[\d.,])?(?:[eE][-+]?\d{1,3})?)"
"""Pattern of a text that may be a number; it has no capturing groups, for use in other patterns.

The text must have plain spaces and minus signs, see `text_with_plain_spaces_and_minus_signs`.
`number_from_text_as_people_write_it` then checks the digits.
"""
_PATTERN_OF_PLAIN_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d{1,3})?", re.ASCII)
_PATTERN_OF_NUMBER_BETWEEN_SPACES = re.compile(rf"\s*({NUMBER_PATTERN})\s*", re.ASCII)
_PATTERN_OF_FRACTION = re.compile(r"(?:(\d+) )?(\d+) ?/ ?(\d+)", re.ASCII)
# The pattern matches digits with at most one point, which is the decimal sign: files of drumlin
# have always had decimal points. In a table with decimal commas such a number is checked further.
_PATTERN_OF_DIGITS_WITH_AT_MOST_ONE_POINT = re.compile(r"\d+\.?\d*|\.\d+", re.ASCII)
_PATTERN_OF_NUMBER_WITH_DECIMAL_COMMA = re.compile(
    r"(?:\d+|\d{1,3}(?:\.\d{3})+|\d{1,3}(?: \d{3})+|),\d+", re.ASCII
)
_PATTERN_OF_NUMBER_IN_GROUPS_OF_THREE = re.compile(
    r"\d{1,3}(?: \d{3})+(?:\.\d+)?|\d{1,3}(?:,\d{3})+(?:\.\d+)?|\d{1,3}(?:\.\d{3}){2,}", re.ASCII
)
# The pattern matches a number such as 1,500, which is 1.5 to some readers and 1500 to others.
_PATTERN_OF_NUMBER_WITH_AMBIGUOUS_COMMA = re.compile(r"[1-9]\d{0,2},\d{3}", re.ASCII)


def text_with_plain_spaces_and_minus_signs(text: str) -> str:
    """The text with a blank for each typographic space, and a hyphen for each minus sign."""
    return (
        text
        if text.isascii() and "\t" not in text
        else text.translate(_TRANSLATION_TO_PLAIN_SPACES_AND_MINUS)
    )


def number_from_text_as_people_write_it(text: str, decimal_sign: str = "") -> float:
    """The number that a text gives, without a unit.

    Parameters
    ----------
    text : such as "150.5", "150,5", "1 500", "1.500,5", "3/4" or "-1e-5"
    decimal_sign : "," or ".", the decimal sign of other numbers in the same table; "" if unknown

    Raises
    ------
    ValueError
        for a text that is no number, or a number with two readings, in words for the user
    """
    # Most numbers are plain and need no further check.
    if decimal_sign != "," and _PATTERN_OF_PLAIN_NUMBER.fullmatch(text):
        return float(text)
    match = _PATTERN_OF_NUMBER_BETWEEN_SPACES.fullmatch(
        text_with_plain_spaces_and_minus_signs(text)
    )
    if match is None or len(text) > MAX_CHARACTERS_OF_QUANTITY_TEXT:
        raise ValueError("must be a number")
    sign = -1.0 if match.group(1).startswith("-") else 1.0
    digits, _, exponent = match.group(1).lstrip("-+ ").lower().partition("e")
    fraction = _PATTERN_OF_FRACTION.fullmatch(digits)
    if fraction is not None:
        whole, above, below = (int(part or 0) for part in fraction.groups())
        if below == 0:
            raise ValueError("must be a number: its fraction has the denominator 0")
        return sign * (whole + above / below)
    return sign * float(
        f"{_digits_with_decimal_point_and_without_grouping(digits, decimal_sign)}e{exponent or 0}"
    )


def decimal_sign_proved_by_number_text(text: str) -> str:
    """The decimal sign that a text proves, "," or "."; "" if the text proves neither of them."""
    digits = text_with_plain_spaces_and_minus_signs(text).strip().lstrip("-+ ")
    digits = re.sub(r"[eE][-+]?\d{1,3}$", "", digits)
    if "." in digits and _PATTERN_OF_DIGITS_WITH_AT_MOST_ONE_POINT.fullmatch(digits):
        return "."
    if _PATTERN_OF_NUMBER_WITH_AMBIGUOUS_COMMA.fullmatch(digits):
        return ""
    if _PATTERN_OF_NUMBER_WITH_DECIMAL_COMMA.fullmatch(digits):
        return ","
    return "." if "," in digits and _PATTERN_OF_NUMBER_IN_GROUPS_OF_THREE.fullmatch(digits) else ""


def _digits_with_decimal_point_and_without_grouping(digits: str, decimal_sign: str) -> str:
    """The digits of a number with a decimal point, and without the signs between groups of three.

    `decimal_sign` is "," or "." if it is known, else "". Raises ValueError for digits that can be
    read as two numbers.
    """
    if _PATTERN_OF_DIGITS_WITH_AT_MOST_ONE_POINT.fullmatch(digits) and not (
        decimal_sign == "," and "." in digits
    ):
        return digits
    if _PATTERN_OF_NUMBER_WITH_AMBIGUOUS_COMMA.fullmatch(digits) and not decimal_sign:
        raise ValueError(
            f"must have a decimal point: {digits} may be {digits.replace(',', '.')} "
            f"or {digits.replace(',', '')}"
        )
    if decimal_sign != "." and _PATTERN_OF_NUMBER_WITH_DECIMAL_COMMA.fullmatch(digits):
        return digits.replace(" ", "").replace(".", "").replace(",", ".")
    if _PATTERN_OF_NUMBER_IN_GROUPS_OF_THREE.fullmatch(digits):
        # Several points separate groups of digits. One point alone is the decimal sign.
        joined = digits.replace(" ", "").replace(",", "")
        return joined.replace(".", "") if joined.count(".") > 1 else joined
    raise ValueError("must be a number with a decimal point")


def number_without_unit_from_text(value: object) -> object:
    """The number without a unit that a text such as "0,3" or "30 %" stands for.

    Other values, and texts that give no number, are returned unchanged. Raises ValueError for a
    number that has two readings.
    """
    if not isinstance(value, str) or len(value) > MAX_CHARACTERS_OF_QUANTITY_TEXT:
        return value
    plain = text_with_plain_spaces_and_minus_signs(value).strip()
    if _PATTERN_OF_NUMBER_BETWEEN_SPACES.fullmatch(plain.removesuffix("%")) is None:
        return value
    return number_from_text_as_people_write_it(plain.removesuffix("%")) / (
        100 if plain.endswith("%") else 1
    )
