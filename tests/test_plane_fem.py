"""Pads on a plane by finite elements: rigid limits, closed forms, balances, mirror images."""

import math
from math import pi
from typing import Any

import numpy as np
import pytest

import command_line
import drumlin
from conftest import ROOT, partly
from drumlin.base.errors import BadInput
from drumlin.brake.fields import Material
from drumlin.brake.file import make_validated_brake_part, vary
from drumlin.brake.plane_brake import FlatBrake, read_drum_or_plane_brake
from drumlin.fem.analysis.fields import stress_and_displacement_fields_of_shoe
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import prepared_model_with_finest_elements
from drumlin.laws import solve_brake_by_its_rigid_shoe_law
from drumlin.lining_wear.archard import WearLaw
from drumlin.lining_wear.linings import wear_setup_by_finite_elements
from drumlin.lining_wear.run_in import (
    DEFAULT_WEAR_COEFFICIENT,
    brake_with_worn_linings,
    sliding_distance_of_e_fold_pressure_change,
    wear_brake_linings_until_worn_in,
)
from drumlin_studies.ladder_pads import brake_with_pad_on_guide
from drumlin_studies.random_kinds import mirror_turn_and_shift_brake
from flat_pads import BODY, KINDS, LINING, pad
from picking import saying


@pytest.mark.parametrize("sliding", ["+x", "-x"])
@pytest.mark.parametrize("kind", ["hinge", "guide", "pivot"])
def test_a_rigid_pad_with_a_thin_lining_answers_as_its_law(kind: str, sliding: str) -> None:
    brake = pad(kind, sliding)
    fem, rigid = drumlin.solve(brake), solve_brake_by_its_rigid_shoe_law(brake)
    assert fem.merits[0].braking_force == pytest.approx(rigid.merits[0].braking_force, rel=3e-3)
    a, b = fem.shoes[0], rigid.shoes[0]
    assert np.linalg.norm(a.hinge_reaction - b.hinge_reaction) < 3e-3 * np.linalg.norm(
        b.hinge_reaction
    )
    x = np.linspace(0.07, 0.17, 33)
    p, q = a.pressure_at(x), b.pressure_at(x)
    assert np.linalg.norm(p - q) < 5e-3 * np.linalg.norm(q)
    assert a.torque == 0.0


@pytest.mark.parametrize("turned", (0.0, pi))
@pytest.mark.parametrize(
    ("tilt", "sliding", "helps"), [(0.0, "+x", 0), (0.0, "-x", 0), (0.2, "-x", 0), (0.2, "+x", 1)]
)
def test_friction_on_a_guide_along_the_normal_neither_helps_nor_opposes(
    turned, tilt: float, sliding: str, helps: int
) -> None:
    """cos(90 deg) is 6e-17 and not 0: round-off is no self-energising."""
    # A guide turned by 180 deg is the same guide.
    brake = pad("guide", sliding, guide={"direction": tilt - pi / 2 + turned})
    for found in (drumlin.solve(brake, elements=20), solve_brake_by_its_rigid_shoe_law(brake)):
        assert found.shoes[0].self_energising == bool(helps)


def test_what_a_pads_penalty_changes_is_its_braking_force() -> None:
    """It has no torque."""
    notes = drumlin.solve(pad("guide"), penalty=1e3).notes
    assert saying(notes, "which changes the braking force by")
    assert not saying(notes, "torque")


def test_a_guide_along_the_plane_is_refused() -> None:
    for direction in (0.0, pi):
        with pytest.raises(
            BadInput,
            match=r"^shoe\[0\].guide.direction = \d+ deg: must lead to the plane, not along it",
        ):
            pad("guide", guide={"direction": direction})
    pad("guide", guide={"direction": 1e-3})


def test_a_pad_that_its_force_lifts_is_said_of_the_plane() -> None:
    brake = vary(pad("hinge"), {"shoe.actuation.force": -1.0})
    said = ["shoe 'pad': no contact, the force does not turn it towards the plane"]
    assert [
        saying(drumlin.solve(brake).notes, "contact"),
        saying(solve_brake_by_its_rigid_shoe_law(brake).notes, "contact"),
    ] == [
        said,
        said,
    ]


@pytest.mark.parametrize(("grip", "held"), ((0.03, "30 mm"), (0.5, "72 mm")))
def test_a_grip_longer_than_its_body_is_said_as_it_is_held(grip, held) -> None:
    """At most .6 of the lining's length is held: of 120 mm 72 mm."""
    notes = drumlin.solve(pad("guide", body=BODY | {"grip": grip}), elements=10).notes
    assert f"held: pad: its guide grips {held} of the back of its body" in notes


def test_a_thin_lining_gives_way_as_a_bonded_layer() -> None:
    """A thin lining under even pressure is squeezed by p t (1 - nu^2)/E, but for its free ends.

    This is a bonded layer in plane stress.

    Those add a width of the order of the thickness, so that halving it halves what is missing.
    """
    off = []
    for t in (0.001, 0.0005):
        brake = pad("guide", mu=0.0, lining=LINING | {"start": 0.06, "end": 0.18, "thickness": t})
        shoe = drumlin.solve(brake, penalty=math.inf).shoes[0]
        assert shoe.motion is not None
        squeezed = 500.0 / (0.12 * 0.04) * t * (1 - 0.25**2) / 3e8
        off.append(-shoe.motion[1] / squeezed - 1)
    assert abs(off[0]) < 0.01
    assert off[1] == pytest.approx(off[0] / 2, rel=0.1)


@pytest.mark.parametrize(
    ("mu", "exponent"), partly([(0.1, 0.887), (0.3, 0.7095), (0.5, 0.564)], {(0.3, 0.7095)})
)
def test_the_pressure_at_the_edge_has_the_exponent_of_a_quarter_plane(
    mu: float, exponent: float
) -> None:
    """The pressure at a pad's leading edge has a quarter plane's power, p ~ r^(lambda - 1).

    The plane runs onto a square edge of nu = 0.3 in plane stress, sliding on a rigid plane.

    lambda solves the transcendental equation of a wedge of 90 deg, free on one side and sliding on
    the other.
    """
    material = {"E": 3e8, "nu": 0.3}
    lining = LINING | {"start": 0.06, "end": 0.18, "thickness": 0.02, "material": material}
    brake = pad("guide", mu=mu, lining=lining)
    found = solve_prepared_model(
        make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[5]), brake
    ).shoes[0]
    r = np.geomspace(2e-6, 4e-5, 12)
    p = found.pressure_at(0.06 + r)
    slope = np.polyfit(np.log(r), np.log(p), 1)[0]
    assert slope == pytest.approx(exponent - 1, abs=0.02)


def points_of(shoe: dict[str, Any]) -> list[dict[str, float]]:
    """The tables of the points that hold and push a shoe."""
    abutment = shoe["abutment"] or {}
    points = (shoe["hinge"], shoe["pivot"], abutment.get("point"), shoe["actuation"]["point"])
    return list(filter(None, points))


@pytest.mark.parametrize("kind", partly(KINDS, {"pivot", "abutment"}))
def test_elastic_pads_balance_and_their_mirror_images_answer_alike(kind: str) -> None:
    """The abutted pad slides on a face that bears its friction."""
    one = "-x" if kind == "abutment" else "+x"
    brake = pad(kind, one, body=BODY)
    response = drumlin.solve(brake)
    assert max(response.balance.force, response.balance.moment) < 1e-9
    data = brake.model_dump(by_alias=True)
    data["plane"] = {"sliding": "+x" if one == "-x" else "-x"}
    (shoe,) = data["shoe"]
    for point in points_of(shoe):
        point["x"] = -point["x"]
    for part in (shoe["abutment"], shoe["guide"], shoe["actuation"]):
        if part:
            part["direction"] = pi - part["direction"]
    for part in (shoe["lining"], shoe["body"]):
        part["start"], part["end"] = -part["end"], -part["start"]
    a, b = response.shoes[0], drumlin.solve(make_validated_brake_part(FlatBrake, data)).shoes[0]
    assert b.normal_force == pytest.approx(a.normal_force, rel=1e-8)
    assert b.hinge_reaction == pytest.approx(a.hinge_reaction * [-1, 1], rel=1e-6, abs=1e-6)
    np.testing.assert_allclose(b.pressure_at(-a.theta), a.pressure, atol=1e-6 * a.peak_pressure)


@pytest.mark.parametrize("kind", ("pivot", "abutment"))
def test_a_pad_answers_alike_wherever_it_stands(kind) -> None:
    """Moved along the plane by 1.3 m, pins, point of the force and all."""
    brake = pad(kind, "-x", body=BODY)
    data = brake.model_dump(by_alias=True)
    (shoe,) = data["shoe"]
    for point in points_of(shoe):
        point["x"] += 1.3
    for part in (shoe["lining"], shoe["body"]):
        part["start"], part["end"] = part["start"] + 1.3, part["end"] + 1.3
    a, b = (
        drumlin.solve(brake).shoes[0],
        drumlin.solve(make_validated_brake_part(FlatBrake, data)).shoes[0],
    )
    assert b.normal_force == pytest.approx(a.normal_force, rel=1e-6)
    np.testing.assert_allclose(
        b.pressure_at(a.theta + 1.3), a.pressure, atol=1e-5 * a.peak_pressure
    )


@pytest.mark.parametrize("kind", ("hinge", "pivot"))
def test_meshes_answer_as_columns_do(kind) -> None:
    brake = pad(kind, body=BODY)
    a, b = drumlin.solve(brake, elements=60), drumlin.solve(brake)
    assert a.merits[0].braking_force == pytest.approx(b.merits[0].braking_force, rel=2e-3)


def test_a_face_on_which_a_pad_would_only_slide_is_refused_in_one_line() -> None:
    face = {"abutment": {"point": {"x": 0.03, "y": 0.03}, "direction": -pi / 2}}
    with pytest.raises(BadInput, match="must not be in line with it and the normal of the plane"):
        pad("hinge", hinge=None, **face)


def test_a_pad_without_thickness_is_refused_in_one_line() -> None:
    bare = {key: None for key in ("thickness", "material")}
    with pytest.raises(BadInput, match="its lining has no thickness and material to mesh"):
        drumlin.solve(pad("hinge", lining=LINING | {"start": 0.06, "end": 0.18} | bare))


def test_a_centred_pad_without_friction_bears_no_moment_and_is_answered() -> None:
    """All moments vanish: what is small is said by the force in the middle of half a lining."""
    response = drumlin.solve(brake_with_pad_on_guide(0.01, 0.0, Material(E=3e8, nu=0.25)))
    assert max(response.balance.force, response.balance.moment) < 1e-9
    (shoe,) = response.shoes
    np.testing.assert_allclose(
        shoe.pressure_at(0.12 - shoe.theta), shoe.pressure, atol=1e-6 * shoe.peak_pressure
    )


def test_the_end_face_by_which_a_hinge_holds_a_pad_lies_on_the_plane_as_it_is() -> None:
    brake = pad("hinge", body=BODY)
    (shoe,) = brake.shoes
    near, far = (
        shoe.middle_of_supported_or_loaded_end_face_of_body(brake.size, loaded=loaded)
        - shoe.pin_position_in_shoe_frame
        for loaded in (False, True)
    )
    # Half of the body lies behind the lining.
    assert near == pytest.approx([0.05, 0.011 - 0.06], rel=1e-12)
    assert far == pytest.approx([0.19, 0.011 - 0.06], rel=1e-12)


def test_pads_are_worn_on_guides_along_the_normal_of_the_plane() -> None:
    """Pads on guides along the plane's normal wear in to even pressure.

    The braking force is mu times the part of the force along the normal.
    """
    file = ROOT / "studies" / "brakes" / "rail_clamp.toml"
    brake = read_drum_or_plane_brake(file)
    done = command_line.drumlin("wear", file, "--guided", "--elements", 20, "--distance", 0.1)
    assert done.returncode == 0
    down = sum(-shoe.actuation.force_vector[1] for shoe in brake.shoes)
    assert f"worn in (law): braking force {brake.friction * down:.6g} N" in " ".join(
        done.stdout.split()
    )


def test_a_worn_pad_is_solved_again_as_it_was_worn() -> None:
    """Its shape, a clearance on the plane, gives the pressure that wore it, a wrong pad's too."""
    own = pad(
        "hinge", body=BODY, lining=LINING | {"start": 0.06, "end": 0.18, "misfit": {"taper": 1e-6}}
    )
    made, rule = make_prepared_model(own, elements=20), WearLaw(DEFAULT_WEAR_COEFFICIENT)
    setup = wear_setup_by_finite_elements(made, own)
    last = wear_brake_linings_until_worn_in(
        setup, rule, distance=0.3 * sliding_distance_of_e_fold_pressure_change(setup, rule)
    )[-1]
    (shoe,) = solve_prepared_model(
        made, brake_with_worn_linings(setup, last), penalty=math.inf
    ).shoes
    (surface,) = setup.surfaces
    np.testing.assert_allclose(
        shoe.pressure,
        surface.lining_values_by_growing_angle(last.pressure),
        atol=1e-8 * shoe.peak_pressure,
    )


@pytest.mark.parametrize("sliding", ["+x", "-x"])
def test_the_fields_of_a_pad_stand_where_it_does_and_bear_its_pressure(sliding: str) -> None:
    """The fields of a pad lie where the pad does and carry its pressure.

    Pressed nodes stay on the plane, under the stress of p and friction there; the plane pushes
    upwards.
    """
    brake = mirror_turn_and_shift_brake(
        pad("pivot", sliding, body=BODY), mirrored=sliding == "-x", shift=0.4
    )
    made = prepared_model_with_finest_elements(brake)
    found = stress_and_displacement_fields_of_shoe(
        made, brake, solve_prepared_model(made, brake, penalty=math.inf), 0
    )
    shoe = brake.shoes[0]
    assert shoe.body is not None
    (left, low), (right, high) = found.points.min(axis=0), found.points.max(axis=0)
    assert (left, right) == pytest.approx((shoe.body.start, shoe.body.end), abs=1e-12)
    assert (low, high) == pytest.approx((0.0, 0.021), abs=1e-12)
    # The points lie away from the lining's ends.
    away = np.abs(found.points[:, 0] - shoe.lining.start - 0.06) < 0.05
    on = (found.pressure > 0.1 * found.pressure.max()) & away
    p = found.pressure[on]
    assert np.abs(found.displacement[on, 1]).max() < 1e-3 * np.abs(found.displacement).max()
    np.testing.assert_allclose(found.push[on], np.column_stack([0 * p, p]), rtol=1e-12)
    np.testing.assert_allclose(found.stress[on, 1], -p, atol=0.05 * p.max())
    np.testing.assert_allclose(
        found.stress[on, 2], -brake.friction * brake.sign_of_motion * p, atol=0.05 * p.max()
    )
