"""Rigid-shoe laws: drum and shoe are rigid, the pressure is proportional to the lining's approach.

`rigid` solves a brake with any rigid shoes, on a drum or a plane; `face` describes the two
surfaces. `shapes`, `pivoted` and `flat` hold laws as formulas on arrays. `hinged` and `flat` solve
a brake by the lumped laws and by the laws that assume a shape of the pressure. `simscape` is the
double-shoe block with its own parameters.
"""

from drumlin.laws.hinged import locking_friction, sine
from drumlin.laws.naming import law
from drumlin.laws.shapes import LAWS, Law, Layout

__all__ = ["LAWS", "Law", "Layout", "law", "locking_friction", "sine"]
