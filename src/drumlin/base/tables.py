"""Read tables from text files in which commas, semicolons or tabs separate the cells.

Spreadsheets of countries with a decimal comma separate cells by semicolons. A table with both
decimal commas and decimal points is refused: its numbers could be read in two ways.
"""

import csv
import io
from collections.abc import Iterable

from drumlin.base.written_numbers import (
    decimal_sign_proved_by_number_text,
    number_from_text_as_people_write_it,
)

CELL_SEPARATORS = (",", ";", "\t")
"""Characters that may separate the cells of a table."""


def split_text_table_into_cell_rows(text: str) -> list[list[str]]:
    """The rows of a table, each a list of cells.

    The separator is the one of CELL_SEPARATORS that the first line has most often.

    Raises csv.Error for a text that is no table.
    """
    heading = text.partition("\n")[0]
    # If the first line has several separators equally often, or none at all, `max` takes the first
    # of CELL_SEPARATORS, the comma.
    separator = max(CELL_SEPARATORS, key=heading.count)
    return list(csv.reader(io.StringIO(text, newline=""), delimiter=separator))


def decimal_sign_of_table(cells: Iterable[str]) -> str:
    """The decimal sign, "," or ".", of the numbers in the cells of a table; "" if no cell tells it.

    Raises ValueError for cells of which some have a decimal comma and others a decimal point.
    """
    # For each decimal sign the first cell that proves it is kept, for the error message.
    found: dict[str, str] = {}
    for cell in cells:
        sign = decimal_sign_proved_by_number_text(cell)
        if sign:
            found.setdefault(sign, cell.strip())
    if len(found) == 2:
        raise ValueError(
            f"has decimal commas ({found[',']}) and decimal points ({found['.']}); "
            "must have one of them"
        )
    return next(iter(found), "")


def number_in_table_cell(cell: str, decimal_sign: str) -> float:
    """The number in a cell of a table whose decimal sign is known, see `decimal_sign_of_table`.

    Raises ValueError for a cell without a number, or with a number that has two readings.
    """
    # A plain number needs no check of its commas. It may also be longer than
    # MAX_CHARACTERS_OF_QUANTITY_TEXT, which `number_from_text_as_people_write_it` refuses.
    if decimal_sign != "," or not set(".,") & set(cell):
        try:
            return float(cell)
        except ValueError:
            pass
    return number_from_text_as_people_write_it(cell, decimal_sign)
