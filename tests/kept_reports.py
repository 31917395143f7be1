"""Tables of the reference reports that the repository keeps in reports/reference."""

import csv

from conftest import ROOT


def rows(report, **chosen):
    with (ROOT / "reports" / "reference" / report).open() as file:
        return [
            row
            for row in csv.DictReader(file)
            if all(row[key] == value for key, value in chosen.items())
        ]
