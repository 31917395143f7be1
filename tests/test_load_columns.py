"""Further load columns on condensed bodies, judged by closed forms of heated bodies."""

import numpy as np
import pytest

from drumlin.brake import read_brake, read_drum_or_plane_brake, vary
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.preparation.bodies import (
    ShoeBodyElements,
    ShoeSubstructure,
    make_shoe_substructure,
    unit_load_factors_under_all_loads,
)
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.substructure.body import (
    condense_body_to_contact_and_hinge_face,
    multi_point_constraints_of_body,
    sparse_stiffness_of_body,
)
from drumlin.fem.substructure.elasticity import elastic_layers_of_ring, elastic_layers_of_shoe
from drumlin.fem.substructure.expansion import (
    nodal_forces_of_thermal_expansion,
    stress_times_width_of_free_strain,
)
from drumlin.fem.substructure.loads import ACTUATION_LOAD_NAME, HEAT_LOAD_NAME
from drumlin.fem.substructure.ring import indices_of_displacements_that_hold_free_ring

STRAIN = 1e-3
"""Free strain of the heated bodies: some 80 K of steel."""
EVEN = np.array([STRAIN, STRAIN])
RING = {"thickness": 0.015, "width": 0.06, "material": {"E": 1.1e11, "nu": 0.26}}
DIVISIONS = pytest.mark.parametrize(
    "level", [REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1], None], ids=["hp elements", "mesh"]
)


@pytest.fixture
def brake(root):
    return read_brake(root / "studies" / "double_shoe" / "brake.toml")


def everywhere(strain):
    """The function of a free strain that is the same at all points (2, ...)."""
    return lambda points: np.multiply.outer(strain, np.ones(points.shape[1:]))


def heated(condensed, basis, layers, strain=EVEN):
    """The body with a further load: a free strain in all of its layers."""
    forces = nodal_forces_of_thermal_expansion(
        basis, layers, dict.fromkeys(layers, everywhere(strain))
    )
    return condensed.body_with_further_loads({HEAT_LOAD_NAME: forces[:, None]})


def displacement(body, **factors):
    """Displacements (2, nodes) of a body under its loads without contact, by load factors."""
    loads = body.columns.column_factors_of_all_loads(
        {name: np.array([value]) for name, value in factors.items()}
    )
    return body.nodal_displacements_in_one_case(np.zeros(len(body.L_cc)), np.zeros(3), loads)


def free_body(brake, level):
    """The first shoe of a brake on three statically determinate unknowns, with its basis."""
    body, shoe = make_prepared_model(brake, level, elements=16).bodies[0], brake.shoes[0]
    basis, contact = body.basis, body.line.nodes
    inner = np.setdiff1d(np.arange(basis.N), contact)
    held = indices_of_displacements_that_hold_free_ring(basis, inner)
    constraints = multi_point_constraints_of_body(basis, contact, inner[:0], np.zeros(2), held)
    layers = elastic_layers_of_shoe(shoe)
    condensed = condense_body_to_contact_and_hinge_face(
        sparse_stiffness_of_body(basis, layers), constraints, {}, 2 * len(contact)
    )
    return condensed, basis, layers, held


@DIVISIONS
def test_a_free_body_with_an_even_strain_grows_without_stress(brake, level):
    condensed, basis, layers, (x_held, _, y_held) = free_body(brake, level)
    u = displacement(heated(condensed, basis, layers), heat=1.0)
    # The body grows by the strain about the first held node, and turns until the other one's y is
    # held: a rotation is small, so that the growth stays exact.
    first, other = x_held // 2, y_held // 2
    arm = basis.doflocs - basis.doflocs[:, [first]]
    turn = -STRAIN * arm[1, other] / arm[0, other]
    exact = STRAIN * arm + turn * np.array([-arm[1], arm[0]])
    assert u == pytest.approx(exact, abs=1e-8 * np.abs(exact).max())


@DIVISIONS
@pytest.mark.parametrize("support", ["fixed", "free"])
def test_a_heated_ring_has_the_displacements_of_the_closed_form(brake, level, support):
    """A free ring grows by the strain times its radius; a fixed one by Lame's formulas."""
    brake = vary(brake, {"drum.ring": RING | {"support": support}})
    ring, R = make_prepared_model(brake, level, elements=40).ring, brake.size
    section = brake.ring.section
    u = displacement(heated(ring.condensed, ring.basis, elastic_layers_of_ring(section)), heat=1.0)
    xy = ring.basis.doflocs
    r = np.hypot(*xy)
    if support == "free":
        # Three unknowns hold the free ring: a rigid-body motion is taken off.
        modes = np.array([[1 + 0 * r, 0 * r, -xy[1]], [0 * r, 1 + 0 * r, xy[0]]])
        flat = modes.transpose(2, 0, 1).reshape(-1, 3)
        change = (u - STRAIN * xy).T.ravel()
        assert change == pytest.approx(
            flat @ np.linalg.lstsq(flat, change)[0], abs=1e-8 * STRAIN * R
        )
        return
    # u = e r + C_1 r + C_2/r, held at the outer radius and without stress at the inner one.
    nu, outer = section.material.nu, R + section.thickness
    conditions = np.array([[outer, 1 / outer], [1 + nu, -(1 - nu) / R**2]])
    C_1, C_2 = np.linalg.solve(conditions, [-STRAIN * outer, 0.0])
    exact = STRAIN * r + C_1 * r + C_2 / r
    along = (u * xy).sum(axis=0) / r
    assert along == pytest.approx(exact, abs=(1e-6 if level else 2e-4) * np.abs(exact).max())


@DIVISIONS
def test_a_clamped_body_is_pressed_as_plane_stress_tells(root, level):
    """The stress is -E alpha T/(1 - nu) in all directions, and the clamps bear it."""
    brake = read_drum_or_plane_brake(root / "studies" / "brakes" / "rail_clamp.toml")
    shoe = brake.shoes[0]
    body = make_prepared_model(brake, level, elements=16).bodies[0]
    layer = elastic_layers_of_shoe(shoe)["lining"]
    material = shoe.lining.material
    pressed = material.E * STRAIN / (1 - material.nu)
    points = body.line.xy
    sigma = stress_times_width_of_free_strain(layer, everywhere(EVEN)(points), points) / layer.width
    assert sigma == pytest.approx(
        np.broadcast_to((pressed * np.eye(2))[:, :, None], sigma.shape), rel=1e-12
    )
    forces = nodal_forces_of_thermal_expansion(
        body.basis, elastic_layers_of_shoe(shoe), {"lining": everywhere(EVEN)}
    ).reshape(-1, 2)
    length = np.ptp(body.line.xy[0])
    # The forces that the free strain puts on the clamped friction surface, y away from the plane.
    clamped = forces[body.line.nodes].sum(axis=0)
    assert clamped == pytest.approx(
        [0.0, -pressed * length * layer.width], abs=1e-9 * pressed * length * layer.width
    )
    assert forces.sum(axis=0) == pytest.approx([0.0, 0.0], abs=1e-9 * np.abs(forces).sum())


@DIVISIONS
def test_a_free_straight_body_swells_through_its_layers_alone(root, level):
    brake = read_drum_or_plane_brake(root / "studies" / "brakes" / "rail_clamp.toml")
    condensed, basis, layers, (x_held, _, y_held) = free_body(brake, level)
    u = displacement(heated(condensed, basis, layers, np.array([0.0, STRAIN])), heat=1.0)
    first, other = x_held // 2, y_held // 2
    arm = basis.doflocs - basis.doflocs[:, [first]]
    turn = -STRAIN * arm[1, other] / arm[0, other]
    exact = np.array([0 * arm[0], STRAIN * arm[1]]) + turn * np.array([-arm[1], arm[0]])
    assert u == pytest.approx(exact, abs=1e-8 * np.abs(exact).max())


def test_further_columns_are_those_of_one_elimination_of_all_loads(brake):
    """A further load has the same result by element-wise elimination and by elimination at once."""
    shoe, body = (
        brake.shoes[0],
        make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0]).bodies[0],
    )
    warm = heated(body.condensed, body.basis, elastic_layers_of_shoe(shoe))
    assert warm.columns.sizes == ((ACTUATION_LOAD_NAME, 3), (HEAT_LOAD_NAME, 1))
    _, constraints, loads, _ = warm.assemble_equations_of_whole_body()
    named = {ACTUATION_LOAD_NAME: loads[:, :3], HEAT_LOAD_NAME: loads[:, 3:]}
    K = body.basis.stiffness(elastic_layers_of_shoe(shoe))
    other = condense_body_to_contact_and_hinge_face(K, constraints, named, 2 * len(body.line.nodes))
    for name in ("load_on_contact", "load_on_frame", "load_work"):
        mine, theirs = getattr(warm, name), getattr(other, name)
        assert np.array_equal(mine[:, :3][:3], getattr(body.condensed, name)[:3])
        largest = np.abs(theirs).max(axis=0)
        assert (np.abs(mine - theirs) <= 1e-8 * largest).all()
    nodal = np.ones(len(warm.L_cc))
    factors = warm.columns.column_factors_of_all_loads(
        {ACTUATION_LOAD_NAME: np.array([1.0, 2.0, 3.0]), HEAT_LOAD_NAME: np.array([0.1])}
    )
    mine, theirs = (
        each.nodal_displacements_in_one_case(nodal, np.ones(3), factors) for each in (warm, other)
    )
    assert mine == pytest.approx(theirs, abs=1e-8 * np.abs(theirs).max())


@DIVISIONS
def test_a_name_is_given_to_one_load(brake, level):
    shoe, body = brake.shoes[0], make_prepared_model(brake, level, elements=8).bodies[0]
    warm = heated(body.condensed, body.basis, elastic_layers_of_shoe(shoe))
    with pytest.raises(ValueError, match="heat"):
        heated(warm, body.basis, elastic_layers_of_shoe(shoe))


@DIVISIONS
def test_a_shoe_is_coupled_with_all_its_columns(brake, level):
    """The gap closes as the heated lining grows; the actuation keeps its own factors."""
    shoe, body = brake.shoes[0], make_prepared_model(brake, level, elements=40).bodies[0]
    warm = heated(body.condensed, body.basis, elastic_layers_of_shoe(shoe))
    division = ShoeBodyElements(body.mesh, body.basis, body.line)
    coupled = make_shoe_substructure(
        ShoeSubstructure,
        shoe,
        division,
        warm,
        body.application_point_of_actuation_loads,
        friction=True,
    )
    # A further column changes the round-off of the other columns on a mesh.
    np.testing.assert_allclose(
        coupled.flexibility.gap_closure_by_load[:, :3],
        body.flexibility.gap_closure_by_load,
        rtol=0,
        atol=1e-12 * np.abs(body.flexibility.gap_closure_by_load).max(),
    )
    u = displacement(warm, heat=1.0)[:, body.line.nodes].T.ravel()
    closed = coupled.flexibility.gap_closure_by_load[:, 3]
    assert closed == pytest.approx(coupled.coupling.N @ u, abs=1e-8 * np.abs(closed).max())
    assert unit_load_factors_under_all_loads(coupled, shoe, 10.0)[3] == 1.0
    assert unit_load_factors_under_all_loads(coupled, shoe, 10.0)[:3] == pytest.approx(
        unit_load_factors_under_all_loads(body, shoe, 10.0)
    )
