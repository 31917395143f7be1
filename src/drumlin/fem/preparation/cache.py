"""The cache of condensed bodies, and the part of a brake that each body depends on."""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Any

import numpy as np

from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Beam
from drumlin.brake.fields import Point
from drumlin.fem.mesh.content import content_digest
from drumlin.fem.preparation.bodies import Body
from drumlin.fem.substructure.ring import RingBody

ROOM = 200_000_000
"""Bytes of condensed bodies that a cache keeps for the next scenes; beyond it the oldest go."""


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
        else (
            shoe.mesh,
            shoe.mesh_unit,
            shoe.mesh_frame == "shoe" or shoe.frame,
            shoe.groups,
        ),
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


def size_of(body: Body | RingBody) -> int:
    """What a condensed body keeps, about: its matrices."""
    n = len(body.line.nodes)
    return 8 * (4 + 2) * n**2 + 400 * 2 * int(body.basis.N)


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
