"""A response as a person at the terminal reads it: the answer as a small table, then what to know
about it.
"""

import math
from typing import TYPE_CHECKING

from drumlin.cli.terminal import Column, print_columns, tell

if TYPE_CHECKING:
    from drumlin.brake.brake import Brake
    from drumlin.response.response import FlatMerit, Merit, Response

LEAST = ["shoe_factor", "reaction", "normal_force", "at"]


def print_response(brake: "Brake", response: "Response", *, verbose: bool = False) -> None:
    """Torque and brake factor, a row a shoe, warnings, how bodies are held; shoes that do not touch
    are said first.

    verbose: figures of merit, how it was found, how long that took and what is left out, too.
    """
    from drumlin.response.merit import brake_factor

    surface = brake.surface
    what = surface.effect
    tell(f"{brake.title}: {response.model}, {brake.motion}, mu = {brake.friction:g}")
    apart = {line for line in response.notes if ": no contact" in line}
    warned = [line for line in response.notes if line.startswith("warning:")]
    held = [line for line in response.notes if line.startswith("held:")]
    for line in response.notes:
        if line in apart:
            tell(line)
    factor = brake_factor(brake, response)
    said = (
        ""
        if factor is None
        else f", brake factor {factor:.4g} = {surface.factor}, F the mean actuation force"
    )
    tell(f"{what} {response.effect:.6g} {surface.effect_unit}{said}")
    if not response.converged:
        tell("not converged")
    _print_shoes(brake, response)
    energised = [shoe.name for shoe in response.shoes if shoe.self_energising]
    if energised:
        tell(f"self-energising: {', '.join(energised)}")
    for line in warned:
        tell(line)
    if response.error is not None:
        more = {"torque": what, "peak": "peak pressure", "reaction": "hinge reaction"}
        errors = [
            f", {name} {response.error[key]:.1e}"
            for key, name in more.items()
            if key in response.error
        ]
        tell(
            f"estimated error: p {response.error['pressure']:.1e} (L2, worst shoe){''.join(errors)}"
        )
    for line in held:
        tell(line)
    if verbose:
        _print_more(response, apart.union(warned, held))


def _print_shoes(brake: "Brake", response: "Response") -> None:
    from drumlin.response.response import peak_place
    from drumlin.response.show import arcs_text

    surface = brake.surface
    unit = surface.shown_unit
    places = [peak_place(brake, i, shoe) for i, shoe in enumerate(response.shoes)]
    at = ["" if place is None else f"{place.at * surface.shown + 0.0:.1f}" for place in places]
    effects = response.effects
    forces = [abs(shoe.actuation.force) * brake.scale_factor for shoe in brake.shoes]
    columns = {
        "shoe": Column("shoe", "shoe\n", [shoe.name for shoe in response.shoes], left=True),
        "effect": Column("torque", surface.heading, [f"{value:.6g}" for value in effects]),
        "normal_force": Column(
            "normal force",
            "normal\nforce [N]",
            [f"{shoe.normal_force:.6g}" for shoe in response.shoes],
        ),
        "peak": Column(
            "peak pressure",
            "peak p\n[MPa]",
            [f"{shoe.peak_pressure * 1e-6:.4g}" for shoe in response.shoes],
        ),
        "at": Column("where the pressure peaks", f"at\n[{unit}]", at),
        "contact": Column(
            "contact",
            f"contact\n[{unit}]",
            [arcs_text(shoe, surface).replace(", ", "\n") for shoe in response.shoes],
        ),
        "reaction": Column(
            "hinge reaction",
            "reaction\n[N]",
            [f"{math.hypot(*shoe.hinge_reaction):.6g}" for shoe in response.shoes],
        ),
        "shoe_factor": Column(
            "shoe factor",
            f"{surface.factor}\n",
            [
                f"{value / force:.3f}" if force else ""
                for value, force in zip(effects, forces, strict=True)
            ],
        ),
    }
    print_columns(columns, LEAST)
    if any(place is not None and place.zone for place in places):
        tell("peak p: the largest, half a lining's thickness at each end left out")


def _print_more(response: "Response", told: set[str]) -> None:
    for shoe, merit in zip(response.shoes, response.merits, strict=True):
        x, y = shoe.hinge_reaction
        tell(f"shoe {shoe.name!r}: hinge reaction ({x:.6g}, {y:.6g}) N; {_merit_text(merit)}")
    spent = ", ".join(f"{phase} {seconds * 1e3:.1f}" for phase, seconds in response.seconds.items())
    if spent:
        tell(f"{response.iterations} active-set steps; balance: force {response.balance.force:.1e}, "
             f"moment {response.balance.moment:.1e}; ms: {spent}")  # fmt: skip
    for line in response.notes:
        if line not in told:
            tell(line)
    for line in response.left_out:
        tell(f"left out: {line}")


def _merit_text(merit: "Merit | FlatMerit") -> str:
    """Figures of merit for people: names as in the JSON, the angle in degrees; without those that
    are None.
    """
    values = {key: value for key, value in merit._asdict().items() if value is not None}
    angle = values.pop("resultant_angle", None)
    said = [] if angle is None else [f"resultant at {round(math.degrees(angle), 3) + 0.0:g} deg"]
    return ", ".join(said + [f"{key} {value:.5g}" for key, value in values.items()])
