"""Drawing of the symbols for the supports and the actuation of shoes.

There are symbols for pin, lever's pivot, abutment, anchor, guide, grip, strut, cam and rigid arm.
"""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Rectangle

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import ShoeBodyOfConstantSection
from drumlin.brake.fields import Point
from drumlin.report.palette import BLUE, COLOR_OF_AXES_AND_NOTES, INK, RED

MM_PER_M = 1e3
"""Millimetres in a metre. Lengths of brakes are in metres, the axes of drawings in mm."""

# These are the colours of a brake's parts in drawings.
DRUM_COLOR = "#e6ebf0"
COLOR_OF_SHOE_BODY = "#aab6c2"
COLOR_OF_SHOE_BACKING = "#e3cfa4"
LINING_COLOR = "#c89b6a"
FORCE_COLOR = RED
COLOR_OF_MOTION_ARROW = BLUE


def draw_support_of_shoe(axes: Axes, shoe: Shoe, unit: float, *, on_strut: bool = False) -> None:
    """Draw the support of a shoe: its pin, pivot, abutment, anchors or guide.

    Parameters
    ----------
    axes : axes of the drawing
    shoe : the shoe
    unit : size of symbols that are not drawn to scale [mm]
    on_strut : whether the shoe's abutment is the end of a strut, which moves
    """
    if shoe.hinge is not None:
        draw_fixed_or_moving_pin(axes, shoe.hinge, unit, fixed=True)
    if shoe.pivot is not None:
        if shoe.hinge is not None:
            lever = np.array([shoe.hinge.xy, shoe.pivot.xy, shoe.actuation.point.xy])
            axes.plot(*lever.T * MM_PER_M, color=COLOR_OF_AXES_AND_NOTES, lw=3, alpha=0.5, zorder=2)
        draw_fixed_or_moving_pin(axes, shoe.pivot, unit, fixed=False)
    if shoe.abutment is not None:
        point = shoe.abutment.point.xy * MM_PER_M
        draw_abutment_face(axes, point, shoe.abutment.direction, unit, ground=not on_strut)
    for anchor in shoe.anchors:
        draw_abutment_face(axes, anchor.point.xy * MM_PER_M, anchor.direction, unit, ground=True)
    if shoe.guide is not None:
        _draw_guide_as_two_lines(axes, shoe.pin.xy * MM_PER_M, shoe.guide.direction, unit)


def _draw_guide_as_two_lines(axes: Axes, at: Floats, direction: float, unit: float) -> None:
    """Draw a guide as two lines in its direction [rad], one on each side of a point (2,) [mm]."""
    along = np.array([math.cos(direction), math.sin(direction)])
    for side in (-1.0, 1.0):
        across = side * 0.6 * unit * np.array([-along[1], along[0]])
        ends = at + across + np.outer([-1.2 * unit, 1.2 * unit], along)
        axes.plot(*ends.T, color=INK, lw=2.5, zorder=5)


def draw_abutment_face(
    axes: Axes, at: Floats, direction: float, unit: float, *, ground: bool
) -> None:
    """Draw the face of an abutment as a line.

    Parameters
    ----------
    axes : axes of the drawing
    at : point of the face (2,) [mm]
    direction : direction of the face's normal [rad]
    unit : size of symbols that are not drawn to scale [mm]
    ground : whether the face is fixed; a fixed face has hatching behind its line
    """
    normal = np.array([math.cos(direction), math.sin(direction)])
    tangent = np.array([-normal[1], normal[0]])
    line = at + np.outer([-unit, unit], tangent)
    axes.plot(*line.T, color=INK, lw=2.5, zorder=5)
    # Draw six short oblique lines behind a fixed face, and none behind a moving face.
    for place in np.linspace(-0.9, 0.9, 6 if ground else 0):
        foot = at + place * unit * tangent
        hatch = np.array([foot, foot - 0.45 * unit * (normal + tangent)])
        axes.plot(*hatch.T, color=COLOR_OF_AXES_AND_NOTES, lw=0.8, zorder=4)


class _DrawnRigidArm(NamedTuple):
    """A rigid arm between a shoe's body and a hinge, pivot or force beside the body.

    Attributes
    ----------
    middle : point of the body (2,) [m], in the shoe's own coordinates
    end : point of the hinge, pivot or force (2,) [mm], in the drawing's coordinates
    """

    middle: Floats
    end: Floats


def draw_rigid_arms_of_shoe(
    axes: Axes, shoe: Shoe, radius: float, force: Floats, unit: float
) -> None:
    """Draw the rigid arms of an elastic shoe as dashed lines, and the part of its back in a grip.

    A grip is a support that holds a part of the shoe's back. A rigid arm joins the shoe's body to a
    hinge, pivot or force at some distance from the body.

    Parameters
    ----------
    axes : axes of the drawing
    shoe : the shoe
    radius : radius of the drum, on a plane length of the first lining [m]
    force : point of the force (2,) [mm]
    unit : size of symbols that are not drawn to scale [mm]
    """
    if not isinstance(shoe.body, ShoeBodyOfConstantSection) or shoe.mesh is not None:
        return
    grip = shoe.interval_of_body_back_held_by_support(radius)
    depth = np.array(shoe.total_thickness)
    pin_at = shoe.pin.xy * MM_PER_M
    drawn: Sequence[_DrawnRigidArm]
    if grip is None:
        # Without a grip, the arms start at the two end faces of the body.
        held_face = shoe.middle_of_supported_or_loaded_end_face_of_body(radius)
        loaded_face = shoe.middle_of_supported_or_loaded_end_face_of_body(radius, loaded=True)
        drawn = [_DrawnRigidArm(held_face, pin_at), _DrawnRigidArm(loaded_face, force)]
    else:
        # With a grip, the arms start at the middle of the gripped part of the back.
        back = (
            shoe.convert_points_to_brake_frame(
                shoe.points_at_depth_and_coordinate_phi(depth, np.linspace(*grip, 20), radius)
            )
            * MM_PER_M
        )
        axes.plot(*back, color=INK, lw=3, solid_capstyle="butt", zorder=4)
        middle = shoe.points_at_depth_and_coordinate_phi(depth, np.array(0.5 * sum(grip)), radius)
        drawn = [_DrawnRigidArm(middle, pin_at), _DrawnRigidArm(middle, force)]
        if shoe.pivot is not None:
            drawn = [_DrawnRigidArm(middle, shoe.pivot.xy * MM_PER_M)]
    # An arm shorter than a fifth of `unit` is not drawn, because the symbol at its end would hide
    # it.
    for arm in drawn:
        start = shoe.convert_points_to_brake_frame(arm.middle[:, None])[:, 0] * MM_PER_M
        line = np.array([start, arm.end])
        if float(np.linalg.norm(line[1] - line[0])) > 0.2 * unit:
            axes.plot(*line.T, color=INK, lw=1.6, ls="--", zorder=4)


def draw_struts_and_cam(
    axes: Axes, brake: Brake, loaded: Mapping[str, Floats], unit: float
) -> None:
    """Draw the struts from shoe to shoe, and the cam between the loaded ends of two shoes.

    Parameters
    ----------
    axes : axes of the drawing
    brake : the brake
    loaded : point (2,) [mm] where the force on each shoe is drawn, by the name of the shoe
    unit : size of symbols that are not drawn to scale [mm]
    """
    shoes = {shoe.name: shoe for shoe in brake.shoes}
    for link in brake.links:
        source, to = shoes[link.source], shoes[link.to]
        assert source.abutment is not None
        # A strut begins at the abutment of one shoe. It ends at the abutment of the other shoe if
        # the other shoe has anchors, else at the other shoe's loaded end.
        end = loaded[link.to]
        if to.anchors and to.abutment is not None:
            end = to.abutment.point.xy * MM_PER_M
        ends = np.array([source.abutment.point.xy * MM_PER_M, end])
        axes.plot(*ends.T, color=INK, lw=5, solid_capstyle="butt", zorder=4)
    # The cam is drawn as a disc at the middle between the loaded ends of the two actuated shoes.
    if brake.actuation is not None and brake.actuation.is_cam_or_wedge:
        tips = [loaded[shoe.name] for shoe in brake.shoes if shoe.actuation.force]
        axes.plot(*np.array(tips).T, color=INK, lw=5, solid_capstyle="butt", zorder=4)
        middle = tuple(0.5 * (tips[0] + tips[1]))
        radius = max((brake.actuation.radius or 0.0) * MM_PER_M, 0.5 * unit)
        axes.add_patch(
            Circle(middle, radius, facecolor=COLOR_OF_SHOE_BODY, edgecolor=INK, zorder=5)
        )


def draw_fixed_or_moving_pin(axes: Axes, point: Point, unit: float, *, fixed: bool) -> None:
    """Draw a pin as a small circle. A fixed pin stands on a triangle on hatched ground."""
    x, y = point.xy * MM_PER_M
    if fixed:
        left, right, base = x - 0.7 * unit, x + 0.7 * unit, y - 1.1 * unit
        foot = np.array([[x, y], [left, base], [right, base], [x, y]])
        axes.fill(*foot.T, facecolor="white", edgecolor=INK, lw=1, zorder=4)
        ground = Rectangle(
            (x - unit, y - 1.45 * unit),
            2 * unit,
            0.35 * unit,
            facecolor="none",
            edgecolor=COLOR_OF_AXES_AND_NOTES,
            hatch="////",
            lw=0,
            zorder=4,
        )
        axes.add_patch(ground)
        axes.plot([x - unit, x + unit], [base] * 2, color=INK, lw=1, zorder=4)
    axes.add_patch(Circle((x, y), 0.32 * unit, facecolor="white", edgecolor=INK, lw=1.4, zorder=5))
