"""Elasticity alone: a manufactured solution with its rates, and a sharp sliding edge."""

import math

import numpy as np
import pytest
import skfem
from scipy.sparse.linalg import spsolve

from drumlin.brake.elasticity import ElasticLayer
from drumlin.brake.fields import Material
from drumlin.contact import active_set
from drumlin.contact.equations import ContactProblem
from drumlin.fem.mesh.degree import nodal_basis_of_mesh
from drumlin.fem.substructure.body import (
    sparse_stiffness_of_body,
)
from drumlin_studies.two_bodies import (
    InnerAndOuterBodyInContact,
    condense_body_to_contact_nodes,
    plane_mesh_of_ring_sector,
    points_with_steps_growing_to_end,
    scikit_fem_basis_of_mesh,
)

pytestmark = pytest.mark.slow

KINDS = {
    "quad2": (skfem.MeshQuad, skfem.MeshQuad2, 3),
    "tri2": (skfem.MeshTri, skfem.MeshTri2, 3),
    "quad1": (skfem.MeshQuad, None, 2),
    "tri1": (skfem.MeshTri, None, 2),
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_manufactured_solution_converges_at_the_rate_of_the_element(kind):
    """A manufactured solution converges in L2 with order 3 (quadratic) or 2 (linear elements).

    u = (sin(pi x) sin(pi y), x y) with its body force.
    """
    make, raise_, order = KINDS[kind]
    E, nu = 1000.0, 0.3
    lam, mu = E * nu / (1 - nu**2), E / (2 * (1 + nu))
    pi = math.pi

    def exact(x, y):
        return np.array([np.sin(pi * x) * np.sin(pi * y), x * y])

    def force(x, y):
        # -div s for s = lam tr(e) I + 2 mu e
        ss, cc = np.sin(pi * x) * np.sin(pi * y), np.cos(pi * x) * np.cos(pi * y)
        return np.array(
            [(lam + 2 * mu) * pi**2 * ss - (lam + mu) + mu * pi**2 * ss, -(lam + mu) * pi**2 * cc]
        )

    errors, sizes = [], (8, 16, 32)
    for n in sizes:
        x = np.linspace(0, 1, n + 1)
        mesh = make.init_tensor(x, x**1.2)
        if raise_ is not None:
            mesh = raise_.from_mesh(mesh)
        mesh = mesh.with_subdomains({"shoe": np.arange(mesh.nelements)})
        basis = scikit_fem_basis_of_mesh(mesh)
        K = sparse_stiffness_of_body(
            nodal_basis_of_mesh(mesh),
            {"shoe": ElasticLayer.make_layer_in_plane_stress(Material(E=E, nu=nu), 1.0)},
        )
        points = np.asarray(basis.global_coordinates())
        f = np.zeros((basis.N, 2))
        for psi, dofs in zip(basis.basis, basis.element_dofs, strict=True):
            for c, part in enumerate(force(*points)):
                np.add.at(f[:, c], dofs, (psi[0] * part * basis.dx).sum(axis=1))
        # The boundary values are given, and the inside is solved for.
        u = exact(*basis.doflocs).T.ravel()
        edge = basis.get_dofs().flatten()
        free = np.setdiff1d(np.arange(2 * basis.N), np.concatenate([2 * edge, 2 * edge + 1]))
        held = np.setdiff1d(np.arange(2 * basis.N), free)
        u[free] = spsolve(K[free][:, free].tocsc(), f.ravel()[free] - K[free][:, held] @ u[held])
        found = np.array(
            [np.asarray(basis.interpolate(u[0::2])), np.asarray(basis.interpolate(u[1::2]))]
        )
        errors.append(
            math.sqrt(float((((found - exact(*points)) ** 2).sum(axis=0) * basis.dx).sum()))
        )
    rate = -np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    assert rate > order - 0.15
    assert errors[-1] < (2e-4 if order == 3 else 5e-3)


@pytest.fixture(scope="module")
def strip():
    """A strip with sharp edges, rigid at its back.

    Elements shrink to 1e-7 of its thickness towards its ends and its face.
    """
    thickness, half = 0.05, 0.1
    fine = points_with_steps_growing_to_end(1e-8, 1.35, half)
    angles = np.concatenate([-half + fine, (half - fine)[::-1][1:]])
    return thickness, InnerAndOuterBodyInContact.couple_two_bodies_at_contact_nodes(
        condense_body_to_contact_nodes(
            plane_mesh_of_ring_sector(
                angles, points_with_steps_growing_to_end(1e-8, 1.35, thickness), 1.0, -1
            ),
            Material(E=3e8, nu=0.3),
        ),
        None,
    )


@pytest.mark.parametrize(
    ("mu", "exponent"), [(0.0, 1.0), (0.1, 0.887), (0.3, 0.7095), (0.5, 0.564)]
)
def test_the_pressure_at_a_sharp_edge_that_the_drum_runs_onto_goes_as_r_to_lambda_minus_one(
    strip, mu, exponent
):
    """Plane stress, nu = 0.3, rigid drum (eigenvalues of the corner with sliding friction)."""
    thickness, pair = strip
    A = pair.pressed.T @ (pair.pressed + mu * pair.dragged)
    n = len(pair.contact_node_angles)
    q = pair.coupling.M @ np.full(n, -1e-4 * thickness)
    found = active_set.solve_contact_problem(
        ContactProblem(A, q, np.zeros((n, 0)), np.zeros((0, n)), np.zeros(0))
    )
    # The drum moves along +phi, onto this end.
    r = pair.contact_node_angles - pair.contact_node_angles[0]
    near = (r > 1e-5 * thickness) & (r < 3e-3 * thickness)
    assert near.sum() > 10
    slope = np.polyfit(np.log(r[near]), np.log(found.p[near]), 1)[0]
    assert slope == pytest.approx(exponent - 1, abs=0.01)
    away = pair.contact_node_angles[-1] - pair.contact_node_angles
    # Where the drum leaves the lining the stress has no singularity.
    if mu:
        last = (away > 1e-5 * thickness) & (away < 3e-3 * thickness)
        assert found.p[last].max() < 1.2 * np.median(found.p)
