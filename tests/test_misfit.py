"""Misfit: exact geometry, what it does to the contact, its symmetries, and how wear heals it."""

import math
from itertools import pairwise, starmap

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from conftest import ROOT, STUDY
from drumlin.base.errors import BadInput
from drumlin.brake import clearance, off_circle
from drumlin.brake.fields import Point
from drumlin.brake.file import make_drum_brake_from_data, read_brake, vary
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin.foundation import model as foundation
from drumlin.laws import solve_brake_by_sine_law
from drumlin.lining_wear import run_in
from drumlin.lining_wear.linings import wear_setup_by_finite_elements
from drumlin.lining_wear.worn_in import brake_with_worn_in_clearances
from drumlin.response.norms import relative_distance_of_pressures
from picking import picked

R = 0.15
TEXT = (STUDY / "brake.toml").read_text()
BRAKE = read_brake(STUDY / "brake.toml")
SCENE = make_prepared_model(BRAKE, elements=40)
MISFIT = "shoe.lining.misfit"


@given(
    st.floats(-0.05, 0.05),
    st.floats(-0.02, 0.02),
    st.floats(-0.02, 0.02),
    st.floats(-3, 3),
    st.sampled_from([-1, 1]),
)
def test_the_gap_ends_on_the_linings_own_circle(dr, x, y, middle, sign):
    """At R - sign gap every point is the radius r away from the circle's centre."""
    theta = middle + np.linspace(-1.2, 1.2, 41)
    r = R * (1 + dr)
    gap = off_circle.gaps_of_lining_ground_to_circle(
        R, r, Point(x=x * R, y=y * R), middle, sign, theta
    )
    rho = R - sign * gap
    centre = (R - r) * np.exp(1j * middle) + R * (x + 1j * y)
    assert np.abs(rho * np.exp(1j * theta) - centre) == pytest.approx(np.full(41, r), rel=1e-13)
    if x == y == 0:
        # Both circles meet in the lining's middle.
        assert abs(gap[20]) <= 1e-15 * R


@pytest.mark.parametrize(("dr", "offset"), [(-1e-4, 0.0), (1e-4, 0.0), (0.0, 1e-4), (-1e-4, 1e-4)])
def test_to_first_order_the_gap_is_that_of_small_mismatches(dr, offset):
    """sign ((R - r)(1 - cos) - offset cos); what is left falls with the square of the mismatch."""
    theta, left = np.linspace(-1.0, 1.0, 41), []
    for scale in (1.0, 0.5):
        a, b = scale * dr, scale * offset
        first = -a * (1 - np.cos(theta)) - b * np.cos(theta)
        exact = off_circle.gaps_of_lining_ground_to_circle(
            R, R + a, Point(x=b, y=0.0), 0.0, 1, theta
        )
        left.append(np.abs(exact - first).max())
        assert left[-1] < 2e-3 * np.abs(first).max()
    assert left[0] == pytest.approx(4 * left[1], rel=1e-2)


@pytest.mark.parametrize(
    ("side", "dr"), [("internal", -1), ("internal", 1), ("external", -1), ("external", 1)]
)
def test_where_a_lining_of_another_radius_touches(side, dr):
    """A lining of another radius touches where geometry says.

    On an internal shoe a smaller one bears in its middle, a larger one at its ends; on an external
    shoe the other way round.
    """
    sign = 1 if side == "internal" else -1
    brake = vary(rigid(side), {f"{MISFIT}.radius": R + dr * 5e-4})
    shoe = solve(brake, elements=60).shoes[0]
    arcs, middle = shoe.contact_arcs, brake.shoes[0].lining.middle
    if dr * sign < 0:
        assert len(arcs) == 1 and arcs[0][0] < middle < arcs[0][1]
        assert arcs[0][1] - arcs[0][0] < 0.5 * (shoe.theta[-1] - shoe.theta[0])
    else:
        assert len(arcs) == 2 and arcs[0][1] < middle < arcs[1][0]
        assert (arcs[0][0], arcs[1][1]) == pytest.approx((shoe.theta[0], shoe.theta[-1]))


def rigid(side="internal", thickness=4e-3, nu=0.0, half=50, force=500.0):
    """A rigid shoe, frictionless, its lining's middle 90 deg from the hinge and under the force."""
    sign = 1 if side == "internal" else -1
    return make_drum_brake_from_data(
        {
            "title": "rigid",
            "rotation": "clockwise",
            "friction": 0.0,
            "drum": {"radius": R},
            "shoe": [
                {
                    "name": "shoe",
                    "side": side,
                    "hinge": {"x": 0.0, "y": -0.12 if side == "internal" else -0.2},
                    "lining": {
                        "start": math.radians(-half),
                        "end": math.radians(half),
                        "thickness": thickness,
                        "width": 0.04,
                        "material": {"E": 3e8, "nu": nu},
                    },
                    "actuation": {
                        "force": force,
                        "direction": 0.0 if sign > 0 else math.pi,
                        "point": {"x": 0, "y": 0},
                    },
                }
            ],
        }
    )


def test_gross_mismatch_on_a_thin_lining_is_the_parabola_of_its_layer():
    """Contact wide against t: p = (E/t)(x_c^2 - x^2)/(2 rho), P = (2/3)(E/t) b x_c^3/rho."""
    t, dr = 4e-4, 2e-3
    brake = vary(rigid(thickness=t, half=25, force=2000.0), {f"{MISFIT}.radius": R - dr})
    shoe = solve(brake, elements=200).shoes[0]
    rho = R * (R - dr) / dr
    width = (1.5 * shoe.normal_force * rho * t / (0.04 * 3e8)) ** (1 / 3)
    ((start, end),) = shoe.contact_arcs
    assert width > 10 * t
    assert R * (end - start) / 2 == pytest.approx(width, rel=0.02)
    assert shoe.peak_pressure == pytest.approx(3e8 / t * width**2 / (2 * rho), rel=0.02)


def test_gross_mismatch_on_a_thick_lining_is_hertz():
    """Contact narrow against t, rigid drum: a^2 = 4 P rho/(pi E b), p_0 = 2 P/(pi a b)."""
    t, r = 0.06, 0.143
    brake = vary(rigid(thickness=t, half=20, force=60.0), {f"{MISFIT}.radius": r})
    shoe = solve(brake, elements=240).shoes[0]
    rho, P = R * r / (R - r), shoe.normal_force / 0.04
    a = math.sqrt(4 * P * rho / (math.pi * 3e8))
    ((start, end),) = shoe.contact_arcs
    assert a < t / 10
    assert R * (end - start) / 2 == pytest.approx(a, rel=0.035)
    assert shoe.peak_pressure == pytest.approx(2 * P / (math.pi * a), rel=0.02)


def test_an_offset_across_the_hinges_radius_is_a_turn_of_the_shoe():
    """An offset across the hinge's radius changes the gap by sin(phi), as a turn of the shoe does.

    The shoe turns back by it; an offset along the radius stays.
    """
    base, hinge = solve_prepared_model(SCENE, BRAKE), BRAKE.shoes[0].hinge
    # A move across the hinge's radius is nearly a turn about the hinge.
    across = np.array([-hinge.y, hinge.x]) / hinge.radius
    along = hinge.xy / hinge.radius
    changes = []
    for direction in (across, along):
        x, y = 1e-5 * direction
        moved = solve_prepared_model(
            SCENE,
            vary(BRAKE, {"shoe[0].lining.misfit.offset.x": x, "shoe[0].lining.misfit.offset.y": y}),
        )
        changes.append(abs(moved.shoes[0].torque / base.shoes[0].torque - 1))
    assert changes[0] < 2e-5
    assert changes[1] > 1e-2


def same(a, b, rel=1e-9):
    assert picked(a.shoes, "torque") == pytest.approx(picked(b.shoes, "torque"), rel=rel)
    for x, y in zip(a.shoes, b.shoes, strict=True):
        assert x.pressure == pytest.approx(y.pressure, rel=rel, abs=rel * y.pressure.max())


def test_taper_blocks_and_growth_are_the_clearances_that_they_say():
    lining = BRAKE.shoes[0].lining
    taper = vary(BRAKE, {"shoe[0].lining.misfit.taper": 4e-5})
    # The right shoe's hinge is at the start of its lining.
    table = [[lining.start, -2e-5], [lining.end, 2e-5]]
    same(
        solve_prepared_model(SCENE, taper),
        solve_prepared_model(SCENE, vary(BRAKE, {"shoe[0].lining.clearance": table})),
    )
    # The left shoe's hinge is at the end of its lining.
    other = vary(BRAKE, {"shoe[1].lining.misfit.taper": 4e-5})
    at = BRAKE.shoes[1].lining
    table = [[at.start, 2e-5], [at.end, -2e-5]]
    same(
        solve_prepared_model(SCENE, other),
        solve_prepared_model(SCENE, vary(BRAKE, {"shoe[1].lining.clearance": table})),
    )
    blocks = (
        vary(BRAKE, {"shoe[0].lining.misfit.blocks": [[-0.4, 2e-5], [0.3, -1e-5]]}).shoes[0].lining
    )
    theta = np.array([-1.0, -0.45, -0.4, -0.35, 0.2, 0.3, 0.4, 0.9])
    assert clearance.gaps_due_to_block_heights(blocks, theta) == pytest.approx(
        [0, 0, 1e-5, 2e-5, 2e-5, 5e-6, -1e-5, -1e-5], abs=1e-15
    )
    # A drum that grows evenly has a lobe of order 0, of 1.2e-5 1/K times 100 K of its radius.
    growth = 1.2e-3 * R
    hot = vary(BRAKE, {"drum.out_of_round": [{"order": 0, "amplitude": growth}]})
    same(
        solve_prepared_model(SCENE, hot),
        solve_prepared_model(SCENE, vary(BRAKE, {"shoe.lining.clearance": growth})),
    )


def test_steps_between_blocks_begin_and_end_at_the_kinks():
    """Between two kinks of a step its gap moves, beyond them it is level."""
    lining = (
        vary(BRAKE, {"shoe[0].lining.misfit.blocks": [[-0.4, 2e-5], [0.3, -1e-5]]}).shoes[0].lining
    )
    edges = [lining.start, *sorted(clearance.coordinates_of_gap_kinks(lining)), lining.end]
    assert len(edges) == 6
    for k, (a, b) in enumerate(pairwise(edges)):
        steps = np.diff(clearance.gaps_due_to_block_heights(lining, np.linspace(a, b, 20)))
        assert (steps == 0).all() if k % 2 == 0 else (np.abs(steps) > 0).all()


def test_a_drum_turns_with_its_surface():
    """Turned by an angle, what stood at theta stands at theta + angle."""
    lobes = [{"order": 1, "amplitude": 2e-5, "phase": 0.4}, {"order": 3, "amplitude": 1e-5}]
    still, turned = (
        vary(BRAKE, {"drum.out_of_round": lobes, "drum.angle": angle}) for angle in (0.0, 0.7)
    )
    theta = np.linspace(-3, 3, 13)
    assert still.radial_deviation_of_drum_surface(np.array([0.4]))[0] == pytest.approx(
        2e-5 + 1e-5 * math.cos(1.2)
    )
    np.testing.assert_allclose(
        turned.radial_deviation_of_drum_surface(theta + 0.7),
        still.radial_deviation_of_drum_surface(theta),
        atol=1e-18,
    )


def test_a_step_between_blocks_converges_with_the_mesh():
    stepped = vary(BRAKE, {"shoe[0].lining.misfit.blocks": [[-0.3, 1e-5]]})
    adapted = solve(stepped, tolerance=1e-2)
    assert solve_prepared_model(SCENE, stepped).torque == pytest.approx(adapted.torque, rel=2e-3)
    assert solve(stepped, elements=120).torque == pytest.approx(adapted.torque, rel=2e-4)


@pytest.mark.parametrize("order", [2, 3, 5])
def test_the_torque_over_a_turn_has_the_period_of_the_lobes(order):
    brake = vary(BRAKE, {"drum.out_of_round": [{"order": order, "amplitude": 2e-5}]})
    angles = np.linspace(0, 2 * math.pi / order, 6, endpoint=False)
    # One turn of the lobes' period later the drum presents the same shape.
    once, again = (
        picked(
            clearance.solve_brake_at_angular_drum_positions(
                brake, lambda b: solve_prepared_model(SCENE, b), start + angles
            ),
            "torque",
        )
        for start in (0.0, 2 * math.pi / order)
    )
    assert again == pytest.approx(once, rel=1e-9)
    assert np.ptp(once) > 0.02 * np.mean(once)


def mirrored(brake):
    """The mirror image about the y axis, rotation included."""
    data = brake.model_dump(by_alias=True)
    data["rotation"] = "clockwise" if brake.sign_of_motion > 0 else "counter-clockwise"
    data["drum"]["angle"] = -data["drum"]["angle"]
    for lobes in data["drum"]["out_of_round"]:
        lobes["phase"] = math.pi - lobes["phase"]
    for shoe in data["shoe"]:
        lining, body, m = shoe["lining"], shoe["body"], shoe["lining"]["misfit"]
        for part in (lining, body):
            part["start"], part["end"] = math.pi - part["end"], math.pi - part["start"]
        for point in (shoe["hinge"], shoe["actuation"]["point"], m["offset"]):
            point["x"] = -point["x"]
        shoe["actuation"]["direction"] = math.pi - shoe["actuation"]["direction"]
        if m["blocks"]:
            ((at, depth),) = m["blocks"]
            # A step that rises one way falls the other way from a level that is deeper by it.
            m["blocks"], lining["clearance"] = [[math.pi - at, -depth]], lining["clearance"] + depth
    return make_drum_brake_from_data(data)


def scaled(brake, s):
    """All lengths s times, all forces s^2 times: the same stresses."""
    data = brake.model_dump(by_alias=True)
    data["drum"]["radius"] *= s
    for lobes in data["drum"]["out_of_round"]:
        lobes["amplitude"] *= s
    for shoe in data["shoe"]:
        lining, m = shoe["lining"], shoe["lining"]["misfit"]
        for part in (lining, shoe["body"]):
            part["thickness"], part["width"] = part["thickness"] * s, part["width"] * s
        for point in (shoe["hinge"], shoe["actuation"]["point"], m["offset"]):
            point["x"], point["y"] = point["x"] * s, point["y"] * s
        m["radius"], m["taper"], lining["clearance"] = (
            m["radius"] * s,
            m["taper"] * s,
            lining["clearance"] * s,
        )
        m["blocks"] = [[at, depth * s] for at, depth in m["blocks"]]
        shoe["actuation"]["force"] *= s**2
    return make_drum_brake_from_data(data)


small = st.floats(-5e-5, 5e-5)


@settings(max_examples=4)
@given(small, small, small, small, small, small, st.floats(-3, 3), st.integers(0, 5))
def test_mirror_image_and_units_change_nothing(dr, x, y, taper, depth, lobe, angle, order):
    brake = vary(
        BRAKE,
        {
            "shoe.lining.misfit.radius": R + dr,
            "shoe.lining.misfit.offset": {"x": x, "y": y},
            "shoe[1].lining.misfit.taper": taper,
            "shoe[0].lining.misfit.blocks": [[0.1, depth]],
            "drum.out_of_round": [{"order": order, "amplitude": lobe, "phase": 0.7}],
            "drum.angle": angle,
        },
    )
    here, there, large = (
        solve_prepared_model(SCENE, brake),
        solve(mirrored(brake), elements=40),
        solve(scaled(brake, 2), elements=40),
    )
    assert picked(there.shoes, "torque") == pytest.approx(picked(here.shoes, "torque"), rel=1e-7)
    # A moment is a force times a length: twice the size has eight times the moment.
    assert np.array(picked(large.shoes, "torque")) / 8 == pytest.approx(
        picked(here.shoes, "torque"), rel=1e-7
    )
    assert picked(large.shoes, "peak_pressure") == pytest.approx(
        picked(here.shoes, "peak_pressure"), rel=1e-7
    )


def test_the_foundation_has_the_same_misfit():
    brake = read_brake(ROOT / "studies" / "post_brake" / "brake.toml")
    radius = brake.size
    changed = vary(brake, {f"{MISFIT}.radius": radius + 1e-3, f"{MISFIT}.taper": 1e-4})
    tables = {}
    for i, shoe in enumerate(changed.shoes):
        theta = np.linspace(shoe.lining.start, shoe.lining.end, 4001)
        gap = clearance.gaps_between_unloaded_lining_and_surface(changed, shoe, theta)
        # The same gap is given as a table of many rows.
        tables[f"shoe[{i}].lining.clearance"] = np.column_stack([theta, gap]).tolist()
    same(
        foundation.solve_brake_by_foundation_model(changed),
        foundation.solve_brake_by_foundation_model(vary(brake, tables)),
        rel=1e-5,
    )
    assert foundation.solve_brake_by_foundation_model(changed).torque != pytest.approx(
        foundation.solve_brake_by_foundation_model(brake).torque, rel=1e-2
    )


def test_worn_in_every_lining_bears_by_the_sine_law():
    """Worn in, a lining of any misfit bears by the sine law, inside or outside the drum.

    On a drum that is not round it does not stay so.
    """
    law = solve_brake_by_sine_law(BRAKE)
    off = vary(BRAKE, {f"{MISFIT}.radius": R - 1e-4, f"{MISFIT}.taper": 5e-5})
    worn = solve_prepared_model(SCENE, brake_with_worn_in_clearances(SCENE, off))
    assert worn.torque == pytest.approx(law.torque, rel=1e-6)
    assert (
        max(starmap(relative_distance_of_pressures, zip(worn.shoes, law.shoes, strict=True))) < 1e-4
    )
    assert (
        min(
            np.array(shoe.lining.clearance)[:, 1].min()
            for shoe in brake_with_worn_in_clearances(SCENE, off).shoes
        )
        >= 0
    )
    block = rigid("external", half=40, force=500.0)
    # Without friction the block does not brake.
    assert solve(block, elements=20).torque == 0
    block = vary(block, {"friction": 0.3})
    scene = make_prepared_model(block, elements=20)
    assert solve_prepared_model(
        scene, brake_with_worn_in_clearances(scene, block)
    ).torque == pytest.approx(solve_brake_by_sine_law(block).torque, rel=1e-5)
    oval = vary(
        brake_with_worn_in_clearances(SCENE, off),
        {"drum.out_of_round": [{"order": 2, "amplitude": 2e-5}]},
    )
    assert abs(solve_prepared_model(SCENE, oval).torque / law.torque - 1) > 0.01


def test_the_worn_in_shape_is_the_one_that_wear_ends_with():
    """`brake_with_worn_in_clearances` returns the shape that Archard's wear ends with.

    Both differ by a turn of the shoe alone, sin(phi).
    """
    off = vary(BRAKE, {f"{MISFIT}.radius": R + 5e-5, f"{MISFIT}.taper": -3e-5})
    setup = wear_setup_by_finite_elements(SCENE, off)
    goal = run_in.final_wear_pressure_and_torque_by_rigid_shoe_law(setup)
    states = run_in.wear_brake_linings_until_worn_in(
        setup, until=run_in.make_function_that_tests_for_end_of_wear(setup, goal, 1e-4)
    )
    ended, limit = (
        run_in.brake_with_worn_linings(setup, states[-1]),
        brake_with_worn_in_clearances(SCENE, off),
    )
    for by_wear, at_once in zip(ended.shoes, limit.shoes, strict=True):
        theta, gap = np.array(at_once.lining.clearance).T
        difference = clearance.gaps_between_unloaded_lining_and_surface(ended, by_wear, theta) - gap
        turn = np.sin(by_wear.frame.phi_of_surface_coordinates(theta))
        # The part of the difference that a turn of the shoe makes is taken off.
        left = difference - turn * (turn @ difference) / (turn @ turn)
        # At the lining's ends the pressure has a spike that wears for ever.
        inside = slice(2, -2)
        assert np.abs(left[inside]).max() < 0.02 * np.ptp(gap)


REFUSED = [
    ('misfit = { radius = "160 mm" }', ["misfit.radius = 160 mm", "drum.radius = 150 mm"]),
    ('misfit = { taper = "-8 mm" }', ["misfit.taper = -8 mm", "7.5 mm"]),
    ('misfit = { offset = { x = "9 mm", y = "0 mm" } }', ["misfit.offset = 9 mm", "7.5 mm"]),
    ('misfit = { offset = "9 mm" }', ["misfit.offset = '9 mm'"]),
    ('misfit = { blocks = [["56 deg", "1 mm"]] }', ["misfit.blocks", "-70 deg to 55 deg"]),
    (
        'misfit = { blocks = [["5 deg", "1 mm"], ["5.5 deg", "0 mm"]] }',
        ["misfit.blocks", "more than 1 deg"],
    ),
    ('misfit = { blocks = [["5 deg", "-9 mm"]] }', ["misfit.blocks", "7.5 mm"]),
    ('misfit = { blocks = ["5 deg"] }', ["misfit.blocks", "rows like"]),
    ('misfit = { blocks = [["5 deg", 1]] }', ["depth = 1 has no unit"]),
    ('misfit = { tapper = "1 mm" }', ["did you mean 'taper'"]),
]


@pytest.mark.parametrize(("line", "words"), REFUSED, ids=[f"{i}" for i in range(len(REFUSED))])
def test_wrong_misfits_are_refused_in_one_line(tmp_path, line, words):
    path = tmp_path / "b.toml"
    path.write_text(TEXT.replace('end = "55 deg"', f'end = "55 deg"\n{line}', 1))
    with pytest.raises(BadInput) as refusal:
        read_brake(path)
    assert "\n" not in str(refusal.value) and "shoe[0].lining" in str(refusal.value)
    for word in words:
        assert word in str(refusal.value)


def test_wrong_drums_are_refused_in_one_line(tmp_path):
    path = tmp_path / "b.toml"
    for line, words in (
        ('out_of_round = [{ order = -1, amplitude = "1 mm" }]', "out_of_round[0].order = -1"),
        ('out_of_round = [{ order = 1.5, amplitude = "1 mm" }]', "out_of_round[0].order = 1.5"),
        (
            "out_of_round = [{ order = 2, amplitude = 3 }]",
            "out_of_round[0].amplitude = 3: has no unit",
        ),
        ('out_of_round = [{ order = 2, amplitude = "9 mm" }]', "out_of_round = 9 mm in all"),
        ('angle = "3 mm"', "drum.angle = '3 mm'"),
    ):
        path.write_text(TEXT.replace("[drum]", f"[drum]\n{line}"))
        with pytest.raises(BadInput) as refusal:
            read_brake(path)
        assert words in str(refusal.value)
