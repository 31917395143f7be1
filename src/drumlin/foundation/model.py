"""Solve post brakes by the foundation model: beams, springs and ring as one contact problem.

The shoe of a post brake is a straight beam on a hinge. Its lining is divided into sectors along the
arc. A sector with the clearance Delta and the stiffness k bears a normal force N >= 0. The ring
below the sector moves inwards by z, and the beam closes the gap by d, so that the remaining gap is

    w = Delta + N/k + z - d >= 0,                N w = 0

The beam turns about its hinge by y and bends under its moments M. The forces of all sectors bend
the ring, which has the flexibilities c. `ShoeInStationsAndSectors` explains the arrays `loaded`,
`pressed`, `dragged` and `closing`, and the friction factor mu_hat. The subscript 0 stands for the
first row of an array, which belongs to the station at the hinge. With the trapezoidal rule over the
stations of the beam, whose weights are dx,

    M = loaded - (pressed + mu_hat dragged) N,   d = y closing_0 + closing^T (dx/EI) M,
    z = c N,                                     M_0 = 0: (pressed + mu_hat dragged)_0 N = loaded_0.

These equations are eq. 2, 8, 16 and 19 of Barecki & Scieszka (1987), and their eq. 7 solved for the
displacement d.
"""

import math
import time
from collections.abc import Iterable
from functools import partial
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats, slices_from_lengths_of_consecutive_parts
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.lapack import block_diag
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import BeamBody
from drumlin.brake.friction import reason_if_friction_depends_on_pressure
from drumlin.brake.further_loads import reason_if_loads_besides_actuation_act
from drumlin.brake.heat import reason_if_any_shoe_is_heated
from drumlin.brake.orthotropic import reason_if_any_part_is_orthotropic
from drumlin.brake.ring_support import reason_if_ring_edge_is_not_fixed_or_free
from drumlin.brake.surface import FRICTION_SURFACE_OF_DRUM
from drumlin.contact import active_set, self_locking
from drumlin.contact.equations import ContactProblem
from drumlin.foundation.post import (
    ShoeInStationsAndSectors,
    brake_angles_from_beam_angles,
    divide_shoe_into_stations_and_sectors,
    trapezoidal_rule_weights,
)
from drumlin.foundation.ring import (
    inward_ring_displacement_per_radial_force,
    inward_ring_displacement_per_tangential_force,
)
from drumlin.laws import self_locking_friction_of_hinged_shoe
from drumlin.laws.hinged import actuation_moment_towards_drum
from drumlin.laws.rigid import note_on_shoe_without_contact
from drumlin.response.balance import largest_imbalance_among_shoes, relative_imbalance_of_shoe
from drumlin.response.merit import response_with_figures_of_merit
from drumlin.response.response import (
    BeamAndRingDeflections,
    Response,
    ShoeResponse,
    response_of_pressed_elastic_shoe,
    response_of_shoe_without_contact,
)
from drumlin.response.resultants import (
    PressureAndFrictionResultant,
    polynomial_nodes_on_linings_and_slots,
)

DEFAULT_DIVISIONS_OF_SHOE_BEAM = 360
"""Number of divisions of each shoe's beam if the user gives none."""

LARGEST_ACCEPTED_TURN_ABOUT_HINGE = 0.2
"""Largest turn of a shoe about its hinge [rad] that the model accepts, some 11 degrees.

The model assumes small displacements, and an answer with a larger turn is refused.
"""

INCLUDABLE_EFFECTS = {
    "plane-stress": (
        "layers as columns of stiffness E/t, not bonded and held along the arc: E/((1 - nu^2) t)"
    ),
    "tilt": (
        "the beam's sections turn without carrying the lining along the beam: "
        "the gap closes by w cos(theta) only"
    ),
    "wedge": (
        "the block has one thickness, that of [shoe.backing], "
        "and does not fill the space up to the beam"
    ),
    "thick-ring": (
        "the ring bends as a thin one of the drum's radius, without hoop and shear deformation"
    ),
    "all-modes": "the ring is loaded by an equal shoe opposite, so that it has even modes only",
    "own-pressure": "the other shoe's pressure is the same, half a turn on, not its own",
    "ring-friction": "friction does not bend the ring",
}
"""Effects that Barecki & Scieszka (1987) neglect and that this model can include.

The keys are the names of the effects for the option --lift, which includes them. The values
describe how the model neglects each effect. They are printed for the effects that stay neglected.
"""

ALWAYS_NEGLECTED_EFFECTS = (
    "shear and stretching of the beam: it only bends",
    "shear of lining and block: springs side by side",
)
"""Effects that the foundation model always neglects, as lines for the printed answer."""

INCLUDABLE_EFFECTS_THAT_NEED_ELASTIC_RING = frozenset(
    {"thick-ring", "all-modes", "own-pressure", "ring-friction"}
)
"""The effects of INCLUDABLE_EFFECTS that exist only if the drum is an elastic ring."""


def reason_against_foundation_model(brake: Brake) -> str | None:
    """The reason why the foundation model does not apply to a brake; None if it applies."""
    refusal = (
        brake.surface.reason_why_surface_is_not_required_one(FRICTION_SURFACE_OF_DRUM)
        or brake.reason_why_cam_or_strut_sets_forces
    )
    if refusal is not None:
        return refusal
    for shoe in brake.shoes:
        if not isinstance(shoe.body, BeamBody):
            return f'shoe {shoe.name!r}: is not a straight beam, [shoe.body] with shape = "beam"'
    model = "the foundation model"
    return (
        reason_if_loads_besides_actuation_act(brake, model)
        or reason_if_any_part_is_orthotropic(brake, model)
        or reason_if_any_shoe_is_heated(brake, model)
        or reason_if_friction_depends_on_pressure(brake, model)
        or reason_if_ring_edge_is_not_fixed_or_free(brake, model)
    )


def validated_names_of_effects_to_include(brake: Brake, lift: Iterable[str]) -> frozenset[str]:
    """The names of the effects that a solve includes, from the values of --lift.

    The value "all" stands for all effects that the brake file allows. Raises BadInput for an
    unknown name, and for an effect that the brake file does not allow, because it lacks data or
    gives a lining its own friction.
    """
    names = set(lift)
    unknown = sorted(names - set(INCLUDABLE_EFFECTS) - {"all"})
    if unknown:
        raise BadInput(
            f"--lift = {unknown[0]!r}: unknown simplification; allowed: "
            f"{', '.join(INCLUDABLE_EFFECTS)}, all"
        )
    # `lacking` tells why the brake file does not allow an effect, by the name of the effect.
    lacking: dict[str, str] = {}
    for shoe in brake.shoes:
        if shoe.backing and isinstance(shoe.body, BeamBody) and shoe.body.thickness is None:
            lacking["wedge"] = "needs shoe.body.thickness"
    if brake.ring is not None and brake.ring.section is None:
        lacking["thick-ring"] = "needs drum.ring.thickness, width and material"
    own_friction = brake.first_key_that_gives_lining_its_own_friction()
    if own_friction is not None:
        lacking["ring-friction"] = f"takes one friction for all shoes, not {own_friction}"
    for name in sorted(names & set(lacking)):
        raise BadInput(f"--lift = {name!r}: {lacking[name]}")
    if "all" in names:
        names = set(INCLUDABLE_EFFECTS) - set(lacking)
    # Without "all-modes" an equal shoe opposite each shoe is assumed, so that the ring has even
    # modes only. If each shoe loads the ring by its own pressure, it needs the odd modes as well.
    if "own-pressure" in names:
        names = names | {"all-modes"}
    return frozenset(names)


class FoundationContactProblem(NamedTuple):
    """The contact problem of shoes that are solved together.

    They are all shoes whose pressures bend the drum's ring together, or a single shoe.

    Attributes
    ----------
    posts : the shoes of the group, with stations along their beams and sectors of their linings
    ring : (n, n) [m/N], inward displacement of the ring at each of the group's n sectors per normal
        force on each sector; zero for a rigid drum
    problem : the contact problem, whose unknowns are the normal forces [N] of the sectors
    """

    posts: tuple[ShoeInStationsAndSectors, ...]
    ring: Floats
    problem: ContactProblem


def contact_problem_of_shoe_group(
    brake: Brake, group: list[int], sections: int, lift: frozenset[str]
) -> FoundationContactProblem:
    """Set up the contact problem of a group of shoes for the normal forces [N] of their sectors.

    Parameters
    ----------
    brake : the brake
    group : indices of the group's shoes in the brake
    sections : number of divisions of each beam
    lift : names in INCLUDABLE_EFFECTS of the effects to include

    Raises
    ------
    BadInput
        if `sections` is below 4 or above 4000
    """
    if not 4 <= sections <= 4000:
        raise BadInput(f"--sections = {sections}: must be from 4 to 4000")
    make = partial(
        divide_shoe_into_stations_and_sectors,
        sections=sections,
        tilt="tilt" in lift,
        wedge="wedge" in lift,
        plane_stress="plane-stress" in lift,
    )
    posts = tuple(make(brake, brake.shoes[i]) for i in group)
    # The polar angles, on the ring, of the sectors of all shoes of the group.
    theta = np.concatenate(
        [p.axis.polar_angle_of_perpendicular_foot + p.axis.sense * p.theta for p in posts]
    )
    ring = inward_ring_displacement_per_normal_force(brake, theta, theta, lift)
    # Only the ring couples the shoes: all matrices except `ring` have a diagonal block per shoe.
    problems = list(map(_contact_problem_of_one_shoe, posts))
    problem = ContactProblem(
        A=block_diag(*(each.A for each in problems)) + ring,
        q=np.concatenate([each.q for each in problems]),
        B=block_diag(*(each.B for each in problems)),
        C=block_diag(*(each.C for each in problems)),
        h=np.concatenate([each.h for each in problems]),
    )
    return FoundationContactProblem(posts, ring, problem)


def _contact_problem_of_one_shoe(p: ShoeInStationsAndSectors) -> ContactProblem:
    """The contact problem of one shoe for the normal forces [N] of its sectors, on a rigid drum."""
    # `turning` times the bending moments at the stations is the distance by which the gaps close.
    # `moments` times the normal forces of the sectors are the moments of these forces and their
    # friction about the stations.
    turning = p.closing.T * (p.station_weights / p.EI)
    moments = p.pressed + p.drag * p.dragged
    return ContactProblem(
        A=turning @ moments + np.diag(1 / p.k),
        q=p.gap - turning @ p.loaded,
        B=-p.closing[:1].T,
        C=-moments[:1],
        h=-p.loaded[:1],
    )


def inward_ring_displacement_per_normal_force(
    brake: Brake, theta: Floats, loads: Floats, lift: frozenset[str]
) -> Floats:
    """The inward displacement (k, n) [m/N] of the drum's ring per normal force on its rim.

    The result has a row for each place and a column for each force. It is zero for a rigid drum.

    Parameters
    ----------
    brake : the brake
    theta : angles (k,) [rad] at which the displacement is evaluated
    loads : angles (n,) [rad] at which the normal forces act
    lift : names in INCLUDABLE_EFFECTS of the effects to include
    """
    ring = brake.ring
    if ring is None:
        return np.zeros((len(theta), len(loads)))
    d = np.subtract.outer(theta, loads)
    twin, R = "all-modes" not in lift, brake.size
    c = inward_ring_displacement_per_radial_force(
        ring, R, d, twin=twin, sign=-1, thick="thick-ring" in lift
    )
    # The friction on the drum acts against the rotation, and bends the ring as well.
    if "ring-friction" in lift:
        c = (
            c
            - brake.friction
            * brake.sign_of_motion
            * inward_ring_displacement_per_tangential_force(ring, R, d, twin=twin)
        )
    return c


def inward_ring_displacement_under_each_shoe(
    brake: Brake, response: Response, theta: Floats, lift: Iterable[str] = ()
) -> Floats:
    """The inward displacement (shoes, k) [m] of the drum's ring that each shoe causes.

    The result has a row for each shoe. With "all-modes" in `lift`, the displacement that all shoes
    cause is the sum of the rows. Without "all-modes", each row is the displacement that the shoe
    and an equal shoe on the opposite side of the drum cause together.

    Parameters
    ----------
    brake : the brake
    response : the response of the foundation model
    theta : angles (k,) [rad] at which the displacement is evaluated
    lift : names in INCLUDABLE_EFFECTS of the effects that the response includes
    """
    names = validated_names_of_effects_to_include(brake, lift)
    rows = []
    # N are the normal forces of a shoe at the angles of its response, from its pressure by the
    # trapezoidal rule.
    for shoe, answer in zip(brake.shoes, response.shoes, strict=True):
        N = (
            shoe.lining.width
            * brake.size
            * trapezoidal_rule_weights(answer.theta)
            * answer.pressure
        )
        rows.append(
            inward_ring_displacement_per_normal_force(brake, theta, answer.theta, names) @ N
        )
    return np.array(rows)


def solve_brake_by_foundation_model(
    brake: Brake,
    *,
    sections: int = DEFAULT_DIVISIONS_OF_SHOE_BEAM,
    lift: Iterable[str] = (),
    start: list[Bools] | None = None,
) -> Response:
    """Solve a post brake by the foundation model.

    Parameters
    ----------
    brake : the brake
    sections : number of divisions of each beam
    lift : names in INCLUDABLE_EFFECTS of the effects to include, or "all"
    start : first guess for the sectors in contact: a mask (n,) for each shoe of the brake

    Raises
    ------
    BadInput
        if the model does not apply, or for an option out of range
    NoAnswer
        for a self-locking shoe, for no equilibrium or no convergence
    """
    reason = reason_against_foundation_model(brake)
    if reason is not None:
        raise BadInput(f"foundation does not apply to this brake: {reason}")
    names, clock = validated_names_of_effects_to_include(brake, lift), time.perf_counter()
    shoes = brake.shoes
    # A shoe that is turned away from the drum by its actuation needs no contact problem.
    touching = [i for i, shoe in enumerate(shoes) if actuation_moment_towards_drum(shoe) > 0]
    answers = {
        i: response_of_shoe_without_contact(shoe, -shoe.actuation.force_vector)
        for i, shoe in enumerate(shoes)
        if i not in touching
    }
    steps = 0
    for group in _groups_of_shoes_solved_together(brake, touching, names):
        parts = contact_problem_of_shoe_group(brake, group, sections, names)
        found = _solve_contact_of_shoe_group(brake, group, parts, sections, names, start)
        steps = max(steps, found.steps)
        answers |= _responses_of_shoe_group(brake, group, parts, found)
    ordered = tuple(answers[i] for i in range(len(shoes)))
    balances = [relative_imbalance_of_shoe(brake, i, shoe) for i, shoe in enumerate(ordered)]
    response = Response(
        model="foundation",
        shoes=ordered,
        balance=largest_imbalance_among_shoes(balances),
        iterations=steps,
        seconds={"solve": time.perf_counter() - clock},
        left_out=texts_of_neglected_effects(brake, names),
        notes=tuple(
            note_on_shoe_without_contact(shoe.name) for shoe in ordered if not shoe.contact_arcs
        ),
    )
    return response_with_figures_of_merit(brake, response)


def _groups_of_shoes_solved_together(
    brake: Brake, touching: list[int], names: frozenset[str]
) -> list[list[int]]:
    """The groups of shoes that must be solved together, as indices of shoes in the brake.

    Shoes influence each other only through an elastic ring that bends under the pressure of each
    shoe (the effect "own-pressure"). Otherwise each shoe is a group of its own. `touching` are the
    indices of the shoes that touch the drum, `names` the effects that the solve includes.
    """
    together = brake.ring is not None and "own-pressure" in names
    return [touching] if together and touching else [[i] for i in touching]


def _responses_of_shoe_group(
    brake: Brake,
    group: list[int],
    parts: FoundationContactProblem,
    found: active_set.ContactSolution,
) -> dict[int, ShoeResponse]:
    """The responses of a group of shoes, by the index of each shoe in the brake.

    Parameters
    ----------
    brake : the brake
    group : indices of the group's shoes in the brake
    parts : the contact problem of the group
    found : the solution of the contact problem
    """
    answers = {}
    # Inward displacement of the ring at the sectors of all shoes of the group.
    z = parts.ring @ found.p
    ranges = slices_from_lengths_of_consecutive_parts(len(p.theta) for p in parts.posts)
    for k, i in enumerate(group):
        part, turn = ranges[k], float(found.y[k])
        answers[i] = response_of_post_brake_shoe(
            brake, i, parts.posts[k], found.p[part], z[part], turn
        )
    return answers


def texts_of_neglected_effects(brake: Brake, names: frozenset[str]) -> tuple[str, ...]:
    """Lines of text about the effects that a solve neglects, each with the option to include it.

    `names` are the names in INCLUDABLE_EFFECTS of the effects that the solve includes.
    """
    ring = brake.ring is not None
    blocks = any(shoe.backing for shoe in brake.shoes)
    kept = []
    # Effects of an elastic ring are listed only if the drum has a ring, and "wedge" only if a shoe
    # has a block.
    for name, text in INCLUDABLE_EFFECTS.items():
        concerns = (ring or name not in INCLUDABLE_EFFECTS_THAT_NEED_ELASTIC_RING) and (
            blocks or name != "wedge"
        )
        if name not in names and concerns:
            kept.append(f"{text} (--lift {name})")
    rigid = () if ring else ("drum: rigid, no [drum.ring] in the brake",)
    return (*rigid, *ALWAYS_NEGLECTED_EFFECTS, *kept)


def _solve_contact_of_shoe_group(
    brake: Brake,
    group: list[int],
    parts: FoundationContactProblem,
    sections: int,
    names: frozenset[str],
    start: list[Bools] | None,
) -> active_set.ContactSolution:
    """Solve the contact problem of a group of shoes for normal forces and turns about the hinges.

    Parameters
    ----------
    brake : the brake
    group : indices of the group's shoes in the brake
    sections : number of divisions of each beam
    parts : the contact problem of the group
    names : names in INCLUDABLE_EFFECTS of the effects to include
    start : first guess for the sectors in contact: a mask (n,) for each shoe of the brake

    Raises
    ------
    NoAnswer
        for a self-locking shoe, no equilibrium, no convergence, or a turn of a shoe beyond
        LARGEST_ACCEPTED_TURN_ABOUT_HINGE
    """
    begin = None if start is None else np.concatenate([start[i] for i in group])

    def contact_problem_at_friction(friction: float) -> ContactProblem:
        """The contact problem of the group at a given friction coefficient."""
        if friction == brake.friction:
            return parts.problem
        other = brake.brake_with_new_friction_coefficient(friction)
        return contact_problem_of_shoe_group(other, group, sections, names).problem

    # `law` is the lowest friction at which a shoe of the group would lock itself if it were rigid.
    # Only below this friction may the solver accept a solution that it finds at once. At higher
    # friction the solver follows the solution in steps of growing friction.
    limits = []
    for i in group:
        own = self_locking_friction_of_hinged_shoe(brake, brake.shoes[i])
        limits.append(brake.brake_friction_that_gives_shoe_friction(brake.shoes[i], own))
    law = min(limits)
    try:
        found = self_locking.solve_contact_reached_from_zero_friction(
            contact_problem_at_friction,
            brake.friction,
            begin,
            rigid_law_limit=law,
            brake_words="on the foundation",
        )
    except NoAnswer as error:
        raise NoAnswer(f"{brake.text_with_names_of_shoes_at_indices(group)}: {error}") from error
    turn = float(np.abs(found.y).max())
    if turn > LARGEST_ACCEPTED_TURN_ABOUT_HINGE:
        raise NoAnswer(
            f"{brake.text_with_names_of_shoes_at_indices(group)}: it would have to turn by "
            f"{math.degrees(turn):.3g} deg; "
            f"small displacements hold up to "
            f"{math.degrees(LARGEST_ACCEPTED_TURN_ABOUT_HINGE):.3g} deg"
        )
    return found


def response_of_post_brake_shoe(
    brake: Brake, index: int, p: ShoeInStationsAndSectors, N: Floats, z: Floats, turn: float
) -> ShoeResponse:
    """The response of one shoe, from the normal forces on the sectors of its lining.

    Parameters
    ----------
    brake : the brake
    index : index of the shoe in the brake
    p : the shoe, with stations along its beam and sectors of its lining
    N : normal forces (n,) [N] on the sectors
    z : inward displacements (n,) [m] of the ring at the sectors
    turn : turn of the beam about its hinge [rad]
    """
    shoe, R = brake.shoes[index], brake.size
    pressure = N / (shoe.lining.width * R * p.sector)
    # The displacement w of the beam is the sum of the displacements by its turn and by its bending.
    moment = p.loaded - (p.pressed + p.drag * p.dragged) @ N
    bent = np.maximum(np.subtract.outer(p.x, p.x), 0.0) @ (p.station_weights / p.EI * moment)
    w = turn * p.x + bent
    theta = brake_angles_from_beam_angles(p.axis, shoe, p.theta)
    contact = _resultant_of_sector_forces(brake, shoe, theta, N)
    # Friction is self-energising if its moment about the hinge opposes the normal forces' moment.
    helping = float(-p.drag * (p.dragged[0] @ N))
    # `place` also has nodes in the slots between linings, where the pressure is zero.
    place, on_lining = polynomial_nodes_on_linings_and_slots(
        p.values_of_each_lining_by_growing_angle(theta), 1
    )
    p_at_place = np.zeros(len(place))
    p_at_place[on_lining] = pressure[:: p.axis.sense]
    z_at_place = np.interp(place, theta[:: p.axis.sense], z[:: p.axis.sense])
    deformation = BeamAndRingDeflections(
        x=p.x, w=w, relative=w - w[-1] * p.x / p.x[-1], z=z_at_place
    )
    return response_of_pressed_elastic_shoe(
        shoe,
        R,
        place,
        p_at_place,
        on_lining=on_lining,
        order=1,
        torque=abs(contact.moment),
        normal_force=float(np.linalg.norm(contact.normal)),
        self_energising=helping > 0,
        hinge_reaction=-shoe.actuation.force_vector - contact.force,
        turn=p.axis.sense * turn,
        located=False,
        lumped=contact,
        deformation=deformation,
    )


def _resultant_of_sector_forces(
    brake: Brake, shoe: Shoe, theta: Floats, N: Floats
) -> PressureAndFrictionResultant:
    """The resultant on an external lining of the normal forces `N` (n,) [N] and of their friction.

    The normal forces act at the angles `theta` (n,) [rad] around the drum.
    """
    normal = np.array([N @ np.cos(theta), N @ np.sin(theta)])
    drag = brake.signed_friction_stress_over_pressure(shoe)
    return PressureAndFrictionResultant(
        normal=normal,
        friction=drag * np.array([-normal[1], normal[0]]),
        moment=drag * brake.size * float(N.sum()),
    )
