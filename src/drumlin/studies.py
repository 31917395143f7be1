"""Finding, loading and running a study: studies/NAME/study.py with `study(short, say)` and
`report(result, folder)`.

A study whose `study` takes a `journal`, too, keeps each finished case in it and goes on where it
was stopped.
"""

import importlib
import inspect
import os
import re
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

from drumlin.base.errors import BadInput
from drumlin.base.journal import Journal, source_stamp
from drumlin.base.texts import nearest

CARRIED = Path(__file__).resolve().parent / "carried"
REPOSITORY = CARRIED if CARRIED.is_dir() else Path(__file__).resolve().parents[2]
"""The folder of studies/ and meshes/: the checkout, or what an installed drumlin carries of it."""
JUDGE = Path(__file__).resolve().parents[1] / "drumlin_studies"
"""The package that studies import. A study's results depend on its source as well as on drumlin's."""


def examples() -> dict[str, Path]:
    """The example brake files by name: their own, after that of a folder whose main brake is
    brake.toml.
    """
    found: dict[str, Path] = {}
    for path in [
        *sorted((REPOSITORY / "studies").glob("*/*.toml")),
        *sorted((REPOSITORY / "meshes").glob("*.toml")),
    ]:
        if "[[shoe]]" in path.read_text(encoding="utf-8"):
            folder, name = path.parent.name, path.stem
            if (path.parent / "brake.toml").exists():
                name = folder if name == "brake" else f"{folder}_{name}"
            found[f"{name}_{folder}" if name in found else name] = path
    return found


def example(name: str) -> str:
    """The text of an example brake file, with its mesh files by where they lie. Raises BadInput for
    an unknown name.
    """
    own = examples()
    if name not in own:
        raise BadInput(
            f"NAME = {name!r}: no such example{nearest(name, own)}; allowed: {', '.join(own)}"
        )
    path = own[name]

    def placed(found: re.Match[str]) -> str:
        return f'mesh = "{(path.parent / found[1]).as_posix()}"'

    text = re.sub(r'(?m)^mesh = "([^"]+)"', placed, path.read_text(encoding="utf-8"))
    return re.sub(r"(?m)^#:schema .*/", "#:schema ", text)


def load(name: str) -> tuple[ModuleType, Path]:
    """The module of a study and the folder that holds studies/.

    A name is one of drumlin's own studies. Another's, which is code that is run, is loaded by its
    path only, such as ./studies/NAME or studies/NAME/study.py. Raises BadInput, naming the studies
    that there are.
    """
    own = {path.parent.name: path for path in sorted((REPOSITORY / "studies").glob("*/study.py"))}
    file = own.get(name)
    if file is None and len(Path(name).parts) > 1:
        given = Path(os.path.abspath(name))  # noqa: PTH100  (links stay: the folder above is that of the name)
        file = given if given.name == "study.py" else given / "study.py"
    if file is None or not os.path.isfile(file) or file.parents[1].name != "studies":  # noqa: PTH113  (NUL is no file)
        raise BadInput(
            f"NAME = {name!r}: no such study{nearest(name, own)}; allowed: {', '.join(own) or 'none of its own here'}, "
            "or the path of another one: .../studies/NAME"
        )
    root = file.parents[2]
    if str(root) not in sys.path:
        sys.path.insert(
            0, str(root)
        )  # for the study's other files, and in the processes that it starts
    return importlib.import_module(f"studies.{file.parent.name}.study"), root


def run(name: str, folder: Path | None, *, short: bool, say: Callable[[str], None]) -> Path:
    """Run a study and write its report into `folder`, by default reports/NAME from here; returns
    the page.
    """
    module, root = load(name)
    folder = folder or Path("reports") / module.__name__.split(".")[1]
    if "journal" not in inspect.signature(module.study).parameters:
        page: Path = module.report(module.study(short=short, say=say), folder)
        return page
    path = folder / ("journal-short.jsonl" if short else "journal.jsonl")
    with Journal(path, source_stamp(root / "studies", JUDGE)) as journal:
        for line in journal.notes:
            say(line)
        if len(journal):
            say(f"going on after {len(journal)} finished cases")
        page = module.report(module.study(short=short, say=say, journal=journal), folder)
        journal.finish()
    return page
