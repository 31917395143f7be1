"""Half a three-dimensional shoe against its drum as an input deck for CalculiX; mm, N, MPa.

The mesh of `drumlin.peers.hexahedra` is used without the nodes in the middle of faces and cells.
Its cells are then CalculiX's hexahedra with 20 nodes and reduced integration (C3D20R). The
mid-plane is a plane of symmetry: its nodes are fixed along z, and all forces are halved. Everything
else in the deck is as in the deck of a shoe in plane stress.
"""

from functools import partial
from itertools import count
from pathlib import Path
from typing import NamedTuple

import numpy as np
import skfem

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.fields import Material
from drumlin.brake.further_loads import brake_with_all_loads_moved_to_actuation
from drumlin.fem.analysis.solid_fields import hexahedra_turned_to_positive_volume
from drumlin.fem.preparation.meshes import materials_and_widths_of_shoe_parts
from drumlin.fem.width.prepare import reason_why_width_model_does_not_apply
from drumlin.peers import calculix
from drumlin.peers.deck import (
    DRUM_LAYER_THICKNESS_OVER_RADIUS,
    DRUM_MODULUS_OVER_LINING_MODULUS,
    MM_PER_METRE,
    MPA_PER_PASCAL,
    CalculixDeckParameters,
    DrumMeshAsDeckLines,
    FirstDrumLabels,
    ShoeMeshOfDeck,
    angles_of_drum_nodes,
    deck_header_lines,
    deck_lines_of_contact,
    deck_lines_of_hinge,
    deck_lines_of_load_on_pin,
    deck_lines_of_load_step,
    deck_lines_of_nodal_forces,
    require_lining_without_gap,
)
from drumlin.peers.hexahedra import (
    DEFAULT_HEXAHEDRA_ALONG_LINING,
    HalfSolidShoeMesh,
    default_number_of_hexahedra_over_half_width,
    hexahedra_with_twenty_nodes_in_vtk_order,
    mesh_of_half_solid_shoe,
    nodal_forces_of_unit_loads_on_solid_end,
    nodes_of_boundary_over_width_of_part,
    solid_nodes_that_move_with_pin,
)
from drumlin.peers.peer import (
    MeshedShoeUnderActuation,
    PeerResult,
    mesh_hinged_shoes_under_actuation,
    zero_response_and_imbalance_of_shoe_turned_from_drum,
)

DRUM_ROTATION_IN_SOLID_DECK = 4e-3
"""Rotation of the drum [rad] in the first deck of a three-dimensional shoe.

Friction acts in the direction of slip. A pressed lining also expands by some ten micrometres across
its width. The displacement of the drum must be much larger, so that the slip and the friction are
along the drum's circumference."""

MODELLED_FRACTION_OF_WIDTH = 0.5
"""Fraction of the shoe's width that the deck models, see `CalculixDeckParameters.thickness`."""

HEXAHEDRON_FACES = [
    (0, 1, 2, 3),
    (4, 7, 6, 5),
    (0, 4, 5, 1),
    (1, 5, 6, 2),
    (2, 6, 7, 3),
    (3, 7, 4, 0),
]
"""The four corners of each face S1 to S6 of CalculiX's hexahedron."""

DRUM_WIDTH_OVER_LINING_WIDTH = 1.1
"""Width of the drum, relative to the width of the lining.

It is above 1, since the lining must not reach the drum's edge.
"""


class _ShoeUnderActuationWithSolidMesh(NamedTuple):
    """A shoe under its actuation, and its three-dimensional mesh."""

    loaded: MeshedShoeUnderActuation
    solid: HalfSolidShoeMesh


def export_solid_calculix_decks(
    brake: Brake,
    folder: Path,
    stem: str,
    *,
    elements: int = DEFAULT_HEXAHEDRA_ALONG_LINING,
    across: int | None = None,
) -> tuple[list[Path], list[str]]:
    """Write a CalculiX deck of a three-dimensional shoe for each shoe of a brake.

    Parameters
    ----------
    brake : the brake
    folder : folder in which the decks are written
    stem : first part of the names of the deck files
    elements : number of elements along each lining
    across : number of elements over half of the lining's width; None: it follows from `elements`

    Returns
    -------
    the paths of the decks, and the names of the shoes without a deck; the actuation turns these
    shoes away from the drum
    """
    setting = CalculixDeckParameters(
        rotation=DRUM_ROTATION_IN_SOLID_DECK, thickness=MODELLED_FRACTION_OF_WIDTH
    )
    decks = []
    for loaded, solid in _mesh_solid_shoes_under_actuation(brake, elements, across):
        decks.append(
            calculix.ShoeWithDeckText(
                loaded, partial(deck_text_of_half_solid_shoe, brake, loaded, solid, setting)
            )
        )
    return calculix.write_decks_of_shoes_pressed_on_drum(decks, folder, stem, "_solid")


def solve_solid_by_calculix(
    brake: Brake,
    *,
    elements: int = DEFAULT_HEXAHEDRA_ALONG_LINING,
    across: int | None = None,
    setting: CalculixDeckParameters | None = None,
) -> PeerResult:
    """Solve a brake with three-dimensional shoes by CalculiX.

    Raises the errors of `calculix.solve_brake_by_calculix`.

    Parameters
    ----------
    brake : the brake
    elements : number of elements along each lining
    across : number of elements over half of the lining's width; None: it follows from `elements`
    setting : parameters of the decks; None: the usual ones with the rotation
        DRUM_ROTATION_IN_SOLID_DECK
    """
    installed = calculix.calculix_version()
    start = (setting or CalculixDeckParameters(rotation=DRUM_ROTATION_IN_SOLID_DECK))._replace(
        thickness=MODELLED_FRACTION_OF_WIDTH
    )
    tally = calculix.CollectedCalculixResults()
    for loaded, solid in _mesh_solid_shoes_under_actuation(brake, elements, across):
        if not loaded.is_pressed_on_drum:
            tally.answers.append(zero_response_and_imbalance_of_shoe_turned_from_drum(loaded))
            continue
        pose = calculix.DeckWriterAndContactForceReader(
            text=partial(deck_text_of_half_solid_shoe, brake, loaded, solid),
            along=partial(nodal_forces_on_drum_arc, loaded),
        )
        state, _ = calculix.run_calculix_to_state_and_rotation_of_full_slip(
            brake, loaded, start, pose
        )
        tally.add_results_and_costs_of_shoe(loaded, state)
    return tally.result_of_brake_from_added_shoes(
        installed, (f"CalculiX {installed}, C3D20R, face-to-face penalty",)
    )


def _mesh_solid_shoes_under_actuation(
    brake: Brake, elements: int, across: int | None
) -> list[_ShoeUnderActuationWithSolidMesh]:
    """The shoes of a brake under their actuation, with their three-dimensional meshes.

    Raises BadInput if drumlin's model of solid shoes cannot solve the brake.
    """
    reason = reason_why_width_model_does_not_apply(brake)
    if reason is not None:
        raise BadInput(f"solid does not apply to this brake: {reason}")
    posed = []
    for loaded in mesh_hinged_shoes_under_actuation(
        brake_with_all_loads_moved_to_actuation(brake), elements
    ):
        shoe = loaded.shoe
        solid = mesh_of_half_solid_shoe(
            shoe,
            brake.size,
            elements,
            across or default_number_of_hexahedra_over_half_width(shoe, elements),
        )
        posed.append(_ShoeUnderActuationWithSolidMesh(loaded, solid))
    return posed


def deck_text_of_half_solid_shoe(
    brake: Brake,
    loaded: MeshedShoeUnderActuation,
    solid: HalfSolidShoeMesh,
    setting: CalculixDeckParameters,
    name: str = "shoe",
) -> str:
    """The text of the CalculiX deck of half a three-dimensional shoe, in the brake's frame.

    Parameters
    ----------
    brake : the brake
    loaded : the shoe under its actuation
    solid : three-dimensional mesh of the shoe
    setting : parameters of the deck
    name : name of the deck's file, without ending

    Raises
    ------
    BadInput
        for a clearance
    """
    shoe = loaded.shoe
    require_lining_without_gap(brake, loaded)
    points, cells = _points_and_cells_in_brake_frame(shoe, solid)
    used = np.unique(cells)
    held = np.intersect1d(solid_nodes_that_move_with_pin(solid, shoe), used)
    grid = _half_solid_shoe_mesh_for_deck(loaded, points, cells, held)
    drum_mesh = mesh_solid_drum(brake, loaded, FirstDrumLabels(grid.turn + 1, len(cells) + 1))
    # The nodes of the mid-plane are fixed along z. In a rigid shoe the nodes at the back, where
    # lining or backing is bonded to the shoe, are fixed along z as well.
    mid_plane = np.intersect1d(solid.node[solid.node[:, 0] >= 0, 0], used)
    bonded = held if shoe.body is None else held[:0]
    face = nodes_of_boundary_over_width_of_part(solid, "contact", "lining")
    actuation = _deck_lines_of_half_solid_shoe_actuation(loaded, solid, setting, grid)
    lines = [
        *deck_header_lines(brake, loaded, setting, name),
        "** half of the shoe, z >= 0: what is called thickness above is that half",
        *_deck_lines_of_half_solid_shoe_mesh(shoe, solid, points, grid),
        *drum_mesh.lines,
        *_deck_lines_of_solid_materials(shoe),
        *deck_lines_of_contact(
            brake, loaded, setting, _deck_lines_of_solid_faces(cells, face), "S1"
        ),
        *deck_lines_of_hinge(loaded, grid),
        "*BOUNDARY",
        *(f"{i + 1}, 3, 3" for i in np.union1d(mid_plane, bonded)),
        "NDRUM, 3, 3",
        *deck_lines_of_load_step(brake, setting, grid, drum_mesh.xy, actuation),
    ]
    return "\n".join(lines) + "\n"


def _points_and_cells_in_brake_frame(shoe: Shoe, solid: HalfSolidShoeMesh) -> tuple[Floats, Ints]:
    """The nodes (n, 3) [mm] of a solid shoe in the brake's frame, and its cells (m, 20).

    Nodes keep their numbers in drumlin's mesh. The cells do not use the nodes in the middle of
    faces and cells.
    """
    x = solid.basis.doflocs
    points = (
        np.column_stack([shoe.frame.convert_vectors_from_shoe_to_brake_frame(x[:2].T), x[2]])
        * MM_PER_METRE
    )
    cells = hexahedra_with_twenty_nodes_in_vtk_order(solid.basis.element_dofs)
    return points, hexahedra_turned_to_positive_volume(points, cells)


def _half_solid_shoe_mesh_for_deck(
    loaded: MeshedShoeUnderActuation, points: Floats, cells: Ints, held: Ints
) -> ShoeMeshOfDeck:
    """The mesh of half a three-dimensional shoe in the form of a CalculiX deck.

    Parameters
    ----------
    loaded : the shoe under its actuation
    points : positions (n, 3) of the nodes [mm]
    cells : numbers (m, 20) of the nodes of each cell
    held : numbers of the nodes at the hinge, which move with the pin
    """
    return ShoeMeshOfDeck(
        xy=points[:, :2],
        cells=cells,
        corners=8,
        kind="C3D20R",
        edges={"hinge": held},
        pin=len(points) + 1,
        turn=len(points) + 2,
        bearing=len(cells) + len(angles_of_drum_nodes(loaded)) // 2 + 1,
    )


def _deck_lines_of_half_solid_shoe_mesh(
    shoe: Shoe, solid: HalfSolidShoeMesh, points: Floats, grid: ShoeMeshOfDeck
) -> list[str]:
    """The lines of a deck for the nodes (n, 3) [mm] and the elements of half a shoe."""
    pin = [*(shoe.pin.xy * MM_PER_METRE), 0.0]
    lines = ["*NODE, NSET=NSHOE"]
    used = np.unique(grid.cells)
    lines += map(_deck_line_of_solid_node, used + 1, points[used])
    lines += ["*NODE, NSET=PIN", _deck_line_of_solid_node(grid.pin, pin)]
    lines += ["** its displacement x is the turn [rad] of the shoe about the pin"]
    lines += ["*NODE, NSET=TURN", _deck_line_of_solid_node(grid.turn, pin)]
    for part, members in solid.mesh.subdomains.items():
        lines.append(f"*ELEMENT, TYPE={grid.kind}, ELSET={part.upper()}")
        for i in np.sort(members):
            lines += _deck_lines_of_solid_element(i + 1, grid.cells[i] + 1)
    return lines


def _deck_lines_of_solid_materials(shoe: Shoe) -> list[str]:
    """The lines of a deck for the materials of a shoe and of the drum."""
    moduli = {}
    for part, (material, _) in materials_and_widths_of_shoe_parts(shoe).items():
        # `reason_why_width_model_does_not_apply` refuses orthotropic materials.
        assert isinstance(material, Material)
        moduli[part.upper()] = material.E, material.nu
    moduli["DRUM"] = DRUM_MODULUS_OVER_LINING_MODULUS * shoe.lining.material.E_through, 0.0
    lines = []
    for part, (E, nu) in moduli.items():
        lines += [f"*MATERIAL, NAME={part}", "*ELASTIC", f"{E * MPA_PER_PASCAL:.12e}, {nu:.12e}"]
        lines += [f"*SOLID SECTION, ELSET={part}, MATERIAL={part}"]
    return lines


def _deck_line_of_solid_node(label: int, at: Floats | list[float]) -> str:
    """The line of a deck for a node at the point `at` (3,) [mm]."""
    return f"{label}, {at[0]:.12e}, {at[1]:.12e}, {at[2]:.12e}"


def _deck_lines_of_solid_element(label: int, nodes: Ints) -> list[str]:
    """The two lines of a deck for an element of 20 nodes; a line holds at most 16 entries."""
    return [", ".join(map(str, [label, *nodes[:10]])) + ",", ", ".join(map(str, nodes[10:]))]


def _deck_lines_of_solid_faces(cells: Ints, on: Ints) -> list[str]:
    """The lines "element, S<face>" of a deck for the faces that lie on a surface.

    A face lies on the surface if its four corners are among the surface's nodes `on`.
    """
    inside = np.isin(cells[:, :8], on)
    lines = []
    for k, corners in enumerate(HEXAHEDRON_FACES):
        whole = np.flatnonzero(inside[:, corners].all(axis=1))
        lines += [f"{i + 1}, S{k + 1}" for i in whole]
    return lines


def _deck_lines_of_half_solid_shoe_actuation(
    loaded: MeshedShoeUnderActuation,
    solid: HalfSolidShoeMesh,
    setting: CalculixDeckParameters,
    grid: ShoeMeshOfDeck,
) -> list[str]:
    """The lines of a deck for the actuation of half a shoe.

    On an elastic body the lines give nodal forces on its end face. On a rigid shoe they give a
    force and a couple on the pin.
    """
    if "actuation" not in solid.section.boundaries:
        return deck_lines_of_load_on_pin(loaded, setting, grid)
    unit = nodal_forces_of_unit_loads_on_solid_end(solid)
    nodal = (unit @ np.array([*loaded.force, loaded.couple]))[:, :2]
    forces = setting.thickness * loaded.shoe.frame.convert_vectors_from_shoe_to_brake_frame(
        _forces_moved_from_face_middles(solid, nodal)
    )
    return deck_lines_of_nodal_forces(forces, np.flatnonzero(forces.any(axis=1)))


def _forces_moved_from_face_middles(solid: HalfSolidShoeMesh, forces: Floats) -> Floats:
    """Distribute nodal forces (n, 2) in the middle of faces to the other nodes of these faces.

    CalculiX's element has no node there. Its displacement in the middle of a face is 1/2 of the sum
    of the displacements at the middles of the four edges, minus 1/4 of the sum of the displacements
    at the four corners. The force is distributed with the same factors, so that it does the same
    work.
    """
    # In the unit cube the middle of a face has two coordinates 1/2, and the middle of an edge has
    # one coordinate 1/2.
    at, dofs = skfem.ElementHex2.doflocs, solid.basis.element_dofs
    halves = (at == 0.5).sum(axis=1)
    moved, done = forces.copy(), set[int]()
    for middle in np.flatnonzero(halves == 2):
        # The nodes of the face have one coordinate in common with its middle.
        axis = int(np.flatnonzero(at[middle] != 0.5)[0])
        face = (at[:, axis] == at[middle, axis]) & (np.arange(27) != middle)
        edges = face & (halves == 1)
        corners = face & (halves == 0)
        for cell in np.flatnonzero(forces[dofs[middle]].any(axis=1)):
            # Two cells may share a face, but its force must be moved only once.
            node = int(dofs[middle, cell])
            if node not in done:
                done.add(node)
                moved[dofs[corners, cell]] -= forces[node] / 4
                moved[dofs[edges, cell]] += forces[node] / 2
                moved[node] = 0.0
    return moved


class _DrumNodeRow(NamedTuple):
    """A row of the drum's nodes along the arc: radius [m], angles (k,) [rad], coordinate z [m]."""

    radius: float
    theta: Floats
    z: float

    @property
    def positions_of_drum_nodes_in_row(self) -> Floats:
        """The positions of the nodes (k, 3) [m]."""
        r, t = self.radius, self.theta
        return np.column_stack([r * np.cos(t), r * np.sin(t), np.full(len(t), self.z)])


def mesh_solid_drum(
    brake: Brake, loaded: MeshedShoeUnderActuation, first: FirstDrumLabels
) -> DrumMeshAsDeckLines:
    """The mesh of the drum in a three-dimensional CalculiX deck: one row of elements along the arc.

    The elements reach from z = 0 to a little beyond the side of the lining. Their face S1 lies on
    the friction surface. The nodes of the friction surface come first, in three rows: at z = 0, in
    the middle of the elements and at the outer side. `first` holds the labels of the first node and
    the first element.
    """
    shoe, R = loaded.shoe, brake.size
    theta = angles_of_drum_nodes(loaded)
    ends = theta[::2]
    back = R * (1 + shoe.sign_internal_plus_external_minus * DRUM_LAYER_THICKNESS_OVER_RADIUS)
    outer = DRUM_WIDTH_OVER_LINING_WIDTH * shoe.lining.width / 2
    rows = [
        _DrumNodeRow(R, theta, 0.0),
        _DrumNodeRow(R, ends, outer / 2),
        _DrumNodeRow(R, theta, outer),
        _DrumNodeRow(back, theta, 0.0),
        _DrumNodeRow(back, ends, outer / 2),
        _DrumNodeRow(back, theta, outer),
        _DrumNodeRow((R + back) / 2, ends, 0.0),
        _DrumNodeRow((R + back) / 2, ends, outer),
    ]
    xyz = np.concatenate([row.positions_of_drum_nodes_in_row for row in rows]) * MM_PER_METRE
    lines = ["*NODE, NSET=NDRUM"]
    lines += map(_deck_line_of_solid_node, count(first.node), xyz)
    lines.append("*ELEMENT, TYPE=C3D20, ELSET=DRUM")
    labels = first.node + np.cumsum([0, *(len(row.theta) for row in rows)])
    for k in range(len(ends) - 1):
        nodes = _node_labels_of_drum_element(
            labels[:-1].tolist(), k, shoe.sign_internal_plus_external_minus
        )
        lines += _deck_lines_of_solid_element(first.element + k, nodes)
    return DrumMeshAsDeckLines(lines, xyz[:, :2])


def _node_labels_of_drum_element(labels: list[int], k: int, sign: int) -> Ints:
    """The labels (20,) of the nodes of element k of the drum, in CalculiX's order.

    Parameters
    ----------
    labels : label of the first node of each row, in the order of the rows in `mesh_solid_drum`
    k : number of the element along the arc
    sign : 1 for an internal shoe, -1 for an external one
    """
    # The first letter of a row's name is f for the friction face, b for the back, m for the middle
    # between both. The second letter is 0 for z = 0, m for the middle of the element's width, 1 for
    # the outer side.
    f0, fm, f1, b0, bm, b1, m0, m1 = labels
    i = 2 * k
    front = np.array([f0 + i, f0 + i + 2, f1 + i + 2, f1 + i])
    front_edges = np.array([f0 + i + 1, fm + k + 1, f1 + i + 1, fm + k])
    behind = np.array([b0 + i, b0 + i + 2, b1 + i + 2, b1 + i])
    behind_edges = np.array([b0 + i + 1, bm + k + 1, b1 + i + 1, bm + k])
    between = np.array([m0 + k, m0 + k + 1, m1 + k + 1, m1 + k])
    # The nodes on the friction face come first, so that it is the face S1. The sense around the
    # face gives the element a positive volume.
    corners = [0, 1, 2, 3] if sign > 0 else [0, 3, 2, 1]
    edges = [0, 1, 2, 3] if sign > 0 else [3, 2, 1, 0]
    return np.concatenate(
        [front[corners], behind[corners], front_edges[edges], behind_edges[edges], between[corners]]
    )


def nodal_forces_on_drum_arc(loaded: MeshedShoeUnderActuation, forces: Floats) -> Floats:
    """The nodal forces (n, 2) on the drum's arc, summed over the width of the drum.

    `forces` has the forces on all nodes of the drum in the order of `mesh_solid_drum`. The sums are
    forces on the nodes of a line of quadratic elements along the arc.
    """
    count = len(angles_of_drum_nodes(loaded))
    ends = (count + 1) // 2
    total = forces[:count] + forces[count + ends : 2 * count + ends]
    total[::2] += forces[count : count + ends]
    return total
