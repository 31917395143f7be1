"""What is wrong on the built pages of the manual that Sphinx does not notice."""

import html
import re
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

_WRONG_TEXTS = {
    "a control code of a terminal": re.compile(
        r"[\x00-\x08\x0b\x0c\x0e-\x1f]|\[(?:\d+;)*\d+m|\?25[hl]"
    ),
    "a spinner": re.compile("[\u2800-\u28ff]"),
    "a figure that is not drawn": re.compile(r"<Figure size|<Axes: |<[\w.]+ object at 0x"),
    "a command of TeX": re.compile(r"</?m[ion]>\\"),
    "a mark of a notebook, which no terminal takes": re.compile(
        r"^(?:!\s*drumlin|%%\w)", re.MULTILINE
    ),
}
"""Texts that no page may have, by what they are."""

_PRINTED_BY_EXAMPLE = re.compile(r'class="output[^"]*stream.*?<pre>(.*?)</pre>', re.DOTALL)
"""The text that a command or a print of an executed example has left on a page."""

_FAILED_COMMAND = re.compile(r"^(?:drumlin: |Error: |Traceback |\S*sh: .*not found)", re.MULTILINE)
"""What a command of the shell prints where it fails: the notebook itself does not notice it."""

_TAG = re.compile(r"<(?!/?m[ion]>)[^>]*>")
"""A tag of HTML, but for the letters, numbers and signs of formulas."""


class Links(HTMLParser):
    """What a page points at and loads, and the places in it that others may point at."""

    def __init__(self, text: str) -> None:
        """Read the text of a page."""
        super().__init__()
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.places: set[str | None] = {""}
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note the address and the place of a tag."""
        found = dict(attrs)
        self.places.add(found.get("id"))
        if tag == "a" and found.get("href"):
            self.links.append(found["href"] or "")
        if tag in {"script", "img", "iframe"} and found.get("src"):
            self.loaded.append(found["src"] or "")
        if tag == "link" and found.get("rel") != "canonical":
            self.loaded.append(found["href"] or "")


def faults_of_built_pages(site: Path) -> list[str]:
    """A line for each wrong text, failed command, dead link and foreign address in `site`."""
    texts = {}
    for path in sorted(site.rglob("*.html")):
        texts[path.resolve()] = path.read_text(encoding="utf-8")
    pages = {path: Links(text) for path, text in texts.items()}
    faults = []
    for path, page in pages.items():
        name = path.relative_to(site.resolve()).as_posix()
        plain = html.unescape(_TAG.sub("", texts[path]))
        for what, pattern in _WRONG_TEXTS.items():
            if pattern.search(plain):
                faults.append(f"{name}: {what}")
        for printed in _PRINTED_BY_EXAMPLE.findall(texts[path]):
            if _FAILED_COMMAND.search(html.unescape(_TAG.sub("", printed))):
                faults.append(f"{name}: a command that fails")
        for address in page.loaded:
            if not _is_own_file(path, address):
                faults.append(f"{name}: loads {address}")
        for address in page.links:
            if not _leads_somewhere(path, address, pages):
                faults.append(f"{name}: dead link {address}")
    return faults


def _is_own_file(path: Path, address: str) -> bool:
    """Whether an address that the page `path` loads is a file of the site."""
    parts = urlsplit(address)
    return not parts.netloc and (not address or (path.parent / unquote(parts.path)).exists())


def _leads_somewhere(path: Path, address: str, pages: dict[Path, Links]) -> bool:
    """Whether a link of the page `path` leads to a file and a place of the site, or out of it."""
    parts = urlsplit(address)
    if parts.scheme or parts.netloc:
        return True
    target = path if not parts.path else (path.parent / unquote(parts.path)).resolve()
    known = pages.get(target)
    return target.exists() and (known is None or unquote(parts.fragment) in known.places)
