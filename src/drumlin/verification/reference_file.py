"""JSON files of reference values: write a file, read and check it, find the file of a brake."""

import json
import math
import re
import tomllib
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.base.files import read_text, write_text
from drumlin.base.texts import check_numbers_have_few_digits, check_toml_parses_quickly
from drumlin.brake.surface import FRICTION_SURFACE_OF_DRUM, FRICTION_SURFACE_OF_PLANE
from drumlin.brake.units import LARGEST_ALLOWED_NUMBER_IN_SI
from drumlin.response.response import which_angles_are_outside_end_zones
from drumlin.verification.reference import (
    ReferenceValuesOfBrake,
    ReferenceValuesOfShoe,
    UncertainValue,
)

NAME_AND_VERSION_OF_REFERENCE_FILE_FORMAT = "drumlin reference values, 1"
"""Name and version of the file format. A file has this text under its first key, "format"."""

SIGNIFICANT_DIGITS_IN_REFERENCE_FILE = 10
"""Number of significant digits of each number in a file; the last digits are not certain."""

_NUMBER_LIST_PATTERN = re.compile(r"\[[-+0-9.eE,\s]*\]")
"""Pattern of a list of numbers in a JSON text."""

LARGEST_BYTES_OF_REFERENCE_FILE = 10_000_000
"""Size [bytes] above which a file is refused unread.

A file of reference values has fewer than 100 000 bytes."""

FILE_KEYS_OF_QUANTITIES_WITH_UNCERTAINTY = (
    "torque",
    "contact_force",
    "hinge_reaction",
    "peak_pressure",
    "contact_arcs",
)
"""Keys, in a file, of the quantities of a shoe that are stored with an uncertainty."""

UNITS_IN_DRUM_BRAKE_REFERENCE_FILE_BY_KEY = {
    "torque": "N m",
    "contact_force": "N",
    "hinge_reaction": "N",
    "peak_pressure": "Pa",
    "contact_arcs": "rad",
    "edge": "rad",
    "theta": "rad",
    "pressure": "Pa",
    "pressure_uncertainty": "Pa",
}
"""Unit of each quantity by its key, in a file of a brake on a drum."""

UNITS_BY_KEY_THAT_DIFFER_ON_DRUM_AND_PLANE = {
    surface: {
        "torque": surface.unit_of_torque_or_brake_force,
        **dict.fromkeys(("contact_arcs", "edge", "theta"), surface.coordinate_unit),
    }
    for surface in (FRICTION_SURFACE_OF_DRUM, FRICTION_SURFACE_OF_PLANE)
}
"""For each friction surface, drum or plane, the units by key that differ between the two."""

EXCEPTIONS_IF_FILE_HOLDS_NO_REFERENCE_VALUES = (
    ValueError,
    LookupError,
    TypeError,
    AttributeError,
    RecursionError,
    OverflowError,
)
"""Errors that are raised when a file is read as reference values but holds other data."""


def _numbers_rounded_to_significant_digits(
    value: Any, digits: int = SIGNIFICANT_DIGITS_IN_REFERENCE_FILE
) -> Any:
    """The number, or nested lists of numbers, rounded to a number of significant digits."""
    if isinstance(value, list):
        return [_numbers_rounded_to_significant_digits(each, digits) for each in value]
    return float(f"{value:.{digits}g}")


def _uncertain_value_as_json_data(sure: UncertainValue) -> dict[str, Any]:
    """A value and its uncertainty as a dictionary for JSON; an infinite uncertainty is null."""
    uncertainty = None
    if math.isfinite(sure.uncertainty):
        uncertainty = _numbers_rounded_to_significant_digits(sure.uncertainty, 3)
    return {"value": _numbers_rounded_to_significant_digits(sure.value), "uncertainty": uncertainty}


def reference_values_as_json_data(found: ReferenceValuesOfBrake) -> dict[str, Any]:
    """The reference values of a brake as a dictionary for JSON."""
    return {
        "format": NAME_AND_VERSION_OF_REFERENCE_FILE_FORMAT,
        "title": found.title,
        "method": found.method,
        "units": UNITS_IN_DRUM_BRAKE_REFERENCE_FILE_BY_KEY
        | UNITS_BY_KEY_THAT_DIFFER_ON_DRUM_AND_PLANE[found.surface],
        "command": found.command,
        "versions": found.versions,
        "torque": _uncertain_value_as_json_data(found.torque),
        "shoes": list(map(_shoe_reference_as_json_data, found.shoes)),
        "brake_file": found.text,
    }


def _shoe_reference_as_json_data(shoe: ReferenceValuesOfShoe) -> dict[str, Any]:
    """The reference values of a shoe as a dictionary for JSON."""
    return {
        "name": shoe.name,
        **{
            key: _uncertain_value_as_json_data(getattr(shoe, key))
            for key in FILE_KEYS_OF_QUANTITIES_WITH_UNCERTAINTY
        },
        "lining": _numbers_rounded_to_significant_digits(list(shoe.ends)),
        "edge": _numbers_rounded_to_significant_digits(shoe.edge),
        "pressure_distance": _numbers_rounded_to_significant_digits(shoe.distance, 3),
        "theta": _numbers_rounded_to_significant_digits(shoe.theta.tolist()),
        "pressure": _numbers_rounded_to_significant_digits(shoe.pressure.tolist()),
        "pressure_uncertainty": _numbers_rounded_to_significant_digits(
            shoe.uncertainty.tolist(), 3
        ),
        **({"slots": list(map(list, shoe.slots))} if shoe.slots else {}),
    }


def write_reference_file(data: dict[str, Any], path: Path) -> None:
    """Write reference values, as `reference_values_as_json_data` returns them, to a JSON file."""
    text = json.dumps(data, indent=1, allow_nan=False)
    # json.dumps writes each number of a list on a line of its own. To shorten the file, each list
    # of numbers is put on one line.
    write_text(
        path, _NUMBER_LIST_PATTERN.sub(lambda match: " ".join(match.group().split()), text) + "\n"
    )


def read_reference_file(path: Path) -> ReferenceValuesOfBrake:
    """Read reference values from a file of `write_reference_file`.

    Raises BadInput for a file that holds no reference values.
    """
    text = read_text(path, LARGEST_BYTES_OF_REFERENCE_FILE, "a file of reference values")
    try:
        check_numbers_have_few_digits(text)
        data = json.loads(text, parse_constant=_refuse_non_finite_json_number)
        if data["format"] != NAME_AND_VERSION_OF_REFERENCE_FILE_FORMAT:
            raise BadInput(
                f"{path}: format = {data['format']!r}: must be "
                f"{NAME_AND_VERSION_OF_REFERENCE_FILE_FORMAT!r}"
            )
        return ReferenceValuesOfBrake(
            title=_text_or_type_error(data["title"]),
            text=_text_or_type_error(data["brake_file"]),
            command=_text_or_type_error(data["command"]),
            method=_text_or_type_error(data["method"]),
            versions=dict(map(_pair_of_texts_or_type_error, data["versions"].items())),
            torque=_uncertain_value_from_json_data(data["torque"]),
            shoes=tuple(map(_reference_values_of_shoe_from_json_data, data["shoes"])),
            surface=FRICTION_SURFACE_OF_PLANE
            if data["units"]["theta"] == FRICTION_SURFACE_OF_PLANE.coordinate_unit
            else FRICTION_SURFACE_OF_DRUM,
        )
    except EXCEPTIONS_IF_FILE_HOLDS_NO_REFERENCE_VALUES as error:
        raise BadInput(
            f"{path}: holds no reference values in the form of `drumlin reference`"
        ) from error


def rows_that_summarise_reference_values(
    values: Mapping[str, Any], name: str
) -> list[dict[str, Any]]:
    """Rows of a table that summarises the reference values of a brake, one row for each shoe.

    `values` are the reference values as `reference_values_as_json_data` returns them; `name` is the
    brake's name in the table. Six digits of the torque and four digits of p outside the edge zones
    should be certain. The column "digits" names the quantities that are less certain, with their
    relative uncertainties, or says "nothing".
    """
    rows = []
    for shoe in values["shoes"]:
        (start, end), edge = shoe["lining"], shoe["edge"]
        theta = np.array(shoe["theta"])
        uncertainty = np.array(shoe["pressure_uncertainty"])
        # The largest uncertainty of p outside the edge zones is related to the peak pressure.
        inside = which_angles_are_outside_end_zones(theta, start, end, edge, shoe.get("slots", ()))
        largest = uncertainty[inside].max()
        pressure = float(largest / shoe["peak_pressure"]["value"])
        torque = shoe["torque"]["uncertainty"] / shoe["torque"]["value"]
        short = [f"six digits of torque ({torque:.0e})"] * (torque > 1e-6)
        short += [f"four digits of p ({pressure:.0e})"] * (pressure > 1e-4)
        arcs = []
        for first, last in shoe["contact_arcs"]["value"]:
            arcs.append(f"{math.degrees(first):.3f} to {math.degrees(last):.3f}")
        rows.append(
            {
                "brake": name,
                "shoe": shoe["name"],
                "torque": shoe["torque"]["value"],
                "torque_uncertainty": torque,
                "reaction": ", ".join(f"{x:.7g}" for x in shoe["hinge_reaction"]["value"]),
                "contact": ", ".join(arcs),
                "pressure": pressure,
                "digits": "; ".join(short) or "nothing",
            }
        )
    return rows


def _refuse_non_finite_json_number(word: str) -> float:
    """Raise ValueError for the word NaN or Infinity, which Python's JSON reader would accept."""
    raise ValueError(f"{word} is no number of JSON")


def _text_or_type_error(value: object) -> str:
    """Return the value if it is a text, else raise TypeError."""
    if not isinstance(value, str):
        raise TypeError("not a text")
    return value


def _pair_of_texts_or_type_error(pair: tuple[object, object]) -> tuple[str, str]:
    """Return the pair if both of its values are texts, else raise TypeError."""
    return _text_or_type_error(pair[0]), _text_or_type_error(pair[1])


def _finite_array_of_given_shape_or_error(value: object, *shape: int) -> Floats:
    """The value as an array of finite numbers with the given shape; a length of -1 is any length.

    Raises ValueError or TypeError for other values.
    """
    array = np.array(value, dtype=float)
    # NumPy gives an empty list the shape (0,), even if an array with two dimensions is wanted.
    if array.size == 0:
        array = array.reshape([max(length, 0) for length in shape])
    fits = array.ndim == len(shape) and all(
        n in {-1, m} for n, m in zip(shape, array.shape, strict=True)
    )
    if not fits or not (np.abs(array) <= LARGEST_ALLOWED_NUMBER_IN_SI).all():
        raise ValueError("not finite numbers of the shape that is needed")
    return array


def _uncertain_value_from_json_data(data: dict[str, Any], *shape: int) -> UncertainValue:
    """Read a value of the given shape and its uncertainty; null is an infinite uncertainty."""
    given = data["uncertainty"]
    uncertainty = math.inf if given is None else _non_negative_float_or_error(given)
    return UncertainValue(
        _finite_array_of_given_shape_or_error(data["value"], *shape).tolist(), uncertainty
    )


def _non_negative_float_or_error(value: object) -> float:
    """Return the value as a float. Raises ValueError or TypeError if it is below 0 or no number."""
    size = float(_finite_array_of_given_shape_or_error(value))
    if size < 0:
        raise ValueError("negative")
    return size


def _reference_values_of_shoe_from_json_data(data: dict[str, Any]) -> ReferenceValuesOfShoe:
    """The reference values of a shoe from the data of a file.

    Raises one of the errors EXCEPTIONS_IF_FILE_HOLDS_NO_REFERENCE_VALUES if the data are not
    reference values.
    """
    theta = _finite_array_of_given_shape_or_error(data["theta"], -1)
    first, last = _finite_array_of_given_shape_or_error(data["lining"], 2).tolist()
    slots = _finite_array_of_given_shape_or_error(data.get("slots", []), -1, 2)
    if (np.diff([first, *slots.ravel(), last]) <= 0).any() or (np.diff(theta) <= 0).any():
        raise ValueError("angles that do not grow")
    return ReferenceValuesOfShoe(
        name=_text_or_type_error(data["name"]),
        torque=_uncertain_value_from_json_data(data["torque"]),
        contact_force=_uncertain_value_from_json_data(data["contact_force"], 2),
        hinge_reaction=_uncertain_value_from_json_data(data["hinge_reaction"], 2),
        peak_pressure=_uncertain_value_from_json_data(data["peak_pressure"]),
        contact_arcs=_uncertain_value_from_json_data(data["contact_arcs"], -1, 2),
        ends=(first, last),
        edge=_non_negative_float_or_error(data["edge"]),
        theta=theta,
        pressure=_finite_array_of_given_shape_or_error(data["pressure"], len(theta)),
        uncertainty=_finite_array_of_given_shape_or_error(data["pressure_uncertainty"], len(theta)),
        distance=_non_negative_float_or_error(data["pressure_distance"]),
        slots=tuple((start, end) for start, end in slots.tolist()),
    )


def path_of_stored_reference_for_brake_file_text(text: str, *folders: Path) -> Path | None:
    """The path of the stored reference values of the brake whose brake file has this text.

    The folders are searched in their order. Two brake files with the same keys and values count as
    equal, even if their comments differ. Returns None if no folder has reference values of the
    brake.
    """
    wanted = _parse_toml_or_return_text(text)
    for folder in folders:
        for path in sorted(folder.glob("*.json")):
            # A JSON file that is unreadable or has no brake file is skipped.
            with suppress(BadInput, *EXCEPTIONS_IF_FILE_HOLDS_NO_REFERENCE_VALUES):
                data = json.loads(
                    read_text(path, LARGEST_BYTES_OF_REFERENCE_FILE, "reference values")
                )
                if _parse_toml_or_return_text(data["brake_file"]) == wanted:
                    return path
    return None


def _parse_toml_or_return_text(text: str) -> object:
    """The keys and values of a TOML text; if the text is not TOML, the text itself."""
    try:
        check_toml_parses_quickly(text)
        return tomllib.loads(text)
    except (ValueError, RecursionError):
        return text
