"""Devices that push several shoes of a brake: a wheel cylinder, a cam or wedge, a strut.

These devices give forces to shoes for which the brake file gives no force. A cylinder pushes every
shoe with the same force. A cam or a wedge moves the loaded ends of two shoes by the same distance.
The brake file gives the sum of the forces on both shoes, and the stiffnesses of the shoes decide
how the sum is divided between the shoes. A strut lies between two shoes: one shoe pushes on it with
its foot (the end away from the actuation), and the strut pushes the other shoe with the same force
along the same line.
"""

import math
from collections.abc import Collection
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, Field, model_validator

from drumlin.brake.components import Actuation
from drumlin.brake.fields import (
    PURE_NUMBER_VALIDATOR,
    Angle,
    Area,
    ElasticModulus,
    Force,
    Name,
    PartOfInputFile,
    Thickness,
    Torque,
)
from drumlin.brake.support import SupportedShoe


def _check_efficiency_is_no_number_of_percent(efficiency: object) -> object:
    """Raise ValueError for an efficiency of up to 100, which may be meant in per cent."""
    if isinstance(efficiency, int | float) and 1 < efficiency <= 100:
        raise ValueError(f"must be less than or equal to 1; did you mean '{efficiency:g} %'?")
    return efficiency


DriveEfficiency = Annotated[
    float,
    Field(gt=0, le=1, strict=True),
    BeforeValidator(_check_efficiency_is_no_number_of_percent),
    PURE_NUMBER_VALIDATOR,
]
"""The type of the efficiency of a drive, a number above 0 and up to 1."""


class BrakeChamber(PartOfInputFile):
    """A brake chamber: air pressure on a membrane pushes a rod against a return spring.

    Attributes
    ----------
    area : effective area [m^2] of the membrane
    pressure : pressure [Pa] of the air
    return_force : force [N] of the return spring on the rod
    lever : length [m] of the slack adjuster, square to the rod, that turns a cam; None for a wedge
    """

    area: Area
    pressure: ElasticModulus
    return_force: Annotated[Force, Field(ge=0)] = 0.0
    lever: Thickness | None = None

    @model_validator(mode="after")
    def _check_chamber_rod_pushes_against_spring(self) -> Self:
        """Raise ValueError unless the air pushes the rod against the force of the return spring."""
        if self.rod_force <= 0:
            raise ValueError(
                f"return_force = {self.return_force:g} N: must be less than pressure times area, "
                f"{self.pressure * self.area:g} N"
            )
        return self

    @property
    def rod_force(self) -> float:
        """The force [N] of the rod: pressure times area minus the force of the return spring."""
        return self.pressure * self.area - self.return_force


class DriveOfAllShoes(PartOfInputFile):
    """The drive of all shoes: a wheel cylinder, a cam or a wedge.

    A cylinder has a `pressure` [Pa] and a `diameter` [m]; below the `threshold` [Pa] it does not
    push. A cam has the sum `force` [N] of its forces on both shoes, or a `torque` [N m] and the
    `radius` [m] of its base circle. A brake `chamber` turns a cam by its lever, or pushes a wedge
    whose faces include the `wedge_angle` [rad]. `efficiency` is the part of the force that arrives
    at the shoes; friction in the drive takes the rest.
    """

    pressure: ElasticModulus | None = None
    diameter: Thickness | None = None
    threshold: ElasticModulus | None = None
    chamber: BrakeChamber | None = None
    wedge_angle: Annotated[Angle, Field(gt=0, lt=math.pi)] | None = None
    force: Force | None = None
    torque: Torque | None = None
    radius: Thickness | None = None
    efficiency: DriveEfficiency = 1.0

    @model_validator(mode="after")
    def _check_keys_of_cylinder_or_cam(self) -> Self:
        """Raise ValueError unless the given keys describe one cylinder, cam or wedge."""
        keys = ("pressure", "diameter", "force", "torque", "radius", "chamber", "wedge_angle")
        given = {key for key in keys if getattr(self, key) is not None}
        # Each of these sets of keys determines the force. Any other key could contradict the set.
        cylinder, by_chamber = {"pressure", "diameter"}, {"chamber", "radius"}
        wedge = {"chamber", "wedge_angle"}
        if given not in (cylinder, {"force"}, {"torque", "radius"}, by_chamber, wedge):
            raise ValueError(
                "needs pressure and diameter of a cylinder, "
                "or of a cam force (of both shoes), torque and radius, or chamber and radius, "
                "or of a wedge chamber and wedge_angle"
            )
        if self.chamber is not None and (self.chamber.lever is None) != (given == wedge):
            raise ValueError(
                "chamber.lever: is the slack adjuster of a cam; a cam needs it, a wedge has none"
            )
        threshold, pressure = self.threshold, self.pressure
        if threshold is not None and (pressure is None or threshold >= pressure):
            raise ValueError(
                f"threshold = {threshold * 1e-5:g} bar: "
                "must be less than the pressure of a cylinder"
            )
        return self

    @property
    def is_cam_or_wedge(self) -> bool:
        """Whether the drive is a cam or a wedge, which moves both loaded shoe ends equally."""
        return self.pressure is None

    @property
    def force_of_cylinder_or_sum_of_cam_forces(self) -> float:
        """Force [N] of a cylinder on each shoe, or of a cam or wedge on both shoes together."""
        # The force of a cylinder is the pressure above the threshold times the area of the piston.
        if self.pressure is not None and self.diameter is not None:
            acting = self.pressure - (self.threshold or 0.0)
            return self.efficiency * acting * math.pi * self.diameter**2 / 4
        if self.chamber is not None and self.chamber.lever is not None and self.radius is not None:
            return self.efficiency * self.chamber.rod_force * self.chamber.lever / self.radius
        # Each of the wedge's two faces pushes a shoe by F/(2 tan(angle/2)), with the rod's force F.
        if self.chamber is not None and self.wedge_angle is not None:
            return self.efficiency * self.chamber.rod_force / math.tan(0.5 * self.wedge_angle)
        if self.torque is not None and self.radius is not None:
            return self.efficiency * self.torque / self.radius
        return self.efficiency * (self.force or 0.0)

    @property
    def key_that_sets_forces(self) -> str:
        """The key of a brake file that sets the forces on the shoes, such as "actuation.pressure".

        Other keys, such as the diameter of the cylinder, change the forces as well.
        """
        if self.pressure is not None:
            return "actuation.pressure"
        if self.chamber is not None:
            return "actuation.chamber.pressure"
        return "actuation.force" if self.torque is None else "actuation.torque"


class StrutOrStrapBetweenShoes(PartOfInputFile):
    """A strut or a strap between two shoes.

    The shoe `from` bears on the strut by its abutment, and the strut pushes or pulls the shoe `to`
    with the same force along the same line. Several links make a chain; the file names them in
    order, beginning at the shoe that the actuation pushes.
    """

    source: Annotated[Name, Field(alias="from")]
    to: Name


def shoes_with_forces_of_drive_and_struts(brake: Any, *, file: bool) -> tuple[Any, ...]:
    """Return the shoes of a brake with the forces that its drive and its struts give them.

    A cylinder gives its force to each shoe, a cam or a wedge half of the sum of its forces. A shoe
    that a strut pushes gets the strut's line of action and the force 0: its force is known only
    when the brake is solved.

    Parameters
    ----------
    brake : the brake as its file describes it: shoes, drive, struts and springs
    file : whether the data come from a file, which must not give forces that a drive gives

    Raises
    ------
    ValueError
        if shoes, drive and struts do not fit together
    """
    shoes, drive, links = brake.shoes, brake.actuation, brake.links
    joined = (*brake.springs, *brake.levers)
    joined_names = {name for each in joined for name in (each.shoe, each.to)}
    # The drive pushes the shoes that no strut pushes.
    lines = _strut_actuations_by_shoe_index(shoes, links)
    pushed = [i for i in range(len(shoes)) if i not in lines]
    on_anchors = [shoe.name for shoe in shoes if shoe.anchors]
    if on_anchors and (lines or (drive is not None and drive.is_cam_or_wedge)):
        by = (
            "a cam"
            if drive is not None and drive.is_cam_or_wedge
            else "a strut that pushes one shoe only"
        )
        raise ValueError(
            f"shoe {on_anchors[0]!r}: a shoe on anchors takes a force of its own or of a cylinder; "
            f"no brake has anchors and {by}"
        )
    if drive is not None and drive.is_cam_or_wedge and len(pushed) != 2:
        raise ValueError(f"actuation: a cam moves two shoes, not {len(pushed)}")
    found = []
    for i, shoe in enumerate(shoes):
        if i in lines:
            if file and "actuation" in shoe.model_fields_set:
                raise ValueError(f"shoe[{i}].actuation: a strut pushes this shoe; leave it out")
            actuation = lines[i]
        elif drive is None and _is_shoe_pressed_without_actuation(shoe, joined_names):
            actuation = shoe.actuation
        else:
            actuation = _actuation_of_shoe_without_strut(f"shoe[{i}].actuation", shoe, drive, file)
        found.append(shoe.model_copy(update={"actuation": actuation}))
    return tuple(found)


def _is_shoe_pressed_without_actuation(shoe: Any, joined_names: Collection[str | None]) -> bool:
    """Whether a shoe has no actuation in the file, and another load presses it.

    The load is a force, a mass on which weight or rotation acts, a spring or a lever.
    `joined_names` are the names of the shoes with springs or levers. A shoe on a guide has its pin
    at the point of the actuation and thus needs an actuation.
    """
    loaded = bool(shoe.forces) or shoe.mass is not None or shoe.name in joined_names
    return loaded and shoe.guide is None and "actuation" not in shoe.model_fields_set


def _strut_actuations_by_shoe_index(
    shoes: tuple[Any, ...], links: tuple[StrutOrStrapBetweenShoes, ...]
) -> dict[int, Actuation]:
    """Actuations of force 0 with the lines of action of the struts, by the pushed shoe's index.

    A strut between two shoes on anchors gives no actuation: it is a support of both shoes, see
    `one_sided.one_sided_supports_of_brake`.

    Raises ValueError for a strut that names no shoe of the brake or does not fit its shoes.
    """
    places = {shoe.name: i for i, shoe in enumerate(shoes)}
    lines: dict[int, Actuation] = {}
    for k, link in enumerate(links):
        # The strut's line follows from its two shoes, so that both names must be known.
        for key, name in (("from", link.source), ("to", link.to)):
            if name not in places:
                raise ValueError(
                    f"link[{k}].{key} = {name!r}: must be the name of a shoe: {', '.join(places)}"
                )
        source, pushed = shoes[places[link.source]], shoes[places[link.to]]
        if source.anchors or pushed.anchors:
            _check_strut_joins_two_shoes_on_anchors(f"link[{k}]", source, pushed, links[:k], link)
            continue
        lines[places[link.to]] = _actuation_of_shoe_pushed_by_strut(
            f"link[{k}]", source, link, links[:k]
        )
    return lines


def key_that_sets_actuation_force_of_shoe(brake: Any, shoe: Any) -> str | None:
    """The key that sets the actuation force of a shoe in place of the shoe's own key `force`.

    It is a key of the brake's drive; without a drive, the force of the shoe at the beginning of a
    chain of struts. The result is None if the shoe's own key sets its force.
    """
    if brake.actuation is not None:
        return str(brake.actuation.key_that_sets_forces)
    # A strut between two shoes on anchors is a support, and gives no actuation.
    pushers = {link.to: link.source for link in brake.links} if not shoe.anchors else {}
    name = shoe.name
    while name in pushers:
        name = pushers[name]
    return None if name == shoe.name else f"shoe.{name}.actuation.force"


LARGEST_ANGLE_BETWEEN_STRUT_FORCES = 1e-9
"""Largest angle [rad] between the lines of the forces at a strut's two ends that is round-off.

The same limit holds for the distance of the two lines divided by the distance of the ends. A strut
beyond the limit could not be in equilibrium. Equal angles that a file gives in degrees differ by
less than the limit.
"""


def _check_strut_joins_two_shoes_on_anchors(
    key: str,
    source: SupportedShoe,
    to: SupportedShoe,
    before: tuple[StrutOrStrapBetweenShoes, ...],
    link: StrutOrStrapBetweenShoes,
) -> None:
    """Raise ValueError unless a strut pushes apart the abutments of two shoes on anchors.

    Parameters
    ----------
    key : key of the strut in error messages
    source, to : the shoes on which the strut pushes
    before : struts that the file names before this strut
    link : the strut
    """
    for shoe in (source, to):
        if not shoe.anchors or shoe.abutment is None:
            raise ValueError(
                f"{key}: a strut between shoes on anchors bears on an abutment of each; "
                f"shoe {shoe.name!r} needs anchor and abutment"
            )
    first, second = source.abutment, to.abutment
    assert first is not None and second is not None
    if source is to or any({link.source, link.to} & {b.source, b.to} for b in before):
        raise ValueError(f"{key}: a shoe on anchors bears on one strut, from another shoe")
    turn = math.remainder(second.direction - first.direction - math.pi, 2 * math.pi)
    between = first.point.xy - second.point.xy
    along = source.unit_vector_of_smooth_abutment_force
    off = abs(float(between[0] * along[1] - between[1] * along[0]))
    if (
        abs(turn) > LARGEST_ANGLE_BETWEEN_STRUT_FORCES
        or off > LARGEST_ANGLE_BETWEEN_STRUT_FORCES * math.hypot(*between)
        or between @ along <= 0
    ):
        raise ValueError(
            f"{key}: a strut pushes the feet of both shoes apart along one line; the abutments of "
            f"{link.source!r} and {link.to!r} must lie on it, with opposite directions along it"
        )


def _actuation_of_shoe_without_strut(
    key: str, shoe: Any, drive: DriveOfAllShoes | None, file: bool
) -> Actuation:
    """Actuation of a shoe that no strut pushes, with the force of the drive if there is a drive.

    Raises ValueError if the force is missing, or if a file gives it besides the drive.

    Parameters
    ----------
    key : key of the actuation in error messages
    shoe : shoe as the brake file describes it
    drive : drive of all shoes, or None
    file : whether the data come from a file
    """
    if "actuation" not in shoe.model_fields_set:
        raise ValueError(f"{key}: is missing")
    own: Actuation = shoe.actuation
    has_force = "force" in own.model_fields_set
    if drive is None and not has_force:
        raise ValueError(f"{key}.force: is missing")
    if drive is not None and file and has_force:
        raise ValueError(f"{key}.force: the brake's [actuation] gives it; leave one out")
    if drive is None:
        return own
    # A cam gives half of its sum to each shoe for now. How the sum is really divided follows from
    # the stiffnesses of the shoes in a solve.
    share = drive.force_of_cylinder_or_sum_of_cam_forces / (2 if drive.is_cam_or_wedge else 1)
    return own.model_copy(update={"force": share})


def _actuation_of_shoe_pushed_by_strut(
    key: str,
    source: SupportedShoe,
    link: StrutOrStrapBetweenShoes,
    before: tuple[StrutOrStrapBetweenShoes, ...],
) -> Actuation:
    """Actuation of the shoe that a strut pushes: the strut's line of action, with the force 0.

    Raises ValueError if the strut does not fit its shoes or the other struts.

    Parameters
    ----------
    key : key of the strut in error messages
    source : shoe whose abutment bears on the strut
    link : the strut
    before : struts that the file names before this strut
    """
    if source.abutment is None:
        raise ValueError(
            f"{key}.from = {link.source!r}: its shoe must bear on the strut by an abutment"
        )
    if source.abutment.friction > 0:
        raise ValueError(
            f"{key}.from = {link.source!r}: a strut pushes along its line; "
            "leave out abutment.friction"
        )
    # The file names the struts of a chain in order. The shoe that this strut pushes must therefore
    # not push a strut that the file has named before.
    if link.to == link.source or any(other.source == link.to for other in before):
        raise ValueError(
            f"{key}.to = {link.to!r}: must be a shoe that does not push another in a link before; "
            "name the links from the actuation on"
        )
    if any(other.to == link.to for other in before):
        raise ValueError(f"{key}.to = {link.to!r}: is pushed by two struts")
    if any(other.source == link.source for other in before):
        raise ValueError(f"{key}.from = {link.source!r}: bears on two struts")
    # The strut's force on the pushed shoe is opposite to its force on the other shoe's abutment.
    return Actuation(
        force=0.0, direction=source.abutment.direction + math.pi, point=source.abutment.point
    )


def reason_why_forces_follow_from_cam_or_strut(
    drive: DriveOfAllShoes | None, links: tuple[StrutOrStrapBetweenShoes, ...]
) -> str | None:
    """Text for an error message that the forces on the shoes follow from a cam or a strut.

    The result is None if the force on each shoe is known before the solve.
    """
    by = ["a cam"] * (drive is not None and drive.is_cam_or_wedge) + ["a strut"] * bool(links)
    return f"its shoes share their forces by {' and '.join(by)}" if by else None
