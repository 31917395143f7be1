"""The JSON schema of a brake file, made from the classes that read the file.

With the schema, text editors complete and check brake files as they are written.
"""

import json
import re
from functools import partial
from typing import Any

from pydantic import TypeAdapter
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue

from drumlin.base.written_numbers import number_without_unit_from_text
from drumlin.brake import fields
from drumlin.brake.drum_brake import DrumBrake
from drumlin.brake.key_meanings import (
    KEY_MEANINGS_OF_BRAKE_FILE_PARTS,
    add_key_meanings_to_json_schema,
)
from drumlin.brake.plane_brake import FlatBrake
from drumlin.brake.units import EXAMPLE_OF_QUANTITY_BY_SI_UNIT, NAME_OF_QUANTITY_BY_SI_UNIT

JSON_SCHEMA_DIALECT = "https://json-schema.org/draft/2020-12/schema"
"""The version of JSON schema that the schema of brake files uses."""
# The patterns match every text that drumlin takes, and some that it refuses: an editor must not
# mark a correct text as wrong. A number may begin with a typographic minus sign or a decimal sign.
_PATTERN_OF_NUMBER_BEGINNING = r"^\s*[-+\u2010-\u2013\u2212\ufe63\uff0d]?\s*[.,]?\d"
# The pattern matches the text of a quantity in a brake file: a number and some unit.
PATTERN_OF_QUANTITY_TEXT = _PATTERN_OF_NUMBER_BEGINNING + r""".*[A-Za-zµμ°º˚%"'″′].*$"""
# The pattern matches a number without unit that is written as a text, such as "30 %" or "0,3".
_PATTERN_OF_PURE_NUMBER_TEXT = _PATTERN_OF_NUMBER_BEGINNING + r"[-+\d.,/eE\s]*%?\s*$"


def json_schema_of_quantity_with_unit(si: str) -> dict[str, Any]:
    """The schema of a quantity: a text of a number and a unit of the same dimension as `si`."""
    said = (
        f"{NAME_OF_QUANTITY_BY_SI_UNIT[si]} with its unit, such as "
        f"{EXAMPLE_OF_QUANTITY_BY_SI_UNIT[si]!r}"
    )
    return {
        "type": "string",
        "pattern": PATTERN_OF_QUANTITY_TEXT,
        "description": said,
        "examples": [EXAMPLE_OF_QUANTITY_BY_SI_UNIT[si]],
    }


class JsonSchemaGeneratorWithUnits(GenerateJsonSchema):
    """Generator of JSON schemas in which every quantity is a text with its unit, as in files.

    pydantic's own generator would describe numbers in SI, to which the quantities are converted.
    """

    def function_before_schema(self, schema: Any) -> JsonSchemaValue:
        """The schema of the data that a validator takes, in place of the data that it returns.

        pydantic calls this method for each field whose data drumlin converts before pydantic checks
        them (BeforeValidator).
        """
        found, function = super().function_before_schema(schema), schema["function"]["function"]
        if function is fields._point_from_polar_coordinates:
            return {"anyOf": [found, _JSON_SCHEMA_OF_POLAR_POINT]}
        if function is number_without_unit_from_text:
            return {"anyOf": [found, {"type": "string", "pattern": _PATTERN_OF_PURE_NUMBER_TEXT}]}
        if isinstance(function, partial):
            return _json_schema_of_numbers_as_texts_with_units(found, function.keywords.get("si"))
        return found


# The schema of a point in polar coordinates.
_JSON_SCHEMA_OF_POLAR_POINT = {
    "type": "object",
    "description": "about the drum's centre, counter-clockwise from +x",
    "properties": {
        "radius": json_schema_of_quantity_with_unit("m"),
        "angle": json_schema_of_quantity_with_unit("rad"),
    },
    "required": ["radius", "angle"],
    "additionalProperties": False,
}


def _json_schema_of_numbers_as_texts_with_units(
    found: JsonSchemaValue, si: str | None
) -> JsonSchemaValue:
    """Convert the schema of numbers in SI to the schema of texts with units.

    Parameters
    ----------
    found : schema of a number, of a table of numbers, or of a choice of both
    si : SI unit of the number; None if any unit is allowed
    """
    if "anyOf" in found:
        return {
            **found,
            "anyOf": [
                _json_schema_of_numbers_as_texts_with_units(part, si) for part in found["anyOf"]
            ],
        }
    if found.get("type") == "number":
        return (
            json_schema_of_quantity_with_unit(si)
            if si
            else {"type": "string", "pattern": PATTERN_OF_QUANTITY_TEXT}
        )
    # Any other schema describes a table of numbers: rows of two quantities.
    row = {
        "type": "array",
        "items": {"type": "string", "pattern": PATTERN_OF_QUANTITY_TEXT},
        "minItems": 2,
        "maxItems": 2,
    }
    return {
        "type": "array",
        "items": row,
        "description": "rows of a place and a value, each with its unit",
    }


def json_schema_without_entries_unfit_for_toml(schema: Any) -> Any:
    """Remove from a schema all entries that do not hold for TOML files, at every level.

    These are defaults in SI units, titles that pydantic makes from names of Python classes and
    fields, and the value null, which TOML does not have.
    """
    if isinstance(schema, list):
        return [
            json_schema_without_entries_unfit_for_toml(part)
            for part in schema
            if part != {"type": "null"}
        ]
    if not isinstance(schema, dict):
        return schema
    found: dict[str, Any] = {}
    for key, value in schema.items():
        title_of_name = key == "title" and isinstance(value, str)
        default_in_si = key == "default" and not isinstance(value, str | bool)
        if title_of_name or default_in_si:
            continue
        # The keys within "properties" and "$defs" are names of fields and classes; all are kept.
        if key in {"properties", "$defs"}:
            found[key] = {
                name: json_schema_without_entries_unfit_for_toml(part)
                for name, part in value.items()
            }
        else:
            found[key] = json_schema_without_entries_unfit_for_toml(value)
    # A choice between schemas ("anyOf") of which one is left is replaced by this schema.
    choices = found.get("anyOf", ())
    if len(choices) == 1:
        del found["anyOf"]
        return {**choices[0], **found}
    return found


PATTERN_OF_DRUM_BRAKE_CLASS_NAMES = re.compile(
    r'"(#/\$defs/)?(?:Drum(Brake|LiningRow|Lining|Shoe)|Arc(Body))"'
)
"""Pattern of the names of the classes that read a brake on a drum.

The schema calls them Brake, Lining, Shoe and Body; editors of users may rely on these names.
"""


def json_schema_of_brake_file() -> dict[str, Any]:
    """The JSON schema of a brake file, for brakes on a drum and on a plane."""
    made = TypeAdapter(DrumBrake | FlatBrake).json_schema(
        schema_generator=JsonSchemaGeneratorWithUnits
    )
    add_key_meanings_to_json_schema(made["$defs"], KEY_MEANINGS_OF_BRAKE_FILE_PARTS)
    # In a file several linings of a shoe are a list of tables, not a table with the key `parts`.
    row = made["$defs"]["DrumLiningRow"]
    made["$defs"]["DrumLiningRow"] = {
        "description": row["description"],
        **row["properties"]["parts"],
    }
    found = json.loads(
        PATTERN_OF_DRUM_BRAKE_CLASS_NAMES.sub(
            r'"\1\2\3"', json.dumps(json_schema_without_entries_unfit_for_toml(made))
        )
    )
    return {
        "$schema": JSON_SCHEMA_DIALECT,
        "title": "drumlin brake file",
        **found,
        "$defs": dict(sorted(found["$defs"].items())),
    }
