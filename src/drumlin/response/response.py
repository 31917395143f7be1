"""What every model returns, whatever it computes with: one Response, with one ShoeResponse a shoe."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from drumlin.arrays import Floats
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.surface import DRUM, FrictionSurface
from drumlin.errors import NoAnswer
from drumlin.response.limits import check_strain
from drumlin.response.resultants import (
    InnerPart,
    Resultant,
    by_piece,
    contact_arcs,
    edge_left_out,
    integrate,
)
from drumlin.response.show import as_html, as_text, plot

EDGE_ZONE = math.radians(0.2)
"""Zone [rad] at each end of a lining in which no pressure is compared: it is singular at a sharp
elastic edge. It is part of what an error of p means, in README and in stated errors.
"""
CURVE_SPACING = math.radians(0.2)
"""Longest step [rad] of a curve that is drawn or written: 500 points of a lining of 100 degrees, as
many as a picture has dots. No answer depends on it.
"""
SMALLEST_CURVE_PIECE = 1e-9
"""Distance [rad] of a curve's pieces from the lining's ends: angles that are nearer to each other
are one in a table. At a pressed corner p has pieces down to 1e-12 rad; 1e-5 of its force is left
so.
"""
NEITHER = 1e-9  # of the work of the normal forces, up to which friction neither helps nor opposes the actuation


@dataclass(frozen=True)
class Balance:
    """What is left of the equilibrium of a shoe, relative to the largest force or moment on it."""

    force: float
    moment: float


class Deformation(NamedTuple):
    """How a shoe's beam and the drum's ring deform.

    At the stations `x` (m,) [m] along the beam from the hinge: displacement `w` (m,) [m] towards
    the drum and `relative` (m,) [m], w beyond the straight line through the beam's ends. `z` (n,)
    [m]: inward displacement of the ring at the response's angles.
    """

    x: Floats
    w: Floats
    relative: Floats
    z: Floats


class ShoeChange(NamedTuple):
    """The parts of a shoe's `pressure` (L2, outside EDGE_ZONE at the lining's ends), `torque` and
    `reaction` by which something changes them, and of its peak that of the pressure near it,
    `peak`.
    """

    pressure: float
    torque: float
    reaction: float
    peak: float = 0.0


NO_CHANGE = ShoeChange(0.0, 0.0, 0.0)
NEAR_PEAK = 0.8  # of the peak: p that is near it
NO_FORCE = 1e-6  # of the contact's: a smaller reaction is none


def reaction_size(reaction: Floats, normal_force: float) -> float:
    """What errors of a reaction (2,) are parts of [N]: its size, or where it is none, NO_FORCE of
    the contact's.
    """
    return max(math.hypot(*reaction), NO_FORCE * normal_force) or 1.0


class PressureField(NamedTuple):
    """The pressure over arc and width: `pressure` (n, m) [Pa] at the response's angles and at `z`
    (m,) [m] off the mid-plane, growing; between these quadratic in z over every two steps.
    """

    z: Floats
    pressure: Floats


@dataclass(frozen=True)
class ShoeResponse:
    """What one shoe does.

    `theta` (n,) [rad], growing, and `pressure` (n,) [Pa] are nodes and values of a piecewise
    polynomial of degree `order`; consecutive pieces share their end node. `torque` >= 0 [N m] is
    the size of the torque on the drum, which opposes its rotation; `normal_force` [N] the size of
    the vector sum of the normal forces; `hinge_reaction` (2,) [N] the force of the pin on the shoe.
    `peak_pressure` [Pa] is the largest pressure; of elastic models the largest one more than half a
    lining thickness from the lining's ends, where a sharp edge has no bound. `turn` [rad] is the
    rotation of the shoe about its pin, where a model knows it. `pivot_reaction` (2,) [N] is the
    force of the pivot on the shoe, where there is one; `reaction_moment` [N m] what a guide adds to
    its force, about `Held.pin`; `force` [N] of the actuation, where shoes share it; `motion` dx, dy
    [m] at `Held.pin` and turn [rad] in the shoe's own frame, of a shoe without hinge; `lumped` the
    contact's forces, where a law lumps them at one point or a model in sectors: else they are the
    integrals of the pressure. `deformation` of beam and ring, of the foundation model. `surface` of
    a solid: its `pressure` is then the mean over the width, in `peak_pressure` too. `error`:
    estimated relative errors "pressure" (L2 outside the edge zones), "torque", "peak" and
    "reaction", None where nothing was estimated; `softness`: what the contact's penalty changes;
    `lost`: about what the round-off of the elimination changes, as far as known.

    Of a shoe on a plane `theta` and `contact_arcs` are places x [m], and `torque` is 0: it brakes
    by a force.
    """

    name: str
    torque: float
    normal_force: float
    self_energising: bool
    peak_pressure: float
    hinge_reaction: Floats
    contact_arcs: tuple[tuple[float, float], ...]
    theta: Floats
    pressure: Floats
    order: int = 2
    turn: float | None = None
    lumped: Resultant | None = None
    pivot_reaction: Floats | None = None
    reaction_moment: float = 0.0
    force: float | None = None
    motion: tuple[float, float, float] | None = None
    deformation: Deformation | None = None
    surface: PressureField | None = None
    error: Mapping[str, float] | None = None
    softness: ShoeChange = NO_CHANGE
    lost: ShoeChange = NO_CHANGE

    def pressure_at(self, theta: Floats) -> Floats:
        """Pressure [Pa] at the angles `theta` [rad], same shape; 0 beyond the lining."""
        theta = np.asarray(theta, dtype=float)
        ends = self.theta[:: self.order]
        piece = np.clip(np.searchsorted(ends, theta, side="right") - 1, 0, len(ends) - 2)
        x, y = by_piece(self.theta, self.order), by_piece(self.pressure, self.order)
        apart = x[:, :, None] - x[:, None]  # (pieces, nodes, nodes)
        one = np.eye(self.order + 1)
        factors = (y / (apart + one).prod(axis=2))[piece]
        off = theta[..., None] - x[piece]
        up, down = (
            np.ones(off.shape),
            np.ones(off.shape),
        )  # products of those before a node, and behind it
        np.cumprod(off[..., :-1], axis=-1, out=up[..., 1:])
        np.cumprod(off[..., :0:-1], axis=-1, out=down[..., -2::-1])
        value = (factors * up * down).sum(axis=-1)
        return np.where((theta >= self.theta[0]) & (theta <= self.theta[-1]), value, 0.0)

    def curve(self) -> tuple[Floats, Floats]:
        """The pressure as a curve to draw and to write: angles (m,) [rad] and p >= 0 (m,) [Pa]
        there.

        Its own nodes, or where pieces are of a high degree so many points that straight lines or
        parabolas between them will do: an even number of even steps a piece. A polynomial may dip
        below zero between its nodes, a pressure not.
        """
        if self.order <= 2:
            return self.theta, self.pressure
        ends = self.theta[:: self.order]
        apart = np.minimum(ends - ends[0], ends[-1] - ends) > SMALLEST_CURVE_PIECE
        ends = np.concatenate([ends[:1], ends[apart], ends[-1:]])
        counts = 2 * np.maximum(self.order, np.ceil(np.diff(ends) / (2 * CURVE_SPACING))).astype(
            int
        )
        theta = np.concatenate(
            [
                np.linspace(a, b, n + 1)[:-1]
                for a, b, n in zip(ends[:-1], ends[1:], counts, strict=True)
            ]
        )
        theta = np.append(theta, ends[-1])
        return theta, np.maximum(self.pressure_at(theta), 0.0)

    def as_dict(self) -> dict[str, Any]:
        """The response as plain data for JSON (units as in the attributes); the pressure as `curve`
        has it.
        """
        theta, pressure = self.curve()
        data: dict[str, Any] = {
            "name": self.name,
            "torque": self.torque,
            "normal_force": self.normal_force,
            "self_energising": self.self_energising,
            "peak_pressure": self.peak_pressure,
            "hinge_reaction": [float(x) for x in self.hinge_reaction],
            "contact_arcs": [list(arc) for arc in self.contact_arcs],
            "theta": theta.tolist(),
            "pressure": pressure.tolist(),
        }
        if self.error is not None:
            data["error"] = dict(self.error)
        if self.force is not None:
            data["force"] = self.force
        if self.reaction_moment:
            data["reaction_moment"] = self.reaction_moment
        if self.pivot_reaction is not None:
            data["pivot_reaction"] = [float(x) for x in self.pivot_reaction]
        if self.deformation is not None:
            data["deformation"] = {
                key: values.tolist() for key, values in self.deformation._asdict().items()
            }
        if self.surface is not None:
            data["surface"] = {
                key: values.tolist() for key, values in self.surface._asdict().items()
            }
        return data


class Merit(NamedTuple):
    """Figures of merit of a shoe on a drum, from its p(theta); None where 0 is divided by 0 or by
    mu = 0.

    `resultant_angle` [rad] of the normal pressure at O, counted as the lining's angles are;
    `friction_radius` psi, the apparent radius of friction over R; `shoe_factor` T/(F R);
    `mechanical_advantage` eta = T/M = 1/(m - double_delta n); `sensitivity_at_fixed_shape` m eta,
    the (mu/eta) d eta/d mu of a pressure whose shape does not change.
    """

    resultant_angle: float | None
    friction_radius: float | None
    shoe_factor: float | None
    mechanical_advantage: float | None
    m: float | None
    n: float | None
    double_delta: int
    sensitivity_at_fixed_shape: float | None

    def effect_of(self, shoe: ShoeResponse) -> float:
        """What the shoe does: its torque [N m]."""
        return shoe.torque


class FlatMerit(NamedTuple):
    """Figures of merit of a shoe on a plane: braking force [N], the same over the actuation moment
    M [1/m], S.
    """

    braking_force: float
    braking_force_over_moment: float | None
    sensitivity_at_fixed_shape: float | None

    def effect_of(self, shoe: ShoeResponse) -> float:
        """What the shoe does: its braking force [N]."""
        return self.braking_force


@dataclass(frozen=True, repr=False)
class Response:
    """What a model answers for a brake.

    `seconds`: time of each phase; `left_out`: what was not computed, and why; `merits`: one a shoe;
    `bearing_load` (2,) [N]: force of all shoes on the drum, which its bearings carry. `error`:
    estimated relative errors "pressure" (L2 outside the edge zones, the worst shoe's) and "torque",
    None where nothing was estimated. `surface`: what the brake runs on, known once it has `merits`.
    """

    model: str
    shoes: tuple[ShoeResponse, ...]
    balance: Balance
    converged: bool = True
    iterations: int = 0
    seconds: Mapping[str, float] = field(default_factory=dict)
    left_out: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    merits: tuple[Merit | FlatMerit, ...] = ()
    bearing_load: Floats | None = None
    error: Mapping[str, float] | None = None
    surface: FrictionSurface = DRUM

    def __post_init__(self) -> None:
        for shoe in self.shoes:
            numbers = shoe.torque, shoe.normal_force, shoe.peak_pressure, *shoe.hinge_reaction
            if not (all(map(math.isfinite, numbers)) and np.isfinite(shoe.pressure).all()):
                raise NoAnswer(
                    f"shoe {shoe.name!r}: the answer is not finite, sizes or forces are beyond the arithmetic"
                )

    @property
    def torque(self) -> float:
        """Torque of all shoes on the drum [N m], >= 0, against the rotation."""
        return math.fsum(shoe.torque for shoe in self.shoes)

    @property
    def effects(self) -> list[float]:
        """What each shoe does: its torque [N m], on a plane its braking force [N]."""
        if not self.merits:
            return [shoe.torque for shoe in self.shoes]
        return [merit.effect_of(shoe) for merit, shoe in zip(self.merits, self.shoes, strict=True)]

    @property
    def effect(self) -> float:
        """What the brake does: its torque [N m], on a plane its braking force [N]."""
        return math.fsum(self.effects)

    def __repr__(self) -> str:
        return as_text(self)

    def _repr_html_(self) -> str:
        return as_html(self)

    def plot(self, axes: Any = None) -> Any:
        """Draw p(theta) of every shoe, in MPa over degrees, into matplotlib `axes`, or new ones;
        returns them.
        """
        return plot(self, axes)

    def as_dict(self) -> dict[str, Any]:
        """The response as plain data for JSON (units as in the attributes: N m, N, Pa, rad, s)."""
        merits = [merit._asdict() for merit in self.merits] or [{} for _ in self.shoes]
        data: dict[str, Any] = {
            "model": self.model,
            "torque": self.torque,
            "converged": self.converged,
            "iterations": self.iterations,
            "error": None if self.error is None else dict(self.error),
            "balance": {"force": self.balance.force, "moment": self.balance.moment},
            "seconds": dict(self.seconds),
            "left_out": list(self.left_out),
            "notes": list(self.notes),
            "shoes": [
                shoe.as_dict() | merit for shoe, merit in zip(self.shoes, merits, strict=True)
            ],
        }
        if self.bearing_load is not None:
            data["bearing_load"] = [float(x) for x in self.bearing_load]
        return data


def untouched(shoe: Shoe, hinge_reaction: Floats) -> ShoeResponse:
    """The response of a shoe that does not touch the drum: no torque, no pressure."""
    theta = np.linspace(shoe.lining.start, shoe.lining.end, 3)
    return ShoeResponse(
        name=shoe.name,
        torque=0.0,
        normal_force=0.0,
        self_energising=False,
        peak_pressure=0.0,
        hinge_reaction=hinge_reaction,
        contact_arcs=(),
        theta=theta,
        pressure=np.zeros(3),
        pivot_reaction=np.zeros(2) if shoe.pivot else None,
    )


def pressed_shoe(
    shoe: Shoe,
    scale_factor: float,
    theta: Floats,
    pressure: Floats,
    *,
    order: int,
    torque: float,
    normal_force: float,
    self_energising: bool,
    hinge_reaction: Floats,
    turn: float | None = None,
    located: bool = True,
    peak: float | None = None,
    surface: PressureField | None = None,
    **more: Any,
) -> ShoeResponse:
    """The response of an elastic lining: `pressure` (n,) [Pa] at the angles theta (n,) [rad],
    growing or falling.

    scale_factor: of the brake's surface; located: the ends of the contact and the peak are located
    within their elements; peak: its pressure [Pa], where it is known; surface: its rows as the
    angles; more: other attributes of ShoeResponse. Raises NoAnswer beyond LARGEST_STRAIN.
    """
    forward = slice(None, None, 1 if theta[-1] > theta[0] else -1)
    theta, pressure = theta[forward], pressure[forward]
    if peak is None:
        zone = edge_zone(shoe, scale_factor)
        if located:
            peak = InnerPart(theta, order, zone).peak(pressure)
        else:
            peak = nodal_peak(theta, pressure, edge_left_out(theta, pressure, order, zone))
    arcs = contact_arcs(theta, pressure, order, located=located)
    force = (
        shoe.lining.width * scale_factor * integrate(theta, pressure, order)
    )  # not its resultant: opposite sides cancel
    check_strain(shoe, scale_factor, force, sum(end - start for start, end in arcs))
    return ShoeResponse(
        name=shoe.name,
        torque=torque,
        normal_force=normal_force,
        self_energising=self_energising,
        peak_pressure=peak,
        hinge_reaction=hinge_reaction,
        contact_arcs=arcs,
        theta=theta,
        pressure=pressure,
        order=order,
        turn=turn,
        surface=None if surface is None else surface._replace(pressure=surface.pressure[forward]),
        **more,
    )


def edge_zone(shoe: Shoe, scale_factor: float) -> float:
    """Half the lining's thickness at each of its ends, in which a sharp edge makes the pressure
    steep; a quarter of its length where that is all of it. In the coordinate of a surface of this
    scale factor.
    """
    zone, length = (
        (shoe.lining.thickness or 0.0) / (2 * scale_factor),
        shoe.lining.end - shoe.lining.start,
    )
    return zone if 2 * zone < length else 0.25 * length


def own_edge_zone(shoe: Shoe, size: float) -> float:
    """The same zone in phi of the shoe's own frame, in a brake of this size [m]."""
    unit = shoe.frame.unit
    return edge_zone(shoe, size / unit) / unit


def singular_zone(length: float, unit: float = 1.0) -> float:
    """EDGE_ZONE at each end of a lining of this length, a quarter of a short one; both in a
    coordinate of which one unit of phi has `unit`.
    """
    return min(unit * EDGE_ZONE, 0.25 * length)


class PeakPlace(NamedTuple):
    """Where a pressure peaks: the angle (on a plane x) `at` [rad, m], and the `zone` at the ends
    that is left out.
    """

    at: float
    zone: float


def peak_place(brake: Brake, index: int, response: ShoeResponse) -> PeakPlace | None:
    """Where shoe `index` has its peak pressure, within CURVE_SPACING; None where it does not touch.

    The points of the curve may miss the peak. So the zones at the ends are said to be left out
    where the largest value between them is nearer to the peak than the largest one of all.
    """
    if not response.contact_arcs or not response.peak_pressure > 0:
        return None
    theta, pressure = response.curve()
    zone = edge_zone(brake.shoes[index], brake.scale_factor)
    inside = (theta > theta[0] + zone) & (theta < theta[-1] - zone)
    apart = abs(pressure[inside].max(initial=0.0) - response.peak_pressure)
    if abs(pressure.max() - response.peak_pressure) <= apart:
        inside, zone = np.ones(len(theta), dtype=bool), 0.0
    return PeakPlace(float(theta[inside][pressure[inside].argmax()]), zone)


def nodal_peak(theta: Floats, pressure: Floats, zone: float) -> float:
    """Largest nodal pressure [Pa] more than `zone` [rad] from the lining's ends; of all where none
    presses there.
    """
    inside = (theta > theta[0] + zone) & (theta < theta[-1] - zone)
    return float(pressure[inside if pressure[inside].any() else slice(None)].max())
