"""Scenes of brakes whose shoes are columns of high degree."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Beam
from drumlin.fem.hp.body import condensed, contact_line, end_load_of, grid_of
from drumlin.fem.hp.corner import powers_of
from drumlin.fem.hp.division import CORNER_COUNTS, Division, Kind, Level, Place, divide
from drumlin.fem.hp.ring import ring_body
from drumlin.fem.hp.shoe import condense
from drumlin.fem.preparation import assembly
from drumlin.fem.substructure.elasticity import layers_of

MOST_NODES = 3000  # in contact with each other: matrices of twice as many rows take gigabytes
Places = Mapping[int, Sequence[Place]]  # by the first shoe of a shape: see `divide`


def body(
    shoe: Shoe, radius: float, div: Division, friction: bool, seconds: assembly.Seconds
) -> assembly.Body:
    """The condensed body of a parametric shoe that is divided so."""
    with assembly.clock(seconds, "condensation"):
        found = condense(shoe, radius, div, layers_of(shoe))
        line, grid = contact_line(shoe, radius, div), grid_of(shoe, radius, div)
        inner = condensed(shoe, div, found, line, grid)
    with assembly.clock(seconds, "coupling"):
        made = partial(assembly.Body, grid, grid, line)
        return assembly.coupled(made, shoe, line, inner, found.centre, friction=friction)


def scene(
    brake: Brake,
    level: Level,
    places: Places | None = None,
    cache: assembly.Cache | None = None,
    alike: Sequence[int] = (),
) -> assembly.Scene:
    """The scene of a brake at a level. Raises as assembly.prepare, and NoAnswer where it has more
    than MOST_NODES.

    places: where the pressure is not smooth; cache: bodies of earlier scenes, taken from there and
    put there; alike: as of `assembly.alike`, where it is known.
    """
    reason = assembly.why_not(brake)
    if reason is not None:
        raise BadInput(f"fem does not apply to this brake: {reason}")
    radius, friction = brake.size, brake.friction > 0
    seconds: assembly.Seconds = {}
    alike = alike or assembly.alike(brake)
    shoes = {i: brake.shoes[i] for i in alike}  # the first of each shape
    cam = brake.actuation is not None and brake.actuation.is_cam
    powers = {i: _steepest(brake, alike, i, (places or {}).get(i, ())) for i in shoes}
    divided = {
        i: divide(shoe, radius, level, (places or {}).get(i, ()), tip=cam, powers=powers[i])
        for i, shoe in shoes.items()
    }
    together = sum if brake.ring is not None else max
    nodes = together(divided[i].contact_nodes for i in alike)
    if nodes > MOST_NODES:
        raise NoAnswer(f"its {nodes} contact nodes are more than the {MOST_NODES} that are allowed")
    made: dict[int, assembly.Body] = {}
    for i, shoe in shoes.items():
        make = partial(body, shoe, radius, divided[i], friction, seconds)
        if cache is None:
            made[i] = make()
        else:
            made[i] = cache.get(
                (assembly.bare_shoe(shoe), radius, friction, divided[i].key), make, assembly.size_of
            )
    bodies = tuple(made[i] for i in alike)
    left_out = ["interior fields: recovered only for a picture"]
    if len(made) < len(bodies):
        left_out.append(
            f"{len(bodies) - len(made)} of {len(bodies)} shoes: same shape as another, condensed once"
        )
    if brake.friction == 0:
        left_out.append("friction: mu = 0, symmetric, without the flexibility under drag")
    sharp = min(each.sharp for each in divided.values())
    ring, ring_under = None, partial(ring_body, brake, level, sharp=sharp)
    if brake.ring is not None:
        with assembly.clock(seconds, "ring"):
            lines = tuple(body.line for body in bodies)
            own = (assembly.bare(brake), level, sharp, *(each.key for each in divided.values()))
            ring = (cache or assembly.Cache()).get(
                own, partial(ring_under, lines), assembly.size_of
            )
    again = {
        i: partial(
            _nodes_of, shoe, divided[i], radius, level, (places or {}).get(i, ()), cam, powers[i]
        )
        for i, shoe in shoes.items()
    }
    return assembly.Scene(
        brake,
        bodies,
        ring,
        seconds,
        (*left_out, *assembly.lacking(brake)),
        nodes_of=partial(_nodes_alike, again, alike),
        ring_under=ring_under,
    )


def _steepest(
    brake: Brake, alike: Sequence[int], first: int, places: Sequence[Place]
) -> tuple[float, float]:
    """The smallest powers of p at both ends of the linings of all shoes of one shape.

    0 where no contact is so short that its corner counts, see CORNER_COUNTS.
    """
    if not any(kind == Kind.END and length <= CORNER_COUNTS for _, length, kind in places):
        return 0.0, 0.0
    each = [powers_of(brake, j) for j, shape in enumerate(alike) if shape == first]
    return min(start for start, _ in each), min(end for _, end in each)


def _nodes_of(
    shoe: Shoe,
    div: Division,
    radius: float,
    level: Level,
    places: Sequence[Place],
    tip: bool,
    powers: tuple[float, float],
    other: Shoe,
) -> assembly.BodyNodes:
    """The nodes of the body of another shoe that is divided by the rule by which `div` divides this
    one.

    Of a straight beam the division under the lining stays on the drum, while the frame turns with
    the hinge.
    """
    turn = other.arc[0] - shoe.arc[0]
    moved = [(phi + turn, length, kink) for phi, length, kink in places]
    found = divide(other, radius, level, moved, tip=tip, powers=powers)
    if isinstance(shoe.body, Beam):
        found = replace(found, angles=div.angles + turn)
    grid = grid_of(other, radius, found)
    if "actuation" not in grid.sets:
        return assembly.BodyNodes(grid.doflocs, np.zeros(grid.doflocs.shape))
    full, centre = end_load_of(found, grid)
    return assembly.BodyNodes(
        grid.doflocs, (full @ assembly.load_on(centre, other)[0]).reshape(-1, 2).T
    )


def _nodes_alike(
    each: Mapping[int, Callable[[Shoe], assembly.BodyNodes]],
    alike: Sequence[int],
    i: int,
    shoe: Shoe,
) -> assembly.BodyNodes:
    """As `Scene.nodes_of`; each: by the first shoe of a shape."""
    return each[alike[i]](shoe)
