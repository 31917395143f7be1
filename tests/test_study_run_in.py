"""The study on its short setting, and the command beside it: their headline numbers and files."""

import csv
import json
import re

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

import independent
from command_line import drumlin
from conftest import ROOT, STUDY
from drumlin.brake.file import read_brake
from drumlin.cli.commands import app
from drumlin_studies.run_in_limits import table_row_of_wear_run_until_settled
from picking import keyed, picked

pytestmark = pytest.mark.slow
STUDY_NAME = "run_in"


def test_every_brake_comes_to_its_law_in_balance_and_without_a_checkerboard(result):
    assert set(picked(result.brakes, "law")) == {"sin", "cos", "A cos + B sin"}
    rows = [*result.brakes, *result.ratios]
    assert len(rows) == 8
    for row in rows:
        assert row["status"] == "at the law"
        assert row["end_pressure"] <= 0.01 and abs(row["end_torque"]) <= 1e-3
        assert row["volume"] < 1e-8
        assert row["ripple"] < 2e-3
    for row in result.brakes:
        assert abs(row["target"]) < 1e-6


def test_steps_do_not_matter_but_their_kind_does(result):
    for row in result.halves:
        assert max(row["pressure"], row["torque"], row["depth"]) < row["asked"]
        assert abs(row["long_pressure"]) < 1e-5
    ripples = keyed(result.steps, ("way", "step"))
    for step in (0.05, 0.5):
        assert ripples["implicit", step]["ripple"] < 2e-3
        assert ripples["implicit", step]["touching"] > 0.98
    bad = ripples["explicit", 0.5]
    assert bad["ripple"] > 0.05
    # The torque still looks right where the pressure is wrong.
    assert abs(bad["torque_error"]) < 0.01


def test_new_and_worn_in_are_told_apart(result):
    stiff, soft = (
        table_row_of_wear_run_until_settled(result.main),
        table_row_of_wear_run_until_settled(result.flexible),
    )
    for row, file in ((stiff, "brake"), (soft, "flexible")):
        expected = independent.torque(f"double_shoe/{file}") / independent.SINE_LAW - 1
        assert row["new_torque"] == pytest.approx(expected, abs=2e-4)
    distance, part = independent_life(read_brake(STUDY / "brake.toml"))
    # One element is cut off at each singular end.
    assert stiff["new_pressure"] == pytest.approx(distance, rel=0.05)
    # The steps of implicit Euler take 1.5 % of this.
    assert stiff["pressure_life"] == pytest.approx(part, rel=0.03)
    assert soft["pressure_life"] > 0.9


def independent_life(brake, coefficient=1e-14, travel=2e5, within=0.01):
    """Distance of p from the sine law when new, and the share of life until it is within 1 %.

    Both of the worst lining.

    By another discretisation; the life ends at 80 % of the lining's thickness, and the ends are cut
    off by 1/30.
    """
    found = []
    for i, shoe in enumerate(brake.shoes):
        theta, p, depth = independent.worn(brake, i, 30, coefficient, travel, 100)
        phi = shoe.frame.phi_of_surface_coordinates(theta)
        inside = (phi - phi.min() > np.ptp(phi) / 30) & (phi.max() - phi > np.ptp(phi) / 30)
        law = np.sin(phi) * (p[-1] @ np.sin(phi)) / (np.sin(phi) @ np.sin(phi))
        far = np.linalg.norm((p - law)[:, inside], axis=1) / np.linalg.norm(law[inside])
        s = np.interp(-within, -far, np.linspace(0, travel, len(far)))
        found.append(
            (
                far[0],
                s,
                travel
                + (0.8 * shoe.lining.thickness - depth[-1].max()) / (coefficient * law.max()),
            )
        )
    new, settled, end = np.array(found).T
    return new.max(), settled.max() / end.min()


def test_the_report_holds_the_tables_and_the_film(module, result, tmp_path):
    text = module.report(result, tmp_path).read_text()
    for word in ("Checkerboard", "Reversed", "worn-in lining", "A cos + B sin", "image/gif"):
        assert word.lower() in text.lower()
    with (tmp_path / "brakes.csv").open() as file:
        assert len(list(csv.DictReader(file))) == len(result.brakes)
    with Image.open(tmp_path / "film.gif") as film:
        assert getattr(film, "n_frames", 1) == 6
    assert (tmp_path / "film.gif").stat().st_size < 3e6


def wear(*arguments):
    done = CliRunner().invoke(
        app, ["wear", str(ROOT / "studies" / "double_shoe" / "brake.toml"), *arguments]
    )
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception
    return done.stdout


def test_the_command_runs_a_brake_in_and_writes_all_states(tmp_path):
    out = wear("--elements", "30", "--json", str(tmp_path / "run.json"))
    # The torque is 2 kN times the published lever of .2176081 m.
    assert re.search(r"worn in \(law\): torque 435\.21\d N m", out)
    data = json.loads((tmp_path / "run.json").read_text())
    first, last = data["states"][0], data["states"][-1]
    assert abs(last["torque_from_law"]) < 1e-3 and last["pressure_from_law"] < 1e-3
    assert first["worn_volume"] == 0 < last["worn_volume"]
    assert list(map(len, last["pressure"])) == list(map(len, picked(data["shoes"], "theta")))
    out = wear(
        "--elements",
        "10",
        "--distance",
        "3 km",
        "--coefficient",
        "2e-5 mm^3/(N m)",
        "--torque",
        "450 N m",
    )
    row = next(line.split() for line in out.splitlines() if line.startswith("        3 "))
    assert float(row[0]) == 3 and float(row[2]) == 450


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (
            ["--coefficient", "3 kg"],
            r"--coefficient = '3 kg': must be a wear coefficient such as '1e-5 mm\^3/\(N m\)'",
        ),
        (["--distance", "-2"], "distance = .*: must be greater than 0"),
        (["--model", "sine"], "--model = 'sine': does not wear; allowed: fem, solid, foundation"),
        (
            ["--model", "foundation", "--elements", "4"],
            "--elements and --kind belong to --model fem, --guided to fem and solid",
        ),
        (["--torque", "5"], "--torque = '5': has no unit; write a torque such as '400 N m'"),
    ],
)
def test_bad_options_are_one_line_and_exit_2(arguments, line):
    done = drumlin("wear", STUDY / "brake.toml", *arguments)
    assert done.returncode == 2
    assert re.search(line, done.stderr)
