"""A brake on finer and finer divisions, each moved to the ends of the contact that the one before it found."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple, Protocol

from drumlin.brake.brake import Brake
from drumlin.errors import LostDigits, NoAnswer
from drumlin.fem import assembly
from drumlin.fem.hp.division import Kind, Level, Place
from drumlin.fem.hp.places import places_of
from drumlin.fem.hp.scene import scene
from drumlin.response.response import Response

DEG = math.pi / 180
LEVELS = tuple(
    Level(*row)
    for row in (  # degree, zone, edge, end, ratio, opening, largest, back, hinge, through
        (3, 0.4, 0.11, 0.06, 0.32, 0.32, 20 * DEG, 0.4, 0.5, 0.1),
        (4, 0.2, 0.06, 0.008, 0.35, 0.25, 17 * DEG, 0.13, 0.1, 0.16),
        (5, 0.07, 0.025, 0.0025, 0.4, 0.24, 16 * DEG, 0.055, 0.035, 0.17),
        (6, 0.025, 0.01, 0.0008, 0.42, 0.25, 15 * DEG, 0.022, 0.012, 0.2),
        (7, 0.008, 0.004, 0.0004, 0.45, 0.27, 15 * DEG, 0.009, 0.0042, 0.24),
        (7, 0.0025, 0.0015, 0.0002, 0.5, 0.3, 12 * DEG, 0.0038, 0.0016, 0.32),
    )
)
"""Each has a tenth to a fifth of the error of the one before it, also of what the growth of the sizes leaves: that of
the degree p and the ratio q goes as ((1 - sqrt q)/(1 + sqrt q))^p, and two levels that share p and q do not see it.
Forces feel the corners behind the lining and at the hinge, whose sizes shrink so evenly that what is left of a level's
error of a force is a part of its step that can be foretold. The pressure of a short contact rises from its ends as a
root: there sizes may grow faster (`opening`)."""
MOST_PASSES = 8
EVEN = 64
"""Least number of columns under a lining on a division that confirms a refusal. Their nodes are then a
third of a degree apart on most linings, less than on a mesh of 80 elements. Fewer let a contact that is
shorter than a column stand on its ends alone; more cost time and no test brake needed them."""
SETTLED = 0.02  # of the length of the contact: an end of it is located by the first level where it moves by less


class Respond(Protocol):
    """What answers for a brake on a scene, from the contact of an earlier response."""

    def __call__(self, scene: assembly.Scene, brake: Brake, *, start: Response | None = None) -> Response:
        """The response."""


class Step(NamedTuple):
    """A level's scene and response."""

    scene: assembly.Scene
    response: Response


def steps(
    brake: Brake,
    respond: Respond,
    cache: assembly.Cache | None = None,
    levels: Sequence[Level] = (),
) -> Iterator[Step]:
    """The brake on all levels, or on those given, finer and finer; cache: see `scene`.

    A division is coarse where the contact of the level before does not lie. But what the answer is followed through as
    friction grows lies there too, and a short contact on nodes far apart may find no way. So a refusal is asked for
    once more on an even division of the same level, see EVEN, and all levels from there on are so. Lost digits are not:
    no division of a level brings them back.

    Raises NoAnswer where neither division of the first level has an answer, or two later levels have none.
    """
    last: Response | None = None
    alike = assembly.alike(brake)
    refused, even = 0, math.inf
    for level in levels or LEVELS:
        step: Step | None = None
        places = places_of(brake, last, alike, level.end)
        tried: list[Mapping[int, Sequence[Place]]] = []
        for _ in range(MOST_PASSES):
            made = scene(brake, _evened(level, even), places, cache, alike)
            try:
                found = respond(made, brake, start=last)
            except NoAnswer as refusal:
                step = None
                if math.isinf(even) and not isinstance(refusal, LostDigits):
                    even = min(end - start for start, end in (shoe.arc for shoe in brake.shoes)) / EVEN
                    continue
                refused += 1
                if refused == 2 or (last is None and math.isfinite(even)):
                    raise
                break
            step = Step(made, found)
            tried.append(places)
            last, places = found, places_of(brake, found, alike, level.end)
            # Ends that go back to where an earlier pass had them would go to and fro for ever.
            if any(not _moved(brake, meant, places) for meant in tried):
                break
        if step is not None:
            yield step


def _evened(level: Level, largest: float) -> Level:
    """The level with columns of this size [rad] at most."""
    return replace(level, largest=min(level.largest, largest))


def _moved(brake: Brake, meant: Mapping[int, Sequence[Place]], now: Mapping[int, Sequence[Place]]) -> bool:
    """Whether an end of the contact of any shape of shoe is away from where columns end, or a kink
    is no place yet."""
    return any(_off(brake.shoes[i].arc, meant[i], places) for i, places in now.items())


def _off(arc: tuple[float, float], places: Sequence[Place], now: Sequence[Place]) -> bool:
    """Whether an end of the contact is away from where columns end, over the length that it bounds,
    or a kink is."""
    meant = [*arc, *(place[0] for place in places)]
    if any(kind in {Kind.KINK, Kind.TIP} and x not in meant for x, _, kind in now):
        return True
    return any(kind == Kind.END and min(abs(x - y) for y in meant) > SETTLED * length for x, length, kind in now)
