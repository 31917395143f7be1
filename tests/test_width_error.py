"""The error of plane stress itself: how near it is to the true one, and where it is stated."""

import json
import math

import numpy as np
import pytest

import drumlin as package
from command_line import drumlin
from drumlin.brake.file import vary
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.error_control.singular_points import singular_points_of_each_shoe_shape
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin.fem.width.error import (
    estimate_error_of_plane_stress,
    relative_distance_of_plane_stress_from_width_solution,
)
from drumlin.fem.width.prepare import prepare_model_with_shoe_widths
from drumlin.sweeps.cases import results_of_response_by_name
from drumlin_studies.random_brake import draw_random_brake
from sections import t_section

LINE = "error of plane stress itself: "


def true_error(brake, degree=4):
    """The error of plane stress on a section of the first level, whose own error cancels."""
    start = solve(brake)
    points = singular_points_of_each_shoe_shape(brake, start)
    plane = solve_prepared_model(
        make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], points),
        brake,
        start=start,
    )
    wide = solve_prepared_model(
        prepare_model_with_shoe_widths(
            brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], degree, points
        ),
        brake,
        start=start,
    )
    return relative_distance_of_plane_stress_from_width_solution(brake, plane, wide).brake


def line_of(done):
    """The words of an answer on the error, however they are broken into lines."""
    assert done.returncode == 0, done.stderr
    text = " ".join(done.stdout.split())
    start = text.index(LINE)
    return text[start:]


@pytest.mark.parametrize(
    "section", [lambda brake: brake, pytest.param(t_section, marks=pytest.mark.slow)]
)
def test_the_estimate_is_within_a_third_of_the_true_error(flexible, section):
    brake = section(flexible)
    true, found = true_error(brake), estimate_error_of_plane_stress(brake, solve(brake)).brake
    assert set(found) == {"torque", "pressure", "reaction"}
    for name, error in true.items():
        assert error > 1e-3
        assert 2 / 3 < found[name] / error < 1.5, name


def test_on_the_main_brake_it_is_what_plane_stress_is_off_by(brake):
    # 448.7310 N m is the limit of solid shoes in hexahedra.
    response = solve(brake, model_error=True)
    true = abs(response.torque / 448.7310 - 1)
    assert response.plane_stress_error.brake["torque"] == pytest.approx(true, rel=0.2)


def test_without_contraction_one_width_has_no_error(flexible):
    changes = {"shoe.lining.material.nu": 0.0, "shoe.body.material.nu": 0.0}
    brake = vary(flexible, changes)
    found = estimate_error_of_plane_stress(brake, solve(brake)).brake
    assert max(found.values()) < 1e-8


def percent(error: float) -> str:
    return f"{100 * error:.2g} %"


def test_a_solve_prints_it_alone_and_with_that_of_the_mesh(root, tmp_path):
    file = root / "studies" / "double_shoe" / "brake.toml"
    done = drumlin("solve", file, "--json", tmp_path / "a.json")
    line = line_of(done)
    data = json.loads((tmp_path / "a.json").read_text())
    found, mesh = data["plane_stress_error"], data["error"]
    assert found["peak"] is None
    assert line.startswith(
        f"{LINE}p {percent(found['pressure'])} (mean over the width), "
        f"torque {percent(found['torque'])}, hinge reaction {percent(found['reaction'])}, "
        f"peak pressure not known; both errors together, with all inputs taken as exact: "
        f"p {percent(found['pressure'] + mesh['pressure'])}, "
        f"torque {percent(found['torque'] + mesh['torque'])}, "
        f"hinge reaction {percent(found['reaction'] + mesh['reaction'])}"
    )
    for shoe in data["shoes"]:
        assert set(shoe["plane_stress_error"]) == {"torque", "pressure", "reaction"}
    worst = max(shoe["plane_stress_error"]["pressure"] for shoe in data["shoes"])
    assert worst == found["pressure"]


def test_it_can_be_left_out(root, tmp_path):
    file = root / "studies" / "double_shoe" / "brake.toml"
    done = drumlin("solve", file, "--no-model-error", "--json", tmp_path / "a.json")
    assert done.returncode == 0
    assert LINE not in done.stdout
    assert "plane_stress_error" not in json.loads((tmp_path / "a.json").read_text())
    assert package.solve(file, model_error=False).plane_stress_error is None
    assert package.solve(file, "sine").plane_stress_error is None
    assert package.solve(file, worn_in=True, elements=8).plane_stress_error is None


def test_on_one_mesh_it_stands_alone(root):
    file = root / "studies" / "double_shoe" / "brake.toml"
    line = line_of(drumlin("solve", file, "--elements", "12"))
    assert "peak pressure not known" in line
    assert "together" not in line


@pytest.mark.parametrize(
    ("file", "options", "why"),
    [
        ("studies/post_brake/brake.toml", (), "its drum is an elastic ring"),
        pytest.param(
            "meshes/double_shoe.toml",
            (),
            "it has a mesh of its own, which is drawn in the plane",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_where_it_is_not_known_a_line_says_why(root, file, options, why):
    line = line_of(drumlin("solve", root / file, *options))
    assert line.startswith(f"{LINE}not known, ")
    assert why in line


def test_where_the_coarse_section_has_no_answer_it_says_so(brake, monkeypatch):
    from drumlin.fem.width import error

    def refuse(*_, **__):
        raise error.NoAnswer("no equilibrium")

    monkeypatch.setattr(error, "prepare_model_with_widths_on_given_elements", refuse)
    found = estimate_error_of_plane_stress(brake, solve(brake))
    assert found.brake == {}
    assert found.unknown == "on a coarse section, with its width: no equilibrium"
    assert found.as_dict() == {"unknown": found.unknown}


def test_a_shoe_that_loses_its_contact_has_no_error(brake):
    plane = solve(brake)
    shoe = plane.shoes[0]
    from dataclasses import replace

    lost = replace(shoe, pressure=np.zeros_like(shoe.pressure), contact_arcs=())
    found = relative_distance_of_plane_stress_from_width_solution(
        brake, plane, replace(plane, shoes=(lost, plane.shoes[1]))
    )
    assert found.unknown == "shoe 'right' loses its contact with its width"


def test_a_sweep_has_its_columns_on_request(flexible):
    response = solve(flexible, model_error=True)
    names = {"torque", "pressure", "reaction"}
    columns = {f"plane_stress_error_{name}" for name in names}
    row = results_of_response_by_name(flexible, response)
    assert columns <= set(row)
    assert all(math.isfinite(row[name]) for name in columns)
    assert not columns & set(results_of_response_by_name(flexible, solve(flexible)))


def test_a_sweep_file_asks_for_it(root, tmp_path):
    brake = root / "studies" / "double_shoe" / "brake.toml"
    text = f'brake = "{brake}"\n[vary]\nfriction = [0.2, 0.3]\n'
    (tmp_path / "s.toml").write_text(text + "[model.fem]\nmodel_error = true\n")
    rows = package.sweep(tmp_path / "s.toml")
    assert [row["status"] for row in rows] == ["solved", "solved"]
    assert all(1e-4 < row["plane_stress_error_torque"] < 1e-2 for row in rows)
    (tmp_path / "p.toml").write_text(text)
    assert "plane_stress_error_torque" not in package.sweep(tmp_path / "p.toml")[0]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [102, 158])
def test_a_contact_that_a_coarse_section_misses_is_seen_on_the_first_level(seed):
    brake = draw_random_brake(seed, "small contact")
    true, found = true_error(brake), estimate_error_of_plane_stress(brake, solve(brake)).brake
    assert true["pressure"] > 0.05
    for name in ("torque", "pressure"):
        assert 2 / 3 < found[name] / true[name] < 1.5, name
