"""Models side by side: outcomes, distances between responses, observed orders, and the table of all
that.
"""

import csv
import io
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
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

B = TypeVar("B", bound=Brake)


@dataclass(frozen=True)
class Outcome:
    """What a model made of a brake: its response, or why there is none; seconds: median of the
    repeats.
    """

    model: str
    response: Response | None
    failure: str
    seconds: float
    repeats: int


def run(name: str, solve: Callable[[], Response], repeats: int = 1) -> Outcome:
    """Run a model `repeats` times; a refusal (NoAnswer) is an outcome, not an error."""
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
    """Richardson extrapolation from three meshes: observed order, value, its uncertainty."""

    order: float
    value: float
    uncertainty: float


def richardson(fine: float, first: float, last: float, ratio: float = 2.0) -> Extrapolated:
    """The limit of a value as meshes are refined, by Richardson extrapolation.

    Where the steps do not shrink with one sign, no limit is seen: the finest value stands, with the
    larger step as its uncertainty. Its order is nan, or that of steps which shrink with changing
    sign.

    Parameters
    ----------
    fine : the value on the finest of three meshes
    first : the step of the value from the coarsest mesh to the next
    last : the step from there to the finest mesh
    ratio : how many times as fine each mesh is as the one before
    """
    if last == 0:
        return Extrapolated(math.nan, fine, abs(first))
    gain = first / last
    order = math.log(abs(gain), ratio) if abs(gain) > 1 else math.nan
    if gain <= 1:
        return Extrapolated(order, fine, max(abs(first), abs(last)))
    correction = last / (gain - 1)
    return Extrapolated(order, fine + correction, abs(correction))


def extrapolate(coarse: float, medium: float, fine: float, ratio: float = 2.0) -> Extrapolated:
    """`richardson` of the values on three meshes."""
    return richardson(fine, medium - coarse, fine - medium, ratio)


class TableColumn(NamedTuple):
    """A column of a table: key of the row, heading, unit as people read it, factor from SI, format."""

    key: str
    heading: str
    unit: str = ""
    factor: float = 1.0
    form: str = ".4g"

    def text(self, row: dict[str, Any]) -> str:
        """The cell as people read it."""
        value = row.get(self.key)
        if value is None or (isinstance(value, float) and math.isnan(value)):
            return "–"
        if not isinstance(value, int | float):
            return str(value)
        return formatted(value if self.factor == 1 else value * self.factor, self.form)

    @property
    def title(self) -> str:
        """Heading with unit."""
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


def rows(
    brake: Brake, outcomes: Sequence[Outcome], reference: str = "fem", case: str | None = None
) -> list[dict[str, Any]]:
    """One row a model and shoe, errors against the outcome called `reference`; failed models stay
    as rows.

    On a plane the braking force [N] stands in the place of the torque.

    Keys as in COLUMNS, values in SI, errors as fractions. Torque of the whole brake: the row "all".
    """
    true = next((o.response for o in outcomes if o.model == reference), None)
    table: list[dict[str, Any]] = []
    for outcome in outcomes:
        base = {"case": case or brake.title, "rotation": brake.sense, "model": outcome.model}
        if outcome.response is None:
            table.append(
                {
                    **base,
                    "shoe": "all",
                    "seconds": outcome.seconds,
                    "status": f"failed: {outcome.failure}",
                }
            )
            continue
        response, judged = outcome.response, true is not None and outcome.model != reference
        for i, shoe in enumerate(response.shoes):
            row = {
                **base,
                "shoe": shoe.name,
                "torque": response.effects[i],
                "peak_pressure": shoe.peak_pressure,
                "reaction": float(np.linalg.norm(shoe.hinge_reaction)),
                "contact": arcs_text(shoe, brake.surface),
                "self_energising": "yes" if shoe.self_energising else "no",
                "status": "converged" if response.converged else "not converged",
            }
            if judged and true is not None:
                other = true.shoes[i]
                row["torque_error"] = relative(response.effects[i], true.effects[i])
                row["peak_error"] = relative(shoe.peak_pressure, other.peak_pressure)
                row["pressure_error"] = pressure_distance(shoe, other, edge_of(brake))
                row["reaction_error"] = vector_distance(shoe.hinge_reaction, other.hinge_reaction)
            table.append(row)
        whole = {
            **base,
            "shoe": "all",
            "torque": response.effect,
            "seconds": outcome.seconds,
            "status": "converged",
        }
        if judged and true is not None:
            whole["torque_error"] = relative(response.effect, true.effect)
        table.append(whole)
    return table


def edge_of(brake: Brake) -> float:
    """The zones at a lining's ends in which no pressure is compared, in the coordinate of the
    brake's surface.
    """
    return EDGE_ZONE * brake.unit


def columns_of(brake: Brake) -> tuple[TableColumn, ...]:
    """The columns of a table of a brake: on a plane the braking force stands for the torque,
    lengths for angles.
    """
    surface = brake.surface
    if not surface.straight:
        return COLUMNS
    words: dict[str, dict[str, Any]] = {
        "rotation": {"heading": surface.moving},
        "torque": {"heading": surface.effect, "unit": surface.effect_unit},
        "torque_error": {"heading": "error of the force"},
        "contact": {"unit": surface.shown_unit},
    }
    return tuple(column._replace(**words.get(column.key, {})) for column in COLUMNS)


def as_csv(table: Sequence[dict[str, Any]]) -> str:
    """A table in SI units as CSV text; columns: every key that occurs. No text in it is a
    spreadsheet's formula.
    """
    keys = list(dict.fromkeys(key for row in table for key in row))
    text = io.StringIO()
    writer = csv.DictWriter(text, keys, lineterminator="\n")
    writer.writeheader()
    writer.writerows({key: cell(value) for key, value in row.items()} for row in table)
    return text.getvalue()


@dataclass(frozen=True)
class Comparison(Generic[B]):
    """A brake and what every model that applies made of it; the finite elements come first."""

    case: str
    brake: B
    outcomes: tuple[Outcome, ...]

    @property
    def responses(self) -> dict[str, Response]:
        """Model -> response, of the models that answered."""
        return {o.model: o.response for o in self.outcomes if o.response is not None}

    @property
    def rows(self) -> list[dict[str, Any]]:
        """The comparison as rows of a table, errors against the finite elements."""
        return rows(self.brake, self.outcomes, case=self.case)


def compare(
    brake: B, case: str = "", repeats: int = 1, models: Sequence[str] | None = None, **options: Any
) -> Comparison[B]:
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
    outcomes = [
        run(
            model.name,
            partial(model.solve, brake, **(options if model.name == "fem" else {})),
            repeats,
        )
        for model in applicable(brake)
        if models is None or model.name in models
    ]
    return Comparison(case or brake.title, brake, tuple(outcomes))


@dataclass(frozen=True)
class Convergence:
    """A brake on meshes that double: `elements` along the lining and the responses; order, limit,
    uncertainty.

    `torque` and, for each shoe, `pressure`: the L2 distance of the finest p from its limit, by
    extrapolation of the distances between successive meshes, outside the edge zones.
    """

    elements: tuple[int, ...]
    responses: tuple[Response, ...]

    @property
    def torque(self) -> Extrapolated:
        """The torque of the brake [N m] from the three finest meshes."""
        return extrapolate(*(response.torque for response in self.responses[-3:]))

    def pressure_steps(self, shoe: int) -> list[float]:
        """Relative L2 distances of p between each mesh and the next finer one."""
        return [
            pressure_distance(a.shoes[shoe], b.shoes[shoe]) for a, b in pairwise(self.responses)
        ]

    def pressure(self, shoe: int) -> tuple[float, float]:
        """Observed order of p in L2 and the estimated error of the finest mesh."""
        first, last = self.pressure_steps(shoe)[-2:]
        found = richardson(0.0, first, last)
        return found.order, found.uncertainty


def converge(brake: Brake, elements: Sequence[int]) -> Convergence:
    """Solve a brake on several meshes, coarse to fine, with exact contact."""
    from drumlin.fem.solve import solve  # noqa: PLC0415  (finite elements load only where they are used)

    return Convergence(
        tuple(elements), tuple(solve(brake, elements=n, penalty=math.inf) for n in elements)
    )
