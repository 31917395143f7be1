"""Reading a sweep file: extremes judge many values where they suffice, else with progress."""

import io
import random

import pytest

from conftest import ROOT, STUDY, partly
from drumlin.base.errors import BadInput
from drumlin.brake.fields import PartOfInputFile
from drumlin.brake.file import (
    are_allowed_values_of_key_an_interval,
    si_unit_of_brake_key,
    values_of_brake_key,
    vary,
)
from drumlin.cli import terminal
from drumlin.sweeps import file as sweep_file
from drumlin.sweeps.file import sweep_from_file_data
from drumlin_studies.random_brake import draw_random_brake
from drumlin_studies.random_kinds import draw_random_brake_of_support_kind

BRAKE = str(STUDY / "brake.toml")


def sweep(vary_, done=lambda judged, of: None, **more):
    return sweep_from_file_data(
        {"brake": BRAKE, "model": {"sine": {}}, "vary": vary_} | more, done=done
    )


@pytest.fixture
def judged(monkeypatch):
    """The changes that are judged, as they come."""
    found = []

    def counted(brake, changes):
        found.append(changes)
        return vary(brake, changes)

    monkeypatch.setattr(sweep_file, "vary", counted)
    return found


MANY = 19_600
RANGES = {
    "friction": {"from": 0.1, "to": 0.6, "count": MANY},
    "clearance": {"from": "-0.1 mm", "to": "0.5 mm", "count": MANY},
}


@pytest.mark.parametrize(
    ("vary_", "more"),
    [
        ({"friction": RANGES["friction"]}, {}),
        ({"shoe.lining.clearance": RANGES["clearance"]}, {}),
        ({"friction": {"distribution": "uniform", "from": 0.1, "to": 0.6}}, {"cases": MANY}),
        (
            {
                "friction": RANGES["friction"] | {"count": 140},
                "shoe.lining.clearance": RANGES["clearance"] | {"count": 140},
            },
            {},
        ),
    ],
    ids=["friction", "clearance", "draws", "grid"],
)
def test_many_thousand_numbers_are_judged_by_a_few(judged, vary_, more):
    assert len(sweep(vary_, **more).cases) == MANY
    assert len(judged) < 12


def numbers(part, prefix=""):
    """The keys of all numbers of a brake, as `vary` takes them."""
    for name, field in type(part).model_fields.items():
        value = getattr(part, name)
        key = f"{prefix}{field.alias or name}"
        if isinstance(value, float):
            yield key
        for i, below in enumerate(value if isinstance(value, tuple) else [value]):
            if isinstance(below, PartOfInputFile):
                yield from numbers(below, f"{key}[{i}]." if isinstance(value, tuple) else f"{key}.")


def taken(brake, key, value):
    try:
        vary(brake, {key: value})
    except BadInput:
        return False
    return True


@pytest.mark.parametrize("seed", partly(range(60), range(6)))
def test_what_lies_between_two_numbers_of_one_sign_that_a_brake_takes_is_taken(seed):
    """Of every key that is said to be an interval, on brakes of all kinds."""
    rng = random.Random(seed)
    brake = draw_random_brake(seed) if seed % 2 else draw_random_brake_of_support_kind(seed)
    keys = [key for key in numbers(brake) if are_allowed_values_of_key_an_interval(brake, key)]
    assert len(keys) > 5
    for key in keys:
        own = abs(values_of_brake_key(brake, key)[0]) or 1e-4
        for sign in (-1.0, 1.0):
            tried = [sign * own * 10 ** rng.uniform(-1.5, 1.5) for _ in range(4)] + [
                sign * own,
                sign * own * 1.001,
            ]
            sound = [value for value in tried if taken(brake, key, value)]
            if sound:
                low, high = min(sound), max(sound)
                between = [low + (high - low) * u for u in (0.01, 0.1, 0.3, 0.6, 0.9)]
                between += [sign * abs(low) ** (1 - u) * abs(high) ** u for u in (0.3, 0.6)]
                assert all(taken(brake, key, value) for value in between), key


def test_angles_and_coordinates_are_judged_one_by_one(judged, brake):
    assert not are_allowed_values_of_key_an_interval(
        brake, "shoe.lining.start"
    ) and not are_allowed_values_of_key_an_interval(brake, "shoe[0].hinge.x")
    assert si_unit_of_brake_key(brake, "shoe.lining.start") == "rad"
    told = []
    sweep(
        {"shoe.actuation.direction": {"from": "0 deg", "to": "180 deg", "count": 1000}},
        lambda *numbers: told.append(numbers),
    )
    assert len(judged) > 1000
    assert told[0] == (0, 1000) and len(told) > 2 and told == sorted(told)


@pytest.mark.parametrize("place", [0, 499, 500, 999])
@pytest.mark.parametrize(
    ("key", "good", "bad", "said"),
    [
        ("friction", [0.2 + i * 1e-4 for i in range(1000)], -0.1, "friction = -0.1: "),
        (
            "shoe.lining.thickness",
            [f"{5 + i * 1e-3} mm" for i in range(1000)],
            "-1 mm",
            "thickness = -1 mm: ",
        ),
        (
            "shoe[0].lining.start",
            [f"{130 + i * 1e-3} deg" for i in range(1000)],
            "300 deg",
            "must be greater than",
        ),
        (
            "shoe.lining.clearance",
            ["0 mm", [["130 deg", "0 mm"], ["180 deg", "1 mm"]]] * 500,
            [["1 deg", "0 mm"]],
            "needs at least two rows",
        ),
    ],
)
def test_one_bad_value_of_a_thousand_is_refused_with_its_key(place, key, good, bad, said):
    values = [*good[:place], bad, *good[place + 1 :]]
    with pytest.raises(BadInput, match=said):
        sweep({key: values})


def test_a_number_that_is_bad_near_nothing_is_found_between_both_signs():
    """A pad's face ground to a circle: any radius either way, but not a small one."""
    data = {"brake": str(ROOT / "studies" / "brakes" / "rail_clamp.toml"), "model": {"fem": {}}}
    key = {"shoe.lining.misfit.radius": {"from": "-9 m", "to": "9 m", "count": 6}}
    assert len(sweep_from_file_data(data | {"vary": key}).cases) == 6
    key["shoe.lining.misfit.radius"]["count"] = 6001
    with pytest.raises(BadInput, match=r"misfit.radius = .*: must be at least .* either way"):
        sweep_from_file_data(data | {"vary": key})


def test_many_values_that_fit_only_together_are_taken_and_judged_once(judged):
    count = 400
    long = {"from": "60 deg", "to": "70 deg", "count": count}
    keys = {
        "shoe[0].lining.end": long,
        "shoe[0].body.end": {"from": "71 deg", "to": "75 deg", "count": count},
    }
    assert len(sweep(keys, combine="zip").cases) == count
    assert len(judged) <= 4 * count + 1
    keys["shoe[0].body.end"]["from"] = "1 deg"
    with pytest.raises(BadInput, match="must lie within the body"):
        sweep(keys, combine="zip")


def test_in_a_grid_a_value_is_judged_with_the_first_case_that_has_it(judged):
    keys = {
        "friction": [0.1, 0.2],
        "shoe[0].lining.end": ["40 deg", "70 deg"],
        "shoe[0].body.end": ["75 deg", "76 deg"],
    }
    cases = sweep(keys).cases
    first = next(case.changes for case in cases if case.changes["shoe[0].lining.end"] > 1.2)
    assert [one for one in judged if len(one) == 3] == [first]


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.parametrize(("long", "shown"), ((100.0, False), (0.0, True)))
def test_what_takes_long_shows_a_bar_and_what_does_not_shows_none(long, shown, monkeypatch):
    monkeypatch.setattr(terminal, "SECONDS_BEFORE_PROGRESS_BAR", long)
    monkeypatch.setattr("sys.stderr", Terminal())
    with terminal.show_progress_bar_if_long("reading sweep.toml") as done:
        for judged in range(4):
            done(judged, 4)
    assert ("reading sweep.toml" in terminal.sys.stderr.getvalue()) is shown
