"""The pressure over arc and width of shoes with a width: means, peaks, and values at the nodes."""

from dataclasses import replace

import numpy as np
import pytest

from drumlin.fem.analysis.solid_fields import contact_face_of_solid_shoe
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.width.prepare import LARGEST_WIDTH_DEGREE, prepare_model_with_shoe_widths
from drumlin.response.face import pressure_on_face_of_lining
from drumlin.response.response import length_of_edge_zone_left_out_of_peak_search
from wide_shoes import HELD


@pytest.fixture(scope="module")
def solved():
    """A shoe of rigid body with degree 3 across its width, and its prepared model."""
    brake = HELD["rigid"]()
    scene = prepare_model_with_shoe_widths(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], 3)
    return brake, scene, solve_prepared_model(scene, brake)


def test_the_mean_over_the_width_is_the_pressure_of_the_response(solved):
    brake, _, response = solved
    face = pressure_on_face_of_lining(brake, response, 0)
    shoe = response.shoes[0]
    assert face.widths.sum() == pytest.approx(brake.shoes[0].lining.width)
    assert face.theta is shoe.theta
    np.testing.assert_allclose(
        face.mean_pressure_over_width, shoe.pressure, atol=1e-12 * shoe.peak_pressure
    )
    # The pressure varies over the width, or the weights would not matter.
    assert np.ptp(face.pressure, axis=1).max() > 0.01 * shoe.peak_pressure


@pytest.mark.parametrize("degree", [0, 1, 4, LARGEST_WIDTH_DEGREE])
def test_written_pressures_tell_those_of_the_nodes(degree):
    brake = HELD["T-section" if degree == 1 else "rigid"]()
    face = contact_face_of_solid_shoe(
        prepare_model_with_shoe_widths(
            brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], degree
        ).bodies[0]
    )
    p = np.random.default_rng(1).standard_normal(len(face.nodes))
    written = face.pressure_distribution_over_arc_and_width(p)
    np.testing.assert_allclose(face.nodal_pressures_from_pressures_of_file(written), p, atol=1e-10)
    _, mean = face.angles_and_pressures_averaged_over_width(p)
    own = written.pressure @ written.widths / written.widths.sum()
    np.testing.assert_allclose(own, mean, atol=1e-12)
    np.testing.assert_allclose(written.pressure, written.pressure[:, ::-1])


def test_products_with_the_tangential_coupling_are_those_of_the_whole_matrix(solved):
    _, scene, _ = solved
    coupling = scene.bodies[0].coupling
    X = np.random.default_rng(2).standard_normal((coupling.T.shape[1], 3))
    expected = coupling.T @ X
    np.testing.assert_allclose(
        coupling.tangential_coupling_for_products @ X, expected, atol=1e-13 * np.abs(expected).max()
    )


def test_the_peak_is_the_largest_pressure_away_from_the_ends(solved):
    brake, _, response = solved
    face, shoe = pressure_on_face_of_lining(brake, response, 0), response.shoes[0]
    zone = length_of_edge_zone_left_out_of_peak_search(
        brake.shoes[0], brake.length_per_surface_coordinate
    )
    theta = np.linspace(shoe.theta[0] + zone, shoe.theta[-1] - zone, 4001)
    dense = np.array(
        [replace(shoe, pressure=column).pressure_at(theta) for column in face.pressure.T]
    )
    assert face.peak == pytest.approx(dense.max(), rel=1e-4)
    column, at = np.unravel_index(dense.argmax(), dense.shape)
    assert face.peak_theta == pytest.approx(theta[at], abs=0.01)
    assert face.peak_z == pytest.approx(abs(face.z[column]))
    assert face.peak > shoe.peak_pressure
    assert face.error is None


def test_rows_in_json_belong_to_its_angles(solved):
    brake, _, response = solved
    shoe = response.shoes[0]
    data = shoe.as_dict()
    surface = data["surface"]
    pressure = np.array(surface["pressure"])
    assert pressure.shape == (len(data["theta"]), len(surface["z"]))
    assert len(data["theta"]) > len(shoe.theta)
    mean = pressure @ surface["widths"] / brake.shoes[0].lining.width
    inside = np.array(data["pressure"]) > 0.1 * shoe.peak_pressure
    np.testing.assert_allclose(mean[inside], np.array(data["pressure"])[inside], rtol=1e-9)


def test_without_contact_or_width_there_is_no_pressure_on_a_face(solved):
    brake, _, response = solved
    plane = replace(response, shoes=(replace(response.shoes[0], surface=None),))
    assert pressure_on_face_of_lining(brake, plane, 0) is None
