"""What leaving things out costs and saves: the brakes, and the section of the report."""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from drumlin.brake.drum_brake import Brake
from drumlin.brake.file import read_brake, vary
from drumlin.comparison import as_csv
from drumlin.fem.assembly import ELEMENTS
from drumlin.files import write_text
from drumlin.journal import Journal
from drumlin.report.figures import save
from drumlin.report.left_out_figure import predictions
from drumlin.report.page import Figure, Section, Table, Text
from drumlin.verification.omission_table import COLUMNS, omissions

STUDIES = Path(__file__).parents[1]
IRON, STEEL, LAYER = {"E": 1.2e11, "nu": 0.25}, {"E": 2.1e11, "nu": 0.3}, {"E": 1e10, "nu": 0.3}


def _ring(support: str, thickness: float = 0.015, E: float = 1.2e11) -> dict[str, Any]:
    material = {**IRON, "E": E}
    return {"drum.ring": {"thickness": thickness, "width": 0.04, "material": material, "support": support}}


def _backing(thickness: float = 0.005, E: float = 1e10) -> dict[str, Any]:
    return {"shoe.backing": {"thickness": thickness, "material": {**LAYER, "E": E}}}


def brakes(*, short: bool = False) -> dict[str, Brake]:
    """The brakes of the table, by name."""
    main = read_brake(STUDIES / "double_shoe" / "brake.toml")
    found = {
        "double shoe": main,
        "double shoe, ring fixed": vary(main, _ring("fixed")),
    }
    if short:
        return found
    return found | {
        "double shoe, ring free": vary(main, _ring("free")),
        "double shoe, backing": vary(main, _backing()),
        "double shoe, mu = 0": vary(main, {"friction": 0.0}),
        "flexible double shoe": read_brake(STUDIES / "double_shoe" / "flexible.toml"),
        "post brake": read_brake(STUDIES / "post_brake" / "brake.toml"),
    }


def ladder(*, short: bool = False) -> dict[str, Brake]:
    """Brakes from stiff to soft, on which predictions are held against the truth, without timing."""
    main = read_brake(STUDIES / "double_shoe" / "brake.toml")
    shoes = {f"shoe E = {E:.0e} Pa": vary(main, {"shoe.body.material.E": E}) for E in (2.1e12, 2.1e13, 2.1e14, 2.1e15)}
    if short:
        return dict(list(shoes.items())[::2])
    free = {f"free ring, E = {E:.0e} Pa": vary(main, _ring("free", 0.03, E)) for E in (1e9, 1.2e11, 2e12, 2e13, 2e14)}
    fixed = {f"fixed ring, E = {E:.0e} Pa": vary(main, _ring("fixed", 0.015, E)) for E in (3e8, 1e9, 1e10, 1e13)}
    layers = {f"backing E = {E:.0e} Pa": vary(main, _backing(0.003, E)) for E in (3e8, 3e9, 1e11)}
    rigid = {
        f"rigid shoe, backing E = {E:.0e} Pa": vary(main, {"shoe.body": None} | _backing(0.003, E))
        for E in (3e8, 3e9, 3e10)
    }
    friction = {f"rigid shoe, mu = {mu:g}": vary(main, {"shoe.body": None, "friction": mu}) for mu in (0.02, 0.5)}
    return shoes | free | fixed | layers | rigid | friction


def rows_of(
    journal: Journal, *, short: bool = False, say: Callable[[str], None] = lambda _: None
) -> list[dict[str, Any]]:
    """The rows of all brakes, each brake one case of the journal: those of the table timed, those of the ladder not."""
    rows: list[dict[str, Any]] = []
    cases = [(name, brake, 1 if short else 5) for name, brake in brakes(short=short).items()]
    cases += [(name, brake, 0) for name, brake in ladder(short=short).items()]
    for name, brake, repeats in cases:
        say(f"left out: {name}")
        compute = partial(_case, brake, name, repeats, 40 if short else ELEMENTS)
        rows += journal.once({"left out": name, "short": short}, compute)["rows"]
    return rows


def _case(brake: Brake, name: str, repeats: int, elements: int) -> dict[str, Any]:
    return {"rows": omissions(brake, name, elements=elements, repeats=repeats)}


def section(rows: Sequence[dict[str, Any]], folder: Path) -> Section:
    """The section of the report: figure, table, what it says. `rows`: of `left_out.omissions`, timed ones in the table."""
    write_text(folder / "left_out.csv", as_csv(rows))
    figure = save(predictions(rows), folder / "left_out.svg")
    timed = [row for row in rows if "seconds" in row or row["status"] != "converged"]
    return Section(
        "What leaving things out costs",
        [
            Text(
                "Each part is left out alone, and then all of them together; the change is that between both solutions on "
                "one mesh. Three omissions change nothing: the inside of the bodies, the second of two equal shoes, and "
                "without friction the flexibility under drag. drumlin always makes them. "
                "The other changes are predicted beforehand on a sketch: the lining on a coarse mesh, the shoe a curved "
                "bar, the ring a series of waves in closed form, nothing calibrated. It takes some ten milliseconds, and "
                "needs neither the shoe's mesh nor the ring's."
            ),
            Figure(
                figure,
                "Predicted over true change of the shoes' torques and of p, on brakes from stiff to soft. Line: equal; band: "
                "within a factor 2. The shoes' changes count with one sign: of the brake's torque they cancel in part.",
            ),
            Text(_said(rows)),
            Table(
                timed,
                COLUMNS,
                "Time: share of the process's own time saved; memory: of the largest amount held by Python and NumPy.",
            ),
            Text(
                "Left out are: <em>ring</em>, the drum taken as rigid; <em>coupling</em>, each shoe meets the elastic ring as "
                "if the other did not press it; <em>shoe</em>, its arc taken as rigid (a post's beam and block stay: "
                "the block has no shape without the beam); <em>backing</em>, the shoe then lies behind the lining at once; "
                "<em>drag</em>, friction enters the moments about the hinge and does not shear shoe, lining and ring; "
                "<em>curvature</em>, the edges of the elements are straight, and the gap between chord and drum counts."
            ),
        ],
    )


def _said(rows: Sequence[dict[str, Any]]) -> str:
    """How good the predictions are, and what is worth leaving out, in words that the rows give."""
    ratios = {
        key: [
            row[f"predicted_{key}"] / row[key]
            for row in rows
            if row["exact"] == "no" and row["part"] not in {"curvature", "all"} and 1e-4 < (row.get(key) or 0.0) < 0.3
        ]
        for key in ("torque", "shoes", "pressure")
    }
    parts = [
        f"{min(ratios[key]):.2f} to {max(ratios[key]):.2f} times the truth for {name} ({len(ratios[key])} cases)"
        for key, name in (
            ("pressure", "p"),
            ("shoes", "the shoes' torques, counted with one sign"),
            ("torque", "the brake's torque, in which these cancel in part"),
        )
        if ratios[key]
    ]
    said = []
    if parts:
        said.append(
            f"Where the true change lies between 0.01 % and 30 %, the prediction is {'; '.join(parts)}; curvature apart. "
            "What is promised of the torque is therefore the second, which bounds the third."
        )
    saving: dict[str, list[float]] = {}
    for row in rows:
        if row["exact"] == "no" and "seconds" in row and not row["part"].startswith("all"):
            saving.setdefault(row["part"], []).append(row["seconds"])
    worth = [f"{part} {100 * min(v):.0f} to {100 * max(v):.0f} %" for part, v in saving.items() if max(v) > 0.2]
    if worth:
        said.append(
            f"Time is saved by leaving out {', '.join(worth)}; the rest is next to free and is always computed. "
            "<code>drumlin solve --tolerance X</code> leaves out ring and shoe where half of X covers 1.5 times the "
            "predicted change, says so, and counts it in the error that it states."
        )
    straight = [row for row in rows if row["part"] == "curvature" and row.get("pressure")]
    if straight:
        worst = max(straight, key=lambda row: row["pressure"])
        said.append(
            f"Straight edges save nothing and cost most, {100 * worst['pressure']:.0f} % of p on {worst['brake']}: the "
            "height of a chord is as large as the lining's compression, so that the lining touches only at the "
            "elements' ends. There the prediction, which is linear, says more than all. Finer meshes help little: "
            "shorter waves are lower with the square of their length, but the lining answers them the stiffer, so that "
            "p errs by half as much for twice the elements."
        )
    return " ".join(said)
