"""Convert quantities as people write them ("150 mm", "2 kN") to numbers in SI units, and back.

All other modules of drumlin work with numbers in m, N, Pa and rad.
"""

import functools
import math
import numbers
import re
from typing import Any, cast

from drumlin.base.errors import BadInput
from drumlin.base.texts import MAX_CHARACTERS_OF_QUANTITY_TEXT
from drumlin.base.written_numbers import (
    NUMBER_PATTERN,
    number_from_text_as_people_write_it,
    text_with_plain_spaces_and_minus_signs,
)

# A quantity is a number and a unit. A unit consists of words, each with a power of one digit at
# most, joined by a blank, a point, a hyphen, * or /. The last denominator may be in brackets. Other
# texts are refused before pint, the package for units, reads them: pint would compute a unit such
# as m^9^9^9 for ever.
_PATTERN_OF_UNIT_WORD = r"[A-Za-zµμ°%][\wµμ°%]{0,30}\.?(?: ?(?:\^|\*\*) ?-?\d(?!\d))?"
_PATTERN_OF_UNIT = (
    rf"(?:1 ?/ ?)?{_PATTERN_OF_UNIT_WORD}(?:[ */-]{{0,3}}(?<![\wµμ°%]){_PATTERN_OF_UNIT_WORD})"
    rf"{{0,5}}"
    rf"(?: ?/ ?\( ?{_PATTERN_OF_UNIT_WORD}(?:[ *-]{{0,3}}(?<![\wµμ°%]){_PATTERN_OF_UNIT_WORD})"
    rf"{{0,5}} ?\))?"
)
_PATTERN_OF_QUANTITY = re.compile(
    rf"\s*({NUMBER_PATTERN})\s*({_PATTERN_OF_UNIT}|[\"'])\s*", re.ASCII
)
_PATTERN_OF_NUMBER_WITHOUT_UNIT = re.compile(rf"\s*{NUMBER_PATTERN}\s*", re.ASCII)
# Signs that word processors and keyboards put into units, each with the sign that pint reads.
_TRANSLATION_TO_PINT_UNIT_SIGNS = str.maketrans(
    {"·": "*", "⋅": "*", "∙": "*", "×": "*", "º": "°", "˚": "°", "″": '"', "′": "'"}
)
_PATTERN_OF_SUPERSCRIPT_DIGIT = re.compile(r"⁻?[⁰¹²³⁴⁵⁶⁷⁸⁹]")
_TRANSLATION_OF_SUPERSCRIPTS_TO_DIGITS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")

LARGEST_ALLOWED_NUMBER_IN_SI = 1e30
"""Largest number of a brake in SI units; a larger number is refused.

No brake needs a larger number, and products of such numbers stay finite.
"""

SMALLEST_NONZERO_NUMBER_IN_SI = 1e-30
"""Smallest absolute value of a number of a brake in SI units; a smaller number is set to 0.

The square of a number below some 1e-162 is 0 in floating point although the number is not 0.
"""

# Examples of quantities in error messages, by SI unit.
EXAMPLE_OF_QUANTITY_BY_SI_UNIT = {
    "m": "8 mm",
    "N": "2 kN",
    "Pa": "300 MPa",
    "rad": "55 deg",
    "N m": "400 N m",
    "N m^2": "12 MN m^2",
    "1/Pa": "1e-5 mm^3/(N m)",
    "m^2": "194 cm^2",
    "N/m": "20 N/mm",
    "kg": "1.5 kg",
    "m/s^2": "9.81 m/s^2",
    "rad/s": "1500 rpm",
    "m/s": "12 m/s",
    "K": "180 K",
    "1/K": "12e-6 1/K",
}
# Names of quantities in error messages, by SI unit.
NAME_OF_QUANTITY_BY_SI_UNIT = {
    "m": "a length",
    "N": "a force",
    "Pa": "a stress",
    "rad": "an angle",
    "N m": "a torque",
    "N m^2": "a bending stiffness",
    "1/Pa": "a wear coefficient",
    "m^2": "an area",
    "N/m": "a spring rate",
    "kg": "a mass",
    "m/s^2": "an acceleration",
    "rad/s": "an angular speed",
    "m/s": "a speed",
    "K": "a temperature rise",
    "1/K": "a coefficient of thermal expansion",
}
# Factors that convert the usual units to SI, by SI unit. With them most files are read without the
# package pint, which takes long to load. The tests compare them with the factors of pint.
FACTORS_OF_COMMON_UNITS_BY_SI_UNIT = {
    "m": {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254},
    "N": {"N": 1.0, "kN": 1e3, "lbf": 4.4482216152605},
    "Pa": {"Pa": 1.0, "MPa": 1e6, "GPa": 1e9, "N/mm^2": 1e6, "bar": 1e5, "psi": 6894.757293168361},
    "rad": {"rad": 1.0, "deg": math.pi / 180, "°": math.pi / 180},
    "N m": {"N m": 1.0, "Nm": 1.0},
    "m^2": {"m^2": 1.0, "cm^2": 1e-4, "mm^2": 1e-6},
    "N/m": {"N/m": 1.0, "N/mm": 1e3},
    "kg": {"kg": 1.0, "g": 1e-3},
    "m/s^2": {"m/s^2": 1.0},
    "rad/s": {"rad/s": 1.0, "rpm": math.pi / 30},
    "m/s": {"m/s": 1.0, "km/h": 1 / 3.6},
    # Every temperature of a brake file is a difference, so that 180 degC is a rise by 180 K.
    "K": {"K": 1.0, "degC": 1.0, "°C": 1.0, "degF": 5 / 9, "°F": 5 / 9},
    "1/K": {"1/K": 1.0, "1/degC": 1.0, "1/°C": 1.0, "um/(m K)": 1e-6},
}

_RADIANS_PER_SECOND_BY_UNIT_OF_REVOLUTIONS = {
    "1/min": math.pi / 30,
    "min^-1": math.pi / 30,
    "U/min": math.pi / 30,
    "rev/min": math.pi / 30,
    "Hz": 2 * math.pi,
}
"""Angular speeds [rad/s] of one revolution per minute or second, by units without blanks.

European data sheets state rotational speeds in these units (ISO 80000-3, rotational frequency). The
package pint would take them for angular speeds of one radian. The unit 1/s is refused, because it
may be a revolution or a radian per second.
"""

PRINTED_UNIT_AND_FACTOR_BY_SI_UNIT = {
    "m": ("mm", 1e3),
    "rad": ("deg", math.degrees(1)),
    "Pa": ("MPa", 1e-6),
    "N/m": ("N/mm", 1e-3),
}
"""Units in which quantities are printed, by SI unit, each with the factor from the SI unit."""

# Definitions of units that pint does not know or takes for something else. In pint Nm is a unit of
# textile fibres, and in some versions of pint a pond is 1 kgf.
_PINT_DEFINITIONS_OF_FURTHER_UNITS = (
    "newton_meter = newton * meter = Nm",
    "newton_centimeter = newton * centimeter = Ncm",
    "newton_millimeter = newton * millimeter = Nmm",
    "pond = 9.80665e-3 * newton",
    "kilogram_weight = 9.80665 * newton = kp",
)
# Units that pint reads as a mass or an angle, each with the force or length that may be meant.
_SECOND_MEANING_BY_UNIT_WORD = {"lb": "lbf", "lbs": "lbf", "mil": "thou", "mils": "thou"}


@functools.cache
def _pint_unit_registry() -> Any:
    """The registry of units of the package pint, with drumlin's further units.

    pint takes 0.25 s to load. drumlin loads pint only for a unit that is not in
    FACTORS_OF_COMMON_UNITS_BY_SI_UNIT.
    """
    import pint  # noqa: PLC0415

    registry = pint.UnitRegistry(on_redefinition="ignore")
    for definition in _PINT_DEFINITIONS_OF_FURTHER_UNITS:
        registry.define(definition)
    return registry


@functools.cache
def _si_factor_of_unit(unit: str, si: str) -> float:
    """Factor that converts a number in `unit` to the SI unit `si`.

    Raises ValueError if `unit` is unknown or has another dimension than `si`.
    """
    common = FACTORS_OF_COMMON_UNITS_BY_SI_UNIT.get(si, {}).get(unit.strip())
    if common is None and si == "rad/s":
        common = _RADIANS_PER_SECOND_BY_UNIT_OF_REVOLUTIONS.get(
            unit.replace(" ", "").replace("**", "^")
        )
    return _si_factor_of_unit_by_pint(unit.strip(), si) if common is None else common


def _si_factor_of_unit_by_pint(unit: str, si: str) -> float:
    """Factor that converts a number in `unit` to the SI unit `si`, found by the package pint.

    If the text of a unit can be read in several ways, the first reading with the dimension of `si`
    counts. Raises ValueError if `unit` is unknown or has another dimension than `si`.
    """
    # "Grad" is a degree in German and a gon in English, and pint would read Grad as gigaradian.
    if si == "rad" and unit.casefold() == "grad":
        raise ValueError(f"{unit!r} may be degrees or gons; write 'deg' or 'gon'")
    readings = _possible_meanings_of_unit_text(unit, si)
    # A reading of the unit that pint does not know gives None.
    found = [_si_factor_and_dimension_by_pint(reading) for reading in readings]
    needed = _si_factor_and_dimension_by_pint(si)
    assert needed is not None  # the SI units of this module are known
    for factor_and_dimension in found:
        if factor_and_dimension is not None and factor_and_dimension[1] == needed[1]:
            return factor_and_dimension[0] / needed[0]
    wanted = f"{NAME_OF_QUANTITY_BY_SI_UNIT[si]} such as {EXAMPLE_OF_QUANTITY_BY_SI_UNIT[si]!r}"
    if found[0] is None:
        raise ValueError(
            f"unknown unit {unit!r}{_hint_about_wrong_capitals_in_unit(unit, si)}; allowed: "
            f"{wanted}"
        )
    # A mass in place of a force is refused: the key or the unit may be wrong.
    weight = _si_factor_and_dimension_by_pint(re.sub(r"\bkg\b", "kgf", readings[0]))
    if weight is not None and weight[1] == needed[1]:
        raise ValueError(f"must be {wanted}; kg is a mass, kgf the weight of this mass")
    raise ValueError(f"must be {wanted}")


def _si_factor_and_dimension_by_pint(unit: str) -> tuple[float, Any] | None:
    """The factor from `unit` to pint's base units, and the base units; None for an unknown unit."""
    registry = _pint_unit_registry()
    try:
        factor, base = registry.get_base_units(registry.parse_units(unit))
    # pint raises exceptions of many classes for a unit that it cannot read.
    except Exception:
        return None
    return float(factor), base


def _possible_meanings_of_unit_text(unit: str, si: str) -> list[str]:
    """The texts, in the notation of pint, that a unit may stand for, the most likely one first.

    Of these readings at most one has the dimension of the SI unit `si`.
    """
    if unit in {'"', "'"}:
        # The signs " and ' are inches and feet of a length, but seconds and minutes of an angle.
        return [{'"': "in", "'": "ft"}[unit]] if si == "m" else [unit]
    # A point or a hyphen between two words is a product, and a digit after a length is its power.
    plain = re.sub(r"(?<=[A-Za-z])[.-]+", " ", unit)
    plain = re.sub(r"(?<![A-Za-z])(mm|cm|dm|m|in|ft)([2-4])(?!\w)", r"\1^\2", plain)
    # In "Nm^2" people mean N m^2, whereas pint would square the whole unit Nm.
    squared = re.sub(r"N(mm|cm|m)(?= ?(?:\^|\*\*))", r"N \1", plain)
    readings = [plain, squared, re.sub(r"[A-Za-z]+", _second_meaning_of_unit_word, plain)]
    # In "mm^3/N m" both N and m may be meant to be in the denominator.
    above, line, below = plain.partition("/")
    if line and not set("/()") & set(below):
        readings.append(f"{above}/({below})")
    return list(dict.fromkeys(readings))


def _second_meaning_of_unit_word(match: re.Match[str]) -> str:
    """The second meaning of a word of a unit, or the word itself if it has only one meaning."""
    return _SECOND_MEANING_BY_UNIT_WORD.get(match.group(), match.group())


def _hint_about_wrong_capitals_in_unit(unit: str, si: str) -> str:
    """The hint "(did you mean ...?)" for a unit whose capital letters are wrong, or ""."""
    for known in FACTORS_OF_COMMON_UNITS_BY_SI_UNIT.get(si, {}):
        if known.casefold() == unit.casefold():
            return f" (did you mean {known!r}?)"
    return ""


def quantity_in_si(value: object, si: str, *, unit_required: bool) -> float:
    """Convert a quantity to a number in SI units.

    Parameters
    ----------
    value : a text with a unit, such as "8 mm", or a number in SI units
    si : the SI unit
    unit_required : whether a number without unit is refused

    Raises
    ------
    ValueError
        for another value, with a line that says what is allowed
    """
    if isinstance(value, str):
        number = _quantity_text_in_si(value, si)
    elif isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise ValueError(
            f"must be {NAME_OF_QUANTITY_BY_SI_UNIT[si]} such as "
            f"{EXAMPLE_OF_QUANTITY_BY_SI_UNIT[si]!r}"
        )
    elif unit_required:
        raise ValueError(
            f"has no unit; write {NAME_OF_QUANTITY_BY_SI_UNIT[si]} such as "
            f"{EXAMPLE_OF_QUANTITY_BY_SI_UNIT[si]!r}"
        )
    else:
        # Real numbers of all types, as of numpy, compare as floats do.
        number = cast("float", value)
    # For nan the comparison is false, so that nan is refused. Python compares integers of any size
    # exactly.
    if not abs(number) <= LARGEST_ALLOWED_NUMBER_IN_SI:
        raise ValueError(f"must be finite and at most {LARGEST_ALLOWED_NUMBER_IN_SI:g} in SI units")
    return float(number) if abs(number) >= SMALLEST_NONZERO_NUMBER_IN_SI else 0.0


def _quantity_text_in_si(text: str, si: str) -> float:
    """Convert the text of a quantity to a number in SI units. Raises ValueError for other texts."""
    name = NAME_OF_QUANTITY_BY_SI_UNIT[si]
    if len(text) > MAX_CHARACTERS_OF_QUANTITY_TEXT:
        raise ValueError(
            f"must be {name} in at most {MAX_CHARACTERS_OF_QUANTITY_TEXT} characters, "
            f"such as {EXAMPLE_OF_QUANTITY_BY_SI_UNIT[si]!r}"
        )
    plain = _quantity_text_with_keyboard_signs(text)
    # The text "3e8" would otherwise be the number 3 with the unit e8.
    if _PATTERN_OF_NUMBER_WITHOUT_UNIT.fullmatch(plain):
        raise ValueError(
            f"has no unit; write {name} such as {EXAMPLE_OF_QUANTITY_BY_SI_UNIT[si]!r}"
        )
    match = _PATTERN_OF_QUANTITY.fullmatch(plain)
    if match is None:
        raise ValueError(
            f"must be {name}: a number and its unit, such as {EXAMPLE_OF_QUANTITY_BY_SI_UNIT[si]!r}"
        )
    return number_from_text_as_people_write_it(match.group(1)) * _si_factor_of_unit(
        match.group(2), si
    )


def _quantity_text_with_keyboard_signs(text: str) -> str:
    """The text of a quantity, with typographic signs replaced by those of a plain keyboard."""
    if text.isascii():
        return text
    plain = text_with_plain_spaces_and_minus_signs(text).translate(_TRANSLATION_TO_PINT_UNIT_SIGNS)
    return _PATTERN_OF_SUPERSCRIPT_DIGIT.sub(
        lambda power: f"^{power.group().translate(_TRANSLATION_OF_SUPERSCRIPTS_TO_DIGITS)}", plain
    )


def number_in_si_from_command_option_text(key: str, text: str, si: str) -> float:
    """Convert the text of a command's option to a number in SI units.

    Raises BadInput for a text that is no such quantity; `key` is the option in the message.
    """
    try:
        return quantity_in_si(text, si, unit_required=True)
    except ValueError as error:
        raise BadInput(f"{key} = {text!r}: {error}") from error


def length_as_text_in_mm(length: float) -> str:
    """A length [m] as text in mm."""
    return f"{length * 1e3:.6g} mm"


def angle_as_text_in_degrees(angle: float) -> str:
    """An angle [rad] as text in degrees."""
    return f"{math.degrees(angle):.6g} deg"


def quantity_with_usual_unit(value: float, si: str) -> str:
    """A quantity as text with six digits and a usual unit, such as "12.5 mm"."""
    unit, per_si = PRINTED_UNIT_AND_FACTOR_BY_SI_UNIT.get(si, (si, 1.0))
    return f"{value * per_si:.6g} {unit}".rstrip()
