"""Error and run time of all models against solid shoes."""

import pytest

from drumlin.response.response import Response
from drumlin.studies import import_study_and_find_folder_above_studies
from drumlin_studies.solid_work import (
    SettingsOfSolidComparisonSolves,
    measure_models_against_solid_shoes,
    relative_uncertainty_of_solid_shoe_reference,
    solve_and_measure_processor_time,
    solve_fine_reference_of_solid_shoes,
)
from picking import having

SETTING = SettingsOfSolidComparisonSolves(
    truth=2, levels=2, degrees=(2, 3), tolerances=(2e-2,), elements=()
)


@pytest.fixture(scope="module")
def measured(brake):
    truth = solve_fine_reference_of_solid_shoes(brake, SETTING.truth)
    rows = measure_models_against_solid_shoes(brake, SETTING, truth.response)
    return [row._asdict() for row in rows], relative_uncertainty_of_solid_shoe_reference(
        brake, truth
    )


@pytest.mark.slow
def test_plane_stress_is_exact_by_its_own_measure_and_not_by_the_solid(measured):
    rows, uncertain = measured
    last = having(rows, family="degree 0")[-1]
    assert last["plane_pressure"] < 1e-3
    assert 8e-3 < last["solid_pressure"] < 2e-2
    assert uncertain["pressure"] < 0.2 * last["solid_pressure"]


@pytest.mark.slow
def test_each_degree_across_the_width_is_nearer_to_the_solid(measured):
    rows, _ = measured
    errors = [having(rows, family=f"degree {q}")[-1]["solid_pressure"] for q in (0, 2, 3)]
    assert errors[0] > 3 * errors[1] > 3 * errors[2]
    (stated,) = having(rows, family="error stated")
    assert stated["solid_pressure"] < 2e-2
    # The laws of rigid shoes are far from both.
    assert min(row["solid_pressure"] for row in having(rows, family="law")) > 0.3


@pytest.mark.slow
def test_the_picture_has_a_curve_for_each_family(measured):
    module, _ = import_study_and_find_folder_above_studies("error_vs_runtime")
    rows, uncertain = measured
    figure = module.draw_error_against_solid(rows, uncertain)
    above, below = figure.axes
    assert len(above.get_lines()) == len(below.get_lines()) == len({r["family"] for r in rows})
    assert above.get_title(loc="left") == "compared with plane stress"


def test_the_time_of_a_solve_is_that_of_one_call():
    calls = []

    def solve_once():
        calls.append(1)
        return Response

    timed = solve_and_measure_processor_time(solve_once)
    assert timed.response is Response
    assert 0 <= timed.seconds < 1e-3
    assert len(calls) > 1
