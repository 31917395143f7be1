"""The brake on a plane, the data of a brake file with [plane]: shoes that press on a body which
slides straight on.

Conventions: the sliding surface is y = 0, the body lies below it, the shoes above; a lining reaches
from x = start to x = end. It is the same kind of data as a drum brake, with lengths in place of
angles.
"""

import math
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, PrivateAttr, ValidationInfo, model_validator

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake, Frame, Shoe
from drumlin.brake.components import LARGEST_MISFIT, STEP, Backing, Bar, Friction, Lining, Misfit
from drumlin.brake.drive import Drive, Link, driven
from drumlin.brake.drum_brake import DrumBrake, check_grip
from drumlin.brake.fields import (
    AnyMaterial,
    Length,
    Part,
    Point,
    Rows,
    Thickness,
    Title,
    check_names,
    number_or_table,
    table,
)
from drumlin.brake.file import read_toml, toml_data, validated
from drumlin.brake.off_circle import crown_gap
from drumlin.brake.support import check_motions
from drumlin.brake.surface import PLANE
from drumlin.brake.units import deg, mm


class Plane(Part):
    """The sliding plane y = 0 and the direction in which the body slides."""

    sliding: Literal["+x", "-x"]


class FlatMisfit(Misfit):
    """How a pad's face is off the plane, besides its clearance.

    `radius` [m] of a face that is ground to a circle, which meets the plane in the lining's middle:
    positive of a crowned face, negative of a hollow one. `blocks`: rows (x, depth) [m]; the rest as
    of a lining on a drum.
    """

    radius: Length | None = None
    blocks: Annotated[Rows, table("place", "m", "depth", "m")] = ()


class FlatLining(Lining):
    """The friction lining on the plane, from x = `start` to x = `end` [m], `width` [m] across.

    `thickness` [m] and `material` are what finite elements need; `clearance` [m]: how far it stands
    off the plane, one value, or a table of (x, clearance) with straight lines between; `misfit`
    comes on top.
    """

    start: Length
    end: Length
    width: Thickness
    thickness: Thickness | None = None  # type: ignore[assignment]
    material: AnyMaterial | None = None  # type: ignore[assignment]
    clearance: Annotated[float | Rows, number_or_table("place", "m", "clearance", "m")] = 0.0
    misfit: FlatMisfit = FlatMisfit()

    @model_validator(mode="after")
    def _order(self) -> Self:
        long, radius = self.end - self.start, self.misfit.radius
        if long <= 0:
            raise ValueError(f"end = {mm(self.end)} must be greater than start = {mm(self.start)}")
        most, least = (
            LARGEST_MISFIT * long,
            long / (8 * LARGEST_MISFIT),
        )  # of a circle that is off by so much at most
        if radius is not None and abs(radius) < least:
            raise ValueError(
                f"misfit.radius = {mm(radius)}: must be at least {mm(least)} either way, "
                f"{1 / (8 * LARGEST_MISFIT):g} times the lining's length"
            )
        allowed = f"{LARGEST_MISFIT:g} of the lining's length, {mm(most)}"
        self.misfit.check("misfit", (self.start, self.end), self.step, mm, most, allowed)
        return self

    @property
    def step(self) -> float:
        """Length [m] of the rounded step from one block's height to the next."""
        return STEP * (self.end - self.start)


class FlatBody(Bar):
    """The elastic shoe behind lining and backing: a straight bar from x = `start` to x = `end` [m]."""

    start: Length
    end: Length

    @property
    def shape(self) -> str:
        """Its shape in phi: that of an arc."""
        return "arc"


class FlatFrame(Frame):
    """A flat shoe's own frame, whose origin is the hinge's foot on the plane.

    Its points are (distance from there towards the lining, height above the plane) [m].
    """

    def to_brake(self, vectors: Floats) -> Floats:
        """Vectors (..., 2) of the shoe's frame in the brake's."""
        return np.asarray(vectors) * np.array([float(self.sense), 1.0])

    def to_shoe(self, vectors: Floats) -> Floats:
        """Vectors (..., 2) of the brake's frame in the shoe's."""
        return np.asarray(vectors) * np.array([float(self.sense), 1.0])


class FlatShoe(Shoe):
    """A shoe with a flat lining, held by a hinge or otherwise (`Held`); without `body` it is rigid."""

    surface = PLANE
    _size: float | None = PrivateAttr(None)

    lining: FlatLining
    backing: Backing | None = None
    body: FlatBody | None = None

    @model_validator(mode="after")
    def _on_body(self) -> Self:
        slack = 1e-9 * (self.lining.end - self.lining.start)
        if (
            self.body
            and not self.body.start - slack
            <= self.lining.start
            < self.lining.end
            <= self.body.end + slack
        ):
            raise ValueError(
                f"lining = {mm(self.lining.start)} to {mm(self.lining.end)}: must lie within the body, "
                f"{mm(self.body.start)} to {mm(self.body.end)}"
            )
        return self

    @property
    def side(self) -> str:
        """The side of a drum whose shoes look at their lining as this one does."""
        return "internal"

    @property
    def size(self) -> float:
        """The size [m] of its brake; of a shoe that no brake has yet, the length of its own lining."""
        return self.lining.end - self.lining.start if self._size is None else self._size

    def of_size(self, size: float) -> Self:
        """The shoe in a brake of this size [m]."""
        shoe = self.model_copy()
        shoe._size = size
        return shoe

    @cached_property
    def frame(self) -> FlatFrame:
        """The shoe's own frame; its sense is chosen so that the lining's middle is at a distance >=
        0.
        """
        return FlatFrame(self.pin.x, 1 if self.lining.middle >= self.pin.x else -1, self.size)

    @property
    def own_pin(self) -> Floats:
        """The pin (2,) [m] in its frame."""
        return np.array([0.0, self.pin.y])

    def own_points(self, xy: Floats) -> Floats:
        """Points (..., 2) [m] of the brake's frame in its own."""
        return self.frame.to_shoe(np.asarray(xy) - np.array([self.pin.x, 0.0]))

    def points(self, xy: Floats) -> Floats:
        """Points (2, n) [m] of its frame in the brake's."""
        return np.array([self.pin.x + self.frame.sense * xy[0], xy[1]])

    def at(self, depth: Floats, phi: Floats, size: float) -> Floats:
        """Points (2, ...) [m] of its frame, at a height [m] above the plane and at phi."""
        return np.stack(np.broadcast_arrays(size * phi, depth))

    def off(self, xy: Floats, size: float) -> Floats:
        """Height [m] of points (2, ...) [m] of its frame above the plane."""
        return np.asarray(xy[1])

    def phi_of(self, xy: Floats, size: float) -> Floats:
        """phi of points (2, ...) [m] of its frame."""
        return np.asarray(xy[0] / size)

    def place_of(self, point: Point) -> float:
        """The x [m] of a point."""
        return point.x

    def back(self, size: float) -> float:
        """Length [m] of the back of its body per unit of phi."""
        return size

    @property
    def closing(self) -> float:
        """Direction [rad] of the plane's normal, towards the plane."""
        return -math.pi / 2

    def misfit_gap(self, theta: Floats, size: float) -> Floats:
        """Gap [m] of a face ground to a circle, moved by its offset, at the places x [m], same
        shape.
        """
        return crown_gap(
            self.lining.misfit.radius, self.lining.misfit.offset, theta - self.lining.middle
        )


class FlatBrake(Brake):
    """A brake on a plane: friction coefficient, sliding plane and shoes."""

    surface = PLANE
    direction_key = "plane.sliding"
    directions = ("+x", "-x")

    title: Title
    friction: Friction
    plane: Plane
    shoes: Annotated[tuple[FlatShoe, ...], Field(alias="shoe", min_length=1)]
    actuation: Drive | None = None
    links: Annotated[tuple[Link, ...], Field(alias="link")] = ()

    @property
    def direction(self) -> str:
        """The direction in which the body slides."""
        return self.plane.sliding

    @property
    def size(self) -> float:
        """The length [m] of its first lining."""
        return self.shoes[0].size

    def reversed(self) -> Self:
        """The brake whose body slides the other way."""
        return self.model_copy(
            update={"plane": self.plane.model_copy(update={"sliding": self.other_direction})}
        )

    def bare(self) -> Self:
        """The brake without what its bodies do not depend on, but for the shoes."""
        friction = float(self.friction > 0)
        return self.model_copy(
            update={"title": "-", "friction": friction, "plane": Plane(sliding="+x")}
        )

    @model_validator(mode="after")
    def _whole(self, info: ValidationInfo) -> Self:
        check_names([shoe.name for shoe in self.shoes])
        shoes = driven(
            self.shoes,
            self.actuation,
            self.links,
            file=bool((info.context or {}).get("unit_required")),
        )
        size = shoes[0].lining.end - shoes[0].lining.start
        shoes = tuple(shoe.of_size(size) for shoe in shoes)
        for i, shoe in enumerate(shoes):
            check_grip(f"shoe[{i}]", shoe)
            check_motions(f"shoe[{i}]", shoe, slice(1, 3))
            if shoe.guide is not None and abs(math.sin(shoe.guide.direction)) < 1e-6:
                shown = f"shoe[{i}].guide.direction = {deg(shoe.guide.direction)}"
                raise ValueError(f"{shown}: must lead to the plane, not along it")
        return self.model_copy(update={"shoes": shoes})


def any_from(
    data: Mapping[str, Any], *, unit_required: bool = False, base: Path | None = None
) -> Brake:
    """As `brake_from`, with [plane] a brake on a plane."""
    return validated(Brake.shape_of(data), data, unit_required=unit_required, base=base)


def read_any(path: Path | str, text: str | None = None) -> Brake:
    """Read a brake from a TOML file: with the table [plane] a brake on a plane, else on a drum.

    Parameters
    ----------
    path : path of the file, every quantity in it with its unit
    text : the text of the file where it was read before

    Returns
    -------
    Brake
        frozen data in SI units, checked key by key

    Raises
    ------
    BadInput
        for a file that cannot be read or is no brake: one line that names the key, the value and
        what is allowed

    Examples
    --------
    >>> drumlin.read_brake("brake.toml").friction
    0.3
    """
    path = Path(path)
    data = read_toml(path) if text is None else toml_data(text, path)
    try:
        return any_from(data, unit_required=True, base=path.parent)
    except BadInput as error:
        raise BadInput(f"{path}: {error}") from error


def read_drum(path: Path, what: str, text: str | None = None) -> Brake:
    """The brake on a drum of a TOML file, for `what` takes no other. Raises BadInput as `read_any`,
    and for a plane.
    """
    brake = read_any(path, text)
    if not isinstance(brake, DrumBrake):
        raise BadInput(f"{path}: is a brake on a plane; {what} takes brakes on a drum")
    return brake
