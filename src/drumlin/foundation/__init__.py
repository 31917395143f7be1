"""The elastic foundation model of post brakes, published by Barecki & Scieszka (1987).

The shoe is a bending beam, lining and block are springs side by side, and the drum is a ring that
bends.
"""

from drumlin.foundation.model import LIFTS, RING_SECTIONS, rim, solve, why_not

__all__ = ["LIFTS", "RING_SECTIONS", "rim", "solve", "why_not"]
