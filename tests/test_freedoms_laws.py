"""The rigid-shoe law for every support and load: closed forms, special cases, symmetries."""

import math
from math import atan, cos, pi, radians, sin
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from pytest import approx

import drumlin
from drumlin import BadInput, Brake, NoAnswer
from drumlin.brake.file import make_drum_brake_from_data, make_validated_brake_part, vary
from drumlin.brake.plane_brake import FlatBrake, read_drum_or_plane_brake
from drumlin.laws import LAWS_OF_HINGED_SHOES_BY_NAME, rigid, solve_brake_by_its_rigid_shoe_law
from drumlin.laws.hinged import angles_and_radii_of_hinged_shoe
from drumlin.laws.shapes import ratio_of_equivalent_to_lining_friction
from drumlin.models import MODELS, applicable_models
from drumlin.response.balance import brake_with_forces_of_response, resultant_of_contact_on_shoe
from drumlin.response.response import Response, ShoeResponse
from picking import having, picked
from shared_parts import of_shoes

many = settings(suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much])
SIGNS = st.sampled_from([1, -1])
LINING = {"thickness": 0.005, "width": 0.04, "material": {"E": 3e8, "nu": 0.25}}
# The dimensions are those of the closed form's example.
R, F, C, A, OFF = 0.11, 1000.0, 0.08, 0.08, 0.025


def abutted(
    mu: float,
    spin: int,
    m: float,
    friction: float = 0.0,
    arc: float = radians(110),
    at: float = 0.05,
    off: float = OFF,
) -> Any:
    return {
        "name": "first",
        "side": "internal",
        "abutment": {"point": {"x": off, "y": -A}, "direction": atan(m), "friction": friction},
        "lining": LINING | {"start": at - arc / 2, "end": at + arc / 2},
        "actuation": {"force": F, "direction": 0.0, "point": {"x": 0.02, "y": C}},
    }


def brake_of(*shoes: dict[str, Any], mu: float = 0.3, spin: int = -1, **more: Any) -> Brake:
    rotation = "counter-clockwise" if spin > 0 else "clockwise"
    data = {
        "title": "t",
        "rotation": rotation,
        "friction": mu,
        "drum": {"radius": R},
        "shoe": list(shoes),
    }
    return make_drum_brake_from_data(data | more)


def limpert(
    mu: float, lead: int, m: float, arc: float = radians(110), be: float = 0.05, off: float = OFF
) -> float:
    """Brake factor T/(r F) of a shoe on an abutment (Limpert, Brake Design and Safety).

    The upper signs are those of the leading shoe.
    """
    D = (C + A + m * off) / R * cos(be) + m * C / R * sin(be)
    E = m * C / R * cos(be) - (C + A + m * off) / R * sin(be)
    f = (arc + sin(arc)) / (4 * sin(arc / 2)) * (A + m * off) / R
    G, H = cos(be) + m * sin(be), f - (m * cos(be) - sin(be))
    return (mu * D + lead * mu**2 * E) / (f - lead * mu * G + mu**2 * H)


@pytest.mark.parametrize(("spin", "factor"), [(-1, 1.3888340858866), (1, 0.4747431137095)])
def test_an_abutted_shoe_is_the_closed_form(spin: int, factor: float) -> None:
    """All of the lining bearing, tension at its end included, as the closed form has it."""
    brake = brake_of(abutted(0.35, spin, 0.2), mu=0.35, spin=spin)
    assert limpert(0.35, -spin, 0.2) == approx(factor, rel=1e-12)
    assert rigid.solve_brake_by_rigid_shoe_law(brake, whole=True).torque / (R * F) == approx(
        factor, rel=1e-12
    )


@many
@given(
    st.floats(0.05, 0.45), SIGNS, st.floats(-0.2, 0.4), st.floats(1.0, 2.0), st.floats(-0.1, 0.15)
)
def test_abutted_shoes_of_all_kinds_are_the_closed_form(
    mu: float, spin: int, m: float, arc: float, at: float
) -> None:
    brake = brake_of(abutted(mu, spin, m, arc=arc, at=at), mu=mu, spin=spin)
    factor = limpert(mu, -spin, m, arc, at)
    assume(rigid.self_locking_friction_of_rigid_shoe(brake, brake.shoes[0]) > 1.05 * mu)
    assert rigid.solve_brake_by_rigid_shoe_law(brake, whole=True).torque / (R * F) == approx(
        factor, rel=1e-9
    )


@pytest.mark.parametrize(("spin", "m"), ((-1, 0.2), (1, -0.2)))
def test_friction_of_an_abutment_opposes_the_slide_that_it_finds(spin, m) -> None:
    """An abutment's friction opposes the slide of the foot that the law itself finds.

    A leading shoe slides with the drum, so that mu_s acts as the slope does; a trailing one slides
    the other way.
    """
    rough, sloped = (
        brake_of(abutted(0.35, spin, *s), mu=0.35, spin=spin) for s in ((0.0, 0.2), (m, 0.0))
    )
    assert rigid.solve_brake_by_rigid_shoe_law(rough).torque == approx(
        rigid.solve_brake_by_rigid_shoe_law(sloped).torque, rel=1e-12
    )


def test_a_foot_that_sticks_is_a_hinge() -> None:
    """A foot that sticks to a rough abutment acts as a hinge.

    The sine law about the foot holds, with a reaction inside the cone of friction.
    """
    brake = brake_of(abutted(0.3, -1, 0.0, friction=2.0), mu=0.3)
    hinge = vary(brake, {"shoe.abutment": None, "shoe.hinge": {"x": OFF, "y": -A}})
    assert solve_brake_by_its_rigid_shoe_law(brake).torque == approx(
        MODELS["sine"].solve(hinge).torque, rel=1e-10
    )
    x, y = solve_brake_by_its_rigid_shoe_law(brake).shoes[0].hinge_reaction
    assert abs(y) <= 2.0 * x


def secondary(hx: float, hy: float) -> dict[str, Any]:
    """The secondary shoe of a duo-servo brake, hinged at the top.

    Its lining covers 20 to 130 deg from the strut's end.
    """
    lining = LINING | {"start": radians(-90 - 130), "end": radians(-90 - 20)}
    return {"name": "second", "side": "internal", "hinge": {"x": hx, "y": hy}, "lining": lining}


def hinged_factor(mu: float, h: float, a: float, phi_1: float, phi_2: float) -> float:
    """T/(r F) of a leading hinged shoe, F at the arm h: the textbooks' integrals."""
    Is, Isc = cos(phi_1) - cos(phi_2), (cos(2 * phi_1) - cos(2 * phi_2)) / 4
    Iss = (phi_2 - phi_1) / 2 - (sin(2 * phi_2) - sin(2 * phi_1)) / 4
    return mu * Is * h / (a * Iss - mu * (R * Is - a * Isc))


@pytest.mark.parametrize("m", (0.0, 0.2))
def test_duo_servo_is_the_closed_form(m) -> None:
    """A duo-servo brake has the closed-form factor B = B1 + B2 (c + B1 r)/a of a level strut.

    With a slope m of the abutment the equilibria give (c + B1 r)/(a + m o).

    The strut is a two-force member: its line meets the secondary at the arm 2 a + m o about a hinge
    at (0, a).
    """
    brake = brake_of(
        abutted(0.3, -1, m), secondary(0.0, A), link=[{"from": "first", "to": "second"}]
    )
    B1, B2 = limpert(0.3, 1, m), hinged_factor(0.3, 2 * A, A, radians(50), radians(160))
    strut = (C + B1 * R) / (A + m * OFF)
    expected = B1 + B2 * strut * (2 * A + m * OFF) / (2 * A)
    response = rigid.solve_brake_by_rigid_shoe_law(brake, whole=True)
    assert response.torque / (R * F) == approx(expected, rel=1e-9)
    assert response.shoes[1].force == approx(strut * F * math.hypot(1, m), rel=1e-9)
    as_it_is = rigid.solve_brake_by_rigid_shoe_law(brake)
    assert max(as_it_is.balance.force, as_it_is.balance.moment) < 1e-9


def test_duo_servo_by_the_short_formula() -> None:
    """The short formula of a duo-servo brake is exact without a slope or with an offset of zero.

    B = B1 + B2 (c + B1 r)/a neglects that a slope m lifts the foot at o.
    """
    B2 = hinged_factor(0.3, 2 * A, A, radians(50), radians(160))

    def short(m: float, off: float) -> float:
        B1 = limpert(0.3, 1, m, off=off)
        return B1 + B2 * (C + B1 * R) / A

    assert short(0.2, OFF) == approx(4.7856859083271, rel=1e-12)
    for m, off in ((0.0, OFF), (0.2, 0.0)):
        first = abutted(0.3, -1, m, off=off)
        brake = brake_of(first, secondary(0.0, A), link=[{"from": "first", "to": "second"}])
        assert rigid.solve_brake_by_rigid_shoe_law(brake, whole=True).torque / (R * F) == approx(
            short(m, off), rel=1e-9
        )
    inclined = brake_of(
        abutted(0.3, -1, 0.2), secondary(0.0, A), link=[{"from": "first", "to": "second"}]
    )
    assert rigid.solve_brake_by_rigid_shoe_law(inclined, whole=True).torque / (R * F) == approx(
        short(0.2, OFF), rel=0.05
    )


def cam_brake(mu: float, spin: int, **actuation: Any) -> Brake:
    """Two hinged shoes, mirror images, under an S-cam at the top."""
    shoes = [
        {
            "name": name,
            "side": "internal",
            "hinge": {"x": hand * 0.03, "y": -0.09},
            "lining": LINING | {"start": middle - 0.9, "end": middle + 0.9},
            "actuation": {
                "direction": 0.0 if hand > 0 else pi,
                "point": {"x": hand * 0.02, "y": 0.085},
            },
        }
        for name, hand, middle in (("right", 1, 0.0), ("left", -1, pi))
    ]
    return brake_of(*shoes, mu=mu, spin=spin, actuation=actuation or {"force": 2000.0})


@many
@given(st.floats(0.05, 0.5), SIGNS)
def test_a_cam_that_moves_both_tips_equally_has_the_closed_form(mu: float, spin: int) -> None:
    """F1 B1 = F2 B2, and the brake factor 4 B1 B2/(B1 + B2) over half of the sum of both forces."""
    brake = cam_brake(mu, spin)
    response = solve_brake_by_its_rigid_shoe_law(brake)
    B = [
        solve_brake_by_its_rigid_shoe_law(
            vary(brake, {"actuation": None, "shoe.actuation.force": F})
        )
        .shoes[i]
        .torque
        / (R * F)
        for i in (0, 1)
    ]
    forces = picked(response.shoes, "force")
    assert sum(forces) == approx(2000.0, rel=1e-12)
    assert forces[0] * B[0] == approx(forces[1] * B[1], rel=1e-9)
    assert response.torque / (R * 1000.0) == approx(4 * B[0] * B[1] / (B[0] + B[1]), rel=1e-9)
    by_torque = solve_brake_by_its_rigid_shoe_law(
        cam_brake(mu, spin, torque=50.0, radius=0.02, efficiency=0.8)
    )
    assert by_torque.torque == approx(response.torque, rel=1e-12)


def test_a_cam_on_linings_of_unlike_stiffness_says_how_it_shares_its_force() -> None:
    """A cam on linings of unlike stiffness says how it shares its force between the shoes.

    New linings share by F1 B1 t1/E1 = F2 B2 t2/E2, worn-in ones by F1 B1 = F2 B2: the tip of a
    rigid shoe moves by p t/E when new and by the wear later.
    """
    brake = vary(cam_brake(0.3, -1), {"shoe.lining.thickness": 3e-4})
    unlike = vary(brake, {"shoe[1].lining.material.E": 1e8})
    B = [
        solve_brake_by_its_rigid_shoe_law(
            vary(brake, {"actuation": None, "shoe.actuation.force": F})
        )
        .shoes[i]
        .torque
        for i in (0, 1)
    ]
    for one, stiff in ((brake, 1.0), (unlike, 3.0)):
        for model, ratio in (("rigid", 1.0), ("fem", stiff)):
            found = MODELS[model].solve(one)
            first, second = (shoe.force or 0.0 for shoe in found.shoes)
            assert first * B[0] == approx(
                ratio * second * B[1], rel=1e-9 if model == "rigid" else 1e-2
            )
            said = [
                note
                for note in found.notes
                if note.startswith("cam: linings of unlike E/t, 1e+12 and 3.33e+11 Pa")
            ]
            assert len(said) == (one is unlike)


def test_a_cylinder_pushes_both_shoes_with_its_pressure() -> None:
    brake = cam_brake(0.3, 1, pressure=5e6, diameter=0.02, efficiency=0.96)
    assert picked(brake.shoes, "actuation.force") == approx([0.96 * 5e6 * pi * 0.02**2 / 4] * 2)
    doubled = vary(brake, {"actuation.pressure": 1e7})
    assert MODELS["sine"].solve(doubled).torque == approx(
        2 * MODELS["sine"].solve(brake).torque, rel=1e-12
    )


# the special cases


@pytest.mark.parametrize("spin", (1, -1))
def test_the_law_of_a_hinge_is_the_sine_law_and_that_of_a_guide_the_cosine(spin) -> None:
    brake = vary(cam_brake(0.3, spin), {"actuation": None, "shoe.actuation.force": F})
    sine, own = MODELS["sine"].solve(brake), rigid.solve_brake_by_rigid_shoe_law(brake)
    for a, b in zip(own.shoes, sine.shoes, strict=True):
        assert a.torque == approx(b.torque, rel=1e-12)
        assert a.peak_pressure == approx(b.peak_pressure, rel=1e-12)
        np.testing.assert_allclose(a.hinge_reaction, b.hinge_reaction, rtol=1e-10)
    guided = vary(
        brake,
        {"shoe.hinge": None} | of_shoes("guide", [{"direction": 0.0}, {"direction": pi}]),
    )
    shoe = solve_brake_by_its_rigid_shoe_law(guided).shoes[0]
    # The friction acts across the guide and does not change the normal force.
    N = F
    assert shoe.torque == approx(
        0.3 * float(ratio_of_equivalent_to_lining_friction(0.9)) * N * R, rel=1e-12
    )
    assert shoe.pressure == approx(shoe.peak_pressure * np.cos(shoe.theta), rel=1e-12)


def test_a_lining_that_reaches_past_its_hinge_lifts_there() -> None:
    brake = brake_of(abutted(0.3, -1, 0.0))
    brake = vary(brake, {"shoe.abutment": None, "shoe.hinge": {"radius": 0.09, "angle": -0.5}})
    assert "within 0 to 180 deg" in str(MODELS["sine"].why_not(brake))
    shoe = solve_brake_by_its_rigid_shoe_law(brake).shoes[0]
    assert shoe.contact_arcs[0][0] == approx(-0.5, abs=1e-12)
    cut = vary(brake, {"shoe.lining.start": -0.5})
    assert shoe.torque == approx(MODELS["sine"].solve(cut).torque, rel=1e-9)


def plane(
    held: dict[str, Any], mu: float = 0.35, sliding: str = "+x", **actuation: Any
) -> FlatBrake:
    shoe = {
        "name": "pad",
        "lining": {"start": 0.06, "end": 0.18, "width": 0.04},
        "actuation": {"force": 500.0, "direction": -pi / 2, "point": {"x": 0.25, "y": 0.06}}
        | actuation,
    } | held
    return make_validated_brake_part(
        FlatBrake, {"title": "t", "friction": mu, "plane": {"sliding": sliding}, "shoe": [shoe]}
    )


def test_on_a_plane_a_guide_makes_p_even_and_a_pivot_balances_about_itself() -> None:
    guided = solve_brake_by_its_rigid_shoe_law(plane({"guide": {"direction": -pi / 2}})).shoes[0]
    assert guided.pressure == approx(np.full(3, 500 / (0.12 * 0.04)), rel=1e-12)
    for sliding, spin in (("+x", 1), ("-x", -1)):
        brake = plane(
            {"hinge": {"x": 0.0, "y": 0.1}, "pivot": {"x": 0.12, "y": 0.02}}, sliding=sliding
        )
        shoe = solve_brake_by_its_rigid_shoe_law(brake).shoes[0]
        x = np.linspace(0.06, 0.18, 4001)
        p = shoe.pressure_at(x)
        about = np.trapezoid(p * ((x - 0.12) + 0.35 * spin * 0.02), x)
        assert abs(about) < 1e-6 * np.trapezoid(p * abs(x - 0.12), x)
        assert approx(0.04 * np.trapezoid(p * (x + 0.35 * spin * 0.1), x), rel=1e-6) == 500 * 0.25


# all kinds


def kinds(draw: Any, mu: float, spin: int) -> Brake:
    """A brake of any kind."""
    kind = draw(
        st.sampled_from(
            ["abutment", "rough", "pivot", "guide", "cam", "servo", "plane guide", "plane pivot"]
        )
    )
    m, at, half = (
        draw(st.floats(-0.2, 0.3)),
        draw(st.floats(-0.15, 0.15)),
        draw(st.floats(0.3, 0.9)),
    )
    one = abutted(mu, spin, m, arc=2 * half, at=at)
    if kind == "cam":
        return cam_brake(mu, spin)
    if kind == "servo":
        return brake_of(
            one, secondary(0.0, A), mu=mu, spin=spin, link=[{"from": "first", "to": "second"}]
        )
    if kind == "plane guide":
        return plane({"guide": {"direction": -pi / 2 + m}}, mu, "+x" if spin > 0 else "-x")
    if kind == "plane pivot":
        return plane(
            {"hinge": {"x": 0.0, "y": 0.1}, "pivot": {"x": 0.12 + 0.05 * m, "y": 0.02}}, mu
        )
    if kind == "rough":
        one["abutment"]["friction"] = draw(st.floats(0.05, 0.4))
    if kind in {"pivot", "guide"}:
        del one["abutment"]
    if kind == "pivot":
        reach = float(ratio_of_equivalent_to_lining_friction(half)) * draw(st.floats(0.9, 1.1))
        one |= {
            "hinge": {"x": 0.03, "y": -0.2},
            "pivot": {"radius": R * reach, "angle": at + 0.1 * m},
        }
    if kind == "guide":
        one |= {"guide": {"direction": m}}
    return brake_of(one, mu=mu, spin=spin)


@st.composite
def brakes(draw: st.DrawFn) -> Brake:
    return kinds(draw, draw(st.floats(0.0, 0.4)), draw(SIGNS))


def answered(brake: Brake) -> Response:
    try:
        return solve_brake_by_its_rigid_shoe_law(brake)
    except NoAnswer:
        assume(False)
        raise


@many
@given(brakes())
def test_forces_moments_and_what_holds_the_shoe_balance(brake: Brake) -> None:
    response = answered(brake)
    assert max(response.balance.force, response.balance.moment) < 1e-9
    under = brake_with_forces_of_response(brake, response)
    for i, (data, shoe) in enumerate(zip(under.shoes, response.shoes, strict=True)):
        assert shoe.pressure.min() >= 0
        size = np.linalg.norm(shoe.hinge_reaction) + abs(data.actuation.force)
        x, y = shoe.hinge_reaction
        # A guide bears no force along itself.
        if data.guide is not None:
            assert abs(x * cos(data.guide.direction) + y * sin(data.guide.direction)) < 1e-9 * size
        if data.abutment is not None:
            c, s = cos(data.abutment.direction), sin(data.abutment.direction)
            assert abs(-s * x + c * y) <= data.abutment.friction * (c * x + s * y) + 1e-9 * size
        if data.pivot is not None and not under.surface.is_plane_and_not_drum:
            force, g = resultant_of_contact_on_shoe(under, i, shoe), data.pivot.xy
            assert (
                abs(force.moment - (g[0] * force.force[1] - g[1] * force.force[0]))
                < 1e-7 * size * R
            )
    for link in under.links:
        source, to = (having(response.shoes, name=name)[0] for name in (link.source, link.to))
        assert np.linalg.norm(source.hinge_reaction) == approx(to.force, rel=1e-12)


def mirrored(brake: Brake) -> Brake:
    """The mirror image about the y axis, from the data itself."""
    data = brake.model_dump(by_alias=True)
    if "rotation" in data:
        data["rotation"] = {"clockwise": "counter-clockwise", "counter-clockwise": "clockwise"}[
            data["rotation"]
        ]
    else:
        data["plane"] = {"sliding": {"+x": "-x", "-x": "+x"}[data["plane"]["sliding"]]}
    flat = isinstance(brake, FlatBrake)
    for shoe in data["shoe"]:
        for key in ("hinge", "pivot"):
            if shoe[key]:
                shoe[key] |= {"x": -shoe[key]["x"]}
        for part in (shoe["abutment"], shoe["guide"], shoe["actuation"]):
            if part:
                part["direction"] = pi - part["direction"]
                if "point" in part:
                    part["point"] |= {"x": -part["point"]["x"]}
        ends = shoe["lining"]["start"], shoe["lining"]["end"]
        shoe["lining"] |= dict(
            zip(("end", "start"), ((0 if flat else pi) - x for x in ends), strict=True)
        )
    return make_validated_brake_part(type(brake), data)


def same(a: ShoeResponse, b: ShoeResponse, size: float = 1.0) -> None:
    assert b.torque == approx(a.torque * size, rel=1e-8, abs=1e-9)
    assert b.normal_force == approx(a.normal_force * size, rel=1e-8)
    assert b.peak_pressure == approx(a.peak_pressure * size, rel=1e-8)
    assert b.self_energising == a.self_energising


@many
@given(brakes(), st.floats(0.1, 10.0))
def test_mirror_images_and_scaled_forces_answer_alike(brake: Brake, size: float) -> None:
    response = answered(brake)
    for a, b in zip(
        response.shoes, solve_brake_by_its_rigid_shoe_law(mirrored(brake)).shoes, strict=True
    ):
        same(a, b)
        np.testing.assert_allclose(
            b.pressure[::-1], a.pressure, rtol=1e-7, atol=1e-9 * a.peak_pressure
        )
    drive = brake.actuation is not None
    # A strut gives its force to the shoe that it pushes.
    own = {shoe.name: shoe.actuation.force * size for shoe in brake.shoes if shoe.actuation.force}
    changes = {f"shoe.{name}.actuation.force": force for name, force in own.items()}
    more = vary(brake, {"actuation.force": 2000.0 * size} if drive else changes)
    for a, b in zip(response.shoes, solve_brake_by_its_rigid_shoe_law(more).shoes, strict=True):
        same(a, b, size)


@many
@given(brakes())
def test_torque_grows_without_bound_towards_locking(brake: Brake) -> None:
    """On the part of the lining that presses near the limit; beyond it there is no number."""
    shoe = brake.shoes[0]
    assume(len(brake.shoes) == 1 and not (shoe.abutment and shoe.abutment.friction))
    mu_lock = rigid.self_locking_friction_of_rigid_shoe(brake, shoe)
    assume(mu_lock < 5 and not brake.surface.is_plane_and_not_drum)
    free = shoe.rigid_body_modes_of_support()
    face, ends = (
        rigid.friction_surface_of_shoe(brake, shoe),
        ((shoe.lining.start, shoe.lining.end),),
    )
    N, G = rigid.equilibrium_matrices_of_rigid_shoe(face, free, 1.0, ends)
    assert abs(np.linalg.det((N - mu_lock * brake.sign_of_motion * G) / np.abs(N).max())) < 1e-9
    with pytest.raises(NoAnswer):
        solve_brake_by_its_rigid_shoe_law(vary(brake, {"friction": mu_lock * 1.001}))


def test_every_brake_has_the_rigid_law_under_exactly_one_name(root: Any) -> None:
    names = {"sine", "pivoted", "linear", "rigid"}
    for brake in (
        cam_brake(0.3, 1),
        brake_of(abutted(0.3, 1, 0.1)),
        read_drum_or_plane_brake(root / "studies/laws/pad.toml"),
    ):
        assert len(names & set(picked(applicable_models(brake), "name"))) == 1
    one = vary(cam_brake(0.3, 1), {"actuation": None, "shoe.actuation.force": F})
    assert solve_brake_by_its_rigid_shoe_law(one).model == "sine"
    assert solve_brake_by_its_rigid_shoe_law(one).torque == approx(
        float(MODELS["sine"].solve(one).torque), rel=1e-12
    )
    assert LAWS_OF_HINGED_SHOES_BY_NAME["sine"].self_locking_friction(
        angles_and_radii_of_hinged_shoe(one, one.shoes[0])
    ) == approx(rigid.self_locking_friction_of_rigid_shoe(one, one.shoes[0]), rel=1e-9)


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        (
            {"hinge": None},
            "hinge: is missing; a shoe is held by one of hinge, hinge and pivot, abutment, guide",
        ),
        (
            {"guide": {"direction": 0.0}},
            "guide: a shoe is held by one of hinge, abutment, guide, not by hinge and guide",
        ),
        (
            {"hinge": None, "guide": {"direction": pi}},
            "guide.direction = 180 deg: must lead the middle of the lining",
        ),
        (
            {"hinge": None, "pivot": {"x": 0.1, "y": 0}, "guide": {"direction": 0.0}},
            "whose pin is the hinge",
        ),
        (
            {"actuation": {"direction": 0.0, "point": {"x": 0.02, "y": 0.08}}},
            "shoe[0].actuation.force: is missing",
        ),
    ],
)
def test_misuse_is_refused_in_one_line(changes: dict[str, Any], line: str) -> None:
    shoe = abutted(0.3, 1, 0.0)
    del shoe["abutment"]
    with pytest.raises(BadInput) as refusal:
        brake_of(shoe | {"hinge": {"x": OFF, "y": -A}} | changes)
    assert line in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("name", "key", "line"),
    [
        ("simplex_hinged", "shoe.actuation.force", "[actuation] gives it; change actuation.pre"),
        ("simplex_hinged", "shoe.left.actuation.force", "[actuation] gives it; change actuation.p"),
        ("s_cam", "shoe[1].actuation.force", "[actuation] gives it; change actuation.torque"),
        ("uni_servo", "shoe[1].actuation.force", "[actuation] gives it; change actuation.pressure"),
    ],
)
def test_a_shoe_force_that_a_drive_gives_is_no_key_to_vary(name: str, key: str, line: str) -> None:
    """Without the refusal such a sweep has the same results at all forces."""
    brake = drumlin.example(name)
    for question in (
        lambda: vary(brake, {key: "5 kN"}),
        lambda: drumlin.size(brake, key, torque=900.0, model="rigid", low=1e3, high=1e4),
        lambda: drumlin.sweep(brake, {key: [4000.0, 5000.0]}, model="rigid"),
    ):
        with pytest.raises(BadInput) as refusal:
            question()
        assert f"{key}: has no effect, {line}" in str(refusal.value)


def test_a_shoe_force_that_a_strut_gives_is_no_key_to_vary() -> None:
    brake = drumlin.example("uni_servo")
    without = vary(brake, {"actuation": None, "shoe.primary.actuation.force": F})
    line = "a strut pushes this shoe; change shoe.primary.actuation.force"
    with pytest.raises(BadInput) as refusal:
        vary(without, {"shoe.secondary.actuation.force": F})
    assert str(refusal.value) == f"shoe.secondary.actuation.force: has no effect, {line}"
    # All shoes together include the one with a force of its own.
    assert vary(without, {"shoe.actuation.force": 2 * F}).shoes[0].actuation.force == 2 * F
    # A shoe has a force of its own as soon as the drive is gone.
    simplex = drumlin.example("simplex_hinged")
    freed = vary(simplex, {"actuation": None, "shoe.actuation.force": F})
    assert [shoe.actuation.force for shoe in freed.shoes] == [F, F]


def test_misuse_of_what_pushes_the_shoes_is_refused_in_one_line() -> None:
    one, two = abutted(0.3, -1, 0.0), secondary(0.0, A)
    pushed = two | {"actuation": one["actuation"]}
    for shoes, more, line in (
        (
            (one, pushed),
            {"link": [{"from": "first", "to": "third"}]},
            "link[0].to = 'third': must be the name of a shoe",
        ),
        (
            (one, pushed),
            {"link": [{"from": "second", "to": "first"}]},
            "must bear on the strut by an abutment",
        ),
        ((one, two), {}, "shoe[1].actuation: is missing"),
        ((one,), {"actuation": {"force": 1.0}}, "a cam moves two shoes, not 1"),
        (
            (one, pushed),
            {"actuation": {"force": 1.0, "radius": 0.01}},
            "needs pressure and diameter of a cylinder",
        ),
    ):
        with pytest.raises(BadInput) as refusal:
            brake_of(*shoes, **more)
        assert line in str(refusal.value)
