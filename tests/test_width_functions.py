"""The functions across the width: parity, hierarchy, completeness, and exact integrals."""

from fractions import Fraction

import numpy as np
import pytest

from drumlin.brake.file import vary
from drumlin.fem.width.functions import (
    FunctionsAcrossWidth,
    functions_across_width_of_shoe,
    integrals_of_function_products_over_width,
    piece_ends_across_half_width_of_shoe,
)
from sections import t_section

BREAKS = (0.0, 0.5, 2.0, 3.0)
"""Breaks of three pieces whose lengths differ."""
DEGREES = range(1, 7)


def sampled(functions, z):
    """Values of the even and of the odd functions."""
    return [
        functions.function_values_and_slopes(own, z)[0]
        for own in (functions.even_functions_across_width, functions.odd_functions_across_width)
    ]


@pytest.mark.parametrize("degree", DEGREES)
def test_they_hold_all_polynomials_of_their_parity_and_degree(degree):
    functions = FunctionsAcrossWidth(BREAKS, degree)
    z = np.linspace(0, 3, 200)
    for parity, values in enumerate(sampled(functions, z)):
        for power in range(parity, degree + 1, 2):
            wanted = z**power
            found = values.T @ np.linalg.lstsq(values.T, wanted, rcond=None)[0]
            np.testing.assert_allclose(found, wanted, atol=1e-11 * wanted.max())


@pytest.mark.parametrize("degree", DEGREES)
def test_those_of_a_degree_are_among_those_of_the_next(degree):
    z = np.linspace(0, 3, 50)
    few, many = FunctionsAcrossWidth(BREAKS, degree), FunctionsAcrossWidth(BREAKS, degree + 1)
    for own, others in zip(sampled(few, z), sampled(many, z), strict=True):
        apart = np.abs(own[:, None] - others).max(axis=2)
        assert (apart.min(axis=1) == 0).all()


@pytest.mark.parametrize("degree", DEGREES)
def test_even_and_odd_ones_start_flat_and_at_zero(degree):
    functions = FunctionsAcrossWidth(BREAKS, degree)
    at = np.array([0.0])
    assert (
        np.abs(
            functions.function_values_and_slopes(functions.even_functions_across_width, at)[1]
        ).max()
        < 1e-14
    )
    assert (
        np.abs(
            functions.function_values_and_slopes(functions.odd_functions_across_width, at)[0]
        ).max()
        < 1e-14
    )


@pytest.mark.parametrize("degree", DEGREES)
def test_they_are_continuous(degree):
    functions = FunctionsAcrossWidth(BREAKS, degree)
    for at in BREAKS[1:-1]:
        before, behind = np.array([at - 1e-9]), np.array([at + 1e-9])
        for own in (functions.even_functions_across_width, functions.odd_functions_across_width):
            left, _ = functions.function_values_and_slopes(own, before)
            right, _ = functions.function_values_and_slopes(own, behind)
            np.testing.assert_allclose(left, right, atol=1e-7)


@pytest.mark.parametrize("degree", DEGREES)
def test_in_a_narrower_part_the_functions_of_wider_ones_vanish(degree):
    functions = FunctionsAcrossWidth(BREAKS, degree)
    for half in BREAKS[1:]:
        even, odd = functions.counts_of_even_and_odd_functions_on_part(half)
        inside = np.linspace(0, half, 40)
        for own, count in (
            (functions.even_functions_across_width, even),
            (functions.odd_functions_across_width, odd),
        ):
            values, _ = functions.function_values_and_slopes(own, inside)
            assert not np.abs(values[count:]).max(initial=0) > 1e-14
            assert np.linalg.matrix_rank(values[:count]) == count


@pytest.mark.parametrize("degree", [0, *DEGREES])
@pytest.mark.parametrize("half", BREAKS[1:])
def test_face_nodes_tell_the_functions_and_part_one(degree, half):
    functions = functions_of_breaks(degree)
    own = functions.even_functions_across_width[
        : functions.counts_of_even_and_odd_functions_on_part(half)[0]
    ]
    nodes = functions.node_distances_across_half_width_of_part(half)
    assert len(nodes) == len(own) and (nodes >= 0).all() and (nodes <= half).all()
    nodal = np.linalg.inv(functions.function_values_and_slopes(own, nodes)[0])
    z = np.linspace(0, half, 30)
    parts = nodal @ functions.function_values_and_slopes(own, z)[0]
    np.testing.assert_allclose(parts.sum(axis=0), 1, atol=1e-12)


def functions_of_breaks(degree):
    return FunctionsAcrossWidth(BREAKS if degree else (0.0, BREAKS[-1]), degree)


def test_slopes_of_the_bubbles_of_a_piece_are_orthonormal():
    integrals = integrals_of_function_products_over_width(FunctionsAcrossWidth((0.0, 1.0), 9), 1.0)
    np.testing.assert_allclose(integrals.even_slopes[1:, 1:], np.eye(4), atol=1e-13)
    np.testing.assert_allclose(integrals.odd_slopes[1:, 1:], np.eye(4), atol=1e-13)
    # A bubble's ends are zero: the slope of z is orthogonal to the slopes of all odd ones.
    np.testing.assert_allclose(integrals.odd_slopes[0, 1:], 0, atol=1e-13)


def test_integrals_over_one_piece_are_those_by_hand():
    # On |z| <= h:  e = 1, N_2 = sqrt(3/8) (x^2 - 1),  o = x, N_3 = sqrt(5/8) (x^3 - x),  x = z/h.
    h = 2.0
    found = integrals_of_function_products_over_width(FunctionsAcrossWidth((0.0, h), 3), h)
    two, three = np.sqrt(3 / 8), np.sqrt(5 / 8)
    np.testing.assert_allclose(
        found.even, h * np.array([[2, -4 / 3 * two], [-4 / 3 * two, 16 / 15 * 3 / 8]])
    )
    np.testing.assert_allclose(
        found.odd, h * np.array([[2 / 3, -4 / 15 * three], [-4 / 15 * three, 16 / 105 * 5 / 8]])
    )
    # Int e o' = [2, 0; Int N_2, Int N_2 N_3'],  Int N_2 N_3' = two three 8/15 - ... by parts.
    by_parts = two * three * float(Fraction(2, 1) * (Fraction(3, 5) - Fraction(4, 3) + 1))
    np.testing.assert_allclose(
        found.even_times_odd_slopes, [[2, 0], [-4 / 3 * two, by_parts]], atol=1e-14
    )
    assert found.even_slopes_times_odd[1, 0] == pytest.approx(two * 4 / 3)


def test_integrals_over_pieces_are_those_of_a_fine_sum():
    functions = FunctionsAcrossWidth(BREAKS, 3)
    z = (np.arange(300_000) + 0.5) * 1e-5
    e, slopes = functions.function_values_and_slopes(functions.even_functions_across_width, z)
    o, _ = functions.function_values_and_slopes(functions.odd_functions_across_width, z)
    found = integrals_of_function_products_over_width(functions, 3.0)
    np.testing.assert_allclose(found.even, 2e-5 * e @ e.T, atol=1e-7)
    np.testing.assert_allclose(found.even_slopes_times_odd, 2e-5 * slopes @ o.T, atol=1e-4)


def test_breaks_are_at_the_sides_of_the_parts(brake, flexible):
    assert piece_ends_across_half_width_of_shoe(brake.shoes[0]) == (0.0, 20e-3)
    table = t_section(flexible)
    assert piece_ends_across_half_width_of_shoe(table.shoes[0]) == pytest.approx(
        (0.0, 2.5e-3, 10.5e-3, 20e-3)
    )
    # The overhang of 1.44 thicknesses is short: its break is at a quarter of it.
    short = vary(table, {"shoe.body.width": 17e-3})
    assert piece_ends_across_half_width_of_shoe(short.shoes[0]) == pytest.approx(
        (0.0, 8.5e-3, 11.375e-3, 20e-3)
    )
    shorter = vary(table, {"shoe.body.width": 34e-3})
    assert piece_ends_across_half_width_of_shoe(shorter.shoes[0]) == pytest.approx(
        (0.0, 17e-3, 20e-3)
    )
    # A long overhang, of 4.7 thicknesses, has a second break.
    long = vary(table, {"shoe.lining.width": 80e-3})
    assert piece_ends_across_half_width_of_shoe(long.shoes[0]) == pytest.approx(
        (0.0, 2.5e-3, 10.5e-3, 22.5e-3, 40e-3)
    )


def test_plane_stress_is_the_one_constant(brake):
    functions = functions_across_width_of_shoe(brake.shoes[0], 0)
    assert (
        len(functions.even_functions_across_width),
        len(functions.odd_functions_across_width),
    ) == (1, 0)
    assert integrals_of_function_products_over_width(functions, 5e-3).even == pytest.approx(10e-3)
