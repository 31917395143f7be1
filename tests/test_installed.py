"""drumlin away from its checkout: examples, schemas, contents of wheel and sdist, a used wheel."""

import json
import os
import re
import subprocess
import sys
import tarfile
import tomllib
import venv
import zipfile
from pathlib import Path
from urllib.request import urlopen

import pytest
from jsonschema import Draft202012Validator

import drumlin as package
from browsing import browser, play, served
from command_line import drumlin
from conftest import ROOT, STUDY
from drumlin.brake.plane_brake import read_drum_or_plane_brake
from drumlin.brake.schema import json_schema_of_brake_file
from drumlin.studies import paths_of_all_examples, paths_of_example_brakes
from drumlin.sweeps.schema import json_schema_of_sweep_file
from picking import picked

SWEEPS = sorted((ROOT / "studies" / "sweeps").glob("*.toml"))


def test_every_example_is_listed_printed_and_is_a_brake(tmp_path):
    listed = [line.split("  ")[0] for line in drumlin("init").stdout.splitlines()]
    assert listed == list(paths_of_all_examples()) and {
        "double_shoe",
        "double_shoe_flexible",
        "post_brake",
        "pad",
        "sweep_grid",
        "notebook_engineer",
    } <= set(listed)
    for name, path in paths_of_example_brakes().items():
        (tmp_path / "my.toml").write_text(drumlin("init", name).stdout)
        # Mesh files must be found from any current folder.
        assert read_drum_or_plane_brake(tmp_path / "my.toml") == read_drum_or_plane_brake(path), (
            name
        )
    done = drumlin("init", "duble_shoe")
    assert done.returncode == 2 and "did you mean 'double_shoe'?" in done.stderr


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        (["solve", STUDY / "brake.toml", "--model", "cosin"], "cosine"),
        (["study", "doubel_shoe"], "double_shoe"),
        (["schema", "break"], "brake"),
        (["slove", "x"], "solve"),
    ],
)
def test_what_is_misspelt_is_guessed(words, meant):
    done = drumlin(*words)
    assert done.returncode == 2 and f"id you mean '{meant}'?" in done.stderr


def test_version_and_completion(monkeypatch):
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert (
        drumlin("--version").stdout
        == f"drumlin {project['version']}\n"
        == f"drumlin {package.__version__}\n"
    )
    assert f"version: {project['version']}\n" in (ROOT / "CITATION.cff").read_text()
    monkeypatch.setenv("_DRUMLIN_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", "drumlin so")
    monkeypatch.setenv("COMP_CWORD", "1")
    assert drumlin().stdout.split() == ["solve"]


# schemas


def faults(schema, data):
    return picked(Draft202012Validator(schema).iter_errors(data), "message")


@pytest.mark.parametrize(
    ("kind", "made"),
    (("brake", json_schema_of_brake_file()), ("sweep", json_schema_of_sweep_file())),
)
def test_the_schemas_beside_the_examples_are_those_of_the_classes(kind, made):
    Draft202012Validator.check_schema(made)
    kept = json.loads((ROOT / "studies" / f"{kind}.schema.json").read_text())
    assert kept == made, f"drumlin schema {kind} > studies/{kind}.schema.json"


def test_every_example_keeps_to_its_schema_and_names_it():
    for schema, paths in (
        (json_schema_of_brake_file(), paths_of_example_brakes().values()),
        (json_schema_of_sweep_file(), SWEEPS),
    ):
        for path in paths:
            text = path.read_text()
            assert faults(schema, tomllib.loads(text)) == [], path
            if text.startswith("#:schema "):
                assert (path.parent / text.split("\n")[0].removeprefix("#:schema ")).is_file()
    assert (STUDY / "brake.toml").read_text().startswith("#:schema ")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        # A quantity without its unit is an error of the schema.
        ('radius = "150 mm"', "radius = 150"),
        ('radius = "150 mm"', 'radius = "big"'),
        ('radius = "150 mm"', 'radiuss = "150 mm"'),
        ('rotation = "counter-clockwise"', 'rotation = "left"'),
        (
            'hinge = { radius = "125 mm", angle = "-75 deg" }',
            'hinge = { radius = "125 mm", x = "-75 mm" }',
        ),
        ("friction = 0.3", 'friction = "much"'),
        ('thickness = "8 mm" ', 'clearance = [["-70 deg", 0]]\nthickness = "8 mm" '),
    ],
)
def test_what_the_reader_refuses_the_schema_refuses(old, new):
    text = (STUDY / "brake.toml").read_text()
    assert old in text
    assert faults(json_schema_of_brake_file(), tomllib.loads(text.replace(old, new, 1)))


def test_tables_and_sweeps_are_in_the_schemas():
    data = tomllib.loads((STUDY / "brake.toml").read_text())
    data["shoe"][0]["lining"] |= {
        "clearance": [["-70 deg", "0 mm"], ["55 deg", "0.1 mm"]],
        "misfit": {"blocks": [["0 deg", "0.1 mm"]]},
    }
    assert faults(json_schema_of_brake_file(), data) == []
    sweep = tomllib.loads(SWEEPS[0].read_text())
    assert faults(json_schema_of_sweep_file(), sweep | {"pressure": "psi"})
    # A single value has no deviation.
    assert faults(
        json_schema_of_sweep_file(), sweep | {"vary": {"friction": {"distribution": "normal"}}}
    )


# a wheel


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """The wheel and the sdist of the checkout, made where nothing of it is changed."""
    folder = tmp_path_factory.mktemp("built")
    files = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        check=True,
        text=True,
    ).stdout.split("\0")
    source = folder / "source"
    for name in filter(None, files):
        if (ROOT / name).is_file():
            (source / name).parent.mkdir(parents=True, exist_ok=True)
            (source / name).write_bytes((ROOT / name).read_bytes())
    code = (
        f"from setuptools import build_meta as "
        f"b\nb.build_sdist({str(folder)!r})\nb.build_wheel({str(folder)!r})"
    )
    tools = folder / "tools"
    venv.create(tools, with_pip=True)
    subprocess.run([tools / "bin" / "pip", "install", "--quiet", "setuptools>=77"], check=True)
    subprocess.run(
        [tools / "bin" / "python", "-c", code], cwd=source, capture_output=True, check=True
    )
    return next(folder.glob("*.whl")), next(folder.glob("*.tar.gz")), set(filter(None, files))


@pytest.mark.slow
def test_the_sdist_is_complete_and_the_wheel_carries_what_commands_need(built):
    wheel, sdist, files = built
    with tarfile.open(sdist) as archive:
        held = {name.partition("/")[2] for name in archive.getnames()}
    assert files - held <= {".gitignore"}
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
    for name in files:
        kept = name.startswith("reports/reference/") and not name.endswith((".png", "index.html"))
        if name.startswith(("studies/", "meshes/")) or kept:
            assert f"drumlin/carried/{name}" in names
        # Both packages are in the wheel: what a user runs, and what its studies import.
        if name.startswith("src/") and name.endswith(".py"):
            assert name.removeprefix("src/") in names
    assert not any("__pycache__" in name or name.startswith(("studies", "tests")) for name in names)


@pytest.mark.slow
def test_the_wheel_serves_in_an_empty_folder(built, tmp_path):
    """The built wheel serves in an empty folder, the page included.

    Its environment borrows all libraries of this one but drumlin.
    """
    place, here = tmp_path / "environment", tmp_path / "empty"
    here.mkdir()
    venv.create(place, with_pip=True)
    python = place / "bin" / "python"
    subprocess.run(
        [python, "-m", "pip", "install", "--quiet", "--no-deps", built[0]], check=True, cwd=here
    )
    site = next((place / "lib").glob("python*/site-packages"))
    borrowed = [path for path in sys.path if path.endswith("site-packages")]
    (site / "borrowed.pth").write_text("".join(f"{path}\n" for path in borrowed))
    free = {
        key: value for key, value in os.environ.items() if key not in {"PYTHONPATH", "PYTHONHOME"}
    }

    def run(*words):
        done = subprocess.run(
            [place / "bin" / "drumlin", *map(str, words)],
            cwd=here,
            env=free,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    where = [
        python,
        "-c",
        "import drumlin.studies as s; print(s.FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES)",
    ]
    at = Path(
        subprocess.run(
            where, cwd=here, env=free, capture_output=True, text=True, check=True
        ).stdout.strip()
    )
    assert at == site / "drumlin" / "carried"
    # README's lines of Python and its commands.
    readme = (ROOT / "README.md").read_text()
    (code,) = re.findall(r"```python\n(.*?)```", readme, re.DOTALL)
    printed = subprocess.run(
        [python, "-c", code], cwd=here, env=free, capture_output=True, text=True, check=True
    ).stdout
    assert printed.startswith("fem: torque 447.593 N m") and not list(here.iterdir())
    assert "double_shoe" in run("init")
    (here / "my.toml").write_text(run("init", "double_shoe"))
    (here / "mesh.toml").write_text(run("init", "web_shoe"))
    assert "torque 447.593 N m" in run("solve", "my.toml")
    assert "torque" in run("solve", "mesh.toml")
    run("view", "my.toml", "--elements", 10)
    assert (here / "my.png").read_bytes().startswith(b"\x89PNG")
    run("compare", "my.toml", "--elements", 10)
    assert (here / "reports" / "my" / "index.html").is_file()
    run("study", "double_shoe", "--short")
    assert (here / "reports" / "double_shoe" / "index.html").is_file()
    run("study", "paper")
    assert (here / "reports" / "paper" / "index.html").is_file()
    kept = run("solve", "my.toml", "--elements", 80, "--pressure", "p.csv") and run(
        "check", "my.toml", "p.csv"
    )
    # The wheel carries the reference values.
    assert "carried" in kept.splitlines()[0]
    program = [place / "bin" / "drumlin"]
    with served(program, "my.toml", cwd=here, env=free) as address, browser(tmp_path) as page:
        link = play(page, address)
        with urlopen(link.replace("/?", "/brake.toml?")) as saved:
            (here / "explored.toml").write_bytes(saved.read())
    assert read_drum_or_plane_brake(here / "explored.toml").friction == 0.34
    assert "torque" in run("solve", "explored.toml")
    assert not list(site.glob("drumlin/carried/reports/*.html")) and not list(
        site.rglob("drumlin/reports")
    )
