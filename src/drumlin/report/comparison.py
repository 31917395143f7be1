"""The report of `drumlin compare`, and the pieces of it that studies use."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from drumlin.base.errors import NoAnswer
from drumlin.base.files import write_text
from drumlin.brake.brake import Brake
from drumlin.comparison import Column, Comparison, as_csv, columns_of, compare
from drumlin.fem.preparation.finite_width import finite_width
from drumlin.models import refusals
from drumlin.report import figures
from drumlin.report.page import fill, versions
from drumlin.response.balance import loaded
from drumlin.response.response import Response


class Written(NamedTuple):
    """What a comparison left: its table, lines for people, and the page."""

    table: list[dict[str, Any]]
    notes: list[str]
    page: Path
    columns: tuple[Column, ...]


def panels(comparison: Comparison[Any]) -> list[tuple[str, dict[str, Any]]]:
    """A panel of pressures for each shoe: every model that answered."""
    brake = comparison.brake
    made = []
    for i, shoe in enumerate(brake.shoes):
        responses = {model: response.shoes[i] for model, response in comparison.responses.items()}
        if responses:
            helps = any(response.self_energising for response in responses.values())
            made.append(
                (
                    f"{shoe.name}, {brake.sense}: friction {'assists' if helps else 'opposes'}",
                    responses,
                )
            )
    return made


def draw_fields(
    brake: Brake, response: Response, folder: Path, name: str, **options: Any
) -> str | None:
    """Write name.vtu and, where off-screen rendering works, name.png; says why there is no picture,
    None if there is.

    `options`: those of the scene. A page shows what came of it by the macro `fields`.
    """
    from drumlin.fem.analysis.fields import all_fields, write_vtu  # noqa: PLC0415  (only where a picture is asked for)
    from drumlin.fem.solve import scene_of  # noqa: PLC0415
    from drumlin.report.render import render  # noqa: PLC0415

    brake.check_meshable()
    scene = scene_of(brake, **options)
    write_vtu(folder / f"{name}.vtu", all_fields(scene, brake, response))
    title = f"{brake.title}, {brake.motion}"
    return render(folder / f"{name}.vtu", folder / f"{name}.png", loaded(brake, response), title)


def results_json(comparisons: Sequence[Comparison[Any]], **more: Any) -> str:
    """Every number of some comparisons as JSON text, with versions; seconds of each model are
    medians.
    """
    cases = [
        {
            "case": c.case,
            "rotation": c.brake.sense,
            "friction": c.brake.friction,
            "models": [
                {
                    **(
                        o.response.as_dict()
                        if o.response
                        else {"model": o.model, "failed": o.failure}
                    ),
                    "run_time": o.seconds,
                    "repeats": o.repeats,
                }
                for o in c.outcomes
            ],
        }
        for c in comparisons
    ]
    return json.dumps({"versions": versions(), "cases": cases, **more}, indent=1) + "\n"


def write_comparison(brake: Brake, source: str, folder: Path, options: dict[str, Any]) -> Written:
    """Compare all models that apply to a brake and write page, CSV, JSON, figure, fields into
    `folder`.

    Raises NoAnswer, and writes nothing, where no model has an answer.
    """
    comparison = compare(brake, repeats=3, **options)
    if not comparison.responses:
        raise NoAnswer("; ".join(f"{o.model}: {o.failure}" for o in comparison.outcomes))
    table = comparison.rows
    write_text(folder / "results.csv", as_csv(table))
    write_text(folder / "results.json", results_json([comparison]))
    figures.save(
        figures.pressures(panels(comparison), surface=brake.surface), folder / "pressure.svg"
    )
    fem = comparison.responses.get("fem")
    drawn, not_drawn = False, None
    if fem is not None and any(shoe.contact_arcs for shoe in fem.shoes):
        drawn = True
        chosen = {k: v for k, v in options.items() if k in {"elements", "kind"}}
        drawn_as = finite_width(brake) if options.get("finite_width") else brake
        not_drawn = draw_fields(drawn_as, fem, folder, "fields", **chosen)
    notes = [
        f"{o.model}: {line}" for o in comparison.outcomes if o.response for line in o.response.notes
    ]
    notes += [f"{name}: does not apply: {reason}" for name, reason in refusals(brake).items()]
    left = [
        f"{o.model} left out {line}"
        for o in comparison.outcomes
        if o.response
        for line in o.response.left_out
    ]
    page = fill(
        Path(__file__).with_name("comparison.html"),
        folder / "index.html",
        brake=brake,
        rows=table,
        columns=columns_of(brake),
        drawn=drawn,
        not_drawn=not_drawn,
        notes=notes + left,
        source_text=source,
    )
    return Written(table, notes, page, columns_of(brake))
