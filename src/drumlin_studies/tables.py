"""Selections from tables of results: sequences of rows, each with a value for each key."""

from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

RowType = TypeVar("RowType", bound=Mapping[str, Any])
"""Type variable for the type of a row: a selected row has the same type as the given rows."""


def values_of_key_in_rows(rows: Sequence[Mapping[str, Any]], key: str) -> list[Any]:
    """The values of a key, one for each row. Every row must have the key."""
    return [row[key] for row in rows]


def rows_with_given_values(rows: Sequence[RowType], **values: Any) -> list[RowType]:
    """The rows that have the given value for each given key.

    **values : the values by key, for example `knob="penalty"`.
    """
    return [row for row in rows if all(row.get(key) == value for key, value in values.items())]


def rows_that_have_value_of_key(rows: Sequence[RowType], key: str) -> list[RowType]:
    """The rows that have a value other than None for a key."""
    return [row for row in rows if row.get(key) is not None]
