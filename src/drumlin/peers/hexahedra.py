"""Mesh a solid shoe by hexahedra: its section's plane mesh, extruded over the widths of its parts.

The mesh covers half of the shoe, from the mid-plane z = 0 to one side. Its elements are
isoparametric quadratic hexahedra with 27 nodes. It has the same groups as the mesh of the section.
The answers of CalculiX on this mesh test drumlin's own model of solid shoes, which does not use
this mesh.
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
from drumlin.fem.mesh.arc import parametric_mesh_of_shoe
from drumlin.fem.mesh.degree import nodal_basis_of_mesh
from drumlin.fem.mesh.edges import nodes_along_element_edges
from drumlin.fem.mesh.grading import LiningDivision, points_graded_to_both_ends
from drumlin.fem.preparation.meshes import materials_and_widths_of_shoe_parts
from drumlin.fem.substructure.interface import nodal_forces_of_unit_end_loads_and_end_centre

DEFAULT_HEXAHEDRA_ALONG_LINING = 48
"""Default number of hexahedra along a lining; CalculiX's run time grows with its fourth power."""
SIZE_OF_FREE_SIDE_ELEMENT_OVER_MIDDLE_ELEMENT = 1 / 8
"""Size of an element at a free side, relative to an element in the middle of the width.

Since there are only few elements across the width, their sizes differ less than the sizes along the
lining.
"""
SECTION_CORNERS_AND_Z_ENDS_OF_HEXAHEDRON = [2, 2, 1, 3, 1, 3, 0, 0], [1, 0, 1, 1, 0, 0, 1, 0]
"""The eight corners of skfem's hexahedra.

For each corner of a hexahedron the first list has the number of the section's corner below it, and
the second list has 1 if the corner lies at the larger z and 0 if it lies at the smaller z.
"""
# VTK's order of the nodes of a hexahedron with 20 nodes: the corners of the bottom, the corners of
# the top, then the middles of the edges.
# fmt: off
_BOTTOM_CORNERS_IN_VTK_ORDER = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
_CORNERS_IN_VTK_ORDER = np.array(
    [
        *_BOTTOM_CORNERS_IN_VTK_ORDER,
        *((x, y, 1) for x, y, _ in _BOTTOM_CORNERS_IN_VTK_ORDER),
    ],
    dtype=float,
)
_EDGE_CORNERS_IN_VTK_ORDER = [
    (0, 1), (1, 2), (2, 3), (3, 0),
    (4, 5), (5, 6), (6, 7), (7, 4),
    (0, 4), (1, 5), (2, 6), (3, 7),
]
# fmt: on


@dataclass(frozen=True)
class HalfSolidShoeMesh:
    """The mesh of half a solid shoe, on one side of its mid-plane.

    Attributes
    ----------
    section, plane : mesh of the shoe's section, and its scalar finite-element basis
    mesh, basis : mesh of hexahedra, and its scalar finite-element basis
    z : (m,) growing coordinates [m] across the width at which there are nodes, from 0 on
    node : (n, m), entry i, j is the number of the hexahedral mesh's node that has x and y of the
        section's node i and the coordinate z[j]; -1 where the shoe does not reach to z[j]
    half : half the width of each subdomain [m]
    """

    section: Any
    plane: Any
    mesh: Any
    basis: Any
    z: Floats
    node: Ints
    half: Mapping[str, float]

    def number_of_z_coordinates_in_half_width_of_subdomain(self, name: str) -> int:
        """Number of the coordinates `z` that lie within half the width of a subdomain."""
        return int(np.searchsorted(self.z, self.half[name] * (1 + 1e-9)))


def half_width_of_each_shoe_subdomain(shoe: Shoe) -> dict[str, float]:
    """Half the width [m] of each subdomain of a shoe."""
    return {
        name: width / 2 for name, (_, width) in materials_and_widths_of_shoe_parts(shoe).items()
    }


def element_end_positions_over_half_width(
    half: Mapping[str, float], across: int, zone: float
) -> Floats:
    """Coordinates z (m + 1,) [m] between the m elements across half the shoe's width.

    They begin with the mid-plane z = 0, and contain the sides of all subdomains.

    Parameters
    ----------
    half : half the width of each subdomain [m]
    across : approximate number of elements over half the lining's width
    zone : distance [m] from each free side within which the elements become smaller
    """
    sides = np.unique(np.round(list(half.values()), 15))
    sides = sides[np.append(True, np.diff(sides) > 1e-9 * sides[-1])]
    size = half["lining"] / across
    # The narrowest part is divided over its whole width, with small elements at both sides, and the
    # half z > 0 is kept.
    first = max(1, round(sides[0] / size))
    pieces = [
        points_graded_to_both_ends(
            -sides[0], sides[0], 2 * first, zone, SIZE_OF_FREE_SIDE_ELEMENT_OVER_MIDDLE_ELEMENT
        )[first:]
    ]
    pieces[0][0] = 0.0
    for a, b in pairwise(sides):
        pieces.append(
            points_graded_to_both_ends(
                a,
                b,
                max(2, round((b - a) / size)),
                zone,
                SIZE_OF_FREE_SIDE_ELEMENT_OVER_MIDDLE_ELEMENT,
            )[1:]
        )
    return np.concatenate(pieces)


def mesh_of_half_solid_shoe(
    shoe: Shoe, radius: float, elements: int | LiningDivision, across: int
) -> HalfSolidShoeMesh:
    """The mesh of half a shoe, in the shoe's own frame.

    Parameters
    ----------
    shoe : a shoe without a mesh file
    radius : radius of the drum [m]
    elements : number of elements along the lining, or its division
    across : number of elements over half the lining's width
    """
    half = half_width_of_each_shoe_subdomain(shoe)
    levels = element_end_positions_over_half_width(half, across, shoe.lining.thickness)
    return extrude_shoe_section_to_solid(
        parametric_mesh_of_shoe(shoe, radius, elements), half, levels
    )


def extrude_shoe_section_to_solid(
    section: Any, half: Mapping[str, float], levels: Floats
) -> HalfSolidShoeMesh:
    """Extrude a section of quadratic quadrilaterals across the width; returns the solid mesh.

    Parameters
    ----------
    section : mesh of the section
    half : half the width of each subdomain [m], over which it is extruded
    levels : (m + 1,) coordinates z [m] between the elements across half the width
    """
    cells, outer = section.t, 0.5 * (levels[1:] + levels[:-1])
    # `exists` (layers, cells) says whether a cell of the section is extruded into a hexahedron in
    # each layer of elements across the width.
    exists = np.zeros((len(levels) - 1, cells.shape[1]), dtype=bool)
    for name, elements in section.subdomains.items():
        exists[:, elements] = outer[:, None] < half[name]
    layer, cell = np.nonzero(exists)
    mesh = skfem.MeshHex2.from_mesh(
        _mesh_of_hexahedra_with_straight_edges(section, levels, layer, cell)
    )

    # All nodes are moved to the x and y of the section's nodes. Straight edges thus become curved
    # where the section has curved edges.
    corners = np.ascontiguousarray(section.p)
    straight_section = skfem.MeshQuad1(corners, np.ascontiguousarray(cells))
    plane = skfem.MeshQuad2.from_mesh(straight_section)
    far, below = cKDTree(plane.doflocs.T).query(mesh.doflocs[:2].T)
    assert far.max() < 1e-9 * np.ptp(section.p)
    z = np.concatenate([np.column_stack([levels[:-1], outer]).ravel(), levels[-1:]])
    level = np.abs(mesh.doflocs[2][:, None] - z).argmin(axis=1)
    doflocs = np.ascontiguousarray(np.vstack([section.doflocs[:, below], z[level]]))
    numbers = np.full((section.doflocs.shape[1], len(z)), -1)
    numbers[below, level] = np.arange(doflocs.shape[1])
    subdomains = {}
    for name, elements in section.subdomains.items():
        subdomains[name] = np.flatnonzero(np.isin(cell, elements))
    mesh = skfem.MeshHex2(doflocs, mesh.t, _subdomains=subdomains)
    basis = skfem.Basis(mesh, skfem.ElementHex2(), intorder=4)
    return HalfSolidShoeMesh(section, nodal_basis_of_mesh(section), mesh, basis, z, numbers, half)


def _mesh_of_hexahedra_with_straight_edges(
    section: Any, levels: Floats, layer: Ints, cell: Ints
) -> Any:
    """The mesh of hexahedra with straight edges between the corners of a section's cells.

    Parameters
    ----------
    section, levels : the parameters of `extrude_shoe_section_to_solid`
    layer, cell : (e,) number of each hexahedron's layer across the width, and of its cell in the
        section
    """
    count = section.p.shape[1]
    corner, above = SECTION_CORNERS_AND_Z_ENDS_OF_HEXAHEDRON
    corners = section.t[corner][:, cell] + count * (layer + np.array(above)[:, None])
    # Corners that belong to no hexahedron are left out.
    used, t = np.unique(corners, return_inverse=True)
    points = np.vstack([section.p[:, used % count], levels[used // count]])
    return skfem.MeshHex1(np.ascontiguousarray(points), np.ascontiguousarray(t.reshape(8, -1)))


def default_number_of_hexahedra_over_half_width(shoe: Shoe, elements: int) -> int:
    """Default number of hexahedra over half the width of a lining with `elements` along it.

    Few elements are enough: the pressure varies smoothly across the width, and mainly within about
    one lining thickness of the sides.
    """
    slender = shoe.lining.width / (2 * shoe.lining.thickness)
    return max(2, round(elements / DEFAULT_HEXAHEDRA_ALONG_LINING * min(2 + slender, 6)))


def hexahedra_with_twenty_nodes_in_vtk_order(cells: Ints) -> Ints:
    """Nodes (m, 20) of hexahedra in the order of VTK and of CalculiX's C3D20.

    `cells` (27, m) are the nodes in the order of skfem.
    """
    middles = _CORNERS_IN_VTK_ORDER[np.array(_EDGE_CORNERS_IN_VTK_ORDER)].mean(axis=1)
    places = np.vstack([_CORNERS_IN_VTK_ORDER, middles])
    same = (skfem.ElementHex2.doflocs == places[:, None]).all(axis=2)
    return np.asarray(cells[same.argmax(axis=1)].T)


def nodes_of_boundary_over_width_of_part(
    solid: HalfSolidShoeMesh, boundary: str, part: str
) -> Ints:
    """The nodes (n, m) of a solid on a boundary of its section, over the width of a part.

    There is a row for each of the n nodes of the boundary in the section, and a column for each of
    the m coordinates z of the solid within the half width of the subdomain `part`.
    """
    line = np.unique(nodes_along_element_edges(solid.plane, solid.section.boundaries[boundary]))
    return solid.node[line, : solid.number_of_z_coordinates_in_half_width_of_subdomain(part)]


def solid_nodes_that_move_with_pin(solid: HalfSolidShoeMesh, shoe: Shoe) -> Ints:
    """Numbers of the nodes of the half shoe at the hinge, which move rigidly with the pin.

    They are the nodes of the body's edge at the hinge. In a rigid shoe they are the nodes on the
    back of the backing, or on the back of the lining if there is no backing.
    """
    held = "lining" if shoe.backing is None else "backing"
    return nodes_of_boundary_over_width_of_part(
        solid, "hinge", held if shoe.body is None else "shoe"
    ).ravel()


def nodal_forces_of_unit_loads_on_solid_end(solid: HalfSolidShoeMesh) -> Floats:
    """Nodal forces (nodes, 3, 3) on the loaded end of the half shoe, which add up to unit loads.

    The second axis counts the components x, y, z of a nodal force, the last axis the unit loads:
    force x, force y and couple. The loads are uniform across the width. Half of a load on the whole
    shoe acts on the half shoe; the caller halves the forces.
    """
    edges = solid.section.boundaries["actuation"]
    line, _ = nodal_forces_of_unit_end_loads_and_end_centre(solid.plane, edges)
    nodes = np.unique(nodes_along_element_edges(solid.plane, edges))
    numbers = nodes_of_boundary_over_width_of_part(solid, "actuation", "shoe")
    z = solid.z[: numbers.shape[1]]
    # The integrals of the quadratic shape functions across the width are the weights of Simpson's
    # rule.
    share = np.zeros(len(z))
    for k in range(0, len(z) - 2, 2):
        share[k : k + 3] += (z[k + 2] - z[k]) / 6 * np.array([1, 4, 1])
    forces = np.zeros((solid.basis.N, 3, 3))
    each = line.reshape(-1, 2, 3)[nodes]
    forces[numbers, :2] = each[:, None] * (share / share.sum())[:, None, None]
    return forces
