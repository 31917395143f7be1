"""Checks that an answer is finite, in balance, and has the torque of its pressure."""

import tempfile
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from drumlin.brake.brake import Brake
from drumlin.brake.plane_brake import read_any
from drumlin.models import MODELS
from drumlin.response.balance import contact_resultant
from drumlin.response.response import Response
from drumlin_studies.fuzzing.inputs import BrokenInput

SOUND_IMBALANCE = 1e-6
"""Largest imbalance of a sound answer, relative to the applied forces and moments.

The value is a judgement: far above round-off, and far below an error that a user would notice.
"""
TORQUE_SLACK = 0.03
"""Largest difference between the stated torque and the torque of the pressure, relative.

The lining of a mesh may lie off the drum by 1 % of its radius. Its length and its lever are then
larger by 1 % each.
"""


def find_unsound_answer(given: BrokenInput) -> str:
    """Why the answer of a solve cannot be true; empty where it can.

    The brake is read and solved again with the options of the input. Raises what a solve raises;
    warnings are errors.
    """
    options: dict[str, Any] = {}
    if "--elements" in given.words:
        options["elements"] = int(_word_after(given.words, "--elements"))
    model = _word_after(given.words, "--model") if "--model" in given.words else "fem"
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("error")
        for name, data in given.files.items():
            (Path(folder) / name).write_bytes(data)
        brake = read_any(Path(folder) / "b.toml")
        return find_unsound_response(brake, MODELS[model].solve(brake, **options))


def _word_after(words: list[str], option: str) -> str:
    """The word that follows an option on a command line; None without the option."""
    return words[words.index(option) + 1]


def find_unsound_response(brake: Brake, response: Response) -> str:
    """Why a response cannot be true; empty where it can."""
    numbers = [response.torque, response.balance.force, response.balance.moment]
    for shoe in response.shoes:
        numbers += [shoe.torque, shoe.normal_force, shoe.peak_pressure]
        numbers += [*shoe.hinge_reaction, *shoe.pressure]
    if not np.isfinite(numbers).all():
        return "not finite"
    if response.torque < 0 or any((shoe.pressure < 0).any() for shoe in response.shoes):
        return "negative torque or pressure"
    if max(response.balance.force, response.balance.moment) > SOUND_IMBALANCE:
        return f"out of balance by {response.balance}"
    # On a plane there is no torque, and the foundation model takes the torque from its springs.
    if brake.surface.straight or response.model == "foundation":
        return ""
    for i, shoe in enumerate(response.shoes):
        by_pressure = abs(contact_resultant(brake, i, shoe).moment)
        if abs(by_pressure - shoe.torque) > TORQUE_SLACK * shoe.torque + 1e-300:
            return f"torque {shoe.torque:g} N m, of its pressure {by_pressure:g} N m"
    return ""
