"""The ladder's rigid-shoe laws: worked examples of textbooks, and limits of the laws in closed
form.
"""

import math
from functools import cache, partial
from math import cos, radians, sin

import numpy as np

from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.laws import locking_friction
from drumlin.laws.shapes import LAWS, equivalent_friction, m_and_n, pivot_radius
from drumlin.laws.simscape import DoubleShoe
from drumlin.models import MODELS
from drumlin.response.merit import rated, sensitivity
from drumlin.response.response import Response
from drumlin_studies import closed_forms
from drumlin_studies.ladder_case import EXACT, PRINTED, KnownAnswer
from drumlin_studies.textbook_brakes import hinged, lever_block, pad


def _solve(model: str, brake: object) -> Response:
    return MODELS[model].solve(brake)


def _shigley_16_2() -> float:
    """Torque [N m] of both shoes at 1 MPa on the helped one."""
    shoe = {
        "R": 0.15,
        "a": math.hypot(0.112, 0.05),
        "arc": (0.0, radians(126)),
        "mu": 0.32,
        "width": 0.032,
    }
    helped = rated(hinged(**shoe, moment=100.0, spin=-1), MODELS["sine"].solve, 1e6)  # type: ignore[arg-type]
    opposed = hinged(**shoe, moment=helped.shoes[0].actuation.force, spin=1)  # type: ignore[arg-type]
    return _solve("sine", helped).torque + _solve("sine", opposed).torque


@cache
def _shigley_p16_1() -> Response:
    block = DoubleShoe(
        r_D=0.15,
        r_p=0.125,
        r_a=0.125 * cos(radians(30)),
        theta_p=radians(30),
        theta_sb=0.0,
        theta_s=radians(120),
        mu_Coulomb=0.28,
    )
    return _solve("sine", block.brake(2200.0, "clockwise"))


@cache
def _bhandari_12_7() -> Response:
    h = float(pivot_radius(0.25, radians(50)))
    lever = hinged(
        R=0.25,
        a=0.45,
        arc=(radians(30), radians(130)),
        moment=100.0,
        mu=0.2,
        side="external",
        width=0.1,
        pivot=(h, radians(80)),
    )
    return _solve("pivoted", rated(lever, MODELS["pivoted"].solve, 0.5e6))


@cache
def _bhandari_12_8() -> tuple[float, float]:
    """Force [N] and torque [N m]."""
    shoe = {
        "R": 0.125,
        "a": math.hypot(0.0866, 0.05),
        "arc": (0.0, radians(120)),
        "mu": 0.32,
        "width": 0.04,
    }
    helped = rated(hinged(**shoe, moment=100.0, spin=-1), MODELS["sine"].solve, 1e6)  # type: ignore[arg-type]
    moment = helped.shoes[0].actuation.force  # at a unit arm
    opposed = hinged(**shoe, moment=moment, spin=1)  # type: ignore[arg-type]
    return moment / 0.1875, _solve("sine", helped).torque + _solve("sine", opposed).torque


def _block(a: float = 0.05, spin: int = 1, mu: float = 0.35, x: float = 0.2) -> Brake:
    return lever_block(R=0.125, arm=0.45, x=x, a=a, P=700.0, mu=mu, half=radians(45), spin=spin)


def _block_by_statics() -> float:
    psi = closed_forms.equivalent_block(radians(45))
    normal = 700.0 * 0.45 / (0.2 - 0.35 * (0.125 + 0.05 - psi * 0.125))
    return 0.35 * psi * 0.125 * normal


def _lock_of_block() -> float:
    brake = lever_block(
        R=0.125, arm=0.45, x=0.03, a=0.15, P=700.0, mu=0.1, half=radians(20), spin=1
    )
    return float(locking_friction(brake, brake.shoes[0], LAWS["block"]))


def _double_block() -> float:
    """Torque of two blocks face to face over that of one."""
    one = lever_block(R=0.125, arm=0.45, x=0.2, a=0.0, P=700.0, mu=0.35, half=radians(45), spin=1)
    data = one.shoes[0].model_dump()
    data["name"] = "below"
    data["hinge"] = {"x": one.shoes[0].pin.x, "y": -one.shoes[0].pin.y}
    data["lining"] |= {"start": -one.shoes[0].lining.end, "end": -one.shoes[0].lining.start}
    data["actuation"] |= {"direction": math.pi / 2, "point": {"x": 0.25, "y": -0.125}}
    both = vary(one, {"shoe": [one.shoes[0].model_dump(), data]})
    return _solve("block", both).torque / _solve("block", one).torque


def _gate() -> Response:
    return _solve(
        "short",
        lever_block(R=0.25, arm=1.0, x=0.5, a=0.2, P=100.0, mu=0.35, half=radians(10), spin=1),
    )


def _two_short_shoes() -> float:
    """Both opposite each other at 90 deg from their pins, a = R: N = M/(R (1 -+ mu)), N_1 = 400,
    N_2 = 160 N.
    """
    shoe = {"R": 0.2, "a": 0.2, "arc": (radians(88), radians(92)), "mu": 0.25, "side": "external"}
    turned = -math.pi / 2
    torques = [
        _solve("short", hinged(**shoe, moment=moment, hand=hand, turned=turned)).torque  # type: ignore[arg-type]
        for hand, moment in ((1, 60.0), (-1, 40.0))
    ]
    return math.fsum(torques)


M, H, X_1, X_2, PAD_MU = 90.0, 0.06, 0.05, 0.2, 0.4


def _long_pad() -> float:
    return (
        _solve("linear", pad(h=H, span=(X_1, X_2), moment=M, mu=PAD_MU, width=0.03))
        .shoes[0]
        .peak_pressure
    )


def _short_pad() -> float:
    return _solve("short", pad(h=H, span=(0.1, 0.16), moment=M, mu=PAD_MU)).shoes[0].normal_force


NPTEL_SHOE = {
    "R": 0.2,
    "a": 0.23,
    "arc": (radians(20), radians(130)),
    "mu": 0.3,
    "side": "external",
    "width": 0.05,
}


def _nptel_moment() -> float:
    """F l = M_p - M_f for 0.8 MPa."""
    p, b, R, d, mu, t_1, t_2 = 0.8e6, 0.05, 0.2, 0.23, 0.3, radians(20), radians(130)
    M_p = 0.5 * p * b * R * d * ((t_2 - t_1) + 0.5 * (sin(2 * t_1) - sin(2 * t_2)))
    M_f = mu * p * b * R * (R * (cos(t_1) - cos(t_2)) - d / 4 * (cos(2 * t_1) - cos(2 * t_2)))
    return M_p - M_f


def _nptel_long_shoe() -> float:
    return _solve("sine", hinged(**NPTEL_SHOE, moment=_nptel_moment(), spin=1)).torque  # type: ignore[arg-type]


SHORT_SHOE = {
    "R": 0.2,
    "a": 0.25,
    "arc": (radians(75) - 0.05, radians(75) + 0.05),
    "mu": 0.3,
    "side": "external",
}


def _sensitivity() -> float:
    return sensitivity(hinged(**SHORT_SHOE, moment=50.0), MODELS["short"].solve)  # type: ignore[arg-type]


def _sensitivity_by_formula() -> float:
    m, n = 0.25 * sin(radians(75)) / (0.3 * 0.2), 1 - 0.25 * cos(radians(75)) / 0.2
    assert np.allclose(m_and_n(0.3, radians(75), 0.2, 0.25), (m, n))
    return m / (m - n)


def _simscape(what: str) -> float:
    block = DoubleShoe()
    return float(sum(block.shoe_torques(1.0, 1.0))) if what == "T/F" else block.mu_lock


SHIGLEY, BHANDARI = "Shigley, Mechanical Engineering Design", "Bhandari, Design of Machine Elements"
LESSON, UWA = (
    "NPTEL, Machine Design II, lesson 12.1",
    "University of Western Australia, notes on brakes",
)
LAW_CASES = (
    KnownAnswer(
        "internal shoes rated by pressure",
        "sine law",
        f"{SHIGLEY}, ex. 16-2, its formulas",
        "torque [N m]",
        527.761,
        1e-6,
        PRINTED,
        _shigley_16_2,
    ),
    KnownAnswer(
        "internal shoes under a force",
        "sine law",
        f"{SHIGLEY}, problem 16-1",
        "peak pressure [kPa]",
        734.0,
        7e-4,
        PRINTED,
        lambda: _shigley_p16_1().shoes[0].peak_pressure * 1e-3,
    ),
    KnownAnswer(
        "internal shoes under a force",
        "sine law",
        f"{SHIGLEY}, problem 16-1, its formulas",
        "torque [N m]",
        422.004,
        1.2e-6,
        PRINTED,
        lambda: _shigley_p16_1().torque,
    ),
    KnownAnswer(
        "pivoted block",
        "law of a shoe on a pivot",
        f"{BHANDARI}, ex. 12.7",
        "torque [N mm]",
        957555.554,
        1e-9,
        PRINTED,
        lambda: _bhandari_12_7().torque * 1e3,
    ),
    KnownAnswer(
        "internal shoes of a car",
        "sine law",
        f"{BHANDARI}, ex. 12.8",
        "force [N]",
        2089.795894,
        1e-9,
        PRINTED,
        lambda: _bhandari_12_8()[0],
    ),
    KnownAnswer(
        "internal shoes of a car",
        "sine law",
        f"{BHANDARI}, ex. 12.8",
        "torque [N mm]",
        434831.0515,
        1e-9,
        PRINTED,
        lambda: _bhandari_12_8()[1] * 1e3,
    ),
    KnownAnswer(
        "block on a lever",
        "block law",
        "problem collection; printed with mu' rounded to .385",
        "torque [N m]",
        83.87,
        5e-4,
        PRINTED,
        lambda: _solve("block", _block()).torque,
    ),
    KnownAnswer(
        "block on a lever, exact statics",
        "cosine law",
        "statics of p_0 cos, mu N at psi R",
        "torque [N m]",
        _block_by_statics(),
        1e-11,
        EXACT,
        lambda: _solve("cosine", _block()).torque,
    ),
    *(
        KnownAnswer(
            "equivalent friction of a block",
            "block law",
            LESSON,
            f"mu'/mu, half-arc {angle} deg",
            closed_forms.equivalent_block(radians(angle)),
            1e-13,
            EXACT,
            partial(lambda half: float(equivalent_friction(half)), radians(angle)),
        )
        for angle in (30, 90)
    ),
    KnownAnswer(
        "back stop",
        "self-locking of a block",
        f"{LESSON}: mu' = x/a",
        "mu_lock",
        0.03 / 0.15 / closed_forms.equivalent_block(radians(20)),
        1e-9,
        EXACT,
        _lock_of_block,
    ),
    KnownAnswer(
        "double block",
        "several shoes",
        LESSON,
        "torque over that of one block",
        2.0,
        1e-12,
        EXACT,
        _double_block,
    ),
    KnownAnswer(
        "short shoe on a lever",
        "short-shoe law",
        "GATE examination",
        "normal force [N]",
        232.558,
        2e-6,
        PRINTED,
        lambda: _gate().shoes[0].normal_force,
    ),
    KnownAnswer(
        "short shoe on a lever",
        "short-shoe law",
        "GATE examination",
        "torque [N m]",
        20.35,
        2.5e-4,
        PRINTED,
        lambda: _gate().torque,
    ),
    KnownAnswer(
        "two short shoes",
        "short-shoe law",
        "statics by hand: .25 x .2 x (400 + 160)",
        "torque [N m]",
        28.0,
        1e-9,
        EXACT,
        _two_short_shoes,
    ),
    KnownAnswer(
        "long shoe on a plane",
        "linear law",
        f"{UWA}, eq. iv",
        "peak pressure [Pa]",
        M * X_2 / 0.03 / ((X_2**3 - X_1**3) / 3 + PAD_MU * H * (X_2**2 - X_1**2) / 2),
        1e-12,
        EXACT,
        _long_pad,
    ),
    KnownAnswer(
        "short shoe on a plane",
        "short-shoe law",
        f"{UWA}, eq. iii",
        "normal force [N]",
        M / (0.13 + PAD_MU * H),
        1e-12,
        EXACT,
        _short_pad,
    ),
    KnownAnswer(
        "external long shoe",
        "sine law",
        LESSON,
        "torque [N m]",
        0.3 * 0.8e6 * 0.05 * 0.2**2 * (cos(radians(20)) - cos(radians(130))),
        1e-12,
        EXACT,
        _nptel_long_shoe,
    ),
    KnownAnswer(
        "sensitivity to friction",
        "S by differences",
        f"{UWA}, S = m/(m - n)",
        "S",
        _sensitivity_by_formula(),
        1e-6,
        EXACT,
        _sensitivity,
    ),
    KnownAnswer(
        "double-shoe block of Simscape",
        "sine law",
        "Simscape Driveline, its formulas at its defaults",
        "T/F [m]",
        0.2176081,
        5e-7,
        PRINTED,
        partial(_simscape, "T/F"),
    ),
    KnownAnswer(
        "double-shoe block of Simscape",
        "self-locking",
        "Simscape Driveline, its formulas at its defaults",
        "mu_lock",
        0.823082,
        1e-6,
        PRINTED,
        partial(_simscape, "mu_lock"),
    ),
)
