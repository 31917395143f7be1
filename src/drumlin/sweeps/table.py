"""The table of a sweep, with a line for each case, and its file (CSV or Parquet)."""

import importlib
import json
import os
from collections.abc import Sequence
from itertools import chain
from pathlib import Path
from typing import Any

from drumlin.base.errors import BadInput
from drumlin.base.files import temporary_file_replacing_output, write_text
from drumlin.brake.file import si_unit_of_brake_key
from drumlin.comparison import table_as_csv_text
from drumlin.sweeps.cases import CaseResultsByName, SweepCase, is_key_of_mesh_file

UNITS_OF_CASE_RESULTS_BY_LAST_NAME_PART = {
    "torque": "N m",
    "braking_force": "N",
    "peak_pressure": "Pa",
    "hinge_reaction": "N",
}
"""The unit of each result, by the last part of its name ("torque" for "leading.torque").

Other results have no unit, except the ends of a contact: rad on a drum, m on a plane.
"""


def table_lines_of_cases(
    cases: Sequence[SweepCase],
    rows: Sequence[CaseResultsByName],
    base: Path | None = None,
    pressure: str = "Pa",
) -> list[CaseResultsByName]:
    """The lines of a sweep's table, with headings such as "shoe.lining.thickness [m]".

    Parameters
    ----------
    cases : the cases of the sweep
    rows : results of each case, in SI
    base : folder to which paths of mesh files are made relative; None: paths are not changed
    pressure : unit of all stresses in the table, "Pa" or "MPa"

    Returns
    -------
    a line for each case, as values by heading: number of the case, changed values, model, status
    and results. A changed value that is a list of numbers is written as JSON.
    """
    # Many cases change the same keys, so that each heading is made once.
    headings: dict[str, str] = {}
    lines = []
    for number, (case, row) in enumerate(zip(cases, rows, strict=True)):
        line: CaseResultsByName = {"case": number}
        for key, value in case.changes.items():
            if key not in headings:
                headings[key] = _column_heading_with_unit(
                    key, si_unit_of_brake_key(case.brake, key)
                )
            line[headings[key]] = _table_cell_of_changed_value(key, value, base)
        line |= {"model": case.model, "status": row["status"]}
        for name, value in row.items():
            line[_column_heading_with_unit(name, _unit_of_result(case, name))] = value
        lines.append(line if pressure == "Pa" else _table_line_with_stresses_in_mpa(line))
    return lines


def _table_cell_of_changed_value(key: str, value: Any, base: Path | None) -> Any:
    """A changed value as a cell of the table.

    The path of a mesh file is made relative to the folder `base`; a list becomes JSON.
    """
    if base is not None and is_key_of_mesh_file(key):
        return Path(os.path.relpath(value, base)).as_posix()
    return json.dumps(value) if isinstance(value, list | tuple) else value


def _unit_of_result(case: SweepCase, name: str) -> str | None:
    """The unit of a result of a case, by the name of the result; None without a unit."""
    # Results of a shoe have the name of the shoe in front, such as "leading.torque".
    quantity = name.rpartition(".")[2]
    if quantity in {"contact_start", "contact_end"}:
        return case.brake.surface.coordinate_unit
    return UNITS_OF_CASE_RESULTS_BY_LAST_NAME_PART.get(quantity)


def _table_line_with_stresses_in_mpa(line: CaseResultsByName) -> CaseResultsByName:
    """A copy of a line of the table, with stresses in MPa instead of Pa."""
    converted: CaseResultsByName = {}
    for name, value in line.items():
        if not name.endswith(" [Pa]"):
            converted[name] = value
            continue
        heading = f"{name.removesuffix(' [Pa]')} [MPa]"
        converted[heading] = value * 1e-6 if isinstance(value, float) else value
    return converted


def _column_heading_with_unit(name: str, unit: str | None) -> str:
    """The heading of a column: the name, followed by the unit in brackets if there is one."""
    return f"{name} [{unit}]" if unit else name


def write_table_file(lines: Sequence[CaseResultsByName], path: Path) -> None:
    """Write the lines of a table into a file, whole or not at all.

    The file is Parquet if its name ends in .parquet, else CSV.
    """
    if path.suffix != ".parquet":
        write_text(path, table_as_csv_text(lines))
        return
    parquet = _import_parquet_module_or_refuse_output()
    arrow = importlib.import_module("pyarrow")
    columns: dict[str, list[Any]] = {}
    # The columns stand in the order in which their names first occur in the lines.
    for name in dict.fromkeys(chain.from_iterable(lines)):
        values = [line.get(name) for line in lines]
        # All values of a Parquet column have one type, so that numbers in a column with words
        # become text.
        if any(isinstance(value, str) for value in values):
            values = [value if value is None else str(value) for value in values]
        columns[name] = values
    with temporary_file_replacing_output(path) as partial:
        parquet.write_table(arrow.table(columns), partial)


def _import_parquet_module_or_refuse_output() -> Any:
    """The Python module that writes Parquet files. Raises BadInput if it is not installed."""
    try:
        return importlib.import_module("pyarrow.parquet")
    except ImportError as error:
        raise BadInput(
            "--output: Parquet needs the extra drumlin[parquet]; or take a name that ends in .csv"
        ) from error


def check_table_file_is_writable(path: Path) -> None:
    """Raise BadInput if a table cannot be written to a file of this name.

    The check of the name's ending is done before the sweep, which may take hours.
    """
    if path.suffix not in {".csv", ".parquet"}:
        raise BadInput(f"--output = {str(path)!r}: must end in .csv or .parquet")
    if path.suffix == ".parquet":
        _import_parquet_module_or_refuse_output()
