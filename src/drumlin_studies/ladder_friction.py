"""Cases of the benchmark ladder on friction and wear.

The cases treat stick and slip, a belt, a plate, self-locking, running in, and whole brakes.
"""

import math
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np
import skfem
from scipy.sparse.linalg import splu

from drumlin.base.arrays import Floats, Ints
from drumlin.brake.elasticity import ElasticLayer
from drumlin.brake.fields import Material
from drumlin.brake.file import vary
from drumlin.contact import active_set, equations, self_locking, stick_slip
from drumlin.contact.stick_slip import (
    OPEN,
    STICK,
    StickSlipProblem,
    TractionsAndSlipsOfLastIncrement,
)
from drumlin.fem.mesh.degree import nodal_basis_of_mesh
from drumlin.fem.solve import solve
from drumlin.fem.substructure.body import (
    sparse_stiffness_of_body,
)
from drumlin.fem.substructure.interface import (
    ContactCouplingMatrices,
    ContactLine,
    NormalsAndTangentsFunction,
    coupling_matrices_of_contact_line,
    function_that_returns_drum_normals_and_tangents,
    make_contact_line_of_lining,
)
from drumlin.laws import solve_brake_by_sine_law
from drumlin.laws.simscape import DoubleShoe
from drumlin.lining_wear.archard import (
    WearContactProblem,
    WearLaw,
    WearState,
    wear_linings_over_sliding_distance,
)
from drumlin.response.response import Response
from drumlin_studies import closed_forms
from drumlin_studies.ladder_case import (
    TOLERANCE_REASON_DISCRETISATION,
    TOLERANCE_REASON_MODEL_LIMIT,
    TOLERANCE_REASON_PRINTED_DIGITS,
    TOLERANCE_REASON_ROUND_OFF,
    KnownAnswerCase,
)
from drumlin_studies.ladder_contact import (
    HALF_PLANE_CONTACT_HALF_WIDTH,
    RELATIVE_CURVATURE_RADIUS_OF_HALF_PLANES,
    condensed_half_plane_body,
)
from drumlin_studies.two_bodies import (
    STEEL_OF_KNOWN_ANSWER_CASES,
    InnerAndOuterBodyInContact,
    first_contact_set_from_coarse_problem,
)


def _problem_of_node_on_springs(push: float, shift: float, k: float = 100.0) -> StickSlipProblem:
    """The stick-slip problem of one node on springs, which is pressed on a moving drum.

    Parameters
    ----------
    push : float
        Normal force on the node [N].
    shift : float
        Displacement of the drum along its surface [m].
    k : float
        Stiffness of the normal spring and of the tangential spring, which are equal [N/m].
    """
    # The arguments are the blocks of the equations of `StickSlipProblem`, here of size 1 or 0.
    one, none = np.ones((1, 1)), np.zeros((1, 1))
    across, along = np.zeros((1, 0)), np.zeros((0, 1))
    return StickSlipProblem(
        A_wp=one / k,
        A_wt=none,
        A_sp=none,
        A_st=-one / k,
        B_w=across,
        B_s=across,
        C_p=along,
        C_t=along,
        q_w=np.array([-push / k]),
        q_s=np.array([shift]),
        h=np.zeros(0),
        Q=0 * one,
    )


def _friction_force_on_node(shift: float) -> float:
    """Friction force [N] on a node under 10 N at mu = 0.5, after the drum has moved `shift` [m]."""
    untouched = TractionsAndSlipsOfLastIncrement(np.zeros(1), np.zeros(1))
    answer = stick_slip.solve_stick_slip_load_increment(
        _problem_of_node_on_springs(10.0, shift), 0.5, untouched, np.array([STICK])
    )
    return float(answer.t[0])


def _energy_dissipated_in_slip_loop() -> float:
    """Energy [J] that one node on springs dissipates by friction as the drum moves to and fro once.

    The drum moves between -0.2 m and 0.2 m.
    """
    # The drum moves from 0 to one end, to the other end, and back to the first end.
    path = np.concatenate(
        [np.linspace(0, 0.2, 21), np.linspace(0.2, -0.2, 41), np.linspace(-0.2, 0.2, 41)]
    )
    history, state, dissipated = (
        TractionsAndSlipsOfLastIncrement(np.zeros(1), np.zeros(1)),
        np.array([STICK]),
        0.0,
    )
    for i, shift in enumerate(path):
        answer = stick_slip.solve_stick_slip_load_increment(
            _problem_of_node_on_springs(10.0, shift), 0.5, history, state
        )
        # The first 21 positions lead to the start of the closed loop. The energy that is dissipated
        # on this way is left out.
        if i > 20:
            dissipated += float(answer.t[0] * (answer.s[0] - history.s[0]))
        history, state = answer.tractions_and_slips_for_next_increment, answer.state
    return dissipated


def _make_function_of_constant_normal_and_tangent(
    normal: Floats, tangent: Floats
) -> NormalsAndTangentsFunction:
    """A function that returns the same normal and tangent at all points of a plane contact.

    `normal` and `tangent` are unit vectors (2,).
    """

    def normal_and_tangent_at_points(points: Floats) -> tuple[Floats, Floats]:
        """The normal and the tangent (2, ...) at each of the points (2, ...)."""
        shape = (2, *([1] * (points.ndim - 1)))
        ones = np.ones_like(points)
        return normal.reshape(shape) * ones, tangent.reshape(shape) * ones

    return normal_and_tangent_at_points


def _push_over_weight_of_block_on_wedge() -> float:
    """Push on a block that slides up a wedge, divided by the weight of the block.

    The push is horizontal, the slope of the wedge is 0.1 (rise over run), and mu is 0.3.
    """
    slope, x = math.atan(0.1), np.linspace(0, 1, 5)
    up = np.array([math.cos(slope), math.sin(slope)])
    # A straight contact line of two quadratic edges.
    line = ContactLine(np.arange(5), up[:, None] * x, x, np.array([[0, 2], [1, 3], [2, 4]]))
    coupling = coupling_matrices_of_contact_line(
        line, 1.0, _make_function_of_constant_normal_and_tangent(np.array([up[1], -up[0]]), -up)
    )
    # Forces on the block under a uniform pressure of 7 Pa. The push and the weight balance these
    # forces.
    p = np.full(5, 7.0)
    on_block = (-coupling.N.T @ p + 0.3 * coupling.T.T @ p).reshape(-1, 2).sum(axis=0)
    return float(-on_block[0] / on_block[1])


@cache
def _sticking_over_contact_half_width(share: float) -> float:
    """Half-width c of the sticking zone over half-width a of the contact, for two cylinders.

    The tangential load is `share` times mu P, with the normal load P. The ratio c/a = 1 - t/(mu p)
    follows from the pressure p and the traction t in the middle. The ends of the computed zones
    would be less exact, because they can only lie at nodes.
    """
    mu, load = (
        0.3,
        HALF_PLANE_CONTACT_HALF_WIDTH**2
        * math.pi
        * STEEL_OF_KNOWN_ANSWER_CASES.E
        / 2
        / (4 * RELATIVE_CURVATURE_RADIUS_OF_HALF_PLANES),
    )
    pair = InnerAndOuterBodyInContact.couple_two_bodies_at_contact_nodes(
        condensed_half_plane_body(-1, 14), condensed_half_plane_body(1, 12), motions="xy"
    )
    s = pair.contact_node_angles
    gap, n = s**2 / (2 * RELATIVE_CURVATURE_RADIUS_OF_HALF_PLANES), len(s)
    along = InnerAndOuterBodyInContact(
        pair.inner, pair.coupling, pair.pressed, pair.dragged, pair.motions[:, :1]
    )
    pressing = along.frictionless_contact_problem(gap, [load])
    state = np.where(
        active_set.solve_contact_problem(
            pressing, first_contact_set_from_coarse_problem(pressing)
        ).active,
        STICK,
        OPEN,
    )
    # The normal load comes first, then the tangential load in two steps.
    untouched = TractionsAndSlipsOfLastIncrement(np.zeros(n), np.zeros(n))
    found = stick_slip.solve_stick_slip_load_increment(
        pair.frictional_contact_problem(gap, [load, 0.0]), mu, untouched, state
    )
    for part in (0.5, 1.0):
        loads = [load, part * share * mu * load]
        found = stick_slip.solve_stick_slip_load_increment(
            pair.frictional_contact_problem(gap, loads),
            mu,
            found.tractions_and_slips_for_next_increment,
            found.state,
        )
    middle = np.abs(s) < 0.2 * HALF_PLANE_CONTACT_HALF_WIDTH
    ratio = np.abs(found.t[middle]).mean() / (mu * found.p[middle].mean())
    # At s = 0 the exact ratio t/(mu p) is 1 - c/a. `ratio` belongs to a small interval around the
    # middle and differs from 1 - c/a by a term of second order. The closed form gives this
    # difference, which is subtracted from `ratio`.
    exact_p = np.sqrt(1 - (s[middle] / HALF_PLANE_CONTACT_HALF_WIDTH) ** 2)
    c = math.sqrt(1 - share)
    exact_t = exact_p - c * np.sqrt(1 - (s[middle] / (c * HALF_PLANE_CONTACT_HALF_WIDTH)) ** 2)
    return float(1 - ratio + (exact_t.mean() / exact_p.mean() - (1 - c)))


class ElasticBodyWithContactLine(NamedTuple):
    """An elastic body with some fixed displacements and a contact line.

    Attributes
    ----------
    basis, K : skfem basis, sparse matrix
        Finite-element basis and stiffness matrix of the body.
    line, coupling : ContactLine, ContactCouplingMatrices
        Contact line of the body, and its coupling matrices between displacements and gaps.
    free : array of int
        Indices of the displacements that are not fixed.
    """

    basis: Any
    K: Any
    line: ContactLine
    coupling: ContactCouplingMatrices
    free: Ints

    @classmethod
    def elastic_body_of_mesh(
        cls,
        mesh: Any,
        material: Material,
        held: Ints,
        directions: NormalsAndTangentsFunction,
        middle: float,
    ) -> "ElasticBodyWithContactLine":
        """The elastic body of a mesh that has the boundary "contact".

        Parameters
        ----------
        mesh : skfem mesh
            Mesh of the body.
        material : Material
            Material of the body.
        held : array of int
            Indices of the displacements that are fixed.
        directions : function
            Function that returns normal and tangent at points of the contact.
        middle : float
            Angle of the middle of the contact [rad].
        """
        basis = nodal_basis_of_mesh(mesh)
        K = sparse_stiffness_of_body(
            basis, {"body": ElasticLayer.make_layer_in_plane_stress(material, 1.0)}
        ).tocsc()
        line = make_contact_line_of_lining(basis, mesh.boundaries["contact"], middle)
        free = np.setdiff1d(np.arange(2 * basis.N), held)
        return cls(basis, K, line, coupling_matrices_of_contact_line(line, 1.0, directions), free)

    @property
    def indices_of_contact_node_displacements(self) -> Ints:
        """Indices (2 n,) of the displacements of the n contact nodes: x, y of each node in turn."""
        return np.column_stack([2 * self.line.nodes, 2 * self.line.nodes + 1]).ravel()

    def nodal_forces_of_unit_tractions(self, matrix: Floats) -> Floats:
        """Nodal forces (2 nodes, n) of a unit pressure or a unit traction at each contact node.

        `matrix` (n, 2 n) is the coupling matrix N for pressures, or the coupling matrix T for
        tractions.
        """
        f = np.zeros((self.basis.N, 2, len(matrix)))
        f[self.line.nodes] = matrix.T.reshape(-1, 2, len(matrix))
        return f.reshape(2 * self.basis.N, -1)

    def displacements_under_forces(self, forces: Floats) -> Floats:
        """Nodal displacements (2 nodes, m) of the body under m sets of nodal forces."""
        u = np.zeros_like(forces)
        u[self.free] = splu(self.K[self.free][:, self.free].tocsc()).solve(forces[self.free])
        return u


def _quadratic_mesh_of_mapped_grid(grid: Any, to: Any, held: Any) -> Any:
    """The quadratic mesh of a mapped grid, whose edge with the first coordinate 0 is the contact.

    Parameters
    ----------
    grid : skfem mesh
        The grid of rectangles, in two coordinates.
    to : function
        Function that maps the two coordinates of the grid to positions (2, nodes).
    held : function
        Function of the two coordinates of an edge's middle that says whether the edge is fixed.
    """
    middle = grid.p[:, grid.facets].mean(axis=1)
    mesh = skfem.MeshQuad2.from_mesh(grid)
    return skfem.MeshQuad2(
        to(*mesh.doflocs),
        mesh.t,
        _subdomains={"body": np.arange(mesh.nelements)},
        _boundaries={
            "contact": np.flatnonzero(middle[0] < 1e-12),
            "support": np.flatnonzero(held(*middle)),
        },
    )


def _tension_ratio_of_belt_on_drum(mu: float, wrap: float) -> float:
    """Tension at the fixed end of a belt around a rotating drum, over tension at the pulled end.

    `mu` is the coefficient of friction, `wrap` the angle of wrap [rad].
    """
    # A belt of thickness 0.002 m on a drum of radius 1 m. One end of the belt is fixed at the angle
    # `wrap`.
    t = 0.002
    grid = skfem.MeshQuad.init_tensor(np.array([0.0, t]), np.linspace(0, wrap, 161))
    mesh = _quadratic_mesh_of_mapped_grid(
        grid,
        lambda d, phi: np.array([(1 + d) * np.cos(phi), (1 + d) * np.sin(phi)]),
        lambda d, phi: phi > wrap - 1e-9,
    )
    at = nodal_basis_of_mesh(mesh).get_dofs(mesh.boundaries["support"]).flatten()
    belt = ElasticBodyWithContactLine.elastic_body_of_mesh(
        mesh,
        STEEL_OF_KNOWN_ANSWER_CASES,
        np.concatenate([2 * at, 2 * at + 1]),
        function_that_returns_drum_normals_and_tangents(-1),
        wrap / 2,
    )
    N, T = belt.coupling.N, belt.coupling.T
    x, y = belt.basis.doflocs
    pulled = np.flatnonzero((np.abs(y) < 1e-12) & (x > 0))
    f = np.zeros((belt.basis.N, 2))
    weights = np.where(np.abs(x[pulled] - 1 - t / 2) < 1e-9, 4.0, 1.0) / 6
    # The other end is pulled by 1 N, uniformly over the thickness.
    f[pulled, 1] = -weights
    by_pressure = belt.nodal_forces_of_unit_tractions(N) + mu * belt.nodal_forces_of_unit_tractions(
        T
    )
    u = belt.displacements_under_forces(np.column_stack([f.ravel(), by_pressure]))
    on, n = belt.indices_of_contact_node_displacements, len(N)
    without_motions = np.zeros((n, 0)), np.zeros((0, n)), np.zeros(0)
    problem = equations.ContactProblem(N @ u[on, 1:], -N @ u[on, 0], *without_motions)
    p = active_set.solve_contact_problem(problem).p
    whole = u @ np.concatenate([[1.0], -p])
    reaction = (belt.K @ whole).reshape(-1, 2)[at].sum(axis=0)
    return float(np.array([-math.sin(wrap), math.cos(wrap)]) @ reaction)


def _largest_pressure_in_patch_test(turned: float) -> float:
    """Largest pressure [Pa] on a strip into which an inclined plane is pressed by 0.05 m.

    The strip is inclined like the plane. The strip is 1 m high and has nu = 0, so that the exact
    pressure is uniform. `turned` is the inclination [rad].
    """
    c, s = math.cos(turned), math.sin(turned)
    grid = skfem.MeshQuad.init_tensor(np.array([0, 0.4, 0.5, 1.0]), np.array([0, 0.3, 1.1, 2.0]))
    mesh = _quadratic_mesh_of_mapped_grid(
        grid,
        lambda d, x: np.array([3 + c * x - s * d, 1 + s * x + c * d]),
        lambda d, x: d > 1 - 1e-9,
    )
    top = nodal_basis_of_mesh(mesh).get_dofs(mesh.boundaries["support"]).flatten()
    directions = _make_function_of_constant_normal_and_tangent(np.array([s, -c]), np.array([c, s]))
    held = np.concatenate([2 * top, 2 * top + 1])
    strip = ElasticBodyWithContactLine.elastic_body_of_mesh(
        mesh, Material(E=2e6, nu=0.0), held, directions, 0.3
    )
    N, M = strip.coupling.N, strip.coupling.M
    n = len(M)
    # Opening of the gap under unit nodal pressures, integrated with the shape functions of the
    # contact nodes. Before the deformation the plane lies 0.05 m inside the strip.
    closure = (
        N
        @ strip.displacements_under_forces(strip.nodal_forces_of_unit_tractions(N))[
            strip.indices_of_contact_node_displacements
        ]
    )
    none = np.zeros((n, 0))
    problem = equations.ContactProblem(closure, M @ np.full(n, -0.05), none, none.T, np.zeros(0))
    return float(active_set.solve_contact_problem(problem).p.max())


EDGE_LENGTH_OF_SQUARE_PLATE = 40.0
"""Length of the edges of the square plate of Raous, Chabrand & Lebon (1988). The results do not
depend on the unit of length.
"""


class PressedPlateResults(NamedTuple):
    """Results for an elastic plate that is pressed on a rigid plane and pushed from its side.

    Attributes
    ----------
    moment : float
        Moment of the contact pressure about a corner of the plate, divided by minus the moment of
        all other forces. The result is 1 if the moments are in balance.
    states : frozenset of int
        States that occur among the contact nodes: open, stick or slip.
    """

    moment: float
    states: frozenset[int]


@cache
def solve_pressed_and_pushed_plate() -> PressedPlateResults:
    """Results for an elastic plate that is pressed on a rigid plane at mu = 1 and pushed sideways.

    The plate comes from Raous, Chabrand & Lebon (1988): 40 by 40, nu = 0.2, 5 MPa on its upper edge
    and 10 MPa on its side, with a plane of symmetry at x = 0. Moments are taken about the corner in
    the origin. Friction on the rigid plane has no moment about this corner, and neither has the
    vertical force that fixes the plate there.
    """
    body = _plate_with_plane_of_symmetry()
    plate, f = body.body, _nodal_forces_on_plate_edge_and_side(body.body.basis)
    N, T = plate.coupling.N, plate.coupling.T
    u = plate.displacements_under_forces(
        np.column_stack(
            [
                f.ravel(),
                plate.nodal_forces_of_unit_tractions(N),
                plate.nodal_forces_of_unit_tractions(T),
            ]
        )
    )
    problem = _stick_slip_problem_of_pushed_plate(plate, f, u)
    n = len(N)
    found = stick_slip.solve_stick_slip_load_increment(
        problem, 1.0, TractionsAndSlipsOfLastIncrement(np.zeros(n), np.zeros(n)), np.full(n, STICK)
    )
    whole = u @ np.concatenate([[1.0], -found.p, found.t])
    total = f.copy()
    # At the nodes on the plane of symmetry the reactions of the fixed displacements act as well.
    total[body.left] = (plate.K @ whole).reshape(-1, 2)[body.left]
    x, y = plate.basis.doflocs
    others = float((x * total[:, 1] - y * total[:, 0]).sum())
    pressures = (-N.T @ found.p).reshape(-1, 2)
    return PressedPlateResults(
        float((plate.line.xy[0] * pressures[:, 1]).sum() / -others),
        frozenset(int(s) for s in found.state),
    )


class _PlateWithSymmetryPlane(NamedTuple):
    """A plate with its plane of symmetry.

    Attributes
    ----------
    body : ElasticBodyWithContactLine
        The plate, whose lower edge is in contact.
    left : array of int
        Numbers of the plate's nodes on the plane of symmetry.
    """

    body: ElasticBodyWithContactLine
    left: Ints


def _plate_with_plane_of_symmetry() -> _PlateWithSymmetryPlane:
    """The plate of Raous, Chabrand & Lebon, fixed along x at x = 0, and along y at the origin."""
    L = EDGE_LENGTH_OF_SQUARE_PLATE
    grid = skfem.MeshQuad.init_tensor(np.linspace(0, L, 13), np.linspace(0, L, 25))
    mesh = _quadratic_mesh_of_mapped_grid(
        grid, lambda depth, x: np.array([x, depth]), lambda depth, x: x < 1e-9
    )
    basis = nodal_basis_of_mesh(mesh)
    left = basis.get_dofs(mesh.boundaries["support"]).flatten()
    corner = left[np.argmax(basis.doflocs[1][left])]
    plate = ElasticBodyWithContactLine.elastic_body_of_mesh(
        mesh,
        Material(E=130e9, nu=0.2),
        np.concatenate([2 * left, [2 * corner + 1]]),
        _make_function_of_constant_normal_and_tangent(np.array([0.0, -1.0]), np.array([1.0, 0.0])),
        math.pi / 4,
    )
    return _PlateWithSymmetryPlane(plate, left)


def _nodal_forces_on_plate_edge_and_side(basis: Any) -> Floats:
    """The nodal forces (nodes, 2) of 5 MPa on the plate's upper edge and 10 MPa on its side."""
    x, y = basis.doflocs
    f = np.zeros((basis.N, 2))
    f[:, 1] -= 5e6 * _nodal_forces_of_unit_traction(
        x, np.flatnonzero(y > EDGE_LENGTH_OF_SQUARE_PLATE - 1e-9)
    )
    f[:, 0] -= 10e6 * _nodal_forces_of_unit_traction(
        y, np.flatnonzero(x > EDGE_LENGTH_OF_SQUARE_PLATE - 1e-9)
    )
    return f


def _stick_slip_problem_of_pushed_plate(
    plate: ElasticBodyWithContactLine, f: Floats, u: Floats
) -> StickSlipProblem:
    """The stick-slip problem of a plate that may also move up and down as a rigid body.

    Parameters
    ----------
    plate : ElasticBodyWithContactLine
        The plate with n contact nodes.
    f : array (nodes, 2)
        Nodal forces of the loads.
    u : array (2 nodes, 1 + 2 n)
        Displacements under the loads (first column), under a unit pressure at each contact node,
        and under a unit traction at each contact node.
    """
    N, T = plate.coupling.N, plate.coupling.T
    on, n = plate.indices_of_contact_node_displacements, len(N)
    by_f, by_N, by_T = u[on, 0], u[on, 1 : 1 + n], u[on, 1 + n :]
    up = np.tile([0.0, 1.0], n)
    B_w, B_s = -(N @ up)[:, None], -(T @ up)[:, None]
    return StickSlipProblem(
        A_wp=N @ by_N,
        A_wt=-N @ by_T,
        A_sp=T @ by_N,
        A_st=-T @ by_T,
        B_w=B_w,
        B_s=B_s,
        C_p=B_w.T,
        C_t=-B_s.T,
        q_w=-N @ by_f,
        q_s=-T @ by_f,
        h=np.array([-f[:, 1].sum()]),
        Q=np.zeros((n, n)),
    )


def _nodal_forces_of_unit_traction(along: Floats, nodes: Ints) -> Floats:
    """Nodal forces (all nodes,) of a unit traction on a straight edge of quadratic elements.

    `along` (all nodes,) is the coordinate along the edge, `nodes` are the nodes on the edge.
    """
    f = np.zeros(len(along))
    # Simpson's weights on each quadratic edge: two ends and the middle between them.
    order = nodes[np.argsort(along[nodes])]
    for first, middle, last in zip(order[0:-2:2], order[1::2], order[2::2], strict=True):
        length = along[last] - along[first]
        f[[first, middle, last]] += length / 6 * np.array([1.0, 4.0, 1.0])
    return f


WINKLER_LINING_STIFFNESS = 4e10  # Pa/m
"""Stiffness K [Pa/m], pressure per compression, of a lining of springs on a rigid shoe."""
SPRING_RADIUS, SPRING_WIDTH, SPRING_PIN = 0.15, 0.04, 0.125  # m
"""Radius of the drum, width of the lining, and distance of the hinge from the drum's centre [m]."""
WINKLER_SHOE_ACTUATION_MOMENT = 250.0  # N m
"""Moment [N m] of the actuation about the hinge of the shoe with a lining of springs."""
WINKLER_LINING_FRICTION = 0.25
"""Coefficient of friction of the lining of springs."""
WINKLER_LINING_END_ANGLES = (0.3, 2.2)  # rad
"""Angles [rad] of the ends of the lining of springs, counted from the line from the drum's centre
to the hinge.
"""
WEAR_LAW_OF_WINKLER_LINING = WearLaw(1e-13)
"""Wear law of the lining of springs, with the wear coefficient k."""
SLIDING_DISTANCE_OF_WINKLER_DECAY = 1 / (
    WEAR_LAW_OF_WINKLER_LINING.coefficient * WINKLER_LINING_STIFFNESS
)
"""Sliding distance 1/(k K) [m] over which wear reduces the deviation from the sine law to 1/e."""


def _wear_problem_and_node_angles_of_winkler_shoe(mu: float) -> tuple[WearContactProblem, Floats]:
    """The wear problem of a hinged rigid shoe with a lining of springs, and its node angles.

    The springs are a Winkler foundation. At first the lining is uneven by 2 micrometres. The angles
    (n,) [rad] of the lining's nodes count from the hinge.
    """
    phi = np.linspace(*WINKLER_LINING_END_ANGLES, 49)
    xy = SPRING_RADIUS * np.array([np.cos(phi), np.sin(phi)])
    coupling = coupling_matrices_of_contact_line(
        ContactLine(np.arange(49), xy, phi, np.arange(0, 48, 2) + np.arange(3)[:, None]),
        SPRING_WIDTH,
        function_that_returns_drum_normals_and_tangents(1),
    )
    # Displacements [m/rad] of the nodes as the shoe turns about its pin.
    turned = np.column_stack([-xy[1], xy[0] - SPRING_PIN]).ravel()
    closing = coupling.N @ turned
    problem = equations.ContactProblem(
        coupling.M / WINKLER_LINING_STIFFNESS,
        coupling.M @ (2e-6 * np.cos(3 * phi)),
        -closing[:, None],
        (mu * (coupling.T @ turned) - closing)[None],
        np.array([WINKLER_SHOE_ACTUATION_MOMENT]),
    )
    interface = WearContactProblem(
        problem,
        np.zeros(49),
        coupling.M,
        np.ones(49),
        coupling.areas_of_contact_nodes,
        mu * coupling.lever,
    )
    return interface, phi


def _locking_friction_of_winkler_shoe() -> float:
    """Coefficient of friction at which the shoe with a lining of springs locks itself."""
    # The equations are linear in the friction coefficient. The equations at two coefficients
    # therefore give the equations at any coefficient.
    still, unit = (
        _wear_problem_and_node_angles_of_winkler_shoe(0.0)[0].problem,
        _wear_problem_and_node_angles_of_winkler_shoe(-1.0)[0].problem,
    )
    return self_locking.find_largest_friction_with_equilibrium(
        self_locking.FrictionDependentProblem.linear_function_of_friction_from_two_problems(
            still, unit
        )
    ).friction


@cache
def _wear_states_and_sine_pressure_of_winkler_shoe() -> tuple[list[WearState], Floats]:
    """States of the shoe with a lining of springs as it wears, and its pressure by the sine law.

    The sliding distance is 2/(k K). The pressure (n,) by the sine law is for an actuating moment of
    1 N m.
    """
    interface, phi = _wear_problem_and_node_angles_of_winkler_shoe(WINKLER_LINING_FRICTION)
    states = wear_linings_over_sliding_distance(
        [interface],
        WEAR_LAW_OF_WINKLER_LINING,
        distance=2 * SLIDING_DISTANCE_OF_WINKLER_DECAY,
        tolerance=1e-4,
    )
    # The sine law gives the shape of the pressure; the balance of moments gives its size.
    return states, np.sin(phi) / float(interface.problem.C[0] @ np.sin(phi))


def _remaining_deviation_from_sine_law() -> float:
    """Deviation of the pressure from the sine law after sliding by 2/(k K), relative to the start.

    The deviation at the start is the deviation of the new lining.
    """
    states, law = _wear_states_and_sine_pressure_of_winkler_shoe()
    first = states[0].pressure - WINKLER_SHOE_ACTUATION_MOMENT * law
    last = states[-1].pressure - WINKLER_SHOE_ACTUATION_MOMENT * law
    return float(first @ last / (first @ first))


def _worn_volume_over_archard_volume() -> float:
    """Worn volume over k Int N ds, with the wear coefficient k, normal force N and distance s."""
    states, _ = _wear_states_and_sine_pressure_of_winkler_shoe()
    area = _wear_problem_and_node_angles_of_winkler_shoe(WINKLER_LINING_FRICTION)[0].area
    worn_volume = area @ (states[-1].depth - states[0].depth)
    return float(worn_volume / (WEAR_LAW_OF_WINKLER_LINING.coefficient * states[-1].pressed))


class BrakeWithThinLiningsAndItsResults(NamedTuple):
    """A brake with thin linings on rigid shoes, and its results.

    Attributes
    ----------
    law_torque : float
        Torque by the sine law [N m].
    response : Response
        Response by finite elements.
    brake : Brake
        The brake.
    """

    law_torque: float
    response: Response
    brake: Any


@cache
def _solve_brake_with_thin_linings() -> BrakeWithThinLiningsAndItsResults:
    """A double-shoe brake with 3 mm linings on rigid shoes, by sine law and by finite elements."""
    rigid = vary(DoubleShoe().brake(2000.0), {"shoe.lining.thickness": 3e-3})
    return BrakeWithThinLiningsAndItsResults(
        solve_brake_by_sine_law(rigid).torque, solve(rigid, elements=24), rigid
    )


def _external_moment_over_torque() -> float:
    """Moment of actuations and hinge reactions about the drum's centre, divided by the torque."""
    response, brake = (
        _solve_brake_with_thin_linings().response,
        _solve_brake_with_thin_linings().brake,
    )
    # Sum of the moments of actuation force and hinge reaction about the drum's centre, for each
    # shoe.
    moments = []
    for spec, shoe in zip(brake.shoes, response.shoes, strict=True):
        pin, force = spec.pin.xy, shoe.hinge_reaction
        act, at = spec.actuation.force_vector, spec.actuation.point.xy
        moments.append(at[0] * act[1] - at[1] * act[0] + pin[0] * force[1] - pin[1] * force[0])
    return abs(math.fsum(moments)) / response.torque


KNOWN_ANSWER_CASES_ON_FRICTION_AND_WEAR = (
    *(
        KnownAnswerCase(
            family="one node on springs",
            shows="friction states",
            source="spring force k s up to mu p",
            quantity=f"traction at s = {shift} m",
            expected=min(100 * shift, 5.0),
            tolerance=1e-12,
            tier=TOLERANCE_REASON_ROUND_OFF,
            found=partial(_friction_force_on_node, shift),
        )
        for shift in (0.02, 0.05, 0.2)
    ),
    KnownAnswerCase(
        family="closed loop of slip",
        shows="dissipation",
        source="area of the loop, 4 mu p (s - mu p/k)",
        quantity="energy [J]",
        expected=4 * 0.5 * 10 * (0.2 - 0.5 * 10 / 100),
        tolerance=1e-9,
        tier=TOLERANCE_REASON_ROUND_OFF,
        found=_energy_dissipated_in_slip_loop,
    ),
    *(
        KnownAnswerCase(
            family="flat patch test",
            shows="even pressure",
            source="El-Abbasi & Bathe 2001: E times the strain -.05",
            quantity=f"largest p [Pa], inclined by {turned} rad",
            expected=1e5,
            tolerance=1e-10,
            tier=TOLERANCE_REASON_ROUND_OFF,
            found=partial(_largest_pressure_in_patch_test, turned),
        )
        for turned in (0.0, 0.4)
    ),
    KnownAnswerCase(
        family="block on a wedge",
        shows="direction of friction",
        source="NAFEMS CGS-4: (tan a + mu)/(1 - mu tan a)",
        quantity="push over weight",
        expected=0.412371,
        tolerance=1e-6,
        tier=TOLERANCE_REASON_PRINTED_DIGITS,
        found=_push_over_weight_of_block_on_wedge,
    ),
    KnownAnswerCase(
        family="tangentially loaded cylinders",
        shows="partial slip",
        source="Cattaneo 1938, Mindlin 1949: c/a = sqrt(1 - Q/(mu P))",
        quantity="c/a at Q = mu P/2",
        expected=math.sqrt(0.5),
        tolerance=1e-2,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=partial(_sticking_over_contact_half_width, 0.5),
    ),
    KnownAnswerCase(
        family="belt on a drum",
        shows="drag of a flexible body",
        source="capstan: e^(mu theta)",
        quantity="ratio of tensions, mu = .3, 120 deg",
        expected=closed_forms.capstan_tension_ratio(0.3, 2 * math.pi / 3),
        tolerance=1e-2,
        tier=TOLERANCE_REASON_MODEL_LIMIT,
        found=partial(_tension_ratio_of_belt_on_drum, 0.3, 2 * math.pi / 3),
    ),
    KnownAnswerCase(
        family="plate on a rigid plane",
        shows="stick, slip and open in one contact",
        source="balance of moments about a corner",
        quantity="moment of p over all others",
        expected=1.0,
        tolerance=1e-9,
        tier=TOLERANCE_REASON_ROUND_OFF,
        found=lambda: solve_pressed_and_pushed_plate().moment,
    ),
    KnownAnswerCase(
        family="shoe on springs, self-locking",
        shows="limit of friction",
        source="moments of p ~ sin about the hinge",
        quantity="mu_lock",
        expected=closed_forms.locking_friction_of_hinged_shoe_with_sine_pressure(
            SPRING_RADIUS, SPRING_PIN, *WINKLER_LINING_END_ANGLES
        ),
        tolerance=1e-5,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=_locking_friction_of_winkler_shoe,
    ),
    KnownAnswerCase(
        family="shoe on springs, running in",
        shows="Archard wear in time",
        source="exp(-k K s), all in contact",
        quantity="deviation left at k K s = 2",
        expected=math.exp(-2),
        tolerance=1e-3,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=_remaining_deviation_from_sine_law,
    ),
    KnownAnswerCase(
        family="worn volume",
        shows="Archard wear",
        source="Archard 1953: V = k N s",
        quantity="V over k Int N ds",
        expected=1.0,
        tolerance=1e-9,
        tier=TOLERANCE_REASON_ROUND_OFF,
        found=_worn_volume_over_archard_volume,
    ),
    KnownAnswerCase(
        family="rigid shoe with a thin lining",
        shows="whole brake by elements",
        source="sine law in the limit",
        quantity="torque over the law's",
        expected=1.0,
        tolerance=2e-2,
        tier=TOLERANCE_REASON_MODEL_LIMIT,
        found=lambda: (
            _solve_brake_with_thin_linings().response.torque
            / _solve_brake_with_thin_linings().law_torque
        ),
    ),
    KnownAnswerCase(
        family="balance of a whole brake",
        shows="hinge reactions",
        source="moments about the drum's centre",
        quantity="moment over torque",
        expected=1.0,
        tolerance=1e-8,
        tier=TOLERANCE_REASON_ROUND_OFF,
        found=_external_moment_over_torque,
    ),
)
"""The cases of the ladder on friction and wear."""
