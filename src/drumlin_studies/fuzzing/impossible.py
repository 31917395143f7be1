"""Random brake files that drumlin must refuse, whichever model is to solve them."""

import random
import tomllib
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

from drumlin.brake.plane_brake import read_drum_or_plane_brake
from drumlin.models import applicable_models
from drumlin.studies import FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES
from drumlin_studies.fuzzing.inputs import (
    NAMES_OF_VALID_BRAKE_FILES_TO_BREAK,
    WORD_FOR_FEW_ELEMENTS_PER_LINING,
    FilesAndCommandLineOfBrokenInput,
    content_of_brake_file,
    data_as_toml,
)

VALUES_OF_WRONG_TYPE_FOR_EVERY_KEY: tuple[Any, ...] = (
    {"a": 1},
    [],
    [[1, 2], 3],
    True,
    "",
    "12",
    "3 mm mm",
    "nan mm",
    "NaN",
    "1e999 m",
)
"""Values that drumlin must refuse for every key of a brake file, except titles and names."""


def make_input_with_broken_structure(rng: random.Random) -> FilesAndCommandLineOfBrokenInput:
    """An input whose brake file has a renamed key or a value of a wrong type."""
    name = rng.choice(NAMES_OF_VALID_BRAKE_FILES_TO_BREAK)
    data = tomllib.loads(content_of_brake_file(name).decode())
    # Titles and names are left out, since any text is valid for them.
    keyed = [
        place for place in _key_paths_of_values_in_nested_data(data) if isinstance(place[-1], str)
    ]
    named = [place for place in keyed if place[-1] not in {"title", "name"}]
    *parents, key = rng.choice(named)
    owner = _value_at_key_path_in_nested_data(data, tuple(parents))
    if rng.random() < 0.5:
        owner[key + rng.choice(["_", "x", " "])] = owner.pop(key)
    else:
        owner[key] = rng.choice(VALUES_OF_WRONG_TYPE_FOR_EVERY_KEY)
    return _input_with_broken_brake_file(rng, "brake file: structure", name, data_as_toml(data))


def make_input_with_huge_file(rng: random.Random) -> FilesAndCommandLineOfBrokenInput:
    """An input whose brake file is far too long, too deeply nested, or has too many shoes."""
    name = rng.choice(NAMES_OF_VALID_BRAKE_FILES_TO_BREAK)
    text = content_of_brake_file(name).decode()
    # Functions make the huge texts, so that only the text that is chosen takes memory.
    texts: list[Callable[[], str]] = [
        lambda: text + "\nx = " + "[" * 50_000,
        lambda: text + "\n# " + "x" * 2_000_000,
        lambda: "[a." + ".".join("b" for _ in range(20_000)) + "]",
        lambda: text.replace('width = "', 'width = "' + "9" * 5_000, 1),
        lambda: "\0" * 900_000,
        lambda: text.replace("[[shoe]]", "[[shoe]]\n" * 20_000, 1),
    ]
    return _input_with_broken_brake_file(
        rng, "brake file: huge", name, rng.choice(texts)().encode()
    )


def _input_with_broken_brake_file(
    rng: random.Random, kind: str, name: str, text: bytes
) -> FilesAndCommandLineOfBrokenInput:
    """An input of `drumlin solve` with a broken brake file and a random model.

    The model can solve the valid brake file from which the broken one was made.

    Parameters
    ----------
    rng : random.Random
        Random numbers from which the model is drawn.
    kind : str
        Kind of the input in tables.
    name : str
        Name of the valid brake file.
    text : bytes
        Content of the broken brake file.
    """
    words = ["solve", "b.toml", "--json", "r.json"]
    model = rng.choice(_models_that_can_solve_brake(name))
    words += (
        ["--elements", WORD_FOR_FEW_ELEMENTS_PER_LINING] if model == "fem" else ["--model", model]
    )
    return FilesAndCommandLineOfBrokenInput(kind, {"b.toml": text}, words, must_fail=True)


@cache
def _models_that_can_solve_brake(name: str) -> tuple[str, ...]:
    """The names of the models that can solve the valid brake file `name` of the studies."""
    brake = read_drum_or_plane_brake(
        FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES / "studies" / f"{name}.toml"
    )
    return tuple(model.name for model in applicable_models(brake))


def _key_paths_of_values_in_nested_data(
    data: Any, place: tuple[Any, ...] = ()
) -> Iterator[tuple[Any, ...]]:
    """Yield the place of each number and text in nested data, as keys and indices from the top."""
    if isinstance(data, dict):
        for key, value in data.items():
            yield from _key_paths_of_values_in_nested_data(value, (*place, key))
    elif isinstance(data, list):
        for i, value in enumerate(data):
            yield from _key_paths_of_values_in_nested_data(value, (*place, i))
    else:
        yield place


def _value_at_key_path_in_nested_data(data: Any, place: tuple[Any, ...]) -> Any:
    """The value in nested data at a place, given as keys and indices from the top."""
    for step in place:
        data = data[step]
    return data
