"""A brake and its mesh as a picture."""

from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from drumlin.brake import Brake
from drumlin.fem.scene import prepare

PARTS = {"shoe": "#c9d3dc", "backing": "#d9c39a", "lining": "#b98b6b"}


def draw(brake: Brake, **options: Any) -> Figure:
    """The meshes of all shoes in the drum, with pins, forces and the sense of rotation; lengths in mm."""
    scene = prepare(brake, **options)
    figure = Figure(figsize=(7.5, 7.5), layout="constrained")
    axes = figure.subplots()
    axes.add_patch(Circle((0, 0), brake.drum.radius * 1e3, fill=False, lw=2))
    for shoe, body in zip(brake.shoes, scene.bodies, strict=True):
        xy = shoe.frame.to_brake(body.mesh.p.T) * 1e3
        for name, elements in body.mesh.subdomains.items():
            corners = xy[body.mesh.t[:, elements].T]
            axes.add_collection(PolyCollection(corners, facecolor=PARTS[name], edgecolor="#40505f", lw=0.25))
        axes.plot(*(shoe.hinge.xy * 1e3), "o", color="#1d2733", ms=9)
        force = shoe.actuation.vector
        size = float(np.linalg.norm(force))
        if size > 0:
            tip = shoe.actuation.point.xy * 1e3
            tail = tip - 0.35e3 * brake.drum.radius * force / size
            axes.annotate(
                f"{size:.4g} N",
                (tip[0], tip[1]),
                (tail[0], tail[1]),
                ha="center",
                arrowprops={"arrowstyle": "-|>", "color": "#1d2733", "lw": 2},
            )
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("y [mm]")
    axes.set_title(f"{brake.title}, drum turns {brake.rotation}")
    return figure
