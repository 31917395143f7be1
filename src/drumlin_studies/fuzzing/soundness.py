"""Checks of a response: finite, not negative, in balance, and with the torque of its pressure."""

import tempfile
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from drumlin.brake.brake import Brake
from drumlin.brake.plane_brake import read_drum_or_plane_brake
from drumlin.models import MODELS
from drumlin.response.balance import resultant_of_contact_on_shoe
from drumlin.response.response import Response
from drumlin_studies.fuzzing.inputs import FilesAndCommandLineOfBrokenInput

LARGEST_IMBALANCE_OF_RIGHT_RESPONSE = 1e-6
"""Imbalance of forces or moments, relative to the applied ones, above which a response is wrong.

The value is a judgement. It is far above round-off, and far below an error that users notice.
"""
LARGEST_TORQUE_DIFFERENCE_FROM_FRICTION_MOMENT = 0.03
"""Difference between a shoe's torque and the moment of its friction, relative to the torque, above
which the response is wrong.

The lining of a mesh file may be off the drum by 1 % of the drum's radius. The length of the lining
and the lever arm of the friction then have errors of 1 % each.
"""


def explain_wrong_answer_to_input(given: FilesAndCommandLineOfBrokenInput) -> str:
    """Why the response to an input of `drumlin solve` must be wrong; "" if it may be right.

    The brake is read and solved again with the options of the input. Errors of this solve are
    raised, and so are warnings, as errors.
    """
    options: dict[str, Any] = {}
    if "--elements" in given.words:
        options["elements"] = int(_word_after_option(given.words, "--elements"))
    model = _word_after_option(given.words, "--model") if "--model" in given.words else "fem"
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("error")
        for name, data in given.files.items():
            (Path(folder) / name).write_bytes(data)
        brake = read_drum_or_plane_brake(Path(folder) / "b.toml")
        return explain_wrong_response(brake, MODELS[model].solve(brake, **options))


def _word_after_option(words: list[str], option: str) -> str:
    """The word that follows an option on a command line. Raises ValueError without the option."""
    return words[words.index(option) + 1]


def explain_wrong_response(brake: Brake, response: Response) -> str:
    """Why the response of a brake must be wrong, as text; "" if it may be right."""
    numbers = [response.torque, response.balance.force, response.balance.moment]
    for shoe in response.shoes:
        numbers += [shoe.torque, shoe.normal_force, shoe.peak_pressure]
        numbers += [*shoe.hinge_reaction, *shoe.pressure]
    if not np.isfinite(numbers).all():
        return "not finite"
    if response.torque < 0 or any((shoe.pressure < 0).any() for shoe in response.shoes):
        return "negative torque or pressure"
    if max(response.balance.force, response.balance.moment) > LARGEST_IMBALANCE_OF_RIGHT_RESPONSE:
        return f"out of balance by {response.balance}"
    # Two kinds of responses are not compared with the moment of the friction: a brake on a plane
    # has no torque, and the foundation model computes the torque from springs.
    if brake.surface.is_plane_and_not_drum or response.model == "foundation":
        return ""
    for i, shoe in enumerate(response.shoes):
        by_pressure = abs(resultant_of_contact_on_shoe(brake, i, shoe).moment)
        if (
            abs(by_pressure - shoe.torque)
            > LARGEST_TORQUE_DIFFERENCE_FROM_FRICTION_MOMENT * shoe.torque + 1e-300
        ):
            return f"torque {shoe.torque:g} N m, of its pressure {by_pressure:g} N m"
    return ""
