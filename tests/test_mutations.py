"""The runner that changes tuned numbers changes the numbers that it says, and no others."""

import ast

import pytest

from mutations import ROOT, TUNED, changed, changes

SOURCE = ROOT / "src" / "drumlin"


@pytest.mark.parametrize("module", TUNED)
def test_every_tuned_number_is_found_and_its_change_changes_nothing_else(module):
    source = (SOURCE / module).read_text(encoding="utf-8")
    for name in TUNED[module]:
        found = list(changes(source, name))
        assert found and len(found) % 2 == 0, name
        for change in found:
            other = ast.parse(changed(source, change)).body
            pairs = zip(ast.parse(source).body, other, strict=True)
            differing = [before for before, after in pairs if ast.dump(before) != ast.dump(after)]
            assert [ast.unparse(node.targets[0]) for node in differing if isinstance(node, ast.Assign)] == [name]
            assert len(differing) == 1


def test_a_number_goes_up_by_a_factor_of_two_and_a_whole_one_by_one():
    source = "BEFORE = 1.0\nTUNED = Rule(first=0.4, later=12)\n"
    found = [changed(source, change).splitlines()[1] for change in changes(source, "TUNED")]
    assert found == [
        "TUNED = Rule(first=0.8, later=12)",
        "TUNED = Rule(first=0.2, later=12)",
        "TUNED = Rule(first=0.4, later=13)",
        "TUNED = Rule(first=0.4, later=11)",
    ]
