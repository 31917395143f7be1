"""The double-shoe study in its short setting: headline numbers, files, and its report."""

import csv
import json

import pytest

import independent
from drumlin.report import render
from picking import having

pytestmark = pytest.mark.slow
STUDY_NAME = "double_shoe"


def test_headline_numbers(result):
    """The study's headline numbers: the published law against an independent discretisation.

    The rotation does not matter by symmetry.
    """
    law = {
        (row["case"], row["rotation"]): row["torque_error"]
        for comparison in result.comparisons
        for row in comparison.rows
        if row["model"] == "sine" and row["shoe"] == "all"
    }
    assert len(law) == 4
    for case, file in (("stiff shoes", "brake"), ("flexible shoes", "flexible")):
        expected = independent.SINE_LAW / independent.torque(f"double_shoe/{file}") - 1
        both = [law[case, "counter-clockwise"], law[case, "clockwise"]]
        assert both[0] == pytest.approx(both[1], abs=1e-8)
        # These are the torques of 40 elements and of the independent mesh.
        assert both[0] == pytest.approx(expected, abs=2e-4)
    for row in result.limit:
        assert abs(row["difference"]) < 3e-3
    assert len(result.limit) - len(having(result.limit, shoe="all")) == 4


def test_most_of_the_lining_is_in_contact_in_the_main_variant(result):
    for comparison in result.comparisons[:2]:
        for shoe in comparison.responses["fem"].shoes:
            touching = sum(b - a for a, b in shoe.contact_arcs)
            assert touching > 0.95 * (shoe.theta[-1] - shoe.theta[0])


def test_the_report_holds_every_number_and_the_files(module, result, tmp_path):
    text = module.report(result, tmp_path).read_text()
    for word in (
        "Rigid limit",
        "Convergence",
        "observed order",
        "fields.vtu",
        "Simscape",
        "scikit-fem",
        "out",
    ):
        assert word in text
    with (tmp_path / "results.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 4 * 2 * 3
    data = json.loads((tmp_path / "results.json").read_text())
    assert len(data["cases"]) == 4
    assert {"rigid_limit", "convergence", "torque_limit", "cost", "versions"} <= set(data)
    assert (tmp_path / "fields.vtu").stat().st_size > 10_000
    assert "a fault" not in text
    # A white page has some 9 kB.
    assert (tmp_path / "fields.png").stat().st_size > 20_000
    assert (tmp_path / "fields_vtk.png").stat().st_size > 20_000
    assert (tmp_path / "fields.svg").read_text().count("<image") >= 1


def test_without_off_screen_rendering_the_report_says_so_and_goes_on(
    module, result, tmp_path, monkeypatch
):
    monkeypatch.setattr(render.sys, "executable", "/bin/false")
    text = module.report(result, tmp_path).read_text()
    assert "off-screen rendering is not possible here" in text
    assert not (tmp_path / "fields_vtk.png").exists()
    assert (tmp_path / "fields.vtu").exists()
