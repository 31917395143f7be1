"""Half a solid shoe against its drum as an input deck for CalculiX; units mm, N, MPa.

The mesh is drumlin's own. The cells are hexahedra with 20 nodes and reduced integration (C3D20R):
drumlin's cells without the nodes in the middle of faces and cells. The mid-plane is held along z,
and forces are half the brake's. All else is as in the plane deck.
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
from drumlin.fem.preparation.meshes import materials_of_parts
from drumlin.fem.solid.body import end_forces, friction_face, hinge_nodes
from drumlin.fem.solid.fields import orient_cells, serendipity_cells
from drumlin.fem.solid.mesh import Solid, solid_mesh
from drumlin.fem.solid.model import SOLID_LINING_ELEMENTS, elements_across, why_not
from drumlin.peers import calculix
from drumlin.peers.deck import (
    DRUM_LAYER,
    DRUM_MODULUS,
    MM,
    MPA,
    DeckGrid,
    DeckSetting,
    DrumMesh,
    FirstLabels,
    check_fit,
    contact_lines,
    drum_angles,
    header_lines,
    hinge_lines,
    nodal_load_lines,
    pin_load_lines,
    step_lines,
)
from drumlin.peers.peer import Loaded, Peer, loaded_shoes, untouched_response

ROTATION = 4e-3
"""Rotation of the drum [rad].

Friction has the direction of the slip. As the lining is pressed it widens and creeps sideways by
some ten micrometres, which must be little beside the way of the drum."""

MODELLED_WIDTH = 0.5
"""Part of the shoe that the deck holds. It takes the place of the plane deck's thickness."""

FACES = [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)]
"""Corners of CalculiX's faces S1 to S6 of a hexahedron."""

DRUM_WIDTH = 1.1
"""Width of the drum relative to the lining's, so that the lining does not reach its edge."""


class _SolidShoe(NamedTuple):
    """A shoe under its force, and its solid mesh."""

    loaded: Loaded
    solid: Solid


def export(
    brake: Brake,
    folder: Path,
    stem: str,
    *,
    elements: int = SOLID_LINING_ELEMENTS,
    across: int | None = None,
) -> tuple[list[Path], list[str]]:
    """Write a CalculiX deck for each solid shoe of a brake.

    Parameters
    ----------
    brake : the brake
    folder : where the decks are written
    stem : first part of their names
    elements : along each lining
    across : over half of the lining's width; None: by the mesh along the lining

    Returns
    -------
    the files, and the names of shoes without a deck, which their force turns away from the drum
    """
    setting = DeckSetting(rotation=ROTATION, thickness=MODELLED_WIDTH)
    decks = []
    for loaded, solid in _posed(brake, elements, across):
        decks.append(calculix.ShoeDeck(loaded, partial(deck, brake, loaded, solid, setting)))
    return calculix.write_decks(decks, folder, stem, "_solid")


def solve(
    brake: Brake,
    *,
    elements: int = SOLID_LINING_ELEMENTS,
    across: int | None = None,
    setting: DeckSetting | None = None,
) -> Peer:
    """Solve a brake's solid shoes by CalculiX. Raises the errors of `calculix.solve`.

    Parameters
    ----------
    brake : the brake
    elements : along each lining
    across : over half of the lining's width; None: by the mesh along the lining
    setting : of the decks
    """
    installed = calculix.version()
    start = (setting or DeckSetting(rotation=ROTATION))._replace(thickness=MODELLED_WIDTH)
    tally = calculix.RunTally()
    for loaded, solid in _posed(brake, elements, across):
        if not loaded.approaches:
            tally.answers.append(untouched_response(loaded))
            continue
        pose = calculix.PosedShoe(
            text=partial(deck, brake, loaded, solid), along=partial(along, loaded)
        )
        state, _ = calculix.slipping(brake, loaded, start, pose)
        tally.add(loaded, state)
    return tally.peer(installed, (f"CalculiX {installed}, C3D20R, face-to-face penalty",))


def _posed(brake: Brake, elements: int, across: int | None) -> list[_SolidShoe]:
    """The solid shoes of a brake with their meshes, each under its force.

    Raises BadInput where the model of solid shoes does not apply.
    """
    reason = why_not(brake)
    if reason is not None:
        raise BadInput(f"solid does not apply to this brake: {reason}")
    posed = []
    for loaded in loaded_shoes(brake, elements):
        shoe = loaded.shoe
        solid = solid_mesh(shoe, brake.size, elements, across or elements_across(shoe, elements))
        posed.append(_SolidShoe(loaded, solid))
    return posed


def deck(
    brake: Brake, loaded: Loaded, solid: Solid, setting: DeckSetting, name: str = "shoe"
) -> str:
    """The text of the deck of half a shoe, in the brake's frame.

    Parameters
    ----------
    brake : the brake
    loaded : the shoe
    solid : its mesh
    setting : of the deck
    name : of the deck's file, without ending

    Raises
    ------
    BadInput
        for a clearance
    """
    shoe = loaded.shoe
    check_fit(brake, loaded)
    # Cells keep the node numbers of drumlin's mesh, some of which are then unused.
    x = solid.basis.doflocs
    points = np.column_stack([shoe.frame.to_brake(x[:2].T), x[2]]) * MM
    cells = orient_cells(points, serendipity_cells(solid.basis.element_dofs))
    used = np.unique(cells)
    held = np.intersect1d(hinge_nodes(solid, shoe), used)
    grid = _deck_grid(loaded, points, cells, held)
    drum_mesh = mesh_drum(brake, loaded, FirstLabels(grid.turn + 1, len(cells) + 1))
    # The mid-plane stays plane. A rigid shoe holds the back of its lining in this direction, too.
    mid_plane = np.intersect1d(solid.node[solid.node[:, 0] >= 0, 0], used)
    bonded = held if shoe.body is None else held[:0]
    face = friction_face(solid, shoe, brake.size).nodes
    lines = [
        *header_lines(brake, loaded, setting, name),
        "** half of the shoe, z >= 0: what is called thickness above is that half",
        *_shoe_lines(shoe, solid, points, grid),
        *drum_mesh.lines,
        *_material_lines(shoe),
        *contact_lines(brake, loaded, setting, _face_lines(cells, face), "S1"),
        *hinge_lines(loaded, grid),
        "*BOUNDARY",
        *(f"{i + 1}, 3, 3" for i in np.union1d(mid_plane, bonded)),
        "NDRUM, 3, 3",
        *step_lines(brake, setting, grid, drum_mesh.xy, _load_lines(loaded, solid, setting, grid)),
    ]
    return "\n".join(lines) + "\n"


def _deck_grid(loaded: Loaded, points: Floats, cells: Ints, held: Ints) -> DeckGrid:
    """The mesh of half a shoe as CalculiX has it.

    Parameters
    ----------
    loaded : the shoe
    points : nodes (n, 3) [mm]
    cells : nodes (m, 20) of each cell
    held : nodes of the hinge
    """
    return DeckGrid(
        xy=points[:, :2],
        cells=cells,
        corners=8,
        kind="C3D20R",
        edges={"hinge": held},
        pin=len(points) + 1,
        turn=len(points) + 2,
        bearing=len(cells) + len(drum_angles(loaded)) // 2 + 1,
    )


def _shoe_lines(shoe: Shoe, solid: Solid, points: Floats, grid: DeckGrid) -> list[str]:
    """The lines of a deck for the nodes (n, 3) [mm] and the elements of half a shoe."""
    pin = [*(shoe.pin.xy * MM), 0.0]
    lines = ["*NODE, NSET=NSHOE"]
    used = np.unique(grid.cells)
    lines += map(_node_line, used + 1, points[used])
    lines += ["*NODE, NSET=PIN", _node_line(grid.pin, pin)]
    lines += ["** its displacement x is the turn [rad] of the shoe about the pin"]
    lines += ["*NODE, NSET=TURN", _node_line(grid.turn, pin)]
    for part, members in solid.mesh.subdomains.items():
        lines.append(f"*ELEMENT, TYPE={grid.kind}, ELSET={part.upper()}")
        for i in np.sort(members):
            lines += _element_lines(i + 1, grid.cells[i] + 1)
    return lines


def _material_lines(shoe: Shoe) -> list[str]:
    """The lines of a deck for the materials of a shoe and of the drum."""
    moduli = {}
    for part, (material, _) in materials_of_parts(shoe).items():
        # `why_not` refuses orthotropic materials.
        assert isinstance(material, Material)
        moduli[part.upper()] = material.E, material.nu
    moduli["DRUM"] = DRUM_MODULUS * shoe.lining.material.E_through, 0.0
    lines = []
    for part, (E, nu) in moduli.items():
        lines += [f"*MATERIAL, NAME={part}", "*ELASTIC", f"{E * MPA:.12e}, {nu:.12e}"]
        lines += [f"*SOLID SECTION, ELSET={part}, MATERIAL={part}"]
    return lines


def _node_line(label: int, at: Floats | list[float]) -> str:
    """The line of a deck for a node (3,) [mm]."""
    return f"{label}, {at[0]:.12e}, {at[1]:.12e}, {at[2]:.12e}"


def _element_lines(label: int, nodes: Ints) -> list[str]:
    """The two lines of a deck for an element: a line holds at most 16 entries."""
    return [", ".join(map(str, [label, *nodes[:10]])) + ",", ", ".join(map(str, nodes[10:]))]


def _face_lines(cells: Ints, on: Ints) -> list[str]:
    """The lines "element, S<face>" of the faces whose four corners are all among the nodes `on`."""
    inside = np.isin(cells[:, :8], on)
    lines = []
    for k, corners in enumerate(FACES):
        whole = np.flatnonzero(inside[:, corners].all(axis=1))
        lines += [f"{i + 1}, S{k + 1}" for i in whole]
    return lines


def _load_lines(loaded: Loaded, solid: Solid, setting: DeckSetting, grid: DeckGrid) -> list[str]:
    """The lines of the actuation: nodal forces on the end face, or force and couple on the pin."""
    if "actuation" not in solid.section.boundaries:
        return pin_load_lines(loaded, setting, grid)
    unit, _ = end_forces(solid)
    nodal = (unit @ np.array([*loaded.force, loaded.couple]))[:, :2]
    forces = setting.thickness * loaded.shoe.frame.to_brake(_without_middles(solid, nodal))
    return nodal_load_lines(forces, np.flatnonzero(forces.any(axis=1)))


def _without_middles(solid: Solid, forces: Floats) -> Floats:
    """Nodal forces (n, 2) moved from the middles of faces to the other nodes of the faces.

    In the middle of a face a quadratic displacement is -1/4 of those at the corners plus 1/2 of
    those at the edges.
    """
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
            # Two cells share a face: its force is moved once.
            node = int(dofs[middle, cell])
            if node not in done:
                done.add(node)
                moved[dofs[corners, cell]] -= forces[node] / 4
                moved[dofs[edges, cell]] += forces[node] / 2
                moved[node] = 0.0
    return moved


class _Row(NamedTuple):
    """A row of the drum's nodes: its radius [m], its angles (k,) [rad], and its place z [m]."""

    radius: float
    theta: Floats
    z: float

    @property
    def xyz(self) -> Floats:
        """The nodes (k, 3) [m]."""
        r, t = self.radius, self.theta
        return np.column_stack([r * np.cos(t), r * np.sin(t), np.full(len(t), self.z)])


def mesh_drum(brake: Brake, loaded: Loaded, first: FirstLabels) -> DrumMesh:
    """The mesh of the drum: one element over half the width of the lining and a little more.

    The face S1 of the elements lies on the friction surface. The nodes of the friction surface come
    first: the nodes at z = 0, in the middle and on the outer side.
    """
    shoe, R = loaded.shoe, brake.size
    theta = drum_angles(loaded)
    ends = theta[::2]
    back = R * (1 + shoe.sign * DRUM_LAYER)
    outer = DRUM_WIDTH * shoe.lining.width / 2
    rows = [
        _Row(R, theta, 0.0),
        _Row(R, ends, outer / 2),
        _Row(R, theta, outer),
        _Row(back, theta, 0.0),
        _Row(back, ends, outer / 2),
        _Row(back, theta, outer),
        _Row((R + back) / 2, ends, 0.0),
        _Row((R + back) / 2, ends, outer),
    ]
    xyz = np.concatenate([row.xyz for row in rows]) * MM
    lines = ["*NODE, NSET=NDRUM"]
    lines += map(_node_line, count(first.node), xyz)
    lines.append("*ELEMENT, TYPE=C3D20, ELSET=DRUM")
    labels = first.node + np.cumsum([0, *(len(row.theta) for row in rows)])
    for k in range(len(ends) - 1):
        nodes = _drum_cell(labels[:-1].tolist(), k, shoe.sign)
        lines += _element_lines(first.element + k, nodes)
    return DrumMesh(lines, xyz[:, :2])


def _drum_cell(labels: list[int], k: int, sign: int) -> Ints:
    """The nodes (20,) of element k of the drum.

    Parameters
    ----------
    labels : of the first node of each row, in the order of the rows in `mesh_drum`
    k : number of the element along the arc
    sign : of the shoe
    """
    # Rows on the friction face (f), on the back (b) and between both (m): at z = 0 (0), in the
    # middle of the width (m) and at the outer side (1).
    f0, fm, f1, b0, bm, b1, m0, m1 = labels
    i = 2 * k
    front = np.array([f0 + i, f0 + i + 2, f1 + i + 2, f1 + i])
    front_edges = np.array([f0 + i + 1, fm + k + 1, f1 + i + 1, fm + k])
    behind = np.array([b0 + i, b0 + i + 2, b1 + i + 2, b1 + i])
    behind_edges = np.array([b0 + i + 1, bm + k + 1, b1 + i + 1, bm + k])
    between = np.array([m0 + k, m0 + k + 1, m1 + k + 1, m1 + k])
    # From the friction face to the back, in the order that gives the element a positive volume.
    corners = [0, 1, 2, 3] if sign > 0 else [0, 3, 2, 1]
    edges = [0, 1, 2, 3] if sign > 0 else [3, 2, 1, 0]
    return np.concatenate(
        [front[corners], behind[corners], front_edges[edges], behind_edges[edges], between[corners]]
    )


def along(loaded: Loaded, forces: Floats) -> Floats:
    """The nodal forces (n, 2) on the drum's arc, summed over the width from all nodes of the drum.

    The sums are the nodal forces of a quadratic line.
    """
    count = len(drum_angles(loaded))
    ends = (count + 1) // 2
    total = forces[:count] + forces[count + ends : 2 * count + ends]
    total[::2] += forces[count : count + ends]
    return total
