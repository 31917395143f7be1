"""Models side by side: their outcomes, the distances between their responses, and a table of both.

The module also finds observed orders and limits of a value as meshes are refined.
"""

import csv
import io
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain, pairwise
from statistics import median
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from drumlin.base.errors import NoAnswer
from drumlin.base.files import cell
from drumlin.base.texts import formatted
from drumlin.brake.brake import Brake
from drumlin.models import applicable
from drumlin.response.norms import pressure_distance, relative, vector_distance
from drumlin.response.response import EDGE_ZONE, Response
from drumlin.response.show import arcs_text

BrakeKind = TypeVar("BrakeKind", bound=Brake)


@dataclass(frozen=True)
class Outcome:
    """The response of a model to a brake, or the reason why there is none.

    Attributes
    ----------
    model : name of the model
    response : its response; None where it has none
    failure : why it has none
    seconds : of a solve, median of the repeats
    repeats : number of solves
    """

    model: str
    response: Response | None
    failure: str
    seconds: float
    repeats: int


def run(name: str, solve: Callable[[], Response], repeats: int = 1) -> Outcome:
    """Solve by a model; a refusal (NoAnswer) is an outcome, not an error.

    Parameters
    ----------
    name : of the model
    solve : solves the brake
    repeats : how often it is called and timed
    """
    seconds, response, failure = [], None, ""
    for _ in range(repeats):
        start = time.perf_counter()
        try:
            response = solve()
        except NoAnswer as error:
            failure = str(error)
        seconds.append(time.perf_counter() - start)
    return Outcome(name, response, failure, median(seconds), repeats)


class Extrapolated(NamedTuple):
    """A Richardson extrapolation from three meshes.

    Attributes
    ----------
    order : observed order of convergence; nan where no order is seen
    value : the limit
    uncertainty : of the limit, as large as its correction
    """

    order: float
    value: float
    uncertainty: float


def richardson(fine: float, first: float, last: float, ratio: float = 2.0) -> Extrapolated:
    """The limit of a value as meshes are refined, by Richardson extrapolation.

    Where the steps do not shrink with one sign, no limit is seen. The finest value then stands for
    the limit, with the larger step as its uncertainty. Its order is nan; steps that shrink with
    changing sign keep their order.

    Parameters
    ----------
    fine : the value on the finest of three meshes
    first : the step of the value from the coarsest mesh to the next
    last : the step from there to the finest mesh
    ratio : how many times as fine each mesh is as the one before
    """
    if last == 0:
        return Extrapolated(math.nan, fine, abs(first))
    # The factor by which the steps shrink.
    gain = first / last
    order = math.log(abs(gain), ratio) if abs(gain) > 1 else math.nan
    if gain <= 1:
        return Extrapolated(order, fine, max(abs(first), abs(last)))
    # The steps after the finest mesh would form a geometric series with the ratio 1/gain.
    correction = last / (gain - 1)
    return Extrapolated(order, fine + correction, abs(correction))


def extrapolate(coarse: float, medium: float, fine: float, ratio: float = 2.0) -> Extrapolated:
    """`richardson` of the values on three meshes."""
    return richardson(fine, medium - coarse, fine - medium, ratio)


class TableColumn(NamedTuple):
    """A column of a table for people.

    Attributes
    ----------
    key : of the row's value
    heading : of the column
    unit : in which the value is shown
    factor : from SI to this unit
    form : format of the number
    """

    key: str
    heading: str
    unit: str = ""
    factor: float = 1.0
    form: str = ".4g"

    def text(self, row: dict[str, Any]) -> str:
        """The cell of a row as people read it."""
        value = row.get(self.key)
        if value is None or (isinstance(value, float) and math.isnan(value)):
            return "–"
        if not isinstance(value, int | float):
            return str(value)
        # A factor of 1 would turn whole numbers into fractions.
        return formatted(value if self.factor == 1 else value * self.factor, self.form)

    @property
    def title(self) -> str:
        """The heading with its unit."""
        return f"{self.heading} [{self.unit}]" if self.unit else self.heading


COLUMNS = (
    TableColumn("case", "case"),
    TableColumn("rotation", "drum turns"),
    TableColumn("shoe", "shoe"),
    TableColumn("model", "model"),
    TableColumn("torque", "torque", "N m", 1, ".5g"),
    TableColumn("torque_error", "error of torque", "%", 100, "+.2f"),
    TableColumn("peak_pressure", "peak pressure", "MPa", 1e-6, ".4g"),
    TableColumn("peak_error", "error of peak", "%", 100, "+.1f"),
    TableColumn("pressure_error", "error of p (L2)", "%", 100, ".1f"),
    TableColumn("reaction", "hinge reaction", "N", 1, ".5g"),
    TableColumn("reaction_error", "error of reaction", "%", 100, ".1f"),
    TableColumn("contact", "contact arcs", "deg"),
    TableColumn("self_energising", "self-energising"),
    TableColumn("seconds", "run time", "ms", 1e3, ".3g"),
    TableColumn("status", "status"),
)
"""The columns of a comparison, in the order of its table."""


def rows(
    brake: Brake, outcomes: Sequence[Outcome], reference: str = "fem", case: str | None = None
) -> list[dict[str, Any]]:
    """One row for each model and shoe, and a row "all" for the whole brake by each model.

    The keys are those of COLUMNS, the values in SI, errors as fractions. On a plane the braking
    force [N] takes the place of the torque. A model without an answer has one row that says why.

    Parameters
    ----------
    brake : the brake
    outcomes : of the models
    reference : name of the model that errors refer to
    case : name of the brake in the table; None: its title
    """
    # Without the reference, as where it has no answer, the rows state no errors.
    true = next((o.response for o in outcomes if o.model == reference), None)
    table: list[dict[str, Any]] = []
    for outcome in outcomes:
        base = {"case": case or brake.title, "rotation": brake.sense, "model": outcome.model}
        if outcome.response is None:
            status = f"failed: {outcome.failure}"
            table.append({**base, "shoe": "all", "seconds": outcome.seconds, "status": status})
            continue
        judged_by = true if outcome.model != reference else None
        for i in range(len(brake.shoes)):
            table.append({**base, **_shoe_row(brake, outcome.response, i, judged_by)})
        table.append({**base, **_whole_row(outcome, judged_by)})
    return table


def _shoe_row(brake: Brake, response: Response, i: int, true: Response | None) -> dict[str, Any]:
    """The values of one shoe.

    Parameters
    ----------
    brake : the brake
    response : of a model
    i : position of the shoe
    true : response that errors refer to; None: no errors
    """
    shoe = response.shoes[i]
    row = {
        "shoe": shoe.name,
        "torque": response.effects[i],
        "peak_pressure": shoe.peak_pressure,
        "reaction": float(np.linalg.norm(shoe.hinge_reaction)),
        "contact": arcs_text(shoe, brake.surface),
        "self_energising": "yes" if shoe.self_energising else "no",
        "status": "converged" if response.converged else "not converged",
    }
    if true is not None:
        other = true.shoes[i]
        row["torque_error"] = relative(response.effects[i], true.effects[i])
        row["peak_error"] = relative(shoe.peak_pressure, other.peak_pressure)
        row["pressure_error"] = pressure_distance(shoe, other, edge_of(brake))
        row["reaction_error"] = vector_distance(shoe.hinge_reaction, other.hinge_reaction)
    return row


def _whole_row(outcome: Outcome, true: Response | None) -> dict[str, Any]:
    """The values of the whole brake by one model; `true`: response that errors refer to."""
    assert outcome.response is not None
    effect = outcome.response.effect
    row = {"shoe": "all", "torque": effect, "seconds": outcome.seconds, "status": "converged"}
    if true is not None:
        row["torque_error"] = relative(effect, true.effect)
    return row


def edge_of(brake: Brake) -> float:
    """The length of the zones at a lining's ends in which no pressure is compared.

    It is in the coordinate of the brake's surface.
    """
    return EDGE_ZONE * brake.unit


def columns_of(brake: Brake) -> tuple[TableColumn, ...]:
    """The columns of a table of a brake.

    On a plane the braking force takes the place of the torque, and lengths that of angles.
    """
    surface = brake.surface
    if not surface.straight:
        return COLUMNS
    # Keys stay those of a drum, so that programs read both kinds of table alike.
    words: dict[str, dict[str, Any]] = {
        "rotation": {"heading": surface.moving},
        "torque": {"heading": surface.effect, "unit": surface.effect_unit},
        "torque_error": {"heading": "error of the force"},
        "contact": {"unit": surface.shown_unit},
    }
    return tuple(column._replace(**words.get(column.key, {})) for column in COLUMNS)


def as_csv(table: Sequence[dict[str, Any]]) -> str:
    """A table in SI units as CSV text, with a column for every key that occurs.

    No text in it is a formula to a spreadsheet.
    """
    # A dict keeps the order in which the keys first occur.
    keys = list(dict.fromkeys(chain.from_iterable(table)))
    text = io.StringIO()
    writer = csv.DictWriter(text, keys, lineterminator="\n")
    writer.writeheader()
    writer.writerows({key: cell(value) for key, value in row.items()} for row in table)
    return text.getvalue()


@dataclass(frozen=True)
class Comparison(Generic[BrakeKind]):
    """A brake and the outcome of every model that applies; the finite elements come first."""

    case: str
    brake: BrakeKind
    outcomes: tuple[Outcome, ...]

    @property
    def responses(self) -> dict[str, Response]:
        """The responses of the models that answered, by model."""
        return {o.model: o.response for o in self.outcomes if o.response is not None}

    @property
    def rows(self) -> list[dict[str, Any]]:
        """The comparison as rows of a table, errors against the finite elements."""
        return rows(self.brake, self.outcomes, case=self.case)


def compare(
    brake: BrakeKind,
    case: str = "",
    repeats: int = 1,
    models: Sequence[str] | None = None,
    **options: Any,
) -> Comparison[BrakeKind]:
    """Solve a brake by all models that apply, side by side.

    Parameters
    ----------
    brake : as `read_brake` gives it
    case : a name for the table; "": the brake's title
    repeats : how often each model is timed
    models : names of the models; None: all that apply
    options : of the finite elements, as `solve` takes them

    Returns
    -------
    the comparison: `responses` by model, `rows` of a table with the errors against the finite
    elements (fractions); a model that has no answer is a row that says why

    Raises
    ------
    BadInput
        for an option out of range
    """
    outcomes = []
    for model in applicable(brake):
        if models is None or model.name in models:
            # The options are those of the finite elements; no other model takes them.
            own_options = options if model.name == "fem" else {}
            outcomes.append(run(model.name, partial(model.solve, brake, **own_options), repeats))
    return Comparison(case or brake.title, brake, tuple(outcomes))


@dataclass(frozen=True)
class Convergence:
    """A brake on meshes that double, with observed orders and limits.

    Attributes
    ----------
    elements : along each lining, on each mesh
    responses : on each mesh
    """

    elements: tuple[int, ...]
    responses: tuple[Response, ...]

    @property
    def torque(self) -> Extrapolated:
        """The limit of the torque of the brake [N m], from the three finest meshes."""
        return extrapolate(*(response.torque for response in self.responses[-3:]))

    def pressure_steps(self, shoe: int) -> list[float]:
        """Relative L2 distances of p between each mesh and the next finer one.

        They leave out the edge zones.
        """
        pairs = pairwise(self.responses)
        return [pressure_distance(a.shoes[shoe], b.shoes[shoe]) for a, b in pairs]

    def pressure(self, shoe: int) -> tuple[float, float]:
        """Observed order of p in L2, and the estimated error of the finest mesh.

        The error is the relative L2 distance of the finest p from its limit, by extrapolation of
        the distances between successive meshes.
        """
        # With the value 0 for the finest p, the uncertainty is the distance of p from its limit.
        first, last = self.pressure_steps(shoe)[-2:]
        limit = richardson(0.0, first, last)
        return limit.order, limit.uncertainty


def converge(brake: Brake, elements: Sequence[int]) -> Convergence:
    """Solve a brake on several meshes, coarse to fine, with exact contact."""
    # The finite elements load only where they are used.
    from drumlin.fem.solve import solve  # noqa: PLC0415

    responses = tuple(solve(brake, elements=n, penalty=math.inf) for n in elements)
    return Convergence(tuple(elements), responses)
