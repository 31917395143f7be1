"""Convert quantities as people write them ("150 mm", "2 kN") to numbers in SI units, and back.

All other modules of drumlin work with numbers in m, N, Pa and rad.
"""

import functools
import math
import re
from typing import Any

from drumlin.base.errors import BadInput
from drumlin.base.texts import LONGEST_QUANTITY

# A quantity is a number and a unit. A unit consists of words, each with a power of one digit at
# most, joined by a blank, * or /. The last denominator may be in brackets. Other texts are refused
# before pint sees them, because pint would evaluate a unit such as m^9^9^9 for ever.
_WORD = r"[A-Za-zµμ°%][\wµμ°%]{0,30}(?: ?(?:\^|\*\*) ?-?\d(?!\d))?"
_UNIT = (
    rf"(?:1 ?/ ?)?{_WORD}(?:[ */]{{1,3}}{_WORD}){{0,5}}"
    rf"(?: ?/ ?\( ?{_WORD}(?:[ *]{{1,3}}{_WORD}){{0,5}} ?\))?"
)
_QUANTITY = re.compile(
    rf"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d{{1,3}})?)\s*({_UNIT})\s*", re.ASCII
)

LARGEST_NUMBER_SI = 1e30
"""Largest number of a brake in SI units; a larger number is refused.

No brake needs a larger number, and products of such numbers stay finite.
"""

SMALLEST = 1e-30
"""Smallest absolute value of a number of a brake in SI units; a smaller number is set to 0.

The square of a much smaller number would be rounded to 0 although the number is not 0.
"""

# Error messages show these examples of a quantity, by its SI unit.
EXAMPLES = {
    "m": "8 mm",
    "N": "2 kN",
    "Pa": "300 MPa",
    "rad": "55 deg",
    "N m": "400 N m",
    "N m^2": "12 MN m^2",
    "1/Pa": "1e-5 mm^3/(N m)",
}
# Error messages call a quantity by these names, by its SI unit.
QUANTITY_NAMES = {
    "m": "a length",
    "N": "a force",
    "Pa": "a stress",
    "rad": "an angle",
    "N m": "a torque",
    "N m^2": "a bending stiffness",
    "1/Pa": "a wear coefficient",
}
# These factors convert the usual units to SI, so that most files are read without loading pint. The
# tests compare them with the factors of pint.
COMMON = {
    "m": {"m": 1.0, "mm": 1e-3},
    "N": {"N": 1.0, "kN": 1e3},
    "Pa": {"Pa": 1.0, "MPa": 1e6, "GPa": 1e9},
    "rad": {"rad": 1.0, "deg": math.pi / 180},
}


@functools.cache
def _pint_unit_registry() -> Any:
    """The units that the package pint knows.

    pint takes 0.25 s to load. It is loaded only for a unit that is not in COMMON.
    """
    import pint  # noqa: PLC0415

    return pint.UnitRegistry()


@functools.cache
def _si_factor_of_unit(unit: str, si: str) -> float:
    """Factor that converts a number in `unit` to the SI unit `si`.

    Raises ValueError if `unit` is unknown or has another dimension than `si`.
    """
    common = COMMON.get(si, {}).get(unit.strip())
    return _si_factor_of_unit_by_pint(unit, si) if common is None else common


def _si_factor_of_unit_by_pint(unit: str, si: str) -> float:
    """Factor that converts a number in `unit` to the SI unit `si`, as the package pint knows it.

    Raises ValueError if `unit` is unknown or has another dimension than `si`.
    """
    registry = _pint_unit_registry()
    try:
        factor, base = registry.get_base_units(registry.parse_units(unit.strip()))
        si_factor, si_base = registry.get_base_units(si)
    # pint raises exceptions of many classes for a unit that it cannot read.
    except Exception as error:
        raise ValueError(
            f"unknown unit {unit.strip()!r}; allowed: {QUANTITY_NAMES[si]} such as {EXAMPLES[si]!r}"
        ) from error
    if base != si_base:
        raise ValueError(f"must be {QUANTITY_NAMES[si]} such as {EXAMPLES[si]!r}")
    return float(factor / si_factor)


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
    # A text is split into its number and its unit.
    if isinstance(value, str):
        if len(value) > LONGEST_QUANTITY:
            raise ValueError(
                f"must be {QUANTITY_NAMES[si]} in at most {LONGEST_QUANTITY} characters, "
                f"such as {EXAMPLES[si]!r}"
            )
        match = _QUANTITY.fullmatch(value)
        if match is None:
            raise ValueError(
                f"must be {QUANTITY_NAMES[si]}: a number and its unit, such as {EXAMPLES[si]!r}"
            )
        number: float = float(match.group(1)) * _si_factor_of_unit(match.group(2), si)
    elif isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"must be {QUANTITY_NAMES[si]} such as {EXAMPLES[si]!r}")
    elif unit_required:
        raise ValueError(f"has no unit; write {QUANTITY_NAMES[si]} such as {EXAMPLES[si]!r}")
    else:
        number = value
    # For nan the comparison is false, so that nan is refused. Python compares integers of any size
    # exactly.
    if not abs(number) <= LARGEST_NUMBER_SI:
        raise ValueError(f"must be finite and at most {LARGEST_NUMBER_SI:g} in SI units")
    return float(number) if abs(number) >= SMALLEST else 0.0


def option_value_in_si(key: str, text: str, si: str) -> float:
    """Convert the text of a command's option to a number in SI units.

    Raises BadInput for a text that is no such quantity; `key` is the option in the message.
    """
    try:
        return quantity_in_si(text, si, unit_required=True)
    except ValueError as error:
        raise BadInput(f"{key} = {text!r}: {error}") from error


def mm_text(length: float) -> str:
    """A length [m] as text in mm."""
    return f"{length * 1e3:.6g} mm"


def deg_text(angle: float) -> str:
    """An angle [rad] as text in degrees."""
    return f"{math.degrees(angle):.6g} deg"
