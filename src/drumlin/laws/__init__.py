"""Rigid-shoe laws: drum and shoe rigid, pressure proportional to the lining's normal approach.

`rigid`: the law of any rigid shoe, on a drum or a plane, brake -> response; `face`: what tells the
two apart; `shapes`, `pivoted`, `flat`: laws as pure formulas on arrays; `hinged`, `flat`: the
lumped laws and those that take a shape of p for granted, brake -> response; `simscape`: the
double-shoe block with its own parameters.
"""

from drumlin.laws.hinged import locking_friction, sine
from drumlin.laws.naming import law
from drumlin.laws.shapes import LAWS, Law, Layout

__all__ = ["LAWS", "Law", "Layout", "law", "locking_friction", "sine"]
