"""Discretise a shoe of the foundation model: stations along the beam, lining sectors, levers.

The beam has three equal divisions, before, under and behind the lining. The lining's ends are
stations, and its end sectors are halves. The sums of Barecki & Scieszka (1987) are then trapezoidal
rules of second order in dx. Only the part of a sector beyond its station bends the beam there. The
paper's sum (8) counts the whole sector, which is an error of first order.
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
    """A shoe on m stations and n sectors, in the beam's coordinates.

    Attributes
    ----------
    axis : of the beam
    x : (m,), stations [m]
    step : (m,), length of beam that each station stands for [m]
    EI : (m,), bending stiffness [N m^2]
    under : (n,), indices of the stations under the lining
    theta : (n,), angles of the sectors [rad]
    sector : (n,), sizes of the sectors [rad]
    k : (n,), stiffnesses of the sectors [N/m]
    gap : (n,), clearance Delta [m]
    pressed : (m, n), moments about the stations per normal force [m]
    dragged : (m, n), moments about the stations per friction towards the loaded end [m]
    loaded : (m,), moments of the actuation about the stations, against the others [N m]
    closing : (m, n), closing of the gap per turn at a station [m]
    drag : mu_hat, the friction over N towards the loaded end
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
    """Discretise a shoe.

    Parameters
    ----------
    brake, shoe : the shoe and its brake
    sections : divisions of the beam
    tilt : whether turning sections carry the lining along the beam
    wedge, plane_stress : as of `layers`
    """
    body, lining, R = shoe.body, shoe.lining, brake.size
    assert isinstance(body, Beam)  # `why_not` has refused other bodies
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

    # The part of each sector beyond each station.
    beyond = (x[:, None] < x[under]).astype(float)
    forward = np.append(np.diff(theta), 0.0) / (2 * sector)
    beyond[under, np.arange(len(under))] = forward
    # Levers of the sectors about the stations: along the axis, and towards the drum's centre. Here
    # a is the a + R (1 - cos theta) of the paper.
    arm_x = np.maximum(x[under] - x[:, None], 0.0)
    a = axis.distance - R * np.cos(theta)
    arm_y = beyond * (body.offset_at(x)[:, None] + a)
    c, s = np.cos(theta), np.sin(theta)
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


def stations(length: float, start: float, end: float, sections: int) -> tuple[Floats, Ints]:
    """Stations (about `sections` + 1,) [m] of a beam, and the indices of those under its lining.

    Parameters
    ----------
    length : of the beam [m]
    start, end : of the lining along the beam [m]
    sections : divisions of the beam
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
    """Weights (n,) of the trapezoidal rule on the points x (n,)."""
    half = 0.5 * np.diff(x)
    return np.append(half, 0.0) + np.append(0.0, half)


def layers(
    brake: Brake, shoe: Shoe, axis: Axis, theta: Floats, *, wedge: bool, plane_stress: bool
) -> Floats:
    """Compliance t_l/E_l + t_w/E_w [m/Pa] of lining and block at the beam's angles, same shape.

    Parameters
    ----------
    brake, shoe : the shoe and its brake
    axis : of the beam
    theta : the beam's angles [rad]
    wedge : whether the block fills the space between the lining's back and the beam's face
    plane_stress : whether the layers are bonded; they cannot spread along the arc then and are
        1/(1 - nu^2) times stiffer
    """

    def soft(thickness: Floats, material: AnyMaterial) -> Floats:
        assert isinstance(material, Material)  # `why_not` has refused others
        return thickness * ((1 - material.nu**2) if plane_stress else 1.0) / material.E

    lining, backing = shoe.lining, shoe.backing
    total = soft(np.full(theta.shape, lining.thickness), lining.material)
    if backing is None:
        return total
    thickness = np.full(theta.shape, backing.thickness)
    if wedge:
        # The model has refused other bodies and missing thicknesses.
        assert isinstance(shoe.body, Beam) and shoe.body.thickness is not None
        face = axis.distance - shoe.body.thickness / 2
        thickness = face - (brake.size + lining.thickness) * np.cos(theta)
    return total + soft(thickness, backing.material)


def shoe_angles(axis: Axis, shoe: Shoe, theta: Floats) -> Floats:
    """Convert the beam's angles to the brake's [rad], counted as the lining's angles."""
    middle = 0.5 * (shoe.lining.start + shoe.lining.end)
    origin = middle - axis.sense * float(axis.angle(np.array(middle)))
    return origin + axis.sense * theta
