"""Pads that do not fit the plane: closed forms, symmetries and refusals."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import drumlin
from drumlin.base.errors import BadInput
from drumlin.brake import off_circle
from drumlin.brake.fields import Point
from drumlin.brake.file import make_validated_brake_part, vary
from drumlin.brake.plane_brake import FlatBrake
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.error_control.singular_points import singular_points_of_each_shoe_shape
from drumlin.fem.hp.division import KindOfSingularPoint
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.laws import solve_brake_by_its_rigid_shoe_law
from drumlin.response.response import ShoeResponse
from drumlin_studies.random_kinds import (
    brake_with_scaled_lengths_and_moduli,
    mirror_turn_and_shift_brake,
)
from flat_pads import BODY, LINING, pad

LENGTH, WIDTH, E = 0.12, 0.04, 3e8
MISFIT = "shoe.lining.misfit"


def centred(
    thickness: float, force: float = 500.0, nu: float = 0.0, mu: float = 0.0, **lining: Any
) -> FlatBrake:
    """A rigid pad about x = 0 on a guide square to the plane, under a force in its middle."""
    material = {"E": E, "nu": nu}
    shoe = {
        "name": "pad",
        "guide": {"direction": -math.pi / 2},
        "lining": {
            "start": -LENGTH / 2,
            "end": LENGTH / 2,
            "width": WIDTH,
            "thickness": thickness,
            "material": material,
        }
        | lining,
        "actuation": {"force": force, "direction": -math.pi / 2, "point": {"x": 0.0, "y": 0.1}},
    }
    return make_validated_brake_part(
        FlatBrake, {"title": "t", "friction": mu, "plane": {"sliding": "+x"}, "shoe": [shoe]}
    )


def pressed(brake: FlatBrake) -> ShoeResponse:
    (shoe,) = drumlin.solve(brake, penalty=math.inf).shoes
    return shoe


@given(st.floats(0.3, 1e6), st.booleans(), st.floats(-6e-3, 6e-3), st.floats(-6e-3, 6e-3))
def test_the_gap_ends_on_the_faces_own_circle(
    radius: float, crowned: bool, x: float, y: float
) -> None:
    """The gap of a crowned or hollow face ends on the face's circle.

    Each point of the face is one radius away from the centre, which lies above a crowned and below
    a hollow face.
    """
    r, along = radius if crowned else -radius, np.linspace(-0.06, 0.06, 41)
    gap = off_circle.gaps_of_pad_ground_to_circle(r, Point(x=x, y=y), along)
    away = np.hypot(along - x, gap - (r + y))
    np.testing.assert_allclose(away, radius, rtol=1e-13)
    # The pad meets the plane in the lining's middle.
    assert off_circle.gaps_of_pad_ground_to_circle(r, Point(x=0.0, y=0.0), along)[20] == 0.0


def test_a_crowned_pad_with_a_thin_lining_is_pressed_by_a_parabola() -> None:
    """A crowned pad with a thin lining has a parabola of pressure, p = (E/t)(c^2 - x^2)/(2 r).

    Springs side by side: P = (2/3)(E/t) b c^3/r, but for an error over about t at the ends.
    """
    t, r, force = 5e-4, 50.0, 4000.0
    shoe = pressed(centred(t, force, misfit={"radius": r}))
    half = (1.5 * force * r * t / (WIDTH * E)) ** (1 / 3)
    ((start, end),) = shoe.contact_arcs
    assert -start == pytest.approx(end, rel=1e-6)
    assert 20 * t < end < LENGTH / 2
    assert end == pytest.approx(half, rel=0.02)
    x = np.linspace(-0.9, 0.9, 21) * half
    p = E / t * (half**2 - x**2) / (2 * r)
    assert np.linalg.norm(shoe.pressure_at(x) - p) < 0.02 * np.linalg.norm(p)


def test_a_crowned_pad_with_a_thick_lining_is_hertz() -> None:
    """A narrow contact feels neither the lining's back nor its ends: a^2 = 4 P r/(pi E b)."""
    r, force = 0.3, 40.0
    shoe = pressed(centred(0.06, force, misfit={"radius": r}))
    a = math.sqrt(4 * force / WIDTH * r / (math.pi * E))
    ((start, end),) = shoe.contact_arcs
    assert end - start == pytest.approx(2 * a, rel=2e-3)
    x = np.linspace(-0.95, 0.95, 21) * a
    p = 2 * force / (math.pi * a * WIDTH) * np.sqrt(1 - (x / a) ** 2)
    np.testing.assert_allclose(shoe.pressure_at(x), p, rtol=3e-3)


@pytest.mark.parametrize(("force", "arcs"), ((20.0, 2), (2e4, 1)))
@pytest.mark.parametrize("sliding", ["+x", "-x"])
def test_a_hollow_pad_rests_on_its_ends_and_closes_under_its_force(
    force, arcs, sliding: str
) -> None:
    shoe = pressed(vary(centred(1e-3, force, misfit={"radius": -50.0}), {"plane.sliding": sliding}))
    assert len(shoe.contact_arcs) == arcs
    assert (shoe.contact_arcs[0][0], shoe.contact_arcs[-1][1]) == (-LENGTH / 2, LENGTH / 2)


def test_a_tilted_rigid_pad_is_pressed_linearly() -> None:
    """A tilted rigid pad has a linear pressure, p = P/(b L) - (E/t) taper x/L.

    Springs side by side; the taper counts from the pin, which is the force's point here.
    """
    t, taper, force = 5e-4, 1e-6, 4800.0
    for sense in (1, -1):
        brake = vary(
            centred(t, force, misfit={"taper": taper}), {"shoe.actuation.point.x": -sense * 1e-3}
        )
        shoe = pressed(brake)
        x = np.linspace(-0.9, 0.9, 21) * LENGTH / 2
        p = force / (WIDTH * LENGTH) - sense * E / t * taper * x / LENGTH
        assert p.min() > 0.3 * p.max()
        assert np.linalg.norm(shoe.pressure_at(x) - p) < 3e-3 * np.linalg.norm(p)


@pytest.mark.parametrize("kind", [pytest.param("pivot", marks=pytest.mark.slow), "abutment"])
def test_a_shoe_of_two_freedoms_takes_up_taper_and_even_clearance(kind: str) -> None:
    brake = pad(kind, "-x", body=BODY)
    a = pressed(brake)
    b = pressed(vary(brake, {f"{MISFIT}.taper": 3e-4, "shoe.lining.clearance": 1e-4}))
    np.testing.assert_allclose(b.pressure_at(a.theta), a.pressure, atol=1e-6 * a.peak_pressure)
    assert b.hinge_reaction == pytest.approx(a.hinge_reaction, rel=1e-7)


def test_taper_blocks_and_offset_are_the_clearances_that_they_say() -> None:
    brake = pad("hinge", body=BODY)
    start, end = 0.06, 0.18
    for misfit, table in (
        ({"taper": 2e-6}, [[start, -1e-6], [end, 1e-6]]),
        ({"offset": {"x": 0.002, "y": 1e-6}}, 1e-6),
        (
            {"radius": 500.0, "offset": {"x": 0.003, "y": 0.0}},
            [[x, (x - 0.123) ** 2 / 1000] for x in np.linspace(start, end, 241)],
        ),
    ):
        changes = {MISFIT: misfit}, {"shoe.lining.clearance": table}
        a, b = (drumlin.solve(vary(brake, change), elements=40).shoes[0] for change in changes)
        assert b.normal_force == pytest.approx(a.normal_force, rel=1e-4)
        np.testing.assert_allclose(b.pressure, a.pressure, atol=2e-3 * a.peak_pressure)


def test_a_pad_in_blocks_bears_by_those_that_do_not_stand_back() -> None:
    """Also where a step is steep and far from the contact, which must not swing into it."""
    step, blocks = math.radians(1) * LENGTH, {"blocks": [[-0.02, 1e-3], [0.02, 0.0]]}
    first, second = drumlin.solve(centred(1e-3, misfit=blocks), elements=120).shoes[0].contact_arcs
    assert (first[0], second[1]) == (-LENGTH / 2, LENGTH / 2)
    assert -0.02 - step < first[1] < -0.02
    assert 0.02 < second[0] < 0.02 + step
    # Under this body the far end of the lining alone bears.
    brake = pad("hinge", body=BODY)
    stepped = vary(brake, {MISFIT: {"blocks": [[0.1, 1e-3], [0.14, 0.0]]}})
    (places,) = singular_points_of_each_shoe_shape(
        stepped,
        solve_prepared_model(
            make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1]), brake
        ),
    ).values()
    assert (
        sum(
            point.kind in {KindOfSingularPoint.STEP, KindOfSingularPoint.OPEN_STEP}
            for point in places
        )
        == 4
    )
    a, b = pressed(brake), pressed(stepped)
    assert b.contact_arcs[0] == pytest.approx(a.contact_arcs[0], rel=1e-3)
    assert b.normal_force == pytest.approx(a.normal_force, rel=1e-4)


@settings(max_examples=2, deadline=None)
@given(st.floats(-2, 2), st.floats(0, 2), st.sampled_from(["hinge", "guide", "abutment"]))
def test_a_wrong_pads_mirror_image_answers_alike(taper: float, crown: float, kind: str) -> None:
    brake = pad(kind, "-x", body=BODY)
    misfit = {
        "taper": 1e-6 * taper,
        "radius": 0.12**2 / (8e-6 * (0.1 + crown)),
        "offset": {"x": 4e-3, "y": 1e-6},
    }
    rows = [[0.06, 1e-6], [0.1, 0.0], [0.18, 2e-6]]
    brake = vary(brake, {MISFIT: misfit, "shoe.lining.clearance": rows})
    (a,) = drumlin.solve(brake, elements=20).shoes
    (b,) = drumlin.solve(mirror_turn_and_shift_brake(brake, mirrored=True), elements=20).shoes
    np.testing.assert_allclose(b.pressure_at(-a.theta), a.pressure, atol=1e-7 * a.peak_pressure)
    (c,) = drumlin.solve(mirror_turn_and_shift_brake(brake, shift=0.7), elements=20).shoes
    np.testing.assert_allclose(
        c.pressure_at(a.theta + 0.7), a.pressure, atol=1e-7 * a.peak_pressure
    )
    (d,) = drumlin.solve(brake_with_scaled_lengths_and_moduli(brake, 3.0, 2.0), elements=20).shoes
    np.testing.assert_allclose(
        d.pressure_at(3 * a.theta), 2 * a.pressure, atol=1e-7 * d.peak_pressure
    )


@pytest.mark.parametrize(
    ("lining", "said"),
    [
        (
            {"misfit": {"radius": 0.1}},
            "misfit.radius = 100 mm: must be at least 300 mm either way, 2.5 times",
        ),
        ({"misfit": {"radius": 0.0}}, "misfit.radius = 0 mm: must be at least 300 mm"),
        (
            {"misfit": {"taper": 0.01}},
            "misfit.taper = 10 mm: must be at most 0.05 of the lining's length, 6 mm",
        ),
        (
            {"misfit": {"offset": {"x": 0.0, "y": -0.01}}},
            "misfit.offset = 10 mm: must be at most 0.05",
        ),
        (
            {"misfit": {"blocks": [[0.061, 1e-4]]}},
            "misfit.blocks at 61 mm: must begin on the lining, 60 mm to 180 mm, more",
        ),
        ({"misfit": 3}, "misfit = 3: must be a table with keys of radius, offset, taper, blocks"),
        (
            {"misfit": {"coning": 1e-4}},
            "unknown key 'coning'.*allowed: radius, offset, taper, blocks",
        ),
        ({"clearance": [[0.1, 0.0]]}, "the table needs at least two rows, with growing places"),
        (
            {"clearance": [[0.1, 0.0], [0.1, 0.0]]},
            "the table needs growing places, not 0.1 after 0.1",
        ),
    ],
)
def test_what_is_no_small_misfit_is_refused_in_one_line(lining: dict[str, Any], said: str) -> None:
    with pytest.raises(BadInput, match=said) as refusal:
        pad("hinge", lining=LINING | {"start": 0.06, "end": 0.18} | lining)
    assert "\n" not in str(refusal.value)


def test_laws_of_planes_say_that_they_are_those_of_a_lining_that_fits() -> None:
    brake = vary(pad("hinge"), {f"{MISFIT}.taper": 1e-5})
    for model in ("linear", "short"):
        found, fits = drumlin.solve(brake, model), drumlin.solve(pad("hinge"), model)
        assert any("clearance and misfit" in line and "plane" in line for line in found.left_out)
        assert found.shoes[0].normal_force == fits.shoes[0].normal_force


@pytest.mark.slow
def test_a_wrong_pad_wears_to_the_law() -> None:
    """Worn in, nothing is left of a misfit."""
    brake = vary(pad("pivot", body=BODY), {MISFIT: {"radius": 100.0, "taper": 2e-5}})
    found, goal = (
        drumlin.solve(brake, worn_in=True).shoes[0],
        solve_brake_by_its_rigid_shoe_law(brake).shoes[0],
    )
    x = np.linspace(0.06, 0.18, 41)
    np.testing.assert_allclose(
        found.pressure_at(x), goal.pressure_at(x), atol=2e-3 * goal.peak_pressure
    )
