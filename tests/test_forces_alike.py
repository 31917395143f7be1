"""Mirror images, other units, other sizes and other orders of shoes of brakes with every force."""

import math
from collections.abc import Callable
from typing import Any

import pytest

import drumlin
from anchored_shoes import duo_servo
from drumlin.brake.brake import Brake
from drumlin.brake.file import make_drum_brake_from_data, vary
from drumlin.fem.solve import solve
from drumlin.response.response import Response
from friction_tables import FALLING
from further_loads import BODY, FORCE, PULL, brake_with, two_shoes

Data = dict[str, Any]
"""The data of a brake file, in SI units."""
MASS = {"mass": 4.0, "point": {"x": 0.09, "y": 0.01}}
ACROSS = PULL | {"point": {"x": 0.05, "y": 0.07}, "end": {"x": -0.05, "y": 0.07}}
HEATED = {
    "shoe.lining.temperature_rise": 150.0,
    "shoe.lining.material.expansion": 3e-5,
    "drum.temperature_rise": 100.0,
    "drum.expansion": 1.1e-5,
}
WEDGE = {
    "wedge_angle": 0.2,
    "chamber": {"area": 1e-3, "pressure": 6e5, "return_force": 50.0},
    "efficiency": 0.9,
}
BRAKES: dict[str, Callable[[], Brake]] = {
    "force": lambda: brake_with(body=BODY, force=[FORCE]),
    "weight": lambda: brake_with(body=BODY, mass=MASS, brake={"gravity": {"direction": -1.5}}),
    "centrifugal": lambda: brake_with(body=BODY, mass=MASS, brake={"shoe_speed": 60.0}),
    "clutch": lambda: drumlin.example("centrifugal_clutch"),
    "spring": lambda: two_shoes(True, spring=[PULL | {"rate": 1e6}]),
    "chamber": lambda: drumlin.example("air_chamber"),
    "wedge": lambda: two_shoes(True, actuation=WEDGE),
    "lever": lambda: drumlin.example("parking_lever"),
    "anchors and spring": lambda: vary(duo_servo(), {"spring": [ACROSS | {"rate": 1e6}]}),
    "friction over pressure": lambda: vary(two_shoes(True), {"friction": FALLING}),
    "heat": lambda: vary(two_shoes(True), HEATED),
}
"""A brake for each kind of force, support, friction or heat."""

LENGTHS = ("x", "y", "radius", "thickness", "width", "diameter", "lever", "clearance")
FORCES = ("force", "preload", "return_force")
STRESSES = ("E", "pressure", "threshold")
ANGLES = ("direction", "start", "end", "wedge_angle")


def data_of_brake(brake: Brake) -> Data:
    """The data of a brake as in its file, without the forces that its drive computes."""
    data: Data = brake.model_dump(by_alias=True, exclude_none=True, exclude_defaults=True)
    if "actuation" in data:
        for shoe in data["shoe"]:
            shoe["actuation"].pop("force", None)
    else:
        # A force of 0 is the default of a solved brake, while a file must give it.
        for shoe in data["shoe"]:
            if "actuation" in shoe:
                shoe["actuation"].setdefault("force", 0.0)
    return data


def changed(node: Any, change: Callable[[str, float], Any], key: str = "") -> Any:
    """A copy of data in which `change` of the key and of the number replaces each number."""
    if isinstance(node, dict):
        return {name: changed(value, change, name) for name, value in node.items()}
    if isinstance(node, list | tuple):
        return [changed(value, change, key) for value in node]
    is_number = isinstance(node, int | float) and not isinstance(node, bool)
    return change(key, node) if is_number else node


def mirrored(node: Any) -> Any:
    """The data of the mirror image: x becomes -x, the drum turns the other way."""
    if isinstance(node, list | tuple):
        return [mirrored(value) for value in node]
    if not isinstance(node, dict):
        return node
    other = {key: mirrored(value) for key, value in node.items()}
    if "x" in node:
        other["x"] = -node["x"]
    if "direction" in node:
        other["direction"] = math.pi - node["direction"]
    if isinstance(node.get("start"), float):
        other["start"], other["end"] = math.pi - node["end"], math.pi - node["start"]
    if "rotation" in node:
        senses = {"clockwise": "counter-clockwise", "counter-clockwise": "clockwise"}
        other["rotation"] = senses[node["rotation"]]
    return other


def in_other_units(key: str, value: float) -> Any:
    """A number in inches, pounds-force, pounds-force per square inch, N/mm or degrees, as text."""
    if key in LENGTHS:
        return f"{value / 0.0254!r} in"
    if key in FORCES:
        return f"{value / 4.4482216152605!r} lbf"
    if key in STRESSES:
        return f"{value / 6894.757293168361!r} psi"
    if key == "rate":
        return f"{value * 1e-3!r} N/mm"
    return f"{math.degrees(value)!r} deg" if key in ANGLES else value


def enlarged(weighs: bool) -> Callable[[str, float], float]:
    """A change to a brake of twice the size whose stresses are three times as high.

    `weighs` is whether its masses have weight, which grows otherwise than the centrifugal force.
    """
    L, S = 2.0, 3.0
    factors = dict.fromkeys(LENGTHS, L) | dict.fromkeys(FORCES, S * L**2)
    factors |= dict.fromkeys(STRESSES, S) | {"area": L**2, "rate": S * L}
    factors |= {"mass": S * L**2 if weighs else S * L}
    return lambda key, value: factors.get(key, 1.0) * value


def solved(data: Data) -> Response:
    """The response of a brake on eight elements along each lining, with its balance checked."""
    response = solve(make_drum_brake_from_data(data), elements=8)
    assert max(response.balance.force, response.balance.moment) < 1e-9
    return response


def torques(response: Response) -> dict[str, float]:
    """The torque of each shoe by its name."""
    return {shoe.name: shoe.torque for shoe in response.shoes}


def peaks(response: Response) -> dict[str, float]:
    """The peak pressure of each shoe by its name."""
    return {shoe.name: shoe.peak_pressure for shoe in response.shoes}


@pytest.mark.parametrize("name", BRAKES)
def test_mirror_units_size_and_order_change_no_answer(name):
    data = data_of_brake(BRAKES[name]())
    one = solved(data)
    assert one.torque > 0
    heated = name == "heat"
    changes = {
        "mirror": (mirrored(data), 1.0, 1.0),
        "order": (data | {"shoe": data["shoe"][::-1]}, 1.0, 1.0),
        "units": (changed(data, in_other_units), 1.0, 1.0),
    }
    if not heated:
        # Strains by heat do not grow with the stresses.
        changes["size"] = (changed(data, enlarged(name == "weight")), 24.0, 3.0)
    for what, (other, of_torque, of_pressure) in changes.items():
        found = solved(other)
        assert torques(found) == pytest.approx(
            {shoe: of_torque * torque for shoe, torque in torques(one).items()}, rel=1e-9
        ), what
        assert peaks(found) == pytest.approx(
            {shoe: of_pressure * peak for shoe, peak in peaks(one).items()}, rel=1e-8
        ), what
