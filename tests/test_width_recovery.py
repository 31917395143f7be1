"""Displacements of all nodes of shoes with a width, against closed forms and plane stress."""

from functools import partial
from itertools import product

import numpy as np
import pytest

from conftest import partly
from drumlin.base.lapack import dtrtrs
from drumlin.brake.file import vary
from drumlin.fem.analysis.solid_fields import (
    contact_face_of_solid_shoe,
    displacement_unknowns_of_solid_shoe,
)
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.hp.division import divide_shoe_into_hp_elements
from drumlin.fem.hp.element import reference_element_of_degree
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.displacements import nodal_displacements_of_shoe
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.substructure.body import rigid_body_displacements_of_nodes
from drumlin.fem.width.columns import (
    ConditionAtEdgeFarthestFromContact,
    column_stiffnesses_without_inner_element_unknowns,
    condensation_plan_of_column,
    displacements_inside_elements,
    indices_of_unknowns_along_node_row,
    layers_of_element_column_from_half_widths,
    unknowns_of_element_column_by_role_in_condensation,
)
from drumlin.fem.width.functions import (
    FunctionsAcrossWidth,
    functions_across_width_of_shoe,
    integrals_of_function_products_over_width,
    matrix_from_node_values_to_function_factors,
)
from drumlin.fem.width.integrals import LameConstants, cross_section_integrals_of_any_shape
from drumlin.fem.width.prepare import prepare_model_with_shoe_widths
from drumlin.fem.width.recovery import EliminatedUnknownsOfShoeWithWidth
from drumlin.response.balance import brake_with_forces_of_response
from sections import without_contraction
from wide_shoes import HELD

ROUND_OFF = 1e-8
"""Displacements of slender shoes lose up to eight of sixteen digits to rigid-body motions."""


def prepared(kind, degree):
    return prepare_model_with_shoe_widths(
        HELD[kind](), REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], degree
    )


def contact_displacements(unknowns, u):
    """Displacements (2n, m) of the nodes of the face from the unknowns of the section's nodes."""
    to_functions = matrix_from_node_values_to_function_factors(
        unknowns.functions, unknowns.layers.halves[0]
    )
    count, nodes = len(to_functions), unknowns.division.contact_nodes
    own = u.reshape(unknowns.grid.N, unknowns.unknowns_per_node, -1)[:nodes, : 2 * count]
    own = own.reshape(nodes, count, 2, -1)
    at_nodes = np.einsum("jk,nkcm->njcm", np.linalg.inv(to_functions), own)
    return at_nodes.reshape(2 * nodes * count, -1)


@pytest.mark.parametrize(
    ("kind", "degree"), partly(product(HELD, (0, 3)), [("pad", 3), ("rigid", 0)])
)
def test_recovered_displacements_of_the_face_are_those_of_the_condensed_body(kind, degree):
    body = prepared(kind, degree).bodies[0]
    inner, condensed = displacement_unknowns_of_solid_shoe(body), body.condensed
    # Random forces on the face, motions of the frame and actuations.
    random = np.random.default_rng(1)
    nodal = random.standard_normal((len(condensed.L_cc), 2))
    loads = random.standard_normal((3, 2))
    found = contact_displacements(
        inner, condensed.nodal_displacements_in_load_cases(nodal, np.zeros((3, 2)), loads)
    )
    forces = nodal + condensed.load_on_contact @ loads
    half = dtrtrs(condensed.L_cc, forces, lower=1)[0]
    true = dtrtrs(condensed.L_cc, half, lower=1, trans=1)[0]
    np.testing.assert_allclose(found, true, atol=ROUND_OFF * np.abs(true).max())


def test_a_motion_of_the_frame_moves_the_shoe_as_a_rigid_body():
    body = prepared("rigid", 3).bodies[0]
    inner, frame = displacement_unknowns_of_solid_shoe(body), np.array([[1e-3], [-2e-3], [0.01]])
    u = body.condensed.nodal_displacements_in_load_cases(
        np.zeros((len(body.condensed.L_cc), 1)), frame, np.zeros((3, 1))
    )
    even, odd = inner.factors_of_even_and_odd_functions_at_nodes(u[:, 0])
    rigid = rigid_body_displacements_of_nodes(
        inner.grid.doflocs, inner.shoe.pin_position_in_shoe_frame
    )
    np.testing.assert_allclose(even[:, 0], (rigid @ frame).reshape(-1, 2), atol=1e-15)
    assert np.abs(even[:, 1:]).max() == np.abs(odd).max() == 0


@pytest.mark.parametrize(
    ("kind", "degree"), partly(product(HELD, (0, 1, 3)), [("pad", 3), ("rigid", 1)])
)
def test_without_contraction_one_width_moves_as_plane_stress(kind, degree):
    brake = without_contraction(HELD[kind]())
    plane, wide = (
        make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0]),
        prepare_model_with_shoe_widths(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], degree),
    )
    response = solve_prepared_model(plane, brake)
    under_forces = brake_with_forces_of_response(brake, response)
    for i, (shoe, answer) in enumerate(zip(under_forces.shoes, response.shoes, strict=True)):
        p = answer.pressure[:: shoe.frame.sense]
        move = partial(nodal_displacements_of_shoe, brake=brake, shoe=shoe, answer=answer)
        flat = move(plane.bodies[i], p=p).reshape(-1, 2)
        body = wide.bodies[i]
        over_width = np.repeat(
            p, len(contact_face_of_solid_shoe(body).node_distances_from_mid_plane)
        )
        moved = move(body, p=over_width)
        even, odd = displacement_unknowns_of_solid_shoe(
            body
        ).factors_of_even_and_odd_functions_at_nodes(moved)
        size = np.abs(flat).max()
        np.testing.assert_allclose(even[:, 0], flat, atol=ROUND_OFF * size)
        # Nothing varies over the width.
        assert max(np.abs(even[:, 1:]).max(initial=0), np.abs(odd).max(initial=0)) < 1e-10 * size


@pytest.mark.parametrize("degree", [0, 3])
def test_a_uniform_pressure_on_a_bonded_layer_makes_a_uniform_stress(degree):
    brake = without_contraction(HELD["rigid pad"]())
    scene = prepare_model_with_shoe_widths(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], degree)
    shoe, body, pressure = brake.shoes[0], scene.bodies[0], 2e6
    inner, count = displacement_unknowns_of_solid_shoe(body), len(body.line.nodes)
    nodal = -body.coupling.N.T @ np.full((count, 1), pressure)
    u = inner.nodal_displacements_in_load_cases(nodal, np.zeros((3, 1)), np.zeros((3, 1)))
    even, odd = inner.factors_of_even_and_odd_functions_at_nodes(u[:, 0])
    layer = shoe.lining
    depth = np.abs(inner.grid.doflocs[1] - inner.grid.doflocs[1, 0])
    shortening = pressure / layer.material.E * (layer.thickness - depth)
    np.testing.assert_allclose(np.abs(even[:, 0, 1]), shortening, atol=1e-9 * shortening.max())
    assert np.abs(even[:, 0, 0]).max() < 1e-9 * shortening.max()
    assert max(np.abs(even[:, 1:]).max(initial=0), np.abs(odd).max(initial=0)) < 1e-12


@pytest.mark.parametrize(("p", "q"), [(2, 1), (3, 2), (4, 3)])
def test_the_patch_test_holds_inside_a_column(p, q):
    """Uniform strain without stress across the width: what was eliminated is exact."""
    lame, halves = LameConstants(1.3, 0.7), (1.1, 1.1)
    functions = FunctionsAcrossWidth((0.0, 0.4, 1.1), q)
    stack = layers_of_element_column_from_half_widths(
        functions, halves, p, contact=False, back=ConditionAtEdgeFarthestFromContact.FREE
    )
    along = indices_of_unknowns_along_node_row(p)
    plan, names = (
        condensation_plan_of_column(stack, along),
        unknowns_of_element_column_by_role_in_condensation(stack, along),
    )
    x, y = np.meshgrid(np.linspace(0, 2, p + 1), np.linspace(0, 1, 2 * p + 1))
    points = np.array([x + 0.1 * np.sin(3 * y) * (x + 1), y + 0.2 * (1 - y) * np.cos(2 * x)])
    order = reference_element_of_degree(p).order
    parts = []
    for k in range(2):
        xy = points[:, k * p : (k + 1) * p + 1].reshape(2, -1)[:, order]
        parts.append(cross_section_integrals_of_any_shape(xy[None], lame, p))
    widths = [integrals_of_function_products_over_width(functions, half) for half in halves]
    slope = np.array([[3e-3, 1e-3], [-2e-3, 1e-3]])
    across = -lame.lam * np.trace(slope) / (lame.lam + 2 * lame.mu)

    def exact(unknowns):
        """The values of unknowns under the uniform strain."""
        found = []
        for z, place, row, function in unknowns:
            node = place if z else place // 2
            # The first odd function is z over half the width.
            value = across * 1.1 if z else slope[place % 2] @ points[:, row, node]
            found.append(value if function == 0 else 0.0)
        return np.array(found)[:, None]

    kept, rest = exact(names.kept), exact(names.rest)
    K, C, inner = column_stiffnesses_without_inner_element_unknowns(parts, widths, plan)
    # The edge at the contact and the back are loaded by the stress; no force acts between them.
    forces = C[0] @ kept + inner[0] @ rest
    middle = np.array([u.row == p for u in names.rest])
    scale = np.abs(K).max() * np.abs(kept).max()
    assert middle.sum() > 0
    assert np.abs(forces[middle]).max() < 1e-12 * scale
    for k, layer in enumerate(plan.layers):
        own = exact(names.boundary[k])[None]
        found = displacements_inside_elements(parts[k], widths[k], layer, own)[0]
        np.testing.assert_allclose(found, exact(names.within[k]), atol=1e-12)


@pytest.mark.parametrize(
    ("kind", "degree"), partly(product(HELD, (0, 1, 3)), [("wide body", 1), ("rigid", 1)])
)
def test_the_stated_number_of_unknowns_is_that_of_the_columns(kind, degree):
    for body in prepared(kind, degree).bodies:
        columns = displacement_unknowns_of_solid_shoe(body).element_columns_from_hinge_to_far_end()
        of_columns = [part for each in columns for part in (each.kept, each.rest, *each.within)]
        assert body.unknowns == len(np.unique(np.concatenate(of_columns)))


def test_loads_on_the_end_of_a_t_section_are_even_over_the_width_of_table_and_web(flexible):
    """The work of a unit load on u = z^2 is the mean of z^2 over each plate, half width^2 / 3."""
    table = {"thickness": 3e-3, "width": 0.04}
    brake = vary(flexible, {"shoe.body.table": table, "shoe.body.width": 6e-3})
    shoe = brake.shoes[0]
    functions = functions_across_width_of_shoe(shoe, 2)
    division = divide_shoe_into_hp_elements(
        shoe, brake.size, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0]
    )
    unknowns = EliminatedUnknownsOfShoeWithWidth(shoe, brake.size, division, functions)
    nodes, line = (
        unknowns.grid.sets["actuation"],
        unknowns.layers.unknowns_across_body_thickness(division),
    )
    end, forces = unknowns.layers.unit_loads_on_end_face(
        division, unknowns.grid.doflocs[:, nodes], np.zeros(1)
    )
    half = functions.breaks[-1]
    z = functions.node_distances_across_half_width_of_part(half)
    factors = matrix_from_node_values_to_function_factors(functions, half) @ z**2
    web = shoe.body.thickness
    share = 3e-3 / (3e-3 + web)
    mean = share * 0.02**2 / 3 + (1 - share) * 0.003**2 / 3
    for component in (0, 1):
        along = (line.z == 0) & (line.component == component)
        work = factors[line.function[along]] @ forces[along]
        assert work[component] == pytest.approx(mean, rel=1e-10)
        # The resultant is that of the plane section.
        total = forces[along & (line.function == 0)].sum(axis=0)
        assert total[component] == pytest.approx(1.0, rel=1e-12)
    assert end.forces.shape == (2 * len(nodes), 3)
