"""Running a brake in: its linings worn by Archard's law, from the elastic pressure of the new to
the law of the rigid.

Whatever the elasticity, wear ends where every point of the lining wears as fast as the rigid
motions of the shoe close the gap, p ~ approach^(1/m) with the exponent m of the wear law: for m = 1
sin(phi) of a hinged shoe, cos(phi) about its direction of a guided one, A cos + B sin of one on a
pivot of a lever. What remains of elasticity then stands in the worn shape. The clearance of `worn`
is that shape: every model solves the worn brake as it solves any other.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from drumlin.arrays import Floats
from drumlin.brake.brake import Brake
from drumlin.brake.units import mm
from drumlin.errors import BadInput, NoAnswer
from drumlin.laws import rigid
from drumlin.laws.rigid import PressedShoe
from drumlin.response.response import edge_zone, nodal_peak
from drumlin.response.resultants import gauss_points
from drumlin.texts import formatted
from drumlin.wear import archard
from drumlin.wear.archard import WearLaw, WearState, steady
from drumlin.wear.linings import Surface, WearSetup, worn_by

COEFFICIENT = 1e-14
"""k [1/Pa] where none is given: 1e-5 mm^3/(N m), the order of organic linings. In units of 1/(k
E/t) nothing depends on it, nor does the part of life.
"""
WORN_OUT = 0.8  # part of the lining's thickness that may wear off
SETTLED = 1e-3


class Target(NamedTuple):
    """What wear tends to: pressure (n,) [Pa] of all unknowns, torque [N m]."""

    pressure: Floats
    torque: float


def target(setup: WearSetup, law: WearLaw | None = None, torque: float | None = None) -> Target:
    """The law that wear tends to: p = (approach . y)^(1/m) >= 0, as all points wear as their shoe
    moves.

    For finite elements and the exponent 1 the law is the rigid-shoe law. For the foundation model
    and other exponents it is `discrete_end`. torque [N m]: held, else the actuation stays. Raises
    NoAnswer where the rigid shoe has no equilibrium.
    """
    if setup.model != "fem" or (law is not None and law.exponent != 1):
        return discrete_end(setup, law, torque)
    under = rigid.forced(setup.brake)
    pressed = [rigid.press(under, under.shoes[surface.shoe]) for surface in setup.surfaces]
    p = [
        rigid.pressure(found, surface.theta)
        for found, surface in zip(pressed, setup.surfaces, strict=True)
    ]
    size = sum(
        _torque(setup, surface, found)
        for found, surface in zip(pressed, setup.surfaces, strict=True)
        if found
    )
    return _held(np.concatenate(p), size, torque)


def discrete_end(
    setup: WearSetup, law: WearLaw | None = None, torque: float | None = None
) -> Target:
    """The end of wear on the mesh or the sections of a setup.

    It differs from the law where the law presses a part of a lining only, for that part ends
    within an element. torque [N m] and errors: as of `target`.
    """
    law = law or WearLaw(COEFFICIENT)
    p = np.concatenate(
        [interface.pressure * steady(interface, law).contact.p for interface in setup.interfaces]
    )
    size = sum(
        float(interface.torque @ p[setup.part(i)]) for i, interface in enumerate(setup.interfaces)
    )
    return _held(p, size, torque)


def _held(p: Floats, size: float, torque: float | None) -> Target:
    return Target(p, size) if torque is None else Target(p * torque / size, torque)


def _torque(setup: WearSetup, surface: Surface, found: PressedShoe) -> float:
    """The torque [N m] of a lining by the law, on a plane the braking force [N]."""
    brake, lining = setup.brake, setup.brake.shoes[surface.shoe].lining
    theta = rigid.nodes((lining.start, lining.end), found.arcs, rigid.PRESSURE_NODES - 1)
    _, p, weight = gauss_points(theta, rigid.pressure(found, theta), 2)
    return float(brake.friction * lining.width * brake.scale_factor**2 * (p * weight).sum())


class Distance(NamedTuple):
    """How far a state is from the target: of p (L2, the worst lining's, without one element at each
    end), of torque.
    """

    pressure: float
    torque: float


def distance(setup: WearSetup, state: WearState, goal: Target) -> Distance:
    """The relative distances of a state from the target."""
    worst = apart(setup, state.pressure, goal.pressure)
    return Distance(worst, state.torque / goal.torque - 1 if goal.torque else 0.0)


def apart(setup: WearSetup, p: Floats, goal: Floats) -> float:
    """How far pressures (n,) are from others: the worst lining's, relative."""
    sizes = [norm(s, s.along(goal)) for s in setup.surfaces]
    off = [norm(s, s.along(p - goal)) for s in setup.surfaces]
    return max((a / size for a, size in zip(off, sizes, strict=True) if size), default=0.0)


def norm(surface: Surface, values: Floats) -> float:
    """L2 norm over theta of values (n,) by growing theta, without one element at each end."""
    inner = slice(surface.order, len(values) - surface.order)
    _, v, w = gauss_points(surface.angles[inner], values[inner], surface.order)
    return math.sqrt(float((v**2 * w).sum()))


def settled(setup: WearSetup, goal: Target, within: float = SETTLED) -> Callable[[WearState], bool]:
    """Whether p and torque of a state are within a fraction of the target.

    The target must be `discrete_end`: wear on a mesh does not come nearer to the law than that.
    """
    return lambda state: max(map(abs, distance(setup, state, goal))) <= within


def run_in(
    setup: WearSetup,
    law: WearLaw | None = None,
    *,
    backward: WearSetup | None = None,
    until: Callable[[WearState], bool] | None = None,
    **options: Any,
) -> list[WearState]:
    """Wear a brake in by `law`, by default Archard's: options as in archard.run; until settled, or
    over `distance`.

    backward: the setup of the same brake with the drum turning the other way, for `reverse`. Raises
    BadInput, NoAnswer.
    """
    for surface in setup.surfaces:  # p is compared without one element at each end
        count = (len(surface.angles) - 1) // surface.order
        if count < 3:
            raise BadInput(
                f"shoe {surface.name!r}: its lining has {count} elements; wear needs at least 3 (--elements)"
            )
    law = law or WearLaw(COEFFICIENT)
    torque = options.get("torque")
    if until is None and "distance" not in options:
        if backward is not None:
            raise BadInput(
                "a brake whose drum turns both ways does not settle: a distance must be given"
            )
        until = settled(setup, discrete_end(setup, law, torque))
    return archard.run(
        setup.interfaces,
        law,
        backward=backward.interfaces if backward else (),
        until=until or (lambda _: False),
        **options,
    )


def unit_distance(setup: WearSetup, law: WearLaw) -> float:
    """1/(k K) [m]: the sliding distance over which a rigid shoe's Winkler lining forgets its shape,
    by e.
    """
    return 1 / (law.coefficient * setup.stiffness) if law.coefficient else math.inf


def worn(setup: WearSetup, state: WearState) -> Brake:
    """The brake with the depth worn off added to the clearance of its linings."""
    return worn_by(setup.brake, {s.shoe: (s.angles, s.along(state.depth)) for s in setup.surfaces})


def check_depth(setup: WearSetup, states: Sequence[WearState]) -> None:
    """Raise NoAnswer where more of a lining is worn off than it has, saying which was gone first
    and when.
    """
    s, gone = [state.s for state in states], []
    for surface in setup.surfaces:
        has = setup.brake.shoes[surface.shoe].lining.thickness
        deepest = [float(state.depth[surface.part].max()) for state in states]
        if deepest[-1] > has:
            gone.append(
                (
                    float(np.interp(has, deepest, s)),
                    f"shoe {surface.name!r}: its lining of {mm(has)}",
                )
            )
    if gone:
        after, lining = min(gone)
        raise NoAnswer(
            f"{lining} is worn through after {after * 1e-3:.4g} km of the {s[-1] * 1e-3:.4g} km asked for or needed to "
            "settle; a shorter --distance has an answer"
        )


class Life(NamedTuple):
    """The sliding distance [m] at which a lining is worn out, and the parts of it after which p and
    torque stay within `within` of the law; above 1: they never come there.
    """

    distance: float
    pressure: float
    torque: float


def life(
    setup: WearSetup,
    states: Sequence[WearState],
    goal: Target,
    law: WearLaw,
    within: float = 0.01,
    part: float = WORN_OUT,
) -> Life:
    """How much of a lining's life is spent away from the law.

    The life ends where the deepest wear of a lining reaches `part` of its thickness; beyond the
    last state all wears at the rate of the law. The lining's own loss of thickness is not fed back
    into its stiffness.
    """
    end = math.inf
    for surface in setup.surfaces:
        allowed = part * setup.brake.shoes[surface.shoe].lining.thickness
        deepest = [float(state.depth[surface.part].max()) for state in states]
        if deepest[-1] >= allowed:
            end = min(end, float(np.interp(allowed, deepest, [state.s for state in states])))
        elif law.coefficient > 0:
            rate = float(law.rate(goal.pressure[surface.part], 0.0)[0].max())
            end = min(end, states[-1].s + (allowed - deepest[-1]) / rate)
    s, far = [state.s for state in states], [distance(setup, state, goal) for state in states]
    pressure = archard.last_beyond(s, [d.pressure for d in far], within)
    return Life(end, pressure / end, archard.last_beyond(s, [d.torque for d in far], within) / end)


class Checks(NamedTuple):
    """Balances of a run, relative: its worn volume against the integral of the wear rate (k Int Int
    p dA ds), and that of the worn shape over the round lining against the energy, V = k W/mu.

    `energy`: None without friction and for other exponents than 1. `ripple`: the largest
    checkerboard of any state after the first, see archard.ripple; None where the linings have too
    few nodes.
    """

    volume: float
    energy: float | None
    ripple: float | None


def checks(setup: WearSetup, states: Sequence[WearState], law: WearLaw) -> Checks:
    """The balances and the checkerboard of a run."""
    end, brake = states[-1], setup.brake
    area = np.concatenate([interface.area for interface in setup.interfaces])
    scale = end.removed or 1.0
    by_energy = None
    if brake.friction > 0 and law.exponent == 1:
        shape = sum(
            brake.shoes[s.shoe].lining.width * brake.scale_factor * _integral(s, s.along(end.depth))
            for s in setup.surfaces
        )
        by_energy = (
            abs(shape - law.coefficient * end.work / (brake.friction * brake.scale_factor)) / scale
        )
    ripples = [
        archard.ripple(s.along(state.pressure)) for state in states[1:] for s in setup.surfaces
    ]
    seen = [ripple for ripple in ripples if not math.isnan(ripple)]
    return Checks(
        abs(float(area @ end.depth) - end.removed) / scale, by_energy, max(seen, default=None)
    )


def _integral(surface: Surface, values: Floats) -> float:
    _, v, w = gauss_points(surface.angles, values, surface.order)
    return float((v * w).sum())


def peak(setup: WearSetup, state: WearState) -> float:
    """The largest nodal pressure [Pa], more than half a lining's thickness from its ends."""
    peaks = []
    for surface in setup.surfaces:
        theta, p = surface.angles, surface.along(state.pressure)
        peaks.append(
            nodal_peak(
                theta, p, edge_zone(setup.brake.shoes[surface.shoe], setup.brake.scale_factor)
            )
        )
    return max(peaks)


def as_dict(
    setup: WearSetup, states: Sequence[WearState], goal: Target, law: WearLaw
) -> dict[str, Any]:
    """A run as plain data for JSON: SI; values of each lining by growing theta."""

    def linings(values: Floats) -> list[list[float]]:
        return [surface.along(values).tolist() for surface in setup.surfaces]

    return {
        "model": setup.model,
        "law": law._asdict(),
        "unit_distance": unit_distance(setup, law) if law.coefficient else None,
        "shoes": [
            {"name": surface.name, "theta": surface.angles.tolist()} for surface in setup.surfaces
        ],
        "worn_in": {"torque": goal.torque, "pressure": linings(goal.pressure)},
        "states": [
            {
                "distance": state.s,
                "forward": state.forward,
                "torque": state.torque,
                "force": state.force,
                "peak_pressure": peak(setup, state),
                "pressure_from_law": distance(setup, state, goal).pressure,
                "torque_from_law": distance(setup, state, goal).torque,
                "worn_volume": state.removed,
                "depth": linings(state.depth),
                "pressure": linings(state.pressure),
            }
            for state in states
        ],
    }


def report_lines(
    setup: WearSetup, states: Sequence[WearState], goal: Target, law: WearLaw, lines: int = 24
) -> list[str]:
    """A run as lines of text: some of its states, evenly spread, then what became of it."""
    unit, surface = unit_distance(setup, law), setup.brake.surface
    of = surface.effect_unit
    wears = f", 1/(k K) = {unit * 1e-3:.5g} km" if law.coefficient else ": nothing wears"
    force = setup.brake.shoes[setup.surfaces[0].shoe].actuation.force
    said = [
        f"{setup.brake.title}: {setup.model}, {setup.brake.motion}, mu = {setup.brake.friction:g}, "
        f"k = {law.coefficient:g} 1/Pa, exponent {law.exponent:.9g}{wears}",
        f"{'s':>9}{'s k K':>9}{surface.short:>10}{'force':>9}{'peak p':>9}{'p off law':>11}"
        f"{'T off law':>11}{'deepest':>10}",
        f"{'[km]':>9}{'':9}{f'[{of}]':>10}{'[N]':>9}{'[MPa]':>9}{'[%]':>11}{'[%]':>11}{'wear [mm]':>10}",
    ]
    for i in sorted({round(x) for x in np.linspace(0, len(states) - 1, lines)}):
        state = states[i]
        off = distance(setup, state, goal)
        said.append(
            f"{state.s * 1e-3:9.5g}{state.s / unit:9.4g}{state.torque:10.6g}{state.force * force:9.5g}"
            f"{peak(setup, state) * 1e-6:9.4g}{100 * off.pressure:11.3f}{100 * off.torque:+11.4f}"
            f"{state.depth.max() * 1e3:10.4g}"
        )
    said.append(f"worn in (law): {surface.effect} {goal.torque:.6g} {of}")
    said += _mesh_line(setup, goal, law)
    if law.coefficient > 0:
        spent = life(setup, states, goal, law)
        said.append(
            f"life: {spent.distance * 1e-3:.5g} km to {formatted(WORN_OUT, '.0%')} of the thickness; of it p is more "
            f"than 1 % off the law for {_part(spent.pressure)}, the torque for {_part(spent.torque)}"
        )
    balance = checks(setup, states, law)
    energy = "" if balance.energy is None else f", energy {balance.energy:.1e}"
    ripple = "" if balance.ripple is None else f"checkerboard at most {balance.ripple:.1e}; "
    said.append(
        f"worn volume {states[-1].removed * 1e9:.5g} mm^3; balance: volume {balance.volume:.1e}{energy}; "
        f"{ripple}{len(states) - 1} steps"
    )
    return said


def _mesh_line(setup: WearSetup, goal: Target, law: WearLaw) -> list[str]:
    """A line on how far wear on this mesh ends from the law, where that is over SETTLED."""
    own = discrete_end(setup, law)
    factor = goal.torque / own.torque if own.torque else 1.0
    off = apart(setup, own.pressure * factor, goal.pressure)
    if off <= SETTLED:
        return []
    return [
        f"p at the end of wear is {formatted(off, '.2%')} off the law on this mesh, for the law presses a part of a "
        "lining that ends within an element; more elements come nearer"
    ]


def _part(share: float) -> str:
    if math.isinf(share):
        return "all of this run"
    return formatted(share, ".1%") if share <= 1 else f"all of it ({share:.3g} lives)"
