"""The brake files of every kind, and the rows and sentences that the study makes of them."""

from pathlib import Path
from typing import Any

import pytest

from drumlin.brake.plane_brake import read_any
from drumlin.laws import law
from drumlin.verification.brake_kinds import both_ways, case, row_of, verdict

FILES = sorted((Path(__file__).parents[1] / "studies/brakes").glob("*.toml"))
KINDS = {"hinge", "abutment", "pivot"}


def test_the_files_hold_and_push_shoes_in_every_way() -> None:
    brakes = [read_any(path) for path in FILES]
    assert len(brakes) == 8
    assert {shoe.held_by for brake in brakes for shoe in brake.shoes} == KINDS
    assert {brake.shares for brake in brakes} == {
        None, "its shoes share their forces by a cam", "its shoes share their forces by a strut",
    }  # fmt: skip


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_every_file_has_its_law_both_ways(path: Path) -> None:
    for brake in both_ways(read_any(path)):
        response = law(brake)
        assert max(response.balance.force, response.balance.moment) < 1e-9
        assert all(shoe.contact_arcs for shoe in response.shoes)


def test_the_elastic_cam_brake_wears_in_to_equal_torques() -> None:
    (path,) = [path for path in FILES if path.stem == "s_cam"]
    found = case("s_cam", read_any(path), 24)
    new, worn = found.new.shoes, found.worn.shoes
    assert abs(new[0].torque / new[1].torque - 1) > 0.2
    assert worn[0].torque == pytest.approx(worn[1].torque, rel=1e-3)
    row: dict[str, Any] = row_of(found, None)
    assert row["balance"] < 1e-9
    assert abs(row["worn"]) < 1e-3 < abs(row["new"])
    assert verdict([row]).startswith("New, the law 'rigid' of the torque is an estimate")
