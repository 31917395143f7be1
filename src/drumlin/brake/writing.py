"""A brake as the text of a brake file: what `read_brake` reads, every quantity with its unit."""

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

from pydantic.fields import FieldInfo

from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake
from drumlin.brake.components import Actuation, Lobes, Misfit, Table
from drumlin.brake.fields import Material, Orthotropic, Part, Point, row_units_in, unit_in
from drumlin.brake.support import Held
from drumlin.brake.units import COMMON, to_si

INLINE = (Material, Orthotropic, Point, Misfit, Lobes, Table)
READABLE = {"m": ("mm", "m"), "rad": ("deg",), "Pa": ("GPa", "MPa"), "N": ("kN", "N")}


def brake_text(brake: Part) -> str:
    """The text of a brake file that reads as exactly this brake; keys that have their default are
    left out.

    Paths of mesh files are written as they are in the brake, so that they are found from the same
    folder. Raises BadInput for a path with bytes that are no UTF-8, which no brake file can name.
    """
    return "\n".join(_table(_as_given(brake), "")).strip() + "\n"


def _as_given(brake: Part) -> Part:
    """The brake without the forces that follow from its drive and its struts: a file must not
    repeat them.
    """
    if not isinstance(brake, Brake) or not (brake.actuation or brake.links):
        return brake
    pushed = {link.to for link in brake.links}
    none = Held.model_fields["actuation"].default
    shoes = tuple(
        shoe.model_copy(update={"actuation": none}) if shoe.name in pushed
        else shoe.model_copy(update={"actuation": shoe.actuation.model_copy(update={"force": math.nan})})
        if brake.actuation else shoe
        for shoe in brake.shoes
    )  # fmt: skip
    return brake.model_copy(update={"shoes": shoes})


def _fields(part: Part) -> Iterator[tuple[str, Any, FieldInfo]]:
    """Key, value and field of what is not left at its default."""
    for name, field in type(part).model_fields.items():
        value = getattr(part, name)
        if (
            isinstance(part, Actuation) and name == "force"
        ):  # its default is that of a shoe that something else pushes
            if not math.isnan(value):
                yield name, value, field
        elif field.is_required() or value != field.get_default(call_default_factory=True):
            yield field.alias or name, value, field


def _table(part: Part, path: str) -> Iterator[str]:
    """The lines of a table: its own keys first, then the tables below it."""
    below = []
    for key, value, field in _fields(part):
        parts = value if isinstance(value, tuple) else (value,)
        if value != () and all(
            isinstance(item, Part) and not isinstance(item, INLINE) for item in parts
        ):
            below.append((key, value))
        else:
            yield f"{key} = {_value(value, field)}"
    for key, value in below:
        name = f"{path}.{key}" if path else key
        for item in value if isinstance(value, tuple) else (value,):
            yield from ("", f"[[{name}]]" if isinstance(value, tuple) else f"[{name}]")
            yield from _table(item, name)


def _value(value: Any, field: FieldInfo) -> str:
    if isinstance(value, Part):
        return _inline(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str | Path):
        return _quoted(str(value))
    if isinstance(value, tuple) and any(isinstance(item, Part) for item in value):
        return "[" + ", ".join(_inline(item) for item in value) + "]"
    kind = Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
    if isinstance(value, tuple):
        place, size = row_units_in(kind)
        return (
            "["
            + ", ".join(f"[{quantity_text(a, place)}, {quantity_text(b, size)}]" for a, b in value)
            + "]"
        )
    return quantity_text(value, unit_in(kind) or "")


def _quoted(text: str) -> str:
    """A text in quotes: TOML takes the escapes of JSON, and wants one for DEL as well."""
    try:
        text.encode("utf-8")
    except UnicodeEncodeError as error:
        raise BadInput(
            f"{text}: has bytes that are no UTF-8; a brake file cannot name it"
        ) from error
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _inline(part: Part) -> str:
    return (
        "{ "
        + ", ".join(f"{key} = {_value(value, field)}" for key, value, field in _fields(part))
        + " }"
    )


def quantity_text(value: float, si: str) -> str:
    """A number [SI] as a quoted text with a readable unit that reads as the same number; bare where
    `si` is empty.
    """
    if not si:
        return repr(value)
    for unit in READABLE.get(si, ()):
        text = f"{value / COMMON[si][unit]:.12g} {unit}"
        if to_si(text, si, unit_required=True) == value and "e" not in text.split(maxsplit=1)[0]:
            return json.dumps(text)
    return json.dumps(f"{value!r} {si}")
