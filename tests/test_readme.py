"""The numbers that README quotes are those of the reports that are kept."""

import re
from itertools import product, starmap

import numpy as np
import pytest

from conftest import ROOT
from drumlin_studies.stated_true import JUDGED_QUANTITIES, stated_over_true
from kept_reports import rows
from picking import having, picked

README = re.sub(r"\s+", " ", (ROOT / "README.md").read_text())


def quoted(pattern):
    """The numbers in README that a pattern catches."""
    found = re.findall(pattern, README)
    assert len(found) == 1, pattern
    return list(map(float, found[0] if isinstance(found[0], tuple) else found))


def digits(said, value):
    """What is said, as a number of the same digits: half a unit of its last one is allowed."""
    unit = 10.0 ** -len(f"{said:g}".partition(".")[2])
    assert abs(said - value) <= 0.5 * unit * (1 + 1e-9), (said, value)


def test_law_against_elements():
    made = rows("double_shoe/results.csv", rotation="counter-clockwise")
    sine = having(made, model="sine")
    stiff = {row["shoe"]: row for row in sine if row["case"] == "stiff shoes"}
    low, high, low_too, peak, flexible, seconds = quoted(
        r"total torque is ([\d.]+) % low, its torque of the single shoes ([\d.]+) % high and "
        r"([\d.]+) % low, its peak "
        r"pressure up to ([\d.]+) % low; with flexible shoes the total is ([\d.]+) % low\. The "
        r"whole elastic brake is "
        r"solved in ([\d.]+) s"
    )
    digits(low, -100 * float(stiff["all"]["torque_error"]))
    shoes = [stiff["right"], stiff["left"]]
    torque_errors = list(map(float, picked(shoes, "torque_error")))
    digits(high, 100 * max(torque_errors))
    digits(low_too, -100 * min(torque_errors))
    digits(peak, -100 * min(map(float, picked(shoes, "peak_error"))))
    total = next(row for row in sine if (row["case"], row["shoe"]) == ("flexible shoes", "all"))
    digits(flexible, -100 * float(total["torque_error"]))
    spent = [
        float(row["seconds"]) for row in made if row["model"] == "fem" and row["shoe"] == "all"
    ]
    assert len(spent) == 2
    for one in spent:
        digits(seconds, one)


def test_error_against_run_time():
    file, brake = "error_vs_runtime/results.csv", "double_shoe/brake"
    law = rows(file, brake=brake, method="sine")[0]
    law_ms, off = quoted(r"sine law takes ([\d.]+) ms, and its pressure is ([\d.]+) % off")
    known, ms, best, slow = quoted(
        r"\|---\| \| ([\d.]+) % \| ([\d.]+) ms \| ([\d.]+) times as long \| (\d+) times \|"
    )
    fine_ms, finer, slower = quoted(r"\| 0\.1 % \| ([\d.]+) ms \| ([\d.]+) times \| (\d+) times \|")
    further_ms, further = quoted(
        r"\| 0\.1 %, further load case \| ([\d.]+) ms \| ([\d.]+) times \|"
    )
    digits(off, 100 * float(law["pressure_error"]))
    digits(law_ms, 1e3 * float(law["seconds"]))
    for target, said in ((known / 100, ms), (1e-3, fine_ms)):
        least = rows(
            "error_vs_runtime/recommended.csv",
            brake=brake,
            quantity="p (L2)",
            target=f"{target:g}",
        )[0]
        digits(said, 1e3 * float(least["seconds"]))
        assert float(least["error"]) <= target
    digits(further_ms, 1e3 * float(least["further"]))

    def times(peer, target, key="ratio"):
        """How many times as long a peer takes on the quickest of its meshes that know p as well."""
        made = rows(file, brake=brake, family=peer, status="converged")
        best = min(
            (row for row in made if float(row["pressure_error"]) <= target),
            key=lambda row: float(row["seconds"]),
        )
        ours = rows(
            "error_vs_runtime/recommended.csv", brake=brake, quantity="p (L2)", target=f"{target:g}"
        )[0]
        (ours,) = rows(file, brake=brake, family=ours["family"], method=ours["method"])
        return float(best[key]) / float(ours[key])

    (wanted,) = quoted(r"GetFEM is still ([\d.]+) % off after a second")
    digits(best, times("GetFEM", known / 100))
    digits(finer, times("GetFEM", 1e-3))
    digits(further, times("GetFEM", 1e-3, "further_ratio"))
    assert slow == pytest.approx(times("CalculiX", known / 100), rel=0.02)
    assert slower == pytest.approx(times("CalculiX", 1e-3), rel=0.02)
    even = rows(file, brake=brake, family="GetFEM", even="True")[-1]
    digits(wanted, 100 * float(even["pressure_error"]))
    assert 0.8 < float(even["seconds"]) < 1.5


def test_run_in():
    made = rows("run_in/brakes.csv", brake="double_shoe/brake", model="fem")[0]
    within, distance = quoted(
        r"end at p ~ sin φ within ([\d.]+) %, after a sliding distance of some ([\d.]+)/\(k "
        r"K\), an eighth"
    )
    assert 100 * float(made["end_pressure"]) <= within
    digits(distance, float(made["pressure_distance"]))
    assert float(made["pressure_life"]) == pytest.approx(1 / 8, rel=0.05)
    flexible = rows("run_in/brakes.csv", brake="double_shoe/flexible", model="fem")[0]
    # README says that this "takes longer than the lining lasts".
    assert float(flexible["pressure_life"]) > 1


def test_stated_against_true_errors():
    """Of all that are judged: p, torque, peak and reaction of every brake, to every tolerance."""
    brakes, above, most, whole = quoted(
        r"stated errors of (\d+) random brakes ([\d.]+) % were smaller than the true ones, at "
        r"most ([\d.]+) times; "
        r"([\d.]+) % if the uncertainty"
    )
    made = [{k: v for k, v in row.items() if v} for row in rows("verification/stated_true.csv")]
    assert len(set(picked(made, "seed"))) == brakes
    pairs = list(product(made, JUDGED_QUANTITIES))
    ratios = np.array(list(starmap(stated_over_true, pairs)))
    # A true error that is unknown has no ratio.
    known = ~np.isnan(ratios)
    judged = ratios[known]
    assert len(judged) > 4000
    digits(above, 100 * np.count_nonzero(judged < 1) / len(judged))
    digits(most, 1 / judged.min())
    sure = [(row | {f"unsure_{name}": 0.0}, name) for row, name in pairs]
    whole_errors = np.array(list(starmap(stated_over_true, sure)))[known]
    digits(whole, 100 * np.count_nonzero(whole_errors < 1) / len(judged))
