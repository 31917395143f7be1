"""The method recommended for a target error, from rows made by hand."""

from drumlin_studies.recommendation import (
    AIMED_PEER_TIME_OVER_DRUMLIN_TIME,
    LARGEST_ALLOWED_ERRORS_OF_RECOMMENDED_METHODS,
    compare_times_with_peer_programs,
    recommended_methods_by_brake_and_target,
    rows_of_fastest_methods_by_target,
)
from drumlin_studies.work_precision import converged_rows_by_mesh_series, fastest_rows_within_error
from picking import picked


def row_of(elements, error, seconds, family="graded mesh"):
    return {
        "family": family,
        "kind": "quad2",
        "elements": elements,
        "torque_error": error,
        "seconds": seconds,
        "ratio": 10 * seconds,
        "status": "converged",
    }


def test_luck_is_no_recommendation_and_ties_go_to_the_more_exact():
    lucky = [row_of(20, 1e-4, 1.0), row_of(40, 1e-2, 2.0), row_of(80, 1e-3, 4.0)]
    other = [row_of(20, 5e-4, 4.5, "even mesh")]
    failed = [
        {
            "family": "even mesh",
            "kind": "tri1",
            "elements": 20,
            "seconds": 0.1,
            "status": "failed: x",
        }
    ]
    floors = {"torque_error": 1e-6}
    fit = fastest_rows_within_error(lucky + other + failed, "torque_error", 5e-3, floors)
    # The mesh of 20 elements was lucky; of two equally fast rows the more exact one is first.
    assert picked(fit, "seconds") == [4.5, 4.0]
    assert fastest_rows_within_error(lucky, "torque_error", 1e-7, floors) == []
    assert len(converged_rows_by_mesh_series(lucky + other)) == 2


def test_what_to_use_is_a_matrix_of_brakes_and_targets():
    """The recommendation is a matrix of brakes and target errors.

    On one of three brakes the law is right. On another only finite elements are. On the third the
    reference is not accurate enough for a judgement.
    """
    law = {
        "family": "law",
        "method": "sine",
        "model": "sine",
        "status": "converged",
        "seconds": 0.1,
        "ratio": 0.1,
    }
    mesh = {
        "family": "graded mesh",
        "method": "quad2, 40 elements",
        "kind": "quad2",
        "elements": 40,
        "seconds": 2.0,
        "ratio": 2.0,
        "status": "converged",
        "torque_error": 1e-5,
        "pressure_error": 2e-3,
    }
    rows = [
        {"brake": "right", **law, "torque_error": 5e-3, "pressure_error": 0.5},
        {"brake": "wrong", **law, "torque_error": 0.2, "pressure_error": 0.5},
        *({"brake": name, **mesh} for name in ("right", "wrong", "vague")),
    ]
    fine = {"torque_error": 1e-6, "pressure_error": 1e-5}
    floors = {"right": fine, "wrong": fine, "vague": {"torque_error": 5e-4, "pressure_error": 1e-5}}
    torque, pressure = recommended_methods_by_brake_and_target(
        rows_of_fastest_methods_by_target(rows, floors)
    )
    assert (torque.quantity, pressure.quantity) == ("torque", "p (L2)")
    assert torque.targets == LARGEST_ALLOWED_ERRORS_OF_RECOMMENDED_METHODS["torque_error"]
    assert torque.by_law == [1, 1, 1, 0, 0] and pressure.by_law == [0] * len(
        LARGEST_ALLOWED_ERRORS_OF_RECOMMENDED_METHODS["pressure_error"]
    )
    assert list(torque.lines) == ["right", "wrong", "vague"]
    assert picked(torque.lines["right"], "sort") == ["law"] * 3 + ["elastic"] * 2
    assert picked(torque.lines["wrong"], "sort") == ["elastic"] * 5
    assert picked(torque.lines["vague"], "sort") == ["elastic"] * 4 + ["none"]
    assert "below what the reference knows" in torque.lines["vague"][-1].what
    assert pressure.lines["wrong"][-1].what == "none of those tried"
    assert torque.lines["right"][0].what == "sine law"
    assert torque.lines["wrong"][0][:2] == ("graded mesh: quad2, 40 elements", "elastic")
    assert torque.lines["wrong"][0].row["seconds"] == 2.0


def test_peers_are_held_against_the_fastest_way_to_each_error():
    """Peers are compared with drumlin's fastest way to each error.

    Ratios are of the quickest rows on both sides; a slow row, or one on an even mesh, does not
    count.
    """

    def made(family, error, ratio, **more):
        return {
            "brake": "one",
            "family": family,
            "method": "x",
            "kind": "quad2",
            "pressure_error": error,
            "ratio": ratio,
            "status": "converged",
            **more,
        }

    rows = [
        made("columns", 2e-3, 1.0, level=0),
        made("columns", 2e-4, 2.0, level=1),
        made("columns", 2e-5, 4.0, level=2),
        made("graded mesh", 4e-3, 8.0, elements=56),
        made("GetFEM", 4e-3, 40.0, elements=56),
        made("GetFEM", 9e-4, 90.0, elements=112),
        made("GetFEM", 3e-3, 30.0, elements=42, layers=5),
        made("GetFEM", 4e-4, 80.0, elements=81, layers=7),
        made("GetFEM", 1e-3, 1.0, elements=160, even=True),
        made("CalculiX", 3e-3, 900.0, elements=56),
    ]
    ((brake, times, alike, even),) = compare_times_with_peer_programs(
        rows, {"one": {"pressure_error": 1e-6}}
    )
    assert brake == "one" and picked(times, ("peer", "target")) == [
        (p, x)
        for p in AIMED_PEER_TIME_OVER_DRUMLIN_TIME
        for x in AIMED_PEER_TIME_OVER_DRUMLIN_TIME[p]
    ]
    ratios = {
        (one.peer, one.target): one.best["ratio"] / one.own["ratio"] for one in times if one.best
    }
    assert ratios == {("GetFEM", 5e-3): 30.0, ("GetFEM", 1e-3): 40.0, ("CalculiX", 5e-3): 900.0}
    assert {one.target: one.own["ratio"] for one in times if one.peer == "GetFEM"} == {
        5e-3: 1.0,
        1e-3: 2.0,
        1e-4: 4.0,
    }
    assert [(theirs["ratio"], mine["ratio"]) for theirs, mine in alike] == [
        (40.0, 8.0),
        (900.0, 8.0),
    ]
    assert (even[0]["ratio"], even[1]["ratio"]) == (1.0, 1.0)
