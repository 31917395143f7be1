"""Compare models: solve a brake by each, and make a table of the results and their differences.

The module also estimates the order of convergence and the limit of a value as meshes are refined.
"""

import csv
import io
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import chain, pairwise
from statistics import median
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from drumlin.base.errors import BadInput, FailedLawOfUser, NoAnswer
from drumlin.base.files import spreadsheet_cell_safe_from_being_run_as_formula
from drumlin.base.shown_tables import html_table_with_caption, text_lines_of_aligned_columns
from drumlin.base.texts import number_as_text
from drumlin.brake.brake import Brake
from drumlin.brake.heat import brake_with_heat_only_in_given_parts, names_of_heated_parts
from drumlin.models import (
    Model,
    applicable_models,
    reasons_why_models_do_not_apply,
    require_known_model,
)
from drumlin.response.norms import (
    relative_distance_of_pressures,
    relative_distance_of_vectors,
    relative_error_of_number,
)
from drumlin.response.response import UNCOMPARED_EDGE_ZONE_IN_RADIANS, Response
from drumlin.response.show import (
    matplotlib_axes_itself_or_new,
    plot_pressure_of_each_shoe,
    text_of_contact_arcs,
)

NAME_OF_RESULT_WITHOUT_HEAT = "cold"
"""Name, in comparisons, of the result that finite elements give for a heated brake without heat."""

# Type variable for the class of the compared brake: `ModelComparison.brake` keeps this class.
BrakeTypeVariable = TypeVar("BrakeTypeVariable", bound=Brake)


@dataclass(frozen=True)
class ModelResultOrReasonOfFailure:
    """The result of one model for a brake, or the reason why the model has no answer.

    Attributes
    ----------
    model : name of the model
    response : the result; None if the model has no answer
    failure : why the model has no answer; "" if it has one
    seconds : time of one solve, median of the repeats [s]
    repeats : number of solves
    """

    model: str
    response: Response | None
    failure: str
    seconds: float = field(compare=False)
    repeats: int


def solve_and_time_model(
    name: str, solve: Callable[[], Response], repeats: int = 1
) -> ModelResultOrReasonOfFailure:
    """Solve a brake by one model and measure the time.

    If the model raises NoAnswer, or if a law of the user fails, the ModelResultOrReasonOfFailure
    has the reason, and no exception is raised.

    Parameters
    ----------
    name : name of the model
    solve : function without arguments that solves the brake
    repeats : how often `solve` is called and timed
    """
    seconds, response, failure = [], None, ""
    for _ in range(repeats):
        start = time.perf_counter()
        try:
            response = solve()
        except (FailedLawOfUser, NoAnswer) as error:
            failure = str(error)
        seconds.append(time.perf_counter() - start)
    return ModelResultOrReasonOfFailure(name, response, failure, median(seconds), repeats)


class RichardsonLimit(NamedTuple):
    """The limit of a value as meshes are refined, by Richardson extrapolation from three meshes.

    Attributes
    ----------
    order : observed order of convergence; nan if the values do not converge
    value : estimated limit
    uncertainty : uncertainty of the limit: its difference from the finest value, or the larger of
        the two changes between meshes if the values do not converge
    """

    order: float
    value: float
    uncertainty: float


def richardson_limit_from_changes_between_meshes(
    fine: float, first: float, last: float, ratio: float = 2.0
) -> RichardsonLimit:
    """Estimate the limit of a value as meshes are refined, by Richardson extrapolation.

    The extrapolation needs two changes of the same sign, of which the second is smaller than the
    first. If the changes are not of this kind, the value on the finest mesh is taken as the limit,
    and the larger change as its uncertainty. The order is nan if the second change is not smaller
    than the first.

    Parameters
    ----------
    fine : the value on the finest of three meshes
    first : change of the value from the coarsest to the middle mesh
    last : change of the value from the middle to the finest mesh
    ratio : ratio of the element sizes of two successive meshes
    """
    if last == 0:
        return RichardsonLimit(math.nan, fine, abs(first))
    # `gain` is the first change divided by the second.
    gain = first / last
    order = math.log(abs(gain), ratio) if abs(gain) > 1 else math.nan
    if gain <= 1:
        return RichardsonLimit(order, fine, max(abs(first), abs(last)))
    # The changes beyond the finest mesh are a geometric series with the ratio 1/gain.
    correction = last / (gain - 1)
    return RichardsonLimit(order, fine + correction, abs(correction))


def richardson_limit_from_three_meshes(
    coarse: float, medium: float, fine: float, ratio: float = 2.0
) -> RichardsonLimit:
    """Estimate the limit of a value from three meshes.

    See `richardson_limit_from_changes_between_meshes`.
    """
    return richardson_limit_from_changes_between_meshes(fine, medium - coarse, fine - medium, ratio)


class ResultTableColumn(NamedTuple):
    """A column of a table of results as people read it.

    Attributes
    ----------
    key : key of the column's value in a row
    heading : heading of the column
    unit : unit in which the value is shown
    factor : factor that converts the value from SI to this unit
    form : format specification of the number, such as ".4g"
    """

    key: str
    heading: str
    unit: str = ""
    factor: float = 1.0
    form: str = ".4g"

    def text(self, row: dict[str, Any]) -> str:
        """The text of this column's cell in a row; a dash if the row has no value."""
        value = row.get(self.key)
        if value is None or (isinstance(value, float) and math.isnan(value)):
            return "–"
        if not isinstance(value, int | float):
            return str(value)
        # A product with 1.0 would turn an integer into a float, which is written otherwise.
        return number_as_text(value if self.factor == 1 else value * self.factor, self.form)

    @property
    def title(self) -> str:
        """The heading of the column with its unit."""
        return f"{self.heading} [{self.unit}]" if self.unit else self.heading


COLUMNS_OF_COMPARISON_TABLE = (
    ResultTableColumn("case", "case"),
    ResultTableColumn("rotation", "drum turns"),
    ResultTableColumn("shoe", "shoe"),
    ResultTableColumn("model", "model"),
    ResultTableColumn("torque", "torque", "N m", 1, ".5g"),
    ResultTableColumn("torque_error", "error of torque", "%", 100, "+.2f"),
    ResultTableColumn("stated_torque_error", "stated error of torque", "%", 100, ".1g"),
    ResultTableColumn("peak_pressure", "peak pressure", "MPa", 1e-6, ".4g"),
    ResultTableColumn("peak_error", "error of peak", "%", 100, "+.1f"),
    ResultTableColumn("pressure_error", "error of p (L2)", "%", 100, ".1f"),
    ResultTableColumn("stated_pressure_error", "stated error of p", "%", 100, ".1g"),
    ResultTableColumn("reaction", "hinge reaction", "N", 1, ".5g"),
    ResultTableColumn("reaction_error", "error of reaction", "%", 100, ".1f"),
    ResultTableColumn("contact", "contact arcs", "deg"),
    ResultTableColumn("self_energising", "self-energising"),
    ResultTableColumn("seconds", "run time", "ms", 1e3, ".3g"),
    ResultTableColumn("status", "status"),
)
"""The columns of the table of a comparison, in their order."""


HEADINGS_OF_DISPLAYED_COMPARISON = {
    "torque_error": "torque off fem",
    "peak_error": "peak p off fem",
    "pressure_error": "p off fem",
    "stated_torque_error": "stated: torque",
    "stated_pressure_error": "stated: p",
}
"""Headings of columns of a comparison as Python shows it, by their keys.

They are shorter than in reports, and call a difference from the finite elements by this name: for a
solid model it is no error.
"""


def comparison_table_rows(
    brake: Brake,
    outcomes: Sequence[ModelResultOrReasonOfFailure],
    reference: str = "fem",
    case: str | None = None,
) -> list[dict[str, Any]]:
    """The rows of the table of a comparison: one for each model and shoe.

    Each model also has a row for the whole brake, in which the shoe is "all". The keys are those of
    COLUMNS_OF_COMPARISON_TABLE, the values are in SI units and errors are fractions. On a plane the
    torque is the braking force [N]. A model without an answer has one row, with the reason in
    "status".

    Parameters
    ----------
    brake : the brake
    outcomes : results of the models
    reference : name of the model that errors refer to
    case : name of the brake in the table; None for its title
    """
    # If the reference model has no answer, the rows have no errors.
    true = next((o.response for o in outcomes if o.model == reference), None)
    table: list[dict[str, Any]] = []
    # Each row begins with the case and the model; the values follow.
    for outcome in outcomes:
        base = {
            "case": case or brake.title,
            "rotation": brake.direction_as_text_in_tables,
            "model": outcome.model,
        }
        if outcome.response is None:
            status = f"failed: {outcome.failure}"
            table.append({**base, "shoe": "all", "seconds": outcome.seconds, "status": status})
            continue
        judged_by = true if outcome.model != reference else None
        for i in range(len(brake.shoes)):
            table.append({**base, **_table_row_of_shoe(brake, outcome.response, i, judged_by)})
        table.append({**base, **_table_row_of_whole_brake(outcome, judged_by)})
    return table


def _table_row_of_shoe(
    brake: Brake, response: Response, i: int, true: Response | None
) -> dict[str, Any]:
    """The values of one shoe in the table of a comparison, by the keys of its columns.

    Parameters
    ----------
    brake : the brake
    response : result of a model
    i : index of the shoe
    true : result that errors refer to; None for a row without errors
    """
    shoe = response.shoes[i]
    row = {
        "shoe": shoe.name,
        "torque": response.effects[i],
        "peak_pressure": shoe.peak_pressure,
        "reaction": float(np.linalg.norm(shoe.hinge_reaction)),
        "contact": text_of_contact_arcs(shoe, brake.surface),
        "self_energising": "yes" if shoe.self_energising else "no",
        "status": "converged" if response.converged else "not converged",
    }
    stated = shoe.error or {}
    row["stated_torque_error"] = stated.get("torque")
    row["stated_pressure_error"] = stated.get("pressure")
    # The errors are differences from the reference result, relative to it.
    if true is not None:
        other = true.shoes[i]
        row["torque_error"] = relative_error_of_number(response.effects[i], true.effects[i])
        row["peak_error"] = relative_error_of_number(shoe.peak_pressure, other.peak_pressure)
        row["pressure_error"] = relative_distance_of_pressures(
            shoe, other, length_of_uncompared_zone_at_lining_end(brake)
        )
        row["reaction_error"] = relative_distance_of_vectors(
            shoe.hinge_reaction, other.hinge_reaction
        )
    return row


def _table_row_of_whole_brake(
    outcome: ModelResultOrReasonOfFailure, true: Response | None
) -> dict[str, Any]:
    """The values of the whole brake by one model in the table of a comparison.

    `true` is the result that errors refer to; None for a row without errors.
    """
    assert outcome.response is not None
    effect = outcome.response.effect
    row = {"shoe": "all", "torque": effect, "seconds": outcome.seconds, "status": "converged"}
    row["stated_torque_error"] = (outcome.response.error or {}).get("torque")
    if true is not None:
        row["torque_error"] = relative_error_of_number(effect, true.effect)
    return row


def length_of_uncompared_zone_at_lining_end(brake: Brake) -> float:
    """Length of the zone at each end of a lining in which pressures are not compared.

    The length is an angle [rad] on a drum and a length [m] on a plane.
    """
    return UNCOMPARED_EDGE_ZONE_IN_RADIANS * brake.surface_coordinate_per_phi


def comparison_columns_for_brake(brake: Brake) -> tuple[ResultTableColumn, ...]:
    """The columns of the table of a comparison for this brake.

    For a brake on a plane the headings name the braking force in place of the torque, with its
    unit, and contact arcs are lengths in place of angles.
    """
    surface = brake.surface
    if not surface.is_plane_and_not_drum:
        return COLUMNS_OF_COMPARISON_TABLE
    # The keys are the same for drum and plane, so that programs can read both kinds of table.
    words: dict[str, dict[str, Any]] = {
        "rotation": {"heading": surface.name_of_moving_body},
        "torque": {
            "heading": surface.word_for_torque_or_brake_force,
            "unit": surface.unit_of_torque_or_brake_force,
        },
        "torque_error": {"heading": "error of the force"},
        "contact": {"unit": surface.shown_unit},
    }
    return tuple(
        column._replace(**words.get(column.key, {})) for column in COLUMNS_OF_COMPARISON_TABLE
    )


def table_as_csv_text(table: Sequence[dict[str, Any]]) -> str:
    """The rows of a table as CSV text, with a column for every key that occurs in a row.

    Texts that a spreadsheet would run as formulas get an apostrophe in front.
    """
    # The columns are in the order in which the keys first occur.
    keys = list(dict.fromkeys(chain.from_iterable(table)))
    text = io.StringIO()
    writer = csv.DictWriter(text, keys, lineterminator="\n")
    writer.writeheader()
    writer.writerows(
        {key: spreadsheet_cell_safe_from_being_run_as_formula(value) for key, value in row.items()}
        for row in table
    )
    return text.getvalue()


WIDTH_AND_HEIGHT_OF_FIGURE_WITH_LEGEND_BESIDE_AXES = (9.0, 4.8)
"""Size [inch] of the figure of a comparison, with room for the legend beside the axes."""


@dataclass(frozen=True, repr=False)
class ModelComparison(Generic[BrakeTypeVariable]):
    """A brake and its results by every model that applies; the finite elements come first.

    Attributes
    ----------
    case : name of the brake in tables
    brake : the brake
    outcomes : result of each model, or the reason why the model has no answer
    """

    case: str
    brake: BrakeTypeVariable
    outcomes: tuple[ModelResultOrReasonOfFailure, ...]

    @property
    def responses(self) -> dict[str, Response]:
        """The results of the models that have an answer, by the name of the model."""
        return {o.model: o.response for o in self.outcomes if o.response is not None}

    @property
    def rows(self) -> list[dict[str, Any]]:
        """The rows of the table: for each model one for each shoe, and one for the shoe "all".

        The values are in SI, and differences are fractions of the value by the finite elements in
        plane stress ("fem"). A value that only other rows have is None.

        - "torque" [N m], "peak_pressure" [Pa], "reaction" [N] and "contact" are the results.
        - "torque_error" is the difference of the torque from fem, with its sign, and "peak_error"
          that of the peak pressure.
        - "pressure_error" is the L2 norm of the difference of p(theta) from fem, divided by the L2
          norm of p by fem, without 0.2 degrees at each end of the lining.
        - "reaction_error" is the length of the difference of the two reactions, relative to fem.
        - "stated_torque_error" and "stated_pressure_error" are the errors that a model states.
        - "seconds" is the run time of the model, and "status" has the reason of a failure.
        """
        found = comparison_table_rows(self.brake, self.outcomes, case=self.case)
        keys = dict.fromkeys(chain.from_iterable(found))
        return [{key: row.get(key) for key in keys} for row in found]

    def __repr__(self) -> str:
        """The comparison as a table of text."""
        lines = text_lines_of_aligned_columns(self._cells_of_displayed_table())
        return "\n".join([self.case, *lines, *self._lines_below_displayed_table()])

    def _repr_html_(self) -> str:
        """The comparison as an HTML table, which notebooks display."""
        table = html_table_with_caption(self.case, self._cells_of_displayed_table())
        lines = [f"<div>{line}</div>" for line in self._lines_below_displayed_table()]
        return "".join([table, *lines])

    def _lines_below_displayed_table(self) -> list[str]:
        """A line that explains the differences from fem; none without differences."""
        if len(self.responses) < 2 or "fem" not in self.responses:
            return []
        return ["off fem: difference from plane-stress fem; p (L2) and peak p: the worst shoe's"]

    def _cells_of_displayed_table(self) -> list[tuple[str, ...]]:
        """The cells of the table as it is shown: headings, and a row for each model.

        The rows are those of the whole brake, with the differences in pressure of the worst shoe.
        Columns without a value are left out.
        """
        rows = [self._displayed_row_of_model(row) for row in self.rows if row["shoe"] == "all"]
        shown = []
        for column in comparison_columns_for_brake(self.brake):
            has_values = any(row.get(column.key) is not None for row in rows)
            if column.key not in {"case", "rotation", "shoe"} and has_values:
                heading = HEADINGS_OF_DISPLAYED_COMPARISON.get(column.key, column.heading)
                if self.brake.surface.is_plane_and_not_drum:
                    heading = heading.replace("torque", "force")
                shown.append(column._replace(heading=heading))
        head = tuple(column.title for column in shown)
        return [head, *(tuple(column.text(row) for column in shown) for row in rows)]

    def _displayed_row_of_model(self, whole: dict[str, Any]) -> dict[str, Any]:
        """The row of a model as it is shown, from the row of the whole brake `whole`.

        Errors that only the rows of the shoes have are those of the shoe with the largest.
        """
        row = dict(whole)
        shoes = [one for one in self.rows if one["model"] == whole["model"] != "fem"]
        for key in ("peak_error", "pressure_error"):
            known = [one[key] for one in shoes if one.get(key) is not None]
            row[key] = max(known, key=abs, default=None)
        response = self.responses.get(whole["model"])
        stated = {} if response is None else response.error or {}
        row["stated_torque_error"] = stated.get("torque")
        row["stated_pressure_error"] = stated.get("pressure")
        return row

    def plot(self, axes: Any = None) -> Any:
        """Draw the pressure of every shoe by every model, in MPa over degrees, on a plane over mm.

        A model has a colour, and a shoe a style of line. The curves are drawn into the given
        matplotlib `axes`, or into new axes if it is None. The method returns the axes. Raises
        BadInput for a value that is no axes of matplotlib.
        """
        has_own_figure = axes is None
        if axes is not None:
            axes = matplotlib_axes_itself_or_new(axes)
        for number, (model, response) in enumerate(self.responses.items()):
            axes = plot_pressure_of_each_shoe(
                response, axes, prefix=f"{model}, ", color=f"C{number}"
            )
        if axes is not None:
            axes.set_title(self.case)
            if has_own_figure:
                # So many entries would cover the curves. The layout makes room beside the axes.
                axes.figure.set_size_inches(WIDTH_AND_HEIGHT_OF_FIGURE_WITH_LEGEND_BESIDE_AXES)
                axes.figure.set_layout_engine("constrained")
                title = axes.get_legend().get_title().get_text()
                axes.legend(title=title, loc="upper left", bbox_to_anchor=(1.02, 1.0))
        return axes


def compare(
    brake: BrakeTypeVariable,
    case: str = "",
    repeats: int = 1,
    models: Sequence[str] | None = None,
    *,
    solid: bool = False,
    **options: Any,
) -> ModelComparison[BrakeTypeVariable]:
    """Solve a brake by all models that apply, side by side.

    The finite elements solve a brake with heated parts twice: hot, and cold.

    Parameters
    ----------
    brake : as `read_brake` gives it
    case : name of the brake in the table; "" for its title
    repeats : how often each model is solved and timed
    models : names of the models; None for all that apply but "solid"
    solid : whether "solid" is one of the models that None stands for
    options : options of the finite elements, as `solve` takes them

    Returns
    -------
    ModelComparison
        the results by model, and the rows of a table with errors relative to the finite elements,
        as fractions; a model without an answer has a row with the reason

    Raises
    ------
    BadInput
        for an unknown model or an option out of range
    """
    if repeats < 1:
        raise BadInput(f"repeats = {repeats}: must be at least 1")
    outcomes = []
    named = ("solid",) if solid else models or ()
    for name in models or ():
        require_known_model(name, "models")
    for name, reason in reasons_why_models_do_not_apply(brake, named).items():
        # A model that does not apply gets a row only if the user names it.
        if models is not None and name in models:
            outcomes.append(
                ModelResultOrReasonOfFailure(name, None, f"does not apply: {reason}", 0.0, 0)
            )
    for model in applicable_models(brake, named):
        if models is not None and model.name not in models:
            continue
        own_options = options if model.name == "fem" else {}
        # A model that takes seconds is timed once.
        times = 1 if model.by_name else repeats
        outcomes.append(
            solve_and_time_model(model.name, partial(model.solve, brake, **own_options), times)
        )
        # A heated brake is also solved without its heat, for comparison.
        if model.name == "fem" and names_of_heated_parts(brake):
            solve = partial(_solve_brake_without_heat, model, brake, **own_options)
            outcomes.append(solve_and_time_model(NAME_OF_RESULT_WITHOUT_HEAT, solve, times))
    return ModelComparison(case or brake.title, brake, tuple(outcomes))


def _solve_brake_without_heat(model: Model, brake: Brake, **options: Any) -> Response:
    """The result of a model for a heated brake without its heat."""
    response = model.solve(brake_with_heat_only_in_given_parts(brake, ()), **options)
    return replace(response, model=NAME_OF_RESULT_WITHOUT_HEAT)


@dataclass(frozen=True)
class ResultsOnRefinedMeshes:
    """The results of a brake on several meshes, each with twice as many elements as the one before.

    Attributes
    ----------
    elements : number of elements along each lining, for each mesh from coarse to fine
    responses : result on each mesh
    """

    elements: tuple[int, ...]
    responses: tuple[Response, ...]

    @property
    def torque(self) -> RichardsonLimit:
        """The torque of the brake [N m] extrapolated from the three finest meshes to its limit."""
        return richardson_limit_from_three_meshes(
            *(response.torque for response in self.responses[-3:])
        )

    def relative_pressure_distances_between_meshes(self, shoe: int) -> list[float]:
        """Relative L2 distances between the pressures of a shoe on successive meshes.

        `shoe` is the index of the shoe. Zones at both ends of the lining are left out.
        """
        pairs = pairwise(self.responses)
        return [relative_distance_of_pressures(a.shoes[shoe], b.shoes[shoe]) for a, b in pairs]

    def pressure(self, shoe: int) -> tuple[float, float]:
        """Observed order of convergence of a shoe's pressure, and its error on the finest mesh.

        `shoe` is the index of the shoe. The error is the relative L2 distance of the pressure on
        the finest mesh from its limit. This distance is extrapolated from the distances between
        successive meshes.
        """
        # Distances are extrapolated as values of which the finest mesh has the value 0. The
        # uncertainty of their limit is then the distance of the finest mesh from the limit.
        first, last = self.relative_pressure_distances_between_meshes(shoe)[-2:]
        limit = richardson_limit_from_changes_between_meshes(0.0, first, last)
        return limit.order, limit.uncertainty


def solve_on_refined_meshes(brake: Brake, elements: Sequence[int]) -> ResultsOnRefinedMeshes:
    """Solve a brake by finite elements on several meshes, without penalty in the contact.

    `elements` are the numbers of elements along each lining, from coarse to fine.
    """
    # The finite elements are imported only when they are used.
    from drumlin.fem.solve import solve  # noqa: PLC0415

    responses = tuple(solve(brake, elements=n, penalty=math.inf) for n in elements)
    return ResultsOnRefinedMeshes(tuple(elements), responses)
