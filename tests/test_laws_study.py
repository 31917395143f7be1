"""The study of the rigid-shoe laws, its report, and the drawing of every kind of brake."""

import json
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from matplotlib.figure import Figure

from drumlin.brake.plane_brake import read_drum_or_plane_brake
from drumlin.report.drawing import draw_brake
from drumlin.studies import import_study_and_find_folder_above_studies
from drumlin_studies.law_table import rows_of_shoe_factors_of_post_brake
from drumlin_studies.worked_examples import row_of_printed_and_computed_number
from picking import having, picked

STUDIES = Path(__file__).parent.parent / "studies"


@pytest.fixture(scope="module")
def laws() -> ModuleType:
    return import_study_and_find_folder_above_studies("laws")[0]


def test_study_meets_every_worked_example_and_names_the_two_that_were_printed_rounded(
    laws: ModuleType,
) -> None:
    result = laws.study(short=True)
    assert len(result.examples) == 41
    odd = [(row["source"], row["given"]) for row in result.examples if row["status"] != "agrees"]
    assert odd == [
        ("block on a lever, friction assists", "83.87"),
        ("block on a lever, friction opposes", "69.14"),
    ]
    assert all(
        abs(row["difference"]) < 3e-4 for row in result.examples if row["status"] != "agrees"
    )
    assert not having(result.applies, status="no answer")


def test_a_wrong_number_would_be_seen() -> None:
    assert (
        row_of_printed_and_computed_number("sine", "", "", "527.761", 527.7606)["status"]
        == "agrees"
    )
    assert (
        row_of_printed_and_computed_number("sine", "", "", "527.761", 527.7616)["status"]
        == "differs"
    )


def test_barecki_leading_post_has_the_smaller_shoe_factor_where_n_is_negative() -> None:
    rows = rows_of_shoe_factors_of_post_brake(
        read_drum_or_plane_brake(STUDIES / "post_brake/brake.toml")
    )
    assert len(rows) == 8
    for leading, trailing in zip(rows[::2], rows[1::2], strict=True):
        assert (leading["word"], trailing["word"]) == ("leading", "trailing")
        assert leading["S_26"] == pytest.approx(leading["S"], rel=1e-9)
        assert (leading["S_26"] < trailing["S_26"]) == (leading["n"] < 0)
    assert {row["law"]: row["n"] < 0 for row in rows} == {
        "short": True,
        "cosine": True,
        "uniform": True,
        "sine": False,
    }


@pytest.mark.slow
def test_report_is_one_page_with_every_law(laws: ModuleType, tmp_path: Path) -> None:
    text = laws.report(laws.study(short=True), tmp_path).read_text()
    for heading in (
        "Short shoe",
        "Long shoe on a plane",
        "Long shoe turning about its hinge: the sine law",
        "Double-shoe block of Simscape",
        "Block on a lever: p = p₀ cos",
        "Shoe on a pivot at the end of a lever",
        "Uniform pressure",
        "Leading and trailing: whose word means what",
    ):
        assert f">{heading}</a></h2>" in text
    assert text.count("data:image/svg+xml") == 9
    assert '<img src="http' not in text
    assert text.count("<b>Assumes</b>") == 7
    assert len(json.loads((tmp_path / "results.json").read_text())["examples"]) == 41


BRAKES = sorted([*STUDIES.glob("laws/*.toml"), *STUDIES.glob("*/brake.toml")])
BRAKES = [path for path in BRAKES if path.name != "examples.toml"]


def test_there_are_brakes_of_every_kind_to_draw() -> None:
    assert len(BRAKES) >= 11


@pytest.mark.parametrize("path", BRAKES, ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_every_brake_is_drawn_with_its_pins_inside_the_picture(path: Path) -> None:
    brake = read_drum_or_plane_brake(path)
    axes = Figure().subplots()
    draw_brake(axes, brake)
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    if not brake.surface.is_plane_and_not_drum:
        assert min(-left, right, -low, high) > brake.size * 1e3
    for shoe in brake.shoes:
        x, y = shoe.hinge.xy * 1e3
        assert left < x < right
        assert low < y < high
    words = {text.get_text() for text in axes.texts}
    assert set(picked(brake.shoes, "name")) <= words
    assert any(word.removesuffix(" each").endswith("N") for word in words)
    assert axes.get_aspect() == 1.0
    for line in axes.lines:
        assert np.isfinite(line.get_xydata()).all()
