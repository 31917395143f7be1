"""Self-locking of elastic brakes: limit, torque up to it, uniqueness of answers, slopes against
differences.
"""

import math
from typing import Any

import numpy as np

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.contact.self_locking import agreement, first_singular, limit
from drumlin.fem.analysis.self_locking import limits, torques
from drumlin.fem.analysis.sensitivity import against_differences
from drumlin.fem.equilibrium.group import ShoeGroup
from drumlin.fem.model import respond
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.laws import locking_friction, sine
from drumlin_studies.random_brake import random_brake

FARTHEST_FRICTION = 3.0  # friction coefficient up to which the limit of a brake is looked for
FARTHEST_RANDOM_FRICTION = 100.0  # and that of a random brake
LARGEST_FRICTION = (
    1.0  # friction coefficient up to which a shoe that never locks is asked for its uniqueness
)
LIMIT_FRACTIONS = (0.1, 0.3, 0.5, 0.7, 0.9, 0.99)
BEYOND_LIMIT = (
    1 + 1e-6,
    1.01,
    1.1,
    1.5,
    2.0,
    3.0,
)  # parts of the limit at which there should be no answer
RANDOM_STARTS = 5  # random contact sets
LOCKING_ELEMENTS = 16  # of the random brakes
ALL_SETS_ELEMENTS = 4  # elements of the brakes on which all contact sets are tried
START_SEED = 7
AGREEMENT_COUNTS = ("starts", "same", "others", "unstable", "lost")

Row = dict[str, Any]


def limit_row(brake: Brake, elements: int) -> Row:
    """mu_lock of a brake, elastic and by the sine law: of its first group of shoes to lock."""
    scene = prepare(brake, elements=elements)
    found = min(limits(scene, brake, FARTHEST_FRICTION).values(), key=lambda end: end.friction)
    law = _law(brake)
    mu, t_over_R = found.friction, brake.shoes[0].lining.thickness / brake.size
    off = mu / law - 1
    return {
        "mu_lock": mu,
        "law": law,
        "difference": off,
        "bounded": found.bounded,
        "elements": elements,
        "t_over_R": t_over_R,
    }


def torque_row(brake: Brake, name: str, elements: int) -> Row:
    """Torque [N m] over friction up to the elastic limit, and by the sine law up to that of the
    law.
    """
    scene = prepare(brake, elements=elements)
    end = min(found.friction for found in limits(scene, brake, FARTHEST_FRICTION).values())
    law = _law(brake)
    mu = [end * x for x in (*np.linspace(0.02, 0.9, 45), *(1 - np.logspace(-1, -6, 26)[1:]))]
    of_law = [m for m in mu if m < law * 0.999]
    return {
        "name": name,
        "mu": mu,
        "law_mu": of_law,
        "mu_lock": end,
        "law": law,
        "torque": torques(scene, brake, mu).sum(axis=1).tolist(),
        "law_torque": [sine(vary(brake, {"friction": m})).torque for m in of_law],
    }


def _law(brake: Brake) -> float:
    return min(locking_friction(brake, shoe) for shoe in brake.shoes)


def pole(row: Row) -> tuple[float, float]:
    """T (mu_lock - mu) [N m] nearest to the limit, and by what part of itself it still changes from
    1e-5 of it on.

    `row`: of torque_row.
    """
    products = [T * (row["mu_lock"] - mu) for mu, T in zip(row["mu"], row["torque"], strict=True)]
    near = [
        p for p, mu in zip(products, row["mu"], strict=True) if 1 - mu / row["mu_lock"] < 1.01e-5
    ]
    return products[-1], abs(near[-1] / near[0] - 1)


def uniqueness_row(seed: int, way: str) -> Row:
    """One random brake: starts from all, no and random nodes at each fraction of its limit; beyond
    the limit.

    `way`: as `random_brake` takes it.
    """
    brake = random_brake(seed, way)
    scene = prepare(brake, elements=LOCKING_ELEMENTS)
    problems = ShoeGroup(scene, brake, (0,)).sliding
    end, n, rng = (
        limit(problems, FARTHEST_RANDOM_FRICTION),
        len(problems.still.q),
        np.random.default_rng([START_SEED, seed]),
    )
    starts = [
        np.ones(n, bool),
        np.zeros(n, bool),
        *(rng.random(n) < 0.5 for _ in range(RANDOM_STARTS)),
    ]
    top = min(end.friction, LARGEST_FRICTION)
    total: Row = dict.fromkeys(AGREEMENT_COUNTS, 0) | {"difference": 0.0}
    disagreeing = []
    for fraction in LIMIT_FRACTIONS:
        mu = fraction * top
        answer = limit(problems, mu).last
        found = agreement(problems.at(mu), answer, starts)
        for key in AGREEMENT_COUNTS:
            total[key] += getattr(found, key)
        total["difference"] = max(total["difference"], found.difference)
        if found.same < found.starts:
            disagreeing.append(fraction)
    beyond = answered = None
    if end.friction <= 10:
        mu_beyond = [end.friction * x for x in BEYOND_LIMIT]
        beyond = sum(agreement(problems.at(mu), end.last, starts, 0.0).others for mu in mu_beyond)
        answered = sum(_answers(scene, vary(brake, {"friction": mu})) for mu in mu_beyond)
    small = prepare(brake, elements=ALL_SETS_ELEMENTS)
    any_set = first_singular(ShoeGroup(small, brake, (0,)).sliding)
    shoe = brake.shoes[0]
    return {
        "brake": seed,
        "way": way,
        "mu_lock": None if math.isinf(end.friction) else end.friction,
        "bounded": end.bounded,
        "law": locking_friction(brake, shoe),
        "top": top,
        "disagreeing": disagreeing,
        "beyond": beyond,
        "answered": answered,
        "any_set": None if math.isinf(any_set) else any_set,
        "clearance": _clearance(brake),
        "shoe": "elastic" if shoe.body else "rigid",
        "t_over_R": shoe.lining.thickness / brake.size,
        **total,
    }


def _answers(scene: PreparedModel, brake: Brake) -> bool:
    """Whether drumlin itself gives a number, the contact as stiff as that whose limit was followed."""
    try:
        respond(scene, brake, penalty=math.inf)
    except NoAnswer:
        return False
    return True


def _clearance(brake: Brake) -> str:
    given = brake.shoes[0].lining.clearance
    return "uneven" if isinstance(given, tuple) else "none" if given == 0 else "even"


def slope_rows(brake: Brake, name: str, penalty: float) -> list[Row]:
    """Slopes of the whole torque next to differences; S of the elastic brake and of the sine law in
    the first row.
    """
    found, table = against_differences(brake, 1, elements=20, penalty=penalty)
    return [
        row
        | {"brake": name}
        | ({"S": found.S, "law": (found.law or (None,))[-1]} if k == 0 else {})
        for k, row in enumerate(table)
    ]
