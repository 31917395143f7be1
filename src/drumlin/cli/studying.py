"""Commands that solve many brakes: studies and sweeps."""

from pathlib import Path
from typing import Annotated

import typer

from drumlin.base.errors import NoAnswer, Stopped
from drumlin.cli.terminal import busy, note, progress, progress_if_long, tell


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
    """Solve a brake with any of its keys varied: one table, a row a case. Stopped, it goes on with
    what is missing.
    """
    from collections import Counter

    from drumlin.base.files import check_outputs
    from drumlin.base.journal import Journal, source_stamp
    from drumlin.sweeps.cases import run
    from drumlin.sweeps.file import read_sweep
    from drumlin.sweeps.table import check_output, table, write_table
    from drumlin.sweeps.workers import executor

    with progress_if_long(f"reading {sweep_file.name}") as judged:
        made = read_sweep(sweep_file, judged)
    table_file = output or Path(f"{sweep_file.stem}.csv")
    check_output(table_file)
    check_outputs(table_file)
    with Journal(table_file.with_name(table_file.name + ".journal"), source_stamp()) as journal:
        kept = f"finished cases are kept in {journal.path}; the same command goes on"
        for line in journal.notes:
            note(line)
        try:
            with executor(jobs, scheduler, note) as (pool, workers), progress(made.title) as done:
                rows = run(
                    made.cases, executor=pool, workers=workers, journal=journal, done=done, say=note
                )
        except NoAnswer as error:
            raise NoAnswer(f"{error}; {len(journal)} {kept}") from error
        except (KeyboardInterrupt, Stopped) as stop:
            stop.add_note(f"{len(journal)} {kept}")
            raise
    with busy(f"writing {table_file.name}"):
        write_table(table(made.cases, rows, sweep_file.parent.resolve(), made.pressure), table_file)
    failed = Counter(
        row["status"].removeprefix("failed: ") for row in rows if row["status"] != "solved"
    )
    tell(f"{len(rows)} cases: {len(rows) - failed.total()} solved, {failed.total()} failed")
    for reason, count in failed.most_common(3):
        tell(f"  failed, {count}: {reason}")
    tell(f"table: {table_file}")
    if failed.total() == len(rows):
        raise NoAnswer("sweep: no case has an answer; the table says why")
