"""The path of a solve as a picture for the manual: boxes and arrows, drawn as SVG by the build."""

from collections.abc import Sequence
from html import escape
from typing import NamedTuple

BOX_WIDTH, BOX_HEIGHT = 290, 54
"""Size of a box in units of the picture, which the page scales to its text."""
STEP = 84
"""Distance from the top of a box to the top of the next box, in units of the picture."""
MARGIN = 20
"""Distance of the outer boxes from the edge of the picture, in its units."""
WIDTH = 760
"""Width of the picture in its units: two columns of boxes and room for an arrow between them."""


class Box(NamedTuple):
    """A box of the picture: what stands in it, and the room of the package that does this step."""

    title: str
    text: str
    room: str


DOWN = (
    Box("Brake file", "TOML, every quantity with its unit", "drumlin.brake.file"),
    Box("Brake", "frozen data in SI, checked key by key", "drumlin.brake"),
    Box("Division", "hp elements, graded to singular points", "drumlin.fem.hp"),
    Box("Substructures", "bodies condensed to their contact nodes", "drumlin.fem.substructure"),
    Box("Prepared model", "all bodies of the brake, kept in a cache", "drumlin.fem.preparation"),
)
"""The steps on the left, from the file down: each needs geometry and stiffness alone."""

UP = (
    Box("Answer", "Response: torque, p(theta), reactions, errors", "drumlin.response"),
    Box("Error estimate", "from the last two levels", "drumlin.fem.error_control"),
    Box("Response of a level", "balance, round-off, penalty error", "drumlin.fem.model"),
    Box("Active-set method", "p >= 0, gap >= 0, one of them 0", "drumlin.contact"),
    Box("Contact problem", "shoes that share a force or a ring", "drumlin.fem.equilibrium"),
)
"""The steps on the right, from the answer down; the path runs upwards through them."""


def solve_path_picture() -> str:
    """The picture as raw HTML for a page in MyST Markdown."""
    right = WIDTH - BOX_WIDTH - MARGIN
    parts = [_box_svg(box, MARGIN, i) for i, box in enumerate(DOWN)]
    parts += [_box_svg(box, right, i) for i, box in enumerate(UP)]
    left_middle, right_middle = MARGIN + BOX_WIDTH / 2, right + BOX_WIDTH / 2
    for i in range(len(DOWN) - 1):
        low, high = _top_of_row(i) + BOX_HEIGHT, _top_of_row(i + 1)
        parts.append(_arrow_svg([(left_middle, low), (left_middle, high)]))
        parts.append(_arrow_svg([(right_middle, high), (right_middle, low)]))
    # The prepared model leads across to the contact problem.
    across = _top_of_row(len(DOWN) - 1) + BOX_HEIGHT / 2
    parts.append(_arrow_svg([(MARGIN + BOX_WIDTH, across), (right, across)]))
    # If the error is too large, the path returns to the division.
    estimate, division = _top_of_row(1) + BOX_HEIGHT / 2, _top_of_row(2) + BOX_HEIGHT / 2
    bend = (MARGIN + BOX_WIDTH + right) / 2
    back = [(right, estimate), (bend, estimate), (bend, division), (MARGIN + BOX_WIDTH, division)]
    parts.append(_arrow_svg(back))
    parts.append(_label_svg("too large:", bend, estimate - 22))
    parts.append(_label_svg("next level", bend, estimate - 8))
    return f"```{{raw}} html\n{_svg_element(parts)}\n```"


def rooms_in_picture() -> list[str]:
    """The rooms that the picture names, in the order of the path."""
    found: list[str] = []
    for box in (*DOWN, *reversed(UP)):
        found.append(box.room)
    return found


def _top_of_row(row: int) -> float:
    """Upper edge of the boxes of a row."""
    return MARGIN + row * STEP


def _svg_element(parts: Sequence[str]) -> str:
    """The parts in an SVG element that takes its colours from the page."""
    height = _top_of_row(len(DOWN) - 1) + BOX_HEIGHT + MARGIN
    head = (
        f'<svg viewBox="0 0 {WIDTH} {height:g}" role="img" xmlns="http://www.w3.org/2000/svg" '
        'style="max-width:100%;color:var(--color-foreground-primary,#111)" '
        'font-family="sans-serif" fill="currentColor">'
        "<title>The path of a solve, from the brake file to the response</title>"
        '<defs><marker id="tip" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="7" '
        'markerHeight="7" orient="auto-start-reverse"><path d="M0 0L10 5L0 10z"/></marker></defs>'
    )
    return "\n".join([head, *parts, "</svg>"])


def _box_svg(box: Box, x: float, row: int) -> str:
    """A box with its title, its text and its room."""
    y, middle = _top_of_row(row), x + BOX_WIDTH / 2
    return (
        f'<rect x="{x}" y="{y:g}" width="{BOX_WIDTH}" height="{BOX_HEIGHT}" rx="5" fill="none" '
        'stroke="currentColor"/>'
        f'<text x="{middle:g}" y="{y + 16:g}" text-anchor="middle" font-size="13" '
        f'font-weight="bold">{escape(box.title)}</text>'
        f'<text x="{middle:g}" y="{y + 31:g}" text-anchor="middle" font-size="11">'
        f"{escape(box.text)}</text>"
        f'<text x="{middle:g}" y="{y + 46:g}" text-anchor="middle" font-size="11" '
        f'font-family="monospace">{escape(box.room)}</text>'
    )


def _arrow_svg(points: Sequence[tuple[float, float]]) -> str:
    """A line through points with a tip at its end."""
    path = " ".join(f"{x:g},{y:g}" for x, y in points)
    return f'<polyline points="{path}" fill="none" stroke="currentColor" marker-end="url(#tip)"/>'


def _label_svg(text: str, x: float, y: float) -> str:
    """A text in the middle over a place."""
    return f'<text x="{x:g}" y="{y:g}" text-anchor="middle" font-size="11">{escape(text)}</text>'
