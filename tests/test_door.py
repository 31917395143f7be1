"""The public door: what `import drumlin` offers, and that importing it does nothing else."""

import importlib
import json
import subprocess
import sys

import pytest

import drumlin
from drumlin.laws import sine
from drumlin.response.balance import contact_resultant
from drumlin.response.merit import merit

BRAKE = "studies/double_shoe/brake.toml"


def test_every_public_name_is_there():
    for name in drumlin.__all__:
        assert getattr(drumlin, name) is not None
    assert set(dir(drumlin)) == set(drumlin.__all__)
    with pytest.raises(AttributeError, match="nonsense"):
        drumlin.nonsense  # noqa: B018


def test_importing_it_loads_nothing_and_changes_nothing():
    program = (
        "import json, os, sys; before, loaded = dict(os.environ), set(sys.modules); import drumlin;"
        "print(json.dumps([dict(os.environ) == before, sorted(set(sys.modules) - loaded)]))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    same, loaded = json.loads(done.stdout)
    assert same
    assert not {name.split(".")[0] for name in loaded} & {
        "numpy",
        "scipy",
        "pydantic",
        "skfem",
        "matplotlib",
    }


@pytest.mark.parametrize(
    ("old", "new", "name"),
    [
        ("drumlin.errors", "drumlin.base.errors", "BadInput"),
        ("drumlin.fem.assembly", "drumlin.fem.preparation.prepare", "prepare"),
        ("drumlin.fem.group", "drumlin.fem.equilibrium.group", "groups_of"),
        ("drumlin.fem.self_locking", "drumlin.fem.analysis.self_locking", "limits"),
        ("drumlin.fem.sensitivity", "drumlin.fem.analysis.sensitivity", "sensitivity"),
    ],
)
def test_a_module_that_has_moved_answers_by_its_old_name_with_a_warning(old, new, name):
    moved = importlib.import_module(old)
    with pytest.warns(DeprecationWarning, match=f"{old} has moved to {new}") as said:
        found = getattr(moved, name)
    assert found is getattr(importlib.import_module(new), name)
    # The warning points to the line that asks, not into drumlin.
    assert said[0].filename == __file__
    with pytest.raises(AttributeError, match="nonsense"):
        moved.nonsense  # noqa: B018


def test_a_path_may_be_a_text_and_a_response_carries_its_figures_of_merit(root):
    brake = drumlin.read_brake(str(root / BRAKE))
    response = drumlin.solve(brake, elements=10)
    assert response.torque == pytest.approx(sum(shoe.torque for shoe in response.shoes))
    for i, shoe in enumerate(response.shoes):  # T/(F R) by hand, F = 2 kN, R = 150 mm
        assert response.merits[i].shoe_factor == pytest.approx(
            shoe.torque / (2000 * 0.150), rel=1e-12
        )
        assert response.merits[i] == merit(brake, i, shoe, contact_resultant(brake, i, shoe))
    assert response.bearing_load is not None
    assert drumlin.solve(brake, "sine").torque == sine(brake).torque


def test_a_response_shows_itself(root):
    response = drumlin.solve(drumlin.read_brake(root / BRAKE), "sine")
    lines = repr(response).splitlines()
    assert lines[0] == f"sine: torque {response.torque:.6g} N m"
    assert [line.split()[0] for line in lines[2:]] == ["right", "left", "all"]
    page = response._repr_html_()
    assert page.count("<tr>") == 4
    assert f"<td>{response.shoes[1].torque:.6g}</td>" in page
    axes = response.plot()
    for line, shoe in zip(axes.lines, response.shoes, strict=True):
        assert line.get_ydata().max() == pytest.approx(shoe.peak_pressure * 1e-6, rel=1e-3)
        assert line.get_xdata()[[0, -1]] == pytest.approx(
            [57.29577951308232 * shoe.theta[k] for k in (0, -1)]
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
