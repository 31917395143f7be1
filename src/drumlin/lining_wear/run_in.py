"""Running a brake in: wear takes its linings from the elastic pressure to the rigid-shoe law.

Whatever the elasticity, wear ends where every point of the lining wears as fast as the rigid
motions of the shoe close the gap: p ~ approach^(1/m) with the exponent m of the wear law. For m = 1
this is sin(phi) of a hinged shoe, cos(phi) about the direction of a guided shoe, and A cos + B sin
of a shoe on a pivot of a lever. What remains of elasticity then stands in the worn shape. The
clearance of `brake_with_worn_linings` is this shape: every model solves the worn brake as it solves
any other.
"""

import math
from collections.abc import Callable, Sequence
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.texts import formatted
from drumlin.brake.brake import Brake
from drumlin.brake.units import mm
from drumlin.laws import rigid
from drumlin.laws.rigid import PressedShoe
from drumlin.lining_wear import archard
from drumlin.lining_wear.archard import WearLaw, WearState, solve_steady_wear
from drumlin.lining_wear.linings import WearSetup, WornLining, add_worn_depths
from drumlin.response.response import edge_zone, nodal_peak
from drumlin.response.resultants import gauss_points

COEFFICIENT = 1e-14
"""Wear coefficient k [1/Pa] where none is given: 1e-5 mm^3/(N m), the order of organic linings.

Results in units of the sliding distance 1/(k E/t) do not depend on it, nor do parts of a lining's
life."""

WORN_OUT = 0.8
"""Part of the lining's thickness after which a lining counts as worn out. A judgement."""

WEAR_SETTLED = 1e-3
"""Largest relative distance of p and torque from the end of wear that counts as settled. It is the
error that a step of the wear may make."""


class WearTarget(NamedTuple):
    """The end of wear: pressure (n,) [Pa] at all contact unknowns, and torque [N m]."""

    pressure: Floats
    torque: float


def rigid_law_target(
    setup: WearSetup, law: WearLaw | None = None, torque: float | None = None
) -> WearTarget:
    """The law that wear tends to: p = (approach . y)^(1/m) >= 0 with motions y of the shoe.

    For finite elements and the exponent 1 it is the rigid-shoe law. For the foundation model and
    other exponents it is `discrete_wear_target`.

    Parameters
    ----------
    setup : the linings
    law : the wear law; None: Archard's
    torque : which the actuation holds [N m]; None: the actuation stays

    Raises
    ------
    NoAnswer
        where the rigid shoe has no equilibrium
    """
    # The closed form holds for wear in proportion to the pressure.
    if setup.model != "fem" or (law is not None and law.exponent != 1):
        return discrete_wear_target(setup, law, torque)
    forced = rigid.forced(setup.brake)
    pressures = []
    total: float = 0
    for surface in setup.surfaces:
        pressed = rigid.press(forced, forced.shoes[surface.shoe])
        pressures.append(rigid.pressure(pressed, surface.theta))
        if pressed:
            total += _lining_torque_by_law(setup, surface, pressed)
    return _target_at_torque(np.concatenate(pressures), total, torque)


def discrete_wear_target(
    setup: WearSetup, law: WearLaw | None = None, torque: float | None = None
) -> WearTarget:
    """The end of wear on the mesh or the sections of a setup.

    The end of wear on a mesh differs from the law where the law presses only a part of a lining,
    because this part ends within an element. Parameters and errors are those of `rigid_law_target`.
    """
    law = law or WearLaw(COEFFICIENT)
    pressures = []
    total: float = 0
    for interface in setup.interfaces:
        p = interface.pressure * solve_steady_wear(interface, law).contact.p
        pressures.append(p)
        total += float(interface.torque @ p)
    return _target_at_torque(np.concatenate(pressures), total, torque)


def _target_at_torque(p: Floats, total: float, torque: float | None) -> WearTarget:
    """The end of wear with pressures p (n,) of the torque `total`, scaled to a held torque."""
    return WearTarget(p, total) if torque is None else WearTarget(p * torque / total, torque)


def _lining_torque_by_law(setup: WearSetup, surface: WornLining, pressed: PressedShoe) -> float:
    """The torque [N m] of a lining by the law; on a plane the braking force [N]."""
    brake, lining = setup.brake, setup.brake.shoes[surface.shoe].lining
    theta = rigid.nodes((lining.start, lining.end), pressed.arcs, rigid.PRESSURE_NODES - 1)
    # Parabolas through the law's pressure are integrated exactly.
    _, p, weight = gauss_points(theta, rigid.pressure(pressed, theta), 2)
    return float(brake.friction * lining.width * brake.scale_factor**2 * (p * weight).sum())


class TargetDistance(NamedTuple):
    """The relative distance of a state from the end of wear.

    Attributes
    ----------
    pressure : distance of p in the L2 norm, without one element at each end, of the worst lining
    torque : distance of the torque, positive where the state has more torque
    """

    pressure: float
    torque: float


def distance_from_target(setup: WearSetup, state: WearState, goal: WearTarget) -> TargetDistance:
    """The relative distances of pressure and torque of a state from the end of wear `goal`."""
    return TargetDistance(
        pressure=pressure_distance(setup, state.pressure, goal.pressure),
        torque=state.torque / goal.torque - 1 if goal.torque else 0.0,
    )


def pressure_distance(setup: WearSetup, p: Floats, goal: Floats) -> float:
    """The relative L2 distance between pressures (n,) and others: the worst lining's."""
    distances = []
    for surface in setup.surfaces:
        size = lining_pressure_norm(surface, surface.along(goal))
        # A lining that the target does not press has no relative distance.
        if size:
            distances.append(lining_pressure_norm(surface, surface.along(p - goal)) / size)
    return max(distances, default=0.0)


def lining_pressure_norm(surface: WornLining, values: Floats) -> float:
    """The L2 norm over theta of values (n,) along a lining, without one element at each end."""
    inner = slice(surface.order, len(values) - surface.order)
    _, at_points, weight = gauss_points(surface.angles[inner], values[inner], surface.order)
    return math.sqrt(float((at_points**2 * weight).sum()))


def make_settled_test(
    setup: WearSetup, goal: WearTarget, within: float = WEAR_SETTLED
) -> Callable[[WearState], bool]:
    """A function that tells whether p and torque of a state are within a fraction of the target.

    The target must be `discrete_wear_target`: wear on a mesh does not come nearer to the law than
    that.
    """
    return lambda state: max(map(abs, distance_from_target(setup, state, goal))) <= within


def run_in(
    setup: WearSetup,
    law: WearLaw | None = None,
    *,
    backward: WearSetup | None = None,
    until: Callable[[WearState], bool] | None = None,
    **options: Any,
) -> list[WearState]:
    """Wear a brake until it is settled, or over a `distance`; returns its states.

    Parameters
    ----------
    setup : the linings
    law : the wear law; None: Archard's with COEFFICIENT
    backward : setup of the same brake with the drum turning the other way, for `reverse`
    until : whether the run ends with a state; None: when p and torque are settled
    options : `distance`, `reverse`, `torque` and `tolerance` of `archard.wear_linings`

    Raises
    ------
    BadInput
        for options out of range, and for linings of fewer than 3 elements
    NoAnswer
        for the reasons of archard.wear_linings
    """
    _check_elements(setup)
    law = law or WearLaw(COEFFICIENT)
    torque = options.get("torque")
    if until is None and "distance" not in options:
        if backward is not None:
            raise BadInput(
                "a brake whose drum turns both ways does not settle: a distance must be given"
            )
        until = make_settled_test(setup, discrete_wear_target(setup, law, torque))
    return archard.wear_linings(
        setup.interfaces,
        law,
        backward=backward.interfaces if backward else (),
        until=until or (lambda _: False),
        **options,
    )


def _check_elements(setup: WearSetup) -> None:
    """Raise BadInput where a lining has fewer than 3 elements.

    The comparison of pressures leaves out one element at each end.
    """
    for surface in setup.surfaces:
        count = (len(surface.angles) - 1) // surface.order
        if count < 3:
            raise BadInput(
                f"shoe {surface.name!r}: its lining has {count} elements; "
                "wear needs at least 3 (--elements)"
            )


def unit_sliding_distance(setup: WearSetup, law: WearLaw) -> float:
    """The sliding distance 1/(k K) [m], inf where nothing wears.

    Over this distance a rigid shoe on a lining of springs forgets its shape by a factor e.
    """
    return 1 / (law.coefficient * setup.stiffness) if law.coefficient else math.inf


def brake_with_worn_linings(setup: WearSetup, state: WearState) -> Brake:
    """The brake with the depth worn off added to the clearance of its linings."""
    depths = {}
    for surface in setup.surfaces:
        depths[surface.shoe] = surface.angles, surface.along(state.depth)
    return add_worn_depths(setup.brake, depths)


def _largest_worn_depths(surface: WornLining, states: Sequence[WearState]) -> list[float]:
    """The largest depth [m] worn off a lining in each state."""
    return [float(state.depth[surface.part].max()) for state in states]


def check_worn_depth(setup: WearSetup, states: Sequence[WearState]) -> None:
    """Raise NoAnswer where a lining is worn through.

    The message names the lining that is worn through first, and the sliding distance.
    """
    s = list(map(attrgetter("s"), states))
    worn_through = []
    for surface in setup.surfaces:
        # The depth grows with the distance, so that the last state tells whether it is too much.
        thickness = setup.brake.shoes[surface.shoe].lining.thickness
        deepest = _largest_worn_depths(surface, states)
        if deepest[-1] > thickness:
            after = float(np.interp(thickness, deepest, s))
            worn_through.append((after, f"shoe {surface.name!r}: its lining of {mm(thickness)}"))
    if worn_through:
        after, lining = min(worn_through)
        raise NoAnswer(
            f"{lining} is worn through after {after * 1e-3:.4g} km "
            f"of the {s[-1] * 1e-3:.4g} km asked for or needed to settle; "
            "a shorter --distance has an answer"
        )


class LiningLife(NamedTuple):
    """The life of a brake's linings.

    Attributes
    ----------
    distance : sliding distance [m] at which the first lining is worn out
    pressure : part of the life after which the pressure stays near the law; above 1 the linings
        are worn out before
    torque : part of the life after which the torque stays near the law
    """

    distance: float
    pressure: float
    torque: float


def lining_life(
    setup: WearSetup,
    states: Sequence[WearState],
    goal: WearTarget,
    law: WearLaw,
    within: float = 0.01,
    part: float = WORN_OUT,
) -> LiningLife:
    """The life of the linings, and how much of it is spent away from the law.

    Beyond the last state all linings wear at the rate of the law. The loss of thickness does not
    change the stiffness of the lining.

    Parameters
    ----------
    setup : the linings
    states : of a run
    goal : the law
    law : the wear law
    within : relative distance from the law up to which p and torque count as near
    part : of a lining's thickness with which it is worn out at its deepest place
    """
    s = list(map(attrgetter("s"), states))
    end = math.inf
    for surface in setup.surfaces:
        allowed = part * setup.brake.shoes[surface.shoe].lining.thickness
        deepest = _largest_worn_depths(surface, states)
        # The lining is worn out within the run, or later at the rate that the law has.
        if deepest[-1] >= allowed:
            end = min(end, float(np.interp(allowed, deepest, s)))
        elif law.coefficient > 0:
            rate = float(law.rate(goal.pressure[surface.part], 0.0)[0].max())
            end = min(end, s[-1] + (allowed - deepest[-1]) / rate)
    # A quantity is near the law from the last state on that is beyond the bound.
    pressures, torques = np.array(
        [distance_from_target(setup, state, goal) for state in states]
    ).T.tolist()
    pressure_near = archard.settling_distance(s, pressures, within)
    torque_near = archard.settling_distance(s, torques, within)
    return LiningLife(end, pressure_near / end, torque_near / end)


class RunChecks(NamedTuple):
    """The balances of a run, relative to the worn volume, and its checkerboard.

    Attributes
    ----------
    volume : difference between the worn volume and the integral of the wear rate, k Int Int p dA ds
    energy : difference between the volume of the worn shape over the round lining and the friction
        energy, V = k W/mu; None without friction and for other exponents than 1
    ripple : largest checkerboard of any state after the first, see
        `archard.checkerboard_amplitude`; None where the linings have too few nodes
    """

    volume: float
    energy: float | None
    ripple: float | None


def compute_run_checks(setup: WearSetup, states: Sequence[WearState], law: WearLaw) -> RunChecks:
    """The balances and the checkerboard of a run."""
    end = states[-1]
    area = np.concatenate(list(map(attrgetter("area"), setup.interfaces)))
    scale = end.removed or 1.0
    # The first state is the new lining, whose pressure no wear has smoothed.
    ripples = []
    for state in states[1:]:
        for surface in setup.surfaces:
            ripple = archard.checkerboard_amplitude(surface.along(state.pressure))
            # A lining of few nodes has no ripple.
            if not math.isnan(ripple):
                ripples.append(ripple)
    return RunChecks(
        volume=abs(float(area @ end.depth) - end.removed) / scale,
        energy=_energy_imbalance(setup, end, law, scale),
        ripple=max(ripples, default=None),
    )


def _energy_imbalance(setup: WearSetup, end: WearState, law: WearLaw, scale: float) -> float | None:
    """The imbalance between worn volume and friction energy, see RunChecks.

    Parameters
    ----------
    setup : the linings
    end : last state of a run
    law : the wear law
    scale : volume [m^3] that the imbalance is relative to
    """
    brake = setup.brake
    if not (brake.friction > 0 and law.exponent == 1):
        return None
    volumes = []
    for surface in setup.surfaces:
        width = brake.shoes[surface.shoe].lining.width
        depth = _integral_over_lining(surface, surface.along(end.depth))
        volumes.append(width * brake.scale_factor * depth)
    by_energy = law.coefficient * end.work / (brake.friction * brake.scale_factor)
    return abs(sum(volumes) - by_energy) / scale


def _integral_over_lining(surface: WornLining, values: Floats) -> float:
    """The integral over theta of values (n,) by growing theta."""
    _, at_points, weight = gauss_points(surface.angles, values, surface.order)
    return float((at_points * weight).sum())


def peak_nodal_pressure(setup: WearSetup, state: WearState) -> float:
    """The largest nodal pressure [Pa] of a state outside the edge zones at the linings' ends."""
    peaks = []
    for surface in setup.surfaces:
        zone = edge_zone(setup.brake.shoes[surface.shoe], setup.brake.scale_factor)
        peaks.append(nodal_peak(surface.angles, surface.along(state.pressure), zone))
    return max(peaks)


def wear_run_data(
    setup: WearSetup, states: Sequence[WearState], goal: WearTarget, law: WearLaw
) -> dict[str, Any]:
    """A run as plain data for JSON: SI; values of each lining by growing theta.

    Parameters
    ----------
    setup : the linings
    states : of the run
    goal : the law that the wear tends to
    law : the wear law
    """

    def by_lining(values: Floats) -> list[list[float]]:
        """Values (n,) at all unknowns, as a list for each lining."""
        return [surface.along(values).tolist() for surface in setup.surfaces]

    def state_data(state: WearState) -> dict[str, Any]:
        """A wear state as plain data for JSON."""
        off = distance_from_target(setup, state, goal)
        return {
            "distance": state.s,
            "forward": state.forward,
            "torque": state.torque,
            "force": state.force,
            "peak_pressure": peak_nodal_pressure(setup, state),
            "pressure_from_law": off.pressure,
            "torque_from_law": off.torque,
            "worn_volume": state.removed,
            "depth": by_lining(state.depth),
            "pressure": by_lining(state.pressure),
        }

    shoes = []
    for surface in setup.surfaces:
        shoes.append({"name": surface.name, "theta": surface.angles.tolist()})
    return {
        "model": setup.model,
        "law": law._asdict(),
        "unit_distance": unit_sliding_distance(setup, law) if law.coefficient else None,
        "shoes": shoes,
        "worn_in": {"torque": goal.torque, "pressure": by_lining(goal.pressure)},
        "states": list(map(state_data, states)),
    }


def report_lines(
    setup: WearSetup,
    states: Sequence[WearState],
    goal: WearTarget,
    law: WearLaw,
    lines: int = 24,
) -> list[str]:
    """A run as lines of text: some of its states, evenly spread, then its result.

    Parameters
    ----------
    setup : the linings
    states : of the run
    goal : the law that the wear tends to
    law : the wear law
    lines : largest number of states that are shown
    """
    surface = setup.brake.surface
    text = _heading_lines(setup, law)
    for i in np.unique(np.rint(np.linspace(0, len(states) - 1, lines)).astype(int)):
        text.append(_state_line(setup, states[i], goal, law))
    text.append(f"worn in (law): {surface.effect} {goal.torque:.6g} {surface.effect_unit}")
    text += _line_on_mesh_error(setup, goal, law)
    if law.coefficient > 0:
        spent = lining_life(setup, states, goal, law)
        text.append(
            f"life: {spent.distance * 1e-3:.5g} km "
            f"to {formatted(WORN_OUT, '.0%')} of the thickness; "
            f"of it p is more than 1 % off the law for {_life_fraction_text(spent.pressure)}, "
            f"the torque for {_life_fraction_text(spent.torque)}"
        )
    balance = compute_run_checks(setup, states, law)
    energy = "" if balance.energy is None else f", energy {balance.energy:.1e}"
    ripple = "" if balance.ripple is None else f"checkerboard at most {balance.ripple:.1e}; "
    text.append(
        f"worn volume {states[-1].removed * 1e9:.5g} mm^3; "
        f"balance: volume {balance.volume:.1e}{energy}; {ripple}{len(states) - 1} steps"
    )
    return text


def _heading_lines(setup: WearSetup, law: WearLaw) -> list[str]:
    """The brake and the wear law, then the two lines that head the table of states."""
    brake, surface = setup.brake, setup.brake.surface
    wears = ": nothing wears"
    if law.coefficient:
        wears = f", 1/(k K) = {unit_sliding_distance(setup, law) * 1e-3:.5g} km"
    effect_unit = f"[{surface.effect_unit}]"
    return [
        f"{brake.title}: {setup.model}, {brake.motion}, mu = {brake.friction:g}, "
        f"k = {law.coefficient:g} 1/Pa, exponent {law.exponent:.9g}{wears}",
        f"{'s':>9}{'s k K':>9}{surface.short:>10}{'force':>9}{'peak p':>9}{'p off law':>11}"
        f"{'T off law':>11}{'deepest':>10}",
        f"{'[km]':>9}{'':9}{effect_unit:>10}{'[N]':>9}{'[MPa]':>9}{'[%]':>11}"
        f"{'[%]':>11}{'wear [mm]':>10}",
    ]


def _state_line(setup: WearSetup, state: WearState, goal: WearTarget, law: WearLaw) -> str:
    """The line of a wear state in the table of states; parameters as of `report_lines`."""
    off = distance_from_target(setup, state, goal)
    force = state.force * setup.brake.shoes[setup.surfaces[0].shoe].actuation.force
    peak = peak_nodal_pressure(setup, state) * 1e-6
    return (
        f"{state.s * 1e-3:9.5g}{state.s / unit_sliding_distance(setup, law):9.4g}"
        f"{state.torque:10.6g}{force:9.5g}{peak:9.4g}"
        f"{100 * off.pressure:11.3f}{100 * off.torque:+11.4f}{state.depth.max() * 1e3:10.4g}"
    )


def _line_on_mesh_error(setup: WearSetup, goal: WearTarget, law: WearLaw) -> list[str]:
    """A line of text on the distance between the end of wear on this mesh and the law.

    There is no line where the distance is at most WEAR_SETTLED.
    """
    end = discrete_wear_target(setup, law)
    factor = goal.torque / end.torque if end.torque else 1.0
    off = pressure_distance(setup, end.pressure * factor, goal.pressure)
    if off <= WEAR_SETTLED:
        return []
    return [
        f"p at the end of wear is {formatted(off, '.2%')} off the law on this mesh, "
        "for the law presses a part of a lining that ends within an element; "
        "more elements come nearer"
    ]


def _life_fraction_text(share: float) -> str:
    """A part of the life in words."""
    if math.isinf(share):
        return "all of this run"
    return formatted(share, ".1%") if share <= 1 else f"all of it ({share:.3g} lives)"
