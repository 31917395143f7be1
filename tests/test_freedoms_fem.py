"""Elastic shoes on a pivot, an abutment or a guide: rigid limit, balances, mirror images."""

import math
from pathlib import Path

import numpy as np
import pytest

import drumlin
from drumlin.base.errors import BadInput
from drumlin.brake.file import make_drum_brake_from_data, vary
from drumlin.fem.analysis.fields import stress_and_displacement_fields_of_shoe
from drumlin.fem.equilibrium.group import divide_pressed_shoes_into_groups
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.model import solve_full_system_of_group_by_refinement
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import prepared_model_with_finest_elements
from drumlin.laws import solve_brake_by_its_rigid_shoe_law
from held_shoes import BODY, KINDS, THIN, brake_of


@pytest.mark.parametrize("spin", [1, -1])
@pytest.mark.parametrize("kind", KINDS)
def test_a_rigid_shoe_with_a_thin_lining_answers_as_its_law(kind: str, spin: int) -> None:
    brake = brake_of(kind, spin)
    fem, rigid = drumlin.solve(brake), solve_brake_by_its_rigid_shoe_law(brake)
    assert fem.torque == pytest.approx(rigid.torque, rel=3e-3)
    a, b = fem.shoes[0], rigid.shoes[0]
    assert np.linalg.norm(a.hinge_reaction - b.hinge_reaction) < 6e-3 * np.linalg.norm(
        b.hinge_reaction
    )
    theta = np.linspace(-0.8, 0.8, 33)
    p, q = a.pressure_at(theta), b.pressure_at(theta)
    assert np.linalg.norm(p - q) < 0.02 * np.linalg.norm(q)


@pytest.mark.parametrize("kind", KINDS)
def test_an_elastic_shoe_balances_and_its_mirror_image_answers_alike(kind: str) -> None:
    brake = brake_of(kind, 1, body=BODY)
    response = drumlin.solve(brake)
    assert max(response.balance.force, response.balance.moment) < 1e-9
    data = brake.model_dump(by_alias=True)
    data["rotation"] = "clockwise"
    (shoe,) = data["shoe"]
    for point in (
        shoe["hinge"],
        shoe["pivot"],
        shoe["abutment"] and shoe["abutment"]["point"],
        shoe["actuation"]["point"],
    ):
        if point:
            point["y"] = -point["y"]
    for part in (shoe["abutment"], shoe["guide"], shoe["actuation"]):
        if part:
            part["direction"] = -part["direction"]
    for part in (shoe["lining"], shoe["body"]):
        part["start"], part["end"] = -part["end"], -part["start"]
    other = drumlin.solve(make_drum_brake_from_data(data))
    assert other.torque == pytest.approx(response.torque, rel=1e-8)
    a, b = response.shoes[0], other.shoes[0]
    assert b.hinge_reaction == pytest.approx(a.hinge_reaction * [1, -1], rel=1e-6, abs=1e-6)
    assert b.reaction_moment == pytest.approx(-a.reaction_moment, rel=1e-6, abs=1e-9)
    np.testing.assert_allclose(b.pressure_at(-a.theta), a.pressure, atol=1e-6 * a.peak_pressure)


@pytest.mark.parametrize("kind", ["pivot", "guide", "abutment"])
def test_a_stiff_body_is_a_rigid_shoe(kind: str) -> None:
    """Wherever pivot, guide or abutment grips it."""
    stiff = vary(brake_of(kind, -1, body=BODY), {"shoe.body.material.E": 2.1e16})
    rigid = vary(stiff, {"shoe.body": None})
    assert drumlin.solve(stiff).torque == pytest.approx(drumlin.solve(rigid).torque, rel=3e-4)


@pytest.mark.parametrize("kind", ["abutment", "rough abutment", "guide"])
def test_what_holds_an_elastic_shoe_bears_what_it_can(kind) -> None:
    x, y = drumlin.solve(brake_of(kind, -1, body=BODY)).shoes[0].hinge_reaction
    if kind == "abutment":
        assert math.atan2(y, x) == pytest.approx(0.2, abs=1e-9)
    if kind == "rough abutment":
        assert abs(y) <= 0.2 * x * (1 + 1e-9)
    if kind == "guide":
        assert abs(x * math.cos(0.1) + y * math.sin(0.1)) < 1e-9 * math.hypot(x, y)


def test_a_foot_that_friction_holds_is_a_pin_also_where_the_lining_stands_off() -> None:
    foot = {"point": {"x": 0.025, "y": -0.08}, "direction": 0.0, "friction": 1.0}
    off = {"lining": THIN | {"start": -0.95, "end": 0.95, "clearance": 1e-4}}
    stuck = drumlin.solve(brake_of("rough abutment", 1, abutment=foot, **off))
    pinned = drumlin.solve(brake_of("rough abutment", 1, abutment=None, hinge=foot["point"], **off))
    assert stuck.torque == pytest.approx(pinned.torque, rel=1e-9)
    assert stuck.shoes[0].hinge_reaction == pytest.approx(pinned.shoes[0].hinge_reaction, rel=1e-9)


@pytest.mark.slow
def test_the_whole_system_refined_is_the_same_answer() -> None:
    for kind in KINDS:
        brake = brake_of(kind, 1, body=BODY)
        (group,) = divide_pressed_shoes_into_groups(
            make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1]), brake, 1e6
        )
        group, found = group.solve_contact_and_abutment_friction()
        for order in ("COLAMD", "MMD_AT_PLUS_A"):
            refined = solve_full_system_of_group_by_refinement(group, found.active, order)
            np.testing.assert_allclose(refined.p[0], found.p, atol=1e-8 * found.p.max())
            np.testing.assert_allclose(
                refined.coordinates[0], found.y, rtol=1e-6, atol=1e-9 * abs(found.y).max()
            )


@pytest.mark.parametrize("kind", ("abutment", "pivot", "guide"))
def test_meshes_answer_as_columns_do(kind) -> None:
    brake = vary(brake_of(kind, 1, body=BODY), {"shoe.lining.thickness": 0.006})
    assert drumlin.solve(brake, elements=60).torque == pytest.approx(
        drumlin.solve(brake).torque, rel=2e-3
    )


@pytest.mark.slow
def test_a_body_bolted_to_a_lever_is_held_as_a_guided_one_where_the_lever_is_long() -> None:
    """A body bolted to a very long lever is held as a guided body is.

    A far pin on a normal of the guide's direction lets the shoe move along the guide and does not
    turn it.
    """
    guided = brake_of("guide", 1, body=BODY | {"grip": 0.03})
    away = {"x": -1e4 * math.sin(0.1), "y": 1e4 * math.cos(0.1)}
    hinged = vary(guided, {"shoe.guide": None, "shoe.hinge": away})
    a, b = drumlin.solve(hinged), drumlin.solve(guided)
    assert a.torque == pytest.approx(b.torque, rel=1e-4)
    theta = np.linspace(-0.9, 0.9, 31)
    np.testing.assert_allclose(
        a.shoes[0].pressure_at(theta), b.shoes[0].pressure_at(theta), rtol=2e-3
    )
    assert "its hinge grips 30 mm of the back of its body" in "\n".join(a.notes)
    by_face = drumlin.solve(vary(hinged, {"shoe.body.grip": None}))
    assert abs(by_face.torque / b.torque - 1) > 0.01


@pytest.mark.parametrize("kind", ["abutment", "rough abutment"])
def test_an_abutment_does_not_grip_a_back(kind: str) -> None:
    with pytest.raises(
        BadInput, match=r"^shoe\[0\]\.body\.grip = 30 mm: an abutment holds the body's end face"
    ):
        brake_of(kind, 1, body=BODY | {"grip": 0.03})


def test_a_guided_shoe_that_aims_at_the_centre_bears_no_moment_without_friction() -> None:
    towards = {
        "guide": {"direction": 0.0},
        "actuation": {"force": 1e3, "direction": 0.0, "point": {"x": 0.1, "y": 0.0}},
    }
    response = drumlin.solve(brake_of("guide", 1, mu=0.0, **towards))
    assert max(response.balance.force, response.balance.moment) < 1e-9


FILES = ["band", "crane", "uni_servo", "duplex", "s_cam", "simplex_hinged", "block_on_lever"]


@pytest.mark.parametrize("name", FILES)
@pytest.mark.slow
def test_the_displacements_inside_are_those_of_the_answer(name: str, root: Path) -> None:
    """Displacements recovered inside a shoe leave its pressed face on the drum, however held.

    On pressed nodes the radial displacement vanishes.
    """
    brake = drumlin.read_brake(root / f"studies/brakes/{name}.toml")
    scene = prepared_model_with_finest_elements(brake, elements=20)
    response = drumlin.solve(brake, elements=20)
    for i in range(len(brake.shoes)):
        found = stress_and_displacement_fields_of_shoe(scene, brake, response, i)
        on = found.pressure > 0.01 * found.pressure.max()
        radial = (found.displacement * found.points).sum(axis=1)[on] / np.hypot(*found.points[on].T)
        assert np.abs(radial).max() < 0.01 * np.linalg.norm(found.displacement, axis=1).max()
