"""Outlines of shoes as layered bodies, and meshes of triangles that fill the outlines."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.brake.beam_axis import BeamAxis, make_beam_axis
from drumlin.brake.brake import Shoe
from drumlin.brake.components import BeamBody, RectangularCrossSection
from drumlin.brake.elasticity import ElasticLayer
from drumlin.brake.heat import heated_layers_of_shoe
from drumlin.verification.triangles.triangulation import (
    FunctionFromBodyCoordinatesToPoints,
    LayerOfTriangulatedBody,
    TriangleMeshInBodyCoordinates,
    coordinates_with_position_dependent_spacing,
    grade_mesh_towards_points,
    triangulate_grid_of_layered_body,
)

LONGEST_TRIANGLE_OVER_THINNEST_LAYER = 12.0
"""Largest length of triangles far from all corners, relative to the thickness of the thinnest
layer."""


class DegreeAndGradingOfTriangleMesh(NamedTuple):
    """The degree and the grading of a mesh of triangles.

    Attributes
    ----------
    degree : polynomial degree of the triangles
    halvings : number of times that the triangles are halved towards each corner
    longest_over_corner_distance : largest length of a triangle near a corner, relative to its
        distance from the corner
    size : factor on the lengths of all triangles before they are halved
    """

    degree: int
    halvings: int
    longest_over_corner_distance: float
    size: float


class PlacesOfNonSmoothPressure(NamedTuple):
    """Places on a lining's face where the pressure is not smooth.

    Attributes
    ----------
    s : (k,) coordinate of each place along the lining's face
    smallest : (k,) length of the smallest triangle at each place [m]
    """

    s: Floats
    smallest: Floats


@dataclass(frozen=True)
class OutlineOfLayeredBody:
    """A shoe or a ring as a body of layers, in the coordinates s along it and d across its layers.

    Layer j fills j <= d <= j + 1; the friction surface is d = 0.

    Attributes
    ----------
    place : function that returns the points [m] in the brake's frame for given s and d
    layers : the layers, beginning at the lining's face
    thickness : (layers,) thickness of each layer [m]
    s : coordinates s of the ends of all layers, growing
    corners : (k, 2) s and d of the points to which triangles are graded
    held : s of the end face at the hinge, which is fixed; None if the back of the body is fixed
        instead
    loaded : s of the end face on which the actuation force acts, or None
    origin, turn : the point s of the lining's face is at theta = origin + turn s; turn is 1 or -1
    length : length along the body per unit of s [m]
    grip : first and last s of the fixed part of the back, or None if the whole back is fixed
    plates : number of layers (plates) of the shoe's body, which lies behind lining and backing
    """

    place: FunctionFromBodyCoordinatesToPoints
    layers: list[LayerOfTriangulatedBody]
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
    def number_of_first_layer_of_shoe_body(self) -> int:
        """Number of the first layer of the shoe's body; the body begins at this coordinate d."""
        return len(self.layers) - self.plates

    @property
    def triangle_length_before_first_halving(self) -> float:
        """Length of a triangle before its first halving towards a corner [m]."""
        face = self.layers[0]
        ends = [face.start, *(end for slot in face.slots for end in slot), face.end]
        arc = min(b - a for a, b in zip(ends[::2], ends[1::2], strict=True)) * self.length
        return min(float(self.thickness.min()), arc / 4)


def make_shoe_outline(shoe: Shoe, R: float) -> OutlineOfLayeredBody:
    """The outline of a shoe on a drum of radius R [m].

    Raises BadInput for a shoe that has a mesh of its own or a beam without a constant section.
    """
    if shoe.mesh is not None:
        raise BadInput(f"shoe {shoe.name!r} has a mesh of its own")
    if isinstance(shoe.body, BeamBody):
        return _outline_of_beam_shoe(shoe, R)
    lining, body = shoe.lining, shoe.body
    layers, thickness = _layers_and_thicknesses_of_arc_shoe(shoe)
    plates = 0 if body is None else len(body.plates)
    before_body = len(layers) - plates
    held = loaded = grip = None
    s = [end for arc in lining.arcs for end in arc]
    corners = [(end, float(d)) for end in s for d in range(before_body + 1)]
    if body is not None:
        s += [body.start, body.end]
        depths = range(before_body, len(layers) + 1)
        corners += _points_at_all_pairs_of_coordinates((body.start, body.end), depths)
        grip = _angles_of_gripped_part_of_arc_shoe(shoe, R)
        if grip is None:
            held, loaded = sorted(
                (body.start, body.end),
                key=lambda end: abs(float(shoe.frame.phi_of_surface_coordinates(np.array(end)))),
            )
        else:
            s += grip
            corners += [(end, float(len(layers))) for end in grip]
    return OutlineOfLayeredBody(
        place=_function_from_coordinates_to_arc_shoe_points(shoe, R, thickness),
        layers=layers,
        thickness=np.array(thickness),
        s=_sorted_distinct_values(s),
        corners=np.unique(corners, axis=0),
        held=held,
        loaded=loaded,
        origin=0.0,
        turn=1,
        length=R,
        grip=grip,
        plates=plates,
    )


def _points_at_all_pairs_of_coordinates(
    s: Iterable[float], d: Iterable[int]
) -> list[tuple[float, float]]:
    """The points (s, d) of every given s with every given d, in the coordinates of an outline."""
    return [(along, float(across)) for along, across in product(s, d)]


def _layers_and_thicknesses_of_arc_shoe(
    shoe: Shoe,
) -> tuple[list[LayerOfTriangulatedBody], list[float]]:
    """The layers of a shoe on an arc, counted from the lining's face, and their thicknesses [m].

    Lining and backing come first, then the plates of the shoe's body; s is the angle theta.
    """
    lining, backing, body = shoe.lining, shoe.backing, shoe.body
    layers, thickness = [], list[float]()
    heated = {layer.key: layer for layer in heated_layers_of_shoe(shoe)}

    def free_thermal_strains_at_layer_faces(key: str, part_thickness: float) -> Floats | None:
        """Free strains (2, 2) of a layer, at its near and its far face; None without heat."""
        near = sum(thickness)
        faces = np.array([near, near + part_thickness])
        return (
            np.array(heated[key].free_thermal_strains_at_depths(faces)) if key in heated else None
        )

    for key, part in (("lining", lining), ("backing", backing)):
        if part is not None:
            elastic = ElasticLayer.make_layer_in_plane_stress(part.material, lining.width)
            strains = free_thermal_strains_at_layer_faces(key, part.thickness)
            layers.append(
                LayerOfTriangulatedBody(lining.start, lining.end, elastic, lining.slots, strains)
            )
            thickness.append(part.thickness)
    if body is not None:
        assert not isinstance(body, BeamBody)
        for plate in body.plates.values():
            elastic = ElasticLayer.make_layer_in_plane_stress(plate.material, plate.width)
            strains = free_thermal_strains_at_layer_faces("body", plate.thickness)
            layers.append(
                LayerOfTriangulatedBody(body.start, body.end, elastic, free_strains=strains)
            )
            thickness.append(plate.thickness)
    return layers, thickness


def _angles_of_gripped_part_of_arc_shoe(shoe: Shoe, R: float) -> tuple[float, float] | None:
    """The first and last angle [rad] of the part of a shoe's back that a holder fixes, or None.

    The actuation force acts on the holder.
    """
    grip = shoe.interval_of_body_back_held_by_support(R)
    if grip is None:
        return None
    first, last = sorted(shoe.frame.surface_coordinates_of_phi(np.array(grip)).tolist())
    return first, last


def _function_from_coordinates_to_arc_shoe_points(
    shoe: Shoe, R: float, thickness: Sequence[float]
) -> FunctionFromBodyCoordinatesToPoints:
    """The function from angles and layer coordinates to points of a shoe on an arc.

    Parameters
    ----------
    shoe : the shoe
    R : radius of the drum [m]
    thickness : thickness of each layer [m], in the order from the lining's face to the back
    """
    depths = np.concatenate([[0.0], np.cumsum(thickness)])

    def shoe_points_at_angles_and_layer_coordinates(s: Floats, d: Floats) -> Floats:
        """Points (..., 2) [m] of the shoe at the angles s and the layer coordinates d."""
        r = R - shoe.sign_internal_plus_external_minus * np.interp(
            d, np.arange(len(depths)), depths
        )
        return np.stack([r * np.cos(s), r * np.sin(s)], axis=-1)

    return shoe_points_at_angles_and_layer_coordinates


class _BeamShoeDimensions(NamedTuple):
    """The dimensions of a shoe with a straight beam.

    Attributes
    ----------
    axis : axis of the beam
    first, last : coordinates s of the ends of the lining and of the block that carries it
    low, high : coordinates s of the ends of the beam
    back : radius of the lining's back [m]
    lining, beam : thickness of the lining and of the beam [m]
    """

    axis: BeamAxis
    first: float
    last: float
    low: float
    high: float
    back: float
    lining: float
    beam: float

    @property
    def distance_of_beam_face_from_axis(self) -> float:
        """Distance from the beam's axis to the face of the beam that carries the block [m]."""
        return self.beam / 2

    @property
    def smallest_thickness_between_lining_and_beam(self) -> float:
        """Smallest thickness [m] of the block between lining and beam."""
        nearest = min(math.cos(self.first), math.cos(self.last))
        return (
            self.axis.distance_from_drum_centre
            - self.distance_of_beam_face_from_axis
            - self.back * nearest
        )


def _outline_of_beam_shoe(shoe: Shoe, R: float) -> OutlineOfLayeredBody:
    """The outline of a straight beam that carries its lining on a rectangular block.

    The coordinate s is the angle of a point on the lining's back, seen from the drum's centre. On
    the ends of the beam, which project beyond the block, s grows in proportion to the length along
    the beam.
    """
    lining, backing, body = shoe.lining, shoe.backing, shoe.body
    assert isinstance(body, BeamBody)
    section = body.section
    if section is None or backing is None:
        raise BadInput(
            f"shoe {shoe.name!r}: its beam has no constant section, or nothing before it"
        )
    if any(True for _ in heated_layers_of_shoe(shoe)):
        raise BadInput(f"shoe {shoe.name!r}: heat in a shoe on a straight beam")
    size = _dimensions_of_beam_shoe(shoe, R, section)
    axis, first, last = size.axis, size.first, size.last
    low, high = size.low, size.high
    make_layer = ElasticLayer.make_layer_in_plane_stress
    ends = np.sort(axis.angle(np.ravel(lining.arcs))).tolist()
    slots = tuple(zip(ends[1:-1:2], ends[2:-1:2], strict=True))
    block = make_layer(backing.material, lining.width, axis.along)
    layers = [
        LayerOfTriangulatedBody(first, last, make_layer(lining.material, lining.width), slots),
        LayerOfTriangulatedBody(first, last, block, slots),
        LayerOfTriangulatedBody(low, high, make_layer(section.material, section.width, axis.along)),
    ]
    corners = [(s, d) for s in ends for d in (0.0, 1.0, 2.0)] + [
        (s, d) for s in (low, high) for d in (2.0, 3.0)
    ]
    return OutlineOfLayeredBody(
        place=_function_from_coordinates_to_beam_shoe_points(size, R),
        layers=layers,
        thickness=np.array(
            [size.lining, size.smallest_thickness_between_lining_and_beam, size.beam]
        ),
        s=_sorted_distinct_values([low, *ends, high]),
        corners=np.unique(corners, axis=0),
        held=low,
        loaded=high,
        origin=lining.middle - axis.sense * float(axis.angle(np.array(lining.middle))),
        turn=axis.sense,
        length=size.back,
    )


def _dimensions_of_beam_shoe(
    shoe: Shoe, R: float, section: RectangularCrossSection
) -> _BeamShoeDimensions:
    """The dimensions of a shoe with a straight beam of a `section`, on a drum of radius R [m]."""
    lining = shoe.lining
    axis = make_beam_axis(shoe.pin.xy, shoe.actuation.point.xy)
    first, last = np.sort(axis.angle(np.array([lining.start, lining.end]))).tolist()
    back = R + lining.thickness
    low = first - (axis.x_of_perpendicular_foot + back * math.sin(first)) / back
    high = last + (axis.length - axis.x_of_perpendicular_foot - back * math.sin(last)) / back
    return _BeamShoeDimensions(
        axis, first, last, low, high, back, lining.thickness, section.thickness
    )


def _function_from_coordinates_to_beam_shoe_points(
    size: _BeamShoeDimensions, R: float
) -> FunctionFromBodyCoordinatesToPoints:
    """The function from coordinates (s, d) to points of a beam shoe, with drum radius R [m]."""
    axis = size.axis

    def beam_shoe_points_at_angles_and_layer_coordinates(s: Floats, d: Floats) -> Floats:
        """Points (..., 2) [m] of lining (d < 1), block (d < 2) and beam, in the brake's frame."""
        inside = np.clip(s, size.first, size.last)
        along = axis.x_of_perpendicular_foot + size.back * (np.sin(inside) + (s - inside))
        r = R + size.lining * np.minimum(d, 1)
        x = np.where(d < 1, axis.x_of_perpendicular_foot + r * np.sin(s), along)
        y = axis.distance_from_drum_centre - r * np.cos(inside)
        y = y + np.clip(d - 1, 0, 1) * (size.distance_of_beam_face_from_axis - y)
        y = np.where(d >= 2, size.distance_of_beam_face_from_axis - (d - 2) * size.beam, y)
        return axis.convert_beam_coordinates_to_brake_points(x, y)

    return beam_shoe_points_at_angles_and_layer_coordinates


def _sorted_distinct_values(values: Sequence[float]) -> Floats:
    """The values in growing order; of values that differ by less than 1e-9 only the smallest."""
    grown = np.unique(values)
    return grown[np.append(True, np.diff(grown) > 1e-9)]


def initial_grid_lines_of_body(
    shape: OutlineOfLayeredBody, size: float, wavelength: float, points: Sequence[float]
) -> tuple[Floats, list[Floats]]:
    """Coordinates of the grid lines of a body's first mesh: s along it, and d in each layer.

    Each cell of the grid becomes two triangles. The cells are nearly square at the corners of the
    body and at the places `points`, and longer along the body elsewhere.

    Parameters
    ----------
    shape : outline of the body
    size : factor on the lengths of all cells
    wavelength : shortest wavelength [m] of the gap of an out-of-round drum
    points : coordinates s of places on the lining's face where the pressure is not smooth
    """
    # The cells are smallest, `least` [m], at the ends of the lining and at `points`, and largest,
    # `most`, far from them.
    face = shape.layers[0]
    arc = (face.end - face.start) * shape.length
    thinnest = float(
        shape.thickness[
            : len(shape.layers) - (shape.held is not None or shape.grip is not None)
        ].min()
    )
    least = min(thinnest, arc / 4) * size
    most = max(
        least,
        min(
            LONGEST_TRIANGLE_OVER_THINNEST_LAYER * float(shape.thickness.min()),
            arc / 8,
            wavelength / 4,
        )
        * size,
    )
    dense = np.concatenate([shape.s, points])
    ends = (dense > face.start - 1e-9) & (dense < face.end + 1e-9)
    near = np.where(ends, least, max(least, float(shape.thickness[-1]) / 4 * size))

    def grid_step_along_body(s: float) -> float:
        """The distance in s between two grid lines near s."""
        # The spacing of the grid lines grows with the distance from the points of `dense`, by half
        # of this distance.
        growing = near + 0.5 * shape.length * np.abs(dense - s)
        return min(most, float(growing.min())) / shape.length

    s = coordinates_with_position_dependent_spacing(shape.s, grid_step_along_body)
    return s, _grid_lines_across_layers(shape, size, least)


def _grid_lines_across_layers(
    shape: OutlineOfLayeredBody, size: float, least: float
) -> list[Floats]:
    """The coordinates d of the grid lines of a body's first mesh, for each layer.

    Parameters
    ----------
    shape : outline of the body
    size : factor on the lengths of all cells
    least : smallest length of a cell, at the faces of a layer [m]
    """
    d = []
    for j, t in enumerate(shape.thickness.tolist()):
        coarsest = t * (1.0 if j == 0 else 0.5) * min(1.0, 1.25 * size)

        def relative_grid_step_across_layer(
            x: float, t: float = t, coarsest: float = coarsest
        ) -> float:
            """Distance of grid lines, divided by the layer's thickness t, at the depth x t."""
            return min(coarsest / t, least / t + min(x, 1 - x))

        across = coordinates_with_position_dependent_spacing(
            np.array([0.0, 1.0]), relative_grid_step_across_layer
        )
        d.append(j + across)
    return d


class ShoeMeshOfTriangleCorners(NamedTuple):
    """A shoe's mesh of triangles with corners only, before nodes on edges and inside are added.

    Attributes
    ----------
    shape : outline of the shoe
    s : coordinates s of the grid lines from which the mesh was made
    sharp : places on the lining's face to which the mesh is graded
    mesh : the triangles
    """

    shape: OutlineOfLayeredBody
    s: Floats
    sharp: PlacesOfNonSmoothPressure
    mesh: TriangleMeshInBodyCoordinates


def make_graded_shoe_mesh(
    shape: OutlineOfLayeredBody,
    sharp: PlacesOfNonSmoothPressure,
    level: DegreeAndGradingOfTriangleMesh,
    wavelength: float,
) -> ShoeMeshOfTriangleCorners:
    """Mesh a shoe by triangles that shrink towards its corners and the places `sharp` on its face.

    Parameters
    ----------
    shape : outline of the shoe
    sharp : places on the lining's face where the pressure is not smooth
    level : grading of the triangles
    wavelength : shortest wavelength [m] of the gap between lining and out-of-round drum
    """
    s, d = initial_grid_lines_of_body(shape, level.size, wavelength, sharp.s.tolist())
    points = np.concatenate([shape.corners, np.stack([sharp.s, 0 * sharp.s], axis=1)])
    smallest = np.concatenate(
        [
            np.full(
                len(shape.corners), shape.triangle_length_before_first_halving * 0.5**level.halvings
            ),
            sharp.smallest,
        ]
    )
    at = shape.place(points[:, 0], points[:, 1])
    return ShoeMeshOfTriangleCorners(
        shape,
        s,
        sharp,
        grade_mesh_towards_points(
            triangulate_grid_of_layered_body(s, d, shape.layers),
            shape.place,
            at,
            smallest,
            level.longest_over_corner_distance,
        ),
    )
