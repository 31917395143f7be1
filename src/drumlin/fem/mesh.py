"""Meshes of a shoe: the parametric one, and a user's own through meshio. Both in the shoe's frame.

Named groups: subdomains "shoe", "lining", "backing"; boundaries "contact" (lining against drum),
"hinge" (moves as a rigid line that turns about the pin) and "actuation" (carries the force).
"""

import contextlib
import dataclasses
import io
import math
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import scipy.spatial
import skfem
from skfem.io.meshio import from_meshio

from drumlin.arrays import Floats, Ints
from drumlin.brake import Body, Shoe
from drumlin.errors import BadInput
from drumlin.files import replacing
from drumlin.units import deg, mm

ELEMENTS: dict[type, Any] = {
    skfem.MeshQuad1: skfem.ElementQuad1,
    skfem.MeshQuad2: skfem.ElementQuad2,
    skfem.MeshTri1: skfem.ElementTriP1,
    skfem.MeshTri2: skfem.ElementTriP2,
}
MOST_LAYERS = 8  # through backing and body each: more costs time and changes nothing that matters
EDGE_SIZE = 1 / 32  # of an element at the lining's sharp edge, relative to one in its middle
FACE_SIZE = 1 / 8  # of a layer at the lining's faces, relative to one in its middle
ARC_SLACK = math.radians(2)  # between the lining's arc in the file and in a user's mesh
CELLS = {
    "quad9": "line3",
    "triangle6": "line3",
    "quad": "line",
    "triangle": "line",
}  # meshio's cells and edges


def shoe_mesh(shoe: Shoe, radius: float, elements: int) -> Any:
    """Quadratic quadrilateral mesh of a shoe in its own frame, with curved edges that follow the arcs.

    `elements`: number along the lining. They shrink towards the lining's ends, where the pressure of a sharp
    edge is singular, and so do the layers towards the lining's faces. Without a body the back of the
    lining (or backing) is the rigid line "hinge" and the mesh has no "actuation".
    """
    phi_1, phi_2 = shoe.arc
    step = (phi_2 - phi_1) / elements
    layers = [("lining", shoe.lining.thickness)]
    if shoe.backing is not None:
        layers.append(("backing", shoe.backing.thickness))
    lining_depth = sum(thickness for _, thickness in layers)
    angles = phi_1 + lining_angles(phi_2 - phi_1, shoe, radius, elements)
    body = (phi_1, phi_2)
    if shoe.body is not None:
        assert isinstance(shoe.body, Body)  # a straight beam: beam_mesh
        layers.append(("shoe", shoe.body.thickness))
        ends = shoe.frame.phi(np.array([shoe.body.start, shoe.body.end]))
        body = (float(ends.min()), float(ends.max()))
        angles = np.concatenate([overhang(body[0], phi_1, step)[:-1], angles, overhang(phi_2, body[1], step)[1:]])
    through = graded(0, shoe.lining.thickness, lining_layers(elements), shoe.lining.thickness / 2, FACE_SIZE)
    depths = [through]
    for _, thickness in layers[1:]:
        count = min(max(1, math.ceil(thickness / (step * radius))), MOST_LAYERS)
        depths.append(depths[-1][-1] + np.arange(1, count + 1) / count * thickness)
    bounds = np.array([part[-1] for part in depths])
    grid = skfem.MeshQuad.init_tensor(np.concatenate(depths), angles)
    depth, phi = grid.p[:, grid.t].mean(axis=1)
    grid = grid.restrict(np.flatnonzero((depth > lining_depth) | ((phi > phi_1) & (phi < phi_2))))
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
        on["hinge"] = behind & (np.abs(middle[1] - near) < slack)
        on["actuation"] = behind & (np.abs(middle[1] - far) < slack)
    mesh = skfem.MeshQuad2.from_mesh(grid)
    depth, phi = mesh.doflocs
    r = radius - shoe.sign * depth
    return skfem.MeshQuad2(
        np.array([r * np.cos(phi), r * np.sin(phi)]),
        mesh.t,
        _subdomains={name: np.flatnonzero(layer == i) for i, (name, _) in enumerate(layers)},
        _boundaries={name: np.flatnonzero(where) for name, where in on.items()},
    )


def overhang(start: float, end: float, step: float) -> Floats:
    """Angles from start to end, about `step` apart; both ends once even where they coincide."""
    if end - start < 1e-9:
        return np.array([end])
    return np.linspace(start, end, max(1, round((end - start) / step)) + 1)


def lining_angles(arc: float, shoe: Shoe, radius: float, elements: int) -> Floats:
    """Ends of the elements along a lining, from 0 to `arc` [rad]: symmetric, fine at its ends."""
    return graded(0.0, arc, elements, shoe.lining.thickness / radius, EDGE_SIZE)


def lining_layers(elements: int) -> int:
    """Layers through a lining with this number of elements along it."""
    return min(max(2, round(elements / 15)), 12)


def graded(start: float, end: float, count: int, zone: float, smallest: float) -> Floats:
    """count + 1 points from start to end; steps shrink linearly over `zone` at each end to `smallest` of the inner.

    The step is h(d) = h_0 min(1, smallest + d / zone) at the distance d from the nearer end: points lie at
    equal parts of Int dd / h.
    """
    half = (end - start) / 2
    reach = min(zone * (1 - smallest), half)  # beyond it all steps are h_0

    def parts(d: Floats) -> Floats:
        return zone * np.log1p(np.minimum(d, reach) / (zone * smallest)) + np.maximum(d - reach, 0.0)

    total = float(parts(np.array(half)))
    part = total * np.minimum(np.arange(count + 1), np.arange(count + 1)[::-1]) / (count / 2)
    inner = float(parts(np.array(reach)))
    d = np.where(part <= inner, zone * smallest * np.expm1(np.minimum(part, inner) / zone), reach + part - inner)
    left = np.arange(count + 1) <= count / 2
    points = np.where(left, start + d, end - d)
    points[0], points[-1] = start, end
    return points


def cell_type(mesh: Any) -> str:
    """meshio's name of a mesh's cells."""
    kinds = {skfem.MeshQuad2: "quad9", skfem.MeshTri2: "triangle6", skfem.MeshQuad1: "quad", skfem.MeshTri1: "triangle"}
    return kinds[type(mesh)]


def write_mesh(path: Path, mesh: Any, shoe: Shoe) -> None:
    """Write a shoe's mesh as a Gmsh file (format 2.2) in the brake's frame [m], groups as physical names."""
    basis = skfem.Basis(mesh, ELEMENTS[type(mesh)](), intorder=1)
    cell = cell_type(mesh)
    blocks, names = [], {}
    for number, (name, elements) in enumerate(mesh.subdomains.items(), start=1):
        blocks.append((cell, basis.element_dofs[:, elements].T))
        names[name] = np.array([number, 2])
    for number, (name, facets) in enumerate(mesh.boundaries.items(), start=len(names) + 1):
        nodes = np.vstack(
            [basis.nodal_dofs[0][mesh.facets[:, facets]], *(row[None, facets] for row in basis.facet_dofs)]
        )
        blocks.append((CELLS[cell], nodes.T))
        names[name] = np.array([number, 1])
    tags = [np.full(len(block[1]), number, dtype=np.int32) for number, block in enumerate(blocks, start=1)]
    xy = shoe.frame.to_brake(basis.doflocs.T)
    points = np.column_stack([xy, np.zeros(len(xy))])
    data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    content = meshio.Mesh(points, blocks, cell_data=data, field_data=names)
    with replacing(path) as partial:
        meshio.write(partial, content, file_format="gmsh22", binary=False)


def read_mesh(path: Path, shoe: Shoe, radius: float, key: str = "mesh") -> Any:
    """A user's mesh of a shoe [in shoe.mesh_unit, brake's frame], in the shoe's frame [m].

    Raises BadInput, naming `key` and the file, for a file that cannot be read or used.
    """
    fault = f"{key} = '{path}'"
    if not path.is_file():
        raise BadInput(f"{fault}: no such file")
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            raw = meshio.read(path)
    except (Exception, SystemExit) as error:  # meshio's readers fail in their own many ways
        raise BadInput(f"{fault}: is not a mesh that meshio can read ({type(error).__name__})") from error
    cells = {block.type for block in raw.cells if block.dim == 2}
    if len(cells) != 1 or not cells <= set(CELLS):
        raise BadInput(f"{fault}: has cells {sorted(cells)}; allowed is one kind of: {', '.join(CELLS)}")
    if not np.isfinite(raw.points).all():
        raise BadInput(f"{fault}: has coordinates that are not finite")
    scale = {"m": 1.0, "mm": 1e-3}[shoe.mesh_unit]
    raw.points = shoe.frame.to_shoe(raw.points[:, :2] * scale)
    try:
        bare = from_meshio(meshio.Mesh(raw.points, [(kind, raw.cells_dict[kind]) for kind in cells]))
    except Exception as error:
        raise BadInput(f"{fault}: is not a valid mesh ({error})") from error
    mesh = _with_groups(bare, raw, cells.pop())
    _check_groups(mesh, shoe, fault)
    _check_contact(mesh, shoe, radius, fault)
    return mesh


def _with_groups(bare: Any, raw: Any, kind: str) -> Any:
    """The mesh with the named groups of the file: subdomains from its cells, boundaries from its edges."""
    tree = scipy.spatial.cKDTree(bare.p.T)  # skfem renumbers the nodes
    facet = {tuple(sorted(ends)): i for i, ends in enumerate(bare.facets.T.tolist())}
    subdomains, boundaries = {}, {}
    for name, members in _named_cells(raw).items():
        if len(members.get(kind, ())):
            subdomains[name] = members[kind]
        edges = members.get(CELLS[kind], np.empty(0, dtype=np.int64))
        if len(edges):
            ends = tree.query(raw.points[raw.cells_dict[CELLS[kind]][edges, :2]])[1]
            known = [facet.get((min(pair), max(pair)), -1) for pair in ends.tolist()]
            boundaries[name] = np.array([number for number in known if number >= 0], dtype=np.int64)
    return dataclasses.replace(bare, _subdomains=subdomains, _boundaries=boundaries)


def _named_cells(raw: Any) -> dict[str, dict[str, Ints]]:
    """Group name -> cell type -> numbers of its cells of that type, from physical names or cell sets."""
    groups: dict[str, dict[str, Ints]] = {
        name: dict(members) for name, members in raw.cell_sets_dict.items() if not name.startswith("gmsh:")
    }
    tags = raw.cell_data_dict.get("gmsh:physical", {})
    for name, (tag, _) in raw.field_data.items():
        for kind, values in tags.items():
            members = np.flatnonzero(values == tag)
            if len(members):
                groups.setdefault(name, {})[kind] = members
    return groups


def _check_groups(mesh: Any, shoe: Shoe, fault: str) -> None:
    subdomains, boundaries = mesh.subdomains or {}, mesh.boundaries or {}
    needed = {"lining"} | ({"shoe"} if shoe.body else set()) | ({"backing"} if shoe.backing else set())
    lines = {"contact", "hinge"} | ({"actuation"} if shoe.body else set())
    missing = sorted((needed - set(subdomains)) | (lines - set(boundaries)))
    if missing:
        found = ", ".join([*subdomains, *boundaries]) or "none"
        raise BadInput(f"{fault}: named groups missing: {', '.join(missing)}; found: {found}")
    named = np.concatenate([subdomains[name] for name in needed])
    if len(np.unique(named)) < mesh.nelements or len(named) > mesh.nelements:
        raise BadInput(f"{fault}: every element must be in exactly one of the groups {', '.join(sorted(needed))}")


def _check_contact(mesh: Any, shoe: Shoe, radius: float, fault: str) -> None:
    nodes = mesh.p[:, np.unique(mesh.facets[:, mesh.boundaries["contact"]])]
    off = float(np.abs(np.hypot(*nodes) - radius).max())
    if off > shoe.lining.thickness:
        raise BadInput(
            f"{fault}: the group contact lies up to {mm(off)} off the drum's radius {mm(radius)}; "
            f"must be within the lining's thickness (coordinates are read in {shoe.mesh_unit})"
        )
    middle = sum(shoe.arc) / 2
    phi = middle + np.angle(np.exp(-1j * middle) * (nodes[0] + 1j * nodes[1]))
    arc = (float(phi.min()), float(phi.max()))
    if max(abs(a - b) for a, b in zip(arc, shoe.arc, strict=True)) > ARC_SLACK:
        ends = sorted(shoe.frame.theta(np.array(arc)).tolist())
        raise BadInput(
            f"{fault}: the group contact runs from {deg(ends[0])} to {deg(ends[1])}; must be the lining's arc, "
            f"{deg(shoe.lining.start)} to {deg(shoe.lining.end)}, within {deg(ARC_SLACK)}"
        )
