"""Elastic contact against closed forms: Hertz, Cattaneo-Mindlin, Persson, Westergaard, Lame."""

import math

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from drumlin.brake.elasticity import ElasticLayer
from drumlin.brake.fields import Material
from drumlin.contact import active_set, stick_slip
from drumlin.fem.mesh.degree import nodal_basis_of_mesh
from drumlin.fem.mesh.grading import points_graded_to_both_ends
from drumlin.fem.substructure.body import (
    sparse_stiffness_of_body,
)
from drumlin.fem.substructure.interface import (
    coupling_matrices_of_contact_line,
    function_that_returns_drum_normals_and_tangents,
    make_contact_line_of_lining,
)
from drumlin.response.resultants import integral_of_piecewise_polynomial
from drumlin_studies import closed_forms
from drumlin_studies.two_bodies import (
    STEEL_OF_KNOWN_ANSWER_CASES,
    InnerAndOuterBodyInContact,
    angles_graded_from_middle_to_both_ends,
    condense_body_to_contact_nodes,
    first_contact_set_from_coarse_problem,
    plane_mesh_of_closed_ring,
    plane_mesh_of_ring_sector,
    points_with_steps_growing_to_end,
)

pytestmark = pytest.mark.slow

R = 1.0
# Intended half-width of the Hertz contacts for radius 1: so narrow that the interface's curvature
# has no effect.
A = 0.005


def half_plane(sign, per_half=20, material=STEEL_OF_KNOWN_ANSWER_CASES, end=0.5):
    angles = angles_graded_from_middle_to_both_ends(2 * A, 4 * per_half, 1.35, end)
    return condense_body_to_contact_nodes(
        plane_mesh_of_ring_sector(
            angles, points_with_steps_growing_to_end(A / per_half, 1.3, 0.5), R, sign
        ),
        material,
    )


@pytest.fixture(scope="module")
def half_planes():
    """Two equal half-planes (thick sectors) whose meshes do not match."""
    return half_plane(-1, 20), half_plane(+1, 17)


@pytest.fixture(scope="module")
def hertz(half_planes):
    """Pressed along x, free along it."""
    return InnerAndOuterBodyInContact.couple_two_bodies_at_contact_nodes(*half_planes, motions="x")


def hertz_load(rho, E):
    """Force per width for the half-width A: a^2 = 4 P rho / (pi E*)."""
    return A**2 * math.pi * E / (4 * rho)


def test_hertz(hertz):
    """Hertz: a = sqrt(4 P rho/(pi E*)), p_0 = sqrt(P E*/(pi rho)), 1/E* = 2/E in plane stress.

    The gap is a parabola.
    """
    rho, E = 2.0, STEEL_OF_KNOWN_ANSWER_CASES.E / 2
    P = hertz_load(rho, E)
    s = R * hertz.contact_node_angles
    problem = hertz.frictionless_contact_problem(s**2 / (2 * rho), [P])
    found = active_set.solve_contact_problem(
        problem, first_contact_set_from_coarse_problem(problem)
    )
    p0 = math.sqrt(P * E / (math.pi * rho))
    exact = p0 * np.sqrt(np.maximum(1 - (s / A) ** 2, 0))
    assert found.steps <= 15
    assert found.p.max() == pytest.approx(p0, rel=2e-3)
    # Even elements do not resolve the square root at the ends.
    inside = np.abs(s) < 0.9 * A
    assert np.abs(found.p - exact)[inside].max() < 4e-3 * p0
    edge = s[found.p > 0]
    assert 0.5 * (edge.max() - edge.min()) == pytest.approx(A, abs=A / 20)
    assert integral_of_piecewise_polynomial(s, found.p, 2) == pytest.approx(P, rel=1e-4)


@pytest.mark.parametrize("share", [0.2, 0.5, 0.8])
def test_cattaneo_mindlin(hertz, half_planes, share):
    """Cattaneo-Mindlin: a tangential load Q < mu P sticks within c = a sqrt(1 - Q/(mu P)).

    Outside the contact slips; t follows by superposition.
    """
    rho, mu, E = 2.0, 0.3, STEEL_OF_KNOWN_ANSWER_CASES.E / 2
    P = hertz_load(rho, E)
    s = R * hertz.contact_node_angles
    problem = hertz.frictionless_contact_problem(s**2 / (2 * rho), [P])
    touching = active_set.solve_contact_problem(
        problem, first_contact_set_from_coarse_problem(problem)
    ).active
    hertz = InnerAndOuterBodyInContact.couple_two_bodies_at_contact_nodes(
        *half_planes, motions="xy"
    )
    rest = stick_slip.TractionsAndSlipsOfLastIncrement(np.zeros(len(s)), np.zeros(len(s)))
    start = np.where(touching, stick_slip.STICK, stick_slip.OPEN)
    first = stick_slip.solve_stick_slip_load_increment(
        hertz.frictional_contact_problem(s**2 / (2 * rho), [P, 0.0]), mu, rest, start
    )
    inner = np.abs(s) < 0.8 * A
    # Equal bodies have no traction from pressing alone.
    assert np.abs(first.t[inner]).max() < 5e-3 * first.p.max()
    increment = first
    for step in np.linspace(0, share, 5)[1:]:
        increment = stick_slip.solve_stick_slip_load_increment(
            hertz.frictional_contact_problem(s**2 / (2 * rho), [P, step * mu * P]),
            mu,
            increment.tractions_and_slips_for_next_increment,
            increment.state,
        )
    assert {stick_slip.OPEN, stick_slip.STICK} <= set(increment.state)
    slips = np.isin(increment.state, [stick_slip.FORWARD, stick_slip.BACKWARD])
    assert slips.any()
    c = A * math.sqrt(1 - share)
    sticks = s[increment.state == stick_slip.STICK]
    assert 0.5 * (sticks.max() - sticks.min()) == pytest.approx(c, abs=1.5 * A / 20)
    p0 = math.sqrt(P * E / (math.pi * rho))
    exact = (
        mu
        * p0
        * (
            np.sqrt(np.maximum(1 - (s / A) ** 2, 0))
            - c / A * np.sqrt(np.maximum(1 - (s / c) ** 2, 0))
        )
    )
    away = (np.abs(np.abs(s) - c) > 0.12 * A) & (np.abs(s) < 0.9 * A)
    assert np.abs(np.abs(increment.t) - exact)[away].max() < 0.02 * mu * p0
    assert abs(integral_of_piecewise_polynomial(s, increment.t, 2)) == pytest.approx(
        share * mu * P, rel=1e-3
    )


def disc_in_hole(eps, count=50):
    """A disc, loaded at its centre through a small core, in the hole of a large plate.

    The meshes of disc and plate do not match.

    The elements shrink towards the ends +-eps [rad] of the contact, where p ~ sqrt(distance).
    """

    def angles(count):
        inner = points_graded_to_both_ends(-eps, eps, count, eps / 2, 1 / 40)
        rest = points_graded_to_both_ends(eps, 2 * math.pi - eps, count, 0.4, eps / 200)
        return np.concatenate([inner, rest[1:-1]])

    disc = condense_body_to_contact_nodes(
        plane_mesh_of_closed_ring(
            angles(count), points_with_steps_growing_to_end(0.01, 1.18, 0.985), R, -1
        ),
        STEEL_OF_KNOWN_ANSWER_CASES,
    )
    plate = condense_body_to_contact_nodes(
        plane_mesh_of_closed_ring(
            angles(count + 7), points_with_steps_growing_to_end(0.01, 1.2, 39.0), R, 1
        ),
        STEEL_OF_KNOWN_ANSWER_CASES,
    )
    return InnerAndOuterBodyInContact.couple_two_bodies_at_contact_nodes(disc, plate, motions="x")


@pytest.mark.parametrize("half_angle", [20, 40, 60, 75, 85])
def test_disc_in_a_hole_of_the_same_material(half_angle):
    """Persson: p at the middle and in L2 (0.5 %), contact half-angle, over 20 to 85 deg."""
    b, Q = math.tan(math.radians(half_angle) / 2), 1e6
    pair = disc_in_hole(math.radians(half_angle))
    theta = pair.contact_node_angles
    gap = (
        closed_forms.dimensionless_persson_clearance_of_disc_in_hole(b)
        * Q
        / STEEL_OF_KNOWN_ANSWER_CASES.E
        * (1 - np.cos(theta))
    )
    problem = pair.frictionless_contact_problem(gap, [Q])
    found = active_set.solve_contact_problem(
        problem, first_contact_set_from_coarse_problem(problem)
    )
    exact = closed_forms.dimensionless_persson_pressure_of_disc_in_hole(b, theta) * Q / R
    middle = np.argmin(np.abs(theta))
    assert found.p[middle] == pytest.approx(exact[middle], rel=5e-3)
    error = math.sqrt(
        integral_of_piecewise_polynomial(theta, (found.p - exact) ** 2, 2)
        / integral_of_piecewise_polynomial(theta, exact**2, 2)
    )
    assert error < 5e-3
    touching = theta[found.p > 0]
    assert math.degrees(0.5 * (touching.max() - touching.min())) == pytest.approx(
        half_angle, rel=5e-3
    )
    assert found.steps <= 15


def ring_pair(count=48, other=60):
    """A ring held inside, pressed by a ring held outside, on meshes that do not match."""
    inner = condense_body_to_contact_nodes(
        plane_mesh_of_closed_ring(
            np.linspace(-math.pi, math.pi, count + 1)[:-1], np.linspace(0, 0.4, 5), R, -1
        ),
        STEEL_OF_KNOWN_ANSWER_CASES,
    )
    outer = condense_body_to_contact_nodes(
        plane_mesh_of_closed_ring(
            np.linspace(-math.pi, math.pi, other + 1)[:-1] + 0.01, np.linspace(0, 0.5, 6), R, 1
        ),
        STEEL_OF_KNOWN_ANSWER_CASES,
    )
    return inner, outer


def test_swapping_sides_changes_nothing_beyond_discretisation():
    """The pressure carried by the inner or by the outer ring's nodes: the same field."""
    inner, outer = ring_pair(120, 97)
    one, two = (
        InnerAndOuterBodyInContact.couple_two_bodies_at_contact_nodes(inner, outer),
        InnerAndOuterBodyInContact.couple_two_bodies_at_contact_nodes(outer, inner, sign=-1),
    )

    def gap(angle):
        return 1e-4 * (np.cos(angle) - 0.3)

    a = active_set.solve_contact_problem(
        one.frictionless_contact_problem(gap(one.contact_node_angles))
    )
    b = active_set.solve_contact_problem(
        two.frictionless_contact_problem(gap(two.contact_node_angles))
    )
    assert 0.2 < (a.p > 0).mean() < 0.8
    # The touching side of the disc is where the cosine is -1, at pi.
    theta = np.linspace(2.2, 4.0, 50) - math.pi
    theta = np.where(theta > 0, theta - math.pi, theta + math.pi)
    pa, pb = (
        np.interp(theta, x.contact_node_angles, f.p, period=2 * math.pi)
        for x, f in ((one, a), (two, b))
    )
    assert pa == pytest.approx(pb, abs=3e-3 * a.p.max())


def wavy(mean_share, m=40):
    """Two rings with a wavy gap: mean pressure and waviness by Westergaard's periodic contact.

    The rings are thick against the wave 2 pi/m, so that each wave sees half-planes; the mean
    pressure comes from an interference.
    """
    count = 12 * m
    angles = np.linspace(-math.pi, math.pi, count + 1)[:-1]
    depths = points_with_steps_growing_to_end(2 * math.pi / count, 1.25, 0.5)
    inner, outer = (
        condense_body_to_contact_nodes(
            plane_mesh_of_closed_ring(angles, depths, R, sign), STEEL_OF_KNOWN_ANSWER_CASES
        )
        for sign in (-1, 1)
    )
    pair = InnerAndOuterBodyInContact.couple_two_bodies_at_contact_nodes(inner, outer)
    soft = sum(
        abs(
            closed_forms.ring_displacement_per_harmonic_pressure(
                0, 1.0, held, STEEL_OF_KNOWN_ANSWER_CASES.E, STEEL_OF_KNOWN_ANSWER_CASES.nu
            )
        )
        for held in (0.5, 1.5)
    )
    amplitude = 1e-6
    p_star = math.pi * (STEEL_OF_KNOWN_ANSWER_CASES.E / 2) * amplitude * m / (2 * math.pi * R) * 1.0
    gap = (
        amplitude * (1 - np.cos(m * pair.contact_node_angles))
        - mean_share * p_star * soft
        - amplitude
    )
    return pair, active_set.solve_contact_problem(pair.frictionless_contact_problem(gap)), p_star


def test_westergaard_full_contact():
    """p = p_mean + p* cos(2 pi x/lambda), p* = pi E* amplitude/lambda, as long as p_mean > p*."""
    pair, found, p_star = wavy(1.5)
    m = 40
    exact = found.p.mean() + p_star * np.cos(m * pair.contact_node_angles)
    assert (found.p > 0).all()
    assert found.p == pytest.approx(exact, abs=0.01 * p_star)


def test_westergaard_partial_contact():
    """Partial contact of a wavy gap has Westergaard's pressure.

    p = 2 p_mean cos(psi)/sin^2(psi_a) sqrt(sin^2 psi_a - sin^2 psi), psi = pi x/lambda, sin^2 psi_a
    = p_mean/p*.
    """
    pair, found, p_star = wavy(0.2)
    m = 40
    mean = integral_of_piecewise_polynomial(pair.contact_node_angles, found.p, 2) / (
        pair.contact_node_angles[-1] - pair.contact_node_angles[0]
    )
    psi = 0.5 * (np.mod(m * pair.contact_node_angles + math.pi, 2 * math.pi) - math.pi)
    share = mean / p_star
    assert 0.05 < share < 0.95
    exact = 2 * mean * np.cos(psi) / share * np.sqrt(np.maximum(share - np.sin(psi) ** 2, 0))
    inside = np.sin(psi) ** 2 < 0.7 * share
    assert found.p[inside] == pytest.approx(exact[inside], abs=0.03 * exact.max())
    assert not (found.p > 0).all()


def test_lame_ring_under_inner_pressure():
    """a = .1, b = .2 m, p = 60 MPa, E = 200 GPa, nu = .3: u(a) = 5.90e-5, u(b) = 4.00e-5 m."""
    mesh = plane_mesh_of_closed_ring(
        np.linspace(-math.pi, math.pi, 33)[:-1], np.linspace(0, 0.1, 7), 0.1, 1
    )
    basis = nodal_basis_of_mesh(mesh)
    K = sparse_stiffness_of_body(
        basis, {"body": ElasticLayer.make_layer_in_plane_stress(Material(E=200e9, nu=0.3), 0.02)}
    ).tolil()
    line = make_contact_line_of_lining(basis, mesh.boundaries["contact"], 0.0)
    coupling = coupling_matrices_of_contact_line(
        line, 0.02, function_that_returns_drum_normals_and_tangents(1)
    )
    f = np.zeros(2 * basis.N)
    force = (coupling.N.T @ np.full(len(line.nodes), 60e6)).reshape(-1, 2)
    f[2 * line.nodes], f[2 * line.nodes + 1] = force.T
    x, y = basis.doflocs
    # statically determinate supports of an axisymmetric state: on the axes nodes move along them
    # only
    on_x, on_y = np.flatnonzero(np.abs(y) < 1e-9), np.flatnonzero(np.abs(x) < 1e-9)
    fixed = np.concatenate([2 * on_x + 1, 2 * on_y])
    free = np.setdiff1d(np.arange(2 * basis.N), fixed)
    u = np.zeros(2 * basis.N)
    K = K.tocsc()
    u[free] = spsolve(K[free][:, free].tocsc(), f[free])
    radial_u = (u[0::2] * x + u[1::2] * y) / np.hypot(x, y)
    r = np.hypot(x, y)
    assert radial_u[r < 0.1 + 1e-9] == pytest.approx(
        np.full((r < 0.1 + 1e-9).sum(), 5.90e-5), rel=2e-4
    )
    assert radial_u[r > 0.2 - 1e-9] == pytest.approx(
        np.full((r > 0.2 - 1e-9).sum(), 4.00e-5), rel=2e-4
    )
