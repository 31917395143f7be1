"""An experiment with the rule by which drumlin refines its hp meshes from level to level.

    make levels                        the rule as it is
    make levels ARGS="fall=6"          the rule as it is, then with this number changed
    make levels ARGS="fall=6 sizes=.7" the rule as it is, then with both numbers changed

The rule, `levels.RULE_OF_DEGREE_AND_GRADING`, gives degree and grading of each level; its eight
numbers, which `levels.RuleOfDegreeAndGradingByLevel` explains, were found by experiment. For each
rule this command solves the random brakes of the error estimate's fit on four levels, and prints

- the safety factors of the error estimate, fitted on these levels alone;
- for each of three tolerances, the processor time of all brakes up to the level where a solve would
  stop, and the percentage of brakes that reach the tolerance on four levels;
- the median ratio of stated to true error of each quantity, with the number of stated errors that
  are too small.

The far finer solutions, from which true errors are taken, need ten minutes on two cores, each rule
one to three minutes.
"""

import sys
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.errors import NoAnswer
from drumlin.fem.error_control.estimate import (
    QUANTITIES_WITH_STATED_ERROR,
    SafetyFactorsOfErrorEstimate,
)
from drumlin.fem.error_control.levels import (
    RULE_OF_DEGREE_AND_GRADING,
    RuleOfDegreeAndGradingByLevel,
    SolvedLevel,
    solve_brake_on_finer_and_finer_mesh_levels,
)
from drumlin.fem.model import solve_prepared_model
from drumlin_studies.calibration import (
    FIRST_SEED,
    FITTED_BRAKES,
    TrueErrorsAndEstimateTermsOnLevel,
    draw_random_calibration_brake_and_name_of_kind,
    fit_safety_factors,
    true_errors_and_estimates_on_each_mesh,
)
from drumlin_studies.sharpness import TOLERANCES_OF_SOLVES_BY_NAME
from drumlin_studies.side_by_side import NUMBER_OF_PROCESSES_OF_STUDY
from drumlin_studies.stated_true import FarFinerSolutionOfBrake
from drumlin_studies.stored_truth import (
    LEAST_USABLE_TRUE_ERROR_OVER_ITS_UNCERTAINTY,
    solve_brake_by_finer_hp_meshes,
)

NUMBER_OF_LEVELS_TRIED_PER_RULE = 4
"""Number of levels on which the brakes are solved for each rule.

A fifth level would take more time than the first four together, and few brakes need it."""


class LevelErrorsAndTimesByRule(NamedTuple):
    """Errors and times of one brake, solved on the hp meshes (levels) that a refinement rule gives.

    Attributes
    ----------
    levels : true errors and the terms of their estimates, for each level from the second level on
    seconds : processor time [s] of each level, from the first level on
    """

    levels: list[TrueErrorsAndEstimateTermsOnLevel]
    seconds: list[float]


def far_finer_solution_of_random_brake_or_none(seed: int) -> FarFinerSolutionOfBrake | None:
    """The far finer solution of the random brake of a seed, or None without an equilibrium."""
    try:
        return solve_brake_by_finer_hp_meshes(
            draw_random_calibration_brake_and_name_of_kind(seed)[1]
        )
    except NoAnswer:
        return None


def solve_random_brake_with_level_rule(
    seed: int, truth: FarFinerSolutionOfBrake | None, rule: RuleOfDegreeAndGradingByLevel
) -> LevelErrorsAndTimesByRule | None:
    """Errors and times of the random brake of a seed on the meshes that a refinement rule gives.

    Returns None if the brake has no equilibrium, or if `truth`, the far finer solution, is None.
    """
    brake = draw_random_calibration_brake_and_name_of_kind(seed)[1]
    if truth is None:
        return None
    # Only the solves are timed, not the comparison with the finer solution.
    found: list[SolvedLevel] = []
    seconds: list[float] = []
    begin = time.process_time()
    try:
        for step in solve_brake_on_finer_and_finer_mesh_levels(
            brake,
            solve_prepared_model,
            levels=[
                rule.refinement_level_with_number(k + 1)
                for k in range(NUMBER_OF_LEVELS_TRIED_PER_RULE)
            ],
        ):
            seconds.append(time.process_time() - begin)
            found.append(step)
            begin = time.process_time()
    except NoAnswer:
        return None
    return LevelErrorsAndTimesByRule(
        true_errors_and_estimates_on_each_mesh(brake, truth, found), seconds
    )


class StoppingLevel(NamedTuple):
    """The level at which a solve stops: the first level within the tolerance, or the last level.

    Attributes
    ----------
    seconds : processor time of this level and all levels before it [s]
    reached : whether the stated errors are within the tolerance
    stated : stated errors by quantity
    level : true errors of the level, and terms of their estimate
    """

    seconds: float
    reached: bool
    stated: Mapping[str, float]
    level: TrueErrorsAndEstimateTermsOnLevel


def find_mesh_at_which_refinement_stops(
    brake: LevelErrorsAndTimesByRule,
    factors: SafetyFactorsOfErrorEstimate,
    pressure: float,
    torque: float,
) -> StoppingLevel:
    """The mesh (level) at which a solve stops, for relative tolerances of p and of the torque."""
    for k, level in enumerate(brake.levels, 2):
        stated = _errors_stated_on_mesh_by_safety_factors(level, factors)
        reached = stated["pressure"] <= pressure and stated["torque"] <= torque
        if reached or k == len(brake.seconds):
            return StoppingLevel(sum(brake.seconds[:k]), reached, stated, level)
    raise ValueError("a brake that was tried on one level alone")


def _errors_stated_on_mesh_by_safety_factors(
    level: TrueErrorsAndEstimateTermsOnLevel, factors: SafetyFactorsOfErrorEstimate
) -> dict[str, float]:
    """Errors, by quantity, that drumlin would state on a level with the given safety factors."""
    # The pressure and its peak have their own factors. The torque and the reaction share the factor
    # of forces.
    factor = {"pressure": factors.pressure, "peak": factors.peak}
    stated = {}
    for name in QUANTITIES_WITH_STATED_ERROR:
        moved = factor.get(name, factors.force) * level.step[name]
        by_chance = 0.0 if name in factor else factors.cancelled * level.chance[name]
        stated[name] = moved + by_chance + level.beside[name]
    return stated


def report_text_on_refinement_rule(brakes: Sequence[LevelErrorsAndTimesByRule]) -> str:
    """The text that `main` prints for the brakes solved with one rule."""
    factors = fit_safety_factors([level for brake in brakes for level in brake.levels])
    lines = [f"  {factors}"]
    for asked, tolerance in TOLERANCES_OF_SOLVES_BY_NAME.items():
        stops = [
            find_mesh_at_which_refinement_stops(brake, factors, *tolerance) for brake in brakes
        ]
        seconds = sum(each.seconds for each in stops)
        share = sum(each.reached for each in stops) / len(stops)
        lines.append(f"  {asked}: {seconds:.1f} s, {100 * share:.1f} % reached")
        lines += [
            f"    {name}: {_text_on_ratios_of_stated_to_true_error(stops, name)}"
            for name in QUANTITIES_WITH_STATED_ERROR
        ]
    return "\n".join(lines)


def _text_on_ratios_of_stated_to_true_error(stops: Sequence[StoppingLevel], quantity: str) -> str:
    """Text with the median ratio of stated to true error, and the number of ratios below 1."""
    # Levels whose true error is not known well enough do not count.
    certain = [
        stop.stated[quantity] / stop.level.true[quantity]
        for stop in stops
        if stop.level.true[quantity]
        > LEAST_USABLE_TRUE_ERROR_OVER_ITS_UNCERTAINTY * stop.level.unsure[quantity]
    ]
    small = sum(ratio < 1 for ratio in certain)
    return f"median {np.median(certain):.1f}, {small} of {len(certain)} too small"


def refinement_rule_with_changed_numbers(words: Sequence[str]) -> RuleOfDegreeAndGradingByLevel:
    """A copy of RULE_OF_DEGREE_AND_GRADING with the new numbers of words such as `fall=6`.

    Raises ValueError for a word of another form.
    """
    numbers: dict[str, Any] = {}
    for word in words:
        name, _, value = word.partition("=")
        numbers[name] = int(value) if name == "first_degree" else float(value)
    return RULE_OF_DEGREE_AND_GRADING._replace(**numbers)


def main(words: Sequence[str]) -> int:
    """Print the report on the present rule and on the rule changed by `words`; returns 0."""
    seeds = range(FIRST_SEED, FIRST_SEED + FITTED_BRAKES)
    rules = {"as it is": RULE_OF_DEGREE_AND_GRADING} | (
        {" ".join(words): refinement_rule_with_changed_numbers(words)} if words else {}
    )
    with ProcessPoolExecutor(NUMBER_OF_PROCESSES_OF_STUDY, mp_context=get_context("spawn")) as pool:
        truths = list(pool.map(far_finer_solution_of_random_brake_or_none, seeds))
        for name, rule in rules.items():
            print(f"{name}: {rule}", flush=True)  # noqa: T201
            found = pool.map(solve_random_brake_with_level_rule, seeds, truths, [rule] * len(seeds))
            answered = [brake for brake in found if brake is not None]
            print(report_text_on_refinement_rule(answered), flush=True)  # noqa: T201
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
