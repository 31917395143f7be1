"""Sweeps: the meaning of their files, refusals, shared bodies, rows that depend on no worker."""

import math
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scipy import stats

from command_line import drumlin as run
from conftest import ROOT, STUDY
from drumlin.base.errors import BadInput
from drumlin.base.journal import JournalOfCaseResults, checksum_of_source_and_libraries
from drumlin.brake.file import read_brake, si_unit_of_brake_key, vary
from drumlin.fem.preparation import meshes
from drumlin.fem.preparation.cache import CacheOfCondensedBodies
from drumlin.fem.solve import solve
from drumlin.sweeps import cases as case_solving
from drumlin.sweeps import file as sweep_file
from drumlin.sweeps.cases import (
    SweepCase,
    solve_all_cases_of_sweep,
    solve_case_without_raising,
)
from drumlin.sweeps.file import read_sweep_from_toml_file, sweep_from_file_data
from drumlin.sweeps.run import solve_sweep_with_journal
from drumlin.sweeps.table import table_lines_of_cases, write_table_file
from picking import picked
from shared_parts import friction_cases

BRAKE = str(STUDY / "brake.toml")
LAW = {"brake": BRAKE, "model": {"sine": {}}}


def sweep(vary_, **more):
    return sweep_from_file_data(LAW | {"vary": vary_} | more)


def frictions(cases):
    """The coefficients of friction that the cases of a sweep change to."""
    return [case.changes["friction"] for case in cases]


def refusal(vary_, **more):
    with pytest.raises(BadInput) as error:
        sweep(vary_, **more)
    assert "\n" not in str(error.value)
    return str(error.value)


@pytest.mark.parametrize("name", ["grid", "loads", "tolerances"])
def test_the_examples_can_be_read(name):
    assert len(read_sweep_from_toml_file(ROOT / "studies" / "sweeps" / f"{name}.toml").cases) >= 300


def test_grid_zip_and_models():
    keys = {
        "friction": [0.2, 0.3],
        "shoe.actuation.force": {"from": "1 kN", "to": "4 kN", "count": 3, "scale": "log"},
    }
    grid = sweep(keys, model={"sine": {}, "fem": {"elements": 20}}).cases
    assert len(grid) == 2 * 3 * 2 and picked(grid[:2], "model") == ["sine", "fem"]
    forces = [case.changes["shoe.actuation.force"] for case in grid[0:6:2]]
    # A logarithmic scale doubles the force at each step.
    assert forces == pytest.approx([1000, 2000, 4000]) and set(frictions(grid[:6])) == {0.2}
    assert refusal(keys, combine="zip") == (
        "combine = \"zip\": needs as many values of each key; there are {'friction': 2, "
        "'shoe.actuation.force': 3}"
    )
    zipped = sweep(keys | {"friction": [0.1, 0.2, 0.3]}, combine="zip").cases
    assert frictions(zipped) == [0.1, 0.2, 0.3]


LAWS_OF_HINGED_SHOES_BY_NAME = {
    "normal": ({"mean": 0.3, "deviation": "10 %"}, stats.norm(0.3, 0.03)),
    "uniform": ({"from": 0.2, "to": 0.5}, stats.uniform(0.2, 0.3)),
    "triangular": ({"from": 0.2, "mode": 0.25, "to": 0.5}, stats.triang(1 / 6, 0.2, 0.3)),
    "lognormal": (
        {"deviation": 0.06},
        stats.lognorm(math.sqrt(math.log(1.04)), scale=0.3 / math.sqrt(1.04)),
    ),
    "truncated-normal": (
        {"deviation": 0.05, "from": 0.32, "to": 0.45},
        stats.truncnorm(0.4, 3, 0.3, 0.05),
    ),
}


@pytest.mark.parametrize("name", LAWS_OF_HINGED_SHOES_BY_NAME)
def test_draws_follow_their_distribution(name):
    given, law = LAWS_OF_HINGED_SHOES_BY_NAME[name]
    drawn = frictions(sweep({"friction": {"distribution": name} | given}, cases=2000).cases)
    assert stats.kstest(drawn, law.cdf).pvalue > 0.01


@pytest.mark.parametrize("name", LAWS_OF_HINGED_SHOES_BY_NAME)
def test_quantiles_are_those_of_scipy(name):
    given, law = LAWS_OF_HINGED_SHOES_BY_NAME[name]
    u = np.linspace(1e-6, 1 - 1e-6, 101)
    inverse = sweep_file._make_inverse_cumulative_function(
        "",
        sweep_file.DISTRIBUTION_CLASSES_BY_NAME[name].model_validate(
            {"distribution": name} | given
        ),
        "",
        [0.3],
    )
    np.testing.assert_allclose(inverse(u), law.ppf(u), rtol=1e-13)


@pytest.mark.parametrize(
    "ends", [(-40, 40), (-math.inf, 1), (10, math.inf), (-11, -10), (50, 51), (-1e-9, 1e-9)]
)
def test_a_normal_distribution_is_cut_in_its_tails_too(ends):
    u = np.linspace(1e-6, 1 - 1e-6, 101)
    np.testing.assert_allclose(
        sweep_file._inverse_of_cumulative_truncated_standard_normal(u, *ends),
        stats.truncnorm(*ends).ppf(u),
        rtol=1e-9,
        atol=1e-15,
    )


def test_draws_stay_when_keys_and_cases_are_added():
    spread = {"distribution": "normal", "deviation": "5 %"}
    few = sweep({"friction": spread}, cases=10).cases
    more = sweep(
        {"shoe.lining.thickness": spread | {"each_shoe": True}, "friction": spread}, cases=20
    ).cases
    assert frictions(few) == frictions(more[:10])
    assert {"shoe[0].lining.thickness", "shoe[1].lining.thickness"} < set(more[0].changes)
    assert (
        more[0].changes["shoe[0].lining.thickness"] != more[0].changes["shoe[1].lining.thickness"]
    )
    other = sweep({"friction": spread}, cases=10, seed=2).cases
    assert not set(frictions(few)) & set(frictions(other))


MANY = {"from": 0, "to": 1, "count": 2000}
NORMAL = {"distribution": "normal", "deviation": 0.03}


@pytest.mark.parametrize(
    ("vary_", "more", "words"),
    [
        ({"frictoin": [0.3]}, {}, ["vary.frictoin: unknown key 'frictoin'", "friction"]),
        (
            {"shoe.lining.thickness": [8]},
            {},
            ['vary."shoe.lining.thickness" = 8', "has no unit", "8 mm"],
        ),
        ({"shoe.lining.thickness": ["8 MPa"]}, {}, ["'8 MPa'", "a length"]),
        ({"friction": ["wet"]}, {}, ["vary.friction = 'wet'", "must be a number"]),
        ({"friction": 0.3}, {}, ["vary.friction = 0.3", "must be a list"]),
        ({"friction": []}, {}, ["at least one value"]),
        ({"friction": [-0.1]}, {}, ["friction = -0.1", "greater than or equal to 0"]),
        ({"rotation": ["up"]}, {}, ["rotation = 'up'", "'clockwise'"]),
        ({"rotation": NORMAL}, {"cases": 2}, ["vary.rotation", "takes words"]),
        ({"friction": NORMAL}, {}, ["cases: is missing"]),
        ({"friction": [0.3]}, {"cases": 3}, ["cases = 3", "nothing is drawn"]),
        (
            {"friction": NORMAL | {"deviation": -1}},
            {"cases": 2},
            ["vary.friction.deviation = -1", "greater than 0"],
        ),
        (
            {"friction": NORMAL | {"spread": 1}},
            {"cases": 2},
            ["vary.friction: unknown key 'spread'", "deviation"],
        ),
        (
            {"friction": {"distribution": "gauss"}},
            {"cases": 2},
            ["distribution = 'gauss'", "truncated-normal"],
        ),
        (
            {"friction": {"distribution": "uniform", "from": 2, "to": 1}},
            {"cases": 2},
            ["vary.friction.to = 1"],
        ),
        (
            {"friction": NORMAL | {"each_shoe": True}},
            {"cases": 2},
            ["each_shoe", "shoe.lining.thickness"],
        ),
        ({"friction": {"from": 0, "to": 1, "count": 1}}, {}, ["count = 1"]),
        (
            {"friction": {"from": 0, "to": 1, "count": 3, "scale": "log"}},
            {},
            ['scale = "log"', "greater than 0"],
        ),
        ({"drum.ring.thickness": ["5 mm"]}, {}, ["no such part"]),
        ({"friction": [0.3]}, {"combine": "all"}, ["combine = 'all'", "'grid'"]),
        (
            {"friction": {"from": float("nan"), "to": 1, "count": 3}},
            {},
            ["vary.friction: from = nan", "finite number"],
        ),
        ({"friction": [0.3]}, {"model": "sine"}, ["model = 'sine'", "must be a table, [model]"]),
        ({"friction": [0.3]}, {"model": {"spline": {}}}, ["model.spline: unknown model", "sine"]),
        (
            {"friction": [0.3]},
            {"model": {"sine": {"elements": 8}}},
            ["model.sine: unknown key 'elements'"],
        ),
        ({"friction": [0.3]}, {"model": {"fem": {"elements": 0}}}, ["model.fem: elements = 0"]),
        (
            {"friction": [0.3]},
            {"model": {"fem": {"kind": "tri2", "tolerance": 0.1}}},
            ["tolerance chooses the"],
        ),
        (
            {"friction": [0.3]},
            {"model": {"foundation": {}}},
            ["model.foundation: does not apply", "straight beam"],
        ),
        (
            {"friction": MANY, "drum.radius": MANY | {"from": "1 m", "to": "2 m"}},
            {},
            ["4000000 cases", "1000000"],
        ),
    ],
)
def test_refusals_name_key_value_and_what_is_allowed(vary_, more, words):
    said = refusal(vary_, **more)
    assert all(word in said for word in words), said


def test_values_that_fit_only_together_are_taken():
    keys = {"shoe[0].lining.end": ["70 deg"], "shoe[0].body.end": ["75 deg"]}
    assert len(sweep(keys).cases) == 1
    assert "must lie within the body" in refusal({"shoe[0].lining.end": ["70 deg"]})


def test_units_of_keys(brake):
    keys = (
        "friction",
        "rotation",
        "shoe.lining.clearance",
        "shoe[1].body.material.E",
        "shoe.actuation.direction",
    )
    assert [si_unit_of_brake_key(brake, key) for key in keys] == ["", None, "m", "Pa", "rad"]
    post = read_brake(ROOT / "studies" / "post_brake" / "brake.toml")
    assert (
        si_unit_of_brake_key(post, "drum.ring.bending_stiffness")
        == si_unit_of_brake_key(post, "shoe.body.bending_stiffness")
        == "N m^2"
    )


def test_a_failed_case_is_a_row_with_its_reason(brake, monkeypatch):
    cases = friction_cases(brake, (0.3, 0.9, -1.0))
    good, locked, bad = solve_all_cases_of_sweep(cases)
    assert good["status"] == "solved" and good["torque"] > 0
    assert (
        "self-locking" in locked["status"]
        and "friction = -1" in bad["status"]
        and list(bad) == ["status"]
    )
    monkeypatch.setattr("drumlin.sweeps.cases.results_of_response_by_name", lambda *_: 1 / 0)
    assert (
        solve_case_without_raising(cases[0]).row["status"]
        == "failed: unexpected ZeroDivisionError: division by zero"
    )


def test_bodies_are_condensed_once_for_all_loads(brake, monkeypatch):
    made = []
    assemble = meshes.mesh_and_assemble_shoe
    monkeypatch.setattr(meshes, "mesh_and_assemble_shoe", lambda *a: made.append(1) or assemble(*a))
    loads = [
        {"friction": 0.2},
        {"rotation": "clockwise", "shoe[0].actuation.force": 500.0},
        {"shoe[1].lining.clearance": 1e-4, "shoe.actuation.direction": 0.1},
        {"shoe[0].actuation.point.y": 0.09},
    ]
    solve_all_cases_of_sweep(
        [SweepCase(brake, change, "fem", {"elements": 10}) for change in loads]
    )
    # Both shoes share one body.
    assert len(made) == 1
    softer = [{"shoe[0].lining.material.E": 2e8, "friction": mu} for mu in (0.2, 0.3)]
    solve_all_cases_of_sweep(
        [SweepCase(brake, change, "fem", {"elements": 10}) for change in softer]
    )
    assert len(made) == 3


def test_shared_bodies_change_no_digit(brake, flexible):
    """Cases of a sweep that share bodies, in any order, have the numbers of cases that do not."""
    changes = [
        {"friction": mu, "shoe[0].lining.thickness": t} for mu in (0.0, 0.3) for t in (7e-3,)
    ]
    ring = {"thickness": 0.01, "width": 0.04, "material": {"E": 1.2e11, "nu": 0.25}}
    changes += [{"drum.ring": ring}]
    changes += [{"rotation": "clockwise", "shoe.lining.clearance": 1e-4}]
    cases = [
        SweepCase(base, change, "fem", {"elements": 8})
        for change in changes
        for base in (brake, flexible)
    ]
    cache = CacheOfCondensedBodies()
    shared = [solve_case_without_raising(case, cache).row for case in reversed(cases)][::-1]
    assert (
        shared
        == [solve_case_without_raising(case).row for case in cases]
        == solve_all_cases_of_sweep(cases)
    )
    assert set(picked(shared, "status")) == {"solved"}
    own = [solve(vary(case.brake, case.changes), elements=8).torque for case in cases]
    assert picked(shared, "torque") == own


def test_room_for_bodies_is_kept_to():
    cache, made = CacheOfCondensedBodies(room=10), []
    for key in (1, 2, 1, 3, 2, 1):
        assert cache.get(key, lambda key=key: made.append(key) or key, lambda _: 5) == key
    # Body 1 was used after body 2: body 3 took the place of 2, and then 2 the place of 1.
    assert made == [1, 2, 3, 2, 1]
    assert cache.get(9, lambda: 9, lambda _: 100) == 9


@pytest.mark.parametrize("count", [1, 7])
def test_any_executor_gives_the_same_rows(brake, count, tmp_path):
    cases = friction_cases(brake, np.linspace(0.1, 0.9, 41))
    told = []
    with (
        ThreadPoolExecutor(count) as executor,
        JournalOfCaseResults(tmp_path / "journal") as journal,
    ):
        rows = solve_all_cases_of_sweep(
            cases,
            executor=executor,
            workers=count,
            journal=journal,
            done=lambda *at: told.append(at),
        )
    assert rows == solve_all_cases_of_sweep(cases) and told == [(n, 41) for n in range(42)]
    # All cases are in the journal; four more are asked for.
    with JournalOfCaseResults(tmp_path / "journal") as journal:
        more = cases + friction_cases(brake, (0.11, 0.12, 0.13, 0.11))
        solve_all_cases_of_sweep(more, journal=journal, done=lambda *at: told.append(at))
        # The doubled case is not solved twice.
        assert told[42] == (42, 45)
        assert told[-1] == (45, 45) and len(journal) == 44


def test_journal_with_cases_of_another_sweep_stays(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    file, journal = tmp_path / "s.toml", tmp_path / "s.csv.journal"

    def sweep_frictions(numbers, *options):
        file.write_text(f"brake = '{BRAKE}'\n[model.sine]\n[vary]\nfriction = {numbers}\n")
        done = run("sweep", file, "--jobs", 1, *options)
        assert done.returncode == 0
        return done.stderr

    assert sweep_frictions([0.2, 0.3, 0.3], "--keep-journal") == "" and journal.exists()
    said = sweep_frictions([0.3])
    assert "s.csv.journal: is kept, since it has 1 finished cases that are not" in said
    with JournalOfCaseResults(journal, checksum_of_source_and_libraries()) as kept:
        assert len(kept) == 2
    # The sweep to which all cases belong deletes the journal; equal cases count once.
    assert sweep_frictions([0.2, 0.3, 0.3]) == "" and not journal.exists()


def test_table_is_written_while_the_journal_is_locked(tmp_path):
    made = sweep({"friction": [0.2, 0.3]})
    journal = tmp_path / "t.csv.journal"

    def write_table(rows):
        with pytest.raises(BadInput, match="another run is writing it"):
            JournalOfCaseResults(journal)
        return len(rows)

    lines = []
    how = {"jobs": 1, "say": lines.append}
    kept = solve_sweep_with_journal(made, tmp_path / "t.csv", write_table, keep_journal=True, **how)
    assert kept == 2 and journal.exists()
    assert solve_sweep_with_journal(made, tmp_path / "t.csv", write_table, **how) == 2
    assert not journal.exists() and lines == []


def test_sweep_that_lacks_cases_says_so_and_keeps_its_journal(tmp_path, monkeypatch):
    solve_case = case_solving.solve_case_without_raising

    def answer_short_of_memory(case, cache=None):
        answer = solve_case(case, cache)
        return answer._replace(is_kept_in_journal=case.changes["friction"] != 0.3)

    made = sweep({"friction": [0.2, 0.3, 0.4]})
    lines = []
    how = {"jobs": 1, "say": lines.append}
    with monkeypatch.context() as patched:
        patched.setattr(case_solving, "solve_case_without_raising", answer_short_of_memory)
        solve_sweep_with_journal(made, tmp_path / "t.csv", len, **how)
    assert len(lines) == 1
    assert lines[0].startswith("1 of 3 cases failed for want of memory") and "again" in lines[0]
    assert (tmp_path / "t.csv.journal").exists()
    solve_sweep_with_journal(made, tmp_path / "t.csv", len, **how)
    assert len(lines) == 1 and not (tmp_path / "t.csv.journal").exists()


def test_tables(brake, tmp_path):
    cases = [
        SweepCase(brake, {"shoe.lining.clearance": c, "friction": mu}, "sine")
        for c, mu in ((0.0, 0.3), (0.0, 0.9))
    ]
    cases.append(
        SweepCase(
            brake,
            {"shoe.lining.clearance": [["-70 deg", "0 mm"], ["55 deg", "0 mm"]], "friction": 0.3},
            "sine",
        )
    )
    lines = table_lines_of_cases(cases, solve_all_cases_of_sweep(cases))
    assert list(lines[0])[:6] == [
        "case",
        "shoe.lining.clearance [m]",
        "friction",
        "model",
        "status",
        "torque [N m]",
    ]
    assert (
        "right.contact_end [rad]" in lines[0]
        and lines[0]["torque [N m]"] == lines[2]["torque [N m]"]
    )
    assert lines[0]["brake_factor"] == pytest.approx(lines[0]["torque [N m]"] / (2000 * 0.15))
    write_table_file(lines, tmp_path / "t.csv")
    text = (tmp_path / "t.csv").read_text().splitlines()
    assert len(text) == 4 and text[2].startswith("1,0.0,0.9,sine,\"failed: shoe '")
    arrow = pytest.importorskip("pyarrow.parquet")
    write_table_file(lines, tmp_path / "t.parquet")
    again = arrow.read_table(tmp_path / "t.parquet").to_pylist()
    assert picked(again, "torque [N m]") == [line.get("torque [N m]") for line in lines]


def test_cases_that_share_bodies_cost_a_fraction_of_others():
    """Cases that share bodies take a fraction of the time of others.

    A thousand cases take some 20 s on two cores; ratios of the process's own time, a fifth, are
    tested.
    """

    def spent(do):
        start = time.process_time()
        do()
        return time.process_time() - start

    loads = read_sweep_from_toml_file(ROOT / "studies" / "sweeps" / "loads.toml")
    rows = solve_all_cases_of_sweep(loads.cases[:1])
    shared = spent(lambda: rows.extend(solve_all_cases_of_sweep(loads.cases[:12]))) / 12
    alone = sorted(
        spent(lambda case=case: solve_all_cases_of_sweep([case])) for case in loads.cases[:3]
    )[1]
    assert shared < 0.5 * alone
    for row in rows:
        assert row["status"] == "solved" and row["balance"] < 1e-9
