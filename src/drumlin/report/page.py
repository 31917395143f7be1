"""One self-contained HTML page: text, figures, tables, sources, with versions and machine at its foot."""

import base64
import datetime
import importlib.metadata
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

    @property
    def source(self) -> str:
        """The picture as a data URI."""
        data = base64.b64encode(self.path.read_bytes()).decode()
        return f"data:{_MEDIA[self.path.suffix]};base64,{data}"


@dataclass(frozen=True)
class Table:
    """Rows as dictionaries in SI; the columns say how people read them. Columns that no row has are left out."""

    rows: Sequence[dict[str, Any]]
    columns: Sequence[Column]
    caption: str

    @property
    def shown(self) -> list[Column]:
        """The columns that some row fills."""
        return [column for column in self.columns if any(row.get(column.key) is not None for row in self.rows)]

    def words(self, column: Column) -> bool:
        """Whether a column holds words, and its heading stands on their side."""
        return any(isinstance(row.get(column.key), str) for row in self.rows)


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


def write_page(path: Path, title: str, lead: str, sections: Sequence[Section]) -> None:
    """Write the page whole or not at all; everything that it shows is inside it."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("drumlin", "report"), autoescape=True, trim_blocks=True, lstrip_blocks=True
    )
    environment.tests["kind"] = lambda block, name: type(block).__name__ == name
    text = environment.get_template("page.html").render(
        title=title,
        lead=lead,
        sections=sections,
        versions=versions(),
        date=datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d"),
        command=" ".join(["drumlin", *sys.argv[1:]]),
    )
    write_text(path, text)
