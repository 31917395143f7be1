"""Routines of LAPACK and BLAS for systems of linear equations, and a triangular solve.

Other modules of drumlin import these routines of scipy from this module.
"""

import numpy as np
from scipy.linalg import block_diag
from scipy.linalg.blas import dgemm, dsyrk, dtrsm
from scipy.linalg.lapack import dgecon, dgetrf, dgetrs, dpotrf, dtrtrs

from drumlin.base.arrays import Floats

__all__ = [
    "block_diag",
    "dgecon",
    "dgemm",
    "dgetrf",
    "dgetrs",
    "dpotrf",
    "dsyrk",
    "dtrsm",
    "dtrtrs",
    "solve_lower_triangular_system",
]


def solve_lower_triangular_system(L: Floats, b: Floats, *, in_place: bool = False) -> Floats:
    """Solve L x = b for x, with a lower triangular matrix L (n, n) and b (n,) or (n, m).

    If `in_place` is True and b lies column by column in memory, x is written into b. Raises numpy's
    LinAlgError if L is singular.
    """
    x, info = dtrtrs(L, b, lower=1, overwrite_b=in_place)
    if info:
        raise np.linalg.LinAlgError(f"singular: no pivot in row {info}")
    return np.asarray(x).reshape(b.shape)
