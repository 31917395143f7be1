"""Each name of a class or of a module constant has one meaning in the whole source."""

import ast
from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from conftest import ROOT

MOST_ALLOWED = 10
"""Names that may keep two meanings. More than these would make the rule one of many exceptions."""

ALLOWED: dict[str, str] = {}
"""Names that stand for two things on purpose, each with the reason why no better name exists."""

STILL_DOUBLE: set[str] = set()
"""Names that await a better one. A name leaves this list with its second meaning."""


def constants(statement: ast.stmt) -> Iterator[str]:
    """Names of the constants that a statement of a module assigns: those in capitals."""
    targets: list[ast.expr] = []
    if isinstance(statement, ast.Assign):
        targets = statement.targets
    elif isinstance(statement, ast.AnnAssign):
        targets = [statement.target]
    for target in targets:
        for node in ast.walk(target):
            if isinstance(node, ast.Name) and node.id.lstrip("_").isupper():
                yield node.id


def names(text: str) -> Iterator[str]:
    """Names of the classes and of the module constants in the text of a module."""
    tree = ast.parse(text)
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef):
            yield node.name
    for statement in tree.body:
        yield from constants(statement)


def places(root: Path) -> dict[str, list[str]]:
    """The files of each name in the source of both packages."""
    found: dict[str, list[str]] = defaultdict(list)
    for path in sorted(root.rglob("*.py")):
        # A constant that a module assigns in both branches of a condition counts once.
        for name in sorted(set(names(path.read_text(encoding="utf-8")))):
            found[name].append(path.relative_to(root).as_posix())
    return found


@cache
def doubles(root: Path) -> dict[str, list[str]]:
    """Names that two files or more define, with these files."""
    return {name: files for name, files in places(root).items() if len(files) > 1}


def test_a_name_has_one_meaning():
    excused = STILL_DOUBLE | set(ALLOWED)
    found = {name: files for name, files in doubles(ROOT / "src").items() if name not in excused}
    assert not found


def test_what_is_excused_is_double():
    """Names in the list of exceptions are really defined twice."""
    unique = (STILL_DOUBLE | set(ALLOWED)) - set(doubles(ROOT / "src"))
    assert not unique, f"remove from the lists of test_names.py: {sorted(unique)}"
    assert len(ALLOWED) <= MOST_ALLOWED
    assert all(len(reason) > 20 for reason in ALLOWED.values())
    assert not STILL_DOUBLE & set(ALLOWED)


def test_a_second_meaning_is_found(tmp_path):
    (tmp_path / "one.py").write_text("LIMIT = 1\nclass Body:\n    class Face: ...\nlower = 2\n")
    (tmp_path / "two.py").write_text("FIRST, LIMIT = 1, 2\nlower = 3\n")
    (tmp_path / "three.py").write_text("class Face: ...\nOTHER: int = 1\n")
    assert doubles(tmp_path) == {"LIMIT": ["one.py", "two.py"], "Face": ["one.py", "three.py"]}
