"""No test module imports another: functions that several of them use are in separate modules."""

import ast
from pathlib import Path


def test_no_test_module_is_imported():
    for path in Path(__file__).parent.glob("*.py"):
        imported = [
            node.module
            for node in ast.walk(ast.parse(path.read_text()))
            if isinstance(node, ast.ImportFrom)
        ]
        assert not [name for name in imported if name is not None and name.startswith("test_")], (
            path.name
        )
