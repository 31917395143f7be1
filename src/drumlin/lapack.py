"""The routines of LAPACK and BLAS that solves call, as scipy has compiled them, and block_diag.

`import scipy.linalg` loads numpy.f2py and numpy.testing and rewrites its documentation, twice as long as a brake takes
from its file to its answer. scipy's compiled modules `_flapack` and `_fblas` load by themselves; where a scipy has none
of that name its public `scipy.linalg.lapack` and `.blas` stand in, with the same routines.
"""

import sys
from importlib import import_module
from importlib.machinery import PathFinder
from importlib.util import module_from_spec
from pathlib import Path
from types import ModuleType

import numpy as np
import scipy

from drumlin.arrays import Floats


def compiled(name: str, public: str) -> ModuleType:
    """A compiled module of scipy.linalg by itself, or where there is none the public one."""
    full = f"scipy.linalg.{name}"
    if full not in sys.modules:
        spec = PathFinder.find_spec(full, [str(Path(scipy.__file__).parent / "linalg")])
        if spec is None or spec.loader is None:
            return import_module(f"scipy.linalg.{public}")
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
        sys.modules[full] = module  # where scipy.linalg finds it
    return sys.modules[full]


_LAPACK, _BLAS = compiled("_flapack", "lapack"), compiled("_fblas", "blas")
dpotrf, dtrtrs, dtrsm, dgemm = _LAPACK.dpotrf, _LAPACK.dtrtrs, _BLAS.dtrsm, _BLAS.dgemm
dgetrf, dgetrs, dgecon = _LAPACK.dgetrf, _LAPACK.dgetrs, _LAPACK.dgecon


def solve_lower(L: Floats, b: Floats) -> Floats:
    """x of L x = b; L (n, n) lower triangular, b (n,) or (n, m). Raises numpy's LinAlgError where L is singular."""
    x, info = dtrtrs(L, b, lower=1)
    if info:
        raise np.linalg.LinAlgError(f"singular: no pivot in row {info}")
    return np.asarray(x).reshape(b.shape)


def block_diag(*blocks: Floats) -> Floats:
    """Matrices (m_i, n_i) as one (sum m_i, sum n_i) with them along its diagonal; (n,) counts as one row."""
    blocks = tuple(map(np.atleast_2d, blocks))
    made = np.zeros([sum(sizes) for sizes in zip(*(block.shape for block in blocks), strict=True)])
    row = column = 0
    for block in blocks:
        rows, columns = block.shape
        made[row : row + rows, column : column + columns] = block
        row, column = row + rows, column + columns
    return made
