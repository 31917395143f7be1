"""The elastic foundation model of post brakes: beam, layers of springs, elastic ring (Barecki &
Scieszka 1987).
"""

from drumlin.foundation.model import LIFTS, SECTIONS, rim, solve, why_not

__all__ = ["LIFTS", "SECTIONS", "rim", "solve", "why_not"]
