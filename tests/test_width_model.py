"""Brakes with widths: limits in which they are plane stress, balances, and the solid shoes."""

import numpy as np
import pytest

from conftest import partly
from drumlin.base.errors import BadInput
from drumlin.brake.file import read_brake, vary
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.error_control.singular_points import singular_points_of_each_shoe_shape
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.substructure.body import rigid_body_displacements_of_nodes
from drumlin.fem.width.error import LEVEL_OF_PLANE_STRESS_ERROR_ESTIMATE
from drumlin.fem.width.functions import FunctionsAcrossWidth
from drumlin.fem.width.prepare import (
    prepare_model_with_shoe_widths,
    reason_why_width_model_does_not_apply,
    refinement_level_for_narrow_shoes,
)
from drumlin.response.norms import relative_distance_of_pressures, relative_error_of_number
from drumlin_studies.random_kinds import draw_random_brake_of_kind
from sections import widths, without_contraction
from wide_shoes import HELD, plane

QUICK = ("T-section", "post", "grip", "pad")


def wide(brake, degree, level=REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], places=None):
    return solve_prepared_model(prepare_model_with_shoe_widths(brake, level, degree, places), brake)


def assert_same(mine, other, within, reactions=1e-9):
    """All torques agree to `within`, pressures in L2 and reactions more roughly.

    Digits that either answer knows to have lost do not count.
    """
    least = within
    for own, true in zip(mine.shoes, other.shoes, strict=True):
        within = least + own.lost.torque + true.lost.torque
        assert relative_error_of_number(own.normal_force, true.normal_force) == pytest.approx(
            0, abs=within
        )
        assert own.torque == pytest.approx(true.torque, rel=within)
        assert relative_distance_of_pressures(own, true) < 1e-9
        np.testing.assert_allclose(
            own.hinge_reaction, true.hinge_reaction, atol=reactions * true.normal_force
        )


@pytest.mark.parametrize("kind", partly(HELD, QUICK))
def test_degree_zero_is_plane_stress(kind):
    brake = HELD[kind]()
    assert_same(wide(brake, 0), plane(brake), 1e-11)


@pytest.mark.parametrize("kind", partly(HELD, QUICK))
@pytest.mark.parametrize("degree", [1, 2, 3, 5])
def test_without_contraction_one_width_is_plane_stress_at_every_degree(kind, degree):
    brake = without_contraction(HELD[kind]())
    mine, other = wide(brake, degree), plane(brake)
    assert_same(mine, other, 1e-10)
    for shoe, true in zip(mine.shoes, other.shoes, strict=True):
        # Nothing varies over the width.
        apart = np.abs(shoe.surface.pressure.T - shoe.pressure).max()
        assert apart < 1e-7 * true.pressure.max()


@pytest.mark.parametrize("kind", partly(HELD, QUICK))
@pytest.mark.parametrize("degree", [2, 3])
def test_forces_and_moments_balance(kind, degree):
    response = wide(HELD[kind](), degree)
    assert response.balance.force < 1e-9
    assert response.balance.moment < 1e-9


@pytest.mark.parametrize("kind", partly(HELD, QUICK))
def test_rigid_body_modes_strain_nothing(kind):
    brake = HELD[kind]()
    scene = prepare_model_with_shoe_widths(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], 3)
    for body, shoe in zip(scene.bodies, brake.shoes, strict=True):
        inner = body.condensed
        R = rigid_body_displacements_of_nodes(body.line.xy, shoe.pin_position_in_shoe_frame)
        # With the frame held, the forces that move the contact rigidly are those of the frame:
        # S_cc R = -S_cf, here as L L^T R + L L_fc^T = 0.
        forces = inner.L_cc @ (inner.L_cc.T @ R + inner.L_fc.T)
        scale = np.abs(inner.L_cc @ (np.abs(inner.L_cc.T) @ np.abs(R))).max()
        assert np.abs(forces).max() < 1e-9 * scale


def test_as_the_width_goes_to_zero_the_difference_falls_in_proportion(brake):
    apart = []
    for width in (40e-3, 8e-3, 2e-3, 5e-4):
        narrow = widths(brake, width)
        level = refinement_level_for_narrow_shoes(narrow, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0])
        own = wide(narrow, 2), plane(narrow, level)
        apart.append(abs(relative_error_of_number(own[0].torque, own[1].torque)))
    first, second, third, fourth = apart
    # 40 mm is wider than the lining is thick, where the difference has nearly saturated.
    assert second < first / 2
    assert third / second == pytest.approx(1 / 4, rel=0.05)
    assert fourth / third == pytest.approx(1 / 4, rel=0.05)


@pytest.mark.slow
def test_on_the_main_brake_it_is_the_solid_shoes_to_which_hexahedra_converge(brake):
    points = singular_points_of_each_shoe_shape(
        brake, plane(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1])
    )
    functions = FunctionsAcrossWidth((0.0, 17e-3, 20e-3), 4)
    mine = wide(brake, lambda shoe: functions, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1], points)
    # 448.7310 N m is the limit of quadratic hexahedra, 80 of them along each lining, which an
    # earlier solver of drumlin extrapolated.
    assert mine.torque == pytest.approx(448.7310, rel=1e-5)
    ungraded = wide(brake, 4, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1], points)
    assert ungraded.torque == pytest.approx(448.7310, rel=2e-4)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "seed"), [("arc", 1), ("backed", 2), ("misfit", 1), ("cam", 1), ("strut", 2)]
)
def test_on_random_brakes_degree_zero_is_plane_stress(kind, seed):
    brake = draw_random_brake_of_kind(seed, kind)
    assert_same(wide(brake, 0), plane(brake), 1e-11)
    balance = wide(brake, 2, LEVEL_OF_PLANE_STRESS_ERROR_ESTIMATE).balance
    assert max(balance.force, balance.moment) < 1e-9


def test_what_is_not_covered_is_refused_in_a_line(brake, root):
    ring = read_brake(root / "studies" / "post_brake" / "brake.toml")
    assert reason_why_width_model_does_not_apply(brake) is None
    with pytest.raises(BadInput, match="its drum is an elastic ring, whose own width"):
        prepare_model_with_shoe_widths(ring, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], 1)
    with pytest.raises(BadInput, match="its bending_stiffness is not that of a section"):
        prepare_model_with_shoe_widths(
            vary(ring, {"drum.ring": None}), REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], 1
        )
    full = vary(brake, {"shoe.lining.material.nu": 0.4995})
    with pytest.raises(BadInput, match=r"nu = 0\.4995 is all but incompressible; at most 0\.499"):
        prepare_model_with_shoe_widths(full, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], 1)
    with pytest.raises(BadInput, match="--across = 10: must be from 0 to 9"):
        prepare_model_with_shoe_widths(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], 10)
