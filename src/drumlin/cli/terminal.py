"""Printing for a person at the terminal: lines of an answer, progress bars and tables."""

import os
import re
import shutil
import sys
import time
import unicodedata
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from textwrap import fill
from typing import TYPE_CHECKING, Any, NamedTuple

from drumlin.base.errors import exception_for_unusable_file
from drumlin.base.texts import printable_single_line

if TYPE_CHECKING:
    from drumlin.comparison import ResultTableColumn

UNPRINTED_COMPARISON_COLUMNS = ("case", "rotation")
"""Columns of the table of `drumlin compare` that are never printed.

These columns have the same value in all rows, since the table is of one brake.
"""
COMPARISON_COLUMNS_DROPPED_ON_NARROW_TERMINAL = [
    "self_energising",
    "contact",
    "stated_pressure_error",
    "stated_torque_error",
    "reaction_error",
    "reaction",
    "peak_error",
    "peak_pressure",
    "seconds",
]
"""Columns of the table of `drumlin compare` that a narrow terminal has no room for.

The columns are left out in this order, until the other columns fit.
"""
COMPARISON_TABLE_WIDTH_IN_FILE_OR_PIPE = 200
"""Width [characters] of the table of `drumlin compare` in a file or a pipe, not a terminal."""
TABLE_WIDTH_IN_FILE_OR_PIPE = sys.maxsize
"""Width [characters] of other tables in a file or a pipe: all of their columns are printed."""
SMALLEST_WIDTH_OF_STATUS_COLUMN = 10
"""Smallest width [characters] of the column "status"; a longer status is folded into lines."""
NO_BREAK_SPACE = "\N{NO-BREAK SPACE}"
"""The character that joins a number and its unit while a text is folded into lines."""
UNIT_AFTER_NUMBER = re.compile(
    r"(?<=[0-9]) (?:%|[kM]?N m|k?N|[kMG]?Pa|deg|rad|[kmu]?m|m?s|J)(?![A-Za-z0-9])"
)
"""The pattern of a unit behind a number, with the blank before the unit."""
MAX_CHARACTERS_OF_PRINTED_LINE = 10_000
"""Largest number of characters of a printed line.

A longer line is cut: a text that comes from the user's file may have any length.
"""


def print_line_folded_to_terminal_width(line: str, *, at_once: bool = False) -> None:
    """Print a line to standard output, folded between words to the width of the terminal.

    Characters that cannot be printed, as in the name of a file, are escaped. `at_once` is whether
    the line is flushed, so that a reader sees it before the next line is printed.
    """
    line, width = (
        printable_single_line(line, MAX_CHARACTERS_OF_PRINTED_LINE),
        shutil.get_terminal_size().columns,
    )
    # A line of two words, such as "report: PATH", is not folded: a folded path cannot be copied.
    if len(line) > width and len(line.split()) > 2:
        line = _text_folded_to_width(line, width, more=" " * (len(line) - len(line.lstrip()) + 2))
    with _turn_output_faults_into_drumlin_errors():
        print(line, flush=at_once)


def print_names_beside_texts(texts: Mapping[str, str]) -> None:
    """Print a line for each name in `texts`: the name, then its text in an aligned column."""
    wide = max(map(len, texts))
    for name, text in texts.items():
        print_line_folded_to_terminal_width(f"{name:{wide}}  {text}")


def print_text_unchanged(text: str) -> None:
    """Print a text to standard output as it is: neither folded nor escaped, no line end added."""
    with _turn_output_faults_into_drumlin_errors():
        sys.stdout.write(text)


def _text_folded_to_width(text: str, width: int, more: str = "") -> str:
    """A text folded into lines of at most `width` characters.

    All lines but the first begin with `more`. A word longer than a line is not broken, and a number
    stays on one line with its unit.
    """
    # The module textwrap folds a line at common blanks only.
    joined = UNIT_AFTER_NUMBER.sub(lambda unit: unit[0].replace(" ", NO_BREAK_SPACE), text)
    folded = fill(
        joined, width, break_long_words=False, break_on_hyphens=False, subsequent_indent=more
    )
    return folded.replace(NO_BREAK_SPACE, " ")


def print_note_to_standard_error(line: str) -> None:
    """Print a message of one line to standard error. The answer itself goes to standard output."""
    print(f"drumlin: {printable_single_line(line)}", file=sys.stderr)


@contextmanager
def _turn_output_faults_into_drumlin_errors() -> Iterator[None]:
    """Turn a failed write to standard output within the block into a DrumlinError of one line.

    A reader that has closed its pipe, such as `head`, is no fault: BrokenPipeError is passed on.
    """
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        raise exception_for_unusable_file("standard output", "written", error) from error


def can_terminal_show_progress() -> bool:
    """Whether standard error is a terminal in which a line can be replaced by the next one.

    A notebook seems to be a terminal to the commands in its cells, but it prints control codes as
    text.
    """
    is_cell_of_notebook = "JPY_PARENT_PID" in os.environ
    return sys.stderr.isatty() and not is_cell_of_notebook


SECONDS_BEFORE_PROGRESS_BAR = 2.0
"""Seconds after which `show_progress_bar_if_long` shows a bar.

Reading most sweep files takes less, and a bar would only flash up.
"""


@contextmanager
def show_progress_bar_if_long(words: str) -> Iterator[Callable[[int, int], None]]:
    """Show a progress bar with the time left, on a terminal, if the block runs for some time.

    The bar appears after SECONDS_BEFORE_PROGRESS_BAR seconds. The `with` statement gives a function
    that the block calls with the number of finished cases and the number of all cases.
    """
    start = time.monotonic()
    with ExitStack() as shown:
        bars: list[Callable[[int, int], None]] = []

        def show_and_move_progress_bar(finished: int, of: int) -> None:
            """Move the bar to `finished` of `of` cases.

            The bar is shown once SECONDS_BEFORE_PROGRESS_BAR seconds have passed.
            """
            if not bars and time.monotonic() - start > SECONDS_BEFORE_PROGRESS_BAR:
                bars.append(shown.enter_context(show_progress_bar(words)))
            for bar in bars:
                bar(finished, of)

        yield show_and_move_progress_bar


@contextmanager
def show_progress_bar(words: str) -> Iterator[Callable[[int, int], None]]:
    """Show a progress bar with the time left while the block runs, on a terminal.

    `words` stand before the bar. The `with` statement gives a function that the block calls with
    the number of finished cases and the number of all cases. Nothing is shown where
    `can_terminal_show_progress` is false.
    """
    if not can_terminal_show_progress():
        yield lambda finished, of: None
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeRemainingColumn,
    )

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task(words, total=None)
        yield lambda finished, of: bar.update(task, completed=finished, total=of)


@contextmanager
def show_spinner_beside_words(words: str) -> Iterator[Callable[[str], None]]:
    """Show a spinner beside `words` while the block runs, if the terminal can show progress.

    The `with` statement gives a function that the block calls with new words for its next task.
    """
    if not can_terminal_show_progress():
        yield lambda words: None
        return
    from rich.console import Console
    from rich.text import Text

    with Console(stderr=True).status(Text(words)) as status:
        yield lambda words: status.update(Text(words))


class PrintedColumn(NamedTuple):
    """A column of a printed table.

    Attributes
    ----------
    title : name of the column for use in a sentence
    heading : heading, of one line or more
    cells : text of each row, of one line or more
    is_left_aligned : whether the texts are aligned to the left
    """

    title: str
    heading: str
    cells: list[str]
    is_left_aligned: bool = False

    @property
    def width(self) -> int:
        """Width of the widest line in the column's heading and cells, in characters."""
        lines = [line for cell in (self.heading, *self.cells) for line in cell.split("\n")]
        return max(map(_width_on_terminal, lines))

    def line_padded_to_column_width(self, word: str) -> str:
        """A line of a cell with blanks up to the width of the column."""
        blanks = " " * (self.width - _width_on_terminal(word))
        return word + blanks if self.is_left_aligned else blanks + word


def _width_on_terminal(text: str) -> int:
    """The width of a line of text on a terminal, in widths of a Latin letter.

    East Asian letters count as two, and marks that combine with a letter as none.
    """
    width = 0
    for letter in text:
        if not unicodedata.combining(letter):
            width += 2 if unicodedata.east_asian_width(letter) in {"W", "F"} else 1
    return width


def print_table_fitted_to_terminal(
    columns: Mapping[str, PrintedColumn], least: Sequence[str], width: int | None = None
) -> None:
    """Print a table; on a narrow terminal the least important columns are left out.

    Cells are never cut. A line below the table names the columns that are left out.

    Parameters
    ----------
    columns : the columns, each by a short name such as "effect"
    least : short names of the columns that may be left out, the least important first
    width : largest number of characters of a line; None: the width of the terminal, and no limit
        in a file or a pipe
    """
    width = width or shutil.get_terminal_size((TABLE_WIDTH_IN_FILE_OR_PIPE, 1)).columns
    shown, cut = dict(columns), []
    for key in least:
        # The width of the table: all columns with two spaces between them.
        needed = sum(column.width + 2 for column in shown.values()) - 2
        if key in shown and needed > width:
            cut.append(shown.pop(key).title)
    with _turn_output_faults_into_drumlin_errors():
        print("\n".join(_lines_of_printed_table(shown.values())))
    if cut:
        print_line_folded_to_terminal_width(
            f"not shown here, the terminal is too narrow: {', '.join(cut)}"
        )


def _lines_of_printed_table(columns: Collection[PrintedColumn]) -> list[str]:
    """The lines of a printed table without ruled lines, with two spaces between the columns.

    A heading with few lines stands at the bottom of the row of headings. A cell with few lines
    stands at the top of its row.
    """
    rows = zip(*((column.heading, *column.cells) for column in columns), strict=True)
    lines: list[str] = []
    for number, row in enumerate(rows):
        cells = [text.split("\n") for text in row]
        height = max(map(len, cells))
        for k in range(height):
            words = []
            for column, cell in zip(columns, cells, strict=True):
                at = k - (height - len(cell)) * (number == 0)
                word = cell[at] if 0 <= at < len(cell) else ""
                words.append(column.line_padded_to_column_width(word))
            lines.append("  ".join(words).rstrip())
    return lines


def print_table_of_compared_models(
    table: Sequence[dict[str, Any]], shown: "Sequence[ResultTableColumn]"
) -> None:
    """Print the table of a comparison of models.

    `table` holds a row for each model and shoe, `shown` the columns. Columns without a value are
    not printed.
    """
    width = (
        shutil.get_terminal_size().columns
        if sys.stdout.isatty()
        else COMPARISON_TABLE_WIDTH_IN_FILE_OR_PIPE
    )
    # Turn the values of each column into texts. Columns that are empty or never printed are left
    # out.
    columns = {}
    for column in shown:
        is_empty = all(row.get(column.key) is None for row in table)
        if column.key in UNPRINTED_COMPARISON_COLUMNS or is_empty:
            continue
        # The unit stands on a line of its own below the folded heading.
        head = fill(column.heading, 9, break_long_words=False)
        if column.unit:
            head += f"\n[{column.unit}]"
        cells = [printable_single_line(column.text(row)) for row in table]
        has_words = column.key in {"shoe", "model", "status"}
        columns[column.key] = PrintedColumn(column.title, head, cells, is_left_aligned=has_words)
    # The status of a model may be a long reason: it is folded into the width that is left.
    status = columns.get("status")
    if status is not None:
        others = [other for key, other in columns.items() if key != "status"]
        room = width - sum(other.width + 2 for other in others)
        folded = [
            _text_folded_to_width(cell, max(room, SMALLEST_WIDTH_OF_STATUS_COLUMN))
            for cell in status.cells
        ]
        columns["status"] = status._replace(cells=folded)
    print_table_fitted_to_terminal(columns, COMPARISON_COLUMNS_DROPPED_ON_NARROW_TERMINAL, width)
