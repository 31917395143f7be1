"""The benchmark ladder: cases with known answers, from a textbook's brake up to frictional contact
of two bodies.

Each is judged by a closed form, a balance or a published number; none by what drumlin gave before.
"""

from collections.abc import Sequence
from typing import Any

from drumlin_studies.ladder_bodies import BODY_CASES as BODIES
from drumlin_studies.ladder_case import KnownAnswer
from drumlin_studies.ladder_contact import CONTACT_CASES as CONTACT
from drumlin_studies.ladder_friction import FRICTION_CASES as FRICTION
from drumlin_studies.ladder_laws import LAW_CASES as LAWS
from drumlin_studies.ladder_pads import PAD_CASES as PADS

LADDER_CASES: tuple[KnownAnswer, ...] = (*LAWS, *BODIES, *CONTACT, *PADS, *FRICTION)


def families(cases: Sequence[KnownAnswer] = LADDER_CASES) -> tuple[str, ...]:
    """The families of some cases, in their order."""
    return tuple(dict.fromkeys(case.family for case in cases))


def within(case: KnownAnswer, value: float) -> bool:
    """Whether a value is the expected one to the case's tolerance; nan never is."""
    return abs(value - case.expected) <= case.tolerance * abs(case.expected)


def row(case: KnownAnswer) -> dict[str, Any]:
    """A case and what drumlin gives for it, as a row of a table."""
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
        "status": "within" if within(case, value) else "failed: outside",
    }
