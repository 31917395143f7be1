"""The ladder's friction and wear: stick and slip, belts, plates, self-locking, running in.

The last cases judge a whole brake.
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
from drumlin.contact.stick_slip import OPEN, STICK, FrictionalProblem, SlipHistory
from drumlin.fem.solve import solve
from drumlin.fem.substructure.body import scalar_basis, stiffness
from drumlin.fem.substructure.interface import (
    ContactLine,
    Coupling,
    Directions,
    couple_with_counterface,
    drum_directions,
    make_contact_line,
)
from drumlin.laws import sine
from drumlin.laws.simscape import DoubleShoe
from drumlin.lining_wear.archard import WearInterface, WearLaw, WearState, wear_linings
from drumlin.response.response import Response
from drumlin_studies import closed_forms
from drumlin_studies.ladder_case import DISCRETE, EXACT, MODEL, PRINTED, KnownAnswer
from drumlin_studies.ladder_contact import GAP_RADIUS, HALF_WIDTH, half_plane_body
from drumlin_studies.two_bodies import LADDER_STEEL, BodyPair, coarse_contact_set


def _node_on_springs(push: float, shift: float, k: float = 100.0) -> FrictionalProblem:
    """One node on springs, pushed against a drum that has moved.

    Parameters
    ----------
    push : float
        Normal force on the node [N].
    shift : float
        Displacement of the drum [m].
    k : float
        Stiffness of both springs [N/m].
    """
    one, none = np.ones((1, 1)), np.zeros((1, 1))
    across, along = np.zeros((1, 0)), np.zeros((0, 1))
    return FrictionalProblem(
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


def _node_traction(shift: float) -> float:
    """Traction of one node under 10 N at mu = 0.5, after a displacement of the drum [m]."""
    untouched = SlipHistory(np.zeros(1), np.zeros(1))
    answer = stick_slip.solve_load_increment(
        _node_on_springs(10.0, shift), 0.5, untouched, np.array([STICK])
    )
    return float(answer.t[0])


def _loop_dissipation() -> float:
    """Energy [J] that one node dissipates as the drum moves in a closed loop between +-0.2 m."""
    # From the start to one end, to the other end, and back to the first.
    path = np.concatenate(
        [np.linspace(0, 0.2, 21), np.linspace(0.2, -0.2, 41), np.linspace(-0.2, 0.2, 41)]
    )
    history, state, dissipated = SlipHistory(np.zeros(1), np.zeros(1)), np.array([STICK]), 0.0
    for i, shift in enumerate(path):
        answer = stick_slip.solve_load_increment(_node_on_springs(10.0, shift), 0.5, history, state)
        # The first 21 positions lead from zero to the loop.
        if i > 20:
            dissipated += float(answer.t[0] * (answer.s[0] - history.s[0]))
        history, state = answer.history, answer.state
    return dissipated


def _constant_directions(normal: Floats, tangent: Floats) -> Directions:
    """Directions of a plane contact: the same normal and tangent (2,) at all points."""

    def directions_at(points: Floats) -> tuple[Floats, Floats]:
        """The same normal and tangent at each of the points."""
        shape = (2, *([1] * (points.ndim - 1)))
        ones = np.ones_like(points)
        return normal.reshape(shape) * ones, tangent.reshape(shape) * ones

    return directions_at


def _wedge_push_ratio() -> float:
    """Push over weight of a block that slides up a wedge of slope 0.1 at mu = 0.3."""
    slope, x = math.atan(0.1), np.linspace(0, 1, 5)
    up = np.array([math.cos(slope), math.sin(slope)])
    # A straight contact line of two quadratic edges.
    line = ContactLine(np.arange(5), up[:, None] * x, x, np.array([[0, 2], [1, 3], [2, 4]]))
    coupling = couple_with_counterface(
        line, 1.0, _constant_directions(np.array([up[1], -up[0]]), -up)
    )
    p = np.full(5, 7.0)
    on_block = (-coupling.N.T @ p + 0.3 * coupling.T.T @ p).reshape(-1, 2).sum(axis=0)
    return float(-on_block[0] / on_block[1])


@cache
def _sticking_half_width_ratio(share: float) -> float:
    """Half-width c of the sticking zone over half-width a of contact.

    The tangential load is `share` times mu P. The ratio follows from the tractions in the middle,
    (1 - t/(mu p))^2 = c^2/a^2, because the ends of a zone depend on where nodes lie.
    """
    mu, load = 0.3, HALF_WIDTH**2 * math.pi * LADDER_STEEL.E / 2 / (4 * GAP_RADIUS)
    pair = BodyPair.of(half_plane_body(-1, 14), half_plane_body(1, 12), motions="xy")
    s = pair.angle
    gap, n = s**2 / (2 * GAP_RADIUS), len(s)
    along = BodyPair(pair.inner, pair.coupling, pair.pressed, pair.dragged, pair.motions[:, :1])
    pressing = along.normal(gap, [load])
    state = np.where(
        active_set.solve_contact_problem(pressing, coarse_contact_set(pressing)).active, STICK, OPEN
    )
    # The normal load comes first, then the tangential load in two steps.
    untouched = SlipHistory(np.zeros(n), np.zeros(n))
    found = stick_slip.solve_load_increment(pair.frictional(gap, [load, 0.0]), mu, untouched, state)
    for part in (0.5, 1.0):
        loads = [load, part * share * mu * load]
        found = stick_slip.solve_load_increment(
            pair.frictional(gap, loads), mu, found.history, found.state
        )
    middle = np.abs(s) < 0.2 * HALF_WIDTH
    ratio = np.abs(found.t[middle]).mean() / (mu * found.p[middle].mean())
    # In the middle t/(mu p) = 1 - c/a, but for a term of second order in the width of the window.
    # The same window of the closed form corrects this term.
    exact_p = np.sqrt(1 - (s[middle] / HALF_WIDTH) ** 2)
    c = math.sqrt(1 - share)
    exact_t = exact_p - c * np.sqrt(1 - (s[middle] / (c * HALF_WIDTH)) ** 2)
    return float(1 - ratio + (exact_t.mean() / exact_p.mean() - (1 - c)))


class FlexibleBody(NamedTuple):
    """An elastic body with some unknowns held.

    Attributes
    ----------
    basis, K : skfem basis, sparse matrix
        Finite elements and stiffness of the body.
    line, coupling : ContactLine, Coupling
        Contact line, and how displacements of its nodes open the gap.
    free : array of int
        Unknowns that are not held.
    """

    basis: Any
    K: Any
    line: ContactLine
    coupling: Coupling
    free: Ints

    @classmethod
    def of(
        cls, mesh: Any, material: Material, held: Ints, directions: Directions, middle: float
    ) -> "FlexibleBody":
        """The body of a mesh with the boundary "contact".

        Parameters
        ----------
        mesh : skfem mesh
            Its mesh.
        material : Material
            Its material.
        held : array of int
            Unknowns that are held.
        directions : function
            Normal and tangent at points of the contact.
        middle : float
            Angle of the middle of the contact [rad].
        """
        basis = scalar_basis(mesh)
        K = stiffness(basis, {"body": ElasticLayer.of(material, 1.0)}).tocsc()
        line = make_contact_line(basis, mesh.boundaries["contact"], middle)
        free = np.setdiff1d(np.arange(2 * basis.N), held)
        return cls(basis, K, line, couple_with_counterface(line, 1.0, directions), free)

    @property
    def contact_unknowns(self) -> Ints:
        """Numbers (2 n,) of the displacements of the contact nodes, x and y of each in turn."""
        return np.column_stack([2 * self.line.nodes, 2 * self.line.nodes + 1]).ravel()

    def spread(self, matrix: Floats) -> Floats:
        """Nodal forces (2 nodes, n) of unit pressures or tractions.

        matrix : coupling matrix (n, 2 n), as N or T of `Coupling`.
        """
        f = np.zeros((self.basis.N, 2, len(matrix)))
        f[self.line.nodes] = matrix.T.reshape(-1, 2, len(matrix))
        return f.reshape(2 * self.basis.N, -1)

    def moved(self, forces: Floats) -> Floats:
        """Displacements (2 nodes, m) under forces (2 nodes, m)."""
        u = np.zeros_like(forces)
        u[self.free] = splu(self.K[self.free][:, self.free].tocsc()).solve(forces[self.free])
        return u


def _quadratic_grid_mesh(grid: Any, to: Any, held: Any) -> Any:
    """Quadratic mesh of a tensor grid, in contact where the first coordinate is zero.

    Parameters
    ----------
    grid : skfem mesh
        The tensor grid.
    to : function
        Places (2, nodes) of the nodes, by both coordinates of the grid.
    held : function
        Whether an edge is held, by both coordinates of its middle.
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


def _belt_tension_ratio(mu: float, wrap: float) -> float:
    """Ratio of the tensions at the held and the pulled end of a belt around a sliding drum."""
    t = 0.002
    grid = skfem.MeshQuad.init_tensor(np.array([0.0, t]), np.linspace(0, wrap, 161))
    mesh = _quadratic_grid_mesh(
        grid,
        lambda d, phi: np.array([(1 + d) * np.cos(phi), (1 + d) * np.sin(phi)]),
        lambda d, phi: phi > wrap - 1e-9,
    )
    at = scalar_basis(mesh).get_dofs(mesh.boundaries["support"]).flatten()
    belt = FlexibleBody.of(
        mesh, LADDER_STEEL, np.concatenate([2 * at, 2 * at + 1]), drum_directions(-1), wrap / 2
    )
    N, T = belt.coupling.N, belt.coupling.T
    x, y = belt.basis.doflocs
    pulled = np.flatnonzero((np.abs(y) < 1e-12) & (x > 0))
    f = np.zeros((belt.basis.N, 2))
    weights = np.where(np.abs(x[pulled] - 1 - t / 2) < 1e-9, 4.0, 1.0) / 6
    # A tension of 1 N, uniform through the thickness.
    f[pulled, 1] = -weights
    u = belt.moved(np.column_stack([f.ravel(), belt.spread(N) + mu * belt.spread(T)]))
    on, n = belt.contact_unknowns, len(N)
    without_motions = np.zeros((n, 0)), np.zeros((0, n)), np.zeros(0)
    problem = equations.ContactProblem(N @ u[on, 1:], -N @ u[on, 0], *without_motions)
    p = active_set.solve_contact_problem(problem).p
    whole = u @ np.concatenate([[1.0], -p])
    reaction = (belt.K @ whole).reshape(-1, 2)[at].sum(axis=0)
    return float(np.array([-math.sin(wrap), math.cos(wrap)]) @ reaction)


def _patch_largest_pressure(turned: float) -> float:
    """Largest pressure [Pa] of a strip that is pressed by 0.05 m on an inclined plane.

    The strip is 1 m high and has nu = 0, so that the pressure is uniform. turned : inclination of
    the plane [rad].
    """
    c, s = math.cos(turned), math.sin(turned)
    grid = skfem.MeshQuad.init_tensor(np.array([0, 0.4, 0.5, 1.0]), np.array([0, 0.3, 1.1, 2.0]))
    mesh = _quadratic_grid_mesh(
        grid,
        lambda d, x: np.array([3 + c * x - s * d, 1 + s * x + c * d]),
        lambda d, x: d > 1 - 1e-9,
    )
    top = scalar_basis(mesh).get_dofs(mesh.boundaries["support"]).flatten()
    directions = _constant_directions(np.array([s, -c]), np.array([c, s]))
    held = np.concatenate([2 * top, 2 * top + 1])
    strip = FlexibleBody.of(mesh, Material(E=2e6, nu=0.0), held, directions, 0.3)
    N, M = strip.coupling.N, strip.coupling.M
    n = len(M)
    # Closure of the gap by unit pressures, on a plane that lies 0.05 m inside the strip.
    closure = N @ strip.moved(strip.spread(N))[strip.contact_unknowns]
    none = np.zeros((n, 0))
    problem = equations.ContactProblem(closure, M @ np.full(n, -0.05), none, none.T, np.zeros(0))
    return float(active_set.solve_contact_problem(problem).p.max())


class Plate(NamedTuple):
    """A plate on a rigid plane.

    Attributes
    ----------
    moment : float
        Moment of the plane's pressures about the plate's corner, over that of all other forces.
    states : frozenset of int
        The states that occur among the contact nodes: open, stick or slip.
    """

    moment: float
    states: frozenset[int]


@cache
def press_and_push_plate() -> Plate:
    """An elastic plate on a rigid plane at mu = 1, pressed from above and pushed from its side.

    After Raous, Chabrand & Lebon (1988): 40 by 40, nu = 0.2, 5 MPa from above and 10 MPa from the
    side, with a plane of symmetry at x = 0. About the corner in the origin, tractions along the
    plane have no moment, nor has the vertical force that holds the plate there.
    """
    L, mu = 40.0, 1.0
    grid = skfem.MeshQuad.init_tensor(np.linspace(0, L, 13), np.linspace(0, L, 25))
    mesh = _quadratic_grid_mesh(
        grid, lambda depth, x: np.array([x, depth]), lambda depth, x: x < 1e-9
    )
    basis = scalar_basis(mesh)
    left = basis.get_dofs(mesh.boundaries["support"]).flatten()
    x, y = basis.doflocs
    corner = left[np.argmax(y[left])]
    held = np.concatenate([2 * left, [2 * corner + 1]])
    plate = FlexibleBody.of(
        mesh,
        Material(E=130e9, nu=0.2),
        held,
        _constant_directions(np.array([0.0, -1.0]), np.array([1.0, 0.0])),
        math.pi / 4,
    )
    # The loads act on the upper edge and on the side.
    f = np.zeros((basis.N, 2))
    f[:, 1] -= 5e6 * _edge_nodal_forces(x, np.flatnonzero(y > L - 1e-9))
    f[:, 0] -= 10e6 * _edge_nodal_forces(y, np.flatnonzero(x > L - 1e-9))
    N, T = plate.coupling.N, plate.coupling.T
    on, n = plate.contact_unknowns, len(N)
    u = plate.moved(np.column_stack([f.ravel(), plate.spread(N), plate.spread(T)]))
    by_f, by_N, by_T = u[on, 0], u[on, 1 : 1 + n], u[on, 1 + n :]
    # The plate moves up and down as a rigid body.
    up = np.tile([0.0, 1.0], n)
    B_w, B_s = -(N @ up)[:, None], -(T @ up)[:, None]
    problem = FrictionalProblem(
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
    found = stick_slip.solve_load_increment(
        problem, mu, SlipHistory(np.zeros(n), np.zeros(n)), np.full(n, STICK)
    )
    whole = u @ np.concatenate([[1.0], -found.p, found.t])
    total = f.copy()
    # On the plane of symmetry the nodal forces include the reactions.
    total[left] = (plate.K @ whole).reshape(-1, 2)[left]
    others = float((x * total[:, 1] - y * total[:, 0]).sum())
    pressures = (-N.T @ found.p).reshape(-1, 2)
    return Plate(
        float((plate.line.xy[0] * pressures[:, 1]).sum() / -others),
        frozenset(int(s) for s in found.state),
    )


def _edge_nodal_forces(along: Floats, nodes: Ints) -> Floats:
    """Consistent nodal forces (all nodes,) of a unit traction on a straight edge.

    along : coordinate along the edge of all nodes; nodes : the nodes of the edge.
    """
    f = np.zeros(len(along))
    # Simpson's weights on each quadratic edge: two ends and the middle between them.
    order = nodes[np.argsort(along[nodes])]
    for first, middle, last in zip(order[0:-2:2], order[1::2], order[2::2], strict=True):
        length = along[last] - along[first]
        f[[first, middle, last]] += length / 6 * np.array([1.0, 4.0, 1.0])
    return f


SPRING_STIFFNESS = 4e10  # Pa/m
SPRING_RADIUS, SPRING_WIDTH, SPRING_PIN = 0.15, 0.04, 0.125  # m
SPRING_MOMENT = 250.0  # N m
SPRING_MU = 0.25
SPRING_ARC = (0.3, 2.2)  # rad
SPRING_WEAR = WearLaw(1e-13)
WEAR_UNIT = 1 / (SPRING_WEAR.coefficient * SPRING_STIFFNESS)
"""Distance 1/(k K) over which the deviation from the law falls to 1/e [m]."""


def _winkler_shoe(mu: float) -> tuple[WearInterface, Floats]:
    """A hinged rigid shoe with an unevenly worn lining of springs, and its nodes' angles (n,)."""
    phi = np.linspace(*SPRING_ARC, 49)
    xy = SPRING_RADIUS * np.array([np.cos(phi), np.sin(phi)])
    coupling = couple_with_counterface(
        ContactLine(np.arange(49), xy, phi, np.arange(0, 48, 2) + np.arange(3)[:, None]),
        SPRING_WIDTH,
        drum_directions(1),
    )
    # Displacements of the nodes as the shoe turns about its pin by 1 rad.
    turned = np.column_stack([-xy[1], xy[0] - SPRING_PIN]).ravel()
    closing = coupling.N @ turned
    problem = equations.ContactProblem(
        coupling.M / SPRING_STIFFNESS,
        coupling.M @ (2e-6 * np.cos(3 * phi)),
        -closing[:, None],
        (mu * (coupling.T @ turned) - closing)[None],
        np.array([SPRING_MOMENT]),
    )
    interface = WearInterface(
        problem, np.zeros(49), coupling.M, np.ones(49), coupling.area, mu * coupling.lever
    )
    return interface, phi


def _winkler_locking_friction() -> float:
    """Friction at which the hinged rigid shoe with a lining of springs locks itself."""
    # The equations are linear in friction, so that two problems give those of every friction.
    still, unit = _winkler_shoe(0.0)[0].problem, _winkler_shoe(-1.0)[0].problem
    return self_locking.find_friction_limit(
        self_locking.FrictionDependentProblem.from_two_problems(still, unit)
    ).friction


@cache
def _run_in_winkler_shoe() -> tuple[list[WearState], Floats]:
    """The states of the shoe as it runs in, and the pressure (n,) of the sine law at 1 N m."""
    interface, phi = _winkler_shoe(SPRING_MU)
    states = wear_linings([interface], SPRING_WEAR, distance=2 * WEAR_UNIT, tolerance=1e-4)
    # The sine law gives the shape of the pressure; the balance of moments gives its size.
    return states, np.sin(phi) / float(interface.problem.C[0] @ np.sin(phi))


def _remaining_deviation() -> float:
    """Fraction of the deviation from the sine law that is left after a distance of 2/(k K)."""
    states, law = _run_in_winkler_shoe()
    first = states[0].pressure - SPRING_MOMENT * law
    last = states[-1].pressure - SPRING_MOMENT * law
    return float(first @ last / (first @ first))


def _worn_volume_ratio() -> float:
    """Worn volume over k times the normal force integrated over the distance."""
    states, _ = _run_in_winkler_shoe()
    area = _winkler_shoe(SPRING_MU)[0].area
    worn_volume = area @ (states[-1].depth - states[0].depth)
    return float(worn_volume / (SPRING_WEAR.coefficient * states[-1].pressed))


class ThinLinings(NamedTuple):
    """A brake with thin linings on rigid shoes: torque [N m] by law, response by elements."""

    law_torque: float
    response: Response
    brake: Any


@cache
def _thin_linings() -> ThinLinings:
    """The double-shoe brake with linings of 3 mm on rigid shoes, by sine law and by elements."""
    rigid = vary(DoubleShoe().brake(2000.0), {"shoe.lining.thickness": 3e-3})
    return ThinLinings(sine(rigid).torque, solve(rigid, elements=24), rigid)


def _moment_imbalance() -> float:
    """Moment of all actuations and hinges about the drum's centre, over the torque."""
    response, brake = _thin_linings().response, _thin_linings().brake
    # Moments of the actuation and of the hinge reaction of each shoe.
    moments = []
    for spec, shoe in zip(brake.shoes, response.shoes, strict=True):
        pin, force = spec.pin.xy, shoe.hinge_reaction
        act, at = spec.actuation.vector, spec.actuation.point.xy
        moments.append(at[0] * act[1] - at[1] * act[0] + pin[0] * force[1] - pin[1] * force[0])
    return abs(math.fsum(moments)) / response.torque


FRICTION_CASES = (
    *(
        KnownAnswer(
            family="one node on springs",
            shows="friction states",
            source="spring force k s up to mu p",
            quantity=f"traction at s = {shift} m",
            expected=min(100 * shift, 5.0),
            tolerance=1e-12,
            tier=EXACT,
            found=partial(_node_traction, shift),
        )
        for shift in (0.02, 0.05, 0.2)
    ),
    KnownAnswer(
        family="closed loop of slip",
        shows="dissipation",
        source="area of the loop, 4 mu p (s - mu p/k)",
        quantity="energy [J]",
        expected=4 * 0.5 * 10 * (0.2 - 0.5 * 10 / 100),
        tolerance=1e-9,
        tier=EXACT,
        found=_loop_dissipation,
    ),
    *(
        KnownAnswer(
            family="flat patch test",
            shows="even pressure",
            source="El-Abbasi & Bathe 2001: E times the strain -.05",
            quantity=f"largest p [Pa], inclined by {turned} rad",
            expected=1e5,
            tolerance=1e-10,
            tier=EXACT,
            found=partial(_patch_largest_pressure, turned),
        )
        for turned in (0.0, 0.4)
    ),
    KnownAnswer(
        family="block on a wedge",
        shows="direction of friction",
        source="NAFEMS CGS-4: (tan a + mu)/(1 - mu tan a)",
        quantity="push over weight",
        expected=0.412371,
        tolerance=1e-6,
        tier=PRINTED,
        found=_wedge_push_ratio,
    ),
    KnownAnswer(
        family="tangentially loaded cylinders",
        shows="partial slip",
        source="Cattaneo 1938, Mindlin 1949: c/a = sqrt(1 - Q/(mu P))",
        quantity="c/a at Q = mu P/2",
        expected=math.sqrt(0.5),
        tolerance=1e-2,
        tier=DISCRETE,
        found=partial(_sticking_half_width_ratio, 0.5),
    ),
    KnownAnswer(
        family="belt on a drum",
        shows="drag of a flexible body",
        source="capstan: e^(mu theta)",
        quantity="ratio of tensions, mu = .3, 120 deg",
        expected=closed_forms.capstan_tension_ratio(0.3, 2 * math.pi / 3),
        tolerance=1e-2,
        tier=MODEL,
        found=partial(_belt_tension_ratio, 0.3, 2 * math.pi / 3),
    ),
    KnownAnswer(
        family="plate on a rigid plane",
        shows="stick, slip and open in one contact",
        source="balance of moments about a corner",
        quantity="moment of p over all others",
        expected=1.0,
        tolerance=1e-9,
        tier=EXACT,
        found=lambda: press_and_push_plate().moment,
    ),
    KnownAnswer(
        family="shoe on springs, self-locking",
        shows="limit of friction",
        source="moments of p ~ sin about the hinge",
        quantity="mu_lock",
        expected=closed_forms.sine_shoe_locking_friction(SPRING_RADIUS, SPRING_PIN, *SPRING_ARC),
        tolerance=1e-5,
        tier=DISCRETE,
        found=_winkler_locking_friction,
    ),
    KnownAnswer(
        family="shoe on springs, running in",
        shows="Archard wear in time",
        source="exp(-k K s), all in contact",
        quantity="deviation left at k K s = 2",
        expected=math.exp(-2),
        tolerance=1e-3,
        tier=DISCRETE,
        found=_remaining_deviation,
    ),
    KnownAnswer(
        family="worn volume",
        shows="Archard wear",
        source="Archard 1953: V = k N s",
        quantity="V over k Int N ds",
        expected=1.0,
        tolerance=1e-9,
        tier=EXACT,
        found=_worn_volume_ratio,
    ),
    KnownAnswer(
        family="rigid shoe with a thin lining",
        shows="whole brake by elements",
        source="sine law in the limit",
        quantity="torque over the law's",
        expected=1.0,
        tolerance=2e-2,
        tier=MODEL,
        found=lambda: _thin_linings().response.torque / _thin_linings().law_torque,
    ),
    KnownAnswer(
        family="balance of a whole brake",
        shows="hinge reactions",
        source="moments about the drum's centre",
        quantity="moment over torque",
        expected=1.0,
        tolerance=1e-8,
        tier=EXACT,
        found=_moment_imbalance,
    ),
)
