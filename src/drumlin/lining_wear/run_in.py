"""Run a brake in: wear turns the elastic brake's pressure into the pressure of the rigid-shoe law.

Whatever the elasticity of the brake, wear ends when every point of the lining wears as fast as the
rigid-body motion of the shoe brings the point nearer to the drum. The pressure at a point is then
proportional to v^(1/m), where v is the approach of the point to the drum per sliding distance, and
m the exponent of the wear law. For m = 1 the pressure is proportional to sin(phi) on a hinged shoe,
with phi from the hinge, and to cos(phi) on a guided shoe, with phi from the direction of the guide.
On a shoe with a pivot on a lever it is A cos(phi) + B sin(phi). The elasticity then influences only
the worn shape of the lining. `brake_with_worn_linings` returns a brake whose linings have this
shape as their clearance, which the models with elastic linings can solve.
"""

import math
from collections.abc import Callable, Sequence
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.base.texts import error_text_in_percent, number_as_text
from drumlin.brake.brake import Brake
from drumlin.brake.friction import first_key_of_pressure_dependent_friction
from drumlin.brake.further_loads import first_key_of_loads_besides_actuation
from drumlin.brake.one_sided import (
    LARGEST_ROUND_OFF_CONTACT_FORCE,
    note_on_shoe_held_off_by_its_supports,
)
from drumlin.brake.units import length_as_text_in_mm
from drumlin.laws import rigid
from drumlin.laws.shoe_contact import RigidShoeContact
from drumlin.lining_wear import archard
from drumlin.lining_wear.archard import WearLaw, WearState, solve_steady_wear
from drumlin.lining_wear.linings import WearSetup, WornLining, brake_with_added_worn_depths
from drumlin.response.response import (
    largest_nodal_pressure_outside_end_zones,
    length_of_edge_zone_left_out_of_peak_search,
)
from drumlin.response.resultants import polynomial_values_at_gauss_points

DEFAULT_WEAR_COEFFICIENT = 1e-14
"""Wear coefficient k [1/Pa] if the user gives none.

The value is 1e-5 mm^3/(N m), the order of magnitude of the wear of organic linings.

Sliding distances in units of 1/(k E/t), with the lining's stiffness E/t, do not depend on k, nor do
fractions of a lining's life."""

WORN_OUT_FRACTION_OF_LINING_THICKNESS = 0.8
"""Fraction of a lining's thickness that is worn off when the lining counts as worn out.

A judgement."""

END_OF_WEAR_TOLERANCE = 1e-3
"""Relative difference of pressure and torque from their final values below which a run ends.

It equals the largest error of a wear step, `archard.DEFAULT_PRESSURE_ERROR_OF_WEAR_STEP`."""


class FinalWearPressureAndTorque(NamedTuple):
    """The final pressure and torque, to which wear tends.

    Attributes
    ----------
    pressure : (n,) [Pa], pressures at all contact unknowns of the WearSetup
    torque : torque of all linings [N m]
    """

    pressure: Floats
    torque: float


def final_wear_pressure_and_torque_by_rigid_shoe_law(
    setup: WearSetup, law: WearLaw | None = None, torque: float | None = None
) -> FinalWearPressureAndTorque:
    """The pressure and the torque to which wear tends as the mesh is refined.

    For finite elements and the exponent 1 of the wear law, the rigid-shoe law gives the pressure,
    which is constant across the width. For the foundation model, for other exponents, and for
    friction that depends on the pressure,
    `final_pressure_and_torque_of_wear_on_mesh` gives the result.

    Parameters
    ----------
    setup : the brake with the contact problems of its linings
    law : the wear law; None for Archard's law
    torque : torque [N m] that the actuation is adjusted to keep; None for a constant actuation

    Raises
    ------
    NoAnswer
        if a rigid shoe has no equilibrium
    """
    # The rigid-shoe law holds only if wear is proportional to the pressure and friction constant.
    is_archard = law is None or law.exponent == 1
    if setup.model == "foundation" or not is_archard or setup.is_friction_dependent_on_pressure:
        return final_pressure_and_torque_of_wear_on_mesh(setup, law, torque)
    forced = rigid.brake_with_cam_and_strut_forces_by_rigid_law(setup.brake)
    pressures = []
    total: float = 0
    for surface in setup.surfaces:
        pressed = rigid.find_contact_of_rigid_shoe(forced, forced.shoes[surface.shoe])
        even = rigid.pressures_of_rigid_shoe_at_places(pressed, surface.theta)
        pressures.append(np.repeat(even, len(surface.across)))
        if pressed:
            total += _lining_torque_by_rigid_shoe_law(setup, surface, pressed)
    return _final_pressure_scaled_to_held_torque(np.concatenate(pressures), total, torque)


def final_pressure_and_torque_of_wear_on_mesh(
    setup: WearSetup, law: WearLaw | None = None, torque: float | None = None
) -> FinalWearPressureAndTorque:
    """The final pressure and torque of wear on the finite elements, or the sectors, of a setup.

    If by the rigid-shoe law only a part of a lining is in contact, this part usually ends inside an
    element. The pressure on the mesh then differs from the law.

    Parameters
    ----------
    setup : the brake with the contact problems of its linings
    law : the wear law; None for Archard's law
    torque : torque [N m] that the actuation is adjusted to keep; None for a constant actuation

    Raises
    ------
    NoAnswer
        if a rigid shoe has no equilibrium
    """
    law = law or WearLaw(DEFAULT_WEAR_COEFFICIENT)
    pressures = []
    total: float = 0
    for interface in setup.interfaces:
        p = interface.pressure * solve_steady_wear(interface, law).contact.p
        pressures.append(p)
        total += float(interface.torque @ interface.quantities_per_torque_arm(p))
    return _final_pressure_scaled_to_held_torque(np.concatenate(pressures), total, torque)


def _final_pressure_scaled_to_held_torque(
    p: Floats, total: float, torque: float | None
) -> FinalWearPressureAndTorque:
    """The final pressure and torque of wear, scaled to a torque that the actuation must keep.

    Parameters
    ----------
    p : (n,) [Pa], pressures under the actuation of the brake file
    total : torque [N m] of the pressures p
    torque : torque [N m] that the actuation is adjusted to keep; None for a constant actuation
    """
    return (
        FinalWearPressureAndTorque(p, total)
        if torque is None
        else FinalWearPressureAndTorque(p * torque / total, torque)
    )


def _lining_torque_by_rigid_shoe_law(
    setup: WearSetup, surface: WornLining, pressed: RigidShoeContact
) -> float:
    """The torque [N m] of one lining by the rigid-shoe law; on a plane the braking force [N].

    Parameters
    ----------
    setup : the brake with the contact problems of its linings
    surface : the lining
    pressed : contact of the rigid shoe
    """
    brake, shoe = setup.brake, setup.brake.shoes[surface.shoe]
    lining, mu = shoe.lining, brake.friction_coefficient_of_shoe_at_zero_pressure(shoe)
    start, end = lining.arcs[surface.lining]
    own = tuple(arc for arc in pressed.arcs if start <= arc[0] and arc[1] <= end)
    theta = rigid.node_places_of_pressure_along_lining(
        (start, end), own, rigid.NUMBER_OF_PRESSURE_NODES_ON_DRUM_LINING - 1
    )
    # The law's pressure is interpolated by parabolas between nodes. The Gauss rule integrates these
    # parabolas exactly.
    _, p, weight = polynomial_values_at_gauss_points(
        theta, rigid.pressures_of_rigid_shoe_at_places(pressed, theta), 2
    )
    return float(mu * lining.width * brake.length_per_surface_coordinate**2 * (p * weight).sum())


class DifferenceFromEndOfWear(NamedTuple):
    """The relative difference between a state of worn linings and the end of wear.

    Attributes
    ----------
    pressure : L2 norm of the difference in pressure, divided by the L2 norm of the final pressure,
        for the lining where this ratio is largest; one element at each end of a lining is left out
    torque : difference in torque divided by the final torque, positive if the state has more torque
    """

    pressure: float
    torque: float


def relative_differences_from_end_of_wear(
    setup: WearSetup, state: WearState, goal: FinalWearPressureAndTorque
) -> DifferenceFromEndOfWear:
    """The relative differences in pressure and torque of a state from their final values `goal`."""
    return DifferenceFromEndOfWear(
        pressure=largest_relative_pressure_difference_of_linings(
            setup, state.pressure, goal.pressure
        ),
        torque=state.torque / goal.torque - 1 if goal.torque else 0.0,
    )


def largest_relative_pressure_difference_of_linings(
    setup: WearSetup, p: Floats, goal: Floats
) -> float:
    """The relative L2 difference of pressures p (n,) from `goal` (n,), the largest of all linings.

    The difference is computed for each lining, without one element at each end.
    """
    distances = []
    for surface in setup.surfaces:
        size = _norm_over_lining_face_without_end_elements(surface, goal)
        # The difference of a lining is relative to the norm of `goal` on this lining. A lining that
        # has no contact when worn in, so that `goal` is zero on it, is skipped.
        if size:
            distances.append(_norm_over_lining_face_without_end_elements(surface, p - goal) / size)
    return max(distances, default=0.0)


def _norm_over_lining_face_without_end_elements(surface: WornLining, values: Floats) -> float:
    """The L2 norm of a lining's values over theta; their squares are averaged over the width.

    One element at each end of the lining is left out. `values` holds one value for each contact
    unknown of all linings.
    """
    rows = surface.lining_values_over_arc_and_width(values).T
    norms = [norm_along_lining_without_end_elements(surface, row) for row in rows]
    return math.sqrt(float(np.square(norms) @ surface.shares))


def norm_along_lining_without_end_elements(surface: WornLining, values: Floats) -> float:
    """The L2 norm over theta of values (n,) along a lining, without one element at each end."""
    inner = slice(surface.order, len(values) - surface.order)
    _, at_points, weight = polynomial_values_at_gauss_points(
        surface.contact_angles_in_growing_order[inner], values[inner], surface.order
    )
    return math.sqrt(float((at_points**2 * weight).sum()))


def make_function_that_tests_for_end_of_wear(
    setup: WearSetup, goal: FinalWearPressureAndTorque, within: float = END_OF_WEAR_TOLERANCE
) -> Callable[[WearState], bool]:
    """Make a function that tells whether a state of worn linings has reached the end of wear.

    Parameters
    ----------
    setup : the brake with the contact problems of its linings
    goal : end of wear on the mesh, by `final_pressure_and_torque_of_wear_on_mesh`, because wear on
        a mesh does not reach the pressure of the rigid-shoe law exactly
    within : largest relative difference of pressure and torque from the end of wear
    """
    return lambda state: (
        max(map(abs, relative_differences_from_end_of_wear(setup, state, goal))) <= within
    )


def wear_brake_linings_until_worn_in(
    setup: WearSetup,
    law: WearLaw | None = None,
    *,
    backward: WearSetup | None = None,
    until: Callable[[WearState], bool] | None = None,
    **options: Any,
) -> list[WearState]:
    """Wear the linings of a brake until they are worn in, or over a `distance`; returns all states.

    Parameters
    ----------
    setup : the brake with the contact problems of its linings
    law : the wear law; None for Archard's law with DEFAULT_WEAR_COEFFICIENT
    backward : setup of the same brake with the drum turning the other way, for the option `reverse`
    until : function of a WearState that returns whether the run ends with this state. By default
        the run ends after `distance` or, without a distance, when pressure and torque differ by at
        most END_OF_WEAR_TOLERANCE from their final values.
    options : `distance`, `reverse`, `torque` and `tolerance` of
        `archard.wear_linings_over_sliding_distance`

    Raises
    ------
    BadInput
        for an option out of range, and for a lining of fewer than 3 elements
    NoAnswer
        for the reasons of `archard.wear_linings_over_sliding_distance`
    """
    _require_three_elements_per_lining(setup)
    law = law or WearLaw(DEFAULT_WEAR_COEFFICIENT)
    torque = options.get("torque")
    if torque is not None:
        _require_loads_and_friction_that_allow_a_kept_torque(setup)
    if until is None and "distance" not in options:
        _require_that_wear_settles(setup.brake, both_ways=backward is not None)
        until = make_function_that_tests_for_end_of_wear(
            setup, final_pressure_and_torque_of_wear_on_mesh(setup, law, torque)
        )
    states = archard.wear_linings_over_sliding_distance(
        setup.interfaces,
        law,
        backward=backward.interfaces if backward else (),
        until=until or (lambda _: False),
        **options,
    )
    return list(map(setup.state_with_spring_pulls_apart, states))


def _require_loads_and_friction_that_allow_a_kept_torque(setup: WearSetup) -> None:
    """Raise BadInput for a brake on which the actuation cannot be adjusted to keep a torque."""
    key = first_key_of_loads_besides_actuation(setup.brake)
    if key is not None:
        raise BadInput(
            f"{key}: a torque that is kept scales all forces alike; leave out the torque"
        )
    if setup.is_friction_dependent_on_pressure:
        key = first_key_of_pressure_dependent_friction(setup.brake)
        raise BadInput(
            f"{key}: a torque that is kept takes no friction that depends on the pressure; "
            "leave out the torque"
        )


def reason_why_wear_never_settles(brake: Brake) -> str | None:
    """Why the pressure of a brake never stops changing by wear, or None if it stops."""
    for i, spring in enumerate(brake.springs):
        if spring.rate:
            return (
                f"spring[{i}].rate = {spring.rate * 1e-3:g} N/mm: the pull changes "
                "as long as the linings wear, which does not settle"
            )
    return None


def _require_that_wear_settles(brake: Brake, *, both_ways: bool) -> None:
    """Raise BadInput for a brake whose pressure never stops changing by wear.

    A wear run of such a brake must be given a distance. `both_ways` tells whether the drum turns
    both ways.
    """
    reason = reason_why_wear_never_settles(brake)
    if reason is not None:
        raise BadInput(f"{reason}: a distance must be given")
    if both_ways:
        raise BadInput(
            "a brake whose drum turns both ways does not settle: a distance must be given"
        )


def _require_three_elements_per_lining(setup: WearSetup) -> None:
    """Raise BadInput if a lining has fewer than 3 elements.

    One element at each end of a lining is left out where pressures are compared.
    """
    for surface in setup.surfaces:
        count = (len(surface.contact_angles_in_growing_order) - 1) // surface.order
        if count < 3:
            raise BadInput(
                f"shoe {surface.name!r}: its lining has {count} elements; "
                "wear needs at least 3 (--elements)"
            )


def sliding_distance_of_e_fold_pressure_change(setup: WearSetup, law: WearLaw) -> float:
    """The unit of sliding distance 1/(k K) [m], with the wear coefficient k; inf if k is 0.

    K is the stiffness E/t of the lining. For a rigid shoe on a lining of independent springs, wear
    reduces the difference of the pressure from its final value by a factor e over this distance.
    """
    return 1 / (law.coefficient * setup.lining_stiffness_per_area) if law.coefficient else math.inf


def brake_with_worn_linings(setup: WearSetup, state: WearState) -> Brake:
    """The brake with worn linings: the worn depth of a state is added to their clearances.

    Raises BadInput for the model "solid", in which the worn depth changes across the width.
    """
    if setup.model == "solid":
        raise BadInput(
            "--model = 'solid': its worn depth changes across the width, which a clearance cannot "
            "say; allowed: fem, foundation"
        )
    depths = {}
    for surface in setup.surfaces:
        depths[surface.shoe, surface.lining] = (
            surface.contact_angles_in_growing_order,
            surface.lining_values_by_growing_angle(state.depth),
        )
    return brake_with_added_worn_depths(setup.brake, depths)


def _largest_worn_depth_in_each_state(
    surface: WornLining, states: Sequence[WearState]
) -> list[float]:
    """The largest worn depth [m] of a lining in each of the states."""
    return [float(state.depth[surface.part].max()) for state in states]


class LiningWornThrough(NamedTuple):
    """The first lining of a wear run that is worn through.

    Attributes
    ----------
    distance : sliding distance [m] at which the lining has lost its whole thickness
    reason : why the wear run ends there, in words
    """

    distance: float
    reason: str


def first_lining_worn_through(
    setup: WearSetup, states: Sequence[WearState]
) -> LiningWornThrough | None:
    """The lining of a wear run that is first worn by more than its thickness; None if none is.

    The reason names the lining and the sliding distance.
    """
    s = list(map(attrgetter("s"), states))
    worn_through = []
    for surface in setup.surfaces:
        # The worn depth never shrinks, so that the last state tells whether it is too large.
        thickness = setup.brake.shoes[surface.shoe].lining.thickness
        deepest = _largest_worn_depth_in_each_state(surface, states)
        if deepest[-1] > thickness:
            after = float(np.interp(thickness, deepest, s))
            worn_through.append(
                (after, f"shoe {surface.name!r}: its lining of {length_as_text_in_mm(thickness)}")
            )
    if not worn_through:
        return None
    after, lining = min(worn_through)
    return LiningWornThrough(
        after,
        f"{lining} is worn through after {after * 1e-3:.4g} km "
        f"of the {s[-1] * 1e-3:.4g} km asked for or needed to settle, where this run ends",
    )


class LiningLife(NamedTuple):
    """The life of a brake's linings, and the fraction of this life until they are worn in.

    Attributes
    ----------
    distance : sliding distance [m] at which the first lining is worn out
    pressure : sliding distance after which the pressure stays near its final value, divided by
        `distance`; above 1 if a lining is worn out earlier, inf if the run never comes near it
    torque : sliding distance after which the torque stays near its final value, divided by
        `distance`
    """

    distance: float
    pressure: float
    torque: float


def compute_life_of_linings(
    setup: WearSetup,
    states: Sequence[WearState],
    goal: FinalWearPressureAndTorque,
    law: WearLaw,
    within: float = 0.01,
    part: float = WORN_OUT_FRACTION_OF_LINING_THICKNESS,
) -> LiningLife:
    """The life of the linings in a wear run, and the fraction of this life until they are worn in.

    After the last state the linings are assumed to wear at the rate of the final pressure. The wear
    run keeps the stiffness of a lining although it becomes thinner.

    Parameters
    ----------
    setup : the brake with the contact problems of its linings
    states : states of a wear run
    goal : pressure and torque to which wear tends
    law : the wear law
    within : relative difference from the final pressure and torque up to which they count as near
    part : largest worn depth, relative to the lining's thickness, at which a lining is worn out
    """
    s = list(map(attrgetter("s"), states))
    end = math.inf
    for surface in setup.surfaces:
        allowed = part * setup.brake.shoes[surface.shoe].lining.thickness
        deepest = _largest_worn_depth_in_each_state(surface, states)
        # A lining that is not worn out in the run is assumed to go on wearing at the rate of the
        # final pressure. The rate is 0 on a shoe that its supports hold off the drum.
        rate = float(law.wear_rate_and_its_slope(goal.pressure[surface.part], 0.0)[0].max())
        if deepest[-1] >= allowed:
            end = min(end, float(np.interp(allowed, deepest, s)))
        elif rate > 0:
            end = min(end, s[-1] + (allowed - deepest[-1]) / rate)
    # For each state, the relative differences of pressure and torque from their final values. The
    # brake counts as worn in once they stay within the bound `within`.
    distances = np.array(
        [relative_differences_from_end_of_wear(setup, state, goal) for state in states]
    )
    pressures, torques = distances.T.tolist()
    pressure_near = archard.distance_after_which_values_stay_small(s, pressures, within)
    torque_near = archard.distance_after_which_values_stay_small(s, torques, within)
    return LiningLife(end, pressure_near / end, torque_near / end)


class WearRunChecks(NamedTuple):
    """Checks of a wear run: two balances of the worn volume, and the ripple of the pressure.

    The two differences are relative to the worn volume and vanish in an exact solution.

    Attributes
    ----------
    volume : difference between the worn volume at the end and the integral of the wear rate over
        area and sliding distance
    energy : difference between the worn volume and k W/mu, with the friction energy W, the wear
        coefficient k and the friction coefficient mu. None if mu is 0 or not the same for all
        shoes, or if the exponent of the wear law is not 1.
    ripple : largest fraction of the pressure that alternates from node to node, by
        `archard.relative_amplitude_of_node_to_node_pressure_ripple`, in all states after the first;
        None if the linings have too few nodes
    """

    volume: float
    energy: float | None
    ripple: float | None


def compute_checks_of_wear_run(
    setup: WearSetup, states: Sequence[WearState], law: WearLaw
) -> WearRunChecks:
    """Compute the checks of a wear run: balances of the worn volume, and ripple of the pressure."""
    end = states[-1]
    area = np.concatenate(list(map(attrgetter("area"), setup.interfaces)))
    scale = end.removed or 1.0
    # The first state, the new lining, is left out: wear has not smoothed its pressure yet.
    ripples = []
    for state in states[1:]:
        for surface in setup.surfaces:
            rows = surface.lining_values_over_arc_and_width(state.pressure).T
            own = map(archard.relative_amplitude_of_node_to_node_pressure_ripple, rows)
            # The ripple of a lining with too few nodes is nan.
            ripples += [ripple for ripple in own if not math.isnan(ripple)]
    return WearRunChecks(
        volume=abs(float(area @ end.depth) - end.removed) / scale,
        energy=_imbalance_of_wear_and_friction_energy(setup, end, law, scale),
        ripple=max(ripples, default=None),
    )


def _imbalance_of_wear_and_friction_energy(
    setup: WearSetup, end: WearState, law: WearLaw, scale: float
) -> float | None:
    """The relative difference between the worn volume and k W/mu, with the friction energy W.

    The result is None if mu is 0, depends on the pressure or is not the same for all shoes, or if
    the exponent of the wear law is not 1, because k W/mu is then not the worn volume.

    Parameters
    ----------
    setup : the brake with the contact problems of its linings
    end : last state of a wear run
    law : the wear law
    scale : volume [m^3] to which the difference is relative
    """
    brake = setup.brake
    if (
        brake.friction == 0
        or setup.is_friction_dependent_on_pressure
        or brake.first_key_that_gives_lining_its_own_friction()
        or law.exponent != 1
    ):
        return None
    # The worn volume of a lining is the integral of the worn depth over its face, an arc or plane.
    volumes = []
    for surface in setup.surfaces:
        width = brake.shoes[surface.shoe].lining.width
        depth = _integral_over_lining(surface, surface.lining_values_by_growing_angle(end.depth))
        volumes.append(width * brake.length_per_surface_coordinate * depth)
    by_energy = law.coefficient * end.work / (brake.friction * brake.length_per_surface_coordinate)
    return abs(sum(volumes) - by_energy) / scale


def _integral_over_lining(surface: WornLining, values: Floats) -> float:
    """The integral over theta of values (n,), given at the growing angles of a lining."""
    _, at_points, weight = polynomial_values_at_gauss_points(
        surface.contact_angles_in_growing_order, values, surface.order
    )
    return float((at_points * weight).sum())


def peak_nodal_pressure_of_wear_state(setup: WearSetup, state: WearState) -> float:
    """The largest nodal pressure [Pa] on all linings, without the zones at the linings' ends.

    For solid shoes it is the largest mean over the width, as in the answer of `solve`.
    """
    peaks = []
    for surface in setup.surfaces:
        zone = length_of_edge_zone_left_out_of_peak_search(
            setup.brake.shoes[surface.shoe], setup.brake.length_per_surface_coordinate
        )
        peaks.append(
            largest_nodal_pressure_outside_end_zones(
                surface.contact_angles_in_growing_order,
                surface.lining_values_by_growing_angle(state.pressure),
                zone,
            )
        )
    return max(peaks)


def wear_run_as_json_data(
    setup: WearSetup, states: Sequence[WearState], goal: FinalWearPressureAndTorque, law: WearLaw
) -> dict[str, Any]:
    """A wear run as plain data for JSON in SI units, with each lining's values by growing theta.

    Depths and pressures are means over the width. For solid shoes, each state also has an entry
    "face" with values (n, m) for each lining, at n angles and at the m distances "z" [m] from the
    mid-plane.

    Parameters
    ----------
    setup : the brake with the contact problems of its linings
    states : states of the run
    goal : pressure and torque to which wear tends
    law : the wear law
    """
    is_solid = setup.model == "solid"

    def list_of_values_for_each_lining(values: Floats) -> list[list[float]]:
        """Convert values at the contact unknowns of all linings to a list for each lining."""
        return [
            surface.lining_values_by_growing_angle(values).tolist() for surface in setup.surfaces
        ]

    def values_over_face_of_each_lining(values: Floats) -> list[list[list[float]]]:
        """Convert values at the contact unknowns of all linings to rows (n, m) for each lining."""
        return [
            surface.lining_values_over_arc_and_width(values).tolist() for surface in setup.surfaces
        ]

    def wear_state_as_json_data(state: WearState) -> dict[str, Any]:
        """A state of the wear run as plain data for JSON."""
        off = relative_differences_from_end_of_wear(setup, state, goal)
        face = {
            "depth": values_over_face_of_each_lining(state.depth),
            "pressure": values_over_face_of_each_lining(state.pressure),
        }
        return {
            "distance": state.s,
            "forward": state.forward,
            "torque": state.torque,
            "force": state.force,
            "peak_pressure": peak_nodal_pressure_of_wear_state(setup, state),
            "pressure_from_law": off.pressure,
            "torque_from_law": off.torque,
            "worn_volume": state.removed,
            **({"spring_pulls": list(state.pulls)} if state.pulls else {}),
            "depth": list_of_values_for_each_lining(state.depth),
            "pressure": list_of_values_for_each_lining(state.pressure),
            **({"face": face} if is_solid else {}),
        }

    shoes = []
    for surface in setup.surfaces:
        shoe = {
            "name": surface.name,
            "lining": surface.lining,
            "theta": surface.contact_angles_in_growing_order.tolist(),
        }
        shoes.append(shoe | ({"z": surface.across.tolist()} if is_solid else {}))
    return {
        "model": setup.model,
        "law": law._asdict(),
        "unit_distance": sliding_distance_of_e_fold_pressure_change(setup, law)
        if law.coefficient
        else None,
        "shoes": shoes,
        "worn_in": {
            "torque": goal.torque,
            "pressure": list_of_values_for_each_lining(goal.pressure),
        },
        "states": list(map(wear_state_as_json_data, states)),
    }


def report_lines_of_wear_run(
    setup: WearSetup,
    states: Sequence[WearState],
    goal: FinalWearPressureAndTorque,
    law: WearLaw,
    lines: int = 24,
) -> list[str]:
    """A wear run as lines of text: a table of states, the life of the linings, and checks.

    Parameters
    ----------
    setup : the brake with the contact problems of its linings
    states : states of the run
    goal : pressure and torque to which wear tends
    law : the wear law
    lines : largest number of states in the table, which are spread evenly over the run
    """
    surface = setup.brake.surface
    text = _heading_lines_of_wear_report(setup, law)
    for i in np.unique(np.rint(np.linspace(0, len(states) - 1, lines)).astype(int)):
        text.append(_table_line_of_wear_state(setup, states[i], goal, law))
    text += _lines_on_spring_pulls_of_wear_run(setup.brake, states)
    text += _notes_on_shoes_without_contact_force(setup, states)
    text.append(
        f"worn in (law): {surface.word_for_torque_or_brake_force} {goal.torque:.6g} "
        f"{surface.unit_of_torque_or_brake_force}"
    )
    text += _notes_on_difference_of_wear_end_from_law(setup, goal, law)
    if law.coefficient > 0:
        spent = compute_life_of_linings(setup, states, goal, law)
        text.append(
            f"life: {spent.distance * 1e-3:.5g} km "
            f"to {number_as_text(WORN_OUT_FRACTION_OF_LINING_THICKNESS, '.0%')} of the thickness; "
            "p is more than 1 % off the law for "
            f"{_fraction_of_lining_life_as_text(spent.pressure)}, "
            f"the torque for {_fraction_of_lining_life_as_text(spent.torque)}"
        )
    balance = compute_checks_of_wear_run(setup, states, law)
    energy = "" if balance.energy is None else f", energy {error_text_in_percent(balance.energy)}"
    ripple = (
        ""
        if balance.ripple is None
        else f"p alternates from node to node by {error_text_in_percent(balance.ripple)} at most; "
    )
    text.append(
        f"worn volume {states[-1].removed * 1e9:.5g} mm^3; "
        f"balance: volume {error_text_in_percent(balance.volume)}{energy}; "
        f"{ripple}{len(states) - 1} steps"
    )
    return text


def _lines_on_spring_pulls_of_wear_run(brake: Brake, states: Sequence[WearState]) -> list[str]:
    """A line of text for each spring whose pull changes in a wear run, with first and last pull."""
    lines = []
    for i, (first, last) in enumerate(zip(states[0].pulls, states[-1].pulls, strict=True)):
        if first != last:
            lines.append(
                f"spring[{i}]: pulls by {first:.6g} N unworn and {last:.6g} N at the end, which "
                "the law below takes"
            )
    return lines


def _notes_on_shoes_without_contact_force(
    setup: WearSetup, states: Sequence[WearState]
) -> list[str]:
    """A note for each shoe on anchors that its supports hold off the drum in all states of a run.

    The pressure on the lining of such a shoe is round-off, and the lining does not wear.
    """
    largest = np.max([state.pressure for state in states], axis=0)
    notes = []
    for i, shoe in enumerate(setup.brake.shoes):
        own = [float(largest[each.part].max()) for each in setup.surfaces if each.shoe == i]
        limit = LARGEST_ROUND_OFF_CONTACT_FORCE * float(largest.max())
        if shoe.anchors and own and max(own) <= limit:
            notes.append(note_on_shoe_held_off_by_its_supports(shoe))
    return notes


def _heading_lines_of_wear_report(setup: WearSetup, law: WearLaw) -> list[str]:
    """A line of text on brake and wear law, and the two heading lines of the table of states."""
    brake, surface = setup.brake, setup.brake.surface
    wears = ": nothing wears"
    if law.coefficient:
        wears = (
            f", 1/(k K) = {sliding_distance_of_e_fold_pressure_change(setup, law) * 1e-3:.5g} km"
        )
    unit_of_torque_or_brake_force = f"[{surface.unit_of_torque_or_brake_force}]"
    return [
        f"{brake.title}: {setup.model}, {brake.motion_as_text}, "
        f"{brake.friction_coefficients_as_text}, k = {law.coefficient:g} 1/Pa, "
        f"exponent {law.exponent:.9g}{wears}",
        f"{'s':>9}{'s k K':>10}{surface.short_word_for_torque_or_brake_force:>11}{'force':>10}"
        f"{'peak p':>10}{'p off':>10}{'T off':>10}{'deepest':>10}",
        f"{'[km]':>9}{'':10}{unit_of_torque_or_brake_force:>11}{'[N]':>10}{'[MPa]':>10}"
        f"{'law [%]':>10}{'law [%]':>10}{'wear [mm]':>10}",
    ]


def _table_line_of_wear_state(
    setup: WearSetup, state: WearState, goal: FinalWearPressureAndTorque, law: WearLaw
) -> str:
    """The line for one state in the printed table of a wear run; `goal` has the final values."""
    off = relative_differences_from_end_of_wear(setup, state, goal)
    force = state.force * setup.brake.shoes[setup.surfaces[0].shoe].actuation.force
    peak = peak_nodal_pressure_of_wear_state(setup, state) * 1e-6
    relative = state.s / sliding_distance_of_e_fold_pressure_change(setup, law)
    # A number of four digits with sign and exponent has nine characters. Columns of ten characters
    # therefore leave a space between the numbers.
    return (
        f"{state.s * 1e-3:9.4g}{relative:10.4g}"
        f"{state.torque:11.6g}{force:10.4g}{peak:10.4g}"
        f"{100 * off.pressure:10.3f}{100 * off.torque:+10.3f}{state.depth.max() * 1e3:10.4g}"
    )


def _notes_on_difference_of_wear_end_from_law(
    setup: WearSetup, goal: FinalWearPressureAndTorque, law: WearLaw
) -> list[str]:
    """A line of text on how far the end of wear on this mesh is from the rigid-shoe law.

    The list is empty if the relative difference of the pressures is at most END_OF_WEAR_TOLERANCE.
    See `report_lines_of_wear_run` for the parameters.
    """
    end = final_pressure_and_torque_of_wear_on_mesh(setup, law)
    factor = goal.torque / end.torque if end.torque else 1.0
    off = largest_relative_pressure_difference_of_linings(
        setup, end.pressure * factor, goal.pressure
    )
    if off <= END_OF_WEAR_TOLERANCE:
        return []
    return [
        f"p at the end of wear is {number_as_text(off, '.2%')} off the law on this mesh, "
        "for the law presses a part of a lining that ends within an element; "
        "more elements come nearer"
    ]


def _fraction_of_lining_life_as_text(share: float) -> str:
    """A fraction of the linings' life as text; inf stands for more than the whole wear run."""
    if math.isinf(share):
        return "all of this run"
    if share > 1:
        return f"the whole life ({share:.3g} lives)"
    return f"{number_as_text(share, '.1%')} of the life"
