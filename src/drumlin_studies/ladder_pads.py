"""Cases of the benchmark ladder on pads on a plane, solved as whole brakes.

The cases compare two results with closed forms: the compression of a thin lining, and the exponent
of the pressure at a pad's edge.
"""

import math
from functools import partial

import numpy as np

from drumlin.brake.brake import Brake
from drumlin.brake.fields import Material
from drumlin.brake.plane_brake import make_drum_or_plane_brake_from_data
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin_studies import closed_forms
from drumlin_studies.ladder_case import TOLERANCE_REASON_DISCRETISATION, KnownAnswerCase

PAD_LENGTH, PAD_WIDTH = 0.12, 0.04  # m
"""Length and width of the pad [m]."""
FORCE_THAT_PRESSES_PAD_ON_PLANE = 500.0  # N
"""Force that presses the pad on the plane [N]."""
MATERIAL_OF_THIN_PAD_LINING = Material(E=3e8, nu=0.25)
"""Material of the thin lining of the pad."""


def brake_with_pad_on_guide(thickness: float, mu: float, lining: Material) -> Brake:
    """A brake with one pad on a plane; the pad has a rigid back and a guide normal to the plane.

    Parameters
    ----------
    thickness : float
        Thickness of the lining [m].
    mu : float
        Coefficient of friction.
    lining : Material
        Material of the lining.
    """
    shoe = {
        "name": "pad",
        "guide": {"direction": -math.pi / 2},
        "lining": {
            "start": 0.0,
            "end": PAD_LENGTH,
            "width": PAD_WIDTH,
            "thickness": thickness,
            "material": lining,
        },
        "actuation": {
            "force": FORCE_THAT_PRESSES_PAD_ON_PLANE,
            "direction": -math.pi / 2,
            "point": {"x": PAD_LENGTH / 2, "y": 0.1},
        },
    }
    data = {"title": "pad", "friction": mu, "plane": {"sliding": "+x"}, "shoe": [shoe]}
    return make_drum_or_plane_brake_from_data(data)


def _lining_compression_over_closed_form() -> float:
    """The compression of a thin lining, relative to the closed form p (1 - nu^2) t/E.

    The closed form neglects the ends of the lining. The effect of the ends is proportional to the
    thickness t. It is extrapolated to t = 0 from two thicknesses.
    """
    pressure = FORCE_THAT_PRESSES_PAD_ON_PLANE / (PAD_LENGTH * PAD_WIDTH)
    ratios = []
    for t in (1e-3, 5e-4):
        (pad,) = solve(
            brake_with_pad_on_guide(t, 0.0, MATERIAL_OF_THIN_PAD_LINING), penalty=math.inf
        ).shoes
        assert pad.motion is not None
        closed_form = (
            pressure * t * (1 - MATERIAL_OF_THIN_PAD_LINING.nu**2) / MATERIAL_OF_THIN_PAD_LINING.E
        )
        ratios.append(-pad.motion[1] / closed_form)
    # In this combination of two thicknesses, an error that is proportional to the thickness
    # cancels.
    return 2 * ratios[1] - ratios[0]


def _displacement_exponent_at_leading_edge(mu: float, nu: float) -> float:
    """The exponent lambda of p ~ r^(lambda - 1) at the leading edge of a pad on a plane.

    r is the distance from the edge.
    """
    brake = brake_with_pad_on_guide(0.02, mu, Material(E=3e8, nu=nu))
    (pad,) = solve_prepared_model(
        make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[5]), brake
    ).shoes
    # Distances [m] from the edge, far below the lining's thickness of 20 mm.
    r = np.geomspace(2e-6, 4e-5, 12)
    return float(1 + np.polyfit(np.log(r), np.log(pad.pressure_at(r)), 1)[0])


KNOWN_ANSWER_CASES_ON_PADS = (
    KnownAnswerCase(
        family="thin pad on a plane",
        shows="a brake on a plane, lining as springs",
        source="Winkler, p (1 - nu^2) t/E bonded",
        quantity="yielding over the closed form, ends extrapolated",
        expected=1.0,
        tolerance=1e-3,
        tier=TOLERANCE_REASON_DISCRETISATION,
        found=_lining_compression_over_closed_form,
    ),
    *(
        KnownAnswerCase(
            family="edge of a pad on a plane",
            shows="singular pressure of a brake",
            source="eigenvalue of the corner (Williams 1952)",
            quantity=f"lambda, nu = 0.3, mu = {mu}",
            expected=closed_forms.displacement_exponent_at_sliding_corner(mu, 0.3),
            tolerance=1e-2,
            tier=TOLERANCE_REASON_DISCRETISATION,
            found=partial(_displacement_exponent_at_leading_edge, mu, 0.3),
        )
        for mu in (0.1, 0.3, 0.5)
    ),
)
"""The cases of the ladder on pads on a plane."""
