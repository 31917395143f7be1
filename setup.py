"""The wheel carries studies, meshes and kept numbers, which pyproject.toml cannot say.

They lie in git once, outside of the package.
"""

import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

CARRIED = ("studies", "meshes", "reports/reference")
LEFT = ("__pycache__", ".*")
PICTURES = ("*.png", "index.html")  # of the kept reports


class BuildWithExamples(build_py):
    """Copies the folders CARRIED to drumlin/carried in the built package.

    An editable install finds them in the checkout.
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
