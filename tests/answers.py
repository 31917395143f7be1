"""Write what drumlin answers to many commands, or compare two such files.

The comparison shows whether a change of the code has left all answers as they were.

    python tests/answers.py write FILE.json [BRAKES]
    python tests/answers.py compare BEFORE.json AFTER.json

`write` runs the commands of COMMANDS on every brake file of studies/ and meshes/ and on BRAKES
random brakes (by default 100). It stores exit status, printed text and JSON of each command.
`compare` prints every command whose status, words or numbers differ. Times are not compared.
Numbers may differ by CLOSE, relative to the largest number of their array.
"""

import json
import math
import re
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from typer.testing import CliRunner

from drumlin.brake.writing import brake_file_text
from drumlin.cli.commands import app
from drumlin_studies.random_brake import (
    FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND,
    draw_random_brake,
)
from drumlin_studies.random_kinds import (
    FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND as KINDS_OF_HOLDING,
)
from drumlin_studies.random_kinds import draw_random_brake_of_support_kind

ROOT = Path(__file__).resolve().parents[1]

COMMANDS: dict[str, list[str]] = {
    "solve": ["solve", "--verbose", "--json", "{json}"],
    "sine": ["solve", "--model", "sine", "--json", "{json}"],
    "cosine": ["solve", "--model", "cosine", "--json", "{json}"],
    "foundation": ["solve", "--model", "foundation", "--lift", "all", "--json", "{json}"],
    "mesh": ["solve", "--elements", "20", "--json", "{json}"],
    "triangles": ["solve", "--elements", "12", "--kind", "tri2", "--json", "{json}"],
    "tolerance": ["solve", "--tolerance", "1e-3", "--json", "{json}"],
    "sensitivity": ["sensitivity", "--json", "{json}"],
    "hold": ["hold", "--steps", "4", "--json", "{json}"],
    "wear": ["wear", "--distance", "0.1", "--json", "{json}"],
}
"""The commands by name; a brake file follows, and {json} stands for the file of the answer."""

CLOSE = 1e-10
"""Largest difference of equal numbers, relative to the largest number of their array.

Another order of the same operations stays below it; another number of levels or another mesh does
not.
"""

SEED = 90_000
"""Seed of the first random brake."""

TIMES = re.compile(r"\d[\d.e+-]* ?(?:ms|s)\b|\bms: .*?(?=\n\S|\Z)", re.DOTALL)
"""Times in a printed text: numbers with a unit, and the list of phases of a solve."""
NOT_COMPARED = {"seconds", "brake_file"}
"""Keys that are not compared: times, and the path of a brake file."""


class Difference(NamedTuple):
    """A command whose two answers differ, and a description of the differences."""

    case: str
    how: str


def brake_files(folder: Path, count: int) -> Iterator[Path]:
    """The paths of all brake files of the project, and of `count` random ones in a folder."""
    for path in [
        *sorted((ROOT / "studies").rglob("*.toml")),
        *sorted((ROOT / "meshes").glob("*.toml")),
    ]:
        if "[[shoe]]" in path.read_text(encoding="utf-8"):
            yield path
    kinds = [*FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND, *KINDS_OF_HOLDING]
    for seed in range(SEED, SEED + count):
        kind = kinds[seed % len(kinds)]
        brake = (
            draw_random_brake(seed, kind)
            if kind in FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND
            else draw_random_brake_of_support_kind(seed, kind)
        )
        path = folder / f"random_{seed}_{kind.replace(' ', '_')}.toml"
        path.write_text(brake_file_text(brake), encoding="utf-8")
        yield path


def answer(command: list[str], brake: Path, folder: Path) -> dict[str, Any]:
    """Exit status, refusal, printed text and JSON of a command on a brake file."""
    file = folder / "answer.json"
    file.unlink(missing_ok=True)
    words = [str(file) if word == "{json}" else word for word in command]
    result = CliRunner().invoke(app, [words[0], str(brake), *words[1:]])
    printed = (
        TIMES.sub("<time>", result.output)
        .replace(str(folder), "<folder>")
        .replace(str(ROOT), "<root>")
    )
    written = json.loads(file.read_text(encoding="utf-8")) if file.exists() else None
    refused = (
        "" if result.exception is None else f"{type(result.exception).__name__}: {result.exception}"
    )
    return {"status": result.exit_code, "refused": refused, "printed": printed, "json": written}


def write(file: str, count: str = "100") -> int:
    """Write the answers of all commands on all brakes into a file, and return the exit status 0."""
    found = {}
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        for brake in brake_files(folder, int(count)):
            name = "/".join(brake.parts[-2:]) if ROOT in brake.parents else brake.name
            for command, words in COMMANDS.items():
                found[f"{name} {command}"] = answer(words, brake, folder)
            sys.stdout.write(f"{name}\n")
            sys.stdout.flush()
    Path(file).write_text(json.dumps(found), encoding="utf-8")
    return 0


def differences(before: Any, after: Any, where: str = "") -> Iterator[str]:
    """Descriptions of the places where two JSON values differ. Times are not compared."""
    if isinstance(before, dict) and isinstance(after, dict):
        for key in sorted({*before, *after} - NOT_COMPARED):
            if key not in before or key not in after:
                yield f"{where}.{key} is only in one"
            else:
                yield from differences(before[key], after[key], f"{where}.{key}")
    elif isinstance(before, list) and isinstance(after, list):
        yield from _of_lists(before, after, where)
    elif isinstance(before, float) and isinstance(after, float):
        if abs(before - after) > CLOSE * max(abs(before), abs(after)):
            yield f"{where}: {before!r} and {after!r}"
    elif before != after:
        yield f"{where}: {before!r} and {after!r}"


def _of_lists(before: list[Any], after: list[Any], where: str) -> Iterator[str]:
    """The differences of two lists. Differences of numbers are relative to the largest number."""
    if len(before) != len(after):
        yield f"{where}: {len(before)} and {len(after)} entries"
    elif all(isinstance(x, int | float) for x in [*before, *after]):
        size = max((abs(x) for x in [*before, *after] if math.isfinite(x)), default=0.0)
        off = max((abs(x - y) for x, y in zip(before, after, strict=True) if x != y), default=0.0)
        if off > CLOSE * size:
            yield f"{where}: numbers differ by {off / size:.1e} of the largest"
    else:
        for i, (one, other) in enumerate(zip(before, after, strict=True)):
            yield from differences(one, other, f"{where}[{i}]")


def compare(before_file: str, after_file: str) -> int:
    """Print every command whose answers differ, and return the exit status: 1 if there is any."""
    before, after = (
        json.loads(Path(file).read_text(encoding="utf-8")) for file in (before_file, after_file)
    )
    found = [
        Difference(case, next(differences(before.get(case), after.get(case))))
        for case in {**before, **after}
        if any(differences(before.get(case), after.get(case)))
    ]
    for case, how in found:
        sys.stdout.write(f"{case}: {how}\n")
    sys.stdout.write(f"{len(found)} of {len(before)} answers differ\n")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit({"write": write, "compare": compare}[sys.argv[1]](*sys.argv[2:]))
