"""Scenes of brakes whose shoes are columns of high degree."""

from collections.abc import Mapping, Sequence
from functools import partial

from drumlin.brake import Brake, Shoe
from drumlin.errors import BadInput
from drumlin.fem import scene as scenes
from drumlin.fem.hp.body import condensed, contact_line, grid_of
from drumlin.fem.hp.division import Level, divide
from drumlin.fem.hp.ring import ring_body
from drumlin.fem.hp.shoe import condense

Places = Mapping[tuple[object, ...], Sequence[tuple[float, float, bool]]]  # by the shape of a shoe: see `divide`


def body(
    shoe: Shoe,
    radius: float,
    level: Level,
    places: Sequence[tuple[float, float, bool]],
    friction: bool,
    seconds: scenes.Seconds,
) -> scenes.Body:
    """The condensed body of a parametric shoe at a level."""
    with scenes.clock(seconds, "condensation"):
        div = divide(shoe, radius, level, places)
        found = condense(shoe, radius, div, scenes.materials_of(shoe))
        line, grid = contact_line(shoe, radius, div), grid_of(shoe, radius, div)
        inner = condensed(shoe, radius, div, found, grid)
    with scenes.clock(seconds, "coupling"):
        made = partial(scenes.Body, grid, grid, line)
        return scenes.coupled(made, shoe, line, inner, found.centre, friction=friction)


def scene(brake: Brake, level: Level, places: Places | None = None) -> scenes.Scene:
    """The scene of a brake at a level; `places`: where the pressure is not smooth.  Raises as scenes.prepare."""
    reason = scenes.why_not(brake)
    if reason is not None:
        raise BadInput(f"fem does not apply to this brake: {reason}")
    seconds: scenes.Seconds = {}
    made: dict[tuple[object, ...], scenes.Body] = {}
    for shoe in brake.shoes:
        key = scenes.shape_of(brake, shoe)
        if key not in made:
            made[key] = body(shoe, brake.drum.radius, level, (places or {}).get(key, ()), brake.friction > 0, seconds)
    bodies = tuple(made[scenes.shape_of(brake, shoe)] for shoe in brake.shoes)
    left_out = ["interior fields: recovered only for a picture"]
    if len(made) < len(bodies):
        left_out.append(f"{len(bodies) - len(made)} of {len(bodies)} shoes: same shape as another, condensed once")
    if brake.friction == 0:
        left_out.append("friction: mu = 0, symmetric, without the flexibility under drag")
    ring = None
    if brake.drum.ring is not None:
        with scenes.clock(seconds, "ring"):
            ring = ring_body(brake, tuple(body.line for body in bodies), level)
    return scenes.Scene(brake, bodies, ring, seconds, (*left_out, *scenes.lacking(brake)))
