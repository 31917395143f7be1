"""Running a brake in: its linings worn by Archard's law, from the elastic pressure of the new to the law of the rigid.

Whatever the elasticity, wear ends where every point of the lining wears as fast as the rigid motions of the shoe close
the gap, p ~ approach^(1/m) with the exponent m of the wear law: for m = 1 sin(phi) of a hinged shoe, cos(phi) about
its direction of a guided one, A cos + B sin of one on a pivot of a lever. What remains of elasticity then stands in
the worn shape. The clearance of `worn` is that shape: every model solves the worn brake as it solves any other.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Literal, NamedTuple

import numpy as np
import scipy.optimize

from drumlin import contact, wear
from drumlin.arrays import Floats
from drumlin.brake import Brake, Shoe
from drumlin.brakefile import vary
from drumlin.errors import BadInput, NoAnswer
from drumlin.fem.model import contact_problem, gap_of, turns_towards, unit_force
from drumlin.fem.scene import Body, Scene
from drumlin.foundation import model as foundation
from drumlin.foundation.post import shoe_angles
from drumlin.laws.hinged import pressing_moment
from drumlin.statics import cross, gauss_points
from drumlin.wear import Law, Rub, State

COEFFICIENT = 1e-14
"""k [1/Pa] where none is given: 1e-5 mm^3/(N m), the order of organic linings. In units of 1/(k E/t) nothing depends
on it, nor does the part of life."""
WORN_OUT = 0.8  # part of the lining's thickness that may wear off
Guide = Literal["hinge", "radius"]
SETTLED = 1e-3


class Surface(NamedTuple):
    """The lining of shoe `shoe` among the unknowns of its rig.

    `part`: its unknowns in all, `local`: in its rub, number `rub`; `rows`: its rows of that rub's C; `theta` (n,) [rad]
    and `forward`: the slice that makes it grow; `order` of the interpolation; `approach` (n, k): closing of the gap
    per unit of each rigid motion.
    """

    shoe: int
    name: str
    rub: int
    part: slice
    local: slice
    rows: slice
    theta: Floats
    forward: slice
    order: int
    approach: Floats

    def along(self, values: Floats) -> Floats:
        """Values (n,) of this lining, by growing theta, of those of all unknowns."""
        return values[self.part][self.forward]

    @property
    def angles(self) -> Floats:
        """theta (n,) [rad], growing."""
        return self.theta[self.forward]


class Rig(NamedTuple):
    """A brake ready to be worn in: its rubs, and where each lining lies in them."""

    brake: Brake
    model: str
    rubs: tuple[Rub, ...]
    surfaces: tuple[Surface, ...]

    @property
    def stiffness(self) -> float:
        """K = E/t of the first lining that touches [Pa/m]; 1/(k K) is the unit of sliding distance."""
        lining = self.brake.shoes[self.surfaces[0].shoe].lining
        return lining.material.E / lining.thickness


class Motions(NamedTuple):
    """Rigid motions of a shoe, in its frame: contact displacements (2n, k), and the actuation's work on each (k,)."""

    moved: Floats
    work: Floats


def fem_rig(scene: Scene, brake: Brake, *, penalty: float = math.inf, guide: Guide = "hinge") -> Rig:
    """The rig of a brake on a prepared scene of finite elements.

    guide: "hinge", the shoes turn about their hinges, and rigid ones about their pivots too; "radius", rigid shoes
    that move along the middle radius of their linings, the guide bearing what else acts on them.
    Raises BadInput, and NoAnswer where no shoe touches.
    """
    special = guide == "radius" or any(shoe.pivot for shoe in brake.shoes)
    if special and (scene.ring is not None or any(shoe.body or shoe.mesh for shoe in brake.shoes)):
        raise BadInput("a shoe on a guide or a pivot is worn in as a rigid one: leave out [shoe.body] and [drum.ring]")
    motions = [motions_of(body, shoe, guide) for body, shoe in zip(scene.bodies, brake.shoes, strict=True)]
    pressing = [
        turns_towards(body, shoe) if guide == "hinge" else bool(moves.work[0] > 0)
        for body, shoe, moves in zip(scene.bodies, brake.shoes, motions, strict=True)
    ]
    touching = [i for i, presses in enumerate(pressing) if presses]
    rubs, surfaces = [], list[Surface]()
    for group in [[i] for i in touching] if scene.ring is None else [touching] if touching else []:
        bodies = [scene.bodies[i] for i in group]
        size = unit_force(brake, group)
        problem = contact_problem(scene, brake, group, penalty)
        problem = problem._replace(q=size * problem.q, h=size * problem.h)  # newtons
        if special:
            problem = _moving(problem, bodies[0], brake, brake.shoes[group[0]], motions[group[0]])
        weight = scipy.linalg.block_diag(*(body.coupling.M for body in bodies))
        gap = np.concatenate([gap_of(body, brake, brake.shoes[i]) for i, body in zip(group, bodies, strict=True)])
        placed = [
            (i, brake.shoes[i].frame.theta(body.line.phi), body.line.order, _approach(body, brake.shoes[i], motions[i]))
            for i, body in zip(group, bodies, strict=True)
        ]
        surfaces += _surfaces(brake, surfaces, len(rubs), placed)
        rubs.append(
            Rub(
                problem=problem,
                loaded=problem.q - weight @ gap,
                weight=weight,
                pressure=np.ones(len(gap)),
                area=np.concatenate([body.coupling.area for body in bodies]),
                torque=brake.friction * np.concatenate([body.coupling.lever for body in bodies]),
            )
        )
    return _rig(brake, "fem", rubs, surfaces)


def foundation_rig(brake: Brake, *, sections: int = foundation.SECTIONS, lift: Iterable[str] = ()) -> Rig:
    """The rig of a post brake on the foundation model; options as of foundation.solve. Raises BadInput, NoAnswer."""
    reason = foundation.why_not(brake)
    if reason is not None:
        raise BadInput(f"foundation does not apply to this brake: {reason}")
    names = foundation.lifted(brake, lift)
    touching = [i for i, shoe in enumerate(brake.shoes) if pressing_moment(shoe) > 0]
    together = brake.drum.ring is not None and "own-pressure" in names
    rubs, surfaces = [], list[Surface]()
    for group in [touching] if together and touching else [[i] for i in touching]:
        posts, _, problem = foundation.system(brake, group, sections, names)
        widths = [brake.shoes[i].lining.width for i in group]
        area = np.concatenate([b * brake.drum.radius * p.sector for b, p in zip(widths, posts, strict=True)])
        placed = [
            (i, shoe_angles(p.axis, brake.shoes[i], p.theta), 1, p.closing[:1].T)
            for i, p in zip(group, posts, strict=True)
        ]
        surfaces += _surfaces(brake, surfaces, len(rubs), placed)
        rubs.append(
            Rub(
                problem=problem,
                loaded=problem.q - np.concatenate([p.gap for p in posts]),
                weight=np.eye(len(area)),
                pressure=1 / area,
                area=area,
                torque=brake.friction * brake.drum.radius * area,
            )
        )
    return _rig(brake, "foundation", rubs, surfaces)


def motions_of(body: Body, shoe: Shoe, guide: Guide) -> Motions:
    """The rigid motions that a shoe has: its turn about the hinge, that about the pivot, or its way along a radius."""
    x, y = body.line.xy
    force, at = shoe.frame.to_shoe(shoe.actuation.vector), shoe.frame.to_shoe(shoe.actuation.point.xy)
    if guide == "radius":
        middle = sum(shoe.arc) / 2
        e = shoe.sign * np.array([math.cos(middle), math.sin(middle)])
        return Motions(np.tile(e, len(x))[:, None], np.array([float(e @ force)]))
    moved = [body.turned]
    work = [float(cross(at - np.array([shoe.hinge.radius, 0.0]), force))]
    if shoe.pivot is not None:  # the actuation acts on the lever: it does no work where the shoe turns on its pivot
        u, v = shoe.frame.to_shoe(shoe.pivot.xy)
        moved.append(np.column_stack([v - y, x - u]).ravel())
        work.append(0.0)
    return Motions(np.column_stack(moved), np.array(work))


def _moving(problem: contact.Problem, body: Body, brake: Brake, shoe: Shoe, motions: Motions) -> contact.Problem:
    """The problem of a rigid shoe with these motions: C is what the contact does on them, against the actuation."""
    drag = brake.friction * brake.spin * shoe.frame.sense
    approach = body.coupling.N @ motions.moved
    C = (drag * (body.coupling.T @ motions.moved) - approach).T
    return problem._replace(B=-approach, C=C, h=-motions.work)


def _approach(body: Body, shoe: Shoe, motions: Motions) -> Floats:
    c, s = np.cos(body.line.phi)[:, None], np.sin(body.line.phi)[:, None]
    return shoe.sign * (c * motions.moved[0::2] + s * motions.moved[1::2])


def _surfaces(
    brake: Brake, before: Sequence[Surface], rub: int, placed: list[tuple[int, Floats, int, Floats]]
) -> list[Surface]:
    """The surfaces of a rub's shoes: shoe, theta, order and approach of each."""
    offset, first, row, found = sum(len(s.theta) for s in before), 0, 0, []
    for i, theta, order, approach in placed:
        n, k = approach.shape
        found.append(
            Surface(
                shoe=i,
                name=brake.shoes[i].name,
                rub=rub,
                part=slice(offset + first, offset + first + n),
                local=slice(first, first + n),
                rows=slice(row, row + k),
                theta=theta,
                forward=slice(None, None, 1 if theta[-1] > theta[0] else -1),
                order=order,
                approach=approach,
            )
        )
        first, row = first + n, row + k
    return found


def _rig(brake: Brake, model: str, rubs: list[Rub], surfaces: list[Surface]) -> Rig:
    if not rubs:
        raise NoAnswer("no contact: no shoe is turned towards the drum, so that nothing wears")
    return Rig(brake, model, tuple(rubs), tuple(surfaces))


class Target(NamedTuple):
    """What wear tends to: pressure (n,) [Pa] of all unknowns, torque [N m]."""

    pressure: Floats
    torque: float


def target(rig: Rig, law: Law | None = None, torque: float | None = None) -> Target:
    """Where all points of each lining wear as its shoe moves: p = (approach . y)^(1/m), in equilibrium.

    torque [N m]: held, else the actuation stays. Raises NoAnswer where the rigid shoe has no equilibrium or would
    not press everywhere.
    """
    exponent = 1.0 if law is None else law.exponent
    p = np.concatenate([_worn_pressure(rig, surface, exponent) for surface in rig.surfaces])
    size = sum(float(rub.torque @ p[_of(rig, i)]) for i, rub in enumerate(rig.rubs))
    return Target(p, size) if torque is None else Target(p * torque / size, torque)


def _of(rig: Rig, rub: int) -> slice:
    parts = [surface.part for surface in rig.surfaces if surface.rub == rub]
    return slice(parts[0].start, parts[-1].stop)


def _worn_pressure(rig: Rig, surface: Surface, exponent: float) -> Floats:
    rub = rig.rubs[surface.rub]
    C = rub.problem.C[surface.rows, surface.local] / rub.pressure[surface.local]
    h = rub.problem.h[surface.rows]
    said = f"shoe {surface.name!r}"

    def pressure(y: Floats) -> Floats:
        v = surface.approach @ y
        return np.sign(v) * np.abs(v) ** (1 / exponent)

    y = np.linalg.solve(C @ surface.approach, h)
    if exponent != 1 and len(h) == 1:
        unit = pressure(np.sign(y))
        return _pressing(unit * float(h[0] / (C @ unit)[0]), said)
    if exponent != 1:
        scale = np.abs(h).max()
        unit = pressure(y)
        factor = float(scale / np.abs(C @ unit).max()) ** exponent  # p goes as y^(1/m)
        found = scipy.optimize.root(lambda z: (C @ pressure(z * y * factor) - h) / scale, np.ones(len(h)), tol=1e-13)
        if not found.success:
            raise NoAnswer(f"{said}: no worn-in pressure in equilibrium found")
        y = found.x * y * factor
    return _pressing(pressure(y), said)


def _pressing(p: Floats, said: str) -> Floats:
    if p.min() < -1e-9 * np.abs(p).max():
        raise NoAnswer(f"{said}: worn in, a rigid shoe would not press everywhere, or lock itself")
    return np.maximum(p, 0.0)


class Distance(NamedTuple):
    """How far a state is from the target: of p (L2, the worst lining's, without one element at each end), of torque."""

    pressure: float
    torque: float


def distance(rig: Rig, state: State, goal: Target) -> Distance:
    """The relative distances of a state from the target."""
    worst = max(
        norm(s, s.along(state.pressure - goal.pressure)) / norm(s, s.along(goal.pressure)) for s in rig.surfaces
    )
    return Distance(worst, state.torque / goal.torque - 1 if goal.torque else 0.0)


def norm(surface: Surface, values: Floats) -> float:
    """L2 norm over theta of values (n,) by growing theta, without one element at each end."""
    inner = slice(surface.order, len(values) - surface.order)
    _, v, w = gauss_points(surface.angles[inner], values[inner], surface.order)
    return math.sqrt(float((v**2 * w).sum()))


def settled(rig: Rig, goal: Target, within: float = SETTLED) -> Callable[[State], bool]:
    """Whether p and torque of a state are within a fraction of the target."""
    return lambda state: max(map(abs, distance(rig, state, goal))) <= within


def run_in(
    rig: Rig,
    law: Law | None = None,
    *,
    backward: Rig | None = None,
    until: Callable[[State], bool] | None = None,
    **options: object,
) -> list[State]:
    """Wear a brake in by `law`, by default Archard's: see wear.run for the options; until settled, or over `distance`.

    backward: the rig of the same brake with the drum turning the other way, for `reverse`.
    """
    law = law or Law(COEFFICIENT)
    torque = options.get("torque")
    if until is None and "distance" not in options and "stations" not in options:
        if backward is not None:
            raise BadInput("a brake whose drum turns both ways does not settle: a distance must be given")
        until = settled(rig, target(rig, law, torque))  # type: ignore[arg-type]
    return wear.run(
        rig.rubs,
        law,
        backward=backward.rubs if backward else (),
        until=until or (lambda _: False),
        **options,  # type: ignore[arg-type]
    )


def unit_distance(rig: Rig, law: Law) -> float:
    """1/(k K) [m]: the sliding distance over which a rigid shoe's Winkler lining forgets its shape, by e."""
    return 1 / (law.coefficient * rig.stiffness)


def worn(rig: Rig, state: State) -> Brake:
    """The brake with the depth worn off added to the clearance of its linings."""
    changes = {}
    for surface in rig.surfaces:
        theta = surface.angles
        clearance = rig.brake.shoes[surface.shoe].lining.clearance_at(theta) + surface.along(state.depth)
        changes[f"shoe[{surface.shoe}].lining.clearance"] = np.column_stack([theta, clearance]).tolist()
    return vary(rig.brake, changes)


class Life(NamedTuple):
    """The sliding distance [m] at which a lining is worn out, and the parts of it after which p and torque stay
    within `within` of the law; above 1: they never come there.
    """

    distance: float
    pressure: float
    torque: float


def life(
    rig: Rig, states: Sequence[State], goal: Target, law: Law, within: float = 0.01, part: float = WORN_OUT
) -> Life:
    """How much of a lining's life is spent away from the law.

    The life ends where the deepest wear of a lining reaches `part` of its thickness; beyond the last state all wears
    at the rate of the law. The lining's own loss of thickness is not fed back into its stiffness.
    """
    end = math.inf
    for surface in rig.surfaces:
        allowed = part * rig.brake.shoes[surface.shoe].lining.thickness
        deepest = [float(state.depth[surface.part].max()) for state in states]
        if deepest[-1] >= allowed:
            end = min(end, float(np.interp(allowed, deepest, [state.s for state in states])))
        elif law.coefficient > 0:
            rate = float(law.rate(goal.pressure[surface.part], 0.0)[0].max())
            end = min(end, states[-1].s + (allowed - deepest[-1]) / rate)
    s, far = [state.s for state in states], [distance(rig, state, goal) for state in states]
    pressure = wear.last_beyond(s, [d.pressure for d in far], within)
    return Life(end, pressure / end, wear.last_beyond(s, [d.torque for d in far], within) / end)


class Checks(NamedTuple):
    """Balances of a run, relative: worn volume against k Int Int p dA ds (exponent 1), and against the energy, V = k W/mu.

    `ripple`: the largest checkerboard of any state after the first; see wear.ripple.
    """

    volume: float
    energy: float
    ripple: float


def checks(rig: Rig, states: Sequence[State], law: Law) -> Checks:
    """The balances and the checkerboard of a run; the worn volume is integrated from the worn shape."""
    end, radius = states[-1], rig.brake.drum.radius
    volume = sum(rig.brake.shoes[s.shoe].lining.width * radius * _integral(s, s.along(end.depth)) for s in rig.surfaces)
    scale = abs(end.removed) or 1.0
    friction = rig.brake.friction
    worn_by_energy = law.coefficient * end.work / (friction * radius) if friction and law.exponent == 1 else volume
    ripples = [wear.ripple(s.along(state.pressure)) for state in states[1:] for s in rig.surfaces]
    return Checks(
        abs(volume - end.removed) / scale,
        abs(volume - worn_by_energy) / scale,
        float(np.nanmax(ripples)) if len(ripples) and not np.isnan(ripples).all() else math.nan,
    )


def _integral(surface: Surface, values: Floats) -> float:
    _, v, w = gauss_points(surface.angles, values, surface.order)
    return float((v * w).sum())
