"""One self-contained HTML page: text, figures, tables, sources, with versions and machine at its foot."""

import base64
import datetime
import importlib.metadata
import math
import os
import platform
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jinja2

import drumlin
from drumlin.comparison import Column
from drumlin.files import write_text

_MEDIA = {".svg": "image/svg+xml", ".png": "image/png", ".gif": "image/gif"}


@dataclass(frozen=True)
class Text:
    """A paragraph; `html` may hold inline markup and comes from the program, never from a brake file."""

    html: str


@dataclass(frozen=True)
class Figure:
    """A picture file, embedded in the page."""

    path: Path
    caption: str


@dataclass(frozen=True)
class Table:
    """Rows as dictionaries in SI; the columns say how people read them. Columns that no row has are left out."""

    rows: Sequence[dict[str, Any]]
    columns: Sequence[Column]
    caption: str


@dataclass(frozen=True)
class Source:
    """A file shown as it is."""

    name: str
    text: str


@dataclass(frozen=True)
class Section:
    """A heading and what stands under it."""

    heading: str
    blocks: Sequence[Text | Figure | Table | Source]


PACKAGES = ("numpy", "scipy", "scikit-fem", "meshio", "pyvista", "matplotlib")


def versions() -> dict[str, str]:
    """Versions of drumlin, Python and the packages that make the numbers, and the machine."""
    found = {"drumlin": drumlin.__version__, "Python": platform.python_version()}
    found.update({name: importlib.metadata.version(name) for name in PACKAGES})
    found["machine"] = f"{platform.machine()}, {os.cpu_count()} cores, {platform.system()}"
    return found


def embedded(path: Path) -> str:
    """A picture file as a data URI."""
    return f"data:{_MEDIA[path.suffix]};base64,{base64.b64encode(path.read_bytes()).decode()}"


def filled(rows: Sequence[dict[str, Any]], columns: Sequence[Column]) -> list[Column]:
    """The columns that some row fills."""
    return [column for column in columns if any(row.get(column.key) is not None for row in rows)]


def of_words(rows: Sequence[dict[str, Any]], column: Column) -> bool:
    """Whether a column holds words, and its heading stands on their side."""
    return any(isinstance(row.get(column.key), str) for row in rows)


def fill(template: Path, page: Path, **values: Any) -> Path:
    """Fill a jinja template with values and write the page whole or not at all; returns `page`.

    The template extends base.html (blocks title, lead, body) and imports what it needs of blocks.html: figure, table,
    source, fields; pictures are files beside the page and are embedded. In it `Column` makes a table's column, `pi` is
    there, and the filter `form` writes a number: {{ error|form("+.1%") }}. Values are escaped.

    Raises jinja2.UndefinedError where the template asks for what is not given.
    """
    environment = jinja2.Environment(
        loader=jinja2.ChoiceLoader(
            [jinja2.PackageLoader("drumlin", "report"), jinja2.FileSystemLoader(template.parent)]
        ),
        undefined=jinja2.StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["form"] = format
    environment.tests["kind"] = lambda block, name: type(block).__name__ == name
    environment.globals |= {
        "embedded": lambda name: embedded(page.parent / name),
        "filled": filled,
        "of_words": of_words,
        "Column": Column,
        "pi": math.pi,
    }
    text = environment.get_template(template.name).render(
        **values,
        versions=versions(),
        date=datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d"),
        command=" ".join(["drumlin", *sys.argv[1:]]),
    )
    write_text(page, text)
    return page


def write_page(path: Path, title: str, lead: str, sections: Sequence[Section]) -> None:
    """A page whose sections are given as data."""
    fill(Path(__file__).with_name("sections.html"), path, title=title, lead=lead, sections=sections)
