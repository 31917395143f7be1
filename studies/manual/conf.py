"""Settings of Sphinx for the manual, which loads nothing from another machine."""

import sys
from html import escape
from pathlib import Path
from typing import Any

import latex2mathml.converter
from studies.manual.docstrings import is_field_of_named_tuple, prepare_docstring

import drumlin

sys.setrecursionlimit(5000)  # long pages of the API
project = "drumlin"
author = "the drumlin authors"
version = release = drumlin.__version__
html_title = f"drumlin {version}"
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
exclude_patterns: list[str] = []
default_role = "py:obj"  # a name in back quotes is a link if the manual has a page of this name
myst_enable_extensions = ["colon_fence", "dollarmath", "amsmath", "deflist"]
myst_heading_anchors = 3
nb_execution_mode = "force"
# The notebooks are kept with their outputs, which a test computes anew.
nb_execution_excludepatterns = ["notebooks/*"]
nb_execution_timeout = 300
nb_execution_show_tb = True
nb_merge_streams = True
nb_execution_in_temp = True  # each page runs in an empty folder, as a reader's would
# Field names that several classes have, such as pressure, are no faults of a page (ref.python).
suppress_warnings = ["mystnb.unknown_mime_type", "ref.python"]
autodoc_default_options = {"members": True, "undoc-members": False}
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_member_order = "bysource"
napoleon_numpy_docstring = True
napoleon_google_docstring = False
napoleon_use_ivar = True  # fields are listed once, below their class
html_theme = "furo"
html_copy_source = False
html_show_sourcelink = False
html_show_copyright = False
html_use_index = False
html_css_files = ["manual.css"]
html_js_files = ["copy.js"]
html_static_path = ["static"]
# A search lists pages of modules last. Sphinx opens the file from the current folder.
html_search_scorer = str(Path(__file__).with_name("static") / "scorer.js")
html_math_renderer = "mathml"


def _formula_as_mathml(text: str, display: str) -> str:
    """TeX as MathML, which browsers draw by themselves."""
    return str(latex2mathml.converter.convert(text, display=display))


def _write_inline_formula(writer: Any, node: Any) -> None:
    """Write a formula that stands in a line of text."""
    from docutils import nodes  # noqa: PLC0415

    writer.body.append(_formula_as_mathml(node.astext(), "inline"))
    raise nodes.SkipNode


def _write_displayed_formula(writer: Any, node: Any) -> None:
    """Write a formula that stands in a line of its own, with its number."""
    from docutils import nodes  # noqa: PLC0415

    number = f'<span class="eqno">({node["number"]})</span>' if node.get("number") else ""
    for line in node.astext().split("\n\n"):
        writer.body.append(f'<div class="math">{number}{_formula_as_mathml(line, "block")}</div>')
    if not node.astext().strip():
        writer.body.append(escape(""))
    raise nodes.SkipNode


def _show_commands_and_files_as_readers_write_them(app: Any, page: Any) -> None:
    """Change the examples of a page into text that a reader can copy.

    An example that runs `!drumlin` shows the command as a terminal takes it, without the mark of
    notebooks. An example that writes a file by `%%writefile` shows its text, below a comment with
    the name of the file. The notebooks keep their cells.
    """
    from docutils import nodes  # noqa: PLC0415

    if app.env.docname.startswith("notebooks/"):
        return
    for cell in page.findall(nodes.literal_block):
        lines = cell.astext().splitlines()
        if "cell_input" not in cell.parent.get("classes", []) or not lines:
            continue
        if all(line.startswith("!") for line in lines):
            lines, cell["language"] = [line[1:] for line in lines], "sh"
        elif lines[0].startswith("%%writefile "):
            lines[0] = f"# {lines[0].split()[1]}"
            cell["language"] = "toml"
        cell.children = [nodes.Text("\n".join(lines))]


def setup(app: Any) -> None:
    """Register the renderer of formulas, and what changes docstrings and examples."""
    app.connect("doctree-read", _show_commands_and_files_as_readers_write_them)
    # napoleon reads docstrings at the default priority, 500.
    app.connect("autodoc-process-docstring", prepare_docstring, priority=400)
    app.connect("autodoc-skip-member", is_field_of_named_tuple)
    app.add_html_math_renderer(
        "mathml", (_write_inline_formula, None), (_write_displayed_formula, None)
    )
