"""The JSON schema of a brake file, from the classes that read it: editors complete and check TOML
by it.
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
    """The schema of a text with its unit, of the dimension of an SI unit."""
    said = f"{QUANTITY_NAMES[si]} with its unit, such as {EXAMPLES[si]!r}"
    return {"type": "string", "pattern": QUANTITY, "description": said, "examples": [EXAMPLES[si]]}


class UnitSchema(GenerateJsonSchema):
    """A schema in which every quantity is a text with its unit, as the files have it."""

    def function_before_schema(self, schema: Any) -> JsonSchemaValue:
        """The schema of what a validator of brake.fields reads, in place of what it makes."""
        found, function = super().function_before_schema(schema), schema["function"]["function"]
        if function is fields._from_polar:
            return {"anyOf": [found, _POLAR]}
        return (
            _with_units(found, function.keywords.get("si"))
            if isinstance(function, partial)
            else found
        )


_POLAR = {
    "type": "object",
    "description": "about the drum's centre, counter-clockwise from +x",
    "properties": {"radius": quantity("m"), "angle": quantity("rad")},
    "required": ["radius", "angle"],
    "additionalProperties": False,
}


def _with_units(found: JsonSchemaValue, si: str | None) -> JsonSchemaValue:
    """A number or a table of numbers, which a file has with their units."""
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
    """A schema without what no file has: defaults in SI, titles made of names, null for a key that
    is left out.
    """
    if isinstance(schema, list):
        return [written(part) for part in schema if part != {"type": "null"}]
    if not isinstance(schema, dict):
        return schema
    found = {
        key: {name: written(part) for name, part in value.items()}
        if key in {"properties", "$defs"}
        else written(value)
        for key, value in schema.items()
        if not (key == "title" and isinstance(value, str))
        and not (key == "default" and not isinstance(value, str | bool))
    }
    only = found.get("anyOf", ())
    return (
        {**only[0], **{k: v for k, v in found.items() if k != "anyOf"}} if len(only) == 1 else found
    )


IN_FILES = re.compile(r'"(#/\$defs/)?(?:Drum(Brake|Lining|Shoe)|Arc(Body))"')
"""Names of the classes that read a brake on a drum. A schema calls them Brake, Lining, Shoe and Body,
which stays.
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
