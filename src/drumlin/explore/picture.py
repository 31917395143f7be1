"""An answer as plain data to draw: lines and areas on the drum and unrolled, in mm, MPa and degrees, and a table."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import NamedTuple

import numpy as np

from drumlin.arrays import Floats
from drumlin.brake import Brake, Shoe
from drumlin.brake.components import Beam
from drumlin.explore.answers import HIGHEST, Answer
from drumlin.report.figures import name_of, smooth
from drumlin.response import Response, ShoeResponse
from drumlin.response.show import arcs_text

MM, MPA = 1e3, 1e-6
POINTS = 160  # of a curve
ARROW = 0.45  # of the drum's radius
PETAL = 0.45  # of the drum's radius: how far the full scale stands off the drum
HEAD = ("shoe", "by", "torque [N m]", "T/(F R)", "peak p [MPa]", "contact [deg]", "self-energising")


class Lines(NamedTuple):
    """Lines or areas: lists of x and of y, one of each a line."""

    xs: list[Floats]
    ys: list[Floats]


LINES = ("area", "fem", "law", "contact", "drum_area", "drum_law", "drum_contact")


@dataclass(frozen=True)
class Picture:
    """What the page shows of an answer.

    `lines`, named by LINES: unrolled over the angle [deg] the pressure [MPa] of the finite elements as `area` and line
    `fem`, that of the law, and the contact arcs; on the drum [mm] the same, standing off its surface on the side away
    from the shoe, by PETAL of its radius at the full `scale` [MPa]. `forces`: arrows [mm], tail to tip. `motion`: the
    drum's, as a sign. `head`: the answer in a line, `rows` the table below HEAD; `failures`: why there is no answer,
    or none by the law.
    """

    lines: Mapping[str, Lines]
    forces: Lines
    scale: float
    motion: str
    head: str
    rows: tuple[tuple[str, ...], ...]
    failures: tuple[str, ...]


def picture_of(answer: Answer, brake: Brake) -> Picture:
    """The picture of an answer; `brake`: that of the file, where the setting's is none."""
    shown = answer.brake or brake
    R = shown.drum.radius * MM
    own, law = _curves(answer.found, shown), _curves(answer.law, shown)
    peaks = [shoe.peak_pressure for r in (answer.found, answer.law) if r is not None for shoe in r.shoes]
    scale = scale_of(max(peaks, default=0.0) * MPA)
    arcs = [arc for shoe in answer.found.shoes for arc in shoe.contact_arcs] if answer.found else []
    touching = [np.linspace(*arc, POINTS // 2) for arc in arcs]
    lines = {
        "area": Lines([np.degrees(_closed(t, t)) for t, _, _ in own], [_closed(p, 0 * p) * MPA for _, p, _ in own]),
        "fem": Lines([np.degrees(t) for t, _, _ in own], [p * MPA for _, p, _ in own]),
        "law": Lines([np.degrees(t) for t, _, _ in law], [p * MPA for _, p, _ in law]),
        "contact": Lines([np.degrees(np.array(arc)) for arc in arcs], [np.zeros(2) for _ in arcs]),
        "drum_area": _round([(_closed(t, t), _closed(_off(p, n, R, scale), 0 * p + R)) for t, p, n in own]),
        "drum_law": _round([(t, _off(p, n, R, scale)) for t, p, n in law]),
        "drum_contact": _round([(t, np.full(t.shape, R)) for t in touching]),
    }
    failures = (answer.failure, answer.law_failure)
    said = tuple(dict.fromkeys(line for line in failures if line))
    motion = "↺" if shown.spin > 0 else "↻"
    return Picture(lines, _forces(shown), scale, motion, head_of(answer), rows_of(answer, shown), said)


def scale_of(peak: float) -> float:
    """The full scale [MPa] for a peak [MPa]: the next of 1, 2, 5 times a power of ten, so that it seldom changes."""
    if not peak > 0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(peak))
    return float(next(digit for digit in (1, 2, 5, 10) if digit * power >= peak)) * power


def _curves(response: Response | None, brake: Brake) -> list[tuple[Floats, Floats, int]]:
    """theta [rad], p [Pa] and the sign of each shoe that touches."""
    if response is None:
        return []
    pairs = zip(response.shoes, brake.shoes, strict=True)
    return [(*smooth(shoe, POINTS), part.sign) for shoe, part in pairs if shoe.contact_arcs]


def _closed(there: Floats, back: Floats) -> Floats:
    """A way there and back."""
    return np.concatenate([there, back[::-1]])


def _round(curves: Sequence[tuple[Floats, Floats]]) -> Lines:
    """Curves r(theta) in the plane."""
    return Lines([r * np.cos(t) for t, r in curves], [r * np.sin(t) for t, r in curves])


def _off(p: Floats, sign: int, R: float, scale: float) -> Floats:
    """Radii [mm] of the pressures p [Pa]; a singular edge is cut off a little beyond the full scale."""
    return R * (1 + sign * PETAL * np.minimum(p * MPA / scale, 1.1))


def _forces(brake: Brake) -> Lines:
    """An arrow for each force: its shaft, tail to tip, and its head."""
    found = []
    for shoe in brake.shoes:
        tail, tip = _arrow(brake, shoe)
        along = tip - tail
        barbs = [tip + 0.25 * (turn * np.array([-along[1], along[0]]) - along) for turn in (0.5, -0.5)]
        found += [np.array([tail, tip]).T * MM, np.array([barbs[0], tip, barbs[1]]).T * MM]
    return Lines([xy[0] for xy in found], [xy[1] for xy in found])


def _arrow(brake: Brake, shoe: Shoe) -> tuple[Floats, Floats]:
    """Tail and tip (2,) [m] of a force; the largest one is as long as ARROW of the drum's radius."""
    largest = max(abs(shoe.actuation.force) for shoe in brake.shoes) or 1.0
    tip = _loaded(shoe)
    return tip - ARROW * brake.drum.radius * shoe.actuation.vector / largest, tip


def _loaded(shoe: Shoe) -> Floats:
    """Where a force is drawn (2,) [m]: on its line of action, nearest to the end of the lining away from the hinge."""
    along, point = shoe.actuation.direction_vector, shoe.actuation.point.xy
    if shoe.sign < 0:
        return point
    size = float(np.linalg.norm(point))
    ends = [size * np.array([math.cos(a), math.sin(a)]) for a in (shoe.lining.start, shoe.lining.end)]
    far = max(ends, key=lambda end: float(np.linalg.norm(end - shoe.pin.xy)))
    return np.asarray(point + ((far - point) @ along) * along)


# in words


def brake_factor(brake: Brake, torque: float) -> float | None:
    """T/(F R) of the whole brake, F the mean of the forces on its shoes; None without a force."""
    mean = sum(abs(shoe.actuation.force) for shoe in brake.shoes) / len(brake.shoes)
    return torque / (mean * brake.drum.radius) if mean else None


def head_of(answer: Answer) -> str:
    """Torque, brake factor and law in a line of HTML."""
    if answer.found is None or answer.brake is None:
        return "no answer"
    factor = brake_factor(answer.brake, answer.found.torque)
    said = [f"torque <b>{answer.found.torque:.6g} N m</b>"]
    said += [] if factor is None else [f"brake factor T/(F R) <b>{factor:.4g}</b>"]
    if answer.law is not None:
        off = f" ({answer.law.torque / answer.found.torque - 1:+.1%})" if answer.found.torque else ""
        said.append(f"{escape(name_of(answer.law.model))} {answer.law.torque:.6g} N m{off}")
    if answer.distance:
        said.append(f"worn over {answer.distance * 1e-3:.4g} km at k = 1e-5 mm³/(N m)")
    return " · ".join(said)


def head_html(picture: Picture, refused: Sequence[str] = ()) -> str:
    """The answer, and what was refused or has no answer, a line each."""
    lines = [f'<p class="refused">{escape(line)}</p>' for line in (*refused, *picture.failures)]
    return f'<p class="answer">{picture.head}</p>' + "".join(lines)


def locking_html(answer: Answer, locking: Mapping[tuple[int, ...], float] | None) -> str:
    """How far the friction is from self-locking; `locking`: mu_lock by finite elements of each group, if known."""
    if answer.brake is None:
        return ""
    friction, said = answer.brake.friction, "…"
    if locking is not None:
        limit = min(locking.values(), default=math.inf)
        far = f"<b>{limit:.4g}</b>, {limit - friction:+.4g} from {friction:.4g}"
        said = f"none up to friction {HIGHEST:g}" if math.isinf(limit) else f"at friction {far}"
    law = answer.law_locking
    if law is not None:
        by = escape(name_of(answer.law_name or ""))
        said += f"; by the {by} " + ("never" if math.isinf(law) else f"at {law:.4g}")
    return f"<p>self-locking {said}</p>"


def rows_of(answer: Answer, brake: Brake) -> tuple[tuple[str, ...], ...]:
    """The table below HEAD: a row a shoe and model."""
    responses = [r for r in (answer.found, answer.law) if r is not None]
    return tuple(
        _row(shoe, name_of(response.model), brake.shoes[i], brake.drum.radius)
        for i in range(len(brake.shoes))
        for response in responses
        for shoe in (response.shoes[i],)
    )


def _row(shoe: ShoeResponse, model: str, part: Shoe, R: float) -> tuple[str, ...]:
    force = abs(part.actuation.force)
    return (
        shoe.name,
        model,
        f"{shoe.torque:.6g}",
        f"{shoe.torque / (force * R):.4g}" if force else "–",
        f"{shoe.peak_pressure * MPA:.4g}",
        arcs_text(shoe),
        "yes" if shoe.self_energising else "no",
    )


def table_html(rows: Sequence[Sequence[str]]) -> str:
    """The table as HTML."""
    lines = ["".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rows]
    head = "".join(f"<th>{escape(cell)}</th>" for cell in HEAD)
    return f"<table><tr>{head}</tr>" + "".join(f"<tr>{line}</tr>" for line in lines) + "</table>"


# what does not change with the knobs


def drawing_of(brake: Brake) -> dict[str, Lines]:
    """Circle of the drum, linings and shoe bodies as areas, and hinges as points [mm]."""
    R = brake.drum.radius
    circle = np.linspace(0, 2 * math.pi, 361)
    linings, bodies = [], []
    for shoe in brake.shoes:
        lining, sign = shoe.lining, shoe.sign
        linings.append(_layer(lining.start, lining.end, R, R - sign * lining.thickness))
        if shoe.mesh is None and shoe.body is not None and shoe.body.shape == "arc":
            inner = lining.thickness + (shoe.backing.thickness if shoe.backing else 0.0)
            far = R - sign * (inner + shoe.body.depth)
            bodies.append(_layer(shoe.body.start, shoe.body.end, R - sign * inner, far))
        if isinstance(shoe.body, Beam):
            bodies.append(_beam(shoe, R))
    held = [shoe.pin.xy * MM for shoe in brake.shoes if shoe.guide is None]
    return {
        "drum": _round([(circle, np.full(circle.shape, R * MM))]),
        "linings": Lines([x for x, _ in linings], [y for _, y in linings]),
        "bodies": Lines([x for x, _ in bodies], [y for _, y in bodies]),
        "hinges": Lines([xy[:1] for xy in held], [xy[1:] for xy in held]),
    }


def path_of(lines: Lines) -> str:
    """Lines as the path of an SVG."""
    pairs = zip(lines.xs, lines.ys, strict=True)
    return "".join(
        "M" + "L".join(f"{a:.5g},{b:.5g}" for a, b in zip(x.tolist(), y.tolist(), strict=True)) for x, y in pairs
    )


def brake_extent(brake: Brake) -> tuple[float, float]:
    """The angles [deg] between which all linings lie, with some room."""
    ends = [math.degrees(angle) for shoe in brake.shoes for angle in (shoe.lining.start, shoe.lining.end)]
    return min(ends) - 5, max(ends) + 5


def reach_of(brake: Brake) -> float:
    """Half the side [mm] of a square about the drum that holds shoes, hinges, pressures and forces."""
    R = brake.drum.radius
    room = [1.12 * (1 + PETAL) * R if shoe.sign > 0 else 1.05 * R + shoe.depth for shoe in brake.shoes]
    places = [place for shoe in brake.shoes for place in (shoe.pin.xy, *_arrow(brake, shoe))]
    room += [float(np.abs(place).max()) + 0.1 * R for place in places]
    return max(room) * MM


def _layer(start: float, end: float, near: float, far: float) -> tuple[Floats, Floats]:
    """x and y [mm] of a layer between two radii [m]."""
    t, r = _closed(np.linspace(start, end, 90), np.linspace(start, end, 90)), np.repeat([near, far], 90) * MM
    return r * np.cos(t), r * np.sin(t)


def _beam(shoe: Shoe, R: float) -> tuple[Floats, Floats]:
    """x and y [mm] of a straight beam; where the file has no thickness, a tenth of the drum's radius stands for it."""
    assert isinstance(shoe.body, Beam)
    hinge, along = shoe.pin.xy, shoe.actuation.point.xy - shoe.pin.xy
    across = 0.5 * (shoe.body.thickness or 0.1 * R) * np.array([-along[1], along[0]]) / np.linalg.norm(along)
    xy = np.array([hinge - across, hinge + along - across, hinge + along + across, hinge + across]) * MM
    return xy[:, 0], xy[:, 1]
