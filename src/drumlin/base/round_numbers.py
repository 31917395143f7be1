"""Round numbers, for the scales of figures: 1, 2 or 5 times a power of ten."""

import math


def four_round_numbers_around_value(value: float) -> tuple[float, ...]:
    """Four round numbers around a positive `value`, in growing order.

    The numbers are 1, 2, 5 and 10 times the largest power of ten that is not above the value.
    """
    power = 10.0 ** math.floor(math.log10(value))
    return tuple(digit * power for digit in (1, 2, 5, 10))


def largest_round_number_not_above_value(value: float) -> float:
    """The largest round number that is not above a positive `value`, up to round-off."""
    slack = value * (1 + 1e-9)
    return max(number for number in four_round_numbers_around_value(value) if number <= slack)
