"""Reference values of a brake that others can cite, and how far somebody's p(theta) is from them.

Two discretisations that share no mesh, quadratic quadrilaterals and quadratic triangles, both far finer than a solve
needs and graded to every corner and to the ends of the contact, with exact contact. The quadrilaterals give the value,
the distance of the triangles is its uncertainty.
"""

import importlib.metadata
import json
import math
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import drumlin
from drumlin.arrays import Bools, Floats
from drumlin.brake.drum_brake import Brake
from drumlin.brake.units import LARGEST
from drumlin.errors import BadInput
from drumlin.fem.adapt import scene_refined
from drumlin.fem.mesh.grading import fine
from drumlin.fem.model import respond
from drumlin.fem.solve import solve
from drumlin.files import read_text, write_text
from drumlin.response.norms import pressure_distance
from drumlin.response.response import Response, ShoeResponse, contact_resultant, edge_zone
from drumlin.texts import check_digits, check_toml

FORMAT = "drumlin reference values, 1"
DIGITS = 10  # significant digits in a file
PACKAGES = ("numpy", "scipy", "scikit-fem")
_LIST = re.compile(r"\[[-+0-9.eE,\s]*\]")  # in JSON, of numbers only
LARGEST_FILE = 10_000_000  # bytes
METHOD = (
    "2D plane stress, unilateral contact, full-slip Coulomb friction, exact contact; value: graded quadratic "
    "quadrilaterals; uncertainty: distance of graded quadratic triangles, four to a cell of a division of their own"
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
    """A fine mesh: its kind, the least elements along a lining, its shortest element over the lining's thickness, and
    the factor by which elements grow away from corners and contact ends."""

    kind: str
    elements: int
    smallest: float
    along: float


FIRST = Refinement("quad2", 120, 2e-3, 1.4)  # finds the contact's ends
REFINEMENTS = (Refinement("quad2", 400, 7e-4, 1.25), Refinement("tri2", 200, 1e-3, 1.2))


def fine_response(brake: Brake, guess: Response, refinement: Refinement) -> Response:
    """The response with exact contact on a fine mesh, graded to the contact ends of an earlier response."""
    kind, elements, smallest, along = refinement
    divide = partial(fine, elements=elements, smallest=smallest, along=along)
    scene = scene_refined(brake, guess, divide, kind, elements)
    return respond(scene, brake, penalty=math.inf, start=guess)


class Pair(NamedTuple):
    """The two responses of a reference; `value` is the one that is cited."""

    value: Response
    other: Response


def responses(brake: Brake, refinements: tuple[Refinement, Refinement] = REFINEMENTS) -> Pair:
    """Both fine responses of a brake. Raises BadInput where finite elements do not apply or a mesh is given by a file,
    NoAnswer where there is no equilibrium."""
    for shoe in brake.shoes:
        if shoe.mesh is not None:
            raise BadInput(f"shoe {shoe.name!r} has a mesh file, which is not refined: no reference values")
    first = fine_response(brake, solve(brake, elements=40), FIRST)
    value, other = (fine_response(brake, first, refinement) for refinement in refinements)
    return Pair(value, other)


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
    versions: dict[str, str]
    torque: Sure
    shoes: tuple[ShoeReference, ...]


def reference(brake: Brake, text: str, command: str, pair: Pair | None = None) -> Reference:
    """The reference values of a brake; `pair`: its fine responses, already there. Raises as responses."""
    pair = pair or responses(brake)
    versions = {"drumlin": drumlin.__version__, **{name: importlib.metadata.version(name) for name in PACKAGES}}
    shoes = tuple(_shoe(brake, i, *pair) for i in range(len(brake.shoes)))
    torque = Sure(pair.value.torque, math.fsum(shoe.torque.uncertainty for shoe in shoes))  # shoes do not cancel
    return Reference(brake.title, text, command, versions, torque, shoes)


def _sure(value: Any, other: Any) -> Sure:
    """A value whose uncertainty is its distance from another one; of arrays of another shape: infinite."""
    value, other = np.asarray(value, dtype=float), np.asarray(other, dtype=float)
    apart = float(np.linalg.norm(value - other)) if value.shape == other.shape else math.inf
    return Sure(value.tolist(), apart)


def _shoe(brake: Brake, index: int, value: Response, other: Response) -> ShoeReference:
    spec, a, b = brake.shoes[index], value.shoes[index], other.shoes[index]
    edge = edge_zone(spec, brake.drum.radius)
    first, last = spec.lining.start, spec.lining.end
    degrees = np.arange(math.ceil(math.degrees(first) + 1e-6), math.degrees(last) - 1e-6)
    theta = np.radians(degrees)
    pressure = a.pressure_at(theta)
    return ShoeReference(
        name=spec.name,
        torque=_sure(a.torque, b.torque),
        contact_force=_sure(*(contact_resultant(brake, index, x).force for x in (a, b))),
        hinge_reaction=_sure(a.hinge_reaction, b.hinge_reaction),
        peak_pressure=_sure(peak_away(a, edge), peak_away(b, edge)),
        contact_arcs=_sure(np.reshape(a.contact_arcs, (-1, 2)), np.reshape(b.contact_arcs, (-1, 2))),
        ends=(first, last),
        edge=edge,
        theta=theta,
        pressure=pressure,
        uncertainty=np.abs(b.pressure_at(theta) - pressure),
        distance=pressure_distance(b, a) if a.pressure.any() else 0.0,
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
        "method": METHOD,
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
