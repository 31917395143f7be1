"""The tolerances of the misfit study. All limits are assumptions."""

import math

from drumlin.brake.brake import Brake
from drumlin.brake.clearance import (
    lining_radii_by_key_for_radius_mismatch,
    point_coordinate_changes_per_metre_along_hinge_radius,
)
from drumlin.brake.file import vary
from drumlin.laws import solve_brake_by_sine_law
from drumlin.sweeps.tolerances import (
    ManufacturingTolerance,
    truncated_normal_distribution,
    uniform_distribution,
)


def nominal_brake(brake: Brake) -> Brake:
    """The brake with the keys that tolerances change.

    They are a radius of the lining that equals the drum's, and an oval of amplitude zero.
    """
    oval = [{"order": 2, "amplitude": 0.0}]
    return vary(brake, {"shoe.lining.misfit.radius": brake.size, "drum.out_of_round": oval})


def assumed_tolerances(brake: Brake) -> tuple[ManufacturingTolerance, ...]:
    """The tolerances: normal distributions that are cut at their limits, two standard deviations.

    The radii of drums and linings are made to some hundredths of a millimetre, pins and lines of
    force to some tenths. Organic linings scatter by some 10 % in friction and 20 % in stiffness.
    """
    leading = 0 if solve_brake_by_sine_law(brake).shoes[0].self_energising else 1
    found = [
        ManufacturingTolerance(
            "friction ±0.03", truncated_normal_distribution(0.03), {"friction": 1.0}
        ),
        ManufacturingTolerance(
            "lining's modulus ±20 %",
            truncated_normal_distribution(0.2),
            {"shoe.lining.material.E": brake.shoes[0].lining.material.E_through},
        ),
        ManufacturingTolerance(
            "lining's thickness ±0.2 mm",
            truncated_normal_distribution(0.2e-3),
            {"shoe.lining.thickness": 1.0},
        ),
        ManufacturingTolerance(
            "drum's radius ±50 µm",
            truncated_normal_distribution(50e-6),
            {key: -1.0 for key in lining_radii_by_key_for_radius_mismatch(brake, 0.0)},
        ),
    ]
    for name, i in (("leading", leading), ("trailing", 1 - leading)):
        own = f"shoe[{i}].lining.misfit"
        found += [
            ManufacturingTolerance(
                f"lining's radius ±50 µm, {name}",
                truncated_normal_distribution(50e-6),
                {f"{own}.radius": 1.0},
            ),
            ManufacturingTolerance(
                f"centre of lining ±50 µm, {name}",
                truncated_normal_distribution(50e-6),
                point_coordinate_changes_per_metre_along_hinge_radius(
                    brake, i, "lining.misfit.offset"
                ),
            ),
            ManufacturingTolerance(
                f"taper ±50 µm, {name}", truncated_normal_distribution(50e-6), {f"{own}.taper": 1.0}
            ),
        ]
    pins: dict[str, float] = {}
    for i in range(len(brake.shoes)):
        pins |= point_coordinate_changes_per_metre_along_hinge_radius(brake, i, "hinge")
    return (
        *found,
        ManufacturingTolerance(
            "pins' distance ±0.2 mm", truncated_normal_distribution(0.2e-3), pins
        ),
        ManufacturingTolerance(
            "force ±3 %",
            truncated_normal_distribution(0.03),
            {"shoe.actuation.force": brake.shoes[0].actuation.force},
        ),
        ManufacturingTolerance(
            "line of force ±0.5 mm",
            truncated_normal_distribution(0.5e-3),
            {"shoe.actuation.point.y": 1.0},
        ),
        ManufacturingTolerance(
            "ovality of drum 0 to 30 µm",
            uniform_distribution(0.0, 30e-6),
            {"drum.out_of_round[0].amplitude": 1.0},
        ),
        ManufacturingTolerance(
            "where the oval drum stands",
            uniform_distribution(0.0, 2 * math.pi),
            {"drum.angle": 1.0},
        ),
    )
