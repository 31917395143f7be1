"""The JSON schema of a sweep file, from the classes that read it."""

from typing import Any

from pydantic import TypeAdapter

from drumlin.brake.schema import DIALECT, UnitSchema, written
from drumlin.models import MODELS
from drumlin.sweeps.file import DISTRIBUTIONS, Range, SweepFile
from drumlin.sweeps.options import OPTIONS


def sweep_schema() -> dict[str, Any]:
    """The schema of a sweep file: what is varied and how, which models answer by which options."""
    made = TypeAdapter(SweepFile).json_schema(schema_generator=UnitSchema)
    laws = {name: _of(kind) for name, kind in DISTRIBUTIONS.items()}
    for name, law in laws.items():
        law["properties"]["distribution"] = {"const": name}
    listed = {"type": "array", "minItems": 1, "description": "values, each with its unit, or words"}
    properties = made["properties"]
    properties["vary"] = {
        "description": "keys of the brake file, such as friction or shoe.lining.thickness, and what they take",
        "type": "object",
        "minProperties": 1,
        "additionalProperties": {"anyOf": [listed, _of(Range), *laws.values()]},
    }
    properties["model"] = {
        "description": "the models that answer, each with its options; default: fem",
        "type": "object",
        "properties": {
            name: _of(OPTIONS[name]) if name in OPTIONS else {"type": "object"} for name in MODELS
        },
        "additionalProperties": False,
    }
    return {"$schema": DIALECT, "title": "drumlin sweep file", **written(made)}


def _of(kind: type[Any]) -> dict[str, Any]:
    return dict(TypeAdapter(kind).json_schema(schema_generator=UnitSchema))
