"""A cache of condensed bodies; the key of a body has all data of the brake that it depends on."""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Any

import numpy as np

from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import BeamBody
from drumlin.brake.fields import Point
from drumlin.brake.further_loads import NO_SPRING_LEVER_AND_MASS_LOADS, SpringLeverAndMassLoads
from drumlin.fem.preparation.bodies import ShoeSubstructure
from drumlin.fem.preparation.load_places import points_where_shoe_body_is_loaded
from drumlin.fem.substructure.body import UncondensedBodySystem
from drumlin.fem.substructure.ring import RingSubstructure
from drumlin.mesh_files.content import digest_of_mesh_file

MOST_BYTES_OF_CACHED_BODIES = 400_000_000
"""Largest memory [bytes] of the condensed bodies that a cache keeps for later solves.

If the bodies need more, the cache drops the body that was used longest ago. The limit is a
judgement: some two hundred bodies of hp elements of the size that a solve uses, or all levels of
two mesh files of 10 000 nodes with straight sides.
"""


def cache_key_of_shoe_shape(brake: Brake, shoe: Shoe) -> tuple[object, ...]:
    """A key that is equal for two shoes if they can share one condensed body.

    It contains the geometry and the materials. Shoes with the same key have one shape. They may
    differ in position, load and clearance, and one may be the mirror image of the other.
    """
    arcs = list(shoe.arcs)
    lining, body = shoe.lining, shoe.body
    behind: tuple[object, ...] | None = None
    if isinstance(body, BeamBody):
        # A beam ends at the point of the actuation force, so that its shape depends on this point.
        loaded = np.round(
            shoe.frame.convert_vectors_to_shoe_frame(shoe.actuation.point.xy) / brake.size, 12
        )
        behind = (body, *loaded.tolist())
    elif body is not None:
        first, last = sorted(shoe.frame.phi_coordinates_as_list((body.start, body.end)))
        arcs.append((first, last))
        behind = (body.shape, tuple(body.plates.items()))
        grip = shoe.interval_of_body_back_held_by_support(brake.size)
        if grip is not None:
            arcs.append(grip)
    mesh: tuple[object, ...] | None = None
    if shoe.mesh is not None:
        # If the mesh of a file is in the brake's frame, shoes at two positions have different
        # shapes.
        frame = shoe.mesh_frame == "shoe" or shoe.frame
        mesh = (shoe.mesh, shoe.mesh_unit, frame, shoe.groups)
    # Lengths and angles are rounded, because round-off would make equal shapes different.
    angles = [angle for arc in arcs for angle in arc]
    return (
        brake.size,
        shoe.side,
        tuple(np.round(shoe.pin_position_in_shoe_frame / brake.size, 12).tolist()),
        tuple(round(angle, 12) for angle in angles),
        (lining.thickness, lining.width, lining.material),
        shoe.backing,
        behind,
        mesh,
        tuple(np.round(points_where_shoe_body_is_loaded(shoe) / brake.size, 12).ravel().tolist()),
    )


def indices_of_first_shoes_of_equal_shape(brake: Brake) -> tuple[int, ...]:
    """For each shoe of a brake, the index of the first shoe that has the same shape.

    Shoes of the same shape share one condensed body. The first shoe of a shape has its own index.
    """
    shapes = [cache_key_of_shoe_shape(brake, shoe) for shoe in brake.shoes]
    return tuple(map(shapes.index, shapes))


class CacheOfCondensedBodies:
    """A store of the condensed bodies that were used last, for later prepared models.

    A body depends on its key alone. `room` [bytes] limits the memory of all bodies together. If
    they need more, the cache drops the body that was used longest ago; it never drops the body that
    was used last, unless the room is 0. functools.lru_cache cannot be used instead, since it counts
    entries and not bytes.
    """

    def __init__(self, room: int = MOST_BYTES_OF_CACHED_BODIES) -> None:
        self._room = room
        self._taken = 0
        self._values = OrderedDict[Hashable, tuple[int, Any]]()

    def get(self, key: Hashable, make: Callable[[], Any], size: Callable[[Any], int]) -> Any:
        """Return the value of a key from the cache, or make it and keep it.

        The function `make` makes the value if the cache does not have it. The function `size`
        returns the bytes of a value.
        """
        kept = self._values.pop(key, None)
        if kept is None:
            value = make()
            kept = size(value), value
            self._taken += kept[0]
        # The order of the dictionary is the order of use: the value that was used last comes last.
        self._values[key] = kept
        while len(self._values) > min(self._room, 1) and self._taken > self._room:
            _, (dropped, _) = self._values.popitem(last=False)
            self._taken -= dropped
        return kept[1]


def memory_bytes_of_condensed_body(body: ShoeSubstructure | RingSubstructure) -> int:
    """The approximate memory [bytes] of the matrices of a condensed body."""
    # A body has at most eleven dense (n, n) matrices of doubles: two for the closures of the gap,
    # five for the coupling with the drum, and four that stand for its stiffness on the contact
    # nodes, which a meshed body has only if an analysis needs it. Its sparse matrices take some 400
    # bytes for each displacement.
    n = len(body.line.nodes)
    inner = body.condensed.inner
    factors = inner.factors if isinstance(inner, UncondensedBodySystem) else None
    kept = 0 if factors is None else factors.memory
    return 8 * (4 + 2 + 5) * n**2 + 400 * 2 * int(body.basis.N) + kept


def digest_of_mesh_file_of_shoe(shoe: Shoe) -> str | None:
    """A digest of the content of a shoe's mesh file, which changes if the file changes.

    None stands for a shoe without a mesh file.
    """
    return None if shoe.mesh is None else digest_of_mesh_file(shoe.mesh)


def brake_without_loads_and_clearances(brake: Brake) -> Brake:
    """A copy of a brake without the data on which its condensed bodies do not depend.

    The copies of two brakes with equal condensed bodies are equal, and serve as a key of the cache.
    Title, rotation, forces, clearances and misfits (deviations of a lining from the drum's circle)
    are removed. All friction coefficients except zero are made equal.
    """
    shoes = tuple(shoe_without_loads_and_clearances(shoe) for shoe in brake.shoes)
    return brake.brake_reduced_to_stiffness_data().model_copy(update={"shoes": shoes})


def shoe_without_loads_and_clearances(shoe: Shoe) -> Shoe:
    """A copy of a shoe without the data on which its condensed body does not depend.

    The removed data are the size and direction of the actuation force, the sizes of all other
    loads, the clearance, the misfit and the friction. The point of the actuation force is removed
    too, unless the body depends on it. See `brake_without_loads_and_clearances`.
    """
    actuation: dict[str, Any] = {"force": 1.0, "direction": 0.0}
    # The body depends on the point of the actuation force if it is a beam, which ends at this
    # point, or if the shoe has a guide, whose pin lies at this point.
    point_matters = isinstance(shoe.body, BeamBody) or shoe.guide is not None
    if not point_matters:
        actuation["point"] = Point(x=0.0, y=0.0)
    lining: dict[str, Any] = {
        "clearance": 0.0,
        "misfit": type(shoe.lining.linings[0].misfit)(),
        "friction": None,
    }
    changes = {
        "lining": shoe.lining.copy_of_lining_with_changed_fields(lining),
        "actuation": shoe.actuation.model_copy(update=actuation),
        "forces": (),
        "mass": None,
    }
    # The load columns of an elastic body depend on the points of its forces and on its centre of
    # mass, and not on the forces themselves.
    if not len(points_where_shoe_body_is_loaded(shoe)):
        return shoe.model_copy(update=changes).shoe_with_spring_lever_and_mass_loads(
            NO_SPRING_LEVER_AND_MASS_LOADS
        )
    changes["mass"] = shoe.mass and shoe.mass.model_copy(update={"mass": 1.0})
    at_places = [
        force._replace(force=(0.0, 0.0)) for force in shoe.forces_at_points_besides_actuation
    ]
    return shoe.model_copy(update=changes).shoe_with_spring_lever_and_mass_loads(
        SpringLeverAndMassLoads(tuple(at_places))
    )
