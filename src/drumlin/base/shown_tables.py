"""Show the cells of a table to the reader, as aligned text or as HTML."""

from collections.abc import Sequence

RowsOfCellTexts = Sequence[Sequence[str]]
"""The type of the cells of a table: a row of headings, then the rows of texts."""


def text_lines_of_aligned_columns(rows: RowsOfCellTexts) -> list[str]:
    """The rows of a table as lines of text, with two spaces between the aligned columns."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = []
    for row in rows:
        # Each cell is padded to the width of its column.
        lines.append("  ".join(map(str.ljust, row, widths)).rstrip())
    return lines


def html_table_with_caption(caption: str, rows: RowsOfCellTexts) -> str:
    """A table as HTML, which notebooks display; the first row holds the headings."""
    # The standard module `html` loads a table of all entities, and only notebooks need it.
    from html import escape  # noqa: PLC0415

    def html_of_table_row(cells: Sequence[str], tag: str) -> str:
        """The HTML of a row whose cells have the given tag, "td" or "th"."""
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    head, *rest = rows
    body = "".join(html_of_table_row(cells, "td") for cells in rest)
    return (
        f"<table><caption>{escape(caption)}</caption>{html_of_table_row(head, 'th')}{body}</table>"
    )
