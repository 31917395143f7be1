"""Fields in shoes with a width, against contact pressures, plane stress and hexahedra."""

from itertools import pairwise
from pathlib import Path

import meshio
import numpy as np
import pytest

from conftest import partly
from drumlin.base.errors import BadInput
from drumlin.fem import solid as solid_shoes
from drumlin.fem.analysis.fields import stress_and_displacement_fields_of_shoe
from drumlin.fem.analysis.solid_fields import (
    displacements_and_stresses_in_shoe_part,
    recover_stresses_in_half_of_each_solid_shoe,
)
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.hp.division import divide_shoe_into_hp_elements
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.width.functions import (
    functions_across_width_of_shoe,
    matrix_from_node_values_to_function_factors,
)
from drumlin.fem.width.prepare import prepare_model_with_shoe_widths
from drumlin.fem.width.recovery import EliminatedUnknownsOfShoeWithWidth
from drumlin.response.response import length_of_edge_zone_left_out_of_peak_search
from wide_shoes import HELD

PUT_AT = ([0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2])
"""Rows and columns of the six stresses of a node in its stress tensor."""


def stress_tensors(fields):
    """The stress tensors (n, 3, 3) [Pa] of the nodes."""
    found = np.zeros((len(fields.points), 3, 3))
    found[:, *PUT_AT] = fields.solid_stress
    found[:, *PUT_AT[::-1]] = fields.solid_stress
    return found


def pressed_nodes_away_from_ends(brake, index, fields, answer):
    """Nodes in contact, farther from the ends of lining and contact than the lining is thick."""
    shoe, theta = brake.shoes[index], fields.points[:, 0]
    if not shoe.is_on_plane:
        middle = 0.5 * (answer.theta[0] + answer.theta[-1])
        theta = np.arctan2(fields.points[:, 1], fields.points[:, 0])
        theta = middle + (theta - middle + np.pi) % (2 * np.pi) - np.pi
    zone = 2 * length_of_edge_zone_left_out_of_peak_search(
        shoe, brake.length_per_surface_coordinate
    )
    inside = np.zeros(len(theta), dtype=bool)
    for start, end in answer.contact_arcs:
        low, high = max(start, answer.theta[0] + zone), min(end, answer.theta[-1] - zone)
        inside |= (theta > low) & (theta < high)
    return np.flatnonzero(inside & (fields.pressure != 0))


@pytest.mark.parametrize("kind", partly(HELD, ("rigid", "pad in a grip")))
def test_stresses_on_the_face_are_pressure_and_friction(kind):
    """sigma n = -p n + mu p t, and no stress along z, to the error of the pressure itself."""
    brake = HELD[kind]()
    scene = prepare_model_with_shoe_widths(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], 2)
    response = solve_prepared_model(scene, brake)
    # Beside a web of 15 mm under a lining of 40 mm degree 2 is 3 % off.
    within = 0.05 if kind == "narrow body in a grip" else 5e-3
    for i, (shoe, answer) in enumerate(zip(brake.shoes, response.shoes, strict=True)):
        fields = recover_stresses_in_half_of_each_solid_shoe(scene, brake, response)[i]
        on = pressed_nodes_away_from_ends(brake, i, fields, answer)
        assert len(on) > 20
        # On a plane the normal is y, on a drum it is the radius.
        normal = np.array([0.0, 1.0, 0.0]) if shoe.is_on_plane else fields.points[on] * [1, 1, 0]
        normal = np.broadcast_to(normal, (len(on), 3))
        normal = normal / np.linalg.norm(normal, axis=1)[:, None]
        traction = np.einsum("nij,nj->ni", stress_tensors(fields)[on], normal)
        p = fields.pressure[on]
        size = np.sqrt(np.mean(p**2))
        pressed = np.einsum("ni,ni->n", traction, normal)
        rubbed = np.cross(normal, [0.0, 0.0, 1.0])
        dragged = np.abs(np.einsum("ni,ni->n", traction, rubbed))
        assert np.sqrt(np.mean((pressed + p) ** 2)) < within * size
        assert np.sqrt(np.mean((dragged - brake.friction * p) ** 2)) < within * size
        assert np.sqrt(np.mean(traction[:, 2] ** 2)) < within * size


@pytest.mark.parametrize("name", ["lining", "shoe"])
def test_the_stress_of_known_strains_is_exact(name):
    """Uniform strain, and a shear strain in proportion to z, in all cells of a wide body."""
    brake = HELD["wide body"]()
    shoe = brake.shoes[0]
    functions = functions_across_width_of_shoe(shoe, 3)
    division = divide_shoe_into_hp_elements(
        shoe, brake.size, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0]
    )
    unknowns = EliminatedUnknownsOfShoeWithWidth(shoe, brake.size, division, functions)
    slope, across, bend = np.array([[3e-3, 1e-3], [-2e-3, 1e-3]]), 5e-4, 0.2
    even = np.zeros((unknowns.grid.N, len(functions.even_functions_across_width), 2))
    odd = np.zeros((unknowns.grid.N, len(functions.odd_functions_across_width)))
    even[:, 0] = (slope @ unknowns.grid.doflocs).T
    # u_x = bend z^2, and u_z = across z; the first odd function is z over half the width.
    half = functions.breaks[-1]
    z = functions.node_distances_across_half_width_of_part(half)
    even[:, :, 0] += matrix_from_node_values_to_function_factors(functions, half) @ (bend * z**2)
    odd[:, 0] = across * half
    u = np.hstack([even.reshape(unknowns.grid.N, -1), odd]).ravel()
    found = displacements_and_stresses_in_shoe_part(unknowns, u, name)
    lame = unknowns.layers.lame[division.part.index(name)]
    strain = np.zeros((len(found.z), 3, 3))
    strain[:, :2, :2] = 0.5 * (slope + slope.T)
    strain[:, 2, 2] = across
    strain[:, 0, 2] = strain[:, 2, 0] = bend * found.z
    exact = lame.lam * np.trace(strain[0]) * np.eye(3) + 2 * lame.mu * strain
    np.testing.assert_allclose(found.stress, exact, atol=1e-9 * np.abs(exact).max())
    np.testing.assert_allclose(found.displacement[:, 2], across * found.z, atol=1e-12)


@pytest.mark.parametrize("kind", partly(HELD, ("rigid",)))
def test_the_face_moves_to_the_drum(kind):
    brake = HELD[kind]()
    scene = prepare_model_with_shoe_widths(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], 2)
    response = solve_prepared_model(scene, brake)
    for i, shoe in enumerate(brake.shoes):
        fields = recover_stresses_in_half_of_each_solid_shoe(scene, brake, response)[i]
        on = fields.pressure > 0.01 * fields.pressure.max()
        x, y = fields.points[on, :2].T
        normal = np.array(
            [0 * x, 1 + 0 * y] if shoe.is_on_plane else np.array([x, y]) / np.hypot(x, y)
        )
        moved = np.einsum("in,ni->n", normal, fields.displacement[on, :2])
        # The gap closes weakly, not at every node.
        assert np.abs(moved).mean() < 0.02 * np.abs(fields.displacement).max()
        # No displacement leaves the mid-plane.
        assert np.abs(fields.displacement[fields.points[:, 2] == 0, 2]).max() == 0
        assert fields.points[:, 2].min() == 0


def test_at_degree_zero_stresses_are_those_of_plane_stress():
    brake = HELD["pad"]()
    plane, wide = (
        make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0]),
        prepare_model_with_shoe_widths(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], 0),
    )
    flat = stress_and_displacement_fields_of_shoe(
        plane, brake, solve_prepared_model(plane, brake), 0
    )
    solid = recover_stresses_in_half_of_each_solid_shoe(
        wide, brake, solve_prepared_model(wide, brake)
    )[0]
    middle = solid.points[:, 2] == 0
    # Both have the same nodes, in the order of the parts.
    np.testing.assert_allclose(solid.points[middle, :2], flat.points, atol=1e-12)
    size = np.abs(flat.stress).max()
    xx, yy, zz, xy, yz, xz = solid.solid_stress[middle].T
    np.testing.assert_allclose(np.array([xx, yy, xy]).T, flat.stress, atol=1e-7 * size)
    assert np.abs([zz, yz, xz]).max() == 0
    np.testing.assert_allclose(solid.von_mises[middle], flat.von_mises, atol=1e-7 * size)
    np.testing.assert_allclose(
        solid.pressure[middle], flat.pressure, atol=1e-9 * flat.pressure.max()
    )
    assert solid.points[:, 2].max() == pytest.approx(0.02)


def test_cells_fill_the_half_shoe_once():
    brake = HELD["T-section"]()
    scene = prepare_model_with_shoe_widths(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], 1)
    fields = recover_stresses_in_half_of_each_solid_shoe(
        scene, brake, solve_prepared_model(scene, brake)
    )[1]
    corners = fields.points[fields.cells]
    # The sum of six tetrahedra around the diagonal from corner 0 to corner 6.
    ring, volume = (1, 2, 3, 7, 4, 5, 1), np.zeros(len(corners))
    along = corners[:, 6] - corners[:, 0]
    for a, b in pairwise(ring):
        sides = corners[:, a] - corners[:, 0], corners[:, b] - corners[:, 0]
        volume += np.einsum("ni,ni->n", np.cross(*sides), along) / 6
    assert (volume > 0).all()
    shoe = brake.shoes[1]
    lining = volume[fields.part == 0].sum()
    middle = brake.size - shoe.lining.thickness / 2
    angle = shoe.lining.end - shoe.lining.start
    exact = angle * middle * shoe.lining.thickness * shoe.lining.width / 2
    assert lining == pytest.approx(exact, rel=1e-2)


def test_a_solve_to_a_tolerance_writes_the_fields(tmp_path):
    brake, path = HELD["rigid"](), tmp_path / "shoes.vtu"
    response = solid_shoes.solve(brake, tolerance=0.05, fields=path)
    grid = meshio.read(path)
    (cells,) = grid.cells
    assert cells.type == "hexahedron"
    assert grid.point_data["stress xx, yy, zz, xy, yz, xz [Pa]"].shape == (len(grid.points), 6)
    surface = response.shoes[0].surface
    # The file has the pressures of the face at its own samples.
    p = grid.point_data["pressure [Pa]"]
    assert p.max() == pytest.approx(surface.pressure.max(), rel=1e-3)
    with pytest.raises(BadInput, match=r"--fields = 'shoes.png': must end in .vtu"):
        solid_shoes.solve(brake, tolerance=0.05, fields=Path("shoes.png"))
