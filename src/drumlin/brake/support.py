"""How a shoe is held: hinge, pivot of a lever, abutment, guide; and the rigid motions that each
leaves it.

A rigid motion of the plane is three numbers (dx, dy [m], turn [rad]) about the origin, the drum's
centre or that of a plane's coordinates: the point x moves by (dx - turn y, dy + turn x). The
reactions of what holds a shoe do no work on its `tests`. Its `motions` are the same but where
friction acts at an abutment, whose reaction leans away from the face's normal: the shoe slides
along the face, and is tested along what is square to the reaction.
"""

import math
from pathlib import Path
from typing import Annotated, Literal, NamedTuple, Self

import numpy as np
from pydantic import AfterValidator, Field, ValidationInfo, model_validator

from drumlin.base.arrays import Floats
from drumlin.base.files import keep_input
from drumlin.brake.components import Actuation
from drumlin.brake.fields import Angle, Name, Part, Place, Point

KINDS = ("hinge", "abutment", "guide")
MOVES = {
    "hinge": "it turns about its hinge",
    "pivot": "it turns about a pivot on its lever, not about its hinge",
    "abutment": "its foot slides on an abutment, it has no hinge",
    "guide": "it moves along a guide, it has no hinge",
}
"""How a shoe moves, in words of a refusal, by `Held.held_by`."""
UNHELD = 2  # in place of the sense of an abutment's friction, see `Held.freedoms`
STICKS = 1e-9  # relative, of what friction bears: round-off


class Abutment(Part):
    """A face that the shoe's foot slides on: it bears at `point`, `direction` [rad] is the face's
    normal, the direction of its force on the foot without friction. `friction` mu_s opposes the
    slide.
    """

    point: Place
    direction: Angle
    friction: Annotated[float, Field(ge=0, le=10, strict=True)] = 0.0


class Guide(Part):
    """A straight guide: the shoe moves along `direction` [rad] only, and does not turn."""

    direction: Angle


class Freedoms(NamedTuple):
    """The free motions of a shoe: `motions`, `tests` (k, 3), and the `work` (k,) of the actuation
    on the tests, in N m of a turn and N of a slide; `tip` (k,): how far the actuation's point goes
    along its force on the motions, in m. `names` (k,): "turn", "tilt" about a pivot, "slide".
    """

    motions: Floats
    tests: Floats
    work: Floats
    tip: Floats
    names: tuple[str, ...]


def turn_about(point: Point) -> Floats:
    """The motion (3,) of a unit turn about a point."""
    return np.array([point.y, -point.x, 1.0])


def slide_along(angle: float) -> Floats:
    """The motion (3,) of a unit slide in the direction `angle` [rad]."""
    return np.array([math.cos(angle), math.sin(angle), 0.0])


def work_on(motions: Floats, force: Floats, point: Floats) -> Floats:
    """Work (k,) of a force (2,) [N] at a point (2,) [m] on rigid motions (k, 3)."""
    (x, y), (fx, fy) = point, force
    return motions @ np.array([fx, fy, x * fy - y * fx])


def wrench(forces: Floats, points: Floats) -> Floats:
    """The sum (3,) of forces (..., 2) [N] at points (..., 2) [m]: x, y and moment about the origin."""
    moments = points[..., 0] * forces[..., 1] - points[..., 1] * forces[..., 0]
    return np.array([forces[..., 0].sum(), forces[..., 1].sum(), moments.sum()])


def moved(motions: Floats, xy: Floats) -> Floats:
    """Displacements (2, n, k) of the points xy (2, n) per unit of rigid motions (k, 3)."""
    x, y = xy[..., None]
    dx, dy, turn = motions.T
    return np.array([dx - turn * y, dy + turn * x])


class Change(NamedTuple):
    """How `motions` and `tests` (k, 3) of a shoe's freedoms change with one number of what holds
    it.
    """

    motions: Floats
    tests: Floats


class Held(Part):
    """What shoes on a drum and on a plane share: a name, what holds them, what pushes them.

    `hinge`: a pin about which the shoe turns. With a `pivot` besides, the hinge is the pin of a
    lever, the actuation acts on the lever, and the shoe turns about the pivot at the lever's end.
    Or an `abutment`, or a `guide`.
    """

    name: Name
    hinge: Place | None = None
    pivot: Place | None = None
    abutment: Abutment | None = None
    guide: Guide | None = None
    actuation: Actuation = Actuation(
        force=0.0, direction=0.0, point=Point(x=0.0, y=0.0)
    )  # until a strut gives it

    @model_validator(mode="after")
    def _held(self) -> Self:
        given = [key for key in KINDS if getattr(self, key) is not None]
        if not given:
            raise ValueError(
                "hinge: is missing; a shoe is held by one of hinge, hinge and pivot, abutment, guide"
            )
        if len(given) > 1:
            raise ValueError(
                f"{given[1]}: a shoe is held by one of {', '.join(KINDS)}, not by {' and '.join(given)}"
            )
        if self.pivot is not None and self.hinge is None:
            raise ValueError("pivot: is on a lever, whose pin is the hinge; hinge is missing")
        return self

    @property
    def held_by(self) -> str:
        """What holds the shoe: "hinge", "pivot", "abutment" or "guide"."""
        if self.hinge is not None:
            return "hinge" if self.pivot is None else "pivot"
        return "guide" if self.abutment is None else "abutment"

    @property
    def pin(self) -> Point:
        """The point that its moments and angles count from: the hinge, the foot's on an abutment;
        of a guided shoe, which has none, the point of its actuation.
        """
        if self.hinge is not None:
            return self.hinge
        return self.actuation.point if self.abutment is None else self.abutment.point

    def under(self, force: float) -> Self:
        """The shoe under another force [N] of its actuation."""
        return self.model_copy(
            update={"actuation": self.actuation.model_copy(update={"force": force})}
        )

    @property
    def bearing(self) -> Floats:
        """The direction (2,) of the force of a smooth abutment on the foot."""
        assert self.abutment is not None
        return np.array([math.cos(self.abutment.direction), math.sin(self.abutment.direction)])

    @property
    def senses(self) -> tuple[int, ...]:
        """How friction may act where the shoe is held, see `freedoms`: the first is to be tried
        first.
        """
        return (1, -1, 0) if self.abutment is not None and self.abutment.friction > 0 else (1,)

    def stands(self, reaction: Floats, sense: int, slide: float) -> bool:
        """Whether an abutment can give a reaction (2,) on the foot: it presses, and its friction of
        a `sense` opposes the `slide` of the foot along it (any length), or holds the foot. True of
        a shoe without one.
        """
        if self.abutment is None:
            return True
        c, s = self.bearing
        bearing, along = float(reaction @ [c, s]), float(reaction @ [-s, c])
        if bearing <= 0 or self.abutment.friction == 0:
            return bearing > 0
        if sense == 0:
            return abs(along) <= self.abutment.friction * bearing * (1 + STICKS)
        return sense * slide <= 0

    def freedoms(self, sense: int = 1) -> Freedoms:
        """The free motions of the shoe.

        sense: of an abutment's friction, +1 along the normal turned by +90 deg, -1 against it; 0
        where the foot sticks. UNHELD: the abutment is left out, the foot may slide and come off its
        face.
        """
        at = self.actuation.point.xy
        motions, names = [turn_about(self.pin)], ["turn"]
        if self.guide is not None:
            motions, names = [slide_along(self.guide.direction)], ["slide"]
        elif self.pivot is not None:
            motions.append(turn_about(self.pivot))
            names.append("tilt")
        tests = list(motions)
        if self.abutment is not None and sense != 0:
            along = self.abutment.direction + math.pi / 2
            motions.append(slide_along(along))
            tests.append(
                slide_along(along + (sense != UNHELD) * sense * math.atan(self.abutment.friction))
            )
            names.append("slide")
        if self.abutment is not None and sense == UNHELD:
            motions.append(slide_along(self.abutment.direction))
            tests.append(motions[-1])
            names.append("off")
        moved, tested = np.array(motions), np.array(tests)
        work = work_on(tested, self.actuation.vector, at)
        tip = work_on(moved, self.actuation.direction_vector, at)
        if (
            self.pivot is not None
        ):  # the actuation acts on the lever: it does no work where the shoe tilts on its pivot
            work[1] = tip[1] = 0.0
        return Freedoms(moved, tested, work, tip, tuple(names))

    def changes(self, sense: int = 1) -> dict[str, tuple[Change, ...]]:
        """How its freedoms change with what holds it, by key: points along x and y [per m],
        directions [per rad], friction [1]. Exact: freedoms are linear in points; sense: as of
        `freedoms`.
        """
        k = len(self.freedoms(sense).names)

        def both(row: int, change: Floats) -> Change:
            return Change(_rows(k, row, change), _rows(k, row, change))

        def point(row: int) -> tuple[Change, ...]:
            return both(row, np.array([0.0, -1.0, 0.0])), both(row, np.array([1.0, 0.0, 0.0]))

        if self.guide is not None:
            return {"guide.direction": (both(0, slide_along(self.guide.direction + math.pi / 2)),)}
        if self.abutment is None:
            return {"hinge": point(0)} | ({} if self.pivot is None else {"pivot": point(1)})
        found = {"abutment.point": point(0)}
        if sense == 0:  # the foot sticks: how its face lies does not matter
            return found
        mu, along = self.abutment.friction, self.abutment.direction + math.pi / 2
        tested = slide_along(along + sense * math.atan(mu) + math.pi / 2)
        found["abutment.direction"] = (
            Change(_rows(k, 1, slide_along(along + math.pi / 2)), _rows(k, 1, tested)),
        )
        if mu > 0:
            found["abutment.friction"] = (
                Change(np.zeros((k, 3)), _rows(k, 1, sense * tested / (1 + mu**2))),
            )
        return found


def _found(mesh: Path | None, info: ValidationInfo) -> Path | None:
    """The path from the folder of the brake file; what is read there is not to be written over."""
    base = (info.context or {}).get("base")
    if mesh is None or base is None:
        return mesh
    keep_input(base / mesh)
    return Path(base / mesh)


GroupNames = Name | int | tuple[Name | int, ...] | None
"""How a mesh file calls a group: a name, a number, several of them, or as drumlin does."""


class MeshGroups(Part):
    """The names or numbers that a mesh file has for the groups of a shoe; None: drumlin's name."""

    lining: GroupNames = None
    backing: GroupNames = None
    table: GroupNames = None
    shoe: GroupNames = None
    contact: GroupNames = None
    hinge: GroupNames = None
    actuation: GroupNames = None

    def names_of(self, group: str) -> list[str]:
        """The names in the file, in lower case, of one of drumlin's groups."""
        given = getattr(self, group)
        if given is None:
            return [group]
        several = given if isinstance(given, tuple) else (given,)
        return [str(name).lower() for name in several]

    @property
    def given(self) -> list[str]:
        """The groups that are named here."""
        return [group for group in type(self).model_fields if getattr(self, group) is not None]


class Meshed(Held):
    """A shoe that can take a mesh file, `mesh`, in place of the parametric mesh.

    Its coordinates are the brake's or, so that a shoe and its mirror image can share one file,
    those of the shoe's own `frame`. `mesh_interference` says that a contact line deep in the drum
    or the plane is meant. `groups` are the names or numbers that the file has for its groups.
    """

    mesh: Annotated[Path | None, AfterValidator(_found)] = None
    mesh_unit: Literal["m", "mm", "in"] = "m"
    mesh_frame: Literal["brake", "shoe"] = "brake"
    mesh_interference: bool = False
    groups: MeshGroups = MeshGroups()

    @model_validator(mode="after")
    def _of_a_mesh(self) -> Self:
        for key in ("mesh_unit", "mesh_frame", "mesh_interference", "groups"):
            if self.mesh is None and getattr(self, key) != type(self).model_fields[key].default:
                raise ValueError(
                    f"{key} = {getattr(self, key)!r}: belongs to a mesh file; mesh is missing"
                )
        return self


def _rows(count: int, row: int, change: Floats) -> Floats:
    """Changes (count, 3) of motions of which one changes."""
    found = np.zeros((count, 3))
    found[row] = change
    return found


def check_motions(key: str, shoe: Held, columns: slice) -> None:
    """Raise ValueError where two motions of a shoe close its gap alike, so that nothing fixes one
    of them.

    columns: those of a motion that close the gap, dx and dy on a drum, dy and turn on a plane.
    """
    closing = shoe.freedoms().motions[:, columns]
    if len(closing) == 2 and abs(np.linalg.det(closing)) <= 1e-6 * np.prod(
        np.linalg.norm(closing, axis=1)
    ):
        what = (
            "pivot: the lever's pin"
            if shoe.pivot is not None
            else "abutment: the normal of its face"
        )
        where = "the drum's centre" if columns.start == 0 else "the normal of the plane"
        raise ValueError(
            f"{key}.{what} must not be in line with it and {where}: the shoe would only slide"
        )
