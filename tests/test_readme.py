"""The numbers that README quotes are those of the reports that are kept."""

import csv
import re

import pytest

from conftest import ROOT

README = re.sub(r"\s+", " ", (ROOT / "README.md").read_text())


def rows(report, **chosen):
    with (ROOT / "reports" / "reference" / report).open() as file:
        return [row for row in csv.DictReader(file) if all(row[key] == value for key, value in chosen.items())]


def quoted(pattern):
    """The numbers in README that a pattern catches."""
    found = re.findall(pattern, README)
    assert len(found) == 1, pattern
    return [float(number) for number in (found[0] if isinstance(found[0], tuple) else found)]


def digits(said, value):
    """What is said, as a number of the same digits: half a unit of its last one is allowed."""
    unit = 10.0 ** -len(f"{said:g}".partition(".")[2])
    assert abs(said - value) <= 0.5 * unit * (1 + 1e-9), (said, value)


def test_law_against_elements():
    made = rows("double_shoe/results.csv", rotation="counter-clockwise")
    sine = [row for row in made if row["model"] == "sine"]
    stiff = {row["shoe"]: row for row in sine if row["case"] == "stiff shoes"}
    low, high, low_too, peak, flexible, seconds = quoted(
        r"total torque is ([\d.]+) % low, its torque of the single shoes ([\d.]+) % high and ([\d.]+) % low, its peak "
        r"pressure up to ([\d.]+) % low; with flexible shoes the total is ([\d.]+) % low\. The whole elastic brake is "
        r"solved in ([\d.]+) s"
    )
    digits(low, -100 * float(stiff["all"]["torque_error"]))
    digits(high, 100 * max(float(stiff[shoe]["torque_error"]) for shoe in ("right", "left")))
    digits(low_too, -100 * min(float(stiff[shoe]["torque_error"]) for shoe in ("right", "left")))
    digits(peak, -100 * min(float(stiff[shoe]["peak_error"]) for shoe in ("right", "left")))
    total = next(row for row in sine if (row["case"], row["shoe"]) == ("flexible shoes", "all"))
    digits(flexible, -100 * float(total["torque_error"]))
    spent = [float(row["seconds"]) for row in made if row["model"] == "fem" and row["shoe"] == "all"]
    assert len(spent) == 2
    for one in spent:
        digits(seconds, one)


def test_error_against_run_time():
    file, brake = "error_vs_runtime/results.csv", "double_shoe/brake"
    law = rows(file, brake=brake, method="sine")[0]
    off, ms, known = quoted(
        r"sine law takes a millisecond and is ([\d.]+) % off .*?; ([\d.]+) ms of finite elements know it to ([\d.]+) %"
    )
    digits(off, 100 * float(law["pressure_error"]))
    assert 0.5e-3 < float(law["seconds"]) < 1.5e-3
    least = rows("error_vs_runtime/recommended.csv", brake=brake, quantity="p (L2)", target=f"{known / 100:g}")[0]
    digits(ms, 1e3 * float(least["seconds"]))
    assert float(least["error"]) <= known / 100

    def smallest(family, kind):
        """The quickest solve of a kind of graded mesh that knows p as well."""
        made = rows(file, brake=brake, family=family, kind=kind, status="converged")
        good = [row for row in made if row["even"] != "True" and not row.get("layers")]
        good = [row for row in good if float(row["pressure_error"]) <= known / 100]
        return min(good, key=lambda row: float(row["seconds"]))

    pairs = [(smallest("GetFEM", kind), smallest("graded mesh", kind)) for kind in ("quad1", "quad2")]
    assert all(theirs["elements"] == ours["elements"] for theirs, ours in pairs)
    cold, further = (
        [float(theirs[key]) / float(ours[key]) for theirs, ours in pairs] for key in ("seconds", "further")
    )
    said = quoted(
        r"GetFEM takes ([\d.]+) to ([\d.]+) times as long for that, and ([\d.]+) to ([\d.]+) times for a further"
    )
    for number, value in zip(said, (min(cold), max(cold), min(further), max(further)), strict=True):
        digits(number, value)
    (calculix,) = quoted(r"CalculiX some ([\d.]+) times")
    ratio = float(smallest("CalculiX", "quad2")["seconds"]) / float(smallest("graded mesh", "quad2")["seconds"])
    assert ratio == pytest.approx(calculix, rel=0.02)
    (even,) = quoted(r"graded nowhere \(dotted\) GetFEM is ([\d.]+) % off after a second")
    finest = max(rows(file, brake=brake, family="GetFEM", even="True"), key=lambda row: float(row["seconds"]))
    digits(even, 100 * float(finest["pressure_error"]))
    assert float(finest["seconds"]) == pytest.approx(1.0, abs=0.1)


def test_run_in():
    made = rows("run_in/brakes.csv", brake="double_shoe/brake", model="fem")[0]
    within, distance = quoted(
        r"end at p ~ sin φ within ([\d.]+) %, after a sliding distance of some ([\d.]+)/\(k K\), an eighth"
    )
    assert 100 * float(made["end_pressure"]) <= within
    digits(distance, float(made["pressure_distance"]))
    assert float(made["pressure_life"]) == pytest.approx(1 / 8, rel=0.05)
    flexible = rows("run_in/brakes.csv", brake="double_shoe/flexible", model="fem")[0]
    assert float(flexible["pressure_life"]) > 1  # "takes longer than the lining lasts"
