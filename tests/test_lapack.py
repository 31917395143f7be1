"""The compiled routines of scipy.linalg without the rest of it: the same, in value and where they are missing."""

import subprocess
import sys

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given
from hypothesis import strategies as st

from drumlin import lapack


def test_the_routines_are_those_of_scipy():
    rng = np.random.default_rng(3)
    A, b = rng.random((7, 7)), rng.random((7, 3))
    for name, arguments in (
        ("dgetrf", (A,)), ("dgetrs", (*scipy.linalg.lapack.dgetrf(A)[:2], b)), ("dpotrf", (A @ A.T,)),
        ("dtrtrs", (A, b)), ("dgecon", (scipy.linalg.lapack.dgetrf(A)[0], 1.0)),
    ):  # fmt: skip
        ours, theirs = getattr(lapack, name)(*arguments), getattr(scipy.linalg.lapack, name)(*arguments)
        assert all(np.array_equal(one, other) for one, other in zip(ours, theirs, strict=True)), name
    for name, arguments in (("dtrsm", (2.0, A, b)), ("dgemm", (2.0, A, b))):
        assert np.array_equal(getattr(lapack, name)(*arguments), getattr(scipy.linalg.blas, name)(*arguments)), name


def test_where_a_compiled_module_has_another_name_the_public_one_stands_in():
    assert lapack.compiled("_nowhere", "lapack") is scipy.linalg.lapack


@pytest.mark.parametrize("shape", [(6,), (6, 1), (6, 4)])
def test_a_lower_triangle_is_solved(shape):
    rng = np.random.default_rng(5)
    L, b = np.tril(rng.random((6, 6))) + np.eye(6), rng.random(shape)
    x = lapack.solve_lower(L, b)
    assert x.shape == shape
    assert L @ x == pytest.approx(b, abs=1e-12)
    with pytest.raises(np.linalg.LinAlgError, match="row 3"):
        lapack.solve_lower(np.diag([1.0, 1.0, 0.0, 1.0, 1.0, 1.0]), b)


@given(st.lists(st.one_of(st.integers(1, 4), st.tuples(st.integers(0, 4), st.integers(0, 4))), min_size=1, max_size=5))
def test_blocks_stand_along_the_diagonal(shapes):
    rng = np.random.default_rng(7)
    blocks = [rng.random(shape) for shape in shapes]
    assert np.array_equal(lapack.block_diag(*blocks), scipy.linalg.block_diag(*blocks))


def test_it_loads_before_or_after_scipy_linalg():
    """In a process of its own, where drumlin comes first."""
    code = (
        "import sys, drumlin.lapack as ours\n"
        "assert not {'scipy.linalg', 'numpy.f2py', 'numpy.testing'} & set(sys.modules), 'too much is loaded'\n"
        "import scipy.linalg.lapack as theirs, scipy.linalg, numpy as np\n"
        "assert ours.dgetrf is theirs.dgetrf\n"
        "assert scipy.linalg.solve(np.eye(2), np.ones(2)).tolist() == [1, 1]"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)
