"""Reference values against independent ones, their file, and the check of a table p(theta)."""

import json
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import independent
from conftest import ROOT, STUDY
from drumlin.base.errors import BadInput
from drumlin.brake.file import read_brake, vary
from drumlin.cli.commands import app
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.solve import solve
from drumlin.laws import solve_brake_by_sine_law
from drumlin.verification import triangles
from drumlin.verification.check import (
    are_curve_deviations_within_tolerance,
    compare_curves_with_reference,
    pressure_curves_as_csv,
    read_pressure_curves,
    text_lines_on_errors_of_pressure_table,
)
from drumlin.verification.reference import (
    MeshesOfReferenceValues,
    compute_reference_values,
    solve_brake_for_reference_values,
)
from drumlin.verification.reference_file import (
    path_of_stored_reference_for_brake_file_text,
    read_reference_file,
    reference_values_as_json_data,
    write_reference_file,
)
from picking import having, keyed, picked

QUICK = MeshesOfReferenceValues(
    2,
    (REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1], REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[2]),
    triangles.TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE[:2],
)
VALUES = ROOT / "reports" / "reference" / "values"


@pytest.fixture(scope="module")
def known():
    return read_reference_file(VALUES / "double_shoe_brake.json")


@pytest.fixture(scope="module")
def quick(brake):
    """Reference values by coarser meshes than those of the stored reference values."""
    return compute_reference_values(
        brake, "text", "command", solve_brake_for_reference_values(brake, QUICK)
    )


@pytest.mark.slow
def test_a_reference_agrees_with_a_coarser_one_and_with_another_discretisation(known, quick):
    """A reference agrees with a coarser one and with an independent discretisation.

    The independent one has an error of some 1e-5: from 45 to 90 elements it changes by 2e-5.
    """
    assert known.torque.value == pytest.approx(independent.torque("double_shoe/brake"), rel=2e-5)
    assert known.torque.relative_uncertainty < 1e-6
    assert quick.torque.value == pytest.approx(known.torque.value, rel=1e-5)
    for fine, coarse in zip(known.shoes, quick.shoes, strict=True):
        assert fine.distance < 1e-4 and fine.relative_pressure_uncertainty_outside_edge_zones < 5e-4
        off = (
            np.abs(fine.pressure - coarse.pressure)[fine.mask_of_angles_outside_edge_zones].max()
            / fine.peak_pressure.value
        )
        # The uncertainty covers what a finer mesh changes.
        assert off < 5 * coarse.relative_pressure_uncertainty_outside_edge_zones
        assert coarse.relative_pressure_uncertainty_outside_edge_zones < 5e-3


# These are folders of studies/.
STORED = ("brakes", "double_shoe", "laws", "plane_stress", "post_brake")


def test_every_stored_reference_is_of_its_brake_file_and_known_as_well_as_it_says():
    files = keyed(VALUES.glob("*.json"), "stem")
    assert len(files) >= 10
    for stem, path in files.items():
        found = read_reference_file(path)
        folder = next(f for f in STORED if stem.startswith(f + "_"))
        brake_file = ROOT / "studies" / folder / f"{stem.removeprefix(folder + '_')}.toml"
        assert tomllib.loads(found.text) == tomllib.loads(brake_file.read_text())
        assert path_of_stored_reference_for_brake_file_text(found.text, VALUES) == path
        assert path.stat().st_size < 60_000
        assert found.torque.relative_uncertainty < 2e-6
        brake = read_brake(brake_file)
        coarse = solve(brake, elements=40)
        assert coarse.torque == pytest.approx(found.torque.value, rel=1e-3)
        for shoe, answer in zip(found.shoes, coarse.shoes, strict=True):
            assert answer.hinge_reaction == pytest.approx(
                np.array(shoe.hinge_reaction.value),
                abs=5e-3 * np.linalg.norm(shoe.hinge_reaction.value),
            )
            own = having(brake.shoes, name=shoe.name)[0]
            if own.kind_of_support != "hinge" or brake.links or brake.actuation is not None:
                # A lever, a strut or a cam pushes this shoe too.
                continue
            drum, pin = np.array(shoe.contact_force.value), np.array(shoe.hinge_reaction.value)
            force = own.actuation.force_vector
            assert np.linalg.norm(drum + pin + force) < 1e-6 * np.linalg.norm(force)


def test_a_file_of_reference_values_returns_what_was_written(known, tmp_path):
    path = tmp_path / "values.json"
    write_reference_file(reference_values_as_json_data(known), path)
    assert reference_values_as_json_data(
        read_reference_file(path)
    ) == reference_values_as_json_data(known)
    # Arrays stand on a line each.
    assert max(map(len, path.read_text().splitlines())) > 1000
    for text in ("", "[]", '{"format": "other"}', path.read_text().replace('"edge"', '"edgy"')):
        path.write_text(text)
        with pytest.raises(BadInput, match=r"values\.json"):
            read_reference_file(path)
    path.write_text(json.dumps({"no": "reference"}))
    assert path_of_stored_reference_for_brake_file_text("text", tmp_path) is None


def table(response, factor=1.0, step=0.25):
    """A response's p(theta) as somebody's CSV file, in degrees and MPa."""
    rows = ["shoe,theta [deg],p [MPa]"]
    for shoe in response.shoes:
        ends = np.degrees(shoe.theta[[0, -1]])
        for angle in np.linspace(*ends, round((ends[1] - ends[0]) / step) + 1):
            p = shoe.pressure_at(np.clip(np.radians(angle), *shoe.theta[[0, -1]]))
            rows.append(f"{shoe.name},{angle:.9f},{float(p) * 1e-6 * factor:.9g}")
    return "\n".join(rows) + "\n"


def test_check_tells_good_curves_from_bad_ones(brake, known, tmp_path):
    path = tmp_path / "p.csv"
    response = solve(brake, elements=120)
    path.write_text(table(response))
    good = compare_curves_with_reference(brake, known, read_pressure_curves(path, brake))
    assert are_curve_deviations_within_tolerance(good, 0.005) and all(
        v.distance < 1e-3 for v in good
    )
    path.write_text(table(response, factor=1.05))
    for verdict in compare_curves_with_reference(brake, known, read_pressure_curves(path, brake)):
        assert verdict.distance == pytest.approx(0.05, abs=2e-3)
        assert verdict.torque_error == pytest.approx(0.05, abs=4e-3)
    path.write_text(table(solve_brake_by_sine_law(brake)))
    law = compare_curves_with_reference(brake, known, read_pressure_curves(path, brake))
    assert not are_curve_deviations_within_tolerance(law, 0.05)
    assert (
        text_lines_on_errors_of_pressure_table(law, 0.05)[-1] == "NOT within 5 % of the reference"
    )
    # whole turns, radians, Pa and the order of lines change nothing
    heading, *rows = table(response).splitlines()
    turned = [heading.replace("[deg]", "[rad]").replace("[MPa]", "[Pa]")]
    for name, angle, p in (row.split(",") for row in reversed(rows)):
        turned.append(f"{name},{np.radians(float(angle)) - 2 * np.pi},{float(p) * 1e6}")
    path.write_text("\n".join(turned))
    again = compare_curves_with_reference(brake, known, read_pressure_curves(path, brake))
    assert picked(again, "distance") == pytest.approx(picked(good, "distance"), rel=1e-5)


BAD = {
    "": "is empty",
    "shoe,theta,p [MPa]\n": r"line 1: 'theta'",
    "shoe,theta [mm],p [MPa]\n": r"line 1: 'theta \[mm\]'",
    "shoe,theta [deg]\n": "no column 'p'",
    "theta [deg],p [MPa]\n0,1\n": "no column 'shoe'",
    "shoe,theta [deg],p [MPa]\nmiddle,0,1\n": r"line 2: shoe = 'middle'.*right, left",
    "shoe,theta [deg],p [MPa]\nright,0,nan\n": "line 2: p = 'nan'",
    "shoe,theta [deg],p [MPa]\nright,zero,1\n": "line 2: theta = 'zero'",
    "shoe,theta [deg],p [MPa]\nright,0\n": "line 2: 2 cells",
    "shoe,theta [deg],p [MPa]\nright,0,1\nright,0,2\n": "stands twice",
    "shoe,theta [deg],p [MPa]\nright,0,1\n": "1 points",
}


@pytest.mark.parametrize("text", BAD)
def test_a_table_that_cannot_be_read_is_refused_in_one_line(text, brake, tmp_path):
    path = tmp_path / "p.csv"
    path.write_text(text)
    with pytest.raises(BadInput, match=BAD[text]) as caught:
        read_pressure_curves(path, brake)
    assert "\n" not in str(caught.value) and "p.csv" in str(caught.value)


def test_curves_that_stop_short_and_references_of_other_brakes_are_refused(brake, known, tmp_path):
    path = tmp_path / "p.csv"
    path.write_text(
        "shoe,theta [deg],p [MPa]\n"
        + "".join(f"{n},{a},1\n" for n in ("right", "left") for a in (0, 30))
    )
    with pytest.raises(BadInput, match="must reach from"):
        compare_curves_with_reference(brake, known, read_pressure_curves(path, brake))
    block = read_brake(ROOT / "studies" / "laws" / "block.toml")
    with pytest.raises(BadInput, match="another brake"):
        compare_curves_with_reference(block, known, {})
    path.write_text(pressure_curves_as_csv(solve(brake, elements=20)))
    others = {
        "friction": 0.31,
        "shoe[1].lining.material.E": 301e6,
        "shoe[0].lining.clearance": 1e-6,
        "drum.radius": 0.2,
    }
    # The shoes of other brakes bear the same names.
    for key, value in others.items():
        with pytest.raises(BadInput, match=re.escape(f"of another brake: {key} is not the same")):
            compare_curves_with_reference(
                vary(brake, {key: value}), known, read_pressure_curves(path, brake)
            )
    titled = vary(
        brake, {"title": "mine", "drum.radius": "15 cm", "shoe[0].lining.thickness": "0.8 cm"}
    )
    assert compare_curves_with_reference(titled, known, read_pressure_curves(path, brake))
    with pytest.raises(BadInput, match="mesh file"):
        solve_brake_for_reference_values(vary(brake, {"shoe[0].mesh": str(Path("s.msh"))}))


def test_pressures_that_solve_writes_are_read_by_check(brake, tmp_path):
    path, response = tmp_path / "p.csv", solve(brake, elements=20)
    path.write_text(pressure_curves_as_csv(response))
    for shoe, curve in zip(response.shoes, read_pressure_curves(path, brake).values(), strict=True):
        assert curve.theta == pytest.approx(shoe.theta, abs=1e-10)
        assert curve.p == pytest.approx(shoe.pressure, rel=1e-10)


@pytest.mark.slow
def test_commands(tmp_path):
    brake_file, path = STUDY.parent / "laws" / "short_block.toml", tmp_path / "p.csv"
    made = CliRunner().invoke(
        app, ["solve", str(brake_file), "--elements", "80", "--pressure", str(path)]
    )
    assert made.exit_code == 0 and path.read_text().startswith("shoe,theta [deg],p [MPa]\n")
    done = CliRunner().invoke(app, ["check", str(brake_file), str(path)])
    assert done.exit_code == 0 and "laws_short_block.json" in done.output
    assert done.output.splitlines()[-1] == "within 1 % of the reference"
    strict = CliRunner().invoke(app, ["check", str(brake_file), str(path), "--tolerance", "1e-9"])
    assert strict.exit_code == 0 and "NOT within 1e-07 % of" in strict.output
    with pytest.raises(BadInput, match="tolerance = 2"):
        CliRunner().invoke(
            app, ["check", str(brake_file), str(path), "--tolerance", "2"], catch_exceptions=False
        )
    made = CliRunner().invoke(
        app, ["reference", str(brake_file), "--output", str(tmp_path / "r.json")]
    )
    assert made.exit_code == 0 and "uncertainty" in made.output
    # The stored value must be the one that the command gives.
    kept = read_reference_file(VALUES / "laws_short_block.json").torque
    assert read_reference_file(tmp_path / "r.json").torque.value == pytest.approx(
        kept.value, abs=2 * kept.uncertainty
    )
