"""The correction for finite width: a flange on a foundation, a lining's plane strain."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from command_line import drumlin
from drumlin.base.errors import BadInput
from drumlin.brake.fields import Material
from drumlin.brake.file import read_brake, vary
from drumlin.brake.plane_brake import read_any
from drumlin.fem.preparation import finite_width
from drumlin.fem.solid import model
from drumlin.fem.solve import solve
from drumlin.sweeps.cases import case_row
from drumlin.sweeps.file import sweep_from_data
from sections import t_section

pytestmark = pytest.mark.slow


def by_differences(beta, reach, count=2000):
    """Mean deflection of a flange on an elastic foundation, by cubic beam elements.

    y'''' + 4 beta^4 y = 0 with y(0) = 1, y'(0) = 0, free at the reach; the mean follows from the
    energy.
    """
    h = reach / count
    bend = (
        np.array(
            [
                [12, 6 * h, -12, 6 * h],
                [6 * h, 4 * h * h, -6 * h, 2 * h * h],
                [-12, -6 * h, 12, -6 * h],
                [6 * h, 2 * h * h, -6 * h, 4 * h * h],
            ]
        )
        / h**3
    )
    bed = (
        h
        / 420
        * np.array(
            [
                [156, 22 * h, 54, -13 * h],
                [22 * h, 4 * h * h, 13 * h, -3 * h * h],
                [54, 13 * h, 156, -22 * h],
                [-13 * h, -3 * h * h, -22 * h, 4 * h * h],
            ]
        )
    )
    size = 2 * count + 2
    K = np.zeros((size, size))
    area = np.zeros(size)
    for i in range(count):
        part = slice(2 * i, 2 * i + 4)
        K[part, part] += bend + 4 * beta**4 * bed
        area[part] += [h / 2, h * h / 12, h / 2, -h * h / 12]
    y = np.zeros(size)
    y[0] = 1.0
    y[2:] = np.linalg.solve(K[2:, 2:], -K[2:, 0])
    return area @ y / reach


@pytest.mark.parametrize("turns", [0.3, 1.0, 2.5])
def test_the_flange_is_a_beam_on_a_foundation(turns):
    """With beta c = turns; D = 1, K = 4 beta^4."""
    reach = 0.7
    beta = turns / reach
    found = finite_width.mean_pressure_under_flange(reach, 1.0, 4 * beta**4)
    assert found == pytest.approx(by_differences(beta, reach, 150), rel=1e-5)


def test_a_stiff_flange_presses_evenly_and_a_long_one_under_the_web():
    assert finite_width.mean_pressure_under_flange(1.0, 1.0, 1e-12) == pytest.approx(1.0, abs=1e-9)
    # The area under the curve of an infinite beam is 1/beta (Hetenyi).
    for reach in (20.0, 60.0, 500.0):
        assert finite_width.mean_pressure_under_flange(reach, 1.0, 4.0) == pytest.approx(
            1 / reach, rel=1e-6
        )


@given(E=st.floats(1e6, 1e10), nu=st.floats(0.0, 0.49))
def test_a_lining_lies_between_plane_stress_and_plane_strain(E, nu):
    material = Material(E=E, nu=nu)
    assert (
        pytest.approx(E, rel=1e-12) == finite_width.material_between_plane_states(material, 0.0).E
    )
    # A layer that cannot contract has the modulus E/(1 - nu^2).
    held = finite_width.material_between_plane_states(material, 1.0)
    assert held.E / (1 - nu**2) == pytest.approx(E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)), rel=1e-9)


def test_it_halves_the_error_of_a_t_section_and_leaves_a_narrow_one_alone(flexible):
    brake = t_section(flexible)
    brake = vary(brake, {"shoe.backing.thickness": 2e-3})
    true = model.solve(brake, elements=12).shoes[1].torque
    plane, other = (
        solve(each, elements=12).shoes[1].torque
        for each in (brake, finite_width.correct_for_finite_width(brake))
    )
    assert plane / true - 1 > 0.01
    assert abs(other / true - 1) < 0.4 * abs(plane / true - 1)
    narrow = vary(flexible, dict.fromkeys(("shoe.lining.width", "shoe.body.width"), 4e-3))
    assert finite_width.correct_for_finite_width(narrow) == narrow


def test_the_option_solves_the_corrected_brake_and_says_how_far_it_is_to_be_trusted(
    root, flexible, tmp_path
):
    brake = t_section(flexible)
    plain, found = solve(brake, elements=12), solve(brake, elements=12, finite_width=True)
    assert (
        found.torque
        == solve(finite_width.correct_for_finite_width(brake), elements=12).torque
        != plain.torque
    )
    (note,) = set(found.notes) - set(
        solve(finite_width.correct_for_finite_width(brake), elements=12).notes
    )
    factor = (
        finite_width.lining_material_for_width(brake.shoes[0]).E / brake.shoes[0].lining.material.E
    )
    assert f"modulus of the lining times {factor:.3f};" in note and "within 1.5 %" in note
    file, answers = root / "studies" / "plane_stress" / "brake.toml", []
    for options in ((), ("--finite-width",)):
        done = drumlin("solve", file, "--elements", "12", *options, "--json", tmp_path / "a.json")
        assert done.returncode == 0
        answers.append(json.loads((tmp_path / "a.json").read_text())["torque"])
    assert answers == [
        solve(read_brake(file), elements=12, finite_width=wide).torque for wide in (False, True)
    ]


@pytest.mark.parametrize(
    ("file", "changes", "said"),
    [
        ("double_shoe/brake.toml", {"shoe.lining.material.nu": 0.46}, "lining.material.nu = 0.46"),
        ("laws/pad.toml", {}, "its shoes press on a plane"),
    ],
)
def test_what_the_correction_does_not_cover_it_refuses(root, file, changes, said):
    brake = (
        vary(read_any(root / "studies" / file), changes)
        if changes
        else read_any(root / "studies" / file)
    )
    with pytest.raises(BadInput, match=f"--finite-width: does not apply to this brake: .*{said}"):
        solve(brake, finite_width=True)


def test_the_option_belongs_to_the_finite_elements(root):
    done = drumlin(
        "solve",
        root / "studies" / "double_shoe" / "brake.toml",
        "--model",
        "sine",
        "--finite-width",
    )
    assert done.returncode == 2 and "--finite-width belong to --model fem" in " ".join(
        done.stderr.split()
    )


def test_what_else_is_done_with_a_brake_takes_the_corrected_one(root, flexible, tmp_path):
    """Wear, the holding brake and a comparison start from the solve of the corrected brake."""
    file, torque = root / "studies" / "double_shoe" / "flexible.toml", {}
    wide = finite_width.correct_for_finite_width(flexible)
    options = ("--elements", "8", "--finite-width", "--json", tmp_path / "a.json")
    done = drumlin("wear", file, "--distance", "0.01", *options)
    assert done.returncode == 0 and done.stdout.startswith(
        "corrected for the finite width: modulus"
    )
    torque["wear"] = json.loads((tmp_path / "a.json").read_text())["states"][0]["torque"]
    done = drumlin("compare", file, *options[:-2], "--output", tmp_path / "report")
    assert done.returncode == 0 and "fem: corrected for the finite width" in " ".join(
        done.stdout.split()
    )
    (case,) = json.loads((tmp_path / "report" / "results.json").read_text())["cases"]
    torque["compare"] = next(model["torque"] for model in case["models"] if model["model"] == "fem")
    want = solve(wide, elements=8).torque
    assert want != pytest.approx(solve(flexible, elements=8).torque, rel=1e-4)
    assert torque == pytest.approx(dict.fromkeys(torque, want), rel=1e-4)
    done = drumlin("hold", file, "--steps", "1", *options)
    assert done.returncode == 0 and done.stdout.startswith(
        "corrected for the finite width: modulus"
    )
    slopes = drumlin("sensitivity", file, "--finite-width")
    assert (
        slopes.returncode == 2
        and "--finite-width" in slopes.stderr
        and slopes.stderr.count("\n") == 1
    )
    done = drumlin("wear", file, "--model", "foundation", "--finite-width")
    assert done.returncode == 2 and "--finite-width belong to --model fem" in " ".join(
        done.stderr.split()
    )


def test_a_sweep_takes_the_option(root, flexible):
    file = str(root / "studies" / "double_shoe" / "flexible.toml")
    options = {"elements": 8, "finite_width": True}
    cases = sweep_from_data(
        {"brake": file, "model": {"fem": options}, "vary": {"friction": [0.2, 0.3]}}
    ).cases
    for case, friction in zip(cases, (0.2, 0.3), strict=True):
        wide = finite_width.correct_for_finite_width(vary(flexible, {"friction": friction}))
        assert case_row(case)["torque"] == solve(wide, elements=8).torque
