"""A brake to a tolerance: finer levels until the estimated errors are below it.

The estimate. Let e_k be the error of level k and d_k its distance from the level before. If errors fall by the factor r
from level to level, then d_k >= e_(k-1) - e_k = (r - 1) e_k, so that

    e_k <= safety d_k / (r - 1),   r = d_(k-1) / d_k as observed, from SLOWEST to `steep`; at first `begin`

Where d is small by chance, as the difference of two numbers may be, what was estimated before counts, less the factor
`fastest`, and the error of p: forces and the torque go as its square, the peak as itself, by the `share` that is seen
at least. Steepness, safety and shares come from random brakes of every kind, against levels far finer (`RULES`).
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from drumlin.arrays import Floats
from drumlin.brake.drum_brake import Brake
from drumlin.errors import BadInput, NoAnswer
from drumlin.fem.assembly import Cache
from drumlin.fem.hp.levels import Respond, Step, steps
from drumlin.response.norms import pressure_distance
from drumlin.response.response import EDGE_ZONE, Response, ShoeResponse

SLOWEST = 1.3  # factor by which errors fall from level to level at least, where they do not stay


class Rule(NamedTuple):
    """How an error is estimated, see above; `power` of the error of p that it goes with, `first` and `share` of that
    which it is at least, on two levels and on more."""

    fastest: float
    begin: float
    steep: float
    safety: float
    power: int
    first: float
    share: float


RULES = {
    "pressure": Rule(fastest=8, begin=2.3, steep=3, safety=1.0, power=1, first=0, share=0),
    "torque": Rule(fastest=12, begin=2, steep=5, safety=1.3, power=2, first=1, share=0.05),
    "peak": Rule(fastest=12, begin=2, steep=5, safety=1.3, power=1, first=0.4, share=0.02),
    "reaction": Rule(fastest=12, begin=2, steep=5, safety=1.3, power=2, first=4, share=0.1),
}
"""On random brakes of 11 kinds, against curved triangles of a code of their own and against far finer levels."""
ROUND_OFF = 10.0  # times what the elimination has lost of a unit force: what that may be in p


class Tolerance(NamedTuple):
    """Relative errors of p (L2 outside the edge zones, worst shoe) and of the torque that are allowed."""

    pressure: float
    torque: float


DEFAULT = Tolerance(5e-3, 1e-4)


def adapt(
    brake: Brake,
    tolerance: Tolerance,
    respond: Respond,
    *,
    must: bool = True,
    soft: float = 0.0,
    cache: Cache | None = None,
) -> Step:
    """The response whose estimated errors are within the tolerance, on its scene.

    soft: the relative error that a finite penalty makes; cache: see `scene`. Raises NoAnswer, saying what was reached,
    where the levels do not suffice, unless it need not be; BadInput for a brake with a mesh file.
    """
    responses: list[Response] = []
    error = Errors({}, ())
    unknowns = 0
    missed = f"tolerance {tolerance.pressure:g} not reached"
    try:
        for scene, found in steps(brake, respond, cache):
            responses.append(found)
            unknowns = max(body.unknowns for body in scene.bodies)
            if len(responses) > 1:
                lost = max(body.condensed.lost for body in scene.bodies)
                error = estimate(responses, soft + ROUND_OFF * lost)
                if error.brake["pressure"] <= tolerance.pressure and error.brake["torque"] <= tolerance.torque:
                    return Step(scene, _final(responses, error, unknowns, ""))
    except NoAnswer as refusal:  # of finer levels
        if not error.brake:
            raise
        missed += f", the next level: {refusal}"
    if must:
        said = f"estimated error of p {error.brake['pressure']:.1e}, of the torque {error.brake['torque']:.1e}"
        raise NoAnswer(f"{missed} on {len(responses)} meshes of up to {unknowns} unknowns a shoe: {said}")
    return Step(scene, _final(responses, error, unknowns, missed))


class Errors(NamedTuple):
    """Relative errors of each of the `shoes`, and of the `brake`: of its torque, and the worst shoe's others.

    By QUANTITIES: p in L2 outside the edge zones, torque, peak pressure, hinge reaction.
    """

    brake: Mapping[str, float]
    shoes: tuple[Mapping[str, float], ...]


def estimate(responses: Sequence[Response], floor: float = 0.0) -> Errors:
    """Upper values of the errors of the last of the responses, each on a finer level than the one before.

    floor: what round-off and penalty may be at least, where there is contact.
    """
    names = ("torque", *QUANTITIES * len(responses[-1].shoes))
    rules = [RULES[name] for name in names]
    keys = ("fastest", "begin", "steep", "safety")
    fastest, begin, steep, safety = (np.array([getattr(rule, key) for rule in rules]) for key in keys)
    series = np.array([distances(a, b) for a, b in pairwise(responses)])  # (steps, quantities)
    found = safety * series[0] / (begin - 1)
    for before, last in pairwise(series):
        falls = np.clip(before / np.maximum(last, np.finfo(float).tiny), SLOWEST, steep)
        found = np.maximum(safety * last / (falls - 1), found / fastest)
    own = found[1 :: len(QUANTITIES)]  # of p
    own = np.array([own.max(), *np.repeat(own, len(QUANTITIES))])
    shares = np.array([rule.first if len(series) == 1 else rule.share for rule in rules])
    least = shares * own ** np.array([rule.power for rule in rules])
    found = np.where(found > 0, np.maximum(found, least) + floor, found)
    count = len(responses[-1].shoes)
    shoes = tuple(dict(zip(QUANTITIES, row.tolist(), strict=True)) for row in found[1:].reshape(count, -1))
    worst = {name: max(shoe[name] for shoe in shoes) for name in QUANTITIES}
    return Errors(worst | {"torque": float(found[0])}, shoes)


QUANTITIES = ("pressure", "torque", "peak", "reaction")


def distances(a: Response, b: Response) -> Floats:
    """Relative distances of a from b: of the torque, shoes not cancelling, then of each shoe the QUANTITIES."""
    off = [abs(x.torque - y.torque) for x, y in zip(a.shoes, b.shoes, strict=True)]
    return np.array(
        [sum(off) / (b.torque or 1.0), *(d for x, y in zip(a.shoes, b.shoes, strict=True) for d in _of(x, y))]
    )


def _of(a: ShoeResponse, b: ShoeResponse) -> tuple[float, ...]:
    zone = min(EDGE_ZONE, 0.25 * float(b.theta[-1] - b.theta[0]))
    p = pressure_distance(a, b, zone) if b.pressure.any() else float(a.pressure.any())
    reaction = float(np.linalg.norm(a.hinge_reaction - b.hinge_reaction) / (np.linalg.norm(b.hinge_reaction) or 1.0))
    peak = abs(a.peak_pressure - b.peak_pressure) / (b.peak_pressure or 1.0)
    return p, abs(a.torque - b.torque) / (b.torque or 1.0), peak, reaction


def check_tolerance(brake: Brake, tolerance: float) -> None:
    """Raise BadInput for a tolerance out of range, and for a brake with a mesh file, which is not refined."""
    if not 0 < tolerance < 1:
        raise BadInput(f"--tolerance = {tolerance:g}: must be greater than 0 and less than 1")
    for shoe in brake.shoes:
        if shoe.mesh is not None:
            raise BadInput(f"--tolerance = {tolerance:g}: shoe {shoe.name!r} has a mesh file, which is not refined")


def _final(responses: Sequence[Response], error: Errors, unknowns: int, missed: str) -> Response:
    """The last response with its errors, the time of all levels and the steps of the longest."""
    seconds: dict[str, float] = {}
    for response in responses:
        for phase, spent in response.seconds.items():
            seconds[phase] = seconds.get(phase, 0.0) + spent
    note = f"adapted on {len(responses)} meshes, the last with {unknowns} unknowns a shoe"
    return replace(
        responses[-1],
        error=error.brake,
        shoes=tuple(replace(shoe, error=own) for shoe, own in zip(responses[-1].shoes, error.shoes, strict=True)),
        seconds=seconds,
        iterations=max(response.iterations for response in responses),
        notes=(*responses[-1].notes, f"{note}; {missed}" if missed else note),
    )
