"""The brake files of every kind, and the rows and sentences that the study makes of them."""

import math
from pathlib import Path
from typing import Any

import pytest

from drumlin.brake import read_drum_or_plane_brake, vary
from drumlin.brake.brake import Brake
from drumlin.laws import solve_brake_by_its_rigid_shoe_law
from drumlin.response.merit import brake_factor
from drumlin_studies.brake_kinds import (
    brake_and_reversed_brake,
    brake_factor_of_cam_brake,
    row_of_errors_of_rigid_shoe_law,
    sentence_on_whether_law_can_be_trusted,
    solve_brake_by_all_models,
    torque_error_rows_of_other_models,
)
from picking import having, keyed, picked

FILES = sorted((Path(__file__).parents[1] / "studies/brakes").glob("*.toml"))
KINDS = {"hinge", "abutment", "pivot", "anchor"}


def test_the_files_hold_and_push_shoes_in_every_way() -> None:
    brakes = list(map(read_drum_or_plane_brake, FILES))
    assert len(brakes) == 10
    assert {shoe.kind_of_support for brake in brakes for shoe in brake.shoes} == KINDS
    assert set(picked(brakes, "reason_why_cam_or_strut_sets_forces")) == {
        None,
        "its shoes share their forces by a cam",
        "its shoes share their forces by a strut",
    }


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
@pytest.mark.slow
def test_every_file_has_its_law_both_ways(path: Path) -> None:
    for brake in brake_and_reversed_brake(read_drum_or_plane_brake(path)):
        response = solve_brake_by_its_rigid_shoe_law(brake)
        assert max(response.balance.force, response.balance.moment) < 1e-9
        assert all(picked(response.shoes, "contact_arcs"))


def test_the_elastic_cam_brake_wears_in_to_equal_torques() -> None:
    (path,) = having(FILES, stem="s_cam")
    brake = read_drum_or_plane_brake(path)
    assert not brake.surface.is_plane_and_not_drum
    found = solve_brake_by_all_models("s_cam", brake, 24)
    new, worn = found.new.shoes, found.worn.shoes
    assert abs(new[0].torque / new[1].torque - 1) > 0.2
    assert worn[0].torque == pytest.approx(worn[1].torque, rel=1e-3)
    one, two = (
        solve_brake_by_its_rigid_shoe_law(under(brake, i)).torque / (brake.size * 500.0)
        for i in range(2)
    )
    assert brake_factor_of_cam_brake(brake) == pytest.approx(4 * one * two / (one + two), rel=1e-12)
    row: dict[str, Any] = row_of_errors_of_rigid_shoe_law(found, None)
    assert row["factor_worn"] == pytest.approx(brake_factor_of_cam_brake(brake), rel=1e-3)
    assert abs(row["factor"] / row["factor_worn"] - 1) > 0.01
    assert row["balance"] < 1e-9
    assert abs(row["worn"]) < 1e-3 < abs(row["new"])
    assert abs(row["p_worn"]) < 1e-2 < abs(row["p"])


@pytest.mark.slow
def test_a_case_takes_solid_shoes_where_they_apply() -> None:
    paths = keyed(FILES, "stem")
    # On a pivot levers alone tell the force.
    for name, least in (
        ("simplex_hinged", 1e-3),
        ("rail_clamp", 0.0),
    ):
        found = solve_brake_by_all_models(
            name, read_drum_or_plane_brake(paths[name]), 12, solid=True
        )
        (row,) = having(torque_error_rows_of_other_models(found), model="solid")
        assert least <= abs(row["new"]) < 0.05


def under(brake: Brake, index: int) -> Brake:
    """One shoe of the brake, under a force of its own."""
    data = brake.shoes[index].model_dump(by_alias=True)
    data["actuation"]["force"] = 500.0
    return vary(brake.model_copy(update={"actuation": None}), {"shoe": [data]})


def test_a_strut_is_no_actuation() -> None:
    """The brake factor of a uni-servo brake counts the force of its cylinder."""
    (path,) = having(FILES, stem="uni_servo")
    brake = read_drum_or_plane_brake(path)
    assert not brake.surface.is_plane_and_not_drum
    response = solve_brake_by_its_rigid_shoe_law(brake)
    force = 0.96 * 3e6 * math.pi * 0.02222**2 / 4
    assert brake_factor(brake, response) == pytest.approx(
        response.torque / (force * 0.1397), rel=1e-12
    )


@pytest.mark.parametrize(
    ("new", "p", "said"),
    [
        (
            0.03,
            0.6,
            "New, the torque of the law 'sine' can be trusted (off by up to 3 %), its pressure "
            "cannot be",
        ),
        (
            0.1,
            0.01,
            "is an estimate (off by up to 10 %), its pressure can be trusted (off by up to 1 "
            "%); worn in, the",
        ),
        (
            -0.2,
            0.06,
            "cannot be trusted (off by up to 20 %), its pressure is an estimate (off by up to 6 %)",
        ),
        (
            1e-12,
            0.06,
            "The torque follows from equilibrium alone, whatever the pressure. The pressure of "
            "the law "
            "'sine' is an estimate (off by up to 6 %) new, and can be trusted (off by less "
            "than 0.01 %)",
        ),
    ],
)
def test_a_verdict_is_that_of_the_worse_sense_of_motion(new: float, p: float, said: str) -> None:
    row = {"unit": "N m", "law": "sine", "new": new, "p": p, "worn": 0.0, "p_worn": 0.0}
    assert said in sentence_on_whether_law_can_be_trusted([row, row | {"new": 0.0, "p": 0.0}])
