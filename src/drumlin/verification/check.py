"""Somebody's p(theta), a table in a CSV file, against reference values."""

import csv
import io
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.base.files import read_text
from drumlin.base.texts import formatted
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import differing
from drumlin.brake.plane_brake import read_any
from drumlin.brake.surface import DRUM, FrictionSurface
from drumlin.brake.units import LARGEST_NUMBER_SI, to_si
from drumlin.comparison import as_csv
from drumlin.response.response import Response, ShoeResponse
from drumlin.verification.reference import Reference, ShoeReference
from drumlin.verification.reference_file import LARGEST_FILE


def _place_heading(surface: FrictionSurface) -> str:
    return f"{surface.coordinate} [{surface.shown_unit}]"


def _allowed(surface: FrictionSurface) -> str:
    place = _place_heading(surface)
    return f"columns 'shoe', {place!r} and 'p [MPa]', or other units"


class Curve(NamedTuple):
    """Pressures p (n,) [Pa] of a shoe at growing angles theta (n,) [rad]."""

    theta: Floats
    p: Floats


class Verdict(NamedTuple):
    """How far a shoe's curve is from its reference.

    `distance`: relative L2 distance of p outside the edge zones, at the reference's angles;
    `largest`: largest difference there over the peak pressure, and its place `at`, in words;
    `torque_error`: what these differences of p change of the torque, relative; `torque` [N m], on a
    plane the braking force [N]: by trapezia of the curve's own points, held even to the lining's
    ends, where a sharp edge may need finer ones; `floor`, `torque_floor`: relative uncertainties of
    the reference.
    """

    shoe: str
    distance: float
    largest: float
    at: str
    torque: float
    torque_error: float
    floor: float
    torque_floor: float


def curves_text(response: Response, surface: FrictionSurface = DRUM) -> str:
    """The pressures of a response over the places of its surface, as a CSV table that `read_curves`
    takes.
    """
    place, per_unit = _place_heading(surface), surface.shown
    return as_csv(
        [
            {"shoe": shoe.name, place: f"{x:.12g}", "p [MPa]": f"{p:.12g}"}
            for shoe in response.shoes
            for x, p in zip(*curve_of(shoe, per_unit), strict=True)
        ]
    )


def curve_of(shoe: ShoeResponse, per_unit: float) -> tuple[Floats, Floats]:
    """The curve of a shoe: places, in units of which there are so many to SI's, and p [MPa]."""
    theta, p = shoe.curve()
    return theta * per_unit, p * 1e-6


def read_curves(path: Path, brake: Brake) -> dict[str, Curve]:
    """The curve of each shoe from a CSV file, on a plane over x [m].

    Raises BadInput with one line: file, line, what is allowed.
    """
    text = read_text(path, LARGEST_FILE, "a table of p(theta)")
    try:
        lines = list(csv.reader(io.StringIO(text, newline="")))
    except csv.Error as error:
        raise BadInput(f"{path}: is not a CSV file ({error})") from error
    surface = brake.surface
    wanted = {surface.coordinate: surface.unit, "p": "Pa"}
    if not lines:
        raise BadInput(f"{path}: is empty; must have {_allowed(surface)}")
    columns = _columns(path, lines[0], wanted, surface)
    names = [shoe.name for shoe in brake.shoes]
    if "shoe" not in columns and len(names) > 1:
        raise BadInput(f"{path}: line 1: no column 'shoe'; the brake has {', '.join(names)}")
    points: dict[str, list[tuple[float, float]]] = {name: [] for name in names}
    for number, line in enumerate(lines[1:], 2):
        if not any(cell.strip() for cell in line):
            continue
        if len(line) != len(lines[0]):
            raise BadInput(
                f"{path}: line {number}: {len(line)} cells; must have {len(lines[0])} as the "
                f"heading"
            )
        name = line[columns["shoe"][0]].strip() if "shoe" in columns else names[0]
        if name not in points:
            raise BadInput(
                f"{path}: line {number}: shoe = {name!r}: unknown; allowed: {', '.join(names)}"
            )
        theta, p = (_number(path, number, line, key, *columns[key]) for key in wanted)
        points[name].append((theta, p))
    return {shoe.name: _curve(path, shoe, points[shoe.name]) for shoe in brake.shoes}


def _columns(
    path: Path, heading: Sequence[str], wanted: Mapping[str, str], surface: FrictionSurface
) -> dict[str, tuple[int, float]]:
    """Place and factor to SI of each column, from headings such as 'theta [deg]'."""
    columns: dict[str, tuple[int, float]] = {}
    for place, cell in enumerate(heading):
        name, _, unit = cell.strip().removesuffix("]").partition("[")
        name = name.strip()
        if name == "shoe":
            columns[name] = (place, 1.0)
        if name in wanted:
            try:
                columns[name] = (
                    place,
                    to_si(f"1 {unit.strip()}", wanted[name], unit_required=True),
                )
            except ValueError as error:
                raise BadInput(f"{path}: line 1: {cell.strip()!r}: {error}") from error
    for name in wanted:
        if name not in columns:
            raise BadInput(
                f"{path}: line 1: no column {name!r} with its unit; must have {_allowed(surface)}"
            )
    return columns


def _number(
    path: Path, number: int, line: Sequence[str], key: str, place: int, factor: float
) -> float:
    try:
        value = float(line[place]) * factor
    except ValueError:
        value = math.nan
    if not abs(value) <= LARGEST_NUMBER_SI:
        raise BadInput(
            f"{path}: line {number}: {key} = {line[place]!r}: must be a finite number, "
            f"up to {LARGEST_NUMBER_SI:g} in SI units"
        )
    return value


def _curve(path: Path, shoe: Shoe, points: list[tuple[float, float]]) -> Curve:
    if len(points) < 2:
        raise BadInput(f"{path}: shoe {shoe.name!r}: {len(points)} points; must be 2 or more")
    theta, p = np.array(points).T
    if not shoe.flat:  # whole turns do not matter
        theta = (
            shoe.lining.middle + (theta - shoe.lining.middle + math.pi) % (2 * math.pi) - math.pi
        )
    order = np.argsort(theta, kind="stable")
    theta, p = theta[order], p[order]
    same = np.diff(theta) <= 0
    if same.any():
        raise BadInput(
            f"{path}: shoe {shoe.name!r}: {_place(shoe, theta[:-1][same][0])} stands twice"
        )
    return Curve(theta, p)


def _place(shoe: Shoe, at: float) -> str:
    return f"{shoe.surface.coordinate} = {shoe.surface.place(at)}"


def check(brake: Brake, known: Reference, curves: dict[str, Curve]) -> list[Verdict]:
    """The verdict on each shoe. Raises BadInput where the reference is of another brake, or a curve
    does not reach over its lining up to the edge zones.
    """
    if [shoe.name for shoe in known.shoes] != [shoe.name for shoe in brake.shoes]:
        said = ", ".join(shoe.name for shoe in known.shoes)
        raise BadInput(f"the reference is of another brake, with the shoes {said}")
    key = differing(brake, read_any(Path("brake_file"), known.text))
    if key is not None:
        raise BadInput(f"the reference is of another brake: {key} is not the same")
    return [
        _verdict(brake, spec, shoe, curves[shoe.name])
        for spec, shoe in zip(brake.shoes, known.shoes, strict=True)
    ]


def _verdict(brake: Brake, spec: Shoe, known: ShoeReference, curve: Curve) -> Verdict:
    inside = known.inside
    theta, p = known.theta[inside], known.pressure[inside]
    if not len(theta):
        raise BadInput(
            f"shoe {known.name!r}: its lining is shorter than its edge zones; nothing to compare"
        )
    if curve.theta[0] > theta[0] + 1e-9 or curve.theta[-1] < theta[-1] - 1e-9:
        raise BadInput(
            f"shoe {known.name!r}: from {_place(spec, curve.theta[0])} to "
            f"{_place(spec, curve.theta[-1])}: must reach "
            f"from {_place(spec, theta[0])} to {_place(spec, theta[-1])}"
        )
    off = np.interp(theta, *curve) - p
    size = math.sqrt(float(p @ p))
    worst = int(np.abs(off).argmax())
    peak = known.peak_pressure.value
    lever = brake.friction * spec.lining.width * brake.scale_factor**2
    return Verdict(
        shoe=known.name,
        distance=math.sqrt(float(off @ off)) / size if size else math.inf if off.any() else 0.0,
        largest=abs(float(off[worst])) / peak if peak else math.inf if off.any() else 0.0,
        at=_place(spec, float(theta[worst])),
        torque=lever * _area(spec, curve),
        torque_error=abs(lever * float(np.trapezoid(off, theta))) / known.torque.value
        if known.torque.value
        else 0.0,
        floor=known.distance,
        torque_floor=known.torque.relative,
    )


def _area(shoe: Shoe, curve: Curve) -> float:
    """Int p dtheta over the lining, by trapezia of the curve's own points."""
    start, end = shoe.lining.start, shoe.lining.end
    theta = np.concatenate(
        [[start], curve.theta[(curve.theta > start) & (curve.theta < end)], [end]]
    )
    return float(np.trapezoid(np.interp(theta, *curve), theta))


def within(verdicts: Sequence[Verdict], tolerance: float) -> bool:
    """Whether p in L2 and the torque of each shoe are within a relative tolerance."""
    return all(max(v.distance, v.torque_error) <= tolerance for v in verdicts)


def lines(
    verdicts: Sequence[Verdict], tolerance: float, surface: FrictionSurface = DRUM
) -> list[str]:
    """The verdicts for people, the last line the verdict on all, of the effect of a surface."""
    effect, unit = surface.effect, surface.effect_unit
    said = [
        f"shoe {v.shoe!r}: p off by {formatted(v.distance, '.2%')} in L2 (reference known to "
        f"{v.floor:.1e}), at most "
        f"by {formatted(v.largest, '.2%')} of the peak, at {v.at}; that is "
        f"{formatted(v.torque_error, '.2%')} of the "
        f"{effect} (known to {v.torque_floor:.1e}); {effect} of its points {v.torque:.7g} {unit}"
        for v in verdicts
    ]
    return [
        *said,
        f"{'within' if within(verdicts, tolerance) else 'NOT within'} {tolerance:.3g} of the "
        f"reference",
    ]
