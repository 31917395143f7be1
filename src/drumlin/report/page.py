"""Writing of an HTML page as a single file: text, figures, tables and sources.

The foot of the page names the versions of the software and the machine.
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
from contextlib import suppress
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup

import drumlin
from drumlin.base.files import write_text
from drumlin.base.texts import command_text_without_folders, number_as_text
from drumlin.comparison import ResultTableColumn

_MEDIA_TYPE_OF_PICTURE_SUFFIX = {".svg": "image/svg+xml", ".png": "image/png", ".gif": "image/gif"}
"""The media type of a picture file, by the ending of its name."""

LEAST_SECTIONS_FOR_CONTENTS_LIST = 3
"""Smallest number of sections at which a page gets a list of its contents."""

PACKAGES_WITH_RECORDED_VERSION = ("numpy", "scipy", "scikit-fem", "meshio", "pyvista", "matplotlib")
"""The packages whose versions a page names: they compute the results and draw the pictures."""


def software_versions() -> dict[str, str]:
    """The versions of drumlin, Python and the recorded packages, and a description of this machine.

    A package of an extra that is not installed, such as pyvista, is left out.
    """
    found = {"drumlin": drumlin.__version__, "Python": platform.python_version()}
    for name in PACKAGES_WITH_RECORDED_VERSION:
        with suppress(importlib.metadata.PackageNotFoundError):
            found[name] = importlib.metadata.version(name)
    found["machine"] = f"{platform.machine()}, {os.cpu_count()} cores, {platform.system()}"
    return found


def picture_data_uri(path: Path) -> str:
    """A picture file as a data URI, a text by which an HTML page contains the picture itself."""
    media_type = _MEDIA_TYPE_OF_PICTURE_SUFFIX[path.suffix]
    return f"data:{media_type};base64,{base64.b64encode(path.read_bytes()).decode()}"


def table_columns_with_value_in_any_row(
    rows: Sequence[dict[str, Any]], columns: Sequence[ResultTableColumn]
) -> list[ResultTableColumn]:
    """The columns of a table that have a value in at least one row."""

    def has_value_in_any_row(column: ResultTableColumn) -> bool:
        """Whether at least one row has a value in the column."""
        return any(row.get(column.key) is not None for row in rows)

    return list(filter(has_value_in_any_row, columns))


def is_text_column(rows: Sequence[dict[str, Any]], column: ResultTableColumn) -> bool:
    """Whether a table's column holds text; the heading of such a column is aligned to the left."""
    return any(isinstance(row.get(column.key), str) for row in rows)


_SPACE_BEFORE_PERCENT_PATTERN = re.compile(r"(?<=[0-9]) %")
"""The pattern of a space and a percent sign after a number; a page does not break lines there."""


def write_html_page(template: Path, page: Path, **values: Any) -> Path:
    """Fill a jinja template with values and write the page whole or not at all; returns `page`.

    The template extends base.html (blocks title, lead, body) and imports macros from blocks.html:
    figure, table, source, fields. A figure names a picture file beside the page; the picture is
    embedded into the page. In the template `Column` makes a table's column, and `pi` is defined.
    The filter `form` writes a number, {{ error|form("+.1%") }}, and the function `tex` writes a
    formula, {{ tex("p_0") }}. Values are escaped for HTML.

    A number and its % stay on one line. Figures and tables are numbered. A list of links to the
    sections (h2) is added. Raises jinja2.UndefinedError if the template asks for a value that is
    not given.
    """
    # Versions, date and command are printed at the foot of each page.
    text = (
        _jinja_environment_for_page(template, page)
        .get_template(template.name)
        .render(
            **values,
            versions=software_versions(),
            date=datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d"),
            command=command_text_without_folders(["drumlin", *sys.argv[1:]]),
        )
    )
    write_text(
        page,
        html_with_contents_list(_SPACE_BEFORE_PERCENT_PATTERN.sub("\N{NO-BREAK SPACE}%", text)),
    )
    return page


def _jinja_environment_for_page(template: Path, page: Path) -> jinja2.Environment:
    """The jinja environment of a page's template, with the functions and filters for templates.

    Pictures are looked for in the folder of `page`.
    """
    # Templates are looked for in this package first, then in the folder of the given template.
    own_templates = jinja2.PackageLoader("drumlin", "report")
    beside = jinja2.FileSystemLoader(template.parent)
    environment = jinja2.Environment(
        loader=jinja2.ChoiceLoader([own_templates, beside]),
        undefined=jinja2.StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["form"] = number_as_text
    count: Counter[str] = Counter()

    def next_figure_or_table_label(kind: str) -> Markup:
        """The label of the next figure or table, such as "Figure 2." if `kind` is "Figure"."""
        count[kind] += 1
        return Markup("<b>{} {}.</b>").format(kind, count[kind])

    environment.globals |= {
        "numbered": next_figure_or_table_label,
        "tex": formula_as_mathml,
        "embedded": lambda name: picture_data_uri(page.parent / name),
        "filled": table_columns_with_value_in_any_row,
        "of_words": is_text_column,
        "Column": ResultTableColumn,
        "pi": math.pi,
    }
    return environment


def formula_as_mathml(source: str) -> Markup:
    """A formula in LaTeX as MathML, which browsers typeset."""
    # Few pages have formulas, and the converter takes long to load.
    import latex2mathml.converter  # noqa: PLC0415

    return Markup(latex2mathml.converter.convert(source))


_SECTION_HEADING_PATTERN = re.compile(r"<h2>(.*?)</h2>", re.DOTALL)
"""The pattern of a section's heading in HTML."""


def html_with_contents_list(text: str) -> str:
    """The HTML of a page, with an anchor added to each section, and links to all sections.

    The list of links stands below the first paragraph of the page. Pages with fewer than
    LEAST_SECTIONS_FOR_CONTENTS_LIST sections get no list.
    """
    titles = list(map(text_without_html_tags, _SECTION_HEADING_PATTERN.findall(text)))
    names = _distinct_anchor_names_of_titles(titles)
    next_name = iter(names)

    def heading_with_link_to_itself(heading: re.Match[str]) -> str:
        """A section's heading in HTML with an anchor, and with a link to this anchor."""
        name = next(next_name)
        return f'<h2 id="{name}"><a href="#{name}">{heading[1]}</a></h2>'

    # Each heading becomes a link to itself, so that a reader can copy its address.
    text = _SECTION_HEADING_PATTERN.sub(heading_with_link_to_itself, text)
    if len(titles) < LEAST_SECTIONS_FOR_CONTENTS_LIST:
        return text
    links = "".join(map('<li><a href="#{}">{}</a></li>'.format, names, titles))
    contents = f'<nav aria-label="Contents"><ul>{links}</ul></nav>'
    return text.replace("<!-- contents -->", contents, 1)


def _distinct_anchor_names_of_titles(titles: Sequence[str]) -> list[str]:
    """A distinct name for the anchor of each section title.

    The name is the title in small letters with hyphens. If this name is empty or an earlier title
    has it, the number of the section is added at its end.
    """
    names: list[str] = []
    anchors = []
    for position, title in enumerate(titles, 1):
        name = re.sub(r"[^a-z0-9]+", "-", html.unescape(title).lower()).strip("-")
        is_new = name and name not in names
        names.append(name)
        anchors.append(name if is_new else f"{name}-{position}")
    return anchors


def text_without_html_tags(text: str) -> str:
    """The text of a piece of HTML, without tags and without spaces at its ends."""
    return re.sub(r"<[^>]*>", "", text).strip()
