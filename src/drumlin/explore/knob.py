"""A slider of the page (class `BrakeSlider`), and what several kinds of sliders need."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from drumlin.base.round_numbers import four_round_numbers_around_value
from drumlin.brake.brake import Brake
from drumlin.brake.components import Lining

NewValuesByBrakeFileKey = dict[str, Any]
"""New values of a brake file by their keys, such as {"friction": 0.3}; `vary` takes them."""


SIGNIFICANT_DIGITS_OF_SLIDER_VALUE = 9
"""Significant digits of a number that a slider sets.

More digits would hold the rounding of additions and units, such as 0.34000000000000002, and a saved
brake file would show them. Fewer digits would change the torque in the digits that the page shows.
"""


def value_with_all_numbers_rounded(value: Any) -> Any:
    """The value with all numbers in it rounded for a slider; texts stay as they are."""
    if isinstance(value, float):
        return float(f"{value:.{SIGNIFICANT_DIGITS_OF_SLIDER_VALUE}g}")
    if isinstance(value, dict):
        return {key: value_with_all_numbers_rounded(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [value_with_all_numbers_rounded(item) for item in value]
    return value


def rounded_brake_file_text_of_angle(angle: float) -> str:
    """An angle [rad] as a brake file writes it, in rounded degrees such as "10 deg"."""
    return f"{math.degrees(angle):.{SIGNIFICANT_DIGITS_OF_SLIDER_VALUE}g} deg"


class BrakeSlider(NamedTuple):
    """A slider of the page, which changes one quantity of the brake.

    Attributes
    ----------
    name : name of the slider in the link
    label : text beside the slider on the page
    unit : unit of the slider's values
    low, high : ends of the slider's range [unit]
    step : smallest change of the value [unit]
    start : value of the brake file [unit]
    changes : function that turns a value [unit] into new values of the brake file by key
    log : whether equal distances on the slider change the value by equal factors
    """

    name: str
    label: str
    unit: str
    low: float
    high: float
    step: float
    start: float
    changes: Callable[[float], NewValuesByBrakeFileKey]
    log: bool = False

    @property
    def title(self) -> str:
        """The label of the slider, followed by its unit in brackets."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label

    def nearest_value_in_range(self, value: float) -> float:
        """The value within the slider's range that is nearest to `value` [unit of the slider]."""
        return min(max(value, self.low), self.high)


def nearest_1_2_or_5_times_power_of_ten(value: float) -> float:
    """The number nearest to `value` (in ratio) that is 1, 2 or 5 times a power of ten."""
    return min(
        four_round_numbers_around_value(value), key=lambda number: abs(math.log(value / number))
    )


def linings_by_brake_file_key(brake: Brake) -> dict[str, Lining]:
    """The linings of all shoes by their key in the brake file, such as "shoe[0].lining[1]"."""
    linings: dict[str, Lining] = {}
    for i, shoe in enumerate(brake.shoes):
        parts = shoe.lining.linings
        for k, part in enumerate(parts):
            number = f"[{k}]" if len(parts) > 1 else ""
            linings[f"shoe[{i}].lining{number}"] = part
    return linings
