"""The checks of a mesh that a user gives in a file.

A mesh with a fault is refused by an error whose message is one line and says what is allowed.
"""

import dataclasses
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.spatial

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Shoe
from drumlin.brake.components import ShoeBodyOfConstantSection
from drumlin.brake.units import length_as_text_in_mm
from drumlin.fem.mesh.degree import nodal_basis_of_mesh
from drumlin.fem.mesh.edges import nodes_along_element_edges

MOST_GROUP_NAMES_IN_MESSAGE = 30
"""Largest number of group names that the message on a missing group lists."""
BRAKE_FILE_KEY_OF_ELEMENT_GROUP = {
    "backing": "table [shoe.backing]",
    "shoe": "table [shoe.body]",
    "table": "key table in [shoe.body]",
}
"""The table or key of the brake file that makes a mesh need a group of elements, by the group.

Without the table or key the mesh needs no such group.
"""
LARGEST_LINING_END_ANGLE_DIFFERENCE_OF_MESH = math.radians(2)
"""Largest difference [rad] between an end of the lining in the brake's file and in the mesh.

With a larger difference the mesh and the brake's file do not describe the same shoe, and the mesh
is refused.
"""
SAME_NODE_POSITION_TOLERANCE = 1e-7
"""Distance between two nodes, relative to the mesh's size, below which they have the same position.

A mesh with two nodes at the same position is refused, since its parts are not bonded there.
"""
MOST_COUNTED_COINCIDENT_NODES = 1000
"""Largest number of coincident nodes for which the pairs of nodes at the same position are counted.

The message on such nodes then states the number of pairs. More nodes could form more pairs than the
memory holds, so that the message only says that there are many.
"""
LARGEST_RELATIVE_MESH_COORDINATE = 1e6
"""Largest coordinate of a mesh, relative to the drum's radius or to the length of a pad.

A mesh with a larger coordinate is refused, because round-off makes its checks unsure. The cause is
nearly always a wrong unit of length.
"""
LARGEST_RELATIVE_MIDDLE_NODE_OFFSET = 0.5
"""Largest distance of an edge's middle node from the middle of the chord, relative to the chord.

The chord is the straight line between the ends of an element's edge. At this distance the edge is
half a circle. A mesh with a larger distance is refused.
"""
LARGEST_CONTACT_DISTANCE_FROM_DRUM_OVER_RADIUS = 0.01
"""Largest distance of the lining's contact nodes from the drum or the plane.

The distance is relative to the drum's radius or to the length of a pad. The pressure is computed at
the nodes and stated on the drum, so that both must nearly coincide. A mesh with a larger distance
is refused.
"""
LARGEST_CONTACT_OVERLAP_OVER_LINING_THICKNESS = 0.1
"""Largest depth by which the lining's face reaches into the drum or the plane in a mesh.

The depth is relative to the lining's thickness. A larger depth is an interference fit, which is
refused unless the brake's file declares it.
"""
LARGEST_SLOPE_OF_CONTACT_AGAINST_DRUM = 0.1
"""Largest slope of an edge of the lining's face against the drum or the plane.

A steeper edge is no part of the lining's face, and the mesh is refused.
"""
SMALLEST_NODE_JACOBIAN_OVER_ELEMENT_SUM = 1e-6
"""Smallest Jacobian determinant at a node, relative to the sum over all nodes of its element.

A mesh is refused if an element has a smaller determinant: the element is inverted or has no area in
a corner.
"""


def check_mesh_and_drop_unneeded_groups(
    mesh: Any, shoe: Shoe, radius: float, fault: str, names: Sequence[str] = ()
) -> Any:
    """Check a user's mesh of a shoe, and return it with only the groups that the shoe needs.

    Parameters
    ----------
    mesh : scikit-fem's mesh in the shoe's frame [m]
    shoe : the shoe
    radius : radius of the drum [m]; on a plane the length of the pad
    fault : beginning of each message
    names : names of all groups in the file

    Raises
    ------
    BadInput
        for the first fault that is found
    """
    mesh = _mesh_with_only_needed_groups(mesh, shoe, fault, names)
    _check_nodes_are_near_and_distinct(mesh, shoe, radius, fault)
    _check_elements_are_valid_and_connected(mesh, shoe, fault)
    _check_named_edges_are_on_outline(mesh, fault)
    _check_contact_is_face_of_lining(mesh, shoe, radius, fault)
    _check_hinge_is_nearer_to_pin_than_actuation(mesh, shoe, fault)
    return mesh


def _mesh_with_only_needed_groups(mesh: Any, shoe: Shoe, fault: str, names: Sequence[str]) -> Any:
    """The mesh with only the groups that the shoe needs; others are left out.

    A mesh is refused if a needed group is missing, or if an element is not in exactly one of the
    needed groups of elements.
    """
    # A shoe needs its layers as subdomains, and contact, hinge and usually actuation as boundaries.
    subdomains, boundaries = mesh.subdomains, mesh.boundaries
    needed = {"lining"} | ({"backing"} if shoe.backing else set())
    if isinstance(shoe.body, ShoeBodyOfConstantSection):
        needed |= set(shoe.body.plates)
    elif shoe.body:
        needed.add("shoe")
    lines = {"contact", "hinge"} | (
        {"actuation"} if shoe.body and not shoe.has_support_on_back_of_body else set()
    )
    missing = sorted((needed - set(subdomains)) | (lines - set(boundaries)))
    if missing:
        shown = dict.fromkeys([*subdomains, *boundaries, *names][:MOST_GROUP_NAMES_IN_MESSAGE])
        found = ", ".join(sorted(shown)) or "none"
        raise BadInput(
            f"{fault}: named groups missing or empty: {', '.join(missing)}; found: {found} "
            f"(names or numbers of its own: groups = {{ {missing[0]} = ... }})"
        )
    # An element in no group is missing among the distinct members of all groups. An element in two
    # groups makes the total number of members larger than the number of elements.
    named = np.concatenate([subdomains[name] for name in needed])
    if len(np.unique(named)) < mesh.nelements or len(named) > mesh.nelements:
        reason = ""
        for name, table in BRAKE_FILE_KEY_OF_ELEMENT_GROUP.items():
            if name in subdomains and name not in needed:
                reason += f"; the file has a group {name}, and the shoe has no {table}"
        raise BadInput(
            f"{fault}: every element must be in exactly one of the groups "
            f"{', '.join(sorted(needed))}{reason}"
        )
    lines |= {"actuation"} & set(boundaries)
    return dataclasses.replace(
        mesh,
        _subdomains={name: subdomains[name] for name in subdomains if name in needed},
        _boundaries={name: boundaries[name] for name in boundaries if name in lines},
    )


def _check_nodes_are_near_and_distinct(mesh: Any, shoe: Shoe, radius: float, fault: str) -> None:
    """Refuse a mesh with coordinates that are too large, or with two nodes at the same position."""
    size = float(np.abs(mesh.doflocs).max())
    if size > LARGEST_RELATIVE_MESH_COORDINATE * radius:
        where = (
            f"on a plane, its lining {length_as_text_in_mm(radius)} long"
            if shoe.is_on_plane
            else f"in a drum of radius {length_as_text_in_mm(radius)}"
        )
        raise BadInput(
            f"{fault}: reaches {size:.3g} m far; must be a shoe {where} "
            f"(coordinates are read in {shoe.mesh_unit})"
        )
    # Many nodes at the same position would form too many pairs to count. A first check therefore
    # counts the squares of a fine grid that contain a node: nodes at one position share a square.
    cells = np.unique(np.round(mesh.doflocs / (SAME_NODE_POSITION_TOLERANCE * size)), axis=1)
    if cells.shape[1] < mesh.doflocs.shape[1] - MOST_COUNTED_COINCIDENT_NODES:
        raise BadInput(f"{fault}: many nodes stand in one place; merge them, the parts are bonded")
    pairs = scipy.spatial.cKDTree(mesh.doflocs.T).query_pairs(
        SAME_NODE_POSITION_TOLERANCE * size, output_type="ndarray"
    )
    if len(pairs):
        count = (
            "a pair of nodes stands" if len(pairs) == 1 else f"{len(pairs)} pairs of nodes stand"
        )
        x, y = 1e3 * shoe.convert_points_to_brake_frame(mesh.doflocs[:, pairs[0, :1]])[:, 0]
        first = "" if len(pairs) == 1 else "the first "
        raise BadInput(
            f"{fault}: {count} in one place ({first}at x = {x:.4g} mm, y = {y:.4g} mm); "
            "merge them, the parts are bonded"
        )


def _check_elements_are_valid_and_connected(mesh: Any, shoe: Shoe, fault: str) -> None:
    """Refuse a mesh with bent, inverted or folded elements, or with more than one part."""
    # The middle node of each edge must be near the middle of the edge's chord.
    basis = nodal_basis_of_mesh(mesh)
    on_edges = basis.doflocs[:, nodes_along_element_edges(basis, np.arange(mesh.nfacets))]
    first, *middles, last = on_edges.transpose(1, 0, 2)
    for middle in middles:
        bent = np.hypot(
            *(middle - (first + last) / 2)
        ) > LARGEST_RELATIVE_MIDDLE_NODE_OFFSET * np.hypot(*(last - first))
        if bent.any():
            where = _text_with_count_of_faulty_elements(
                mesh, mesh.f2t[0, np.flatnonzero(bent)], shoe
            )
            raise BadInput(f"{fault}: {where} with the middle node of an edge far off that edge")
    # The Jacobian determinant must have the same sign at all nodes of an element, plus or minus.
    determinant = mesh.mapping().detDF(basis.elem.doflocs.T)
    determinant = np.broadcast_to(determinant, (mesh.nelements, determinant.shape[-1]))
    smallest = np.abs(determinant.sum(axis=1)) * SMALLEST_NODE_JACOBIAN_OVER_ELEMENT_SUM
    flat = np.abs(determinant).min(axis=1) <= smallest
    inverted = flat | (np.ptp(np.sign(determinant), axis=1) > 0)
    if inverted.any():
        raise BadInput(
            f"{fault}: {_text_with_count_of_faulty_elements(mesh, np.flatnonzero(inverted), shoe)} "
            "inverted or without area in a corner"
        )
    if np.bincount(mesh.t2f.ravel()).max() > 2:
        raise BadInput(f"{fault}: more than two elements meet in an edge")
    # Two neighbours must lie on opposite sides of their common edge. If both lie on the same side,
    # one of them is folded over the other.
    inner = np.flatnonzero(mesh.f2t[1] >= 0)
    sides = np.array(
        [_sign_of_edge_side_where_element_lies(mesh, inner, mesh.f2t[i, inner]) for i in (0, 1)]
    )
    folded = inner[sides[0] * sides[1] > 0]
    if len(folded):
        raise BadInput(
            f"{fault}: {_text_with_count_of_faulty_elements(mesh, mesh.f2t[1, folded], shoe)} "
            "folded over a neighbour"
        )
    # Elements that share an edge are bonded. All elements of a shoe must form one bonded part.
    links = sp.coo_array(
        (np.ones(len(inner)), mesh.f2t[:, inner]), shape=(mesh.nelements, mesh.nelements)
    )
    parts, _ = sp.csgraph.connected_components(links)
    if parts > 1:
        raise BadInput(f"{fault}: consists of {parts} parts that share no edge; must be one")


def _text_with_count_of_faulty_elements(mesh: Any, elements: Ints, shoe: Shoe) -> str:
    """The subject of a sentence about faulty elements: "2 elements are (the first at x = ...)"."""
    ((x,), (y,)) = (
        shoe.convert_points_to_brake_frame(
            mesh.p[:, mesh.t[:, elements[0]]].mean(axis=1, keepdims=True)
        )
        * 1e3
    )
    count = len(np.unique(elements))
    return (
        f"{count} element{'s are' if count > 1 else ' is'} "
        f"(the first at x = {x:.4g} mm, y = {y:.4g} mm)"
    )


def _sign_of_edge_side_where_element_lies(mesh: Any, facets: Ints, elements: Ints) -> Floats:
    """The side of each edge (n,) on which the centre of an adjoining element lies: 1 or -1.

    `facets` (n,) are the indices of the edges, and `elements` (n,) are the indices of the elements.
    """
    a, b = mesh.p[:, mesh.facets[:, facets]].transpose(1, 0, 2)
    to = mesh.p[:, mesh.t[:, elements]].mean(axis=1) - a
    return np.sign((b - a)[0] * to[1] - (b - a)[1] * to[0])


def _check_named_edges_are_on_outline(mesh: Any, fault: str) -> None:
    """Refuse a mesh with named edges in its interior, or with a hinge that touches the contact."""
    outer = mesh.boundary_facets()
    for name, facets in mesh.boundaries.items():
        inside = len(np.setdiff1d(facets, outer))
        if inside:
            raise BadInput(
                f"{fault}: {inside} of the {len(facets)} edges of the group {name} "
                "are not on the boundary"
            )
    nodes = {name: np.unique(mesh.facets[:, facets]) for name, facets in mesh.boundaries.items()}
    if len(np.intersect1d(nodes["contact"], nodes["hinge"])):
        raise BadInput(f"{fault}: the groups contact and hinge share a node; must lie apart")


def _check_contact_is_face_of_lining(mesh: Any, shoe: Shoe, radius: float, fault: str) -> None:
    """Refuse a mesh whose group "contact" is not the lining's face on the drum or the plane."""
    # The edges of the contact must be edges of the lining's elements.
    facets = mesh.boundaries["contact"]
    if not np.isin(mesh.f2t[0, facets], mesh.subdomains["lining"]).all():
        raise BadInput(f"{fault}: the group contact must be edges of the lining only")
    # The nodes of the contact must lie near the drum or the plane.
    basis = nodal_basis_of_mesh(mesh)
    line = basis.doflocs[:, nodes_along_element_edges(basis, facets)]
    off, word = shoe.distances_from_friction_surface(line, radius), shoe.surface.name
    most, deep = float(np.abs(off).max()), -float(off.min())
    allowed = LARGEST_CONTACT_DISTANCE_FROM_DRUM_OVER_RADIUS * radius
    if most > allowed:
        surface = "plane" if shoe.is_on_plane else f"drum's radius {length_as_text_in_mm(radius)}"
        raise BadInput(
            f"{fault}: the group contact lies up to {length_as_text_in_mm(most)} off the "
            f"{surface}; "
            f"must be within {length_as_text_in_mm(allowed)} of it "
            f"(coordinates are read in {shoe.mesh_unit})"
        )
    # The lining's elements must lie behind its face, which must not reach deep into the drum.
    behind = shoe.distances_from_friction_surface(
        mesh.p[:, mesh.t[:, mesh.subdomains["lining"]]].mean(axis=1), radius
    )
    if behind.mean() < 0 and not shoe.mesh_interference:
        raise BadInput(
            f"{fault}: the lining's elements lie in the {word}; must lie behind the group contact"
        )
    if (
        deep > LARGEST_CONTACT_OVERLAP_OVER_LINING_THICKNESS * shoe.lining.thickness
        and not shoe.mesh_interference
    ):
        raise BadInput(
            f"{fault}: the group contact lies up to {length_as_text_in_mm(deep)} in the {word}, "
            f"over {LARGEST_CONTACT_OVERLAP_OVER_LINING_THICKNESS:g} of the lining's thickness of "
            f"{length_as_text_in_mm(shoe.lining.thickness)}; say mesh_interference = true if "
            f"that is meant"
        )
    steep = (
        np.abs(np.diff(off, axis=0))
        > LARGEST_SLOPE_OF_CONTACT_AGAINST_DRUM * np.hypot(*np.diff(line, axis=1))
    ).any(axis=0)
    if steep.any():
        where = _text_with_count_of_faulty_elements(mesh, mesh.f2t[0, facets[steep]], shoe)
        raise BadInput(
            f"{fault}: {where} with an edge of the contact that is steeper than "
            f"{LARGEST_SLOPE_OF_CONTACT_AGAINST_DRUM:g} against the {word}"
        )
    # The contact must have the same ends as the lining in the brake's file.
    nodes, ends = np.unique(mesh.facets[:, facets], return_inverse=True)
    xy = mesh.p[:, nodes]
    phi = shoe.surface_coordinates_of_points_in_shoe_frame(xy, radius)
    # Each node belongs to the lining that it is nearest to.
    distances = [np.maximum(start - phi, phi - end) for start, end in shoe.arcs]
    nearest = np.argmin(distances, axis=0)
    for k, arc in enumerate(shoe.arcs):
        _check_contact_covers_lining(phi[nearest == k], arc, shoe, fault)
    # With the nodes in the order of their angle, each edge must lead from a node to the next one
    # on the same lining.
    by_angle = np.argsort(phi)
    steps = np.sort(np.argsort(by_angle)[ends.reshape(2, -1)], axis=0)
    steps = steps[:, np.argsort(steps[0])]
    on_lining = nearest[by_angle]
    from_each = np.array_equal(steps[0], np.flatnonzero(on_lining[1:] == on_lining[:-1]))
    to_next = np.array_equal(steps[1], steps[0] + 1)
    if not (from_each and to_next):
        lines = "line" if len(shoe.arcs) == 1 else "line on each lining"
        raise BadInput(
            f"{fault}: the group contact must be one {lines} without gaps or turns, "
            "one edge after the other"
        )


def _check_contact_covers_lining(
    phi: Floats, arc: tuple[float, float], shoe: Shoe, fault: str
) -> None:
    """Refuse a mesh whose contact nodes on a lining do not reach from its start to its end.

    Parameters
    ----------
    phi : (n,) positions of the contact nodes on the lining [rad]
    arc : positions of the lining's ends in the brake's file [rad]
    shoe : the shoe
    fault : beginning of the message
    """
    found = (float(phi.min()), float(phi.max())) if len(phi) else (arc[0], arc[0])
    if (
        max(abs(a - b) for a, b in zip(found, arc, strict=True))
        <= LARGEST_LINING_END_ANGLE_DIFFERENCE_OF_MESH
    ):
        return
    text, frame = shoe.surface.coordinate_as_text, shoe.frame
    theta, wanted = (
        sorted(frame.surface_coordinates_of_phi(np.array(ends)).tolist()) for ends in (found, arc)
    )
    raise BadInput(
        f"{fault}: the group contact runs from {text(theta[0])} to {text(theta[1])}; "
        f"must be the lining's {'length' if shoe.is_on_plane else 'arc'}, "
        f"{text(wanted[0])} to {text(wanted[1])}, "
        f"within "
        f"{text(frame.surface_coordinate_per_phi * LARGEST_LINING_END_ANGLE_DIFFERENCE_OF_MESH)} "
        f"(coordinates are read in the {shoe.mesh_frame}'s frame)"
    )


def _check_hinge_is_nearer_to_pin_than_actuation(mesh: Any, shoe: Shoe, fault: str) -> None:
    """Refuse a mesh whose group "actuation" is nearer to the pin than its group "hinge"."""
    nodes = {name: np.unique(mesh.facets[:, facets]) for name, facets in mesh.boundaries.items()}
    if "actuation" in nodes and not shoe.has_support_on_back_of_body:
        away = {
            name: math.dist(shoe.pin_position_in_shoe_frame, mesh.p[:, nodes[name]].mean(axis=1))
            for name in ("hinge", "actuation")
        }
        if away["hinge"] > away["actuation"]:
            raise BadInput(
                f"{fault}: the group hinge lies {length_as_text_in_mm(away['hinge'])} from "
                f"the pin, "
                f"the group actuation {length_as_text_in_mm(away['actuation'])}; "
                "must be the nearer one (are they swapped?)"
            )
