"""The holding brake: from rest through partial slip to full slip, as the drum is turned.

In this analysis the actuation force is applied while the drum is at rest, and the drum turns
afterwards. In `solve`, in contrast, the drum already turns while the force is applied. At full slip
all nodes of the linings have slipped in one direction, and the pressures on the linings are the
same in both cases. For a foot on a rough abutment, however, the order matters: the foot slides
while the force is applied, and may then stick. The brake then reaches another equilibrium, in which
the force on the foot lies within the cone of friction, and its torque differs from the torque of
`solve`. A note of the result says so.

The contact nodes of a three-dimensional (solid) shoe cover the face of its lining. Each node opens,
sticks or slips along theta by itself. Across the width every node slides without friction. At full
slip this is exact, because the friction of a drum that has slid far acts along theta alone. Before
full slip, friction on a real drum also acts across the width. If the face of the double-shoe brake
cannot move across the width where it is in contact, the moment is 1.3 % larger at a fifth of the
rotation to full slip, and 0.8 % larger at three fifths.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import (
    BaseClassWithArrayEquality,
    Floats,
    Ints,
    text_of_fields_with_arrays_by_shape,
)
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.one_sided import (
    LARGEST_ROUND_OFF_CONTACT_FORCE,
    note_on_shoe_held_off_by_its_supports,
)
from drumlin.contact import stick_slip
from drumlin.contact.active_set import ContactSolution
from drumlin.contact.pressure_friction import (
    FunctionOfNodalFrictionByPressures,
    NodalFrictionAndSlope,
    solve_stick_slip_increment_with_pressure_dependent_friction,
)
from drumlin.contact.stick_slip import (
    BACKWARD,
    FORWARD,
    OPEN,
    STICK,
    StickSlipIncrementSolution,
    StickSlipProblem,
    TractionsAndSlipsOfLastIncrement,
)
from drumlin.fem.analysis.at_rest import (
    FeetOnRoughAbutments,
    make_stick_slip_problem_and_slip_per_drum_rotation,
)
from drumlin.fem.equilibrium.group import (
    ShoeGroup,
    divide_shoes_into_groups,
    indices_of_pressed_shoes_in_brake,
)
from drumlin.fem.equilibrium.pressure_friction import (
    friction_and_its_slopes_at_nodes_of_group,
    solve_shoe_group_with_lining_friction,
)
from drumlin.fem.equilibrium.spring_nodes import (
    SpringNodes,
    group_under_spring_pulls,
    spring_nodes_of_brake,
)
from drumlin.fem.model import DEFAULT_PENALTY_FACTOR, solve_prepared_model
from drumlin.fem.preparation.bodies import (
    substructure_with_flexibility_of_condensed_stiffness,
)
from drumlin.fem.preparation.scene import PreparedModel

MAX_HALVINGS_OF_ROTATION_INCREMENT = 4
"""Largest number of times that an increment of the drum's rotation is halved before `hold` fails.

Within a large increment a node may stick, slip and open one after the other. A single increment,
which has one state for each node, then has no solution. This happens if the increment is many
times as large as the rotation to full slip. Of ten random shoes with clearances, turned to and fro
by 10 to 5000 times this rotation, two need four halvings, and three halvings refuse them. With more
halvings a brake without a solution is only refused later.
"""
FIRST_ROTATION_OF_FULL_SLIP_SEARCH = 1e-7
"""First rotation of the drum [rad] in the search for full slip, which enlarges it step by step.

It lies far below any rotation that makes a lining slip, which is 1e-4 p/E or more for a lining of
modulus E under the pressure p. The rotation grows elevenfold in an increment at most. A first
rotation that is a hundred times smaller therefore takes some two increments more, of the 100
increments that the search may take.
"""
MARGIN_OF_FULL_SLIP_ROTATION = 0.1
"""Fraction by which `find_drum_rotation_of_full_slip` enlarges the rotation that gave full slip.

The rotation at which all nodes slip depends on the increments, and may be larger in a later
computation with other increments. With half of this fraction some linings on a pivot then still
stick at a few nodes. With a larger fraction, a table of states up to this rotation has fewer rows
before full slip. Each increment of the search is between MARGIN_OF_FULL_SLIP_ROTATION and
1/MARGIN_OF_FULL_SLIP_ROTATION times the rotation reached so far. The search then narrows the
rotation down to this fraction above a rotation without full slip.
"""
MOST_INCREMENTS_OF_FULL_SLIP_SEARCH = 100
"""Number of increments of rotation after which the search for full slip fails as not converged."""
LARGEST_TORQUE_DIFFERENCE_OF_SAME_EQUILIBRIUM = 1e-6
"""Relative difference of two torques at full slip above which they count as two equilibria.

Two computations of the same equilibrium differ only by the effect of the penalty, 1e-8.
"""
LARGEST_FOOT_FRICTION_RATIO_DIFFERENCE = 1e-6
"""Difference of two ratios of friction force to normal force above which states of a foot differ.

Smaller differences are round-off and the effect of the penalty.
"""

NOTE_ON_NEGLECTED_FRICTION_ACROSS_WIDTH = (
    "solid: friction acts along theta; across the width the face slides freely, "
    "also where it sticks"
)
"""Note that each `HoldingState` of a brake with solid shoes contains."""
STICK_SLIP_STATES_IN_ORDER_OF_PRECEDENCE = (STICK, FORWARD, BACKWARD)
"""The states of contact nodes in order of precedence across the width of a solid shoe.

The nodes across the width at one angle may have different states. The lining counts as sticking at
this angle if at least one of these nodes sticks. If no node sticks, it counts as slipping if at
least one of these nodes slips.
"""

NodesFriction = float | Floats | FunctionOfNodalFrictionByPressures
"""The friction of contact nodes: one coefficient, coefficients (n,), or a function of pressures."""

ArcsAlongLining = tuple[tuple[float, float], ...]
"""The type of arcs along a lining: the angles [rad] at which each arc starts and ends."""


class ContactNodesOfHeldLiningFace(NamedTuple):
    """The contact nodes of one shoe's lining, at n angles and m distances from the mid-plane.

    A lining in plane stress has one node at each angle.

    Attributes
    ----------
    z : (m,) distances [m] from the mid-plane
    pressure, traction : (n, m) pressure and tangential traction along e_theta [Pa]
    state : (n, m) state of each node: open, stick, slip forward or slip backward
    """

    z: Floats
    pressure: Floats
    traction: Floats
    state: Ints


@dataclass(frozen=True, eq=False)
class HoldingState(BaseClassWithArrayEquality):
    """The state of a holding brake at one rotation of the drum, which has turned from rest.

    Attributes
    ----------
    rotation : rotation [rad] of the drum from its rest
    torque : moment [N m] of all linings on the drum, positive against the brake's rotation
    names : names of the shoes
    theta : for each shoe, the angles (n,) [rad] of its lining's nodes, in increasing order
    pressure : for each shoe, the pressure (n,) [Pa] on its lining; for solid shoes the mean over
        the width
    traction : for each shoe, the tangential traction (n,) [Pa] on its lining along e_theta; for
        solid shoes the mean over the width
    state : for each shoe, the state (n,) at each angle: open, stick, slip forward or slip backward;
        for solid shoes the first state in STICK_SLIP_STATES_IN_ORDER_OF_PRECEDENCE that occurs
        across the width
    stick, slip : for each shoe, the arcs [rad] of its lining that stick, and the arcs that slip
    dissipated : energy [J] dissipated by slip since the actuation force was zero
    face : for each shoe, the contact nodes of its lining
    notes : notes that explain why the moment at full slip differs from the moment by `solve`, and
        what the model of solid shoes neglects
    spring_pulls : pull [N] of each spring; empty if no spring has a rate
    """

    rotation: float
    torque: float
    names: tuple[str, ...]
    theta: tuple[Floats, ...]
    pressure: tuple[Floats, ...]
    traction: tuple[Floats, ...]
    state: tuple[Ints, ...]
    stick: tuple[ArcsAlongLining, ...]
    slip: tuple[ArcsAlongLining, ...]
    dissipated: float
    face: tuple[ContactNodesOfHeldLiningFace, ...]
    notes: tuple[str, ...] = ()
    spring_pulls: tuple[float, ...] = ()

    def __repr__(self) -> str:
        """The fields, where an array is shown by its shape alone."""
        return text_of_fields_with_arrays_by_shape(self)

    @property
    def sticking(self) -> float:
        """The fraction of the touching contact nodes that stick; 0 if no node touches the drum."""
        states = np.concatenate([face.state.ravel() for face in self.face])
        touching = np.count_nonzero(states != OPEN)
        sticking = np.count_nonzero(states == STICK)
        return float(sticking / touching) if touching else 0.0


class _LoadedGroupAtRest(NamedTuple):
    """A group of shoes under the full actuation force, with the drum at rest.

    The stick-slip problem and its increments hold per newton of the group's largest actuation
    force, and energies per newton squared.

    Attributes
    ----------
    group : the group of shoes
    problem : the stick-slip problem, whose last nodes are feet on rough abutments and one-sided
        supports
    slip_per_rotation : growth (n,) of the weighted slips q_s (integrals of the slip times each
        node's shape function) per radian of drum rotation in the brake's sense
    friction : friction coefficients (n,) of the nodes, or a function of the pressures that returns
        the coefficients
    rest : the last load increment before the drum turns, at whose end the full force acts
    dissipated : energy [J/N^2] dissipated by slip while the force was applied
    springs : the springs with a rate, whose nodes are the last; None without such nodes. With such
        nodes, the springs with a rate do not load `group`, because their pulls are unknowns
    """

    group: ShoeGroup
    problem: StickSlipProblem
    slip_per_rotation: Floats
    friction: NodesFriction
    rest: StickSlipIncrementSolution
    dissipated: float
    springs: SpringNodes | None = None

    def pulls_of_springs(self, at: StickSlipIncrementSolution) -> tuple[float, ...]:
        """The pull [N] of each spring of the brake at an increment; empty without a rate.

        Raises NoAnswer if a spring is slack.
        """
        if self.springs is None:
            return ()
        forces = self.group.largest_actuation_force * at.p[-len(self.springs.numbers) :]
        return self.springs.pulls_of_all_springs(self.group.brake, forces)

    @property
    def number_of_lining_nodes(self) -> int:
        """The number of nodes on linings, which come before the nodes of feet and supports."""
        return self.group.contact_node_slices_of_shoes[-1].stop

    def torque(self, at: StickSlipIncrementSolution) -> float:
        """The moment [N m] of the linings on the drum at an increment, against the rotation."""
        return float(self.group.largest_actuation_force**2 * (self.slip_per_rotation @ at.t))

    def turn_drum_from_start_to_end_rotation(
        self, increment: StickSlipIncrementSolution, start: float, end: float
    ) -> Iterator[StickSlipIncrementSolution]:
        """Turn the drum from `start` to `end` [rad], and yield each converged increment.

        `increment` is the converged increment at the rotation `start`.
        """
        return turn_drum_in_increments(
            self.problem, self.slip_per_rotation, self.friction, increment, start, end
        )


class _SlidingDrumSolution(NamedTuple):
    """The equilibrium of a group of shoes on a drum that already slides when the force is applied.

    Attributes
    ----------
    group : the group, with the directions of friction at its abutments in this equilibrium
    contact : the contact of the linings in the equilibrium; None without an equilibrium
    torque : torque [N m], positive against the sense of the brake's rotation
    refusal : the reason why there is no equilibrium; empty with an equilibrium
    """

    group: ShoeGroup
    contact: ContactSolution | None
    torque: float
    refusal: str


class _IncrementsAlongRotationPath(NamedTuple):
    """The increments of a group of shoes as the drum turns through given rotations.

    Attributes
    ----------
    held : the group under the full force, with the drum at rest
    increments : the converged increment at each rotation
    dissipated : energy [J] dissipated up to each rotation
    solve_under_sliding_drum : function that returns the equilibrium on a drum that slides from the
        start; its argument is the sense, +1 or -1, in which all nodes slip
    """

    held: _LoadedGroupAtRest
    increments: list[StickSlipIncrementSolution]
    dissipated: list[float]
    solve_under_sliding_drum: Callable[[int], _SlidingDrumSolution]


class _NodalStatesAlongLining(NamedTuple):
    """Angles, pressures, tractions and states (n,) along the lining of one shoe, and its face.

    n is the number of angles [rad]; pressures and tractions are in Pa. The values become the
    entries of one shoe in a `HoldingState`.
    """

    theta: Floats
    pressure: Floats
    traction: Floats
    state: Ints
    face: ContactNodesOfHeldLiningFace


class _FootSlideWords(NamedTuple):
    """The slide of a foot along its abutment, as words for a note.

    `foot_slide_from_rest` is the slide after the drum has turned from rest, `foot_slide_by_solve`
    the slide by `solve`.
    """

    foot_slide_from_rest: str
    foot_slide_by_solve: str


def turn_holding_brake_and_return_states_at_rotations(
    scene: PreparedModel,
    brake: Brake,
    rotations: Floats,
    *,
    penalty: float = DEFAULT_PENALTY_FACTOR,
    say: Callable[[str], None] = lambda _: None,
) -> list[HoldingState]:
    """Apply the force, turn the drum through rotations, and return the state at each rotation.

    The actuation force grows while the drum rests. If the linings have a gap to close, the force
    grows in as many increments as there are rotations, because the contact under a small force
    decides where a lining sticks. Without a gap one increment of force is exact. Afterwards the
    drum turns to each rotation in one increment, or in several if one does not converge. The error
    of the dissipated energy is proportional to the size of the increments. The moment hardly
    depends on the increments unless the drum turns back. A state at full slip has a note if its
    moment differs from the moment by `solve`.

    Parameters
    ----------
    scene : the prepared model
    brake : the brake
    rotations : rotations (m,) of the drum [rad] from its rest, positive in the sense of the brake's
        rotation
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    say : function that receives a text with the names of the shoes that are solved next

    Raises
    ------
    NoAnswer
        for a shoe that does not touch the drum, for a brake that locks itself (the text states the
        friction limit), if there is no equilibrium, and if an increment does not converge
    BadInput
        for a brake without friction
    """
    paths = []
    for held in _apply_actuation_forces_to_resting_groups(scene, brake, len(rotations), penalty):
        say(f"holding: {held.group.names_of_shoes_as_text}")
        paths.append(_turn_drum_through_rotations(held, rotations))
    return [
        _state_of_brake_at_rotation(brake, paths, k, float(rotation))
        for k, rotation in enumerate(rotations)
    ]


# The following functions apply the actuation force while the drum rests.


def _apply_actuation_forces_to_resting_groups(
    scene: PreparedModel, brake: Brake, increments: int, penalty: float
) -> Iterator[_LoadedGroupAtRest]:
    """Apply the actuation force to each group of shoes while the drum is at rest.

    Yields each loaded group. `increments` is the number of increments in which the force grows.
    Raises NoAnswer and BadInput as `turn_holding_brake_and_return_states_at_rotations` does.
    """
    if brake.friction == 0 or scene.brake.friction == 0:
        raise BadInput(f"friction = {brake.friction:g}: must be greater than 0 for a holding brake")
    # Tractions at rest need the condensed stiffness, so that all flexibilities come from it.
    bodies = map(substructure_with_flexibility_of_condensed_stiffness, scene.bodies)
    scene = replace(scene, bodies=tuple(bodies))
    springs = None
    if any(spring.rate for spring in brake.springs):
        pulls = solve_prepared_model(scene, brake, penalty=penalty).spring_pulls
        springs = spring_nodes_of_brake(brake, pulls)
    touching = indices_of_pressed_shoes_in_brake(scene, brake)
    for i, shoe in enumerate(brake.shoes):
        if i not in touching:
            raise NoAnswer(
                f"shoe {shoe.name!r}: does not touch the drum, so that it cannot hold it"
            )
    shoes = list(range(len(brake.shoes)))
    for group in divide_shoes_into_groups(scene, brake, shoes, penalty, springs_join=True):
        yield _apply_actuation_force_to_resting_group(group, increments, springs)


def _apply_actuation_force_to_resting_group(
    group: ShoeGroup, increments: int, springs: SpringNodes | None
) -> _LoadedGroupAtRest:
    """Apply the actuation force to a group of shoes in increments while the drum is at rest.

    The pulls of `springs` with a rate come on together with the force. Raises NoAnswer as
    `turn_holding_brake_and_return_states_at_rotations` does.
    """
    under = group if springs is None else group_under_spring_pulls(group, None)
    problem, lever = make_stick_slip_problem_and_slip_per_drum_rotation(under, springs)
    feet = FeetOnRoughAbutments.collect_feet_on_rough_abutments(group)
    further = 0 if springs is None else len(springs.numbers)
    count = len(feet.indices_of_shoes_on_rough_abutments)
    starts = [
        np.append(states, np.full(further, FORWARD))
        for states in _first_guesses_of_states_at_rest(group, feet)
    ]
    size = under.largest_actuation_force
    unit_gaps = np.concatenate(group.gaps_of_unloaded_linings) / size
    clearances = [support.clearance for support in group.one_sided_supports]
    gap = np.concatenate(
        [
            group.mass_matrix_of_contact_nodes @ unit_gaps,
            np.zeros(count),
            np.array(clearances) / size,
            np.zeros(further),
        ]
    )
    constant = np.append(feet.friction_coefficients_of_all_nodes(), np.zeros(further))
    friction: NodesFriction = constant
    if any(
        len(group.brake.friction_coefficient_curve_of_shoe(shoe).mu) > 1 for shoe in group.shoes
    ):
        friction = partial(_friction_of_lining_and_further_nodes, under, constant)
    try:
        rest, spent = _increase_actuation_force_from_first_guess_that_converges(
            partial(_increase_actuation_force_at_rest, problem, gap, friction), starts, increments
        )
    except NoAnswer as error:
        # On a brake that locks itself, `solve_shoe_group_with_lining_friction` raises a NoAnswer
        # that states the friction limit. This error replaces the error below.
        solve_shoe_group_with_lining_friction(group)
        raise NoAnswer(f"{group.names_of_shoes_as_text}: {error}, the drum at rest") from error
    per_rotation = lever * (group.brake.sign_of_motion / size)
    return _LoadedGroupAtRest(under, problem, per_rotation, friction, rest, spent, springs)


def _first_guesses_of_states_at_rest(group: ShoeGroup, feet: FeetOnRoughAbutments) -> list[Ints]:
    """The states (n,) of all nodes but springs from which the first load increment may start.

    A solution without friction gives these states. Nodes of linings that touch in this solution
    stick, and all feet stick. One-sided supports that bear in this solution slip, and all other
    supports are open. In the first guess a support with a clearance is open too: friction may hold
    the shoe before it comes to the support. In the second guess the shoe has come to it.
    """
    smooth = replace(
        group, brake=feet.brake_with_smooth_abutments(0.0), abutment_friction_directions_of_shoes=()
    )
    if group.one_sided_supports:
        smooth, contact = smooth.solve_contact_and_abutment_friction()
    else:
        contact = smooth.solve_contact_for_given_abutment_friction()
    touching = np.where(contact.active, STICK, OPEN)
    sticking = np.full(len(feet.indices_of_shoes_on_rough_abutments), STICK)
    bears = np.array(smooth.bearing, dtype=bool)
    has_clearance = np.array([each.clearance > 0 for each in smooth.one_sided_supports], dtype=bool)
    choices = [bears & ~has_clearance]
    if (bears & has_clearance).any():
        choices.append(bears)
    return [
        np.concatenate([touching, sticking, np.where(bearing, FORWARD, OPEN)])
        for bearing in choices
    ]


def _friction_of_lining_and_further_nodes(
    group: ShoeGroup, constant: Floats, p: Floats
) -> NodalFrictionAndSlope:
    """The friction of all nodes at pressures p (n,) per newton of the group's actuation force.

    Nodes after the lining nodes have the coefficients of `constant` (n,).
    """
    size, n = group.largest_actuation_force, len(group.contact_node_areas)
    found = friction_and_its_slopes_at_nodes_of_group(group, size * p[:n])
    coefficient = np.append(found.coefficient, constant[n:])
    return NodalFrictionAndSlope(coefficient, np.append(size * found.slope, 0 * constant[n:]))


def _solve_load_increment(
    problem: StickSlipProblem,
    friction: NodesFriction,
    history: TractionsAndSlipsOfLastIncrement,
    state: Ints,
    p: Floats,
) -> StickSlipIncrementSolution:
    """Solve a load increment under friction that may depend on the pressure.

    `state` and `p` (n,) are the states and pressures from which the iteration starts.
    """
    if callable(friction):
        return solve_stick_slip_increment_with_pressure_dependent_friction(
            problem, friction, history, state, p
        )
    return stick_slip.solve_stick_slip_load_increment(problem, friction, history, state)


def _increase_actuation_force_from_first_guess_that_converges(
    increase: Callable[[Ints, int], tuple[StickSlipIncrementSolution, float]],
    starts: Sequence[Ints],
    increments: int,
) -> tuple[StickSlipIncrementSolution, float]:
    """The result of `increase` from the first of several guesses from which it converges.

    `increase` is a function of the states from which the first increment starts, and of the number
    of increments. Raises the NoAnswer of the last guess if none converges.
    """
    *others, last = starts
    for start in others:
        with suppress(NoAnswer):
            return increase(start, increments)
    return increase(last, increments)


def _increase_actuation_force_at_rest(
    problem: StickSlipProblem, gap: Floats, friction: NodesFriction, state: Ints, increments: int
) -> tuple[StickSlipIncrementSolution, float]:
    """Increase the actuation force to its full value while the drum rests.

    Without gaps all quantities are proportional to the force, and one increment is exact. With gaps
    the force after increment number i is proportional to i^3, because the contact changes most
    under a small force. Under a very small force only one or two nodes are in contact, and an
    increment may not converge. Such an increment is joined with the next increment.

    Parameters
    ----------
    problem : the stick-slip problem under the full force
    gap : weighted gaps (n,) of the unloaded linings: integrals of the gap times each node's shape
        function
    friction : friction coefficient (n,) of each node, or a function of the pressures
    state : states (n,) of the nodes from which the first increment starts
    increments : number of increments

    Returns
    -------
    the increment at whose end the full force acts, and the energy [J/N^2] dissipated by slip

    Raises
    ------
    NoAnswer
        if the last increment does not converge
    """
    history = TractionsAndSlipsOfLastIncrement(np.zeros(len(gap)), np.zeros(len(gap)))
    energy, p = 0.0, np.zeros(len(gap))
    # Without a gap, the force is applied in one increment.
    shares = np.ones(1)
    if gap.any():
        shares = np.linspace(0, 1, max(increments, 1) + 1)[1:] ** 3
    for share in shares:
        q_w = gap + share * (problem.q_w - gap)
        part = problem._replace(q_w=q_w, q_s=share * problem.q_s, h=share * problem.h)
        try:
            increment = _solve_load_increment(part, friction, history, state, p)
        except NoAnswer:
            if share == 1:
                raise
            continue
        energy += _energy_dissipated_by_slip_per_squared_force(problem, increment, history)
        history, state = increment.tractions_and_slips_for_next_increment, increment.state
        p = increment.p
    return increment, energy


# The following functions turn the drum under the full actuation force.


def _turn_drum_through_rotations(
    held: _LoadedGroupAtRest, rotations: Floats
) -> _IncrementsAlongRotationPath:
    """Turn the drum under a loaded group through rotations (m,) [rad], one after the other.

    Raises NoAnswer as `turn_holding_brake_and_return_states_at_rotations` does.
    """
    group, brake = held.group, held.group.brake
    increment, reached = held.rest, 0.0
    energy = held.dissipated
    increments, spent = [], []
    for rotation in rotations:
        try:
            for step in held.turn_drum_from_start_to_end_rotation(
                increment, reached, float(rotation)
            ):
                energy += _energy_dissipated_by_slip_per_squared_force(
                    held.problem, step, increment.tractions_and_slips_for_next_increment
                )
                increment = step
        except NoAnswer as error:
            # On a brake that locks itself, `solve_shoe_group_with_lining_friction` raises a
            # NoAnswer with the friction limit. This error replaces the error below.
            turning = brake if rotation > reached else brake.brake_with_reversed_motion()
            solve_shoe_group_with_lining_friction(
                _shoe_group_with_other_rotation_or_friction(group, turning)
            )
            raise NoAnswer(
                f"{group.names_of_shoes_as_text}: {error}, turned by {rotation:.3g} rad"
            ) from error
        reached = float(rotation)
        increments.append(increment)
        spent.append(energy * group.largest_actuation_force**2)
    return _IncrementsAlongRotationPath(
        held, increments, spent, cache(partial(_solve_contact_under_sliding_drum, held))
    )


def turn_drum_in_increments(
    problem: StickSlipProblem,
    lever: Floats,
    friction: NodesFriction,
    increment: StickSlipIncrementSolution,
    start: float,
    end: float,
) -> Iterator[StickSlipIncrementSolution]:
    """Turn the drum from one rotation to another, and yield each converged increment.

    The whole turn is one increment if the states of the nodes (open, stick, slip) converge. If the
    states do not converge, the turn is halved up to MAX_HALVINGS_OF_ROTATION_INCREMENT times, and
    its parts are the increments.

    Parameters
    ----------
    problem : the stick-slip problem while the drum rests
    lever : growth (n,) of the nodes' weighted slips q_s per radian of drum rotation
    friction : one coefficient for all nodes, coefficients (n,), or a function of the pressures
    increment : the converged increment at the rotation `start`
    start, end : rotations [rad]

    Raises
    ------
    NoAnswer
        if the states of the nodes do not converge in the smallest part
    """
    # If `start` equals `end`, the state at this rotation is still solved once.
    reached, pieces = start, 1
    while reached != end or start == end:
        step = end if pieces == 1 else reached + (end - reached) / pieces
        moved = problem._replace(q_s=problem.q_s + lever * step)
        try:
            increment = _solve_load_increment(
                moved,
                friction,
                increment.tractions_and_slips_for_next_increment,
                increment.state,
                increment.p,
            )
        except NoAnswer:
            if pieces >= 2**MAX_HALVINGS_OF_ROTATION_INCREMENT:
                raise
            pieces *= 2
            continue
        yield increment
        if step == end:
            return
        reached, pieces = step, pieces - 1


def _shoe_group_with_other_rotation_or_friction(group: ShoeGroup, brake: Brake) -> ShoeGroup:
    """The group of shoes on a brake with another rotation or friction of its drum.

    The directions of friction at rough abutments become unknown, since feet may slide the other
    way.
    """
    return replace(
        group,
        brake=brake,
        abutment_friction_directions_of_shoes=()
        if group.has_abutment_with_friction
        else group.abutment_friction_directions_of_shoes,
    )


def _energy_dissipated_by_slip_per_squared_force(
    problem: StickSlipProblem,
    after: StickSlipIncrementSolution,
    before: TractionsAndSlipsOfLastIncrement,
) -> float:
    """The energy dissipated by slip in an increment, per squared actuation force [J/N^2].

    It is computed with the tractions at the end of the increment.
    """
    # The compliance Q of the penalty contact adds elastic slip, which dissipates no energy.
    slip = after.s - before.s - problem.Q @ (after.t - before.t)
    return float(after.t @ slip)


def _state_of_brake_at_rotation(
    brake: Brake, paths: list[_IncrementsAlongRotationPath], k: int, rotation: float
) -> HoldingState:
    """The state of the whole brake at rotation number `k`, from the increments of its groups."""
    linings: dict[int, _NodalStatesAlongLining] = {}
    torque, dissipated = 0.0, 0.0
    notes: list[str] = []
    pulls: tuple[float, ...] = ()
    for path in paths:
        pulls = path.held.pulls_of_springs(path.increments[k])
        dissipated += path.dissipated[k]
        notes += _notes_if_moment_differs_from_solve(path, k)
        notes += _notes_on_shoes_without_contact_force(path, k)
        torque += path.held.torque(path.increments[k])
        linings |= _nodal_contact_states_of_linings(path.held.group, path.increments[k])
    order = sorted(linings)
    theta, pressure, traction, state, face = zip(*(linings[i] for i in order), strict=True)
    if any(path.held.group.prepared_model.model == "solid" for path in paths):
        notes.append(NOTE_ON_NEGLECTED_FRICTION_ACROSS_WIDTH)
    arcs = list(map(stick_slip.sticking_and_slipping_arcs_of_lining, theta, state))
    return HoldingState(
        rotation=rotation,
        torque=torque,
        names=tuple(brake.shoes[i].name for i in order),
        theta=theta,
        pressure=pressure,
        traction=traction,
        state=state,
        stick=tuple(arc["stick"] for arc in arcs),
        slip=tuple(arc["slip"] for arc in arcs),
        dissipated=dissipated,
        face=face,
        notes=tuple(notes),
        spring_pulls=pulls,
    )


def _nodal_contact_states_of_linings(
    group: ShoeGroup, at: StickSlipIncrementSolution
) -> dict[int, _NodalStatesAlongLining]:
    """The nodal states of each shoe's lining at an increment, by the shoe's index in the brake."""
    size = group.largest_actuation_force
    states = {}
    for k, part in enumerate(group.contact_node_slices_of_shoes):
        frame = group.shoes[k].frame
        # The nodes are put in the order of increasing theta. They are reversed if the shoe's frame
        # is mirrored.
        forward = slice(None, None, frame.sense)
        line = group.substructures_of_shoes[k].line
        shares = line.width_fraction_of_each_node_across_width
        shape = -1, len(shares)
        phi, _ = line.angles_and_pressures_averaged_over_width(at.p[part])
        face = ContactNodesOfHeldLiningFace(
            line.node_distances_from_mid_plane,
            size * at.p[part].reshape(shape)[forward],
            size * at.t[part].reshape(shape)[forward],
            at.state[part].reshape(shape)[forward],
        )
        states[group.members[k]] = _NodalStatesAlongLining(
            frame.surface_coordinates_of_phi(phi)[forward],
            face.pressure @ shares,
            face.traction @ shares,
            stick_slip_state_at_each_angle_of_lining(face.state),
            face,
        )
    return states


def stick_slip_state_at_each_angle_of_lining(state: Ints) -> Ints:
    """The state (n,) at each angle of a lining, from the states (n, m) of nodes across the width.

    It is the first state in STICK_SLIP_STATES_IN_ORDER_OF_PRECEDENCE that a node at this angle has,
    or OPEN.
    """
    found = np.full(len(state), OPEN)
    for kind in reversed(STICK_SLIP_STATES_IN_ORDER_OF_PRECEDENCE):
        found[(state == kind).any(axis=1)] = kind
    return found


# The following functions compare full slip with `solve`, and find the rotation to full slip.


def _solve_contact_under_sliding_drum(held: _LoadedGroupAtRest, sense: int) -> _SlidingDrumSolution:
    """The equilibrium of a group of shoes on a drum that already slides when the force is applied.

    `sense` +1 or -1 is the sense in which the nodes slip.
    """
    brake = held.group.brake
    group = _shoe_group_with_other_rotation_or_friction(
        held.group, brake if sense == brake.sign_of_motion else brake.brake_with_reversed_motion()
    )
    try:
        if held.springs is not None:
            # The group has the pulls that its springs have in `solve`.
            solved = solve_prepared_model(group.prepared_model, group.brake, penalty=group.penalty)
            group = group_under_spring_pulls(group, solved.spring_pulls)
        group, contact = solve_shoe_group_with_lining_friction(group)
    except NoAnswer as error:
        return _SlidingDrumSolution(group, None, math.nan, str(error))
    torque = (
        brake.friction
        * group.largest_actuation_force
        * float(group.torque_of_each_shoe_per_nodal_pressure.sum(axis=1) @ contact.p)
    )
    return _SlidingDrumSolution(group, contact, sense * brake.sign_of_motion * torque, "")


def _notes_if_moment_differs_from_solve(path: _IncrementsAlongRotationPath, k: int) -> list[str]:
    """A note with both moments, if the moment at full slip differs from the moment by `solve`.

    The list is empty if the moments agree, and at partial slip. `k` is the number of the rotation.
    """
    held, at = path.held, path.increments[k]
    sense = _sense_of_full_slip_or_zero(held, at)
    if sense == 0:
        return []
    torque, sliding = held.torque(at), path.solve_under_sliding_drum(sense)
    if math.isclose(torque, sliding.torque, rel_tol=LARGEST_TORQUE_DIFFERENCE_OF_SAME_EQUILIBRIUM):
        return []
    surface = held.group.brake.surface
    unit, moving = surface.unit_of_torque_or_brake_force, surface.name_of_moving_body
    text = (
        f"{held.group.names_of_shoes_as_text}: at full slip the "
        f"{surface.word_for_torque_or_brake_force} is {torque:.6g} {unit}"
    )
    if sliding.contact is None:
        return [f"{text}; solve has none: {sliding.refusal}"]
    text += f", by solve {sliding.torque:.6g} {unit}"
    feet = _abutments_whose_friction_differs_from_solve(held, at, sliding.group, sliding.contact)
    if not feet:
        return [f"{text}: more than one answer"]
    ends, places = map(" and ".join, zip(*feet, strict=True))
    return [
        f"{text}: the force came on while the {moving} was at rest and left {ends} along its "
        f"abutment from where it was without force; in solve the {moving} moves already as the "
        f"force comes on, which leaves it at {places}"
    ]


def _notes_on_shoes_without_contact_force(path: _IncrementsAlongRotationPath, k: int) -> list[str]:
    """A note for each shoe on anchors that its supports hold off the drum at rotation number `k`.

    The pressure on the lining of such a shoe is round-off.
    """
    group, p = path.held.group, path.increments[k].p
    peak = float(np.max(p[: path.held.number_of_lining_nodes]))
    return [
        note_on_shoe_held_off_by_its_supports(shoe)
        for shoe, part in zip(group.shoes, group.contact_node_slices_of_shoes, strict=True)
        if shoe.anchors and np.max(p[part]) <= LARGEST_ROUND_OFF_CONTACT_FORCE * peak
    ]


def _sense_of_full_slip_or_zero(held: _LoadedGroupAtRest, at: StickSlipIncrementSolution) -> int:
    """The sense, +1 or -1, in which all touching nodes of the linings slip.

    It is 0 if some touching nodes stick, or slip the other way.
    """
    touching = set(at.state[: held.number_of_lining_nodes].tolist()) - {OPEN}
    return int(touching == {FORWARD}) - int(touching == {BACKWARD})


def _abutments_whose_friction_differs_from_solve(
    held: _LoadedGroupAtRest,
    at: StickSlipIncrementSolution,
    group: ShoeGroup,
    contact: ContactSolution,
) -> list[_FootSlideWords]:
    """The slides of feet whose ratio of friction to normal force differs from the ratio by `solve`.

    Parameters
    ----------
    held : the group whose drum was turned from rest
    at : the increment at full slip
    group, contact : the equilibrium of the group on a drum that slides from the start
    """
    size, feet = held.group.largest_actuation_force, []
    numbers = FeetOnRoughAbutments.collect_feet_on_rough_abutments(
        held.group
    ).indices_of_shoes_on_rough_abutments
    for node, k in enumerate(numbers, start=held.number_of_lining_nodes):
        shoe = group.shoes[k]
        x, y = group.abutment_force_on_shoe(contact, k)
        # The force on the foot has a component normal to the abutment and another along it.
        bearing, along = (
            float(shoe.unit_vector_of_smooth_abutment_force @ (x, y)),
            float(shoe.unit_vector_of_smooth_abutment_force @ (y, -x)),
        )
        if at.p[node] > 0:
            difference = abs(at.t[node] / at.p[node] - along / bearing)
            if difference <= LARGEST_FOOT_FRICTION_RATIO_DIFFERENCE:
                continue
        slide = (
            float(group.rigid_body_coordinates_of_each_shoe(contact)[k][-1])
            if group.known_abutment_friction_directions[k]
            else 0.0
        )
        # The slip of a node is the negative of the slide of its foot. The subtraction from 0.0, in
        # place of a minus sign, keeps the text from showing -0.
        foot_slide_from_rest = f"{1e6 * size * (0.0 - at.s[node]):.6g} µm"
        foot_slide_by_solve = f"{1e6 * size * slide:.6g} µm"
        feet.append(
            _FootSlideWords(
                f"the foot of shoe {shoe.name!r} {foot_slide_from_rest}", foot_slide_by_solve
            )
        )
    return feet


def find_drum_rotation_of_full_slip(
    scene: PreparedModel,
    brake: Brake,
    *,
    increments: int = 20,
    penalty: float = DEFAULT_PENALTY_FACTOR,
) -> float:
    """Find a rotation of the drum [rad] after which every touching node slips.

    The moment at this rotation is the moment of `solve`, unless a foot sticks on a rough abutment.

    Parameters
    ----------
    scene : the prepared model
    brake : the brake
    increments : number of increments in which the actuation force grows before the drum turns
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)

    Raises
    ------
    NoAnswer
        for a brake that locks itself (the text states the friction limit), for a shoe that does not
        touch the drum, and if the search does not converge
    """
    shoes = solve_prepared_model(scene, brake, penalty=penalty).shoes
    ends = []
    for held in _apply_actuation_forces_to_resting_groups(scene, brake, increments, penalty):
        target = sum(shoes[i].torque for i in held.group.members)
        slipping = FORWARD if brake.sign_of_motion > 0 else BACKWARD
        try:
            ends.append(_find_drum_rotation_of_full_slip_of_group(held, target, slipping))
        except NoAnswer as error:
            raise NoAnswer(f"{held.group.names_of_shoes_as_text}: {error}") from error
    return (1 + MARGIN_OF_FULL_SLIP_ROTATION) * max(ends)


def _find_drum_rotation_of_full_slip_of_group(
    held: _LoadedGroupAtRest, target: float, slipping: int
) -> float:
    """Find a rotation of the drum [rad] after which all touching nodes of a group slip.

    Parameters
    ----------
    held : the group under the full force, with the drum at rest
    target : moment [N m] on a drum that slides from the start, as in `solve`
    slipping : the state of the nodes at full slip, FORWARD or BACKWARD

    Raises
    ------
    NoAnswer
        if the moment at full slip differs from the target, and if no rotation is found
    """
    increment, reached = held.rest, 0.0
    step, n = FIRST_ROTATION_OF_FULL_SLIP_SEARCH, held.number_of_lining_nodes
    for _ in range(MOST_INCREMENTS_OF_FULL_SLIP_SEARCH):
        last, before = increment, held.torque(increment)
        *_, increment = held.turn_drum_from_start_to_end_rotation(last, reached, reached + step)
        torque = held.torque(increment)
        if _do_touching_nodes_of_linings_slip(held, increment, slipping):
            if _is_moment_of_full_slip_as_by_solve(held, increment, target):
                return _narrow_rotation_of_full_slip(
                    held, last, (reached, reached + step), target, slipping
                )
            raise NoAnswer(
                f"more than one answer: held it comes to slip everywhere at {torque:.5g} N m, "
                f"at once it slides at {target:.5g} N m"
            )
        reached += step
        # By linear extrapolation the missing moment needs another rotation of `lacking` times the
        # last step.
        lacking = (target - torque) / (torque - before) if torque > before else math.inf
        step = min(
            max(step * lacking, MARGIN_OF_FULL_SLIP_ROTATION * reached),
            reached / MARGIN_OF_FULL_SLIP_ROTATION,
        )
    sticking = np.count_nonzero(increment.state[:n] == STICK)
    raise NoAnswer(
        f"not converged: after a rotation of {reached:.3g} rad "
        f"{sticking} of {n} nodes still stick, "
        f"at {torque:.5g} of the sliding drum's {target:.5g} N m"
    )


def _do_touching_nodes_of_linings_slip(
    held: _LoadedGroupAtRest, increment: StickSlipIncrementSolution, slipping: int
) -> bool:
    """Whether all touching nodes of the linings have the state `slipping`, FORWARD or BACKWARD."""
    states = increment.state[: held.number_of_lining_nodes]
    return bool(np.isin(states, [OPEN, slipping]).all())


def _is_moment_of_full_slip_as_by_solve(
    held: _LoadedGroupAtRest, increment: StickSlipIncrementSolution, target: float
) -> bool:
    """Whether the moment at full slip is the moment `target` [N m] by `solve`, or may differ.

    The friction of a sticking foot depends on whether the force is applied before the drum turns,
    so that the moment of a brake with rough abutments may differ.
    """
    springs = 0 if held.springs is None else len(held.springs.numbers)
    has_feet = len(increment.state) > held.number_of_lining_nodes + springs
    return has_feet or math.isclose(
        held.torque(increment), target, rel_tol=LARGEST_TORQUE_DIFFERENCE_OF_SAME_EQUILIBRIUM
    )


def _narrow_rotation_of_full_slip(
    held: _LoadedGroupAtRest,
    increment: StickSlipIncrementSolution,
    rotations: tuple[float, float],
    target: float,
    slipping: int,
) -> float:
    """Find a rotation of the drum [rad] at which the touching nodes have just come to slip.

    It is larger than a rotation without full slip by a fraction MARGIN_OF_FULL_SLIP_ROTATION at
    most. While a shoe moves through the clearance of its anchor, the moment hardly grows. The
    extrapolation of the moment then leads far beyond the rotation to full slip.

    Parameters
    ----------
    held : the group under the full force
    increment : the converged increment at the first of two `rotations` [rad]
    rotations : a rotation before full slip, and a larger one at full slip
    target, slipping : moment [N m] and state of the nodes at full slip
    """
    before, full = rotations
    # The small addition keeps round-off from asking for a narrower range than the search leaves.
    while full - before > MARGIN_OF_FULL_SLIP_ROTATION * before * (1 + 1e-9) and before > 0:
        middle = math.sqrt(before * full)
        *_, found = held.turn_drum_from_start_to_end_rotation(increment, before, middle)
        if _do_touching_nodes_of_linings_slip(
            held, found, slipping
        ) and _is_moment_of_full_slip_as_by_solve(held, found, target):
            full = middle
        else:
            before, increment = middle, found
    return full


# The following functions convert the states to plain data for JSON.


def holding_states_as_plain_data(states: list[HoldingState]) -> list[dict[str, Any]]:
    """Convert the states of a holding brake to plain data for JSON, in rad, N m, Pa and J.

    The state of each node is a word: "open", "stick", "slip" or "slip back".
    """
    rows = []
    for state in states:
        shoes = [_stick_slip_state_of_lining_as_dict(state, i) for i in range(len(state.names))]
        row = {
            "rotation": state.rotation,
            "torque": state.torque,
            "dissipated": state.dissipated,
            "notes": list(state.notes),
            **({"spring_pulls": list(state.spring_pulls)} if state.spring_pulls else {}),
            "shoes": shoes,
        }
        rows.append(row)
    return rows


def _stick_slip_states_as_words(states: Ints) -> list[str]:
    """A word for the state of each node: "open", "stick", "slip" or "slip back"."""
    names = {OPEN: "open", STICK: "stick", FORWARD: "slip", BACKWARD: "slip back"}
    return [names[int(state)] for state in states]


def _stick_slip_state_of_lining_as_dict(state: HoldingState, i: int) -> dict[str, Any]:
    """Convert the nodal values of shoe `i` in a state of the brake to plain data for JSON.

    If there are several nodes across the width, the key "face" has the values at all of them.
    """
    face = state.face[i]
    across = {
        "z": face.z.tolist(),
        "pressure": face.pressure.tolist(),
        "traction": face.traction.tolist(),
        "state": [_stick_slip_states_as_words(row) for row in face.state],
    }
    return {
        "name": state.names[i],
        "theta": state.theta[i].tolist(),
        "pressure": state.pressure[i].tolist(),
        "traction": state.traction[i].tolist(),
        "state": _stick_slip_states_as_words(state.state[i]),
        "stick": [list(arc) for arc in state.stick[i]],
        "slip": [list(arc) for arc in state.slip[i]],
        **({"face": across} if len(face.z) > 1 else {}),
    }
