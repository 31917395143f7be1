"""Finding, loading and running a study, and the example brake files.

A study is a file studies/NAME/study.py with `study(short, say)` and `report(result, folder)`. A
study whose `study` also takes a `journal` keeps each finished case in it, and goes on where it was
stopped.
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
"""The folder in which an installed drumlin carries studies/ and meshes/."""

REPOSITORY = CARRIED if CARRIED.is_dir() else Path(__file__).resolve().parents[2]
"""The folder of studies/ and meshes/: the checkout, or what an installed drumlin carries of it."""

JUDGE = Path(__file__).resolve().parents[1] / "drumlin_studies"
"""The package that studies import. A study's results depend on its source as on drumlin's own."""


def examples() -> dict[str, Path]:
    """The example brake files by name.

    A file brake.toml has the name of its folder. Another file beside it has the folder's name
    before its own.
    """
    # Files of studies come first, so that a mesh file of the same name gets the longer name.
    found: dict[str, Path] = {}
    in_studies = sorted((REPOSITORY / "studies").glob("*/*.toml"))
    in_meshes = sorted((REPOSITORY / "meshes").glob("*.toml"))
    for path in [*in_studies, *in_meshes]:
        if "[[shoe]]" in path.read_text(encoding="utf-8"):
            folder, name = path.parent.name, path.stem
            if (path.parent / "brake.toml").exists():
                name = folder if name == "brake" else f"{folder}_{name}"
            found[f"{name}_{folder}" if name in found else name] = path
    return found


def example(name: str) -> str:
    """The text of an example brake file, with absolute paths of its mesh files.

    Raises BadInput for an unknown name.
    """
    paths = examples()
    if name not in paths:
        raise BadInput(
            f"NAME = {name!r}: no such example{nearest(name, paths)}; allowed: {', '.join(paths)}"
        )
    path = paths[name]

    def placed(mesh: re.Match[str]) -> str:
        """The line of a mesh file with its absolute path."""
        return f'mesh = "{(path.parent / mesh[1]).as_posix()}"'

    # The text may be written into any folder, from which the mesh files are still found.
    text = re.sub(r'(?m)^mesh = "([^"]+)"', placed, path.read_text(encoding="utf-8"))
    return re.sub(r"(?m)^#:schema .*/", "#:schema ", text)


def load(name: str) -> tuple[ModuleType, Path]:
    """The module of a study, and the folder that holds studies/.

    A name is that of one of drumlin's own studies. A study of somebody else is code that is run: it
    is loaded by its path only, such as ./studies/NAME or studies/NAME/study.py. Raises BadInput,
    which names the studies that there are.
    """
    # A name alone never runs code of somebody else that lies in the current folder.
    own = {path.parent.name: path for path in sorted((REPOSITORY / "studies").glob("*/study.py"))}
    file = own.get(name)
    if file is None and len(Path(name).parts) > 1:
        # Links stay as they are: the folder above is that of the name.
        given = Path(os.path.abspath(name))  # noqa: PTH100
        file = given if given.name == "study.py" else given / "study.py"
    # A name with a NUL is no file; Path.is_file would raise an error for it.
    is_file = file is not None and os.path.isfile(file)  # noqa: PTH113
    if file is None or not is_file or file.parents[1].name != "studies":
        raise BadInput(
            f"NAME = {name!r}: no such study{nearest(name, own)}; "
            f"allowed: {', '.join(own) or 'none of its own here'}, "
            "or the path of another one: .../studies/NAME"
        )
    root = file.parents[2]
    # The study's other files are found there, also by the processes that the study starts.
    if str(root) not in sys.path:
        sys.path.insert(0, str(root))
    return importlib.import_module(f"studies.{file.parent.name}.study"), root


def run(name: str, folder: Path | None, *, short: bool, say: Callable[[str], None]) -> Path:
    """Run a study and write its report; returns the page.

    Parameters
    ----------
    name : of the study, or its path
    folder : of the report; None: reports/NAME in the current folder
    short : whether the study runs its short form
    say : told the progress in lines
    """
    module, root = load(name)
    # A study without a journal begins anew each time.
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
