"""Self-locking of the elastic brake: its limit, the torque up to it, whether the answer is unique, sensitivities."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drumlin.brake.drum_brake import Brake
from drumlin.brake.file import read_brake, vary
from drumlin.comparison import Column
from drumlin.contact.self_locking import agreement, first_singular, limit
from drumlin.errors import NoAnswer
from drumlin.fem.assembly import Scene, prepare
from drumlin.fem.group import ShoeGroup
from drumlin.fem.model import PENALTY, respond
from drumlin.fem.self_locking import limits, torques
from drumlin.fem.sensitivity import against_differences
from drumlin.journal import Journal
from drumlin.laws import locking_friction, sine
from drumlin.report import figures, locking_figures
from drumlin.report.page import Figure, Section, Table, Text
from drumlin.verification.random_brake import random_brake

FILE = Path(__file__).parents[1] / "double_shoe" / "brake.toml"
THICKNESSES = (8e-3, 3e-3, 1e-3)
RING = {"thickness": 0.015, "width": 0.04, "material": {"E": 120e9, "nu": 0.25}, "support": "free"}
FRACTIONS = (0.1, 0.3, 0.5, 0.7, 0.9, 0.99)
LARGEST = 1.0  # friction coefficient up to which a shoe that never locks is asked for its uniqueness
FAR = 3.0  # friction coefficient up to which the limit of the double-shoe brake is looked for
NEVER = 100.0  # and that of a random brake
STARTS = 5  # random contact sets
BEYOND = (1 + 1e-6, 1.01, 1.1, 1.5, 2.0, 3.0)  # parts of the limit at which there should be no answer
SMALL = 4  # elements of the brakes on which all contact sets are tried
SEED = 7

Row = dict[str, Any]


class Result(NamedTuple):
    """Rows of each table: limits over stiffness, over the mesh, of a rigid shoe; torque; uniqueness; sensitivity."""

    shoe: list[Row]
    ring: list[Row]
    rigid: list[Row]
    mesh: list[Row]
    torque: list[Row]
    unique: list[Row]
    slopes: list[Row]


def rows(short: bool = False, journal: Journal | None = None, say: Callable[[str], None] = lambda _: None) -> Result:
    """Compute all rows, each kept in the journal as it comes; `short`: fewer and coarser."""
    kept = Journal() if journal is None else journal  # an empty journal is falsy
    elements = 16 if short else 40
    brake, every = read_brake(FILE), 4 if short else 1
    ways = ("locking", "opposed")

    def locked(**case: Any) -> Row:
        changes = {key: case[key] for key in case if "." in key}
        return kept.once({"of": "limit", **case}, lambda: _limit(vary(brake, changes), case.get("n", elements)) | case)

    say("limits of self-locking")
    E = brake.shoes[0].body.material.E  # type: ignore[union-attr]
    exponents = [k / 2 for k in range(-6, 13)][::every]
    shoe = [
        locked(**{"shoe.body.material.E": E * 10**k, "shoe.lining.thickness": t, "factor": 10**k})
        for t in THICKNESSES
        for k in exponents
    ]
    ring = [
        locked(**{"drum.ring": RING | {"support": support}, "drum.ring.material.E": 120e9 * 10**k, "factor": 10**k,
                  "support": support})
        for support in ("free", "fixed")
        for k in [k / 2 for k in range(-8, 9)][::every]
    ]  # fmt: skip
    rigid = [
        locked(**{"shoe.body": None, "shoe.lining.thickness": 8e-3 / 2**k, "n": 2 * elements})
        for k in range(3 if short else 6)
    ]
    mesh = [locked(**{"friction": 0.3, "n": n}) for n in ((10, 20, 40) if short else (20, 40, 80, 160))]
    say("torque up to the limit")
    torque = [
        kept.once({"of": "torque", "ring": ringed, "n": elements}, lambda r=ringed: _torque(brake, r, elements))  # type: ignore[misc]
        for ringed in (False, True)
    ]
    say("uniqueness")
    count = 3 if short else 30
    cases = [(k, way) for k in range(count) for way in ways]
    unique = [
        kept.once({"of": "unique", "seed": k, "way": way, "n": elements}, lambda k=k, w=way: _unique(k, w))  # type: ignore[misc]
        for k, way in cases
    ]
    say("sensitivities against differences")
    named: dict[str, dict[str, Any]] = {
        "stiff shoes": {}, "clockwise": {"rotation": "clockwise"}, "with a free ring": {"drum.ring": RING},
        "clearance, soft contact": {"shoe.lining.clearance": 1e-5}, "friction 0.6": {"friction": 0.6},
    }  # fmt: skip
    compared = [
        row
        for name, changes in list(named.items())[: 1 if short else None]
        for row in kept.once(
            {"of": "slopes", "name": name},
            lambda name=name, changes=changes: {"rows": _slopes(name, vary(brake, changes))},  # type: ignore[misc]
        )["rows"]
    ]
    return Result(shoe, ring, rigid, mesh, torque, unique, compared)


def _limit(brake: Brake, elements: int) -> Row:
    """mu_lock of the brake, elastic and by the sine law: of its first group of shoes to lock."""
    scene = prepare(brake, elements=elements)
    found = min(limits(scene, brake, FAR).values(), key=lambda end: end.friction)
    law = min(locking_friction(brake, shoe) for shoe in brake.shoes)
    mu = found.friction
    return {"mu_lock": mu, "law": law, "difference": mu / law - 1, "bounded": found.bounded, "elements": elements,
            "t_over_R": brake.shoes[0].lining.thickness / brake.drum.radius}  # fmt: skip


def _torque(brake: Brake, ringed: bool, elements: int) -> Row:
    """Torque [N m] over friction up to the elastic limit and that of the law, and the product that shows the pole."""
    brake = vary(brake, {"drum.ring": RING}) if ringed else brake
    scene = prepare(brake, elements=elements)
    end = min(found.friction for found in limits(scene, brake, FAR).values())
    law = min(locking_friction(brake, shoe) for shoe in brake.shoes)
    mu = [end * x for x in (*np.linspace(0.02, 0.9, 45), *(1 - np.logspace(-1, -6, 26)[1:]))]
    of_law = [m for m in mu if m < law * 0.999]
    return {
        "name": "with a free ring" if ringed else "rigid drum", "mu": mu, "law_mu": of_law, "mu_lock": end, "law": law,
        "torque": torques(scene, brake, mu).sum(axis=1).tolist(),
        "law_torque": [sine(vary(brake, {"friction": m})).torque for m in of_law],
    }  # fmt: skip


def _unique(seed: int, way: str) -> Row:
    """One random brake: starts from all, no and random nodes at each fraction of its limit; beyond the limit."""
    brake = random_brake(seed, way)
    scene = prepare(brake, elements=16)
    problems = ShoeGroup(scene, brake, (0,)).sliding
    end, n, rng = limit(problems, NEVER), len(problems.still.q), np.random.default_rng([SEED, seed])
    starts = [np.ones(n, bool), np.zeros(n, bool), *(rng.random(n) < 0.5 for _ in range(STARTS))]
    top = min(end.friction, LARGEST)
    total: Row = dict.fromkeys(("starts", "same", "others", "unstable", "lost"), 0) | {"difference": 0.0}
    disagreeing = []
    for fraction in FRACTIONS:
        mu = fraction * top
        answer = limit(problems, mu).last
        found = agreement(problems.at(mu), answer, starts)
        for key in ("starts", "same", "others", "unstable", "lost"):
            total[key] += getattr(found, key)
        total["difference"] = max(total["difference"], found.difference)
        if found.same < found.starts:
            disagreeing.append(fraction)
    beyond = answered = None
    if end.friction <= 10:
        mu_beyond = [end.friction * x for x in BEYOND]
        beyond = sum(agreement(problems.at(mu), end.last, starts, 0.0).others for mu in mu_beyond)
        answered = sum(_answers(scene, vary(brake, {"friction": mu})) for mu in mu_beyond)
    small = prepare(brake, elements=SMALL)
    any_set = first_singular(ShoeGroup(small, brake, (0,)).sliding)
    shoe = brake.shoes[0]
    return {
        "brake": seed, "way": way, "mu_lock": None if math.isinf(end.friction) else end.friction, "bounded": end.bounded,
        "law": locking_friction(brake, shoe), "top": top, "disagreeing": disagreeing, "beyond": beyond, "answered": answered,
        "any_set": None if math.isinf(any_set) else any_set, "clearance": _clearance(brake),
        "shoe": "elastic" if shoe.body else "rigid", "t_over_R": shoe.lining.thickness / brake.drum.radius, **total,
    }  # fmt: skip


def _answers(scene: Scene, brake: Brake) -> bool:
    """Whether drumlin itself gives a number, the contact as stiff as that whose limit was followed."""
    try:
        respond(scene, brake, penalty=math.inf)
    except NoAnswer:
        return False
    return True


def _clearance(brake: Brake) -> str:
    given = brake.shoes[0].lining.clearance
    return "uneven" if isinstance(given, tuple) else "none" if given == 0 else "even"


def _slopes(name: str, brake: Brake) -> list[Row]:
    """Slopes of the whole torque next to differences; S of the elastic brake and of the sine law in the first row."""
    found, table = against_differences(brake, 1, elements=20, penalty=100.0 if "soft" in name else PENALTY)
    return [row | {"brake": name} | ({"S": found.S, "law": (found.law or (None,))[-1]} if k == 0 else {})
            for k, row in enumerate(table)]  # fmt: skip


LIMITS = (
    Column("elements", "elements along the lining", form="d"),
    Column("t_over_R", "lining thickness over R", form=".4f"),
    Column("mu_lock", "elastic limit of μ", form=".8f"),
    Column("law", "μ_lock of the sine law", form=".6f"),
    Column("difference", "difference", "%", 100, "+.3f"),
    Column("per_thickness", "difference over t/R", form="+.3f"),
)
UNIQUE = (
    Column("brake", "brake", form="d"),
    Column("way", "friction"),
    Column("shoe", "shoe"),
    Column("clearance", "clearance"),
    Column("t_over_R", "t/R", form=".3f"),
    Column("law", "μ_lock, law", form=".3f"),
    Column("mu_lock", "μ_lock, elastic", form=".5f"),
    Column("ends", "there"),
    Column("any_set", "first singular set, 9 nodes: μ", form=".3f"),
    Column("top", "up to μ", form=".3f"),
    Column("starts", "starts", form="d"),
    Column("same", "same answer", form="d"),
    Column("others", "another, stable", form="d"),
    Column("unstable", "another, unstable", form="d"),
    Column("lost", "not converged", form="d"),
    Column("where", "disagreeing at these parts of it"),
    Column("difference", "largest difference of p", form=".0e"),
)
SLOPES = (
    Column("brake", "brake"),
    Column("what", "slope of the torque"),
    Column("unit", "unit"),
    Column("exact", "from the tangent", form=".9g"),
    Column("near", "central difference", form=".9g"),
    Column("difference", "relative difference", form=".0e"),
    Column("S", "S = (μ/T) dT/dμ", form=".4f"),
    Column("law", "S, sine law", form=".4f"),
)


def sections(result: Result, folder: Path) -> list[Section]:
    """What the page of the study shows; figures go to `folder`."""
    return [_locking(result, folder), _uniqueness(result), _sensitivity(result)]


def _locking(result: Result, folder: Path) -> Section:
    law = result.mesh[0]["law"]
    thick = {t: [row for row in result.shoe if row["shoe.lining.thickness"] == t] for t in THICKNESSES}
    series = {f"lining {t * 1e3:g} mm": _curve(of) for t, of in thick.items()}
    rings = {
        f"{support} rim": _curve([row for row in result.ring if row["support"] == support])
        for support in ("free", "fixed")
    }
    figures.save(locking_figures.limits([("shoe", series), ("drum ring", rings)], law), folder / "locking.svg")
    figures.save(locking_figures.poles(result.torque), folder / "locking_torque.svg")
    rigid = [row | {"per_thickness": row["difference"] / row["t_over_R"]} for row in result.rigid]
    stiffest = {t: max(of, key=lambda row: row["factor"]) for t, of in thick.items()}
    ends = ", ".join(f"{stiffest[t]['difference']:+.2%} ({t * 1e3:g} mm)" for t in THICKNESSES)
    highest = max(row["difference"] for row in result.shoe)
    own = next(row for row in result.ring if row["support"] == "free" and row["factor"] == 1)
    pole = [_pole(row) for row in result.torque]
    return Section(
        "Self-locking",
        [
            Text(
                "Under full slip the condensed equations are linear in μ. On a contact set they have no answer where "
                "their matrix is singular, at a generalised eigenvalue; the contact set, and so the eigenvalue, changes "
                "with μ. The answer is followed from μ = 0 up to the eigenvalue of a set that holds right up to it. Force "
                "and clearance have no part in that limit: pressures grow beyond them. Where the set changes so that the "
                "determinant changes its sign the answer turns back at finite pressure instead."
            ),
            Figure(
                folder / "locking.svg",
                "Limit of self-locking of the double-shoe brake over the stiffness of its shoes (rigid drum) and of an "
                "elastic drum ring 15 mm thick, whose other rim is free or fixed. Dashed: the sine law.",
            ),
            Text(
                "<b>Towards the law.</b> As the shoe stiffens the elastic limit tends to that of the law, but for what "
                f"the lining's own shear leaves: at the stiffest shoe {ends} of {law:.4f}. That rest is linear in the "
                f"lining's thickness: {rigid[2]['per_thickness']:+.2f} t/R for rigid shoes (below, while the mesh resolves "
                f"the lining). A softer shoe locks up to {highest:.0%} later than the law; with a drum ring of its own "
                f"stiffness and a free rim the brake locks {own['difference']:+.1%} from the law."
            ),
            Table(rigid, LIMITS, "Rigid shoes with ever thinner linings: the limit tends to the law's as t/R."),
            Table(result.mesh, LIMITS, "The limit of the brake on finer meshes."),
            Figure(
                folder / "locking_torque.svg",
                "Torque over friction and, right, the torque times the distance from the limit: constant at a simple pole, which is reached once the contact set stays: with the ring the contact shrinks up to then.",
            ),
            Text(
                "<b>The pole.</b> T (μ_lock − μ) settles at "
                + " and ".join(
                    f"{value:.5g} N m ({row['name']})" for value, row in zip(pole, result.torque, strict=True)
                )
                + "; between distances of 1e-5 and 1e-6 of the limit it changes by "
                + " and ".join(f"{_drift(row):.0e}" for row in result.torque)
                + " of itself. Beyond the limit a brake is refused, and the line names both limits."
            ),
        ],
    )


def _curve(of: list[Row]) -> tuple[list[float], list[float]]:
    return [row["factor"] for row in of], [row["mu_lock"] for row in of]


def _products(row: Row) -> list[float]:
    return [T * (row["mu_lock"] - mu) for mu, T in zip(row["mu"], row["torque"], strict=True)]


def _pole(row: Row) -> float:
    return _products(row)[-1]


def _drift(row: Row) -> float:
    products = _products(row)
    near = [p for p, mu in zip(products, row["mu"], strict=True) if 1 - mu / row["mu_lock"] < 1.01e-5]
    return abs(near[-1] / near[0] - 1)


def _uniqueness(result: Result) -> Section:
    rows = result.unique
    shown = [
        row | {
            "ends": None if row["mu_lock"] is None else "turns back" if row["bounded"] else "pole",
            "where": ", ".join(f"{f:g}" for f in row["disagreeing"]) or None,
            "law": None if math.isinf(row["law"]) else row["law"],
        }
        for row in rows
    ]  # fmt: skip
    locking, opposed = ([row for row in rows if row["way"] == way] for way in ("locking", "opposed"))
    starts = sum(row["starts"] for row in rows)
    agreed = [row for row in rows if not row["disagreeing"]]
    never = sum(row["mu_lock"] is None for row in opposed)
    turning = sum(row["bounded"] for row in rows)
    beyond = [row for row in rows if row["beyond"] is not None]
    differing = [row for row in shown if row["disagreeing"]]
    return Section(
        "Is the answer unique?",
        [
            Text(
                f"{len(rows)} random brakes of one shoe: {len(locking)} that the sine law locks, {len(opposed)} whose "
                "friction opposes. Each at parts of its own limit, "
                + ", ".join(f"{f:g}" for f in FRACTIONS)
                + f" (of μ = {LARGEST:g} where it locks later or never), from all nodes, none, and {STARTS} random "
                f"contact sets: {starts} starts. {sum(row['same'] for row in rows)} end at the answer followed from μ = 0, "
                f"on {len(agreed)} brakes all of them; {sum(row['others'] for row in rows)} at another that is stable as "
                f"well, {sum(row['unstable'] for row in rows)} at an unstable one, {sum(row['lost'] for row in rows)} "
                "nowhere. drumlin keeps the stable answer that its first guess leads to; where that leads to none, and beyond "
                "the limit of the rigid shoe, it follows the answer from μ = 0."
            ),
            Text(
                f"Of the {len(opposed)} shoes whose friction opposes {never} never lock up to μ = {NEVER:g}. {turning} brakes do "
                "not lock at a pole but turn back at finite pressure, where the contact set changes: below that two "
                f"answers stand side by side. Beyond the limits, up to {BEYOND[-1]:g} times, {sum(row['beyond'] for row in beyond)} "
                "stable answers were found from the same starts, which no friction that grows from 0 "
                f"leads to. Asked there, {len(beyond)} brakes at {len(BEYOND)} frictions each, drumlin gives "
                f"{sum(row['answered'] for row in beyond)} numbers and refuses the rest. With nine nodes all contact sets can "
                "be tried: below the first singular one every load and clearance has just one answer. It lies well below "
                "the limit of the load at hand."
            ),
            Table(differing, UNIQUE, "The brakes on which starts disagree.")
            if differing
            else Text("No brake on which starts disagree."),
            Table([row for row in shown if not row["disagreeing"]], UNIQUE, "The brakes on which all starts agree."),
        ],
    )


def _sensitivity(result: Result) -> Section:
    worst = max(row["difference"] for row in result.slopes)
    return Section(
        "Sensitivity",
        [
            Text(
                "Slopes of the torque from the tangent of the contact equations: one solution of their transpose, and two "
                "displacement fields for the moduli. The differences solve the brake anew from its mesh; the largest "
                f"relative difference is {worst:.0e}. Force, moduli, clearance and hinge are those of the left shoe."
            ),
            Table(result.slopes, SLOPES, "Exact slopes next to central differences; double-shoe brake, 20 elements."),
        ],
    )
