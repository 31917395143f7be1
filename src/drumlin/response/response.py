"""The result of every model: one Response with one ShoeResponse per shoe."""

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

The pressure is singular at a sharp elastic edge. Stated errors of the pressure, in README too, hold
outside this zone.
"""

CURVE_SPACING = math.radians(0.2)
"""Longest step [rad] between two points of a pressure curve that is drawn or written.

A lining of 100 degrees gets 500 points, as many as a picture has dots. The step changes no answer.
"""

SMALLEST_CURVE_PIECE = 1e-9
"""Distance [rad] from the lining's ends within which a curve leaves out ends of pieces.

Angles that differ by less are the same number in a table. The pressure at a pressed corner has
pieces down to 1e-12 rad. The pieces that are left out bear 1e-5 of the corner's force.
"""

NEITHER = 1e-9
"""Work of the friction, relative to the work of the normal forces, that counts as round-off.

If its work is smaller, friction neither helps nor opposes the actuation.
"""

NO_FORCE = 1e-6
"""Fraction of the contact's force below which a support reaction counts as zero."""


@dataclass(frozen=True)
class Balance:
    """Imbalance of a shoe: the sum of its forces and the sum of its moments.

    Each sum is relative to its largest member.
    """

    force: float
    moment: float


class Deformation(NamedTuple):
    """Deflections of a shoe's beam and of the drum's ring.

    Attributes
    ----------
    x : stations (m,) [m] along the beam from the hinge
    w : displacement (m,) [m] of the beam towards the drum
    relative : displacement (m,) [m] of the beam beyond the straight line through the beam's ends
    z : inward displacement (n,) [m] of the ring at the response's angles
    """

    x: Floats
    w: Floats
    relative: Floats
    z: Floats


class ShoeChange(NamedTuple):
    """Relative changes of a shoe's results by a cause such as the penalty.

    Attributes
    ----------
    pressure : change of the pressure in L2, outside EDGE_ZONE at the lining's ends
    torque : change of the torque
    reaction : change of the support reaction
    peak : change of the pressure near the peak
    """

    pressure: float
    torque: float
    reaction: float
    peak: float = 0.0


NO_CHANGE = ShoeChange(0.0, 0.0, 0.0)


def reaction_size(reaction: Floats, normal_force: float) -> float:
    """The force [N] to which errors of a support reaction (2,) [N] are relative.

    This force is the size of the reaction, and at least NO_FORCE of the contact's force.
    """
    return max(math.hypot(*reaction), NO_FORCE * normal_force) or 1.0


class ModelError(NamedTuple):
    """How far plane stress is estimated to be from the shoes with their widths.

    Attributes
    ----------
    brake : relative errors "torque", of the brake, and "pressure" (mean over the width, L2 outside
        the edge zones) and "reaction" of the worst shoe; empty if they are not known
    shoes : the same three errors of each shoe
    unknown : why they are not known; empty if they are
    """

    brake: Mapping[str, float]
    shoes: tuple[Mapping[str, float], ...] = ()
    unknown: str = ""

    def as_dict(self) -> dict[str, Any]:
        """The errors of the brake as plain data for JSON; that of the peak is not known."""
        if self.unknown:
            return {"unknown": self.unknown}
        return {**self.brake, "peak": None}


class PressureOverWidth(NamedTuple):
    """The pressure over the arc and the width of a lining.

    Attributes
    ----------
    z : growing distances (m,) [m] from the mid-plane
    pressure : pressures (n, m) [Pa] at the response's angles and at z; quadratic in z over every
        two steps
    """

    z: Floats
    pressure: Floats


@dataclass(frozen=True)
class ShoeResponse:
    """The forces, the pressure and the motion of one shoe, as a model answers.

    For a shoe on a plane, `theta` and `contact_arcs` are places x [m], and `torque` is 0, because
    the shoe brakes by a force.

    Attributes
    ----------
    name : name of the shoe
    torque : size of the torque on the drum [N m], which opposes the rotation
    normal_force : size of the vector sum of the normal forces [N]
    self_energising : whether friction helps the actuation
    peak_pressure : largest pressure [Pa]. Elastic models leave out half a lining thickness at each
        end of the lining, where the pressure at a sharp edge has no bound.
    hinge_reaction : force (2,) [N] of the pin on the shoe
    contact_arcs : begin and end of each arc in contact [rad]
    theta : growing nodes (n,) [rad] of a piecewise polynomial; consecutive pieces share an end
    pressure : pressures (n,) [Pa] at the nodes
    order : degree of the pieces
    turn : rotation of the shoe about its pin [rad]; None if the model does not know the rotation
    lumped : resultant of the contact, if a law lumps the forces at one point or a model in sectors;
        otherwise the resultant is the integral of the pressure
    pivot_reaction : force (2,) [N] of the pivot on the shoe; None without a pivot
    reaction_moment : moment that a guide adds to its force, about `Held.pin` [N m]
    force : actuation force [N], if shoes share forces
    motion : dx, dy [m] at `Held.pin` and turn [rad] of a shoe without hinge, in the shoe's frame
    deformation : deflections of beam and ring, from the foundation model
    surface : pressure over the width of a solid; then `pressure` and `peak_pressure` are means over
        the width
    error : estimated relative errors "pressure" (L2 outside the edge zones), "torque", "peak" and
        "reaction"; None if nothing was estimated
    softness : relative change of the results by the contact's penalty
    lost : known relative change of the results by the round-off of the elimination
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
        """The pressure [Pa] at angles `theta` [rad] of any shape; 0 beyond the lining.

        The pressure is Lagrange's interpolation of the nodal values in the piece of each angle.
        """
        theta = np.asarray(theta, dtype=float)
        ends = self.theta[:: self.order]
        piece = np.clip(np.searchsorted(ends, theta, side="right") - 1, 0, len(ends) - 2)
        x, y = by_piece(self.theta, self.order), by_piece(self.pressure, self.order)
        # Distances of the nodes of a piece from each other; the diagonal is set to 1.
        apart = x[:, :, None] - x[:, None]  # (pieces, nodes, nodes)
        unit = np.eye(self.order + 1)
        factors = (y / (apart + unit).prod(axis=2))[piece]
        # Products of the distances to all nodes before a node, and to all nodes behind the node.
        off = theta[..., None] - x[piece]
        before, behind = np.ones(off.shape), np.ones(off.shape)
        np.cumprod(off[..., :-1], axis=-1, out=before[..., 1:])
        np.cumprod(off[..., :0:-1], axis=-1, out=behind[..., -2::-1])
        value = (factors * before * behind).sum(axis=-1)
        on_lining = (theta >= self.theta[0]) & (theta <= self.theta[-1])
        return np.where(on_lining, value, 0.0)

    def curve(self) -> tuple[Floats, Floats]:
        """The pressure as a curve to draw or write: angles (m,) [rad] and pressures >= 0 (m,) [Pa].

        Pieces up to degree 2 keep their own nodes. A piece of a higher degree is divided into an
        even number of even steps. The steps are so short that straight lines or parabolas between
        the points follow the polynomial.
        """
        if self.order <= 2:
            return self.theta, self.pressure
        # Pieces next to the lining's ends that are too short to show are joined.
        ends = self.theta[:: self.order]
        apart = np.minimum(ends - ends[0], ends[-1] - ends) > SMALLEST_CURVE_PIECE
        ends = np.concatenate([ends[:1], ends[apart], ends[-1:]])
        half_steps = np.ceil(np.diff(ends) / (2 * CURVE_SPACING))
        counts = 2 * np.maximum(self.order, half_steps).astype(int)
        pieces = []
        for i, count in enumerate(counts):
            pieces.append(np.linspace(ends[i], ends[i + 1], count + 1)[:-1])
        theta = np.append(np.concatenate(pieces), ends[-1])
        # A polynomial may dip below zero between its nodes, where no pressure acts.
        return theta, np.maximum(self.pressure_at(theta), 0.0)

    def as_dict(self) -> dict[str, Any]:
        """Convert the response of the shoe to plain data for JSON, in the units of the attributes.

        The angles and pressures are the points of `curve`.
        """
        theta, pressure = self.curve()
        data: dict[str, Any] = {
            "name": self.name,
            "torque": self.torque,
            "normal_force": self.normal_force,
            "self_energising": self.self_energising,
            "peak_pressure": self.peak_pressure,
            "hinge_reaction": list(map(float, self.hinge_reaction)),
            "contact_arcs": list(map(list, self.contact_arcs)),
            "theta": theta.tolist(),
            "pressure": pressure.tolist(),
        }
        # Results that this shoe or its model does not have are no keys.
        if self.error is not None:
            data["error"] = dict(self.error)
        if self.force is not None:
            data["force"] = self.force
        if self.reaction_moment:
            data["reaction_moment"] = self.reaction_moment
        if self.pivot_reaction is not None:
            data["pivot_reaction"] = list(map(float, self.pivot_reaction))
        for name in ("deformation", "surface"):
            arrays = getattr(self, name)
            if arrays is not None:
                data[name] = {key: values.tolist() for key, values in arrays._asdict().items()}
        return data


class Merit(NamedTuple):
    """The figures of merit of a shoe on a drum, from its pressure p(theta).

    A figure is None if its definition divides by 0.

    Attributes
    ----------
    resultant_angle : angle [rad] of the normal pressure's resultant at the drum's centre O, counted
        as the lining's angles
    friction_radius : psi, the apparent radius of friction over R
    shoe_factor : T/(F R)
    mechanical_advantage : eta = T/M = 1/(m - double_delta n)
    m : moment of the normal pressure about the hinge over T
    n : moment of the friction about the hinge over the moment of the friction about O
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
        """The effect of the shoe on the drum, a torque [N m]."""
        return shoe.torque


class FlatMerit(NamedTuple):
    """The figures of merit of a shoe on a plane.

    Attributes
    ----------
    braking_force : force of the shoe against the motion [N]
    braking_force_over_moment : braking force over the actuation's moment M [1/m]
    sensitivity_at_fixed_shape : S, relative change of the braking force per relative change of mu
    """

    braking_force: float
    braking_force_over_moment: float | None
    sensitivity_at_fixed_shape: float | None

    def effect_of(self, shoe: ShoeResponse) -> float:
        """The effect of the shoe on the plane, a braking force [N]."""
        return self.braking_force


@dataclass(frozen=True, repr=False)
class Response:
    """The answer of a model for a brake.

    Attributes
    ----------
    model : name of the model
    shoes : response of each shoe
    balance : largest imbalance of the shoes
    converged : whether the model has converged
    iterations : number of the model's iterations
    seconds : time of each phase of the solve [s]
    left_out : effects that the model neglects, a line each
    notes : lines for the reader
    merits : figures of merit of each shoe; empty until `with_merits` adds them
    bearing_load : force (2,) [N] of all shoes on the drum, which the drum's bearings carry
    error : estimated relative errors "pressure" (L2 outside the edge zones, the worst shoe's) and
        "torque"; None if nothing was estimated
    surface : surface on which the brake runs, known once the response has `merits`
    plane_stress_error : estimated error of plane stress itself; None if it was not asked for
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
    plane_stress_error: ModelError | None = None

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
        """The torque of all shoes on the drum [N m], >= 0, against the rotation."""
        return math.fsum(shoe.torque for shoe in self.shoes)

    @property
    def effects(self) -> list[float]:
        """The effect of each shoe: its torque [N m], on a plane its braking force [N]."""
        effects = [shoe.torque for shoe in self.shoes]
        for i, merit in enumerate(self.merits):
            effects[i] = merit.effect_of(self.shoes[i])
        return effects

    @property
    def effect(self) -> float:
        """The effect of the brake: its torque [N m], on a plane its braking force [N]."""
        return math.fsum(self.effects)

    def __repr__(self) -> str:
        return as_text(self)

    def _repr_html_(self) -> str:
        return as_html(self)

    def plot(self, axes: Any = None) -> Any:
        """Draw p(theta) of every shoe, in MPa over degrees, and return the matplotlib axes.

        The curves are drawn into the given `axes`, or into new axes.
        """
        return plot(self, axes)

    def as_dict(self) -> dict[str, Any]:
        """Convert the response to plain data for JSON, in N m, N, Pa, rad and s."""
        shoes = [shoe.as_dict() for shoe in self.shoes]
        for i, merit in enumerate(self.merits):
            shoes[i] |= merit._asdict()
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
            "shoes": shoes,
        }
        if self.bearing_load is not None:
            data["bearing_load"] = list(map(float, self.bearing_load))
        if self.plane_stress_error is not None:
            data["plane_stress_error"] = self.plane_stress_error.as_dict()
            for shoe, own in zip(shoes, self.plane_stress_error.shoes, strict=False):
                shoe["plane_stress_error"] = dict(own)
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
    located: bool = True,
    peak: float | None = None,
    surface: PressureOverWidth | None = None,
    **results: Any,
) -> ShoeResponse:
    """Make the response of a shoe whose elastic lining is pressed.

    Parameters
    ----------
    shoe : the shoe
    scale_factor : length per unit of the surface's coordinate [m/rad, on a plane 1]
    theta : growing or falling nodes (n,) [rad]
    pressure : pressures (n,) [Pa] at the nodes
    order : degree of the pieces of the pressure
    located : whether the ends of the contact and the peak are located within their elements
    peak : peak pressure [Pa]; None if unknown
    surface : pressure over the width, whose rows stand at theta
    results : the attributes torque, normal_force, self_energising and hinge_reaction of
        ShoeResponse, and optional attributes

    Raises
    ------
    NoAnswer
        if the lining is strained beyond LARGEST_STRAIN
    """
    # Nodes at falling angles are put into the order of growing angles.
    forward = slice(None, None, 1 if theta[-1] > theta[0] else -1)
    theta, pressure = theta[forward], pressure[forward]
    if peak is None:
        zone = edge_zone(shoe, scale_factor)
        if located:
            peak = InnerPart(theta, order, zone).peak(pressure)
        else:
            peak = nodal_peak(theta, pressure, edge_left_out(theta, pressure, order, zone))
    arcs = contact_arcs(theta, pressure, order, located=located)
    # Normal forces are summed by their sizes: in their resultant opposite sides would cancel.
    force = shoe.lining.width * scale_factor * integrate(theta, pressure, order)
    check_strain(shoe, scale_factor, force, sum(end - start for start, end in arcs))
    if surface is not None:
        surface = surface._replace(pressure=surface.pressure[forward])
    return ShoeResponse(
        name=shoe.name,
        peak_pressure=peak,
        contact_arcs=arcs,
        theta=theta,
        pressure=pressure,
        order=order,
        surface=surface,
        **results,
    )


def edge_zone(shoe: Shoe, scale_factor: float) -> float:
    """The zone at each end of a lining in which a sharp edge makes the pressure steep.

    The zone is half the lining's thickness, or a quarter of the length of a short lining. It counts
    in the coordinate of a surface with the scale factor [m/rad, on a plane 1].
    """
    zone = (shoe.lining.thickness or 0.0) / (2 * scale_factor)
    length = shoe.lining.end - shoe.lining.start
    return zone if 2 * zone < length else 0.25 * length


def own_edge_zone(shoe: Shoe, size: float) -> float:
    """The `edge_zone` of a lining in phi of the shoe's own frame, in a brake of a size [m]."""
    unit = shoe.frame.unit
    return edge_zone(shoe, size / unit) / unit


def singular_zone(length: float, unit: float = 1.0) -> float:
    """The smaller of EDGE_ZONE and a quarter of a lining's length.

    The zone and the length count in a coordinate that grows by `unit` per radian of phi.
    """
    return min(unit * EDGE_ZONE, 0.25 * length)


class PeakPlace(NamedTuple):
    """The place of a peak pressure, and the zone in which the peak was not sought.

    Attributes
    ----------
    at : angle [rad] of the peak, on a plane its place x [m]
    zone : zone [rad or m] at each of the lining's ends that was left out
    """

    at: float
    zone: float


def peak_place(brake: Brake, index: int, response: ShoeResponse) -> PeakPlace | None:
    """The place of the peak pressure of shoe `index`, to CURVE_SPACING; None without contact."""
    if not response.contact_arcs or not response.peak_pressure > 0:
        return None
    theta, pressure = response.curve()
    zone = edge_zone(brake.shoes[index], brake.scale_factor)
    inside = _is_outside_zones(theta, zone)
    # The response does not tell whether its peak leaves out the zones at the ends. The curve's
    # largest value outside the zones, or its largest value of all, comes nearest to the peak.
    apart = abs(pressure[inside].max(initial=0.0) - response.peak_pressure)
    if abs(pressure.max() - response.peak_pressure) <= apart:
        inside, zone = np.ones(len(theta), dtype=bool), 0.0
    highest = pressure[inside].argmax()
    return PeakPlace(float(theta[inside][highest]), zone)


def nodal_peak(theta: Floats, pressure: Floats, zone: float) -> float:
    """The largest nodal pressure [Pa] more than `zone` [rad] away from the lining's ends.

    All nodes count if no node outside the zones presses.
    """
    inside = _is_outside_zones(theta, zone)
    return float(pressure[inside if pressure[inside].any() else slice(None)].max())


def _is_outside_zones(theta: Floats, zone: float) -> Bools:
    """Whether angles (n,) are more than a zone away from the first angle and the last angle."""
    return np.asarray((theta > theta[0] + zone) & (theta < theta[-1] - zone))
