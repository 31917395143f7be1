"""A brake on finer and finer divisions, each moved to the ends of the contact that the one before it found."""

import math
from collections.abc import Iterator
from typing import NamedTuple, Protocol

from drumlin.brake.drum_brake import Brake
from drumlin.errors import NoAnswer
from drumlin.fem import assembly
from drumlin.fem.hp.division import Level
from drumlin.fem.hp.places import places_of
from drumlin.fem.hp.scene import Places, scene
from drumlin.response.response import Response

DEG = math.pi / 180
LEVELS = (
    Level(3, zone=0.6, edge=0.12, end=0.15, ratio=0.25, largest=20 * DEG, face=0.35, back=0.6, hinge=0.6, through=0.15),
    Level(
        4, zone=0.2, edge=0.06, end=0.035, ratio=0.35, largest=20 * DEG, face=0.2, back=0.25, hinge=0.25, through=0.16
    ),
    Level(
        5, zone=0.07, edge=0.025, end=0.008, ratio=0.4, largest=16 * DEG, face=0.08, back=0.09, hinge=0.09, through=0.17
    ),
    Level(
        6,
        zone=0.025,
        edge=0.01,
        end=0.002,
        ratio=0.42,
        largest=15 * DEG,
        face=0.03,
        back=0.03,
        hinge=0.03,
        through=0.18,
    ),
    Level(
        7,
        zone=0.008,
        edge=0.004,
        end=0.0005,
        ratio=0.45,
        largest=15 * DEG,
        face=0.012,
        back=0.011,
        hinge=0.011,
        through=0.2,
    ),
    Level(
        7,
        zone=0.0025,
        edge=0.0015,
        end=0.00012,
        ratio=0.45,
        largest=12 * DEG,
        face=0.005,
        back=0.004,
        hinge=0.004,
        through=0.22,
    ),
)
"""Each has about a quarter of the error of the one before it."""
MOST_PASSES = 8
SETTLED = 0.1  # of the length of the contact: an end of it is located by the first level where it moves by less


class Respond(Protocol):
    """What answers for a brake on a scene, from the contact of an earlier response."""

    def __call__(self, scene: assembly.Scene, brake: Brake, *, start: Response | None = None) -> Response:
        """The response."""


class Step(NamedTuple):
    """A level's scene and response."""

    scene: assembly.Scene
    response: Response


def steps(brake: Brake, respond: Respond) -> Iterator[Step]:
    """The brake on all levels, finer and finer. Raises NoAnswer where two levels have none."""
    last: Response | None = None
    refused = 0
    for level in LEVELS:
        for _ in range(MOST_PASSES):
            places = places_of(brake, last)
            made = scene(brake, level, places)
            try:
                found = respond(made, brake, start=last)
            except NoAnswer:
                refused += 1
                if refused == 2:
                    raise
                break
            first, last = last is None, found
            if not _moved(brake, places, found, new=first):
                yield Step(made, found)
                break
        else:
            yield Step(made, found)


def _moved(brake: Brake, places: Places, found: Response, *, new: bool) -> bool:
    """Whether an end of the contact is away from where the columns end, over the length that it bounds."""
    for key, ends in places_of(brake, found).items():
        meant = [place[0] for place in places.get(key, ())]
        for x, length, kink in ends:
            if not kink and min((abs(x - y) for y in meant), default=math.inf) > SETTLED * length:
                return True
    return False
