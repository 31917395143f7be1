"""Worked examples of the rigid-shoe laws, each with its origin.

[P] printed in the named source, compared to the printed digits; [C] computed once from the source's
formula, compared to the digits given, 1e-6 or so; [D] derived here.
"""

import math
from math import cos, radians, sin

import numpy as np
import pytest
from pytest import approx

from drumlin import Brake, NoAnswer, Response
from drumlin.brake.file import make_drum_brake_from_data, vary
from drumlin.laws import (
    LAWS_OF_HINGED_SHOES_BY_NAME,
    ShoeAnglesAndRadii,
    self_locking_friction_of_hinged_shoe,
)
from drumlin.laws.shapes import (
    pivot_radius_for_cosine_pressure,
    ratio_of_equivalent_to_lining_friction,
    short_shoe_pressure_and_friction_moments_over_torque,
)
from drumlin.laws.simscape import DoubleShoe
from drumlin.models import MODELS
from drumlin.response.merit import (
    brake_scaled_to_peak_pressure,
    sign_of_friction_moment_about_hinge,
    torque_sensitivity_to_friction_by_differences,
)
from drumlin_studies.textbook_brakes import (
    TEXTBOOK_LINING,
    brake_with_block_on_lever,
    brake_with_one_hinged_pad,
    brake_with_one_hinged_shoe,
)
from picking import picked

C = 1e-6
"""Relative tolerance of values given with seven or more digits."""


def solve(model: str, brake: Brake) -> Response:
    assert MODELS[model].why_not(brake) is None
    response = MODELS[model].solve(brake)
    assert response.converged
    assert response.balance.force < 1e-9
    assert response.balance.moment < 1e-9
    return response


def shigley_16_2() -> Brake:
    """Shigley's example 16-2: two equal internal shoes, mirror images in their own frames.

    The force lies 24 deg off the hinge's radius.
    """
    a, c, slope = math.hypot(0.112, 0.050), 0.212, radians(24)
    shoes = []
    for name, hand, turned in (("helped", 1, 0.0), ("opposed", -1, math.pi)):
        x, y = a - c * cos(slope), c * sin(slope)
        place = math.atan2(y, x)
        shoes.append(
            {
                "name": name,
                "side": "internal",
                "hinge": {"radius": a, "angle": turned},
                "lining": TEXTBOOK_LINING
                | {
                    "width": 0.032,
                    "start": turned + min(0.0, hand * radians(126)),
                    "end": turned + max(0.0, hand * radians(126)),
                },
                "actuation": {
                    "force": 1000.0,
                    "direction": turned + hand * (math.pi / 2 - slope),
                    "point": {"radius": math.hypot(x, y), "angle": turned + hand * place},
                },
            }
        )
    return make_drum_brake_from_data(
        {
            "title": "16-2",
            "rotation": "clockwise",
            "friction": 0.32,
            "drum": {"radius": 0.15},
            "shoe": shoes,
        }
    )


def test_shigley_example_16_2_internal_shoes_from_the_permissible_pressure() -> None:
    """Shigley, example 16-2 [C]: forces, torques and pins at p_a = 1000 kPa on the helped shoe."""
    brake = brake_scaled_to_peak_pressure(shigley_16_2(), MODELS["sine"].solve, 1e6)
    helped, opposed = solve("sine", brake).shoes
    assert brake.shoes[0].actuation.force == approx(2279.06, abs=0.005)
    assert (helped.torque, opposed.torque) == (approx(365.826, abs=5e-4), approx(161.935, abs=5e-4))
    assert solve("sine", brake).torque == approx(527.761, abs=5e-4)
    assert helped.peak_pressure == approx(1e6, rel=1e-12)
    assert opposed.peak_pressure == approx(442.656e3, abs=0.5)
    assert np.linalg.norm(helped.hinge_reaction) == approx(5041.1, abs=0.05)
    assert np.linalg.norm(opposed.hinge_reaction) == approx(864.6, abs=0.05)
    assert helped.self_energising
    assert not opposed.self_energising
    assert self_locking_friction_of_hinged_shoe(brake, brake.shoes[0]) == approx(0.82830, abs=5e-6)


def test_shigley_problem_16_1_from_the_force() -> None:
    """Shigley, problem 16-1 [C]: the force gives 734 kPa [P].

    Hinges lie 30 deg off the axis of symmetry, the force line 216.506 mm away.
    """
    a = 0.125
    block = DoubleShoe(
        r_D=0.15,
        r_p=a,
        r_a=a * cos(radians(30)),
        theta_p=radians(30),
        theta_sb=0.0,
        theta_s=radians(120),
        mu_Coulomb=0.28,
    )
    assert block.arm == approx(0.216506, abs=5e-7)
    brake = block.brake(2200.0, "clockwise")
    response = solve("sine", brake)
    first, second = response.shoes
    assert (first.torque, second.torque) == (approx(277.624, abs=5e-4), approx(144.381, abs=5e-4))
    assert response.torque == approx(422.004, abs=5e-4)
    assert first.peak_pressure == approx(734.454e3, abs=0.5)
    assert round(first.peak_pressure / 1e3) == 734
    assert second.peak_pressure == approx(381.959e3, abs=0.5)
    assert np.linalg.norm(first.hinge_reaction) == approx(4247.3, abs=0.05)
    assert np.linalg.norm(second.hinge_reaction) == approx(942.4, abs=0.05)
    assert self_locking_friction_of_hinged_shoe(brake, brake.shoes[0]) == approx(0.88681, abs=5e-6)


def test_bhandari_12_7_pivoted_block() -> None:
    """Bhandari, example 12.7 [P]: torque and reactions of a pivoted block at 0.5 MPa.

    The pivot lies where the pressure is p_0 cos.
    """
    R, half = 0.25, radians(50)
    h = float(pivot_radius_for_cosine_pressure(R, half))
    assert h * 1e3 == approx(280.588279, abs=5e-7)
    lever = brake_with_one_hinged_shoe(
        R=R,
        a=0.45,
        arc=(radians(30), radians(130)),
        moment=100.0,
        mu=0.2,
        side="external",
        width=0.1,
        pivot=(h, radians(80)),
    )
    (shoe,) = solve(
        "pivoted", brake_scaled_to_peak_pressure(lever, MODELS["pivoted"].solve, 0.5e6)
    ).shoes
    assert shoe.torque * 1e3 == approx(957555.554, abs=5e-4)
    assert shoe.pivot_reaction is not None
    along = np.array([cos(radians(80)), sin(radians(80))])
    across = np.array([-along[1], along[0]])
    assert abs(shoe.pivot_reaction @ along) == approx(17063.356, abs=5e-4)
    assert abs(shoe.pivot_reaction @ across) == approx(3412.671, abs=5e-4)
    assert shoe.torque == approx(abs(shoe.pivot_reaction @ across) * h, rel=1e-9)
    assert shoe.pressure == approx(0.5e6 * np.cos(shoe.theta - radians(80)), rel=1e-9)


def test_bhandari_12_8_internal_shoes() -> None:
    """Bhandari, example 12.8 [P]: force for 1 MPa on the helped shoe, and the torque of both."""
    moment = 100.0
    a = math.hypot(0.0866, 0.05)
    shoe = {"R": 0.125, "a": a, "arc": (0.0, radians(120)), "mu": 0.32, "width": 0.04}
    helped = brake_with_one_hinged_shoe(**shoe, moment=moment, spin=-1)
    helped = brake_scaled_to_peak_pressure(helped, MODELS["sine"].solve, 1e6)
    opposed = brake_with_one_hinged_shoe(**shoe, moment=helped.shoes[0].actuation.force, spin=1)
    torque = solve("sine", helped).torque + solve("sine", opposed).torque
    # The force has an arm of one unit.
    assert helped.shoes[0].actuation.force / 0.1875 == approx(2089.795894, rel=1e-9)
    assert torque * 1e3 == approx(434831.0515, rel=1e-9)


@pytest.mark.parametrize(("spin", "torque", "printed"), [(1, 83.8874, 83.87), (-1, 69.1543, 69.14)])
def test_block_on_a_lever_with_the_equivalent_friction(
    spin: int, torque: float, printed: float
) -> None:
    """A block on a lever has the torques of a problem collection [C] by equivalent friction.

    The printed torques [P] come from a rounded mu' = 0.385.
    """
    brake = brake_with_block_on_lever(
        R=0.125, arm=0.45, x=0.2, a=0.05, P=700.0, mu=0.35, half=radians(45), spin=spin
    )
    response = solve("block", brake)
    assert 0.35 * ratio_of_equivalent_to_lining_friction(radians(45)) == approx(0.3850750, abs=5e-8)
    assert response.torque == approx(torque, rel=C)
    rounded = 0.385 * 700 * 0.45 / (0.2 - spin * 0.385 * 0.05) * 0.125
    assert rounded == approx(printed, abs=0.005)
    assert response.shoes[0].self_energising == (spin > 0)


def test_cosine_law_of_the_same_block_by_exact_statics() -> None:
    """The cosine law on the same block by exact statics [D]: friction acts at psi R, as mu N.

    The equivalent friction is mu' N at R instead.
    """
    R, x, a, mu, half = 0.125, 0.2, 0.05, 0.35, radians(45)
    brake = brake_with_block_on_lever(R=R, arm=0.45, x=x, a=a, P=700.0, mu=mu, half=half, spin=1)
    psi = float(ratio_of_equivalent_to_lining_friction(half))
    N = 700.0 * 0.45 / (x - mu * (R + a - psi * R))
    response = solve("cosine", brake)
    assert response.torque == approx(mu * psi * R * N, rel=1e-12)
    assert response.torque < solve("block", brake).torque


@pytest.mark.parametrize(
    ("half", "ratio"),
    [(15, 1.011408), (30, 1.045356), (45, 1.100214), (60, 1.170138), (90, 4 / math.pi)],
)
def test_equivalent_friction(half: float, ratio: float) -> None:
    """NPTEL lesson 12.1, mu' [C]; 1.0453 at 30 deg [P]."""
    assert ratio_of_equivalent_to_lining_friction(radians(half)) == approx(ratio, abs=5e-7)


@pytest.mark.parametrize(("spin", "a"), ((1, 0.2), (-1, -0.2)))
def test_gate_short_shoe(spin, a) -> None:
    """GATE problem [P]: normal force and torque of a short shoe on a lever.

    Drum 500 mm, lever 1000 mm, block at 500 mm, pin 200 mm off the line of friction.
    """
    brake = brake_with_block_on_lever(
        R=0.25, arm=1.0, x=0.5, a=a, P=100.0, mu=0.35, half=radians(10), spin=spin
    )
    response = solve("short", brake)
    assert response.shoes[0].normal_force == approx(232.558, abs=5e-4)
    assert round(response.torque, 2) == 20.35
    assert response.shoes[0].self_energising


def test_simscape_defaults_and_both_readings_of_theta_s() -> None:
    """Simscape double-shoe brake, default parameters [C], per newton of force."""
    block = DoubleShoe()
    leading, trailing = block.torques_of_leading_and_trailing_shoe(1.0, 1.0)
    p_a, p_b = block.peak_line_loads_of_leading_and_trailing_shoe(1.0, 1.0)
    assert (leading, trailing) == (approx(0.1484614, rel=C), approx(0.0691468, rel=C))
    assert leading + trailing == approx(0.2176081, rel=C)
    assert p_b / p_a == approx(0.465756, rel=C)
    assert block.mu_lock == approx(0.823082, rel=C)
    span = DoubleShoe(reading="span")
    assert sum(span.torques_of_leading_and_trailing_shoe(1.0, 1.0)) == approx(0.2211397, rel=C)
    assert span.mu_lock == approx(0.794253, rel=C)


def test_simscape_block_and_its_brake_file_are_one() -> None:
    """Simscape's block has the torques of the sine law on the brake that it describes [D].

    Shoes lie inside or outside the drum.
    """
    block = DoubleShoe()
    leading, trailing = block.torques_of_leading_and_trailing_shoe(2000.0, 1.0)
    for side in ("internal", "external"):
        for rotation in ("clockwise", "counter-clockwise"):
            torques = sorted(
                picked(solve("sine", block.brake(2000.0, rotation, side)).shoes, "torque")
            )
            assert torques == [
                approx(float(trailing), rel=1e-12),
                approx(float(leading), rel=1e-12),
            ]


def test_simscape_torque_over_speed_and_force() -> None:
    """Simscape's torque is odd in omega, viscous at full friction, and zero for F <= 0.

    Beyond the threshold speed the torque grows by mu_visc omega alone.
    """
    block = DoubleShoe(mu_visc=0.5)
    omega = np.linspace(-0.02, 0.02, 81)
    torque = block.torque(1000.0, omega)
    assert torque == approx(-torque[::-1], rel=1e-12, abs=1e-12 * torque.max())
    assert torque[40] == 0.0
    assert np.all(np.diff(torque) > 0)
    # tanh(4) at the threshold: 0.9993 of the friction
    assert block.friction(0.01) / 0.3 == approx(math.tanh(4.0), rel=1e-12)
    # beyond it the rest grows by the viscous torque alone
    assert block.torque(1000.0, 3.0) - block.torque(1000.0, 1.0) == approx(2 * 0.5, rel=1e-9)
    force = np.array([-1000.0, 0.0, 500.0, 1000.0])
    by_force = block.torque(force, 1.0)
    assert by_force[:2].tolist() == [0.0, 0.0]
    assert by_force[3] - 0.5 == approx(2 * (by_force[2] - 0.5), rel=1e-12)


def test_uwa_translational_short_shoe_both_directions() -> None:
    """UWA notes, eq. iii: N = M/(a +- mu h), + where the drum drags the lining off the hinge."""
    M, h, mu, x = 90.0, 0.06, 0.4, 0.13
    for sliding, sign in (("+x", 1), ("-x", -1)):
        brake = brake_with_one_hinged_pad(h=h, span=(0.1, 0.16), moment=M, mu=mu, sliding=sliding)
        response = solve("short", brake)
        assert response.shoes[0].normal_force == approx(M / (x + sign * mu * h), rel=1e-12)
        assert response.shoes[0].self_energising == (sign < 0)
        N = response.shoes[0].normal_force
        # the pin takes what the force (down) and the contact (up, and with the body) leave
        assert response.shoes[0].hinge_reaction == approx([-sign * mu * N, M - N], rel=1e-12)


def test_uwa_translational_long_shoe() -> None:
    """UWA notes, eq. iv and the total braking effect after it."""
    M, h, mu, x1, x2, w = 90.0, 0.06, 0.4, 0.05, 0.2, 0.03
    (shoe,), (merit,) = (
        (
            r := solve(
                "linear", brake_with_one_hinged_pad(h=h, span=(x1, x2), moment=M, mu=mu, width=w)
            )
        ).shoes,
        r.merits,
    )
    assert shoe.peak_pressure == approx(
        M * x2 / w / ((x2**3 - x1**3) / 3 + mu * h * (x2**2 - x1**2) / 2), rel=1e-12
    )
    assert merit.braking_force == approx(
        M / (h + 2 * (x2**3 - x1**3) / (3 * mu * (x2**2 - x1**2))), rel=1e-12
    )
    assert shoe.pressure_at(np.array([0.1])) == approx([shoe.peak_pressure * 0.1 / x2], rel=1e-12)


@pytest.mark.parametrize("side", ["external", "internal"])
@pytest.mark.parametrize("spin", [1, -1])
def test_uwa_short_rotational_shoe_in_the_general_form(side: str, spin: int) -> None:
    """UWA notes, eq. 6a and 8: N = M/(mu r (m - dD n)), eta = 1/(m - dD n), S = m eta.

    dD follows from its definition.
    """
    r, a, theta_m, mu, M = 0.2, 0.25, radians(75), 0.3, 50.0
    arc = (theta_m - 0.05, theta_m + 0.05)
    brake = brake_with_one_hinged_shoe(R=r, a=a, arc=arc, moment=M, mu=mu, side=side, spin=spin)
    m, n = short_shoe_pressure_and_friction_moments_over_torque(mu, theta_m, r, a)
    # The lining lies counter-clockwise of the hinge.
    dragged_away = spin > 0
    dD = 1 if dragged_away == (side == "external") else -1
    assert sign_of_friction_moment_about_hinge(brake, brake.shoes[0]) == dD
    response = solve("short", brake)
    (shoe,), (merit,) = response.shoes, response.merits
    assert shoe.normal_force == approx(M / (mu * r * (m - dD * n)), rel=1e-12)
    assert merit.mechanical_advantage == approx(1 / (m - dD * n), rel=1e-12)
    assert merit.sensitivity_at_fixed_shape == approx(m / (m - dD * n), rel=1e-12)
    assert (merit.m, merit.n) == (approx(float(m), rel=1e-12), approx(float(n), rel=1e-12))
    assert shoe.self_energising == (dD * n > 0)


def test_two_separately_actuated_short_shoes() -> None:
    """Two separately actuated short shoes: torque, sensitivity and bearing load of the pair [D].

    The UWA notes close with an example of this kind.

    Both shoes sit opposite each other at 90 deg from their pins, a = r: then n = 1 and m = 1/mu, so
    N = M/(r (1 - dD mu)), and by hand with M_1 = 60, M_2 = 40 N m, r = 0.2 m, mu = 0.25:
    N_1 = 400 N, N_2 = 160 N, T = 0.25 * 0.2 * 560 = 28 N m; S = sum of T_i S_i over T.
    """
    shoes = []
    for name, turned, moment in (("helped", -math.pi / 2, 60.0), ("opposed", -math.pi / 2, 40.0)):
        hand = 1 if name == "helped" else -1
        shoes.append(
            brake_with_one_hinged_shoe(
                R=0.2,
                a=0.2,
                arc=(radians(88), radians(92)),
                moment=moment,
                mu=0.25,
                side="external",
                hand=hand,
                turned=turned,
            )
            .shoes[0]
            .model_copy(update={"name": name})
        )
    one = brake_with_one_hinged_shoe(
        R=0.2, a=0.2, arc=(1.0, 2.0), moment=1.0, mu=0.25, side="external"
    )
    brake = one.model_copy(update={"shoes": tuple(shoes)})
    response = solve("short", brake)
    helped, opposed = response.shoes
    assert (helped.normal_force, opposed.normal_force) == (
        approx(400.0, rel=1e-9),
        approx(160.0, rel=1e-9),
    )
    assert response.torque == approx(28.0, rel=1e-9)
    # on the drum: 400 N from the right, 160 N from the left; friction -mu s N across each
    assert response.bearing_load == approx([-400 + 160, -0.25 * 400 + 0.25 * 160], rel=1e-9)
    S = [1 / (1 - 0.25), 1 / (1 + 0.25)]
    assert picked(response.merits, "sensitivity_at_fixed_shape") == approx(S, rel=1e-9)
    pair = (20 * S[0] + 8 * S[1]) / 28
    assert torque_sensitivity_to_friction_by_differences(brake, MODELS["short"].solve) == approx(
        pair, rel=1e-6
    )


def test_nptel_external_long_shoes() -> None:
    """NPTEL lesson 12.1: F_1 l = M_p - M_f, F_2 l = M_p + M_f and T, with M_f as it must read.

    The lesson prints 1/2 mu_0 b R delta [R (cos th_1 - th_2) - ...], which is not even a moment.
    """
    p0, b, R, delta, mu, th1, th2 = 0.8e6, 0.05, 0.2, 0.23, 0.3, radians(20), radians(130)
    M_p = 0.5 * p0 * b * R * delta * ((th2 - th1) + 0.5 * (sin(2 * th1) - sin(2 * th2)))
    M_f = mu * p0 * b * R * (R * (cos(th1) - cos(th2)) - delta / 4 * (cos(2 * th1) - cos(2 * th2)))
    T = mu * p0 * b * R**2 * (cos(th1) - cos(th2))
    for spin, moment in ((1, M_p - M_f), (-1, M_p + M_f)):
        brake = brake_with_one_hinged_shoe(
            R=R, a=delta, arc=(th1, th2), moment=moment, mu=mu, side="external", spin=spin, width=b
        )
        (shoe,) = solve("sine", brake).shoes
        assert shoe.peak_pressure == approx(p0, rel=1e-12)
        assert shoe.torque == approx(T, rel=1e-12)
        assert shoe.self_energising == (spin > 0)
    # internal shoes: the same two moments with the rotations exchanged
    inside = brake_with_one_hinged_shoe(
        R=R, a=0.18, arc=(th1, th2), moment=100.0, mu=mu, side="internal", spin=1
    )
    outside = brake_with_one_hinged_shoe(
        R=R, a=0.18, arc=(th1, th2), moment=100.0, mu=mu, side="external", spin=-1
    )
    assert solve("sine", inside).torque == approx(solve("sine", outside).torque, rel=1e-12)


def test_nptel_back_stop_locks_one_way_only() -> None:
    """NPTEL lesson 12.1: mu' > x/a locks the block in one rotation, never in the other."""
    block = {
        "R": 0.125,
        "arm": 0.45,
        "x": 0.03,
        "a": 0.15,
        "P": 700.0,
        "mu": 0.35,
        "half": radians(20),
    }
    with pytest.raises(NoAnswer, match=r"self-locking, friction 0.35 is not below mu_lock = 0.19"):
        solve("block", brake_with_block_on_lever(**block, spin=1))
    assert solve("block", brake_with_block_on_lever(**block, spin=-1)).torque > 0
    # a force that lifts the locking lever off is an answer: no contact
    lifted = vary(brake_with_block_on_lever(**block, spin=1), {"shoe.actuation.force": -700.0})
    assert solve("block", lifted).torque == 0.0


def test_double_block_brake_takes_the_load_off_the_shaft() -> None:
    """NPTEL lesson 12.1: two opposite blocks take the load off the drum's shaft.

    With the pins on the lines of friction no load is left.
    """
    one = brake_with_block_on_lever(
        R=0.125, arm=0.45, x=0.2, a=0.0, P=700.0, mu=0.35, half=radians(45), spin=1
    )
    shoe = one.shoes[0]
    data = shoe.model_dump()
    data["name"] = "below"
    data["hinge"] = {"x": shoe.hinge.x, "y": -shoe.hinge.y}
    data["lining"] |= {"start": -shoe.lining.end, "end": -shoe.lining.start}
    data["actuation"] |= {"direction": math.pi / 2, "point": {"x": 0.25, "y": -0.125}}
    both = vary(one, {"shoe": [shoe.model_dump(), data]})
    single, double = solve("block", one), solve("block", both)
    assert double.torque == approx(2 * single.torque, rel=1e-12)
    assert single.bearing_load is not None
    assert double.bearing_load is not None
    assert np.linalg.norm(double.bearing_load) < 1e-12 * np.linalg.norm(single.bearing_load)


def test_pivot_off_the_middle_leaves_no_moment_about_it() -> None:
    """A pivot off the middle of the lining bears no moment [D].

    The shoe's equilibrium about G by quadrature of the response's own p, tractions written out
    here.
    """
    brake = brake_with_one_hinged_shoe(
        R=0.25,
        a=0.45,
        arc=(radians(30), radians(130)),
        moment=300.0,
        mu=0.3,
        side="external",
        pivot=(0.29, radians(84)),
    )
    (shoe,) = solve("pivoted", brake).shoes
    theta = np.linspace(shoe.theta[0], shoe.theta[-1], 20001)
    p = shoe.pressure_at(theta)
    assert p.min() > 0
    radial, across = (
        np.array([np.cos(theta), np.sin(theta)]),
        np.array([-np.sin(theta), np.cos(theta)]),
    )
    # The shoe is external and the drum turns counter-clockwise.
    traction = p * radial + 0.3 * p * across
    place = 0.25 * radial - brake.shoes[0].pivot.xy[:, None]
    moment = place[0] * traction[1] - place[1] * traction[0]
    assert abs(np.trapezoid(moment, theta)) < 1e-8 * np.trapezoid(abs(moment), theta)


def test_layouts_broadcast() -> None:
    """One law over a grid of friction and arcs is what it is for each brake by itself."""
    mu = np.linspace(0.05, 0.5, 7)[:, None]
    phi_2 = np.radians([60.0, 90.0, 130.0])
    for law in LAWS_OF_HINGED_SHOES_BY_NAME.values():
        grid = law.torque(100.0, mu, ShoeAnglesAndRadii(0.1, phi_2, 0.15, 0.125, 1))
        assert grid.shape == (7, 3)
        brake = brake_with_one_hinged_shoe(
            R=0.15, a=0.125, arc=(0.1, phi_2[1]), moment=100.0, mu=mu[3, 0], spin=-1
        )
        assert grid[3, 1] == approx(solve(law.name, brake).torque, rel=1e-12)
