"""The parametric mesh of a shoe, in its own frame.

Named groups: subdomains "shoe", "table" of a T-section, "backing", "lining"; boundaries "contact"
(lining on drum), "hinge" (moves as a rigid line that turns about the pin) and "actuation" (carries
the force).
"""

from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Shoe
from drumlin.brake.components import Beam
from drumlin.fem.mesh.beam import beam_mesh
from drumlin.fem.mesh.grading import (
    MOST_LAYERS,
    MOST_THIN,
    LiningDivision,
    divide,
    layers_behind,
    overhang,
)


class MeshKind(NamedTuple):
    """A kind of mesh: the names of skfem's mesh and element, meshio's of its cells and of their
    edges.
    """

    mesh_name: str
    element_name: str
    cell: str
    edge: str

    @property
    def mesh(self) -> Any:
        """skfem's class of meshes."""
        return _skfem(self.mesh_name)

    @property
    def element(self) -> Any:
        """skfem's class of elements."""
        return _skfem(self.element_name)


def _skfem(name: str) -> Any:
    import skfem  # noqa: PLC0415  (meshes alone load it)

    return getattr(skfem, name)


MESH_KINDS = {
    "quad2": MeshKind("MeshQuad2", "ElementQuad2", "quad9", "line3"),
    "quad1": MeshKind("MeshQuad1", "ElementQuad1", "quad", "line"),
    "tri2": MeshKind("MeshTri2", "ElementTriP2", "triangle6", "line3"),
    "tri1": MeshKind("MeshTri1", "ElementTriP1", "triangle", "line"),
}
DEFAULT_KIND = "quad2"


def kind_of(mesh: Any) -> MeshKind:
    """The kind of a mesh."""
    return next(kind for kind in MESH_KINDS.values() if kind.mesh is type(mesh))


def _moved_to(angles: Floats, places: tuple[float, ...]) -> Floats:
    """The angles (n,) with the inner ones that are nearest to the places moved there; one that has
    moved to a place already, or is not there, is added.
    """
    inner = angles[1:-1]
    moved = (
        list(dict.fromkeys(int(np.abs(inner - x).argmin()) for x in places)) if len(inner) else []
    )
    return np.sort(np.concatenate([angles[:1], np.delete(inner, moved), places, angles[-1:]]))


def shoe_mesh(
    shoe: Shoe, radius: float, elements: int | LiningDivision, kind: str = DEFAULT_KIND
) -> Any:
    """Mesh of a shoe in its own frame; the nodes lie on the arcs, the edges of quadratic kinds
    follow them.

    `kind`: "quad2", "quad1", "tri2" or "tri1" (quadrilaterals or triangles, quadratic or linear).

    `elements`: number along the lining, graded to its edges, or its division. Without a body the
    back of the lining (or backing) is the rigid line "hinge" and the mesh has no "actuation".
    """
    if kind not in MESH_KINDS:
        raise BadInput(f"--kind = {kind!r}: unknown kind of mesh; allowed: {', '.join(MESH_KINDS)}")
    phi_1, phi_2 = shoe.arc
    division = elements if isinstance(elements, LiningDivision) else divide(shoe, radius, elements)
    if isinstance(shoe.body, Beam):
        return beam_mesh(shoe, radius, division, MESH_KINDS[kind].mesh)
    layers = [("lining", shoe.lining.thickness)]
    if shoe.backing is not None:
        layers.append(("backing", shoe.backing.thickness))
    lining_depth = sum(thickness for _, thickness in layers)
    angles = division.angles
    body = (phi_1, phi_2)
    if shoe.body is not None:
        layers += [(name, plate.thickness) for name, plate in shoe.body.plates.items()]
        ends = shoe.frame.phi(np.array([shoe.body.start, shoe.body.end]))
        body = (float(ends.min()), float(ends.max()))
        grip = shoe.grip(radius)
        angles = _moved_to(angles, grip or ())
        angles = np.concatenate(
            [
                overhang(phi_1, body[0], division)[:0:-1],
                angles,
                overhang(phi_2, body[1], division)[1:],
            ]
        )
    most = (
        MOST_LAYERS if kind.endswith("2") else MOST_THIN
    )  # linear elements bend well only in thin layers
    depths = [division.depths]
    for _, thickness in layers[1:]:
        parts = layers_behind(thickness, division, division.step * radius, most)
        depths.append(depths[-1][-1] + parts * thickness)
    bounds = np.array([part[-1] for part in depths])
    grid = _skfem("MeshQuad").init_tensor(np.concatenate(depths), angles)
    depth, phi = grid.p[:, grid.t].mean(axis=1)
    grid = grid.restrict(np.flatnonzero((depth > lining_depth) | ((phi > phi_1) & (phi < phi_2))))
    if kind.startswith("tri"):
        grid = grid.to_meshtri()
    depth, phi = grid.p[:, grid.t].mean(axis=1)
    layer = np.searchsorted(bounds, depth)
    middle = grid.p[:, grid.facets].mean(axis=1)
    outer = np.isin(np.arange(grid.nfacets), grid.boundary_facets())
    slack = 1e-9
    on = {"contact": outer & (middle[0] < slack * radius)}
    if shoe.body is None:
        on["hinge"] = outer & (middle[0] > lining_depth * (1 - slack))
    else:
        near, far = sorted(body, key=abs)
        behind = outer & (middle[0] > lining_depth)
        if grip is None:
            on["hinge"] = behind & (np.abs(middle[1] - near) < slack)
            on["actuation"] = behind & (np.abs(middle[1] - far) < slack)
        else:
            back = outer & (middle[0] > bounds[-1] * (1 - slack))
            on["hinge"] = back & (middle[1] > grip[0] - slack) & (middle[1] < grip[1] + slack)
    shape = MESH_KINDS[kind].mesh
    mesh = shape.from_mesh(grid)
    depth, phi = mesh.doflocs
    return shape(
        shoe.at(depth, phi, radius),
        mesh.t,
        _subdomains={name: np.flatnonzero(layer == i) for i, (name, _) in enumerate(layers)},
        _boundaries={name: np.flatnonzero(where) for name, where in on.items()},
    )
