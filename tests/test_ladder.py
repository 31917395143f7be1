"""Benchmarks of rising difficulty with known answers (the ladder): all within their tolerances."""

import math

import numpy as np
import pytest
from pytest import approx

from drumlin.contact.stick_slip import BACKWARD, FORWARD, OPEN, STICK
from drumlin_studies import closed_forms
from drumlin_studies.ladder import (
    ALL_KNOWN_ANSWER_CASES,
    is_value_within_case_tolerance,
    names_of_families_of_known_answer_cases,
)
from drumlin_studies.ladder_friction import solve_pressed_and_pushed_plate
from picking import picked

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    "case",
    ALL_KNOWN_ANSWER_CASES,
    ids=lambda case: f"{case.family}: {case.quantity}".replace(" ", "_"),
)
def test_every_case_is_within_its_tolerance(case):
    value = case.found()
    assert is_value_within_case_tolerance(case, value), (
        f"{value!r} for {case.expected!r}, {value / case.expected - 1:.2e} off"
    )
    assert not is_value_within_case_tolerance(case, 1.1 * value)
    assert not is_value_within_case_tolerance(case, value / 1.1)
    assert not is_value_within_case_tolerance(case, math.nan)


def test_the_ladder_has_forty_families_each_with_its_source():
    assert len(names_of_families_of_known_answer_cases()) >= 40
    assert len(set(picked(ALL_KNOWN_ANSWER_CASES, ("family", "quantity")))) == len(
        ALL_KNOWN_ANSWER_CASES
    )
    for case in ALL_KNOWN_ANSWER_CASES:
        assert case.source and case.shows
        assert 0 < case.tolerance <= 0.03


def test_the_plate_sticks_slips_and_lifts_off_at_once():
    states = solve_pressed_and_pushed_plate().states
    assert {OPEN, STICK} <= states
    assert states & {FORWARD, BACKWARD}


def test_the_clearance_and_the_pressure_of_the_disc_agree():
    """Zero clearance at 84.828 deg (Persson); the pressure carries the load."""
    b = math.tan(math.radians(84.828) / 2)
    assert abs(closed_forms.dimensionless_persson_clearance_of_disc_in_hole(b)) < 2e-5
    for half in (20, 60):
        theta = np.linspace(-math.radians(half), math.radians(half), 20001)
        p = closed_forms.dimensionless_persson_pressure_of_disc_in_hole(
            math.tan(math.radians(half) / 2), theta
        )
        assert np.trapezoid(p * np.cos(theta), theta) == approx(1, rel=1e-5)
    assert closed_forms.dimensionless_persson_pressure_of_disc_in_hole(0.5, np.array([1.0])) == 0


def test_the_yield_of_rings_tends_to_its_limits():
    E, nu = 200e9, 0.3
    # a thin layer of thickness t held at its back: t (1 - nu^2)/E in every mode that is long
    # against it
    for n in (0, 1, 2, 5):
        inside, outside = (
            closed_forms.ring_displacement_per_harmonic_pressure(n, 1.0, held, E, nu)
            for held in (1 - 1e-4, 1 + 1e-4)
        )
        assert inside == approx(-1e-4 * (1 - nu**2) / E, rel=1e-3)
        assert outside == approx(1e-4 * (1 - nu**2) / E, rel=1e-3)
    # a short wave sees a half-plane: 2/(E n)
    assert closed_forms.ring_displacement_per_harmonic_pressure(60, 1.0, 1.9, E, nu) == approx(
        2 / (E * 60), rel=0.02
    )
    # sizes scale
    assert closed_forms.ring_displacement_per_harmonic_pressure(2, 3.0, 1.8, E, nu) == approx(
        3 * closed_forms.ring_displacement_per_harmonic_pressure(2, 1.0, 0.6, E, nu)
    )


def test_lames_ring_tends_to_the_boiler_formula():
    inner, outer = closed_forms.lame_displacements_of_ring_edges(1.0, 1.001, 1e6, 200e9, 0.3)
    assert inner == approx(outer, rel=1e-3)
    assert inner == approx(1e6 / 200e9 / 0.001, rel=2e-3)


@pytest.mark.parametrize(
    ("mu", "exponent"), [(0.0, 1.0), (0.1, 0.887), (0.3, 0.7095), (0.5, 0.564)]
)
def test_exponents_of_the_corner(mu, exponent):
    """The exponents agree with known digits for nu = 0.3, and tend to 1 as mu tends to 0."""
    assert closed_forms.displacement_exponent_at_sliding_corner(mu, 0.3) == approx(
        exponent, abs=5e-5 if mu == 0.3 else 5e-4
    )
    assert closed_forms.displacement_exponent_at_sliding_corner(1e-3, 0.3) > 0.995


def test_hertz_and_westergaard_in_their_limits():
    half, peak = closed_forms.hertz_half_width_and_peak_pressure(1e5, 2.0, 1e11)
    # The half-ellipse of pressure carries the load.
    assert math.pi * half * peak / 2 == approx(1e5)
    assert peak == approx(1e11 * half / (2 * 2.0))
    psi = np.linspace(-math.pi / 2, math.pi / 2, 100001)
    for mean in (0.2, 0.7, 1.5):
        p = closed_forms.westergaard_pressure_of_wavy_surface(mean, 1.0, psi)
        assert np.trapezoid(p, psi) / math.pi == approx(mean, rel=1e-5)
    assert closed_forms.westergaard_pressure_of_wavy_surface(1 - 1e-9, 1.0, psi) == approx(
        closed_forms.westergaard_pressure_of_wavy_surface(1.0, 1.0, psi), abs=1e-4
    )


def test_the_flat_punch_carries_its_load():
    # The angles are those of x = a sin(turned).
    turned = (np.arange(1000) + 0.5) / 1000 * math.pi - math.pi / 2
    p = closed_forms.flat_punch_pressure(3.0, 0.2, 0.2 * np.sin(turned))
    assert (p * 0.2 * np.cos(turned)).mean() * math.pi == approx(3.0)


def test_tensions_of_a_belt_multiply():
    assert closed_forms.capstan_tension_ratio(0.3, 1.0) * closed_forms.capstan_tension_ratio(
        0.3, 2.0
    ) == approx(closed_forms.capstan_tension_ratio(0.3, 3.0))
    assert closed_forms.capstan_tension_ratio(0.3, -1.0) * closed_forms.capstan_tension_ratio(
        0.3, 1.0
    ) == approx(1.0)


def test_a_short_shoe_on_springs_locks_as_a_block_does():
    """A short shoe 90 deg from a hinge on the drum's rim locks itself at mu = 1.

    The equivalent friction of a short block is its own friction.
    """
    assert closed_forms.locking_friction_of_hinged_shoe_with_sine_pressure(
        0.2, 0.2, math.pi / 2 - 1e-3, math.pi / 2 + 1e-3
    ) == approx(1.0, rel=1e-5)
    assert closed_forms.equivalent_over_actual_friction_of_block(1e-3) == approx(1.0, rel=1e-6)
    assert closed_forms.equivalent_over_actual_friction_of_block(math.pi / 2) == approx(4 / math.pi)
