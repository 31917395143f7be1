"""One self-contained HTML page: text, figures, tables, sources, with versions and machine at its foot."""

import base64
import datetime
import importlib.metadata
import math
import os
import platform
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import jinja2

import drumlin
from drumlin.comparison import Column
from drumlin.files import write_text
from drumlin.texts import typed

_MEDIA = {".svg": "image/svg+xml", ".png": "image/png", ".gif": "image/gif"}


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
        command=typed(["drumlin", *sys.argv[1:]]),
    )
    write_text(page, text)
    return page
