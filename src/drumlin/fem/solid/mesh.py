"""The mesh of a solid shoe: the plane mesh of its section, extruded from the mid-plane z = 0 over
the widths.

Quadratic hexahedra with 27 nodes, isoparametric. Groups as those of the section; the solid is half
of the shoe.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import skfem
from scipy.spatial import cKDTree

from drumlin.base.arrays import Floats, Ints
from drumlin.brake.brake import Shoe
from drumlin.fem.mesh.arc import shoe_mesh
from drumlin.fem.mesh.grading import LiningDivision, graded
from drumlin.fem.preparation.meshes import materials_of
from drumlin.fem.substructure.body import scalar_basis

SIDE_SIZE = 1 / 8
"""Size of an element at a free side, relative to one in the middle: there are few elements across,
so that they shrink less than along the lining.
"""
CORNERS = [2, 2, 1, 3, 1, 3, 0, 0], [1, 0, 1, 1, 0, 0, 1, 0]
"""Corners of skfem's hexahedra: the corner of the section's quadrilateral, and whether it is the
outer one.
"""


@dataclass(frozen=True)
class Solid:
    """A meshed half of a shoe.

    `section`, `plane`: mesh and scalar basis of its section; `mesh`, `basis`: those of the
    hexahedra; `z` (m,) [m]: the levels of nodes, growing from 0; `node` (n, m): number of the node
    above each of the section's, -1 where the shoe does not reach that far out; `half` [m]: half the
    width of each subdomain.
    """

    section: Any
    plane: Any
    mesh: Any
    basis: Any
    z: Floats
    node: Ints
    half: Mapping[str, float]

    def levels(self, name: str) -> int:
        """Number of the levels of nodes that a subdomain reaches."""
        return int(np.searchsorted(self.z, self.half[name] * (1 + 1e-9)))


def half_widths(shoe: Shoe) -> dict[str, float]:
    """Half the width [m] of each subdomain of a shoe."""
    return {name: width / 2 for name, (_, width) in materials_of(shoe).items()}


def width_levels(half: Mapping[str, float], across: int, zone: float) -> Floats:
    """Ends (m + 1,) [m] of the elements across half the shoe: about `across` over half the lining's
    width, graded over `zone` [m] to every free side, and an end at each.
    """
    sides = np.unique(np.round(list(half.values()), 15))
    sides = sides[np.append(True, np.diff(sides) > 1e-9 * sides[-1])]
    size = half["lining"] / across
    first = max(1, round(sides[0] / size))
    pieces = [graded(-sides[0], sides[0], 2 * first, zone, SIDE_SIZE)[first:]]
    pieces[0][0] = 0.0
    for a, b in pairwise(sides):
        pieces.append(graded(a, b, max(2, round((b - a) / size)), zone, SIDE_SIZE)[1:])
    return np.concatenate(pieces)


def solid_mesh(shoe: Shoe, radius: float, elements: int | LiningDivision, across: int) -> Solid:
    """Mesh of half a shoe, in its own frame: `elements` along the lining or its division, `across`
    over half of its width.
    """
    half = half_widths(shoe)
    levels = width_levels(half, across, shoe.lining.thickness)
    return extruded(shoe_mesh(shoe, radius, elements), half, levels)


def extruded(section: Any, half: Mapping[str, float], levels: Floats) -> Solid:
    """A section of quadratic quadrilaterals, extruded: each subdomain over the levels (m + 1,) [m]
    within its half.
    """
    cells, outer = section.t, 0.5 * (levels[1:] + levels[:-1])
    members = {name: np.asarray(elements) for name, elements in section.subdomains.items()}
    where = np.zeros((len(levels) - 1, cells.shape[1]), dtype=bool)  # layer, cell
    for name, elements in members.items():
        where[:, elements] = outer[:, None] < half[name]
    layer, cell = np.nonzero(where)
    count = section.p.shape[1]
    corner, above = CORNERS
    t = cells[corner][:, cell] + count * (layer + np.array(above)[:, None])
    used, t = np.unique(t, return_inverse=True)
    t = t.reshape(8, -1)
    flat = section.p[:, used % count]
    straight = skfem.MeshHex1(
        np.ascontiguousarray(np.vstack([flat, levels[used // count]])), np.ascontiguousarray(t)
    )
    mesh = skfem.MeshHex2.from_mesh(straight)
    # Nodes within straight edges, faces and cells: moved to where the section has them.
    plane = skfem.MeshQuad2.from_mesh(
        skfem.MeshQuad1(np.ascontiguousarray(section.p), np.ascontiguousarray(cells))
    )
    far, below = cKDTree(plane.doflocs.T).query(mesh.doflocs[:2].T)
    assert far.max() < 1e-9 * np.ptp(section.p)
    z = np.concatenate([np.column_stack([levels[:-1], outer]).ravel(), levels[-1:]])
    level = np.abs(mesh.doflocs[2][:, None] - z).argmin(axis=1)
    doflocs = np.ascontiguousarray(np.vstack([section.doflocs[:, below], z[level]]))
    numbers = np.full((section.doflocs.shape[1], len(z)), -1)
    numbers[below, level] = np.arange(doflocs.shape[1])
    subdomains = {
        name: np.flatnonzero(np.isin(cell, elements)) for name, elements in members.items()
    }
    mesh = skfem.MeshHex2(doflocs, mesh.t, _subdomains=subdomains)
    basis = skfem.Basis(mesh, skfem.ElementHex2(), intorder=4)
    return Solid(section, scalar_basis(section), mesh, basis, z, numbers, half)
