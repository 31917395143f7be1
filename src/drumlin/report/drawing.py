"""A brake as a drawing by matplotlib: drum, shoes, pins and forces to scale, axes in mm.

What a brake file leaves out is drawn as a sign, not to scale: a rigid shoe as a grey stroke, a
force as an arrow of fixed length.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, FancyArrowPatch, PathPatch, Rectangle, Wedge
from matplotlib.path import Path as Outline

from drumlin.base.arrays import Floats
from drumlin.brake.beam_axis import axis_of
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Actuation, Bar, Beam
from drumlin.report.signs import (
    BLOCK,
    BODY,
    DRUM,
    FAINT,
    FORCE,
    INK,
    LINING,
    MM,
    MOTION,
    arms,
    between,
    held,
)


def draw_brake(axes: Axes, brake: Brake) -> None:
    """Draw a brake of either kind into `axes`, which become mm at equal scale."""
    if brake.surface.straight:
        _draw_flat(axes, brake)
    else:
        _draw_drum_brake(axes, brake)
    axes.set_aspect("equal")
    axes.grid(False)
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("y [mm]")


# on a drum


def _draw_drum_brake(axes: Axes, brake: Brake) -> None:
    R = brake.size * MM
    unit = R / 10  # of signs that have no size of their own
    _drum(axes, brake, unit)
    struts = {link.source for link in brake.links}
    for shoe in brake.shoes:
        _shoe(axes, shoe, R, unit, on_strut=shoe.name in struts)
    loaded = {shoe.name: _loaded_point(shoe, R) for shoe in brake.shoes}
    between(axes, brake, loaded, unit)
    _forces(axes, brake, {shoe.name: _tip(shoe, R, unit) for shoe in brake.shoes}, unit)
    corners = np.array([[-1.0, -1.0], [1.0, 1.0]]) * _outermost(brake)
    points = [corners, *(_places(shoe, R, unit) for shoe in brake.shoes)]
    _frame(axes, np.concatenate(points), 1.8 * unit)


def _outermost(brake: Brake) -> float:
    """Radius [mm] of everything round in the brake."""
    ring = _ring_depth(brake)
    outside = any(shoe.side == "internal" for shoe in brake.shoes) and ring
    depth = max((shoe.depth for shoe in brake.shoes if shoe.side == "external"), default=0.0)
    return (brake.size + max(outside, depth)) * MM


def _ring_depth(brake: Brake) -> float:
    """Thickness [m] of the ring; without one, or where the file does not say, a tenth of the
    radius.
    """
    ring = brake.ring
    return ring.thickness if ring and ring.thickness else 0.1 * brake.size


def _drum(axes: Axes, brake: Brake, unit: float) -> None:
    R = brake.size * MM
    ring = _ring_depth(brake) * MM
    if brake.shoes[0].side == "internal":
        axes.add_patch(
            Wedge((0, 0), R + ring, 0, 360, width=ring, facecolor=DRUM, edgecolor="none")
        )
    elif brake.ring:
        axes.add_patch(Wedge((0, 0), R, 0, 360, width=ring, facecolor=DRUM, edgecolor="none"))
    else:
        axes.add_patch(Circle((0, 0), R, facecolor=DRUM, edgecolor="none"))
    axes.add_patch(Circle((0, 0), R, facecolor="none", edgecolor=INK, lw=1.6))
    cross = np.array([-0.35, 0.35]) * unit
    axes.plot(cross, [0, 0], color=INK, lw=0.8)
    axes.plot([0, 0], cross, color=INK, lw=0.8)
    free = _free_angle(brake, unit)
    axes.plot([0, R * math.cos(free)], [0, R * math.sin(free)], color=FAINT, lw=0.7)
    _label(axes, 0.5 * R * np.array([math.cos(free), math.sin(free)]), f"R = {R:.5g} mm")
    turn, reach = 2.6 * unit, math.radians(220)
    start = math.pi / 2 - brake.spin * reach / 2
    angles = start + brake.spin * np.linspace(0, reach, 60)
    axes.plot(
        turn * np.cos(angles[:-3]),
        turn * np.sin(angles[:-3]),
        color=MOTION,
        lw=2,
        solid_capstyle="round",
    )
    tip, back = (turn * np.array([math.cos(a), math.sin(a)]) for a in (angles[-1], angles[-8]))
    _arrow(axes, back, tip, MOTION, width=0.1)


def _free_angle(brake: Brake, unit: float) -> float:
    """An angle [rad] for the drum's radius that keeps away from the shoes' names, ends and forces."""
    taken = []
    for shoe in brake.shoes:
        tip = _loaded_point(shoe, brake.size * MM)
        tail = tip - _tail(shoe.actuation, unit)
        taken += [shoe.lining.start, shoe.lining.end, 0.5 * (shoe.lining.start + shoe.lining.end)]
        taken += [math.atan2(y, x) for x, y in (tip, tail)]
    candidates = np.radians(np.arange(-60, 300, 5) + 2.0)
    away = [min(abs(math.remainder(c - e, 2 * math.pi)) for e in taken) for c in candidates]
    return float(candidates[int(np.argmax(away))])


def _shoe(axes: Axes, shoe: Shoe, R: float, unit: float, *, on_strut: bool) -> None:
    start, end = (math.degrees(angle) for angle in (shoe.lining.start, shoe.lining.end))
    if shoe.body is None:
        for stroke in _strokes(shoe, R):
            axes.plot(
                *stroke.T,
                color=BODY,
                lw=7,
                solid_capstyle="round",
                solid_joinstyle="round",
                zorder=2,
            )
    lining = shoe.lining.thickness * MM
    _layer(axes, shoe, R, 0.0, lining, (start, end), LINING)
    own = shoe.mesh is not None  # then only the mesh knows what is behind the lining
    if isinstance(shoe.body, Beam) and not own:
        _beam(axes, shoe, R, unit)
    elif shoe.backing is not None and not own:
        _layer(axes, shoe, R, lining, shoe.backing.thickness * MM, (start, end), BLOCK)
        lining += shoe.backing.thickness * MM
    if isinstance(shoe.body, Bar) and not own:
        arc = math.degrees(shoe.body.start), math.degrees(shoe.body.end)
        for plate in shoe.body.plates.values():
            _layer(axes, shoe, R, lining, plate.thickness * MM, arc, BODY)
            lining += plate.thickness * MM
    held(axes, shoe, unit, on_strut=on_strut)
    arms(axes, shoe, R / MM, _loaded_point(shoe, R), unit)
    middle = 0.5 * (shoe.lining.start + shoe.lining.end)
    inside = R - 1.8 * unit - (shoe.depth * MM if shoe.sign > 0 else 0.0)
    _label(axes, inside * np.array([math.cos(middle), math.sin(middle)]), shoe.name)


def _beam(axes: Axes, shoe: Shoe, R: float, unit: float) -> None:
    """A straight beam, and the block that fills the space up to the lining's back."""
    assert isinstance(shoe.body, Beam)
    axis = axis_of(shoe.pin.xy * MM, shoe.actuation.point.xy * MM)
    half = 0.5 * (shoe.body.thickness * MM if shoe.body.thickness else unit)
    if shoe.backing is not None:
        angle = axis.angle(np.linspace(shoe.lining.start, shoe.lining.end, 60))
        back = R + shoe.lining.thickness * MM
        x, y = axis.foot + back * np.sin(angle), axis.distance - back * np.cos(angle)
        block = axis.to_brake(np.append(x, x[[-1, 0]]), np.append(y, [half, half]))
        axes.fill(*block.T, facecolor=BLOCK, edgecolor=INK, lw=0.8, zorder=2)
    corners = axis.to_brake(np.array([0, 1, 1, 0]) * axis.length, np.array([-1, -1, 1, 1]) * half)
    axes.fill(*corners.T, facecolor=BODY, edgecolor=INK, lw=0.8, zorder=2)


def _layer(
    axes: Axes,
    shoe: Shoe,
    R: float,
    depth: float,
    thickness: float,
    arc: tuple[float, float],
    color: str,
) -> None:
    """A layer of a shoe, from `depth` to `depth + thickness` [mm] behind the friction surface, over
    an arc [deg].
    """
    outer = R - depth if shoe.sign > 0 else R + depth + thickness
    axes.add_patch(
        Wedge(
            (0, 0), outer, *arc, width=thickness, facecolor=color, edgecolor=INK, lw=0.8, zorder=3
        )
    )


def _back(shoe: Shoe, R: float) -> float:
    """Radius [mm] of the stroke behind the lining."""
    return R - shoe.sign * (shoe.lining.thickness * MM + 0.035 * R)


def _strokes(shoe: Shoe, R: float) -> list[Floats]:
    """Lines (n, 2) [mm] that stand for a rigid shoe: its back, to the hinge, to the force; or its
    lever.
    """
    angles = np.linspace(shoe.lining.start, shoe.lining.end, 80)
    back = _back(shoe, R) * np.column_stack([np.cos(angles), np.sin(angles)])
    hinge, load = shoe.pin.xy * MM, _loaded_point(shoe, R)
    if shoe.pivot is not None:
        pivot = shoe.pivot.xy * MM
        return [back, np.array([back[40], pivot]), np.array([hinge, pivot, load])]
    lever = load - hinge
    along = (
        float(np.clip((back[40] - hinge) @ lever / (lever @ lever), 0.0, 1.0))
        if lever.any()
        else 0.0
    )
    foot = hinge + along * lever
    clear = np.linalg.norm(np.linspace(hinge, load, 50), axis=1)
    if np.all(clear > R) and shoe.sign < 0:  # a straight lever outside the drum
        return [back, np.array([hinge, load]), np.array([back[40], foot])]
    near, far = (back, back[::-1])[
        int(np.linalg.norm(back[0] - hinge) > np.linalg.norm(back[-1] - hinge))
    ][[0, -1]]
    return [back, np.array([hinge, near]), np.array([far, load])]


def _loaded_point(shoe: Shoe, R: float) -> Floats:
    """Where the force is drawn (2,) [mm].

    At its point if that lies outside the drum beside an external shoe, else where its line of
    action comes to the shoe's end: from outside onto its back, from inside nearest to it.
    """
    point = shoe.actuation.point.xy * MM
    if shoe.sign < 0 and np.linalg.norm(point) > R:
        return point
    half = 0.5 * shoe.body.depth if isinstance(shoe.body, Bar) else 0.0
    depth = R - shoe.sign * (shoe.depth - half) * MM
    arc = shoe.body if isinstance(shoe.body, Bar) else shoe.lining
    ends = [depth * np.array([math.cos(angle), math.sin(angle)]) for angle in (arc.start, arc.end)]
    far = max(ends, key=lambda end: float(np.linalg.norm(end - shoe.pin.xy * MM)))
    along = np.array([math.cos(shoe.actuation.direction), math.sin(shoe.actuation.direction)])
    nearest = point + ((far - point) @ along) * along
    middle = point - (point @ along) * along
    reach = _back(shoe, R) ** 2 - middle @ middle
    if shoe.sign > 0 or shoe.body or reach < 0:
        return np.asarray(nearest)
    return np.asarray(middle + math.copysign(math.sqrt(reach), (far - middle) @ along) * along)


def _tip(shoe: Shoe, R: float, unit: float) -> Floats:
    """The tip (2,) [mm] of the force's arrow; of one that pulls an external shoe its tail is where
    it acts.
    """
    load, tail = _loaded_point(shoe, R), _tail(shoe.actuation, unit)
    middle = R * np.array([math.cos(shoe.lining.middle), math.sin(shoe.lining.middle)])
    return load + tail if shoe.sign < 0 and (load - middle) @ tail > 0 else load


def _places(shoe: Shoe, R: float, unit: float) -> Floats:
    """Points (n, 2) [mm] that must be in the picture."""
    load = _tip(shoe, R, unit)
    hinge = shoe.pin.xy * MM
    size = np.array([[-1.2, -1.6], [1.2, 1.6]]) * unit
    return np.concatenate([_room(shoe.actuation, load, unit), hinge + size])


# on a plane


def _draw_flat(axes: Axes, brake: Brake) -> None:
    pins = [x for shoe in brake.shoes for x in (shoe.pin.x, shoe.actuation.point.x)]
    ends = [x for shoe in brake.shoes for x in (shoe.lining.start, shoe.lining.end)]
    left, right = min(pins + ends) * MM, max(pins + ends) * MM
    unit = (right - left) / 20
    left, right = left - 2 * unit, right + 2 * unit
    axes.add_patch(
        Rectangle((left, -2 * unit), right - left, 2 * unit, facecolor=DRUM, edgecolor="none")
    )
    axes.plot([left, right], [0, 0], color=INK, lw=1.6)
    middle = 0.5 * (left + right)
    half = 2.2 * unit * brake.spin
    _arrow(
        axes, np.array([middle - half, -unit]), np.array([middle + half, -unit]), MOTION, width=0.14
    )
    places = [np.array([[left, -2 * unit], [right, 0]])]
    elastic = brake.unmeshable() is None
    struts = {link.source for link in brake.links}
    _forces(axes, brake, {shoe.name: shoe.actuation.point.xy * MM for shoe in brake.shoes}, unit)
    for shoe in brake.shoes:
        _flat_shoe(axes, shoe, unit, on_strut=shoe.name in struts)
        if elastic:
            arms(axes, shoe, brake.size, shoe.actuation.point.xy * MM, unit)
        load = shoe.actuation.point.xy * MM
        pin = shoe.pin.xy * MM + np.array([[-1.2, -1.6], [1.2, 1.6]]) * unit
        places.append(np.concatenate([_room(shoe.actuation, load, unit), pin]))
    _frame(axes, np.concatenate(places), 2 * unit)


def _flat_shoe(axes: Axes, shoe: Shoe, unit: float, *, on_strut: bool) -> None:
    start, end = shoe.lining.start * MM, shoe.lining.end * MM
    if isinstance(shoe.body, Bar) and shoe.lining.thickness is not None:
        layers = [(start, end, shoe.lining.thickness, LINING)]
        if shoe.mesh is None:  # else only the mesh knows what is behind the lining
            layers += [(start, end, shoe.backing.thickness, BLOCK)] if shoe.backing else []
            body = shoe.body.start * MM, shoe.body.end * MM
            layers += [(*body, plate.thickness, BODY) for plate in shoe.body.plates.values()]
        top = 0.0
        for left, right, thickness, color in layers:
            box = Rectangle(
                (left, top),
                right - left,
                thickness * MM,
                facecolor=color,
                edgecolor=INK,
                lw=0.8,
                zorder=3,
            )
            axes.add_patch(box)
            top += thickness * MM
    else:
        _flat_sign(axes, shoe, unit)
    held(axes, shoe, unit, on_strut=on_strut)
    _label(axes, np.array([end + 1.2 * unit, 1.0 * unit]), shoe.name, ha="left")
    if shoe.hinge is not None and shoe.pivot is None:
        x, h = shoe.hinge.xy * MM
        axes.annotate(
            "",
            (x, 0),
            (x, h),
            arrowprops={"arrowstyle": "<->", "color": FAINT, "lw": 0.8},
            zorder=4,
        )
        _label(axes, np.array([x - 1.6 * unit, 0.4 * h]), f"h = {h:.4g} mm")


def _flat_sign(axes: Axes, shoe: Shoe, unit: float) -> None:
    """A rigid shoe: its lining, and a block up to the lever."""
    start, end, top = shoe.lining.start * MM, shoe.lining.end * MM, 0.8 * unit
    pin, load = shoe.pin.xy * MM, shoe.actuation.point.xy * MM
    axes.add_patch(
        Rectangle((start, 0), end - start, top, facecolor=LINING, edgecolor=INK, lw=0.8, zorder=3)
    )
    lever = load - pin
    share = np.clip((np.array([start, end]) - pin[0]) / lever[0], 0, 1) if lever[0] else np.zeros(2)
    feet = pin + share[:, None] * lever
    block = [(start, top), *feet.tolist(), (end, top)]
    axes.add_patch(
        PathPatch(Outline(np.array([*block, block[0]])), facecolor=BODY, edgecolor="none", zorder=2)
    )
    axes.plot(*np.array([pin, load]).T, color=BODY, lw=7, solid_capstyle="round", zorder=2)


# signs


def _tail(actuation: Actuation, unit: float) -> Floats:
    """From an arrow's tail to its tip (2,) [mm]."""
    sense = -1.0 if actuation.force < 0 else 1.0
    return (
        4 * unit * sense * np.array([math.cos(actuation.direction), math.sin(actuation.direction)])
    )


def _beside(
    actuation: Actuation, tip: Floats, unit: float, *, inside: bool = False
) -> tuple[Floats, str]:
    """Where the words of an arrow stand (2,) [mm]: above it, or to its right, inside a drum towards
    the centre; and their alignment.
    """
    along = _tail(actuation, unit)
    left = np.array([-along[1], along[0]]) / np.linalg.norm(along)
    up = left if left[1] > 1e-9 or (abs(left[1]) <= 1e-9 and left[0] > 0) else -left
    if inside and up @ tip > 0:
        up = -up
    return tip - 0.75 * along + 0.95 * unit * up, "left" if abs(up[1]) < 0.5 else "center"


def _forces(axes: Axes, brake: Brake, tips: Mapping[str, Floats], unit: float) -> None:
    """The forces on the shoes with their sizes, of a cam their sum; equal ones beside each other
    have their size once.

    That of a strut is drawn with it.
    """
    pushed = [shoe for shoe in brake.shoes if shoe.actuation.force]
    if brake.actuation is not None and brake.actuation.is_cam:
        middle = 0.5 * sum(tips[shoe.name] for shoe in pushed)
        _label(
            axes,
            middle - np.array([0.0, 1.6 * unit]),
            f"{_size(brake.actuation.total)} in all",
            color=FORCE,
        )
        return
    inside = not brake.surface.straight and brake.shoes[0].sign > 0
    labels: list[tuple[Floats, str, str]] = []
    for shoe in pushed:
        tip = tips[shoe.name]
        _arrow(axes, tip - _tail(shoe.actuation, unit), tip, FORCE, width=0.12)
        place, alignment = _beside(shoe.actuation, tip, unit, inside=inside)
        text = _size(shoe.actuation.force)
        k = next(
            (
                k
                for k, one in enumerate(labels)
                if one[1] == text and math.dist(one[0], place) < 5 * unit
            ),
            None,
        )
        if k is None:
            labels.append((place, text, alignment))
        else:
            labels[k] = 0.5 * (labels[k][0] + place), f"{text} each", alignment
    for place, text, alignment in labels:
        _label(axes, place, text, color=FORCE, ha=alignment)


def _size(force: float) -> str:
    return f"{abs(force) / 1e3:.4g} kN" if abs(force) >= 1e3 else f"{abs(force):.4g} N"


def _room(actuation: Actuation, tip: Floats, unit: float) -> Floats:
    """Points (3, 2) [mm] that an arrow and its words need in the picture."""
    place, alignment = _beside(actuation, tip, unit)
    words = np.array([3 * unit if alignment == "left" else 0.0, 0.0])
    return np.array([tip, tip - _tail(actuation, unit), place + words])


def _arrow(axes: Axes, tail: Floats, tip: Floats, color: str, width: float) -> None:
    axes.add_patch(
        FancyArrowPatch(
            tuple(tail), tuple(tip), arrowstyle="-|>,head_length=0.45,head_width=0.22", mutation_scale=22,
            color=color, lw=20 * width, shrinkA=0, shrinkB=0, zorder=6,
        )
    )  # fmt: skip


def _label(axes: Axes, place: Floats, text: str, color: str = INK, **style: Any) -> None:
    style = {"ha": "center", "va": "center"} | style
    box = {"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none", "alpha": 0.75}
    axes.text(place[0], place[1], text, color=color, fontsize=8.5, bbox=box, zorder=7, **style)


def _frame(axes: Axes, points: Floats, margin: float) -> None:
    low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
