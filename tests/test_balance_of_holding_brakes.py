"""Moments and energy of a holding brake with springs and with friction over the pressure."""

import itertools
from typing import Any

import numpy as np
import pytest

from anchored_shoes import duo_servo
from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.fem.analysis.holding import (
    HoldingState,
    find_drum_rotation_of_full_slip,
    turn_holding_brake_and_return_states_at_rotations,
)
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from friction_tables import FALLING, over_pressure
from further_loads import PULL, two_shoes

SPRING: dict[str, Any] = PULL | {"rate": 1e6}
BRAKES = {
    "spring": lambda elastic: two_shoes(elastic, spring=[SPRING]),
    "friction over pressure": lambda elastic: over_pressure(two_shoes(elastic), FALLING),
    "both": lambda elastic: over_pressure(two_shoes(elastic, spring=[SPRING]), FALLING),
}


def moment_about_origin(point: Floats, force: Floats) -> float:
    """The moment [N m] about the origin of a force (2,) [N] at a point (2,) [m]."""
    return float(point[0] * force[1] - point[1] * force[0])


def moment_about_hinge(
    scene: PreparedModel, brake: Brake, state: HoldingState, index: int
) -> float:
    """The moment [N m] of all forces on a shoe about its hinge, which the hinge cannot balance."""
    shoe, body = brake.shoes[index], scene.bodies[index]
    normal, dragged = body.resultants_of_unit_nodal_pressures_and_tractions
    phi, _ = body.line.angles_and_pressures_averaged_over_width(np.zeros(len(body.line.nodes)))
    order = np.argsort(shoe.frame.surface_coordinates_of_phi(phi))
    p, t = np.empty(len(order)), np.empty(len(order))
    p[order], t[order] = state.pressure[index], state.traction[index]
    of_contact = shoe.frame.sense * (dragged @ t) - normal @ p
    force = shoe.frame.convert_vectors_from_shoe_to_brake_frame(of_contact[:2])
    hinge, push = shoe.hinge.xy, shoe.actuation.force * shoe.actuation.unit_vector_of_force
    moment = shoe.frame.sense * of_contact[2] - moment_about_origin(hinge, force)
    moment += moment_about_origin(shoe.actuation.point.xy - hinge, push)
    for spring, pull in zip(brake.springs, state.spring_pulls, strict=False):
        load = spring.spring_or_lever_force_on_shoe(shoe.name, pull)
        if load is not None:
            moment += load.resultant[2] - moment_about_origin(hinge, load.resultant[:2])
    return float(moment)


@pytest.mark.parametrize("elastic", [False, True])
@pytest.mark.parametrize("name", BRAKES)
def test_a_holding_brake_balances_at_every_rotation_and_dissipates_its_work(name, elastic):
    """Beyond full slip nothing is stored any more: the work of the drum is dissipated."""
    brake = BRAKES[name](elastic)
    scene = make_prepared_model(brake, elements=8)
    end = find_drum_rotation_of_full_slip(scene, brake)
    rotations = np.array([0.0, 0.3, 0.7, 1.0, 1.5, 2.0]) * end
    states = turn_holding_brake_and_return_states_at_rotations(scene, brake, rotations)
    push = brake.shoes[0].actuation.force * brake.size
    for state in states:
        for index in range(len(brake.shoes)):
            assert abs(moment_about_hinge(scene, brake, state, index)) < 1e-9 * push
    for before, after in zip(states[-3:], states[-2:], strict=False):
        work = 0.5 * (before.torque + after.torque) * (after.rotation - before.rotation)
        assert after.dissipated - before.dissipated == pytest.approx(work, rel=1e-9)


@pytest.mark.parametrize("elastic", [False, True])
def test_a_holding_duo_servo_on_a_spring_balances_and_dissipates_its_work(elastic):
    """The anchor alone holds both shoes against the drum's moment, so that its force is known.

    The cylinder, the strut and the spring push or pull both shoes alike, without a moment on them.
    """
    spring = SPRING | {"point": {"x": 0.05, "y": 0.07}, "end": {"x": -0.05, "y": 0.07}}
    brake = vary(duo_servo(body=elastic), {"spring": [spring]})
    scene = make_prepared_model(brake, elements=8)
    end = find_drum_rotation_of_full_slip(scene, brake)
    rotations = np.array([1.0, 1.5, 2.0]) * end
    states = turn_holding_brake_and_return_states_at_rotations(scene, brake, rotations)
    solved = solve_prepared_model(scene, brake)
    assert states[-1].torque == pytest.approx(solved.torque, rel=1e-9)
    anchors = [
        each.push.force
        for shoe in solved.shoes
        for each in shoe.supports
        if each.name.startswith("anchor")
    ]
    height = brake.shoes[0].anchors[0].point.y
    assert max(anchors) * height == pytest.approx(states[-1].torque, rel=1e-9)
    for before, after in itertools.pairwise(states):
        work = 0.5 * (before.torque + after.torque) * (after.rotation - before.rotation)
        assert after.dissipated - before.dissipated == pytest.approx(work, rel=1e-9)
