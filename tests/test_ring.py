"""The elastic drum ring: thin-ring theory, limits, balance, coupling of the shoes."""

import math

import numpy as np
import pytest

from conftest import STUDY
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.file import read_brake, vary
from drumlin.brake.plane_brake import make_drum_or_plane_brake_from_data
from drumlin.fem.analysis.fields import (
    stress_and_displacement_fields_of_ring,
    stress_and_displacement_fields_of_shoe,
)
from drumlin.fem.hp import ring as hp_ring
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin.fem.substructure.ring import mesh_of_drum_ring
from drumlin.response.norms import relative_distance_of_pressures
from drumlin.response.response import length_of_uncompared_edge_zone
from drumlin_studies.random_brake import draw_random_brake
from picking import picked, saying

BRAKE = read_brake(STUDY / "brake.toml")


def ringed(E=1.2e11, support="fixed", thickness=0.015, **changes):
    ring = {
        "thickness": thickness,
        "width": 0.04,
        "material": {"E": E, "nu": 0.25},
        "support": support,
    }
    return vary(BRAKE, {"drum.ring": ring, **changes})


def test_the_mesh_is_the_whole_ring():
    spec = ringed()
    mesh = mesh_of_drum_ring(spec.drum.ring, spec.drum.radius, spec.shoes, 20)
    r = np.hypot(*mesh.doflocs)
    assert (r.min(), r.max()) == pytest.approx((0.150, 0.165), rel=1e-12)
    assert len(mesh.boundaries["contact"]) == len(mesh.boundaries["support"]) > 40
    external = vary(spec, {"shoe.side": "external", "shoe.hinge": {"x": 0.05, "y": -0.2}})
    r = np.hypot(*mesh_of_drum_ring(external.drum.ring, 0.15, external.shoes, 20).doflocs)
    assert (r.min(), r.max()) == pytest.approx((0.135, 0.150), rel=1e-12)


@pytest.mark.parametrize("support", ["fixed", "free"])
def test_a_stiff_ring_is_a_rigid_drum_and_the_difference_goes_as_one_over_E(support):
    rigid = solve(BRAKE, elements=30).torque
    off = [solve(ringed(E, support), elements=30).torque / rigid - 1 for E in (1.2e14, 1.2e15)]
    assert abs(off[1]) < 1e-3
    # what does not fall with E is the ring's own discretisation of the singular edges
    assert abs(off[1]) < 0.2 * abs(off[0]) + 3e-6


@pytest.mark.parametrize("support", ["fixed", "free"])
def test_balance_symmetry_and_mirror_with_a_ring(support):
    scene = make_prepared_model(ringed(support=support), elements=30)
    one = solve_prepared_model(scene, ringed(support=support))
    other = solve_prepared_model(scene, ringed(support=support, rotation="clockwise"))
    assert max(one.balance.force, one.balance.moment) < 1e-9
    assert one.torque == pytest.approx(other.torque, rel=1e-8)
    assert one.shoes[0].torque == pytest.approx(other.shoes[1].torque, rel=1e-8)


def test_shoes_meet_through_a_free_ring_and_not_through_a_rigid_drum():
    strong = {"shoe[0].actuation.force": 3000.0}
    scene, plain = (
        make_prepared_model(ringed(support="free"), elements=20),
        make_prepared_model(BRAKE, elements=20),
    )
    for spec, prepared, felt in ((ringed(support="free"), scene, True), (BRAKE, plain, False)):
        before = solve_prepared_model(prepared, spec).shoes[1].torque
        after = solve_prepared_model(prepared, vary(spec, strong)).shoes[1].torque
        assert (abs(after / before - 1) > 1e-3) == felt


def test_a_thin_free_ring_bends_as_theory_says():
    """A thin free ring under two opposite forces shortens by .148778 and widens by .136620.

    Both in F R^3/(EI); the first is pi/4 - 2/pi.

    The pair is spread over short arcs of the friction surface; the linear response comes from the
    ring body alone.
    """
    R, width, E = 1.0, 0.04, 1.2e11
    deviations = []
    for share in (0.04, 0.02):
        t = share * R
        shoe = {
            "side": "internal",
            "hinge": {"x": 0.0, "y": -0.5},
            "lining": {
                "start": -0.02,
                "end": 0.02,
                "thickness": 0.01,
                "width": width,
                "material": {"E": 1e9, "nu": 0.0},
            },
            "actuation": {"force": 1.0, "direction": 0.0, "point": {"x": 0.0, "y": 0.5}},
        }
        left = {
            **shoe,
            "lining": {**shoe["lining"], "start": math.pi - 0.02, "end": math.pi + 0.02},
        }
        left["actuation"] = {"force": 1.0, "direction": math.pi, "point": {"x": 0.0, "y": 0.5}}
        from drumlin.brake.file import make_drum_brake_from_data

        spec = make_drum_brake_from_data(
            {
                "title": "ring",
                "rotation": "clockwise",
                "friction": 0.3,
                "drum": {
                    "radius": R - 0.5 * t,
                    "ring": {
                        "thickness": t,
                        "width": width,
                        "material": {"E": E, "nu": 0.0},
                        "support": "free",
                    },
                },
                "shoe": [{**shoe, "name": "right"}, {**left, "name": "left"}],
            }
        )
        scene = make_prepared_model(spec, elements=4)
        ring, bodies = scene.ring, scene.bodies
        areas = picked(bodies, "coupling.areas_of_contact_nodes")
        # Even pressures of one newton act on each side.
        p = [np.full(len(a), 1.0 / a.sum()) for a in areas]
        opening = [
            float(
                p[i]
                @ ring.normal_half_flexibilities[i].T
                @ sum(ring.normal_half_flexibilities[j] @ p[j] for j in (0, 1))
            )
            for i in (0, 1)
        ]
        EI = E * width * t**3 / 12
        # the mean radial displacement under each force, outwards
        expected = 0.5 * (math.pi / 4 - 2 / math.pi) * R**3 / EI
        deviations.append(sum(opening) / 2 / expected - 1)
    assert abs(deviations[1]) < 0.01
    assert abs(deviations[1]) < abs(deviations[0])


def test_it_is_said_that_no_ring_was_left_out():
    assert saying(solve(BRAKE, elements=10).left_out, "no [drum.ring]")
    assert not saying(solve(ringed(), elements=10).left_out, "no [drum.ring]")


def test_shoes_on_both_sides_of_one_ring_are_refused():
    spec = ringed(**{"shoe[1].side": "external", "shoe[1].hinge": {"x": -0.05, "y": -0.2}})
    with pytest.raises(BadInput, match="inside and outside"):
        solve(spec)


def test_a_scene_with_another_ring_is_refused():
    scene = make_prepared_model(ringed(), elements=10)
    with pytest.raises(BadInput, match="ring"):
        solve_prepared_model(scene, ringed(E=1e12))


@pytest.mark.parametrize("support", ["fixed", "free"])
def test_the_fields_of_ring_and_lining_meet_on_the_friction_surface(support):
    """Normal displacements of ring and lining agree on the friction surface where they touch.

    Both are recovered inside their own meshes.
    """
    spec = ringed(support=support)
    scene = make_prepared_model(spec, elements=60)
    response = solve_prepared_model(scene, spec)
    lining, ring = (
        stress_and_displacement_fields_of_shoe(scene, spec, response, 1),
        stress_and_displacement_fields_of_ring(scene, spec, response),
    )
    touching = lining.pressure > 0.05 * lining.pressure.max()
    surface = np.hypot(*ring.points.T) < 0.150 + 1e-9

    def outwards(part, where):
        angle = np.mod(np.arctan2(part.points[where, 1], part.points[where, 0]), 2 * math.pi)
        return angle, np.einsum("ij,ij->i", part.displacement[where], part.points[where]) / 0.150

    angle, mine = outwards(lining, touching)
    theirs = np.interp(
        angle, *zip(*sorted(zip(*outwards(ring, surface), strict=True)), strict=True)
    )
    compression = response.shoes[1].peak_pressure * 0.008 / 3e8
    assert np.abs(mine - theirs).max() < 2e-3 * compression
    # The mean motion of a free rim is zero.
    if support == "free":
        far = np.hypot(*ring.points.T) > 0.165 - 1e-9
        assert (
            np.abs(ring.displacement[far].mean(axis=0)).max()
            < 0.05 * np.abs(ring.displacement).max()
        )


def solved_without_widening(brake, monkeypatch):
    """The answer on a ring whose columns are those of the linings."""
    with monkeypatch.context() as patch:
        patch.setattr(hp_ring, "largest_ratio_of_ring_to_lining_column_widths", lambda *_: 1.0)
        return solve(brake)


def test_the_wide_columns_of_a_ring_change_p_less_than_its_error(monkeypatch):
    brake = draw_random_brake(7, "linings on ring")
    wide, fine = solve(brake), solved_without_widening(brake, monkeypatch)
    for own, other in zip(wide.shoes, fine.shoes, strict=True):
        zone = length_of_uncompared_edge_zone(other.theta[-1] - other.theta[0])
        assert relative_distance_of_pressures(own, other, zone) < 0.2 * wide.error["pressure"]
    assert abs(wide.torque / fine.torque - 1) < 0.2 * wide.error["torque"]


def test_a_ring_with_too_many_nodes_under_linings_is_refused(monkeypatch):
    brake = draw_random_brake(7, "linings on ring")
    monkeypatch.setattr(hp_ring, "MAX_NODES_OF_CONTACT_PROBLEM", 20)
    with pytest.raises(NoAnswer, match=r"the ring has .* more than the 20 that are allowed"):
        solve(brake)


def test_equal_shoes_around_a_free_ring_press_alike(monkeypatch):
    shoe = {
        "name": "shoe",
        "side": "internal",
        "pattern": {"count": 5, "step": "72 deg"},
        "hinge": {"radius": "115 mm", "angle": "-24 deg"},
        "lining": {
            "start": "-20 deg",
            "end": "20 deg",
            "thickness": "8 mm",
            "width": "40 mm",
            "material": {"E": "300 MPa", "nu": 0.25},
        },
        "actuation": {
            "force": "2 kN",
            "direction": "10 deg",
            "point": {"x": "110 mm", "y": "45 mm"},
        },
    }
    ring = {"thickness": "10 mm", "width": "50 mm", "support": "free"}
    material = {"E": "210 GPa", "nu": 0.3}
    brake = make_drum_or_plane_brake_from_data(
        {
            "title": "five shoes",
            "rotation": "clockwise",
            "friction": 0.3,
            "drum": {"radius": "150 mm", "ring": ring | {"material": material}},
            "shoe": [shoe],
        }
    )
    wide, fine = solve(brake), solved_without_widening(brake, monkeypatch)
    for other in wide.shoes[1:]:
        assert other.pressure == pytest.approx(wide.shoes[0].pressure, rel=1e-7)
    assert abs(wide.torque / fine.torque - 1) < 0.2 * wide.error["torque"]
