"""Reference values as files: written as JSON, read back without trust, found by the brake file that
they belong to.
"""

import json
import math
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.base.files import read_text, write_text
from drumlin.base.texts import check_digits, check_toml
from drumlin.brake.surface import DRUM, PLANE
from drumlin.brake.units import LARGEST_NUMBER_SI
from drumlin.verification.reference import Reference, ShoeReference, Sure

FORMAT = "drumlin reference values, 1"
FILE_DIGITS = 10  # significant digits in a file
_LIST = re.compile(r"\[[-+0-9.eE,\s]*\]")  # in JSON, of numbers only
LARGEST_FILE = 10_000_000  # bytes
UNITS = {
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


SURFACE_UNITS = {
    surface: {
        "torque": surface.effect_unit,
        **dict.fromkeys(("contact_arcs", "edge", "theta"), surface.unit),
    }
    for surface in (DRUM, PLANE)
}


def _rounded(value: Any, digits: int = FILE_DIGITS) -> Any:
    """Numbers, also in lists, to so many significant digits."""
    if isinstance(value, list):
        return [_rounded(each, digits) for each in value]
    return float(f"{value:.{digits}g}")


def _sure_data(sure: Sure) -> dict[str, Any]:
    finite = math.isfinite(sure.uncertainty)
    return {
        "value": _rounded(sure.value),
        "uncertainty": _rounded(sure.uncertainty, 3) if finite else None,
    }


def as_dict(found: Reference) -> dict[str, Any]:
    """Reference values as plain data for JSON."""
    shoes = [
        {
            "name": shoe.name,
            **{
                key: _sure_data(getattr(shoe, key))
                for key in (
                    "torque",
                    "contact_force",
                    "hinge_reaction",
                    "peak_pressure",
                    "contact_arcs",
                )
            },
            "lining": _rounded(list(shoe.ends)),
            "edge": _rounded(shoe.edge),
            "pressure_distance": _rounded(shoe.distance, 3),
            "theta": _rounded(shoe.theta.tolist()),
            "pressure": _rounded(shoe.pressure.tolist()),
            "pressure_uncertainty": _rounded(shoe.uncertainty.tolist(), 3),
        }
        for shoe in found.shoes
    ]
    return {
        "format": FORMAT,
        "title": found.title,
        "method": found.method,
        "units": UNITS | SURFACE_UNITS[found.surface],
        "command": found.command,
        "versions": found.versions,
        "torque": _sure_data(found.torque),
        "shoes": shoes,
        "brake_file": found.text,
    }


def write_values(data: dict[str, Any], path: Path) -> None:
    """Write reference values, as as_dict gives them, as JSON; a list of numbers is a line."""
    text = json.dumps(data, indent=1, allow_nan=False)
    write_text(path, _LIST.sub(lambda match: " ".join(match.group().split()), text) + "\n")


def read_reference(path: Path) -> Reference:
    """Reference values from a file that write_values made. Raises BadInput with one line."""
    text = read_text(path, LARGEST_FILE, "a file of reference values")
    try:
        check_digits(text)
        data = json.loads(text, parse_constant=_refused)
        if data["format"] != FORMAT:
            raise BadInput(f"{path}: format = {data['format']!r}: must be {FORMAT!r}")
        return Reference(
            _text(data["title"]),
            _text(data["brake_file"]),
            _text(data["command"]),
            _text(data["method"]),
            {_text(name): _text(version) for name, version in data["versions"].items()},
            _sure_from(data["torque"]),
            tuple(_shoe_from(shoe) for shoe in data["shoes"]),
            surface=PLANE if data["units"]["theta"] == PLANE.unit else DRUM,
        )
    except (
        ValueError,
        LookupError,
        TypeError,
        AttributeError,
        RecursionError,
        OverflowError,
    ) as error:
        raise BadInput(
            f"{path}: holds no reference values in the form of `drumlin reference`"
        ) from error


def summary_rows(values: Mapping[str, Any], name: str) -> list[dict[str, Any]]:
    """A row a shoe of reference values as plain data: what is known of it, and which of six digits
    of its torque and four of p away from the edges it is short of.
    """
    rows = []
    for shoe in values["shoes"]:
        peak, (start, end), edge = shoe["peak_pressure"]["value"], shoe["lining"], shoe["edge"]
        away = [
            u
            for angle, u in zip(shoe["theta"], shoe["pressure_uncertainty"], strict=True)
            if start + edge < angle < end - edge
        ]
        torque = shoe["torque"]["uncertainty"] / shoe["torque"]["value"]
        pressure = max(away) / peak
        short = [f"six digits of torque ({torque:.0e})"] * (torque > 1e-6)
        short += [f"four digits of p ({pressure:.0e})"] * (pressure > 1e-4)
        arcs = [
            f"{math.degrees(a):.3f} to {math.degrees(b):.3f}"
            for a, b in shoe["contact_arcs"]["value"]
        ]
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


def _refused(word: str) -> float:
    raise ValueError(f"{word} is no number of JSON")


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise TypeError("not a text")
    return value


def _numbers(value: object, *shape: int) -> Floats:
    """Finite numbers of a shape; -1: of any length. Raises ValueError, TypeError."""
    array = np.array(value, dtype=float)
    if array.size == 0:
        array = array.reshape([max(length, 0) for length in shape])
    fits = array.ndim == len(shape) and all(
        n in {-1, m} for n, m in zip(shape, array.shape, strict=True)
    )
    if not fits or not (np.abs(array) <= LARGEST_NUMBER_SI).all():
        raise ValueError("not finite numbers of the shape that is needed")
    return array


def _sure_from(data: dict[str, Any], *shape: int) -> Sure:
    known = data["uncertainty"]
    return Sure(
        _numbers(data["value"], *shape).tolist(), math.inf if known is None else _size(known)
    )


def _size(value: object) -> float:
    """A number that is not negative."""
    size = float(_numbers(value))
    if size < 0:
        raise ValueError("negative")
    return size


def _shoe_from(data: dict[str, Any]) -> ShoeReference:
    theta = _numbers(data["theta"], -1)
    pressure, uncertainty = (
        _numbers(data[key], len(theta)) for key in ("pressure", "pressure_uncertainty")
    )
    first, last = _numbers(data["lining"], 2).tolist()
    if not first < last or (np.diff(theta) <= 0).any():
        raise ValueError("angles that do not grow")
    return ShoeReference(
        name=_text(data["name"]),
        torque=_sure_from(data["torque"]),
        contact_force=_sure_from(data["contact_force"], 2),
        hinge_reaction=_sure_from(data["hinge_reaction"], 2),
        peak_pressure=_sure_from(data["peak_pressure"]),
        contact_arcs=_sure_from(data["contact_arcs"], -1, 2),
        ends=(first, last),
        edge=_size(data["edge"]),
        theta=theta,
        pressure=pressure,
        uncertainty=uncertainty,
        distance=_size(data["pressure_distance"]),
    )


def stored(text: str, *folders: Path) -> Path | None:
    """The file with reference values of a brake file that says what this text says, comments aside,
    in the first of the folders that has one.
    """
    asked = _said(text)
    for folder in folders:
        for path in sorted(folder.glob("*.json")):
            try:
                if (
                    _said(
                        json.loads(read_text(path, LARGEST_FILE, "reference values"))["brake_file"]
                    )
                    == asked
                ):
                    return path
            except (BadInput, ValueError, LookupError, TypeError, RecursionError):
                continue  # another JSON file
    return None


def _said(text: str) -> object:
    """What a TOML text says; of another its words."""
    try:
        check_toml(text)
        return tomllib.loads(text)
    except (ValueError, RecursionError):
        return text
