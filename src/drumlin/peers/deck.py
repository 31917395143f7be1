"""A shoe against its drum as an input deck for CalculiX, from drumlin's own mesh; units mm, N, MPa.

All elements are plane stress elements CPS8 or CPS6 of the same small thickness, since thick
elements of CalculiX are not exactly in plane stress. All forces are proportional to this thickness.
A layer that is wider than the lining has a larger modulus in place of a larger thickness.
Multi-point constraints let the nodes at the hinge rotate about the pin as a rigid line. The drum is
an arc of elements that reaches past the lining's ends. The displacements of all nodes of the drum
are prescribed. Contact is face-to-face with a penalty and friction.
"""

import math
from collections.abc import Mapping
from itertools import count as count_from
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake
from drumlin.brake.fields import Material, OrthotropicMaterial
from drumlin.fem.equilibrium.state import unloaded_lining_gaps_at_points
from drumlin.fem.mesh.arc import mesh_kind_of_scikit_fem_mesh
from drumlin.fem.mesh.edges import nodes_along_element_edges
from drumlin.fem.preparation.meshes import materials_and_widths_of_shoe_parts
from drumlin.fem.substructure.elasticity import elastic_layers_of_shoe
from drumlin.fem.substructure.interface import nodal_forces_of_unit_end_loads_and_end_centre
from drumlin.mesh_files.abaqus import ABAQUS_TYPE_OF_MESHIO_CELL
from drumlin.peers.peer import MeshedShoeUnderActuation

MM_PER_METRE = 1e3
"""Millimetres in a metre: the lengths of a deck are in mm."""

MPA_PER_PASCAL = 1e-6
"""Megapascals in a pascal: the stresses of a deck are in MPa."""

DECK_CELL_AND_CORNERS_OF_MESH_CELL = {"quad9": ("quad8", 4), "triangle6": ("triangle6", 3)}
"""For each kind of cell in drumlin's mesh: the kind of cell in a deck, and its corner count."""

DRUM_LAYER_THICKNESS_OVER_RADIUS = 1 / 30
"""Thickness of the drum's arc of elements, relative to the radius of the drum.

The value has no effect on results, since the displacements of all nodes of the drum are
prescribed."""

DRUM_ANGLE_BEYOND_LINING = math.radians(3)
"""Angle [rad] by which the drum's arc reaches past each end of the lining."""

DRUM_ELEMENTS_BEYOND_LINING = 2
"""Number of the drum's elements past each end of the lining."""

PIN_SPRING_STIFFNESS_IN_N_PER_MM = 1e10
"""Stiffness of the springs that support the pin [N/mm].

The hinge reaction is computed from the displacement of the pin. Under 1 kN the pin moves by 1e-7
mm. This is too little to change a result, and CalculiX still prints it with all digits."""

DRUM_MODULUS_OVER_LINING_MODULUS = 1e-6
"""Young's modulus of the drum, relative to Young's modulus of the lining.

The displacements of all nodes of the drum are prescribed. A soft drum adds nearly nothing to the
forces on these nodes, so that they equal the contact forces."""


class CalculixDeckParameters(NamedTuple):
    """The parameters of a CalculiX deck.

    Attributes
    ----------
    rotation : rotation of the drum [rad]
    thickness : thickness of all elements, relative to the lining's width
    penalty : normal contact stiffness, relative to E/t, Young's modulus of the lining divided by
        the thickness of the lining
    tangential_penalty : tangential stiffness of a sticking contact, relative to E/t
    steps : smallest number of increments of the load step
    accuracy : CalculiX's relative tolerance of the residual forces
    """

    rotation: float = 1e-3
    thickness: float = 0.01
    penalty: float = 1e3
    tangential_penalty: float = 1e3
    steps: int = 1
    accuracy: float = 1e-5


class ShoeMeshOfDeck(NamedTuple):
    """A shoe's mesh in the form of a CalculiX deck, in the brake's frame.

    Labels are CalculiX's numbers of nodes and elements, from 1 on. The nodes of the mesh come
    first, then the nodes `pin` and `turn`, then the nodes of the drum. The elements of the drum and
    the springs come after the elements of the shoe.

    Attributes
    ----------
    xy : positions (n, 2) of the nodes [mm]
    cells : numbers (m, k) of the nodes of each cell, from 0 on, corners first
    corners : number of corners of a cell
    kind : CalculiX's name of the element type
    edges : numbers of the nodes on each boundary, by the boundary's name such as "hinge"
    pin : label of the pin's node
    turn : label of a node whose displacement along x is the rotation of the shoe [rad]
    bearing : label of the first of the two springs at the pin
    """

    xy: Floats
    cells: Ints
    corners: int
    kind: str
    edges: Mapping[str, Ints]
    pin: int
    turn: int
    bearing: int


class FirstDrumLabels(NamedTuple):
    """The labels of the drum's first node and first element in a CalculiX deck."""

    node: int
    element: int


class DrumMeshAsDeckLines(NamedTuple):
    """The drum's mesh: deck lines of its nodes and elements, and the nodes' places (n, 2) [mm]."""

    lines: list[str]
    xy: Floats


def plane_stress_deck_text(
    brake: Brake,
    loaded: MeshedShoeUnderActuation,
    setting: CalculixDeckParameters,
    name: str = "shoe",
) -> str:
    """The text of the CalculiX deck of one shoe, in the brake's frame.

    Parameters
    ----------
    brake : the brake
    loaded : the shoe under its actuation
    setting : parameters of the deck
    name : name of the deck's file, without ending

    Raises
    ------
    BadInput
        for linear elements and for a clearance
    """
    require_lining_without_gap(brake, loaded)
    grid = _shoe_mesh_in_form_of_calculix_deck(loaded)
    drum_mesh = mesh_drum_arc(brake, loaded, FirstDrumLabels(grid.turn + 1, len(grid.cells) + 1))
    lining_faces = deck_lines_of_element_faces(grid.cells, grid.edges["contact"], grid.corners)
    drum_face = "S1" if loaded.shoe.sign_internal_plus_external_minus > 0 else "S3"
    lines = [
        *deck_header_lines(brake, loaded, setting, name),
        *_deck_lines_of_shoe_mesh(loaded, grid),
        *drum_mesh.lines,
        *_deck_lines_of_materials(loaded, setting),
        *deck_lines_of_contact(brake, loaded, setting, lining_faces, drum_face),
        *deck_lines_of_hinge(loaded, grid),
        *deck_lines_of_load_step(
            brake, setting, grid, drum_mesh.xy, _deck_lines_of_actuation(loaded, setting, grid)
        ),
    ]
    return "\n".join(lines) + "\n"


def require_lining_without_gap(brake: Brake, loaded: MeshedShoeUnderActuation) -> None:
    """Raise BadInput if there is a gap between the undeformed lining and the drum."""
    shoe, line = loaded.shoe, loaded.parts.line
    if np.any(unloaded_lining_gaps_at_points(line.xy, line.phi, brake, shoe)):
        raise BadInput(
            f"shoe {shoe.name!r}: lining.clearance: "
            "CalculiX gets linings that fit the drum; must be 0"
        )


def _shoe_mesh_in_form_of_calculix_deck(loaded: MeshedShoeUnderActuation) -> ShoeMeshOfDeck:
    """The mesh of a shoe in the form of a CalculiX deck. Raises BadInput for linear elements."""
    shoe, parts = loaded.shoe, loaded.parts
    cell = mesh_kind_of_scikit_fem_mesh(parts.mesh).cell
    if cell not in DECK_CELL_AND_CORNERS_OF_MESH_CELL:
        raise BadInput("--kind: CalculiX gets quadratic elements only; allowed: quad2, tri2")
    kind, corners = DECK_CELL_AND_CORNERS_OF_MESH_CELL[cell]
    xy = shoe.frame.convert_vectors_from_shoe_to_brake_frame(parts.basis.doflocs.T) * MM_PER_METRE
    cells = cells_with_nodes_counter_clockwise(
        xy, parts.basis.element_dofs.T[:, : 2 * corners], corners
    )
    edges = {}
    for name, facets in parts.mesh.boundaries.items():
        edges[name] = nodes_along_element_edges(parts.basis, facets)
    return ShoeMeshOfDeck(
        xy=xy,
        cells=cells,
        corners=corners,
        kind=ABAQUS_TYPE_OF_MESHIO_CELL[kind],
        edges=edges,
        pin=len(xy) + 1,
        turn=len(xy) + 2,
        bearing=len(cells) + len(angles_of_drum_nodes(loaded)) // 2 + 1,
    )


def _deck_lines_of_shoe_mesh(loaded: MeshedShoeUnderActuation, grid: ShoeMeshOfDeck) -> list[str]:
    """The lines of a deck for the nodes and elements of a shoe."""
    hinge = loaded.shoe.pin.xy * MM_PER_METRE
    lines = ["*NODE, NSET=NSHOE"]
    # CalculiX's quadrilaterals have no node in their middle, so drumlin's middle nodes are left
    # out.
    used = np.unique(grid.cells)
    lines += map(_deck_line_of_node, used + 1, grid.xy[used])
    lines += ["*NODE, NSET=PIN", _deck_line_of_node(grid.pin, hinge)]
    lines += ["** its displacement x is the turn [rad] of the shoe about the pin"]
    lines += ["*NODE, NSET=TURN", _deck_line_of_node(grid.turn, hinge)]
    for part, members in loaded.parts.mesh.subdomains.items():
        lines.append(f"*ELEMENT, TYPE={grid.kind}, ELSET={part.upper()}")
        for i in np.sort(members):
            lines.append(", ".join(map(str, [i + 1, *(grid.cells[i] + 1)])))
    return lines


def _deck_line_of_node(label: int, xy: Floats) -> str:
    """The line of a deck for a node at xy (2,) [mm]."""
    return f"{label}, {xy[0]:.12e}, {xy[1]:.12e}, 0."


def _deck_lines_of_materials(
    loaded: MeshedShoeUnderActuation, setting: CalculixDeckParameters
) -> list[str]:
    """The lines of a deck for the materials and the thickness of the parts of a shoe.

    All parts have the same thickness. A part that is wider than the lining gets a larger modulus in
    place of a larger thickness.
    """
    lining = loaded.shoe.lining
    thickness = setting.thickness * lining.width * MM_PER_METRE
    drum_material = Material(E=DRUM_MODULUS_OVER_LINING_MODULUS * lining.material.E_through, nu=0.0)
    parts = materials_and_widths_of_shoe_parts(loaded.shoe) | {
        "drum": (drum_material, lining.width)
    }
    layers, lines = elastic_layers_of_shoe(loaded.shoe), []
    for part, (material, width) in parts.items():
        name, times = part.upper(), width / lining.width
        section = f"*SOLID SECTION, ELSET={name}, MATERIAL={name}"
        lines.append(f"*MATERIAL, NAME={name}")
        if isinstance(material, Material):
            lines += ["*ELASTIC", f"{material.E * times * MPA_PER_PASCAL:.12e}, {material.nu:.12e}"]
        else:
            along = layers[part].along
            direction = (
                None
                if along is None
                else loaded.shoe.frame.convert_vectors_from_shoe_to_brake_frame(along)
            )
            lines += _deck_lines_of_orthotropic_material(material, times)
            lines += _deck_lines_of_orientation(f"O{name}", direction)
            section += f", ORIENTATION=O{name}"
        lines += [section, f"{thickness:.12e}"]
    return lines


def _deck_lines_of_orthotropic_material(material: OrthotropicMaterial, times: float) -> list[str]:
    """The lines of a deck for an orthotropic material, with its moduli multiplied by `times`.

    CalculiX's directions 1, 2, 3 are through, along and across the layer, as in its cylindrical
    coordinates. Constants across the layer (the width direction) do not matter in plane stress. If
    the brake file does not give them, Poisson's ratios across the layer are zero, Young's modulus
    across it equals E_along, and both shear moduli across it equal G_along_through.
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
    # CalculiX reads three Young's moduli, then three Poisson's ratios, then three shear moduli.
    moduli = times * MPA_PER_PASCAL * np.array([E, G])
    values = list(map("{:.12e}".format, [*moduli[0], *nu, *moduli[1]]))
    return ["*ELASTIC, TYPE=ENGINEERING CONSTANTS", ", ".join(values[:8]) + ",", values[8]]


def _deck_lines_of_orientation(name: str, along: Floats | None) -> list[str]:
    """The lines of a deck for the directions through, along and across an orthotropic layer.

    `along` is the direction (2,) of a straight layer in the brake's frame, or None for a layer that
    is curved around the drum's centre.
    """
    if along is None:
        return [f"*ORIENTATION, NAME={name}, SYSTEM=CYLINDRICAL", "0., 0., 0., 0., 0., 1."]
    x, y = along
    return [
        f"*ORIENTATION, NAME={name}, SYSTEM=RECTANGULAR",
        f"{y:.12e}, {-x:.12e}, 0., {x:.12e}, {y:.12e}, 0.",
    ]


def deck_lines_of_contact(
    brake: Brake,
    loaded: MeshedShoeUnderActuation,
    setting: CalculixDeckParameters,
    slave: list[str],
    master: str,
) -> list[str]:
    """The lines of a deck for the contact between lining and drum.

    Parameters
    ----------
    brake : the brake
    loaded : the shoe under its actuation
    setting : parameters of the deck
    slave : faces of the lining on the friction surface, as lines "element, face"
    master : name of the face of the drum's elements on the friction surface, such as "S1"
    """
    # The stiffness of the lining through its thickness, per area [MPa/mm].
    lining = loaded.shoe.lining
    unit = lining.material.E_through * MPA_PER_PASCAL / (lining.thickness * MM_PER_METRE)
    return [
        "*SURFACE, NAME=SLINING, TYPE=ELEMENT",
        *slave,
        "*SURFACE, NAME=SDRUM, TYPE=ELEMENT",
        f"DRUM, {master}",
        "*SURFACE INTERACTION, NAME=SLIDING",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
        f"{setting.penalty * unit:.12e}",
        "*FRICTION",
        f"{brake.friction_coefficient_of_shoe_at_zero_pressure(loaded.shoe):.12e}, "
        f"{setting.tangential_penalty * unit:.12e}",
        "*CONTACT PAIR, INTERACTION=SLIDING, TYPE=SURFACE TO SURFACE",
        "SLINING, SDRUM",
    ]


def deck_lines_of_hinge(loaded: MeshedShoeUnderActuation, grid: ShoeMeshOfDeck) -> list[str]:
    """The lines of a deck for the hinge and its pin.

    The nodes at the hinge move as a rigid line with the pin and turn about it. Stiff springs
    support the pin, because CalculiX prints no reaction at a node that is part of a constraint.
    """
    # A node moves by the pin's displacement, plus the rotation times the node's lever arm about the
    # pin, at right angles to this arm.
    lines = ["** the hinge's line turns about the pin", "*EQUATION"]
    for i in np.unique(grid.edges["hinge"]):
        x, y = grid.xy[i] - loaded.shoe.pin.xy * MM_PER_METRE
        lines += ["3", f"{i + 1}, 1, 1., {grid.pin}, 1, -1., {grid.turn}, 1, {y:.12e}"]
        lines += ["3", f"{i + 1}, 2, 1., {grid.pin}, 2, -1., {grid.turn}, 1, {-x:.12e}"]
    lines.append("** the pin's bearing: its force on the shoe is that of these springs")
    for c, axis in enumerate("XY"):
        lines += [
            f"*ELEMENT, TYPE=SPRING1, ELSET=BEARING{axis}",
            f"{grid.bearing + c}, {grid.pin}",
        ]
    for c, axis in enumerate("XY", start=1):
        lines += [
            f"*SPRING, ELSET=BEARING{axis}",
            f"{c}",
            f"{PIN_SPRING_STIFFNESS_IN_N_PER_MM:.12e}",
        ]
    return [*lines, "*BOUNDARY", f"{grid.pin}, 3, 3"]


def deck_lines_of_load_step(
    brake: Brake,
    setting: CalculixDeckParameters,
    grid: ShoeMeshOfDeck,
    drum_xy: Floats,
    load: list[str],
) -> list[str]:
    """The lines of a deck for the load step, which loads the shoe and rotates the drum together.

    The last lines tell CalculiX which results to print.

    Parameters
    ----------
    brake : the brake
    setting : parameters of the deck
    grid : mesh of the shoe
    drum_xy : positions (n, 2) [mm] of the drum's nodes
    load : lines of the deck for the nodal forces of the actuation
    """
    lines = ["*STEP, INC=1000", "*STATIC", f"{1 / setting.steps:.12e}, 1."]
    lines += ["*CONTROLS, PARAMETERS=FIELD"]
    lines += [f"{setting.accuracy:.12e}, {setting.accuracy:.12e}", "*CLOAD", *load]
    # Each node of the drum moves along the tangent of the drum, by the angle times its radius.
    angle = brake.sign_of_motion * setting.rotation
    displacements = angle * drum_xy @ np.array([[0, 1], [-1, 0]])
    lines.append("*BOUNDARY")
    for label, (x, y) in enumerate(displacements, start=grid.turn + 1):
        lines += [f"{label}, 1, 1, {x:.12e}", f"{label}, 2, 2, {y:.12e}"]
    for nodes, value in (("PIN", "U"), ("TURN", "U"), ("NDRUM", "RF")):
        lines += [f"*NODE PRINT, NSET={nodes}, FREQUENCY=1000", value]
    lines += ["*CONTACT PRINT, SLAVE=SLINING, MASTER=SDRUM, FREQUENCY=1000", "CF, CSTR"]
    return [*lines, "*CONTACT FILE, FREQUENCY=1000", "CDIS, CSTR", "*END STEP"]


def _deck_lines_of_actuation(
    loaded: MeshedShoeUnderActuation, setting: CalculixDeckParameters, grid: ShoeMeshOfDeck
) -> list[str]:
    """The lines of a deck for the actuation of a shoe.

    On an elastic body the lines give the same nodal forces as in drumlin's own solve, also for
    springs and weight. On a rigid shoe they give a force and a couple on the pin.
    """
    if "actuation" not in grid.edges:
        return deck_lines_of_load_on_pin(loaded, setting, grid)
    parts = loaded.parts
    unit, _ = nodal_forces_of_unit_end_loads_and_end_centre(
        parts.basis, parts.mesh.boundaries["actuation"]
    )
    nodal = (unit @ np.array([*loaded.force, loaded.couple])).reshape(-1, 2)
    forces = setting.thickness * loaded.shoe.frame.convert_vectors_from_shoe_to_brake_frame(
        nodal + loaded.at_places
    )
    on_body = np.flatnonzero(loaded.at_places.any(axis=1))
    return deck_lines_of_nodal_forces(forces, np.union1d(grid.edges["actuation"], on_body))


def deck_lines_of_nodal_forces(forces: Floats, nodes: Ints) -> list[str]:
    """The lines of a deck for the forces (n, 2) [N] on the nodes with the numbers `nodes`."""
    lines = []
    for i in nodes:
        lines += [f"{i + 1}, {c + 1}, {forces[i, c]:.12e}" for c in range(2)]
    return lines


def deck_lines_of_load_on_pin(
    loaded: MeshedShoeUnderActuation, setting: CalculixDeckParameters, grid: ShoeMeshOfDeck
) -> list[str]:
    """The lines of a deck for the actuation as a force and a couple on the pin of a rigid shoe."""
    frame, size = loaded.shoe.frame, setting.thickness
    force = size * frame.convert_vectors_from_shoe_to_brake_frame(loaded.force)
    couple = size * frame.sense * loaded.couple * MM_PER_METRE
    lines = [f"{grid.pin}, {c + 1}, {force[c]:.12e}" for c in range(2)]
    return [*lines, f"{grid.turn}, 1, {couple:.12e}"]


def deck_header_lines(
    brake: Brake, loaded: MeshedShoeUnderActuation, setting: CalculixDeckParameters, name: str
) -> list[str]:
    """The comment lines at the head of a deck: its brake, its units, how to run and read it.

    Parameters
    ----------
    brake : the brake
    loaded : the shoe under its actuation
    setting : parameters of the deck
    name : name of the deck's file, without ending
    """
    # Names are put on one line and cut at 80 letters, so that they fit into a comment line.
    friction = brake.friction_coefficient_of_shoe_at_zero_pressure(loaded.shoe)
    title, shoe = (" ".join(text.split())[:80] for text in (brake.title, loaded.shoe.name))
    return [
        f"** {title}",
        f"** shoe {shoe!r}, drum turns {brake.direction}, friction {friction:g}",
        "** units: mm, N, MPa; written by drumlin from its own mesh",
        f"** run: ccx {name}     results: {name}.dat",
        f"** thickness, stiffness across it and force are {setting.thickness:g} of the brake's",
        f"** the drum turns by {setting.rotation:g} rad along its tangents: small displacements",
    ]


def cells_with_nodes_counter_clockwise(xy: Floats, cells: Ints, corners: int) -> Ints:
    """The cells with their nodes in counter-clockwise order.

    Parameters
    ----------
    xy : positions (n, 2) of the nodes
    cells : numbers (m, 2 corners) of the nodes of each cell, corners first, clockwise or
        counter-clockwise
    corners : number of corners of a cell
    """
    x, y = xy[cells[:, :corners]].transpose(2, 0, 1)
    area = (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)
    # `back` reverses the order of a cell's corners, and keeps the first corner in its place.
    back = [0, *range(corners - 1, 0, -1)]
    middles = list(range(2 * corners - 1, corners - 1, -1))
    return np.where((area > 0)[:, None], cells, cells[:, back + middles])


def deck_lines_of_element_faces(cells: Ints, along: Ints, corners: int) -> list[str]:
    """The lines "element, S<face>" by which a CalculiX deck names the edges `along` of elements.

    Face i of a plane element of CalculiX is its edge from corner i to the next corner.

    Parameters
    ----------
    cells : numbers (m, k) of the nodes of each cell, corners first
    along : numbers (3, edges) of the nodes of each edge to be named, from end to end
    corners : number of corners of a cell
    """
    # An edge is identified by the set of its two end nodes, so that their order does not matter.
    wanted = set(map(frozenset, along[[0, -1]].T.tolist()))
    lines = []
    for number, row in enumerate(cells[:, :corners].tolist(), start=1):
        for face in range(corners):
            if frozenset((row[face], row[(face + 1) % corners])) in wanted:
                lines.append(f"{number}, S{face + 1}")
    return lines


def angles_of_drum_nodes(loaded: MeshedShoeUnderActuation) -> Floats:
    """The angles theta [rad] of the nodes of the drum's arc in a CalculiX deck.

    The drum has nodes at the same angles as the lining, so that no gap is left between the curved
    edges of drum and lining. It has a few more nodes beyond the lining's ends.
    """
    theta = np.sort(loaded.shoe.frame.surface_coordinates_of_phi(loaded.parts.line.phi))
    # The drum's arc must not close to a full circle.
    beyond = min(DRUM_ANGLE_BEYOND_LINING, 0.49 * (2 * math.pi - np.ptp(theta)))
    more = np.linspace(0.0, beyond, 2 * DRUM_ELEMENTS_BEYOND_LINING + 1)[1:]
    return np.concatenate([theta[0] - more[::-1], theta, theta[-1] + more])


def mesh_drum_arc(
    brake: Brake, loaded: MeshedShoeUnderActuation, first: FirstDrumLabels
) -> DrumMeshAsDeckLines:
    """The mesh of the drum in a CalculiX deck: one layer of elements CPS8 along the arc.

    The face of the elements on the friction surface is S1 for an internal shoe, and S3 for an
    external shoe. `first` holds the labels of the first node and the first element.
    """
    shoe, R = loaded.shoe, brake.size
    theta = angles_of_drum_nodes(loaded)
    count = len(theta) // 2
    inner, outer = (
        (R, R * (1 + DRUM_LAYER_THICKNESS_OVER_RADIUS))
        if shoe.sign_internal_plus_external_minus > 0
        else (R * (1 - DRUM_LAYER_THICKNESS_OVER_RADIUS), R)
    )
    # Rows of nodes along the arc: the inner arc, the middle of the layer (at every other angle),
    # the outer arc.
    rows = [(inner, theta), ((inner + outer) / 2, theta[::2]), (outer, theta)]
    xy = (
        np.concatenate([r * np.column_stack([np.cos(t), np.sin(t)]) for r, t in rows])
        * MM_PER_METRE
    )
    # The label of the first node in each of the three rows.
    a, b, c = (first.node + np.cumsum([0, len(theta), count + 1])).tolist()
    lines = ["*NODE, NSET=NDRUM"]
    lines += map(_deck_line_of_node, count_from(first.node), xy)
    lines.append("*ELEMENT, TYPE=CPS8, ELSET=DRUM")
    for k in range(count):
        i = 2 * k
        # The nodes run counter-clockwise: first the four corners, then the four middle nodes.
        nodes = [a + i + 2, a + i, c + i, c + i + 2, a + i + 1, b + k, c + i + 1, b + k + 1]
        lines.append(", ".join(map(str, [first.element + k, *nodes])))
    return DrumMeshAsDeckLines(lines, xy)
