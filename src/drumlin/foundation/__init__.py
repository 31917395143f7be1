"""The elastic foundation model of post brakes, published by Barecki & Scieszka (1987).

The shoe is a bending beam, lining and block are springs side by side, and the drum is a ring that
bends.
"""

from drumlin.foundation.model import (
    LIFTS,
    RING_SECTIONS,
    reason_against_foundation_model,
    ring_displacement_under_each_shoe,
    solve_brake_by_foundation_model,
)

__all__ = [
    "LIFTS",
    "RING_SECTIONS",
    "reason_against_foundation_model",
    "ring_displacement_under_each_shoe",
    "solve_brake_by_foundation_model",
]
