"""The table of omissions: parts and effects of a brake that a simpler model neglects.

For each omission the table has the change of the answer, the predicted change, and the fractions of
time and memory that the omission saves.
"""

import math
import time
import tracemalloc
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from statistics import median
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import vary
from drumlin.fem.analysis.fields import stress_and_displacement_fields_of_shoe
from drumlin.fem.mesh.grading import divide_lining_into_elements
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.cache import cache_key_of_shoe_shape
from drumlin.fem.preparation.meshes import DEFAULT_ELEMENTS_ALONG_LINING
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.response.response import Response
from drumlin_studies.omission import (
    OMITTABLE_PARTS_AND_EFFECTS_BY_NAME,
    RelativeResponseChangesByOmission,
    names_of_omissions_possible_for_brake,
    predict_response_change_by_omitting_parts,
    prepare_model_with_straight_element_edges,
    prepared_model_and_brake_without_neglected_parts,
    relative_change_from_whole_to_simpler_brake,
)
from drumlin_studies.reduced import make_function_that_prepares_surrogates
from drumlin_studies.tables import rows_with_given_values

COMPUTATIONS_LEFT_OUT_WITHOUT_CHANGE_OF_ANSWER = {
    "interior fields": "not recovered",
    "second of equal shoes": "condensed once",
    "flexibility under drag, mu = 0": "symmetric part only",
}
"""Computations that a solve leaves out without any change of the answer.

Each key names the computation, and each value says how the solve avoids the computation. The last
entry is the flexibility of the shoes under friction, for a coefficient of friction mu of zero.
"""


class SolversOfWholeAndSimplerBrake(NamedTuple):
    """Two functions: one solves the whole brake, the other the brake with an omission.

    Each function prepares its model anew, so that a call takes the whole time of a solve.
    """

    whole: Callable[[], Response]
    simple: Callable[[], Response]


def table_rows_for_each_part_omitted_from_brake(
    brake: Brake, name: str, *, elements: int = DEFAULT_ELEMENTS_ALONG_LINING, repeats: int = 5
) -> list[dict[str, Any]]:
    """A row for each omission that a brake allows.

    The first rows are on COMPUTATIONS_LEFT_OUT_WITHOUT_CHANGE_OF_ANSWER, the next on each of
    OMITTABLE_PARTS_AND_EFFECTS_BY_NAME alone, the last on all OMITTABLE_PARTS_AND_EFFECTS_BY_NAME
    together. A row has the changes under the names of `RelativeResponseChangesByOmission`, and the
    predicted changes under the same names after "predicted_". `seconds` and `memory` are the
    fractions of time and memory of the whole solve that the omission saves. Where one of the two
    solves has no answer, the `status` of the row gives the reason.

    Parameters
    ----------
    brake : Brake
        The brake.
    name : str
        Name of the brake in the rows.
    elements : int
        Elements along each lining.
    repeats : int
        Number of timings of each solve; their median counts. With 0 the rows have no `seconds` and
        no `memory`.
    """
    rows: list[dict[str, Any]] = []
    for part, instead, names in _list_part_omissions_computed_for_brake(brake):
        exact = names is None
        pair = (
            _solvers_with_and_without_needless_computation(brake, part, elements)
            if names is None
            else _functions_that_solve_whole_and_simpler_brake(brake, names, elements)
        )
        if pair is None:
            continue
        row: dict[str, Any] = {"brake": name, "part": part, "instead": instead}
        row["exact"] = "yes" if exact else "no"
        try:
            row |= _omission_change_as_row(
                relative_change_from_whole_to_simpler_brake(pair.simple(), pair.whole()), ""
            )
            if names is not None:
                row |= _omission_change_as_row(
                    _predict_change_by_omitting_parts_or_edge_curvature(brake, names, elements),
                    "predicted_",
                )
            row |= (fractions_of_time_and_memory_saved(pair, repeats) if repeats else {}) | {
                "status": "converged"
            }
        except NoAnswer as error:
            row["status"] = f"failed: {error}"
        rows.append(row)
    return rows


def predicted_over_true_changes_by_omission(
    rows: Sequence[Mapping[str, Any]], key: str
) -> list[float]:
    """Predicted change divided by true change, for each row with a true change from 0.01 % to 30 %.

    Three kinds of rows are left out: omissions that change no answer, the curvature of the
    elements, and all omissions together with the curvature.

    rows : rows of `table_rows_for_each_part_omitted_from_brake`; key : attribute of
        `RelativeResponseChangesByOmission` that is compared.
    """
    ratios = []
    for row in rows:
        is_predicted = row["exact"] == "no" and row["part"] not in {"curvature", "all"}
        if is_predicted and 1e-4 < (row.get(key) or 0.0) < 0.3:
            ratios.append(row[f"predicted_{key}"] / row[key])
    return ratios


def saved_time_ranges_by_omission(
    rows: Sequence[Mapping[str, Any]], least: float
) -> dict[str, tuple[float, float]]:
    """Smallest and largest fraction of the time that each omission alone saves, by its name.

    rows : rows of `table_rows_for_each_part_omitted_from_brake`; least : fraction of the time that
    an omission must save on at least one brake to be in the result.
    """
    saving: dict[str, list[float]] = {}
    for row in rows:
        if row["exact"] == "no" and "seconds" in row and not row["part"].startswith("all"):
            saving.setdefault(row["part"], []).append(row["seconds"])
    ranges = {}
    for part, shares in saving.items():
        if max(shares) > least:
            ranges[part] = min(shares), max(shares)
    return ranges


def row_of_largest_pressure_change_by_straight_edges(
    rows: Sequence[Mapping[str, Any]],
) -> Mapping[str, Any] | None:
    """The row in which elements with straight edges change the pressure most.

    The result is None if straight edges change no pressure.
    """
    straight = rows_with_given_values(rows, part="curvature")
    # A row whose solve failed has no key "pressure" and counts as no change.
    worst = max(straight, key=lambda row: row.get("pressure") or 0.0, default=None)
    return worst if worst and worst.get("pressure") else None


class _OmissionRowBeforeItsChanges(NamedTuple):
    """A row of the table of omissions before its changes are computed.

    Attributes
    ----------
    part, instead : str
        The neglected part or effect, and the model that replaces it, in words.
    names : list of str or None
        Names of OMITTABLE_PARTS_AND_EFFECTS_BY_NAME; None for one of
        COMPUTATIONS_LEFT_OUT_WITHOUT_CHANGE_OF_ANSWER, which change no number.
    """

    part: str
    instead: str
    names: list[str] | None


def _list_part_omissions_computed_for_brake(brake: Brake) -> list[_OmissionRowBeforeItsChanges]:
    """The omissions for which a brake gets a row in the table, in the order of the rows.

    The COMPUTATIONS_LEFT_OUT_WITHOUT_CHANGE_OF_ANSWER come first, then each of
    OMITTABLE_PARTS_AND_EFFECTS_BY_NAME alone, then the OMITTABLE_PARTS_AND_EFFECTS_BY_NAME
    together.
    """
    rows = [
        _OmissionRowBeforeItsChanges(part, instead, None)
        for part, instead in COMPUTATIONS_LEFT_OUT_WITHOUT_CHANGE_OF_ANSWER.items()
    ]
    names = names_of_omissions_possible_for_brake(brake)
    together = []
    for part in names:
        rows.append(
            _OmissionRowBeforeItsChanges(
                part, OMITTABLE_PARTS_AND_EFFECTS_BY_NAME[part].instead, [part]
            )
        )
        # A rigid drum does not couple the shoes. Without the ring, the omission of the coupling
        # therefore changes nothing.
        if part != "curvature" and not (part == "coupling" and "ring" in names):
            together.append(part)
    if len(together) > 1:
        rows.append(
            _OmissionRowBeforeItsChanges("all but curvature", ", ".join(together), together)
        )
    if together and "curvature" in names:
        everything = [*together, "curvature"]
        rows.append(_OmissionRowBeforeItsChanges("all", ", ".join(everything), everything))
    return rows


def _omission_change_as_row(
    found: RelativeResponseChangesByOmission, prefix: str
) -> dict[str, float]:
    """The relative changes by an omission as keys and values of a table row.

    prefix : text before each key.
    """
    return {prefix + key: value for key, value in found._asdict().items()}


def fractions_of_time_and_memory_saved(
    pair: SolversOfWholeAndSimplerBrake, repeats: int
) -> dict[str, float]:
    """Fractions of time ("seconds") and peak memory of the whole solve that a simpler solve saves.

    Simpler and whole solves alternate. Each pair gives a ratio of times. The median of these ratios
    gives the saved time.

    pair : functions that run the two solves; repeats : number of timed pairs.
    """
    ratios = [
        _processor_seconds_of_solve(pair.simple) / _processor_seconds_of_solve(pair.whole)
        for _ in range(repeats)
    ]
    return {
        "seconds": 1 - median(ratios),
        "memory": 1
        - _peak_memory_of_one_solve(pair.simple) / _peak_memory_of_one_solve(pair.whole),
    }


def _processor_seconds_of_solve(solve: Callable[[], object]) -> float:
    """The processor time of one call of a function that solves a brake [s]."""
    start = time.process_time()
    solve()
    return time.process_time() - start


def _peak_memory_of_one_solve(solve: Callable[[], object]) -> int:
    """The peak memory [bytes] of Python and NumPy in one call of a function that solves a brake."""
    tracemalloc.start()
    try:
        solve()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def _functions_that_solve_whole_and_simpler_brake(
    brake: Brake, names: list[str], elements: int
) -> SolversOfWholeAndSimplerBrake:
    """Functions that solve the whole brake and the brake without the effects in `names`.

    elements : number of elements along each lining.
    """
    whole = partial(make_prepared_model, elements=elements)
    make = (
        partial(prepare_model_with_straight_element_edges, elements=elements)
        if "curvature" in names
        else whole
    )
    return SolversOfWholeAndSimplerBrake(
        lambda: solve_prepared_model(whole(brake), brake),
        lambda: solve_prepared_model(
            *prepared_model_and_brake_without_neglected_parts(brake, names, make)
        ),
    )


def _solvers_with_and_without_needless_computation(
    brake: Brake, part: str, elements: int
) -> SolversOfWholeAndSimplerBrake | None:
    """Functions that solve a brake with and without the needless computation `part`.

    The result is None where the omission does not apply to the brake.

    part : a key of COMPUTATIONS_LEFT_OUT_WITHOUT_CHANGE_OF_ANSWER; elements : number of elements
        along each lining.
    """
    make = partial(make_prepared_model, elements=elements)

    def solve_brake_without_extra_computation() -> Response:
        """The response by the usual solve, which leaves out the computation `part`."""
        return solve_prepared_model(make(brake), brake)

    if part == "interior fields":

        def solve_and_recover_stresses() -> Response:
            """The response after the stresses inside all shoes have been computed as well."""
            scene = make(brake)
            response = solve_prepared_model(scene, brake)
            for i in range(len(brake.shoes)):
                stress_and_displacement_fields_of_shoe(scene, brake, response, i)
            return response

        return SolversOfWholeAndSimplerBrake(
            solve_and_recover_stresses, solve_brake_without_extra_computation
        )
    if part == "second of equal shoes":
        shapes = {cache_key_of_shoe_shape(brake, shoe) for shoe in brake.shoes}
        # The omission does not apply to a brake without two equal shoes. It is not shown for an
        # elastic ring either: here the shoes are prepared one by one, but the ring belongs to all
        # shoes.
        if len(shapes) == len(brake.shoes) or brake.ring is not None:
            return None
        return SolversOfWholeAndSimplerBrake(
            lambda: solve_prepared_model(
                _prepare_model_with_separately_condensed_shoes(brake, make), brake
            ),
            solve_brake_without_extra_computation,
        )
    if brake.friction > 0:
        return None
    rubbing = vary(brake, {"friction": 0.3})
    return SolversOfWholeAndSimplerBrake(
        lambda: solve_prepared_model(make(rubbing), brake), solve_brake_without_extra_computation
    )


def _prepare_model_with_separately_condensed_shoes(
    brake: Brake, make: Callable[[Brake], PreparedModel]
) -> PreparedModel:
    """The prepared model of a brake in which each shoe is condensed by itself.

    An ordinary prepared model condenses shoes of equal shape only once.
    """
    bodies: list[Any] = []
    for shoe in brake.shoes:
        alone = make(brake.model_copy(update={"shoes": (shoe,)}))
        bodies += alone.bodies
    return replace(alone, brake=brake, bodies=tuple(bodies))


def _predict_change_by_omitting_parts_or_edge_curvature(
    brake: Brake, names: Iterable[str], elements: int
) -> RelativeResponseChangesByOmission:
    """The predicted change of the answer by some omissions, which may include "curvature".

    The surrogate predicts all other omissions. "curvature" means straight element edges: their
    effect depends on the number of elements along a lining and is predicted in closed form.
    """
    names = list(names)
    if "curvature" not in names:
        return predict_response_change_by_omitting_parts(brake, names, solve_prepared_model)
    sketch = make_function_that_prepares_surrogates()
    whole = solve_prepared_model(sketch(brake), brake)
    # The other omissions are predicted on a surrogate. The surrogate also gets a clearance: the
    # mean gap between the chords of the elements and the arc of the drum.
    scene, simple = prepared_model_and_brake_without_neglected_parts(
        brake, set(names) - {"curvature"}, sketch
    )
    rest = solve_prepared_model(scene, simple)
    straightened = tuple(
        _shoe_with_clearance_like_straight_edge_gap(brake, shoe, elements) for shoe in simple.shoes
    )
    straight = simple.model_copy(update={"shoes": straightened})
    found = relative_change_from_whole_to_simpler_brake(
        solve_prepared_model(scene, straight), whole
    )
    # The gap also varies within each element and causes waves of the pressure. A closed form gives
    # these waves.
    waves = []
    for shoe, answer in zip(brake.shoes, rest.shoes, strict=True):
        size = _root_mean_square_of_pressure(answer.theta, answer.pressure)
        waves.append(
            rms_pressure_waves_due_to_straight_edges(brake, shoe, elements) / size if size else 0.0
        )
    return found._replace(pressure=math.hypot(found.pressure, max(waves)))


def _element_angles_and_chord_sagittas(
    brake: Brake, shoe: Shoe, elements: int
) -> tuple[Floats, Floats]:
    """Ends (m + 1,) [rad] of the elements along a lining, and sagittas (m,) [m] of their chords.

    A sagitta is the largest distance of the straight edge of an element from the arc.
    """
    angles = divide_lining_into_elements(shoe, brake.size, elements).angles
    return angles, brake.size * (1 - np.cos(np.diff(angles) / 2))


def _shoe_with_clearance_like_straight_edge_gap(brake: Brake, shoe: Shoe, elements: int) -> Shoe:
    """The shoe with a clearance like the mean gap between straight element edges and the arc.

    The mean gap of an element is 2/3 of its sagitta.
    """
    angles, height = _element_angles_and_chord_sagittas(brake, shoe, elements)
    # In the frame of a mirrored shoe the angles grow in the direction of falling brake angles
    # theta. Therefore the angles are sorted.
    middle = np.sort(shoe.frame.surface_coordinates_of_phi((angles[:-1] + angles[1:]) / 2))
    height = height[:: shoe.frame.sense]
    gap = (
        shoe.sign_internal_plus_external_minus * 2 / 3 * height
        + shoe.lining.clearances_at_surface_coordinates(middle)
    )
    table = tuple(zip(middle.tolist(), gap.tolist(), strict=True))
    return shoe.model_copy(update={"lining": shoe.lining.model_copy(update={"clearance": table})})


def rms_pressure_waves_due_to_straight_edges(brake: Brake, shoe: Shoe, elements: int) -> float:
    """Root mean square over the lining of the pressure waves [Pa] by straight element edges.

    A straight edge is a chord of length h with the sagitta s = R (1 - cos(dphi/2)). It leaves the
    periodic gap s (1 - (2 x/h)^2) to the drum. The Fourier series of this gap has waves m = 1, 2,
    ... with the wave numbers k = 2 pi m/h and the amplitudes 4 s/(pi m)^2. The lining is taken as a
    layer of thickness t on a rigid base in plane stress, without friction. A wave of amplitude w in
    the gap causes a wave of amplitude p in the pressure, by the formula below. The ratio p/w tends
    to E k/2 for a thick layer (half-plane) and to E/((1 - nu^2) t) for a thin layer.

        p = w 4 G k/(kappa + 1) (2 kappa cosh 2kt + 1 + kappa^2 + (2kt)^2)/(2 kappa sinh 2kt - 4kt).
    """
    angles, height = _element_angles_and_chord_sagittas(brake, shoe, elements)
    lining = shoe.lining
    E, nu = lining.material.E_through, lining.material.nu_along_through
    kappa, G = (3 - nu) / (1 + nu), E / (2 * (1 + nu))
    h, m = brake.size * np.diff(angles)[:, None], np.arange(1, 9)
    k = 2 * math.pi * m / h
    # For 2 k t above 50 the layer acts as a half-plane. The limit 50 prevents overflow of cosh.
    a = np.minimum(2 * k * lining.thickness, 50.0)
    stiff = (2 * kappa * np.cosh(a) + 1 + kappa**2 + a**2) / (2 * kappa * np.sinh(a) - 2 * a)
    p = 4 * height[:, None] / (math.pi * m) ** 2 * 4 * G * k / (kappa + 1) * stiff
    return math.sqrt(
        float((np.diff(angles)[:, None] * p**2 / 2).sum()) / float(angles[-1] - angles[0])
    )


def _root_mean_square_of_pressure(theta: Floats, p: Floats) -> float:
    """Root mean square of the pressures p at the angles theta, by the trapezoidal rule."""
    return math.sqrt(float(np.trapezoid(p**2, theta)) / float(theta[-1] - theta[0]))
