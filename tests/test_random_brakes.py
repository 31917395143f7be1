"""A hundred random brakes: each ends converged or refused with a reason.

Up to mu = 0.6 the answer is the same whatever contact set it starts from. Far beyond, where
friction may have taken the matrix its uniqueness, the answer is what the model takes; that is
checked too, not that there is no other.
"""

import math
from collections import Counter

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.file import make_drum_brake_from_data
from drumlin.fem.equilibrium.group import ShoeGroup
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model

# Friction up to which any start must lead to the same answer.
UNIQUE = 0.6
ROTATIONS = ("counter-clockwise", "clockwise")


@st.composite
def shoes(draw, R):
    """Tables of a random shoe for a drum of radius R: lining rigid, backed or on an elastic arc."""

    def between(low, high):
        return draw(st.floats(low, high))

    side = draw(st.sampled_from(["internal", "external"]))
    inside, way, origin = side == "internal", draw(st.sampled_from([-1, 1])), between(-3, 3)
    gap, arc = between(0.05, 0.4), between(0.4, 2.4)
    start, end = sorted([origin + way * gap, origin + way * (gap + arc)])
    far = origin + way * (gap + arc)
    pin = R * (between(0.25, 0.95) if inside else between(1.05, 1.6))
    load = R * (between(0.5, 1.0) if inside else between(1.0, 1.6))
    gaps = st.floats(-2e-4, 1e-3).map(lambda g: g * R)
    wide = st.floats(0.05, 0.3).map(lambda g: g * R)
    table = st.lists(gaps, min_size=5, max_size=5).map(
        lambda values: list(zip(np.linspace(start, end, 5).tolist(), values, strict=True))
    )
    shoe = {
        "name": "shoe",
        "side": side,
        "hinge": {"radius": pin, "angle": origin},
        "lining": {
            "start": start,
            "end": end,
            "thickness": R * between(0.02, 0.12),
            "width": R * between(0.1, 0.4),
            "material": {"E": 10 ** between(7.7, 9.7), "nu": between(0, 0.45)},
            "clearance": draw(st.one_of(st.just(0.0), gaps, table, wide)),
        },
        "actuation": {
            "force": 10 ** between(2, 5),
            "direction": far + (0 if inside else math.pi) + between(-0.9, 0.9),
            "point": {"radius": load, "angle": far},
        },
    }
    if draw(st.booleans()):
        shoe["backing"] = {"thickness": R * between(0.02, 0.1), "material": {"E": 1e10, "nu": 0.3}}
    if draw(st.integers(0, 3)):
        shoe["body"] = {
            "thickness": R * between(0.03, 0.25),
            "width": R * between(0.1, 0.4),
            "start": start - gap / 2,
            "end": end + gap / 2,
            "material": {"E": 10 ** between(9.7, 11.5), "nu": between(0, 0.45)},
        }
    return shoe


@st.composite
def brakes(draw):
    R = draw(st.floats(0.05, 0.4))
    return {
        "title": "random",
        "rotation": draw(st.sampled_from(ROTATIONS)),
        "friction": draw(st.floats(0, UNIQUE) | st.floats(1, 5)),
        "drum": {"radius": R},
        "shoe": [draw(shoes(R))],
    }


@pytest.mark.parametrize("count", [20, pytest.param(100, marks=pytest.mark.slow)])
def test_random_brakes_end_converged_or_refused_with_a_reason(count):
    ends, steps = Counter(), []

    @settings(max_examples=count, suppress_health_check=list(HealthCheck))
    @given(brakes(), st.integers(0, 1000), st.sampled_from([1e6, math.inf]))
    def every(data, seed, penalty):
        try:
            brake = make_drum_brake_from_data(data)
            scene = make_prepared_model(brake, elements=24)
            response = solve_prepared_model(scene, brake, penalty=penalty)
        except (BadInput, NoAnswer) as refusal:
            assert "\n" not in str(refusal)
            assert any(
                why in str(refusal)
                for why in (
                    "self-locking",
                    "to touch",
                    "touching",
                    "no equilibrium",
                    "pressed in by",
                )
            )
            ends[type(refusal).__name__] += 1
            return
        assert response.converged
        assert max(response.balance.force, response.balance.moment) <= 1e-8
        if not response.shoes[0].contact_arcs:
            ends["untouched"] += 1
            return
        if brake.friction <= UNIQUE:
            steps.append(response.iterations)
        ends[f"{len(response.shoes[0].contact_arcs)} arcs"] += 1
        body = scene.bodies[0]
        problem = ShoeGroup(scene, brake, (0,), penalty).contact_problem_of_group
        found = ShoeGroup(scene, brake, (0,), penalty).solve_contact_for_given_abutment_friction()
        w = (
            problem.q + problem.A @ found.p + problem.B @ found.y
        ) / body.coupling.areas_of_contact_nodes
        gap_scale = (
            np.abs(problem.q / body.coupling.areas_of_contact_nodes).max()
            + np.abs(problem.A @ found.p / body.coupling.areas_of_contact_nodes).max()
        )
        assert found.p.min() >= 0
        assert w.min() >= -1e-8 * gap_scale
        assert (found.p * np.abs(w)).max() <= 1e-8 * found.p.max() * gap_scale
        assert found.stable
        if brake.friction > UNIQUE:
            return
        start = np.random.default_rng(seed).random(len(problem.q)) < 0.5
        other = ShoeGroup(scene, brake, (0,), penalty).solve_contact_for_given_abutment_friction(
            start
        )
        assert other.p == pytest.approx(found.p, rel=1e-6, abs=1e-8 * found.p.max())

    every()
    assert sum(ends.values()) >= count
    assert ends["1 arcs"] >= count / 5
    if count == 100:
        # Both kinds of refusal occur among the hundred brakes.
        assert ends["2 arcs"] + ends["3 arcs"] >= 1 and ends["NoAnswer"] >= 1, ends
    # A few brakes need tens of steps, one node after the other.
    assert 1 <= np.median(steps) <= 6
