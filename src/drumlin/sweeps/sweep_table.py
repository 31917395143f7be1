"""The table of a solved sweep: a row for each case, columns by name, statistics and failures."""

import importlib
import math
import sys
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple, overload

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.base.shown_tables import html_table_with_caption, text_lines_of_aligned_columns
from drumlin.base.texts import did_you_mean_hint, error_text_in_percent
from drumlin.brake.units import PRINTED_UNIT_AND_FACTOR_BY_SI_UNIT
from drumlin.response.show import matplotlib_axes_itself_or_new
from drumlin.sweeps.cases import CaseResultsByName
from drumlin.sweeps.table import check_table_file_is_writable, write_table_file

MOST_SHOWN_ROWS_OF_SWEEP_TABLE = 10
"""Largest number of cases that a displayed table shows; all cases would fill the screen."""

MOST_SHOWN_REASONS_OF_FAILED_CASES = 3
"""Largest number of reasons for failed cases that are shown, the most frequent first."""


FEWEST_CASES_OF_SHOWN_QUANTILES = 20
"""Smallest number of cases of which the quantiles of 5 % and of 95 % are shown.

Of fewer cases one of them is more than 5 %, so that the quantiles lie between the two least and the
two largest values.
"""


class ColumnStatistics(NamedTuple):
    """Statistics of one column of a sweep's table, over the solved cases with a number in it.

    Attributes
    ----------
    column : heading of the column, with its unit in brackets
    model : name of the model whose cases are counted
    cases : number of cases
    mean : arithmetic mean
    deviation : standard deviation (sum of squares divided by cases - 1); nan for one case
    low, high : quantiles of 5 % and of 95 %, linear between two neighbouring cases
    smallest, largest : extreme values
    """

    column: str
    model: str
    cases: int
    mean: float
    deviation: float
    low: float
    high: float
    smallest: float
    largest: float

    def texts(self) -> tuple[str, ...]:
        """The cells of a row of the shown table; stresses in MPa, angles in degrees, lengths in mm.

        The cells have the order of STATISTICS_HEADINGS. The name of the model is not among them.
        The quantiles of fewer than FEWEST_CASES_OF_SHOWN_QUANTILES cases are dashes.
        """
        shown = HeadingAndUnitFactorOfShownColumn.shown_column_for_heading(self.column)
        row = self
        if self.cases < FEWEST_CASES_OF_SHOWN_QUANTILES:
            row = self._replace(low=math.nan, high=math.nan)
        return (shown.heading, *(shown.text(value, 4) for value in row[3:]))


STATISTICS_HEADINGS = ("", "mean", "spread", "5 %", "95 %", "least", "most")
"""Headings of the shown statistics. The spread is the standard deviation."""


class HeadingAndUnitFactorOfShownColumn(NamedTuple):
    """The heading of a column of the displayed table, and the factor to its displayed unit.

    Attributes
    ----------
    heading : heading with spaces and the shown unit
    factor : factor that converts the value of the table to the shown unit
    """

    heading: str
    factor: float

    @classmethod
    def shown_column_for_heading(cls, heading: str) -> "HeadingAndUnitFactorOfShownColumn":
        """The shown column for a heading of the table, such as "peak_pressure [Pa]"."""
        name, unit = name_and_unit_of_column(heading)
        shown, factor = PRINTED_UNIT_AND_FACTOR_BY_SI_UNIT.get(unit, (unit, 1.0))
        # A name that begins with "shoe", such as "shoe[0].lining.thickness" or "shoe_factor", stays
        # as it is. In all other names a point or an underscore becomes a space.
        words = name if name.startswith("shoe") else name.replace(".", " ").replace("_", " ")
        return cls(f"{words} [{shown}]" if shown else words, factor)

    def text(self, value: Any, digits: int) -> str:
        """A value of the column as text; numbers have `digits` significant digits."""
        if value is None or (isinstance(value, float) and math.isnan(value)):
            return "–"
        # Adding 0.0 turns a negative zero into a zero without sign.
        is_number = isinstance(value, float)
        return f"{value * self.factor + 0.0:.{digits}g}" if is_number else str(value)


def name_and_unit_of_column(heading: str) -> tuple[str, str]:
    """The name and the unit of a column's heading, such as "torque [N m]"; "" for no unit."""
    name, bracket, unit = heading.partition(" [")
    return name, unit.removesuffix("]") if bracket else ""


class SweepTable(Sequence[CaseResultsByName]):
    """The table of a solved sweep: a sequence of rows, one for each case, with columns by name.

    `table[0]` is the first row, with values by heading. `table["torque"]` is a column: an array of
    numbers, with nan for the results of cases that are not solved, or a list of texts. A row, and
    the file of the table, keep the numbers of a case that has not converged beside its status. The
    unit of a heading may be left out. All numbers are in SI units, but a sweep file may ask for
    stresses in MPa.

    Parameters
    ----------
    title : title of the sweep
    rows : the rows of all cases
    varied : names of the varied keys
    notes : lines on the sweep, such as on a law that does not use a varied key
    """

    def __init__(
        self,
        title: str,
        rows: Sequence[CaseResultsByName],
        varied: Sequence[str],
        notes: Sequence[str] = (),
    ) -> None:
        self.title, self.rows, self.varied = title, list(rows), tuple(varied)
        self.notes = tuple(notes)

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[CaseResultsByName]:
        return iter(self.rows)

    @overload
    def __getitem__(self, which: int) -> CaseResultsByName: ...
    @overload
    def __getitem__(self, which: slice) -> list[CaseResultsByName]: ...
    @overload
    def __getitem__(self, which: str) -> Any: ...
    def __getitem__(self, which: int | slice | str) -> Any:
        """A row by its number, several rows by a slice, or a column by its name."""
        if not isinstance(which, str):
            return self.rows[which]
        heading = self.heading_of_column(which)
        given = self._headings_of_case_inputs()
        values = [_value_unless_result_of_unsolved_case(row, heading, given) for row in self.rows]
        if any(isinstance(value, str) for value in values):
            return values
        return np.array([math.nan if value is None else value for value in values], dtype=float)

    def __eq__(self, other: object) -> bool:
        """Whether another table, or a list, has the same rows."""
        return self.rows == (other.rows if isinstance(other, SweepTable) else other)

    __hash__ = None  # type: ignore[assignment]

    @property
    def headings(self) -> list[str]:
        """The headings of all columns, in the order in which they first occur."""
        return list(dict.fromkeys(heading for row in self.rows for heading in row))

    def heading_of_column(self, name: str) -> str:
        """The heading of a column that is named with or without its unit.

        Raises BadInput for an unknown name.
        """
        headings = self.headings
        names = {name_and_unit_of_column(heading)[0]: heading for heading in headings}
        if name in headings:
            return name
        if name not in names:
            hint = did_you_mean_hint(name, names)
            raise BadInput(f"column {name!r}: unknown{hint}; allowed: {', '.join(names)}")
        return names[name]

    def _headings_of_case_inputs(self) -> set[str]:
        """The headings of the columns that are given for each case and are not results."""
        return {"case", *map(self.heading_of_column, self.varied)}

    @property
    def failures(self) -> Counter[str]:
        """The reasons of the failed cases, each with the number of its cases."""
        statuses = [row["status"] for row in self.rows]
        return Counter(s.removeprefix("failed: ") for s in statuses if s != "solved")

    def statistics(self, *columns: str) -> list[ColumnStatistics]:
        """Statistics of columns, for each model: mean, spread, 5 % and 95 %, and extremes.

        Parameters
        ----------
        columns : names of columns with numbers, with or without units; without names the torque
            (on a plane the braking force), the brake factor, the peak pressure, and the peak
            pressure of each shoe

        Raises
        ------
        BadInput
            for an unknown column, and for a column without numbers
        """
        asked = [self.heading_of_column(column) for column in columns]
        found = []
        for model in dict.fromkeys(row["model"] for row in self.rows):
            for heading in asked or self._headings_of_main_results():
                values = self._numbers_of_column(heading, model)
                if len(values):
                    found.append(_statistics_of_values(heading, model, values))
                elif asked and not self.failures:
                    raise BadInput(f"column {heading!r}: has no numbers")
        return found

    def _numbers_of_column(self, heading: str, model: str) -> Floats:
        """The numbers (n,) of a column in the solved cases of a model."""
        values = [row.get(heading) for row in self._solved_rows_of_model(model)]
        return np.array([value for value in values if isinstance(value, int | float)], dtype=float)

    def _solved_rows_of_model(self, model: str) -> list[CaseResultsByName]:
        """The rows of the solved cases of a model.

        A case that has not converged has numbers, too, but they are not its answer.
        """
        return [row for row in self.rows if row["model"] == model and row["status"] == "solved"]

    def _headings_of_main_results(self) -> list[str]:
        """The headings of the columns whose statistics are shown by default."""
        main = {"torque", "braking_force", "brake_factor", "peak_pressure"}
        found = []
        for heading in self.headings:
            name = name_and_unit_of_column(heading)[0]
            if name in main or name.endswith(".peak_pressure"):
                found.append(heading)
        return found

    def cells_of_statistics(self, *columns: str) -> list[tuple[str, ...]]:
        """The cells of the shown table of statistics: headings, and a row for each column.

        With several models the name of the model stands before the name of the column.
        """
        found = self.statistics(*columns)
        several = len({row.model for row in found}) > 1
        rows: list[tuple[str, ...]] = [STATISTICS_HEADINGS]
        for one in found:
            heading, *texts = one.texts()
            rows.append((f"{one.model}: {heading}" if several else heading, *texts))
        return rows

    @property
    def line_on_statistics(self) -> str:
        """A line of text that explains the headings of the shown statistics."""
        return (
            "spread: standard deviation; 5 % and 95 %: share of the cases with less; least and "
            "most: of the solved cases, not of all possible ones"
        )

    def text_lines_on_outcome_of_cases(self) -> list[str]:
        """Lines of text: the number of solved and failed cases, the main reasons, and the notes."""
        failures = self.failures
        count, failed = len(self.rows), failures.total()
        lines = [f"{count} cases: {count - failed} solved, {failed} failed"]
        for reason, number in failures.most_common(MOST_SHOWN_REASONS_OF_FAILED_CASES):
            lines.append(f"  failed, {number}: {reason}")
        return [*lines, *self.notes]

    def _lines_on_stated_errors(self) -> list[str]:
        """A line on the largest errors that the solved cases state; else no line."""
        parts = []
        for key, words in (("error_torque", "torque"), ("error_pressure", "p (L2, worst shoe)")):
            solved = [row for row in self.rows if row["status"] == "solved"]
            stated = [row[key] for row in solved if isinstance(row.get(key), float)]
            known = [error for error in stated if not math.isnan(error)]
            if known:
                parts.append(f"{words} at most {error_text_in_percent(max(known))}")
        return [f"estimated errors: {', '.join(parts)}"] if parts else []

    def write(self, path: Path | str) -> None:
        """Write the table into a file, CSV or Parquet by the ending of its name.

        Raises BadInput for another ending, and for a file that cannot be written.
        """
        try:
            check_table_file_is_writable(Path(path))
        except BadInput as error:
            error.replace_options_by_python_arguments_in_message()
            raise
        write_table_file(self.rows, Path(path))

    def to_pandas(self) -> Any:
        """The table as a pandas DataFrame, with the headings as names of the columns.

        As in `table["torque"]`, results of cases that are not solved are nan, also of those that
        have not converged.

        Raises BadInput if pandas is not installed.
        """
        try:
            pandas = importlib.import_module("pandas")
        except ImportError as error:
            raise BadInput(
                "to_pandas: needs the package pandas, which is not installed: pip install pandas"
            ) from error
        given = self._headings_of_case_inputs()
        records = []
        for row in self.rows:
            record = {}
            for heading in row:
                value = _value_unless_result_of_unsolved_case(row, heading, given)
                record[heading] = math.nan if value is None else value
            records.append(record)
        return pandas.DataFrame(records, columns=self.headings)

    def plot(self, x: str = "", y: str = "", axes: Any = None) -> Any:
        """Draw column `y` over column `x`: for each model, a point for each solved case.

        Parameters
        ----------
        x, y : names of columns with numbers; x is by default the only varied key with numbers, y
            the torque or braking force
        axes : matplotlib axes; None for new axes

        Returns
        -------
        the axes

        Raises
        ------
        BadInput
            for an unknown column, for a column of texts, for other axes, and without `x` if
            several keys vary
        """
        drawn = [
            self.heading_of_column(x or self._only_varied_key_with_numbers()),
            self.heading_of_column(y or self._heading_of_torque_or_braking_force()),
        ]
        for heading in drawn:
            if any(isinstance(row.get(heading), str) for row in self.rows):
                raise BadInput(f"column {heading!r}: has texts; only numbers can be drawn")
        axes = matplotlib_axes_itself_or_new(axes)
        for model in dict.fromkeys(row["model"] for row in self.rows):
            rows = self._solved_rows_of_model(model)
            columns = [[row.get(heading, math.nan) for row in rows] for heading in drawn]
            axes.plot(*np.array(columns, dtype=float), ".", label=model)
        axes.set(xlabel=drawn[0], ylabel=drawn[1], title=self.title)
        axes.legend()
        return axes

    def _only_varied_key_with_numbers(self) -> str:
        """The one varied key that has numbers. Raises BadInput if there is none or several."""
        keys = [
            key
            for key in self.varied
            if not any(isinstance(row.get(self.heading_of_column(key)), str) for row in self.rows)
        ]
        if len(keys) != 1:
            varied = ", ".join(repr(key) for key in keys) or "no key with numbers"
            raise BadInput(f"x: must name the column to draw over; this sweep varies {varied}")
        return keys[0]

    def _heading_of_torque_or_braking_force(self) -> str:
        """The heading of the brake's torque, or on a plane of its braking force."""
        found = [heading for heading in self._headings_of_main_results() if "." not in heading]
        return found[0] if found else "torque"

    def _cells_of_displayed_table(self) -> list[tuple[str, ...]]:
        """The headings and the first rows of the table: varied keys, model, results, status."""
        keys = [self.heading_of_column(key) for key in self.varied]
        main = [heading for heading in self._headings_of_main_results() if "." not in heading]
        headings = ["case", *keys, "model", *main, "status"]
        columns = {
            heading: HeadingAndUnitFactorOfShownColumn.shown_column_for_heading(heading)
            for heading in headings
        }
        rows = [tuple(column.heading for column in columns.values())]
        given = self._headings_of_case_inputs()
        for row in self.rows[:MOST_SHOWN_ROWS_OF_SWEEP_TABLE]:
            cells = {}
            for heading in headings:
                cells[heading] = _value_unless_result_of_unsolved_case(row, heading, given)
            # The cell says only that a case failed. The reasons are printed above the table.
            cells["status"] = str(row["status"]).partition(":")[0]
            rows.append(tuple(column.text(cells[key], 6) for key, column in columns.items()))
        return rows

    def __repr__(self) -> str:
        """The title, the outcome, the first rows and the statistics as text."""
        lines = [
            self.title,
            *self.text_lines_on_outcome_of_cases(),
            *self._lines_on_stated_errors(),
        ]
        lines += text_lines_of_aligned_columns(self._cells_of_displayed_table())
        if len(self.rows) > MOST_SHOWN_ROWS_OF_SWEEP_TABLE:
            lines.append(f"... {len(self.rows) - MOST_SHOWN_ROWS_OF_SWEEP_TABLE} further cases")
        return "\n".join([*lines, *text_lines_of_aligned_columns(self.cells_of_statistics())])

    def _repr_html_(self) -> str:
        """The first rows and the statistics as two HTML tables, which notebooks display."""
        outcome = "; ".join([self.text_lines_on_outcome_of_cases()[0], *self.notes])
        first = html_table_with_caption(
            f"{self.title}, {outcome}", self._cells_of_displayed_table()
        )
        return first + html_table_with_caption("statistics", self.cells_of_statistics())


def _value_unless_result_of_unsolved_case(
    row: CaseResultsByName, heading: str, given: Collection[str]
) -> Any:
    """The value of a row under a heading; None for a number that results from an unsolved case.

    A case that has not converged has numbers as results, too. `given` are the headings of values
    that are no results.
    """
    value = row.get(heading)
    is_result = heading not in given and not isinstance(value, str)
    return None if is_result and row["status"] != "solved" else value


def _statistics_of_values(heading: str, model: str, values: Floats) -> ColumnStatistics:
    """The statistics of the values (n,) of a column."""
    low, high = np.quantile(values, [0.05, 0.95]).tolist()
    return ColumnStatistics(
        heading,
        model,
        len(values),
        float(values.mean()),
        float(values.std(ddof=1)) if len(values) > 1 else math.nan,
        low,
        high,
        float(values.min()),
        float(values.max()),
    )


def function_that_prints_progress() -> Callable[[int, int], None]:
    """A function that shows the progress of a sweep in one line; each call overwrites the line.

    The line goes to standard error. It looks the same in a terminal and in a notebook.
    """
    shown = [""]

    def print_progress(finished: int, of: int) -> None:
        """Print how many of all cases are finished, if the percentage has changed."""
        share = f"{100 * finished // max(of, 1)} %"
        if share != shown[0]:
            shown[0] = share
            end = "\n" if finished == of else ""
            sys.stderr.write(f"\r{finished} of {of} cases, {share}{end}")
            sys.stderr.flush()

    return print_progress
