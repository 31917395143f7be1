"""A shoe against its drum as an input deck for CalculiX, from drumlin's own mesh; units mm, N, MPa.

Plane stress elements of one small thickness (CPS8 or CPS6; thick ones are not quite in plane stress there), every
stiffness and force in proportion to it: what is wider than the lining is stiffer instead. The hinge's line turns
about the pin by linear equations; the drum is an arc of elements whose nodes are all moved, reaching past the
lining's ends; contact is face to face by a penalty, with friction.
"""

import math
from typing import NamedTuple

import numpy as np

from drumlin.arrays import Floats, Ints
from drumlin.brake import Brake
from drumlin.errors import BadInput
from drumlin.fem.inp import NAMES
from drumlin.fem.interface import edge_nodes
from drumlin.fem.mesh import kind_of
from drumlin.fem.model import gap_at
from drumlin.fem.scene import end_loads, materials_of
from drumlin.peers.peer import Loaded

MM = 1e3  # per m
MPA = 1e-6  # per Pa
CELLS = {"quad9": ("quad8", 4), "triangle6": ("triangle6", 3)}
DRUM_LAYER = 1 / 30  # thickness of the drum's arc of elements, in radii
BEYOND, BEYOND_ELEMENTS = math.radians(3), 2  # at each end of the lining

BEARING = 1e10  # stiffness of the pin's springs [N/mm]
SOFT = 1e-6  # modulus of the drum, of the lining's: all its nodes are prescribed, and their forces are those of contact


class Setting(NamedTuple):
    """How a brake is posed to CalculiX.

    `scale` s: of load and rotation together; `rotation` [rad] of the drum at s = 1; `thickness` of all elements, of the
    lining's width; `penalty` and `stick`: contact and stick stiffness as multiples of E/t of the lining; `steps`: least
    number of increments; `accuracy`: CalculiX's relative tolerance of forces.
    """

    scale: float = 1.0
    rotation: float = 1e-3
    thickness: float = 0.01
    penalty: float = 1e3
    stick: float = 1e3
    steps: int = 1
    accuracy: float = 1e-5


def deck(brake: Brake, loaded: Loaded, setting: Setting, name: str = "shoe") -> str:
    """The deck of one shoe, in the brake's frame. Raises BadInput for linear elements and for a clearance."""
    shoe, parts = loaded.shoe, loaded.parts
    cell = kind_of(parts.mesh).cell
    if cell not in CELLS:
        raise BadInput("--kind: CalculiX gets quadratic elements only; allowed: quad2, tri2")
    if np.any(gap_at(parts.line.xy, parts.line.phi, brake, shoe)):
        raise BadInput(f"shoe {shoe.name!r}: lining.clearance: CalculiX gets linings that fit the drum; must be 0")
    cell, corners = CELLS[cell]
    thick = setting.thickness * shoe.lining.width * MM
    xy = shoe.frame.to_brake(parts.basis.doflocs.T) * MM
    cells = counter_clockwise(xy, parts.basis.element_dofs.T[:, : 2 * corners], corners)
    used = np.unique(cells)
    pin, turn = len(xy) + 1, len(xy) + 2
    edges = {key: edge_nodes(parts.basis, facets) for key, facets in parts.mesh.boundaries.items()}
    lines = [*header(brake, loaded, setting, name), "*NODE, NSET=NSHOE"]
    lines += [f"{i + 1}, {xy[i, 0]:.12e}, {xy[i, 1]:.12e}, 0." for i in used]
    lines += ["*NODE, NSET=PIN", f"{pin}, {shoe.hinge.x * MM:.12e}, {shoe.hinge.y * MM:.12e}, 0."]
    lines += ["** its displacement x is the turn [rad] of the shoe about the pin", "*NODE, NSET=TURN",
              f"{turn}, {shoe.hinge.x * MM:.12e}, {shoe.hinge.y * MM:.12e}, 0."]  # fmt: skip
    for part, members in parts.mesh.subdomains.items():
        lines.append(f"*ELEMENT, TYPE={NAMES[cell]}, ELSET={part.upper()}")
        lines += [", ".join(map(str, [i + 1, *(cells[i] + 1)])) for i in np.sort(members)]
    first = turn + 1, len(cells) + 1
    last = len(cells) + len(drum_angles(loaded)) // 2 + 1
    drum_lines, drum_xy = drum(brake, loaded, setting, first)
    lines += drum_lines
    for part, (material, width) in materials_of(shoe).items():
        E = material.E * width / shoe.lining.width * MPA
        lines += _material(part.upper(), E, material.nu, thick)
    lines += _material("DRUM", SOFT * shoe.lining.material.E * MPA, 0.0, thick)
    lines += ["*SURFACE, NAME=SLINING, TYPE=ELEMENT", *faces(cells, edges["contact"], corners)]
    lines += ["*SURFACE, NAME=SDRUM, TYPE=ELEMENT", f"DRUM, {'S1' if shoe.sign > 0 else 'S3'}"]
    unit = shoe.lining.material.E * MPA / (shoe.lining.thickness * MM)
    lines += [
        "*SURFACE INTERACTION, NAME=SLIDING",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
        f"{setting.penalty * unit:.9e}",
        "*FRICTION",
        f"{brake.friction:.9e}, {setting.stick * unit:.9e}",
        "*CONTACT PAIR, INTERACTION=SLIDING, TYPE=SURFACE TO SURFACE",
        "SLINING, SDRUM",
        "** the hinge's line turns about the pin",
        "*EQUATION",
    ]
    for i in np.unique(edges["hinge"]):
        x, y = xy[i] - shoe.hinge.xy * MM
        lines += ["3", f"{i + 1}, 1, 1., {pin}, 1, -1., {turn}, 1, {y:.12e}"]
        lines += ["3", f"{i + 1}, 2, 1., {pin}, 2, -1., {turn}, 1, {-x:.12e}"]
    lines += ["** its bearing: the force of the pin on the shoe is that of these springs",
              "*ELEMENT, TYPE=SPRING1, ELSET=BEARINGX", f"{last}, {pin}", "*ELEMENT, TYPE=SPRING1, ELSET=BEARINGY",
              f"{last + 1}, {pin}"]  # fmt: skip
    for c, axis in enumerate("XY", start=1):
        lines += [f"*SPRING, ELSET=BEARING{axis}", f"{c}", f"{BEARING:.9e}"]
    lines += ["*BOUNDARY", f"{pin}, 3, 3", f"*STEP, INC={1000}", "*STATIC", f"{1 / setting.steps:.6e}, 1."]
    lines += [
        "*CONTROLS, PARAMETERS=FIELD",
        f"{setting.accuracy:.3e}, {setting.accuracy:.3e}",
        "*CLOAD",
    ]
    size = setting.scale * setting.thickness
    if "actuation" in parts.mesh.boundaries:
        unit_loads, _ = end_loads(parts.basis, parts.mesh.boundaries["actuation"])
        nodal = (unit_loads @ np.array([*loaded.force, loaded.couple])).reshape(-1, 2)
        forces = size * shoe.frame.to_brake(nodal)
        for i in np.unique(edges["actuation"]):
            lines += [f"{i + 1}, {c + 1}, {forces[i, c]:.12e}" for c in range(2)]
    else:  # on the rigid shoe itself
        forces = size * shoe.frame.to_brake(loaded.force)
        lines += [f"{pin}, {c + 1}, {forces[c]:.12e}" for c in range(2)]
        lines.append(f"{turn}, 1, {size * shoe.frame.sense * loaded.couple * MM:.12e}")
    angle = brake.spin * setting.scale * setting.rotation
    moved = np.column_stack([np.cos(angle) * drum_xy[:, 0] - np.sin(angle) * drum_xy[:, 1],
                             np.sin(angle) * drum_xy[:, 0] + np.cos(angle) * drum_xy[:, 1]]) - drum_xy  # fmt: skip
    lines.append("*BOUNDARY")
    for i, (x, y) in enumerate(moved, start=first[0]):
        lines += [f"{i}, 1, 1, {x:.12e}", f"{i}, 2, 2, {y:.12e}"]
    lines += [
        "*NODE PRINT, NSET=PIN, FREQUENCY=1000",
        "U",
        "*NODE PRINT, NSET=TURN, FREQUENCY=1000",
        "U",
        "*NODE PRINT, NSET=NDRUM, TOTALS=YES, FREQUENCY=1000",
        "RF",
        "*CONTACT PRINT, SLAVE=SLINING, MASTER=SDRUM, FREQUENCY=1000",
        "CF, CSTR",
        "*CONTACT FILE, FREQUENCY=1000",
        "CSTR, CDIS",
        "*END STEP",
    ]
    return "\n".join(lines) + "\n"


def header(brake: Brake, loaded: Loaded, setting: Setting, name: str) -> list[str]:
    """Comment lines: what it is, how to run it, how to read it."""
    return [
        f"** {brake.title}, shoe {loaded.shoe.name!r}; drum turns {brake.rotation}, friction {brake.friction:g}",
        "** units: mm, N, MPa; written by drumlin from its own mesh",
        f"** run: ccx {name}     results: {name}.dat",
        f"** thickness, stiffness across it and force are {setting.thickness:g} of the brake's",
        f"** load and drum's rotation ({setting.scale * setting.rotation:g} rad) are scaled by {setting.scale:g};"
        " small displacements are the limit 0",
    ]


def _material(name: str, E: float, nu: float, thickness: float) -> list[str]:
    return [
        f"*MATERIAL, NAME={name}",
        "*ELASTIC",
        f"{E:.12e}, {nu:.9e}",
        f"*SOLID SECTION, ELSET={name}, MATERIAL={name}",
        f"{thickness:.12e}",
    ]


def counter_clockwise(xy: Floats, cells: Ints, corners: int) -> Ints:
    """Cells (m, 2 corners) of nodes xy (n, 2), corners first, each turned so that it runs counter-clockwise."""
    x, y = xy[cells[:, :corners]].transpose(2, 0, 1)
    area = (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)
    back = [0, *range(corners - 1, 0, -1)]
    middles = [corners + i for i in range(corners - 1, -1, -1)]
    return np.where((area > 0)[:, None], cells, cells[:, back + middles])


def faces(cells: Ints, along: Ints, corners: int) -> list[str]:
    """Lines "element, S<face>" of the edges `along` (3, m) (nodes from end to end); faces run between corners."""
    wanted = {tuple(sorted(ends)) for ends in along[[0, -1]].T.tolist()}
    lines = []
    for number, row in enumerate(cells[:, :corners].tolist(), start=1):
        for face in range(corners):
            if tuple(sorted((row[face], row[(face + 1) % corners]))) in wanted:
                lines.append(f"{number}, S{face + 1}")
    return lines


def drum_angles(loaded: Loaded) -> Floats:
    """Angles theta of the nodes of the drum's arc [rad]: those of the lining, so that no gap is left between their
    edges, and a few elements beyond its ends."""
    theta = np.sort(loaded.shoe.frame.theta(loaded.parts.line.phi))
    more = np.linspace(0.0, BEYOND, 2 * BEYOND_ELEMENTS + 1)[1:]
    return np.concatenate([theta[0] - more[::-1], theta, theta[-1] + more])


def drum(brake: Brake, loaded: Loaded, setting: Setting, first: tuple[int, int]) -> tuple[list[str], Floats]:
    """Lines of the drum's nodes and elements, numbered from `first` (node, element), and its nodes (n, 2) [mm].

    One layer of CPS8 along the arc; their face S1 (of an internal shoe) or S3 lies on the friction surface.
    """
    shoe, R = loaded.shoe, brake.drum.radius
    theta = drum_angles(loaded)
    count = len(theta) // 2
    inner, outer = (R, R * (1 + DRUM_LAYER)) if shoe.sign > 0 else (R * (1 - DRUM_LAYER), R)
    # rows of nodes: inner arc, middle (every other), outer arc
    rows = [(inner, theta), ((inner + outer) / 2, theta[::2]), (outer, theta)]
    xy = np.concatenate([r * np.column_stack([np.cos(t), np.sin(t)]) for r, t in rows]) * MM
    node, element = first
    a, b, c = (node + np.cumsum([0, len(theta), count + 1])).tolist()
    lines = ["*NODE, NSET=NDRUM"]
    lines += [f"{i}, {x:.12e}, {y:.12e}, 0." for i, (x, y) in enumerate(xy, start=node)]
    lines.append("*ELEMENT, TYPE=CPS8, ELSET=DRUM")
    for k in range(count):
        i = 2 * k
        # counter-clockwise: along the inner arc backwards, out, along the outer arc forwards
        nodes = [a + i + 2, a + i, c + i, c + i + 2, a + i + 1, b + k, c + i + 1, b + k + 1]
        lines.append(", ".join(map(str, [element + k, *nodes])))
    return lines, xy
