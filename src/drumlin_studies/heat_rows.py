"""Table rows on the effect of heat: in each part of a brake alone, and in all parts together."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from drumlin.brake.brake import Brake
from drumlin.brake.heat import brake_with_heat_only_in_given_parts
from drumlin.response.norms import relative_error_of_number
from drumlin.response.response import Response
from drumlin.verification.triangles.levels import solve_brake_on_sequence_of_triangle_meshes

HEATED_PARTS_BY_STATE_NAME: Mapping[str, tuple[str, ...]] = {
    "cold": (),
    "drum": ("drum",),
    "linings": ("lining",),
    "bodies": ("body",),
    "all parts": ("drum", "lining", "body"),
}
"""The parts that are heated in each state of a brake, by the name of the state."""


def responses_with_heat_only_in_some_parts(
    brake: Brake, solve: Callable[[Brake], Response]
) -> dict[str, Response]:
    """The responses of a hot brake in each state, in which only some parts are hot, by state name.

    Parameters
    ----------
    brake : Brake
        The brake with all of its heat.
    solve : function
        Returns the response of a brake.
    """
    return {
        name: solve(brake_with_heat_only_in_given_parts(brake, parts))
        for name, parts in HEATED_PARTS_BY_STATE_NAME.items()
    }


def rows_of_changes_due_to_heat(responses: Mapping[str, Response]) -> list[dict[str, Any]]:
    """A row for each state: torque, peak pressure, their changes by the heat, and contact arcs."""
    cold = responses["cold"]
    rows = []
    for name, response in responses.items():
        peak = max(shoe.peak_pressure for shoe in response.shoes)
        cold_peak = max(shoe.peak_pressure for shoe in cold.shoes)
        row = {
            "heat": name,
            "torque": response.torque,
            "torque_change": relative_error_of_number(response.torque, cold.torque),
            "stated": (response.error or {}).get("torque"),
            "peak": peak,
            "peak_change": relative_error_of_number(peak, cold_peak),
        }
        for shoe in response.shoes:
            row[f"contact {shoe.name}"] = _sum_of_contact_arc_lengths(shoe.contact_arcs)
        rows.append(row)
    return rows


def _sum_of_contact_arc_lengths(arcs: Iterable[tuple[float, float]]) -> float:
    """The sum of the lengths [rad] of contact arcs, which are pairs of a first and a last angle."""
    return float(sum(end - start for start, end in arcs))


def torque_and_reaction_distances_from_triangles(
    brake: Brake, response: Response
) -> dict[str, float]:
    """Relative distances "torque" and "reaction" of a response from the solution by triangles.

    "reaction" is the distance of the hinge reaction for the shoe with the largest distance. The
    solution by triangles shares neither mesh nor assembly with the finite elements of the response.
    """
    shoes = solve_brake_on_sequence_of_triangle_meshes(brake)[-1]
    torque = sum(shoe.torque for shoe in shoes)
    reactions = []
    for mine, theirs in zip(response.shoes, shoes, strict=True):
        distance = np.linalg.norm(np.asarray(mine.hinge_reaction) - theirs.hinge_reaction)
        reactions.append(float(distance / np.linalg.norm(theirs.hinge_reaction)))
    return {"torque": abs(response.torque / torque - 1), "reaction": max(reactions)}
