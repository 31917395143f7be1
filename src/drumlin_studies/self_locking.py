"""Table rows on self-locking, which begins at the friction limit, where the torque is unbounded.

The rows show the friction limit, the torque up to the limit, and slopes of the torque. They also
show whether a brake has exactly one answer below the limit and no answer beyond the limit.
"""

import math
from typing import Any

import numpy as np

from drumlin.base.arrays import Bools
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.contact.self_locking import (
    FrictionDependentProblem,
    LargestFrictionWithEquilibrium,
    compare_solutions_from_starting_contact_sets,
    find_largest_friction_with_equilibrium,
    smallest_friction_that_makes_any_contact_set_singular,
)
from drumlin.fem.analysis.self_locking import (
    self_locking_friction_of_shoe_groups,
    shoe_torques_at_friction_coefficients,
)
from drumlin.fem.analysis.sensitivity import compare_torque_slopes_with_solve_differences
from drumlin.fem.equilibrium.group import ShoeGroup
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.laws import self_locking_friction_of_hinged_shoe, solve_brake_by_sine_law
from drumlin_studies.random_brake import draw_random_brake

LARGEST_SEARCHED_LOCKING_FRICTION = 3.0
"""Largest coefficient of friction up to which the self-locking of a brake is searched for."""
LARGEST_SEARCHED_FRICTION_OF_RANDOM_BRAKE = 100.0
"""Largest coefficient of friction up to which the self-locking of a random brake is searched for.
"""
LARGEST_FRICTION_CHECKED_FOR_UNIQUENESS = 1.0
"""Largest coefficient of friction at which the uniqueness of an answer is checked.

This value takes the place of the friction limit if a shoe locks itself at a larger friction or at
no friction.
"""
FRACTIONS_OF_LOCKING_FRICTION_WITH_ONE_ANSWER = (0.1, 0.3, 0.5, 0.7, 0.9, 0.99)
"""Fractions of the friction limit (where the brake locks itself) at which it must have exactly one
answer.
"""
MULTIPLES_OF_LOCKING_FRICTION_WITHOUT_ANSWER = (1 + 1e-6, 1.01, 1.1, 1.5, 2.0, 3.0)
"""Multiples of the friction limit (where the brake locks itself) at which it should have no answer.
"""
NUMBER_OF_RANDOM_STARTING_CONTACT_SETS = 5
"""Number of random contact sets from which the contact iteration is started."""
ELEMENTS_PER_LINING_OF_UNIQUENESS_CHECK = 16
"""Elements along a lining of the random brakes whose answers are checked for uniqueness."""
ELEMENTS_PER_LINING_IF_ALL_CONTACT_SETS_ARE_TRIED = 4
"""Elements along a lining of the brakes for which all possible contact sets are tried. The number
is small, because each node more doubles the number of contact sets.
"""
SEED_OF_RANDOM_STARTING_CONTACT_SETS = 7
"""Seed of the random contact sets; it is used together with the seed of the brake."""
ATTRIBUTES_THAT_COUNT_HOW_CONTACT_ITERATIONS_END = {
    "starts": "number_of_start_sets",
    "same": "sets_with_known_solution",
    "others": "sets_with_other_stable_solution",
    "unstable": "sets_with_unstable_solution",
    "lost": "sets_without_convergence",
}
"""Keys of a row, with the attributes that count how contact iterations from several sets end.

The attributes are those of the result of `compare_solutions_from_starting_contact_sets`. A row has
their sums over FRACTIONS_OF_LOCKING_FRICTION_WITH_ONE_ANSWER.
"""

SelfLockingRow = dict[str, Any]
"""A row of a table: its values by key."""


def row_of_self_locking_friction(brake: Brake, elements: int) -> SelfLockingRow:
    """A row with the friction at which a brake locks itself, by finite elements and by sine law.

    If the brake has several groups of shoes, the friction is that of the group that locks first.

    elements : number of elements along each lining.
    """
    scene = make_prepared_model(brake, elements=elements)
    found = min(
        self_locking_friction_of_shoe_groups(
            scene, brake, LARGEST_SEARCHED_LOCKING_FRICTION
        ).values(),
        key=lambda end: end.friction,
    )
    law = _lowest_locking_friction_by_law(brake)
    mu, t_over_R = found.friction, brake.shoes[0].lining.thickness / brake.size
    off = mu / law - 1
    return {
        "mu_lock": mu,
        "law": law,
        "difference": off,
        "bounded": found.pressure_stays_finite,
        "elements": elements,
        "t_over_R": t_over_R,
    }


def row_of_torque_curves_by_friction(brake: Brake, name: str, elements: int) -> SelfLockingRow:
    """A row with the curves of torque [N m] over friction, by finite elements and by the sine law.

    The curve by finite elements ends just before the friction at which the brake locks itself by
    finite elements. The curve by the sine law ends there as well, or earlier, just before the
    friction at which the brake locks itself by the sine law.

    Parameters
    ----------
    brake : Brake
        The brake.
    name : str
        Name of the brake in the row.
    elements : int
        Elements along a lining.
    """
    scene = make_prepared_model(brake, elements=elements)
    end = min(
        found.friction
        for found in self_locking_friction_of_shoe_groups(
            scene, brake, LARGEST_SEARCHED_LOCKING_FRICTION
        ).values()
    )
    law = _lowest_locking_friction_by_law(brake)
    # Friction coefficients of the curve, divided by the limit: even steps up to 0.9, then distances
    # from the limit that shrink by a constant factor.
    fractions = (*np.linspace(0.02, 0.9, 45), *(1 - np.logspace(-1, -6, 26)[1:]))
    mu = [end * fraction for fraction in fractions]
    of_law = [m for m in mu if m < law * 0.999]
    return {
        "name": name,
        "mu": mu,
        "law_mu": of_law,
        "mu_lock": end,
        "law": law,
        "torque": shoe_torques_at_friction_coefficients(scene, brake, mu).sum(axis=1).tolist(),
        "law_torque": [
            solve_brake_by_sine_law(vary(brake, {"friction": m})).torque for m in of_law
        ],
    }


def _lowest_locking_friction_by_law(brake: Brake) -> float:
    """The lowest friction at which a shoe of the brake locks itself by the sine law."""
    return min(self_locking_friction_of_hinged_shoe(brake, shoe) for shoe in brake.shoes)


def torque_times_distance_to_locking_friction_and_its_change(
    row: SelfLockingRow,
) -> tuple[float, float]:
    """The product T (mu_lock - mu) [N m] at the friction limit, and its change near the limit.

    If the torque T has a pole at the friction mu_lock, the product is constant near mu_lock. The
    first result is the product at the last point of the curve, 1e-6 mu_lock below the limit. The
    second result is the relative change of the product from the friction (1 - 1e-5) mu_lock to this
    point.

    row : a row of `row_of_torque_curves_by_friction`.
    """
    limit_friction, products, near = row["mu_lock"], [], []
    for mu, torque in zip(row["mu"], row["torque"], strict=True):
        products.append(torque * (limit_friction - mu))
        if 1 - mu / limit_friction < 1.01e-5:
            near.append(products[-1])
    return products[-1], abs(near[-1] / near[0] - 1)


def row_on_uniqueness_of_contact_solutions(seed: int, way: str) -> SelfLockingRow:
    """A row on the answers of a random brake: one below its friction limit, none beyond it.

    The contact iteration starts from all nodes in contact, from no node in contact, and from random
    contact sets. `disagreeing` lists the fractions of the limit at which some iteration does not
    end in the answer that is followed from zero friction. `beyond` is the number of stable answers
    of the contact iteration beyond the limit. `answered` is the number of solves by drumlin beyond
    the limit that have an answer. Both are None if the limit is above 10.

    Parameters
    ----------
    seed : int
        Seed of the brake.
    way : str
        Kind of the brake, one of `random_brake.KINDS_THAT_LOCK_OR_NEVER_LOCK_WITH_FRICTION`.
    """
    brake = draw_random_brake(seed, way)
    scene = make_prepared_model(brake, elements=ELEMENTS_PER_LINING_OF_UNIQUENESS_CHECK)
    problems = ShoeGroup(scene, brake, (0,)).contact_problem_as_function_of_friction
    end = find_largest_friction_with_equilibrium(
        problems, LARGEST_SEARCHED_FRICTION_OF_RANDOM_BRAKE
    )
    starts = _starting_contact_sets(len(problems.frictionless.q), seed)
    top = min(end.friction, LARGEST_FRICTION_CHECKED_FOR_UNIQUENESS)
    counts, disagreeing = _agreement_counts_and_disagreeing_friction_fractions(
        problems, top, starts
    )
    # Beyond the friction limit the contact iteration should find no stable answer, and a solve of
    # drumlin should raise NoAnswer.
    beyond = answered = None
    if end.friction <= 10:
        mu_beyond = [end.friction * x for x in MULTIPLES_OF_LOCKING_FRICTION_WITHOUT_ANSWER]
        beyond = _count_stable_answers_beyond_friction_limit(problems, end, mu_beyond, starts)
        answered = sum(
            _is_brake_solvable_with_exact_contact(scene, vary(brake, {"friction": mu}))
            for mu in mu_beyond
        )
    any_set = _smallest_singular_friction_on_coarse_mesh(brake)
    shoe = brake.shoes[0]
    return {
        "brake": seed,
        "way": way,
        "mu_lock": None if math.isinf(end.friction) else end.friction,
        "bounded": end.pressure_stays_finite,
        "law": self_locking_friction_of_hinged_shoe(brake, shoe),
        "top": top,
        "disagreeing": disagreeing,
        "beyond": beyond,
        "answered": answered,
        "any_set": None if math.isinf(any_set) else any_set,
        "clearance": _kind_of_first_lining_clearance(brake),
        "shoe": "elastic" if shoe.body else "rigid",
        "t_over_R": shoe.lining.thickness / brake.size,
        **counts,
    }


def _smallest_singular_friction_on_coarse_mesh(brake: Brake) -> float:
    """The lowest friction at which the equations of some contact set become singular.

    All contact sets are tried. This is possible because a coarse mesh has few contact sets.
    """
    coarse = make_prepared_model(brake, elements=ELEMENTS_PER_LINING_IF_ALL_CONTACT_SETS_ARE_TRIED)
    return smallest_friction_that_makes_any_contact_set_singular(
        ShoeGroup(coarse, brake, (0,)).contact_problem_as_function_of_friction
    )


def _starting_contact_sets(n: int, seed: int) -> list[Bools]:
    """Contact sets (n,) to start the iteration from: all nodes, no node, random sets by a seed."""
    rng = np.random.default_rng([SEED_OF_RANDOM_STARTING_CONTACT_SETS, seed])
    random_sets = [rng.random(n) < 0.5 for _ in range(NUMBER_OF_RANDOM_STARTING_CONTACT_SETS)]
    return [np.ones(n, bool), np.zeros(n, bool), *random_sets]


def _count_stable_answers_beyond_friction_limit(
    problems: FrictionDependentProblem,
    end: LargestFrictionWithEquilibrium,
    frictions: list[float],
    starts: list[Bools],
) -> int:
    """The number of stable answers that contact iterations find beyond the friction limit.

    Parameters
    ----------
    problems : FrictionDependentProblem
        The contact problem as a function of friction.
    end : LargestFrictionWithEquilibrium
        The friction limit, with the contact set just below it.
    frictions : list of float
        Friction coefficients beyond the limit.
    starts : list of array of bool (n,)
        Contact sets from which the contact iteration starts.
    """
    count = 0
    for mu in frictions:
        problem = problems.contact_problem_at_friction_coefficient(mu)
        count += compare_solutions_from_starting_contact_sets(
            problem, end.last_contact, starts, 0.0
        ).sets_with_other_stable_solution
    return count


def _agreement_counts_and_disagreeing_friction_fractions(
    problems: FrictionDependentProblem, top: float, starts: list[Bools]
) -> tuple[SelfLockingRow, list[float]]:
    """Counts of how contact iterations end, and the fractions of `top` with a disagreement.

    The counts are summed over all fractions. At a fraction with a disagreement, an iteration from
    some contact set does not end in the answer that is followed from zero friction. The counts also
    contain `difference`, the largest difference between the pressures of answers that count as the
    same.

    Parameters
    ----------
    problems : FrictionDependentProblem
        The contact problem of a shoe as a function of friction.
    top : float
        Friction that is multiplied by FRACTIONS_OF_LOCKING_FRICTION_WITH_ONE_ANSWER.
    starts : list of array (n,)
        Contact sets from which the iteration starts: whether each of the n nodes touches.
    """
    counts: SelfLockingRow = dict.fromkeys(ATTRIBUTES_THAT_COUNT_HOW_CONTACT_ITERATIONS_END, 0) | {
        "difference": 0.0
    }
    disagreeing = []
    for fraction in FRACTIONS_OF_LOCKING_FRICTION_WITH_ONE_ANSWER:
        mu = fraction * top
        found = compare_solutions_from_starting_contact_sets(
            problems.contact_problem_at_friction_coefficient(mu),
            find_largest_friction_with_equilibrium(problems, mu).last_contact,
            starts,
        )
        for key, attribute in ATTRIBUTES_THAT_COUNT_HOW_CONTACT_ITERATIONS_END.items():
            counts[key] += getattr(found, attribute)
        counts["difference"] = max(counts["difference"], found.largest_pressure_difference)
        if found.sets_with_known_solution < found.number_of_start_sets:
            disagreeing.append(fraction)
    return counts, disagreeing


def _is_brake_solvable_with_exact_contact(scene: PreparedModel, brake: Brake) -> bool:
    """Whether a solve of drumlin with exact contact has an answer for the brake."""
    try:
        solve_prepared_model(scene, brake, penalty=math.inf)
    except NoAnswer:
        return False
    return True


def _kind_of_first_lining_clearance(brake: Brake) -> str:
    """The kind of clearance of the brake's first lining: "uneven", "even" or "none"."""
    given = brake.shoes[0].lining.clearance
    return "uneven" if isinstance(given, tuple) else "none" if given == 0 else "even"


def rows_of_torque_slopes_and_differences(
    brake: Brake, name: str, penalty: float
) -> list[SelfLockingRow]:
    """A row for each slope of the brake's torque, with the difference quotient from two solves.

    The first row also has the sensitivity S = (mu/T) dT/dmu to friction, by finite elements and by
    the sine law.

    Parameters
    ----------
    brake : Brake
        The brake.
    name : str
        Name of the brake in the rows.
    penalty : float
        Penalty factor of the contact; inf for exact contact.
    """
    found, table = compare_torque_slopes_with_solve_differences(
        brake, 1, elements=20, penalty=penalty
    )
    rows = [row | {"brake": name} for row in table]
    rows[0] |= {"S": found.S, "law": (found.law or (None,))[-1]}
    return rows
