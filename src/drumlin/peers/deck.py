"""A shoe against its drum as an input deck for CalculiX, from drumlin's own mesh; units mm, N, MPa.

Plane stress elements of one small thickness (CPS8 or CPS6; thick ones are not quite in plane stress
there), every stiffness and force in proportion to it: what is wider than the lining is stiffer
instead. The hinge's line turns about the pin by linear equations; the drum is an arc of elements
whose nodes are all moved, reaching past the lining's ends; contact is face to face by a penalty,
with friction.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake
from drumlin.brake.fields import Material, Orthotropic
from drumlin.fem.equilibrium.group import gap_at
from drumlin.fem.mesh.abaqus import TYPE_OF_CELL
from drumlin.fem.mesh.arc import kind_of
from drumlin.fem.mesh.edges import edge_nodes
from drumlin.fem.preparation.meshes import materials_of
from drumlin.fem.substructure.elasticity import layers_of
from drumlin.fem.substructure.interface import end_loads
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

    `rotation` [rad] of the drum; `thickness` of all elements, of the lining's width; `penalty` and
    `stick`: contact and stick stiffness as multiples of E/t of the lining; `steps`: least number of
    increments; `accuracy`: CalculiX's relative tolerance of forces.
    """

    rotation: float = 1e-3
    thickness: float = 0.01
    penalty: float = 1e3
    stick: float = 1e3
    steps: int = 1
    accuracy: float = 1e-5


class Grid(NamedTuple):
    """A shoe's mesh as CalculiX has it: nodes `xy` (n, 2) [mm], `cells` (m, k) of them, corners
    first, and the nodes of the edges of each boundary. Labels count from 1; nodes `pin` and `turn`
    come after those of the mesh, then the drum's; elements of the drum and of the `bearing` after
    the shoe's.
    """

    xy: Floats
    cells: Ints
    corners: int
    kind: str
    edges: Mapping[str, Ints]
    pin: int
    turn: int
    bearing: int


def deck(brake: Brake, loaded: Loaded, setting: Setting, name: str = "shoe") -> str:
    """The deck of one shoe, in the brake's frame. Raises BadInput for linear elements and for a
    clearance.
    """
    shoe, parts = loaded.shoe, loaded.parts
    if np.any(gap_at(parts.line.xy, parts.line.phi, brake, shoe)):
        raise BadInput(
            f"shoe {shoe.name!r}: lining.clearance: CalculiX gets linings that fit the drum; must be 0"
        )
    grid = _grid(loaded)
    drum_lines, drum_xy = drum(brake, loaded, (grid.turn + 1, len(grid.cells) + 1))
    lines = [
        *header(brake, loaded, setting, name),
        *_shoe(loaded, grid),
        *drum_lines,
        *_sections(loaded, setting),
        *contact(
            brake,
            loaded,
            setting,
            faces(grid.cells, grid.edges["contact"], grid.corners),
            "S1" if shoe.sign > 0 else "S3",
        ),
        *hinge(loaded, grid),
        *step(brake, setting, grid, drum_xy, _load(loaded, setting, grid)),
    ]
    return "\n".join(lines) + "\n"


def _grid(loaded: Loaded) -> Grid:
    shoe, parts = loaded.shoe, loaded.parts
    cell = kind_of(parts.mesh).cell
    if cell not in CELLS:
        raise BadInput("--kind: CalculiX gets quadratic elements only; allowed: quad2, tri2")
    kind, corners = CELLS[cell]
    xy = shoe.frame.to_brake(parts.basis.doflocs.T) * MM
    cells = counter_clockwise(xy, parts.basis.element_dofs.T[:, : 2 * corners], corners)
    edges = {
        name: edge_nodes(parts.basis, facets) for name, facets in parts.mesh.boundaries.items()
    }
    bearing = len(cells) + len(drum_angles(loaded)) // 2 + 1
    return Grid(xy, cells, corners, TYPE_OF_CELL[kind], edges, len(xy) + 1, len(xy) + 2, bearing)


def _shoe(loaded: Loaded, grid: Grid) -> list[str]:
    hinge = loaded.shoe.pin.xy * MM
    lines = ["*NODE, NSET=NSHOE"]
    lines += [_node(i + 1, grid.xy[i]) for i in np.unique(grid.cells)]
    lines += ["*NODE, NSET=PIN", _node(grid.pin, hinge)]
    lines += ["** its displacement x is the turn [rad] of the shoe about the pin"]
    lines += ["*NODE, NSET=TURN", _node(grid.turn, hinge)]
    for part, members in loaded.parts.mesh.subdomains.items():
        lines.append(f"*ELEMENT, TYPE={grid.kind}, ELSET={part.upper()}")
        lines += [", ".join(map(str, [i + 1, *(grid.cells[i] + 1)])) for i in np.sort(members)]
    return lines


def _node(label: int, xy: Floats) -> str:
    return f"{label}, {xy[0]:.12e}, {xy[1]:.12e}, 0."


def _sections(loaded: Loaded, setting: Setting) -> list[str]:
    """Materials and thickness; what is wider than the lining is stiffer instead."""
    lining = loaded.shoe.lining
    thickness = setting.thickness * lining.width * MM
    parts = materials_of(loaded.shoe) | {
        "drum": (Material(E=SOFT * lining.material.E_through, nu=0.0), lining.width)
    }
    layers, lines = layers_of(loaded.shoe), []
    for part, (material, width) in parts.items():
        name, times = part.upper(), width / lining.width
        section = f"*SOLID SECTION, ELSET={name}, MATERIAL={name}"
        lines.append(f"*MATERIAL, NAME={name}")
        if isinstance(material, Material):
            lines += ["*ELASTIC", f"{material.E * times * MPA:.12e}, {material.nu:.12e}"]
        else:
            along = layers[part].along
            lines += _engineering_constants(material, times)
            lines += _orientation(
                f"O{name}", None if along is None else loaded.shoe.frame.to_brake(along)
            )
            section += f", ORIENTATION=O{name}"
        lines += [section, f"{thickness:.12e}"]
    return lines


def _engineering_constants(material: Orthotropic, times: float) -> list[str]:
    """The nine constants of an orthotropic material, moduli so many times as large.

    CalculiX's directions 1, 2, 3 are through, along and across the layer, as in its cylindrical
    systems. Those across do not matter in plane stress; a file without them gets a material that
    does not contract across.
    """
    along, through = material.E_along, material.E_through
    E = [through, along, material.E_across or along]
    nu = [
        material.nu_along_through * through / along,
        material.nu_through_across or 0.0,
        material.nu_along_across or 0.0,
    ]
    shear = material.G_along_through
    G = [shear, material.G_through_across or shear, material.G_along_across or shear]
    moduli = [times * MPA * value for value in (*E, *G)]
    values = [f"{value:.12e}" for value in (*moduli[:3], *nu, *moduli[3:])]
    return ["*ELASTIC, TYPE=ENGINEERING CONSTANTS", ", ".join(values[:8]) + ",", values[8]]


def _orientation(name: str, along: Floats | None) -> list[str]:
    """The directions through, along and across a layer; along (2,): in the brake's frame, None
    around its centre."""
    if along is None:
        return [f"*ORIENTATION, NAME={name}, SYSTEM=CYLINDRICAL", "0., 0., 0., 0., 0., 1."]
    x, y = along
    return [
        f"*ORIENTATION, NAME={name}, SYSTEM=RECTANGULAR",
        f"{y:.12e}, {-x:.12e}, 0., {x:.12e}, {y:.12e}, 0.",
    ]


def contact(
    brake: Brake, loaded: Loaded, setting: Setting, slave: list[str], master: str
) -> list[str]:
    """Contact of the lining's faces `slave` (lines "element, face") with the face `master` of the
    drum's elements.
    """
    lining = loaded.shoe.lining
    unit = lining.material.E_through * MPA / (lining.thickness * MM)
    return [
        "*SURFACE, NAME=SLINING, TYPE=ELEMENT",
        *slave,
        "*SURFACE, NAME=SDRUM, TYPE=ELEMENT",
        f"DRUM, {master}",
        "*SURFACE INTERACTION, NAME=SLIDING",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
        f"{setting.penalty * unit:.12e}",
        "*FRICTION",
        f"{brake.friction:.12e}, {setting.stick * unit:.12e}",
        "*CONTACT PAIR, INTERACTION=SLIDING, TYPE=SURFACE TO SURFACE",
        "SLINING, SDRUM",
    ]


def hinge(loaded: Loaded, grid: Grid) -> list[str]:
    """The hinge's nodes move as a rigid line with the pin's node and the turn; stiff springs bear
    the pin, since CalculiX prints no reaction of a node that equations tie.
    """
    lines = ["** the hinge's line turns about the pin", "*EQUATION"]
    for i in np.unique(grid.edges["hinge"]):
        x, y = grid.xy[i] - loaded.shoe.pin.xy * MM
        lines += ["3", f"{i + 1}, 1, 1., {grid.pin}, 1, -1., {grid.turn}, 1, {y:.12e}"]
        lines += ["3", f"{i + 1}, 2, 1., {grid.pin}, 2, -1., {grid.turn}, 1, {-x:.12e}"]
    lines.append("** the pin's bearing: its force on the shoe is that of these springs")
    for c, axis in enumerate("XY"):
        lines += [f"*ELEMENT, TYPE=SPRING1, ELSET=BEARING{axis}", f"{grid.bearing + c}, {grid.pin}"]
    for c, axis in enumerate("XY", start=1):
        lines += [f"*SPRING, ELSET=BEARING{axis}", f"{c}", f"{BEARING:.12e}"]
    return [*lines, "*BOUNDARY", f"{grid.pin}, 3, 3"]


def step(brake: Brake, setting: Setting, grid: Grid, drum_xy: Floats, load: list[str]) -> list[str]:
    """Load (lines of nodal forces) and rotation together, and what is printed; the drum's nodes are
    at (n, 2) [mm].
    """
    lines = [
        "*STEP, INC=1000",
        "*STATIC",
        f"{1 / setting.steps:.12e}, 1.",
        "*CONTROLS, PARAMETERS=FIELD",
    ]
    lines += [f"{setting.accuracy:.12e}, {setting.accuracy:.12e}", "*CLOAD", *load]
    angle = brake.spin * setting.rotation
    lines.append("*BOUNDARY")
    for label, (x, y) in enumerate(
        angle * drum_xy @ np.array([[0, 1], [-1, 0]]), start=grid.turn + 1
    ):
        lines += [f"{label}, 1, 1, {x:.12e}", f"{label}, 2, 2, {y:.12e}"]
    for nodes, value in (("PIN", "U"), ("TURN", "U"), ("NDRUM", "RF")):
        lines += [f"*NODE PRINT, NSET={nodes}, FREQUENCY=1000", value]
    lines += ["*CONTACT PRINT, SLAVE=SLINING, MASTER=SDRUM, FREQUENCY=1000", "CF, CSTR"]
    return [*lines, "*CONTACT FILE, FREQUENCY=1000", "CDIS, CSTR", "*END STEP"]


def _load(loaded: Loaded, setting: Setting, grid: Grid) -> list[str]:
    """The actuation, as nodal forces of drumlin's traction on the loaded end, or on the rigid shoe
    itself.
    """
    shoe, parts, size = loaded.shoe, loaded.parts, setting.thickness
    if "actuation" in grid.edges:
        unit, _ = end_loads(parts.basis, parts.mesh.boundaries["actuation"])
        nodal = (unit @ np.array([*loaded.force, loaded.couple])).reshape(-1, 2)
        forces = size * shoe.frame.to_brake(nodal)
        return [
            f"{i + 1}, {c + 1}, {forces[i, c]:.12e}"
            for i in np.unique(grid.edges["actuation"])
            for c in range(2)
        ]
    force, couple = (
        size * shoe.frame.to_brake(loaded.force),
        size * shoe.frame.sense * loaded.couple * MM,
    )
    lines = [f"{grid.pin}, {c + 1}, {force[c]:.12e}" for c in range(2)]
    return [*lines, f"{grid.turn}, 1, {couple:.12e}"]


def header(brake: Brake, loaded: Loaded, setting: Setting, name: str) -> list[str]:
    """Comment lines: what it is, how to run it, how to read it."""
    title, shoe = (" ".join(text.split())[:80] for text in (brake.title, loaded.shoe.name))
    return [
        f"** {title}",
        f"** shoe {shoe!r}, drum turns {brake.direction}, friction {brake.friction:g}",
        "** units: mm, N, MPa; written by drumlin from its own mesh",
        f"** run: ccx {name}     results: {name}.dat",
        f"** thickness, stiffness across it and force are {setting.thickness:g} of the brake's",
        f"** the drum turns by {setting.rotation:g} rad along its tangents: small displacements",
    ]


def counter_clockwise(xy: Floats, cells: Ints, corners: int) -> Ints:
    """Cells (m, 2 corners) of nodes xy (n, 2), corners first, each turned so that it runs
    counter-clockwise.
    """
    x, y = xy[cells[:, :corners]].transpose(2, 0, 1)
    area = (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)
    back = [0, *range(corners - 1, 0, -1)]
    middles = [corners + i for i in range(corners - 1, -1, -1)]
    return np.where((area > 0)[:, None], cells, cells[:, back + middles])


def faces(cells: Ints, along: Ints, corners: int) -> list[str]:
    """Lines "element, S<face>" of the edges `along` (3, m) (nodes from end to end); faces run
    between corners.
    """
    wanted = {tuple(sorted(ends)) for ends in along[[0, -1]].T.tolist()}
    lines = []
    for number, row in enumerate(cells[:, :corners].tolist(), start=1):
        for face in range(corners):
            if tuple(sorted((row[face], row[(face + 1) % corners]))) in wanted:
                lines.append(f"{number}, S{face + 1}")
    return lines


def drum_angles(loaded: Loaded) -> Floats:
    """Angles theta of the nodes of the drum's arc [rad]: those of the lining, so that no gap is
    left between their edges, and a few elements beyond its ends.
    """
    theta = np.sort(loaded.shoe.frame.theta(loaded.parts.line.phi))
    beyond = min(BEYOND, 0.49 * (2 * math.pi - np.ptp(theta)))  # the ends of the arc must not meet
    more = np.linspace(0.0, beyond, 2 * BEYOND_ELEMENTS + 1)[1:]
    return np.concatenate([theta[0] - more[::-1], theta, theta[-1] + more])


def drum(brake: Brake, loaded: Loaded, first: tuple[int, int]) -> tuple[list[str], Floats]:
    """Lines of the drum's nodes and elements, numbered from `first` (node, element), and its nodes
    (n, 2) [mm].

    One layer of CPS8 along the arc; their face S1 (of an internal shoe) or S3 lies on the friction
    surface.
    """
    shoe, R = loaded.shoe, brake.size
    theta = drum_angles(loaded)
    count = len(theta) // 2
    inner, outer = (R, R * (1 + DRUM_LAYER)) if shoe.sign > 0 else (R * (1 - DRUM_LAYER), R)
    # rows of nodes: inner arc, middle (every other), outer arc
    rows = [(inner, theta), ((inner + outer) / 2, theta[::2]), (outer, theta)]
    xy = np.concatenate([r * np.column_stack([np.cos(t), np.sin(t)]) for r, t in rows]) * MM
    node, element = first
    a, b, c = (node + np.cumsum([0, len(theta), count + 1])).tolist()
    lines = ["*NODE, NSET=NDRUM"]
    lines += [_node(label, at) for label, at in enumerate(xy, start=node)]
    lines.append("*ELEMENT, TYPE=CPS8, ELSET=DRUM")
    for k in range(count):
        i = 2 * k
        # counter-clockwise: along the inner arc backwards, out, along the outer arc forwards
        nodes = [a + i + 2, a + i, c + i, c + i + 2, a + i + 1, b + k, c + i + 1, b + k + 1]
        lines.append(", ".join(map(str, [element + k, *nodes])))
    return lines, xy
