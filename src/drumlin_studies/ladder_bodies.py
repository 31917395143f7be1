"""The ladder's elastic bodies and numerical methods: stiffness, orders, rings, extrapolation,
equations.
"""

import math
from functools import cache, partial
from typing import Any

import numpy as np
import skfem
from scipy.sparse.linalg import splu

from drumlin.base.arrays import Floats
from drumlin.brake.elasticity import ElasticLayer
from drumlin.brake.fields import Material
from drumlin.contact import active_set
from drumlin.contact.equations import Problem
from drumlin.fem.substructure.body import scalar_basis, stiffness
from drumlin.fem.substructure.interface import contact_line, couple, radial
from drumlin.foundation.ring import two_forces
from drumlin_studies import closed_forms
from drumlin_studies.ladder_case import DISCRETE, EXACT, PRINTED, KnownAnswer
from drumlin_studies.two_bodies import LADDER_STEEL, closed
from drumlin_studies.uncertainty import Index, grid_convergence

# Values on three meshes, each twice as fine as the one before.
ROACHE = (0.96178, 0.96854, 0.97050)


def _roache() -> Index:
    """The grid convergence index of these values."""
    coarse, medium, fine = ROACHE
    return grid_convergence(fine, medium, coarse)


def _rectangle(length: float, height: float, along: int, through: int) -> tuple[Any, Any]:
    """Basis and stiffness of quadratic quadrilaterals on [0, length] x [-height/2, height/2]."""
    return _stiff(
        skfem.MeshQuad2.from_mesh(
            skfem.MeshQuad.init_tensor(
                np.linspace(0, length, along + 1), np.linspace(-height / 2, height / 2, through + 1)
            )
        ),
        LADDER_STEEL,
    )


def _stiff(mesh: Any, material: Material) -> tuple[Any, Any]:
    mesh = mesh.with_subdomains({"body": np.arange(mesh.nelements)})
    basis = scalar_basis(mesh)
    return basis, stiffness(basis, {"body": ElasticLayer.of(material, 1.0)}).tocsc()


def solved(K: Any, f: Floats, held: Any, at: Floats | float = 0.0) -> Floats:
    """Displacements (2 nodes,) under the forces f (2 nodes,), the unknowns `held` at the values
    `at`.
    """
    u = np.zeros(len(f))
    u[held] = at
    free = np.setdiff1d(np.arange(len(f)), held)
    u[free] = splu(K[free][:, free].tocsc()).solve(f[free] - K[free][:, held] @ u[held])
    return u


def _stretched() -> float:
    """End force of a bar under the strain 1e-3, displacements e x, -nu e y."""
    basis, K = _rectangle(2, 1, 4, 3)
    x, y = basis.doflocs
    u = np.column_stack([1e-3 * x, -LADDER_STEEL.nu * 1e-3 * y]).ravel()
    return float((K @ u)[0::2][x > 2 - 1e-12].sum())


def _bent() -> float:
    """End moment of a bar of height 1 bent to the curvature 1e-3: u = -k x y, v = k (x^2 + nu
    y^2)/2.
    """
    basis, K = _rectangle(2, 1, 4, 3)
    x, y = basis.doflocs
    u = 1e-3 * np.column_stack([-x * y, 0.5 * (x**2 + LADDER_STEEL.nu * y**2)]).ravel()
    end = x > 2 - 1e-12
    return float(-((K @ u)[0::2] * y)[end].sum())


def _cantilever() -> float:
    """Tip force of a beam, length 4, height 1, over the closed form, from its displacements on both
    ends.

    Timoshenko & Goodier, art. 21: cubic displacements, so that the elements have an error.
    """
    L, c, P = 4.0, 0.5, 1.0
    E, nu, I = LADDER_STEEL.E, LADDER_STEEL.nu, 2 * 0.5**3 / 3  # noqa: E741
    G = E / (2 * (1 + nu))
    basis, K = _rectangle(L, 2 * c, 16, 4)
    x, y = basis.doflocs
    u = -P * x**2 * y / (2 * E * I) - nu * P * y**3 / (6 * E * I) + P * y**3 / (6 * I * G)
    v = nu * P * x * y**2 / (2 * E * I) + P * x**3 / (6 * E * I) - P * c**2 * x / (2 * I * G)
    both = np.column_stack([u, v]).ravel()
    ends = np.flatnonzero((x < 1e-12) | (x > L - 1e-12))
    held = np.concatenate([2 * ends, 2 * ends + 1])
    found = solved(K, np.zeros(2 * basis.N), held, both[held])
    return abs(float((K @ found)[1::2][x < 1e-12].sum()))


def _curved_bar() -> float:
    """P u_0 of the quarter ring, a = 1, b = 2, E = 1e4, nu = 1/4, moved by u_0 = .01 at its end."""
    grid = skfem.MeshQuad.init_tensor(np.linspace(1, 2, 13), np.linspace(0, math.pi / 2, 25))
    mesh = skfem.MeshQuad2.from_mesh(grid)
    r, phi = mesh.doflocs
    basis, K = _stiff(
        skfem.MeshQuad2(np.array([r * np.cos(phi), r * np.sin(phi)]), mesh.t),
        Material(E=1e4, nu=0.25),
    )
    x, y = basis.doflocs
    base, tip = np.flatnonzero(np.abs(x) < 1e-12), np.flatnonzero(np.abs(y) < 1e-12)
    pinned = base[np.argmin(np.abs(y[base] - 1))]
    held = np.concatenate([2 * base, [2 * pinned + 1], 2 * tip])
    at = np.where(np.isin(held, 2 * tip), 0.01, 0.0)
    u = solved(K, np.zeros(2 * basis.N), held, at)
    return float(u @ (K @ u))


@cache
def _lame() -> tuple[float, float]:
    """Mean radial displacements [m] at both edges of the ring under 60 MPa inside."""
    mesh = closed(np.linspace(-math.pi, math.pi, 33)[:-1], np.linspace(0, 0.1, 7), 0.1, 1)
    basis, K = _stiff(mesh, Material(E=200e9, nu=0.3))
    line = contact_line(basis, mesh.boundaries["contact"], 0.0)
    force = couple(line, 1.0, radial(1)).N.T @ np.full(len(line.nodes), 60e6)
    f = np.zeros((basis.N, 2))
    f[line.nodes] = force.reshape(-1, 2)
    x, y = basis.doflocs
    on_x, on_y = np.flatnonzero(np.abs(y) < 1e-9), np.flatnonzero(np.abs(x) < 1e-9)
    u = solved(K, f.ravel(), np.concatenate([2 * on_x + 1, 2 * on_y]))
    r = np.hypot(x, y)
    moved = (u[0::2] * x + u[1::2] * y) / r
    return float(moved[r < 0.1 + 1e-9].mean()), float(moved[r > 0.2 - 1e-9].mean())


@cache
def _thin_ring() -> tuple[float, float]:
    """Changes of both diameters of a thin ring under a diametral pair of forces, times EI/(F R^3):
    t/R = .02.
    """
    R, t, E = 1.0, 0.02, 1e9
    mesh = closed(np.linspace(-math.pi, math.pi, 241)[:-1], np.array([0.0, t]), R - t / 2, 1)
    basis, K = _stiff(mesh, Material(E=E, nu=0.0))
    x, y = basis.doflocs
    f = np.zeros((basis.N, 2))
    middle = np.abs(np.hypot(x, y) - R) < 1e-9
    top = np.flatnonzero(middle & (np.abs(x) < 1e-9) & (y > 0))
    bottom = np.flatnonzero(middle & (np.abs(x) < 1e-9) & (y < 0))
    right = np.flatnonzero(middle & (np.abs(y) < 1e-9) & (x > 0))
    f[top, 1], f[bottom, 1] = -1.0, 1.0
    on_x, on_y = np.flatnonzero(np.abs(y) < 1e-9), np.flatnonzero(np.abs(x) < 1e-9)
    u = solved(K, f.ravel(), np.concatenate([2 * on_x + 1, 2 * on_y]))
    size = E * t**3 / 12 / R**3
    return float(-2 * u[2 * top[0] + 1] * size), float(2 * u[2 * right[0]] * size)


def _rate(kind: str) -> float:
    """Observed order of the L2 error on u = (sin pi x sin pi y, x y) with its body force."""
    make, raised = {"quad2": (skfem.MeshQuad, skfem.MeshQuad2), "tri1": (skfem.MeshTri, None)}[kind]
    E, nu, pi = 1000.0, 0.3, math.pi
    lam, mu = E * nu / (1 - nu**2), E / (2 * (1 + nu))
    errors = []
    for n in (8, 16):
        grid = make.init_tensor(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))
        basis, K = _stiff(raised.from_mesh(grid) if raised else grid, Material(E=E, nu=nu))
        points = np.asarray(basis.global_coordinates())
        ss, cc = (g(pi * points[0]) * g(pi * points[1]) for g in (np.sin, np.cos))
        force = ((lam + 3 * mu) * pi**2 * ss - (lam + mu), -(lam + mu) * pi**2 * cc)
        f = np.zeros((basis.N, 2))
        for psi, dofs in zip(basis.basis, basis.element_dofs, strict=True):
            for c in (0, 1):
                np.add.at(f[:, c], dofs, (psi[0] * force[c] * basis.dx).sum(axis=1))
        exact = _manufactured(*basis.doflocs)
        edge = basis.get_dofs().flatten()
        held = np.concatenate([2 * edge, 2 * edge + 1])
        u = solved(K, f.ravel(), held, exact.T.ravel()[held])
        off = np.array([np.asarray(basis.interpolate(u[c::2])) for c in (0, 1)]) - _manufactured(
            *points
        )
        errors.append(math.sqrt(float(((off**2).sum(axis=0) * basis.dx).sum())))
    return math.log2(errors[0] / errors[1])


def _manufactured(x: Floats, y: Floats) -> Floats:
    return np.array([np.sin(math.pi * x) * np.sin(math.pi * y), x * y])


def _murty() -> float:
    """Largest pressure of the P-matrix on which plain pivoting of all wrong nodes cycles."""
    A = np.array([[1.0, 2, 0], [0, 1, 2], [2, 0, 1]])
    none = np.zeros((3, 0))
    return float(active_set.solve(Problem(A, -np.ones(3), none, none.T, np.zeros(0))).p.max())


def _lever() -> float:
    """Force of the outer one of two equal springs at 1 and 2 m on a hinged rigid lever under 3 N at
    2 m.
    """
    B = -np.array([[1.0], [2.0]])
    problem = Problem(np.eye(2), np.zeros(2), B, B.T.copy(), np.array([-6.0]))
    return float(active_set.solve(problem).p[1])


LAME = closed_forms.lame(0.1, 0.2, 60e6, 200e9, 0.3)
STEEL_MODULUS, STEEL_POISSON = LADDER_STEEL.E, LADDER_STEEL.nu
ROACHE_SAYS = "Roache, Verification and Validation (1998): f = .97050, .96854, .96178, r = 2; in single precision"
TIMOSHENKO = "Timoshenko & Goodier, Theory of Elasticity"
BODY_CASES = (
    KnownAnswer(
        "grid convergence index",
        "Richardson extrapolation",
        ROACHE_SAYS,
        "order",
        1.78618479,
        1e-5,
        PRINTED,
        lambda: _roache().order,
    ),
    KnownAnswer(
        "grid convergence index",
        "Richardson extrapolation",
        ROACHE_SAYS,
        "extrapolated",
        0.971300304,
        1e-7,
        PRINTED,
        lambda: _roache().extrapolated,
    ),
    KnownAnswer(
        "grid convergence index",
        "uncertainty of an extrapolation",
        ROACHE_SAYS,
        "GCI, fine [%]",
        0.103080,
        5e-5,
        PRINTED,
        lambda: 100 * _roache().fine,
    ),
    KnownAnswer(
        "grid convergence index",
        "uncertainty of an extrapolation",
        ROACHE_SAYS,
        "GCI, coarse [%]",
        0.356244,
        5e-5,
        PRINTED,
        lambda: 100 * _roache().coarse,
    ),
    KnownAnswer(
        "uniaxial stress",
        "plane-stress stiffness",
        "s = E e",
        "end force [N]",
        STEEL_MODULUS * 1e-3,
        1e-11,
        EXACT,
        _stretched,
    ),
    KnownAnswer(
        "pure bending",
        "quadratic elements",
        f"{TIMOSHENKO}: M = E I k",
        "end moment [N m]",
        STEEL_MODULUS * 1e-3 / 12,
        1e-11,
        EXACT,
        _bent,
    ),
    KnownAnswer(
        "cantilever under end shear",
        "quadratic elements",
        f"{TIMOSHENKO}, art. 21",
        "end force [N]",
        1.0,
        1e-4,
        DISCRETE,
        _cantilever,
    ),
    KnownAnswer(
        "curved bar under end shear",
        "curved quadratic elements",
        f"{TIMOSHENKO}: (ln 2 - .6)/pi",
        "P u_0",
        (math.log(2) - 0.6) / math.pi,
        2e-5,
        DISCRETE,
        _curved_bar,
    ),
    KnownAnswer(
        "ring under inner pressure",
        "pressure on a curved edge",
        "Lame 1852",
        "u at the inner edge [m]",
        LAME[0],
        2e-4,
        DISCRETE,
        lambda: _lame()[0],
    ),
    KnownAnswer(
        "ring under inner pressure",
        "pressure on a curved edge",
        "Lame 1852",
        "u at the outer edge [m]",
        LAME[1],
        2e-4,
        DISCRETE,
        lambda: _lame()[1],
    ),
    KnownAnswer(
        "thin ring under a diametral pair, by elements",
        "slender elements",
        "Timoshenko, Strength of Materials II",
        "closing E I/(F R^3)",
        math.pi / 4 - 2 / math.pi,
        3e-3,
        DISCRETE,
        lambda: _thin_ring()[0],
    ),
    KnownAnswer(
        "thin ring under a diametral pair, by elements",
        "slender elements",
        "Timoshenko, Strength of Materials II",
        "widening E I/(F R^3)",
        2 / math.pi - 0.5,
        3e-3,
        DISCRETE,
        lambda: _thin_ring()[1],
    ),
    KnownAnswer(
        "thin ring under a diametral pair, as a series",
        "ring of the foundation model",
        "Timoshenko, Strength of Materials II",
        "closing E I/(F R^3)",
        math.pi / 4 - 2 / math.pi,
        1e-12,
        EXACT,
        lambda: 2 * float(two_forces(np.array(0.0))) / math.pi,
    ),
    KnownAnswer(
        "thin ring under a diametral pair, as a series",
        "ring of the foundation model",
        "Timoshenko, Strength of Materials II",
        "widening E I/(F R^3)",
        2 / math.pi - 0.5,
        1e-12,
        EXACT,
        lambda: -2 * float(two_forces(np.array(math.pi / 2))) / math.pi,
    ),
    KnownAnswer(
        "manufactured solution",
        "quadratic quadrilaterals",
        "Roache 2002; order of the element",
        "order",
        3.0,
        0.03,
        DISCRETE,
        partial(_rate, "quad2"),
    ),
    KnownAnswer(
        "manufactured solution",
        "linear triangles",
        "Roache 2002; order of the element",
        "order, tri1",
        2.0,
        0.03,
        DISCRETE,
        partial(_rate, "tri1"),
    ),
    KnownAnswer(
        "Murty's cycle",
        "active set",
        "Murty 1974: p = 1/3 at each node",
        "p",
        1 / 3,
        1e-13,
        EXACT,
        _murty,
    ),
    KnownAnswer(
        "lever on two springs",
        "equilibrium of a free motion",
        "statics: F_2 = 2 F_1, F_1 + 2 F_2 = 6 N",
        "force of the outer spring [N]",
        2.4,
        1e-12,
        EXACT,
        _lever,
    ),
)
