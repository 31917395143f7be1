"""Cases of the benchmark ladder on elastic bodies and on numerical methods, without contact.

The cases test the stiffness of elements, the order of convergence, rings, and extrapolation.
"""

import math
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np
import skfem
from scipy.sparse.linalg import splu

from drumlin.base.arrays import Floats
from drumlin.brake.elasticity import ElasticLayer
from drumlin.brake.fields import Material
from drumlin.contact import active_set
from drumlin.contact.equations import ContactProblem
from drumlin.fem.mesh.degree import nodal_basis_of_mesh
from drumlin.fem.substructure.body import (
    sparse_stiffness_of_body,
)
from drumlin.fem.substructure.interface import (
    coupling_matrices_of_contact_line,
    function_that_returns_drum_normals_and_tangents,
    make_contact_line_of_lining,
)
from drumlin.foundation.ring import deflection_series_of_two_opposite_forces
from drumlin_studies import closed_forms
from drumlin_studies.ladder_case import (
    TOLERANCE_REASON_DISCRETISATION,
    TOLERANCE_REASON_PRINTED_DIGITS,
    TOLERANCE_REASON_ROUND_OFF,
    KnownAnswerCase,
)
from drumlin_studies.two_bodies import (
    STEEL_OF_KNOWN_ANSWER_CASES,
    plane_mesh_of_closed_ring,
    scikit_fem_basis_of_mesh,
)
from drumlin_studies.uncertainty import GridConvergenceIndex, grid_convergence_index_of_three_values

ROACHE_EXAMPLE_VALUES_ON_THREE_MESHES = (0.96178, 0.96854, 0.97050)
"""Values of one quantity on three meshes, coarse to fine, from an example of Roache. The elements
of each mesh are half as long as those of the mesh before.
"""
SYMMETRY_AXIS_TOLERANCE = 1e-9
"""Distance [m] from an axis of symmetry within which a node counts as lying on it."""


def _roache_convergence_index() -> GridConvergenceIndex:
    """The grid convergence index of Roache's example values."""
    coarse, medium, fine = ROACHE_EXAMPLE_VALUES_ON_THREE_MESHES
    return grid_convergence_index_of_three_values(fine, medium, coarse)


def _basis_and_stiffness_of_rectangle(
    length: float, height: float, along: int, through: int
) -> tuple[Any, Any]:
    """The finite-element basis and stiffness matrix of a steel rectangle, quadratic quadrilaterals.

    Parameters
    ----------
    length, height : float
        The rectangle is [0, length] x [-height/2, height/2] [m].
    along, through : int
        Number of elements along the length and along the height.
    """
    x = np.linspace(0, length, along + 1)
    y = np.linspace(-height / 2, height / 2, through + 1)
    grid = skfem.MeshQuad.init_tensor(x, y)
    return _basis_and_stiffness_of_mesh(
        skfem.MeshQuad2.from_mesh(grid), STEEL_OF_KNOWN_ANSWER_CASES
    )


def _basis_and_stiffness_of_mesh(mesh: Any, material: Material) -> tuple[Any, Any]:
    """The finite-element basis and stiffness matrix of a body of one material and unit width."""
    mesh = mesh.with_subdomains({"body": np.arange(mesh.nelements)})
    return scikit_fem_basis_of_mesh(mesh), sparse_stiffness_of_body(
        nodal_basis_of_mesh(mesh), {"body": ElasticLayer.make_layer_in_plane_stress(material, 1.0)}
    ).tocsc()


def solve_nodal_displacements(K: Any, f: Floats, held: Any, at: Floats | float = 0.0) -> Floats:
    """Nodal displacements (2 nodes,) [m] of a body under forces and prescribed displacements.

    Parameters
    ----------
    K : sparse matrix (2 nodes, 2 nodes)
        Stiffness matrix.
    f : array (2 nodes,)
        Nodal forces.
    held : array of int
        Indices of the prescribed displacements.
    at : array or float
        Values of the prescribed displacements.
    """
    u = np.zeros(len(f))
    u[held] = at
    # The prescribed displacements u act on the free unknowns as the nodal forces -K u.
    free = np.setdiff1d(np.arange(len(f)), held)
    u[free] = splu(K[free][:, free].tocsc()).solve(f[free] - K[free][:, held] @ u[held])
    return u


def _end_force_of_stretched_bar() -> float:
    """End force [N] of a bar under the uniaxial strain e = 1e-3.

    The prescribed displacements are u = e x, v = -nu e y.
    """
    basis, K = _basis_and_stiffness_of_rectangle(2, 1, 4, 3)
    x, y = basis.doflocs
    u = np.column_stack([1e-3 * x, -STEEL_OF_KNOWN_ANSWER_CASES.nu * 1e-3 * y]).ravel()
    return float((K @ u)[0::2][x > 2 - 1e-12].sum())


def _end_moment_of_bent_bar() -> float:
    """End moment [N m] of a bar of height 1 m, bent to the curvature k = 1e-3 1/m.

    The prescribed displacements are u = -k x y, v = k (x^2 + nu y^2)/2.
    """
    basis, K = _basis_and_stiffness_of_rectangle(2, 1, 4, 3)
    x, y = basis.doflocs
    u = (
        1e-3
        * np.column_stack([-x * y, 0.5 * (x**2 + STEEL_OF_KNOWN_ANSWER_CASES.nu * y**2)]).ravel()
    )
    end = x > 2 - 1e-12
    return float(-((K @ u)[0::2] * y)[end].sum())


def _cantilever_end_force_over_closed_form() -> float:
    """End force of a cantilever of length 4 and height 1, relative to the closed form.

    The displacements of both ends are prescribed as in the closed form (Timoshenko & Goodier,
    art. 21). They are cubic, so that quadratic elements have an error.
    """
    L, c, P = 4.0, 0.5, 1.0
    E, nu, I = STEEL_OF_KNOWN_ANSWER_CASES.E, STEEL_OF_KNOWN_ANSWER_CASES.nu, 2 * 0.5**3 / 3  # noqa: E741
    G = E / (2 * (1 + nu))
    basis, K = _basis_and_stiffness_of_rectangle(L, 2 * c, 16, 4)
    x, y = basis.doflocs
    u = -P * x**2 * y / (2 * E * I) - nu * P * y**3 / (6 * E * I) + P * y**3 / (6 * I * G)
    v = nu * P * x * y**2 / (2 * E * I) + P * x**3 / (6 * E * I) - P * c**2 * x / (2 * I * G)
    both = np.column_stack([u, v]).ravel()
    ends = np.flatnonzero((x < 1e-12) | (x > L - 1e-12))
    held = np.concatenate([2 * ends, 2 * ends + 1])
    displacements = solve_nodal_displacements(K, np.zeros(2 * basis.N), held, both[held])
    return abs(float((K @ displacements)[1::2][x < 1e-12].sum()))


def _work_of_end_force_on_curved_bar() -> float:
    """Product P u_0 of the displacement u_0 = 0.01 of a quarter ring's end and the end force P.

    The ring lies between the radii 1 and 2 and has E = 1e4 and nu = 1/4.
    """
    grid = skfem.MeshQuad.init_tensor(np.linspace(1, 2, 13), np.linspace(0, math.pi / 2, 25))
    mesh = skfem.MeshQuad2.from_mesh(grid)
    r, phi = mesh.doflocs
    curved = skfem.MeshQuad2(np.array([r * np.cos(phi), r * np.sin(phi)]), mesh.t)
    basis, K = _basis_and_stiffness_of_mesh(curved, Material(E=1e4, nu=0.25))
    x, y = basis.doflocs
    # The base (x = 0) is fixed along x, and one of its nodes also along y. The tip (y = 0) is
    # displaced along y by 0.01.
    base, tip = np.flatnonzero(np.abs(x) < 1e-12), np.flatnonzero(np.abs(y) < 1e-12)
    pinned = base[np.argmin(np.abs(y[base] - 1))]
    held = np.concatenate([2 * base, [2 * pinned + 1], 2 * tip])
    at = np.where(np.isin(held, 2 * tip), 0.01, 0.0)
    u = solve_nodal_displacements(K, np.zeros(2 * basis.N), held, at)
    return float(u @ (K @ u))


class MeanRadialDisplacementsOfRingEdges(NamedTuple):
    """The mean radial displacements [m] of the inner and of the outer edge of a ring."""

    inner: float
    outer: float


@cache
def _edge_displacements_of_lame_ring() -> MeanRadialDisplacementsOfRingEdges:
    """Displacements of a steel ring between the radii 0.1 m and 0.2 m under 60 MPa inside."""
    mesh = plane_mesh_of_closed_ring(
        np.linspace(-math.pi, math.pi, 33)[:-1], np.linspace(0, 0.1, 7), 0.1, 1
    )
    basis, K = _basis_and_stiffness_of_mesh(mesh, Material(E=200e9, nu=0.3))
    line = make_contact_line_of_lining(basis, mesh.boundaries["contact"], 0.0)
    # The nodal forces of the uniform pressure on the inner edge.
    force = coupling_matrices_of_contact_line(
        line, 1.0, function_that_returns_drum_normals_and_tangents(1)
    ).N.T @ np.full(len(line.nodes), 60e6)
    f = np.zeros((basis.N, 2))
    f[line.nodes] = force.reshape(-1, 2)
    x, y = basis.doflocs
    on_x, on_y = (
        np.flatnonzero(np.abs(y) < SYMMETRY_AXIS_TOLERANCE),
        np.flatnonzero(np.abs(x) < SYMMETRY_AXIS_TOLERANCE),
    )
    u = solve_nodal_displacements(K, f.ravel(), np.concatenate([2 * on_x + 1, 2 * on_y]))
    r = np.hypot(x, y)
    radial_u = (u[0::2] * x + u[1::2] * y) / r
    inner, outer = radial_u[r < 0.1 + 1e-9], radial_u[r > 0.2 - 1e-9]
    return MeanRadialDisplacementsOfRingEdges(float(inner.mean()), float(outer.mean()))


class DimensionlessRingDiameterChanges(NamedTuple):
    """Changes of a ring's diameter along and across two opposite forces F, times EI/(F R^3)."""

    closing: float
    widening: float


@cache
def _diameter_changes_of_thin_ring() -> DimensionlessRingDiameterChanges:
    """Dimensionless diameter changes of a ring of t/R = 0.02 under two forces along a diameter."""
    R, t, E = 1.0, 0.02, 1e9
    mesh = plane_mesh_of_closed_ring(
        np.linspace(-math.pi, math.pi, 241)[:-1], np.array([0.0, t]), R - t / 2, 1
    )
    basis, K = _basis_and_stiffness_of_mesh(mesh, Material(E=E, nu=0.0))
    x, y = basis.doflocs
    f = np.zeros((basis.N, 2))
    # The forces act on the middle line of the ring, at its top and its bottom.
    middle = np.abs(np.hypot(x, y) - R) < 1e-9
    top = np.flatnonzero(middle & (np.abs(x) < SYMMETRY_AXIS_TOLERANCE) & (y > 0))
    bottom = np.flatnonzero(middle & (np.abs(x) < SYMMETRY_AXIS_TOLERANCE) & (y < 0))
    right = np.flatnonzero(middle & (np.abs(y) < SYMMETRY_AXIS_TOLERANCE) & (x > 0))
    f[top, 1], f[bottom, 1] = -1.0, 1.0
    on_x, on_y = (
        np.flatnonzero(np.abs(y) < SYMMETRY_AXIS_TOLERANCE),
        np.flatnonzero(np.abs(x) < SYMMETRY_AXIS_TOLERANCE),
    )
    u = solve_nodal_displacements(K, f.ravel(), np.concatenate([2 * on_x + 1, 2 * on_y]))
    size = E * t**3 / 12 / R**3
    closing, widening = -2 * u[2 * top[0] + 1] * size, 2 * u[2 * right[0]] * size
    return DimensionlessRingDiameterChanges(float(closing), float(widening))


def _observed_order_of_convergence(kind: str) -> float:
    """Order of convergence of the L2 error of the displacements, for elements of a kind.

    The kind is "quad2" or "tri1". The order follows from the errors on two meshes of 8 and 16
    elements to a side, for a manufactured solution.
    """
    return math.log2(
        _displacement_error_for_manufactured_solution(kind, 8)
        / _displacement_error_for_manufactured_solution(kind, 16)
    )


def _displacement_error_for_manufactured_solution(kind: str, n: int) -> float:
    """L2 error of the displacements of a unit square with n elements along each side.

    The exact displacements u = (sin pi x sin pi y, x y) are chosen ("manufactured"), and the body
    force follows from them.
    """
    make, raised = {"quad2": (skfem.MeshQuad, skfem.MeshQuad2), "tri1": (skfem.MeshTri, None)}[kind]
    E, nu, pi = 1000.0, 0.3, math.pi
    lam, mu = E * nu / (1 - nu**2), E / (2 * (1 + nu))
    grid = make.init_tensor(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))
    basis, K = _basis_and_stiffness_of_mesh(
        raised.from_mesh(grid) if raised else grid, Material(E=E, nu=nu)
    )
    points = np.asarray(basis.global_coordinates())
    ss = np.sin(pi * points[0]) * np.sin(pi * points[1])
    cc = np.cos(pi * points[0]) * np.cos(pi * points[1])
    force = ((lam + 3 * mu) * pi**2 * ss - (lam + mu), -(lam + mu) * pi**2 * cc)
    # The nodal forces of the body force, integrated with the shape functions.
    f = np.zeros((basis.N, 2))
    for psi, dofs in zip(basis.basis, basis.element_dofs, strict=True):
        for c in (0, 1):
            np.add.at(f[:, c], dofs, (psi[0] * force[c] * basis.dx).sum(axis=1))
    # The displacements of all nodes on the boundary are prescribed.
    exact = _displacements_of_manufactured_solution(*basis.doflocs)
    edge = basis.get_dofs().flatten()
    held = np.concatenate([2 * edge, 2 * edge + 1])
    u = solve_nodal_displacements(K, f.ravel(), held, exact.T.ravel()[held])
    computed = np.array([np.asarray(basis.interpolate(u[c::2])) for c in (0, 1)])
    error = computed - _displacements_of_manufactured_solution(*points)
    return math.sqrt(float(((error**2).sum(axis=0) * basis.dx).sum()))


def _displacements_of_manufactured_solution(x: Floats, y: Floats) -> Floats:
    """The displacements (2, ...) of the manufactured solution, (sin pi x sin pi y, x y)."""
    return np.array([np.sin(math.pi * x) * np.sin(math.pi * y), x * y])


def _largest_pressure_of_murty_problem() -> float:
    """Largest pressure in Murty's contact problem, in which a simpler active-set method fails.

    The simpler method changes the state of all wrong nodes at once, and so repeats the same contact
    sets for ever.
    """
    A = np.array([[1.0, 2, 0], [0, 1, 2], [2, 0, 1]])
    none = np.zeros((3, 0))
    return float(
        active_set.solve_contact_problem(
            ContactProblem(A, -np.ones(3), none, none.T, np.zeros(0))
        ).p.max()
    )


def _outer_spring_force_of_lever() -> float:
    """Force [N] of the outer spring of a hinged rigid lever under 3 N at 2 m.

    Two equal springs support the lever at 1 m and 2 m from the hinge.
    """
    B = -np.array([[1.0], [2.0]])
    problem = ContactProblem(np.eye(2), np.zeros(2), B, B.T.copy(), np.array([-6.0]))
    return float(active_set.solve_contact_problem(problem).p[1])


LAME_EDGE_DISPLACEMENTS = closed_forms.lame_displacements_of_ring_edges(0.1, 0.2, 60e6, 200e9, 0.3)
"""Radial displacements [m] of the inner and the outer edge of a ring under inner pressure (Lame).
"""
STEEL_MODULUS, STEEL_POISSON = STEEL_OF_KNOWN_ANSWER_CASES.E, STEEL_OF_KNOWN_ANSWER_CASES.nu
"""Young's modulus [Pa] and Poisson's ratio of the steel of the ladder."""
ROACHE_CITATION = (
    "Roache, Verification and Validation (1998): f = .97050, .96854, .96178, r = 2; "
    "in single precision"
)
"""Citation of the example of the grid convergence index, for the ladder's table."""
TIMOSHENKO_CITATION = "Timoshenko & Goodier, Theory of Elasticity"
"""Citation of closed forms of beams and rings, for the ladder's table."""
KNOWN_ANSWER_CASES_ON_ELASTIC_BODIES = (
    KnownAnswerCase(
        family="grid convergence index",
        shows="Richardson extrapolation",
        source=ROACHE_CITATION,
        quantity="order",
        expected=1.78618479,
        tolerance=1e-5,
        tier=TOLERANCE_REASON_PRINTED_DIGITS,
        found=lambda: _roache_convergence_index().order,
    ),
    KnownAnswerCase(
        family="grid convergence index",
        shows="Richardson extrapolation",
        source=ROACHE_CITATION,
        quantity="extrapolated",
        expected=0.971300304,
        tolerance=1e-7,
        tier=TOLERANCE_REASON_PRINTED_DIGITS,
        found=lambda: _roache_convergence_index().extrapolated,
    ),
    KnownAnswerCase(
        family="grid convergence index",
        shows="uncertainty of an extrapolation",
        source=ROACHE_CITATION,
        quantity="GCI, fine [%]",
        expected=0.103080,
        tolerance=5e-5,
        tier=TOLERANCE_REASON_PRINTED_DIGITS,
        found=lambda: 100 * _roache_convergence_index().fine,
    ),
    KnownAnswerCase(
        family="grid convergence index",
        shows="uncertainty of an extrapolation",
        source=ROACHE_CITATION,
        quantity="GCI, coarse [%]",
        expected=0.356244,
        tolerance=5e-5,
        tier=TOLERANCE_REASON_PRINTED_DIGITS,
        found=lambda: 100 * _roache_convergence_index().coarse,
    ),
    KnownAnswerCase(
        family="uniaxial stress",
        shows="plane-stress stiffness",
        source="s = E e",
        quantity="end force [N]",
        expected=STEEL_MODULUS * 1e-3,
        tolerance=1e-11,
        tier=TOLERANCE_REASON_ROUND_OFF,
        found=_end_force_of_stretched_bar,
    ),
    KnownAnswerCase(
        family="pure bending",
        shows="quadratic elements",
        source=f"{TIMOSHENKO_CITATION}: M = E I k",
        quantity="end moment [N m]",
        expected=STEEL_MODULUS * 1e-3 / 12,
        tolerance=1e-11,
        tier=TOLERANCE_REASON_ROUND_OFF,
        found=_end_moment_of_bent_bar,
    ),
    KnownAnswerCase(
        family="cantilever under end shear",
        shows="quadratic elements",
        source=f"{TIMOSHENKO_CITATION}, art. 21",
        quantity="end force [N]",
        expected=1.0,
        tolerance=1e-4,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=_cantilever_end_force_over_closed_form,
    ),
    KnownAnswerCase(
        family="curved bar under end shear",
        shows="curved quadratic elements",
        source=f"{TIMOSHENKO_CITATION}: (ln 2 - .6)/pi",
        quantity="P u_0",
        expected=(math.log(2) - 0.6) / math.pi,
        tolerance=2e-5,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=_work_of_end_force_on_curved_bar,
    ),
    KnownAnswerCase(
        family="ring under inner pressure",
        shows="pressure on a curved edge",
        source="Lame 1852",
        quantity="u at the inner edge [m]",
        expected=LAME_EDGE_DISPLACEMENTS[0],
        tolerance=2e-4,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=lambda: _edge_displacements_of_lame_ring().inner,
    ),
    KnownAnswerCase(
        family="ring under inner pressure",
        shows="pressure on a curved edge",
        source="Lame 1852",
        quantity="u at the outer edge [m]",
        expected=LAME_EDGE_DISPLACEMENTS[1],
        tolerance=2e-4,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=lambda: _edge_displacements_of_lame_ring().outer,
    ),
    KnownAnswerCase(
        family="thin ring under a diametral pair, by elements",
        shows="slender elements",
        source="Timoshenko, Strength of Materials II",
        quantity="closing E I/(F R^3)",
        expected=math.pi / 4 - 2 / math.pi,
        tolerance=3e-3,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=lambda: _diameter_changes_of_thin_ring().closing,
    ),
    KnownAnswerCase(
        family="thin ring under a diametral pair, by elements",
        shows="slender elements",
        source="Timoshenko, Strength of Materials II",
        quantity="widening E I/(F R^3)",
        expected=2 / math.pi - 0.5,
        tolerance=3e-3,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=lambda: _diameter_changes_of_thin_ring().widening,
    ),
    KnownAnswerCase(
        family="thin ring under a diametral pair, as a series",
        shows="ring of the foundation model",
        source="Timoshenko, Strength of Materials II",
        quantity="closing E I/(F R^3)",
        expected=math.pi / 4 - 2 / math.pi,
        tolerance=1e-12,
        tier=TOLERANCE_REASON_ROUND_OFF,
        found=lambda: 2 * float(deflection_series_of_two_opposite_forces(np.array(0.0))) / math.pi,
    ),
    KnownAnswerCase(
        family="thin ring under a diametral pair, as a series",
        shows="ring of the foundation model",
        source="Timoshenko, Strength of Materials II",
        quantity="widening E I/(F R^3)",
        expected=2 / math.pi - 0.5,
        tolerance=1e-12,
        tier=TOLERANCE_REASON_ROUND_OFF,
        found=lambda: (
            -2 * float(deflection_series_of_two_opposite_forces(np.array(math.pi / 2))) / math.pi
        ),
    ),
    KnownAnswerCase(
        family="manufactured solution",
        shows="quadratic quadrilaterals",
        source="Roache 2002; order of the element",
        quantity="order",
        expected=3.0,
        tolerance=0.03,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=partial(_observed_order_of_convergence, "quad2"),
    ),
    KnownAnswerCase(
        family="manufactured solution",
        shows="linear triangles",
        source="Roache 2002; order of the element",
        quantity="order, tri1",
        expected=2.0,
        tolerance=0.03,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=partial(_observed_order_of_convergence, "tri1"),
    ),
    KnownAnswerCase(
        family="Murty's cycle",
        shows="active set",
        source="Murty 1974: p = 1/3 at each node",
        quantity="p",
        expected=1 / 3,
        tolerance=1e-13,
        tier=TOLERANCE_REASON_ROUND_OFF,
        found=_largest_pressure_of_murty_problem,
    ),
    KnownAnswerCase(
        family="lever on two springs",
        shows="equilibrium of a free motion",
        source="statics: F_2 = 2 F_1, F_1 + 2 F_2 = 6 N",
        quantity="force of the outer spring [N]",
        expected=2.4,
        tolerance=1e-12,
        tier=TOLERANCE_REASON_ROUND_OFF,
        found=_outer_spring_force_of_lever,
    ),
)
"""The cases of the ladder on elastic bodies and numerical methods."""
