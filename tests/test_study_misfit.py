"""The misfit study in its short setting: findings, continuation after a stop, and report."""

import numpy as np
import pytest

import independent
from conftest import STUDY
from drumlin.base.journal import JournalOfCaseResults
from drumlin.brake.file import read_brake
from drumlin_studies.misfit_rows import rows_with_mean_and_percentiles_of_quantities
from picking import keyed, picked

pytestmark = pytest.mark.slow
STUDY_NAME = "misfit"


@pytest.fixture(scope="module")
def journal():
    return JournalOfCaseResults()


@pytest.fixture(scope="module")
def result(module, journal):
    return module.study(short=True, journal=journal)


def by_another_mesh(larger):
    """Change of the torque by linings ground to a radius larger by an amount [m].

    To first order in the gap.
    """
    brake = read_brake(STUDY / "brake.toml")
    torques = []
    for i, shoe in enumerate(brake.shoes):
        gap = lambda theta, middle=shoe.lining.middle: -larger * (1 - np.cos(theta - middle))  # noqa: E731
        torques.append(independent.solve(brake, i, 45, 1e4, gap)[0])
    return sum(torques) / independent.torque("double_shoe/brake") - 1


def test_some_hundredths_of_a_millimetre_change_the_torque_by_tens_of_per_cent(result):
    off = keyed(result.single, "misfit", "from_fit")
    assert off["fits"] == 0
    for words, larger in (("larger", 5e-5), ("smaller", -5e-5)):
        assert off[f"linings 50 µm {words} in radius"] == pytest.approx(
            by_another_mesh(larger), abs=1e-3
        )
    assert min(off.values()) > -0.2
    ratio = result.ratios["torque"]
    # The middle of the map is the fitting lining.
    assert ratio[2, 3] == pytest.approx(result.single[0]["from_law"], abs=1e-3)
    assert (np.diff(ratio[-1]) > 0).all() and (np.diff(ratio[:, -1]) > 0).all()


def test_run_in_heals_every_misfit_but_not_the_drum(result, module):
    assert result.healed["torque"][:, -1] == pytest.approx(law_torques(result, module), rel=3e-3)
    first, last = np.ptp(result.healed["torque"][:, 0]), np.ptp(result.healed["torque"][:, -1])
    assert last < 0.6 * first
    worn = keyed(result.shares["worn in"]["torque"], "name", "total.value")
    for name, value in worn.items():
        assert value < 1e-6 or not any(word in name for word in ("radius", "centre", "taper")), name
    assert max(worn, key=worn.get).startswith("where the oval drum stands")
    for name in ("run-out", "oval"):
        assert np.ptp(result.turns["worn in"][name]) > 0.5 * np.ptp(result.turns["new"][name])


def law_torques(result, module):
    """The sine law's torque of the brakes that were worn in."""
    return picked(result.rows["law"][: len(result.healed["torque"])], "torque")


def test_a_second_run_computes_no_case_again(result, module, journal, monkeypatch):
    kept = len(journal)
    assert kept > 300
    monkeypatch.setattr(
        module,
        "torque_and_peak_during_run_in",
        lambda *_, **__: pytest.fail("computed again"),
    )
    monkeypatch.setattr(
        "drumlin.sweeps.cases.solve_case_without_raising",
        lambda *_, **__: pytest.fail("computed again"),
    )
    again = module.study(short=True, journal=journal)
    assert len(journal) == kept
    assert again.rows == result.rows
    assert again.shares == result.shares


def test_the_report_says_it_in_numbers(result, module, tmp_path):
    page = module.report(result, tmp_path).read_text()
    assert (
        "What the law's user has to assume" in page
        or "What the law&#39;s user has to assume" in page
    )
    assert page.count("data:image/svg+xml") == 6
    assert (tmp_path / "cases_new.csv").read_text().count("\n") == 1 + len(result.rows["new"])
    quantities = keyed(
        rows_with_mean_and_percentiles_of_quantities(result.drawn), ("quantity", "state")
    )
    new, worn, law = (
        quantities["torque [N m]", state]["relative"] for state in ("new", "worn in", "sine law")
    )
    assert new > worn > law
