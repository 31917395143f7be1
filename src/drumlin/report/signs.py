"""Signs for how shoes are held and pushed: pin, lever's pivot, abutment, guide, strut, cam, rigid arm."""

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Rectangle

from drumlin.arrays import Floats
from drumlin.brake.components import Body
from drumlin.brake.drum_brake import Brake, Shoe
from drumlin.brake.fields import Point
from drumlin.brake.plane_brake import FlatShoe
from drumlin.report.palette import BLUE, RED

MM = 1e3
INK, FAINT, DRUM, BODY, BLOCK, LINING, FORCE, MOTION = (
    "#1d2733", "#5b6875", "#e6ebf0", "#aab6c2", "#e3cfa4", "#c89b6a", RED, BLUE,
)  # fmt: skip


def held(axes: Axes, shoe: Shoe | FlatShoe, unit: float) -> None:
    """What holds a shoe."""
    if shoe.hinge is not None:
        pin(axes, shoe.hinge, unit, fixed=True)
    if shoe.pivot is not None:
        if shoe.hinge is not None:  # the lever
            lever = [shoe.hinge.xy, shoe.pivot.xy, shoe.actuation.point.xy]
            axes.plot(*np.array(lever).T * MM, color=FAINT, lw=3, alpha=0.5, zorder=2)
        pin(axes, shoe.pivot, unit, fixed=False)
    if shoe.abutment is not None:
        face(axes, shoe.abutment.point.xy * MM, shoe.abutment.direction, unit)
    if shoe.guide is not None:
        for side in (-1.0, 1.0):
            along = np.array([math.cos(shoe.guide.direction), math.sin(shoe.guide.direction)])
            across = side * 0.6 * unit * np.array([-along[1], along[0]])
            ends = shoe.pin.xy * MM + across + np.outer([-1.2 * unit, 1.2 * unit], along)
            axes.plot(*ends.T, color=INK, lw=2.5, zorder=5)


def face(axes: Axes, at: Floats, direction: float, unit: float) -> None:
    """The face of an abutment at a point [mm], its normal in the direction [rad]: a line, hatched behind."""
    n = np.array([math.cos(direction), math.sin(direction)])
    t = np.array([-n[1], n[0]])
    axes.plot(*(at + np.outer([-unit, unit], t)).T, color=INK, lw=2.5, zorder=5)
    for place in np.linspace(-0.9, 0.9, 6):
        foot = at + place * unit * t
        axes.plot(*np.array([foot, foot - 0.45 * unit * (n + t)]).T, color=FAINT, lw=0.8, zorder=4)


def arm(axes: Axes, shoe: Shoe, radius: float, unit: float) -> None:
    """A rigid arm, dashed, where what holds an elastic shoe stands off the face of its body; radius [m] of the drum."""
    middle = end_face(shoe, radius)
    if middle is not None and float(np.linalg.norm(middle - shoe.pin.xy)) * MM > 0.2 * unit:
        axes.plot(*np.array([middle, shoe.pin.xy]).T * MM, color=INK, lw=1.6, ls="--", zorder=4)


def end_face(shoe: Shoe, radius: float) -> Floats | None:
    """The middle (2,) [m] of the end face by which a hinge or an abutment holds an arc; None of other shoes."""
    if not isinstance(shoe.body, Body) or shoe.mesh is not None or shoe.held_by not in {"hinge", "abutment"}:
        return None
    return np.asarray(shoe.frame.to_brake(shoe.end_face(radius)))


def between(axes: Axes, brake: Brake, unit: float) -> None:
    """What shoes share: a strut from one to the other, a cam between their tips."""
    shoes = {shoe.name: shoe for shoe in brake.shoes}
    for link in brake.links:
        source, to = shoes[link.source], shoes[link.to]
        assert source.abutment is not None
        start, along = source.abutment.point.xy * MM, -source.bearing
        far = start + along * max(0.0, float((to.lining.thickness * MM) + 2 * abs(start @ along)))
        axes.plot(*np.array([start, far]).T, color=INK, lw=5, solid_capstyle="butt", zorder=4)
    if brake.actuation is not None and brake.actuation.is_cam:
        tips = [shoe.actuation.point.xy * MM for shoe in brake.shoes if shoe.actuation.force]
        if len(tips) == 2:
            middle, size = 0.5 * (tips[0] + tips[1]), 0.5 * float(np.linalg.norm(tips[0] - tips[1]))
            axes.add_patch(Circle(tuple(middle), max(0.6 * size, 0.4 * unit), facecolor=BODY, edgecolor=INK, zorder=4))
            axes.plot(*np.array(tips).T, color=INK, lw=3, zorder=5)


def pin(axes: Axes, point: Point, unit: float, *, fixed: bool) -> None:
    """A pin: on hatched ground, or on the lever."""
    x, y = point.xy * MM
    if fixed:
        foot = np.array([[x, y], [x - 0.7 * unit, y - 1.1 * unit], [x + 0.7 * unit, y - 1.1 * unit], [x, y]])
        axes.fill(*foot.T, facecolor="white", edgecolor=INK, lw=1, zorder=4)
        ground = (x - unit, y - 1.45 * unit)
        axes.add_patch(
            Rectangle(ground, 2 * unit, 0.35 * unit, facecolor="none", edgecolor=FAINT, hatch="////", lw=0, zorder=4)
        )
        axes.plot([x - unit, x + unit], [y - 1.1 * unit] * 2, color=INK, lw=1, zorder=4)
    axes.add_patch(Circle((x, y), 0.32 * unit, facecolor="white", edgecolor=INK, lw=1.4, zorder=5))
