"""What every model returns: one Response, with one ShoeResponse per shoe."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.surface import DRUM, FrictionSurface
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
"""Zone [rad] at each end of a lining in which no pressures are compared.

The pressure is singular at a sharp elastic edge. The zone is part of the meaning of an error of p,
in README and in stated errors.
"""

CURVE_SPACING = math.radians(0.2)
"""Longest step [rad] of a curve that is drawn or written.

It gives 500 points over a lining of 100 degrees, as many as a picture has dots. No answer depends
on it.
"""

SMALLEST_CURVE_PIECE = 1e-9
"""Distance [rad] from the lining's ends within which the pieces of a curve are left out.

Angles that are nearer to each other are the same in a table. At a pressed corner p has pieces down
to 1e-12 rad, and 1e-5 of the corner's force lies in the pieces that are left out.
"""

NEITHER = 1e-9
"""Work of the friction, relative to the work of the normal forces, that counts as round-off.

Below it friction neither helps nor opposes the actuation.
"""

NO_FORCE = 1e-6
"""Reaction relative to the contact's force below which the reaction counts as zero."""


@dataclass(frozen=True)
class Balance:
    """Imbalance of a shoe: sums of forces and of moments, relative to their largest members."""

    force: float
    moment: float


class Deformation(NamedTuple):
    """Deflections of a shoe's beam and of the drum's ring.

    Attributes
    ----------
    x : (m,), stations along the beam from the hinge [m]
    w : (m,), displacement towards the drum there [m]
    relative : (m,), w beyond the straight line through the beam's ends [m]
    z : (n,), inward displacement of the ring at the response's angles [m]
    """

    x: Floats
    w: Floats
    relative: Floats
    z: Floats


class ShoeChange(NamedTuple):
    """Relative changes of a shoe's results by a cause such as the penalty.

    Attributes
    ----------
    pressure : in L2, outside EDGE_ZONE at the lining's ends
    torque : of the torque
    reaction : of the support reaction
    peak : of the pressure near the peak
    """

    pressure: float
    torque: float
    reaction: float
    peak: float = 0.0


NO_CHANGE = ShoeChange(0.0, 0.0, 0.0)


def reaction_size(reaction: Floats, normal_force: float) -> float:
    """Force [N] to which errors of a reaction (2,) [N] are relative.

    It is the size of the reaction, and at least NO_FORCE of the contact's force.
    """
    return max(math.hypot(*reaction), NO_FORCE * normal_force) or 1.0


class PressureOverWidth(NamedTuple):
    """The pressure over arc and width.

    Attributes
    ----------
    z : (m,), growing distances from the mid-plane [m]
    pressure : (n, m), pressures [Pa] at the response's angles and at z; quadratic in z over every
        two steps
    """

    z: Floats
    pressure: Floats


@dataclass(frozen=True)
class ShoeResponse:
    """What one shoe does.

    Of a shoe on a plane `theta` and `contact_arcs` are places x [m], and `torque` is 0: the shoe
    brakes by a force.

    Attributes
    ----------
    name : of the shoe
    torque : size of the torque on the drum [N m]; it opposes the rotation
    normal_force : size of the vector sum of the normal forces [N]
    self_energising : whether friction helps the actuation
    peak_pressure : largest pressure [Pa]. Of elastic models it is the largest pressure more than
        half a lining thickness from the lining's ends, where a sharp edge has no bound.
    hinge_reaction : (2,), force of the pin on the shoe [N]
    contact_arcs : begin and end of each arc in contact [rad]
    theta : (n,), growing nodes of a piecewise polynomial [rad]; consecutive pieces share an end
    pressure : (n,), values of the pressure there [Pa]
    order : degree of the pieces
    turn : rotation of the shoe about its pin [rad]; None if the model does not know it
    lumped : resultant of the contact, if a law lumps the forces at one point or a model in sectors;
        otherwise the resultant is the integral of the pressure
    pivot_reaction : (2,), force of the pivot on the shoe [N], if there is a pivot
    reaction_moment : moment that a guide adds to its force, about `Held.pin` [N m]
    force : of the actuation [N], if shoes share it
    motion : dx, dy [m] at `Held.pin` and turn [rad] of a shoe without hinge, in the shoe's frame
    deformation : of beam and ring, of the foundation model
    surface : pressure over the width of a solid; then `pressure` and `peak_pressure` are means over
        the width
    error : estimated relative errors "pressure" (L2 outside the edge zones), "torque", "peak" and
        "reaction"; None if nothing was estimated
    softness : change that the contact's penalty causes
    lost : change that the round-off of the elimination causes, as far as it is known
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
    surface: PressureOverWidth | None = None
    error: Mapping[str, float] | None = None
    softness: ShoeChange = NO_CHANGE
    lost: ShoeChange = NO_CHANGE

    def pressure_at(self, theta: Floats) -> Floats:
        """Pressure [Pa] at the angles `theta` [rad], same shape; 0 beyond the lining.

        It is Lagrange's interpolation in the piece of each angle.
        """
        theta = np.asarray(theta, dtype=float)
        ends = self.theta[:: self.order]
        piece = np.clip(np.searchsorted(ends, theta, side="right") - 1, 0, len(ends) - 2)
        x, y = by_piece(self.theta, self.order), by_piece(self.pressure, self.order)
        # Distances of the nodes of a piece from each other; 1 from a node to itself.
        apart = x[:, :, None] - x[:, None]  # (pieces, nodes, nodes)
        unit = np.eye(self.order + 1)
        factors = (y / (apart + unit).prod(axis=2))[piece]
        # Products of the distances to all nodes before a node, and to all nodes behind it.
        off = theta[..., None] - x[piece]
        before, behind = np.ones(off.shape), np.ones(off.shape)
        np.cumprod(off[..., :-1], axis=-1, out=before[..., 1:])
        np.cumprod(off[..., :0:-1], axis=-1, out=behind[..., -2::-1])
        value = (factors * before * behind).sum(axis=-1)
        on_lining = (theta >= self.theta[0]) & (theta <= self.theta[-1])
        return np.where(on_lining, value, 0.0)

    def curve(self) -> tuple[Floats, Floats]:
        """The pressure as a curve to draw and to write: angles (m,) [rad] and p >= 0 (m,) [Pa].

        Pieces up to degree 2 keep their own nodes. Pieces of a higher degree get an even number of
        even steps each, so many that straight lines or parabolas between them are good enough. A
        polynomial may dip below zero between its nodes; the curve does not.
        """
        if self.order <= 2:
            return self.theta, self.pressure
        ends = self.theta[:: self.order]
        apart = np.minimum(ends - ends[0], ends[-1] - ends) > SMALLEST_CURVE_PIECE
        ends = np.concatenate([ends[:1], ends[apart], ends[-1:]])
        half_steps = np.ceil(np.diff(ends) / (2 * CURVE_SPACING))
        counts = 2 * np.maximum(self.order, half_steps).astype(int)
        pieces = [
            np.linspace(a, b, count + 1)[:-1]
            for a, b, count in zip(ends[:-1], ends[1:], counts, strict=True)
        ]
        theta = np.append(np.concatenate(pieces), ends[-1])
        return theta, np.maximum(self.pressure_at(theta), 0.0)

    def as_dict(self) -> dict[str, Any]:
        """The response as plain data for JSON, in the units of the attributes.

        Its pressure is that of `curve`.
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
    """Figures of merit of a shoe on a drum, from its p(theta).

    A figure is None if 0 is divided by 0 or by mu = 0.

    Attributes
    ----------
    resultant_angle : of the normal pressure's resultant at O [rad], counted as the lining's angles
    friction_radius : psi, the apparent radius of friction over R
    shoe_factor : T/(F R)
    mechanical_advantage : eta = T/M = 1/(m - double_delta n)
    m : moment of the normal pressure about the hinge over T
    n : moment of the friction about the hinge over its moment about O
    double_delta : sign of n in eta
    sensitivity_at_fixed_shape : m eta, the (mu/eta) d eta/d mu of a pressure of constant shape
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
    """Figures of merit of a shoe on a plane.

    Attributes
    ----------
    braking_force : force against the motion [N]
    braking_force_over_moment : braking force over the actuation's moment M [1/m]
    sensitivity_at_fixed_shape : S, relative change of the braking force per relative change of mu
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

    Attributes
    ----------
    model : name of the model
    shoes : one response per shoe
    balance : largest imbalance of the shoes
    converged : whether the model has converged
    iterations : number of its iterations
    seconds : time of each phase [s]
    left_out : what was not computed, and why
    notes : lines for the reader
    merits : figures of merit, one per shoe
    bearing_load : (2,), force of all shoes on the drum, which its bearings carry [N]
    error : estimated relative errors "pressure" (L2 outside the edge zones, the worst shoe's) and
        "torque"; None if nothing was estimated
    surface : surface on which the brake runs, known once the response has `merits`
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
                    f"shoe {shoe.name!r}: the answer is not finite, "
                    "sizes or forces are beyond the arithmetic"
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
        """Draw p(theta) of every shoe, in MPa over degrees.

        It draws into matplotlib `axes`, or into new axes, and returns them.
        """
        return plot(self, axes)

    def as_dict(self) -> dict[str, Any]:
        """The response as plain data for JSON, in N m, N, Pa, rad and s."""
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
    surface: PressureOverWidth | None = None,
    **more: Any,
) -> ShoeResponse:
    """The response of a shoe whose elastic lining is pressed.

    Parameters
    ----------
    shoe : the shoe
    scale_factor : of the brake's surface [m per unit of its coordinate]
    theta : (n,), growing or falling nodes [rad]
    pressure : (n,), pressures there [Pa]
    order, torque, normal_force, self_energising, hinge_reaction, turn : as of ShoeResponse
    located : whether the ends of the contact and the peak are located within their elements
    peak : peak pressure [Pa], if it is known
    surface : pressure over the width, its rows at theta
    more : other attributes of ShoeResponse

    Raises
    ------
    NoAnswer
        if the lining is strained beyond LARGEST_STRAIN
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
    # The sum of the normal forces: in their resultant opposite sides would cancel.
    force = shoe.lining.width * scale_factor * integrate(theta, pressure, order)
    check_strain(shoe, scale_factor, force, sum(end - start for start, end in arcs))
    if surface is not None:
        surface = surface._replace(pressure=surface.pressure[forward])
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
        surface=surface,
        **more,
    )


def edge_zone(shoe: Shoe, scale_factor: float) -> float:
    """Zone at each end of a lining in which a sharp edge makes the pressure steep.

    It is half the lining's thickness, or a quarter of the length of a short lining, in the
    coordinate of a surface of this scale factor.
    """
    zone = (shoe.lining.thickness or 0.0) / (2 * scale_factor)
    length = shoe.lining.end - shoe.lining.start
    return zone if 2 * zone < length else 0.25 * length


def own_edge_zone(shoe: Shoe, size: float) -> float:
    """The zone of `edge_zone` in phi of the shoe's own frame, in a brake of this size [m]."""
    unit = shoe.frame.unit
    return edge_zone(shoe, size / unit) / unit


def singular_zone(length: float, unit: float = 1.0) -> float:
    """EDGE_ZONE at each end of a lining of this length, or a quarter of a short lining.

    Both count in a coordinate of which one unit of phi has `unit`.
    """
    return min(unit * EDGE_ZONE, 0.25 * length)


class PeakPlace(NamedTuple):
    """Where a pressure peaks: at the angle `at` [rad], on a plane at x [m].

    The peak is sought outside a `zone` at the lining's ends.
    """

    at: float
    zone: float


def peak_place(brake: Brake, index: int, response: ShoeResponse) -> PeakPlace | None:
    """Where shoe `index` has its peak pressure, within CURVE_SPACING; None without contact.

    The points of the curve may miss the peak. The zones at the ends therefore count as left out if
    the largest value outside the zones is nearer to the peak than the largest of all values.
    """
    if not response.contact_arcs or not response.peak_pressure > 0:
        return None
    theta, pressure = response.curve()
    zone = edge_zone(brake.shoes[index], brake.scale_factor)
    inside = _inside(theta, zone)
    apart = abs(pressure[inside].max(initial=0.0) - response.peak_pressure)
    if abs(pressure.max() - response.peak_pressure) <= apart:
        inside, zone = np.ones(len(theta), dtype=bool), 0.0
    highest = pressure[inside].argmax()
    return PeakPlace(float(theta[inside][highest]), zone)


def nodal_peak(theta: Floats, pressure: Floats, zone: float) -> float:
    """Largest nodal pressure [Pa] more than `zone` [rad] from the lining's ends.

    If no node presses there, all nodes count.
    """
    inside = _inside(theta, zone)
    return float(pressure[inside if pressure[inside].any() else slice(None)].max())


def _inside(theta: Floats, zone: float) -> Bools:
    """Whether angles (n,) are more than `zone` from the first and the last of them."""
    return np.asarray((theta > theta[0] + zone) & (theta < theta[-1] - zone))
