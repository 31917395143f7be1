"""Bodies on meshes: a parametric mesh of each shoe, or the mesh of its file, condensed."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.fields import AnyMaterial
from drumlin.fem.mesh.arc import shoe_mesh
from drumlin.fem.mesh.from_file import ShoeMesh
from drumlin.fem.preparation.bodies import Body, BodyNodes, coupled, load_on
from drumlin.fem.preparation.cache import Cache, bare, bare_shoe, content, shape_of, size_of
from drumlin.fem.preparation.scene import DividedBodies, Seconds, clock
from drumlin.fem.substructure.body import FRAME, Ties, condense, scalar_basis, stiffness, tie
from drumlin.fem.substructure.elasticity import layers_of
from drumlin.fem.substructure.interface import ContactLine, contact_line, end_loads
from drumlin.fem.substructure.loads import ACTUATION, LoadColumns
from drumlin.fem.substructure.ring import ring_body
from drumlin.response.response import own_edge_zone

ELEMENTS = 80
"""Default number along a lining. On most brakes p is then within about 0.2 % in L2 and the torque
within 1e-5. With half of it the errors of 22 random brakes are two and three times as large in the
median, with twice as many 0.7 and 0.5 times, at four times the work.
"""
MOST_ELEMENTS = 4000
"""Largest number along a lining: the dense matrices of its contact then fill 2 GB."""

Mesher = Callable[[Shoe, float], Any]
"""Makes the mesh of a shoe in its own frame, from the shoe and the drum's radius [m]."""


def on_meshes(
    brake: Brake,
    elements: int,
    kind: str,
    mesher: Mesher | None,
    cache: Cache,
    seconds: Seconds,
) -> DividedBodies:
    """The bodies of a brake on meshes; shoes of one shape share one body.

    Parameters
    ----------
    elements : number along each parametric lining, and along the linings' part of an elastic ring
    kind : "quad2", "quad1", "tri2" or "tri1"
    mesher : makes the mesh of a shoe without a file, in place of `shoe_mesh`; its bodies are not
        taken from the cache
    cache : bodies of earlier scenes, taken from there and put there
    seconds : time of each phase, which this adds to

    Raises
    ------
    BadInput
        for a number of elements out of range, and for a mesh file that cannot serve
    """
    if not 1 <= elements <= MOST_ELEMENTS:
        raise BadInput(f"--elements = {elements}: must be from 1 to {MOST_ELEMENTS}")
    cache = cache if mesher is None else Cache()
    mesher = mesher or partial(shoe_mesh, elements=elements, kind=kind)
    setting = (elements, kind)
    made: dict[tuple[object, ...], Body] = {}
    for shoe in brake.shoes:
        shape = shape_of(brake, shoe)
        if shape not in made:
            key = (bare_shoe(shoe), brake.size, brake.friction > 0, setting, content(shoe))
            make = partial(_body, brake, shoe, mesher, seconds)
            made[shape] = cache.get(key, make, size_of)
    bodies = tuple(made[shape_of(brake, shoe)] for shoe in brake.shoes)
    ring, ring_under = None, partial(ring_body, brake, elements)
    if brake.ring is not None:
        with clock(seconds, "ring"):
            lines = tuple(body.line for body in bodies)
            own = (bare(brake), setting, *map(content, brake.shoes))
            ring = cache.get(own, partial(ring_under, lines), size_of)
    return DividedBodies(bodies, ring, partial(_nodes_of, mesher, brake.size, bodies), ring_under)


def _nodes_of(
    mesher: Mesher, radius: float, bodies: tuple[Body, ...], i: int, shoe: Shoe
) -> BodyNodes:
    """As `Scene.nodes_of`, on meshes; one from a file is the same in the frame of any shoe."""
    mesh = mesher(shoe, radius) if shoe.mesh is None else bodies[i].mesh
    basis = scalar_basis(mesh)
    if "actuation" not in mesh.boundaries or shoe.gripped:
        return BodyNodes(basis.doflocs, np.zeros(basis.doflocs.shape))
    full, centre = end_loads(basis, mesh.boundaries["actuation"])
    return BodyNodes(basis.doflocs, (full @ load_on(centre, shoe)[0]).reshape(-1, 2).T)


@dataclass(frozen=True)
class Assembled:
    """One shoe with its lining, meshed and assembled, in its own frame: what condensation starts
    from.

    `K` (2 nodes, 2 nodes): stiffness; `loads`: the unit loads (unknowns, k) on the reduced unknowns
    of `ties`, by name; `load_centre` (2,) [m]: what those of the actuation act about.
    `of_file`: what was done to the mesh of a file.
    """

    mesh: Any
    basis: Any
    line: ContactLine
    K: Any
    ties: Ties
    loads: dict[str, Floats]
    load_centre: Floats
    of_file: ShoeMesh | None = None

    @cached_property
    def columns(self) -> LoadColumns:
        """Which load column is which load."""
        return LoadColumns.of(self.loads)


def line_of(basis: Any, facets: Ints, shoe: Shoe, radius: float) -> ContactLine:
    """The contact line of a shoe on the `facets` of a scalar basis; radius [m]: of the drum."""
    return contact_line(
        basis, facets, sum(shoe.arc) / 2, radius if shoe.flat else None, own_edge_zone(shoe, radius)
    )


def assemble(brake: Brake, shoe: Shoe, mesher: Mesher, seconds: Seconds) -> Assembled:
    """Mesh and assemble a shoe. Raises BadInput for a mesh file that cannot serve."""
    of_file = None
    with clock(seconds, "mesh"):
        if shoe.mesh is None:
            mesh = mesher(shoe, brake.size)
        else:
            from drumlin.fem.mesh.file import read_shoe_mesh  # noqa: PLC0415  (meshio: 0.1 s, for a mesh in a file only)

            of_file = read_shoe_mesh(shoe.mesh, shoe, brake.size, f"shoe {shoe.name!r}: mesh")
            mesh = of_file.mesh
        basis = scalar_basis(mesh)
    with clock(seconds, "assembly"):
        K = stiffness(basis, layers_of(shoe))
    with clock(seconds, "ties"):
        pin = shoe.own_pin
        line = line_of(basis, mesh.boundaries["contact"], shoe, brake.size)
        rigid = basis.get_dofs(mesh.boundaries["hinge"]).flatten()
        ties = tie(basis, line.nodes, rigid, pin)
        if "actuation" in mesh.boundaries and not shoe.gripped:
            full, load_centre = end_loads(basis, mesh.boundaries["actuation"])
            actuated = ties.matrix.T @ full
        else:  # the force acts on the rigid shoe itself, or on what holds the back of the body
            actuated, load_centre = np.zeros((ties.matrix.shape[1], FRAME)), pin
            actuated[-FRAME:] = np.eye(FRAME)
    return Assembled(mesh, basis, line, K, ties, {ACTUATION: actuated}, load_centre, of_file)


def _body(brake: Brake, shoe: Shoe, mesher: Mesher, seconds: Seconds) -> Body:
    parts = assemble(brake, shoe, mesher, seconds)
    with clock(seconds, "condensation"):
        condensed = condense(parts.K, parts.ties, parts.loads, 2 * len(parts.line.nodes))
    made = partial(Body, parts.mesh, parts.basis, parts.line, of_file=parts.of_file)
    with clock(seconds, "coupling"):
        return coupled(
            made, shoe, parts.line, condensed, parts.load_centre, friction=brake.friction > 0
        )


def materials_of(shoe: Shoe) -> dict[str, tuple[AnyMaterial, float]]:
    """Material and width [m] of each subdomain of a shoe."""
    parts: dict[str, tuple[AnyMaterial, float]] = {
        "lining": (shoe.lining.material, shoe.lining.width)
    }
    if shoe.backing is not None:
        parts["backing"] = (shoe.backing.material, shoe.lining.width)
    if shoe.body is not None:
        parts |= {name: (plate.material, plate.width) for name, plate in shoe.body.plates.items()}
    return parts
