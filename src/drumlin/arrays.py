"""Array types. Shapes stand in the docstrings."""

from typing import Any

import numpy as np

Floats = np.ndarray[Any, np.dtype[np.float64]]
Ints = np.ndarray[Any, np.dtype[np.int64]]
Bools = np.ndarray[Any, np.dtype[np.bool_]]
Values = float | Floats
"""One number or an array that broadcasts with the others."""
