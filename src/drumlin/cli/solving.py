"""Commands that compute a brake: solve, compare, hold, sensitivity, size and wear.

Each command reads its options, calls the function of the package `drumlin`, and prints the answer.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

import drumlin
from drumlin.base.errors import BadInput, NoAnswer, text_of_error_for_command_line
from drumlin.base.written_numbers import number_without_unit_from_text
from drumlin.cli import options as of
from drumlin.cli.answer import print_brake_response
from drumlin.cli.options import (
    BrakeFileArgument,
    ElementsOption,
    FiniteWidthOption,
    ParametricMeshKindOption,
    PenaltyOption,
)
from drumlin.cli.terminal import (
    PrintedColumn,
    print_line_folded_to_terminal_width,
    print_note_to_standard_error,
    print_table_fitted_to_terminal,
    print_table_of_compared_models,
    show_spinner_beside_words,
)

if TYPE_CHECKING:
    from drumlin.brake.brake import Brake
    from drumlin.door import HoldingRun
    from drumlin.response.response import Response

TEXT_ON_COMPARISON_ERRORS = (
    "errors: differences from the model fem; of p (L2): the root of the mean square along a "
    "lining, without its ends; stated error: that of a model's own elements (drumlin solve also "
    "states that of plane stress)"
)
"""The line below the table of a comparison, which explains its columns of errors."""


def solve(
    brake_files: of.BrakeFilesArgument,
    model: Annotated[str, typer.Option(help="which model answers")] = "fem",
    json_file: of.ResponseJsonOption = None,
    pressure: of.PressureFileOption = None,
    elements: ElementsOption = None,
    kind: ParametricMeshKindOption = None,
    penalty: PenaltyOption = None,
    tolerance: of.ErrorToleranceOption = None,
    sections: of.FoundationSectionsOption = None,
    lift: of.LiftedSimplificationsOption = None,
    finite_width: FiniteWidthOption = False,
    no_model_error: of.NoModelErrorOption = False,
    across: of.DegreeAcrossWidthOption = None,
    fields: of.FieldsFileOption = None,
    verbose: of.VerboseOption = False,
) -> None:
    """Solve a brake, or several, by one model."""
    from drumlin.base.files import check_output_files_are_writable

    brakes = [drumlin.read_brake(brake_file) for brake_file in brake_files]
    check_output_files_are_writable(json_file, pressure, fields)
    options = of.command_options_given_by_user(
        elements=elements,
        kind=kind,
        penalty=of.penalty_as_number(penalty),
        tolerance=tolerance,
        sections=sections,
        lift=lift,
        finite_width=finite_width,
        across=across,
        fields=fields,
    )
    _check_model_applies_and_takes_options(brakes, model, options)
    _check_output_files_are_for_single_brake(brakes, {"--pressure": pressure, "--fields": fields})
    answers: list[_BrakeWithResponseOrFailure] = []
    # --no-model-error leaves out the error of plane stress. The check of the options would refuse
    # it for other models, which have no such error, so that it is added after the check.
    options |= {"model_error": False} if no_model_error else {}
    for answer in _solve_brakes_one_by_one(brake_files, brakes, model, options):
        separated = any(earlier.response is not None for earlier in answers)
        _print_answer_and_write_pressures(answer, pressure, separated=separated, verbose=verbose)
        answers.append(answer)
    _write_json_and_require_all_answers(answers, json_file)


class _BrakeWithResponseOrFailure(NamedTuple):
    """A brake with its response, or with the reason why the model has no answer.

    Attributes
    ----------
    brake_file : path of the brake file
    brake : the brake
    response : the answer of the model; None where there is no answer
    failure : the reason why there is no answer; None where there is an answer
    """

    brake_file: Path
    brake: "Brake"
    response: "Response | None"
    failure: NoAnswer | None

    def as_dict(self) -> dict[str, Any]:
        """The path of the brake file and the response or failure, as plain data for JSON."""
        name = {"brake_file": str(self.brake_file)}
        if self.response is None:
            assert self.failure is not None
            return name | {"failure": text_of_error_for_command_line(self.failure)}
        return name | self.response.as_dict()


def _check_model_applies_and_takes_options(
    brakes: "list[Brake]", model: str, options: dict[str, Any]
) -> None:
    """Raise BadInput where the model does not apply to a brake or does not take an option.

    The check is done before any brake is solved.
    """
    from drumlin.models import check_options_belong_to_model, model_with_name_that_applies_to_brake

    for brake in brakes:
        model_with_name_that_applies_to_brake(model, brake)
    check_options_belong_to_model(model, options)


def _check_output_files_are_for_single_brake(
    brakes: "list[Brake]", outputs: dict[str, Path | None]
) -> None:
    """Raise BadInput where a file for a single brake is asked for, but several brakes are given.

    `outputs` holds the path of each file by the name of its option; None for a file that the user
    has not asked for.
    """
    for option, path in outputs.items():
        if path is not None and len(brakes) > 1:
            raise BadInput(f"{option} writes the file of one brake; give one brake file")


def _solve_brakes_one_by_one(
    brake_files: list[Path], brakes: "list[Brake]", model: str, options: dict[str, Any]
) -> Iterator[_BrakeWithResponseOrFailure]:
    """Solve brakes by a model one after the other and yield the answer of each.

    Where one of several brakes has no answer, the reason is yielded in its place. If there is only
    one brake and it has no answer, NoAnswer is raised.
    """
    for brake_file, brake in zip(brake_files, brakes, strict=True):
        try:
            with show_spinner_beside_words(f"solving by {model}"):
                response = drumlin.solve(brake, model, **options)
        except NoAnswer as error:
            if len(brakes) == 1:
                raise
            yield _BrakeWithResponseOrFailure(brake_file, brake, None, error)
        else:
            yield _BrakeWithResponseOrFailure(brake_file, brake, response, None)


def _print_answer_and_write_pressures(
    answer: _BrakeWithResponseOrFailure, pressure: Path | None, *, separated: bool, verbose: bool
) -> None:
    """Print the answer of a brake and write its pressures, or print why there is no answer.

    Parameters
    ----------
    answer : the brake and its response or failure
    pressure : CSV file of the pressures; None: no file
    separated : whether an empty line is printed above the answer
    verbose : whether figures of merit, steps, times and neglected effects are printed
    """
    if answer.response is None:
        assert answer.failure is not None
        reason = text_of_error_for_command_line(answer.failure)
        print_note_to_standard_error(f"{answer.brake_file}: {reason}")
        return
    if pressure is not None:
        from drumlin.base.files import write_text
        from drumlin.verification.check import pressure_curves_as_csv

        write_text(pressure, pressure_curves_as_csv(answer.response, answer.brake.surface))
    if separated:
        print_line_folded_to_terminal_width("")
    print_brake_response(answer.brake, answer.response, verbose=verbose)
    if verbose:
        for line in _verbose_lines_on_stiff_shoes_and_locking(answer.brake, answer.response):
            print_line_folded_to_terminal_width(line)


def _verbose_lines_on_stiff_shoes_and_locking(
    brake: "Brake", response: "Response"
) -> Iterator[str]:
    """Yield the lines of --verbose on stiff shoes, fitting linings and the elastic locking limit.

    The limit is sought only if the finite elements answered without finding it.
    """
    from drumlin.fem.analysis.self_locking import line_on_locking_friction_of_elastic_brake
    from drumlin.response.self_locking import SelfLocking
    from drumlin.response.shoe_stiffness import lines_on_stiff_shoes_and_fitting_linings

    yield from lines_on_stiff_shoes_and_fitting_linings(brake, response)
    locking = response.self_locking
    if (
        response.model == "fem"
        and isinstance(locking, SelfLocking)
        and not locking.is_elastic_known
    ):
        yield line_on_locking_friction_of_elastic_brake(brake)


def _write_json_and_require_all_answers(
    answers: list[_BrakeWithResponseOrFailure], json_file: Path | None
) -> None:
    """Write the answers of all brakes as JSON. Raises NoAnswer where a brake has no answer."""
    from drumlin.base.files import write_json

    if json_file is not None:
        data = [answer.as_dict() for answer in answers]
        write_json(json_file, data[0] if len(data) == 1 else data)
    failed = sum(answer.response is None for answer in answers)
    if failed:
        raise NoAnswer(f"{failed} of {len(answers)} brakes have no answer")


def compare(
    brake_file: BrakeFileArgument,
    output: of.ReportFolderOption = None,
    elements: ElementsOption = None,
    kind: ParametricMeshKindOption = None,
    penalty: PenaltyOption = None,
    finite_width: FiniteWidthOption = False,
    solid: of.AlsoSolidOption = False,
    fields: of.WithFieldsFileOption = False,
    verbose: of.VerboseComparisonOption = False,
) -> None:
    """Solve a brake by all models that apply, side by side, and write one report."""
    from drumlin.base.files import check_path_can_be_folder
    from drumlin.brake.file import read_text_of_brake_file
    from drumlin.report.comparison import compare_models_and_write_html_page

    text = read_text_of_brake_file(brake_file)
    brake = drumlin.read_brake(brake_file, text)
    folder = output or Path("reports") / brake_file.stem
    check_path_can_be_folder(folder)
    options = of.command_options_given_by_user(
        elements=elements,
        kind=kind,
        penalty=of.penalty_as_number(penalty),
        finite_width=finite_width,
        solid=solid,
    )
    with show_spinner_beside_words("comparing the models"):
        result = compare_models_and_write_html_page(
            brake, text, folder, options, fields_file=fields
        )
    print_line_folded_to_terminal_width(
        f"{brake.title}: {brake.motion_as_text}, {brake.friction_coefficients_as_text}"
    )
    print_table_of_compared_models(result.table, result.columns)
    print_line_folded_to_terminal_width(TEXT_ON_COMPARISON_ERRORS)
    for line in (*result.notes, *(result.details if verbose else [])):
        print_line_folded_to_terminal_width(line)
    print_line_folded_to_terminal_width(f"report: {result.page}")


def hold(
    brake_file: BrakeFileArgument,
    model: of.AnalysisModelOption = "fem",
    rotation: of.RotationOption = None,
    steps: Annotated[
        int,
        typer.Option(
            parser=of.parser_of_whole_number_option("--steps"),
            metavar="<int>",
            help="increments of the rotation",
        ),
    ] = 20,
    json_file: of.StatesJsonOption = None,
    elements: ElementsOption = None,
    kind: ParametricMeshKindOption = None,
    penalty: PenaltyOption = None,
) -> None:
    """Turn the drum against its shoes, from rest through partial slip to full slip."""
    from drumlin.base.files import check_output_files_are_writable, write_json

    brake = drumlin.read_brake(brake_file)
    check_output_files_are_writable(json_file)
    with show_spinner_beside_words("holding") as say:
        run = drumlin.hold(
            brake,
            model,
            rotation=rotation,
            steps=steps,
            elements=elements,
            kind=kind,
            penalty=of.penalty_as_number(penalty),
            say=say,
        )
    if json_file is not None:
        write_json(json_file, run.as_dict())
    print_table_fitted_to_terminal(_table_columns_of_holding_states(run), [])
    for line in (*run.states[-1].notes, *run.lines()):
        print_line_folded_to_terminal_width(line)


def _table_columns_of_holding_states(run: "HoldingRun") -> dict[str, PrintedColumn]:
    """The states of a brake that is turned from rest, as columns of a printed table.

    The columns are rotation, torque, sticking part of the contact and dissipated energy.
    """
    from drumlin.base.texts import number_as_text

    surface, states = run.brake.surface, run.states
    turned = [f"{at.rotation * surface.si_to_shown_unit_factor:.6f}" for at in states]
    moments = [number_as_text(at.torque, ".4f") for at in states]
    sticking = [f"{100 * at.sticking:.1f}" for at in states]
    dissipated = [f"{at.dissipated:.5g}" for at in states]
    return {
        "way": PrintedColumn("way", f"{surface.word_for_motion} [{surface.shown_unit}]", turned),
        "moment": PrintedColumn(
            "moment",
            f"{surface.word_for_held_load} [{surface.unit_of_torque_or_brake_force}]",
            moments,
        ),
        "sticking": PrintedColumn("sticking", "sticking [%]", sticking),
        "dissipated": PrintedColumn("dissipated", "dissipated [J]", dissipated),
    }


def sensitivity(
    brake_file: BrakeFileArgument,
    model: of.AnalysisModelOption = "fem",
    json_file: of.SlopesJsonOption = None,
    elements: ElementsOption = None,
    kind: ParametricMeshKindOption = None,
    penalty: PenaltyOption = None,
) -> None:
    """How the torque changes with friction, force, moduli, clearance and hinge, by its slopes."""
    from drumlin.base.files import check_output_files_are_writable, write_json
    from drumlin.fem.analysis.sensitivity import sensitivity_as_text_lines

    brake = drumlin.read_brake(brake_file)
    check_output_files_are_writable(json_file)
    stiffness = of.penalty_as_number(penalty)
    with show_spinner_beside_words("sensitivity"):
        found = drumlin.sensitivity(brake, model, elements=elements, kind=kind, penalty=stiffness)
    if json_file is not None:
        write_json(json_file, found.as_dict())
    print_line_folded_to_terminal_width(
        f"{brake.title}: {model}, {brake.motion_as_text}, {brake.friction_coefficients_as_text}"
    )
    for line in sensitivity_as_text_lines(found, brake):
        print_line_folded_to_terminal_width(line)


def size(
    brake_file: BrakeFileArgument,
    vary: Annotated[str, typer.Option(metavar="KEY", help="the key that varies")],
    torque: of.WantedTorqueOption = None,
    peak_pressure: of.WantedPeakPressureOption = None,
    model: Annotated[str, typer.Option(help="which model answers")] = "fem",
    low: Annotated[str | None, typer.Option("--from", help="begin of the key's range")] = None,
    high: Annotated[str | None, typer.Option("--to", help="end of the key's range")] = None,
    json_file: of.ResponseJsonOption = None,
    write: of.SizedFileOption = None,
    elements: ElementsOption = None,
    kind: ParametricMeshKindOption = None,
    penalty: PenaltyOption = None,
    tolerance: of.ErrorToleranceOption = None,
    finite_width: FiniteWidthOption = False,
    sections: of.FoundationSectionsOption = None,
    lift: of.LiftedSimplificationsOption = None,
) -> None:
    """Find the value of a key for a wanted torque or peak pressure, by any model."""
    from drumlin.base.files import check_output_files_are_writable, write_json

    brake = drumlin.read_brake(brake_file)
    check_output_files_are_writable(json_file)
    # An existing file is refused before the brakes are solved.
    if write is not None and write.exists():
        raise BadInput(f"--write = {str(write)!r}: exists already; brake files are not replaced")
    options = of.command_options_given_by_user(
        elements=elements,
        kind=kind,
        penalty=of.penalty_as_number(penalty),
        tolerance=tolerance,
        finite_width=finite_width,
        sections=sections,
        lift=lift,
    )
    with show_spinner_beside_words(f"sizing: {vary}") as say:
        found = drumlin.size(
            brake,
            vary,
            torque=torque,
            peak_pressure=peak_pressure,
            model=model,
            low=low,
            high=high,
            say=say,
            **options,
        )
    if json_file is not None:
        write_json(json_file, found.as_dict())
    if write is not None:
        drumlin.write_brake(found.brake, write)
    for line in found.lines():
        print_line_folded_to_terminal_width(line)
    print_brake_response(found.brake, found.response)


def wear(
    brake_file: BrakeFileArgument,
    model: of.WearingModelOption = "fem",
    distance: of.SlidingDistanceOption = None,
    coefficient: of.WearCoefficientOption = None,
    exponent: Annotated[
        float,
        typer.Option(
            parser=of.parser_of_number_option("--exponent"),
            metavar="<float>",
            help="of the pressure in the rate of wear",
        ),
    ] = 1.0,
    torque: of.HeldTorqueOption = None,
    reverse: of.ReversalDistanceOption = None,
    guided: of.GuidedAlongMiddleRadiusOption = False,
    tolerance: Annotated[
        float | None,
        typer.Option(
            parser=of.parser_of_number_option("--tolerance"),
            metavar="<float>",
            help="relative error of p (L2) a step",
        ),
    ] = None,
    json_file: of.StatesJsonOption = None,
    elements: ElementsOption = None,
    kind: ParametricMeshKindOption = None,
    sections: of.FoundationSectionsOption = None,
    lift: of.LiftedSimplificationsOption = None,
) -> None:
    """Wear the linings by Archard's law until the pressure is that of the rigid-shoe law."""
    from drumlin.base.files import check_output_files_are_writable, write_json
    from drumlin.lining_wear.run_in import sliding_distance_of_e_fold_pressure_change

    brake = drumlin.read_brake(brake_file)
    check_output_files_are_writable(json_file)
    with show_spinner_beside_words("running in") as say:
        run = drumlin.wear(
            brake,
            model,
            distance=distance,
            coefficient=coefficient,
            exponent=exponent,
            torque=torque,
            reverse=reverse,
            guided=guided,
            tolerance=tolerance,
            elements=elements,
            kind=kind,
            sections=sections,
            lift=lift,
            say=say,
        )
    if json_file is not None:
        write_json(json_file, run.as_dict())
    unit = sliding_distance_of_e_fold_pressure_change(run.setup, run.law)
    for option, value in (("--distance", distance), ("--reverse", reverse)):
        number = number_without_unit_from_text(value)
        if isinstance(number, float):
            km = 1e-3 * number * unit
            print_line_folded_to_terminal_width(
                f"{option} {value} has no unit: {value} times 1/(k K), {km:.5g} km"
            )
    for line in run.lines():
        print_line_folded_to_terminal_width(line)
    # The states up to the early end are printed and written before the reason ends the command.
    if run.ended:
        raise NoAnswer(run.ended)
