"""The brake as frozen, validated data.

Conventions: the drum's centre O is the origin, angles run counter-clockwise from +x, and all
numbers are SI (m, N, Pa, rad). The lining lies against the drum's friction surface of radius R.
"""

import math
from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import Annotated, Literal, NamedTuple, Self

import numpy as np
from pydantic import (
    Field,
    ValidationInfo,
    model_validator,
)

from drumlin.arrays import Floats
from drumlin.brake.beam_axis import axis_of
from drumlin.brake.components import (
    LARGEST_MISFIT,
    AnyBody,
    Backing,
    Bar,
    Beam,
    Body,
    Drum,
    Friction,
    Lining,
    Ring,
    Table,
)
from drumlin.brake.drive import Drive, Link, driven, shares
from drumlin.brake.fields import Part, Point, Title, check_names
from drumlin.brake.support import MOVES, Held, Meshed, check_motions
from drumlin.brake.units import deg, mm
from drumlin.errors import BadInput


class Frame(NamedTuple):
    """A shoe's own frame: polar angle phi at O, measured from the hinge (`Held.pin`) towards the lining.

    theta = origin + sense * phi. In it a shoe and its mirror image are the same thing.
    """

    origin: float
    sense: int

    def phi(self, theta: Floats) -> Floats:
        """phi of angles theta [rad], same shape."""
        return self.sense * (np.asarray(theta) - self.origin)

    def phis(self, theta: Iterable[float]) -> list[float]:
        """phi of a few angles theta [rad]."""
        return [self.sense * (angle - self.origin) for angle in theta]

    def theta(self, phi: Floats) -> Floats:
        """theta of angles phi [rad], same shape."""
        return self.origin + self.sense * np.asarray(phi)

    def to_brake(self, vectors: Floats) -> Floats:
        """Vectors (..., 2) of the shoe's frame in the brake's."""
        c, s = math.cos(self.origin), math.sin(self.origin)
        return np.asarray(vectors) @ np.array([[c, s], [-self.sense * s, self.sense * c]])

    def to_shoe(self, vectors: Floats) -> Floats:
        """Vectors (..., 2) of the brake's frame in the shoe's."""
        c, s = math.cos(self.origin), math.sin(self.origin)
        return np.asarray(vectors) @ np.array([[c, -self.sense * s], [s, self.sense * c]])


class Shoe(Meshed):
    """One shoe with its lining, held by a hinge or otherwise (`Held`); without `body` the shoe is rigid."""

    side: Literal["internal", "external"]
    lining: Lining
    backing: Backing | None = None
    body: AnyBody | None = None

    @property
    def sign(self) -> int:
        """Outward normal of the lining n = sign * e_r: +1 internal, -1 external."""
        return 1 if self.side == "internal" else -1

    @property
    def depth(self) -> float:
        """Radial thickness of lining, backing and body together [m]."""
        return (
            self.lining.thickness
            + (self.backing.thickness if self.backing else 0.0)
            + (self.body.depth if self.body else 0.0)
        )

    @cached_property
    def frame(self) -> Frame:
        """The shoe's own frame; its origin is chosen so that phi of the lining's middle is in [0, pi]."""
        middle = 0.5 * (self.lining.start + self.lining.end)
        offset = math.remainder(middle - self.pin.angle, 2 * math.pi)
        sense = 1 if offset >= 0 else -1
        return Frame(middle - offset, sense)

    @cached_property
    def arc(self) -> tuple[float, float]:
        """The lining's arc (phi_1, phi_2) [rad] in the shoe's frame."""
        first, last = self.frame.phis((self.lining.start, self.lining.end))
        return min(first, last), max(first, last)

    @property
    def flat(self) -> bool:
        """Whether it presses on a plane: `unrolled`."""
        return False

    @property
    def face(self) -> str:
        """What it presses on, in a word."""
        return "plane" if self.flat else "drum"

    @property
    def own_pin(self) -> Floats:
        """The pin (2,) [m] in its frame."""
        return np.array([self.pin.radius, 0.0])

    def own_points(self, xy: Floats) -> Floats:
        """Points (..., 2) [m] of the brake's frame in its own."""
        return self.frame.to_shoe(xy)

    def points(self, xy: Floats) -> Floats:
        """Points (2, n) [m] of its frame in the brake's."""
        return np.asarray(self.frame.to_brake(xy.T).T)

    def at(self, depth: Floats, phi: Floats, radius: float) -> Floats:
        """Points (2, ...) [m] of its frame, at a depth [m] behind the friction surface and angles phi [rad]."""
        r = radius - self.sign * depth
        return np.array([r * np.cos(phi), r * np.sin(phi)])

    def off(self, xy: Floats, radius: float) -> Floats:
        """How far points (2, ...) [m] of its frame lie off the friction surface [m], positive = open."""
        return self.sign * (radius - np.hypot(*xy))

    def end_face(self, radius: float, *, loaded: bool = False) -> Floats:
        """The middle (2,) [m], in its frame, of the end face by which a hinge or an abutment holds an arc, or of that
        which the actuation pushes."""
        assert isinstance(self.body, Body)
        phi = (max if loaded else min)(self.frame.phis((self.body.start, self.body.end)), key=abs)
        return self.at(np.array(self.depth - 0.5 * self.body.depth), np.array(phi), radius)

    def angle_of(self, point: Point) -> float:
        """The angle [rad] of a point, that nearest to the lining's middle."""
        return self.lining.middle + math.remainder(point.angle - self.lining.middle, 2 * math.pi)

    def back(self, radius: float) -> float:
        """Radius [m] of the back of its body."""
        return radius - self.sign * self.depth

    @property
    def gripped(self) -> bool:
        """Whether what holds the shoe grips the back of an elastic body, not an end face: the force acts on it then."""
        return self.held_by in {"pivot", "guide"} or (isinstance(self.body, Body) and self.body.grip is not None)

    def grip(self, radius: float) -> tuple[float, float] | None:
        """The arc [rad] in its frame of the body's back that is held (see `Bar`), on a drum of this radius [m].

        None where what holds the shoe holds an end face of its body, or all of the back of a rigid one.
        """
        if not isinstance(self.body, Body) or self.mesh is not None or not self.gripped:
            return None
        start, end = self.arc
        angle = self.lining.middle if self.pivot is None else self.angle_of(self.pivot)
        half = min(0.5 * (self.body.grip or self.body.thickness) / self.back(radius), 0.3 * (end - start))
        at = float(np.clip(self.frame.phi(np.array(angle)), start + 1.5 * half, end - 1.5 * half))
        return at - half, at + half


class Brake(Part):
    """A brake: friction coefficient, sense of rotation, drum and shoes."""

    title: Title
    rotation: Literal["counter-clockwise", "clockwise"]
    friction: Friction
    drum: Drum
    shoes: Annotated[tuple[Shoe, ...], Field(alias="shoe", min_length=1)]
    actuation: Drive | None = None
    links: Annotated[tuple[Link, ...], Field(alias="link")] = ()

    @property
    def spin(self) -> int:
        """Sense of the drum's rotation s: +1 counter-clockwise, -1 clockwise."""
        return 1 if self.rotation == "counter-clockwise" else -1

    @property
    def drag(self) -> float:
        """Friction on the lining per pressure along e_theta at full slip: mu s."""
        return self.friction * self.spin

    def drag_on(self, shoe: Shoe) -> float:
        """The same along growing angles of the shoe's own frame."""
        return self.drag * shoe.frame.sense

    @property
    def shares(self) -> str | None:
        """That a cam or a strut shares a force among its shoes, in words; None where each shoe has its own."""
        return shares(self.actuation, self.links)

    @property
    def motion(self) -> str:
        """What moves, in words."""
        return f"drum turns {self.rotation}"

    def unhinged(self) -> str | None:
        """The first thing that is not plain hinges under forces of their own, in words of a refusal; None if all is."""
        moving = (f"shoe {shoe.name!r}: {MOVES[shoe.held_by]}" for shoe in self.shoes if shoe.held_by != "hinge")
        return self.shares or next(moving, None)

    def check_hinged(self, what: str) -> None:
        """Raise BadInput for `what` is done with shoes on hinges only, under forces of their own."""
        reason = self.unhinged()
        if reason is not None:
            raise BadInput(f"{what} takes shoes on hinges under forces of their own only: {reason}")

    def names(self, group: Sequence[int]) -> str:
        """The shoes of a group as a refusal names them."""
        return ", ".join(f"shoe {self.shoes[i].name!r}" for i in group)

    @model_validator(mode="after")
    def _geometry(self, info: ValidationInfo) -> Self:
        check_names([shoe.name for shoe in self.shoes])
        shoes = driven(self.shoes, self.actuation, self.links, file=bool((info.context or {}).get("unit_required")))
        _check_thickness("drum.ring", self.drum.ring, self.drum.radius)
        _check_round(self.drum)
        for i, shoe in enumerate(shoes):
            _check_shoe(f"shoe[{i}]", shoe, self.drum.radius)
            _check_misfit(f"shoe[{i}].lining.misfit", shoe.lining, self.drum.radius)
        return self.model_copy(update={"shoes": shoes})


def _check_round(drum: Drum) -> None:
    off, most = sum(abs(lobes.amplitude) for lobes in drum.out_of_round), LARGEST_MISFIT * drum.radius
    if off > most:
        raise ValueError(f"drum.out_of_round = {mm(off)} in all: must be at most {LARGEST_MISFIT:g} R = {mm(most)}")


def _check_misfit(key: str, lining: Lining, radius: float) -> None:
    """Raise ValueError for a misfit that is no small one of a drum of this radius [m], or blocks not on the lining."""
    misfit, most = lining.misfit, LARGEST_MISFIT * radius
    allowed = f"{LARGEST_MISFIT:g} R = {mm(most)}"
    if misfit.radius is not None and abs(misfit.radius - radius) > most:
        raise ValueError(f"{key}.radius = {mm(misfit.radius)}: must be within {allowed} of drum.radius = {mm(radius)}")
    misfit.check(key, (lining.start, lining.end), lining.step, deg, most, allowed)


THINNEST = 1e-9  # of the drum's radius: a thinner layer has no elements that arithmetic can tell from nothing


def _check_thickness(key: str, part: "Lining | Backing | Body | Beam | Ring | Table | None", radius: float) -> None:
    thickness = None if part is None else part.thickness
    if thickness is not None and thickness < THINNEST * radius:
        raise ValueError(
            f"{key}.thickness = {mm(thickness)}: must be at least {THINNEST:g} of drum.radius = {mm(radius)}"
        )


def _check_shoe(key: str, shoe: Shoe, radius: float) -> None:
    """Raise ValueError where a shoe does not fit together or into a drum of this radius [m]."""
    table = shoe.body.table if isinstance(shoe.body, Body) else None
    parts = {"lining": shoe.lining, "backing": shoe.backing, "body": shoe.body, "body.table": table}
    for name, part in parts.items():
        _check_thickness(f"{key}.{name}", part, radius)
    if shoe.hinge is not None and shoe.hinge.radius < 1e-9 * radius:
        raise ValueError(f"{key}.hinge = (0, 0): must not be the drum's centre, about which the shoe would only slide")
    check_grip(key, shoe)
    _check_support(key, shoe, radius)
    if shoe.sign > 0 and shoe.depth >= radius:
        raise ValueError(
            f"{key}: lining, backing and body are {mm(shoe.depth)} thick together; "
            f"must be less than drum.radius = {mm(radius)}"
        )
    body, lining = shoe.body, shoe.lining
    if isinstance(body, Beam):
        _check_beam(key, shoe, radius)
    if not isinstance(body, Body):
        return
    if not 0 < body.end - body.start < 2 * math.pi:
        raise ValueError(
            f"{key}.body.end = {deg(body.end)}: must be greater than body.start = {deg(body.start)}, "
            "by less than 360 deg"
        )
    slack = 1e-9
    if lining.start < body.start - slack or lining.end > body.end + slack:
        raise ValueError(
            f"{key}.lining = {deg(lining.start)} to {deg(lining.end)}: must lie within the body, "
            f"{deg(body.start)} to {deg(body.end)}"
        )


def check_grip(key: str, shoe: Held) -> None:
    """Raise ValueError for a grip of the back of a body that an abutment holds by its end face."""
    body = getattr(shoe, "body", None)
    if shoe.abutment is not None and isinstance(body, Bar) and body.grip is not None:
        raise ValueError(f"{key}.body.grip = {mm(body.grip)}: an abutment holds the body's end face; leave it out")


def _check_beam(key: str, shoe: Shoe, radius: float) -> None:
    said = f'{key}.body.shape = "beam"'
    if shoe.sign > 0 or shoe.held_by != "hinge":
        raise ValueError(f"{said}: only for an external shoe that turns about its hinge")
    if math.dist(shoe.actuation.point.xy, shoe.pin.xy) < 1e-6 * radius:
        raise ValueError(f"{said}: the actuation's point is the beam's loaded end and must not be the hinge")
    axis = axis_of(shoe.pin.xy, shoe.actuation.point.xy)
    if axis.distance <= radius:
        raise ValueError(
            f"{said}: the line from the hinge to the actuation's point passes {mm(axis.distance)} from "
            f"the drum's centre; must be more than drum.radius = {mm(radius)}"
        )
    ends = axis.angle(np.array([shoe.lining.start, shoe.lining.end]))
    x = axis.foot + radius * np.sin(ends)
    if np.abs(ends).max() >= 0.5 * math.pi or x.min() < 0 or x.max() > axis.length:
        raise ValueError(
            f"{key}.lining = {deg(shoe.lining.start)} to {deg(shoe.lining.end)}: must lie between the beam's ends "
            "and less than 90 deg from where the beam is nearest to the drum"
        )


def _check_support(key: str, shoe: Shoe, radius: float) -> None:
    if shoe.guide is not None:
        away = shoe.sign * math.cos(shoe.guide.direction - shoe.lining.middle)
        if away <= 0:
            shown = f"{key}.guide.direction = {deg(shoe.guide.direction)}"
            raise ValueError(f"{shown}: must lead the middle of the lining towards the drum")
    if shoe.abutment is not None and shoe.abutment.point.radius < 1e-9 * radius:
        raise ValueError(f"{key}.abutment.point = (0, 0): must not be the drum's centre")
    if shoe.pivot is None:
        check_motions(key, shoe, slice(0, 2))
        return
    shown = f"{key}.pivot = ({mm(shoe.pivot.x)}, {mm(shoe.pivot.y)})"
    if shoe.pivot.radius < 1e-9 * radius:
        raise ValueError(f"{shown}: must not be the drum's centre, about which the shoe would only slide")
    if math.dist(shoe.pivot.xy, shoe.pin.xy) < 1e-9 * radius:
        raise ValueError(f"{shown}: must not be the hinge; leave it out for a shoe that turns about its hinge")
    check_motions(key, shoe, slice(0, 2))
