"""Array types. Shapes stand in the docstrings."""

from typing import Any

import numpy as np

Floats = np.ndarray[Any, np.dtype[np.float64]]
Ints = np.ndarray[Any, np.dtype[np.int64]]
Bools = np.ndarray[Any, np.dtype[np.bool_]]
Values = float | Floats
"""One number or an array that broadcasts with the others."""


def unique(values: Floats | Ints) -> Any:
    """The different ones of values (n,), growing; np.unique loads numpy.ma for them (20 ms)."""
    found = np.sort(values)
    new = np.ones(len(found), dtype=bool)
    new[1:] = found[1:] != found[:-1]
    return found[new]


def block_diagonal(*blocks: Floats) -> Floats:
    """The blocks (m_i, n_i), or rows (n_i,), along the diagonal of a matrix that is zero elsewhere."""
    parts = [np.atleast_2d(block) for block in blocks]
    found = np.zeros(np.sum([part.shape for part in parts], axis=0))
    row, column = 0, 0
    for part in parts:
        m, n = part.shape
        found[row : row + m, column : column + n] = part
        row, column = row + m, column + n
    return found
