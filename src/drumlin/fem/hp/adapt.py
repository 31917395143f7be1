"""A brake to a tolerance: finer levels until the estimated errors are below it.

The estimate. Let e_k be the error of level k and d_k its distance from the level before. If errors fall by the factor r
from level to level, then d_k >= e_(k-1) - e_k = (r - 1) e_k, so that

    e_k <= d_k / (r - 1),   r = d_(k-1) / d_k as observed, at least SLOWEST, and 1 / (r - 1) at least `later`;

of the first step, which shows no r, e_1 <= `first` d_1. On random brakes of every kind e_k / d_k has the median 0.1 to
0.25 and is in 95 % below 0.4: errors fall by a factor of 5 to 10. The difference of two numbers may be small by chance.
So what was estimated before counts too, less the factor `fastest`; the distance of peaks is the geometric mean of how
far p is apart near the peak and in L2; and a force is a resultant of p whose columns may cancel, so that CHANCE of what
they would change it by, were their signs chance, is added to its error. The factors come from those brakes, against
finer levels (`RULES`). To all are added what the elimination has lost and what the contact's penalty changes, by
`ShoeResponse.lost` and `softness`.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import chain, pairwise
from typing import NamedTuple

import numpy as np

from drumlin.arrays import Floats
from drumlin.brake import clearance
from drumlin.brake.drum_brake import Brake, Shoe
from drumlin.errors import BadInput, NoAnswer
from drumlin.fem.assembly import Cache
from drumlin.fem.hp.division import FINEST
from drumlin.fem.hp.levels import Respond, Step, steps
from drumlin.fem.hp.places import pressed_arcs
from drumlin.response.norms import Difference
from drumlin.response.response import NEAR_PEAK, Response, ShoeResponse, edge_zone, reaction_size, singular_zone
from drumlin.response.resultants import edge_left_out, largest

SLOWEST = 1.3  # factor by which errors fall from level to level at least, where they do not stay


class Rule(NamedTuple):
    """How an error is estimated, see above: least parts of the `first` step and of `later` ones that it may be, and the
    factor by which estimates fall from level to level at most, as a step may be short by chance: `fastest`."""

    first: float
    later: float
    fastest: float


OF_FORCES = Rule(first=0.38, later=0.5, fastest=12)
RULES = {
    "pressure": Rule(first=0.62, later=0.6, fastest=30),
    "torque": OF_FORCES,
    "peak": Rule(first=0.6, later=0.5, fastest=30),
    "reaction": OF_FORCES,
}
"""Of 500 random brakes of all kinds: about 1 in 200 has a larger error than is stated, and the median is two to five
times the error."""
CHANCE = 0.008  # of what the last step of p changes of a force, were its columns' signs chance: so much does not cancel
SOFTER = 2.0  # times the softness: what the penalty changes at most
SHORTEST = 10 * FINEST  # of the lining's thickness: the pressure of a shorter contact is not known
AT = 1e-9
"""Distance [rad] up to which a tip of the gap is at an end of columns, as a place is but for
round-off."""
UNDER_TIP = math.log(1 / FINEST) / (2 * math.pi)
"""Growth of p over E s under a tip of the gap, from the lining's thickness from it down to FINEST
of that.

On a half-plane of modulus E a wedge whose slope changes by s has the pressure E s/(2 pi) ln(1/x)
(Johnson, Contact Mechanics, ch. 5). It is what the peak may lack where no columns end at the tip.
"""
NEAR = 0.5  # of the peak: p in a column at an end of the lining, where it grows without end
ROUND_OFF = 10.0  # times what the elimination has lost by its own account
"""Of 55 random answers that lost 3e-9 of p and more 52 have lost at most so much, by refined ones. Three, of shoes and
linings as unlike as can be, have lost 12, 76 and 378 times what they say, at most 1e-4 of p."""


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
    cache: Cache | None = None,
    along: Iterable[Step] | None = None,
) -> Step:
    """The response whose estimated errors are within the tolerance, on its scene.

    cache: see `scene`; along: the steps, where some are there already. Raises NoAnswer, saying what was reached, where
    the levels do not suffice, unless it need not be; BadInput for a brake with a mesh file.
    """
    responses: list[Response] = []
    error = Errors({}, ())
    unknowns = 0
    missed = f"tolerance {tolerance.pressure:g} not reached"
    try:
        for scene, found in along or steps(brake, respond, cache):
            responses.append(found)
            unknowns = max(body.unknowns for body in scene.bodies)
            if len(responses) > 1:
                error, unseen = _seen(estimate(brake, responses), brake, found)
                if error.brake["pressure"] <= tolerance.pressure and error.brake["torque"] <= tolerance.torque:
                    return Step(scene, _final(responses, error, unknowns, ""))
                if unseen:
                    missed += f": {unseen}"
                    break
    except NoAnswer as refusal:  # of finer levels
        if not error.brake:
            raise
        missed += f", the next level: {refusal}"
    last = zip(brake.shoes, responses[-1].shoes, strict=True)
    unbounded = [repr(shoe.name) for shoe, found in last if _lacking(shoe, brake.drum.radius, found) == 1.0]
    why = f"; p is unbounded at an end of the lining or a tip of the gap of {', '.join(unbounded)}" if unbounded else ""
    if must:
        said = f"estimated error of p {error.brake['pressure']:.1e}, of the torque {error.brake['torque']:.1e}"
        soft = SOFTER * max(shoe.softness.pressure for shoe in responses[-1].shoes)
        if soft > 0.5 * tolerance.pressure:
            said += f"; the penalty makes {soft:.1e} of it; a larger --penalty makes less"
        raise NoAnswer(f"{missed} on {len(responses)} meshes of up to {unknowns} unknowns a shoe: {said}{why}")
    return Step(scene, _final(responses, error, unknowns, missed + why))


class Errors(NamedTuple):
    """Relative errors of each of the `shoes`, and of the `brake`: of its torque, and the worst shoe's others.

    By QUANTITIES: p in L2 outside the edge zones, torque, peak pressure, hinge reaction.
    """

    brake: Mapping[str, float]
    shoes: tuple[Mapping[str, float], ...]


def estimate(brake: Brake, responses: Sequence[Response]) -> Errors:
    """Upper values of the errors of the last of a brake's responses, each on a finer level than the one before."""
    last = responses[-1]
    rules = np.array([RULES[name] for name in ("torque", *QUANTITIES * len(last.shoes))])
    steps = np.array([distances(brake, a, b) for a, b in pairwise(responses)])
    found = _from_steps(steps[:, 0], rules) + CHANCE * steps[-1, 1]
    beside = SOFTER * _of_quantities(last.shoes, "softness") + ROUND_OFF * _of_quantities(last.shoes, "lost")
    found = np.where(found > 0, found + beside, found)
    shoes = [dict(zip(QUANTITIES, own, strict=True)) for own in np.reshape(found[1:], (-1, len(QUANTITIES))).tolist()]
    return _errors(float(found[0]), shoes)


def _of_quantities(shoes: Sequence[ShoeResponse], name: str) -> Floats:
    """A Change of each shoe, by its name, in the order of `distances`."""
    every = [getattr(shoe, name) for shoe in shoes]
    changes = [(of.pressure, of.torque, max(of.pressure, of.peak), of.reaction) for of in every]
    return np.array([max(of[1] for of in changes), *chain(*changes)])


def _from_steps(series: Floats, rules: Floats) -> Floats:
    """Errors (q,) that the steps (k, q) of a series tell of, by their rules (q, 3)."""
    first, later, fastest = rules.T
    found = first * series[0]
    for before, last in pairwise(series):
        falls = np.maximum(before / np.maximum(last, np.finfo(float).tiny), SLOWEST)
        found = np.maximum(np.maximum(later, 1 / (falls - 1)) * last, found / fastest)
    return np.asarray(found)


def _cornered(shoe: ShoeResponse, zone: float) -> bool:
    """Whether p is largest in a column at an end of the lining that is pressed: there it is unbounded.

    zone [rad]: see `edge_zone`. Where the ends count, p near its peak there will be so on a finer level.
    """
    theta, p, order = shoe.theta, shoe.pressure, shoe.order
    ends = [part for end, part in ((0, slice(order + 1)), (-1, slice(-order - 1, None))) if p[end] > 0]
    heights = [largest(theta[part], p[part], order) / shoe.peak_pressure for part in ends]
    if any(math.isclose(height, 1.0) for height in heights):
        return True
    return max(heights, default=0.0) > NEAR and edge_left_out(theta, p, order, zone) == 0


def _under_tips(shoe: Shoe, radius: float, found: ShoeResponse, zone: float) -> float:
    """What the peak of p may lack, relative, as p is near its peak in a column beside a tip of the
    gap: 1 where columns end at the tip, as p is unbounded there, as under a wedge, and on a finer
    level would be higher.

    No columns end at a tip that p hardly feels, see `places`. zone [rad]: see `edge_zone`; in it
    `_cornered` tells.
    """
    (start, end), phi, order = shoe.arc, shoe.frame.phi(found.theta), found.order
    zone = edge_left_out(found.theta, found.pressure, order, zone)
    lacking = 0.0
    for angle, slope in clearance.tips(shoe.lining):
        (tip,) = shoe.frame.phis([angle])
        if not start + zone < tip < end - zone:
            continue
        k = int(np.abs(phi[::order] - tip).argmin()) * order
        part = slice(max(k - order, 0), k + order + 1)
        if largest(found.theta[part], found.pressure[part], order) > NEAR_PEAK * found.peak_pressure:
            growth = UNDER_TIP * shoe.lining.material.E_half_plane * slope / radius / found.peak_pressure
            lacking = max(lacking, 1.0 if abs(phi[k] - tip) < AT else growth)
    return min(lacking, 1.0)


def _lacking(shoe: Shoe, radius: float, found: ShoeResponse) -> float:
    """What the peak of p may lack, relative: 1 where it is, or is near, what grows without end at a
    lining's end or under a tip of its gap."""
    zone = edge_zone(shoe, radius)
    return 1.0 if _cornered(found, zone) else _under_tips(shoe, radius, found, zone)


def _errors(torque: float, shoes: Sequence[Mapping[str, float]]) -> Errors:
    """The worst shoe's errors and that of the brake's torque, with those of the shoes."""
    worst = {name: max(shoe[name] for shoe in shoes) for name in QUANTITIES}
    return Errors(worst | {"torque": torque}, tuple(shoes))


def _seen(error: Errors, brake: Brake, response: Response) -> tuple[Errors, str]:
    """The errors with what the peak lacks under tips of the gap; of 1 what is not known at all: a
    peak at a lining's end or under a tip of its gap, and the pressure of a contact so short that
    this is said in words."""
    shoes, said = list(error.shoes), ""
    for i, (shoe, found) in enumerate(zip(brake.shoes, response.shoes, strict=True)):
        lacking = _lacking(shoe, brake.drum.radius, found)
        shoes[i] = {**shoes[i], "peak": 1.0 if lacking == 1.0 else shoes[i]["peak"] + lacking}
        length = min((end - start for start, end in pressed_arcs(shoe, found)), default=math.inf) * brake.drum.radius
        if length < SHORTEST * shoe.lining.thickness:
            said = (
                f"shoe {shoe.name!r}: its contact is {1e6 * length:.1g} um long, too short to know its pressure; "
                "torque and forces do not need it"
            )
            shoes[i] = {name: max(e, float(name in {"pressure", "peak"})) for name, e in shoes[i].items()}
    return _errors(error.brake["torque"], shoes), said


QUANTITIES = ("pressure", "torque", "peak", "reaction")


def distances(brake: Brake, a: Response, b: Response) -> Floats:
    """Relative distances of a from b, and by how much what p differs by would change them by chance: (2, q).

    Of the torque, shoes not cancelling, then of each shoe the QUANTITIES.
    """
    R, total = brake.drum.radius, b.torque or a.torque or 1.0
    pairs = list(zip(a.shoes, b.shoes, strict=True))
    own = np.array([_of(edge_zone(of, R), x, y) for of, (x, y) in zip(brake.shoes, pairs, strict=True)])
    moved = sum(abs(x.torque - y.torque) for x, y in pairs) / total
    by_chance = sum(abs(y.torque) * chance for (_, y), chance in zip(pairs, own[:, 1, 1], strict=True)) / total
    return np.array([[moved, *own[:, 0].ravel()], [by_chance, *own[:, 1].ravel()]])


def _of(zone: float, a: ShoeResponse, b: ShoeResponse) -> tuple[tuple[float, ...], ...]:
    """Those of a shoe (2, 4), whose peak is not looked for in this zone [rad] at the lining's ends."""
    held = reaction_size(b.hinge_reaction, b.normal_force)
    torque = abs(a.torque - b.torque) / (b.torque or a.torque or 1.0)
    peak = abs(a.peak_pressure - b.peak_pressure) / (b.peak_pressure or a.peak_pressure or 1.0)
    reaction = math.dist(a.hinge_reaction, b.hinge_reaction) / held
    if not b.pressure.any():
        return (float(a.pressure.any()), torque, peak, reaction), (0.0,) * len(QUANTITIES)
    edge, zone = (
        edge_left_out(b.theta, b.pressure, b.order, x) for x in (singular_zone(float(b.theta[-1] - b.theta[0])), zone)
    )
    step = Difference.of(a, b, edge, zone)
    reach = b.contact_arcs[-1][1] - b.contact_arcs[0][0]  # on so much of the drum what balances moves a force
    p, chance = step.distance(edge), min(step.by_chance(), reach)
    near = max(peak, step.near_peak(zone, NEAR_PEAK))
    by_chance = 0.0, chance if b.torque else 0.0, 0.0, chance * b.normal_force / held
    return (p, torque, math.sqrt(p * near), reaction), by_chance


def check_tolerance(brake: Brake, tolerance: float) -> None:
    """Raise BadInput for a tolerance out of range, and for a brake with a mesh file, which is not refined."""
    if not 0 < tolerance < 1:
        raise BadInput(f"--tolerance = {tolerance:g}: must be greater than 0 and less than 1")
    for shoe in brake.shoes:
        if shoe.mesh is not None:
            raise BadInput(f"--tolerance = {tolerance:g}: shoe {shoe.name!r} has a mesh file, which is not refined")


def _final(responses: Sequence[Response], error: Errors, unknowns: int, missed: str) -> Response:
    """The last response with its errors, the time of all and the steps of the longest, and with a warning where the
    errors missed the tolerance."""
    last = responses[-1]
    seconds: dict[str, float] = {}
    for response in responses:
        for phase, spent in response.seconds.items():
            seconds[phase] = seconds.get(phase, 0.0) + spent
    notes = [f"adapted on {len(responses)} meshes, the last with {unknowns} unknowns a shoe"]
    return replace(
        last,
        error=error.brake,
        shoes=tuple(replace(shoe, error=own) for shoe, own in zip(last.shoes, error.shoes, strict=True)),
        seconds=seconds,
        iterations=max(response.iterations for response in responses),
        notes=(*last.notes, *notes, *([f"warning: {missed}"] if missed else [])),
    )
