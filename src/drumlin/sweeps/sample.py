"""The sample of a sweep: the cases that are solved on all levels, and what follows for the others.

A level is a division of the shoes into finite elements; each level is finer than the level before.
The sample has a case of each N successive cases, drawn at random, and the cases with the smallest
and the largest value of each varied number. A fixed step of N cases would always take the same
value of a key that has N values. The first level is often worst at one of the extreme values: on
eight sweeps of 30 to 45 cases its errors were up to 9.3 times the largest difference between first
and last level in a sample of every 10th case without the extreme values. With the extreme values
they were up to 1.9 times this difference.
"""

import random
import re
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from drumlin.base.errors import BadInput
from drumlin.base.journal import JournalOfCaseResults
from drumlin.base.texts import value_as_text
from drumlin.sweeps.cases import (
    CaseResultsByName,
    SweepCase,
    journal_keys_of_cases,
    paths_of_mesh_files,
    solve_all_cases_of_sweep,
)
from drumlin.sweeps.certificate import (
    LEAST_SOLVED_CASES_OF_CERTIFYING_SAMPLE,
    ROW_KEY_OF_FIRST_LEVEL_ERRORS,
    MarkOfSampleCaseSolvedOnAllLevels,
    SampleErrorsForCasesOutsideSample,
    is_varied_value_a_number,
    sample_errors_for_cases_outside_sample,
)

CERTIFY_VALUE_FOR_OWN_ERRORS_OF_EACH_CASE = "every case"
"""The value of the key `certify` with which each case states its own errors."""

PATTERN_OF_CERTIFY_VALUE_EVERY_NTH = "every [0-9]{1,6}(st|[nr]d|th)"
"""The pattern of values of the key `certify` such as "every 10th": a case of each 10 is drawn."""

FEM_OPTIONS_ALLOWED_WITH_SAMPLE = {"penalty", "model_error"}
"""Options of the finite elements that a sweep certified by sample may have.

All other options choose the elements, or correct the answer of the last level.
"""


def positions_of_sample_cases(
    cases: Sequence[SweepCase], certify: str | int, seed: int
) -> tuple[int, ...]:
    """The positions of the cases in the sample, in growing order.

    There are none if each case states its own errors.

    Parameters
    ----------
    cases : all cases of the sweep; cases of other models than "fem" are not in the sample
    certify : "every case", "every 10th" or another number, or the number of cases to draw
    seed : seed of the draw

    Raises
    ------
    BadInput
        if `certify` has another value, or if a sample cannot state the errors of the sweep
    """
    if certify == CERTIFY_VALUE_FOR_OWN_ERRORS_OF_EACH_CASE:
        return ()
    shown = f"certify = {value_as_text(certify)}"
    own = [i for i, case in enumerate(cases) if case.model == "fem"]
    _check_sample_can_state_errors_of_cases(cases, own, shown)
    drawn = _number_of_cases_to_draw_for_sample(certify, len(own), shown)
    rng = random.Random(seed)
    positions = set()
    for k in range(drawn):
        block = own[k * len(own) // drawn : (k + 1) * len(own) // drawn]
        positions.add(rng.choice(block))
    return tuple(sorted(positions | _positions_of_cases_with_extreme_varied_values(cases, own)))


def _number_of_cases_to_draw_for_sample(certify: str | int, count: int, shown: str) -> int:
    """How many of `count` cases to draw; `shown` is the key as an error message shows it."""
    allowed = 'allowed: "every case", "every 10th" or another number, or a number of cases'
    drawn = certify
    if isinstance(certify, str):
        # The pattern allows at most six digits from 0 to 9, so that `int` can read them.
        is_step = re.fullmatch(PATTERN_OF_CERTIFY_VALUE_EVERY_NTH, certify) is not None
        step = int("".join(filter(str.isdigit, certify))) if is_step else 0
        if step < 2:
            raise BadInput(f"{shown}: {allowed}")
        drawn = -(-count // step)
    # A sweep with fewer than LEAST_SOLVED_CASES_OF_CERTIFYING_SAMPLE cases cannot have a sample.
    allowed_numbers = (
        f"{LEAST_SOLVED_CASES_OF_CERTIFYING_SAMPLE} to {count}"
        if count >= LEAST_SOLVED_CASES_OF_CERTIFYING_SAMPLE
        else "none"
    )
    if not LEAST_SOLVED_CASES_OF_CERTIFYING_SAMPLE <= int(drawn) <= count:
        raise BadInput(
            f"{shown}: is a sample of {value_as_text(drawn)} of {count} cases by finite elements; "
            f"allowed: {allowed_numbers}"
        )
    return int(drawn)


def _check_sample_can_state_errors_of_cases(
    cases: Sequence[SweepCase], own: Sequence[int], shown: str
) -> None:
    """Raise BadInput if a sample cannot state the errors of the cases by finite elements.

    It cannot for a mesh from a file and for other options than FEM_OPTIONS_ALLOWED_WITH_SAMPLE.
    `own` are the positions of the cases by finite elements, and `shown` is the key in the error
    message.
    """
    if not own:
        raise BadInput(f"{shown}: is for [model.fem], which this sweep does not have")
    others = sorted(set(cases[own[0]].options) - FEM_OPTIONS_ALLOWED_WITH_SAMPLE)
    if others:
        raise BadInput(
            f"{shown}: does not go with model.fem.{others[0]} = {cases[own[0]].options[others[0]]}"
        )
    if any(paths_of_mesh_files(cases[i].brake, cases[i].changes) for i in own):
        raise BadInput(f"{shown}: does not go with mesh files")


def _positions_of_cases_with_extreme_varied_values(
    cases: Sequence[SweepCase], own: Sequence[int]
) -> set[int]:
    """The positions of the cases with the smallest and the largest value of each varied number.

    Of several cases with this value the first one counts. Only the cases at the positions `own`,
    the cases by finite elements, are looked at.
    """
    found = set()
    for key in cases[own[0]].changes:
        values: list[tuple[Any, int]] = []
        for i in own:
            value = cases[i].changes[key]
            if is_varied_value_a_number(value):
                values.append((value, i))
        if values:
            found.add(min(values)[1])
            found.add(max(values, key=lambda pair: (pair[0], -pair[1]))[1])
    return found


class SolvedSweep(NamedTuple):
    """A solved sweep: the row of results of each case, and the cases as they were solved.

    The attribute `certify` of a case tells whether its errors come from the sample.
    """

    rows: list[CaseResultsByName]
    cases: list[SweepCase]


def solve_sample_cases_and_then_all_others(
    cases: Sequence[SweepCase],
    sample: Sequence[int],
    *,
    journal: JournalOfCaseResults | None = None,
    done: Callable[[int, int], None] = lambda finished, of: None,
    say: Callable[[str], None] = lambda line: None,
    **options: Any,
) -> SolvedSweep:
    """Solve the cases of a sweep, first the cases of the sample and then all other cases.

    Returns the rows of results and the cases, both in the order of `cases`. Without a sample all
    cases are solved at once.

    Parameters
    ----------
    cases : the cases
    sample : positions of the cases in the sample, see `positions_of_sample_cases`
    journal : file that keeps the row of each finished case; None: they are kept in memory
    done : called with the number of finished cases and the number of all cases
    say : called with a line when the sweep waits for workers, and if the sample is useless
    options : further arguments of `solve_all_cases_of_sweep`, which also says what is raised
    """
    journal = JournalOfCaseResults() if journal is None else journal
    options |= {"journal": journal, "say": say}
    if not sample:
        return SolvedSweep(solve_all_cases_of_sweep(cases, done=done, **options), list(cases))
    members = [cases[i]._replace(certify=MarkOfSampleCaseSolvedOnAllLevels()) for i in sample]
    rows_of_sample = solve_all_cases_of_sweep(
        members, done=lambda finished, _: done(finished, len(cases)), **options
    )
    reason = _reason_why_sample_must_not_certify_cases(cases, sample, rows_of_sample)
    if any(key not in journal for key in journal_keys_of_cases(members)):
        reason = "a case of the sample failed for a reason that may pass"
    if reason:
        say(f"no case is certified by the sample, each states its own errors: {reason}")
    certificate = SampleErrorsForCasesOutsideSample((), {})
    if not reason:
        certificate = sample_errors_for_cases_outside_sample(rows_of_sample)
    rest = sorted(set(range(len(cases))) - set(sample))
    others = []
    for i in rest:
        by_sample = cases[i].model == "fem"
        others.append(cases[i]._replace(certify=certificate) if by_sample else cases[i])
    rows_of_rest = solve_all_cases_of_sweep(
        others, done=lambda finished, _: done(len(sample) + finished, len(cases)), **options
    )
    places = [*sample, *rest]
    rows = dict(zip(places, [*rows_of_sample, *rows_of_rest], strict=True))
    solved = dict(zip(places, [*members, *others], strict=True))
    order = range(len(cases))
    return SolvedSweep(
        [_row_without_first_level_errors(rows[i]) for i in order], [solved[i] for i in order]
    )


def _reason_why_sample_must_not_certify_cases(
    cases: Sequence[SweepCase], sample: Sequence[int], rows_of_sample: Sequence[CaseResultsByName]
) -> str:
    """Why other cases must not take their errors from a solved sample; "" if they may.

    Without the errors of a case with an extreme value, or of enough cases, the largest error of
    the sample may be too small for the other cases.

    Parameters
    ----------
    cases : all cases of the sweep
    sample : positions of the cases in the sample
    rows_of_sample : results of the cases in the sample
    """
    solved = {
        i
        for i, row in zip(sample, rows_of_sample, strict=True)
        if ROW_KEY_OF_FIRST_LEVEL_ERRORS in row
    }
    own = [i for i, case in enumerate(cases) if case.model == "fem"]
    missing = sorted(_positions_of_cases_with_extreme_varied_values(cases, own) - solved)
    if missing:
        return f"case {missing[0]}, which has an extreme value, has no errors of its first level"
    if len(solved) < LEAST_SOLVED_CASES_OF_CERTIFYING_SAMPLE:
        return f"only {len(solved)} of its cases have errors of their first level"
    return ""


def _row_without_first_level_errors(row: CaseResultsByName) -> CaseResultsByName:
    """A copy of a row without the errors of its first level, which the table does not show."""
    return {name: value for name, value in row.items() if name != ROW_KEY_OF_FIRST_LEVEL_ERRORS}
