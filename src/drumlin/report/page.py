"""One self-contained HTML page: text, figures, tables and sources.

The foot of the page names the versions and the machine.
"""

import base64
import datetime
import html
import importlib.metadata
import math
import os
import platform
import re
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import jinja2
import latex2mathml.converter
from markupsafe import Markup

import drumlin
from drumlin.base.files import write_text
from drumlin.base.texts import formatted, typed
from drumlin.comparison import TableColumn

_MEDIA = {".svg": "image/svg+xml", ".png": "image/png", ".gif": "image/gif"}

LEAST_SECTIONS = 3
"""Number of sections from which on a page lists them. Shorter pages are seen at a glance."""

RECORDED_PACKAGES = ("numpy", "scipy", "scikit-fem", "meshio", "pyvista", "matplotlib")
"""Packages that make the numbers and pictures, whose versions a page names."""


def versions() -> dict[str, str]:
    """The versions of drumlin, Python and the packages that make the numbers, and the machine."""
    found = {"drumlin": drumlin.__version__, "Python": platform.python_version()}
    found.update({name: importlib.metadata.version(name) for name in RECORDED_PACKAGES})
    found["machine"] = f"{platform.machine()}, {os.cpu_count()} cores, {platform.system()}"
    return found


def embedded(path: Path) -> str:
    """A picture file as a data URI."""
    return f"data:{_MEDIA[path.suffix]};base64,{base64.b64encode(path.read_bytes()).decode()}"


def filled(rows: Sequence[dict[str, Any]], columns: Sequence[TableColumn]) -> list[TableColumn]:
    """The columns that some row fills."""
    return [column for column in columns if any(row.get(column.key) is not None for row in rows)]


def of_words(rows: Sequence[dict[str, Any]], column: TableColumn) -> bool:
    """Whether a column holds words, so that its heading stands on their side."""
    return any(isinstance(row.get(column.key), str) for row in rows)


_PERCENT = re.compile(r"(?<=[0-9]) %")


def fill(template: Path, page: Path, **values: Any) -> Path:
    """Fill a jinja template with values and write the page whole or not at all; returns `page`.

    The template extends base.html (blocks title, lead, body) and imports from blocks.html what it
    needs: figure, table, source, fields. Pictures are files beside the page and are embedded. In
    the template `Column` makes a table's column, and `pi` is there. The filter `form` writes a
    number, {{ error|form("+.1%") }}, and `tex` a formula, {{ tex("p_0") }}. Values are escaped. A
    number and its % stay on one line. Figures and tables are numbered. The sections (h2) get a list
    of links.

    Raises jinja2.UndefinedError where the template asks for a value that is not given.
    """
    text = (
        _environment(template, page)
        .get_template(template.name)
        .render(
            **values,
            versions=versions(),
            date=datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d"),
            command=typed(["drumlin", *sys.argv[1:]]),
        )
    )
    write_text(page, with_contents(_PERCENT.sub("\N{NO-BREAK SPACE}%", text)))
    return page


def _environment(template: Path, page: Path) -> jinja2.Environment:
    """The functions and filters that a template can use for a page."""
    own_templates = jinja2.PackageLoader("drumlin", "report")
    beside = jinja2.FileSystemLoader(template.parent)
    environment = jinja2.Environment(
        loader=jinja2.ChoiceLoader([own_templates, beside]),
        undefined=jinja2.StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["form"] = formatted
    count: Counter[str] = Counter()

    def numbered(kind: str) -> Markup:
        """The next number of a kind, such as "Figure 2."."""
        count[kind] += 1
        return Markup("<b>{} {}.</b>").format(kind, count[kind])

    environment.globals |= {
        "numbered": numbered,
        "tex": typeset,
        "embedded": lambda name: embedded(page.parent / name),
        "filled": filled,
        "of_words": of_words,
        "Column": TableColumn,
        "pi": math.pi,
    }
    return environment


def typeset(source: str) -> Markup:
    """A formula in LaTeX as MathML, which browsers typeset."""
    return Markup(latex2mathml.converter.convert(source))


_HEADING = re.compile(r"<h2>(.*?)</h2>", re.DOTALL)


def with_contents(text: str) -> str:
    """A page whose sections can be linked; a list of LEAST_SECTIONS and more follows its lead."""
    titles = [striptags(title) for title in _HEADING.findall(text)]
    names = _anchors(titles)
    next_name = iter(names)

    def linked(heading: re.Match[str]) -> str:
        """A heading with its anchor and a link to itself."""
        name = next(next_name)
        return f'<h2 id="{name}"><a href="#{name}">{heading[1]}</a></h2>'

    text = _HEADING.sub(linked, text)
    if len(titles) < LEAST_SECTIONS:
        return text
    items = zip(names, titles, strict=True)
    links = "".join(f'<li><a href="#{name}">{title}</a></li>' for name, title in items)
    contents = f'<nav aria-label="Contents"><ul>{links}</ul></nav>'
    return text.replace("<!-- contents -->", contents, 1)


def _anchors(titles: Sequence[str]) -> list[str]:
    """Names for links to titles, all different: those that are not get a number."""
    names = []
    for title in titles:
        lower = html.unescape(title).lower()
        names.append(re.sub(r"[^a-z0-9]+", "-", lower).strip("-"))
    return [
        name if name and names.index(name) == i else f"{name}-{i + 1}"
        for i, name in enumerate(names)
    ]


def striptags(text: str) -> str:
    """A piece of HTML without its tags."""
    return re.sub(r"<[^>]*>", "", text).strip()
