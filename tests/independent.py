"""A second way to the same answer: triangles, skfem's own forms, pointwise contact, one sparse system.

Shares no code with drumlin's finite elements beyond skfem: cubic-free P2 triangles with curved edges, the
hinge by rows of the unknown turn, contact as a stiff layer at the quadrature points of the lining, whose
contact set is iterated pointwise.
"""

from dataclasses import dataclass, fields

import numpy as np
import scipy.sparse as sp
import skfem
from scipy.sparse.linalg import splu, spsolve
from skfem.helpers import dot
from skfem.models.elasticity import linear_elasticity, plane_stress

from drumlin.brake.drum_brake import Brake


@dataclass
class Shoe:
    """Stiffness K and force f of one shoe with an arc body, ties of its unknowns (the turn about the pin last), and
    its lining: facets' basis, points x, outward normals n and tangents e (2, ...) there, stiffness eps of the layer.
    """

    K: sp.spmatrix
    f: np.ndarray
    ties: sp.spmatrix
    surface: skfem.FacetBasis
    x: np.ndarray
    n: np.ndarray
    e: np.ndarray
    eps: float


def assembled(brake: Brake, index: int, elements: int, penalty: float) -> Shoe:
    """One shoe with an arc body, ready for contact."""
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
    eps = penalty * lining.material.E / t * lining.width
    return Shoe(K, f, ties, surface, x, n, e, eps)


def solve(brake: Brake, index: int, elements: int, penalty: float) -> tuple[float, np.ndarray, np.ndarray]:
    """Torque [N m], and angles [rad] with pressures [Pa] at the quadrature points, of the sliding drum's shoe."""
    shoe = assembled(brake, index, elements, penalty)
    K, f, ties, surface, x, n, e, eps = (getattr(shoe, field.name) for field in fields(shoe))
    width, drag = brake.shoes[index].lining.width, brake.friction * brake.spin
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
    p = eps / width * np.maximum(closing, 0)
    torque = abs(drag) * width * float((p * np.hypot(*x) * surface.dx).sum())
    order = np.argsort(np.arctan2(*(x[::-1])).ravel())
    return torque, np.arctan2(*(x[::-1])).ravel()[order], p.ravel()[order]


def hold(brake: Brake, index: int, rotations: np.ndarray, elements: int, penalty: float) -> np.ndarray:
    """Torque [N m] of one shoe as the drum is turned through `rotations` [rad] from rest, the force on before.

    Layers normal and tangential at the quadrature points, the tractions bounded by mu times the pressure of the
    iteration before, until it no longer changes: each time the displacements of the lining and the turn minimise a
    convex energy (Panagiotopoulos 1975). No states are chosen and there are no multipliers.
    """
    shoe, mu = assembled(brake, index, elements, penalty), brake.friction
    K, f = (shoe.ties.T @ shoe.K @ shoe.ties).tocsc(), shoe.ties.T @ shoe.f
    lining = np.zeros(len(shoe.f))
    lining[shoe.surface.get_dofs(facets=shoe.surface.find).flatten()] = 1.0
    kept = np.flatnonzero(shoe.ties.T @ lining != 0)
    kept = np.union1d(kept, [len(f) - 1])
    inner = np.setdiff1d(np.arange(len(f)), kept)
    into = np.column_stack([K[np.ix_(inner, kept)].toarray(), f[inner]])
    through = splu(K[np.ix_(inner, inner)].tocsc()).solve(into)
    K_c = K[np.ix_(kept, kept)].toarray() - into[:, :-1].T @ through[:, :-1]
    f_c = f[kept] - into[:, :-1].T @ through[:, -1]
    moved = [np.asarray(shoe.surface.interpolate(column)) for column in shoe.ties[:, kept].T.toarray()]
    N, T = (np.array([(u * to).sum(axis=0).ravel() for u in moved]).T for to in (shoe.n, shoe.e))
    weight, radius = shoe.surface.dx.ravel() * shoe.eps, np.hypot(*shoe.x).ravel()

    x = np.linalg.solve(K_c + (N.T * weight) @ N, f_c)  # a first guess: pressed without friction
    elastic, at, p, torques = np.zeros(len(radius)), 0.0, np.zeros(len(radius)), []
    for rotation in rotations:
        turned = elastic + radius * brake.spin * (rotation - at) + (T @ x if torques else 0.0)

        def energy(x, bound, turned=turned):
            """Energy, its slope, its second slope, and p and t per eps; convex, for the bound (q,) of t is given."""
            p, trial = np.maximum(N @ x, 0.0), turned - T @ x
            t = np.clip(trial, -bound, bound)
            value = 0.5 * x @ K_c @ x - f_c @ x + weight @ (0.5 * p**2 + t * (trial - 0.5 * t))
            slope = K_c @ x - f_c + N.T @ (weight * p) - T.T @ (weight * t)
            second = K_c + (N.T * (weight * (p > 0))) @ N + (T.T * (weight * (np.abs(trial) < bound))) @ T
            return value, slope, second, p, t

        for _ in range(400):
            bound = mu * p
            for _ in range(100):
                value, slope, second, p, t = energy(x, bound)
                step = np.linalg.solve(second, slope)
                if np.abs(step).max() < 1e-10 * np.abs(x).max():
                    break
                share = 1.0
                while energy(x - share * step, bound)[0] > value - 1e-4 * share * (slope @ step) and share > 1e-6:
                    share *= 0.5
                x = x - share * step
            else:
                raise AssertionError("no minimum of the energy found")
            if np.abs(mu * p - bound).max() < 1e-6 * bound.max():
                break
        else:
            raise AssertionError("the bound of the traction did not settle")
        elastic, at = t, rotation
        torques.append(brake.spin * float((weight * t) @ radius))
    return np.array(torques)


def mesh_facets(where: np.ndarray) -> np.ndarray:
    """Numbers of the chosen facets; MeshTri2 numbers them as the straight mesh does."""
    return np.flatnonzero(where)
