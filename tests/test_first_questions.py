"""What a newcomer asks: numbers of the manual's page on laws, and lines that explain themselves."""

import math
import re

import numpy as np
import pytest

import drumlin
from command_line import drumlin as run
from conftest import ROOT
from drumlin.base.errors import BadInput
from drumlin.brake.plausibility import (
    LARGEST_USUAL_UNIFORM_CLEARANCE_OVER_RADIUS,
    notes_on_implausible_brake_values,
)
from drumlin.fem.width.prepare import reason_why_width_model_does_not_apply

WHICH_LAW = ROOT / "studies" / "manual" / "pages" / "engineer" / "which_law.md"
CELL = re.compile(r"^```\{code-cell\}\n(.*?)^```", re.MULTILINE | re.DOTALL)


@pytest.fixture
def here(tmp_path, monkeypatch):
    """An empty folder with the example double_shoe in my.toml."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my.toml").write_text((ROOT / "studies/double_shoe/brake.toml").read_text())
    return tmp_path


# which law is right to how much


@pytest.mark.slow
def test_the_page_on_laws_says_what_its_tables_show(monkeypatch):
    """The page says by numbers what is stiff and what fits; its cells compute the errors."""
    monkeypatch.setenv("MPLBACKEND", "agg")
    text = WHICH_LAW.read_text(encoding="utf-8")
    names = {}
    for cell in CELL.findall(text):
        code = "\n".join(line for line in cell.splitlines() if not line.startswith(":"))
        exec(compile(code, "which_law", "exec"), names)
    stiff = float(re.search(r"stiff if S is at least ([\d.]+)\.", text)[1])
    bounds = bounds_that_the_page_says(text)
    fitting = [row for row in names["misfit_rows"] if abs(row[0]) <= 1 and row[1] > stiff]
    rows = [errors for ratio, errors in names["stiffness_rows"] if ratio > stiff]
    assert len(rows) == 8 and len(fitting) == 12
    rows += [errors for _, _, errors in fitting]
    # Each bound holds for all stiff shoes whose linings fit, and is not far above the worst error.
    for friction, bounds_of_friction in bounds.items():
        for which, bound in enumerate(bounds_of_friction):
            found = max(abs(names["worst"](errors, which, friction)) for errors in rows)
            assert 0.8 * bound < found <= bound, (friction, which)
    # The friction of the lower bounds is the limit of what they hold for.
    assert max(abs(names["worst"](errors, 0, 0.5)) for errors in rows) > bounds[0.4][0]
    # Softer shoes and linings that do not fit are worse.
    soft = [errors for ratio, errors in names["stiffness_rows"] if ratio < stiff]
    misfits = [errors for share, _, errors in names["misfit_rows"] if abs(share) > 1]
    for others in (soft, misfits):
        assert max(abs(names["worst"](errors, 0, 0.4)) for errors in others) > bounds[0.4][0]
    # A lining that fits changes the torque by no more than the page says.
    change = float(re.search(r"by up to (\d+) % of the brake's torque", text)[1]) / 100
    for friction in names["FRICTIONS"]:
        for ratio in {ratio for _, ratio, _ in fitting}:
            own = {row[0]: row[2][friction][0] for row in fitting if row[1] == ratio}
            assert max(abs(own[1] - own[0]), abs(own[-1] - own[0])) <= change
    # The errors of shoes on abutments.
    least, most = (float(x) / 100 for x in re.search(r"by (\d+) to (\d+) % for", text).groups())
    abutted = [abs(errors[0]) for errors in names["abutted_rows"].values()]
    assert (min(abutted), max(abutted)) == pytest.approx((least, most), abs=0.006)


def bounds_that_the_page_says(text):
    """Errors of the torque of the brake and of a shoe, by the largest friction coefficient."""
    said = re.search(
        r"brake to some (\d+) %.*?shoe to some (\d+) %, up to a friction coefficient of ([\d.]+)\."
        r" Up to ([\d.]+) these are (\d+) % and (\d+) %",
        text,
        re.S,
    )
    brake, shoe, friction, more, brake_more, shoe_more = map(float, said.groups())
    # The table of rules repeats the errors of the torque of the brake.
    rules = re.findall(r"friction up to ([\d.]+) \| sine law, to some (\d+) %", text)
    assert [tuple(map(float, rule)) for rule in rules] == [(friction, brake), (more, brake_more)]
    return {friction: (brake / 100, shoe / 100), more: (brake_more / 100, shoe_more / 100)}


# clearance


def test_the_gap_of_an_adjuster_changes_nothing_but_an_even_gap_does(brake):
    """A shoe closes by a turn about its pin a gap that a turn has made."""
    gaps = {}
    for i, shoe in enumerate(brake.shoes):
        pin = math.atan2(shoe.pin.xy[1], shoe.pin.xy[0])
        gaps[f"shoe[{i}].lining.clearance"] = lambda theta, pin=pin: (
            0.3e-3 * abs(np.sin(theta - pin))
        )
    adjusted = drumlin.vary(brake, gaps)
    even = drumlin.vary(brake, {"shoe.lining.clearance": 0.3e-3})
    fits = drumlin.solve(brake, elements=20).torque
    assert drumlin.solve(adjusted, elements=20).torque == pytest.approx(fits, rel=1e-5)
    assert drumlin.solve(even, elements=20).torque < 0.9 * fits
    assert not notes_on_implausible_brake_values(adjusted)
    (note,) = notes_on_implausible_brake_values(even)
    assert "shoe[0].lining.clearance = 0.3 mm is a gap along the whole lining" in note
    assert "which the shoe closes by a turn about its pin (1 more shoe alike)" in note
    small = drumlin.vary(
        brake, {"shoe.lining.clearance": 0.99 * LARGEST_USUAL_UNIFORM_CLEARANCE_OVER_RADIUS * 0.15}
    )
    assert not notes_on_implausible_brake_values(small)


# sweeps


def test_a_sweep_says_that_a_law_does_not_use_a_key(here):
    """In the terminal, in Python and in a notebook; with a key that acts on the finite elements."""
    (here / "s.toml").write_text(
        'brake = "my.toml"\n[model.sine]\n[model.fem]\nelements = 10\n'
        "[vary]\nfriction = [0.2, 0.3]\n"
        '"shoe.lining.clearance" = ["0 mm", "0.05 mm"]\n'
    )
    said = "sine does not use shoe.lining.clearance: no result depends on it"
    assert run("sweep", "s.toml", "--jobs", 1).stdout.splitlines()[1] == said
    keys = {
        "shoe.body.thickness": {"distribution": "normal", "deviation": "3 %", "each_shoe": True},
        "friction": [0.2, 0.3],
        "shoe.lining.width": ["40 mm", "41 mm"],
    }
    table = drumlin.sweep("my.toml", keys, model=["sine", "uniform"], cases=3)
    (sine, uniform) = table.notes
    assert sine == (
        "sine does not use shoe[0].body.thickness, shoe[1].body.thickness: no result depends on it"
    )
    assert uniform == sine.replace("sine", "uniform") and "friction" not in sine
    assert sine in repr(table) and sine in table._repr_html_()


@pytest.mark.parametrize(
    ("combine", "forces", "torques"),
    [
        ("grid", ["0 N", "300 N"], 3),
        # The force is zero in the first and the last case, not in cases between.
        ("grid", ["0 N", "300 N", "0 N"], 3),
        # No two cases differ in the direction alone, and the last case has a force.
        ("zip", ["0 N", "300 N"], 2),
    ],
)
def test_a_key_with_an_effect_only_beside_another_key_has_no_note(here, combine, forces, torques):
    """The direction of a further force changes the torque where the force is not zero."""
    load = {"force": 0.0, "direction": 0.0, "point": {"x": 0.05, "y": 0.02}}
    brake = drumlin.vary(drumlin.example("double_shoe"), {"shoe.force": [load]})
    keys = {"shoe[0].force[0].force": forces, "shoe[0].force[0].direction": ["0 deg", "60 deg"]}
    table = drumlin.sweep(brake, keys, model="sine", combine=combine)
    assert len(set(table["torque"].round(6))) == torques and not table.notes


def test_a_table_in_a_pipe_has_all_its_columns(here, monkeypatch):
    """On a terminal of 40 columns some are left out, in a pipe none, however long the names are."""
    monkeypatch.delenv("COLUMNS", raising=False)
    name = "a rather long name of the shoe that gives most of the torque of this brake"
    text = (here / "my.toml").read_text().replace('name = "left"', f'name = "{name}"')
    (here / "my.toml").write_text(text)
    (here / "s.toml").write_text('brake = "my.toml"\n[model.sine]\n[vary]\nfriction = [0.2, 0.3]\n')
    lines = run("sweep", "s.toml", "--jobs", 1).stdout.splitlines()
    assert max(map(len, lines)) > 100
    assert lines[1].split() == ["mean", "spread", "5", "%", "95", "%", "least", "most"]
    monkeypatch.setenv("COLUMNS", "40")
    lines = run("sweep", "s.toml", "--jobs", 1).stdout.splitlines()
    assert any("not shown here, the terminal is too" in line for line in lines)


# words of errors and of comparisons


def test_a_diameter_in_place_of_the_radius_gets_a_hint(here):
    text = (here / "my.toml").read_text().replace('radius = "150 mm"', 'diameter = "300 mm"', 1)
    (here / "my.toml").write_text(text)
    with pytest.raises(BadInput, match=r"drum: unknown key 'diameter' \(write 'radius', half of"):
        drumlin.read_brake("my.toml")


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ("backing", "has a group backing, and the shoe has no table [shoe.backing]"),
        ("body", "has a group shoe, and the shoe has no table [shoe.body]"),
    ],
)
def test_a_group_without_its_table_is_named(tmp_path, table, said):
    text = (ROOT / "meshes" / "web_shoe.toml").read_text()
    text = re.sub(rf"\[shoe\.{table}\][^\[]*", "", text)
    text = text.replace('mesh = "', f'mesh = "{ROOT}/meshes/')
    (tmp_path / "b.toml").write_text(text)
    with pytest.raises(BadInput) as refused:
        drumlin.solve(drumlin.read_brake(tmp_path / "b.toml"))
    assert said in str(refused.value)


def test_a_mesh_file_says_what_would_know_the_error_of_plane_stress():
    reason = reason_why_width_model_does_not_apply(drumlin.example("double_shoe_meshes"))
    assert (
        "the widths of parts such as web and table, which [shoe.body] without mesh gives" in reason
    )


@pytest.mark.slow
def test_lines_of_a_comparison_have_no_bare_powers_of_ten(here):
    """Penetrations are in mm and changes in per cent, and a line explains the errors."""
    words = ("--elements", 10, "--verbose", "--output", here / "report")
    done = run("compare", "my.toml", *words)
    text = " ".join(done.stdout.split())
    assert "errors: differences from the model fem; of p (L2): the root of the mean square" in text
    assert re.search(
        r"enters the drum by [\d.e-]+ mm at most, which changes the torque by .* %", text
    )
    assert "lumped" not in text and "psi R" not in text
