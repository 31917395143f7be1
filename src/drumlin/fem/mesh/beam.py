"""The mesh of a straight-beam shoe in its own frame: lining, block and beam.

The block fills the space between lining and beam and is cut square to the beam: behind the lining's
back at the angle theta it reaches the beam's face at the same distance along the beam.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.beam_axis import Axis, axis_of
from drumlin.brake.brake import Shoe
from drumlin.brake.components import Beam, Section
from drumlin.brake.units import mm
from drumlin.fem.mesh.grading import (
    MOST_LINEAR_LAYERS,
    MOST_QUADRATIC_LAYERS,
    LiningDivision,
    element_ends_beyond_lining,
    layer_ends_behind_lining,
)

PARTS = ("lining", "backing", "shoe")
"""The subdomains of the mesh from the contact inwards; the backing is the block."""
BEAM_SLACK = 1e-9
"""Distance of a facet's middle from a face below which the facet counts as lying on the face.

Depths count in layers, and distances along the beam in radii of the lining's back. The distance
covers round-off alone.
"""


def reason_why_not_meshed(shoe: Shoe, radius: float) -> str | None:
    """Why a shoe with a straight beam cannot be meshed; None where it can, or has no beam."""
    if not isinstance(shoe.body, Beam) or shoe.mesh is not None:
        return None
    section = shoe.body.section
    if section is None:
        return (
            "its beam has no constant section to mesh: thickness, "
            "and width and material or one bending_stiffness"
        )
    if shoe.backing is None:
        return "nothing fills the space between its straight beam and the lining: no [shoe.backing]"
    if isinstance(shoe.body.offset, tuple) and any(offset for _, offset in shoe.body.offset):
        return "a beam with a curved axis is not meshed"
    return _reason_why_no_block_fits(
        shoe, axis_of(shoe.pin.xy, shoe.actuation.point.xy), section, radius
    )


def _reason_why_no_block_fits(
    shoe: Shoe, axis: Axis, section: Section, radius: float
) -> str | None:
    """Why no block fits between lining and beam; None where one fits."""
    back = radius + shoe.lining.thickness
    # The back of the lining comes nearest to the beam at the foot of the axis, or else at one end.
    ends = axis.angle(np.array([shoe.lining.start, shoe.lining.end]))
    x = axis.foot + back * np.sin(ends)
    nearest = back * (1.0 if ends.min() < 0 < ends.max() else float(np.cos(ends).max()))
    room = axis.distance - section.thickness / 2 - nearest
    if room <= 0:
        return f"its beam reaches {mm(-room)} into the lining; there is no room for the block"
    if x.min() < 0 or x.max() > axis.length:
        return "its block reaches beyond the beam's ends"
    return None


class _BeamShape(NamedTuple):
    """The geometry of a straight-beam shoe; lengths in m, in the axes of the beam.

    `back` is the radius of the lining's back. `start` and `end` are the angles of the lining's ends
    from the foot of the axis [rad]; `low` and `high` the beam's ends, as distances along the beam
    over `back`. `thickness` is that of the lining, `beam` that of the beam.
    """

    axis: Axis
    radius: float
    thickness: float
    beam: float
    back: float
    start: float
    end: float
    low: float
    high: float

    @property
    def face(self) -> float:
        """Distance of the beam's face from the drum's centre [m]."""
        return self.axis.distance - self.beam / 2

    def points(self, depth: Floats, s: Floats) -> Floats:
        """Points in the brake's frame, for depths in layers and positions s.

        Under the lining s is the angle from the axis's foot. Beyond the lining it is the distance
        along the beam over `back`.
        """
        r = self.radius + self.thickness * np.minimum(depth, 1)
        # In the axes of the beam, x runs along the beam and y towards the drum's centre.
        in_lining = self.axis.foot + r * np.sin(s)
        x = np.where(depth < 1, in_lining, self._distance_along_beam(s))
        y = self.axis.distance - r * np.cos(s)
        # The block leads from the lining's back straight to the beam's face.
        beam_face = self.axis.distance - self.face
        in_block = y + np.minimum(depth - 1, 1) * (beam_face - y)
        y = np.where(depth > 1, in_block, y)
        in_beam = beam_face - (depth - 2) * self.beam
        y = np.where(depth > 2, in_beam, y)
        return self.axis.to_brake(x, y)

    def _distance_along_beam(self, s: Floats) -> Floats:
        """Distances along the beam behind the positions s [m]."""
        start, end = self.start, self.end
        inside = self.axis.foot + self.back * np.sin(np.clip(s, start, end))
        beyond = np.minimum(s - start, 0) + np.maximum(s - end, 0)
        return np.asarray(inside + self.back * beyond)


def beam_mesh(shoe: Shoe, radius: float, division: LiningDivision, shape: Any) -> Any:
    """The mesh of a straight-beam shoe in its own frame, with the groups of an arc's mesh.

    "hinge" and "actuation" are the beam's end faces.

    Parameters
    ----------
    shoe : the shoe, whose beam has a constant section
    radius : of the drum [m]
    division : of the lining
    shape : skfem's class of the mesh
    """
    # Only meshes load scikit-fem.
    import skfem  # noqa: PLC0415

    assert isinstance(shoe.body, Beam) and shoe.body.section is not None  # why_not
    axis = axis_of(shoe.pin.xy, shoe.actuation.point.xy)
    angles = np.sort(axis.angle(shoe.frame.theta(division.angles)))
    form = _beam_shape_of(shoe, shoe.body.section, axis, radius, angles)
    linear = shape in {skfem.MeshQuad1, skfem.MeshTri1}
    grid = _cut_beam_grid(form, division, angles, linear=linear)
    if shape in {skfem.MeshTri1, skfem.MeshTri2}:
        grid = grid.to_meshtri()

    # The depth counts layers, so that its whole part is the number of the subdomain.
    layer = np.floor(grid.p[0, grid.t].mean(axis=0)).astype(int)
    depth, s = grid.p[:, grid.facets].mean(axis=1)
    outer = np.isin(np.arange(grid.nfacets), grid.boundary_facets())
    on = {
        "contact": outer & (depth < BEAM_SLACK),
        "hinge": outer & (depth > 2) & (s < form.low + BEAM_SLACK),
        "actuation": outer & (depth > 2) & (s > form.high - BEAM_SLACK),
    }
    mesh = shape.from_mesh(grid)
    depth, s = mesh.doflocs
    return shape(
        shoe.frame.to_shoe(form.points(depth, s)).T.copy(),
        mesh.t,
        _subdomains={name: np.flatnonzero(layer == i) for i, name in enumerate(PARTS)},
        _boundaries={name: np.flatnonzero(where) for name, where in on.items()},
    )


def _beam_shape_of(
    shoe: Shoe, section: Section, axis: Axis, radius: float, angles: Floats
) -> _BeamShape:
    """The geometry of a shoe whose lining has elements at these `angles` from the axis's foot."""
    start, end = float(angles[0]), float(angles[-1])
    thickness = shoe.lining.thickness
    back = radius + thickness
    # The block reaches the beam's face where the ends of the lining's back lie along the beam.
    foot = axis.foot + back * np.sin(np.array([start, end]))
    low = start - foot[0] / back
    high = end + (axis.length - foot[1]) / back
    return _BeamShape(axis, radius, thickness, section.thickness, back, start, end, low, high)


def _cut_beam_grid(
    form: _BeamShape, division: LiningDivision, angles: Floats, *, linear: bool
) -> Any:
    """The grid of depths in layers and positions s, without lining and block beyond the lining."""
    import skfem  # noqa: PLC0415

    start, end, back = form.start, form.end, form.back
    before = element_ends_beyond_lining(start, form.low, division)[:0:-1]
    after = element_ends_beyond_lining(end, form.high, division)[1:]
    s = np.concatenate([before, angles, after])
    # Linear elements bend well only in thin layers.
    most = MOST_LINEAR_LAYERS if linear else MOST_QUADRATIC_LAYERS
    deepest = form.face - back * min(math.cos(start), math.cos(end))
    size = division.step * form.radius
    block = layer_ends_behind_lining(deepest, division, size, most)
    beam = layer_ends_behind_lining(form.beam, division, size, most)
    depths = np.concatenate([division.depths / form.thickness, 1 + block, 2 + beam])
    grid = skfem.MeshQuad.init_tensor(depths, s)
    depth, place = grid.p[:, grid.t].mean(axis=1)
    under_lining = (place > start) & (place < end)
    return grid.restrict(np.flatnonzero((depth > 2) | under_lining))
