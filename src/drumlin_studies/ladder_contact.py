"""Cases of the benchmark ladder on contact without sticking.

The bodies in contact are half-planes, discs, rings, thin layers, and layers whose sharp edges
slide.
"""

import math
from functools import cache, partial
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.fields import Material
from drumlin.contact import active_set
from drumlin.contact.equations import ContactProblem
from drumlin.fem.mesh.grading import points_graded_to_both_ends
from drumlin.response.resultants import integral_of_piecewise_polynomial
from drumlin_studies import closed_forms
from drumlin_studies.ladder_case import (
    TOLERANCE_REASON_DISCRETISATION,
    TOLERANCE_REASON_MODEL_LIMIT,
    KnownAnswerCase,
)
from drumlin_studies.two_bodies import (
    STEEL_OF_KNOWN_ANSWER_CASES,
    BodyCondensedToContactNodes,
    InnerAndOuterBodyInContact,
    angles_graded_from_middle_to_both_ends,
    condense_body_to_contact_nodes,
    first_contact_set_from_coarse_problem,
    plane_mesh_of_closed_ring,
    plane_mesh_of_ring_sector,
    points_with_steps_growing_to_end,
)

HALF_PLANE_CONTACT_HALF_WIDTH = 0.005
"""Half-width of the contact between half-planes [m].

Thick sectors of radius 1 m take the place of half-planes. The contact is so short compared with
this radius that the curvature of the sectors has no effect on the results.
"""
RELATIVE_CURVATURE_RADIUS_OF_HALF_PLANES = 2.0
"""Relative radius of curvature of the contact between half-planes [m]."""
BONDED_THIN_LINING_MATERIAL = Material(E=3e8, nu=0.25)
"""Material of the thin lining on a rigid back."""
NUMBER_OF_WAVES_AROUND_WAVY_RING = 40
"""Number of waves around the circumference of the ring with a wavy surface."""


def condensed_half_plane_body(
    sign: int, per_half: int, material: Material = STEEL_OF_KNOWN_ANSWER_CASES
) -> BodyCondensedToContactNodes:
    """A thick sector of radius 1 m that stands for a half-plane, condensed to its contact nodes.

    Parameters
    ----------
    sign : int
        1 for a body outside the circle of radius 1 m, -1 for a body inside.
    per_half : int
        Number of elements of equal length in the half-width of the contact.
    material : Material
        Material of the body.
    """
    angles = angles_graded_from_middle_to_both_ends(
        2 * HALF_PLANE_CONTACT_HALF_WIDTH, 4 * per_half, 1.35, 0.5
    )
    return condense_body_to_contact_nodes(
        plane_mesh_of_ring_sector(
            angles,
            points_with_steps_growing_to_end(HALF_PLANE_CONTACT_HALF_WIDTH / per_half, 1.3, 0.5),
            1.0,
            sign,
        ),
        material,
    )


def solve_nodal_contact_pressures(problem: ContactProblem) -> Floats:
    """The nodal pressures (n,) [Pa] that solve a contact problem by drumlin's active-set method."""
    return active_set.solve_contact_problem(
        problem, first_contact_set_from_coarse_problem(problem)
    ).p


def _peak_pressure_over_hertz() -> float:
    """Peak pressure between two equal half-planes, divided by Hertz's closed form."""
    # Under this load Hertz's formula gives a contact of HALF_PLANE_CONTACT_HALF_WIDTH.
    load = (
        HALF_PLANE_CONTACT_HALF_WIDTH**2
        * math.pi
        * STEEL_OF_KNOWN_ANSWER_CASES.E
        / 2
        / (4 * RELATIVE_CURVATURE_RADIUS_OF_HALF_PLANES)
    )
    pair = InnerAndOuterBodyInContact.couple_two_bodies_at_contact_nodes(
        condensed_half_plane_body(-1, 16), condensed_half_plane_body(1, 13), motions="x"
    )
    p = solve_nodal_contact_pressures(
        pair.frictionless_contact_problem(
            pair.contact_node_angles**2 / (2 * RELATIVE_CURVATURE_RADIUS_OF_HALF_PLANES), [load]
        )
    )
    return float(
        p.max()
        / closed_forms.hertz_half_width_and_peak_pressure(
            load, RELATIVE_CURVATURE_RADIUS_OF_HALF_PLANES, STEEL_OF_KNOWN_ANSWER_CASES.E / 2
        )[1]
    )


class PeakPressureAndContactHalfWidth(NamedTuple):
    """The peak pressure [N/mm^2] and the half-width [mm] of a contact."""

    peak: float
    half_width: float


@cache
def _peak_pressure_and_half_width_of_cylinder() -> PeakPressureAndContactHalfWidth:
    """Peak pressure and half-width of the contact of a steel cylinder on aluminium.

    The cylinder has the radius 50 mm and carries 35 kN on each millimetre of its length. The
    benchmark is in plane strain, which equals plane stress with E/(1 - nu^2) and nu/(1 - nu).
    Lengths are scaled so that the half-width of the contact is HALF_PLANE_CONTACT_HALF_WIDTH.
    """
    steel = Material(E=210e9 / (1 - 0.3**2), nu=0.3 / 0.7)
    aluminium = Material(E=70e9 / (1 - 0.3**2), nu=0.3 / 0.7)
    scale = 6.21e-3 / HALF_PLANE_CONTACT_HALF_WIDTH
    load = 35e3 / 1e-3 / scale
    pair = InnerAndOuterBodyInContact.couple_two_bodies_at_contact_nodes(
        condensed_half_plane_body(-1, 16, steel),
        condensed_half_plane_body(1, 13, aluminium),
        motions="x",
    )
    s = pair.contact_node_angles
    p = solve_nodal_contact_pressures(
        pair.frictionless_contact_problem(s**2 / (2 * 0.05 / scale), [load])
    )
    # By Hertz's formula p^2 falls linearly with s^2 and vanishes at the half-width. A line is
    # therefore fitted to the values of p^2 away from the ends of the contact, where p is exact.
    near = np.abs(s) < 0.8 * HALF_PLANE_CONTACT_HALF_WIDTH
    slope, top = np.polyfit(s[near] ** 2, p[near] ** 2, 1)
    return PeakPressureAndContactHalfWidth(
        float(p.max() * 1e-6), math.sqrt(-top / slope) * scale * 1e3
    )


def _mean_punch_pressure_over_closed_form() -> float:
    """Pressure under a rigid flat punch over its closed form, averaged over the middle half."""
    pair = InnerAndOuterBodyInContact.couple_two_bodies_at_contact_nodes(
        condensed_half_plane_body(-1, 24), None, motions="x"
    )
    s = pair.contact_node_angles
    load = 1e6
    # Beside the punch a gap of 1 m keeps the half-plane out of contact.
    p = solve_nodal_contact_pressures(
        pair.frictionless_contact_problem(
            np.where(np.abs(s) < HALF_PLANE_CONTACT_HALF_WIDTH * (1 + 1e-9), 0.0, 1.0), [load]
        )
    )
    inside = np.abs(s) < 0.5 * HALF_PLANE_CONTACT_HALF_WIDTH
    return float(
        np.mean(
            p[inside]
            / closed_forms.flat_punch_pressure(load, HALF_PLANE_CONTACT_HALF_WIDTH, s[inside])
        )
    )


class DiscInHoleResultsOverPersson(NamedTuple):
    """Results of a loaded disc in a hole, each divided by its value by Persson's closed form.

    The results are the pressure in the middle of the contact and the half-angle of the contact.
    """

    pressure: float
    half_angle: float


@cache
def _disc_in_hole_results_over_persson(half_angle: float) -> DiscInHoleResultsOverPersson:
    """Pressure and contact angle of a loaded disc in a hole, divided by Persson's closed form.

    The hole is in a large plate. The clearance is chosen so that the closed form gives the contact
    the half-angle `half_angle` [deg].
    """
    eps, load = math.radians(half_angle), 1e6
    # The disc and the edge of the hole have different meshes, fine at the ends of the contact.
    disc = condense_body_to_contact_nodes(
        plane_mesh_of_closed_ring(
            _node_angles_around_circle(30, eps),
            points_with_steps_growing_to_end(0.01, 1.3, 0.985),
            1.0,
            -1,
        ),
        STEEL_OF_KNOWN_ANSWER_CASES,
    )
    plate = condense_body_to_contact_nodes(
        plane_mesh_of_closed_ring(
            _node_angles_around_circle(36, eps),
            points_with_steps_growing_to_end(0.01, 1.3, 39.0),
            1.0,
            1,
        ),
        STEEL_OF_KNOWN_ANSWER_CASES,
    )
    pair = InnerAndOuterBodyInContact.couple_two_bodies_at_contact_nodes(disc, plate, motions="x")
    b = math.tan(eps / 2)
    clearance = closed_forms.dimensionless_persson_clearance_of_disc_in_hole(b)
    clearance *= load / STEEL_OF_KNOWN_ANSWER_CASES.E
    gap = clearance * (1 - np.cos(pair.contact_node_angles))
    p = solve_nodal_contact_pressures(pair.frictionless_contact_problem(gap, [load]))
    middle = int(np.argmin(np.abs(pair.contact_node_angles)))
    touching = pair.contact_node_angles[p > 0]
    exact = (
        closed_forms.dimensionless_persson_pressure_of_disc_in_hole(
            b, pair.contact_node_angles[[middle]]
        )[0]
        * load
    )
    return DiscInHoleResultsOverPersson(
        float(p[middle] / exact), float(np.ptp(touching) / (2 * eps))
    )


def _node_angles_around_circle(count: int, eps: float) -> Floats:
    """Angles [rad] of nodes around a circle, closest together at the ends of a contact.

    The contact reaches from -eps to eps [rad]. It has `count` steps between nodes, and the rest of
    the circle has `count` steps as well.
    """
    inner = points_graded_to_both_ends(-eps, eps, count, eps / 2, 1 / 40)
    outer = points_graded_to_both_ends(eps, 2 * math.pi - eps, count, 0.4, eps / 200)
    return np.concatenate([inner, outer[1:-1]])


def _wavy_ring_pressure_over_westergaard(share: float) -> float:
    """Pressure at the crests of a wavy ring in another ring, divided by Westergaard's closed form.

    `share` is about the mean pressure divided by the smallest mean pressure p* with full contact.
    """
    count = 12 * NUMBER_OF_WAVES_AROUND_WAVY_RING
    angles = np.linspace(-math.pi, math.pi, count + 1)[:-1]
    depths = points_with_steps_growing_to_end(2 * math.pi / count, 1.4, 0.5)
    inner = condense_body_to_contact_nodes(
        plane_mesh_of_closed_ring(angles, depths, 1.0, -1), STEEL_OF_KNOWN_ANSWER_CASES
    )
    outer = condense_body_to_contact_nodes(
        plane_mesh_of_closed_ring(angles, depths, 1.0, 1), STEEL_OF_KNOWN_ANSWER_CASES
    )
    pair = InnerAndOuterBodyInContact.couple_two_bodies_at_contact_nodes(inner, outer)
    height = 1e-6
    E, nu = STEEL_OF_KNOWN_ANSWER_CASES.E, STEEL_OF_KNOWN_ANSWER_CASES.nu
    full = math.pi * E / 2 * height * NUMBER_OF_WAVES_AROUND_WAVY_RING / (2 * math.pi)
    # Overlap [m] of the two rings that causes a uniform pressure of 1 Pa: the sum of the radial
    # displacements with which the rings give way.
    soft = sum(
        abs(closed_forms.ring_displacement_per_harmonic_pressure(0, 1.0, held, E, nu))
        for held in (0.5, 1.5)
    )
    p = active_set.solve_contact_problem(
        pair.frictionless_contact_problem(
            -height * np.cos(NUMBER_OF_WAVES_AROUND_WAVY_RING * pair.contact_node_angles)
            - share * full * soft
        )
    ).p
    # Westergaard's closed form needs the mean pressure, which is taken from the computed solution.
    mean = float(
        integral_of_piecewise_polynomial(pair.contact_node_angles, p, 2)
        / np.ptp(pair.contact_node_angles)
    )
    crests = np.abs(np.cos(NUMBER_OF_WAVES_AROUND_WAVY_RING * pair.contact_node_angles) - 1) < 1e-9
    return float(
        p[crests].mean()
        / closed_forms.westergaard_pressure_of_wavy_surface(mean, full, np.array(0.0))
    )


@cache
def _make_concentric_rings_in_contact() -> InnerAndOuterBodyInContact:
    """Two concentric rings in contact at the radius 1, with contact nodes that do not match.

    The inner ring is fixed at the radius 0.6, the outer ring at the radius 1.4.
    """
    angles = np.linspace(-math.pi, math.pi, 49)[:-1]
    inner = condense_body_to_contact_nodes(
        plane_mesh_of_closed_ring(angles, np.linspace(0, 0.4, 6), 1.0, -1),
        STEEL_OF_KNOWN_ANSWER_CASES,
    )
    angles = np.linspace(-math.pi, math.pi, 61)[:-1]
    outer = condense_body_to_contact_nodes(
        plane_mesh_of_closed_ring(angles + 0.01, np.linspace(0, 0.4, 7), 1.0, 1),
        STEEL_OF_KNOWN_ANSWER_CASES,
    )
    return InnerAndOuterBodyInContact.couple_two_bodies_at_contact_nodes(inner, outer)


class PressureMeanAndHarmonic(NamedTuple):
    """The mean of the pressure around a ring, and the amplitude of one of its harmonics [Pa]."""

    mean: float
    harmonic: float


@cache
def _pressure_harmonics_of_pressed_rings(n: int) -> PressureMeanAndHarmonic:
    """Mean and cos(n theta) amplitude [Pa] of the computed pressure between two rings.

    The overlap of the rings is chosen so that the exact pressure is 3 MPa + 1 MPa cos(n theta).
    """
    pair = _make_concentric_rings_in_contact()
    angle = pair.contact_node_angles

    def gap_amplitude_per_harmonic_pressure(k: int) -> float:
        """Amplitude [m/Pa] of the unloaded gap that causes the pressure cos(k theta)."""
        E, nu = STEEL_OF_KNOWN_ANSWER_CASES.E, STEEL_OF_KNOWN_ANSWER_CASES.nu
        inner = closed_forms.ring_displacement_per_harmonic_pressure(k, 1.0, 0.6, E, nu)
        return inner - closed_forms.ring_displacement_per_harmonic_pressure(k, 1.0, 1.4, E, nu)

    soft = [gap_amplitude_per_harmonic_pressure(0), gap_amplitude_per_harmonic_pressure(n)]
    p = active_set.solve_contact_problem(
        pair.frictionless_contact_problem(3e6 * soft[0] + 1e6 * soft[1] * np.cos(n * angle))
    ).p
    # A least-squares fit to the nodal pressures gives the mean and the amplitudes of cosine and
    # sine.
    columns = np.column_stack([np.ones_like(angle), np.cos(n * angle), np.sin(n * angle)])
    fit = np.linalg.lstsq(columns, p, rcond=None)[0]
    return PressureMeanAndHarmonic(float(fit[0]), float(fit[1]))


def _computed_pressure_per_indentation_of_lining() -> float:
    """Pressure per compression [Pa/m] in the middle of a thin lining on a rigid back."""
    thickness, depth = 1e-3, 1e-6
    angles = np.linspace(-0.03, 0.03, 61)
    pair = InnerAndOuterBodyInContact.couple_two_bodies_at_contact_nodes(
        condense_body_to_contact_nodes(
            plane_mesh_of_ring_sector(angles, np.linspace(0, thickness, 4), 1.0, -1),
            BONDED_THIN_LINING_MATERIAL,
        ),
        None,
    )
    p = active_set.solve_contact_problem(
        pair.frictionless_contact_problem(np.full(len(pair.contact_node_angles), -depth))
    ).p
    return float(p[len(p) // 2] / depth)


@cache
def _make_lining_strip_on_rigid_back(nu: float) -> InnerAndOuterBodyInContact:
    """A lining with sharp edges on a rigid back, in contact with a rigid body.

    Towards the ends and the face of the lining the elements shrink to some 1e-7 of the lining's
    thickness.
    """
    fine = points_with_steps_growing_to_end(1e-8, 1.45, 0.1)
    angles = np.concatenate([-0.1 + fine, (0.1 - fine)[::-1][1:]])
    return InnerAndOuterBodyInContact.couple_two_bodies_at_contact_nodes(
        condense_body_to_contact_nodes(
            plane_mesh_of_ring_sector(
                angles, points_with_steps_growing_to_end(1e-8, 1.45, 0.05), 1.0, -1
            ),
            Material(E=3e8, nu=nu),
        ),
        None,
    )


def _displacement_exponent_at_sliding_edge(mu: float, nu: float) -> float:
    """The exponent lambda of p ~ r^(lambda - 1) at the edge where the drum enters the contact.

    r is the distance from the edge, which is sharp and belongs to a lining on a rigid back.
    """
    pair, thickness = _make_lining_strip_on_rigid_back(nu), 0.05
    matrix = pair.pressed.T @ (pair.pressed + mu * pair.dragged)
    n = len(pair.contact_node_angles)
    q = pair.coupling.M @ np.full(n, -1e-4 * thickness)
    p = active_set.solve_contact_problem(
        ContactProblem(matrix, q, np.zeros((n, 0)), np.zeros((0, n)), np.zeros(0))
    ).p
    r = pair.contact_node_angles - pair.contact_node_angles[0]
    # lambda - 1 is the slope of log p against log r, fitted away from the smallest elements.
    near = (r > 1e-5 * thickness) & (r < 3e-3 * thickness)
    return float(1 + np.polyfit(np.log(r[near]), np.log(p[near]), 1)[0])


KONTER_CITATION = "Konter, Advanced FE contact benchmarks (NAFEMS 2006), 2D cylinder; Hertz"
"""Citation of the benchmark of a cylinder on a block, for the ladder's table."""
MICHELL, PERSSON = (
    "Michell 1899, rings held at .6 and 1.4",
    "Persson 1964; Ciavarella & Decuzzi 2001",
)
"""Citations for rings and for a disc in a hole, for the ladder's table."""
KNOWN_ANSWER_CASES_ON_CONTACT_WITHOUT_STICKING = (
    KnownAnswerCase(
        family="equal cylinders",
        shows="contact of two bodies",
        source="Hertz 1881",
        quantity="p_0 over the closed form",
        expected=1.0,
        tolerance=4e-3,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=_peak_pressure_over_hertz,
    ),
    KnownAnswerCase(
        family="cylinder on a block",
        shows="contact of two materials",
        source=KONTER_CITATION,
        quantity="peak pressure [N/mm^2]",
        expected=3585.37,
        tolerance=1e-2,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=lambda: _peak_pressure_and_half_width_of_cylinder().peak,
    ),
    KnownAnswerCase(
        family="cylinder on a block",
        shows="contact of two materials",
        source=KONTER_CITATION,
        quantity="half-width [mm]",
        expected=6.21,
        tolerance=1e-2,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=lambda: _peak_pressure_and_half_width_of_cylinder().half_width,
    ),
    KnownAnswerCase(
        family="rigid flat punch",
        shows="contact with a sharp end",
        source="Sadowsky 1928",
        quantity="p over the closed form, |x| < a/2",
        expected=1.0,
        tolerance=2e-2,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=_mean_punch_pressure_over_closed_form,
    ),
    *(
        KnownAnswerCase(
            family="disc in a hole",
            shows="conforming contact",
            source=PERSSON,
            quantity=f"p(0) over the closed form, {angle} deg",
            expected=1.0,
            tolerance=1e-2,
            tier=TOLERANCE_REASON_DISCRETISATION,
            found=partial(lambda angle: _disc_in_hole_results_over_persson(angle).pressure, angle),
        )
        for angle in (30, 75)
    ),
    KnownAnswerCase(
        family="disc in a hole",
        shows="conforming contact",
        source=PERSSON,
        quantity="half-angle of contact over the closed form, 75 deg",
        expected=1.0,
        tolerance=1e-2,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=lambda: _disc_in_hole_results_over_persson(75).half_angle,
    ),
    KnownAnswerCase(
        family="wavy surface, full contact",
        shows="contact without ends",
        source="Westergaard 1939",
        quantity="p at crests over the closed form",
        expected=1.0,
        tolerance=1e-2,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=partial(_wavy_ring_pressure_over_westergaard, 1.5),
    ),
    KnownAnswerCase(
        family="wavy surface, partial contact",
        shows="many contacts",
        source="Westergaard 1939",
        quantity="p at crests over the closed form",
        expected=1.0,
        tolerance=3e-2,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=partial(_wavy_ring_pressure_over_westergaard, 0.2),
    ),
    KnownAnswerCase(
        family="ring pressed into a ring",
        shows="patch test on the arc, other meshes",
        source="Lame 1852",
        quantity="mean p [Pa]",
        expected=3e6,
        tolerance=2e-4,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=lambda: _pressure_harmonics_of_pressed_rings(2).mean,
    ),
    KnownAnswerCase(
        family="rings pressed by p_0 + p_1 cos 2 theta",
        shows="contact of rings, other meshes",
        source=MICHELL,
        quantity="p_1 [Pa]",
        expected=1e6,
        tolerance=5e-4,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=lambda: _pressure_harmonics_of_pressed_rings(2).harmonic,
    ),
    KnownAnswerCase(
        family="eccentric ring in a ring",
        shows="contact of rings, other meshes",
        source=MICHELL + ", off centre: cos theta",
        quantity="p_1 [Pa]",
        expected=1e6,
        tolerance=5e-4,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=lambda: _pressure_harmonics_of_pressed_rings(1).harmonic,
    ),
    KnownAnswerCase(
        family="thin bonded lining",
        shows="lining as springs",
        source="E/((1 - nu^2) t) in the limit",
        quantity="stiffness [Pa/m]",
        expected=closed_forms.pressure_per_compression_of_thin_bonded_layer(
            BONDED_THIN_LINING_MATERIAL.E, BONDED_THIN_LINING_MATERIAL.nu, 1e-3
        ),
        tolerance=5e-3,
        tier=TOLERANCE_REASON_MODEL_LIMIT,
        found=_computed_pressure_per_indentation_of_lining,
    ),
    *(
        KnownAnswerCase(
            family="sharp sliding edge",
            shows="singular pressure",
            source="eigenvalue of the corner (Williams 1952)",
            quantity=f"lambda, nu = {nu}, mu = {mu}",
            expected=closed_forms.displacement_exponent_at_sliding_corner(mu, nu),
            tolerance=1e-2,
            tier=TOLERANCE_REASON_DISCRETISATION,
            found=partial(_displacement_exponent_at_sliding_edge, mu, nu),
        )
        for nu, mu in ((0.1, 0.3), (0.3, 0.3), (0.3, 0.5), (0.45, 0.3))
    ),
)
"""The cases of the ladder on contact without sticking."""
