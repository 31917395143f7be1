"""Commands that solve many brakes: `study` writes a report, and `sweep` writes a table."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from drumlin.base.errors import NoAnswer
from drumlin.cli.options import parser_of_whole_number_option
from drumlin.cli.terminal import (
    PrintedColumn,
    print_line_folded_to_terminal_width,
    print_names_beside_texts,
    print_note_to_standard_error,
    print_table_fitted_to_terminal,
    show_progress_bar,
    show_progress_bar_if_long,
    show_spinner_beside_words,
)

if TYPE_CHECKING:
    from drumlin.sweeps.cases import CaseResultsByName
    from drumlin.sweeps.sweep_table import SweepTable

STATISTICS_DROPPED_ON_NARROW_TERMINAL = ["most", "least"]
"""Columns of the printed statistics that a narrow terminal has no room for.

The columns are left out in this order, until the other columns fit.
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
    from drumlin.studies import docstring_first_lines_of_drumlin_studies, run_study_and_write_report

    if name is None:
        print_names_beside_texts(docstring_first_lines_of_drumlin_studies())
        return

    with show_spinner_beside_words(f"study {name}") as say:
        page = run_study_and_write_report(name, output, short=short, say=say)
    print_line_folded_to_terminal_width(f"report: {page}")


def sweep(
    sweep_file: Annotated[Path, typer.Argument(metavar="SWEEP.toml", help="the sweep file")],
    output: Annotated[
        Path | None, typer.Option(metavar="FILE.csv|FILE.parquet", help="the table of all cases")
    ] = None,
    jobs: Annotated[
        int | None,
        typer.Option(
            parser=parser_of_whole_number_option("--jobs"),
            metavar="<int>",
            help="processes; default: one a core",
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="a Dask scheduler, in place of this machine's cores"),
    ] = None,
    keep_journal: Annotated[
        bool, typer.Option("--keep-journal", help="keep the journal when all cases are solved")
    ] = False,
) -> None:
    """Solve a brake for many values of its keys, as one table with a row a case.

    The command ends with the mean, the spread, 5 % and 95 % and the extremes of the results. After
    a stop the same command goes on with the missing cases.
    """
    from drumlin.base.files import check_output_files_are_writable
    from drumlin.sweeps.file import read_sweep_from_toml_file
    from drumlin.sweeps.run import solve_sweep_with_journal, table_of_solved_sweep
    from drumlin.sweeps.table import check_table_file_is_writable

    with show_progress_bar_if_long(f"reading {sweep_file.name}") as judged:
        made = read_sweep_from_toml_file(sweep_file, judged)
    table_file = output or Path(f"{sweep_file.stem}.csv")
    check_table_file_is_writable(table_file)
    check_output_files_are_writable(table_file)

    def write_table(rows: "list[CaseResultsByName]") -> "SweepTable":
        """Write the table with the results of all cases, and return it."""
        solved = table_of_solved_sweep(made, rows, sweep_file.parent)
        with show_spinner_beside_words(f"writing {table_file.name}"):
            solved.write(table_file)
        return solved

    table = solve_sweep_with_journal(
        made,
        table_file,
        write_table,
        jobs=jobs,
        scheduler=scheduler,
        keep_journal=keep_journal,
        progress=show_progress_bar,
        say=print_note_to_standard_error,
    )
    _print_outcome_of_sweep(table, table_file)


def _print_outcome_of_sweep(table: "SweepTable", table_file: Path) -> None:
    """Print the number of failed cases with the reasons, the statistics, and the table's path.

    Raises NoAnswer where every case has failed.
    """
    for line in table.text_lines_on_outcome_of_cases():
        print_line_folded_to_terminal_width(line)
    failed = table.failures.total()
    if failed < len(table):
        head, *rows = table.cells_of_statistics()
        columns = {}
        for title, *texts in zip(head, *rows, strict=True):
            columns[title] = PrintedColumn(
                title or "result", title, texts, is_left_aligned=not title
            )
        print_table_fitted_to_terminal(columns, STATISTICS_DROPPED_ON_NARROW_TERMINAL)
        print_line_folded_to_terminal_width(table.line_on_statistics)
    print_line_folded_to_terminal_width(f"table: {table_file}")
    if failed == len(table):
        raise NoAnswer("sweep: no case has an answer; the table says why")
