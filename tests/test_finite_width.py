"""The correction of plane stress for the widths of the shoes: how near it comes to solid shoes."""

import json
import math

import numpy as np
import pytest

import drumlin as package
from command_line import drumlin
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.texts import error_text_in_percent
from drumlin.brake.file import read_brake, vary
from drumlin.brake.plane_brake import read_drum_or_plane_brake
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.error_control.singular_points import singular_points_of_each_shoe_shape
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.solve import solve
from drumlin.fem.width import error
from drumlin.fem.width.correction import (
    pressure_of_shoe_zero_outside_contact,
    shoe_response_corrected_for_widths,
)
from drumlin.fem.width.error import (
    coarse_solutions_with_and_without_shoe_width,
    relative_distance_of_plane_stress_from_width_solution,
)
from drumlin.fem.width.prepare import prepare_model_with_shoe_widths
from drumlin.response.balance import relative_imbalance_of_shoe
from drumlin.sweeps.cases import solve_case_without_raising
from drumlin.sweeps.file import sweep_from_file_data
from sections import t_section

LINE = "error of plane stress after the correction for the widths: "


def one_width(brake):
    return brake


def solid_answer(brake, plane, degree=5, level=REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1]):
    """The answer of shoes with their widths on the second level of the section."""
    points = singular_points_of_each_shoe_shape(
        brake, plane, error=level.pressure_error_due_to_column_size_ratio
    )
    return solve_prepared_model(
        prepare_model_with_shoe_widths(brake, level, degree, points), brake, start=plane
    )


def test_without_contraction_one_width_is_not_corrected(flexible):
    changes = {"shoe.lining.material.nu": 0.0, "shoe.body.material.nu": 0.0}
    brake = vary(flexible, changes)
    plane, found = solve(brake), solve(brake, finite_width=True)
    assert (
        max(
            relative_distance_of_plane_stress_from_width_solution(
                brake, plane, found
            ).brake.values()
        )
        < 1e-9
    )
    assert max(found.plane_stress_error.brake.values()) < 1e-9


def test_on_equal_sections_it_is_the_answer_with_the_widths(flexible):
    brake = t_section(flexible)
    answers = coarse_solutions_with_and_without_shoe_width(brake, solve(brake, elements=12))
    for i, (plane, wide) in enumerate(zip(*(each.shoes for each in answers), strict=True)):
        found = shoe_response_corrected_for_widths(brake, i, plane, answers)
        assert plane.torque != pytest.approx(wide.torque, rel=1e-3)
        assert found.pressure == pytest.approx(wide.pressure, abs=1e-12 * wide.peak_pressure)
        for name in ("torque", "normal_force", "hinge_reaction", "peak_pressure"):
            assert getattr(found, name) == pytest.approx(getattr(wide, name), rel=1e-12)
        assert np.array(found.contact_arcs) == pytest.approx(np.array(wide.contact_arcs))


def test_beyond_the_contact_the_coarse_pressure_is_zero(flexible):
    """The polynomials of the coarse section oscillate beyond the end of the contact."""
    wide = coarse_solutions_with_and_without_shoe_width(
        flexible, solve(flexible, elements=12)
    ).wide.shoes[1]
    end = wide.contact_arcs[-1][1]
    beyond = np.linspace(end, wide.theta[-1], 50)[1:]
    assert np.abs(wide.pressure_at(beyond)).max() > 0
    assert not pressure_of_shoe_zero_outside_contact(wide, beyond).any()
    inside = np.linspace(wide.theta[0], 0.5 * (wide.theta[0] + end), 50)
    assert pressure_of_shoe_zero_outside_contact(wide, inside) == pytest.approx(
        wide.pressure_at(inside)
    )


@pytest.mark.slow
@pytest.mark.parametrize("section", [one_width, t_section])
def test_it_more_than_halves_the_error_and_states_what_remains(flexible, section):
    brake = section(flexible)
    plane, found = solve(brake), solve(brake, finite_width=True)
    true = solid_answer(brake, plane)
    without = relative_distance_of_plane_stress_from_width_solution(brake, plane, true).brake
    remaining = relative_distance_of_plane_stress_from_width_solution(brake, found, true).brake
    for name, size in remaining.items():
        stated = found.plane_stress_error.brake[name] + found.error[name]
        assert without[name] > 1e-3
        assert size < 0.5 * without[name], name
        assert size < stated, name
        assert found.plane_stress_error.brake[name] < without[name], name


@pytest.mark.slow
def test_the_balance_is_that_of_the_corrected_pressure(flexible):
    brake = t_section(flexible)
    found = solve(brake, finite_width=True)
    balances = [relative_imbalance_of_shoe(brake, i, shoe) for i, shoe in enumerate(found.shoes)]
    assert found.balance.force == max(each.force for each in balances)
    assert found.balance.moment == max(each.moment for each in balances)
    (note,) = [line for line in found.notes if line.startswith("corrected for the widths")]
    assert f"balances to {error_text_in_percent(found.balance.force)} (force)" in note
    assert not any("not quite as round" in line for line in found.notes)
    # The pressure and the torque are corrected one by one, but by the same two answers.
    assert 1e-9 < found.balance.force < 1e-3


@pytest.mark.slow
def test_a_solve_prints_what_remains_alone_and_with_the_error_of_the_mesh(root, tmp_path):
    file = root / "studies" / "plane_stress" / "brake.toml"
    done = drumlin("solve", file, "--finite-width", "--json", tmp_path / "a.json", "--verbose")
    assert done.returncode == 0, done.stderr
    text = " ".join(done.stdout.split())
    data = json.loads((tmp_path / "a.json").read_text())
    left, mesh = data["plane_stress_error"], data["error"]
    assert left["corrected"] is True
    assert left["peak"] is None
    assert f"{LINE}p {error_text_in_percent(left['pressure'])} (mean over the width)" in text
    both = error_text_in_percent(left["pressure"] + mesh["pressure"])
    assert f"with all inputs taken as exact: p {both}" in text
    assert "error of plane stress itself" not in text
    assert "corrected for the widths of the shoes: torque by " in text
    brake = read_brake(file)
    plane = solve(brake, model_error=True)
    assert data["torque"] == pytest.approx(solve(brake, finite_width=True).torque, rel=1e-9)
    assert data["torque"] != pytest.approx(plane.torque, rel=1e-3)
    for name in ("torque", "pressure", "reaction"):
        assert 0 < left[name] < plane.plane_stress_error.brake[name]
    assert "corrected" not in plane.plane_stress_error.as_dict()


@pytest.mark.parametrize(
    ("file", "reason"),
    [
        ("studies/post_brake/brake.toml", "its drum is an elastic ring"),
        ("meshes/double_shoe.toml", "it has a mesh of its own, which is drawn in the plane"),
    ],
)
def test_where_the_model_of_the_width_does_not_apply_it_is_refused(root, file, reason):
    said = f"--finite-width: does not apply to this brake: .*{reason}"
    with pytest.raises(BadInput, match=said):
        solve(read_drum_or_plane_brake(root / file), finite_width=True)


def test_where_the_coarse_section_has_no_answer_it_is_refused(brake, monkeypatch):
    def refuse(*_, **__):
        raise NoAnswer("no equilibrium")

    monkeypatch.setattr(error, "prepare_model_with_widths_on_given_elements", refuse)
    said = "--finite-width: the correction is not known: on a coarse section, .*no equilibrium"
    with pytest.raises(NoAnswer, match=said):
        solve(brake, elements=8, finite_width=True)


@pytest.mark.slow
def test_it_corrects_brakes_on_a_plane(root):
    brake = read_drum_or_plane_brake(root / "studies" / "brakes" / "rail_clamp.toml")
    plane, found = solve(brake), solve(brake, finite_width=True)
    assert found.effect == pytest.approx(plane.effect, rel=0.1)
    sizes = relative_distance_of_plane_stress_from_width_solution(brake, plane, found).brake
    assert sizes["pressure"] > found.plane_stress_error.brake["pressure"] > 1e-5


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"model_error": False}, "model_error=False: finite_width states the error that remains"),
        ({"worn_in": True}, "finite_width: does not apply to worn-in linings"),
    ],
)
def test_options_that_contradict_it_are_refused(brake, options, said):
    with pytest.raises(BadInput, match=said):
        package.solve(brake, finite_width=True, **options)


def test_the_option_belongs_to_the_finite_elements_and_to_answers(root):
    file = root / "studies" / "double_shoe" / "brake.toml"
    done = drumlin("solve", file, "--model", "sine", "--finite-width")
    assert done.returncode == 2
    assert "--finite-width and --fields belong to --model fem" in " ".join(done.stderr.split())
    for command in ("wear", "hold", "sensitivity"):
        done = drumlin(command, file, "--finite-width")
        assert done.returncode == 2
        assert "--finite-width" in done.stderr
        assert done.stderr.count("\n") == 1


@pytest.mark.slow
def test_a_comparison_takes_the_option_and_draws_plane_stress(root, flexible, tmp_path):
    file = root / "studies" / "double_shoe" / "flexible.toml"
    done = drumlin(
        "compare", file, "--elements", "8", "--finite-width", "--output", tmp_path / "report"
    )
    assert done.returncode == 0
    assert "fem: corrected for the widths" in " ".join(done.stdout.split())
    (case,) = json.loads((tmp_path / "report" / "results.json").read_text())["cases"]
    (torque,) = [model["torque"] for model in case["models"] if model["model"] == "fem"]
    assert torque == pytest.approx(solve(flexible, elements=8, finite_width=True).torque)
    assert (tmp_path / "report" / "fields.svg").is_file()


@pytest.mark.slow
def test_a_sweep_takes_the_option_and_states_what_remains(root, flexible):
    file = str(root / "studies" / "double_shoe" / "flexible.toml")
    options = {"elements": 8, "finite_width": True}
    (case,) = sweep_from_file_data(
        {"brake": file, "model": {"fem": options}, "vary": {"friction": [0.2]}}
    ).cases
    row = solve_case_without_raising(case).row
    want = solve(vary(flexible, {"friction": 0.2}), elements=8, finite_width=True)
    assert row["torque"] == pytest.approx(want.torque, rel=1e-12)
    left = want.plane_stress_error.brake["torque"]
    assert row["plane_stress_error_torque"] == pytest.approx(left, rel=1e-6)
    assert math.isfinite(left)
