"""Which model or mesh for the accuracy one needs, and what does it cost? Errors against run time on every brake."""

import math
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, partial
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

from studies.error_vs_runtime import left_out

from drumlin.brake.drum_brake import Brake
from drumlin.brake.file import read_brake
from drumlin.brake.plane_brake import FlatBrake, read_any
from drumlin.comparison import Column, as_csv
from drumlin.errors import DrumlinError
from drumlin.fem.mesh.arc import KINDS
from drumlin.fem.solve import solve
from drumlin.files import write_text
from drumlin.journal import Journal
from drumlin.models import applicable, refusals
from drumlin.report.figures import save
from drumlin.report.page import Figure, Section, Source, Table, Text, versions, write_page
from drumlin.report.work_figure import work_precision
from drumlin.verification.reference import REFINEMENTS, Pair, Refinement, as_dict, reference, responses, write_values
from drumlin.verification.work_precision import (
    PEERS,
    REPEATS,
    Method,
    enough,
    floor,
    measure,
    peer_row,
    process_seconds,
)

STUDIES = Path(__file__).parents[1]
UNIT = STUDIES / "double_shoe" / "brake.toml"
UNIT_ELEMENTS = 20
SHORT = ("double_shoe/brake", "laws/shigley_16_2")
PROCESSES = ("quad2", "quad1")  # kinds of graded meshes whose whole process is timed beside the peers
WITH_PEERS = ("double_shoe/brake", "double_shoe/flexible")
QUICK = (Refinement("quad2", 120, 2e-3, 1.4), Refinement("tri2", 100, 2e-3, 1.3))  # references of the short setting
TARGETS = {"torque_error": (0.1, 0.05, 0.01, 1e-3, 1e-4), "pressure_error": (0.1, 0.05, 0.01, 5e-3, 1e-3)}


class Result(NamedTuple):
    """Everything that the report shows; `floors` and `references` by brake, `refused`: brakes left out and why."""

    rows: list[dict[str, Any]]
    floors: dict[str, dict[str, float]]
    references: dict[str, dict[str, Any]]
    refused: dict[str, str]
    left_out: list[dict[str, Any]]
    unit: float
    seconds: float


def brakes() -> tuple[dict[str, Path], dict[str, str]]:
    """The brake files of studies/ that finite elements cover, by name, and why each other one is left out."""
    found, refused = {}, {}
    for path in sorted(STUDIES.glob("*/*.toml")):
        name = f"{path.parent.name}/{path.stem}"
        try:
            brake = read_any(path)
        except DrumlinError:
            continue  # data of a study, no brake
        if isinstance(brake, FlatBrake) or "fem" in refusals(brake):
            models = ", ".join(model.name for model in applicable(brake))
            refused[name] = f"{refusals(brake)['fem']}; only {models}, and nothing to judge by"
        else:
            found[name] = path
    return found, refused


def methods(name: str, brake: Brake, *, short: bool = False) -> list[Method]:
    """Every way to solve a brake that the study tries."""
    kinds = ("quad2", "tri1") if short else tuple(KINDS)
    elastic = any(shoe.body is not None for shoe in brake.shoes) and brake.drum.ring is None  # a ring costs much more
    sizes = (20, 40) if short else (20, 40, 80, 160) if elastic else (20, 40, 80)
    tolerances = (1e-2,) if short else (3e-2, 1e-2, 3e-3, 1e-3)
    penalties = (1e3, 1e6) if short else (1e1, 1e3, 1e6)
    found = [Method("law", law, {"model": law}) for law in ("sine", "cosine", "uniform")]
    if "foundation" not in refusals(brake):
        found += [
            Method("foundation", f"{sections} sections{', lifted' if lift else ''}", options | lift)
            for sections in (20, 60, 180)
            for options in ({"model": "foundation", "sections": sections},)
            for lift in ({}, {"lift": ["all"]})
        ]
    for family, even in (("even mesh", {"even": True}), ("graded mesh", {})):
        found += [
            Method(family, f"{kind}, {n} elements", {"kind": kind, "elements": n, **even})
            for kind in kinds
            for n in sizes
        ]
    found += [
        Method("adapted mesh", f"{kind}, tolerance {tolerance:g}", {"kind": kind, "tolerance": tolerance})
        for kind in kinds
        for tolerance in (tolerances if kind == "quad2" else tolerances[:2])
    ]
    some = sizes[-1:] if short else sizes[:3]
    for family in ("weak penalty", "pointwise penalty"):
        found += [
            Method(family, f"{penalty:g} E/t, {n} elements", {"elements": n, "penalty": penalty})
            for penalty in penalties
            for n in some
        ]
    if name in WITH_PEERS and not short:
        found += [
            Method("graded mesh", f"{kind}, {n} elements", {"kind": kind, "elements": n})
            for kind, n in (("quad2", 56), ("quad1", 112))  # half a percent of p
        ]
        found += [
            Method("GetFEM", f"{kind}, {n} elements", {"kind": kind, "elements": n})
            for kind, sizes in (("quad2", (20, 40, 56, 80)), ("quad1", (40, 80, 112)))
            for n in sizes
        ]
        found += [
            Method("GetFEM", f"even, quad2, {n} elements", {"kind": "quad2", "elements": n, "even": True})
            for n in (40, 80, 160)
        ]
        found += [Method("CalculiX", f"quad2, {n} elements", {"kind": "quad2", "elements": n}) for n in (40, 56)]
    return found


def study(
    *, short: bool = False, say: Callable[[str], None] = lambda _: None, journal: Journal | None = None
) -> Result:
    """Every method on every brake, each a case of the journal; `short`: two brakes, fewer sizes, coarser references."""
    start = time.perf_counter()
    journal = Journal() if journal is None else journal  # an empty one is false
    paths, refused = brakes()
    paths = {name: path for name, path in paths.items() if not short or name in SHORT}
    unit_brake = read_brake(UNIT)
    unit = partial(solve, unit_brake, elements=UNIT_ELEMENTS)
    unit()
    rows, floors, references = [], {}, {}
    for name, path in paths.items():
        brake, pair = read_brake(path), cache(partial(responses, read_brake(path), QUICK if short else REFINEMENTS))
        say(f"{name}: reference")
        known = journal.once({"brake": name, "reference": True}, partial(_reference, name, path, brake, pair))
        floors[name], references[name] = known["floor"], known["values"]
        for method in methods(name, brake, short=short):
            say(f"{name}: {method.family}, {method.name}")
            row = journal.once({"brake": name, **method.case}, partial(_row, brake, method, pair, unit))
            if name in WITH_PEERS and not short and method.family == "graded mesh" and row["kind"] in PROCESSES:
                kind, n = row["kind"], row["elements"]
                case = {"brake": name, "process": n, "kind": kind}
                row = row | journal.once(case, partial(_process, path, kind, n))
            rows.append({"brake": name, **row})
    left = left_out.rows_of(journal, short=short, say=say)
    return Result(rows, floors, references, refused, left, _median_unit(rows), time.perf_counter() - start)


def _reference(name: str, path: Path, brake: Brake, pair: Callable[[], Pair]) -> dict[str, Any]:
    command = f"drumlin reference studies/{name}.toml"
    return {
        "floor": floor(brake, pair()),
        "values": as_dict(reference(brake, path.read_text(), command, pair())),
    }


def _row(brake: Brake, method: Method, pair: Callable[[], Pair], unit: Callable[[], object]) -> dict[str, Any]:
    if method.family in PEERS:
        return peer_row(brake, method, pair().value, unit, 1 if method.family == "CalculiX" else REPEATS)
    return measure(brake, method, pair().value, unit)


def _process(path: Path, kind: str, elements: int) -> dict[str, Any]:
    return {"process": process_seconds(path, "--elements", str(elements), "--kind", kind)}


def _median_unit(rows: Iterable[Mapping[str, Any]]) -> float:
    """Seconds of the unit, from the rows' times and ratios."""
    return median(row["seconds"] / row["ratio"] for row in rows if "ratio" in row)


def brake_rows(result: Result, name: str) -> list[dict[str, Any]]:
    """The rows of one brake."""
    return [row for row in result.rows if row["brake"] == name]


def offered(rows: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """The rows among which one is recommended: not the peers, nor the penalties that are there to be compared, which
    cost what the exact contact on the same mesh costs, or more."""
    return [row for row in rows if row["family"] not in (*PEERS, "weak penalty", "pointwise penalty")]


NAMES = {"torque_error": "torque", "pressure_error": "p (L2)"}
BEST = (
    Column("brake", "brake"),
    Column("quantity", "error of"),
    Column("target", "at most", "%", 100, "g"),
    Column("family", "fastest that keeps it"),
    Column("method", "which"),
    Column("error", "its error", "%", 100, ".2g"),
    Column("seconds", "cold solve", "ms", 1e3, ".3g"),
    Column("ratio", "over the unit", "", 1, ".2f"),
    Column("further", "further load case", "ms", 1e3, ".3g"),
)


def best_rows(result: Result) -> list[dict[str, Any]]:
    """For each brake and target the fastest method whose error is at most the target."""
    found = []
    for name in result.floors:
        rows = offered(brake_rows(result, name))
        for key, targets in TARGETS.items():
            for target in targets:
                fit = enough(rows, key, target, result.floors[name])
                row = {"brake": name, "quantity": NAMES[key], "target": target}
                if fit:
                    row |= {k: fit[0].get(k) for k in ("family", "method", "seconds", "ratio", "further")}
                    row["error"] = fit[0][key]
                    if fit[0]["family"] == "law":
                        row["method"] = " or ".join(r["model"] for r in fit if r["family"] == "law")
                else:
                    below = target < result.floors[name][key]
                    row["family"] = "not claimed: below what the reference knows" if below else "none of those tried"
                found.append(row)
    return found


def said_of(row: Mapping[str, Any]) -> str:
    """What a row recommends, in words."""
    family, method = row["family"], row.get("method")
    if method is None:
        return str(family)
    if family == "law":
        return f"the {method} law"
    return f"{family} ({method})"


def advice(best: Sequence[Mapping[str, Any]]) -> list[str]:
    """The table of recommendations in words: for each target, what is enough where."""
    said = []
    for key, targets in TARGETS.items():
        for target in targets:
            where: dict[str, list[str]] = {}
            for row in best:
                if (row["quantity"], row["target"]) == (NAMES[key], target):
                    where.setdefault(said_of(row), []).append(row["brake"])
            parts = [
                f"{what}: {'all brakes' if len(where) == 1 else ', '.join(names)}"
                for what, names in sorted(where.items(), key=lambda item: -len(item[1]))
            ]
            said.append(
                f"<b>{100 * target:g} % of {NAMES[key]}</b> is kept by {'; by '.join(parts)}.".replace(
                    "by none", "none"
                ).replace("by not", "not")
            )
    return said


ROWS = (
    Column("family", "family"),
    Column("method", "method"),
    Column("torque_error", "error of torque", "%", 100, ".2g"),
    Column("peak_error", "of peak p", "%", 100, ".2g"),
    Column("pressure_error", "of p (L2)", "%", 100, ".2g"),
    Column("reaction_error", "of hinge reaction", "%", 100, ".2g"),
    Column("seconds", "cold solve", "ms", 1e3, ".3g"),
    Column("lower", "lower quartile", "ms", 1e3, ".3g"),
    Column("upper", "upper quartile", "ms", 1e3, ".3g"),
    Column("ratio", "over the unit", "", 1, ".2f"),
    Column("further", "further load case", "ms", 1e3, ".3g"),
    Column("memory", "peak memory", "MB", 1e-6, ".3g"),
    Column("unknowns", "unknowns", form="d"),
    Column("status", "status"),
)
FAILED = (
    Column("brake", "brake"),
    Column("family", "family"),
    Column("method", "method"),
    Column("status", "how it failed"),
)
VALUES = (
    Column("brake", "brake"),
    Column("shoe", "shoe"),
    Column("torque", "torque", "N m", 1, ".9g"),
    Column("torque_uncertainty", "uncertainty, relative", "", 1, ".1e"),
    Column("reaction", "hinge reaction x, y", "N"),
    Column("contact", "contact arcs", "deg"),
    Column("pressure", "p away from edges: uncertainty over peak", "", 1, ".1e"),
    Column("digits", "short of"),
)


def value_rows(result: Result) -> list[dict[str, Any]]:
    """The reference values as rows, and which of six digits of torque and four of p away from edges they lack."""
    found = []
    for name, values in result.references.items():
        for shoe in values["shoes"]:
            peak, (start, end), edge = shoe["peak_pressure"]["value"], shoe["lining"], shoe["edge"]
            away = [
                u
                for angle, u in zip(shoe["theta"], shoe["pressure_uncertainty"], strict=True)
                if start + edge < angle < end - edge
            ]
            torque = shoe["torque"]["uncertainty"] / shoe["torque"]["value"]
            pressure = max(away) / peak
            short = [f"six digits of torque ({torque:.0e})"] * (torque > 1e-6)
            short += [f"four digits of p ({pressure:.0e})"] * (pressure > 1e-4)
            found.append(
                {
                    "brake": name,
                    "shoe": shoe["name"],
                    "torque": shoe["torque"]["value"],
                    "torque_uncertainty": torque,
                    "reaction": ", ".join(f"{x:.7g}" for x in shoe["hinge_reaction"]["value"]),
                    "contact": ", ".join(
                        f"{math.degrees(a):.3f} to {math.degrees(b):.3f}" for a, b in shoe["contact_arcs"]["value"]
                    ),
                    "pressure": pressure,
                    "digits": "; ".join(short) or "nothing",
                }
            )
    return found


def report(result: Result, folder: Path) -> Path:
    """Write page, figures, CSV; returns the page."""
    figures = []
    for name in result.floors:
        rows, stem = brake_rows(result, name), f"work_precision_{name.replace('/', '_')}"
        picture = work_precision(result.references[name]["title"], rows, result.floors[name])
        for ending in ("png", "svg"):
            path = save(picture, folder / f"{stem}.{ending}")
        figures.append(
            Figure(
                path,
                f"{name}: error over run time of a cold solve. Each marker is a solve, each line a kind of mesh on sizes or tolerances that grow finer; bars are the quartiles of the repeats.",
            )
        )
        write_values(result.references[name], folder / "values" / f"{name.replace('/', '_')}.json")
    best = best_rows(result)
    write_text(folder / "results.csv", as_csv(result.rows))
    write_text(folder / "recommended.csv", as_csv(best))
    failed = [row for row in result.rows if row["status"] != "converged"]
    first = next(iter(result.floors))
    sections = [
        Section(
            "What to use",
            [
                *(Text(line) for line in advice(best)),
                Table(
                    best,
                    BEST,
                    "The fastest method whose error is at most the target. A mesh counts only where all finer ones of its kind keep the target too; a law may keep it by chance.",
                ),
            ],
        ),
        Section("Error against run time", figures),
        Section(
            f"All numbers of {first}",
            [
                Table(
                    brake_rows(result, first),
                    ROWS,
                    "Every method. p in L2 without 0.2 deg at the lining's ends, peak p without half the lining's thickness there; the worst shoe's. Further load case: another friction coefficient on the bodies that are there. Memory: beyond the loaded program, in a process of its own.",
                ),
                Text("The same for every brake: <code>results.csv</code> beside this page, in SI units."),
            ],
        ),
        Section(
            "What failed, and how",
            [Table(failed, FAILED, "Methods without an answer. A refused one does not cover the brake.")],
        ),
        *peers_sections(result),
        left_out.section(result.left_out, folder),
        Section(
            "Reference values",
            [
                Text(
                    "Quadratic quadrilaterals and quadratic triangles on divisions of their own, graded to every corner and to the ends of the contact, exact contact. "
                    "The uncertainty is their distance; it is shaded in the figures, and nothing is claimed below it. An elastic ring is meshed by quadrilaterals of two sizes in both. "
                    "<code>reports/reference/values/</code> has each brake's values as JSON, <code>drumlin reference BRAKE.toml</code> makes them again, "
                    "<code>drumlin check BRAKE.toml RESULT.csv</code> compares anybody's p(θ) with them."
                ),
                Table(
                    value_rows(result),
                    VALUES,
                    "Wanted: six digits of the torque, four of p away from the edges by half a lining thickness.",
                ),
            ],
        ),
        Section("Deliberately not covered", [Text(line) for line in not_covered(result)]),
        Section(
            "How it was measured",
            [Text(measured(result)), Source("versions", "\n".join(f"{k}: {v}" for k, v in versions().items()))],
        ),
    ]
    page = folder / "index.html"
    write_page(page, "Error against run time", lead(result), sections)
    return page


def lead(result: Result) -> str:
    """What was found, in one sentence."""
    laws = [row["torque_error"] for row in result.rows if row.get("model") == "sine" and row["status"] == "converged"]
    fit = [
        enough(offered(brake_rows(result, name)), "pressure_error", 0.01, floors)
        for name, floors in result.floors.items()
    ]
    times = [rows[0]["seconds"] * 1e3 for rows in fit if rows]
    return (
        f"On {len(result.floors)} brakes the sine law misses the torque by {min(laws):.1%} to {max(laws):.0%} in about a "
        f"millisecond; finite elements know the pressure to 1 % in {min(times):.0f} to {max(times):.0f} ms."
    )


HALF = 5e-3  # of p, at which peers are compared
AIMS = {"GetFEM": (20, 200), "CalculiX": (200, None)}  # times as long as drumlin, cold and for a further load case


def peer_lines(name: str, rows: Sequence[Mapping[str, Any]], floors: Mapping[str, float]) -> list[str]:
    """What the peers need for half a percent of p on one brake, as times of what drumlin needs."""
    own = enough([r for r in rows if r["family"] == "graded mesh" and "process" in r], "pressure_error", HALF, floors)
    lines = []
    for peer, aims in AIMS.items():
        theirs = enough([r for r in rows if r["family"] == peer], "pressure_error", HALF, floors)
        if not (own and theirs):
            lines.append(f"{name}: no solve by {peer} within 0.5 % of p among those tried.")
            continue
        best, mine = theirs[0], own[0]
        parts = [
            f"{said} {_missed(best[key] / mine[key], aim)}"
            for said, key, aim in zip(
                ("cold", "for a further load case"), ("ratio", "further_ratio"), aims, strict=True
            )
        ]
        lines.append(
            f"{name}, 0.5 % of p: {peer} ({best['method']}) takes, as times of drumlin ({mine['method']}), {', '.join(parts)}; "
            f"as a whole process {best['process'] / mine['process']:.2g} ({best['process']:.2f} s against {mine['process']:.2f} s)."
        )
        for other in theirs:
            same = [r for r in own if (r["kind"], r["elements"]) == (other["kind"], other["elements"])]
            if same and not other.get("even") and (other, same[0]) != (best, mine):
                lines.append(
                    f"{name}, both on {other['method']}: {peer} takes {other['ratio'] / same[0]['ratio']:.2g} times as long cold, "
                    f"{other['further_ratio'] / same[0]['further_ratio']:.2g} times for a further load case."
                )
    even = [r for r in rows if r["family"] in PEERS and r.get("even") and r["status"] == "converged"]
    if even and own:
        last = max(even, key=lambda r: r["elements"])
        lines.append(
            f"{name}, on a mesh that is graded nowhere: {last['family']} with {last['elements']} elements along the lining is off by {last['pressure_error']:.1%} of p, "
            f"in {last['ratio'] / own[0]['ratio']:.2g} times the time in which drumlin is off by {own[0]['pressure_error']:.1%}."
        )
    return lines


def _missed(times: float, aim: float | None) -> str:
    return f"{times:.2g}" if aim is None else f"{times:.2g} (aim {aim:g}{'' if times >= aim else ', missed'})"


def peers_sections(result: Result) -> list[Section]:
    """Other solvers on the same brakes; empty where none was tried."""
    rows = [row for row in result.rows if row["family"] in PEERS]
    if not rows:
        return []
    names = dict.fromkeys(row["brake"] for row in rows)
    return [
        Section(
            "Peers",
            [
                Text(
                    "The same brakes by CalculiX and by GetFEM, on drumlin's own graded mesh, which is in their favour, and by GetFEM on an even one. "
                    "Their times are their own, without the start of the process where that can be told apart."
                ),
                *(
                    Text(line)
                    for name in names
                    for line in peer_lines(name, brake_rows(result, name), result.floors[name])
                ),
                Table(
                    rows,
                    (Column("brake", "brake"), *ROWS, Column("process", "whole process", "s", 1, ".3g")),
                    "Peers; the reference is drumlin's.",
                ),
            ],
        )
    ]


def not_covered(result: Result) -> list[str]:
    """What the study leaves out on purpose."""
    return [
        *(f"<code>{name}</code>: {why}." for name, why in result.refused.items()),
        "The brakes of <code>meshes/</code>: a mesh from a file has no finer one, hence no reference. Three dimensions, heat, wear, "
        "stick under changing load: the reference knows nothing of them, and what the full-slip model itself is worth beside a test rig is another question.",
        "Threads: every solve runs on one core. Compiling and importing: the process is warm; what a whole process costs is said beside the peers.",
        "The time of making the brake file, and of knowing beforehand which mesh is enough: only the adapted meshes know their error without a reference.",
    ]


def measured(result: Result) -> str:
    """How times were taken."""
    spread = [(row["upper"] - row["lower"]) / row["seconds"] for row in result.rows if row.get("repeats", 0) >= REPEATS]
    return (
        f"Times are the process's own, medians of at least {REPEATS} repeats; half of all repeats lie within {median(spread):.0%} of the median's size (median over the rows). "
        f"Before every repeat a unit is timed, the double-shoe brake on {UNIT_ELEMENTS} elements ({result.unit * 1e3:.1f} ms here); ratios to it are what can be compared between runs and machines. "
        f"This run took {result.seconds:.0f} s beyond the cases that an earlier, stopped one had finished."
    )
