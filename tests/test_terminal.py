"""What the terminal prints: the answer first, lines within 80 columns, helpful refusals."""

import json
import math
import re

import numpy as np
import pytest

from command_line import drumlin
from conftest import STUDY
from drumlin.brake.file import vary
from drumlin.brake.plane_brake import read_drum_or_plane_brake
from drumlin.cli.terminal import can_terminal_show_progress
from drumlin.door import solve
from drumlin.response.merit import brake_factor
from drumlin.response.response import (
    PeakPressurePlace,
    length_of_edge_zone_left_out_of_peak_search,
    place_of_peak_pressure,
)
from picking import picked

BRAKE = STUDY / "brake.toml"


def words_of(lines):
    return re.sub(r"\s+", " ", "\n".join(lines)).strip()


def changed(tmp_path, name, *pairs):
    text = BRAKE.read_text()
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new, 1)
    (tmp_path / name).write_text(text)
    return tmp_path / name


def test_the_answer_comes_first_as_a_table(brake):
    lines = drumlin("solve", BRAKE).stdout.splitlines()
    response = solve(brake)
    T = response.torque
    assert (
        lines[1]
        == f"torque {T:.6g} N m, brake factor {T / (2000 * 0.15):.4g} = T/(F R), F the mean "
        f"actuation force"
    )
    assert lines[2].split() == [
        "shoe",
        "torque",
        "normal",
        "peak",
        "p",
        "at",
        "contact",
        "reaction",
        "T/(F",
        "R)",
    ]
    for row, shoe in zip(lines[4:6], response.shoes, strict=True):
        name, torque, normal, peak, at, first, _, last, reaction, factor = row.split()
        assert name == shoe.name
        assert float(torque) == pytest.approx(shoe.torque, rel=1e-5)
        assert float(normal) == pytest.approx(shoe.normal_force, rel=1e-5)
        assert float(peak) * 1e6 == pytest.approx(shoe.peak_pressure, rel=1e-3)
        assert shoe.pressure_at(math.radians(float(at))) == pytest.approx(
            shoe.peak_pressure, rel=0.02
        )
        assert [float(first), float(last)] == pytest.approx(
            np.degrees(shoe.contact_arcs[0]), abs=0.051
        )
        assert float(reaction) == pytest.approx(np.hypot(*shoe.hinge_reaction), rel=1e-5)
        assert float(factor) == pytest.approx(shoe.torque / 300, abs=6e-4)
    assert lines[6] == "peak p: the largest, half a lining's thickness at each end left out"
    assert lines[7] == "self-energising: left"


def test_the_rest_is_for_those_who_ask():
    short, long = (
        words_of(drumlin("solve", BRAKE, *more).stdout.splitlines()) for more in ([], ["--verbose"])
    )
    for said in ("left out: ", "mechanical_advantage", "active-set steps", "penalty 1e+08"):
        assert said in long and said not in short
    assert long.startswith(short)


@pytest.mark.parametrize(
    "words",
    [
        ["solve", BRAKE, "--verbose"],
        ["solve", STUDY.parent / "post_brake" / "brake.toml", "--model", "foundation", "--verbose"],
        ["sensitivity", BRAKE, "--elements", 20],
        ["wear", BRAKE, "--elements", 20, "--distance", "3 km"],
        ["hold", BRAKE, "--elements", 20, "--steps", 2],
    ],
)
def test_no_line_is_longer_than_80_columns_and_no_word_is_broken(words, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    lines = drumlin(*words).stdout.splitlines()
    assert len(lines) > 3
    assert max(map(len, lines)) <= 80
    monkeypatch.setenv("COLUMNS", "4000")
    whole = set(" ".join(drumlin(*words).stdout.splitlines()).split())
    timings = re.compile(r"[\d.,]+|ms:")
    assert {word for word in " ".join(lines).split() if not timings.fullmatch(word)} <= whole


def test_a_shoe_that_is_lifted_off_and_a_warning_are_said_at_once(tmp_path):
    lifted = changed(tmp_path, "lifted.toml", ('force = "2 kN"', 'force = "-2 kN"'))
    lines = drumlin("solve", lifted).stdout.splitlines()
    assert lines[1] == "shoe 'right': no contact, the force does not turn it towards the drum"
    assert lines[5].split()[:4] == ["right", "0", "0", "0"] and "none" in lines[5]
    hard = changed(tmp_path, "hard.toml", ('force = "2 kN"', 'force = "60 kN"'))
    assert "warning: shoe 'right': the lining is strained by up to" in words_of(
        drumlin("solve", hard).stdout.splitlines()
    )


def test_where_the_pressure_peaks(root, brake):
    flat = read_drum_or_plane_brake(root / "studies/laws/pad.toml")
    pad = solve(flat, "linear")
    assert place_of_peak_pressure(flat, 0, pad.shoes[0]) == PeakPressurePlace(
        flat.shoes[0].lining.end, 0.0
    )
    assert brake_factor(flat, pad) == pytest.approx(
        pad.merits[0].braking_force / flat.shoes[0].actuation.force
    )
    # Its pressure has no bound at the end that runs on.
    clamp = read_drum_or_plane_brake(root / "studies/brakes/rail_clamp.toml")
    (shoe,) = solve(clamp, elements=40).shoes
    place = place_of_peak_pressure(clamp, 0, shoe)
    # The zone is half of the 10 mm of thickness.
    assert place.zone == 5e-3 and abs(place.at) < 75e-3 - 5e-3
    assert (
        shoe.pressure_at(np.array(place.at))
        == pytest.approx(shoe.peak_pressure, rel=1e-3)
        != shoe.pressure[0]
    )
    for i, shoe in enumerate(solve(brake, elements=40).shoes):
        place, zone = (
            place_of_peak_pressure(brake, i, shoe),
            length_of_edge_zone_left_out_of_peak_search(brake.shoes[i], brake.drum.radius),
        )
        # The zone is half of 8 mm at R = 150 mm.
        assert zone == pytest.approx(4 / 150, rel=1e-12)
        assert place.zone == (zone if shoe.pressure.max() > shoe.peak_pressure else 0.0)
        assert shoe.theta[0] + zone <= place.at <= shoe.theta[-1] - zone
    lifted = vary(brake, {"shoe[0].actuation.force": -1.0})
    assert place_of_peak_pressure(lifted, 0, solve(lifted, "sine").shoes[0]) is None


def test_several_brakes_are_solved_in_one_call_and_one_failure_costs_no_other(tmp_path):
    locked = changed(tmp_path, "locked.toml", ("friction = 0.3", "friction = 0.9"))
    done = drumlin(
        "solve", BRAKE, STUDY / "flexible.toml", "--model", "sine", "--json", tmp_path / "r.json"
    )
    assert done.returncode == 0 and done.stdout.count("torque 435.216 N m") == 2
    alone = drumlin("solve", BRAKE, "--model", "sine").stdout
    assert done.stdout.startswith(alone + "\n")
    both = json.loads((tmp_path / "r.json").read_text())
    assert picked(both, "brake_file") == [str(BRAKE), str(STUDY / "flexible.toml")]
    done = drumlin("solve", locked, BRAKE, "--model", "sine", "--json", tmp_path / "r.json")
    assert done.returncode == 3 and done.stdout == alone
    assert done.stderr.splitlines()[0].startswith(f"drumlin: {locked}: shoe")
    assert done.stderr.splitlines()[1] == "drumlin: 1 of 2 brakes have no answer"
    first, second = json.loads((tmp_path / "r.json").read_text())
    assert "self-locking" in first["failure"] and "torque" not in first and second["torque"] > 0
    done = drumlin("solve", BRAKE, tmp_path / "none.toml", "--model", "sine")
    assert done.returncode == 2 and not done.stdout and "none.toml" in done.stderr
    done = drumlin("solve", BRAKE, BRAKE, "--model", "sine", "--pressure", tmp_path / "p.csv")
    assert (
        done.returncode == 2 and "--pressure" in done.stderr and not (tmp_path / "p.csv").exists()
    )


def test_no_more_is_worn_off_than_the_lining_has():
    words = ["wear", BRAKE, "--elements", 10, "--coefficient", "1e-4 mm^3/(N m)"]
    done = drumlin(*words, "--distance", "300 km")
    assert done.returncode == 3
    gone = float(
        re.search(r"lining of 8 mm is worn through after ([\d.]+) km", done.stderr).group(1)
    )
    # The states up to there are printed: the last one has lost the lining.
    rows = [line.split() for line in done.stdout.splitlines() if re.fullmatch("[-+0-9.e ]+", line)]
    assert float(rows[-1][0]) == pytest.approx(gone, rel=1e-3)
    assert float(rows[-1][-1]) == pytest.approx(8.0, rel=2e-3)
    assert drumlin(*words, "--distance", f"{0.99 * gone} km").returncode == 0


@pytest.mark.parametrize("elements", (10, 12))
def test_a_cam_brake_at_rest_holds_nothing_without_a_sign(elements):
    """Round-off of either sign is left of its moment, by the mesh."""
    lines = drumlin(
        "hold", STUDY.parent / "brakes" / "s_cam.toml", "--elements", elements, "--steps", 1
    ).stdout
    assert lines.splitlines()[1].split()[:2] == ["0.000000", "0.0000"]


@pytest.mark.parametrize(
    ("is_terminal", "is_notebook", "shows"),
    [(True, False, True), (True, True, False), (False, False, False)],
)
def test_a_cell_of_a_notebook_shows_no_spinner(monkeypatch, is_terminal, is_notebook, shows):
    """A notebook seems to be a terminal, but prints the control codes of a spinner."""
    monkeypatch.setattr("sys.stderr.isatty", lambda: is_terminal, raising=False)
    monkeypatch.delenv("JPY_PARENT_PID", raising=False)
    if is_notebook:
        monkeypatch.setenv("JPY_PARENT_PID", "1")
    assert can_terminal_show_progress() == shows
