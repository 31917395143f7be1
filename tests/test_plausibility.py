"""Notes on values that can hardly be meant: which values get one, and what the note says."""

import json

import pytest
from typer.testing import CliRunner

import drumlin
from conftest import ROOT, STUDY
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.file import vary
from drumlin.brake.plane_brake import read_drum_or_plane_brake
from drumlin.brake.plausibility import notes_on_implausible_brake_values as notes
from drumlin.cli.commands import app
from drumlin_studies.random_brake import draw_random_brake
from drumlin_studies.random_kinds import draw_random_brake_of_support_kind

FAR_HINGE = {"x": "12.5 m", "y": "0 m"}
PUSH = {"force": "1 kN", "direction": "0 deg"}
SPRING = {"shoe": "right", "preload": "100 N", "point": {"x": "40 mm", "y": "100 mm"}}
MASS = {"mass": "1.3 kg", "point": {"x": "85 mm", "y": "0 mm"}}
HARDLY_MEANT = [
    ({"friction": 30}, "friction = 30 is more than any lining has; did you mean 0.3"),
    ({"shoe[0].hinge": FAR_HINGE}, "shoe[0].hinge is 12.5 m away, 83.3 times drum.radius"),
    ({"shoe[0].actuation.point": {"x": "58 m", "y": "0 m"}}, "actuation.point is 58 m away"),
    (
        {"shoe[0].force": [PUSH | {"point": {"x": "58 m", "y": "0 m"}}]},
        "shoe[0].force[0].point is 58 m away, 387 times drum.radius = 150 mm; did you mean 58 mm",
    ),
    (
        {"spring": [SPRING | {"end": {"x": "40 m", "y": "100 mm"}}]},
        "spring[0].end is 40 m away, 267 times drum.radius = 150 mm; did you mean 40 mm",
    ),
    ({"shoe[0].lining.width": "40 m"}, "shoe[0].lining.width = 40 m is 267 times drum.radius"),
    ({"shoe[0].lining.width": "0.04 mm"}, "width = 0.04 mm is 0.00027 of"),
    ({"shoe[0].actuation.direction": "75 rad"}, "is 11.9 turns; did you mean 75 deg?"),
    (
        {"shoe[0].hinge": {"radius": "125 mm", "angle": "-75 rad"}},
        "shoe[0].hinge.angle = -75 rad is 11.9 turns; did you mean -75 deg?",
    ),
    (
        {"shoe[0].lining.material.E": "300 Pa"},
        "shoe[0].lining.material.E = 300 Pa (N/m^2) is low for a lining; did you mean 300 MPa",
    ),
    (
        {"shoe[0].lining.material.E": "3e8 MPa"},
        "(N/mm^2) is high for a lining; did you mean N/m^2, which gives 300 MPa?",
    ),
    (
        {"shoe[0].body.material.E": "210000 Pa"},
        "shoe[0].body.material.E = 210000 Pa (N/m^2) is low for a shoe or a ring; "
        "did you mean 210000 MPa",
    ),
    (
        {"shoe[0].lining.material.E": "300 GPa"},
        "shoe[0].lining.material is stiffer than shoe[0].body.material, "
        "E = 300000 MPa beside 210000 MPa; did you mean 300 MPa?",
    ),
    (
        {"shoe[0].lining.material.E": "210 GPa", "shoe[0].body.material.E": "300 MPa"},
        "E = 210000 MPa beside 300 MPa; were the two exchanged?",
    ),
    (
        {"drum.expansion": "1e-5 1/K", "drum.temperature_rise": "1300 K"},
        "drum.temperature_rise = 1300 K is more than the materials of a brake bear",
    ),
    (
        {"shoe[0].body.material.expansion": "12 1/K"},
        "shoe[0].body.material.expansion = 12 1/K is large for a solid; did you mean 1.2e-05 1/K?",
    ),
    (
        {"shoe_speed": "1450 rad/s", "shoe[0].mass": MASS},
        "shoe_speed = 1450 rad/s gives the drum's surface 217.5 m/s; did you mean 1450 rpm?",
    ),
    (
        {"gravity": {"direction": "-90 deg"}, "shoe[0].mass": MASS | {"mass": "1300 kg"}},
        "shoe[0].mass.mass = 1300 kg is more than a steel cube as large as the drum; did you mean",
    ),
]


@pytest.mark.parametrize(("changes", "words"), HARDLY_MEANT)
def test_a_value_that_can_hardly_be_meant_has_one_note_with_the_likely_value(brake, changes, words):
    (line,) = notes(vary(brake, changes))
    assert line.startswith("note: ")
    assert words in line


def test_a_slack_adjuster_of_metres_has_a_note():
    brake = vary(drumlin.example("air_chamber"), {"actuation.chamber.lever": "6 m"})
    (line,) = notes(brake)
    assert "actuation.chamber.lever = 6 m is 28.6 times drum.radius = 210 mm" in line


def test_a_mistaken_drum_radius_has_one_note_and_shoes_alike_have_one_note_together(brake):
    far = {"shoe.hinge": {"x": "20 m", "y": "-100 m"}}
    (line,) = notes(vary(brake, {"drum.radius": "150 m", **far}))
    assert "did you mean 150 mm" in line
    (line,) = notes(vary(brake, {"shoe.lining.width": "40 m"}))
    assert line.endswith("did you mean 40 mm or 40 cm? (1 more shoe alike)")


def test_arcs_in_radians_are_refused_with_the_degrees(brake):
    with pytest.raises(BadInput, match=r"did you mean -70 deg to 55 deg\?"):
        vary(brake, {"shoe[0].lining.start": "-70 rad", "shoe[0].lining.end": "55 rad"})
    # Only one of the two angles has the wrong unit.
    with pytest.raises(BadInput, match=r"did you mean -70 deg to 55 deg\?"):
        vary(brake, {"shoe[0].lining.start": "-70 rad", "shoe[0].lining.end": "55 deg"})


def test_the_note_stands_with_the_answer_in_json_and_with_a_refusal(tmp_path, brake):
    text = (STUDY / "brake.toml").read_text()
    path, json_file = tmp_path / "b.toml", tmp_path / "r.json"
    path.write_text(text.replace("friction = 0.3", "friction = 30"))
    told = "friction = 30 is more than any lining has"
    # The law has no answer at this friction, and the reason has the note.
    with pytest.raises(NoAnswer, match=told):
        drumlin.solve(path, "sine")
    path.write_text(text.replace('direction = "0 deg"', 'direction = "87.964594300514 rad"'))
    ran = CliRunner().invoke(
        app, ["solve", str(path), "--model", "sine", "--json", str(json_file)], terminal_width=200
    )
    assert ran.exit_code == 0
    assert ran.stdout.count("note:") == 1
    written = json.loads(json_file.read_text())["notes"]
    assert [note for note in written if "did you mean 87.9646 deg?" in note] == written
    # The angle is 14 whole turns, so that the answer is that of the direction 0.
    assert json.loads(json_file.read_text())["torque"] == pytest.approx(
        drumlin.solve(brake, "sine").torque, rel=1e-9
    )


def test_a_law_says_that_it_leaves_blocks_out(brake):
    """The blocks stand back by 5 mm, where neither a law nor a lining on a drum presses."""
    slotted = vary(brake, {"shoe[0].lining.misfit.blocks": [["-5 deg", "5 mm"], ["5 deg", "0 mm"]]})
    for model, count in {"sine": 1, "short": 1, "fem": 0}.items():
        options = {"elements": 12, "model_error": False} if model == "fem" else {}
        lines = [
            note
            for note in drumlin.solve(slotted, model, **options).notes
            if note.startswith("warning: shoe 'right': misfit.blocks are left out")
        ]
        assert len(lines) == count, model


def test_brake_files_of_the_studies_have_no_note():
    paths = [p for p in sorted((ROOT / "studies").rglob("*.toml")) if "[[shoe]]" in p.read_text()]
    assert len(paths) > 20
    for path in paths:
        assert notes(read_drum_or_plane_brake(path)) == (), path


@pytest.mark.parametrize("draw", [draw_random_brake, draw_random_brake_of_support_kind])
def test_a_random_brake_has_no_note(draw):
    """Of seed 21 the first brake is of the kind "extreme", with a lining stiffer than its shoe."""
    brake = draw(21)
    assert notes(brake) == (), brake.title


@pytest.mark.slow
def test_random_brakes_have_no_note():
    """The limits are wide enough for brakes with extreme sizes and moduli."""
    brakes = [draw_random_brake(seed) for seed in range(300)]
    brakes += [draw_random_brake_of_support_kind(seed) for seed in range(100)]
    for brake in brakes:
        assert notes(brake) == (), brake.title
