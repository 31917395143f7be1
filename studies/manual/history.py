"""The history of the benchmarks for the manual: a table of the figures and a picture of them."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drumlin_studies.benchmarks import BenchmarkFiguresOfCommit

GROUPS = {
    "Times of solves": ("solve ", "sine law", "sensitivity", "hold"),
    "Times in default solves of the double-shoe brake": ("default solves: ",),
    "Unknowns and iterations": ("unknowns ", "iterations "),
    "Times of commands": ("command ", "import "),
}
"""Panels of the picture, each with the beginnings of the names of its figures."""

PANEL_SIZE = (8.0, 2.6)
"""Width and height of a panel of the picture [inch]."""


def history_table(history: Sequence[BenchmarkFiguresOfCommit]) -> str:
    """A Markdown table of each figure in the first and in the last line of a history."""
    first, last = history[0], history[-1]
    lines = [
        f"| figure | {first.commit} ({first.date}) | {last.commit} ({last.date}) |",
        "|---|---|---|",
    ]
    for name, value in last.figures.items():
        before = first.figures.get(name)
        lines.append(f"| {name} | {'' if before is None else f'{before:g}'} | {value:g} |")
    return "\n".join(lines)


def draw_history(history: Sequence[BenchmarkFiguresOfCommit]) -> Figure:
    """Each figure over the commits, in per cent of its oldest value; one panel a group."""
    width, height = PANEL_SIZE
    figure = Figure(figsize=(width, height * len(GROUPS)), layout="constrained")
    panels = figure.subplots(len(GROUPS), 1, sharex=True)
    for axes, (title, beginnings) in zip(panels, GROUPS.items(), strict=True):
        axes.set_title(title)
        for name in history[-1].figures:
            if name.startswith(beginnings):
                draw_figure(axes, history, name)
        axes.set_ylabel("% of the first")
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize="small")
    commits = []
    for benchmark in history:
        commits.append(f"{benchmark.commit}\n{benchmark.date}")
    panels[-1].set_xticks(range(len(history)), commits, fontsize="small")
    return figure


def draw_figure(axes: Axes, history: Sequence[BenchmarkFiguresOfCommit], name: str) -> None:
    """Draw one figure over the lines of a history that have it."""
    places = []
    for place, line in enumerate(history):
        if name in line.figures:
            places.append(place)
    values = []
    for place in places:
        values.append(history[place].figures[name])
    axes.plot(places, [100 * value / values[0] for value in values], marker="o", label=name)
