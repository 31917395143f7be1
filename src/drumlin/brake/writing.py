"""Write a brake as the text of a brake file, with a unit on every quantity."""

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
"""Parts that are written in one line, in braces."""

READABLE = {"m": ("mm", "m"), "rad": ("deg",), "Pa": ("GPa", "MPa"), "N": ("kN", "N")}
"""Units that people read easily, by SI unit, in the order of trial."""


def brake_text(brake: Part) -> str:
    """The text of a brake file that reads as exactly this brake, without keys at their default.

    Paths of mesh files are written as they are in the brake, so that they are found from the same
    folder. Raises BadInput for a path with bytes that are no UTF-8: no brake file can name it.
    """
    return "\n".join(_table(_as_given(brake), "")).strip() + "\n"


def _as_given(brake: Part) -> Part:
    """The brake without the forces that follow from its drive and its struts.

    A file must not repeat these forces.
    """
    if not isinstance(brake, Brake) or not (brake.actuation or brake.links):
        return brake
    pushed = {link.to for link in brake.links}
    shoes = []
    for shoe in brake.shoes:
        actuation = shoe.actuation
        if shoe.name in pushed:
            actuation = Held.model_fields["actuation"].default
        elif brake.actuation:
            actuation = actuation.model_copy(update={"force": math.nan})
        shoes.append(shoe.model_copy(update={"actuation": actuation}))
    return brake.model_copy(update={"shoes": tuple(shoes)})


def _fields(part: Part) -> Iterator[tuple[str, Any, FieldInfo]]:
    """Key, value and field of each value that is not the default."""
    for name, field in type(part).model_fields.items():
        value = getattr(part, name)
        # The default of a force is for shoes under a drive, whose force is nan here.
        if isinstance(part, Actuation) and name == "force":
            if not math.isnan(value):
                yield name, value, field
        elif field.is_required() or value != field.get_default(call_default_factory=True):
            yield field.alias or name, value, field


def _table(part: Part, path: str) -> Iterator[str]:
    """The lines of a table: its own keys first, then the tables below it."""
    below = []
    for key, value, field in _fields(part):
        parts = value if isinstance(value, tuple) else (value,)
        tables = [isinstance(item, Part) and not isinstance(item, INLINE) for item in parts]
        if value != () and all(tables):
            below.append((key, value))
        else:
            yield f"{key} = {_value(value, field)}"
    for key, value in below:
        name = f"{path}.{key}" if path else key
        several = isinstance(value, tuple)
        for item in value if several else (value,):
            yield ""
            yield f"[[{name}]]" if several else f"[{name}]"
            yield from _table(item, name)


def _value(value: Any, field: FieldInfo) -> str:
    """The text of a value."""
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
        rows = [f"[{quantity_text(a, place)}, {quantity_text(b, size)}]" for a, b in value]
        return f"[{', '.join(rows)}]"
    return quantity_text(value, unit_in(kind) or "")


def _quoted(text: str) -> str:
    """A text in quotes, with the escapes of JSON, which TOML takes, and one for DEL."""
    try:
        text.encode("utf-8")
    except UnicodeEncodeError as error:
        raise BadInput(
            f"{text}: has bytes that are no UTF-8; a brake file cannot name it"
        ) from error
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _inline(part: Part) -> str:
    """The text of a part in one line."""
    pairs = [f"{key} = {_value(value, field)}" for key, value, field in _fields(part)]
    return f"{{ {', '.join(pairs)} }}"


def quantity_text(value: float, si: str) -> str:
    """A number [SI] as a quoted text with a readable unit, which reads as exactly this number.

    A pure number, with an empty unit `si`, is written without quotes.
    """
    if not si:
        return repr(value)
    for unit in READABLE.get(si, ()):
        text = f"{value / COMMON[si][unit]:.12g} {unit}"
        if to_si(text, si, unit_required=True) == value and "e" not in text.split(maxsplit=1)[0]:
            return json.dumps(text)
    return json.dumps(f"{value!r} {si}")
