"""Fine meshes with a grading of their own, of triangles or quadrilaterals: references for pressure and torque."""

import math
from itertools import pairwise

import numpy as np
import skfem

from drumlin.fem.model import respond
from drumlin.fem.scene import prepare

FAMILIES = {"triangles": (skfem.MeshTri, skfem.MeshTri2), "quadrilaterals": (skfem.MeshQuad, skfem.MeshQuad2)}


def reference(brake, ends, family, **grading):
    """Response with exact contact on a fine mesh graded to the contact `ends` (phi of the shoes' own frame)."""
    scene = prepare(brake, mesher=lambda shoe, radius: fine(shoe, radius, ends, family, **grading))
    return respond(scene, brake, penalty=math.inf)


def geometric(start, end, smallest, ratio, largest):
    """Points from start to end; from either end steps grow by `ratio` from `smallest` up to `largest`."""
    half, points, step = (end - start) / 2, [0.0], min(smallest, (end - start) / 4)
    while points[-1] < half:
        points.append(points[-1] + step)
        step = min(step * ratio, largest)
    x = np.array(points) * half / points[-1]
    return np.concatenate([start + x, end - x[-2::-1]])


def from_start(length, smallest, ratio, largest):
    """Points from 0 to `length`, graded to 0 only."""
    points = geometric(0, 2 * length, smallest, ratio, largest)
    return points[: len(points) // 2 + 1]


def fine(shoe, radius, ends, family, smallest=5e-5, ratio=1.15, largest=0.01, layer=0.004, growth=1.5, thickest=0.15):
    """Mesh of a shoe with an elastic body; sizes along the arc in rad, through the lining as parts of its thickness."""
    bare, quadratic = FAMILIES[family]
    start, end = shoe.arc
    t, h = shoe.lining.thickness, shoe.body.thickness
    places = [start, *ends, end]
    pieces = [geometric(a, b, smallest, ratio, largest)[:-1] for a, b in pairwise(places)]
    near, far = np.sort(shoe.frame.phi(np.array([shoe.body.start, shoe.body.end])))
    before = start - from_start(start - near, smallest, ratio, largest)[:0:-1]
    after = end + from_start(far - end, smallest, ratio, largest)[1:]
    angles = np.concatenate([before, *pieces, [end], after])
    depths = np.concatenate(
        [t * geometric(0, 1, layer, growth, thickest), t + from_start(h, layer * t, growth, h / 7)[1:]]
    )
    grid = bare.init_tensor(depths, angles)
    depth, phi = grid.p[:, grid.t].mean(axis=1)
    grid = grid.restrict(np.flatnonzero((depth > t) | ((phi > start) & (phi < end))))
    depth, _ = grid.p[:, grid.t].mean(axis=1)
    across, along = grid.p[:, grid.facets].mean(axis=1)
    outer = np.isin(np.arange(grid.nfacets), grid.boundary_facets())
    behind = outer & (across > t)
    groups = {
        "contact": outer & (across < 1e-12),
        "hinge": behind & (np.abs(along - min(near, far, key=abs)) < 1e-9),
        "actuation": behind & (np.abs(along - max(near, far, key=abs)) < 1e-9),
    }
    mesh = quadratic.from_mesh(grid)
    r, phi = radius - shoe.sign * mesh.doflocs[0], mesh.doflocs[1]
    return quadratic(
        np.array([r * np.cos(phi), r * np.sin(phi)]),
        mesh.t,
        _subdomains={"lining": np.flatnonzero(depth < t), "shoe": np.flatnonzero(depth > t)},
        _boundaries={name: np.flatnonzero(where) for name, where in groups.items()},
    )
