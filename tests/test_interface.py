"""The weak coupling on the arc: resultants, areas, balance and patch, on meshes fine and coarse."""

import math

import numpy as np
import pytest

import pair
from drumlin.brake.file import vary
from drumlin.contact import active_set
from drumlin.fem.assembly import prepare
from drumlin.fem.ring import couple_ring
from drumlin.response.resultants import cross, integrate, resultant


@pytest.fixture(scope="module", params=[3, 10, 80])
def body(request, brake):
    return prepare(brake, elements=request.param).bodies[0]


@pytest.fixture(scope="module")
def brake():
    from conftest import STUDY
    from drumlin.brake.file import read_brake

    return read_brake(STUDY / "brake.toml")


def test_the_contact_line_is_the_lining_from_end_to_end(body, brake):
    line = body.line
    assert (np.diff(line.phi) > 0).all()
    assert (line.phi[0], line.phi[-1]) == pytest.approx(brake.shoes[0].arc, rel=1e-12)
    assert np.hypot(*line.xy) == pytest.approx(brake.drum.radius, rel=1e-14)
    assert line.pieces[-1, :-1] == pytest.approx(line.pieces[0, 1:])


def test_area_and_lever_are_those_of_the_arc(body, brake):
    shoe = brake.shoes[0]
    phi_1, phi_2 = shoe.arc
    area = shoe.lining.width * brake.drum.radius * (phi_2 - phi_1)
    tolerance = 0.02 * ((phi_2 - phi_1) / body.line.pieces.shape[1]) ** 4 + 1e-12
    assert body.coupling.area.sum() == pytest.approx(area, rel=tolerance)
    assert body.coupling.lever.sum() == pytest.approx(area * brake.drum.radius, rel=tolerance)


def test_normal_pressure_has_no_moment_about_the_centre_and_drag_has_the_torque(body):
    rng = np.random.default_rng(1)
    p = rng.random(len(body.line.nodes))
    normal = (body.coupling.N.T @ p).reshape(-1, 2)
    drag = (body.coupling.T.T @ p).reshape(-1, 2)
    torque = float(body.coupling.lever @ p)
    assert float(cross(body.line.xy.T, drag).sum()) == pytest.approx(torque, rel=1e-13)
    assert abs(float(cross(body.line.xy.T, normal).sum())) < 1e-13 * torque


def test_nodal_forces_have_the_resultant_of_the_traction(brake):
    """Against an integration over the exact arc that knows nothing of the mesh: they differ by its chord error."""
    shoe = brake.shoes[0]
    body = prepare(brake, elements=80).bodies[0]
    phi = body.line.phi
    p = 1e6 * np.sin(phi)
    force = (-body.coupling.N.T @ p + 0.3 * body.coupling.T.T @ p).reshape(-1, 2).sum(axis=0)
    exact = resultant(phi, p, order=2, radius=brake.drum.radius, width=shoe.lining.width, sign=1, drag=0.3)
    assert force == pytest.approx(exact.force, rel=1e-7)


@pytest.mark.parametrize("sign", [1, -1])
def test_patch_test_on_the_arc(sign):
    """Ring pressed into ring by an interference, on meshes that do not match: the even pressure of Lame.

    Even to the error of the arcs, which falls with more than the second power of the element; forces and moment on both
    rings balance to round-off. The pressure is carried by the inner ring (sign 1) or by the outer one.
    """
    interference, exact, spreads, means = 1e-4, lame_interference(1e-4), [], []
    for inside, outside in ((24, 30), (48, 60), (96, 120)):
        rings = [
            pair.body(pair.closed(angles, np.linspace(0, 0.4, depth), 1.0, way), pair.STEEL)
            for angles, depth, way in ((circle(inside), 5, -1), (circle(outside) + 0.01, 6, 1))
        ]
        both = pair.Pair.of(*rings[::sign], sign=sign)
        found = active_set.solve(both.normal(np.full(len(both.angle), -interference)))
        spreads.append(np.ptp(found.p) / exact)
        means.append(abs(found.p.mean() / exact - 1))
        mine, other = rings[::sign]
        for ours, theirs in zip(
            (both.coupling.N, both.coupling.T), couple_ring(mine.line, other.line, 1.0, sign), strict=True
        ):
            a, b = ((M.T @ found.p).reshape(-1, 2) for M in (ours, theirs))
            scale = np.abs(a).sum()
            assert b.sum(axis=0) == pytest.approx(a.sum(axis=0), abs=1e-13 * scale)
            moments = [float(cross(line.xy.T, f).sum()) for line, f in ((mine.line, a), (other.line, b))]
            assert moments[1] == pytest.approx(moments[0], abs=1e-13 * scale)
    assert spreads[0] > 4 * spreads[1] > 16 * spreads[2]
    assert spreads[2] < 5e-6
    assert max(means) < 5e-5 and means[2] < 5e-6


def circle(count):
    return np.linspace(-math.pi, math.pi, count + 1)[:-1]


def lame_interference(interference):
    """Pressure between rings of R = 1 held at r = 0.6 and r = 1.4, plane stress: u = A r + B/r, u = 0 where held."""
    E, nu = pair.STEEL.E, pair.STEEL.nu
    yielding = 0.0  # radial displacement per pressure, of both
    for held in (0.6, 1.4):
        A, B = 1.0, -(held**2)
        yielding += abs((A + B) * (1 - nu**2) / E / ((1 + nu) * A - (1 - nu) * B))
    return interference / yielding


def test_integrals_of_piecewise_polynomials():
    theta = np.linspace(0.2, 1.4, 41)
    assert integrate(theta, np.sin(theta), 2) == pytest.approx(math.cos(0.2) - math.cos(1.4), rel=1e-8)
    assert integrate(theta, np.sin(theta), 1) == pytest.approx(math.cos(0.2) - math.cos(1.4), rel=1e-3)
    assert integrate(theta, theta**2, 2) == pytest.approx((1.4**3 - 0.2**3) / 3, rel=1e-14)


def test_an_external_lining_sees_its_drum_from_the_other_side(brake):
    external = vary(
        brake,
        {"shoe.side": "external", "shoe.hinge": {"x": 0.05, "y": -0.2}, "shoe.actuation.direction": math.pi},
    )
    body = prepare(external, elements=10).bodies[0]
    assert np.hypot(*body.basis.doflocs).min() == pytest.approx(brake.drum.radius, rel=1e-12)
