"""Every knob turned to its end: right, or refused with the reason? The classical pointwise penalty beside it."""

import math
import statistics
import time
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple

from studies.stability import bad_input, locking

from drumlin.comparison import Column, as_csv
from drumlin.files import write_text
from drumlin.journal import Journal
from drumlin.report import figures, stability_figures
from drumlin.report.page import Figure, Section, Table, Text, write_page
from drumlin.verification.extreme_cases import cases
from drumlin.verification.trial import ANSWERS, DIGITS, FAULTS, OUTCOMES, REFUSALS, RESIDUAL, trial

WORKERS = 2
INPUTS = 5000  # bad ones
CROSSED = ("corners", "shoe × friction", "thickness × penalty", "hypercube")


class Result(NamedTuple):
    """A row for each case; self-locking; what became of each bad input; `seconds` of this run."""

    rows: list[dict[str, Any]]
    locked: locking.Result
    verdicts: list[bad_input.Verdict]
    seconds: float


def study(
    *, short: bool = False, say: Callable[[str], None] = lambda _: None, journal: Journal | None = None
) -> Result:
    """Try every case of the designed set, two at a time; `short`: some 70 of them, here and one by one."""
    start = time.perf_counter()
    journal = journal or Journal()
    keys = {case: {"case": repr(case)} for case in cases(short=short)}
    left = [case for case, key in keys.items() if key not in journal]
    if short:
        for case in left:
            journal.add(keys[case], trial(case))
    else:
        with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
            for done, (case, row) in enumerate(zip(left, pool.map(trial, left), strict=True), 1):
                journal.add(keys[case], row)
                if done % 10 == 0:
                    say(f"{done} of {len(left)} cases")
    locked = locking.rows(short, journal, say)
    say("bad input")
    verdicts = bad_input.judge_all(40 if short else INPUTS, journal, say, processes=0 if short else WORKERS)
    return Result([journal[key] for key in keys.values()], locked, verdicts, time.perf_counter() - start)


def faults(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The cases that are neither right nor refused with a physical reason."""
    return [row for row in rows if row["outcome"] in FAULTS]


def softening(rows: list[dict[str, Any]]) -> dict[str, list[tuple[float, float]]]:
    """For each sweep of the penalty: its values and the relative change of the torque by each."""
    found: dict[str, list[tuple[float, float]]] = {}
    swept = [row for row in rows if row["knob"] == "penalty" and row["outcome"] == "answer"]
    for clearance, name in ((0.0, "whole lining in contact, stiff shoe"), (1e-4, "partial contact, soft shoe")):
        torque = {r["knobs"]["penalty"]: r["torque"] for r in swept if r["knobs"]["clearance"] == clearance}
        if math.inf in torque:
            exact = torque[math.inf]
            found[name] = [(a, abs(t / exact - 1)) for a, t in sorted(torque.items()) if a < math.inf]
    return found


def slope(values: list[tuple[float, float]], low: float = 1e2, high: float = 1e6) -> float:
    """Slope of log error over log penalty between two penalties, from the ends."""
    inside = [(math.log(a), math.log(e)) for a, e in values if low <= a <= high and e > 0]
    return (inside[-1][1] - inside[0][1]) / (inside[-1][0] - inside[0][0])


def worst(rows: list[dict[str, Any]], count: int = 10) -> list[dict[str, Any]]:
    """The answers with the fewest digits."""
    return sorted((row for row in rows if row.get("digits") is not None), key=lambda row: row["digits"])[:count]


def counted(rows: list[dict[str, Any]], key: str, names: tuple[str, ...]) -> list[dict[str, Any]]:
    """How often each value of a key occurs, a row for each knob and one for all."""
    table = []
    for knob in [*dict.fromkeys(row["knob"] for row in rows), "all"]:
        count = Counter(row.get(key) for row in rows if knob in (row["knob"], "all"))
        table.append({"knob": knob, "cases": sum(count.values()), **{name: count[name] or None for name in names}})
    return table


def timings(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Medians of the times of a knob's cases."""
    table = []
    for knob in [*dict.fromkeys(row["knob"] for row in rows), "all"]:
        there = [row for row in rows if knob in (row["knob"], "all")]
        line: dict[str, Any] = {"knob": knob, "cases": len(there)}
        for key in ("seconds", "seconds_whole", "pointwise_seconds", "steps", "pointwise_steps"):
            values = [row[key] for row in there if row.get(key) is not None]
            line[key] = statistics.median(values) if values else None
            line[f"most_{key}"] = max(values) if values else None
        table.append(line)
    return table


CASE = (Column("knob", "sweep"), Column("case", "what differs from the base"))
WORTH = (
    Column("torque", "torque", "N m", 1, ".6g"),
    Column("digits", "digits", form=".1f"),
    Column("allowed", "16 − log₁₀ condition", form=".1f"),
    Column("torque_condition", "condition of the torque", form=".1e"),
    Column("condition", "of the contact equations", form=".1e"),
    Column("balance", "balance", form=".1e"),
    Column("complementarity", "complementarity", form=".1e"),
    Column("pressure_error", "p against refined", form=".1e"),
    Column("steps", "steps", form="d"),
    Column("pointwise", "pointwise penalty"),
)
REFUSED = (*CASE, Column("outcome", "why"), Column("reason", "the line"), Column("pointwise", "pointwise penalty"))
POINTWISE = (
    "agrees",
    "differs",
    "cycles",
    "does not end",
    "singular",
    "a number where there is none",
    "not for rings",
    "not tried: too large",
)
TIMES = (
    Column("knob", "sweep"),
    Column("cases", "cases", form="d"),
    Column("seconds", "drumlin, median", "ms", 1e3, ".0f"),
    Column("most_seconds", "longest", "ms", 1e3, ".0f"),
    Column("steps", "steps, median", form=".0f"),
    Column("most_steps", "most", form="d"),
    Column("pointwise_seconds", "pointwise, median", "ms", 1e3, ".0f"),
    Column("most_pointwise_seconds", "longest", "ms", 1e3, ".0f"),
    Column("pointwise_steps", "steps where it ends, median", form=".0f"),
    Column("seconds_whole", "refined whole system, median", "ms", 1e3, ".0f"),
)
PENALTIES = (
    Column("penalty", "penalty, times E/t", form=".0e"),
    Column("torque", "torque", "N m", 1, ".9g"),
    Column("change", "change by the penalty", form=".1e"),
    Column("steps", "steps", form="d"),
    Column("digits", "digits", form=".1f"),
    Column("pointwise", "pointwise penalty"),
    Column("pointwise_off", "torque of the pointwise penalty off by", form=".1e"),
)


def report(result: Result, folder: Path) -> Path:
    """Write page, figures and CSV; returns the page."""
    rows = result.rows
    write_text(folder / "cases.csv", as_csv([{k: v for k, v in row.items() if k != "knobs"} for row in rows]))
    page = folder / "index.html"
    wrong = faults(rows)
    write_page(
        page,
        "Every knob turned to its end",
        f"{len(rows)} brakes with extreme knobs: {sum(r['outcome'] in ANSWERS for r in rows)} answers, "
        f"{sum(r['outcome'] in (*REFUSALS.values(), 'bad input') for r in rows)} refusals with a physical reason, "
        f"{len(wrong)} faults.",
        [
            outcomes(rows, folder),
            digits(rows, folder),
            refusals(rows),
            baseline(rows),
            penalties(rows, folder),
            *locking.sections(result.locked, folder),
            bad_input.section(result.verdicts),
            times(result),
        ],
    )
    return page


def outcomes(rows: list[dict[str, Any]], folder: Path) -> Section:
    """What became of the cases."""
    blocks: list[Any] = [
        Text(
            "The base is one internal shoe of a car's rear brake (drum 300 mm, lining 125 deg and 8 mm, steel shoe 24 mm, "
            "friction 0.3 that assists) at 40 quadratic elements along the lining. Each sweep turns one knob to its ends; "
            "corners, grids and a Latin hypercube turn many at once. Every case ends as an answer, as a shoe that is not "
            "pressed against the drum (torque 0), or as a refusal in one line. Faults would be: not converged, a "
            f"traceback, or inaccurate: a residual above {RESIDUAL:g} or fewer than {DIGITS} digits of the torque where its "
            "condition leaves as many."
        )
    ]
    knobs = [knob for knob in dict.fromkeys(row["knob"] for row in rows) if " × " not in knob and knob != "hypercube"]
    path = figures.save(stability_figures.strips(rows, knobs), folder / "sweeps.svg")
    blocks.append(
        Figure(
            path,
            "A cell for each case of each sweep, from its first value to its last; the number in it is that of the digits of its torque.",
        )
    )
    for knob, x, y, labels in (
        ("shoe × friction", "shoe", "friction", ("modulus of the shoe over that of the lining [-]", "friction μ [-]")),
        (
            "thickness × penalty",
            "penalty",
            "thickness",
            ("penalty, multiple of E/t [-]", "lining thickness over R [-]"),
        ),
    ):
        chosen = [row for row in rows if row["knob"] == knob]
        name = knob.replace(" × ", "_") + ".svg"
        path = figures.save(stability_figures.grids(chosen, x, y, labels), folder / name)
        blocks.append(Figure(path, f"{knob.capitalize()}: outcome, and digits of the torque that survive."))
    columns = (Column("knob", "sweep"), Column("cases", "cases", form="d"))
    blocks.append(
        Table(
            counted(rows, "outcome", OUTCOMES),
            (*columns, *(Column(name, name, form="d") for name in OUTCOMES)),
            "Outcomes of each sweep.",
        )
    )
    return Section("Outcomes", blocks)


def digits(rows: list[dict[str, Any]], folder: Path) -> Section:
    """What the answers are worth."""
    known = [row for row in rows if row.get("digits") is not None]
    path = figures.save(stability_figures.condition(known), folder / "condition.svg")
    fewest = min(row["digits"] for row in known)
    below = [row for row in known if row["digits"] < min(DIGITS, row["allowed"])]
    return Section(
        "Digits",
        [
            Text(
                "How many digits of a torque survive is not guessed from residuals: the whole brake, nothing condensed, "
                "is solved again as one sparse system by another elimination (SuperLU), its stiffness assembled in long "
                "double and the solution refined with long double residuals until the pressures move no more. Digits are those "
                "in which both torques agree, and never more than the refinement is sure of. Its condition is the torque's "
                "own: by how much it changes, at most, where every entry of the whole system changes by a fraction. An answer "
                "whose forces balance worse than 1e-9 is such a refined solution itself, eliminated in yet another order "
                f"for this comparison. {len(known)} answers: median {statistics.median(r['digits'] for r in known):.1f} digits, "
                f"fewest {fewest:.1f}; {len(below)} below what is required; "
                f"{sum(row['refined'] for row in known)} of them refined."
            ),
            Figure(path, "Digits against the condition of the torque, all answers."),
            Table(worst(rows), (*CASE, *WORTH), "The ten answers with the fewest digits."),
        ],
    )


def refusals(rows: list[dict[str, Any]]) -> Section:
    """The refusals with their lines."""
    refused = [row for row in rows if row["outcome"] not in ANSWERS]
    return Section(
        "Refusals",
        [Table(refused, REFUSED, f"All {len(refused)} refusals and faults with the line that the command prints.")],
    )


def baseline(rows: list[dict[str, Any]]) -> Section:
    """The pointwise penalty beside it."""
    columns = (Column("knob", "sweep"), Column("cases", "cases", form="d"))
    return Section(
        "The classical pointwise penalty beside it",
        [
            Text(
                "The same cases on the same meshes with the penalty at the quadrature points and one sparse factorisation a "
                "Newton step, at the case's own penalty (10<sup>16</sup> for an infinite one). It agrees where its torque is "
                "within 1 % of that of the weak coupling; where it differs that is a matter of the mesh (few or linear "
                "elements) or of lost digits. It cycles where its set of touching points repeats itself, does not end where "
                "60 steps did not settle it, and gives a number where there is none past the limit of self-locking or where "
                "no digit is left."
            ),
            Table(
                counted(rows, "pointwise", POINTWISE),
                (*columns, *(Column(name, name, form="d") for name in POINTWISE)),
                "What becomes of the pointwise penalty.",
            ),
        ],
    )


def penalties(rows: list[dict[str, Any]], folder: Path) -> Section:
    """A stiff penalty costs nothing."""
    series = softening(rows)
    if not series or any(len(values) < 4 for values in series.values()):
        return Section("A stiff penalty costs nothing", [Text("Not in the short setting.")])
    path = figures.save(stability_figures.softening(series), folder / "penalty.svg")
    swept = [row for row in rows if row["knob"] == "penalty" and row["knobs"]["clearance"] == 0]
    exact = next(row["torque"] for row in swept if math.isinf(row["knobs"]["penalty"]))
    table = [{**row, "penalty": row["knobs"]["penalty"], "change": row["torque"] / exact - 1} for row in swept]
    stiff = max(change for values in series.values() for a, change in values if a >= 1e6)
    slopes = " and ".join(f"{slope(values):.3f}" for values in series.values())
    return Section(
        "A stiff penalty costs nothing",
        [
            Text(
                "In the weak coupling the penalty is a compliance M/ε beside that of the lining: a stiff one vanishes. From "
                f"10<sup>6</sup> to infinity the torque stays within {stiff:.1e}, the steps are the same. What a finite one "
                f"changes is linear in 1/penalty: slopes {slopes} between 10<sup>2</sup> and 10<sup>6</sup>."
            ),
            Figure(
                path,
                "Change of the torque by a finite penalty. Dashed: slope −1; dotted: 1e-5, and the default penalty.",
            ),
            Table(table, PENALTIES, "The sweep of the penalty, whole lining in contact."),
        ],
    )


def times(result: Result) -> Section:
    """What it cost."""
    return Section(
        "What it cost",
        [
            Table(
                timings(result.rows),
                TIMES,
                "Wall-clock times of single cases, two running at a time; cold: meshed and condensed anew.",
            ),
            Text(f"This run took {result.seconds:.0f} s."),
        ],
    )
