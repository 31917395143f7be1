"""The benchmark ladder: cases with known results, from simple brakes to contact with friction.

Each case compares a result of drumlin with a closed form, an equilibrium or a published number. No
case compares it with an earlier result of drumlin.
"""

from collections.abc import Sequence
from typing import Any

from drumlin_studies.ladder_bodies import KNOWN_ANSWER_CASES_ON_ELASTIC_BODIES as BODIES
from drumlin_studies.ladder_case import KnownAnswerCase
from drumlin_studies.ladder_contact import KNOWN_ANSWER_CASES_ON_CONTACT_WITHOUT_STICKING as CONTACT
from drumlin_studies.ladder_friction import KNOWN_ANSWER_CASES_ON_FRICTION_AND_WEAR as FRICTION
from drumlin_studies.ladder_laws import (
    KNOWN_ANSWER_CASES_ON_RIGID_SHOE_LAWS as LAWS_OF_HINGED_SHOES_BY_NAME,
)
from drumlin_studies.ladder_pads import KNOWN_ANSWER_CASES_ON_PADS as PADS

ALL_KNOWN_ANSWER_CASES: tuple[KnownAnswerCase, ...] = (
    *LAWS_OF_HINGED_SHOES_BY_NAME,
    *BODIES,
    *CONTACT,
    *PADS,
    *FRICTION,
)
"""All cases of the benchmark ladder."""


def names_of_families_of_known_answer_cases(
    cases: Sequence[KnownAnswerCase] = ALL_KNOWN_ANSWER_CASES,
) -> tuple[str, ...]:
    """The names of the families of cases, each name once, in the order of the cases."""
    return tuple(dict.fromkeys(case.family for case in cases))


def is_value_within_case_tolerance(case: KnownAnswerCase, value: float) -> bool:
    """Whether a value agrees with the expected value of a case, within the case's tolerance.

    The value nan never agrees.
    """
    return abs(value - case.expected) <= case.tolerance * abs(case.expected)


def run_known_answer_case_and_return_row(case: KnownAnswerCase) -> dict[str, Any]:
    """Run a case; returns a table row with expected value, drumlin's value and their agreement."""
    value = case.found()
    return {
        "family": case.family,
        "shows": case.shows,
        "source": case.source,
        "quantity": case.quantity,
        "expected": case.expected,
        "found": value,
        "difference": value / case.expected - 1,
        "tolerance": case.tolerance,
        "tier": case.tier,
        "status": "within" if is_value_within_case_tolerance(case, value) else "failed: outside",
    }
