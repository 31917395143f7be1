"""Divide a shoe of the foundation model into stations along its beam and sectors of its lining.

The shoe of a post brake is a straight beam that carries one lining, or several with slots between
them. The beam has parts under the linings, in the slots, and before and behind them, and each part
has equal divisions of length dx. The ends of the divisions are called stations. Each station under
a lining has a sector of the lining, which reaches half-way to the neighbouring stations. The ends
of a lining are stations, so that the sectors there are half as long. The sums of Barecki & Scieszka
(1987) are then trapezoidal rules, with errors of second order in dx. At the station of a sector
only the half of the sector that is farther from the hinge bends the beam. Sum (8) of the paper
counts the whole sector there, which is an error of first order in dx.
"""

from collections.abc import Sequence
from operator import itemgetter
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.brake import clearance
from drumlin.brake.beam_axis import BeamAxis, make_beam_axis
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import BeamBody
from drumlin.brake.fields import IsotropicOrOrthotropicMaterial, Material


class ShoeInStationsAndSectors(NamedTuple):
    """A shoe of a post brake, whose beam has m stations and whose lining has n sectors.

    A station is a point of the beam. A sector is the part of the lining at a station. All
    quantities are in the beam's coordinates, which begin at the hinge.

    Attributes
    ----------
    axis : axis of the beam
    x : (m,) [m], distances of the stations from the hinge along the beam
    station_weights : (m,) [m], weights of the trapezoidal rule over the stations, 0 at the hinge
    EI : (m,) [N m^2], bending stiffness of the beam at the stations
    under : (n,), index of the station of each sector
    theta : (n,) [rad], angles of the sectors in the beam's coordinates, see
        `drumlin.brake.beam_axis`
    sector : (n,) [rad], angles that the sectors cover
    k : (n,) [N/m], stiffnesses of the sectors: force per compression of lining and block
    gap : (n,) [m], clearance Delta between the unloaded lining and the drum at the sectors
    pressed : (m, n) [m], moment about each station per normal force on each sector
    dragged : (m, n) [m], moment about each station per friction force on each sector, with the
        friction towards the loaded end of the beam
    loaded : (m,) [N m], moment of the actuation about each station, positive if it opposes the
        moments of the normal forces
    closing : (m, n) [m], closing of the gap at each sector per turn [rad] of the part of the beam
        beyond each station
    drag : mu_hat, signed ratio of friction to normal force, positive if the friction acts on the
        shoe towards the loaded end
    further_linings : index of the first sector of each lining except the first lining
    """

    axis: BeamAxis
    x: Floats
    station_weights: Floats
    EI: Floats
    under: Ints
    theta: Floats
    sector: Floats
    k: Floats
    gap: Floats
    pressed: Floats
    dragged: Floats
    loaded: Floats
    closing: Floats
    drag: float
    further_linings: tuple[int, ...] = ()

    def values_of_each_lining_by_growing_angle(self, values: Floats) -> list[Floats]:
        """Split values (n,) at the sectors into an array for each lining.

        The linings, and the values of each lining, are in the order of growing angles of the brake.
        """
        parts = np.split(values, self.further_linings)
        return parts if self.axis.sense > 0 else [part[::-1] for part in parts[::-1]]


def divide_shoe_into_stations_and_sectors(
    brake: Brake, shoe: Shoe, sections: int, *, tilt: bool, wedge: bool, plane_stress: bool
) -> ShoeInStationsAndSectors:
    """Divide a shoe of a post brake into stations along its beam and sectors of its lining.

    Parameters
    ----------
    brake, shoe : the brake and the shoe
    sections : number of divisions of the beam
    tilt : whether a turning cross-section of the beam also moves the lining along the beam
    wedge : whether the block fills the space between the lining's back and the beam's straight
        face; otherwise the block has the thickness of the shoe's backing everywhere
    plane_stress : whether the layers are bonded, so that they cannot expand along the arc and are
        1/(1 - nu^2) times as stiff
    """
    body, lining, R = shoe.body, shoe.lining, brake.size
    # `reason_against_foundation_model` has refused brakes whose shoes are not beams.
    assert isinstance(body, BeamBody)
    axis = make_beam_axis(shoe.pin.xy, shoe.actuation.point.xy)
    arcs = sorted(
        (np.sort(axis.angle(np.array(arc))) for arc in shoe.lining.arcs), key=itemgetter(0)
    )
    places = [axis.x_of_perpendicular_foot + R * np.sin(arc) for arc in arcs]
    x, stations = places_of_beam_stations_and_indices_under_linings(axis.length, places, sections)
    angles = [
        _sector_angles_from_distances_along_beam(x[own], axis, R, arc)
        for own, arc in zip(stations, arcs, strict=True)
    ]
    under, theta = np.concatenate(stations), np.concatenate(angles)
    sector = np.concatenate(list(map(trapezoidal_rule_weights, angles)))
    soft = compression_of_layers_per_pressure(
        brake, shoe, axis, theta, wedge=wedge, plane_stress=plane_stress
    )
    c, s = np.cos(theta), np.sin(theta)
    offset = body.neutral_axis_offset_at_distances_from_hinge(x)
    arm_x, arm_y = _levers_along_and_across_beam_of_sectors_about_stations(
        x, under, angles, offset[:, None] + (axis.distance_from_drum_centre - R * c)
    )
    along, towards = axis.vector_components_along_and_across_beam(shoe.actuation.force_vector)
    pressed = arm_x * c + arm_y * s
    return ShoeInStationsAndSectors(
        axis=axis,
        x=x,
        station_weights=_weights_of_beam_stations(x),
        EI=body.bending_stiffness_at_distances_from_hinge(x),
        under=under,
        theta=theta,
        sector=sector,
        k=lining.width * R * sector / soft,
        gap=clearance.gaps_between_unloaded_lining_and_surface(
            brake, shoe, brake_angles_from_beam_angles(axis, shoe, theta)
        ),
        pressed=pressed,
        dragged=arm_y * c - arm_x * s,
        loaded=(axis.length - x) * towards - offset * along,
        closing=pressed if tilt else arm_x * c,
        drag=brake.signed_friction_stress_over_pressure(shoe) * axis.sense,
        further_linings=tuple(np.cumsum(list(map(len, angles)))[:-1].tolist()),
    )


def _sector_angles_from_distances_along_beam(
    places: Floats, axis: BeamAxis, R: float, ends: Floats
) -> Floats:
    """The angles (m,) [rad] of the sectors of a lining from their distances along the beam.

    Parameters
    ----------
    places : (m,) distances of the sectors from the hinge along the beam [m]
    axis : axis of the beam
    R : radius of the drum [m]
    ends : (2,) angles of the lining's ends [rad], which are the first and the last result
    """
    theta = np.arcsin(np.clip((places - axis.x_of_perpendicular_foot) / R, -1, 1))
    theta[[0, -1]] = ends
    return theta


def _weights_of_beam_stations(x: Floats) -> Floats:
    """The weights (n,) [m] of a beam's stations in integrals of its bending moment.

    `x` (n,) are the distances of the stations from the hinge [m]. The beam has no moment at its
    hinge, so that the first station has the weight 0.
    """
    weights = trapezoidal_rule_weights(x)
    weights[0] = 0.0
    return weights


def _levers_along_and_across_beam_of_sectors_about_stations(
    x: Floats, under: Ints, angles: list[Floats], depth: Floats
) -> tuple[Floats, Floats]:
    """The lever arms of n sectors about m stations, as two arrays (m, n) [m].

    The first array has the arms along the beam, the second the arms normal to the beam.

    Only forces farther from the hinge than a station bend the beam at this station. Sectors that
    are nearer to the hinge than a station therefore have arms of 0 about this station.

    Parameters
    ----------
    x : (m,) distances of the stations from the hinge along the beam [m]
    under : (n,) index of the station of each sector
    angles : angles (n_k,) of the sectors of each lining [rad]
    depth : (m, n) distance [m] of each sector from the beam's neutral axis at each station, normal
        to the beam
    """
    along = np.maximum(x[under] - x[:, None], 0.0)
    return along, _fractions_of_sectors_beyond_stations(x, under, angles) * depth


def _fractions_of_sectors_beyond_stations(x: Floats, under: Ints, angles: list[Floats]) -> Floats:
    """Fractions (m, n): how much of each of n sectors is farther from the hinge than each station.

    Parameters
    ----------
    x : distances (m,) [m] of the stations from the hinge along the beam
    under : index (n,) of the station of each sector
    angles : angles (n_k,) [rad] of the sectors of each lining
    """
    beyond = (x[:, None] < x[under]).astype(float)
    # A sector reaches half-way to the neighbouring stations. Of the sector at a station only the
    # part towards the next station is farther from the hinge.
    ahead = []
    for theta in angles:
        half_ahead = np.append(np.diff(theta), 0.0)
        ahead.append(half_ahead / (2 * trapezoidal_rule_weights(theta)))
    beyond[under, np.arange(len(under))] = np.concatenate(ahead)
    return beyond


def places_of_beam_stations_and_indices_under_linings(
    length: float, linings: Sequence[Floats], sections: int
) -> tuple[Floats, list[Ints]]:
    """Distances (m,) [m] of a beam's stations from its hinge, and indices (n_k,) under each lining.

    Parameters
    ----------
    length : length of the beam [m]
    linings : distances (2,) of begin and end of each lining from the hinge along the beam [m]
    sections : wanted number of divisions of the beam; the actual number, m - 1, may differ a little
    """
    # Lengths of the parts of the beam, in order: before the first lining, under it, in the slot
    # behind it, under the next lining, and so on, and behind the last lining.
    lengths = np.diff(np.concatenate([[0.0], *linings, [length]]))
    # Each part has at least one division, unless it has no length; a lining has two or more.
    divisions = np.maximum(np.round(sections * lengths / length), 1)
    counts = np.where(lengths > 1e-9 * length, divisions, 0).astype(int)
    counts[1::2] = np.maximum(counts[1::2], 2)
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    parts = [
        np.linspace(ends[i], ends[i + 1], count + 1)[1:] for i, count in enumerate(counts) if count
    ]
    firsts = np.concatenate([[0], np.cumsum(counts)])
    under = [np.arange(firsts[i], firsts[i + 1] + 1) for i in range(1, len(counts), 2)]
    return np.concatenate([[0.0], *parts]), under


def trapezoidal_rule_weights(x: Floats) -> Floats:
    """The weights (n,) of the trapezoidal rule on the points x (n,)."""
    half = 0.5 * np.diff(x)
    return np.append(half, 0.0) + np.append(0.0, half)


def compression_of_layers_per_pressure(
    brake: Brake, shoe: Shoe, axis: BeamAxis, theta: Floats, *, wedge: bool, plane_stress: bool
) -> Floats:
    """The compression per pressure [m/Pa] of lining and block together, in the shape of `theta`.

    It is t_l/E_l + t_w/E_w, with thickness t and modulus E of the lining (l) and the block (w).

    Parameters
    ----------
    brake, shoe : the brake and the shoe
    axis : axis of the beam
    theta : angles [rad] in the beam's coordinates, any shape
    wedge : whether the block fills the space between the lining's back and the beam's face;
        otherwise the block has the thickness of the shoe's backing everywhere
    plane_stress : whether the layers are bonded, so that they cannot expand along the arc and are
        1/(1 - nu^2) times as stiff
    """

    def compression_of_layer_per_pressure(
        thickness: Floats, material: IsotropicOrOrthotropicMaterial
    ) -> Floats:
        """The compression per pressure [m/Pa] of a layer of a given thickness [m] and material."""
        # `reason_against_foundation_model` has refused brakes with orthotropic materials.
        assert isinstance(material, Material)
        return thickness * ((1 - material.nu**2) if plane_stress else 1.0) / material.E

    lining, backing = shoe.lining, shoe.backing
    total = compression_of_layer_per_pressure(
        np.full(theta.shape, lining.thickness), lining.material
    )
    if backing is None:
        return total
    thickness = np.full(theta.shape, backing.thickness)
    if wedge:
        # `reason_against_foundation_model` has refused bodies other than beams, and
        # `validated_names_of_effects_to_include` has refused beams without a thickness.
        assert isinstance(shoe.body, BeamBody) and shoe.body.thickness is not None
        face = axis.distance_from_drum_centre - shoe.body.thickness / 2
        thickness = face - (brake.size + lining.thickness) * np.cos(theta)
    return total + compression_of_layer_per_pressure(thickness, backing.material)


def brake_angles_from_beam_angles(axis: BeamAxis, shoe: Shoe, theta: Floats) -> Floats:
    """Convert angles in a beam's coordinates to angles of the brake [rad], of the same shape.

    Full turns are added so that the results are near the angles of the shoe's lining.
    """
    middle = 0.5 * (shoe.lining.start + shoe.lining.end)
    origin = middle - axis.sense * float(axis.angle(np.array(middle)))
    return origin + axis.sense * theta
