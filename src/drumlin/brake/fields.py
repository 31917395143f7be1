"""Quantities, tables, points and materials, of which brakes are described.

Every number is SI. When a brake file is read, the context of the validation asks for units.
"""

import math
import re
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Annotated, Any, Self, get_args, get_origin

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    ValidationInfo,
    model_validator,
)

from drumlin.base.arrays import Floats
from drumlin.base.texts import nearest
from drumlin.brake.units import EXAMPLES, QUANTITY_NAMES, to_si


def _in_si(value: object, info: ValidationInfo, si: str, key: str = "") -> float:
    """Convert a value to SI; the context of the validation tells whether a unit is required.

    Parameters
    ----------
    value : a number, or a text with its unit
    si : the SI unit
    info : of the validation
    key : of the value, for the message of an error
    """
    try:
        unit_required = bool(info.context and info.context.get("unit_required"))
        return to_si(value, si, unit_required=unit_required)
    except ValueError as error:
        raise ValueError(f"{key} = {value!r} {error}" if key else str(error)) from error


def _quantity(si: str) -> BeforeValidator:
    """The validator that reads a quantity with this SI unit."""
    return BeforeValidator(partial(_in_si, si=si))


def _one_line(text: str) -> str:
    """Check a title. It heads pages and figures, where $ would begin a formula."""
    if not text.isprintable() or "$" in text:
        raise ValueError("must be one line of printable characters, without $")
    return text


def _name(text: str) -> str:
    """Check a name. Files and lines in figures are named after it; "all" is the whole brake."""
    if not re.fullmatch(r"\w([\w .+()-]*[\w+)])?", text) or text == "all":
        raise ValueError(
            "must be letters, digits, spaces and . _ + - ( ), "
            "a letter or digit at both ends; not 'all'"
        )
    return text


def check_names(names: Sequence[str]) -> None:
    """Raise ValueError if files of two shoes would have the same name."""
    if len({name.replace(" ", "_").casefold() for name in names}) < len(names):
        raise ValueError(
            f"shoe.name = {list(names)}: names must differ, not in case or spaces alone"
        )


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
    """A part of a brake: frozen data that refuses unknown keys."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, populate_by_name=True, defer_build=True
    )

    @model_validator(mode="before")
    @classmethod
    def _refuse_unknown_keys(cls, data: object) -> object:
        """The data as they are; ValueError for keys that the part does not have."""
        allowed = [field.alias or name for name, field in cls.model_fields.items()]
        if isinstance(data, Mapping):
            for key in data:
                if key not in allowed and key not in cls.model_fields:
                    meant = nearest(str(key), allowed)
                    raise ValueError(f"unknown key {key!r}{meant}; allowed: {', '.join(allowed)}")
        elif not isinstance(data, Part):
            raise ValueError(f"must be a table with keys of {', '.join(allowed)}")
        return data

    def __copy__(self) -> Self:
        """Copy without the values of cached properties, as `model_copy` changes their sources."""
        found = super().__copy__()
        # The dictionary of an instance holds its fields and the cached values of its properties.
        for name in found.__dict__.keys() - type(self).model_fields:
            del found.__dict__[name]
        return found


class Material(Part):
    """A linear elastic, isotropic material: Young's modulus E [Pa] and Poisson's ratio nu.

    It also has the constants of an `Orthotropic` material, the same in all directions.
    """

    E: Modulus
    nu: Annotated[float, Field(gt=-1, lt=0.5, strict=True)]

    @property
    def E_along(self) -> float:
        """Young's modulus along a layer [Pa]."""
        return self.E

    @property
    def E_through(self) -> float:
        """Young's modulus through a layer [Pa]."""
        return self.E

    @property
    def G_along_through(self) -> float:
        """Shear modulus in the plane of the brake [Pa]."""
        return self.E / (2 * (1 + self.nu))

    @property
    def nu_along_through(self) -> float:
        """Poisson's ratio: contraction through a layer per stretch along it."""
        return self.nu

    @property
    def E_half_plane(self) -> float:
        """Young's modulus [Pa] of the isotropic half-plane with the same compliance."""
        return self.E

    @property
    def moduli(self) -> dict[str, float]:
        """All moduli [Pa] by their keys."""
        return {"E": self.E}


PoissonRatio = Annotated[float, Field(strict=True)]
ACROSS = ("E_across", "G_along_across", "G_through_across", "nu_along_across", "nu_through_across")
"""Keys of an orthotropic material that only a solid uses."""

DEFINITE_WITHIN = 1e-12
"""Smallest determinant of the compliances at which the energy of every strain is positive.

Each compliance is divided by the root of the product of its diagonal entries. Below this value
round-off decides, and the material is refused.
"""


class Orthotropic(Part):
    """A linear elastic material, orthotropic in the directions along, through and across its layer.

    It has Young's moduli E [Pa] of the directions, shear moduli G [Pa] between two of them, and
    Poisson's ratios nu. A layer that is pulled along itself shrinks through its thickness by
    nu_along_through times its stretch. Only solids use the keys ACROSS: plane stress does not
    depend on them.
    """

    E_along: Modulus
    E_through: Modulus
    G_along_through: Modulus
    nu_along_through: PoissonRatio
    E_across: Modulus | None = None
    G_along_across: Modulus | None = None
    G_through_across: Modulus | None = None
    nu_along_across: PoissonRatio | None = None
    nu_through_across: PoissonRatio | None = None

    @model_validator(mode="after")
    def _check_positive_definite(self) -> Self:
        """Refuse constants under which some strain would have no positive energy."""
        _check_ratio(
            "nu_along_through",
            self.nu_along_through,
            self.E_along,
            self.E_through,
            ("along", "through"),
        )
        # A material without constants across its layer serves plane stress, a solid needs them all.
        missing = [key for key in ACROSS if getattr(self, key) is None]
        if len(missing) == len(ACROSS):
            return self
        if missing:
            raise ValueError(
                f"{missing[0]} is missing: {', '.join(ACROSS)} go together; give all of them "
                f"or none"
            )
        assert (
            self.E_across is not None
            and self.nu_along_across is not None
            and self.nu_through_across is not None
        )
        _check_ratio(
            "nu_along_across",
            self.nu_along_across,
            self.E_along,
            self.E_across,
            ("along", "across"),
        )
        low, high = self._nu_through_across_allowed(self.E_across, self.nu_along_across)
        if not low < self.nu_through_across < high:
            raise ValueError(
                f"nu_through_across = {self.nu_through_across:g}: must be greater than {low:.6g} "
                f"and less than {high:.6g}, beside these moduli and Poisson's ratios"
            )
        return self

    def _nu_through_across_allowed(
        self, E_across: float, nu_along_across: float
    ) -> tuple[float, float]:
        """Lower and upper bound of nu_through_across.

        Each compliance is divided by the root of the product of its diagonal entries. The
        determinant 1 - a^2 - b^2 - c^2 - 2 a b c must be positive. Here a, b and c are Poisson's
        ratios along-through, along-across and through-across, each times the root of the ratio of
        its moduli.
        """
        # The determinant is a quadratic in c: the bounds of c are its two zeros.
        a = self.nu_along_through * math.sqrt(self.E_through / self.E_along)
        b = nu_along_across * math.sqrt(E_across / self.E_along)
        reach = math.sqrt(max((1 - a**2) * (1 - b**2) - DEFINITE_WITHIN, 0.0))
        # This factor turns c back into Poisson's ratio.
        unit = math.sqrt(self.E_through / E_across)
        return (-a * b - reach) * unit, (-a * b + reach) * unit

    @property
    def E_half_plane(self) -> float:
        """Young's modulus [Pa] of the isotropic half-plane with the same compliance.

        The surface of a half-plane gives way by 2/E_half_plane per pressure and wave number. With
        the compliances s this is the root of 2 s_nn (sqrt(s_tt s_nn) + s_tn + s_gg/2) (Lekhnitskii,
        Anisotropic Plates, section 34).
        """
        s_tt, s_nn, s_gg = 1 / self.E_along, 1 / self.E_through, 1 / self.G_along_through
        s_tn = -self.nu_along_through / self.E_along
        return 2 / math.sqrt(2 * s_nn * (math.sqrt(s_tt * s_nn) + s_tn + s_gg / 2))

    @property
    def moduli(self) -> dict[str, float]:
        """All moduli [Pa] by their keys."""
        keys = [key for key in type(self).model_fields if not key.startswith("nu")]
        return {key: value for key in keys if (value := getattr(self, key)) is not None}


def _check_ratio(key: str, nu: float, E: float, other: float, names: tuple[str, str]) -> None:
    """Raise ValueError if Poisson's ratio between two directions is too large.

    Parameters
    ----------
    key : of the ratio
    nu : Poisson's ratio
    E, other : Young's moduli of the two directions [Pa]
    names : of the two directions
    """
    most = math.sqrt(E / other)
    if 1 - (nu / most) ** 2 <= DEFINITE_WITHIN:
        raise ValueError(
            f"{key} = {nu:g}: must be greater than {-most:.6g} and less than {most:.6g}, "
            f"the root of E_{names[0]} / E_{names[1]}"
        )


def _kind_of_material(data: object) -> str:
    """Kind of a material, "isotropic" or "orthotropic", by keys that only the latter has."""
    if isinstance(data, Mapping):
        return "orthotropic" if set(data) & set(Orthotropic.model_fields) else "isotropic"
    return "orthotropic" if isinstance(data, Orthotropic) else "isotropic"


AnyMaterial = Annotated[
    Annotated[Material, Tag("isotropic")] | Annotated[Orthotropic, Tag("orthotropic")],
    Discriminator(_kind_of_material),
]


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
    """Read a point that a file gives as { radius, angle } in place of { x, y }."""
    if not isinstance(data, Mapping) or not {"radius", "angle"} & set(data):
        return data
    if set(data) != {"radius", "angle"}:
        raise ValueError("must be { radius = ..., angle = ... } or { x = ..., y = ... }")
    # A negative radius would turn the point to the other side of the centre unseen.
    radius = _in_si(data["radius"], info, "m", "radius")
    if radius < 0:
        raise ValueError(f"radius = {data['radius']!r} must not be negative")
    angle = _in_si(data["angle"], info, "rad", "angle")
    return Point(x=radius * math.cos(angle), y=radius * math.sin(angle))


Place = Annotated[Point, BeforeValidator(_from_polar)]


Rows = tuple[tuple[float, float], ...]


def number_or_table(place: str, place_si: str, name: str, si: str) -> BeforeValidator:
    """The validator of a number or of a table (place, value) with straight lines between.

    Parameters
    ----------
    place, name : words for place and value in the message of an error
    place_si, si : their SI units
    """
    read = partial(_number_or_rows, si=si, place=place, name=name, row=(place_si, si))
    return BeforeValidator(read)


def table(place: str, place_si: str, name: str, si: str) -> BeforeValidator:
    """The validator of rows (place, value) with growing places; parameters of `number_or_table`."""
    return BeforeValidator(partial(_rows, place=place, name=name, row=(place_si, si)))


def _number_or_rows(
    value: object, info: ValidationInfo, *, si: str, place: str, name: str, row: tuple[str, str]
) -> float | Rows:
    """Read a number or a table; parameters as of `_rows`, `si` the unit of the number."""
    if not isinstance(value, list | tuple):
        return _in_si(value, info, si)
    rows = _rows(
        value, info, place=place, name=name, row=row, kinds=f"{QUANTITY_NAMES[si]} or rows"
    )
    if len(rows) < 2:
        raise ValueError(f"the table needs at least two rows, with growing {place}s")
    return rows


def _rows(
    value: object,
    info: ValidationInfo,
    *,
    place: str,
    name: str,
    row: tuple[str, str],
    kinds: str = "rows",
) -> Rows:
    """Read the rows of a table.

    Parameters
    ----------
    value : the rows as data
    info : of the validation
    place, name : words for place and value in the message of an error
    row : SI units of place and value
    kinds : words for what may stand here
    """
    items: Sequence[Any] = value if isinstance(value, list | tuple) else [value]
    rows: list[tuple[float, float]] = []
    for item in items:
        if not isinstance(item, list | tuple) or len(item) != 2:
            raise ValueError(f'must be {kinds} like ["{EXAMPLES[row[0]]}", "{EXAMPLES[row[1]]}"]')
        rows.append((_in_si(item[0], info, row[0], place), _in_si(item[1], info, row[1], name)))
    # Places that do not grow would have two values, or none between them.
    for k in range(1, len(rows)):
        if rows[k][0] <= rows[k - 1][0]:
            raise ValueError(
                f"the table needs growing {place}s, not {items[k][0]!r} after {items[k - 1][0]!r}"
            )
    return tuple(rows)


def unit_in(annotation: Any) -> str | None:
    """The SI unit of a field's type: "" for a pure number, None if it is no number."""
    unit: str | None = _keyword_of(annotation, "si", pure="")
    return unit


def row_units_in(annotation: Any) -> tuple[str, str]:
    """The SI units of place and value in a row of the table that a field's type takes."""
    units: tuple[str, str] = _keyword_of(annotation, "row")
    return units


def _keyword_of(annotation: Any, key: str, pure: Any = None) -> Any:
    """Keyword that the validator of a field's type has; `pure` for a number without validator.

    It is None for any other type.
    """
    kind: Any = annotation
    marks: tuple[Any, ...] = ()
    if get_origin(annotation) is Annotated:
        kind, marks = annotation.__origin__, annotation.__metadata__
    # Validators of quantities and tables are partial functions with their units as keywords.
    for mark in marks:
        if not isinstance(mark, BeforeValidator) or not isinstance(mark.func, partial):
            continue
        if key in mark.func.keywords:
            return mark.func.keywords[key]
    if kind is float:
        return pure
    # A union: the first of its types that has the keyword counts.
    for part in get_args(kind):
        found = _keyword_of(part, key, pure)
        if found is not None:
            return found
    return None


def rows_of(places: Floats, values: Floats) -> Rows:
    """Make the table of values (n,) at growing places (n,)."""
    return tuple(zip(places.tolist(), values.tolist(), strict=True))


def value_at(values: float | Rows, places: Floats) -> Floats:
    """Evaluate a number or table at `places`, same shape."""
    if isinstance(values, tuple):
        at, value = zip(*values, strict=True)
        return np.interp(places, at, value)
    return np.full(np.shape(places), values)
