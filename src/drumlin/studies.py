"""Find, load and run studies, and find the example brake files.

A study is a file studies/NAME/study.py with the functions `study(short, say)` and
`report(result, folder)`. If `study` also has a parameter `journal`, it stores each finished case in
the journal. A study that was stopped then continues with the next case.
"""

import ast
import importlib
import importlib.util
import inspect
import json
import os
import re
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.files import write_new_text_file
from drumlin.base.journal import JournalOfCaseResults, checksum_of_source_and_libraries
from drumlin.base.texts import did_you_mean_hint

FOLDER_OF_INSTALLED_STUDIES_AND_MESHES = Path(__file__).resolve().parent / "carried"
"""The folder with copies of studies/ and meshes/ in an installed drumlin."""

FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES = (
    FOLDER_OF_INSTALLED_STUDIES_AND_MESHES
    if FOLDER_OF_INSTALLED_STUDIES_AND_MESHES.is_dir()
    else Path(__file__).resolve().parents[2]
)
"""The folder that has studies/ and meshes/: that of the installed package or the source's."""

DRUMLIN_STUDIES_PACKAGE_FOLDER = Path(__file__).resolve().parents[1] / "drumlin_studies"
"""The folder of the package `drumlin_studies`, which studies import.

The results of a study depend on the source of this package, so that the checksum in the journal of
a study covers it.
"""


OPTIONAL_PACKAGE_BY_STUDY_NAME = {"manual": "sphinx"}
"""For studies that need optional packages: one of these packages, by the name of the study.

If it is missing, the user is told to install the extra drumlin[NAME] with the study's name.
"""


def paths_of_example_brakes() -> dict[str, Path]:
    """The paths of the example brake files by the names of the examples.

    A file brake.toml gets the name of its folder. Another file in the same folder gets the names of
    folder and file, joined by an underscore. Any other file keeps its own name.
    """
    # Brakes of studies come first, so that a brake in meshes/ of the same name gets a longer name.
    found: dict[str, Path] = {}
    in_studies = sorted(
        (FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES / "studies").glob("*/*.toml")
    )
    in_meshes = sorted((FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES / "meshes").glob("*.toml"))
    for path in [*in_studies, *in_meshes]:
        if "[[shoe]]" in path.read_text(encoding="utf-8"):
            folder, name = path.parent.name, path.stem
            if (path.parent / "brake.toml").exists():
                name = folder if name == "brake" else f"{folder}_{name}"
            found[f"{name}_{folder}" if name in found else name] = path
    return found


def paths_of_example_sweeps() -> dict[str, Path]:
    """The paths of the example sweep files by the names of the examples.

    The name of an example is ``sweep_`` and the name of its file without the suffix.
    """
    found = {}
    for path in sorted(
        (FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES / "studies").glob("*/*.toml")
    ):
        if re.search(r"(?m)^\[vary\]", path.read_text(encoding="utf-8")):
            found[f"sweep_{path.stem}"] = path
    return found


def paths_of_example_notebooks() -> dict[str, Path]:
    """The paths of the example notebooks by the names of the examples.

    The name of an example is ``notebook_`` and the name of its file without the suffix.
    """
    files = sorted(
        (FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES / "studies" / "notebooks").glob("*.ipynb")
    )
    return {f"notebook_{path.stem}": path for path in files}


def paths_of_all_examples() -> dict[str, Path]:
    """The paths of all examples by name: brakes, then sweeps, then notebooks."""
    return paths_of_example_brakes() | paths_of_example_sweeps() | paths_of_example_notebooks()


def titles_of_all_examples() -> dict[str, str]:
    """The title of each example by its name; the title of a notebook is its first heading."""
    titles = {}
    for name, path in paths_of_all_examples().items():
        text = path.read_text(encoding="utf-8")
        if path.suffix == ".ipynb":
            lines = "".join(json.loads(text)["cells"][0]["source"]).splitlines()
            titles[name] = f"notebook: {lines[0].lstrip('# ')}"
        else:
            data = tomllib.loads(text)
            titles[name] = f"sweep: {data['title']}" if "vary" in data else data["title"]
    return titles


# The first pattern matches the first line of an example, which names the JSON schema. The second
# pattern matches a line with the path of a mesh file or of the brake of a sweep.
_PATTERN_OF_FIRST_LINE_THAT_NAMES_JSON_SCHEMA = re.compile(r"\A#:schema .*/(\w+\.schema\.json)\n")
_PATTERN_OF_LINE_WITH_MESH_OR_BRAKE_PATH = re.compile(r'(?m)^(mesh|brake) = "([^"]+)"')


def path_of_example(name: str) -> Path:
    """The path of an example. Raises BadInput for an unknown name."""
    paths = paths_of_all_examples()
    if name not in paths:
        raise BadInput(
            f"NAME = {name!r}: no such example{did_you_mean_hint(name, paths)}; "
            f"allowed: {', '.join(paths)}"
        )
    return paths[name]


def text_of_example(name: str) -> str:
    """The text of an example with absolute paths of other files, so that any folder may hold it.

    The line that names the JSON schema is left out, since other folders have no such file. Raises
    BadInput for an unknown name of an example.
    """
    path = path_of_example(name)

    def mesh_or_brake_line_with_absolute_path(line: re.Match[str]) -> str:
        """The line `mesh = ...` or `brake = ...` with the absolute path of the file."""
        return f'{line[1]} = "{(path.parent / line[2]).resolve().as_posix()}"'

    text = _PATTERN_OF_LINE_WITH_MESH_OR_BRAKE_PATH.sub(
        mesh_or_brake_line_with_absolute_path, path.read_text(encoding="utf-8")
    )
    return _PATTERN_OF_FIRST_LINE_THAT_NAMES_JSON_SCHEMA.sub("", text)


def write_example_with_its_files(name: str, folder: Path) -> list[Path]:
    """Write an example into a folder, with its meshes, the brake of a sweep and the JSON schema.

    All paths in the written files are relative, so that the folder may be moved. Returns the paths
    of the written files. Raises BadInput for an unknown name, and for a file that exists already.
    """
    path = path_of_example(name)
    # The file of the example gets the name of the example. If a sweep names a brake file, this file
    # gets the name of the example that it belongs to. Mesh files keep their names.
    texts = {name + path.suffix: path.read_text(encoding="utf-8")}
    for target, text in list(texts.items()):
        _add_files_of_example(texts, target, text, path.parent)
    for target in texts:
        if (folder / target).exists():
            raise BadInput(f"{folder / target}: exists already; give another folder")
    for target, text in texts.items():
        write_new_text_file(folder / target, text)
    return [folder / target for target in texts]


def _add_files_of_example(texts: dict[str, str], target: str, text: str, base: Path) -> None:
    """Add the files that an example names to `texts`, and make the paths in its text relative.

    Parameters
    ----------
    texts : texts of the files by their names; files are added and texts are changed
    target : name of the file of the example
    text : text of the example
    base : folder to which the paths in the text are relative
    """
    names = {path.resolve(): name for name, path in paths_of_example_brakes().items()}

    def mesh_or_brake_line_without_folder(line: re.Match[str]) -> str:
        """The line `mesh = ...` or `brake = ...` with the name of the file in the same folder."""
        source = (base / line[2]).resolve()
        name = f"{names[source]}.toml" if line[1] == "brake" else source.name
        if name not in texts:
            texts[name] = source.read_text(encoding="utf-8")
            _add_files_of_example(texts, name, texts[name], source.parent)
        return f'{line[1]} = "{name}"'

    schema = _PATTERN_OF_FIRST_LINE_THAT_NAMES_JSON_SCHEMA.match(text)
    if schema is not None:
        source = FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES / "studies" / schema[1]
        texts[schema[1]] = source.read_text(encoding="utf-8")
        text = f"#:schema {schema[1]}\n{text[schema.end() :]}"
    if target.endswith(".toml"):
        texts[target] = _PATTERN_OF_LINE_WITH_MESH_OR_BRAKE_PATH.sub(
            mesh_or_brake_line_without_folder, text
        )


def paths_of_drumlin_studies() -> dict[str, Path]:
    """The paths study.py of drumlin's own studies by their names."""
    files = sorted(
        (FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES / "studies").glob("*/study.py")
    )
    return {file.parent.name: file for file in files}


def docstring_first_lines_of_drumlin_studies() -> dict[str, str]:
    """The first line of the docstring of each of drumlin's own studies, by name.

    The studies are read and not run.
    """
    found = {}
    for name, file in paths_of_drumlin_studies().items():
        text = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
        found[name] = text.partition("\n")[0]
    return found


def import_study_and_find_folder_above_studies(name: str) -> tuple[ModuleType, Path]:
    """Import a study; returns its module, and the folder in which the folder studies/ lies.

    `name` is the name of one of drumlin's own studies, or a path such as ./studies/NAME or
    studies/NAME/study.py. A study of somebody else must be given by its path, because its code is
    run. Raises BadInput, which lists drumlin's own studies, if there is no such study.
    """
    # Code in the current folder is never run by a name alone: it must be given by its path.
    own = paths_of_drumlin_studies()
    file = own.get(name)
    if file is None and len(Path(name).parts) > 1:
        # Symbolic links are not resolved: studies/ must be a folder of the path as it was given.
        given = Path(os.path.abspath(name))  # noqa: PTH100
        file = given if given.name == "study.py" else given / "study.py"
    # For a name with a NUL character os.path.isfile returns False; Path.is_file raises an error.
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


def _require_packages_of_study(name: str) -> None:
    """Raise NoAnswer, with the extra to install, if a package that a study needs is missing."""
    package = OPTIONAL_PACKAGE_BY_STUDY_NAME.get(name)
    if package is not None and importlib.util.find_spec(package) is None:
        raise NoAnswer(
            f"study {name}: needs the package {package!r}, which is not installed: "
            f'pip install "drumlin[{name}]"'
        )


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
    _require_packages_of_study(name)
    module, root = import_study_and_find_folder_above_studies(name)
    # A study without a journal computes all cases in each run.
    folder = folder or Path("reports") / module.__name__.split(".")[1]
    if "journal" not in inspect.signature(module.study).parameters:
        page: Path = module.report(module.study(short=short, say=say), folder)
        return page
    # A study with a journal continues an earlier run that was stopped.
    path = folder / ("journal-short.jsonl" if short else "journal.jsonl")
    with JournalOfCaseResults(
        path, checksum_of_source_and_libraries(root / "studies", DRUMLIN_STUDIES_PACKAGE_FOLDER)
    ) as journal:
        for line in journal.notes:
            say(line)
        if len(journal):
            say(f"going on after {len(journal)} finished cases")
        page = module.report(module.study(short=short, say=say, journal=journal), folder)
        journal.close_and_rename_complete_journal()
    return page
