"""Write the number of a release into all files that state it, and date its changes.

`make release_number VERSION=1.2.3` does this today, as the first step of the commit of a release.
"""

import re
import sys
from datetime import UTC, datetime
from pathlib import Path

from drumlin.base.errors import BadInput

PATTERNS_OF_RELEASE_NUMBER_BY_FILE = {
    "pyproject.toml": r'^(version = ")[^"]+(")$',
    "src/drumlin/__init__.py": r'^(__version__ = ")[^"]+(")$',
    "CITATION.cff": r"^(version: )\S+()$",
    ".zenodo.json": r'^( "version": ")[^"]+(",)$',
    "recipe/recipe.yaml": r'^(  version: ")[^"]+(")$',
    "README.md": r"(`pip install drumlin-)[^`]+(-py3-none-any\.whl`)",
}
"""The one place of the number in each file that states it: what stands before and after it."""

HEADING_OF_UNRELEASED_CHANGES = "## Not released yet\n"
"""The heading in CHANGELOG.md below which changes stand until they are released."""


def write_release_number(folder: Path, version: str, day: str) -> None:
    """Write the number of a release into the files of a checkout, and date the changelog.

    Nothing is written if one of the files has no place for the number.

    Parameters
    ----------
    folder : the checkout
    version : number of the release, such as "0.2.0"
    day : day of the release, as year-month-day

    Raises
    ------
    BadInput
        for a number that is no three numbers with dots, and for a file without its place
    """
    if not re.fullmatch(r"\d+\.\d+\.\d+", version):
        raise BadInput(f"VERSION = {version!r}: must be three numbers, such as '0.2.0'")
    texts = {}
    for name, pattern in PATTERNS_OF_RELEASE_NUMBER_BY_FILE.items():
        old = (folder / name).read_text(encoding="utf-8")
        texts[name], count = re.subn(pattern, rf"\g<1>{version}\g<2>", old, flags=re.MULTILINE)
        if count != 1:
            raise BadInput(f"{name}: states the number of the release {count} times, not once")
    changes = (folder / "CHANGELOG.md").read_text(encoding="utf-8")
    if changes.count(HEADING_OF_UNRELEASED_CHANGES) != 1:
        raise BadInput("CHANGELOG.md: has no section 'Not released yet'")
    dated = f"{HEADING_OF_UNRELEASED_CHANGES}\n## {version} ({day})\n"
    texts["CHANGELOG.md"] = changes.replace(HEADING_OF_UNRELEASED_CHANGES, dated)
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    today = datetime.now(UTC).date().isoformat()
    try:
        write_release_number(Path.cwd(), " ".join(sys.argv[1:]), today)
    except BadInput as error:
        sys.exit(str(error))
