"""Shoes with a width against closed forms in three dimensions: Lame's ring and Hertz's contact."""

import math

import numpy as np
import pytest

from drumlin.contact import active_set
from drumlin.contact.equations import ContactProblem
from drumlin.fem.analysis.solid_fields import contact_face_of_solid_shoe
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.hp.division import KindOfSingularPoint, SingularPoint, divide_shoe_into_hp_elements
from drumlin.fem.hp.element import reference_element_of_degree
from drumlin.fem.hp.shoe import node_positions_in_each_element_of_row
from drumlin.fem.width.columns import (
    ConditionAtEdgeFarthestFromContact,
    condense_element_columns_of_any_shape,
    indices_of_unknowns_along_node_row,
    layers_of_element_column_from_half_widths,
)
from drumlin.fem.width.functions import (
    FunctionsAcrossWidth,
    integrals_of_function_products_over_width,
)
from drumlin.fem.width.integrals import LameConstants, cross_section_integrals_of_any_shape
from drumlin.fem.width.prepare import condense_and_couple_shoe_with_width
from flat_pads import pad


@pytest.mark.parametrize("q", [1, 3])
def test_a_ring_under_outer_pressure_moves_as_lame_says(q):
    """A sector of a ring with free faces: u_r = A r + B/r, u_z = -nu/E (s_r + s_theta) z.

    This is plane stress for any width (Lame 1852; Timoshenko & Goodier, art. 28).
    """
    E, nu, pressure, a, b, half, p = 2.0, 0.3, 0.7, 0.6, 1.0, 0.5, 6
    lame = LameConstants(E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu)))
    functions = FunctionsAcrossWidth((0.0, half), q)
    stack = layers_of_element_column_from_half_widths(
        functions, (half, half), p, contact=True, back=ConditionAtEdgeFarthestFromContact.FREE
    )
    phi = 0.3 * node_positions_in_each_element_of_row(np.array([-1.0, 1.0]), p)[0]
    r = node_positions_in_each_element_of_row(np.array([b, 0.8, a]), p)
    xy = np.array([r[:, :, None] * np.cos(phi), r[:, :, None] * np.sin(phi)])
    xy = xy.reshape(2, 2, -1)[:, :, reference_element_of_degree(p).order]
    parts = [cross_section_integrals_of_any_shape(xy[:, k][None], lame, p) for k in range(2)]
    widths = [integrals_of_function_products_over_width(functions, half)] * 2
    (column,) = condense_element_columns_of_any_shape(parts, widths, stack)

    size = -pressure * b**2 / (b**2 - a**2)
    radii = np.append(r[:, :-1].ravel(), a)

    def displacement(unknown):
        """Lame's factor of the function of an unknown: only 1 and z take part."""
        if unknown.function > 0:
            return 0.0
        if unknown.z == 1:
            return -2 * nu / E * size * half
        at, angle = radii[unknown.row], phi[unknown.along // 2]
        radial = size / E * ((1 - nu) * at + (1 + nu) * a**2 / at)
        return radial * (math.sin(angle) if unknown.along % 2 else math.cos(angle))

    row = indices_of_unknowns_along_node_row(p)
    left = stack.unknowns_on_left_or_right_side_of_column(row.left)
    right = stack.unknowns_on_left_or_right_side_of_column(row.right)
    # The unknowns of the contact stand node by node, x and y of a function together.
    contact = stack.unknowns_of_contact_nodes(row)
    contact.sort(key=lambda own: (own.along // 2, own.function, own.along % 2))
    u = np.array([displacement(own) for own in (*left, *contact, *right)])
    forces = column.K @ u
    # The pressure on the arc does virtual work on the functions of the inner contact nodes; the
    # sides are loaded by s_theta.
    x, weights = np.polynomial.legendre.leggauss(p + 2)
    nodes = phi / phi[-1]
    shape = []
    for node in nodes:
        others = nodes[nodes != node]
        shape.append(np.prod((x[:, None] - others) / (node - others), axis=1))
    angles, even = phi[-1] * x, widths[0].even[0]
    wanted = []
    for own in contact:
        direction = np.sin(angles) if own.along % 2 else np.cos(angles)
        arc = b * phi[-1] * (weights * shape[own.along // 2] * direction).sum()
        wanted.append(-pressure * arc * even[own.function])
    inside = np.array([0 < own.along // 2 < p for own in contact])
    found = forces[len(left) : len(left) + len(contact)]
    np.testing.assert_allclose(found[inside], np.array(wanted)[inside], atol=1e-8 * pressure)


@pytest.mark.slow
@pytest.mark.parametrize("nu", [0.0, 0.3])
def test_a_sphere_presses_as_hertz_says(nu):
    """A rigid sphere on a block: F = 4/3 E/(1 - nu^2) a^3/R, p = 3 F/(2 pi a^2) sqrt(1 - r^2/a^2).

    The block is six radii a of the contact high and twice as wide (Hertz 1882; Johnson, Contact
    Mechanics, eq. 3.39, 4.22 to 4.24). The contact is a circle, and pieces and columns are squares.
    """
    a, E, height = 1e-3, 3e8, 6e-3
    lining = {
        "start": -height,
        "end": height,
        "thickness": height,
        "width": 2 * height,
        "material": {"E": E, "nu": nu},
    }
    brake = pad("hinge", mu=0.0, lining=lining)
    shoe = brake.shoes[0]
    points = [
        SingularPoint(
            at / brake.surface_coordinate_per_phi,
            2 * a / brake.surface_coordinate_per_phi,
            KindOfSingularPoint.END,
        )
        for at in (-a, a)
    ]
    division = divide_shoe_into_hp_elements(
        shoe, brake.size, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1], points
    )
    functions = FunctionsAcrossWidth((0.0, a / 2, a, 2 * a, height), 4)
    body = condense_and_couple_shoe_with_width(shoe, brake.size, division, functions, False, {})
    face, coupling = contact_face_of_solid_shoe(body), body.coupling
    half = body.condensed.half_flexibility_under_nodal_forces(coupling.N.T)
    x = face.xy[0]
    z = np.tile(face.node_distances_from_mid_plane, len(face.line.nodes))
    r = np.hypot(x, z)
    load, area = 4 / 3 * E / (1 - nu**2) * a**3, coupling.areas_of_contact_nodes
    # The sphere has a radius of 1 m, so that the gap is r^2/2, and the total force is given.
    problem = ContactProblem(
        A=half.T @ half,
        q=coupling.M @ (r**2 / 2),
        B=-area[:, None],
        C=area[None],
        h=np.array([load]),
    )
    p = active_set.solve_contact_problem(problem, r < 1.05 * a).p
    peak = 1.5 * load / (math.pi * a**2)
    exact = peak * np.sqrt(np.maximum(1 - (r / a) ** 2, 0.0))
    off = p - exact
    distance = math.sqrt(off @ coupling.M @ off / (exact @ coupling.M @ exact))
    assert p[r.argmin()] == pytest.approx(peak, rel=5e-3)
    assert distance < 0.04
