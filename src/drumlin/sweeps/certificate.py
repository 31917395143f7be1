"""Certificates of a sweep: what the cases of its sample tell about its other cases.

The finite elements solve a case on two or more levels, divisions into finer and finer elements, and
state its errors from the differences between the levels. If a sweep is certified by sample, some of
its cases are solved on all levels, as they would be without a sample. The other cases are solved on
the first level only and take their errors from the sample.
"""

import hashlib
import json
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from drumlin.base.errors import NoAnswer, is_failure_of_memory_or_system
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.estimate import QUANTITIES_WITH_STATED_ERROR
from drumlin.fem.error_control.first_level import (
    errors_of_first_refinement_level,
    first_level_response_with_errors_of_sample,
    text_that_identifies_kind_of_contact,
)
from drumlin.fem.preparation.cache import CacheOfCondensedBodies
from drumlin.fem.preparation.scene import reason_against_finite_element_model
from drumlin.fem.solve import solve_brake_on_first_level_without_error_estimate
from drumlin.response.response import Response

NAME_OF_COLUMN_WITH_SOURCE_OF_ERRORS = "certified"
"""The name of the column that says where the stated errors of a case come from.

Its value is "itself" if the case was solved on all levels, and "sample" if its errors were taken
from the sample.
"""

LEAST_SOLVED_CASES_OF_CERTIFYING_SAMPLE = 3
"""Smallest number of solved cases of a sample whose errors may be used for other cases.

The largest error of fewer cases says little about other cases. The limit is a judgement.
"""

ROW_KEY_OF_FIRST_LEVEL_ERRORS = "first_level"
"""The name under which the row of a case in the sample keeps the errors of its first level.

The table of the sweep does not show it.
"""


class MarkOfSampleCaseSolvedOnAllLevels(NamedTuple):
    """The mark of a case in the sample: it is solved on all levels.

    The difference between its first and last level gives the errors of the first level.
    """

    def text_that_identifies_cases_in_journal(self) -> str:
        """The text by which the journal recognises cases with this mark."""
        return "sample"


class SampleErrorsForCasesOutsideSample(NamedTuple):
    """What the sample tells about the cases that are solved on the first level only.

    Attributes
    ----------
    kinds : kinds of cases in the sample, see `_text_that_identifies_kind_of_case`; a case of
        another kind is solved on all levels
    errors : largest relative errors of the first level in the sample, by the names of
        QUANTITIES_WITH_STATED_ERROR
    """

    kinds: tuple[str, ...]
    errors: Mapping[str, float]

    def text_that_identifies_cases_in_journal(self) -> str:
        """A digest by which the journal recognises cases with this certificate."""
        text = json.dumps([self.kinds, self.errors], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:16]


def sample_errors_for_cases_outside_sample(
    rows: Iterable[Mapping[str, Any]],
) -> SampleErrorsForCasesOutsideSample:
    """The certificate of a sample, from the rows of its solved cases.

    It has no kinds of cases, and so certifies no case, if fewer than
    LEAST_SOLVED_CASES_OF_CERTIFYING_SAMPLE rows have errors of a first level.
    """
    members = [
        row[ROW_KEY_OF_FIRST_LEVEL_ERRORS] for row in rows if ROW_KEY_OF_FIRST_LEVEL_ERRORS in row
    ]
    if len(members) < LEAST_SOLVED_CASES_OF_CERTIFYING_SAMPLE:
        return SampleErrorsForCasesOutsideSample((), {})
    kinds = sorted({str(member["kind"]) for member in members})
    largest = {}
    for name in QUANTITIES_WITH_STATED_ERROR:
        largest[name] = max(float(member[name]) for member in members)
    return SampleErrorsForCasesOutsideSample(tuple(kinds), largest)


def kind_and_first_level_errors_of_sample_case_from_responses(
    brake: Brake, changes: Mapping[str, Any], first: Response, last: Response
) -> dict[str, Any]:
    """The kind of a case in the sample, and the errors of its first level by name.

    Parameters
    ----------
    brake : the brake with its changed values
    changes : the changed values, by key of the brake file
    first, last : responses on the first and on the last level
    """
    errors = errors_of_first_refinement_level(brake, first, last)
    return {"kind": _text_that_identifies_kind_of_case(brake, changes, first)} | errors


def response_with_errors_certified_by_sample(
    brake: Brake,
    changes: Mapping[str, Any],
    certificate: SampleErrorsForCasesOutsideSample,
    options: Mapping[str, Any],
    cache: CacheOfCondensedBodies | None,
) -> Response | None:
    """The response of a case on the first level, with the errors of the sample.

    None if the case must be solved on all levels: finite elements do not apply to it, its first
    level has no solution, or the case is of a kind that is not in the sample.

    Parameters
    ----------
    brake : the brake with its changed values
    changes : the changed values, by key of the brake file
    certificate : what the sample tells
    options : options of the finite elements
    cache : keeps the condensed bodies of earlier solves

    Raises
    ------
    NoAnswer
        if the first level has no solution because memory or a file is missing
    """
    if reason_against_finite_element_model(brake) is not None:
        return None
    try:
        first = solve_brake_on_first_level_without_error_estimate(brake, **options, cache=cache)
    except NoAnswer as refusal:
        # A lack of memory says nothing about the case, which is tried again.
        if is_failure_of_memory_or_system(refusal):
            raise
        return None
    if (
        not first.converged
        or _text_that_identifies_kind_of_case(brake, changes, first) not in certificate.kinds
    ):
        return None
    return first_level_response_with_errors_of_sample(brake, first, certificate.errors)


def _text_that_identifies_kind_of_case(
    brake: Brake, changes: Mapping[str, Any], first: Response
) -> str:
    """A text that is equal for cases of one kind: same changed words and tables, same contact.

    A changed word is a value such as "clockwise", and a changed table is, for example, a clearance
    over the angle. Unlike numbers they have no extreme values that the sample could contain.
    """
    others = {key: value for key, value in changes.items() if not is_varied_value_a_number(value)}
    return json.dumps(
        [others, text_that_identifies_kind_of_contact(brake, first)], sort_keys=True, default=str
    )


def is_varied_value_a_number(value: Any) -> bool:
    """Whether a changed value is a number, and not a word, a table or true or false."""
    return isinstance(value, int | float) and not isinstance(value, bool)
