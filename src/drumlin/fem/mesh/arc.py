"""The parametric mesh of a shoe with linear or quadratic elements, in the shoe's own frame.

The mesh has named groups. Its subdomains are "lining", "backing", "table" (of a T-section) and
"shoe". Its boundaries are "contact" (the face of the lining on the drum), "hinge" (the face that
moves as a rigid line about the pin) and "actuation" (the face that the actuation force acts on).
"""

from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Shoe
from drumlin.brake.components import BeamBody, ShoeBodyOfConstantSection
from drumlin.fem.mesh.beam import mesh_of_straight_beam_shoe
from drumlin.fem.mesh.grading import (
    MOST_LINEAR_LAYERS_BEHIND_LINING,
    MOST_QUADRATIC_LAYERS_BEHIND_LINING,
    LiningDivision,
    divide_lining_into_elements,
    element_ends_beyond_lining,
    relative_layer_depths_behind_lining,
)


class MeshKind(NamedTuple):
    """A kind of mesh: quadrilaterals or triangles, linear or quadratic.

    Attributes
    ----------
    mesh_name : name of scikit-fem's class of the mesh
    degree : polynomial degree of the sides of the elements, 1 or 2
    cell : meshio's name of the elements
    """

    mesh_name: str
    degree: int
    cell: str

    @property
    def mesh(self) -> Any:
        """scikit-fem's class of meshes of this kind."""
        return _scikit_fem_class_of_name(self.mesh_name)


def _scikit_fem_class_of_name(name: str) -> Any:
    """scikit-fem's class of the given name."""
    # scikit-fem takes long to load, and only meshes need it.
    import skfem  # noqa: PLC0415

    return getattr(skfem, name)


MESH_KINDS = {
    "quad2": MeshKind("MeshQuad2", 2, "quad9"),
    "quad1": MeshKind("MeshQuad1", 1, "quad"),
    "tri2": MeshKind("MeshTri2", 2, "triangle6"),
    "tri1": MeshKind("MeshTri1", 1, "triangle"),
}
"""The kinds of meshes by their names in options: quadrilaterals or triangles, of degree 1 or 2."""
DEFAULT_MESH_KIND = "quad2"
"""The kind of mesh that is made if the user names none: quadratic quadrilaterals."""


def mesh_kind_of_scikit_fem_mesh(mesh: Any) -> MeshKind:
    """The kind of a scikit-fem mesh: quadrilaterals or triangles, of degree 1 or 2."""
    return next(kind for kind in MESH_KINDS.values() if kind.mesh is type(mesh))


def _move_nearest_element_ends_to_angles(angles: Floats, places: tuple[float, ...]) -> Floats:
    """The angles [rad] of element ends, changed so that elements end at each of the `places` [rad].

    The inner angle nearest to a place is moved to this place. If it has been moved to another place
    already, or if there is no inner angle, the place is added as a new angle. Inner angles are all
    angles but the first and the last.
    """
    inner = angles[1:-1]
    moved: list[int] = []
    if len(inner):
        nearest = [int(np.abs(inner - x).argmin()) for x in places]
        moved = list(dict.fromkeys(nearest))
    return np.sort(np.concatenate([angles[:1], np.delete(inner, moved), places, angles[-1:]]))


EDGE_ON_ARC_FACE_TOLERANCE = 1e-9
"""Largest distance from a face of the shoe at which the middle of an edge counts as on the face.

The edge is an edge of an element. At the contact the distance in depth is relative to the drum's
radius, and at the back relative to the depth of the back. Distances along the shoe are in rad.
Distances of this size are round-off.
"""


class _ArcMeshDepthsAndAngles(NamedTuple):
    """The rectangular grid of depths and angles from which the mesh of a shoe on an arc is made.

    The grid covers the longest layer; the parts beyond the ends of shorter layers are cut off.

    Attributes
    ----------
    layers : name and thickness [m] of each layer of the shoe, beginning at the contact
    bounds : (layers,) depth at which each layer ends, measured from the contact [m]
    depths, angles : depths [m] and angles [rad] of the grid's lines, which divide the elements
    body : angles at which the body of the shoe begins and ends [rad]
    """

    layers: list[tuple[str, float]]
    bounds: Floats
    depths: Floats
    angles: Floats
    body: tuple[float, float]

    @property
    def thickness_of_lining_and_backing(self) -> float:
        """Thickness of the lining and its backing together [m]."""
        return sum(thickness for name, thickness in self.layers if name in {"lining", "backing"})


def parametric_mesh_of_shoe(
    shoe: Shoe, radius: float, elements: int | LiningDivision, kind: str = DEFAULT_MESH_KIND
) -> Any:
    """The parametric mesh of a shoe: scikit-fem's mesh with named groups, in the shoe's frame [m].

    A rigid shoe has no elements of a body. The back of its lining (or backing) is then the boundary
    "hinge", which moves as a rigid line, and the mesh has no boundary "actuation". The nodes of a
    layer on an arc lie on circles about the drum's centre.

    Parameters
    ----------
    shoe : the shoe
    radius : radius of the drum [m]
    elements : number of elements along the lining, which become smaller towards its ends; or the
        division of the lining into elements
    kind : "quad2", "quad1", "tri2" or "tri1" (quadrilaterals or triangles, quadratic or linear)

    Raises
    ------
    BadInput
        for an unknown kind
    """
    if kind not in MESH_KINDS:
        raise BadInput(f"--kind = {kind!r}: unknown kind of mesh; allowed: {', '.join(MESH_KINDS)}")
    division = (
        elements
        if isinstance(elements, LiningDivision)
        else divide_lining_into_elements(shoe, radius, elements)
    )
    if isinstance(shoe.body, BeamBody):
        reason = shoe.reason_if_several_linings_are_not_allowed("the mesh of a straight beam")
        if reason is not None:
            raise BadInput(f"--kind = {kind!r}: shoe {shoe.name!r}: {reason}")
        return mesh_of_straight_beam_shoe(shoe, radius, division, MESH_KINDS[kind].mesh)
    # Each element belongs to the layer that its centre lies in.
    layout = _depths_and_angles_of_arc_mesh(shoe, radius, division, kind)
    grid = _element_grid_of_arc_shoe(shoe, layout, kind)
    depth, _ = grid.p[:, grid.t].mean(axis=1)
    layer = np.searchsorted(layout.bounds, depth)
    subdomains = {name: np.flatnonzero(layer == i) for i, (name, _) in enumerate(layout.layers)}
    boundaries = _element_edges_on_each_boundary(shoe, radius, layout, grid)

    # The nodes of the grid of depths and angles are mapped to points of the shoe.
    shape = MESH_KINDS[kind].mesh
    mesh = shape.from_mesh(grid)
    depth, phi = mesh.doflocs
    return shape(
        shoe.points_at_depth_and_coordinate_phi(depth, phi, radius),
        mesh.t,
        _subdomains=subdomains,
        _boundaries=boundaries,
    )


def _depths_and_angles_of_arc_mesh(
    shoe: Shoe, radius: float, division: LiningDivision, kind: str
) -> _ArcMeshDepthsAndAngles:
    """The rectangular grid of depths and angles that the mesh of a shoe on an arc is cut from."""
    phi_1, phi_2 = shoe.arc
    layers = [("lining", shoe.lining.thickness)]
    if shoe.backing is not None:
        layers.append(("backing", shoe.backing.thickness))
    # The body may be longer than the lining. A grip (the part of the body's back that the support
    # holds) begins and ends between two elements.
    angles = division.angles
    body = (phi_1, phi_2)
    if isinstance(shoe.body, ShoeBodyOfConstantSection):
        layers += [(name, plate.thickness) for name, plate in shoe.body.plates.items()]
        ends = shoe.frame.phi_of_surface_coordinates(np.array([shoe.body.start, shoe.body.end]))
        body = (float(ends.min()), float(ends.max()))
        angles = _move_nearest_element_ends_to_angles(
            angles, shoe.interval_of_body_back_held_by_support(radius) or ()
        )
        before = element_ends_beyond_lining(phi_1, body[0], division)[:0:-1]
        after = element_ends_beyond_lining(phi_2, body[1], division)[1:]
        angles = np.concatenate([before, angles, after])

    # Linear elements bend well only in thin layers, so that they may have more layers.
    most = (
        MOST_QUADRATIC_LAYERS_BEHIND_LINING
        if kind.endswith("2")
        else MOST_LINEAR_LAYERS_BEHIND_LINING
    )
    depths = [division.depths]
    for _, thickness in layers[1:]:
        parts = relative_layer_depths_behind_lining(
            thickness, division, division.step * radius, most
        )
        depths.append(depths[-1][-1] + parts * thickness)
    bounds = np.array([part[-1] for part in depths])
    return _ArcMeshDepthsAndAngles(layers, bounds, np.concatenate(depths), angles, body)


def _element_grid_of_arc_shoe(shoe: Shoe, layout: _ArcMeshDepthsAndAngles, kind: str) -> Any:
    """The grid of depths and angles, without lining and backing where the shoe has no lining.

    The grid is scikit-fem's mesh of quadrilaterals or, for a `kind` of triangles, of triangles.
    """
    grid = _scikit_fem_class_of_name("MeshQuad").init_tensor(layout.depths, layout.angles)
    depth, phi = grid.p[:, grid.t].mean(axis=1)
    of_body = depth > layout.thickness_of_lining_and_backing
    under_lining = np.any([(phi > start) & (phi < end) for start, end in shoe.arcs], axis=0)
    grid = grid.restrict(np.flatnonzero(of_body | under_lining))
    return grid.to_meshtri() if kind.startswith("tri") else grid


def _element_edges_on_each_boundary(
    shoe: Shoe, radius: float, layout: _ArcMeshDepthsAndAngles, grid: Any
) -> dict[str, Ints]:
    """The edges of the grid on each named boundary: "contact", "hinge" and "actuation".

    `grid` is the grid of depths and angles that becomes the mesh of the shoe.
    """
    depth, phi = grid.p[:, grid.facets].mean(axis=1)
    outer = np.isin(np.arange(grid.nfacets), grid.boundary_facets())
    # The boundary "hinge" is one of three faces: the back of a rigid shoe's lining, the body's end
    # face nearer to the pin, or the part of the body's back that the support holds (the grip).
    on = {"contact": outer & (depth < EDGE_ON_ARC_FACE_TOLERANCE * radius)}
    grip = shoe.interval_of_body_back_held_by_support(radius) if shoe.body is not None else None
    if shoe.body is None:
        on["hinge"] = outer & (
            depth > layout.thickness_of_lining_and_backing * (1 - EDGE_ON_ARC_FACE_TOLERANCE)
        )
    elif grip is None:
        near, far = sorted(layout.body, key=abs)
        behind = outer & (depth > layout.thickness_of_lining_and_backing)
        on["hinge"] = behind & (np.abs(phi - near) < EDGE_ON_ARC_FACE_TOLERANCE)
        on["actuation"] = behind & (np.abs(phi - far) < EDGE_ON_ARC_FACE_TOLERANCE)
    else:
        back = outer & (depth > layout.bounds[-1] * (1 - EDGE_ON_ARC_FACE_TOLERANCE))
        on["hinge"] = (
            back
            & (phi > grip[0] - EDGE_ON_ARC_FACE_TOLERANCE)
            & (phi < grip[1] + EDGE_ON_ARC_FACE_TOLERANCE)
        )
    return {name: np.flatnonzero(where) for name, where in on.items()}
