"""The report of `drumlin compare`, which shows all models of a brake side by side.

The reports of studies use some functions of this module, too.
"""

import json
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from drumlin.base.errors import NoAnswer
from drumlin.base.files import delete_output_of_earlier_run, write_text
from drumlin.brake.brake import Brake
from drumlin.brake.friction import first_key_of_pressure_dependent_friction
from drumlin.comparison import (
    ModelComparison,
    ModelResultOrReasonOfFailure,
    ResultTableColumn,
    compare,
    comparison_columns_for_brake,
    table_as_csv_text,
)
from drumlin.laws.rigid import (
    UNUSED_KEYS_LINE_START,
    response_with_note_on_ignored_keys,
    self_locking_by_rigid_shoe_law,
)
from drumlin.models import MODELS, reasons_why_models_do_not_apply
from drumlin.report import figures
from drumlin.report.page import software_versions, write_html_page
from drumlin.response.response import Response
from drumlin.response.shoe_stiffness import lines_on_stiff_shoes_and_fitting_linings

NAMES_OF_STRESS_FIELD_FILES = ("fields.svg", "fields.png", "fields.vtu", "fields_column.svg")
"""Names of the files of stress fields that `compare` writes, or that older versions wrote."""

BEGINNINGS_OF_NOTES_OF_MODELS = ("warning:", "note:", "corrected for the widths", "peak p over")
"""Beginnings of the lines of a response that `compare` prints without --verbose."""


class WrittenComparison(NamedTuple):
    """The results of a comparison of models, after its report has been written.

    Attributes
    ----------
    table : rows of the table, one for each shoe and each model
    notes : lines of text that the user needs: the laws that hold for the shoes, self-locking,
        warnings, unused keys, and why some models do not apply
    details : further lines of text, about how each model models the brake and solved it
    page : path of the HTML page, which shows notes and details
    columns : columns of the table
    """

    table: list[dict[str, Any]]
    notes: list[str]
    details: list[str]
    page: Path
    columns: tuple[ResultTableColumn, ...]


def panel_title_and_responses_of_each_shoe(
    comparison: ModelComparison[Any],
) -> list[tuple[str, dict[str, Any]]]:
    """For each shoe, the title of its panel in the pressure figure and its responses by model."""
    brake = comparison.brake
    made: list[tuple[str, dict[str, Any]]] = []
    if not comparison.responses:
        return made
    for i, shoe in enumerate(brake.shoes):
        verb, responses = "opposes", {}
        for model, response in comparison.responses.items():
            responses[model] = response.shoes[i]
            # The title says that friction assists if the shoe is self-energising in at least one
            # model.
            if response.shoes[i].self_energising:
                verb = "assists"
        made.append(
            (f"{shoe.name}, {brake.direction_as_text_in_tables}: friction {verb}", responses)
        )
    return made


def draw_stress_fields(
    brake: Brake,
    response: Response,
    folder: Path,
    name: str,
    endings: Sequence[str] = ("svg",),
    *,
    also_for_column: bool = True,
    **options: Any,
) -> None:
    """Write files of the von Mises stress in the deformed shoes, such as a picture NAME.svg.

    An HTML page can show the picture by the macro `fields` of its template.

    Parameters
    ----------
    brake : the brake
    response : response of the brake by finite elements
    folder : folder in which the files are written
    name : name of the files, without ending
    endings : endings of the files to write: "svg" and "png" hold the picture of stresses, pressures
        and forces, "vtu" holds displacements, stresses and pressures for ParaView
    also_for_column : whether pictures are also drawn for a column of 85 mm, as NAME_column
    options : options of the mesh (elements, kind)
    """
    # The modules take long to load, and most commands draw no stress fields.
    from drumlin.fem.analysis.fields import (  # noqa: PLC0415
        stress_and_displacement_fields_of_shoes_and_ring,
        write_fields_to_vtu_file,
    )
    from drumlin.fem.solve import prepared_model_with_finest_elements  # noqa: PLC0415
    from drumlin.report.field_picture import draw_stress_in_shoes_and_ring  # noqa: PLC0415

    brake.check_shoes_can_be_meshed()
    scene = prepared_model_with_finest_elements(brake, **options)
    bodies = stress_and_displacement_fields_of_shoes_and_ring(scene, brake, response)
    if "vtu" in endings:
        write_fields_to_vtu_file(folder / f"{name}.vtu", bodies)
    pictures = [ending for ending in endings if ending != "vtu"]
    draw = partial(draw_stress_in_shoes_and_ring, brake, response, bodies)
    if also_for_column:
        figures.save_figure_for_page_and_column(draw, folder / name, pictures)
    else:
        figures.save_figure_as_files(draw(figures.FULL_WIDTH), folder / name, pictures)


def comparisons_as_json(comparisons: Sequence[ModelComparison[Any]], **more: Any) -> str:
    """All results of some comparisons as JSON text, with the versions of the software.

    The computing time [s] of each model is the median of its repeated runs. `more` holds additional
    keys and values for the JSON object.
    """
    cases = list(map(_comparison_as_plain_data, comparisons))
    return json.dumps({"versions": software_versions(), "cases": cases, **more}, indent=1) + "\n"


def _comparison_as_plain_data(comparison: ModelComparison[Any]) -> dict[str, Any]:
    """The comparison of all models on one brake as plain data for JSON."""
    return {
        "case": comparison.case,
        "rotation": comparison.brake.direction_as_text_in_tables,
        "friction": comparison.brake.friction,
        "models": list(map(_model_answer_as_plain_data, comparison.outcomes)),
    }


def _model_answer_as_plain_data(outcome: ModelResultOrReasonOfFailure) -> dict[str, Any]:
    """The response of one model, or the text of its failure, with the computing time, for JSON."""
    answer = {"model": outcome.model, "failed": outcome.failure}
    if outcome.response:
        answer = outcome.response.as_dict()
    return {**answer, "run_time": outcome.seconds, "repeats": outcome.repeats}


def compare_models_and_write_html_page(
    brake: Brake, source: str, folder: Path, options: dict[str, Any], *, fields_file: bool = False
) -> WrittenComparison:
    """Compare all models that apply to a brake, and write the HTML page and its data.

    The page, a table as CSV, all results as JSON, the figure of pressures and the picture of the
    stress fields are written into `folder`. Stress fields of an earlier run there are deleted.

    Parameters
    ----------
    brake : the brake
    source : text of the brake file, which the page shows
    folder : folder in which the files are written
    options : options of `compare`
    fields_file : whether the stress fields are also written as fields.vtu

    Raises
    ------
    NoAnswer
        if no model has an answer; then nothing is written
    """
    comparison = compare(brake, repeats=3, **options)
    if not comparison.responses:
        failures = [f"{outcome.model}: {outcome.failure}" for outcome in comparison.outcomes]
        raise NoAnswer("; ".join(failures))
    # Fields of an earlier run must not stand beside the new results.
    for name in NAMES_OF_STRESS_FIELD_FILES:
        delete_output_of_earlier_run(folder / name)
    table = comparison.rows
    write_text(folder / "results.csv", table_as_csv_text(table))
    write_text(folder / "results.json", comparisons_as_json([comparison]))
    pressure_figure = figures.draw_pressure_along_lining_of_each_shoe(
        panel_title_and_responses_of_each_shoe(comparison), surface=brake.surface
    )
    figures.save_figure(pressure_figure, folder / "pressure.svg")
    endings = ("svg", "vtu") if fields_file else ("svg",)
    drawn = _draw_stress_fields_of_comparison(comparison, folder, endings, options)
    named = ("solid",) if options.get("solid") else ()
    of_models = _notes_and_details_of_models(comparison)
    notes = [
        *_lines_on_stiff_shoes_and_both_locking_limits(comparison, options),
        *of_models.notes,
        *_lines_on_models_that_do_not_apply(brake, named),
    ]
    page = write_html_page(
        Path(__file__).with_name("comparison.html"),
        folder / "index.html",
        brake=brake,
        rows=table,
        columns=comparison_columns_for_brake(brake),
        drawn=drawn,
        fields_file=fields_file,
        notes=notes + of_models.details + _sentences_about_effects_that_models_neglect(comparison),
        source_text=source,
    )
    return WrittenComparison(
        table, notes, of_models.details, page, comparison_columns_for_brake(brake)
    )


def _draw_stress_fields_of_comparison(
    comparison: ModelComparison[Any], folder: Path, endings: Sequence[str], options: dict[str, Any]
) -> bool:
    """Write the stress fields of the finite elements, and return whether there are any.

    There are fields if at least one shoe is in contact. `endings` are those of the files, and
    `options` those of `compare`.
    """
    brake, fem = comparison.brake, comparison.responses.get("fem")
    if fem is None or not any(shoe.contact_arcs for shoe in fem.shoes):
        return False
    # The correction for finite widths gives no stress field, so that the picture shows the
    # stresses of plane stress.
    if options.get("finite_width"):
        plane = {key: value for key, value in options.items() if key != "solid"}
        fem = MODELS["fem"].solve(brake, **{**plane, "finite_width": False})
    # The page shows no picture for a column, and the column of a journal is asked of a study.
    draw_stress_fields(
        brake,
        fem,
        folder,
        "fields",
        endings,
        also_for_column=False,
        **_options_that_concern_mesh(options),
    )
    return True


def _options_that_concern_mesh(options: dict[str, Any]) -> dict[str, Any]:
    """Those of the options of `compare` that concern the mesh."""
    return {key: options[key] for key in ("elements", "kind") if key in options}


class _NotesAndDetailsOfModels(NamedTuple):
    """Lines of text about the models of a comparison, see `WrittenComparison`."""

    notes: list[str]
    details: list[str]


def _notes_and_details_of_models(comparison: ModelComparison[Any]) -> _NotesAndDetailsOfModels:
    """The lines of all models that answered.

    Warnings, shoes without contact, unused keys and corrections that the user asked for are notes.
    All other lines are details.
    """
    notes: list[str] = []
    details: list[str] = []
    models_by_line: dict[str, list[str]] = {}
    for model, response in comparison.responses.items():
        noted = response_with_note_on_ignored_keys(comparison.brake, response)
        for line in noted.notes:
            is_note = line.startswith(BEGINNINGS_OF_NOTES_OF_MODELS) or ": no contact" in line
            (notes if is_note else details).append(f"{model}: {line}")
        for line in noted.left_out:
            if line.startswith(UNUSED_KEYS_LINE_START):
                models_by_line.setdefault(line, []).append(model)
    # All laws leave the same keys out, so that one line names the laws.
    unused = [f"{', '.join(models)}: {line}" for line, models in models_by_line.items()]
    return _NotesAndDetailsOfModels(unused + notes, details)


def _lines_on_models_that_do_not_apply(brake: Brake, named: Sequence[str]) -> list[str]:
    """A line for each reason why models do not apply to a brake, with the names of these models.

    `named` are the models that were asked for by name.
    """
    models_by_reason: dict[str, list[str]] = {}
    for name, reason in reasons_why_models_do_not_apply(brake, named).items():
        models_by_reason.setdefault(reason, []).append(name)
    lines = []
    for reason, models in models_by_reason.items():
        verb = "does" if len(models) == 1 else "do"
        lines.append(f"{', '.join(models)}: {verb} not apply: {reason}")
    return lines


def _lines_on_stiff_shoes_and_both_locking_limits(
    comparison: ModelComparison[Any], options: dict[str, Any]
) -> list[str]:
    """Lines on stiff shoes, fitting linings and the self-locking limit of the elastic brake.

    There is no line without an answer of the finite elements. `options` are those of `compare`.
    """
    from drumlin.fem.analysis.self_locking import (  # noqa: PLC0415
        line_on_locking_friction_of_elastic_brake,
    )

    fem = comparison.responses.get("fem")
    if fem is None:
        return []
    brake = comparison.brake
    mesh_options = _options_that_concern_mesh(options)
    lines = list(lines_on_stiff_shoes_and_fitting_linings(brake, fem))
    # The law has no limit where friction depends on the pressure.
    if first_key_of_pressure_dependent_friction(brake) is None:
        lines.append(self_locking_by_rigid_shoe_law(brake).line())
    return [*lines, line_on_locking_friction_of_elastic_brake(brake, **mesh_options)]


def _sentences_about_effects_that_models_neglect(comparison: ModelComparison[Any]) -> list[str]:
    """A line of text for each effect that a model of the comparison neglects."""
    lines = []
    for model, response in comparison.responses.items():
        for effect in response.left_out:
            lines.append(f"{model} left out {effect}")
    return lines
