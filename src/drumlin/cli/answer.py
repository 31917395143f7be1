"""Printing of the answer to one brake file by one model, such as finite elements or a law.

The torque, a table of the shoes, warnings and the estimated errors are printed.
"""

import math
from typing import TYPE_CHECKING, NamedTuple

from drumlin.base.texts import error_text_in_percent
from drumlin.cli.terminal import (
    PrintedColumn,
    print_line_folded_to_terminal_width,
    print_table_fitted_to_terminal,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from drumlin.brake.brake import Brake
    from drumlin.response.response import (
        EstimatedErrorOfPlaneStress,
        FiguresOfMeritOnDrum,
        FiguresOfMeritOnPlane,
        Response,
    )

SHOE_COLUMNS_DROPPED_ON_NARROW_TERMINAL = ["shoe_factor", "reaction", "normal_force", "at"]
"""Columns of the printed table of shoes that a narrow terminal has no room for.

The columns are left out in this order, until the other columns fit.
"""

LARGE_PLANE_STRESS_ERROR = 0.05
"""Relative error of plane stress from which the answer names options with smaller errors.

Below this error plane stress is enough for most uses, because the friction of a real lining varies
by more. The value is a judgement.
"""


def print_brake_response(brake: "Brake", response: "Response", *, verbose: bool = False) -> None:
    """Print the torque and brake factor of a brake, a row for each shoe, warnings and errors.

    Lines on shoes that do not touch the drum stand below the title line. `verbose` is whether
    reactions, figures of merit, solution steps, times and neglected effects are printed, too.
    """
    from drumlin.laws.rigid import UNUSED_KEYS_LINE_START
    from drumlin.response.show import estimated_errors_as_line, plane_stress_errors_as_line

    notes = _NotesByPlaceInPrintout.notes_of_response_by_place_in_printout(response)
    print_line_folded_to_terminal_width(
        f"{brake.title}: {response.model}, {brake.motion_as_text}, "
        f"{brake.friction_coefficients_as_text}"
    )
    for line in notes.lines_above_table:
        print_line_folded_to_terminal_width(line)
    _print_torque_and_brake_factor(brake, response)
    _print_table_of_shoes(brake, response)
    # Warnings and estimated errors stand below the table, since the last lines stay on the screen.
    if brake.friction:
        print_line_folded_to_terminal_width(_self_energising_shoes_as_line(response))
    if response.self_locking is not None:
        print_line_folded_to_terminal_width(_self_locking_as_line(response))
    for line in notes.warnings:
        print_line_folded_to_terminal_width(line)
    for line in response.left_out:
        if line.startswith(UNUSED_KEYS_LINE_START):
            print_line_folded_to_terminal_width(line)
    if response.error is not None:
        print_line_folded_to_terminal_width(
            estimated_errors_as_line(brake.surface.word_for_torque_or_brake_force, response.error)
        )
    if response.plane_stress_error is not None:
        print_line_folded_to_terminal_width(
            plane_stress_errors_as_line(brake.surface.word_for_torque_or_brake_force, response)
        )
        for line in _ways_to_smaller_plane_stress_error_as_lines(
            brake, response.plane_stress_error
        ):
            print_line_folded_to_terminal_width(line)
    for line in notes.lines_on_supports:
        print_line_folded_to_terminal_width(line)
    if verbose:
        _print_lines_of_verbose_answer(response, notes.lines_of_verbose_answer)


def _self_energising_shoes_as_line(response: "Response") -> str:
    """The names of the self-energising shoes as a line, or why there are none."""
    energised = [shoe.name for shoe in response.shoes if shoe.self_energising]
    if energised:
        return f"self-energising: {', '.join(energised)}"
    not_touching = [repr(shoe.name) for shoe in response.shoes if not shoe.contact_arcs]
    if not not_touching:
        return "self-energising: none, every shoe is trailing"
    others = "; every other shoe is trailing" if len(not_touching) < len(response.shoes) else ""
    return f"self-energising: none, shoe {', '.join(not_touching)} does not touch{others}"


def _self_locking_as_line(response: "Response") -> str:
    """The friction relative to the limits of self-locking as a line.

    The limit of the rigid-shoe law may belong to a shoe that the actuation does not press on the
    drum; the line then says so.
    """
    from drumlin.response.self_locking import SelfLocking

    locking = response.self_locking
    assert locking is not None
    line = locking.line()
    if not isinstance(locking, SelfLocking) or math.isinf(locking.law.friction):
        return line
    not_touching = {shoe.name for shoe in response.shoes if not shoe.contact_arcs}
    names = [repr(name) for name in locking.law.shoes if name in not_touching]
    if names:
        line += f" (of shoe {', '.join(names)}, which does not touch here)"
    return line


class _NotesByPlaceInPrintout(NamedTuple):
    """The notes of a response, sorted by the place where the notes are printed.

    Attributes
    ----------
    lines_above_table : lines on shoes without contact, printed above the table of shoes
    warnings : lines that begin with "warning:" or "note:", printed below the table
    lines_on_supports : lines on the supports of each body and on corrections of a mesh file,
        printed below the estimated errors
    lines_of_verbose_answer : all other lines, printed with --verbose only
    """

    lines_above_table: list[str]
    warnings: list[str]
    lines_on_supports: list[str]
    lines_of_verbose_answer: list[str]

    @classmethod
    def notes_of_response_by_place_in_printout(
        cls, response: "Response"
    ) -> "_NotesByPlaceInPrintout":
        """The notes of a response, sorted by the place of the printed answer where they stand.

        Some notes stand above the table, some below it, some at the end, and some are printed only
        with --verbose. The words of a note tell its place.
        """
        from drumlin.response.show import BEGIN_OF_NOTE_ON_PEAKS_OVER_WIDTH

        notes = cls([], [], [], [])
        for line in response.notes:
            if ": no contact" in line:
                notes.lines_above_table.append(line)
            elif line.startswith(("warning:", "note:")):
                notes.warnings.append(line)
            elif line.startswith(BEGIN_OF_NOTE_ON_PEAKS_OVER_WIDTH):
                # The line stands directly below the table of shoes.
                continue
            elif line.startswith("held:") or ": its mesh: " in line:
                notes.lines_on_supports.append(line)
            else:
                notes.lines_of_verbose_answer.append(line)
        return notes


def _print_torque_and_brake_factor(brake: "Brake", response: "Response") -> None:
    """Print the torque of a brake, or the braking force of a brake on a plane, as one line.

    The brake factor follows, if the brake has one. A second line is printed if the solution has not
    converged.
    """
    from drumlin.response.merit import brake_factor

    surface = brake.surface
    factor = brake_factor(brake, response)
    line = (
        f"{surface.word_for_torque_or_brake_force} {response.effect:.6g} "
        f"{surface.unit_of_torque_or_brake_force}"
    )
    if factor is not None:
        line += (
            f", brake factor {factor:.4g} = {surface.brake_factor_formula}, F the mean actuation "
            "force"
        )
    print_line_folded_to_terminal_width(line)
    if not response.converged:
        print_line_folded_to_terminal_width("not converged")


def _ways_to_smaller_plane_stress_error_as_lines(
    brake: "Brake", found: "EstimatedErrorOfPlaneStress"
) -> "Iterator[str]":
    """Yield a line that names the options with a smaller error than plane stress, if it is large.

    There is no line where no option is possible, and none below LARGE_PLANE_STRESS_ERROR.
    """
    from drumlin.models import MODELS

    if found.unknown or max(found.brake.values()) < LARGE_PLANE_STRESS_ERROR:
        return
    ways = [] if found.corrected else ["--finite-width corrects the answer for the widths"]
    if MODELS["solid"].why_not(brake) is None:
        ways.append("--model solid computes the shoes in three dimensions")
    if ways:
        yield f"smaller errors: {'; '.join(ways)}"


def _print_table_of_shoes(brake: "Brake", response: "Response") -> None:
    """Print a table with a row for each shoe.

    A line below the table tells if the ends of a lining were left out in the search for the peak
    pressure. For a model of solid shoes a note of the response gives the peaks over arc and width.
    """
    from drumlin.response.response import place_of_peak_pressure
    from drumlin.response.show import BEGIN_OF_NOTE_ON_PEAKS_OVER_WIDTH

    places = [place_of_peak_pressure(brake, i, shoe) for i, shoe in enumerate(response.shoes)]
    shown = brake.surface.si_to_shown_unit_factor
    # The list `at` has the angle or length where the pressure of each shoe peaks, as text. Adding
    # 0.0 turns a negative zero into a zero without sign.
    at = ["" if place is None else f"{place.at * shown + 0.0:.1f}" for place in places]
    print_table_fitted_to_terminal(
        _columns_of_shoe_table(brake, response, at), SHOE_COLUMNS_DROPPED_ON_NARROW_TERMINAL
    )
    if any(place is not None and place.zone for place in places):
        print_line_folded_to_terminal_width(
            "peak p: the largest, half a lining's thickness at each end left out"
        )
    for line in response.notes:
        if line.startswith(BEGIN_OF_NOTE_ON_PEAKS_OVER_WIDTH):
            print_line_folded_to_terminal_width(line)


def _columns_of_shoe_table(
    brake: "Brake", response: "Response", at: list[str]
) -> dict[str, PrintedColumn]:
    """The columns of the printed table of shoes, by a key such as "effect" for the torque.

    `at` holds the place where the pressure of each shoe peaks, as text.
    """
    from drumlin.response.show import text_of_contact_arcs

    surface = brake.surface
    unit = surface.shown_unit
    table = {
        "shoe": PrintedColumn("shoe", "shoe\n", [], is_left_aligned=True),
        "effect": PrintedColumn("torque", surface.heading_of_torque_or_brake_force, []),
        "normal_force": PrintedColumn("normal force", "normal\nforce [N]", []),
        "peak": PrintedColumn("peak pressure", "peak p\n[MPa]", []),
        "at": PrintedColumn("where the pressure peaks", f"at\n[{unit}]", at),
        "contact": PrintedColumn("contact", f"contact\n[{unit}]", []),
        "reaction": PrintedColumn("hinge reaction", "reaction\n[N]", []),
        "shoe_factor": PrintedColumn("shoe factor", f"{surface.brake_factor_formula}\n", []),
    }
    for i, shoe in enumerate(response.shoes):
        effect = response.effects[i]
        force = abs(brake.shoes[i].actuation.force) * brake.length_per_surface_coordinate
        cells = {
            "shoe": shoe.name,
            "effect": f"{effect:.6g}",
            "normal_force": f"{shoe.normal_force:.6g}",
            "peak": f"{shoe.peak_pressure * 1e-6:.4g}",
            # In the cell of a shoe, each arc in contact stands on a line of its own.
            "contact": text_of_contact_arcs(shoe, surface).replace(", ", "\n"),
            "reaction": f"{math.hypot(*shoe.hinge_reaction):.6g}",
            # A shoe without an actuation force of its own has no shoe factor.
            "shoe_factor": f"{effect / force:.3f}" if force else "",
        }
        for key, cell in cells.items():
            table[key].cells.append(cell)
    return table


def _print_lines_of_verbose_answer(response: "Response", notes: list[str]) -> None:
    """Print the lines that only --verbose shows.

    These lines give hinge reaction and figures of merit of each shoe, solution steps, balance of
    forces, computing times, the given notes and neglected effects.
    """
    from drumlin.laws.rigid import UNUSED_KEYS_LINE_START

    # One line for each shoe: the force of its hinge and its figures of merit.
    for shoe, merit in zip(response.shoes, response.merits, strict=True):
        x, y = shoe.hinge_reaction
        figures = _figures_of_merit_as_line(merit)
        print_line_folded_to_terminal_width(
            f"shoe {shoe.name!r}: hinge reaction ({x:.6g}, {y:.6g}) N; {figures}"
        )
    times = [f"{phase} {seconds * 1e3:.1f}" for phase, seconds in response.seconds.items()]
    if times:
        balance = response.balance
        print_line_folded_to_terminal_width(
            f"{response.iterations} active-set steps; "
            f"balance: force {error_text_in_percent(balance.force)}, "
            f"moment {error_text_in_percent(balance.moment)}; ms: {', '.join(times)}"
        )
    for line in notes:
        print_line_folded_to_terminal_width(line)
    # The last lines name effects that the model neglects.
    for line in response.left_out:
        if not line.startswith(UNUSED_KEYS_LINE_START):
            print_line_folded_to_terminal_width(f"left out: {line}")


def _figures_of_merit_as_line(merit: "FiguresOfMeritOnDrum | FiguresOfMeritOnPlane") -> str:
    """The figures of merit of one shoe as a line of text; unknown figures are left out.

    The figures have the same names as in the JSON file. The angle of the resultant force is in
    degrees.
    """
    values = {key: value for key, value in merit._asdict().items() if value is not None}
    angle = values.pop("resultant_angle", None)
    # Adding 0.0 turns a negative zero into a zero without sign.
    parts = [] if angle is None else [f"resultant at {round(math.degrees(angle), 3) + 0.0:g} deg"]
    parts += [f"{key} {value:.5g}" for key, value in values.items()]
    return ", ".join(parts)
