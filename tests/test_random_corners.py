"""Random brakes that press with a corner of a lining alone, or under a tip of the gap."""

import math

import pytest

import drumlin
from conftest import partly
from drumlin_studies.random_corners import (
    RANGE_OF_SHORT_CONTACT_LENGTH,
    WAYS_TO_DRAW_BRAKES_BY_CORNER_KIND,
    draw_random_brake_pressing_with_corner_or_kink,
    is_kink_towards_drum_in_contact,
    is_lining_corner_in_contact,
)

FIRST = 400_000


@pytest.mark.parametrize("number", partly([0, 1, 5, 6, 9], {1, 6}))
@pytest.mark.slow
def test_a_seed_gives_a_brake_that_presses_as_its_kind_says(number):
    """With a corner or under a tip, and on no more of the lining than some degrees."""
    kind = list(WAYS_TO_DRAW_BRAKES_BY_CORNER_KIND)[number]
    brake = draw_random_brake_pressing_with_corner_or_kink(FIRST + number)
    assert brake == draw_random_brake_pressing_with_corner_or_kink(FIRST + number, kind)
    found = drumlin.solve(brake)
    pairs = list(zip(brake.shoes, found.shoes, strict=True))
    presses = {
        "corner": is_lining_corner_in_contact,
        "tip": is_kink_towards_drum_in_contact,
        "table": lambda *pair: (
            is_lining_corner_in_contact(*pair) or is_kink_towards_drum_in_contact(*pair)
        ),
    }
    assert any(presses[WAYS_TO_DRAW_BRAKES_BY_CORNER_KIND[kind].presses](*pair) for pair in pairs)
    for shoe in found.shoes:
        assert math.fsum(b - a for a, b in shoe.contact_arcs) < math.radians(12)


def test_short_contacts_are_in_the_zones_that_other_brakes_leave_out():
    assert RANGE_OF_SHORT_CONTACT_LENGTH[1] <= 4 * math.radians(0.2)
