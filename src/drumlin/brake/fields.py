"""The small pieces that brakes are described with: quantities, tables, points, materials.

Every number is SI. Where a brake file is read the validation's context asks for units.
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

from drumlin.arrays import Floats
from drumlin.brake.units import EXAMPLES, QUANTITY_NAMES, to_si
from drumlin.texts import nearest


def _si(value: object, si: str, info: ValidationInfo, key: str = "") -> float:
    """`value` in SI, where the context of the validation says whether it must carry its unit."""
    try:
        return to_si(
            value, si, unit_required=bool(info.context and info.context.get("unit_required"))
        )
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
        raise ValueError(
            "must be letters, digits, spaces and . _ + - ( ), a letter or digit at both ends; not 'all'"
        )
    return text


def check_names(names: Sequence[str]) -> None:
    """Raises ValueError where files of two shoes would have the same name."""
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
    """A piece of a brake: frozen, and with no key that it does not know."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, populate_by_name=True, defer_build=True
    )

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, data: object) -> object:
        allowed = [field.alias or name for name, field in cls.model_fields.items()]
        if isinstance(data, Mapping):
            for key in data:
                if key not in allowed and key not in cls.model_fields:
                    raise ValueError(
                        f"unknown key {key!r}{nearest(str(key), allowed)}; allowed: {', '.join(allowed)}"
                    )
        elif not isinstance(data, Part):
            raise ValueError(f"must be a table with keys of {', '.join(allowed)}")
        return data

    def __copy__(self) -> Self:
        """Without what cached properties keep: `model_copy` changes what it hangs on."""
        found = super().__copy__()
        for name in found.__dict__.keys() - type(self).model_fields:
            del found.__dict__[name]
        return found


class Material(Part):
    """Linear elastic, isotropic: Young's modulus E [Pa] and Poisson's ratio nu.

    What an `Orthotropic` material has in directions of its layer it has as well, the same in all.
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
        """Poisson's ratio: how much a layer shrinks through itself as it is stretched along."""
        return self.nu

    @property
    def E_half_plane(self) -> float:
        """Modulus of the isotropic half-plane that gives way like one of this material [Pa]."""
        return self.E

    @property
    def moduli(self) -> dict[str, float]:
        """All moduli [Pa] by their keys."""
        return {"E": self.E}


PoissonRatio = Annotated[float, Field(strict=True)]
ACROSS = ("E_across", "G_along_across", "G_through_across", "nu_along_across", "nu_through_across")
"""The keys of an orthotropic material that only a solid uses."""
DEFINITE_WITHIN = 1e-12
"""Least determinant of the compliances, each over the root of the product of its diagonal entries.
Below it round-off decides whether the energy of a strain is positive."""


class Orthotropic(Part):
    """Linear elastic, orthotropic in directions of its layer: along, through and across it.

    Young's moduli E [Pa] of the directions, shear moduli G [Pa] between two of them, and Poisson's
    ratios nu: a layer that is pulled along itself shrinks through its thickness by nu_along_through
    times as much. The keys ACROSS are for solids alone: plane stress does not depend on them.
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
    def _positive_definite(self) -> Self:
        """Refuses constants under which some strain would have no positive energy."""
        _check_ratio(
            "nu_along_through",
            self.nu_along_through,
            self.E_along,
            self.E_through,
            ("along", "through"),
        )
        missing = [key for key in ACROSS if getattr(self, key) is None]
        if len(missing) == len(ACROSS):
            return self
        if missing:
            raise ValueError(
                f"{missing[0]} is missing: {', '.join(ACROSS)} go together; give all of them or none"
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
                f"nu_through_across = {self.nu_through_across:g}: must be greater than {low:.6g} and less than "
                f"{high:.6g}, beside these moduli and Poisson's ratios"
            )
        return self

    def _nu_through_across_allowed(
        self, E_across: float, nu_along_across: float
    ) -> tuple[float, float]:
        """Between what nu_through_across must lie.

        With every compliance over the root of the product of its diagonal entries, the determinant
        1 - a^2 - b^2 - c^2 - 2 a b c must be positive, a, b, c being the Poisson's ratios
        along-through, along-across and through-across times the root of their moduli's ratio.
        """
        a = self.nu_along_through * math.sqrt(self.E_through / self.E_along)
        b = nu_along_across * math.sqrt(E_across / self.E_along)
        reach = math.sqrt(max((1 - a**2) * (1 - b**2) - DEFINITE_WITHIN, 0.0))
        unit = math.sqrt(self.E_through / E_across)
        return (-a * b - reach) * unit, (-a * b + reach) * unit

    @property
    def E_half_plane(self) -> float:
        """Modulus of the isotropic half-plane that gives way like one of this material [Pa].

        Lekhnitskii, Anisotropic Plates, section 34: under pressure the surface of a half-plane with
        the compliances s gives way by 2/E_half_plane, the root of 2 s_nn (sqrt(s_tt s_nn) + s_tn +
        s_gg/2), per pressure and wave number.
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
    """Raise ValueError where Poisson's ratio between directions of the moduli E and `other` is too
    large."""
    most = math.sqrt(E / other)
    if 1 - (nu / most) ** 2 <= DEFINITE_WITHIN:
        raise ValueError(
            f"{key} = {nu:g}: must be greater than {-most:.6g} and less than {most:.6g}, "
            f"the root of E_{names[0]} / E_{names[1]}"
        )


def _kind_of_material(data: object) -> str:
    """Which of the two kinds a material is, by the keys that only an orthotropic one has."""
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
    """One value, or a table of (place, value) with straight lines between; for the words of a
    refusal: names.
    """
    return BeforeValidator(
        partial(_number_or_rows, si=si, place=place, name=name, row=(place_si, si))
    )


def table(place: str, place_si: str, name: str, si: str) -> BeforeValidator:
    """Any number of rows (place, value) with growing places; for the words of a refusal: names."""
    return BeforeValidator(partial(_rows, place=place, name=name, row=(place_si, si)))


def _number_or_rows(
    value: object, info: ValidationInfo, *, si: str, place: str, name: str, row: tuple[str, str]
) -> float | Rows:
    if not isinstance(value, list | tuple):
        return _si(value, si, info)
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
    items: Sequence[Any] = value if isinstance(value, list | tuple) else [value]
    rows: list[tuple[float, float]] = []
    for item in items:
        if not isinstance(item, list | tuple) or len(item) != 2:
            raise ValueError(f'must be {kinds} like ["{EXAMPLES[row[0]]}", "{EXAMPLES[row[1]]}"]')
        rows.append((_si(item[0], row[0], info, place), _si(item[1], row[1], info, name)))
    for k in range(1, len(rows)):
        if rows[k][0] <= rows[k - 1][0]:
            raise ValueError(
                f"the table needs growing {place}s, not {items[k][0]!r} after {items[k - 1][0]!r}"
            )
    return tuple(rows)


def unit_in(annotation: Any) -> str | None:
    """The SI unit of a field's type: "" of a pure number, None of what is no number."""
    unit: str | None = _told(annotation, "si", pure="")
    return unit


def row_units_in(annotation: Any) -> tuple[str, str]:
    """The SI units of place and value in a row of the table that a field's type takes."""
    units: tuple[str, str] = _told(annotation, "row")
    return units


def _told(annotation: Any, key: str, pure: Any = None) -> Any:
    """What the reader of a field's type is told by a key; `pure` of a number without reader, None
    of the rest.
    """
    kind, *marks = (
        (annotation.__origin__, *annotation.__metadata__)
        if get_origin(annotation) is Annotated
        else [annotation]
    )
    for mark in marks:
        if (
            isinstance(mark, BeforeValidator)
            and isinstance(mark.func, partial)
            and key in mark.func.keywords
        ):
            return mark.func.keywords[key]
    if kind is float:
        return pure
    return next(
        (found for part in get_args(kind) if (found := _told(part, key, pure)) is not None), None
    )


def rows_of(places: Floats, values: Floats) -> Rows:
    """The table of values (n,) at growing places (n,)."""
    return tuple(zip(places.tolist(), values.tolist(), strict=True))


def value_at(values: float | Rows, places: Floats) -> Floats:
    """A number or table at `places`, same shape."""
    if isinstance(values, tuple):
        at, value = zip(*values, strict=True)
        return np.interp(places, at, value)
    return np.full(np.shape(places), values)
