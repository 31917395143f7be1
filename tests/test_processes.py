"""The command line as a process: signals, streams, locales, foreign code, missing packages."""

import os
import resource
import signal
import subprocess
import sys
import time

import pytest

from conftest import STUDY
from picking import picked

pytestmark = pytest.mark.slow

DRUMLIN = [sys.executable, "-c", "from drumlin.cli import main; main()"]
PATH = os.pathsep.join(path for path in sys.path if path)
BRAKE = str(STUDY / "brake.toml")
QUICK = ["--elements", "6"]


def drumlin(*words, cwd, env=None, **more):
    env = {**os.environ, "PYTHONPATH": PATH, **(env or {})}
    return subprocess.run(
        [*DRUMLIN, *map(str, words)],
        capture_output=True,
        text=True,
        cwd=cwd,
        env=env,
        check=False,
        **more,
    )


def one_line(done, status):
    assert done.returncode == status, done.stderr
    assert done.stderr.startswith("drumlin: ") and done.stderr.count("\n") == 1, done.stderr
    return done.stderr


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_signal_leaves_no_temporary_file_and_no_child(tmp_path, number):
    command = [*DRUMLIN, "compare", BRAKE, "--output", "report", "--elements", "12"]
    process = subprocess.Popen(
        command,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": PATH},
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
    )
    end = time.monotonic() + 60
    # Once this file is there the fields are being drawn.
    while not (tmp_path / "report" / "pressure.svg").exists():
        assert process.poll() is None and time.monotonic() < end
        time.sleep(0.005)
    process.send_signal(number)
    said = process.communicate(timeout=60)[1].decode()
    assert process.returncode == 128 + number
    assert said.startswith("drumlin: stopped") and said.count("\n") == 1
    assert not [path.name for path in (tmp_path / "report").iterdir() if path.name.startswith(".")]
    assert not (tmp_path / "report" / "index.html").exists()


def test_a_usage_error_is_one_line_with_status_2(tmp_path):
    for words in (
        ["solve"],
        ["solve", BRAKE, "--bad"],
        ["nothing"],
        ["solve", "a", "b"],
    ):
        one_line(drumlin(*words, cwd=tmp_path), 2)
    for option, word in (("--elements", "x"), ("--elements", "2.5"), ("--tolerance", "5 m")):
        said = one_line(drumlin("solve", BRAKE, option, word, cwd=tmp_path), 2)
        assert option in said and repr(word) in said


def test_names_reach_the_terminal_escaped(tmp_path):
    name = "x\n\x1b[31m.json"
    (tmp_path / "b.toml").write_bytes((STUDY / "brake.toml").read_bytes())
    assert r"a\n\x1b[31m" in one_line(drumlin("solve", "a\n\x1b[31m", cwd=tmp_path), 2)
    done = drumlin("view", "b.toml", "--output", "x\n\x1b[31m.png", *QUICK, cwd=tmp_path)
    assert done.returncode == 0 and done.stdout == "picture: x\\n\\x1b[31m.png\n"
    assert (
        drumlin("solve", "b.toml", "--json", name, *QUICK, cwd=tmp_path).returncode == 0
        and (tmp_path / name).exists()
    )


def test_streams_that_are_closed_or_full(tmp_path):
    words = [*DRUMLIN, "solve", BRAKE, *QUICK]
    env = {**os.environ, "PYTHONPATH": PATH}
    closed = subprocess.run(
        words,
        cwd=tmp_path,
        env=env,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
        preexec_fn=lambda: os.close(1),
    )
    assert "standard output is closed" in one_line(closed, 3)
    silent = subprocess.run(
        words,
        cwd=tmp_path,
        env=env,
        stdout=subprocess.PIPE,
        check=False,
        preexec_fn=lambda: os.close(2),
    )
    assert silent.returncode == 0 and silent.stdout
    full = tmp_path / "full"
    try:
        os.mknod(full, 0o020666, os.makedev(1, 7))
        stream = full.open("wb")
    except PermissionError:
        pytest.skip("devices can only be made by root")
    with stream:
        done = subprocess.run(
            words,
            cwd=tmp_path,
            env=env,
            stdout=stream,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert "standard output: cannot be written" in one_line(done, 3)
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run(
        words, cwd=tmp_path, env=env, stdout=write, stderr=subprocess.PIPE, text=True, check=False
    )
    os.close(write)
    assert done.returncode == 141 and not done.stderr


WRITERS = {
    "json": ["solve", BRAKE, "--json", "r.json"],
    "pressure": ["solve", BRAKE, "--pressure", "r.csv"],
    "png": ["view", BRAKE, "--output", "v.png"],
    "svg": ["view", BRAKE, "--output", "v.svg"],
    "msh": ["mesh", BRAKE, "--output", "m"],
    "vtu": ["mesh", BRAKE, "--output", "m", "--format", "vtu"],
    "inp": ["mesh", BRAKE, "--output", "m", "--format", "inp"],
    "deck": ["export", BRAKE, "--to", "calculix", "--output", "m"],
    "report": ["compare", BRAKE, "--output", "m"],
}


@pytest.mark.parametrize("case", WRITERS)
def test_a_disk_that_is_full_is_one_line_in_every_writer(tmp_path, case):
    """A limit of the size of files stands in for it."""
    limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (300, 300))  # noqa: E731
    done = drumlin(*WRITERS[case], "--elements", 10, cwd=tmp_path, preexec_fn=limit)
    assert "cannot be written (File too large)" in one_line(done, 3)
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]


def test_files_are_utf_8_in_the_locale_c(tmp_path):
    plain = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    text = (
        (STUDY / "brake.toml").read_text(encoding="utf-8").replace("internal double", "Öl λ 漢字")
    )
    (tmp_path / "b.toml").write_text(text, encoding="utf-8")
    words = ["solve", "b.toml", "--json", "r.json", "--pressure", "r.csv", *QUICK]
    done = drumlin(*words, cwd=tmp_path, env=plain)
    assert done.returncode == 0 and not done.stderr, done.stderr
    done = drumlin("compare", "b.toml", "--output", "report", *QUICK, cwd=tmp_path, env=plain)
    assert done.returncode == 0 and not done.stderr, done.stderr
    assert "Öl λ 漢字" in (tmp_path / "report" / "index.html").read_text(encoding="utf-8")


def test_an_unknown_backend_and_letters_that_the_font_lacks_are_silent(tmp_path):
    text = (STUDY / "brake.toml").read_text().replace("internal double", "漢字 अ")
    (tmp_path / "b.toml").write_text(text, encoding="utf-8")
    done = drumlin("view", "b.toml", *QUICK, cwd=tmp_path, env={"MPLBACKEND": "nonsense"})
    assert done.returncode == 0 and not done.stderr and (tmp_path / "b.png").exists()


def test_equal_runs_write_equal_pictures(tmp_path):
    for name in ("1.svg", "2.svg", "1.png", "2.png"):
        assert drumlin("view", BRAKE, "--output", name, *QUICK, cwd=tmp_path).returncode == 0
    for suffix in ("svg", "png"):
        assert (tmp_path / f"1.{suffix}").read_bytes() == (tmp_path / f"2.{suffix}").read_bytes()


def test_a_missing_package_is_one_line(tmp_path):
    (tmp_path / "packages" / "matplotlib").mkdir(parents=True)
    line = "raise ModuleNotFoundError('No module named matplotlib', name='matplotlib')"
    (tmp_path / "packages" / "matplotlib" / "__init__.py").write_text(line)
    done = drumlin(
        "view",
        BRAKE,
        cwd=tmp_path,
        env={"PYTHONPATH": os.pathsep.join([str(tmp_path / "packages"), PATH])},
    )
    assert "needs the package 'matplotlib'" in one_line(done, 3)


FOREIGN = (
    "pyvista",
    "vtk",
    "meshio",
    "matplotlib",
    "numpy",
    "random",
    "multiprocessing",
    "drumlin",
    "json",
    "typer",
)


def test_nothing_is_imported_from_the_current_folder(tmp_path):
    """Neither by compare nor by the workers of a sweep."""
    for name in FOREIGN:
        (tmp_path / f"{name}.py").write_text(f"open(r'{tmp_path}/RAN {name}', 'w').close()\n")
    script = tmp_path / "bin" / "drumlin"
    script.parent.mkdir()
    script.write_text("from drumlin.cli import main\nif __name__ == '__main__':\n    main()\n")
    (tmp_path / "b.toml").write_bytes((STUDY / "brake.toml").read_bytes())
    (tmp_path / "s.toml").write_text(
        'brake = "b.toml"\n[vary]\nfriction = [0.1, 0.2]\n[model.fem]\nelements = 6\n'
    )
    for words in (
        ["compare", "b.toml", "--output", "report", *QUICK],
        ["sweep", "s.toml", "--jobs", "2"],
    ):
        done = subprocess.run(
            [sys.executable, script, *words],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": PATH},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        assert not list(tmp_path.glob("RAN *"))
    assert (tmp_path / "report" / "fields.svg").exists()


def test_a_foreign_study_is_run_by_its_path_only(tmp_path):
    for name in ("mine", "laws"):
        (tmp_path / "studies" / name).mkdir(parents=True)
        (tmp_path / "studies" / name / "study.py").write_text(
            f"def study(short, say): open('RAN {name}', 'w').close()\n"
            "def report(result, folder): return folder / 'i.html'\n"
        )
    assert "double_shoe" in one_line(drumlin("study", "mine", cwd=tmp_path), 2)
    assert not list(tmp_path.glob("RAN *"))
    for path in ("studies/mine", "./studies/mine/study.py", "studies/laws"):
        done = drumlin("study", path, cwd=tmp_path)
        assert done.returncode == 0 and "reports/" in done.stdout, done.stderr
    assert set(picked(tmp_path.glob("RAN *"), "name")) == {"RAN mine", "RAN laws"}
    one_line(drumlin("study", "studies/none", cwd=tmp_path), 2)


def test_a_current_folder_that_is_gone(tmp_path):
    gone = tmp_path / "gone"
    python = f"{sys.executable} -c 'from drumlin.cli import main; main()'"
    command = f"mkdir -p {gone} && cd {gone} && rmdir {gone} && exec {python}"
    for words, status in (
        (f"solve {BRAKE} --elements 6", 0),
        ("solve b.toml", 2),
        (f"view {BRAKE}", 2),
    ):
        done = subprocess.run(
            ["/bin/sh", "-c", f"{command} {words}"],
            env={**os.environ, "PYTHONPATH": PATH},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == status, done.stderr
        if status:
            one_line(done, status)


def test_too_little_memory_is_one_line(tmp_path):
    limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (700_000_000, 700_000_000))  # noqa: E731
    done = drumlin("solve", BRAKE, "--elements", "4000", cwd=tmp_path, preexec_fn=limit)
    one_line(done, 3)
