"""Cases and their rows as one table, and the file of the table."""

import importlib
import json
import os
from collections.abc import Sequence
from itertools import chain
from pathlib import Path
from typing import Any

from drumlin.base.errors import BadInput
from drumlin.base.files import replacing, write_text
from drumlin.brake.file import unit_of
from drumlin.comparison import as_csv
from drumlin.sweeps.cases import Row, SweepCase, is_mesh_key

ROW_UNITS = {
    "torque": "N m",
    "braking_force": "N",
    "peak_pressure": "Pa",
    "hinge_reaction": "N",
}
"""Unit of a row's number, by the last part of its name. Other numbers have no unit; the ends of a
contact have that of the friction surface."""


def make_case_table(
    cases: Sequence[SweepCase],
    rows: Sequence[Row],
    base: Path | None = None,
    pressure: str = "Pa",
) -> list[Row]:
    """Cases and their rows as one table, headed with name and unit: "shoe.lining.thickness [m]".

    Parameters
    ----------
    cases : the cases
    rows : numbers of each case, in SI
    base : folder from which the paths of mesh files are written; None: the paths stay
    pressure : unit of all stresses, "Pa" or "MPa"

    Returns
    -------
    one line a case: its number, the changed values, model, status and the numbers of its row. A
    changed value that is a table itself stands as JSON.
    """
    # Many cases change the same keys: each heading is made once.
    headings: dict[str, str] = {}
    lines = []
    for number, (case, row) in enumerate(zip(cases, rows, strict=True)):
        line: Row = {"case": number}
        for key, value in case.changes.items():
            if key not in headings:
                headings[key] = _column_heading(key, unit_of(case.brake, key))
            line[headings[key]] = _changed_value_cell(key, value, base)
        line |= {"model": case.model, "status": row["status"]}
        for name, value in row.items():
            line[_column_heading(name, _row_unit(case, name))] = value
        lines.append(line if pressure == "Pa" else _stresses_in_megapascal(line))
    return lines


def _changed_value_cell(key: str, value: Any, base: Path | None) -> Any:
    """The cell of a changed value: a path from the folder `base`, a table of numbers as JSON."""
    if base is not None and is_mesh_key(key):
        return Path(os.path.relpath(value, base)).as_posix()
    return json.dumps(value) if isinstance(value, list | tuple) else value


def _row_unit(case: SweepCase, name: str) -> str | None:
    """The unit of a number of a row, by its name."""
    # The numbers of a shoe are named SHOE.NUMBER.
    quantity = name.rpartition(".")[2]
    if quantity in {"contact_start", "contact_end"}:
        return case.brake.surface.unit
    return ROW_UNITS.get(quantity)


def _stresses_in_megapascal(line: Row) -> Row:
    """A line of the table with its stresses in MPa."""
    converted: Row = {}
    for name, value in line.items():
        if not name.endswith(" [Pa]"):
            converted[name] = value
            continue
        heading = f"{name.removesuffix(' [Pa]')} [MPa]"
        converted[heading] = value * 1e-6 if isinstance(value, float) else value
    return converted


def _column_heading(name: str, unit: str | None) -> str:
    """The heading of a column: the name and, if there is one, the unit."""
    return f"{name} [{unit}]" if unit else name


def write_table(lines: Sequence[Row], path: Path) -> None:
    """Write a table whole or not at all: Parquet where the name ends in .parquet, else CSV."""
    if path.suffix != ".parquet":
        write_text(path, as_csv(lines))
        return
    parquet = _parquet_module()
    arrow = importlib.import_module("pyarrow")
    columns: dict[str, list[Any]] = {}
    # A dict keeps the order in which the names first occur.
    for name in dict.fromkeys(chain.from_iterable(lines)):
        values = [line.get(name) for line in lines]
        # A column of Parquet has one type. Numbers beside words become words.
        if any(isinstance(value, str) for value in values):
            values = [value if value is None else str(value) for value in values]
        columns[name] = values
    with replacing(path) as partial:
        parquet.write_table(arrow.table(columns), partial)


def _parquet_module() -> Any:
    """The module that writes Parquet. Raises BadInput where it is not installed."""
    try:
        return importlib.import_module("pyarrow.parquet")
    except ImportError as error:
        raise BadInput(
            "--output: Parquet needs the extra drumlin[parquet]; or take a name that ends in .csv"
        ) from error


def check_table_file(path: Path) -> None:
    """Raise BadInput for a table file that could not be written at the end of the sweep."""
    if path.suffix not in {".csv", ".parquet"}:
        raise BadInput(f"--output = {str(path)!r}: must end in .csv or .parquet")
    if path.suffix == ".parquet":
        _parquet_module()
