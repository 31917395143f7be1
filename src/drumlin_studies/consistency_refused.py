"""Checks that the default solve refuses only brakes that three uniform meshes refuse as well.

The default solve uses hp meshes that are graded to the ends of the contact. A uniform mesh does not
depend on the contact, so that its result is independent. If the default solve finds no equilibrium,
the uniform meshes must find none, either, or disagree with each other. Half of the seeds draw a
brake whose clearance is far larger than the lining's compression, the other half any random brake.
"""

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.model import ROUND_OFF_TOO_LARGE_REASON
from drumlin.fem.solve import solve
from drumlin.response.response import Response
from drumlin_studies import random_brake, random_kinds
from drumlin_studies.consistency import TwoPathComparison
from drumlin_studies.random_kinds import draw_random_brake_of_kind
from drumlin_studies.standing_off import draw_random_brake_with_clearances

ELEMENTS_PER_LINING_OF_THREE_UNIFORM_MESHES = 20, 40, 80
"""Number of elements along a lining of the three uniform meshes."""
LARGEST_SPREAD_OF_AGREEING_NORMAL_FORCES = 0.05
"""Relative spread of the sums of normal forces up to which the three meshes agree.

With a larger spread the meshes are too coarse for the contact, and do not tell whether the brake
has an equilibrium.
"""
SOLVED_BRAKES_PER_ONE_CHECKED_ON_UNIFORM_MESHES = 10
"""Of this many brakes that the default solve can solve, one is also solved on the uniform meshes.

The uniform meshes take about one second for a brake. A brake that the default solve refuses is
always solved on them.
"""


def rows_comparing_default_solve_with_meshes(seed: int) -> list[TwoPathComparison]:
    """Compare the default solve with three uniform meshes for the random brake of a seed.

    Returns one row. It returns none if the default solve succeeds and the meshes are left out or
    disagree with each other.
    """
    brake = draw_random_brake_for_refusal_check(seed)
    found = _solve_brake_or_return_refusal_message(brake, None)
    refused = isinstance(found, str)
    if not refused and seed // 2 % SOLVED_BRAKES_PER_ONE_CHECKED_ON_UNIFORM_MESHES:
        return []
    # If the three meshes give nearly the same contact force, the brake has an equilibrium.
    on_meshes = [
        _solve_brake_or_return_refusal_message(brake, elements)
        for elements in ELEMENTS_PER_LINING_OF_THREE_UNIFORM_MESHES
    ]
    forces = [
        sum_of_normal_forces_of_shoes(mesh) for mesh in on_meshes if not isinstance(mesh, str)
    ]
    one_answer = (
        len(forces) == len(ELEMENTS_PER_LINING_OF_THREE_UNIFORM_MESHES)
        and range_of_values_over_last_value(forces) <= LARGEST_SPREAD_OF_AGREEING_NORMAL_FORCES
    )
    if isinstance(found, str):
        if one_answer:
            # Elements of high degree have more round-off than a uniform mesh of low degree. This is
            # a valid reason for a refusal.
            said = found if ROUND_OFF_TOO_LARGE_REASON in found else ""
            return [
                _row_comparing_default_solve_with_meshes(
                    brake, f"an answer, refused: {found}", 1.0, 0.0, said=said
                )
            ]
        return [
            _row_comparing_default_solve_with_meshes(
                brake, "an answer", 0.0, 0.0, said=found, refused=True
            )
        ]
    if not one_answer:
        return []
    difference = max(abs(each / sum_of_normal_forces_of_shoes(found) - 1) for each in forces)
    # No mesh should differ from the default solve by more than the error of the coarsest mesh,
    # which is about the spread of the forces. The factor 2 allows for slow convergence.
    return [
        _row_comparing_default_solve_with_meshes(
            brake,
            "contact force",
            difference,
            max(2 * range_of_values_over_last_value(forces), 1e-3),
        )
    ]


def draw_random_brake_for_refusal_check(seed: int) -> Brake:
    """The random brake of a seed: even seeds have large clearances, odd seeds are of all kinds."""
    half, odd = divmod(seed, 2)
    if not odd:
        return draw_random_brake_with_clearances(half)
    kinds = [
        *random_brake.FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND,
        *random_kinds.FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND,
    ]
    return draw_random_brake_of_kind(half, kinds[half % len(kinds)])


def sum_of_normal_forces_of_shoes(response: Response) -> float:
    """The sum over all shoes of the size of the resultant of the lining's pressure [N]."""
    return sum(shoe.normal_force for shoe in response.shoes)


def range_of_values_over_last_value(values: list[float]) -> float:
    """The largest value minus the smallest one, divided by the last value."""
    return (max(values) - min(values)) / values[-1]


def _solve_brake_or_return_refusal_message(brake: Brake, elements: int | None) -> Response | str:
    """Solve a brake; returns the response, or the error message as text if it is refused.

    `elements` is the number of elements along a lining, or None for the default solve.
    """
    try:
        return solve(brake, elements=elements)
    except NoAnswer as refusal:
        return str(refusal)


def _row_comparing_default_solve_with_meshes(
    brake: Brake,
    quantity: str,
    difference: float,
    allowed: float,
    *,
    said: str = "",
    refused: bool = False,
) -> TwoPathComparison:
    """A table row of this check: one brake, one quantity, and the difference of its two values."""
    return TwoPathComparison(
        "default solve = three meshes", brake.title, quantity, difference, allowed, said, refused
    )
