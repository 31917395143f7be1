"""Print the lower bounds of pyproject.toml as exact versions for pip.

These are the oldest libraries with which drumlin and its tests must work.
"""

import sys
import tomllib
from pathlib import Path
from typing import Any

# These extras judge the source, or stand for the other extras.
TOOLS = ("mypy", "ruff", "import-linter", "drumlin")


def oldest(data: dict[str, Any]) -> list[str]:
    """The required packages, each with the oldest allowed version."""
    extras = data["project"]["optional-dependencies"]
    used = [
        line
        for name in ("distributed", "fields", "manual", "med", "parquet", "dev")
        for line in extras[name]
    ]
    wanted = dict.fromkeys([*data["project"]["dependencies"], *used])
    return [line.replace(">=", "==") for line in wanted if not line.startswith(TOOLS)]


if __name__ == "__main__":
    file = Path(__file__).resolve().parents[1] / "pyproject.toml"
    sys.stdout.write("\n".join(oldest(tomllib.loads(file.read_text()))) + "\n")
