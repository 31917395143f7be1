"""The elastic foundation model of post brakes: beam, layers of springs, elastic ring (Barecki & Scieszka 1987)."""

from drumlin.foundation.model import LIFTS, SECTIONS, rim, solve, why_not
from drumlin.foundation.worn import worn_in

__all__ = ["LIFTS", "SECTIONS", "rim", "solve", "why_not", "worn_in"]
