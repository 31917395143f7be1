"""Solid shoes: plane stress where they must agree, balances, fields, options and refusals."""

import json
from pathlib import Path

import meshio
import numpy as np
import pytest

from command_line import drumlin
from conftest import settled_sizes
from drumlin.base.errors import BadInput
from drumlin.brake.file import read_brake, vary
from drumlin.contact import self_locking
from drumlin.fem import solid
from drumlin.fem.analysis.solid_fields import recover_stresses_in_half_of_each_solid_shoe
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.width import prepare
from drumlin.fem.width.ladder import LARGEST_WIDTH_DEGREE_WITH_STATED_ERROR
from drumlin.fem.width.prepare import (
    prepare_model_with_shoe_widths,
    refinement_level_for_narrow_shoes,
)
from drumlin.response.balance import resultant_of_contact_on_shoe
from drumlin.response.norms import relative_error_of_number
from drumlin.sweeps.cases import solve_all_cases_of_sweep
from drumlin.sweeps.file import sweep_from_file_data
from drumlin.verification.cost import table_lines_of_solid_shoe_cost_by_degree
from picking import picked
from sections import t_section, widths, without_contraction

KINDS = ("crane", "duplex", "uni_servo", "s_cam", "block_on_lever")


def of_kind(root, name):
    return read_brake(root / "studies" / "brakes" / f"{name}.toml")


def wide_and_plane(brake):
    """The answers with degree 2 across the width and of plane stress, on one section."""
    return [
        solve_prepared_model(scene, brake)
        for scene in (
            prepare_model_with_shoe_widths(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], 2),
            make_prepared_model(
                brake,
                refinement_level_for_narrow_shoes(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0]),
            ),
        )
    ]


@pytest.mark.slow
@pytest.mark.parametrize("name", KINDS)
def test_without_lateral_contraction_every_kind_of_shoe_is_plane_stress(root, name):
    """Without lateral contraction every kind of solid shoe is plane stress.

    Pivots, abutments, struts, a cam: the rigid line across the width stands for the point of the
    plane.
    """
    brake = without_contraction(of_kind(root, name))
    wide, plane = wide_and_plane(brake)
    for mine, other in zip(wide.shoes, plane.shoes, strict=True):
        assert relative_error_of_number(mine.torque, other.torque) == pytest.approx(0, abs=1e-9)
        np.testing.assert_allclose(mine.pressure, other.pressure, atol=1e-8 * other.pressure.max())
        size = np.abs(other.hinge_reaction).max()
        np.testing.assert_allclose(mine.hinge_reaction, other.hinge_reaction, atol=1e-7 * size)
        assert mine.force == (None if other.force is None else pytest.approx(other.force, rel=1e-9))
        np.testing.assert_allclose(mine.motion or 0, other.motion or 0, rtol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("name", KINDS)
def test_every_kind_of_solid_shoe_balances_and_meets_the_drum(root, name):
    brake = of_kind(root, name)
    scene = prepare_model_with_shoe_widths(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], 2)
    response = solve_prepared_model(scene, brake)
    assert max(response.balance.force, response.balance.moment) < 1e-9
    for found in recover_stresses_in_half_of_each_solid_shoe(scene, brake, response):
        r = found.points[:, :2] / np.hypot(*found.points[:, :2].T)[:, None]
        on = found.pressure > 0
        moved = np.einsum("nc,nc->n", r, found.displacement[:, :2])[on]
        assert np.abs(moved).mean() < 0.05 * np.abs(found.displacement).max()


@pytest.mark.slow
@pytest.mark.parametrize("rotation", ["clockwise", "counter-clockwise"])
@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_forces_and_moments_balance(flexible, rotation, friction):
    brake = vary(t_section(flexible), {"rotation": rotation, "friction": friction})
    response = solid.solve(brake, across=2)
    assert max(response.balance.force, response.balance.moment) < 1e-9
    # Independently of the matrices: the integrals of the pressure over the exact arc, against pin
    # and actuation.
    for i, (shoe, found) in enumerate(zip(brake.shoes, response.shoes, strict=True)):
        contact = resultant_of_contact_on_shoe(brake, i, found)
        total = contact.force + found.hinge_reaction + shoe.actuation.force_vector
        assert np.linalg.norm(total) < 1e-7 * np.linalg.norm(shoe.actuation.force_vector)
        assert found.torque == pytest.approx(abs(contact.moment), rel=1e-8, abs=1e-6)


@pytest.mark.slow
def test_a_narrow_web_presses_under_itself(flexible):
    for found in solid.solve(t_section(flexible), across=3).shoes:
        middle = len(found.theta) // 2
        p = found.surface.pressure[middle]
        assert p[len(p) // 2] > 1.05 * p[-1]


@pytest.mark.slow
def test_the_mirror_image_of_a_brake_is_solved_alike(flexible):
    brake = t_section(flexible)
    turned = vary(brake, {"rotation": "clockwise"})
    a, b = solid.solve(brake, across=2), solid.solve(turned, across=2)
    np.testing.assert_allclose(
        a.shoes[0].surface.pressure,
        b.shoes[1].surface.pressure[::-1],
        atol=1e-7 * a.shoes[0].peak_pressure,
    )
    np.testing.assert_allclose(a.shoes[0].torque, b.shoes[1].torque, rtol=1e-9)


REFUSED = {
    "its drum is an elastic ring": {
        "drum.ring": {"thickness": 0.02, "width": 0.05, "material": {"E": 2e11, "nu": 0.3}}
    },
    "all but incompressible": {"shoe.lining.material.nu": 0.4995},
}


@pytest.mark.parametrize("said", REFUSED)
def test_what_it_does_not_cover_it_refuses(flexible, said):
    with pytest.raises(BadInput, match=said):
        solid.solve(vary(flexible, REFUSED[said]))


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"across": 0}, "--across = 0: must be from 1 to 7"),
        ({"across": 8}, "--across = 8: must be from 1 to 7"),
        ({"fields": Path("fields.png")}, "--fields = 'fields.png': must end in .vtu"),
        ({"tolerance": 1e-2, "across": 3}, "chooses the degree .*; leave out --across = 3"),
        ({"tolerance": 1.0}, "--tolerance = 1: must be greater than 0"),
    ],
)
def test_options_out_of_range(brake, options, said):
    with pytest.raises(BadInput, match=said):
        solid.solve(brake, **options)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--kind", "tri2"], "and --finite-width belong to --model fem"),
        (["--elements", "12"], "--elements, --kind and --finite-width belong to --model fem"),
        (["--sections", "9"], "belong to --model foundation"),
    ],
)
def test_options_that_it_has_not(root, options, said):
    done = drumlin(
        "solve", root / "studies" / "double_shoe" / "flexible.toml", "--model", "solid", *options
    )
    assert done.returncode == 2 and said in " ".join(done.stderr.split())


@pytest.mark.parametrize("across", [1, 4])
def test_a_given_degree_states_its_own_error(brake, across):
    """The error of a degree covers the distance from the answer to a far smaller tolerance."""
    found, true = solid.solve(brake, across=across), solid.solve(brake, tolerance=2e-3)
    assert f"degree {across} across the width" in found.notes[-1]
    for mine, other in zip(found.shoes, true.shoes, strict=True):
        moved = abs(relative_error_of_number(mine.torque, other.torque))
        assert moved < mine.error["torque"] + other.error["torque"]
    stated = max(found.error["pressure"], found.error["torque"])
    too_large = stated > solid.DEFAULT_ERROR_TOLERANCE_OF_SOLID_MODEL
    assert too_large == any("not reached" in note for note in found.notes)


@pytest.mark.slow
def test_the_command_writes_the_surface(root, tmp_path):
    file = root / "studies" / "double_shoe" / "flexible.toml"
    made = [tmp_path / "a.json", tmp_path / "a.vtu"]
    options = ["--model", "solid", "--across", "2", "--json", made[0], "--fields", made[1]]
    done = drumlin("solve", file, *options)
    assert done.returncode == 0 and "flexible shoes: solid" in done.stdout
    shoes = json.loads(made[0].read_text())["shoes"]
    surface = np.array(shoes[1]["surface"]["pressure"])
    assert surface.shape == (len(shoes[1]["theta"]), len(shoes[1]["surface"]["z"]))
    grid = meshio.read(made[1])
    p, points = grid.point_data["pressure [Pa]"], grid.points
    np.testing.assert_allclose(np.hypot(*points[p > 0, :2].T), 0.15, rtol=1e-12)
    assert points[:, 2].min() == 0 and points[:, 2].max() == pytest.approx(0.02)


@pytest.mark.slow
def test_a_large_face_is_answered_on_every_other_node_and_settles_once_on_all(
    flexible, monkeypatch
):
    """A large face is solved on every other node and then once on all nodes."""
    brake = t_section(flexible)
    scene = prepare_model_with_shoe_widths(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], 2)
    wanted = solve_prepared_model(scene, brake)
    monkeypatch.setattr(self_locking, "NODES_ABOVE_WHICH_FRICTION_PATH_IS_COARSE", 60)
    sizes = settled_sizes(monkeypatch)
    found = solve_prepared_model(scene, brake)
    nodes = list(map(len, picked(scene.bodies, "line.nodes")))
    for count in set(nodes):
        assert sizes.count(count) == nodes.count(count)
    for mine, other in zip(found.shoes, wanted.shoes, strict=True):
        np.testing.assert_allclose(
            mine.surface.pressure, other.surface.pressure, atol=1e-8 * other.peak_pressure
        )


@pytest.mark.slow
def test_the_cost_table_has_a_row_a_degree(flexible):
    heading, *rows = table_lines_of_solid_shoe_cost_by_degree(flexible, (1, 2))
    assert heading.split()[:2] == ["degree", "unknowns"]
    degrees, unknowns, seconds = ([float(row.split()[k]) for row in rows] for k in (0, 1, 3))
    assert degrees == [1, 2]
    made = [
        prepare_model_with_shoe_widths(flexible, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], degree)
        for degree in (1, 2)
    ]
    assert unknowns == [sum({body.unknowns for body in scene.bodies}) for scene in made]
    assert min(seconds) > 0


def test_the_cost_of_a_model_that_has_none(root):
    done = drumlin("cost", root / "studies" / "double_shoe" / "flexible.toml", "--model", "sine")
    assert done.returncode == 2 and "allowed: fem, solid" in done.stderr


@pytest.mark.slow
def test_a_sweep_of_solid_shoes_condenses_no_division_twice(root, flexible, monkeypatch):
    made, file = [], str(root / "studies" / "double_shoe" / "flexible.toml")
    make = prepare.condense_and_couple_shoe_with_width
    monkeypatch.setattr(
        prepare,
        "condense_and_couple_shoe_with_width",
        lambda *of: made.append(of[2:4]) or make(*of),
    )
    frictions = (0.2, 0.25, 0.3)
    sweep = {
        "brake": file,
        "model": {"solid": {"across": 2}, "sine": {}},
        "vary": {"friction": list(frictions)},
    }
    rows = solve_all_cases_of_sweep(sweep_from_file_data(sweep).cases)
    keys = [(division.dictionary_key_of_division, functions) for division, functions in made]
    assert len(set(keys)) == len(keys)
    torques = [solid.solve(vary(flexible, {"friction": mu}), across=2).torque for mu in frictions]
    assert picked(rows[::2], "torque") == torques and set(picked(rows, "status")) == {"solved"}


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"across": 0}, "model.solid: across = 0"),
        ({"across": LARGEST_WIDTH_DEGREE_WITH_STATED_ERROR + 1}, "model.solid: across = 8"),
        (
            {"elements": 12},
            "model.solid: unknown key 'elements'; allowed: penalty, across, tolerance",
        ),
        ({"tolerance": 1e-3, "across": 2}, "model.solid: tolerance chooses the degree"),
    ],
)
def test_options_that_a_sweep_of_solids_has_not(root, options, said):
    file = str(root / "studies" / "double_shoe" / "flexible.toml")
    with pytest.raises(BadInput, match=said):
        sweep_from_file_data(
            {"brake": file, "model": {"solid": options}, "vary": {"friction": [0.2]}}
        )


def guided(brake, **more):
    """Its shoes on guides along their linings' middles, outwards, behind bodies of one width."""
    held = {"hinge": None, "guide": {"direction": 0.0}}
    shoes = []
    for shoe in brake.model_dump(by_alias=True)["shoe"]:
        middle = (shoe["lining"]["start"] + shoe["lining"]["end"]) / 2
        force = {"force": 4e3, "direction": middle}
        shoes.append(
            shoe | held | {"guide": {"direction": middle}, "actuation": shoe["actuation"] | force}
        )
    return vary(brake, {"shoe": shoes, **more})


@pytest.mark.slow
@pytest.mark.parametrize("width", [2e-3, 40e-3])
def test_a_guided_shoe_without_lateral_contraction_is_plane_stress(flexible, width):
    brake = without_contraction(widths(guided(flexible), width))
    wide, plane = wide_and_plane(brake)
    for mine, other in zip(wide.shoes, plane.shoes, strict=True):
        assert relative_error_of_number(mine.torque, other.torque) == pytest.approx(0, abs=1e-9)
        np.testing.assert_allclose(mine.pressure, other.pressure, atol=1e-8 * other.pressure.max())
        np.testing.assert_allclose(mine.reaction_moment, other.reaction_moment, rtol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_a_guided_solid_shoe_balances(flexible, friction):
    brake = guided(t_section(flexible), friction=friction)
    response = solid.solve(brake, across=2)
    assert max(response.balance.force, response.balance.moment) < 1e-9
    for i, (shoe, found) in enumerate(zip(brake.shoes, response.shoes, strict=True)):
        along = np.array([np.cos(shoe.guide.direction), np.sin(shoe.guide.direction)])
        bears = resultant_of_contact_on_shoe(brake, i, found).force @ along
        # None of the actuation's force goes into the guide.
        assert bears == pytest.approx(-4e3, rel=1e-4)


def test_a_pad_without_thickness_is_refused_in_a_line(root):
    done = drumlin("solve", root / "studies" / "laws" / "pad.toml", "--model", "solid")
    assert done.returncode == 2 and done.stderr.count("\n") == 1
    assert (
        "does not apply to this brake: shoe 'pad': its lining has no thickness and material to mesh"
        in done.stderr
    )
