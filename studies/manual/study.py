"""The manual: written pages, executed examples and a reference read off the program, as a site.

`study` writes the reference's pages as texts. `report` puts the values that pages quote in place
and builds the site by Sphinx, which runs every example. A broken example, formula or link, and a
value that does not exist, are errors.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path

from studies.manual import gallery, history, listing
from studies.manual.built_pages import faults_of_built_pages
from studies.manual.values import fill_in_values, quoted_values

from drumlin.base.errors import NoAnswer
from drumlin.report.figures import save_figure
from drumlin_studies.benchmarks import read_benchmark_history

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
NOTEBOOKS = ROOT / "studies" / "notebooks"


def study(*, short: bool = False, say: Callable[[str], None] = lambda _: None) -> Mapping[str, str]:
    """The pages that are read off the program: their texts by their names below pages/.

    `short` changes nothing.
    """
    say("the reference")
    return {
        "reference/brake_file.md": listing.brake_file_page(),
        "reference/sweep_file.md": listing.sweep_file_page(),
        "reference/commands.md": listing.commands_page(),
        **listing.api_pages(),
        "reference/laws.md": listing.models_page(),
        "researcher/ladder.md": listing.ladder_page(),
        **gallery.example_pages(say),
    }


def report(result: Mapping[str, str], folder: Path) -> Path:
    """Build the site into `folder`; returns its first page.

    Raises NoAnswer, with Sphinx's words, where an example, a formula or a link is broken.
    """
    with tempfile.TemporaryDirectory(prefix="drumlin-manual-") as place:
        source = Path(place) / "pages"
        shutil.copytree(HERE / "pages", source)
        shutil.copytree(NOTEBOOKS, source / "notebooks")
        known = quoted_values()
        for page in source.rglob("*.md"):
            page.write_text(
                fill_in_values(page.read_text(encoding="utf-8"), known), encoding="utf-8"
            )
        # The texts that are read off the program follow the hand-written ones.
        for name, text in result.items():
            page = source / name
            page.parent.mkdir(exist_ok=True)
            page.write_text(
                page.read_text(encoding="utf-8") + text if page.exists() else text, encoding="utf-8"
            )
        save_figure(
            history.draw_history(read_benchmark_history()), source / "researcher" / "benchmarks.png"
        )
        (source / "pictures").mkdir()
        gallery.draw_examples(source / "pictures")
        site = Path(place) / "site"
        build_site(source, site)
        if folder.exists():
            shutil.rmtree(folder)
        shutil.copytree(
            site, folder, ignore=shutil.ignore_patterns(".doctrees", ".buildinfo", "objects.inv")
        )
    return folder / "index.html"


def build_site(source: Path, site: Path) -> None:
    """Build the pages in the folder `source` into the folder `site`.

    Raises NoAnswer with the words of Sphinx where Sphinx warns of anything, and where a built page
    has a dead link, control codes of a terminal or a figure that is not drawn.
    """
    options = ["-b", "html", "-W", "--keep-going", "-q", "-c", str(HERE)]
    command = [sys.executable, "-m", "sphinx", *options, str(source), str(site)]
    done = subprocess.run(
        command, env=_example_environment(), capture_output=True, text=True, check=False
    )
    if done.returncode:
        lines = re.sub(r"\x1b\[[\d;]*m", "", done.stderr).replace(str(source), "pages").splitlines()
        # Errors come first: they are often the cause of the warnings.
        faults = [line for line in lines if "rror: " in line]
        faults += [line for line in lines if "WARNING: " in line]
        said = " | ".join(faults or lines[-3:])
        raise NoAnswer(f"the manual is not built: {' '.join(said.split())}")
    if wrong := faults_of_built_pages(site):
        raise NoAnswer(f"the manual is not built: {' | '.join(wrong)}")


def _example_environment() -> dict[str, str]:
    """The environment in which the manual's examples run: the repository's drumlin, no terminal.

    The command `drumlin` is that of this interpreter.
    """
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    python = os.pathsep.join(
        filter(None, [str(ROOT / "src"), str(ROOT), os.environ.get("PYTHONPATH", "")])
    )
    # Figures appear in the page, whatever the command line has set.
    figures = "module://matplotlib_inline.backend_inline"
    # In a dumb terminal no command prints control codes.
    terminal = "dumb"
    return os.environ | {
        "PATH": path,
        "PYTHONPATH": python,
        "TERM": terminal,
        "MPLBACKEND": figures,
    }
