"""The public door: what `import drumlin` offers, and that importing it does nothing else."""

import ast
import doctest
import importlib
import inspect
import json
import re
import subprocess
import sys
import time

import nbformat
import pytest

import drumlin
from conftest import partly
from drumlin.laws import solve_brake_by_sine_law
from drumlin.models import MODELS, NAMES_OF_BUILT_IN_MODELS
from drumlin.response.balance import resultant_of_contact_on_shoe
from drumlin.response.merit import figures_of_merit_of_shoe_on_drum
from picking import picked

BRAKE = "studies/double_shoe/brake.toml"
HEAVY = {"numpy", "scipy", "pydantic", "skfem", "matplotlib"}
FUNCTIONS = sorted(name for name in drumlin.__all__ if inspect.isfunction(getattr(drumlin, name)))
START_UP = 0.3
"""Seconds of processor time that importing drumlin may add to a start of Python.

It takes some 5 ms. A first import of numpy alone takes 60 ms or more, so that on a machine a few
times as slow the limit still tells the one from the other.
"""


def test_every_public_name_is_there():
    for name in drumlin.__all__:
        assert getattr(drumlin, name) is not None
    assert set(dir(drumlin)) == set(drumlin.__all__)
    with pytest.raises(AttributeError, match="nonsense"):
        drumlin.nonsense  # noqa: B018


def printed_by(program):
    """What a program prints as JSON, run by an interpreter of its own."""
    command = [sys.executable, "-c", program]
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def packages(modules):
    """The packages to which modules belong."""
    return {name.split(".")[0] for name in modules}


def test_importing_it_loads_nothing_and_changes_nothing():
    same, loaded = printed_by(
        "import json, os, sys; before, loaded = dict(os.environ), set(sys.modules); import drumlin;"
        "print(json.dumps([dict(os.environ) == before, sorted(set(sys.modules) - loaded)]))"
    )
    assert same
    assert not packages(loaded) & HEAVY


def test_naming_a_function_loads_nothing_heavy():
    loaded = printed_by(
        "import json, sys, drumlin; drumlin.solve, drumlin.wear, drumlin.reference;"
        "print(json.dumps(sorted(sys.modules)))"
    )
    assert not packages(loaded) & HEAVY


def test_importing_it_takes_hardly_longer_than_starting_python():
    def least_seconds(program):
        """The least processor time of some starts: a busy machine only adds to it."""
        seconds = []
        for _ in range(5):
            done = subprocess.run(
                [sys.executable, "-c", f"{program}; import time; print(time.process_time())"],
                capture_output=True,
                text=True,
                check=True,
            )
            seconds.append(float(done.stdout))
        return min(seconds)

    assert least_seconds("import drumlin") - least_seconds("pass") < START_UP
    start = time.process_time()
    drumlin.__getattr__("solve")
    assert time.process_time() - start < START_UP


# what each function promises


@pytest.mark.parametrize("name", FUNCTIONS)
def test_its_options_have_types_and_names(name):
    """No option hides behind `**options`, and every parameter and result has a type."""
    for parameter in inspect.signature(getattr(drumlin, name)).parameters.values():
        assert parameter.kind not in {parameter.VAR_KEYWORD, parameter.VAR_POSITIONAL}, parameter
        assert parameter.annotation not in {parameter.empty, "Any"}, parameter
    assert (
        inspect.signature(getattr(drumlin, name)).return_annotation is not inspect.Parameter.empty
    )


@pytest.mark.parametrize("name", partly(FUNCTIONS, set(FUNCTIONS) - {"reference"}))
def test_the_example_in_its_docstring_runs(name, root, tmp_path, monkeypatch):
    (tmp_path / "loads.toml").write_text(
        f'brake = "{(root / BRAKE).as_posix()}"\n[model.sine]\n[vary]\nfriction = [0.3, 0.4]\n'
    )
    (tmp_path / "brake.toml").write_text((root / BRAKE).read_text())
    monkeypatch.chdir(tmp_path)
    (found,) = doctest.DocTestFinder(recurse=False).find(
        getattr(drumlin, name), name, globs={"drumlin": drumlin}
    )
    assert found.examples
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    lines = []
    runner.run(found, out=lines.append)
    # The example of `law` registers a law, which other tests must not meet.
    for law in set(MODELS) - NAMES_OF_BUILT_IN_MODELS:
        del MODELS[law]
    assert not runner.failures, "".join(lines)


def test_a_path_and_its_brake_give_the_same_answer(root, tmp_path):
    path = root / BRAKE
    brake = drumlin.read_brake(path)
    drumlin.write_brake(path, tmp_path / "again.toml")
    assert drumlin.read_brake(tmp_path / "again.toml") == brake
    with pytest.raises(drumlin.BadInput, match=r"again\.toml: cannot be written \(File exists\)"):
        drumlin.write_brake(brake, tmp_path / "again.toml")
    assert drumlin.solve(str(path), "sine").torque == drumlin.solve(brake, "sine").torque
    slopes = [drumlin.sensitivity(given, elements=8).friction for given in (path, brake)]
    assert slopes[0] == slopes[1]
    held = [drumlin.hold(given, elements=8, steps=2).states[-1].torque for given in (path, brake)]
    assert held[0] == held[1] > 0


def test_an_option_of_another_model_is_refused_in_a_line(root):
    brake = drumlin.read_brake(root / BRAKE)
    with pytest.raises(drumlin.BadInput, match='finite_width and fields belong to model="fem"'):
        drumlin.solve(brake, "sine", elements=10)
    with pytest.raises(drumlin.BadInput, match='sections and lift belong to model="found'):
        drumlin.solve(brake, sections=10)
    with pytest.raises(drumlin.BadInput, match='worn_in belongs to model="fem"'):
        drumlin.solve(brake, "sine", worn_in=True)
    with pytest.raises(drumlin.BadInput, match=r"penalty = 0.0: must be greater than 0"):
        drumlin.solve(brake, penalty=0.0)
    with pytest.raises(drumlin.BadInput, match="steps = 0: must be from 1 to 10000"):
        drumlin.hold(brake, steps=0)


def test_wear_counts_its_distance_in_metres_units_or_words(root):
    brake = drumlin.read_brake(root / BRAKE)
    by_number = drumlin.wear(brake, elements=8, distance=1000.0).states[-1].s
    by_words = drumlin.wear(brake, elements=8, distance="1 km").states[-1].s
    assert by_number == by_words == pytest.approx(1000.0)
    run = drumlin.wear(brake, elements=8, distance="0.5")
    lining = brake.shoes[0].lining
    unit = lining.thickness / (run.law.coefficient * lining.material.E)
    assert run.states[-1].s == pytest.approx(0.5 * unit)
    assert run.as_dict()["states"][-1]["distance"] == run.states[-1].s
    assert run.lines()[0].startswith("internal double-shoe brake: fem")


def test_the_locking_limit_is_a_pole_of_the_torque(root):
    brake = drumlin.read_brake(root / BRAKE)
    limit = min(drumlin.self_locking(brake, elements=12), key=lambda limit: limit.friction)
    near, nearer = (
        drumlin.solve(
            drumlin.vary(brake, {"friction": limit.friction * (1 - part)}),
            elements=12,
            penalty=float("inf"),
        ).torque
        for part in (2e-3, 1e-3)
    )
    # The torque grows as 1/(mu_lock - mu), so that half the distance doubles it.
    assert nearer / near == pytest.approx(2, rel=0.05)
    with pytest.raises(drumlin.NoAnswer, match="self-locking"):
        drumlin.solve(drumlin.vary(brake, {"friction": limit.friction * 1.01}), elements=12)


def test_fields_are_written_for_every_shoe_and_ring(root, tmp_path):
    import meshio

    brake = drumlin.example("double_shoe")
    found = drumlin.fields(brake, tmp_path / "fields.vtu", elements=8)
    assert len(found) == len(brake.shoes)
    points = meshio.read(tmp_path / "fields.vtu").points
    assert len(points) == sum(map(len, picked(found, "points")))
    with pytest.raises(drumlin.BadInput, match=r"must end in \.vtu"):
        drumlin.fields(brake, tmp_path / "fields.png")


def test_a_result_is_checked_against_stored_values(root, tmp_path):
    from drumlin.verification.check import pressure_curves_as_csv

    table = tmp_path / "p.csv"
    table.write_text(pressure_curves_as_csv(drumlin.solve(root / BRAKE)))
    found = drumlin.check(root / BRAKE, table, tolerance=1e-3)
    assert found.within
    assert found.reference.endswith("double_shoe_brake.json")
    assert found.lines()[-1] == "within 0.1 % of the reference"
    assert not drumlin.check(root / BRAKE, table, tolerance=1e-9).within


# what the manual and the notebooks use


def public_names(module):
    """The public names of a module: those that it lists, else all that it defines or imports."""
    listed = getattr(module, "__all__", None)
    return set(listed or [name for name in vars(module) if not name.startswith("_")])


def imports_of(source):
    """The names (module, name or None) that a piece of Python imports from drumlin."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from ((alias.name, None) for alias in node.names)
        if isinstance(node, ast.ImportFrom):
            yield from ((node.module, alias.name) for alias in node.names)


def cells(root):
    """Name and source of each piece of Python in the manual's pages and in the notebooks."""
    for page in sorted((root / "studies" / "manual" / "pages").rglob("*.md")):
        for cell in re.findall(r"```\{code-cell\}\n(.*?)```", page.read_text(), re.S):
            # Such a cell is the text of a file.
            if cell.startswith("%%writefile"):
                continue
            yield page.name, re.sub(r"(?m)^(:tags:|!).*$", "", cell)
    for path in sorted((root / "studies" / "notebooks").glob("*.ipynb")):
        for cell in nbformat.read(path, as_version=4).cells:
            if cell.cell_type == "code":
                yield path.name, re.sub(r"(?m)^[!%].*$", "", cell.source)


def test_what_the_manual_and_the_notebooks_import_is_public(root):
    """A page imports the door, or a public name that a module of its own defines."""
    seen = 0
    for page, source in cells(root):
        for module, name in imports_of(source):
            if module.split(".")[0] not in {"drumlin", "drumlin_studies"}:
                continue
            seen += 1
            assert not any(part.startswith("_") for part in module.split(".")), (page, module)
            made = importlib.import_module(module)
            assert name is None or name in public_names(made), (page, module, name)
        for name in re.findall(r"\bdrumlin\.(\w+)\(", source):
            assert name in drumlin.__all__, (page, name)
    assert seen > 10


@pytest.mark.parametrize(
    ("old", "new", "name", "present"),
    [
        ("drumlin.errors", "drumlin.base.errors", "BadInput", "BadInput"),
        (
            "drumlin.fem.assembly",
            "drumlin.fem.preparation.prepare",
            "prepare",
            "make_prepared_model",
        ),
        (
            "drumlin.fem.group",
            "drumlin.fem.equilibrium.group",
            "groups_of",
            "divide_pressed_shoes_into_groups",
        ),
        (
            "drumlin.fem.self_locking",
            "drumlin.fem.analysis.self_locking",
            "limits",
            "self_locking_friction_of_shoe_groups",
        ),
        (
            "drumlin.fem.sensitivity",
            "drumlin.fem.analysis.sensitivity",
            "sensitivity",
            "compute_torque_sensitivity",
        ),
    ],
)
def test_a_module_that_has_moved_answers_by_its_old_name_with_a_warning(old, new, name, present):
    moved = importlib.import_module(old)
    with pytest.warns(DeprecationWarning, match=f"{old} has moved to {new}") as said:
        found = getattr(moved, name)
    assert found is getattr(importlib.import_module(new), present)
    # The warning points to the line that asks, not into drumlin.
    assert said[0].filename == __file__
    with pytest.raises(AttributeError, match="nonsense"):
        moved.nonsense  # noqa: B018


@pytest.mark.parametrize(
    ("module", "name", "present"),
    [
        ("drumlin.laws", "sine", "solve_brake_by_sine_law"),
        ("drumlin.foundation", "why_not", "reason_against_foundation_model"),
        ("drumlin.peers", "missing", "install_hint_if_missing"),
    ],
)
def test_a_renamed_function_answers_by_its_old_name_with_a_warning(module, name, present):
    owner = importlib.import_module(module)
    with pytest.warns(DeprecationWarning, match=f"{module}.{name} is now {present}") as said:
        found = getattr(owner, name)
    assert found is getattr(owner, present)
    assert said[0].filename == __file__
    with pytest.raises(AttributeError, match="nonsense"):
        owner.nonsense  # noqa: B018


def test_a_path_may_be_a_text_and_a_response_carries_its_figures_of_merit(root):
    brake = drumlin.read_brake(str(root / BRAKE))
    response = drumlin.solve(brake, elements=10)
    assert response.torque == pytest.approx(sum(picked(response.shoes, "torque")))
    # The brake factor is T/(F R) by hand with F = 2 kN and R = 150 mm.
    for i, shoe in enumerate(response.shoes):
        assert response.merits[i].shoe_factor == pytest.approx(
            shoe.torque / (2000 * 0.150), rel=1e-12
        )
        assert response.merits[i] == figures_of_merit_of_shoe_on_drum(
            brake, i, shoe, resultant_of_contact_on_shoe(brake, i, shoe)
        )
    assert response.bearing_load is not None
    assert drumlin.solve(brake, "sine").torque == solve_brake_by_sine_law(brake).torque


def test_a_response_shows_itself(root):
    response = drumlin.solve(drumlin.read_brake(root / BRAKE), "sine")
    lines = repr(response).splitlines()
    assert lines[0] == f"sine: torque {response.torque:.6g} N m"
    assert [line.split()[0] for line in lines[2:5]] == ["right", "left", "all"]
    page = response._repr_html_()
    assert page.count("<tr>") == 4
    assert f"<td>{response.shoes[1].torque:.6g}</td>" in page
    axes = response.plot()
    for line, shoe in zip(axes.lines, response.shoes, strict=True):
        assert line.get_ydata().max() == pytest.approx(shoe.peak_pressure * 1e-6, rel=1e-3)
        assert line.get_xdata()[[0, -1]] == pytest.approx(
            [57.29577951308232 * shoe.theta[0], 57.29577951308232 * shoe.theta[-1]]
        )


def test_compare_and_sweep_are_functions_whatever_was_imported_before(root):
    import drumlin.comparison
    import drumlin.sweeps.cases

    brake = drumlin.read_brake(root / BRAKE)
    assert set(drumlin.compare(brake, models=["sine", "uniform"]).responses) == {"sine", "uniform"}
    with pytest.raises(drumlin.BadInput, match=r"nowhere\.toml"):
        drumlin.sweep("nowhere.toml")


def test_a_shoe_on_a_plane_shows_its_braking_force_and_lengths(root):
    response = drumlin.solve(drumlin.read_brake(root / "studies/laws/pad.toml"), "linear")
    force, shoe = response.merits[0].braking_force, response.shoes[0]
    lines = repr(response).splitlines()
    assert lines[0] == f"linear: braking force {force:.6g} N"
    assert f"{shoe.contact_arcs[0][0] * 1e3:.1f} to {shoe.contact_arcs[0][1] * 1e3:.1f}" in lines[2]
    assert response.plot().lines[0].get_xdata()[-1] == pytest.approx(shoe.theta[-1] * 1e3)
