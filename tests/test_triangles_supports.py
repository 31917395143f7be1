"""The triangle solver on supports that push and cannot pull, against the elements it judges."""

import math

import numpy as np
import pytest

import drumlin
from anchored_shoes import PIN, duo_servo, shoe_between_anchors
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.file import read_brake, vary
from drumlin.studies import paths_of_example_brakes
from drumlin.verification.reference import (
    MESHES_OF_PUBLISHED_REFERENCE_VALUES,
    compute_reference_values,
    solve_brake_for_reference_values,
)
from drumlin.verification.triangles import (
    DegreeAndGradingOfTriangleMesh,
    solve_brake_on_one_triangle_mesh,
    solve_brake_on_sequence_of_triangle_meshes,
)
from drumlin.verification.triangles.solution import ShoeSolution
from drumlin_studies.stated_true import relative_pressure_error_of_shoe

pytestmark = pytest.mark.slow

SMALL = (DegreeAndGradingOfTriangleMesh(4, 10, 1.0, 1.0),)


def by_triangles(brake: Brake) -> list[ShoeSolution]:
    """The solutions of all shoes of a brake on one mesh of triangles."""
    return solve_brake_on_sequence_of_triangle_meshes(brake, SMALL)[-1]


def forces(shoes) -> dict[str, float]:
    """The forces [N] of the one-sided supports by their names."""
    return {force.name: force.push.force for shoe in shoes for force in shoe.supports}


@pytest.mark.parametrize("spin", (1, -1))
def test_duo_servo_in_both_senses_is_that_of_the_elements(spin: int) -> None:
    """Two independent solvers agree; the anchor's force times its height is the torque."""
    brake = duo_servo(spin, half=(0.7, 0.8))
    one, other = by_triangles(brake), drumlin.solve(brake, model_error=False)
    torque = math.fsum(shoe.torque for shoe in one)
    assert torque == pytest.approx(other.torque, rel=5e-5)
    own, theirs = forces(one), forces(other.shoes)
    assert own.keys() == theirs.keys()
    for name, force in own.items():
        assert force == pytest.approx(theirs[name], rel=1e-4)
    anchors = {name: force for name, force in own.items() if name.startswith("anchor")}
    assert sorted(anchors.values())[0] == 0.0
    assert sum(anchors.values()) * PIN == pytest.approx(torque, rel=1e-9)
    for a, b in zip(one, other.shoes, strict=True):
        assert relative_pressure_error_of_shoe(b, a) < 5e-3


@pytest.mark.parametrize("clearance", (0.0, 1e-4))
@pytest.mark.parametrize("spin", (1, -1))
def test_a_shoe_rests_on_the_anchor_of_the_elements(spin: int, clearance: float) -> None:
    """The drag on the shoe over the anchor's arm of 0.12 m is its force, for any clearance."""
    brake = shoe_between_anchors(spin, clearance=clearance)
    (one,), other = by_triangles(brake), drumlin.solve(brake, model_error=False)
    first, second = forces([one]).values()
    bears, left = (second, first) if spin > 0 else (first, second)
    assert left == 0.0
    assert bears == pytest.approx(one.torque / 0.12, rel=1e-9)
    assert one.torque == pytest.approx(other.torque, rel=5e-5)
    assert np.allclose(one.hinge_reaction, other.shoes[0].hinge_reaction, rtol=1e-4, atol=1e-2)


def test_supports_that_would_have_to_pull_give_no_answer() -> None:
    """One anchor that the drum drags the shoe away from holds nothing."""
    brake = shoe_between_anchors(1)
    brake = vary(brake, {"shoe.anchor": brake.shoes[0].anchors[:1]})
    with pytest.raises(NoAnswer, match="on no choice of its one-sided supports do pushes"):
        by_triangles(brake)


def test_bearing_supports_are_found_from_a_wrong_first_guess() -> None:
    """The supports that bore in an earlier solution are only where the search begins."""
    brake = duo_servo(half=(0.7, 0.7))
    right = by_triangles(brake)
    mirrored = by_triangles(brake.brake_with_reversed_motion())
    again = solve_brake_on_one_triangle_mesh(brake, SMALL[0], mirrored)
    assert forces(again) == pytest.approx(forces(right), rel=1e-4)
    assert {name for name, force in forces(again).items() if force == 0.0} == {"anchor of 'left'"}


def test_reference_values_of_the_duo_servo_come_from_both_solvers() -> None:
    """The stated uncertainty of the torque is small, and the triangles have judged it."""
    brake = read_brake(paths_of_example_brakes()["duo_servo"])
    trio = solve_brake_for_reference_values(
        brake,
        MESHES_OF_PUBLISHED_REFERENCE_VALUES._replace(
            triangles=MESHES_OF_PUBLISHED_REFERENCE_VALUES.triangles[:2]
        ),
    )
    assert trio.other is not None and trio.other.model == "triangles"
    found = compute_reference_values(brake, "", "", trio)
    assert found.torque.value == pytest.approx(796.344, abs=5e-3)
    assert found.torque.relative_uncertainty < 1e-5
    assert max(shoe.hinge_reaction.relative_uncertainty for shoe in found.shoes) < 1e-5
