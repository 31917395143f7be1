"""The picture of `drumlin view`: a brake to scale with the meshes of its shoes."""

from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from drumlin.base.arrays import Ints
from drumlin.brake.brake import Brake
from drumlin.fem.hp.grid import HpElementGrid
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import prepared_model_with_finest_elements
from drumlin.models import reasons_why_models_do_not_apply
from drumlin.report.drawing import draw_brake

COLOR_OF_ELEMENTS_BY_SHOE_PART = {
    "shoe": "#c9d3dc",
    "table": "#b3c0cc",
    "backing": "#d9c39a",
    "lining": "#b98b6b",
}
"""Colour of the finite elements, by the part of the shoe to which they belong."""


def draw_brake_with_meshes(brake: Brake, **options: Any) -> Figure:
    """Draw a brake with drum, pins and forces, and on top the finite-element meshes of its shoes.

    A brake to which finite elements do not apply is drawn without meshes. `options` are options of
    the mesh, such as elements and kind.
    """
    figure = Figure(figsize=(7.5, 7.5), layout="constrained")
    axes = figure.subplots()
    draw_brake(axes, brake)
    axes.set_title(f"{brake.title}, {brake.motion_as_text}")
    if "fem" in reasons_why_models_do_not_apply(brake):
        return figure
    if options or not any(shoe.mesh for shoe in brake.shoes):
        scene = prepared_model_with_finest_elements(brake, **options)
    else:
        # Meshes from files are drawn as they are in the files, not refined as for a solution.
        scene = make_prepared_model(brake)
    for shoe, body in zip(brake.shoes, scene.bodies, strict=True):
        # Each element is drawn as the polygon of the nodes around it.
        xy = shoe.convert_points_to_brake_frame(body.basis.doflocs).T * 1e3  # mm
        around = (
            body.mesh.boundary_nodes_around_each_element
            if isinstance(body.mesh, HpElementGrid)
            else boundary_nodes_around_each_mesh_element(body.basis)
        )
        for name, elements in body.mesh.subdomains.items():
            polygons = PolyCollection(
                list(xy[around[:, elements].T]),
                facecolor=COLOR_OF_ELEMENTS_BY_SHOE_PART[name],
                edgecolor="#40505f",
                lw=0.25,
                zorder=3.5,
            )
            axes.add_collection(polygons)
    return figure


def boundary_nodes_around_each_mesh_element(basis: Any) -> Ints:
    """The nodes on the boundary of each element of a mesh (k, elements), in order around it.

    The nodes are corners and middles of edges; linear elements have corners only. `basis` is the
    scikit-fem basis of a scalar field on the mesh.
    """
    corners = len(basis.mesh.t)
    around = np.asarray(basis.element_dofs[: 2 * corners])
    if len(around) == 2 * corners:
        # skfem lists all corners first, then all middles of edges. Around an element, corners and
        # middles alternate.
        around = around.reshape(2, corners, -1).swapaxes(0, 1).reshape(2 * corners, -1)
    return around
