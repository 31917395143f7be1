"""The verification study on its short setting."""

import pytest

from drumlin.studies import import_study_and_find_folder_above_studies
from picking import having, picked

pytestmark = pytest.mark.slow


def test_orders_and_estimates(tmp_path):
    module, _ = import_study_and_find_folder_above_studies("verification")
    result = module.study(short=True)
    assert len(result.orders) == 2 * 4 * 3
    assert len(result.estimates) == 2 * 2
    whole = having(result.orders, case="whole lining in contact")
    errors = {row["kind"]: row["pressure"] for row in whole if row["elements"] == 40}
    assert errors["quad2"] < errors["quad1"] < errors["tri1"]
    for row in result.estimates:
        assert row["status"].startswith("converged")
        assert row["estimate"] <= row["tolerance"]
        assert row["true"] < 1.5 * row["tolerance"]
    assert picked(result.judged, "seed") == list(range(module.JUDGED, module.JUDGED + module.FEW))
    reached = having(result.judged, outcome="reached")
    assert len(reached) >= 2 and all(row["true_pressure"] < 1e-2 for row in reached)
    assert all(row["reason"] for row in result.judged if row not in reached)
    text = module.report(result, tmp_path).read_text()
    assert "Observed orders" in text and "estimate over truth" in text
    assert (
        "true above stated" in text
        and (tmp_path / "stated_true.csv").read_text().count("\n") == module.FEW + 1
    )
    assert picked(result.corners, "tolerance") == [5e-3, 1e-3, 1e-4]
    assert "Corners and tips" in text and (tmp_path / "corners.csv").is_file()
    assert "Benchmark ladder" in text and "failed: outside" not in text
