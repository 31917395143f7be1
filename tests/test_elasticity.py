"""Elasticity matrices against skfem's own forms, rotated by hand, on every kind of element."""

import math

import numpy as np
import pytest
import skfem
from skfem.helpers import sym_grad
from skfem.models.elasticity import plane_stress

from drumlin.brake.elasticity import (
    ElasticLayer,
    plane_stress_elasticity_matrix,
    which_elasticity_matrices_are_orthotropic,
)
from drumlin.brake.fields import Material
from drumlin.fem.hp import element as hp
from drumlin.fem.hp.arc import (
    angular_factors_of_column_stiffness,
    condensed_arc_column_stiffness,
    condensed_arc_element_stiffness,
)
from drumlin.fem.hp.columns import (
    condensed_element_column_stiffness,
    numbering_of_element_column_unknowns,
    rotate_node_axes_of_matrix,
)
from drumlin.fem.hp.shoe import node_coordinates_of_layers_and_columns
from drumlin.fem.mesh.degree import nodal_basis_of_mesh
from drumlin.fem.substructure.body import (
    sparse_stiffness_of_body,
)
from drumlin.fem.substructure.elasticity import (
    isotropic_and_orthotropic_elastic_constants,
    stresses_from_displacement_gradients,
    unit_vectors_through_thickness_of_layers,
)
from drumlin.response.resultants import gauss_lobatto_points
from drumlin.verification.triangles import lagrange
from drumlin.verification.triangles.triangulation import (
    LayerOfTriangulatedBody,
    triangulate_grid_of_layered_body,
)
from drumlin_studies.two_bodies import scikit_fem_basis_of_mesh
from picking import picked

DIRECTED = np.array([[9.0, 0.8, 0.0], [0.8, 3.0, 0.0], [0.0, 0.0, 2.5]]) * 1e8
"""A layer three times as stiff along as through, with a shear stiffness of its own.

No isotropic material has this shear stiffness.
"""
LAYERS = {
    "around": ElasticLayer(DIRECTED, 0.03),
    "straight": ElasticLayer(DIRECTED, 0.03, np.array([0.6, -0.8])),
}
KINDS = {
    "quad2": (skfem.MeshQuad, skfem.MeshQuad2.from_mesh),
    "quad1": (skfem.MeshQuad, None),
    "tri2": (skfem.MeshTri, skfem.MeshTri2.from_mesh),
    "tri1": (skfem.MeshTri, None),
}


def directions(layer, x):
    """The unit vectors along a layer and through it at points (2, ...), by angles."""
    angle = (
        np.arctan2(x[1], x[0]) + math.pi / 2
        if layer.along is None
        else math.atan2(-0.8, 0.6) + 0 * x[0]
    )
    return np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])


def work_in(layer):
    """scikit-fem's form of stress times strain, both taken along and through a layer."""

    @skfem.BilinearForm
    def work(u, v, w):
        t, n = directions(layer, w.x)

        def strains(field):
            eps = sym_grad(field)
            along, through, half_shear = (
                sum(a[i] * eps[i, j] * b[j] for i in range(2) for j in range(2))
                for a, b in ((t, t), (n, n), (t, n))
            )
            return along, through, 2 * half_shear

        D, (e, f, gamma), (tested_e, tested_f, tested_gamma) = (
            layer.elasticity,
            strains(u),
            strains(v),
        )
        along, through, shear = (
            D[0, 0] * e + D[0, 1] * f,
            D[1, 0] * e + D[1, 1] * f,
            D[2, 2] * gamma,
        )
        return layer.width * (along * tested_e + through * tested_f + shear * tested_gamma)

    return work


def by_skfem(basis, layer):
    """The stiffness by scikit-fem's own assembly, unknown 2 i + c of node i."""
    vector = basis.with_element(skfem.ElementVector(basis.elem))
    theirs = work_in(layer).assemble(vector)
    place = np.empty(2 * basis.N, dtype=int)
    place[2 * basis.element_dofs.ravel()] = vector.element_dofs[0::2].ravel()
    place[2 * basis.element_dofs.ravel() + 1] = vector.element_dofs[1::2].ravel()
    return theirs[place][:, place]


def test_the_matrix_of_an_isotropic_material_has_the_constants_of_plane_stress():
    material = Material(E=2.1e11, nu=0.3)
    lam, mu = plane_stress(material.E, material.nu)
    expected = [[lam + 2 * mu, lam, 0], [lam, lam + 2 * mu, 0], [0, 0, mu]]
    assert plane_stress_elasticity_matrix(material) == pytest.approx(np.array(expected), rel=1e-14)


@pytest.mark.parametrize("nu", [-0.999, -0.3, 0.0, 0.25, 0.4999])
def test_isotropic_materials_have_no_directions(nu):
    matrix = plane_stress_elasticity_matrix(Material(E=3e8, nu=nu))
    assert not which_elasticity_matrices_are_orthotropic(
        matrix
    ) and not which_elasticity_matrices_are_orthotropic(0.0371 * matrix)
    assert which_elasticity_matrices_are_orthotropic(
        DIRECTED
    ) and which_elasticity_matrices_are_orthotropic(
        matrix * [[1, 1, 1], [1, 1 + 1e-9, 1], [1, 1, 1]]
    )


@pytest.mark.parametrize("name", LAYERS)
def test_stresses_are_those_of_the_matrix_in_the_layers_directions(name):
    layer, random = LAYERS[name], np.random.default_rng(3)
    points, H = random.uniform(0.1, 0.2, (2, 5)), random.standard_normal((2, 2, 5))
    t, n = directions(layer, points)
    assert layer.unit_vectors_along_layer(points) == pytest.approx(t, abs=1e-14)
    assert unit_vectors_through_thickness_of_layers(t) == pytest.approx(n, abs=1e-14)
    eps = 0.5 * (H + H.swapaxes(0, 1))

    def parts(tensor):
        return np.array(
            [np.einsum("im,ijm,jm->m", a, tensor, b) for a, b in ((t, t), (n, n), (t, n))]
        )

    strains = parts(eps) * np.array([[1], [1], [2]])
    assert parts(stresses_from_displacement_gradients(H, DIRECTED, t)) == pytest.approx(
        DIRECTED @ strains, rel=1e-12
    )


@pytest.mark.parametrize("name", LAYERS)
@pytest.mark.parametrize("kind", KINDS)
def test_on_meshes_the_stiffness_is_that_of_scikit_fems_own_assembly(kind, name):
    make, raised = KINDS[kind]
    grid = make.init_tensor(np.linspace(0.1, 0.14, 4), np.linspace(0.05, 0.12, 5))
    mesh = raised(grid) if raised else grid
    # The edges of quad2 elements are curved.
    if kind == "quad2":
        mesh = skfem.MeshQuad2(mesh.doflocs + 0.01 * np.sin(40 * mesh.doflocs[::-1]), mesh.t)
    mesh = mesh.with_subdomains({"body": np.arange(mesh.nelements)})
    basis = nodal_basis_of_mesh(mesh)
    K, theirs = (
        sparse_stiffness_of_body(basis, {"body": LAYERS[name]}),
        by_skfem(scikit_fem_basis_of_mesh(mesh), LAYERS[name]),
    )
    assert abs(K - theirs).max() < 1e-13 * abs(K).max()
    assert abs(K - K.T).max() < 1e-15 * abs(K).max()
    precise = sparse_stiffness_of_body(basis, {"body": LAYERS[name]}, precise=True)
    assert precise.dtype == np.longdouble and abs(K - precise).max() < 1e-13 * abs(K).max()


def bent_elements(p):
    """Nodes (e, 2, a) of three distorted elements of degree p, in the order of an element.

    No edge of the elements is an arc of a circle.
    """
    x = 0.5 * (gauss_lobatto_points(p) + 1)
    s, d = np.repeat(x, p + 1), np.tile(x, p + 1)
    found = []
    for k in range(3):
        phi, r = 0.3 + 0.2 * (k + d) + 0.03 * s * d, 0.14 - 0.02 * s + 0.004 * np.sin(3 * d)
        found.append(np.stack([r * np.cos(phi), r * np.sin(phi)]))
    return np.ascontiguousarray(np.array(found)[..., hp.reference_element_of_degree(p).order])


def along_at(layer, xy, p):
    return np.moveaxis(
        layer.unit_vectors_along_layer(np.moveaxis(hp.gauss_points_of_elements(xy, p), 1, 0)), 0, 1
    )


@pytest.mark.parametrize("name", LAYERS)
@pytest.mark.parametrize("p", [2, 4, 7])
def test_elements_of_high_degree_have_the_rotated_stiffness_of_every_point(p, name):
    layer, xy = LAYERS[name], bent_elements(p)
    matrices = np.tile(layer.elasticity_times_width, (len(xy), 1, 1))
    K = hp.plane_stress_stiffness_of_elements(xy, matrices, p, along_at(layer, xy, p))
    gradients, area = hp.shape_function_gradients_and_gauss_areas(xy, p)
    points = np.moveaxis(hp.gauss_points_of_elements(xy, p), 1, 0)
    theirs = lagrange._stiffness_matrices_of_orthotropic_triangles(
        gradients.transpose(0, 2, 1, 3), area, layer, points
    )
    size = np.abs(K).max()
    assert np.abs(K.reshape(theirs.shape) - theirs).max() < 1e-13 * size
    long = xy.astype(np.longdouble)
    precise = hp.plane_stress_stiffness_of_elements(
        long, matrices.astype(np.longdouble), p, along_at(layer, long, p)
    )
    assert np.abs(K - precise).max() < 1e-13 * size
    turn = np.stack([-long[:, 1], long[:, 0]], axis=2)
    assert (
        np.abs(np.einsum("eaibj,ebj->eai", precise, turn)).max()
        < 1e-17 * float(size) * (p + 1) ** 2
    )
    values = np.linalg.eigvalsh(theirs[0])
    assert values[3] > 1e-6 * values[-1] > 1e6 * abs(values[2])


def test_isotropic_elements_beside_directed_ones_stay_what_they_are_alone():
    p, xy, steel = (
        4,
        bent_elements(4),
        0.02 * plane_stress_elasticity_matrix(Material(E=2e11, nu=0.3)),
    )
    layer = LAYERS["around"]
    along = along_at(layer, xy, p)
    mixed = hp.plane_stress_stiffness_of_elements(
        xy, np.array([steel, layer.elasticity_times_width, steel]), p, along
    )
    alone = hp.plane_stress_stiffness_of_elements(xy, np.tile(steel, (3, 1, 1)), p)
    directed = hp.plane_stress_stiffness_of_elements(
        xy, np.tile(layer.elasticity_times_width, (3, 1, 1)), p, along
    )
    for k, expected in enumerate((alone, directed, alone)):
        assert np.array_equal(mixed[k], expected[k])


@pytest.mark.parametrize("flat", [False, True], ids=["arc", "pad"])
@pytest.mark.parametrize(
    ("p", "contact", "held"), [(3, True, False), (4, True, True), (5, False, False)]
)
def test_columns_in_product_form_are_those_of_their_elements(p, contact, held, flat):
    """Columns in product form are those of their elements, for isotropic and directed layers.

    One layer is isotropic, one is a third as stiff through as along, one has the shear stiffness of
    no isotropic material.
    """
    half, depths = np.array([0.003, 0.05, 0.21]), np.array([0.0, 0.0002, 0.004, 0.011])
    steel = plane_stress_elasticity_matrix(Material(E=2e11, nu=0.28))
    layers = [
        ElasticLayer(D, 0.04, np.array([0.0, 1.0]) if flat else None)
        for D in (DIRECTED, 0.1 * DIRECTED, steel)
    ]
    matrices = np.array(picked(layers, "elasticity_times_width"))
    angles, radius = half[:, None] * gauss_lobatto_points(p), 0.14

    def place(depth, phi):
        """Coordinates (x, y) of a depth and an angle, on an arc or on a flat pad.

        A pad's angles are lengths over the radius, and x is the normal as in an arc's middle.
        """
        if flat:
            return np.array(np.broadcast_arrays(-depth, radius * phi))
        return np.array([(radius - depth) * np.cos(phi), (radius - depth) * np.sin(phi)])

    xy = node_coordinates_of_layers_and_columns(place, depths, angles, p)
    along = np.array([along_at(layer, own, p) for layer, own in zip(layers, xy, strict=True)])
    of = numbering_of_element_column_unknowns(p, 3, contact=contact, held=held)
    theirs = condensed_element_column_stiffness(
        hp.condensed_element_stiffness(xy, matrices, p, along), of
    )
    A = angular_factors_of_column_stiffness(angles, p, flat=flat, directed=True)
    ours = condensed_arc_column_stiffness(
        condensed_arc_element_stiffness(radius - depths, A, matrices, p, radius if flat else None),
        p,
        contact=contact,
        held=held,
    )
    nodes = p + 1 if contact else 0
    for K, own, side in zip(theirs, ours, 0.0 * half if flat else half, strict=True):
        lines = np.full(of.number_of_side_unknowns // 2, side)
        ends = np.concatenate([[-side], np.zeros(nodes - 2), [side]]) if contact else []
        expected = rotate_node_axes_of_matrix(K, np.concatenate([lines * -1, ends, lines]))
        np.testing.assert_allclose(own, expected, rtol=0, atol=1e-11 * np.abs(expected).max())


def test_split_and_put_together_a_matrix_is_the_same():
    lam, mu, a, b = isotropic_and_orthotropic_elastic_constants(DIRECTED)
    assert np.array(
        [[lam + 2 * mu + a, lam, 0], [lam, lam + 2 * mu + b, 0], [0, 0, mu]]
    ) == pytest.approx(DIRECTED)


def test_triangles_of_the_second_solver_carry_an_even_strain():
    """A straight layer of triangles under u = H x has the nodal forces of its even stress."""
    layer = LAYERS["straight"]
    mesh = triangulate_grid_of_layered_body(
        np.linspace(0, 0.2, 4), [np.linspace(0, 1, 3)], [LayerOfTriangulatedBody(-1, 1, layer)]
    )

    def place(s, d):
        return np.stack([s, 0.02 * d + 0.1 * s], axis=-1)

    degree = 3
    nodes = lagrange.nodes_of_triangle_mesh_of_given_degree(mesh, place, degree)
    K = lagrange.triangle_stiffness_matrices(
        mesh, nodes, [LayerOfTriangulatedBody(-1, 1, layer)], degree
    )
    H = np.array([[1e-3, 4e-4], [-2e-4, 5e-4]])
    u = nodes.xy @ H.T
    energy = sum(
        0.5 * u[of].ravel() @ own @ u[of].ravel()
        for own, of in zip(K, nodes.nodes_of_triangles, strict=True)
    )
    sigma = stresses_from_displacement_gradients(H[..., None], DIRECTED, layer.along[:, None])[
        ..., 0
    ]
    area = 0.2 * 0.02
    assert energy == pytest.approx(0.5 * (sigma * H).sum() * area * layer.width, rel=1e-12)
