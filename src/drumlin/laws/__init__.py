"""Rigid-shoe laws: drum and shoe rigid, pressure proportional to the lining's normal approach.

`shapes`: the laws as pure formulas on arrays; `hinged`, `pivoted`, `flat`: brake -> response;
`simscape`: the double-shoe block with its own parameters.
"""

from drumlin.laws.hinged import locking_friction, sine
from drumlin.laws.shapes import LAWS, Law, Layout

__all__ = ["LAWS", "Law", "Layout", "locking_friction", "sine"]
