"""The elastic foundation model of post brakes: beam, layers of springs and elastic ring.

The model was published by Barecki & Scieszka (1987).
"""

from drumlin.foundation.model import LIFTS, RING_SECTIONS, rim, solve, why_not

__all__ = ["LIFTS", "RING_SECTIONS", "rim", "solve", "why_not"]
