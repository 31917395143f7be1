"""The example notebooks with their outputs, as they are kept in `studies/notebooks`.

`python -m drumlin_studies.notebooks` executes each notebook in an empty folder and writes its
outputs into its file, without the times, paths and counts of the run. The manual shows the kept
outputs. A test executes the notebooks anew and compares the texts.
"""

import base64
import importlib
import os
import re
import struct
import tempfile
from pathlib import Path
from typing import Any

from nbclient import NotebookClient

from drumlin.base.files import write_text
from drumlin.studies import paths_of_example_notebooks

# The package nbformat has no type hints, so that its type is Any.
nbformat_library: Any = importlib.import_module("nbformat.v4")

LONGEST_SECONDS_OF_CELL = 300
"""Seconds after which a cell counts as hung. All cells of a notebook take some 20 s."""

PATTERN_OF_NUMBER_IN_TEXT = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
"""Regular expression for a number in a text, such as 447.59, +2.8 or 1e-05."""

HTML_TAG_PATTERN = re.compile(r"<[^>]*>")
"""Regular expression for a tag of an HTML text. A space takes the place of a tag, because the tag
separates words on the page.
"""

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
"""First bytes of each PNG file (PNG specification, section 5.2)."""

TYPES_OF_PNG_CHUNKS_WITH_TEXTS_AND_TIMES = (b"tEXt", b"zTXt", b"iTXt", b"tIME", b"eXIf")
"""Types of the PNG chunks with texts and times, such as the version of matplotlib."""


def execute_notebook(path: Path) -> Any:
    """The notebook of a file with the outputs of its cells, and without traces of this run.

    The cells run in an empty folder, like the cells of a reader who has only drumlin. Raises
    nbclient's CellExecutionError if a cell fails.
    """
    notebook: Any = nbformat_library.reads(path.read_text(encoding="utf-8"))
    with tempfile.TemporaryDirectory(prefix="drumlin-notebook-") as folder:
        place = {"metadata": {"path": folder}}
        # drumlin's command line sets MPLBACKEND for its process, to draw without a window. The
        # variable is removed here, because a notebook must show its figures.
        environment = {name: text for name, text in os.environ.items() if name != "MPLBACKEND"}
        NotebookClient(
            notebook, timeout=LONGEST_SECONDS_OF_CELL, kernel_name="python3", resources=place
        ).execute(env=environment)
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    for number, cell in enumerate(cells, start=1):
        cell.execution_count = number
        # The metadata of a cell are the times at which it began and ended.
        cell.metadata = {}
        cell.outputs = _outputs_with_joined_texts(cell.outputs)
        for output in cell.outputs:
            _remove_traces_of_run_from_output(output, number)
    notebook.metadata.pop("language_info", None)
    return notebook


def _outputs_with_joined_texts(outputs: list[Any]) -> list[Any]:
    """The outputs of a cell, with successive printed texts joined to one text.

    The lines that a loop prints come in one text or in several texts, by chance.
    """
    joined: list[Any] = []
    for output in outputs:
        if joined and output.get("name") and output.get("name") == joined[-1].get("name"):
            joined[-1].text += output.text
        else:
            joined.append(output)
    return joined


def _remove_traces_of_run_from_output(output: Any, number: int) -> None:
    """Give an output the number of its cell, and remove the texts beside a picture and in it.

    The text beside a picture is "<Figure size ...>". The texts in a picture's data contain the
    version of matplotlib. Each new version would change them.
    """
    if output.output_type == "execute_result":
        output.execution_count = number
    data = output.get("data", {})
    if "image/png" in data:
        data.pop("text/plain", None)
        picture = png_without_texts(base64.b64decode(data["image/png"]))
        # IPython ends the base64 text of a picture with a line end.
        data["image/png"] = base64.b64encode(picture).decode("ascii") + "\n"


def png_without_texts(picture: bytes) -> bytes:
    """The bytes of a PNG file without its texts and times.

    A chunk is its length (4 bytes), its type (4), its data and a check sum (4) [PNG specification,
    section 5.3]. Raises ValueError if the bytes are no PNG file.
    """
    if not picture.startswith(PNG_SIGNATURE):
        raise ValueError(f"no PNG file: begins with {picture[: len(PNG_SIGNATURE)]!r}")
    kept, start = [PNG_SIGNATURE], len(PNG_SIGNATURE)
    while start < len(picture):
        length, kind = struct.unpack_from(">I4s", picture, start)
        end = start + 12 + length
        if kind not in TYPES_OF_PNG_CHUNKS_WITH_TEXTS_AND_TIMES:
            kept.append(picture[start:end])
        start = end
    return b"".join(kept)


def texts_of_outputs(notebook: Any) -> list[str]:
    """The printed texts and the shown values of the code cells, one entry for each cell.

    The entry has a value in plain text and in HTML if the cell gives both. The manual shows the
    HTML.
    """
    texts = []
    for cell in notebook.cells:
        if cell.cell_type == "code":
            values = [output.get("data", {}) for output in cell.outputs]
            shown = [output.get("text", "") for output in cell.outputs]
            shown += [value.get("text/plain", "") for value in values]
            shown += [HTML_TAG_PATTERN.sub(" ", value.get("text/html", "")) for value in values]
            texts.append("\n".join(filter(None, shown)))
    return texts


def text_with_stars_for_numbers_and_its_numbers(text: str) -> tuple[str, list[float]]:
    """A text with a star in place of each number, and the list of these numbers."""
    return " ".join(PATTERN_OF_NUMBER_IN_TEXT.sub("*", text).split()), list(
        map(float, PATTERN_OF_NUMBER_IN_TEXT.findall(text))
    )


def main() -> None:
    """Execute all example notebooks, and write their outputs into their files."""
    for path in paths_of_example_notebooks().values():
        write_text(path, nbformat_library.writes(execute_notebook(path)) + "\n")


if __name__ == "__main__":
    main()
