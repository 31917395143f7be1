"""Brakes that run in: to their law, in balance, as every other model sees them."""

import math
from itertools import pairwise

import numpy as np
import pytest

from conftest import ROOT
from drumlin.brake.file import read_brake, vary
from drumlin.errors import BadInput, NoAnswer
from drumlin.fem.assembly import prepare
from drumlin.fem.model import respond
from drumlin.laws import hinged, pivoted
from drumlin.response.norms import pressure_distance
from drumlin.wear.archard import Law, ripple, run_on
from drumlin.wear.linings import fem_rig, foundation_rig
from drumlin.wear.run_in import COEFFICIENT, checks, distance, life, run_in, target, unit_distance, worn

LAW = Law(COEFFICIENT)


def of(name, **changes):
    return vary(read_brake(ROOT / "studies" / f"{name}.toml"), changes)


@pytest.fixture(scope="module")
def scene(brake):
    return prepare(brake, elements=60)


@pytest.fixture(scope="module")
def rig(scene, brake):
    return fem_rig(scene, brake)


@pytest.fixture(scope="module")
def states(rig):
    return run_in(rig)


def holds(rig, states, law_torque):
    """What must hold after run-in, in one place."""
    end = distance(rig, states[-1], target(rig))
    assert end.pressure <= 0.01
    assert states[-1].torque == pytest.approx(law_torque, rel=1e-3)
    found = checks(rig, states, LAW)
    assert found.volume < 1e-8
    assert found.energy < 1e-6
    assert all(ripple(s.along(states[-1].pressure)) < 1e-3 for s in rig.surfaces)


def test_the_main_brake_comes_to_the_sine_law_and_stays(brake, rig, states):
    law = hinged.sine(brake)
    holds(rig, states, law.torque)
    assert distance(rig, states[0], target(rig)).pressure > 0.5
    long = run_in(rig, distance=10 * states[-1].s)
    assert max(map(abs, distance(rig, long[-1], target(rig)))) < 1e-6
    for surface in rig.surfaces:  # the target is the law itself, not only near it
        expected = law.shoes[surface.shoe].pressure_at(surface.angles)
        np.testing.assert_allclose(surface.along(target(rig).pressure), expected, rtol=1e-6)


def test_every_state_is_what_the_finite_elements_answer_for_the_worn_brake(scene, rig, states):
    for state in states[:: len(states) // 4]:
        response = respond(scene, worn(rig, state), penalty=math.inf)
        assert response.torque == pytest.approx(state.torque, rel=1e-9)
        for surface, shoe in zip(rig.surfaces, response.shoes, strict=True):
            np.testing.assert_allclose(surface.along(state.pressure), shoe.pressure, atol=1e-7 * shoe.pressure.max())


def test_half_the_step_gives_the_same_answer(rig, states):
    s = [state.s for state in states]
    halved = run_on(rig.rubs, LAW, sorted([*s[1:], *((a + b) / 2 for a, b in pairwise(s))]))[::2]
    area = np.concatenate([rub.area for rub in rig.rubs])
    for a, b in zip(states, halved, strict=True):
        assert a.s == b.s
        assert area @ (a.pressure - b.pressure) ** 2 < 1e-6 * (area @ b.pressure**2)  # the tolerance asked for
        assert a.torque == pytest.approx(b.torque, rel=1e-4)


@pytest.mark.parametrize("ratio", [1e-4, 1e-1])
def test_linings_soft_and_stiff_come_to_the_law(brake, ratio):
    changed = vary(brake, {"shoe.lining.material.E": 210e9 * ratio})
    rig = fem_rig(prepare(changed, elements=40), changed)
    holds(rig, run_in(rig), hinged.sine(brake).torque)


def test_a_pivoted_shoe_comes_to_its_two_term_law():
    brake = of("laws/pivoted_block", **{"shoe.pivot": {"x": 0.27, "y": 0.02}})
    rig = fem_rig(prepare(brake, elements=40), brake)
    law = pivoted.solve(brake)
    holds(rig, run_in(rig), law.torque)
    (surface,) = rig.surfaces
    np.testing.assert_allclose(
        surface.along(target(rig).pressure),
        law.shoes[0].pressure_at(surface.angles),
        atol=1e-5 * law.shoes[0].peak_pressure,
    )


def test_a_guided_shoe_comes_to_the_cosine_law():
    brake = of("laws/block")
    rig = fem_rig(prepare(brake, elements=40), brake, guide="radius")
    holds(rig, run_in(rig), hinged.guided_torque(brake))
    (surface,) = rig.surfaces
    p = surface.along(target(rig).pressure)
    cosine = np.cos(surface.angles - math.pi / 2)
    np.testing.assert_allclose(p, p.max() * cosine, rtol=1e-6)


def test_a_post_comes_to_the_sine_law_on_the_foundation_once_it_may_tilt():
    brake = of("post_brake/brake")
    rig = foundation_rig(brake, sections=180, lift=("tilt",))
    states = run_in(rig)
    holds(rig, states, hinged.sine(brake).torque)
    published = target(foundation_rig(brake, sections=180)).torque
    assert published > 1.04 * hinged.sine(brake).torque  # its shoes turn without tilt: x cos(theta), not sin(phi)


def test_shoes_that_meet_through_a_ring_wear_together():
    brake = of("post_brake/brake")
    rig = fem_rig(prepare(brake, elements=24), brake)
    assert len(rig.rubs) == 1 and len(rig.surfaces) == 2
    holds(rig, run_in(rig), hinged.sine(brake).torque)


def test_a_square_law_of_wear_tends_to_the_root_of_the_sine(rig):
    law = Law(COEFFICIENT, 2.0)
    states, goal = run_in(rig, law), target(rig, law)
    for surface in rig.surfaces:
        phi = rig.brake.shoes[surface.shoe].frame.phi(surface.angles)
        p = surface.along(goal.pressure)
        np.testing.assert_allclose(p / p.max(), np.sqrt(np.sin(phi) / np.sin(phi)[p.argmax()]), rtol=1e-5)
    assert max(map(abs, distance(rig, states[-1], goal))) < 1e-3


def test_constant_torque_needs_the_force_that_the_worn_brake_needs(scene, brake, rig):
    states = run_in(rig, torque=450.0)
    assert len(rig.rubs) == 2  # both shoes share one force
    for state in states[:: len(states) // 3]:
        force = {f"shoe[{i}].actuation.force": state.force * brake.shoes[i].actuation.force for i in (0, 1)}
        assert respond(scene, vary(worn(rig, state), force), penalty=math.inf).torque == pytest.approx(450.0, rel=1e-9)


def test_a_reversal_undoes_the_law_until_the_lining_has_run_in_anew(scene, brake, rig, states):
    other = fem_rig(scene, vary(brake, {"rotation": "clockwise"}))
    every = states[-1].s
    run = run_in(rig, backward=other, reverse=every, distance=2 * every)
    (turn,) = [i for i, (a, b) in enumerate(pairwise(run)) if a.forward != b.forward]
    before, after = run[turn], run[turn + 1]
    assert before.s == after.s == every
    assert (before.depth == after.depth).all()
    assert distance(rig, before, target(rig)).pressure < 2e-3
    assert distance(other, after, target(other)).pressure > 0.3
    assert distance(other, run[-1], target(other)).pressure < 0.01
    third = run_in(rig, backward=other, reverse=every / 3, distance=3.0 * (every / 3), tolerance=5e-3)
    assert sum(a.forward != b.forward for a, b in pairwise(third)) == 2  # none at the very end
    with pytest.raises(BadInput, match="distance must be given"):
        run_in(rig, backward=other, reverse=every)


def test_the_part_of_life_does_not_depend_on_the_wear_coefficient_and_grows_with_the_force(brake, scene, rig, states):
    mine = life(rig, states, target(rig), LAW)
    faster = Law(7 * COEFFICIENT)
    again = life(rig, run_in(rig, faster), target(rig), faster)
    assert again.pressure == pytest.approx(mine.pressure, rel=1e-6)
    assert unit_distance(rig, faster) == pytest.approx(unit_distance(rig, LAW) / 7)
    heavy = fem_rig(scene, vary(brake, {"shoe.actuation.force": 4e3}))
    assert life(heavy, run_in(heavy), target(heavy), LAW).pressure == pytest.approx(2 * mine.pressure, rel=2e-3)
    assert 0.1 < mine.pressure < 0.2 and 0.03 < mine.torque < 0.06


def test_what_cannot_be_worn_in_is_refused(brake, scene, flexible):
    with pytest.raises(BadInput, match=r"leave out \[shoe.body\]"):
        fem_rig(scene, brake, guide="radius")
    with pytest.raises(NoAnswer, match="no contact"):
        fem_rig(scene, vary(brake, {"shoe.actuation.force": -1.0}))
    with pytest.raises(BadInput, match="foundation does not apply"):
        foundation_rig(flexible)
    locking = vary(brake, {"friction": 1.0})
    with pytest.raises(NoAnswer):
        target(fem_rig(prepare(locking, elements=10), locking))


def test_the_worn_brake_is_a_brake_file_apart(rig, states, brake):
    """Its clearance is that of the file plus the depth; the new one is the brake itself."""
    new = worn(rig, states[0])
    assert all(abs(c) < 1e-15 for shoe in new.shoes for _, c in shoe.lining.clearance)
    end = worn(rig, states[-1])
    assert max(c for _, c in end.shoes[0].lining.clearance) == pytest.approx(
        states[-1].depth[rig.surfaces[0].part].max()
    )
    law, coarse = hinged.sine(brake), prepare(brake, elements=30)
    response = respond(coarse, end, penalty=math.inf)  # on another mesh it still bears by the law
    assert pressure_distance(response.shoes[0], law.shoes[0]) < 0.02
