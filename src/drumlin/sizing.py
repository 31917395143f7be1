"""Find the value of a key of a brake file at which a brake has a wanted torque or peak pressure.

The search begins at the value of the file. It uses the exact derivative of the torque by the key if
the finite elements give one. Each next value of the key follows from a rational function through
earlier answers. If this search finds no value, some values from the whole range of the key are
tried, and the rational function is used between two neighbours that enclose the wanted quantity.
The search does not go beyond values of the key at which there is no answer (a brake that locks
itself, a geometry that is not allowed). A refusal names the reason.
"""

import math
from bisect import insort
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.file import (
    are_allowed_values_of_key_an_interval,
    numerical_value_of_brake_key,
    si_unit_of_brake_key,
    values_of_brake_key,
    vary,
)
from drumlin.brake.units import quantity_with_usual_unit
from drumlin.fem.analysis.sensitivity import compute_torque_sensitivity
from drumlin.fem.analysis.slope_by_key import exact_torque_slope_by_key, slopes_wanted_for_key
from drumlin.fem.preparation.cache import CacheOfCondensedBodies
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.solve import (
    prepared_model_with_finest_elements,
    solve_brake_on_first_level_without_error_estimate,
)
from drumlin.models import model_with_name_that_applies_to_brake
from drumlin.response.response import Response

WORD_FOR_LARGEST_TORQUE = "largest"
"""The value of --torque that asks for the largest torque in the range of the key."""

DEFAULT_FACTOR_FROM_FILE_VALUE_TO_RANGE_END = 10.0
"""Factor between a quantity in the file and each end of its range, if no range is given.

It holds for quantities that keep their sign, such as lengths and forces. The value is a judgement:
the answer names the range that was searched, and the user may give another range.
"""
DEFAULT_HALF_RANGE_OF_ANGLE = math.radians(30)
"""Angle [rad] between an angle in the file and each end of its range, if no range is given."""

DEFAULT_HALF_RANGE_OF_COORDINATE_OVER_BRAKE_SIZE = 0.25
"""Length between a coordinate of the file and each end of its range, relative to brake size.

It holds for coordinates of points if no range is given, and is a judgement.
"""
NUMBER_OF_KEY_VALUES_TRIED_FIRST = 9
"""Number of values of the key, from end to end of its range, at which the brake is solved first.

If the torque crosses the wanted torque twice between two neighbours, this is not seen. More values
take more time.
"""
BISECTIONS_TO_LIMIT_OF_SOLVABLE_KEY_VALUES = 16
"""Number of bisections to find the value of the key beyond which the brake has no answer.

The brake may lock itself there, for example. The value is then known to 1e-5 of the distance
between two of the first trials.
"""
RELATIVE_KEY_STEP_OF_DIFFERENCE_QUOTIENT = 1e-2
"""Step of the key's value, up and down, for the difference quotient of torque or peak pressure.

The step is relative to the value of the key, or to the range of an angle or a coordinate. The slope
turns an error of the torque into an error of the key; the slope itself has an error of some 1 %.
With a smaller step the errors of the two torques would disturb the slope.
"""
KEY_TOLERANCE_AT_EXTREME_QUANTITY = 1e-4
"""Tolerance of the key's value at which a quantity has its maximum or minimum.

It is relative to the distance of the two values of the key between which the maximum is sought.
Near a maximum the torque is quadratic: the error of the torque is then some 1e-8 of the torque's
rise between these two values. A smaller tolerance takes more time.
"""
SEARCH_TOLERANCE_OVER_STATED_ERROR = 0.01
"""Fraction of the stated error of a torque or peak pressure at which the search for it ends.

The search ends when the quantity differs from its wanted value by less than this fraction of its
stated error.
"""

MOST_TRIALS_TO_ENCLOSE_WANTED_VALUE = 12
"""Largest number of trials, from the file's value on, until two enclose the wanted quantity.

Most questions take two to four trials. If these trials do not enclose the wanted quantity, the
whole range is tried, which takes more time.
"""
RELATIVE_DIFFERENCE_AT_DISCONTINUITY = 1e-9
"""Relative difference from the wanted value above which a quantity counts as discontinuous there.

The limit is used when two values of the key enclose the wanted value and differ only by round-off.
If the stated error is larger, the stated error replaces the limit. The round-off of a solve is some
1e-12: with a much smaller limit round-off would count as a jump.
"""
TORQUE_ERROR_ASSUMED_ON_FIRST_LEVEL = 1e-2
"""Relative error that the search assumes for torques on the first, coarse level of elements.

A range of the key is searched on the first level only if all torques there differ from the wanted
one by more than this error, so that the elements cannot decide on which side they lie. The torques
of the double-shoe brake on the first level are 1e-5 off. The value is a judgement: a larger one
sends more questions to the slower search on all levels, and no answer depends on it.
"""
MOST_TRIALS_AFTER_SEARCH_ON_FIRST_LEVEL = 6
"""Largest number of solves on all levels that follow a search on the first level of elements.

Two or three are enough, since each step has the exact slope or a rational function. If six do not
find the value, the whole range is searched on all levels.
"""
SEARCH_TOLERANCE_WITHOUT_STATED_ERROR = 1e-14
"""Relative difference from the wanted value at which the search ends if no error is stated.

It is some 50 times the relative round-off of a double.
"""


class TriedKeyValue(NamedTuple):
    """A value of the key that was tried, with the torque and peak pressure of the brake.

    Attributes
    ----------
    value : value of the key [SI]
    torque : torque of the brake [N m], on a plane its braking force [N]; nan without an answer
    peak_pressure : largest peak pressure of the shoes [Pa]; nan without an answer
    errors : stated relative errors of "torque" and "peak_pressure", 0 if not stated; empty without
        an answer
    failure : the reason why there is no answer; "" if there is one
    """

    value: float
    torque: float
    peak_pressure: float
    errors: Mapping[str, float]
    failure: str = ""


@dataclass(frozen=True)
class SizingQuestion:
    """The question which value of a key gives a brake a wanted torque or peak pressure.

    Attributes
    ----------
    brake : the brake, in which the key has the value of the brake file
    key : the key, written as for `vary`
    model : name of the model that solves the brakes
    options : options of the model
    torque : wanted torque [N m], WORD_FOR_LARGEST_TORQUE for the largest one, or None
    peak_pressure : wanted peak pressure [Pa], or its upper limit if a torque is wanted, or None
    low, high : ends of the range of the key [SI]; None for a range about the value of the file
    say : called with a line of text before each trial
    cache : store of condensed shoe bodies, so that a body is not condensed again in each trial
    trials : the trials that are solved already, by the value of the key
    last_model : the prepared model of the last solve in plane stress, by the value of the key; the
        exact slope of the torque is computed with it
    on_first_level : whether the brakes are solved in plane stress on the first level of elements
        only, without stated errors
    """

    brake: Brake
    key: str
    model: str
    options: Mapping[str, Any]
    torque: float | str | None
    peak_pressure: float | None
    low: float | None = None
    high: float | None = None
    say: Callable[[str], None] = lambda words: None
    cache: CacheOfCondensedBodies = field(default_factory=CacheOfCondensedBodies)
    trials: dict[float, TriedKeyValue] = field(default_factory=dict)
    last_model: dict[float, PreparedModel] = field(default_factory=dict)
    on_first_level: bool = False

    @cached_property
    def unit(self) -> str:
        """The SI unit of the key."""
        return si_unit_of_brake_key(self.brake, self.key) or ""

    @cached_property
    def value_of_file(self) -> float:
        """The value of the key in the brake file. Raises BadInput if it is no single number."""
        if set(map(type, values_of_brake_key(self.brake, self.key))) == {type(None)}:
            raise BadInput(f"{self.key}: has no value in the brake file to start from; write one")
        return numerical_value_of_brake_key(self.brake, self.key)

    @cached_property
    def does_key_keep_one_sign(self) -> bool:
        """Whether the key holds a length, force, modulus or number that keeps its sign."""
        return are_allowed_values_of_key_an_interval(self.brake, self.key)

    @cached_property
    def ends_of_key_range(self) -> tuple[float, float]:
        """The ends of the range of the key. Raises BadInput for a range without values."""
        value = self.value_of_file
        if self.unit == "rad":
            ends = (value - DEFAULT_HALF_RANGE_OF_ANGLE, value + DEFAULT_HALF_RANGE_OF_ANGLE)
        elif not self.does_key_keep_one_sign:
            reach = DEFAULT_HALF_RANGE_OF_COORDINATE_OVER_BRAKE_SIZE * self.brake.size
            ends = (value - reach, value + reach)
        else:
            first, second = sorted(
                (
                    value / DEFAULT_FACTOR_FROM_FILE_VALUE_TO_RANGE_END,
                    value * DEFAULT_FACTOR_FROM_FILE_VALUE_TO_RANGE_END,
                )
            )
            ends = (first, second)
        low = ends[0] if self.low is None else self.low
        high = ends[1] if self.high is None else self.high
        if not low < high:
            raise BadInput(
                f"--from = {self.key_value_as_text(low)}: must be less than "
                f"--to = {self.key_value_as_text(high)}"
            )
        return low, high

    def key_values_to_try_first(self) -> list[float]:
        """The values of the key that are tried first, ascending, with the value of the file.

        Lengths, forces and moduli are spaced by equal factors, other values by equal distances.
        """
        low, high = self.ends_of_key_range
        spaced = np.geomspace if self.does_key_keep_one_sign and low * high > 0 else np.linspace
        values = {float(x) for x in spaced(low, high, NUMBER_OF_KEY_VALUES_TRIED_FIRST)} | {
            low,
            high,
        }
        if low <= self.value_of_file <= high:
            values.add(self.value_of_file)
        return sorted(value for value in values if low <= value <= high)

    def key_value_as_text(self, value: float) -> str:
        """A value of the key as text with its unit, such as "12 mm"."""
        return quantity_with_usual_unit(value, self.unit)

    def torque_or_braking_force_as_text(self, torque: float) -> str:
        """A torque as text, such as "400 N m"; for a brake on a plane its braking force."""
        return quantity_with_usual_unit(torque, self.brake.surface.unit_of_torque_or_brake_force)

    def response_at_key_value(self, value: float) -> Response:
        """The response of the brake at a value of the key. Raises BadInput and NoAnswer."""
        self.say(f"sizing: {self.key} = {self.key_value_as_text(value)}")
        varied = vary(self.brake, {self.key: value})
        options = dict(self.options)
        if self.on_first_level:
            penalty = {name: options[name] for name in {"penalty"} & options.keys()}
            return solve_brake_on_first_level_without_error_estimate(
                varied, **penalty, cache=self.cache
            )
        if self.model in {"fem", "solid"}:
            options["cache"] = self.cache
        if self.model == "fem":

            def keep_model(scene: PreparedModel, _: Response) -> None:
                """Keep the prepared model of this solve in place of an earlier model."""
                self.last_model.clear()
                self.last_model[value] = scene

            options["use_model"] = keep_model
        return model_with_name_that_applies_to_brake(self.model, varied).solve(varied, **options)

    def solve_trial_at_key_value(self, value: float) -> TriedKeyValue:
        """Solve the brake with a value of the key; the trial has an answer or a `failure`.

        A value that has been solved already is not solved again.
        """
        if value not in self.trials:
            self.trials[value] = self._newly_solved_trial(value)
        return self.trials[value]

    def _newly_solved_trial(self, value: float) -> TriedKeyValue:
        """Solve the brake with a value of the key, as `solve_trial_at_key_value` does."""
        try:
            response = self.response_at_key_value(value)
        except (BadInput, NoAnswer) as error:
            return TriedKeyValue(value, math.nan, math.nan, {}, str(error))
        stated = response.error or {}
        peak = max(shoe.peak_pressure for shoe in response.shoes)
        errors = {"torque": stated.get("torque", 0.0), "peak_pressure": stated.get("peak", 0.0)}
        if self.on_first_level:
            errors["torque"] = TORQUE_ERROR_ASSUMED_ON_FIRST_LEVEL
        return TriedKeyValue(value, float(response.effect), float(peak), errors)


@dataclass(frozen=True)
class SizingResult:
    """The value of a key at which a brake has a wanted torque or peak pressure.

    Attributes
    ----------
    key : the key of the brake file
    unit : SI unit of the key
    value : the value [SI]
    value_of_file : the value of the brake file [SI]
    torque : torque [N m], on a plane braking force [N]
    peak_pressure : largest peak pressure of the shoes [Pa]
    slope : derivative of the wanted quantity by the key [SI], exact where it is known; None where
        the torque is largest, or where the values of the key next to it have no answer
    errors : error of the value [SI] that follows from the stated error of the finite elements
        ("elements") and of plane stress itself ("plane_stress"); unknown errors are left out
    range : ends of the range that was searched [SI]
    others : further values [SI] that give the wanted quantity, as far as the search has seen them
    remark : what bounds the largest torque; "" for other questions
    brake : the brake with the value
    response : response of the brake with the value, with its stated errors and notes
    """

    key: str
    unit: str
    value: float
    value_of_file: float
    torque: float
    peak_pressure: float
    slope: float | None
    errors: Mapping[str, float]
    range: tuple[float, float]
    others: tuple[float, ...]
    remark: str
    brake: Brake
    response: Response

    def __repr__(self) -> str:
        """The lines of `lines`, and the response as a table of text."""
        return "\n".join([*self.lines(), repr(self.response)])

    def as_dict(self) -> dict[str, Any]:
        """The answer as plain data for JSON, in SI, with the response to the found value."""
        data = {name: value for name, value in vars(self).items() if name != "brake"}
        return data | {
            "errors": dict(self.errors),
            "range": list(self.range),
            "others": list(self.others),
            "response": self.response.as_dict(),
        }

    def lines(self) -> list[str]:
        """Lines of text: the value, its errors, the range, and further values."""
        text, surface = quantity_with_usual_unit, self.brake.surface
        low, high = (text(end, self.unit) for end in self.range)
        lines = [
            f"{self.key} = {text(self.value, self.unit)} "
            f"({text(self.value_of_file, self.unit)} in the file): "
            f"{surface.word_for_torque_or_brake_force} "
            f"{text(self.torque, surface.unit_of_torque_or_brake_force)}, "
            f"peak pressure {text(self.peak_pressure, 'Pa')}"
        ]
        words = {"elements": "the finite elements", "plane_stress": "plane stress itself"}
        stated = []
        for name, error in self.errors.items():
            # An estimate has no more than two digits that mean something.
            stated.append(f"{text(float(f'{error:.2g}'), self.unit)} by {words[name]}")
        if stated:
            lines.append(f"error of this value: {', '.join(stated)}")
        others = f"; the same at {', '.join(text(x, self.unit) for x in self.others)}"
        lines.append(
            f"searched: {low} to {high}{others if self.others else ''}"
            f"{'; ' + self.remark if self.remark else ''}"
        )
        return lines


def size_brake(question: SizingQuestion, answer: Callable[[Brake], Response]) -> SizingResult:
    """Find the value of a key that gives a wanted torque or peak pressure.

    Parameters
    ----------
    question : the brake, the key and what is wanted
    answer : function that solves the brake with the value found, with all stated errors

    Raises
    ------
    BadInput
        for an unknown key, a key without a single number, a range without values, a wanted quantity
        that is not positive, or no wanted quantity
    NoAnswer
        if no value of the range gives what is wanted, with the reason and the range
    """
    _check_wanted_quantities(question)
    name = "peak_pressure" if question.torque is None else "torque"
    wanted = question.peak_pressure if question.torque is None else question.torque
    if not isinstance(wanted, str) and wanted is not None:
        near = _find_trial_with_wanted_value_near_file_value(question, name, wanted)
        if near is None and name == "torque":
            near = _find_only_trial_with_wanted_torque_from_first_level(question, wanted)
        if near is not None and _is_peak_pressure_allowed(question, near):
            return _sizing_result_of_found_value(question, near, (), answer)
    trials = _solve_first_trial_values(question)
    if question.torque == WORD_FOR_LARGEST_TORQUE:
        found, remark = _trial_with_largest_torque_and_what_bounds_it(question, trials)
        return _sizing_result_of_found_value(question, found, (), answer, remark)
    roots = _find_all_trials_with_wanted_quantity(question, trials, name)
    allowed = [root for root in roots if _is_peak_pressure_allowed(question, root)]
    if not allowed:
        raise NoAnswer(_text_on_peak_pressure_above_limit(question, trials, roots[0]))
    allowed.sort(key=lambda root: abs(root.value - question.value_of_file))
    others = tuple(sorted(root.value for root in allowed[1:]))
    return _sizing_result_of_found_value(question, allowed[0], others, answer)


def _check_wanted_quantities(question: SizingQuestion) -> None:
    """Raise BadInput unless a positive quantity is wanted and the key can be varied."""
    if question.torque is None and question.peak_pressure is None:
        raise BadInput("--torque, --peak-pressure: give at least one of both")
    wanted = {"--torque": question.torque, "--peak-pressure": question.peak_pressure}
    for option, value in wanted.items():
        if isinstance(value, float | int) and not 0 < value < math.inf:
            raise BadInput(f"{option} = {value:g}: must be greater than 0")
    if (
        question.value_of_file == 0
        and question.does_key_keep_one_sign
        and None
        in (
            question.low,
            question.high,
        )
    ):
        raise BadInput(f"{question.key} = 0: the range to search is missing; give --from and --to")
    # `vary` refuses a key that cannot change, such as a force that follows from a drive.
    vary(question.brake, {question.key: question.value_of_file})
    model_with_name_that_applies_to_brake(question.model, question.brake)


def _solve_first_trial_values(question: SizingQuestion) -> list[TriedKeyValue]:
    """Solve the brake at the values of the key that are tried first.

    Raises NoAnswer if there is no answer at any of them.
    """
    trials = [
        question.solve_trial_at_key_value(value) for value in question.key_values_to_try_first()
    ]
    if all(trial.failure for trial in trials):
        nearest = min(trials, key=lambda trial: abs(trial.value - question.value_of_file))
        raise NoAnswer(
            f"{_first_words_of_refusal_text(question)}, because no value of the range has an "
            "answer; "
            f"{question.key} = {question.key_value_as_text(nearest.value)}: {nearest.failure}"
        )
    return trials


def _find_all_trials_with_wanted_quantity(
    question: SizingQuestion, trials: list[TriedKeyValue], name: str
) -> list[TriedKeyValue]:
    """The trials at which the wanted quantity has its wanted value.

    The value is sought between the first trials. If it is not found, further trials are added: near
    the values of the key where answers end, then near the largest or smallest quantity.

    Parameters
    ----------
    question : the question
    trials : the trials up to now in growing order, to which further ones are added
    name : the wanted quantity, "torque" or "peak_pressure"

    Raises
    ------
    NoAnswer
        if the quantity does not have this value in the range
    """
    wanted = question.torque if name == "torque" else question.peak_pressure
    assert isinstance(wanted, float | int)
    searches: tuple[Callable[[], None], ...] = (
        lambda: None,
        lambda: _add_trials_at_limits_of_solvable_key_values(question, trials),
        lambda: _add_trial_with_largest_or_smallest_quantity(question, trials, name, wanted),
    )
    for search in searches:
        search()
        roots = list(_find_trials_at_crossings_of_wanted_value(question, trials, name, wanted))
        if roots:
            return roots
    raise NoAnswer(_text_on_value_out_of_reach(question, trials, name, wanted))


def _find_trials_at_crossings_of_wanted_value(
    question: SizingQuestion, trials: Sequence[TriedKeyValue], name: str, wanted: float
) -> Iterator[TriedKeyValue]:
    """Yield the trials at which a quantity crosses a wanted value."""
    for before, after in pairwise(trials):
        off = [getattr(trial, name) - wanted for trial in (before, after)]
        # A trial with exactly the wanted value ends one interval and begins the next. It is yielded
        # once, at the beginning of an interval.
        if off[0] == 0 or off[0] * off[1] < 0:
            yield _find_trial_with_wanted_value_between_two_trials(
                question, [before, after], name, wanted
            )
    if trials and getattr(trials[-1], name) == wanted:
        yield trials[-1]


def _quantity_minus_wanted_value(trial: TriedKeyValue, name: str, wanted: float) -> float:
    """A trial's quantity minus the wanted value; 0 if this is a small part of the stated error."""
    off = float(getattr(trial, name) - wanted)
    close = (
        max(
            SEARCH_TOLERANCE_WITHOUT_STATED_ERROR,
            SEARCH_TOLERANCE_OVER_STATED_ERROR * trial.errors.get(name, 0.0),
        )
        * wanted
    )
    return 0.0 if abs(off) <= close else off


def _find_trial_with_wanted_value_between_two_trials(
    question: SizingQuestion, known: list[TriedKeyValue], name: str, wanted: float
) -> TriedKeyValue:
    """The trial at which a quantity has a wanted value, between two trials that enclose it.

    The next value of the key comes from a rational function through the nearest trials, if it lies
    between the two trials that enclose the wanted value. Every third step halves the distance of
    these two instead, unless the last three steps have already more than halved it.

    Parameters
    ----------
    question : the question
    known : solved trials, two of which are on either side of the wanted value
    name, wanted : the quantity and its wanted value

    Raises
    ------
    NoAnswer
        if a brake between the two trials has no answer, or the quantity jumps over the wanted value
    """
    known = sorted(known, key=lambda trial: trial.value)
    steps, width = 0, math.inf
    while True:
        for trial in known:
            if _quantity_minus_wanted_value(trial, name, wanted) == 0:
                return trial
        low, high = _closest_trials_around_wanted_value(known, name, wanted)
        resolution = 2 * np.finfo(float).eps * max(abs(low.value), abs(high.value))
        if high.value - low.value <= resolution:
            return _nearer_of_two_almost_equal_trials(question, (low, high), name, wanted)
        value = _key_value_by_rational_interpolation(known, name, wanted)
        is_slow = steps % 3 == 2 and high.value - low.value > 0.5 * width
        if is_slow or value is None or not low.value < value < high.value:
            value = 0.5 * (low.value + high.value)
        if steps % 3 == 2:
            width = high.value - low.value
        steps += 1
        insort(
            known, _solve_trial_or_raise_no_answer(question, value), key=lambda trial: trial.value
        )


def _solve_trial_or_raise_no_answer(question: SizingQuestion, value: float) -> TriedKeyValue:
    """Solve the brake with a value of the key. Raises NoAnswer with the reason for no answer."""
    trial = question.solve_trial_at_key_value(value)
    if trial.failure:
        raise NoAnswer(
            f"{_first_words_of_refusal_text(question)}, because {question.key} = "
            f"{question.key_value_as_text(value)} "
            f"has no answer: {trial.failure}"
        )
    return trial


def _closest_trials_around_wanted_value(
    known: Sequence[TriedKeyValue], name: str, wanted: float
) -> tuple[TriedKeyValue, TriedKeyValue]:
    """The two neighbouring trials, in growing order, between which a quantity crosses `wanted`.

    If there are several pairs, the pair with the smallest distance is returned. Raises ValueError
    if there is no pair.
    """
    crossed = [
        (before, after)
        for before, after in pairwise(known)
        if (getattr(before, name) - wanted) * (getattr(after, name) - wanted) < 0
    ]
    return min(crossed, key=lambda pair: pair[1].value - pair[0].value)


def _nearer_of_two_almost_equal_trials(
    question: SizingQuestion, ends: tuple[TriedKeyValue, TriedKeyValue], name: str, wanted: float
) -> TriedKeyValue:
    """Of two trials whose keys differ only by round-off, the trial nearer to the wanted value.

    Raises NoAnswer if the quantity of this trial differs from the wanted value by more than its
    stated error and more than RELATIVE_DIFFERENCE_AT_DISCONTINUITY: then the quantity jumps between
    the two trials.
    """
    near = min(ends, key=lambda trial: abs(getattr(trial, name) - wanted))
    allowed = max(RELATIVE_DIFFERENCE_AT_DISCONTINUITY, near.errors.get(name, 0.0)) * wanted
    if abs(getattr(near, name) - wanted) <= allowed:
        return near
    what = (
        question.brake.surface.word_for_torque_or_brake_force
        if name == "torque"
        else "peak pressure"
    )
    unit = question.brake.surface.unit_of_torque_or_brake_force if name == "torque" else "Pa"
    from_to = [quantity_with_usual_unit(getattr(trial, name), unit) for trial in ends]
    raise NoAnswer(
        f"{_first_words_of_refusal_text(question)}, because the {what} jumps from {from_to[0]} to "
        f"{from_to[1]} "
        f"at {question.key_value_as_text(near.value)}"
    )


def _key_value_by_rational_interpolation(
    known: Sequence[TriedKeyValue], name: str, wanted: float
) -> float | None:
    """The value x of the key at which a rational function y(x) equals the wanted quantity.

    The function y = (a + b x)/(1 + c x) goes through the three trials whose quantities are nearest
    to the wanted one. It is exact for a torque that is proportional to a force, and for the torque
    of a short shoe, which grows without bound at self-locking. Two trials give a straight line. The
    result is None if the function has no such value.
    """
    nearest = sorted(known, key=lambda trial: abs(getattr(trial, name) - wanted))[:3]
    x = np.array([trial.value for trial in nearest])
    off = np.array([getattr(trial, name) - wanted for trial in nearest])
    x0, off0 = x[0], off[0]
    with np.errstate(all="ignore"):
        slopes = (off[1:] - off0) / (x[1:] - x0)
        if len(slopes) == 1:
            step = -off0 / slopes[0]
        else:
            # The slope (y - y0)/(x - x0) = (b - c y)/(1 + c x0) is linear in y. Here y is the
            # difference from the wanted quantity, which is 0 at the value that is returned.
            per_off = (slopes[1] - slopes[0]) / (off[2] - off[1])
            step = -off0 / (slopes[0] - per_off * off[1])
    return float(x0 + step) if np.isfinite(step) else None


def _find_trial_with_wanted_value_near_file_value(
    question: SizingQuestion, name: str, wanted: float
) -> TriedKeyValue | None:
    """The trial with the wanted value of a quantity, by a search that starts at the file's value.

    The result is None if this search does not find the wanted value: then the whole range must be
    searched. It is also None for angles and coordinates, because the torque often has the same
    value at two angles or coordinates.
    """
    (low, high), start = question.ends_of_key_range, question.value_of_file
    if start == 0 or not (question.does_key_keep_one_sign and low <= start <= high):
        return None
    first = question.solve_trial_at_key_value(start)
    known = (
        []
        if first.failure
        else _solve_trials_until_wanted_value_is_enclosed(question, first, name, wanted)
    )
    if not known:
        return None
    with suppress(NoAnswer):
        return _find_trial_with_wanted_value_between_two_trials(question, known, name, wanted)
    return None


def _find_only_trial_with_wanted_torque_from_first_level(
    question: SizingQuestion, wanted: float
) -> TriedKeyValue | None:
    """The only trial with the wanted torque, by a search on the first level of elements.

    The range of the key is tried on the first level. If the torque rises or falls throughout this
    range and crosses the wanted torque, the value there is corrected on all levels by Newton's
    method, with the exact slope of the torque, and by rational functions. The result is None if
    this fails, and if the elements of the first level could decide what is found: then the whole
    range must be searched on all levels.
    """
    has_mesh_file = any(shoe.mesh for shoe in question.brake.shoes)
    if question.model != "fem" or question.does_key_keep_one_sign:
        return None
    if has_mesh_file or not set(question.options) <= {"penalty"}:
        return None
    coarse = replace(question, on_first_level=True, trials={}, last_model={})
    try:
        trials = _solve_first_trial_values(coarse)
        if not _does_torque_cross_wanted_torque_once(trials, wanted):
            return None
        (root,) = _find_trials_at_crossings_of_wanted_value(coarse, trials, "torque", wanted)
    except NoAnswer:
        return None
    return _find_trial_on_all_levels_near_key_value(question, root.value, wanted)


def _does_torque_cross_wanted_torque_once(trials: Sequence[TriedKeyValue], wanted: float) -> bool:
    """Whether the torque rises or falls throughout, and crosses the wanted torque between trials.

    No torque may lie within TORQUE_ERROR_ASSUMED_ON_FIRST_LEVEL of the wanted torque, and no trial
    may lack an answer.
    """
    if any(trial.failure for trial in trials):
        return False
    torques = np.array([trial.torque for trial in trials])
    rises = np.diff(torques)
    is_monotonic = bool((rises > 0).all() or (rises < 0).all())
    is_apart = (np.abs(torques - wanted) > TORQUE_ERROR_ASSUMED_ON_FIRST_LEVEL * wanted).all()
    return is_monotonic and bool(is_apart) and bool(torques.min() < wanted < torques.max())


def _find_trial_on_all_levels_near_key_value(
    question: SizingQuestion, value: float, wanted: float
) -> TriedKeyValue | None:
    """The trial with the wanted torque near a value of the key; None if it is not found."""
    known: list[TriedKeyValue] = []
    low, high = question.ends_of_key_range
    for _ in range(MOST_TRIALS_AFTER_SEARCH_ON_FIRST_LEVEL):
        trial = question.solve_trial_at_key_value(value)
        if trial.failure:
            return None
        off = _quantity_minus_wanted_value(trial, "torque", wanted)
        if off == 0:
            return trial
        known.append(trial)
        if len(known) == 1:
            slope = _exact_torque_slope_at_key_value(question, value, "torque")
            after = value - off / slope if slope else None
        else:
            after = _key_value_by_rational_interpolation(known, "torque", wanted)
        if after is None or not low < after < high:
            return None
        value = after
    return None


def _solve_trials_until_wanted_value_is_enclosed(
    question: SizingQuestion, first: TriedKeyValue, name: str, wanted: float
) -> list[TriedKeyValue]:
    """Solved trials, beginning with `first`, of which two enclose the wanted value or one has it.

    The list is empty if there are no such trials after MOST_TRIALS_TO_ENCLOSE_WANTED_VALUE trials
    in the range.
    """
    known, (low, high) = [first], question.ends_of_key_range
    slope = _exact_torque_slope_at_key_value(question, first.value, name)
    value: float | None = _key_value_to_try_after_first_trial(first, name, wanted, slope)
    for _ in range(MOST_TRIALS_TO_ENCLOSE_WANTED_VALUE):
        if _is_wanted_value_enclosed(known, name, wanted):
            return known
        value = None if value is None else min(max(value, low), high)
        if value is None or any(value == trial.value for trial in known):
            break
        trial = question.solve_trial_at_key_value(value)
        if trial.failure:
            # There is no answer at this value. The next value is half-way to the nearest solved
            # trial, and the range ends here.
            nearest = min(known, key=lambda one: abs(one.value - trial.value))
            low, high = (low, value) if value > nearest.value else (value, high)
            value = 0.5 * (nearest.value + value)
        else:
            insort(known, trial, key=lambda one: one.value)
            value = _key_value_by_rational_interpolation(known, name, wanted)
    return []


def _is_wanted_value_enclosed(known: Sequence[TriedKeyValue], name: str, wanted: float) -> bool:
    """Whether two of the solved trials enclose the wanted value of a quantity, or one has it."""
    off = [_quantity_minus_wanted_value(trial, name, wanted) for trial in known]
    return min(off) <= 0 <= max(off)


def _key_value_to_try_after_first_trial(
    trial: TriedKeyValue, name: str, wanted: float, slope: float | None
) -> float:
    """The second value of the key to try: from the slope of the quantity, or by proportion.

    `slope` is the derivative of the quantity by the key, or None. It is not used if its value of
    the key has another sign than the proportional value, or differs from the proportional value by
    more than the factor DEFAULT_FACTOR_FROM_FILE_VALUE_TO_RANGE_END.
    """
    quantity = float(getattr(trial, name))
    proportional = (
        trial.value * wanted / quantity
        if quantity > 0
        else DEFAULT_FACTOR_FROM_FILE_VALUE_TO_RANGE_END * trial.value
    )
    if not slope:
        return proportional
    value = trial.value + (wanted - quantity) / slope
    is_near = (
        1 / DEFAULT_FACTOR_FROM_FILE_VALUE_TO_RANGE_END
        < value / proportional
        < DEFAULT_FACTOR_FROM_FILE_VALUE_TO_RANGE_END
    )
    return value if is_near else proportional


def _exact_torque_slope_at_key_value(
    question: SizingQuestion, value: float, name: str
) -> float | None:
    """The exact derivative of the torque by the key at a value of the key; None if unknown.

    Finite elements in plane stress give it for friction, forces, moduli, clearances and hinges.
    """
    plain = {"elements", "kind", "penalty", "tolerance"}
    if question.model != "fem" or name != "torque" or not set(question.options) <= plain:
        return None
    brake = vary(question.brake, {question.key: value})
    on_mesh = {
        name: question.options[name] for name in ("elements", "kind") & question.options.keys()
    }
    stiffness = {name: question.options[name] for name in {"penalty"} & question.options.keys()}
    try:
        model = question.last_model.get(value) or prepared_model_with_finest_elements(
            brake, **on_mesh, cache=question.cache
        )
        wanted = slopes_wanted_for_key(brake, question.key)
        slopes = compute_torque_sensitivity(model, brake, **stiffness, wanted=wanted)
    except (BadInput, NoAnswer):
        return None
    return exact_torque_slope_by_key(brake, question.key, slopes)


def _add_trials_at_limits_of_solvable_key_values(
    question: SizingQuestion, trials: list[TriedKeyValue]
) -> None:
    """Find by bisection the values of the key at which answers end; add the trials to `trials`."""
    for before, after in list(pairwise(trials)):
        if bool(before.failure) == bool(after.failure):
            continue
        low, high = before.value, after.value
        for _ in range(BISECTIONS_TO_LIMIT_OF_SOLVABLE_KEY_VALUES):
            middle = question.solve_trial_at_key_value(0.5 * (low + high))
            insort(trials, middle, key=lambda trial: trial.value)
            if bool(middle.failure) == bool(before.failure):
                low = middle.value
            else:
                high = middle.value


def _add_trial_with_largest_or_smallest_quantity(
    question: SizingQuestion, trials: list[TriedKeyValue], name: str, wanted: float
) -> None:
    """Add a trial at the maximum or minimum of the quantity, sought between two solved trials.

    The maximum is sought if all trials are below the wanted value, else the minimum. The two trials
    are the neighbours of the trial with the largest (or smallest) quantity so far. If one of these
    neighbours has no answer, nothing is added.
    """
    solved = [trial for trial in trials if not trial.failure]
    sign = 1 if all(getattr(trial, name) < wanted for trial in solved) else -1
    best = max(solved, key=lambda trial: sign * getattr(trial, name))
    at = trials.index(best)
    if not 0 < at < len(trials) - 1:
        return
    ends = trials[at - 1], trials[at + 1]
    if not any(end.failure for end in ends):
        refined = _trial_with_largest_or_smallest_quantity_in_range(
            question, (ends[0].value, ends[1].value), name, sign
        )
        if not refined.failure:
            insort(trials, refined, key=lambda trial: trial.value)


def _trial_with_largest_or_smallest_quantity_in_range(
    question: SizingQuestion, ends: tuple[float, float], name: str, sign: int
) -> TriedKeyValue:
    """The trial between two values of the key with the largest (sign 1) or smallest quantity."""
    seen: list[TriedKeyValue] = []

    def signed_quantity_or_infinity_without_answer(value: float) -> float:
        """The quantity times -sign, whose minimum is sought; infinite if there is no answer."""
        seen.append(question.solve_trial_at_key_value(float(value)))
        return math.inf if seen[-1].failure else -sign * float(getattr(seen[-1], name))

    resolution = KEY_TOLERANCE_AT_EXTREME_QUANTITY * (ends[1] - ends[0])
    minimize_scalar(
        signed_quantity_or_infinity_without_answer,
        bounds=ends,
        method="bounded",
        options={"xatol": resolution},
    )
    solved = [trial for trial in seen if not trial.failure]
    return max(solved or seen, key=lambda trial: sign * getattr(trial, name))


def _trial_with_largest_torque_and_what_bounds_it(
    question: SizingQuestion, trials: list[TriedKeyValue]
) -> tuple[TriedKeyValue, str]:
    """The trial with the largest torque at an allowed peak pressure, and a text on what bounds it.

    Raises NoAnswer if the peak pressure is above its limit in the whole range.
    """
    _add_trials_at_limits_of_solvable_key_values(question, trials)
    limit, bounded = question.peak_pressure, []
    if limit is not None:
        bounded = list(
            _find_trials_at_crossings_of_wanted_value(question, trials, "peak_pressure", limit)
        )
    solved = [trial for trial in trials if not trial.failure]
    allowed = [trial for trial in solved if _is_peak_pressure_allowed(question, trial)] + bounded
    if not allowed:
        raise NoAnswer(_text_on_value_out_of_reach(question, trials, "peak_pressure", limit or 0.0))
    best = max(allowed, key=lambda trial: trial.torque)
    if best in bounded:
        return best, "the peak pressure bounds the torque"
    at = trials.index(best)
    if not 0 < at < len(trials) - 1:
        return best, "the torque is largest at the end of the range"
    failure = trials[at - 1].failure or trials[at + 1].failure
    if failure:
        return best, f"the torque is largest before there is no answer: {failure}"
    refined = _trial_with_largest_or_smallest_quantity_in_range(
        question, (trials[at - 1].value, trials[at + 1].value), "torque", 1
    )
    if refined.torque > best.torque and _is_peak_pressure_allowed(question, refined):
        best = refined
    return best, "the torque is largest inside the range"


def _is_peak_pressure_allowed(question: SizingQuestion, trial: TriedKeyValue) -> bool:
    """Whether the peak pressure of a trial is within its limit; True if there is no limit."""
    limit = question.peak_pressure
    if limit is None or question.torque is None:
        return True
    return trial.peak_pressure <= limit * (
        1 + SEARCH_TOLERANCE_OVER_STATED_ERROR * trial.errors["peak_pressure"]
    )


def _sizing_result_of_found_value(
    question: SizingQuestion,
    found: TriedKeyValue,
    others: tuple[float, ...],
    answer: Callable[[Brake], Response],
    remark: str = "",
) -> SizingResult:
    """The answer to a question: the value, the response of its brake, and the errors of the value.

    Parameters
    ----------
    question, answer : parameters of `size_brake`
    found : the trial with the value
    others : further values that give the wanted quantity
    remark : what bounds the largest torque
    """
    brake = vary(question.brake, {question.key: found.value})
    response = answer(brake)
    by_pressure = question.torque is None or remark == "the peak pressure bounds the torque"
    name = "peak_pressure" if by_pressure else "torque"
    slope = None
    if not remark or by_pressure:
        slope = _derivative_of_quantity_by_key_at_trial(question, found, name)
    return SizingResult(
        key=question.key,
        unit=question.unit,
        value=found.value,
        value_of_file=question.value_of_file,
        torque=float(response.effect),
        peak_pressure=float(max(shoe.peak_pressure for shoe in response.shoes)),
        slope=slope,
        errors=_errors_of_found_key_value(response, name, getattr(found, name), slope),
        range=question.ends_of_key_range,
        others=others,
        remark=remark,
        brake=brake,
        response=response,
    )


def _derivative_of_quantity_by_key_at_trial(
    question: SizingQuestion, found: TriedKeyValue, name: str
) -> float | None:
    """The derivative of a quantity by the key: exact if it is known, else a difference quotient.

    It is None if the brake has no answer at the neighbouring values of the key.
    """
    exact = _exact_torque_slope_at_key_value(question, found.value, name)
    if exact is not None:
        return exact
    low, high = question.ends_of_key_range
    size = abs(found.value) if question.does_key_keep_one_sign else high - low
    steps = (
        RELATIVE_KEY_STEP_OF_DIFFERENCE_QUOTIENT * size,
        -RELATIVE_KEY_STEP_OF_DIFFERENCE_QUOTIENT * size,
    )
    near = [question.solve_trial_at_key_value(found.value + step) for step in steps]
    solved = [trial for trial in near if not trial.failure] + [found]
    first, last = solved[0], solved[1] if len(solved) > 1 else found
    if first.value == last.value:
        return None
    rise = float(getattr(first, name) - getattr(last, name))
    return rise / (first.value - last.value)


def _errors_of_found_key_value(
    response: Response, name: str, quantity: float, slope: float | None
) -> dict[str, float]:
    """The errors of a value of the key [SI]: errors of a quantity divided by its slope.

    Parameters
    ----------
    response : the response with the stated errors
    name : the quantity, "torque" or "peak_pressure"
    quantity : value of the quantity
    slope : slope of the quantity by the key; None if it is not known
    """
    if not slope:
        return {}
    of_elements = (response.error or {}).get("torque" if name == "torque" else "peak")
    of_model = None
    if name == "torque" and response.plane_stress_error is not None:
        of_model = response.plane_stress_error.brake.get("torque")
    stated = {"elements": of_elements, "plane_stress": of_model}
    return {
        key: abs(error * quantity / slope) for key, error in stated.items() if error is not None
    }


# The functions below write the messages of NoAnswer.


def _first_words_of_refusal_text(question: SizingQuestion) -> str:
    """The first words of a refusal: what is wanted, and the range that was searched."""
    wanted = []
    if question.torque is not None:
        torque = question.torque
        shown = (
            torque if isinstance(torque, str) else question.torque_or_braking_force_as_text(torque)
        )
        wanted.append(f"--torque = {shown}")
    if question.peak_pressure is not None:
        wanted.append(f"--peak-pressure = {quantity_with_usual_unit(question.peak_pressure, 'Pa')}")
    low, high = map(question.key_value_as_text, question.ends_of_key_range)
    return f"{', '.join(wanted)}: not possible with {question.key} from {low} to {high}"


def _text_on_value_out_of_reach(
    question: SizingQuestion, trials: Sequence[TriedKeyValue], name: str, wanted: float
) -> str:
    """The text that says why a quantity does not reach its wanted value in the range."""
    solved = [trial for trial in trials if not trial.failure]
    below = all(getattr(trial, name) < wanted for trial in solved)
    best = (max if below else min)(solved, key=lambda trial: getattr(trial, name))
    what, extreme = name.replace("_", " "), "largest" if below else "smallest"
    if name == "torque":
        what = question.brake.surface.word_for_torque_or_brake_force
    unit = "Pa" if name == "peak_pressure" else question.brake.surface.unit_of_torque_or_brake_force
    reached = quantity_with_usual_unit(getattr(best, name), unit)
    text = (
        f"{_first_words_of_refusal_text(question)}, because the {extreme} {what} is {reached}, "
        f"at {question.key_value_as_text(best.value)}"
    )
    at = trials.index(best)
    if not 0 < at < len(trials) - 1:
        return f"{text}, the end of the range"
    failure = trials[at - 1].failure or trials[at + 1].failure
    if failure:
        return f"{text}; beyond it there is no answer: {failure}"
    return f"{text}, inside the range: the {what} is not monotonic"


def _text_on_peak_pressure_above_limit(
    question: SizingQuestion, trials: list[TriedKeyValue], root: TriedKeyValue
) -> str:
    """The refusal of a torque at which the peak pressure is above its limit.

    It names the largest torque with an allowed peak pressure, if there is one.
    """
    peak = quantity_with_usual_unit(root.peak_pressure, "Pa")
    text = (
        f"{_first_words_of_refusal_text(question)}, because {question.key} = "
        f"{question.key_value_as_text(root.value)}, "
        f"which gives this torque, gives a peak pressure of {peak}"
    )
    try:
        best, _ = _trial_with_largest_torque_and_what_bounds_it(question, trials)
    except NoAnswer:
        return text
    return (
        f"{text}; the largest {question.brake.surface.word_for_torque_or_brake_force} within "
        f"the limit is "
        f"{question.torque_or_braking_force_as_text(best.torque)}, "
        f"at {question.key_value_as_text(best.value)}"
    )
