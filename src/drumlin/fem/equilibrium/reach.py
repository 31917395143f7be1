"""How far a shoe that stands off has to turn to touch, and where that is no small displacement."""

import math

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Shoe

LARGEST_TURN = 0.2  # rad; beyond it small displacements are no longer a model of the shoe's motion


def check_pin(shoe: Shoe, xy: Floats, gap: Floats, moment: float) -> None:
    """Raise NoAnswer where a shoe hinged in a drum would have to turn too far to touch, or could
    turn for ever.

    A lining point at distance d from the pin and angle psi reaches the radius r when it has turned
    by alpha: r^2 = a^2 + d^2 + 2 a d cos(psi + alpha), with a the pin's distance from the drum's
    centre.
    """
    if shoe.held_by != "hinge" or shoe.flat or (gap <= 0).any():
        return
    a, r = shoe.pin.radius, np.hypot(*xy)
    v = xy * ((r - shoe.sign * gap) / r) - np.array(
        [[a], [0.0]]
    )  # the lining stands back by its gap
    d, psi = np.hypot(*v), np.arctan2(v[1], v[0])
    cosine = (r**2 - a**2 - d**2) / (2 * a * d)
    meets = np.abs(cosine) <= 1
    if not meets.any():
        raise NoAnswer(
            f"shoe {shoe.name!r}: no equilibrium, the force turns it without its ever touching the drum"
        )
    angle = np.arccos(cosine[meets])
    turns = (
        math.copysign(1.0, moment)
        * (np.concatenate([angle, -angle]) - np.tile(psi[meets], 2))
        % (2 * math.pi)
    )
    _check(shoe, float(turns.min()))


def check_turns(shoe: Shoe, sense: int, gap: Floats, amounts: Floats) -> None:
    """Raise NoAnswer where a shoe that stands off everywhere, by its `gap` (n,) [m], has turned too
    far.

    sense: of the friction at its abutment, see `Held.freedoms`; amounts: of its free motions in an
    answer [rad, m]. Of a pin on a drum `check_pin` knows better.
    """
    if (shoe.held_by in {"hinge", "guide"} and not shoe.flat) or (gap <= 0).any():
        return
    names = shoe.freedoms(sense).names
    turns = [turn for turn, name in zip(amounts, names, strict=True) if name in {"turn", "tilt"}]
    _check(
        shoe, max(map(abs, (*turns, sum(turns))))
    )  # on a pivot the shoe turns with its lever and tilts on it


def _check(shoe: Shoe, turn: float) -> None:
    if turn > LARGEST_TURN:
        raise NoAnswer(
            f"shoe {shoe.name!r}: it would have to turn by {math.degrees(turn):.3g} deg to touch the "
            f"{shoe.surface.word}; small displacements hold up to {math.degrees(LARGEST_TURN):.3g} deg"
        )
