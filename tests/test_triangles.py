"""The triangle solver against closed forms, itself, and the finite elements it judges."""

import math
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drumlin.base.errors import NoAnswer
from drumlin.brake.elasticity import ElasticLayer
from drumlin.brake.fields import Material
from drumlin.brake.file import make_drum_brake_from_data, read_brake, vary
from drumlin.fem.solve import solve
from drumlin.verification.triangles import (
    DegreeAndGradingOfTriangleMesh,
    contact,
    lagrange,
    levels,
    solve_brake_on_sequence_of_triangle_meshes,
)
from drumlin.verification.triangles.equations import ContactEquations
from drumlin.verification.triangles.face import (
    gauss_points_lengths_and_shape_functions_on_curved_edges,
    node_numbers_along_edges,
    triangle_body_with_nodes_and_stiffness,
)
from drumlin.verification.triangles.outline import OutlineOfLayeredBody
from drumlin.verification.triangles.triangulation import (
    LayerOfTriangulatedBody,
    bisect_marked_triangles_without_hanging_nodes,
    edges_of_mesh_and_of_each_triangle,
    grade_mesh_towards_points,
    triangulate_grid_of_layered_body,
)
from drumlin_studies.random_brake import draw_random_brake
from drumlin_studies.stated_true import relative_pressure_error_of_shoe

pytestmark = pytest.mark.slow

SMALL = (
    DegreeAndGradingOfTriangleMesh(3, 5, 1.4, 1.0),
    DegreeAndGradingOfTriangleMesh(5, 7, 1.2, 1.0),
)


def block(a, b):
    """A grid of a rectangle in a plane in which s and d are lengths."""
    elastic = ElasticLayer.make_layer_in_plane_stress(Material(E=1.0, nu=0.0), 1.0)
    return triangulate_grid_of_layered_body(
        np.linspace(0, a, 4), [np.linspace(0, 1, 3)], [LayerOfTriangulatedBody(0.0, a, elastic)]
    )


def area(mesh):
    first, second = mesh.at[:, 1] - mesh.at[:, 0], mesh.at[:, 2] - mesh.at[:, 0]
    return 0.5 * np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**30))
def test_bisection_keeps_area_and_fits(seed):
    rng, mesh = np.random.default_rng(seed), block(2.0, 1.0)
    for _ in range(5):
        mesh = bisect_marked_triangles_without_hanging_nodes(
            mesh, rng.random(len(mesh.layer)) < 0.2
        )
    assert area(mesh).sum() == pytest.approx(2.0, rel=1e-12)
    places = {}
    for number, at in zip(mesh.vertices.ravel(), mesh.at.reshape(-1, 2), strict=True):
        # A corner of several triangles has one place.
        assert places.setdefault(int(number), tuple(at)) == tuple(at)
    assert len(set(places.values())) == len(places)
    edges, of = edges_of_mesh_and_of_each_triangle(mesh)
    once = np.flatnonzero(np.bincount(of.ravel()) == 1)
    ends = np.array([[places[int(a)], places[int(b)]] for a, b in edges[once]])
    on_border = (ends == np.array([0.0, 0.0])) | (ends == np.array([2.0, 1.0]))
    # No node may hang inside the mesh.
    assert on_border.all(axis=1).any(axis=1).all()


def test_triangles_are_as_small_as_their_distance_asks():
    def plane(s, d):
        return np.stack([s, d], axis=-1)

    mesh = grade_mesh_towards_points(
        block(2.0, 1.0), plane, np.array([[2 / 3, 0.0]]), np.array([1e-4]), 0.8
    )
    corners = mesh.at
    size = np.hypot(*np.moveaxis(corners - np.roll(corners, -1, axis=1), 2, 0)).max(axis=1)
    away = np.hypot(*(corners.mean(axis=1) - [2 / 3, 0.0]).T)
    assert (size <= np.maximum(0.8 * away, 1e-4)).all()
    assert size.min() < 1e-4 and len(size) < 1500


@pytest.mark.parametrize("degree", [2, 3, 4, 5])
def test_shape_functions_are_lagranges_and_carry_all_polynomials(degree):
    nodes = lagrange.nodes_of_reference_triangle(degree)
    assert len(nodes) == (degree + 1) * (degree + 2) // 2
    assert nodes.sum(axis=1) == pytest.approx(1.0, abs=1e-14)
    value, slopes, weights = lagrange.triangle_shape_functions_gradients_and_weights(degree)
    assert value.sum(axis=0) == pytest.approx(1.0, abs=1e-12)
    assert slopes.sum(axis=0) == pytest.approx(0.0, abs=1e-10)
    # Int x^a y^b over the triangle = a! b! / (a + b + 2)!
    for a in range(degree + 1):
        b = degree - a
        found = (nodes[:, 1] ** a * nodes[:, 2] ** b) @ value @ weights
        assert found == pytest.approx(
            math.factorial(a) * math.factorial(b) / math.factorial(degree + 2), rel=1e-10
        )


def test_ring_under_even_pressure_is_lames():
    """A ring under even pressure is Lame's in plane stress.

    The outer rim is held: u = A r + B/r with A (1 + nu) - B (1 - nu)/a^2 = -p (1 - nu^2)/E, A b +
    B/b = 0.
    """
    a, b, E, nu, width, p = 0.1, 0.13, 2e11, 0.3, 0.04, 1e6
    layer = LayerOfTriangulatedBody(
        -math.inf, math.inf, ElasticLayer.make_layer_in_plane_stress(Material(E=E, nu=nu), width)
    )

    def place(s, d):
        r = a + (b - a) * d
        return np.stack([r * np.cos(s), r * np.sin(s)], axis=-1)

    shape = OutlineOfLayeredBody(
        place, [layer], np.array([b - a]), np.zeros(2), np.zeros((0, 2)), None, None, 0.0, 1, a
    )
    mesh = triangulate_grid_of_layered_body(
        np.linspace(0, 2 * math.pi, 25), [np.linspace(0, 1, 3)], [layer], 2 * math.pi
    )
    body = triangle_body_with_nodes_and_stiffness(shape, mesh, 4)
    nodes, kept = body.nodes, body.surface
    tri, edge = mesh.indices_of_triangle_edges_on_friction_surface
    edges = node_numbers_along_edges(nodes, tri, edge, 4)
    psi, x, ds = gauss_points_lengths_and_shape_functions_on_curved_edges(nodes.xy[edges], 4)
    loads = np.zeros_like(nodes.xy)
    outwards = x / np.hypot(x[..., 0], x[..., 1])[..., None]
    np.add.at(loads, edges, width * p * np.einsum("aq,kqc,kq->kac", psi, outwards, ds))
    held = np.repeat(nodes.at[:, 1] > 1 - 1e-12, 2)
    found = lagrange.condense_body_to_kept_nodes(body.K, nodes, held, kept, loads.reshape(-1, 1))
    by_forces = found.under_unit_forces @ loads[kept].ravel()
    assert by_forces == pytest.approx(
        found.loaded[:, 0], rel=1e-9, abs=1e-9 * np.abs(by_forces).max()
    )
    A, B = np.linalg.solve([[1 + nu, -(1 - nu) / a**2], [b, 1 / b]], [-p * (1 - nu**2) / E, 0.0])
    radial = np.einsum("nc,nc->n", by_forces.reshape(-1, 2), nodes.xy[kept]) / a
    assert radial == pytest.approx(A * a + B / a, rel=1e-7)
    work = found.work[0, 0]
    assert work == pytest.approx(p * width * 2 * math.pi * a * (A * a + B / a), rel=1e-6)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**30), st.floats(0.0, 0.3))
def test_contact_sets_settle_on_the_one_that_fits(seed, skew):
    """Contact sets of the triangle solver settle on the one that fits.

    All contact sets are tried on problems whose A is positive definite, skewed as friction does.
    """
    rng, n = np.random.default_rng(seed), 6
    X, Y = rng.normal(size=(n, n)), rng.normal(size=(n, n))
    A = X @ X.T + 0.3 * np.eye(n) + skew * (Y - Y.T)
    B, q = -(0.5 + rng.random((n, 1))), 0.1 * rng.normal(size=n)
    C, h = -B.T, np.array([1.0])
    equations = ContactEquations(
        A, q, B, C, np.zeros((1, 1)), h, np.ones(n), np.zeros(1, dtype=bool)
    )
    found = contact.solve_contact_complementarity(equations, np.ones(n, dtype=bool))
    right = []
    for size in range(1, n + 1):
        for members in combinations(range(n), size):
            a = list(members)
            system = np.block([[A[np.ix_(a, a)], B[a]], [C[:, a], np.zeros((1, 1))]])
            f = np.zeros(n)
            x = np.linalg.solve(system, np.concatenate([-q[a], h]))
            f[a] = x[:-1]
            if f.min() >= 0 and (q + A @ f + B @ x[-1:]).min() >= -1e-10:
                right.append(f)
    assert len(right) >= 1
    assert min(np.abs(found.force - f).max() for f in right) < 1e-9


def pressed_circle(half):
    """A thick lining of a 3 % smaller radius on a rigid shoe, and Hertz's half-width [rad]."""
    R, r, E, width = 0.15, 0.1455, 3e8, 0.04
    force = math.pi / 4 * (half * R) ** 2 * E * (1 / r - 1 / R) * width
    return make_drum_brake_from_data(
        {
            "title": "circle",
            "rotation": "clockwise",
            "friction": 0.0,
            "drum": {"radius": R},
            "shoe": [
                {
                    "name": "s",
                    "side": "internal",
                    "hinge": {"x": 0.0, "y": -0.6 * R},
                    "lining": {
                        "start": -0.6,
                        "end": 0.6,
                        "thickness": R / 3,
                        "width": width,
                        "material": {"E": E, "nu": 0.3},
                        "misfit": {"radius": r},
                    },
                    "actuation": {"force": force, "direction": 0.0, "point": {"x": 0.0, "y": 0.0}},
                }
            ],
        }
    )


def test_of_two_answers_triangles_find_the_one_that_grows_from_no_friction():
    """Of two answers the triangle solver finds the one that grows from no friction.

    A shoe presses with its end; another answer, with the whole lining, has 3.5 times its torque.
    """
    brake = draw_random_brake(5820)
    *_, (found,) = solve_brake_on_sequence_of_triangle_meshes(brake, SMALL[:1])
    assert found.torque == pytest.approx(solve(brake, tolerance=1e-3).torque, rel=1e-3)
    (other,) = levels.solve_brake_on_one_triangle_mesh(
        brake, levels.COARSE_MESH_LEVEL_TO_FIND_CONTACT_ENDS
    )
    assert other.torque > 3 * found.torque


def test_a_small_contact_is_hertzs():
    """A small contact by triangles is Hertz's, p = p0 sqrt(1 - (x/a)^2).

    a^2 = 4 P'/(pi E (1/r - 1/R)) in plane stress against a rigid drum; a/t = 0.03.
    """
    *_, (found,) = solve_brake_on_sequence_of_triangle_meshes(
        pressed_circle(math.radians(0.5)), SMALL
    )
    R, r, E = 0.15, 0.1455, 3e8
    load = found.normal_force / 0.04
    a = math.sqrt(4 * load / (math.pi * E * (1 / r - 1 / R)))
    p0 = 2 * load / (math.pi * a)
    middle = found.arcs.mean()
    assert np.diff(found.arcs[0])[0] * R == pytest.approx(2 * a, rel=2e-3)
    theta = middle + np.linspace(-0.95, 0.95, 201) * a / R
    hertz = p0 * np.sqrt(1 - ((theta - middle) * R / a) ** 2)
    assert np.linalg.norm(found.pressure_at(theta) - hertz) < 2e-3 * np.linalg.norm(hertz)


def test_moments_and_forces_of_a_solution_are_in_equilibrium(brake):
    mild = vary(brake, {"shoe.lining.clearance": 5e-5})
    for shoe, found in zip(
        mild.shoes, solve_brake_on_sequence_of_triangle_meshes(mild, SMALL[:1])[-1], strict=True
    ):
        half = 0.5 * np.diff(found.theta[:: found.order])[:, None]
        gauss, weights = np.polynomial.legendre.leggauss(8)
        theta = found.theta[: -1 : found.order][:, None] + half * (1 + gauss)
        load = found.pressure_at(theta) * half * weights * mild.drum.radius * shoe.lining.width
        e = np.array([np.cos(theta), np.sin(theta)])
        drag = mild.friction * mild.sign_of_motion
        force = (
            load * (-shoe.sign_internal_plus_external_minus * e + drag * np.array([-e[1], e[0]]))
        ).sum(axis=(1, 2))
        total = force + shoe.actuation.force_vector + found.hinge_reaction
        assert np.linalg.norm(total) < 1e-4 * np.linalg.norm(force)
        assert found.torque == pytest.approx(
            mild.friction * mild.drum.radius * load.sum(), rel=1e-5
        )
        x, y = shoe.hinge.xy
        at_pin = drag * mild.drum.radius * load.sum() - (x * force[1] - y * force[0])
        assert at_pin == pytest.approx(
            -shoe.actuation.moment_of_force_about_point(shoe.hinge), rel=1e-4
        )


def test_a_shoe_that_is_pulled_off_has_no_solution(brake):
    with pytest.raises(NoAnswer, match="towards"):
        levels.solve_brake_on_one_triangle_mesh(
            vary(brake, {"shoe[0].actuation.force": -10.0}), SMALL[0]
        )


RING = {"thickness": 0.015, "width": 0.04, "material": {"E": 120e9, "nu": 0.25}}
CASES = {
    "as it is": {},
    "clearance and out of round": {
        "shoe.lining.clearance": 5e-5,
        "drum.out_of_round": [{"order": 3, "amplitude": 5e-5, "phase": 0.3}],
    },
    "rigid": {"shoe.body": None},
    "backing": {"shoe.backing": {"thickness": 0.004, "material": {"E": 1e10, "nu": 0.3}}},
    "fixed ring": {"drum.ring": RING | {"support": "fixed"}},
    "free ring": {"drum.ring": RING | {"support": "free"}},
}


@pytest.mark.parametrize("case", CASES)
def test_the_finite_elements_agree(case, brake):
    """Torque, reactions and p of two codes that share no mesh, no element and no contact."""
    changed = vary(brake, CASES[case])
    theirs = solve_brake_on_sequence_of_triangle_meshes(changed, SMALL)[-1]
    mine = solve(changed, tolerance=1e-3)
    for a, b in zip(mine.shoes, theirs, strict=True):
        assert a.torque == pytest.approx(b.torque, rel=5e-5)
        assert relative_pressure_error_of_shoe(a, b) < 3e-3
        assert np.linalg.norm(a.hinge_reaction - b.hinge_reaction) < 1e-4 * np.linalg.norm(
            b.hinge_reaction
        )


def test_a_post_and_its_mirror_image_are_the_same(root):
    two = vary(
        read_brake(root / "studies" / "post_brake" / "brake.toml"),
        {"drum.ring": None, "friction": 0.0},
    )
    right, left = levels.solve_brake_on_one_triangle_mesh(two, SMALL[0])
    assert left.normal_force == pytest.approx(right.normal_force, rel=1e-9)
    assert left.hinge_reaction == pytest.approx(right.hinge_reaction * [-1, 1], rel=1e-6)
    theirs = solve(two, tolerance=1e-2).shoes[0]
    assert np.linalg.norm(theirs.hinge_reaction - right.hinge_reaction) < 2e-3 * np.linalg.norm(
        right.hinge_reaction
    )
