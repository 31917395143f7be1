"""Half a solid shoe against its drum as an input deck for CalculiX, from drumlin's own mesh; units
mm, N, MPa.

Hexahedra with 20 nodes and reduced integration (C3D20R): drumlin's without the nodes in the middle
of faces and cells. The mid-plane is held along z, forces are half the brake's; all else is as in
the plane deck.
"""

from functools import partial
from pathlib import Path

import numpy as np
import skfem

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import BadInput
from drumlin.base.files import write_text
from drumlin.brake.brake import Brake
from drumlin.brake.fields import Material
from drumlin.fem.equilibrium.state import gap_at
from drumlin.fem.preparation.meshes import materials_of
from drumlin.fem.solid.body import end_forces, face_of, hinged
from drumlin.fem.solid.fields import oriented, serendipity
from drumlin.fem.solid.mesh import Solid, solid_mesh
from drumlin.fem.solid.model import ELEMENTS, across_of, why_not
from drumlin.peers import calculix
from drumlin.peers.deck import (
    DRUM_LAYER,
    MM,
    MPA,
    SOFT,
    Grid,
    Setting,
    contact,
    drum_angles,
    header,
    hinge,
    step,
)  # fmt: skip
from drumlin.peers.peer import Loaded, Peer, brake_response, loaded_shoes, untouched_response

ROTATION = 4e-3
"""Of the drum [rad]. Friction has the direction of the slip: as it is pressed the lining widens,
and what it creeps sideways, some ten micrometres, must be little beside the way of the drum.
"""
HALF = 0.5  # of the shoe, which stands in the place of a thin layer's thickness
FACES = [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)]
WIDER = 1.1  # the drum, of half the lining's width


def export(
    brake: Brake, folder: Path, stem: str, *, elements: int = ELEMENTS, across: int | None = None
) -> tuple[list[Path], list[str]]:
    """Write the decks of a brake's solid shoes, one for each; as peers.calculix.export does."""
    paths, apart = [], []
    for loaded, solid in _posed(brake, elements, across):
        if not loaded.approaches:
            apart.append(loaded.shoe.name)
            continue
        path = folder / f"{stem}_{loaded.shoe.name}_solid.inp".replace(" ", "_")
        write_text(
            path, deck(brake, loaded, solid, Setting(rotation=ROTATION, thickness=HALF), path.stem)
        )
        paths.append(path)
    return paths, apart


def solve(
    brake: Brake,
    *,
    elements: int = ELEMENTS,
    across: int | None = None,
    setting: Setting | None = None,
) -> Peer:
    """A brake's solid shoes by CalculiX; options and what is raised as of peers.calculix.solve."""
    installed = calculix.version()
    answers, iterations, unknowns, seconds = [], 0, 0, 0.0
    for loaded, solid in _posed(brake, elements, across):
        if not loaded.approaches:
            answers.append(untouched_response(loaded))
            continue
        pose = calculix.Posed(partial(deck, brake, loaded, solid), partial(along, loaded))
        start = (setting or Setting(rotation=ROTATION))._replace(thickness=HALF)
        state, _ = calculix.slipping(brake, loaded, start, pose)
        answers.append(calculix.response(loaded, state))
        iterations = max(iterations, state.iterations)
        unknowns += state.unknowns
        seconds += state.seconds
    response = brake_response("calculix", answers, iterations, {"calculix": seconds})
    notes = (f"CalculiX {installed}, C3D20R, face-to-face penalty",)
    return Peer("calculix", installed, response, seconds, seconds, seconds, unknowns, notes)


def _posed(brake: Brake, elements: int, across: int | None) -> list[tuple[Loaded, Solid]]:
    reason = why_not(brake)
    if reason is not None:
        raise BadInput(f"solid does not apply to this brake: {reason}")
    posed = []
    for loaded in loaded_shoes(brake, elements):
        shoe = loaded.shoe
        solid = solid_mesh(shoe, brake.size, elements, across or across_of(shoe, elements))
        posed.append((loaded, solid))
    return posed


def deck(brake: Brake, loaded: Loaded, solid: Solid, setting: Setting, name: str = "shoe") -> str:
    """The deck of half a shoe, in the brake's frame. Raises BadInput for a clearance."""
    shoe, parts = loaded.shoe, loaded.parts
    if np.any(gap_at(parts.line.xy, parts.line.phi, brake, shoe)):
        raise BadInput(
            f"shoe {shoe.name!r}: lining.clearance: CalculiX gets linings that fit the drum; must be 0"
        )
    x = solid.basis.doflocs
    points = np.column_stack([shoe.frame.to_brake(x[:2].T), x[2]]) * MM
    cells = oriented(points, serendipity(solid.basis.element_dofs))
    used = np.unique(cells)
    held = np.intersect1d(hinged(solid, shoe), used)
    count = len(points)
    drum_lines, drum_xy = drum(brake, loaded, (count + 3, len(cells) + 1))
    grid = Grid(points[:, :2], cells, 8, "C3D20R", {"hinge": held}, count + 1, count + 2,
                len(cells) + len(drum_angles(loaded)) // 2 + 1)  # fmt: skip
    flat = np.intersect1d(solid.node[solid.node[:, 0] >= 0, 0], used)
    bonded = held if shoe.body is None else held[:0]
    lines = [
        *header(brake, loaded, setting, name),
        "** half of the shoe, z >= 0: what is called thickness above is that half",
        "*NODE, NSET=NSHOE",
        *(_node(i + 1, points[i]) for i in used),
        "*NODE, NSET=PIN",
        _node(grid.pin, [*(shoe.pin.xy * MM), 0.0]),
        "** its displacement x is the turn [rad] of the shoe about the pin",
        "*NODE, NSET=TURN",
        _node(grid.turn, [*(shoe.pin.xy * MM), 0.0]),
    ]
    for part, members in solid.mesh.subdomains.items():
        lines.append(f"*ELEMENT, TYPE=C3D20R, ELSET={part.upper()}")
        lines += [line for i in np.sort(members) for line in _element(i + 1, cells[i] + 1)]
    lines += drum_lines
    moduli = {}
    for part, (material, _) in materials_of(shoe).items():
        assert isinstance(material, Material)  # why_not
        moduli[part.upper()] = material.E, material.nu
    moduli["DRUM"] = SOFT * shoe.lining.material.E_through, 0.0
    for part, (E, nu) in moduli.items():
        lines += [f"*MATERIAL, NAME={part}", "*ELASTIC", f"{E * MPA:.12e}, {nu:.12e}"]
        lines += [f"*SOLID SECTION, ELSET={part}, MATERIAL={part}"]
    face = face_of(solid, shoe, brake.size).nodes
    lines += contact(brake, loaded, setting, _faces(cells, face), "S1")
    lines += hinge(loaded, grid)
    lines += ["*BOUNDARY", *(f"{i + 1}, 3, 3" for i in np.union1d(flat, bonded)), "NDRUM, 3, 3"]
    lines += step(brake, setting, grid, drum_xy, _load(loaded, solid, setting, grid))
    return "\n".join(lines) + "\n"


def _node(label: int, at: Floats | list[float]) -> str:
    return f"{label}, {at[0]:.12e}, {at[1]:.12e}, {at[2]:.12e}"


def _element(label: int, nodes: Ints) -> list[str]:
    """Two lines: one holds at most 16 entries."""
    return [", ".join(map(str, [label, *nodes[:10]])) + ",", ", ".join(map(str, nodes[10:]))]


def _faces(cells: Ints, on: Ints) -> list[str]:
    """Lines "element, S<face>" of the faces whose four corners are all among the nodes `on`."""
    inside = np.isin(cells[:, :8], on)
    return [
        f"{i + 1}, S{k + 1}"
        for k, corners in enumerate(FACES)
        for i in np.flatnonzero(inside[:, corners].all(axis=1))
    ]


def _load(loaded: Loaded, solid: Solid, setting: Setting, grid: Grid) -> list[str]:
    """The actuation on the end face, moved from the middles of its faces to their other nodes; or
    on the pin.
    """
    shoe, size = loaded.shoe, setting.thickness
    if "actuation" in solid.section.boundaries:
        unit, _ = end_forces(solid)
        nodal = (unit @ np.array([*loaded.force, loaded.couple]))[:, :2]
        forces = size * shoe.frame.to_brake(_without_middles(solid, nodal))
        return [
            f"{i + 1}, {c + 1}, {forces[i, c]:.12e}"
            for i in np.flatnonzero(forces.any(axis=1))
            for c in range(2)
        ]
    force, couple = (
        size * shoe.frame.to_brake(loaded.force),
        size * shoe.frame.sense * loaded.couple * MM,
    )
    return [f"{grid.pin}, {c + 1}, {force[c]:.12e}" for c in range(2)] + [
        f"{grid.turn}, 1, {couple:.12e}"
    ]


def _without_middles(solid: Solid, forces: Floats) -> Floats:
    """Nodal forces (n, 2) without those on middles of faces: a quadratic displacement is -1/4 of
    that of the corners and 1/2 of that of the edges there.
    """
    at, dofs = skfem.ElementHex2.doflocs, solid.basis.element_dofs
    moved, done = forces.copy(), set[int]()
    for middle in np.flatnonzero((at == 0.5).sum(axis=1) == 2):
        axis = int(np.flatnonzero(at[middle] != 0.5)[0])
        side = (at[:, axis] == at[middle, axis]) & (np.arange(27) != middle)
        edges = side & ((at == 0.5).sum(axis=1) == 1)
        corners = side & ((at == 0.5).sum(axis=1) == 0)
        for cell in np.flatnonzero(forces[dofs[middle]].any(axis=1)):
            node = int(dofs[middle, cell])
            if node not in done:
                done.add(node)
                moved[dofs[corners, cell]] -= forces[node] / 4
                moved[dofs[edges, cell]] += forces[node] / 2
                moved[node] = 0.0
    return moved


def drum(brake: Brake, loaded: Loaded, first: tuple[int, int]) -> tuple[list[str], Floats]:
    """Lines of the drum's nodes and elements, numbered from `first` (node, element), and its nodes
    (n, 2) [mm].

    One element over half the width and a little more; its face S1 lies on the friction surface,
    whose nodes come first: those of z = 0, of the middle and of the outer side.
    """
    shoe, R = loaded.shoe, brake.size
    theta = drum_angles(loaded)
    back = R * (1 + shoe.sign * DRUM_LAYER)
    outer = WIDER * shoe.lining.width / 2
    ends = theta[::2]
    rows = [(R, theta, 0.0), (R, ends, outer / 2), (R, theta, outer), (back, theta, 0.0), (back, ends, outer / 2),
            (back, theta, outer), ((R + back) / 2, ends, 0.0), ((R + back) / 2, ends, outer)]  # fmt: skip
    xyz = (
        np.concatenate(
            [
                np.column_stack([r * np.cos(t), r * np.sin(t), np.full(len(t), z)])
                for r, t, z in rows
            ]
        )
        * MM
    )
    begins = first[0] + np.cumsum([0, *(len(t) for _, t, _ in rows)])
    f0, fm, f1, b0, bm, b1, m0, m1 = (int(i) for i in begins[:-1])
    lines = [
        "*NODE, NSET=NDRUM",
        *(_node(label, at) for label, at in enumerate(xyz, start=first[0])),
    ]
    lines.append("*ELEMENT, TYPE=C3D20, ELSET=DRUM")
    for k in range(len(ends) - 1):
        i = 2 * k
        front = (
            [f0 + i, f0 + i + 2, f1 + i + 2, f1 + i],
            [f0 + i + 1, fm + k + 1, f1 + i + 1, fm + k],
        )
        behind_ = (
            [b0 + i, b0 + i + 2, b1 + i + 2, b1 + i],
            [b0 + i + 1, bm + k + 1, b1 + i + 1, bm + k],
        )
        between = [m0 + k, m0 + k + 1, m1 + k + 1, m1 + k]
        turn = (
            slice(None) if shoe.sign > 0 else [0, 3, 2, 1]
        )  # from the friction face to the back: a positive volume
        turn_edges = slice(None) if shoe.sign > 0 else [3, 2, 1, 0]
        corners = np.concatenate([np.array(front[0])[turn], np.array(behind_[0])[turn]])
        edges = np.concatenate([np.array(front[1])[turn_edges], np.array(behind_[1])[turn_edges]])
        lines += _element(first[1] + k, np.concatenate([corners, edges, np.array(between)[turn]]))
    return lines, xyz[:, :2]


def along(loaded: Loaded, forces: Floats) -> Floats:
    """Forces (n, 2) on the nodes of the drum's arc, summed over the width; they are those of a
    quadratic line.
    """
    count = len(drum_angles(loaded))
    ends = (count + 1) // 2
    total = forces[:count] + forces[count + ends : 2 * count + ends]
    total[::2] += forces[count : count + ends]
    return total
