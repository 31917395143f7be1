"""Mutated sweep files are read or refused in one line; `python tests/sweep_faults.py 2000` tries
more of them.
"""

import pytest

import sweep_faults


@pytest.mark.parametrize(
    "seeds", [range(n, n + 25) for n in range(0, 150, 25)], ids=lambda seeds: seeds.start
)
def test_mutated_sweep_files_end_in_a_line(seeds, tmp_path):
    assert [(seed, said) for seed in seeds if (said := sweep_faults.fault(seed, tmp_path))] == []
