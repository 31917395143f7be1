"""Self-locking with springs, with friction over the pressure, and at the corner of a lining."""

import math
from pathlib import Path

import numpy as np
import pytest

import drumlin
from drumlin.base.errors import AnswerBeyondModel, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.fem.analysis.self_locking import (
    FRICTION_AT_WHICH_RIGHT_ANGLED_CORNER_LOCKS,
    _limit_by_repeated_solves,
    _limit_by_repeated_solves_of_brake,
    self_locking_friction_of_shoe_groups,
)
from drumlin.fem.equilibrium.group import ShoeGroup, divide_pressed_shoes_into_groups
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.response.self_locking import LockedShoesAndLockingFriction, SelfLockingFactor

BRAKES = Path(__file__).parents[1] / "studies" / "brakes"
ELEMENTS = 8


def with_spring(rate: float) -> Brake:
    """The double-shoe brake with a spring at the tip of the left shoe; `rate` is in N/m."""
    spring = {
        "shoe": "left",
        "point": {"x": -0.058, "y": 0.1},
        "end": {"x": 0.0, "y": 0.1},
        "preload": 100.0,
    }
    return vary(drumlin.example("double_shoe"), {"spring": [spring | {"rate": rate}]})


def over_pressure(brake: Brake, share: float) -> Brake:
    """A brake whose friction falls to a share of its coefficient from 0 to 2 MPa."""
    table = {"pressure": [0.0, 2e6], "mu": [brake.friction, share * brake.friction]}
    return vary(brake, {"friction": table})


def limits(brake: Brake, most: float = 3.0) -> list[float]:
    """The self-locking friction of each group, on a coarse mesh."""
    return [found.friction for found in drumlin.self_locking(brake, elements=ELEMENTS, most=most)]


def test_a_soft_spring_changes_no_limit_and_a_stiff_one_raises_it():
    (plain,) = (limit for limit in limits(drumlin.example("double_shoe")) if math.isfinite(limit))
    (soft,), (stiff,) = limits(with_spring(1.0)), limits(with_spring(1e7))
    assert soft == pytest.approx(plain, rel=1e-6)
    assert stiff > 1.05 * plain


def test_repeated_solves_end_just_below_the_limit_with_springs_as_nodes():
    """The solver of a brake ends where the shoe would lock under the last pull of its spring."""
    brake = with_spring(1e4)
    scene = make_prepared_model(brake, elements=ELEMENTS)
    repeated = _limit_by_repeated_solves_of_brake(scene, brake, 3.0, math.inf)
    (exact,) = self_locking_friction_of_shoe_groups(scene, brake, 3.0).values()
    assert not exact.pressure_stays_finite
    assert 0.999 * exact.friction < repeated.friction < exact.friction


@pytest.mark.parametrize("name", ["uni_servo", "s_cam"])
def test_anchors_and_cams_lock_alike_with_a_number_and_a_table_that_is_nearly_constant(name):
    brake = drumlin.read_brake(BRAKES / f"{name}.toml")
    assert limits(over_pressure(brake, 1 - 1e-9)) == pytest.approx(limits(brake), rel=1e-5)


def test_a_cam_with_falling_friction_has_equilibria_up_to_its_limit_only():
    brake = over_pressure(drumlin.read_brake(BRAKES / "s_cam.toml"), 0.7)
    (limit,) = limits(brake)
    scale = limit / brake.friction
    below, above = (brake.brake_with_multiplied_friction(scale * by) for by in (0.9999, 1.0001))
    assert drumlin.solve(below, elements=ELEMENTS, model_error=False).torque > 0
    with pytest.raises(NoAnswer):
        drumlin.solve(above, elements=ELEMENTS, model_error=False)


def test_a_corner_of_the_lining_locks_at_half_of_pi_on_ever_finer_elements():
    """mu_lock - pi/2 falls as 1/log(1/h) with the size h of the elements at the corner."""
    brake = drumlin.read_brake(BRAKES / "crane.toml")
    inverse, sizes = [], []
    for level in REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[:3]:
        scene = make_prepared_model(brake, level)
        found = self_locking_friction_of_shoe_groups(scene, brake, 2.0)[(0,)]
        assert found.pressure_stays_finite
        least = found.least_friction_on_finer_elements
        assert least == FRICTION_AT_WHICH_RIGHT_ANGLED_CORNER_LOCKS == math.pi / 2
        inverse.append(1 / (found.friction - least))
        xy = scene.bodies[0].line.xy
        sizes.append(float(np.linalg.norm(xy[:, 1] - xy[:, 0])))
    growth = np.diff(inverse) / np.diff(np.log(1 / np.array(sizes)))
    assert np.ptp(growth) < 0.1 * growth.mean()


@pytest.mark.parametrize("end", [-0.06, 0.0])
def test_a_spring_without_preload_raises_the_limit_alike_on_either_side(end):
    """Compressed on one side or extended on the other side, it resists the shoe's motion."""
    spring = {"shoe": "left", "point": {"x": -0.032, "y": 0.121}, "end": {"x": end, "y": 0.121}}
    spring |= {"preload": 0.0, "rate": 2e6}
    brake = vary(drumlin.example("double_shoe"), {"spring": [spring]})
    (found,) = limits(brake)
    assert found == pytest.approx(limits(brake_with_spring_on_other_side(brake))[0], rel=1e-6)
    assert found > 1.01 * 1.181


def brake_with_spring_on_other_side(brake: Brake) -> Brake:
    """The brake with the fixed end of its spring on the other side of the spring's point."""
    (spring,) = brake.springs
    other = 2 * spring.point.x - spring.end.x
    return vary(brake, {"spring[0].end.x": other})


def test_the_friction_at_the_corner_decides_whether_it_locks():
    crane = drumlin.read_brake(BRAKES / "crane.toml")
    own = vary(crane, {"shoe.lining.friction": 2 * crane.friction})
    found = min(drumlin.self_locking(own, elements=ELEMENTS), key=lambda limit: limit.friction)
    assert found.bounded
    assert found.least_friction_on_finer_elements == pytest.approx(math.pi / 4)


@pytest.mark.parametrize("most", [0.0, -1.0, math.nan, math.inf])
def test_a_largest_friction_that_is_no_friction_is_refused(most):
    with pytest.raises(drumlin.BadInput, match=r"most = \S+: must be greater than 0 and finite"):
        drumlin.self_locking(drumlin.example("double_shoe"), most=most)


def test_a_brake_without_friction_has_no_limit():
    brake = vary(drumlin.example("double_shoe"), {"friction": 0.0})
    with pytest.raises(drumlin.BadInput, match="friction = 0: self-locking needs"):
        drumlin.self_locking(brake, elements=ELEMENTS)


def test_a_spring_that_goes_slack_is_not_taken_for_self_locking():
    pressures = {0.1: 1.0, 0.2: 1.0}

    def peak_pressure(friction: float) -> float:
        if friction > max(pressures):
            raise AnswerBeyondModel("spring[0]: goes slack")
        return 1.0

    with pytest.raises(NoAnswer, match=r"not known: above 0\.2, spring\[0\]: goes slack"):
        _limit_by_repeated_solves(peak_pressure, 3.0)


@pytest.mark.parametrize("limit", [0.003, 0.05, 0.0999, 0.7])
def test_a_short_shoe_on_a_lever_locks_at_its_closed_form_however_low(limit):
    """p = F a/(A (x - mu h)) has its pole at mu = x/h."""

    def peak_pressure(friction: float) -> float:
        if friction >= limit:
            raise NoAnswer("self-locking")
        return 1 / (limit - friction)

    found = _limit_by_repeated_solves(peak_pressure, 3.0)
    assert found.friction == pytest.approx(limit, rel=1e-6)
    assert not found.pressure_stays_finite


def test_a_limit_sought_up_to_little_friction_only_is_infinite_or_refused_for_its_cause():
    found = _limit_by_repeated_solves(lambda friction: 1.0, 9e-4)
    assert math.isinf(found.friction)

    def refuse(friction):
        raise NoAnswer("a spring goes slack")

    with pytest.raises(NoAnswer, match="a spring goes slack"):
        _limit_by_repeated_solves(refuse, 9e-4)


def test_a_shoe_that_needs_friction_is_followed_from_the_friction_that_it_needs():
    def peak_pressure(friction: float) -> float:
        if not 0.25 < friction < 0.7:
            raise NoAnswer("no equilibrium")
        return 1.0

    found = _limit_by_repeated_solves(peak_pressure, 3.0)
    assert found.friction == pytest.approx(0.7, rel=1e-5)
    assert found.pressure_stays_finite


@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.parametrize("name", ["duo_servo", "duo_servo_by_hand"])
def test_the_pressure_of_a_duo_servo_grows_without_bound_towards_its_limit(name, reverse):
    """A tenth of the distance from the pole makes the pressure ten times as large."""
    brake = vary(drumlin.example(name), {"actuation.pressure": 1e3})
    if reverse:
        brake = brake.brake_with_reversed_motion()
    (limit,) = drumlin.self_locking(brake, elements=ELEMENTS)
    assert not limit.bounded

    def peak_pressure(distance: float) -> float:
        factor = limit.friction * (1 - distance) / brake.friction
        found = drumlin.solve(
            brake.brake_with_multiplied_friction(factor), elements=ELEMENTS, model_error=False
        )
        return max(shoe.peak_pressure for shoe in found.shoes)

    assert peak_pressure(1e-5) == pytest.approx(10 * peak_pressure(1e-4), rel=0.15)


@pytest.mark.parametrize("clearance", [1e-5, 1e-4])
def test_a_pole_on_an_abutment_does_not_depend_on_the_clearance_and_the_turn(clearance):
    """The turn that closes the clearance grows with the pressure, and would end the search."""
    brake = drumlin.example("duplex")
    (plain, _) = limits(brake)
    apart = vary(brake, {"shoe.lining.clearance": clearance})
    for pressure in (1e3, 3e6):
        pushed = vary(apart, {"actuation.pressure": pressure})
        assert limits(pushed)[0] == pytest.approx(plain, rel=1e-6)


def test_an_equilibrium_that_ends_just_below_a_pole_ends_there():
    """On eight elements a support is left 7e-5 below the pole: there is no equilibrium between."""
    changes = {
        "actuation.pressure": 1e3,
        "shoe.lining.material": {"E": 179310424.0, "nu": 0.25},
        "shoe.body.thickness": 0.033,
        "shoe[0].actuation.point.y": 0.1,
        "shoe[1].actuation.point.y": 0.081,
        "shoe[0].lining.start": -0.407,
        "shoe[0].lining.end": 0.316,
        "shoe[1].lining.start": 2.507,
        "shoe[1].lining.end": 4.074,
    }
    brake = vary(drumlin.example("duo_servo"), changes)
    (limit,) = drumlin.self_locking(brake, elements=8)
    assert limit.bounded and limit.friction == pytest.approx(0.357057, rel=2e-6)
    below = brake.brake_with_multiplied_friction(limit.friction * (1 - 1e-6) / brake.friction)
    found = drumlin.solve(below, elements=8, model_error=False)
    assert max(shoe.peak_pressure for shoe in found.shoes) < 1e5


@pytest.mark.parametrize("degrees", [45.0, 40.0])
def test_the_contact_of_a_floating_shoe_shrinks_to_the_start_of_its_lining(degrees):
    """Cylinder and adjuster push the primary of a uni-servo brake along x.

    A pressure at the angle t and its friction balance along y if mu = tan(-t). The lining begins at
    the angle -`degrees`, so that mu_lock = tan(degrees). The contact there has the force of the
    cylinder by the moments about the adjuster.
    """
    start = -math.radians(degrees)
    brake = vary(
        drumlin.read_brake(BRAKES / "uni_servo.toml"), {"shoe.primary.lining.start": start}
    )
    (found,) = drumlin.self_locking(brake, elements=16)
    assert found.friction == pytest.approx(math.tan(-start), rel=1e-5)
    assert (found.bounded, found.pressed_at_point) == (False, ("primary",))
    assert found.least_friction_on_finer_elements == found.friction
    (group,) = divide_pressed_shoes_into_groups(make_prepared_model(brake, elements=16), brake)
    limit = group.find_friction_limit_by_following_contact(2.0).limit
    nodes = group.contact_node_slices_of_shoes[0]
    normal = float(limit.last_contact.p[nodes] @ group.contact_node_areas[nodes])
    primary = brake.shoes[0]
    foot = primary.abutment.point.y
    arm_of_contact = brake.size * math.sin(start) - foot
    along_x = (primary.actuation.point.y - foot) / arm_of_contact
    assert normal == pytest.approx(along_x * math.cos(start), rel=2e-3)


def test_a_pad_tips_about_its_edge():
    """The pad of the rail clamp is dragged at its face and held by a pivot above the face.

    The force on the face moves to the edge until mu = half the length/height of the pivot.
    """
    clamp = drumlin.read_brake(BRAKES / "rail_clamp.toml")
    brake = vary(clamp, {"shoe.pivot.y": 0.060})
    (found,) = drumlin.self_locking(brake, elements=ELEMENTS)
    assert found.friction == pytest.approx(0.075 / 0.060, rel=1e-5)
    assert (found.bounded, found.pressed_at_point) == (False, ("pad",))
    near = drumlin.solve(vary(brake, {"friction": 1.0}), elements=ELEMENTS, model_error=False)
    (warned,) = (note for note in near.notes if "for the elastic brake" in note)
    assert warned.endswith("torque is finite and the contact of shoe 'pad' shrinks to a point")


@pytest.mark.parametrize("friction", [0.7, 0.9, 1.0])
def test_a_limit_at_infinite_force_is_not_called_finite(friction):
    """The contact of the duplex brake gains a node just below the friction of infinite force."""
    brake = vary(drumlin.example("duplex"), {"friction": friction})
    answer = drumlin.solve(brake, model_error=False)
    assert not answer.self_locking.elastic.pressure_stays_finite
    limits = drumlin.self_locking(brake)
    assert not any(limit.bounded for limit in limits)
    assert answer.self_locking.elastic.friction == pytest.approx(limits[0].friction, rel=1e-9)


def test_a_limit_with_a_wide_clearance_and_a_small_force_holds_for_that_force():
    """With 1 mm at 1 kPa a few nodes press, and the path turns back; at 10 kPa more nodes press."""
    wide = vary(drumlin.example("duplex"), {"shoe.lining.clearance": 1e-3})
    small, large = (vary(wide, {"actuation.pressure": pressure}) for pressure in (1e3, 1e4))
    found, *_ = drumlin.self_locking(small, elements=48)
    finer, *_ = drumlin.self_locking(small, elements=96)
    under_more_force, *_ = drumlin.self_locking(large, elements=48)
    assert found.bounded and found.friction == pytest.approx(finer.friction, rel=2e-4)
    assert not under_more_force.bounded and under_more_force.friction < 0.996 * found.friction
    between = 0.5 * (found.friction + under_more_force.friction)
    answer = drumlin.solve(vary(small, {"friction": between}), elements=48, model_error=False)
    assert answer.torque > 0
    with pytest.raises(NoAnswer, match="self-locking, no equilibrium"):
        drumlin.solve(vary(large, {"friction": between}), elements=48, model_error=False)


@pytest.mark.parametrize(
    ("changes", "searches"),
    [
        ({}, 1),
        ({"shoe.left.lining.friction": 0.4}, 2),
        ({"shoe.left.abutment.friction": 0.1}, 2),
        ({"shoe.left.lining.material.E": 2e8}, 2),
    ],
)
def test_the_limit_of_equal_shoes_is_searched_once(changes, searches, monkeypatch):
    brake = vary(drumlin.example("duplex"), changes)
    search, groups = ShoeGroup.find_friction_limit_by_following_contact, []

    def noted(group, largest):
        groups.append(group.members)
        return search(group, largest)

    monkeypatch.setattr(ShoeGroup, "find_friction_limit_by_following_contact", noted)
    right, left = drumlin.self_locking(brake, elements=ELEMENTS)
    assert len(groups) == searches
    assert (right.shoes, left.shoes) == (("right",), ("left",))
    assert (right.friction == left.friction) == (searches == 1)


@pytest.mark.parametrize(
    ("finite", "end"),
    [
        (True, "at which the equilibrium ends while the torque is finite"),
        (False, "towards which the torque grows without bound"),
    ],
)
def test_the_warning_of_friction_over_pressure_says_how_the_equilibrium_ends(finite, end):
    limit = LockedShoesAndLockingFriction(("left",), 1.2, finite)
    (warned,) = SelfLockingFactor("friction", limit, 3.0).warnings()
    assert warned.endswith(f"locks at 1.2 times its friction (friction), {end}")
