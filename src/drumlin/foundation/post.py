"""Discretise a shoe of the foundation model: stations along the beam, lining sectors, levers.

The beam has three parts, before, under and behind the lining, and each part has equal divisions.
The ends of the lining are stations, and its end sectors are halves. The sums of Barecki & Scieszka
(1987) are then trapezoidal rules of second order in dx. Only the part of a sector beyond its
station bends the beam at the station. Sum (8) of the paper counts the whole sector, which is an
error of first order.
"""

from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.brake import clearance
from drumlin.brake.beam_axis import Axis, axis_of
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Beam
from drumlin.brake.fields import AnyMaterial, Material


class Post(NamedTuple):
    """A shoe, divided into m stations and n sectors, in the beam's coordinates.

    Attributes
    ----------
    axis : axis of the beam
    x : stations (m,) [m] along the beam
    step : length (m,) [m] of beam that each station stands for
    EI : bending stiffness (m,) [N m^2] of the beam at the stations
    under : numbers (n,) of the stations under the lining
    theta : angles (n,) [rad] of the sectors
    sector : sizes (n,) [rad] of the sectors
    k : stiffnesses (n,) [N/m] of the sectors
    gap : clearance Delta (n,) [m] of the sectors
    pressed : moments (m, n) [m] about the stations per normal force
    dragged : moments (m, n) [m] about the stations per friction force towards the loaded end
    loaded : moments (m,) [N m] of the actuation about the stations, positive against the others
    closing : closing (m, n) [m] of the gaps per turn of the beam at a station
    drag : mu_hat, the friction towards the loaded end over the normal force
    """

    axis: Axis
    x: Floats
    step: Floats
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


def post(
    brake: Brake, shoe: Shoe, sections: int, *, tilt: bool, wedge: bool, plane_stress: bool
) -> Post:
    """Divide a shoe into stations along its beam and sectors of its lining.

    Parameters
    ----------
    brake, shoe : the brake and the shoe
    sections : number of divisions of the beam
    tilt : whether a turning section of the beam carries the lining along the beam
    wedge, plane_stress : parameters of `layers`
    """
    body, lining, R = shoe.body, shoe.lining, brake.size
    # `why_not` has refused other bodies.
    assert isinstance(body, Beam)
    axis = axis_of(shoe.pin.xy, shoe.actuation.point.xy)
    ends = np.sort(axis.angle(np.array([lining.start, lining.end])))
    start, end = (axis.foot + R * np.sin(ends)).tolist()
    x, under = stations(axis.length, start, end, sections)
    # The hinge bears no moment: the first term of its rule is zero in every equilibrium.
    step = trapezoid(x)
    step[0] = 0.0
    theta = np.arcsin(np.clip((x[under] - axis.foot) / R, -1, 1))
    theta[[0, -1]] = ends
    sector = trapezoid(theta)
    soft = layers(brake, shoe, axis, theta, wedge=wedge, plane_stress=plane_stress)
    c, s = np.cos(theta), np.sin(theta)
    # Levers of the sectors about the stations: along the axis, and towards the drum's centre.
    arm_x = np.maximum(x[under] - x[:, None], 0.0)
    depth = body.offset_at(x)[:, None] + (axis.distance - R * c)
    arm_y = _fractions_beyond(x, under, theta) * depth
    along, towards = axis.components(shoe.actuation.vector)
    pressed = arm_x * c + arm_y * s
    return Post(
        axis=axis,
        x=x,
        step=step,
        EI=body.bending_stiffness_at(x),
        under=under,
        theta=theta,
        sector=sector,
        k=lining.width * R * sector / soft,
        gap=clearance.gap(brake, shoe, shoe_angles(axis, shoe, theta)),
        pressed=pressed,
        dragged=arm_y * c - arm_x * s,
        loaded=(axis.length - x) * towards - body.offset_at(x) * along,
        closing=pressed if tilt else arm_x * c,
        drag=brake.friction * brake.spin * axis.sense,
    )


def _fractions_beyond(x: Floats, under: Ints, theta: Floats) -> Floats:
    """The fraction (m, n) of each sector at theta (n,) that lies beyond each station x (m,).

    `under` (n,) are the numbers of the stations at the sectors.
    """
    beyond = (x[:, None] < x[under]).astype(float)
    half_ahead = np.append(np.diff(theta), 0.0)
    beyond[under, np.arange(len(under))] = half_ahead / (2 * trapezoid(theta))
    return beyond


def stations(length: float, start: float, end: float, sections: int) -> tuple[Floats, Ints]:
    """The stations (m,) [m] of a beam, and the numbers (n,) of the stations under its lining.

    Parameters
    ----------
    length : length of the beam [m]
    start, end : begin and end of the lining along the beam [m]
    sections : number of divisions of the beam, which m - 1 approximates
    """
    lengths = np.array([start, end - start, length - end])
    # Each part has at least one division, unless it has no length.
    divisions = np.maximum(np.round(sections * lengths / length), 1)
    counts = np.where(lengths > 1e-9 * length, divisions, 0).astype(int)
    counts[1] = max(counts[1], 2)
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    parts = [np.linspace(ends[i], ends[i + 1], counts[i] + 1)[1:] for i in range(3) if counts[i]]
    return np.concatenate([[0.0], *parts]), counts[0] + np.arange(counts[1] + 1)


def trapezoid(x: Floats) -> Floats:
    """The weights (n,) of the trapezoidal rule on the points x (n,)."""
    half = 0.5 * np.diff(x)
    return np.append(half, 0.0) + np.append(0.0, half)


def layers(
    brake: Brake, shoe: Shoe, axis: Axis, theta: Floats, *, wedge: bool, plane_stress: bool
) -> Floats:
    """The compliance t_l/E_l + t_w/E_w [m/Pa] of lining and block at angles of the beam.

    Parameters
    ----------
    brake, shoe : the brake and the shoe
    axis : axis of the beam
    theta : angles [rad] in the beam's coordinates, any shape
    wedge : whether the block fills the space between the lining's back and the beam's face
    plane_stress : whether the layers are bonded; bonded layers cannot spread along the arc and are
        1/(1 - nu^2) times stiffer
    """

    def compliance(thickness: Floats, material: AnyMaterial) -> Floats:
        """The compliance [m/Pa] of a layer of a thickness [m]."""
        # `why_not` has refused orthotropic materials.
        assert isinstance(material, Material)
        return thickness * ((1 - material.nu**2) if plane_stress else 1.0) / material.E

    lining, backing = shoe.lining, shoe.backing
    total = compliance(np.full(theta.shape, lining.thickness), lining.material)
    if backing is None:
        return total
    thickness = np.full(theta.shape, backing.thickness)
    if wedge:
        # `why_not` and `included_effects` have refused other bodies and missing thicknesses.
        assert isinstance(shoe.body, Beam) and shoe.body.thickness is not None
        face = axis.distance - shoe.body.thickness / 2
        thickness = face - (brake.size + lining.thickness) * np.cos(theta)
    return total + compliance(thickness, backing.material)


def shoe_angles(axis: Axis, shoe: Shoe, theta: Floats) -> Floats:
    """Convert angles of the beam to angles of the brake [rad], counted as the lining's angles."""
    middle = 0.5 * (shoe.lining.start + shoe.lining.end)
    origin = middle - axis.sense * float(axis.angle(np.array(middle)))
    return origin + axis.sense * theta
