"""Changes each number that was found by experiment, and runs the tests that should notice.

    make noticed, or python tests/mutations.py [MODULE ...]

It takes hours, so that no other target runs it. A number that no test notices is useless or unguarded. For each
number of TUNED this copies src/, changes the number there, and runs JUDGES against the copy: tests that judge answers
by independent solutions, never by the number itself. A number is doubled and halved, a whole one goes one up and one
down. Prints a line for each change: the test that noticed, or that none did. Exit status 1 where one was not noticed.
"""

import ast
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
JUDGES = ("tests/test_stored_truths.py", "tests/test_ways.py", "tests/test_blocks.py", "tests/test_locking.py")
PATIENCE = 300
"""Seconds after which a run of the judges counts as noticed. On two idle cores they take one minute, so that a change
which makes them five times slower is one that a user would see."""

TUNED = {
    "fem/hp/levels.py": ("LEVELS", "SETTLED", "EVEN"),
    "fem/hp/adapt.py": ("SHORTEST", "NEAR"),
    "fem/hp/estimate.py": ("SOFTER", "ROUND_OFF"),
    "fem/hp/division.py": ("FINEST", "FADES", "COARSEST", "BENT", "FACE", "SHORT", "SAME", "STEP_POWER"),
    "fem/hp/places.py": ("UNFELT", "SEEN", "FEW", "SHORTER", "DIGITS"),
    "fem/hp/shoe.py": ("LEFT",),
    "fem/model.py": ("REFINED_FROM", "MAX_REFINED", "LARGEST_LOSS", "MOST_LOSS", "UNSTATED_LOSS"),
    "contact/active_set.py": ("WIDER", "FAR", "PATIENCE", "SMALL", "MOST_SETS"),
    "contact/self_locking.py": ("STEP", "QUIET", "LIKE", "LARGE"),
    "response/response.py": ("EDGE_ZONE", "STEP", "SAME_PEAK", "NEAR_PEAK"),
}
"""Module-level numbers that were found by trying, by their module in src/drumlin."""


class Change(NamedTuple):
    """A changed number: `where` it stands in words, and the replacements (start, end, new text) in the source."""

    where: str
    edits: tuple[tuple[int, int, str], ...]


def changes(source: str, name: str) -> Iterator[Change]:
    """All changes of the numbers of a module constant, LEVELS by its columns."""
    value = _value(ast.parse(source), name)
    starts = _line_starts(source)
    numbers = [
        node for node in ast.walk(value) if isinstance(node, ast.Constant) and isinstance(node.value, int | float)
    ]
    numbers.sort(key=lambda node: (node.lineno, node.col_offset))
    if name == "LEVELS":
        rows = [row.elts for row in ast.walk(value) if isinstance(row, ast.Tuple) and len(row.elts) == 10]
        groups = {f"column {j}": [next(_numbers(row[j])) for row in rows] for j in range(10)}
    else:
        groups = {f"number {j}" if len(numbers) > 1 else "": [number] for j, number in enumerate(numbers)}
    for where, group in groups.items():
        for way in (1, -1):
            edits = tuple(_edit(starts, node, way) for node in group)
            label = f"{name} {where}".strip()
            yield Change(f"{label} {'up' if way > 0 else 'down'}: {', '.join(edit[2] for edit in edits)}", edits)


def _numbers(node: ast.AST) -> Iterator[ast.Constant]:
    for each in ast.walk(node):
        if isinstance(each, ast.Constant):
            yield each


def _value(tree: ast.Module, name: str) -> ast.expr:
    for node in tree.body:
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name) and node.targets[0].id == name:
            return node.value
    raise LookupError(f"no module constant {name}")


def _edit(starts: list[int], node: ast.Constant, way: int) -> tuple[int, int, str]:
    """The replacement of a number: a whole one by one more or less, others by twice or half."""
    assert node.end_col_offset is not None
    value = node.value
    if isinstance(value, int) and abs(value) < 50:
        new: float = value + way
    else:
        assert isinstance(value, int | float)
        new = value * 2.0**way
    first = starts[node.lineno - 1] + node.col_offset
    return first, first + node.end_col_offset - node.col_offset, repr(new)


def _line_starts(source: str) -> list[int]:
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    return starts


def changed(source: str, change: Change) -> str:
    """The source with the numbers of a change replaced."""
    for first, last, text in sorted(change.edits, reverse=True):
        source = source[:first] + text + source[last:]
    return source


def noticed(module: str, change: Change) -> str:
    """The first test of JUDGES that fails with a change, or an empty text."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "src"
        shutil.copytree(ROOT / "src", copy)
        path = copy / "drumlin" / module
        path.write_text(changed(path.read_text(encoding="utf-8"), change), encoding="utf-8")
        command = [sys.executable, "-m", "pytest", "-x", "-q", "--no-header", "-p", "no:cacheprovider", *JUDGES]
        environment = os.environ | {"PYTHONPATH": str(copy)}
        try:
            run = subprocess.run(
                command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=PATIENCE, check=False
            )
        except subprocess.TimeoutExpired:
            return f"took more than {PATIENCE} s"
    if run.returncode == 0:
        return ""
    failed = [line for line in run.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return failed[0].split(" - ")[0] if failed else f"pytest ended with status {run.returncode}"


def main(*modules: str) -> int:
    """Try all changes of some modules of TUNED, by default of all; 1 where one is not noticed."""
    unseen = 0
    for module, names in TUNED.items():
        if modules and module not in modules:
            continue
        source = (ROOT / "src" / "drumlin" / module).read_text(encoding="utf-8")
        for name in names:
            for change in changes(source, name):
                by = noticed(module, change)
                unseen += not by
                sys.stdout.write(f"{module}  {change.where}  {by or 'NOT NOTICED'}\n")
                sys.stdout.flush()
    return int(unseen > 0)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
