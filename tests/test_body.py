"""Stiffness, dissection and condensation against closed forms and one dense solve."""

import math

import numpy as np
import pytest
import scipy.sparse as sp
import skfem
from scipy.sparse.linalg import spsolve
from skfem.models.elasticity import linear_elasticity, plane_stress

from drumlin import NoAnswer, vary
from drumlin.brake.elasticity import ElasticLayer
from drumlin.brake.fields import Material
from drumlin.fem.mesh.arc import parametric_mesh_of_shoe
from drumlin.fem.mesh.degree import nodal_basis_of_mesh, nodal_basis_of_shoe_mesh
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.substructure.body import (
    DEGREES_OF_FREEDOM_OF_BODY_FRAME,
    condense_body_to_contact_and_hinge_face,
    meshed_body_with_eliminated_contact,
    multi_point_constraints_of_body,
    sparse_stiffness_of_body,
)
from drumlin.fem.substructure.elasticity import elastic_layers_of_shoe
from drumlin.fem.substructure.elimination import (
    FactorsOfElimination,
    eliminate_inner_unknowns,
    elimination_order_by_nested_dissection,
)
from drumlin.fem.substructure.interface import (
    coupling_matrices_of_contact_line,
    function_that_returns_drum_normals_and_tangents,
    make_contact_line_of_lining,
    nodal_forces_of_unit_end_loads_and_end_centre,
)
from drumlin_studies.two_bodies import scikit_fem_basis_of_mesh
from picking import saying

STEEL = Material(E=210e9, nu=0.3)
KINDS = {
    "quad2": lambda: skfem.MeshQuad2.from_mesh(
        skfem.MeshQuad.init_tensor(np.linspace(0, 2, 5), np.linspace(0, 1, 4))
    ),
    "quad1": lambda: skfem.MeshQuad.init_tensor(np.linspace(0, 2, 5), np.linspace(0, 1, 4)),
    "tri2": lambda: skfem.MeshTri2.from_mesh(
        skfem.MeshTri.init_tensor(np.linspace(0, 2, 5), np.linspace(0, 1, 4))
    ),
    "tri1": lambda: skfem.MeshTri.init_tensor(np.linspace(0, 2, 5), np.linspace(0, 1, 4)),
}


def whole(mesh):
    return mesh.with_subdomains({"shoe": np.arange(mesh.nelements)})


@pytest.mark.parametrize("kind", KINDS)
def test_stiffness_equals_skfems_own_form(kind):
    mesh = whole(KINDS[kind]())
    basis = nodal_basis_of_mesh(mesh)
    K = sparse_stiffness_of_body(
        basis, {"shoe": ElasticLayer.make_layer_in_plane_stress(STEEL, 0.04)}
    )
    own = scikit_fem_basis_of_mesh(mesh)
    vector = own.with_element(skfem.ElementVector(own.elem))
    theirs = 0.04 * linear_elasticity(*plane_stress(STEEL.E, STEEL.nu)).assemble(vector)
    # Node numbers of drumlin are 2 node + component.
    place = np.empty(2 * basis.N, dtype=int)
    place[2 * basis.element_dofs.ravel()] = vector.element_dofs[0::2].ravel()
    place[2 * basis.element_dofs.ravel() + 1] = vector.element_dofs[1::2].ravel()
    difference = abs(K - theirs[place][:, place]).max()
    assert difference < 1e-13 * abs(K).max()


@pytest.mark.parametrize("kind", KINDS)
def test_uniaxial_plane_stress(kind):
    """s_xx = E e_xx, e_yy = -nu e_xx, exactly, for every element: end forces E e b h only."""
    mesh = whole(KINDS[kind]())
    basis = nodal_basis_of_mesh(mesh)
    b, strain = 0.04, 1e-3
    K = sparse_stiffness_of_body(basis, {"shoe": ElasticLayer.make_layer_in_plane_stress(STEEL, b)})
    x, y = basis.doflocs
    u = np.column_stack([strain * x, -STEEL.nu * strain * y]).ravel()
    force = (K @ u).reshape(-1, 2)
    end = x > 2 - 1e-12
    expected = STEEL.E * strain * b * 1.0
    assert force[end, 0].sum() == pytest.approx(expected, rel=1e-12)
    assert np.abs(force[(x > 1e-12) & ~end]).max() < 1e-10 * expected
    assert np.abs(force[:, 1]).max() < 1e-10 * expected


def test_curved_cantilever_under_end_shear():
    """A curved cantilever under end shear has the closed-form force at its moved end.

    Quarter ring, a = 1, b = 2, E = 1e4, fixed at one end, moved by u0 = 0.01 at the other: P u0 =
    (ln 2 - 0.6)/pi.

    Timoshenko & Goodier's curved bar under end shear; the strain energy, plane stress, nu = 1/4,
    unit width. The shear traction's distribution is that of the closed form, so the end
    displacement is prescribed radially.
    """
    errors = []
    for n in (4, 8, 16):
        grid = skfem.MeshQuad.init_tensor(
            np.linspace(1, 2, n + 1), np.linspace(0, math.pi / 2, 2 * n + 1)
        )
        mesh = skfem.MeshQuad2.from_mesh(grid)
        r, phi = mesh.doflocs
        mesh = whole(skfem.MeshQuad2(np.array([r * np.cos(phi), r * np.sin(phi)]), mesh.t))
        basis = nodal_basis_of_mesh(mesh)
        K = sparse_stiffness_of_body(
            basis, {"shoe": ElasticLayer.make_layer_in_plane_stress(Material(E=1e4, nu=0.25), 1.0)}
        )
        x, y = basis.doflocs
        u = np.zeros(2 * basis.N)
        base, tip = np.flatnonzero(np.abs(x) < 1e-12), np.flatnonzero(np.abs(y) < 1e-12)
        pinned = base[np.argmin(np.abs(y[base] - 1))]
        # symmetry-like supports of the benchmark: u_x = 0 on x = 0 with one point held in y; u_x =
        # u0 on y = 0
        fixed = np.concatenate([2 * base, [2 * pinned + 1], 2 * tip])
        u[2 * tip] = 0.01
        free = np.setdiff1d(np.arange(2 * basis.N), fixed)
        u[free] = spsolve(K[free][:, free].tocsc(), -(K[free][:, fixed] @ u[fixed]))
        errors.append(abs(u @ (K @ u) * 1.0 - 0.0296496684) / 0.0296496684)
    assert errors[-1] < 1e-5
    assert math.log2(errors[-2] / errors[-1]) > 2


def test_dissection_is_an_order_of_all_nodes_in_which_regions_follow_one_another(brake):
    basis = make_prepared_model(brake, elements=40).bodies[0].basis
    order = elimination_order_by_nested_dissection(basis.doflocs, basis.element_dofs)
    assert np.array_equal(np.sort(order.nodes), np.arange(basis.N))
    assert set(np.diff(order.region)) == {0, 1}
    assert np.bincount(order.region).max() < 0.2 * basis.N


def test_elimination_equals_the_dense_schur_complement():
    """Elimination equals the dense Schur complement for any positive definite sparse matrix.

    The matrix is split into any regions, empty ones included.
    """
    rng = np.random.default_rng(4)
    for inner, kept in ((30, 7), (60, 3), (5, 12)):
        n = inner + kept
        G = sp.random_array((n, n), density=0.15, rng=rng)
        A = (G @ G.T + 0.1 * sp.eye_array(n)).tocsc()
        region = np.sort(rng.integers(0, 8, inner))
        loads = rng.normal(size=(n, 2))
        found = eliminate_inner_unknowns(A, region, loads)
        dense = A.toarray()
        ii, ik, ki, kk = (
            dense[:inner, :inner],
            dense[:inner, inner:],
            dense[inner:, :inner],
            dense[inner:, inner:],
        )
        inverse = np.linalg.inv(ii)
        scale = np.abs(kk).max()
        assert pytest.approx(kk - ki @ inverse @ ik, abs=1e-11 * scale) == found.S
        assert found.loads == pytest.approx(
            loads[inner:] - ki @ inverse @ loads[:inner], rel=1e-9, abs=1e-10
        )
        assert found.work == pytest.approx(loads[:inner].T @ inverse @ loads[:inner], rel=1e-9)
        # The factors solve with given last unknowns, and the regions may be in any order.
        shuffled = rng.permutation(region)
        factors = FactorsOfElimination.factors_of_sparse_matrix(A, shuffled)
        given = rng.normal(size=(kept, 2))
        x = factors.solve_with_given_last_unknowns(loads, given)
        np.testing.assert_array_equal(x[inner:], given)
        np.testing.assert_allclose((dense @ x)[:inner], loads[:inner], rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_straight_triangles_have_the_stiffness_of_quadrature(brake, degree, monkeypatch):
    """Among the triangles are straight ones and, at the drum, curved ones."""
    shoe = brake.shoes[0]
    mesh = parametric_mesh_of_shoe(shoe, brake.size, 8, "tri1")
    basis = nodal_basis_of_shoe_mesh(mesh, degree, shoe, brake.size)
    straight = len(basis.numbers_of_straight_triangles())
    assert 0 < straight < mesh.nelements or degree == 1
    layers = elastic_layers_of_shoe(shoe)
    found = sparse_stiffness_of_body(basis, layers).toarray()
    monkeypatch.setattr(
        type(basis), "numbers_of_straight_triangles", lambda _: np.zeros(0, dtype=np.int64)
    )
    known = sparse_stiffness_of_body(basis, layers).toarray()
    assert np.abs(found - known).max() < 1e-12 * np.abs(known).max()


def test_a_singular_inside_is_refused():
    A = sp.csc_array(np.array([[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
    with pytest.raises(NoAnswer, match="singular"):
        eliminate_inner_unknowns(A, np.array([0, 0]), np.zeros((3, 0)))


@pytest.mark.parametrize("elements", [1, 2, 3, 7])
def test_dissection_of_tiny_meshes(brake, elements):
    mesh = parametric_mesh_of_shoe(brake.shoes[0], brake.drum.radius, elements)
    basis = nodal_basis_of_mesh(mesh)
    assert np.array_equal(
        np.sort(elimination_order_by_nested_dissection(basis.doflocs, basis.element_dofs).nodes),
        np.arange(basis.N),
    )


def full_system(brake, elements=12):
    """Stiffness of a shoe and the pieces of its condensation."""
    shoe = brake.shoes[0]
    mesh = parametric_mesh_of_shoe(shoe, brake.drum.radius, elements)
    basis = nodal_basis_of_mesh(mesh)
    K = sparse_stiffness_of_body(basis, elastic_layers_of_shoe(shoe))
    line = make_contact_line_of_lining(basis, mesh.boundaries["contact"], sum(shoe.arc) / 2)
    rigid = basis.get_dofs(mesh.boundaries["hinge"]).flatten()
    ties = multi_point_constraints_of_body(
        basis, line.nodes, rigid, np.array([shoe.hinge.radius, 0.0])
    )
    loads, _ = nodal_forces_of_unit_end_loads_and_end_centre(basis, mesh.boundaries["actuation"])
    return basis, K, line, rigid, ties, loads


def test_condensed_displacements_equal_those_of_the_whole_system(brake):
    basis, K, line, rigid, ties, loads = full_system(brake)
    n = 2 * len(line.nodes)
    condensed = condense_body_to_contact_and_hinge_face(
        K, ties, {"actuation": ties.matrix.T @ loads}, n
    )
    rng = np.random.default_rng(0)
    nodal = rng.normal(size=n) * 1e3
    forces = np.zeros(2 * basis.N)
    forces[2 * line.nodes], forces[2 * line.nodes + 1] = nodal[0::2], nodal[1::2]
    factors = np.array([3e3, -2e3, 5.0])
    forces += loads @ factors
    held = np.concatenate([2 * rigid, 2 * rigid + 1])
    free = np.setdiff1d(np.arange(2 * basis.N), held)
    u = np.zeros(2 * basis.N)
    u[free] = spsolve(K[free][:, free].tocsc(), forces[free])
    scale = np.abs(u).max()

    Y = condensed.half_flexibility_under_nodal_forces(
        np.column_stack([nodal + condensed.load_on_contact @ factors])
    )
    work = float((Y[:, 0] ** 2).sum())
    c = np.column_stack([u[2 * line.nodes], u[2 * line.nodes + 1]]).ravel()
    assert work == pytest.approx(c @ (nodal + condensed.load_on_contact @ factors), rel=1e-9)
    reaction = (condensed.L_fc @ Y)[:, 0] - condensed.load_on_frame @ factors
    applied = forces.reshape(-1, 2).sum(axis=0)
    assert reaction[:2] == pytest.approx(-applied, rel=1e-9, abs=1e-9 * np.abs(applied).max())
    everywhere = condensed.nodal_displacements_in_one_case(
        nodal, np.zeros(DEGREES_OF_FREEDOM_OF_BODY_FRAME), factors
    )
    assert everywhere.T.ravel() == pytest.approx(u, abs=1e-9 * scale)


def test_end_loads_have_their_resultants(brake):
    basis, _, _, _, _, loads = full_system(brake)
    mesh = basis.mesh
    loads, centre = nodal_forces_of_unit_end_loads_and_end_centre(
        basis, mesh.boundaries["actuation"]
    )
    x, y = basis.doflocs - centre[:, None]
    nodal = loads.reshape(-1, 2, 3)
    assert nodal.sum(axis=0) == pytest.approx(np.array([[1, 0, 0], [0, 1, 0]]), abs=1e-11)
    moments = (x[:, None] * nodal[:, 1] - y[:, None] * nodal[:, 0]).sum(axis=0)
    assert moments == pytest.approx([0, 0, 1], abs=1e-11)


def test_a_rigid_shoe_has_only_its_lining_meshed(brake):
    bare = vary(brake, {"shoe.body": None})
    scene = make_prepared_model(bare, elements=20)
    assert list(scene.bodies[0].mesh.subdomains) == ["lining"]
    assert saying(scene.left_out, "rigid, no [shoe.body]")


@pytest.mark.parametrize("friction", [True, False])
def test_elimination_of_contact_nodes_gives_the_flexibility_of_the_condensed_body(brake, friction):
    """Both ways, with kept factors and without, agree at each node, and so does a single load."""
    _, K, line, _, ties, loads = full_system(brake, elements=60)
    assert ties.region.max() > 10
    named = {"actuation": ties.matrix.T @ loads}
    coupling = coupling_matrices_of_contact_line(
        line, 0.04, function_that_returns_drum_normals_and_tangents(1)
    )
    known = condense_body_to_contact_and_hinge_face(K, ties, named, 2 * len(line.nodes))
    for keep_factors in (False, True):
        body = meshed_body_with_eliminated_contact(K, ties, named, keep_factors=keep_factors)
        found = body.flexibility_under_contact_loads(coupling, friction=friction)
        other = known.flexibility_under_contact_loads(coupling, friction=friction)
        for name, right in other._asdict().items():
            mine = getattr(found, name)
            if right is None:
                assert mine is None
                continue
            scale = np.abs(right).max()
            np.testing.assert_allclose(mine, right, rtol=0, atol=1e-9 * scale, err_msg=name)
        for mine, right in zip(
            body.contact_displacements_and_load_travel(slice(1, 3)),
            known.contact_displacements_and_load_travel(slice(1, 3)),
            strict=True,
        ):
            np.testing.assert_allclose(mine, right, rtol=0, atol=1e-9 * np.abs(right).max())
        # The dense stiffness on the contact nodes was not computed.
        assert "condensed" not in vars(body)
