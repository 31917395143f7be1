"""Makes web_shoe.msh: a shoe of a car, table and web with holes, its lining bonded on.

    python meshes/web_shoe.py [--refine N] [--output FILE]

Needs gmsh (pip install 'drumlin[meshing]'). Lengths in mm; the frame is the shoe's own: the drum's
centre is the origin, the pin lies on the +x axis, the lining at growing angle. N divides every
element size.
"""

import argparse
import math
from pathlib import Path

import gmsh

# The radius of the drum, and the radial thicknesses of the layers.
DRUM, LINING, TABLE, WEB = 150.0, 8.0, 3.0, 28.0
PIN = 125.0  # distance of the pin from the centre
LINING_ARC = (5.0, 130.0)  # deg from the pin
TABLE_ARC = (3.0, 132.0)
WEB_END = 125.0  # deg: where the web's inner edge ends
# The cylinder pushes on this upright face, in the brake with the pin at -75 deg.
FACE_X, FACE_Y = 58.0, (93.0, 107.0)
PIN_ANGLE = -75.0
# Of each hole the angle from the pin in degrees, the distance from the centre, and the radius.
HOLES = [
    (0.0, PIN, 6.0),  # the pin's
    (30.0, 123.5, 8.0),  # three to save weight
    (62.0, 123.5, 8.0),
    (96.0, 123.5, 8.0),
    (117.0, 123.5, 3.0),  # the return spring's
]
LARGEST = 6.5  # size of the elements
SIZES = {"lining ends": (0.5, 0.0, 23.0), "lining": (3.2, 4.0, 30.0), "holes": (3.2, 0.0, 12.0)}
"""Size near some curves, the distance up to which it stays, the one from which it is the largest.
"""
SLACK = 1e-6


def polar_point(radius: float, angle: float) -> tuple[float, float]:
    """x, y of polar coordinates [mm, deg]."""
    return radius * math.cos(math.radians(angle)), radius * math.sin(math.radians(angle))


def add_ring_sector(inner: float, outer: float, start: float, end: float) -> int:
    """A sector of a ring [mm, deg]."""
    occ = gmsh.model.occ
    centre = occ.addPoint(0, 0, 0)
    polar = [(inner, start), (outer, start), (outer, end), (inner, end)]
    corners = [occ.addPoint(*polar_point(*corner), 0) for corner in polar]
    lines = [
        occ.addLine(corners[0], corners[1]),
        occ.addCircleArc(corners[1], centre, corners[2]),
        occ.addLine(corners[2], corners[3]),
        occ.addCircleArc(corners[3], centre, corners[0]),
    ]
    return int(occ.addPlaneSurface([occ.addCurveLoop(lines)]))


def add_web() -> list[tuple[int, int]]:
    """The web without its holes: an eye about the pin, a ring sector, a nose with its face."""
    occ = gmsh.model.occ
    outer = DRUM - LINING - TABLE
    inner = outer - WEB
    upper, lower = (
        polar_point(math.hypot(FACE_X, y), math.degrees(math.atan2(y, FACE_X)) - PIN_ANGLE)
        for y in FACE_Y[::-1]
    )
    corners = [
        occ.addPoint(*polar_point(inner, WEB_END), 0),
        occ.addPoint(*polar_point(outer - WEB / 2, WEB_END - 1), 0),
    ]
    corners += [occ.addPoint(*xy, 0) for xy in (polar_point(outer, TABLE_ARC[1]), upper, lower)]
    edges = [occ.addLine(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    parts = [
        (2, occ.addDisk(PIN, 0, 0, WEB / 2, WEB / 2)),
        (2, add_ring_sector(inner, outer, 0, WEB_END)),
        (2, add_ring_sector(outer - WEB / 2, outer, WEB_END - 1, TABLE_ARC[1])),
        (2, occ.addPlaneSurface([occ.addCurveLoop(edges)])),
    ]
    whole, _ = occ.fuse(parts[:1], parts[1:])
    cut = [
        (2, occ.addDisk(*polar_point(distance, angle), 0, radius, radius))
        for angle, distance, radius in HOLES
    ]
    whole, _ = occ.cut(whole, cut)
    return [(int(dim), int(tag)) for dim, tag in whole]


def build_geometry(refine: float) -> None:
    """Geometry, named groups and sizes in the current gmsh model."""
    occ = gmsh.model.occ
    lining = (2, add_ring_sector(DRUM - LINING, DRUM, *LINING_ARC))
    table = (2, add_ring_sector(DRUM - LINING - TABLE, DRUM - LINING, *TABLE_ARC))
    parts = [lining, table, *add_web()]
    _, pieces = occ.fragment(parts, [])
    occ.synchronize()
    for name, chosen in (("lining", pieces[:1]), ("backing", pieces[1:2]), ("shoe", pieces[2:])):
        gmsh.model.addPhysicalGroup(2, [tag for found in chosen for _, tag in found], name=name)
    outer = gmsh.model.getBoundary(gmsh.model.getEntities(2), combined=True, oriented=False)
    lines: dict[str, list[int]] = {}
    for _, tag in outer:
        lines.setdefault(_curve_name(tag), []).append(tag)
    for name in ("contact", "hinge", "actuation"):
        gmsh.model.addPhysicalGroup(1, lines[name], name=name)
    _set_element_sizes(lines, refine)


def _curve_name(curve: int) -> str:
    """What a curve of the outline is, by its middle."""
    (low,), (high,) = gmsh.model.getParametrizationBounds(1, curve)
    x, y, _ = gmsh.model.getValue(1, curve, [0.5 * (low + high)])
    turn, r = math.radians(PIN_ANGLE), math.hypot(x, y)
    if abs(r - DRUM) < SLACK:
        return "contact"
    if r > DRUM - LINING + SLACK:
        return "lining ends"
    if abs(x * math.cos(turn) - y * math.sin(turn) - FACE_X) < SLACK:
        return "actuation"
    for i, (angle, distance, radius) in enumerate(HOLES):
        centre = polar_point(distance, angle)
        if abs(math.hypot(x - centre[0], y - centre[1]) - radius) < SLACK:
            return "holes" if i else "hinge"
    return "outline"


def _set_element_sizes(lines: dict[str, list[int]], refine: float) -> None:
    """Small elements at the lining's ends, in the lining, and around the holes.

    The pressure is singular at the lining's ends.
    """
    field = gmsh.model.mesh.field
    fields = []
    for curves, (near, within, beyond) in (
        (lines["lining ends"], SIZES["lining ends"]),
        (lines["contact"], SIZES["lining"]),
        (lines["hinge"] + lines["holes"], SIZES["holes"]),
    ):
        distance = field.add("Distance")
        field.setNumbers(distance, "CurvesList", curves)
        field.setNumber(distance, "Sampling", 200)
        threshold = field.add("Threshold")
        field.setNumber(threshold, "InField", distance)
        field.setNumber(threshold, "SizeMin", near / refine)
        field.setNumber(threshold, "SizeMax", LARGEST / refine)
        field.setNumber(threshold, "DistMin", within)
        field.setNumber(threshold, "DistMax", beyond)
        fields.append(threshold)
    least = field.add("Min")
    field.setNumbers(least, "FieldsList", fields)
    field.setAsBackgroundMesh(least)


def write_mesh(path: Path, refine: float = 1.0) -> None:
    """Mesh with curved triangles of second order and write `path`."""
    gmsh.initialize(readConfigFiles=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
        gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 0)
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 0)
        gmsh.model.add("web_shoe")
        build_geometry(refine)
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(2)
        gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
        gmsh.write(str(path))
    finally:
        gmsh.finalize()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Make the mesh of the web shoe.")
    parser.add_argument("--refine", type=float, default=1.0, help="divides every element size")
    parser.add_argument("--output", type=Path, default=Path(__file__).with_suffix(".msh"))
    arguments = parser.parse_args()
    write_mesh(arguments.output, arguments.refine)
