"""scikit-fem's elements without the rest of it.

`import skfem` runs all of scikit-fem, its meshes, forms and scipy.sparse as well, which takes longer than a brake does.
A solve by columns calls its elements alone: they are loaded from the same files under a name of their own, so that
`import skfem` stays what it is, here and for others.
"""

import importlib
import importlib.util
import sys
from functools import cache
from types import ModuleType
from typing import Any

PLACE = "drumlin.fem._skfem"  # where they are known to Python: a package with scikit-fem's folder, and no __init__ run


@cache
def elements() -> Any:
    """The module `skfem.element`."""
    spec = importlib.util.find_spec("skfem")
    assert spec is not None and spec.submodule_search_locations is not None  # drumlin requires it
    bare = ModuleType(PLACE, "scikit-fem's folder")
    bare.__path__ = list(spec.submodule_search_locations)
    sys.modules[PLACE] = bare
    return importlib.import_module(f"{PLACE}.element")


def plane_stress(E: float, nu: float) -> tuple[float, float]:
    """Lamé's constants of plane stress: E nu/(1 - nu^2), E/(2 (1 + nu)) [Pa]."""
    return E * nu / (1 - nu**2), E / (2 * (1 + nu))
