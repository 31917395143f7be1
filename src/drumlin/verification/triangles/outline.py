"""The outlines of shoes as layered bodies, and the first lines of their meshes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.brake.beam_axis import axis_of
from drumlin.brake.brake import Shoe
from drumlin.brake.components import Beam
from drumlin.brake.elasticity import ElasticLayer
from drumlin.verification.triangles.triangulation import (
    Map,
    TriangleLayer,
    Triangles,
    graded,
    spaced,
    start,
)

SLENDER = 12.0
"""Largest length of triangles far from all corners, over the thickness of the thinnest layer."""


class TriangleLevel(NamedTuple):
    """A mesh: degree of its triangles, `halvings` towards each corner, length of triangles over
    their distance from it, and factor on all lengths elsewhere.
    """

    degree: int
    halvings: int
    steep: float
    size: float


class Sharp(NamedTuple):
    """Places on a face at which p is not smooth: their `s` (k,), and the length of triangles there
    (k,) [m].
    """

    s: Floats
    smallest: Floats


@dataclass(frozen=True)
class Outline:
    """A layered body in the coordinates s, d: `place` maps them; `s` are the ends of its parts,
    `thickness` (layers,) [m]; `corners` (k, 2) the s, d of the points to which triangles are
    graded; `held` s of the end face that is, or None where the back is, all of it or its `grip`;
    `loaded` s or None; `turn`: theta = origin + turn s; `length` [m] per s.
    """

    place: Map
    layers: list[TriangleLayer]
    thickness: Floats
    s: Floats
    corners: Floats
    held: float | None
    loaded: float | None
    origin: float
    turn: int
    length: float
    grip: tuple[float, float] | None = None
    plates: int = 1

    @property
    def front(self) -> int:
        """d where the body begins, which has so many `plates`."""
        return len(self.layers) - self.plates

    @property
    def least(self) -> float:
        """The length from which halvings towards a corner count [m]."""
        arc = (self.layers[0].end - self.layers[0].start) * self.length
        return min(float(self.thickness.min()), arc / 4)


def outline(shoe: Shoe, R: float) -> Outline:
    """The outline of a shoe. Raises BadInput for one without a section, or with its own mesh."""
    lining, backing, body = shoe.lining, shoe.backing, shoe.body
    if shoe.mesh is not None:
        raise BadInput(f"shoe {shoe.name!r} has a mesh of its own")
    if isinstance(body, Beam):
        return _post(shoe, R)
    parts = [(lining.thickness, lining.material)] + (
        [(backing.thickness, backing.material)] if backing else []
    )
    layers = [
        TriangleLayer(lining.start, lining.end, ElasticLayer.of(material, lining.width))
        for _, material in parts
    ]
    thickness = [t for t, _ in parts]
    held = loaded = grip = None
    s = [lining.start, lining.end]
    corners = [(end, float(d)) for end in s for d in range(len(parts) + 1)]
    if body is not None:
        for plate in body.plates.values():
            layers.append(
                TriangleLayer(body.start, body.end, ElasticLayer.of(plate.material, plate.width))
            )
            thickness.append(plate.thickness)
        s += [body.start, body.end]
        corners += [
            (end, float(d))
            for end in (body.start, body.end)
            for d in range(len(parts), len(layers) + 1)
        ]
        of = shoe.grip(R)
        if of is None:
            held, loaded = sorted(
                (body.start, body.end), key=lambda end: abs(float(shoe.frame.phi(np.array(end))))
            )
        else:  # the force acts on what holds the back
            first, last = sorted(shoe.frame.theta(np.array(of)).tolist())
            grip = first, last
            s += grip
            corners += [(end, float(len(layers))) for end in grip]
    depths = np.concatenate([[0.0], np.cumsum(thickness)])

    def place(s: Floats, d: Floats) -> Floats:
        r = R - shoe.sign * np.interp(d, np.arange(len(depths)), depths)
        return np.stack([r * np.cos(s), r * np.sin(s)], axis=-1)

    ends, points, plates = _distinct(s), np.unique(corners, axis=0), len(layers) - len(parts)
    return Outline(
        place, layers, np.array(thickness), ends, points, held, loaded, 0.0, 1, R, grip, plates
    )


def _post(shoe: Shoe, R: float) -> Outline:
    """A straight beam with a square-cut block; s is the beam's angle under the lining's back."""
    lining, backing, body = shoe.lining, shoe.backing, shoe.body
    assert isinstance(body, Beam)
    section = body.section
    if section is None or backing is None:
        raise BadInput(
            f"shoe {shoe.name!r}: its beam has no constant section, or nothing before it"
        )
    axis = axis_of(shoe.pin.xy, shoe.actuation.point.xy)
    first, last = np.sort(axis.angle(np.array([lining.start, lining.end]))).tolist()
    t, back = lining.thickness, R + lining.thickness
    low = first - (axis.foot + back * math.sin(first)) / back
    high = last + (axis.length - axis.foot - back * math.sin(last)) / back
    face = section.thickness / 2

    def place(s: Floats, d: Floats) -> Floats:
        inside = np.clip(s, first, last)
        along = axis.foot + back * (np.sin(inside) + (s - inside))
        r = R + t * np.minimum(d, 1)
        x = np.where(d < 1, axis.foot + r * np.sin(s), along)
        y = axis.distance - r * np.cos(inside)
        y = y + np.clip(d - 1, 0, 1) * (face - y)
        y = np.where(d >= 2, face - (d - 2) * section.thickness, y)
        return axis.to_brake(x, y)

    block = axis.distance - face - back * min(math.cos(first), math.cos(last))
    layers = [
        TriangleLayer(first, last, ElasticLayer.of(lining.material, lining.width)),
        TriangleLayer(first, last, ElasticLayer.of(backing.material, lining.width, axis.along)),
        TriangleLayer(low, high, ElasticLayer.of(section.material, section.width, axis.along)),
    ]
    corners = [(s, d) for s in (first, last) for d in (0.0, 1.0, 2.0)] + [
        (s, d) for s in (low, high) for d in (2.0, 3.0)
    ]
    thickness = np.array([t, block, section.thickness])
    origin = lining.middle - axis.sense * float(axis.angle(np.array(lining.middle)))
    s = _distinct([low, first, last, high])
    return Outline(
        place, layers, thickness, s, np.unique(corners, axis=0), low, high, origin, axis.sense, back
    )


def _distinct(values: Sequence[float]) -> Floats:
    """Growing values, those that are equal to round-off once."""
    grown = np.unique(values)
    return grown[np.append(True, np.diff(grown) > 1e-9)]


def grid(
    shape: Outline, size: float, wavelength: float, points: Sequence[float]
) -> tuple[Floats, list[Floats]]:
    """The first lines of a mesh in s, and in d for each layer: nearly square cells at the corners
    and at `points` (s) of the face, slender ones elsewhere; wavelength [m] of what the gap does.
    """
    face = shape.layers[0]
    arc = (face.end - face.start) * shape.length
    thinnest = float(
        shape.thickness[
            : len(shape.layers) - (shape.held is not None or shape.grip is not None)
        ].min()
    )
    least = min(thinnest, arc / 4) * size
    most = max(least, min(SLENDER * float(shape.thickness.min()), arc / 8, wavelength / 4) * size)
    dense = np.concatenate([shape.s, points])
    ends = (dense > face.start - 1e-9) & (dense < face.end + 1e-9)
    near = np.where(ends, least, max(least, float(shape.thickness[-1]) / 4 * size))

    def along(s: float) -> float:
        return (
            min(most, float((near + 0.5 * shape.length * np.abs(dense - s)).min())) / shape.length
        )

    s = spaced(shape.s, along)
    d = []
    for j, t in enumerate(shape.thickness.tolist()):
        coarsest = t * (1.0 if j == 0 else 0.5) * min(1.0, 1.25 * size)

        def across(x: float, t: float = t, coarsest: float = coarsest) -> float:
            return min(coarsest / t, least / t + min(x, 1 - x))

        d.append(j + spaced(np.array([0.0, 1.0]), across))
    return s, d


class Draft(NamedTuple):
    """A body's mesh before it has nodes, with the first lines `s` it began from, and where it is
    sharp.
    """

    shape: Outline
    s: Floats
    sharp: Sharp
    mesh: Triangles


def draft(shape: Outline, sharp: Sharp, level: TriangleLevel, wavelength: float) -> Draft:
    """The mesh of a body, graded to its corners and to the sharp places of its face."""
    s, d = grid(shape, level.size, wavelength, sharp.s.tolist())
    points = np.concatenate([shape.corners, np.stack([sharp.s, 0 * sharp.s], axis=1)])
    smallest = np.concatenate(
        [np.full(len(shape.corners), shape.least * 0.5**level.halvings), sharp.smallest]
    )
    at = shape.place(points[:, 0], points[:, 1])
    return Draft(
        shape, s, sharp, graded(start(s, d, shape.layers), shape.place, at, smallest, level.steep)
    )
