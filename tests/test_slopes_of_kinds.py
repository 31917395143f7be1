"""Derivatives of the torque for every kind of brake agree with differences of whole solves."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest

import drumlin
from conftest import ROOT, partly
from drumlin.brake.brake import Brake
from drumlin.brake.file import values_of_brake_key, vary
from drumlin.fem.analysis.sensitivity import (
    TorqueSensitivities,
    compute_torque_sensitivity,
    sensitivity_as_text_lines,
)
from drumlin.fem.preparation.prepare import make_prepared_model
from flat_pads import pad
from held_shoes import BODY, brake_of
from shared_forces import cam_brake, servo
from shared_parts import drum_ring

ELEMENTS = 8
THICK = {"shoe.lining.thickness": 0.005}
RING = drum_ring(0.01, "free")
PADS = {"shoe.lining.thickness": 0.008}
BODY_OF_PAD = {
    "thickness": 0.02,
    "width": 0.04,
    "start": 0.05,
    "end": 0.19,
    "material": {"E": 2.1e11, "nu": 0.3},
}
BRAKES: dict[str, Callable[[], Brake]] = {
    "rough abutment": lambda: vary(brake_of("rough abutment", -1, body=BODY), THICK),
    "abutment, trailing": lambda: vary(brake_of("abutment", 1, body=BODY), THICK),
    "pivot": lambda: vary(brake_of("pivot", 1, body=BODY), THICK | {"shoe.lining.clearance": 1e-5}),
    "guide": lambda: vary(brake_of("guide", 1, body=BODY), THICK),
    "guide on a ring": lambda: vary(brake_of("guide", -1, body=BODY), THICK | RING),
    "cam": lambda: cam_brake(body=0.012, thickness=0.006),
    "cam on a ring": lambda: vary(cam_brake(body=0.012, thickness=0.006), RING),
    "strut": lambda: vary(servo(body=0.02), THICK),
    "chain of struts": lambda: drumlin.read_brake(ROOT / "studies" / "brakes" / "band.toml"),
    "pad on a hinge": lambda: vary(pad("hinge", body=BODY_OF_PAD), PADS),
    "pad on a pivot": lambda: vary(pad("pivot", body=BODY_OF_PAD), PADS),
    "pad on an abutment": lambda: vary(pad("abutment", "-x", body=BODY_OF_PAD), PADS),
}


def slopes(brake: Brake) -> TorqueSensitivities:
    return compute_torque_sensitivity(make_prepared_model(brake, elements=ELEMENTS), brake)


def differences(brake: Brake, changes: Callable[[float], dict[str, Any]], step: float) -> float:
    """A finite difference of the fourth order."""

    def at(x: float) -> float:
        return drumlin.solve(vary(brake, changes(x)), elements=ELEMENTS).effect

    wide, narrow = ((at(s) - at(-s)) / (2 * s) for s in (2 * step, step))
    return (4 * narrow - wide) / 3


def moved(brake: Brake, i: int, key: str, way: Any) -> Callable[[float], dict[str, Any]]:
    part: Any = brake.shoes[i]
    for name in key.split("."):
        part = getattr(part, name)
    return lambda s: {f"shoe[{i}].{key}": {"x": part.x + s * way[0], "y": part.y + s * way[1]}}


def turned(brake: Brake, i: int, key: str) -> Callable[[float], dict[str, Any]]:
    part: Any = brake.shoes[i]
    for name in key.split("."):
        part = getattr(part, name)
    return lambda s: {f"shoe[{i}].{key}": part + s}


class Row(NamedTuple):
    """An exact slope, and the change of the brake whose solves give its difference.

    `changes` takes a step; `step` is its size, and `unit` divides the difference.
    """

    what: str
    exact: float
    changes: Callable[[float], dict[str, Any]]
    step: float
    unit: float = 1.0

    def near(self, brake: Brake) -> float:
        return differences(brake, self.changes, self.step) / self.unit


def scaled(key: str, value: float) -> Callable[[float], dict[str, Any]]:
    return lambda s: {key: value * (1 + s)}


def rows(brake: Brake, found: TorqueSensitivities) -> list[Row]:
    mu = brake.friction
    table = [Row("friction", found.friction, lambda s: {"friction": mu + s}, 1e-4)]
    if found.drive is not None:
        assert brake.actuation is not None
        table.append(
            Row(
                "actuation",
                found.drive,
                scaled("actuation.force", brake.actuation.force or 0.0),
                1e-3,
            )
        )
    if found.ring is not None:
        table.append(Row("ring", found.ring, scaled("drum.ring.material.E", 1.2e11), 1e-3))
    shoes: Any = brake.shoes
    for i, (shoe, own) in enumerate(zip(shoes, found.shoes, strict=True)):
        key, size, gap = f"shoe[{i}].", shoe.actuation.force, shoe.lining.clearance
        if own.force is not None:
            table.append(
                Row(f"{key}force", own.force, scaled(f"{key}actuation.force", size), 1e-3, size)
            )
        E, stiff = (
            values_of_brake_key(brake, f"{key}{part}.material.E")[0] for part in ("lining", "body")
        )
        table += [
            Row(f"{key}lining E", own.moduli["lining"], scaled(f"{key}lining.material.E", E), 1e-3),
            Row(f"{key}shoe E", own.moduli["shoe"], scaled(f"{key}body.material.E", stiff), 1e-3),
            Row(
                f"{key}clearance",
                own.clearance,
                lambda s, k=key, g=gap: {f"{k}lining.clearance": g + s},
                1e-8,
            ),
        ]
        for what, value in own.held.items():
            if len(value) == 1:
                table.append(Row(f"{key}{what}", float(value[0]), turned(brake, i, what), 2e-5))
                continue
            for way in np.eye(2):
                table.append(
                    Row(f"{key}{what} place", float(value @ way), moved(brake, i, what, way), 2e-5)
                )
    return table


UNITS = {"place": 10.0, "clearance": 1e4, "force": 1e-3}


def check(brake: Brake, row: Row, size: float) -> None:
    unit = next((value for key, value in UNITS.items() if row.what.endswith(key)), 1.0)
    assert row.exact == pytest.approx(row.near(brake), rel=2e-5, abs=2e-7 * size * unit), row.what


QUICK = {"rough abutment", "guide on a ring", "cam", "chain of struts", "pad on a pivot"}


@pytest.mark.parametrize("name", partly(BRAKES, QUICK))
@pytest.mark.slow
def test_the_slope_over_friction_is_that_of_differences(name: str) -> None:
    brake = BRAKES[name]()
    found = slopes(brake)
    size = drumlin.solve(brake, elements=ELEMENTS).effect
    assert found.torque == pytest.approx(size, rel=1e-9)
    check(brake, rows(brake, found)[0], size)
    for line in sensitivity_as_text_lines(found, brake):
        assert "\n" not in line and "law: none" not in line and " -0 " not in line


@pytest.mark.slow
@pytest.mark.parametrize("name", BRAKES)
def test_every_slope_of_every_kind_is_that_of_differences(name: str) -> None:
    brake = BRAKES[name]()
    found = slopes(brake)
    for row in rows(brake, found)[1:]:
        check(brake, row, found.torque)
