"""What is done with a brake besides: every kind of shoe, or one plain line that says why not."""

import numpy as np
import pytest

import drumlin
from drumlin.brake.file import vary
from drumlin.contact import stick_slip
from drumlin.fem.analysis.at_rest import (
    FeetOnRoughAbutments,
    make_stick_slip_problem_and_slip_per_drum_rotation,
)
from drumlin.fem.analysis.holding import (
    find_drum_rotation_of_full_slip,
    turn_holding_brake_and_return_states_at_rotations,
)
from drumlin.fem.equilibrium.group import divide_shoes_into_groups
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from held_shoes import BODY, brake_of
from picking import picked
from shared_forces import cam_brake, servo


@pytest.mark.parametrize("kind", ["abutment", "pivot", "guide"])
def test_held_from_rest_to_full_slip_shoes_come_to_the_sliding_torque(kind: str) -> None:
    brake = vary(brake_of(kind, 1, body=BODY), {"shoe.lining.thickness": 0.005})
    scene = make_prepared_model(brake, elements=16)
    states = turn_holding_brake_and_return_states_at_rotations(
        scene, brake, np.geomspace(1e-6, 2e-3, 8)
    )
    # The lever drags the shoe along the drum to full slip as it presses the shoe.
    if kind != "pivot":
        assert states[0].torque < states[-1].torque * (1 - 1e-3)
    assert states[-1].torque == pytest.approx(drumlin.solve(brake, elements=16).torque, rel=1e-3)


RING = {"thickness": 0.01, "width": 0.04, "material": {"E": 1.1e11, "nu": 0.25}, "support": "fixed"}


@pytest.mark.parametrize("ring", [None, RING])
@pytest.mark.parametrize("spin", [1, -1])
@pytest.mark.parametrize("make", [cam_brake, servo])
def test_forces_shared_by_a_cam_or_a_strut_hold_the_drum_by_what_it_slides_at(
    make, spin: int, ring
) -> None:
    brake = vary(make(spin=spin, body=0.012), {"shoe.lining.thickness": 0.005, "drum.ring": ring})
    scene = make_prepared_model(brake, elements=10)
    states = turn_holding_brake_and_return_states_at_rotations(
        scene, brake, np.linspace(0, find_drum_rotation_of_full_slip(scene, brake), 4)
    )
    assert states[-1].sticking == 0
    assert states[-1].torque == pytest.approx(solve_prepared_model(scene, brake).torque, rel=1e-6)
    # The strut lets both shoes be dragged, to full slip, as they are pressed.
    trailing = brake.links and spin > 0
    assert states[0].torque <= (1 + 1e-9 if trailing else 0.9) * states[-1].torque
    assert np.diff(picked(states, "dissipated")).min() >= 0


@pytest.mark.parametrize("spin", [1, -1])
def test_a_foot_on_a_rough_face_sticks_and_slips_as_the_linings_do(spin: int) -> None:
    """A foot on a rough face obeys Coulomb's law: it opens, sticks or slips as linings do.

    At full slip the drum is held by the friction of all faces that it slides on.
    """
    brake = vary(brake_of("rough abutment", spin, body=BODY), {"shoe.lining.thickness": 0.005})
    scene = make_prepared_model(brake, elements=12)
    (group,) = divide_shoes_into_groups(scene, brake, [0], 1e6)
    problem, lever = make_stick_slip_problem_and_slip_per_drum_rotation(group)
    mu = FeetOnRoughAbutments.collect_feet_on_rough_abutments(
        group
    ).friction_coefficients_of_all_nodes()
    assert mu[-1] == 0.2
    assert lever[-1] == 0
    end, n = find_drum_rotation_of_full_slip(scene, brake), len(lever)
    nothing, seen = np.zeros(n), set()
    before = stick_slip.TractionsAndSlipsOfLastIncrement(nothing, nothing)
    at = stick_slip.solve_stick_slip_load_increment(
        problem, mu, before, np.full(n, stick_slip.STICK)
    )
    for rotation in end * np.array([0.0, 0.2, 1.0, 0.5, -0.5]):
        q_s = (
            problem.q_s + lever * (brake.sign_of_motion / group.largest_actuation_force) * rotation
        )
        before, at = (
            at.tractions_and_slips_for_next_increment,
            stick_slip.solve_stick_slip_load_increment(
                problem._replace(q_s=q_s), mu, at.tractions_and_slips_for_next_increment, at.state
            ),
        )
        p, t = at.p[-1], at.t[-1]
        s = (
            problem.q_s[-1]
            + problem.A_sp[-1] @ at.p
            + problem.A_st[-1] @ at.t
            + problem.B_s[-1] @ at.y
        )
        slip = s - before.s[-1] - problem.Q[-1, -1] * (t - before.t[-1])
        assert p > 0
        assert abs(t) <= 0.2 * p * (1 + 1e-9)
        assert abs(slip) < 1e-15 or t == pytest.approx(0.2 * p * np.sign(slip), rel=1e-9)
        seen.add(int(at.state[-1]))
    assert len(seen) > 1
    last = turn_holding_brake_and_return_states_at_rotations(scene, brake, np.linspace(0, end, 5))[
        -1
    ]
    # The foot of the trailing shoe slides while the force comes on and sticks there: a little
    # beyond its place under a drum that slides already.
    assert last.torque == pytest.approx(
        solve_prepared_model(scene, brake).torque, rel=1e-3 if spin > 0 else 1e-8
    )
    assert len(last.notes) == (spin > 0)


@pytest.mark.parametrize("kind", ("abutment", "pivot", "guide"))
def test_clearance_and_misfit_act_on_every_kind_of_shoe(kind) -> None:
    brake = vary(brake_of(kind, 1, body=BODY), {"shoe.lining.thickness": 0.005})
    ground = vary(brake, {"shoe.lining.misfit": {"radius": 0.1098}, "shoe.lining.clearance": 1e-5})
    response = drumlin.solve(ground)
    assert max(response.balance.force, response.balance.moment) < 1e-9
    assert abs(response.torque / drumlin.solve(brake).torque - 1) > 1e-3


@pytest.mark.parametrize(
    ("kind", "said"),
    (
        ("abutment", "its foot holds the end face of its body, "),
        ("pivot", "its pivot grips 12 mm of the back of its body"),
        ("guide", "its guide grips 12 mm of the back of its body"),
    ),
)
def test_how_a_body_is_held_is_said_in_one_line(kind, said) -> None:
    notes = drumlin.solve(brake_of(kind, 1, body=BODY), elements=20).notes
    assert sum(said in note for note in notes) == 1


@pytest.mark.parametrize("kind", ["pivot", "guide"])
def test_a_grip_is_met_by_any_mesh(kind: str) -> None:
    """Also where both its ends lie next to one line of the mesh, or between none."""
    brake = vary(brake_of(kind, -1, body=BODY), {"shoe.lining.thickness": 0.005})
    torque = drumlin.solve(brake, elements=24).torque
    for elements in (1, 2, 3, 5, 8, 10):
        assert drumlin.solve(brake, elements=elements).torque == pytest.approx(
            torque, rel=0.2 / elements
        )
