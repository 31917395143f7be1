"""How many cases a second a sweep solves, and whether a killed sweep can be continued.

Processes are compared with Dask workers, and cases that need new stiffness matrices with cases that
share those of other cases.
"""

import importlib.util
import json
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from studies.sweeps import figures

from drumlin.base.files import write_text
from drumlin.report import figures as drawing
from drumlin.report.page import write_html_page
from drumlin.sweeps.cases import CaseResultsByName, solve_all_cases_of_sweep
from drumlin.sweeps.file import Sweep, read_sweep_from_toml_file
from drumlin.sweeps.sample import positions_of_sample_cases
from drumlin.sweeps.table import table_lines_of_cases, write_table_file
from drumlin_studies.throughput import (
    ENVIRONMENT_THAT_KEEPS_FREED_MEMORY,
    KilledSweepRun,
    MeasuredTimeOfSweep,
    kill_and_finish_sweep,
    measure_time_of_sweep_by_dask_keeping_memory,
    measure_time_of_sweep_by_dask_workers,
    measure_time_of_sweep_by_processes,
    row_of_torque_distribution,
    rows_of_cases_per_second,
    rows_of_sweep_times_with_and_without_sample,
    time_and_error_rows_of_coarser_meshes,
)

HERE = Path(__file__).parent
SHARED, OWN = "loads: bodies shared", "tolerances: bodies of their own"
FILES = {SHARED: "loads.toml", OWN: "tolerances.toml"}
WORKERS = (1, 2)
FINE = 160
"""Elements along a lining of the meshes against which coarser meshes are judged."""


@dataclass(frozen=True)
class Result:
    """All results that the report of this study shows."""

    measured: dict[str, list[MeasuredTimeOfSweep]]
    same: bool
    sampled: list[CaseResultsByName]
    meshes: list[CaseResultsByName]
    kills: list[KilledSweepRun]
    killed_cases: int
    killed_same: bool
    sweeps: dict[str, Sweep]
    seconds: float


def study(*, short: bool = False, say: Callable[[str], None] = lambda _: None) -> Result:
    """Time two sweeps by all kinds of workers, judge coarser meshes, and kill and continue a sweep.

    short : trial run with few cases.
    """
    start = time.perf_counter()
    with_dask = not short and importlib.util.find_spec("distributed") is not None
    ways = (
        [
            measure_time_of_sweep_by_processes,
            measure_time_of_sweep_by_dask_workers,
            measure_time_of_sweep_by_dask_keeping_memory,
        ]
        if with_dask
        else [measure_time_of_sweep_by_processes]
    )
    counts = {SHARED: 60 if short else 1000, OWN: 4 if short else 150}
    sweeps = {name: read_sweep_from_toml_file(HERE / file) for name, file in FILES.items()}
    measured: dict[str, list[MeasuredTimeOfSweep]] = {name: [] for name in sweeps}
    for name, sweep in sweeps.items():
        for way in ways:
            for workers in WORKERS:
                say(f"{name}, {way.__name__}, {workers}")
                measured[name].append(way(sweep.cases[: counts[name]], workers))
    # Rows do not depend on who solved the cases.
    same = all(one.rows == those[0].rows for those in measured.values() for one in those)
    say(f"{OWN}, certified by sample")
    own = sweeps[OWN].cases[: counts[OWN]]
    sample = positions_of_sample_cases(own, 3 if short else "every 10th", seed=1)
    sampled = rows_of_sweep_times_with_and_without_sample(
        measured[OWN],
        [measure_time_of_sweep_by_processes(own, workers, sample) for workers in WORKERS],
    )
    say("coarser meshes")
    meshes = time_and_error_rows_of_coarser_meshes(
        sweeps[OWN].cases[: 1 if short else 12],
        (20, 40, None) if short else (20, 40, 80, None),
        FINE,
    )
    # A run that is killed several times must end with the same rows.
    cases = sweeps[SHARED].cases[: 100 if short else 1000]
    with tempfile.TemporaryDirectory() as folder:
        kills, rows = kill_and_finish_sweep(
            cases, Path(folder) / "journal", 1 if short else 5, seed=1, say=say
        )
    expected = solve_all_cases_of_sweep(cases) if short else measured[SHARED][0].rows
    return Result(
        measured,
        same,
        sampled,
        meshes,
        kills,
        len(cases),
        rows == expected,
        sweeps,
        time.perf_counter() - start,
    )


def report(result: Result, folder: Path) -> Path:
    """Write page, figures and tables, and return the path of the page."""
    drawing.save_figure(figures.draw_throughput(result.measured), folder / "throughput.svg")
    drawing.save_figure(figures.draw_torque_distributions(result.measured), folder / "torque.svg")
    for name, those in result.measured.items():
        cases = result.sweeps[name].cases[: those[0].cases]
        write_table_file(
            table_lines_of_cases(cases, those[0].rows), folder / f"{name.partition(':')[0]}.csv"
        )
    rows = [
        {"sweep": name} | row
        for name, those in result.measured.items()
        for row in rows_of_cases_per_second(those)
    ]
    write_text(
        folder / "results.json",
        json.dumps(
            {"throughput": rows, "sampled": result.sampled, "meshes": result.meshes}, indent=1
        )
        + "\n",
    )
    kills = []
    for i, kill in enumerate(result.kills):
        kills.append({"run": i + 1} | kill._asdict())
    files = {}
    for file in FILES.values():
        files[file] = (HERE / file).read_text()
    return write_html_page(
        HERE / "page.html",
        folder / "index.html",
        result=result,
        best=max(result.measured[SHARED], key=lambda one: (one.by == "processes", one.workers)),
        rates=rows,
        torques=[
            {"sweep": name} | row_of_torque_distribution(those[0].rows)
            for name, those in result.measured.items()
        ],
        kills=kills,
        with_dask=any(one.by != "processes" for those in result.measured.values() for one in those),
        keep=" and ".join(
            f"{name}={value}" for name, value in ENVIRONMENT_THAT_KEEPS_FREED_MEMORY.items()
        ),
        fine=FINE,
        files=files,
    )
