"""Large shoes with a width: ways to condense them that need less memory change no answer."""

import math
import tracemalloc
import weakref
from functools import partial
from itertools import pairwise

import numpy as np
import pytest

import drumlin.fem.hp.element as hp_element
import drumlin.fem.width.columns as width_columns
import drumlin.fem.width.prepare as width_prepare
import drumlin.fem.width.shoe as width_shoe
from drumlin.base.errors import NoAnswer
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.hp.columns import (
    ColumnSubstructure,
    ColumnSubstructureMadeWhenNeeded,
    assemble_and_condense_row_of_element_columns,
    matrix_entries_while_columns_are_joined,
)
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.width.functions import (
    FunctionsAcrossWidth,
    functions_across_width_of_shoe,
    piece_ends_across_half_width_of_shoe,
)
from drumlin.fem.width.ladder import solve_cross_section_mesh_with_width_degree
from drumlin.fem.width.prepare import (
    memory_bytes_of_condensation_on_divisions,
    prepare_model_with_shoe_widths,
    prepare_model_with_widths_on_given_elements,
)
from wide_shoes import HELD

KINDS = ("T-section", "rigid with a backing", "narrow body in a grip", "post", "pad")


@pytest.fixture
def large(monkeypatch):
    """Limits above which shoes are condensed like large ones; here every shoe is."""

    def apply():
        limits = [
            (hp_element, "SMALLEST_SIZE_COMPUTED_BY_TRIANGLE"),
            (width_columns, "LARGEST_COUPLING_ELIMINATED_AT_ONCE"),
            (width_shoe, "MOST_BYTES_OF_COLUMNS_MADE_TOGETHER"),
            (width_prepare, "MOST_BYTES_OF_KEPT_CHOLESKY_FACTOR"),
        ]
        for module, name in limits:
            monkeypatch.setattr(module, name, 0)
        width_columns.condensation_plan_of_column.cache_clear()

    yield apply
    width_columns.condensation_plan_of_column.cache_clear()


def prepared(brake, degree=2):
    return prepare_model_with_shoe_widths(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], degree)


@pytest.mark.parametrize("kind", KINDS)
def test_a_shoe_condensed_like_a_large_one_has_the_same_answer(kind, large):
    brake = HELD[kind]()
    before = prepared(brake)
    expected = solve_prepared_model(before, brake)
    large()
    scene = prepared(brake)
    found = solve_prepared_model(scene, brake)
    for own, true in zip(found.shoes, expected.shoes, strict=True):
        assert own.torque == pytest.approx(true.torque, rel=1e-10)
        np.testing.assert_allclose(
            own.surface.pressure, true.surface.pressure, atol=1e-9 * true.surface.pressure.max()
        )
    # The factor is not kept, and is computed again when it is needed.
    for body, other in zip(scene.bodies, before.bodies, strict=True):
        assert "L_cc" not in vars(body.condensed)
        stiffness, true_stiffness = (
            each.condensed.L_cc @ each.condensed.L_cc.T for each in (body, other)
        )
        scale = np.abs(true_stiffness).max()
        np.testing.assert_allclose(stiffness, true_stiffness, atol=1e-9 * scale, rtol=0)


def test_a_schur_complement_by_its_triangle_is_symmetric_and_the_same(large):
    random = np.random.default_rng(5)
    A = random.standard_normal((150, 150))
    A = A @ A.T
    blocks = A[:130, :130], A[130:, :130], A[130:, 130:]
    expected = hp_element.replace_matrix_by_schur_complement(*(each.copy() for each in blocks))
    large()
    found = hp_element.replace_matrix_by_schur_complement(*(each.copy() for each in blocks))
    np.testing.assert_allclose(found, expected, atol=1e-12 * np.abs(A).max())
    np.testing.assert_array_equal(found, found.T)


def test_of_the_columns_of_a_large_shoe_only_a_few_exist_at_a_time(large, monkeypatch):
    condense = width_shoe.condense_mirror_symmetric_columns
    made, existing = [], []

    def condense_and_count(parts, widths, stack):
        columns = condense(parts, widths, stack)
        if stack.contact:
            made.extend(weakref.ref(column.K) for column in columns)
            existing.append(sum(own() is not None for own in made))
        return columns

    monkeypatch.setattr(width_shoe, "condense_mirror_symmetric_columns", condense_and_count)
    brake = HELD["T-section"]()
    prepared(brake)
    assert max(existing) == len(made) > 4
    existing.clear()
    large()
    prepared(brake)
    assert max(existing) <= 3


@pytest.mark.parametrize(("degree", "pieces"), [(9, 1), (2, 4)])
def test_the_memory_of_a_condensation_is_known_before_it_is_made(degree, pieces, large):
    """Two shoes: in the first the joined columns take more memory, in the second the contact."""
    brake = HELD["T-section"]()
    large()
    wide = prepared(brake)

    def functions(shoe):
        ends = piece_ends_across_half_width_of_shoe(shoe)
        cuts = [np.linspace(*own, pieces, endpoint=False) for own in pairwise(ends)]
        return FunctionsAcrossWidth((*np.concatenate(cuts).tolist(), ends[-1]), degree)

    tracemalloc.start()
    before, _ = tracemalloc.get_traced_memory()
    prepare_model_with_widths_on_given_elements(brake, wide.divisions, functions)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    stated = memory_bytes_of_condensation_on_divisions(brake, wide.divisions, functions)
    assert 0.5 < stated / (peak - before) < 1.5


@pytest.mark.parametrize("columns", [3, 13])
def test_the_entries_of_joined_columns_are_counted_before_they_are_joined(columns):
    side, contact, shared = 200, 40, 10

    def column(left, right):
        K = np.full((left + right + contact, left + right + contact), 0.01)
        np.fill_diagonal(K, 1e3)
        return ColumnSubstructure(K, left, right)

    inner = [
        ColumnSubstructureMadeWhenNeeded(
            2 * side + contact, side, side, partial(column, side, side)
        )
        for _ in range(columns - 2)
    ]
    tracemalloc.start()
    row = [column(0, side), *inner, column(side, 0)]
    assemble_and_condense_row_of_element_columns(row, shared)
    peak = tracemalloc.get_traced_memory()[1] / 8
    tracemalloc.stop()
    counted = matrix_entries_while_columns_are_joined(side, [contact] * columns, shared)
    assert counted == pytest.approx(peak, rel=0.06)


def test_a_face_with_too_many_nodes_would_take_any_memory(monkeypatch):
    brake = HELD["T-section"]()
    wide = prepared(brake)
    degree = partial(functions_across_width_of_shoe, degree=2)
    nodes = len(wide.bodies[0].line.nodes)
    for most, fits in ((nodes, True), (nodes - 1, False)):
        monkeypatch.setattr(width_prepare, "MOST_NODES_OF_CONTACT_FACE", most)
        found = memory_bytes_of_condensation_on_divisions(brake, wide.divisions, degree)
        assert math.isfinite(found) == fits


def test_a_face_may_have_as_many_nodes_as_the_caller_allows():
    brake = HELD["T-section"]()
    level = REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0]
    nodes = len(prepared(brake).bodies[0].line.nodes)
    start = solve_prepared_model(prepared(brake), brake)
    answer = partial(solve_cross_section_mesh_with_width_degree, brake, level, 2, start)
    allowed = answer(most_contact_nodes=nodes).prepared_model.bodies
    assert max(len(body.line.nodes) for body in allowed) == nodes
    with pytest.raises(NoAnswer, match=f"its {nodes} contact nodes are more than the {nodes - 1}"):
        answer(most_contact_nodes=nodes - 1)


def test_the_stated_memory_of_a_body_is_that_of_its_matrices(large):
    def bytes_of_matrices(values):
        arrays = [value for value in values if isinstance(value, np.ndarray)]
        return sum(array.nbytes for array in arrays if array.ndim == 2)

    brake = HELD["T-section"]()
    for is_large in (False, True):
        if is_large:
            large()
        body = prepared(brake, 3).bodies[0]
        # The mass matrix is computed at its first access, which every solve makes.
        assert body.coupling.M.any()
        owners = (vars(body.condensed).values(), vars(body.coupling).values(), body.flexibility)
        true = sum(map(bytes_of_matrices, owners))
        stated = width_prepare.memory_bytes_of_condensed_solid_shoe(body)
        assert stated == pytest.approx(true, rel=0.1)
