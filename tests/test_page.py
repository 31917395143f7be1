"""HTML pages filled from templates: escaping, embedded files, omitted parts, and refusals."""

import base64
import re
from itertools import starmap

import jinja2
import pytest

from conftest import ROOT
from drumlin.base.texts import number_as_text
from drumlin.report.page import write_html_page

TEMPLATE = """{% extends "base.html" %}
{% from "blocks.html" import figure, table, fields_by_vtk %}
{% block title %}{{ name }}{% endblock %}
{% block lead %}off by {{ error|form("+.1%") }}{% endblock %}
{% block body %}
{% call figure("dot.png") %}a <b>dot</b> of {{ name }}{% endcall %}
{% set first = Column("a", "first", "mm", 1e3, ".1f") %}
{% set columns = [first, Column("b", "second"), Column("c", "third")] %}
{% call table(rows, columns) %}rows{% endcall %}
{{ fields_by_vtk("none", "no screen") }}
{% endblock %}
"""


@pytest.fixture
def page(tmp_path):
    (tmp_path / "dot.png").write_bytes(b"dot")
    (tmp_path / "page.html").write_text(TEMPLATE)

    def made(**values):
        given = {
            "name": "<x> & y",
            "error": 0.0123,
            "rows": [{"a": 2e-3, "b": "<w>"}, {"shoe": "all"}],
        }
        return write_html_page(
            tmp_path / "page.html", tmp_path / "index.html", **(given | values)
        ).read_text()

    return made


def test_values_are_escaped_and_prose_is_not(page):
    text = page()
    assert "<title>&lt;x&gt; &amp; y</title>" in text and "<h1>&lt;x&gt; &amp; y</h1>" in text
    assert "<figcaption><b>Figure 1.</b> a <b>dot</b> of &lt;x&gt; &amp; y</figcaption>" in text
    assert 'alt="a dot of &lt;x&gt; &amp; y"' in text
    assert "off by +1.2\N{NO-BREAK SPACE}%" in text and "<p>no screen</p>" in text


def test_a_figure_beside_the_page_is_embedded(page):
    assert f"data:image/png;base64,{base64.b64encode(b'dot').decode()}" in page()


def test_a_column_that_no_row_fills_is_left_out(page):
    text = page()
    assert '<th>first <span class="unit">[mm]</span></th><th class="text">second</th></tr>' in text
    assert '<tr class=""><td>2.0</td><td class="text">&lt;w&gt;</td></tr>' in text
    assert '<tr class="whole"><td>–</td><td>–</td></tr>' in text
    assert '<tr class="failed"><td>1.0</td></tr>' in page(rows=[{"a": 1e-3, "status": "failed: x"}])


def test_what_is_not_given_is_an_error_and_leaves_no_page(page, tmp_path):
    (tmp_path / "page.html").write_text(
        TEMPLATE.replace("{{ name }}{% endcall %}", "{{ nmae }}{% endcall %}")
    )
    with pytest.raises(jinja2.UndefinedError, match="nmae"):
        page()
    assert not (tmp_path / "index.html").exists()


def test_a_large_number_has_no_exponent_and_keeps_its_digits():
    """A large number is printed without an exponent, and keeps its digits.

    Otherwise only some of the torques in a column would have an exponent.
    """
    given = (
        (238918.3, ".5g"),
        (85245.2, ".5g"),
        (2318.0, ".3g"),
        (-119290.0, "+.4g"),
        (2e9, ".3g"),
        (3e-7, ".2g"),
    )
    assert list(starmap(number_as_text, given)) == [
        "238920",
        "85245",
        "2320",
        "-119300",
        "2e+09",
        "3e-07",
    ]
    assert number_as_text(238918.3, ".1e") == "2.4e+05"


def test_every_percentage_is_written_alike():
    """Every percentage has a space before the % sign, unlike Python's own formats."""
    assert [
        number_as_text(x, form)
        for x, form in ((0.18, ".0%"), (-0.0123, "+.1%"), (-1e-9, "+.1%"), (0.5, ".1f"))
    ] == [
        "18 %",
        "-1.2 %",
        "0.0 %",
        "0.5",
    ]
    sources = [*ROOT.glob("src/drumlin/**/*.py"), *ROOT.glob("studies/**/*.py")]
    bare = {
        path.name for path in sources if re.search(r"\{[^{}\n]+:[-+,.0-9]*%\}", path.read_text())
    }
    assert not bare, "formatted(x, '.1%') writes it with its space"
