"""Functions that make random broken inputs: brake files, meshes, tables and command lines.

Each function draws the input from a random generator `rng`. With the same seed it makes the same
input. The module `endings` runs an input and judges how the run ends.
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
from drumlin.brake.plane_brake import read_drum_or_plane_brake
from drumlin.studies import FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES
from drumlin_studies.fuzzing.broken_meshes import (
    SUFFIXES_OF_BROKEN_MESH_FILES,
    files_of_brake_with_valid_mesh_file,
    input_with_mesh_file,
    valid_mesh_files_by_suffix,
)
from drumlin_studies.fuzzing.inputs import (
    NAMES_OF_VALID_BRAKE_FILES_TO_BREAK,
    WORD_FOR_FEW_ELEMENTS_PER_LINING,
    FilesAndCommandLineOfBrokenInput,
    bytes_with_random_noise,
    content_of_brake_file,
    data_as_toml,
)
from drumlin_studies.fuzzing.wrong_values import (
    EXISTING_MISSING_AND_FORBIDDEN_PATHS,
    ODD_TEXTS_FOR_KEYS_AND_OPTIONS,
    USUAL_TO_IMPOSSIBLE_NUMBERS,
    VALID_AND_WRONG_INTEGER_WORDS,
    VALID_AND_WRONG_NUMBER_WORDS,
    VALID_AND_WRONG_TEXTS_BY_OPTION,
    random_toml_value,
    random_value_mostly_of_similar_type_or_value,
    tables_and_allowed_keys_in_brake_data,
)

PATH_OF_DOUBLE_SHOE_REFERENCE_VALUES = "reports/reference/values/double_shoe_brake.json"
"""Path, in the repository, of the reference values of the double-shoe brake."""


@cache
def content_of_reference_file() -> bytes:
    """The content of the file of reference values of the double-shoe brake."""
    return (
        FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES / PATH_OF_DOUBLE_SHOE_REFERENCE_VALUES
    ).read_bytes()


@cache
def csv_table_of_pressure_over_angle() -> bytes:
    """A CSV table of p(theta) of the double-shoe brake, as a user gives it to `drumlin check`."""
    from drumlin.models import MODELS  # noqa: PLC0415
    from drumlin.verification.check import pressure_curves_as_csv  # noqa: PLC0415

    brake = read_drum_or_plane_brake(
        FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES
        / "studies"
        / f"{NAMES_OF_VALID_BRAKE_FILES_TO_BREAK[0]}.toml"
    )
    return pressure_curves_as_csv(MODELS["fem"].solve(brake, elements=12)).encode()


def make_input_with_broken_bytes(rng: random.Random) -> FilesAndCommandLineOfBrokenInput:
    """An input whose brake file has broken bytes."""
    text = bytes_with_random_noise(
        rng,
        content_of_brake_file(rng.choice(NAMES_OF_VALID_BRAKE_FILES_TO_BREAK)),
        ODD_TEXTS_FOR_KEYS_AND_OPTIONS,
    )
    return FilesAndCommandLineOfBrokenInput(
        "brake file: bytes", {"b.toml": text}, _words_of_random_solve_command(rng)
    )


def make_input_with_scaled_quantities(rng: random.Random) -> FilesAndCommandLineOfBrokenInput:
    """An input whose brake file has one to four quantities multiplied by random factors.

    The file often still describes a valid but extreme brake.
    """
    text = content_of_brake_file(rng.choice(NAMES_OF_VALID_BRAKE_FILES_TO_BREAK)).decode()
    # Pattern of a number that is followed by a unit or by the end of the value.
    number = r"(?<![\w.])(-?\d[\d.]*)(?= \w+\"|\s*(?:[,}#]|$))"
    places = list(re.finditer(number, text, re.MULTILINE))
    chosen = rng.sample(places, min(len(places), rng.choice([1, 1, 2, 4])))
    # Numbers are replaced from the end of the text, so that the places of the numbers before stay
    # valid.
    for place in sorted(chosen, key=lambda match: -match.start()):
        sizes = [rng.uniform(0.2, 3), 10 ** rng.uniform(-3, 3), 10 ** rng.uniform(-12, 12)]
        size = rng.choice(sizes)
        value = float(place[1]) * size * rng.choice([1, 1, 1, -1])
        text = text[: place.start()] + f"{value:.9g}" + text[place.end() :]
    return FilesAndCommandLineOfBrokenInput(
        "brake file: sizes", {"b.toml": text.encode()}, _words_of_random_solve_command(rng)
    )


def make_input_with_wrong_values(rng: random.Random) -> FilesAndCommandLineOfBrokenInput:
    """An input whose brake file has random values for one to three keys that a brake file may have.

    The file need not have had these keys before.
    """
    data = tomllib.loads(
        content_of_brake_file(rng.choice(NAMES_OF_VALID_BRAKE_FILES_TO_BREAK)).decode()
    )
    # A change may remove a key, add an unknown one, or give a key another value.
    for _ in range(rng.choice([1, 1, 2, 3])):
        places = list(
            tables_and_allowed_keys_in_brake_data(Brake.brake_class_for_file_data(data), data)
        )
        table, key, annotation = rng.choice(places)
        if not isinstance(table, dict):
            continue
        if rng.random() < 0.08:
            table.pop(key, None)
        elif rng.random() < 0.05:
            table[rng.choice([*ODD_TEXTS_FOR_KEYS_AND_OPTIONS, "shoe[²]", "lining"])] = (
                random_toml_value(rng)
            )
        else:
            table[key] = random_value_mostly_of_similar_type_or_value(
                rng, annotation, table.get(key)
            )
    return FilesAndCommandLineOfBrokenInput(
        "brake file: schema", {"b.toml": data_as_toml(data)}, _words_of_random_solve_command(rng)
    )


def _words_of_random_solve_command(rng: random.Random) -> list[str]:
    """The words of a random command line that reads the brake file, mostly `drumlin solve`."""
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
        return [*rng.choice(commands), "--elements", WORD_FOR_FEW_ELEMENTS_PER_LINING]
    return [*words, "--model", model]


def make_input_with_broken_mesh(rng: random.Random) -> FilesAndCommandLineOfBrokenInput:
    """An input whose mesh file is broken.

    The file is cut off, or has the suffix of another format, a wrong number, shuffled or doubled
    lines, or broken bytes. A file .inp may also have lines of WRONG_LINES_APPENDED_TO_INP_FILE.
    """
    files = valid_mesh_files_by_suffix()
    suffix = rng.choice(SUFFIXES_OF_BROKEN_MESH_FILES)
    data = files[suffix]
    undamaged_files: dict[str, bytes] = {}
    what = rng.randrange(6)
    if what == 0:
        data = data[: rng.randrange(len(data))]
    elif what == 1:
        suffix_of_content = rng.choice(SUFFIXES_OF_BROKEN_MESH_FILES)
        data = files[suffix_of_content]
        undamaged_files = files_of_brake_with_valid_mesh_file(suffix_of_content)
    elif what == 2:
        # One number of the file is replaced by another number.
        numbers = list(re.finditer(rb"[-+]?\d[\d.]*(?:e[-+]?\d+)?", data))
        at = rng.choice(numbers)
        number = str(rng.choice([*USUAL_TO_IMPOSSIBLE_NUMBERS, 3, 10**9, 2**31])).encode()
        data = data[: at.start()] + number + data[at.end() :]
    elif what == 3:
        lines = data.splitlines(keepends=True)
        if rng.random() < 0.2:
            rng.shuffle(lines)
        else:
            lines.insert(rng.randrange(len(lines)), rng.choice(lines))
        data = b"".join(lines)
    elif what == 4 and suffix == ".inp":
        data += rng.choice(WRONG_LINES_APPENDED_TO_INP_FILE)
    else:
        data = bytes_with_random_noise(rng, data, ODD_TEXTS_FOR_KEYS_AND_OPTIONS)
    given = input_with_mesh_file(f"mesh: {suffix}", data, suffix, must_fail=False)
    return given._replace(undamaged_files=undamaged_files)


WRONG_LINES_APPENDED_TO_INP_FILE = (
    b"*NSET, NSET=HINGE, GENERATE\n1, 300000000\n",
    b"*NSET, NSET=HINGE, GENERATE\n1, 99999999999999999999\n",
    b"*NSET, NSET=A\n1\n" + b"".join(b"*NSET, NSET=A\n" + b"A, " * 40 + b"\n" for _ in range(20)),
    b"*NSET, NSET=A, GENERATE\n1, 9, 0\n",
    b"*NODE\n\n,,,\n",
    b"*ELEMENT, TYPE=CPS3\n1,2,3\n",
    b"*INCLUDE, INPUT=/etc/passwd\n",
)
"""Lines appended to a mesh file .inp: huge sets, sets that contain themselves, wrong keywords."""


def make_input_with_broken_reference(rng: random.Random) -> FilesAndCommandLineOfBrokenInput:
    """An input of `drumlin check` whose reference values have wrong types or broken bytes."""
    text = content_of_reference_file()
    if rng.random() < 0.4:
        text = bytes_with_random_noise(rng, text, ODD_TEXTS_FOR_KEYS_AND_OPTIONS)
    else:
        data = json.loads(text)
        for _ in range(rng.choice([1, 1, 2])):
            places = list(_tables_and_keys_in_nested_data(data))
            owner, key = rng.choice(places)
            value = rng.choice(
                [
                    *USUAL_TO_IMPOSSIBLE_NUMBERS,
                    *ODD_TEXTS_FOR_KEYS_AND_OPTIONS,
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
    files = {
        "b.toml": content_of_brake_file(NAMES_OF_VALID_BRAKE_FILES_TO_BREAK[0]),
        "ref.json": text,
        "r.csv": csv_table_of_pressure_over_angle(),
    }
    return FilesAndCommandLineOfBrokenInput(
        "reference values", files, ["check", "b.toml", "r.csv", "--reference", "ref.json"]
    )


def _tables_and_keys_in_nested_data(data: Any) -> Iterator[tuple[Any, Any]]:
    """Yield each key or index in nested data, with the table or list that it belongs to.

    Of all keys and indices inside a list, only the first three are yielded.
    """
    for key, value in list(data.items() if isinstance(data, dict) else enumerate(data)):
        yield data, key
        if isinstance(value, dict):
            yield from _tables_and_keys_in_nested_data(value)
        elif isinstance(value, list) and value:
            yield from list(_tables_and_keys_in_nested_data(value))[:3]


def make_input_with_broken_pressure_table(rng: random.Random) -> FilesAndCommandLineOfBrokenInput:
    """An input of `drumlin check` whose table of p(theta) has wrong cells or broken bytes."""
    text = csv_table_of_pressure_over_angle()
    if rng.random() < 0.5:
        text = bytes_with_random_noise(rng, text, ODD_TEXTS_FOR_KEYS_AND_OPTIONS)
    else:
        rows = list(csv.reader(io.StringIO(text.decode())))
        for _ in range(rng.choice([1, 1, 3])):
            row = rng.choice([rows[0], rng.choice(rows)])
            row[rng.randrange(len(row))] = rng.choice(
                [
                    *ODD_TEXTS_FOR_KEYS_AND_OPTIONS,
                    *map(str, USUAL_TO_IMPOSSIBLE_NUMBERS),
                    "theta [deg]",
                    "p [N]",
                    "p [",
                    "p",
                ]
            )
        buffer = io.StringIO()
        csv.writer(buffer).writerows(rows)
        text = buffer.getvalue().encode(errors="replace")
    files = {
        "b.toml": content_of_brake_file(NAMES_OF_VALID_BRAKE_FILES_TO_BREAK[0]),
        "ref.json": content_of_reference_file(),
        "r.csv": text,
    }
    return FilesAndCommandLineOfBrokenInput(
        "result table", files, ["check", "b.toml", "r.csv", "--reference", "ref.json"]
    )


NAMES_OF_SLOW_OR_ENDLESS_COMMANDS = {
    "study",
    "sweep",
    "reference",
    "cost",
    "compare",
    "hold",
    "explore",
}
"""Commands that take long, or run until they are stopped.

`make_input_with_wrong_command` runs them with wrong options, so that they end at once. Only `hold`
is also run with random options, on few elements.
"""


@cache
def _drumlin_commands_by_name() -> dict[str, Any]:
    """The commands of drumlin's command line, by name, as objects of the library typer."""
    from typer.main import get_command  # noqa: PLC0415

    from drumlin.cli.commands import app  # noqa: PLC0415

    return dict(vars(get_command(app))["commands"])


def make_input_with_random_command(rng: random.Random) -> FilesAndCommandLineOfBrokenInput:
    """An input that is a random command of drumlin with random values of its options."""
    commands = _drumlin_commands_by_name()
    name = rng.choice(
        [name for name in commands if name not in NAMES_OF_SLOW_OR_ENDLESS_COMMANDS - {"hold"}]
    )
    words = [name, "b.toml"]
    chosen = {}
    # Required arguments always get a word, options only in one case of three.
    for option in commands[name].params:
        required = option.param_type_name == "argument" or option.name == "to"
        if option.name in {"brake_file", "brake_files"} or (not required and rng.random() < 0.65):
            continue
        value = _random_value_for_command_option(rng, option)
        if option.param_type_name == "argument":
            words.append(str(value))
        else:
            chosen[option.name] = [option.opts[0], *([] if value is None else [value])]
    # Most commands get a small number of elements, so that they are quick.
    if name == "hold" or (name != "check" and rng.random() < 0.9):
        chosen.setdefault("elements", ["--elements", WORD_FOR_FEW_ELEMENTS_PER_LINING])
        if chosen.get("model", ["", "fem"])[1] != "fem":
            del chosen["elements"]
    files = {
        "b.toml": content_of_brake_file(
            rng.choice(
                [
                    NAMES_OF_VALID_BRAKE_FILES_TO_BREAK[0],
                    NAMES_OF_VALID_BRAKE_FILES_TO_BREAK[0],
                    *NAMES_OF_VALID_BRAKE_FILES_TO_BREAK,
                ]
            )
        ),
        "r.csv": csv_table_of_pressure_over_angle(),
        "ref.json": content_of_reference_file(),
    }
    for option in chosen.values():
        words += option
    return FilesAndCommandLineOfBrokenInput(f"command line: {name}", files, words)


def _random_value_for_command_option(rng: random.Random, option: Any) -> str | None:
    """A random word as the value of an option, chosen by its name and type; None for a flag."""
    if getattr(option, "is_flag", False) or getattr(option, "is_bool_flag", False):
        return None
    if option.name == "result":
        return rng.choice(["r.csv", "r.csv", "ref.json", *EXISTING_MISSING_AND_FORBIDDEN_PATHS])
    if option.name == "known":
        return rng.choice(["ref.json", "ref.json", "r.csv", *EXISTING_MISSING_AND_FORBIDDEN_PATHS])
    kind = str(getattr(option, "type", "")) + str(getattr(option, "type_descriptor", ""))
    pool: Sequence[str] = ODD_TEXTS_FOR_KEYS_AND_OPTIONS
    if option.name in VALID_AND_WRONG_TEXTS_BY_OPTION:
        pool = VALID_AND_WRONG_TEXTS_BY_OPTION[option.name]
    elif "Path" in kind or "path" in kind or option.name in {"output", "json_file", "pressure"}:
        pool = EXISTING_MISSING_AND_FORBIDDEN_PATHS
    elif option.name in {"elements", "sections", "jobs"}:
        pool = VALID_AND_WRONG_INTEGER_WORDS
    elif option.name in {"tolerance", "exponent"}:
        pool = VALID_AND_WRONG_NUMBER_WORDS
    return rng.choice(pool if rng.random() < 0.95 else ODD_TEXTS_FOR_KEYS_AND_OPTIONS)


def make_input_with_wrong_command(rng: random.Random) -> FilesAndCommandLineOfBrokenInput:
    """An input whose command line is not valid: random words after the name of a command."""
    name = rng.choice([*_drumlin_commands_by_name(), "", "x", "--help", "--version", "-h", "--bad"])
    words = [name] + [
        rng.choice(
            [
                *ODD_TEXTS_FOR_KEYS_AND_OPTIONS,
                *EXISTING_MISSING_AND_FORBIDDEN_PATHS,
                "--json",
                "--elements",
                "--bad",
            ]
        )
        for _ in range(rng.choice([0, 1, 2]))
    ]
    if name in NAMES_OF_SLOW_OR_ENDLESS_COMMANDS:
        words += ["--nope"]
    return FilesAndCommandLineOfBrokenInput(
        "command line: words",
        {"b.toml": content_of_brake_file(NAMES_OF_VALID_BRAKE_FILES_TO_BREAK[0])},
        words,
    )


def command_line_as_text(given: FilesAndCommandLineOfBrokenInput) -> str:
    """The command line of an input as text for people: long words are cut, odd words are quoted."""
    safe = set(string.ascii_letters + string.digits + "-_./=")
    cut = [word if len(word) < 40 else word[:20] + f"...({len(word)})" for word in given.words]
    return " ".join(word if word and set(word) <= safe else repr(word) for word in cut)
