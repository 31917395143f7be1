"""The runner that changes numbers changes only the stated one, and knows every number."""

import ast
import json

import pytest

from mutations import (
    PACKAGE,
    TUNED,
    Guard,
    changes,
    constants,
    imported,
    in_source,
    in_table,
    moved,
    red,
    tried,
    unguarded,
)
from not_tuned import NOT_TUNED

PARTS = ("fem", "contact", "response", "mesh_files")
MODULES = [
    path.relative_to(PACKAGE).as_posix()
    for part in PARTS
    for path in sorted((PACKAGE / part).rglob("*.py"))
]
ROWS = [(module, name) for module, guards in TUNED.items() for name in guards]
"""The constants of which it is shown that a test notices them."""


@pytest.mark.parametrize("module", [module for module in TUNED if module.endswith(".py")])
def test_every_tuned_number_is_found_and_its_change_changes_nothing_else(module):
    source = (PACKAGE / module).read_text(encoding="utf-8")
    for name in TUNED[module]:
        found = list(changes(module, name))
        assert found and len(found) % 2 == 0, name
        for change in found:
            pairs = zip(ast.parse(source).body, ast.parse(change.source).body, strict=True)
            differing = [before for before, after in pairs if ast.dump(before) != ast.dump(after)]
            assert [
                ast.unparse(node.targets[0]) for node in differing if isinstance(node, ast.Assign)
            ] == [name]
            assert len(differing) == 1


@pytest.mark.parametrize("module", MODULES)
def test_every_number_is_tuned_or_has_a_reason(module):
    known, reasons = set(TUNED.get(module, ())), NOT_TUNED.get(module, {})
    assert set(constants(module)) == known | set(reasons)
    assert not known & set(reasons) and all(reasons.values())


def test_the_tables_name_modules_that_exist():
    for module in (*TUNED, *NOT_TUNED):
        assert (PACKAGE / module).exists(), module
    for module, names in TUNED.items():
        assert module.endswith(".json") or all(hasattr(imported(module), name) for name in names)


def test_a_number_goes_up_by_a_factor_of_two_and_a_whole_one_by_one():
    source = "BEFORE = 1.0  # µ\nTUNED = Rule(first=0.2, later=12, most=240)\n"
    found = [change.source.splitlines()[1] for change in in_source(source, "TUNED")]
    assert found == [
        "TUNED = Rule(first=0.4, later=12, most=240)",
        "TUNED = Rule(first=0.1, later=12, most=240)",
        "TUNED = Rule(first=0.2, later=13, most=240)",
        "TUNED = Rule(first=0.2, later=11, most=240)",
        "TUNED = Rule(first=0.2, later=12, most=480)",
        "TUNED = Rule(first=0.2, later=12, most=120)",
    ]
    whole = [change.source for change in in_source("TUNED = 1 / 32\n", "TUNED", 1 / 32)]
    assert whole == ["TUNED = 0.0625\n", "TUNED = 0.015625\n"]
    assert moved(0.8, "up") == 0.9 and moved(0.8, "down") == 0.4 and moved(1.5, "up") == 3.0


def test_a_number_of_a_table_changes_in_its_table_alone():
    source = json.dumps({"one": {"value": 0.5}, "other": {"value": 3.0}})
    found = [json.loads(change.source) for change in in_table(source, "other")]
    assert found == [{"one": {"value": 0.5}, "other": {"value": value}} for value in (6.0, 1.5)]


def test_a_constant_that_shares_its_line_is_refused():
    with pytest.raises(LookupError, match="OTHER"):
        list(in_source("TUNED, OTHER = 1.0, 2.0\n", "OTHER"))


def test_an_unsafe_side_that_stays_green_is_not_guarded():
    sides = {("X", "up"): "", ("X", "down"): "tests/test_x.py::test_y"}
    assert unguarded(Guard("down"), sides) == [] == unguarded(Guard("either"), sides)
    assert (
        unguarded(Guard("up"), sides) == ["X: up is not noticed"] == unguarded(Guard("both"), sides)
    )
    assert unguarded(Guard("either"), sides | {("X", "down"): ""}) == ["X: neither side is noticed"]


@pytest.mark.slow
def test_a_change_is_noticed_by_the_test_that_fails_with_it(tmp_path):
    test = tmp_path / "test_copy.py"
    test.write_text(
        "from drumlin.base.texts import printable_single_line\n\ndef test_one():\n    pass\n",
        encoding="utf-8",
    )
    guard = Guard(tests=(str(test),))
    assert red(guard) == ""
    assert "test_copy.py" in red(guard, "base/texts.py", "raise SystemError\n")


# A part of a name up to its last "::" is what a process takes as a whole: so modules are shared
# out.
@pytest.mark.slow
@pytest.mark.parametrize(
    ("module", "name"), [pytest.param(*row, id="::".join(row)) for row in ROWS]
)
def test_a_tuned_number_on_its_unsafe_side_is_noticed(module, name):
    noticed = {(change.name, change.side): by for change, by in tried(module, name, safe=False)}
    assert not unguarded(TUNED[module][name], noticed)
