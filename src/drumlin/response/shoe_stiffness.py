"""How stiff the shoes of a brake are, and how far off the drum's radius their linings may be.

Both numbers decide whether the pressure laws of rigid shoes hold for a brake, see the page "Which
law may I trust" of the manual.
"""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from drumlin.base.texts import number_as_text
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import ArcBody, Lining, stiffnesses_of_bonded_plates
from drumlin.brake.heat import names_of_heated_parts
from drumlin.brake.surface import FRICTION_SURFACE_OF_DRUM
from drumlin.response.response import Response, ShoeResponse

SMALLEST_STIFFNESS_RATIO_OF_STIFF_SHOE = 0.15
"""Stiffness ratio S from which on a shoe is called stiff.

The sine law is off the torque of brakes with such shoes by at most some 7 % up to a friction
coefficient of 0.4. The page "Which law may I trust" of the manual shows the errors over S. The
value changes no result.
"""


class ShoeStiffnessAndLiningCompression(NamedTuple):
    """How stiff a shoe is beside its lining, and by how much the pressure compresses the lining.

    Attributes
    ----------
    shoe : name of the shoe
    stiffness_ratio : S = 12 EI t/(E b R^4), bending stiffness EI [N m^2] of the body, and modulus
        E, thickness t and width b of the lining, on a drum of radius R. For a body of the lining's
        width it is E_b h^3 t/(E R^4). Infinite for a rigid shoe
    mean_compression : p t/E [m] of the lining with its mean pressure p; 0 without contact
    radius_difference : radius of the lining minus that of the drum [m], by its `misfit.radius`.
        An even clearance makes the lining of an internal shoe smaller, of an external shoe larger.
    not_counted : what else moves the faces of the lining and of the drum: the lining's other misfit
        such as a taper, heat, and the shape of the drum
    """

    shoe: str
    stiffness_ratio: float
    mean_compression: float
    radius_difference: float
    not_counted: tuple[str, ...] = ()

    def as_text(self) -> str:
        """What both numbers say about the shoe and its lining, without the shoe's name."""
        S = self.stiffness_ratio
        least = SMALLEST_STIFFNESS_RATIO_OF_STIFF_SHOE
        kind = "stiff" if least <= S else "flexible"
        # Two digits would print 0.148 as 0.15, the limit itself.
        texts = [f"{S:.{digits}g}" for digits in (2, 3, 17)]
        ratio = next(text for text in texts if (least <= float(text)) == (least <= S))
        shoe = "rigid" if math.isinf(S) else f"{kind}, S = {ratio} (stiff from {least:g} on)"
        if not self.mean_compression:
            return shoe
        off = abs(self.radius_difference)
        fits = "fits" if off <= self.mean_compression else "does not fit"
        radius = "its radius is the drum's"
        if off:
            sign = "smaller" if self.radius_difference < 0 else "larger"
            radius = f"its radius is {number_as_text(1e6 * off, '.3g')} µm {sign} than the drum's"
        other = f", {' and '.join(self.not_counted)} not counted" if self.not_counted else ""
        return (
            f"{shoe}; its lining {fits}: {radius}, and may be off by its mean compression "
            f"p t/E = {number_as_text(1e6 * self.mean_compression, '.2g')} µm{other}"
        )


def stiffness_ratio_of_shoe(shoe: Shoe, drum_radius: float) -> float | None:
    """The ratio S of the bending of a shoe's body to the compression of its lining.

    `ShoeStiffnessAndLiningCompression` has the formula. The result is infinite for a rigid shoe,
    and None for a shoe that is no arc of constant section. `drum_radius` is in m.
    """
    if shoe.body is None and shoe.mesh is None:
        return math.inf
    if not isinstance(shoe.body, ArcBody) or shoe.mesh is not None:
        return None
    lining = shoe.lining
    EI = stiffnesses_of_bonded_plates(list(shoe.body.plates.values())).EI
    E = lining.material.E_through
    return 12 * EI / lining.width * lining.thickness / (E * drum_radius**4)


def lining_compression_by_normal_force(
    shoe: Shoe, response: ShoeResponse, drum_radius: float
) -> float:
    """The compression p t/E [m] of a lining under its mean pressure p.

    The mean pressure is the normal force of the shoe's response over the area of the lining's face.
    `drum_radius` is in m.
    """
    lining = shoe.lining
    length = drum_radius * sum(end - start for start, end in lining.arcs)
    pressure = response.normal_force / (lining.width * length)
    return pressure * lining.thickness / lining.material.E_through


def stiffness_and_compression_of_shoes(
    brake: Brake, response: Response
) -> list[ShoeStiffnessAndLiningCompression]:
    """The stiffness ratio and the lining's mean compression of each shoe on a drum.

    Shoes on a plane, on the mesh of a file and with a straight beam have no such numbers, and are
    left out.
    """
    found: list[ShoeStiffnessAndLiningCompression] = []
    if brake.surface is not FRICTION_SURFACE_OF_DRUM:
        return found
    radius = brake.size
    for shoe, answer in zip(brake.shoes, response.shoes, strict=True):
        ratio = stiffness_ratio_of_shoe(shoe, radius)
        if ratio is None:
            continue
        linings = shoe.lining.linings
        differences = [_radius_difference_of_lining(part, shoe, radius) for part in linings]
        found.append(
            ShoeStiffnessAndLiningCompression(
                shoe.name,
                ratio,
                lining_compression_by_normal_force(shoe, answer, radius),
                max(differences, key=abs),
                tuple(_deviations_besides_radius_of_lining(brake, linings)),
            )
        )
    return found


def _radius_difference_of_lining(lining: Lining, shoe: Shoe, drum_radius: float) -> float:
    """Radius of a lining minus that of the drum [m], by `misfit.radius` and an even clearance."""
    ground = lining.misfit.radius
    difference = 0.0 if ground is None else ground - drum_radius
    if isinstance(lining.clearance, float):
        difference -= shoe.sign_internal_plus_external_minus * lining.clearance
    return difference


def _deviations_besides_radius_of_lining(brake: Brake, linings: Sequence[Lining]) -> Iterator[str]:
    """Yield in words what moves the faces of linings and drum besides the radius of the linings."""
    if any(_has_lining_misfit_besides_its_radius(lining) for lining in linings):
        yield "its other misfit"
    is_heated = bool(names_of_heated_parts(brake))
    if is_heated:
        yield "heat"
    # The growth of a heated drum is a harmonic of order 0.
    harmonics = brake.out_of_round_harmonics
    if any(harmonic.order for harmonic in harmonics) or (harmonics and not is_heated):
        yield "the drum's out_of_round"


def _has_lining_misfit_besides_its_radius(lining: Lining) -> bool:
    """Whether a lining has an uneven clearance, an offset, a taper or blocks that stand back."""
    misfit = lining.misfit
    return bool(
        not isinstance(lining.clearance, float)
        or misfit.offset.radius
        or misfit.taper
        or misfit.blocks
    )


def lines_on_stiff_shoes_and_fitting_linings(brake: Brake, response: Response) -> Iterator[str]:
    """Yield a line of text for each shoe: whether the shoe is stiff, and whether its lining fits.

    These lines decide on the pressure laws that hold for the brake.
    """
    for each in stiffness_and_compression_of_shoes(brake, response):
        yield f"shoe {each.shoe!r}: {each.as_text()}"
