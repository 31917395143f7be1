"""A brake on a plane in the words of one on a drum, so that the same elements, contact and error estimates serve both.

Places x along the plane count in lengths of the first lining, as angles do in radii of a drum: theta = x/unit. What is
different is said here: normals do not turn, a shoe's own frame is only moved and mirrored, nothing has a moment about
a centre. In a shoe's frame x counts from its pin towards its lining, y is the height above the plane.
"""

from functools import cached_property
from typing import Any

import numpy as np

from drumlin.arrays import Floats
from drumlin.brake.components import STEP, Bar, Body, Drum, Lining
from drumlin.brake.drum_brake import Brake, Frame, Shoe
from drumlin.brake.fields import Point, Rows
from drumlin.brake.plane_brake import AnyBrake, FlatBrake, FlatShoe
from drumlin.brake.support import Meshed
from drumlin.errors import BadInput


class StraightFrame(Frame):
    """The frame of a shoe on a plane; `origin`: the pin's theta."""

    def to_brake(self, vectors: Floats) -> Floats:
        """As of a shoe on a drum."""
        return np.asarray(vectors) * np.array([float(self.sense), 1.0])

    def to_shoe(self, vectors: Floats) -> Floats:
        """As of a shoe on a drum."""
        return np.asarray(vectors) * np.array([float(self.sense), 1.0])


class StraightLining(Lining):
    """A lining on a plane."""

    @property
    def step(self) -> float:
        """As of a lining on a drum, in proportion to its length."""
        return STEP * (self.end - self.start)


class StraightShoe(Shoe):
    """A shoe on a plane, `unit` [m] of its theta."""

    unit: float

    @property
    def flat(self) -> bool:
        """That it presses on a plane."""
        return True

    @cached_property
    def frame(self) -> Frame:
        """The shoe's own frame."""
        sense = 1 if self.lining.middle * self.unit >= self.pin.x else -1
        return StraightFrame(self.pin.x / self.unit, sense)

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

    def at(self, depth: Floats, phi: Floats, radius: float) -> Floats:
        """As of a shoe on a drum."""
        return np.stack(np.broadcast_arrays(radius * phi, depth))

    def off(self, xy: Floats, radius: float) -> Floats:
        """As of a shoe on a drum: its height."""
        return np.asarray(xy[1])

    def angle_of(self, point: Point) -> float:
        """The theta of a point."""
        return point.x / self.unit

    def back(self, radius: float) -> float:
        """By what a length along its back makes a theta [m]."""
        return radius


def why_not(brake: FlatBrake) -> str | None:
    """Why the shoes of a brake on a plane cannot be meshed; None where they can."""
    for shoe in brake.shoes:
        if shoe.lining.thickness is None or shoe.lining.material is None:
            return f"shoe {shoe.name!r}: its lining has no thickness and material to mesh"
    return None


def unrolled(brake: FlatBrake) -> Brake:
    """The brake in the words of one on a drum; see `why_not`. Not validated: it is one already."""
    return Brake.model_construct(
        title=brake.title,
        rotation="counter-clockwise" if brake.spin > 0 else "clockwise",
        friction=brake.friction,
        drum=Drum(radius=brake.unit),
        shoes=tuple(_straight(shoe, brake.unit) for shoe in brake.shoes),
        actuation=brake.actuation,
        links=brake.links,
    )


def on_drum(brake: AnyBrake) -> Brake:
    """The brake, one on a plane `unrolled`. Raises BadInput where that cannot be meshed."""
    if not isinstance(brake, FlatBrake):
        return brake
    reason = why_not(brake)
    if reason is not None:
        raise BadInput(f"fem does not apply to this brake: {reason}")
    return unrolled(brake)


def _rolled(rows: Rows, unit: float) -> Rows:
    return tuple((x / unit, value) for x, value in rows)


def _straight(shoe: FlatShoe, unit: float) -> StraightShoe:
    lining, body = shoe.lining, shoe.body
    own: dict[str, Any] = {key: getattr(shoe, key) for key in Meshed.model_fields}
    assert lining.thickness is not None and lining.material is not None  # why_not
    return StraightShoe.model_construct(
        **own,
        side="internal",
        lining=StraightLining.model_construct(
            start=lining.start / unit,
            end=lining.end / unit,
            thickness=lining.thickness,
            width=lining.width,
            material=lining.material,
            clearance=_rolled(lining.clearance, unit) if isinstance(lining.clearance, tuple) else lining.clearance,
            misfit=lining.misfit.model_copy(update={"blocks": _rolled(lining.misfit.blocks, unit)}),
        ),
        backing=shoe.backing,
        body=None
        if body is None
        else Body.model_construct(
            **{name: getattr(body, name) for name in Bar.model_fields},
            shape="arc",
            start=body.start / unit,
            end=body.end / unit,
        ),
        unit=unit,
    )
