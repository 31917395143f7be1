"""Bad input at scale: brake files and meshes broken in every way at hand, and what drumlin makes of each.

Every input ends as an answer that is sound, or as one line that refuses it. A traceback, a warning, a run beyond
LONGEST seconds and a number for an input that `must_fail` are faults.
"""

import html
import math
import random
import re
import signal
import tempfile
import time
import tomllib
import traceback
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager, nullcontext
from functools import cache
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple

import meshio
import numpy as np

from drumlin.brake.plane_brake import FlatBrake, read_any
from drumlin.comparison import Column
from drumlin.errors import BadInput, NoAnswer
from drumlin.journal import Journal
from drumlin.models import MODELS, applicable
from drumlin.report.page import Section, Source, Table, Text
from drumlin.response.response import Response, contact_resultant

ROOT = Path(__file__).parents[2]
LONGEST = 10.0  # s an input may take
ELEMENTS = 8  # of the finite elements that try a brake file
UNITS = ("mm", "m", "deg", "rad", "N", "kN", "Pa", "GPa", "s", "", "furlong")
CHUNK = 50  # inputs a process takes at a time


class Input(NamedTuple):
    """Files by name; `brake.toml` is what drumlin reads. `must_fail`: no number may come of it."""

    kind: str
    files: dict[str, bytes]
    must_fail: bool


class Verdict(NamedTuple):
    """What became of an input. `outcome`: answer, refused, no answer; or a fault: traceback, hang, wrong number."""

    kind: str
    outcome: str
    line: str
    seconds: float


FAULTS = ("traceback", "hang", "wrong number")


# ---------------------------------------------------------------------------------------------------- brake files


@cache
def brake_files() -> tuple[bytes, ...]:
    """The texts of all brake files of the studies that stand for themselves."""
    files = sorted((ROOT / "studies").glob("*/*.toml"))
    return tuple(path.read_bytes() for path in files if b"[[shoe]]" in path.read_bytes())


def noisy_text(rng: random.Random) -> Input:
    """A brake file with bytes dropped, doubled, swapped or overwritten."""
    return Input("brake file: bytes", {"brake.toml": _noise(rng, rng.choice(brake_files()))}, False)


def changed_values(rng: random.Random) -> Input:
    """One to four values of a brake file scaled, negated, made infinite or given another unit."""
    data = tomllib.loads(rng.choice(brake_files()).decode())
    places = list(_leaves(data))
    for place in rng.sample(places, min(len(places), rng.randint(1, 4))):
        _put(data, place, _other_value(rng, _get(data, place)))
    return Input("brake file: values", {"brake.toml": _toml(data)}, False)


def broken_structure(rng: random.Random) -> Input:
    """A brake file with a key renamed or a value of another type: no brake any more."""
    data = tomllib.loads(rng.choice(brake_files()).decode())
    named = [place for place in _leaves(data) if isinstance(place[-1], str) and place[-1] not in {"title", "name"}]
    *parents, key = rng.choice(named)
    owner = _get(data, tuple(parents))
    if rng.random() < 0.5:
        owner[key + rng.choice(["_", "x", " "])] = owner.pop(key)
    else:
        owner[key] = rng.choice([{"a": 1}, [], [[1, 2], 3], True, "", "12", "3 mm mm", "nan mm", "NaN", "1e999 m"])
    return Input("brake file: structure", {"brake.toml": _toml(data)}, True)


def huge_file(rng: random.Random) -> Input:
    """A brake file that is deep, long or wide beyond sense."""
    text = rng.choice(brake_files()).decode()
    texts: list[Callable[[], str]] = [
        lambda: text + "\nx = " + "[" * 50_000,
        lambda: text + "\n# " + "x" * 2_000_000,
        lambda: "[a." + ".".join("b" for _ in range(20_000)) + "]",
        lambda: text.replace('force = "', 'force = "' + "9" * 5_000, 1),
        lambda: "\0" * 900_000,
        lambda: text.replace("[[shoe]]", "[[shoe]]\n" * 20_000, 1),
    ]
    return Input("brake file: huge", {"brake.toml": rng.choice(texts)().encode()}, True)


def _noise(rng: random.Random, text: bytes) -> bytes:
    data = bytearray(text)
    for _ in range(rng.choice([1, 1, 2, 5, 40])):
        at = rng.randrange(len(data) + 1)
        end = min(len(data), at + rng.choice([1, 1, 3, 20, 200]))
        what = rng.randrange(5)
        if what == 0:
            del data[at:end]
        elif what == 1:
            data[at:at] = data[at:end]
        elif what == 2:
            data[at:at] = bytes([rng.randrange(256)])
        elif what == 3 and at < len(data):
            data[at] = rng.choice(b'0123456789.-e"[]{}=\n ,nafi')
        else:
            data[at:end] = data[at:end][::-1]
        if not data:
            break
    return bytes(data)


def _other_value(rng: random.Random, value: Any) -> Any:
    if isinstance(value, str) and value[:1] in "0123456789-+." and " " in value:
        number, unit = value.split(" ", 1)
        factor = rng.choice(
            [0, -1, 1, 1e300, 1e-300, math.nan, math.inf, 10 ** rng.uniform(-9, 9), rng.uniform(0.3, 3)]
        )
        shift = rng.choice([0, 0, 0, rng.uniform(-100, 100)])
        return f"{float(number) * factor + shift!r} {unit if rng.random() < 0.9 else rng.choice(UNITS)}"
    if isinstance(value, bool | str):
        return rng.choice([value, value, "clockwise", "external", "beam", "", "ü"])
    return rng.choice([0, -1, value, rng.uniform(0, 5), 1e9, math.inf, math.nan, 10 ** rng.uniform(-12, 12)])


def _leaves(data: Any, place: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    if isinstance(data, dict):
        for key, value in data.items():
            yield from _leaves(value, (*place, key))
    elif isinstance(data, list):
        for i, value in enumerate(data):
            yield from _leaves(value, (*place, i))
    else:
        yield place


def _get(data: Any, place: tuple[Any, ...]) -> Any:
    for step in place:
        data = data[step]
    return data


def _put(data: Any, place: tuple[Any, ...], value: Any) -> None:
    _get(data, place[:-1])[place[-1]] = value


def _toml(data: Any) -> bytes:
    """Nested data as TOML: everything below the top as inline tables."""
    return "".join(f"{_quoted(key)} = {_inline(value)}\n" for key, value in data.items()).encode()


def _inline(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_quoted(key)} = {_inline(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_inline, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return _quoted(value) if isinstance(value, str) else repr(value)


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'


# --------------------------------------------------------------------------------------------------------- meshes


@cache
def mesh_files() -> dict[str, bytes]:
    """Small sound meshes of the double-shoe brake's right shoe, by suffix, and the brake file that names them."""
    from drumlin.brake.file import brake_from  # noqa: PLC0415
    from drumlin.fem.assembly import prepare  # noqa: PLC0415
    from drumlin.fem.mesh.file import FORMATS, write_mesh  # noqa: PLC0415

    data = tomllib.loads((ROOT / "studies/double_shoe/brake.toml").read_text())
    data["shoe"] = data["shoe"][:1]
    brake = brake_from(data, unit_required=True)
    mesh = prepare(brake, elements=12, kind="tri2").bodies[0].mesh
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder) / f"shoe{suffix}" for suffix in FORMATS]
        for path in paths:
            write_mesh(path, mesh, brake.shoes[0])
        return {path.suffix: path.read_bytes() for path in paths} | {"brake": _toml(data)}


def _meshed(kind: str, mesh: bytes, suffix: str, must_fail: bool) -> Input:
    data = tomllib.loads(mesh_files()["brake"].decode())
    data["shoe"][0]["mesh"] = f"shoe{suffix}"
    return Input(kind, {"brake.toml": _toml(data), f"shoe{suffix}": mesh}, must_fail)


def cut_mesh(rng: random.Random) -> Input:
    """A mesh file of which less than three quarters are left."""
    suffix = rng.choice([".msh", ".inp", ".vtu"])
    text = mesh_files()[suffix]
    return _meshed(f"mesh {suffix}: cut off", text[: rng.randrange(3 * len(text) // 4)], suffix, True)


def noisy_mesh(rng: random.Random) -> Input:
    """A mesh file with bytes dropped, doubled, swapped or overwritten."""
    suffix = rng.choice([".msh", ".inp", ".vtu"])
    return _meshed(f"mesh {suffix}: bytes", _noise(rng, mesh_files()[suffix]), suffix, False)


def mislabelled_mesh(rng: random.Random) -> Input:
    """A mesh under the suffix of another format, or something that is no mesh at all."""
    suffix, other = rng.sample([".msh", ".inp", ".vtu"], 2)
    text = rng.choice(
        [mesh_files()[other], rng.choice(brake_files()), b"", bytes(rng.randrange(256) for _ in range(99))]
    )
    return _meshed(f"mesh {suffix}: another format", text, suffix, True)


def lying_mesh(rng: random.Random) -> Input:
    """A mesh file whose counts promise more than there is, up to more than any memory holds."""
    text = mesh_files()[".msh"].decode()
    keyword = rng.choice(["$Nodes\n", "$Elements\n", "$PhysicalNames\n"])
    start = text.index(keyword) + len(keyword)
    count = rng.choice(["-1", "0", "1", "999999", "99999999999999", "1e9", "nan"])
    return _meshed(
        "mesh .msh: false counts", (text[:start] + count + text[text.index("\n", start) :]).encode(), ".msh", True
    )


def wrong_mesh(rng: random.Random) -> Input:
    """A well-formed mesh file of a shoe that cannot be: torn, folded, doubled, without its groups."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "shoe.vtu"
        path.write_bytes(mesh_files()[".vtu"])
        mesh = meshio.read(path)
        name, spoil = rng.choice(list(SPOILS.items()))
        points, cells = mesh.points.copy(), mesh.cells[0].data.copy()
        cell_data = {key: values[0].copy() for key, values in mesh.cell_data.items()}
        point_data = {key: values.copy() for key, values in mesh.point_data.items()}
        points, cells, cell_data, point_data = spoil(rng, points, cells, cell_data, point_data)
        meshio.Mesh(
            points,
            [(mesh.cells[0].type, cells)],
            cell_data={key: [values] for key, values in cell_data.items()},
            point_data=point_data,
        ).write(path, file_format="vtu")
        return _meshed(f"mesh: {name}", path.read_bytes(), ".vtu", True)


Spoiled = tuple[Any, Any, dict[str, Any], dict[str, Any]]


def _inverted(rng: random.Random, points: Any, cells: Any, at: Any, on: Any) -> Spoiled:
    i = rng.randrange(len(cells))
    cells[i, [0, 1]] = cells[i, [1, 0]]
    return points, cells, at, on


def _torn(rng: random.Random, points: Any, cells: Any, at: Any, on: Any) -> Spoiled:
    """A strip of elements is missing: two parts are left."""
    theta = np.arctan2(points[:, 1], points[:, 0])[cells[:, :3]]
    cut = rng.uniform(-0.6, 0.5)
    keep = (theta.max(axis=1) < cut) | (theta.min(axis=1) > cut)
    return points, cells[keep], {key: values[keep] for key, values in at.items()}, on


def _doubled_node(rng: random.Random, points: Any, cells: Any, at: Any, on: Any) -> Spoiled:
    """An element has a corner of its own where its neighbours have another."""
    i, k = rng.randrange(len(cells)), rng.randrange(3)
    points = np.vstack([points, points[cells[i, k]]])
    on = {key: np.append(values, values[cells[i, k]]) for key, values in on.items()}
    if np.count_nonzero(cells == cells[i, k]) == 1:  # a corner of one element only: nothing would be wrong
        return _inverted(rng, points, cells, at, on)
    cells[i, k] = len(points) - 1
    return points, cells, at, on


def _not_finite(rng: random.Random, points: Any, cells: Any, at: Any, on: Any) -> Spoiled:
    points[cells[rng.randrange(len(cells)), rng.randrange(3)], rng.randrange(2)] = rng.choice([math.nan, math.inf])
    return points, cells, at, on


def _folded(rng: random.Random, points: Any, cells: Any, at: Any, on: Any) -> Spoiled:
    """A corner moved far across its neighbours."""
    points[cells[rng.randrange(len(cells)), rng.randrange(3)], :2] += rng.choice([-1, 1]) * 0.3
    return points, cells, at, on


def _doubled_element(rng: random.Random, points: Any, cells: Any, at: Any, on: Any) -> Spoiled:
    i = rng.randrange(len(cells))
    return points, np.vstack([cells, cells[i : i + 1]]), {k: np.append(v, v[i]) for k, v in at.items()}, on


def _without_group(rng: random.Random, points: Any, cells: Any, at: Any, on: Any) -> Spoiled:
    data, name = rng.choice([(at, "lining"), (at, "shoe"), (on, "contact"), (on, "hinge"), (on, "actuation")])
    if rng.random() < 0.5:
        del data[name]
    else:
        data[name][:] = 0
    return points, cells, at, on


def _element_in_none(rng: random.Random, points: Any, cells: Any, at: Any, on: Any) -> Spoiled:
    i, value = rng.randrange(len(cells)), rng.randrange(2)
    for values in at.values():
        values[i] = value
    return points, cells, at, on


def _other_unit(rng: random.Random, points: Any, cells: Any, at: Any, on: Any) -> Spoiled:
    return points * rng.choice([1e3, 1e-3, 25.4]), cells, at, on


def _not_plane(rng: random.Random, points: Any, cells: Any, at: Any, on: Any) -> Spoiled:
    points[rng.randrange(len(points)), 2] = 0.01
    return points, cells, at, on


def _no_such_node(rng: random.Random, points: Any, cells: Any, at: Any, on: Any) -> Spoiled:
    cells[rng.randrange(len(cells)), rng.randrange(cells.shape[1])] = rng.choice([-1, len(points), 2**40])
    return points, cells, at, on


def _far_middle(rng: random.Random, points: Any, cells: Any, at: Any, on: Any) -> Spoiled:
    """The middle node of an edge far from it: the element folds over."""
    points[cells[rng.randrange(len(cells)), rng.randrange(3, 6)], :2] += 0.2
    return points, cells, at, on


SPOILS: dict[str, Callable[..., Spoiled]] = {
    "inverted element": _inverted,
    "disconnected parts": _torn,
    "doubled node": _doubled_node,
    "NaN or infinity": _not_finite,
    "folded": _folded,
    "doubled element": _doubled_element,
    "group missing": _without_group,
    "element in no group or in two": _element_in_none,
    "another unit": _other_unit,
    "not plane": _not_plane,
    "undefined node": _no_such_node,
    "middle node far off": _far_middle,
}

# How often each is drawn; a mesh is read and solved in some 20 ms.
MAKERS: dict[Callable[[random.Random], Input], int] = {
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


def make(rng: random.Random) -> Input:
    """A broken input."""
    maker: Callable[[random.Random], Input]
    (maker,) = rng.choices(list(MAKERS), list(MAKERS.values()))
    return maker(rng)


# -------------------------------------------------------------------------------------------------------- trying


def judge(given: Input) -> Verdict:
    """Read the brake, try every model that applies, and say what became of it."""
    start = time.perf_counter()
    try:
        with tempfile.TemporaryDirectory() as folder, _at_most(LONGEST), warnings.catch_warnings():
            warnings.simplefilter("error")
            for name, data in given.files.items():
                (Path(folder) / name).write_bytes(data)
            # The laws have no mesh: a broken one is the finite elements' affair alone.
            failing = () if not given.must_fail else ("fem",) if len(given.files) > 1 else tuple(MODELS)
            outcome, line = _try(Path(folder) / "brake.toml", failing)
            line = line.replace(folder + "/", "")
    except TimeoutError:
        outcome, line = "hang", f"longer than {LONGEST:g} s"
    except BaseException as error:  # this is what is looked for
        place = traceback.extract_tb(error.__traceback__)[-1]
        outcome, line = "traceback", f"{type(error).__name__}: {error} ({Path(place.filename).name}:{place.lineno})"
    seconds = time.perf_counter() - start
    if seconds > LONGEST and outcome not in FAULTS:
        outcome, line = "hang", f"{seconds:.1f} s: {line}"
    return Verdict(given.kind, outcome, " ".join(line.split())[:300], seconds)


def _try(path: Path, failing: tuple[str, ...]) -> tuple[str, str]:
    """Outcome and line; no answer of the models `failing` is right."""
    try:
        brake = read_any(path)
    except BadInput as error:
        return ("traceback", f"more than one line: {error}") if "\n" in str(error) else ("refused", str(error))
    refusals, answers = [], 0
    for model in applicable(brake):
        try:
            response = model.solve(brake, **({"elements": ELEMENTS} if model.name == "fem" else {}))
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
    """Why an answer cannot be: not finite, out of balance, or its torque is not that of its pressure. Else empty."""
    numbers = [response.torque, response.balance.force, response.balance.moment]
    for shoe in response.shoes:
        numbers += [shoe.torque, shoe.normal_force, shoe.peak_pressure, *shoe.hinge_reaction, *shoe.pressure]
    if not np.isfinite(numbers).all():
        return "not finite"
    if response.torque < 0 or any((shoe.pressure < 0).any() for shoe in response.shoes):
        return "negative torque or pressure"
    if max(response.balance.force, response.balance.moment) > 1e-6:
        return f"out of balance by {response.balance}"
    if isinstance(brake, FlatBrake) or response.model == "foundation":
        return ""
    for i, shoe in enumerate(response.shoes):
        by_pressure = abs(contact_resultant(brake, i, shoe).moment)
        # A mesh may lie off the drum by 1 % of its radius, and as much longer and with as much more lever is its lining.
        if abs(by_pressure - shoe.torque) > 0.03 * shoe.torque + 1e-300:
            return f"torque {shoe.torque:g} N m, of its pressure {by_pressure:g} N m"
    return ""


@contextmanager
def _at_most(seconds: float) -> Iterator[None]:
    """Raise TimeoutError in the block after so long."""

    def late(*_: object) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def judge_many(chunk: dict[str, Any]) -> dict[str, Any]:
    """Try `count` inputs from number `first` on, each drawn from a generator of its own."""
    numbers = range(chunk["first"], chunk["first"] + chunk["count"])
    return {"verdicts": [judge(make(random.Random(number)))._asdict() for number in numbers]}


def judge_all(
    count: int, journal: Journal, say: Callable[[str], None] = lambda _: None, processes: int = 0
) -> list[Verdict]:
    """Try `count` inputs, the same ones each time, in this process or in several; a chunk is a case of the journal."""
    chunks: list[dict[str, Any]] = [
        {"of": "bad input", "first": first, "count": min(CHUNK, count - first)} for first in range(0, count, CHUNK)
    ]
    left = [chunk for chunk in chunks if chunk not in journal]
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) if processes else nullcontext() as pool:
        found = pool.map(judge_many, left) if pool else map(judge_many, left)
        for chunk, verdicts in zip(left, found, strict=True):
            journal.add(chunk, verdicts)
            say(f"bad input: {chunk['first'] + chunk['count']} of {count}")
    return [Verdict(**verdict) for chunk in chunks for verdict in journal[chunk]["verdicts"]]


# -------------------------------------------------------------------------------------------------------- telling


def rows(verdicts: list[Verdict]) -> list[dict[str, Any]]:
    """One row a kind of input: how many there were and what became of them."""
    table: list[dict[str, Any]] = []
    for kind in sorted({verdict.kind for verdict in verdicts}):
        own = [verdict for verdict in verdicts if verdict.kind == kind]
        table.append(
            {
                "kind": kind,
                "inputs": len(own),
                **{name: sum(v.outcome == name for v in own) for name in ("answer", "refused", "no answer")},
                "faults": sum(v.outcome in FAULTS for v in own),
                "longest": max(v.seconds for v in own),
            }
        )
    total = {"kind": "all", **{key: sum(row[key] for row in table) for key in COUNTS}}
    return [*table, total | {"longest": max(row["longest"] for row in table)}]


COUNTS = ("inputs", "answer", "refused", "no answer", "faults")
COLUMNS = (
    Column("kind", "what is broken"),
    Column("inputs", "inputs", form="d"),
    Column("answer", "sound answer", form="d"),
    Column("refused", "refused", form="d"),
    Column("no answer", "no answer", form="d"),
    Column("faults", "faults", form="d"),
    Column("longest", "longest", "ms", 1e3, ".0f"),
)


def refusal_lines(verdicts: list[Verdict], count: int = 40) -> str:
    """The refusals that come most often, one of each form (numbers and quoted texts apart), most frequent first."""
    forms: dict[str, list[str]] = {}
    for verdict in verdicts:
        if verdict.outcome in {"refused", "no answer"}:
            form = re.sub(r"'[^']*'|[-+]?\d[\d.e+-]*", "…", verdict.line.removeprefix("brake.toml: "))
            forms.setdefault(form, []).append(verdict.line.removeprefix("brake.toml: "))
    most = sorted(forms.values(), key=len, reverse=True)[:count]
    return "\n".join(f"{len(lines):5d}  {min(lines, key=len)[:160]}" for lines in most)


def section(verdicts: list[Verdict]) -> Section:
    """What the page says of it."""
    table = rows(verdicts)
    faults = [verdict for verdict in verdicts if verdict.outcome in FAULTS]
    total = table[-1]
    found = (
        "None of them is a traceback, a warning, a run beyond the limit or a number that should not be."
        if not faults
        else f"<b>{len(faults)} of them are faults:</b> "
        + "; ".join(html.escape(f"{v.kind}: {v.line}") for v in faults[:10])
    )
    return Section(
        "Bad input",
        [
            Text(
                f"{total['inputs']} brake files and meshes, broken in every way at hand: bytes lost, doubled or swapped, "
                "values out of all proportion, keys renamed, files cut off or mislabelled, counts that lie, meshes that are "
                "torn, folded, doubled or without their groups. Every model that applies tries each. An answer counts as "
                "sound if it is finite, in balance, without a negative pressure, and has the torque of its own pressure; "
                f"an input may take {LONGEST:g} s. {found}"
            ),
            Table(
                table, COLUMNS, "What became of each kind of input. An answer is right where the change left a brake."
            ),
            Source("the refusals, most frequent first, one of each form", refusal_lines(verdicts)),
        ],
    )
