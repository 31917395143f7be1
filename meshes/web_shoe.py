"""Makes web_shoe.msh: the shoe of a car's drum brake, a table and a web with holes, its lining bonded on.

    python meshes/web_shoe.py [--refine N] [--output FILE]

Needs gmsh (pip install 'drumlin[meshing]'). Lengths in mm; the frame is the shoe's own: the drum's centre is
the origin, the pin lies on the +x axis, the lining at growing angle. N divides every element size.
"""

import argparse
import math
from pathlib import Path

import gmsh

DRUM, LINING, TABLE, WEB = 150.0, 8.0, 3.0, 28.0  # radius of the drum; radial thicknesses of the layers
PIN, PIN_HOLE = 125.0, 6.0  # distance of the pin from the centre; radius of its hole
LINING_ARC = (5.0, 130.0)  # deg from the pin
TABLE_ARC = (3.0, 132.0)
WEB_END = 125.0  # deg: where the web's inner edge ends
FACE_X, FACE_Y = 58.0, (93.0, 107.0)  # the cylinder pushes on this upright face, in the brake with the pin at -75 deg
PIN_ANGLE = -75.0
HOLES = {  # deg from the pin, distance from the centre, radius
    "lightening": [(30.0, 123.5, 8.0), (62.0, 123.5, 8.0), (96.0, 123.5, 8.0)],
    "spring": [(117.0, 123.5, 3.0)],
}
SIZES = {"lining": 2.8, "lining ends": 0.5, "holes": 2.6, "web": 5.5}


def point(radius: float, angle: float) -> int:
    """A point by polar coordinates [mm, deg]."""
    a = math.radians(angle)
    return int(gmsh.model.occ.addPoint(radius * math.cos(a), radius * math.sin(a), 0))


def sector(inner: float, outer: float, start: float, end: float) -> int:
    """A sector of a ring [mm, deg]."""
    occ = gmsh.model.occ
    centre = occ.addPoint(0, 0, 0)
    corners = [point(inner, start), point(outer, start), point(outer, end), point(inner, end)]
    lines = [
        occ.addLine(corners[0], corners[1]),
        occ.addCircleArc(corners[1], centre, corners[2]),
        occ.addLine(corners[2], corners[3]),
        occ.addCircleArc(corners[3], centre, corners[0]),
    ]
    return int(occ.addPlaneSurface([occ.addCurveLoop(lines)]))


def web() -> list[tuple[int, int]]:
    """The web: an eye about the pin, a ring sector, a nose with the upright face; cut out: the holes."""
    occ = gmsh.model.occ
    outer = DRUM - LINING - TABLE
    inner = outer - WEB
    parts = [(2, occ.addDisk(PIN, 0, 0, WEB / 2, WEB / 2)), (2, sector(inner, outer, 0, WEB_END))]
    turn = math.radians(-PIN_ANGLE)  # from the brake to the shoe's frame

    def turned(x: float, y: float) -> int:
        return int(occ.addPoint(x * math.cos(turn) - y * math.sin(turn), x * math.sin(turn) + y * math.cos(turn), 0))

    corners = [
        point(inner, WEB_END),
        point(outer, WEB_END),
        point(outer, TABLE_ARC[1]),
        turned(FACE_X, FACE_Y[1]),
        turned(FACE_X, FACE_Y[0]),
    ]
    edges = [occ.addLine(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    nose = [(2, occ.addPlaneSurface([occ.addCurveLoop([edges[0], *edges[1:]])]))]
    # the nose's outer edge must follow the table
    nose, _ = occ.fuse(nose, [(2, sector(outer - WEB / 2, outer, WEB_END - 1, TABLE_ARC[1]))])
    whole, _ = occ.fuse(parts, nose)
    holes = [(2, occ.addDisk(PIN, 0, 0, PIN_HOLE, PIN_HOLE))]
    for angle, distance, radius in (hole for group in HOLES.values() for hole in group):
        a = math.radians(angle)
        holes.append((2, occ.addDisk(distance * math.cos(a), distance * math.sin(a), 0, radius, radius)))
    whole, _ = occ.cut(whole, holes)
    return [(int(dim), int(tag)) for dim, tag in whole]


def build(refine: float) -> None:
    """Geometry, named groups and sizes in the current gmsh model."""
    occ = gmsh.model.occ
    lining = (2, sector(DRUM - LINING, DRUM, *LINING_ARC))
    table = (2, sector(DRUM - LINING - TABLE, DRUM - LINING, *TABLE_ARC))
    parts = [lining, table, *web()]
    _, pieces = occ.fragment(parts, [])
    occ.synchronize()
    names = ["lining", "backing"] + ["shoe"] * (len(parts) - 2)
    for name in dict.fromkeys(names):
        members = [tag for part, found in zip(names, pieces, strict=True) if part == name for _, tag in found]
        gmsh.model.addPhysicalGroup(2, members, name=name)
    outer = [abs(tag) for _, tag in gmsh.model.getBoundary(gmsh.model.getEntities(2), combined=True)]
    groups: dict[str, list[int]] = {"contact": [], "hinge": [], "actuation": [], "holes": []}
    ends = []
    for tag in dict.fromkeys(outer):
        x, y, _ = occ.getCenterOfMass(1, tag)
        low, high = gmsh.model.getParametrizationBounds(1, tag)
        xyz = gmsh.model.getValue(1, tag, [low[0], 0.5 * (low[0] + high[0])])
        radii = [math.hypot(*xyz[i : i + 2]) for i in (0, 3)]
        from_pin = [math.hypot(xyz[i] - PIN, xyz[i + 1]) for i in (0, 3)]
        turn = math.radians(PIN_ANGLE)
        brake_x = [xyz[i] * math.cos(turn) - xyz[i + 1] * math.sin(turn) for i in (0, 3)]
        if all(abs(r - DRUM) < 1e-6 for r in radii):
            groups["contact"].append(tag)
        elif all(abs(d - PIN_HOLE) < 1e-6 for d in from_pin):
            groups["hinge"].append(tag)
        elif all(abs(bx - FACE_X) < 1e-6 for bx in brake_x):
            groups["actuation"].append(tag)
        elif (
            gmsh.model.getType(1, tag) == "Circle"
            and math.hypot(x, y) < DRUM - LINING - TABLE - 1
            and any(
                math.hypot(x - d * math.cos(math.radians(a)), y - d * math.sin(math.radians(a))) < 1e-3
                for group in HOLES.values()
                for a, d, _ in group
            )
        ):
            groups["holes"].append(tag)
        elif min(radii) > DRUM - LINING + 1e-6:
            ends.append(tag)
    for name in ("contact", "hinge", "actuation"):
        gmsh.model.addPhysicalGroup(1, groups[name], name=name)
    _sizes(lining, groups, ends, refine)


def _sizes(lining: tuple[int, int], groups: dict[str, list[int]], ends: list[int], refine: float) -> None:
    """Small elements at the lining's ends, where the pressure is singular, in the lining, and around the holes."""
    field = gmsh.model.mesh.field
    fields = []
    for curves, near, far, reach in (
        (ends, SIZES["lining ends"], SIZES["web"], 25.0),
        (groups["contact"], SIZES["lining"], SIZES["web"], 30.0),
        (groups["holes"] + groups["hinge"], SIZES["holes"], SIZES["web"], 12.0),
    ):
        distance = field.add("Distance")
        field.setNumbers(distance, "CurvesList", curves)
        field.setNumber(distance, "Sampling", 200)
        threshold = field.add("Threshold")
        field.setNumber(threshold, "InField", distance)
        field.setNumber(threshold, "SizeMin", near / refine)
        field.setNumber(threshold, "SizeMax", far / refine)
        field.setNumber(threshold, "DistMin", 0.0 if curves is ends else 4.0)
        field.setNumber(threshold, "DistMax", reach)
        fields.append(threshold)
    least = field.add("Min")
    field.setNumbers(least, "FieldsList", fields)
    field.setAsBackgroundMesh(least)


def make(path: Path, refine: float = 1.0) -> None:
    """Mesh with curved triangles of second order and write `path`."""
    gmsh.initialize(readConfigFiles=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
        gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 0)
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 0)
        gmsh.model.add("web_shoe")
        build(refine)
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
    make(arguments.output, arguments.refine)
