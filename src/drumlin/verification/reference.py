"""Reference values of a brake that others can cite, and how far somebody's p(theta) is from them.

The value comes from columns of high degree on the finer of two divisions, with exact contact. Its uncertainty is the
larger of two distances: from the other division, of another degree and grading, and from curved triangles, which share
nothing with it but the brake.
"""

import importlib.metadata
import json
import math
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import drumlin
from drumlin.arrays import Bools, Floats
from drumlin.brake.drum_brake import Brake
from drumlin.brake.units import LARGEST
from drumlin.errors import BadInput
from drumlin.fem.hp.division import Level
from drumlin.fem.hp.levels import steps
from drumlin.fem.hp.places import places_of
from drumlin.fem.hp.scene import scene
from drumlin.fem.model import respond
from drumlin.files import read_text, write_text
from drumlin.response.balance import contact_resultant
from drumlin.response.norms import pressure_distance
from drumlin.response.response import Response, ShoeResponse, edge_zone, pressed_shoe
from drumlin.texts import check_digits, check_toml
from drumlin.verification import triangles

FORMAT = "drumlin reference values, 1"
DIGITS = 10  # significant digits in a file
PACKAGES = ("numpy", "scipy", "scikit-fem")
_LIST = re.compile(r"\[[-+0-9.eE,\s]*\]")  # in JSON, of numbers only
LARGEST_FILE = 10_000_000  # bytes
METHOD = (
    "2D plane stress, unilateral contact, full-slip Coulomb friction, exact contact; value: columns of elements of "
    "high degree; uncertainty: the larger of the distances from another division of them and from curved triangles "
    "with contact node by node"
)
ALONE = (
    "2D plane stress, unilateral contact, full-slip Coulomb friction, exact contact; value: columns of elements of "
    "high degree; uncertainty: the distance from another division of them"
)
UNITS = {
    "torque": "N m",
    "contact_force": "N",
    "hinge_reaction": "N",
    "peak_pressure": "Pa",
    "contact_arcs": "rad",
    "edge": "rad",
    "theta": "rad",
    "pressure": "Pa",
    "pressure_uncertainty": "Pa",
}


class Refinement(NamedTuple):
    """How finely a reference is solved: two divisions into columns, the second one cited, after `first` levels that
    find the ends of the contact; the meshes of triangles."""

    first: int
    levels: tuple[Level, Level]
    triangles: tuple[triangles.Level, ...]


DEG = math.pi / 180
FINE = Refinement(
    3,
    (
        Level(7, 0.02, 0.01, 0.002, 0.45, 15 * DEG, 0.02, 0.01, 0.01, 0.3),
        Level(8, 0.01, 0.006, 0.001, 0.5, 15 * DEG, 0.015, 0.003, 0.01, 0.4),
    ),
    triangles.LEVELS,
)
"""Sizes that grow slowly towards the ends of the layers and the hinge, where the torque feels them; thinner columns at
the lining's ends would cost a stiff shoe more digits than they bring."""


class Trio(NamedTuple):
    """The responses of a reference: `value` is cited, `before` on the other division, `other` by triangles, None where
    these do not cover the brake."""

    value: Response
    before: Response
    other: Response | None

    @property
    def others(self) -> tuple[Response, ...]:
        """Those whose distances are the uncertainty."""
        return (self.before,) if self.other is None else (self.before, self.other)


def responses(brake: Brake, refinement: Refinement = FINE) -> Trio:
    """The fine responses of a brake. Raises BadInput where finite elements do not apply or a mesh is given by a file,
    NoAnswer where there is no equilibrium."""
    brake.check_hinged("reference")
    for shoe in brake.shoes:
        if shoe.mesh is not None:
            raise BadInput(f"shoe {shoe.name!r} has a mesh file, which is not refined: no reference values")
    respond_ = partial(respond, penalty=math.inf)
    *_, last = islice((step.response for step in steps(brake, respond_)), refinement.first)
    found = []
    for level in refinement.levels:
        last = respond_(scene(brake, level, places_of(brake, last)), brake, start=last)
        found.append(last)
    before, value = found
    return Trio(value, before, _by_triangles(brake, value, refinement))


def _by_triangles(brake: Brake, like: Response, refinement: Refinement) -> Response | None:
    """The finest solution by triangles in the form of `like`; None where they do not cover the brake."""
    try:
        *_, solutions = triangles.sequence(brake, refinement.triangles)
    except BadInput:
        return None
    shoes = [
        pressed_shoe(
            shoe,
            brake.drum.radius,
            found.theta,
            found.pressure,
            order=found.order,
            torque=found.torque,
            normal_force=found.normal_force,
            self_energising=own.self_energising,
            hinge_reaction=found.hinge_reaction,
        )
        for shoe, found, own in zip(brake.shoes, solutions, like.shoes, strict=True)
    ]
    return replace(like, model="triangles", shoes=tuple(shoes))


def peak_away(response: ShoeResponse, edge: float, points: int = 2001) -> float:
    """Largest pressure [Pa] outside zones of `edge` [rad] at the lining's ends, at evenly spread angles."""
    start, end = response.theta[0] + edge, response.theta[-1] - edge
    return float(response.pressure_at(np.linspace(start, end, points)).max())


@dataclass(frozen=True)
class Sure:
    """A value, a number or an array, with its absolute uncertainty."""

    value: Any
    uncertainty: float

    @property
    def relative(self) -> float:
        """The uncertainty over the value's size; 0 where the uncertainty is."""
        size = float(np.linalg.norm(self.value))
        return self.uncertainty / size if size else math.inf if self.uncertainty else 0.0


@dataclass(frozen=True)
class ShoeReference:
    """What is known of one shoe.

    `contact_force` (2,) [N]: of the drum on the lining, friction included. `peak_pressure` [Pa]: outside the zones of
    `edge` [rad] at the lining's ends. `contact_arcs` (k, 2) [rad]. `theta` (n,) [rad], whole degrees, `pressure` and
    `uncertainty` (n,) [Pa]. `distance`: relative L2 distance of both pressures outside EDGE_ZONE at the ends.
    """

    name: str
    torque: Sure
    contact_force: Sure
    hinge_reaction: Sure
    peak_pressure: Sure
    contact_arcs: Sure
    ends: tuple[float, float]
    edge: float
    theta: Floats
    pressure: Floats
    uncertainty: Floats
    distance: float

    @property
    def inside(self) -> Bools:
        """Which angles are not in the edge zones."""
        return np.asarray((self.theta > self.ends[0] + self.edge) & (self.theta < self.ends[1] - self.edge))

    @property
    def pressure_uncertainty(self) -> float:
        """The largest uncertainty of p outside the edge zones, over the peak pressure."""
        peak = self.peak_pressure.value
        return float(self.uncertainty[self.inside].max() / peak) if peak else 0.0


@dataclass(frozen=True)
class Reference:
    """Reference values of a brake: `text` is its file, `command` makes them again."""

    title: str
    text: str
    command: str
    method: str
    versions: dict[str, str]
    torque: Sure
    shoes: tuple[ShoeReference, ...]


def reference(brake: Brake, text: str, command: str, trio: Trio | None = None) -> Reference:
    """The reference values of a brake; `trio`: its fine responses, already there. Raises as responses."""
    trio = trio or responses(brake)
    versions = {"drumlin": drumlin.__version__, **{name: importlib.metadata.version(name) for name in PACKAGES}}
    shoes = tuple(_shoe(brake, i, trio) for i in range(len(brake.shoes)))
    torque = Sure(trio.value.torque, math.fsum(shoe.torque.uncertainty for shoe in shoes))  # shoes do not cancel
    method = ALONE if trio.other is None else METHOD
    return Reference(brake.title, text, command, method, versions, torque, shoes)


def _sure(value: Any, *others: Any) -> Sure:
    """A value whose uncertainty is its distance from the farthest of others; of arrays of another shape: infinite."""
    value = np.asarray(value, dtype=float)
    apart = 0.0
    for other in others:
        off = np.asarray(other, dtype=float)
        apart = max(apart, float(np.linalg.norm(value - off)) if value.shape == off.shape else math.inf)
    return Sure(value.tolist(), apart)


def _shoe(brake: Brake, index: int, trio: Trio) -> ShoeReference:
    spec = brake.shoes[index]
    own = [response.shoes[index] for response in (trio.value, *trio.others)]
    a = own[0]
    edge = edge_zone(spec, brake.drum.radius)
    first, last = spec.lining.start, spec.lining.end
    degrees = np.arange(math.ceil(math.degrees(first) + 1e-6), math.degrees(last) - 1e-6)
    theta = np.radians(degrees)
    pressure = a.pressure_at(theta)
    return ShoeReference(
        name=spec.name,
        torque=_sure(*(x.torque for x in own)),
        contact_force=_sure(*(contact_resultant(brake, index, x).force for x in own)),
        hinge_reaction=_sure(*(x.hinge_reaction for x in own)),
        peak_pressure=_sure(*(peak_away(x, edge) for x in own)),
        contact_arcs=_sure(*(np.reshape(x.contact_arcs, (-1, 2)) for x in own)),
        ends=(first, last),
        edge=edge,
        theta=theta,
        pressure=pressure,
        uncertainty=np.max([np.abs(x.pressure_at(theta) - pressure) for x in own[1:]], axis=0),
        distance=max(pressure_distance(x, a) for x in own[1:]) if a.pressure.any() else 0.0,
    )


def _rounded(value: Any, digits: int = DIGITS) -> Any:
    """Numbers, also in lists, to so many significant digits."""
    if isinstance(value, list):
        return [_rounded(each, digits) for each in value]
    return float(f"{value:.{digits}g}")


def _sure_data(sure: Sure) -> dict[str, Any]:
    finite = math.isfinite(sure.uncertainty)
    return {"value": _rounded(sure.value), "uncertainty": _rounded(sure.uncertainty, 3) if finite else None}


def as_dict(found: Reference) -> dict[str, Any]:
    """Reference values as plain data for JSON."""
    shoes = [
        {
            "name": shoe.name,
            **{
                key: _sure_data(getattr(shoe, key))
                for key in ("torque", "contact_force", "hinge_reaction", "peak_pressure", "contact_arcs")
            },
            "lining": _rounded(list(shoe.ends)),
            "edge": _rounded(shoe.edge),
            "pressure_distance": _rounded(shoe.distance, 3),
            "theta": _rounded(shoe.theta.tolist()),
            "pressure": _rounded(shoe.pressure.tolist()),
            "pressure_uncertainty": _rounded(shoe.uncertainty.tolist(), 3),
        }
        for shoe in found.shoes
    ]
    return {
        "format": FORMAT,
        "title": found.title,
        "method": found.method,
        "units": UNITS,
        "command": found.command,
        "versions": found.versions,
        "torque": _sure_data(found.torque),
        "shoes": shoes,
        "brake_file": found.text,
    }


def write_values(data: dict[str, Any], path: Path) -> None:
    """Write reference values, as as_dict gives them, as JSON; a list of numbers stands on one line."""
    text = json.dumps(data, indent=1, allow_nan=False)
    write_text(path, _LIST.sub(lambda match: " ".join(match.group().split()), text) + "\n")


def read_reference(path: Path) -> Reference:
    """Reference values from a file that write_values made. Raises BadInput with one line."""
    text = read_text(path, LARGEST_FILE, "a file of reference values")
    try:
        check_digits(text)
        data = json.loads(text, parse_constant=_refused)
        if data["format"] != FORMAT:
            raise BadInput(f"{path}: format = {data['format']!r}: must be {FORMAT!r}")
        return Reference(
            _text(data["title"]),
            _text(data["brake_file"]),
            _text(data["command"]),
            _text(data["method"]),
            {_text(name): _text(version) for name, version in data["versions"].items()},
            _sure_from(data["torque"]),
            tuple(_shoe_from(shoe) for shoe in data["shoes"]),
        )
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError, OverflowError) as error:
        raise BadInput(f"{path}: holds no reference values in the form of `drumlin reference`") from error


def summary_rows(values: Mapping[str, Any], name: str) -> list[dict[str, Any]]:
    """A row a shoe of reference values as plain data: what is known of it, and which of six digits of its torque and
    four of p away from the edges it is short of."""
    rows = []
    for shoe in values["shoes"]:
        peak, (start, end), edge = shoe["peak_pressure"]["value"], shoe["lining"], shoe["edge"]
        away = [
            u
            for angle, u in zip(shoe["theta"], shoe["pressure_uncertainty"], strict=True)
            if start + edge < angle < end - edge
        ]
        torque = shoe["torque"]["uncertainty"] / shoe["torque"]["value"]
        pressure = max(away) / peak
        short = [f"six digits of torque ({torque:.0e})"] * (torque > 1e-6)
        short += [f"four digits of p ({pressure:.0e})"] * (pressure > 1e-4)
        arcs = [f"{math.degrees(a):.3f} to {math.degrees(b):.3f}" for a, b in shoe["contact_arcs"]["value"]]
        rows.append(
            {
                "brake": name,
                "shoe": shoe["name"],
                "torque": shoe["torque"]["value"],
                "torque_uncertainty": torque,
                "reaction": ", ".join(f"{x:.7g}" for x in shoe["hinge_reaction"]["value"]),
                "contact": ", ".join(arcs),
                "pressure": pressure,
                "digits": "; ".join(short) or "nothing",
            }
        )
    return rows


def _refused(word: str) -> float:
    raise ValueError(f"{word} is no number of JSON")


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise TypeError("not a text")
    return value


def _numbers(value: object, *shape: int) -> Floats:
    """Finite numbers of a shape; -1: of any length. Raises ValueError, TypeError."""
    array = np.array(value, dtype=float)
    if array.size == 0:
        array = array.reshape([max(length, 0) for length in shape])
    fits = array.ndim == len(shape) and all(n in {-1, m} for n, m in zip(shape, array.shape, strict=True))
    if not fits or not (np.abs(array) <= LARGEST).all():
        raise ValueError("not finite numbers of the shape that is needed")
    return array


def _sure_from(data: dict[str, Any], *shape: int) -> Sure:
    known = data["uncertainty"]
    return Sure(_numbers(data["value"], *shape).tolist(), math.inf if known is None else _size(known))


def _size(value: object) -> float:
    """A number that is not negative."""
    size = float(_numbers(value))
    if size < 0:
        raise ValueError("negative")
    return size


def _shoe_from(data: dict[str, Any]) -> ShoeReference:
    theta = _numbers(data["theta"], -1)
    pressure, uncertainty = (_numbers(data[key], len(theta)) for key in ("pressure", "pressure_uncertainty"))
    first, last = _numbers(data["lining"], 2).tolist()
    if not first < last or (np.diff(theta) <= 0).any():
        raise ValueError("angles that do not grow")
    return ShoeReference(
        name=_text(data["name"]),
        torque=_sure_from(data["torque"]),
        contact_force=_sure_from(data["contact_force"], 2),
        hinge_reaction=_sure_from(data["hinge_reaction"], 2),
        peak_pressure=_sure_from(data["peak_pressure"]),
        contact_arcs=_sure_from(data["contact_arcs"], -1, 2),
        ends=(first, last),
        edge=_size(data["edge"]),
        theta=theta,
        pressure=pressure,
        uncertainty=uncertainty,
        distance=_size(data["pressure_distance"]),
    )


def stored(text: str, *folders: Path) -> Path | None:
    """The file with reference values of a brake file that says what this text says, comments aside, in the first of
    the folders that has one.
    """
    asked = _said(text)
    for folder in folders:
        for path in sorted(folder.glob("*.json")):
            try:
                if _said(json.loads(read_text(path, LARGEST_FILE, "reference values"))["brake_file"]) == asked:
                    return path
            except (BadInput, ValueError, LookupError, TypeError, RecursionError):
                continue  # another JSON file
    return None


def _said(text: str) -> object:
    """What a TOML text says; of another its words."""
    try:
        check_toml(text)
        return tomllib.loads(text)
    except (ValueError, RecursionError):
        return text
