"""Read brake files, get values of a brake by their keys, and make brakes with changed values.

Brake files are in TOML, with a unit on every quantity. An error in a file is reported in one line.
"""

import math
import re
import tomllib
from collections.abc import Mapping, Sequence
from copy import deepcopy
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args

from pydantic import ValidationError

from drumlin.base.errors import BadInput
from drumlin.base.files import read_text
from drumlin.base.texts import check_toml_parses_quickly, did_you_mean_hint, value_as_text
from drumlin.brake.brake import Brake
from drumlin.brake.components import Lining
from drumlin.brake.drive import key_that_sets_actuation_force_of_shoe
from drumlin.brake.drum_brake import DrumBrake
from drumlin.brake.fields import PartOfInputFile, Point, si_unit_of_field_type
from drumlin.brake.friction import FrictionTable
from drumlin.brake.units import (
    EXAMPLE_OF_QUANTITY_BY_SI_UNIT,
    NAME_OF_QUANTITY_BY_SI_UNIT,
    quantity_in_si,
    quantity_with_usual_unit,
)

SI_UNITS_BY_POLAR_POINT_KEY = {"radius": "m", "angle": "rad"}
"""The keys of a point in polar coordinates, in a file, with their SI units."""

MAX_BYTES_OF_BRAKE_FILE = 500_000
"""Largest size of a brake file [bytes]; a larger file is refused. Usual files have 1000 bytes."""

ALLOWED_VALUE_TEXT_BY_PYDANTIC_ERROR = {
    "tuple_type": "must be tables, each under [[{key}]]",
    "dict_type": "must be a table, [{key}]",
    "too_short": "needs one entry at least",
    "string_type": "must be a text",
    "path_type": "must be the name of a file",
    "float_type": "must be a number",
    "float_parsing": "must be a number",
    "int_type": "must be a whole number",
    "int_parsing": "must be a whole number",
    "bool_type": "must be true or false",
    "bool_parsing": "must be true or false",
}
"""Texts that say what a value must be, by pydantic's name of the error.

pydantic's own messages for these errors use words of Python, such as "tuple".
"""


WORDS_IN_PYDANTIC_PATH_THAT_ARE_NO_KEYS = {
    *("arc", "beam", "isotropic", "orthotropic", "float", "str"),
    *("one lining", "several linings", "parts"),
    *("friction number", "friction table"),
}
"""Words in pydantic's path to a wrong value that are no keys of the brake file.

Each word says which of several types pydantic took for the data, such as "beam" for a body.
"""


def _dotted_key_of_pydantic_path(path: Sequence[int | str]) -> str:
    """The dotted key, such as "shoe[0].lining.width", of pydantic's path to a value."""
    key = ""
    for step in path:
        if step not in WORDS_IN_PYDANTIC_PATH_THAT_ARE_NO_KEYS:
            key += f"[{step}]" if isinstance(step, int) else f".{step}" if key else str(step)
    return key


def _hint_on_missing_keys(error: ValidationError, kind: type[PartOfInputFile]) -> str:
    """An example of the first missing value, and the names of all other missing keys.

    The hint is such as "; write a length such as '8 mm'; also missing: shoe[0].lining.end". `kind`
    is the class that the data should have become.
    """
    paths = [fault["loc"] for fault in error.errors() if fault["type"] == "missing"]
    unit = _si_unit_of_value_at_pydantic_path(kind, paths[0])
    hint = ""
    if unit:
        name, example = NAME_OF_QUANTITY_BY_SI_UNIT[unit], EXAMPLE_OF_QUANTITY_BY_SI_UNIT[unit]
        hint = f"; write {name} such as {example!r}"
    others = [_dotted_key_of_pydantic_path(path) for path in paths[1:]]
    return f"{hint}; also missing: {', '.join(others)}" if others else hint


def _si_unit_of_value_at_pydantic_path(
    kind: type[PartOfInputFile], path: Sequence[int | str]
) -> str | None:
    """The SI unit of the value at pydantic's path in a class of parts; None if it is not known."""
    classes, unit = [kind], None
    for step in path:
        if isinstance(step, int) or step in WORDS_IN_PYDANTIC_PATH_THAT_ARE_NO_KEYS:
            continue
        units, below = set(), []
        for each in classes:
            for name, field in each.model_fields.items():
                if step == (field.alias or name):
                    whole: Any = field.annotation
                    if field.metadata:
                        whole = Annotated[whole, *field.metadata]
                    units.add(si_unit_of_field_type(whole))
                    below += _classes_of_parts_in_type(field.annotation)
        classes, unit = below, units.pop() if len(units) == 1 else None
    return unit


def _classes_of_parts_in_type(annotation: Any) -> list[type[PartOfInputFile]]:
    """The classes of parts in a type: alternatives of a union, or the items of a tuple."""
    if isinstance(annotation, type) and issubclass(annotation, PartOfInputFile):
        return [annotation]
    found: list[type[PartOfInputFile]] = []
    for inner in get_args(annotation):
        found += _classes_of_parts_in_type(inner)
    return found


def _error_line_about_invalid_brake_data(
    error: ValidationError, data: Any, kind: type[PartOfInputFile]
) -> str:
    """One line about the first error in the data of a brake file: "key = value: what is allowed".

    Parameters
    ----------
    error : pydantic's list of errors
    data : data of the brake file, from which the wrong value is shown
    kind : class that the data should have become
    """
    fault = error.errors()[0]
    # pydantic's path to the wrong value is followed through the data.
    key = _dotted_key_of_pydantic_path(fault["loc"])
    for step in fault["loc"]:
        if step in WORDS_IN_PYDANTIC_PATH_THAT_ARE_NO_KEYS:
            continue
        try:
            data = data[step]
        except (LookupError, TypeError):
            data = None
    # A message of pydantic that uses words of Python is replaced.
    message = fault["msg"].removeprefix("Value error, ").replace("Input should be", "must be")
    if fault["type"] in ALLOWED_VALUE_TEXT_BY_PYDANTIC_ERROR:
        message = ALLOWED_VALUE_TEXT_BY_PYDANTIC_ERROR[fault["type"]].format(key=key)
    if fault["type"] == "missing":
        return f"{key}: is missing{_hint_on_missing_keys(error, kind)}"
    if key.endswith("misfit.radius") and fault["type"].startswith("greater_than"):
        message += (
            "; it is the radius of the lining's face itself, not its difference from the drum's"
        )
    shown = f" = {value_as_text(data)}" if isinstance(data, str | int | float) else ""
    # A long value is cut off, so that the line still shows what is allowed.
    if len(shown) > 60:
        shown = shown[:57] + "..."
    return " ".join(f"{key}{shown}: {message}".removeprefix(": ").split())


BrakePartTypeVariable = TypeVar("BrakePartTypeVariable", bound=PartOfInputFile)


def make_validated_brake_part(
    kind: type[BrakePartTypeVariable],
    data: Mapping[str, Any],
    *,
    unit_required: bool = False,
    base: Path | None = None,
) -> BrakePartTypeVariable:
    """Make a brake, or a part of a brake, from nested data as a brake file has them.

    Parameters
    ----------
    kind : class to make
    data : nested tables of keys and values
    unit_required : whether numbers without unit are refused; otherwise they count as SI
    base : folder from which relative paths of mesh files start

    Raises
    ------
    BadInput
        with one line that names the key, the value and what is allowed
    """
    try:
        return kind.model_validate(data, context={"unit_required": unit_required, "base": base})
    except ValidationError as error:
        # A traceback in Python ends with this line. The text of pydantic would stand above it, with
        # hundreds of lines for a table.
        raise BadInput(_error_line_about_invalid_brake_data(error, data, kind)) from None


def make_drum_brake_from_data(
    data: Mapping[str, Any], *, unit_required: bool = False, base: Path | None = None
) -> Brake:
    """Make a brake on a drum from the nested data of a brake file.

    Raises BadInput for wrong data. The parameters are as in `make_validated_brake_part`.
    """
    return make_validated_brake_part(DrumBrake, data, unit_required=unit_required, base=base)


def read_text_of_brake_file(path: Path) -> str:
    """Read the text of a brake file; raises BadInput if the file cannot be read."""
    return read_text(path, MAX_BYTES_OF_BRAKE_FILE, "a brake file")


def parse_text_of_brake_file(text: str, path: Path) -> dict[str, Any]:
    """Parse the text of the brake file `path`; raises BadInput if it is not TOML."""
    try:
        check_toml_parses_quickly(text)
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise BadInput(
            f"{path}: is not TOML ({error}){_hint_about_toml_error(text, error)}"
        ) from error


# Pairs: a pattern of lines that TOML does not take, and the hint on what to write.
_HINTS_WITH_PATTERN_OF_WRONG_TOML_LINE = (
    (r"^\s*\[{1,2}\s*(?:shoe|link)\s*\]", "write [[shoe]] in double brackets above each shoe"),
    ("[“”„‟«»‘’]", 'write quotes as "'),
    (r"[^\x00-\x7f]", "the line has a sign outside of quotes that only looks like a plain one"),
    (r"=\s*[-+]?\d+,\d+\s*$", "a number has a decimal point, not a comma"),
    (r"=\s*[-+]?[\d.,]+\s*[A-Za-z%°µ]", 'a quantity with its unit stands in quotes, as "8 mm"'),
)


def _hint_about_toml_error(text: str, error: Exception) -> str:
    """A hint on what to write in the line that a TOML error names, as "; write quotes as ...".

    The hint is "" if the cause is unknown.
    """
    at = re.search(r"at line (\d+)", str(error))
    lines = text.split("\n")
    if at is None or int(at.group(1)) > len(lines):
        return ""
    number = int(at.group(1))
    # Texts in quotes are emptied, and comments removed, because they cannot be the cause.
    complete = r'"(?:\\.|[^"\\])*"|\'[^\']*\'|#.*'
    line = re.sub(complete, lambda found: "" if found[0][0] == "#" else "''", lines[number - 1])
    # A text in quotes must end on its line. A quotation mark that is left begins or ends no text.
    if '"' in line:
        return f"; a quotation mark is missing in line {number}"
    for pattern, hint in _HINTS_WITH_PATTERN_OF_WRONG_TOML_LINE:
        if re.search(pattern, line):
            return f"; {hint}"
    return ""


def read_data_of_brake_file(path: Path) -> dict[str, Any]:
    """Read a brake file into nested data; raises BadInput if it cannot be read or is not TOML."""
    return parse_text_of_brake_file(read_text_of_brake_file(path), path)


def read_brake(path: Path, text: str | None = None) -> Brake:
    """Read a brake on a drum from the TOML file `path`, in which every quantity has a unit.

    `text` is the content of the file if it has been read already. Raises BadInput with one line
    that names the key, the value and what is allowed.
    """
    data = read_data_of_brake_file(path) if text is None else parse_text_of_brake_file(text, path)
    try:
        return make_drum_brake_from_data(data, unit_required=True, base=path.parent)
    except BadInput as error:
        raise BadInput(f"{path}: {error}{name_of_shoe_in_error_line(str(error), data)}") from error


def name_of_shoe_in_error_line(line: str, data: Mapping[str, Any]) -> str:
    """The name of the shoe that an error line calls by its number, as " (shoe[0] is 'left')".

    The result is "" if the line has no number of a shoe, or its shoe has no name. `data` are those
    of the brake file.
    """
    found = re.match(r"shoe\[(\d+)\]", line)
    shoes = data.get("shoe")
    if found is None or not isinstance(shoes, list) or int(found[1]) >= len(shoes):
        return ""
    shoe = shoes[int(found[1])]
    name = shoe.get("name") if isinstance(shoe, dict) else None
    # The line already has the name if the name itself is wrong.
    if not isinstance(name, str) or not name or line.startswith(f"{found[0]}.name"):
        return ""
    return f" ({found[0]} is {name!r})"


def vary(brake: BrakePartTypeVariable, changes: Mapping[str, Any]) -> BrakePartTypeVariable:
    """Make a brake in which some keys have other values; the new brake is checked like a file.

    Parameters
    ----------
    brake : as `read_brake` gives it
    changes : new values by key, in SI or as texts with a unit; a key is written as in the file's
        error lines, "shoe[0].lining.thickness", or with a shoe's name, "shoe.left.hinge.angle";
        "shoe.lining.thickness" changes every shoe

    Returns
    -------
    Brake
        another brake; the given one stays as it is

    Raises
    ------
    BadInput
        for a key that does not exist, for the force of a shoe that a cylinder, a cam or a strut
        sets, or for a brake that does not fit together, in one line

    Examples
    --------
    >>> brake = drumlin.example("double_shoe")
    >>> drumlin.vary(brake, {"friction": 0.4, "drum.radius": "150 mm"}).friction
    0.4
    """
    if not isinstance(changes, Mapping):
        raise BadInput(
            f"changes = {value_as_text(changes)}: must be a dict of new values by key, "
            'such as {"friction": 0.3}'
        )
    # All changes are made before the brake is checked: they may be valid only together.
    data = brake.model_dump(by_alias=True)
    for key, value in changes.items():
        _refuse_key_without_its_beginning(brake, key)
        if not _set_value_of_key_in_nested_data(data, _split_dotted_key(key), value, key):
            raise BadInput(f"{key}: the brake has no such part")
    varied = make_validated_brake_part(type(brake), data)
    for key in changes:
        if _split_dotted_key(key)[-1] == "force":
            _refuse_force_of_shoe_that_drive_or_strut_sets(varied, key)
    return varied


def _refuse_force_of_shoe_that_drive_or_strut_sets(brake: Any, key: str) -> None:
    """Raise BadInput if a key is the actuation force of shoes, and none of them has its own force.

    A drive or a strut would set the force to another value.
    """
    parts, _ = parts_and_field_name_of_brake_key(brake, key)
    shoes = [shoe for shoe in brake.shoes if any(part is shoe.actuation for part in parts)]
    setting = [key_that_sets_actuation_force_of_shoe(brake, shoe) for shoe in shoes]
    if setting and None not in setting:
        by = "a strut pushes this shoe" if brake.actuation is None else "[actuation] gives it"
        raise BadInput(f"{key}: has no effect, {by}; change {setting[0]}")


def si_unit_of_brake_key(brake: PartOfInputFile, key: str) -> str | None:
    """The SI unit of the quantity that a key of a brake holds.

    The result is "" for a number without unit, and None if the value is no number. The key is
    written as for `vary`. Raises BadInput for an unknown key.
    """
    parts, name = parts_and_field_name_of_brake_key(brake, key)
    if isinstance(parts[0], Point) and name in SI_UNITS_BY_POLAR_POINT_KEY:
        return SI_UNITS_BY_POLAR_POINT_KEY[name]
    field = type(parts[0]).model_fields[name]
    kind = Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
    return si_unit_of_field_type(kind)


def are_allowed_values_of_key_an_interval(brake: PartOfInputFile, key: str) -> bool:
    """Whether the allowed positive values of a key form one interval, and the negative ones too.

    All other keys keep their values. The result is True for lengths, forces, moduli and numbers
    without unit, which have upper and lower limits only. The result is False for angles and for
    coordinates of points, where a value between allowed values may be forbidden, such as the
    direction of a force through the hinge.
    """
    unit = si_unit_of_brake_key(brake, key)
    return unit not in {None, "rad"} and not isinstance(
        parts_and_field_name_of_brake_key(brake, key)[0][0], Point
    )


def values_of_brake_key(brake: PartOfInputFile, key: str) -> list[Any]:
    """The values of a key in a list: one value, or one for each shoe if the key means all shoes.

    The key is written as for `vary`. Raises BadInput for an unknown key.
    """
    parts, name = parts_and_field_name_of_brake_key(brake, key)
    return [getattr(part, name) for part in parts]


def parts_and_field_name_of_brake_key(
    brake: PartOfInputFile, key: str
) -> tuple[list[PartOfInputFile], str]:
    """The parts of a brake that have a key, and the Python name of the field for this key.

    There are several parts if the key means every shoe. Raises BadInput for an unknown key.
    """
    _refuse_key_without_its_beginning(brake, key)
    found: list[PartOfInputFile] = [brake]
    *path, last = _split_dotted_key(key)
    for step in path:
        if _is_key_word_an_index(step):
            found = found[int(step) : int(step) + 1]
            continue
        # A word that is the name of a shoe means this shoe, unless shoes have a key of this name.
        named = [part for part in found if _is_key_word_name_of_part(part, step)]
        if named:
            found = named
            continue
        # A key leads from each part to a part within it, or to several parts, such as all shoes.
        below: list[PartOfInputFile] = []
        for part in found:
            value = getattr(part, _field_name_of_brake_file_key(part, step, key))
            value = value.linings if isinstance(value, Lining) else value
            below += value if isinstance(value, tuple) else [value]
        found = [part for part in below if part is not None]
        if not all(isinstance(part, PartOfInputFile) for part in found):
            raise BadInput(f"{key}: {step!r} has nothing to be set in")
    if not found:
        raise BadInput(f"{key}: the brake has no such part")
    return found, _field_name_of_brake_file_key(found[0], last, key)


def _refuse_key_without_its_beginning(brake: PartOfInputFile, key: str) -> None:
    """Raise BadInput if `key` is only the end of whole keys of the brake, and name these keys.

    For example, "force" and "actuation.force" are ends of "shoe.actuation.force".
    """
    first, *rest = _split_dotted_key(key)
    names = {field.alias or name: name for name, field in type(brake).model_fields.items()}
    # A key that leads into a part which the brake does not have may lack its beginning, too.
    is_whole = first in names and (not rest or getattr(brake, names[first]) is not None)
    if is_whole or _is_key_word_name_of_part(brake, first):
        return
    end = "." + ".".join([first, *rest])
    whole = _keys_of_values_in_nested_data(brake.model_dump(by_alias=True), "")
    meant = [known.removeprefix(".") for known in whole if known.endswith(end)]
    if rest and not meant:
        # A key without a value in this brake, such as "lining.misfit.radius", is no end of a known
        # key. Its first word may be.
        heads = [known.removeprefix(".") for known in whole if known.endswith(f".{first}")]
        longer = [".".join([head, *rest]) for head in heads]
        meant = [known for known in longer if _is_key_of_brake(brake, known)]
    if meant:
        keys = " or ".join(repr(known) for known in meant)
        raise BadInput(
            f"{key}: unknown key {first!r} (did you mean {keys}?); allowed: {', '.join(names)}"
        )


def _is_key_of_brake(brake: PartOfInputFile, key: str) -> bool:
    """Whether a dotted key that begins with a table of the brake is a key of the brake."""
    try:
        parts_and_field_name_of_brake_key(brake, key)
    except BadInput:
        return False
    return True


def _keys_of_values_in_nested_data(data: Any, key: str) -> list[str]:
    """The dotted keys of all tables and values in nested data, each once and without indices.

    `key` is the dotted key under which the data stand. Keys without a value, and with an empty list
    or table, are left out.
    """
    has_value = data is not None and data not in ({}, [], ())
    found = {key: None} if key and has_value else {}
    if isinstance(data, dict):
        polar = SI_UNITS_BY_POLAR_POINT_KEY if set(data) == {"x", "y"} else {}
        found |= {f"{key}.{name}": None for name in polar}
        for name, value in data.items():
            found |= dict.fromkeys(_keys_of_values_in_nested_data(value, f"{key}.{name}"))
    elif isinstance(data, list | tuple):
        for entry in data:
            found |= dict.fromkeys(_keys_of_values_in_nested_data(entry, key))
    return list(found)


def _is_key_word_name_of_part(part: PartOfInputFile, step: str) -> bool:
    """Whether `step`, one word of a dotted key, is the name of this part, such as a shoe.

    The result is False if the part has a key with this word.
    """
    is_key = any(step == (field.alias or name) for name, field in type(part).model_fields.items())
    return getattr(part, "name", None) == step and not is_key


def _field_name_of_brake_file_key(part: PartOfInputFile, key: str, whole: str) -> str:
    """The name in Python of the field of a part that a brake file calls `key`.

    Raises BadInput for an unknown key; `whole` is the whole dotted key for the message.
    """
    # Some fields have another name in a file, such as `shoe` for the field `shoes`.
    names = {field.alias or name: name for name, field in type(part).model_fields.items()}
    if isinstance(part, Point):
        # A file may give a point in polar coordinates. Radius and angle are properties of `Point`,
        # no fields.
        names |= {key: key for key in SI_UNITS_BY_POLAR_POINT_KEY}
    if key not in names:
        longer = _keys_of_inner_parts_that_end_with(part, key) if key == whole else []
        if longer and key not in part.hints_on_other_keys:
            raise BadInput(
                f"{whole}: unknown key {key!r} (did you mean {' or '.join(map(repr, longer))}?); "
                f"allowed: {', '.join(names)}"
            )
        raise BadInput(f"{whole}: {part.message_on_unknown_key(key, names)}")
    return names[key]


def _keys_of_inner_parts_that_end_with(part: PartOfInputFile, word: str) -> list[str]:
    """The dotted keys that lead from a part to a number `word` of a part within it, each once."""
    found: dict[str, None] = {}
    for name, field in type(part).model_fields.items():
        value, step = getattr(part, name), field.alias or name
        value = value.linings if isinstance(value, Lining) else value
        for inner in value if isinstance(value, tuple) else (value,):
            if not isinstance(inner, PartOfInputFile):
                continue
            fields = {own.alias or key: key for key, own in type(inner).model_fields.items()}
            if word in fields and isinstance(getattr(inner, fields[word]), int | float):
                found[f"{step}.{word}"] = None
            for longer in _keys_of_inner_parts_that_end_with(inner, word):
                found[f"{step}.{longer}"] = None
    return list(found)


def numerical_value_of_brake_key(brake: PartOfInputFile, key: str) -> float:
    """The numerical value [SI] of a key of a brake; the key is written as for `vary`.

    Raises BadInput if the value is no number, or if the shoes have different values.
    """
    values = values_of_brake_key(brake, key)
    if not all(isinstance(value, int | float) for value in values):
        for value in values:
            if isinstance(value, FrictionTable):
                raise BadInput(
                    f"{key}: must be a key of the brake with a number, not a table over "
                    f"{' and '.join(value.given_columns_by_key)}; give one coefficient instead"
                )
        raise BadInput(f"{key}: must be a key of the brake with a number, not {values[0]!r}")
    if len(set(values)) > 1:
        unit = si_unit_of_brake_key(brake, key) or ""
        texts = ", ".join(quantity_with_usual_unit(value, unit) for value in values)
        raise BadInput(f"{key}: is {texts} of the different shoes; name one")
    return float(values[0])


def first_key_in_which_two_brakes_differ(
    one: PartOfInputFile, other: PartOfInputFile
) -> str | None:
    """The first key in which two brakes differ by more than round-off; None for equal brakes.

    Titles are not compared.
    """
    return _first_differing_key_of_data(
        one.model_dump(by_alias=True), other.model_dump(by_alias=True), ""
    )


def _first_differing_key_of_data(one: Any, other: Any, key: str) -> str | None:
    """The first key in which two nested data differ by more than round-off; None if they do not.

    `key` is the dotted key under which both data stand; the result begins with this key.
    """
    # Tables and lists are compared entry by entry, other values directly.
    if isinstance(one, dict) and isinstance(other, dict):
        names = [name for name in {**one, **other} if name != "title"]
        pairs = [
            (f"{key}.{name}" if key else name, one.get(name), other.get(name)) for name in names
        ]
    elif _are_lists_of_equal_length(one, other):
        pairs = [(f"{key}[{i}]", a, b) for i, (a, b) in enumerate(zip(one, other, strict=True))]
    elif isinstance(one, float) and isinstance(other, float):
        return None if math.isclose(one, other, rel_tol=1e-12, abs_tol=1e-15) else key
    else:
        return None if one == other else key
    for name, a, b in pairs:
        found = _first_differing_key_of_data(a, b, name)
        if found is not None:
            return found
    return None


def _are_lists_of_equal_length(one: Any, other: Any) -> bool:
    """Whether two values are lists of the same length."""
    lists = isinstance(one, list | tuple) and isinstance(other, list | tuple)
    return lists and len(one) == len(other)


def _split_dotted_key(key: str) -> list[str]:
    """Split a dotted key into names and numbers: "shoe[0].lining" is "shoe", "0", "lining".

    Raises BadInput for a key that is no text, and for a key in which a name or a number is missing.
    """
    words = key.replace("[", ".").replace("]", "").split(".") if isinstance(key, str) else [""]
    if "" in words:
        raise BadInput(
            f"key = {value_as_text(key)}: must be names joined by dots, with an index only behind "
            "a name, such as 'shoe[0].hinge.angle' or 'shoe.left.hinge.angle'"
        )
    return words


def _is_key_word_an_index(step: str) -> bool:
    """Whether `step`, one word of a dotted key, is an index, such as 0 in "shoe[0].lining"."""
    return step.isascii() and step.isdigit() and len(step) < 9


def _set_value_of_key_in_nested_data(data: Any, steps: list[str], value: Any, key: str) -> bool:
    """Set a value in nested data, in place, and return whether any value was set.

    No value is set if the key means all entries of a list without entries. Raises BadInput for an
    unknown key.

    Parameters
    ----------
    data : nested tables and lists, which are changed
    steps : names and indices that lead to the value; without an index all entries of a list change
    value : the new value
    key : the whole dotted key, for the error message
    """
    head, *rest = steps
    if isinstance(data, list | tuple):
        # An index or a shoe's name leads to one shoe. Any other word is a key of all shoes.
        named = [
            part
            for part in data
            if isinstance(part, dict) and part.get("name") == head and head not in part
        ]
        if _is_key_word_an_index(head) and data:
            _refuse_index_out_of_list_and_entry_as_whole(data, steps, key)
            targets, rest_of = [data[int(head)]], rest
        elif named and rest:
            targets, rest_of = named, rest
        else:
            _refuse_word_that_is_neither_name_nor_key(data, steps, key)
            targets, rest_of = list(data), steps
        were_set = [
            _set_value_of_key_in_nested_data(target, rest_of, value, key) for target in targets
        ]
        return any(were_set)
    if not isinstance(data, dict):
        raise BadInput(f"{key}: {head!r} has nothing to be set in")
    # If more names follow, the value belongs into the table with the key `head`.
    if rest:
        if head not in data:
            hint = did_you_mean_hint(head, data)
            raise BadInput(f"{key}: unknown key {head!r}{hint}; allowed: {', '.join(data)}")
        return _set_value_of_key_in_nested_data(data[head], rest, value, key)
    _convert_point_data_to_coordinate_system_of_key(data, head)
    # The value is copied, because a later change may set a key within it.
    data[head] = deepcopy(value)
    return True


def _refuse_index_out_of_list_and_entry_as_whole(
    entries: Sequence[Any], steps: list[str], key: str
) -> None:
    """Raise BadInput for an index that a list does not have, and for an index that ends a key.

    `steps` are the index and the words that follow it, and `key` is the whole dotted key.
    """
    index, *rest = steps
    if int(index) >= len(entries):
        allowed = f"0 to {len(entries) - 1}" if len(entries) > 1 else "0"
        raise BadInput(f"{key}: there is no number {index}; allowed: {allowed}")
    if not rest:
        keys = list(entries[0]) if isinstance(entries[0], dict) else []
        allowed = f"a key of it, such as '{key}.{keys[0]}', or " if keys else ""
        raise BadInput(f"{key}: is an entry of a list; allowed: {allowed}the whole list")


def _refuse_word_that_is_neither_name_nor_key(
    parts: Sequence[Any], steps: list[str], key: str
) -> None:
    """Raise BadInput if a word of a key is no key of the named parts in a list, nor their name.

    Parameters
    ----------
    parts : data of the parts, such as the shoes
    steps : the word, and the words that follow it
    key : the whole dotted key, for the error message
    """
    head, *rest = steps
    names = [str(part.get("name") or "") for part in parts if isinstance(part, dict)]
    # The last word of a key is checked together with the value.
    if not (rest and names and all(names)) or any(head in part for part in parts):
        return
    keys = [name for name in parts[0] if name != "name"]
    hint = did_you_mean_hint(head, [*names, *keys])
    raise BadInput(
        f"{key}: unknown key {head!r}{hint}; allowed: {', '.join(keys)}, or one of the names "
        f"{', '.join(names)}"
    )


def _convert_point_data_to_coordinate_system_of_key(data: dict[str, Any], key: str) -> None:
    """Convert a point's data, in place, to polar coordinates or to x and y, whichever have `key`.

    Data that are no point, and data that have the key already, are not changed.
    """
    if key in data or not isinstance(key, str):
        return
    if set(data) == {"x", "y"} and key in SI_UNITS_BY_POLAR_POINT_KEY:
        x, y = (_point_coordinate_in_si(data[name], "m") for name in ("x", "y"))
        data.clear()
        data.update(radius=math.hypot(x, y), angle=math.atan2(y, x))
    elif set(data) == set(SI_UNITS_BY_POLAR_POINT_KEY) and key in {"x", "y"}:
        radius, angle = (
            _point_coordinate_in_si(data[name], si)
            for name, si in SI_UNITS_BY_POLAR_POINT_KEY.items()
        )
        data.clear()
        data.update(x=radius * math.cos(angle), y=radius * math.sin(angle))


def _point_coordinate_in_si(value: Any, si: str) -> float:
    """Convert a coordinate of a point to SI; BadInput for a value that is no such quantity."""
    try:
        return quantity_in_si(value, si, unit_required=False)
    except ValueError as error:
        raise BadInput(f"{value!r}: {error}") from error
