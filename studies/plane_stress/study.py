"""How far is plane stress from a solid shoe, with table and web, and which brakes may be priced by it?"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from studies.plane_stress import figures

from drumlin.brake.file import read_brake, vary
from drumlin.comparison import as_csv
from drumlin.fem.assembly import prepare
from drumlin.fem.model import respond
from drumlin.fem.solid import model as solid
from drumlin.fem.solid.fields import recover, write_vtu
from drumlin.files import write_text
from drumlin.report import figures as drawing
from drumlin.report.page import fill
from drumlin.report.solid_picture import render
from drumlin.verification import plane_stress as rows
from drumlin.verification.plane_stress import Certain, Map, Rung, Three, Worn
from drumlin.verification.uncertainty import Validation

HERE = Path(__file__).parent
WIDTHS: Sequence[float] = (1.0, 2.0, 5.0, 10.0, 20.0)  # over the lining's thickness
MODULI: Sequence[float] = (50.0, 150.0, 300.0, 1000.0, 3000.0)  # MPa
WEBS: Sequence[float] = (0.1, 0.2, 0.4, 0.7, 1.0)  # over the lining's width
TABLES: Sequence[float] = (1.5, 2.0, 3.0, 5.0, 8.0)  # mm
FRICTIONS: Sequence[float] = (0.1, 0.2, 0.3, 0.4, 0.5)
POISSON: Sequence[float] = (0.0, 0.1, 0.25, 0.35, 0.45)
DISTANCES: Sequence[float] = (0.0, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 20.0, 40.0, 70.0, 100.0, 150.0, 200.0)  # 1/(k K)


@dataclass(frozen=True)
class Setting:
    """How fine and how many: elements along a lining in maps and in the brake itself, meshes that double, every how
    many points of the maps; of the ladder its solid truth, meshes in the plane and of solids."""

    elements: int
    fine: int
    doubled: tuple[int, int, int]
    every: int
    truth: int
    meshes: tuple[int, ...]
    solids: tuple[int, ...]


FULL = Setting(24, 40, (14, 28, 56), 1, 64, (8, 16, 32, 64, 128), (8, 12, 16, 24, 32, 48))
SHORT = Setting(10, 12, (6, 12, 24), 4, 20, (8, 16), (6, 12))


@dataclass(frozen=True)
class Result:
    """Everything that the report shows."""

    three: Three
    scene: Any
    table: list[dict[str, Any]]
    certain: tuple[Certain, Certain]
    validation: Validation
    maps: tuple[Map, Map]
    curves: dict[str, list[tuple[float, list[dict[str, Any]]]]]
    worn: Worn
    ladder: list[Rung]
    seconds: float


def study(*, short: bool = False, say: Callable[[str], None] = lambda _: None) -> Result:
    """All computing; `short`: coarser, fewer points."""
    start = time.perf_counter()
    setting = SHORT if short else FULL
    brake = read_brake(HERE / "brake.toml")
    say("the brake itself")
    scene = solid.prepare(brake, elements=setting.fine)
    three = rows.solve(brake, setting.fine)
    say("meshes that double")
    true = rows.certain(lambda n: respond(solid.prepare(brake, elements=n), brake).torque, setting.doubled)
    plane = rows.certain(lambda n: respond(prepare(brake, elements=n), brake).torque, setting.doubled)
    t = brake.shoes[0].lining.thickness
    b = brake.shoes[0].lining.width
    n = setting.every
    maps = (
        rows.chart(
            "one width", lambda x, y: rows.plain(brake, x * t, y * 1e6), WIDTHS[::n], MODULI[::n], setting.elements, say
        ),
        rows.chart(
            "table and web",
            lambda x, y: vary(brake, {"shoe.body.width": x * b, "shoe.backing.thickness": y * 1e-3}),
            WEBS[::n], TABLES[::n], setting.elements, say,
        ),
    )  # fmt: skip
    curves = {}
    for name, key, values in (
        ("friction", "friction", FRICTIONS),
        ("Poisson's ratio of the lining", "shoe.lining.material.nu", POISSON),
    ):
        say(name)
        found = [(value, rows.rows(rows.solve(vary(brake, {key: value}), setting.elements))) for value in values[::n]]
        curves[name] = found
    say("wear")
    worn = rows.wear(brake, setting.elements, DISTANCES if not short else DISTANCES[::3])
    say("the ladder")
    ladder = rows.ladder(brake, setting.truth, setting.meshes, setting.solids)
    return Result(
        three=three,
        scene=scene,
        table=rows.rows(three, "T-section"),
        certain=(plane, true),
        validation=rows.validation(plane, true),
        maps=maps,
        curves=curves,
        worn=worn,
        ladder=ladder,
        seconds=time.perf_counter() - start,
    )


def report(result: Result, folder: Path) -> Path:
    """Write page, figures, tables and fields; returns the page."""
    made = {
        "map": figures.maps(result.maps),
        "face": figures.faces(result.three, result.worn),
        "curves": figures.curves(result.curves),
        "worn": figures.wear(result.worn),
        "ladder": figures.ladder(result.ladder),
    }
    for name, figure in made.items():
        for ending in ("svg", "png") if name in {"map", "ladder"} else ("png",) if name == "face" else ("svg",):
            drawing.save(figure, folder / f"{name}.{ending}")
    brake, response = result.three.brake, result.three.solid
    write_vtu(folder / "solid.vtu", [recover(result.scene, brake, response, i) for i in range(len(brake.shoes))])
    not_drawn = render(folder / "solid.vtu", folder / "solid.png", brake.title)
    write_text(folder / "errors.csv", as_csv(result.table))
    write_text(folder / "ladder.csv", as_csv([rung._asdict() for rung in result.ladder]))
    points = [
        {"map": chart.name, "x": x, "y": y, **{key: float(values[j, i]) for key, values in chart.errors.items()}}
        for chart in result.maps
        for j, y in enumerate(chart.y)
        for i, x in enumerate(chart.x)
    ]
    write_text(folder / "maps.csv", as_csv(points))
    return fill(
        HERE / "page.html",
        folder / "index.html",
        result=result,
        not_drawn=not_drawn,
        within=partial(_within, result.maps),
        largest={key: max(float(np.abs(chart.errors[key]).max()) for chart in result.maps) for key in points[0].keys()
                 - {"map", "x", "y", "mid_over_side"}},
        limits=rows.KNOWN,
        sentence=rows.sentence(result.maps),
    )  # fmt: skip


def _within(maps: tuple[Map, Map], limit: float, key: str) -> float:
    """The share of all brakes of the maps within a limit."""
    return float(np.mean([np.mean(np.abs(chart.errors[key]) <= limit) for chart in maps]))
