"""Every rigid-shoe law on its worked examples and on every kind of brake: what it assumes, gives, and where it fails."""

import json
import math
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drumlin.brake.drum_brake import Brake
from drumlin.brake.file import vary
from drumlin.brake.plane_brake import AnyBrake, read_any
from drumlin.brake.units import to_si
from drumlin.comparison import Column, as_csv
from drumlin.errors import NoAnswer
from drumlin.files import write_text
from drumlin.laws import LAWS, locking_friction
from drumlin.laws.shapes import equivalent_friction
from drumlin.laws.simscape import DoubleShoe
from drumlin.models import MODELS
from drumlin.report import figures, law_figures
from drumlin.report.page import Figure, Section, Source, Table, Text, versions, write_page
from drumlin.response.merit import barecki_shoe_factor, rated
from drumlin.response.response import FlatMerit, Merit, Response

HERE = Path(__file__).parent
LAW_NAMES = tuple(name for name in MODELS if name != "fem")
FILES = (
    "laws/pad.toml",
    "laws/short_block.toml",
    "laws/block.toml",
    "laws/double_block.toml",
    "laws/pivoted_block.toml",
    "double_shoe/brake.toml",
    "laws/double_shoe_external.toml",
    "post_brake/brake.toml",
)


def _lock(brake: AnyBrake) -> float:
    assert isinstance(brake, Brake)
    return min(locking_friction(brake, shoe) for shoe in brake.shoes)


def _pivot(response: Response, axis: int) -> float:
    reaction = response.shoes[0].pivot_reaction
    return math.nan if reaction is None else abs(float(reaction[axis]))


QUANTITIES: dict[str, Callable[[AnyBrake, Response], float]] = {
    "force [N]": lambda b, r: b.shoes[0].actuation.force,
    "torque [N m]": lambda b, r: r.torque,
    "torque [N mm]": lambda b, r: r.torque * 1e3,
    "torque, helped shoe [N m]": lambda b, r: r.shoes[0].torque,
    "torque, opposed shoe [N m]": lambda b, r: r.shoes[1].torque,
    "peak pressure, helped shoe [kPa]": lambda b, r: r.shoes[0].peak_pressure * 1e-3,
    "peak pressure, opposed shoe [kPa]": lambda b, r: r.shoes[1].peak_pressure * 1e-3,
    "hinge reaction, helped shoe [N]": lambda b, r: float(np.linalg.norm(r.shoes[0].hinge_reaction)),
    "hinge reaction, opposed shoe [N]": lambda b, r: float(np.linalg.norm(r.shoes[1].hinge_reaction)),
    "normal force [N]": lambda b, r: r.shoes[0].normal_force,
    "pivot reaction, along [N]": lambda b, r: _pivot(r, 0),
    "pivot reaction, across [N]": lambda b, r: _pivot(r, 1),
    "force [kN]": lambda b, r: b.shoes[0].actuation.force * 1e-3,
    "mu_lock": lambda b, r: _lock(b),
}


class Result(NamedTuple):
    """Everything that the report shows."""

    examples: list[dict[str, Any]]
    applies: list[dict[str, Any]]
    words: list[dict[str, Any]]
    pressures: dict[str, Any]


def study(*, short: bool = False, say: Callable[[str], None] = lambda _: None) -> Result:
    """Worked examples, every brake file by every law, the sources' words; `short` changes nothing, all is fast."""
    say("worked examples")
    given = tomllib.loads((HERE / "examples.toml").read_text())["example"]
    examples = [row for example in given for row in example_rows(example)] + simscape_rows() + friction_rows()
    say("brake files")
    applies = [row for file in FILES for row in file_rows(file)]
    return Result(examples, applies, word_rows(), pressures())


def example_rows(example: dict[str, Any]) -> list[dict[str, Any]]:
    """One row a number given, for an entry of examples.toml."""
    law, source = example["law"], example["source"]
    solve = MODELS[law].solve
    brake = vary(read_any(HERE / example["file"]), example.get("changes", {}))
    if "peak" in example:
        brake = rated(brake, solve, to_si(example["peak"], "Pa", unit_required=True))
    response = solve(brake)
    return [
        compared(
            law,
            source,
            quantity,
            text,
            QUANTITIES[quantity](brake, response),
            example["origin"],
            example.get("remark", ""),
        )
        for quantity, text in example["given"].items()
    ]


def compared(
    law: str, source: str, quantity: str, given: str, value: float, origin: str = "formula", remark: str = ""
) -> dict[str, Any]:
    """A row: given and computed value side by side; they agree within half a unit of the last digit given."""
    decimals = len(given.partition(".")[2])
    agrees = abs(value - float(given)) <= 0.5 * 10.0**-decimals * (1 + 1e-6)
    return {
        "law": law,
        "source": source,
        "quantity": quantity,
        "origin": origin,
        "given": given,
        "computed": f"{value:.{decimals + 2}f}",
        "difference": value / float(given) - 1,
        "status": "agrees" if agrees else remark or "differs",
    }


def simscape_rows() -> list[dict[str, Any]]:
    """The double-shoe block with its default parameters, per newton of force, both readings of theta_s."""
    rows = []
    for reading, torque, mu_lock in (("end", "0.2176081", "0.823082"), ("span", "0.2211397", "0.794253")):
        block = DoubleShoe(reading="end" if reading == "end" else "span")
        source = f"Simscape defaults, theta_s as {reading}"
        leading, trailing = (float(T) for T in block.shoe_torques(1.0, 1.0))
        p_a, p_b = block.line_pressures(1.0, 1.0)
        if reading == "end":
            rows.append(compared("sine", source, "T/F, leading shoe [m]", "0.1484614", leading))
            rows.append(compared("sine", source, "T/F, trailing shoe [m]", "0.0691468", trailing))
            rows.append(compared("sine", source, "p_b/p_a", "0.465756", float(p_b / p_a)))
        rows.append(compared("sine", source, "T/F [m]", torque, leading + trailing))
        rows.append(compared("sine", source, "mu_lock", mu_lock, block.mu_lock))
    return rows


def friction_rows() -> list[dict[str, Any]]:
    """The equivalent friction of a block over its half-arc."""
    printed = {15: "1.011408", 30: "1.045356", 45: "1.100214", 60: "1.170138", 90: "1.273240"}
    return [
        compared("block", "mu'/mu", f"half-arc {angle} deg", text, float(equivalent_friction(math.radians(angle))))
        for angle, text in printed.items()
    ]


def file_rows(file: str) -> list[dict[str, Any]]:
    """One row a shoe for every law that applies to a brake file, and a row with the reason for every other law."""
    brake = read_any(HERE.parent / file)
    rows: list[dict[str, Any]] = []
    for name in LAW_NAMES:
        reason = MODELS[name].why_not(brake)
        base = {"file": file, "law": name}
        if reason is not None:
            rows.append({**base, "reason": reason, "status": "does not apply"})
            continue
        try:
            response = MODELS[name].solve(brake)
        except NoAnswer as error:
            rows.append({**base, "reason": str(error), "status": "no answer"})
            continue
        rows += [{**base, **shoe_row(response, i)} for i in range(len(response.shoes))]
    return rows


def shoe_row(response: Response, index: int) -> dict[str, Any]:
    """What a law says of one shoe."""
    shoe, merit = response.shoes[index], response.merits[index]
    row = {
        "shoe": shoe.name,
        "normal": shoe.normal_force,
        "peak": shoe.peak_pressure,
        "reaction": float(np.linalg.norm(shoe.hinge_reaction)),
        "helps": "yes" if shoe.self_energising else "no",
        "status": "applies",
    }
    if isinstance(merit, FlatMerit):
        return row | {"braking": merit.braking_force, "S": merit.sensitivity_at_fixed_shape}
    return row | {
        "torque": shoe.torque,
        "eta": merit.mechanical_advantage,
        "S": merit.sensitivity_at_fixed_shape,
        "factor": merit.shoe_factor,
        "psi": merit.friction_radius,
        "angle": merit.resultant_angle,
    }


def word_rows() -> list[dict[str, Any]]:
    """The shoe factor that eq. 26 of Barecki & Scieszka gives the two posts of a brake, by the word it uses for each."""
    brake = read_any(HERE.parent / "post_brake/brake.toml")
    assert isinstance(brake, Brake)
    rows = []
    for law in ("short", "cosine", "uniform", "sine"):
        response = MODELS[law].solve(brake)
        for shoe, data, merit in zip(response.shoes, brake.shoes, response.merits, strict=True):
            assert isinstance(merit, Merit) and merit.resultant_angle is not None and merit.friction_radius is not None
            R = brake.drum.radius
            arm = abs(data.actuation.moment_about(data.hinge) / data.actuation.force)
            angle = data.frame.phi(np.array(merit.resultant_angle))
            S = barecki_shoe_factor(
                brake.friction, angle, merit.friction_radius, data.hinge.radius / R, arm / R, merit.double_delta
            )
            rows.append(
                {
                    "law": law,
                    "shoe": shoe.name,
                    "word": "leading" if merit.double_delta > 0 else "trailing",
                    "helps": "yes" if shoe.self_energising else "no",
                    "S_26": float(S),
                    "S": merit.shoe_factor,
                    "n": merit.n,
                }
            )
    return rows


def pressures() -> dict[str, Any]:
    """p of every law: the drum laws and a pivot off its best place on one block, the long flat shoe on its pad."""
    block, pad = read_any(HERE / "block.toml"), read_any(HERE / "pad.toml")
    shoes = {name: MODELS[name].solve(block).shoes[0] for name in LAWS}
    pivoted = vary(block, {"shoe.pivot": {"radius": "140 mm", "angle": "84 deg"}})
    shoes["pivoted"] = MODELS["pivoted"].solve(pivoted).shoes[0]
    shoes["linear"] = MODELS["linear"].solve(pad).shoes[0]
    return shoes


GIVEN = (
    Column("source", "example"),
    Column("quantity", "quantity"),
    Column("origin", "origin"),
    Column("given", "given"),
    Column("computed", "computed"),
    Column("difference", "difference", "", 1, "+.1e"),
    Column("status", "within the digits given"),
)
APPLIES = (
    Column("file", "brake file"),
    Column("law", "law"),
    Column("shoe", "shoe"),
    Column("torque", "torque", "N m", 1, ".6g"),
    Column("braking", "braking force", "N", 1, ".6g"),
    Column("normal", "normal force", "N", 1, ".6g"),
    Column("peak", "peak pressure", "MPa", 1e-6, ".4g"),
    Column("reaction", "hinge reaction", "N", 1, ".6g"),
    Column("helps", "self-energising"),
    Column("eta", "η = T/M", "", 1, ".4f"),
    Column("S", "S = m η", "", 1, ".4f"),
    Column("factor", "T/(F R)", "", 1, ".4f"),
    Column("psi", "ψ", "", 1, ".4f"),
    Column("angle", "resultant at", "deg", 180 / math.pi, ".2f"),
)
REFUSED = (Column("file", "brake file"), Column("laws", "laws"), Column("reason", "why they have no answer"))
WORDS = (
    Column("law", "pressure"),
    Column("shoe", "post"),
    Column("word", "word of eq. 26"),
    Column("S_26", "S by eq. 26", "", 1, ".5f"),
    Column("S", "T/(P R) of the law", "", 1, ".5f"),
    Column("n", "n", "", 1, "+.4f"),
    Column("helps", "self-energising"),
)
WORD_MAP = (Column("source", "source"), Column("word", "word"), Column("means", "means"), Column("effect", "friction"))
ORIGIN = (
    "Worked examples. Given: printed by the source, or its formula with more digits than it prints. They agree where the "
    "computed number is within half a unit of the last digit given."
)


def report(result: Result, folder: Path) -> Path:
    """Write page, figures, CSV and JSON; returns the page."""
    rows = result.examples + result.applies + result.words
    write_text(folder / "results.csv", as_csv(rows))
    data = {"versions": versions(), "examples": result.examples, "files": result.applies, "words": result.words}
    write_text(folder / "results.json", json.dumps(data, indent=1) + "\n")
    for name, files in DRAWINGS.items():
        brakes = [(title, read_any(HERE.parent / file)) for title, file in files]
        figures.save(law_figures.drawing(brakes), folder / f"{name}.svg")
    angles = [math.radians(angle) for angle in (60, 90, 120)]
    figures.save(law_figures.short_shoe_merits(angles, a_over_r=1.2), folder / "merits.svg")
    figures.save(law_figures.friction_over_arc(), folder / "friction.svg")
    figures.save(law_figures.torque_over_speed(DoubleShoe(), (0, 250, 500, 1000), 1000.0), folder / "speed.svg")
    figures.save(law_figures.pressures(result.pressures), folder / "pressures.svg")
    page = folder / "index.html"
    write_page(page, "The pressure laws of shoe brakes", lead(result), sections(result, folder))
    return page


def lead(result: Result) -> str:
    """What was found, in one sentence."""
    agree = sum(row["status"] == "agrees" for row in result.examples)
    applied = sum(row["status"] == "applies" for row in result.applies)
    return (
        f"What each rigid-shoe law assumes, what follows from it, and where it fails. {agree} of {len(result.examples)} "
        f"numbers of worked examples are met to the digits given, the others say why not; {len(FILES)} brake files "
        f"are solved by every law that applies, {applied} shoes in all."
    )


DRAWINGS = {
    "short_shoes": [("short block on a lever", "laws/short_block.toml"), ("pad on a plane", "laws/pad.toml")],
    "double_shoes": [
        ("internal double shoe", "double_shoe/brake.toml"),
        ("external double shoe", "laws/double_shoe_external.toml"),
    ],
    "blocks": [("block on a lever", "laws/block.toml"), ("double block brake", "laws/double_block.toml")],
    "pivoted": [("pivoted block", "laws/pivoted_block.toml")],
    "post_brake": [("post brake", "post_brake/brake.toml")],
}


def examples_of(result: Result, law: str, source: str = "", but: str = "\0") -> Table:
    """The worked examples of a law, printed and computed side by side."""
    rows = [r for r in result.examples if r["law"] == law and source in r["source"] and but not in r["source"]]
    assert rows, f"no worked example of {law} from {source!r}"
    return Table(rows, GIVEN, ORIGIN)


def refused(result: Result) -> list[dict[str, Any]]:
    """The laws without an answer, together by file and reason."""
    laws: dict[tuple[str, str], list[str]] = {}
    for row in result.applies:
        if row["status"] != "applies":
            laws.setdefault((row["file"], row["reason"]), []).append(row["law"])
    return [{"file": file, "laws": ", ".join(names), "reason": why} for (file, why), names in laws.items()]


def law_text(law: dict[str, str]) -> Text:
    """The four things that a reader must know of a law."""
    parts = ("assumes", "formula", "source", "fails")
    return Text("<br>".join(f"<b>{part.capitalize()}</b> {law[part]}" for part in parts))


def sections(result: Result, folder: Path) -> list[Section]:
    """The page."""
    text = tomllib.loads((HERE / "text.toml").read_text())
    laws = {name: law_text(law) for name, law in text["law"].items()}
    return [
        Section("How to read the formulas", [Text(paragraph) for paragraph in text["conventions"]]),
        Section(
            "Short shoe",
            [
                Figure(folder / "short_shoes.svg", "A short block on a lever, and a pad on a plane."),
                laws["short"],
                examples_of(result, "short"),
                Figure(
                    folder / "merits.svg",
                    "Mechanical advantage and sensitivity of short shoes with a/r = 1.2, θm from the hinge. Solid: "
                    "δΔ = +1, dashed: −1. Where friction assists both run off to infinity at μ_lock (dotted): what "
                    "brakes more also depends more on μ.",
                ),
            ],
        ),
        Section(
            "Long shoe on a plane",
            [
                Text("The pad is drawn above, with the short shoes."),
                laws["linear"],
                Text(
                    "No source prints a worked example; the tests compare pressure and braking force with the formulas above."
                ),
            ],
        ),
        Section(
            "Long shoe turning about its hinge: the sine law",
            [
                Figure(folder / "double_shoes.svg", "Double-shoe brakes with the parameters of the Simscape block."),
                laws["sine"],
                examples_of(result, "sine", but="Simscape"),
            ],
        ),
        Section(
            "Double-shoe block of Simscape",
            [
                Text(text["simscape"]),
                examples_of(result, "sine", "Simscape"),
                Figure(
                    folder / "speed.svg",
                    "Torque of the block with its default parameters through zero speed; dashed with a viscous coefficient "
                    "10⁵ times the default, to make it visible.",
                ),
            ],
        ),
        Section(
            "Block on a lever: p = p₀ cos",
            [
                Figure(folder / "blocks.svg", "A block on a lever, and two of them face to face."),
                laws["cosine"],
                laws["block"],
                examples_of(result, "block"),
                Figure(
                    folder / "friction.svg",
                    "What the arc does to the friction force of a block: μ′/μ, which is also ψ, the apparent radius of "
                    "friction over R.",
                ),
                Text(text["back_stop"]),
            ],
        ),
        Section(
            "Shoe on a pivot at the end of a lever",
            [
                Figure(folder / "pivoted.svg", "A block on a pivot: the lever turns about its pin, the shoe about G."),
                laws["pivoted"],
                examples_of(result, "pivoted"),
            ],
        ),
        Section("Uniform pressure", [laws["uniform"]]),
        Section(
            "The pressures side by side",
            [
                Figure(
                    folder / "pressures.svg",
                    "p(θ) of every law. Left: on the block of 90° above, under the same force (its pivot, for the pivoted "
                    "law, 140 mm from the centre and 6° off the middle; the short shoe and the block formula act at "
                    "the middle with the p drawn here). Right: the shapes, with the long flat shoe.",
                )
            ],
        ),
        Section("Figures of merit, for any pressure", [Text(paragraph) for paragraph in text["merits"]]),
        Section(
            "Leading and trailing: whose word means what",
            [
                Table(text["word"], WORD_MAP, "The words of the sources, in terms of what can be computed."),
                Text(text["contradiction"]),
                Figure(folder / "post_brake.svg", "The post brake of the table below; its sizes are assumed."),
                Table(
                    result.words,
                    WORDS,
                    "Post brake, drum turning counter-clockwise: the post that eq. 26 calls leading has the smaller shoe "
                    "factor under all pressures but the sine law's, whose resultant lies so high that n is just positive.",
                ),
            ],
        ),
        Section(
            "Every brake file by every law",
            [
                Table(
                    [row for row in result.applies if row["status"] == "applies"],
                    APPLIES,
                    "S: with the shape of p held; the change of the pivoted shoe's shape with μ is not in it.",
                ),
                Table(refused(result), REFUSED, "The other laws, and why they do not apply."),
                *(Source(f"studies/{file}", (HERE.parent / file).read_text()) for file in FILES),
            ],
        ),
    ]
