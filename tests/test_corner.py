"""The pressure at a pressed corner and under a tip, by closed forms and a solved contact."""

import math
from itertools import islice, pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.special import betainc

from drumlin.brake.file import vary
from drumlin.fem.error_control.estimate import estimate_errors_from_two_mesh_levels
from drumlin.fem.error_control.levels import solve_brake_on_finer_and_finer_mesh_levels
from drumlin.fem.hp.corner import (
    POWER_LAW_FRACTION_OF_CONTACT,
    CornerWithUnboundedPressure,
    corners_with_unbounded_pressure,
    element_column_size_for_error_at_pointed_gap_kink,
    nodes_and_pressures_with_power_law_at_corner,
    polynomial_error_of_power_function,
    pressure_exponent_at_lining_corner,
    pressure_exponents_at_both_lining_corners,
    remaining_pressure_error_at_lining_corners,
    remaining_pressure_error_at_pointed_gap_kinks,
    response_with_power_laws_at_corners,
)
from drumlin.fem.hp.division import HALF_FORCE_FRACTION_OF_CONTACT
from drumlin.fem.model import solve_prepared_model
from drumlin.response.resultants import gauss_lobatto_points, polynomial_values_at_gauss_points
from drumlin_studies.stated_true import true_errors_of_response
from drumlin_studies.stored_truth import read_stored_fine_solution

TRUTHS = Path(__file__).parent / "truths"


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.49])
def test_without_friction_on_a_rigid_drum_the_pressure_is_bounded_by_symmetry(nu):
    assert pressure_exponent_at_lining_corner(0.0, nu) == 0.0


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.49])
def test_a_little_friction_makes_the_power_4_over_pi_of_it(nu):
    assert pressure_exponent_at_lining_corner(2e-3, nu) == pytest.approx(-8e-3 / math.pi, rel=1e-2)


def test_a_square_block_on_a_half_plane_of_its_own_material_has_the_power_of_dundurs_and_lee():
    assert pressure_exponent_at_lining_corner(0.0, 0.3, 1.0, 0.3) == pytest.approx(-0.226, abs=5e-4)


def test_friction_towards_the_corner_bounds_the_pressure_and_away_from_it_makes_it_steeper():
    assert pressure_exponent_at_lining_corner(-0.3, 0.2) == 0.0
    powers = [pressure_exponent_at_lining_corner(f, 0.2) for f in (0.0, 0.1, 0.2, 0.4, 0.6)]
    for a, b in pairwise(powers):
        assert a > b > -1


@pytest.mark.parametrize(("power", "degree"), [(-0.2, 0), (-0.2, 5), (-0.35, 7), (0.5, 4)])
def test_what_a_polynomial_leaves_of_a_power_is_its_distance_by_gauss_and_jacobi(power, degree):
    """The distance of x^a from its best polynomial agrees with that by Legendre coefficients."""
    coefficients = [
        math.gamma(power + 1) ** 2 / (math.gamma(power + n + 2) * math.gamma(power - n + 1))
        for n in range(degree + 1)
    ]
    inside = sum((2 * n + 1) * c**2 for n, c in enumerate(coefficients))
    assert polynomial_error_of_power_function(power, degree) == pytest.approx(
        math.sqrt(1 - inside * (2 * power + 1)), rel=1e-6
    )


def test_columns_at_a_tip_leave_the_error_that_they_are_made_for():
    """Columns of elements graded to a tip approximate ln x with the error for which they are made.

    A least-squares fit on many points, on both sides of the tip, gives the error.
    """
    degree, error, length = 4, 1e-2, 3.0
    size = element_column_size_for_error_at_pointed_gap_kink(length, degree, error)
    x, weight = np.polynomial.legendre.leggauss(400)
    x, weight = 0.5 + 0.5 * x, 0.5 * weight
    basis = np.polynomial.legendre.legvander(2 * x - 1, degree) * np.sqrt(weight)[:, None]
    target = np.log(x) * np.sqrt(weight)
    left = np.linalg.norm(target - basis @ np.linalg.lstsq(basis, target, rcond=None)[0])
    assert math.sqrt(2 * size) * left == pytest.approx(error * math.sqrt(length), rel=1e-3)


def test_a_solved_contact_has_the_power_of_its_corner_over_decades():
    """A solved contact has the closed-form power of its corner over two decades.

    The elements there have polynomials as shape functions, without a special function for the
    power. Slopes of log p are taken between 0.0003 and 0.01 of the contact, where neither the
    elements at the corner nor the rest of the lining matter.
    """
    stored = read_stored_fine_solution(TRUTHS / "corner_dragged_inwards.json")
    *_, last = islice(
        solve_brake_on_finer_and_finer_mesh_levels(stored.brake, solve_prepared_model), 5
    )
    (found,) = last.response.shoes
    ((at_start, power),) = corners_with_unbounded_pressure(stored.brake, 0, found)
    assert (
        power == pytest.approx(min(pressure_exponents_at_both_lining_corners(stored.brake, 0)))
        and power < -0.2
    )
    x = found.theta - found.theta[0] if at_start else found.theta[-1] - found.theta
    length = np.diff(found.contact_arcs).sum()
    near = (x > 3e-4 * length) & (x < 1e-2 * length)
    slope = np.polyfit(np.log(x[near]), np.log(found.pressure[near]), 1)[0]
    assert slope == pytest.approx(power, abs=3e-3)


@pytest.mark.parametrize("at_start", [True, False])
def test_what_gives_way_to_a_power_keeps_force_and_moment_and_finds_the_power_again(at_start):
    """Replacing p at a corner by a power keeps force and moment and finds the power again.

    The pressure is p = x^-0.3 + 2 - x on columns that grow from a corner, with a made-up value
    there.
    """
    power, order = -0.3, 6
    ends = np.concatenate([[0.0], 1e-4 * 2.4 ** np.arange(11)])
    x = np.append(
        (
            ends[:-1, None] + np.diff(ends)[:, None] * 0.5 * (1 + gauss_lobatto_points(order)[:-1])
        ).ravel(),
        ends[-1],
    )
    with np.errstate(divide="ignore"):
        exact = x**power + 2 - x
    exact[0] = exact[1]
    theta, p = (1.0 + x, exact) if at_start else ((1.0 + ends[-1] - x)[::-1], exact[::-1])
    new, value = nodes_and_pressures_with_power_law_at_corner(
        theta,
        p,
        order,
        CornerWithUnboundedPressure(at_start=at_start, exponent=power),
        reach=POWER_LAW_FRACTION_OF_CONTACT,
    )
    at, q, weight = polynomial_values_at_gauss_points(new, value, order)
    before, r, own = polynomial_values_at_gauss_points(theta, p, order)
    assert (weight * q).sum() == pytest.approx((own * r).sum(), rel=1e-12)
    assert (weight * q * at).sum() == pytest.approx((own * r * before).sum(), rel=1e-12)
    assert (np.diff(new) > 0).all() and new[0] == theta[0] and new[-1] == theta[-1]


def test_half_the_force_of_the_steepest_pressure_lies_where_it_is_said():
    """The force of p = x^(-1/2) (1 - x)^(1/2) up to x is the incomplete beta function."""
    assert betainc(0.5, 1.5, HALF_FORCE_FRACTION_OF_CONTACT) == pytest.approx(0.5, abs=1e-4)


def test_p_between_the_nodes_near_a_corner_is_its_power_to_a_ten_thousandth():
    """Polynomials of degree 5 for x^-0.3 near a corner agree with it between their nodes."""
    power, order = -0.3, 5
    ends = np.concatenate([[0.0], 1e-4 * 2.4 ** np.arange(11)])
    inner = np.diff(ends)[:, None] * 0.5 * (1 + gauss_lobatto_points(order)[:-1])
    x = np.append((ends[:-1, None] + inner).ravel(), ends[-1])
    p = np.append(x[1] ** power, x[1:] ** power)
    new, value = nodes_and_pressures_with_power_law_at_corner(
        x,
        p,
        order,
        CornerWithUnboundedPressure(at_start=True, exponent=power),
        reach=POWER_LAW_FRACTION_OF_CONTACT,
    )
    at, q, weight = (part.ravel() for part in polynomial_values_at_gauss_points(new, value, order))
    # Gauss points within the pieces that were made, but for the last one at the corner.
    near = (at > 1e-10) & (at < 0.5 * POWER_LAW_FRACTION_OF_CONTACT)
    terms = np.stack([at[near] ** power, np.ones(near.sum()), at[near]], axis=1)
    own = np.sqrt(weight[near])
    parts = np.linalg.lstsq(own[:, None] * terms, own * q[near], rcond=None)[0]
    off = own * (terms @ parts - q[near])
    assert np.linalg.norm(off) < 1e-4 * np.linalg.norm(own * q[near])


@pytest.mark.parametrize(
    ("name", "level", "most", "gain"),
    [
        ("corner_dragged_inwards", 2, 2e-3, 5),
        ("corner_dragged_inwards", 3, 1.5e-4, 30),
        ("corner_little_friction", 4, 3e-5, 4),
    ],
)
def test_the_power_of_a_corner_makes_p_many_times_more_exact(name, level, most, gain):
    stored = read_stored_fine_solution(TRUTHS / f"{name}.json")
    *_, last = islice(
        solve_brake_on_finer_and_finer_mesh_levels(stored.brake, solve_prepared_model), level
    )
    raw = true_errors_of_response(stored.brake, last.response.shoes, stored.true.shoes)["pressure"]
    found = response_with_power_laws_at_corners(stored.brake, last.response)
    error = true_errors_of_response(stored.brake, found.shoes, stored.true.shoes)["pressure"]
    assert error < most and error < raw / gain


@pytest.mark.parametrize("force_factor", [0.53, 0.72, 1.0])
def test_the_first_two_levels_of_a_pressed_corner_do_not_have_nearly_equal_errors(force_factor):
    """The stated error of a torque is the true one at least, however long the short contact is.

    Layers of elements that begin at the tiny columns of the corner lie at nearly equal depths on
    both levels. The errors were then 4e-5, 8e-5 and 4e-5, and stated up to 9 times too small.
    """
    stored = read_stored_fine_solution(TRUTHS / "corner_dragged_inwards.json").brake
    force = force_factor * stored.shoes[0].actuation.force
    brake = vary(stored, {"shoe[0].actuation.force": force})
    levels = solve_brake_on_finer_and_finer_mesh_levels(brake, solve_prepared_model)
    before, last, _, fine = (solved.response for solved in islice(levels, 4))
    stated = estimate_errors_from_two_mesh_levels(brake, before, last).brake["torque"]
    true = abs(last.torque / fine.torque - 1)
    assert true < 5e-6 and true < stated < 1e-4


def test_what_is_left_of_p_is_known_where_it_has_no_bound():
    """The error of p beside a singular point is known: under a tip it is the true one.

    At a corner, far smaller elements leave little error.
    """
    stored = read_stored_fine_solution(TRUTHS / "tip_short.json")
    *_, last = islice(
        solve_brake_on_finer_and_finer_mesh_levels(stored.brake, solve_prepared_model), 4
    )
    (shoe,), (found,) = stored.brake.shoes, last.response.shoes
    left = remaining_pressure_error_at_pointed_gap_kinks(shoe, stored.brake.size, found)
    assert left == pytest.approx(
        true_errors_of_response(stored.brake, [found], stored.true.shoes)["pressure"], rel=0.3
    )
    corner = read_stored_fine_solution(TRUTHS / "corner_dragged_inwards.json").brake
    *_, last = islice(solve_brake_on_finer_and_finer_mesh_levels(corner, solve_prepared_model), 2)
    (found,) = last.response.shoes
    assert remaining_pressure_error_at_lining_corners(corner, 0, found) > 2e-3
    (better,) = response_with_power_laws_at_corners(corner, last.response).shoes
    assert remaining_pressure_error_at_lining_corners(corner, 0, better) < 3e-4
