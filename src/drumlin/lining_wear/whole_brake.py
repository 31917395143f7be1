"""Run a whole brake in: check the options, set the brake up, wear its linings, report the run.

The function `drumlin.wear` and the command `drumlin wear` call the functions of this module one
after the other. The method itself is in `drumlin.lining_wear.run_in` and
`drumlin.lining_wear.archard`.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.base.texts import error_text_in_percent
from drumlin.base.written_numbers import number_without_unit_from_text
from drumlin.brake.brake import Brake
from drumlin.brake.units import number_in_si_from_command_option_text
from drumlin.lining_wear.archard import (
    DEFAULT_PRESSURE_ERROR_OF_WEAR_STEP,
    WearLaw,
    WearState,
    require_wear_law_in_range,
)
from drumlin.lining_wear.linings import (
    WearSetup,
    wear_setup_by_finite_elements,
    wear_setup_by_foundation_model,
)
from drumlin.lining_wear.run_in import (
    DEFAULT_WEAR_COEFFICIENT,
    FinalWearPressureAndTorque,
    final_wear_pressure_and_torque_by_rigid_shoe_law,
    first_lining_worn_through,
    report_lines_of_wear_run,
    sliding_distance_of_e_fold_pressure_change,
    wear_brake_linings_until_worn_in,
    wear_run_as_json_data,
)

NAMES_OF_MODELS_WITH_WEAR = ("fem", "solid", "foundation")
"""The names of the models that can compute wear."""

LARGEST_WEAR_COEFFICIENT_WITHOUT_UNIT = 1e-9
"""Largest wear coefficient [1/Pa] that Python takes as a number without a unit.

At 1 MPa it wears 1 mm of a lining on each metre of sliding, 1e5 times as much as the default. A
larger number is in another unit, such as 1e-5 for 1e-5 mm^3/(N m), which is 1e-14 1/Pa.
"""


class StateOfWornLining(NamedTuple):
    """A lining in one state of a wear run.

    Attributes
    ----------
    name : name of the shoe
    lining : position of the lining on the shoe, 0 for the only lining
    theta : (n,) [rad], growing angles of the nodes; on a plane places x [m]
    depth : (n,) [m], worn depth at these angles; for solid shoes the mean over the width
    pressure : (n,) [Pa], pressure at these angles; for solid shoes the mean over the width
    """

    name: str
    lining: int
    theta: Floats
    depth: Floats
    pressure: Floats

    def __repr__(self) -> str:
        """The fields, where an array is shown by its shape alone."""
        shown = [
            f"{key}={value!r}" if isinstance(value, str | int) else f"{key}=array{value.shape}"
            for key, value in self._asdict().items()
        ]
        return f"StateOfWornLining({', '.join(shown)})"


@dataclass(frozen=True)
class WearRun:
    """The result of running a brake in: the states of its linings, and the end state of wear.

    Parameters
    ----------
    setup : the brake with the contact problems of its linings
    law : the wear law
    states : states of the linings at growing sliding distances, the unworn state first
    target : pressure [Pa] and torque [N m] to which wear tends
    step_tolerance : largest error of the pressure in a step of the wear (L2, relative)
    start_error : estimated relative errors of the unworn state, with the keys of `Response.error`;
        None where no error is estimated: for the models "solid" and "foundation", on elements of
        the user's choice, and at a held torque
    ended : why the run ends before the distance asked for, or before the linings are worn in; ""
        if it does not
    notes : how a distance without a unit is understood
    """

    setup: WearSetup
    law: WearLaw
    states: tuple[WearState, ...]
    target: FinalWearPressureAndTorque
    step_tolerance: float = DEFAULT_PRESSURE_ERROR_OF_WEAR_STEP
    start_error: Mapping[str, float] | None = None
    ended: str = ""
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        """The lines of `lines`, with the notes above and the reason of an early end below."""
        ended = [f"ended: {self.ended}"] if self.ended else []
        return "\n".join([*self.notes, *self.lines(), *ended])

    def linings(self, state: WearState) -> tuple[StateOfWornLining, ...]:
        """Each lining in a state of this run: shoe, angles, worn depth and pressure.

        The linings are in the order of the shoes. The arrays of the state itself have the nodes of
        all linings.
        """
        linings = []
        for surface in self.setup.surfaces:
            lining = StateOfWornLining(
                surface.name,
                surface.lining,
                surface.contact_angles_in_growing_order,
                surface.lining_values_by_growing_angle(state.depth),
                surface.lining_values_by_growing_angle(state.pressure),
            )
            linings.append(lining)
        return tuple(linings)

    def as_dict(self) -> dict[str, Any]:
        """The run as plain data for JSON, in SI; the keys are those of `drumlin wear --json`."""
        data = wear_run_as_json_data(self.setup, self.states, self.target, self.law)
        error = None if self.start_error is None else dict(self.start_error)
        ended = {"ended": self.ended} if self.ended else {}
        return {**data, "start_error": error, "step_tolerance": self.step_tolerance, **ended}

    def lines(self) -> list[str]:
        """The run as lines of text: a table of some states, and the life of the linings."""
        lines = report_lines_of_wear_run(self.setup, self.states, self.target, self.law)
        step = f"each step of wear: p at most {error_text_in_percent(self.step_tolerance)} (L2)"
        if self.start_error is None:
            unknown = "estimated error: not known on chosen elements and at a held torque"
            return [*lines, f"{unknown}; {step}"]
        start = self.start_error
        return [
            *lines,
            f"estimated error of the unworn state: p {error_text_in_percent(start['pressure'])} "
            f"(L2), {self.setup.brake.surface.word_for_torque_or_brake_force} "
            f"{error_text_in_percent(start['torque'])}; {step}",
        ]


class WearSetupsOfBothRotations(NamedTuple):
    """The contact problems for wear of a brake's linings, for both directions of rotation.

    Attributes
    ----------
    forward : setup for the drum turning as the brake file states
    backward : setup for the drum turning the other way; None if the drum never does
    start_error : estimated relative errors of the unworn state, see `WearRun`; None if the model or
        the elements have no estimate
    """

    forward: WearSetup
    backward: WearSetup | None
    start_error: Mapping[str, float] | None = None


def require_options_of_wear_model(
    model: str, on_mesh: Mapping[str, Any], on_springs: Mapping[str, Any]
) -> None:
    """Raise BadInput for a model that cannot compute wear, or for options of another model.

    Parameters
    ----------
    model : name of the model
    on_mesh : options of the user, by name, that only finite elements have
    on_springs : options of the user, by name, that only the foundation model has
    """
    if model not in NAMES_OF_MODELS_WITH_WEAR:
        allowed = ", ".join(NAMES_OF_MODELS_WITH_WEAR)
        raise BadInput(f"--model = {model!r}: does not wear; allowed: {allowed}")
    foreign = on_mesh if model == "foundation" else on_springs
    if foreign:
        raise BadInput(
            "--elements and --kind belong to --model fem, --guided to fem and solid, "
            "--sections and --lift to foundation"
        )


def make_wear_law(coefficient: float | str | None, exponent: float) -> WearLaw:
    """Make the wear law from a wear coefficient and the exponent of the pressure.

    The coefficient is a number [1/Pa], a text with a unit, or None for DEFAULT_WEAR_COEFFICIENT.
    Raises BadInput for a coefficient or an exponent out of range, and for a number above
    LARGEST_WEAR_COEFFICIENT_WITHOUT_UNIT.
    """
    number = coefficient
    if number is None:
        number = DEFAULT_WEAR_COEFFICIENT
    elif isinstance(number, str):
        number = number_in_si_from_command_option_text("--coefficient", number, "1/Pa")
    law = WearLaw(number, exponent)
    require_wear_law_in_range(law)
    if isinstance(coefficient, int | float) and number > LARGEST_WEAR_COEFFICIENT_WITHOUT_UNIT:
        raise BadInput(
            f"--coefficient = {coefficient:g}: a number is in 1/Pa, and must be at most "
            f'{LARGEST_WEAR_COEFFICIENT_WITHOUT_UNIT:g}; did you mean "{coefficient:g} mm^3/(N m)"?'
        )
    return law


def make_wear_setups_of_brake(
    brake: Brake, model: str, *, both_ways: bool, **options: Any
) -> WearSetupsOfBothRotations:
    """Set up the wear of a brake's linings, on the same mesh for both directions of rotation.

    Parameters
    ----------
    brake : the brake
    model : name of the model, "fem", "solid" or "foundation"
    both_ways : whether a setup is also made for the drum turning the other way
    options : options of `prepared_model_for_hold_wear_or_sensitivity` for "fem" and "solid", and
        options of `wear_setup_by_foundation_model` for "foundation"

    Raises
    ------
    BadInput
        for an option out of range
    NoAnswer
        if the linings do not touch the drum, or if there is no equilibrium
    """
    turned_back = brake.brake_with_reversed_motion() if both_ways else None
    if model == "foundation":
        forward = wear_setup_by_foundation_model(brake, **options)
        backward = (
            None if turned_back is None else wear_setup_by_foundation_model(turned_back, **options)
        )
        return WearSetupsOfBothRotations(forward, backward)
    # The imports take long, and only finite elements need them.
    from drumlin.fem.analysis.prepared import prepared_model_for_hold_wear_or_sensitivity  # noqa: PLC0415
    from drumlin.fem.solve import finest_prepared_model_with_stated_errors  # noqa: PLC0415

    error = None
    if model == "fem":
        scene, error = finest_prepared_model_with_stated_errors(brake, **options)
    else:
        scene = prepared_model_for_hold_wear_or_sensitivity(brake, model, **options)
    forward = wear_setup_by_finite_elements(scene, brake)
    backward = None if turned_back is None else wear_setup_by_finite_elements(scene, turned_back)
    return WearSetupsOfBothRotations(forward, backward, error)


def sliding_distance_from_option(option: str, given: float | str, unit: float) -> float:
    """Convert the value of an option, a number or a text, to a sliding distance [m].

    Parameters
    ----------
    option : name of the option, for an error message
    given : number of metres, or a text such as "20 km"; a text without a unit is a multiple of
        `unit`
    unit : distance 1/(k K) [m], see `sliding_distance_of_e_fold_pressure_change`

    Raises
    ------
    BadInput
        for a text that is no number, with or without a unit, and for inf and nan
    """
    try:
        number: Any = number_without_unit_from_text(given)
    except ValueError as error:
        raise BadInput(f"{option} = {given!r}: {error}") from error
    if isinstance(number, str) and number.strip(" +-").lower() in {"inf", "infinity", "nan"}:
        number = math.inf
    if isinstance(number, str):
        return number_in_si_from_command_option_text(option, number, "m")
    if not math.isfinite(number):
        raise BadInput(f"{option} = {given!r}: must be finite")
    return number * unit if isinstance(given, str) else number


def _note_on_distance_without_unit(option: str, given: float | str, unit: float) -> list[str]:
    """A note, as a list of one line, on a distance that is a text without a unit; else no note.

    The parameters are those of `sliding_distance_from_option`.
    """
    if not isinstance(given, str):
        return []
    try:
        kilometres = float(given) * unit * 1e-3
    except ValueError:
        return []
    return [f"{option} = {given!r} has no unit: {given} times 1/(k K), {kilometres:.5g} km"]


def wear_linings_of_whole_brake(
    setups: WearSetupsOfBothRotations,
    law: WearLaw,
    *,
    distance: float | str | None = None,
    reverse: float | str | None = None,
    torque: float | None = None,
    tolerance: float | None = None,
) -> WearRun:
    """Wear the linings of a brake over a distance, or until they are worn in.

    The run ends where a lining is worn through, and `WearRun.ended` says so.

    Parameters
    ----------
    setups : wear setups of the brake; with `reverse`, also for the other direction of rotation
    law : the wear law
    distance : sliding distance [m], or a text such as "20 km" (a text without a unit is a multiple
        of 1/(k K)); None to wear until pressure and torque hardly differ from their final values
    reverse : sliding distance, given like `distance`, after which the drum turns the other way,
        again and again; None for one direction
    torque : torque [N m] that the actuation is adjusted to keep; None for a constant actuation
    tolerance : largest error of the pressure in a step (L2 norm, relative); None for the default

    Raises
    ------
    BadInput
        for an option out of range
    NoAnswer
        for no equilibrium, no convergence, and self-locking
    """
    setup, backward, start_error = setups
    unit = sliding_distance_of_e_fold_pressure_change(setup, law)
    # Options that are None are left out, so that `wear_brake_linings_until_worn_in` uses its
    # defaults.
    given = {"tolerance": tolerance, "torque": torque}
    options: dict[str, Any] = {key: value for key, value in given.items() if value is not None}
    notes: list[str] = []
    for name, value in (("distance", distance), ("reverse", reverse)):
        notes += [] if value is None else _note_on_distance_without_unit(name, value, unit)
    if reverse is not None:
        options["reverse"] = sliding_distance_from_option("--reverse", reverse, unit)
    if distance is not None:
        options["distance"] = sliding_distance_from_option("--distance", distance, unit)
    states = wear_brake_linings_until_worn_in(setup, law, backward=backward, **options)
    worn_through = first_lining_worn_through(setup, states)
    if worn_through is not None:
        # The run is repeated so that its last state is the one in which the lining is gone.
        options["distance"] = worn_through.distance
        states = wear_brake_linings_until_worn_in(setup, law, backward=backward, **options)
    # The final pressure depends on the pulls of the springs. The pulls still change in the last
    # state, and the final pressure is computed for the pulls of this state.
    if setup.at_constant_pulls is not None:
        setup = setup.at_constant_pulls(states[-1].pulls)
    goal = final_wear_pressure_and_torque_by_rigid_shoe_law(setup, law, torque)
    # A held torque changes the actuation of the unworn state, and with it the contact.
    error = start_error if torque is None else None
    step_error = tolerance or DEFAULT_PRESSURE_ERROR_OF_WEAR_STEP
    ended = "" if worn_through is None else worn_through.reason
    return WearRun(setup, law, tuple(states), goal, step_error, error, ended, tuple(notes))
