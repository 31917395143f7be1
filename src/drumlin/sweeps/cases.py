"""Solving of the cases of a sweep, in this process or by workers; a journal keeps each result.

A case is a brake with some changed values and a model. Its results, called its row, depend on the
case alone: neither on the worker that solved the case nor on the cases solved before. A sweep that
was stopped and continued therefore gives the same table as a sweep that was never stopped.
"""

import hashlib
import json
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.errors import (
    BadInput,
    DrumlinError,
    NoAnswer,
    is_failure_of_memory_or_system,
)
from drumlin.base.journal import (
    JournalOfCaseResults,
    case_data_as_json_line,
    checksum_of_source_and_libraries,
)
from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.fem.preparation.cache import CacheOfCondensedBodies
from drumlin.mesh_files.content import digest_of_mesh_file
from drumlin.models import model_with_name_that_applies_to_brake
from drumlin.response.merit import brake_factor
from drumlin.response.response import Response, ShoeResponse
from drumlin.sweeps.certificate import (
    NAME_OF_COLUMN_WITH_SOURCE_OF_ERRORS,
    ROW_KEY_OF_FIRST_LEVEL_ERRORS,
    MarkOfSampleCaseSolvedOnAllLevels,
    SampleErrorsForCasesOutsideSample,
    kind_and_first_level_errors_of_sample_case_from_responses,
    response_with_errors_certified_by_sample,
)
from drumlin.sweeps.workers import ShowLineToUser, message_on_waiting_for_workers

CaseResultsByName = dict[str, Any]
"""The results of a case by name, such as "torque"; "status" is "solved" or says why it failed."""

SECONDS_BEFORE_WAITING_MESSAGE = 20.0
"""Seconds without a result after which a message says that the sweep waits for workers.

The limit is a judgement: most cases take far less.
"""

SECONDS_OF_WORK_PER_CHUNK_OF_CASES = 0.1
"""Seconds that a chunk should take: the cases that a worker gets in one message.

With longer chunks more work is lost when the sweep is killed. Shorter chunks need more messages
between the processes.
"""

MAX_CASES_PER_CHUNK = 64
"""Largest number of cases that a worker gets in one message, however fast they are solved."""

MOST_FURTHER_ATTEMPTS_AT_CASE_AFTER_WORKER_FAILURE = 2
"""Number of further attempts at a case that failed because memory was short or its worker died."""

DIFFERENT_DRUMLIN_MESSAGE = (
    "executor: its workers run another drumlin, or other libraries, than this one; "
    "install the same there"
)
"""The message of the error if workers have another version of drumlin or its libraries."""

KEYS_WITHOUT_EFFECT_ON_STIFFNESS = (
    "title",
    "rotation",
    "friction",
    "clearance",
    "misfit",
    "out_of_round",
    "angle",
    "force",
    "direction",
    "point",
)
"""Keys of a brake file that do not change the stiffness of the shoes.

Cases that differ in these keys alone are solved one after the other, with the same condensed
stiffness.
"""


class SweepCase(NamedTuple):
    """A case of a sweep: a brake with some changed values, and the model that solves it.

    Attributes
    ----------
    brake : the base brake
    changes : new values of the brake, by key of the brake file
    model : name of the model
    options : options of the model
    certify : MarkOfSampleCaseSolvedOnAllLevels if the case belongs to the sample that certifies the
        sweep; SampleErrorsForCasesOutsideSample if it takes its errors from this sample; None if it
        states its own errors
    """

    brake: Brake
    changes: Mapping[str, Any]
    model: str = "fem"
    options: Mapping[str, Any] = {}
    certify: MarkOfSampleCaseSolvedOnAllLevels | SampleErrorsForCasesOutsideSample | None = None


class ResultOfAttemptAtCase(NamedTuple):
    """The result of one attempt to solve a case.

    Attributes
    ----------
    row : results of the case, or the reason of its failure
    is_kept_in_journal : whether the journal keeps the row, because a further attempt would give
        the same row
    again : whether the case is tried again, because a further attempt may succeed
    """

    row: CaseResultsByName
    is_kept_in_journal: bool = True
    again: bool = False


def solve_case_and_return_brake_and_response(
    case: SweepCase,
    cache: CacheOfCondensedBodies | None = None,
    use_first_level: Callable[[Response], None] | None = None,
) -> tuple[Brake, Response]:
    """Solve a case; returns the brake with its changed values, and the response of the model.

    Parameters
    ----------
    case : the case
    cache : store of condensed stiffnesses; the models "fem" and "solid" take the stiffness of an
        equal shoe from it, and add the stiffness of each new shoe
    use_first_level : called by the model "fem" with the response on its first level, see
        `drumlin.fem.solve.solve`; None for other models

    Raises
    ------
    BadInput, NoAnswer
        as the model does
    """
    brake = _brake_of_case(case)
    options = dict(case.options)
    if use_first_level is not None:
        options["use_first_level"] = use_first_level
    if case.model in {"fem", "solid"}:
        options["cache"] = cache
    return brake, model_with_name_that_applies_to_brake(case.model, brake).solve(brake, **options)


def _brake_of_case(case: SweepCase) -> Brake:
    """The brake of a case with its changed values."""
    # Without changes the brake needs no check, since the base brake has been checked before.
    return vary(case.brake, case.changes) if case.changes else case.brake


def solve_case_without_raising(
    case: SweepCase, cache: CacheOfCondensedBodies | None = None
) -> ResultOfAttemptAtCase:
    """Solve a case, and say whether its results may be kept. Never raises.

    Results are kept, and so are refusals because of the input or the physics. A failure because
    memory or a file is missing is not kept, because a later attempt may succeed. An unexpected
    error, a fault of drumlin, is not kept and not tried again.
    """
    try:
        return ResultOfAttemptAtCase(_solve_case_and_return_results(case, cache))
    # An error in one case must not end the sweep. It is written into the row of the case.
    except Exception as error:
        return _answer_of_failed_case(case, error)


def _solve_case_and_return_results(
    case: SweepCase, cache: CacheOfCondensedBodies | None
) -> CaseResultsByName:
    """The results of a case by name; with a certificate, also where its stated errors come from."""
    # A case that takes its errors from the sample is solved on the first level only. If the sample
    # has no case of the same kind, the case is solved on all levels.
    if isinstance(case.certify, SampleErrorsForCasesOutsideSample):
        brake = _brake_of_case(case)
        by_sample = response_with_errors_certified_by_sample(
            brake, case.changes, case.certify, case.options, cache
        )
        if by_sample is not None:
            row = results_of_response_by_name(brake, by_sample)
            return {"status": row["status"], NAME_OF_COLUMN_WITH_SOURCE_OF_ERRORS: "sample"} | row
    first: list[Response] = []
    use = first.append if isinstance(case.certify, MarkOfSampleCaseSolvedOnAllLevels) else None
    brake, response = solve_case_and_return_brake_and_response(case, cache, use)
    row = results_of_response_by_name(brake, response)
    if case.certify is None:
        return row
    row = {"status": row["status"], NAME_OF_COLUMN_WITH_SOURCE_OF_ERRORS: "itself"} | row
    if first and response.converged:
        row[ROW_KEY_OF_FIRST_LEVEL_ERRORS] = (
            kind_and_first_level_errors_of_sample_case_from_responses(
                brake, case.changes, first[0], response
            )
        )
    return row


def _answer_of_failed_case(case: SweepCase, error: Exception) -> ResultOfAttemptAtCase:
    """The answer for a case that ended with an error: a row with the error's text as its status."""
    known = isinstance(error, DrumlinError)
    text = str(error) if known else f"unexpected {type(error).__name__}: {error}"
    passing = is_failure_of_memory_or_system(error)
    # If a mesh file cannot be read now (its digest is "none"), a later attempt may succeed.
    readable = "none" not in map(digest_of_mesh_file, paths_of_mesh_files(case.brake, case.changes))
    row = {"status": f"failed: {' '.join(text.split())}"}
    return ResultOfAttemptAtCase(
        row, is_kept_in_journal=known and not passing and readable, again=passing
    )


def results_of_response_by_name(brake: Brake, response: Response) -> CaseResultsByName:
    """The results of a case by name, in SI; results of the shoe NAME as "NAME.torque" and so on.

    Of the brake: "torque" T [N m], on a plane "braking_force" [N]; "brake_factor" T/(F R) with the
    mean actuation force F and the drum radius R, on a plane braking force / F; "peak_pressure"
    [Pa], the largest of all shoes; "balance", the larger one of the relative imbalances of forces
    and of moments. A response with error estimates adds the relative errors "error_pressure",
    "error_torque", "error_peak" and "error_reaction" (see `Response.error`). A response that also
    estimates the error of the plane-stress model adds "plane_stress_error_torque",
    "plane_stress_error_pressure" and "plane_stress_error_reaction", or, if this error is not known,
    the reason as "plane_stress_error_unknown".

    Of each shoe: torque, peak_pressure, shoe_factor T/(F R) and hinge_reaction [N]; contact_start
    and contact_end, the ends of the contact [rad; on a plane m]; contact_arcs, the number of
    separate arcs in contact.
    """
    row: CaseResultsByName = {
        "status": "solved" if response.converged else "failed: not converged",
        brake.surface.key_of_torque_or_brake_force: response.effect,
        "brake_factor": brake_factor(brake, response),
        "peak_pressure": max(shoe.peak_pressure for shoe in response.shoes),
        "balance": max(response.balance.force, response.balance.moment),
    }
    for name, value in (response.error or {}).items():
        row[f"error_{name}"] = value
    if response.plane_stress_error is not None:
        for name, value in response.plane_stress_error.brake.items():
            row[f"plane_stress_error_{name}"] = value
        if response.plane_stress_error.unknown:
            row["plane_stress_error_unknown"] = response.plane_stress_error.unknown
    # The results of each shoe follow, with the shoe's name in front.
    for i, shoe in enumerate(response.shoes):
        numbers = _results_of_shoe_by_name(brake, i, response.effects[i], shoe)
        row |= {f"{shoe.name}.{name}": value for name, value in numbers.items()}
    return {name: _result_as_plain_python_value(value) for name, value in row.items()}


def _results_of_shoe_by_name(
    brake: Brake, number: int, effect: float, shoe: ShoeResponse
) -> CaseResultsByName:
    """The results of one shoe by name, in SI.

    Parameters
    ----------
    brake : the brake
    number : index of the shoe among the brake's shoes
    effect : torque of the shoe [N m], on a plane its braking force [N]
    shoe : response of the shoe
    """
    load = abs(brake.shoes[number].actuation.force)
    arcs = shoe.contact_arcs
    return {
        brake.surface.key_of_torque_or_brake_force: effect,
        "peak_pressure": shoe.peak_pressure,
        "shoe_factor": effect / (load * brake.length_per_surface_coordinate) if load else None,
        "hinge_reaction": float(np.linalg.norm(shoe.hinge_reaction)),
        "contact_start": arcs[0][0] if arcs else None,
        "contact_end": arcs[-1][1] if arcs else None,
        "contact_arcs": len(arcs),
    }


def _result_as_plain_python_value(value: Any) -> Any:
    """A result as a plain Python value, which JSON can store: numpy's numbers become floats."""
    return value if value is None or isinstance(value, str | int) else float(value)


def solve_all_cases_of_sweep(
    cases: Sequence[SweepCase],
    *,
    executor: Executor | None = None,
    workers: int = 1,
    journal: JournalOfCaseResults | None = None,
    done: Callable[[int, int], None] = lambda finished, of: None,
    say: ShowLineToUser = lambda words: None,
) -> list[CaseResultsByName]:
    """Solve the cases of a sweep; returns the row of results of each case, in the same order.

    A failure because of missing memory or a dead worker may not occur again. A case with this
    failure is tried twice more, alone in a message to a worker. If the case still fails, its row
    says why, and the journal does not keep this row.

    Parameters
    ----------
    cases : the cases
    executor : executor whose workers solve the cases, in chunks; None: this process solves them
    workers : number of the executor's workers
    journal : file that keeps the row of each finished case; cases that it already has are not
        solved again
    done : called with the number of finished cases and the number of all cases
    say : called with a message when the sweep waits for workers

    Raises
    ------
    NoAnswer
        if all workers are lost; finished cases are in the journal
    BadInput
        if the workers run another version of drumlin or its libraries
    """
    journal = JournalOfCaseResults() if journal is None else journal
    keys = list(journal_keys_of_cases(cases))
    missing = _positions_of_unsolved_cases(cases, keys, journal)
    finished = len(cases) - len(missing)
    done(finished, len(cases))
    # `passing` has the rows of cases that failed but may succeed later, by the journal's key of the
    # case. The journal does not keep these rows.
    passing: dict[str, CaseResultsByName] = {}
    # The first round solves all missing cases. Later rounds try again the cases that failed because
    # memory was short or a worker died.
    for further in reversed(range(MOST_FURTHER_ATTEMPTS_AT_CASE_AFTER_WORKER_FAILURE + 1)):
        again = []
        if executor is None:
            answers = _solve_cases_in_this_process(cases, missing)
        else:
            alone = further < MOST_FURTHER_ATTEMPTS_AT_CASE_AFTER_WORKER_FAILURE
            answers = _solve_cases_by_workers(
                _ChunkDispatcher(executor, workers, cases, missing, alone), say
            )
        # Store each answer as it comes, and collect the cases that are tried again.
        for i, answer in answers:
            if answer.is_kept_in_journal:
                journal.add(keys[i], answer.row)
                passing.pop(case_data_as_json_line(keys[i]), None)
            else:
                passing[case_data_as_json_line(keys[i])] = answer.row
            if answer.again and further:
                again.append(i)
            else:
                finished += 1
                done(finished, len(cases))
        missing = again
    return [passing.get(case_data_as_json_line(key)) or journal[key] for key in keys]


def _positions_of_unsolved_cases(
    cases: Sequence[SweepCase], keys: Sequence[dict[str, Any]], journal: JournalOfCaseResults
) -> list[int]:
    """The positions of the cases that are not in the journal.

    Of equal cases only one is listed. Cases whose shoes have the same stiffness stand one after the
    other.
    """
    unsolved = [i for i, key in enumerate(keys) if key not in journal]
    distinct = {json.dumps(keys[i]): i for i in unsolved}

    def sort_key_of_case_at_position(i: int) -> tuple[str, str, int]:
        """The key that sorts the case at position i: model, data of the shoes' stiffness, i."""
        return cases[i].model, key_of_cases_with_equal_shoe_stiffness(cases[i]), i

    return sorted(distinct.values(), key=sort_key_of_case_at_position)


def journal_keys_of_cases(cases: Iterable[SweepCase]) -> Iterator[dict[str, Any]]:
    """Yield for each case the data by which the journal recognises the case.

    These data are a digest of the base brake, the changed values, the model, its options and the
    certificate. A changed mesh file is represented by a digest of its content.
    """
    brake_digests: dict[int, str] = {}
    # A mesh file is read once, even if many cases name it.
    file_digest = cache(digest_of_mesh_file)
    for case in cases:
        # Many cases share one brake object, so that its digest is computed once.
        if id(case.brake) not in brake_digests:
            brake_digests[id(case.brake)] = digest_of_brake_data(case.brake)
        changes = dict(case.changes)
        for key, value in changes.items():
            if is_key_of_mesh_file(key) and isinstance(value, str | Path):
                changes[key] = file_digest(Path(value))
        data = {
            "brake": brake_digests[id(case.brake)],
            "changes": changes,
            "model": case.model,
            "options": dict(case.options),
        }
        if case.certify is not None:
            data["certify"] = case.certify.text_that_identifies_cases_in_journal()
        yield data


def digest_of_brake_data(brake: Brake) -> str:
    """A digest (16 hexadecimal digits) of all data of a brake.

    It depends on the content of the brake's mesh files, not on their names.
    """
    # Equal brakes give equal JSON text, since its keys have the order of the fields in the classes.
    data = brake.model_dump(mode="json")
    for shoe in data["shoes"]:
        if shoe.get("mesh") is not None:
            shoe["mesh"] = digest_of_mesh_file(Path(shoe["mesh"]))
    return hashlib.sha256(json.dumps(data).encode()).hexdigest()[:16]


def is_key_of_mesh_file(key: str) -> bool:
    """Whether the values of a key of the brake file are paths of mesh files."""
    return key.rpartition(".")[2] == "mesh"


def paths_of_mesh_files(brake: Brake, changes: Mapping[str, Any]) -> list[Path]:
    """The paths of all mesh files that a brake or its changed values name."""
    named = [shoe.mesh for shoe in brake.shoes]
    named += [value for key, value in changes.items() if is_key_of_mesh_file(key)]
    return [Path(path) for path in named if isinstance(path, str | Path)]


def key_of_cases_with_equal_shoe_stiffness(case: SweepCase) -> str:
    """A text that is equal only for cases whose shoes have the same stiffness.

    It holds the options of the model, and all changed values except the values of the keys in
    KEYS_WITHOUT_EFFECT_ON_STIFFNESS.
    """
    changes_of_bodies = {}
    for key, value in case.changes.items():
        # Split a key into its words: "shoe[0].actuation.force" has shoe, 0, actuation and force.
        words = set(key.replace("[", ".").split("."))
        if not words & set(KEYS_WITHOUT_EFFECT_ON_STIFFNESS):
            changes_of_bodies[key] = value
    return json.dumps([changes_of_bodies, dict(case.options)], sort_keys=True, default=str)


def _solve_cases_in_this_process(
    cases: Sequence[SweepCase], missing: Sequence[int]
) -> Iterator[tuple[int, ResultOfAttemptAtCase]]:
    """Solve the cases at the positions `missing` in this process; yields position and answer."""
    bodies = CacheOfCondensedBodies()
    for i in missing:
        yield i, solve_case_without_raising(cases[i], bodies)


class _ChunkAnswer(NamedTuple):
    """The answer of a worker to a chunk, the cases that it got in one message.

    Attributes
    ----------
    answers : answer for each case of the chunk
    seconds : time that the chunk took [s]
    digest_of_worker_code : digest of the worker's source of drumlin and of the versions of its
        libraries
    """

    answers: list[ResultOfAttemptAtCase]
    seconds: float
    digest_of_worker_code: str


_condensed_shoe_cache_of_each_worker_thread = threading.local()
"""The cache of condensed stiffnesses of shoes in a worker, one for each thread of the worker."""


def solve_chunk_of_cases(cases: Sequence[SweepCase]) -> _ChunkAnswer:
    """Solve the cases that a worker gets in one message; the worker runs this function."""
    if not hasattr(_condensed_shoe_cache_of_each_worker_thread, "cache"):
        _condensed_shoe_cache_of_each_worker_thread.cache = CacheOfCondensedBodies()
    start = time.perf_counter()
    answers = [
        solve_case_without_raising(case, _condensed_shoe_cache_of_each_worker_thread.cache)
        for case in cases
    ]
    return _ChunkAnswer(answers, time.perf_counter() - start, _digest_of_drumlin_and_libraries())


@cache
def _digest_of_drumlin_and_libraries() -> str:
    """A digest of the source of this process's drumlin and of the versions of its libraries."""
    return checksum_of_source_and_libraries()


def _solve_cases_by_workers(
    dispatch: "_ChunkDispatcher", say: ShowLineToUser
) -> Iterator[tuple[int, ResultOfAttemptAtCase]]:
    """Solve cases by workers; yields the position and answer of each case as the answer comes."""
    last_answer, told = time.time(), False
    try:
        while dispatch.has_unfinished_cases:
            dispatch.send_chunks_to_workers()
            finished = wait(
                dispatch.sent, timeout=SECONDS_BEFORE_WAITING_MESSAGE, return_when=FIRST_COMPLETED
            ).done
            if finished:
                last_answer, told = time.time(), False
            elif not told:
                say(message_on_waiting_for_workers(last_answer))
                told = True
            for future in finished:
                yield from dispatch.answers_of_finished_chunk(future)
    except BrokenExecutor as error:
        raise NoAnswer(
            f"sweep: the workers died ({error}); what has finished is kept, the same run goes on"
        ) from error
    finally:
        dispatch.cancel_unstarted_chunks()


class _ChunkDispatcher:
    """The distribution of cases to the workers of an executor.

    A worker gets several cases, a chunk, in one message. Chunks grow until each takes
    SECONDS_OF_WORK_PER_CHUNK_OF_CASES. Cases that are tried again are sent one at a time:
    if a case kills its worker, no other case is lost.

    Parameters
    ----------
    executor : executor whose workers solve the chunks
    workers : number of the executor's workers
    cases : all cases of the sweep
    missing : positions of the cases to solve
    alone : whether the cases are sent one at a time
    """

    def __init__(
        self,
        executor: Executor,
        workers: int,
        cases: Sequence[SweepCase],
        missing: Sequence[int],
        alone: bool,
    ) -> None:
        self.sent: dict[Future[_ChunkAnswer], list[int]] = {}
        self._executor, self._cases = executor, cases
        self._waiting = _WaitingCases(cases, missing)
        self._size = 1
        self._max_size = 1 if alone else MAX_CASES_PER_CHUNK
        # Each worker has at most two chunks: one that it solves, and one that waits. One more chunk
        # may wait for any worker.
        self._max_sent = 1 if alone else 2 * workers + 1

    @property
    def has_unfinished_cases(self) -> bool:
        """Whether cases wait for a worker or are being solved."""
        return self._waiting.has_waiting_cases or bool(self.sent)

    def send_chunks_to_workers(self) -> None:
        """Send chunks of cases to the workers until the largest allowed number is sent."""
        while self._waiting.has_waiting_cases and len(self.sent) < self._max_sent:
            positions = self._waiting.remove_and_return_case_positions(self._size)
            chunk = [self._cases[i] for i in positions]
            self.sent[self._executor.submit(solve_chunk_of_cases, chunk)] = positions

    def answers_of_finished_chunk(
        self, future: "Future[_ChunkAnswer]"
    ) -> Iterator[tuple[int, ResultOfAttemptAtCase]]:
        """Yield the position and answer of each case of a chunk that a worker has finished.

        If the worker died, the cases of its chunk count as failed, and are tried again.
        Raises BadInput if the worker runs another version of drumlin or its libraries.
        """
        positions = self.sent.pop(future)
        try:
            chunk = future.result()
            if chunk.digest_of_worker_code != _digest_of_drumlin_and_libraries():
                raise BadInput(DIFFERENT_DRUMLIN_MESSAGE)
            answers = chunk.answers
            # The next chunks get as many cases as are solved in SECONDS_OF_WORK_PER_CHUNK_OF_CASES.
            size = round(
                SECONDS_OF_WORK_PER_CHUNK_OF_CASES * len(positions) / max(chunk.seconds, 1e-6)
            )
            self._size = min(max(size, 1), self._max_size)
        except DrumlinError:
            raise
        except ImportError as error:
            raise BadInput(f"{DIFFERENT_DRUMLIN_MESSAGE} ({error})") from error
        except Exception as error:
            status = f"failed: its worker was lost ({type(error).__name__}: {error})"
            lost = ResultOfAttemptAtCase({"status": status}, is_kept_in_journal=False, again=True)
            answers = [lost] * len(positions)
        yield from zip(positions, answers, strict=True)

    def cancel_unstarted_chunks(self) -> None:
        """Cancel all chunks that no worker has begun to solve."""
        for future in self.sent:
            future.cancel()


class _WaitingCases:
    """The cases that still wait for a worker, in groups whose shoes have the same stiffness.

    In one message a worker gets a part of a large group, or several small groups.
    """

    def __init__(self, cases: Sequence[SweepCase], missing: Sequence[int]) -> None:
        groups = groupby(missing, lambda i: key_of_cases_with_equal_shoe_stiffness(cases[i]))
        # The list of groups is reversed: the next group is the last item, which is removed fast.
        self._groups = [list(group) for _, group in groups][::-1]

    @property
    def has_waiting_cases(self) -> bool:
        """Whether any case has not been sent to a worker yet."""
        return bool(self._groups)

    def remove_and_return_case_positions(self, size: int) -> list[int]:
        """Remove about `size` cases from the waiting cases and return their positions."""
        taken: list[int] = []
        while self._groups and len(taken) < size:
            group = self._groups.pop()
            room = max(size - len(taken), 1)
            # `room` is the number of cases that are still wanted. A group of up to twice this
            # number is taken as a whole, so that only one worker computes the stiffness of its
            # shoes. Of a larger group only a part is taken.
            if len(group) > 2 * room:
                self._groups.append(group[room:])
                group = group[:room]
            taken += group
        return taken
