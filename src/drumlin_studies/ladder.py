"""The benchmark ladder: cases with known answers, from a textbook's brake up to frictional contact
of two bodies.

Each is judged by a closed form, a balance or a published number; none by what drumlin gave before.
"""

from collections.abc import Sequence
from typing import Any

from drumlin_studies.ladder_bodies import CASES as BODIES
from drumlin_studies.ladder_case import Case
from drumlin_studies.ladder_contact import CASES as CONTACT
from drumlin_studies.ladder_friction import CASES as FRICTION
from drumlin_studies.ladder_laws import CASES as LAWS
from drumlin_studies.ladder_pads import CASES as PADS

CASES: tuple[Case, ...] = (*LAWS, *BODIES, *CONTACT, *PADS, *FRICTION)


def families(cases: Sequence[Case] = CASES) -> tuple[str, ...]:
    """The families of some cases, in their order."""
    return tuple(dict.fromkeys(case.family for case in cases))


def within(case: Case, value: float) -> bool:
    """Whether a value is the expected one to the case's tolerance; nan never is."""
    return abs(value - case.expected) <= case.tolerance * abs(case.expected)


def row(case: Case) -> dict[str, Any]:
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
