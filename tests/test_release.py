"""A release has one number, wherever it stands."""

import re
import tomllib

import drumlin
from conftest import ROOT


def test_the_version_is_the_same_everywhere():
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert drumlin.__version__ == version
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text()
    assert re.findall(r"drumlin-(.*)-py3-none-any\.whl", (ROOT / "README.md").read_text()) == [
        version
    ]


def test_the_address_of_the_source_is_the_same_where_it_is_cited():
    """Both are missing until the first release."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    source = project.get("urls", {}).get("Source")
    cited = re.findall(r"^repository-code: (\S+)$", (ROOT / "CITATION.cff").read_text(), re.M)
    assert cited == ([source] if source else [])
