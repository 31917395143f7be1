"""The parametric mesh of a shoe, in its own frame.

Named groups: subdomains "shoe", "table" of a T-section, "backing", "lining"; boundaries "contact"
(lining on drum), "hinge" (moves as a rigid line that turns about the pin) and "actuation" (carries
the force).
"""

from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Shoe
from drumlin.brake.components import Bar, Beam
from drumlin.fem.mesh.beam import beam_mesh
from drumlin.fem.mesh.grading import (
    MOST_LINEAR_LAYERS,
    MOST_QUADRATIC_LAYERS,
    LiningDivision,
    divide_lining,
    element_ends_beyond_lining,
    layer_ends_behind_lining,
)


class MeshKind(NamedTuple):
    """A kind of mesh: names of its classes in skfem, and of its cells and edges in meshio."""

    mesh_name: str
    element_name: str
    cell: str
    edge: str

    @property
    def mesh(self) -> Any:
        """The class of skfem for meshes of this kind."""
        return _skfem_class(self.mesh_name)

    @property
    def element(self) -> Any:
        """The class of skfem for the elements of this kind."""
        return _skfem_class(self.element_name)


def _skfem_class(name: str) -> Any:
    """The class of scikit-fem with this name."""
    # scikit-fem takes long to load, and only meshes use scikit-fem.
    import skfem  # noqa: PLC0415

    return getattr(skfem, name)


MESH_KINDS = {
    "quad2": MeshKind("MeshQuad2", "ElementQuad2", "quad9", "line3"),
    "quad1": MeshKind("MeshQuad1", "ElementQuad1", "quad", "line"),
    "tri2": MeshKind("MeshTri2", "ElementTriP2", "triangle6", "line3"),
    "tri1": MeshKind("MeshTri1", "ElementTriP1", "triangle", "line"),
}
"""The kinds of meshes by their names in options: quadrilaterals or triangles, of degree 1 or 2."""
DEFAULT_KIND = "quad2"
"""The kind of a mesh for which no option asks otherwise."""


def mesh_kind_of(mesh: Any) -> MeshKind:
    """The kind of skfem's `mesh`: quadrilaterals or triangles, of degree 1 or 2."""
    return next(kind for kind in MESH_KINDS.values() if kind.mesh is type(mesh))


def _move_inner_angles_to(angles: Floats, places: tuple[float, ...]) -> Floats:
    """Angles (n,) [rad] of which the inner ones nearest to the `places` are moved there.

    A place is added as a new angle where its nearest angle has moved to another place already, or
    where no inner angle exists.
    """
    inner = angles[1:-1]
    moved: list[int] = []
    if len(inner):
        nearest = [int(np.abs(inner - x).argmin()) for x in places]
        moved = list(dict.fromkeys(nearest))
    return np.sort(np.concatenate([angles[:1], np.delete(inner, moved), places, angles[-1:]]))


FACE_SLACK = 1e-9
"""Distance of a facet's middle from a face below which the facet counts as lying on the face.

The distance is in drum radii for depths and in radians for angles, and covers round-off alone.
"""


class _ArcLayout(NamedTuple):
    """The rectangle of depths and angles that an arc is cut from.

    `layers` are the names and thicknesses [m] from the contact inwards, `bounds` (layers,) the
    depths where they end [m], `depths` and `angles` the ends of the elements [m], [rad], and `body`
    the angles where the body ends [rad].
    """

    layers: list[tuple[str, float]]
    bounds: Floats
    depths: Floats
    angles: Floats
    body: tuple[float, float]

    @property
    def lining_depth(self) -> float:
        """Depth of the lining and its backing [m]."""
        return sum(thickness for name, thickness in self.layers if name in {"lining", "backing"})


def shoe_mesh(
    shoe: Shoe, radius: float, elements: int | LiningDivision, kind: str = DEFAULT_KIND
) -> Any:
    """The mesh of a shoe in its own frame, with nodes and quadratic edges on the arcs.

    Without a body the back of the lining (or backing) is the rigid line "hinge", and the mesh has
    no "actuation".

    Parameters
    ----------
    shoe : the shoe
    radius : of the drum [m]
    elements : number along the lining, graded to its ends, or the lining's division
    kind : "quad2", "quad1", "tri2" or "tri1" (quadrilaterals or triangles, quadratic or linear)

    Raises
    ------
    BadInput
        for an unknown kind
    """
    if kind not in MESH_KINDS:
        raise BadInput(f"--kind = {kind!r}: unknown kind of mesh; allowed: {', '.join(MESH_KINDS)}")
    division = (
        elements if isinstance(elements, LiningDivision) else divide_lining(shoe, radius, elements)
    )
    if isinstance(shoe.body, Beam):
        return beam_mesh(shoe, radius, division, MESH_KINDS[kind].mesh)
    layout = _layout_of_arc(shoe, radius, division, kind)
    grid = _cut_arc_grid(shoe, layout, kind)
    depth, _ = grid.p[:, grid.t].mean(axis=1)
    layer = np.searchsorted(layout.bounds, depth)
    subdomains = {name: np.flatnonzero(layer == i) for i, (name, _) in enumerate(layout.layers)}
    boundaries = _find_boundaries(shoe, radius, layout, grid)

    # The grid of depths and angles is mapped to the arcs.
    shape = MESH_KINDS[kind].mesh
    mesh = shape.from_mesh(grid)
    depth, phi = mesh.doflocs
    return shape(
        shoe.at(depth, phi, radius), mesh.t, _subdomains=subdomains, _boundaries=boundaries
    )


def _layout_of_arc(shoe: Shoe, radius: float, division: LiningDivision, kind: str) -> _ArcLayout:
    """The rectangle of depths and angles that the mesh of a shoe on an arc is cut from."""
    phi_1, phi_2 = shoe.arc
    layers = [("lining", shoe.lining.thickness)]
    if shoe.backing is not None:
        layers.append(("backing", shoe.backing.thickness))
    # The body may end before or beyond the lining, and a grip is marked by two of the angles.
    angles = division.angles
    body = (phi_1, phi_2)
    if isinstance(shoe.body, Bar):
        layers += [(name, plate.thickness) for name, plate in shoe.body.plates.items()]
        ends = shoe.frame.phi(np.array([shoe.body.start, shoe.body.end]))
        body = (float(ends.min()), float(ends.max()))
        angles = _move_inner_angles_to(angles, shoe.grip(radius) or ())
        before = element_ends_beyond_lining(phi_1, body[0], division)[:0:-1]
        after = element_ends_beyond_lining(phi_2, body[1], division)[1:]
        angles = np.concatenate([before, angles, after])

    # Linear elements bend well only in thin layers.
    most = MOST_QUADRATIC_LAYERS if kind.endswith("2") else MOST_LINEAR_LAYERS
    depths = [division.depths]
    for _, thickness in layers[1:]:
        parts = layer_ends_behind_lining(thickness, division, division.step * radius, most)
        depths.append(depths[-1][-1] + parts * thickness)
    bounds = np.array([part[-1] for part in depths])
    return _ArcLayout(layers, bounds, np.concatenate(depths), angles, body)


def _cut_arc_grid(shoe: Shoe, layout: _ArcLayout, kind: str) -> Any:
    """The grid of depths and angles, without the parts of the lining's layers beyond the lining."""
    phi_1, phi_2 = shoe.arc
    grid = _skfem_class("MeshQuad").init_tensor(layout.depths, layout.angles)
    depth, phi = grid.p[:, grid.t].mean(axis=1)
    of_body = depth > layout.lining_depth
    under_lining = (phi > phi_1) & (phi < phi_2)
    grid = grid.restrict(np.flatnonzero(of_body | under_lining))
    return grid.to_meshtri() if kind.startswith("tri") else grid


def _find_boundaries(shoe: Shoe, radius: float, layout: _ArcLayout, grid: Any) -> dict[str, Ints]:
    """The facets of each named boundary of a grid of depths and angles."""
    depth, phi = grid.p[:, grid.facets].mean(axis=1)
    outer = np.isin(np.arange(grid.nfacets), grid.boundary_facets())
    # The hinge of a gripped body is the part of its back in the grip; other bodies have end faces.
    on = {"contact": outer & (depth < FACE_SLACK * radius)}
    grip = shoe.grip(radius) if shoe.body is not None else None
    if shoe.body is None:
        on["hinge"] = outer & (depth > layout.lining_depth * (1 - FACE_SLACK))
    elif grip is None:
        near, far = sorted(layout.body, key=abs)
        behind = outer & (depth > layout.lining_depth)
        on["hinge"] = behind & (np.abs(phi - near) < FACE_SLACK)
        on["actuation"] = behind & (np.abs(phi - far) < FACE_SLACK)
    else:
        back = outer & (depth > layout.bounds[-1] * (1 - FACE_SLACK))
        on["hinge"] = back & (phi > grip[0] - FACE_SLACK) & (phi < grip[1] + FACE_SLACK)
    return {name: np.flatnonzero(where) for name, where in on.items()}
