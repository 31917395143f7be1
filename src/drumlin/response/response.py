"""The classes of the result of every model: Response for a brake, ShoeResponse for a shoe."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import (
    BaseClassWithArrayEquality,
    Bools,
    Floats,
    text_of_fields_with_arrays_by_shape,
)
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.texts import did_you_mean_hint
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.one_sided import OneSidedSupportForce
from drumlin.brake.surface import FRICTION_SURFACE_OF_DRUM, FrictionSurface
from drumlin.response.limits import require_lining_strain_below_limit
from drumlin.response.resultants import (
    BeginAndEndOfEachSlot,
    LiningWithoutEndZones,
    PressureAndFrictionResultant,
    arrange_nodal_values_by_piece,
    contact_arcs_from_nodal_pressures,
    integral_of_piecewise_polynomial,
    polynomial_nodes_on_linings_and_slots,
    slots_from_nodes_and_lining_mask,
)
from drumlin.response.self_locking import SelfLocking, SelfLockingFactor
from drumlin.response.show import (
    html_table_of_response,
    plot_pressure_of_each_shoe,
    text_of_response,
)

UNCOMPARED_EDGE_ZONE_IN_RADIANS = math.radians(0.2)
"""Length [rad] of the zone at each end of a lining in which pressures are not compared.

The pressure is singular at a sharp elastic edge. The stated error of a pressure therefore holds
outside the zones at the lining's ends.
"""

LARGEST_PRESSURE_CURVE_STEP_IN_RADIANS = math.radians(0.2)
"""Longest step [rad] between two points of a pressure curve that is drawn or written to a file.

With this step the curve of a lining of 100 degrees has 500 points, about as many as a plot can
show. The spacing does not change the answer of a model.
"""

LEAST_ANGLE_FROM_LINING_END_TO_PRESSURE_CURVE_POINT = 1e-9
"""Distance [rad] from an end of the lining up to which a pressure curve has no point but the end.

Angles that differ by less are the same number in a table. Towards a corner of the lining that
presses on the drum, the polynomial pieces of the pressure are as short as 1e-12 rad. A curve leaves
out the ends of the pieces that lie nearer to the lining's end. These pieces bear 1e-5 of the force
on the corner.
"""

LARGEST_NEUTRAL_FRICTION_OVER_PRESSURE_WORK = 1e-9
"""Ratio of friction work to pressure work up to which friction is not self-energising.

Both works are done in the same rigid-body motion of the shoe. A ratio below the limit is round-off:
the friction then neither helps nor opposes the actuation.
"""

NEGLIGIBLE_REACTION_OVER_NORMAL_FORCE = 1e-6
"""Fraction of the normal force on a lining below which a support reaction counts as zero."""


@dataclass(frozen=True)
class ForceAndMomentImbalance:
    """The imbalance of a shoe: the sum of its forces and the sum of its moments.

    Both sums vanish in equilibrium. Each sum is divided by the largest force or moment in it.

    Attributes
    ----------
    force : magnitude of the sum of the forces, relative to the largest force
    moment : magnitude of the sum of the moments, relative to the largest moment
    """

    force: float
    moment: float


class BeamAndRingDeflections(NamedTuple):
    """The deflections of a post brake's beam and of its drum's ring, by the foundation model.

    Attributes
    ----------
    x : (m,) [m], places along the beam from the hinge
    w : (m,) [m], displacement of the beam towards the drum at x
    relative : (m,) [m], displacement of the beam from the straight line through its displaced ends
    z : (n,) [m], inward displacement of the ring at the angles `theta` of the shoe's response;
        in a slot between two linings it is interpolated linearly
    """

    x: Floats
    w: Floats
    relative: Floats
    z: Floats


class RelativeChangesOfShoeResults(NamedTuple):
    """Relative changes of a shoe's results by one cause, such as the finite contact penalty.

    Attributes
    ----------
    pressure : change of the pressure in the L2 norm, outside UNCOMPARED_EDGE_ZONE_IN_RADIANS at the
        lining's ends
    torque : change of the torque
    reaction : change of the support reaction
    peak : largest change of the pressure near its peak, relative to the peak pressure
    """

    pressure: float
    torque: float
    reaction: float
    peak: float = 0.0


ZERO_CHANGES_OF_SHOE_RESULTS = RelativeChangesOfShoeResults(0.0, 0.0, 0.0)
"""Relative changes that are all zero, for a shoe whose results have no such cause of change."""


def reference_force_of_reaction_errors(reaction: Floats, normal_force: float) -> float:
    """The force [N] to which errors of a support reaction (2,) [N] are relative.

    It is the size of the reaction, and at least NEGLIGIBLE_REACTION_OVER_NORMAL_FORCE times the
    normal force [N] on the lining. If both are zero, it is 1 N.
    """
    return max(math.hypot(*reaction), NEGLIGIBLE_REACTION_OVER_NORMAL_FORCE * normal_force) or 1.0


class EstimatedErrorOfPlaneStress(NamedTuple):
    """The estimated error of the assumption of plane stress, for shoes of finite width.

    Attributes
    ----------
    brake : relative errors by their keys: "torque" of the brake, "pressure" of the worst shoe (of
        the mean over the width, L2 norm outside the edge zones), and "reaction" of the worst shoe;
        empty if the errors are not known
    shoes : errors "torque", "pressure" and "reaction" of each shoe
    unknown : reason why the errors are not known; empty if they are known
    corrected : whether the response is corrected for the widths, so that the errors are those that
        remain
    """

    brake: Mapping[str, float]
    shoes: tuple[Mapping[str, float], ...] = ()
    unknown: str = ""
    corrected: bool = False

    def as_dict(self) -> dict[str, Any]:
        """The errors of the brake as plain data for JSON.

        The error of the peak pressure is not known, and therefore None. A corrected response has
        the key "corrected".
        """
        if self.unknown:
            return {"unknown": self.unknown}
        corrected = {"corrected": True} if self.corrected else {}
        return {**self.brake, "peak": None, **corrected}


class PressureOverArcAndWidth(NamedTuple):
    """The pressure over the arc and the width of a lining, by a solid model.

    Attributes
    ----------
    z : (m,) [m], growing coordinates across the width, from the mid-plane of the shoe
    pressure : (n, m) [Pa], pressures at the n angles `theta` of the shoe's response and at z; a
        quadratic polynomial in z from z[0] to z[2], from z[2] to z[4], and so on
    widths : (m,) [m], width of the lining that each z stands for: the mean of `pressure` over z
        with these weights is the `pressure` of the shoe's response
    """

    z: Floats
    pressure: Floats
    widths: Floats


@dataclass(frozen=True, eq=False)
class ShoeResponse(BaseClassWithArrayEquality):
    """The forces on one shoe, the pressure on its lining, and its motion, as a model computes them.

    For a shoe on a plane, `theta` and `contact_arcs` are places x [m], and `torque` is 0, because
    the shoe brakes by a force.

    Attributes
    ----------
    name : name of the shoe
    torque : size of the shoe's torque on the drum [N m], which opposes the rotation
    normal_force : size of the vector sum of the normal forces [N]
    self_energising : whether friction helps the actuation
    peak_pressure : largest pressure [Pa]. Elastic models do not count half a lining thickness at
        each end of the lining, where the pressure at a sharp edge grows without bound.
    hinge_reaction : (2,) [N], force of the pin, or of the abutment or guide, on the shoe; of a shoe
        on anchors the sum of the forces in `supports`
    contact_arcs : first and last angle [rad] of each part of the lining in contact
    theta : (n,) [rad], growing angles of the nodes at which the pressure is given. Between the
        nodes the pressure is a piecewise polynomial, whose neighbouring pieces share an end node.
    pressure : (n,) [Pa], pressures at the nodes
    friction_stress : (n,) [Pa], friction stresses at the nodes, if the friction coefficient depends
        on the pressure; otherwise None, and the stress is the coefficient times the pressure
    order : degree of the polynomial pieces
    slots : begin and end of each slot between two linings [rad]. There the pressure is 0, and the
        polynomial pieces beside a slot are PRESSURE_DROP_LENGTH_AT_SLOT long, see
        `resultants.polynomial_nodes_on_linings_and_slots`
    turn : rotation of the shoe about its pin [rad], counter-clockwise positive; None if the model
        does not compute the rotation
    lumped : resultant of the contact, if a law lumps the forces at one point or a model in sectors;
        None if the resultant is the integral of the pressure
    pivot_reaction : (2,) [N], force of the pivot on the shoe; None without a pivot
    reaction_moment : moment [N m] of a guide, or of the forces in `supports`, on the shoe about
        `SupportedShoe.pin`, besides the force at the pin
    supports : forces of the anchors, of the abutment and of the strut on a shoe on anchors
    force : actuation force [N] on the shoe, if a cam or a strut determines it; otherwise None
    motion : rigid-body motion of a shoe without hinge, in the shoe's frame: displacement dx, dy [m]
        of the shoe's reference point `SupportedShoe.pin`, and turn [rad]
    deformation : deflections of beam and ring, by the foundation model only
    surface : pressure over arc and width, by a solid model only; `pressure` and `peak_pressure` are
        then means over the width
    error : estimated relative errors by their keys "pressure" (L2 norm outside the edge zones),
        "torque", "peak" and "reaction"; None if nothing was estimated
    softness : relative changes of the results due to the finite contact stiffness (penalty)
    lost : relative changes of the results by round-off when the unknowns inside the bodies are
        eliminated, as far as these changes are known
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
    slots: BeginAndEndOfEachSlot = ()
    friction_stress: Floats | None = None
    turn: float | None = None
    lumped: PressureAndFrictionResultant | None = None
    pivot_reaction: Floats | None = None
    reaction_moment: float = 0.0
    supports: tuple[OneSidedSupportForce, ...] = ()
    force: float | None = None
    motion: tuple[float, float, float] | None = None
    deformation: BeamAndRingDeflections | None = None
    surface: PressureOverArcAndWidth | None = None
    error: Mapping[str, float] | None = None
    softness: RelativeChangesOfShoeResults = ZERO_CHANGES_OF_SHOE_RESULTS
    lost: RelativeChangesOfShoeResults = ZERO_CHANGES_OF_SHOE_RESULTS

    def __repr__(self) -> str:
        """The fields, where an array is shown by its shape alone."""
        return text_of_fields_with_arrays_by_shape(self)

    @property
    def length_of_shortest_lining(self) -> float:
        """Length [rad, on a plane m] of the lining, or of the shortest of several linings."""
        edges = [self.theta[0], *(edge for slot in self.slots for edge in slot), self.theta[-1]]
        return min(float(b - a) for a, b in zip(edges[::2], edges[1::2], strict=True))

    @property
    def nodal_pressures_on_linings(self) -> Floats:
        """The pressures [Pa] at nodes on linings, without the nodes in slots between linings."""
        return self.nodal_values_on_linings(self.pressure)

    def nodal_values_on_linings(self, values: Floats) -> Floats:
        """The values at nodes on linings, selected from the values (n,) at all nodes."""
        on_lining = np.ones(len(self.theta), dtype=bool)
        for start, end in self.slots:
            on_lining &= (self.theta <= start) | (self.theta >= end)
        return values[on_lining]

    def pressure_at(self, theta: Floats) -> Floats:
        """The pressure [Pa] at angles `theta` [rad] of any shape; 0 beyond the lining.

        In each polynomial piece the pressure is Lagrange's interpolation of the nodal values.
        Raises BadInput for an angle more than a turn beyond the lining: it was given in degrees.
        """
        theta = np.asarray(theta, dtype=float)
        self._refuse_coordinates_more_than_turn_beyond_lining(theta)
        ends = self.theta[:: self.order]
        piece = np.clip(np.searchsorted(ends, theta, side="right") - 1, 0, len(ends) - 2)
        x, y = (
            arrange_nodal_values_by_piece(self.theta, self.order),
            arrange_nodal_values_by_piece(self.pressure, self.order),
        )
        # The denominators of Lagrange's polynomials are products of the distances between the nodes
        # of a piece. The distance 0 of a node from itself must not count, and is replaced by 1.
        apart = x[:, :, None] - x[:, None]  # (pieces, nodes, nodes)
        unit = np.eye(self.order + 1)
        factors = (y / (apart + unit).prod(axis=2))[piece]
        # The numerator for a node is the product of the distances of the angle from all other
        # nodes. It is computed as a product over the nodes before the node, times a product over
        # the nodes behind it.
        off = theta[..., None] - x[piece]
        before, behind = np.ones(off.shape), np.ones(off.shape)
        np.cumprod(off[..., :-1], axis=-1, out=before[..., 1:])
        np.cumprod(off[..., :0:-1], axis=-1, out=behind[..., -2::-1])
        value = (factors * before * behind).sum(axis=-1)
        on_lining = (theta >= self.theta[0]) & (theta <= self.theta[-1])
        return np.where(on_lining, value, 0.0)

    def _refuse_coordinates_more_than_turn_beyond_lining(self, theta: Floats) -> None:
        """Raise BadInput if one of the angles `theta` [rad] is more than a turn beyond the lining.

        On a plane the same bound holds for places in metres, as a shoe does not tell its surface.
        """
        start, end = float(self.theta[0]), float(self.theta[-1])
        beyond = theta[(theta < start - 2 * math.pi) | (theta > end + 2 * math.pi)]
        if beyond.size:
            raise BadInput(
                f"theta = {beyond[0]:g}: is far beyond the lining, which lies from {start:.4g} to "
                f"{end:.4g}; angles are in rad, as numpy.radians makes them from degrees, and "
                "places on a plane in m"
            )

    def curve(self) -> tuple[Floats, Floats]:
        """Points of the pressure curve for plots and tables.

        The result is the angles (m,) [rad] and the pressures (m,) [Pa] of the points. No pressure
        of the curve is negative. If the polynomial pieces have a degree up to 2, the points are the
        nodes. A piece of a higher degree is divided into an even number of equal steps. The steps
        are so short that straight lines or parabolas through the points follow the polynomial.
        """
        if self.order <= 2:
            return self.theta, self.pressure
        if self.slots:
            return self._pressure_curve_with_slots()
        return self._pressure_curve_of_one_lining(self.theta)

    def _pressure_curve_with_slots(self) -> tuple[Floats, Floats]:
        """Points of the pressure curve on several linings; the pressure is 0 in the slots.

        Beside each slot there is a point at LEAST_ANGLE_FROM_LINING_END_TO_PRESSURE_CURVE_POINT
        from the lining's edge.
        """
        edges = [self.theta[0], *(edge for slot in self.slots for edge in slot), self.theta[-1]]
        theta, pressure = [], []
        for k, (start, end) in enumerate(zip(edges[::2], edges[1::2], strict=True)):
            if k > 0:
                slot = [
                    edges[2 * k - 1] + LEAST_ANGLE_FROM_LINING_END_TO_PRESSURE_CURVE_POINT,
                    start - LEAST_ANGLE_FROM_LINING_END_TO_PRESSURE_CURVE_POINT,
                ]
                theta.append(np.array(slot))
                pressure.append(np.zeros(2))
            nodes = self.theta[(self.theta >= start) & (self.theta <= end)]
            points, values = self._pressure_curve_of_one_lining(nodes)
            theta.append(points)
            pressure.append(values)
        return np.concatenate(theta), np.concatenate(pressure)

    def _pressure_curve_of_one_lining(self, nodes: Floats) -> tuple[Floats, Floats]:
        """Points of the pressure curve on the lining with the given nodes (n,) [rad]."""
        # Ends of pieces within LEAST_ANGLE_FROM_LINING_END_TO_PRESSURE_CURVE_POINT of the lining's
        # ends are left out.
        ends = nodes[:: self.order]
        apart = (
            np.minimum(ends - ends[0], ends[-1] - ends)
            > LEAST_ANGLE_FROM_LINING_END_TO_PRESSURE_CURVE_POINT
        )
        ends = np.concatenate([ends[:1], ends[apart], ends[-1:]])
        half_steps = np.ceil(np.diff(ends) / (2 * LARGEST_PRESSURE_CURVE_STEP_IN_RADIANS))
        counts = 2 * np.maximum(self.order, half_steps).astype(int)
        pieces = []
        for i, count in enumerate(counts):
            pieces.append(np.linspace(ends[i], ends[i + 1], count + 1)[:-1])
        theta = np.append(np.concatenate(pieces), ends[-1])
        # A polynomial may dip below zero between its nodes, where no pressure acts.
        return theta, np.maximum(self.pressure_at(theta), 0.0)

    def pressure_curve_at_distance_from_mid_plane(self, number: int) -> tuple[Floats, Floats]:
        """Points of the pressure curve at one distance from the mid-plane, by a solid model.

        `number` is the index of the distance in the array z of `surface`. The angles (m,) [rad] are
        those that `curve` returns.
        """
        # Only a shoe in contact, solved by a solid model, has `surface`.
        assert self.surface is not None
        return replace(self, pressure=self.surface.pressure[:, number]).curve()

    def as_dict(self) -> dict[str, Any]:
        """The response of the shoe as plain data for JSON, in the units of the attributes.

        The angles and pressures are the points that `curve` returns, and the rows of the pressure
        over the width belong to these angles.
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
        # Results that this shoe or its model does not have get no key.
        if self.friction_stress is not None:
            stress = replace(self, pressure=self.friction_stress).curve()[1]
            data["friction_stress"] = stress.tolist()
        if self.error is not None:
            data["error"] = dict(self.error)
        if self.force is not None:
            data["force"] = self.force
        if self.reaction_moment:
            data["reaction_moment"] = self.reaction_moment
        if self.supports:
            data["supports"] = [
                {"name": support.name, "force": list(map(float, support.push.force_vector))}
                for support in self.supports
            ]
        if self.pivot_reaction is not None:
            data["pivot_reaction"] = list(map(float, self.pivot_reaction))
        if self.deformation is not None:
            data["deformation"] = _arrays_as_lists(self.deformation)
        if self.surface is not None:
            columns = range(len(self.surface.z))
            rows = np.array(
                [self.pressure_curve_at_distance_from_mid_plane(k)[1] for k in columns]
            ).T
            data["surface"] = _arrays_as_lists(self.surface._replace(pressure=rows))
        return data


def notes_on_forces_of_one_sided_supports(shoes: Sequence[ShoeResponse]) -> tuple[str, ...]:
    """A note, as a tuple of one line, on the force that each one-sided support bears.

    The tuple is empty if the shoes have no one-sided supports.
    """
    # A strut appears in the results of both of its shoes, but the dictionary names it once.
    forces = {support.name: support.push.force for shoe in shoes for support in shoe.supports}
    if not forces:
        return ()
    parts = [
        f"{name} bears {force:.6g} N" if force else f"{name} does not bear"
        for name, force in forces.items()
    ]
    return (f"supports: {'; '.join(parts)}",)


def notes_on_struts_of_trailing_shoes(brake: Brake, shoes: Sequence[ShoeResponse]) -> list[str]:
    """A note for each strut whose force is small because friction opposes it on both shoes.

    The note stands where neither shoe is self-energising, and the strut pushes the second shoe by
    less than the force on the first one. `shoes` are the results of all shoes.
    """
    found = {shoe.name: shoe for shoe in shoes}
    notes = []
    for link in brake.links:
        source, to = found[link.source], found[link.to]
        given, passed_on = source.force, to.force
        if given is None or passed_on is None or source.self_energising or to.self_energising:
            continue
        if brake.friction > 0 and passed_on < given:
            notes.append(
                f"note: friction opposes shoe {link.source!r} and shoe {link.to!r} in this sense "
                f"of the motion: their strut passes on {passed_on:.6g} N of {given:.6g} N; in the "
                "other sense friction helps"
            )
    return notes


def _arrays_as_lists(
    arrays: BeamAndRingDeflections | PressureOverArcAndWidth,
) -> dict[str, list[Any]]:
    """The arrays of a result as lists by their names, for JSON."""
    return {key: values.tolist() for key, values in arrays._asdict().items()}


class FiguresOfMeritOnDrum(NamedTuple):
    """The figures of merit of a shoe on a drum, such as its shoe factor.

    A figure is None if its definition divides by 0. T is the torque of the shoe, F its actuation
    force, M the moment of F about the hinge, and R the radius of the drum with the centre O.

    Attributes
    ----------
    resultant_angle : angle [rad] of the normal pressure's resultant at O, counted with the full
        turns of the lining's angles
    friction_radius : psi, apparent radius of the friction, divided by R
    shoe_factor : T/(F R)
    mechanical_advantage : eta = T/M = 1/(m - double_delta n)
    m : moment of the normal pressure about the hinge, divided by T
    n : moment of the friction about the hinge, divided by the moment of the friction about O
    double_delta : the sign dD of the UWA notes, +1 or -1, before n in the formula of eta
    sensitivity_at_fixed_shape : sensitivity (mu/eta) d eta/d mu = m eta, if the shape of the
        pressure did not change with mu
    """

    resultant_angle: float | None
    friction_radius: float | None
    shoe_factor: float | None
    mechanical_advantage: float | None
    m: float | None
    n: float | None
    double_delta: int
    sensitivity_at_fixed_shape: float | None

    def torque_or_braking_force_of_shoe(self, shoe: ShoeResponse) -> float:
        """The effect of a shoe on the drum, which is its torque [N m]."""
        return shoe.torque


class FiguresOfMeritOnPlane(NamedTuple):
    """The figures of merit of a shoe on a plane.

    Attributes
    ----------
    braking_force : force of the shoe against the motion [N]
    braking_force_over_moment : braking force, divided by the moment of the actuation [1/m]
    sensitivity_at_fixed_shape : relative change of the braking force per relative change of mu, if
        the shape of the pressure did not change with mu
    """

    braking_force: float
    braking_force_over_moment: float | None
    sensitivity_at_fixed_shape: float | None

    def torque_or_braking_force_of_shoe(self, shoe: ShoeResponse) -> float:
        """The effect of a shoe on the plane, which is its braking force [N]."""
        return self.braking_force


class ShoeResponsesByNameOrIndex(tuple[ShoeResponse, ...]):
    """The responses of shoes: a tuple whose entries are also found by the name of the shoe.

    `shoes["left"]` is the response of the shoe named "left".
    """

    __slots__ = ()

    def __getitem__(self, key: Any) -> Any:
        """The response at an index or of a shoe's name, or the responses of a slice."""
        if not isinstance(key, str):
            return super().__getitem__(key)
        names = [shoe.name for shoe in self]
        if key not in names:
            hint = did_you_mean_hint(key, names)
            raise BadInput(f"shoe = {key!r}: no such shoe{hint}; allowed: {', '.join(names)}")
        return super().__getitem__(names.index(key))


@dataclass(frozen=True, repr=False, eq=False)
class Response(BaseClassWithArrayEquality):
    """The answer of a model for a brake: torque, pressures, reactions and contact of its shoes.

    Two responses are equal if everything but their times is equal.

    Attributes
    ----------
    model : name of the model
    shoes : response of each shoe, found by index or by name: `shoes[0]` or `shoes["left"]`. The
        tuple that is given becomes a `ShoeResponsesByNameOrIndex`
    balance : largest imbalance of forces and of moments among the shoes
    converged : whether the iterations of the model have converged
    iterations : number of iterations of the model
    seconds : time [s] of each phase of the solve, by the name of the phase
    left_out : effects that the model neglects, a line of text for each
    notes : lines of text for the reader, such as warnings
    merits : figures of merit of each shoe; empty until `response_with_figures_of_merit` adds them
    bearing_load : (2,) [N], force of all shoes on the drum, which the drum's bearings carry
    error : estimated relative errors of the elements by their keys "torque" (of the brake),
        "pressure" (L2 norm outside the edge zones), "peak" (of the peak pressure) and "reaction",
        all but that of the torque are of the worst shoe; None if nothing was estimated
    surface : friction surface; always FRICTION_SURFACE_OF_DRUM until
        `response_with_figures_of_merit` sets drum or plane
    plane_stress_error : estimated error of the assumption of plane stress; None if it was not asked
        for
    self_locking : the friction of the brake and the friction coefficients at which the brake locks
        itself; None if they were not asked for
    spring_pulls : pull [N] of each spring of the brake; empty if all springs pull with their
        preloads
    """

    model: str
    shoes: tuple[ShoeResponse, ...]
    balance: ForceAndMomentImbalance
    converged: bool = True
    iterations: int = 0
    seconds: Mapping[str, float] = field(default_factory=dict, compare=False)
    left_out: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    merits: tuple[FiguresOfMeritOnDrum | FiguresOfMeritOnPlane, ...] = ()
    bearing_load: Floats | None = None
    error: Mapping[str, float] | None = None
    surface: FrictionSurface = FRICTION_SURFACE_OF_DRUM
    plane_stress_error: EstimatedErrorOfPlaneStress | None = None
    self_locking: SelfLocking | SelfLockingFactor | None = None
    spring_pulls: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        """Let shoes be found by name. Raise NoAnswer for a result that is infinite or no number."""
        object.__setattr__(self, "shoes", ShoeResponsesByNameOrIndex(self.shoes))
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
        """The effect of each shoe: a torque [N m], or on a plane a braking force [N]."""
        effects = [shoe.torque for shoe in self.shoes]
        for i, merit in enumerate(self.merits):
            effects[i] = merit.torque_or_braking_force_of_shoe(self.shoes[i])
        return effects

    @property
    def effect(self) -> float:
        """The effect of the brake: its torque [N m], on a plane its braking force [N]."""
        return math.fsum(self.effects)

    def __repr__(self) -> str:
        """The response as a table of text."""
        return text_of_response(self)

    def _repr_html_(self) -> str:
        """The response as an HTML table, which notebooks display."""
        return html_table_of_response(self)

    def plot(self, axes: Any = None) -> Any:
        """Draw the pressure of every shoe, in MPa over degrees, or over mm on a plane.

        The curves are drawn into the given matplotlib `axes`, or into new axes if it is None. The
        method returns the axes. Raises BadInput for a value that is no axes of matplotlib.
        """
        return plot_pressure_of_each_shoe(self, axes)

    def as_dict(self) -> dict[str, Any]:
        """The response as plain data for JSON, in N m, N, Pa, rad and s."""
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
        if self.self_locking is not None:
            data["self_locking"] = self.self_locking.as_dict()
        if self.plane_stress_error is not None:
            data["plane_stress_error"] = self.plane_stress_error.as_dict()
            for shoe, own in zip(shoes, self.plane_stress_error.shoes, strict=False):
                shoe["plane_stress_error"] = dict(own)
        return data


def response_of_shoe_without_contact(shoe: Shoe, hinge_reaction: Floats) -> ShoeResponse:
    """The response of a shoe that does not touch the drum: torque and pressure are zero.

    `hinge_reaction` (2,) [N] is the force of the support, which balances the actuation.
    """
    theta, on_lining = polynomial_nodes_on_linings_and_slots(
        [np.linspace(*ends, 3) for ends in shoe.lining.arcs], 2
    )
    return ShoeResponse(
        name=shoe.name,
        torque=0.0,
        normal_force=0.0,
        self_energising=False,
        peak_pressure=0.0,
        hinge_reaction=hinge_reaction,
        contact_arcs=(),
        theta=theta,
        pressure=np.zeros(len(theta)),
        slots=slots_from_nodes_and_lining_mask(theta, on_lining),
        pivot_reaction=np.zeros(2) if shoe.pivot else None,
    )


def response_of_pressed_elastic_shoe(
    shoe: Shoe,
    length_per_surface_coordinate: float,
    theta: Floats,
    pressure: Floats,
    *,
    order: int,
    located: bool = True,
    on_lining: Bools | None = None,
    peak: float | None = None,
    surface: PressureOverArcAndWidth | None = None,
    friction_stress: Floats | None = None,
    **results: Any,
) -> ShoeResponse:
    """The response of a shoe with an elastic lining that is in contact.

    The function computes the peak pressure and the arcs in contact from the nodal pressures.

    Parameters
    ----------
    shoe : the shoe
    length_per_surface_coordinate : length per unit of the surface's coordinate [m/rad, on a plane
        1]
    theta : (n,) [rad], growing or falling angles of the nodes
    pressure : (n,) [Pa], pressures at the nodes
    order : degree of the polynomial pieces of the pressure
    located : whether to locate the ends of the contact and the peak between the nodes; otherwise
        they are at nodes
    on_lining : (n,) mask of the nodes on linings; None if no node lies in a slot between linings
    peak : peak pressure [Pa]; None if it is to be found from the nodal pressures
    surface : pressure over the width, whose rows belong to the angles `theta`
    friction_stress : (n,) [Pa], friction stresses at the nodes; see ShoeResponse
    results : values of the attributes torque, normal_force, self_energising and hinge_reaction of
        ShoeResponse, and of optional attributes

    Raises
    ------
    NoAnswer
        if the lining is strained beyond LARGEST_ACCEPTED_LINING_STRAIN
    """
    # If the angles of the nodes fall, the nodes are put into reverse order.
    forward = slice(None, None, 1 if theta[-1] > theta[0] else -1)
    theta, pressure = theta[forward], pressure[forward]
    slots = () if on_lining is None else slots_from_nodes_and_lining_mask(theta, on_lining[forward])
    if peak is None:
        zone = length_of_edge_zone_left_out_of_peak_search(shoe, length_per_surface_coordinate)
        inner = LiningWithoutEndZones(theta, order, zone, slots)
        peak = _peak_pressure_outside_edge_zones(inner, pressure, located=located)
    arcs = contact_arcs_from_nodal_pressures(theta, pressure, order, located=located)
    # The force is the integral of the pressure without directions: in a vector sum, forces on
    # opposite sides of a long arc would cancel.
    force = (
        shoe.lining.width
        * length_per_surface_coordinate
        * integral_of_piecewise_polynomial(theta, pressure, order)
    )
    require_lining_strain_below_limit(
        shoe, length_per_surface_coordinate, force, sum(end - start for start, end in arcs)
    )
    if surface is not None:
        surface = surface._replace(pressure=surface.pressure[forward])
    return ShoeResponse(
        name=shoe.name,
        peak_pressure=peak,
        contact_arcs=arcs,
        theta=theta,
        pressure=pressure,
        order=order,
        slots=slots,
        surface=surface,
        friction_stress=None if friction_stress is None else friction_stress[forward],
        **results,
    )


def _peak_pressure_outside_edge_zones(
    inner: LiningWithoutEndZones, pressure: Floats, *, located: bool
) -> float:
    """The peak pressure [Pa] of a lining outside the edge zones at its ends.

    Parameters
    ----------
    inner : the part of the lining outside the edge zones
    pressure : (n,) pressures at the nodes [Pa]
    located : whether to locate the peak between the nodes; otherwise it is at a node
    """
    if located:
        return inner.peak_pressure_outside_end_zones(pressure)
    counts = inner.fraction_of_integral_outside_end_zones(pressure) > 0.5
    return largest_nodal_pressure_outside_end_zones(
        inner.theta, pressure, inner.zone if counts else 0.0, inner.slots
    )


def length_of_edge_zone_left_out_of_peak_search(
    shoe: Shoe, length_per_surface_coordinate: float
) -> float:
    """The length of the zone at each end of a lining in which the peak pressure is not sought.

    In this zone a sharp edge makes the pressure steep. The zone is half a lining thickness long, or
    a quarter of the lining's length if the lining is short. Of several linings of a shoe the
    shortest counts. The result is in rad, on a plane in m. `length_per_surface_coordinate` is the
    drum's radius [m/rad], on a plane 1.
    """
    zone = (shoe.lining.thickness or 0.0) / (2 * length_per_surface_coordinate)
    length = shoe.lining.length_of_shortest_lining
    return zone if 2 * zone < length else 0.25 * length


def angle_of_edge_zone_left_out_of_peak_search(shoe: Shoe, size: float) -> float:
    """The length of the end zone without peak search, as an angle phi [rad] in the shoe's frame.

    In this zone at each end of the lining the peak pressure is not sought, see
    `length_of_edge_zone_left_out_of_peak_search`. `size` [m] is the size of the brake, on a drum
    its radius.
    """
    unit = shoe.frame.surface_coordinate_per_phi
    return length_of_edge_zone_left_out_of_peak_search(shoe, size / unit) / unit


def length_of_uncompared_edge_zone(length: float, unit: float = 1.0) -> float:
    """The length of the zone at each end of a lining in which pressures are not compared.

    It is UNCOMPARED_EDGE_ZONE_IN_RADIANS, or a quarter of the lining's `length` if that is shorter.
    Both lengths are in a coordinate that grows by `unit` per radian.
    """
    return min(unit * UNCOMPARED_EDGE_ZONE_IN_RADIANS, 0.25 * length)


class PeakPressurePlace(NamedTuple):
    """The place of a shoe's peak pressure, and the end zones in which the peak was not sought.

    Attributes
    ----------
    at : angle [rad] of the peak, on a plane its place x [m]
    zone : length [rad, on a plane m] of the zone at each end of the lining in which the peak was
        not sought
    """

    at: float
    zone: float


def place_of_peak_pressure(
    brake: Brake, index: int, response: ShoeResponse
) -> PeakPressurePlace | None:
    """The place of the peak pressure of shoe `index`; None if the shoe does not touch.

    The place is one of the points of the pressure curve, at most
    LARGEST_PRESSURE_CURVE_STEP_IN_RADIANS apart.
    """
    if not response.contact_arcs or not response.peak_pressure > 0:
        return None
    theta, pressure = response.curve()
    zone = length_of_edge_zone_left_out_of_peak_search(
        brake.shoes[index], brake.length_per_surface_coordinate
    )
    inside = which_angles_are_outside_end_zones(theta, theta[0], theta[-1], zone, response.slots)
    # A response does not tell whether its peak pressure was sought on the whole lining or outside
    # the end zones only. The largest value of the curve is found for both cases, and the case whose
    # value is nearer to the peak pressure counts.
    apart = abs(pressure[inside].max(initial=0.0) - response.peak_pressure)
    if abs(pressure.max() - response.peak_pressure) <= apart:
        inside, zone = np.ones(len(theta), dtype=bool), 0.0
    highest = pressure[inside].argmax()
    return PeakPressurePlace(float(theta[inside][highest]), zone)


def largest_nodal_pressure_outside_end_zones(
    theta: Floats, pressure: Floats, zone: float, slots: BeginAndEndOfEachSlot = ()
) -> float:
    """The largest nodal pressure [Pa] at nodes farther than `zone` [rad] from the lining's ends.

    If the pressure is zero at all these nodes, the largest of all nodal pressures is returned. With
    `slots` between several linings, each lining has a zone at both of its ends.
    """
    inside = which_angles_are_outside_end_zones(theta, theta[0], theta[-1], zone, slots)
    return float(pressure[inside if pressure[inside].any() else slice(None)].max())


def which_angles_are_outside_end_zones(
    theta: Floats, first: float, last: float, zone: float, slots: BeginAndEndOfEachSlot = ()
) -> Bools:
    """Whether angles are on a lining, and farther than a zone from its ends; a mask (n,).

    Parameters
    ----------
    theta : angles (n,) [rad]
    first, last : angles of the ends of the lining, or of all linings together [rad]
    zone : length of the zone [rad]
    slots : first and last angle of each slot between two linings [rad]
    """
    inside = (theta > first + zone) & (theta < last - zone)
    for start, end in slots:
        inside &= (theta < start - zone) | (theta > end + zone)
    return np.asarray(inside)
