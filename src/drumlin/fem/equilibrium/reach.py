"""Checks that refuse shoes which would have to turn too far before they touch the drum."""

import math

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import AnswerBeyondModel, NoAnswer
from drumlin.brake.brake import Shoe

LARGEST_SHOE_TURN_BEFORE_CONTACT = 0.2
"""Largest rotation [rad] by which a shoe may have to turn before it touches the drum.

The model assumes small displacements: at this angle the sine differs from the angle by 0.7 %. A
shoe that has to turn by a larger angle is refused. The value is a judgement; the refusal prints it.
"""


def require_small_turn_of_hinged_shoe(shoe: Shoe, xy: Floats, gap: Floats, moment: float) -> None:
    """Raise NoAnswer if a hinged shoe has to turn too far to touch the drum, or never touches it.

    A lining point at the distance d and the polar angle psi from the pin reaches the radius r after
    a turn of the shoe by alpha, with r^2 = a^2 + d^2 + 2 a d cos(psi + alpha). Here a is the
    distance of the pin from the drum's centre.

    Parameters
    ----------
    shoe : the shoe; a shoe on a plane, or without a hinge, passes
    xy : contact nodes (2, n) [m] in the frame of the shoe
    gap : gaps (n,) [m] of the unloaded lining; a lining that touches anywhere passes
    moment : moment of all loads about the pin; its sign is the direction of the turn
    """
    if shoe.kind_of_support != "hinge" or shoe.is_on_plane or (gap <= 0).any():
        return
    a, r = shoe.pin.radius, np.hypot(*xy)
    # The contact nodes lie on the drum's radius. The unloaded lining stands back from them by its
    # gap.
    lining = xy * ((r - shoe.sign_internal_plus_external_minus * gap) / r)
    from_pin = lining - np.array([[a], [0.0]])
    d = np.hypot(*from_pin)
    psi = np.arctan2(from_pin[1], from_pin[0])
    cosine = (r**2 - a**2 - d**2) / (2 * a * d)
    meets = np.abs(cosine) <= 1
    if not meets.any():
        raise NoAnswer(
            f"shoe {shoe.name!r}: no equilibrium, "
            "the force turns it without its ever touching the drum"
        )
    # Each point of the lining meets the drum at two angles. The angle that the turning shoe reaches
    # first counts.
    angle = np.arccos(cosine[meets])
    both = np.concatenate([angle, -angle])
    turns = math.copysign(1.0, moment) * (both - np.tile(psi[meets], 2)) % (2 * math.pi)
    _require_small_turn_of_shoe(shoe, float(turns.min()))


def require_small_shoe_turns_in_contact_solution(
    shoe: Shoe, sense: int, gap: Floats, coordinates: Floats
) -> None:
    """Raise NoAnswer if a shoe turns too far in the solution of its contact.

    Only a shoe whose whole lining has a gap while it is unloaded is checked. A hinged shoe in a
    drum passes, because `require_small_turn_of_hinged_shoe` judges it by its geometry. A guided
    shoe in a drum passes too.

    Parameters
    ----------
    shoe : the shoe
    sense : direction of the friction at its abutment: +1 or -1 along the face, 0 if the foot
        sticks, see `SupportedShoe.rigid_body_modes_of_support`
    gap : gaps (n,) [m] of the unloaded lining; a lining that touches anywhere passes
    coordinates : generalised coordinates (k,) [rad, m] of the shoe in the solution
    """
    if (shoe.kind_of_support in {"hinge", "guide"} and not shoe.is_on_plane) or (gap <= 0).any():
        return
    turns = coordinates[np.isin(shoe.rigid_body_modes_of_support(sense).names, ["turn", "tilt"])]
    # A shoe on a pivot turns with its lever and tilts on the lever. Each of the two turns counts,
    # and so does their sum.
    _require_small_turn_of_shoe(shoe, max(map(abs, (*turns, sum(turns)))))


def _require_small_turn_of_shoe(shoe: Shoe, turn: float) -> None:
    """Raise NoAnswer for a turn [rad] beyond LARGEST_SHOE_TURN_BEFORE_CONTACT."""
    if turn > LARGEST_SHOE_TURN_BEFORE_CONTACT:
        raise AnswerBeyondModel(
            f"shoe {shoe.name!r}: it would have to turn by {math.degrees(turn):.3g} deg "
            f"to touch the {shoe.surface.name}; small displacements hold up to "
            f"{math.degrees(LARGEST_SHOE_TURN_BEFORE_CONTACT):.3g} deg"
        )
