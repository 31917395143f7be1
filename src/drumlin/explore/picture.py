"""An answer as plain data to draw: pressures over the angle on a drum [deg] or the place on a plane
[mm], a table.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.texts import formatted
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Bar, Beam
from drumlin.explore.answers import HIGHEST, WEAR_TOLERANCE, Answer, Stated
from drumlin.report.figures import name_of, smooth
from drumlin.response import Response
from drumlin.response.balance import loaded
from drumlin.response.merit import brake_factor
from drumlin.response.show import arcs_text

MM, MPA = 1e3, 1e-6
POINTS = 160  # of a curve
ARROW = 0.45  # of the drum's radius: the largest force
PETAL = 0.45  # of the drum's radius: how far the full scale stands off the drum
ROUNDING = 1e-12  # relative, below which an error is that of the arithmetic
PLACE, PRESSURE = (
    1e-3,
    1e-4,
)  # what curves count in on their way to the page: deg or mm, parts of the full scale


class Curve(NamedTuple):
    """The pressure of a shoe: places `at` (n,) [deg], on a plane [mm], `p` (n,) [MPa], the shoe's
    `sign`: +1 inside.
    """

    at: Floats
    p: Floats
    sign: int


class Lines(NamedTuple):
    """Lines or areas: lists of x and of y, one of each a line."""

    xs: list[Floats]
    ys: list[Floats]


@dataclass(frozen=True)
class Picture:
    """What the page shows of an answer.

    `fem`, `law`: curves of the shoes that touch; `arcs`: contact of the finite elements, as places.
    `forces`: arrows [mm], tail to tip. `scale` [MPa]: the full one. `motion`: of drum or body, as a
    sign. `head`: the answer in a line, `rows` the table with its head; `failures`: why there is no
    answer, or none by the law.
    """

    fem: tuple[Curve, ...]
    law: tuple[Curve, ...]
    arcs: tuple[tuple[float, float], ...]
    forces: Lines
    scale: float
    motion: str
    head: str
    rows: tuple[tuple[str, ...], ...]
    failures: tuple[str, ...]


def picture_of(answer: Answer, brake: Brake) -> Picture:
    """The picture of an answer; `brake`: that of the file, where the setting's is none."""
    shown = answer.brake or brake
    peaks = [
        shoe.peak_pressure for r in (answer.found, answer.law) if r is not None for shoe in r.shoes
    ]
    arcs = [arc for shoe in answer.found.shoes for arc in shoe.contact_arcs] if answer.found else []
    unit = shown.surface.shown
    failures = (answer.failure, answer.law_failure)
    return Picture(
        fem=_curves(answer.found, shown),
        law=_curves(answer.law, shown),
        arcs=tuple((a * unit, b * unit) for a, b in arcs),
        forces=_forces(shown if answer.found is None else loaded(shown, answer.found)),
        scale=scale_of(max(peaks, default=0.0) * MPA),
        motion=_motion(shown),
        head=head_of(answer),
        rows=rows_of(answer, shown),
        failures=tuple(dict.fromkeys(line for line in failures if line)),
    )


def _motion(brake: Brake) -> str:
    """Of the drum, or of the body that slides."""
    if brake.surface.straight:
        return "→" if brake.spin > 0 else "←"
    return "↺" if brake.spin > 0 else "↻"


def numbers_of(curve: Curve, scale: float) -> dict[str, Any]:
    """A curve as whole numbers, of which a page draws its paths: short to send and fast to read."""
    at, p = np.rint(curve.at / PLACE), np.rint(curve.p / scale / PRESSURE)
    return {"at": at.astype(int).tolist(), "p": p.astype(int).tolist(), "sign": curve.sign}


def scale_of(peak: float) -> float:
    """The full scale [MPa] for a peak [MPa]: the next of 1, 2, 5 times a power of ten, so that it
    seldom changes.
    """
    if not peak > 0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(peak))
    return float(next(digit for digit in (1, 2, 5, 10) if digit * power >= peak)) * power


def _curves(response: Response | None, brake: Brake) -> tuple[Curve, ...]:
    """Of each shoe that touches."""
    if response is None:
        return ()
    unit, found = brake.surface.shown, []
    for shoe, part in zip(response.shoes, brake.shoes, strict=True):
        if shoe.contact_arcs:
            theta, p = smooth(shoe, POINTS)
            found.append(Curve(theta * unit, p * MPA, part.sign))
    return tuple(found)


def _forces(brake: Brake) -> Lines:
    """An arrow for each force: its shaft, tail to tip, and its head."""
    found = []
    for shoe in brake.shoes:
        tail, tip = _arrow(brake, shoe)
        along = tip - tail
        barbs = [
            tip + 0.25 * (turn * np.array([-along[1], along[0]]) - along) for turn in (0.5, -0.5)
        ]
        found += [np.array([tail, tip]).T * MM, np.array([barbs[0], tip, barbs[1]]).T * MM]
    return Lines([xy[0] for xy in found], [xy[1] for xy in found])


def _arrow(brake: Brake, shoe: Shoe) -> tuple[Floats, Floats]:
    """Tail and tip (2,) [m] of a force; the largest one is as long as ARROW of the drum's radius."""
    largest = max(abs(shoe.actuation.force) for shoe in brake.shoes) or 1.0
    tip = _loaded(shoe)
    return tip - ARROW * brake.size * shoe.actuation.vector / largest, tip


def _loaded(shoe: Shoe) -> Floats:
    """Where a force is drawn (2,) [m]: on its line of action, nearest to the end of the lining away
    from the hinge.
    """
    along, point = shoe.actuation.direction_vector, shoe.actuation.point.xy
    if shoe.flat or shoe.sign < 0:
        return point
    size = float(np.linalg.norm(point))
    ends = [
        size * np.array([math.cos(a), math.sin(a)]) for a in (shoe.lining.start, shoe.lining.end)
    ]
    far = max(ends, key=lambda end: float(np.linalg.norm(end - shoe.pin.xy)))
    return np.asarray(point + ((far - point) @ along) * along)


# in words


def head_of(answer: Answer) -> str:
    """Torque, brake factor and law in a line of HTML."""
    if answer.found is None or answer.brake is None:
        return "no answer"
    surface = answer.brake.surface
    unit = surface.effect_unit
    found, factor = answer.found.effect, brake_factor(answer.brake, answer.found)
    said = [f"{surface.effect} <b>{found:.6g} {unit}</b>"]
    said += [] if factor is None else [f"brake factor {surface.factor} <b>{factor:.4g}</b>"]
    if answer.law is not None:
        by_law = answer.law.effect
        off = f" ({formatted(by_law / found - 1, '+.1%')})" if found else ""
        said.append(f"{escape(name_of(answer.law.model))} {by_law:.6g} {unit}{off}")
    if answer.distance:
        said.append(f"worn over {answer.distance * 1e-3:.4g} km at k = 1e-5 mm³/(N m)")
    return " · ".join(said)


def head_html(picture: Picture, refused: Sequence[str] = ()) -> str:
    """The answer, and what was refused or has no answer, a line each."""
    lines = [f'<p class="refused">{escape(line)}</p>' for line in (*refused, *picture.failures)]
    return f'<p class="answer">{picture.head}</p>' + "".join(lines)


def locking_html(answer: Answer, locking: Mapping[tuple[int, ...], float] | None) -> str:
    """How far the friction is from self-locking; `locking`: mu_lock by finite elements of each
    group, if known.
    """
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


def error_html(answer: Answer, stated: Stated | None, *, asked: bool) -> str:
    """How exact an answer is; `asked`: whether it was held against `solve`."""
    if answer.found is None or answer.brake is None or (asked and stated is None):
        return ""
    said = "finite elements on a fixed division; their error is found out when the sliders rest"
    if stated is not None:
        own = "which states no error of its own, as it is one mesh"
        if stated.own is not None:
            own = f"whose own errors are estimated as {stated.own['torque']:.1e} and {stated.own['pressure']:.1e}"
        said = (
            f"error of the finite elements on this fixed division: {answer.brake.surface.effect} "
            f"{_small(stated.torque)}, p {_small(stated.pressure)} (L2, worst shoe) from drumlin solve, {own}"
        )
    worn = f"; wear in steps of {WEAR_TOLERANCE:g} of p" if answer.distance else ""
    return f"<p>{said}{worn}</p>"


def _small(error: float) -> str:
    return f"{error:.1e}" if error > ROUNDING else "only rounding"


def rows_of(answer: Answer, brake: Brake) -> tuple[tuple[str, ...], ...]:
    """The table: its head, a row a shoe and model."""
    surface = brake.surface
    responses = [r for r in (answer.found, answer.law) if r is not None]
    head = (
        "shoe",
        "by",
        f"{surface.effect} [{surface.effect_unit}]",
        surface.factor,
        "peak p [MPa]",
        f"contact [{brake.surface.shown_unit}]",
        "self-energising",
    )
    rows = [_row(brake, response, i) for i in range(len(brake.shoes)) for response in responses]
    return (head, *rows)


def _row(brake: Brake, response: Response, i: int) -> tuple[str, ...]:
    shoe, made = response.shoes[i], response.effects[i]
    force = abs(loaded(brake, response).shoes[i].actuation.force)
    force *= brake.scale_factor
    return (
        shoe.name,
        name_of(response.model),
        f"{made:.6g}",
        f"{made / force:.4g}" if force else "–",
        f"{shoe.peak_pressure * MPA:.4g}",
        arcs_text(shoe, brake.surface),
        "yes" if shoe.self_energising else "no",
    )


def table_html(rows: Sequence[Sequence[str]]) -> str:
    """A table as HTML, its head first."""
    lines = ["".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rows[1:]]
    head = "".join(f"<th>{escape(cell)}</th>" for cell in rows[0])
    return f"<table><tr>{head}</tr>" + "".join(f"<tr>{line}</tr>" for line in lines) + "</table>"


# what does not change with the knobs


def drawing_of(brake: Brake) -> dict[str, Lines]:
    """Circle of the drum, or the plane, linings and shoe bodies as areas, and hinges as points
    [mm].
    """
    linings, bodies = [], []
    for shoe in brake.shoes:
        lining, behind = shoe.lining, shoe.lining.thickness or 0.0
        linings.append(_layer(shoe, brake.size, (lining.start, lining.end), (0.0, behind)))
        if shoe.mesh is None and isinstance(shoe.body, Bar):
            behind += shoe.backing.thickness if shoe.backing else 0.0
            over = shoe.body.start, shoe.body.end
            bodies.append(_layer(shoe, brake.size, over, (behind, behind + shoe.body.depth)))
        if isinstance(shoe.body, Beam):
            bodies.append(_beam(shoe, brake.size))
    held = [shoe.pin.xy * MM for shoe in brake.shoes if shoe.guide is None]
    return {
        "drum": _surface(brake),
        "linings": _lines(linings),
        "bodies": _lines(bodies),
        "hinges": Lines([xy[:1] for xy in held], [xy[1:] for xy in held]),
    }


def _surface(brake: Brake) -> Lines:
    """The friction surface [mm]."""
    if brake.surface.straight:
        (x, _), reach = centre_of(brake), reach_of(brake)
        return Lines([np.array([x - reach, x + reach])], [np.zeros(2)])
    R, circle = brake.size * MM, np.linspace(0, 2 * math.pi, 361)
    return Lines([R * np.cos(circle)], [R * np.sin(circle)])


def _lines(curves: Sequence[tuple[Floats, Floats]]) -> Lines:
    return Lines([x for x, _ in curves], [y for _, y in curves])


def path_of(lines: Lines) -> str:
    """Lines as the path of an SVG."""
    pairs = zip(lines.xs, lines.ys, strict=True)
    return "".join(
        "M" + "L".join(f"{a:.5g},{b:.5g}" for a, b in zip(x.tolist(), y.tolist(), strict=True))
        for x, y in pairs
    )


def brake_extent(brake: Brake) -> tuple[float, float]:
    """The places [deg], on a plane [mm], between which all linings lie, with some room."""
    unit = brake.surface.shown
    ends = [place * unit for shoe in brake.shoes for place in (shoe.lining.start, shoe.lining.end)]
    room = 0.04 * brake.size * MM if brake.surface.straight else 5.0
    return min(ends) - room, max(ends) + room


def centre_of(brake: Brake) -> tuple[float, float]:
    """The middle (x, y) [mm] of the picture: the drum's, on a plane that of what is drawn."""
    if not brake.surface.straight:
        return 0.0, 0.0
    xy = _places(brake)
    x, y = 0.5 * (xy.min(axis=0) + xy.max(axis=0)) * MM
    return float(x), float(y)


def _places(brake: Brake) -> Floats:
    """Points (n, 2) [m] that must be in the picture of a brake on a plane."""
    found = [
        (place, -1.2 * PETAL * brake.size)
        for shoe in brake.shoes
        for place in (shoe.lining.start, shoe.lining.end)
    ]
    return np.array(
        [*found, *(point for shoe in brake.shoes for point in (shoe.pin.xy, *_arrow(brake, shoe)))]
    )


def reach_of(brake: Brake) -> float:
    """Half the side [mm] of a square about `centre_of` that holds shoes, hinges, pressures and
    forces.
    """
    if brake.surface.straight:
        xy = _places(brake)
        return float(0.55 * np.ptp(xy, axis=0).max()) * MM
    R = brake.size
    room = [
        1.12 * (1 + PETAL) * R if shoe.sign > 0 else 1.05 * R + shoe.depth for shoe in brake.shoes
    ]
    places = [place for shoe in brake.shoes for place in (shoe.pin.xy, *_arrow(brake, shoe))]
    room += [float(np.abs(place).max()) + 0.1 * R for place in places]
    return max(room) * MM


def _layer(
    shoe: Shoe, size: float, over: tuple[float, float], depths: tuple[float, float]
) -> tuple[Floats, Floats]:
    """x and y [mm] of the outline of a layer of a shoe, over two places and between two depths [m]."""
    there = np.linspace(*over, 2 if shoe.flat else 90)
    places = np.concatenate([there, there[::-1], there[:1]])
    near, far = depths
    at = np.repeat([near, far, near], [len(there), len(there), 1])
    x, y = shoe.points(shoe.at(at, shoe.frame.phi(places), size)) * MM
    return x, y


def _beam(shoe: Shoe, R: float) -> tuple[Floats, Floats]:
    """x and y [mm] of a straight beam; where the file has no thickness, a tenth of the drum's
    radius stands for it.
    """
    assert isinstance(shoe.body, Beam)
    hinge, along = shoe.pin.xy, shoe.actuation.point.xy - shoe.pin.xy
    across = (
        0.5
        * (shoe.body.thickness or 0.1 * R)
        * np.array([-along[1], along[0]])
        / np.linalg.norm(along)
    )
    xy = (
        np.array([hinge - across, hinge + along - across, hinge + along + across, hinge + across])
        * MM
    )
    return xy[:, 0], xy[:, 1]
