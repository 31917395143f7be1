"""The recipe for conda-forge says what pyproject.toml says: needs, extras, commands and license."""

import re
import shlex
import tomllib

import pytest
import yaml

from command_line import drumlin
from conftest import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
TEXT = (ROOT / "recipe" / "recipe.yaml").read_text(encoding="utf-8")
RECIPE = yaml.safe_load(TEXT)
NAMES_THERE = {"matplotlib": "matplotlib-base", "gmsh": "python-gmsh"}
"""Names of conda-forge for packages that are named otherwise in pyproject.toml."""


def needs(lines):
    """Lower bounds by the names that the packages have at conda-forge."""
    found = {}
    for line in lines:
        name, bound = re.fullmatch(r"([\w-]+) ?(>=[\w.]+)", line).groups()
        found[NAMES_THERE.get(name, name)] = bound
    return found


def filled(text):
    """A text of the recipe with the values of its context."""
    return re.sub(r"\$\{\{ (\w+) \}\}", lambda found: RECIPE["context"][found[1]], text)


def test_the_recipe_needs_what_the_package_needs():
    run = list(map(filled, RECIPE["requirements"]["run"]))
    assert run[0] == f"python {PROJECT['project']['requires-python']}"
    assert needs(run[1:]) == needs(PROJECT["project"]["dependencies"])
    host = list(map(filled, RECIPE["requirements"]["host"]))
    assert host[:2] == [f"python {RECIPE['context']['python_min']}.*", "pip"]
    assert needs(host[2:]) == needs(PROJECT["build-system"]["requires"])


def test_the_recipe_bounds_what_the_extras_add():
    """All extras but that of developers; what the package needs anyway is not repeated."""
    extras = PROJECT["project"]["optional-dependencies"]
    wanted = {}
    for name, lines in extras.items():
        if name != "dev":
            wanted |= needs(lines)
    for name in needs(PROJECT["project"]["dependencies"]):
        wanted.pop(name, None)
    assert needs(RECIPE["requirements"]["run_constraints"]) == wanted


def test_the_recipe_has_the_number_the_commands_and_the_license():
    project = PROJECT["project"]
    assert RECIPE["context"]["version"] == project["version"]
    assert RECIPE["package"] == {"name": project["name"], "version": "${{ version }}"}
    commands = [f"{name} = {function}" for name, function in project["scripts"].items()]
    assert RECIPE["build"]["python"]["entry_points"] == commands
    # Without compiled code one package serves all systems.
    assert RECIPE["build"]["noarch"] == "python"
    about = RECIPE["about"]
    assert about["license"] == project["license"]
    assert [about["license_file"]] == project["license-files"]
    assert about["summary"] == project["description"]
    # The addresses are filled in with the first release, in both files.
    assert about.get("homepage") == project.get("urls", {}).get("Homepage")
    assert filled(RECIPE["source"]["path"]).endswith(f"drumlin-{project['version']}.tar.gz")
    assert "://" not in TEXT


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_what_the_recipe_tests_holds(tmp_path, monkeypatch):
    """The modules can be imported, and the commands end without error in an empty folder."""
    monkeypatch.chdir(tmp_path)
    python, script = RECIPE["tests"]
    for name in python["python"]["imports"]:
        __import__(name)
    for line in script["script"]:
        command, _, file = line.partition(" > ")
        program, *words = shlex.split(command)
        assert program in PROJECT["project"]["scripts"]
        done = drumlin(*words)
        assert done.returncode == 0 and done.stdout, line
        if file:
            (tmp_path / file).write_text(done.stdout, encoding="utf-8")
