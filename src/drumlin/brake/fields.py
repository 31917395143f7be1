"""The small pieces that brakes are described with: quantities, tables, points, materials.

Every number is SI. Where a brake file is read the validation's context asks for units.
"""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Annotated, Any, get_args, get_origin

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationInfo,
    model_validator,
)

from drumlin.arrays import Floats
from drumlin.brake.units import EXAMPLES, NAMES, to_si
from drumlin.texts import nearest


def _si(value: object, si: str, info: ValidationInfo, key: str = "") -> float:
    """`value` in SI, where the context of the validation says whether it must carry its unit."""
    try:
        return to_si(value, si, unit_required=bool(info.context and info.context.get("unit_required")))
    except ValueError as error:
        raise ValueError(f"{key} = {value!r} {error}" if key else str(error)) from error


def _quantity(si: str) -> BeforeValidator:
    def read(value: object, info: ValidationInfo, *, si: str) -> float:
        return _si(value, si, info)

    return BeforeValidator(partial(read, si=si))


def _one_line(text: str) -> str:
    """It heads pages and figures, where $ would begin a formula."""
    if not text.isprintable() or "$" in text:
        raise ValueError("must be one line of printable characters, without $")
    return text


def _name(text: str) -> str:
    """Files are named after it, and lines in figures; "all" is the whole brake."""
    if not re.fullmatch(r"\w([\w .+()-]*[\w+)])?", text) or text == "all":
        raise ValueError("must be letters, digits, spaces and . _ + - ( ), a letter or digit at both ends; not 'all'")
    return text


def check_names(names: Sequence[str]) -> None:
    """Raises ValueError where files of two shoes would have the same name."""
    if len({name.replace(" ", "_").casefold() for name in names}) < len(names):
        raise ValueError(f"shoe.name = {list(names)}: names must differ, not in case or spaces alone")


Length = Annotated[float, _quantity("m")]
Thickness = Annotated[float, Field(gt=0), _quantity("m")]
Angle = Annotated[float, _quantity("rad")]
Force = Annotated[float, _quantity("N")]
Torque = Annotated[float, _quantity("N m")]
Modulus = Annotated[float, Field(gt=0), _quantity("Pa")]
BendingStiffness = Annotated[float, Field(gt=0), _quantity("N m^2")]
Title = Annotated[str, Field(min_length=1, max_length=80), AfterValidator(_one_line)]
Name = Annotated[str, Field(min_length=1, max_length=80), AfterValidator(_name)]


class Part(BaseModel):
    """A piece of a brake: frozen, and with no key that it does not know."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, populate_by_name=True, defer_build=True)

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, data: object) -> object:
        allowed = [field.alias or name for name, field in cls.model_fields.items()]
        if isinstance(data, Mapping):
            for key in data:
                if key not in allowed and key not in cls.model_fields:
                    raise ValueError(f"unknown key {key!r}{nearest(str(key), allowed)}; allowed: {', '.join(allowed)}")
        elif not isinstance(data, Part):
            raise ValueError(f"must be a table with keys of {', '.join(allowed)}")
        return data


class Material(Part):
    """Linear elastic, isotropic: Young's modulus E [Pa] and Poisson's ratio nu."""

    E: Modulus
    nu: Annotated[float, Field(gt=-1, lt=0.5, strict=True)]


class Point(Part):
    """A point x, y [m] of the brake's plane."""

    x: Length
    y: Length

    @property
    def xy(self) -> Floats:
        """The coordinates as an array (2,) [m]."""
        return np.array([self.x, self.y])

    @property
    def radius(self) -> float:
        """Distance from the drum's centre [m]."""
        return math.hypot(self.x, self.y)

    @property
    def angle(self) -> float:
        """Angle at the drum's centre [rad]."""
        return math.atan2(self.y, self.x)


def _from_polar(data: object, info: ValidationInfo) -> object:
    """A file may give a point as { radius, angle } in place of { x, y }."""
    if not isinstance(data, Mapping) or not {"radius", "angle"} & set(data):
        return data
    if set(data) != {"radius", "angle"}:
        raise ValueError("must be { radius = ..., angle = ... } or { x = ..., y = ... }")
    radius = _si(data["radius"], "m", info, "radius")
    if radius < 0:
        raise ValueError(f"radius = {data['radius']!r} must not be negative")
    angle = _si(data["angle"], "rad", info, "angle")
    return Point(x=radius * math.cos(angle), y=radius * math.sin(angle))


Place = Annotated[Point, BeforeValidator(_from_polar)]


Rows = tuple[tuple[float, float], ...]


def number_or_table(place: str, place_si: str, name: str, si: str) -> BeforeValidator:
    """One value, or a table of (place, value) with straight lines between; for the words of a refusal: names."""
    read_rows = _rows_reader(place, place_si, name, si, f"{NAMES[si]} or rows")

    def read(value: object, info: ValidationInfo, *, si: str) -> float | Rows:
        if not isinstance(value, list | tuple):
            return _si(value, si, info)
        rows = read_rows(value, info)
        if len(rows) < 2:
            raise ValueError(f"the table needs at least two rows, with growing {place}s")
        return rows

    return BeforeValidator(partial(read, si=si))


def table(place: str, place_si: str, name: str, si: str) -> BeforeValidator:
    """Any number of rows (place, value) with growing places; for the words of a refusal: names."""
    return BeforeValidator(_rows_reader(place, place_si, name, si, "rows"))


def _rows_reader(place: str, place_si: str, name: str, si: str, kinds: str) -> Callable[[object, ValidationInfo], Rows]:
    def read(value: object, info: ValidationInfo) -> Rows:
        rows = []
        for row in value if isinstance(value, list | tuple) else [value]:
            if not isinstance(row, list | tuple) or len(row) != 2:
                raise ValueError(f'must be {kinds} like ["{EXAMPLES[place_si]}", "{EXAMPLES[si]}"]')
            rows.append((_si(row[0], place_si, info, place), _si(row[1], si, info, name)))
        for k in range(1, len(rows)):
            if rows[k][0] <= rows[k - 1][0]:
                before, after = (row[0] for row in value[k - 1 : k + 1])  # type: ignore[index]
                raise ValueError(f"the table needs growing {place}s, not {after!r} after {before!r}")
        return tuple(rows)

    return read


def unit_in(annotation: Any) -> str | None:
    """The SI unit of a field's type: "" of a pure number, None of what is no number."""
    kind, *marks = (
        (annotation.__origin__, *annotation.__metadata__) if get_origin(annotation) is Annotated else [annotation]
    )
    for mark in marks:
        if isinstance(mark, BeforeValidator) and isinstance(mark.func, partial):
            return str(mark.func.keywords["si"])
    if kind is float:
        return ""
    return next((unit for unit in map(unit_in, get_args(kind)) if unit is not None), None)


def value_at(values: float | Rows, places: Floats) -> Floats:
    """A number or table at `places`, same shape."""
    if isinstance(values, tuple):
        at, value = zip(*values, strict=True)
        return np.interp(places, at, value)
    return np.full(np.shape(places), values)
