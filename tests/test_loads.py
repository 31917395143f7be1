"""Unit loads of a body by name: a body takes further unit loads in addition to its actuation."""

import numpy as np
import pytest

from drumlin.brake.file import read_brake
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.hp import body as body_path
from drumlin.fem.hp import shoe as shoe_path
from drumlin.fem.hp.shoe import UnitLoadsOnLoadedEndFace, unit_actuation_loads_on_end_face
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.bodies import actuation_factors_and_pin_moment_per_newton
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.substructure.body import condense_body_to_contact_and_hinge_face
from drumlin.fem.substructure.elasticity import elastic_layers_of_shoe
from drumlin.fem.substructure.loads import ACTUATION_LOAD_NAME, ColumnsOfUnitLoads

FURTHER = "further force"
TWO = ColumnsOfUnitLoads(((ACTUATION_LOAD_NAME, 3), (FURTHER, 1)))


@pytest.fixture
def brake(root):
    return read_brake(root / "studies" / "double_shoe" / "brake.toml")


def with_further_force(xy, depths, p):
    """The unit actuations, and a unit force along y on the first node of the loaded end."""
    end = unit_actuation_loads_on_end_face(xy, depths, p)
    force = np.zeros((len(end.forces), 1))
    force[1] = 1.0
    moment = np.array([[0.0], [1.0], [xy[0, 0] - end.centre[0]]])
    return UnitLoadsOnLoadedEndFace(
        np.hstack([end.forces, force]), TWO, end.centre, np.hstack([end.moments, moment])
    )


@pytest.fixture
def further(monkeypatch):
    """Every condensed body in hp elements has the further unit load."""
    for module in (shoe_path, body_path):
        monkeypatch.setattr(module, "unit_actuation_loads_on_end_face", with_further_force)


def test_factors_name_the_loads_that_act():
    assert TWO.number_of_load_columns == 4
    assert TWO.column_factors_of_all_loads({FURTHER: np.array([2.0])}).tolist() == [
        0.0,
        0.0,
        0.0,
        2.0,
    ]
    factors = TWO.column_factors_of_all_loads({ACTUATION_LOAD_NAME: np.array([1.0, 2.0, 3.0])})
    assert TWO.column_factors_of_one_named_load(ACTUATION_LOAD_NAME, factors).tolist() == [
        1.0,
        2.0,
        3.0,
    ]
    assert TWO.column_factors_of_one_named_load(FURTHER, factors).tolist() == [0.0]
    assert ColumnsOfUnitLoads().column_factors_of_all_loads({}).shape == (0,)
    with pytest.raises(KeyError):
        TWO.column_factors_of_all_loads({"heat": np.array([1.0])})


def test_a_further_force_on_hp_elements_is_what_one_factorisation_leaves(brake, further):
    shoe, body = (
        brake.shoes[0],
        make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1]).bodies[0],
    )
    assert body.load_matrix_columns_by_load_name == TWO
    assert body.flexibility.gap_closure_by_load.shape == (len(body.line.nodes), 4)
    assert body.flexibility.load_point_motion_by_load.shape == (4, 4)
    _, ties, loads, _ = body.condensed.assemble_equations_of_whole_body()
    named = {ACTUATION_LOAD_NAME: loads[:, :3], FURTHER: loads[:, 3:]}
    other = condense_body_to_contact_and_hinge_face(
        body.basis.stiffness(elastic_layers_of_shoe(shoe)), ties, named, 2 * len(body.line.nodes)
    )
    assert other.columns == TWO
    for name in ("load_on_contact", "load_on_frame", "load_work"):
        mine, theirs = getattr(body.condensed, name), getattr(other, name)
        assert mine == pytest.approx(theirs, abs=1e-8 * np.abs(theirs).max())


def test_the_frame_bears_a_further_force(brake, further):
    """All of the force, and its moment about the pin, held where the contact is free."""
    shoe, body = (
        brake.shoes[0],
        make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1]).bodies[0],
    )
    held = body.flexibility.reaction_to_load @ TWO.column_factors_of_all_loads(
        {FURTHER: np.array([1.0])}
    )
    x = body.basis.doflocs[0, body.basis.sets["actuation"][0]]
    assert held == pytest.approx([0.0, -1.0, -(x - shoe.pin_position_in_shoe_frame[0])], abs=1e-8)


def test_a_load_that_does_not_act_changes_no_answer(brake, further, monkeypatch):
    scene = make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1])
    factors, _ = actuation_factors_and_pin_moment_per_newton(scene.bodies[0], brake.shoes[0])
    assert factors.shape == (4,) and factors[3] == 0.0
    found = solve_prepared_model(scene, brake)
    monkeypatch.undo()
    assert found.torque == pytest.approx(
        solve_prepared_model(
            make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1]), brake
        ).torque,
        rel=1e-9,
    )
