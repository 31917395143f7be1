"""The paper: its length and sections, and the agreement of its numbers with the kept reports."""

import importlib
import json
import re

import pytest
import yaml

import drumlin
from conftest import ROOT
from drumlin.base.errors import BadInput
from drumlin.base.texts import number_as_text
from drumlin.studies import import_study_and_find_folder_above_studies
from kept_reports import rows
from picking import keyed, picked

study = import_study_and_find_folder_above_studies("paper")[0]
markdown = importlib.import_module("studies.paper.markdown")
PARTS = [
    "Summary",
    "Statement of need",
    "State of the field",
    "How it works",
    "How it is checked",
    "What it has shown",
    "Honest limits",
    "Availability",
    "References",
]


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    return study.report(study.study(), tmp_path_factory.mktemp("paper")).read_text()


@pytest.fixture(scope="module")
def text(page):
    """The text of the paper between its title and its references."""
    inside = re.search(r"<main>(.*?)</main>", page, re.DOTALL)[1]
    return re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", inside))


def test_it_has_its_parts_and_its_length(page, text):
    assert re.findall(r"<h2[^>]*><a[^>]*>(.*?)</a></h2>", page) == PARTS
    assert 750 <= len(text.split()) <= 1750


def test_every_source_that_is_named_is_listed_and_no_other(page, text):
    named = {
        (found[0], found[2])
        for found in re.findall(r"([A-Z]\w+)( and [A-Z]\w+)? \(?(\d{4})\)", text)
    }
    # The page says "Archard's law (1953)", which the pattern misses.
    named.add(("Archard", "1953"))
    listed = set(re.findall(r"<p>([A-Z]\w+), .*?\((\d{4})\)", page[page.index("</main>") :]))
    assert named == listed and len(listed) == 7


def test_the_paper_for_a_journal_is_the_same_paper(page):
    kept = (ROOT / "studies" / "paper" / "paper.md").read_text(encoding="utf-8")
    assert kept == markdown.paper_as_markdown(page), "drumlin study paper; copy paper.md"
    assert kept.startswith("---\ntitle: ")
    assert 750 <= len(kept.split()) <= 1750
    sources = (ROOT / "studies" / "paper" / "paper.bib").read_text(encoding="utf-8")
    keys = set(re.findall(r"@\w+\{(\w+),", sources))
    assert set(re.findall(r"\[@(\w+)\]", kept)) == keys
    assert len(keys) == 7
    assert re.findall(r"(?m)^# (.*)$", kept) == PARTS
    assert not re.search(r"[<{]|\(\d{4}\)", kept.partition("---\n")[2])
    assert re.search(r"\| accuracy \| brakes .* \|\n\| --- \| --- \|\n\| 5 % of the torque", kept)


def percent(value, form):
    return number_as_text(float(value), form)


def test_its_numbers_are_those_of_the_kept_reports(text):
    made = rows("double_shoe/results.csv", rotation="counter-clockwise", model="sine")
    total = {row["case"]: row["torque_error"] for row in made if row["shoe"] == "all"}
    assert f"total torque is off by {percent(total['stiff shoes'], '+.1%')}" in text
    assert (
        f"With flexible shoes the total is off by {percent(total['flexible shoes'], '+.0%')}"
        in text
    )
    law = rows("error_vs_runtime/results.csv", model="sine", status="converged")
    errors = sorted(map(float, picked(law, "torque_error")))
    assert (
        f"of the sine law is wrong by {percent(errors[0], '.1%')} to {percent(errors[-1], '.0%')}"
        in text
    )
    all_brakes = {row["brake"] for row in rows("error_vs_runtime/recommended.csv")}
    # One brake has a friction that depends on the pressure, which the law does not take.
    assert len(law) < len(all_brakes)
    assert f"Over the {len(law)} of these {len(all_brakes)} brakes to which it applies" in text
    best = rows("error_vs_runtime/recommended.csv", family="law")
    for words, quantity, target in (
        ("5 % of the torque", "torque", "0.05"),
        ("0.1 % of the torque", "torque", "0.001"),
        ("5 % of the pressure", "p (L2)", "0.05"),
    ):
        count = sum((row["quantity"], row["target"]) == (quantity, target) for row in best)
        assert f"{words} {count} " in text
    half = rows(
        "error_vs_runtime/recommended.csv",
        brake="double_shoe/brake",
        quantity="p (L2)",
        target="0.005",
    )[0]
    assert (
        f"compute the pressure to half a percent in {1e3 * float(half['seconds']):.0f} ms" in text
    )
    flexible = rows("run_in/brakes.csv", brake="double_shoe/flexible", model="fem")[0]
    life = f"{float(flexible['pressure_life']):.2f} times the life of the lining"
    assert f"takes {life}, so that the brake never reaches the law" in text
    assert float(flexible["pressure_life"]) > 1
    post = keyed(rows("post_brake/results.csv", case="fits", shoe="all"), "model")
    assert (
        f"is off by {percent(post['sine']['torque_error'], '+.0%')}. The torque of the published"
        in text
    )
    lifted = percent(post["lifted"]["torque_error"], "+.1%")
    assert f"torque of the foundation model is off by {lifted}" in text
    solid = rows("plane_stress/errors.csv", case="T-section", shoe="leading")[0]
    assert f"off by {percent(solid['torque'], '+.1%')} only" in text


def test_a_missing_report_is_said(monkeypatch, tmp_path):
    monkeypatch.setattr(study, "KEPT", tmp_path)
    with pytest.raises(
        BadInput, match=r"double_shoe/results\.csv: the paper quotes it, and it is missing"
    ):
        study.study()


def test_the_metadata_agree():
    citation = (ROOT / "CITATION.cff").read_text()
    project = (ROOT / "pyproject.toml").read_text()
    assert "license: BSD-3-Clause" in citation and 'license = "BSD-3-Clause"' in project
    assert "The drumlin developers" in citation and "The drumlin developers" in project
    assert (ROOT / "LICENSE").read_text().startswith("BSD 3-Clause License")


def test_the_other_programs_take_as_long_as_readme_says(text):
    """README and the paper have the same ratios of times."""
    readme = re.sub(r"\s+", " ", (ROOT / "README.md").read_text(encoding="utf-8"))
    half, slow = re.search(
        r"\| 0\.5 % \| [\d.]+ ms \| ([\d.]+) times as long \| (\d+) times as long", readme
    ).groups()
    (fine,) = re.search(r"\| 0\.1 % \| [\d.]+ ms \| ([\d.]+) times as long", readme).groups()
    (more,) = re.search(r"further load case \| [\d.]+ ms \| ([\d.]+) times", readme).groups()
    assert f"GetFEM takes {half} times as long as drumlin," in text
    assert f"started for each solution, some {slow} times." in text
    assert f"To a tenth of a percent GetFEM takes {fine} times as long, and {more} times" in text


def test_an_archive_reads_the_citation():
    """CITATION.cff and the file of Zenodo say the same, with the keys that both must have."""
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    archive = json.loads((ROOT / ".zenodo.json").read_text())
    for key in ("title", "version", "license", "keywords"):
        assert archive[key] == citation[key]
    assert archive["creators"] == citation["authors"]
    assert archive["description"] == citation["abstract"].strip()
    assert (archive["upload_type"], citation["type"]) == ("software", "software")
    assert citation["cff-version"] == "1.2.0" and citation["message"]
    assert citation["version"] == drumlin.__version__
