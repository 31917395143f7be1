"""Supports that push and cannot pull: anchors, and the strut and anchor of a duo-servo brake."""

import math

import numpy as np
import pytest

import drumlin
from anchored_shoes import (
    CYLINDER,
    FOOT,
    FORCE,
    PIN,
    STEEL,
    WIDTH,
    R,
    duo_servo,
    forces,
    shoe_between_anchors,
    shoe_equations,
)
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.file import make_drum_brake_from_data, vary
from drumlin.contact import stick_slip
from drumlin.fem.analysis import holding
from drumlin.fem.analysis.prepared import prepared_model_for_hold_wear_or_sensitivity
from drumlin.fem.analysis.self_locking import (
    self_locking_friction_of_shoe_groups,
    shoe_torques_at_friction_coefficients,
)
from drumlin.fem.equilibrium.group import ShoeGroup
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin.laws import rigid
from drumlin.models import MODELS

SENSES = (1, -1)
FULL = (0.8, 0.8)
"""Half arcs [rad] of linings that touch along their whole lengths up to a friction of 0.2."""


def duo_servo_by_hand(spin: int, mu: float, half: float) -> tuple[float, float, float]:
    """Torque, strut force and anchor force of a duo-servo brake from three equations a shoe.

    The drum drags the shoes with its spin, so that the shoe on the side of the spin's hand bears on
    the anchor and the other one floats. Each equation balances forces x, y or moments about O.
    """
    free, bears = -spin, spin
    # The floating shoe: A, B and the strut's force, which is outwards at the foot.
    at_tip = FORCE * free * np.array([1.0, 0.0, -CYLINDER])
    strut = free * np.array([1.0, 0.0, -FOOT])
    own = np.column_stack([shoe_equations(free, half, spin, mu), strut])
    A, B, S = np.linalg.solve(own, -at_tip)
    torque = abs(shoe_equations(free, half, spin, mu)[2] @ [A, B])
    # The shoe on the anchor: A, B and the anchor's force under cylinder and strut.
    load = FORCE * bears * np.array([1.0, 0.0, -CYLINDER])
    load += S * bears * np.array([1.0, 0.0, -FOOT])
    anchor = bears * np.array([1.0, 0.0, -PIN])
    own = np.column_stack([shoe_equations(bears, half, spin, mu), anchor])
    A, B, f = np.linalg.solve(own, -load)
    torque += abs(shoe_equations(bears, half, spin, mu)[2] @ [A, B])
    return torque, S, f


@pytest.mark.parametrize("spin", SENSES)
@pytest.mark.parametrize("mu", (0.05, 0.1, 0.2))
def test_a_duo_servo_is_its_closed_form_in_both_senses(spin: int, mu: float) -> None:
    response = drumlin.solve(duo_servo(spin, mu, FULL), "rigid")
    assert all(
        arc == pytest.approx((m - 0.8, m + 0.8))
        for shoe, m in zip(response.shoes, (0.0, math.pi), strict=True)
        for arc in shoe.contact_arcs
    )
    torque, strut, anchor = duo_servo_by_hand(spin, mu, 0.8)
    found = forces(response)
    bears, left = ("right", "left") if spin > 0 else ("left", "right")
    assert response.torque == pytest.approx(torque, rel=1e-9)
    assert found["the strut from 'right' to 'left'"] == pytest.approx(strut, rel=1e-9)
    assert found[f"anchor of {bears!r}"] == pytest.approx(anchor, rel=1e-9)
    assert found[f"anchor of {left!r}"] == 0.0
    # The anchor alone balances the drum's torque on the pair of shoes.
    assert anchor * PIN == pytest.approx(torque, rel=1e-9)
    assert max(response.balance.force, response.balance.moment) < 1e-9


def wedge_determinant_by_hand(spin: int, mu: float, arcs: list[tuple[float, float]]) -> float:
    """The determinant of the equilibria of a duo-servo brake on its strut and on both anchors.

    On these supports both shoes turn by one angle, and each shoe moves along y. A lining point
    moves towards the drum by ux cos + uy sin, where ux is PIN times the angle, and p is in
    proportion. The unknowns are the angle, both uy, and the forces of strut and anchors. `arcs` are
    the arcs in contact of the right and the left shoe. Where the determinant is zero, the pressures
    may grow while the loads stay.
    """
    matrix = np.zeros((6, 6))
    for k, hand in enumerate((1, -1)):
        begin, end = arcs[k]
        theta = begin + (end - begin) * (np.arange(20_000) + 0.5) / 20_000
        area = WIDTH * R * (end - begin) / 20_000
        c, s, drag = np.cos(theta), np.sin(theta), mu * spin
        # Forces x and y and moment about O of unit pressures.
        unit = area * np.array([-c - drag * s, -s + drag * c, np.full(theta.shape, drag * R)])
        rows = slice(3 * k, 3 * k + 3)
        matrix[rows, 0] = unit @ (PIN * c)
        matrix[rows, 1 + k] = unit @ s
        matrix[rows, 3] = hand * np.array([1.0, 0.0, -FOOT])
        matrix[rows, 4 + k] = hand * np.array([1.0, 0.0, -PIN])
    return float(np.linalg.det(matrix))


@pytest.mark.parametrize(("spin", "mu"), [(1, 0.1), (-1, 0.45)])
def test_a_rigid_duo_servo_locks_where_its_floating_shoe_meets_the_anchor(
    spin: int, mu: float
) -> None:
    """Beyond, the drum wedges both shoes between strut and anchors: no friction has an answer."""
    brake = duo_servo(spin, mu, FULL)
    limits = [rigid.self_locking_friction_of_rigid_shoe(brake, shoe) for shoe in brake.shoes]
    assert limits == pytest.approx([limits[0]] * 2, rel=1e-12)
    below = drumlin.solve(vary(brake, {"friction": (1 - 1e-6) * limits[0]}), "rigid")
    assert math.isfinite(below.torque)
    arcs = [shoe.contact_arcs[0] for shoe in below.shoes]
    signs = [wedge_determinant_by_hand(spin, x * limits[0], arcs) for x in (0.9999, 1.0001)]
    assert signs[0] * signs[1] < 0
    for beyond in (1.0001, 1.5):
        locked = vary(brake, {"friction": beyond * limits[0]})
        with pytest.raises(NoAnswer, match=r"self-locking, friction .* is not below mu_lock = "):
            drumlin.solve(locked, "rigid")


def test_a_block_between_two_anchors_locks_alike_in_both_senses() -> None:
    """The anchors lie on one line across the free motion of the block: neither opens nor closes."""
    for mu in (0.3, 1.0):
        one, other = (
            rigid.self_locking_friction_of_rigid_shoe(brake, brake.shoes[0])
            for brake in (shoe_between_anchors(spin, mu) for spin in SENSES)
        )
        assert one == pytest.approx(other, rel=3e-4)
        assert one == pytest.approx(1.65894, rel=3e-4)
    torques = [drumlin.solve(shoe_between_anchors(spin, 0.8), "rigid").torque for spin in SENSES]
    assert torques[0] == pytest.approx(torques[1], rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("spin", SENSES)
def test_elements_on_soft_contact_are_the_closed_form(spin: int) -> None:
    """With a contact far softer than the bodies the shoes are rigid: the error falls with it."""
    torque, strut, anchor = duo_servo_by_hand(spin, 0.2, 0.8)
    brake = duo_servo(spin, 0.2, FULL)
    soft = drumlin.solve(brake, penalty=1e-10, model_error=False)
    assert soft.torque == pytest.approx(torque, rel=1e-9)
    found = forces(soft)
    bears = "right" if spin > 0 else "left"
    assert found[f"anchor of {bears!r}"] == pytest.approx(anchor, rel=1e-9)
    assert found["the strut from 'right' to 'left'"] == pytest.approx(strut, rel=1e-9)
    assert max(soft.balance.force, soft.balance.moment) < 1e-9


def test_an_elastic_duo_servo_boosts_both_ways_and_its_mirror_image_is_alike() -> None:
    one, other = (solve(duo_servo(s, half=(0.7, 0.7)), elements=16) for s in SENSES)
    assert one.torque == pytest.approx(other.torque, rel=1e-9)
    assert forces(one)["anchor of 'right'"] == pytest.approx(
        forces(other)["anchor of 'left'"], rel=1e-9
    )
    assert forces(one)["anchor of 'left'"] == forces(other)["anchor of 'right'"] == 0.0
    for response in (one, other):
        assert min(forces(response).values()) >= 0.0
        assert max(response.balance.force, response.balance.moment) < 1e-9
        anchors = sum(f for name, f in forces(response).items() if name.startswith("anchor"))
        assert anchors * PIN == pytest.approx(response.torque, rel=1e-8)


def test_neither_the_order_of_shoes_nor_the_size_matters() -> None:
    """All lengths times ten and forces times a hundred leave the stresses as they are."""
    brakes = [
        duo_servo(half=(0.6, 0.7), order=order, scale=scale)
        for order, scale in ((1, 1.0), (-1, 1.0), (1, 10.0))
    ]
    for model, options in (("rigid", {}), ("fem", {"elements": 12})):
        a, b, c = (MODELS[model].solve(brake, **options) for brake in brakes)
        assert b.torque == pytest.approx(a.torque, rel=1e-9)
        assert c.torque == pytest.approx(1e3 * a.torque, rel=1e-9)


@pytest.mark.parametrize("spin", SENSES)
@pytest.mark.parametrize("clearance", (0.0, 1e-4))
def test_a_shoe_rests_on_the_anchor_towards_which_it_is_dragged(
    spin: int, clearance: float
) -> None:
    """The drag is mu N b r, the anchor's force its moment over the arm 0.12 m, without a pull."""
    brake = shoe_between_anchors(spin, clearance=clearance)
    for model in ("rigid", "fem"):
        options = {"elements": 16} if model == "fem" else {}
        response = drumlin.solve(brake, model, **options)
        first, second = (s.push.force for s in response.shoes[0].supports)
        bears, left = (second, first) if spin > 0 else (first, second)
        assert left == 0.0
        assert bears == pytest.approx(response.torque / 0.12, rel=1e-8)
    # The clearance is closed by a motion of the shoe along the anchor's direction.
    (_, dy, turn) = response.shoes[0].motion
    assert bool(abs(dy) + abs(0.1 * turn) > 1e-5) == bool(clearance)


def test_a_shoe_on_one_anchor_is_a_shoe_on_an_abutment() -> None:
    plain = vary(
        shoe_between_anchors(-1),
        {"shoe.anchor": (), "shoe.abutment": {"point": {"x": 0.12, "y": -0.1}, "direction": 1.2}},
    )
    anchor = {"point": {"x": 0.12, "y": -0.1}, "direction": 1.2}
    anchored = vary(plain, {"shoe.abutment": None, "shoe.anchor": [anchor]})
    for model, options in (("rigid", {}), ("fem", {"elements": 16})):
        a, b = (drumlin.solve(brake, model, **options) for brake in (plain, anchored))
        assert b.torque == pytest.approx(a.torque, rel=1e-9)
        assert b.shoes[0].hinge_reaction == pytest.approx(a.shoes[0].hinge_reaction, rel=1e-8)


def test_a_shoe_that_no_support_holds_is_refused() -> None:
    """The abutment of the shoe would have to pull where the drum turns the other way."""
    brake = shoe_between_anchors(1)
    brake = vary(brake, {"shoe.anchor": brake.shoes[0].anchors[:1]})
    for model in ("rigid", "fem"):
        options = {"elements": 12} if model == "fem" else {}
        with pytest.raises(NoAnswer, match="on no choice of its one-sided supports do pushes"):
            drumlin.solve(brake, model, **options)


def duo_servo_with_clearances(
    spin: int, mu: float, half: tuple[float, float], right: float, left: float, order: int = 1
) -> Brake:
    """A duo-servo brake whose anchors have clearances [m] to the right and to the left shoe."""
    clearances = {"shoe.right.anchor[0].clearance": right, "shoe.left.anchor[0].clearance": left}
    return vary(duo_servo(spin, mu, half, order=order), clearances)


FLOATING_DUO_SERVO = duo_servo_with_clearances(1, 0.228, (0.503, 0.631), 2e-5, 1.5e-4)


@pytest.mark.parametrize(
    ("brake", "elements", "steps"),
    [
        (duo_servo_with_clearances(1, 0.078, (0.913, 0.582), 0.0, 5e-5, -1), 9, 1),
        (duo_servo_with_clearances(-1, 0.2, (0.73, 0.8), 1.5e-4, 1.5e-4), 8, 2),
        (FLOATING_DUO_SERVO, 10, 13),
    ],
)
def test_shoes_that_float_at_rest_hold_with_the_torque_of_solve(
    brake: Brake, elements: int, steps: int
) -> None:
    """At rest only friction keeps the shoes from turning about the drum's centre.

    Cylinder and strut push both shoes alike, so that no anchor bears and the moment is zero.
    """
    states = drumlin.hold(brake, elements=elements, steps=steps).states
    torque = drumlin.solve(brake, elements=elements).torque
    assert states[-1].torque == pytest.approx(torque, rel=1e-7)
    assert states[-1].sticking == 0
    assert states[0].torque == pytest.approx(0.0, abs=1e-9 * torque)
    assert states[0].sticking > 0


@pytest.mark.parametrize("clearance", (0.0, 1e-4))
def test_a_rigid_duo_servo_holds_as_it_slides(clearance: float) -> None:
    brake = duo_servo_with_clearances(1, 0.1, FULL, clearance, clearance)
    rigid_limit = {"penalty": 1e-10, "elements": 6}
    expected = drumlin.solve(brake, model_error=False, **rigid_limit).torque
    for steps in (1, 3):
        end = drumlin.hold(brake, steps=steps, **rigid_limit).states[-1]
        assert end.torque == pytest.approx(expected, rel=1e-9)


def test_a_path_of_solutions_ends_in_a_solution_or_is_refused(monkeypatch) -> None:
    """One path led to a shoe inside its anchor, or to a slip against the friction."""
    ends = []
    follow = stick_slip._follow_stick_slip_states_to_true_load

    def refuse(*_):
        raise NoAnswer("not converged")

    def follow_and_keep_violations(system, state, *, from_wide_gaps):
        ends.append(None)
        end = follow(system, state, from_wide_gaps=from_wide_gaps)
        _, violated = stick_slip._solution_and_violated_conditions(system, end.state)
        ends[-1] = int(np.count_nonzero(violated))
        return end

    for method in ("newton", "lowering_friction", "slowed_newton"):
        monkeypatch.setattr(stick_slip, f"_find_stick_slip_states_by_{method}", refuse)
    monkeypatch.setattr(
        stick_slip, "_follow_stick_slip_states_to_true_load", follow_and_keep_violations
    )
    brake = duo_servo_with_clearances(1, 0.12, (0.693, 0.51), 5e-5, 0.0)
    with pytest.raises(NoAnswer, match="the drum at rest"):
        drumlin.hold(brake, elements=8, steps=1)
    assert ends
    assert set(ends) <= {None, 0}


def test_most_states_up_to_the_default_rotation_lie_before_full_slip() -> None:
    """The moment does not grow before the drum has carried the shoes to the anchor.

    The extrapolation of the moment went to 11 times the rotation to full slip.
    """
    brake = duo_servo_with_clearances(-1, 0.2, (0.73, 0.8), 1.5e-4, 1.5e-4)
    states = drumlin.hold(brake, elements=8, steps=10).states
    sticking = [at.sticking > 0 for at in states]
    assert sticking[-1] is False
    assert sticking[:8] == [True] * 8


@pytest.mark.parametrize("increments", (5, 10))
def test_friction_holds_a_shoe_at_rest_between_its_anchors(increments: int) -> None:
    """The load of 1 kN at 30 mm turns the shoe by 30 N m, less than friction can hold.

    The moment stays that of the load until the drum has carried the shoe by the clearance.
    """
    clearance = 3e-4
    brake = vary(
        shoe_between_anchors(1, clearance=clearance),
        {"shoe.actuation.point": {"x": 0.1, "y": 0.03}},
    )
    scene = prepared_model_for_hold_wear_or_sensitivity(brake, "fem", elements=16)
    rotations = np.linspace(0, 0.7 * clearance / R, increments)
    states = holding.turn_holding_brake_and_return_states_at_rotations(scene, brake, rotations)
    assert [at.torque for at in states] == pytest.approx([30.0] * increments, rel=1e-6)


@pytest.mark.slow
@pytest.mark.filterwarnings("error")
def test_the_default_rotation_closes_the_clearance_of_an_anchor() -> None:
    """With the load of the test above, the search took a shoe at its anchor for the one at rest."""
    brake = vary(
        shoe_between_anchors(1, clearance=5e-4),
        {"shoe.actuation.point": {"x": 0.1, "y": 0.03}},
    )
    end = drumlin.hold(brake, elements=16, steps=2).states[-1]
    assert end.rotation > 5e-4 / R
    assert end.sticking == 0
    assert end.torque == pytest.approx(drumlin.solve(brake, elements=16).torque, rel=1e-7)


def test_a_hold_searches_full_slip_from_the_rest_of_its_states(monkeypatch) -> None:
    """A shoe that slides to its anchor at rest sticks there as the load increments have it.

    The force therefore grows in the search in as many increments as before the states.
    """
    counts = []
    increase = holding._increase_actuation_force_at_rest

    def count_increments(*arguments):
        counts.append(arguments[-1])
        return increase(*arguments)

    monkeypatch.setattr(holding, "_increase_actuation_force_at_rest", count_increments)
    end = drumlin.hold(shoe_between_anchors(1, clearance=1e-4), elements=8, steps=4).states[-1]
    assert counts == [5, 5]
    assert end.sticking == 0


@pytest.mark.slow
def test_a_holding_duo_servo_reverses_through_its_anchor() -> None:
    """Turned to full slip and back, it holds with the torque of each sliding sense."""
    brake = duo_servo(half=(0.6, 0.7))
    scene = prepared_model_for_hold_wear_or_sensitivity(brake, "fem", elements=16)
    full = holding.find_drum_rotation_of_full_slip(scene, brake)
    back = holding.find_drum_rotation_of_full_slip(scene, brake.brake_with_reversed_motion())
    rotations = np.concatenate([np.linspace(0, full, 5), np.linspace(full, -full - 4 * back, 12)])
    states = holding.turn_holding_brake_and_return_states_at_rotations(scene, brake, rotations)
    forwards = drumlin.solve(brake, elements=16).torque
    backwards = drumlin.solve(brake.brake_with_reversed_motion(), elements=16).torque
    assert abs(forwards / backwards - 1) > 1e-5
    # At rest the pair floats: without an anchor's force the drum has no torque.
    assert abs(states[0].torque) < 1e-9 * forwards
    assert states[4].torque == pytest.approx(forwards, rel=1e-8)
    assert states[-1].torque == pytest.approx(-backwards, rel=1e-8)


@pytest.mark.parametrize(
    ("changes", "line"),
    (
        (
            {"shoe.right.hinge": {"x": 0.0, "y": 0.1}},
            "anchor: a shoe on anchors can leave them, hinge holds it both ways",
        ),
        (
            {"shoe.right.abutment": {"point": {"x": 0.02, "y": -0.1}, "direction": 0.3}},
            "a strut pushes the feet of both shoes apart along one line",
        ),
        (
            {"shoe.right.anchor": ()},
            "a strut between shoes on anchors bears on an abutment of each",
        ),
        ({"actuation": {"force": 1.0}}, "takes a force of its own or of a cylinder"),
        (
            {
                "shoe.right.abutment": {
                    "point": {"x": 0.025, "y": FOOT},
                    "direction": 0.0,
                    "friction": 0.2,
                }
            },
            "abutment.friction = 0.2: a shoe with anchors takes abutments without friction",
        ),
    ),
)
def test_what_does_not_fit_anchors_is_named(changes, line) -> None:
    data = duo_servo().model_dump(by_alias=True)
    for key, value in changes.items():
        if key == "actuation":
            data[key] = value
        else:
            data["shoe"][0][key.split(".")[-1]] = value
    with pytest.raises(BadInput, match=line):
        make_drum_brake_from_data(data)


def test_a_brake_file_with_anchors_is_written_and_read_again(tmp_path) -> None:
    brake = duo_servo()
    path = tmp_path / "duo.toml"
    drumlin.write_brake(brake, path)
    assert drumlin.read_brake(path).model_dump() == brake.model_dump()


@pytest.mark.slow
def test_a_worn_in_duo_servo_is_its_law() -> None:
    """Rigid shoes under steady wear press as rigid shoes on springs do."""
    brake = duo_servo(1, 0.2, FULL)
    worn = drumlin.solve(brake, worn_in=True, elements=40)
    law = drumlin.solve(brake, "rigid")
    assert worn.torque == pytest.approx(law.torque, rel=1e-3)
    assert abs(solve(brake, elements=40).torque / law.torque - 1) > 0.02


@pytest.mark.slow
@pytest.mark.parametrize("rotation", ["clockwise", "counter-clockwise"])
def test_the_limit_of_a_duo_servo_is_where_solves_end_and_takes_few_searches(rotation, monkeypatch):
    """While the present supports bear, one contact solve a step follows the friction."""
    searches = []
    search = ShoeGroup._solve_contact_with_confirmed_abutment_friction

    def counted(group, first=None):
        searches.append(group.brake.friction)
        return search(group, first)

    brake = vary(drumlin.example("duo_servo"), {"rotation": rotation})
    monkeypatch.setattr(ShoeGroup, "_solve_contact_with_confirmed_abutment_friction", counted)
    scene = make_prepared_model(brake, elements=4)
    (limit,) = self_locking_friction_of_shoe_groups(scene, brake).values()
    # The friction grows by 60 steps, and 20 more steps halve the last one.
    assert len(searches) < 10
    below, above = limit.friction * (1 - 1e-6), limit.friction * (1 + 1e-6)
    assert shoe_torques_at_friction_coefficients(scene, brake, [below]).sum() > 0
    with pytest.raises(NoAnswer):
        shoe_torques_at_friction_coefficients(scene, brake, [above])


def test_a_shoe_wedged_between_two_anchors_is_told_from_one_that_nothing_holds() -> None:
    """The force bends the shoe, so that it presses on both anchors at once."""
    body = {"thickness": 0.025, "width": 0.012, "start": -0.8, "end": 0.8, "material": STEEL}
    brake = vary(shoe_between_anchors(-1), {"shoe.body": body})
    wedged = r"wedged between anchor 1 of 'block' and anchor 2 of 'block': give one of them a clear"
    with pytest.raises(NoAnswer, match=wedged):
        solve(brake, elements=8)
    freed = vary(brake, {"shoe.anchor[1].clearance": 1e-4})
    held = forces(solve(freed, elements=8))
    assert held["anchor 1 of 'block'"] > 0 == held["anchor 2 of 'block'"]


def test_the_law_names_the_clearance_of_anchors_among_the_keys_that_it_does_not_use() -> None:
    for clearance in (0.0, 1e-4):
        left_out = drumlin.solve(shoe_between_anchors(clearance=clearance), "rigid").left_out
        assert any("shoe.anchor.clearance" in line for line in left_out) == bool(clearance)


@pytest.mark.filterwarnings("error")
def test_holding_on_anchors_with_clearances_warns_of_no_division() -> None:
    changes = {f"shoe[{i}].anchor[0].clearance": 1.5e-4 for i in range(2)}
    brake = vary(duo_servo(-1, 0.2, FULL), changes | {"shoe.lining.clearance": 1.8e-4})
    assert drumlin.hold(brake, elements=6, steps=2).states[-1].torque == pytest.approx(
        drumlin.solve(brake, elements=6, model_error=False).torque, rel=1e-8
    )
