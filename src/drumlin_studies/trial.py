"""A trial: what becomes of a case of `extreme_cases`, and whether that is right.

Every trial ends in one of TRIAL_OUTCOMES. An answer is right where its own forces balance and its
pressures and gaps are complementary to 1e-8, and where six digits of its torque agree with the
whole system refined in long double (`drumlin.fem.error_control.refinement`), or as many as its condition allows. A
refusal is right where it names a physical reason.
"""

import dataclasses
import math
import time
import warnings
from typing import Any

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.contact.equations import condition
from drumlin.fem.equilibrium.group import ShoeGroup, groups_of
from drumlin.fem.error_control.refinement import EPSILON
from drumlin.fem.model import REFINED, refined_group, respond
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.response.response import Response
from drumlin_studies import pointwise
from drumlin_studies.extreme_cases import KnobCase

ANSWERS = ("answer", "no contact")
REFUSALS = {  # what a refusal says -> why
    "self-locking": "self-locking",
    "to touch the drum": "out of reach",
    "ever touching": "out of reach",
    "pressed in by": "out of reach",
    "no equilibrium": "no equilibrium",
    "too far apart": "arithmetic",
    "singular stiffness": "arithmetic",
}
TRIAL_FAULTS = ("not converged", "traceback", "inaccurate")
TRIAL_OUTCOMES = (*ANSWERS, *dict.fromkeys(REFUSALS.values()), "bad input", *TRIAL_FAULTS)
LARGEST_RESIDUAL = 1e-8  # relative, of balances and complementarity
TORQUE_DIGITS = 6  # of the torque
OTHER_ORDER = "MMD_AT_PLUS_A"  # of the elimination than the model takes where it refines
STIFFEST_PENALTY = 1e16  # penalty of the pointwise method in the place of an infinite one
POINTWISE_REFUSALS = {"repeats": "cycles", "singular": "singular"}  # what its refusal says -> why
LARGEST_POINTWISE = 12_000
"""Unknowns of a shoe up to which the pointwise method is tried.

The method takes up to 60 factorisations.
"""
POINTWISE_AGREEMENT = 1e-2
"""Relative difference of the torques up to which both methods agree.

A smaller difference is within the errors of the meshes.
"""


def trial(case: KnobCase) -> dict[str, Any]:
    """One row: the outcome of a case, its reason, and what the answer is worth."""
    row: dict[str, Any] = {"knob": case.knob, "case": said(case), "knobs": dataclasses.asdict(case)}
    start = time.perf_counter()
    brake = scene = response = None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            brake = case.brake()
            scene = prepare(brake, elements=case.elements, kind=case.kind, mesher=case.mesher())
            response = respond(scene, brake, penalty=case.penalty)
        row["outcome"] = (
            "answer" if any(shoe.contact_arcs for shoe in response.shoes) else "no contact"
        )
    except BadInput as error:
        row |= {"outcome": "bad input", "reason": str(error)}
    except NoAnswer as error:
        outcome = next(
            (why for words, why in REFUSALS.items() if words in str(error)), "not converged"
        )
        row |= {"outcome": outcome, "reason": str(error)}
    except Exception as error:  # what must never happen is a row of its own
        row |= {"outcome": "traceback", "reason": f"{type(error).__name__}: {error}"}
    row["seconds"] = time.perf_counter() - start
    if response is not None:
        assert brake is not None and scene is not None
        row |= {
            "torque": response.torque,
            "steps": response.iterations,
            "balance": max(response.balance.force, response.balance.moment),
            "refined": any(REFINED in note for note in response.notes),
        }
        if row["outcome"] == "answer":
            row |= worth(scene, brake, response, case.penalty)
            if not sound(row):
                row |= {"outcome": "inaccurate"}
    if brake is not None and scene is not None:
        large = max(body.unknowns for body in scene.bodies) > LARGEST_POINTWISE
        row |= {"pointwise": "not tried: too large"} if large else beside(case, brake, response)
    return row


def said(case: KnobCase) -> str:
    """What a case changes, in a few words."""
    return ", ".join(
        f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}"
        for key, value in case.changes.items()
    )


def sound(row: dict[str, Any]) -> bool:
    """Whether residuals and digits of an answer are as they must be, or as its condition allows."""
    if row["digits"] is None:
        return False
    return max(row["balance"], row["complementarity"]) <= LARGEST_RESIDUAL and row["digits"] >= min(
        TORQUE_DIGITS, row["allowed"]
    )


def worth(scene: PreparedModel, brake: Brake, response: Response, penalty: float) -> dict[str, Any]:
    """Residuals, condition and digits of an answer, the worst over its groups of shoes.

    `complementarity`: of the reported pressures with the gaps of the refined whole system, relative
    to their largest terms; `condition`: 1-norm estimate of the equilibrated contact equations;
    `torque_condition`: the torque's own, and the digits that it leaves to double precision
    `allowed`; `digits` of the torque that agree with the refined whole system, at most 16 and at
    most what the refinement itself is sure of; `pressure_error`: in the maximum norm.
    """
    rows = [_worth(response, group) for group in groups_of(scene, brake, penalty)]
    worst: dict[str, Any] = {
        key: max(row[key] for row in rows) for key in ("condition", "seconds_whole")
    }
    known = [row for row in rows if row["digits"] is not None]
    if len(known) < len(rows):
        return {
            **worst,
            "digits": None,
            "allowed": 0.0,
            "whole": next(r["whole"] for r in rows if r["whole"]),
        }
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


def _worth(response: Response, group: ShoeGroup) -> dict[str, Any]:
    group, _ = group.settled()
    size, shoes = group.unit_force, [response.shoes[i] for i in group.members]
    p = (
        np.concatenate(
            [r.pressure[:: s.frame.sense] for r, s in zip(shoes, group.shoes, strict=True)]
        )
        / size
    )
    active = p > 0
    row: dict[str, Any] = {
        "condition": condition(group.problem, active),
        "digits": None,
        "whole": "",
    }
    start = time.perf_counter()
    try:
        found = refined_group(group, active, OTHER_ORDER)
    except NoAnswer as error:
        return row | {"whole": str(error), "seconds_whole": time.perf_counter() - start}
    row["seconds_whole"] = time.perf_counter() - start
    torque = sum(shoe.torque for shoe in shoes) / size
    off = abs(torque - found.torque) / found.torque if found.torque else 0.0
    q = np.concatenate(found.p)
    return row | {
        "complementarity": float(max(-found.gap.min(), (np.abs(found.gap) * p).max() / p.max())),
        "digits": min(digits_of(off), digits_of(found.correction)),
        "sure": digits_of(found.correction),
        "allowed": digits_of(0.0 if math.isnan(found.condition) else EPSILON * found.condition),
        "torque_condition": None if math.isnan(found.condition) else found.condition,
        "pressure_error": float(np.abs(p - q).max() / q.max()),
        "sets": found.sets,
    }


def digits_of(error: float) -> float:
    """Digits that a relative error leaves: from 0 to 16."""
    return float(np.clip(-math.log10(max(error, 1e-16)), 0, 16))


def beside(case: KnobCase, brake: Brake, response: Response | None) -> dict[str, Any]:
    """What the classical pointwise penalty makes of a case: outcome, difference of torque, steps,
    time.
    """
    start = time.perf_counter()
    row: dict[str, Any] = {}
    try:
        with np.errstate(all="ignore"):
            other = pointwise.solve(
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
        row["pointwise"] = next(
            (why for words, why in POINTWISE_REFUSALS.items() if words in str(error)),
            "does not end",
        )
    except Exception as error:
        row["pointwise"] = f"{type(error).__name__}"
    return row | {"pointwise_seconds": time.perf_counter() - start}
