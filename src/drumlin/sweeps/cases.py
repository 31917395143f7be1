"""Sweeps: many cases, solved by whatever executor there is, each kept in a journal as it finishes.

A row depends on its case alone: not on who solved it, nor on what was solved before, so that a
sweep that was stopped and went on ends with the same rows as one that was not.
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
from drumlin.fem.mesh.content import content_digest
from drumlin.fem.preparation.cache import Cache
from drumlin.models import pick
from drumlin.response.merit import brake_factor
from drumlin.response.response import Response
from drumlin.sweeps.workers import Say, waiting_since

Row = dict[str, Any]

QUIET = 20.0  # s without an answer, then it is said that workers are waited for
CHUNK_SECONDS = 0.1  # of work sent to a worker at a time: what a kill can lose of it
MOST_IN_CHUNK = 64
OTHER = "executor: its workers run another drumlin, or other libraries, than this one; install the same there"
LOADS = (
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
"""Keys that leave the bodies as they are: cases that differ in others are solved one group after
the other.
"""


class Case(NamedTuple):
    """A brake with some keys changed (as `vary` takes them), the model that answers and its
    options.
    """

    brake: Brake
    changes: Mapping[str, Any]
    model: str = "fem"
    options: Mapping[str, Any] = {}


def respond(case: Case, cache: Cache | None = None) -> tuple[Brake, Response]:
    """The brake of a case and its response; elements and solids take bodies from the cache and put
    theirs there.

    Raises BadInput, NoAnswer.
    """
    brake = vary(case.brake, case.changes) if case.changes else case.brake
    options = dict(case.options)
    if case.model in {"fem", "solid"}:
        options["cache"] = cache
    return brake, pick(case.model, brake).solve(brake, **options)


class Answer(NamedTuple):
    """A row, whether it is the case's own (kept in a journal), and else whether a further attempt
    may change it.
    """

    row: Row
    lasting: bool = True
    again: bool = False


def solved(case: Case, cache: Cache | None = None) -> Row:
    """The row of a case: its numbers by name (see `row_of`), or why it has none. Never raises."""
    return attempt(case, cache).row


def attempt(case: Case, cache: Cache | None = None) -> Answer:
    """The answer to a case. Never raises.

    Answers and refusals of physics and input last; want of memory, files and workers passes; faults
    of drumlin neither.
    """
    try:
        return Answer(row_of(*respond(case, cache)))
    except (
        Exception
    ) as error:  # a fault of one case must not cost the others; its row says what it was
        said = (
            str(error)
            if isinstance(error, DrumlinError)
            else f"unexpected {type(error).__name__}: {error}"
        )
        passing, files = _passing(error), mesh_files(case.brake, case.changes)
        lasting = (
            isinstance(error, DrumlinError)
            and not passing
            and "none" not in map(content_digest, files)
        )
        return Answer({"status": f"failed: {' '.join(said.split())}"}, lasting, passing)


def _passing(error: BaseException | None) -> bool:
    """Whether memory or the system, not the case, made an error."""
    while error is not None:
        if isinstance(error, MemoryError | OSError):
            return True
        error = error.__cause__ or error.__context__
    return False


def row_of(brake: Brake, response: Response) -> Row:
    """What a row says of a response, in SI; of shoe NAME as "NAME.torque" and so on.

    "torque" [N m] of the whole brake (on a plane: "braking_force" [N]), "brake_factor" T/(F R) with
    the mean force F of its actuation (on a plane: braking force / F), "peak_pressure" [Pa] the
    largest of its shoes, "balance" the worse of forces and moments; where they are estimated, the
    relative errors "error_pressure", "error_torque", "error_peak" and "error_reaction" (see
    `Response.error`). Of each shoe: torque, peak_pressure, shoe_factor T/(F R), hinge_reaction [N],
    contact_start and contact_end [rad; on a plane m] from where to where it touches, contact_arcs
    how many arcs that is.
    """
    name = brake.surface.key
    row: Row = {
        "status": "solved" if response.converged else "failed: not converged",
        name: response.effect,
        "brake_factor": brake_factor(brake, response),
        "peak_pressure": max(shoe.peak_pressure for shoe in response.shoes),
        "balance": max(response.balance.force, response.balance.moment),
        **{f"error_{name}": value for name, value in (response.error or {}).items()},
    }
    for i, shoe in enumerate(response.shoes):
        own, load = response.effects[i], abs(brake.shoes[i].actuation.force)
        row |= {
            f"{shoe.name}.{key}": value
            for key, value in {
                name: own,
                "peak_pressure": shoe.peak_pressure,
                "shoe_factor": own / (load * brake.scale_factor) if load else None,
                "hinge_reaction": float(np.linalg.norm(shoe.hinge_reaction)),
                "contact_start": shoe.contact_arcs[0][0] if shoe.contact_arcs else None,
                "contact_end": shoe.contact_arcs[-1][1] if shoe.contact_arcs else None,
                "contact_arcs": len(shoe.contact_arcs),
            }.items()
        }
    return {
        key: value if value is None or isinstance(value, str | int) else float(value)
        for key, value in row.items()
    }


def run(
    cases: Sequence[Case],
    *,
    executor: Executor | None = None,
    workers: int = 1,
    journal: Journal | None = None,
    done: Callable[[int, int], None] = lambda finished, of: None,
    say: Say = lambda words: None,
) -> list[Row]:
    """The rows of the cases, in their order.

    executor: who solves, in chunks, at most a few for each of its `workers` at a time; None: this
    process. journal: where each row is kept as it comes; cases that it has are not solved again.
    done: told how many cases have finished. say: told in a line when workers are waited for. What
    fails for a passing reason (no memory, a dead worker) is tried twice more, alone; if it fails
    still, its row says why and is not kept.

    Raises NoAnswer where no workers are left (what has finished is in the journal), BadInput where
    they run another drumlin.
    """
    journal = Journal() if journal is None else journal
    keys = list(keys_of(cases))
    missing = list(
        {json.dumps(key): i for i, key in enumerate(keys) if key not in journal}.values()
    )
    missing.sort(key=lambda i: (cases[i].model, body_key(cases[i]), i))
    finished = len(cases) - len(missing)
    done(finished, len(cases))
    passing: dict[str, Row] = {}
    for further in (2, 1, 0):
        again = []
        found = (
            _in_process(cases, missing)
            if executor is None
            else _by(executor, workers, cases, missing, further < 2, say)
        )
        for i, answer in found:
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


def keys_of(cases: Iterable[Case]) -> Iterator[dict[str, Any]]:
    """What tells each case from others in a journal: its brake by a digest, its changes, model and
    options.
    """
    digests: dict[int, str] = {}
    content = cache(content_digest)
    for case in cases:
        if id(case.brake) not in digests:
            digests[id(case.brake)] = digest_of(case.brake)
        yield {
            "brake": digests[id(case.brake)],
            "changes": {
                key: content(Path(value))
                if names_mesh(key) and isinstance(value, str | Path)
                else value
                for key, value in case.changes.items()
            },
            "model": case.model,
            "options": dict(case.options),
        }


def digest_of(brake: Brake) -> str:
    """A digest of all that a brake is, of its mesh files what is in them, not their names."""
    data = brake.model_dump(mode="json")
    for shoe in data["shoes"]:
        if shoe.get("mesh") is not None:
            shoe["mesh"] = content_digest(Path(shoe["mesh"]))
    return hashlib.sha256(json.dumps(data).encode()).hexdigest()[:16]


def names_mesh(key: str) -> bool:
    """Whether a key, written as for `vary`, takes mesh files."""
    return key.rpartition(".")[2] == "mesh"


def mesh_files(brake: Brake, changes: Mapping[str, Any]) -> list[Path]:
    """The mesh files of a brake and of what is changed."""
    named = [shoe.mesh for shoe in brake.shoes]
    named += [value for key, value in changes.items() if names_mesh(key)]
    return [Path(path) for path in named if isinstance(path, str | Path)]


def body_key(case: Case) -> str:
    """Equal for cases that share their bodies: what is changed besides loads, friction, rotation
    and clearance.
    """
    others = {
        k: v
        for k, v in case.changes.items()
        if not set(k.replace("[", ".").split(".")) & set(LOADS)
    }
    return json.dumps([others, dict(case.options)], sort_keys=True, default=str)


def _in_process(cases: Sequence[Case], missing: Sequence[int]) -> Iterator[tuple[int, Answer]]:
    bodies = Cache()
    for i in missing:
        yield i, attempt(cases[i], bodies)


class _Chunk(NamedTuple):
    """What a worker answers: the answers, the seconds that they took, and its drumlin's source."""

    answers: list[Answer]
    seconds: float
    stamp: str


_own = (
    threading.local()
)  # the bodies that a worker keeps; a worker with threads keeps some for each


def solve_chunk(cases: Sequence[Case]) -> _Chunk:
    """Solve some cases in a worker."""
    if not hasattr(_own, "cache"):
        _own.cache = Cache()
    start = time.perf_counter()
    answers = [attempt(case, _own.cache) for case in cases]
    return _Chunk(answers, time.perf_counter() - start, _stamp())


@cache
def _stamp() -> str:
    return source_stamp()


def _by(
    executor: Executor,
    workers: int,
    cases: Sequence[Case],
    missing: Sequence[int],
    alone: bool,
    say: Say,
) -> Iterator[tuple[int, Answer]]:
    """Answers as they come from an executor; chunks grow until each takes CHUNK_SECONDS. `alone`:
    one case at a time.

    What a worker takes with it as it dies fails for a passing reason.
    """
    size, most, at_a_time = (1, 1, 1) if alone else (1, MOST_IN_CHUNK, 2 * workers + 1)
    waiting = _Chunks(cases, missing)
    sent: dict[Future[_Chunk], list[int]] = {}
    heard, said = time.time(), False
    try:
        while waiting.left or sent:
            while waiting.left and len(sent) < at_a_time:
                part = waiting.take(size)
                sent[executor.submit(solve_chunk, [cases[i] for i in part])] = part
            come = wait(sent, timeout=QUIET, return_when=FIRST_COMPLETED).done
            if not come and not said:
                say(waiting_since(heard))
            heard, said = (time.time(), False) if come else (heard, True)
            for future in come:
                part, answers = sent.pop(future), []
                try:
                    answer = future.result()
                    if answer.stamp != _stamp():
                        raise BadInput(OTHER)
                    answers = answer.answers
                    size = round(CHUNK_SECONDS * len(part) / max(answer.seconds, 1e-6))
                    size = min(max(size, 1), most)
                except DrumlinError:
                    raise
                except ImportError as error:
                    raise BadInput(f"{OTHER} ({error})") from error
                except Exception as error:
                    row = {
                        "status": f"failed: its worker was lost ({type(error).__name__}: {error})"
                    }
                    answers = [Answer(row, False, True)] * len(part)
                yield from zip(part, answers, strict=True)
    except BrokenExecutor as error:
        raise NoAnswer(
            f"sweep: the workers died ({error}); what has finished is kept, the same run goes on"
        ) from error
    finally:
        for future in sent:
            future.cancel()


class _Chunks:
    """Cases by the bodies that they share; a chunk takes a few of one group, or small groups whole."""

    def __init__(self, cases: Sequence[Case], missing: Sequence[int]) -> None:
        self._groups = [list(group) for _, group in groupby(missing, lambda i: body_key(cases[i]))][
            ::-1
        ]

    @property
    def left(self) -> bool:
        return bool(self._groups)

    def take(self, size: int) -> list[int]:
        """About `size` cases."""
        part: list[int] = []
        while self._groups and len(part) < size:
            group = self._groups.pop()
            room = max(size - len(part), 1)
            if len(group) > 2 * room:
                self._groups.append(group[room:])
                group = group[:room]
            part += group
        return part
