"""The pointwise penalty: contact as in textbooks, by Newton's method, for comparison only.

At the Gauss points of each element edge on the lining (order + 1 points) the pressure is p = eps
max(-g, 0), with the penalty stiffness eps and the gap g of the deformed lining. The drum drags the
lining by the friction mu p. Each step of Newton's method solves the system below for the
displacements u. Then the points with a closed gap count as touching. The steps end when no point
changes between touching and open:

    [K + sum w eps psi_a psi_b (n - mu s e) n^T] u = f + sum w eps psi_a (n - mu s e) g0

The sums are over the touching points, with the weight w, the shape functions psi, the normal n, the
tangent e, the sense s of the sliding, and the gap g0 of the unloaded lining; K is the stiffness
matrix, f the load. Each step factorises the whole sparse system, without static condensation and
without reuse of earlier factors. The method does not detect that friction has locked the shoe.
"""

import math
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.fem.equilibrium.state import unloaded_lining_gaps_at_points
from drumlin.fem.mesh.arc import DEFAULT_MESH_KIND, parametric_mesh_of_shoe
from drumlin.fem.preparation.bodies import (
    actuation_factors_and_pin_moment_per_newton,
    penalty_stiffness_of_contact_per_area,
)
from drumlin.fem.preparation.meshes import (
    DEFAULT_ELEMENTS_ALONG_LINING,
    AssembledUncondensedShoe,
    Mesher,
    mesh_and_assemble_shoe,
)
from drumlin.fem.preparation.scene import SecondsOfEachPhase, add_elapsed_time_of_block_to_phase
from drumlin.fem.substructure.body import DEGREES_OF_FREEDOM_OF_BODY_FRAME
from drumlin.fem.substructure.interface import (
    edge_quadrature_points,
    function_that_returns_drum_normals_and_tangents,
)
from drumlin.fem.substructure.loads import ACTUATION_LOAD_NAME
from drumlin.response.balance import (
    largest_imbalance_among_shoes,
    relative_magnitudes_of_force_and_moment_sums,
)
from drumlin.response.response import (
    ForceAndMomentImbalance,
    Response,
    ShoeResponse,
    response_of_pressed_elastic_shoe,
    response_of_shoe_without_contact,
)
from drumlin.response.resultants import planar_cross_product

DEFAULT_FACTOR_OF_POINTWISE_PENALTY = 1e3
"""Default penalty factor alpha in the penalty stiffness eps = alpha E/t [Pa/m].

E and t are Young's modulus and thickness of the lining. There are more Gauss points than nodes.
With a much larger factor the contact conditions at the points would over-constrain the nodes.
"""
MOST_NEWTON_STEPS_OF_POINTWISE_PENALTY = 60
"""Number of Newton steps after which the method gives up, because the contact has not converged."""


def solve_by_pointwise_penalty(
    brake: Brake,
    *,
    elements: int = DEFAULT_ELEMENTS_ALONG_LINING,
    kind: str = DEFAULT_MESH_KIND,
    penalty: float = DEFAULT_FACTOR_OF_POINTWISE_PENALTY,
    mesher: Mesher | None = None,
) -> Response:
    """The response of a brake with a rigid drum by the pointwise penalty.

    Each shoe is solved by itself. The pressure of the response is linear between the Gauss points.

    Parameters
    ----------
    brake : Brake
        The brake to be solved.
    elements : int
        Elements along a lining.
    kind : str
        Kind of the elements.
    penalty : float
        Penalty factor alpha in the penalty stiffness eps = alpha E/t.
    mesher : function, optional
        Returns the mesh of a shoe for the radius of the drum [m], in place of `elements` and
        `kind`.

    Raises
    ------
    NoAnswer
        The set of touching points repeats itself or still changes after
        MOST_NEWTON_STEPS_OF_POINTWISE_PENALTY.
    BadInput
        The brake has an elastic ring, or the penalty is infinite.
    """
    if not 0 < penalty < math.inf:
        raise BadInput(
            f"--penalty = {penalty}: must be greater than 0 and finite at quadrature points"
        )
    if brake.ring is not None:
        raise BadInput("drum.ring: the pointwise penalty has a rigid drum only")
    seconds: SecondsOfEachPhase = {}
    mesher = mesher or partial(parametric_mesh_of_shoe, elements=elements, kind=kind)
    shoes, balances, steps = [], [], []
    for shoe in brake.shoes:
        answer = _solve_one_shoe_by_penalty(brake, shoe, mesher, penalty, seconds)
        shoes.append(answer.response)
        balances.append(answer.balance)
        steps.append(answer.steps)
    return Response(
        model="pointwise",
        shoes=tuple(shoes),
        balance=largest_imbalance_among_shoes(balances),
        iterations=max(steps),
        seconds=seconds,
    )


@dataclass(frozen=True)
class _QuadraturePointsOfFrictionFace:
    """The quadrature points of a shoe's friction face, at which the contact is enforced.

    Attributes
    ----------
    weight : array (q,)
        Area of the lining that each of the q points represents [m^2].
    phi, radius, gap : array (q,)
        Angle in the shoe's frame [rad], radius [m] and gap of the unloaded lining [m].
    gap_closure_by_displacements : sparse matrix (q, unknowns)
        Matrix that maps the displacements to the closure n . u of the gap at each point.
    nodal_forces_of_unit_contact : sparse matrix (q, unknowns)
        In each row the nodal forces of a normal force of 1 N at a point and of its friction.
    """

    weight: Floats
    phi: Floats
    radius: Floats
    gap: Floats
    gap_closure_by_displacements: Any
    nodal_forces_of_unit_contact: Any


class ShoeResponseByPointwisePenalty(NamedTuple):
    """The response of a shoe, its imbalance of forces, and its number of Newton steps."""

    response: ShoeResponse
    balance: ForceAndMomentImbalance
    steps: int


def _solve_one_shoe_by_penalty(
    brake: Brake, shoe: Shoe, mesher: Mesher, penalty: float, seconds: SecondsOfEachPhase
) -> ShoeResponseByPointwisePenalty:
    """Solve one shoe; returns its response, its imbalance and its number of Newton steps.

    Parameters
    ----------
    brake, shoe : Brake, Shoe
        The brake, and the shoe that is solved.
    mesher : function
        Returns the mesh of the shoe for the radius of the drum [m].
    penalty : float
        Penalty factor alpha in the penalty stiffness eps = alpha E/t.
    seconds : dict
        Times [s] of the steps of the solve, by name; the times of this shoe are added.
    """
    parts = mesh_and_assemble_shoe(brake, shoe, mesher, seconds)
    drag = brake.signed_friction_stress_over_pressure_in_shoe_frame(shoe)
    unit, moment = actuation_factors_and_pin_moment_per_newton(parts, shoe)
    force = abs(shoe.actuation.force)
    per_newton = parts.load_matrix_columns_by_load_name.column_factors_of_one_named_load(
        ACTUATION_LOAD_NAME, unit
    )
    with add_elapsed_time_of_block_to_phase(seconds, "contact"):
        A = (parts.constraints.matrix.T @ parts.K @ parts.constraints.matrix).tocsc()
        points = _quadrature_points_of_shoe_friction_face(parts, brake, shoe, drag)
        # Displacements of all unknowns while the shoe turns as a rigid body about its pin by 1 rad.
        turned = np.zeros(A.shape[0])
        turned[
            2 * -len(parts.line.nodes)
            - DEGREES_OF_FREEDOM_OF_BODY_FRAME : -DEGREES_OF_FREEDOM_OF_BODY_FRAME
        ] = _nodal_displacements_per_turn_about_pin(parts, shoe)
        turned[-1] = 1.0
        if force == 0 or not (moment * (points.gap_closure_by_displacements @ turned) > 0).any():
            return _answer_of_shoe_without_contact(shoe)
        # The pin fixes the two displacements of the shoe's frame; all other unknowns are free.
        free = np.delete(
            np.arange(A.shape[0]),
            [-DEGREES_OF_FREEDOM_OF_BODY_FRAME, 1 - DEGREES_OF_FREEDOM_OF_BODY_FRAME],
        )
        load = force * (parts.loads[ACTUATION_LOAD_NAME] @ per_newton)
        stiffness = penalty_stiffness_of_contact_per_area(shoe, penalty)
        contact_state = _find_touching_points_by_newton(A, load, points, stiffness, free, shoe.name)
        u, on = contact_state.u, contact_state.touching
        p = np.where(on, stiffness * (points.gap_closure_by_displacements @ u - points.gap), 0.0)
        nodal = points.nodal_forces_of_unit_contact.T @ (points.weight * p)
        # The hinge reaction is the residual of two equations, those of the displacements that the
        # pin fixes.
        reaction = (A @ u - load - nodal)[
            -DEGREES_OF_FREEDOM_OF_BODY_FRAME : 1 - DEGREES_OF_FREEDOM_OF_BODY_FRAME + 1
        ]
    contact = nodal[
        2 * -len(parts.line.nodes)
        - DEGREES_OF_FREEDOM_OF_BODY_FRAME : -DEGREES_OF_FREEDOM_OF_BODY_FRAME
    ].reshape(-1, 2)
    given = (force * per_newton)[:2]
    balance = _relative_imbalance_of_forces_and_moments(
        parts, shoe, contact, reaction, given, force * moment
    )
    # Friction assists the actuation if both do work of the same sign in a rotation of the shoe
    # about its pin.
    assists = _work_of_friction_in_shoe_motion(points, p, turned) * moment > 0
    to_brake, turn = shoe.frame.convert_vectors_from_shoe_to_brake_frame(reaction), float(u[-1])
    response = _shoe_response_from_quadrature_pressures(
        shoe, points, p, abs(drag), to_brake, assists, turn
    )
    return ShoeResponseByPointwisePenalty(response, balance, contact_state.steps)


def _answer_of_shoe_without_contact(shoe: Shoe) -> ShoeResponseByPointwisePenalty:
    """The answer for a shoe that its actuation force does not press on the drum."""
    response = response_of_shoe_without_contact(shoe, -shoe.actuation.force_vector)
    return ShoeResponseByPointwisePenalty(response, ForceAndMomentImbalance(0.0, 0.0), 0)


def _work_of_friction_in_shoe_motion(
    points: _QuadraturePointsOfFrictionFace, p: Floats, motion: Floats
) -> float:
    """Work [N m] of the friction under the pressures p (q,) [Pa] in the displacements `motion` [m].

    `motion` (unknowns,) has all displacements of the shoe. The matrix
    `nodal_forces_of_unit_contact` gives normal and friction forces, and
    `gap_closure_by_displacements` gives the normal forces with the opposite sign. The sum of both
    matrices gives the friction forces alone.
    """
    return float(
        (points.weight * p)
        @ ((points.nodal_forces_of_unit_contact + points.gap_closure_by_displacements) @ motion)
    )


def _relative_imbalance_of_forces_and_moments(
    parts: AssembledUncondensedShoe,
    shoe: Shoe,
    contact: Floats,
    reaction: Floats,
    given: Floats,
    moment: float,
) -> ForceAndMomentImbalance:
    """The relative imbalance of forces on a shoe, and of their moments about the drum's centre.

    Parameters
    ----------
    parts : AssembledUncondensedShoe
        The assembled shoe, with its n contact nodes.
    shoe : Shoe
        The shoe.
    contact : array (n, 2)
        Forces on the contact nodes [N].
    reaction, given : array (2,)
        Forces of the hinge and of the actuation [N].
    moment : float
        Moment of the actuation about the pin [N m].
    """
    pin = shoe.pin_position_in_shoe_frame
    return relative_magnitudes_of_force_and_moment_sums(
        [contact.sum(axis=0), reaction, given],
        [
            float(planar_cross_product(parts.line.xy.T, contact).sum()),
            float(planar_cross_product(pin, reaction)),
            moment,
            float(planar_cross_product(pin, given)),
        ],
    )


def _quadrature_points_of_shoe_friction_face(
    parts: AssembledUncondensedShoe, brake: Brake, shoe: Shoe, drag: float
) -> _QuadraturePointsOfFrictionFace:
    """The quadrature points of a shoe's friction face.

    drag : friction force divided by normal force, positive if the drum drags towards growing
    angles.
    """
    line = parts.line
    at, weights = np.polynomial.legendre.leggauss(line.interpolation_degree_along_contact_line + 1)
    psi, x, ds = edge_quadrature_points(line.xy[:, line.pieces], at, weights)
    normal, tangent = function_that_returns_drum_normals_and_tangents(
        shoe.sign_internal_plus_external_minus
    )(x)
    radius = np.hypot(*x)
    phi = shoe.surface_coordinates_of_points_in_shoe_frame(x, brake.size)
    unknowns = parts.constraints.matrix.shape[1]
    first = unknowns - DEGREES_OF_FREEDOM_OF_BODY_FRAME - 2 * len(line.nodes)

    def nodal_force_matrix_of_vectors_at_points(vectors: Floats) -> Any:
        """The nodal forces of a vector at each point, as a sparse matrix (points, unknowns).

        vectors : array (2, edges, points on an edge) of unit forces at the points.
        """
        edges, q = x.shape[1:]
        rows = np.broadcast_to(np.arange(edges * q).reshape(edges, q), (2, len(psi), edges, q))
        columns = np.broadcast_to(
            first + 2 * line.pieces[None, :, :, None] + np.arange(2)[:, None, None, None],
            rows.shape,
        )
        values = np.einsum("aq,ceq->caeq", psi, vectors)
        return sp.csr_matrix(
            (values.ravel(), (rows.ravel(), columns.ravel())), shape=(edges * q, unknowns)
        )

    return _QuadraturePointsOfFrictionFace(
        weight=(shoe.lining.width * ds).ravel(),
        phi=phi.ravel(),
        radius=radius.ravel(),
        gap=unloaded_lining_gaps_at_points(x, phi, brake, shoe).ravel(),
        gap_closure_by_displacements=nodal_force_matrix_of_vectors_at_points(normal),
        nodal_forces_of_unit_contact=nodal_force_matrix_of_vectors_at_points(
            drag * tangent - normal
        ),
    )


def _nodal_displacements_per_turn_about_pin(parts: AssembledUncondensedShoe, shoe: Shoe) -> Floats:
    """Displacements (2 n,) [m/rad] of the n contact nodes as the shoe turns about its pin."""
    x, y = parts.line.xy - shoe.pin_position_in_shoe_frame[:, None]
    return np.column_stack([-y, x]).ravel()


class _ContactStateOfShoeByNewton(NamedTuple):
    """Contact state of a shoe: displacements u (unknowns,), touching points, number of steps.

    `touching` (q,) tells for each quadrature point whether it touches the drum. `steps` is the
    number of Newton steps.
    """

    u: Floats
    touching: Bools
    steps: int


def _find_touching_points_by_newton(
    A: Any,
    load: Floats,
    points: _QuadraturePointsOfFrictionFace,
    stiffness: float,
    free: Ints,
    name: str,
) -> _ContactStateOfShoeByNewton:
    """The contact state of a shoe by Newton's method, which starts with all points touching.

    Parameters
    ----------
    A : sparse matrix (unknowns, unknowns)
        Stiffness matrix of the shoe.
    load : array (unknowns,)
        Nodal forces of the actuation [N].
    points : _QuadraturePointsOfFrictionFace
        Quadrature points of the shoe's friction face.
    stiffness : float
        Penalty stiffness eps [Pa/m].
    free : array of int
        Indices of the unknowns that the pin does not fix.
    name : str
        Name of the shoe, for error messages.
    """
    u, on = np.zeros(A.shape[0]), np.ones(len(points.gap), dtype=bool)
    K = A[free][:, free].tocsc()
    seen: set[bytes] = set()
    for step in range(1, MOST_NEWTON_STEPS_OF_POINTWISE_PENALTY + 1):
        factor = sp.diags(on * points.weight * stiffness)
        pushing = points.nodal_forces_of_unit_contact.T[free] @ factor
        try:
            factors = splu(
                (K - pushing @ points.gap_closure_by_displacements[:, free]).tocsc(),
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=0.01,
                options={"SymmetricMode": True},
            )
        except RuntimeError as error:
            raise NoAnswer(
                f"shoe {name!r}: the pointwise contact has a singular tangent in step {step}"
            ) from error
        u[free] = factors.solve(load[free] - pushing @ points.gap)
        # In the next step a point touches if the displacements of this step close its gap.
        touching = points.gap_closure_by_displacements @ u > points.gap
        if (touching == on).all():
            return _ContactStateOfShoeByNewton(u, on, step)
        if touching.tobytes() in seen:
            raise NoAnswer(
                f"shoe {name!r}: not converged, "
                f"the pointwise contact repeats itself after {step} steps"
            )
        seen.add(touching.tobytes())
        on = touching
    raise NoAnswer(
        f"shoe {name!r}: not converged, "
        f"the pointwise contact still changes after {MOST_NEWTON_STEPS_OF_POINTWISE_PENALTY} steps"
    )


def _shoe_response_from_quadrature_pressures(
    shoe: Shoe,
    points: _QuadraturePointsOfFrictionFace,
    p: Floats,
    friction: float,
    reaction: Floats,
    assists: bool,
    turn: float,
) -> ShoeResponse:
    """The response of a shoe from the pressures at its quadrature points.

    The pressure is linear between the points, and constant from the outermost points to the
    lining's ends.

    Parameters
    ----------
    shoe : Shoe
        The shoe.
    points : _QuadraturePointsOfFrictionFace
        Quadrature points of the shoe's friction face.
    p : array (q,)
        Pressure at the points [Pa].
    friction : float
        Coefficient of friction.
    reaction : array (2,)
        Hinge reaction in the coordinates of the brake [N].
    assists : bool
        Whether friction presses the shoe to the drum.
    turn : float
        Angle by which the shoe turns about its pin [rad].
    """
    frame, by_angle = shoe.frame, np.argsort(points.phi)
    phi, q = points.phi[by_angle], p[by_angle]
    phi, q = np.concatenate([[shoe.arc[0]], phi, [shoe.arc[1]]]), np.concatenate([q[:1], q, q[-1:]])
    forces = points.weight * p
    normal = [float(forces @ np.cos(points.phi)), float(forces @ np.sin(points.phi))]
    return response_of_pressed_elastic_shoe(
        shoe,
        float(points.radius.mean()),
        frame.surface_coordinates_of_phi(phi),
        q,
        order=1,
        torque=friction * float(forces @ points.radius),
        normal_force=float(np.linalg.norm(normal)),
        self_energising=assists,
        hinge_reaction=reaction,
        turn=frame.sense * turn,
        located=False,
    )
