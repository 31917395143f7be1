"""Many cases of a brake, solved in this process or by workers, each kept in a journal.

The row of a case depends on the case alone. It depends neither on the worker that solved the case
nor on the cases that the worker solved before. A sweep that was stopped and goes on therefore ends
with the same rows as a sweep that was never stopped.
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

from drumlin.base.errors import BadInput, DrumlinError, NoAnswer
from drumlin.base.journal import Journal, key_of, source_stamp
from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.fem.mesh.content import digest_of_mesh_file
from drumlin.fem.preparation.cache import Cache
from drumlin.models import pick
from drumlin.response.merit import brake_factor
from drumlin.response.response import Response, ShoeResponse
from drumlin.sweeps.workers import SayLine, waiting_line

Row = dict[str, Any]
"""The numbers of a case by name, or its failure under "status"; see `response_row`."""

QUIET_SECONDS = 20.0
"""Seconds without an answer after which a line tells that the sweep waits for workers. A judgement:
most cases take far less."""

CHUNK_SECONDS = 0.1
"""Seconds of work that a worker gets at a time. Longer chunks lose more work when the sweep is
killed; shorter ones cost more messages between the processes."""

MAX_CASES_PER_CHUNK = 64
"""Largest number of cases in a chunk, however fast the cases are solved."""

FURTHER_ATTEMPTS = 2
"""How often a case that failed for a passing reason (no memory, a dead worker) is tried again."""

OTHER_DRUMLIN = (
    "executor: its workers run another drumlin, or other libraries, than this one; "
    "install the same there"
)

LOAD_KEYS = (
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
"""Keys of a brake file that leave the stiffness of the bodies as it is. Cases that differ in these
keys alone are solved one after the other and share their bodies."""


class SweepCase(NamedTuple):
    """A brake with some of its keys changed, and the model that solves it.

    Attributes
    ----------
    brake : the base brake
    changes : new values by key, as `vary` takes them
    model : name of the model
    options : options of the model
    """

    brake: Brake
    changes: Mapping[str, Any]
    model: str = "fem"
    options: Mapping[str, Any] = {}


class CaseAnswer(NamedTuple):
    """The row of a case after one attempt at it.

    Attributes
    ----------
    row : numbers of the case, or why it has none
    lasting : whether the row belongs to the case, so that the journal keeps it
    again : whether a further attempt may change a row that is not lasting
    """

    row: Row
    lasting: bool = True
    again: bool = False


def solve_case(case: SweepCase, cache: Cache | None = None) -> tuple[Brake, Response]:
    """Solve a case: its brake, with the changes, and the response.

    The models "fem" and "solid" take condensed bodies from the cache and put theirs into it. Raises
    BadInput and NoAnswer as the model does.
    """
    # A case without changes needs no second validation of its brake.
    brake = vary(case.brake, case.changes) if case.changes else case.brake
    options = dict(case.options)
    if case.model in {"fem", "solid"}:
        options["cache"] = cache
    return brake, pick(case.model, brake).solve(brake, **options)


def case_row(case: SweepCase, cache: Cache | None = None) -> Row:
    """The numbers of a case by name (see `response_row`), or its failure. Never raises."""
    return attempt_case(case, cache).row


def attempt_case(case: SweepCase, cache: Cache | None = None) -> CaseAnswer:
    """Solve a case and tell whether its row may be kept. Never raises.

    Answers are lasting, and so are refusals of the input or the physics. Failures for want of
    memory, files or workers may pass. Faults of drumlin are neither lasting nor tried again.
    """
    try:
        return CaseAnswer(response_row(*solve_case(case, cache)))
    # A fault of one case must not cost the others. The row of the case tells the fault.
    except Exception as error:
        return _failed_answer(case, error)


def _failed_answer(case: SweepCase, error: Exception) -> CaseAnswer:
    """The answer to a case that an error ended."""
    known = isinstance(error, DrumlinError)
    text = str(error) if known else f"unexpected {type(error).__name__}: {error}"
    passing = _is_passing_failure(error)
    # A mesh file that cannot be read has the digest "none". The file may be back next time.
    readable = "none" not in map(digest_of_mesh_file, mesh_files(case.brake, case.changes))
    row = {"status": f"failed: {' '.join(text.split())}"}
    return CaseAnswer(row, lasting=known and not passing and readable, again=passing)


def _is_passing_failure(error: BaseException | None) -> bool:
    """Whether memory or the system, not the case, caused an error."""
    # A model may wrap the system's error in a refusal of its own, which names its cause.
    while error is not None:
        if isinstance(error, MemoryError | OSError):
            return True
        error = error.__cause__ or error.__context__
    return False


def response_row(brake: Brake, response: Response) -> Row:
    """The numbers of a response by name, in SI; those of shoe NAME as "NAME.torque" and so on.

    Of the brake: "torque" [N m], on a plane "braking_force" [N]; "brake_factor" T/(F R) with the
    mean force F of the actuation, on a plane braking force / F; "peak_pressure" [Pa], the largest
    of all shoes; "balance", the larger one of the relative imbalances of forces and of moments. A
    response that estimates its errors adds the relative errors "error_pressure", "error_torque",
    "error_peak" and "error_reaction" (see `Response.error`). One that estimates the error of plane
    stress itself adds "plane_stress_error_torque", "..._pressure" and "..._reaction".

    Of each shoe: torque, peak_pressure, shoe_factor T/(F R) and hinge_reaction [N]; contact_start
    and contact_end, the ends of the contact [rad; on a plane m]; contact_arcs, the number of
    separate arcs in contact.
    """
    row: Row = {
        "status": "solved" if response.converged else "failed: not converged",
        brake.surface.key: response.effect,
        "brake_factor": brake_factor(brake, response),
        "peak_pressure": max(shoe.peak_pressure for shoe in response.shoes),
        "balance": max(response.balance.force, response.balance.moment),
    }
    for name, value in (response.error or {}).items():
        row[f"error_{name}"] = value
    if response.plane_stress_error is not None:
        for name, value in response.plane_stress_error.brake.items():
            row[f"plane_stress_error_{name}"] = value
    for i, shoe in enumerate(response.shoes):
        numbers = _shoe_row(brake, i, response.effects[i], shoe)
        row |= {f"{shoe.name}.{name}": value for name, value in numbers.items()}
    return {name: _as_plain_value(value) for name, value in row.items()}


def _shoe_row(brake: Brake, number: int, effect: float, shoe: ShoeResponse) -> Row:
    """The numbers of one shoe by name.

    Parameters
    ----------
    brake : the brake
    number : position of the shoe in the brake
    effect : torque of the shoe [N m], on a plane its braking force [N]
    shoe : response of the shoe
    """
    load = abs(brake.shoes[number].actuation.force)
    arcs = shoe.contact_arcs
    return {
        brake.surface.key: effect,
        "peak_pressure": shoe.peak_pressure,
        "shoe_factor": effect / (load * brake.scale_factor) if load else None,
        "hinge_reaction": float(np.linalg.norm(shoe.hinge_reaction)),
        "contact_start": arcs[0][0] if arcs else None,
        "contact_end": arcs[-1][1] if arcs else None,
        "contact_arcs": len(arcs),
    }


def _as_plain_value(value: Any) -> Any:
    """A value of a row as plain Python: numbers of numpy as floats."""
    return value if value is None or isinstance(value, str | int) else float(value)


def solve_cases(
    cases: Sequence[SweepCase],
    *,
    executor: Executor | None = None,
    workers: int = 1,
    journal: Journal | None = None,
    done: Callable[[int, int], None] = lambda finished, of: None,
    say: SayLine = lambda words: None,
) -> list[Row]:
    """Solve cases; returns their rows in the order of the cases.

    A case that fails for a passing reason (no memory, a dead worker) is tried twice more, alone. If
    it still fails, its row tells why, and the journal does not keep the row.

    Parameters
    ----------
    cases : the cases
    executor : who solves the cases, in chunks; None: this process
    workers : number of the executor's workers, each of which gets a few chunks at a time
    journal : where each row is kept as it comes; cases that are in it are not solved again
    done : told how many cases have finished, and of how many
    say : told in a line when the sweep waits for workers

    Raises
    ------
    NoAnswer
        where no workers are left; what has finished is in the journal
    BadInput
        where the workers run another drumlin
    """
    journal = Journal() if journal is None else journal
    keys = list(journal_keys(cases))
    missing = _missing_cases(cases, keys, journal)
    finished = len(cases) - len(missing)
    done(finished, len(cases))
    # Rows that the journal does not keep, by the key of their case.
    passing: dict[str, Row] = {}
    # Only cases that failed for a passing reason are left for the second and third round.
    for further in reversed(range(FURTHER_ATTEMPTS + 1)):
        again = []
        if executor is None:
            answers = _solve_in_process(cases, missing)
        else:
            alone = further < FURTHER_ATTEMPTS
            answers = _solve_by_workers(_Dispatch(executor, workers, cases, missing, alone), say)
        for i, answer in answers:
            if answer.lasting:
                journal.add(keys[i], answer.row)
                passing.pop(key_of(keys[i]), None)
            else:
                passing[key_of(keys[i])] = answer.row
            if answer.again and further:
                again.append(i)
            else:
                finished += 1
                done(finished, len(cases))
        missing = again
    return [passing.get(key_of(key)) or journal[key] for key in keys]


def _missing_cases(
    cases: Sequence[SweepCase], keys: Sequence[dict[str, Any]], journal: Journal
) -> list[int]:
    """Positions of the cases that the journal has not, equal cases once, sorted by their bodies."""
    unsolved = [i for i, key in enumerate(keys) if key not in journal]
    distinct = {json.dumps(keys[i]): i for i in unsolved}
    return sorted(distinct.values(), key=lambda i: (cases[i].model, shared_body_key(cases[i]), i))


def journal_keys(cases: Iterable[SweepCase]) -> Iterator[dict[str, Any]]:
    """The journal key of each case: a digest of its brake, its changes, model and options.

    Mesh files among the changes stand by a digest of their content.
    """
    brake_digests: dict[int, str] = {}
    # Each mesh file is read once, however many cases name it.
    file_digest = cache(digest_of_mesh_file)
    for case in cases:
        # Thousands of cases share one brake object: it is digested once.
        if id(case.brake) not in brake_digests:
            brake_digests[id(case.brake)] = brake_digest(case.brake)
        changes = dict(case.changes)
        for key, value in changes.items():
            if is_mesh_key(key) and isinstance(value, str | Path):
                changes[key] = file_digest(Path(value))
        yield {
            "brake": brake_digests[id(case.brake)],
            "changes": changes,
            "model": case.model,
            "options": dict(case.options),
        }


def brake_digest(brake: Brake) -> str:
    """A digest of all data of a brake; mesh files count by their content, not by their names."""
    # Equal brakes have equal JSON, since the keys stand in the order of the classes.
    data = brake.model_dump(mode="json")
    for shoe in data["shoes"]:
        if shoe.get("mesh") is not None:
            shoe["mesh"] = digest_of_mesh_file(Path(shoe["mesh"]))
    return hashlib.sha256(json.dumps(data).encode()).hexdigest()[:16]


def is_mesh_key(key: str) -> bool:
    """Whether a key, written as for `vary`, takes mesh files."""
    return key.rpartition(".")[2] == "mesh"


def mesh_files(brake: Brake, changes: Mapping[str, Any]) -> list[Path]:
    """The mesh files of a brake and those among its changes."""
    named = [shoe.mesh for shoe in brake.shoes]
    named += [value for key, value in changes.items() if is_mesh_key(key)]
    return [Path(path) for path in named if isinstance(path, str | Path)]


def shared_body_key(case: SweepCase) -> str:
    """A text that is equal for cases with the same bodies.

    It holds the model's options and all changes but those of LOAD_KEYS.
    """
    changes_of_bodies = {}
    for key, value in case.changes.items():
        # "shoe[0].actuation.force" has the words shoe, 0, actuation and force.
        words = set(key.replace("[", ".").split("."))
        if not words & set(LOAD_KEYS):
            changes_of_bodies[key] = value
    return json.dumps([changes_of_bodies, dict(case.options)], sort_keys=True, default=str)


def _solve_in_process(
    cases: Sequence[SweepCase], missing: Sequence[int]
) -> Iterator[tuple[int, CaseAnswer]]:
    """Positions of the missing cases, each with its answer, which this process finds."""
    bodies = Cache()
    for i in missing:
        yield i, attempt_case(cases[i], bodies)


class _ChunkAnswer(NamedTuple):
    """What a worker returns: the answers, the seconds they took, and the stamp of its drumlin."""

    answers: list[CaseAnswer]
    seconds: float
    stamp: str


_worker_bodies = threading.local()
"""The condensed bodies that a worker keeps. A worker with threads keeps some for each thread."""


def solve_chunk(cases: Sequence[SweepCase]) -> _ChunkAnswer:
    """Solve some cases in a worker."""
    if not hasattr(_worker_bodies, "cache"):
        _worker_bodies.cache = Cache()
    start = time.perf_counter()
    answers = [attempt_case(case, _worker_bodies.cache) for case in cases]
    return _ChunkAnswer(answers, time.perf_counter() - start, _drumlin_stamp())


@cache
def _drumlin_stamp() -> str:
    """The stamp of this process's drumlin and libraries."""
    return source_stamp()


def _solve_by_workers(dispatch: "_Dispatch", say: SayLine) -> Iterator[tuple[int, CaseAnswer]]:
    """Positions of cases with their answers, as the answers come from an executor."""
    last_answer, told = time.time(), False
    try:
        while dispatch.has_open_work:
            dispatch.send_chunks()
            finished = wait(dispatch.sent, timeout=QUIET_SECONDS, return_when=FIRST_COMPLETED).done
            if finished:
                last_answer, told = time.time(), False
            elif not told:
                say(waiting_line(last_answer))
                told = True
            for future in finished:
                yield from dispatch.collect_answers(future)
    except BrokenExecutor as error:
        raise NoAnswer(
            f"sweep: the workers died ({error}); what has finished is kept, the same run goes on"
        ) from error
    finally:
        dispatch.cancel_chunks()


class _Dispatch:
    """Chunks of cases on their way to the workers of an executor and back.

    The chunks grow until each takes CHUNK_SECONDS. Cases that are tried again go alone, one at a
    time, so that a case that kills its worker takes no other case with it.

    Parameters
    ----------
    executor : who solves the chunks
    workers : number of its workers
    cases : all cases
    missing : positions of the cases to solve
    alone : whether each case goes alone
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
        self._waiting = _Chunks(cases, missing)
        self._size = 1
        self._max_size = 1 if alone else MAX_CASES_PER_CHUNK
        # Each worker has one chunk at work and one in its queue.
        self._max_sent = 1 if alone else 2 * workers + 1

    @property
    def has_open_work(self) -> bool:
        """Whether cases wait or are with a worker."""
        return self._waiting.has_cases or bool(self.sent)

    def send_chunks(self) -> None:
        """Send chunks until the workers have enough."""
        while self._waiting.has_cases and len(self.sent) < self._max_sent:
            positions = self._waiting.take_cases(self._size)
            chunk = [self._cases[i] for i in positions]
            self.sent[self._executor.submit(solve_chunk, chunk)] = positions

    def collect_answers(self, future: "Future[_ChunkAnswer]") -> Iterator[tuple[int, CaseAnswer]]:
        """The answers of a chunk that has come back. Raises BadInput for another drumlin.

        The cases of a worker that died fail for a passing reason.
        """
        positions = self.sent.pop(future)
        try:
            chunk = future.result()
            if chunk.stamp != _drumlin_stamp():
                raise BadInput(OTHER_DRUMLIN)
            answers = chunk.answers
            size = round(CHUNK_SECONDS * len(positions) / max(chunk.seconds, 1e-6))
            self._size = min(max(size, 1), self._max_size)
        except DrumlinError:
            raise
        except ImportError as error:
            raise BadInput(f"{OTHER_DRUMLIN} ({error})") from error
        except Exception as error:
            status = f"failed: its worker was lost ({type(error).__name__}: {error})"
            lost = CaseAnswer({"status": status}, lasting=False, again=True)
            answers = [lost] * len(positions)
        yield from zip(positions, answers, strict=True)

    def cancel_chunks(self) -> None:
        """Take back all chunks that no worker has begun."""
        for future in self.sent:
            future.cancel()


class _Chunks:
    """Cases grouped by the bodies they share.

    A chunk is a part of one large group, or some small groups as a whole.
    """

    def __init__(self, cases: Sequence[SweepCase], missing: Sequence[int]) -> None:
        groups = groupby(missing, lambda i: shared_body_key(cases[i]))
        # The first group stands last, where a list gives it up at once.
        self._groups = [list(group) for _, group in groups][::-1]

    @property
    def has_cases(self) -> bool:
        """Whether cases are left."""
        return bool(self._groups)

    def take_cases(self, size: int) -> list[int]:
        """Positions of about `size` cases, which leave the groups."""
        taken: list[int] = []
        while self._groups and len(taken) < size:
            group = self._groups.pop()
            room = max(size - len(taken), 1)
            # A group that hardly exceeds the room goes as a whole and keeps its bodies together.
            if len(group) > 2 * room:
                self._groups.append(group[room:])
                group = group[:room]
            taken += group
        return taken
