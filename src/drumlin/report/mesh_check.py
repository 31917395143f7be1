"""The picture and the text of `drumlin mesh --check`: a shoe's mesh as drumlin read it from a file.

The left panel shows the groups of the mesh, the pin and the force, to scale. The right panel shows
the distance of the contact line from the drum or the plane, magnified.
"""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.transforms import ScaledTranslation

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.units import length_as_text_in_mm
from drumlin.fem.mesh.arc import mesh_kind_of_scikit_fem_mesh
from drumlin.fem.mesh.degree import nodal_basis_of_mesh
from drumlin.fem.mesh.edges import nodes_along_element_edges
from drumlin.fem.mesh.file import read_shoe_mesh_with_notes
from drumlin.fem.mesh.from_file import (
    ShoeMeshReadFromFile,
    notes_on_file_that_differs_from_mesh,
)
from drumlin.report.drawing import absolute_force_as_text_with_unit, draw_arrow_from_tail_to_tip
from drumlin.report.figures import MATPLOTLIB_SETTINGS_FOR_SCREEN
from drumlin.report.palette import BLUE, COLOR_OF_AXES_AND_NOTES, GREEN, INK, PURPLE, RED
from drumlin.report.signs import DRUM_COLOR, MM_PER_M, draw_support_of_shoe
from drumlin.report.view import boundary_nodes_around_each_mesh_element

MESH_GROUP_COLORS = {
    "lining": "#c89b6a",
    "backing": "#e3cfa4",
    "table": "#9db0c2",
    "shoe": "#cdd6de",
    "contact": RED,
    "hinge": BLUE,
    "actuation": GREEN,
}
"""The colour of each group of a mesh, by the name of the group.

Groups of elements are drawn as areas, groups of edges as lines.
"""
MICROMETRES_PER_METRE = 1e6
"""Micrometres in a metre."""
LEGEND_DISTANCE_BELOW_AXES = 0.55
"""Distance [inch] of a legend from the axes above it, which leaves room for the axis label."""


class ShoeWithMeshFromFile(NamedTuple):
    """A shoe with the mesh that was read from the shoe's mesh file."""

    shoe: Shoe
    read: ShoeMeshReadFromFile


class _ContactOffsets(NamedTuple):
    """Distances of a mesh's n contact nodes from the drum or plane, in order along the lining.

    Attributes
    ----------
    at : (n,) places of the nodes along the lining, in the surface's coordinate [rad; on a plane m]
    in_file : (n,) distances of the nodes from the drum or the plane in the mesh file [m]
    solved : (n,) distances of the nodes from the drum or the plane in the mesh that drumlin solves
        [m]; in this mesh, nodes close to the drum or the plane have been moved onto it
    """

    at: Floats
    in_file: Floats
    solved: Floats


def read_mesh_files_of_brake(brake: Brake) -> list[ShoeWithMeshFromFile]:
    """Read the mesh of each shoe that has a mesh file.

    Raises BadInput if no shoe has a mesh file, and for a mesh file that cannot be used.
    """
    brake.check_shoes_can_be_meshed()
    found = []
    for shoe in brake.shoes:
        if shoe.mesh is not None:
            key = f"shoe {shoe.name!r}: mesh"
            read = read_shoe_mesh_with_notes(shoe.mesh, shoe, brake.size, key)
            found.append(ShoeWithMeshFromFile(shoe, read))
    if not found:
        raise BadInput("--check: no shoe has a mesh file; drumlin view draws its own meshes")
    return found


# The functions below write text about the meshes that will be solved.


def text_lines_about_mesh_to_be_solved(
    brake: Brake, checked: ShoeWithMeshFromFile
) -> Iterator[str]:
    """Yield three lines of text on a shoe's mesh: elements, contact line, and support with force.

    The following lines say what drumlin changed when it read the file, and which places and lengths
    of the brake file hardly agree with the mesh.
    """
    shoe, mesh = checked.shoe, checked.read.mesh
    kind = mesh_kind_of_scikit_fem_mesh(mesh)
    form = "triangles" if len(mesh.t) == 3 else "quadrilaterals"
    degree = "quadratic" if kind.degree == 2 else "linear"
    parts = ", ".join(f"{name} {len(of)}" for name, of in mesh.subdomains.items())
    yield (
        f"shoe {shoe.name!r}: {mesh.nelements} {degree} {form} ({parts}), "
        f"{mesh.doflocs.shape[1]} nodes, in plane stress"
    )
    yield f"shoe {shoe.name!r}: {_text_about_contact_line(brake, checked)}"
    yield f"shoe {shoe.name!r}: {_text_about_support_and_force(shoe, mesh)}"
    differs = notes_on_file_that_differs_from_mesh(shoe, mesh, brake.size)
    for note in (*checked.read.notes, *differs):
        yield f"shoe {shoe.name!r}: {note}"


def _text_about_contact_line(brake: Brake, checked: ShoeWithMeshFromFile) -> str:
    """A text about a contact line: its ends, and its distance from the drum or the plane."""
    shoe, contact = checked.shoe, checked.read.contact
    offsets = _offsets_of_contact_nodes(brake, checked)
    surface, place = shoe.surface.name, shoe.surface.coordinate_as_text
    sides = len(checked.read.mesh.boundaries["contact"])
    text = (
        f"contact line of {sides} sides from {place(offsets.at[0])} to {place(offsets.at[-1])}, "
        f"in the file up to {_largest_length_as_text_in_micrometres(offsets.in_file)} off the "
        f"{surface}"
    )
    moved = contact.rounded + contact.straight
    if moved:
        gap = _largest_length_as_text_in_micrometres(offsets.solved)
        text += f"; {moved} nodes are put on it, up to {gap} stays as a gap"
    compression = mean_lining_compression_under_actuation_force(brake, shoe)
    compressed = _largest_length_as_text_in_micrometres(compression)
    return f"{text}; the force spread evenly compresses the lining by {compressed}"


def _largest_length_as_text_in_micrometres(lengths: Floats | float) -> str:
    """The largest absolute value of lengths [m] as text in micrometres; "0 um" for round-off."""
    largest = float(np.abs(lengths).max()) * MICROMETRES_PER_METRE
    return f"{largest:.3g} um" if largest > 1e-4 else "0 um"


def _text_about_support_and_force(shoe: Shoe, mesh: Any) -> str:
    """A text about the mesh's edges at the support and at the force, and about the force."""
    held = len(mesh.boundaries["hinge"])
    x, y = shoe.pin.xy.tolist()
    text = (
        f"the {held} sides of the group hinge are a rigid line held at x = "
        f"{length_as_text_in_mm(x)}, "
        f"y = {length_as_text_in_mm(y)} ({shoe.kind_of_support}); "
    )
    where = "the rigid line"
    if "actuation" in mesh.boundaries and not shoe.has_support_on_back_of_body:
        where = f"the {len(mesh.boundaries['actuation'])} sides of the group actuation"
    force = shoe.actuation.force
    if not force:
        return f"{text}no force of its own acts on {where}"
    angle = math.degrees(shoe.actuation.direction)
    sense = "against" if force < 0 else "at"
    return f"{text}{absolute_force_as_text_with_unit(force)} {sense} {angle:.4g} deg act on {where}"


def mean_lining_compression_under_actuation_force(brake: Brake, shoe: Shoe) -> float:
    """The compression [m] of a lining if the actuation force is spread evenly over its face.

    Distances of the contact line from the drum matter if they are as large as this compression.
    """
    lining = shoe.lining
    area = lining.width * (lining.end - lining.start) * brake.length_per_surface_coordinate
    return abs(shoe.actuation.force) / area * lining.thickness / lining.material.E_through


def _offsets_of_contact_nodes(brake: Brake, checked: ShoeWithMeshFromFile) -> _ContactOffsets:
    """The distances of a mesh's contact nodes from the drum or the plane."""
    shoe, mesh = checked.shoe, checked.read.mesh
    nodes = np.unique(_nodes_along_element_sides(mesh, mesh.boundaries["contact"]))
    solved = nodal_basis_of_mesh(mesh).doflocs[:, nodes]
    in_file = nodal_basis_of_mesh(checked.read.in_file).doflocs[:, nodes]
    at = shoe.frame.surface_coordinates_of_phi(
        shoe.surface_coordinates_of_points_in_shoe_frame(solved, brake.size)
    )
    order = np.argsort(at)
    return _ContactOffsets(
        at[order],
        shoe.distances_from_friction_surface(in_file, brake.size)[order],
        shoe.distances_from_friction_surface(solved, brake.size)[order],
    )


def _nodes_along_element_sides(mesh: Any, facets: Ints) -> Ints:
    """The nodes (degree + 1, m) along m sides of elements, which have the numbers `facets` (m,)."""
    return nodes_along_element_edges(nodal_basis_of_mesh(mesh), facets)


# The functions below draw the picture.


def draw_checked_meshes(brake: Brake, checked: list[ShoeWithMeshFromFile]) -> Figure:
    """Draw the meshes that were read from files, in a row of two panels for each shoe."""
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_SCREEN):
        figure = Figure(figsize=(13.0, 6.4 * len(checked)), layout="constrained")
        rows = figure.subplots(
            len(checked), 2, squeeze=False, gridspec_kw={"width_ratios": [1.25, 1.0]}
        )
        for (left, right), one in zip(rows, checked, strict=True):
            _draw_groups_with_pin_and_force(left, brake, one)
            _draw_offsets_of_contact_line(right, brake, one)
    return figure


def _draw_groups_with_pin_and_force(
    axes: Axes, brake: Brake, checked: ShoeWithMeshFromFile
) -> None:
    """Draw the groups of a mesh in colour, its support and its force, in mm."""
    shoe, mesh = checked.shoe, checked.read.mesh
    basis = nodal_basis_of_mesh(mesh)
    xy = shoe.convert_points_to_brake_frame(basis.doflocs).T * MM_PER_M
    around = boundary_nodes_around_each_mesh_element(basis)
    # Thin lines keep the colours of fine meshes visible.
    width = 0.4 if mesh.nelements < 3000 else 0.15
    for name, elements in mesh.subdomains.items():
        axes.add_collection(
            PolyCollection(
                list(xy[around[:, elements].T]),
                facecolor=MESH_GROUP_COLORS[name],
                edgecolor="#40505f",
                lw=width,
                zorder=3,
            )
        )
    for name, facets in mesh.boundaries.items():
        lines = xy[nodes_along_element_edges(basis, facets).T]
        look: dict[str, Any] = {"color": MESH_GROUP_COLORS[name], "lw": 3.0, "zorder": 4.5}
        axes.add_collection(LineCollection(list(lines), **look))
    low, high = xy.min(axis=0), xy.max(axis=0)
    unit = float((high - low).max()) / 22
    draw_support_of_shoe(axes, shoe, unit)
    held = xy[np.unique(nodes_along_element_edges(basis, mesh.boundaries["hinge"]))].mean(axis=0)
    _draw_rigid_arm(axes, held, shoe.pin.xy * MM_PER_M, unit)
    ends = _draw_force_at_loaded_sides(axes, checked, xy, basis, unit)
    points = np.concatenate([[low, high, shoe.pin.xy * MM_PER_M], ends])
    low, high = points.min(axis=0) - 1.8 * unit, points.max(axis=0) + 1.8 * unit
    _draw_friction_surface(axes, brake, shoe, low, high)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("y [mm]")
    assert shoe.mesh is not None
    axes.set_title(f"shoe {shoe.name}: {shoe.mesh.name}")
    _draw_legend_of_groups(axes, mesh)


def _draw_legend_of_groups(axes: Axes, mesh: Any) -> None:
    """Draw the legend of a mesh's groups, with the number of elements or sides in each."""
    handles: list[Any] = [
        Patch(
            facecolor=MESH_GROUP_COLORS[name],
            edgecolor="#40505f",
            label=f"{name}: {len(of)} elements",
        )
        for name, of in mesh.subdomains.items()
    ]
    handles += [
        Line2D([], [], color=MESH_GROUP_COLORS[name], lw=3, label=f"{name}: {len(of)} sides")
        for name, of in mesh.boundaries.items()
    ]
    _draw_legend_below_axes(axes, handles, 3)


def _draw_legend_below_axes(axes: Axes, handles: list[Any], columns: int) -> None:
    """Draw a legend below the label of the horizontal axis, where it covers no part of a mesh."""
    figure = axes.get_figure()
    assert isinstance(figure, Figure)
    below = axes.transAxes + ScaledTranslation(
        0.0, -LEGEND_DISTANCE_BELOW_AXES, figure.dpi_scale_trans
    )
    axes.legend(
        handles=handles,
        loc="upper center",
        bbox_to_anchor=(0.5, 0.0),
        bbox_transform=below,
        ncols=columns,
        fontsize=9,
    )


def _draw_force_at_loaded_sides(
    axes: Axes, checked: ShoeWithMeshFromFile, xy: Floats, basis: Any, unit: float
) -> Floats:
    """Draw the actuation force where it acts on the mesh; returns points (n, 2) [mm] to show.

    The arrow's tip is the point of the line of action nearest to the loaded edges of elements. If
    the mesh has no loaded edges, it is the force's point in the brake file.

    Parameters
    ----------
    axes : axes of the drawing
    checked : the shoe and its mesh
    xy : (nodes, 2) nodes [mm]
    basis : basis of the mesh
    unit : size of symbols that are not drawn to scale [mm]
    """
    shoe, mesh = checked.shoe, checked.read.mesh
    if not shoe.actuation.force:
        return np.zeros((0, 2))
    tip = shoe.actuation.point.xy * MM_PER_M
    along = shoe.actuation.unit_vector_of_force * math.copysign(1.0, shoe.actuation.force)
    if "actuation" in mesh.boundaries:
        sides = nodes_along_element_edges(basis, mesh.boundaries["actuation"])
        middle = xy[np.unique(sides)].mean(axis=0)
        tip = tip + ((middle - tip) @ along) * along
        _draw_rigid_arm(axes, middle, tip, unit)
    tail = tip - 4 * unit * along
    draw_arrow_from_tail_to_tip(axes, tail, tip, PURPLE, width=0.12)
    text = absolute_force_as_text_with_unit(shoe.actuation.force)
    place = tail - 0.4 * unit * along
    align = "right" if along[0] > 0.3 else "left" if along[0] < -0.3 else "center"
    axes.text(place[0], place[1], text, color=PURPLE, ha=align, va="center", fontsize=10, zorder=7)
    # The text beside the arrow is about 4 * unit long.
    reach = {"right": -4.0, "left": 4.0, "center": 0.0}[align] * unit
    return np.array([tip, tail, place + np.array([reach, 0.0])])


def _draw_rigid_arm(axes: Axes, start: Floats, end: Floats, unit: float) -> None:
    """Draw a rigid arm from the middle of a mesh's edges to the pin or the force beside them.

    `start` and `end` (2,) [mm] are its ends. An arm shorter than `unit` [mm] is not drawn.
    """
    if float(np.hypot(*(end - start))) > unit:
        axes.plot(*np.array([start, end]).T, color=INK, lw=1.2, ls="--", zorder=4.2)


def _draw_friction_surface(axes: Axes, brake: Brake, shoe: Shoe, low: Floats, high: Floats) -> None:
    """Draw the drum's circle with its centre, or the plane, behind the mesh."""
    if shoe.is_on_plane:
        axes.axhspan(min(low[1], 0.0) - 1.0, 0.0, facecolor=DRUM_COLOR, zorder=1)
        axes.plot([low[0], high[0]], [0.0, 0.0], color=INK, lw=0.8, zorder=2)
        return
    angle = np.linspace(0.0, 2 * math.pi, 721)
    radius = brake.size * MM_PER_M
    axes.plot(radius * np.cos(angle), radius * np.sin(angle), color=INK, lw=0.8, ls="--", zorder=2)
    axes.plot([0.0], [0.0], "+", color=COLOR_OF_AXES_AND_NOTES, ms=10, zorder=2)


def _draw_offsets_of_contact_line(axes: Axes, brake: Brake, checked: ShoeWithMeshFromFile) -> None:
    """Draw the distances of the contact nodes from the drum or the plane, in micrometres."""
    shoe = checked.shoe
    offsets = _offsets_of_contact_nodes(brake, checked)
    at = offsets.at * shoe.surface.si_to_shown_unit_factor
    compression = mean_lining_compression_under_actuation_force(brake, shoe) * MICROMETRES_PER_METRE
    word = shoe.surface.name
    axes.axhline(0.0, color=INK, lw=1.2)
    if compression:
        axes.axhspan(-compression, compression, facecolor="#dfe5ea", zorder=0)
    moved = np.abs(offsets.in_file - offsets.solved).max() > 0
    in_file = "in the file" if moved else "in the file, solved as it is"
    axes.plot(
        at, offsets.in_file * MICROMETRES_PER_METRE, "o-", color=RED, ms=3, lw=0.9, label=in_file
    )
    if moved:
        axes.plot(
            at,
            offsets.solved * MICROMETRES_PER_METRE,
            ".-",
            color=BLUE,
            ms=3,
            lw=1.2,
            label="solved",
        )
    # The vertical axis covers at least the lining's compression, so that distances that are
    # round-off do not fill the panel.
    shown = np.append(
        offsets.in_file * MICROMETRES_PER_METRE, [-1.5 * compression, 1.5 * compression]
    )
    low, high = min(float(shown.min()), -1e-3), max(float(shown.max()), 1e-3)
    margin = 0.06 * (high - low)
    axes.set_ylim(low - margin, high + margin)
    if compression:
        text = f"grey: the force compresses the lining by {compression:.3g} \u00b5m"
        box = {"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": "none"}
        axes.text(
            0.98,
            0.97,
            text,
            transform=axes.transAxes,
            color=COLOR_OF_AXES_AND_NOTES,
            fontsize=9,
            bbox=box,
            ha="right",
            va="top",
            zorder=6,
        )
    axes.set_title(f"contact line off the {word}, positive: open gap")
    axes.set_xlabel(shoe.surface.axis_label_in_report)
    axes.set_ylabel(f"distance off the {word} [\u00b5m]")
    _draw_legend_below_axes(axes, axes.get_legend_handles_labels()[0], 2)
