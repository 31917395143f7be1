"""The brake on a plane: data of a brake file with [plane], whose shoes press on a sliding body.

Conventions: the sliding surface is y = 0, the body lies below it and the shoes above. A lining
reaches from x = start to x = end. The data are those of a brake on a drum, with lengths in place of
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
from drumlin.brake.brake import Brake, Shoe, ShoeFrame
from drumlin.brake.components import (
    LARGEST_MISFIT,
    ROUNDED_STEP,
    Backing,
    Bar,
    Friction,
    Lining,
    Misfit,
)
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
    """Deviation of a pad's face from the plane, besides its clearance.

    `radius` [m] is that of a face that is ground to a circle: positive for a crowned face, negative
    for a hollow face. The circle meets the plane in the lining's middle. `blocks` are rows
    (x, depth) [m]. The other keys are those of a lining on a drum.
    """

    radius: Length | None = None
    blocks: Annotated[Rows, table("place", "m", "depth", "m")] = ()


class FlatLining(Lining):
    """The friction lining on the plane from x = `start` to x = `end` [m], `width` [m] across.

    Finite elements need `thickness` [m] and `material`. `clearance` [m] is the gap of the unloaded
    lining: a number, or a table of (x, clearance) with straight lines between. The gap of the
    `misfit` is added.
    """

    start: Length
    end: Length
    width: Thickness
    thickness: Thickness | None = None  # type: ignore[assignment]
    material: AnyMaterial | None = None  # type: ignore[assignment]
    clearance: Annotated[float | Rows, number_or_table("place", "m", "clearance", "m")] = 0.0
    misfit: FlatMisfit = FlatMisfit()

    @model_validator(mode="after")
    def _check_ends_and_misfit(self) -> Self:
        """Raise ValueError for ends in the wrong order or a misfit that is too large."""
        long, radius = self.end - self.start, self.misfit.radius
        if long <= 0:
            raise ValueError(f"end = {mm(self.end)} must be greater than start = {mm(self.start)}")
        # A circle of the least radius stands off by the largest misfit at the lining's ends.
        most = LARGEST_MISFIT * long
        least = long / (8 * LARGEST_MISFIT)
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
        return ROUNDED_STEP * (self.end - self.start)


class FlatBody(Bar):
    """The elastic shoe behind lining and backing: a bar from x = `start` to x = `end` [m]."""

    start: Length
    end: Length

    @property
    def shape(self) -> str:
        """Shape of the body in phi: that of an arc."""
        return "arc"


class FlatFrame(ShoeFrame):
    """A flat shoe's own frame, with its origin at the hinge's foot on the plane.

    Its points are (distance from the origin towards the lining, height above the plane) [m].
    """

    def to_brake(self, vectors: Floats) -> Floats:
        """Convert vectors (..., 2) of the shoe's frame to the brake's."""
        # A shoe whose lining lies towards -x from its pin is mirrored.
        return np.asarray(vectors) * np.array([float(self.sense), 1.0])

    def to_shoe(self, vectors: Floats) -> Floats:
        """Convert vectors (..., 2) of the brake's frame to the shoe's."""
        # A mirror image of the mirror image is the vector itself.
        return self.to_brake(vectors)


class FlatShoe(Shoe):
    """A shoe with a flat lining and its support (`Held`). Without `body` it is rigid."""

    surface = PLANE
    _size: float | None = PrivateAttr(None)

    lining: FlatLining
    backing: Backing | None = None
    body: FlatBody | None = None

    @model_validator(mode="after")
    def _check_lining_on_body(self) -> Self:
        """Raise ValueError where the lining reaches beyond the body."""
        lining, body = self.lining, self.body
        # Ends that a file gives in different units may differ by round-off.
        slack = 1e-9 * (lining.end - lining.start)
        if body and not body.start - slack <= lining.start < lining.end <= body.end + slack:
            raise ValueError(
                f"lining = {mm(lining.start)} to {mm(lining.end)}: must lie within the body, "
                f"{mm(body.start)} to {mm(body.end)}"
            )
        return self

    @property
    def side(self) -> str:
        """Side of a drum on which shoes face their lining in the same way."""
        return "internal"

    @property
    def size(self) -> float:
        """Size [m] of the brake; of a shoe outside a brake the length of its own lining."""
        return self.lining.end - self.lining.start if self._size is None else self._size

    def of_size(self, size: float) -> Self:
        """The shoe in a brake of this size [m]."""
        shoe = self.model_copy()
        shoe._size = size
        return shoe

    @cached_property
    def frame(self) -> FlatFrame:
        """The shoe's own frame, with the lining's middle at a distance >= 0."""
        sense = 1 if self.lining.middle >= self.pin.x else -1
        return FlatFrame(self.pin.x, sense, self.size)

    @property
    def own_pin(self) -> Floats:
        """Position (2,) [m] of the pin in the shoe's frame."""
        return np.array([0.0, self.pin.y])

    def own_points(self, xy: Floats) -> Floats:
        """Convert points (..., 2) [m] of the brake's frame to the shoe's."""
        return self.frame.to_shoe(np.asarray(xy) - np.array([self.pin.x, 0.0]))

    def points(self, xy: Floats) -> Floats:
        """Convert points (2, n) [m] of the shoe's frame to the brake's."""
        return np.array([self.pin.x + self.frame.sense * xy[0], xy[1]])

    def at(self, depth: Floats, phi: Floats, size: float) -> Floats:
        """Points (2, ...) [m] of the shoe's frame at phi, a height `depth` [m] above the plane."""
        return np.stack(np.broadcast_arrays(size * phi, depth))

    def off(self, xy: Floats, size: float) -> Floats:
        """Height [m] above the plane of points (2, ...) [m] of the shoe's frame."""
        return np.asarray(xy[1])

    def phi_of(self, xy: Floats, size: float) -> Floats:
        """Coordinate phi of points (2, ...) [m] of the shoe's frame."""
        return np.asarray(xy[0] / size)

    def place_of(self, point: Point) -> float:
        """Coordinate x [m] of a point."""
        return point.x

    def back(self, size: float) -> float:
        """Length [m] of the back of the shoe's body per unit of phi."""
        return size

    @property
    def closing(self) -> float:
        """Direction [rad] of the plane's normal, towards the plane."""
        return -math.pi / 2

    def misfit_gap(self, theta: Floats, size: float) -> Floats:
        """Gap [m] of a face ground to a circle, with its offset, at places x [m], same shape."""
        misfit = self.lining.misfit
        return crown_gap(misfit.radius, misfit.offset, theta - self.lining.middle)


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
        """Length [m] of the first lining."""
        return self.shoes[0].size

    def reversed(self) -> Self:
        """The brake whose body slides the other way."""
        plane = self.plane.model_copy(update={"sliding": self.other_direction})
        return self.model_copy(update={"plane": plane})

    def bare(self) -> Self:
        """The brake without data on which its condensed bodies do not depend; the shoes stay."""
        changes = {
            "title": "-",
            "friction": float(self.friction > 0),
            "plane": Plane(sliding="+x"),
        }
        return self.model_copy(update=changes)

    @model_validator(mode="after")
    def _check_and_drive_shoes(self, info: ValidationInfo) -> Self:
        """The brake with the forces of its drive and struts; ValueError where parts do not fit."""
        check_names([shoe.name for shoe in self.shoes])
        # Numbers of a file must have units; this tells data of a file from data of a program.
        from_file = bool((info.context or {}).get("unit_required"))
        shoes = driven(self.shoes, self.actuation, self.links, file=from_file)
        # The length of the first lining is the size of the brake, to which all shoes refer.
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
    """Make a brake from a brake file's data, on a plane for data with [plane]; see `validated`."""
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
    """Read a brake on a drum from a TOML file.

    Raises BadInput as `read_any` does, and for a brake on a plane, which `what` does not take.
    """
    brake = read_any(path, text)
    if not isinstance(brake, DrumBrake):
        raise BadInput(f"{path}: is a brake on a plane; {what} takes brakes on a drum")
    return brake
