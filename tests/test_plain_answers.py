"""Answers and refusals say in plain words what they mean: limits, errors, probable mistakes."""

import math
import re

import pytest
from typer.testing import CliRunner

import drumlin
from conftest import ROOT, STUDY
from drumlin.base.errors import BadInput
from drumlin.brake.plausibility import notes_on_implausible_brake_values as notes
from drumlin.cli.commands import app
from drumlin.fem.analysis.self_locking import line_on_locking_friction_of_elastic_brake
from drumlin.report.comparison import _lines_on_models_that_do_not_apply
from drumlin.report.mesh_check import (
    read_mesh_files_of_brake,
    text_lines_about_mesh_to_be_solved,
)
from drumlin.response.shoe_stiffness import (
    ShoeStiffnessAndLiningCompression,
    lines_on_stiff_shoes_and_fitting_linings,
    stiffness_and_compression_of_shoes,
)

FAST = ("--elements", "10")
SHOE_0_TURNED_OFF = "turns shoe 'right' away from the drum; did you mean"


def printed(*words):
    """The output of a command in one line."""
    ran = CliRunner().invoke(app, [str(word) for word in words])
    assert ran.exit_code == 0, ran.output
    return " ".join(ran.stdout.split())


@pytest.fixture
def write(tmp_path, monkeypatch):
    """A function that writes the double-shoe brake with a replaced text into my.toml."""
    monkeypatch.chdir(tmp_path)
    text = (STUDY / "brake.toml").read_text()

    def write_with_replaced_text(old="", new="", count=1):
        assert old in text
        (tmp_path / "my.toml").write_text(text.replace(old, new, count))
        return tmp_path / "my.toml"

    return write_with_replaced_text


# self-locking


def test_the_end_of_a_search_is_told_from_the_limit_and_verbose_states_the_limit(write):
    path = write()
    short = printed("solve", path, *FAST, "--no-model-error")
    assert "mu_lock of the elastic brake is above 0.45 = 1.5 mu, where the search ends" in short
    assert "self-locking of the elastic brake" not in short
    told = printed("solve", path, *FAST, "--no-model-error", "--verbose")
    limit = min(each.friction for each in drumlin.self_locking(path))
    assert f"shoe 'left' locks at mu_lock = {limit:.4g}; friction 0.3 is 25 % of it" in told


def test_compare_states_the_elastic_limit_or_names_the_call(write):
    told = printed("compare", write(), *FAST)
    limit = min(each.friction for each in drumlin.self_locking("my.toml", elements=10))
    assert f"self-locking of the elastic brake: shoe 'left' locks at mu_lock = {limit:.4g}" in told
    assert "self-locking: friction 0.3 is 36 % of mu_lock = 0.8231 by the rigid-shoe law" in told
    assert "linear: does not apply: its shoes press on a drum, not on a plane" in told
    assert "fem: held: " not in told and "penalty" not in told
    # On a cam the search takes long.
    line = line_on_locking_friction_of_elastic_brake(drumlin.example("s_cam"))
    assert line.endswith('drumlin.self_locking("BRAKE.toml") in Python finds the limit')
    # Both shoes of this brake press on one elastic ring.
    posts = line_on_locking_friction_of_elastic_brake(drumlin.example("post_brake"), elements=4)
    assert ": shoe 'right', shoe 'left' lock together at mu_lock = " in posts


def test_shoes_that_are_not_pressed_have_no_elastic_limit(brake):
    def line(changes):
        return line_on_locking_friction_of_elastic_brake(drumlin.vary(brake, changes), elements=6)

    assert line({"shoe.actuation.force": 0.0}).endswith("not sought, the actuation presses no shoe")
    assert line({"shoe.left.actuation.force": 0.0}).endswith("pressed shoes lock at no friction")
    own = line({"shoe.left.lining.friction": 0.5})
    assert own.endswith(" % of it; all frictions in proportion, shoe[1].lining.friction too")


def test_compare_answers_a_brake_with_a_shoe_that_turns_away(write):
    off = write('direction = "180 deg"', 'direction = "0 deg"')
    assert "report: reports/my/index.html" in printed("compare", off, *FAST)
    with pytest.raises(drumlin.NoAnswer, match=r"^shoe 'left': no contact, so that its stresses"):
        drumlin.fields(off, elements=10)


def test_self_locking_limits_are_printed_in_words(brake):
    limits = drumlin.self_locking(brake, elements=6)
    assert isinstance(limits, tuple)
    assert repr(limits).splitlines() == [
        "shoe 'right' does not lock up to the largest friction tried",
        f"shoe 'left' locks at mu_lock = {limits[1].friction:.4g}",
    ]
    assert limits[0].friction == math.inf


def test_a_shoe_that_does_not_touch_is_no_trailing_shoe(write):
    path = write('direction = "180 deg"', 'direction = "0 deg"')
    told = printed("solve", path, *FAST, "--no-model-error")
    assert "self-energising: none, shoe 'left' does not touch; every other shoe is trailing" in told
    assert "(of shoe 'left', which does not touch here)" in told


def test_the_page_on_errors_quotes_the_shares_of_readme():
    """The reports guard README's numbers, which the manual repeats."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    page = ROOT / "studies" / "manual" / "pages" / "engineer" / "table.md"
    text = " ".join(page.read_text(encoding="utf-8").split())
    brakes = re.search(r"\| stated errors of (\d+) random brakes", readme)[1]
    share = re.search(r"\| smaller than the true error \| ([\d.]+) %", readme)[1]
    most = re.search(r"\| largest ratio of true to stated error \| ([\d.]+)", readme)[1]
    assert f"on {brakes} random brakes" in text
    assert f"{share} % of the stated errors are smaller than the true error" in text
    assert f"largest true error is {float(most):.1f} times the stated one" in text


# stiff shoes, fitting linings, errors of compare


def test_stiffness_and_compression_are_those_of_hand_formulas(brake):
    """Steel of 24 mm under 8 mm of 300 MPa on R = 150 mm; both have a width of 40 mm."""
    response = drumlin.solve(brake, "sine")
    found = stiffness_and_compression_of_shoes(brake, response)
    for each, shoe in zip(found, response.shoes, strict=True):
        ratio = 210e9 * 0.024**3 * 0.008 / (300e6 * 0.150**4)
        assert each.stiffness_ratio == pytest.approx(ratio, rel=1e-12)
        pressure = shoe.normal_force / (0.040 * 0.150 * math.radians(125))
        assert each.mean_compression == pytest.approx(pressure * 0.008 / 300e6, rel=1e-12)
    # The lining is off by an even gap or by its own radius, which has the same sign.
    off = 2 * max(each.mean_compression for each in found)
    for changes in ({"shoe.lining.clearance": off}, {"shoe.lining.misfit.radius": 0.15 - off}):
        lines = list(
            lines_on_stiff_shoes_and_fitting_linings(drumlin.vary(brake, changes), response)
        )
        assert all(f"its radius is {1e6 * off:.3g} µm smaller than the drum's" in x for x in lines)
        assert all("its lining does not fit" in line for line in lines)
    lines = list(lines_on_stiff_shoes_and_fitting_linings(brake, response))
    assert all("its lining fits: its radius is the drum's" in line for line in lines)
    assert all(f"stiff, S = {ratio:.2g} (stiff from 0.15 on)" in line for line in lines)
    thin = drumlin.vary(brake, {"shoe.body.thickness": "6 mm"})
    assert "flexible, S = 0.0024" in next(lines_on_stiff_shoes_and_fitting_linings(thin, response))


@pytest.mark.parametrize(
    ("ratio", "text"),
    [(0.148, "flexible, S = 0.148"), (0.15, "stiff, S = 0.15"), (0.142, "flexible, S = 0.14")],
)
def test_a_flexible_shoe_near_the_limit_is_not_printed_with_the_limit(ratio, text):
    line = ShoeStiffnessAndLiningCompression("shoe", ratio, 0.0, 0.0).as_text()
    assert line == f"{text} (stiff from 0.15 on)"


def test_heat_and_a_drum_out_of_round_are_not_counted_where_a_lining_fits(brake):
    response = drumlin.solve(brake, "sine")
    lobes = {"order": 2, "amplitude": "0.1 mm"}
    off = drumlin.vary(
        brake,
        {"drum.temperature_rise": 150.0, "drum.expansion": 11e-6, "drum.out_of_round": [lobes]},
    )
    for line in lines_on_stiff_shoes_and_fitting_linings(off, response):
        assert line.endswith("µm, heat and the drum's out_of_round not counted")
    soft = drumlin.vary(brake, {"shoe.lining.material.E": "20 MPa"})
    for line in lines_on_stiff_shoes_and_fitting_linings(soft, response):
        assert re.search(r"p t/E = \d+ µm$", line)


def test_models_that_do_not_apply_for_one_reason_share_a_line():
    lines = _lines_on_models_that_do_not_apply(drumlin.example("duo_servo"), ())
    share = [line for line in lines if line.endswith("its shoes share their forces by a strut")]
    assert len(share) == 1
    assert {"sine", "cosine", "pivoted"} < set(
        share[0].partition(": do not apply: ")[0].split(", ")
    )


def test_compare_states_the_errors_of_fem_and_the_keys_that_laws_leave_out(write):
    path = write("[shoe.lining]", '[shoe.lining]\nmisfit = { radius = "149.9 mm" }')
    told = printed("compare", path, *FAST, "--verbose")
    assert "fem: held: " in told and "fem: shoe 'left': penalty" in told
    assert "keys that the law does not use: shoe.body, shoe.lining.misfit.radius" in told
    assert told.count("keys that the law does not use") == 1
    rows = {row["shoe"]: row for row in drumlin.compare(path, models=["fem"]).rows}
    assert 0 < rows["all"]["stated_torque_error"] < 1e-3
    assert 0 < rows["left"]["stated_pressure_error"] < 1e-2


# probable mistakes


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"shoe[0].actuation.force": "-2 kN"},
            "shoe[0].actuation.force = -2000 N: with this minus the force "
            f"{SHOE_0_TURNED_OFF} 2000 N?",
        ),
        (
            {"shoe[0].actuation.direction": "180 deg"},
            f"shoe[0].actuation.direction = 180 deg: the force {SHOE_0_TURNED_OFF} 0 deg?",
        ),
        (
            {"shoe[1].actuation.direction": "0 deg"},
            "the force turns shoe 'left' away from the drum; did you mean 180 deg?",
        ),
        ({"drum.radius": "300 mm"}, "is 300 mm the diameter, and the radius 150 mm?"),
        (
            {"shoe[0].lining.thickness": "8 cm"},
            "shoe[0].lining.thickness = 80 mm is 0.53 of drum.radius = 150 mm; did you mean 8 mm?",
        ),
        (
            {
                "shoe[0].lining.start": "5 deg",
                "shoe[0].lining.end": "130 deg",
                "shoe[0].body": None,
            },
            "shoe[0].lining = 5 deg to 130 deg ends 205 deg from the hinge at -75 deg; angles "
            "count counter-clockwise from +x",
        ),
    ],
)
def test_a_probable_mistake_has_one_note_with_what_is_likely_meant(brake, changes, words):
    (line,) = notes(drumlin.vary(brake, changes))
    assert words in line


def test_two_minuses_are_no_mistake(brake):
    pull = {"shoe[0].actuation.force": "-2 kN", "shoe[0].actuation.direction": "180 deg"}
    assert notes(drumlin.vary(brake, pull)) == ()


def test_a_lining_that_presses_with_one_end_is_not_turned_away(brake):
    """The middle of this lining is opposite of the hinge, so that one half moves to the drum."""
    middle = math.degrees(brake.shoes[1].pin.angle) + 179
    changes = {
        "shoe.left.lining.start": f"{middle - 80} deg",
        "shoe.left.lining.end": f"{middle + 80} deg",
        "shoe.left.body": None,
    }
    turned = drumlin.vary(brake, changes)
    assert not [line for line in notes(turned) if "away from the drum" in line]
    assert drumlin.solve(turned, elements=10).shoes["left"].normal_force > 1e3


def test_error_lines_name_the_shoe_the_origin_and_the_quotation_mark(write):
    """A missing key, angles from the pin, and a text whose end has no quotation mark."""
    with pytest.raises(
        BadInput, match=r"shoe\[1\]\.lining\.thickness: is missing; write a length such as '8 mm' "
    ):
        drumlin.read_brake(write('thickness = "8 mm"\n', ""))
    both = r"'8 mm'; also missing: shoe\[1\]\.lining\.thickness \(shoe\[0\] is 'right'\)$"
    with pytest.raises(BadInput, match=both):
        drumlin.read_brake(write('thickness = "8 mm"', "", 2))
    with pytest.raises(
        BadInput, match=r"within the body, .*; angles count counter-clockwise from "
    ):
        drumlin.read_brake(write('start = "-70 deg"', 'start = "-80 deg"'))
    with pytest.raises(BadInput, match=r"mark is missing in line [0-9]+$") as refusal:
        drumlin.read_brake(write('radius = "150 mm"', 'radius = "150 mm'))
    line = int(re.search(r"missing in line (\d+)", str(refusal.value))[1])
    assert (write().read_text().splitlines()[line - 1]).startswith("radius")


def test_no_other_error_is_called_a_missing_quotation_mark(write):
    """A number sign, an inch sign and an apostrophe within texts that end on their line."""
    for wrong in ('"brake #3" x', '"12\\" drum" x', "'12\" drum' x", '{ x = "1 mm", y = }'):
        with pytest.raises(BadInput, match=r"\(at line \d+, column \d+\)\)$"):
            drumlin.read_brake(write('radius = "150 mm"', f"radius = {wrong}"))


# meshes


def test_a_file_that_differs_from_its_mesh_is_told():
    """The pin of web_shoe is in a round hole, its lining 8 mm thick; notes name what is off."""
    brake = drumlin.example("web_shoe")

    def notes_on_mesh(changes):
        """The lines of `mesh --check` on the mesh of the first shoe of the changed brake."""
        changed = drumlin.vary(brake, changes)
        checked = read_mesh_files_of_brake(changed)[0]
        lines = text_lines_about_mesh_to_be_solved(changed, checked)
        return [line.removeprefix(f"shoe {checked.shoe.name!r}: ") for line in lines]

    told = (
        "thick; the mesh has the shape",
        "centre of the round group hinge",
        "of the force passes",
    )
    assert not [note for note in notes_on_mesh({}) if any(words in note for words in told)]
    thick = 1.2 * brake.shoes[0].lining.thickness
    (note,) = (n for n in notes_on_mesh({"shoe.lining.thickness": thick}) if told[0] in n)
    assert f"= {1e3 * thick:.6g} mm in the brake file, but the lining of the mesh is" in note
    assert f" {1e3 * thick / 1.2:.3g} mm thick" in note
    low = brake.shoes[0].actuation.point.y - 0.06
    moved = {"shoe[0].actuation.point.y": low}
    assert [n for n in notes_on_mesh(moved) if told[2] in n and "middle of the group" in n]
    pin = brake.shoes[0].hinge
    off = {"shoe[0].hinge": {"radius": pin.radius + 0.004, "angle": pin.angle}}
    assert [n for n in notes_on_mesh(off) if n.startswith("the pin is 4 mm from the centre")]


# sweeps


@pytest.mark.parametrize(
    ("key", "given", "words"),
    [
        (
            "shoe.lining.misfit.radius",
            {"from": "-0.1 mm", "to": "0.1 mm", "count": 3},
            r"misfit\.radius = -0\.1 mm: must be greater than 0; it is the radius of the lining's "
            "face itself, not its difference from the drum's",
        ),
        ("shoe.lining.radius", ["149 mm"], r"unknown key 'radius' \(write 'misfit\.radius'"),
        ("lining.misfit.radius", ["149 mm"], r"\(did you mean 'shoe\.lining\.misfit\.radius'\?\)"),
        (
            "friction",
            {"mean": 0.3, "deviation": 0.1},
            r"distribution: is missing, and mean belongs",
        ),
    ],
)
def test_a_sweep_s_refusal_says_what_is_meant(brake, key, given, words):
    with pytest.raises(BadInput, match=words):
        drumlin.sweep(brake, {key: given}, model={"sine": {}}, cases=None)


def test_a_sweep_explains_its_statistics(write):
    (write().parent / "s.toml").write_text(
        'brake = "my.toml"\n[model.sine]\n[vary]\nfriction = [0.2, 0.3]\n'
    )
    told = printed("sweep", "s.toml", "--jobs", 1)
    assert "spread: standard deviation; 5 % and 95 %: share of the cases with less" in told
    assert "least and most: of the solved cases, not of all possible ones" in told
