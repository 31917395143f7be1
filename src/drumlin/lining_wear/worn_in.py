"""The clearance of worn-in linings: they then bear by the rigid-shoe law on an elastic brake, too.

Wear ends where all points of the lining wear as the shoe moves: p ~ sin(phi) about a hinge. On the
mesh this is the pressure p of steady wear, see `archard.solve_steady_wear`. With the motions y' of
the shoe it satisfies

    w' = M p + B y' >= 0,   p >= 0,   p w' = 0,   C p = h

where M weighs a gap (fem.substructure.interface), and friction at the abutments opposes y'. The
brake bears by the same p under its load if, for some motions y, its unloaded linings have the gap g
with

    w = M g + q + A p + B y >= 0,   p w = 0

where the actuation opens the weighted gap q and the pressure the weighted gap A p. Let c = M^-1 (q
+ A p) be both together as a gap. For any motions y0 of the shoe and any a >= 0 the choice

    g = a p - c - M^-1 B y0,   y = y0 + a y'   gives   w = a (M p + B y') = a w'

This w is 0 where the law presses and not negative where the law lifts the lining: the brake bears
by exactly p. The amounts a and y0 are free. The module chooses them by these rules:

- a > 0 is the depth of even wear per pressure. A negative a would push the lifted part into the
  drum. A small depth is enough, see EVEN_WEAR.
- y0 is the position in which the unloaded shoe rests. It does not move a foot on a rough abutment.
  The foot then slides by a y' alone, and friction acts on it as in steady wear. y0 is the motion
  nearest to c plus a part of the motion that closes the gap most evenly. This part is just large
  enough that -c - M^-1 B y0 is nowhere negative, so that the unloaded lining does not lie in the
  drum. The motion y' cannot take the place of the even motion: where the pressed part ends, y'
  moves the lining along the drum, and no amount of y' keeps the drum free there.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np
import scipy.linalg

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.fields import Rows, rows_of
from drumlin.fem.model import PENALTY, solve_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.solve import prepare_finest_division
from drumlin.foundation.model import RING_SECTIONS, included_effects, system
from drumlin.foundation.post import shoe_angles
from drumlin.laws import sine
from drumlin.lining_wear.archard import WearInterface, WearLaw, solve_steady_wear
from drumlin.lining_wear.linings import fem_wear_setup
from drumlin.response import Response
from drumlin.response.merit import with_merits

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


def solve_worn_in_brake(brake: Brake, *, penalty: float = PENALTY, **options: Any) -> Response:
    """Solve a brake with worn-in linings by finite elements; `options` as of `solve`."""
    scene = prepare_finest_division(brake, **options)
    return with_merits(
        brake, solve_prepared_model(scene, worn_in_brake(scene, brake), penalty=penalty)
    )


def worn_in_brake(scene: PreparedModel, brake: Brake) -> Brake:
    """The brake with the clearances that wear ends with, in place of its own and its misfit.

    A drum that is not round stays so: as it turns it wears the lining evenly, as long as the whole
    lining stays in contact. Raises NoAnswer for a self-locking shoe.
    """
    setup = fem_wear_setup(scene, remove_misfit(brake, drum=True))
    gaps: dict[int, Rows] = {}
    for number, interface in enumerate(setup.interfaces):
        surfaces = [surface for surface in setup.surfaces if surface.interface == number]
        # Shoes under a cam or behind a strut move together, so all their linings count as one.
        linings = [slice(None)]
        if brake.shares is None:
            linings = list(map(attrgetter("local"), surfaces))
        gap = _worn_in_gap(interface, linings)
        for surface in surfaces:
            along = gap[surface.local][surface.forward]
            gaps[surface.shoe] = rows_of(surface.angles, along)
    return remove_misfit(remove_misfit(brake), gaps)


def _worn_in_gap(interface: WearInterface, linings: list[slice]) -> Floats:
    """The gap g (n,) [m] of the unloaded linings of an interface, see the head of this module.

    `linings` are the unknowns of those linings that move each by itself. Raises NoAnswer.
    """
    end = solve_steady_wear(interface, WearLaw(1.0))
    footing, M, p = interface.footings[end.footing], interface.weight, end.contact.p
    A, q, B, *_ = footing.problem
    # The footing with the fewest motions is that in which each rough foot stays where it is.
    resting = min(map(attrgetter("problem.B"), interface.footings), key=lambda B: B.shape[1])
    solved = scipy.linalg.solve(M, np.column_stack([q + A @ p, resting]), assume_a="pos")
    # opened is c, and approach y closes the gap by a motion y.
    opened, approach = solved[:, 0], -solved[:, 1:]
    motions = _resting_motions(interface, opened, approach)
    rest, bent = motions.nearest, opened - approach @ motions.nearest
    closing = approach @ motions.evenly
    for part in linings:
        # The even motion keeps all nodes off the drum that it moves towards the drum.
        moves = closing[part] >= LEAST_CLOSING * closing[part].max()
        amount = float((bent[part][moves] / closing[part][moves]).max())
        own_motions = np.any(resting[part] != 0, axis=0)
        rest[own_motions] += amount * motions.evenly[own_motions]
    depth_per_pressure = EVEN_WEAR * np.abs(bent).max() / p.max()
    # The footing judges the slide by its own motions, among which are the slides of the feet.
    rest_among_all = np.linalg.lstsq(B, resting @ rest, rcond=None)[0]
    y = rest_among_all + depth_per_pressure * end.contact.y
    if not footing.stands(replace(end.contact, y=y)):
        raise NoAnswer("worn in, a foot hardly slides: friction may act on it in more than one way")
    return depth_per_pressure * p - opened + approach @ rest


class _RestingMotions(NamedTuple):
    """Motions (m,) of the shoes that come nearest to an opening, and that close the gap evenly."""

    nearest: Floats
    evenly: Floats


def _resting_motions(interface: WearInterface, opened: Floats, approach: Floats) -> _RestingMotions:
    """The motions y0 for which -M^-1 B y0 comes nearest to c and to 1, in least squares.

    Parameters
    ----------
    interface : the linings
    opened : c (n,) [m]
    approach : -M^-1 B (n, m)
    """
    weight = np.sqrt(np.abs(interface.area))[:, None]
    wanted = np.column_stack([opened, np.ones(len(opened))])
    nearest, evenly = np.linalg.lstsq(approach * weight, wanted * weight, rcond=None)[0].T
    return _RestingMotions(nearest, evenly)


def remove_misfit(
    brake: Brake, gaps: Mapping[int, Rows] | None = None, *, drum: bool = False
) -> Brake:
    """The brake with linings that fit the drum, without misfit.

    Parameters
    ----------
    brake : the brake
    gaps : clearances that some linings get nevertheless, by the position of the shoe
    drum : whether the drum becomes round, too
    """

    def fit(i: int, shoe: Shoe) -> Shoe:
        """The shoe number i with a lining that fits the drum but for its clearance in `gaps`."""
        clearance = (gaps or {}).get(i, 0.0)
        no_misfit = type(shoe.lining.misfit)()
        lining = shoe.lining.model_copy(update={"clearance": clearance, "misfit": no_misfit})
        return shoe.model_copy(update={"lining": lining})

    shoes = tuple(fit(i, shoe) for i, shoe in enumerate(brake.shoes))
    return (brake.round() if drum else brake).model_copy(update={"shoes": shoes})


def worn_in_foundation_brake(
    brake: Brake, *, sections: int = RING_SECTIONS, lift: Iterable[str] = ()
) -> Brake:
    """The brake with the clearances at which the foundation model bears by the sine law.

    They replace every clearance and misfit.

    Parameters
    ----------
    brake : the brake
    sections : along each lining
    lift : simplifications that the model includes after all

    Raises
    ------
    NoAnswer
        for a self-locking shoe
    """
    names, law = included_effects(brake, lift), sine(brake)
    fitting = remove_misfit(brake, drum=True)
    shoes = list(range(len(brake.shoes)))
    gaps: dict[int, Rows] = {}
    for group in [shoes] if "own-pressure" in names else [[i] for i in shoes]:
        model = system(fitting, group, sections, names)
        forces, angles = [], []
        for i, post in zip(group, model.posts, strict=True):
            theta = shoe_angles(post.axis, brake.shoes[i], post.theta)
            angles.append(theta)
            width = brake.shoes[i].lining.width
            forces.append(law.shoes[i].pressure_at(theta) * width * brake.size * post.sector)
        # The clearance and the turn of the shoe must make up for this gap.
        opened = model.problem.q + model.problem.A @ np.concatenate(forces)
        parts = np.split(opened, np.cumsum(list(map(len, angles)))[:-1])
        for k, post in enumerate(model.posts):
            own, theta = parts[k], angles[k]
            # A turn of the shoe closes the gap until it touches at one place.
            gap = post.closing[0] * np.max(own / post.closing[0]) - own
            gaps[group[k]] = rows_of(theta[:: post.axis.sense], gap[:: post.axis.sense])
    return remove_misfit(fitting, gaps)
