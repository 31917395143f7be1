"""A release has one number, wherever it stands."""

import re
import tomllib

import pytest

import drumlin
from conftest import ROOT
from drumlin_studies.release_number import (
    PATTERNS_OF_RELEASE_NUMBER_BY_FILE,
    write_release_number,
)


def test_the_version_is_the_same_everywhere():
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert drumlin.__version__ == version
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text()
    assert re.findall(r"drumlin-(.*)-py3-none-any\.whl", (ROOT / "README.md").read_text()) == [
        version
    ]


def test_one_command_writes_the_number_everywhere_and_dates_the_changes(tmp_path):
    names = [*PATTERNS_OF_RELEASE_NUMBER_BY_FILE, "CHANGELOG.md"]
    for name in names:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes((ROOT / name).read_bytes())
    write_release_number(tmp_path, "7.8.9", "2031-02-03")
    for name in names:
        old, new = (folder.joinpath(name).read_text().splitlines() for folder in (ROOT, tmp_path))
        if name == "CHANGELOG.md":
            start = new.index("## Not released yet")
            assert new[start : start + 3] == [old[start], "", "## 7.8.9 (2031-02-03)"]
            assert new[:start] + new[start + 2 :] == [
                *old[:start],
                new[start + 2],
                *old[start + 1 :],
            ]
        else:
            (changed,) = [pair for pair in zip(old, new, strict=True) if pair[0] != pair[1]]
            assert changed[0].replace(drumlin.__version__, "7.8.9") == changed[1]


@pytest.mark.parametrize(("version", "said"), [("0.2", "three numbers"), ("", "three numbers")])
def test_a_wrong_number_is_refused(tmp_path, version, said):
    with pytest.raises(drumlin.BadInput, match=said):
        write_release_number(tmp_path, version, "2031-02-03")


def test_a_file_without_a_place_for_the_number_leaves_all_files_as_they_are(tmp_path):
    for name in [*PATTERNS_OF_RELEASE_NUMBER_BY_FILE, "CHANGELOG.md"]:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        text = (ROOT / name).read_text().replace("## Not released yet", "## 0.1.0")
        (tmp_path / name).write_text(text)
    with pytest.raises(drumlin.BadInput, match=r"CHANGELOG.md: has no section"):
        write_release_number(tmp_path, "7.8.9", "2031-02-03")
    assert drumlin.__version__ in (tmp_path / "pyproject.toml").read_text()
    (tmp_path / "CITATION.cff").write_text("title: drumlin\n")
    with pytest.raises(drumlin.BadInput, match=r"CITATION.cff: states the number .* 0 times"):
        write_release_number(tmp_path, "7.8.9", "2031-02-03")


def test_the_address_of_the_source_is_the_same_where_it_is_cited():
    """Both are missing until the first release."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    source = project.get("urls", {}).get("Source")
    cited = re.findall(r"^repository-code: (\S+)$", (ROOT / "CITATION.cff").read_text(), re.M)
    assert cited == ([source] if source else [])
