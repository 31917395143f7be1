"""Benchmarks: their measurement, the file with their history, and its display in the manual."""

import json
import math

import pytest

from conftest import ROOT
from drumlin.studies import import_study_and_find_folder_above_studies
from drumlin_studies import benchmarks
from picking import picked

import_study_and_find_folder_above_studies("manual")

from studies.manual import history  # noqa: E402


@pytest.fixture(scope="module")
def measured():
    """A measurement of the run time of one brake with few repeats."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(benchmarks, "EXAMPLES_WITH_TIMED_DEFAULT_SOLVE", ("double_shoe",))
        patch.setattr(benchmarks, "EXAMPLES_WITH_COUNTED_UNKNOWNS_AND_ITERATIONS", ("double_shoe",))
        return benchmarks.measure_all_benchmarks(repeats=1)


@pytest.mark.slow
def test_the_command_appends_a_line(measured, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(benchmarks, "measure_all_benchmarks", lambda repeats: measured)
    path = tmp_path / "new" / "history.jsonl"
    benchmarks.main(str(path), "1")
    benchmarks.main(str(path), "1")
    assert benchmarks.read_benchmark_history(path) == [measured, measured]
    first, second = path.read_text().splitlines()
    assert first == second == capsys.readouterr().out.splitlines()[0]
    assert set(json.loads(first)) == {"commit", "date", "figures"}


@pytest.mark.slow
def test_figures_are_ratios_in_their_range(measured):
    figures = measured.figures
    for value in figures.values():
        assert math.isfinite(value) and value > 0
    assert figures["sine law"] < figures["solve double_shoe"] < figures["sensitivity"]
    assert figures["import drumlin"] < figures["command init"] < figures["command solve"]
    unit = "default solves: "
    assert figures[f"{unit}sweep by sample"] < figures[f"{unit}sweep in full"]
    assert figures[f"{unit}post on a ring"] < figures[f"{unit}post on a ring to 0.01 %"]
    assert figures[f"{unit}ring with 8 shoes"] < figures[f"{unit}ring with 12 shoes"]
    assert figures["command solve"] < figures["command compare"]
    assert figures["unknowns double_shoe"] > 1000
    assert figures["iterations double_shoe"] == int(figures["iterations double_shoe"]) >= 1


def test_a_ratio_is_the_median_of_neighbours():
    """If the machine is slow during a repeat, both times double and their ratio is the same."""
    timed = iter([2.0, 4.0, 2.0, 9.0, 2.0])
    compared = iter([1.0, 2.0, 1.0, 1.0, 1.0])
    assert (
        benchmarks.median_ratio_of_times_returned_by_two_functions(
            lambda: next(timed), lambda: next(compared), 5
        )
        == 2.0
    )


def test_a_changed_source_is_marked(monkeypatch):
    answers = {"status": " M src/drumlin/door.py", "rev-parse": "1234567"}
    monkeypatch.setattr(benchmarks, "output_of_git_command", lambda *words: answers[words[0]])
    assert benchmarks.short_commit_hash() == "1234567+"
    answers["status"] = ""
    assert benchmarks.short_commit_hash() == "1234567"


def test_the_kept_history_is_whole():
    kept = benchmarks.read_benchmark_history()
    assert kept
    assert len(kept[-1].figures) >= 15
    dates = picked(kept, "date")
    assert dates == sorted(dates)
    for line in kept:
        for value in line.figures.values():
            assert value > 0
    assert "benchmarks" in (ROOT / "Makefile").read_text()


def test_every_figure_is_in_the_table_and_in_one_panel():
    kept = benchmarks.read_benchmark_history()
    other = kept[-1]._replace(commit="abcdef0", figures={**kept[-1].figures, "hold": 1.0})
    rows = [*kept, other]
    table = history.history_table(rows)
    panels = history.draw_history(rows).axes
    labels = [str(line.get_label()) for axes in panels for line in axes.get_lines()]
    assert sorted(labels) == sorted(other.figures)
    for name in other.figures:
        assert f"| {name} |" in table
    assert "abcdef0" in table
