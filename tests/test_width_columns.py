"""Columns with a width: the patch test, rigid-body modes, and columns by their symmetries."""

import numpy as np
import pytest

from drumlin.fem.hp.element import reference_element_of_degree
from drumlin.fem.hp.shoe import node_positions_in_each_element_of_row
from drumlin.fem.width.columns import (
    ConditionAtEdgeFarthestFromContact,
    condense_element_columns_of_any_shape,
    condense_mirror_symmetric_columns,
    indices_of_unknowns_along_node_row,
    indices_of_unknowns_along_symmetric_half_row,
    layers_of_element_column_from_half_widths,
)
from drumlin.fem.width.functions import (
    FunctionsAcrossWidth,
    integrals_of_function_products_over_width,
)
from drumlin.fem.width.integrals import (
    SYMMETRY_NUMBERS_OF_COLUMN_DISPLACEMENTS,
    LameConstants,
    angular_factors_of_section_integrals,
    cross_section_integrals_between_circles,
    cross_section_integrals_of_any_shape,
)

LAME = LameConstants(1.3, 0.7)
SOFT = LameConstants(0.4, 0.9)
BREAKS = (0.0, 0.4, 1.1)
HALVES = (1.1, 0.4)
"""A wide layer on a narrow one."""


def cells(along, depths, p):
    """Nodes (layers, columns, 2, a) of elements on an arc that is bent by a quadratic map."""
    r = 5.0 - node_positions_in_each_element_of_row(depths, p)[:, None, :, None]
    phi = along[:, None, :]
    r, phi = np.broadcast_arrays(r, phi)
    xy = np.array([r * np.cos(phi), r * np.sin(phi)])
    xy = xy.reshape(2, len(depths) - 1, len(along), -1).transpose(1, 2, 0, 3)
    return np.ascontiguousarray(xy[..., reference_element_of_degree(p).order])


def unknown_values(stack, along, xy_of, field, p):
    """The values of a displacement field at all unknowns that a whole column keeps.

    field: from points (2,) to the factors of the functions: (even, 2) and (odd,).
    """
    found = []
    kept = [
        *stack.unknowns_on_left_or_right_side_of_column(along.left),
        *stack.unknowns_of_contact_nodes(along),
        *stack.unknowns_on_left_or_right_side_of_column(along.right),
    ]
    for unknown in kept:
        node = unknown.along if unknown.z else unknown.along // 2
        even, odd = field(xy_of(unknown.row, node))
        value = odd[unknown.function] if unknown.z else even[unknown.function, unknown.along % 2]
        found.append(value)
    # At the contact the unknowns of a column stand by nodes, x and y together.
    line = len(stack.unknowns_on_left_or_right_side_of_column(along.left))
    count = stack.counts[0][0] if stack.contact else 0
    contact = np.array(found[line : len(found) - line]).reshape(-1, 2, max(count, 1))
    values = np.array(found)
    values[line : len(found) - line] = contact.transpose(0, 2, 1).ravel()
    return values


def columns_on_arc(p, q, *, contact=True, back=ConditionAtEdgeFarthestFromContact.FREE):
    """A column with a width of two layers, by its nodes and by its symmetries."""
    functions = FunctionsAcrossWidth(BREAKS, q)
    depths, along = (
        np.array([0.0, 0.5, 1.2]),
        0.3 * node_positions_in_each_element_of_row(np.array([-1.0, 1.0]), p),
    )
    stack = layers_of_element_column_from_half_widths(
        functions, HALVES, p, contact=contact, back=back
    )
    widths = [integrals_of_function_products_over_width(functions, half) for half in HALVES]
    xy = cells(along, depths, p)
    lame = LAME, SOFT
    parts = [
        cross_section_integrals_of_any_shape(own, each, p)
        for own, each in zip(xy, lame, strict=True)
    ]
    (whole,) = condense_element_columns_of_any_shape(parts, widths, stack)
    radii, by_symmetry = 5.0 - depths, []
    for symmetry in SYMMETRY_NUMBERS_OF_COLUMN_DISPLACEMENTS:
        factors = angular_factors_of_section_integrals(along, p, symmetry)
        each = [
            cross_section_integrals_between_circles(radii[k], radii[k + 1], lame[k], factors, p)
            for k in range(2)
        ]
        by_symmetry.append(each)
    (half,) = condense_mirror_symmetric_columns(by_symmetry, widths, stack)
    return stack, along, depths, whole, half


@pytest.mark.parametrize("back", list(ConditionAtEdgeFarthestFromContact))
@pytest.mark.parametrize("contact", [True, False])
@pytest.mark.parametrize(("p", "q"), [(2, 1), (2, 2), (3, 2), (4, 3), (5, 1)])
def test_a_column_by_its_symmetries_is_that_of_its_nodes(p, q, contact, back):
    stack, along, _, whole, half = columns_on_arc(p, q, contact=contact, back=back)
    assert (
        whole.left
        == half.left
        == len(
            stack.unknowns_on_left_or_right_side_of_column(
                indices_of_unknowns_along_symmetric_half_row(p, 0).left
            )
        )
    )
    assert whole.K.shape == half.K.shape
    # The sides of a half are measured along their own radius, the contact's inside as its middle.
    turn = np.eye(len(whole.K))
    row = indices_of_unknowns_along_node_row(p)
    kept = [
        *stack.unknowns_on_left_or_right_side_of_column(row.left),
        *stack.unknowns_of_contact_nodes(row),
        *stack.unknowns_on_left_or_right_side_of_column(row.right),
    ]
    contact_start = len(stack.unknowns_on_left_or_right_side_of_column(row.left))
    for start, stop in ((0, contact_start), (len(kept) - contact_start, len(kept))):
        for i in range(start, stop):
            if kept[i].z == 0 and kept[i].along % 2 == 0:
                _turn(turn, i, _partner(kept, i), along[0, kept[i].along // 2])
    count = stack.counts[0][0] if contact else 0
    for node in (0, p) if contact else ():
        for f in range(count):
            i = contact_start + 2 * (node * count + f)
            _turn(turn, i, i + 1, along[0, node])
    scale = np.abs(whole.K).max()
    np.testing.assert_allclose(turn @ whole.K @ turn.T, half.K, atol=1e-11 * scale)


def _partner(kept, i):
    """The unknown along y beside an unknown along x."""
    own = kept[i]
    return kept.index(own._replace(along=own.along + 1))


def _turn(turn, i, j, angle):
    """Turn the axes of two unknowns by an angle."""
    c, s = np.cos(angle), np.sin(angle)
    turn[np.ix_([i, j], [i, j])] = [[c, s], [-s, c]]


@pytest.mark.parametrize(("p", "q"), [(2, 1), (3, 2), (4, 3)])
def test_motions_that_strain_nothing_need_no_force(p, q):
    stack, along, depths, whole, _ = columns_on_arc(p, q)
    places = _places(along, depths, p)
    motions = [
        lambda xy: np.array([1.0, 0.0]),
        lambda xy: np.array([0.0, 1.0]),
        lambda xy: np.array([-xy[1], xy[0]]),
    ]
    for motion in motions:

        def field(xy, motion=motion):
            even = np.zeros((len(stack.even), 2))
            even[0] = motion(xy)
            return even, np.zeros(len(stack.odd))

        u = unknown_values(stack, indices_of_unknowns_along_node_row(p), places, field, p)
        scale = np.abs(whole.K).max() * np.abs(u).max()
        np.testing.assert_allclose(whole.K @ u, 0, atol=1e-12 * scale)


@pytest.mark.parametrize(("p", "q"), [(2, 1), (3, 2), (4, 3)])
def test_the_patch_test_holds_with_a_width(p, q):
    """Simple tension of skewed elements: condensed unknowns, on which nothing acts, are exact.

    The back and both faces across the width are free. So the energy is that of sigma^2/E; any other
    values of the condensed unknowns would need less.
    """
    half, pull, angle = 1.1, 0.3, 0.6
    E = LAME.mu * (3 * LAME.lam + 2 * LAME.mu) / (LAME.lam + LAME.mu)
    nu = LAME.lam / (2 * (LAME.lam + LAME.mu))
    functions = FunctionsAcrossWidth((0.0, half), q)
    stack = layers_of_element_column_from_half_widths(
        functions, (half, half), p, contact=True, back=ConditionAtEdgeFarthestFromContact.FREE
    )
    widths = [integrals_of_function_products_over_width(functions, half)] * 2
    along = node_positions_in_each_element_of_row(np.array([0.0, 2.0]), p)
    rows = np.append(
        node_positions_in_each_element_of_row(np.array([0.0, 0.6, 1.0]), p)[:, :-1].ravel(), 1.0
    )
    # The back at y = 1 is straight, all other edges are curved.
    x, y = np.meshgrid(along[0], rows)
    bent = np.array([x + 0.1 * np.sin(3 * y) * (x + 1), y + 0.2 * (1 - y) * np.cos(2 * x)])
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    points = np.einsum("ij,jrc->irc", turn, bent)
    order = reference_element_of_degree(p).order
    xy = [points[:, k * p : (k + 1) * p + 1].reshape(2, -1)[None, :, order] for k in range(2)]
    (whole,) = condense_element_columns_of_any_shape(
        [cross_section_integrals_of_any_shape(own, LAME, p) for own in xy], widths, stack
    )
    slope = turn @ np.diag([pull / E, -nu * pull / E]) @ turn.T

    def field(at):
        even, odd = np.zeros((len(stack.even), 2)), np.zeros(len(stack.odd))
        even[0], odd[0] = slope @ at, -nu * pull / E * half
        return even, odd

    u = unknown_values(
        stack, indices_of_unknowns_along_node_row(p), lambda r, n: points[:, r, n], field, p
    )
    unit = [cross_section_integrals_of_any_shape(own, LameConstants(0.0, 1.0), p) for own in xy]
    area = sum(float(own.across.sum()) / 2 for own in unit)
    assert u @ whole.K @ u == pytest.approx(2 * half * area * pull**2 / E, rel=1e-12)


def _places(along, depths, p):
    """From a row of nodes and a node along it to the point."""
    rows = np.append(node_positions_in_each_element_of_row(depths, p)[:, :-1].ravel(), depths[-1])

    def place(row, node):
        r, phi = 5.0 - rows[row], along[0, node]
        return np.array([r * np.cos(phi), r * np.sin(phi)])

    return place
