"""Thousands of broken inputs, generator by generator: what became of each, kept in a journal as it
goes.
"""

import os
import random
import re
from collections.abc import Callable
from typing import Any, NamedTuple

from drumlin.base.errors import line_and_status
from drumlin.base.journal import Journal
from drumlin_studies.fuzzing import faults
from drumlin_studies.fuzzing.broken_meshes import impossible_mesh
from drumlin_studies.fuzzing.broken_sweeps import broken_sweep, changed_sweep, damaged_journal
from drumlin_studies.fuzzing.endings import fault_of, in_process, in_subprocess
from drumlin_studies.fuzzing.impossible import broken_structure, huge_file
from drumlin_studies.fuzzing.inputs import BrokenInput
from drumlin_studies.fuzzing.soundness import fault_of_answer
from drumlin_studies.side_by_side import Case, kept

INPUTS_AT_A_TIME = 50
"""Inputs that a process takes at a time."""
KEPT_LETTERS = 300
"""Letters of a refusal that a verdict keeps: enough to tell what it refuses."""

GENERATORS: dict[str, tuple[Callable[[random.Random], BrokenInput], str]] = {
    "bytes": (faults.broken_bytes, "a brake file with its bytes in disorder"),
    "schema": (faults.typed, "keys of the brake file's schema with values near and far"),
    "sizes": (faults.scaled, "quantities of a brake file made larger or smaller by up to 1e12"),
    "structure": (broken_structure, "a brake file with a key renamed or of another type"),
    "huge": (huge_file, "brake files that are deep, long or wide beyond sense"),
    "meshes": (faults.broken_mesh, "mesh files cut off, mislabelled, with numbers that lie"),
    "impossible meshes": (impossible_mesh, "meshes torn, folded, doubled or without their groups"),
    "references": (faults.broken_reference, "files of reference values with other values or bytes"),
    "tables": (faults.broken_table, "tables of p(θ) with cells of all sorts"),
    "sweeps": (broken_sweep, "sweep files with values, keys and bytes of all sorts"),
    "changed sweeps": (changed_sweep, "sweep files of the studies, changed anywhere"),
    "journals": (
        damaged_journal,
        "journals of a sweep with flipped, lost, doubled and zeroed bytes",
    ),
    "command lines": (faults.command_line, "commands with options of all sorts"),
    "words": (faults.wrong_words, "words that are no command line"),
}
"""What breaks an input, and what that is in words."""


class InputVerdict(NamedTuple):
    """What became of an input: its number, exit status, seconds of processor time, the fault (empty
    where there is none), and the line that refused the input.
    """

    number: int
    status: int
    seconds: float
    fault: str
    line: str = ""


def made(generator: str, number: int) -> BrokenInput:
    """Input `number` of a generator, the same every time."""
    return GENERATORS[generator][0](random.Random(f"{generator} {number}"))


def tried(generator: str, number: int, apart: bool = False) -> InputVerdict:
    """Run an input in this process or (`apart`) in one of its own, and judge how it ends."""
    given = made(generator, number)
    apart = apart and all(map(passes, given.words))
    end = in_subprocess(given) if apart else in_process(given)
    fault = fault_of(given, end)
    if not fault and end.status == 0 and given.words[0] == "solve" and not apart:
        fault = _unsound(given)
    line = end.err.removeprefix("drumlin: ").strip()[:KEPT_LETTERS] if end.status else ""
    said = f"{faults.shown(given)}: {fault}" if fault else ""
    return InputVerdict(number, end.status, end.seconds, said, line)


def _unsound(given: BrokenInput) -> str:
    """Why the answer of a solve cannot be true, or how solving it again fails; else empty."""
    try:
        return fault_of_answer(given)
    except Exception as error:
        return f"solved again: {line_and_status(error)[0]}"


def passes(word: str) -> bool:
    """Whether a process can be given the word: without NUL, and of letters that have bytes."""
    try:
        return b"\0" not in os.fsencode(word)
    except UnicodeEncodeError:
        return False


def _chunk(case: Case) -> dict[str, Any]:
    numbers = range(case["first"], case["first"] + case["count"])
    return {
        "verdicts": [
            tried(case["generator"], number, case["apart"])._asdict() for number in numbers
        ]
    }


def try_all(
    counts: dict[str, int],
    journal: Journal,
    *,
    apart: bool = False,
    processes: int = 0,
    say: Callable[[str], None] = lambda _: None,
) -> dict[str, list[InputVerdict]]:
    """So many inputs of each generator, in this process or in several, those that the journal has
    not yet.
    """
    cases = {
        name: [
            {
                "generator": name,
                "first": first,
                "count": min(INPUTS_AT_A_TIME, count - first),
                "apart": apart,
            }
            for first in range(0, count, INPUTS_AT_A_TIME)
        ]
        for name, count in counts.items()
    }
    kept(
        [case for of in cases.values() for case in of],
        _chunk,
        journal,
        say,
        processes,
        f"lots of {INPUTS_AT_A_TIME} inputs",
    )
    return {
        name: [InputVerdict(**row) for case in of for row in journal[case]["verdicts"]]
        for name, of in cases.items()
    }


def table(verdicts: dict[str, list[InputVerdict]]) -> list[dict[str, Any]]:
    """A row a generator: how its inputs ended, the faults, the longest run; the last row is the
    sum.
    """
    rows: list[dict[str, Any]] = [
        {
            "generator": name,
            "what": GENERATORS[name][1],
            "inputs": len(of),
            **{
                key: sum(v.status == status for v in of) for key, status in COUNTED_STATUSES.items()
            },
            "faults": sum(bool(v.fault) for v in of),
            "longest": max(v.seconds for v in of),
        }
        for name, of in verdicts.items()
    ]
    total = {key: sum(row[key] for row in rows) for key in ("inputs", *COUNTED_STATUSES, "faults")}
    return [*rows, {"generator": "all", **total, "longest": max(row["longest"] for row in rows)}]


def refusal_lines(verdicts: dict[str, list[InputVerdict]], count: int = 40) -> str:
    """The refusals that come most often, most frequent first, each with its number.

    Lines that differ in numbers and quoted texts alone count as one, shown by its shortest.
    """
    forms: dict[str, list[str]] = {}
    refused = [verdict.line for of in verdicts.values() for verdict in of if verdict.line]
    for line in refused:
        form = re.sub(r"'[^']*'|[-+]?\d[\d.e+-]*", "…", line)
        forms.setdefault(form, []).append(line)
    most = sorted(forms.values(), key=len, reverse=True)[:count]
    return "\n".join(f"{len(lines):5d}  {min(lines, key=len)[:160]}" for lines in most)


COUNTED_STATUSES = {"answers": 0, "refused": 2, "no answer": 3}
