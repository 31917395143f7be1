"""The study of heat on its short setting."""

import pytest

from drumlin.studies import import_study_and_find_folder_above_studies


@pytest.mark.slow
def test_the_page_has_every_state_and_the_law(tmp_path):
    module, _ = import_study_and_find_folder_above_studies("heat")
    result = module.study(short=True)
    assert list(result.responses) == ["cold", "drum", "linings", "bodies", "all parts"]
    torque = {name: response.torque for name, response in result.responses.items()}
    # A hot drum grows away from its linings, and hot linings bear in their middle.
    assert torque["drum"] < torque["cold"] and torque["all parts"] < torque["cold"]
    peaks = {
        name: max(shoe.peak_pressure for shoe in response.shoes)
        for name, response in result.responses.items()
    }
    assert peaks["drum"] > peaks["cold"]
    text = module.report(result, tmp_path).read_text()
    assert f"{result.law.torque:.0f} N m for both brakes" in text
    assert (tmp_path / "pressure.svg").stat().st_size > 20_000
    assert (tmp_path / "results.csv").read_text().count("\n") == 6
