"""Derivatives by a body's points and by bending stiffness agree with finite differences."""

import json
import math
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial
from typing import Any

import meshio
import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from command_line import drumlin
from conftest import ROOT
from drumlin.brake.brake import Brake
from drumlin.brake.elasticity import ElasticLayer, plane_stress_elasticity_matrix
from drumlin.brake.fields import Material
from drumlin.brake.file import make_drum_brake_from_data, read_brake, vary
from drumlin.fem.analysis.mutual_work import (
    mutual_elastic_work_in_each_part_of_body,
    mutual_work_derivatives_by_node_motions,
)
from drumlin.fem.analysis.sensitivity import compute_torque_sensitivity, sensitivity_as_text_lines
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.hp.grid import HpElementGrid
from drumlin.fem.mesh.arc import parametric_mesh_of_shoe
from drumlin.fem.mesh.degree import nodal_basis_of_mesh
from drumlin.fem.mesh.file import write_shoe_mesh_to_file
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import prepared_model_with_finest_elements, solve
from drumlin.fem.substructure.body import (
    DEGREES_OF_FREEDOM_OF_BODY_FRAME,
    sparse_stiffness_of_body,
)
from drumlin_studies import consistency_slopes
from drumlin_studies.consistency_slopes import (
    MeshKindForSlopes,
    all_torque_sensitivities_printed_for_brake,
    largest_relative_difference_from_central_differences,
)
from drumlin_studies.random_brake import draw_random_brake
from drumlin_studies.random_kinds import draw_random_brake_of_support_kind
from shared_parts import modulus_slopes

ELEMENTS = 10
POST = {
    "name": "post",
    "side": "external",
    "hinge": {"x": 0.16, "y": -0.13},
    "lining": {
        "start": -0.5,
        "end": 0.45,
        "thickness": 0.01,
        "width": 0.04,
        "material": {"E": 5e8, "nu": 0.3},
    },
    "backing": {"thickness": 0.03, "material": {"E": 1e9, "nu": 0.3}},
    "body": {"shape": "beam", "thickness": 0.02, "width": 0.02, "material": {"E": 2e10, "nu": 0.3}},
}
TOP = {
    "name": "top",
    "side": "external",
    "abutment": {"point": {"x": 0.16, "y": 0.13}, "direction": -0.3},
    "lining": {
        "start": 1.2,
        "end": 2.0,
        "thickness": 0.01,
        "width": 0.04,
        "material": {"E": 5e8, "nu": 0.3},
    },
    "body": {
        "thickness": 0.01,
        "width": 0.04,
        "start": 1.1,
        "end": 2.1,
        "material": {"E": 2e10, "nu": 0.3},
    },
    "actuation": {"force": 1000.0, "direction": np.pi + 0.8, "point": {"x": -0.06, "y": 0.13}},
}
RING = {
    "drum.ring": {
        "thickness": 0.02,
        "width": 0.05,
        "material": {"E": 5e10, "nu": 0.3},
        "support": "free",
    }
}


def along(brake: Brake, i: int, key: str, way: int, s: float) -> Brake:
    """The brake with a point of shoe i moved by s along x (0) or y (1)."""
    part: Any = brake.shoes[i]
    for name in key.split("."):
        part = getattr(part, name)
    return vary(
        brake, {f"shoe[{i}].{key}": {"x": part.x + s * (way == 0), "y": part.y + s * (way == 1)}}
    )


def on_mesh(brake: Brake) -> Any:
    return make_prepared_model(brake, elements=ELEMENTS)


def on_columns(brake: Brake) -> Any:
    return make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0])


def central(
    brake: Brake, i: int, key: str, way: int, torque: Callable[[Brake], float], step: float
) -> float:
    h = step * brake.size
    up, down = torque(along(brake, i, key, way, h)), torque(along(brake, i, key, way, -h))
    return (up - down) / (2 * h)


# Seeds whose slope had the wrong sign, or was off by more than its size, while the body stayed in
# its place.
WRONG = [
    (partial(draw_random_brake, 51, "post"), "hinge", 1),
    (partial(draw_random_brake, 12, "post"), "hinge", 1),
    (partial(draw_random_brake_of_support_kind, 6, "pivot"), "pivot", 0),
    (partial(draw_random_brake, 9, "post"), "hinge", 0),
    (partial(draw_random_brake_of_support_kind, 15, "grip"), "pivot", 1),
    (partial(draw_random_brake_of_support_kind, 11, "pivot"), "pivot", 1),
]


@pytest.mark.parametrize("scene", [on_mesh, on_columns])
@pytest.mark.parametrize(
    ("draw", "key", "way"),
    [
        case if k % 2 == 0 else pytest.param(*case, marks=pytest.mark.slow)
        for k, case in enumerate(WRONG)
    ],
)
def test_a_slope_along_a_point_is_that_of_solves_whose_body_moves_with_it(draw, key, way, scene):
    brake = draw()
    exact = float(compute_torque_sensitivity(scene(brake), brake).shoes[0].held[key][way])
    # within larger steps nodes come into contact, and the torque has a kink
    for step in (3e-5, 1e-5, 3e-6):
        near = central(
            brake, 0, key, way, lambda other: solve_prepared_model(scene(other), other).torque, step
        )
        assert exact == pytest.approx(near, rel=1e-3), step


@pytest.mark.slow
@pytest.mark.parametrize("name", ["brakes/crane.toml", "post_brake/brake.toml"])
def test_slopes_of_the_studies_are_those_of_solves_by_default(name):
    brake = read_brake(ROOT / "studies" / name)
    for i, own in enumerate(
        compute_torque_sensitivity(prepared_model_with_finest_elements(brake), brake).shoes
    ):
        for key, value in own.held.items():
            for way, exact in enumerate(value):
                for step in (1e-2, 3e-3, 1e-3):
                    near = central(brake, i, key, way, lambda other: solve(other).torque, step)
                    assert exact == pytest.approx(near, rel=0.01), (own.name, key, way)


@pytest.mark.slow
@pytest.mark.parametrize("support", ["free", "fixed"])
@pytest.mark.parametrize("elements", [None, ELEMENTS])
def test_a_grip_on_an_elastic_ring_moves_the_contact_of_the_ring_too(elements, support):
    brake = vary(
        draw_random_brake_of_support_kind(0, "pivot"), RING | {"drum.ring.support": support}
    )
    assert largest(brake, elements, "pivot") < 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("elements", [None, ELEMENTS])
def test_a_strut_moves_the_loaded_end_of_the_post_that_it_pushes(elements):
    data = {
        "title": "strut",
        "rotation": "clockwise",
        "friction": 0.3,
        "drum": {"radius": 0.1},
        "shoe": [TOP, POST],
    }
    brake = make_drum_brake_from_data(data | {"link": [{"from": "top", "to": "post"}]})
    assert largest(brake, elements) < 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("elements", [None, ELEMENTS])
def test_posts_under_a_cam_share_its_force_anew_as_their_hinges_move(elements):
    right = POST | {"actuation": {"direction": np.pi - 0.1, "point": {"x": 0.165, "y": 0.13}}}
    lining = POST["lining"] | {"start": np.pi - 0.45, "end": np.pi + 0.5}
    left = POST | {"name": "left", "hinge": {"x": -0.16, "y": -0.13}, "lining": lining}
    left |= {"actuation": {"direction": 0.1, "point": {"x": -0.16, "y": 0.13}}}
    data = {
        "title": "cam",
        "rotation": "clockwise",
        "friction": 0.3,
        "drum": {"radius": 0.1},
        "shoe": [right, left],
    }
    assert (
        largest(make_drum_brake_from_data(data | {"actuation": {"force": 2000.0}}), elements) < 1e-4
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "draw"),
    [("post", draw_random_brake), ("rough abutment", draw_random_brake_of_support_kind)],
)
def test_a_mesh_in_the_shoes_frame_turns_with_its_pin(kind, draw, tmp_path):
    brake = draw(3, kind)
    shoe, path = brake.shoes[0], tmp_path / "shoe.msh"
    write_shoe_mesh_to_file(path, parametric_mesh_of_shoe(shoe, brake.size, ELEMENTS), shoe)
    mesh = meshio.read(path)
    mesh.points[:, :2] = shoe.convert_points_to_shoe_frame(mesh.points[:, :2])
    mesh.write(path, file_format="gmsh22", binary=False)
    assert (
        largest(vary(brake, {"shoe.mesh": str(path), "shoe.mesh_frame": "shoe"}), ELEMENTS) < 1e-4
    )


def largest(brake: Brake, elements: int | None, key: str = "") -> float:
    """The largest relative difference of slopes whose names begin with a key.

    Differences over three steps are the reference.
    """
    divided = MeshKindForSlopes(elements, consistency_slopes.CacheOfCondensedBodies())
    base = divided.solve_brake_for_torque(brake)
    table = [
        slope
        for slope in all_torque_sensitivities_printed_for_brake(
            brake, divided.compute_derivatives_of_brake_torque(brake)
        )
        if slope.what.startswith(key)
    ]
    apart = [
        largest_relative_difference_from_central_differences(brake, slope, divided, base)
        for slope in table
    ]
    assert len(table) > 1
    assert None not in apart
    return max(each for each in apart if each is not None)


@pytest.mark.parametrize("scene", [on_mesh, on_columns])
def test_a_bending_stiffness_has_a_slope_of_its_own_and_the_modulus_beside_it_none(scene):
    brake = draw_random_brake(5, "arc on ring")
    body, ring = brake.shoes[0].body, brake.ring
    EI = {
        "shoe[0].body.bending_stiffness": body.plates["shoe"].bending_stiffness,
        "drum.ring.bending_stiffness": ring.EI,
    }
    given = vary(brake, EI)
    plain, found = (
        compute_torque_sensitivity(scene(brake), brake),
        compute_torque_sensitivity(scene(given), given),
    )
    # the section is the same, and plane stress feels the product of modulus and width alone
    assert found.shoes[0].bending_stiffness == pytest.approx(
        plain.shoes[0].moduli["shoe"], rel=1e-9
    )
    assert found.ring_bending_stiffness == pytest.approx(plain.ring, rel=1e-9)
    assert "shoe" not in found.shoes[0].moduli
    assert found.ring is None
    assert (plain.shoes[0].bending_stiffness, plain.ring_bending_stiffness) == (None, None)
    torque = {}
    for key in (*EI, "shoe[0].body.material.E", "drum.ring.material.E"):
        for s in (1e-3, -1e-3):
            value = EI.get(key) or (body if "body" in key else ring).material.E
            other = vary(given, {key: value * (1 + s)})
            torque[key, s] = solve_prepared_model(scene(other), other).torque
    near = [
        (torque[key, 1e-3] - torque[key, -1e-3]) / 2e-3 for key in (*EI, "shoe[0].body.material.E")
    ]
    assert near[0] == pytest.approx(found.shoes[0].bending_stiffness, rel=1e-4)
    assert near[1] == pytest.approx(found.ring_bending_stiffness, rel=1e-4)
    # A larger width makes up for a smaller modulus.
    assert abs(near[2]) < 1e-6 * abs(near[0])
    text = " ".join(sensitivity_as_text_lines(found, given))
    assert "d ln T/d ln bending_stiffness of the drum ring" in text
    assert "d ln T/d ln bending_stiffness: shoe" in text
    assert "E of the drum ring" not in text


def test_the_command_writes_bending_stiffnesses_under_their_names(tmp_path):
    file = tmp_path / "s.json"
    post = ROOT / "studies/post_brake/brake.toml"
    done = drumlin("sensitivity", post, "--elements", 8, "--json", file)
    assert done.returncode == 0
    data, said = json.loads(file.read_text()), " ".join(done.stdout.split())
    assert data["ring"] is None
    assert (
        f"bending_stiffness of the drum ring {data['ring_bending_stiffness'] / data['torque']:+.4g}"
        in said
    )
    for shoe in data["shoes"]:
        assert set(shoe["moduli"]) == {"lining", "backing"}
        assert f"bending_stiffness: shoe {shoe['bending_stiffness'] / data['torque']:+.4g}" in said


BODIES = {
    "columns": on_columns,
    "mesh": on_mesh,
    "triangles": lambda brake: make_prepared_model(brake, elements=6, kind="tri2"),
}


def at_nodes(xy: np.ndarray) -> np.ndarray:
    """A smooth field (2, n) at points (2, n)."""
    x, y = xy / 0.1
    return np.array([np.sin(3 * y), x * y])


def moved(basis: Any, step: float) -> Any:
    """The basis of the body with its nodes moved by the field times a step."""
    if isinstance(basis, HpElementGrid):
        found = replace(basis)
        vars(found)["doflocs"] = basis.doflocs + step * at_nodes(basis.doflocs)
        return found
    mesh = basis.mesh
    places = mesh.doflocs + step * at_nodes(mesh.doflocs)
    return nodal_basis_of_mesh(type(mesh)(places, mesh.t, _subdomains=mesh.subdomains))


ORTHOTROPIC = np.array([[9.0, 0.8, 0.0], [0.8, 3.0, 0.0], [0.0, 0.0, 2.5]])


def some_layers(names: Iterable[str], *, directed: bool) -> dict[str, ElasticLayer]:
    """A layer of each name, the first around the centre, the others straight.

    Each layer is stiffer than the one before.
    """
    found = {}
    for k, name in enumerate(names):
        matrix = (
            ORTHOTROPIC if directed else plane_stress_elasticity_matrix(Material(E=1.0, nu=0.2))
        )
        found[name] = ElasticLayer(
            1e9 * (k + 1) * matrix, 0.03, np.array([0.6, -0.8]) if k else None
        )
    return found


@pytest.mark.parametrize("directed", [False, True], ids=["isotropic", "orthotropic"])
@pytest.mark.parametrize("name", BODIES)
def test_the_mutual_work_is_that_of_the_assembled_stiffness_and_so_is_its_change(name, directed):
    """The mutual work and its change are those of the assembled stiffness.

    Nodes are moved and the stiffness assembled anew for a central difference.
    """
    body = BODIES[name](draw_random_brake(3, "post")).bodies[0]
    basis, size = body.basis, np.abs(body.basis.doflocs).max()
    u, v = np.random.default_rng(0).standard_normal((2, 2 * basis.N))
    layers = some_layers(body.mesh.subdomains, directed=directed)
    whole = v @ (sparse_stiffness_of_body(basis, layers) @ u)
    assert sum(
        mutual_elastic_work_in_each_part_of_body(basis, layers, u, v).values()
    ) == pytest.approx(whole, rel=1e-9)
    h = 1e-6 * size
    ahead, behind = (v @ (sparse_stiffness_of_body(moved(basis, s), layers) @ u) for s in (h, -h))
    moves = at_nodes(basis.doflocs).T.reshape(1, -1)
    exact = mutual_work_derivatives_by_node_motions(basis, layers, u, v, moves, [0.0])[0]
    assert exact == pytest.approx((ahead - behind) / (2 * h), rel=1e-4)


@pytest.mark.parametrize("name", BODIES)
def test_the_mutual_work_changes_as_the_axis_of_straight_layers_turns(name):
    """No node moves; the directions of the straight layers turn, by a central difference."""
    body = BODIES[name](draw_random_brake(3, "post")).bodies[0]
    basis = body.basis
    u, v = np.random.default_rng(1).standard_normal((2, 2 * basis.N))
    layers = some_layers(body.mesh.subdomains, directed=True)

    def turned(angle: float) -> dict[str, ElasticLayer]:
        c, s = math.cos(angle), math.sin(angle)
        turn = np.array([[c, -s], [s, c]])
        return {
            part: layer if layer.along is None else layer._replace(along=turn @ layer.along)
            for part, layer in layers.items()
        }

    h = 1e-5
    ahead, behind = (
        v @ (sparse_stiffness_of_body(basis, turned(h)) @ u),
        v @ (sparse_stiffness_of_body(basis, turned(-h)) @ u),
    )
    exact = mutual_work_derivatives_by_node_motions(
        basis, layers, u, v, np.zeros((1, 2 * basis.N)), [1.0]
    )[0]
    assert exact == pytest.approx((ahead - behind) / (2 * h), rel=1e-6)


def test_displacements_on_columns_come_without_a_factorisation_of_the_whole(monkeypatch):
    """Displacements on columns need no factorisation of the whole shoe.

    This factorisation had an index limit, met at 270 000 nodes, and wrote on standard output.
    """

    def refuse(*_: Any, **__: Any) -> None:
        raise AssertionError("the whole stiffness of a body of columns is not put together")

    brake = draw_random_brake(3, "arc on ring")
    scene = on_columns(brake)
    monkeypatch.setattr(HpElementGrid, "stiffness", refuse)
    monkeypatch.setattr("scipy.sparse.linalg.splu", refuse)
    found = compute_torque_sensitivity(scene, brake)
    moduli = modulus_slopes(found)
    assert math.fsum([*moduli, found.ring or 0.0]) == pytest.approx(
        0.0, abs=1e-7 * max(map(abs, moduli))
    )


@pytest.mark.parametrize("kind", ["arc", "post on ring", "linings on ring"])
def test_displacements_by_way_of_the_sides_of_elements_are_those_of_the_whole_system(kind):
    scene, rng = on_columns(draw_random_brake(3, kind)), np.random.default_rng(1)
    for body in [*scene.bodies, scene.ring]:
        if body is None:
            continue
        condensed = body.condensed
        nodal = (
            body.coupling.N.T @ rng.random((len(body.line.nodes), 2))
            if hasattr(body, "coupling")
            else None
        )
        nodal = rng.standard_normal((2 * len(body.line.nodes), 2)) if nodal is None else nodal
        frame, loads = (
            np.zeros((DEGREES_OF_FREEDOM_OF_BODY_FRAME, 2)),
            rng.standard_normal((condensed.load_on_contact.shape[1], 2)),
        )
        inside = condensed.assemble_equations_of_whole_body()
        right = inside.loads[:-DEGREES_OF_FREEDOM_OF_BODY_FRAME] @ loads
        right[-len(nodal) :] += nodal
        u = spsolve(
            inside.A[
                :-DEGREES_OF_FREEDOM_OF_BODY_FRAME, :-DEGREES_OF_FREEDOM_OF_BODY_FRAME
            ].tocsc(),
            right,
        )
        expected = inside.constraints.matrix @ np.vstack([u, frame])
        found = condensed.nodal_displacements_in_load_cases(nodal, frame, loads)
        assert np.abs(found - expected).max() < 1e-6 * np.abs(expected).max()


@pytest.mark.parametrize(
    "seed", range(3, 2 * len(consistency_slopes.KINDS_OF_RANDOM_BRAKES_FOR_SLOPE_CHECK), 7)
)
@pytest.mark.slow
def test_random_brakes_of_all_kinds_keep_their_slopes(seed):
    rows = consistency_slopes.rows_comparing_torque_slopes_of_random_brake(seed, 1)
    assert all(row.outcome == "agrees" for row in rows), rows


@pytest.mark.slow
def test_more_random_brakes_keep_their_slopes():
    outcomes = [
        row.outcome
        for seed in range(1000, 1104)
        for row in consistency_slopes.rows_comparing_torque_slopes_of_random_brake(seed)
    ]
    assert len(outcomes) > 280
    assert set(outcomes) == {"agrees"}
