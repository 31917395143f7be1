"""Shoes that repeat at equal distances, such as the blocks of a band, from one table of the file.

A shoe with a pattern is read as several shoes: copies that are turned about the drum's centre, or
moved along the plane, each by `step` farther than the one before. Links from each copy to the next
can be added, and springs from the shoe to the frame are repeated as well.
"""

import math
from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Annotated, Any, NamedTuple

from pydantic import Field, ValidationError, ValidationInfo

from drumlin.brake.fields import Angle, Length, PartOfInputFile, Point
from drumlin.brake.further_loads import Spring

KEYS_OF_COORDINATES_ALONG_SURFACE = ("start", "end")
"""Keys of a brake file that hold a coordinate along the surface, which moves with a shoe."""
KEYS_OF_TABLES_ALONG_SURFACE = ("clearance", "blocks")
"""Keys that may hold a table whose rows begin with a coordinate along the surface."""


class ShoePattern(PartOfInputFile):
    """How often a shoe repeats, and whether each shoe pushes the next by a strut or strap.

    `count` is the number of shoes, with the first one. With `linked` the abutment of each shoe
    bears on a link to the next shoe, and only the first shoe has an actuation.
    """

    count: Annotated[int, Field(ge=2, le=200)]
    linked: bool = False


class DrumPattern(ShoePattern):
    """A pattern of shoes on a drum; `step` [rad] is the angle from each shoe to the next."""

    step: Angle


class FlatPattern(ShoePattern):
    """A pattern of shoes on a plane; `step` [m] is the length from each shoe to the next."""

    step: Length


class RigidMotionOfCopiedShoe(NamedTuple):
    """A rigid-body motion of a shoe: a turn about the drum's centre or a shift along the plane.

    Attributes
    ----------
    turn : angle [rad] by which directions turn; 0 on a plane
    along : increase of coordinates along the surface, [rad] on a drum and [m] on a plane
    point : function that takes a point of the shoe and returns the moved point
    """

    turn: float
    along: float
    point: Callable[[Point], Point]


def shoe_motion_of_turn_about_drum_centre(angle: float) -> RigidMotionOfCopiedShoe:
    """The motion of a shoe that turns about the drum's centre by an angle [rad]."""
    c, s = math.cos(angle), math.sin(angle)
    return RigidMotionOfCopiedShoe(
        angle, angle, lambda p: Point(x=c * p.x - s * p.y, y=s * p.x + c * p.y)
    )


def shoe_motion_of_shift_along_plane(length: float) -> RigidMotionOfCopiedShoe:
    """The motion of a shoe that moves along the plane by a length [m]."""
    return RigidMotionOfCopiedShoe(0.0, length, lambda p: Point(x=p.x + length, y=p.y))


def copy_of_part_after_motion(part: Any, move: RigidMotionOfCopiedShoe) -> Any:
    """A copy of a shoe or of a part of it, with all its places and directions moved.

    The offset of a misfit is a vector, not a place: it turns with a shoe on a drum, and does not
    change with a shoe that moves along a plane.
    """
    changes: dict[str, Any] = {}
    for name in part.model_fields_set:
        value = getattr(part, name)
        if isinstance(value, Point):
            is_vector = name == "offset" and move.turn == 0
            changes[name] = value if is_vector else move.point(value)
        elif name == "direction":
            changes[name] = value + move.turn
        elif name in KEYS_OF_COORDINATES_ALONG_SURFACE:
            changes[name] = value + move.along
        elif name in KEYS_OF_TABLES_ALONG_SURFACE and isinstance(value, tuple):
            changes[name] = tuple((place + move.along, size) for place, size in value)
        elif isinstance(value, PartOfInputFile):
            changes[name] = copy_of_part_after_motion(value, move)
        elif isinstance(value, tuple) and all(isinstance(item, PartOfInputFile) for item in value):
            changes[name] = tuple(copy_of_part_after_motion(item, move) for item in value)
    return part.model_copy(update=changes)


def brake_data_with_patterned_shoes_repeated(
    data: object,
    kind: type[Any],
    move: Callable[[float], RigidMotionOfCopiedShoe],
    info: ValidationInfo,
) -> object:
    """Return the data of a brake with several shoes in place of each shoe with a pattern.

    Data without a pattern are returned as they are. A shoe with wrong data is kept, so that its
    error is reported later, as for any shoe.

    Parameters
    ----------
    data : data of a brake file, or wrong data of any type
    kind : class of the shoes
    move : function that returns the motion of a shoe by an angle [rad] or a length [m]
    info : pydantic's state of the validation

    Raises
    ------
    ValueError
        for a pattern of shoes that cannot be repeated
    """
    shoes = data.get("shoe") if isinstance(data, Mapping) else None
    if not isinstance(data, Mapping) or not isinstance(shoes, list | tuple):
        return data
    if not any(isinstance(shoe, Mapping) and shoe.get("pattern") is not None for shoe in shoes):
        return data
    found: list[Any] = []
    links: list[Any] = []
    springs = data.get("spring", ())
    for i, own in enumerate(shoes):
        repeats = isinstance(own, Mapping) and own.get("pattern") is not None
        first = _brake_part_from_data_or_none(kind, own, info) if repeats else None
        if first is None:
            found.append(own)
            continue
        copies = _copies_of_shoe_with_pattern(f"shoe[{i}]", first, move)
        found += copies
        springs = _springs_copied_with_repeated_shoe(springs, first, move, info)
        if first.pattern.linked:
            names = [shoe.name for shoe in copies]
            links += [{"from": a, "to": b} for a, b in pairwise(names)]
    changed: dict[str, Any] = {"shoe": found}
    given = data.get("link", ())
    if links and isinstance(given, list | tuple):
        changed["link"] = _links_sorted_from_pushing_to_pushed_shoe([*given, *links])
    if springs:
        changed["spring"] = springs
    return {**data, **changed}


def _brake_part_from_data_or_none(kind: type[Any], data: object, info: ValidationInfo) -> Any:
    """The part that data describe; None for wrong data, whose error is reported later.

    Parameters
    ----------
    kind : class of the part
    data : data of the part
    info : pydantic's state of the validation
    """
    try:
        return kind.model_validate(data, context=info.context)
    except ValidationError:
        return None


def _springs_copied_with_repeated_shoe(
    springs: Any, first: Any, move: Callable[[float], RigidMotionOfCopiedShoe], info: ValidationInfo
) -> Any:
    """The springs of a brake, with a copy for each copy of a shoe that a spring ties to the frame.

    Data that are no list of springs are returned unchanged. A spring to another shoe is not
    repeated: it must name one of the copies. `first` is the shoe with the pattern. `move` and
    `info` are as in `brake_data_with_patterned_shoes_repeated`.
    """
    if not isinstance(springs, list | tuple):
        return springs
    found: list[Any] = []
    for own in springs:
        to_frame = isinstance(own, Mapping) and own.get("to") is None
        of_shoe = to_frame and own.get("shoe") == first.name
        spring = _brake_part_from_data_or_none(Spring, own, info) if of_shoe else None
        if spring is None:
            found.append(own)
            continue
        for number in range(first.pattern.count):
            moved = copy_of_part_after_motion(spring, move(number * first.pattern.step))
            found.append(moved.model_copy(update={"shoe": f"{first.name} {number + 1}"}))
    return found


def _copies_of_shoe_with_pattern(
    key: str, first: Any, move: Callable[[float], RigidMotionOfCopiedShoe]
) -> list[Any]:
    """The shoes that `first`, a shoe with a pattern, stands for; `key` is its key in messages.

    `move` returns the motion of a shoe by an angle or length. Raises ValueError for a mesh file in
    the brake's coordinates, which would not move with a shoe, and for linked shoes without an
    abutment.
    """
    pattern = first.pattern
    if first.mesh is not None and first.mesh_frame == "brake":
        raise ValueError(f"{key}.pattern: a mesh file must have mesh_frame = 'shoe' to be repeated")
    if pattern.linked and first.abutment is None:
        raise ValueError(f"{key}.pattern.linked: each shoe bears on the next by an abutment")
    shoes = []
    for number in range(pattern.count):
        shoe = copy_of_part_after_motion(first, move(number * pattern.step))
        changes = {"name": f"{first.name} {number + 1}", "pattern": None}
        if pattern.linked and number > 0:
            changes["actuation"] = type(first).model_fields["actuation"].default
        shoe = shoe.model_copy(update=changes)
        if pattern.linked and number > 0:
            shoe.model_fields_set.discard("actuation")
        shoes.append(shoe)
    return shoes


def _links_sorted_from_pushing_to_pushed_shoe(links: list[Any]) -> list[Any]:
    """Sort links so that every shoe is pushed by a link before it pushes another shoe.

    Links that are no tables, or that form a closed ring, come last in their given order.
    """
    left = list(links)
    found: list[Any] = []
    while left:
        pushed = {link.get("to") for link in left if isinstance(link, Mapping)}
        ready = [
            link for link in left if isinstance(link, Mapping) and link.get("from") not in pushed
        ]
        if not ready:
            return [*found, *left]
        found += ready
        left = [link for link in left if link not in ready]
    return found
