"""Solve a brake on meshes from files with stated errors, by smaller elements of higher degree.

From level to level the displacements on the mesh of a file are polynomials of higher degree, and
its elements are split into smaller elements at singular points: corners of the shoe, ends of the
lining and of the contact. The difference between two levels gives the errors of the finer level.
Straight or parabolic element sides on curved outlines cause another error. Their error follows from
the change of the response if arcs take their place. Shoes without a mesh file and the drum's ring
are divided into the hp elements of the same level.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.base.texts import error_text_in_percent
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.adapt import (
    DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE,
    TolerancesOfPressureAndTorque,
    errors_with_singular_points_and_text_on_short_contacts,
    is_tolerance_met,
    response_with_estimated_errors,
)
from drumlin.fem.error_control.changed_shape import prepared_model_with_moved_nodes
from drumlin.fem.error_control.estimate import (
    QUANTITIES_WITH_STATED_ERROR,
    SAFETY_FACTORS_OF_ERROR_ESTIMATE,
    EstimatedErrors,
    SafetyFactorsOfErrorEstimate,
    estimate_errors_from_response_differences,
    relative_differences_of_responses_on_two_levels,
)
from drumlin.fem.error_control.levels import (
    REFINEMENT_LEVELS_FROM_COARSE_TO_FINE,
    FunctionThatComputesResponse,
    FunctionThatPreparesModelOfLevel,
    SolvedLevel,
    solve_brake_on_finer_and_finer_mesh_levels,
)
from drumlin.fem.hp.corner import response_with_power_laws_at_corners
from drumlin.fem.hp.division import RefinementLevel
from drumlin.fem.mesh.degree import nodal_basis_of_shoe_mesh
from drumlin.fem.mesh.smooth_outline import node_displacements_onto_smooth_outline
from drumlin.fem.preparation.cache import CacheOfCondensedBodies
from drumlin.fem.preparation.meshes import (
    MOST_NODES_AT_RAISED_DEGREE,
    MOST_NODES_WITHOUT_KEPT_FACTORS,
    DegreeAndSplittingOfMesh,
    read_mesh_file_of_shoe,
)
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.preparation.scene import PreparedModel, SingularPointsByShoeShape
from drumlin.response.response import Response


class RefinementLevelsOnMeshFiles(NamedTuple):
    """The levels of refinement of a solve on the meshes of files.

    Attributes
    ----------
    levels : the levels, from coarse to fine. Their sizes at singular points are those of all
        elements, and their degrees those of the hp elements beside the mesh of a file
    degrees_below_level : how much the degree of the elements on the mesh of a file is
        below the degree of these hp elements
    """

    levels: tuple[RefinementLevel, ...]
    degrees_below_level: int


REFINEMENT_LEVELS_ON_MESH_FILES = RefinementLevelsOnMeshFiles(
    REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1:5], degrees_below_level=2
)
"""The levels of refinement on meshes of files, with elements of degree 2 to 5.

The sizes at singular points are those of hp elements whose degree is higher by two: most elements
of a mesh are smaller than hp elements, so that most of the errors come from the singular points.
With the sizes of hp elements of a degree higher by one, p at degree 3 was 0.3 % to 1 % off on 7 of
15 meshes by Gmsh. Now p is off by 0.02 % to 0.1 % on most meshes, and many solves need one level
less.
"""
REFINEMENT_LEVELS_ON_FINE_MESH_FILES = RefinementLevelsOnMeshFiles(
    REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1:6], degrees_below_level=3
)
"""The levels of refinement on fine meshes, with elements of degree 1 to 5.

A mesh is fine from FEWEST_VERTICES_OF_FINE_MESH_FILE vertices on.

The sizes at singular points are those of hp elements whose degree is higher by three. On four
meshes of 10 000 nodes p is 0.4 % to 0.8 % off on the first level, and 0.05 % to 0.2 % on the
second.
"""
FEWEST_VERTICES_OF_FINE_MESH_FILE = 2000
"""Number of vertices from which on a mesh counts as fine, see REFINEMENT_LEVELS_ON_FINE_MESH_FILES.

On such a mesh elements of degree 2 often suffice, and higher degrees would take most of the time. A
smaller number adds a level to solves on coarse meshes, where degree 2 does not suffice. With a
larger number solves on fine meshes take about 1.5 times as long. The value is a judgement.
"""
SAFETY_FACTOR_OF_MESH_FILE_FORCES = 0.05
"""The factor of the error estimate on a mesh file for torque and reactions.

It is the number `force` of `SafetyFactorsOfErrorEstimate`.

On 45 meshes by Gmsh 0.018 would just suffice, together with 0.0003 for
SAFETY_FACTOR_OF_CANCELLED_MESH_FILE_FORCES. Either factor may be smaller if the other one is
larger. A larger factor makes stated errors larger. The value is a judgement.
"""
SAFETY_FACTOR_OF_CANCELLED_MESH_FILE_FORCES = 0.004
"""The number `cancelled` of `SafetyFactorsOfErrorEstimate` for the error estimate on a mesh file.

A larger factor makes stated errors larger. With 0.002 a torque's error of 5e-7 was stated 1.3 times
too small on one of 50 meshes by Gmsh. With 0.003 no error is too small on these meshes. The value
is a judgement.
"""
SAFETY_FACTORS_OF_MESH_FILES = SafetyFactorsOfErrorEstimate(
    pressure=0.45,
    force=SAFETY_FACTOR_OF_MESH_FILE_FORCES,
    cancelled=SAFETY_FACTOR_OF_CANCELLED_MESH_FILE_FORCES,
    peak=0.5,
)
"""The `SafetyFactorsOfErrorEstimate` of the error estimate from two levels on a mesh file.

A smaller factor makes stated errors too small, a larger one only larger. On 70 meshes by Gmsh a
pressure factor of 0.3 and a peak factor of 0.45 would just suffice. `make degrees` compares stated
with true errors on other meshes.
"""
SHARE_OF_EARLIER_LEVEL_DIFFERENCE = 0.04
"""Fraction of the difference between the two earlier levels that is added to the last difference.

The last difference, between the last two levels, may be small by accident. A larger fraction makes
stated errors larger. With 0.02 the error of p was once stated 8 % too small on a uniform mesh of
ten elements along the lining. Since the shape of the outline is part of the error on every mesh, no
known mesh needs it: the value is a judgement.
"""
CANCELLED_PART_OF_MESH_SHAPE_ERROR = 0.1
"""Fraction of the change of a force by another shape of the mesh that may cancel by accident.

It is relative to the change that random signs of the changes of p would give. On one mesh the
changes of p cancelled in the torque, whose error was 0.12 times the change with random signs. The
value is a judgement: a larger one makes stated errors of forces larger.
"""
FACTORS_FROM_SHAPE_CHANGE_TO_MESH_SHAPE_ERROR = SafetyFactorsOfErrorEstimate(
    pressure=1.3, force=1.3, cancelled=CANCELLED_PART_OF_MESH_SHAPE_ERROR, peak=1.3
)
"""Error that the shape of a mesh causes, divided by the change of the result with another shape.

Arcs replace straight sides on curved outlines, or a round lining replaces a gap below the rounding
of coordinates. For such a gap the change is the error itself, if rounding alone has caused the gap.
See `SafetyFactorsOfErrorEstimate` for each number. If the straight sides cause the largest error,
the change is nearly the true error: on 45 meshes by Gmsh with straight sides the error of p was 1.0
to 1.15 times its change, and the error of the peak up to 1.25 times the larger of the changes of p
and of the peak. Smaller factors make stated errors too small.
"""
ERROR_PER_ROUNDING_OVER_LINING_THICKNESS = {
    "pressure": 1.5,
    "torque": 0.1,
    "peak": 0.8,
    "reaction": 0.25,
}
"""Relative errors due to rounded coordinates of a mesh file, divided by the relative rounding.

The relative rounding is the rounding of the coordinates divided by the lining's thickness.

Contact nodes are moved back onto the drum, but the other nodes, and so the lining's thickness, keep
the rounding. On 7 coarse meshes by Gmsh with curved sides, rounded to 0.01 mm and solved at the
highest degree, p changed by 0.3 to 1.3 times the relative rounding, the peak by up to 0.6 times,
the reaction by up to 0.2 times and the torque by up to 0.07 times. Smaller factors make stated
errors of rounded meshes too small.
"""
NEGLIGIBLE_SHARE_OF_LEVEL_ERROR = 0.1
"""Fraction of an estimated error up to which the part that levels reduce is negligible.

Straight sides and rounded coordinates cause the rest of the error, and finer levels do not change
this rest. With a smaller fraction some meshes with straight sides need one more level, which takes
two to three times as long, for errors that are smaller by less than this fraction. With a larger
fraction the last level could leave a larger part of the errors. The value is a judgement.
"""
NEGLIGIBLE_DISTANCE_OF_SIDE_FROM_ARC = 1e-5
"""Largest distance between a side and its arc, in lining thicknesses, that is neglected.

On four meshes by Gmsh with third-order sides a tenth of the drum's radius long, all sides lay up to
5e-6 of a lining's thickness off their arcs. Arcs changed p by 1e-6, the torque by 1e-7 and the
reaction by 5e-7. If the limit is far larger, the neglected errors are no longer small.
"""


def solve_brake_on_mesh_files(
    brake: Brake,
    respond: FunctionThatComputesResponse,
    tolerance: float | None,
    cache: CacheOfCondensedBodies | None = None,
) -> SolvedLevel:
    """Solve a brake on the meshes of its shoes' files, with stated errors.

    Returns the prepared model of the last level that was solved, and the response on it. The levels
    end when the estimated errors meet the tolerance, or when straight sides and rounded coordinates
    cause nearly all of the errors. If a given tolerance is not met, a warning says so. If the
    errors cannot be estimated, the brake is solved at the meshes' own degrees, and a note says why
    no error is stated.

    Parameters
    ----------
    brake : the brake; at least one shoe has a mesh file
    respond : function that computes the response on a prepared model
    tolerance : largest relative error of p and of the torque; None for the default tolerance
    cache : keeps the condensed bodies of earlier solves

    Raises
    ------
    BadInput
        for a mesh file that cannot be used
    NoAnswer
        if the brake has no solution on the meshes' own degrees
    """
    cache = cache or CacheOfCondensedBodies()
    aim = (
        DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE
        if tolerance is None
        else TolerancesOfPressureAndTorque(tolerance, tolerance)
    )
    responses: list[Response] = []
    error: EstimatedErrors | None = None
    stopped = ""
    mesh_levels = mesh_levels_of_brake(brake, cache)
    # Elements of degree 1 have straight sides only, so that arcs are tried on the second level.
    second_degree = mesh_levels.levels[1].degree - mesh_levels.degrees_below_level
    has_chords = _has_mesh_sides_off_smooth_outline(brake, second_degree, cache)
    prepare = partial(
        prepared_model_of_mesh_files,
        brake,
        degrees_below_level=mesh_levels.degrees_below_level,
        keep_factors_at=second_degree if has_chords else None,
        most_nodes=MOST_NODES_AT_RAISED_DEGREE if has_chords else MOST_NODES_WITHOUT_KEPT_FACTORS,
        cache=cache,
    )
    levels = solve_brake_on_finer_and_finer_mesh_levels(
        brake, respond, cache, mesh_levels.levels, prepare=prepare
    )
    try:
        for solved in levels:
            responses.append(response_with_power_laws_at_corners(brake, solved.response))
            solved_last = solved.prepared_model
            if len(responses) == 1:
                first = solved
                continue
            if len(responses) == 2:
                shape: Floats | float = _errors_due_to_rounded_mesh_coordinates(brake, cache)
                if has_chords:
                    shape = shape + _errors_due_to_sides_off_smooth_outline(brake, respond, solved)
                fitting = partial(prepare, fitting=True)
                shape = shape + _errors_due_to_gaps_below_rounding(
                    brake, respond, first, fitting, cache
                )
            error = _estimated_errors_on_last_mesh_level(brake, responses, shape)
            of_level = _estimated_errors_on_last_mesh_level(brake, responses, 0.0)
            if not _would_finer_mesh_level_reduce_error(error, of_level, aim):
                break
    except NoAnswer as refusal:
        stopped = str(refusal)
    if error is None:
        own = make_prepared_model(brake, cache=cache)
        response = respond(own, brake)
        warning = f"warning: no error stated: {stopped}"
        return SolvedLevel(own, replace(response, notes=(*response.notes, warning)))
    degree = max(
        answer.order
        for shoe, answer in zip(brake.shoes, responses[-1].shoes, strict=True)
        if shoe.mesh is not None
    )
    notes = [f"meshes of files: elements of degree {degree}, split at singular points"]
    if stopped:
        notes.append(f"meshes of files: no higher degree: {stopped}")
    if tolerance is not None and not is_tolerance_met(error, aim):
        notes.append(
            f"warning: tolerance {tolerance:g} not reached on the meshes of the files: estimated "
            f"error of p {error_text_in_percent(error.brake['pressure'])}, "
            f"of the torque {error_text_in_percent(error.brake['torque'])}; "
            "a finer mesh or more digits of its coordinates make it smaller"
        )
    return SolvedLevel(solved_last, response_with_estimated_errors(responses, error, notes))


def mesh_levels_of_brake(
    brake: Brake, cache: CacheOfCondensedBodies
) -> RefinementLevelsOnMeshFiles:
    """The levels of refinement for a brake with mesh files.

    Raises BadInput for a mesh file that cannot be used.
    """
    read = [read_mesh_file_of_shoe(brake, shoe, cache) for shoe in brake.shoes]
    vertices = max(each.mesh.nvertices for each in read if each is not None)
    return (
        REFINEMENT_LEVELS_ON_FINE_MESH_FILES
        if vertices >= FEWEST_VERTICES_OF_FINE_MESH_FILE
        else REFINEMENT_LEVELS_ON_MESH_FILES
    )


def prepared_model_on_second_level_of_mesh_files(
    brake: Brake, cache: CacheOfCondensedBodies | None = None
) -> PreparedModel:
    """The prepared model of a brake with mesh files on the second of its levels of refinement.

    Analyses use it for a brake that has no solution in sliding. The errors raised are those of
    `prepared_model_of_mesh_files`; `cache` keeps condensed bodies of earlier solves.
    """
    cache = cache or CacheOfCondensedBodies()
    mesh_levels = mesh_levels_of_brake(brake, cache)
    return prepared_model_of_mesh_files(
        brake,
        mesh_levels.levels[1],
        degrees_below_level=mesh_levels.degrees_below_level,
        cache=cache,
    )


def prepared_model_of_mesh_files(
    brake: Brake,
    level: RefinementLevel,
    points: SingularPointsByShoeShape | None = None,
    *,
    degrees_below_level: int = REFINEMENT_LEVELS_ON_MESH_FILES.degrees_below_level,
    fitting: bool = False,
    keep_factors_at: int | None = None,
    most_nodes: int = MOST_NODES_AT_RAISED_DEGREE,
    cache: CacheOfCondensedBodies | None = None,
) -> PreparedModel:
    """The prepared model of a brake on a level, with the meshes of its files split.

    Parameters
    ----------
    brake : the brake
    level : sizes of elements at singular points, and the degree of hp elements
    points : singular points of the pressure for each shape of shoe; the key is the index of the
        first shoe of this shape. None for no points
    degrees_below_level : how much the degree on the mesh of a file is below the degree
        of the level
    fitting : whether contact nodes are moved onto the drum if they lie off the drum by no more than
        the rounding of coordinates
    keep_factors_at : degree of the elements on the mesh of a file at which the factors of their
        eliminated unknowns are kept; None for no degree
    most_nodes : largest number of nodes of a shoe at degree 1 or 2. At higher degrees, whose
        matrices take more memory, it is MOST_NODES_AT_RAISED_DEGREE
    cache : keeps condensed bodies of earlier solves

    Raises
    ------
    BadInput
        for a mesh file that cannot be used
    NoAnswer
        for a mesh with too many nodes on this level, and for a singular stiffness
    """
    of_shoes = tuple(tuple((points or {}).get(i, ())) for i in range(len(brake.shoes)))
    degree = level.degree - degrees_below_level
    own = replace(level, degree=degree)
    raised = DegreeAndSplittingOfMesh(
        degree,
        fitting=fitting,
        level=own,
        points=of_shoes,
        keep_factors=degree == keep_factors_at,
        most_nodes=most_nodes if degree <= 2 else MOST_NODES_AT_RAISED_DEGREE,
    )
    try:
        return make_prepared_model(brake, level, points, raised=raised, cache=cache)
    except NoAnswer as refusal:
        raise NoAnswer(f"at degree {degree}: {refusal}") from refusal


def _estimated_errors_on_last_mesh_level(
    brake: Brake, responses: list[Response], shape: Floats | float
) -> EstimatedErrors:
    """The estimated errors of the response on the last of at least two levels.

    `shape` are the errors (1 + 4 shoes,) due to straight sides and rounded coordinates, in the
    order of `estimate.ResponseDifferencesOfTwoLevels`.
    """
    *former, before, last = responses
    moved = relative_differences_of_responses_on_two_levels(brake, before, last)
    if former:
        steps = relative_differences_of_responses_on_two_levels(
            brake, former[-1], before
        ).differences
        moved = moved._replace(
            differences=moved.differences + SHARE_OF_EARLIER_LEVEL_DIFFERENCE * steps
        )
    factors = _factors_of_error_estimate(brake)
    errors = estimate_errors_from_response_differences(moved, last, factors, shape)
    return errors_with_singular_points_and_text_on_short_contacts(errors, brake, last)[0]


def _factors_of_error_estimate(brake: Brake) -> SafetyFactorsOfErrorEstimate:
    """The factors of the error estimate of a brake with mesh files.

    Hp elements beside the meshes need larger factors, since their levels begin with larger
    elements. A force may depend on all bodies, so that the larger factors count for all shoes.
    """
    if brake.ring is None and all(shoe.mesh is not None for shoe in brake.shoes):
        return SAFETY_FACTORS_OF_MESH_FILES
    return SafetyFactorsOfErrorEstimate(
        *map(max, SAFETY_FACTORS_OF_MESH_FILES, SAFETY_FACTORS_OF_ERROR_ESTIMATE)
    )


def _would_finer_mesh_level_reduce_error(
    error: EstimatedErrors, of_level: EstimatedErrors, aim: TolerancesOfPressureAndTorque
) -> bool:
    """Whether another level would reduce an error that misses its tolerance.

    Parameters
    ----------
    error : estimated errors of the last level
    of_level : the same errors without the part by straight sides and rounded coordinates, which no
        level reduces
    aim : largest errors that are allowed
    """
    return any(
        error.brake[name] > allowed
        and of_level.brake[name] > NEGLIGIBLE_SHARE_OF_LEVEL_ERROR * error.brake[name]
        for name, allowed in aim._asdict().items()
    )


def _errors_due_to_sides_off_smooth_outline(
    brake: Brake, respond: FunctionThatComputesResponse, solved: SolvedLevel
) -> Floats:
    """The relative errors (1 + 4 shoes,) due to straight sides or parabolas in place of arcs.

    `solved` is a solved level with elements of degree 2 or higher, and `respond` computes the
    response on a prepared model.
    """
    changed = prepared_model_with_moved_nodes(
        solved.prepared_model, brake, solved.response, node_displacements_onto_smooth_outline
    )
    cause = "with sides that follow the curves"
    return _errors_by_change_of_shape(brake, respond, solved, lambda: changed, cause)


def _errors_by_change_of_shape(
    brake: Brake,
    respond: FunctionThatComputesResponse,
    solved: SolvedLevel,
    prepare_changed: Callable[[], PreparedModel],
    cause: str,
) -> Floats:
    """The relative errors (1 + 4 shoes,) of a solved level due to the shape of its mesh.

    They follow from the change of the response with another shape of the mesh. The order is that of
    `estimate.ResponseDifferencesOfTwoLevels`.

    Parameters
    ----------
    brake : the brake
    respond : function that computes the response on a prepared model
    solved : the solved level
    prepare_changed : function that makes the prepared model with the other shape
    cause : words that name the other shape if it has no solution
    """
    try:
        changed = respond(prepare_changed(), brake, start=solved.response)
    except NoAnswer as refusal:
        raise NoAnswer(f"{cause}: {refusal}") from refusal
    moved = relative_differences_of_responses_on_two_levels(brake, changed, solved.response)
    torque, of_shoes = (
        moved.differences[:1],
        moved.differences[1:].reshape(-1, len(QUANTITIES_WITH_STATED_ERROR)).copy(),
    )
    pressure, peak = (QUANTITIES_WITH_STATED_ERROR.index(name) for name in ("pressure", "peak"))
    # The difference of a peak may be small by accident; it counts as at least the difference of p.
    of_shoes[:, peak] = of_shoes[:, [pressure, peak]].max(axis=1)
    steps = np.concatenate([torque, of_shoes.ravel()])
    factors = FACTORS_FROM_SHAPE_CHANGE_TO_MESH_SHAPE_ERROR.safety_factors_of_level_differences(
        len(brake.shoes)
    )
    return (
        factors * steps
        + FACTORS_FROM_SHAPE_CHANGE_TO_MESH_SHAPE_ERROR.cancelled * moved.changes_with_random_signs
    )


def _errors_due_to_rounded_mesh_coordinates(brake: Brake, cache: CacheOfCondensedBodies) -> Floats:
    """The relative errors (1 + 4 shoes,) that rounded coordinates of mesh files cause."""
    of_shoes = []
    for shoe in brake.shoes:
        read = read_mesh_file_of_shoe(brake, shoe, cache)
        moved = 0.0 if read is None else read.contact.largest_rounding_offset
        of_shoes.append(moved / shoe.lining.thickness)
    rows = np.outer(
        of_shoes,
        [ERROR_PER_ROUNDING_OVER_LINING_THICKNESS[name] for name in QUANTITIES_WITH_STATED_ERROR],
    )
    return np.array(
        [ERROR_PER_ROUNDING_OVER_LINING_THICKNESS["torque"] * max(of_shoes), *rows.ravel()]
    )


def _errors_due_to_gaps_below_rounding(
    brake: Brake,
    respond: FunctionThatComputesResponse,
    solved: SolvedLevel,
    prepare_fitting: FunctionThatPreparesModelOfLevel,
    cache: CacheOfCondensedBodies,
) -> Floats | float:
    """The relative errors (1 + 4 shoes,) due to gaps that rounded coordinates may have caused.

    Neighbouring contact nodes that lie off the drum to the same side count as a gap, even if each
    node lies off by less than the rounding. Rounding alone makes such a gap at a few of a thousand
    nodes. The errors are the changes of the response if these nodes lie on the drum.

    Parameters
    ----------
    brake : the brake
    respond : function that computes the response on a prepared model
    solved : a solved level
    prepare_fitting : function that makes the prepared model of a level, in which these nodes lie on
        the drum
    cache : cache of meshes that were read from files
    """
    for shoe in brake.shoes:
        read = read_mesh_file_of_shoe(brake, shoe, cache)
        gaps = np.zeros(0) if read is None else np.abs(read.off[read.off != 0])
        if read is not None and (gaps <= read.contact.largest_rounding_offset).any():
            cause = "without gaps below the rounding of coordinates"
            level = solved.prepared_model.level
            assert level is not None
            prepare = partial(prepare_fitting, level, solved.prepared_model.points)
            return _errors_by_change_of_shape(brake, respond, solved, prepare, cause)
    return 0.0


def _has_mesh_sides_off_smooth_outline(
    brake: Brake, degree: int, cache: CacheOfCondensedBodies
) -> bool:
    """Whether the mesh of a file has sides that lie noticeably off its smooth outline.

    Such sides are straight or, if the `degree` of the elements is at least 3, parabolas of strong
    curvature.
    """
    for shoe in brake.shoes:
        read = read_mesh_file_of_shoe(brake, shoe, cache)
        if read is not None:
            basis = nodal_basis_of_shoe_mesh(read.mesh, degree, shoe, brake.size)
            largest = abs(node_displacements_onto_smooth_outline(basis)).max()
            if largest > NEGLIGIBLE_DISTANCE_OF_SIDE_FROM_ARC * shoe.lining.thickness:
                return True
    return False
