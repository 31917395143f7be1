"""Table rows on the convergence of finite elements.

The rows show orders of convergence, estimated errors beside true errors, and how the pressure of a
nearly rigid shoe tends to the sine law.
"""

import math
import time
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.comparison import ResultsOnRefinedMeshes
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.error_control.singular_points import singular_points_of_each_shoe_shape
from drumlin.fem.hp.division import RefinementLevel
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin.laws import solve_brake_by_sine_law
from drumlin.response.norms import relative_distance_of_pressures, relative_error_of_number
from drumlin.response.response import Response, ShoeResponse
from drumlin.verification.reference import MeshesOfReferenceValues, solve_brake_for_reference_values
from drumlin_studies.tables import values_of_key_in_rows

BRAKE_CHANGES_FOR_NEARLY_RIGID_SHOE = {
    "shoe.body.material.E": 2.1e15,
    "shoe.lining.thickness": 3e-3,
}
"""Changes of a brake file that make a shoe nearly rigid.

Young's modulus of its body becomes 1e4 times that of steel. The thickness of its lining becomes 3
mm, which is R/50 in the brake of the study.
"""
ConvergenceRow = dict[str, Any]
"""A row of a table: its values by key."""


def largest_pressure_distance_of_shoes(response: Response, reference: Response) -> float:
    """Largest relative L2 distance, over all shoes, of a response's pressure from the reference.

    The zones at the ends of the linings, in which the pressure is singular, are left out.
    """
    return max(map(relative_distance_of_pressures, response.shoes, reference.shoes))


def convergence_order_rows_of_meshes(
    brake: Brake, case: str, kind: str, sizes: Sequence[int], reference: Response
) -> list[ConvergenceRow]:
    """A row for each of several meshes: the errors of pressure and torque, with exact contact.

    From the second row on, `order` is the order of convergence of the pressure, observed between
    this mesh and the next coarser one.

    Parameters
    ----------
    brake : Brake
        The brake.
    case : str
        Name of the brake in the rows.
    kind : str
        Kind of the elements, for example "quad2".
    sizes : sequence of int
        Number of elements along each lining on each mesh, in growing order.
    reference : Response
        The response against which errors are taken.
    """
    rows: list[ConvergenceRow] = []
    for n in sizes:
        response = solve(brake, elements=n, kind=kind, penalty=math.inf)
        row = {
            "case": case,
            "kind": kind,
            "elements": n,
            "pressure": largest_pressure_distance_of_shoes(response, reference),
            "torque": abs(relative_error_of_number(response.torque, reference.torque)),
            "steps": response.iterations,
        }
        if rows:
            error_ratio = math.log(rows[-1]["pressure"] / row["pressure"])
            row["order"] = error_ratio / math.log(n / rows[-1]["elements"])
        rows.append(row)
    return rows


# The arguments are the attributes of `RefinementLevel` in their order, from `degree` to
# `layer_size_ratio`.
COARSEST_HP_MESH_OF_ERROR_ROWS = RefinementLevel(
    2, 0.9, 0.3, 0.4, 0.15, 0.15, math.radians(30), 1.0, 1.0, 0.1
)
"""The first and coarsest hp mesh of `error_rows_of_hp_levels`. The errors on it are some percent.
"""

REFERENCE_MESHES_OF_HP_LEVELS = MeshesOfReferenceValues(
    3,
    (
        RefinementLevel(8, 0.002, 0.0015, 3e-4, 0.5, 0.5, math.radians(12), 0.003, 0.0015, 0.4),
        RefinementLevel(9, 0.001, 7e-4, 1e-4, 0.5, 0.5, math.radians(12), 0.0015, 7e-4, 0.4),
    ),
    (),
)
"""Two fine hp meshes on which the reference of `error_rows_of_hp_levels` is solved.

With these meshes the errors of four coarser levels are known to within 50 %.
"""


def error_rows_of_hp_levels(
    brake: Brake, refinement: MeshesOfReferenceValues = REFERENCE_MESHES_OF_HP_LEVELS
) -> list[ConvergenceRow]:
    """A row for each level of hp elements: the errors of pressure and torque, with exact contact.

    The elements are refined towards the ends of the contact that the reference solution has. `root`
    is the cube root of the number of unknowns of a shoe. The logarithm of the error falls linearly
    with `root` if the elements are graded to all singular points (Babuska & Guo 1986). The rows end
    where the error of the pressure falls below twice the distance between the responses on the two
    hp meshes of the reference. A larger error is known to within 50 %.
    """
    reference = solve_brake_for_reference_values(brake, refinement)
    true, places = reference.value, singular_points_of_each_shoe_shape(brake, reference.value)
    floor = 2 * largest_pressure_distance_of_shoes(reference.before, true)
    rows = []
    for level in (COARSEST_HP_MESH_OF_ERROR_ROWS, *REFINEMENT_LEVELS_FROM_COARSE_TO_FINE):
        made = make_prepared_model(brake, level, places)
        # An infinite penalty gives exact contact. The solve starts from the contact set of the
        # reference.
        response = solve_prepared_model(made, brake, penalty=math.inf, start=true)
        unknowns = max(body.unknowns for body in made.bodies)
        error = largest_pressure_distance_of_shoes(response, true)
        torque = abs(relative_error_of_number(response.torque, true.torque))
        # For smaller errors the error of the reference, which is unknown, would be too large a part
        # of the difference.
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


class FittedErrorDecayOfHpMeshes(NamedTuple):
    """The fit log10(error) = a - fall n^(1/3) to the errors of hp meshes with n unknowns.

    Attributes
    ----------
    fall : float
        Decrease of log10(error) as n^(1/3) grows by 1.
    correlation : float
        Correlation of -log10(error) with n^(1/3); near 1 if the errors lie on a straight line.
    decades : float
        Powers of ten between the largest and the smallest error.
    """

    fall: float
    correlation: float
    decades: float


def fit_line_to_log_errors(rows: Sequence[ConvergenceRow]) -> FittedErrorDecayOfHpMeshes:
    """The straight line through the errors of p in the rows of `error_rows_of_hp_levels`."""
    x = np.array(values_of_key_in_rows(rows, "root"))
    y = np.array(list(map(math.log10, values_of_key_in_rows(rows, "pressure"))))
    return FittedErrorDecayOfHpMeshes(
        -float(np.polyfit(x, y, 1)[0]), -float(np.corrcoef(x, y)[0, 1]), float(np.ptp(y))
    )


def estimated_and_true_error_row(
    brake: Brake, case: str, tolerance: float, reference: Response, floor: float
) -> ConvergenceRow:
    """A row with the estimated and the true errors of a solve to a tolerance, and the wall time.

    Parameters
    ----------
    brake : Brake
        The brake.
    case : str
        Name of the brake in the row.
    tolerance : float
        Relative tolerance of the solve.
    reference : Response
        The far finer response. True errors are the differences from it.
    floor : float
        Relative uncertainty of the reference. If the true error of the pressure is smaller than
        `floor`, the `status` of the row says so.
    """
    start = time.perf_counter()
    row: ConvergenceRow = {"case": case, "tolerance": tolerance}
    try:
        response = solve(brake, tolerance=tolerance, penalty=math.inf)
    except NoAnswer as error:
        return {**row, "seconds": time.perf_counter() - start, "status": f"failed: {error}"}
    seconds = time.perf_counter() - start
    # A solve to a tolerance always estimates its errors.
    assert response.error is not None
    true = largest_pressure_distance_of_shoes(response, reference)
    below = "converged; truth below what the reference knows"
    return {
        **row,
        "estimate": response.error["pressure"],
        "true": true,
        "ratio": response.error["pressure"] / true,
        "torque_estimate": response.error["torque"],
        "torque_true": abs(relative_error_of_number(response.torque, reference.torque)),
        "seconds": seconds,
        "status": "converged" if true > floor else below,
    }


def torque_convergence_rows_of_meshes(convergence: ResultsOnRefinedMeshes) -> list[ConvergenceRow]:
    """A row for each of several meshes, each twice as fine as the one before.

    A row has the torque [N m], the relative distance of the torque from its extrapolated limit, and
    under the name of each shoe the relative change of the pressure to the next finer mesh. On the
    finest mesh this change is None.
    """
    limit = convergence.torque.value
    rows: list[ConvergenceRow] = []
    for n, response in zip(convergence.elements, convergence.responses, strict=True):
        row: ConvergenceRow = {
            "elements": n,
            "unknowns_torque": response.torque,
            "torque_error": relative_error_of_number(response.torque, limit),
        }
        rows.append(row)
    for i, shoe in enumerate(convergence.responses[0].shoes):
        # Changes of the pressure from each mesh to the next finer one. The finest mesh has no such
        # change.
        steps: list[float | None] = [
            *convergence.relative_pressure_distances_between_meshes(i),
            None,
        ]
        for row, change in zip(rows, steps, strict=True):
            row[shoe.name] = change
    for row, response in zip(rows, convergence.responses, strict=True):
        row["steps"] = response.iterations
    return rows


def rows_comparing_sine_law_with_rigid_shoe_solves(
    brake: Brake, elements: int
) -> list[ConvergenceRow]:
    """Rows that compare the sine law with finite elements on nearly rigid shoes with thin linings.

    Each row has the torques [N m] of a shoe, and the last row those of the whole brake. `spread` is
    the largest minus the smallest p/sin(phi), divided by the mean, for the pressure p by finite
    elements at the angle phi from the hinge. By the sine law `spread` is zero.

    brake : the brake, before BRAKE_CHANGES_FOR_NEARLY_RIGID_SHOE; elements : number of elements
        along each lining.
    """
    rigid = vary(brake, BRAKE_CHANGES_FOR_NEARLY_RIGID_SHOE)
    law, fem = solve_brake_by_sine_law(rigid), solve(rigid, elements=elements)
    rows: list[ConvergenceRow] = []
    for spec, a, b in zip(rigid.shoes, law.shoes, fem.shoes, strict=True):
        # The free ends of an elastic lining disturb its pressure over a length of some five
        # thicknesses.
        edge = 5 * spec.lining.thickness / rigid.size
        ratio = pressure_over_sine_of_hinge_angle(
            spec.frame.phi_of_surface_coordinates(b.theta), b, edge
        )
        rows.append(
            {
                "rotation": brake.direction,
                "shoe": spec.name,
                "law": a.torque,
                "fem": b.torque,
                "difference": relative_error_of_number(b.torque, a.torque),
                "spread": float(np.ptp(ratio) / np.mean(ratio)),
            }
        )
    rows.append(
        {
            "rotation": brake.direction,
            "shoe": "all",
            "law": law.torque,
            "fem": fem.torque,
            "difference": relative_error_of_number(fem.torque, law.torque),
        }
    )
    return rows


def pressure_over_sine_of_hinge_angle(phi: Floats, shoe: ShoeResponse, edge: float) -> Floats:
    """The ratio p/sin(phi) [Pa] at the nodes in the inner part of a lining.

    By the sine law the ratio is the same at all nodes.

    phi : angles of all nodes from the hinge [rad]; edge : length [rad] at each end of the lining
    whose nodes are left out.
    """
    inside = (phi > phi.min() + edge) & (phi < phi.max() - edge)
    return np.asarray(shoe.pressure[inside] / np.sin(phi[inside]))


def largest_equilibrium_residual_of_responses(responses: Sequence[Response]) -> float:
    """The largest relative residual in the balances of forces and moments of several responses.

    Responses without a balance, whose residual is nan, are left out.
    """
    residuals: list[float] = []
    for response in responses:
        if not math.isnan(response.balance.force):
            residuals += response.balance.force, response.balance.moment
    return max(residuals)
