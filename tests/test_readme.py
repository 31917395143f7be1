"""The numbers that README quotes are those of the reports that are kept."""

import re
from itertools import product, starmap

import numpy as np
import pytest

import drumlin
from conftest import ROOT, STUDY
from drumlin_studies.plane_stress_limits import parameter_ranges_within_error_limits
from drumlin_studies.stated_true import (
    QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED,
    stated_over_true_error_of_row,
)
from kept_reports import rows
from picking import having, picked

README = re.sub(r"\s+", " ", (ROOT / "README.md").read_text())


def quoted(pattern):
    """The numbers in README that a pattern catches."""
    found = re.findall(pattern, README)
    assert len(found) == 1, pattern
    return list(map(float, found[0] if isinstance(found[0], tuple) else found))


def digits(said, value):
    """A quoted number, with a tolerance of half a unit of its last digit."""
    unit = 10.0 ** -len(f"{said:g}".partition(".")[2])
    assert abs(said - value) <= 0.5 * unit * (1 + 1e-9), (said, value)


def test_the_answer_of_the_example():
    """The table on the first screen is what a solve of the double-shoe brake answers."""
    brake = drumlin.read_brake(STUDY / "brake.toml")
    response = drumlin.solve(brake)
    shoes = {shoe.name: shoe for shoe in response.shoes}
    leading, trailing = shoes["left"], shoes["right"]
    factors = {
        shoe.name: merit.shoe_factor
        for shoe, merit in zip(response.shoes, response.merits, strict=True)
    }
    answers = {
        "torque": (" N m", leading.torque, trailing.torque, response.error["torque"]),
        r"brake factor T/\(F R\)": (
            "",
            factors["left"],
            factors["right"],
            response.error["torque"],
        ),
        "load on the pin": (
            " N",
            float(np.hypot(*leading.hinge_reaction)),
            float(np.hypot(*trailing.hinge_reaction)),
            response.error["reaction"],
        ),
        "peak pressure": (
            " MPa",
            1e-6 * leading.peak_pressure,
            1e-6 * trailing.peak_pressure,
            response.error["peak"],
        ),
    }
    for name, (unit, first, second, error) in answers.items():
        row = rf"\| {name} \| ([\d.]+){unit} \| ([\d.]+){unit} \| ([\d.]+) % \|"
        said = quoted(row)
        digits(said[0], first)
        digits(said[1], second)
        digits(said[2], 100 * error)
        if name == "peak pressure":
            assert re.search(row + r" not known \|", README)
        else:
            quantity = "reaction" if name == "load on the pin" else "torque"
            of_plane_stress = response.plane_stress_error.brake[quantity]
            digits(quoted(row + r" ([\d.]+) % \|")[-1], 100 * of_plane_stress)
    limits = {limit.shoes: limit.friction for limit in drumlin.self_locking(brake)}
    (locking,) = quoted(r"friction coefficient at which the shoe locks itself \| ([\d.]+) \| none")
    digits(locking, limits["left",])
    assert np.isinf(limits["right",])
    lines = (STUDY / "brake.toml").read_text().splitlines()
    (some,) = quoted(r"text file of some (\d+) lines")
    assert some == sum(bool(line) and not line.startswith("#") for line in lines)


def test_the_lines_of_python_run_in_any_folder(monkeypatch, tmp_path, capsys):
    monkeypatch.chdir(tmp_path)
    (code,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    exec(compile(code, "README.md", "exec"), {})
    total = (
        float(quoted(r"\| torque \| ([\d.]+) N m")[0])
        + quoted(r"\| torque \| [\d.]+ N m \| ([\d.]+) N m")[0]
    )
    assert f"fem: torque {total:.1f}"[:16] in capsys.readouterr().out
    assert list(tmp_path.iterdir()) == []


def test_law_against_elements():
    made = rows("double_shoe/results.csv", rotation="counter-clockwise")
    sine = having(made, model="sine")
    stiff = {row["shoe"]: row for row in sine if row["case"] == "stiff shoes"}
    (low,) = quoted(r"torque of the brake \| ([\d.]+) % low")
    (high,) = quoted(r"torque of the trailing shoe \| ([\d.]+) % high")
    (low_too,) = quoted(r"torque of the leading shoe \| ([\d.]+) % low")
    (peak,) = quoted(r"peak pressure of the trailing shoe \| ([\d.]+) % low")
    (flexible,) = quoted(r"torque of the same brake with flexible shoes \| ([\d.]+) % low")
    (seconds,) = quoted(r"The solve takes ([\d.]+) s\.")
    digits(low, -100 * float(stiff["all"]["torque_error"]))
    assert (stiff["right"]["self_energising"], stiff["left"]["self_energising"]) == ("no", "yes")
    digits(high, 100 * float(stiff["right"]["torque_error"]))
    digits(low_too, -100 * float(stiff["left"]["torque_error"]))
    digits(peak, -100 * float(stiff["right"]["peak_error"]))
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
        r"\|---\| \| ([\d.]+) % \| ([\d.]+) ms \| ([\d.]+) times as long \| (\d+) times as long \|"
    )
    fine_ms, finer, slower = quoted(
        r"\| 0\.1 % \| ([\d.]+) ms \| ([\d.]+) times as long \| (\d+) times as long \|"
    )
    further_ms, further = quoted(
        r"\| 0\.1 %, further load case \| ([\d.]+) ms \| ([\d.]+) times as long \|"
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

    (wanted,) = quoted(r"GetFEM is ([\d.]+) % off after a second")
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
    (within,) = quoted(r"difference from the sine law at the end \| at most ([\d.]+) % of the p")
    (distance,) = quoted(r"within 1 % of the sine law \| ([\d.]+)/\(k K\)")
    (life,) = quoted(r"share of the lining's life \| 1/(\d+)")
    assert 100 * float(made["end_pressure"]) <= within
    digits(distance, float(made["pressure_distance"]))
    assert float(made["pressure_life"]) == pytest.approx(1 / life, rel=0.05)
    flexible = rows("run_in/brakes.csv", brake="double_shoe/flexible", model="fem")[0]
    # README says of flexible shoes that running in takes "more than the lining's life".
    assert float(flexible["pressure_life"]) > 1


def test_stated_against_true_errors():
    """The shares of stated errors that README quotes are those of the kept report.

    They count pressure, torque, peak and reaction of every brake at every tolerance.
    """
    (brakes,) = quoted(r"\| stated errors of (\d+) random brakes \|")
    (above,) = quoted(r"smaller than the true error \| ([\d.]+) %")
    (whole,) = quoted(r"finer solution counts as an error of drumlin \| ([\d.]+) %")
    (most,) = quoted(r"largest ratio of true to stated error \| ([\d.]+)")
    made = [{k: v for k, v in row.items() if v} for row in rows("verification/stated_true.csv")]
    assert len(set(picked(made, "seed"))) == brakes
    pairs = list(product(made, QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED))
    ratios = np.array(list(starmap(stated_over_true_error_of_row, pairs)))
    # A true error that is unknown has no ratio.
    known = ~np.isnan(ratios)
    judged = ratios[known]
    assert len(judged) > 4000
    digits(above, 100 * np.count_nonzero(judged < 1) / len(judged))
    digits(most, 1 / judged.min())
    sure = [(row | {f"unsure_{name}": 0.0}, name) for row, name in pairs]
    whole_errors = np.array(list(starmap(stated_over_true_error_of_row, sure)))[known]
    digits(whole, 100 * np.count_nonzero(whole_errors < 1) / len(judged))


def test_plane_stress_against_the_solid_model():
    leading = rows("plane_stress/errors.csv", case="T-section", shoe="leading")[0]
    trailing = rows("plane_stress/errors.csv", case="T-section", shoe="trailing")[0]
    (spread,) = quoted(r"across the width is ([\d.]+) % of its mean")
    digits(spread, 100 * float(trailing["uneven"]))
    plane, corrected = quoted(
        r"torque of the leading shoe of the car \| ([\d.]+) % off \| ([\d.]+) % off"
    )
    digits(plane, 100 * float(leading["torque"]))
    digits(corrected, 100 * float(leading["corrected_torque"]))
    maps = rows("plane_stress/maps.csv")
    for name, words in (("torque", "torque of one shoe"), ("pressure", "pressure averaged over")):
        count, plane, corrected = quoted(
            rf"{words}[^|]*, worst of (\d+) brakes[^|]*\| ([\d.]+) % off \| ([\d.]+) % off"
        )
        assert count == len(maps)
        digits(plane, 100 * max(abs(float(row[name])) for row in maps))
        digits(corrected, 100 * max(abs(float(row[f"corrected_{name}"])) for row in maps))


def test_the_brakes_for_which_plane_stress_is_enough():
    table = rows("plane_stress/limits.csv")
    for row in table:
        row.update({name: float(row[name]) for name in ("value", "pressure", "torque")})
    found = {
        (each.varied, each.brake, each.quantity, each.limit): (each.low, each.high)
        for each in parameter_ranges_within_error_limits(table)
    }
    (largest_nu,) = quoted(r"Poisson's ratio of the lining is at most ([\d.]+)\. On the shoe")
    nu = "Poisson's ratio of the lining", "one width"
    assert found[*nu, "torque", 0.01] == found[*nu, "pressure", 0.05] == (0.0, largest_nu)
    (overhang,) = quoted(r"beyond the web by at most ([\d.]+) times the thickness of the")
    assert found["overhang / table thickness", "T-section", "pressure", 0.05][1] == overhang
    (modulus,) = quoted(r"lining's modulus may be at most (\d+) MPa")
    assert found["modulus of the lining [MPa]", "T-section", "pressure", 0.05][1] == modulus
    assert max(row["torque"] for row in table) < 0.05
    assert max(row["pressure"] for row in table) < 0.2


def test_error_against_the_solid_shoe():
    made = rows("error_vs_runtime/solid_plane_stress_brake.csv")
    (plane,) = quoted(r"plane stress is ([\d.]+) % off the pressure of the solid shoe")
    for row in having(made, family="degree 0"):
        digits(plane, 100 * float(row["solid_pressure"]))
    error, seconds = quoted(r"across the width is ([\d.]+) % off after ([\d.]+) s")
    degree = having(made, family="degree 2")[0]
    digits(error, 100 * float(degree["solid_pressure"]))
    digits(seconds, float(degree["seconds"]))
    error, seconds = quoted(r"hexahedra is ([\d.]+) % off after ([\d.]+) s")
    peer = having(made, family="CalculiX")[-1]
    digits(error, 100 * float(peer["solid_pressure"]))
    digits(seconds, float(peer["seconds"]))
