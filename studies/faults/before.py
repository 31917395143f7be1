"""Run an earlier drumlin on the inputs of the study.

Usage: python studies/faults/before.py CHECKOUT > before.json

The earlier drumlin runs as a separate program, which is loaded once and then forks for each input.
It shares only the inputs and the judge with the present drumlin. The damaged journals are those
that it has written itself.
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

from drumlin.studies import FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES
from drumlin_studies.fuzzing import broken_sweeps, endings, trials
from drumlin_studies.fuzzing.inputs import (
    NAMES_OF_VALID_BRAKE_FILES_TO_BREAK,
    FilesAndCommandLineOfBrokenInput,
)

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
"""Words of the judge's line, and the kind of fault that they mean."""
LATER = ("No such option", "No such command")
"""Words of an earlier drumlin about options that it does not have. They are no fault."""


class EarlierDrumlin:
    """An earlier drumlin that runs one input after the other."""

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
                FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES
                / "studies"
                / f"{NAMES_OF_VALID_BRAKE_FILES_TO_BREAK[0]}.toml",
            ],
            env=env,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def end(self, given: FilesAndCommandLineOfBrokenInput) -> endings.EndOfCommandLineRun:
        """The ending of an input."""
        assert self._process.stdin is not None and self._process.stdout is not None
        with tempfile.TemporaryDirectory() as name, tempfile.TemporaryDirectory() as beside:
            endings.write_files_of_broken_input(given, Path(name))
            said = {}
            for stream in ("out", "err"):
                said[stream] = f"{beside}/{stream}"
            self._process.stdin.write(
                json.dumps({"folder": name, "words": given.words, **said}) + "\n"
            )
            self._process.stdin.flush()
            status, seconds = self._process.stdout.readline().split()
            out, err = (
                Path(said[stream]).read_bytes().decode(errors="replace")
                for stream in ("out", "err")
            )
            return endings.EndOfCommandLineRun(
                int(status),
                out,
                err,
                endings.contents_of_written_files(Path(name), given),
                float(seconds),
            )


def fault_kind(fault: str, status: int) -> str:
    """The kind of a fault, by the judge's line.

    A process that its limits of time or memory have ended counts as a hang.
    """
    if status < 0:
        return "hang"
    return next((kind for words, kind in KINDS if words in fault), "other")


def count_earlier_faults(checkout: Path, share: float = 1.0) -> dict[str, Any]:
    """The faults of an earlier drumlin by generator and kind.

    share : fraction of the inputs of each generator that are run.
    """
    earlier = EarlierDrumlin(checkout)
    end = earlier.end(
        FilesAndCommandLineOfBrokenInput(
            "sweep", broken_sweeps.files_of_valid_sweep(), broken_sweeps.SWEEP_COMMAND_WORDS
        )
    )
    if end.status:
        sys.exit(end.err or end.out)
    # Table and journal as the earlier drumlin writes them.
    table, kept = (
        end.written[broken_sweeps.SWEEP_TABLE_FILE_NAME],
        end.written[broken_sweeps.SWEEP_JOURNAL_FILE_NAME],
    )
    rows = []
    for name, whole in INPUTS.items():
        count = round(share * whole)
        found: Counter[str] = Counter()
        for number in range(count):
            given = trials.make_numbered_input_of_generator(name, number)
            # A damaged journal must be one of its own.
            if name == "journals":
                rng = random.Random(f"{name} {number}")
                given = broken_sweeps.input_with_random_journal_damage(rng, table, kept)
            end = earlier.end(given)
            if fault := endings.describe_fault_of_run(given, end):
                later = name == "command lines" and any(word in end.err for word in LATER)
                found[UNKNOWN if later else fault_kind(fault, end.status)] += 1
        print(name, dict(found), file=sys.stderr, flush=True)  # noqa: T201  (goes on for half an hour)
        rows.append({"generator": name, "inputs": count, "faults": dict(found.most_common())})
    commit = subprocess.run(
        ["git", "-C", checkout, "describe", "--always"], capture_output=True, text=True, check=True
    )
    return {"commit": commit.stdout.strip(), "rows": rows}


if __name__ == "__main__":
    json.dump(
        count_earlier_faults(Path(sys.argv[1]), *map(float, sys.argv[2:])), sys.stdout, indent=1
    )
