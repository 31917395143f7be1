"""Columns whose face stays open keep few contact nodes, and the answer is the same."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import drumlin.fem.width.prepare as width_prepare
import drumlin.fem.width.shoe as width_shoe
from drumlin.fem.analysis.solid_fields import recover_stresses_in_half_of_each_solid_shoe
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE, SolvedLevel
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.solve import solve
from drumlin.fem.width.functions import functions_across_width_of_shoe
from drumlin.fem.width.ladder import solve_cross_section_mesh_with_width_degree
from drumlin.fem.width.open_columns import (
    divisions_with_open_columns,
    solve_until_open_columns_stay_open,
)
from drumlin.fem.width.prepare import (
    memory_bytes_of_condensation_on_divisions,
    prepare_model_with_shoe_widths,
    prepare_model_with_widths_on_given_elements,
)
from drumlin.fem.width.shoe import condense_shoe_with_width
from drumlin_studies.solid_error import draw_random_brake_with_steel_table_and_web
from wide_shoes import HELD

KINDS = ("T-section", "rigid with a backing", "narrow body in a grip", "post", "pad")


def prepared(brake, degree=2):
    return prepare_model_with_shoe_widths(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], degree)


@pytest.fixture(scope="module")
def lifted():
    """A shoe whose lining lifts off over a third of its columns, and its answer with all nodes."""
    brake = draw_random_brake_with_steel_table_and_web(510115)
    scene = prepared(brake)
    return brake, SolvedLevel(scene, solve_prepared_model(scene, brake))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("made_when_needed", [False, True])
def test_open_columns_have_the_stiffness_of_all_nodes(kind, made_when_needed, monkeypatch):
    brake = HELD[kind]()
    division = prepared(brake).divisions[0]
    if made_when_needed:
        monkeypatch.setattr(width_shoe, "MOST_BYTES_OF_COLUMNS_MADE_TOGETHER", 0)
    columns = len(division.angles) - 1
    chosen = replace(division, open_columns=(0, 2, 3, columns // 2, columns - 1))
    functions = functions_across_width_of_shoe(brake.shoes[0], 2)
    full, found = (
        condense_shoe_with_width(brake.shoes[0], brake.size, own, functions).S
        for own in (division, chosen)
    )
    face = prepare_model_with_widths_on_given_elements(
        brake, {0: division}, lambda shoe: functions
    ).bodies[0]
    across = len(face.line.node_distances_from_mid_plane)
    kept = chosen.indices_of_kept_contact_nodes
    assert len(kept) == division.contact_nodes - 5 * (division.degree - 1)
    unknowns = np.arange(division.contact_nodes * across * 2).reshape(-1, 2 * across)
    on = np.concatenate([np.arange(3), 3 + unknowns[kept].ravel()])
    off = np.setdiff1d(np.arange(len(full)), on)
    eliminated = full[np.ix_(on, off)] @ np.linalg.solve(
        full[np.ix_(off, off)], full[np.ix_(off, on)]
    )
    expected = full[np.ix_(on, on)] - eliminated
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(full).max())


def test_the_answer_and_its_fields_are_those_of_all_nodes(lifted):
    brake, first = lifted
    expected = first.response
    divisions = divisions_with_open_columns(brake, first.prepared_model.divisions, [expected])
    assert len(divisions[0].open_columns) > 4
    scene = prepare_model_with_widths_on_given_elements(brake, divisions, 2)
    nodes = [len(each.bodies[0].line.nodes) for each in (scene, first.prepared_model)]
    assert nodes[0] < 0.8 * nodes[1]
    found = solve_prepared_model(scene, brake)
    (own,), (true,) = found.shoes, expected.shoes
    np.testing.assert_allclose(own.theta, true.theta, rtol=1e-14)
    np.testing.assert_allclose(own.pressure, true.pressure, atol=1e-9 * true.peak_pressure)
    np.testing.assert_allclose(
        own.surface.pressure, true.surface.pressure, atol=1e-9 * true.surface.pressure.max()
    )
    assert own.torque == pytest.approx(true.torque, rel=1e-10)
    fields, true_fields = (
        recover_stresses_in_half_of_each_solid_shoe(model, brake, response)[0]
        for model, response in ((scene, found), (first.prepared_model, expected))
    )
    for name in ("displacement", "solid_stress", "pressure"):
        value, right = getattr(fields, name), getattr(true_fields, name)
        np.testing.assert_allclose(
            value, right, rtol=0, atol=1e-7 * np.abs(right).max(), err_msg=name
        )


def test_contact_that_grows_with_the_degree_is_that_of_all_nodes():
    """With degree 3 the contact reaches farther than in the answer that shows the open columns.

    Without a column with all nodes beside the open ones, the pressures are 2 % of the peak off.
    """
    brake = draw_random_brake_with_steel_table_and_web(1006)
    start = solve_cross_section_mesh_with_width_degree(
        brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], 2, solve(brake)
    )
    full = start.prepared_model.divisions

    def solve_with_degree_3(answers):
        divisions = divisions_with_open_columns(brake, full, answers)
        scene = prepare_model_with_widths_on_given_elements(brake, divisions, 3)
        return SolvedLevel(scene, solve_prepared_model(scene, brake))

    found = solve_until_open_columns_stay_open(brake, [start.response], solve_with_degree_3)
    assert found.prepared_model.divisions[0].open_columns
    (own,), (true,) = found.response.shoes, solve_with_degree_3([]).response.shoes
    np.testing.assert_allclose(
        own.surface.pressure, true.surface.pressure, atol=1e-7 * true.surface.pressure.max()
    )


def test_open_columns_need_less_memory(lifted, monkeypatch):
    brake, first = lifted
    full = first.prepared_model.divisions
    opened = divisions_with_open_columns(brake, full, [first.response])
    functions = partial(functions_across_width_of_shoe, degree=3)
    before, after = (
        memory_bytes_of_condensation_on_divisions(brake, each, functions) for each in (full, opened)
    )
    assert 0.5 * before < after < 0.95 * before
    # Only the nodes that are kept count for the largest number of nodes.
    scene = prepare_model_with_widths_on_given_elements(brake, opened, functions)
    nodes = len(scene.bodies[0].line.nodes)
    for most, fits in ((nodes, True), (nodes - 1, False)):
        monkeypatch.setattr(width_prepare, "MOST_NODES_OF_CONTACT_FACE", most)
        found = memory_bytes_of_condensation_on_divisions(brake, opened, functions)
        assert np.isfinite(found) == fits


def test_no_column_is_open_where_an_answer_has_contact_nearby(lifted):
    brake, first = lifted
    full = first.prepared_model.divisions
    (shoe,) = first.response.shoes
    pressed = np.asarray(shoe.theta)[(shoe.surface.pressure != 0).any(axis=1)]
    (division,) = divisions_with_open_columns(brake, full, [first.response]).values()
    phi = brake.shoes[0].frame.phi_coordinates_as_list(pressed)
    for column in division.open_columns:
        start, end = division.angles[column : column + 2]
        assert all(each < start - 1e-6 or each > end + 1e-6 for each in phi)
    # An answer in plane stress does not show where the face is open, and no answer shows nothing.
    plane = replace(first.response, shoes=(replace(shoe, surface=None),))
    for answers in ([], [plane], [first.response, plane]):
        (division,) = divisions_with_open_columns(brake, full, answers).values()
        assert division.open_columns == ()


def test_a_brake_is_solved_again_until_its_open_columns_stay_open(lifted):
    """The earlier answer has lost most of its contact, so that too many columns are open."""
    brake, first = lifted
    (shoe,) = first.response.shoes
    few = shoe.surface.pressure.copy()
    pressed = np.flatnonzero(few.any(axis=1))
    few[: pressed[-1]] = 0.0
    wrong = replace(
        first.response, shoes=(replace(shoe, surface=shoe.surface._replace(pressure=few)),)
    )
    open_columns = []

    def solve(answers):
        divisions = divisions_with_open_columns(brake, first.prepared_model.divisions, answers)
        open_columns.append(len(divisions[0].open_columns))
        scene = prepare_model_with_widths_on_given_elements(brake, divisions, 2)
        return SolvedLevel(scene, solve_prepared_model(scene, brake))

    found = solve_until_open_columns_stay_open(brake, [wrong], solve)
    assert len(open_columns) > 1
    assert open_columns == sorted(open_columns, reverse=True)
    np.testing.assert_allclose(
        found.response.shoes[0].pressure, shoe.pressure, atol=1e-9 * shoe.peak_pressure
    )
