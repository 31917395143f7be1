"""Pressure laws of rigid shoes on a rigid drum or plane.

By the rigid-shoe law the pressure is proportional to the lining's compression. The module `rigid`
solves a brake by this law, and `face` describes the drum or the plane on which the shoes press. The
modules `shapes`, `pivoted` and `flat` hold closed-form laws as formulas on arrays. The modules
`hinged` and `flat` solve a brake by laws that assume how the pressure varies along the lining. The
module `naming` tells under which name the rigid-shoe law applies to a brake. The module `simscape`
has the formulas of the Double-Shoe Brake block of Simscape Driveline.
"""

from typing import TYPE_CHECKING

from drumlin.base.moved import make_getattr_function_for_renamed_functions
from drumlin.laws.hinged import self_locking_friction_of_hinged_shoe, solve_brake_by_sine_law
from drumlin.laws.naming import solve_brake_by_its_rigid_shoe_law
from drumlin.laws.shapes import (
    LAWS_OF_HINGED_SHOES_BY_NAME,
    PressureLawOfHingedShoe,
    ShoeAnglesAndRadii,
)

__all__ = [
    "LAWS_OF_HINGED_SHOES_BY_NAME",
    "PressureLawOfHingedShoe",
    "ShoeAnglesAndRadii",
    "self_locking_friction_of_hinged_shoe",
    "solve_brake_by_its_rigid_shoe_law",
    "solve_brake_by_sine_law",
]

if not TYPE_CHECKING:
    # Users' programs may still import these functions by their former names.
    __getattr__ = make_getattr_function_for_renamed_functions(
        __name__,
        {
            "sine": "solve_brake_by_sine_law",
            "law": "solve_brake_by_its_rigid_shoe_law",
            "locking_friction": "self_locking_friction_of_hinged_shoe",
        },
    )
