"""Solid pads on a plane: plane stress where they must agree, balances, mirror images, fields."""

from pathlib import Path

import meshio
import numpy as np
import pytest

import drumlin
from conftest import ROOT, partly
from drumlin.brake.file import vary
from drumlin.brake.plane_brake import read_drum_or_plane_brake
from drumlin.response.norms import relative_distance_of_pressures
from drumlin_studies.random_kinds import mirror_turn_and_shift_brake
from flat_pads import BODY, KINDS, LINING, pad

NO_NU = {"shoe.lining.material.nu": 0.0, "shoe.body.material.nu": 0.0}


@pytest.mark.parametrize("kind", partly(KINDS, {"pivot"}))
def test_without_lateral_contraction_it_is_plane_stress(kind: str) -> None:
    brake = vary(pad(kind, "-x", body=BODY), NO_NU | {"shoe.lining.misfit": {"taper": 1e-6}})
    solid = drumlin.solve(brake, "solid", across=2).shoes[0]
    plane = drumlin.solve(brake).shoes[0]
    assert solid.error is not None and plane.error is not None
    stated = {name: solid.error[name] + plane.error[name] for name in plane.error}
    assert solid.normal_force == pytest.approx(plane.normal_force, rel=stated["torque"] + 1e-9)
    assert relative_distance_of_pressures(solid, plane, 5e-3) < stated["pressure"] + 1e-9
    assert stated["torque"] < 1e-3


@pytest.mark.slow
def test_a_narrow_pad_is_plane_stress_and_a_wide_one_is_not() -> None:
    """A pad of a tenth of its lining's thickness in width is plane stress, a wide one is not."""
    p, force = [], []
    for width in (0.04, 2e-4):
        lining = LINING | {"start": 0.06, "end": 0.18, "thickness": 2e-3, "width": width}
        brake = pad("hinge", lining=lining, body=BODY | {"width": width})
        brake = vary(brake, {"shoe.actuation.force": 1e4 * width})
        (a,), (b,) = (drumlin.solve(brake, model).shoes for model in ("solid", "fem"))
        p.append(relative_distance_of_pressures(a, b, 5e-3))
        force.append(abs(a.normal_force / b.normal_force - 1))
    assert p[0] > 0.04
    assert p[1] < 4e-3
    assert force[0] > 1e-3
    assert force[1] < 2e-4


def test_solid_pads_balance_and_their_mirror_images_answer_alike() -> None:
    brake = read_drum_or_plane_brake(ROOT / "studies" / "brakes" / "rail_clamp.toml")
    found = drumlin.solve(brake, "solid", across=2)
    assert max(found.balance.force, found.balance.moment) < 1e-9
    other = drumlin.solve(
        mirror_turn_and_shift_brake(brake, mirrored=True, shift=0.3), "solid", across=2
    )
    for a, b in zip(found.shoes, other.shoes, strict=True):
        np.testing.assert_allclose(
            b.pressure_at(0.3 - a.theta), a.pressure, atol=1e-6 * a.peak_pressure
        )
        assert a.surface is not None
        assert np.ptp(a.surface.pressure, axis=1).max() > 0.01 * a.peak_pressure


def test_the_fields_stand_where_the_pad_does_and_meet_the_plane(tmp_path: Path) -> None:
    brake, file = pad("hinge", body=BODY), tmp_path / "pad.vtu"
    (shoe,) = drumlin.solve(brake, "solid", across=2, fields=file).shoes
    mesh = meshio.read(file)
    x, y, z = mesh.points.T
    assert (x.min(), x.max(), y.min()) == pytest.approx(
        (BODY["start"], BODY["end"], 0.0), abs=1e-12
    )
    assert (y.max(), z.max()) == pytest.approx((0.021, 0.02))
    pressed = mesh.point_data["pressure [Pa]"] > 0
    moved = mesh.point_data["displacement [m]"]
    assert np.abs(moved[pressed, 1]).mean() < 1e-2 * np.abs(moved).max()
    assert x[pressed].min() >= shoe.contact_arcs[0][0] - 0.02
