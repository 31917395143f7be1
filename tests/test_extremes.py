"""Extreme stiffnesses, sizes and arcs: stated errors exceed true ones, or drumlin refuses."""

import pytest

from drumlin.base.errors import NoAnswer
from drumlin.fem.solve import solve
from drumlin.response.norms import relative_distance_of_pressures
from drumlin_studies.extreme_cases import ExtremeCase
from drumlin_studies.trial import text_of_changed_quantities

QUICK = [ExtremeCase(thickness=1 / 3), ExtremeCase(arc=170.0)]
SLOW = [
    *(ExtremeCase(shoe=ratio) for ratio in (1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6)),
    *(ExtremeCase(thickness=share) for share in (1e-3, 1e-2, 0.1)),
    *(
        ExtremeCase(arc=arc, force=force)
        for arc, force in ((1.0, 20.0), (5.0, 100.0), (60.0, 2000.0))
    ),
    ExtremeCase(nu=0.0),
    ExtremeCase(nu=0.49),
    ExtremeCase(friction=1.0),
    ExtremeCase(clearance=1e-3),
    ExtremeCase(clearance="split"),
    *(ExtremeCase(shoes=2, ring=ring, support="free") for ring in (10.0, 1e3, 1e5)),
    ExtremeCase(shoe=1e4, arc=5.0, force=100.0),
    ExtremeCase(shoe=1e6, thickness=0.2, nu=0.49),
]


def check(case):
    """Check that a brake's true errors, found by a graded mesh, are at most the stated errors.

    Corners converge slowly on a mesh: its last step may be half of the error that is left.
    """
    brake = case.brake()
    found = solve(brake)
    coarse, fine = solve(brake, elements=60), solve(brake, elements=120)
    assert found.torque > 0
    off, step = abs(found.torque / fine.torque - 1), abs(coarse.torque / fine.torque - 1)
    assert off <= found.error["torque"] + 2 * step
    for a, b, c in zip(found.shoes, fine.shoes, coarse.shoes, strict=True):
        assert relative_distance_of_pressures(a, b) <= found.error[
            "pressure"
        ] + 2 * relative_distance_of_pressures(c, b)


@pytest.mark.parametrize("case", QUICK, ids=text_of_changed_quantities)
def test_far_apart(case):
    check(case)


@pytest.mark.slow
@pytest.mark.parametrize("case", SLOW, ids=text_of_changed_quantities)
def test_farther_apart(case):
    check(case)


@pytest.mark.slow
def test_a_thin_lining_on_a_shoe_far_softer_is_refused_a_fine_tolerance_and_says_what_it_reached():
    case = ExtremeCase(shoe=1e-3, thickness=1e-3)
    check(case)
    with pytest.raises(NoAnswer, match=r"not reached.* estimated error of p"):
        solve(case.brake(), tolerance=1e-4)
