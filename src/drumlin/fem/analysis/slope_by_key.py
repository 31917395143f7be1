"""The exact derivative of the torque by a key of the brake file, from the brake's sensitivities.

The adjoint method (fem.analysis.sensitivity) gives derivatives by physical quantities: friction, a
force, a modulus, a clearance or a coordinate of a hinge. This module finds the quantity to which a
key of the brake file belongs.
"""

import math

from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.fields import Material, PartOfInputFile, Point
from drumlin.brake.file import parts_and_field_name_of_brake_key
from drumlin.fem.analysis.sensitivity import ShoeSensitivity, TorqueSensitivities, WantedSlopes


def slopes_wanted_for_key(brake: Brake, key: str) -> WantedSlopes:
    """The slopes of the torque that `exact_torque_slope_by_key` needs for a key.

    Raises BadInput for an unknown key.
    """
    parts, _ = parts_and_field_name_of_brake_key(brake, key)
    hinges = [shoe.hinge for shoe in brake.shoes if shoe.hinge is not None]
    return WantedSlopes(
        moduli=any(isinstance(part, Material) for part in parts),
        supports=any(part is hinge for part in parts for hinge in hinges),
    )


def exact_torque_slope_by_key(brake: Brake, key: str, slopes: TorqueSensitivities) -> float | None:
    """The derivative of the torque with respect to a key's value; None if it is not known exactly.

    Parameters
    ----------
    brake : the brake
    key : the key of the brake file, as "shoe[0].hinge.x" or "friction"
    slopes : the sensitivities of this brake

    Returns
    -------
    slope [N m per SI unit of the key], on a plane [N per SI unit of the key]

    Raises
    ------
    BadInput
        for an unknown key
    """
    parts, name = parts_and_field_name_of_brake_key(brake, key)
    if parts == [brake]:
        # The known slope holds if the friction of all linings changes in proportion. The key
        # "friction" changes only linings without a coefficient of their own, so that the slope is
        # exact only if no lining has its own coefficient.
        is_exact = (
            name == "friction_as_written"
            and brake.first_key_that_gives_lining_its_own_friction() is None
        )
        return slopes.friction if is_exact else None
    of_springs = dict(zip(map(id, brake.springs), slopes.springs, strict=True))
    if len(parts) == 1 and id(parts[0]) in of_springs:
        by_field = of_springs[id(parts[0])]._asdict()
        return by_field[name] if name in ("preload", "rate") else None
    found = [
        _torque_slope_by_field_of_shoe(shoe, own, part, name)
        for shoe, own in zip(brake.shoes, slopes.shoes, strict=True)
        for part in parts
        if _is_one_of_parts_with_exact_slopes(shoe, part)
    ]
    known = [slope for slope in found if slope is not None]
    return math.fsum(known) if known and len(known) == len(parts) == len(found) else None


def _shoe_parts_whose_torque_slopes_are_exact(shoe: Shoe) -> list[PartOfInputFile | None]:
    """The parts of a shoe whose keys may have exact torque slopes; None for a missing part."""
    body = None if shoe.body is None else shoe.body.material
    return [shoe.actuation, shoe.hinge, shoe.lining, shoe.lining.material, body]


def _is_one_of_parts_with_exact_slopes(shoe: Shoe, part: PartOfInputFile) -> bool:
    """Whether a part is the same object as one of the shoe's parts with exact slopes."""
    return any(part is own for own in _shoe_parts_whose_torque_slopes_are_exact(shoe))


def _torque_slope_by_field_of_shoe(
    shoe: Shoe, slopes: ShoeSensitivity, part: PartOfInputFile, name: str
) -> float | None:
    """The derivative of the brake's torque by a field of a shoe's part; None if it is not known.

    Parameters
    ----------
    shoe : the shoe
    slopes : the sensitivities of the shoe
    part : the actuation, the hinge, the lining, or a material of the shoe
    name : name of the field, as "force", "E" or "x"
    """
    if part is shoe.actuation:
        return slopes.force if name == "force" else None
    if part is shoe.lining:
        return slopes.clearance if name == "clearance" else None
    if part is shoe.hinge and isinstance(part, Point):
        return _torque_slope_by_coordinate_of_hinge(part, slopes, name)
    if name != "E" or not isinstance(part, Material):
        return None
    of_modulus = slopes.moduli.get("lining" if part is shoe.lining.material else "shoe")
    return None if of_modulus is None else of_modulus / part.E


def _torque_slope_by_coordinate_of_hinge(
    hinge: Point, slopes: ShoeSensitivity, name: str
) -> float | None:
    """The derivative of the torque by "x", "y", "radius" or "angle" of a hinge; None if unknown."""
    if "hinge" not in slopes.held:
        return None
    by_x, by_y = map(float, slopes.held["hinge"])
    along_radius = (by_x * hinge.x + by_y * hinge.y) / hinge.radius if hinge.radius else None
    values = {
        "x": by_x,
        "y": by_y,
        "radius": along_radius,
        "angle": by_y * hinge.x - by_x * hinge.y,
    }
    return values.get(name)
