"""How far plane stress is from a solid shoe: rows of errors, maps over widths and moduli, wear
across the width.

Both models share the section's mesh, so that its error all but drops out of their difference; what
it leaves is told by meshes that double.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.texts import formatted
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import vary
from drumlin.fem.model import respond
from drumlin.fem.preparation.finite_width import finite_width
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.solid import model as solid
from drumlin.fem.solid.face import ContactFace
from drumlin.fem.solve import solve as by_elements
from drumlin.foundation import model as foundation
from drumlin.laws import LAWS, hinged, sine
from drumlin.lining_wear.archard import WearLaw, run_on
from drumlin.lining_wear.linings import fem_setup
from drumlin.response.norms import pressure_distance, relative, vector_distance
from drumlin.response.response import PressureOverWidth, Response, ShoeResponse, edge_zone
from drumlin_studies.uncertainty import Index, Validation, grid_convergence, validate

WIDTH_QUANTITIES = {
    "torque": "torque",
    "pressure": "mean p over the width (L2)",
    "peak": "peak pressure against the face's",
    "reaction": "hinge reaction",
    "uneven": "p on the face off its mean across the width",
    "corrected_torque": "torque, corrected",
    "corrected_pressure": "mean p, corrected",
}
SAID = {"torque": "the torque of each shoe", "pressure": "its mean pressure"}
READER_LIMITS = (0.01, 0.05, 0.20)
"""Errors within which a reader wants to know plane stress."""


class Three(NamedTuple):
    """One brake by the solid, by plane stress, and by plane stress corrected for the width."""

    brake: Brake
    solid: Response
    plane: Response
    corrected: Response


def solve(brake: Brake, elements: int, across: int | None = None) -> Three:
    """A brake by all three, on one mesh of the section."""
    other = finite_width(brake)
    return Three(
        brake, _solid(brake, elements, across), _plane(brake, elements), _plane(other, elements)
    )


def uneven(shoe: ShoeResponse, zone: float) -> float:
    """Standard deviation of p across the width over its mean, root mean square over the lining but
    for its ends.

    zone [rad] at each end of the lining is left out.
    """
    theta, surface = shoe.theta, surface_of(shoe)
    inside = (theta > theta[0] + zone) & (theta < theta[-1] - zone)
    weights = np.gradient(theta)[inside]
    z = surface.z
    across = np.zeros(len(z))
    for k in range(0, len(z) - 2, 2):
        across[k : k + 3] += (z[k + 2] - z[k]) / 6 * np.array([1, 4, 1])
    off = surface.pressure[inside] - shoe.pressure[inside, None]
    variance = weights @ (off**2 @ across) / across.sum()
    size = weights @ shoe.pressure[inside] ** 2
    return float(np.sqrt(variance / size)) if size > 0 else 0.0


def surface_of(shoe: ShoeResponse) -> PressureOverWidth:
    """The surface of a solid shoe's pressure."""
    assert shoe.surface is not None
    return shoe.surface


def highest(shoe: ShoeResponse, zone: float) -> float:
    """The largest pressure on the face [Pa], off the lining's ends."""
    inside = (shoe.theta > shoe.theta[0] + zone) & (shoe.theta < shoe.theta[-1] - zone)
    return float(surface_of(shoe).pressure[inside].max())


def rows(three: Three, case: str = "") -> list[dict[str, Any]]:
    """One row a shoe: errors of plane stress against the solid, as it is and corrected.

    `torque`, `pressure` (L2 of the mean over the width, off the ends), `peak` (plane stress against
    the largest on the face), `reaction`, and `uneven`, how far p is from its mean across the width.
    """
    table = []
    for i, (true, plane, other) in enumerate(
        zip(three.solid.shoes, three.plane.shoes, three.corrected.shoes, strict=True)
    ):
        zone = edge_zone(three.brake.shoes[i], three.brake.scale_factor)
        row: dict[str, Any] = {
            "case": case,
            "shoe": true.name,
            "friction": "assists" if true.self_energising else "opposes",
            "solid_torque": true.torque,
            "uneven": uneven(true, zone),
            "mid_over_side": middle_over_side(true),
        }
        for name, found in (("", plane), ("corrected_", other)):
            row |= {
                f"{name}torque": relative(found.torque, true.torque),
                f"{name}pressure": pressure_distance(found, true, zone),
                f"{name}peak": relative(found.peak_pressure, highest(true, zone)),
                f"{name}reaction": vector_distance(found.hinge_reaction, true.hinge_reaction),
            }
        table.append(row)
    return table


def middle_over_side(shoe: ShoeResponse) -> float:
    """Pressure at the mid-plane over that at the sides, in the middle of the lining's pressed
    nodes.
    """
    p = surface_of(shoe).pressure
    pressed = np.flatnonzero((p > 0).all(axis=1))
    if not len(pressed):
        return float("inf")
    row = p[pressed[len(pressed) // 2]]
    return float(row[len(row) // 2] / row[-1])


def worst(table: Sequence[dict[str, Any]], key: str) -> float:
    """The entry of largest size among the shoes."""
    return float(max((row[key] for row in table), key=abs))


@dataclass(frozen=True)
class Map:
    """Errors over two groups of the names `axes`: `x` (n,), `y` (m,), and by key (m, n) the worst
    shoe's, fractions.
    """

    name: str
    axes: tuple[str, str]
    x: Floats
    y: Floats
    errors: dict[str, Floats]

    def share_within(self, limit: float, key: str = "torque") -> float:
        """The share of the brakes within a limit."""
        return float(np.mean(np.abs(self.errors[key]) <= limit))

    def where_within(self, limit: float, key: str = "torque") -> str:
        """In which of the brakes an error is within a limit, by each group alone, in words."""
        within = np.abs(self.errors[key]) <= limit
        if within.all():
            return "everywhere"
        found = []
        for name, values, along in zip(self.axes, (self.x, self.y), (0, 1), strict=True):
            lines = np.asarray(within.all(axis=along))
            upwards, downwards = (int(np.cumprod(side).sum()) for side in (lines[::-1], lines))
            if upwards:
                found.append(f"{name} from {values[-upwards]:g} on")
            if downwards:
                found.append(f"{name} up to {values[downwards - 1]:g}")
        return " or ".join(found) or "for no whole row or column of the map"


def chart(
    name: str,
    axes: tuple[str, str],
    brake_at: Callable[[float, float], Brake],
    x: Sequence[float],
    y: Sequence[float],
    elements: int,
    say: Callable[[str], None],
) -> Map:
    """The errors over a grid of brakes."""
    keys = [*WIDTH_QUANTITIES, "mid_over_side"]
    errors = {key: np.full((len(y), len(x)), np.nan) for key in keys}
    for j, b in enumerate(y):
        for i, a in enumerate(x):
            say(f"{name}: {j * len(x) + i} of {len(x) * len(y)}")
            table = rows(solve(brake_at(a, b), elements))
            for key in keys:
                errors[key][j, i] = worst(table, key)
    return Map(name, axes, np.asarray(x), np.asarray(y), errors)


def shares(charts: Sequence[Map]) -> list[dict[str, Any]]:
    """A row for each quantity of each chart: the share of the brakes within each of READER_LIMITS, and the
    largest error.
    """
    return [
        {
            "map": chart.name,
            "quantity": WIDTH_QUANTITIES[key],
            "largest": float(np.abs(chart.errors[key]).max()),
        }
        | {f"within_{limit:g}": chart.share_within(limit, key) for limit in READER_LIMITS}
        for chart in charts
        for key in WIDTH_QUANTITIES
    ]


class Certain(NamedTuple):
    """A torque on three meshes, each twice as fine: `elements`, values [N m], and the index
    `found`; None where no order shows.
    """

    elements: tuple[int, ...]
    values: tuple[float, ...]
    found: Index | None

    @property
    def uncertainty(self) -> float:
        """Of the finest value [N m]: its index, or the spread of the three."""
        fine = self.values[-1]
        return self.found.fine * abs(fine) if self.found else float(np.ptp(self.values))


def certain(torque: Callable[[int], float], elements: Sequence[int]) -> Certain:
    """The torque on three meshes, coarse to fine."""
    values = tuple(torque(n) for n in elements)
    try:
        index = grid_convergence(*values[::-1])
    except ValueError:
        index = None
    return Certain(tuple(elements), values, index)


def validation(plane: Certain, true: Certain) -> Validation:
    """Plane stress against the solid as reference, E = S - D, each with the uncertainty of its
    meshes.
    """
    return validate(
        plane.values[-1], true.values[-1], numerical=plane.uncertainty, of_data=true.uncertainty
    )


class Rung(NamedTuple):
    """A way to solve a brake: seconds of processor time, and its errors of torque and pressure (L2
    of the mean over the width, off the ends), the worst shoe's, against the solid truth and against
    that of plane stress.
    """

    method: str
    setting: str
    seconds: float
    torque: float
    pressure: float
    plane_torque: float
    plane_pressure: float


def ladder(brake: Brake, fine: int, meshes: Sequence[int], solids: Sequence[int]) -> list[Rung]:
    """Laws, the foundation model where it applies, plane stress on several `meshes`, corrected for
    the width, and solids on several, against a `fine` solid and against plane stress to 1e-4.
    """
    truths = _solid(brake, fine), by_elements(brake)
    other = finite_width(brake)
    ways: list[tuple[str, str, Callable[[], Response]]] = [
        (name, "", partial(hinged.solve, LAWS[name], brake))
        for name in ("sine", "cosine", "uniform")
    ]
    if foundation.why_not(brake) is None:
        ways += [
            (name, ", ".join(lift), partial(foundation.solve, brake, lift=lift))
            for name, lift in (("foundation", ()), ("lifted", ("all",)))
        ]
    for n in meshes:
        ways.append(("plane stress", f"{n} elements", partial(_plane, brake, n)))
        ways.append(("plane stress, corrected", f"{n} elements", partial(_plane, other, n)))
    ways += [("solid", f"{n} elements", partial(_solid, brake, n)) for n in solids]
    found = []
    for method, setting, way in ways:
        seconds = []
        for _ in range(
            1 if method == "solid" else 4
        ):  # what is loaded and cached by a first call is not counted
            start = time.process_time()
            response = way()
            seconds.append(time.process_time() - start)
        errors = [
            max(
                (
                    abs(of(a, b, shoe, brake))
                    for a, b, shoe in zip(response.shoes, truth.shoes, brake.shoes, strict=True)
                )
            )
            for truth in truths
            for of in (_torque_off, _pressure_off)
        ]
        found.append(Rung(method, setting, float(np.median(seconds[1:] or seconds)), *errors))
    return found


def _plane(brake: Brake, elements: int) -> Response:
    return respond(prepare(brake, elements=elements), brake)


def _solid(brake: Brake, elements: int, across: int | None = None) -> Response:
    return respond(solid.prepare(brake, elements=elements, across=across), brake)


def _torque_off(a: ShoeResponse, b: ShoeResponse, shoe: Shoe, brake: Brake) -> float:
    return relative(a.torque, b.torque)


def _pressure_off(a: ShoeResponse, b: ShoeResponse, shoe: Shoe, brake: Brake) -> float:
    return pressure_distance(a, b, edge_zone(shoe, brake.scale_factor))


class WornSolid(NamedTuple):
    """A solid lining over the sliding distance, in 1/(k K): by shoe how uneven p is, and its mean's
    distance (L2) from the sine law; `last`: the response as it is worn in.
    """

    distance: tuple[float, ...]
    uneven: tuple[tuple[float, ...], ...]
    from_law: tuple[tuple[float, ...], ...]
    last: tuple[ShoeResponse, ...]


def wear(
    brake: Brake, elements: int, distances: Sequence[float], across: int | None = None
) -> WornSolid:
    """Run a brake's solid linings in by Archard's wear; the first of `distances` is 0."""
    scene = solid.prepare(brake, elements=elements, across=across)
    start, law = respond(scene, brake), sine(brake)
    setup = fem_setup(scene, brake)
    unit = 1 / setup.stiffness  # of k p: a coefficient of 1/Pa
    states = run_on(setup.interfaces, WearLaw(1.0), [s * unit for s in distances[1:]])
    shoes = [
        [
            _worn(scene.bodies[s.shoe].line, start.shoes[s.shoe], s.part, s.forward, at.pressure)
            for at in states
        ]
        for s in setup.surfaces
    ]
    zones = [edge_zone(brake.shoes[s.shoe], brake.scale_factor) for s in setup.surfaces]
    return WornSolid(
        tuple(distances),
        tuple(
            tuple(uneven(shoe, zone) for shoe in each)
            for each, zone in zip(shoes, zones, strict=True)
        ),
        tuple(
            tuple(pressure_distance(shoe, law.shoes[s.shoe], zone) for shoe in each)
            for each, zone, s in zip(shoes, zones, setup.surfaces, strict=True)
        ),
        tuple(each[-1] for each in shoes),
    )


def _worn(
    line: Any, first: ShoeResponse, part: slice, forward: slice, pressure: Floats
) -> ShoeResponse:
    assert isinstance(line, ContactFace)
    p = pressure[part]
    _, mean = line.along(p)
    surface = line.surface(p)
    return replace(
        first, pressure=mean[forward], surface=surface._replace(pressure=surface.pressure[forward])
    )


def plain(brake: Brake, width: float, modulus: float) -> Brake:
    """The brake with one width [m] and no table, its lining of this modulus [Pa]."""
    return vary(
        brake,
        {
            "shoe.lining.width": width,
            "shoe.body.width": width,
            "shoe.backing": None,
            "shoe.lining.material.E": modulus,
        },
    )


def along(curves: Mapping[str, Sequence[tuple[float, list[dict[str, Any]]]]]) -> list[str]:
    """Of one brake over a quantity at a time: where plane stress is off most."""
    lines = []
    for name, points in curves.items():
        most = {
            key: max(((abs(worst(table, key)), at) for at, table in points))
            for key in ("torque", "pressure")
        }
        off = ", ".join(
            f"{said} by {formatted(most[key][0], '.1%')} (at {most[key][1]:g})"
            for key, said in SAID.items()
        )
        lines.append(
            f"T-section over {name} from {points[0][0]:g} to {points[-1][0]:g}, off at most: {off}"
        )
    return lines


def sentence(charts: Sequence[Map]) -> list[str]:
    """What a reader needs: of each chart, which brakes plane stress prices within 1, 5 and 20 %."""
    lines = []
    for chart in charts:
        worst_of = chart.errors["torque"].ravel()[np.abs(chart.errors["torque"]).argmax()]
        for key, said in SAID.items():
            found = [(limit, chart.where_within(limit, key)) for limit in READER_LIMITS]
            last = next(
                (k for k, (_, where) in enumerate(found) if where == "everywhere"), len(found) - 1
            )
            parts = "; ".join(
                f"{formatted(limit, '.0%')}: {where}" for limit, where in found[: last + 1]
            )
            end = f" (at worst {formatted(worst_of, '+.1%')})" if key == "torque" else ""
            lines.append(f"{chart.name}: plane stress has {said}{end} within {parts}")
    return lines
