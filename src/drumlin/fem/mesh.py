"""Meshes of a shoe: the parametric one, and a user's own through meshio. Both in the shoe's frame.

Named groups: subdomains "shoe", "lining", "backing"; boundaries "contact" (lining against drum),
"hinge" (moves as a rigid line that turns about the pin) and "actuation" (carries the force).
"""

import math
import warnings
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import skfem

from drumlin.brake import Floats, Shoe
from drumlin.errors import BadInput

ELEMENTS: dict[type, Any] = {
    skfem.MeshQuad1: skfem.ElementQuad1,
    skfem.MeshQuad2: skfem.ElementQuad2,
    skfem.MeshTri1: skfem.ElementTriP1,
    skfem.MeshTri2: skfem.ElementTriP2,
}
MOST_LAYERS = 8  # through lining, backing and body each: more costs time and changes nothing that matters
SUBDOMAINS = ("shoe", "backing", "lining")
BOUNDARIES = ("contact", "hinge", "actuation")
# meshio's order of the nodes of a cell, in the order of skfem's (vertices, edges, interior)
CELLS = {skfem.MeshQuad2: ("quad9", "line3"), skfem.MeshQuad1: ("quad", "line"),
         skfem.MeshTri2: ("triangle6", "line3"), skfem.MeshTri1: ("triangle", "line")}


def shoe_mesh(shoe: Shoe, radius: float, elements: int) -> Any:
    """Quadratic quadrilateral mesh of a shoe in its own frame, with curved edges that follow the arcs.

    `elements`: number along the lining, evenly spaced. Layers through each thickness follow, with nearly
    square elements where there is room. Without a body the back of the lining (or backing) is the rigid
    line "hinge" and the mesh has no "actuation".
    """
    phi_1, phi_2 = shoe.arc
    step = (phi_2 - phi_1) / elements
    layers = [("lining", shoe.lining.thickness)]
    if shoe.backing is not None:
        layers.append(("backing", shoe.backing.thickness))
    lining_depth = sum(thickness for _, thickness in layers)
    angles = np.linspace(phi_1, phi_2, elements + 1)
    body = (phi_1, phi_2)
    if shoe.body is not None:
        layers.append(("shoe", shoe.body.thickness))
        ends = shoe.frame.phi(np.array([shoe.body.start, shoe.body.end]))
        body = (float(ends.min()), float(ends.max()))
        angles = np.concatenate(
            [_overhang(body[0], phi_1, step)[:-1], angles, _overhang(phi_2, body[1], step)[1:]]
        )
    depths = np.concatenate(
        [[0.0]] + [
            start + _fractions(thickness, step * radius) * thickness
            for start, thickness in zip(np.cumsum([0.0] + [t for _, t in layers[:-1]]), [t for _, t in layers], strict=True)
        ]
    )
    grid = skfem.MeshQuad.init_tensor(depths, angles)
    depth, phi = grid.p[:, grid.t].mean(axis=1)
    grid = grid.restrict(np.flatnonzero((depth > lining_depth) | ((phi > phi_1) & (phi < phi_2))))
    depth, phi = grid.p[:, grid.t].mean(axis=1)
    bounds = np.cumsum([t for _, t in layers])
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


def _overhang(start: float, end: float, step: float) -> Floats:
    """Angles from start to end, about `step` apart; both ends once even where they coincide."""
    if end - start < 1e-9:
        return np.array([end])
    return np.linspace(start, end, max(1, round((end - start) / step)) + 1)


def _fractions(thickness: float, width: float) -> Floats:
    """Ends of the layers through a thickness, as fractions in (0, 1], for elements of this width."""
    count = min(max(1, math.ceil(thickness / width)), MOST_LAYERS)
    return np.arange(1, count + 1) / count
