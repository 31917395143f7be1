"""One self-contained HTML page: text, figures, tables, sources, with versions and machine at its
foot.
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
from drumlin.comparison import Column

_MEDIA = {".svg": "image/svg+xml", ".png": "image/png", ".gif": "image/gif"}


LEAST_SECTIONS = 3  # from which on a page has a list of them
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


_PERCENT = re.compile(r"(?<=[0-9]) %")


def fill(template: Path, page: Path, **values: Any) -> Path:
    """Fill a jinja template with values and write the page whole or not at all; returns `page`.

    The template extends base.html (blocks title, lead, body) and imports what it needs of
    blocks.html: figure, table, source, fields; pictures are files beside the page and are embedded.
    In it `Column` makes a table's column, `pi` is there, the filter `form` writes a number: {{
    error|form("+.1%") }}, and `tex` a formula: {{ tex("p_0") }}. Values are escaped; a number and
    its % stay on one line. Figures and tables are numbered; the sections (h2) get a list of links.

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
    environment.filters["form"] = formatted
    count: Counter[str] = Counter()

    def numbered(kind: str) -> Markup:
        count[kind] += 1
        return Markup("<b>{} {}.</b>").format(kind, count[kind])

    environment.globals |= {
        "numbered": numbered,
        "tex": typeset,
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
    write_text(page, with_contents(_PERCENT.sub("\N{NO-BREAK SPACE}%", text)))
    return page


def typeset(source: str) -> Markup:
    """A formula in LaTeX as MathML, which browsers typeset."""
    return Markup(latex2mathml.converter.convert(source))


_HEADING = re.compile(r"<h2>(.*?)</h2>", re.DOTALL)


def with_contents(text: str) -> str:
    """A page whose sections can be linked, with their list after its lead where there are some."""
    titles = [striptags(title) for title in _HEADING.findall(text)]
    names = [
        re.sub(r"[^a-z0-9]+", "-", html.unescape(title).lower()).strip("-") for title in titles
    ]
    names = [
        name if name and names.index(name) == i else f"{name}-{i + 1}"
        for i, name in enumerate(names)
    ]
    each = iter(names)
    text = _HEADING.sub(
        lambda found: f'<h2 id="{(name := next(each))}"><a href="#{name}">{found[1]}</a></h2>', text
    )
    if len(titles) < LEAST_SECTIONS:
        return text
    links = "".join(
        f'<li><a href="#{name}">{title}</a></li>' for name, title in zip(names, titles, strict=True)
    )
    return text.replace(
        "<!-- contents -->", f'<nav aria-label="Contents"><ul>{links}</ul></nav>', 1
    )


def striptags(text: str) -> str:
    """A piece of HTML without its tags."""
    return re.sub(r"<[^>]*>", "", text).strip()
