"""The weak coupling on the arc: resultants, areas, balance and patch, on meshes fine and coarse."""

import math

import numpy as np
import pytest
import skfem

from conftest import STUDY
from drumlin.brake.file import read_brake, vary
from drumlin.brake.surface import FRICTION_SURFACE_OF_DRUM
from drumlin.contact import active_set
from drumlin.fem.mesh.degree import nodal_basis_of_mesh
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.substructure.interface import (
    ContactLine,
    coupling_matrices_of_contact_line,
    function_that_returns_drum_normals_and_tangents,
    make_contact_line_of_lining,
)
from drumlin.fem.substructure.ring import coupling_matrices_of_lining_and_ring
from drumlin.response.resultants import (
    integral_of_piecewise_polynomial,
    planar_cross_product,
    resultant_of_pressure_and_friction,
)
from drumlin_studies import two_bodies as pair


@pytest.fixture(scope="module", params=[3, 10, 80])
def body(request, brake):
    return make_prepared_model(brake, elements=request.param).bodies[0]


@pytest.fixture(scope="module")
def brake():
    return read_brake(STUDY / "brake.toml")


def test_the_contact_line_is_the_lining_from_end_to_end(body, brake):
    line = body.line
    assert (np.diff(line.phi) > 0).all()
    assert (line.phi[0], line.phi[-1]) == pytest.approx(brake.shoes[0].arc, rel=1e-12)
    assert np.hypot(*line.xy) == pytest.approx(brake.drum.radius, rel=1e-14)
    assert line.pieces[-1, :-1] == pytest.approx(line.pieces[0, 1:])


def test_area_and_lever_are_those_of_the_arc(body, brake):
    shoe = brake.shoes[0]
    phi_1, phi_2 = shoe.arc
    area = shoe.lining.width * brake.drum.radius * (phi_2 - phi_1)
    tolerance = 0.02 * ((phi_2 - phi_1) / body.line.pieces.shape[1]) ** 4 + 1e-12
    assert body.coupling.areas_of_contact_nodes.sum() == pytest.approx(area, rel=tolerance)
    assert body.coupling.lever.sum() == pytest.approx(area * brake.drum.radius, rel=tolerance)


def test_normal_pressure_has_no_moment_about_the_centre_and_drag_has_the_torque(body):
    rng = np.random.default_rng(1)
    p = rng.random(len(body.line.nodes))
    normal = (body.coupling.N.T @ p).reshape(-1, 2)
    drag = (body.coupling.T.T @ p).reshape(-1, 2)
    torque = float(body.coupling.lever @ p)
    assert float(planar_cross_product(body.line.xy.T, drag).sum()) == pytest.approx(
        torque, rel=1e-13
    )
    assert abs(float(planar_cross_product(body.line.xy.T, normal).sum())) < 1e-13 * torque


def test_nodal_forces_have_the_resultant_of_the_traction(brake):
    """Nodal forces have the resultant of the traction integrated over the exact arc.

    Both differ by the chord error of the mesh, of which the integration knows nothing.
    """
    shoe = brake.shoes[0]
    body = make_prepared_model(brake, elements=80).bodies[0]
    phi = body.line.phi
    p = 1e6 * np.sin(phi)
    force = (-body.coupling.N.T @ p + 0.3 * body.coupling.T.T @ p).reshape(-1, 2).sum(axis=0)
    R = brake.drum.radius
    exact = resultant_of_pressure_and_friction(
        FRICTION_SURFACE_OF_DRUM,
        phi,
        p,
        order=2,
        size=R,
        per_place=R * shoe.lining.width,
        sign=1,
        drag=0.3,
    )
    assert force == pytest.approx(exact.force, rel=1e-7)


@pytest.mark.parametrize("sign", [1, -1])
def test_patch_test_on_the_arc(sign):
    """A ring pressed into a ring by interference has Lame's even pressure on unmatched meshes.

    Even to the error of the arcs, which falls with more than the second power of the element;
    forces and moment on both rings balance to round-off. The pressure is carried by the inner ring
    (sign 1) or by the outer one.
    """
    interference, exact, spreads, means = 1e-4, lame_interference(1e-4), [], []
    for inside, outside in ((24, 30), (48, 60), (96, 120)):
        rings = [
            pair.condense_body_to_contact_nodes(
                pair.plane_mesh_of_closed_ring(angles, np.linspace(0, 0.4, depth), 1.0, way),
                pair.STEEL_OF_KNOWN_ANSWER_CASES,
            )
            for angles, depth, way in ((circle(inside), 5, -1), (circle(outside) + 0.01, 6, 1))
        ]
        both = pair.InnerAndOuterBodyInContact.couple_two_bodies_at_contact_nodes(
            *rings[::sign], sign=sign
        )
        found = active_set.solve_contact_problem(
            both.frictionless_contact_problem(np.full(len(both.contact_node_angles), -interference))
        )
        spreads.append(np.ptp(found.p) / exact)
        means.append(abs(found.p.mean() / exact - 1))
        mine, other = rings[::sign]
        for ours, theirs in zip(
            (both.coupling.N, both.coupling.T),
            coupling_matrices_of_lining_and_ring(mine.line, other.line, 1.0, sign),
            strict=True,
        ):
            a, b = (ours.T @ found.p).reshape(-1, 2), (theirs.T @ found.p).reshape(-1, 2)
            scale = np.abs(a).sum()
            assert b.sum(axis=0) == pytest.approx(a.sum(axis=0), abs=1e-13 * scale)
            moments = [
                float(planar_cross_product(mine.line.xy.T, a).sum()),
                float(planar_cross_product(other.line.xy.T, b).sum()),
            ]
            assert moments[1] == pytest.approx(moments[0], abs=1e-13 * scale)
    assert spreads[0] > 4 * spreads[1] > 16 * spreads[2]
    assert spreads[2] < 5e-6
    assert max(means) < 5e-5 and means[2] < 5e-6


def circle(count):
    return np.linspace(-math.pi, math.pi, count + 1)[:-1]


def lame_interference(interference):
    """Pressure between two rings of R = 1, held at r = 0.6 and r = 1.4, in plane stress.

    u = A r + B/r, and u = 0 where the rings are held.
    """
    E, nu = pair.STEEL_OF_KNOWN_ANSWER_CASES.E, pair.STEEL_OF_KNOWN_ANSWER_CASES.nu
    # Both bodies have a radial displacement per pressure.
    yielding = 0.0
    for held in (0.6, 1.4):
        A, B = 1.0, -(held**2)
        yielding += abs((A + B) * (1 - nu**2) / E / ((1 + nu) * A - (1 - nu) * B))
    return interference / yielding


def test_integrals_of_piecewise_polynomials():
    theta = np.linspace(0.2, 1.4, 41)
    assert integral_of_piecewise_polynomial(theta, np.sin(theta), 2) == pytest.approx(
        math.cos(0.2) - math.cos(1.4), rel=1e-8
    )
    assert integral_of_piecewise_polynomial(theta, np.sin(theta), 1) == pytest.approx(
        math.cos(0.2) - math.cos(1.4), rel=1e-3
    )
    assert integral_of_piecewise_polynomial(theta, theta**2, 2) == pytest.approx(
        (1.4**3 - 0.2**3) / 3, rel=1e-14
    )


def test_an_external_lining_sees_its_drum_from_the_other_side(brake):
    external = vary(
        brake,
        {
            "shoe.side": "external",
            "shoe.hinge": {"x": 0.05, "y": -0.2},
            "shoe.actuation.direction": math.pi,
        },
    )
    body = make_prepared_model(external, elements=10).bodies[0]
    assert np.hypot(*body.basis.doflocs).min() == pytest.approx(brake.drum.radius, rel=1e-12)


# The integrals Int psi_i psi_j over a straight edge of length 1 are known.
STRAIGHT = {
    1: np.array([[2, 1], [1, 2]]) / 6,
    2: np.array([[4, 2, -1], [2, 16, 2], [-1, 2, 4]]) / 30,
}


@pytest.mark.parametrize("order", [1, 2])
def test_the_matrices_of_straight_edges_are_those_of_the_book(order):
    """The coupling matrices of two straight edges are those of the textbook.

    The edges, of lengths 2 and 1, lie on x = 3 from y = -1 to 2; directions are given, not radial.
    """
    y = np.array([-1.0, 0, 1, 1.5, 2])[:: 3 - order]
    line = ContactLine(
        np.arange(len(y)),
        np.array([np.full(len(y), 3.0), y]),
        y,
        np.arange(order + 1)[:, None] + [0, order],
    )
    found = coupling_matrices_of_contact_line(
        line,
        0.5,
        lambda x: (np.ones_like(x) * [[[0.6]], [[0.8]]], np.ones_like(x) * [[[-0.8]], [[0.6]]]),
    )
    M = np.zeros((len(y), len(y)))
    for first, length in ((0, 2.0), (order, 1.0)):
        M[first : first + order + 1, first : first + order + 1] += 0.5 * length * STRAIGHT[order]
    assert line.interpolation_degree_along_contact_line == order
    assert pytest.approx(M, abs=1e-15) == found.M
    assert found.areas_of_contact_nodes == pytest.approx(M.sum(axis=1), abs=1e-15)
    for matrix, (a, b) in ((found.N, (0.6, 0.8)), (found.T, (-0.8, 0.6))):
        assert matrix[:, 0::2] == pytest.approx(a * M, abs=1e-15) and matrix[
            :, 1::2
        ] == pytest.approx(b * M, abs=1e-15)
    lever = 0.5 * sum(
        end / 2 * math.hypot(3, end) + 9 / 2 * math.asinh(end / 3) for end in (1.0, 2.0)
    )
    # The lever is 0.5 Int sqrt(9 + y^2) dy.
    assert found.lever.sum() == pytest.approx(lever, rel=1e-7)


@pytest.mark.parametrize("kind", ["quad2", "quad1"])
@pytest.mark.parametrize("turned", [0.0, 3.0, -3.1])
def test_the_nodes_of_a_contact_line_follow_one_another_wherever_it_lies(kind, turned):
    """Edges in any order and sense; angles within half a turn of the middle, also past 180 deg."""
    angles = turned + np.linspace(-0.5, 0.5, 6)
    mesh = pair.plane_mesh_of_ring_sector(angles, np.array([0.0, 0.1, 0.2]), 1.0, 1)
    if kind == "quad1":
        mesh = skfem.MeshQuad(mesh.p, mesh.t, _boundaries=mesh.boundaries)
    basis = nodal_basis_of_mesh(mesh)
    facets = np.random.default_rng(0).permutation(mesh.boundaries["contact"])
    line = make_contact_line_of_lining(basis, facets, turned + 0.1)
    order = 2 if kind == "quad2" else 1
    assert line.interpolation_degree_along_contact_line == order
    assert line.phi == pytest.approx(np.linspace(angles[0], angles[-1], 5 * order + 1), abs=1e-12)
    assert line.xy == pytest.approx(basis.doflocs[:, line.nodes])
    assert line.pieces == pytest.approx(np.arange(order + 1)[:, None] + order * np.arange(5))


@pytest.mark.parametrize("sign", (1, -1))
def test_normals_point_from_the_lining_to_the_drum_and_tangents_along_growing_angles(sign):
    n, e = function_that_returns_drum_normals_and_tangents(sign)(
        np.array([[3.0, 0.0], [4.0, -2.0]])
    )
    assert n == pytest.approx(sign * np.array([[0.6, 0], [0.8, -1]]))
    assert e == pytest.approx(np.array([[-0.8, 1], [0.6, 0]]))
