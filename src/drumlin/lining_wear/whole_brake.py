"""Running in from a brake to its worn states: both ways of turning are set up, worn and reported.

`drumlin.wear` and the command `drumlin wear` call these steps in their order. The method itself is
in `drumlin.lining_wear.run_in` and `drumlin.lining_wear.archard`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake
from drumlin.brake.units import quantity
from drumlin.lining_wear.archard import WearLaw, WearState
from drumlin.lining_wear.linings import WearSetup, fem_wear_setup, foundation_wear_setup
from drumlin.lining_wear.run_in import (
    COEFFICIENT,
    WearTarget,
    check_worn_depth,
    report_lines,
    rigid_law_target,
    run_in,
    unit_sliding_distance,
    wear_run_data,
)

WEARING_MODELS = ("fem", "foundation")
"""The names of the models whose linings can wear."""


@dataclass(frozen=True)
class WearRun:
    """A brake that was run in.

    Parameters
    ----------
    setup : the brake, and where its linings lie among the unknowns
    law : the law of wear
    states : the states of the linings, from the unworn one on
    target : pressure [Pa] and torque [N m] at the end of wear
    notes : lines about the brake that was worn, such as its correction for finite width
    """

    setup: WearSetup
    law: WearLaw
    states: tuple[WearState, ...]
    target: WearTarget
    notes: tuple[str, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """The run as plain data for JSON, in SI; the keys are those of `drumlin wear --json`."""
        return wear_run_data(self.setup, self.states, self.target, self.law)

    def lines(self) -> list[str]:
        """The run as lines of text: the notes, some of the states, and the life of the linings."""
        return [*self.notes, *report_lines(self.setup, self.states, self.target, self.law)]


class WearSetups(NamedTuple):
    """The setup of a brake that turns as its file says, and of the same brake turning back."""

    forward: WearSetup
    backward: WearSetup | None


def check_wear_options(
    model: str, on_mesh: Mapping[str, Any], on_springs: Mapping[str, Any]
) -> None:
    """Raise BadInput for a model that does not wear, or for an option of the other model.

    Parameters
    ----------
    model : name of the model
    on_mesh : the options given that only finite elements take
    on_springs : the options given that only the foundation model takes
    """
    if model not in WEARING_MODELS:
        allowed = ", ".join(WEARING_MODELS)
        raise BadInput(f"--model = {model!r}: does not wear; allowed: {allowed}")
    foreign = on_springs if model == "fem" else on_mesh
    if foreign:
        raise BadInput(
            "--elements, --kind, --guided and --finite-width belong to --model fem, "
            "--sections and --lift to foundation"
        )


def make_wear_law(coefficient: float | str | None, exponent: float) -> WearLaw:
    """Archard's law with a coefficient [1/Pa], or its text with a unit; by default COEFFICIENT."""
    if coefficient is None:
        return WearLaw(COEFFICIENT, exponent)
    if isinstance(coefficient, str):
        return WearLaw(quantity("--coefficient", coefficient, "1/Pa"), exponent)
    return WearLaw(coefficient, exponent)


def wear_setups(brake: Brake, model: str, *, both_ways: bool, **options: Any) -> WearSetups:
    """Set a brake up to be worn by a model, on one mesh for both ways of turning.

    Parameters
    ----------
    brake : the brake
    model : "fem" or "foundation"
    both_ways : whether the drum also turns back
    options : those of the model, see `prepare_finest_division` and `foundation_wear_setup`

    Raises
    ------
    BadInput
        for an option out of range
    NoAnswer
        for a brake whose linings do not touch the drum, or that has no equilibrium
    """
    turned_back = brake.reversed() if both_ways else None
    if model == "foundation":
        forward = foundation_wear_setup(brake, **options)
        backward = None if turned_back is None else foundation_wear_setup(turned_back, **options)
        return WearSetups(forward, backward)
    # Only finite elements need this import, which takes longest.
    from drumlin.fem.solve import prepare_finest_division  # noqa: PLC0415

    scene = prepare_finest_division(brake, **options)
    forward = fem_wear_setup(scene, brake)
    backward = None if turned_back is None else fem_wear_setup(scene, turned_back)
    return WearSetups(forward, backward)


def sliding_distance(option: str, given: float | str, unit: float) -> float:
    """A sliding distance [m] from a number [m] or from a text.

    Parameters
    ----------
    option : name of the option, for the message
    given : number of metres, or a text such as "20 km"; a text without a unit is a multiple of
        `unit`
    unit : the distance 1/(k K) [m] over which wear changes the pressure by a factor e

    Raises
    ------
    BadInput
        for a text that is no number, with or without a unit
    """
    if not isinstance(given, str):
        return given
    try:
        return float(given) * unit
    except ValueError:
        return quantity(option, given, "m")


def run_wear(
    setups: WearSetups,
    law: WearLaw,
    *,
    distance: float | str | None = None,
    reverse: float | str | None = None,
    torque: float | None = None,
    tolerance: float | None = None,
    notes: Sequence[str] = (),
) -> WearRun:
    """Wear a brake that is set up, over a distance or until it is settled.

    Parameters
    ----------
    setups : the brake, and with `reverse` the brake turning back
    law : the law of wear
    distance : sliding distance, see `sliding_distance`; None: until p and torque are settled
    reverse : sliding distance after which the drum turns back, again and again
    torque : torque [N m] that the actuation holds; None: the actuation stays
    tolerance : relative error of p (L2) of a step
    notes : lines that the run keeps for its report

    Raises
    ------
    BadInput
        for an option out of range
    NoAnswer
        for no equilibrium, no convergence, self-locking, a lining that is worn through
    """
    setup, backward = setups
    unit = unit_sliding_distance(setup, law)
    # Options that are not given keep the defaults of `run_in`.
    given = {"tolerance": tolerance, "torque": torque}
    options: dict[str, Any] = {key: value for key, value in given.items() if value is not None}
    if reverse is not None:
        options["reverse"] = sliding_distance("--reverse", reverse, unit)
    if distance is not None:
        options["distance"] = sliding_distance("--distance", distance, unit)
    states = run_in(setup, law, backward=backward, **options)
    check_worn_depth(setup, states)
    goal = rigid_law_target(setup, law, torque)
    return WearRun(setup, law, tuple(states), goal, tuple(notes))
