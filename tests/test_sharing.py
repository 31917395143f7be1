"""Shoes that share a force, under a cam and by a strut, by finite elements."""

import math
from typing import Any

import numpy as np
import pytest

import drumlin
from drumlin import NoAnswer, vary
from drumlin.fem.equilibrium.group import divide_pressed_shoes_into_groups
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.bodies import actuation_factors_and_pin_moment_per_newton
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.substructure.body import sparse_stiffness_of_body
from drumlin.fem.substructure.elasticity import elastic_layers_of_shoe
from drumlin.laws import solve_brake_by_its_rigid_shoe_law
from drumlin.response.balance import brake_with_forces_of_response
from drumlin.response.merit import brake_factor
from drumlin.verification import triangles
from picking import picked
from shared_forces import R, cam_brake, servo


@pytest.mark.parametrize("make", [cam_brake, servo])
@pytest.mark.parametrize("spin", [1, -1])
def test_rigid_shoes_with_thin_linings_share_as_by_the_law(make: Any, spin: int) -> None:
    brake = make(spin)
    fem, rigid = drumlin.solve(brake), solve_brake_by_its_rigid_shoe_law(brake)
    assert fem.torque == pytest.approx(rigid.torque, rel=3e-3)
    for a, b in zip(fem.shoes, rigid.shoes, strict=True):
        assert a.force == pytest.approx(b.force, rel=3e-3)
        assert a.torque == pytest.approx(b.torque, rel=4e-3)


def test_under_a_cam_the_tips_of_elastic_shoes_go_the_same_way() -> None:
    """Under a cam the tips of elastic shoes move by equal amounts.

    Each shoe alone under its share is the reference; the work of a small change gives its tip.
    """
    brake = cam_brake(body=0.012, thickness=0.006)
    scene = make_prepared_model(brake, elements=40)
    both = solve_prepared_model(scene, brake)
    assert sum(picked(both.shoes, "force")) == pytest.approx(2000.0, rel=1e-9)
    assert abs(both.shoes[0].force / both.shoes[1].force - 1) > 0.1
    alone = vary(brake_with_forces_of_response(brake, both), {"actuation": None})
    tips = []
    for i, group in enumerate(divide_pressed_shoes_into_groups(scene, alone, 1e6)):
        found = group.solve_contact_for_given_abutment_friction()
        own = group.contact_effects_of_each_actuation_force(group.brake.friction)[0]
        tip = group.largest_actuation_force * (
            own.load_point_travel_by_pressure @ found.p
            + own.load_point_travel_by_force
            + own.load_point_travel_by_modes @ found.y
        )
        tips.append(tip)
        shoe = solve_prepared_model(scene, alone).shoes[i]
        assert shoe.torque == pytest.approx(both.shoes[i].torque, rel=1e-8)
        np.testing.assert_allclose(
            shoe.pressure, both.shoes[i].pressure, atol=1e-7 * shoe.peak_pressure
        )
    assert tips[0] == pytest.approx(tips[1], rel=1e-8)


@pytest.mark.slow
def test_a_cam_feels_the_corners_of_the_loaded_ends() -> None:
    """A cam feels the singular corners of the loaded ends of its shoes.

    Where the table of a T-section ends under the load the stress is singular. Triangles agree to
    3e-6.
    """
    brake = cam_brake(
        body=0.02, thickness=0.012, web=0.002, table={"thickness": 0.004, "width": 0.04}
    )
    (true,) = triangles.solve_brake_on_sequence_of_triangle_meshes(
        brake, triangles.TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE[:1]
    )
    found = solve_prepared_model(
        make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1]),
        brake,
        penalty=math.inf,
    )
    for a, b in zip(found.shoes, true, strict=True):
        assert a.hinge_reaction == pytest.approx(
            b.hinge_reaction, abs=1e-5 * np.linalg.norm(b.hinge_reaction)
        )


def test_the_tip_moves_as_the_energy_says() -> None:
    """The tip of a frictionless shoe moves by tip = dW/dF, with W = F tip/2.

    The force's work is the elastic energy; dW/dF is a central difference.

    The brake is linear where the contact does not change with the force, as without gaps.
    """
    brake = vary(
        cam_brake(body=0.012, thickness=0.006, mu=0.0),
        {"actuation": None, "shoe.actuation.force": 1000.0},
    )
    scene = make_prepared_model(brake, elements=30)
    (group, _) = divide_pressed_shoes_into_groups(scene, brake, math.inf)
    found, own = (
        group.solve_contact_for_given_abutment_friction(),
        group.contact_effects_of_each_actuation_force(group.brake.friction)[0],
    )
    tip = (
        own.load_point_travel_by_pressure @ found.p
        + own.load_point_travel_by_force
        + own.load_point_travel_by_modes @ found.y
    )
    body, part = group.substructures_of_shoes[0], group.contact_node_slices_of_shoes[0]
    nodal = -body.coupling.N.T @ found.p[part]
    u = body.condensed.nodal_displacements_in_one_case(
        nodal, np.array([0.0, 0.0, found.y[0]]), _load(group)
    )
    energy = 0.5 * float(
        u.T.ravel()
        @ (
            sparse_stiffness_of_body(body.basis, elastic_layers_of_shoe(group.shoes[0]))
            @ u.T.ravel()
        )
    )
    assert 0.5 * tip == pytest.approx(energy, rel=1e-6)


def _load(group: Any) -> Any:
    return actuation_factors_and_pin_moment_per_newton(
        group.substructures_of_shoes[0], group.shoes[0]
    )[0]


@pytest.mark.parametrize("make", [cam_brake, servo])
def test_every_shoe_and_the_whole_brake_balance(make: Any) -> None:
    brake = make(body=0.012)
    response = drumlin.solve(brake)
    assert max(response.balance.force, response.balance.moment) < 1e-9
    under = brake_with_forces_of_response(brake, response)
    outside = picked(under.shoes, "actuation.force_vector") + picked(
        response.shoes, "hinge_reaction"
    )
    # The strut acts on both shoes alike.
    if brake.links:
        a, b = response.shoes
        assert a.hinge_reaction == pytest.approx(-under.shoes[1].actuation.force_vector, rel=1e-9)
        assert np.linalg.norm(a.hinge_reaction) == pytest.approx(b.force, rel=1e-9)
    total = np.sum(outside, axis=0) + -response.bearing_load
    assert np.linalg.norm(total) < 1e-9 * max(map(np.linalg.norm, outside))


def test_what_a_strut_passes_on_is_no_actuation() -> None:
    """The brake factor is T/(F R) with the force F on the first shoe alone."""
    brake = servo()
    response = drumlin.solve(brake, elements=20)
    assert response.shoes[1].force > 1.1 * 1000.0
    assert brake_factor(brake, response) == pytest.approx(response.torque / (1000.0 * R), rel=1e-12)


@pytest.mark.parametrize("make", (cam_brake, servo))
def test_a_locked_cam_or_strut_is_refused_with_its_limit(make) -> None:
    with pytest.raises(NoAnswer, match=r"self-locking|would have to pull|no equilibrium"):
        drumlin.solve(make(mu=3.0), elements=30)
