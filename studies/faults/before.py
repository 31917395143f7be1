"""The inputs of the study given to an earlier drumlin: python studies/faults/before.py CHECKOUT >
before.json.

That drumlin runs as a program of its own, which loads it once and then forks for each input; it
shares nothing with this one but the inputs and the judge. Journals are damaged that it wrote
itself.
"""

import json
import os
import random
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

from studies.faults.study import INPUTS, UNKNOWN

from drumlin.studies import REPOSITORY
from drumlin_studies.fuzzing import broken_sweeps, endings, trials
from drumlin_studies.fuzzing.inputs import SOUND_BRAKES, BrokenInput

PROGRAM = r"""
import contextlib, io, json, os, resource, signal, sys, traceback
from drumlin.cli.main import main

with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(SystemExit):
    sys.argv = ["drumlin", "solve", sys.argv[1]]
    main()  # loads what a solve needs

def one(given):
    os.chdir(given["folder"])
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    for number, name in ((1, "out"), (2, "err")):
        os.dup2(os.open(given[name], os.O_WRONLY | os.O_CREAT), number)
    signal.alarm(120)
    resource.setrlimit(resource.RLIMIT_CPU, (15, 15))
    resource.setrlimit(resource.RLIMIT_AS, (3 << 30, 3 << 30))
    sys.argv = ["drumlin", *given["words"]]
    try:
        main()
    except SystemExit as end:
        return end.code or 0
    except BaseException:
        traceback.print_exc()
        return 1
    return 0

for line in sys.stdin:
    child = os.fork()
    if not child:
        status = 1
        try:
            status = one(json.loads(line))
            sys.stdout.flush()
            sys.stderr.flush()
        finally:
            os._exit(status if isinstance(status, int) else 1)
    _, status, used = os.wait4(child, 0)
    print(os.waitstatus_to_exitcode(status), used.ru_utime + used.ru_stime, flush=True)
"""
KINDS = (
    ("took", "hang"),
    ("status", "traceback"),
    ("not one line", "several lines"),
    ("an answer with", "warnings on the screen"),
    ("control", "control character"),
    ("not finite", "not finite"),
    ("not the right", "wrong table"),
    ("an input was", "input written over"),
    ("files of", "files of a refused run"),
    ("temporary file", "temporary file left"),
    ("formula", "formula in a table"),
    ("holds", "not finite"),
    ("nan", "not finite"),
)
"""What the judge's line says, and the kind of fault that it is."""
LATER = ("No such option", "No such command")
"""What an earlier drumlin says of options that it has not yet: no fault of its own."""


class Earlier:
    """An earlier drumlin that is given one input after the other."""

    def __init__(self, checkout: Path) -> None:
        env = os.environ | {
            "PYTHONPATH": str(checkout / "src"),
            "OPENBLAS_NUM_THREADS": "1",
            "PYTHONUTF8": "1",
        }
        self._process = subprocess.Popen(
            [
                sys.executable,
                "-P",
                "-c",
                PROGRAM,
                REPOSITORY / "studies" / f"{SOUND_BRAKES[0]}.toml",
            ],
            env=env,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def end(self, given: BrokenInput) -> endings.Ending:
        """How it ends on an input."""
        assert self._process.stdin is not None and self._process.stdout is not None
        with tempfile.TemporaryDirectory() as name, tempfile.TemporaryDirectory() as beside:
            endings.lay_out(given, Path(name))
            said = {stream: f"{beside}/{stream}" for stream in ("out", "err")}
            self._process.stdin.write(
                json.dumps({"folder": name, "words": given.words, **said}) + "\n"
            )
            self._process.stdin.flush()
            status, seconds = self._process.stdout.readline().split()
            out, err = (
                Path(said[stream]).read_bytes().decode(errors="replace")
                for stream in ("out", "err")
            )
            return endings.Ending(
                int(status), out, err, endings.written(Path(name), given), float(seconds)
            )


def kind_of(fault: str, status: int) -> str:
    """The kind of fault that the judge's line says; a process that its limits ended had hung."""
    return (
        "hang" if status < 0 else next((kind for begins, kind in KINDS if begins in fault), "other")
    )


def main(checkout: Path, share: float = 1.0) -> dict[str, Any]:
    """Faults of an earlier drumlin by generator and kind, on a share of the inputs of each
    generator.
    """
    earlier = Earlier(checkout)
    end = earlier.end(BrokenInput("sweep", broken_sweeps.sound_files(), broken_sweeps.SWEEP_WORDS))
    if end.status:
        sys.exit(end.err or end.out)
    table, kept = end.written[broken_sweeps.SWEEP_TABLE], end.written[broken_sweeps.SWEEP_JOURNAL]
    rows = []
    for name, whole in INPUTS.items():
        count = round(share * whole)
        found: Counter[str] = Counter()
        for number in range(count):
            given = trials.made(name, number)
            if name == "journals":
                rng = random.Random(f"{name} {number}")
                given = broken_sweeps.damaged(rng, table, kept)
            end = earlier.end(given)
            if fault := endings.fault_of(given, end):
                later = name == "command lines" and any(word in end.err for word in LATER)
                found[UNKNOWN if later else kind_of(fault, end.status)] += 1
        print(name, dict(found), file=sys.stderr, flush=True)  # noqa: T201  (goes on for half an hour)
        rows.append({"generator": name, "inputs": count, "faults": dict(found.most_common())})
    commit = subprocess.run(
        ["git", "-C", checkout, "describe", "--always"], capture_output=True, text=True, check=True
    )
    return {"commit": commit.stdout.strip(), "rows": rows}


if __name__ == "__main__":
    json.dump(main(Path(sys.argv[1]), *map(float, sys.argv[2:])), sys.stdout, indent=1)
