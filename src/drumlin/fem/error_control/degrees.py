"""A brake solved on meshes of files with stated errors, by elements of higher and higher degree.

The elements of a mesh file stay as they are. The displacements on them are polynomials of degree 2,
then 3 and 4. The errors of the last answer follow from the differences between these answers. In a
further answer arcs take the place of straight element sides on curved outlines. The difference to
this answer is the error by the straight sides. Shoes without a mesh file and the drum's ring are
divided into more and more elements instead.
"""

from collections.abc import Iterator
from dataclasses import replace

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.adapt import (
    DEFAULT_TOLERANCE,
    Tolerance,
    errors_with_singular_points_included,
    is_tolerance_met,
    response_with_estimated_errors,
)
from drumlin.fem.error_control.estimate import (
    Errors,
    Factors,
    errors_from_differences,
    relative_differences_of_two_levels,
)
from drumlin.fem.error_control.levels import ResponseFunction, SolvedLevel
from drumlin.fem.preparation.cache import Cache
from drumlin.fem.preparation.meshes import ELEMENTS, RaisedDegree, read_mesh_file_of_shoe
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.response.response import Response

DEGREES = (2, 3, 4)
"""The degrees of the displacements on the mesh of a file, one after the other."""
DEGREE_FACTORS = Factors(pressure=1.25, force=1.5, cancelled=0.015, peak=1.5)
"""The factors of the error estimate that compares two degrees; see `Factors` for each number.

A smaller factor makes stated errors too small, a larger one only larger. On 124 meshes by Gmsh of
25 random shoes a pressure factor of 1.06, a force factor of 0.92 and a peak factor of 1.04 would
just suffice, with the other numbers as they are. `make degrees` compares stated with true errors
on further meshes.
"""
FORMER_SHARE = 0.2
"""Share of the difference of the two degrees before that is added to the last difference.

The last difference may be small by accident. Without the share one of the 124 torques was 1.7 times
as far off as stated. With 0.05 none is; with 0.2 stated errors are some tenth larger.
"""
OUTLINE_FACTOR = 1.1
"""Error by straight sides on a curved outline, over the difference that arcs in their place make.

Where the sides are the largest error, the difference is the true error within some per cent. The
tenth above 1 allows for this. A smaller factor makes stated errors too small. The value is a
judgement.
"""
NEGLIGIBLE_MOVE = 1e-4
"""Largest distance between side and arc, relative to the lining's thickness, that is neglected.

The torque changes by a fiftieth of the relative distance. Quadratic sides that follow an arc of a
tenth of its radius lie 3e-5 of a lining's thickness off it.
"""
MOST_RAISED_NODES = 150_000
"""Largest number of nodes of a shoe at a raised degree.

A solve with this number takes a minute. The degree of a larger mesh is not raised so far.
"""


def solve_meshes_of_files(
    brake: Brake, respond: ResponseFunction, tolerance: float | None, cache: Cache | None = None
) -> SolvedLevel:
    """Solve a brake on the meshes of its shoes' files, with stated errors.

    Returns the prepared model of the highest degree that was solved, and the response on it. The
    degree rises until the estimated errors meet the tolerance, or to the last degree. If a given
    tolerance is not met, the response has a warning. If the errors cannot be estimated, the brake
    is solved with elements of the meshes' own degrees, and a note gives the reason why no error is
    stated.

    Parameters
    ----------
    brake : the brake; at least one shoe has a mesh file
    respond : function that computes the response on a prepared model
    tolerance : largest relative error of p and of the torque; None for the default tolerance
    cache : keeps the stiffness matrices of bodies from earlier solves

    Raises
    ------
    BadInput
        for a mesh file that cannot serve
    NoAnswer
        if the brake has no solution on the meshes' own degrees
    """
    cache = cache or Cache()
    aim = DEFAULT_TOLERANCE if tolerance is None else Tolerance(tolerance, tolerance)
    responses: list[Response] = []
    error: Errors | None = None
    stopped = ""
    try:
        for scene, response in _solved_models_at_rising_degrees(brake, respond, cache):
            responses.append(response)
            solved_last = scene
            if len(responses) == 1:
                continue
            if len(responses) == 2:
                outline = _errors_of_straight_sides(brake, respond, responses[0], cache)
            error = _errors_of_last_degree(brake, responses, outline)
            if is_tolerance_met(error, aim):
                break
    except NoAnswer as refusal:
        stopped = str(refusal)
    if error is None:
        why = stopped or "not even degree 3 is solved, the mesh is too fine"
        own = make_prepared_model(brake, cache=cache)
        response = respond(own, brake)
        warning = f"warning: no error stated: {why}"
        return SolvedLevel(own, replace(response, notes=(*response.notes, warning)))
    notes = [f"meshes of files: elements of degree {DEGREES[len(responses) - 1]}"]
    if stopped:
        notes.append(f"meshes of files: no higher degree: {stopped}")
    if tolerance is not None and not is_tolerance_met(error, aim):
        notes.append(
            f"warning: tolerance {tolerance:g} not reached on the meshes of the files: estimated "
            f"error of p {error.brake['pressure']:.1e}, of the torque {error.brake['torque']:.1e}; "
            "a finer mesh makes it smaller"
        )
    return SolvedLevel(solved_last, response_with_estimated_errors(responses, error, notes))


def _solved_models_at_rising_degrees(
    brake: Brake, respond: ResponseFunction, cache: Cache
) -> Iterator[SolvedLevel]:
    """Yield the solved model of a brake at each degree at which its meshes have few enough nodes.

    Raises NoAnswer with the degree at which the brake has no solution.
    """
    last: Response | None = None
    for degree in DEGREES:
        if not _is_small_enough_at_degree(brake, degree, cache):
            return
        # Parametric shoes and the ring have twice as many elements at each degree.
        elements = ELEMENTS * 2**degree // 2 ** DEGREES[1]
        raised = RaisedDegree(degree)
        try:
            scene = make_prepared_model(brake, elements=elements, raised=raised, cache=cache)
            last = respond(scene, brake, start=last)
        except NoAnswer as refusal:
            raise NoAnswer(f"at degree {degree}: {refusal}") from refusal
        yield SolvedLevel(scene, last)


def _is_small_enough_at_degree(brake: Brake, degree: int, cache: Cache) -> bool:
    """Whether the meshes of all files have few enough nodes to be solved at a degree."""
    # The module loads scikit-fem, which takes long.
    from drumlin.fem.mesh.degree import number_of_nodes_at_degree  # noqa: PLC0415

    for shoe in brake.shoes:
        read = read_mesh_file_of_shoe(brake, shoe, cache)
        if read and number_of_nodes_at_degree(read.mesh, degree) > MOST_RAISED_NODES:
            return False
    return True


def _errors_of_last_degree(
    brake: Brake, responses: list[Response], outline: Floats | float
) -> Errors:
    """The estimated errors of the last of at least two responses.

    `outline` (1 + 4 shoes,) are the errors by straight sides, in the order of `LevelDifferences`.
    """
    *former, before, last = responses
    moved = relative_differences_of_two_levels(brake, before, last)
    if former:
        steps = relative_differences_of_two_levels(brake, former[-1], before).steps
        moved = moved._replace(steps=moved.steps + FORMER_SHARE * steps)
    errors = errors_from_differences(moved, last, DEGREE_FACTORS, outline)
    return errors_with_singular_points_included(errors, brake, last)[0]


def _errors_of_straight_sides(
    brake: Brake, respond: ResponseFunction, first: Response, cache: Cache
) -> Floats | float:
    """The relative errors (1 + 4 shoes,) that straight sides on curved outlines cause.

    They are 0 if the sides follow the curves already. `first` is the response at the first degree.
    """
    if not _has_straight_sides_on_curves(brake, cache):
        return 0.0
    raised = RaisedDegree(DEGREES[0], smooth=True)
    elements = ELEMENTS * 2 ** DEGREES[0] // 2 ** DEGREES[1]
    try:
        scene = make_prepared_model(brake, elements=elements, raised=raised, cache=cache)
        smooth = respond(scene, brake, start=first)
    except NoAnswer as refusal:
        raise NoAnswer(f"with sides that follow the curves: {refusal}") from refusal
    return OUTLINE_FACTOR * relative_differences_of_two_levels(brake, smooth, first).steps


def _has_straight_sides_on_curves(brake: Brake, cache: Cache) -> bool:
    """Whether the mesh of a file has straight sides that lie noticeably off a smooth outline."""
    # The modules load scikit-fem, which takes long.
    from drumlin.fem.mesh.degree import nodal_basis_of_shoe_mesh  # noqa: PLC0415
    from drumlin.fem.mesh.smooth_outline import moves_onto_smooth_outline  # noqa: PLC0415

    for shoe in brake.shoes:
        read = read_mesh_file_of_shoe(brake, shoe, cache)
        if read is not None:
            basis = nodal_basis_of_shoe_mesh(read.mesh, DEGREES[0], shoe, brake.size)
            largest = abs(moves_onto_smooth_outline(basis)).max()
            if largest > NEGLIGIBLE_MOVE * shoe.lining.thickness:
                return True
    return False
