"""Blocks on a band: shoes in a chain of straps, by equilibrium and by finite elements."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import drumlin
from drumlin import BadInput, Brake
from drumlin.brake import read_drum_or_plane_brake, vary
from drumlin.brake.file import make_drum_brake_from_data
from drumlin.fem.analysis.holding import (
    find_drum_rotation_of_full_slip,
    turn_holding_brake_and_return_states_at_rotations,
)
from drumlin.fem.analysis.sensitivity import compute_torque_sensitivity
from drumlin.fem.solve import prepared_model_with_finest_elements
from drumlin.laws import solve_brake_by_its_rigid_shoe_law
from picking import picked

R, BAND, HALF, PITCH = 0.25, 0.267, math.radians(18), math.radians(48)


def band(mu: float = 0.35, spin: int = -1, blocks: int = 3, thickness: float = 5e-4) -> Brake:
    """A band brake of rigid blocks with thin linings, pulled at the first, held at the last."""
    shoes: list[dict[str, Any]] = []
    for k in range(blocks):
        middle = k * PITCH
        ends = [
            {"x": BAND * math.cos(a), "y": BAND * math.sin(a)}
            for a in (middle - PITCH / 2, middle + PITCH / 2)
        ]
        shoe = {
            "name": f"b{k}",
            "side": "external",
            "abutment": {"point": ends[1], "direction": middle + PITCH / 2 + math.pi / 2},
            "lining": {
                "start": middle - HALF,
                "end": middle + HALF,
                "thickness": thickness,
                "width": 0.08,
                "material": {"E": 3e8, "nu": 0.25},
            },
        }
        if k == 0:
            shoe["actuation"] = {
                "force": 2000.0,
                "direction": -PITCH / 2 - math.pi / 2,
                "point": ends[0],
            }
        shoes.append(shoe)
    links = [{"from": f"b{k}", "to": f"b{k + 1}"} for k in range(blocks - 1)]
    rotation = "counter-clockwise" if spin > 0 else "clockwise"
    data = {
        "title": "band",
        "rotation": rotation,
        "friction": mu,
        "drum": {"radius": R},
        "shoe": shoes,
        "link": links,
    }
    return make_drum_brake_from_data(data)


def pulls(mu: float, spin: int, blocks: int) -> list[float]:
    """The pulls of the straps by each block's equilibria: of x, of y and of moments about the drum.

    Under p = A cos + B sin of the angle from its middle, times width and R, the drum pushes it by A
    (a + sin 2a/2) outwards and B (a - sin 2a/2) across, drags it by mu of that turned, and turns it
    by mu R of A 2 sin a.
    """
    even, odd = HALF + math.sin(2 * HALF) / 2, HALF - math.sin(2 * HALF) / 2
    s, c, d = math.sin(PITCH / 2), math.cos(PITCH / 2), mu * spin
    found = [2000.0]
    for _ in range(blocks):
        T = found[-1]
        # the pulls: T (-s, -c) at the one end, next (-s, c) at the other, in the frame of the
        # block's middle
        rows = np.array(
            [
                [even, -d * odd, -s],
                [d * even, odd, c],
                [d * R * 2 * math.sin(HALF), 0.0, BAND],
            ]
        )
        found.append(float(np.linalg.solve(rows, T * np.array([s, c, BAND]))[2]))
    return found


@pytest.mark.parametrize("spin", [1, -1])
@pytest.mark.parametrize("blocks", [1, 3])
def test_the_law_of_a_band_of_blocks_is_the_equilibrium_of_each(spin: int, blocks: int) -> None:
    response = solve_brake_by_its_rigid_shoe_law(band(spin=spin, blocks=blocks))
    found = pulls(0.35, spin, blocks)
    for shoe, pull in zip(response.shoes, found[1:], strict=True):
        assert np.linalg.norm(shoe.hinge_reaction) == pytest.approx(pull, rel=1e-9)
    assert response.torque == pytest.approx(abs(found[-1] - found[0]) * BAND, rel=1e-9)
    assert (found[-1] > found[0]) == (spin < 0)


def test_short_blocks_have_the_ratio_of_pulls_of_textbooks() -> None:
    """Each short block multiplies the pull by (1 + mu tan(theta))/(1 - mu tan(theta)).

    The block covers 2 theta, and both pulls meet in the middle of its face.
    """
    brake, arm = band(blocks=3), R * math.cos(PITCH / 2) / BAND
    changes: dict[str, Any] = {}
    for k, shoe in enumerate(brake.shoes):
        middle = shoe.lining.middle
        changes |= {
            f"shoe[{k}].lining.start": middle - 1e-4,
            f"shoe[{k}].lining.end": middle + 1e-4,
        }
        for key in ("abutment.point", "actuation.point") if k == 0 else ("abutment.point",):
            point = shoe.abutment.point if "abutment" in key else shoe.actuation.point  # type: ignore[union-attr]
            changes[f"shoe[{k}].{key}"] = {"x": point.x * arm, "y": point.y * arm}
    t = 0.35 * math.tan(PITCH / 2)
    reactions = [
        np.linalg.norm(shoe.hinge_reaction)
        for shoe in solve_brake_by_its_rigid_shoe_law(vary(brake, changes)).shoes
    ]
    assert reactions == pytest.approx(
        [2000 * ((1 + t) / (1 - t)) ** (k + 1) for k in range(3)], rel=1e-3
    )


@pytest.mark.parametrize("spin", [1, -1])
def test_elastic_blocks_balance_and_thin_linings_bear_by_the_law(spin: int) -> None:
    brake = band(spin=spin)
    fem, rigid = drumlin.solve(brake), solve_brake_by_its_rigid_shoe_law(brake)
    assert fem.torque == pytest.approx(rigid.torque, rel=3e-3)
    assert picked(fem.shoes, "torque") == pytest.approx(picked(rigid.shoes, "torque"), rel=3e-3)
    assert max(fem.balance.force, fem.balance.moment) < 1e-9


def test_slopes_and_full_slip_of_a_chain() -> None:
    brake = band(thickness=5e-3)
    scene = prepared_model_with_finest_elements(brake, elements=20)
    torque = [
        drumlin.solve(vary(brake, {"friction": mu}), elements=20).torque
        for mu in (0.35, 0.3501, 0.3499)
    ]
    assert compute_torque_sensitivity(scene, brake).friction == pytest.approx(
        (torque[1] - torque[2]) / 2e-4, rel=1e-6
    )
    states = turn_holding_brake_and_return_states_at_rotations(
        scene, brake, np.array([0.0, find_drum_rotation_of_full_slip(scene, brake)])
    )
    assert states[-1].torque == pytest.approx(torque[0], rel=1e-9)


def test_the_file_wears_in_to_its_law(root: Path) -> None:
    brake = read_drum_or_plane_brake(root / "studies/brakes/band.toml")
    worn = drumlin.solve(brake, worn_in=True)
    assert worn.torque == pytest.approx(solve_brake_by_its_rigid_shoe_law(brake).torque, rel=1e-4)
    anchor, pull = np.linalg.norm(worn.shoes[-1].hinge_reaction), 2000.0
    assert worn.torque == pytest.approx((anchor - pull) * 0.267, rel=1e-8)


@pytest.mark.parametrize(
    ("links", "said"),
    [
        (
            [("b1", "b2"), ("b0", "b1")],
            "link[1].to = 'b1': must be a shoe that does not push another in a link before",
        ),
        (
            [("b0", "b1"), ("b1", "b0")],
            "link[1].to = 'b0': must be a shoe that does not push another in a link before",
        ),
        ([("b0", "b1"), ("b0", "b2")], "link[1].from = 'b0': bears on two struts"),
        ([("b0", "b2"), ("b1", "b2")], "link[1].to = 'b2': is pushed by two struts"),
        ([("b0", "b0")], "link[0].to = 'b0': must be a shoe that does not push another"),
    ],
)
def test_a_chain_is_named_from_the_actuation_on(links: list[tuple[str, str]], said: str) -> None:
    data = band().model_dump(by_alias=True)
    data["link"] = [{"from": a, "to": b} for a, b in links]
    with pytest.raises(BadInput) as error:
        make_drum_brake_from_data(data)
    assert said in str(error.value)
