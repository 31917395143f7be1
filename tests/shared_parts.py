"""Parts of brakes and cases of sweeps that tests of several modules use."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from drumlin.brake.brake import Brake
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.response.response import Response
from drumlin.sweeps.cases import SweepCase


def drum_ring(thickness: float, support: str) -> dict[str, Any]:
    """The change that gives a brake an elastic cast-iron ring 40 mm wide for its drum.

    `thickness` is in metres; `support` is "fixed" or "free".
    """
    iron = {"E": 1.2e11, "nu": 0.25}
    return {
        "drum.ring": {"thickness": thickness, "width": 0.04, "material": iron, "support": support}
    }


def solve_on_elements_of_files(brake: Brake) -> Response:
    """The response of a brake on unrefined mesh files, by elements of the files' degree."""
    return solve_prepared_model(make_prepared_model(brake), brake)


def friction_cases(brake: Brake, frictions: Iterable[float], model: str = "sine") -> list[Any]:
    """The cases of a sweep over coefficients of friction."""
    return [SweepCase(brake, {"friction": mu}, model) for mu in frictions]


def modulus_slopes(found: Any) -> list[float]:
    """The derivatives of the torque by all moduli of all shoes, computed by `sensitivity`."""
    return [slope for shoe in found.shoes for slope in shoe.moduli.values()]


def of_shoes(key: str, values: Iterable[Any]) -> dict[str, Any]:
    """The changes that give one value of a key, such as "actuation.force", to each shoe."""
    return {f"shoe[{i}].{key}": value for i, value in enumerate(values)}


def scaled_pressures(shoes: Iterable[Any], factor: float) -> tuple[Any, ...]:
    """Responses of shoes with only the pressures multiplied by a factor."""
    return tuple(replace(shoe, pressure=factor * shoe.pressure) for shoe in shoes)
