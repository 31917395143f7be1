"""What sweeps cost: cases a second by processes and by Dask workers, new bodies against shared ones, and kill -9."""

import importlib.util
import json
import signal
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure as Picture

from drumlin.comparison import Column
from drumlin.files import write_text
from drumlin.report import figures
from drumlin.report.page import Figure, Section, Source, Table, Text, write_page
from drumlin.sweeps.cases import Case, Row, run, table, write_table
from drumlin.sweeps.file import Sweep, read_sweep
from drumlin.verification.throughput import KEEP, Kill, Throughput, dask, dask_keeping, killed, processes

HERE = Path(__file__).parent
SHARED, OWN = "loads: bodies shared", "tolerances: bodies of their own"
WORKERS = (1, 2)
MEMORY = (
    "Dask starts its workers with MALLOC_TRIM_THRESHOLD_=65536: memory that they free returns to the system at once and is "
    "asked for again by the next matrix. Workers that keep memory were started with "
    + " and ".join(f"{name}={value}" for name, value in KEEP.items())
    + " in the environment."
)
FINE = 160  # elements along each lining that meshes are judged against


class Result(NamedTuple):
    """Everything that the report shows."""

    measured: dict[str, list[Throughput]]
    same: bool
    meshes: list[Row]
    kills: list[Kill]
    killed_same: bool
    sweeps: dict[str, Sweep]
    seconds: float


def study(*, short: bool = False, say: Callable[[str], None] = lambda _: None) -> Result:
    """Measure the throughput of both sweeps by all workers, judge coarser meshes, kill a run; `short`: few cases."""
    start = time.perf_counter()
    with_dask = not short and importlib.util.find_spec("distributed") is not None
    ways = [processes, dask, dask_keeping] if with_dask else [processes]
    counts = {SHARED: 60 if short else 1000, OWN: 4 if short else 150}
    sweeps: dict[str, Sweep] = {}
    measured: dict[str, list[Throughput]] = {}
    for name, file in ((SHARED, "loads.toml"), (OWN, "tolerances.toml")):
        sweep = read_sweep(HERE / file)
        sweeps[name] = sweep
        measured[name] = []
        for way in ways:
            for workers in WORKERS:
                say(f"{name}, {way.__name__}, {workers}")
                measured[name].append(way(sweep.cases[: counts[name]], workers))
    same = all(one.rows == those[0].rows for those in measured.values() for one in those)
    say("coarser meshes")
    meshes = coarser(sweeps[OWN].cases[: 1 if short else 12], (20, 40) if short else (20, 40, 80))
    cases = sweeps[SHARED].cases[: 100 if short else 1000]
    with tempfile.TemporaryDirectory() as folder:
        kills, rows = killed(cases, Path(folder) / "journal", 1 if short else 5, seed=1, say=say)
    expected = run(cases) if short else measured[SHARED][0].rows
    return Result(measured, same, meshes, kills, rows == expected, sweeps, time.perf_counter() - start)


def coarser(cases: Sequence[Case], elements: Sequence[int]) -> list[Row]:
    """Time a case and largest error of the torque on meshes of so many elements along each lining."""
    true = torques(run([case._replace(options={"elements": FINE}) for case in cases]))
    rows = []
    for n in elements:
        start = time.process_time()
        found = torques(run([case._replace(options={"elements": n}) for case in cases]))
        spent = time.process_time() - start
        error = float(np.abs(found / true - 1).max())
        rows.append({"elements": n, "nodes": 2 * n + 1, "seconds": spent / len(cases), "error": error})
    return rows


def torques(rows: Sequence[Row]) -> Any:
    """Torques of the rows that have one [N m]."""
    return np.array([row["torque"] for row in rows if row["status"] == "solved"])


THROUGHPUT = (
    Column("sweep", "sweep"),
    Column("by", "solved by"),
    Column("workers", "workers", form="d"),
    Column("cases", "cases", form="d"),
    Column("started", "until workers are there", "s", 1, ".2f"),
    Column("seconds", "solving", "s", 1, ".2f"),
    Column("rate", "throughput", "cases/s", 1, ".3g"),
    Column("gain", "against one worker", "", 1, ".2f"),
    Column("processor", "processor time, start and end included", "s", 1, ".3g"),
)
MESHES = (
    Column("elements", "elements along each lining", form="d"),
    Column("nodes", "contact nodes", form="d"),
    Column("seconds", "processor time a case, bodies of its own", "ms", 1e3, ".3g"),
    Column("error", f"largest error of the torque, against {FINE} elements", "", 1, ".1e"),
)
KILLS = (
    Column("run", "run", form="d"),
    Column("found", "rows that it found", form="d"),
    Column("left", "rows when it was killed", form="d"),
)
TORQUES = (
    Column("sweep", "sweep"),
    Column("cases", "cases", form="d"),
    Column("failed", "failed", form="d"),
    Column("mean", "mean torque", "N m", 1, ".4g"),
    Column("spread", "standard deviation", "%", 100, ".2f"),
    Column("low", "2.5 % are below", "N m", 1, ".4g"),
    Column("high", "2.5 % are above", "N m", 1, ".4g"),
)


def throughput_rows(result: Result) -> list[Row]:
    """The throughput of each sweep by each kind of worker."""
    rows = []
    for name, those in result.measured.items():
        for one in those:
            alone = next(other for other in those if other.by == one.by)
            row = {key: value for key, value in one._asdict().items() if key != "rows"}
            rows.append({"sweep": name} | row | {"rate": one.rate, "gain": one.rate / alone.rate})
    return rows


def torque_rows(result: Result) -> list[Row]:
    """What each sweep makes of the torque."""
    rows = []
    for name, those in result.measured.items():
        torque = torques(those[0].rows)
        low, high = np.percentile(torque, [2.5, 97.5])
        rows.append(
            {"sweep": name, "cases": those[0].cases, "failed": those[0].cases - len(torque), "mean": torque.mean(),
             "spread": torque.std(ddof=1) / torque.mean(), "low": low, "high": high}
        )  # fmt: skip
    return rows


def pictures(result: Result) -> tuple[Picture, Picture]:
    """Throughput as bars, and the distribution of the torque."""
    colors = {"processes": "#0b6e99", "Dask workers": "#d19a1b", "Dask workers that keep memory": "#2a9d5c"}
    with mpl.rc_context(figures.STYLE):
        bars = Picture(figsize=(9.6, 3.4), layout="constrained")
        for axes, (name, those) in zip(bars.subplots(1, 2), result.measured.items(), strict=True):
            for place, one in enumerate(those):
                axes.bar(place, one.rate, color=colors[one.by], width=0.62, label=one.by if one.workers == 1 else None)
                axes.annotate(
                    f"{one.rate:.3g}",
                    (place, one.rate),
                    ha="center",
                    va="bottom",
                    xytext=(0, 2),
                    textcoords="offset points",
                )
            axes.set_xticks(range(len(those)), [str(one.workers) for one in those])
            axes.set_xlabel("workers")
            axes.set_title(name)
            axes.set_ylabel("throughput [cases/s]")
            axes.set_ylim(0, 1.25 * max(one.rate for one in those))
            axes.grid(visible=False, axis="x")
        bars.axes[0].legend()
        spread = Picture(figsize=(9.6, 3.2), layout="constrained")
        panels = spread.subplots(1, 2, sharex=True)
        for axes, (name, those), color in zip(panels, result.measured.items(), ("#0b6e99", "#2a9d5c"), strict=True):
            torque = torques(those[0].rows)
            axes.hist(torque, bins="auto", color=color, alpha=0.75)
            for percent in (2.5, 50, 97.5):
                axes.axvline(np.percentile(torque, percent), color="#1d2733", lw=1, ls="-" if percent == 50 else "--")
            axes.set_title(f"{name.partition(':')[0]}, {len(torque)} cases")
            axes.set_xlabel("torque [N m]")
            axes.set_ylabel("cases")
    return bars, spread


def report(result: Result, folder: Path) -> Path:
    """Write page, figures, tables; returns the page."""
    bars, spread = pictures(result)
    for name, picture in (("throughput", bars), ("torque", spread)):
        figures.save(picture, folder / f"{name}.svg")
    for name, those in result.measured.items():
        first = those[0]
        cases = result.sweeps[name].cases[: first.cases]
        write_table(table(cases, first.rows), folder / f"{name.partition(':')[0]}.csv")
    rows = throughput_rows(result)
    write_text(folder / "results.json", json.dumps({"throughput": rows, "meshes": result.meshes}, indent=1) + "\n")
    best = max(result.measured[SHARED], key=lambda one: (one.by == "processes", one.workers))
    lead = (
        f"{best.cases} cases of the double-shoe brake with 161 contact nodes on each lining, friction, forces and "
        f"clearances by chance, took {best.seconds:.1f} s on {best.workers} cores. A sweep that was killed "
        f"{len(result.kills)} times by kill -9 ended with {'the very same' if result.killed_same else 'ANOTHER'} table."
    )
    page = folder / "index.html"
    write_page(page, "What sweeps cost", lead, sections(result, rows, folder))
    return page


def sections(result: Result, rows: list[Row], folder: Path) -> list[Section]:
    """The page."""
    kills = [{"run": i + 1} | kill._asdict() for i, kill in enumerate(result.kills)]
    return [
        Section(
            "Throughput",
            [
                Figure(folder / "throughput.svg", "Cases a second by processes of one machine and by workers of a Dask cluster on its loopback interface."),
                Text(
                    "Cases that differ in friction, rotation, forces, their lines of action and clearances share their condensed "
                    "bodies: each worker condenses them once and each further case costs its contact alone. A tolerance of "
                    "stiffness or geometry makes new bodies, here two a case, and these then are nearly all of the cost."
                ),
                Table(rows, THROUGHPUT, "One measurement each. With one process the sweep runs in drumlin's own."),
                *([Text(MEMORY)] if any(one.by != "processes" for those in result.measured.values() for one in those) else []),
                Text(f"All workers gave {'the very same' if result.same else 'DIFFERENT'} rows, to the last digit."),
                Table(result.meshes, MESHES, "Where every case needs bodies of its own, a coarser mesh pays."),
            ],
        ),
        Section(
            "Killed",
            [
                Text(
                    f"A run in a process of its own, killed by signal {int(signal.SIGKILL)} at random moments and started again. Each row "
                    "is in the journal beside the table as soon as its worker has answered; a line torn by the kill is dropped. "
                    f"The rows at the end are {'the very same as' if result.killed_same else 'NOT those'} of the undisturbed run."
                ),
                Table(kills, KILLS, f"{len(kills)} kills in {len(result.sweeps[SHARED].cases)} cases."),
            ],
        ),
        Section(
            "What the sweeps say",
            [
                Figure(folder / "torque.svg", "Torque of the brake; lines: median, 2.5 % and 97.5 %."),
                Table(torque_rows(result), TORQUES, "Every case: <sweep>.csv beside this page."),
                *(Source(file, (HERE / file).read_text()) for file in ("loads.toml", "tolerances.toml")),
            ],
        ),
    ]  # fmt: skip
