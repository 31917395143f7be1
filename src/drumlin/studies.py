"""Finding and loading a study: studies/NAME/study.py with `study(short, say)` and `report(result, folder)`."""

import importlib.util
from pathlib import Path
from types import ModuleType

from drumlin.errors import BadInput

REPOSITORY = Path(__file__).resolve().parents[2]


def load(name: str) -> tuple[ModuleType, Path]:
    """The module of a study and the folder that holds studies/ and reports/: here, or where drumlin's source is.

    Raises BadInput, naming the studies that there are.
    """
    found: list[str] = []
    for root in dict.fromkeys([Path.cwd(), REPOSITORY]):
        files = {path.parent.name: path for path in sorted((root / "studies").glob("*/study.py"))}
        found += [known for known in files if known not in found]
        if name in files:
            spec = importlib.util.spec_from_file_location(f"studies.{name}.study", files[name])
            assert spec is not None and spec.loader is not None  # a .py file always has both
            module = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(module)
            return module, root
    raise BadInput(f"NAME = {name!r}: no such study; allowed: {', '.join(found) or 'none here (no studies/)'}")
