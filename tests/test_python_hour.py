"""Python in a researcher's first hour: laws and wear runs, what results show, and refusals.

Each test is of something that stopped a researcher of contact.
"""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

import drumlin
from command_line import drumlin as run
from drumlin.base.texts import error_text_in_percent
from drumlin.models import MODELS, NAMES_OF_BUILT_IN_MODELS
from drumlin.studies import paths_of_example_brakes
from drumlin.sweeps.sweep_table import SweepTable
from drumlin.verification.check import pressure_curves_as_csv


@pytest.fixture
def brake():
    """The brake of README."""
    return drumlin.example("double_shoe")


@pytest.fixture
def laws():
    """The registered models, which are as they were after the test."""
    yield MODELS
    for name in set(MODELS) - NAMES_OF_BUILT_IN_MODELS:
        del MODELS[name]


# A law of your own that fails.


FAILING_LAWS = {
    "nan": (lambda phi, layout: phi * math.nan, "a finite number .* returned nan at"),
    "typo": (
        lambda phi, layout: phi / layout.radius,
        "failed with AttributeError: .* 'radius' .test_python_hour.py, line .*; the layout has phi",
    ),
    # The exception arises in a file of numpy, or in no file.
    "within numpy": (
        lambda phi, layout: np.linalg.inv(np.zeros((2, 2))),
        "failed with LinAlgError: Singular matrix .test_python_hour.py, line",
    ),
    "without a line": (np.matmul, r"failed with ValueError: (?!.*\.py)"),
    "text": (lambda phi, layout: "high", "returned 'high'"),
    "shape": (lambda phi, layout: [1.0, 2.0], "returned an array of shape"),
}


@pytest.mark.parametrize("wrong", FAILING_LAWS)
def test_a_law_that_fails_is_a_failed_row_and_no_end_of_a_comparison(brake, laws, wrong):
    function, said = FAILING_LAWS[wrong]
    drumlin.law("toe")(function)
    with pytest.raises(drumlin.BadInput, match=f"^law 'toe': its function .*{said}"):
        drumlin.solve(brake, "toe")
    compared = drumlin.compare(brake, models=["sine", "toe"])
    assert set(compared.responses) == {"sine"}
    (failed,) = (row for row in compared.rows if row["model"] == "toe")
    assert failed["status"].startswith("failed: law 'toe': its function ")
    # The name is free for the mended law.
    drumlin.law("toe")(lambda phi, layout: np.sin(phi))
    both = drumlin.compare(brake, models=["sine", "toe"]).responses
    assert both["toe"].torque == pytest.approx(both["sine"].torque, rel=1e-12)


def test_a_law_of_your_own_can_be_removed(brake, laws):
    drumlin.law("toe")(lambda phi, layout: np.sin(phi))
    with pytest.raises(drumlin.BadInput, match=r"no law of your own has this name; allowed: toe$"):
        drumlin.remove_law("sine")
    drumlin.remove_law("toe")
    with pytest.raises(drumlin.BadInput, match=r"'toe': unknown model"):
        drumlin.solve(brake, "toe")
    with pytest.raises(drumlin.BadInput, match=r"allowed: none, as no law is registered$"):
        drumlin.remove_law("toe")


def test_vary_takes_the_path_of_a_brake_file(tmp_path):
    path = tmp_path / "my.toml"
    path.write_text(run("init", "double_shoe").stdout)
    changed = {"friction": 0.4}
    of_path = drumlin.vary(str(path), changed)
    assert of_path == drumlin.vary(drumlin.read_brake(path), changed)
    assert of_path.friction == 0.4
    with pytest.raises(drumlin.BadInput, match=r"path of a brake file, not NoneType"):
        drumlin.vary(None, changed)


def test_the_slip_of_the_whole_contact_lies_between_the_rotations_of_its_line(brake):
    """Coarse steps name an interval that holds the one of fine steps."""

    def interval(**options):
        line = drumlin.hold(brake, elements=6, **options).lines()[1]
        said = "the whole contact slips from a rotation between (.*) and (.*) deg on"
        found = re.fullmatch(said, line)
        return tuple(map(float, found.groups()))

    fine = interval()
    assert 0 < fine[0] < fine[1] < 1.1 * fine[0]
    coarse = interval(rotation=1.0, steps=5)
    assert coarse[0] == 0 and coarse[1] > fine[1]


# Angles in degrees where radians are meant.


def test_a_clearance_over_degrees_is_refused(brake):
    rows = np.array([[-70.0, 1e-5], [55.0, 0.0]])
    key = "shoe.right.lining.clearance"
    said = r"the row at -70 rad is more than a turn beyond the lining .*did you mean -70 deg\?"
    with pytest.raises(drumlin.BadInput, match=said):
        drumlin.vary(brake, {key: rows})
    right = drumlin.vary(brake, {key: np.column_stack([np.radians(rows[:, 0]), rows[:, 1]])})
    assert right.shoes[0].lining.clearance[0] == (math.radians(-70), 1e-5)


def test_a_pressure_at_degrees_is_refused(brake):
    shoe = drumlin.solve(brake, "sine").shoes[0]
    assert shoe.pressure_at(np.radians(20)) > 0 == shoe.pressure_at(np.radians(90))
    for theta in (20, np.array([0.1, 20.0])):
        with pytest.raises(drumlin.BadInput, match=r"^theta = 20: is far beyond the lining, which"):
            shoe.pressure_at(theta)


# Wear.


def test_a_run_that_wears_a_lining_through_keeps_its_states():
    """Under four times the force and a tenth of the stiffness the leading shoe is worn through."""
    brake = drumlin.example("double_shoe_flexible")
    worn = drumlin.wear(brake, elements=12, distance="3000 km")
    said = r"^shoe 'left': its lining of 8 mm is worn through after (.*) km of the 3000 km"
    after = float(re.search(said, worn.ended).group(1))
    assert worn.states[-1].s == pytest.approx(after * 1e3, rel=1e-3)
    assert worn.states[-1].depth.max() == pytest.approx(8e-3, rel=1e-3)
    assert repr(worn).splitlines()[-1] == f"ended: {worn.ended}"
    assert worn.as_dict()["ended"] == worn.ended
    whole = drumlin.wear(brake, elements=12, distance=0.9e3 * after)
    assert whole.ended == "" and "ended" not in whole.as_dict()


def test_a_state_of_wear_has_its_linings_by_shoe(brake):
    worn = drumlin.wear(brake, elements=12, distance="20 km")
    state = worn.states[-1]
    right, left = worn.linings(state)
    assert (right.name, left.name) == ("right", "left")
    for lining, shoe in zip((right, left), brake.shoes, strict=True):
        ends = lining.theta[[0, -1]]
        assert ends == pytest.approx([shoe.lining.start, shoe.lining.end], rel=1e-12)
        assert (np.diff(lining.theta) > 0).all() and lining.depth.shape == lining.theta.shape
    both = np.concatenate([right.pressure, left.pressure])
    assert np.array_equal(np.sort(both), np.sort(state.pressure))
    assert "array(" in repr(right) and len(repr(right)) < 120
    # Over a short distance s the depth at an angle is k p s.
    short = drumlin.wear(brake, elements=12, distance=10.0)
    unworn = drumlin.solve(brake, elements=12).shoes
    for lining, shoe in zip(short.linings(short.states[-1]), unworn, strict=True):
        expected = 1e-14 * 10.0 * shoe.pressure_at(lining.theta)
        assert lining.depth == pytest.approx(expected, abs=0.02 * expected.max())
    # Width times radius times the areas below both depths is the worn volume.
    areas = [np.trapezoid(lining.depth, lining.theta) for lining in (right, left)]
    assert 0.04 * 0.15 * sum(areas) == pytest.approx(state.removed, rel=0.01)


def test_a_distance_and_a_coefficient_without_unit_are_told(brake):
    worn = drumlin.wear(brake, elements=6, distance="0.2")
    assert worn.notes == (f"distance = '0.2' has no unit: 0.2 times 1/(k K), {0.2 * 8 / 3:.5g} km",)
    assert repr(worn).startswith(worn.notes[0])
    assert drumlin.wear(brake, elements=6, distance="0,2").notes == (
        worn.notes[0].replace("0.2' ", "0,2' ").replace("0.2 times", "0,2 times"),
    )
    assert drumlin.wear(brake, elements=6, distance="1 km").notes == ()
    said = r"^coefficient = 1e-05: a number is in 1/Pa.*did you mean \"1e-05 mm\^3/\(N m\)\"\?$"
    with pytest.raises(drumlin.BadInput, match=said):
        drumlin.wear(brake, elements=6, coefficient=1e-5)


def test_headings_of_wear_stand_apart(brake):
    lines = drumlin.wear(brake, elements=6, distance="1 km").lines()
    assert len(re.split(" {2,}", lines[1].strip())) == len(lines[3].split()) == 8
    assert "p alternates from node to node by" in lines[-2]


# What an answer shows of itself.


def test_a_response_shows_its_errors_and_the_load_of_its_pins(brake):
    response = drumlin.solve(brake)
    lines = repr(response).splitlines()
    loads = [np.linalg.norm(shoe.hinge_reaction) for shoe in response.shoes]
    assert "reaction [N]" in lines[1]
    for line, load in zip(lines[2:4], loads, strict=True):
        assert f"  {load:.6g}  " in line
    text = " ".join(" ".join(lines).split())
    for error in (*response.error.values(), *response.plane_stress_error.brake.values()):
        assert error_text_in_percent(error) in text
    assert "error of plane stress itself" in text
    assert "is 36 % of mu_lock = 0.8231 by the rigid-shoe law" in text
    assert repr(response.self_locking) == response.self_locking.line()
    for line in lines[-4:]:
        assert len(line) <= 100
    assert "error of plane stress itself" in response._repr_html_()


def test_a_response_shows_its_warnings(brake):
    near = drumlin.solve(drumlin.vary(brake, {"friction": 0.7}), "sine")
    (warning,) = (note for note in near.notes if note.startswith("warning:"))
    assert warning[:60] in repr(near)


@pytest.mark.slow
def test_a_solid_response_shows_its_peak_over_the_width():
    """The mean over the width has a lower peak than the pressure under the web."""
    response = drumlin.solve(drumlin.example("plane_stress"), "solid", tolerance=0.1)
    (note,) = (note for note in response.notes if note.startswith("peak p over the width:"))
    peaks = [float(number) for number in re.findall(r"([0-9.]+) MPa", note)]
    for shoe, peak in zip(response.shoes, peaks, strict=True):
        assert peak > 1.1 * shoe.peak_pressure * 1e-6
        # Between its nodes the pressure may be somewhat higher than at a node.
        assert peak < 1.02 * shoe.surface.pressure.max() * 1e-6
    assert note[:60] in repr(response)


def test_a_check_shows_its_lines_and_takes_one_measured_shoe(tmp_path):
    example = drumlin.example("double_shoe")
    path = paths_of_example_brakes()["double_shoe"]
    shown = repr(drumlin.check(path, pressure_table(tmp_path, example.shoes), tolerance="5 %"))
    assert shown.splitlines()[0].startswith("reference: ")
    assert shown.splitlines()[-1] == "within 5 % of the reference"
    one = drumlin.check(path, pressure_table(tmp_path, example.shoes[1:]), tolerance=0.05)
    assert [verdict.shoe for verdict in one.verdicts] == ["left"]
    assert one.within and one.lines()[0].startswith("shoe 'right': not compared, the table has no")
    with pytest.raises(drumlin.BadInput, match=r"has no points below its heading"):
        drumlin.check(path, pressure_table(tmp_path, ()))
    written = drumlin.check(path, pressure_table(tmp_path, example.shoes), tolerance="0,5 %")
    assert written.tolerance == pytest.approx(0.005, rel=1e-15)
    for wrong in ("5 percent", "%", "5 N", "1_0 %", "1,500"):
        with pytest.raises(
            drumlin.BadInput, match=r"^tolerance = .*(must be a fraction such as 0|1500)"
        ):
            drumlin.check(path, "nowhere.csv", tolerance=wrong)


def pressure_table(folder, shoes):
    """The path of a table with the pressures of some shoes of the double-shoe brake."""
    response = drumlin.solve(drumlin.example("double_shoe"))
    names = [shoe.name for shoe in shoes]
    kept = tuple(shoe for shoe in response.shoes if shoe.name in names)
    path = folder / "p.csv"
    text = pressure_curves_as_csv(replace(response, shoes=kept))
    path.write_text(text if kept else "shoe,theta [deg],p [MPa]\n")
    return path


def test_a_comparison_shows_the_differences_in_pressure(brake):
    compared = drumlin.compare(brake, models=["fem", "sine"])
    rows = {(row["model"], row["shoe"]): row for row in compared.rows}
    assert len({tuple(row) for row in compared.rows}) == 1
    assert rows["fem", "left"]["pressure_error"] is None
    lines = repr(compared).splitlines()
    head, fem, sine = (re.split(" {2,}", line) for line in lines[1:4])
    shown = dict(zip(head, sine, strict=True))
    worst = max(rows["sine", name]["pressure_error"] for name in ("right", "left"))
    assert shown["p off fem [%]"] == f"{100 * worst:.1f}"
    peak = max((rows["sine", name]["peak_error"] for name in ("right", "left")), key=abs)
    assert shown["peak p off fem [%]"] == f"{100 * peak:+.1f}"
    stated = compared.responses["fem"].error
    by_fem = dict(zip(head, fem, strict=True))
    assert by_fem["stated: torque [%]"] == f"{100 * stated['torque']:.1g}"
    assert by_fem["stated: p [%]"] == f"{100 * stated['pressure']:.1g}"
    assert lines[-1].startswith("off fem: difference from plane-stress fem")


def test_a_plot_of_a_comparison_has_a_colour_for_each_model(brake):
    axes = drumlin.compare(brake, models=["fem", "sine", "cosine"]).plot()
    colors = [line.get_color() for line in axes.lines]
    styles = [line.get_linestyle() for line in axes.lines]
    assert colors == ["C0", "C0", "C1", "C1", "C2", "C2"]
    assert styles == ["-", "--"] * 3
    assert axes.get_legend().get_title().get_text() == "cut at the top: p at sharp edges"
    # The legend stands beside the curves, and within the picture.
    axes.figure.canvas.draw()
    legend, picture = axes.get_legend().get_window_extent(), axes.figure.bbox
    assert axes.bbox.x1 < legend.x0 and legend.x1 < picture.x1 and legend.y0 > picture.y0
    uncut = drumlin.solve(brake, "sine").plot()
    assert uncut.get_legend().get_title().get_text() == ""
    assert len({line.get_color() for line in uncut.lines}) == 2


# Keys, options and fields.


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("shoe.rigth.lining.width", r"'rigth' .did you mean 'right'..; allowed: .* names right, l"),
        ("shoes.right.lining.width", r"'shoes' .did you mean 'shoe'"),
        ("shoe.right.linning.width", r"'linning' .did you mean 'lining'"),
    ],
)
def test_a_misspelt_name_in_a_key_gets_the_names_of_the_shoes(brake, key, said):
    with pytest.raises(drumlin.BadInput, match=f"^{re.escape(key)}: unknown key {said}"):
        drumlin.vary(brake, {key: 0.05})


def test_an_option_of_two_models_names_both(brake):
    with pytest.raises(drumlin.BadInput, match=r"; penalty and tolerance also to model=\"solid\"$"):
        drumlin.solve(brake, "sine", tolerance=0.1, penalty=10.0)
    with pytest.raises(drumlin.BadInput, match=r"not to 'sine'$"):
        drumlin.solve(brake, "sine", kind="quad2")


def test_fields_show_the_names_of_their_shoes(brake):
    found = drumlin.fields(brake, elements=6)
    assert [one.name for one in found] == ["right", "left"]
    assert [repr(one).partition(":")[0] for one in found] == ["right", "left"]


def test_quantiles_of_a_few_cases_are_not_shown(brake):
    def quantiles(count):
        frictions = np.linspace(0.2, 0.3, count)
        table = drumlin.sweep(brake, {"friction": frictions}, model="sine")
        return table.cells_of_statistics("torque")[1][3:5]

    assert quantiles(19) == ("–", "–")
    assert all(float(value) > 250 for value in quantiles(20))


def test_a_sweep_shows_its_largest_errors(brake):
    table = drumlin.sweep(brake, {"friction": [0.2, 0.3]})
    lines = repr(table).splitlines()
    largest = [error_text_in_percent(max(table[f"error_{key}"])) for key in ("torque", "pressure")]
    assert lines[2] == (
        f"estimated errors: torque at most {largest[0]}, p (L2, worst shoe) at most {largest[1]}"
    )
    assert "estimated" not in repr(drumlin.sweep(brake, {"friction": [0.2]}, model="sine"))
    clamp = {"status": "solved", "model": "fem", "braking_force [N]": 9e3, "error_torque": 1.5}
    assert "estimated errors: braking force not known" in repr(SweepTable("clamp", [clamp], []))


def test_a_large_array_in_place_of_a_path_is_told_by_its_shape(brake):
    said = r"^result = array of shape \(300, 2\): must be a path or a text$"
    with pytest.raises(drumlin.BadInput, match=said):
        drumlin.check(brake, np.zeros((300, 2)))
