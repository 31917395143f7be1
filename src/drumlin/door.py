"""The public functions of drumlin; most take a `Brake` or the path of a brake file.

The command line calls the same functions. Each function imports the package that does its work only
when it is called, so that `import drumlin` is fast.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import wraps
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, ParamSpec, TypeVar

from drumlin.base.errors import BadInput, DrumlinError, NoAnswer

if TYPE_CHECKING:
    from drumlin.brake.brake import Brake
    from drumlin.brake.surface import FrictionSurface
    from drumlin.comparison import ModelComparison
    from drumlin.fem.analysis.fields import StressAndDisplacementFields
    from drumlin.fem.analysis.holding import HoldingState
    from drumlin.fem.analysis.sensitivity import TorqueSensitivities
    from drumlin.laws.own import PressureShapeFunction
    from drumlin.lining_wear.whole_brake import WearRun
    from drumlin.models import Model
    from drumlin.response.response import Response
    from drumlin.sizing import SizingResult
    from drumlin.sweeps.sweep_table import SweepTable
    from drumlin.verification.check import DeviationOfCurveFromReference
    from drumlin.verification.reference import ReferenceValuesOfBrake

    BrakeOrPath = Brake | Path | str

MAX_ROTATION_INCREMENTS_OF_HOLD = 10_000
"""Largest number of increments in which `hold` turns the drum.

The states of so many increments fill some 100 MB of JSON.
"""

LARGEST_ROTATION_OR_SLIDE_OF_HOLD_BY_UNIT = {"rad": 2 * math.pi, "m": 1.0}
"""Largest rotation of a drum and largest slide on a plane for `hold`, by their SI units.

A turn that is rounded up to six digits, 6.28319, is still taken.

Brakes slip as a whole after some 0.03 degrees or 0.1 mm, and their moment is constant afterwards.
Up to 100 rad the moment of the double-shoe and of the duplex brake keeps 12 digits. Round-off
changes it by some 1e-6 of its value at 1e4 rad, by 0.1 percent at 1e5 rad, and by 0.5 to 27
percent at 1e7 rad.
"""

LARGEST_EXCESS_OF_ROUNDED_UP_ROTATION = 1e-6
"""Relative excess of a rotation over the largest one that counts as rounding.

A turn of 2 pi = 6.2831853 that a user rounds up to six digits, 6.28319, exceeds it by 7e-7.
"""

FunctionThatShowsProgressText = Callable[[str], None]
"""The type of a function that shows the user a line about the progress of a computation."""


def _ignore_text_about_progress(_: str) -> None:
    """Ignore a line about the progress of a computation."""


# Type variables for the arguments and the result of a public function.
FunctionArguments = ParamSpec("FunctionArguments")
FunctionResult = TypeVar("FunctionResult")


def _make_public_function_that_rewords_errors(
    function: Callable[FunctionArguments, FunctionResult],
) -> Callable[FunctionArguments, FunctionResult]:
    """Make a public function whose errors name its arguments, not options of the command line.

    The packages that do the work write their messages for the command line. The command line calls
    the same public functions, and prints the original messages.
    """
    parameters = inspect.signature(function).parameters
    annotations = {name: str(parameter.annotation) for name, parameter in parameters.items()}

    @wraps(function)
    def call_function_and_reword_errors(
        *arguments: FunctionArguments.args, **options: FunctionArguments.kwargs
    ) -> FunctionResult:
        """Call the function, and name Python arguments in the errors that it raises."""
        try:
            given = _arguments_with_annotated_types(annotations, arguments, options)
            return function(*given.in_order, **given.by_name)
        except DrumlinError as error:
            error.replace_options_by_python_arguments_in_message()
            # A traceback shows the line alone. The errors that led to it stay in `__context__`.
            if error.__cause__ is error.__context__:
                error.__cause__ = None
            raise

    return call_function_and_reword_errors


def _make_public_function_that_solves(
    function: Callable[FunctionArguments, FunctionResult],
) -> Callable[FunctionArguments, FunctionResult]:
    """Make a public function that solves brakes with one thread for linear algebra.

    A number of threads that the user has set by an environment variable stays.
    """

    @wraps(function)
    def call_function_with_one_thread(
        *arguments: FunctionArguments.args, **options: FunctionArguments.kwargs
    ) -> FunctionResult:
        """Call the function while the BLAS has one thread."""
        from drumlin.base.threads import one_blas_thread_unless_user_set_number

        with one_blas_thread_unless_user_set_number():
            return function(*arguments, **options)

    return _make_public_function_that_rewords_errors(call_function_with_one_thread)


class _GivenArguments(NamedTuple):
    """The arguments of a call: those that are given in their order, and those given by name."""

    in_order: list[Any]
    by_name: dict[str, Any]


def _arguments_with_annotated_types(
    annotations: Mapping[str, str], arguments: Sequence[object], options: Mapping[str, object]
) -> _GivenArguments:
    """The arguments of a call, each converted to the type that its annotation says.

    Parameters
    ----------
    annotations : annotations of the function's parameters by their names
    arguments : values of the first parameters, which are given without names
    options : the arguments that are given by name

    Raises
    ------
    BadInput
        for an argument of another type than its annotation says, and for integers that no
        floating-point number can hold
    """
    # Too many arguments are left to Python, which refuses them when it calls the function.
    names = [*annotations, *("" for _ in arguments[len(annotations) :])]
    return _GivenArguments(
        [
            _argument_with_annotated_type(name, value, annotations.get(name))
            for name, value in zip(names, arguments, strict=False)
        ],
        {
            name: _argument_with_annotated_type(name, value, annotations.get(name))
            for name, value in options.items()
        },
    )


def _argument_with_annotated_type(name: str, value: object, annotation: str | None) -> object:
    """The value of an argument, converted to its annotated type; None for no annotation.

    Raises BadInput for another type, and for an integer that no floating-point number can hold.
    """
    from drumlin.base.python_arguments import argument_with_annotated_type
    from drumlin.base.texts import check_integers_have_few_digits

    try:
        check_integers_have_few_digits(name, value)
    except ValueError as error:
        raise BadInput(str(error)) from None
    return value if annotation is None else argument_with_annotated_type(name, value, annotation)


class _BrakeWithFileText(NamedTuple):
    """A brake with the text of its file.

    Attributes
    ----------
    brake : the brake
    text : text of its brake file
    folder : folder of the brake file; None for a brake that was not read from a file
    command : command that computes reference values of this brake, for a report
    """

    brake: Brake
    text: str
    folder: Path | None
    command: str


def _brake_itself_or_read_from_file(brake: BrakeOrPath) -> Brake:
    """Return the brake; if `brake` is the path of a brake file, read the brake from this file.

    Raises BadInput for any other argument.
    """
    from drumlin.brake.plane_brake import brake_itself_or_read_from_file

    return brake_itself_or_read_from_file(brake)


def _brake_with_text_of_its_file(brake: BrakeOrPath) -> _BrakeWithFileText:
    """Return a brake with the text of its brake file.

    For a brake that was not read from a file, the text is the text that `write_brake` writes.
    """
    from drumlin.base.texts import command_text_without_folders
    from drumlin.brake import read_drum_or_plane_brake
    from drumlin.brake.file import read_text_of_brake_file
    from drumlin.brake.writing import brake_file_text

    # A brake that was not read from a file has no folder in which reference values could lie.
    if not isinstance(brake, str | Path):
        return _BrakeWithFileText(brake, brake_file_text(brake), None, "drumlin.reference(brake)")
    path = Path(brake)
    text = read_text_of_brake_file(path)
    command = command_text_without_folders(["drumlin", "reference", str(path)])
    return _BrakeWithFileText(read_drum_or_plane_brake(path, text), text, path.parent, command)


def _solver_options_given_by_user(**options: Any) -> dict[str, Any]:
    """Return the options whose value is neither None nor False, with their names as keys."""
    from drumlin.models import model_options_given_by_user

    return model_options_given_by_user(**options)


def _value_of_function_option_in_si(option: str, value: float | str, unit: str) -> float:
    """Convert the value of an option to a number in SI units.

    `value` is a number, which is in SI units already, or a text with a unit. `option` is the name
    of the option in an error message.
    """
    from drumlin.brake.units import number_in_si_from_command_option_text

    return (
        number_in_si_from_command_option_text(option, value, unit)
        if isinstance(value, str)
        else value
    )


def _fraction_from_number_or_percentage(option: str, value: float | str) -> float:
    """The fraction that an option gives as a number, such as 0.05, or as a text such as "5 %".

    Raises BadInput for another text, and for a number that has two readings; `option` is the name
    of the option in the message.
    """
    from drumlin.base.written_numbers import number_without_unit_from_text

    try:
        number = number_without_unit_from_text(value)
        if isinstance(number, str):
            raise ValueError('must be a fraction such as 0.05, or a text such as "5 %"')
    except ValueError as error:
        raise BadInput(f"{option} = {value!r}: {error}") from error
    return float(number)  # type: ignore[arg-type]


@_make_public_function_that_solves
def solve(
    brake: BrakeOrPath,
    model: str = "fem",
    *,
    elements: int | None = None,
    kind: str | None = None,
    penalty: float | None = None,
    tolerance: float | None = None,
    finite_width: bool = False,
    worn_in: bool = False,
    model_error: bool = True,
    across: int | None = None,
    fields: Path | str | None = None,
    sections: int | None = None,
    lift: Sequence[str] | None = None,
) -> Response:
    """Solve a brake by one model: torque, pressure on each lining, reactions, estimated errors.

    Parameters
    ----------
    brake : the brake, or the path of its file
    model : "fem" for finite elements in plane stress, "solid" for finite elements in three
        dimensions, "foundation" for a beam on springs, or a law such as "sine"
    elements : number of finite elements along each lining; None: as the error needs ("fem")
    kind : "quad2", "quad1", "tri2" or "tri1", the elements of the parametric mesh ("fem")
    penalty : contact stiffness as a multiple of E/t of the lining, up to inf ("fem", "solid")
    tolerance : relative error to reach, of the pressure p (L2 norm) and of the torque ("fem",
        "solid")
    finite_width : whether the answer is corrected for the widths of the shoes ("fem")
    worn_in : whether the linings are worn until their pressure no longer changes ("fem")
    model_error : whether the error of plane stress itself is estimated, with `finite_width` the
        error that remains; not for worn-in linings ("fem")
    across : degree of the polynomials across the width; None: as the error needs ("solid")
    fields : path of a .vtu file for displacements and stresses in the shoes, in plane stress also
        in an elastic ring; not with `finite_width` or `worn_in` ("fem", "solid")
    sections : number of sections along each beam ("foundation")
    lift : names of simplifications of the model to remove, or ["all"] ("foundation")

    Returns
    -------
    Response
        the torque [N m], the load of the drum's bearings [N], and for each shoe its pressure
        p(theta) [Pa over rad], reactions [N] and figures of merit; on a plane the braking force [N]
        and pressures over x [m]. `plot()` draws the pressures and returns matplotlib axes

    Raises
    ------
    BadInput
        for an unknown model, a model that does not apply, an option out of range or of another
        model
    NoAnswer
        for self-locking, no equilibrium, no convergence, a tolerance that is not reached (with mesh
        files the answer has a warning instead)

    Examples
    --------
    >>> brake = drumlin.example("double_shoe")
    >>> round(drumlin.solve(brake).torque), round(drumlin.solve(brake, "sine").torque)
    (448, 435)
    """
    from drumlin.models import check_options_belong_to_model, model_with_name_that_applies_to_brake

    whole = _brake_itself_or_read_from_file(brake)
    options = _solver_options_given_by_user(
        elements=elements,
        kind=kind,
        penalty=penalty,
        tolerance=tolerance,
        finite_width=finite_width,
        worn_in=worn_in,
        across=across,
        fields=None if fields is None else Path(fields),
        sections=sections,
        lift=lift,
    )
    # The model is checked before the options: an unknown model is the more helpful message.
    chosen = model_with_name_that_applies_to_brake(model, whole)
    check_options_belong_to_model(model, options)
    if fields is not None and (finite_width or worn_in):
        raise BadInput("--fields: does not apply to worn-in linings, nor to corrected answers")
    if finite_width and worn_in:
        raise BadInput("--finite-width: does not apply to worn-in linings")
    if finite_width and not model_error:
        raise BadInput("--no-model-error: --finite-width states the error that remains")
    if model == "fem" and not worn_in:
        options |= {"model_error": model_error, "self_locking": True}
    return _response_with_notes_and_self_locking(whole, chosen, options)


def _response_with_notes_and_self_locking(
    whole: Brake, chosen: Model, options: Mapping[str, Any]
) -> Response:
    """Solve a brake, and add notes on unlikely values, ignored keys and self-locking.

    `chosen` is the model, and `options` are its options. Raises NoAnswer with the notes on unlikely
    values.
    """
    from drumlin.brake.friction import first_key_of_pressure_dependent_friction
    from drumlin.brake.plausibility import notes_on_implausible_brake_values
    from drumlin.laws.rigid import (
        response_with_note_on_ignored_keys,
        self_locking_by_rigid_shoe_law,
    )
    from drumlin.response.face import peak_pressures_over_width_as_line
    from drumlin.response.response import notes_on_struts_of_trailing_shoes

    # Notes on unlikely values come with a result, and also with the reason why there is no result.
    notes = notes_on_implausible_brake_values(whole)
    try:
        response = chosen.solve(whole, **options)
    except NoAnswer as error:
        if not notes:
            raise
        raise NoAnswer("; ".join((str(error), *notes))) from error
    response = response_with_note_on_ignored_keys(whole, response)
    notes = (*notes_on_struts_of_trailing_shoes(whole, response.shoes), *notes)
    over_width = peak_pressures_over_width_as_line(whole, response)
    if over_width:
        response = replace(response, notes=(*response.notes, over_width))
    key = first_key_of_pressure_dependent_friction(whole)
    if key is not None and response.self_locking is None:
        linings = " for unworn linings" if options.get("worn_in") else ""
        unknown = (
            f"note: {key}: the distance from self-locking is not given with this answer; "
            f"drumlin.self_locking finds it in plane stress{linings}"
        )
        return replace(response, notes=(*response.notes, unknown, *notes))
    locking = response.self_locking or self_locking_by_rigid_shoe_law(whole)
    notes = (*response.notes, *locking.warnings(), *notes)
    return replace(response, notes=notes, self_locking=locking)


@_make_public_function_that_solves
def compare(
    brake: BrakeOrPath,
    case: str = "",
    repeats: int = 1,
    models: Sequence[str] | None = None,
    *,
    elements: int | None = None,
    kind: str | None = None,
    penalty: float | None = None,
    tolerance: float | None = None,
    finite_width: bool = False,
    solid: bool = False,
) -> ModelComparison[Brake]:
    """Solve a brake by all models that apply, side by side.

    Parameters
    ----------
    brake : the brake, or the path of its file
    case : name of the brake in the table; "" for its title
    repeats : how often each model is solved and timed
    models : names of the models; None for all that apply but "solid", which takes longer
    solid : whether "solid" is one of the models that None stands for
    elements : number of finite elements along each lining, see `solve`
    kind : kind of the finite elements, see `solve`
    penalty : contact stiffness of the finite elements, see `solve`
    tolerance : relative error of the finite elements, see `solve`
    finite_width : whether the answer of the finite elements is corrected, see `solve`

    Returns
    -------
    ModelComparison
        `responses` has the results by model. `rows` has the rows of a table with run times [s] and
        differences from the finite elements in plane stress, as fractions; a model without an
        answer has a row with the reason. `plot()` draws the pressures and returns matplotlib axes

    Raises
    ------
    BadInput
        for an option out of range

    Examples
    --------
    >>> brake = drumlin.example("double_shoe")
    >>> sorted(drumlin.compare(brake, models=["sine", "cosine"]).responses)
    ['cosine', 'sine']
    """
    from drumlin.comparison import compare as side_by_side

    options = _solver_options_given_by_user(
        elements=elements,
        kind=kind,
        penalty=penalty,
        tolerance=tolerance,
        finite_width=finite_width,
        solid=solid,
    )
    return side_by_side(_brake_itself_or_read_from_file(brake), case, repeats, models, **options)


@_make_public_function_that_solves
def size(
    brake: BrakeOrPath,
    key: str,
    *,
    torque: float | str | None = None,
    peak_pressure: float | str | None = None,
    model: str = "fem",
    low: float | str | None = None,
    high: float | str | None = None,
    elements: int | None = None,
    kind: str | None = None,
    penalty: float | None = None,
    tolerance: float | None = None,
    finite_width: bool = False,
    sections: int | None = None,
    lift: Sequence[str] | None = None,
    say: FunctionThatShowsProgressText = _ignore_text_about_progress,
) -> SizingResult:
    """Find the value of a key at which a brake has a wanted torque or peak pressure.

    Parameters
    ----------
    brake : the brake, or the path of its file
    key : the key that varies, as for `vary`: "shoe.actuation.force", "shoe.left.hinge.angle"
    torque : wanted torque [N m], on a plane braking force [N]; "largest" for the largest torque in
        the range; None for a wanted peak pressure
    peak_pressure : largest peak pressure of all shoes [Pa]: with `torque` a limit, alone the wanted
        value; None for no limit
    model : the model, see `solve`
    low : begin of the range of the key [SI]; None: a tenth of the value of the file, 30 deg less
        for an angle, a quarter of the radius less for a coordinate
    high : end of the range of the key [SI]; None: ten times the value of the file, 30 deg more for
        an angle, a quarter of the radius more for a coordinate
    elements : number of finite elements along each lining, see `solve`
    kind : kind of the finite elements, see `solve`
    penalty : contact stiffness of the finite elements, see `solve`
    tolerance : relative error of the finite elements, see `solve`
    finite_width : whether the answer of the finite elements is corrected, see `solve`
    sections : number of sections of each beam, see `solve`
    lift : simplifications of the foundation model to remove, see `solve`
    say : function that is called with a line of text before each solve

    Returns
    -------
    SizingResult
        the value of the key [SI], its error from the stated errors of the torque, the range that
        was searched, the brake with this value, and its response

    Raises
    ------
    BadInput
        for an unknown key, a key without a single number, an empty range, an option out of range
    NoAnswer
        if no value of the range gives what is wanted; the message names the reason and the range

    Examples
    --------
    >>> brake = drumlin.example("double_shoe")
    >>> found = drumlin.size(brake, "shoe.actuation.force", torque=400.0, model="sine")
    >>> round(found.value), found.key
    (1838, 'shoe.actuation.force')
    """
    from drumlin.brake.file import si_unit_of_brake_key
    from drumlin.models import check_options_belong_to_model, model_with_name_that_applies_to_brake
    from drumlin.sizing import WORD_FOR_LARGEST_TORQUE, SizingQuestion, size_brake

    whole = _brake_itself_or_read_from_file(brake)
    given = _solver_options_given_by_user(
        elements=elements,
        kind=kind,
        penalty=penalty,
        tolerance=tolerance,
        finite_width=finite_width,
        sections=sections,
        lift=lift,
    )
    check_options_belong_to_model(model, given)
    unit = si_unit_of_brake_key(whole, key) or ""
    wanted = torque
    if torque is not None and torque != WORD_FOR_LARGEST_TORQUE:
        wanted = _value_of_function_option_in_si(
            "--torque", torque, whole.surface.unit_of_torque_or_brake_force
        )
    pressure = None
    if peak_pressure is not None:
        pressure = _value_of_function_option_in_si("--peak-pressure", peak_pressure, "Pa")
    question = SizingQuestion(
        whole,
        key,
        model,
        given,
        torque=wanted,
        peak_pressure=pressure,
        low=None if low is None else _value_of_function_option_in_si("--from", low, unit),
        high=None if high is None else _value_of_function_option_in_si("--to", high, unit),
        say=say,
    )

    def answer(sized: Brake) -> Response:
        """The response of the sized brake, with all errors that its model states."""
        options = dict(given)
        if model == "fem":
            options |= {"model_error": True, "self_locking": True}
        if model in {"fem", "solid"}:
            options["cache"] = question.cache
        chosen = model_with_name_that_applies_to_brake(model, sized)
        return _response_with_notes_and_self_locking(sized, chosen, options)

    return size_brake(question, answer)


@_make_public_function_that_solves
def sweep(
    brake: BrakeOrPath,
    vary: Mapping[str, object] | None = None,
    *,
    model: str | Sequence[str] | Mapping[str, Mapping[str, object]] = "fem",
    combine: str = "grid",
    cases: int | None = None,
    seed: int = 0,
    certify: str | int = "every case",
    jobs: int | None = 1,
    progress: bool | Callable[[int, int], None] = False,
) -> SweepTable:
    """Solve a brake for many values of its keys; the result is a table with a row for each case.

    Parameters
    ----------
    brake : the brake or the path of its file; without `vary` the path of a sweep file
    vary : for each key, named as for the function `vary`, its values: a list or an array of numbers
        [SI] or texts with units, or a dict with a range or a distribution as in a sweep file, such
        as {"from": 0.2, "to": 0.4, "count": 5} or {"distribution": "normal", "deviation": "5 %"}
    model : name of a model, names of several, or a dict of their names and options
    combine : "grid" for all combinations of lists and ranges, "zip" to combine the n-th values of
        all keys, "random" to draw all values at random
    cases : number of random draws; None if no value is drawn
    seed : number that determines the random draws
    certify : which cases are solved on all levels of refinement: "every case", "every 10th" or
        another number, or the number of cases to draw. The errors of all other cases are estimated
        from the errors of these cases. If `brake` is a sweep file, `model`, `combine`, `cases`,
        `seed` and `certify` stand in this file
    jobs : number of processes that solve in parallel; None for one on each core. A script that
        asks for more than one must call this function below `if __name__ == "__main__":`, since
        each process reads the script again. A law of your own is solved with jobs=1
    progress : True to print the number of finished cases; or a function that is called with the
        number of finished cases and of all cases

    Returns
    -------
    SweepTable
        a sequence of rows in the order of the cases: the changed keys, the results in SI units, and
        "status", which has the reason if a case has no results. `table["torque"]` is a column;
        `statistics()`, `failures`, `plot()`, `write()` and `to_pandas()` tell more

    Raises
    ------
    BadInput
        for an unknown key, a value that no brake can have, a sweep file that cannot be read, or an
        argument that must stand in the sweep file; the message is one line
    NoAnswer
        if the processes cannot be started, or all are lost

    Examples
    --------
    >>> brake = drumlin.example("double_shoe")
    >>> table = drumlin.sweep(brake, {"friction": [0.3, 0.4]}, model="sine")
    >>> table["torque"].round().tolist(), table[0]["status"]
    ([435.0, 659.0], 'solved')
    """
    from drumlin.sweeps.file import read_sweep_from_toml_file, sweep_from_file_data
    from drumlin.sweeps.python_values import sweep_file_data_from_python_values
    from drumlin.sweeps.run import solve_sweep_in_memory
    from drumlin.sweeps.sweep_table import function_that_prints_progress

    given = {"combine": combine, "cases": cases, "seed": seed, "certify": certify}
    if vary is None:
        if not isinstance(brake, str | Path):
            raise BadInput('vary: is missing, such as {"friction": [0.3, 0.4]}')
        for name, value in ({"model": model} | given).items():
            if value != inspect.signature(sweep).parameters[name].default:
                raise BadInput(
                    f"{name} = {value!r}: belongs to vary; of a sweep file, write it in the file"
                )
        prepared, folder = read_sweep_from_toml_file(Path(brake)), Path(brake).parent
    else:
        whole, folder = _brake_itself_or_read_from_file(brake), Path()
        data = sweep_file_data_from_python_values(whole, vary, model, **given)
        prepared = sweep_from_file_data(data, folder.resolve(), brake=whole)
    done = function_that_prints_progress() if progress is True else progress
    return solve_sweep_in_memory(
        prepared, folder, jobs=jobs, done=done or (lambda finished, of: None)
    )


@_make_public_function_that_solves
def wear(
    brake: BrakeOrPath,
    model: str = "fem",
    *,
    distance: float | str | None = None,
    coefficient: float | str | None = None,
    exponent: float = 1.0,
    torque: float | str | None = None,
    reverse: float | str | None = None,
    guided: bool = False,
    tolerance: float | None = None,
    elements: int | None = None,
    kind: str | None = None,
    sections: int | None = None,
    lift: Sequence[str] | None = None,
    say: FunctionThatShowsProgressText = _ignore_text_about_progress,
) -> WearRun:
    """Wear the linings of a brake by Archard's law, as during running-in.

    Parameters
    ----------
    brake : the brake, or the path of its file
    model : "fem", "solid" or "foundation", the elastic model whose linings wear
    distance : sliding distance [m], or a text: "20 km". A text without a unit counts in 1/(k K)
        with K = E/t of the lining: "20" is 20 times this distance, not 20 m, and the run says so in
        its `notes`. None: until pressure and torque no longer change
    coefficient : wear coefficient k [1/Pa], or a text such as "1e-5 mm^3/(N m)"; with another
        exponent than 1 it is the value at 1 MPa
    exponent : exponent of the pressure in the wear rate
    torque : torque [N m], or a text with its unit, that is kept constant by changing the actuation;
        None: the actuation stays constant. On a plane it is the braking force [N]
    reverse : sliding distance, as `distance`, after which the drum reverses, again and again
    guided : whether the shoes move along the radius of their middle without turning ("fem",
        "solid")
    tolerance : relative error of p (L2) in a step of the wear
    elements : number of finite elements along each lining, see `solve`
    kind : kind of the finite elements, see `solve`
    sections : number of sections along each beam ("foundation")
    lift : simplifications of the foundation model to remove, see `solve`
    say : function that is called with a line when the computation begins

    Returns
    -------
    WearRun
        `states`, beginning with the unworn linings, each with the sliding distance `s` [m], the
        `torque` [N m], and `depth` [m] and `pressure` [Pa] at the nodes of all linings;
        `linings(state)` has them for each lining, with its angles `theta` [rad] and the name of the
        shoe. `target` is the pressure that wear tends to, `ended` says why the run ends early, as
        where a lining is worn through; `lines()` and `as_dict()`

    Raises
    ------
    BadInput
        for a model that does not wear, an option out of range or of the other model
    NoAnswer
        for no equilibrium, no convergence, self-locking

    Examples
    --------
    >>> run = drumlin.wear(drumlin.example("double_shoe"), elements=12, distance="2")
    >>> bool(run.states[-1].depth.max() > 0)
    True
    """
    from drumlin.lining_wear import linings, whole_brake

    worn = _brake_itself_or_read_from_file(brake)
    # With `guided` a copy of the brake is worn, whose shoes are supported by guides.
    worn = linings.brake_with_shoes_on_guides(worn) if guided else worn
    worn.check_shoes_can_be_meshed()
    on_mesh = _solver_options_given_by_user(elements=elements, kind=kind)
    on_springs = _solver_options_given_by_user(sections=sections, lift=lift)
    # Options of finite elements are refused for the foundation model, and the other way round.
    only_mesh = on_mesh | _solver_options_given_by_user(guided=guided)
    whole_brake.require_options_of_wear_model(model, only_mesh, on_springs)
    # The wear computation needs a wear law, the torque to keep constant, and prepared models.
    law = whole_brake.make_wear_law(coefficient, exponent)
    held = (
        None
        if torque is None
        else _value_of_function_option_in_si(
            "--torque", torque, worn.surface.unit_of_torque_or_brake_force
        )
    )
    options = on_springs if model == "foundation" else on_mesh
    setups = whole_brake.make_wear_setups_of_brake(
        worn, model, both_ways=reverse is not None, **options
    )
    say("wearing")
    return whole_brake.wear_linings_of_whole_brake(
        setups,
        law,
        distance=distance,
        reverse=reverse,
        torque=held,
        tolerance=tolerance,
    )


class HoldingRun(NamedTuple):
    """The states of a brake that holds the drum, as the drum is turned from rest.

    Attributes
    ----------
    brake : the brake that was solved
    states : state at each angle of rotation, beginning at rest
    """

    brake: Brake
    states: tuple[HoldingState, ...]

    def __repr__(self) -> str:
        """The title of the brake, and the lines of `lines`."""
        return "\n".join([self.brake.title, *self.lines()])

    def as_dict(self) -> list[dict[str, Any]]:
        """The states as plain data for JSON, in SI; the keys are those of `drumlin hold --json`."""
        from drumlin.fem.analysis.holding import holding_states_as_plain_data

        return holding_states_as_plain_data(list(self.states))

    def lines(self) -> list[str]:
        """Two lines of text: the largest moment of all states, and when the brake slips.

        The whole contact begins to slip between two states, and the line names both rotations.
        """
        surface = self.brake.surface

        def shown_rotation(state: HoldingState) -> str:
            """The rotation of a state in its unit; on a plane the sliding distance."""
            return f"{state.rotation * surface.si_to_shown_unit_factor:.4g}"

        word, unit = surface.word_for_motion, surface.shown_unit
        largest = max(self.states, key=lambda state: abs(state.torque))
        last = self.states[-1]
        slips = (
            f"no full slip: at {word} {shown_rotation(last)} {unit}, "
            f"{100 * last.sticking:.0f} % still stick"
        )
        if last.sticking == 0:
            # On rough abutments the linings may slip back as the forces come on, and stick as the
            # drum begins to turn.
            count = sum(1 for _ in takewhile(lambda state: state.sticking == 0, self.states[::-1]))
            begin = f"{word} {shown_rotation(self.states[-count])}"
            # The slip of the whole contact begins between two states.
            if count < len(self.states):
                before = shown_rotation(self.states[-count - 1])
                begin = f"a {word} between {before} and {shown_rotation(self.states[-count])}"
            slips = f"the whole contact slips from {begin} {unit} on"
        moment = f"{abs(largest.torque):.6g} {surface.unit_of_torque_or_brake_force}"
        return [f"holds up to {moment}, at {word} {shown_rotation(largest)} {unit}", slips]


def _rotation_or_slide_of_hold_in_si(rotation: float | str, surface: FrictionSurface) -> float:
    """The rotation [rad] for `hold`, on a plane the slide [m].

    Raises BadInput if it is larger than LARGEST_ROTATION_OR_SLIDE_OF_HOLD_BY_UNIT says.
    """
    found = _value_of_function_option_in_si("--rotation", rotation, surface.coordinate_unit)
    most = LARGEST_ROTATION_OR_SLIDE_OF_HOLD_BY_UNIT[surface.coordinate_unit]
    # The comparison is written so that a value that is no number is refused, too.
    if not abs(found) <= most * (1 + LARGEST_EXCESS_OF_ROUNDED_UP_ROTATION):
        raise BadInput(
            f"--rotation = {rotation!r}: must be at most "
            f"{most * surface.si_to_shown_unit_factor:g} {surface.shown_unit} to either side"
        )
    return found


@_make_public_function_that_solves
def hold(
    brake: BrakeOrPath,
    model: str = "fem",
    *,
    rotation: float | str | None = None,
    steps: int = 20,
    elements: int | None = None,
    kind: str | None = None,
    penalty: float | None = None,
    say: FunctionThatShowsProgressText = _ignore_text_about_progress,
) -> HoldingRun:
    """Turn the drum from rest against the shoes that hold it, through partial slip to full slip.

    Parameters
    ----------
    brake : the brake, or the path of its file
    model : "fem" for finite elements in plane stress, "solid" for shoes with their widths
    rotation : angle by which the drum is turned [rad], or a text such as "0.02 deg"; on a plane the
        distance by which the body slides [m]; None: to full slip
    steps : number of increments of the rotation, 1 to 10 000
    elements : number of finite elements along each lining, see `solve`
    kind : kind of the finite elements, see `solve`
    penalty : contact stiffness, see `solve`
    say : function that is called with a line about the shoes when the computation begins

    Returns
    -------
    HoldingRun
        `steps` + 1 `states`, each with `rotation` [rad] or on a plane the slide [m], `torque`, the
        moment [N m] that is held, `sticking`, the fraction of the nodes that stick, `dissipated`,
        the work [J] of slip, and for each shoe `theta` [rad], `pressure` and `traction` [Pa]

    Raises
    ------
    BadInput
        for a brake without friction or an option out of range
    NoAnswer
        for a shoe that does not touch, self-locking, no convergence

    Examples
    --------
    >>> run = drumlin.hold(drumlin.example("double_shoe"), elements=12, steps=4)
    >>> len(run.states), run.states[-1].sticking
    (5, 0.0)
    """
    import numpy as np

    from drumlin.fem.analysis import holding
    from drumlin.fem.analysis.prepared import prepared_model_for_hold_wear_or_sensitivity

    held = _brake_itself_or_read_from_file(brake)
    held.check_shoes_can_be_meshed()
    if not 1 <= steps <= MAX_ROTATION_INCREMENTS_OF_HOLD:
        raise BadInput(f"--steps = {steps}: must be from 1 to {MAX_ROTATION_INCREMENTS_OF_HOLD}")
    on_mesh, stiffness = (
        _solver_options_given_by_user(elements=elements, kind=kind),
        _solver_options_given_by_user(penalty=penalty),
    )
    end = None if rotation is None else _rotation_or_slide_of_hold_in_si(rotation, held.surface)
    # If the user gives no rotation, the drum is turned until every node slips. The force grows in
    # as many increments in the search as below, so that both begin with the same state at rest.
    scene = prepared_model_for_hold_wear_or_sensitivity(held, model, **on_mesh)
    if end is None:
        end = holding.find_drum_rotation_of_full_slip(
            scene, held, increments=steps + 1, **stiffness
        )
    # The state at rest comes first, so that there is one state more than increments.
    rotations = np.linspace(0.0, end, steps + 1)
    states = holding.turn_holding_brake_and_return_states_at_rotations(
        scene, held, rotations, say=say, **stiffness
    )
    return HoldingRun(held, tuple(states))


@_make_public_function_that_solves
def sensitivity(
    brake: BrakeOrPath,
    model: str = "fem",
    *,
    elements: int | None = None,
    kind: str | None = None,
    penalty: float | None = None,
) -> TorqueSensitivities:
    """Exact derivatives of the torque by friction, force, moduli, clearance and hinge position.

    Parameters
    ----------
    brake : the brake, or the path of its file
    model : "fem" for finite elements in plane stress, "solid" for shoes with their widths, whose
        derivatives by moduli are central differences with a stated error
    elements : number of finite elements along each lining, see `solve`
    kind : kind of the finite elements, see `solve`
    penalty : contact stiffness, see `solve`

    Returns
    -------
    TorqueSensitivities
        `torque` T [N m], `friction` dT/dmu [N m], `S` = (mu/T) dT/dmu, and the derivatives by the
        data of each shoe; on a plane T is the braking force [N]

    Raises
    ------
    BadInput
        for an option out of range
    NoAnswer
        for a brake without friction, self-locking, no equilibrium

    Examples
    --------
    >>> slopes = drumlin.sensitivity(drumlin.example("double_shoe"))
    >>> slopes.S > 1
    True
    """
    from drumlin.fem.analysis.prepared import prepared_model_for_hold_wear_or_sensitivity
    from drumlin.fem.analysis.sensitivity import compute_torque_sensitivity as slopes

    on_mesh, stiffness = (
        _solver_options_given_by_user(elements=elements, kind=kind),
        _solver_options_given_by_user(penalty=penalty),
    )
    whole = _brake_itself_or_read_from_file(brake)
    whole.check_shoes_can_be_meshed()
    return slopes(
        prepared_model_for_hold_wear_or_sensitivity(whole, model, **on_mesh), whole, **stiffness
    )


class SelfLockingFrictionOfGroup(NamedTuple):
    """The friction coefficient at which a group of shoes locks itself.

    Printed, it is a line such as "shoe 'left' locks at mu_lock = 1.181".

    Attributes
    ----------
    shoes : names of the shoes whose forces depend on each other, or of a single shoe
    friction : friction coefficient mu_lock; inf if the shoes do not lock up to the largest friction
        that was tried. If friction depends on the pressure, it is the coefficient at zero pressure,
        with all coefficients of the table raised in proportion
    bounded : True if the pressure stays finite as friction rises to mu_lock. The limit then holds
        for the forces and clearances of the brake; under a larger force the equilibrium may end at
        a smaller friction. False if the pressure grows without bound
    least_friction_on_finer_elements : friction coefficient to which mu_lock may fall as the
        elements become smaller. It is smaller than `friction` if the friction at a lining's corner
        is above pi/2: above pi/2 a right-angled corner of a lining may dig into the drum, and
        mu_lock falls with the logarithm of the element size
    pressed_at_point : names of the shoes whose contact shrinks to a point as friction rises to
        mu_lock. `bounded` is then False, while the contact forces and the torque stay finite. They
        are not sought if friction depends on the pressure or a spring has a rate; `bounded` then
        holds on the elements of the solve
    """

    shoes: tuple[str, ...]
    friction: float
    bounded: bool
    least_friction_on_finer_elements: float
    pressed_at_point: tuple[str, ...] = ()

    def __repr__(self) -> str:
        """The shoes and their limit in words, as one line of text."""
        names = ", ".join(f"shoe {name!r}" for name in self.shoes)
        many = len(self.shoes) > 1
        if math.isinf(self.friction):
            return f"{names} {'do' if many else 'does'} not lock up to the largest friction tried"
        text = f"{names} {'lock together' if many else 'locks'} at mu_lock = {self.friction:.4g}"
        if self.bounded:
            text += ", where the equilibrium ends at finite pressures"
        if self.pressed_at_point:
            pressed = ", ".join(f"shoe {name!r}" for name in self.pressed_at_point)
            text += f", where the contact of {pressed} shrinks to a point"
        if self.least_friction_on_finer_elements < self.friction:
            text += f"; down to {self.least_friction_on_finer_elements:.4g} on finer elements"
        return text


class SelfLockingFrictionsOfBrake(tuple[SelfLockingFrictionOfGroup, ...]):
    """The limits of self-locking of a brake: a tuple with one entry for each group of shoes.

    Printed, it has a line for each group. The fields of an entry, such as its `friction`, are
    those of `SelfLockingFrictionOfGroup`.
    """

    __slots__ = ()

    def __repr__(self) -> str:
        """A line of text for each group of shoes."""
        return "\n".join(map(repr, self))


@_make_public_function_that_solves
def self_locking(
    brake: BrakeOrPath,
    *,
    most: float | None = None,
    elements: int | None = None,
    kind: str | None = None,
    penalty: float = math.inf,
) -> SelfLockingFrictionsOfBrake:
    """Find the friction coefficient at which a brake locks itself, by finite elements.

    Parameters
    ----------
    brake : the brake, or the path of its file
    most : largest friction coefficient to try; None for 1000
    elements : number of finite elements along each lining, see `solve`
    kind : kind of the finite elements, see `solve`
    penalty : contact stiffness, see `solve`; inf for contact without penalty

    Returns
    -------
    SelfLockingFrictionsOfBrake
        a tuple with one SelfLockingFrictionOfGroup for each group of shoes whose forces depend on
        each other: all shoes on an elastic ring, on a cam or on struts, and all shoes of a brake
        that has a spring with a rate; any other shoe is a group of its own

    Raises
    ------
    BadInput
        for an option out of range, and for a brake without friction
    NoAnswer
        for a group without equilibrium, and where a spring goes slack or a shoe turns too far

    Examples
    --------
    >>> limits = drumlin.self_locking(drumlin.example("double_shoe"), elements=12)
    >>> limits
    shoe 'right' does not lock up to the largest friction tried
    shoe 'left' locks at mu_lock = 1.181
    >>> [limit.shoes for limit in limits]
    [('right',), ('left',)]
    """
    from drumlin.contact.self_locking import LARGEST_SOUGHT_SELF_LOCKING_FRICTION
    from drumlin.fem.analysis.self_locking import self_locking_friction_of_shoe_groups
    from drumlin.fem.model import require_positive_penalty
    from drumlin.fem.solve import prepared_model_with_finest_elements

    on_mesh = _solver_options_given_by_user(elements=elements, kind=kind)
    require_positive_penalty(penalty)
    if most is not None and not 0 < most < math.inf:
        raise BadInput(f"most = {most:g}: must be greater than 0 and finite")
    whole = _brake_itself_or_read_from_file(brake)
    whole.check_shoes_can_be_meshed()
    # `self_locking_friction_of_shoe_groups` returns indices of shoes, the user gets their names.
    found = self_locking_friction_of_shoe_groups(
        prepared_model_with_finest_elements(whole, **on_mesh),
        whole,
        LARGEST_SOUGHT_SELF_LOCKING_FRICTION if most is None else most,
        penalty,
    )
    return SelfLockingFrictionsOfBrake(
        SelfLockingFrictionOfGroup(
            tuple(whole.shoes[i].name for i in members),
            end.friction,
            end.pressure_stays_finite and not end.shoes_pressed_at_point,
            end.least_friction_on_finer_elements,
            end.shoes_pressed_at_point,
        )
        for members, end in found.items()
    )


@_make_public_function_that_solves
def reference(brake: BrakeOrPath, output: Path | str | None = None) -> ReferenceValuesOfBrake:
    """Compute reference values of a brake with uncertainties; this takes minutes.

    The values come from two independent finite element programs.

    Parameters
    ----------
    brake : the brake, or the path of its file
    output : path of the JSON file to write; None for no file

    Returns
    -------
    ReferenceValuesOfBrake
        the torque [N m], and for each shoe its torque [N m], reactions [N] and pressure [Pa] at
        whole degrees, each with its uncertainty; on a plane the braking force [N], and pressures at
        whole millimetres

    Raises
    ------
    BadInput
        for a brake with a mesh file, a brake to which finite elements do not apply, or an output
        file that may not be written
    NoAnswer
        for a brake without equilibrium

    Examples
    --------
    >>> found = drumlin.reference(drumlin.example("short_block"))
    >>> round(found.torque.value, 4), found.torque.uncertainty < 1e-6
    (20.0995, True)
    """
    from drumlin.base.files import check_output_files_are_writable
    from drumlin.verification.reference import compute_reference_values as values_of
    from drumlin.verification.reference_file import (
        reference_values_as_json_data,
        write_reference_file,
    )

    source = _brake_with_text_of_its_file(brake)
    path = None if output is None else Path(output)
    check_output_files_are_writable(path)
    found = values_of(source.brake, source.text, source.command)
    if path is not None:
        write_reference_file(reference_values_as_json_data(found), path)
    return found


class CheckResult(NamedTuple):
    """The result of `check`: how far a user's pressures p(theta) are from reference values.

    Attributes
    ----------
    verdicts : for each shoe of the table the relative distances of pressure and torque
    tolerance : largest allowed relative distance, of the pressure in L2 and of the torque
    reference : path of the reference values, or "made anew"
    surface : the surface of the brake, drum or plane
    shoes_without_points : names of the shoes of which the table has no points
    """

    verdicts: tuple[DeviationOfCurveFromReference, ...]
    tolerance: float
    reference: str
    surface: FrictionSurface
    shoes_without_points: tuple[str, ...] = ()

    def __repr__(self) -> str:
        """The reference, and the lines of `lines`."""
        return "\n".join([f"reference: {self.reference}", *self.lines()])

    @property
    def within(self) -> bool:
        """Whether the distances of every shoe of the table are within the tolerance."""
        from drumlin.verification.check import are_curve_deviations_within_tolerance

        return are_curve_deviations_within_tolerance(self.verdicts, self.tolerance)

    def lines(self) -> list[str]:
        """Lines of text about the errors of each shoe; the last line is a verdict on all of them.

        A shoe of which the table has no points has a line that says so.
        """
        from drumlin.verification.check import text_lines_on_errors_of_pressure_table

        missing = [
            f"shoe {name!r}: not compared, the table has no points of it"
            for name in self.shoes_without_points
        ]
        return missing + text_lines_on_errors_of_pressure_table(
            self.verdicts, self.tolerance, self.surface
        )


@_make_public_function_that_solves
def check(
    brake: BrakeOrPath,
    result: Path | str,
    *,
    reference: Path | str | None = None,
    tolerance: float | str = 0.01,
    say: FunctionThatShowsProgressText = _ignore_text_about_progress,
) -> CheckResult:
    """Compare pressures p(theta) from any source with reference values of the brake.

    Parameters
    ----------
    brake : the brake, or the path of its file
    result : path of a CSV file with the columns "shoe", "theta [deg]" (on a plane "x [mm]") and
        "p [MPa]"; other units as well. A shoe without points in the file is not compared
    reference : path of reference values; None: the stored values for the brake's file, or else
        values that are computed anew, which takes minutes
    tolerance : largest allowed relative distance of p (L2) and of the torque, between 0 and 1, or a
        text such as "5 %"
    say : function that is called with a line if reference values must be computed

    Returns
    -------
    CheckResult
        `verdicts` with the relative distances of p and torque for each shoe, `within` and
        `lines()`, which it shows

    Raises
    ------
    BadInput
        for a table that cannot be read, or reference values of another brake
    NoAnswer
        for a brake without equilibrium, if reference values must be computed

    Examples
    --------
    >>> try:
    ...     drumlin.check(drumlin.example("double_shoe"), "nowhere.csv", tolerance=2)
    ... except drumlin.BadInput as fault:
    ...     print(fault)
    tolerance = 2: must be greater than 0 and less than 1
    """
    from drumlin.studies import FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES
    from drumlin.verification.check import compare_curves_with_reference as verdicts_on
    from drumlin.verification.check import read_pressure_curves
    from drumlin.verification.reference import compute_reference_values as values_of
    from drumlin.verification.reference_file import (
        path_of_stored_reference_for_brake_file_text,
        read_reference_file,
    )

    allowed = _fraction_from_number_or_percentage("--tolerance", tolerance)
    if not 0 < allowed < 1:
        raise BadInput(f"--tolerance = {allowed:g}: must be greater than 0 and less than 1")
    source = _brake_with_text_of_its_file(brake)
    curves = read_pressure_curves(Path(result), source.brake)
    # Stored values are searched in the brake file's folder, in the reports of the current folder
    # and among drumlin's own values, in this order.
    values = Path("reports") / "reference" / "values"
    beside = () if source.folder is None else (source.folder,)
    known = reference or path_of_stored_reference_for_brake_file_text(
        source.text, *beside, values, FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES / values
    )
    if known is None:
        say("no stored reference: columns of high degree, then triangles")
        found, name = values_of(source.brake, source.text, source.command), "made anew"
    else:
        found, name = read_reference_file(Path(known)), str(known)
    verdicts = verdicts_on(source.brake, found, curves)
    missing = tuple(shoe.name for shoe in source.brake.shoes if shoe.name not in curves)
    return CheckResult(tuple(verdicts), allowed, name, source.brake.surface, missing)


@_make_public_function_that_solves
def fields(
    brake: BrakeOrPath,
    output: Path | str | None = None,
    *,
    elements: int | None = None,
    kind: str | None = None,
    penalty: float | None = None,
) -> tuple[StressAndDisplacementFields, ...]:
    """Displacements and stresses in the shoes, and in an elastic drum ring, by finite elements.

    Parameters
    ----------
    brake : the brake, or the path of its file
    output : path of a .vtu file to write, for ParaView; None for no file
    elements : number of finite elements along each lining, see `solve`
    kind : kind of the finite elements, see `solve`
    penalty : contact stiffness, see `solve`

    Returns
    -------
    tuple of StressAndDisplacementFields
        one for each shoe, and last one for the drum ring if it is elastic: points (n, 2) [m],
        displacement (n, 2) [m], stress (n, 3) with xx, yy, xy [Pa], von Mises stress (n,) [Pa]

    Raises
    ------
    BadInput
        for an option out of range, or a file that does not end in .vtu
    NoAnswer
        for self-locking, no equilibrium, no convergence

    Examples
    --------
    >>> right, left = drumlin.fields(drumlin.example("double_shoe"), elements=12)
    >>> right.stress.shape[1], bool(right.von_mises.max() > 0)
    (3, True)
    """
    from drumlin.base.files import (
        check_output_files_are_writable,
        require_fields_file_name_ends_in_vtu,
    )
    from drumlin.fem.analysis.fields import (
        stress_and_displacement_fields_of_shoes_and_ring,
        write_fields_to_vtu_file,
    )
    from drumlin.fem.model import solve_prepared_model
    from drumlin.fem.solve import prepared_model_with_finest_elements

    # A wrong path is refused before the brake is solved.
    path = None if output is None else Path(output)
    require_fields_file_name_ends_in_vtu(path, "output")
    check_output_files_are_writable(path)
    on_mesh, stiffness = (
        _solver_options_given_by_user(elements=elements, kind=kind),
        _solver_options_given_by_user(penalty=penalty),
    )
    solved = _brake_itself_or_read_from_file(brake)
    solved.check_shoes_can_be_meshed()
    scene = prepared_model_with_finest_elements(solved, **on_mesh)
    found = stress_and_displacement_fields_of_shoes_and_ring(
        scene, solved, solve_prepared_model(scene, solved, **stiffness)
    )
    if path is not None:
        write_fields_to_vtu_file(path, found)
    return tuple(found)


@_make_public_function_that_rewords_errors
def law(name: str, assumes: str = "") -> Callable[[PressureShapeFunction], PressureShapeFunction]:
    """Register a pressure law of your own by a decorator; `solve` and `compare` then know it.

    The law belongs to shoes that turn about a hinge on a drum. Only the shape of the pressure is
    needed: the moments about the hinge give its size, and from it torque and reactions.

    Parameters
    ----------
    name : name of the law, a word that no model of drumlin has
    assumes : assumptions of the law, in words; "" for the docstring of the function

    Returns
    -------
    function
        the decorator of a function of the angles phi (n,) [rad] from the hinge and of the shoe's
        layout, with its attributes phi_1 and phi_2 [rad], the ends of the lining, R and a [m], the
        radii of drum and hinge. The function returns the pressure (n,) up to a factor

    Raises
    ------
    BadInput
        for a name that is no word or is taken, and for a function of other than two arguments

    Examples
    --------
    >>> import numpy as np
    >>> @drumlin.law("my_sine", "as the sine law")
    ... def my_sine(phi, layout):
    ...     return np.sin(phi)
    >>> round(drumlin.solve(drumlin.example("double_shoe"), "my_sine").torque, 2)
    435.22
    """
    from drumlin.models import (
        register_law_with_pressure_shape,
        require_allowed_name_for_law_of_user,
    )

    # `@drumlin.law` without a name in brackets passes the function as the name: it is refused.
    require_allowed_name_for_law_of_user(name)

    def register_law_and_return_function_unchanged(
        shape: PressureShapeFunction,
    ) -> PressureShapeFunction:
        """Register the law with the shape of its pressure, and return the function unchanged."""
        words = assumes or (shape.__doc__ or "a law of the user").strip().partition("\n")[0]
        register_law_with_pressure_shape(name, words, shape)
        return shape

    return register_law_and_return_function_unchanged


@_make_public_function_that_rewords_errors
def remove_law(name: str) -> None:
    """Remove a pressure law of your own, which the decorator `law` has registered.

    To change a law, register the new function under the same name.

    Parameters
    ----------
    name : name of the law

    Returns
    -------
    None
        `solve`, `compare` and `sweep` no longer know the law

    Raises
    ------
    BadInput
        for a name under which you have registered no law

    Examples
    --------
    >>> import numpy as np
    >>> @drumlin.law("toe")
    ... def toe(phi, layout):
    ...     return np.sin(phi / 2) ** 2
    >>> drumlin.remove_law("toe")
    """
    from drumlin.models import remove_law_of_user

    remove_law_of_user(name)


@_make_public_function_that_rewords_errors
def read_brake(path: Path | str, text: str | None = None) -> Brake:
    """Read a brake from its file.

    Parameters
    ----------
    path : path of the brake file
    text : content of the file if it has been read already; mesh files are sought beside `path`

    Returns
    -------
    Brake
        frozen, validated data in SI units

    Raises
    ------
    BadInput
        for a file that cannot be read, or that describes no valid brake; the message has one line

    Examples
    --------
    >>> drumlin.write_brake(drumlin.example("duplex"), "duplex.toml")
    >>> drumlin.read_brake("duplex.toml").title
    'duplex, shoes on abutments'
    """
    from drumlin.brake import read_drum_or_plane_brake

    return read_drum_or_plane_brake(path, text)


@_make_public_function_that_rewords_errors
def vary(brake: BrakeOrPath, changes: Mapping[str, Any]) -> Brake:
    """Make a brake in which some keys have other values; the new brake is checked like a file.

    Parameters
    ----------
    brake : the brake, or the path of its file
    changes : new values by key, in SI or as texts with a unit; a key is written as in the file's
        error lines, "shoe[0].lining.thickness", or with a shoe's name, "shoe.left.hinge.angle";
        "shoe.lining.thickness" changes every shoe

    Returns
    -------
    Brake
        another brake; the given one stays as it is

    Raises
    ------
    BadInput
        for a key that does not exist, for the force of a shoe that a cylinder, a cam or a strut
        sets, or for a brake that does not fit together, in one line

    Examples
    --------
    >>> brake = drumlin.example("double_shoe")
    >>> drumlin.vary(brake, {"friction": 0.4, "drum.radius": "150 mm"}).friction
    0.4
    """
    from drumlin.brake import vary as vary_brake

    return vary_brake(_brake_itself_or_read_from_file(brake), changes)


@_make_public_function_that_rewords_errors
def write_brake(brake: BrakeOrPath, output: Path | str) -> None:
    """Write a brake file with units, from which exactly this brake is read again.

    Parameters
    ----------
    brake : the brake, or the path of its file
    output : path of the new file

    Returns
    -------
    None
        relative paths of mesh files are written as they are in the brake

    Raises
    ------
    BadInput
        for a file that exists already, since brake files are written by hand; for a path that
        cannot be written, or a mesh file whose name is no UTF-8

    Examples
    --------
    >>> brake = drumlin.example("double_shoe")
    >>> drumlin.write_brake(brake, "my.toml")
    >>> drumlin.read_brake("my.toml") == brake
    True
    """
    from drumlin.base.files import write_new_text_file
    from drumlin.brake.writing import brake_file_text

    write_new_text_file(Path(output), brake_file_text(_brake_itself_or_read_from_file(brake)))


@_make_public_function_that_rewords_errors
def example(name: str) -> Brake:
    """Read an example brake by its name; `drumlin init` lists the names.

    Parameters
    ----------
    name : name of the example, such as "double_shoe", "duplex" or "post_brake"

    Returns
    -------
    Brake
        frozen, validated data in SI units

    Raises
    ------
    BadInput
        for an unknown name; the message lists the examples

    Examples
    --------
    >>> drumlin.example("duplex").title
    'duplex, shoes on abutments'
    """
    from drumlin.base.texts import did_you_mean_hint
    from drumlin.brake import read_drum_or_plane_brake
    from drumlin.studies import paths_of_example_brakes

    paths = paths_of_example_brakes()
    if name not in paths:
        hint = did_you_mean_hint(str(name), paths)
        raise BadInput(f"name = {name!r}: no such example{hint}; allowed: {', '.join(paths)}")
    return read_drum_or_plane_brake(paths[name])
