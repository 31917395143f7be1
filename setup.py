"""What pyproject.toml cannot say: the wheel carries studies, meshes and kept numbers, which lie in
git once.
"""

import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

CARRIED = ("studies", "meshes", "reports/reference")
LEFT = ("__pycache__", ".*")
PICTURES = ("*.png", "index.html")  # of the kept reports


class BuildWithExamples(build_py):
    """Copies them to drumlin/carried in what is built; an editable install finds them in the
    checkout.
    """

    def run(self) -> None:
        """Build as usual, then copy."""
        super().run()
        if self.editable_mode:
            return
        for name in CARRIED:
            target = Path(self.build_lib) / "drumlin" / "carried" / name
            shutil.rmtree(target, ignore_errors=True)
            left = LEFT + (PICTURES if name.startswith("reports") else ())
            shutil.copytree(name, target, ignore=shutil.ignore_patterns(*left))


setup(cmdclass={"build_py": BuildWithExamples})
