"""Convert quantities as people write them ("150 mm", "2 kN") to SI numbers, and back.

Inside drumlin every number is in m, N, Pa and rad. Only this module converts.
"""

import functools
import math
import re
from typing import Any

from drumlin.base.errors import BadInput
from drumlin.base.texts import LONGEST_QUANTITY

# A quantity is a number and a unit. A unit is words with one-digit powers, joined by blank, * or /;
# the last denominator may be in brackets. Nothing else reaches pint, which would evaluate m^9^9^9
# for ever.
_WORD = r"[A-Za-zµμ°%][\wµμ°%]{0,30}(?: ?(?:\^|\*\*) ?-?\d(?!\d))?"
_UNIT = (
    rf"(?:1 ?/ ?)?{_WORD}(?:[ */]{{1,3}}{_WORD}){{0,5}}"
    rf"(?: ?/ ?\( ?{_WORD}(?:[ *]{{1,3}}{_WORD}){{0,5}} ?\))?"
)
_QUANTITY = re.compile(
    rf"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d{{1,3}})?)\s*({_UNIT})\s*", re.ASCII
)

LARGEST_NUMBER_SI = 1e30
"""Largest number of a brake in SI units. No brake needs more, and products stay finite."""

SMALLEST = 1e-30
"""Smallest size of a number of a brake in SI units; a smaller number counts as 0.

Squares of smaller numbers would vanish while the numbers would not.
"""

EXAMPLES = {
    "m": "8 mm",
    "N": "2 kN",
    "Pa": "300 MPa",
    "rad": "55 deg",
    "N m": "400 N m",
    "N m^2": "12 MN m^2",
    "1/Pa": "1e-5 mm^3/(N m)",
}
QUANTITY_NAMES = {
    "m": "a length",
    "N": "a force",
    "Pa": "a stress",
    "rad": "an angle",
    "N m": "a torque",
    "N m^2": "a bending stiffness",
    "1/Pa": "a wear coefficient",
}
# Factors to SI of the units of most files, which then need no pint. The tests compare the factors
# with pint's.
COMMON = {
    "m": {"m": 1.0, "mm": 1e-3},
    "N": {"N": 1.0, "kN": 1e3},
    "Pa": {"Pa": 1.0, "MPa": 1e6, "GPa": 1e9},
    "rad": {"rad": 1.0, "deg": math.pi / 180},
}


@functools.cache
def _registry() -> Any:
    """The units of pint. It takes 0.25 s to load, and only files with other units need it."""
    import pint  # noqa: PLC0415

    return pint.UnitRegistry()


@functools.cache
def _factor(unit: str, si: str) -> float:
    """Factor from `unit` to the SI unit `si`; raises ValueError if it measures something else."""
    common = COMMON.get(si, {}).get(unit.strip())
    return _factor_by_pint(unit, si) if common is None else common


def _factor_by_pint(unit: str, si: str) -> float:
    """The factor from `unit` to the SI unit `si`, from pint; ValueError as `_factor` raises."""
    registry = _registry()
    try:
        factor, base = registry.get_base_units(registry.parse_units(unit.strip()))
        si_factor, si_base = registry.get_base_units(si)
    # pint raises errors of many kinds: undefined unit, token errors and others.
    except Exception as error:
        raise ValueError(
            f"unknown unit {unit.strip()!r}; allowed: {QUANTITY_NAMES[si]} such as {EXAMPLES[si]!r}"
        ) from error
    if base != si_base:
        raise ValueError(f"must be {QUANTITY_NAMES[si]} such as {EXAMPLES[si]!r}")
    return float(factor / si_factor)


def to_si(value: object, si: str, *, unit_required: bool) -> float:
    """Convert a quantity to a number in SI.

    Parameters
    ----------
    value : text with a unit, or a number in SI
    si : the SI unit
    unit_required : whether a number without unit is refused

    Raises
    ------
    ValueError
        with a line that says what is allowed
    """
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
        number: float = float(match.group(1)) * _factor(match.group(2), si)
    elif isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"must be {QUANTITY_NAMES[si]} such as {EXAMPLES[si]!r}")
    elif unit_required:
        raise ValueError(f"has no unit; write {QUANTITY_NAMES[si]} such as {EXAMPLES[si]!r}")
    else:
        number = value
    # The comparison is false for nan, and exact for an integer that is too large for a float.
    if not abs(number) <= LARGEST_NUMBER_SI:
        raise ValueError(f"must be finite and at most {LARGEST_NUMBER_SI:g} in SI units")
    return float(number) if abs(number) >= SMALLEST else 0.0


def quantity(key: str, text: str, si: str) -> float:
    """Convert the text of an option to a number in SI; raises BadInput with one line."""
    try:
        return to_si(text, si, unit_required=True)
    except ValueError as error:
        raise BadInput(f"{key} = {text!r}: {error}") from error


def mm(length: float) -> str:
    """A length [m] as text in mm."""
    return f"{length * 1e3:.6g} mm"


def deg(angle: float) -> str:
    """An angle [rad] as text in degrees."""
    return f"{math.degrees(angle):.6g} deg"
