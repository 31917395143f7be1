"""A shoe of the foundation model on its grid: stations along the beam, sectors of the lining, their
levers.

Three equal divisions, before, under and behind the lining, so that the lining's ends are stations
and its end sectors are halves: the sums of Barecki & Scieszka (1987) are then trapezoidal rules, of
second order in dx. Of the sector at a station only the part beyond it bends it there; the paper's
sum (8) counts all of it, an error of first order.
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

    `x`, `step` (m,) [m]: stations, and the length of beam that each stands for; `EI` (m,) [N m^2];
    `under` (n,): the stations under the lining; `theta` (n,) [rad] and `sector` (n,) [rad] the
    sectors' angles and sizes; `k` (n,) [N/m]; `gap` (n,) [m] the clearance Delta.

    Moments about the stations: `pressed` (m, n) [m] of unit N, `dragged` (m, n) [m] of unit
    friction towards the loaded end, both against the force's `loaded` (m,) [N m]. `closing` (m, n)
    [m]: closing of the gap per turn at a station. `drag`: mu_hat, the friction over N towards the
    loaded end.
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
    """The shoe on a grid of `sections` divisions of the beam; the options are those of the model."""
    body, lining, R = shoe.body, shoe.lining, brake.size
    assert isinstance(body, Beam)  # why_not
    axis = axis_of(shoe.pin.xy, shoe.actuation.point.xy)
    ends = np.sort(axis.angle(np.array([lining.start, lining.end])))
    start, end = (axis.foot + R * np.sin(ends)).tolist()
    x, under = stations(axis.length, start, end, sections)
    step = trapezoid(x)
    step[0] = 0.0  # the hinge bears no moment: its rule's first term is zero for every equilibrium
    theta = np.arcsin(np.clip((x[under] - axis.foot) / R, -1, 1))
    theta[[0, -1]] = ends
    sector = trapezoid(theta)
    forward = np.append(np.diff(theta), 0.0) / (2 * sector)  # of a sector, beyond its own station

    beyond = (x[:, None] < x[under]).astype(float)
    beyond[under, np.arange(len(under))] = forward
    arm_x = np.maximum(x[under] - x[:, None], 0.0)
    a = axis.distance - R * np.cos(theta)  # a + R (1 - cos theta) of the paper
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
        k=lining.width
        * R
        * sector
        / layers(brake, shoe, axis, theta, wedge=wedge, plane_stress=plane_stress),
        gap=clearance.gap(brake, shoe, shoe_angles(axis, shoe, theta)),
        pressed=pressed,
        dragged=arm_y * c - arm_x * s,
        loaded=(axis.length - x) * towards - body.offset_at(x) * along,
        closing=pressed if tilt else arm_x * c,
        drag=brake.friction * brake.spin * axis.sense,
    )


def stations(length: float, start: float, end: float, sections: int) -> tuple[Floats, Ints]:
    """Stations (about `sections` + 1,) [m] of a beam whose lining lies from `start` to `end`, and
    those under it.
    """
    lengths = np.array([start, end - start, length - end])
    counts = np.where(
        lengths > 1e-9 * length, np.maximum(np.round(sections * lengths / length), 1), 0
    ).astype(int)
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
    """Compliance t_l/E_l + t_w/E_w [m/Pa] of lining and block at the beam's angles theta, same
    shape.

    `plane_stress`: bonded layers cannot spread along the arc and are 1/(1 - nu^2) stiffer. `wedge`:
    the block fills the space between the lining's back and the beam's face.
    """

    def soft(thickness: Floats, material: AnyMaterial) -> Floats:
        assert isinstance(material, Material)  # why_not
        return thickness * ((1 - material.nu**2) if plane_stress else 1.0) / material.E

    lining, backing = shoe.lining, shoe.backing
    total = soft(np.full(theta.shape, lining.thickness), lining.material)
    if backing is None:
        return total
    thickness = np.full(theta.shape, backing.thickness)
    if wedge:
        assert isinstance(shoe.body, Beam) and shoe.body.thickness is not None  # why_not
        face = axis.distance - shoe.body.thickness / 2
        thickness = face - (brake.size + lining.thickness) * np.cos(theta)
    return total + soft(thickness, backing.material)


def shoe_angles(axis: Axis, shoe: Shoe, theta: Floats) -> Floats:
    """The brake's angles [rad] of the beam's angles, counted as the lining's are."""
    middle = 0.5 * (shoe.lining.start + shoe.lining.end)
    origin = middle - axis.sense * float(axis.angle(np.array(middle)))
    return origin + axis.sense * theta
