"""Cases and their rows as one table, and its file."""

import importlib
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from drumlin.base.errors import BadInput
from drumlin.base.files import replacing, write_text
from drumlin.brake.file import unit_of
from drumlin.comparison import as_csv
from drumlin.sweeps.cases import Case, Row, names_mesh

UNITS = {
    "torque": "N m",
    "braking_force": "N",
    "peak_pressure": "Pa",
    "hinge_reaction": "N",
}


def table(
    cases: Sequence[Case], rows: Sequence[Row], base: Path | None = None, pressure: str = "Pa"
) -> list[Row]:
    """Cases and their rows as one table in SI, columns headed with name and unit:
    "shoe.lining.thickness [m]".

    A changed value that is a table itself stands as JSON, a mesh file by its path from the folder
    `base`; stresses stand in the unit `pressure`, "Pa" or "MPa".
    """
    units: dict[str, str] = {}
    made = []
    for number, (case, row) in enumerate(zip(cases, rows, strict=True)):
        line: Row = {"case": number}
        for key, value in case.changes.items():
            if key not in units:
                units[key] = _headed(key, unit_of(case.brake, key))
            if base is not None and names_mesh(key):
                value = Path(os.path.relpath(value, base)).as_posix()  # noqa: PLW2901
            line[units[key]] = json.dumps(value) if isinstance(value, list | tuple) else value
        line |= {"model": case.model, "status": row["status"]}
        for name, value in row.items():
            last = name.rpartition(".")[2]
            unit = (
                case.brake.surface.unit
                if last in {"contact_start", "contact_end"}
                else UNITS.get(last)
            )
            line[_headed(name, unit)] = value
        made.append(line if pressure == "Pa" else _in_megapascal(line))
    return made


def _in_megapascal(line: Row) -> Row:
    return {
        f"{name.removesuffix(' [Pa]')} [MPa]" if name.endswith(" [Pa]") else name: value * 1e-6
        if name.endswith(" [Pa]") and isinstance(value, float)
        else value
        for name, value in line.items()
    }


def _headed(name: str, unit: str | None) -> str:
    return f"{name} [{unit}]" if unit else name


def write_table(lines: Sequence[Row], path: Path) -> None:
    """Write a table whole or not at all: Parquet where the name ends in .parquet, else CSV."""
    if path.suffix != ".parquet":
        write_text(path, as_csv(lines))
        return
    parquet = _parquet()
    arrow = importlib.import_module("pyarrow")
    names = dict.fromkeys(name for line in lines for name in line)
    columns = {name: [line.get(name) for line in lines] for name in names}
    for name, values in columns.items():
        if any(isinstance(value, str) for value in values):  # numbers and tables under one key
            columns[name] = [value if value is None else str(value) for value in values]
    with replacing(path) as partial:
        parquet.write_table(arrow.table(columns), partial)


def _parquet() -> Any:
    try:
        return importlib.import_module("pyarrow.parquet")
    except ImportError as error:
        raise BadInput(
            "--output: Parquet needs the extra drumlin[parquet]; or take a name that ends in .csv"
        ) from error


def check_output(path: Path) -> None:
    """Raise BadInput for a table that could not be written in the end, before anything is solved."""
    if path.suffix not in {".csv", ".parquet"}:
        raise BadInput(f"--output = {str(path)!r}: must end in .csv or .parquet")
    if path.suffix == ".parquet":
        _parquet()
