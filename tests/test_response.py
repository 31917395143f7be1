"""Resultants and ends of a pressure, and texts of a response, against closed forms."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drumlin.base.arrays import polar_angles_within_half_turn_of_angle
from drumlin.brake.file import vary
from drumlin.brake.surface import FRICTION_SURFACE_OF_DRUM
from drumlin.response.balance import (
    largest_imbalance_among_shoes,
    relative_imbalance_of_shoe,
    relative_magnitudes_of_force_and_moment_sums,
    resultant_of_contact_on_shoe,
)
from drumlin.response.response import (
    BeamAndRingDeflections,
    ForceAndMomentImbalance,
    PressureOverArcAndWidth,
    Response,
    ShoeResponse,
    largest_nodal_pressure_outside_end_zones,
    response_of_pressed_elastic_shoe,
    response_of_shoe_without_contact,
)
from drumlin.response.resultants import (
    PressureAndFrictionResultant,
    contact_arcs_from_nodal_pressures,
    gauss_lobatto_points,
    integral_of_piecewise_polynomial,
    lagrange_shape_function_derivatives,
    lagrange_shape_function_values,
    planar_cross_product,
    resultant_of_pressure_and_friction,
)
from picking import picked


def polynomial(order, knots):
    """Nodes of a piecewise polynomial on uneven knots, `order` steps in each."""
    part = 0.5 * (gauss_lobatto_points(order)[:-1] + 1)
    return np.concatenate([a + (b - a) * part for a, b in pairwise(knots)] + [knots[-1:]])


KNOTS = np.array([0.2, 0.5, 0.6, 1.1, 1.9])


@pytest.mark.parametrize("order", [1, 2, 3])
def test_shape_functions_are_lagranges(order):
    xi = np.array([-1.0, -0.3, 0.0, 0.7, 1.0])
    assert lagrange_shape_function_values(order, gauss_lobatto_points(order)) == pytest.approx(
        np.eye(order + 1), abs=1e-14
    )
    nodes = gauss_lobatto_points(order)
    for degree in range(order + 1):
        assert nodes**degree @ lagrange_shape_function_values(order, xi) == pytest.approx(
            xi**degree, abs=1e-14
        )
        slope = degree * xi ** max(degree - 1, 0)
        assert nodes**degree @ lagrange_shape_function_derivatives(order, xi) == pytest.approx(
            slope, abs=1e-13
        )
    assert lagrange_shape_function_derivatives(order, np.zeros((2, 3))).shape == (order + 1, 2, 3)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_polynomials_are_integrated_and_evaluated_exactly(order):
    theta = polynomial(order, KNOTS)
    for degree in range(order + 1):
        exact = (1.9 ** (degree + 1) - 0.2 ** (degree + 1)) / (degree + 1)
        assert integral_of_piecewise_polynomial(theta, theta**degree, order) == pytest.approx(
            exact, rel=1e-14
        )
        at = np.array([[0.2, 0.55], [1.0, 1.9]])
        shoe = shoe_of(theta, theta**degree, order)
        assert shoe.pressure_at(at) == pytest.approx(at**degree, rel=1e-13)
        assert shoe.pressure_at(np.array([0.2 - 1e-9, 1.9 + 1e-9])).tolist() == [0, 0]
    # Each piece of p has a polynomial of its own.
    kinked = np.abs(theta - 0.6)
    assert integral_of_piecewise_polynomial(theta, kinked, order) == pytest.approx(
        (0.4**2 + 1.3**2) / 2, rel=1e-14
    )
    assert shoe_of(theta, kinked, order).pressure_at(np.array([0.59, 0.61])) == pytest.approx(
        [0.01, 0.01]
    )


def shoe_of(theta, pressure, order=2, **more):
    data = {"torque": 1.0, "normal_force": 1.0, "self_energising": True, "peak_pressure": 1.0}
    arcs = ((float(theta[0]), float(theta[-1])),)
    return ShoeResponse(
        "shoe",
        **(data | more),
        hinge_reaction=np.zeros(2),
        contact_arcs=arcs,
        theta=theta,
        pressure=pressure,
        order=order,
    )


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("drag", [0.3, -0.4])
def test_an_even_pressure_on_an_arc(sign, drag):
    """An even pressure on an arc a < theta < b has the closed-form resultant.

    -sign p R b (sin b - sin a, cos a - cos b), and drag times this vector turned by 90 deg.
    """
    theta, p, R, width = polynomial(2, KNOTS), 3e5, 0.2, 0.05
    found = resultant_of_pressure_and_friction(
        FRICTION_SURFACE_OF_DRUM,
        theta,
        np.full(len(theta), p),
        order=2,
        size=R,
        per_place=R * width,
        sign=sign,
        drag=drag,
    )
    along = p * R * width * np.array([math.sin(1.9) - math.sin(0.2), math.cos(0.2) - math.cos(1.9)])
    assert found.normal == pytest.approx(-sign * along, rel=1e-9)
    assert found.friction == pytest.approx(drag * np.array([-along[1], along[0]]), rel=1e-9)
    assert found.moment == pytest.approx(drag * p * R**2 * width * 1.7, rel=1e-12)
    assert found.force == pytest.approx(found.normal + found.friction)


@given(st.floats(-9, 9), st.floats(-3.1, 3.1), st.floats(0.1, 10))
def test_angles_are_counted_from_the_middle_and_cross_products_by_the_sine(middle, turn, size):
    xy = size * np.array([math.cos(middle + turn), math.sin(middle + turn)])
    assert polar_angles_within_half_turn_of_angle(middle, xy) == pytest.approx(
        middle + turn, abs=1e-12
    )
    start = np.array([math.cos(middle), math.sin(middle)])
    assert planar_cross_product(start, xy) == pytest.approx(size * math.sin(turn), abs=1e-12 * size)


@pytest.mark.parametrize(
    ("pressed", "arcs"),
    [
        ("11111", [(0, 4)]),
        ("00000", []),
        ("10000", [(0, 1)]),
        ("00001", [(3, 4)]),
        ("00100", [(1, 3)]),
        ("11000", [(0, 2)]),
        ("00011", [(2, 4)]),
        ("10001", [(0, 1), (3, 4)]),
        ("100010", [(0, 1), (3, 5)]),
        ("0100100", [(0, 2), (3, 5)]),
        ("10101", [(0, 4)]),
        ("0100010", [(0, 2), (4, 6)]),
    ],
)
def test_arcs_reach_to_the_node_next_to_a_pressed_one(pressed, arcs):
    theta = np.arange(len(pressed)) * 0.5 + 1
    p = np.array(list(map(float, pressed)))
    assert contact_arcs_from_nodal_pressures(theta, p, 1, located=False) == tuple(
        (1 + 0.5 * a, 1 + 0.5 * b) for a, b in arcs
    )


@pytest.mark.parametrize(
    ("order", "end", "found"),
    [
        (1, 0.1, 0.1),
        (1, 0.4, 0.4),
        (2, 0.1, 0.1),
        (2, 0.3, 0.25),
        (1, -0.1, 0.0),
        (2, -0.1, 0.0),
        (2, 0.32, 0.32),
    ],
)
def test_the_end_of_a_contact_is_where_the_integral_of_its_square_root_begins(order, end, found):
    """The end of a contact is where the integral of the pressure's square root begins.

    Nodal values have the integrals (theta - end)^1.5 up to 0.5 and to 1; an end beyond its step is
    taken to the step.
    """
    theta = np.linspace(0, 5, 10 * order + 1)
    # Both are integrals over the step.
    F, G = 0.5**-1 * (0.5 - end) ** 1.5, 0.5**-1 * (1 - end) ** 1.5
    if order == 1:
        p = [0, 2 * F, 2 * (G - F) - 2 * F]
    # The node in the middle is not pressed, either.
    elif found == end > 0.25:
        p = [0, 0, 6 * F, (6 * (G - F) - 6 * F - 2) / 4, 2]
    else:
        p = [0, (6 * F - 1) / 4, 1, (6 * (G - F) - 3) / 4, 2]
    assert min(p) >= 0
    pressure = np.array(p + [1.0] * (len(theta) - len(p)))
    assert contact_arcs_from_nodal_pressures(theta, pressure, order) == (
        (pytest.approx(found, abs=1e-12), 5.0),
    )
    assert contact_arcs_from_nodal_pressures(-theta[::-1], pressure[::-1], order) == (
        (-5.0, pytest.approx(-found, abs=1e-12)),
    )
    two = slice(None, 2 * order + 1)
    assert contact_arcs_from_nodal_pressures(theta[two], pressure[two], order)[0][
        0
    ] == pytest.approx(found, abs=1e-12)
    # One element is too short to tell where the contact ends.
    one = slice(None, order + 1)
    assert (
        contact_arcs_from_nodal_pressures(theta[one], pressure[one], order)[0][0]
        == theta[np.flatnonzero(pressure > 0)[0] - 1]
    )


def test_an_end_next_to_which_nothing_more_is_pressed_stays_at_its_node():
    assert (
        contact_arcs_from_nodal_pressures(np.arange(6.0), np.array([0, 0, 9.0, 0, 0, 0]), 1)[0][0]
        == 1.0
    )
    assert contact_arcs_from_nodal_pressures(np.arange(7.0), np.array([0, 9.0, 0, 0, 0, 0, 0]), 2)[
        0
    ] == (0.0, 2.0)


def test_the_peak_leaves_out_the_ends_unless_nothing_is_left():
    theta, p = np.array([0.0, 0.1, 0.5, 0.9, 1.0]), np.array([9.0, 5, 3, 4, 8])
    assert [
        largest_nodal_pressure_outside_end_zones(theta, p, zone)
        for zone in (0.0, 0.05, 0.1, 0.2, 0.6)
    ] == [5, 5, 3, 3, 9]


def test_a_curve_is_nowhere_below_zero_though_its_polynomial_is():
    theta = polynomial(4, np.array([0.0, 1.0]))
    shoe = shoe_of(theta, np.array([0.0, 0.0, 0.0, 0.0, 1.0]), 4)
    at, p = shoe.curve()
    assert shoe.pressure_at(at).min() < -0.05 and p.min() == 0.0
    assert p == pytest.approx(np.maximum(shoe.pressure_at(at), 0.0))


def test_an_elastic_lining_by_growing_angles(brake):
    shoe = brake.shoes[1]
    theta, p = np.linspace(1, 0, 9), np.arange(9.0)
    found = response_of_pressed_elastic_shoe(
        shoe,
        0.15,
        theta,
        p,
        order=2,
        torque=3.0,
        normal_force=4.0,
        self_energising=False,
        hinge_reaction=np.array([1.0, 2]),
        turn=0.5,
        located=False,
        lumped=PressureAndFrictionResultant(np.ones(2), np.ones(2), 1.0),
    )
    assert found.theta == pytest.approx(theta[::-1]) and found.pressure == pytest.approx(p[::-1])
    assert (found.name, found.torque, found.normal_force, found.self_energising) == (
        shoe.name,
        3.0,
        4.0,
        False,
    )
    # The zones of 8 mm / (2 150 mm) at the ends are left out.
    assert (found.peak_pressure, found.order, found.turn) == (
        7.0,
        2,
        0.5,
    )
    assert found.contact_arcs == ((0.0, 1.0),) and found.lumped is not None
    other = response_of_pressed_elastic_shoe(
        shoe,
        0.15,
        theta[::-1],
        p,
        order=2,
        torque=3.0,
        normal_force=4.0,
        self_energising=False,
        hinge_reaction=np.zeros(2),
    )
    rows = p[:, None] * np.ones(3)
    over_width = response_of_pressed_elastic_shoe(
        shoe,
        0.15,
        theta,
        p,
        order=2,
        torque=3.0,
        normal_force=4.0,
        self_energising=False,
        hinge_reaction=np.zeros(2),
        surface=PressureOverArcAndWidth(np.arange(3.0), rows, np.ones(3)),
    )
    assert over_width.surface.pressure.mean(axis=1) == pytest.approx(over_width.pressure)
    assert other.theta == pytest.approx(theta[::-1]) and other.pressure == pytest.approx(p)
    # At the first node p = 0, so that the contact begins behind it.
    assert other.turn is None and 0 < other.contact_arcs[0][0] < 0.125


def test_forces_and_moments_are_balanced_relative_to_the_largest(brake):
    forces = [np.array([3.0, 0]), np.array([0, 4.0]), np.array([-3.0, -3.0])]
    assert relative_magnitudes_of_force_and_moment_sums(
        forces, [2.0, -1.5]
    ) == ForceAndMomentImbalance(pytest.approx(1 / math.sqrt(18)), pytest.approx(0.25))
    assert (
        relative_magnitudes_of_force_and_moment_sums([np.zeros(2)], [0.0])
        == relative_magnitudes_of_force_and_moment_sums([], [])
        == ForceAndMomentImbalance(0.0, 0.0)
    )
    assert largest_imbalance_among_shoes(
        [ForceAndMomentImbalance(1.0, 4.0), ForceAndMomentImbalance(3.0, 2.0)]
    ) == ForceAndMomentImbalance(3.0, 4.0)


def test_a_shoe_is_balanced_by_the_integrals_of_its_pressure_or_by_what_is_lumped(brake):
    spec, R = brake.shoes[0], brake.drum.radius
    theta = np.linspace(spec.lining.start, spec.lining.end, 41)
    p = 1e5 * (1 + theta**2)
    contact = resultant_of_pressure_and_friction(
        FRICTION_SURFACE_OF_DRUM,
        theta,
        p,
        order=2,
        size=R,
        per_place=R * spec.lining.width,
        sign=1,
        drag=0.3,
    )
    pin = -contact.force - spec.actuation.force_vector
    shoe = replace(shoe_of(theta, p), hinge_reaction=pin)
    found = resultant_of_contact_on_shoe(brake, 0, shoe)
    assert found.force == pytest.approx(contact.force) and found.moment == pytest.approx(
        contact.moment
    )
    clockwise = resultant_of_contact_on_shoe(vary(brake, {"rotation": "clockwise"}), 0, shoe)
    assert clockwise.normal == pytest.approx(contact.normal) and clockwise.moment == pytest.approx(
        -contact.moment
    )
    balance = relative_imbalance_of_shoe(brake, 0, shoe)
    assert balance.force < 1e-15
    hinge, push = spec.hinge.xy, spec.actuation
    about = [
        contact.moment - hinge[0] * contact.force[1] + hinge[1] * contact.force[0],
        push.moment_of_force_about_point(spec.hinge),
    ]
    assert balance.moment == pytest.approx(abs(sum(about)) / max(map(abs, about)))
    lumped = PressureAndFrictionResultant(np.array([5.0, 0]), np.array([0, 7.0]), 9.0)
    assert resultant_of_contact_on_shoe(brake, 0, replace(shoe, lumped=lumped)) is lumped
    assert relative_imbalance_of_shoe(
        brake, 0, replace(shoe, contact_arcs=())
    ) == ForceAndMomentImbalance(0.0, 0.0)


def test_a_shoe_apart_and_responses_as_plain_data(brake):
    away = response_of_shoe_without_contact(brake.shoes[0], np.array([1.0, 2.0]))
    lining = brake.shoes[0].lining
    assert (
        away.theta == pytest.approx([lining.start, lining.middle, lining.end])
        and not away.pressure.any()
    )
    assert (away.torque, away.normal_force, away.peak_pressure) == (0, 0, 0)
    assert away.contact_arcs == () and not away.self_energising and away.pivot_reaction is None
    on_pivot = vary(brake, {"shoe[0].pivot": {"x": 0.1, "y": 0.0}}).shoes[0]
    assert response_of_shoe_without_contact(on_pivot, np.zeros(2)).pivot_reaction == pytest.approx(
        [0, 0]
    )

    bent = BeamAndRingDeflections(*(np.array([float(i)]) for i in range(4)))
    shoe = replace(
        shoe_of(np.array([0.0, 1, 2]), np.array([1.0, 2, 3])),
        deformation=bent,
        pivot_reaction=np.ones(2),
    )
    assert shoe.as_dict() == {
        "name": "shoe",
        "torque": 1.0,
        "normal_force": 1.0,
        "self_energising": True,
        "peak_pressure": 1.0,
        "hinge_reaction": [0, 0],
        "contact_arcs": [[0, 2]],
        "theta": [0, 1, 2],
        "pressure": [1, 2, 3],
        "pivot_reaction": [1, 1],
        "deformation": {"x": [0], "w": [1], "relative": [2], "z": [3]},
    }
    response = Response(
        "fem",
        (shoe, away),
        ForceAndMomentImbalance(1e-9, 2e-9),
        bearing_load=np.array([1.0, 2]),
        error={"torque": 1e-3},
    )
    data = response.as_dict()
    assert response.torque == data["torque"] == 1.0
    assert data["balance"] == {"force": 1e-9, "moment": 2e-9} and data["error"] == {"torque": 1e-3}
    assert (
        picked(data["shoes"], "name") == ["shoe", "right"] and "deformation" not in data["shoes"][1]
    )
    assert data["bearing_load"] == [1, 2] and data["converged"] is True and data["iterations"] == 0
    assert "bearing_load" not in replace(response, bearing_load=None).as_dict()
