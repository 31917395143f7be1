"""Errors of the plane-stress model against solid shoes with polynomials across their width.

The module makes tables of the errors, maps of the errors over two quantities, and simulates the
wear of solid linings across their width. Both models use the same mesh of hp elements in the plane
of the drum. Therefore the error of this mesh nearly cancels in the difference of both models. A
comparison on three meshes shows how much remains of it.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.texts import number_as_text
from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.hp.division import RefinementLevel
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve as by_elements
from drumlin.fem.width.correction import correct_response_for_shoe_widths
from drumlin.fem.width.face import ContactFaceWithWidth
from drumlin.fem.width.prepare import prepare_model_with_shoe_widths
from drumlin.foundation import model as foundation
from drumlin.laws import LAWS_OF_HINGED_SHOES_BY_NAME, hinged, solve_brake_by_sine_law
from drumlin.lining_wear.archard import WearLaw, wear_linings_in_given_steps
from drumlin.lining_wear.linings import wear_setup_by_finite_elements
from drumlin.response.norms import (
    relative_distance_of_pressures,
    relative_distance_of_vectors,
    relative_error_of_number,
)
from drumlin.response.response import (
    PressureOverArcAndWidth,
    Response,
    ShoeResponse,
    length_of_edge_zone_left_out_of_peak_search,
)
from drumlin_studies.tables import values_of_key_in_rows
from drumlin_studies.uncertainty import (
    ComparisonOfSimulationWithData,
    compare_simulated_value_with_reference_value,
)

WIDTH_ERROR_NAMES_BY_ROW_KEY = {
    "torque": "torque",
    "pressure": "mean p over the width (L2)",
    "peak": "peak pressure against the face's",
    "reaction": "hinge reaction",
    "uneven": "p on the face off its mean across the width",
    "corrected_torque": "torque, corrected",
    "corrected_pressure": "mean p, corrected",
}
"""Errors in a row of `plane_stress_error_rows_of_shoes`: name in tables, by key of the row.

"corrected" stands for plane stress with the correction for the finite width of the shoe.
"""
WIDTH_ERROR_WORDS_IN_SENTENCES = {
    "torque": "the torque of each shoe",
    "pressure": "its mean pressure",
}
"""Words for two keys of WIDTH_ERROR_NAMES_BY_ROW_KEY in sentences of the report."""
DEFAULT_DEGREE_ACROSS_SOLID_WIDTH = 3
"""Default degree of the polynomials across the width of solid shoes."""
REPORTED_PLANE_STRESS_ERROR_LIMITS = (0.01, 0.05, 0.20)
"""Limits of the relative error. For each limit the report states the range of brakes in which the
error of plane stress is within it.
"""


class ResponsesBySolidAndPlaneStress(NamedTuple):
    """A brake with its responses by solid shoes, by plane stress, and by corrected plane stress.

    The correction estimates the effect of the widths of the shoes' parts.
    """

    brake: Brake
    solid: Response
    plane: Response
    corrected: Response


def solve_by_solid_and_plane_stress(
    brake: Brake, across: int = DEFAULT_DEGREE_ACROSS_SOLID_WIDTH
) -> ResponsesBySolidAndPlaneStress:
    """The responses of a brake by the three models of `ResponsesBySolidAndPlaneStress`.

    All models have the same mesh in the plane of the drum.

    across : degree across the width of the solid shoes.
    """
    plane = solve_prepared_model(
        make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0]), brake
    )
    true = solve_with_solid_shoes(brake, across)
    return ResponsesBySolidAndPlaneStress(
        brake, true, plane, correct_response_for_shoe_widths(brake, plane)
    )


def relative_pressure_deviation_across_width(shoe: ShoeResponse, zone: float) -> float:
    """Standard deviation of a solid shoe's pressure across the width, over the mean pressure.

    The standard deviation across the width and the mean over the width vary along the lining. The
    result is the ratio of their root mean squares along the lining. It is 0 for an even pressure
    across the width.

    shoe : the response of a solid shoe; zone : angle [rad] at each end of the lining that is left
    out.
    """
    theta, surface = shoe.theta, pressure_over_friction_face_of_solid_shoe(shoe)
    inside = (theta > theta[0] + zone) & (theta < theta[-1] - zone)
    weights = np.gradient(theta)[inside]
    z = surface.z
    # Weights of Simpson's rule across the width. Each element has three nodes across the width.
    across = np.zeros(len(z))
    for k in range(0, len(z) - 2, 2):
        across[k : k + 3] += (z[k + 2] - z[k]) / 6 * np.array([1, 4, 1])
    # The variance across the width, and the square of the mean over the width, are integrated along
    # the lining.
    off = surface.pressure[inside] - shoe.pressure[inside, None]
    variance = weights @ (off**2 @ across) / across.sum()
    size = weights @ shoe.pressure[inside] ** 2
    return float(np.sqrt(variance / size)) if size > 0 else 0.0


def pressure_over_friction_face_of_solid_shoe(shoe: ShoeResponse) -> PressureOverArcAndWidth:
    """The pressure on the whole friction face of a solid shoe, along and across."""
    assert shoe.surface is not None
    return shoe.surface


def largest_pressure_on_solid_face(shoe: ShoeResponse, zone: float) -> float:
    """The largest pressure on the friction face of a solid shoe [Pa].

    zone : angle [rad] at each end of the lining that is left out.
    """
    inside = (shoe.theta > shoe.theta[0] + zone) & (shoe.theta < shoe.theta[-1] - zone)
    return float(pressure_over_friction_face_of_solid_shoe(shoe).pressure[inside].max())


def plane_stress_error_rows_of_shoes(
    three: ResponsesBySolidAndPlaneStress, case: str = ""
) -> list[dict[str, Any]]:
    """A row for each shoe with the relative errors of plane stress against the solid shoe.

    Keys: `torque`; `pressure`, the L2 error of the mean pressure over the width; `peak`, the error
    of the peak pressure by plane stress against the largest pressure on the friction face;
    `reaction`, the hinge reaction. The same four keys with the prefix "corrected_" are the errors
    of plane stress with the correction for the width. `uneven` is the result of
    `relative_pressure_deviation_across_width`, `mid_over_side` of `mid_plane_over_side_pressure`.

    three : the responses of the brake; case : name of the brake in the rows.
    """
    table = []
    # The zones at the lining's ends, where the pressure is singular, are left out of pressure
    # errors.
    for i, (true, plane, other) in enumerate(
        zip(three.solid.shoes, three.plane.shoes, three.corrected.shoes, strict=True)
    ):
        zone = length_of_edge_zone_left_out_of_peak_search(
            three.brake.shoes[i], three.brake.length_per_surface_coordinate
        )
        row: dict[str, Any] = {
            "case": case,
            "shoe": true.name,
            "friction": "assists" if true.self_energising else "opposes",
            "solid_torque": true.torque,
            "uneven": relative_pressure_deviation_across_width(true, zone),
            "mid_over_side": mid_plane_over_side_pressure(true),
        }
        for name, found in (("", plane), ("corrected_", other)):
            row |= {
                f"{name}torque": relative_error_of_number(found.torque, true.torque),
                f"{name}pressure": relative_distance_of_pressures(found, true, zone),
                f"{name}peak": relative_error_of_number(
                    found.peak_pressure, largest_pressure_on_solid_face(true, zone)
                ),
                f"{name}reaction": relative_distance_of_vectors(
                    found.hinge_reaction, true.hinge_reaction
                ),
            }
        table.append(row)
    return table


def mid_plane_over_side_pressure(shoe: ShoeResponse) -> float:
    """Pressure of a solid shoe in its mid-plane, divided by the pressure at its side.

    The ratio is taken in the middle of the contact, among the rows of nodes across the width that
    touch the drum with all nodes. The result is inf if no row touches with all nodes.
    """
    p = pressure_over_friction_face_of_solid_shoe(shoe).pressure
    # Indices of the rows of nodes across the width whose nodes all touch the drum.
    pressed = np.flatnonzero((p > 0).all(axis=1))
    if not len(pressed):
        return float("inf")
    row = p[pressed[len(pressed) // 2]]
    return float(row[len(row) // 2] / row[-1])


def value_of_largest_magnitude_in_rows(table: Sequence[dict[str, Any]], key: str) -> float:
    """The largest value of a key in magnitude among the rows, with its sign."""
    return float(max(values_of_key_in_rows(table, key), key=abs))


@dataclass(frozen=True)
class PlaneStressErrorMap:
    """Map of the relative errors of plane stress over two quantities that are varied.

    Attributes
    ----------
    name : str
        Title of the map.
    axes : tuple of two str
        Names of the two quantities.
    x, y : array (n,), array (m,)
        Values of the first and of the second quantity.
    errors : dict
        Arrays (m, n) of errors, by key of `plane_stress_error_rows_of_shoes`. Each error is the
        error of the shoe with the largest error.
    """

    name: str
    axes: tuple[str, str]
    x: Floats
    y: Floats
    errors: dict[str, Floats]

    def fraction_of_brakes_within_error(self, limit: float, key: str = "torque") -> float:
        """Fraction of the brakes of the map whose error `key` is at most `limit` in size."""
        return float(np.mean(np.abs(self.errors[key]) <= limit))

    def describe_range_within_error(self, limit: float, key: str = "torque") -> str:
        """The range of each quantity in which all errors `key` are at most `limit`, in words."""
        within = np.abs(self.errors[key]) <= limit
        if within.all():
            return "everywhere"
        found = []
        for name, values, along in zip(self.axes, (self.x, self.y), (0, 1), strict=True):
            lines = np.asarray(within.all(axis=along))
            # Number of successive values of the quantity with which all errors are within the
            # limit, counted from the last value backwards and from the first value onwards.
            from_last, from_first = int(np.cumprod(lines[::-1]).sum()), int(np.cumprod(lines).sum())
            if from_last:
                found.append(f"{name} from {values[-from_last]:g} on")
            if from_first:
                found.append(f"{name} up to {values[from_first - 1]:g}")
        return " or ".join(found) or "for no whole row or column of the map"


def map_plane_stress_errors(
    name: str,
    axes: tuple[str, str],
    brake_at: Callable[[float, float], Brake],
    x: Sequence[float],
    y: Sequence[float],
    say: Callable[[str], None],
) -> PlaneStressErrorMap:
    """The map of the errors of plane stress over a grid of brakes.

    Parameters
    ----------
    name, axes : str, tuple of two str
        Title of the map and names of its two quantities, which become attributes of the
        `PlaneStressErrorMap`.
    brake_at : function
        Returns the brake for a value of each quantity.
    x, y : sequence of float
        Values of the first and of the second quantity.
    say : function
        Is called with a line of text on the progress.
    """
    keys = [*WIDTH_ERROR_NAMES_BY_ROW_KEY, "mid_over_side"]
    errors = {key: np.full((len(y), len(x)), np.nan) for key in keys}
    for j, b in enumerate(y):
        for i, a in enumerate(x):
            say(f"{name}: {j * len(x) + i} of {len(x) * len(y)}")
            table = plane_stress_error_rows_of_shoes(
                solve_by_solid_and_plane_stress(brake_at(a, b))
            )
            for key in keys:
                errors[key][j, i] = value_of_largest_magnitude_in_rows(table, key)
    return PlaneStressErrorMap(name, axes, np.asarray(x), np.asarray(y), errors)


def rows_of_shares_within_error_limits(
    charts: Sequence[PlaneStressErrorMap],
) -> list[dict[str, Any]]:
    """A row for each map and each error: largest error, and shares of brakes within the limits.

    The limits are REPORTED_PLANE_STRESS_ERROR_LIMITS.

    A share is the fraction of the brakes of the map whose error is within a limit.
    """
    table = []
    for chart in charts:
        for key, name in WIDTH_ERROR_NAMES_BY_ROW_KEY.items():
            row: dict[str, Any] = {"map": chart.name, "quantity": name}
            row["largest"] = float(np.abs(chart.errors[key]).max())
            for limit in REPORTED_PLANE_STRESS_ERROR_LIMITS:
                row[f"within_{limit:g}"] = chart.fraction_of_brakes_within_error(limit, key)
            table.append(row)
    return table


class TorqueOnLevels(NamedTuple):
    """The torque of a brake on several levels: finer and finer meshes in the plane of the drum.

    Attributes
    ----------
    degrees : tuple of int
        Polynomial degree in the plane of the drum on each level, coarse to fine.
    values : tuple of float
        Torque on each level [N m].
    """

    degrees: tuple[int, ...]
    values: tuple[float, ...]

    @property
    def uncertainty_of_finest_torque(self) -> float:
        """Uncertainty of the torque on the finest level [N m]: largest minus smallest value."""
        return float(np.ptp(self.values))


def solve_torque_on_refinement_levels(
    torque: Callable[[RefinementLevel], float], levels: Sequence[RefinementLevel]
) -> TorqueOnLevels:
    """The torque of a brake on several levels, which are finer and finer meshes.

    torque : function that returns the torque [N m] on a level; levels : the levels, coarse to fine.
    """
    return TorqueOnLevels(tuple(level.degree for level in levels), tuple(map(torque, levels)))


def compare_plane_stress_torque_with_solid(
    plane: TorqueOnLevels, true: TorqueOnLevels
) -> ComparisonOfSimulationWithData:
    """The error of the torque by plane stress against the solid shoe, with its uncertainty.

    The uncertainty comes from the meshes of both models.

    plane, true : torque by plane stress and by solid shoes, each on the same levels.
    """
    return compare_simulated_value_with_reference_value(
        plane.values[-1],
        true.values[-1],
        numerical=plane.uncertainty_of_finest_torque,
        of_data=true.uncertainty_of_finest_torque,
    )


class TimeAndErrors(NamedTuple):
    """Time and errors of a model on a brake.

    The errors are relative. Each is the error of the shoe with the largest error. The error of the
    pressure is the L2 error of the mean pressure over the width.

    Attributes
    ----------
    method, setting : str
        Name of the model, and its mesh or option.
    seconds : float
        Processor time [s].
    torque, pressure : float
        Errors against a fine solution with solid shoes.
    plane_torque, plane_pressure : float
        Errors against a fine solution in plane stress.
    """

    method: str
    setting: str
    seconds: float
    torque: float
    pressure: float
    plane_torque: float
    plane_pressure: float


class ModelWithFunctionThatSolvesBrake(NamedTuple):
    """A model with its setting, and a function that solves the brake by the model."""

    method: str
    setting: str
    solve: Callable[[], Response]


def measure_time_and_errors_of_models(
    brake: Brake, fine: int, meshes: Sequence[int], solids: Sequence[int]
) -> list[TimeAndErrors]:
    """Time and errors of laws, foundation model, plane stress and solid shoes on a brake.

    Errors are differences from two responses: solid shoes with a high degree across the width, and
    the default solve in plane stress.

    Parameters
    ----------
    brake : Brake
        The brake.
    fine : int
        Degree across the width of the solid shoes that serve as the truth.
    meshes : sequence of int
        Elements along a lining of each solve in plane stress. Each mesh is used with and without
        the correction for the width.
    solids : sequence of int
        Degree across the width of each timed solve with solid shoes.
    """
    truths = (
        solve_with_solid_shoes(brake, fine, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1]),
        by_elements(brake),
    )
    rungs = []
    for method, setting, solve_once in _list_brake_models_with_their_solve_functions(
        brake, meshes, solids
    ):
        seconds = []
        # The first of four calls is not counted, because it loads modules and fills caches. Solid
        # shoes take so long that they are called only once, and this call counts.
        for _ in range(1 if method == "solid" else 4):
            start = time.process_time()
            response = solve_once()
            seconds.append(time.process_time() - start)
        errors: list[float] = []
        for truth in truths:
            errors += _largest_torque_and_pressure_error(brake, response, truth)
        rungs.append(
            TimeAndErrors(method, setting, float(np.median(seconds[1:] or seconds)), *errors)
        )
    return rungs


def _list_brake_models_with_their_solve_functions(
    brake: Brake, meshes: Sequence[int], solids: Sequence[int]
) -> list[ModelWithFunctionThatSolvesBrake]:
    """The models that are measured, from the laws to the finest solid shoes."""
    models = []
    by_law = hinged.solve_brake_with_hinged_shoes_by_law
    for name in ("sine", "cosine", "uniform"):
        solve_by_law = partial(by_law, LAWS_OF_HINGED_SHOES_BY_NAME[name], brake)
        models.append(ModelWithFunctionThatSolvesBrake(name, "", solve_by_law))
    if foundation.reason_against_foundation_model(brake) is None:
        plain = partial(foundation.solve_brake_by_foundation_model, brake, lift=())
        models.append(ModelWithFunctionThatSolvesBrake("foundation", "", plain))
        lifted = partial(foundation.solve_brake_by_foundation_model, brake, lift=("all",))
        models.append(ModelWithFunctionThatSolvesBrake("lifted", "all", lifted))
    for n in meshes:
        setting = f"{n} elements"
        models.append(
            ModelWithFunctionThatSolvesBrake(
                "plane stress", setting, partial(_solve_in_plane_stress, brake, n)
            )
        )
        by_corrected = partial(_solve_brake_with_width_correction, brake, n)
        models.append(
            ModelWithFunctionThatSolvesBrake("plane stress, corrected", setting, by_corrected)
        )
    for n in solids:
        models.append(
            ModelWithFunctionThatSolvesBrake(
                "solid", f"degree {n}", partial(solve_with_solid_shoes, brake, n)
            )
        )
    return models


def _largest_torque_and_pressure_error(
    brake: Brake, response: Response, truth: Response
) -> tuple[float, float]:
    """The largest relative error of any shoe's torque, and the largest of any shoe's pressure."""
    torque, pressure = 0.0, 0.0
    for found, true, shoe in zip(response.shoes, truth.shoes, brake.shoes, strict=True):
        torque = max(torque, abs(relative_error_of_number(found.torque, true.torque)))
        zone = length_of_edge_zone_left_out_of_peak_search(
            shoe, brake.length_per_surface_coordinate
        )
        pressure = max(pressure, abs(relative_distance_of_pressures(found, true, zone)))
    return torque, pressure


def _solve_in_plane_stress(brake: Brake, elements: int) -> Response:
    """The response of a brake in plane stress, with `elements` elements along each lining."""
    return solve_prepared_model(make_prepared_model(brake, elements=elements), brake)


def _solve_brake_with_width_correction(brake: Brake, elements: int) -> Response:
    """The response of a brake in plane stress on a mesh, corrected for the widths of the shoes."""
    return correct_response_for_shoe_widths(brake, _solve_in_plane_stress(brake, elements))


def solve_with_solid_shoes(
    brake: Brake,
    across: int = DEFAULT_DEGREE_ACROSS_SOLID_WIDTH,
    level: RefinementLevel = REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0],
) -> Response:
    """The response of a brake with solid shoes.

    across, level : degree across the width, and level of the mesh in the plane of the drum.
    """
    return solve_prepared_model(prepare_model_with_shoe_widths(brake, level, across), brake)


class PressuresOfWornSolidLinings(NamedTuple):
    """The pressures of solid linings that wear, over the sliding distance.

    Attributes
    ----------
    distance : tuple of float
        Sliding distances in units of 1/(k K), with the wear coefficient k and the stiffness K of
        the lining (pressure per compression).
    uneven : tuple of tuples
        For each lining and distance the result of `relative_pressure_deviation_across_width`.
    distance_from_sine_law : tuple of tuples
        For each lining and distance the relative L2 distance of the mean pressure over the width
        from the pressure by the sine law.
    last : tuple of ShoeResponse
        The response of the shoe of each lining, at the last distance.
    """

    distance: tuple[float, ...]
    uneven: tuple[tuple[float, ...], ...]
    distance_from_sine_law: tuple[tuple[float, ...], ...]
    last: tuple[ShoeResponse, ...]


def wear_solid_linings(
    brake: Brake, distances: Sequence[float], across: int = DEFAULT_DEGREE_ACROSS_SOLID_WIDTH
) -> PressuresOfWornSolidLinings:
    """The pressures of a brake's solid linings as they wear by Archard's law.

    Parameters
    ----------
    brake : Brake
        The brake with new linings.
    distances : sequence of float
        Sliding distances in units of 1/(k K), as in `PressuresOfWornSolidLinings`; the first is 0.
    across : int
        Degree across the width.
    """
    scene = prepare_model_with_shoe_widths(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], across)
    start, law = solve_prepared_model(scene, brake), solve_brake_by_sine_law(brake)
    setup = wear_setup_by_finite_elements(scene, brake)
    # The sliding distance 1/(k K) for a wear coefficient k of 1/Pa.
    unit = 1 / setup.lining_stiffness_per_area
    states = wear_linings_in_given_steps(
        setup.interfaces, WearLaw(1.0), [s * unit for s in distances[1:]]
    )
    all_uneven, all_from_law, last = [], [], []
    for surface in setup.surfaces:
        line, first = scene.bodies[surface.shoe].line, start.shoes[surface.shoe]
        shoes = []
        for state in states:
            pressure = state.pressure[surface.part]
            shoes.append(
                _response_with_worn_lining_pressure(line, first, surface.forward, pressure)
            )
        zone = length_of_edge_zone_left_out_of_peak_search(
            brake.shoes[surface.shoe], brake.length_per_surface_coordinate
        )
        by_law = law.shoes[surface.shoe]
        all_uneven.append(
            tuple(relative_pressure_deviation_across_width(shoe, zone) for shoe in shoes)
        )
        all_from_law.append(
            tuple(relative_distance_of_pressures(shoe, by_law, zone) for shoe in shoes)
        )
        last.append(shoes[-1])
    return PressuresOfWornSolidLinings(
        tuple(distances), tuple(all_uneven), tuple(all_from_law), tuple(last)
    )


def _response_with_worn_lining_pressure(
    line: Any, first: ShoeResponse, forward: slice, p: Floats
) -> ShoeResponse:
    """The response of a shoe before wear, with its pressure replaced by the worn lining's.

    Parameters
    ----------
    line : ContactFaceWithWidth
        Friction face of the lining.
    first : ShoeResponse
        The response of the shoe before wear.
    forward : slice
        Slice that sorts the lining's nodes along growing angles.
    p : array
        Pressures at the nodes of the worn lining's face [Pa].
    """
    assert isinstance(line, ContactFaceWithWidth)
    _, mean = line.angles_and_pressures_averaged_over_width(p)
    face = line.pressure_distribution_over_arc_and_width(p)
    surface = face._replace(pressure=face.pressure[forward])
    return replace(first, pressure=mean[forward], surface=surface)


def brake_with_width_and_lining_modulus(brake: Brake, width: float, modulus: float) -> Brake:
    """The brake with shoes of one width, without backing, and with another lining modulus.

    width : width of linings and bodies [m]; modulus : Young's modulus of the linings [Pa].
    """
    return vary(
        brake,
        {
            "shoe.lining.width": width,
            "shoe.body.width": width,
            "shoe.backing": None,
            "shoe.lining.material.E": modulus,
        },
    )


def sentences_on_largest_plane_stress_errors(
    curves: Mapping[str, Sequence[tuple[float, list[dict[str, Any]]]]],
) -> list[str]:
    """A sentence for each varied quantity: the largest errors of plane stress and where they occur.

    curves : for the name of each quantity a sequence of its values, each with the rows of
    `plane_stress_error_rows_of_shoes` for the brake.
    """
    lines = []
    for name, points in curves.items():
        largest = []
        for key, said in WIDTH_ERROR_WORDS_IN_SENTENCES.items():
            # The largest error, and the value of the quantity at which it occurs. Of equal errors
            # `max` takes the error at the largest value of the quantity.
            error, at = max(
                (abs(value_of_largest_magnitude_in_rows(table, key)), at) for at, table in points
            )
            largest.append(f"{said} by {number_as_text(error, '.1%')} (at {at:g})")
        values = f"{name} from {points[0][0]:g} to {points[-1][0]:g}"
        lines.append(f"T-section over {values}, off at most: {', '.join(largest)}")
    return lines


def sentences_on_maps_of_plane_stress_errors(charts: Sequence[PlaneStressErrorMap]) -> list[str]:
    """Sentences on each map: the ranges in which the errors are within the reported limits."""
    lines = []
    for chart in charts:
        torque = chart.errors["torque"]
        worst_of = torque.ravel()[np.abs(torque).argmax()]
        for key, said in WIDTH_ERROR_WORDS_IN_SENTENCES.items():
            end = f" (at worst {number_as_text(worst_of, '+.1%')})" if key == "torque" else ""
            parts = "; ".join(_describe_map_ranges_within_limits(chart, key))
            lines.append(f"{chart.name}: plane stress has {said}{end} within {parts}")
    return lines


def _describe_map_ranges_within_limits(chart: PlaneStressErrorMap, key: str) -> list[str]:
    """Texts, one for each reported limit: the range of a map with errors within the limit.

    The list ends after the first limit within which all errors of the map lie.
    """
    parts = []
    for limit in REPORTED_PLANE_STRESS_ERROR_LIMITS:
        where = chart.describe_range_within_error(limit, key)
        parts.append(f"{number_as_text(limit, '.0%')}: {where}")
        if where == "everywhere":
            break
    return parts
