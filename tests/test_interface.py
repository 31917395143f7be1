"""The weak coupling on the arc: resultants, areas, balance and patch, on meshes fine and coarse."""

import math

import numpy as np
import pytest

from drumlin.brake.file import vary
from drumlin.fem.assembly import prepare
from drumlin.fem.interface import couple, radial
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


def test_a_lining_pressed_evenly_between_rigid_arcs_has_even_pressure(brake):
    """Patch on the arc: a full ring sector pressed by u_r(R) = const with a Lame field; here its weak form.

    The pressure that the coupling finds for the traction of a constant pressure is that constant.
    """
    for sign in (1, -1):
        coupling = couple(prepare(brake, elements=10).bodies[0].line, 0.04, radial(sign))
        p = np.full(len(coupling.M), 7.0)
        assert np.linalg.solve(coupling.M, coupling.M @ p) == pytest.approx(p, rel=1e-12)
        outwards = coupling.N @ np.concatenate(
            [[math.cos(a), math.sin(a)] for a in prepare(brake, elements=10).bodies[0].line.phi]
        )
        assert outwards * sign == pytest.approx(coupling.area, rel=2e-3)


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
