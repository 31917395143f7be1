"""Bad input at scale: brake files and meshes broken in every way at hand, and what drumlin makes of
each.

Every input ends as an answer that is sound, or as one line that refuses it. A traceback, a warning,
a run beyond LONGEST seconds and a number for an input that `must_fail` are faults.
"""

import random
import re
import signal
import tempfile
import time
import traceback
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager, nullcontext
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.journal import Journal
from drumlin.brake.plane_brake import read_any
from drumlin.models import MODELS, applicable
from drumlin.response.balance import contact_resultant
from drumlin.response.response import Response
from drumlin_studies.broken_files import (
    Input,
    Sound,
    broken_structure,
    changed_values,
    huge_file,
    noisy_text,
)
from drumlin_studies.broken_meshes import (
    cut_mesh,
    lying_mesh,
    mislabelled_mesh,
    noisy_mesh,
    wrong_mesh,
)

LONGEST = (
    10.0  # s of processor time that an input may take: neighbours on the machine do not lengthen it
)
ELEMENTS = 8  # of the finite elements that try a brake file
CHUNK = 50  # inputs a process takes at a time
FAULTS = ("traceback", "hang", "wrong number")


class Verdict(NamedTuple):
    """What became of an input. `outcome`: answer, refused, no answer; or one of FAULTS."""

    kind: str
    outcome: str
    line: str
    seconds: float


# How often each is drawn; a mesh is read and solved in some 20 ms.
MAKERS: dict[Callable[[random.Random, Sound], Input], int] = {
    noisy_text: 6,
    changed_values: 8,
    broken_structure: 4,
    huge_file: 1,
    cut_mesh: 3,
    noisy_mesh: 5,
    mislabelled_mesh: 1,
    lying_mesh: 1,
    wrong_mesh: 6,
}


def make(rng: random.Random, sound: Sound) -> Input:
    """A broken input."""
    maker: Callable[[random.Random, Sound], Input]
    (maker,) = rng.choices(list(MAKERS), list(MAKERS.values()))
    return maker(rng, sound)


class _Late(BaseException):
    """An input has had its time; no OSError, as TimeoutError is, which a reader takes for a file's."""


def judge(given: Input) -> Verdict:
    """Read the brake, try every model that applies, and say what became of it."""
    start = time.process_time()
    try:
        with tempfile.TemporaryDirectory() as folder, _at_most(LONGEST), warnings.catch_warnings():
            warnings.simplefilter("error")
            for name, data in given.files.items():
                (Path(folder) / name).write_bytes(data)
            # The laws have no mesh: a broken one is the finite elements' affair alone.
            failing = (
                () if not given.must_fail else ("fem",) if len(given.files) > 1 else tuple(MODELS)
            )
            outcome, line = _try(Path(folder) / "brake.toml", failing)
            line = line.replace(folder + "/", "")
    except _Late:
        outcome, line = "hang", f"longer than {LONGEST:g} s"
    except BaseException as error:  # this is what is looked for
        place = traceback.extract_tb(error.__traceback__)[-1]
        outcome, line = (
            "traceback",
            f"{type(error).__name__}: {error} ({Path(place.filename).name}:{place.lineno})",
        )
    seconds = time.process_time() - start
    if seconds > LONGEST and outcome not in FAULTS:
        outcome, line = "hang", f"{seconds:.1f} s: {line}"
    return Verdict(given.kind, outcome, " ".join(line.split())[:300], seconds)


def _try(path: Path, failing: tuple[str, ...]) -> tuple[str, str]:
    """Outcome and line; no answer of the models `failing` is right."""
    try:
        brake = read_any(path)
    except BadInput as error:
        return (
            ("traceback", f"more than one line: {error}")
            if "\n" in str(error)
            else ("refused", str(error))
        )
    refusals, answers = [], 0
    for model in applicable(brake):
        try:
            coarse = model.name == "fem" and not all(shoe.mesh for shoe in brake.shoes)
            response = model.solve(brake, **({"elements": ELEMENTS} if coarse else {}))
        except (BadInput, NoAnswer) as error:
            if "\n" in str(error):
                return "traceback", f"more than one line: {error}"
            refusals.append((isinstance(error, NoAnswer), str(error)))
            continue
        fault = unsound(brake, response)
        if fault or model.name in failing:
            return "wrong number", f"{model.name}: {fault or 'an answer of an input that has none'}"
        answers += 1
    broken = [line for no_answer, line in refusals if not no_answer]
    if broken:
        return "refused", broken[0]
    if answers:
        return "answer", ""
    return "no answer", refusals[0][1] if refusals else "no model applies"


def unsound(brake: Any, response: Response) -> str:
    """Why an answer cannot be: not finite, out of balance, or its torque is not that of its
    pressure. Else empty.
    """
    numbers = [response.torque, response.balance.force, response.balance.moment]
    for shoe in response.shoes:
        numbers += [
            shoe.torque,
            shoe.normal_force,
            shoe.peak_pressure,
            *shoe.hinge_reaction,
            *shoe.pressure,
        ]
    if not np.isfinite(numbers).all():
        return "not finite"
    if response.torque < 0 or any((shoe.pressure < 0).any() for shoe in response.shoes):
        return "negative torque or pressure"
    if max(response.balance.force, response.balance.moment) > 1e-6:
        return f"out of balance by {response.balance}"
    if brake.surface.straight or response.model == "foundation":
        return ""
    for i, shoe in enumerate(response.shoes):
        by_pressure = abs(contact_resultant(brake, i, shoe).moment)
        # A mesh may lie off the drum by 1 % of its radius; its lining is as much longer, with as
        # much more lever.
        if abs(by_pressure - shoe.torque) > 0.03 * shoe.torque + 1e-300:
            return f"torque {shoe.torque:g} N m, of its pressure {by_pressure:g} N m"
    return ""


@contextmanager
def _at_most(seconds: float) -> Iterator[None]:
    """Raise _Late in the block after so much processor time."""

    def late(*_: object) -> None:
        raise _Late

    before = signal.signal(signal.SIGPROF, late)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def judge_many(sound: Sound, chunk: dict[str, Any]) -> dict[str, Any]:
    """Try `count` inputs from number `first` on, each drawn from a generator of its own."""
    numbers = range(chunk["first"], chunk["first"] + chunk["count"])
    return {"verdicts": [judge(make(random.Random(number), sound))._asdict() for number in numbers]}


def judge_all(
    count: int,
    sound: Sound,
    journal: Journal,
    say: Callable[[str], None] = lambda _: None,
    processes: int = 0,
) -> list[Verdict]:
    """Try `count` inputs, the same ones each time, in this process or in several; a chunk is a case
    of the journal.
    """
    chunks: list[dict[str, Any]] = [
        {"of": "bad input", "first": first, "count": min(CHUNK, count - first)}
        for first in range(0, count, CHUNK)
    ]
    left = [chunk for chunk in chunks if chunk not in journal]
    with (
        ProcessPoolExecutor(processes, mp_context=get_context("spawn"))
        if processes
        else nullcontext() as pool
    ):
        try_chunk = partial(judge_many, sound)
        found = pool.map(try_chunk, left) if pool else map(try_chunk, left)
        for chunk, verdicts in zip(left, found, strict=True):
            journal.add(chunk, verdicts)
            say(f"bad input: {chunk['first'] + chunk['count']} of {count}")
    return [Verdict(**verdict) for chunk in chunks for verdict in journal[chunk]["verdicts"]]


def count_kinds(verdicts: list[Verdict]) -> list[dict[str, Any]]:
    """One row a kind of input: how many there were and what became of them."""
    table: list[dict[str, Any]] = []
    for kind in sorted({verdict.kind for verdict in verdicts}):
        own = [verdict for verdict in verdicts if verdict.kind == kind]
        table.append(
            {
                "kind": kind,
                "inputs": len(own),
                **{
                    name: sum(v.outcome == name for v in own)
                    for name in ("answer", "refused", "no answer")
                },
                "faults": sum(v.outcome in FAULTS for v in own),
                "longest": max(v.seconds for v in own),
            }
        )
    total = {"kind": "all", **{key: sum(row[key] for row in table) for key in COUNTS}}
    return [*table, total | {"longest": max(row["longest"] for row in table)}]


COUNTS = ("inputs", "answer", "refused", "no answer", "faults")


def refusal_lines(verdicts: list[Verdict], count: int = 40) -> str:
    """The refusals that come most often, one of each form (numbers and quoted texts apart), most
    frequent first.
    """
    forms: dict[str, list[str]] = {}
    for verdict in verdicts:
        if verdict.outcome in {"refused", "no answer"}:
            form = re.sub(
                r"'[^']*'|[-+]?\d[\d.e+-]*", "…", verdict.line.removeprefix("brake.toml: ")
            )
            forms.setdefault(form, []).append(verdict.line.removeprefix("brake.toml: "))
    most = sorted(forms.values(), key=len, reverse=True)[:count]
    return "\n".join(f"{len(lines):5d}  {min(lines, key=len)[:160]}" for lines in most)
