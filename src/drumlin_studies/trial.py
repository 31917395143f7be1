"""A trial: what becomes of a case of `extreme_cases`, and whether this is right.

Every trial ends in one of TRIAL_OUTCOMES. An answer is right under three conditions: its forces
balance, its pressures and gaps are complementary to 1e-8, and six digits of its torque agree with
the refined solution. The refined solution solves the whole system in long double
(`drumlin.fem.error_control.refinement`); where its condition leaves fewer digits, fewer must agree.
A refusal is right where it names a physical reason.
"""

import dataclasses
import math
import time
import warnings
from typing import Any

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.contact.equations import condition_number
from drumlin.fem.equilibrium.group import ShoeGroup, divide_pressed_shoes_into_groups
from drumlin.fem.error_control.refinement import EPSILON
from drumlin.fem.model import REFINED_REMARK, refine_group_solution, solve_prepared_model
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.response.response import Response
from drumlin_studies import pointwise
from drumlin_studies.extreme_cases import KnobCase

ANSWERS = ("answer", "no contact")
"""Outcomes with a number."""
REFUSALS = {
    "self-locking": "self-locking",
    "to touch the drum": "out of reach",
    "ever touching": "out of reach",
    "pressed in by": "out of reach",
    "no equilibrium": "no equilibrium",
    "too far apart": "arithmetic",
    "singular stiffness": "arithmetic",
}
"""Outcome of a refusal, by words of its message."""
TRIAL_FAULTS = ("not converged", "traceback", "inaccurate")
"""Outcomes that must not occur."""
TRIAL_OUTCOMES = (*ANSWERS, *dict.fromkeys(REFUSALS.values()), "bad input", *TRIAL_FAULTS)
"""All outcomes of a trial."""
LARGEST_RESIDUAL = 1e-8
"""Largest relative residual of balances and of complementarity of a right answer."""
TORQUE_DIGITS = 6
"""Digits of the torque that must agree with the refined solution."""
OTHER_ORDER = "MMD_AT_PLUS_A"
"""Order of elimination of the refined solution.

It differs from the order that the model uses, so that both have different round-off.
"""
STIFFEST_PENALTY = 1e16
"""Penalty of the pointwise method in place of an infinite penalty."""
POINTWISE_REFUSALS = {"repeats": "cycles", "singular": "singular"}
"""Outcome of a refusal of the pointwise method, by words of its message."""
LARGEST_POINTWISE = 12_000
"""Unknowns of a shoe up to which the pointwise method is tried.

The method takes up to 60 factorisations.
"""
POINTWISE_AGREEMENT = 1e-2
"""Relative difference of the torques up to which both methods agree.

A smaller difference is within the errors of the meshes.
"""


def try_case(case: KnobCase) -> dict[str, Any]:
    """The row of a case: its outcome with a reason, and the accuracy of an answer."""
    row: dict[str, Any] = {
        "knob": case.knob,
        "case": changed_knobs_text(case),
        "knobs": dataclasses.asdict(case),
    }
    start = time.perf_counter()
    brake = scene = response = None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            brake = case.brake()
            scene = prepare(brake, elements=case.elements, kind=case.kind, mesher=case.mesher())
            response = solve_prepared_model(scene, brake, penalty=case.penalty)
        touches = any(shoe.contact_arcs for shoe in response.shoes)
        row["outcome"] = "answer" if touches else "no contact"
    # Any exception becomes a row, because an unexpected one is what a trial looks for.
    except Exception as error:
        row |= _outcome_of_failure(error)
    row["seconds"] = time.perf_counter() - start
    if response is not None:
        assert brake is not None and scene is not None
        row |= _judged_row(row, scene, brake, response, case.penalty)
    if brake is not None and scene is not None:
        too_large = max(body.unknowns for body in scene.bodies) > LARGEST_POINTWISE
        not_tried = {"pointwise": "not tried: too large"}
        row |= not_tried if too_large else compare_with_pointwise(case, brake, response)
    return row


def _outcome_of_failure(error: Exception) -> dict[str, str]:
    """Outcome and reason of a case that raised an error."""
    if isinstance(error, BadInput):
        return {"outcome": "bad input", "reason": str(error)}
    if isinstance(error, NoAnswer):
        outcomes = (outcome for words, outcome in REFUSALS.items() if words in str(error))
        return {"outcome": next(outcomes, "not converged"), "reason": str(error)}
    return {"outcome": "traceback", "reason": f"{type(error).__name__}: {error}"}


def _judged_row(
    row: dict[str, Any], scene: PreparedModel, brake: Brake, response: Response, penalty: float
) -> dict[str, Any]:
    """The row of a response with its accuracy, and with an outcome "inaccurate" where it fails."""
    row = row | {
        "torque": response.torque,
        "steps": response.iterations,
        "balance": max(response.balance.force, response.balance.moment),
        "refined": any(REFINED_REMARK in note for note in response.notes),
    }
    if row["outcome"] == "answer":
        row |= answer_accuracy(scene, brake, response, penalty)
        if not is_sound(row):
            row |= {"outcome": "inaccurate"}
    return row


def changed_knobs_text(case: KnobCase) -> str:
    """The knobs that a case changes, in a few words."""
    words = []
    for key, value in case.changes.items():
        words.append(f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}")
    return ", ".join(words)


def is_sound(row: dict[str, Any]) -> bool:
    """Whether an answer has small residuals, and as many digits as its condition allows."""
    if row["digits"] is None:
        return False
    residual = max(row["balance"], row["complementarity"])
    return residual <= LARGEST_RESIDUAL and row["digits"] >= min(TORQUE_DIGITS, row["allowed"])


def answer_accuracy(
    scene: PreparedModel, brake: Brake, response: Response, penalty: float
) -> dict[str, Any]:
    """Residuals, condition and digits of an answer, the worst of all groups of shoes.

    Keys of the result: `complementarity`, the residual of the reported pressures with the gaps of
    the refined solution, relative to the largest terms; `condition`, a 1-norm estimate of the
    equilibrated contact equations; `torque_condition`, the condition of the torque; `allowed`, the
    digits that this condition leaves to double precision; `digits`, the digits of the torque that
    agree with the refined solution, at most 16; `sure`, the digits to which the refined solution
    itself is known, which limit `digits`; `pressure_error`, the relative error of p in the maximum
    norm; `sets`, the contact sets of the refinement; `seconds_whole`, its time.
    """
    rows = [
        _group_accuracy(response, group)
        for group in divide_pressed_shoes_into_groups(scene, brake, penalty)
    ]
    worst: dict[str, Any] = {
        key: max(row[key] for row in rows) for key in ("condition", "seconds_whole")
    }
    known = [row for row in rows if row["digits"] is not None]
    if len(known) < len(rows):
        failure = next(row["whole"] for row in rows if row["whole"])
        return {**worst, "digits": None, "allowed": 0.0, "whole": failure}
    return worst | {
        "complementarity": max(row["complementarity"] for row in rows),
        "digits": min(row["digits"] for row in rows),
        "allowed": min(row["allowed"] for row in rows),
        "torque_condition": max((row["torque_condition"] or 0.0 for row in rows), default=0.0)
        or None,
        "pressure_error": max(row["pressure_error"] for row in rows),
        "sure": min(row["sure"] for row in rows),
        "sets": max(row["sets"] for row in rows),
    }


def _group_accuracy(response: Response, group: ShoeGroup) -> dict[str, Any]:
    """The keys of `answer_accuracy` for one group of shoes.

    Under `whole` stands why the refined solution of the group failed.
    """
    group, _ = group.solve_contact()
    size, shoes = group.unit_force, [response.shoes[i] for i in group.members]
    # The reported pressures per unit force, in the order of the group's unknowns.
    pairs = zip(shoes, group.shoes, strict=True)
    p = np.concatenate([found.pressure[:: shoe.frame.sense] for found, shoe in pairs]) / size
    active = p > 0
    row: dict[str, Any] = {"condition": condition_number(group.problem, active)}
    row |= {"digits": None, "whole": ""}
    start = time.perf_counter()
    try:
        refined = refine_group_solution(group, active, OTHER_ORDER)
    except NoAnswer as error:
        return row | {"whole": str(error), "seconds_whole": time.perf_counter() - start}
    row["seconds_whole"] = time.perf_counter() - start
    # The refined solution is per unit force, as the group is.
    torque = sum(shoe.torque for shoe in shoes) / size
    off = abs(torque - refined.torque) / refined.torque if refined.torque else 0.0
    exact = np.concatenate(refined.p)
    products = np.abs(refined.gap) * p
    known_condition = not math.isnan(refined.condition)
    return row | {
        "complementarity": float(max(-refined.gap.min(), products.max() / p.max())),
        "digits": min(correct_digits(off), correct_digits(refined.correction)),
        "sure": correct_digits(refined.correction),
        "allowed": correct_digits(EPSILON * refined.condition if known_condition else 0.0),
        "torque_condition": refined.condition if known_condition else None,
        "pressure_error": float(np.abs(p - exact).max() / exact.max()),
        "sets": refined.contact_sets,
    }


def correct_digits(error: float) -> float:
    """Number of correct digits under a relative error, from 0 to 16."""
    return float(np.clip(-math.log10(max(error, 1e-16)), 0, 16))


def compare_with_pointwise(
    case: KnobCase, brake: Brake, response: Response | None
) -> dict[str, Any]:
    """What becomes of a case by the pointwise penalty.

    The result has the outcome `pointwise`, the relative difference of the torques, the Newton steps
    and the time.

    Parameters
    ----------
    case : KnobCase
        The case.
    brake : Brake
        Its brake.
    response : Response or None
        The response of drumlin, None where it has refused the case.
    """
    start = time.perf_counter()
    row: dict[str, Any] = {}
    try:
        with np.errstate(all="ignore"):
            other = pointwise.solve_by_pointwise_penalty(
                brake,
                elements=case.elements,
                kind=case.kind,
                penalty=min(case.penalty, STIFFEST_PENALTY),
                mesher=case.mesher(),
            )
        row["pointwise_steps"] = other.iterations
        if response is None:
            row["pointwise"] = "a number where there is none"
        elif response.torque == other.torque == 0:
            row["pointwise"] = "agrees"
        else:
            off = abs(other.torque - response.torque) / max(response.torque, other.torque)
            row |= {
                "pointwise": "agrees" if off < POINTWISE_AGREEMENT else "differs",
                "pointwise_off": off,
            }
    except BadInput:
        row["pointwise"] = "not for rings"
    except NoAnswer as error:
        outcomes = (why for words, why in POINTWISE_REFUSALS.items() if words in str(error))
        row["pointwise"] = next(outcomes, "does not end")
    except Exception as error:
        row["pointwise"] = f"{type(error).__name__}"
    return row | {"pointwise_seconds": time.perf_counter() - start}
