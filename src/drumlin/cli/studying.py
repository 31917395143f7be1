"""Commands that solve many brakes: a study writes a report, a sweep a table."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drumlin.base.errors import NoAnswer
from drumlin.cli.terminal import busy, note, progress, progress_if_long, tell

if TYPE_CHECKING:
    from drumlin.sweeps.cases import Row

MOST_REASONS = 3
"""Number of reasons for failed cases that are printed after a sweep, the most frequent first.

The table of the sweep gives the reason of each case.
"""


def study(
    name: Annotated[str, typer.Argument(metavar="NAME", help="a folder of studies/")],
    output: Annotated[Path | None, typer.Option(metavar="DIR", help="folder of the report")] = None,
    short: Annotated[
        bool, typer.Option("--short", help="the quick setting that the tests use")
    ] = False,
) -> None:
    """Run a study from studies/ and write its report into reports/NAME."""
    from drumlin.studies import run

    with busy(f"study {name}") as say:
        page = run(name, output, short=short, say=say)
    tell(f"report: {page}")


def sweep(
    sweep_file: Annotated[Path, typer.Argument(metavar="SWEEP.toml", help="the sweep file")],
    output: Annotated[
        Path | None, typer.Option(metavar="FILE.csv|FILE.parquet", help="the table of all cases")
    ] = None,
    jobs: Annotated[int | None, typer.Option(help="processes; default: one a core")] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="a Dask scheduler, in place of this machine's cores"),
    ] = None,
) -> None:
    """Solve a brake for many values of its keys, as one table with a row a case.

    After a stop the same command goes on with the missing cases.
    """
    from drumlin.base.files import check_outputs
    from drumlin.sweeps.file import read_sweep
    from drumlin.sweeps.run import solve_and_keep_rows, table_rows
    from drumlin.sweeps.table import check_table_file, write_table

    with progress_if_long(f"reading {sweep_file.name}") as judged:
        made = read_sweep(sweep_file, judged)
    table_file = output or Path(f"{sweep_file.stem}.csv")
    check_table_file(table_file)
    check_outputs(table_file)
    rows = solve_and_keep_rows(
        made, table_file, jobs=jobs, scheduler=scheduler, progress=progress, say=note
    )
    with busy(f"writing {table_file.name}"):
        write_table(table_rows(made, rows, sweep_file), table_file)
    _tell_outcome(rows, table_file)


def _tell_outcome(rows: "list[Row]", table_file: Path) -> None:
    """Print how many cases of a sweep have failed, the most frequent reasons, and the table's path.

    Raises NoAnswer where every case has failed.
    """
    from collections import Counter

    statuses = [row["status"] for row in rows]
    failed = Counter(status.removeprefix("failed: ") for status in statuses if status != "solved")
    tell(f"{len(rows)} cases: {len(rows) - failed.total()} solved, {failed.total()} failed")
    for reason, count in failed.most_common(MOST_REASONS):
        tell(f"  failed, {count}: {reason}")
    tell(f"table: {table_file}")
    if failed.total() == len(rows):
        raise NoAnswer("sweep: no case has an answer; the table says why")
