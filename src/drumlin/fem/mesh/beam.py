"""The mesh of a straight-beam shoe in its own frame: lining, block and beam.

The block fills the space between lining and beam. Its ends are cut square to the beam: the end of
the lining's back and the end of the block at the beam have the same distance along the beam.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.beam_axis import BeamAxis, make_beam_axis
from drumlin.brake.brake import Shoe
from drumlin.brake.components import BeamBody, RectangularCrossSection
from drumlin.brake.units import length_as_text_in_mm
from drumlin.fem.mesh.grading import (
    MOST_LINEAR_LAYERS_BEHIND_LINING,
    MOST_QUADRATIC_LAYERS_BEHIND_LINING,
    LiningDivision,
    element_ends_beyond_lining,
    relative_layer_depths_behind_lining,
)

BEAM_SHOE_SUBDOMAINS = ("lining", "backing", "shoe")
"""The subdomains of the mesh of a straight-beam shoe, in the order from the contact to the beam.

The subdomain "backing" is the block between lining and beam.
"""
EDGE_ON_BEAM_SHOE_FACE_TOLERANCE = 1e-9
"""Largest distance from a face of the shoe at which the middle of an edge counts as on the face.

The edge is an edge of an element. Distances in depth are relative to the thickness of the layer,
distances along the beam to the radius of the lining's back. Distances of this size are round-off.
"""


def reason_why_beam_shoe_cannot_be_meshed(shoe: Shoe, radius: float) -> str | None:
    """The reason why a shoe with a straight beam cannot be meshed, as a text for a message.

    None is returned if the shoe can be meshed, or if its body is no straight beam. `radius` is the
    drum's radius [m].
    """
    if not isinstance(shoe.body, BeamBody) or shoe.mesh is not None:
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
    return _reason_why_no_block_fits_behind_lining(
        shoe, make_beam_axis(shoe.pin.xy, shoe.actuation.point.xy), section, radius
    )


def _reason_why_no_block_fits_behind_lining(
    shoe: Shoe, axis: BeamAxis, section: RectangularCrossSection, radius: float
) -> str | None:
    """The reason why no block fits between lining and beam, as a text; None if a block fits."""
    back = radius + shoe.lining.thickness
    # The lining's back is nearest to the beam at the foot of the beam's axis (the point of the axis
    # nearest to the drum's centre). If the lining does not reach the foot, the lining's back is
    # nearest to the beam at one of its ends.
    ends = axis.angle(np.array([shoe.lining.start, shoe.lining.end]))
    x = axis.x_of_perpendicular_foot + back * np.sin(ends)
    nearest = back * (1.0 if ends.min() < 0 < ends.max() else float(np.cos(ends).max()))
    room = axis.distance_from_drum_centre - section.thickness / 2 - nearest
    if room <= 0:
        return (
            f"its beam reaches {length_as_text_in_mm(-room)} into the lining; there is no "
            f"room for the block"
        )
    if x.min() < 0 or x.max() > axis.length:
        return "its block reaches beyond the beam's ends"
    return None


def relative_depth_in_block_of_beam_shoe(shoe: Shoe, radius: float, points: Floats) -> Floats:
    """The relative depths (...) of points in the block between a lining and a straight beam.

    The depth is 0 on the back of the lining and 1 on the face of the beam. It grows evenly along
    lines square to the beam. The thickness of the block varies along the beam. The key `thickness`
    of the backing in the brake file has no effect on the depth.

    Parameters
    ----------
    shoe : the shoe, whose beam has a constant section
    radius : radius of the drum [m]
    points : (2, ...) points of the block in the frame of the shoe [m]
    """
    # `reason_why_beam_shoe_cannot_be_meshed` has refused beams without a section before this call.
    assert isinstance(shoe.body, BeamBody) and shoe.body.section is not None
    axis = make_beam_axis(shoe.pin.xy, shoe.actuation.point.xy)
    at = (
        shoe.frame.convert_vectors_from_shoe_to_brake_frame(np.moveaxis(points, 0, -1)) - axis.hinge
    )
    x, y = at @ axis.along, at @ axis.unit_normal_towards_drum_centre
    back = radius + shoe.lining.thickness
    beam_face = shoe.body.section.thickness / 2
    lining_back = axis.distance_from_drum_centre - np.sqrt(
        back**2 - (x - axis.x_of_perpendicular_foot) ** 2
    )
    return np.asarray((lining_back - y) / (lining_back - beam_face))


class _StraightBeamShoeGeometry(NamedTuple):
    """The geometry of a straight-beam shoe.

    Attributes
    ----------
    axis : axis of the beam; its foot is the point nearest to the drum's centre
    radius : radius of the drum [m]
    thickness : thickness of the lining [m]
    beam : thickness of the beam [m]
    back : radius of the lining's back [m]
    start, end : angles of the lining's ends, counted from the foot of the beam's axis [rad]
    position_of_beam_start, position_of_beam_end : positions s of the beam's ends: `start` or `end`
        plus or minus the beam's overhang beyond the lining [m] divided by `back`
    """

    axis: BeamAxis
    radius: float
    thickness: float
    beam: float
    back: float
    start: float
    end: float
    position_of_beam_start: float
    position_of_beam_end: float

    @property
    def distance_of_beam_face_from_centre(self) -> float:
        """Distance of the beam's face from the drum's centre [m]."""
        return self.axis.distance_from_drum_centre - self.beam / 2

    def beam_shoe_points_in_brake_frame(self, depth: Floats, s: Floats) -> Floats:
        """The points in the brake's frame [m] at given depths and positions s along the shoe.

        The depth grows by 1 through each layer: lining, block and beam. Under the lining s is the
        angle from the foot of the beam's axis [rad]. Beyond the lining, s changes by the distance
        along the beam [m] divided by `back`.
        """
        r = self.radius + self.thickness * np.minimum(depth, 1)
        # In the axes of the beam, x runs along the beam and y towards the drum's centre.
        in_lining = self.axis.x_of_perpendicular_foot + r * np.sin(s)
        x = np.where(depth < 1, in_lining, self._distances_along_beam(s))
        y = self.axis.distance_from_drum_centre - r * np.cos(s)
        # The block leads from the lining's back straight to the beam's face.
        beam_face = self.axis.distance_from_drum_centre - self.distance_of_beam_face_from_centre
        in_block = y + np.minimum(depth - 1, 1) * (beam_face - y)
        y = np.where(depth > 1, in_block, y)
        in_beam = beam_face - (depth - 2) * self.beam
        y = np.where(depth > 2, in_beam, y)
        return self.axis.convert_beam_coordinates_to_brake_points(x, y)

    def _distances_along_beam(self, s: Floats) -> Floats:
        """The distances from the hinge along the beam [m] at positions s of the lining's back.

        See `beam_shoe_points_in_brake_frame` for s.
        """
        start, end = self.start, self.end
        inside = self.axis.x_of_perpendicular_foot + self.back * np.sin(np.clip(s, start, end))
        beyond = np.minimum(s - start, 0) + np.maximum(s - end, 0)
        return np.asarray(inside + self.back * beyond)


def mesh_of_straight_beam_shoe(
    shoe: Shoe, radius: float, division: LiningDivision, shape: Any
) -> Any:
    """The mesh of a straight-beam shoe in the shoe's own frame [m], with named groups.

    The groups have the names of a shoe on an arc: subdomains "lining", "backing" and "shoe", and
    the boundary "contact". The boundaries "hinge" and "actuation" are the beam's end faces.

    Parameters
    ----------
    shoe : the shoe, whose beam has a constant section
    radius : radius of the drum [m]
    division : division of the lining into elements
    shape : scikit-fem's class of the mesh
    """
    # scikit-fem takes long to load, and only meshes need it.
    import skfem  # noqa: PLC0415

    # `reason_why_beam_shoe_cannot_be_meshed` has refused beams without a section before this call.
    assert isinstance(shoe.body, BeamBody) and shoe.body.section is not None
    axis = make_beam_axis(shoe.pin.xy, shoe.actuation.point.xy)
    angles = np.sort(axis.angle(shoe.frame.surface_coordinates_of_phi(division.angles)))
    form = _geometry_of_straight_beam_shoe(shoe, shoe.body.section, axis, radius, angles)
    linear = shape in {skfem.MeshQuad1, skfem.MeshTri1}
    grid = _element_grid_of_beam_shoe(form, division, angles, linear=linear)
    if shape in {skfem.MeshTri1, skfem.MeshTri2}:
        grid = grid.to_meshtri()

    # The depth grows by 1 through each layer, so that its whole part is the number of the layer.
    layer = np.floor(grid.p[0, grid.t].mean(axis=0)).astype(int)
    depth, s = grid.p[:, grid.facets].mean(axis=1)
    outer = np.isin(np.arange(grid.nfacets), grid.boundary_facets())
    on_beam, slack = outer & (depth > 2), EDGE_ON_BEAM_SHOE_FACE_TOLERANCE
    on = {
        "contact": outer & (depth < slack),
        "hinge": on_beam & (s < form.position_of_beam_start + slack),
        "actuation": on_beam & (s > form.position_of_beam_end - slack),
    }
    mesh = shape.from_mesh(grid)
    depth, s = mesh.doflocs
    return shape(
        shoe.frame.convert_vectors_to_shoe_frame(
            form.beam_shoe_points_in_brake_frame(depth, s)
        ).T.copy(),
        mesh.t,
        _subdomains={
            name: np.flatnonzero(layer == i) for i, name in enumerate(BEAM_SHOE_SUBDOMAINS)
        },
        _boundaries={name: np.flatnonzero(where) for name, where in on.items()},
    )


def _geometry_of_straight_beam_shoe(
    shoe: Shoe, section: RectangularCrossSection, axis: BeamAxis, radius: float, angles: Floats
) -> _StraightBeamShoeGeometry:
    """The geometry of a straight-beam shoe.

    Parameters
    ----------
    shoe : the shoe
    section : section of its beam
    axis : axis of its beam
    radius : radius of the drum [m]
    angles : angles of the ends of the lining's elements from the foot of the axis [rad]
    """
    start, end = float(angles[0]), float(angles[-1])
    thickness = shoe.lining.thickness
    back = radius + thickness
    # `foot` has the distances of both ends of the lining's back from the hinge, along the beam.
    foot = axis.x_of_perpendicular_foot + back * np.sin(np.array([start, end]))
    position_of_beam_start = start - foot[0] / back
    position_of_beam_end = end + (axis.length - foot[1]) / back
    return _StraightBeamShoeGeometry(
        axis,
        radius,
        thickness,
        section.thickness,
        back,
        start,
        end,
        position_of_beam_start,
        position_of_beam_end,
    )


def _element_grid_of_beam_shoe(
    form: _StraightBeamShoeGeometry, division: LiningDivision, angles: Floats, *, linear: bool
) -> Any:
    """The grid of depths and positions s, without lining and block beyond the lining's ends.

    The depth grows by 1 through each layer. The grid is scikit-fem's mesh of quadrilaterals.

    Parameters
    ----------
    form : geometry of the shoe
    division : division of the lining into elements
    angles : angles of the ends of the lining's elements from the foot of the beam's axis [rad]
    linear : whether the elements are linear
    """
    import skfem  # noqa: PLC0415

    start, end, back = form.start, form.end, form.back
    before = element_ends_beyond_lining(start, form.position_of_beam_start, division)[:0:-1]
    after = element_ends_beyond_lining(end, form.position_of_beam_end, division)[1:]
    s = np.concatenate([before, angles, after])
    # Linear elements bend well only in thin layers, so that they may have more layers. The number
    # of layers through the block follows from its largest thickness.
    most = MOST_LINEAR_LAYERS_BEHIND_LINING if linear else MOST_QUADRATIC_LAYERS_BEHIND_LINING
    deepest = form.distance_of_beam_face_from_centre - back * min(math.cos(start), math.cos(end))
    size = division.step * form.radius
    block = relative_layer_depths_behind_lining(deepest, division, size, most)
    beam = relative_layer_depths_behind_lining(form.beam, division, size, most)
    depths = np.concatenate([division.depths / form.thickness, 1 + block, 2 + beam])
    grid = skfem.MeshQuad.init_tensor(depths, s)
    depth, place = grid.p[:, grid.t].mean(axis=1)
    under_lining = (place > start) & (place < end)
    return grid.restrict(np.flatnonzero((depth > 2) | under_lining))
