"""The elastic foundation model of post brakes, published by Barecki & Scieszka (1987).

A shoe is a beam that bends. Lining and block are springs side by side, which do not interact. The
drum is rigid or a ring that bends.
"""

from typing import TYPE_CHECKING

from drumlin.base.moved import make_getattr_function_for_renamed_functions
from drumlin.foundation.model import (
    DEFAULT_DIVISIONS_OF_SHOE_BEAM,
    INCLUDABLE_EFFECTS,
    inward_ring_displacement_under_each_shoe,
    reason_against_foundation_model,
    solve_brake_by_foundation_model,
)

__all__ = [
    "DEFAULT_DIVISIONS_OF_SHOE_BEAM",
    "INCLUDABLE_EFFECTS",
    "inward_ring_displacement_under_each_shoe",
    "reason_against_foundation_model",
    "solve_brake_by_foundation_model",
]

if not TYPE_CHECKING:
    # Users' programs may still import these functions by their former names.
    __getattr__ = make_getattr_function_for_renamed_functions(
        __name__,
        {
            "solve": "solve_brake_by_foundation_model",
            "why_not": "reason_against_foundation_model",
            "rim": "inward_ring_displacement_under_each_shoe",
        },
    )
