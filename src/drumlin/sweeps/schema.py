"""The JSON schema of a sweep file, made from the classes that read the file."""

from typing import Any

from pydantic import TypeAdapter

from drumlin.brake.key_meanings import add_key_meanings_to_json_schema
from drumlin.brake.schema import (
    JSON_SCHEMA_DIALECT,
    JsonSchemaGeneratorWithUnits,
    json_schema_without_entries_unfit_for_toml,
)
from drumlin.models import MODELS
from drumlin.sweeps.certificate import LEAST_SOLVED_CASES_OF_CERTIFYING_SAMPLE
from drumlin.sweeps.file import DISTRIBUTION_CLASSES_BY_NAME, Range, SweepFile
from drumlin.sweeps.key_meanings import MEANINGS_OF_SWEEP_FILE_KEYS
from drumlin.sweeps.options import OPTION_CLASSES_BY_MODEL_NAME
from drumlin.sweeps.sample import (
    CERTIFY_VALUE_FOR_OWN_ERRORS_OF_EACH_CASE,
    PATTERN_OF_CERTIFY_VALUE_EVERY_NTH,
)


def json_schema_of_sweep_file() -> dict[str, Any]:
    """The JSON schema of a sweep file: its varied keys, its models and their options."""
    schema = _json_schema_of_class(SweepFile)
    schema["properties"]["vary"] = _json_schema_of_vary_table()
    schema["properties"]["model"] = _json_schema_of_model_table()
    schema["properties"]["certify"] = {
        "description": "which cases by finite elements are solved on all levels for their errors",
        "default": CERTIFY_VALUE_FOR_OWN_ERRORS_OF_EACH_CASE,
        "anyOf": [
            {"const": CERTIFY_VALUE_FOR_OWN_ERRORS_OF_EACH_CASE},
            {"type": "string", "pattern": f"^{PATTERN_OF_CERTIFY_VALUE_EVERY_NTH}$"},
            {"type": "integer", "minimum": LEAST_SOLVED_CASES_OF_CERTIFYING_SAMPLE},
        ],
    }
    return {
        "$schema": JSON_SCHEMA_DIALECT,
        "title": "drumlin sweep file",
        **json_schema_without_entries_unfit_for_toml(schema),
    }


def _json_schema_of_vary_table() -> dict[str, Any]:
    """The JSON schema of the table [vary]: each key takes a list, a range or a distribution."""
    listed = {"type": "array", "minItems": 1, "description": "values, each with its unit, or words"}
    distributions = []
    for name, kind in DISTRIBUTION_CLASSES_BY_NAME.items():
        distribution = _json_schema_of_class(kind)
        distribution["properties"]["distribution"] = {"const": name}
        distributions.append(distribution)
    return {
        "description": (
            "keys of the brake file, such as friction or shoe.lining.thickness, and what they take"
        ),
        "type": "object",
        "minProperties": 1,
        "additionalProperties": {"anyOf": [listed, _json_schema_of_class(Range), *distributions]},
    }


def _json_schema_of_model_table() -> dict[str, Any]:
    """The JSON schema of the table [model]: the options of each model, by the model's name."""
    options = {}
    for name in MODELS:
        kind = OPTION_CLASSES_BY_MODEL_NAME.get(name)
        options[name] = {"type": "object"} if kind is None else _json_schema_of_class(kind)
    return {
        "description": "the models that answer, each with its options; default: fem",
        "type": "object",
        "properties": options,
        "additionalProperties": False,
    }


def _json_schema_of_class(kind: type[Any]) -> dict[str, Any]:
    """The JSON schema of a class that reads a part of the sweep file."""
    made = dict(TypeAdapter(kind).json_schema(schema_generator=JsonSchemaGeneratorWithUnits))
    add_key_meanings_to_json_schema(
        {kind.__name__: made, **made.get("$defs", {})}, MEANINGS_OF_SWEEP_FILE_KEYS
    )
    return made
