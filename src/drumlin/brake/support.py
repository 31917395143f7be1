"""Supports of a shoe (hinge, lever pivot, abutment, guide) and the rigid-body modes they leave.

A rigid-body motion of the plane is three numbers: dx, dy [m] and turn [rad] about the origin, the
drum's centre or that of a plane's coordinates. The point x moves by (dx - turn y, dy + turn x).

The support reactions do no work on the test modes of a shoe. The test modes equal the rigid-body
modes unless friction acts at an abutment. Then the reaction leans away from the face's normal: the
shoe slides along the face, and its test mode is square to the reaction.
"""

import math
from pathlib import Path
from typing import Annotated, Literal, NamedTuple, Self

import numpy as np
from pydantic import (
    AfterValidator,
    Field,
    StrictInt,
    ValidationError,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    model_validator,
)

from drumlin.base.arrays import Floats
from drumlin.base.files import keep_input
from drumlin.brake.components import Actuation
from drumlin.brake.fields import Angle, Name, Part, Place, Point

MAIN_SUPPORTS = ("hinge", "abutment", "guide")
"""Keys of the supports of which a shoe has exactly one. A pivot comes on top of a hinge."""

MOVES = {
    "hinge": "it turns about its hinge",
    "pivot": "it turns about a pivot on its lever, not about its hinge",
    "abutment": "its foot slides on an abutment, it has no hinge",
    "guide": "it moves along a guide, it has no hinge",
}
"""How a shoe moves, in words of a refusal, by `Held.held_by`."""

UNHELD = 2
"""Sense of an abutment's friction that leaves the abutment out, see `Held.freedoms`."""

STICKS = 1e-9
"""Excess over the friction limit, relative to it, up to which a foot still sticks: round-off."""


class Abutment(Part):
    """A face on which the shoe's foot slides.

    The foot bears at `point`. `direction` [rad] is the face's normal, the direction of its force on
    the foot without friction. Its friction coefficient `friction` opposes the slide.
    """

    point: Place
    direction: Angle
    friction: Annotated[float, Field(ge=0, le=10, strict=True)] = 0.0


class Guide(Part):
    """A straight guide: the shoe moves only along `direction` [rad] and does not turn."""

    direction: Angle


class Freedoms(NamedTuple):
    """Rigid-body modes of a shoe.

    Attributes
    ----------
    motions : (k, 3), the modes
    tests : (k, 3), test modes, on which the support reactions do no work
    work : (k,), work of the actuation on the test modes [N m of a turn, N of a slide]
    tip : (k,), motion of the actuation's point along its force in the modes [m]
    names : (k,), "turn", "tilt" (about a pivot), "slide" or "off"
    """

    motions: Floats
    tests: Floats
    work: Floats
    tip: Floats
    names: tuple[str, ...]


def turn_about(point: Point) -> Floats:
    """Rigid-body motion (3,) of a unit turn about a point."""
    return np.array([point.y, -point.x, 1.0])


def slide_along(angle: float) -> Floats:
    """Rigid-body motion (3,) of a unit slide in the direction `angle` [rad]."""
    return np.array([math.cos(angle), math.sin(angle), 0.0])


def work_on(motions: Floats, force: Floats, point: Floats) -> Floats:
    """Work (k,) of a force (2,) [N] at a point (2,) [m] on rigid-body motions (k, 3)."""
    (x, y), (fx, fy) = point, force
    return motions @ np.array([fx, fy, x * fy - y * fx])


def wrench(forces: Floats, points: Floats) -> Floats:
    """Sum (3,) of forces (..., 2) [N] at points (..., 2) [m]: x, y and moment about the origin."""
    moments = points[..., 0] * forces[..., 1] - points[..., 1] * forces[..., 0]
    return np.array([forces[..., 0].sum(), forces[..., 1].sum(), moments.sum()])


def moved(motions: Floats, xy: Floats) -> Floats:
    """Displacements (2, n, k) of the points xy (2, n) per unit of rigid-body motions (k, 3)."""
    x, y = xy[..., None]
    dx, dy, turn = motions.T
    return np.array([dx - turn * y, dy + turn * x])


class SupportChange(NamedTuple):
    """Change of a shoe's rigid-body `motions` and `tests` (k, 3) with one number of its support."""

    motions: Floats
    tests: Floats


class Held(Part):
    """A shoe with its name, its support and its actuation, on a drum or on a plane.

    Its support is one of four. A `hinge` is a pin about which the shoe turns. With a `pivot`, the
    hinge is the pin of a lever: the actuation acts on the lever, and the shoe turns about the pivot
    at the lever's end. An `abutment` is a face on which the foot slides. A `guide` lets the shoe
    move along one direction.
    """

    name: Name
    hinge: Place | None = None
    pivot: Place | None = None
    abutment: Abutment | None = None
    guide: Guide | None = None
    # A shoe behind a strut has this actuation until the strut gives another.
    actuation: Actuation = Actuation(force=0.0, direction=0.0, point=Point(x=0.0, y=0.0))

    @model_validator(mode="after")
    def _check_support(self) -> Self:
        """Raise ValueError unless the shoe has one of the four supports."""
        given = [key for key in MAIN_SUPPORTS if getattr(self, key) is not None]
        if not given:
            raise ValueError(
                "hinge: is missing; "
                "a shoe is held by one of hinge, hinge and pivot, abutment, guide"
            )
        if len(given) > 1:
            raise ValueError(
                f"{given[1]}: a shoe is held by one of {', '.join(MAIN_SUPPORTS)}, "
                f"not by {' and '.join(given)}"
            )
        if self.pivot is not None and self.hinge is None:
            raise ValueError("pivot: is on a lever, whose pin is the hinge; hinge is missing")
        return self

    @property
    def held_by(self) -> str:
        """The shoe's support: "hinge", "pivot", "abutment" or "guide"."""
        if self.hinge is not None:
            return "hinge" if self.pivot is None else "pivot"
        return "guide" if self.abutment is None else "abutment"

    @property
    def pin(self) -> Point:
        """The point from which moments and angles of the shoe count.

        It is the hinge, the foot on an abutment, or the point of actuation of a guided shoe.
        """
        if self.hinge is not None:
            return self.hinge
        return self.actuation.point if self.abutment is None else self.abutment.point

    def under(self, force: float) -> Self:
        """The shoe under another force [N] of its actuation."""
        actuation = self.actuation.model_copy(update={"force": force})
        return self.model_copy(update={"actuation": actuation})

    @property
    def bearing(self) -> Floats:
        """Unit vector (2,) of the force of a smooth abutment on the foot."""
        assert self.abutment is not None
        return np.array([math.cos(self.abutment.direction), math.sin(self.abutment.direction)])

    @property
    def senses(self) -> tuple[int, ...]:
        """Possible senses of the friction at the support, see `freedoms`, in the order of trial."""
        return (1, -1, 0) if self.abutment is not None and self.abutment.friction > 0 else (1,)

    def stands(self, reaction: Floats, sense: int, slide: float) -> bool:
        """Whether an abutment can give a reaction on the foot.

        It can if it presses on the foot and its friction opposes the slide, or holds the foot. A
        shoe without abutment always stands.

        Parameters
        ----------
        reaction : (2,), force on the foot [N]
        sense : of the friction, as of `freedoms`
        slide : of the foot along the face, in any unit
        """
        if self.abutment is None:
            return True
        c, s = self.bearing
        # The parts of the reaction along the normal of the face and along the face.
        bearing, along = float(reaction @ [c, s]), float(reaction @ [-s, c])
        if bearing <= 0 or self.abutment.friction == 0:
            return bearing > 0
        # A foot that sticks needs no more friction than the bearing force can give.
        if sense == 0:
            return abs(along) <= self.abutment.friction * bearing * (1 + STICKS)
        return sense * slide <= 0

    def freedoms(self, sense: int = 1) -> Freedoms:
        """Rigid-body modes of the shoe.

        The `sense` of an abutment's friction is +1 along the normal turned by +90 deg, -1 against
        it, and 0 if the foot sticks. With UNHELD the abutment is left out: the foot may slide and
        come off its face.
        """
        at = self.actuation.point.xy
        # Every shoe but a guided one turns about its pin; a second mode follows from its support.
        motions, names = [turn_about(self.pin)], ["turn"]
        if self.guide is not None:
            motions, names = [slide_along(self.guide.direction)], ["slide"]
        elif self.pivot is not None:
            motions.append(turn_about(self.pivot))
            names.append("tilt")
        tests = list(motions)
        if self.abutment is not None and sense != 0:
            along = self.abutment.direction + math.pi / 2
            # Friction turns the test mode, so that it stays square to the reaction.
            leaning = (sense != UNHELD) * sense * math.atan(self.abutment.friction)
            motions.append(slide_along(along))
            tests.append(slide_along(along + leaning))
            names.append("slide")
        # A foot without its face also moves along the normal of the face.
        if self.abutment is not None and sense == UNHELD:
            motions.append(slide_along(self.abutment.direction))
            tests.append(motions[-1])
            names.append("off")
        moved, tested = np.array(motions), np.array(tests)
        work = work_on(tested, self.actuation.vector, at)
        tip = work_on(moved, self.actuation.direction_vector, at)
        # With a pivot the actuation acts on the lever, and does no work as the shoe tilts.
        if self.pivot is not None:
            work[1] = tip[1] = 0.0
        return Freedoms(moved, tested, work, tip, tuple(names))

    def changes(self, sense: int = 1) -> dict[str, tuple[SupportChange, ...]]:
        """Exact changes of the rigid-body modes with the support, by key.

        Points change along x and y [per m], directions [per rad], friction [per 1]. The modes are
        linear in points. The `sense` is as of `freedoms`.
        """
        k = len(self.freedoms(sense).names)

        def both(row: int, change: Floats) -> SupportChange:
            """An equal change of motion and test mode `row`."""
            return SupportChange(_change_of_mode(k, row, change), _change_of_mode(k, row, change))

        def point(row: int) -> tuple[SupportChange, ...]:
            """The changes of mode `row`, a turn about a point, as the point moves along x and y."""
            return both(row, np.array([0.0, -1.0, 0.0])), both(row, np.array([1.0, 0.0, 0.0]))

        if self.guide is not None:
            return {"guide.direction": (both(0, slide_along(self.guide.direction + math.pi / 2)),)}
        if self.abutment is None:
            return {"hinge": point(0)} | ({} if self.pivot is None else {"pivot": point(1)})
        found = {"abutment.point": point(0)}
        # If the foot sticks, the direction of its face does not matter.
        if sense == 0:
            return found
        # Friction leans the test mode by its angle; the motion stays along the face.
        mu, along = self.abutment.friction, self.abutment.direction + math.pi / 2
        tested = slide_along(along + sense * math.atan(mu) + math.pi / 2)
        of_motion = slide_along(along + math.pi / 2)
        of_direction = SupportChange(
            _change_of_mode(k, 1, of_motion), _change_of_mode(k, 1, tested)
        )
        found["abutment.direction"] = (of_direction,)
        if mu > 0:
            of_test = _change_of_mode(k, 1, sense * tested / (1 + mu**2))
            found["abutment.friction"] = (SupportChange(np.zeros((k, 3)), of_test),)
        return found


def _absolute_mesh_path(mesh: Path | None, info: ValidationInfo) -> Path | None:
    """The path from the brake file's folder; the file there is protected from being written."""
    base = (info.context or {}).get("base")
    if mesh is None or base is None:
        return mesh
    keep_input(base / mesh)
    return Path(base / mesh)


def _read_group_names(value: object, read: ValidatorFunctionWrapHandler) -> object:
    """Read the names or numbers of a group in a mesh file. Raises ValueError for other data."""
    try:
        return read(value)
    except ValidationError as error:
        raise ValueError(
            "must be the name or the whole number of a group in the mesh file, or a list of these"
        ) from error


GroupNames = Annotated[
    Name | StrictInt | tuple[Name | StrictInt, ...] | None, WrapValidator(_read_group_names)
]
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
        """The groups of drumlin for which a brake file gives names of the mesh file."""
        return [group for group in type(self).model_fields if getattr(self, group) is not None]


class Meshed(Held):
    """A shoe that may have a mesh file, `mesh`, in place of the parametric mesh.

    The coordinates of the mesh are the brake's, or those of the shoe's own `frame`: then a shoe and
    its mirror image can share a file. `mesh_interference` states that a contact line deep in the
    drum or the plane is intended. `groups` are the names or numbers of its groups in the file.
    """

    mesh: Annotated[Path | None, AfterValidator(_absolute_mesh_path)] = None
    mesh_unit: Literal["m", "mm", "in"] = "m"
    mesh_frame: Literal["brake", "shoe"] = "brake"
    mesh_interference: bool = False
    groups: MeshGroups = MeshGroups()

    @model_validator(mode="after")
    def _check_mesh_keys(self) -> Self:
        """Raise ValueError for keys that only a shoe with a mesh file may have."""
        for key in ("mesh_unit", "mesh_frame", "mesh_interference", "groups"):
            if self.mesh is None and getattr(self, key) != type(self).model_fields[key].default:
                raise ValueError(
                    f"{key} = {getattr(self, key)!r}: belongs to a mesh file; mesh is missing"
                )
        return self


def _change_of_mode(count: int, row: int, change: Floats) -> Floats:
    """Changes (count, 3) of several modes of which only mode `row` changes."""
    found = np.zeros((count, 3))
    found[row] = change
    return found


def check_motions(key: str, shoe: Held, columns: slice) -> None:
    """Raise ValueError if two rigid-body modes of a shoe close its gap alike.

    Then nothing holds one of the modes.

    Parameters
    ----------
    key : of the shoe in the message
    shoe : the shoe
    columns : columns of a motion that close the gap: dx and dy on a drum, dy and turn on a plane
    """
    closing = shoe.freedoms().motions[:, columns]
    # A shoe with one mode has no second mode that could be like it.
    if len(closing) != 2:
        return
    lengths = np.linalg.norm(closing, axis=1)
    if abs(np.linalg.det(closing)) <= 1e-6 * np.prod(lengths):
        what = (
            "pivot: the lever's pin"
            if shoe.pivot is not None
            else "abutment: the normal of its face"
        )
        where = "the drum's centre" if columns.start == 0 else "the normal of the plane"
        raise ValueError(
            f"{key}.{what} must not be in line with it and {where}: the shoe would only slide"
        )
