"""Brakes that run in: their final state, the balance of forces, and agreement with other models."""

import math
from itertools import pairwise

import numpy as np
import pytest

from conftest import ROOT
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.file import read_brake, vary
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.laws import hinged, rigid
from drumlin.lining_wear.archard import (
    WearLaw,
    relative_amplitude_of_node_to_node_pressure_ripple,
    wear_linings_in_given_steps,
)
from drumlin.lining_wear.linings import (
    brake_with_shoes_on_guides,
    wear_setup_by_finite_elements,
    wear_setup_by_foundation_model,
)
from drumlin.lining_wear.run_in import (
    DEFAULT_WEAR_COEFFICIENT,
    brake_with_worn_linings,
    compute_checks_of_wear_run,
    compute_life_of_linings,
    final_wear_pressure_and_torque_by_rigid_shoe_law,
    relative_differences_from_end_of_wear,
    sliding_distance_of_e_fold_pressure_change,
    wear_brake_linings_until_worn_in,
)
from drumlin.response.norms import relative_distance_of_pressures
from drumlin.studies import import_study_and_find_folder_above_studies
from drumlin_studies.run_in_limits import table_row_and_wear_run_of_brake
from picking import picked

LAW = WearLaw(DEFAULT_WEAR_COEFFICIENT)


def of(name, **changes):
    return vary(read_brake(ROOT / "studies" / f"{name}.toml"), changes)


@pytest.fixture(scope="module")
def scene(brake):
    return make_prepared_model(brake, elements=60)


@pytest.fixture(scope="module")
def setup(scene, brake):
    return wear_setup_by_finite_elements(scene, brake)


@pytest.fixture(scope="module")
def states(setup):
    return wear_brake_linings_until_worn_in(setup)


def holds(setup, states, law_torque):
    """Check everything that must hold after run-in."""
    assert (
        relative_differences_from_end_of_wear(
            setup, states[-1], final_wear_pressure_and_torque_by_rigid_shoe_law(setup)
        ).pressure
        <= 0.01
    )
    assert states[-1].torque == pytest.approx(law_torque, rel=1e-3)
    found = compute_checks_of_wear_run(setup, states, LAW)
    assert found.volume < 1e-8
    assert found.energy < 1e-6
    for s in setup.surfaces:
        assert (
            relative_amplitude_of_node_to_node_pressure_ripple(
                s.lining_values_by_growing_angle(states[-1].pressure)
            )
            < 1e-3
        )


def test_the_main_brake_comes_to_the_sine_law_and_stays(brake, setup, states):
    law = hinged.solve_brake_by_sine_law(brake)
    holds(setup, states, law.torque)
    assert (
        relative_differences_from_end_of_wear(
            setup, states[0], final_wear_pressure_and_torque_by_rigid_shoe_law(setup)
        ).pressure
        > 0.5
    )
    long = wear_brake_linings_until_worn_in(setup, distance=10 * states[-1].s)
    assert (
        max(
            map(
                abs,
                relative_differences_from_end_of_wear(
                    setup, long[-1], final_wear_pressure_and_torque_by_rigid_shoe_law(setup)
                ),
            )
        )
        < 1e-6
    )
    # The target is the law itself, not only near it.
    for surface in setup.surfaces:
        expected = law.shoes[surface.shoe].pressure_at(surface.contact_angles_in_growing_order)
        np.testing.assert_allclose(
            surface.lining_values_by_growing_angle(
                final_wear_pressure_and_torque_by_rigid_shoe_law(setup).pressure
            ),
            expected,
            rtol=1e-6,
        )


def test_every_state_is_what_the_finite_elements_answer_for_the_worn_brake(scene, setup, states):
    for state in states[:: len(states) // 4]:
        response = solve_prepared_model(
            scene, brake_with_worn_linings(setup, state), penalty=math.inf
        )
        assert response.torque == pytest.approx(state.torque, rel=1e-9)
        for surface, shoe in zip(setup.surfaces, response.shoes, strict=True):
            np.testing.assert_allclose(
                surface.lining_values_by_growing_angle(state.pressure),
                shoe.pressure,
                atol=1e-7 * shoe.pressure.max(),
            )


def test_half_the_step_gives_the_same_answer(setup, states):
    s = picked(states, "s")
    halved = wear_linings_in_given_steps(
        setup.interfaces, LAW, sorted([*s[1:], *((a + b) / 2 for a, b in pairwise(s))])
    )[::2]
    area = np.concatenate(picked(setup.interfaces, "area"))
    for a, b in zip(states, halved, strict=True):
        assert a.s == b.s
        # The tolerance asked for is 1e-3, here squared.
        assert area @ (a.pressure - b.pressure) ** 2 < 1e-6 * (area @ b.pressure**2)
        assert a.torque == pytest.approx(b.torque, rel=1e-4)


@pytest.mark.parametrize("ratio", [1e-4, 1e-1])
def test_linings_soft_and_stiff_come_to_the_law(brake, ratio):
    changed = vary(brake, {"shoe.lining.material.E": 210e9 * ratio})
    setup = wear_setup_by_finite_elements(make_prepared_model(changed, elements=40), changed)
    holds(
        setup, wear_brake_linings_until_worn_in(setup), hinged.solve_brake_by_sine_law(brake).torque
    )


def test_a_pivoted_shoe_comes_to_its_two_term_law():
    brake = of("laws/pivoted_block", **{"shoe.pivot": {"x": 0.27, "y": 0.02}})
    setup = wear_setup_by_finite_elements(make_prepared_model(brake, elements=40), brake)
    law = rigid.solve_brake_by_rigid_shoe_law(brake)
    holds(setup, wear_brake_linings_until_worn_in(setup), law.torque)
    (surface,) = setup.surfaces
    np.testing.assert_allclose(
        surface.lining_values_by_growing_angle(
            final_wear_pressure_and_torque_by_rigid_shoe_law(setup).pressure
        ),
        law.shoes[0].pressure_at(surface.contact_angles_in_growing_order),
        atol=1e-5 * law.shoes[0].peak_pressure,
    )


def test_a_guided_shoe_comes_to_the_cosine_law():
    brake = of("laws/block")
    setup = wear_setup_by_finite_elements(
        make_prepared_model(brake_with_shoes_on_guides(brake), elements=40),
        brake_with_shoes_on_guides(brake),
    )
    holds(
        setup,
        wear_brake_linings_until_worn_in(setup),
        hinged.torque_of_brake_with_guided_shoes(brake),
    )
    (surface,) = setup.surfaces
    p = surface.lining_values_by_growing_angle(
        final_wear_pressure_and_torque_by_rigid_shoe_law(setup).pressure
    )
    cosine = np.cos(surface.contact_angles_in_growing_order - math.pi / 2)
    np.testing.assert_allclose(p, p.max() * cosine, rtol=1e-6)


def test_a_post_comes_to_the_sine_law_on_the_foundation_once_it_may_tilt():
    brake = of("post_brake/brake")
    setup = wear_setup_by_foundation_model(brake, sections=180, lift=("tilt",))
    holds(
        setup, wear_brake_linings_until_worn_in(setup), hinged.solve_brake_by_sine_law(brake).torque
    )
    published = final_wear_pressure_and_torque_by_rigid_shoe_law(
        wear_setup_by_foundation_model(brake, sections=180)
    ).torque
    # The shoes turn without tilt, which gives x cos(theta), not sin(phi).
    assert published > 1.04 * hinged.solve_brake_by_sine_law(brake).torque


def test_shoes_that_meet_through_a_ring_wear_together():
    brake = of("post_brake/brake")
    setup = wear_setup_by_finite_elements(make_prepared_model(brake, elements=24), brake)
    assert len(setup.interfaces) == 1 and len(setup.surfaces) == 2
    holds(
        setup, wear_brake_linings_until_worn_in(setup), hinged.solve_brake_by_sine_law(brake).torque
    )


def test_a_square_law_of_wear_tends_to_the_root_of_the_sine(setup):
    law = WearLaw(DEFAULT_WEAR_COEFFICIENT, 2.0)
    states, goal = (
        wear_brake_linings_until_worn_in(setup, law),
        final_wear_pressure_and_torque_by_rigid_shoe_law(setup, law),
    )
    for surface in setup.surfaces:
        phi = setup.brake.shoes[surface.shoe].frame.phi_of_surface_coordinates(
            surface.contact_angles_in_growing_order
        )
        p = surface.lining_values_by_growing_angle(goal.pressure)
        np.testing.assert_allclose(
            p / p.max(), np.sqrt(np.sin(phi) / np.sin(phi)[p.argmax()]), rtol=1e-5
        )
    assert max(map(abs, relative_differences_from_end_of_wear(setup, states[-1], goal))) < 1e-3


def test_constant_torque_needs_the_force_that_the_worn_brake_needs(scene, brake, setup):
    states = wear_brake_linings_until_worn_in(setup, torque=450.0)
    # Both shoes share one force of the cam.
    assert len(setup.interfaces) == 2
    for state in states[:: len(states) // 3]:
        force = {
            f"shoe[{i}].actuation.force": state.force * brake.shoes[i].actuation.force
            for i in (0, 1)
        }
        assert solve_prepared_model(
            scene, vary(brake_with_worn_linings(setup, state), force), penalty=math.inf
        ).torque == pytest.approx(450.0, rel=1e-9)


def test_a_reversal_undoes_the_law_until_the_lining_has_run_in_anew(scene, brake, setup, states):
    other = wear_setup_by_finite_elements(scene, vary(brake, {"rotation": "clockwise"}))
    every = states[-1].s
    run = wear_brake_linings_until_worn_in(setup, backward=other, reverse=every, distance=2 * every)
    (turn,) = [i for i, (a, b) in enumerate(pairwise(run)) if a.forward != b.forward]
    before, after = run[turn], run[turn + 1]
    assert before.s == after.s == every
    assert (before.depth == after.depth).all()
    assert (
        relative_differences_from_end_of_wear(
            setup, before, final_wear_pressure_and_torque_by_rigid_shoe_law(setup)
        ).pressure
        < 2e-3
    )
    assert (
        relative_differences_from_end_of_wear(
            other, after, final_wear_pressure_and_torque_by_rigid_shoe_law(other)
        ).pressure
        > 0.3
    )
    assert (
        relative_differences_from_end_of_wear(
            other, run[-1], final_wear_pressure_and_torque_by_rigid_shoe_law(other)
        ).pressure
        < 0.01
    )
    third = wear_brake_linings_until_worn_in(
        setup, backward=other, reverse=every / 3, distance=3.0 * (every / 3), tolerance=5e-3
    )
    # The run does not turn back at its very end.
    assert sum(a.forward != b.forward for a, b in pairwise(third)) == 2
    with pytest.raises(BadInput, match="distance must be given"):
        wear_brake_linings_until_worn_in(setup, backward=other, reverse=every)


def test_the_part_of_life_does_not_depend_on_the_wear_coefficient_and_grows_with_the_force(
    brake, scene, setup, states
):
    mine = compute_life_of_linings(
        setup, states, final_wear_pressure_and_torque_by_rigid_shoe_law(setup), LAW
    )
    faster = WearLaw(7 * DEFAULT_WEAR_COEFFICIENT)
    again = compute_life_of_linings(
        setup,
        wear_brake_linings_until_worn_in(setup, faster),
        final_wear_pressure_and_torque_by_rigid_shoe_law(setup),
        faster,
    )
    assert again.pressure == pytest.approx(mine.pressure, rel=1e-6)
    assert sliding_distance_of_e_fold_pressure_change(setup, faster) == pytest.approx(
        sliding_distance_of_e_fold_pressure_change(setup, LAW) / 7
    )
    heavy = wear_setup_by_finite_elements(scene, vary(brake, {"shoe.actuation.force": 4e3}))
    assert compute_life_of_linings(
        heavy,
        wear_brake_linings_until_worn_in(heavy),
        final_wear_pressure_and_torque_by_rigid_shoe_law(heavy),
        LAW,
    ).pressure == pytest.approx(2 * mine.pressure, rel=2e-3)
    assert 0.1 < mine.pressure < 0.2 and 0.03 < mine.torque < 0.06


def test_what_cannot_be_worn_in_is_refused(brake, scene, flexible):
    with pytest.raises(NoAnswer, match="no contact"):
        wear_setup_by_finite_elements(scene, vary(brake, {"shoe.actuation.force": -1.0}))
    with pytest.raises(BadInput, match="foundation does not apply"):
        wear_setup_by_foundation_model(flexible)
    locking = vary(brake, {"friction": 1.0})
    with pytest.raises(NoAnswer):
        final_wear_pressure_and_torque_by_rigid_shoe_law(
            wear_setup_by_finite_elements(make_prepared_model(locking, elements=10), locking)
        )


def test_the_worn_brake_is_a_brake_file_apart(setup, states, brake):
    """The clearance of the worn brake is that of the file plus the depth of wear.

    Without wear, the worn brake is the brake itself.
    """
    new = brake_with_worn_linings(setup, states[0])
    assert all(abs(c) < 1e-15 for shoe in new.shoes for _, c in shoe.lining.clearance)
    end = brake_with_worn_linings(setup, states[-1])
    assert np.array(end.shoes[0].lining.clearance)[:, 1].max() == pytest.approx(
        states[-1].depth[setup.surfaces[0].part].max()
    )
    law, coarse = hinged.solve_brake_by_sine_law(brake), make_prepared_model(brake, elements=30)
    # On another mesh the worn lining still bears by the law.
    response = solve_prepared_model(coarse, end, penalty=math.inf)
    assert relative_distance_of_pressures(response.shoes[0], law.shoes[0]) < 0.02


def test_the_study_leaves_out_what_never_settles_and_every_other_example_comes_to_an_end():
    """No example brake stops the study: its filter names those that wear without end."""
    found, skipped = import_study_and_find_folder_above_studies("run_in")[0].brakes_that_run_in(
        short=False
    )
    for name in ("forces/air_chamber", "forces/centrifugal_clutch"):
        (reason,) = [one for one in skipped if one.startswith(f"{name}: ")]
        assert "spring[0].rate = " in reason and reason.endswith("which does not settle")
    names = {name for name, _, _ in found}
    assert {"brakes/s_cam", "brakes/duo_servo", "linings/fading_friction"} < names
    assert len(found) > 30
    for name, model, brake in found:
        # The foundation model and meshes of one's own take longer, and have tests of their own.
        if model.startswith("foundation") or name.startswith("meshes/"):
            continue
        row, run = table_row_and_wear_run_of_brake(name, model, brake, 6)
        assert run is not None, row["status"]
