"""Commands that solve many brakes: `study` writes a report, and `sweep` writes a table."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drumlin.base.errors import NoAnswer
from drumlin.cli.terminal import (
    print_folded_line,
    print_names_beside_texts,
    print_note_to_standard_error,
    show_progress_bar,
    show_progress_bar_if_long,
    show_spinner_beside_words,
)

if TYPE_CHECKING:
    from drumlin.sweeps.cases import Row

MAX_PRINTED_REASONS = 3
"""Number of reasons for failed cases that are printed after a sweep, the most frequent first.

The table of the sweep gives the reason of each case.
"""


def study(
    name: Annotated[
        str | None,
        typer.Argument(metavar="[NAME]", help="a study; without one they are listed"),
    ] = None,
    output: Annotated[Path | None, typer.Option(metavar="DIR", help="folder of the report")] = None,
    short: Annotated[
        bool, typer.Option("--short", help="the quick setting that the tests use")
    ] = False,
) -> None:
    """List the studies, or run one of them and write its report into reports/NAME."""
    from drumlin.studies import first_lines_of_own_studies, run_study_and_write_report

    if name is None:
        print_names_beside_texts(first_lines_of_own_studies())
        return

    with show_spinner_beside_words(f"study {name}") as say:
        page = run_study_and_write_report(name, output, short=short, say=say)
    print_folded_line(f"report: {page}")


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
    from drumlin.base.files import check_output_files_are_writable
    from drumlin.sweeps.file import read_sweep_from_toml_file
    from drumlin.sweeps.run import rows_of_sweep_table, solve_sweep_with_journal
    from drumlin.sweeps.table import check_table_file_is_writable, write_table_file

    with show_progress_bar_if_long(f"reading {sweep_file.name}") as judged:
        made = read_sweep_from_toml_file(sweep_file, judged)
    table_file = output or Path(f"{sweep_file.stem}.csv")
    check_table_file_is_writable(table_file)
    check_output_files_are_writable(table_file)
    rows = solve_sweep_with_journal(
        made,
        table_file,
        jobs=jobs,
        scheduler=scheduler,
        progress=show_progress_bar,
        say=print_note_to_standard_error,
    )
    with show_spinner_beside_words(f"writing {table_file.name}"):
        write_table_file(rows_of_sweep_table(made, rows, sweep_file), table_file)
    _print_outcome_of_sweep(rows, table_file)


def _print_outcome_of_sweep(rows: "list[Row]", table_file: Path) -> None:
    """Print how many cases of a sweep have failed, the most frequent reasons, and the table's path.

    Raises NoAnswer where every case has failed.
    """
    from collections import Counter

    statuses = [row["status"] for row in rows]
    failed = Counter(status.removeprefix("failed: ") for status in statuses if status != "solved")
    print_folded_line(
        f"{len(rows)} cases: {len(rows) - failed.total()} solved, {failed.total()} failed"
    )
    for reason, count in failed.most_common(MAX_PRINTED_REASONS):
        print_folded_line(f"  failed, {count}: {reason}")
    print_folded_line(f"table: {table_file}")
    if failed.total() == len(rows):
        raise NoAnswer("sweep: no case has an answer; the table says why")
