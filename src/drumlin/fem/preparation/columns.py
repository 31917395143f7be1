"""Bodies in hp elements: each parametric shoe divided into columns, and condensed."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Beam
from drumlin.fem.hp.body import condensed, contact_line, end_load_of, grid_of
from drumlin.fem.hp.corner import powers_of
from drumlin.fem.hp.division import CORNER_COUNTS, Division, Kind, Level, Place, divide
from drumlin.fem.hp.ring import ring_body
from drumlin.fem.hp.shoe import condense
from drumlin.fem.preparation.bodies import Body, BodyNodes, coupled, load_on
from drumlin.fem.preparation.cache import Cache, bare, bare_shoe, size_of
from drumlin.fem.preparation.scene import DividedBodies, Seconds, clock
from drumlin.fem.substructure.elasticity import layers_of

MOST_NODES = 3000
"""Largest number of contact nodes that feel each other, of one shoe or of all shoes on a ring.
Their matrices have twice as many rows and take gigabytes.
"""
Places = Mapping[int, Sequence[Place]]
"""The grading points of a lining by the first shoe of its shape; see `divide`."""


class _DivisionRule(NamedTuple):
    """How the shoes of one shape are divided: their first `shoe`, the `level`, the grading points
    `places`, whether the loaded end is graded (`tip`), the `powers` of the pressure at both ends of
    the lining, and the `division` that follows.
    """

    shoe: Shoe
    level: Level
    places: Sequence[Place]
    tip: bool
    powers: tuple[float, float]
    division: Division


def in_columns(
    brake: Brake,
    level: Level,
    places: Places | None,
    alike: Sequence[int],
    cache: Cache,
    seconds: Seconds,
) -> DividedBodies:
    """The bodies of a brake in hp elements at a level; shoes of one shape share one body.

    Parameters
    ----------
    places : grading points, where the pressure is not smooth
    alike : for each shoe the first one of its shape, see `cache.alike`
    cache : bodies of earlier scenes, taken from there and put there
    seconds : time of each phase, which this adds to

    Raises
    ------
    NoAnswer
        where more than MOST_NODES contact nodes feel each other
    """
    rules = {i: _rule(brake, level, places or {}, alike, i) for i in dict.fromkeys(alike)}
    together = sum if brake.ring is not None else max
    nodes = together(rules[i].division.contact_nodes for i in alike)
    if nodes > MOST_NODES:
        raise NoAnswer(f"its {nodes} contact nodes are more than the {MOST_NODES} that are allowed")
    made = {i: _cached(brake, rule, cache, seconds) for i, rule in rules.items()}
    bodies = tuple(made[i] for i in alike)
    sharp = min(rule.division.sharp for rule in rules.values())
    ring, ring_under = None, partial(ring_body, brake, level, sharp=sharp)
    if brake.ring is not None:
        with clock(seconds, "ring"):
            lines = tuple(body.line for body in bodies)
            own = (bare(brake), level, sharp, *(rule.division.key for rule in rules.values()))
            ring = cache.get(own, partial(ring_under, lines), size_of)
    again = {i: partial(_nodes_of, rule, brake.size) for i, rule in rules.items()}
    return DividedBodies(bodies, ring, partial(_nodes_alike, again, alike), ring_under)


def _rule(
    brake: Brake, level: Level, places: Places, alike: Sequence[int], i: int
) -> _DivisionRule:
    """The rule for shoe i, the first one of its shape."""
    shoe, own = brake.shoes[i], places.get(i, ())
    tip = brake.actuation is not None and brake.actuation.is_cam
    powers = _steepest(brake, alike, i, own)
    division = divide(shoe, brake.size, level, own, tip=tip, powers=powers)
    return _DivisionRule(shoe, level, own, tip, powers, division)


def _cached(brake: Brake, rule: _DivisionRule, cache: Cache, seconds: Seconds) -> Body:
    """The body of a shape, from the cache or condensed now."""
    shoe, radius, friction, division = rule.shoe, brake.size, brake.friction > 0, rule.division
    key = (bare_shoe(shoe), radius, friction, division.key)
    return cache.get(key, partial(_body, shoe, radius, division, friction, seconds), size_of)


def _body(shoe: Shoe, radius: float, div: Division, friction: bool, seconds: Seconds) -> Body:
    """The condensed body of a parametric shoe that is divided so."""
    with clock(seconds, "condensation"):
        found = condense(shoe, radius, div, layers_of(shoe))
        line, grid = contact_line(shoe, radius, div), grid_of(shoe, radius, div)
        inner = condensed(shoe, div, found, line, grid)
    with clock(seconds, "coupling"):
        made = partial(Body, grid, grid, line)
        return coupled(made, shoe, line, inner, found.centre, friction=friction)


def _steepest(
    brake: Brake, alike: Sequence[int], first: int, places: Sequence[Place]
) -> tuple[float, float]:
    """The smallest powers of p at both ends of the linings of all shoes of one shape.

    0 where no contact is so short that its corner counts, see CORNER_COUNTS, and on an elastic
    ring.
    """
    # The ring has columns as narrow as the lining's. Columns of the width w lose some 1e-16 (R/w)^2
    # of the forces of a ring of radius R, which bends as a whole: 1e-4 at a corner's width.
    if brake.ring is not None and brake.ring.section is not None:
        return 0.0, 0.0
    if not any(kind == Kind.END and length <= CORNER_COUNTS for _, length, kind in places):
        return 0.0, 0.0
    each = [powers_of(brake, j) for j, shape in enumerate(alike) if shape == first]
    return min(start for start, _ in each), min(end for _, end in each)


def _nodes_of(rule: _DivisionRule, radius: float, other: Shoe) -> BodyNodes:
    """The nodes of the body of another shoe that is divided by the rule of its shape.

    Of a straight beam the division under the lining stays on the drum, while the frame turns with
    the hinge.
    """
    shoe = rule.shoe
    turn = other.arc[0] - shoe.arc[0]
    moved = [(phi + turn, length, kink) for phi, length, kink in rule.places]
    found = divide(other, radius, rule.level, moved, tip=rule.tip, powers=rule.powers)
    if isinstance(shoe.body, Beam):
        found = replace(found, angles=rule.division.angles + turn)
    grid = grid_of(other, radius, found)
    if "actuation" not in grid.sets:
        return BodyNodes(grid.doflocs, np.zeros(grid.doflocs.shape))
    full, centre = end_load_of(found, grid)
    load = full @ load_on(centre, other)[0]
    return BodyNodes(grid.doflocs, load.reshape(-1, 2).T)


def _nodes_alike(
    each: Mapping[int, Callable[[Shoe], BodyNodes]],
    alike: Sequence[int],
    i: int,
    shoe: Shoe,
) -> BodyNodes:
    """As `Scene.nodes_of`; each: by the first shoe of a shape."""
    return each[alike[i]](shoe)
