"""The solution of triangular systems by LAPACK agrees with that by scipy's public function."""

import numpy as np
import pytest

from drumlin.base.lapack import solve_lower_triangular_system


@pytest.mark.parametrize("shape", [(6,), (6, 1), (6, 4)])
def test_a_lower_triangle_is_solved(shape):
    rng = np.random.default_rng(5)
    L, b = np.tril(rng.random((6, 6))) + np.eye(6), rng.random(shape)
    x = solve_lower_triangular_system(L, b)
    assert x.shape == shape
    assert L @ x == pytest.approx(b, abs=1e-12)
    with pytest.raises(np.linalg.LinAlgError, match="row 3"):
        solve_lower_triangular_system(np.diag([1.0, 1.0, 0.0, 1.0, 1.0, 1.0]), b)
