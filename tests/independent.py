"""A second way to the same answer: triangles, skfem's own forms, pointwise contact, one sparse system.

Shares no code with drumlin's finite elements beyond skfem: cubic-free P2 triangles with curved edges, the
hinge by rows of the unknown turn, contact as a stiff layer at the quadrature points of the lining, whose
contact set is iterated pointwise.
"""

import numpy as np
import scipy.sparse as sp
import skfem
from scipy.sparse.linalg import spsolve
from skfem.helpers import dot
from skfem.models.elasticity import linear_elasticity, plane_stress

from drumlin.brake.drum_brake import Brake


def solve(brake: Brake, index: int, elements: int, penalty: float) -> tuple[float, np.ndarray, np.ndarray]:
    """Torque [N m], and angles [rad] with pressures [Pa] at the quadrature points, of one shoe with an arc body."""
    shoe = brake.shoes[index]
    R, side = brake.drum.radius, shoe.sign
    lining, body = shoe.lining, shoe.body
    assert body is not None
    step = (lining.end - lining.start) / elements
    angles = np.concatenate(
        [
            np.arange(lining.start, body.start - 1e-9, -step)[:0:-1] if lining.start > body.start + 1e-9 else [],
            np.linspace(lining.start, lining.end, elements + 1),
            np.arange(lining.end, body.end + 1e-9, step)[1:],
        ]
    )
    angles[0], angles[-1] = body.start, body.end
    t, h = lining.thickness, body.thickness
    depths = np.concatenate([np.linspace(0, t, 5), np.linspace(t, t + h, 9)[1:]])
    grid = skfem.MeshTri.init_tensor(depths, angles)
    depth, theta = grid.p[:, grid.t].mean(axis=1)
    grid = grid.restrict(np.flatnonzero((depth > t) | ((theta > lining.start) & (theta < lining.end))))
    in_lining = grid.p[0, grid.t].mean(axis=0) < t
    mesh = skfem.MeshTri2.from_mesh(grid)
    depth, theta = mesh.doflocs.copy()
    r = R - side * depth
    mesh = skfem.MeshTri2(np.array([r * np.cos(theta), r * np.sin(theta)]), mesh.t)
    element = skfem.ElementVector(skfem.ElementTriP2())
    K = 0
    for where, material, width in ((in_lining, lining.material, lining.width), (~in_lining, body.material, body.width)):
        basis = skfem.Basis(mesh, element, elements=np.flatnonzero(where), intorder=4)
        K = K + width * linear_elasticity(*plane_stress(material.E, material.nu)).assemble(basis)
    middle = grid.p[:, grid.facets].mean(axis=1)
    boundary = np.isin(np.arange(grid.nfacets), grid.boundary_facets())
    near, far = sorted((body.start, body.end), key=lambda a: abs(np.sin((a - shoe.hinge.angle) / 2)))
    hinge = mesh_facets(boundary & (middle[0] > t) & (np.abs(middle[1] - near) < 1e-9))
    loaded = mesh_facets(boundary & (middle[0] > t) & (np.abs(middle[1] - far) < 1e-9))
    contact = mesh_facets(boundary & (middle[0] < 1e-12))

    basis = skfem.Basis(mesh, element, intorder=4)
    edge = skfem.FacetBasis(mesh, element, facets=loaded, intorder=6)
    x, w = np.asarray(edge.global_coordinates()), edge.dx
    centre = (x * w).sum(axis=(1, 2)) / w.sum()
    arm = x - centre[:, None, None]
    F, P = shoe.actuation.vector, shoe.actuation.point.xy
    couple = (P - centre)[0] * F[1] - (P - centre)[1] * F[0]
    traction = F[:, None, None] / w.sum() + couple / (arm**2 * w).sum() * np.array([-arm[1], arm[0]])
    f = skfem.LinearForm(lambda v, q: dot(q["t"], v)).assemble(edge, t=traction)

    # hinge: u = turn k x (x - H)
    dofs = basis.get_dofs(hinge)
    nodes = basis.doflocs[:, dofs.flatten()]
    component_x = np.isin(dofs.flatten(), dofs.all(["u^1"]))
    rigid = np.where(component_x, -(nodes[1] - shoe.hinge.y), nodes[0] - shoe.hinge.x)
    free = np.setdiff1d(np.arange(basis.N), dofs.flatten())
    ties = sp.lil_matrix((basis.N, len(free) + 1))
    ties[free, np.arange(len(free))] = 1.0
    ties[dofs.flatten(), len(free)] = rigid
    ties = ties.tocsc()

    surface = skfem.FacetBasis(mesh, element, facets=contact, intorder=6)
    x = np.asarray(surface.global_coordinates())
    radius = np.hypot(*x)
    n = side * x / radius
    e = np.array([-x[1], x[0]]) / radius
    drag = brake.friction * brake.spin
    eps = penalty * lining.material.E / t * lining.width
    form = skfem.BilinearForm(lambda u, v, q: q["on"] * eps * dot(u, q["n"]) * (dot(v, q["n"]) - drag * dot(v, q["e"])))
    on = np.ones(x.shape[1:])
    for _ in range(60):
        A = K + form.assemble(surface, on=on, n=n, e=e)
        u = ties @ spsolve((ties.T @ A @ ties).tocsc(), ties.T @ f)
        closing = np.einsum("iab,iab->ab", np.asarray(surface.interpolate(u)), n)
        if np.array_equal(closing > 0, on > 0):
            break
        on = (closing > 0).astype(float)
    else:
        raise AssertionError("the pointwise contact set did not settle")
    p = eps / lining.width * np.maximum(closing, 0)
    torque = abs(drag) * lining.width * float((p * radius * surface.dx).sum())
    order = np.argsort(np.arctan2(*(x[::-1])).ravel())
    return torque, np.arctan2(*(x[::-1])).ravel()[order], p.ravel()[order]


def mesh_facets(where: np.ndarray) -> np.ndarray:
    """Numbers of the chosen facets; MeshTri2 numbers them as the straight mesh does."""
    return np.flatnonzero(where)
