"""The finite-element model: from a prepared model to the response of the brake.

`make_prepared_model` does the work that depends on geometry and stiffness. `solve_prepared_model`
does the work that depends on friction, rotation, force, line of action, clearance and penalty, in
milliseconds on the same prepared model.
"""

import math
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.base.errors import AnswerLostToRoundOff, BadInput, NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import ShoeBodyOfConstantSection
from drumlin.brake.heat import note_on_heated_parts_of_brake
from drumlin.brake.one_sided import OneSidedSupportForce, note_on_shoe_held_off_by_its_supports
from drumlin.brake.units import length_as_text_in_mm
from drumlin.contact.active_set import ContactSolution
from drumlin.fem.equilibrium.group import ShoeGroup, divide_pressed_shoes_into_groups
from drumlin.fem.equilibrium.modes import pin_motions_in_rigid_body_motions
from drumlin.fem.equilibrium.pressure_friction import solve_shoe_group_with_lining_friction
from drumlin.fem.equilibrium.sharing import (
    ERROR_TEXT_ON_CAM_OR_STRUT_THAT_WOULD_PULL,
    LARGEST_STRUT_OR_CAM_FORCE_COUNTED_AS_ZERO,
)
from drumlin.fem.equilibrium.springs import (
    displacements_of_spring_points_along_pulls,
    find_spring_pulls_that_fit_shoe_motions,
    notes_on_spring_pulls,
)
from drumlin.fem.error_control.singular_points import reason_if_contact_is_too_short
from drumlin.fem.mesh.from_file import notes_on_mesh_file
from drumlin.fem.preparation.bodies import (
    force_resultant_of_unit_load_factors,
    moment_of_loads_besides_actuation_about_pin,
    unit_load_factors_of_one_sided_support_push,
    unit_load_factors_under_all_loads,
)
from drumlin.fem.preparation.cache import cache_key_of_shoe_shape
from drumlin.fem.preparation.load_places import has_unit_loads_of_forces_at_points_or_mass
from drumlin.fem.preparation.scene import PreparedModel, add_elapsed_time_of_block_to_phase
from drumlin.laws.rigid import notes_on_cam_force_of_unlike_linings
from drumlin.response.balance import (
    largest_imbalance_among_shoes,
    moments_that_scale_imbalance_on_guide,
    relative_magnitudes_of_force_and_moment_sums,
)
from drumlin.response.response import (
    LARGEST_NEUTRAL_FRICTION_OVER_PRESSURE_WORK,
    ForceAndMomentImbalance,
    RelativeChangesOfShoeResults,
    Response,
    ShoeResponse,
    length_of_uncompared_edge_zone,
    notes_on_forces_of_one_sided_supports,
    reference_force_of_reaction_errors,
    response_of_pressed_elastic_shoe,
    response_of_shoe_without_contact,
)
from drumlin.response.resultants import planar_cross_product

if TYPE_CHECKING:
    from drumlin.fem.error_control.refinement import RefinedSolutionOfShoeGroup

RELATIVE_SPACING_OF_DOUBLES = float(np.finfo(float).eps)
"""Relative spacing of double-precision numbers, 2.2e-16.

For a solution that iterative refinement has corrected, the stated relative error is at least this
spacing.
"""
LONG_DOUBLE_IS_WIDER = float(np.finfo(np.longdouble).eps) < RELATIVE_SPACING_OF_DOUBLES
"""Whether long double has more digits than double, so that iterative refinement gains digits.

On Windows and on Macs with Apple's processors both are the same. A refinement there would state a
round-off error that is up to 25 times too small: its residuals do not see the digits that the
stiffness itself has lost. Soft shoes are then solved without refinement, or refused.
"""
LARGEST_SILENT_OVERLAP_OVER_LINING_THICKNESS = 0.01
"""Largest overlap of drum and shoe, in lining thicknesses, that causes no warning.

The overlap arises if the mesh in a shoe's mesh file reaches into the drum. A larger overlap
squeezes the lining noticeably before any force acts, and a warning is printed. The value changes no
result.
"""
DEFAULT_PENALTY_FACTOR = 1e8
"""Default penalty factor alpha: the contact stiffness per area is alpha E/t.

E is the modulus of the lining, t its thickness, and p the pressure. With the default the lining
penetrates the drum by 1e-8 of its own compression p t/E. The relative error of the pressure is
about 1e-8 as well, or more if the contact is short compared with the lining's thickness. Each
response states this error.
"""
LARGEST_ACCEPTED_FORCE_IMBALANCE_OF_SHOE = 1e-8
"""Largest imbalance of forces and moments on a shoe, relative to the largest force or moment.

A larger imbalance shows that round-off in the condensed bodies has cost too many digits. The full
(not condensed) system is then solved by iterative refinement. If the imbalance is above the limit
even after the refinement, the solution is refused.
"""
LARGEST_ACCEPTED_FORCE_IMBALANCE_OF_SOLID_SHOE = 1e-5
"""The same limit for solid shoes, which are not refined.

The errors that solid shoes state contain the imbalance. On "free" 510149 of
`drumlin_studies.solid_error`, a short contact at the end of a lining, it is 1.1e-8 on the third
level. The value is a judgement: a hundredth of the smallest tolerance that solid shoes mostly
reach. The refusal prints the imbalance.
"""
LARGEST_PRESSURE_ROUND_OFF_LEFT_UNREFINED = 1e-5
"""Relative round-off error of the pressure up to which a solution needs no refinement.

On elements of degree 1 or 2 the value is also the largest round-off error that is accepted after a
refinement: a solve on these elements states no error, so that a solution with a larger round-off
error is refused. The discretisation error of such a solve is some hundred times larger than the
value. On hp elements the stated error includes the round-off error. The value is a judgement, and
the refusal prints the round-off error.
"""
LARGEST_ACCEPTED_PRESSURE_ROUND_OFF = 1e-3
"""Relative round-off error of the pressure up to which a solution on hp elements is accepted.

The value holds for solutions that have been refined and for solutions that cannot be refined. Their
stated error contains the round-off error. A solution with a larger round-off error is refused. The
value is a judgement, and the refusal prints the round-off error.
"""
LARGEST_SIZE_OF_REFINED_SYSTEM = 240_000
"""Largest size of a group of shoes whose full system is solved by iterative refinement.

The size is the number of unknowns times the squared polynomial degree of the elements. The
iterative refinement of a group of this size takes seconds. The sparse factors of larger systems of
high degree have so many entries that they take too long.
"""
LARGEST_CORRECTION_OF_CONVERGED_REFINEMENT = 1e-10
"""Last relative correction of the pressures up to which an iterative refinement has converged.

The full system has two forms: its displacements include the rigid-body motion of the shoe or are
relative to it. If the last correction in one form is larger than this limit, the other form is
refined as well, and the solution with the smaller last correction is used.
"""
ROUND_OFF_TOO_LARGE_REASON = "stiffnesses or sizes are too far apart for the arithmetic"
"""Reason that is printed if a solution has lost too many digits by round-off."""
NO_LONG_DOUBLE_REASON = "this computer has no long double, in which drumlin refines such shoes"
"""Reason that is added where a computer with long double would have refined the solution."""
SOLID_SHOES_NOT_REFINED_REASON = "drumlin does not refine solid shoes"
"""Reason that is added where shoes of plane stress would have been refined."""
ITERATIVE_REFINEMENT_REMARK = "refined in the whole system, condensed it loses digits"
"""Remark printed with a solution that was corrected by iterative refinement of the full system."""


def solve_prepared_model(
    scene: PreparedModel,
    brake: Brake,
    *,
    penalty: float = DEFAULT_PENALTY_FACTOR,
    start: Response | None = None,
) -> Response:
    """Solve a brake on a prepared model of the same geometry and stiffness.

    Returns the response of the brake.

    Parameters
    ----------
    scene : the prepared model
    brake : the brake; its friction, rotation, load and clearance may differ from the model's
    penalty : factor alpha of the contact stiffness alpha E/t per area; math.inf for exact contact
    start : response of a similar brake or on another mesh, whose contact is the first guess; it
        saves steps and does not change the result

    Raises
    ------
    BadInput
        for a brake whose geometry or stiffness is not that of the prepared model
    NoAnswer
        if the brake locks itself, has no equilibrium, or the contact does not converge
    """
    require_positive_penalty(penalty)
    if brake is not scene.brake:
        _check_brake_matches_prepared_model(scene, brake)
    if not any(spring.rate for spring in brake.springs):
        return _solve_response_and_spring_motions_under_known_pulls(scene, brake, penalty, start)[0]
    response, pulls = find_spring_pulls_that_fit_shoe_motions(
        brake,
        lambda under: _solve_response_and_spring_motions_under_known_pulls(
            scene, under, penalty, start
        ),
    )
    notes = (*response.notes, *notes_on_spring_pulls(brake, pulls))
    return replace(response, spring_pulls=pulls, notes=notes)


def _solve_response_and_spring_motions_under_known_pulls(
    scene: PreparedModel, brake: Brake, penalty: float, start: Response | None
) -> tuple[Response, Floats]:
    """Solve a brake whose spring forces (pulls) are known; parameters as in `solve_prepared_model`.

    Returns the response, and the motion (springs,) [m] by which the two points of each spring come
    nearer to each other.
    """
    seconds = dict(scene.seconds)
    with add_elapsed_time_of_block_to_phase(seconds, "contact"):
        answers: dict[int, _ShoeResponseAndImbalance] = {}
        for group in divide_pressed_shoes_into_groups(scene, brake, penalty):
            answers |= _solve_group_of_coupled_shoes(group, start)
        # The shoes that belong to no group are not pressed on the drum.
        for i in set(range(len(brake.shoes))) - set(answers):
            answers[i] = _result_of_shoe_not_pressed_on_drum(brake.shoes[i])
    in_order = [answers[i] for i in sorted(answers)]
    approach = np.zeros(len(brake.springs))
    for answer in in_order:
        approach += answer.spring_motion
    response = Response(
        model=scene.model,
        shoes=tuple(answer.response for answer in in_order),
        balance=largest_imbalance_among_shoes([answer.balance for answer in answers.values()]),
        iterations=max(answer.steps for answer in in_order),
        seconds=seconds,
        left_out=scene.left_out,
        notes=(
            *_warnings_on_overlap_of_mesh_and_drum(scene, brake),
            *_notes_on_mesh_files(scene, brake, [answer.response for answer in in_order]),
            *(answer.note for answer in in_order),
            *notes_on_forces_of_one_sided_supports([answer.response for answer in in_order]),
            *_notes_on_supports_of_shoe_bodies(brake),
            *_notes_on_loads_moved_to_actuation_point(scene, brake),
            *notes_on_cam_force_of_unlike_linings(brake),
            *filter(None, [note_on_heated_parts_of_brake(brake)]),
        ),
    )
    return response, approach


def _check_brake_matches_prepared_model(scene: PreparedModel, brake: Brake) -> None:
    """Raise BadInput if the bodies of a brake differ from those of a prepared model."""
    if [
        cache_key_of_shoe_shape(brake, shoe) for shoe in brake.shoes
    ] != scene.cache_keys_of_shoe_shapes:
        raise BadInput(
            "the brake differs from the prepared scene in more than "
            "friction, rotation, sizes of loads, clearance"
        )
    if brake.friction > 0 and scene.brake.friction == 0:
        raise BadInput(
            f"friction = {brake.friction:g}: the scene was prepared without friction, "
            "for mu = 0 only"
        )
    if brake.ring != scene.brake.ring:
        raise BadInput("the brake's drum.ring differs from that of the prepared scene")


def require_positive_penalty(penalty: float) -> None:
    """Raise BadInput for a penalty factor of the contact that is not positive."""
    if not penalty > 0:
        raise BadInput(f"--penalty = {penalty}: must be greater than 0 (or inf)")


# The following functions make notes and warnings on the brake as a whole.


def _warnings_on_overlap_of_mesh_and_drum(scene: PreparedModel, brake: Brake) -> Iterator[str]:
    """Yield a warning for each shoe whose own mesh overlaps the drum or the plane."""
    for body, shoe in zip(scene.bodies, brake.shoes, strict=True):
        if shoe.mesh is None:
            continue
        deep = -float(shoe.distances_from_friction_surface(body.line.xy, brake.size).min())
        if deep > LARGEST_SILENT_OVERLAP_OVER_LINING_THICKNESS * shoe.lining.thickness:
            yield (
                f"warning: shoe {shoe.name!r}: the contact line of its mesh lies up to "
                f"{length_as_text_in_mm(deep)} in the {shoe.surface.name}; its pressure is "
                f"that of the "
                "lining "
                "squeezed out of there"
            )


def _notes_on_mesh_files(
    scene: PreparedModel, brake: Brake, responses: Sequence[ShoeResponse]
) -> Iterator[str]:
    """Yield the notes on the shoes' mesh files: ignored parts, moved contact nodes, and gaps.

    Raises BadInput for a contact line that does not have the shape of a lining.
    """
    for body, shoe, response in zip(scene.bodies, brake.shoes, responses, strict=True):
        if body.mesh_read_from_file is not None:
            yield from notes_on_mesh_file(shoe, body.mesh_read_from_file, response, brake.size)


def _notes_on_loads_moved_to_actuation_point(scene: PreparedModel, brake: Brake) -> Iterator[str]:
    """Yield a note that names elastic shoes all of whose loads act at the point of actuation.

    The loads besides the actuation are springs, weight and other forces. If the model cannot place
    these loads at their own points, their resultant acts at the point of actuation.
    """
    names = [
        repr(shoe.name)
        for shoe, body in zip(brake.shoes, scene.bodies, strict=True)
        if shoe.body is not None
        and shoe.has_loads_besides_actuation
        and not has_unit_loads_of_forces_at_points_or_mass(body.load_matrix_columns_by_load_name)
    ]
    if names:
        yield (
            f"note: shoe {', '.join(names)}: its further forces act where its actuation acts, "
            "not at their own places"
        )


def _notes_on_supports_of_shoe_bodies(brake: Brake) -> Iterator[str]:
    """Yield one note on how the supports hold the elastic bodies of the shoes.

    There is no note if no shoe without a mesh file has an elastic body. If a pin lies away from the
    body, a rigid arm joins the two, which changes the pressure; the note says so.
    """
    shoes_of: dict[str, list[str]] = {}
    for shoe in brake.shoes:
        if shoe.mesh is None and isinstance(shoe.body, ShoeBodyOfConstantSection):
            shoes_of.setdefault(
                _support_of_elastic_shoe_body_as_text(shoe, shoe.body, brake.size), []
            ).append(shoe.name)
    if shoes_of:
        parts = [f"{', '.join(names)}: {text}" for text, names in shoes_of.items()]
        yield "held: " + "; ".join(parts)


def _support_of_elastic_shoe_body_as_text(
    shoe: Shoe, bar: ShoeBodyOfConstantSection, size: float
) -> str:
    """The text that says how its support holds the elastic body of a shoe."""
    grip = shoe.interval_of_body_back_held_by_support(size)
    if grip is not None:
        # The support grips a length of the body's back. If the back is shorter than this length in
        # the brake file, all of it is gripped.
        length = (grip[1] - grip[0]) * shoe.length_along_shoe_back_per_unit_of_phi(size)
        return (
            f"its {shoe.kind_of_support} grips {length_as_text_in_mm(round(length, 4))} of "
            f"the back of its "
            "body"
        )
    away = math.dist(
        shoe.middle_of_supported_or_loaded_end_face_of_body(size), shoe.pin_position_in_shoe_frame
    )
    joined = "" if away < 0.5 * bar.total_thickness else ", joined by a rigid arm"
    holder = "pin" if shoe.kind_of_support == "hinge" else "foot"
    return (
        f"its {holder} holds the end face of its body, {length_as_text_in_mm(round(away, 4))} "
        f"from the "
        "face's "
        f"middle{joined}"
    )


# The following functions solve a group of shoes, by its substructures or by refinement.


@dataclass(frozen=True)
class _ShoeResponseAndImbalance:
    """The result of solving one shoe: its response, its imbalance, and a note.

    Attributes
    ----------
    response : response of the shoe
    balance : relative imbalance of the forces and moments on the shoe
    steps : number of steps of the contact algorithm
    note : line of text on the contact of the shoe
    spring_motion : (springs,) [m], displacement of each spring's point on the shoe along the pull
        of the spring
    """

    response: ShoeResponse
    balance: ForceAndMomentImbalance
    steps: int
    note: str
    spring_motion: Floats | float = 0.0


class _GroupSolutionUnderBrakeForces(NamedTuple):
    """The solution of a group of shoes under the forces of the brake, not per newton of force.

    Attributes
    ----------
    group : the group, with known directions of friction at its abutments
    pressures : pressures (n_i,) [Pa] of each shoe
    coordinates : generalised coordinates (k_i,) of each shoe
    forces : actuation forces (shoes,) [N]
    support_forces : forces [N] of one-sided supports on each shoe
    pressure_errors : (2, n) [Pa], change of all pressures by the penalty (first row) and by
        round-off (second row)
    steps : number of steps of the contact algorithm
    refined : whether the full system was solved by iterative refinement; the change by round-off is
        then the last correction of the refinement
    """

    group: ShoeGroup
    pressures: list[Floats]
    coordinates: list[Floats]
    forces: Floats
    support_forces: list[tuple[OneSidedSupportForce, ...]]
    pressure_errors: Floats
    steps: int
    refined: bool


class _ShoePartOfGroupSolution(NamedTuple):
    """The values of one shoe in the solution of its group; see `_GroupSolutionUnderBrakeForces`.

    `shoe_number` is the position of the shoe in the group. `motion_along_surface` is the turn about
    the drum's centre [rad], or the slide along the plane [m], by which the shoe follows its strut.
    """

    group: ShoeGroup
    shoe_number: int
    pressures: Floats
    coordinates: Floats
    motion_along_surface: float
    force: float
    support_forces: tuple[OneSidedSupportForce, ...]
    pressure_errors: Floats
    refined: bool


def _result_of_shoe_not_pressed_on_drum(shoe: Shoe) -> _ShoeResponseAndImbalance:
    """The result for a shoe whose force does not press it on the drum."""
    word = shoe.surface.name
    note = f"shoe {shoe.name!r}: no contact, the force does not turn it towards the {word}"
    return _ShoeResponseAndImbalance(
        response_of_shoe_without_contact(shoe, -shoe.sum_of_forces_of_all_loads),
        ForceAndMomentImbalance(0.0, 0.0),
        0,
        note,
    )


def _solve_group_of_coupled_shoes(
    group: ShoeGroup, start: Response | None
) -> dict[int, _ShoeResponseAndImbalance]:
    """Solve a group of shoes; returns the result of each shoe, by its position in the brake.

    Raises AnswerLostToRoundOff if round-off leaves too few digits, even after a refinement.
    """
    # The contact algorithm starts from the nodes that touch in the earlier response.
    first = None
    if start is not None:
        parts = [
            _mask_of_nodes_touching_in_earlier_response(group, k, start)
            for k in range(len(group.members))
        ]
        first = np.concatenate(parts)
    settled = solve_shoe_group_with_lining_friction(group, first)
    solution = _group_solution_under_brake_forces(*settled)
    answers = _results_of_shoes_in_solved_group(solution)
    imbalance = _largest_imbalance_of_shoes(answers)
    balances = imbalance < _largest_accepted_imbalance(settled.group)
    # A group whose actuation forces come from struts or a cam is never refined.
    if settled.group.strut_and_cam_contact_problem_or_none is not None:
        if not balances:
            raise AnswerLostToRoundOff(
                f"{settled.group.names_of_shoes_as_text}: lost digits, it balances only to "
                f"{imbalance:.1e}; {ROUND_OFF_TOO_LARGE_REASON}"
            )
        return answers
    # A group without struts and cam is refined if its round-off error or its imbalance is too
    # large.
    refinable = _can_full_system_be_refined(settled.group)
    reason = None
    if settled.group.prepared_model.model == "solid":
        reason = SOLID_SHOES_NOT_REFINED_REASON
    elif refinable and not LONG_DOUBLE_IS_WIDER:
        reason = NO_LONG_DOUBLE_REASON
    if reason is not None:
        return _shoe_results_with_note_if_round_off_is_large(settled.group, answers, reason)
    most = (
        LARGEST_PRESSURE_ROUND_OFF_LEFT_UNREFINED
        if refinable
        else LARGEST_ACCEPTED_PRESSURE_ROUND_OFF
    )
    lost = _largest_relative_round_off_that_matters(settled.group, answers)
    if lost < most and balances:
        return answers
    if not refinable:
        raise _error_that_round_off_of_group_is_too_large(settled.group, answers, most)
    return _refine_full_system_and_return_shoe_results(solution, settled.contact)


def _largest_accepted_imbalance(group: ShoeGroup) -> float:
    """The largest relative imbalance of forces or moments that is accepted without refinement."""
    if group.prepared_model.model == "solid":
        return LARGEST_ACCEPTED_FORCE_IMBALANCE_OF_SOLID_SHOE
    return LARGEST_ACCEPTED_FORCE_IMBALANCE_OF_SHOE


def _error_that_round_off_of_group_is_too_large(
    group: ShoeGroup, answers: dict[int, _ShoeResponseAndImbalance], most: float
) -> AnswerLostToRoundOff:
    """The exception for a group whose round-off error or force imbalance is too large.

    `most` is the largest round-off error of the pressure that is accepted.
    """
    lost = _largest_relative_round_off_of_pressure(answers)
    balance = f"it balances only to {_largest_imbalance_of_shoes(answers):.1e}"
    why = f"its pressure is certain only to {lost:.1e}" if lost >= most else balance
    return AnswerLostToRoundOff(
        f"{group.names_of_shoes_as_text}: lost digits, {why}; {ROUND_OFF_TOO_LARGE_REASON}"
    )


def _shoe_results_with_note_if_round_off_is_large(
    group: ShoeGroup, answers: dict[int, _ShoeResponseAndImbalance], reason: str
) -> dict[int, _ShoeResponseAndImbalance]:
    """The results of a group that is not refined for a `reason`, with a note if round-off is large.

    Hp elements state the round-off error. Elements of degree 1 or 2 state no error, so that they
    are judged as strictly as if they were refined. Raises AnswerLostToRoundOff for a larger
    round-off error.
    """
    degrees = [
        body.line.interpolation_degree_along_contact_line for body in group.substructures_of_shoes
    ]
    most = (
        LARGEST_PRESSURE_ROUND_OFF_LEFT_UNREFINED
        if max(degrees) <= 2
        else LARGEST_ACCEPTED_PRESSURE_ROUND_OFF
    )
    lost = _largest_relative_round_off_that_matters(group, answers)
    if lost >= most or not _largest_imbalance_of_shoes(answers) < _largest_accepted_imbalance(
        group
    ):
        error = _error_that_round_off_of_group_is_too_large(group, answers, most)
        raise AnswerLostToRoundOff(f"{error}; {reason}")
    if lost < LARGEST_PRESSURE_ROUND_OFF_LEFT_UNREFINED:
        return answers
    noted = {}
    for i, answer in answers.items():
        certain = f"its pressure is certain only to {answer.response.lost.pressure:.0e}"
        noted[i] = replace(answer, note=f"note: {answer.note}; {certain}: {reason}")
    return noted


def _group_solution_under_brake_forces(
    group: ShoeGroup, contact: ContactSolution
) -> _GroupSolutionUnderBrakeForces:
    """The solution of a group under the brake's forces, from its contact per newton of force."""
    size = group.largest_actuation_force
    coordinates = group.rigid_body_coordinates_of_each_shoe(contact)
    return _GroupSolutionUnderBrakeForces(
        group=group,
        pressures=[size * contact.p[part] for part in group.contact_node_slices_of_shoes],
        coordinates=[size * y for y in coordinates],
        forces=size * group.actuation_forces_under_contact_pressures(contact.p),
        support_forces=[
            group.support_forces_on_shoe(contact.p, k) for k in range(len(group.members))
        ],
        pressure_errors=size
        * _pressure_errors_due_to_penalty_and_round_off(group, contact, coordinates),
        steps=contact.steps,
        refined=False,
    )


def _can_full_system_be_refined(group: ShoeGroup) -> bool:
    """Whether iterative refinement of a group's full system is possible and takes only seconds.

    It is not possible for the solid model and for shoes on one-sided supports.
    """
    orders = [
        body.line.interpolation_degree_along_contact_line for body in group.substructures_of_shoes
    ]
    size = sum(
        body.unknowns * body.line.interpolation_degree_along_contact_line**2
        for body in group.substructures_of_shoes
    )
    # The sparse factors of large systems of high degree have many entries and take too long.
    small = size <= LARGEST_SIZE_OF_REFINED_SYSTEM or max(orders) <= 2
    return group.prepared_model.model != "solid" and small and not group.one_sided_supports


def _refine_full_system_and_return_shoe_results(
    solution: _GroupSolutionUnderBrakeForces, contact: ContactSolution
) -> dict[int, _ShoeResponseAndImbalance]:
    """Solve the full system of a group by iterative refinement, and return each shoe's result.

    `contact` is the contact of the condensed bodies; the refinement starts from its contact set.
    Raises AnswerLostToRoundOff if the refinement fails or leaves too few digits.
    """
    group, size = solution.group, solution.group.largest_actuation_force
    try:
        refined = solve_full_system_of_group_by_refinement(group, contact.active)
    except NoAnswer as error:
        raise AnswerLostToRoundOff(
            f"{group.names_of_shoes_as_text}: lost digits, {ROUND_OFF_TOO_LARGE_REASON}; "
            f"refined: {error}"
        ) from error
    by_penalty = solution.pressure_errors[0]
    last_correction = size * np.concatenate(refined.last_correction)
    answers = _results_of_shoes_in_solved_group(
        solution._replace(
            pressures=[size * p for p in refined.p],
            coordinates=[size * y for y in refined.coordinates],
            pressure_errors=np.array([by_penalty, last_correction]),
            steps=solution.steps + refined.contact_sets,
            refined=True,
        )
    )
    imbalance = _largest_imbalance_of_shoes(answers)
    # A solve on a mesh of degree 1 or 2 states no error, and is judged more strictly than hp
    # elements.
    if (
        max(
            body.line.interpolation_degree_along_contact_line
            for body in group.substructures_of_shoes
        )
        <= 2
    ):
        lost, most = refined.correction, LARGEST_PRESSURE_ROUND_OFF_LEFT_UNREFINED
    else:
        lost, most = (
            _largest_relative_round_off_of_pressure(answers),
            LARGEST_ACCEPTED_PRESSURE_ROUND_OFF,
        )
    if lost >= most or not imbalance < LARGEST_ACCEPTED_FORCE_IMBALANCE_OF_SHOE:
        raise AnswerLostToRoundOff(
            f"{group.names_of_shoes_as_text}: lost digits, even refined its pressure is certain "
            "only to "
            f"{lost:.1e} and balances to {imbalance:.1e}; {ROUND_OFF_TOO_LARGE_REASON}"
        )
    return answers


def _largest_relative_round_off_of_pressure(answers: dict[int, _ShoeResponseAndImbalance]) -> float:
    """The largest relative round-off error of the pressure among several shoes."""
    return max(answer.response.lost.pressure for answer in answers.values())


def _largest_relative_round_off_that_matters(
    group: ShoeGroup, answers: dict[int, _ShoeResponseAndImbalance]
) -> float:
    """The largest relative round-off error of those results of a group that a response states.

    It is the round-off error of the pressure. If the contact of a shoe is too short for the hp
    elements to give its pressure, the response says so, and a refinement would not help. For such a
    shoe the round-off errors of torque and support reaction count instead.
    """
    errors = []
    for i, shoe, body in zip(group.members, group.shoes, group.substructures_of_shoes, strict=True):
        answer = answers[i].response
        # On elements of degree 1 or 2 no response states errors.
        states_errors = body.line.interpolation_degree_along_contact_line > 2
        unknown = reason_if_contact_is_too_short(group.brake, shoe, answer) is not None
        if states_errors and unknown:
            errors += [answer.lost.torque, answer.lost.reaction]
        else:
            errors.append(answer.lost.pressure)
    return max(errors)


def _largest_imbalance_of_shoes(answers: dict[int, _ShoeResponseAndImbalance]) -> float:
    """The largest relative imbalance of forces or moments among several shoes; inf for nan."""
    balance = largest_imbalance_among_shoes([answer.balance for answer in answers.values()])
    largest = max(balance.force, balance.moment)
    return math.inf if math.isnan(largest) else largest


def solve_full_system_of_group_by_refinement(
    group: ShoeGroup, active: Bools, order: str = "COLAMD"
) -> "RefinedSolutionOfShoeGroup":
    """Solve the full (not condensed) system of a group of shoes by iterative refinement.

    Parameters
    ----------
    group : the group, with known directions of friction at its abutments
    active : (n,) whether each contact node touches at the start of the refinement
    order : SuperLU's name for the order in which the unknowns are eliminated

    Raises
    ------
    NoAnswer
        if the system is singular, or the contact set keeps changing
    """
    # The module loads scipy.sparse, which takes time, and few brakes need a refinement.
    from drumlin.fem.error_control.refinement import (  # noqa: PLC0415
        assemble_full_system_of_group,
        solve_full_system_by_iterative_refinement,
    )

    refined = solve_full_system_by_iterative_refinement(
        assemble_full_system_of_group(group), active, order
    )
    if refined.correction < LARGEST_CORRECTION_OF_CONVERGED_REFINEMENT:
        return refined
    # In the other form of the system the displacements include the rigid-body motion. This form may
    # converge better if a soft shoe rotates while the drum holds its lining.
    other = solve_full_system_by_iterative_refinement(
        assemble_full_system_of_group(group, relative_to_rigid_motion=False), active, order
    )
    return min(refined, other, key=lambda each: each.correction)


# The following functions compute the results of one shoe of a solved group.


def _results_of_shoes_in_solved_group(
    solution: _GroupSolutionUnderBrakeForces,
) -> dict[int, _ShoeResponseAndImbalance]:
    """The result of each shoe of a solved group, by its position in the brake."""
    group = solution.group
    answers = {}
    motions = group.motions_along_surface_with_struts(
        solution.pressures, solution.coordinates, solution.forces
    )
    for k, (i, part) in enumerate(
        zip(group.members, group.contact_node_slices_of_shoes, strict=True)
    ):
        of_shoe = _ShoePartOfGroupSolution(
            group=group,
            shoe_number=k,
            pressures=solution.pressures[k],
            coordinates=solution.coordinates[k],
            motion_along_surface=float(motions[k]),
            force=solution.forces[k],
            support_forces=solution.support_forces[k],
            pressure_errors=solution.pressure_errors[:, part],
            refined=solution.refined,
        )
        answers[i] = _result_of_one_shoe_in_solved_group(of_shoe, solution.steps)
    return answers


def _result_of_one_shoe_in_solved_group(
    solution: _ShoePartOfGroupSolution, steps: int
) -> _ShoeResponseAndImbalance:
    """The result of one shoe of a solved group.

    Raises NoAnswer if the cam or the strut of the shoe would have to pull it.
    """
    group, shoe = solution.group, solution.group.shoes[solution.shoe_number]
    if (
        group.strut_and_cam_contact_problem_or_none is not None
        and solution.force
        < LARGEST_STRUT_OR_CAM_FORCE_COUNTED_AS_ZERO * group.largest_actuation_force
    ):
        raise NoAnswer(f"shoe {shoe.name!r}: {ERROR_TEXT_ON_CAM_OR_STRUT_THAT_WOULD_PULL}")
    acting = _forces_on_shoe_due_to_pressure_and_actuation(solution)
    errors = _penalty_and_round_off_errors(solution, acting)
    return _ShoeResponseAndImbalance(
        response=_response_of_shoe_in_brake_frame(solution, acting, errors),
        balance=_relative_force_and_moment_imbalance_of_shoe(solution, acting),
        steps=steps,
        note=_note_on_accuracy_of_shoe_contact(solution, errors),
        spring_motion=_spring_point_displacements_of_shoe_along_pulls(solution),
    )


def _spring_point_displacements_of_shoe_along_pulls(solution: _ShoePartOfGroupSolution) -> Floats:
    """The displacement (springs,) [m] of each spring's point on a shoe along the spring's pull."""
    group, k, p = solution.group, solution.shoe_number, solution.pressures
    brake, shoe, body = group.brake, group.shoes[k], group.substructures_of_shoes[k]
    if not any(spring.rate for spring in brake.springs):
        return np.zeros(len(brake.springs))
    load = unit_load_factors_under_all_loads(body, shoe, solution.force)
    # The force of a support that the shoe can leave bends the body as a load does.
    for support in solution.support_forces:
        if support.push.force > 0:
            load = load + unit_load_factors_of_one_sided_support_push(
                body, shoe, support.push, brake.size
            )
    drag = brake.signed_friction_stress_over_pressure_in_shoe_frame(shoe)
    friction = drag * group.friction_stress_over_friction_coefficient_of_shoe(k, p)
    elastic = body.flexibility.motion_of_load_points(p, friction, load)
    pin_motion = group.rigid_body_modes_of_shoes[k].pin_motion @ solution.coordinates
    along = pin_motions_in_rigid_body_motions(shoe, group.rigid_motion_along_friction_surface[None])
    pin_motion = pin_motion + along[:, 0] * solution.motion_along_surface
    return displacements_of_spring_points_along_pulls(brake, shoe, body, elastic, pin_motion)


class _ForcesOnShoeInShoeFrame(NamedTuple):
    """The forces on a shoe, in the frame of the shoe.

    Moments about the centre are moments about the drum's centre.

    Attributes
    ----------
    resultant_of_pressure : (3,) force x, y [N] and moment about the centre [N m] that the pressures
        exert on the drum
    force_of_drum : (3,) force x, y [N] and moment about the centre [N m] that the drum exerts on
        the linings, by pressure and friction
    actuation_force : (2,) sum of the actuation force, spring forces, weight and other forces [N]
    actuation_moment : moment of all these loads about the pin [N m]
    support_force : (2,) force of the support [N]
    guide_moment : moment [N m] of a guide or of one-sided supports on the shoe, about the pin; 0
        for other supports
    """

    resultant_of_pressure: Floats
    force_of_drum: Floats
    actuation_force: Floats
    actuation_moment: float
    support_force: Floats
    guide_moment: float


def _forces_on_shoe_due_to_pressure_and_actuation(
    solution: _ShoePartOfGroupSolution,
) -> _ForcesOnShoeInShoeFrame:
    """Compute the forces on a shoe from its pressures and its actuation force."""
    group, k, p = solution.group, solution.shoe_number, solution.pressures
    shoe, body = group.shoes[k], group.substructures_of_shoes[k]
    load = unit_load_factors_under_all_loads(body, shoe, solution.force)
    moment = abs(solution.force) * group.actuation_of_each_shoe_by_one_newton[k].moment_about_pin
    if shoe.has_loads_besides_actuation:
        moment += moment_of_loads_besides_actuation_about_pin(shoe)
    push = force_resultant_of_unit_load_factors(body, shoe, load)
    drag = group.brake.signed_friction_stress_over_pressure_in_shoe_frame(shoe)
    dragging = group.friction_stress_over_friction_coefficient_of_shoe(k, p)
    normal, dragged = body.resultants_of_unit_nodal_pressures_and_tractions
    normal, dragged = normal @ p, dragged @ dragging
    contact = drag * dragged - normal
    if solution.support_forces:
        reaction = _resultant_of_support_forces_at_pin(shoe, solution.support_forces)
    elif solution.refined:
        # After a refinement the pressure is more accurate than the reaction computed from the
        # condensed body. The reaction is therefore set to balance all other forces, and only the
        # moments or the virtual work are left to check.
        about_pin = (
            contact[2] + moment - planar_cross_product(shoe.pin_position_in_shoe_frame, contact[:2])
        )
        reaction = -np.append(contact[:2] + push, about_pin)
    else:
        reaction = body.flexibility.support_reaction(p, drag * dragging, load)
    twist = float(reaction[2]) if shoe.kind_of_support in {"guide", "anchor"} else 0.0
    return _ForcesOnShoeInShoeFrame(normal, contact, push, moment, reaction[:2], twist)


def _resultant_of_support_forces_at_pin(
    shoe: Shoe, supports: Sequence[OneSidedSupportForce]
) -> Floats:
    """The resultant (3,) of one-sided supports: force x, y [N] and moment about the pin [N m].

    The resultant is in the frame of the shoe. `supports` are the forces of the supports on it.
    """
    total = np.zeros(3)
    for support in supports:
        force = shoe.frame.convert_vectors_to_shoe_frame(support.push.force_vector)
        at = (
            shoe.convert_points_to_shoe_frame(support.push.point.xy)
            - shoe.pin_position_in_shoe_frame
        )
        total += [*force, float(planar_cross_product(at, force))]
    return total


def _relative_force_and_moment_imbalance_of_shoe(
    solution: _ShoePartOfGroupSolution, acting: _ForcesOnShoeInShoeFrame
) -> ForceAndMomentImbalance:
    """The force and moment imbalance of a shoe, relative to the largest force and moment on it."""
    group, shoe = solution.group, solution.group.shoes[solution.shoe_number]
    pin = shoe.pin_position_in_shoe_frame
    # The moment of the actuation about the drum's centre is listed as two terms: its moment about
    # the pin, and the moment of its force moved to the pin. If mu = 0 and the actuation aims at the
    # centre, the sum of both terms and all other moments vanish, and no moment but the two terms
    # sets the scale.
    moments = [
        float(acting.force_of_drum[2]),
        float(planar_cross_product(pin, acting.support_force)),
        acting.actuation_moment,
        float(planar_cross_product(pin, acting.actuation_force)),
    ]
    if shoe.guide is not None:
        length = group.brake.length_per_surface_coordinate * (shoe.lining.end - shoe.lining.start)
        moments += [
            acting.guide_moment,
            *moments_that_scale_imbalance_on_guide(
                max(solution.force, shoe.largest_force_of_any_load), length
            ),
        ]
    elif shoe.anchors:
        moments.append(acting.guide_moment)
    balance = relative_magnitudes_of_force_and_moment_sums(
        [acting.force_of_drum[:2], acting.support_force, acting.actuation_force], moments
    )
    if shoe.kind_of_support == "hinge":
        return balance
    return ForceAndMomentImbalance(
        balance.force, max(balance.moment, _largest_relative_virtual_work_imbalance(solution))
    )


def _largest_relative_virtual_work_imbalance(solution: _ShoePartOfGroupSolution) -> float:
    """The largest relative residual of virtual work among a shoe's test modes.

    A test mode is a rigid-body motion on which the support of the shoe does no work. The residual
    is relative to the work of the loads, or to the sum of the absolute work at all contact nodes if
    this is larger. It is 0 for a shoe without pressure: the forces and moments of its loads and
    supports then say whether they balance.
    """
    group, k, p = solution.group, solution.shoe_number, solution.pressures
    if not p.any():
        return 0.0
    coupling, modes = group.substructures_of_shoes[k].coupling, group.rigid_body_modes_of_shoes[k]
    drag = group.brake.signed_friction_stress_over_pressure_in_shoe_frame(group.shoes[k])
    nodal = (
        drag * (coupling.T.T @ group.friction_stress_over_friction_coefficient_of_shoe(k, p))
        - coupling.N.T @ p
    )
    by_actuation = abs(solution.force) * modes.actuation_work + modes.work_of_further_loads
    for support in solution.support_forces:
        by_actuation += group.work_of_support_push_on_shoe_modes(k, support.push)
    by_contact = nodal[:, None] * modes.test_modes
    residual = np.abs(by_contact.sum(axis=0) + by_actuation)
    scale = np.maximum(np.abs(by_actuation), np.abs(by_contact).sum(axis=0))
    return float((residual / scale).max())


class _PenaltyAndRoundOffErrors(NamedTuple):
    """The relative errors of a shoe's results by the penalty, and by round-off."""

    penalty: RelativeChangesOfShoeResults
    round_off: RelativeChangesOfShoeResults


def _penalty_and_round_off_errors(
    solution: _ShoePartOfGroupSolution, acting: _ForcesOnShoeInShoeFrame
) -> _PenaltyAndRoundOffErrors:
    """The relative errors of a shoe's results by the penalty, and by round-off."""
    normal_force = math.hypot(*acting.resultant_of_pressure[:2])
    size = reference_force_of_reaction_errors(acting.support_force, normal_force)
    by_penalty, by_round_off = _shoe_changes_by_penalty_and_round_off(solution, size)
    # Eliminating the unknowns inside a body causes a round-off error. No smaller error is stated.
    least = 0.0
    if not solution.refined:
        least = solution.group.substructures_of_shoes[
            solution.shoe_number
        ].condensed.force_imbalance
    round_off = RelativeChangesOfShoeResults(*(max(part, least) for part in by_round_off))
    return _PenaltyAndRoundOffErrors(by_penalty, round_off)


def _note_on_accuracy_of_shoe_contact(
    solution: _ShoePartOfGroupSolution, errors: _PenaltyAndRoundOffErrors
) -> str:
    """The note on how deep the lining enters the drum, the effect on torque, and any refinement."""
    group, k, p = solution.group, solution.shoe_number, solution.pressures
    shoe, lever = group.shoes[k], group.substructures_of_shoes[k].coupling.lever
    if not p.any():
        return note_on_shoe_held_off_by_its_supports(shoe)
    contact = "exact contact, no penetration"
    if not math.isinf(group.penalty):
        lever = lever * group.node_friction_over_shoe_friction(k)
        pressed = float(lever @ p)
        softer = float(lever @ solution.pressure_errors[0]) / pressed if pressed else 0.0
        penetration = p.max() / group.contact_stiffness_per_area_of_shoes[k]
        contact = (
            f"penalty {group.penalty:g} E/t, the stiffness between lining and {shoe.surface.name}: "
            f"the lining enters the {shoe.surface.name} by {1e3 * penetration:.1e} mm at most, "
            f"which changes the {shoe.surface.word_for_torque_or_brake_force} by "
            f"{100 * softer:+.1e} %"
        )
    note = f"shoe {shoe.name!r}: {contact}"
    if solution.refined:
        certain = max(errors.round_off.pressure, RELATIVE_SPACING_OF_DOUBLES)
        note += f"; {ITERATIVE_REFINEMENT_REMARK}, so its pressure is certain to {certain:.0e}"
    return note


def _response_of_shoe_in_brake_frame(
    solution: _ShoePartOfGroupSolution,
    acting: _ForcesOnShoeInShoeFrame,
    errors: _PenaltyAndRoundOffErrors,
) -> ShoeResponse:
    """The response of a shoe, in the frame of the brake.

    Parameters
    ----------
    solution : the shoe's pressures, motion and forces in the solution of its group
    acting : the forces on the shoe
    errors : relative errors by the penalty and by round-off
    """
    group, k, p = solution.group, solution.shoe_number, solution.pressures
    brake, shoe, body, modes = (
        group.brake,
        group.shoes[k],
        group.substructures_of_shoes[k],
        group.rigid_body_modes_of_shoes[k],
    )
    frame, line, drag = (
        shoe.frame,
        body.line,
        brake.signed_friction_stress_over_pressure_in_shoe_frame(shoe),
    )
    phi, on_lining = line.node_angles_with_mask_of_linings
    dragging = group.friction_stress_over_friction_coefficient_of_shoe(k, p)
    mean = np.zeros(len(phi))
    mean[on_lining] = line.angles_and_pressures_averaged_over_width(p)[1]
    stress = None
    if group.node_frictions_over_brake_friction is not None:
        stress = np.zeros(len(phi))
        stress[on_lining] = abs(drag) * line.angles_and_pressures_averaged_over_width(dragging)[1]
    pin_motion = modes.pin_motion @ solution.coordinates
    return response_of_pressed_elastic_shoe(
        shoe,
        brake.length_per_surface_coordinate,
        frame.surface_coordinates_of_phi(phi),
        mean,
        order=line.interpolation_degree_along_contact_line,
        on_lining=on_lining,
        peak=line.lining_part_where_pressure_peak_is_sought.peak_pressure_outside_end_zones(mean),
        torque=abs(drag) * float(body.coupling.lever @ dragging),
        normal_force=math.hypot(*acting.resultant_of_pressure[:2]),
        self_energising=_is_shoe_self_energising(solution),
        hinge_reaction=frame.convert_vectors_from_shoe_to_brake_frame(acting.support_force),
        turn=frame.sense * float(modes.pin_motion[2] @ solution.coordinates),
        force=None if group.strut_and_cam_contact_problem_or_none is None else solution.force,
        pivot_reaction=None
        if shoe.pivot is None
        else -frame.convert_vectors_from_shoe_to_brake_frame(acting.force_of_drum[:2])
        - shoe.resultant_of_loads_besides_actuation[:2],
        reaction_moment=frame.sense * acting.guide_moment,
        supports=solution.support_forces,
        motion=None if shoe.kind_of_support == "hinge" else tuple(pin_motion.tolist()),
        surface=line.pressure_distribution_over_arc_and_width(p),
        friction_stress=stress,
        softness=errors.penalty,
        lost=errors.round_off,
    )


def _is_shoe_self_energising(solution: _ShoePartOfGroupSolution) -> bool:
    """Whether the work of the friction on the first test mode of a shoe helps the actuation.

    A test mode is a rigid-body motion on which the support of the shoe does no work. For a shoe on
    anchors the computed motion of the shoe takes the place of the test mode.
    """
    group, k, p = solution.group, solution.shoe_number, solution.pressures
    drag = group.brake.signed_friction_stress_over_pressure_in_shoe_frame(group.shoes[k])
    closures, dragging = (
        group.gap_closures_of_test_modes[k],
        group.friction_stress_over_friction_coefficient_of_shoe(k, p),
    )
    if group.shoes[k].anchors:
        work = [
            float(acting @ part @ solution.coordinates)
            for acting, part in zip((p, dragging), closures, strict=True)
        ]
        return drag * work[1] > LARGEST_NEUTRAL_FRICTION_OVER_PRESSURE_WORK * abs(work[0])
    closed = float(closures.normal[:, 0] @ p)
    rubbed = float(closures.tangential[:, 0] @ dragging)
    modes = group.rigid_body_modes_of_shoes[k]
    pushing = modes.actuation_work[0]
    if group.shoes[k].has_loads_besides_actuation:
        pushing = abs(solution.force) * pushing + modes.work_of_further_loads[0]
    sense = math.copysign(1.0, pushing)
    return sense * drag * rubbed > LARGEST_NEUTRAL_FRICTION_OVER_PRESSURE_WORK * abs(closed)


# The following functions estimate the penalty error and the round-off error.


def _pressure_errors_due_to_penalty_and_round_off(
    group: ShoeGroup, contact: ContactSolution, coordinates: Sequence[Floats]
) -> Floats:
    """The first-order change (2, n) of all pressures: by the penalty, and by round-off.

    The contact's compliance is x = 1/alpha, with the penalty factor alpha. Its effect on the
    pressure grows as x/(1 + x). The slope of this effect at x, multiplied by x, is smaller than the
    effect by the factor 1 + x. The change is therefore multiplied by 1 + x. The round-off of the
    elimination acts as if the rigid-body modes strained the bodies a little. This strain changes
    the gaps.

    Parameters
    ----------
    group : the group of shoes, with known directions of friction at its abutments
    contact : contact of the group per newton of its largest force; the changes have the same scale
    coordinates : (k_i,) generalised coordinates of each shoe
    """
    opened, strayed = [], []
    for k, (body, part) in enumerate(
        zip(group.substructures_of_shoes, group.contact_node_slices_of_shoes, strict=True)
    ):
        squeezed = (1 + 1 / group.penalty) * (body.coupling.M @ contact.p[part])
        opened.append(squeezed / group.contact_stiffness_per_area_of_shoes[k])
        strains = body.condensed.rigid_mode_error
        if strains is None:
            strayed.append(np.zeros(len(opened[k])))
        else:
            frame = group.rigid_body_modes_of_shoes[k].pin_motion @ coordinates[k]
            strayed.append(body.coupling.N @ (strains @ frame))
    return np.array([contact.pressure_change(np.concatenate(gaps)) for gaps in (opened, strayed)])


def _shoe_changes_by_penalty_and_round_off(
    solution: _ShoePartOfGroupSolution, reaction: float
) -> list[RelativeChangesOfShoeResults]:
    """The relative changes of a shoe's pressure, torque, reaction and peak pressure.

    The first item of the list is the change by the penalty, the second the change by round-off. The
    change of the pressure is taken outside UNCOMPARED_EDGE_ZONE_IN_RADIANS at the lining's ends,
    unless more than half of the force acts in these zones. `reaction` is the size of the support
    reaction [N].
    """
    group, k, p, changes = (
        solution.group,
        solution.shoe_number,
        solution.pressures,
        solution.pressure_errors,
    )
    shoe, body = group.shoes[k], group.substructures_of_shoes[k]
    ratios = group.node_friction_over_shoe_friction(k)
    area, lever = body.coupling.areas_of_contact_nodes, body.coupling.lever * ratios
    weight = _node_areas_with_zero_in_edge_zones(shoe, body.line.phi, area)
    if weight @ p < 0.5 * (area @ p):
        weight = area
    # The support reaction changes only because the pressures change; the actuation stays the same.
    no_load = np.zeros((body.load_matrix_columns_by_load_name.number_of_load_columns, 1))
    drag = group.brake.signed_friction_stress_over_pressure_in_shoe_frame(shoe)
    friction = drag * (changes * ratios).T
    reactions = body.flexibility.support_reaction(changes.T, friction, no_load)
    top = float(p[weight > 0].max(initial=0.0))
    at_top = (weight > 0) & (p == top)
    by_quantity = [
        np.sqrt(changes**2 @ weight),
        np.abs(changes @ lever),
        np.hypot(*reactions[:2]),
        np.abs(changes[:, at_top]).max(axis=1, initial=0.0),
    ]
    wholes = [math.sqrt(weight @ p**2), float(lever @ p), reaction, top]
    relative = np.array(by_quantity).T / [whole or 1.0 for whole in wholes]
    return [RelativeChangesOfShoeResults(*row) for row in relative.tolist()]


def _node_areas_with_zero_in_edge_zones(shoe: Shoe, phi: Floats, area: Floats) -> Floats:
    """The areas (n,) [m^2] of a shoe's contact nodes, 0 for nodes near the ends of a lining.

    Parameters
    ----------
    shoe : the shoe
    phi : (n,) angles of the contact nodes [rad]
    area : (n,) areas of the contact nodes [m^2]
    """
    zone = length_of_uncompared_edge_zone(min(end - start for start, end in shoe.arcs))
    inside = np.zeros(len(phi), dtype=bool)
    for start, end in shoe.arcs:
        inside |= (phi > start + zone) & (phi < end - zone)
    return np.where(inside, area, 0.0)


def _mask_of_nodes_touching_in_earlier_response(group: ShoeGroup, k: int, start: Response) -> Bools:
    """A mask (n_k,) of a shoe's contact nodes, True for nodes that touched in an earlier response.

    Parameters
    ----------
    group : the group of shoes
    k : position of the shoe in the group
    start : the earlier response, whose contact arcs count
    """
    theta = group.shoes[k].frame.surface_coordinates_of_phi(
        group.substructures_of_shoes[k].line.phi
    )
    touching = np.zeros(len(theta), dtype=bool)
    for first, last in start.shoes[group.members[k]].contact_arcs:
        touching |= (theta > first - 1e-9) & (theta < last + 1e-9)
    return touching


def __getattr__(name: str) -> Any:
    """Return `solve_prepared_model` by its old name `respond`, with a warning."""
    if name != "respond":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    message = "drumlin.fem.model.respond is now solve_prepared_model"
    warnings.warn(message, DeprecationWarning, stacklevel=2)
    return solve_prepared_model
