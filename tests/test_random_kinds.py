"""Random brakes of every support and load: what physics demands of laws and finite elements."""

import math
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import drumlin
from conftest import partly
from drumlin import Brake, NoAnswer, Response, vary
from drumlin.brake.plane_brake import FlatBrake, read_drum_or_plane_brake
from drumlin.brake.writing import brake_file_text
from drumlin.fem.analysis.self_locking import self_locking_friction_of_shoe_groups
from drumlin.fem.solve import prepared_model_with_finest_elements
from drumlin.laws import solve_brake_by_its_rigid_shoe_law
from drumlin.response.balance import brake_with_forces_of_response, resultant_of_contact_on_shoe
from drumlin.response.resultants import planar_cross_product
from drumlin_studies.random_kinds import (
    FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND,
    brake_with_scaled_lengths_and_moduli,
    draw_random_brake_of_support_kind,
    mirror_turn_and_shift_brake,
)
from picking import picked

ELEMENTS = 10
SEEDS, NAMES = (
    st.integers(0, 10**6),
    st.sampled_from(list(FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND)),
)


def fem(brake: Brake) -> Response:
    return drumlin.solve(brake, elements=ELEMENTS)


MODELS = (solve_brake_by_its_rigid_shoe_law, fem)


def whole_balance(brake: Brake, found: Response) -> None:
    """Forces and moments from outside, and each force that one shoe passes to another."""
    under = brake_with_forces_of_response(brake, found)
    shoes = {shoe.name: (shoe, own) for shoe, own in zip(under.shoes, found.shoes, strict=True)}
    for link in brake.links:
        source, to = shoes[link.source][1], shoes[link.to][0]
        assert source.hinge_reaction == pytest.approx(
            -to.actuation.force_vector, rel=1e-8, abs=1e-8 * to.actuation.force
        )
        assert to.actuation.force == pytest.approx(np.linalg.norm(source.hinge_reaction), rel=1e-9)
    if brake.actuation is not None and brake.actuation.is_cam_or_wedge:
        assert sum(own.force or 0.0 for own in found.shoes) == pytest.approx(
            brake.actuation.force_of_cylinder_or_sum_of_cam_forces, rel=1e-9
        )
    for shoe, own in shoes.values():
        reaction = own.hinge_reaction
        if shoe.abutment is not None and own.contact_arcs:
            bearing, along = (
                reaction @ shoe.unit_vector_of_smooth_abutment_force,
                abs(planar_cross_product(shoe.unit_vector_of_smooth_abutment_force, reaction)),
            )
            assert bearing > 0
            assert along <= shoe.abutment.friction * bearing + 1e-8 * bearing
        if shoe.guide is not None:
            way = np.array([math.cos(shoe.guide.direction), math.sin(shoe.guide.direction)])
            assert abs(reaction @ way) < 1e-8 * max(np.linalg.norm(reaction), shoe.actuation.force)
    if isinstance(brake, FlatBrake):
        return
    forces, moments = [], []
    for i, (shoe, own) in enumerate(shoes.values()):
        drum = resultant_of_contact_on_shoe(under, i, own)
        foot = shoe.pin.xy
        forces += [drum.force, shoe.actuation.force_vector, own.hinge_reaction]
        moments += [
            drum.moment,
            float(planar_cross_product(shoe.actuation.point.xy, shoe.actuation.force_vector)),
            float(planar_cross_product(foot, own.hinge_reaction)) + own.reaction_moment,
        ]
    size = max(map(np.linalg.norm, forces))
    # The balance is that of p(theta) on the round drum, which the elements' edges follow. `judge`
    # judges the balance at the nodes.
    assert np.linalg.norm(np.sum(forces, axis=0)) < 1e-9 * size
    assert abs(sum(moments)) < 1e-9 * size * brake.size


def judge(seed: int, kind: str) -> None:
    brake = draw_random_brake_of_support_kind(seed, kind)
    for solve in (solve_brake_by_its_rigid_shoe_law, drumlin.solve):
        found = solve(brake)
        assert max(found.balance.force, found.balance.moment) < 1e-9
        assert found.effect > 0
        whole_balance(brake, found)


def same(
    a: Response, b: Response, *, size: float = 1.0, force: float = 1.0, rel: float = 1e-7
) -> None:
    assert b.effect == pytest.approx(size * a.effect, rel=rel)
    for x, y in zip(a.shoes, b.shoes, strict=True):
        assert y.normal_force == pytest.approx(force * x.normal_force, rel=rel)
        assert np.linalg.norm(y.hinge_reaction) == pytest.approx(
            force * np.linalg.norm(x.hinge_reaction), rel=rel
        )
        if x.force is not None:
            assert y.force == pytest.approx(force * x.force, rel=rel)


def fitting(brake: Brake) -> bool:
    """Whether all linings fit: then all grows with the forces."""
    return all(
        lining.clearance == 0 and lining.misfit == type(lining.misfit)()
        for lining in picked(brake.shoes, "lining")
    )


def moved(seed: int, kind: str, turn: float, length: float, modulus: float) -> None:
    """The brake turned, mirrored, shifted, scaled, stiffened, under twice the forces, as a file."""
    brake = draw_random_brake_of_support_kind(seed, kind)
    flat = isinstance(brake, FlatBrake)
    for solve in MODELS:
        a = solve(brake)
        for mirrored in (False, True):
            place: dict[str, Any] = {"shift": turn} if flat else {"turn": turn}
            same(a, solve(mirror_turn_and_shift_brake(brake, mirrored=mirrored, **place)))
        force = modulus * length**2
        same(
            a,
            solve(brake_with_scaled_lengths_and_moduli(brake, length, modulus)),
            size=force * (1 if flat else length),
            force=force,
        )
        (first, *others), fits = (
            brake.shoes,
            solve is solve_brake_by_its_rigid_shoe_law or fitting(brake),
        )
        twice = {"shoe.actuation.force": 2 * first.actuation.force} if fits and not others else {}
        if twice:
            same(a, solve(vary(brake, twice)), size=2, force=2)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "brake.toml"
            path.write_text(brake_file_text(brake))
            same(a, solve(read_drum_or_plane_brake(path)))


@settings(max_examples=2, suppress_health_check=list(HealthCheck))
@given(SEEDS, NAMES)
def test_every_shoe_and_the_whole_brake_balance(seed: int, kind: str) -> None:
    judge(seed, kind)


@pytest.mark.slow
@settings(max_examples=100, suppress_health_check=list(HealthCheck))
@given(SEEDS, NAMES)
def test_every_shoe_and_the_whole_brake_balance_many_times(seed: int, kind: str) -> None:
    judge(seed, kind)


LENGTH, MODULUS = st.floats(0.2, 5.0), st.floats(0.1, 10.0)


@settings(max_examples=2, suppress_health_check=list(HealthCheck))
@given(SEEDS, NAMES, st.floats(-3, 3), LENGTH, MODULUS)
def test_places_sizes_and_units_change_nothing(
    seed: int, kind: str, turn: float, length: float, modulus: float
) -> None:
    moved(seed, kind, turn, length, modulus)


@pytest.mark.slow
@settings(max_examples=100, suppress_health_check=list(HealthCheck))
@given(SEEDS, NAMES, st.floats(-3, 3), LENGTH, MODULUS)
def test_places_sizes_and_units_change_nothing_many_times(
    seed: int, kind: str, turn: float, length: float, modulus: float
) -> None:
    moved(seed, kind, turn, length, modulus)


def both_ways(brake: Brake) -> list[Brake]:
    if isinstance(brake, FlatBrake):
        return [vary(brake, {"plane.sliding": "+x"}), vary(brake, {"plane.sliding": "-x"})]
    return [vary(brake, {"rotation": rotation}) for rotation in ("clockwise", "counter-clockwise")]


def rigid_limit(seed: int, kind: str) -> int:
    """How many of both rotations have an answer; finite elements have none where the law none."""
    answers = 0
    for brake in both_ways(draw_random_brake_of_support_kind(seed, kind, rigid=True)):
        try:
            by_law = solve_brake_by_its_rigid_shoe_law(brake)
        except NoAnswer:
            with pytest.raises(NoAnswer):
                drumlin.solve(brake)
            continue
        assert drumlin.solve(brake).effect == pytest.approx(by_law.effect, rel=3e-3)
        answers += 1
    return answers


@pytest.mark.parametrize(
    "kind",
    partly(FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND, {"hinge", "abutment", "strut", "cam"}),
)
def test_rigid_shoes_with_thin_linings_answer_as_the_law_both_ways(kind: str) -> None:
    assert rigid_limit(9, kind) >= 1


@pytest.mark.slow
@pytest.mark.parametrize("kind", FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND)
def test_rigid_shoes_with_thin_linings_answer_as_the_law_many_times(kind: str) -> None:
    assert sum(rigid_limit(seed, kind) for seed in range(12)) >= 12


def end_by_law(brake: Brake, most: float) -> float | None:
    """The friction up to which the law has an answer; None where that is beyond `most`."""
    low, high = brake.friction, most
    for friction in (most, *(math.nan for _ in range(30))):
        middle = 0.5 * (low + high) if math.isnan(friction) else friction
        try:
            solve_brake_by_its_rigid_shoe_law(vary(brake, {"friction": middle}))
        except NoAnswer:
            high = middle
            continue
        if middle == most:
            return None
        low = middle
    return low


def locked(seed: int, kind: str, most: float = 1.2) -> int:
    """Judge a brake in both senses; in how many of them its law ends below `most`."""
    ends = 0
    for brake in both_ways(draw_random_brake_of_support_kind(seed, kind, rigid=True)):
        try:
            solve_brake_by_its_rigid_shoe_law(brake)
        except NoAnswer:
            continue
        end = end_by_law(brake, most)
        if end is None:
            continue
        own = vary(brake, {"friction": 0.97 * end})
        found = self_locking_friction_of_shoe_groups(
            prepared_model_with_finest_elements(own, elements=24), own, 2.0, 1e6
        )
        assert min(picked(found.values(), "friction")) == pytest.approx(end, rel=1e-2), (
            brake,
            end,
        )
        assert drumlin.solve(vary(brake, {"friction": 0.97 * end})).effect > 0
        with pytest.raises(NoAnswer):
            drumlin.solve(vary(brake, {"friction": 1.03 * end}))
        ends += 1
    return ends


LINKED = ["hinge", "abutment", "pivot", "strut", "cam"]


def test_a_hinged_shoe_ends_where_the_law_does() -> None:
    assert locked(0, "hinge") >= 1


@pytest.mark.slow
@pytest.mark.parametrize("kind", LINKED)
def test_finite_elements_end_where_the_law_does(kind: str) -> None:
    """Finite elements refuse where the rigid law does.

    At self-locking, where a shoe tips, its foot leaves the abutment, or a cam would have to pull.
    """
    assert sum(locked(seed, kind) for seed in range(12)) >= 6
