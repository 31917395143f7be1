"""A second solver for the same brake, which shares no code with drumlin's finite elements.

The solver shares only the package skfem with drumlin's finite elements. It has quadratic triangles
with curved edges and solves one sparse system.

The rotation of the shoe about its hinge is a further unknown of the system. The contact is a stiff
elastic layer at the quadrature points of the lining. The set of points in contact is found by
iteration. Wear increases the clearance at these points by implicit Euler steps.
"""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp
import skfem
from scipy.sparse.linalg import splu, spsolve
from skfem.helpers import dot
from skfem.models.elasticity import linear_elasticity, plane_stress

from drumlin.brake.brake import Brake
from drumlin.brake.file import read_brake

STUDIES = Path(__file__).resolve().parents[1] / "studies"
# Torque of the main and of the flexible brake by the sine law [N m]: 2 kN times the published lever
# .2176081 m.
SINE_LAW = 435.2162


class Shoe(NamedTuple):
    """The matrices and quadrature points of one shoe without contact, from which `pressed` starts.

    At the quadrature points (m, q): angle `theta`, `radius` and integration `weight`.
    """

    K: Any
    ties: Any
    load: np.ndarray
    surface: Any
    normal: np.ndarray
    tangent: np.ndarray
    theta: np.ndarray
    radius: np.ndarray
    weight: np.ndarray
    spring: float
    drag: float


def shoe(brake: Brake, index: int, elements: int) -> Shoe:
    """A shoe with an arc body. `spring` is the stiffness E b/t of the lining per area [N/m^3]."""
    spec = brake.shoes[index]
    R, side = brake.size, spec.sign_internal_plus_external_minus
    lining, body = spec.lining, spec.body
    assert body is not None
    step = (lining.end - lining.start) / elements
    angles = np.concatenate(
        [
            np.arange(lining.start, body.start - 1e-9, -step)[:0:-1]
            if lining.start > body.start + 1e-9
            else [],
            np.linspace(lining.start, lining.end, elements + 1),
            np.arange(lining.end, body.end + 1e-9, step)[1:],
        ]
    )
    angles[0], angles[-1] = body.start, body.end
    t, h = lining.thickness, body.thickness
    depths = np.concatenate([np.linspace(0, t, 5), np.linspace(t, t + h, 9)[1:]])
    grid = skfem.MeshTri.init_tensor(depths, angles)
    depth, theta = grid.p[:, grid.t].mean(axis=1)
    grid = grid.restrict(
        np.flatnonzero((depth > t) | ((theta > lining.start) & (theta < lining.end)))
    )
    in_lining = grid.p[0, grid.t].mean(axis=0) < t
    mesh = skfem.MeshTri2.from_mesh(grid)
    depth, theta = mesh.doflocs.copy()
    r = R - side * depth
    mesh = skfem.MeshTri2(np.array([r * np.cos(theta), r * np.sin(theta)]), mesh.t)
    element = skfem.ElementVector(skfem.ElementTriP2())
    K = 0
    for where, material, width in (
        (in_lining, lining.material, lining.width),
        (~in_lining, body.material, body.width),
    ):
        basis = skfem.Basis(mesh, element, elements=np.flatnonzero(where), intorder=4)
        K = K + width * linear_elasticity(*plane_stress(material.E, material.nu)).assemble(basis)
    middle = grid.p[:, grid.facets].mean(axis=1)
    boundary = np.isin(np.arange(grid.nfacets), grid.boundary_facets())
    near, far = sorted(
        (body.start, body.end), key=lambda a: abs(np.sin((a - spec.hinge.angle) / 2))
    )
    hinge = mesh_facets(boundary & (middle[0] > t) & (np.abs(middle[1] - near) < 1e-9))
    loaded = mesh_facets(boundary & (middle[0] > t) & (np.abs(middle[1] - far) < 1e-9))
    contact = mesh_facets(boundary & (middle[0] < 1e-12))

    basis = skfem.Basis(mesh, element, intorder=4)
    edge = skfem.FacetBasis(mesh, element, facets=loaded, intorder=6)
    x, w = np.asarray(edge.global_coordinates()), edge.dx
    centre = (x * w).sum(axis=(1, 2)) / w.sum()
    arm = x - centre[:, None, None]
    F, P = spec.actuation.force_vector, spec.actuation.point.xy
    couple = (P - centre)[0] * F[1] - (P - centre)[1] * F[0]
    traction = F[:, None, None] / w.sum() + couple / (arm**2 * w).sum() * np.array(
        [-arm[1], arm[0]]
    )
    f = skfem.LinearForm(lambda v, q: dot(q["t"], v)).assemble(edge, t=traction)

    # hinge: u = turn k x (x - H)
    dofs = basis.get_dofs(hinge)
    nodes = basis.doflocs[:, dofs.flatten()]
    component_x = np.isin(dofs.flatten(), dofs.all(["u^1"]))
    rigid = np.where(component_x, -(nodes[1] - spec.hinge.y), nodes[0] - spec.hinge.x)
    free = np.setdiff1d(np.arange(basis.N), dofs.flatten())
    ties = sp.lil_matrix((basis.N, len(free) + 1))
    ties[free, np.arange(len(free))] = 1.0
    ties[dofs.flatten(), len(free)] = rigid
    ties = ties.tocsc()

    surface = skfem.FacetBasis(mesh, element, facets=contact, intorder=6)
    x = np.asarray(surface.global_coordinates())
    radius = np.hypot(*x)
    middle_angle = (lining.start + lining.end) / 2
    theta = middle_angle + np.angle(np.exp(-1j * middle_angle) * (x[0] + 1j * x[1]))
    return Shoe(
        K,
        ties,
        f,
        surface,
        side * x / radius,
        np.array([-x[1], x[0]]) / radius,
        theta,
        radius,
        np.asarray(surface.dx),
        lining.material.E / t * lining.width,
        brake.friction * brake.sign_of_motion,
    )


def contact_forms(one: Shoe, stiffness: float, on: np.ndarray, gap: np.ndarray) -> tuple[Any, Any]:
    """Matrix and load of the traction stiffness (closing - gap) at the quadrature points `on`."""

    def work(v: Any, q: Any) -> Any:
        return q["on"] * stiffness * (dot(v, q["n"]) - one.drag * dot(v, q["e"]))

    data = {"on": on, "n": one.normal, "e": one.tangent, "gap": gap}
    matrix = skfem.BilinearForm(lambda u, v, q: dot(u, q["n"]) * work(v, q)).assemble(
        one.surface, **data
    )
    return matrix, skfem.LinearForm(lambda v, q: q["gap"] * work(v, q)).assemble(
        one.surface, **data
    )


def closing(one: Shoe, u: np.ndarray) -> np.ndarray:
    return np.einsum("iab,iab->ab", np.asarray(one.surface.interpolate(one.ties @ u)), one.normal)


def pressed(one: Shoe, stiffness: float, gap: np.ndarray) -> np.ndarray:
    """Pressure times width (m, q) [N/m] in a stiff contact layer, for the clearances (m, q)."""
    on = np.ones_like(gap)
    for _ in range(60):
        matrix, load = contact_forms(one, stiffness, on, gap)
        A = (one.ties.T @ (one.K + matrix) @ one.ties).tocsc()
        force = stiffness * (closing(one, spsolve(A, one.ties.T @ (one.load + load))) - gap)
        if np.array_equal(force > 0, on > 0):
            return np.maximum(force, 0)
        on = (force > 0).astype(float)
    raise AssertionError("the pointwise contact set did not settle")


def torque_of(one: Shoe, force: np.ndarray) -> float:
    return abs(one.drag) * float((force * one.radius * one.weight).sum())


def solve(
    brake: Brake,
    index: int,
    elements: int,
    penalty: float,
    clearance: Callable[[np.ndarray], np.ndarray] | None = None,
) -> tuple[float, np.ndarray, np.ndarray]:
    """Torque [N m] of one arc shoe, and angles [rad] and pressures [Pa] at quadrature points."""
    one = shoe(brake, index, elements)
    gap = np.zeros_like(one.theta) if clearance is None else clearance(one.theta)
    force = pressed(one, penalty * one.spring, gap)
    order = np.argsort(one.theta.ravel())
    return (
        torque_of(one, force),
        one.theta.ravel()[order],
        force.ravel()[order] / brake.shoes[index].lining.width,
    )


@cache
def torque(name: str) -> float:
    """Torque [N m] of a brake file of the studies by 90 elements per shoe.

    45 and 90 elements differ by 2e-5 for stiff shoes and by 7e-5 for flexible ones.

    A penalty of 1e3 instead of 1e4 changes it by 4e-5.
    """
    brake = read_brake(STUDIES / f"{name}.toml")
    return sum(solve(brake, i, 90, 1e4)[0] for i in range(len(brake.shoes)))


def worn(
    brake: Brake, index: int, elements: int, coefficient: float, distance: float, steps: int
) -> tuple[Any, ...]:
    """Wear by Archard's law of a lining in full contact: angles, pressures, and depths of wear.

    Pressures and depths have the shape (steps + 1, angles).

    An implicit step ds acts as a softer layer, p = e (closing - gap - k ds p). All steps therefore
    have the same matrix, which is factorised once.
    """
    one, ds, width = shoe(brake, index, elements), distance / steps, brake.shoes[index].lining.width
    gap, e = np.zeros_like(one.theta), 1e4 * one.spring
    p, depth = [pressed(one, e, gap) / width], [gap]
    soft = e / (1 + e / width * coefficient * ds)
    matrix, _ = contact_forms(one, soft, np.ones_like(gap), gap)
    solver = splu((one.ties.T @ (one.K + matrix) @ one.ties).tocsc())
    for _ in range(steps):
        _, load = contact_forms(one, soft, np.ones_like(gap), depth[-1])
        p.append(
            soft / width * (closing(one, solver.solve(one.ties.T @ (one.load + load))) - depth[-1])
        )
        assert p[-1].min() > 0
        depth.append(depth[-1] + coefficient * ds * p[-1])
    order = np.argsort(one.theta.ravel())
    return one.theta.ravel()[order], *(
        np.array([x.ravel()[order] for x in kept]) for kept in (p, depth)
    )


def hold(
    brake: Brake, index: int, rotations: np.ndarray, elements: int, penalty: float
) -> np.ndarray:
    """Torque [N m] of one loaded shoe as the drum turns through `rotations` [rad] from rest.

    Layers normal and tangential at the quadrature points, the tractions bounded by mu times the
    pressure of the iteration before, until it no longer changes: each time the displacements of the
    lining and the turn minimise a convex energy (Panagiotopoulos 1975). No states are chosen and
    there are no multipliers.
    """
    one, mu = shoe(brake, index, elements), brake.friction
    K, f = (one.ties.T @ one.K @ one.ties).tocsc(), one.ties.T @ one.load
    lining = np.zeros(len(one.load))
    lining[one.surface.get_dofs(facets=one.surface.find).flatten()] = 1.0
    # The last column is the rigid turn about the pin.
    kept = np.union1d(np.flatnonzero(one.ties.T @ lining != 0), [len(f) - 1])
    inner = np.setdiff1d(np.arange(len(f)), kept)
    into = np.column_stack([K[np.ix_(inner, kept)].toarray(), f[inner]])
    through = splu(K[np.ix_(inner, inner)].tocsc()).solve(into)
    K_c = K[np.ix_(kept, kept)].toarray() - into[:, :-1].T @ through[:, :-1]
    f_c = f[kept] - into[:, :-1].T @ through[:, -1]
    moved = [
        np.asarray(one.surface.interpolate(column)) for column in one.ties[:, kept].T.toarray()
    ]
    N, T = (
        np.array([(u * to).sum(axis=0).ravel() for u in moved]).T
        for to in (one.normal, one.tangent)
    )
    weight, radius = one.weight.ravel() * penalty * one.spring, one.radius.ravel()

    # The first guess is the pressed lining without friction.
    x = np.linalg.solve(K_c + (N.T * weight) @ N, f_c)
    elastic, at, p, torques = np.zeros(len(radius)), 0.0, np.zeros(len(radius)), []
    for rotation in rotations:
        turned = (
            elastic + radius * brake.sign_of_motion * (rotation - at) + (T @ x if torques else 0.0)
        )

        def energy(x, bound, turned=turned):
            """Energy, its slope and second slope, and p and t per eps, for a bound (q,) of t.

            With the bound given the energy is convex.
            """
            p, trial = np.maximum(N @ x, 0.0), turned - T @ x
            t = np.clip(trial, -bound, bound)
            value = 0.5 * x @ K_c @ x - f_c @ x + weight @ (0.5 * p**2 + t * (trial - 0.5 * t))
            slope = K_c @ x - f_c + N.T @ (weight * p) - T.T @ (weight * t)
            second = (
                K_c
                + (N.T * (weight * (p > 0))) @ N
                + (T.T * (weight * (np.abs(trial) < bound))) @ T
            )
            return value, slope, second, p, t

        for _ in range(400):
            bound = mu * p
            for _ in range(100):
                value, slope, second, p, t = energy(x, bound)
                step = np.linalg.solve(second, slope)
                if np.abs(step).max() < 1e-10 * np.abs(x).max():
                    break
                share = 1.0
                while (
                    energy(x - share * step, bound)[0] > value - 1e-4 * share * (slope @ step)
                    and share > 1e-6
                ):
                    share *= 0.5
                x = x - share * step
            else:
                raise AssertionError("no minimum of the energy found")
            if np.abs(mu * p - bound).max() < 1e-6 * bound.max():
                break
        else:
            raise AssertionError("the bound of the traction did not settle")
        elastic, at = t, rotation
        torques.append(brake.sign_of_motion * float((weight * t) @ radius))
    return np.array(torques)


def mesh_facets(where: np.ndarray) -> np.ndarray:
    """Numbers of the chosen facets; MeshTri2 numbers them as the straight mesh does."""
    return np.flatnonzero(where)
