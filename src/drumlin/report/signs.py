"""Signs for how shoes are held and pushed: pin, lever's pivot, abutment, guide, grip, strut, cam,
rigid arm.
"""

import math
from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Rectangle

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Bar
from drumlin.brake.fields import Point
from drumlin.report.palette import BLUE, RED

MM = 1e3
INK, FAINT, DRUM, BODY, BLOCK, LINING, FORCE, MOTION = (
    "#1d2733", "#5b6875", "#e6ebf0", "#aab6c2", "#e3cfa4", "#c89b6a", RED, BLUE,
)  # fmt: skip


def held(axes: Axes, shoe: Shoe, unit: float, *, on_strut: bool = False) -> None:
    """What holds a shoe; on_strut: its abutment is a strut's end."""
    if shoe.hinge is not None:
        pin(axes, shoe.hinge, unit, fixed=True)
    if shoe.pivot is not None:
        if shoe.hinge is not None:  # the lever
            lever = [shoe.hinge.xy, shoe.pivot.xy, shoe.actuation.point.xy]
            axes.plot(*np.array(lever).T * MM, color=FAINT, lw=3, alpha=0.5, zorder=2)
        pin(axes, shoe.pivot, unit, fixed=False)
    if shoe.abutment is not None:
        face(axes, shoe.abutment.point.xy * MM, shoe.abutment.direction, unit, ground=not on_strut)
    if shoe.guide is not None:
        for side in (-1.0, 1.0):
            along = np.array([math.cos(shoe.guide.direction), math.sin(shoe.guide.direction)])
            across = side * 0.6 * unit * np.array([-along[1], along[0]])
            ends = shoe.pin.xy * MM + across + np.outer([-1.2 * unit, 1.2 * unit], along)
            axes.plot(*ends.T, color=INK, lw=2.5, zorder=5)


def face(axes: Axes, at: Floats, direction: float, unit: float, *, ground: bool) -> None:
    """The face of an abutment at a point [mm], its normal in the direction [rad]: a line, hatched
    behind on ground.
    """
    n = np.array([math.cos(direction), math.sin(direction)])
    t = np.array([-n[1], n[0]])
    axes.plot(*(at + np.outer([-unit, unit], t)).T, color=INK, lw=2.5, zorder=5)
    for place in np.linspace(-0.9, 0.9, 6 if ground else 0):
        foot = at + place * unit * t
        axes.plot(*np.array([foot, foot - 0.45 * unit * (n + t)]).T, color=FAINT, lw=0.8, zorder=4)


def arms(axes: Axes, shoe: Shoe, radius: float, force: Floats, unit: float) -> None:
    """Rigid arms, dashed, where what holds or pushes an elastic shoe stands off its body, and what
    a pivot or guide grips of its back, as a line; radius [m], the size of the brake; the force's
    point (2,) [mm].
    """
    if not isinstance(shoe.body, Bar) or shoe.mesh is not None:
        return
    grip = shoe.grip(radius)
    if grip is None:
        faces = [shoe.end_face(radius), shoe.end_face(radius, loaded=True)]
        ends = zip(faces, (shoe.pin.xy * MM, force), strict=True)
    else:
        back = shoe.points(shoe.at(np.array(shoe.depth), np.linspace(*grip, 20), radius)) * MM
        axes.plot(*back, color=INK, lw=3, solid_capstyle="butt", zorder=4)
        held_at = [shoe.pin.xy * MM, force] if shoe.pivot is None else [shoe.pivot.xy * MM]
        ends = zip(
            [shoe.at(np.array(shoe.depth), np.array(0.5 * sum(grip)), radius)] * 2,
            held_at,
            strict=False,
        )
    for middle, to in ends:
        line = np.array([shoe.points(middle[:, None])[:, 0] * MM, to])
        if float(np.linalg.norm(line[1] - line[0])) > 0.2 * unit:
            axes.plot(*line.T, color=INK, lw=1.6, ls="--", zorder=4)


def between(axes: Axes, brake: Brake, loaded: Mapping[str, Floats], unit: float) -> None:
    """What shoes share: a strut from one to the other, a cam between their tips; `loaded`: where
    each is pushed.
    """
    shoes = {shoe.name: shoe for shoe in brake.shoes}
    for link in brake.links:
        source = shoes[link.source]
        assert source.abutment is not None
        ends = np.array([source.abutment.point.xy * MM, loaded[link.to]])
        axes.plot(*ends.T, color=INK, lw=5, solid_capstyle="butt", zorder=4)
    if brake.actuation is not None and brake.actuation.is_cam:
        tips = [loaded[shoe.name] for shoe in brake.shoes if shoe.actuation.force]
        middle, size = 0.5 * (tips[0] + tips[1]), brake.actuation.radius or 0.0
        axes.plot(*np.array(tips).T, color=INK, lw=5, solid_capstyle="butt", zorder=4)
        axes.add_patch(
            Circle(
                tuple(middle), max(size * MM, 0.5 * unit), facecolor=BODY, edgecolor=INK, zorder=5
            )
        )


def pin(axes: Axes, point: Point, unit: float, *, fixed: bool) -> None:
    """A pin: on hatched ground, or on the lever."""
    x, y = point.xy * MM
    if fixed:
        foot = np.array(
            [[x, y], [x - 0.7 * unit, y - 1.1 * unit], [x + 0.7 * unit, y - 1.1 * unit], [x, y]]
        )
        axes.fill(*foot.T, facecolor="white", edgecolor=INK, lw=1, zorder=4)
        ground = (x - unit, y - 1.45 * unit)
        axes.add_patch(
            Rectangle(
                ground,
                2 * unit,
                0.35 * unit,
                facecolor="none",
                edgecolor=FAINT,
                hatch="////",
                lw=0,
                zorder=4,
            )
        )
        axes.plot([x - unit, x + unit], [y - 1.1 * unit] * 2, color=INK, lw=1, zorder=4)
    axes.add_patch(Circle((x, y), 0.32 * unit, facecolor="white", edgecolor=INK, lw=1.4, zorder=5))
