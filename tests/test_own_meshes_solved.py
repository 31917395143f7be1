"""Files of every kind, made anew for three more shoes, give the right torque and peak of p."""

import numpy as np
import pytest

from decks import (
    SAME,
    deck_of,
    every_fifth_cell_cut,
    moved_nodes,
    rounded,
    straightened,
    with_corners_in_sets_alone,
)
from drumlin import vary
from drumlin.fem.solve import solve
from drumlin_studies.mesh_degrees import draw_random_brake_with_one_shoe

pytestmark = pytest.mark.slow
SEEDS = [7, 8, 9]
"""Seeds of brakes with one shoe, of other radii, arcs, thicknesses, moduli and widths."""


@pytest.fixture(scope="module", params=SEEDS)
def one(request):
    """A brake of one shoe, and its response by the parametric model."""
    brake = draw_random_brake_with_one_shoe(np.random.default_rng(request.param))
    return brake, solve(brake, tolerance=1e-3)


def check(one, path, unit="m"):
    """The torque and the peak of a brake with this mesh are right within both stated errors."""
    brake, right = one
    found = solve(vary(brake, {"shoe.mesh": str(path), "shoe.mesh_unit": unit}))
    for name, a, b in (
        ("torque", found.torque, right.torque),
        ("peak", found.shoes[0].peak_pressure, right.shoes[0].peak_pressure),
    ):
        # Twelve straight sides along a lining and its body are off by some per cent.
        assert found.error[name] < 0.05
        assert abs(a / b - 1) <= found.error[name] + right.error[name], name


OTHERS = {
    "rounded to a thousandth": ("quad2", "mm", lambda t: rounded(t, 3)),
    "rounded to a hundredth": ("quad2", "mm", lambda t: rounded(t, 2)),
    "straight sides": ("quad2", "m", straightened),
    "straight and rounded": ("quad2", "mm", lambda t: rounded(straightened(t), 3)),
    "inches": ("quad2", "in", lambda t: moved_nodes(t, lambda x, y: (x / 0.0254, y / 0.0254))),
    "corners in sets alone": ("quad2", "m", with_corners_in_sets_alone),
    "quadrilaterals and triangles": ("quad1", "m", every_fifth_cell_cut),
    "linear triangles": ("tri1", "m", str),
    "plane strain elements": ("quad2", "m", lambda t: t.replace("CPS8", "CPE8")),
}
"""Kind of element, unit of length and change of the deck for each further kind of file."""
KINDS = {case: ("quad2", "m", change) for case, change in SAME.items()} | OTHERS


@pytest.mark.parametrize("case", KINDS)
def test_a_file_of_another_shoe_is_solved_right(tmp_path, one, case):
    brake, _ = one
    kind, unit, change = KINDS[case]
    text = deck_of(tmp_path, brake.shoes[0], brake.drum.radius, kind)
    path = tmp_path / "other.inp"
    path.write_text(change(text))
    check(one, path, unit)
