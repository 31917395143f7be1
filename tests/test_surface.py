"""The friction surface tells a drum from a plane; no code asks for the class of a brake."""

import ast
import math
from pathlib import Path

import numpy as np
import pytest

import drumlin.brake
from drumlin.brake.brake import Brake
from drumlin.brake.drum_brake import DrumBrake
from drumlin.brake.plane_brake import FlatBrake, read_drum_or_plane_brake
from drumlin.brake.surface import FRICTION_SURFACE_OF_DRUM, FRICTION_SURFACE_OF_PLANE

ROOT = Path(__file__).resolve().parents[1]
PAD = read_drum_or_plane_brake(ROOT / "studies" / "brakes" / "rail_clamp.toml")
BLOCK = read_drum_or_plane_brake(ROOT / "studies" / "laws" / "block.toml")
CLASSES = {"Brake", "DrumBrake", "FlatBrake", "DrumShoe", "FlatShoe"}


def test_nothing_outside_of_the_brake_asks_for_the_class_of_a_brake() -> None:
    switches = []
    for path in sorted((ROOT / "src" / "drumlin").rglob("*.py")):
        if path.parent.name == "brake":
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "isinstance":
                asked = {name.id for name in ast.walk(node.args[1]) if isinstance(name, ast.Name)}
                switches += [f"{path}:{node.lineno}"] if asked & CLASSES else []
    assert switches == []


@pytest.mark.parametrize("name", ["BrakeTypeVariableInWear", "FlatBrake", "FlatShoe"])
def test_old_names_are_there_with_a_warning(name: str) -> None:
    with pytest.warns(DeprecationWarning, match=name):
        assert issubclass(getattr(drumlin.brake, name), Brake | drumlin.brake.Shoe)


def test_other_names_are_not_there() -> None:
    with pytest.raises(AttributeError, match="no attribute 'NoBrake'"):
        drumlin.brake.NoBrake  # noqa: B018


@pytest.mark.parametrize(("brake", "kind"), [(PAD, FlatBrake), (BLOCK, DrumBrake)])
def test_data_are_read_by_the_class_of_their_surface(brake: Brake, kind: type[Brake]) -> None:
    again = Brake.model_validate(brake.model_dump(by_alias=True))
    assert type(again) is kind and again == brake


@pytest.mark.parametrize("brake", [PAD, BLOCK])
def test_a_length_along_the_surface_is_phi_in_sizes_and_q_in_scale_factors(brake: Brake) -> None:
    for shoe in brake.shoes:
        q = np.linspace(shoe.lining.start, shoe.lining.end, 5)
        phi = shoe.frame.phi_of_surface_coordinates(q)
        np.testing.assert_allclose(
            shoe.frame.surface_coordinates_of_phi(phi), q, rtol=1e-13, atol=1e-15
        )
        lengths = np.abs(np.diff(q)) * brake.length_per_surface_coordinate
        np.testing.assert_allclose(np.abs(np.diff(phi)) * brake.size, lengths, rtol=1e-12)
        on_it = shoe.points_at_depth_and_coordinate_phi(np.zeros(5), phi, brake.size)
        np.testing.assert_allclose(
            shoe.surface_coordinates_of_points_in_shoe_frame(on_it, brake.size), phi, atol=1e-13
        )
        np.testing.assert_allclose(
            shoe.distances_from_friction_surface(on_it, brake.size), 0.0, atol=1e-15
        )


@pytest.mark.parametrize("brake", [PAD, BLOCK])
def test_the_reversed_brake_moves_the_other_way_and_back(brake: Brake) -> None:
    other = brake.brake_with_reversed_motion()
    assert (
        other.sign_of_motion == -brake.sign_of_motion
        and other.direction == brake.opposite_direction_of_motion
    )
    assert other.brake_with_reversed_motion() == brake


@pytest.mark.parametrize("surface", [FRICTION_SURFACE_OF_DRUM, FRICTION_SURFACE_OF_PLANE])
def test_levers_are_the_moments_of_normal_and_tangent(
    surface: drumlin.brake.surface.FrictionSurface,
) -> None:
    q, size = np.array([-0.4, 0.2, 1.3]), 0.3
    x, y = (
        np.array([q, 0 * q])
        if surface.is_plane_and_not_drum
        else size * np.array([np.cos(q), np.sin(q)])
    )
    for along, lever in zip(
        (surface.unit_normals_into_surface(q), surface.unit_tangents_of_surface(q)),
        surface.moments_of_unit_normal_and_tangential_forces(q, size),
        strict=True,
    ):
        np.testing.assert_allclose(x * along[1] - y * along[0], lever, atol=1e-15)


def test_a_surface_says_where_a_place_is_nearest_and_what_it_is_not() -> None:
    assert FRICTION_SURFACE_OF_DRUM.coordinate_plus_turns_nearest_to_middle(
        0.1 + 4 * math.pi, 0.0
    ) == pytest.approx(0.1)
    assert FRICTION_SURFACE_OF_PLANE.coordinate_plus_turns_nearest_to_middle(7.0, 0.0) == 7.0
    assert (
        FRICTION_SURFACE_OF_DRUM.reason_why_surface_is_not_required_one(FRICTION_SURFACE_OF_DRUM)
        is None
        and FRICTION_SURFACE_OF_PLANE.reason_why_surface_is_not_required_one(
            FRICTION_SURFACE_OF_PLANE
        )
        is None
    )
    assert (
        FRICTION_SURFACE_OF_PLANE.reason_why_surface_is_not_required_one(FRICTION_SURFACE_OF_DRUM)
        == "its shoes press on a plane, not on a drum"
    )
