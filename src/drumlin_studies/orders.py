"""Orders of convergence, error estimates against true errors, and the limit of a rigid shoe."""

import math
import time
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.comparison import Convergence
from drumlin.fem.error_control.levels import LEVELS
from drumlin.fem.error_control.singular_points import singular_points_of
from drumlin.fem.hp.division import Level
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.solve import solve
from drumlin.laws import sine
from drumlin.response.norms import pressure_distance, relative
from drumlin.response.response import Response, ShoeResponse
from drumlin.verification.reference import Refinement, solve_reference_responses
from drumlin_studies.tables import values_of_key

RIGID_CHANGES = {"shoe.body.material.E": 2.1e15, "shoe.lining.thickness": 3e-3}
"""Changes that make a shoe nearly rigid: E of steel times 1e4, and a lining of R/50."""
Row = dict[str, Any]


def largest_pressure_distance(response: Response, reference: Response) -> float:
    """Relative L2 distance of p outside the edge zones, the largest of all shoes."""
    return max(map(pressure_distance, response.shoes, reference.shoes))


def order_rows(
    brake: Brake, case: str, kind: str, sizes: Sequence[int], reference: Response
) -> list[Row]:
    """Errors on meshes that double, with exact contact.

    `order` is the observed order between a mesh and the one before.

    Parameters
    ----------
    brake : Brake
        The brake.
    case : str
        Its name in the rows.
    kind : str
        Kind of the elements.
    sizes : sequence of int
        Elements along a lining of each mesh.
    reference : Response
        The response against which errors are taken.
    """
    rows: list[Row] = []
    for n in sizes:
        response = solve(brake, elements=n, kind=kind, penalty=math.inf)
        row = {
            "case": case,
            "kind": kind,
            "elements": n,
            "pressure": largest_pressure_distance(response, reference),
            "torque": abs(relative(response.torque, reference.torque)),
            "steps": response.iterations,
        }
        if rows:
            error_ratio = math.log(rows[-1]["pressure"] / row["pressure"])
            row["order"] = error_ratio / math.log(n / rows[-1]["elements"])
        rows.append(row)
    return rows


COARSE_LEVEL = Level(2, 0.9, 0.3, 0.4, 0.15, 0.15, math.radians(30), 1.0, 1.0, 0.1)
"""The first and coarsest level of `level_rows`. Its errors are some percent."""

LEVEL_REFERENCE = Refinement(
    3,
    (
        Level(8, 0.002, 0.0015, 3e-4, 0.5, 0.5, math.radians(12), 0.003, 0.0015, 0.4),
        Level(9, 0.001, 7e-4, 1e-4, 0.5, 0.5, math.radians(12), 0.0015, 7e-4, 0.4),
    ),
    (),
)
"""The reference of `level_rows`. With it the errors of four levels are known to within a half."""


def level_rows(brake: Brake, refinement: Refinement = LEVEL_REFERENCE) -> list[Row]:
    """Errors of hp elements, a row for each level, with exact contact.

    The ends of the contact are those of the reference. `root` is the cube root of the unknowns of a
    shoe. Over it the logarithm of the error falls along a straight line where all singular points
    are graded (Babuska & Guo 1986). The rows end at twice the distance between both divisions of
    the reference. Above this floor an error is known to within a half.
    """
    reference = solve_reference_responses(brake, refinement)
    true, places = reference.value, singular_points_of(brake, reference.value)
    floor = 2 * largest_pressure_distance(reference.before, true)
    rows = []
    for level in (COARSE_LEVEL, *LEVELS):
        made = prepare(brake, level, places)
        # Exact contact, from the contact set of the reference.
        response = solve_prepared_model(made, brake, penalty=math.inf, start=true)
        unknowns = max(body.unknowns for body in made.bodies)
        error = largest_pressure_distance(response, true)
        torque = abs(relative(response.torque, true.torque))
        # Below the floor an error is not known to within a half.
        if error < floor:
            break
        rows.append(
            {
                "degree": level.degree,
                "unknowns": unknowns,
                "root": unknowns ** (1 / 3),
                "pressure": error,
                "torque": torque,
            }
        )
    return rows


class FittedLine(NamedTuple):
    """The fit log10(error) = a - fall (unknowns)^(1/3).

    Attributes
    ----------
    fall : float
        Decades of the error per cube root of the unknowns.
    correlation : float
        Correlation of both sides.
    decades : float
        Decades of the error that the rows span.
    """

    fall: float
    correlation: float
    decades: float


def fit_error_line(rows: Sequence[Row]) -> FittedLine:
    """The straight line through `level_rows`."""
    x = np.array(values_of_key(rows, "root"))
    y = np.array(list(map(math.log10, values_of_key(rows, "pressure"))))
    return FittedLine(
        -float(np.polyfit(x, y, 1)[0]), -float(np.corrcoef(x, y)[0, 1]), float(np.ptp(y))
    )


def estimate_row(
    brake: Brake, case: str, tolerance: float, reference: Response, floor: float
) -> Row:
    """Estimated and true errors of a solve to a tolerance, with its time.

    Parameters
    ----------
    brake : Brake
        The brake.
    case : str
        Its name in the row.
    tolerance : float
        Relative tolerance of the solve.
    reference : Response
        The response that serves as truth.
    floor : float
        Uncertainty of the reference.
    """
    start = time.perf_counter()
    row: Row = {"case": case, "tolerance": tolerance}
    try:
        response = solve(brake, tolerance=tolerance, penalty=math.inf)
    except NoAnswer as error:
        return {**row, "seconds": time.perf_counter() - start, "status": f"failed: {error}"}
    seconds = time.perf_counter() - start
    # A solve to a tolerance always estimates its errors.
    assert response.error is not None
    true = largest_pressure_distance(response, reference)
    below = "converged; truth below what the reference knows"
    return {
        **row,
        "estimate": response.error["pressure"],
        "true": true,
        "ratio": response.error["pressure"] / true,
        "torque_estimate": response.error["torque"],
        "torque_true": abs(relative(response.torque, reference.torque)),
        "seconds": seconds,
        "status": "converged" if true > floor else below,
    }


def convergence_rows(convergence: Convergence) -> list[Row]:
    """A row for each of several meshes that double.

    It has the torque [N m], its relative distance from the limit, and under the name of each shoe
    the relative change of p to the next finer mesh (None for the finest).
    """
    limit = convergence.torque.value
    rows: list[Row] = []
    for n, response in zip(convergence.elements, convergence.responses, strict=True):
        row: Row = {
            "elements": n,
            "unknowns_torque": response.torque,
            "torque_error": relative(response.torque, limit),
        }
        rows.append(row)
    for i, shoe in enumerate(convergence.responses[0].shoes):
        # The finest mesh has no next finer one.
        steps: list[float | None] = [*convergence.pressure_steps(i), None]
        for row, change in zip(rows, steps, strict=True):
            row[shoe.name] = change
    for row, response in zip(rows, convergence.responses, strict=True):
        row["steps"] = response.iterations
    return rows


def rigid_limit_rows(brake: Brake, elements: int) -> list[Row]:
    """The sine law against finite elements with a nearly rigid shoe and a thin lining.

    `spread` is the range of p/sin(phi) over its mean; by the law it is zero. The last row has the
    torques of the whole brake.
    """
    rigid = vary(brake, RIGID_CHANGES)
    law, fem = sine(rigid), solve(rigid, elements=elements)
    rows: list[Row] = []
    for spec, a, b in zip(rigid.shoes, law.shoes, fem.shoes, strict=True):
        # Five thicknesses from an end, p of an elastic lining is as inside.
        edge = 5 * spec.lining.thickness / rigid.size
        ratio = sine_amplitude(spec.frame.phi(b.theta), b, edge)
        rows.append(
            {
                "rotation": brake.direction,
                "shoe": spec.name,
                "law": a.torque,
                "fem": b.torque,
                "difference": relative(b.torque, a.torque),
                "spread": float(np.ptp(ratio) / np.mean(ratio)),
            }
        )
    rows.append(
        {
            "rotation": brake.direction,
            "shoe": "all",
            "law": law.torque,
            "fem": fem.torque,
            "difference": relative(fem.torque, law.torque),
        }
    )
    return rows


def sine_amplitude(phi: Floats, shoe: ShoeResponse, edge: float) -> Floats:
    """p/sin(phi) [Pa] at the nodes that are farther than `edge` [rad] from both ends."""
    inside = (phi > phi.min() + edge) & (phi < phi.max() - edge)
    return np.asarray(shoe.pressure[inside] / np.sin(phi[inside]))


def largest_residual(responses: Sequence[Response]) -> float:
    """The largest relative residual of forces or moments of the responses that have a balance."""
    residuals: list[float] = []
    for response in responses:
        if not math.isnan(response.balance.force):
            residuals += response.balance.force, response.balance.moment
    return max(residuals)
