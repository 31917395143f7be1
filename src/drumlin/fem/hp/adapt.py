"""A brake to a tolerance: finer levels until the estimated errors are below it.

The estimate. On successive levels errors fall by a factor of about four, so that the distance of a level's response from
the one before it, d_k >= e_(k-1) - e_k, is some three times its own error e_k. The distance itself is stated, an upper
value. Where it is small by chance, as the difference of two numbers may be, the ones before it count, by the factor that
errors fall at best:

    e_k <= max_j d_(k-j) / FASTEST^j
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from drumlin.brake import Brake
from drumlin.compare import pressure_distance
from drumlin.errors import BadInput, NoAnswer
from drumlin.fem.hp.levels import LEVELS, Respond, steps
from drumlin.response import Response

FASTEST = 4.0  # factor by which errors are trusted to fall from level to level
ROUND_OFF = 10.0  # times what the elimination has lost of a unit force: what that may be in p


class Tolerance(NamedTuple):
    """Relative errors of p (L2 outside the edge zones, worst shoe) and of the torque that are allowed."""

    pressure: float
    torque: float


DEFAULT = Tolerance(5e-3, 1e-4)


def adapt(brake: Brake, tolerance: Tolerance, respond: Respond, *, must: bool = True) -> Response:
    """The response whose estimated errors are within the tolerance.

    Raises NoAnswer, saying what was reached, where the levels do not suffice, unless it need not be; BadInput for a
    brake with a mesh file.
    """
    responses: list[Response] = []
    error: dict[str, float] = {}
    unknowns, lost = 0, 0.0
    for made, found in steps(brake, respond):
        responses.append(found)
        unknowns = max(body.unknowns for body in made.bodies)
        lost = max(body.condensed.lost for body in made.bodies)
        if len(responses) > 1:
            error = estimate(responses, ROUND_OFF * lost)
            if error["pressure"] <= tolerance.pressure and error["torque"] <= tolerance.torque:
                return _final(responses, error, unknowns, "")
    said = f"estimated error of p {error['pressure']:.1e}, of the torque {error['torque']:.1e}"
    wanted = f"tolerance {tolerance.pressure:g} not reached on {len(responses)} levels"
    if must:
        raise NoAnswer(f"{wanted} of up to {unknowns} unknowns a shoe: {said}")
    return _final(responses, error, unknowns, wanted)


def estimate(responses: Sequence[Response], floor: float = 0.0) -> dict[str, float]:
    """Upper values of the relative errors of the last of the responses, each on a finer level than the one before.

    `reaction`: of the hinges; `peak_pressure`; both of the worst shoe. floor: what round-off may be at least.
    """
    found = {name: 0.0 for name in DISTANCES}
    for a, b in pairwise(responses):
        for name, distance in DISTANCES.items():
            found[name] = max(distance(a, b), found[name] / FASTEST)
    return {name: value + floor * (value > 0) for name, value in found.items()}


def _pressure(a: Response, b: Response) -> float:
    return max(
        pressure_distance(x, y) if y.pressure.any() else float(x.pressure.any())
        for x, y in zip(a.shoes, b.shoes, strict=True)
    )


def _torque(a: Response, b: Response) -> float:
    """The torque's, shoes not cancelling."""
    return sum(abs(x.torque - y.torque) for x, y in zip(a.shoes, b.shoes, strict=True)) / (b.torque or 1.0)


def _reaction(a: Response, b: Response) -> float:
    pairs = [(x.hinge_reaction, y.hinge_reaction) for x, y in zip(a.shoes, b.shoes, strict=True)]
    return max(float(np.linalg.norm(x - y) / (np.linalg.norm(y) or 1.0)) for x, y in pairs)


def _peak(a: Response, b: Response) -> float:
    pairs = [(x.peak_pressure, y.peak_pressure) for x, y in zip(a.shoes, b.shoes, strict=True)]
    return max(abs(x - y) / (y or 1.0) for x, y in pairs)


DISTANCES: dict[str, Callable[[Response, Response], float]] = {
    "pressure": _pressure,
    "torque": _torque,
    "reaction": _reaction,
    "peak_pressure": _peak,
}


def check_tolerance(brake: Brake, tolerance: float) -> None:
    """Raise BadInput for a tolerance out of range, and for a brake with a mesh file, which is not refined."""
    if not 0 < tolerance < 1:
        raise BadInput(f"--tolerance = {tolerance:g}: must be greater than 0 and less than 1")
    for shoe in brake.shoes:
        if shoe.mesh is not None:
            raise BadInput(f"--tolerance = {tolerance:g}: shoe {shoe.name!r} has a mesh file, which is not refined")


def _final(responses: Sequence[Response], error: dict[str, float], unknowns: int, missed: str) -> Response:
    """The last response with its error, the time of all levels and the steps of the longest."""
    seconds: dict[str, float] = {}
    for response in responses:
        for phase, spent in response.seconds.items():
            seconds[phase] = seconds.get(phase, 0.0) + spent
    note = f"level {len(responses)} of {len(LEVELS)}: {unknowns} unknowns a shoe"
    return replace(
        responses[-1],
        error=error,
        seconds=seconds,
        iterations=max(response.iterations for response in responses),
        notes=(*responses[-1].notes, f"{note}; {missed}" if missed else note),
    )
