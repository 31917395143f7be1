"""The JSON schema of a brake file, made from the classes that read the file.

Editors complete and check TOML with it.
"""

import json
import re
from functools import partial
from typing import Any

from pydantic import TypeAdapter
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue

from drumlin.brake import fields
from drumlin.brake.drum_brake import DrumBrake
from drumlin.brake.plane_brake import FlatBrake
from drumlin.brake.units import EXAMPLES, QUANTITY_NAMES

DIALECT = "https://json-schema.org/draft/2020-12/schema"
QUANTITY = r"^\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d{1,3})?\s*[A-Za-zµμ°%1].*$"


def quantity(si: str) -> dict[str, Any]:
    """The schema of a text with a unit of the dimension of an SI unit."""
    said = f"{QUANTITY_NAMES[si]} with its unit, such as {EXAMPLES[si]!r}"
    return {"type": "string", "pattern": QUANTITY, "description": said, "examples": [EXAMPLES[si]]}


class UnitSchema(GenerateJsonSchema):
    """A generator of schemas in which every quantity is a text with its unit, as in files."""

    def function_before_schema(self, schema: Any) -> JsonSchemaValue:
        """The schema of a field before its validator: of the input rather than of the result."""
        found, function = super().function_before_schema(schema), schema["function"]["function"]
        if function is fields._from_polar:
            return {"anyOf": [found, _POLAR]}
        if isinstance(function, partial):
            return _with_units(found, function.keywords.get("si"))
        return found


_POLAR = {
    "type": "object",
    "description": "about the drum's centre, counter-clockwise from +x",
    "properties": {"radius": quantity("m"), "angle": quantity("rad")},
    "required": ["radius", "angle"],
    "additionalProperties": False,
}


def _with_units(found: JsonSchemaValue, si: str | None) -> JsonSchemaValue:
    """The schema of a number or a table of numbers, which a file gives with units."""
    if "anyOf" in found:
        return {**found, "anyOf": [_with_units(part, si) for part in found["anyOf"]]}
    if found.get("type") == "number":
        return quantity(si) if si else {"type": "string", "pattern": QUANTITY}
    row = {
        "type": "array",
        "items": {"type": "string", "pattern": QUANTITY},
        "minItems": 2,
        "maxItems": 2,
    }
    return {
        "type": "array",
        "items": row,
        "description": "rows of a place and a value, each with its unit",
    }


def written(schema: Any) -> Any:
    """Reduce a schema to what files have.

    Files have no defaults in SI, no titles made of names, and no null for a missing key.
    """
    if isinstance(schema, list):
        return [written(part) for part in schema if part != {"type": "null"}]
    if not isinstance(schema, dict):
        return schema
    found: dict[str, Any] = {}
    for key, value in schema.items():
        title_of_name = key == "title" and isinstance(value, str)
        default_in_si = key == "default" and not isinstance(value, str | bool)
        if title_of_name or default_in_si:
            continue
        # The keys below these two are names and not words of the schema.
        if key in {"properties", "$defs"}:
            found[key] = {name: written(part) for name, part in value.items()}
        else:
            found[key] = written(value)
    # A choice of one is no choice.
    choices = found.get("anyOf", ())
    if len(choices) == 1:
        del found["anyOf"]
        return {**choices[0], **found}
    return found


IN_FILES = re.compile(r'"(#/\$defs/)?(?:Drum(Brake|Lining|Shoe)|Arc(Body))"')
"""Names of the classes that read a brake on a drum.

A schema calls them Brake, Lining, Shoe and Body; users' editors may rely on these names.
"""


def brake_schema() -> dict[str, Any]:
    """The schema of a brake file, on a drum or on a plane."""
    made = TypeAdapter(DrumBrake | FlatBrake).json_schema(schema_generator=UnitSchema)
    found = json.loads(IN_FILES.sub(r'"\1\2\3"', json.dumps(written(made))))
    return {
        "$schema": DIALECT,
        "title": "drumlin brake file",
        **found,
        "$defs": dict(sorted(found["$defs"].items())),
    }
