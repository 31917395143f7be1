"""A ring with a support of its own kind is refused in a line where plain rings alone are known."""

import pytest

from drumlin import foundation
from drumlin.base.errors import BadInput
from drumlin.brake import read_brake, vary
from drumlin.brake.components import DrumRing
from drumlin.brake.drum_brake import DrumBrake
from drumlin.brake.ring_support import reason_if_ring_edge_is_not_fixed_or_free
from drumlin.fem.analysis.sensitivity import compute_torque_sensitivity
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.verification.triangles.levels import TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE
from drumlin.verification.triangles.levels import (
    solve_brake_on_one_triangle_mesh as solve_by_triangles,
)
from drumlin_studies.reduced import make_function_that_prepares_surrogates

SECTION = {"thickness": 0.015, "width": 0.06, "material": {"E": 1.1e11, "nu": 0.26}}
REFUSED = "takes rings with a fixed or a free far edge only"


@pytest.fixture(params=["double_shoe", "post_brake"])
def strange(root, request):
    """A brake whose ring has a support that no brake file can name."""
    brake = read_brake(root / "studies" / request.param / "brake.toml")
    brake = vary(brake, {"drum.ring": SECTION})
    assert isinstance(brake, DrumBrake) and brake.ring is not None
    ring = brake.ring.model_copy(update={"support": "magnets"})
    return brake.model_copy(update={"drum": brake.drum.model_copy(update={"ring": ring})})


@pytest.mark.parametrize("support", ["fixed", "free"])
def test_rings_of_brake_files_are_plain(root, support):
    brake = read_brake(root / "studies" / "double_shoe" / "brake.toml")
    brake = vary(brake, {"drum.ring": SECTION | {"support": support}})
    assert brake.ring.has_fixed_or_free_far_edge
    assert reason_if_ring_edge_is_not_fixed_or_free(brake, "a model") is None
    assert reason_if_ring_edge_is_not_fixed_or_free(brake.brake_without_ring(), "a model") is None


def test_the_foundation_model_refuses_it(strange):
    said = foundation.reason_against_foundation_model(strange)
    assert said is not None
    if strange.title.startswith("post"):
        assert said == f"drum.ring.support = 'magnets': the foundation model {REFUSED}"


def test_the_triangles_refuse_it(strange):
    with pytest.raises(BadInput, match=f"the verification by triangles {REFUSED}"):
        solve_by_triangles(strange, TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE[0])


def test_the_reduced_model_refuses_it(strange):
    with pytest.raises(BadInput, match=f"a sketch {REFUSED}"):
        make_function_that_prepares_surrogates()(strange)


@pytest.mark.parametrize("stiffness", [{}, {"bending_stiffness": 2000.0}])
def test_a_slope_by_its_modulus_is_not_stated(root, monkeypatch, stiffness):
    """The modulus of a plain ring alone makes the flexibility of the ring."""
    brake = read_brake(root / "studies" / "double_shoe" / "brake.toml")
    brake = vary(brake, {"drum.ring": SECTION | stiffness})
    scene = make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0])
    plain = compute_torque_sensitivity(scene, brake)
    assert [plain.ring is None, plain.ring_bending_stiffness is None] == [
        bool(stiffness),
        not stiffness,
    ]
    monkeypatch.setattr(DrumRing, "has_fixed_or_free_far_edge", False)
    other = compute_torque_sensitivity(scene, brake)
    assert other.ring is None and other.ring_bending_stiffness is None
    assert other.friction == plain.friction
