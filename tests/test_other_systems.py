"""drumlin without what Windows lacks, without long double, and without the extra for pictures.

Python's processes get `other_system/sitecustomize.py` on their path, which takes these things away.
"""

import json
import os
import re
import subprocess
import sys
import tomllib

import pytest

from conftest import ROOT, STUDY
from drumlin.door import example
from drumlin.report import render
from drumlin.report.solid_picture import draw_solid_shoes_and_return_failure_reason

PROGRAM = "from drumlin.cli import main; main()"
BRAKE = str(STUDY / "brake.toml")
QUICK = ["--elements", "6"]


def lacking(words, cwd, lacks="", program=PROGRAM):
    """Run a Python program without what Windows lacks, and without the packages in `lacks`."""
    folders = [ROOT / "tests" / "other_system", *filter(None, sys.path)]
    env = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(map(str, folders)),
        "DRUMLIN_TEST_LACKS": lacks,
    }
    return subprocess.run(
        [sys.executable, "-c", program, *map(str, words)],
        cwd=cwd,
        env=env,
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_simulation_takes_away_what_windows_lacks(tmp_path):
    """Without this test the others would pass wherever the file for the start is not found."""
    program = """
import sys, types
module = types.ModuleType("drumlin.asking")
exec('''
import os, signal
assert not hasattr(signal, "SIGKILL") and not hasattr(os, "fork") and hasattr(os, "getpid")
try:
    import resource
except ImportError:
    print("none")
''', module.__dict__)
assert sys.modules["vtk"] is None
"""
    done = lacking([], tmp_path, "vtk", program)
    assert done.stdout == "none\n", done.stderr


IN_ONE_PROCESS = f"""
import sys
from drumlin.cli.process import run_command_line
for words in (["solve", {BRAKE!r}], ["explore", "--help"],
              ["export", {BRAKE!r}, "--to", "calculix", "--output", "deck", *{QUICK!r}]):
    assert run_command_line(words) == 0, words
import drumlin.verification.cost
import drumlin.explore.serve
assert not {{"resource", "fcntl"}} & set(sys.modules["drumlin.peers.peer"].__dict__)
"""


@pytest.mark.slow
def test_without_posix_and_vtk_a_brake_is_solved_and_exported(tmp_path):
    done = lacking([], tmp_path, "pyvista,vtk,vtkmodules", IN_ONE_PROCESS)
    assert done.returncode == 0, done.stderr
    assert "torque 447.593 N m" in done.stdout and list((tmp_path / "deck").glob("*.inp"))


@pytest.mark.slow
def test_without_vtk_compare_draws_its_fields(tmp_path):
    done = lacking(["compare", BRAKE, *QUICK], tmp_path, "pyvista,vtk,vtkmodules")
    assert done.returncode == 0, done.stderr
    (page,) = tmp_path.glob("**/index.html")
    assert "Von Mises stress" in page.read_text()
    assert list(tmp_path.glob("**/fields.svg")) and not list(tmp_path.glob("**/fields.vtu"))


def test_without_vtk_a_picture_in_space_names_the_extra(tmp_path, monkeypatch):
    monkeypatch.setattr(render, "DRAWING_PACKAGES", ("no_such_package",))
    said = draw_solid_shoes_and_return_failure_reason(
        tmp_path / "a.vtu", tmp_path / "a.png", example("double_shoe")
    )
    assert said == "no field picture: pyvista needs the extra drumlin[fields]"


def test_a_picture_in_space_that_cannot_be_drawn_says_so(tmp_path, monkeypatch):
    monkeypatch.setattr(render, "DRAWING_PACKAGES", ())
    monkeypatch.setattr(render.sys, "executable", "/bin/false")
    (tmp_path / "a.png").write_bytes(b"an earlier picture")
    said = draw_solid_shoes_and_return_failure_reason(
        tmp_path / "a.vtu", tmp_path / "a.png", example("double_shoe")
    )
    assert "off-screen rendering is not possible here" in said
    assert not (tmp_path / "a.png").exists()


@pytest.mark.slow
@pytest.mark.parametrize("study", ["double_shoe", "sweeps", "faults"])
def test_studies_run_without_posix(tmp_path, study):
    done = lacking(["study", study, "--short"], tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "reports" / study / "index.html").stat().st_size > 5000


@pytest.mark.slow
def test_sweep_and_cost_run_without_posix_and_a_journal_of_another_drumlin_is_kept(tmp_path):
    (tmp_path / "s.toml").write_text(
        f"brake = {BRAKE!r}\n[vary]\nfriction = [0.1, 0.2]\n[model.fem]\nelements = 6\n"
    )
    (tmp_path / "t.csv.journal").write_text('{"stamp": "0123456789abcdef"}\n')
    done = lacking(["sweep", "s.toml", "--output", "t.csv", "--jobs", "2"], tmp_path)
    assert done.returncode == 0, done.stderr
    assert len((tmp_path / "t.csv").read_text().splitlines()) == 3
    assert "is kept as t.csv.journal.1" in done.stdout + done.stderr
    done = lacking(["cost", BRAKE, *QUICK], tmp_path)
    assert done.returncode == 0 and "further load case" in done.stdout, done.stderr


SOLVE_SOFT = f"""
import json, sys
import drumlin
brake, found = drumlin.read_brake({BRAKE!r}), {{}}
fine, mesh = {{"tolerance": 0.05}}, {{"elements": 20}}
cases = [("210 GPa", fine), ("3 kPa", fine), ("10 kPa", {{"tolerance": 0.1}})]
for E, options in (*cases, ("210 GPa", mesh), ("1 kPa", mesh), ("400 Pa", mesh)):
    try:
        softer = drumlin.vary(brake, {{"shoe.body.material.E": E}})
        answer = drumlin.solve(softer, **options)
        found[f"{{E}}, {{options}}"] = dict(
            torque=answer.torque, error=answer.error, notes=answer.notes,
            peaks=[shoe.peak_pressure for shoe in answer.shoes],
        )
    except drumlin.NoAnswer as error:
        found[f"{{E}}, {{options}}"] = str(error)
json.dump(found, sys.stdout)
"""


@pytest.mark.slow
def test_where_long_double_is_double_the_answer_says_what_is_lost(tmp_path):
    """Shoes softer than their linings need more digits than double has.

    The reference is the same solve with long double, which has 3 digits more.
    """
    wide, double = (
        json.loads(lacking([], tmp_path, lacks, SOLVE_SOFT).stdout) for lacks in ("", "long double")
    )
    reason = "this computer has no long double"
    outcomes = set()
    for case, found in double.items():
        right = wide[case]
        assert not isinstance(right, str) and reason not in str(right)
        if isinstance(found, str):
            outcomes.add("refused")
            assert "lost digits" in found and reason in found, found
            continue
        notes = [line for line in found["notes"] if line.startswith("note:") and reason in line]
        outcomes.add("noted" if notes else "silent")
        assert notes or "refined" not in str(right["notes"])
        # Both are solved on the same elements, so that they differ by round-off alone. Without a
        # note it is less than that which long double need not refine.
        stated = re.findall(r"certain only to ([0-9.e-]+)", str(notes))
        most = max(map(float, stated), default=1e-5)
        assert abs(found["torque"] / right["torque"] - 1) < most
        for peak, other in zip(found["peaks"], right["peaks"], strict=True):
            assert abs(peak / other - 1) < most
    assert outcomes == {"silent", "noted", "refused"}, double


def test_extras_and_classifiers_say_what_is_tried():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert not [line for line in project["dependencies"] if line.startswith(("pyvista", "vtk"))]
    assert project["optional-dependencies"]["fields"][0].startswith("pyvista")
    assert "fields" in project["optional-dependencies"]["dev"][0]


@pytest.mark.parametrize(("minor", "is_tried"), [(10, 0), (11, 1), (12, 1), (13, 1), (14, 0)])
def test_locked_libraries_are_installed_on_the_pythons_of_the_classifiers(
    minor, is_tried, monkeypatch
):
    """Nobody has run the tests with Python 3.14 yet: `make` installs the newest libraries there."""
    made = (ROOT / "Makefile").read_text().split("TESTED = ")[1].partition("\n\n")[0]
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(sys, "version_info", (3, minor, 0, "final", 0))
    with pytest.raises(SystemExit) as ended:
        exec(made.replace("\\\n", ""))
    assert ended.value.code == (not is_tried)
