"""The manual's reference pages, read off the program.

Keys come from classes, commands from the command line, and names from docstrings.
"""

import ast
import inspect
import pkgutil
import re
from collections.abc import Iterator, Sequence
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic import Discriminator
from pydantic.fields import FieldInfo

import drumlin
import drumlin.door
from drumlin.brake.fields import PartOfInputFile, si_unit_of_field_type, si_units_of_table_field
from drumlin.brake.key_meanings import KEY_MEANINGS_OF_BRAKE_FILE_PARTS, KeyMeaningsOfPart
from drumlin.brake.units import EXAMPLE_OF_QUANTITY_BY_SI_UNIT, NAME_OF_QUANTITY_BY_SI_UNIT
from drumlin.foundation.model import INCLUDABLE_EFFECTS
from drumlin.models import MODELS
from drumlin.sweeps.key_meanings import MEANINGS_OF_SWEEP_FILE_KEYS
from drumlin_studies.ladder import ALL_KNOWN_ANSWER_CASES

ROOT = Path(__file__).resolve().parents[2]
PAGES = Path(__file__).parent / "pages"

ROOMS_WITH_PAGES = ("comparison", "contact", "fem", "laws", "response")
"""The rooms of the package whose modules all have a page, for researchers who call them."""


def markdown_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return (
        "\n".join(
            "| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in lines
        )
        + "\n"
    )


# keys of files


def brake_file_page() -> str:
    """The keys of the brake file, below an example."""
    return _example_file("double_shoe/brake.toml") + _key_tables(KEY_MEANINGS_OF_BRAKE_FILE_PARTS)


def sweep_file_page() -> str:
    """The keys of the sweep file, below an example."""
    return _example_file("sweeps/loads.toml") + _key_tables(MEANINGS_OF_SWEEP_FILE_KEYS)


def _example_file(name: str) -> str:
    """The text of an example file as a block of code."""
    return f"```toml\n{(ROOT / 'studies' / name).read_text(encoding='utf-8')}```\n\n"


def _key_tables(tables: Sequence[KeyMeaningsOfPart]) -> str:
    """A heading and a table of keys for each part of a file."""
    head = ("key", "value", "meaning")
    return "\n".join(
        f"## {heading}\n\n{markdown_table(head, _key_rows(kind, words))}"
        for heading, kind, words in tables
    )


def _key_rows(kind: type[PartOfInputFile], meanings: dict[str, str]) -> list[tuple[str, str, str]]:
    """A row for each key of a part.

    Raises KeyError for a key without a meaning, ValueError for a meaning without a key.
    """
    fields = {}
    for name, field in kind.model_fields.items():
        fields[field.alias or name] = field
    if unknown := set(meanings) - set(fields):
        raise ValueError(f"{kind.__name__}: has no key {sorted(unknown)}")
    rows: list[tuple[str, str, str]] = []
    for key, field in fields.items():
        rows.append((f"`{key}`", _value_in_words(field), meanings[key]))
    return rows


def _value_in_words(field: FieldInfo) -> str:
    """The values that a key takes, and its default, in words."""
    annotation = (
        Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
    )
    said = _kind_of_value(annotation)
    said += "".join(f", {words}" for words in _limits_in_words(annotation))
    if field.is_required():
        return f"{said}; required"
    default = field.get_default(call_default_factory=True)
    plain = isinstance(default, str | int | float) and not isinstance(default, bool)
    return f"{said}; default `{default}`" if plain else f"{said}; may be left out"


def _kind_of_value(annotation: Any) -> str:
    """The kind of value that a key takes, in words."""
    words = _allowed_words(annotation)
    if words:
        return " or ".join(f'`"{word}"`' for word in words)
    unit, row = si_unit_of_field_type(annotation), si_units_of_table_field(annotation)
    rows = (
        f'rows like `["{EXAMPLE_OF_QUANTITY_BY_SI_UNIT[row[0]]}", '
        f'"{EXAMPLE_OF_QUANTITY_BY_SI_UNIT[row[1]]}"]`'
        if row
        else ""
    )
    plain = _plain_types(annotation)
    if unit is not None and not rows:
        said = (
            f"{NAME_OF_QUANTITY_BY_SI_UNIT[unit]} such as "
            f'`"{EXAMPLE_OF_QUANTITY_BY_SI_UNIT[unit]}"`'
            if unit
            else "a number"
        )
        if not unit and str in plain:
            said += ", or a quantity with its unit"
        if any(isinstance(each, type) and issubclass(each, PartOfInputFile) for each in plain):
            said += " or a table"
        return f"a list; each value {said}" if tuple in plain else said
    if rows:
        said = (
            f"{NAME_OF_QUANTITY_BY_SI_UNIT[unit]} such as "
            f'`"{EXAMPLE_OF_QUANTITY_BY_SI_UNIT[unit]}"`, or '
            if unit
            else ""
        )
        return f"{said}{rows}"
    for kind, said in (
        (bool, "`true` or `false`"),
        (int, "a whole number"),
        (str, "a text"),
        (Path, "a path"),
    ):
        if kind in plain:
            return said
    return "a list" if plain & {tuple, list} else "a table"


def _plain_types(annotation: Any) -> set[Any]:
    """The plain types in an annotation."""
    if get_origin(annotation) is None:
        return {annotation}
    return {get_origin(annotation)} | {
        kind for part in get_args(annotation) for kind in _plain_types(part)
    }


def _allowed_words(annotation: Any) -> tuple[str, ...]:
    """The words that an annotation allows, where it allows only certain words."""
    if get_origin(annotation) is Literal:
        return tuple(map(str, get_args(annotation)))
    return next((found for part in get_args(annotation) if (found := _allowed_words(part))), ())


def _limits_in_words(annotation: Any) -> Iterator[str]:
    """The limits of a number, in words."""
    marks = [
        m for mark in _annotations_of(annotation) for m in (mark, *getattr(mark, "metadata", ()))
    ]
    for name, sign in (("gt", ">"), ("ge", "≥"), ("lt", "<"), ("le", "≤")):
        for mark in marks:
            if getattr(mark, name, None) is not None:
                yield f"{sign} {getattr(mark, name):g}"


def _annotations_of(annotation: Any) -> tuple[Any, ...]:
    """The annotations of a type, or of each of its alternatives."""
    own = getattr(annotation, "__metadata__", ())
    # The mark that tells a table from a number says nothing about the number.
    if own and not any(isinstance(mark, Discriminator) for mark in own):
        return tuple(own)
    choices = get_args(annotation.__origin__ if own else annotation)
    return tuple(mark for part in choices for mark in _annotations_of(part))


# commands


def commands_page() -> str:
    """The page of the commands, with all their options."""
    import typer  # noqa: PLC0415

    from drumlin.cli.commands import app  # noqa: PLC0415

    # The commands as the command line itself has them.
    made = typer.main.get_command(app)
    parts = []
    for name, command in made.commands.items():  # type: ignore[attr-defined]
        given = []
        for p in command.params:
            if not p.opts[0].startswith("-"):
                given.append(p)
        options = []
        for p in command.params:
            if p.opts[0].startswith("-") and p.name != "help":
                options.append(p)
        words = " ".join(p.metavar or p.name.upper() for p in given)
        parts.append(f"## `drumlin {name} {words}`\n\n{inspect.cleandoc(command.help or '')}\n")
        rows = []
        for p in [*given, *options]:
            rows.append((_option_names(p), _help_text(p.help), _default_in_words(p)))
        parts.append(markdown_table(("argument or option", "meaning", "default"), rows))
    return "\n".join(parts)


def _option_names(param: Any) -> str:
    """The names of an option with the word for its value, or the name of an argument."""
    names = param.opts if param.opts[0].startswith("-") else [param.metavar or param.name.upper()]
    other = [*names, *param.secondary_opts]
    flag = getattr(param, "is_flag", False) or not param.opts[0].startswith("-")
    value = "" if flag else f" `{param.metavar or param.name.upper()}`"
    return " or ".join(f"`{name}`" for name in other) + value


def _help_text(text: str | None) -> str:
    """The help of an option without the escapes of the terminal."""
    return (text or "").replace("\\[", "[")


def _default_in_words(param: Any) -> str:
    """The default of an option, or "required"; empty where nothing is the default."""
    value = param.default
    if param.required:
        return "required"
    return "" if value is None or value is False or callable(value) else f"`{value}`"


# laws, and the ladder


def models_page() -> str:
    """Tables of the models, and of the simplifications of the foundation model."""
    rows = []
    for name, model in MODELS.items():
        rows.append((f"`{name}`", model.assumes))
    lifts = []
    for name, words in INCLUDABLE_EFFECTS.items():
        lifts.append((f"`{name}`", words))
    heading = "\n## Simplifications that `--lift` removes\n\n"
    return (
        markdown_table(("model", "assumes"), rows)
        + heading
        + markdown_table(("name", "in place of"), lifts)
    )


def ladder_page() -> str:
    """The table of all cases of the ladder."""
    rows = []
    for case in ALL_KNOWN_ANSWER_CASES:
        rows.append(
            (
                case.family,
                case.shows,
                case.quantity,
                f"{case.expected:.6g}",
                f"{case.tolerance:.0e}",
                case.tier,
                case.source,
            )
        )
    return markdown_table(
        ("case", "judges", "quantity", "known answer", "tolerance", "tier", "source"), rows
    )


# names


def api_pages() -> dict[str, str]:
    """The texts of the pages on Python, by their names below pages/.

    Each name of `import drumlin` has a page, and so has each module that an example of the manual
    imports, or that belongs to the rooms of a researcher. The other modules are in a table.
    """
    used = _modules_in_examples()
    pages = {}
    rows = []
    for name in drumlin.__all__:
        if name[0] == "_":
            continue
        value = getattr(drumlin, name)
        kind = "class" if inspect.isclass(value) else "function"
        page = _page_of_object(f"drumlin.{name}", kind)
        for result in _classes_of_results_in_docstring(value) if kind == "function" else ():
            page += f"\n.. autoclass:: drumlin.door.{result}\n"
        pages[f"reference/api/{name}.rst"] = page
        rows.append((f"[`{name}`](api/{name}.rst)", _first_line(value)))
    names = [Path(page).stem for page in pages]
    modules = []
    for module in public_modules():
        first = _first_line(import_module(module))
        has_members = bool(public_members(module))
        if module in used or (has_members and module.split(".")[1] in ROOMS_WITH_PAGES):
            pages[f"reference/api/{module}.rst"] = _page_of_inner_module(module)
            modules.append((f"[`{module}`](api/{module}.rst)", first))
        elif has_members:
            modules.append((f"`{module}`", first))
    tree = "\n".join(["```{toctree}", ":hidden:", *(f"api/{name}" for name in names), "```"])
    pages["reference/api.md"] = (
        f"## `import drumlin`\n\n{markdown_table(('name', 'what it does'), rows)}\n"
        f"## Modules\n\n{markdown_table(('module', 'what it holds'), modules)}\n{tree}\n"
    )
    return pages


def _classes_of_results_in_docstring(function: Any) -> list[str]:
    """The names of the classes of drumlin.door that a function's docstring names, each once.

    These classes have no other page: they are described on the page of the function.
    """
    words = re.findall(r"\w+", inspect.getdoc(function) or "")
    found = []
    for name in dict.fromkeys(words):
        value = getattr(drumlin.door, name, None)
        if inspect.isclass(value) and value.__module__ == "drumlin.door":
            found.append(name)
    return found


def _modules_in_examples() -> set[str]:
    """The names of the modules that the examples of the manual's pages import."""
    found = set()
    for page in PAGES.rglob("*.md"):
        text = page.read_text(encoding="utf-8")
        found |= set(re.findall(r"(?m)^(?:from|import) (drumlin\.[\w.]+)", text))
    return found


def _page_of_object(name: str, kind: str) -> str:
    """The page of a function, a class or a module, which autodoc fills from its docstrings."""
    return f"{name}\n{'=' * len(name)}\n\n.. auto{kind}:: {name}\n"


def _page_of_inner_module(name: str) -> str:
    """The page of a module. It is in the table of the API, but not in the menu of every page."""
    back = ":doc:`All functions and modules </reference/api>`\n\n"
    title, _, content = _page_of_object(name, "module").partition("\n\n")
    return f":orphan:\n\n{title}\n\n{back}{content}"


def _first_line(value: Any) -> str:
    """The first line of a docstring."""
    return (inspect.getdoc(value) or "").splitlines()[0]


def public_modules() -> list[str]:
    """Names of the public modules: all but those of the command line, of checks and of reports."""
    aside = {"cli", "verification", "peers", "report", "explore"}
    found = pkgutil.walk_packages(drumlin.__path__, "drumlin.")
    return sorted(info.name for info in found if info.name.split(".")[1] not in aside)


def public_members(module: str) -> list[tuple[str, Any]]:
    """Public functions and classes that a module defines, in its order."""
    made = import_module(module)
    tree = ast.parse(inspect.getsource(made))
    kinds = (ast.FunctionDef, ast.ClassDef)
    found: list[tuple[str, Any]] = []
    for node in tree.body:
        if isinstance(node, kinds) and node.name[0] != "_":
            found.append((node.name, getattr(made, node.name)))
    return found
