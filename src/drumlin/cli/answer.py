"""Printing of a response: warnings that matter most, a small table, the estimated errors."""

import math
from typing import TYPE_CHECKING, NamedTuple

from drumlin.cli.terminal import Column, print_columns, tell

if TYPE_CHECKING:
    from collections.abc import Mapping

    from drumlin.brake.brake import Brake
    from drumlin.response.response import FlatMerit, Merit, Response

LEAST_OF_SHOES = ["shoe_factor", "reaction", "normal_force", "at"]
"""Columns of the shoes' table that are left out on a narrow terminal, the first of them first."""


def print_response(brake: "Brake", response: "Response", *, verbose: bool = False) -> None:
    """Print torque and brake factor, a row a shoe, warnings and the estimated errors.

    Shoes that do not touch come first. verbose: whether figures of merit, steps, times and what is
    neglected follow.
    """
    notes = _Notes.of(response)
    tell(f"{brake.title}: {response.model}, {brake.motion}, mu = {brake.friction:g}")
    for line in notes.apart:
        tell(line)
    _print_effect(brake, response)
    _print_shoes(brake, response)
    # The warnings and the stated errors follow the table, where a reader looks last.
    energised = [shoe.name for shoe in response.shoes if shoe.self_energising]
    if energised:
        tell(f"self-energising: {', '.join(energised)}")
    for line in notes.warnings:
        tell(line)
    if response.error is not None:
        tell(_error_text(brake.surface.effect, response.error))
    if response.plane_stress_error is not None:
        tell(_model_error_text(brake.surface.effect, response))
    for line in notes.held:
        tell(line)
    if verbose:
        _print_more(response, notes.others)


class _Notes(NamedTuple):
    """The notes of a response by where they are printed.

    `apart`: shoes without contact. `warnings`. `held`: the supports of each body, and what was done
    to the mesh of a file. `others`: what is printed with --verbose only.
    """

    apart: list[str]
    warnings: list[str]
    held: list[str]
    others: list[str]

    @classmethod
    def of(cls, response: "Response") -> "_Notes":
        """Sort the notes of a response."""
        notes = cls([], [], [], [])
        for line in response.notes:
            if ": no contact" in line:
                notes.apart.append(line)
            elif line.startswith("warning:"):
                notes.warnings.append(line)
            elif line.startswith("held:") or ": its mesh: " in line:
                notes.held.append(line)
            else:
                notes.others.append(line)
        return notes


def _print_effect(brake: "Brake", response: "Response") -> None:
    """Print the torque, on a plane the braking force, and the brake factor where there is one."""
    from drumlin.response.merit import brake_factor

    surface = brake.surface
    factor = brake_factor(brake, response)
    line = f"{surface.effect} {response.effect:.6g} {surface.effect_unit}"
    if factor is not None:
        line += f", brake factor {factor:.4g} = {surface.factor}, F the mean actuation force"
    tell(line)
    if not response.converged:
        tell("not converged")


def _error_text(effect: str, error: "Mapping[str, float]") -> str:
    """The estimated relative errors of a response as a line."""
    line = f"estimated error: p {error['pressure']:.1e} (L2, worst shoe)"
    names = {"torque": effect, "peak": "peak pressure", "reaction": "hinge reaction"}
    for key, name in names.items():
        if key in error:
            line += f", {name} {error[key]:.1e}"
    return line


def _model_error_text(effect: str, response: "Response") -> str:
    """The estimated errors of plane stress itself as a line, alone and with those of the mesh."""
    found, mesh = response.plane_stress_error, response.error
    # Only answers by plane stress have such errors.
    assert found is not None
    if found.unknown:
        return f"error of plane stress itself: not known, {found.unknown}"
    names = {"torque": effect, "reaction": "hinge reaction"}
    line = f"error of plane stress itself: p {found.brake['pressure']:.1e} (mean over the width)"
    for key, name in names.items():
        line += f", {name} {found.brake[key]:.1e}"
    line += ", peak pressure not known"
    if mesh is None:
        return line
    both = {key: found.brake[key] + mesh[key] for key in ("pressure", *names) if key in mesh}
    line += f"; both together: p {both.pop('pressure'):.1e}"
    for key, error in both.items():
        line += f", {names[key]} {error:.1e}"
    return line


def _print_shoes(brake: "Brake", response: "Response") -> None:
    """Print a row a shoe, and a line on where its peak pressure is looked for."""
    from drumlin.response.response import peak_place

    places = [peak_place(brake, i, shoe) for i, shoe in enumerate(response.shoes)]
    shown = brake.surface.shown
    # Adding 0.0 turns a negative zero into a zero without sign.
    at = ["" if place is None else f"{place.at * shown + 0.0:.1f}" for place in places]
    print_columns(_shoes_table(brake, response, at), LEAST_OF_SHOES)
    if any(place is not None and place.zone for place in places):
        tell("peak p: the largest, half a lining's thickness at each end left out")


def _shoes_table(brake: "Brake", response: "Response", at: list[str]) -> dict[str, Column]:
    """The columns of the shoes' table; `at`: where each pressure peaks, as a text."""
    from drumlin.response.show import arcs_text

    surface = brake.surface
    unit = surface.shown_unit
    table = {
        "shoe": Column("shoe", "shoe\n", [], left=True),
        "effect": Column("torque", surface.heading, []),
        "normal_force": Column("normal force", "normal\nforce [N]", []),
        "peak": Column("peak pressure", "peak p\n[MPa]", []),
        "at": Column("where the pressure peaks", f"at\n[{unit}]", at),
        "contact": Column("contact", f"contact\n[{unit}]", []),
        "reaction": Column("hinge reaction", "reaction\n[N]", []),
        "shoe_factor": Column("shoe factor", f"{surface.factor}\n", []),
    }
    for i, shoe in enumerate(response.shoes):
        effect = response.effects[i]
        force = abs(brake.shoes[i].actuation.force) * brake.scale_factor
        cells = {
            "shoe": shoe.name,
            "effect": f"{effect:.6g}",
            "normal_force": f"{shoe.normal_force:.6g}",
            "peak": f"{shoe.peak_pressure * 1e-6:.4g}",
            # Each arc of contact has a line of its own.
            "contact": arcs_text(shoe, surface).replace(", ", "\n"),
            "reaction": f"{math.hypot(*shoe.hinge_reaction):.6g}",
            # A shoe without a force of its own has no factor.
            "shoe_factor": f"{effect / force:.3f}" if force else "",
        }
        for key, cell in cells.items():
            table[key].cells.append(cell)
    return table


def _print_more(response: "Response", notes: list[str]) -> None:
    """Print reactions, figures of merit, steps, balance, times, notes and what is neglected."""
    for shoe, merit in zip(response.shoes, response.merits, strict=True):
        x, y = shoe.hinge_reaction
        tell(f"shoe {shoe.name!r}: hinge reaction ({x:.6g}, {y:.6g}) N; {_merit_text(merit)}")
    times = [f"{phase} {seconds * 1e3:.1f}" for phase, seconds in response.seconds.items()]
    if times:
        balance = response.balance
        tell(
            f"{response.iterations} active-set steps; balance: force {balance.force:.1e}, "
            f"moment {balance.moment:.1e}; ms: {', '.join(times)}"
        )
    for line in notes:
        tell(line)
    for line in response.left_out:
        tell(f"left out: {line}")


def _merit_text(merit: "Merit | FlatMerit") -> str:
    """The known figures of merit as a line: names as in the JSON, the angle in degrees."""
    values = {key: value for key, value in merit._asdict().items() if value is not None}
    angle = values.pop("resultant_angle", None)
    # Adding 0.0 turns a negative zero into a zero without sign.
    parts = [] if angle is None else [f"resultant at {round(math.degrees(angle), 3) + 0.0:g} deg"]
    parts += [f"{key} {value:.5g}" for key, value in values.items()]
    return ", ".join(parts)
