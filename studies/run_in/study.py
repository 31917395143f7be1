"""When are the pressure laws right? Every brake of studies/ and meshes/ run in from new to the law."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studies.run_in import figures
from studies.run_in.film import film

from drumlin.base.errors import BadInput
from drumlin.base.files import write_text
from drumlin.brake.brake import Brake
from drumlin.brake.file import read_brake
from drumlin.brake.plane_brake import read_any
from drumlin.comparison import as_csv
from drumlin.fem.preparation.prepare import prepare
from drumlin.lining_wear.linings import fem_setup
from drumlin.lining_wear.run_in import distance
from drumlin.report import figures as drawing
from drumlin.report.page import fill
from drumlin_studies import run_in_limits as limits
from drumlin_studies.run_in_limits import Board, Reversals, Run, RunFrame

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
MAIN = ROOT / "studies" / "double_shoe" / "brake.toml"
FLEXIBLE = ROOT / "studies" / "double_shoe" / "flexible.toml"
SHORT = {"laws/block", "laws/pivoted_block", "double_shoe/brake"}  # the brakes of the short setting
RATIOS = (1e-4, 1e-3, 1e-2, 1e-1)  # E of the lining over that of the shoe
EXPONENTS = (0.5, 1.0, 1.5, 2.0, 3.0)  # of the pressure
CURVES = {
    "stiff": (0.0, 0.3, 3.0, 10.0, 30.0),
    "flexible": (0.0, 3.0, 30.0, 100.0, 300.0),
}  # in 1/(k K), as below
OPEN_CURVES = (0.003, 0.03, 0.2)  # of the whole run
REVERSALS = (10.0, 50.0, 250.0)
END, STEPS = 3.0, (0.05, 0.5)  # how far equal steps go, and their sizes
FAR = 0.01  # torque off the law, when new, of a brake that starts far off


@dataclass(frozen=True)
class Result:
    """Everything that the report shows; rows of tables as verification.run_in_limits has them."""

    main: Run
    flexible: Run
    runs: list[Run]
    brakes: list[dict[str, Any]]
    ratios: list[dict[str, Any]]
    halves: list[dict[str, Any]]
    exponents: list[dict[str, Any]]
    held: Run
    reversals: list[Reversals]
    steps: list[dict[str, Any]]
    boards: list[Board]
    frames: list[RunFrame]
    skipped: list[str]
    seconds: float


def study(*, short: bool = False, say: Callable[[str], None] = lambda _: None) -> Result:
    """Run in every brake, then the main one in many ways; `short`: few brakes, coarse."""
    start = time.perf_counter()
    elements = 30 if short else 80
    runs, brakes = list[Run](), list[dict[str, Any]]()
    found, skipped = cases(short=short)
    for name, model, brake in found:
        say(f"{name}, {model}")
        row, one = limits.brake_row(name, model, brake, elements)
        brakes.append(row)
        runs += [one] if one else []
    say("the main brake")
    brake = read_brake(MAIN)
    scene = prepare(brake, elements=elements)
    setup = fem_setup(scene, brake)
    main = limits.settle("stiff shoes", setup)
    soft = read_brake(FLEXIBLE)
    flexible = limits.settle("flexible shoes", fem_setup(prepare(soft, elements=elements), soft))
    say("linings from soft to stiff")
    ratios = [
        limits.ratio_row(brake, ratio, elements) for ratio in (RATIOS[1::2] if short else RATIOS)
    ]
    say("half the step, twice the way")
    halves = [limits.half_row(one) for one in (main, flexible)]
    say("exponents")
    exponents = [limits.exponent_row(setup, m) for m in ((2.0,) if short else EXPONENTS)]
    say("held torque")
    held = limits.settle("held torque", setup, torque=main.goal.torque)
    reversals = []
    for every in REVERSALS[:1] if short else REVERSALS:
        say(f"reversed every {every:g}")
        reversals.append(limits.reversed_run(scene, brake, every, 3 if short else 8))
    say("steps")
    steps, boards = limits.step_rows(main, END, STEPS)
    say("film")
    frames = limits.frames(scene, main, 6 if short else 40)
    return Result(
        main,
        flexible,
        runs,
        brakes,
        ratios,
        halves,
        exponents,
        held,
        reversals,
        steps,
        boards,
        frames,
        skipped,
        time.perf_counter() - start,
    )


def cases(*, short: bool) -> tuple[list[tuple[str, str, Brake]], list[str]]:
    """Name, model and brake of everything that can be run in; the files that cannot, with the
    reason.
    """
    found, skipped = list[tuple[str, str, Brake]](), list[str]()
    for path in sorted([*(ROOT / "studies").glob("*/*.toml"), *(ROOT / "meshes").glob("*.toml")]):
        name = f"{path.parent.name}/{path.stem}"
        if short and name not in SHORT:
            continue
        try:
            brake = read_any(path)
        except BadInput:
            continue  # another kind of file
        if brake.surface.straight:
            skipped.append(f"{name}: shoes on a plane are not modelled elastically")
            continue
        ways, reason = limits.ways(brake)
        found += [(name + how, model, varied) for how, model, varied in ways]
        skipped += [f"{name}: {reason}"] if reason else []
    return found, skipped


def report(result: Result, folder: Path) -> Path:
    """Write page, figures, film and tables; returns the page."""
    for name, rows in {
        "brakes": result.brakes,
        "ratios": result.ratios,
        "halves": result.halves,
        "exponents": result.exponents,
        "steppers": result.steps,
    }.items():
        write_text(folder / f"{name}.csv", as_csv(rows))
    reversal = result.reversals[min(1, len(result.reversals) - 1)]
    least = limits.least_touching([result.main, *result.runs])
    draw(result, least, reversal, folder)
    lives = [row for row in result.brakes if "life" in row]
    return fill(
        HERE / "page.html",
        folder / "index.html",
        result=result,
        stiff=limits.run_row(result.main),
        soft=limits.run_row(result.flexible),
        met=sum(row["status"] == limits.AT_LAW for row in result.brakes),
        within=(limits.PRESSURE_AT_LAW, limits.TORQUE_AT_LAW),
        least=least,
        far=[row for row in lives if abs(row["new_torque"]) > FAR],
        volume=max(row["volume"] for row in result.brakes if "volume" in row),
        reversal=reversal.row,
        reversals=[one.row for one in result.reversals],
    )


def draw(result: Result, least: Run, reversal: Reversals, folder: Path) -> None:
    """All figures and the film; `least`: the brake that lies on least when new."""
    main = result.main
    for key, one in (("stiff", main), ("flexible", result.flexible)):
        for ending in ("svg", "png"):
            drawing.save(figures.pressures(one, CURVES[key]), folder / f"pressure_{key}.{ending}")
    marks = [float(f"{least.distances()[-1] * part:.1g}") for part in OPEN_CURVES]
    far = [
        one for one in result.runs if abs(distance(one.setup, one.states[0], one.goal).torque) > FAR
    ]
    made = {
        "profiles": figures.profiles(least, marks),
        "pressure_open": figures.pressures(least, [0.0, *marks]),
        "torque": figures.torques(far or [main]),
        "held": figures.held(result.held),
        "reversal": figures.reversal(main, reversal),
        "checkerboard": figures.checkerboard(main.setup.surfaces[0], result.boards),
    }
    for name, figure in made.items():
        drawing.save(figure, folder / f"{name}.svg")
    film(main, result.frames, folder / "film.gif")
