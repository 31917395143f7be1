"""A brake as a drawing by matplotlib: drum, shoes, pins and forces to scale, axes in mm.

Parts whose size a brake file does not give are drawn as symbols, not to scale: a rigid shoe as a
grey line, a force as an arrow of fixed length.
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, FancyArrowPatch, PathPatch, Rectangle, Wedge
from matplotlib.path import Path as Outline

from drumlin.base.arrays import Floats
from drumlin.brake.beam_axis import make_beam_axis
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Actuation, BeamBody, ShoeBodyOfConstantSection
from drumlin.report.palette import COLOR_OF_AXES_AND_NOTES, INK
from drumlin.report.signs import (
    COLOR_OF_MOTION_ARROW,
    COLOR_OF_SHOE_BACKING,
    COLOR_OF_SHOE_BODY,
    DRUM_COLOR,
    FORCE_COLOR,
    LINING_COLOR,
    MM_PER_M,
    draw_rigid_arms_of_shoe,
    draw_struts_and_cam,
    draw_support_of_shoe,
)


def draw_brake(axes: Axes, brake: Brake) -> None:
    """Draw a brake on a drum or a plane into `axes`, in mm and at equal scales of x and y."""
    if brake.surface.is_plane_and_not_drum:
        _draw_plane_brake(axes, brake)
    else:
        _draw_drum_brake(axes, brake)
    axes.set_aspect("equal")
    axes.grid(False)
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("y [mm]")


def _unit_vector_at_angle(angle: float) -> Floats:
    """The unit vector (2,) at an angle [rad] from the x axis."""
    return np.array([math.cos(angle), math.sin(angle)])


# The functions below draw brakes on a drum. R is the drum's radius [mm]. `unit` [mm] is the size of
# symbols that are not drawn to scale.


def _names_of_shoes_whose_abutment_is_a_strut(brake: Brake) -> set[str]:
    """The names of the shoes whose abutment is the end of a strut, not a fixed face."""
    ends = {link.to for link in brake.links} - brake.names_of_shoes_pushed_by_struts
    return ends | {link.source for link in brake.links}


def _draw_drum_brake(axes: Axes, brake: Brake) -> None:
    """Draw a brake on a drum, and set the limits of the axes."""
    R = brake.size * MM_PER_M
    unit = R / 10
    _draw_drum_with_rotation_arrow(axes, brake, R, unit)
    struts = _names_of_shoes_whose_abutment_is_a_strut(brake)
    for shoe in brake.shoes:
        _draw_shoe_on_drum(axes, shoe, R, unit, on_strut=shoe.name in struts)
    loaded = {shoe.name: _point_where_force_is_drawn(shoe, R) for shoe in brake.shoes}
    draw_struts_and_cam(axes, brake, loaded, unit)
    tips = {shoe.name: _tip_of_force_arrow(shoe, R, unit) for shoe in brake.shoes}
    _draw_force_arrows_with_labels(axes, brake, tips, unit)
    # The axes must hold the drum, the shoes, the force arrows with their labels, and the pins.
    corners = np.array([[-1.0, -1.0], [1.0, 1.0]]) * _outer_radius_of_brake(brake)
    points = [corners]
    for shoe in brake.shoes:
        points += [
            _extreme_points_of_force_arrow(shoe.actuation, tips[shoe.name], unit),
            _corners_of_box_around_pin(shoe, unit),
        ]
    _set_axes_limits_around_points(axes, np.concatenate(points), 1.8 * unit)


def _outer_radius_of_brake(brake: Brake) -> float:
    """The radius [mm] of the circle that just encloses drum, ring and external shoes."""
    ring = _thickness_of_drum_ring(brake)
    outside = any(shoe.side == "internal" for shoe in brake.shoes) and ring
    depth = max(
        (shoe.total_thickness for shoe in brake.shoes if shoe.side == "external"), default=0.0
    )
    return (brake.size + max(outside, depth)) * MM_PER_M


def _thickness_of_drum_ring(brake: Brake) -> float:
    """The thickness [m] of the drum's ring; a tenth of the drum's radius if it is not given."""
    ring = brake.ring
    return ring.thickness if ring and ring.thickness else 0.1 * brake.size


def _draw_drum_with_rotation_arrow(axes: Axes, brake: Brake, R: float, unit: float) -> None:
    """Draw the drum: ring, centre, a line labelled with the radius, and the rotation's arrow."""
    ring = _thickness_of_drum_ring(brake) * MM_PER_M
    look = {"facecolor": DRUM_COLOR, "edgecolor": "none"}
    if brake.shoes[0].side == "internal":
        axes.add_patch(Wedge((0, 0), R + ring, 0, 360, width=ring, **look))
    elif brake.ring:
        axes.add_patch(Wedge((0, 0), R, 0, 360, width=ring, **look))
    else:
        axes.add_patch(Circle((0, 0), R, **look))
    axes.add_patch(Circle((0, 0), R, facecolor="none", edgecolor=INK, lw=1.6))
    # Draw a cross at the drum's centre.
    cross = np.array([-0.35, 0.35]) * unit
    axes.plot(cross, [0, 0], color=INK, lw=0.8)
    axes.plot([0, 0], cross, color=INK, lw=0.8)
    # Draw a line from the centre to the friction surface, labelled with the radius.
    direction = _unit_vector_at_angle(_free_angle_for_radius_line(brake, R, unit))
    axes.plot([0, R * direction[0]], [0, R * direction[1]], color=COLOR_OF_AXES_AND_NOTES, lw=0.7)
    _write_text_on_pale_box(axes, 0.5 * R * direction, f"R = {R:.5g} mm")
    _draw_rotation_arrow(axes, brake.sign_of_motion, 2.6 * unit)


def _draw_rotation_arrow(axes: Axes, spin: int, radius: float) -> None:
    """Draw an arc of 220 degrees with an arrowhead about the drum's centre; `radius` is in mm."""
    reach = math.radians(220)
    start = math.pi / 2 - spin * reach / 2
    angles = start + spin * np.linspace(0, reach, 60)
    # The last three points lie within the arrowhead and are left out.
    line = angles[:-3]
    axes.plot(
        radius * np.cos(line),
        radius * np.sin(line),
        color=COLOR_OF_MOTION_ARROW,
        lw=2,
        solid_capstyle="round",
    )
    tip, back = (
        radius * _unit_vector_at_angle(angles[-1]),
        radius * _unit_vector_at_angle(angles[-8]),
    )
    draw_arrow_from_tail_to_tip(axes, back, tip, COLOR_OF_MOTION_ARROW, width=0.1)


def _free_angle_for_radius_line(brake: Brake, R: float, unit: float) -> float:
    """The angle [rad] at which the radius line is farthest from shoes' ends, names and forces."""
    taken = []
    for shoe in brake.shoes:
        tip = _point_where_force_is_drawn(shoe, R)
        tail = tip - _vector_of_force_arrow(shoe.actuation, unit)
        taken += [shoe.lining.start, shoe.lining.end, 0.5 * (shoe.lining.start + shoe.lining.end)]
        taken += [math.atan2(tip[1], tip[0]), math.atan2(tail[1], tail[0])]
    candidates = np.radians(np.arange(-60, 300, 5) + 2.0)
    # For each candidate angle, find its distance from the nearest angle that is occupied.
    away = []
    for candidate in candidates:
        away.append(min(abs(math.remainder(candidate - t, 2 * math.pi)) for t in taken))
    return float(candidates[int(np.argmax(away))])


def _draw_shoe_on_drum(axes: Axes, shoe: Shoe, R: float, unit: float, *, on_strut: bool) -> None:
    """Draw a shoe of a drum brake with its layers, its name and its support.

    Parameters
    ----------
    axes : axes of the drawing
    shoe : the shoe
    R : radius of the drum [mm]
    unit : size of symbols that are not drawn to scale [mm]
    on_strut : whether the shoe's abutment is the end of a strut
    """
    if shoe.body is None:
        _draw_rigid_shoe_on_drum(axes, shoe, R)
    arcs = [(math.degrees(start), math.degrees(end)) for start, end in shoe.lining.arcs]
    depth = shoe.lining.thickness * MM_PER_M
    for arc in arcs:
        _draw_layer_as_ring_segment(axes, shoe, R, _DrawnShoeLayer(0.0, depth, arc, LINING_COLOR))
    # A shoe with a mesh file is drawn without body, since only the mesh knows its shape. `depth`
    # grows from the friction surface through the layers.
    if shoe.mesh is None:
        if isinstance(shoe.body, BeamBody):
            _draw_straight_beam_of_shoe(axes, shoe, R, unit)
        elif shoe.backing is not None:
            backing = shoe.backing.thickness * MM_PER_M
            for arc in arcs:
                _draw_layer_as_ring_segment(
                    axes, shoe, R, _DrawnShoeLayer(depth, backing, arc, COLOR_OF_SHOE_BACKING)
                )
            depth += backing
        if isinstance(shoe.body, ShoeBodyOfConstantSection):
            body_arc = math.degrees(shoe.body.start), math.degrees(shoe.body.end)
            for plate in shoe.body.plates.values():
                thickness = plate.thickness * MM_PER_M
                _draw_layer_as_ring_segment(
                    axes, shoe, R, _DrawnShoeLayer(depth, thickness, body_arc, COLOR_OF_SHOE_BODY)
                )
                depth += thickness
    draw_support_of_shoe(axes, shoe, unit, on_strut=on_strut)
    draw_rigid_arms_of_shoe(axes, shoe, R / MM_PER_M, _point_where_force_is_drawn(shoe, R), unit)
    # The name is written inside the drum; for an internal shoe, between the shoe and the drum's
    # centre.
    middle = 0.5 * (shoe.lining.start + shoe.lining.end)
    inside = (
        R
        - 1.8 * unit
        - (shoe.total_thickness * MM_PER_M if shoe.sign_internal_plus_external_minus > 0 else 0.0)
    )
    _write_text_on_pale_box(axes, inside * _unit_vector_at_angle(middle), shoe.name)


def _draw_rigid_shoe_on_drum(axes: Axes, shoe: Shoe, R: float) -> None:
    """Draw the thick grey lines that stand for a rigid shoe."""
    for stroke in _rigid_shoe_lines(shoe, R):
        axes.plot(
            *stroke.T,
            color=COLOR_OF_SHOE_BODY,
            lw=7,
            solid_capstyle="round",
            solid_joinstyle="round",
            zorder=2,
        )


def _draw_straight_beam_of_shoe(axes: Axes, shoe: Shoe, R: float, unit: float) -> None:
    """Draw the straight beam of a shoe, and the block between the beam and the lining's back."""
    assert isinstance(shoe.body, BeamBody)
    axis = make_beam_axis(shoe.pin.xy * MM_PER_M, shoe.actuation.point.xy * MM_PER_M)
    half = 0.5 * (shoe.body.thickness * MM_PER_M if shoe.body.thickness else unit)
    # The block has an arc on the lining's side and a straight edge along the beam.
    for ends in shoe.lining.arcs if shoe.backing is not None else ():
        angle = axis.angle(np.linspace(*ends, 60))
        back = R + shoe.lining.thickness * MM_PER_M
        x, y = (
            axis.x_of_perpendicular_foot + back * np.sin(angle),
            axis.distance_from_drum_centre - back * np.cos(angle),
        )
        block = axis.convert_beam_coordinates_to_brake_points(
            np.append(x, x[[-1, 0]]), np.append(y, [half, half])
        )
        axes.fill(*block.T, facecolor=COLOR_OF_SHOE_BACKING, edgecolor=INK, lw=0.8, zorder=2)
    corners = axis.convert_beam_coordinates_to_brake_points(
        np.array([0, 1, 1, 0]) * axis.length, np.array([-1, -1, 1, 1]) * half
    )
    axes.fill(*corners.T, facecolor=COLOR_OF_SHOE_BODY, edgecolor=INK, lw=0.8, zorder=2)


class _DrawnShoeLayer(NamedTuple):
    """A layer of a shoe to draw, such as the lining.

    Attributes
    ----------
    depth : distance of the layer's front from the friction surface [mm]
    thickness : thickness of the layer [mm]
    arc : the layer's two ends [deg; on a plane mm]
    color : fill colour of the layer
    """

    depth: float
    thickness: float
    arc: tuple[float, float]
    color: str


def _draw_layer_as_ring_segment(axes: Axes, shoe: Shoe, R: float, layer: _DrawnShoeLayer) -> None:
    """Draw a layer of a shoe on the drum as part of a circular ring."""
    outer = (
        R - layer.depth
        if shoe.sign_internal_plus_external_minus > 0
        else R + layer.depth + layer.thickness
    )
    wedge = Wedge(
        (0, 0),
        outer,
        *layer.arc,
        width=layer.thickness,
        facecolor=layer.color,
        edgecolor=INK,
        lw=0.8,
        zorder=3,
    )
    axes.add_patch(wedge)


def _radius_of_rigid_shoe_back(shoe: Shoe, R: float) -> float:
    """The radius [mm] of the arc that stands for a rigid shoe behind its lining."""
    return R - shoe.sign_internal_plus_external_minus * (
        shoe.lining.thickness * MM_PER_M + 0.035 * R
    )


def _rigid_shoe_lines(shoe: Shoe, R: float) -> list[Floats]:
    """The lines (n, 2) [mm] that stand for a rigid shoe on a drum.

    The first line is an arc behind the lining. For a shoe with a lever, two more lines are the
    lever and its connection to the arc. For other shoes, two more lines join the arc to the hinge
    and to the force.
    """
    angles = np.linspace(shoe.lining.start, shoe.lining.end, 80)
    back = _radius_of_rigid_shoe_back(shoe, R) * np.column_stack([np.cos(angles), np.sin(angles)])
    middle = back[40]
    hinge, load = shoe.pin.xy * MM_PER_M, _point_where_force_is_drawn(shoe, R)
    if shoe.pivot is not None:
        pivot = shoe.pivot.xy * MM_PER_M
        return [back, np.array([middle, pivot]), np.array([hinge, pivot, load])]
    # An external shoe has a lever along the straight line from hinge to force, if this line passes
    # outside the drum.
    clear = np.linalg.norm(np.linspace(hinge, load, 50), axis=1)
    if np.all(clear > R) and shoe.sign_internal_plus_external_minus < 0:
        foot = _point_of_lever_nearest_to_given_point(hinge, load, middle)
        return [back, np.array([hinge, load]), np.array([middle, foot])]
    # For other shoes, the end of the arc near the hinge is joined to the hinge, the other end to
    # the force.
    near, far = back[0], back[-1]
    if np.linalg.norm(back[0] - hinge) > np.linalg.norm(back[-1] - hinge):
        near, far = far, near
    return [back, np.array([hinge, near]), np.array([far, load])]


def _point_of_lever_nearest_to_given_point(hinge: Floats, load: Floats, point: Floats) -> Floats:
    """The point (2,) [mm] of the lever from `hinge` to `load` that is nearest to a point (2,)."""
    lever = load - hinge
    along = 0.0
    if lever.any():
        along = float(np.clip((point - hinge) @ lever / (lever @ lever), 0.0, 1.0))
    return hinge + along * lever


def _point_where_force_is_drawn(shoe: Shoe, R: float) -> Floats:
    """The point (2,) [mm] where the force on a shoe is drawn.

    On an external shoe it is the force's point in the brake file if this point lies outside the
    drum. On all other shoes it is the point of the force's line of action that is nearest to the
    far end, the shoe's end away from the pin. If the other shoe is rigid and external, it is the
    point near the far end where the line of action cuts the arc of the shoe's back.
    """
    point = shoe.actuation.point.xy * MM_PER_M
    if shoe.sign_internal_plus_external_minus < 0 and np.linalg.norm(point) > R:
        return point
    # Find the shoe's end that is farther from the pin, at the middle of the body's depth.
    half = (
        0.5 * shoe.body.total_thickness if isinstance(shoe.body, ShoeBodyOfConstantSection) else 0.0
    )
    radius = R - shoe.sign_internal_plus_external_minus * (shoe.total_thickness - half) * MM_PER_M
    arc = shoe.body if isinstance(shoe.body, ShoeBodyOfConstantSection) else shoe.lining
    ends = [radius * _unit_vector_at_angle(angle) for angle in (arc.start, arc.end)]
    far = max(ends, key=lambda end: float(np.linalg.norm(end - shoe.pin.xy * MM_PER_M)))
    along = _unit_vector_at_angle(shoe.actuation.direction)
    nearest = point + ((far - point) @ along) * along
    # `reach` is the square of half the chord that the line of action cuts from the circle of the
    # back; it is negative if the line misses the circle.
    middle = point - (point @ along) * along
    reach = _radius_of_rigid_shoe_back(shoe, R) ** 2 - middle @ middle
    if shoe.sign_internal_plus_external_minus > 0 or shoe.body or reach < 0:
        return np.asarray(nearest)
    return np.asarray(middle + math.copysign(math.sqrt(reach), (far - middle) @ along) * along)


def _tip_of_force_arrow(shoe: Shoe, R: float, unit: float) -> Floats:
    """The tip (2,) [mm] of the arrow that shows the force on a shoe.

    The arrow's tip is at the point where the force acts. If the force on an external shoe points
    away from the lining, the arrow's tail is at this point instead.
    """
    load, arrow = _point_where_force_is_drawn(shoe, R), _vector_of_force_arrow(shoe.actuation, unit)
    middle = R * _unit_vector_at_angle(shoe.lining.middle)
    return (
        load + arrow
        if shoe.sign_internal_plus_external_minus < 0 and (load - middle) @ arrow > 0
        else load
    )


def _corners_of_box_around_pin(shoe: Shoe, unit: float) -> Floats:
    """Lower left and upper right corner (2, 2) [mm] of a box around the symbol of a shoe's pin."""
    return shoe.pin.xy * MM_PER_M + np.array([[-1.2, -1.6], [1.2, 1.6]]) * unit


# The functions below draw brakes on a plane.


def _draw_plane_brake(axes: Axes, brake: Brake) -> None:
    """Draw a brake on a plane, and set the limits of the axes."""
    ends: list[float] = []
    for shoe in brake.shoes:
        ends += [shoe.pin.x, shoe.actuation.point.x, shoe.lining.start, shoe.lining.end]
    left, right = min(ends) * MM_PER_M, max(ends) * MM_PER_M
    # Symbols that are not to scale have the size `unit`, a twentieth of the brake's length. The
    # plane reaches two units beyond the brake.
    unit = (right - left) / 20
    left, right = left - 2 * unit, right + 2 * unit
    _draw_plane_with_motion_arrow(axes, (left, right), brake.sign_of_motion, unit)
    struts = _names_of_shoes_whose_abutment_is_a_strut(brake)
    loads = {shoe.name: shoe.actuation.point.xy * MM_PER_M for shoe in brake.shoes}
    _draw_force_arrows_with_labels(axes, brake, loads, unit)
    is_elastic = brake.reason_why_shoes_cannot_be_meshed() is None
    places = [np.array([[left, -2 * unit], [right, 0]])]
    for shoe in brake.shoes:
        load = loads[shoe.name]
        _draw_shoe_on_plane(axes, shoe, unit, on_strut=shoe.name in struts)
        if is_elastic:
            draw_rigid_arms_of_shoe(axes, shoe, brake.size, load, unit)
        places += [
            _extreme_points_of_force_arrow(shoe.actuation, load, unit),
            _corners_of_box_around_pin(shoe, unit),
        ]
    _set_axes_limits_around_points(axes, np.concatenate(places), 2 * unit)


def _draw_plane_with_motion_arrow(
    axes: Axes, ends: tuple[float, float], spin: int, unit: float
) -> None:
    """Draw the plane between two ends x [mm], and the arrow of its motion."""
    left, right = ends
    depth = 2 * unit
    ground = Rectangle((left, -depth), right - left, depth, facecolor=DRUM_COLOR, edgecolor="none")
    axes.add_patch(ground)
    axes.plot([left, right], [0, 0], color=INK, lw=1.6)
    middle, half = 0.5 * (left + right), 2.2 * unit * spin
    tail, tip = np.array([middle - half, -unit]), np.array([middle + half, -unit])
    draw_arrow_from_tail_to_tip(axes, tail, tip, COLOR_OF_MOTION_ARROW, width=0.14)


def _draw_shoe_on_plane(axes: Axes, shoe: Shoe, unit: float, *, on_strut: bool) -> None:
    """Draw a shoe on a plane: its layers, name and support, and the height of its hinge."""
    if isinstance(shoe.body, ShoeBodyOfConstantSection) and shoe.lining.thickness is not None:
        _draw_layers_of_shoe_on_plane(axes, shoe, shoe.body)
    else:
        _draw_rigid_shoe_on_plane(axes, shoe, unit)
    draw_support_of_shoe(axes, shoe, unit, on_strut=on_strut)
    end = shoe.lining.end * MM_PER_M
    _write_text_on_pale_box(axes, np.array([end + 1.2 * unit, 1.0 * unit]), shoe.name, ha="left")
    if shoe.hinge is not None and shoe.pivot is None:
        x, height = shoe.hinge.xy * MM_PER_M
        arrow = {"arrowstyle": "<->", "color": COLOR_OF_AXES_AND_NOTES, "lw": 0.8}
        axes.annotate("", (x, 0), (x, height), arrowprops=arrow, zorder=4)
        _write_text_on_pale_box(
            axes, np.array([x - 1.6 * unit, 0.4 * height]), f"h = {height:.4g} mm"
        )


def _draw_layers_of_shoe_on_plane(axes: Axes, shoe: Shoe, body: ShoeBodyOfConstantSection) -> None:
    """Draw the layers of an elastic shoe on a plane: lining, block and plates of the body."""
    lining = shoe.lining.start * MM_PER_M, shoe.lining.end * MM_PER_M
    layers = [_DrawnShoeLayer(0.0, shoe.lining.thickness * MM_PER_M, lining, LINING_COLOR)]
    # A shoe with a mesh file is drawn as a lining only, since only the mesh knows its shape.
    if shoe.mesh is None:
        top = layers[0].thickness
        if shoe.backing:
            layers.append(
                _DrawnShoeLayer(
                    top, shoe.backing.thickness * MM_PER_M, lining, COLOR_OF_SHOE_BACKING
                )
            )
            top += layers[-1].thickness
        ends = body.start * MM_PER_M, body.end * MM_PER_M
        for plate in body.plates.values():
            layers.append(
                _DrawnShoeLayer(top, plate.thickness * MM_PER_M, ends, COLOR_OF_SHOE_BODY)
            )
            top += layers[-1].thickness
    for layer in layers:
        left, right = layer.arc
        box = Rectangle(
            (left, layer.depth),
            right - left,
            layer.thickness,
            facecolor=layer.color,
            edgecolor=INK,
            lw=0.8,
            zorder=3,
        )
        axes.add_patch(box)


def _draw_rigid_shoe_on_plane(axes: Axes, shoe: Shoe, unit: float) -> None:
    """Draw a rigid shoe on a plane: its lining, its lever, and a block between the two."""
    start, end = shoe.lining.start * MM_PER_M, shoe.lining.end * MM_PER_M
    top = 0.8 * unit
    pin, load = shoe.pin.xy * MM_PER_M, shoe.actuation.point.xy * MM_PER_M
    lining = Rectangle(
        (start, 0), end - start, top, facecolor=LINING_COLOR, edgecolor=INK, lw=0.8, zorder=3
    )
    axes.add_patch(lining)
    # The block's upper corners are the points of the lever above the lining's ends.
    lever = load - pin
    share = np.zeros(2)
    if lever[0]:
        share = np.clip((np.array([start, end]) - pin[0]) / lever[0], 0, 1)
    feet = pin + share[:, None] * lever
    block = [(start, top), *feet.tolist(), (end, top)]
    outline = Outline(np.array([*block, block[0]]))
    axes.add_patch(PathPatch(outline, facecolor=COLOR_OF_SHOE_BODY, edgecolor="none", zorder=2))
    line = np.array([pin, load])
    axes.plot(*line.T, color=COLOR_OF_SHOE_BODY, lw=7, solid_capstyle="round", zorder=2)


# The functions below draw forces and the labels beside them.


def _vector_of_force_arrow(actuation: Actuation, unit: float) -> Floats:
    """The vector (2,) [mm] from tail to tip of a force's arrow, with the length 4 * unit."""
    sense = -1.0 if actuation.force < 0 else 1.0
    return 4 * unit * sense * _unit_vector_at_angle(actuation.direction)


class _ForceLabel(NamedTuple):
    """The label of a force arrow: its place (2,) [mm], text, and alignment for matplotlib."""

    place: Floats
    text: str
    alignment: str


def _label_of_force_arrow(
    actuation: Actuation, tip: Floats, unit: float, *, inside: bool = False
) -> _ForceLabel:
    """The label with the size of a force, placed beside the force's arrow.

    The label stands above the arrow or at its right, or towards the drum's centre with `inside`.

    Parameters
    ----------
    actuation : the force
    tip : tip of the force's arrow (2,) [mm]
    unit : size of symbols that are not drawn to scale [mm]
    inside : whether the label stands on the arrow's side that faces the drum's centre
    """
    along = _vector_of_force_arrow(actuation, unit)
    left = np.array([-along[1], along[0]]) / np.linalg.norm(along)
    is_up = left[1] > 1e-9 or (abs(left[1]) <= 1e-9 and left[0] > 0)
    up = left if is_up else -left
    if inside and up @ tip > 0:
        up = -up
    place = tip - 0.75 * along + 0.95 * unit * up
    alignment = "left" if abs(up[1]) < 0.5 else "center"
    return _ForceLabel(place, absolute_force_as_text_with_unit(actuation.force), alignment)


def _draw_force_arrows_with_labels(
    axes: Axes, brake: Brake, tips: Mapping[str, Floats], unit: float
) -> None:
    """Draw an arrow and a label for each actuation force; forces of struts get no arrow.

    For a cam no arrows are drawn, but one label with the sum of its forces. Equal forces close to
    each other share one label.

    Parameters
    ----------
    axes : axes of the drawing
    brake : the brake
    tips : tip of each force's arrow (2,) [mm], by the name of the shoe
    unit : size of symbols that are not drawn to scale [mm]
    """
    pushed = [shoe for shoe in brake.shoes if shoe.actuation.force]
    if brake.actuation is not None and brake.actuation.is_cam_or_wedge:
        middle = 0.5 * sum(tips[shoe.name] for shoe in pushed)
        force = brake.actuation.force_of_cylinder_or_sum_of_cam_forces
        text = f"{absolute_force_as_text_with_unit(force)} in all"
        _write_text_on_pale_box(axes, middle - np.array([0.0, 1.6 * unit]), text, color=FORCE_COLOR)
        return
    # Labels of the forces on internal shoes stand on the side of the arrow that faces the drum's
    # centre.
    inside = (
        not brake.surface.is_plane_and_not_drum
        and brake.shoes[0].sign_internal_plus_external_minus > 0
    )
    labels: list[_ForceLabel] = []
    for shoe in pushed:
        tip = tips[shoe.name]
        tail = tip - _vector_of_force_arrow(shoe.actuation, unit)
        draw_arrow_from_tail_to_tip(axes, tail, tip, FORCE_COLOR, width=0.12)
        _add_or_merge_force_label(
            labels, _label_of_force_arrow(shoe.actuation, tip, unit, inside=inside), 5 * unit
        )
    for label in labels:
        _write_text_on_pale_box(
            axes, label.place, label.text, color=FORCE_COLOR, ha=label.alignment
        )


def _add_or_merge_force_label(labels: list[_ForceLabel], new: _ForceLabel, reach: float) -> None:
    """Add a new label to the list of labels.

    If the list has a label with the same text nearer than `reach` [mm], a single label with the
    word "each" replaces the two labels. It stands at the middle between them.
    """
    for k, label in enumerate(labels):
        if label.text == new.text and math.dist(label.place, new.place) < reach:
            place = 0.5 * (label.place + new.place)
            labels[k] = _ForceLabel(place, f"{new.text} each", new.alignment)
            return
    labels.append(new)


def absolute_force_as_text_with_unit(force: float) -> str:
    """The absolute value of a force [N] as text, in kN if it is at least 1 kN, else in N."""
    return f"{abs(force) / 1e3:.4g} kN" if abs(force) >= 1e3 else f"{abs(force):.4g} N"


def _extreme_points_of_force_arrow(actuation: Actuation, tip: Floats, unit: float) -> Floats:
    """Points (3, 2) [mm] of a force's arrow and label that must lie within the picture."""
    label = _label_of_force_arrow(actuation, tip, unit)
    words = np.array([3 * unit if label.alignment == "left" else 0.0, 0.0])
    return np.array([tip, tip - _vector_of_force_arrow(actuation, unit), label.place + words])


def draw_arrow_from_tail_to_tip(
    axes: Axes, tail: Floats, tip: Floats, color: str, width: float
) -> None:
    """Draw an arrow from tail (2,) to tip (2,) [mm].

    `width` is the width of its line in units of 20 points.
    """
    arrow = FancyArrowPatch(
        tuple(tail),
        tuple(tip),
        arrowstyle="-|>,head_length=0.45,head_width=0.22",
        mutation_scale=22,
        color=color,
        lw=20 * width,
        shrinkA=0,
        shrinkB=0,
        zorder=6,
    )
    axes.add_patch(arrow)


def _write_text_on_pale_box(
    axes: Axes, place: Floats, text: str, color: str = INK, **style: Any
) -> None:
    """Write a text at a place (2,) [mm] on a pale box; `style` holds options of `Axes.text`."""
    style = {"ha": "center", "va": "center"} | style
    box = {"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none", "alpha": 0.75}
    axes.text(place[0], place[1], text, color=color, fontsize=8.5, bbox=box, zorder=7, **style)


def _set_axes_limits_around_points(axes: Axes, points: Floats, margin: float) -> None:
    """Set the limits of the axes to hold all points (n, 2) [mm] with a margin [mm] around them."""
    low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
