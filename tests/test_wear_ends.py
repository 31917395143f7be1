"""Where wear begins and ends: feet on rough abutments, laws that press a part of a lining."""

import math

import numpy as np
import pytest

import drumlin
from conftest import ROOT, partly
from drumlin.brake.brake import Brake
from drumlin.brake.file import read_brake, vary
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import prepared_model_with_finest_elements
from drumlin.laws import solve_brake_by_its_rigid_shoe_law
from drumlin.lining_wear.archard import (
    WearLaw,
    solve_steady_wear,
    wear_linings_in_given_steps,
    wear_linings_over_sliding_distance,
)
from drumlin.lining_wear.linings import wear_setup_by_finite_elements
from drumlin.lining_wear.run_in import (
    DEFAULT_WEAR_COEFFICIENT,
    brake_with_worn_linings,
    final_pressure_and_torque_of_wear_on_mesh,
    final_wear_pressure_and_torque_by_rigid_shoe_law,
    relative_differences_from_end_of_wear,
    report_lines_of_wear_run,
    wear_brake_linings_until_worn_in,
)
from drumlin.lining_wear.worn_in import brake_with_worn_in_clearances
from drumlin_studies import consistency_wear
from drumlin_studies.random_kinds import draw_random_brake_of_support_kind
from picking import picked, saying
from winkler_lining import FORCE, LAW, MU, PIN, RADIUS, UNIT, WIDTH, winkler

ARCHARD = WearLaw(DEFAULT_WEAR_COEFFICIENT)


def drawn(kind: str, seed: int) -> Brake:
    return draw_random_brake_of_support_kind(seed, kind)


@pytest.mark.parametrize(("bend", "middle"), partly([(0.1, 0.7), (0.01, 0.31)], [(0.1, 0.7)]))
def test_steps_are_not_blind_where_one_node_presses(bend: float, middle: float) -> None:
    """200 equal steps are right whatever their error; steps by their error were 4 and 16 % off.

    Where one node presses, equilibrium fixes its pressure, and no wear of the node changes it.
    """
    interface, _ = winkler(lambda phi: bend * (phi - middle) ** 2, elements=6)
    states = wear_linings_over_sliding_distance([interface], LAW, distance=100 * UNIT)
    assert int((states[0].pressure > 0).sum()) <= 2
    for state in states[1 :: len(states) // 5]:
        equal = wear_linings_in_given_steps([interface], LAW, state.s * np.arange(1, 201) / 200)[-1]
        assert state.torque == pytest.approx(equal.torque, rel=1e-3)


@pytest.mark.parametrize(("exponent", "within"), [(1.0, 1e-4), (0.6, 1e-4), (2.0, 2e-3)])
def test_wear_ends_at_the_law_where_that_presses_a_part_only(
    exponent: float, within: float
) -> None:
    """About a hinge p ~ sin(phi)^(1/m), and nothing on a lining's part beyond phi = 0."""
    interface, phi = winkler(
        lambda phi: 1e-6 * (1 + np.cos(3 * phi)), elements=24, arc=(-0.61, 2.0)
    )
    wears = WearLaw(LAW.coefficient, exponent, 2e5)
    found = solve_steady_wear(interface, wears).contact
    # the law's moments of pressure and friction about the hinge, by quadrature
    x = np.linspace(0, 2.0, 4001)
    shape = np.sin(x) ** (1 / exponent)
    pressed = WIDTH * RADIUS * np.trapezoid(shape * PIN * np.sin(x), x)
    dragged = WIDTH * RADIUS * np.trapezoid(shape * (RADIUS - PIN * np.cos(x)), x)
    torque = MU * WIDTH * RADIUS**2 * np.trapezoid(shape, x) * FORCE / (pressed + MU * dragged)
    assert float(interface.torque @ found.p) == pytest.approx(torque, rel=within)
    assert (found.p[phi < -0.05] == 0).all()
    # The lifted part must move away from the drum.
    assert (found.w[phi < -0.05] > 0).all()
    last = wear_linings_over_sliding_distance([interface], wears, distance=1e5 * UNIT)[-1]
    assert last.torque == pytest.approx(torque, rel=within)
    assert np.linalg.norm(last.pressure - found.p) < 1e-3 * np.linalg.norm(found.p)


LAWS_OF_HINGED_SHOES_BY_NAME = [
    ("table", 30042, 101.0048),
    ("cam", 30381, 1374.9285),
    ("abutment", 60016, 2171.6646),
]


@pytest.mark.parametrize("elements", [20, 40])
@pytest.mark.parametrize(
    ("kind", "seed", "torque"),
    partly(LAWS_OF_HINGED_SHOES_BY_NAME, LAWS_OF_HINGED_SHOES_BY_NAME[:1]),
)
def test_worn_in_linings_bear_by_the_law_where_it_presses_a_part(
    kind: str, seed: int, torque: float, elements: int
) -> None:
    """Off by 1.4, 3.9 and 0.04 % as long as the amount of the shoe's motion could be negative."""
    brake = drawn(kind, seed)
    by_law, found = (
        solve_brake_by_its_rigid_shoe_law(brake),
        drumlin.solve(brake, worn_in=True, elements=elements),
    )
    assert by_law.torque == pytest.approx(torque, rel=1e-6)
    assert any(
        shoe.contact_arcs[0][1] - shoe.contact_arcs[0][0] < 0.99 * (b.lining.end - b.lining.start)
        for shoe, b in zip(by_law.shoes, brake.shoes, strict=True)
    )
    assert found.torque == pytest.approx(torque, rel=3e-4)
    for a, b in zip(found.shoes, by_law.shoes, strict=True):
        inner = np.linspace(b.theta[0], b.theta[-1], 201)[20:-20]
        p, q = a.pressure_at(inner), b.pressure_at(inner)
        assert np.linalg.norm(p - q) < 0.01 * np.linalg.norm(q)


@pytest.mark.parametrize(
    ("kind", "seed"),
    partly(
        [("table", 30042), ("cam", 30381), ("abutment", 60016), ("pad on an abutment", 60318)],
        [("table", 30042)],
    ),
)
def test_worn_in_unloaded_linings_do_not_lie_in_the_drum(kind: str, seed: int) -> None:
    brake = drawn(kind, seed)
    shoes = brake_with_worn_in_clearances(make_prepared_model(brake, elements=20), brake).shoes
    gaps = [np.array(shoe.lining.clearance)[:, 1] for shoe in shoes]  # type: ignore[union-attr]
    assert min(gap.min() for gap in gaps) >= -1e-12 * brake.size


@pytest.mark.parametrize("elements", [10, 20])
def test_wear_begins_where_the_feet_slide_as_they_do(elements: int) -> None:
    """With the friction of the rigid shoe's feet it began at 265.15 N m; 262.42 N m is right."""
    brake = read_brake(ROOT / "studies" / "brakes" / "simplex_abutted.toml")
    scene = make_prepared_model(brake, elements=elements)
    (first,) = wear_linings_in_given_steps(
        wear_setup_by_finite_elements(scene, brake).interfaces, ARCHARD, []
    )
    assert first.torque == pytest.approx(solve_prepared_model(scene, brake).torque, rel=1e-7)
    assert first.torque == pytest.approx(262.42, rel=1e-3)


@pytest.mark.slow
def test_wear_begins_where_only_a_soft_lining_shows_the_contact() -> None:
    """`solve` begins each level with the contact of the one before; here there is none before."""
    brake = drawn("cam", 30564)
    (first,) = wear_linings_in_given_steps(
        wear_setup_by_finite_elements(prepared_model_with_finest_elements(brake), brake).interfaces,
        ARCHARD,
        [],
    )
    by_meshes = [drumlin.solve(brake, elements=40).torque, drumlin.solve(brake, elements=80).torque]
    assert first.torque == pytest.approx(by_meshes[1], rel=2e-5)
    assert by_meshes[0] == pytest.approx(by_meshes[1], rel=2e-5)


@pytest.mark.slow
def test_wear_begins_where_the_answer_is_followed_from_no_friction() -> None:
    """From all nodes no contact set is found; 20, 40, 80 elements and the levels agree."""
    brake = drawn("strut", 60412)
    (first,) = wear_linings_in_given_steps(
        wear_setup_by_finite_elements(make_prepared_model(brake, elements=40), brake).interfaces,
        ARCHARD,
        [],
    )
    assert first.torque == pytest.approx(2820.99, rel=1e-4)
    (first,) = wear_linings_in_given_steps(
        wear_setup_by_finite_elements(prepared_model_with_finest_elements(brake), brake).interfaces,
        ARCHARD,
        [],
    )
    assert first.torque == pytest.approx(2820.99, rel=1e-5)


@pytest.mark.parametrize(
    ("kind", "seed"), partly([("abutment", 60016), ("cylinder", 60035)], [("abutment", 60016)])
)
def test_wear_without_a_distance_ends_where_its_mesh_ends_and_says_how_far_that_is_from_the_law(
    kind: str, seed: int
) -> None:
    brake = drawn(kind, seed)
    setup = wear_setup_by_finite_elements(make_prepared_model(brake, elements=20), brake)
    states, goal, own = (
        wear_brake_linings_until_worn_in(setup),
        final_wear_pressure_and_torque_by_rigid_shoe_law(setup),
        final_pressure_and_torque_of_wear_on_mesh(setup),
    )
    assert math.isfinite(states[-1].s) and len(states) < 200
    assert max(map(abs, relative_differences_from_end_of_wear(setup, states[-1], own))) <= 1e-3
    assert 1e-3 < relative_differences_from_end_of_wear(setup, states[-1], goal).pressure < 1e-2
    assert states[-1].torque == pytest.approx(
        solve_brake_by_its_rigid_shoe_law(brake).torque, rel=1e-3
    )
    assert goal.torque == pytest.approx(solve_brake_by_its_rigid_shoe_law(brake).torque, rel=1e-9)
    (line,) = saying(report_lines_of_wear_run(setup, states, goal, ARCHARD), "on this mesh")
    assert "more elements come nearer" in line


@pytest.mark.slow
def test_feet_slide_otherwise_as_the_linings_wear_and_each_state_is_an_answer() -> None:
    """Each worn brake, solved as any other, finds the friction at its feet by itself."""
    brake = drawn("rough abutment", 60177)
    scene = make_prepared_model(brake, elements=10)
    setup = wear_setup_by_finite_elements(scene, brake)
    states = wear_brake_linings_until_worn_in(setup)
    (interface,) = setup.interfaces
    assert interface.settle is not None
    footings = [interface.settle(state.depth)[0] for state in states[::10]]
    assert len(set(footings)) > 1
    for state in states[::20]:
        assert state.torque == pytest.approx(
            solve_prepared_model(scene, brake_with_worn_linings(setup, state)).torque, rel=1e-7
        )


def test_a_held_torque_finds_the_feet_too() -> None:
    """The force at a held torque is that under which the worn brake has this torque."""
    brake = read_brake(ROOT / "studies" / "brakes" / "simplex_abutted.toml")
    scene = make_prepared_model(brake, elements=10)
    setup = wear_setup_by_finite_elements(scene, brake)
    states = wear_brake_linings_until_worn_in(setup, torque=200.0, distance=1e5)
    for state in states[:: len(states) // 2]:
        force = {
            f"shoe[{i}].actuation.force": state.force * shoe.actuation.force
            for i, shoe in enumerate(brake.shoes)
        }
        alone = vary(brake.model_copy(update={"actuation": None}), force)
        loaded = brake_with_worn_linings(setup._replace(brake=alone), state)
        assert solve_prepared_model(scene, loaded).torque == pytest.approx(200.0, rel=1e-7)


@pytest.mark.parametrize("seed", partly([17, 28], [28]))
def test_beginning_middle_and_end_agree_on_random_brakes(seed: int) -> None:
    rows = consistency_wear.rows_of_wear_checks_of_random_brake(seed)
    assert set(picked(rows, "outcome")) <= {"agrees", "refused"}
    assert set(picked(rows, "check")) >= {
        "wear's start = solve",
        "wear's end = worn in",
        "worn in = law",
    }


@pytest.mark.slow
@pytest.mark.parametrize(
    "seed", range(100, 100 + len(consistency_wear.KINDS_OF_RANDOM_BRAKES_FOR_WEAR_CHECK))
)
def test_beginning_middle_and_end_agree_on_brakes_of_every_kind(seed: int) -> None:
    assert set(picked(consistency_wear.rows_of_wear_checks_of_random_brake(seed), "outcome")) <= {
        "agrees",
        "refused",
    }
