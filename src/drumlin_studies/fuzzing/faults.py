"""Broken inputs: folders of files with a command line, from independent generators. `endings`
judges how they end.

Each input draws from random numbers of its own: number n is the same every time.
"""

import csv
import io
import json
import random
import re
import string
import tomllib
from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any

from drumlin.brake.brake import Brake
from drumlin.brake.plane_brake import read_any
from drumlin.studies import REPOSITORY
from drumlin_studies.fuzzing.broken_meshes import mesh_files, with_mesh
from drumlin_studies.fuzzing.inputs import (
    FEW_ELEMENTS,
    SOUND_BRAKES,
    BrokenInput,
    brake_text,
    noise,
    toml,
)
from drumlin_studies.fuzzing.wrong_values import (
    WRONG_FLOATS,
    WRONG_INTEGERS,
    WRONG_NUMBERS,
    WRONG_PATHS,
    WRONG_TEXTS,
    WRONG_WORDS,
    anything,
    fitting,
    schema_places,
)

REFERENCE_FILE = "reports/reference/values/double_shoe_brake.json"


@cache
def reference_text() -> bytes:
    """Reference values of the double-shoe brake."""
    return (REPOSITORY / REFERENCE_FILE).read_bytes()


@cache
def result_text() -> bytes:
    """A table of p(theta) of that brake, as somebody hands it in."""
    from drumlin.models import MODELS  # noqa: PLC0415
    from drumlin.verification.check import curves_text  # noqa: PLC0415

    brake = read_any(REPOSITORY / "studies" / f"{SOUND_BRAKES[0]}.toml")
    return curves_text(MODELS["fem"].solve(brake, elements=12)).encode()


def broken_bytes(rng: random.Random) -> BrokenInput:
    """A brake file with its bytes in disorder."""
    text = noise(rng, brake_text(rng.choice(SOUND_BRAKES)), WRONG_WORDS)
    return BrokenInput("brake file: bytes", {"b.toml": text}, _solving(rng))


def scaled(rng: random.Random) -> BrokenInput:
    """A brake file with one to four quantities made larger or smaller: often still a brake, and an
    extreme one.
    """
    text = brake_text(rng.choice(SOUND_BRAKES)).decode()
    places = list(
        re.finditer(r"(?<![\w.])(-?\d[\d.]*)(?= \w+\"|\s*(?:[,}#]|$))", text, re.MULTILINE)
    )
    chosen = rng.sample(places, min(len(places), rng.choice([1, 1, 2, 4])))
    for place in sorted(chosen, key=lambda match: -match.start()):
        size = rng.choice(
            [rng.uniform(0.2, 3), 10 ** rng.uniform(-3, 3), 10 ** rng.uniform(-12, 12)]
        )
        value = float(place[1]) * size * rng.choice([1, 1, 1, -1])
        text = text[: place.start()] + f"{value:.9g}" + text[place.end() :]
    return BrokenInput("brake file: sizes", {"b.toml": text.encode()}, _solving(rng))


def typed(rng: random.Random) -> BrokenInput:
    """A brake file with one to three keys of the schema, there or not yet, set to values near and
    far.
    """
    data = tomllib.loads(brake_text(rng.choice(SOUND_BRAKES)).decode())
    for _ in range(rng.choice([1, 1, 2, 3])):
        places = list(schema_places(Brake.shape_of(data), data))
        table, key, annotation = rng.choice(places)
        if not isinstance(table, dict):
            continue
        if rng.random() < 0.08:
            table.pop(key, None)
        elif rng.random() < 0.05:
            table[rng.choice([*WRONG_WORDS, "shoe[²]", "lining"])] = anything(rng)
        else:
            table[key] = fitting(rng, annotation, table.get(key))
    return BrokenInput("brake file: schema", {"b.toml": toml(data)}, _solving(rng))


def _solving(rng: random.Random) -> list[str]:
    model = rng.choice(
        [
            "fem",
            "fem",
            "sine",
            "cosine",
            "uniform",
            "short",
            "foundation",
            "linear",
            "pivoted",
            "block",
        ]
    )
    words = ["solve", "b.toml", "--json", "r.json", "--pressure", "r.csv"]
    if model == "fem":
        commands = [
            words,
            words,
            ["sensitivity", "b.toml", "--json", "r.json"],
            ["mesh", "b.toml", "--output", "m"],
        ]
        return [*rng.choice(commands), "--elements", FEW_ELEMENTS]
    return [*words, "--model", model]


def broken_mesh(rng: random.Random) -> BrokenInput:
    """A mesh file with its bytes in disorder, cut off, of another kind, or with sizes that lie."""
    files = mesh_files()
    suffix = rng.choice([".msh", ".inp", ".vtu"])
    data = files[suffix]
    what = rng.randrange(6)
    if what == 0:
        data = data[: rng.randrange(len(data))]
    elif what == 1:
        data = files[rng.choice([".msh", ".inp", ".vtu"])]
    elif what == 2:  # a number becomes another one
        numbers = list(re.finditer(rb"[-+]?\d[\d.]*(?:e[-+]?\d+)?", data))
        at = rng.choice(numbers)
        data = (
            data[: at.start()]
            + str(rng.choice([*WRONG_NUMBERS, 3, 10**9, 2**31])).encode()
            + data[at.end() :]
        )
    elif what == 3:
        lines = data.splitlines(keepends=True)
        rng.shuffle(lines) if rng.random() < 0.2 else lines.insert(
            rng.randrange(len(lines)), rng.choice(lines)
        )
        data = b"".join(lines)
    elif what == 4 and suffix == ".inp":
        data += rng.choice(INP_ENDS)
    else:
        data = noise(rng, data, WRONG_WORDS)
    text = with_mesh(files["brake"], f"m{suffix}")
    return BrokenInput(
        f"mesh: {suffix}",
        {"b.toml": text, f"m{suffix}": data},
        ["solve", "b.toml", "--json", "r.json"],
    )


INP_ENDS = (
    b"*NSET, NSET=HINGE, GENERATE\n1, 300000000\n",
    b"*NSET, NSET=HINGE, GENERATE\n1, 99999999999999999999\n",
    b"*NSET, NSET=A\n1\n" + b"".join(b"*NSET, NSET=A\n" + b"A, " * 40 + b"\n" for _ in range(20)),
    b"*NSET, NSET=A, GENERATE\n1, 9, 0\n",
    b"*NODE\n\n,,,\n",
    b"*ELEMENT, TYPE=CPS3\n1,2,3\n",
    b"*INCLUDE, INPUT=/etc/passwd\n",
)


def broken_reference(rng: random.Random) -> BrokenInput:
    """Reference values with values of other types and sizes, or their bytes in disorder."""
    text = reference_text()
    if rng.random() < 0.4:
        text = noise(rng, text, WRONG_WORDS)
    else:
        data = json.loads(text)
        for _ in range(rng.choice([1, 1, 2])):
            places = list(_json_places(data))
            owner, key = rng.choice(places)
            value = rng.choice(
                [
                    *WRONG_NUMBERS,
                    *WRONG_WORDS,
                    None,
                    True,
                    [],
                    {},
                    [[1]],
                    [1.0, 2.0],
                    {"value": 1},
                    "del",
                ]
            )
            if value == "del":
                del owner[key]
            else:
                owner[key] = value
        text = json.dumps(data).encode()
    files = {"b.toml": brake_text(SOUND_BRAKES[0]), "ref.json": text, "r.csv": result_text()}
    return BrokenInput(
        "reference values", files, ["check", "b.toml", "r.csv", "--reference", "ref.json"]
    )


def _json_places(data: Any) -> Iterator[tuple[Any, Any]]:
    for key, value in list(data.items() if isinstance(data, dict) else enumerate(data)):
        yield data, key
        if isinstance(value, dict):
            yield from _json_places(value)
        elif isinstance(value, list) and value:
            yield from list(_json_places(value))[:3]


def broken_table(rng: random.Random) -> BrokenInput:
    """A table of p(theta) with cells of all sorts, or its bytes in disorder."""
    text = result_text()
    if rng.random() < 0.5:
        text = noise(rng, text, WRONG_WORDS)
    else:
        rows = list(csv.reader(io.StringIO(text.decode())))
        for _ in range(rng.choice([1, 1, 3])):
            row = rng.choice([rows[0], rng.choice(rows)])
            row[rng.randrange(len(row))] = rng.choice(
                [*WRONG_WORDS, *map(str, WRONG_NUMBERS), "theta [deg]", "p [N]", "p [", "p"]
            )
        buffer = io.StringIO()
        csv.writer(buffer).writerows(rows)
        text = buffer.getvalue().encode(errors="replace")
    files = {"b.toml": brake_text(SOUND_BRAKES[0]), "ref.json": reference_text(), "r.csv": text}
    return BrokenInput(
        "result table", files, ["check", "b.toml", "r.csv", "--reference", "ref.json"]
    )


SLOW_COMMANDS = {"study", "sweep", "reference", "cost", "compare", "hold", "explore"}
"""Commands that take long, or serve until they are stopped: they only get options that are wrong,
see `wrong_words`.
"""


@cache
def _commands() -> dict[str, Any]:
    from typer.main import get_command  # noqa: PLC0415

    from drumlin.cli.commands import app  # noqa: PLC0415

    return dict(vars(get_command(app))["commands"])


def command_line(rng: random.Random) -> BrokenInput:
    """A command with options of all sorts."""
    commands = _commands()
    name = rng.choice([name for name in commands if name not in SLOW_COMMANDS - {"hold"}])
    words = [name, "b.toml"]
    chosen = {}
    for option in commands[name].params:
        required = option.param_type_name == "argument" or option.name == "to"
        if option.name in {"brake_file", "brake_files"} or (not required and rng.random() < 0.65):
            continue
        value = _word_for(rng, option)
        if option.param_type_name == "argument":
            words.append(str(value))
        else:
            chosen[option.name] = [option.opts[0], *([] if value is None else [value])]
    if name == "hold" or (name != "check" and rng.random() < 0.9):
        chosen.setdefault("elements", ["--elements", FEW_ELEMENTS])
        if chosen.get("model", ["", "fem"])[1] != "fem":
            del chosen["elements"]
    files = {
        "b.toml": brake_text(rng.choice([SOUND_BRAKES[0], SOUND_BRAKES[0], *SOUND_BRAKES])),
        "r.csv": result_text(),
        "ref.json": reference_text(),
    }
    return BrokenInput(
        f"command line: {name}",
        files,
        words + [word for option in chosen.values() for word in option],
    )


def _word_for(rng: random.Random, option: Any) -> str | None:
    """A word for an option, by its name and type; None for a flag."""
    if getattr(option, "is_flag", False) or getattr(option, "is_bool_flag", False):
        return None
    if option.name == "result":
        return rng.choice(["r.csv", "r.csv", "ref.json", *WRONG_PATHS])
    if option.name == "known":
        return rng.choice(["ref.json", "ref.json", "r.csv", *WRONG_PATHS])
    kind = str(getattr(option, "type", "")) + str(getattr(option, "type_descriptor", ""))
    pool: Sequence[str] = WRONG_WORDS
    if option.name in WRONG_TEXTS:
        pool = WRONG_TEXTS[option.name]
    elif "Path" in kind or "path" in kind or option.name in {"output", "json_file", "pressure"}:
        pool = WRONG_PATHS
    elif option.name in {"elements", "sections", "jobs"}:
        pool = WRONG_INTEGERS
    elif option.name in {"tolerance", "exponent"}:
        pool = WRONG_FLOATS
    return rng.choice(pool if rng.random() < 0.95 else WRONG_WORDS)


def wrong_words(rng: random.Random) -> BrokenInput:
    """Words that are no command line."""
    name = rng.choice([*_commands(), "", "x", "--help", "--version", "-h", "--bad"])
    words = [name] + [
        rng.choice([*WRONG_WORDS, *WRONG_PATHS, "--json", "--elements", "--bad"])
        for _ in range(rng.choice([0, 1, 2]))
    ]
    if name in SLOW_COMMANDS:
        words += ["--nope"]
    return BrokenInput("command line: words", {"b.toml": brake_text(SOUND_BRAKES[0])}, words)


def shown(given: BrokenInput) -> str:
    """The command line of an input for people, long words cut."""
    safe = set(string.ascii_letters + string.digits + "-_./=")
    cut = [word if len(word) < 40 else word[:20] + f"...({len(word)})" for word in given.words]
    return " ".join(word if word and set(word) <= safe else repr(word) for word in cut)
