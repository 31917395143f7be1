"""The checks of a user's mesh: a fault is refused in one line that says what is allowed."""

import dataclasses
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.spatial
import skfem

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Shoe
from drumlin.brake.components import Bar
from drumlin.brake.units import mm
from drumlin.fem.mesh.arc import mesh_kind_of
from drumlin.fem.mesh.edges import nodes_along_edges

MOST_LISTED_NAMES = 30
"""Names of groups that a refusal lists at most."""
LARGEST_ARC_DIFFERENCE = math.radians(2)
"""Largest difference [rad] between the ends of the lining in the brake's file and in the mesh.

A larger difference says that the mesh and the brake's file do not describe the same shoe.
"""
SAME_POINT = 1e-7
"""Distance of two nodes, relative to the mesh's size, below which both stand in one point.

A mesh with two nodes in one point is refused, since its parts are not bonded to each other there.
"""
MOST_COINCIDENT = 1000
"""Number of coincident nodes up to which their pairs are counted for the message.

More nodes in one point would make far more pairs than the memory holds.
"""
LARGEST_REACH = 1e6
"""Largest coordinate of a mesh, in drum radii or in lengths of a pad.

Round-off makes the checks of a larger mesh unsure. Its unit of length is nearly always wrong.
"""
MIDDLE_NODE_OFFSET = 0.5
"""Largest distance of an edge's middle node from the middle of its chord, relative to the chord.

An edge with a middle node at this distance is half a circle.
"""
CONTACT_OFFSET = 0.01
"""Largest distance of the contact from the drum or the plane, in drum radii or lengths of a pad.

The pressure is computed at the nodes and stated on the drum, so that both must nearly coincide.
"""
CONTACT_DEPTH = 0.1
"""Largest depth of the contact in the drum or the plane, in thicknesses of the lining.

A deeper contact is an interference fit, which the brake's file must declare.
"""
CONTACT_SLOPE = 0.1
"""Largest slope of a contact edge against the drum or the plane.

A steeper edge is no part of the lining's face.
"""
JACOBIAN_RATIO = 1e-6
"""Smallest Jacobian determinant in an element, relative to the sum over its nodes.

An element with a smaller determinant is inverted or has no area in a corner.
"""


def check_shoe_mesh(
    mesh: Any, shoe: Shoe, radius: float, fault: str, names: Sequence[str] = ()
) -> Any:
    """The mesh with the groups that the shoe needs, after all checks.

    Parameters
    ----------
    mesh : skfem's mesh in the shoe's frame [m]
    shoe : the shoe
    radius : of the drum [m]; on a plane the length of the pad
    fault : beginning of each message
    names : of all groups in the file

    Raises
    ------
    BadInput
        for the first fault that is found
    """
    mesh = _keep_needed_groups(mesh, shoe, fault, names)
    _check_nodes(mesh, shoe, radius, fault)
    _check_elements(mesh, shoe, fault)
    _check_boundaries(mesh, fault)
    _check_contact(mesh, shoe, radius, fault)
    _check_hinge_and_actuation(mesh, shoe, fault)
    return mesh


def check_cell_nodes(cells: Ints, corners: int, fault: str) -> None:
    """Refuse cells whose nodes do not make them a mesh.

    Parameters
    ----------
    cells : (m, k) nodes of the cells in meshio's order
    corners : number of corners of a cell
    fault : beginning of each message
    """
    # meshio's order is the corners, then the middle nodes of the edges, then the centre.
    ends, middles, centres = np.split(cells, [corners, 2 * corners], axis=1)
    edges = np.sort(np.stack([ends, np.roll(ends, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    distinct = [len(np.unique(nodes)) for nodes in (ends, middles, centres)]
    repeated = (np.diff(np.sort(cells, axis=1), axis=1) == 0).any()
    of_two_kinds = sum(distinct) > len(np.unique(cells))
    if repeated or of_two_kinds:
        raise BadInput(
            f"{fault}: has nodes that a cell has twice, "
            "or that are a corner here and inside an edge there"
        )
    # Edges, middle nodes and pairs of both are equally many.
    bonds = {len(np.unique(edges, axis=0))}
    if middles.size:
        bonds |= {distinct[1], len(np.unique(np.column_stack([edges, middles.ravel()]), axis=0))}
    if len(bonds) > 1 or distinct[2] not in {0, len(cells)}:
        raise BadInput(
            f"{fault}: has cells that share an edge but not its middle node, "
            "or a middle but not the edge"
        )


def _keep_needed_groups(mesh: Any, shoe: Shoe, fault: str, names: Sequence[str]) -> Any:
    """The mesh with only the groups that the shoe needs; each element must be in one of them."""
    subdomains, boundaries = mesh.subdomains, mesh.boundaries
    needed = {"lining"} | ({"backing"} if shoe.backing else set())
    if isinstance(shoe.body, Bar):
        needed |= set(shoe.body.plates)
    elif shoe.body:
        needed.add("shoe")
    lines = {"contact", "hinge"} | ({"actuation"} if shoe.body and not shoe.gripped else set())
    missing = sorted((needed - set(subdomains)) | (lines - set(boundaries)))
    if missing:
        found = (
            ", ".join(dict.fromkeys([*subdomains, *boundaries, *names][:MOST_LISTED_NAMES]))
            or "none"
        )
        raise BadInput(
            f"{fault}: named groups missing or empty: {', '.join(missing)}; found: {found} "
            f"(names or numbers of its own: groups = {{ {missing[0]} = ... }})"
        )
    # Elements in no group lower the number of distinct members, and elements in two groups raise
    # the number of all members.
    named = np.concatenate([subdomains[name] for name in needed])
    if len(np.unique(named)) < mesh.nelements or len(named) > mesh.nelements:
        raise BadInput(
            f"{fault}: every element must be in exactly one of the groups "
            f"{', '.join(sorted(needed))}"
        )
    lines |= {"actuation"} & set(boundaries)
    return dataclasses.replace(
        mesh,
        _subdomains={name: subdomains[name] for name in subdomains if name in needed},
        _boundaries={name: boundaries[name] for name in boundaries if name in lines},
    )


def _check_nodes(mesh: Any, shoe: Shoe, radius: float, fault: str) -> None:
    """Refuse nodes that are too far from the drum, and nodes that stand in one point."""
    size = float(np.abs(mesh.doflocs).max())
    if size > LARGEST_REACH * radius:
        where = (
            f"on a plane, its lining {mm(radius)} long"
            if shoe.flat
            else f"in a drum of radius {mm(radius)}"
        )
        raise BadInput(
            f"{fault}: reaches {size:.3g} m far; must be a shoe {where} "
            f"(coordinates are read in {shoe.mesh_unit})"
        )
    # Many nodes in one point would make far more pairs, which are not counted.
    cells = np.unique(np.round(mesh.doflocs / (SAME_POINT * size)), axis=1)
    if cells.shape[1] < mesh.doflocs.shape[1] - MOST_COINCIDENT:
        raise BadInput(f"{fault}: many nodes stand in one place; merge them, the parts are bonded")
    pairs = scipy.spatial.cKDTree(mesh.doflocs.T).query_pairs(
        SAME_POINT * size, output_type="ndarray"
    )
    if len(pairs):
        raise BadInput(
            f"{fault}: {len(pairs)} pairs of nodes stand in one place; "
            "merge them, the parts are bonded"
        )


def _check_elements(mesh: Any, shoe: Shoe, fault: str) -> None:
    """Refuse bent, inverted and folded elements, and meshes of more than one part."""
    basis = skfem.Basis(
        mesh, mesh_kind_of(mesh).element(), quadrature=(np.zeros((2, 1)), np.ones(1))
    )
    on_edges = basis.doflocs[:, nodes_along_edges(basis, np.arange(mesh.nfacets))]
    first, *middles, last = on_edges.transpose(1, 0, 2)
    for middle in middles:
        bent = np.hypot(*(middle - (first + last) / 2)) > MIDDLE_NODE_OFFSET * np.hypot(
            *(last - first)
        )
        if bent.any():
            where = _text_on_faulty_elements(mesh, mesh.f2t[0, np.flatnonzero(bent)], shoe)
            raise BadInput(f"{fault}: {where} with the middle node of an edge far off that edge")
    # The Jacobian determinant of an element may have either sign, but only one of them.
    determinant = mesh.mapping().detDF(mesh_kind_of(mesh).element().doflocs.T)
    determinant = np.broadcast_to(determinant, (mesh.nelements, determinant.shape[-1]))
    smallest = np.abs(determinant.sum(axis=1)) * JACOBIAN_RATIO
    flat = np.abs(determinant).min(axis=1) <= smallest
    inverted = flat | (np.ptp(np.sign(determinant), axis=1) > 0)
    if inverted.any():
        raise BadInput(
            f"{fault}: {_text_on_faulty_elements(mesh, np.flatnonzero(inverted), shoe)} "
            "inverted or without area in a corner"
        )
    if np.bincount(mesh.t2f.ravel()).max() > 2:
        raise BadInput(f"{fault}: more than two elements meet in an edge")
    # Neighbours lie on opposite sides of their common edge, or else one is folded over the other.
    inner = np.flatnonzero(mesh.f2t[1] >= 0)
    sides = np.array([_side_of_facet_with_element(mesh, inner, mesh.f2t[i, inner]) for i in (0, 1)])
    folded = inner[sides[0] * sides[1] > 0]
    if len(folded):
        raise BadInput(
            f"{fault}: {_text_on_faulty_elements(mesh, mesh.f2t[1, folded], shoe)} "
            "folded over a neighbour"
        )
    # Elements that share an edge are bonded; a shoe is one bonded part.
    links = sp.coo_array(
        (np.ones(len(inner)), mesh.f2t[:, inner]), shape=(mesh.nelements, mesh.nelements)
    )
    parts, _ = sp.csgraph.connected_components(links)
    if parts > 1:
        raise BadInput(f"{fault}: consists of {parts} parts that share no edge; must be one")


def _text_on_faulty_elements(mesh: Any, elements: Ints, shoe: Shoe) -> str:
    """The subject of a sentence about some elements: their number, and where the first lies."""
    ((x,), (y,)) = shoe.points(mesh.p[:, mesh.t[:, elements[0]]].mean(axis=1, keepdims=True)) * 1e3
    count = len(np.unique(elements))
    return (
        f"{count} element{'s are' if count > 1 else ' is'} "
        f"(the first at x = {x:.4g} mm, y = {y:.4g} mm)"
    )


def _side_of_facet_with_element(mesh: Any, facets: Ints, elements: Ints) -> Floats:
    """The sign (n,) of the side of each facet on which the centre of its element lies."""
    a, b = mesh.p[:, mesh.facets[:, facets]].transpose(1, 0, 2)
    to = mesh.p[:, mesh.t[:, elements]].mean(axis=1) - a
    return np.sign((b - a)[0] * to[1] - (b - a)[1] * to[0])


def _check_boundaries(mesh: Any, fault: str) -> None:
    """Refuse named edges inside the mesh, and a hinge that touches the contact."""
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


def _check_contact(mesh: Any, shoe: Shoe, radius: float, fault: str) -> None:
    """Refuse a contact that is not the lining's face on the drum or the plane."""
    facets = mesh.boundaries["contact"]
    if not np.isin(mesh.f2t[0, facets], mesh.subdomains["lining"]).all():
        raise BadInput(f"{fault}: the group contact must be edges of the lining only")
    basis = skfem.Basis(
        mesh, mesh_kind_of(mesh).element(), quadrature=(np.zeros((2, 1)), np.ones(1))
    )
    line = basis.doflocs[:, nodes_along_edges(basis, facets)]
    off, word = shoe.off(line, radius), shoe.surface.word
    most, deep = float(np.abs(off).max()), -float(off.min())
    if most > CONTACT_OFFSET * radius:
        surface = "plane" if shoe.flat else f"drum's radius {mm(radius)}"
        raise BadInput(
            f"{fault}: the group contact lies up to {mm(most)} off the {surface}; "
            f"must be within {mm(CONTACT_OFFSET * radius)} of it "
            f"(coordinates are read in {shoe.mesh_unit})"
        )
    behind = shoe.off(mesh.p[:, mesh.t[:, mesh.subdomains["lining"]]].mean(axis=1), radius)
    if behind.mean() < 0 and not shoe.mesh_interference:
        raise BadInput(
            f"{fault}: the lining's elements lie in the {word}; must lie behind the group contact"
        )
    if deep > CONTACT_DEPTH * shoe.lining.thickness and not shoe.mesh_interference:
        raise BadInput(
            f"{fault}: the group contact lies up to {mm(deep)} in the {word}, "
            f"over {CONTACT_DEPTH:g} of the lining's thickness of {mm(shoe.lining.thickness)}; "
            "say mesh_interference = true if that is meant"
        )
    steep = (np.abs(np.diff(off, axis=0)) > CONTACT_SLOPE * np.hypot(*np.diff(line, axis=1))).any(
        axis=0
    )
    if steep.any():
        where = _text_on_faulty_elements(mesh, mesh.f2t[0, facets[steep]], shoe)
        raise BadInput(
            f"{fault}: {where} with an edge of the contact that is steeper than "
            f"{CONTACT_SLOPE:g} against the {word}"
        )
    nodes, ends = np.unique(mesh.facets[:, facets], return_inverse=True)
    xy = mesh.p[:, nodes]
    phi, text = shoe.phi_of(xy, radius), shoe.surface.place
    arc = (float(phi.min()), float(phi.max()))
    if max(abs(a - b) for a, b in zip(arc, shoe.arc, strict=True)) > LARGEST_ARC_DIFFERENCE:
        theta = sorted(shoe.frame.theta(np.array(arc)).tolist())
        raise BadInput(
            f"{fault}: the group contact runs from {text(theta[0])} to {text(theta[1])}; "
            f"must be the lining's {'length' if shoe.flat else 'arc'}, "
            f"{text(shoe.lining.start)} to {text(shoe.lining.end)}, "
            f"within {text(shoe.frame.unit * LARGEST_ARC_DIFFERENCE)} "
            f"(coordinates are read in the {shoe.mesh_frame}'s frame)"
        )
    # By growing angle each edge leads from one node to the next.
    steps = np.sort(np.argsort(np.argsort(phi))[ends.reshape(2, -1)], axis=0)
    steps = steps[:, np.argsort(steps[0])]
    from_each = np.array_equal(steps[0], np.arange(len(phi) - 1))
    to_next = np.array_equal(steps[1], steps[0] + 1)
    if not (from_each and to_next):
        raise BadInput(
            f"{fault}: the group contact must be one line without gaps or turns, "
            "one edge after the other"
        )


def _check_hinge_and_actuation(mesh: Any, shoe: Shoe, fault: str) -> None:
    """Refuse a mesh whose hinge and actuation are swapped."""
    nodes = {name: np.unique(mesh.facets[:, facets]) for name, facets in mesh.boundaries.items()}
    if "actuation" in nodes and not shoe.gripped:
        away = {
            name: math.dist(shoe.own_pin, mesh.p[:, nodes[name]].mean(axis=1))
            for name in ("hinge", "actuation")
        }
        if away["hinge"] > away["actuation"]:
            raise BadInput(
                f"{fault}: the group hinge lies {mm(away['hinge'])} from the pin, "
                f"the group actuation {mm(away['actuation'])}; "
                "must be the nearer one (are they swapped?)"
            )
