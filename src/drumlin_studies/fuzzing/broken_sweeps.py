"""Broken inputs of `drumlin sweep`: sweep files with wrong values or keys, and damaged journals.

A sweep solves a brake for many values; its journal keeps the solved cases.
"""

import contextlib
import io
import random
import tempfile
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

from drumlin.studies import FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES
from drumlin_studies.fuzzing.broken_meshes import valid_mesh_files_by_suffix
from drumlin_studies.fuzzing.inputs import (
    NAMES_OF_VALID_BRAKE_FILES_TO_BREAK,
    WORD_FOR_FEW_ELEMENTS_PER_LINING,
    FilesAndCommandLineOfBrokenInput,
    bytes_with_random_noise,
    content_of_brake_file,
    data_as_toml,
)
from drumlin_studies.fuzzing.wrong_values import (
    ODD_TEXTS_FOR_KEYS_AND_OPTIONS,
    USUAL_TO_IMPOSSIBLE_NUMBERS,
    USUAL_TO_IMPOSSIBLE_QUANTITIES,
    random_toml_value,
)

SWEEP_TABLE_FILE_NAME = "t.csv"
"""Name of the table that a sweep writes."""
SWEEP_JOURNAL_FILE_NAME = f"{SWEEP_TABLE_FILE_NAME}.journal"
"""Name of the journal of a sweep, beside its table."""
SWEEP_COMMAND_WORDS = ["sweep", "s.toml", "--jobs", "1", "--output", SWEEP_TABLE_FILE_NAME]
"""Words of the command line, after "drumlin", that runs a sweep."""
TEXT_OF_VALID_SWEEP_FILE = """
brake = "b.toml"
[model.fem]
elements = 6
[vary]
friction = [0.1, 0.2, 0.3, 0.4]
"shoe[0].actuation.force" = ["1 kN", "2 kN"]
"""
"""Text of a valid sweep file with eight cases."""
MOSTLY_WRONG_SWEEP_KEYS = (
    "friction",
    "rotation",
    "shoe.lining.thickness",
    "shoe[0].lining.clearance",
    "shoe[²].hinge.x",
    "shoe[9].hinge.x",
    "shoe[-1].hinge.x",
    "shoe",
    "shoe.name",
    "title",
    "drum",
    "drum.radius",
    "drum.ring",
    "drum.out_of_round",
    "shoe.mesh",
    "shoe.lining",
    "shoe.lining.material.E",
    "shoe.body",
    "shoe.actuation.point",
    "shoe.actuation.force",
    "",
    ".",
    "shoe..hinge",
    "shoe[0",
    "a.b.c",
    "\0",
    "x" * 5000,
    "__class__",
    "model_fields",
    f"shoe[{'9' * 5000}].hinge.x",
)
"""Keys under `vary` of a sweep file: some are allowed, most are not."""
ALLOWED_SWEEP_KEYS_REPEATED = (
    "friction",
    "shoe[0].actuation.force",
    "shoe.lining.thickness",
    "drum.radius",
) * 4
"""Allowed keys under `vary`. Each stands four times in the list, so that a third of all drawn keys
is allowed.
"""
VALID_AND_WRONG_DISTRIBUTION_NAMES = (
    "normal",
    "uniform",
    "lognormal",
    "triangular",
    "truncated-normal",
    "x",
    ["normal"],
    3,
)
"""Names of distributions in a sweep file, allowed ones and wrong ones."""


@cache
def table_and_journal_of_valid_sweep() -> tuple[bytes, bytes]:
    """The table and the journal that the valid sweep TEXT_OF_VALID_SWEEP_FILE writes."""
    from drumlin.cli.process import run_command_line  # noqa: PLC0415

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, data in files_of_valid_sweep().items():
            (folder / file).write_bytes(data)
        with contextlib.redirect_stdout(io.StringIO()):
            run_command_line(
                [
                    "sweep",
                    str(folder / "s.toml"),
                    "--jobs",
                    "1",
                    "--output",
                    str(folder / SWEEP_TABLE_FILE_NAME),
                    "--keep-journal",
                ]
            )
        return (folder / SWEEP_TABLE_FILE_NAME).read_bytes(), (
            folder / SWEEP_JOURNAL_FILE_NAME
        ).read_bytes()


def files_of_valid_sweep() -> dict[str, bytes]:
    """The valid sweep file TEXT_OF_VALID_SWEEP_FILE and its brake file, by file name."""
    return {
        "b.toml": content_of_brake_file(NAMES_OF_VALID_BRAKE_FILES_TO_BREAK[0]),
        "s.toml": TEXT_OF_VALID_SWEEP_FILE.encode(),
    }


def make_input_with_broken_sweep(rng: random.Random) -> FilesAndCommandLineOfBrokenInput:
    """An input of `drumlin sweep` whose file has wrong values or keys, or broken bytes."""
    # Three in ten files have broken bytes; the others are valid TOML with wrong keys or values.
    if rng.random() < 0.3:
        text = bytes_with_random_noise(
            rng, TEXT_OF_VALID_SWEEP_FILE.encode(), ODD_TEXTS_FOR_KEYS_AND_OPTIONS
        )
    else:
        data: dict[str, Any] = {
            "brake": "b.toml",
            "model": rng.choice(
                [{"fem": {"elements": 6}}, {"sine": {}}, {"fem": {"elements": 6}, "cosine": {}}]
            ),
            "vary": {"friction": rng.choice([[0.1, 0.3], {"from": 0.1, "to": 0.4, "count": 3}])},
        }
        if rng.random() < 0.7:
            data["vary"][rng.choice([*MOSTLY_WRONG_SWEEP_KEYS, *ALLOWED_SWEEP_KEYS_REPEATED])] = (
                _random_values_for_varied_sweep_key(rng)
            )
        if rng.random() < 0.4:
            data[rng.choice(["seed", "cases", "combine", "brake", "model", "title", "x"])] = (
                rng.choice([random_toml_value(rng), 3, "zip", "grid", 1])
            )
        text = data_as_toml(data)
    return FilesAndCommandLineOfBrokenInput(
        "sweep file",
        {"b.toml": content_of_brake_file(NAMES_OF_VALID_BRAKE_FILES_TO_BREAK[0]), "s.toml": text},
        SWEEP_COMMAND_WORDS,
    )


def make_input_with_changed_sweep(rng: random.Random) -> FilesAndCommandLineOfBrokenInput:
    """An input of `drumlin sweep`: a small sweep file of the studies with one to three errors."""
    data = _random_small_sweep_data(rng)
    for _ in range(rng.choice([1, 1, 2, 3])):
        table = _random_table_in_sweep_data(rng, data)
        kind = rng.random()
        key = rng.choice([*table, "seed", "cases", "combine"])
        if kind < 0.1:
            table.pop(key, None)
        elif kind < 0.5 and isinstance(data.get("vary"), dict):
            data["vary"][rng.choice([*MOSTLY_WRONG_SWEEP_KEYS, *ALLOWED_SWEEP_KEYS_REPEATED])] = (
                _random_values_for_varied_sweep_key(rng)
            )
        elif key in KEYS_THAT_SET_SWEEP_DURATION:
            table[key] = rng.choice(SMALL_AND_WRONG_VALUES_OF_DURATION_KEYS)
        else:
            table[key] = random_toml_value(rng)
    files = {
        "b.toml": content_of_brake_file(NAMES_OF_VALID_BRAKE_FILES_TO_BREAK[0]),
        "m.msh": valid_mesh_files_by_suffix()[".msh"],
        "s.toml": data_as_toml(data),
    }
    return FilesAndCommandLineOfBrokenInput("sweep file of a study", files, SWEEP_COMMAND_WORDS)


KEYS_THAT_SET_SWEEP_DURATION = {"cases", "count", "elements"}
"""Keys of a sweep file whose numbers decide how long the sweep takes."""
SMALL_AND_WRONG_VALUES_OF_DURATION_KEYS: tuple[Any, ...] = (
    0,
    -1,
    1,
    2,
    "3",
    1.5,
    True,
    [],
    {},
    10**9,
    10**30,
    float("nan"),
    float("inf"),
)
"""Values for the keys KEYS_THAT_SET_SWEEP_DURATION: small, wrong and too large numbers."""


def _random_small_sweep_data(rng: random.Random) -> dict[str, Any]:
    """The data of a random sweep file of the studies, made smaller: with few cases and elements.

    One of the choices is a sweep over mesh files, which no study has.
    """
    paths = sorted(
        (FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES / "studies" / "sweeps").glob("*.toml")
    )
    path = rng.choice([*paths, None])
    if path is None:
        meshes = {"shoe.mesh": ["m.msh", "none.msh"], "shoe[0].mesh_unit": ["m", "mm"]}
        data: dict[str, Any] = {"combine": "zip", "vary": meshes}
    else:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    # Ranges and samples get two or three values, so that the sweep is short.
    for spec in data["vary"].values():
        if isinstance(spec, dict) and "count" in spec:
            spec["count"] = 2
    if "cases" in data:
        data["cases"] = 3
    return data | {
        "brake": "b.toml",
        "model": {"fem": {"elements": int(WORD_FOR_FEW_ELEMENTS_PER_LINING)}, "sine": {}},
    }


def _random_table_in_sweep_data(rng: random.Random, data: dict[str, Any]) -> dict[str, Any]:
    """A random table of the sweep file's data: the whole data or a table inside them."""
    table = data
    while rng.random() < 0.7:
        below = [item for item in table.values() if isinstance(item, dict)]
        if not below:
            break
        table = rng.choice(below)
    return table


def _random_values_for_varied_sweep_key(rng: random.Random) -> Any:
    """Random values for a key under `vary`: a list, a range or a distribution, valid or not."""
    # All values of the key are of one kind: numbers, forces, lengths, or wrong values.
    pool = rng.choice(
        [
            (0.1, 0.2, 0.3, 0.35),
            ("1 kN", "2 kN", "30 N"),
            ("1 mm", "8 mm"),
            (*USUAL_TO_IMPOSSIBLE_NUMBERS, *USUAL_TO_IMPOSSIBLE_QUANTITIES[:20]),
        ]
    )
    numbers = [rng.choice(pool) for _ in range(4)]
    return rng.choice(
        [
            numbers[:2],
            [rng.choice(ODD_TEXTS_FOR_KEYS_AND_OPTIONS)],
            random_toml_value(rng),
            {"from": numbers[0], "to": numbers[1], "count": rng.choice([1, 3, 0, -1, 10**7, "3"])},
            {
                "distribution": rng.choice(VALID_AND_WRONG_DISTRIBUTION_NAMES),
                "from": numbers[0],
                "to": numbers[1],
                "deviation": numbers[2],
            },
            {
                "distribution": rng.choice(VALID_AND_WRONG_DISTRIBUTION_NAMES),
                "mean": numbers[0],
                "deviation": "5 %",
                "each_shoe": rng.random() < 0.5,
            },
        ]
    )


def make_input_with_damaged_journal(rng: random.Random) -> FilesAndCommandLineOfBrokenInput:
    """An input of `drumlin sweep`: the valid sweep, beside which lies a damaged journal."""
    return input_with_random_journal_damage(rng, *table_and_journal_of_valid_sweep())


def input_with_random_journal_damage(
    rng: random.Random, table: bytes, journal: bytes
) -> FilesAndCommandLineOfBrokenInput:
    """An input of `drumlin sweep` with a journal in which bytes are flipped, lost or doubled.

    The sweep must write the same table as without a journal, whatever the damage is.

    Parameters
    ----------
    rng : random.Random
        Random numbers that decide the damage.
    table, journal : bytes
        Table and journal of the undisturbed sweep.
    """
    data = bytearray(journal)
    for _ in range(rng.choice([1, 1, 2, 5, 20])):
        at, length = rng.randrange(len(data)), rng.randrange(1, 200)
        # One bit is flipped, the end is cut off, or a piece is doubled, set to zero or left out.
        match rng.randrange(6):
            case 0 | 1:
                data[at] ^= 1 << rng.randrange(8)
            case 2:
                del data[max(at, 1) :]
            case 3:
                data[at:at] = data[at : at + length]
            case 4:
                data[at : at + length] = bytes(len(data[at : at + length]))
            case 5:
                del data[at : at + length]
        if not data:
            break
    return FilesAndCommandLineOfBrokenInput(
        "journal",
        files_of_valid_sweep() | {SWEEP_JOURNAL_FILE_NAME: bytes(data)},
        SWEEP_COMMAND_WORDS,
        {SWEEP_TABLE_FILE_NAME: table},
    )
