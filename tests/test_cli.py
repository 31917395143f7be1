"""The command line as a user meets it: answers, refusals, exit statuses, start-up time."""

import json
import os
import re
import resource
import subprocess
import sys

import pytest

from command_line import drumlin, process
from conftest import STUDY
from drumlin.brake.file import read_brake
from drumlin.cli.terminal import (
    PrintedColumn,
    _lines_of_printed_table,
    print_table_of_compared_models,
)
from drumlin.comparison import COLUMNS_OF_COMPARISON_TABLE
from drumlin.fem.solve import solve
from drumlin.studies import paths_of_drumlin_studies
from picking import picked


def test_solve_prints_and_writes_json(tmp_path):
    done = drumlin(
        "solve",
        STUDY / "brake.toml",
        "--json",
        tmp_path / "r.json",
        "--elements",
        40,
        "--penalty",
        "inf",
    )
    assert done.returncode == 0, done.stderr
    data = json.loads((tmp_path / "r.json").read_text())
    expected = solve(read_brake(STUDY / "brake.toml"), elements=40, penalty=float("inf"))
    assert data["torque"] == pytest.approx(expected.torque, rel=1e-9)
    assert f"torque {expected.torque:.6g} N m" in done.stdout
    assert {
        "model",
        "torque",
        "converged",
        "iterations",
        "balance",
        "seconds",
        "left_out",
        "shoes",
    } <= set(data)
    shoe = data["shoes"][0]
    assert {
        "name",
        "torque",
        "normal_force",
        "self_energising",
        "peak_pressure",
        "hinge_reaction",
        "contact_arcs",
        "theta",
        "pressure",
    } <= set(shoe)
    assert len(shoe["theta"]) == len(shoe["pressure"]) == 81
    # The file is written by way of a temporary one, which must not stay.
    assert picked(tmp_path.iterdir(), "name") == ["r.json"]


def test_solve_to_a_tolerance_states_the_estimated_errors(tmp_path):
    done = drumlin(
        "solve", STUDY / "brake.toml", "--tolerance", "5e-3", "--json", tmp_path / "r.json"
    )
    assert done.returncode == 0, done.stderr
    assert "estimated error: p " in done.stdout
    assert 0 < json.loads((tmp_path / "r.json").read_text())["error"]["pressure"] <= 5e-3


def test_solve_by_the_sine_law():
    done = drumlin("solve", STUDY / "brake.toml", "--model", "sine")
    assert done.returncode == 0
    # The torque is 2 kN times the published lever of .2176081 m.
    assert "torque 435.216 N m" in done.stdout


REFUSED = {
    "unknown model": (["--model", "guess"], None, 2, "unknown model; allowed: fem, sine"),
    "bad penalty": (["--penalty", "soft"], None, 2, "--penalty = 'soft'"),
    "negative penalty": (["--penalty", "-1"], None, 2, "greater than 0"),
    "no elements": (["--elements", "0"], None, 2, "--elements = 0"),
    "lift for a law": (
        ["--model", "sine", "--lift", "tilt"],
        None,
        2,
        "belong to --model foundation, not to 'sine'",
    ),
    "foundation of an arc": (["--model", "foundation"], None, 2, "is not a straight beam"),
    "unknown kind": (["--kind", "hex8"], None, 2, "allowed: quad2, quad1, tri2, tri1"),
    "kind for a law": (["--model", "sine", "--kind", "tri2"], None, 2, "belong to --model fem"),
    "elements for a law": (
        ["--model", "sine", "--elements", "9"],
        None,
        2,
        "belong to --model fem",
    ),
    "tolerance for a law": (
        ["--model", "sine", "--tolerance", "1e-3"],
        None,
        2,
        "belong to --model fem",
    ),
    "tolerance of nothing": (
        ["--tolerance", "0"],
        None,
        2,
        "--tolerance = 0: must be greater than 0",
    ),
    "tolerance and elements": (
        ["--tolerance", "1e-3", "--elements", "9"],
        None,
        2,
        "leave out --elements",
    ),
    "self-locking": ([], ("friction = 0.3", "friction = 1.3"), 3, "self-locking"),
    "self-locking law": (
        ["--model", "sine"],
        ("friction = 0.3", "friction = 0.9"),
        3,
        "self-locking",
    ),
    "never touches": (
        [],
        ('thickness = "8 mm" ', 'clearance = "100 mm"\nthickness = "8 mm" '),
        3,
        "to touch",
    ),
    "broken toml": ([], ("[drum]", "[drum"), 2, "not TOML"),
    "unknown key": ([], ("[drum]", "[drum]\ncolour = 3"), 2, "colour"),
    "wrong unit": ([], ('"150 mm"', '"150 s"'), 2, "drum.radius = '150 s'"),
    "missing mesh": (
        [],
        ('side = "internal"', 'side = "internal"\nmesh = "none.msh"'),
        2,
        "no such file",
    ),
    "zero force": ([], ('force = "2 kN"', 'force = "0 N"'), 0, ""),
}


@pytest.mark.parametrize("case", REFUSED)
def test_every_refusal_is_one_line_and_its_status(tmp_path, case):
    words, change, status, line = REFUSED[case]
    text = (STUDY / "brake.toml").read_text()
    if change is not None:
        assert change[0] in text
        text = text.replace(change[0], change[1], 1)
    (tmp_path / "b.toml").write_text(text)
    done = drumlin("solve", tmp_path / "b.toml", "--json", tmp_path / "r.json", *words)
    assert done.returncode == status, done.stderr
    if status:
        # A refused brake must not leave a number behind.
        assert not (tmp_path / "r.json").exists()
        assert len(done.stderr.strip().splitlines()) == 1
        assert done.stderr.startswith("drumlin: ")
        assert line in done.stderr
        assert not done.stdout
    else:
        assert "no contact" in done.stdout


@pytest.mark.parametrize(
    ("words", "status", "said"),
    [
        (["solve", STUDY / "brake.toml", "--model", "sine"], 0, "torque 435.216 N m"),
        (["compare"], 2, "Missing argument"),
        (["locked.toml"], 3, "self-locking"),
    ],
)
def test_the_exit_status_of_the_process_is_that_of_the_command(tmp_path, words, status, said):
    if words == ["locked.toml"]:
        text = (STUDY / "brake.toml").read_text().replace("friction = 0.3", "friction = 1.3")
        (tmp_path / "locked.toml").write_text(text)
        words = ["solve", tmp_path / "locked.toml", "--model", "sine"]
    done = process(*words, cwd=tmp_path)
    assert done.returncode == status, done.stderr
    assert said in (done.stderr if status else done.stdout)
    assert not (done.stdout if status else done.stderr)


def test_a_refused_run_leaves_an_earlier_result_whole(tmp_path):
    (tmp_path / "r.json").write_text("earlier")
    assert drumlin("solve", tmp_path / "none.toml", "--json", tmp_path / "r.json").returncode == 2
    assert (tmp_path / "r.json").read_text() == "earlier"


def test_on_a_narrow_terminal_columns_are_left_out_by_name_and_no_number_is_cut(
    monkeypatch, capsys
):
    table = [
        {
            "shoe": "[left]",
            "model": "fem",
            "torque": 321.43,
            "peak_pressure": 0.8391e6,
            "reaction": 4227.5,
            "contact": "125.0 to 249.7",
            "self_energising": "yes",
            "pressure_error": 0.268,
            "status": "converged",
        },
        {
            "shoe": "all",
            "model": "sine",
            "status": "failed: " + "self-locking, no equilibrium " * 3,
        },
    ]
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    for columns, left_out in ((66, ["self-energising", "contact arcs [deg]"]), (160, [])):
        monkeypatch.setenv("COLUMNS", str(columns))
        print_table_of_compared_models(table, COLUMNS_OF_COMPARISON_TABLE)
        lines = capsys.readouterr().out.replace("\n  contact", " contact").splitlines()
        assert max(map(len, lines[:-1])) <= columns
        text = "\n".join(lines)
        assert (
            "[left]" in text
            and "321.43" in text
            and "26.8" in text
            and "converged" in text
            and "…" not in text
        )
        assert ("125.0 to 249.7" in text) is not bool(left_out)
        assert (
            lines[-1] == f"not shown here, the terminal is too narrow: {', '.join(left_out)}"
        ) is bool(left_out)


@pytest.mark.slow
def test_a_terminal_without_greek_letters_is_no_fault(tmp_path):
    text = (STUDY / "brake.toml").read_text().replace('name = "left"', 'name = "λ"')
    (tmp_path / "b.toml").write_text(text, encoding="utf-8")
    plain = {**os.environ, "PYTHONIOENCODING": "ascii"}
    done = process("solve", "-v", "--elements", "6", tmp_path / "b.toml", env=plain)
    assert done.returncode == 0 and "shoe '?'" in done.stdout and not done.stderr
    missing = process("solve", tmp_path / "µ.toml", env=plain)
    assert missing.returncode == 2 and missing.stderr.count("\n") == 1


def test_help_keeps_the_units_of_columns():
    # Markup must not swallow the brackets of the unit.
    assert "theta [deg]" in drumlin("check", "--help").stdout


def test_help_answers_in_some_half_a_second():
    def spent():
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return used.ru_utime + used.ru_stime

    # The first call compiles the modules that have changed and does not count.
    process("--help")
    seconds = []
    for _ in range(2):
        # This is processor time, in which other programs on the machine do not count.
        start = spent()
        assert process("--help").returncode == 0
        seconds.append(spent() - start)
    # Where nothing shares the caches the command takes .4 s.
    assert min(seconds) < 1.5


# What a solve by columns does not need.
BESIDE = {"scipy.optimize", "drumlin.foundation"}
HEAVY = {
    "pyvista",
    "matplotlib",
    "vtk",
    "pint",
    "meshio",
    "jinja2",
    "scipy.stats",
    "drumlin.verification",
    "drumlin_studies",
}


@pytest.mark.parametrize(
    ("options", "none_of"),
    [(["--elements", "10"], HEAVY), ([], HEAVY | BESIDE)],
    ids=["mesh", "columns"],
)
def test_solving_loads_what_it_calls(tmp_path, options, none_of):
    """The process also leaves its memory to the operating system, and searches no garbage there."""
    code = (
        "import gc, json, sys; sys.argv = ['drumlin', 'solve', *sys.argv[1:]]\n"
        "from drumlin.cli import main\n"
        "try: main()\n"
        "except SystemExit as end: assert not end.code\n"
        "assert gc.get_freeze_count() > len(gc.get_objects())\n"
        "print(json.dumps(sorted(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, STUDY / "brake.toml", "--json", tmp_path / "r.json", *options],
        capture_output=True,
        text=True,
        check=True,
    )
    loaded = set(json.loads(done.stdout.splitlines()[-1]))
    assert not loaded & none_of


@pytest.mark.slow
def test_compare_view_mesh_and_cost(tmp_path):
    done = drumlin(
        "compare",
        STUDY / "brake.toml",
        "--output",
        tmp_path / "report",
        "--elements",
        30,
        "--fields",
    )
    assert done.returncode == 0, done.stderr
    for unit in ("[N m]", "[%]", "[MPa]", "[N]", "[deg]", "[ms]"):
        assert unit in done.stdout.split("converged")[0], unit
    assert "…" not in done.stdout and "not shown here" not in done.stdout
    assert {
        "index.html",
        "results.csv",
        "results.json",
        "pressure.svg",
        "fields.svg",
        "fields.vtu",
    } <= set(picked((tmp_path / "report").iterdir(), "name"))
    # A second run without the option leaves no fields of the first run.
    again = ("--output", tmp_path / "report", "--elements", 30)
    assert drumlin("compare", STUDY / "brake.toml", *again).returncode == 0
    assert (tmp_path / "report" / "fields.svg").exists()
    assert not (tmp_path / "report" / "fields.vtu").exists()
    page = (tmp_path / "report" / "index.html").read_text()
    assert "sine" in page and 'src="data:image/svg+xml;base64' in page and "scikit-fem" in page
    picture = tmp_path / "v.png"
    assert (
        drumlin("view", STUDY / "brake.toml", "--output", picture, "--elements", 20).returncode == 0
    )
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert drumlin("view", STUDY / "brake.toml", "--output", "v.txt").returncode == 2
    assert (
        drumlin("mesh", STUDY / "brake.toml", "--output", tmp_path, "--elements", 20).returncode
        == 0
    )
    assert (tmp_path / "brake_right.msh").exists() and (tmp_path / "brake_left.msh").exists()
    done = drumlin("cost", STUDY / "brake.toml", "--elements", 20)
    assert "times their sum" in done.stdout and "of the first" in done.stdout
    # The last line has the times of the lines before, in default solves.
    text = " ".join(done.stdout.split())
    default_solve = float(
        re.search(r"default solve ([0-9.]+) ms; the times above in default solves: ", text)[1]
    )
    for name in ("assembly", "factorisation", "whole solve", "further load case"):
        (milliseconds,) = re.findall(rf"{name} ([0-9.]+) ms", text)
        ratio = float(re.findall(rf"{name} ([0-9.e-]+)(?:,|$)", text)[-1])
        assert ratio == pytest.approx(
            float(milliseconds) / default_solve, rel=0.1, abs=0.1 / default_solve
        )
    assert drumlin("cost", STUDY / "brake.toml", "--elements", 20, "--table").returncode == 2


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["msh", "inp", "vtu"])
def test_meshes_of_every_kind_are_written_and_solved(tmp_path, suffix):
    words = ["--kind", "tri2", "--elements", 16]
    done = drumlin("mesh", STUDY / "brake.toml", "--output", tmp_path, "--format", suffix, *words)
    assert done.returncode == 0, done.stderr
    text = (STUDY / "brake.toml").read_text()
    for name in ("right", "left"):
        text = text.replace(f'name = "{name}"', f'name = "{name}"\nmesh = "brake_{name}.{suffix}"')
    (tmp_path / "filed.toml").write_text(text)
    # The degree of the elements rises on the meshes of the files, whose errors are stated.
    on_files, known = (
        float(drumlin("solve", solved).stdout.splitlines()[1].split()[1])
        for solved in (tmp_path / "filed.toml", STUDY / "brake.toml")
    )
    assert on_files == pytest.approx(known, rel=1e-3)
    for command in (["solve"], ["mesh"], ["export", "--to", "calculix"], ["cost"]):
        refused = drumlin(*command, tmp_path / "filed.toml", "--elements", 40)
        assert (
            refused.returncode == 2
            and "--elements = 40: all shoes have mesh files" in refused.stderr
        )
    again = drumlin(
        "mesh", tmp_path / "filed.toml", "--output", tmp_path, "--name", "brake", "--format", suffix
    )
    assert again.returncode == 2 and "must not be written over" in again.stderr


def test_meshes_stay_in_their_folder(tmp_path):
    (tmp_path / "in").mkdir()
    done = drumlin(
        "mesh", STUDY / "brake.toml", "--output", tmp_path / "in", "--name", "../x", "--elements", 9
    )
    assert done.returncode == 2 and "--name = '../x': must be a word without folders" in done.stderr
    assert picked(tmp_path.rglob("*"), "name") == ["in"]


def test_no_output_is_written_over_a_brake_file(tmp_path):
    path = tmp_path / "b.toml"
    text = (STUDY / "brake.toml").read_text()
    path.write_text(text)
    for command, option in (
        ("solve", "--json"),
        ("solve", "--pressure"),
        ("sensitivity", "--json"),
    ):
        done = drumlin(command, path, option, path)
        assert done.returncode == 2 and "must not be a .toml file" in done.stderr
    assert path.read_text() == text


def test_a_study_without_a_name_lists_all_of_them_with_what_they_do():
    done = drumlin("study")
    assert done.returncode == 0
    lines = dict(line.split(maxsplit=1) for line in done.stdout.splitlines() if line[0] != " ")
    assert set(lines) == set(paths_of_drumlin_studies()) >= {"double_shoe", "post_brake", "manual"}
    assert all(line[0].isupper() for line in lines.values())


def test_h_is_the_short_form_of_help():
    for words in ((), ("solve",)):
        short, long = (drumlin(*words, option) for option in ("-h", "--help"))
        assert short.returncode == 0 and short.stdout == long.stdout


def test_an_unknown_study_is_refused_by_name():
    done = drumlin("study", "nothing")
    assert done.returncode == 2
    assert "double_shoe" in done.stderr


def test_wide_letters_do_not_shift_the_columns_of_a_table():
    names = ["日本語", "a\u0301b", "left"]
    columns = [
        PrintedColumn("shoe", "shoe", names, is_left_aligned=True),
        PrintedColumn("torque", "T", ["1", "2", "3"]),
    ]
    lines = _lines_of_printed_table(columns)
    assert lines == ["shoe    T", "日本語  1", "a\u0301b      2", "left    3"]
