"""Runs drumlin on thousands of broken inputs, and keeps in a journal how each run ended.

A generator is a function that makes random broken inputs of one kind.
"""

import itertools
import os
import random
import re
from collections.abc import Callable
from typing import Any, NamedTuple

from drumlin.base.errors import error_line_and_exit_status
from drumlin.base.journal import JournalOfCaseResults
from drumlin_studies.fuzzing import faults
from drumlin_studies.fuzzing.broken_meshes import make_input_with_impossible_mesh
from drumlin_studies.fuzzing.broken_sweeps import (
    make_input_with_broken_sweep,
    make_input_with_changed_sweep,
    make_input_with_damaged_journal,
)
from drumlin_studies.fuzzing.endings import (
    describe_fault_of_run,
    run_command_of_input_in_new_process,
    run_input_in_this_process,
)
from drumlin_studies.fuzzing.impossible import (
    make_input_with_broken_structure,
    make_input_with_huge_file,
)
from drumlin_studies.fuzzing.inputs import FilesAndCommandLineOfBrokenInput
from drumlin_studies.fuzzing.soundness import explain_wrong_answer_to_input
from drumlin_studies.side_by_side import ComputationInput, compute_cases_in_parallel_with_journal

INPUTS_PER_PROCESS_AND_JOURNAL_ENTRY = 50
"""Number of inputs that one process runs in one go. Their verdicts make one entry of the journal.
"""
LETTERS_KEPT_OF_ERROR_MESSAGE = 300
"""Number of letters of an error message that a verdict keeps, enough to see what was refused."""

INPUT_GENERATORS_BY_NAME: dict[
    str, tuple[Callable[[random.Random], FilesAndCommandLineOfBrokenInput], str]
] = {
    "bytes": (faults.make_input_with_broken_bytes, "a brake file with its bytes in disorder"),
    "schema": (
        faults.make_input_with_wrong_values,
        "keys of the brake file's schema with values near and far",
    ),
    "sizes": (
        faults.make_input_with_scaled_quantities,
        "quantities of a brake file made larger or smaller by up to 1e12",
    ),
    "structure": (
        make_input_with_broken_structure,
        "a brake file with a key renamed or of another type",
    ),
    "huge": (make_input_with_huge_file, "brake files that are deep, long or wide beyond sense"),
    "meshes": (
        faults.make_input_with_broken_mesh,
        "mesh files cut off, mislabelled, with numbers that lie",
    ),
    "impossible meshes": (
        make_input_with_impossible_mesh,
        "meshes torn, folded, doubled or without their groups",
    ),
    "references": (
        faults.make_input_with_broken_reference,
        "files of reference values with other values or bytes",
    ),
    "tables": (
        faults.make_input_with_broken_pressure_table,
        "tables of p(θ) with cells of all sorts",
    ),
    "sweeps": (
        make_input_with_broken_sweep,
        "sweep files with values, keys and bytes of all sorts",
    ),
    "changed sweeps": (
        make_input_with_changed_sweep,
        "sweep files of the studies, changed anywhere",
    ),
    "journals": (
        make_input_with_damaged_journal,
        "journals of a sweep with flipped, lost, doubled and zeroed bytes",
    ),
    "command lines": (faults.make_input_with_random_command, "commands with options of all sorts"),
    "words": (faults.make_input_with_wrong_command, "words that are no command line"),
}
"""The generators of broken inputs by name: a function that makes an input, and a description."""


class InputVerdict(NamedTuple):
    """How the run of a broken input ended, and whether this end is a fault of drumlin.

    Attributes
    ----------
    number : int
        Number of the input. The generator's name and this number determine the input.
    status : int
        Exit status of the run.
    seconds : float
        Processor time of the run [s].
    fault : str
        Fault of drumlin; "" if the run ended well.
    line : str
        First letters of the error message of the run; "" if the exit status is 0.
    """

    number: int
    status: int
    seconds: float
    fault: str
    line: str = ""


EXIT_STATUSES_OF_GOOD_ENDS_BY_COLUMN = {"answers": 0, "refused": 2, "no answer": 3}
"""The exit statuses of runs that end well, by the name of the table's column that counts them."""


def make_numbered_input_of_generator(
    generator: str, number: int
) -> FilesAndCommandLineOfBrokenInput:
    """Make input number `number` of a generator. The same number gives the same input."""
    return INPUT_GENERATORS_BY_NAME[generator][0](random.Random(f"{generator} {number}"))


def run_and_judge_input(generator: str, number: int, apart: bool = False) -> InputVerdict:
    """Make input number `number` of a generator, run it, and judge how the run ended.

    If `apart` is true, the input runs in a new process; if not, it runs in this process.
    """
    # A command line with a NUL byte or a letter outside of UTF-8 cannot start a new process. It
    # runs in this process.
    given = make_numbered_input_of_generator(generator, number)
    apart = apart and all(map(can_be_process_argument, given.words))
    end = run_command_of_input_in_new_process(given) if apart else run_input_in_this_process(given)
    fault = describe_fault_of_run(given, end)
    # A brake that was solved successfully is solved again in this process, to check the numbers.
    if not fault and end.status == 0 and given.words[0] == "solve" and not apart:
        fault = _explain_wrong_or_failing_answer(given)
    line = (
        end.err.removeprefix("drumlin: ").strip()[:LETTERS_KEPT_OF_ERROR_MESSAGE]
        if end.status
        else ""
    )
    said = f"{faults.command_line_as_text(given)}: {fault}" if fault else ""
    return InputVerdict(number, end.status, end.seconds, said, line)


def _explain_wrong_or_failing_answer(given: FilesAndCommandLineOfBrokenInput) -> str:
    """Why the response to an input must be wrong, or the error of the solve; "" if neither."""
    try:
        return explain_wrong_answer_to_input(given)
    except Exception as error:
        return f"solved again: {error_line_and_exit_status(error)[0]}"


def can_be_process_argument(word: str) -> bool:
    """Whether a word can be an argument of a process: without NUL, and with letters in UTF-8."""
    try:
        return b"\0" not in os.fsencode(word)
    except UnicodeEncodeError:
        return False


def _run_chunk_of_inputs_and_return_verdicts(case: ComputationInput) -> dict[str, Any]:
    """Run several inputs of a generator; returns their verdicts, which make one journal entry."""
    numbers = range(case["first"], case["first"] + case["count"])
    generator, apart = case["generator"], case["apart"]
    return {
        "verdicts": [run_and_judge_input(generator, number, apart)._asdict() for number in numbers]
    }


def run_and_judge_generators(
    counts: dict[str, int],
    journal: JournalOfCaseResults,
    *,
    apart: bool = False,
    processes: int = 0,
    say: Callable[[str], None] = lambda _: None,
) -> dict[str, list[InputVerdict]]:
    """Run the first inputs of each generator; returns the verdicts by the generators' names.

    Parameters
    ----------
    counts : dict
        Number of inputs of each generator.
    journal : JournalOfCaseResults
        Journal of this experiment; inputs with a verdict in it are not run again.
    apart : bool
        Whether each input runs in a new process.
    processes : int
        Number of processes that share the work; with 0 this process does all the work.
    say : function
        Function that gets a line of text on the progress.
    """
    # Each case is a chunk of inputs of one generator, which one process runs together.
    cases: dict[str, list[dict[str, Any]]] = {name: [] for name in counts}
    for name, count in counts.items():
        for first in range(0, count, INPUTS_PER_PROCESS_AND_JOURNAL_ENTRY):
            case = {"generator": name, "first": first}
            case |= {
                "count": min(INPUTS_PER_PROCESS_AND_JOURNAL_ENTRY, count - first),
                "apart": apart,
            }
            cases[name].append(case)
    everything = list(itertools.chain(*cases.values()))
    compute_cases_in_parallel_with_journal(
        everything,
        _run_chunk_of_inputs_and_return_verdicts,
        journal,
        say,
        processes,
        f"lots of {INPUTS_PER_PROCESS_AND_JOURNAL_ENTRY} inputs",
    )
    verdicts: dict[str, list[InputVerdict]] = {name: [] for name in counts}
    for name, of in cases.items():
        for case in of:
            verdicts[name] += [InputVerdict(**row) for row in journal[case]["verdicts"]]
    return verdicts


def rows_of_verdict_counts_by_generator(
    verdicts: dict[str, list[InputVerdict]],
) -> list[dict[str, Any]]:
    """Summarise verdicts in a table with a row for each generator, and a last row for all.

    A row has the number of inputs with each good end, the number of faults, and the longest
    processor time [s] of an input.
    """
    rows: list[dict[str, Any]] = []
    for name, of in verdicts.items():
        row = {"generator": name, "what": INPUT_GENERATORS_BY_NAME[name][1], "inputs": len(of)}
        for key, status in EXIT_STATUSES_OF_GOOD_ENDS_BY_COLUMN.items():
            row[key] = sum(verdict.status == status for verdict in of)
        row["faults"] = sum(bool(verdict.fault) for verdict in of)
        row["longest"] = max(verdict.seconds for verdict in of)
        rows.append(row)
    total: dict[str, Any] = {"generator": "all"}
    for key in ("inputs", *EXIT_STATUSES_OF_GOOD_ENDS_BY_COLUMN, "faults"):
        total[key] = sum(row[key] for row in rows)
    total["longest"] = max(row["longest"] for row in rows)
    return [*rows, total]


def most_frequent_refusals_text(verdicts: dict[str, list[InputVerdict]], count: int = 40) -> str:
    """The `count` most frequent error messages, one on each line, with the number of inputs.

    Messages that differ only in numbers and quoted texts count as one message. The shortest of them
    is shown.
    """
    # Messages are grouped by their wording without numbers and quoted texts.
    forms: dict[str, list[str]] = {}
    lines = [verdict.line for verdict in itertools.chain(*verdicts.values())]
    for line in filter(None, lines):
        form = re.sub(r"'[^']*'|[-+]?\d[\d.e+-]*", "…", line)
        forms.setdefault(form, []).append(line)
    most = sorted(forms.values(), key=len, reverse=True)[:count]
    return "\n".join(f"{len(lines):5d}  {min(lines, key=len)[:160]}" for lines in most)
