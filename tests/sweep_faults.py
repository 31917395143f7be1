"""Mutated sweep files: what each does. As a program: python tests/sweep_faults.py [COUNT [FIRST]]."""

import math
import random
import signal
import string
import sys
import tempfile
import time
import tomllib
import traceback
from pathlib import Path
from typing import Any

from drumlin.base.errors import BadInput
from drumlin.sweeps.cases import run
from drumlin.sweeps.file import read_sweep
from drumlin.sweeps.table import table, write_table

ROOT = Path(__file__).resolve().parents[1]
SECONDS = 10  # of processor time
LONGEST = 1000  # letters of a line
FILES = [*sorted((ROOT / "studies" / "sweeps").glob("*.toml"))]
MESHED = """
brake = "../../double_shoe/brake.toml"
combine = "zip"
model = {{ foundation = {{}}, fem = {{ elements = 8 }} }}
[vary]
"shoe.mesh" = ["{mesh}", "none.msh"]
"shoe[0].mesh_unit" = ["m", "mm"]
"""
HOSTILE = [
    "", " ", "\0", "a\0b", "\x1b[31mred", "two\nlines", "=1+1", "-", "²", "٣", "shoe[²]", "x" * 5000, "../" * 300,
    "/", ".", "8 mm", "8", "8 mm mm", "1e400 m", "nan m", "5 %", "-5 %", "inf %", "%", "1e-320", "m^9^9^9",
    0, 1, -1, 2, 10**6, 2**63, 10**30, 0.0, -0.0, 1e-320, 1e308, math.inf, -math.inf, math.nan, True, False,
    [], {}, [[]], [{}], ["normal"], [1, "a"], [[["0 deg", "1 mm"]]], [["0 deg", "1 mm"], ["1 deg"]], {"a": {"b": 1}},
    {"from": 1, "to": 2, "count": 3}, {"distribution": "normal"}, {"distribution": ["normal"]},
    {"distribution": "uniform", "from": 0.1, "to": 0.5}, {"distribution": "lognormal", "deviation": 1e300},
    {"distribution": "truncated-normal", "deviation": 1e-300, "from": 0.9}, {"from": "1 mm", "to": "1 m", "count": 3},
    {"distribution": "triangular", "from": 0.1, "mode": 0.1, "to": 0.1}, {"from": 1, "to": 2, "count": 10**6},
    {"distribution": "truncated-normal", "deviation": 0.01, "from": 30.0, "to": 40.0},
    {"distribution": "normal", "deviation": "5 %", "each_shoe": True}, {"from": 1e-300, "to": 1e300, "count": 3},
]  # fmt: skip
KEYS = [
    "friction", "rotation", "shoe.lining.thickness", "shoe[0].lining.clearance", "shoe[²].hinge.x", "shoe[9].hinge.x",
    "shoe[-1].hinge.x", f"shoe[{'9' * 5000}].hinge.x", "shoe", "shoe.name", "title", "drum", "drum.radius", "drum.ring",
    "drum.out_of_round", "shoe.mesh", "shoe.mesh_unit", "shoe.mesh_frame", "shoe.lining", "shoe.lining.material.E",
    "shoe.lining.material", "shoe.body", "shoe.actuation.point", "shoe.actuation.force", "shoe.lining.misfit", "", ".",
    "shoe..hinge", "shoe[0", "a.b.c", "\0", "x" * 5000, "__class__", "model_fields", "shoe.frame", "shoe.0.name",
]  # fmt: skip


def text_of(value: object) -> str:
    """A value in TOML."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return '"' + "".join(c if c in PLAIN else f"\\U{ord(c):08x}" for c in value) + '"'
    if isinstance(value, dict):
        return (
            "{ "
            + ", ".join(f"{text_of(str(key))} = {text_of(item)}" for key, item in value.items())
            + " }"
        )
    if isinstance(value, list):
        return "[" + ", ".join(map(text_of, value)) + "]"
    return repr(value)


PLAIN = set(string.printable) - set('"\\\n\r\t\x0b\x0c')


def typed(data: dict[str, Any], rng: random.Random) -> str:
    """A sweep file with some of its values replaced, dropped, or under other keys."""
    for _ in range(rng.randint(1, 3)):
        place = data
        while rng.random() < 0.7:
            below = [item for item in place.values() if isinstance(item, dict)]
            if not below:
                break
            place = rng.choice(below)
        kind = rng.random()
        key = rng.choice([*place, "seed", "cases", "combine"])
        if kind < 0.1:
            place.pop(key, None)
        elif kind < 0.5 and isinstance(data.get("vary"), dict):
            data["vary"][rng.choice(KEYS)] = rng.choice(
                [rng.choice(HOSTILE), [rng.choice(HOSTILE)]]
            )
        else:
            place[key] = rng.choice(HOSTILE)
    lines = [f"{text_of(key)} = {text_of(value)}" for key, value in data.items()]
    return "\n".join(lines)


def mutated(data: bytes, rng: random.Random) -> bytes:
    """A file with bytes flipped, lost, doubled, or strange ones put in."""
    strange = [b"\0", b"\xff", b"[", b"{" * 300, b"[" * 600, b"9" * 4301, b"0x" + b"f" * 5000, b"\xc2\xb2", b'"', b"=",
               b"1979-05-27", b"nan", b"inf", b"'''", b"\r", b"-", b"e999", b"a" * 100_000]  # fmt: skip
    made = bytearray(data)
    for _ in range(rng.randint(1, 4)):
        at, length = rng.randrange(len(made)), rng.randrange(1, 30)
        match rng.randrange(5):
            case 0:
                made[at] = rng.randrange(256)
            case 1:
                del made[at : at + length]
            case 2:
                made[at:at] = made[at : at + length]
            case 3:
                made[at:at] = rng.choice(strange)
            case 4:  # a number becomes another
                digits = [i for i, byte in enumerate(made) if chr(byte).isdigit()]
                if digits:
                    at = rng.choice(digits)
                    made[at : at + 1] = rng.choice(strange)
        if not made:
            break
    return bytes(made)


def sweep_text(seed: int) -> bytes:
    """The mutated sweep file of a seed."""
    rng = random.Random(seed)
    meshed = MESHED.format(mesh=rng.choice(sorted((ROOT / "meshes").glob("*.msh"))).as_posix())
    text = rng.choice([*(path.read_text() for path in FILES), meshed])
    text = text.replace('"../', f'"{(ROOT / "studies").as_posix()}/')
    if rng.random() < 0.4:
        return mutated(text.encode(), rng)
    data = tomllib.loads(text)
    if rng.random() < 0.3:
        data["brake"] = tomllib.loads((ROOT / "studies" / "double_shoe" / "brake.toml").read_text())
    return typed(data, rng).encode(errors="replace")


def fault(seed: int, folder: Path) -> str:
    """What is wrong with how the sweep file of a seed is taken: nothing ("") if it is read or
    refused in one line.

    Of a file that is read the first cases are solved, on few elements.
    """
    path = folder / "sweep.toml"
    path.write_bytes(sweep_text(seed))

    def late(*_: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGPROF, late)
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    try:
        cases = read_sweep(path).cases[:3]
        quick = [
            case._replace(options={"elements": 6} if case.model == "fem" else case.options)
            for case in cases
        ]
        rows = run(quick)
        write_table(table(quick, rows, folder), folder / "out.csv")
        return next((row["status"] for row in rows if "unexpected" in row["status"]), "")
    except BadInput as error:
        line = str(error).removeprefix(str(path))
        raw = [c for c in line if ord(c) < 32 or ord(c) == 127]
        return (
            f"raw {raw} in {line!r}"[:300]
            if raw
            else f"{len(line)} letters: {line[:200]}"
            if len(line) > 6000
            else ""
        )
    except KeyboardInterrupt:
        return f"took longer than {SECONDS} s"
    except Exception as error:
        frames = traceback.extract_tb(error.__traceback__)[-2:]
        return (
            f"{type(error).__name__}: {error}"[:200]
            + f" at {[f'{f.filename[-30:]}:{f.lineno}' for f in frames]}"
        )
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def main(count: int = 2000, first: int = 0) -> None:
    """Print what falls, and how many."""
    faults = 0
    start = time.time()
    with tempfile.TemporaryDirectory() as name:
        for seed in range(first, first + count):
            said = fault(seed, Path(name))
            faults += bool(said)
            if said:
                sys.stdout.write(f"{seed}: {said}\n")
                sys.stdout.flush()
    sys.stdout.write(f"{count} sweep files, {faults} faults, {time.time() - start:.0f} s\n")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
