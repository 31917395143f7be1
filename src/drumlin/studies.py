"""Find, load and run studies, and find the example brake files.

A study is a file studies/NAME/study.py with the functions `study(short, say)` and
`report(result, folder)`. If `study` also has a parameter `journal`, it stores each finished case in
the journal. A study that was stopped then continues with the next case.
"""

import ast
import importlib
import inspect
import os
import re
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

from drumlin.base.errors import BadInput
from drumlin.base.journal import Journal, checksum_of_source_and_libraries
from drumlin.base.texts import did_you_mean_hint

CARRIED = Path(__file__).resolve().parent / "carried"
"""The folder with copies of studies/ and meshes/ in an installed drumlin."""

REPOSITORY = CARRIED if CARRIED.is_dir() else Path(__file__).resolve().parents[2]
"""The folder that has studies/ and meshes/: CARRIED if it exists, else the source's root."""

JUDGE = Path(__file__).resolve().parents[1] / "drumlin_studies"
"""The folder of the package `drumlin_studies`, which studies import.

The results of a study depend on the source of this package, so that its journal must know it.
"""


def paths_of_example_brakes() -> dict[str, Path]:
    """The paths of the example brake files by the names of the examples.

    A file brake.toml gets the name of its folder. Another file in the same folder gets the name
    FOLDER_FILE. Any other file keeps its own name.
    """
    # Brakes of studies come first, so that a brake in meshes/ of the same name gets a longer name.
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


def text_of_example_brake(name: str) -> str:
    """The text of an example brake file, in which paths of mesh files are made absolute.

    Raises BadInput for an unknown name of an example.
    """
    paths = paths_of_example_brakes()
    if name not in paths:
        raise BadInput(
            f"NAME = {name!r}: no such example{did_you_mean_hint(name, paths)}; "
            f"allowed: {', '.join(paths)}"
        )
    path = paths[name]

    def line_with_absolute_mesh_path(mesh: re.Match[str]) -> str:
        """The line `mesh = ...` of the brake file with the absolute path of the mesh file."""
        return f'mesh = "{(path.parent / mesh[1]).as_posix()}"'

    # The text may be saved in any folder. Absolute paths of the mesh files stay valid there.
    text = re.sub(
        r'(?m)^mesh = "([^"]+)"', line_with_absolute_mesh_path, path.read_text(encoding="utf-8")
    )
    return re.sub(r"(?m)^#:schema .*/", "#:schema ", text)


def paths_of_own_studies() -> dict[str, Path]:
    """The paths study.py of drumlin's own studies by their names."""
    files = sorted((REPOSITORY / "studies").glob("*/study.py"))
    return {file.parent.name: file for file in files}


def first_lines_of_own_studies() -> dict[str, str]:
    """The first line of the docstring of each of drumlin's own studies, by name.

    The studies are read and not run.
    """
    found = {}
    for name, file in paths_of_own_studies().items():
        text = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
        found[name] = text.partition("\n")[0]
    return found


def import_study(name: str) -> tuple[ModuleType, Path]:
    """Import a study; returns its module and the folder that has the folder studies/.

    `name` is the name of one of drumlin's own studies, or a path such as ./studies/NAME or
    studies/NAME/study.py. A study of somebody else must be given by its path, because its code is
    run. Raises BadInput, which lists drumlin's own studies, if there is no such study.
    """
    # A name without a folder never runs code that happens to lie in the current folder.
    own = paths_of_own_studies()
    file = own.get(name)
    if file is None and len(Path(name).parts) > 1:
        # Symbolic links are not resolved: studies/ must be a folder of the path as it was given.
        given = Path(os.path.abspath(name))  # noqa: PTH100
        file = given if given.name == "study.py" else given / "study.py"
    # For a name with a NUL os.path.isfile returns False, while Path.is_file raises an error.
    is_file = file is not None and os.path.isfile(file)  # noqa: PTH113
    if file is None or not is_file or file.parents[1].name != "studies":
        raise BadInput(
            f"NAME = {name!r}: no such study{did_you_mean_hint(name, own)}; "
            f"allowed: {', '.join(own) or 'none of its own here'}, "
            "or the path of another one: .../studies/NAME"
        )
    root = file.parents[2]
    # With this folder on the path, a study and the processes that it starts can import its files.
    if str(root) not in sys.path:
        sys.path.insert(0, str(root))
    return importlib.import_module(f"studies.{file.parent.name}.study"), root


def run_study_and_write_report(
    name: str, folder: Path | None, *, short: bool, say: Callable[[str], None]
) -> Path:
    """Run a study and write its report; returns the path of the report's page.

    Parameters
    ----------
    name : name of the study, or its path
    folder : folder of the report; None for reports/NAME in the current folder
    short : whether the study runs in its short form
    say : function that is called with each line about the progress
    """
    module, root = import_study(name)
    # A study without a journal computes everything again each time.
    folder = folder or Path("reports") / module.__name__.split(".")[1]
    if "journal" not in inspect.signature(module.study).parameters:
        page: Path = module.report(module.study(short=short, say=say), folder)
        return page
    # A study with a journal continues an earlier run that was stopped.
    path = folder / ("journal-short.jsonl" if short else "journal.jsonl")
    with Journal(path, checksum_of_source_and_libraries(root / "studies", JUDGE)) as journal:
        for line in journal.notes:
            say(line)
        if len(journal):
            say(f"going on after {len(journal)} finished cases")
        page = module.report(module.study(short=short, say=say, journal=journal), folder)
        journal.close_and_rename_complete_journal()
    return page
