"""Brakes that the laws refuse with a line of text, and the laws for each kind of brake."""

import json
import math
import sys
from pathlib import Path
from typing import Any

import pytest

from drumlin import BadInput, NoAnswer, vary
from drumlin.brake.plane_brake import FlatBrake, read_drum_or_plane_brake
from drumlin.cli import main
from drumlin.laws.simscape import DoubleShoe
from drumlin.models import MODELS, model_with_name_that_applies_to_brake
from drumlin_studies.textbook_brakes import brake_with_one_hinged_shoe
from picking import picked

STUDIES = Path(__file__).parent.parent / "studies"
ON_DRUM = {"sine", "cosine", "block", "uniform", "short"}
FILES = {
    "laws/pad.toml": {"linear", "short"},
    "laws/short_block.toml": ON_DRUM,
    "laws/block.toml": ON_DRUM,
    "laws/double_block.toml": ON_DRUM,
    "laws/pivoted_block.toml": {"pivoted"},
    "laws/double_shoe_external.toml": ON_DRUM,
    "laws/shigley_16_2.toml": ON_DRUM,
    "laws/shigley_p16_1.toml": ON_DRUM,
    "laws/bhandari_12_8.toml": ON_DRUM,
    "post_brake/brake.toml": ON_DRUM | {"foundation"},
}
# The file of examples holds data of the study, not a brake.
NOT_BRAKES = {"examples.toml"}


@pytest.mark.parametrize(("file", "expected"), FILES.items())
def test_every_brake_file_is_answered_by_the_laws_that_apply_and_the_others_say_why(
    file: str, expected: set[str]
) -> None:
    brake = read_drum_or_plane_brake(STUDIES / file)
    laws = {name: model for name, model in MODELS.items() if name not in {"fem", "solid"}}
    assert len(laws) == 9
    assert {name for name, model in laws.items() if model.why_not(brake) is None} == expected
    for name, model in laws.items():
        if name in expected:
            response = model.solve(brake)
            assert response.model == name
            assert min(picked(response.shoes, "normal_force")) > 0
            assert max(response.balance.force, response.balance.moment) < 1e-9
        else:
            with pytest.raises(BadInput) as refusal:
                model_with_name_that_applies_to_brake(name, brake)
            line = str(refusal.value)
            assert line.startswith(f"--model = {name!r}: does not apply to this brake: ")
            assert "\n" not in line


def test_every_law_file_is_listed_here() -> None:
    assert {
        f"laws/{path.name}"
        for path in (STUDIES / "laws").glob("*.toml")
        if path.name not in NOT_BRAKES
    } == {file for file in FILES if file.startswith("laws/")}


PAD = (STUDIES / "laws/pad.toml").read_text()
PIVOTED = (STUDIES / "laws/pivoted_block.toml").read_text()


@pytest.mark.parametrize(
    ("text", "old", "new", "line"),
    [
        (PAD, 'sliding = "+x"', 'sliding = "left"', "plane.sliding = 'left': must be '+x' or '-x'"),
        (
            PAD,
            'sliding = "+x"',
            'slide = "+x"',
            "unknown key 'slide' (did you mean 'sliding'?); allowed: sliding",
        ),
        (PAD, 'end = "180 mm"', 'end = "40 mm"', "end = 40 mm must be greater than start = 60 mm"),
        (
            PAD,
            'end = "180 mm"',
            'end = "40 deg"',
            "shoe[0].lining.end = '40 deg': must be a length such as '8 mm'",
        ),
        (
            PAD,
            'end = "180 mm"',
            "end = 180",
            "shoe[0].lining.end = 180: has no unit; write a length such as '8 mm'",
        ),
        (
            PAD,
            'width = "40 mm"',
            'width = "-40 mm"',
            "shoe[0].lining.width = '-40 mm': must be greater than 0",
        ),
        (PAD, "friction = 0.35", "friction = nan", "friction = nan: must be a finite number"),
        (
            PAD,
            "friction = 0.35",
            "friction = -0.1",
            "friction = -0.1: must be greater than or equal to 0",
        ),
        (
            PAD,
            "[plane]",
            '[drum]\nradius = "1 m"\n[plane]',
            "unknown key 'drum'; allowed: title, friction, plane, shoe",
        ),
        (
            PIVOTED,
            'pivot = { radius = "280.588279 mm"',
            'pivot = { radius = "0 mm"',
            "must not be the drum's centre",
        ),
        (
            PIVOTED,
            'pivot = { radius = "280.588279 mm", angle = "0 deg" }',
            'pivot = { x = "330 mm", y = "-300 mm" }',
            "shoe[0].pivot = (330 mm, -300 mm): must not be the hinge",
        ),
        (
            PIVOTED,
            'pivot = { radius = "280.588279 mm"',
            "pivot = { radius = 1",
            "radius = 1 has no unit",
        ),
    ],
)
def test_bad_files_are_refused_in_one_line(
    tmp_path: Path, text: str, old: str, new: str, line: str
) -> None:
    assert text.count(old) == 1
    path = tmp_path / "brake.toml"
    path.write_text(text.replace(old, new))
    with pytest.raises(BadInput) as refusal:
        read_drum_or_plane_brake(path)
    said = str(refusal.value)
    assert said.startswith(f"{path}: ")
    assert line in said
    assert "\n" not in said


@pytest.mark.parametrize(
    ("parameters", "line"),
    [
        ({"r_D": 0.0}, "r_D = 0 mm: must be greater than 0"),
        ({"r_a": -0.1}, "r_a = -100 mm: must be greater than 0"),
        ({"r_p": math.nan}, "r_p = nan mm: must be greater than 0"),
        ({"theta_p": -0.1}, "theta_p = -5.72958 deg: must be at least 0"),
        (
            {"theta_sb": math.radians(166)},
            "theta_sb = 166 deg: must be from 0 to 180 deg - theta_p = 165 deg",
        ),
        (
            {"theta_s": math.radians(161)},
            "theta_s = 161 deg: must be above 5 deg and at most 180 deg - theta_p - theta_sb = "
            "160 deg",
        ),
        ({"theta_s": math.radians(5)}, "theta_s = 5 deg: must be above 5 deg"),
        ({"theta_s": 0.0, "reading": "span"}, "theta_s = 0 deg: must be above 0 deg"),
        ({"mu_Coulomb": 0.0}, "mu_Coulomb = 0: must be greater than 0"),
        ({"mu_visc": -1.0}, "mu_visc = -1 N m s/rad: must be at least 0"),
        ({"omega_threshold": 0.0}, "omega_threshold = 0 rad/s: must be greater than 0"),
        ({"omega_threshold": math.inf}, "omega_threshold = inf rad/s: must be greater than 0"),
        ({"reading": "middle"}, "reading = 'middle': must be 'end' or 'span'"),
    ],
)
def test_simscape_ranges_are_enforced(parameters: dict[str, object], line: str) -> None:
    with pytest.raises(BadInput) as refusal:
        DoubleShoe(**parameters)
    assert line in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_simscape_self_locking_is_an_error() -> None:
    with pytest.raises(
        NoAnswer, match=r"self-locking, mu_Coulomb = 0.83 is not below mu_lock = 0.823082"
    ):
        DoubleShoe(mu_Coulomb=0.83).torque(1.0, 1.0)


def test_simscape_says_when_its_arc_is_too_short_for_a_long_shoe() -> None:
    assert DoubleShoe().notes == ()
    (note,) = DoubleShoe(theta_s=math.radians(45)).notes
    assert note == "contact angle 40 deg: below 45 deg the long-shoe approximation is less accurate"


def test_laws_say_why_they_do_not_apply() -> None:
    shoe = {"R": 0.15, "a": 0.125, "moment": 1.0, "mu": 0.3}
    before = brake_with_one_hinged_shoe(**shoe, arc=(-0.2, 1.0))
    assert MODELS["sine"].why_not(before) == (
        "shoe 'shoe': the lining must lie within 0 to 180 deg of the hinge, not -11.4592 deg "
        "to 57.2958 deg"
    )
    wide = brake_with_one_hinged_shoe(**shoe, arc=(0.1, 3.5))
    for name in ("cosine", "block", "uniform", "short"):
        assert "arc 194.806 deg must not be more than 180 deg" in str(MODELS[name].why_not(wide))
    centred = vary(
        brake_with_one_hinged_shoe(**shoe, arc=(0.1, 0.5)),
        {"shoe.lining.start": -0.5, "shoe.lining.end": 0.5},
    )
    assert "passes through the hinge" in str(MODELS["cosine"].why_not(centred))
    two_sided = vary(
        read_drum_or_plane_brake(STUDIES / "laws/pad.toml"), {"shoe.lining.start": "-20 mm"}
    )
    assert isinstance(two_sided, FlatBrake)
    assert "on one side of the hinge, not reach 20 mm beyond" in str(
        MODELS["linear"].why_not(two_sided)
    )
    assert MODELS["short"].why_not(two_sided) is None


@pytest.mark.parametrize(
    ("arguments", "status", "line"),
    [
        (["laws/pad.toml", "--model", "linear"], 0, "braking force 289.735 N"),
        (["brakes/rail_clamp.toml"], 0, "(L2, worst shoe), braking force "),
        (["laws/block.toml", "--model", "block"], 0, "torque 83.8874 N m"),
        (
            ["laws/pad.toml"],
            2,
            "shoe 'pad': its lining has no thickness and material to mesh; allowed: short, linear",
        ),
        (
            ["laws/pivoted_block.toml", "--model", "sine"],
            2,
            "on its lever, not about its hinge; allowed: fem, pivoted",
        ),
        (
            ["locking.toml", "--model", "block"],
            3,
            "shoe 'block': self-locking, friction 4 is not below mu_lock = 3.63",
        ),
    ],
)
def test_command_line_answers_or_says_why_not_in_one_line(
    arguments: list[str],
    status: int,
    line: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: Any,
) -> None:
    locking = (STUDIES / "laws/block.toml").read_text().replace("friction = 0.35", "friction = 4")
    (tmp_path / "locking.toml").write_text(locking)
    folder = tmp_path if arguments[0] == "locking.toml" else STUDIES
    monkeypatch.setattr(
        sys, "argv", ["drumlin", "solve", str(folder / arguments[0]), *arguments[1:]]
    )
    with pytest.raises(SystemExit) as end:
        main()
    out, err = capsys.readouterr()
    assert (end.value.code or 0) == status
    assert line in (err if status else out)
    if status:
        assert err.count("\n") == 1
        assert out == ""


@pytest.mark.parametrize(
    ("file", "keys"),
    (
        (
            "laws/block.toml",
            {"resultant_angle", "friction_radius", "shoe_factor", "mechanical_advantage", "m", "n"},
        ),
        ("laws/pad.toml", {"braking_force", "sensitivity_at_fixed_shape"}),
        ("laws/pivoted_block.toml", {"pivot_reaction", "double_delta"}),
    ),
)
def test_figures_of_merit_reach_the_json(file, keys) -> None:
    brake = read_drum_or_plane_brake(STUDIES / file)
    name = next(
        name for name, model in MODELS.items() if name != "fem" and model.why_not(brake) is None
    )
    data = json.loads(json.dumps(MODELS[name].solve(brake).as_dict(), allow_nan=False))
    assert keys <= set(data["shoes"][0])
    assert ("bearing_load" in data) == (not isinstance(brake, FlatBrake))
