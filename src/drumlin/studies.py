"""Finding, loading and running a study: studies/NAME/study.py with `study(short, say)` and `report(result, folder)`.

A study whose `study` takes a `journal`, too, keeps each finished case in it and goes on where it was stopped.
"""

import importlib
import inspect
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

from drumlin.errors import BadInput
from drumlin.journal import Journal, source_stamp

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
            if str(root) not in sys.path:
                sys.path.insert(0, str(root))  # for the study's other files, and in the processes that it starts
            return importlib.import_module(f"studies.{name}.study"), root
    raise BadInput(f"NAME = {name!r}: no such study; allowed: {', '.join(found) or 'none here (no studies/)'}")


def run(name: str, folder: Path | None, *, short: bool, say: Callable[[str], None]) -> Path:
    """Run a study and write its report into `folder`, by default reports/NAME; returns the page."""
    module, root = load(name)
    folder = folder or root / "reports" / name
    if "journal" not in inspect.signature(module.study).parameters:
        page: Path = module.report(module.study(short=short, say=say), folder)
        return page
    path = folder / ("journal-short.jsonl" if short else "journal.jsonl")
    with Journal(path, source_stamp(root / "studies")) as journal:
        if len(journal):
            say(f"going on after {len(journal)} finished cases")
        page = module.report(module.study(short=short, say=say, journal=journal), folder)
        journal.finish()
    return page
