"""The types of a brake's data: quantities, tables of numbers, points and materials.

The data are in SI units. A brake file must give the unit of each quantity, and the validators
convert it. Data that a program gives may be plain numbers in SI units. The entry "unit_required" of
pydantic's validation context is true for a brake file.
"""

import math
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cache, partial
from typing import Annotated, Any, ClassVar, Self, get_args, get_origin

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    PrivateAttr,
    Tag,
    ValidationInfo,
    model_validator,
)

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.base.texts import did_you_mean_hint
from drumlin.base.written_numbers import number_without_unit_from_text
from drumlin.brake.units import (
    EXAMPLE_OF_QUANTITY_BY_SI_UNIT,
    NAME_OF_QUANTITY_BY_SI_UNIT,
    quantity_in_si,
)


def _quantity_of_brake_key_in_si(
    value: object, info: ValidationInfo, si: str, key: str = ""
) -> float:
    """Convert a quantity to a number in SI units. Raises ValueError for anything else.

    Parameters
    ----------
    value : a number, or a text with its unit
    info : pydantic's state of the validation; numbers without unit are refused if the entry
        "unit_required" of its context is true
    si : the SI unit
    key : key of the quantity in the error message; "" leaves it out
    """
    try:
        unit_required = bool(info.context and info.context.get("unit_required"))
        return quantity_in_si(value, si, unit_required=unit_required)
    except ValueError as error:
        raise ValueError(f"{key} = {value!r} {error}" if key else str(error)) from error


def _make_validator_that_converts_quantity_to_si(si: str) -> BeforeValidator:
    """Make the pydantic validator that converts a quantity to this SI unit."""
    return BeforeValidator(partial(_quantity_of_brake_key_in_si, si=si))


def _check_title_is_one_line(text: str) -> str:
    """Return the title of a brake; ValueError unless it is one printable line without $.

    Titles stand above figures, in which matplotlib would read $ as the beginning of a formula.
    """
    if not text.isprintable() or "$" in text:
        raise ValueError("must be one line of printable characters, without $")
    return text


def _check_name_has_allowed_characters(text: str) -> str:
    """Return the name of a shoe or of a mesh group; ValueError for characters that are not allowed.

    Output files are named after shoes. In tables the name "all" stands for the whole brake.
    """
    if not re.fullmatch(r"\w([\w .+()-]*[\w+)])?", text) or text == "all":
        raise ValueError(
            "must be letters, digits, spaces and . _ + - ( ), "
            "a letter or digit at both ends; not 'all'"
        )
    return text


def check_shoe_names_differ(names: Sequence[str]) -> None:
    """Raise ValueError if the names of two shoes are equal or differ in case and spaces only.

    Output files are named after shoes, and the files of these two would overwrite each other.
    """
    if len({name.replace(" ", "_").casefold() for name in names}) < len(names):
        raise ValueError(
            f"shoe.name = {list(names)}: names must differ, not in case or spaces alone"
        )


PURE_NUMBER_VALIDATOR = BeforeValidator(number_without_unit_from_text)
"""The validator that reads a number without unit, which a file may write as "30 %" or "0,3"."""

# Types of the quantities of a brake file: each converts a text with a unit to a number in SI units.
Length = Annotated[float, _make_validator_that_converts_quantity_to_si("m")]
Thickness = Annotated[float, Field(gt=0), _make_validator_that_converts_quantity_to_si("m")]
Angle = Annotated[float, _make_validator_that_converts_quantity_to_si("rad")]
Force = Annotated[float, _make_validator_that_converts_quantity_to_si("N")]
Torque = Annotated[float, _make_validator_that_converts_quantity_to_si("N m")]
ElasticModulus = Annotated[float, Field(gt=0), _make_validator_that_converts_quantity_to_si("Pa")]
Area = Annotated[float, Field(gt=0), _make_validator_that_converts_quantity_to_si("m^2")]
SpringRate = Annotated[float, _make_validator_that_converts_quantity_to_si("N/m")]
Mass = Annotated[float, Field(gt=0), _make_validator_that_converts_quantity_to_si("kg")]
Acceleration = Annotated[float, Field(gt=0), _make_validator_that_converts_quantity_to_si("m/s^2")]
AngularSpeed = Annotated[float, Field(gt=0), _make_validator_that_converts_quantity_to_si("rad/s")]
PressureInFrictionTable = Annotated[
    float, Field(ge=0), _make_validator_that_converts_quantity_to_si("Pa")
]
SpeedInFrictionTable = Annotated[
    float, Field(ge=0), _make_validator_that_converts_quantity_to_si("m/s")
]
Speed = Annotated[float, Field(gt=0), _make_validator_that_converts_quantity_to_si("m/s")]
TemperatureRise = Annotated[float, _make_validator_that_converts_quantity_to_si("K")]
ThermalExpansionCoefficient = Annotated[float, _make_validator_that_converts_quantity_to_si("1/K")]
BendingStiffness = Annotated[
    float, Field(gt=0), _make_validator_that_converts_quantity_to_si("N m^2")
]
Title = Annotated[str, Field(min_length=1, max_length=80), AfterValidator(_check_title_is_one_line)]
Name = Annotated[
    str, Field(min_length=1, max_length=80), AfterValidator(_check_name_has_allowed_characters)
]


class PartOfInputFile(BaseModel):
    """Base class of a brake and of its parts: immutable data that refuse unknown keys."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, populate_by_name=True, defer_build=True
    )

    # Hints for the error message, by wrong keys that people write in place of an allowed key.
    hints_on_other_keys: ClassVar[Mapping[str, str]] = {}

    # Text that the error message adds if a file has a list of tables in place of one table.
    hint_if_several_are_given: ClassVar[str] = ""

    @model_validator(mode="before")
    @classmethod
    def _check_keys_are_known(cls, data: object) -> object:
        """Return the data unchanged; ValueError if they have a key that the part does not have."""
        allowed = _keys_of_part_in_files(cls)
        if isinstance(data, Mapping):
            for key in data:
                if key not in allowed and key not in cls.model_fields:
                    raise ValueError(cls.message_on_unknown_key(key, allowed))
        elif not isinstance(data, PartOfInputFile):
            several = cls.hint_if_several_are_given if isinstance(data, list) else ""
            raise ValueError(f"must be a table with keys of {', '.join(allowed)}{several}")
        return data

    @classmethod
    def message_on_unknown_key(cls, key: object, allowed: Collection[str]) -> str:
        """The message on a key that the part does not have: a hint, and the allowed keys."""
        hint = cls.hints_on_other_keys.get(str(key)) or did_you_mean_hint(str(key), allowed)
        return f"unknown key {key!r}{hint}; allowed: {', '.join(allowed)}"

    def __setattr__(self, name: str, value: object) -> None:
        """Set a private attribute. Raises BadInput for a field, because a part is immutable."""
        if not name.startswith("_"):
            raise BadInput(
                f"{name}: a brake cannot be changed; drumlin.vary(brake, {{KEY: VALUE}}) makes "
                "another brake"
            )
        super().__setattr__(name, value)

    def __copy__(self) -> Self:
        """Copy the fields of the part, but not the cached values of its properties.

        `model_copy` changes fields of the copy, and cached values would no longer fit them.
        """
        found = super().__copy__()
        # The dictionary of a part has its fields, and the cached values of its properties besides.
        for name in found.__dict__.keys() - type(self).model_fields:
            del found.__dict__[name]
        return found


@cache
def _keys_of_part_in_files(kind: type[PartOfInputFile]) -> list[str]:
    """The keys that a file may have for a part: the names of its fields, or their aliases.

    A file uses the alias of a field, such as `shoe` for the field `shoes`.
    """
    return [field.alias or name for name, field in kind.model_fields.items()]


class Material(PartOfInputFile):
    """A linear elastic, isotropic material: Young's modulus E [Pa] and Poisson's ratio nu.

    `expansion` [1/K] is the coefficient of thermal expansion, which only a heated part needs. The
    properties of this class have the names of the fields of `OrthotropicMaterial`, so that a
    program can treat both kinds of material alike.
    """

    E: ElasticModulus
    nu: Annotated[float, Field(gt=-1, lt=0.5, strict=True), PURE_NUMBER_VALIDATOR]
    expansion: ThermalExpansionCoefficient | None = None

    @property
    def expansion_along(self) -> float | None:
        """Coefficient of thermal expansion along the layer [1/K]; None if it is not given."""
        return self.expansion

    @property
    def expansion_through(self) -> float | None:
        """Coefficient of thermal expansion through the layer [1/K]; None if it is not given."""
        return self.expansion

    @property
    def E_along(self) -> float:
        """Young's modulus in the direction along the layer [Pa]."""
        return self.E

    @property
    def E_through(self) -> float:
        """Young's modulus in the direction of the layer's thickness [Pa]."""
        return self.E

    @property
    def G_along_through(self) -> float:
        """Shear modulus in the plane of the brake, between length and thickness of a layer [Pa]."""
        return self.E / (2 * (1 + self.nu))

    @property
    def nu_along_through(self) -> float:
        """Poisson's ratio: contraction of a layer's thickness per strain along the layer."""
        return self.nu

    @property
    def young_modulus_of_equivalent_half_plane(self) -> float:
        """Young's modulus [Pa] of the isotropic half-plane with the same surface compliance.

        For an isotropic material the result is the material's own E.
        """
        return self.E

    @property
    def moduli(self) -> dict[str, float]:
        """Young's and shear moduli [Pa] of the material by their keys in a brake file."""
        return {"E": self.E}


PoissonRatio = Annotated[float, Field(strict=True), PURE_NUMBER_VALIDATOR]
"""The type of a Poisson's ratio; its bounds depend on the other constants of the material."""
KEYS_OF_ORTHOTROPIC_CONSTANTS_ACROSS_PLANE = (
    "E_across",
    "G_along_across",
    "G_through_across",
    "nu_along_across",
    "nu_through_across",
)
"""Constants of an orthotropic material across the brake's plane, which only solids need."""

SMALLEST_SCALED_COMPLIANCE_DETERMINANT = 1e-12
"""Smallest allowed determinant of the scaled compliance matrix of an orthotropic material.

The matrix is scaled to a unit diagonal: entry (i, j) is divided by the square root of the product
of the diagonal entries i and j. With a positive determinant every strain has a positive energy. A
smaller determinant may be positive by round-off only, and the material is refused.
"""


class OrthotropicMaterial(PartOfInputFile):
    """A linear elastic orthotropic material of a layer, such as a lining of fibres.

    Its axes are "along" (the length of the layer), "through" (its thickness) and "across" (the
    width, normal to the plane of the brake). It has a Young's modulus E [Pa] for each axis, and a
    shear modulus G [Pa] and a Poisson's ratio nu for each pair of axes. A strain along the layer
    reduces its thickness by nu_along_through times the strain. Plane stress does not depend on the
    constants across; only the model of solids needs them. Only a heated part needs the coefficients
    of thermal expansion [1/K].
    """

    E_along: ElasticModulus
    E_through: ElasticModulus
    G_along_through: ElasticModulus
    nu_along_through: PoissonRatio
    E_across: ElasticModulus | None = None
    G_along_across: ElasticModulus | None = None
    G_through_across: ElasticModulus | None = None
    nu_along_across: PoissonRatio | None = None
    nu_through_across: PoissonRatio | None = None
    expansion_along: ThermalExpansionCoefficient | None = None
    expansion_through: ThermalExpansionCoefficient | None = None

    @model_validator(mode="after")
    def _check_strain_energy_is_positive(self) -> Self:
        """Raise ValueError for elastic constants with which some strain has no positive energy."""
        _check_poisson_ratio_is_small_enough(
            "nu_along_through",
            self.nu_along_through,
            self.E_along,
            self.E_through,
            ("along", "through"),
        )
        # A solid needs all five constants across the layer, plane stress needs none of them.
        missing = [
            key for key in KEYS_OF_ORTHOTROPIC_CONSTANTS_ACROSS_PLANE if getattr(self, key) is None
        ]
        if len(missing) == len(KEYS_OF_ORTHOTROPIC_CONSTANTS_ACROSS_PLANE):
            return self
        if missing:
            raise ValueError(
                f"{missing[0]} is missing: "
                f"{', '.join(KEYS_OF_ORTHOTROPIC_CONSTANTS_ACROSS_PLANE)} go together; "
                f"give all of them "
                f"or none"
            )
        # No constant across the layer is missing, which was checked above.
        assert (
            self.E_across is not None
            and self.nu_along_across is not None
            and self.nu_through_across is not None
        )
        _check_poisson_ratio_is_small_enough(
            "nu_along_across",
            self.nu_along_across,
            self.E_along,
            self.E_across,
            ("along", "across"),
        )
        # The other two Poisson's ratios set bounds for the third, between which the strain energy
        # is positive.
        low, high = self._bounds_of_poisson_ratio_through_across(
            self.E_across, self.nu_along_across
        )
        if not low < self.nu_through_across < high:
            raise ValueError(
                f"nu_through_across = {self.nu_through_across:g}: must be greater than {low:.6g} "
                f"and less than {high:.6g}, beside these moduli and Poisson's ratios"
            )
        return self

    def _bounds_of_poisson_ratio_through_across(
        self, E_across: float, nu_along_across: float
    ) -> tuple[float, float]:
        """Lower and upper bound of nu_through_across, between which the strain energy is positive.

        The compliance matrix is scaled to a unit diagonal. The other entries are then -a, -b and
        -c. Here a, b and c are Poisson's ratios along-through, along-across and through-across,
        each times the square root of the second Young's modulus divided by the first. The
        determinant 1 - a^2 - b^2 - c^2 - 2 a b c must be positive.
        """
        # The determinant is a quadratic function of c. The bounds of c are its two zeros.
        a = self.nu_along_through * math.sqrt(self.E_through / self.E_along)
        b = nu_along_across * math.sqrt(E_across / self.E_along)
        reach = math.sqrt(
            max((1 - a**2) * (1 - b**2) - SMALLEST_SCALED_COMPLIANCE_DETERMINANT, 0.0)
        )
        # Poisson's ratio is c times this factor.
        unit = math.sqrt(self.E_through / E_across)
        return (-a * b - reach) * unit, (-a * b + reach) * unit

    @property
    def young_modulus_of_equivalent_half_plane(self) -> float:
        """Young's modulus [Pa] of the isotropic half-plane with the same surface compliance.

        Under a sinusoidal pressure of amplitude p and wave number k the surface of an isotropic
        half-plane deflects by 2 p/(E k). For the orthotropic half-plane 2/E becomes the square root
        of 2 s_nn (sqrt(s_tt s_nn) + s_tn + s_gg/2) (Lekhnitskii, Anisotropic Plates, section 34).
        Here s are the compliances, t the direction along the surface, n the normal and g the shear.
        """
        s_tt, s_nn, s_gg = 1 / self.E_along, 1 / self.E_through, 1 / self.G_along_through
        s_tn = -self.nu_along_through / self.E_along
        return 2 / math.sqrt(2 * s_nn * (math.sqrt(s_tt * s_nn) + s_tn + s_gg / 2))

    @property
    def moduli(self) -> dict[str, float]:
        """Young's and shear moduli [Pa] of the material by their keys in a brake file."""
        keys = [key for key in type(self).model_fields if key.startswith(("E_", "G_"))]
        return {key: value for key in keys if (value := getattr(self, key)) is not None}


def _check_poisson_ratio_is_small_enough(
    key: str, nu: float, E: float, other: float, names: tuple[str, str]
) -> None:
    """Raise ValueError if a Poisson's ratio is too large for a positive strain energy.

    The square of Poisson's ratio must be less than the first Young's modulus divided by the second.

    Parameters
    ----------
    key : key of Poisson's ratio, for the error message
    nu : Poisson's ratio between two axes
    E, other : Young's moduli of the first and of the second axis [Pa]
    names : names of the two axes
    """
    most = math.sqrt(E / other)
    if 1 - (nu / most) ** 2 <= SMALLEST_SCALED_COMPLIANCE_DETERMINANT:
        raise ValueError(
            f"{key} = {nu:g}: must be greater than {-most:.6g} and less than {most:.6g}, "
            f"the root of E_{names[0]} / E_{names[1]}"
        )


def _tag_for_isotropic_or_orthotropic_material(data: object) -> str:
    """The tag by which pydantic chooses the class of a material: "isotropic" or "orthotropic".

    Data are orthotropic if they have any key of an orthotropic material.
    """
    if isinstance(data, Mapping):
        return "orthotropic" if set(data) & set(OrthotropicMaterial.model_fields) else "isotropic"
    return "orthotropic" if isinstance(data, OrthotropicMaterial) else "isotropic"


# The keys of a material tell whether it is read as isotropic or as orthotropic.
IsotropicOrOrthotropicMaterial = Annotated[
    Annotated[Material, Tag("isotropic")] | Annotated[OrthotropicMaterial, Tag("orthotropic")],
    Discriminator(_tag_for_isotropic_or_orthotropic_material),
]


class Point(PartOfInputFile):
    """A point with the coordinates x, y [m] in the plane of the brake."""

    # The polar angle [rad] in the brake file if it is more than a turn, for a note on wrong units.
    _written_angle: float | None = PrivateAttr(None)

    x: Length
    y: Length

    @property
    def angle_in_file_if_beyond_one_turn(self) -> float | None:
        """The polar angle [rad] in the brake file if it is more than one turn, else None."""
        return self._written_angle

    @property
    def xy(self) -> Floats:
        """The coordinates x, y of the point as an array (2,) [m]."""
        return np.array([self.x, self.y])

    @property
    def radius(self) -> float:
        """Distance of the point from the origin, which is the drum's centre [m]."""
        return math.hypot(self.x, self.y)

    @property
    def angle(self) -> float:
        """Polar angle of the point about the origin, from -pi to pi [rad]."""
        return math.atan2(self.y, self.x)


def _point_from_polar_coordinates(data: object, info: ValidationInfo) -> object:
    """Convert a point given in polar coordinates { radius, angle } to a `Point`.

    Data with neither of these keys are returned unchanged. Raises ValueError if one of the two keys
    is missing, for any other key, and for a negative radius.
    """
    if not isinstance(data, Mapping) or not {"radius", "angle"} & set(data):
        return data
    if set(data) != {"radius", "angle"}:
        raise ValueError("must be { radius = ..., angle = ... } or { x = ..., y = ... }")
    # A negative radius would silently put the point on the other side of the centre.
    radius = _quantity_of_brake_key_in_si(data["radius"], info, "m", "radius")
    if radius < 0:
        raise ValueError(f"radius = {data['radius']!r} must not be negative")
    angle = _quantity_of_brake_key_in_si(data["angle"], info, "rad", "angle")
    point = Point(x=radius * math.cos(angle), y=radius * math.sin(angle))
    if abs(angle) > 2 * math.pi:
        point._written_angle = angle
    return point


CartesianOrPolarPoint = Annotated[Point, BeforeValidator(_point_from_polar_coordinates)]
"""The type of a point that a brake file gives by { x, y } or by { radius, angle }."""

InterpolationTable = tuple[tuple[float, float], ...]
"""The type of a table of rows (coordinate, value), between which values are interpolated."""


def make_validator_of_number_or_table(
    place: str, place_si: str, name: str, si: str
) -> BeforeValidator:
    """Make the validator of a quantity that is constant or varies along a coordinate.

    The validator takes a number, or a table of rows (coordinate, value) with linear interpolation
    between the rows.

    Parameters
    ----------
    place, place_si : word for the coordinate in error messages, and its SI unit
    name, si : word for the value in error messages, and its SI unit
    """
    read = partial(
        _convert_number_or_table_to_si, si=si, place=place, name=name, row=(place_si, si)
    )
    return BeforeValidator(read)


def make_validator_of_table_with_growing_coordinates(
    place: str, place_si: str, name: str, si: str
) -> BeforeValidator:
    """Make the validator of a table of rows (coordinate, value) with growing coordinates.

    The parameters are as in `make_validator_of_number_or_table`.
    """
    return BeforeValidator(
        partial(_convert_table_rows_to_si, place=place, name=name, row=(place_si, si))
    )


def array_as_list_of_rows_or_number(value: object) -> object:
    """A numpy array as plain data: a list of rows for the shape (n, 2), a number for the shape ().

    A value that is no array is returned as it is. Raises ValueError for an array of another shape.
    """
    if not isinstance(value, np.ndarray):
        return value
    if value.shape and value.shape[1:] != (2,):
        raise ValueError(f"is an array of shape {value.shape}; must have the shape (N, 2)")
    return value.tolist()


def _convert_number_or_table_to_si(
    value: object, info: ValidationInfo, *, si: str, place: str, name: str, row: tuple[str, str]
) -> float | InterpolationTable:
    """Convert a number, or a table of rows (coordinate, value), to SI units.

    Raises ValueError for other data and for a table of fewer than two rows. `si` is the SI unit of
    a number in place of a table. The other parameters are as in `_convert_table_rows_to_si`.
    """
    value = array_as_list_of_rows_or_number(value)
    if not isinstance(value, list | tuple):
        return _quantity_of_brake_key_in_si(value, info, si)
    rows = _convert_table_rows_to_si(
        value,
        info,
        place=place,
        name=name,
        row=row,
        kinds=f"{NAME_OF_QUANTITY_BY_SI_UNIT[si]} or rows",
    )
    if len(rows) < 2:
        raise ValueError(f"the table needs at least two rows, with growing {place}s")
    return rows


def _convert_table_rows_to_si(
    value: object,
    info: ValidationInfo,
    *,
    place: str,
    name: str,
    row: tuple[str, str],
    kinds: str = "rows",
) -> InterpolationTable:
    """Convert the rows (coordinate, value) of a table to SI units.

    Raises ValueError for other data and for coordinates that do not grow.

    Parameters
    ----------
    value : the rows, each a list of two quantities
    info : pydantic's state of the validation
    place, name : words for coordinate and value in error messages
    row : SI units of coordinate and value
    kinds : words for the allowed data in error messages
    """
    items: Sequence[Any] = value if isinstance(value, list | tuple) else [value]
    rows: list[tuple[float, float]] = []
    for item in items:
        if not isinstance(item, list | tuple) or len(item) != 2:
            raise ValueError(
                f'must be {kinds} like ["{EXAMPLE_OF_QUANTITY_BY_SI_UNIT[row[0]]}", '
                f'"{EXAMPLE_OF_QUANTITY_BY_SI_UNIT[row[1]]}"]'
            )
        coordinate = _quantity_of_brake_key_in_si(item[0], info, row[0], place)
        rows.append((coordinate, _quantity_of_brake_key_in_si(item[1], info, row[1], name)))
    # Interpolation between the rows needs coordinates that grow from row to row.
    for k in range(1, len(rows)):
        if rows[k][0] <= rows[k - 1][0]:
            raise ValueError(
                f"the table needs growing {place}s, not {items[k][0]!r} after {items[k - 1][0]!r}"
            )
    return tuple(rows)


def si_unit_of_field_type(annotation: Any) -> str | None:
    """The SI unit of the quantity that a field of a part takes, found from the field's type.

    The result is "" for a field with a number without unit, and None for a field that takes no
    number.
    """
    unit: str | None = _validator_argument_in_field_type(annotation, "si", pure="")
    return unit


def si_units_of_table_field(annotation: Any) -> tuple[str, str]:
    """The SI units (coordinate, value) of the table that a field takes, from the field's type."""
    units: tuple[str, str] = _validator_argument_in_field_type(annotation, "row")
    return units


def _validator_argument_in_field_type(annotation: Any, key: str, pure: Any = None) -> Any:
    """An argument with which the validator in a field's type was made, such as its SI unit.

    Parameters
    ----------
    annotation : type of the field, with its validators
    key : name of the argument, "si" or "row"
    pure : value to return for a plain number, which has no validator

    Returns
    -------
    Any
        value of the argument; None if no validator in the type has it
    """
    kind: Any = annotation
    marks: tuple[Any, ...] = ()
    if get_origin(annotation) is Annotated:
        kind, marks = annotation.__origin__, annotation.__metadata__
    # Validators of quantities and tables are partial functions; the units are their keywords.
    for mark in marks:
        if not isinstance(mark, BeforeValidator) or not isinstance(mark.func, partial):
            continue
        if key in mark.func.keywords:
            return mark.func.keywords[key]
    if kind is float:
        return pure
    # If the field takes several types, the first type that has the argument counts.
    for part in get_args(kind):
        found = _validator_argument_in_field_type(part, key, pure)
        if found is not None:
            return found
    return None


def table_rows_from_coordinates_and_values(places: Floats, values: Floats) -> InterpolationTable:
    """Make the table of rows (coordinate, value) from two arrays (n,).

    `places` are the coordinates of the rows; they must grow.
    """
    return tuple(zip(places.tolist(), values.tolist(), strict=True))


NUMBER_OF_ROWS_OF_TABULATED_CLEARANCE = 1001
"""Number of rows of the table, along the lining, that replaces a clearance given as a function.

Between the rows the clearance is linear. A sine whose period is the length of the lining is met
within 5e-6 of its amplitude. With a quarter of the rows, the kinks at the rows would count as edges
that need small elements: a parabola that opens the gap by 0.1 mm took 100 times as long to solve.
"""


def make_validator_that_tabulates_function_along_lining() -> BeforeValidator:
    """Make the validator that turns a function of the lining's coordinate into a table of rows.

    The coordinate is the angle [rad] on a drum, and x [m] on a plane. The function takes a
    coordinate and returns a value in SI. The rows of the table stand at equal distances from the
    lining's start to its end.
    """
    return BeforeValidator(_table_rows_of_function_along_lining)


def _table_rows_of_function_along_lining(value: object, info: ValidationInfo) -> object:
    """The table of rows (coordinate, value) for a function along a lining; else the value itself.

    `info` is pydantic's state of the validation, which has the ends of the lining.
    """
    if not callable(value) or not {"start", "end"} <= set(info.data):
        return value
    ends = info.data["start"], info.data["end"]
    return table_rows_of_function_at_coordinates(
        value, np.linspace(*ends, NUMBER_OF_ROWS_OF_TABULATED_CLEARANCE)
    )


def table_rows_of_function_at_coordinates(
    function: Callable[..., Any], places: Floats
) -> list[list[float]]:
    """The values of a function at the coordinates `places` (n,), as n rows (coordinate, value).

    Raises ValueError for values that are not numbers.
    """
    try:
        # The function is called for each number, since it need not take an array.
        values = [float(function(place)) for place in places.tolist()]
    except (TypeError, ValueError) as error:
        raise ValueError(f"must be a function from a number to a number ({error})") from error
    return np.column_stack([places, values]).tolist()


def interpolate_number_or_table(values: float | InterpolationTable, places: Floats) -> Floats:
    """Interpolate a table linearly at the coordinates `places`; the result has their shape.

    Beyond its first and last row a table is constant. A number in place of a table is constant.
    """
    if isinstance(values, tuple):
        at, value = zip(*values, strict=True)
        return np.interp(places, at, value)
    return np.full(np.shape(places), values)
