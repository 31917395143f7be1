"""A brake made ready for contact: meshed, assembled and condensed bodies."""

import math
import time
from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Beam
from drumlin.brake.fields import AnyMaterial, Point
from drumlin.fem.mesh import beam as beam_mesh
from drumlin.fem.mesh.arc import DEFAULT_KIND, shoe_mesh
from drumlin.fem.mesh.content import content_digest
from drumlin.fem.substructure.body import (
    FRAME,
    Condensed,
    Ties,
    condense,
    scalar_basis,
    stiffness,
    tie,
)
from drumlin.fem.substructure.elasticity import layers_of
from drumlin.fem.substructure.interface import (
    ContactLine,
    Coupling,
    contact_line,
    end_loads,
    radial,
    straight,
)
from drumlin.fem.substructure.ring import RingBody, ring_body
from drumlin.laws import rigid
from drumlin.response.response import own_edge_zone

ELEMENTS = 80
"""Default number along a lining. On most brakes p is then within about 0.2 % in L2 and the torque
within 1e-5. With half of it the errors of 22 random brakes are two and three times as large in the
median, with twice as many 0.7 and 0.5 times, at four times the work.
"""
MOST_ELEMENTS = 4000  # along a lining: the dense contact matrices fill 2 GB
ROOM = 200_000_000  # bytes of bodies that are kept for the next scenes

Seconds = dict[str, float]
Mesher = Callable[[Shoe, float], Any]  # shoe, drum radius [m] -> mesh in the shoe's frame


@contextmanager
def clock(seconds: Seconds, phase: str) -> Iterator[None]:
    """Add the time of the block to seconds[phase]."""
    start = time.perf_counter()
    yield
    seconds[phase] = seconds.get(phase, 0.0) + time.perf_counter() - start


@dataclass(frozen=True)
class Body:
    """One shoe with its lining, condensed, in its own frame (angle phi from the hinge).

    With the frame held, under the nodal forces -N^T and T^T and the unit actuations (force x, force
    y, couple about `load_centre`): `closing_pressed`, `closing_dragged` (n, n) and `closing_loaded`
    (n, 3) are N times the contact displacements, what they take from the weighted gap;
    `tip_dragged` (3, n) and `tip_loaded` (3, 3) what the unit actuations move along; `held_*` (3,
    ...) the force x, y and moment that hold the frame meanwhile. The dragged ones are None where mu
    = 0. `turned` (2n,): contact displacement per turn [rad] about the pin.
    """

    mesh: Any
    basis: Any
    line: ContactLine
    coupling: Coupling
    condensed: Condensed
    load_centre: Floats
    turned: Floats
    closing_pressed: Floats
    closing_dragged: Floats | None
    closing_loaded: Floats
    tip_dragged: Floats | None
    tip_loaded: Floats
    held_pressed: Floats
    held_dragged: Floats | None
    held_loaded: Floats

    @property
    def unknowns(self) -> int:
        """Number of displacement unknowns of the mesh."""
        return int(2 * self.basis.N)

    @cached_property
    def turning(self) -> tuple[Floats, Floats]:
        """N u and T u (n, 1) of a turn by one radian."""
        return self.coupling.N @ self.turned[:, None], self.coupling.T @ self.turned[:, None]

    @cached_property
    def forces(self) -> Floats:
        """Force x, y and moment about the centre (2, 3, n) of the nodal forces N^T and T^T."""
        (x, y), none, ones = (
            self.line.xy,
            np.zeros(self.line.xy.shape[1]),
            np.ones(self.line.xy.shape[1]),
        )
        rigid = np.array([[ones, none], [none, ones], [-y, x]]).transpose(0, 2, 1).reshape(3, -1)
        return np.array([rigid @ self.coupling.N.T, rigid @ self.coupling.T.T])


class BodyNodes(NamedTuple):
    """The nodes of a body: points `xy` (2, nodes) [m], and the force `load` (2, nodes) [1] on each
    per newton of the actuation, where this acts on the body itself; both in the shoe's frame."""

    xy: Floats
    load: Floats


@dataclass(frozen=True)
class Scene:
    """A brake made ready: a condensed body for each shoe (equal shoes share one) and the ring, if
    it has one.

    `apart`: each shoe meets the ring as if the others did not press it. `model`: whose bodies they
    are. Where the bodies can be divided anew by the rule that divided them: `nodes_of`(i, shoe),
    the nodes of the body that shoe i would have as another shoe, and `ring_under`(lines), the ring
    under other contact lines.
    """

    brake: Brake
    bodies: tuple[Body, ...]
    ring: RingBody | None
    seconds: Seconds
    left_out: tuple[str, ...]
    apart: bool = False
    model: str = "fem"
    nodes_of: Callable[[int, Shoe], BodyNodes] | None = None
    ring_under: Callable[[tuple[ContactLine, ...]], RingBody] | None = None

    @cached_property
    def shapes(self) -> list[tuple[object, ...]]:
        """The shape of each shoe, see `shape_of`."""
        return [shape_of(self.brake, shoe) for shoe in self.brake.shoes]

    @cached_property
    def laws(self) -> list[float]:
        """mu_lock of each shoe by the rigid-shoe law."""
        return [rigid.locking_friction(self.brake, shoe) for shoe in self.brake.shoes]


def why_not(brake: Brake) -> str | None:
    """Why finite elements do not apply to a brake (None: they do)."""
    if brake.unmeshable() is not None:
        return brake.unmeshable()
    if brake.ring is not None and len({shoe.side for shoe in brake.shoes}) > 1:
        return "shoes inside and outside of one elastic ring are not modelled"
    if brake.ring is not None and brake.ring.section is None:
        return "its ring has no section to mesh: thickness, and width and material or bending_stiffness"
    for shoe in brake.shoes:
        reason = beam_mesh.why_not(shoe, brake.size)
        if reason is not None:
            return f"shoe {shoe.name!r}: {reason}"
    return None


def shape_of(brake: Brake, shoe: Shoe) -> tuple[object, ...]:
    """What a body depends on: equal for shoes that are the same but for place, hand, load and
    clearance.
    """
    arcs, lining, body = [shoe.arc], shoe.lining, shoe.body
    behind: tuple[object, ...] | None = None
    if isinstance(body, Beam):
        loaded = np.round(shoe.frame.to_shoe(shoe.actuation.point.xy) / brake.size, 12)
        behind = (body, *loaded.tolist())
    elif body is not None:
        first, last = sorted(shoe.frame.phis((body.start, body.end)))
        arcs.append((first, last))
        behind = (body.shape, tuple(body.plates.items()))
        arcs += [arc for arc in [shoe.grip(brake.size)] if arc is not None]
    return (
        brake.size,
        shoe.side,
        tuple(np.round(shoe.own_pin / brake.size, 12).tolist()),
        tuple(round(angle, 12) for arc in arcs for angle in arc),
        (lining.thickness, lining.width, lining.material),
        shoe.backing,
        behind,
        None
        if shoe.mesh is None
        else (shoe.mesh, shoe.mesh_unit, shoe.mesh_frame == "shoe" or shoe.frame),
    )


def alike(brake: Brake) -> tuple[int, ...]:
    """For each shoe the place of the first one of its shape, with which it shares a body."""
    shapes = [shape_of(brake, shoe) for shoe in brake.shoes]
    return tuple(map(shapes.index, shapes))


class Cache:
    """Bodies that were made last, by what they were made from, so that the next scenes need not
    make them again.

    A body depends on its key alone, never on what else was made before. `room` [bytes]: beyond it
    the body that was used longest ago goes first; the one in use always stays. (functools.lru_cache
    counts entries, not bytes.)
    """

    def __init__(self, room: int = ROOM) -> None:
        self._room, self._taken, self._values = room, 0, OrderedDict[Hashable, tuple[int, Any]]()

    def get(self, key: Hashable, make: Callable[[], Any], size: Callable[[Any], int]) -> Any:
        """The value of `key`: kept, or else made by `make` and kept; size(value) [bytes]."""
        kept = self._values.pop(key, None)
        if kept is None:
            value = make()
            kept = size(value), value
            self._taken += kept[0]
        self._values[key] = kept  # as the last
        while len(self._values) > 1 and self._taken > self._room:
            self._taken -= self._values.popitem(last=False)[1][0]
        return kept[1]


def content(shoe: Shoe) -> str | None:
    """A digest of a shoe's mesh file, which may change under its name."""
    return None if shoe.mesh is None else content_digest(shoe.mesh)


def bare(brake: Brake) -> Brake:
    """The brake without what its bodies do not depend on, so that brakes with equal bodies are
    equal.

    Removed: title, rotation, size of the friction (but for 0), forces, clearances and misfits.
    """
    return brake.bare().model_copy(update={"shoes": tuple(bare_shoe(shoe) for shoe in brake.shoes)})


def bare_shoe(shoe: Shoe) -> Shoe:
    """The shoe without what its body does not depend on; see `bare`."""
    force: dict[str, Any] = {"force": 1.0, "direction": 0.0}
    ends_there = (
        isinstance(shoe.body, Beam) or shoe.guide is not None
    )  # a beam where it is loaded; a guide's pin
    if not ends_there:
        force["point"] = Point(x=0.0, y=0.0)
    return shoe.model_copy(
        update={
            "lining": shoe.lining.model_copy(
                update={"clearance": 0.0, "misfit": type(shoe.lining.misfit)()}
            ),
            "actuation": shoe.actuation.model_copy(update=force),
        }
    )


def prepare(
    brake: Brake,
    *,
    elements: int = ELEMENTS,
    kind: str = DEFAULT_KIND,
    mesher: Mesher | None = None,
    cache: Cache | None = None,
) -> Scene:
    """Mesh and condense the bodies of a brake; shoes of one shape share one body.

    elements: number along each parametric lining; kind: "quad2", "quad1", "tri2" or "tri1"; mesher:
    what makes the mesh of a shoe without a file in the place of shoe_mesh: `elements` then count
    for an elastic ring only. cache: bodies of earlier scenes, taken from there and put there; not
    with a mesher. Raises BadInput for a brake that finite elements do not cover, and for a mesh
    file that cannot serve.
    """
    reason = why_not(brake)
    if reason is not None:
        raise BadInput(f"fem does not apply to this brake: {reason}")
    if not 1 <= elements <= MOST_ELEMENTS:
        raise BadInput(f"--elements = {elements}: must be from 1 to {MOST_ELEMENTS}")
    seconds: Seconds = {}
    made: dict[tuple[object, ...], Body] = {}
    bodies = []
    cache = Cache() if cache is None or mesher is not None else cache
    mesher = mesher or partial(shoe_mesh, elements=elements, kind=kind)
    setting = (elements, kind)
    for shoe in brake.shoes:
        key = shape_of(brake, shoe)
        if key not in made:
            made[key] = cache.get(
                (bare_shoe(shoe), brake.size, brake.friction > 0, setting, content(shoe)),
                partial(_body, brake, shoe, mesher, seconds),
                size_of,
            )
        bodies.append(made[key])
    ring = None
    ring_under = partial(ring_body, brake, elements)
    left_out = ["interior fields: recovered only for a picture"]
    if brake.ring is not None:
        with clock(seconds, "ring"):
            lines = tuple(body.line for body in bodies)
            key = (bare(brake), setting, *map(content, brake.shoes))
            ring = cache.get(key, partial(ring_under, lines), size_of)
    if len(made) < len(bodies):
        left_out.append(
            f"{len(bodies) - len(made)} of {len(bodies)} shoes: same shape as another, condensed once"
        )
    if brake.friction == 0:
        left_out.append("friction: mu = 0, symmetric, without the flexibility under drag")
    return Scene(
        brake,
        tuple(bodies),
        ring,
        seconds,
        (*left_out, *lacking(brake)),
        nodes_of=partial(_nodes_of, mesher, brake.size, tuple(bodies)),
        ring_under=ring_under,
    )


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


def lacking(brake: Brake) -> list[str]:
    """What is not computed because the brake has it not, in words."""
    rigid_drum = brake.ring is None and not brake.surface.straight
    drum = ["drum: rigid, no [drum.ring] in the brake"] if rigid_drum else []
    return drum + [
        f"shoe {shoe.name!r}: rigid, no [shoe.body]; only its lining is meshed"
        for shoe in brake.shoes
        if shoe.mesh is None and shoe.body is None
    ]


def size_of(body: Body | RingBody) -> int:
    """What a condensed body keeps, about: its matrices."""
    n = len(body.line.nodes)
    return 8 * (4 + 2) * n**2 + 400 * 2 * int(body.basis.N)


@dataclass(frozen=True)
class Assembled:
    """One shoe with its lining, meshed and assembled, in its own frame: what condensation starts
    from.

    `K` (2 nodes, 2 nodes): stiffness; `loads` (unknowns, 3): the unit actuations on the reduced
    unknowns of `ties`.
    """

    mesh: Any
    basis: Any
    line: ContactLine
    K: Any
    ties: Ties
    loads: Floats
    load_centre: Floats


def line_of(basis: Any, facets: Ints, shoe: Shoe, radius: float) -> ContactLine:
    """The contact line of a shoe on the `facets` of a scalar basis; radius [m]: of the drum."""
    return contact_line(
        basis, facets, sum(shoe.arc) / 2, radius if shoe.flat else None, own_edge_zone(shoe, radius)
    )


def assemble(brake: Brake, shoe: Shoe, mesher: Mesher, seconds: Seconds) -> Assembled:
    """Mesh and assemble a shoe. Raises BadInput for a mesh file that cannot serve."""
    with clock(seconds, "mesh"):
        if shoe.mesh is None:
            mesh = mesher(shoe, brake.size)
        else:
            from drumlin.fem.mesh.file import read_mesh  # noqa: PLC0415  (meshio: 0.1 s, for a mesh in a file only)

            mesh = read_mesh(shoe.mesh, shoe, brake.size, f"shoe {shoe.name!r}: mesh")
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
            loads = ties.matrix.T @ full
        else:  # the force acts on the rigid shoe itself, or on what holds the back of the body
            loads, load_centre = np.zeros((ties.matrix.shape[1], 3)), pin
            loads[-FRAME:] = np.eye(3)
    return Assembled(mesh, basis, line, K, ties, loads, load_centre)


def _body(brake: Brake, shoe: Shoe, mesher: Mesher, seconds: Seconds) -> Body:
    parts = assemble(brake, shoe, mesher, seconds)
    with clock(seconds, "condensation"):
        condensed = condense(parts.K, parts.ties, parts.loads, 2 * len(parts.line.nodes))
    made = partial(Body, parts.mesh, parts.basis, parts.line)
    with clock(seconds, "coupling"):
        return coupled(
            made, shoe, parts.line, condensed, parts.load_centre, friction=brake.friction > 0
        )


def coupling_of(line: ContactLine, shoe: Shoe) -> Coupling:
    """The coupling of a shoe's contact line with the drum or the plane."""
    return line.couple(shoe.lining.width, straight if shoe.flat else radial(shoe.sign))


def coupled(
    made: Callable[..., Body],
    shoe: Shoe,
    line: ContactLine,
    condensed: Condensed,
    centre: Floats,
    *,
    friction: bool,
) -> Body:
    """The condensed body of a shoe, coupled with the drum along its contact line; `made` takes the
    rest of a Body.
    """
    n = len(line.nodes)
    coupling = coupling_of(line, shoe)
    forces = [-coupling.N.T, condensed.load_c] + ([coupling.T.T] if friction else [])
    Y = condensed.half(np.concatenate(forces, axis=1))
    closing, holding = -Y[:, :n].T @ Y, condensed.L_fc @ Y
    pressed, loaded, dragged = slice(n), slice(n, n + 3), slice(n + 3, None)
    x, y = line.xy - shoe.own_pin[:, None]
    return made(
        coupling=coupling,
        condensed=condensed,
        load_centre=centre,
        turned=np.array([-y, x]).T.ravel(),
        closing_pressed=closing[:, pressed],
        closing_loaded=closing[:, loaded],
        closing_dragged=closing[:, dragged] if friction else None,
        tip_dragged=Y[:, loaded].T @ Y[:, dragged] if friction else None,
        tip_loaded=Y[:, loaded].T @ Y[:, loaded] + condensed.load_work,
        held_pressed=holding[:, pressed],
        held_loaded=holding[:, loaded] - condensed.load_f,
        held_dragged=holding[:, dragged] if friction else None,
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


def actuation(body: Body | Assembled, shoe: Shoe) -> tuple[Floats, float]:
    """Factors (3,) of the body's unit actuations, and the moment about the pin [m], per newton of
    force.

    In the shoe's frame; a negative force counts as one newton the other way.
    """
    return load_on(body.load_centre, shoe)


def load_on(centre: Floats, shoe: Shoe) -> tuple[Floats, float]:
    """As `actuation`, with the unit actuations at a `centre` (2,) [m] in the shoe's frame."""
    direction = math.copysign(1.0, shoe.actuation.force) * shoe.actuation.direction_vector
    (fx, fy), (x, y) = (
        shoe.frame.to_shoe(direction).tolist(),
        shoe.own_points(shoe.actuation.point.xy).tolist(),
    )
    (centre_x, centre_y), (pin_x, pin_y) = centre.tolist(), shoe.own_pin.tolist()
    couple_ = (x - centre_x) * fy - (y - centre_y) * fx
    return np.array([fx, fy, couple_]), (x - pin_x) * fy - (y - pin_y) * fx


def held(body: Body, p: Floats, drag: float, load: Floats) -> Floats:
    """Force x, y and moment about the pin (3,) that hold the frame, under p (n,), drag mu s and
    load (3,).
    """
    forces = body.held_pressed @ p + body.held_loaded @ load
    return forces if body.held_dragged is None else forces + drag * (body.held_dragged @ p)


def contact_stiffness(shoe: Shoe, penalty: float) -> float:
    """eps = penalty E/t of the lining, the contact's stiffness per area [Pa/m]; E through its
    thickness."""
    return penalty * shoe.lining.material.E_through / shoe.lining.thickness
