"""Routines of LAPACK and BLAS, as scipy ships them, without the 0.3 s that `import scipy.linalg` takes for others.

They are those of scipy.linalg.lapack and scipy.linalg.blas, from the same files. Where a scipy keeps them elsewhere,
they are imported as usual.
"""

from importlib import import_module
from importlib.machinery import PathFinder
from importlib.util import module_from_spec
from typing import Any

import numpy as np
import scipy

from drumlin.arrays import Floats


def _module(compiled: str, public: str) -> Any:
    """The compiled module in scipy's folder linalg; else the public one that takes its routines from there."""
    found = PathFinder.find_spec(f"scipy.linalg.{compiled}", [f"{folder}/linalg" for folder in scipy.__path__])
    if found is None or found.loader is None:
        return import_module(public)
    module = module_from_spec(found)
    found.loader.exec_module(module)
    return module


_lapack, _blas = _module("_flapack", "scipy.linalg.lapack"), _module("_fblas", "scipy.linalg.blas")
dpotrf, dtrtrs, dgetrf, dgetrs, dgecon = (
    getattr(_lapack, name) for name in ("dpotrf", "dtrtrs", "dgetrf", "dgetrs", "dgecon")
)
dtrsm = _blas.dtrsm


def solve_lower(L: Floats, right: Floats) -> Floats:
    """L^-1 right for a lower triangular L (n, n), as dpotrf gives it, and right (n, m)."""
    if not right.size:
        return np.zeros(right.shape)
    return np.asarray(dtrtrs(L, right, lower=1)[0])
