"""The paper as a Markdown file, in the form in which journals of software take papers."""

import html
import re

HEAD = """---
title: "drumlin: what the pressure laws of shoe brakes are worth"
tags: [Python, brakes, contact mechanics, friction, finite elements]
authors:
  - name: The drumlin developers
bibliography: paper.bib
---
"""
"""What a journal reads from the beginning of a paper."""

_CITED = re.compile(r"\((?:([A-Z]\w+)(?: and [A-Z]\w+)? )?(\d{4})\)")
"""A source in brackets: "(Day 2014)", or a year behind "Archard's law"."""


def paper_as_markdown(page: str) -> str:
    """The text of the built page as Markdown, with the keys of paper.bib in place of sources."""
    body = re.search(r"<main>(.*?)</main>", page, re.DOTALL)
    if body is None:
        raise ValueError("the page of the paper has no main part")
    parts = [HEAD]
    for kind, text in re.findall(r"<(h2|p|table)\b[^>]*>(.*?)</\1>", body[1], re.DOTALL):
        parts.append(_block_as_markdown(kind, text))
    return "\n\n".join([*parts, "# References\n"])


def _block_as_markdown(kind: str, text: str) -> str:
    """A heading, a paragraph or a table as Markdown."""
    if kind == "table":
        rows = []
        for row in re.findall(r"<tr[^>]*>(.*?)</tr>", text, re.DOTALL):
            cells = re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row, re.DOTALL)
            rows.append("| " + " | ".join(map(_plain_text, cells)) + " |")
        columns = rows[0].count("|") - 1
        return "\n".join([rows[0], "|" + " --- |" * columns, *rows[1:]])
    plain = _plain_text(text)
    return f"# {plain}" if kind == "h2" else _CITED.sub(_key_of_source, plain)


def _plain_text(text: str) -> str:
    """A text without tags, on one line; code keeps its back quotes."""
    text = re.sub(r"</?code>", "`", text)
    return " ".join(html.unescape(re.sub(r"<[^>]+>", "", text)).split())


def _key_of_source(found: re.Match[str]) -> str:
    """The key of paper.bib for a source that the text names."""
    return f"[@{(found[1] or 'Archard').lower()}{found[2]}]"
