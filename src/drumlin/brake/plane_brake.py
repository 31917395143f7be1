"""The brake on a plane: shoes that press on a body which slides straight on.

Conventions: the sliding surface is y = 0, the body lies below it, the shoes above; a lining reaches
from x = start to x = end. It is the same kind of data as a drum brake, with lengths in place of angles.
"""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, Self

import numpy as np
from pydantic import Field, ValidationInfo, model_validator

from drumlin.arrays import Floats
from drumlin.brake.components import LARGEST_MISFIT, STEP, Backing, Bar, Friction, Misfit
from drumlin.brake.drive import Drive, Link, driven, shares
from drumlin.brake.drum_brake import Brake, check_grip
from drumlin.brake.fields import (
    AnyMaterial,
    Length,
    Part,
    Rows,
    Thickness,
    Title,
    check_names,
    number_or_table,
    table,
)
from drumlin.brake.file import brake_from, read_toml, toml_data, validated
from drumlin.brake.support import Meshed, check_motions
from drumlin.brake.units import deg, mm
from drumlin.errors import BadInput


class Plane(Part):
    """The sliding plane y = 0 and the direction in which the body slides."""

    sliding: Literal["+x", "-x"]


class FlatMisfit(Misfit):
    """How a pad's face is off the plane, besides its clearance.

    `radius` [m] of a face that is ground to a circle, which meets the plane in the lining's middle: positive of a
    crowned face, negative of a hollow one. `blocks`: rows (x, depth) [m]; the rest as of a lining on a drum.
    """

    radius: Length | None = None
    blocks: Annotated[Rows, table("place", "m", "depth", "m")] = ()


class FlatLining(Part):
    """The friction lining on the plane, from x = `start` to x = `end` [m], `width` [m] across.

    `thickness` [m] and `material` are what finite elements need; `clearance` [m]: how far it stands off the plane, one
    value, or a table of (x, clearance) with straight lines between; `misfit` comes on top.
    """

    start: Length
    end: Length
    width: Thickness
    thickness: Thickness | None = None
    material: AnyMaterial | None = None
    clearance: Annotated[float | Rows, number_or_table("place", "m", "clearance", "m")] = 0.0
    misfit: FlatMisfit = FlatMisfit()

    @model_validator(mode="after")
    def _order(self) -> Self:
        long, radius = self.end - self.start, self.misfit.radius
        if long <= 0:
            raise ValueError(f"end = {mm(self.end)} must be greater than start = {mm(self.start)}")
        most, least = LARGEST_MISFIT * long, long / (8 * LARGEST_MISFIT)  # of a circle that is off by so much at most
        if radius is not None and abs(radius) < least:
            raise ValueError(
                f"misfit.radius = {mm(radius)}: must be at least {mm(least)} either way, "
                f"{1 / (8 * LARGEST_MISFIT):g} times the lining's length"
            )
        allowed = f"{LARGEST_MISFIT:g} of the lining's length, {mm(most)}"
        self.misfit.check("misfit", (self.start, self.end), STEP * long, mm, most, allowed)
        return self


class FlatBody(Bar):
    """The elastic shoe behind lining and backing: a straight bar from x = `start` to x = `end` [m]."""

    start: Length
    end: Length


class FlatFrame(NamedTuple):
    """A flat shoe's own frame: distance from the hinge's foot on the plane towards the lining.

    x = origin + sense * distance. In it a shoe and its mirror image are the same thing.
    """

    origin: float
    sense: int

    def distance(self, x: Floats) -> Floats:
        """Distances [m] of the places x [m], same shape."""
        return self.sense * (np.asarray(x) - self.origin)

    def x(self, distance: Floats) -> Floats:
        """Places x [m] at the distances [m], same shape."""
        return self.origin + self.sense * np.asarray(distance)


class FlatShoe(Meshed):
    """A shoe with a flat lining, held by a hinge or otherwise (`Held`); without `body` it is rigid."""

    lining: FlatLining
    backing: Backing | None = None
    body: FlatBody | None = None

    @model_validator(mode="after")
    def _on_body(self) -> Self:
        slack = 1e-9 * (self.lining.end - self.lining.start)
        if self.body and not self.body.start - slack <= self.lining.start < self.lining.end <= self.body.end + slack:
            raise ValueError(
                f"lining = {mm(self.lining.start)} to {mm(self.lining.end)}: must lie within the body, "
                f"{mm(self.body.start)} to {mm(self.body.end)}"
            )
        return self

    @property
    def frame(self) -> FlatFrame:
        """The shoe's own frame; its sense is chosen so that the lining's middle is at a distance >= 0."""
        middle = 0.5 * (self.lining.start + self.lining.end)
        return FlatFrame(self.pin.x, 1 if middle >= self.pin.x else -1)

    @property
    def span(self) -> tuple[float, float]:
        """The lining (x_min, x_max) [m] in the shoe's frame."""
        ends = self.frame.distance(np.array([self.lining.start, self.lining.end]))
        return float(ends.min()), float(ends.max())


class FlatBrake(Part):
    """A brake on a plane: friction coefficient, sliding plane and shoes."""

    title: Title
    friction: Friction
    plane: Plane
    shoes: Annotated[tuple[FlatShoe, ...], Field(alias="shoe", min_length=1)]
    actuation: Drive | None = None
    links: Annotated[tuple[Link, ...], Field(alias="link")] = ()

    @property
    def unit(self) -> float:
        """The length [m] that others are measured by, as by a drum's radius: that of its first lining."""
        return self.shoes[0].lining.end - self.shoes[0].lining.start

    @property
    def spin(self) -> int:
        """Sense of the sliding: +1 along +x, -1 along -x."""
        return 1 if self.plane.sliding == "+x" else -1

    @property
    def shares(self) -> str | None:
        """That a cam or a strut shares a force among its shoes, in words; None where each shoe has its own."""
        return shares(self.actuation, self.links)

    @property
    def motion(self) -> str:
        """What moves, in words."""
        return f"body slides along {self.plane.sliding}"

    @model_validator(mode="after")
    def _whole(self, info: ValidationInfo) -> Self:
        check_names([shoe.name for shoe in self.shoes])
        shoes = driven(self.shoes, self.actuation, self.links, file=bool((info.context or {}).get("unit_required")))
        for i, shoe in enumerate(shoes):
            check_grip(f"shoe[{i}]", shoe)
            check_motions(f"shoe[{i}]", shoe, slice(1, 3))
            if shoe.guide is not None and abs(math.sin(shoe.guide.direction)) < 1e-6:
                shown = f"shoe[{i}].guide.direction = {deg(shoe.guide.direction)}"
                raise ValueError(f"{shown}: must lead to the plane, not along it")
        return self.model_copy(update={"shoes": shoes})


AnyBrake = Brake | FlatBrake


def any_from(data: Mapping[str, Any], *, unit_required: bool = False, base: Path | None = None) -> AnyBrake:
    """As `brake_from`, with [plane] a brake on a plane."""
    if "plane" in data:
        return validated(FlatBrake, data, unit_required=unit_required, base=base)
    return brake_from(data, unit_required=unit_required, base=base)


def read_any(path: Path | str, text: str | None = None) -> AnyBrake:
    """The brake described by a TOML file: with [plane] one on a plane, else one on a drum.

    Parameters
    ----------
    path : path of the file, every quantity in it with its unit
    text : what the file holds, if known

    Returns
    -------
    the brake as frozen, validated data in SI units

    Raises
    ------
    BadInput
        for a file that cannot be read or is no brake: one line that names the key, the value and what is allowed
    """
    path = Path(path)
    data = read_toml(path) if text is None else toml_data(text, path)
    try:
        return any_from(data, unit_required=True, base=path.parent)
    except BadInput as error:
        raise BadInput(f"{path}: {error}") from error


def read_drum(path: Path, what: str, text: str | None = None) -> Brake:
    """The brake on a drum of a TOML file, for `what` takes no other. Raises BadInput as `read_any`, and for a plane."""
    brake = read_any(path, text)
    if isinstance(brake, FlatBrake):
        raise BadInput(f"{path}: is a brake on a plane; {what} takes brakes on a drum")
    return brake
