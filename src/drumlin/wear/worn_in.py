"""The clearance of worn-in linings: with it they bear by the rigid-shoe law, however elastic the
brake.

Wear ends where all points of the lining wear as the shoe moves: p ~ sin(phi) about a hinge. On the
mesh this is the pressure p of steady wear, see `archard.steady`. With the motions y' of the shoe

    w' = M p + B y' >= 0,   p >= 0,   p w' = 0,   C p = h

where M weighs a gap (fem.interface), and friction at the abutments acts as y' has it. The brake
bears by the same p under its load if, for some motions y, its unloaded linings have the gap g with

    w = M g + q + A p + B y >= 0,   p w = 0

where q is the weighted gap that the actuation opens and A p the one that the pressure opens. Let c
= M^-1 (q + A p) be both together as a gap. For any motions y0 of the shoe and any a >= 0 the
choice

    g = a p - c - M^-1 B y0,   y = y0 + a y'   gives   w = a (M p + B y') = a w'

This w is 0 where the law presses and not negative where the law lifts the lining: the brake bears
by exactly p. The amounts a and y0 are free, and are chosen so:

- a > 0 is the depth of even wear per pressure. A negative one would push the lifted part into the
  drum. A small depth is enough, see EVEN_WEAR.
- y0 is where the unloaded shoe rests. It leaves a foot on a rough abutment where it is, so that the
  foot slides by a y' alone: friction opposes its slide and must act as in steady wear. It is the
  motion nearest to c, plus as much of the motion that closes the gap most evenly as keeps all of
  -c - M^-1 B y0 from being negative. So the unloaded lining does not lie in the drum. The motion y'
  would not do in place of the even one: where the pressed part ends, y' moves the lining along the
  drum, and no amount of y' keeps the drum free there.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import scipy.linalg

from drumlin.arrays import Floats
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.fields import Rows, rows_of
from drumlin.errors import NoAnswer
from drumlin.fem.assembly import Scene
from drumlin.fem.model import PENALTY, respond
from drumlin.fem.solve import scene_of
from drumlin.foundation.model import RING_SECTIONS, lifted, system
from drumlin.foundation.post import shoe_angles
from drumlin.laws import sine
from drumlin.response import Response
from drumlin.response.merit import with_merits
from drumlin.wear.archard import WearInterface, WearLaw, steady
from drumlin.wear.linings import fem_setup

LEAST_CLOSING = 0.01
"""Closing of the gap by the most even motion, relative to the largest one along the lining, below
which a node is left out when the unloaded lining is kept off the drum.

Such nodes are near the line through hinge and drum's centre. Only a motion a hundred times as large
would keep them off the drum. A judgement; the pressure does not depend on it."""
EVEN_WEAR = 1e-3
"""Largest depth of even wear a p relative to the largest elastic gap that the shoe's motions leave.

It must be far above round-off, 1e-12, so that the lifted part stands off the drum and rough feet
slide as in steady wear. A depth as large as the gap makes soft shoes turn further than they need
to. A judgement; the pressure does not depend on it."""


def solve(brake: Brake, *, penalty: float = PENALTY, **options: Any) -> Response:
    """The response of a brake of finite elements with linings that are worn in; `options` of
    `scene_of`.
    """
    scene = scene_of(brake, **options)
    return with_merits(brake, respond(scene, worn_in(scene, brake), penalty=penalty))


def worn_in(scene: Scene, brake: Brake) -> Brake:
    """The brake with every clearance and misfit of its linings replaced by those that wear ends
    with.

    A drum that is not round stays so: as it turns it wears the lining evenly, as far as the whole
    lining stays in contact. Raises NoAnswer for a self-locking shoe.
    """
    setup = fem_setup(scene, fitted(brake, drum=True))
    gaps: dict[int, Rows] = {}
    for number, interface in enumerate(setup.interfaces):
        own = [surface for surface in setup.surfaces if surface.interface == number]
        linings = [surface.local for surface in own]
        # Shoes under a cam or behind a strut move together, so all their linings are one.
        gap = _worn_gap(interface, linings if brake.shares is None else [slice(None)])
        for surface in own:
            gaps[surface.shoe] = rows_of(surface.angles, gap[surface.local][surface.forward])
    return fitted(fitted(brake), gaps)


def _worn_gap(interface: WearInterface, linings: list[slice]) -> Floats:
    """The gap (n,) [m] of the unloaded linings of an interface, see above.

    linings: the unknowns of those that move each by itself.
    """
    end = steady(interface, WearLaw(1.0))
    footing, M, p = interface.footings[end.footing], interface.weight, end.contact.p
    A, q, B, *_ = footing.problem
    # The motions that leave each rough foot where it is are those of the footing with the fewest.
    resting = min(
        (each.problem.B for each in interface.footings), key=lambda motions: motions.shape[1]
    )
    solved = scipy.linalg.solve(M, np.column_stack([q + A @ p, resting]), assume_a="pos")
    opened, approach = solved[:, 0], -solved[:, 1:]
    # The motions y0 for which -M^-1 B y0 comes nearest to c and to 1, in least squares.
    weight = np.sqrt(np.abs(interface.area))[:, None]
    wanted = np.column_stack([opened, np.ones(len(p))])
    nearest, evenly = np.linalg.lstsq(approach * weight, wanted * weight, rcond=None)[0].T
    bent, closing = opened - approach @ nearest, approach @ evenly
    rest = nearest
    for part in linings:
        moves = closing[part] >= LEAST_CLOSING * closing[part].max()
        amount = float((bent[part][moves] / closing[part][moves]).max())
        own = np.any(resting[part] != 0, axis=0)
        rest[own] += amount * evenly[own]
    worn = EVEN_WEAR * np.abs(bent).max() / p.max()
    among_all = np.linalg.lstsq(B, resting @ rest, rcond=None)[0]
    if not footing.stands(replace(end.contact, y=among_all + worn * end.contact.y)):
        raise NoAnswer("worn in, a foot hardly slides: friction may act on it in more than one way")
    return worn * p - opened + approach @ rest


def fitted(brake: Brake, gaps: Mapping[int, Rows] | None = None, *, drum: bool = False) -> Brake:
    """The brake with linings that fit, but for the clearances `gaps` by shoe; drum: and on a round
    drum.
    """

    def fit(i: int, shoe: Shoe) -> Shoe:
        clearance = (gaps or {}).get(i, 0.0)
        lining = shoe.lining.model_copy(
            update={"clearance": clearance, "misfit": type(shoe.lining.misfit)()}
        )
        return shoe.model_copy(update={"lining": lining})

    shoes = tuple(fit(i, shoe) for i, shoe in enumerate(brake.shoes))
    return (brake.round() if drum else brake).model_copy(update={"shoes": shoes})


def worn_in_foundation(
    brake: Brake, *, sections: int = RING_SECTIONS, lift: Iterable[str] = ()
) -> Brake:
    """The brake with every clearance and misfit replaced by that at which the foundation model
    bears by the sine law.

    Raises NoAnswer for a self-locking shoe.
    """
    names, law = lifted(brake, lift), sine(brake)
    fitting = fitted(brake, drum=True)
    gaps: dict[int, Rows] = {}
    shoes = list(range(len(brake.shoes)))
    for group in [shoes] if "own-pressure" in names else [[i] for i in shoes]:
        parts = system(fitting, group, sections, names)
        angles = [
            shoe_angles(p.axis, brake.shoes[i], p.theta)
            for i, p in zip(group, parts.posts, strict=True)
        ]
        N = np.concatenate(
            [
                law.shoes[i].pressure_at(theta)
                * brake.shoes[i].lining.width
                * brake.size
                * p.sector
                for i, theta, p in zip(group, angles, parts.posts, strict=True)
            ]
        )
        closed = (
            parts.problem.q + parts.problem.A @ N
        )  # what the clearance and the shoe's turn must make up
        first = 0
        for i, theta, p in zip(group, angles, parts.posts, strict=True):
            own = closed[first : first + len(theta)]
            first += len(theta)
            gap = (
                p.closing[0] * np.max(own / p.closing[0]) - own
            )  # made up for by a turn of the shoe
            gaps[i] = rows_of(theta[:: p.axis.sense], gap[:: p.axis.sense])
    return fitted(fitting, gaps)
