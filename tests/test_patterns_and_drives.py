"""Shoes that repeat, brake chambers, wedges, cylinders with a threshold, and parking levers."""

import math
import tomllib
from pathlib import Path
from typing import Any

import pytest

import drumlin
from drumlin import BadInput, vary
from drumlin.brake import read_drum_or_plane_brake
from drumlin.brake.file import make_drum_brake_from_data
from drumlin.brake.plane_brake import make_drum_or_plane_brake_from_data
from drumlin.laws.rigid import solve_brake_by_rigid_shoe_law
from drumlin.laws.shapes import ratio_of_equivalent_to_lining_friction
from further_loads import moment, two_shoes

ROOT = Path(__file__).parents[1]
INCH, POUND = 0.0254, 4.4482216152605


def example(name: str) -> Any:
    """The brake of a file in studies/forces."""
    return read_drum_or_plane_brake(ROOT / "studies" / "forces" / f"{name}.toml")


# Patterns


def band_data() -> dict[str, Any]:
    """The data of the band of five blocks in studies/brakes."""
    return tomllib.loads((ROOT / "studies/brakes/band.toml").read_text(encoding="utf-8"))


def patterned_band(**pattern: Any) -> dict[str, Any]:
    """The same band from its first block alone, with a pattern."""
    data = band_data()
    data["shoe"] = [data["shoe"][0] | {"name": "block"}]
    del data["link"]
    data["shoe"][0]["pattern"] = {"count": 5, "step": "48 deg", "linked": True} | pattern
    return data


@pytest.mark.slow
def test_pattern_of_linked_blocks_is_the_band_that_was_written_out() -> None:
    """One table with a pattern against five tables and four links."""
    repeated = make_drum_brake_from_data(patterned_band(), unit_required=True)
    written = make_drum_brake_from_data(band_data(), unit_required=True)
    assert [shoe.name for shoe in repeated.shoes] == [f"block {k}" for k in range(1, 6)]
    assert [(link.source, link.to) for link in repeated.links] == [
        (f"block {k}", f"block {k + 1}") for k in range(1, 5)
    ]
    a = drumlin.solve(repeated, elements=8)
    b = drumlin.solve(written, elements=8)
    for one, other in zip(a.shoes, b.shoes, strict=True):
        assert one.torque == pytest.approx(other.torque, rel=1e-12)
        assert one.hinge_reaction == pytest.approx(other.hinge_reaction, rel=1e-10)


def test_repeated_brake_is_written_shoe_by_shoe_and_read_back(tmp_path: Path) -> None:
    """A written file has no pattern, and gives the same brake."""
    brake = make_drum_brake_from_data(patterned_band(), unit_required=True)
    drumlin.write_brake(brake, tmp_path / "band.toml")
    assert "pattern" not in (tmp_path / "band.toml").read_text(encoding="utf-8")
    assert drumlin.read_brake(tmp_path / "band.toml") == brake


def test_pattern_joins_links_and_shoes_that_are_written_out() -> None:
    """A last block of its own hangs on the last repeated block, whatever the order of the links."""
    data = patterned_band(count=4)
    data["shoe"].append(band_data()["shoe"][-1])
    data["link"] = [{"from": "block 4", "to": "last"}]
    brake = make_drum_brake_from_data(data, unit_required=True)
    assert brake.links[-1].to == "last"
    written = make_drum_brake_from_data(band_data(), unit_required=True)
    torques = [solve_brake_by_rigid_shoe_law(each).torque for each in (brake, written)]
    assert torques[0] == pytest.approx(torques[1], rel=1e-12)


def test_pattern_on_a_plane_moves_pads_along_it() -> None:
    """Pads that repeat along the plane are the same pads at other places."""
    data = tomllib.loads((ROOT / "studies/laws/pad.toml").read_text(encoding="utf-8"))
    (first,) = make_drum_or_plane_brake_from_data(data, unit_required=True).shoes
    data["shoe"][0]["pattern"] = {"count": 3, "step": "0.5 m"}
    pads = make_drum_or_plane_brake_from_data(data, unit_required=True).shoes
    assert [pad.lining.start - first.lining.start for pad in pads] == pytest.approx([0, 0.5, 1])
    assert [pad.pin.x - first.pin.x for pad in pads] == pytest.approx([0, 0.5, 1])
    assert [pad.pin.y for pad in pads] == [first.pin.y] * 3


@pytest.mark.parametrize(
    ("pattern", "text"),
    [
        ({"count": 1}, r"shoe\[0\].pattern.count = 1"),
        ({"count": 1000}, r"shoe\[0\].pattern.count = 1000"),
        ({"step": "0.1 m"}, r"shoe\[0\].pattern.step = '0.1 m': must be an angle"),
        ({"steps": 2}, r"unknown key 'steps'"),
    ],
)
def test_wrong_patterns_are_refused_by_their_key(pattern: dict[str, Any], text: str) -> None:
    """A pattern out of range gets no number."""
    with pytest.raises(BadInput, match=text):
        make_drum_brake_from_data(patterned_band(**pattern), unit_required=True)


def test_linked_pattern_needs_an_abutment() -> None:
    """A shoe on a hinge bears on no other shoe."""
    data = patterned_band()
    del data["shoe"][0]["abutment"]
    data["shoe"][0]["hinge"] = {"x": "0.3 m", "y": "0 m"}
    with pytest.raises(BadInput, match=r"shoe\[0\].pattern.linked"):
        make_drum_brake_from_data(data, unit_required=True)


# Drives


def force_of_drive(**drive: Any) -> float:
    """The force [N] of a cylinder, or the sum of a cam's or wedge's forces."""
    found = two_shoes(actuation=drive).actuation
    assert found is not None
    return found.force_of_cylinder_or_sum_of_cam_forces


CHAMBER = {"area": "30 in^2", "pressure": "100 psi"}


def test_chamber_and_slack_adjuster_have_the_numbers_in_print() -> None:
    """A chamber of type 30 at 100 psi pushes by 3000 lbf ("Driving commercial vehicles", p. 144).

    A slack adjuster of 6 in turns 1000 lbf into 6000 in lbf of torque on the cam (Bendix, figure
    16), and a chamber of 24 in^2 has 1440 lbf at 60 psi by the rule of the same page.
    """
    cam = force_of_drive(radius=0.5 * INCH, chamber=CHAMBER | {"lever": "6 in"})
    assert cam == pytest.approx(3000 * POUND * 6 / 0.5, rel=1e-12)
    small = {"area": "10 in^2", "pressure": "100 psi", "lever": "6 in"}
    assert force_of_drive(radius=1.0, chamber=small) == pytest.approx(6000 * POUND * INCH, rel=1e-9)
    middle = {"area": "24 in^2", "pressure": "60 psi", "lever": 1.0}
    assert force_of_drive(radius=1.0, chamber=middle) == pytest.approx(1440 * POUND, rel=1e-12)


def test_wedge_return_spring_threshold_and_efficiency() -> None:
    """Each face of a wedge of the angle a pushes by P/(2 tan(a/2)); a threshold takes its part."""
    P = 3000 * POUND - 200.0
    spring = CHAMBER | {"return_force": "200 N"}
    wedge = force_of_drive(wedge_angle="12 deg", chamber=spring, efficiency=0.9)
    assert wedge == pytest.approx(0.9 * 2 * P / (2 * math.tan(math.radians(6))), rel=1e-12)
    cylinder = force_of_drive(pressure=5e6, diameter=0.02, threshold="2 bar", efficiency=0.96)
    assert cylinder == pytest.approx(0.96 * 4.8e6 * math.pi * 1e-4, rel=1e-12)


def test_an_efficiency_above_one_is_asked_about() -> None:
    with pytest.raises(BadInput, match=r"efficiency = 75: must be less.*; did you mean '75 %'\?"):
        force_of_drive(pressure=5e6, diameter=0.02, efficiency=75)
    for wrong in (750, "much", True, [1]):
        with pytest.raises(BadInput, match=r"efficiency.*: must be (?!.*did you mean)"):
            force_of_drive(pressure=5e6, diameter=0.02, efficiency=wrong)


@pytest.mark.parametrize(
    ("drive", "text"),
    [
        ({"chamber": CHAMBER, "radius": 0.01}, "chamber.lever: is the slack adjuster of a cam"),
        ({"chamber": CHAMBER | {"lever": 0.1}, "wedge_angle": 0.2}, "chamber.lever: is the slack"),
        ({"chamber": CHAMBER}, "needs pressure and diameter"),
        ({"force": 1e3, "threshold": 1e5}, "threshold = 1 bar: must be less than the pressure"),
        ({"pressure": 1e5, "diameter": 0.02, "threshold": 1e5}, "threshold = 1 bar"),
        ({"chamber": CHAMBER | {"return_force": 1e6}, "wedge_angle": 0.2}, "return_force = 1e"),
    ],
)
def test_wrong_drives_are_refused(drive: dict[str, Any], text: str) -> None:
    """Keys that do not belong together, or a drive that does not push."""
    with pytest.raises(BadInput, match=text):
        two_shoes(actuation=drive)


LEVER = {
    "shoe": "left",
    "pivot": {"x": -0.06, "y": 0.09},
    "to": "right",
    "strut": {"x": -0.05, "y": 0.06},
    "end": {"x": 0.05, "y": 0.06},
    "force": 100.0,
    "direction": 0.0,
    "point": {"x": -0.05, "y": -0.06},
}


@pytest.mark.slow
def test_lever_and_strut_are_the_forces_of_its_statics() -> None:
    """The cable pulls 150 mm and the strut bears 30 mm below the pin: 500 N and 400 N."""
    levered = two_shoes(True, lever=[LEVER])
    data = two_shoes(True).model_dump(by_alias=True)
    data["shoe"][0]["force"] = [{"force": 500.0, "direction": 0.0, "point": LEVER["end"]}]
    data["shoe"][1]["force"] = [{"force": -400.0, "direction": 0.0, "point": LEVER["pivot"]}]
    plain = make_drum_brake_from_data(data)
    for solve in (solve_brake_by_rigid_shoe_law, drumlin.solve):
        a, b = solve(levered), solve(plain)
        for one, other in zip(a.shoes, b.shoes, strict=True):
            assert one.torque == pytest.approx(other.torque, rel=1e-9)
            assert one.hinge_reaction == pytest.approx(other.hinge_reaction, rel=1e-9)
        assert max(a.balance.force, a.balance.moment) < 1e-9


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"direction": math.pi}, "turns the lever away from its strut"),
        ({"to": "left"}, "to = 'left': must be another shoe"),
        ({"to": "x"}, r"lever\[0\].to = 'x': must be the name of a shoe"),
        ({"end": LEVER["strut"]}, "must not be the strut's point"),
    ],
)
def test_wrong_levers_are_refused(keys: dict[str, Any], text: str) -> None:
    """A strut can only push, from one shoe to another."""
    with pytest.raises(BadInput, match=text):
        two_shoes(lever=[LEVER | keys])


# The examples in studies/forces


@pytest.mark.slow
def test_centrifugal_clutch_has_the_torque_in_print() -> None:
    """Four shoes of 6 kg: 82.1 N m in print, by hand 4 mu (m w^2 r - S) R.

    A lining of 6 deg under the cosine pressure of a guided shoe has the ratio of equivalent
    friction in addition, 1.0005.
    """
    brake = example("centrifugal_clutch")
    speed = 400 * math.pi / 30
    by_hand = 4 * 0.35 * (6 * speed**2 * 0.160 - 1450) * 0.25
    assert by_hand == pytest.approx(82.1, rel=1e-3)
    law = solve_brake_by_rigid_shoe_law(brake)
    ratio = float(ratio_of_equivalent_to_lining_friction(math.radians(3)))
    assert law.torque == pytest.approx(by_hand * ratio, rel=1e-9)
    response = drumlin.solve(brake)
    assert response.torque == pytest.approx(law.torque, rel=2e-3)
    assert len(response.spring_pulls) == 4
    assert max(response.balance.force, response.balance.moment) < 1e-9
    # Below the speed at which the springs hold the shoes back, nothing touches.
    slow = vary(brake, {"shoe_speed": "360 rpm"})
    assert solve_brake_by_rigid_shoe_law(slow).torque == 0


def test_parking_lever_has_its_torque_by_hand() -> None:
    """Each shoe by its moment about its pin, from the lever's statics and the return spring."""
    brake = example("parking_lever")
    response = drumlin.solve(brake, "sine")
    strut = 250.0 * 145 / 25
    points = {"end": {"x": 0.080, "y": 0.060}, "pivot": {"x": -0.075, "y": 0.085}}
    spring = {"right": {"x": 0.070, "y": 0.075}, "left": {"x": -0.070, "y": 0.075}}
    loads = {"right": (strut, points["end"]), "left": (250.0 - strut, points["pivot"])}
    for shoe, name, pull in zip(response.shoes, loads, (-120.0, 120.0), strict=True):
        pin = {"x": math.copysign(0.020, -pull), "y": -0.100}
        force, point = loads[name]
        M = moment(force, 0.0, point, pin) + moment(pull, 0.0, spring[name], pin)
        assert shoe.torque == pytest.approx(abs(M) * mechanical_advantage(brake, name), rel=1e-9)


def mechanical_advantage(brake: Any, name: str) -> float:
    """The torque of a shoe over the moment at its pin by Shigley's integrals of the sine pressure.

    The pressure is p_a sin(phi), phi from the pin; M_n and M_f are the moments of pressure and
    friction about the pin, integrated here by the midpoint rule.
    """
    (shoe,) = (each for each in brake.shoes if each.name == name)
    R, mu, steps = brake.size, brake.friction, 20_000
    pin_radius, pin_angle = shoe.hinge.radius, shoe.hinge.angle
    first, last = shoe.lining.start, shoe.lining.end
    M_n = M_f = T = 0.0
    for k in range(steps):
        theta = first + (last - first) * (k + 0.5) / steps
        phi = theta - pin_angle
        weight = abs(math.sin(phi)) * (last - first) / steps
        M_n += weight * pin_radius * abs(math.sin(phi))
        M_f += weight * mu * (R - pin_radius * math.cos(phi))
        T += weight * mu * R
    # The drum turns counter-clockwise: it drags the right lining away from its pin, the left to it.
    sense = 1 if name == "left" else -1
    return T / (M_n - sense * M_f)


@pytest.mark.slow
def test_air_chamber_shares_its_force_by_cam_beside_the_return_spring() -> None:
    """Both forces add up to the chamber's over the cam, and the stiffer answer still balances."""
    brake = example("air_chamber")
    total = 0.75 * (3000 * POUND - 200) * 6 / 0.5
    for response in (solve_brake_by_rigid_shoe_law(brake), drumlin.solve(brake)):
        forces = [shoe.force for shoe in response.shoes]
        assert sum(map(float, forces)) == pytest.approx(total, rel=1e-9)
        assert max(response.balance.force, response.balance.moment) < 1e-9
