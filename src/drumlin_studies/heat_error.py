"""Judge the errors that drumlin states for random brakes with heated parts.

    python -m drumlin_studies.heat_error FIRST LAST FILE

draws the hot brakes with the seeds FIRST to LAST - 1, solves each to the tolerances
TOLERANCES_OF_HOT_BRAKE_SOLVES, and prints the ratios of stated to true errors. True errors are
differences from a solution on much finer meshes. FILE keeps the errors of each brake. A later run
only solves the brakes that are not in FILE, and prints the summary of all brakes in FILE.
"""

import json
import math
import sys
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.fem.solve import solve
from drumlin_studies.random_brake import draw_random_brake
from drumlin_studies.random_kinds import draw_random_brake_of_support_kind
from drumlin_studies.stated_true import (
    QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED,
    FarFinerSolutionOfBrake,
    row_of_stated_and_true_errors,
    solve_fine_reference_by_hp_elements,
    stated_over_true_error_of_row,
    summary_rows_of_stated_errors,
)

LINING_STRAINS, BODY_STRAINS = (1e-4, 1e-2), (3e-5, 1e-3)
"""Ranges (smallest and largest) of the free thermal strain: first of hot linings and backings, then
of hot bodies and drums.

A temperature rise of 10 K causes a strain of 1e-4 in steel, and a rise of 80 K a strain of 1e-3. A
rise of 300 K causes a strain of 1e-2 in an organic lining.
"""
TOLERANCES_OF_HOT_BRAKE_SOLVES = (1e-2, 1e-3)
"""Relative tolerances to which each hot brake is solved."""
PROBABILITY_OF_HEATED_PART = 0.7
"""Probability with which a drum, lining, backing or body is heated."""


def draw_random_brake_with_heated_parts(seed: int) -> Brake:
    """Draw the random brake of a seed, with some of its parts heated.

    A straight beam has one temperature throughout. The plane of a brake on a plane is not heated.
    Raises BadInput if heat is not modelled for the brake, for example with a cam.
    """
    rng = np.random.default_rng([seed, 20])
    brake = draw_random_brake(seed) if seed % 2 else draw_random_brake_of_support_kind(seed)
    if brake.actuation is not None and brake.actuation.is_cam_or_wedge:
        raise BadInput("a cam on heated shoes is not modelled")
    changes: dict[str, Any] = {}
    if hasattr(brake, "drum") and rng.random() < PROBABILITY_OF_HEATED_PART:
        changes |= {"drum.expansion": 1e-5}
        changes |= _draw_random_temperature_rises_of_part(
            rng, "drum", BODY_STRAINS, gradient=brake.ring is not None
        )
    for i, shoe in enumerate(brake.shoes):
        for key, strains in (
            ("lining", LINING_STRAINS),
            ("backing", LINING_STRAINS),
            ("body", BODY_STRAINS),
        ):
            part = getattr(shoe, key)
            if part is None or part.material is None or rng.random() > PROBABILITY_OF_HEATED_PART:
                continue
            name = f"shoe[{i}].{key}"
            coefficient = "expansion" if hasattr(part.material, "E") else "expansion_along"
            changes[f"{name}.material.{coefficient}"] = 1e-5
            is_beam = getattr(part, "shape", "arc") == "beam"
            changes |= _draw_random_temperature_rises_of_part(
                rng, name, strains, gradient=not is_beam
            )
    return vary(brake, changes)


def _draw_random_temperature_rises_of_part(
    rng: np.random.Generator, name: str, strains: tuple[float, float], *, gradient: bool
) -> dict[str, float]:
    """Draw the temperature rises [K] of a part whose thermal expansion is 1e-5 1/K.

    The result has the temperature rises by their keys of the brake file.

    Parameters
    ----------
    rng : Generator
        The generator of random numbers.
    name : str
        Name of the part in the brake.
    strains : tuple of two floats
        Smallest and largest free thermal strain.
    gradient : bool
        Whether the part's back, away from the contact, may have another temperature than its front.
    """
    low, high = np.log(strains)
    rises = np.exp(rng.uniform(low, high, 2)) / 1e-5
    found = {f"{name}.temperature_rise": float(rises[0])}
    if gradient and rng.random() < 0.5:
        found[f"{name}.back_temperature_rise"] = float(rises[1])
    return found


def rows_of_stated_and_true_errors_of_drawn_brake(
    draw: Callable[[int], Brake], seed: int
) -> list[dict[str, Any]]:
    """A row for each tolerance with the stated and true errors of the random brake of a seed.

    `draw` is a function that draws the brake of a seed, and may raise BadInput. A brake that is not
    drawn has no rows.
    """
    try:
        brake = draw(seed)
    except BadInput as error:
        sys.stdout.write(f"{seed}: not drawn: {error}\n")
        return []
    truth: FarFinerSolutionOfBrake | None = None
    failure = ""
    try:
        truth = solve_fine_reference_by_hp_elements(brake, min(TOLERANCES_OF_HOT_BRAKE_SOLVES))
    except (NoAnswer, BadInput) as error:
        failure = str(error)
    one = partial(row_of_stated_and_true_errors, brake, solve=solve, true=truth, failure=failure)
    rows = [one(tolerance) for tolerance in TOLERANCES_OF_HOT_BRAKE_SOLVES]
    # A brake on a plane has a braking force in place of a torque. The fine solution does not
    # contain this force. Errors of the torque are therefore left out on a plane.
    left_out = {"true_torque", "stated_torque"} if brake.surface.is_plane_and_not_drum else set()
    return [{key: v for key, v in row.items() if key not in left_out} for row in rows]


def _text_on_outcome_and_smallest_ratio(row: Mapping[str, Any]) -> str:
    """Text on a solve: its outcome, and its smallest ratio of a stated to a true error."""
    ratios = {
        name: stated_over_true_error_of_row(row, name)
        for name in QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED
    }
    known = {name: ratio for name, ratio in ratios.items() if not math.isnan(ratio)}
    if not known:
        return f"{row['outcome']} ({row['reason']})"
    name = min(known, key=lambda each: known[each])
    return f"{row['outcome']} ({name} {known[name]:.2g})"


def read_rows_of_errors_by_seed(path: Path) -> dict[int, list[dict[str, Any]]]:
    """The rows of errors that a file keeps, by the seed of the brake; empty if there is no file.

    Each line of the file is the seed and the rows of one brake, in JSON.
    """
    if not path.exists():
        return {}
    lines = path.read_text(encoding="utf-8").splitlines()
    judged = map(json.loads, lines)
    return {one["seed"]: one["rows"] for one in judged}


def judge_brakes_of_seeds_and_print_summary(
    draw: Callable[[int], Brake], first: int, last: int, path: Path
) -> None:
    """Judge the brakes that are not in a file, append their rows, and print a summary of all rows.

    Parameters
    ----------
    draw : function
        Draws the brake of a seed, and may raise BadInput.
    first, last : int
        The seeds are those from `first` to below `last`.
    path : Path
        The file that keeps the rows.
    """
    judged = read_rows_of_errors_by_seed(path)
    for seed in sorted({*range(first, last)} - judged.keys()):
        own = judged[seed] = rows_of_stated_and_true_errors_of_drawn_brake(draw, seed)
        with path.open("a", encoding="utf-8") as file:
            file.write(json.dumps({"seed": seed, "rows": own}) + "\n")
        sys.stdout.write(f"{seed}: {', '.join(map(_text_on_outcome_and_smallest_ratio, own))}\n")
        sys.stdout.flush()
    rows = [row for own in judged.values() for row in own]
    for row in summary_rows_of_stated_errors(rows):
        shown = {key: f"{v:.4g}" if isinstance(v, float) else v for key, v in row.items()}
        sys.stdout.write(f"{shown}\n")


def judge_brakes_of_command_line(draw: Callable[[int], Brake]) -> None:
    """Judge the brakes that the command line names: the arguments FIRST, LAST and FILE.

    `draw` is a function that draws the brake of a seed, and may raise BadInput.
    """
    judge_brakes_of_seeds_and_print_summary(
        draw, int(sys.argv[1]), int(sys.argv[2]), Path(sys.argv[3])
    )


if __name__ == "__main__":
    judge_brakes_of_command_line(draw_random_brake_with_heated_parts)
