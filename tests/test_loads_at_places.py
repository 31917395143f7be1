"""Forces at places of an elastic shoe and on its mass, judged by closed forms and balances."""

import math
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import spsolve

import drumlin
from drumlin import BadInput, vary
from drumlin.brake.further_loads import brake_with_all_loads_moved_to_actuation
from drumlin.fem import solid
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.mesh.arc import parametric_mesh_of_shoe
from drumlin.fem.mesh.file import write_shoe_mesh_to_file
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.load_places import unit_loads_at_points_and_mass
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin.fem.substructure.body import sparse_stiffness_of_body
from drumlin.fem.substructure.elasticity import elastic_layers_of_shoe
from drumlin.fem.substructure.loads import FURTHER_FORCE_LOAD_NAME, MASS_LOAD_NAME
from drumlin.verification.triangles.levels import (
    TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE,
    solve_brake_on_one_triangle_mesh,
)
from further_loads import BODY, FORCE, R, brake_with, two_shoes
from held_shoes import KINDS

DIVISIONS = pytest.mark.parametrize(
    "level",
    [pytest.param(REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], marks=pytest.mark.slow), None],
    ids=["hp elements", "mesh"],
)
STEEL = {"E": 2.1e11, "nu": 0.3}
HEAVY: dict[str, Any] = {
    "mass": {"mass": 2.0, "point": {"x": 0.08, "y": 0.02}},
    "brake": {"shoe_speed": 200.0, "gravity": {"direction": -1.5}},
}
INNER = {"force": 400.0, "direction": -2.6, "point": {"x": 0.1, "y": 0.0}}
LOADS = {"forces": {"force": [FORCE, INNER]}, "mass": HEAVY}


def prepared_body(brake: Any, level: Any, elements: int = 16) -> Any:
    """The substructure of the first shoe of a brake."""
    return make_prepared_model(brake, level, elements=elements).bodies[0]


@DIVISIONS
def test_a_rotating_ring_has_the_displacements_of_the_closed_form(level: Any) -> None:
    """A segment of a free ring grows as the whole ring (Timoshenko & Goodier, section 32).

    Lining and body are one material of one width. Its ends slide on rays of the ring.
    """
    half, a, b = 0.9, R - 0.013, R
    thick = {"start": -half, "end": half, "width": 0.04, "material": STEEL}
    # The centre of mass of a segment of a ring of even density.
    centre = 2 / 3 * math.sin(half) / half * (b**3 - a**3) / (b**2 - a**2)
    brake = brake_with(
        lining=thick | {"thickness": 0.001},
        body=thick | {"thickness": 0.012},
        mass={"mass": 1.0, "point": {"x": centre, "y": 0.0}},
        brake={"shoe_speed": 1.0},
    )
    shoe, body = brake.shoes[0], prepared_body(brake, level)
    load = unit_loads_at_points_and_mass(body.basis, shoe, R)[MASS_LOAD_NAME][:, 2]
    K = sparse_stiffness_of_body(body.basis, elastic_layers_of_shoe(shoe))
    x, y = body.basis.doflocs
    radius, angle = np.hypot(x, y), np.arctan2(y, x)
    ends = np.flatnonzero((angle < angle.min() + 1e-9) | (angle > angle.max() - 1e-9))
    sliding = np.zeros((len(ends), len(load)))
    sliding[np.arange(len(ends)), 2 * ends] = -np.sin(angle[ends])
    sliding[np.arange(len(ends)), 2 * ends + 1] = np.cos(angle[ends])
    # The scale of the constraints brings both parts of the matrix to one size.
    sliding = sp.csr_matrix(1e9 * sliding)
    whole = sp.bmat([[K, sliding.T], [sliding, None]], format="csc")
    right = np.append(load, np.zeros(len(ends)))
    u = spsolve(whole, right)[: len(load)].reshape(-1, 2)
    nu, E = STEEL["nu"], STEEL["E"]
    density = 1.0 / (half * (b**2 - a**2) * 0.04)
    wave = a**2 + b**2 + (1 + nu) / (1 - nu) * (a * b / radius) ** 2
    wave -= (1 + nu) / (3 + nu) * radius**2
    grown = (3 + nu) * (1 - nu) / 8 * density / E * radius * wave
    wanted = grown[:, None] * np.array([np.cos(angle), np.sin(angle)]).T
    np.testing.assert_allclose(u, wanted, atol=2e-5 * grown.max())


@DIVISIONS
def test_a_force_bends_a_curved_cantilever_where_it_acts(level: Any) -> None:
    """A radial force at the angle a from the held end: F r^3/(E I) (a/2 - sin(2 a)/4).

    Castigliano's theorem on a thin bar, with a lining that is all but missing.
    """
    at, thickness, width = 0.1, 0.004, 0.04
    brake = brake_with(
        body=BODY | {"thickness": thickness},
        lining={
            "start": -0.95,
            "end": 0.95,
            "thickness": 0.001,
            "width": width,
            "material": {"E": 1e4, "nu": 0.2},
        },
        force=[
            {
                "force": 1.0,
                "direction": at,
                "point": {"x": 0.1 * math.cos(at), "y": 0.1 * math.sin(at)},
            }
        ],
    )
    body, shoe = prepared_body(brake, level, 64), brake.shoes[0]
    columns = body.condensed.columns.column_slice_of_each_load[FURTHER_FORCE_LOAD_NAME]
    along = shoe.frame.convert_vectors_to_shoe_frame(np.array([math.cos(at), math.sin(at)]))
    found = along @ body.flexibility.load_point_motion_by_load[columns, columns] @ along
    angle, radius = at + 1.1, R - 0.001 - thickness / 2
    stiffness = 2.1e11 * width * thickness**3 / 12
    wanted = radius**3 / stiffness * (angle / 2 - math.sin(2 * angle) / 4)
    assert found == pytest.approx(wanted, rel=2e-3)


def test_unit_loads_have_the_resultants_of_their_forces() -> None:
    """Force and moment of each unit load are those of a force at its point, by statics."""
    brake = brake_with(body=BODY, force=[FORCE, INNER], **HEAVY)
    shoe, body = brake.shoes[0], prepared_body(brake, None)
    unit = unit_loads_at_points_and_mass(body.basis, shoe, R)
    x, y = body.basis.doflocs
    points = [each["point"] for each in (FORCE, FORCE, INNER, INNER)] + 3 * [HEAVY["mass"]["point"]]
    forces = [[1, 0], [0, 1]] * 3
    for load, point in zip(np.hstack(list(unit.values())).T, points, strict=True):
        at = shoe.convert_points_to_shoe_frame(np.array([point["x"], point["y"]]))
        # The last unit load is the square of the speed, whose force points away from the centre.
        force = np.array(forces.pop(0) if forces else at)
        fx, fy = load.reshape(-1, 2).T
        assert [fx.sum(), fy.sum()] == pytest.approx(list(force), abs=1e-12)
        assert x @ fy - y @ fx == pytest.approx(at[0] * force[1] - at[1] * force[0], abs=1e-12)


def test_mass_lies_in_the_volume_of_a_section_of_two_widths() -> None:
    """Weight alone acts on a shoe whose centre of mass is that of its volume: no couple is left."""
    half, depths = 1.0, [0.0, 0.001, 0.005, 0.017]
    arc = {"start": -half, "end": half, "material": STEEL}
    table = {"thickness": 0.004, "width": 0.04}
    volume = moment = 0.0
    for near, far, width in zip(depths, depths[1:], (0.04, 0.04, 0.008), strict=False):
        outer, inner = R - near, R - far
        volume += width * half * (outer**2 - inner**2)
        moment += width * 2 / 3 * math.sin(half) * (outer**3 - inner**3)
    brake = brake_with(
        lining=arc | {"thickness": 0.001, "width": 0.04},
        body=arc | {"thickness": 0.012, "width": 0.008, "table": table},
        mass={"mass": 1.0, "point": {"x": moment / volume, "y": 0.0}},
        brake={"gravity": {"direction": 0.0}},
    )
    shoe, body = brake.shoes[0], prepared_body(brake, None, 32)
    load = unit_loads_at_points_and_mass(body.basis, shoe, R)[MASS_LOAD_NAME]
    # Weight square to the line through both centres would have a couple if the centres differed.
    line, weight = shoe.frame.convert_vectors_to_shoe_frame(np.eye(2))
    along = load[:, :2].reshape(-1, 2, 2) @ weight @ line
    assert np.abs(along).max() < 1e-5 * np.abs(load).max()


@DIVISIONS
@pytest.mark.parametrize("loads", LOADS.values(), ids=LOADS)
def test_the_work_of_the_loads_is_the_energy_of_the_body(level: Any, loads: Any) -> None:
    """Clapeyron's theorem, and equilibrium of each unit load with its reactions."""
    brake = brake_with(body=BODY, **loads)
    body, shoe = prepared_body(brake, level), brake.shoes[0]
    unit = unit_loads_at_points_and_mass(body.basis, shoe, R)
    K = sparse_stiffness_of_body(body.basis, elastic_layers_of_shoe(shoe))
    x, y = body.basis.doflocs - shoe.pin_position_in_shoe_frame[:, None]
    for name, forces in unit.items():
        columns = body.condensed.columns.column_slice_of_each_load[name]
        for k, column in enumerate(range(columns.start, columns.stop)):
            factors = np.eye(body.condensed.columns.number_of_load_columns)[column]
            u = body.condensed.nodal_displacements_in_one_case(
                np.zeros(len(body.condensed.L_cc)), np.zeros(3), factors
            )
            u = u.T.ravel()
            work = float(forces[:, k] @ u)
            assert u @ (K @ u) == pytest.approx(work, rel=1e-9)
            assert body.flexibility.load_point_motion_by_load[column, column] == pytest.approx(
                work, rel=1e-9
            )
            fx, fy = forces[:, k].reshape(-1, 2).T
            given = np.array([fx.sum(), fy.sum(), x @ fy - y @ fx])
            held = body.flexibility.reaction_to_load[:, column]
            np.testing.assert_allclose(held, -given, atol=1e-9 * np.abs(given).max())


@pytest.mark.parametrize(
    "kind", ["hinge", *(pytest.param(kind, marks=pytest.mark.slow) for kind in KINDS)]
)
def test_forces_at_places_are_balanced_on_each_support(kind: str) -> None:
    """Forces and moments balance to 1e-9."""
    response = solve(brake_with(kind, body=BODY, force=[FORCE]), elements=12)
    assert response.torque > 0
    assert max(response.balance.force, response.balance.moment) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("loads", LOADS.values(), ids=LOADS)
def test_hp_elements_and_meshes_have_the_same_brake(loads: Any) -> None:
    """The torque of a fine mesh and of hp elements agree."""
    brake = brake_with(body=BODY, **loads)
    fine = solve(brake)
    assert solve(brake, elements=96).torque == pytest.approx(fine.torque, rel=2e-5)
    assert max(fine.balance.force, fine.balance.moment) < 1e-9


def test_places_do_not_matter_on_a_stiff_body() -> None:
    """A body of steel bends under its loads; a rigid one feels their resultant alone."""
    apart = []
    for modulus in (2.1e11, 2.1e21):
        brake = brake_with(body=BODY | {"material": STEEL | {"E": modulus}}, force=[FORCE, INNER])
        own = solve(brake, elements=12)
        at_end = solve(brake_with_all_loads_moved_to_actuation(brake), elements=12)
        apart.append(abs(own.torque / at_end.torque - 1))
    assert apart[0] > 1e-4
    assert apart[1] < 1e-9


def test_a_brake_of_other_places_needs_another_model() -> None:
    """A prepared model serves other sizes of its forces, and refuses other places."""
    brake = brake_with(body=BODY, force=[FORCE])
    scene = make_prepared_model(brake, elements=8)
    larger = vary(brake, {"shoe.force[0].force": 200.0})
    direct = solve_prepared_model(make_prepared_model(larger, elements=8), larger)
    assert solve_prepared_model(scene, larger).torque == pytest.approx(direct.torque, rel=1e-12)
    with pytest.raises(BadInput, match="sizes of loads"):
        solve_prepared_model(scene, vary(brake, {"shoe.force[0].point.x": "40 mm"}))


def test_mirrored_shoes_share_a_body_with_their_places() -> None:
    """A spring at both shoes: their points are mirror images, and both shoes have one body."""
    spring = {
        "shoe": "right",
        "to": "left",
        "point": {"x": 0.05, "y": 0.03},
        "end": {"x": -0.05, "y": 0.03},
        "preload": 100.0,
    }
    scene = make_prepared_model(two_shoes(body=True, spring=[spring]), elements=8)
    assert scene.bodies[0] is scene.bodies[1]
    spring["end"] = {"x": -0.05, "y": 0.04}
    scene = make_prepared_model(two_shoes(body=True, spring=[spring]), elements=8)
    assert scene.bodies[0] is not scene.bodies[1]


@pytest.mark.slow
def test_solid_shoes_say_where_their_forces_act() -> None:
    """A shoe with its widths has loads where its actuation acts, and a note says so."""
    response = solid.solve(brake_with(body=BODY, force=[FORCE]), across=1)
    assert any("act where its actuation acts" in note for note in response.notes)
    plane = solve(brake_with(body=BODY, force=[FORCE]))
    assert not any("act where its actuation acts" in note for note in plane.notes)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "shoe"),
    [("double_shoe", 0), ("post_brake", 0)],
)
@pytest.mark.parametrize("loads", ["forces", "mass"])
def test_triangles_agree_on_arcs_and_straight_beams(file: str, shoe: int, loads: str) -> None:
    """The second solver has the same torques and peaks, on a shoe on an arc and on a post."""
    brake = drumlin.example(file)
    data = brake.model_dump(by_alias=True, exclude_none=True)
    middle = brake.shoes[shoe].lining.middle
    size = brake.size
    at = {"x": 0.8 * size * math.cos(middle + 0.2), "y": 0.8 * size * math.sin(middle + 0.2)}
    own = data["shoe"][shoe]
    force = brake.shoes[shoe].actuation.force
    if loads == "forces":
        own["force"] = [{"force": 0.3 * force, "direction": middle, "point": at}]
    else:
        own["mass"] = {"mass": 2.0, "point": at}
        # The centrifugal force is a third of the actuation force.
        data["shoe_speed"] = math.sqrt(0.3 * force / (2.0 * 0.8 * size))
    data.get("drum", {}).pop("ring", None)
    loaded = drumlin.brake.file.make_drum_brake_from_data(data)
    fine = solve_brake_on_one_triangle_mesh(loaded, TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE[0])
    for a, b in zip(solve(loaded).shoes, fine, strict=True):
        assert a.torque == pytest.approx(b.torque, rel=2e-4)


@pytest.mark.slow
@pytest.mark.parametrize("loads", LOADS.values(), ids=LOADS)
def test_a_mesh_file_has_the_loads_of_the_parametric_shoe(tmp_path: Any, loads: Any) -> None:
    """Raised degrees on the elements of a file, split at corners, and hp elements agree."""
    brake = brake_with(body=BODY, **loads)
    path = tmp_path / "shoe.msh"
    write_shoe_mesh_to_file(path, parametric_mesh_of_shoe(brake.shoes[0], R, 24), brake.shoes[0])
    meshed = vary(brake, {"shoe.mesh": str(path)})
    found, true = solve(meshed), solve(brake)
    assert found.torque == pytest.approx(true.torque, rel=1e-5)
    assert found.shoes[0].peak_pressure == pytest.approx(true.shoes[0].peak_pressure, rel=5e-3)
    assert not any("act where its actuation acts" in note for note in found.notes)
