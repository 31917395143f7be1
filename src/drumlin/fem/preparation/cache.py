"""The cache of condensed bodies, and the part of a brake that each body depends on."""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Any

import numpy as np

from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Beam
from drumlin.brake.fields import Point
from drumlin.fem.mesh.content import digest_of_mesh_file
from drumlin.fem.preparation.bodies import ShoeSubstructure
from drumlin.fem.substructure.ring import RingSubstructure

CACHE_BYTES = 200_000_000
"""Largest size [bytes] of the condensed bodies that a cache keeps for the next prepared models.

A fuller cache drops the body that was used longest ago. The limit was chosen by judgement: some
hundred bodies of the size that a solve uses.
"""


def shape_key_of_shoe(brake: Brake, shoe: Shoe) -> tuple[object, ...]:
    """The data that a shoe's body depends on, equal for shoes of one shape.

    Shoes of one shape may differ in their position, hand, load and clearance.
    """
    arcs = [shoe.arc]
    lining, body = shoe.lining, shoe.body
    behind: tuple[object, ...] | None = None
    if isinstance(body, Beam):
        # A beam ends where the force acts.
        loaded = np.round(shoe.frame.to_shoe(shoe.actuation.point.xy) / brake.size, 12)
        behind = (body, *loaded.tolist())
    elif body is not None:
        first, last = sorted(shoe.frame.phis((body.start, body.end)))
        arcs.append((first, last))
        behind = (body.shape, tuple(body.plates.items()))
        grip = shoe.grip(brake.size)
        if grip is not None:
            arcs.append(grip)
    mesh: tuple[object, ...] | None = None
    if shoe.mesh is not None:
        # A mesh in the brake's frame is another shape for each position of the shoe.
        frame = shoe.mesh_frame == "shoe" or shoe.frame
        mesh = (shoe.mesh, shoe.mesh_unit, frame, shoe.groups)
    angles = [angle for arc in arcs for angle in arc]
    return (
        brake.size,
        shoe.side,
        tuple(np.round(shoe.own_pin / brake.size, 12).tolist()),
        tuple(round(angle, 12) for angle in angles),
        (lining.thickness, lining.width, lining.material),
        shoe.backing,
        behind,
        mesh,
    )


def first_shoes_of_equal_shape(brake: Brake) -> tuple[int, ...]:
    """For each shoe the index of the first shoe of its shape, with which it shares a body."""
    shapes = [shape_key_of_shoe(brake, shoe) for shoe in brake.shoes]
    return tuple(map(shapes.index, shapes))


class Cache:
    """Condensed bodies that were made last, kept for the next prepared models by their keys.

    A body depends on its key alone. `room` [bytes] limits the bodies together: beyond it the body
    that was used longest ago goes first, and the body in use always stays. functools.lru_cache
    would count entries in place of bytes.
    """

    def __init__(self, room: int = CACHE_BYTES) -> None:
        self._room = room
        self._taken = 0
        self._values = OrderedDict[Hashable, tuple[int, Any]]()

    def get(self, key: Hashable, make: Callable[[], Any], size: Callable[[Any], int]) -> Any:
        """The value of `key` from the cache, or else made by `make` and kept.

        `size` counts the bytes of a value.
        """
        kept = self._values.pop(key, None)
        if kept is None:
            value = make()
            kept = size(value), value
            self._taken += kept[0]
        # The order of the dictionary is the order of use.
        self._values[key] = kept
        while len(self._values) > 1 and self._taken > self._room:
            _, (dropped, _) = self._values.popitem(last=False)
            self._taken -= dropped
        return kept[1]


def memory_of_body(body: ShoeSubstructure | RingSubstructure) -> int:
    """The memory [bytes] that the matrices of a condensed body take, approximately."""
    # Six dense (n, n) matrices of doubles, and some 400 bytes for each unknown of the sparse ones.
    n = len(body.line.nodes)
    return 8 * (4 + 2) * n**2 + 400 * 2 * int(body.basis.N)


def digest_of_shoe_mesh(shoe: Shoe) -> str | None:
    """A digest of a shoe's mesh file, whose content may change under one name."""
    return None if shoe.mesh is None else digest_of_mesh_file(shoe.mesh)


def brake_without_loads(brake: Brake) -> Brake:
    """The brake without the data that its bodies do not depend on.

    Brakes with equal bodies are then equal. Title, rotation, forces, clearances and misfits are
    removed, and all friction coefficients but zero are made equal.
    """
    shoes = tuple(shoe_without_loads(shoe) for shoe in brake.shoes)
    return brake.bare().model_copy(update={"shoes": shoes})


def shoe_without_loads(shoe: Shoe) -> Shoe:
    """The shoe without the data that its body does not depend on; see `brake_without_loads`."""
    actuation: dict[str, Any] = {"force": 1.0, "direction": 0.0}
    # A beam ends at the point of its force, and a guide has its pin there.
    point_matters = isinstance(shoe.body, Beam) or shoe.guide is not None
    if not point_matters:
        actuation["point"] = Point(x=0.0, y=0.0)
    lining: dict[str, Any] = {"clearance": 0.0, "misfit": type(shoe.lining.misfit)()}
    return shoe.model_copy(
        update={
            "lining": shoe.lining.model_copy(update=lining),
            "actuation": shoe.actuation.model_copy(update=actuation),
        }
    )
