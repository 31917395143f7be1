"""What pushes the shoes of a brake where their own tables do not say: a wheel cylinder, a cam or
wedge, a strut.

A cylinder pushes every shoe with the same force. A cam moves the tips of two shoes equally; its
file says the sum of both forces, and how it is shared follows from the shoes. A strut passes on
what the foot of one shoe bears on: it is the abutment of that shoe and pushes the other along the
same line.
"""

import math
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from drumlin.brake.components import Actuation
from drumlin.brake.fields import Force, Modulus, Name, Part, Thickness, Torque
from drumlin.brake.support import Held

Efficiency = Annotated[float, Field(gt=0, le=1, strict=True)]


class Drive(Part):
    """What pushes all shoes: a cylinder of `pressure` [Pa] and `diameter` [m]; or a cam, by the sum
    `force` [N] of what it does to both shoes, or by its `torque` [N m] and base `radius` [m].
    `efficiency`: what of it arrives.
    """

    pressure: Modulus | None = None
    diameter: Thickness | None = None
    force: Force | None = None
    torque: Torque | None = None
    radius: Thickness | None = None
    efficiency: Efficiency = 1.0

    @model_validator(mode="after")
    def _whole(self) -> Self:
        given = {
            key
            for key in ("pressure", "diameter", "force", "torque", "radius")
            if getattr(self, key) is not None
        }
        if given not in ({"pressure", "diameter"}, {"force"}, {"torque", "radius"}):
            raise ValueError(
                "needs pressure and diameter of a cylinder, or of a cam force (of both shoes) or torque and radius"
            )
        return self

    @property
    def is_cam(self) -> bool:
        """Whether it moves the tips of both shoes equally."""
        return self.pressure is None

    @property
    def total(self) -> float:
        """Of a cam: the sum of the forces on both shoes [N]; of a cylinder: the force on each."""
        if self.pressure is not None and self.diameter is not None:
            return self.efficiency * self.pressure * math.pi * self.diameter**2 / 4
        if self.torque is not None and self.radius is not None:
            return self.efficiency * self.torque / self.radius
        return self.efficiency * (self.force or 0.0)


class Link(Part):
    """A strut or a strap: the abutment of the shoe `from` is on it, and it pushes or pulls the shoe
    `to` along the line of that force. Several make a chain, named from the actuation on.
    """

    source: Annotated[Name, Field(alias="from")]
    to: Name


def driven(
    shoes: tuple[Any, ...], drive: Drive | None, links: tuple[Link, ...], *, file: bool
) -> tuple[Any, ...]:
    """The shoes with what pushes them: those of a drive with its force, of a cam with half of it,
    those behind a strut with its line and no force of their own. Raises ValueError; file: what a
    drive overrules must not be given.
    """
    places = {shoe.name: i for i, shoe in enumerate(shoes)}
    lines: dict[int, Actuation] = {}
    for k, link in enumerate(links):
        for key, name in (("from", link.source), ("to", link.to)):
            if name not in places:
                raise ValueError(
                    f"link[{k}].{key} = {name!r}: must be the name of a shoe: {', '.join(places)}"
                )
        lines[places[link.to]] = _line(f"link[{k}]", shoes[places[link.source]], link, links[:k])
    pushed = [i for i in range(len(shoes)) if i not in lines]
    if drive is not None and drive.is_cam and len(pushed) != 2:
        raise ValueError(f"actuation: a cam moves two shoes, not {len(pushed)}")
    share = 0.0 if drive is None else drive.total / (2 if drive.is_cam else 1)
    found = []
    for i, shoe in enumerate(shoes):
        given = "actuation" in shoe.model_fields_set
        force = given and "force" in shoe.actuation.model_fields_set
        if i in lines:
            if file and given:
                raise ValueError(f"shoe[{i}].actuation: a strut pushes this shoe; leave it out")
            found.append(shoe.model_copy(update={"actuation": lines[i]}))
            continue
        if not given:
            raise ValueError(f"shoe[{i}].actuation: is missing")
        if drive is None and not force:
            raise ValueError(f"shoe[{i}].actuation.force: is missing")
        if drive is not None and file and force:
            raise ValueError(
                f"shoe[{i}].actuation.force: the brake's [actuation] gives it; leave one out"
            )
        own = (
            shoe.actuation if drive is None else shoe.actuation.model_copy(update={"force": share})
        )
        found.append(shoe.model_copy(update={"actuation": own}))
    return tuple(found)


def _line(key: str, source: Held, link: Link, before: tuple[Link, ...]) -> Actuation:
    if source.abutment is None:
        raise ValueError(
            f"{key}.from = {link.source!r}: its shoe must bear on the strut by an abutment"
        )
    if source.abutment.friction > 0:
        raise ValueError(
            f"{key}.from = {link.source!r}: a strut pushes along its line; leave out abutment.friction"
        )
    if link.to == link.source or any(other.source == link.to for other in before):
        raise ValueError(
            f"{key}.to = {link.to!r}: must be a shoe that does not push another in a link before; "
            "name the links from the actuation on"
        )
    if any(other.to == link.to for other in before):
        raise ValueError(f"{key}.to = {link.to!r}: is pushed by two struts")
    if any(other.source == link.source for other in before):
        raise ValueError(f"{key}.from = {link.source!r}: bears on two struts")
    return Actuation(
        force=0.0, direction=source.abutment.direction + math.pi, point=source.abutment.point
    )


def shares(drive: Drive | None, links: tuple[Link, ...]) -> str | None:
    """That the shoes share their forces, in the words of a refusal; None where each has its own."""
    by = ["a cam"] * (drive is not None and drive.is_cam) + ["a strut"] * bool(links)
    return f"its shoes share their forces by {' and '.join(by)}" if by else None
