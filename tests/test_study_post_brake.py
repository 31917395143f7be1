"""The post brake's study on its short setting: what it found, its tables and its report."""

import json
import math

import numpy as np
import pytest

from drumlin import foundation
from picking import keyed, picked

pytestmark = pytest.mark.slow
STUDY_NAME = "post_brake"


def test_lifting_brings_the_foundation_model_to_the_finite_elements(result):
    rows = keyed(result.lifts, "lift")
    assert set(rows) == {"none (the paper)", "all", *foundation.INCLUDABLE_EFFECTS}
    # The printed model is off by a third, and the page says so in words.
    assert 0.25 < rows["none (the paper)"]["error"] < 0.45
    assert abs(rows["all"]["error"]) < 0.02
    assert max(abs(rows["all"]["error_right"]), abs(rows["all"]["error_left"])) < 0.06
    single = {
        name: rows["none (the paper)"]["error"] - rows[name]["error"]
        for name in foundation.INCLUDABLE_EFFECTS
    }
    assert max(single, key=single.get) == "own-pressure"
    law = result.comparison.responses["sine"].torque / result.comparison.responses["fem"].torque - 1
    # The law is off, by less than the printed model.
    assert 0.1 < law < rows["none (the paper)"]["error"]


def test_where_the_assumptions_hold_the_models_agree_and_the_error_grows_as_they_are_left(result):
    rows = {row["case"].split(":")[0]: row for row in result.assumptions}
    assert len(rows) == len(result.assumptions) == 11
    met = rows["all met"]
    assert max(abs(met["foundation"]), abs(met["tilt"]), abs(met["lifted"])) < 0.02
    printed = [
        rows[case]["foundation"]
        for case in ("all met", "60 deg of arc", "80 deg of arc", "the brake of this study")
    ]
    assert printed == sorted(printed)
    assert abs(rows["80 deg of arc"]["tilt"]) < 0.02
    assert rows["80 deg of arc"]["foundation"] > 0.05


def test_a_worn_in_lining_brings_the_torque_back_to_nominal(result):
    off = keyed(result.clearances, ("case", "model", "shoe"), "from_nominal")
    assert len(off) == len(result.clearances) == 6 * 2 * 2
    for shoe in ("right", "left"):
        assert abs(off["worn in", "foundation, unsimplified", shoe]) < 1e-4
        assert abs(off["worn in", "finite elements", shoe]) < 0.03
        assert off["fits", "finite elements", shoe] < -0.05


def test_the_map_has_every_region_and_the_corner_where_the_law_holds(result):
    law, printed, lifted = (np.abs(one.error) for one in result.maps[0])
    assert not np.isnan(law).any()
    assert law[0, 0] < 0.05
    assert law[-1, -1] > 0.20
    assert printed.max() > 0.20
    assert lifted.max() < 0.05
    assert (lifted < 0.01).any()


def test_grids_are_of_second_order(result):
    rows = [row for row in result.grids if row["n"] in {180, 360}]
    assert len(rows) == 2
    for row in rows:
        assert [row["torque_ratio"], row["N_ratio"], row["psi_ratio"]] == pytest.approx(
            [4, 4, 4], abs=0.5
        )
    assert max(picked(result.grids, "steps")) <= 12
    assert keyed(result.grids, "n", "seconds")[360] < 0.1


def test_the_report_holds_its_figures_and_its_numbers(module, result, tmp_path):
    text = module.report(result, tmp_path).read_text()
    assert text.count("data:image/svg+xml") == 9
    for word in ("worn in", "own-pressure", "k R⁴/EI", "second order"):
        assert word in text
    data = json.loads((tmp_path / "results.json").read_text())
    assert {"lifts", "clearances", "assumptions", "grids", "offsets", "merits", "maps"} <= set(data)
    assert len(data["maps"]) == 6
    S = [values[0] for values in data["merits"]["right"]["fem"]]
    assert sorted(S) == S
    assert len(S) == 4
    assert all(
        math.isfinite(error) for one in data["maps"] for line in one["error"] for error in line
    )
