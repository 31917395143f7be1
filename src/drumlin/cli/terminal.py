"""What a person at the terminal sees: progress while something runs, a response, a table."""

import math
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from textwrap import fill
from typing import TYPE_CHECKING, Any

from drumlin.errors import file_fault
from drumlin.texts import one_line

if TYPE_CHECKING:
    from drumlin.brake.plane_brake import AnyBrake
    from drumlin.comparison import Column
    from drumlin.response.response import FlatMerit, Merit, Response

SAME = ("case", "rotation")  # columns that are the same in all rows of one brake
LEAST = ["self_energising", "contact", "reaction_error", "reaction", "peak_error", "peak_pressure", "seconds"]
WIDTH = 200  # characters, where the output is no terminal
STATUS_WIDTH = 10  # a status is folded
LONGEST = 10_000  # characters of a line


def tell(line: str, *, at_once: bool = False) -> None:
    """Print a line of an answer; what is not printable in it, as in the name of a file, is escaped."""
    with _printing():
        print(one_line(line, LONGEST), flush=at_once)


def note(line: str) -> None:
    """A line beside the output."""
    print(f"drumlin: {one_line(line)}", file=sys.stderr)


@contextmanager
def _printing() -> Iterator[None]:
    """Raise DrumlinError where standard output takes no more; that its reader has seen enough is no fault."""
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        raise file_fault("standard output", "written", error) from error


@contextmanager
def progress(words: str) -> Iterator[Callable[[int, int], None]]:
    """A bar with the time left, on a terminal; to be told how many cases have finished, and of how many."""
    if not sys.stderr.isatty():
        yield lambda finished, of: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task(words, total=None)
        yield lambda finished, of: bar.update(task, completed=finished, total=of)


@contextmanager
def busy(words: str) -> Iterator[Callable[[str], None]]:
    """A spinner on a terminal; to be told other words. Silent where no one watches."""
    if not sys.stderr.isatty():
        yield lambda words: None
        return
    from rich.console import Console
    from rich.text import Text

    with Console(stderr=True).status(Text(words)) as status:
        yield lambda words: status.update(Text(words))


def print_response(brake: "AnyBrake", response: "Response") -> None:
    """A response for people: the torque, a line or two a shoe, then how it was found and what it leaves out."""
    from drumlin.response.response import FlatMerit
    from drumlin.response.show import arcs_text

    tell(f"{brake.title}: {response.model}, {brake.motion}, mu = {brake.friction:g}")
    forces = [merit.braking_force for merit in response.merits if isinstance(merit, FlatMerit)]
    tell(f"braking force {sum(forces):.6g} N" if forces else f"torque {response.torque:.6g} N m")
    for shoe, merit in zip(response.shoes, response.merits, strict=True):
        x, y = shoe.hinge_reaction
        effect, unit = f"torque {shoe.torque:.6g} N m", "deg"
        if isinstance(merit, FlatMerit):
            effect, unit = f"braking force {merit.braking_force:.6g} N", "mm"
        touching = f"contact {arcs_text(shoe, unit)} {unit}" if shoe.contact_arcs else "no contact"
        tell(
            f"  shoe {shoe.name!r}: {effect}"
            f"{', self-energising' if shoe.self_energising else ''}; normal force {shoe.normal_force:.6g} N; "
            f"peak pressure {shoe.peak_pressure * 1e-6:.4g} MPa; hinge reaction ({x:.6g}, {y:.6g}) N; "
            f"{touching}"
        )
        tell(f"    {_merit_text(merit)}")
    spent = ", ".join(f"{phase} {seconds * 1e3:.1f}" for phase, seconds in response.seconds.items())
    if spent:
        tell(f"  {response.iterations} active-set steps; balance: force {response.balance.force:.1e}, "
              f"moment {response.balance.moment:.1e}; ms: {spent}")  # fmt: skip
    if response.error is not None:
        more = {"torque": "torque", "peak": "peak pressure", "reaction": "hinge reaction"}
        errors = [f", {said} {response.error[name]:.1e}" for name, said in more.items() if name in response.error]
        tell(f"  estimated error: p {response.error['pressure']:.1e} (L2, worst shoe){''.join(errors)}")
    for line in response.notes:
        tell(f"  {line}")
    for line in response.left_out:
        tell(f"  left out: {line}")


def _merit_text(merit: "Merit | FlatMerit") -> str:
    """Figures of merit for people: names as in the JSON, the angle in degrees; without those that are None."""
    values = {key: value for key, value in merit._asdict().items() if value is not None}
    angle = values.pop("resultant_angle", None)
    said = [] if angle is None else [f"resultant at {math.degrees(angle):.4g} deg"]
    return ", ".join(said + [f"{key} {value:.5g}" for key, value in values.items()])


def print_table(table: Sequence[dict[str, Any]], columns: "Sequence[Column]") -> None:
    """Rows for people. No number is cut: on a narrow terminal the columns that matter least are left out, by name."""
    from rich.console import Console
    from rich.table import Table

    console = Console(width=None if sys.stdout.isatty() else WIDTH, markup=False)
    shown = {c.key: c for c in columns if c.key not in SAME and any(row.get(c.key) is not None for row in table)}
    cells = {key: [c.text(row) for row in table] for key, c in shown.items()}
    units = {key: f"\n[{c.unit}]" if c.unit else "" for key, c in shown.items()}
    heads = {key: fill(c.heading, 9, break_long_words=False) + units[key] for key, c in shown.items()}
    widths = {key: max(map(len, (*heads[key].split("\n"), *cells[key]))) for key in shown} | {"status": STATUS_WIDTH}
    cut = []
    for key in filter(shown.__contains__, LEAST):
        if sum(widths[other] + 2 for other in shown) > console.width:
            cut.append(shown.pop(key).title)
    grid = Table(box=None, pad_edge=False, header_style="bold")
    for key in shown:
        left = key in {"shoe", "model", "status"}
        grid.add_column(heads[key], justify="left" if left else "right", no_wrap=key != "status", overflow="fold")
    for row in zip(*(cells[key] for key in shown), strict=True):
        grid.add_row(*row)
    with _printing():
        console.print(grid)
    if cut:
        tell(f"not shown here, the terminal is too narrow: {', '.join(cut)}")
