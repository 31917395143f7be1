"""Trials: solves of the extreme brakes of `extreme_cases`, each with a verdict on its outcome.

Every trial ends in one of ALL_TRIAL_OUTCOMES. An answer is right under three conditions: its forces
balance, pressure times gap is zero at each node to 1e-8, and six digits of its torque agree with
the refined solution. The refined solution comes from the whole system of equations in extended
precision (`drumlin.fem.error_control.refinement`). If the condition number of the problem allows
less than six exact digits, only these digits must agree. A refusal is right if it names a physical
reason.
"""

import dataclasses
import math
import time
import warnings
from typing import Any

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.contact.equations import condition_number_on_contact_set
from drumlin.fem.equilibrium.group import ShoeGroup, divide_pressed_shoes_into_groups
from drumlin.fem.model import (
    ITERATIVE_REFINEMENT_REMARK,
    RELATIVE_SPACING_OF_DOUBLES,
    solve_full_system_of_group_by_refinement,
    solve_prepared_model,
)
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.response.response import Response
from drumlin_studies import pointwise
from drumlin_studies.extreme_cases import ExtremeCase

TRIAL_OUTCOMES_WITH_ANSWER = ("answer", "no contact")
"""Outcomes in which a solve gives an answer."""
REFUSAL_OUTCOMES_BY_MESSAGE_WORDS = {
    "self-locking": "self-locking",
    "to touch the drum": "out of reach",
    "ever touching": "out of reach",
    "pressed in by": "out of reach",
    "no equilibrium": "no equilibrium",
    "too far apart": "arithmetic",
    "singular stiffness": "arithmetic",
}
"""Outcome of a trial that a solve refuses, by words in the error message."""
TRIAL_OUTCOMES_THAT_ARE_FAULTS_OF_DRUMLIN = ("not converged", "traceback", "inaccurate")
"""Outcomes of a trial that are faults of drumlin and must not occur."""
ALL_TRIAL_OUTCOMES = (
    *TRIAL_OUTCOMES_WITH_ANSWER,
    *dict.fromkeys(REFUSAL_OUTCOMES_BY_MESSAGE_WORDS.values()),
    "bad input",
    *TRIAL_OUTCOMES_THAT_ARE_FAULTS_OF_DRUMLIN,
)
"""All outcomes of a trial: answers, refusals with a reason, bad input, and faults."""
LARGEST_RELATIVE_RESIDUAL_OF_RIGHT_ANSWER = 1e-8
"""Largest relative residual of a right answer, for the balances of forces and moments and for the
products of pressure and gap.
"""
TORQUE_DIGITS_THAT_AGREE_WITH_REFINED_SOLUTION = 6
"""Number of digits of the torque that must agree with the refined solution."""
ELIMINATION_ORDER_OF_REFINED_SOLUTION = "MMD_AT_PLUS_A"
"""Name, in the library SuperLU, of the order in which the refined solution eliminates its unknowns.

The order differs from the order of an ordinary solve. Therefore both solutions have different
round-off.
"""
LARGEST_FACTOR_OF_POINTWISE_PENALTY = 1e16
"""Largest penalty factor of the pointwise penalty; it also replaces an infinite factor."""
POINTWISE_REFUSAL_OUTCOMES_BY_WORDS = {"repeats": "cycles", "singular": "singular"}
"""Outcome of a trial without an answer by the pointwise penalty, by words in the error message."""
MOST_UNKNOWNS_FOR_POINTWISE_PENALTY = 12_000
"""Largest number of unknowns of a shoe for which the pointwise penalty is tried.

The pointwise penalty factorises the whole system of equations up to 60 times.
"""
LARGEST_TORQUE_DIFFERENCE_FROM_POINTWISE_PENALTY = 1e-2
"""Relative difference below which the torques of drumlin and of the pointwise penalty agree.

A smaller difference can be due to discretisation errors.
"""


def solve_and_judge_case(case: ExtremeCase) -> dict[str, Any]:
    """Solve a case and return its row: outcome, reason, times, and the accuracy of an answer."""
    row: dict[str, Any] = {
        "knob": case.knob,
        "case": text_of_changed_quantities(case),
        "knobs": dataclasses.asdict(case),
    }
    start = time.perf_counter()
    brake = scene = response = None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            brake = case.brake()
            scene = make_prepared_model(
                brake,
                elements=case.elements,
                kind=case.kind,
                mesher=case.function_that_meshes_shoe_with_aspect_ratio(),
            )
            response = solve_prepared_model(scene, brake, penalty=case.penalty)
        touches = any(shoe.contact_arcs for shoe in response.shoes)
        row["outcome"] = "answer" if touches else "no contact"
    # A trial looks for unexpected exceptions. Therefore any exception becomes an outcome of the
    # row.
    except Exception as error:
        row |= _outcome_and_reason_of_failed_case(error)
    row["seconds"] = time.perf_counter() - start
    if response is not None:
        assert brake is not None and scene is not None
        row |= _row_with_accuracy_of_answer(row, scene, brake, response, case.penalty)
    # The pointwise penalty is tried as well, unless its system would be too large.
    if brake is not None and scene is not None:
        too_large = (
            max(body.unknowns for body in scene.bodies) > MOST_UNKNOWNS_FOR_POINTWISE_PENALTY
        )
        not_tried = {"pointwise": "not tried: too large"}
        row |= not_tried if too_large else compare_with_pointwise_penalty(case, brake, response)
    return row


def _outcome_and_reason_of_failed_case(error: Exception) -> dict[str, str]:
    """The values of `outcome` and `reason` in the row of a case that raised an error, by key."""
    if isinstance(error, BadInput):
        return {"outcome": "bad input", "reason": str(error)}
    if isinstance(error, NoAnswer):
        outcomes = (
            outcome
            for words, outcome in REFUSAL_OUTCOMES_BY_MESSAGE_WORDS.items()
            if words in str(error)
        )
        return {"outcome": next(outcomes, "not converged"), "reason": str(error)}
    return {"outcome": "traceback", "reason": f"{type(error).__name__}: {error}"}


def _row_with_accuracy_of_answer(
    row: dict[str, Any], scene: PreparedModel, brake: Brake, response: Response, penalty: float
) -> dict[str, Any]:
    """The row with torque, balance and accuracy of an answer added.

    The outcome becomes "inaccurate" where the answer is not right.

    Parameters
    ----------
    row : dict
        The row of the case so far.
    scene : PreparedModel
        The prepared model of the brake.
    brake : Brake
        The brake.
    response : Response
        The answer.
    penalty : float
        Penalty factor of the contact.
    """
    row = row | {
        "torque": response.torque,
        "steps": response.iterations,
        "balance": max(response.balance.force, response.balance.moment),
        "refined": any(ITERATIVE_REFINEMENT_REMARK in note for note in response.notes),
    }
    if row["outcome"] == "answer":
        row |= worst_numerical_accuracy_of_shoe_groups(scene, brake, response, penalty)
        if not is_answer_accurate(row):
            row |= {"outcome": "inaccurate"}
    return row


def text_of_changed_quantities(case: ExtremeCase) -> str:
    """Names and values of the quantities ("knobs") that a case changes, as text."""
    words = []
    for key, value in case.parameters_changed_from_default_case.items():
        words.append(f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}")
    return ", ".join(words)


def is_answer_accurate(row: dict[str, Any]) -> bool:
    """Whether the answer of a row is right.

    An answer is right if its residuals are small and TORQUE_DIGITS_THAT_AGREE_WITH_REFINED_SOLUTION
    digits of its torque are correct. If the condition number of the problem allows fewer digits,
    only these digits must be correct.
    """
    if row["digits"] is None:
        return False
    residual = max(row["balance"], row["complementarity"])
    return residual <= LARGEST_RELATIVE_RESIDUAL_OF_RIGHT_ANSWER and row["digits"] >= min(
        TORQUE_DIGITS_THAT_AGREE_WITH_REFINED_SOLUTION, row["allowed"]
    )


def worst_numerical_accuracy_of_shoe_groups(
    scene: PreparedModel, brake: Brake, response: Response, penalty: float
) -> dict[str, Any]:
    """Residuals, condition numbers and correct digits of an answer: the worst of all shoe groups.

    A group consists of shoes that the ring, a cam or a strut couples. The refined solution is a
    second solution of the same equations, by iterative refinement in extended precision.

    Keys of the result: `complementarity`, the largest violation of the contact conditions (product
    of pressure and gap, or penetration), relative to the largest pressure; `condition`, an estimate
    in the 1-norm for the scaled contact equations; `torque_condition`, the condition of the torque;
    `allowed`, the digits that this condition leaves in double precision; `digits`, the number of
    digits of the torque that agree with the refined solution, at most 16; `sure`, the number of
    digits of the refined solution that are certain, an upper limit of `digits`; `pressure_error`,
    the relative error of the pressure in the maximum norm; `sets`, the number of contact sets that
    the refinement tried; `seconds_whole`, the time of the refined solution. If the refined solution
    failed, `digits` is None and the further key `whole` gives the reason.
    """
    groups = divide_pressed_shoes_into_groups(scene, brake, penalty)
    rows = [_accuracy_of_answer_of_group(response, group) for group in groups]
    worst: dict[str, Any] = {
        "condition": max(row["condition"] for row in rows),
        "seconds_whole": max(row["seconds_whole"] for row in rows),
    }
    # If the refined solution of a group failed, the number of correct digits of the answer is not
    # known.
    known = [row for row in rows if row["digits"] is not None]
    if len(known) < len(rows):
        failure = next(row["whole"] for row in rows if row["whole"])
        return {**worst, "digits": None, "allowed": 0.0, "whole": failure}
    for key in ("complementarity", "pressure_error", "sets"):
        worst[key] = max(row[key] for row in rows)
    for key in ("digits", "allowed", "sure"):
        worst[key] = min(row[key] for row in rows)
    # None stands for a group whose torque has no condition number.
    worst["torque_condition"] = max(row["torque_condition"] or 0.0 for row in rows) or None
    return worst


def _accuracy_of_answer_of_group(response: Response, group: ShoeGroup) -> dict[str, Any]:
    """The values of `worst_numerical_accuracy_of_shoe_groups` for one group of coupled shoes.

    The key `whole` is the reason why the refined solution of the group failed, or empty.
    """
    group, _ = group.solve_contact_and_abutment_friction()
    # In the equations of the group the largest actuation force is 1. `size` is this force [N].
    size, shoes = group.largest_actuation_force, [response.shoes[i] for i in group.members]
    # The pressures of the answer divided by `size`, in the order of the group's nodes.
    pairs = zip(shoes, group.shoes, strict=True)
    p = np.concatenate([found.pressure[:: shoe.frame.sense] for found, shoe in pairs]) / size
    active = p > 0
    row: dict[str, Any] = {
        "condition": condition_number_on_contact_set(group.contact_problem_of_group, active)
    }
    row |= {"digits": None, "whole": ""}
    start = time.perf_counter()
    try:
        refined = solve_full_system_of_group_by_refinement(
            group, active, ELIMINATION_ORDER_OF_REFINED_SOLUTION
        )
    except NoAnswer as error:
        return row | {"whole": str(error), "seconds_whole": time.perf_counter() - start}
    row["seconds_whole"] = time.perf_counter() - start
    # Both torques are divided by the largest actuation force.
    torque = sum(shoe.torque for shoe in shoes) / size
    off = abs(torque - refined.torque) / refined.torque if refined.torque else 0.0
    exact = np.concatenate(refined.p)
    products = np.abs(refined.scaled_weighted_gaps) * p
    known_condition = not math.isnan(refined.condition_number_of_torque)
    return row | {
        "complementarity": float(
            max(-refined.scaled_weighted_gaps.min(), products.max() / p.max())
        ),
        "digits": min(
            correct_decimal_digits_at_relative_error(off),
            correct_decimal_digits_at_relative_error(refined.correction),
        ),
        "sure": correct_decimal_digits_at_relative_error(refined.correction),
        "allowed": correct_decimal_digits_at_relative_error(
            RELATIVE_SPACING_OF_DOUBLES * refined.condition_number_of_torque
            if known_condition
            else 0.0
        ),
        "torque_condition": refined.condition_number_of_torque if known_condition else None,
        "pressure_error": float(np.abs(p - exact).max() / exact.max()),
        "sets": refined.contact_sets,
    }


def correct_decimal_digits_at_relative_error(error: float) -> float:
    """Number of correct decimal digits of a value with the relative error `error`, from 0 to 16."""
    return float(np.clip(-math.log10(max(error, 1e-16)), 0, 16))


def compare_with_pointwise_penalty(
    case: ExtremeCase, brake: Brake, response: Response | None
) -> dict[str, Any]:
    """Solve a case by the pointwise penalty as well, and compare its torque with drumlin's torque.

    The result is a part of a row: the outcome `pointwise`, the relative difference of the torques,
    the number of Newton steps and the time.

    Parameters
    ----------
    case : ExtremeCase
        The case.
    brake : Brake
        The brake of the case.
    response : Response or None
        The response of drumlin; None where drumlin has refused the case.
    """
    start = time.perf_counter()
    row: dict[str, Any] = {}
    try:
        with np.errstate(all="ignore"):
            other = pointwise.solve_by_pointwise_penalty(
                brake,
                elements=case.elements,
                kind=case.kind,
                penalty=min(case.penalty, LARGEST_FACTOR_OF_POINTWISE_PENALTY),
                mesher=case.function_that_meshes_shoe_with_aspect_ratio(),
            )
        row["pointwise_steps"] = other.iterations
        if response is None:
            row["pointwise"] = "a number where there is none"
        elif response.torque == other.torque == 0:
            row["pointwise"] = "agrees"
        else:
            off = abs(other.torque - response.torque) / max(response.torque, other.torque)
            row |= {
                "pointwise": "agrees"
                if off < LARGEST_TORQUE_DIFFERENCE_FROM_POINTWISE_PENALTY
                else "differs",
                "pointwise_off": off,
            }
    except BadInput:
        row["pointwise"] = "not for rings"
    except NoAnswer as error:
        outcomes = (
            why for words, why in POINTWISE_REFUSAL_OUTCOMES_BY_WORDS.items() if words in str(error)
        )
        row["pointwise"] = next(outcomes, "does not end")
    except Exception as error:
        row["pointwise"] = f"{type(error).__name__}"
    return row | {"pointwise_seconds": time.perf_counter() - start}
