"""scikit-fem's elements without the rest of it.

`import skfem` runs all of scikit-fem, its meshes, forms and scipy.sparse as well, which takes longer than a brake does.
A solve by columns calls its elements alone: they are loaded from the same files under a name of their own, so that
`import skfem` stays what it is, here and for others.
"""

import importlib
import importlib.util
import sys
from functools import cache
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

PLACE = "drumlin.fem._skfem"  # where they are known to Python: packages with scikit-fem's folders, and no __init__ run
QUADS = "element.element_quad"  # the elements that are called; all of them are seventy modules


@cache
def elements() -> Any:
    """scikit-fem's ElementQuad2 and ElementQuadP."""
    spec = importlib.util.find_spec("skfem")
    assert spec is not None and spec.submodule_search_locations is not None  # drumlin requires it
    for package in ("", "element", QUADS):
        bare = ModuleType(f"{PLACE}.{package}".rstrip("."), "scikit-fem's folder")
        bare.__path__ = [str(Path(place, *package.split("."))) for place in spec.submodule_search_locations]
        sys.modules[bare.__name__] = bare
    second, high = (importlib.import_module(f"{PLACE}.{QUADS}.{name}") for name in ("element_quad2", "element_quadp"))
    return SimpleNamespace(ElementQuad2=second.ElementQuad2, ElementQuadP=high.ElementQuadP)
