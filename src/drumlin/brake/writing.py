"""Write a brake as the text of a brake file, with a unit on every quantity."""

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

from pydantic.fields import FieldInfo

from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake
from drumlin.brake.components import (
    Actuation,
    DrumLiningRow,
    Misfit,
    OutOfRoundHarmonic,
    TableOfTSection,
)
from drumlin.brake.fields import (
    Material,
    OrthotropicMaterial,
    PartOfInputFile,
    Point,
    si_unit_of_field_type,
    si_units_of_table_field,
)
from drumlin.brake.friction import FrictionTable
from drumlin.brake.support import SupportedShoe
from drumlin.brake.units import FACTORS_OF_COMMON_UNITS_BY_SI_UNIT, quantity_in_si

CLASSES_OF_PARTS_WRITTEN_IN_ONE_LINE = (
    Material,
    OrthotropicMaterial,
    Point,
    Misfit,
    OutOfRoundHarmonic,
    TableOfTSection,
    FrictionTable,
)
"""Classes of parts that are written as { key = value, ... } in one line of a brake file."""

UNITS_WRITTEN_IN_BRAKE_FILES = {
    "m": ("mm", "m"),
    "rad": ("deg",),
    "Pa": ("GPa", "MPa"),
    "N": ("kN", "N"),
    "m^2": ("cm^2",),
    "N/m": ("N/mm",),
    "K": ("K",),
}
"""Units in which a brake file is written, by SI unit.

The first unit in which the number is short and exact is used, else the SI unit.
"""


def brake_file_text(brake: PartOfInputFile) -> str:
    """The text of a brake file from which exactly this brake is read again.

    Keys with their default value are left out. Paths of mesh files are written as they are in the
    brake: relative paths are valid from the current folder only. Raises BadInput for a path that is
    no UTF-8, because a brake file cannot name it.
    """
    return (
        "\n".join(_toml_lines_of_part(_brake_without_forces_of_drive_and_struts(brake), "")).strip()
        + "\n"
    )


def _brake_without_forces_of_drive_and_struts(brake: PartOfInputFile) -> PartOfInputFile:
    """The brake as its file describes it: without forces that follow from a drive or a strut.

    A brake file must not give these forces. A force that follows from a drive is set to nan, which
    marks it to be left out.
    """
    if not isinstance(brake, Brake) or not (brake.actuation or brake.links):
        return brake
    # A strut gives a shoe its whole actuation, a drive gives it the force alone.
    pushed = brake.names_of_shoes_pushed_by_struts
    shoes = []
    for shoe in brake.shoes:
        actuation = shoe.actuation
        if shoe.name in pushed:
            actuation = SupportedShoe.model_fields["actuation"].default
        elif brake.actuation:
            actuation = actuation.model_copy(update={"force": math.nan})
        shoes.append(shoe.model_copy(update={"actuation": actuation}))
    return brake.model_copy(update={"shoes": tuple(shoes)})


def part_values_other_than_defaults(part: PartOfInputFile) -> Iterator[tuple[str, Any, FieldInfo]]:
    """Yield (key in the file, value, pydantic field) of each field that is not at its default."""
    for name, field in type(part).model_fields.items():
        value = getattr(part, name)
        # A force of nan follows from the drive and is left out. Any other force of an actuation is
        # written, even if it is the default 0.
        if isinstance(part, Actuation) and name == "force":
            if not math.isnan(value):
                yield name, value, field
        elif field.is_required() or value != field.get_default(call_default_factory=True):
            yield field.alias or name, value, field


def _toml_lines_of_part(part: PartOfInputFile, path: str) -> Iterator[str]:
    """Lines of a part as a TOML table: first its own keys, then the tables of the parts in it.

    `path` is the dotted name of the table; it is "" for the whole brake.
    """
    # TOML requires that the keys of a table precede the tables within it.
    below = []
    for key, given, field in part_values_other_than_defaults(part):
        value: Any = given.parts if isinstance(given, DrumLiningRow) else given
        parts = value if isinstance(value, tuple) else (value,)
        tables = [
            isinstance(item, PartOfInputFile)
            and not isinstance(item, CLASSES_OF_PARTS_WRITTEN_IN_ONE_LINE)
            for item in parts
        ]
        if value != () and all(tables):
            below.append((key, value))
        else:
            yield f"{key} = {_toml_text_of_value(value, field)}"
    # A tuple of parts, such as the shoes, becomes an array of tables, [[name]].
    for key, value in below:
        name = f"{path}.{key}" if path else key
        several = isinstance(value, tuple)
        items = value if several else (value,)
        for item in items:
            yield ""
            yield f"[[{name}]]" if several else f"[{name}]"
            yield from _toml_lines_of_part(item, name)


def _toml_text_of_value(value: Any, field: FieldInfo) -> str:
    """The text of a value of a part in TOML; `field` is the pydantic field, which has its unit."""
    if isinstance(value, PartOfInputFile):
        return _toml_text_of_part_in_one_line(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str | Path):
        return _toml_text_in_quotes(str(value))
    if isinstance(value, tuple) and any(isinstance(item, PartOfInputFile) for item in value):
        return "[" + ", ".join(_toml_text_of_part_in_one_line(item) for item in value) + "]"
    # The type of the field tells the units of a number or of a table of numbers.
    kind = Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
    if isinstance(value, tuple):
        return f"[{', '.join(_toml_texts_of_table_rows(value, kind))}]"
    return quoted_toml_text_of_quantity(value, si_unit_of_field_type(kind) or "")


def _toml_texts_of_table_rows(rows: tuple[Any, ...], kind: Any) -> list[str]:
    """Texts of the rows of a table, or of the numbers in a column of a friction table.

    `kind` is the type of the field, which has the units.
    """
    if not isinstance(rows[0], tuple):
        si = si_unit_of_field_type(kind) or ""
        return [quoted_toml_text_of_quantity(item, si) for item in rows]
    place, size = si_units_of_table_field(kind)
    return [
        f"[{quoted_toml_text_of_quantity(a, place)}, {quoted_toml_text_of_quantity(b, size)}]"
        for a, b in rows
    ]


def _toml_text_in_quotes(text: str) -> str:
    """A text in quotes for TOML. Raises BadInput for a text that is no UTF-8.

    Special characters are escaped as in JSON, which TOML accepts; DEL is escaped in addition.
    """
    try:
        text.encode("utf-8")
    except UnicodeEncodeError as error:
        raise BadInput(
            f"{text}: has bytes that are no UTF-8; a brake file cannot name it"
        ) from error
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _toml_text_of_part_in_one_line(part: PartOfInputFile) -> str:
    """The text of a part in TOML in one line: { key = value, ... }."""
    pairs = [
        f"{key} = {_toml_text_of_value(value, field)}"
        for key, value, field in part_values_other_than_defaults(part)
    ]
    return f"{{ {', '.join(pairs)} }}"


def quoted_toml_text_of_quantity(value: float, si: str) -> str:
    """A quantity as the quoted text of a brake file, such as "150 mm", exact to the last digit.

    `value` is the number in the SI unit `si`. A number without unit (`si` is "") has no quotes.
    """
    if not si:
        return repr(value)
    # A readable unit is used only if reading the text gives exactly the same number.
    for unit in UNITS_WRITTEN_IN_BRAKE_FILES.get(si, ()):
        text = f"{value / FACTORS_OF_COMMON_UNITS_BY_SI_UNIT[si][unit]:.12g} {unit}"
        if (
            quantity_in_si(text, si, unit_required=True) == value
            and "e" not in text.split(maxsplit=1)[0]
        ):
            return json.dumps(text)
    return json.dumps(f"{value!r} {si}")
