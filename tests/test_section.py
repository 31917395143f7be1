"""T-sections and bodies known by bending stiffness: data, closed forms, all models alike."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import drumlin
from drumlin import BadInput, Brake
from drumlin.brake import read_drum_or_plane_brake, vary
from drumlin.brake.components import (
    STEEL_OF_PARTS_WITHOUT_GIVEN_MATERIAL,
    RectangularCrossSection,
    stiffnesses_of_bonded_plates,
)
from drumlin.brake.fields import Material
from drumlin.brake.file import make_drum_brake_from_data, make_validated_brake_part
from drumlin.brake.plane_brake import FlatBrake
from drumlin.brake.writing import brake_file_text
from drumlin.fem.analysis.sensitivity import compute_torque_sensitivity
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.peers.hexahedra import mesh_of_half_solid_shoe
from drumlin.verification.triangles.outline import make_shoe_outline
from drumlin_studies.reduced import make_function_that_prepares_surrogates
from held_shoes import BODY, brake_of

S = {"E": 2.1e11, "nu": 0.3}
WEB, TABLE = {"thickness": 0.02, "width": 0.005, "material": S}, {"thickness": 0.003, "width": 0.04}
SIZES = st.floats(1e-3, 0.1)


@given(SIZES, SIZES, SIZES, SIZES)
def test_area_neutral_axis_and_second_moment_of_a_t_section(
    t: float, b: float, h: float, w: float
) -> None:
    """A T-section's area, neutral axis and second moment are the sums over its two rectangles.

    A table t x b stands on a web h x w, counted from the web's outer face.
    """
    material = Material(E=2e11, nu=0.25)
    found = stiffnesses_of_bonded_plates(
        [RectangularCrossSection(h, w, material), RectangularCrossSection(t, b, material)]
    )
    area = w * h + b * t
    axis = (w * h**2 / 2 + b * t * (h + t / 2)) / area
    about_face = w * h**3 / 3 + b * ((h + t) ** 3 - h**3) / 3
    assert pytest.approx(2e11 * area, rel=1e-12) == found.EA
    assert pytest.approx(0.8e11 * area, rel=1e-12) == found.GA
    assert found.depth_of_neutral_axis == pytest.approx(axis, rel=1e-12)
    assert pytest.approx(2e11 * (about_face - area * axis**2), rel=1e-9) == found.EI


def bar(**body: Any) -> Brake:
    """A bar 1 m long, held at its end face, under a lining of hardly any stiffness."""
    shoe = {
        "name": "bar",
        "hinge": {"x": 0.0, "y": 0.02},
        "lining": {
            "start": 0.05,
            "end": 0.15,
            "width": 0.04,
            "thickness": 2e-3,
            "material": {"E": 1e3, "nu": 0.0},
        },
        "body": {"start": 0.0, "end": 1.0} | body,
        "actuation": {"force": 1.0, "direction": -1.5, "point": {"x": 1.0, "y": 0.02}},
    }
    data = {"title": "t", "friction": 0.0, "plane": {"sliding": "+x"}, "shoe": [shoe]}
    return make_validated_brake_part(FlatBrake, data)


def scenes(brake: Brake) -> list[PreparedModel]:
    return [
        make_prepared_model(brake, elements=10),
        make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0]),
    ]


# The stiffness is E I with I = 5 20^3/12 + 100 5.227^2 + 40 3^3/12 + 120 6.273^2 mm^4.
@pytest.mark.parametrize(
    ("body", "EI"),
    [
        ({"thickness": 0.02, "width": 0.04, "material": S}, 5600.0),
        ({"thickness": 0.02, "bending_stiffness": 5600.0}, 5600.0),
        (
            {"thickness": 0.03, "bending_stiffness": 5600.0, "material": {"E": 7e10, "nu": 0.3}},
            5600.0,
        ),
        ({"thickness": 0.02, "bending_stiffness": 800.0, "material": S, "width": 0.04}, 800.0),
        (
            WEB | {"table": TABLE},
            2233.7636363636366,
        ),
    ],
)
def test_a_straight_body_bends_as_a_beam(body: dict[str, Any], EI: float) -> None:
    """delta = L^3/(3 EI) (1 + 3 EI kappa/(G A L^2)) under a force at its end, shear by the web."""
    shoe = bar(**body)
    assert (
        pytest.approx(EI, rel=1e-12)
        == stiffnesses_of_bonded_plates(list(shoe.shoes[0].body.plates.values())).EI
    )
    for scene in scenes(shoe):
        assert 3 * EI * scene.bodies[0].flexibility.load_point_motion_by_load[
            1, 1
        ] == pytest.approx(1.0, rel=1e-3)
        assert EI * scene.bodies[0].flexibility.load_point_motion_by_load[2, 2] == pytest.approx(
            1.0, rel=5e-3
        )


def arc(**body: Any) -> Brake:
    shoe = {
        "name": "arc",
        "side": "internal",
        "hinge": {"x": 0.0, "y": -0.9},
        "lining": {
            "start": -0.1,
            "end": 0.1,
            "thickness": 2e-3,
            "width": 0.04,
            "material": {"E": 1e3, "nu": 0.0},
        },
        "body": {"start": -math.pi / 2, "end": math.pi / 2} | body,
        "actuation": {"force": 1.0, "direction": 0.0, "point": {"x": 0.0, "y": 0.9}},
    }
    data = {
        "title": "t",
        "rotation": "clockwise",
        "friction": 0.0,
        "drum": {"radius": 1.0},
        "shoe": [shoe],
    }
    return make_drum_brake_from_data(data)


@pytest.mark.parametrize(
    "body", [{"thickness": 0.03, "bending_stiffness": 3e3}, WEB | {"table": TABLE}]
)
def test_a_curved_body_bends_as_an_arc(body: dict[str, Any]) -> None:
    """A couple turns the end of a half circle by pi A_m/(E A (r A_m - A)), A_m = Int dA/r.

    This is Winkler's curved beam.
    """
    brake = arc(**body)
    plates = list(brake.shoes[0].body.plates.values())[::-1]  # type: ignore[union-attr]
    section = stiffnesses_of_bonded_plates(plates)
    inner = 1.0 - brake.shoes[0].total_thickness
    r, area, over = inner + section.depth_of_neutral_axis, section.EA / plates[0].material.E, 0.0
    for plate in plates:
        over += plate.width * math.log((inner + plate.thickness) / inner)
        inner += plate.thickness
    turn = math.pi * over / (plates[0].material.E * area * (r * over - area))
    assert turn * section.EI / (math.pi * r) == pytest.approx(1.0, rel=0.01)
    for scene in scenes(brake):
        assert scene.bodies[0].flexibility.load_point_motion_by_load[2, 2] == pytest.approx(
            turn, rel=2e-3
        )


def layered(kind: str, *, old: bool) -> Brake:
    """A T-section over the lining's arc, or the same as a backing on a narrow body if `old`."""
    over = {"start": -0.95, "end": 0.95}
    web = BODY | over | {"width": 0.005}
    table = {"thickness": 0.003}
    own = (
        {"body": web, "backing": table | {"material": S}}
        if old
        else {"body": web | {"table": table | {"width": 0.04}}}
    )
    return brake_of(kind, 1, **own)


@pytest.mark.parametrize("kind", ["pivot", "guide"])
def test_a_t_section_is_what_its_layers_are(kind: str) -> None:
    """Held by its back, the body is the same layers whichever way they are written."""
    new, old = (drumlin.solve(layered(kind, old=old), elements=20) for old in (False, True))
    a, b = new.shoes[0], old.shoes[0]
    np.testing.assert_allclose(a.pressure, b.pressure, atol=1e-9 * b.peak_pressure)
    assert new.torque == pytest.approx(old.torque, rel=1e-10)
    rows = [
        np.diag(
            make_function_that_prepares_surrogates()(layered(kind, old=old))
            .bodies[0]
            .flexibility.gap_closure_by_pressure
        )
        for old in (False, True)
    ]
    # The surrogate has a mesh of the backing, and the table in the bar.
    np.testing.assert_allclose(rows[0], rows[1], rtol=0.01)


def test_the_second_solver_has_the_same_plates() -> None:
    hinged = [
        vary(layered("pivot", old=old), {"shoe.pivot": None}).shoes[0] for old in (False, True)
    ]
    new, old = (make_shoe_outline(shoe, 0.11) for shoe in hinged)
    assert len(new.layers) == len(old.layers) == 3
    for one, other in zip(new.layers, old.layers, strict=True):
        assert (one.start, one.end, one.elastic.width) == (
            other.start,
            other.end,
            other.elastic.width,
        )
        np.testing.assert_array_equal(one.elastic.elasticity, other.elastic.elasticity)
    np.testing.assert_array_equal(new.thickness, old.thickness)


def test_the_plates_of_a_t_section_have_their_widths_in_hexahedra(flexible: Brake) -> None:
    """Volumes of half a shoe, plate by plate, in closed form; the hinge holds the web's width."""
    brake = vary(
        flexible, {"shoe.body.table": {"thickness": 3e-3, "width": 0.04}, "shoe.body.width": 5e-3}
    )
    shoe, R = brake.shoes[0], brake.size
    solid = mesh_of_half_solid_shoe(shoe, R, 8, 2)
    volumes = solid.basis.dx.sum(axis=1)
    far = R - shoe.lining.thickness
    for name, t, b in (("table", 3e-3, 0.04), ("shoe", shoe.body.thickness, 5e-3)):  # type: ignore[union-attr]
        near = far - t
        area = (far**2 - near**2) / 2 * math.radians(135)
        assert volumes[solid.mesh.subdomains[name]].sum() == pytest.approx(area * b / 2, rel=1e-4)
        far = near
    assert solid.half["shoe"] == 2.5e-3


def test_moduli_of_table_and_web_are_one(flexible: Brake) -> None:
    brake = vary(
        flexible, {"shoe.body.table": {"thickness": 3e-3, "width": 0.04}, "shoe.body.width": 5e-3}
    )
    E = 2.1e11
    found = compute_torque_sensitivity(make_prepared_model(brake, elements=20), brake)
    torque = [
        drumlin.solve(vary(brake, {"shoe.body.material.E": E * k}), elements=20).torque
        for k in (1.001, 0.999)
    ]
    slope = (torque[0] - torque[1]) / 0.002
    assert set(found.shoes[0].moduli) == {"lining", "shoe"}
    assert sum(shoe.moduli["shoe"] for shoe in found.shoes) == pytest.approx(slope, rel=1e-3)


def test_files_of_both_read_as_they_were_written(tmp_path: Any) -> None:
    for brake in (
        layered("pivot", old=False),
        vary(arc(**WEB), {"shoe.body.bending_stiffness": 3e3}),
    ):
        assert read_drum_or_plane_brake(tmp_path / "b.toml", brake_file_text(brake)) == brake
    only = arc(thickness=0.03, bending_stiffness=3e3)
    assert 'bending_stiffness = "3000.0 N m^2"' in brake_file_text(only)
    assert only.shoes[0].body.plates["shoe"].material == STEEL_OF_PARTS_WITHOUT_GIVEN_MATERIAL  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("body", "said"),
    [
        (
            {"thickness": 0.02},
            "shoe[0].body: needs width and material, or bending_stiffness, or all three",
        ),
        (
            {"thickness": 0.02, "width": 0.04},
            "shoe[0].body: needs width and material, or bending_stiffness, or all",
        ),
        (
            {"thickness": 0.02, "width": 0.04, "bending_stiffness": 1.0},
            "shoe[0].body: needs width and material",
        ),
        ({"bending_stiffness": 1.0}, "shoe[0].body.thickness: is missing"),
        (
            {"thickness": 0.02, "bending_stiffness": 0.0},
            "shoe[0].body.bending_stiffness = 0.0: must be greater than 0",
        ),
        (
            {"thickness": 0.02, "bending_stiffness": 1.0, "table": TABLE},
            "table: bending_stiffness is that of the",
        ),
        (
            WEB | {"table": TABLE | {"width": 4e-3}},
            "table.width = 4 mm: must be at least width = 5 mm, the web's",
        ),
        (WEB | {"table": {"width": 0.04}}, "shoe[0].body.table.thickness: is missing"),
        (
            WEB | {"table": TABLE | {"thickness": 1e-12}},
            "shoe[0].body.table.thickness = 1e-09 mm: must be at least",
        ),
        (WEB | {"table": TABLE | {"web": 1}}, "unknown key 'web'; allowed: thickness, width"),
        (WEB | {"thickness": 0.995, "table": TABLE}, "backing and body are 1000 mm thick together"),
    ],
)
def test_a_section_that_is_none_is_refused_in_one_line(body: dict[str, Any], said: str) -> None:
    with pytest.raises(BadInput) as error:
        arc(**body)
    assert said in str(error.value)
    assert "\n" not in str(error.value)
