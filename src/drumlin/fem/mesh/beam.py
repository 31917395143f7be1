"""Mesh of a straight-beam shoe: lining, block that fills the space up to the beam, beam; in the
shoe's frame.

The block is cut square to the beam: behind the lining's back at the angle theta it reaches the
beam's face at the same distance along the beam.
"""

import math
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.beam_axis import Axis, axis_of
from drumlin.brake.brake import Shoe
from drumlin.brake.components import Beam, Section
from drumlin.brake.units import mm
from drumlin.fem.mesh.grading import MOST_LAYERS, MOST_THIN, LiningDivision, layers_behind, overhang

PARTS = ("lining", "backing", "shoe")


def why_not(shoe: Shoe, radius: float) -> str | None:
    """Why a shoe with a straight beam cannot be meshed (None: it can, or has no beam)."""
    if not isinstance(shoe.body, Beam) or shoe.mesh is not None:
        return None
    section = shoe.body.section
    if section is None:
        return "its beam has no constant section to mesh: thickness, and width and material or one bending_stiffness"
    if shoe.backing is None:
        return "nothing fills the space between its straight beam and the lining: no [shoe.backing]"
    if isinstance(shoe.body.offset, tuple) and any(offset for _, offset in shoe.body.offset):
        return "a beam with a curved axis is not meshed"
    return _no_room(shoe, axis_of(shoe.pin.xy, shoe.actuation.point.xy), section, radius)


def _no_room(shoe: Shoe, axis: Axis, section: Section, radius: float) -> str | None:
    back = radius + shoe.lining.thickness
    ends = axis.angle(np.array([shoe.lining.start, shoe.lining.end]))
    x = axis.foot + back * np.sin(ends)
    nearest = back * (1.0 if ends.min() < 0 < ends.max() else float(np.cos(ends).max()))
    room = axis.distance - section.thickness / 2 - nearest
    if room <= 0:
        return f"its beam reaches {mm(-room)} into the lining; there is no room for the block"
    if x.min() < 0 or x.max() > axis.length:
        return "its block reaches beyond the beam's ends"
    return None


def beam_mesh(shoe: Shoe, radius: float, division: LiningDivision, shape: Any) -> Any:
    """Mesh of a straight-beam shoe in its own frame, groups as those of an arc; `shape`: skfem's
    class of it.

    "hinge" and "actuation" are the beam's end faces.
    """
    import skfem  # noqa: PLC0415  (meshes alone load it)

    assert isinstance(shoe.body, Beam) and shoe.body.section is not None  # why_not
    axis, section, thickness = (
        axis_of(shoe.pin.xy, shoe.actuation.point.xy),
        shoe.body.section,
        shoe.lining.thickness,
    )
    angles = np.sort(axis.angle(shoe.frame.theta(division.angles)))
    start, end, back = float(angles[0]), float(angles[-1]), radius + thickness
    foot = axis.foot + back * np.sin(np.array([start, end]))

    # s: the angle under the lining; before and behind it the distance along the beam over the
    # back's radius.
    low, high = start - foot[0] / back, end + (axis.length - foot[1]) / back
    s = np.concatenate(
        [overhang(start, low, division)[:0:-1], angles, overhang(end, high, division)[1:]]
    )
    face = axis.distance - section.thickness / 2
    linear = shape in {skfem.MeshQuad1, skfem.MeshTri1}
    most = MOST_THIN if linear else MOST_LAYERS  # linear elements bend well only in thin layers
    deepest = face - back * min(math.cos(start), math.cos(end))
    block, beam = (
        layers_behind(t, division, division.step * radius, most)
        for t in (deepest, section.thickness)
    )
    grid = skfem.MeshQuad.init_tensor(
        np.concatenate([division.depths / thickness, 1 + block, 2 + beam]), s
    )
    depth, place = grid.p[:, grid.t].mean(axis=1)
    grid = grid.restrict(np.flatnonzero((depth > 2) | ((place > start) & (place < end))))
    if shape in {skfem.MeshTri1, skfem.MeshTri2}:
        grid = grid.to_meshtri()
    layer = np.floor(grid.p[0, grid.t].mean(axis=0)).astype(int)
    middle = grid.p[:, grid.facets].mean(axis=1)
    outer = np.isin(np.arange(grid.nfacets), grid.boundary_facets())
    slack = 1e-9
    on = {
        "contact": outer & (middle[0] < slack),
        "hinge": outer & (middle[0] > 2) & (middle[1] < low + slack),
        "actuation": outer & (middle[0] > 2) & (middle[1] > high - slack),
    }
    mesh = shape.from_mesh(grid)
    depth, place = mesh.doflocs

    def along(s: Floats) -> Floats:
        inside = axis.foot + back * np.sin(np.clip(s, start, end))
        return np.asarray(inside + back * (np.minimum(s - start, 0) + np.maximum(s - end, 0)))

    r = radius + thickness * np.minimum(depth, 1)
    x = np.where(depth < 1, axis.foot + r * np.sin(place), along(place))
    y = axis.distance - r * np.cos(place)  # of lining and of the lining's back
    inner = axis.distance - face
    y = np.where(depth > 1, y + np.minimum(depth - 1, 1) * (inner - y), y)
    y = np.where(depth > 2, inner - (depth - 2) * section.thickness, y)
    return shape(
        shoe.frame.to_shoe(axis.to_brake(x, y)).T.copy(),
        mesh.t,
        _subdomains={name: np.flatnonzero(layer == i) for i, name in enumerate(PARTS)},
        _boundaries={name: np.flatnonzero(where) for name, where in on.items()},
    )
