"""Brake files that no model may answer."""

import random
import tomllib
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

from drumlin.brake.plane_brake import read_any
from drumlin.models import applicable
from drumlin.studies import REPOSITORY
from drumlin_studies.fuzzing.inputs import (
    FEW_ELEMENTS,
    SOUND_BRAKES,
    BrokenInput,
    brake_text,
    data_as_toml,
)

WRONG_TYPES: tuple[Any, ...] = (
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
"""Values that no key of a brake file accepts, except titles and names."""


def make_broken_structure(rng: random.Random) -> BrokenInput:
    """A brake file with a key renamed or a value of another type."""
    name = rng.choice(SOUND_BRAKES)
    data = tomllib.loads(brake_text(name).decode())
    keyed = [place for place in _places_of_leaf_values(data) if isinstance(place[-1], str)]
    named = [place for place in keyed if place[-1] not in {"title", "name"}]
    *parents, key = rng.choice(named)
    owner = _value_at_place(data, tuple(parents))
    if rng.random() < 0.5:
        owner[key + rng.choice(["_", "x", " "])] = owner.pop(key)
    else:
        owner[key] = rng.choice(WRONG_TYPES)
    return _solve_of_broken_file(rng, "brake file: structure", name, data_as_toml(data))


def make_huge_file(rng: random.Random) -> BrokenInput:
    """A brake file that is far too deep, long or wide."""
    name = rng.choice(SOUND_BRAKES)
    text = brake_text(name).decode()
    texts: list[Callable[[], str]] = [
        lambda: text + "\nx = " + "[" * 50_000,
        lambda: text + "\n# " + "x" * 2_000_000,
        lambda: "[a." + ".".join("b" for _ in range(20_000)) + "]",
        lambda: text.replace('width = "', 'width = "' + "9" * 5_000, 1),
        lambda: "\0" * 900_000,
        lambda: text.replace("[[shoe]]", "[[shoe]]\n" * 20_000, 1),
    ]
    return _solve_of_broken_file(rng, "brake file: huge", name, rng.choice(texts)().encode())


def _solve_of_broken_file(rng: random.Random, kind: str, name: str, text: bytes) -> BrokenInput:
    """A solve of a broken file by a model that would answer the sound brake.

    Parameters
    ----------
    rng : random.Random
        What the model is drawn from.
    kind : str
        What kind of input it is.
    name : str
        Name of the sound brake file.
    text : bytes
        The broken file.
    """
    words = ["solve", "b.toml", "--json", "r.json"]
    model = rng.choice(_answering_models(name))
    words += ["--elements", FEW_ELEMENTS] if model == "fem" else ["--model", model]
    return BrokenInput(kind, {"b.toml": text}, words, must_fail=True)


@cache
def _answering_models(name: str) -> tuple[str, ...]:
    """The names of the models that answer a sound brake."""
    brake = read_any(REPOSITORY / "studies" / f"{name}.toml")
    return tuple(model.name for model in applicable(brake))


def _places_of_leaf_values(data: Any, place: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The places of all values in nested data, each as keys and indices from the top."""
    if isinstance(data, dict):
        for key, value in data.items():
            yield from _places_of_leaf_values(value, (*place, key))
    elif isinstance(data, list):
        for i, value in enumerate(data):
            yield from _places_of_leaf_values(value, (*place, i))
    else:
        yield place


def _value_at_place(data: Any, place: tuple[Any, ...]) -> Any:
    """The value at a place of nested data."""
    for step in place:
        data = data[step]
    return data
