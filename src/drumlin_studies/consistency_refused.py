"""Checks that the default solve refuses only brakes that three meshes refuse as well.

The default solve divides a brake by levels that follow the contact. A mesh is uniform and does not
depend on the contact, so that its answer is independent. Where the default solve has no answer, the
meshes must have none, or must disagree. Half of the seeds draw a brake whose clearance is far
larger than its compression, the other half a brake of any kind of both generators.
"""

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.model import TOO_FAR_REASON
from drumlin.fem.solve import solve
from drumlin.response.response import Response
from drumlin_studies import random_brake, random_kinds
from drumlin_studies.consistency import Check
from drumlin_studies.random_kinds import draw_brake_of_kind
from drumlin_studies.standing_off import draw_brake_with_clearances

MESH_SIZES = 20, 40, 80
"""Elements along a lining of the three meshes."""
SAME_FORCE = 0.05
"""Relative spread of the contact force up to which three meshes count as one answer.

Above it the meshes are too coarse for the contact and prove nothing.
"""
HELD_AGAINST = 10
"""One brake in so many is solved on the meshes although the default solve answers it.

A refused brake is always solved on the meshes. They cost about one second a brake.
"""


def refusal_rows(seed: int) -> list[Check]:
    """The row of the brake of a seed: the default solve against three meshes.

    There is no row for a brake with an answer whose meshes are not asked for or disagree.
    """
    brake = draw_brake(seed)
    found = _response_or_refusal(brake, None)
    refused = isinstance(found, str)
    if not refused and seed // 2 % HELD_AGAINST:
        return []
    # Meshes with one common answer prove that the brake has an answer.
    on_meshes = [_response_or_refusal(brake, elements) for elements in MESH_SIZES]
    forces = [total_contact_force(mesh) for mesh in on_meshes if not isinstance(mesh, str)]
    one_answer = len(forces) == len(MESH_SIZES) and relative_spread(forces) <= SAME_FORCE
    if isinstance(found, str):
        if one_answer:
            # Hp elements lose more digits than a mesh. Drumlin gives this as the reason.
            said = found if TOO_FAR_REASON in found else ""
            return [_check_row(brake, f"an answer, refused: {found}", 1.0, 0.0, said=said)]
        return [_check_row(brake, "an answer", 0.0, 0.0, said=found, refused=True)]
    if not one_answer:
        return []
    difference = max(abs(each / total_contact_force(found) - 1) for each in forces)
    # The error of the coarsest mesh is about the spread. Twice the spread allows for slow
    # convergence.
    return [_check_row(brake, "contact force", difference, max(2 * relative_spread(forces), 1e-3))]


def draw_brake(seed: int) -> Brake:
    """The brake of a seed: even seeds stand off the drum, odd ones are of all kinds."""
    half, odd = divmod(seed, 2)
    if not odd:
        return draw_brake_with_clearances(half)
    kinds = [*random_brake.SHAPE_KINDS, *random_kinds.HOLDING_KINDS]
    return draw_brake_of_kind(half, kinds[half % len(kinds)])


def total_contact_force(response: Response) -> float:
    """The sum of the contact forces of all shoes [N]."""
    return sum(shoe.normal_force for shoe in response.shoes)


def relative_spread(values: list[float]) -> float:
    """The largest difference of some values, relative to the last value."""
    return (max(values) - min(values)) / values[-1]


def _response_or_refusal(brake: Brake, elements: int | None) -> Response | str:
    """The response of the default solve (None) or on a mesh, or the line of the refusal."""
    try:
        return solve(brake, elements=elements)
    except NoAnswer as refusal:
        return str(refusal)


def _check_row(
    brake: Brake,
    quantity: str,
    difference: float,
    allowed: float,
    *,
    said: str = "",
    refused: bool = False,
) -> Check:
    """A row of this check; arguments as the attributes of `Check`."""
    return Check(
        "default solve = three meshes", brake.title, quantity, difference, allowed, said, refused
    )
