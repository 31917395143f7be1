"""The study of sweeps on its short setting."""

import os

import pytest

from drumlin.studies import import_study_and_find_folder_above_studies
from drumlin_studies import throughput
from picking import picked

pytestmark = pytest.mark.slow


def test_throughput_and_kill(tmp_path):
    module, _ = import_study_and_find_folder_above_studies("sweeps")
    result = module.study(short=True)
    assert result.same and result.killed_same
    assert picked(result.measured[module.SHARED], "workers") == [1, 2]
    assert picked(result.sampled, "workers") == [1, 2]
    for row in result.sampled:
        # Three drawn cases and the extremes of five keys leave at most one of four cases.
        assert row["cases"] == 4 and row["itself"] >= 3 and 0 <= row["distance"] < 1
    for kill in result.kills:
        assert 0 <= kill.found < kill.left < 100
    errors = picked(result.meshes, "error")
    assert 1e-9 < errors[1] < errors[0] < 1e-2
    text = module.report(result, tmp_path).read_text()
    assert "the very same" in text and "DIFFERENT" not in text
    assert (tmp_path / "loads.csv").read_text().count("\n") == 61


def test_what_dask_puts_into_the_environment_does_not_outlive_it(monkeypatch):
    monkeypatch.setenv("KEPT", "1")
    before = dict(os.environ)
    with (
        pytest.raises(RuntimeError),
        throughput._set_environment_variables({"MALLOC_TRIM_THRESHOLD_": "1"}),
    ):
        assert os.environ["MALLOC_TRIM_THRESHOLD_"] == "1"
        os.environ["OMP_NUM_THREADS"] = "77"
        del os.environ["KEPT"]
        raise RuntimeError
    assert dict(os.environ) == before
