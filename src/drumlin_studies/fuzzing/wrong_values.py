"""Wrong or unusual values for brake files, paths and options, and functions that draw from them."""

import math
import random
import re
import types
import typing
from collections.abc import Callable, Iterator
from typing import Any

from pydantic import BaseModel

from drumlin_studies.fuzzing.inputs import UnquotedTomlText

ODD_TEXTS_FOR_KEYS_AND_OPTIONS = (
    "",
    " ",
    "0",
    "-0",
    "1",
    "2.5",
    "-1",
    "nan",
    "inf",
    "-inf",
    "1e999",
    "1e-320",
    "1_000",
    "٣",
    "²",
    "0x10",
    "true",
    "9" * 401,
    "9" * 4301,
    "0." + "1" * 5000,
    "=1+1",
    "@x",
    "a\nb",
    "\x1b[31mred\x1b[0m",
    "\r",
    "\0",
    "\u202e",
    "\ud800",
    "λ",
    "漢字",
    "🛞",
    "$x$",
    "x" * 300,
    "x" * 5000,
    "../x",
    "/",
    ".",
    "~",
    "-",
    "--",
    "%s{}",
    "<b>&amp;</b>",
    "[red]x[/]",
)
"""Texts for keys and options: odd numbers, control characters, foreign letters, long words."""
USUAL_TO_IMPOSSIBLE_QUANTITIES = (
    "0 mm",
    "-1 mm",
    "1e30 m",
    "1e-31 m",
    "1e308 mm",
    "150 mm",
    "nan mm",
    "inf m",
    "1 furlong",
    "1 mm mm",
    "1 m^9",
    "5 s",
    "1e-9 m",
    "90 deg",
    "360 deg",
    "-1e9 deg",
    "1e5 deg",
    "3 rad",
    "2 kN",
    "-2 kN",
    "0 N",
    "1e29 N",
    "1e-29 N",
    "300 MPa",
    "1 Pa",
    "1e30 Pa",
    "1/2 m",
    "9" * 100_000 + " mm",
    "1e9999 mm",
    "1 " + "m" * 5000,
    "1 m/(s*",
    "  8   mm ",
    "8mm",
)
"""Quantities with units, from usual to impossible values."""
USUAL_TO_IMPOSSIBLE_NUMBERS = (
    0,
    1,
    -1,
    0.3,
    1e-320,
    1e308,
    5e5,
    math.nan,
    math.inf,
    -math.inf,
    10**30,
    10**310,
    -(10**18),
    2**63,
    1e-9,
)
"""Numbers without units, from usual to impossible values."""
EXISTING_MISSING_AND_FORBIDDEN_PATHS = (
    "r.json",
    "r.csv",
    "r.svg",
    "r.png",
    "m.msh",
    "b.toml",
    "./b.toml",
    "sub/../b.toml",
    "sub",
    "sub/",
    "link.json",
    "x.toml",
    "loop",
    "dangling",
    "no/such/folder/r.json",
    "b.toml/r.json",
    "",
    ".",
    "..",
    "a\nb.json",
    "\x1b]0;x\x07.json",
    "\0",
    "a\0b",
    "x" * 300,
    "x" * 5000 + ".json",
    "λ.json",
    "\udcff.json",
    "pipe",
    "-",
    "r",
    "r.PNG",
    "hard.json",
)
"""Paths of existing and missing files, folders and links, and paths with forbidden letters."""


def random_toml_value(rng: random.Random, deep: int = 2) -> Any:
    """A random value of any type that a TOML file can hold.

    Tables and lists are nested up to `deep` levels.
    """
    simple: list[Callable[[], Any]] = [
        lambda: rng.choice(ODD_TEXTS_FOR_KEYS_AND_OPTIONS),
        lambda: rng.choice(USUAL_TO_IMPOSSIBLE_QUANTITIES),
        lambda: rng.choice(USUAL_TO_IMPOSSIBLE_NUMBERS),
        lambda: rng.random() < 0.5,
        lambda: UnquotedTomlText(
            rng.choice(
                [
                    "1979-05-27",
                    "07:32:00",
                    "1979-05-27T07:32:00Z",
                    "0xdeadbeef",
                    "+1",
                    "'''\nx\n'''",
                ]
            )
        ),
    ]
    if deep and rng.random() < 0.3:
        many = rng.choice([0, 1, 2, 3, 50])
        if rng.random() < 0.6:
            return [random_toml_value(rng, deep - 1) for _ in range(many)]
        return {
            rng.choice(
                ["x", "y", "radius", "angle", "E", "²", "", "a.b", "shoe"]
            ): random_toml_value(rng, deep - 1)
        }
    return rng.choice(simple)()


def _pydantic_models_in_annotation(kind: Any) -> Iterator[type[BaseModel]]:
    """Yield the pydantic models in the type annotation of a field."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        yield kind
    for part in typing.get_args(kind):
        if not isinstance(part, types.EllipsisType):
            yield from _pydantic_models_in_annotation(part)


def tables_and_allowed_keys_in_brake_data(
    kind: type[BaseModel], data: Any
) -> Iterator[tuple[Any, str, Any]]:
    """Yield each table of nested data with each key that the table may have, and the key's type.

    `data` are the data of a brake file. Their pydantic model `kind` gives the allowed keys, with
    the type annotation of each key.
    """
    for name, field in kind.model_fields.items():
        key = field.alias or name
        yield data, key, field.annotation
        inside = data.get(key) if isinstance(data, dict) else None
        for model in dict.fromkeys(_pydantic_models_in_annotation(field.annotation)):
            for part in inside if isinstance(inside, list) else [inside]:
                if isinstance(part, dict):
                    yield from tables_and_allowed_keys_in_brake_data(model, part)


def random_value_mostly_of_similar_type_or_value(
    rng: random.Random, annotation: Any, before: Any
) -> Any:
    """A random value for a key, mostly of the key's type or similar to its present value.

    Parameters
    ----------
    rng : random.Random
        Random numbers.
    annotation : type
        Type annotation of the key in the pydantic model.
    before : object
        Present value of the key, or None.
    """
    # For each type that occurs in the annotation, valid and wrong values of the type are
    # candidates.
    said = str(annotation)
    choices: list[Any] = [
        rng.choice(USUAL_TO_IMPOSSIBLE_QUANTITIES),
        rng.choice(USUAL_TO_IMPOSSIBLE_NUMBERS),
        random_toml_value(rng),
    ]
    if "Literal" in said:
        for part in [annotation, *typing.get_args(annotation)]:
            choices += typing.get_args(part)
    if "tuple" in said:
        rows = []
        for _ in range(rng.choice([1, 2, 3])):
            rows.append(
                [
                    rng.choice(USUAL_TO_IMPOSSIBLE_QUANTITIES),
                    rng.choice(USUAL_TO_IMPOSSIBLE_QUANTITIES),
                ]
            )
        choices += [rows, []]
    if "Path" in said:
        choices += list(EXISTING_MISSING_AND_FORBIDDEN_PATHS)
    # A present value with a unit is multiplied by a random factor. The product is four of the
    # candidates, so that it is drawn more often than others.
    if isinstance(before, str) and (match := re.fullmatch(r"([-\d.]+) (.+)", before)):
        scaled = float(match[1]) * rng.choice(
            [-1, 0, 0.1, 0.5, 0.99, 1.01, 2, 10, 1e6, 1e-6, 1e-15]
        )
        choices += [f"{scaled!r} {match[2]}"] * 4
    if isinstance(before, dict):
        choices += [{}, {**before, "x": "1 mm"}, dict(list(before.items())[:1])]
    if isinstance(before, list):
        choices += [before * 2, before * 300, before[:1], [], before[0] if before else None]
    value = rng.choice(choices)
    return "" if value is None else value


VALID_AND_WRONG_INTEGER_WORDS = (
    "-1",
    "0",
    "1",
    "2",
    "3",
    "5",
    "4001",
    "99999999999999999999",
    "9" * 4301,
    "x",
    "",
    "1e3",
    "nan",
    "2.5",
    "²",
)
"""Words for command-line options that take an integer, valid and wrong ones."""
VALID_AND_WRONG_NUMBER_WORDS = (
    "-1",
    "0",
    "0.01",
    "0.3",
    "1",
    "1.5",
    "2",
    "0.999999",
    "1e-320",
    "1e308",
    "nan",
    "inf",
    "-inf",
    "x",
    "",
    "9" * 4301,
)
"""Words for command-line options that take a number, valid and wrong ones."""
VALID_AND_WRONG_TEXTS_BY_OPTION = {
    "model": ("fem", "sine", "foundation", "short", "guess", ""),
    "kind": ("quad2", "quad1", "tri2", "tri1", "hex8", ""),
    "penalty": ("inf", "1e6", "1", "0", "-1", "nan", "1e-300", "1e300", "soft", "9" * 4301),
    "suffix": ("msh", "inp", "vtu", "stl", "", "../x", "a/b", "\0"),
    "to": ("calculix", "", "x"),
    "steps": ("1", "2", "3", "0", "-1", "10001", "99999999999999999999", "9" * 4301, "x"),
    "lift": ("all", "tilt", "wedge", "x", ""),
    "distance": (
        "0.01",
        "1",
        "5",
        "0",
        "-1",
        "nan",
        "inf",
        "1e999",
        "20 km",
        "1 mm",
        "0 m",
        "-1 m",
        "1e30 m",
        "x",
        "9" * 100_000,
    ),
    "reverse": ("1", "0", "-1", "nan", "0.1", "1 km", "x"),
    "coefficient": ("1e-5 mm^3/(N m)", "0 1/Pa", "-1 1/Pa", "1e-30 1/Pa", "1e30 1/Pa", "x", "1 m"),
    "torque": ("400 N m", "0 N m", "-1 N m", "1e-20 N m", "1e25 N m", "x", "9" * 100_000 + " N m"),
    "rotation": (
        "0.001 deg",
        "0 deg",
        "-0.01 deg",
        "1 rad",
        "1e-29 rad",
        "1e9 deg",
        "nan deg",
        "x",
    ),
    "name": ("x", "", "../y", "a\nb", "λ", "x" * 300, "\0", "/"),
}
"""Words for command-line options that take a name or a quantity, by the option's name."""
