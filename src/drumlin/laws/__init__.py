"""Rigid-shoe laws: shoe and drum are rigid, the pressure is proportional to the approach.

The module `rigid` solves a brake with any rigid shoes, and `face` describes the drum or the plane
on which they press. The modules `shapes`, `pivoted` and `flat` hold closed-form laws as formulas on
arrays. The modules `hinged` and `flat` solve a brake by laws that assume the shape of the pressure.
The module `naming` chooses the name of the law for a brake. The module `simscape` is the
double-shoe brake block of Simscape Driveline.
"""

from drumlin.laws.hinged import locking_friction, sine
from drumlin.laws.naming import law
from drumlin.laws.shapes import LAWS, Law, Layout

__all__ = ["LAWS", "Law", "Layout", "law", "locking_friction", "sine"]
