"""Displacements and stresses inside solid shoes, with polynomials across the width.

The module samples the fields at points across the width, above each node of the cross-section. The
fields are computed only for a picture or a file.
"""

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.brake.brake import Brake, Shoe, ShoeFrame
from drumlin.fem.analysis.fields import nodal_means_of_element_tensors
from drumlin.fem.preparation.bodies import ShoeSubstructure
from drumlin.fem.preparation.displacements import nodal_displacements_of_shoe
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.width.face import ContactFaceWithWidth
from drumlin.fem.width.functions import FunctionsAcrossWidth
from drumlin.fem.width.integrals import LameConstants
from drumlin.fem.width.recovery import EliminatedUnknownsOfShoeWithWidth
from drumlin.response.balance import brake_with_forces_of_response
from drumlin.response.response import Response, ShoeResponse
from drumlin.response.resultants import gauss_lobatto_points

FEWEST_INTERVALS_ACROSS_WIDTH_PIECE = 2
"""Smallest number of intervals between the sample points across a piece of the half width.

A piece is a range of z in which the width functions are polynomials. With one interval the sides of
a shoe would be drawn flat. For polynomials of a higher degree the number of intervals equals the
degree, so that the samples determine the polynomial.
"""


_NODE_ORDER_OF_TURNED_HEXAHEDRON = [
    4,
    5,
    6,
    7,
    0,
    1,
    2,
    3,
    12,
    13,
    14,
    15,
    8,
    9,
    10,
    11,
    16,
    17,
    18,
    19,
]
"""Node order that turns a hexahedron upside down; its nodes are in the order of VTK.

Bottom and top are exchanged. Corners come first, then the middles of the edges.
"""


class StressAndDisplacementFieldsOfHalfShoe(NamedTuple):
    """Displacement and stress in half a shoe (z >= 0), in the brake's frame.

    A node is repeated for each material that meets in it.

    Attributes
    ----------
    points : (n, 3) nodes [m]
    cells : (m, 8) nodes of each hexahedron
    part : (m,) number of the subdomain of each cell
    displacement : (n, 3) displacement of the nodes [m]
    solid_stress : (n, 6) stresses xx, yy, zz, xy, yz, xz [Pa]
    von_mises : (n,) von Mises stress [Pa]
    pressure : (n,) pressure on the friction surface [Pa], 0 elsewhere
    cell_type : name of the cells in meshio
    """

    points: Floats
    cells: Ints
    part: Ints
    displacement: Floats
    solid_stress: Floats
    von_mises: Floats
    pressure: Floats
    cell_type: str = "hexahedron"


class _SamplesAcrossWidthPiece(NamedTuple):
    """The sample points across one piece of the half width, with the width functions there.

    Attributes
    ----------
    z : (s,) distances from the mid-plane [m]
    even, even_slopes : (e, s) values [1] and slopes [1/m] of the functions that are even in z
    odd, odd_slopes : (o, s) values [1] and slopes [1/m] of the functions that are odd in z
    """

    z: Floats
    even: Floats
    even_slopes: Floats
    odd: Floats
    odd_slopes: Floats


class _FieldsOfShoePart(NamedTuple):
    """The fields in one part of a shoe, in the shoe's frame.

    Attributes
    ----------
    nodes : (n,) for each sample point, the number of the node of the cross-section below the point
    z : (n,) distances of the samples from the mid-plane [m]
    cells : (m, 8) numbers of the samples at the corners of each cell
    displacement : (n, 3) displacement [m]
    stress : (n, 3, 3) stress [Pa], the mean over the elements around a sample
    """

    nodes: Ints
    z: Floats
    cells: Ints
    displacement: Floats
    stress: Floats


def recover_stresses_in_half_of_each_solid_shoe(
    scene: PreparedModel, brake: Brake, response: Response
) -> list[StressAndDisplacementFieldsOfHalfShoe]:
    """The displacements and stresses in half of each shoe (z >= 0), from a response's pressures.

    `response` was computed on the prepared model `scene`, which has shoes with widths.
    """
    brake = brake_with_forces_of_response(brake, response)
    return [
        _recover_stresses_in_half_of_solid_shoe(body, brake, shoe, answer)
        for body, shoe, answer in zip(scene.bodies, brake.shoes, response.shoes, strict=True)
    ]


def _recover_stresses_in_half_of_solid_shoe(
    body: ShoeSubstructure, brake: Brake, shoe: Shoe, answer: ShoeResponse
) -> StressAndDisplacementFieldsOfHalfShoe:
    """The displacements and stresses in half of a shoe (z >= 0).

    Parameters
    ----------
    body : the condensed shoe
    brake : the brake, with the forces of its response
    shoe : the shoe
    answer : response of the shoe
    """
    face = contact_face_of_solid_shoe(body)
    p = np.zeros(len(face.nodes))
    if answer.surface is not None:
        surface = answer.surface
        p = face.nodal_pressures_from_pressures_of_file(
            surface._replace(pressure=surface.pressure[:: shoe.frame.sense])
        )
    unknowns = displacement_unknowns_of_solid_shoe(body)
    u = nodal_displacements_of_shoe(body, brake, shoe, answer, p)

    # A sample at the interface of two parts occurs twice, because each part has its own stress.
    parts, cells, numbers, pressures, count = [], [], [], [], 0
    for i, name in enumerate(unknowns.grid.subdomains):
        part = displacements_and_stresses_in_shoe_part(unknowns, u, name)
        parts.append(part)
        cells.append(part.cells + count)
        numbers.append(np.full(len(part.cells), i))
        pressures.append(
            _pressure_at_sample_points_of_lining(face, p, part)
            if name == "lining"
            else np.zeros(len(part.z))
        )
        count += len(part.nodes)
    nodes, z, stress = (
        np.concatenate([getattr(part, name) for part in parts]) for name in ("nodes", "z", "stress")
    )
    moved = np.concatenate([part.displacement for part in parts])
    to_brake = shoe.frame.convert_vectors_from_shoe_to_brake_frame
    points = np.column_stack(
        [shoe.convert_points_to_brake_frame(unknowns.grid.doflocs[:, nodes]).T, z]
    )
    return StressAndDisplacementFieldsOfHalfShoe(
        points=points,
        cells=hexahedra_turned_to_positive_volume(points, np.concatenate(cells)),
        part=np.concatenate(numbers),
        displacement=np.column_stack([to_brake(moved[:, :2]), moved[:, 2]]),
        von_mises=von_mises_stress_of_solid(stress),
        solid_stress=stress_components_in_brake_frame(stress, shoe.frame),
        pressure=np.concatenate(pressures),
    )


def contact_face_of_solid_shoe(body: ShoeSubstructure) -> ContactFaceWithWidth:
    """The contact face of a shoe with a width."""
    # `prepare_model_with_shoe_widths` gives every body a face of this type.
    assert isinstance(body.line, ContactFaceWithWidth)
    return body.line


def displacement_unknowns_of_solid_shoe(
    body: ShoeSubstructure,
) -> EliminatedUnknownsOfShoeWithWidth:
    """The object that recovers the eliminated displacements of a shoe with a width."""
    # `prepare_model_with_shoe_widths` gives every body unknowns of this type.
    assert isinstance(body.condensed.inner, EliminatedUnknownsOfShoeWithWidth)
    return body.condensed.inner


def _width_functions_at_sample_points_of_each_piece(
    functions: FunctionsAcrossWidth, half: float
) -> Iterator[_SamplesAcrossWidthPiece]:
    """Yield the sample points, with the width functions, of each piece of a part's half width."""
    ends = functions.breaks[: functions.number_of_width_pieces_in_part(half) + 1]
    if len(ends) == 1 or functions.degree == 0:
        ends = (0.0, half)
    steps = 0.5 * (
        1 + gauss_lobatto_points(max(functions.degree, FEWEST_INTERVALS_ACROSS_WIDTH_PIECE))
    )
    for start, end in pairwise(ends):
        z = start + (end - start) * steps
        # At the outer end of a piece the slopes may jump. The slopes are taken from within the
        # piece, just before its end.
        at = np.append(z[:-1], np.nextafter(end, 0.0))
        even = functions.function_values_and_slopes(functions.even_functions_across_width, at)
        odd = functions.function_values_and_slopes(functions.odd_functions_across_width, at)
        yield _SamplesAcrossWidthPiece(z, *even, *odd)


def displacements_and_stresses_in_shoe_part(
    unknowns: EliminatedUnknownsOfShoeWithWidth, u: Floats, name: str
) -> _FieldsOfShoePart:
    """The displacements and stresses in the part `name` of a shoe, from all unknowns u [m]."""
    grid, elements = unknowns.grid, unknowns.grid.subdomains[name]
    even, odd = unknowns.factors_of_even_and_odd_functions_at_nodes(u)
    layer = unknowns.division.part.index(name)
    half, lame = unknowns.layers.halves[layer], unknowns.layers.lame[layer]
    dofs, slopes = (
        grid.element_dofs[:, elements],
        grid.shape_function_gradients_at_element_nodes(elements),
    )
    pieces = list(_width_functions_at_sample_points_of_each_piece(unknowns.functions, half))
    steps = len(pieces[0].z) - 1
    levels = np.append(np.concatenate([piece.z[:-1] for piece in pieces]), pieces[-1].z[-1])
    stresses, places = [], []
    for k, piece in enumerate(pieces):
        stress = _stress_at_sample_points_across_width(even, odd, dofs, slopes, piece, lame)
        if unknowns.functions.degree == 0:
            # Plane stress has no stress across the width.
            stress[2, 2] = 0.0
        stresses.append(stress.reshape(3, 3, len(elements), -1))
        # The number of a sample is (node number) times (count of levels) plus (level number). A
        # level is one sampled distance from the mid-plane.
        level = k * steps + np.arange(steps + 1)
        places.append((dofs[:, None] * len(levels) + level[:, None]).reshape(-1, len(elements)))
    means = nodal_means_of_element_tensors(
        np.concatenate(stresses, axis=2), np.concatenate(places, axis=1)
    )
    nodes, level = np.divmod(means.nodes, len(levels))
    displacement = np.zeros((len(levels), grid.N, 3))
    for k, piece in enumerate(pieces):
        within = slice(k * steps, (k + 1) * steps + 1)
        displacement[within, :, :2] = np.einsum("nkc,ks->snc", even, piece.even)
        displacement[within, :, 2] = np.einsum("nk,ks->sn", odd, piece.odd)
    corners = _corners_of_cells_between_sample_points(
        grid.quadrilaterals_between_element_nodes, steps + 1
    )
    cells = means.cells[corners].reshape(8, -1).T
    return _FieldsOfShoePart(nodes, levels[level], cells, displacement[level, nodes], means.values)


def _corners_of_cells_between_sample_points(quadrilaterals: Ints, levels: int) -> Ints:
    """The corners (8, cells) of the cells between the samples of an element.

    The samples of an element are numbered node by node, and at each node by the sampled distances
    (levels) from the mid-plane. The corners are in the order of VTK.

    Parameters
    ----------
    quadrilaterals : (4, k) nodes of the quadrilaterals between the nodes of the element
    levels : number of levels
    """
    lower = quadrilaterals[:, :, None] * levels + np.arange(levels - 1)
    return np.concatenate([lower, lower + 1]).reshape(8, -1)


def _stress_at_sample_points_across_width(
    even: Floats,
    odd: Floats,
    dofs: Ints,
    slopes: Floats,
    piece: _SamplesAcrossWidthPiece,
    lame: LameConstants,
) -> Floats:
    """The stress (3, 3, m, a, s) [Pa] of m elements at their a nodes and s distances z.

    Parameters
    ----------
    even, odd : (nodes, e, 2) and (nodes, o) factors [m] of the even and odd width functions:
        displacements in the section, and across the width
    dofs : (a, m) nodes of the elements
    slopes : (a, 2, m, a) gradients of the shape functions at the nodes [1/m]
    piece : the distances z from the mid-plane, and the width functions there
    lame : Lame constants of the elements
    """
    # `own` are the factors of the even width functions at the nodes of each element, and `across`
    # the factors of the odd ones. `plane` and `tilted` are the gradients of these factors in the
    # section.
    own, across = even[dofs], odd[dofs]
    plane = np.einsum("amkc,ajmn->cjmnk", own, slopes, optimize=True)
    tilted = np.einsum("amk,ajmn->jmnk", across, slopes, optimize=True)
    gradient = np.zeros((3, 3, dofs.shape[1], dofs.shape[0], len(piece.z)))
    gradient[:2, :2] = plane @ piece.even
    gradient[2, :2] = tilted @ piece.odd
    gradient[:2, 2] = np.einsum("amkc,ks->cmas", own, piece.even_slopes, optimize=True)
    gradient[2, 2] = np.einsum("amk,ks->mas", across, piece.odd_slopes, optimize=True)
    stress = lame.mu * (gradient + gradient.swapaxes(0, 1))
    stress[range(3), range(3)] += lame.lam * np.trace(gradient)
    return np.asarray(stress)


def _pressure_at_sample_points_of_lining(
    face: ContactFaceWithWidth, p: Floats, lining: _FieldsOfShoePart
) -> Floats:
    """The pressure (n,) [Pa] at the samples of a lining, 0 off the face.

    `p` are the pressures [Pa] at the nodes of the contact face.
    """
    levels, level = np.unique(lining.z, return_inverse=True)
    on_face = face.pressure_at_distances_from_mid_plane(p, levels)
    # The nodes on the contact line have the first numbers among the nodes of the cross-section.
    touching = lining.nodes < len(on_face)
    found = np.zeros(len(lining.z))
    found[touching] = on_face[lining.nodes[touching], level[touching]]
    return found


def hexahedra_turned_to_positive_volume(points: Floats, cells: Ints) -> Ints:
    """The hexahedra `cells` (m, 8) or (m, 20), turned over where their volume is negative.

    A mirror image makes volumes negative. `points` (n, 3) are the nodes.
    """
    a, b, c, d = (points[cells[:, i]] for i in (0, 1, 3, 4))
    volume = np.einsum("mi,mi->m", np.cross(b - a, c - a), d - a)
    return np.where(
        (volume > 0)[:, None], cells, cells[:, _NODE_ORDER_OF_TURNED_HEXAHEDRON[: cells.shape[1]]]
    )


def von_mises_stress_of_solid(stress: Floats) -> Floats:
    """The von Mises stress (n,) [Pa] of stresses (n, 3, 3) [Pa]."""
    deviator = stress - np.trace(stress, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    return np.sqrt(1.5 * (deviator**2).sum(axis=(1, 2)))


def stress_components_in_brake_frame(stress: Floats, frame: ShoeFrame) -> Floats:
    """The stresses xx, yy, zz, xy, yz, xz (n, 6) [Pa] in the brake's frame.

    `stress` (n, 3, 3) [Pa] are the stresses in the shoe's frame.
    """
    # Stresses are tensors: both of their indices turn with the frame.
    turn = np.eye(3)
    turn[:2, :2] = frame.convert_vectors_from_shoe_to_brake_frame(np.eye(2))
    turned = np.einsum("ia,nij,jb->nab", turn, stress, turn, optimize=True)
    rows, columns = [0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]
    return np.asarray(turned[:, rows, columns])
