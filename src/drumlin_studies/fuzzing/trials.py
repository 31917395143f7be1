"""Runs of thousands of broken inputs, by generator, with a journal of how each input ended."""

import itertools
import os
import random
import re
from collections.abc import Callable
from typing import Any, NamedTuple

from drumlin.base.errors import line_and_status
from drumlin.base.journal import Journal
from drumlin_studies.fuzzing import faults
from drumlin_studies.fuzzing.broken_meshes import make_impossible_mesh
from drumlin_studies.fuzzing.broken_sweeps import (
    make_broken_sweep,
    make_changed_sweep,
    make_damaged_journal,
)
from drumlin_studies.fuzzing.endings import find_fault, run_in_subprocess, run_in_this_process
from drumlin_studies.fuzzing.impossible import make_broken_structure, make_huge_file
from drumlin_studies.fuzzing.inputs import BrokenInput
from drumlin_studies.fuzzing.soundness import find_unsound_answer
from drumlin_studies.side_by_side import Case, compute_and_keep_cases

INPUTS_AT_A_TIME = 50
"""Number of inputs that a process takes at a time."""
KEPT_LETTERS = 300
"""Number of letters of a refusal that a verdict keeps. They are enough to tell what it refuses."""

GENERATORS: dict[str, tuple[Callable[[random.Random], BrokenInput], str]] = {
    "bytes": (faults.make_broken_bytes, "a brake file with its bytes in disorder"),
    "schema": (
        faults.make_wrong_values,
        "keys of the brake file's schema with values near and far",
    ),
    "sizes": (
        faults.make_scaled_quantities,
        "quantities of a brake file made larger or smaller by up to 1e12",
    ),
    "structure": (make_broken_structure, "a brake file with a key renamed or of another type"),
    "huge": (make_huge_file, "brake files that are deep, long or wide beyond sense"),
    "meshes": (faults.make_broken_mesh, "mesh files cut off, mislabelled, with numbers that lie"),
    "impossible meshes": (
        make_impossible_mesh,
        "meshes torn, folded, doubled or without their groups",
    ),
    "references": (
        faults.make_broken_reference,
        "files of reference values with other values or bytes",
    ),
    "tables": (faults.make_broken_table, "tables of p(θ) with cells of all sorts"),
    "sweeps": (make_broken_sweep, "sweep files with values, keys and bytes of all sorts"),
    "changed sweeps": (make_changed_sweep, "sweep files of the studies, changed anywhere"),
    "journals": (
        make_damaged_journal,
        "journals of a sweep with flipped, lost, doubled and zeroed bytes",
    ),
    "command lines": (faults.make_random_command, "commands with options of all sorts"),
    "words": (faults.make_wrong_command, "words that are no command line"),
}
"""The function that makes an input, and what it makes in words, for each generator."""


class InputVerdict(NamedTuple):
    """How an input ended.

    Attributes
    ----------
    number : int
        Number of the input.
    status : int
        Exit status.
    seconds : float
        Processor time [s].
    fault : str
        What is wrong; empty where nothing is.
    line : str
        The line that refused the input.
    """

    number: int
    status: int
    seconds: float
    fault: str
    line: str = ""


COUNTED_STATUSES = {"answers": 0, "refused": 2, "no answer": 3}
"""The exit statuses of a sound ending, by the key of a row that counts them."""


def make_input(generator: str, number: int) -> BrokenInput:
    """An input of a generator. The same number always gives the same input."""
    return GENERATORS[generator][0](random.Random(f"{generator} {number}"))


def try_input(generator: str, number: int, apart: bool = False) -> InputVerdict:
    """The verdict on an input.

    apart : whether the input runs in a process of its own.
    """
    given = make_input(generator, number)
    apart = apart and all(map(can_be_process_word, given.words))
    end = run_in_subprocess(given) if apart else run_in_this_process(given)
    fault = find_fault(given, end)
    if not fault and end.status == 0 and given.words[0] == "solve" and not apart:
        fault = _find_unsound_answer(given)
    line = end.err.removeprefix("drumlin: ").strip()[:KEPT_LETTERS] if end.status else ""
    said = f"{faults.shown_command_line(given)}: {fault}" if fault else ""
    return InputVerdict(number, end.status, end.seconds, said, line)


def _find_unsound_answer(given: BrokenInput) -> str:
    """Why the answer of a solve cannot be true, or how a second solve fails; else empty."""
    try:
        return find_unsound_answer(given)
    except Exception as error:
        return f"solved again: {line_and_status(error)[0]}"


def can_be_process_word(word: str) -> bool:
    """Whether a process can take a word: it has no NUL, and all its letters have bytes."""
    try:
        return b"\0" not in os.fsencode(word)
    except UnicodeEncodeError:
        return False


def _verdicts_of_chunk(case: Case) -> dict[str, Any]:
    """The verdicts on the inputs that a process takes at a time."""
    numbers = range(case["first"], case["first"] + case["count"])
    generator, apart = case["generator"], case["apart"]
    return {"verdicts": [try_input(generator, number, apart)._asdict() for number in numbers]}


def try_generators(
    counts: dict[str, int],
    journal: Journal,
    *,
    apart: bool = False,
    processes: int = 0,
    say: Callable[[str], None] = lambda _: None,
) -> dict[str, list[InputVerdict]]:
    """The verdicts on the first inputs of each generator.

    Parameters
    ----------
    counts : dict
        Number of inputs of each generator.
    journal : Journal
        Inputs with a verdict in the journal are not run again.
    apart : bool
        Whether each input runs in a process of its own.
    processes : int
        Number of processes besides this one; 0 runs in this one.
    say : function
        Is told how far the work is.
    """
    cases: dict[str, list[dict[str, Any]]] = {name: [] for name in counts}
    for name, count in counts.items():
        for first in range(0, count, INPUTS_AT_A_TIME):
            case = {"generator": name, "first": first}
            case |= {"count": min(INPUTS_AT_A_TIME, count - first), "apart": apart}
            cases[name].append(case)
    everything = list(itertools.chain(*cases.values()))
    compute_and_keep_cases(
        everything,
        _verdicts_of_chunk,
        journal,
        say,
        processes,
        f"lots of {INPUTS_AT_A_TIME} inputs",
    )
    verdicts: dict[str, list[InputVerdict]] = {name: [] for name in counts}
    for name, of in cases.items():
        for case in of:
            verdicts[name] += [InputVerdict(**row) for row in journal[case]["verdicts"]]
    return verdicts


def verdict_table(verdicts: dict[str, list[InputVerdict]]) -> list[dict[str, Any]]:
    """A row for each generator: how its inputs ended, the faults, and the longest run.

    The last row is on all inputs.
    """
    rows: list[dict[str, Any]] = []
    for name, of in verdicts.items():
        row = {"generator": name, "what": GENERATORS[name][1], "inputs": len(of)}
        for key, status in COUNTED_STATUSES.items():
            row[key] = sum(verdict.status == status for verdict in of)
        row["faults"] = sum(bool(verdict.fault) for verdict in of)
        row["longest"] = max(verdict.seconds for verdict in of)
        rows.append(row)
    total = {key: sum(row[key] for row in rows) for key in ("inputs", *COUNTED_STATUSES, "faults")}
    return [*rows, {"generator": "all", **total, "longest": max(row["longest"] for row in rows)}]


def refusal_lines(verdicts: dict[str, list[InputVerdict]], count: int = 40) -> str:
    """The refusals that come most often, most frequent first, each with its number.

    Lines that differ in numbers and quoted texts alone count as one, shown by its shortest.
    """
    forms: dict[str, list[str]] = {}
    lines = [verdict.line for verdict in itertools.chain(*verdicts.values())]
    for line in filter(None, lines):
        form = re.sub(r"'[^']*'|[-+]?\d[\d.e+-]*", "…", line)
        forms.setdefault(form, []).append(line)
    most = sorted(forms.values(), key=len, reverse=True)[:count]
    return "\n".join(f"{len(lines):5d}  {min(lines, key=len)[:160]}" for lines in most)
