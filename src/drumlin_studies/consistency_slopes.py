"""Printed slopes of random brakes of all kinds, held against central differences of solves.

`drumlin sensitivity` prints how the torque changes with friction, forces, moduli, bending
stiffnesses, clearances and what holds the shoes. Each slope must be that of `solve`: the central
difference over each of three steps, of solves that divide the brake anew each time. A brake is
divided into the elements of a mesh or into columns of a fixed level, in turn, because the default
refines until a stated error is small, and two of its answers may stand on two levels.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.components import Bar
from drumlin.brake.fields import AnyMaterial
from drumlin.brake.file import vary
from drumlin.fem.analysis.sensitivity import Sensitivity, sensitivity
from drumlin.fem.error_control.levels import LEVELS
from drumlin.fem.model import respond
from drumlin.fem.preparation.cache import Cache
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel
from drumlin_studies import random_brake, random_kinds
from drumlin_studies.consistency import Check

SLOPE_MESH_ELEMENTS = 10
"""Elements along a lining of the meshes. The slope is exact for the discrete brake, so that few
elements are enough."""
SLOPE_LEVEL = LEVELS[0]
"""The level of the columns, the coarsest, for the same reason."""
DIFFERENCE_STEPS = (1e-3, 3e-4, 1e-4)
"""Steps of the differences, relative to the size of the quantity. A larger step changes the contact
set and has the error of the difference itself, a smaller one has the round-off of the solves, some
1e-11 of the torque."""
STEP_FACTORS = (1.0, 0.1, 0.01)
"""Factors of the steps, tried in turn until no step changes the contact set."""
ALLOWED_SLOPE_DIFFERENCE = 0.01
"""Largest relative difference of a slope that counts as agreement; the aim of the project for
printed slopes."""
SMALLEST_SLOPE = 1e-3
"""A slope below this part of the torque over the quantity's size is compared with this part instead
of itself, so that ALLOWED_SLOPE_DIFFERENCE of it is 1e-5 of the torque: below that the differences have no
digits."""
SLOPES_PER_BRAKE = 3
"""Slopes of a brake that are compared, drawn by the seed; all of them would take some ten seconds
of a large brake."""

Changes = Callable[[float], dict[str, Any]]


class Slope(NamedTuple):
    """A printed slope: `what` it is over, its value `exact` [N m per unit, on a plane N], the keys
    that `changes` by a step gives, and the `size` of the quantity in its unit, 1 for a
    logarithm."""

    what: str
    exact: float
    changes: Changes
    size: float = 1.0


class TorqueOnDivision(NamedTuple):
    """The `torque` of a brake [N m], on a plane its braking force [N], the number of unknowns of
    each of its `bodies`, and which nodes of each shoe are `touching` the drum."""

    torque: float
    bodies: tuple[int, ...]
    touching: tuple[bytes, ...]

    def alike(self, other: "TorqueOnDivision") -> bool:
        """Whether both stand on the same division and the same contact set."""
        return self.bodies == other.bodies and self.touching == other.touching


@dataclass(frozen=True)
class Divided:
    """How a brake is divided into elements: on a mesh of `elements` along a lining, or in columns
    of SLOPE_LEVEL."""

    elements: int | None
    cache: Cache

    def scene(self, own: Brake) -> PreparedModel:
        """The prepared scene of a brake."""
        if self.elements is None:
            return prepare(own, SLOPE_LEVEL, cache=self.cache)
        return prepare(own, elements=self.elements, cache=self.cache)

    def solved(self, brake: Brake) -> "TorqueOnDivision":
        """The torque of a brake, and on what it stands. Raises as `solve`."""
        scene = self.scene(brake)
        response = respond(scene, brake)
        bodies = [body.unknowns for body in scene.bodies] + (
            [scene.ring.basis.N] if scene.ring else []
        )
        return TorqueOnDivision(
            response.torque,
            tuple(bodies),
            tuple((shoe.pressure > 0).tobytes() for shoe in response.shoes),
        )

    def slopes(self, brake: Brake) -> Sensitivity:
        """The slopes of a brake. Raises as `sensitivity`."""
        return sensitivity(self.scene(brake), brake)


def scaled(key: str, value: float) -> Changes:
    """Changes of a key by a part of its value."""
    return lambda s: {key: value * (1 + s)}


def scaled_moduli(key: str, material: AnyMaterial) -> Changes:
    """Changes of all moduli of the material of the part `key` by one part of their values."""
    return lambda s: {
        f"{key}material.{name}": value * (1 + s) for name, value in material.moduli.items()
    }


def shifted(key: str, value: float) -> Changes:
    """Changes of a key by a step."""
    return lambda s: {key: value + s}


def moved(key: str, x: float, y: float, way: int) -> Changes:
    """Changes of a point along x (0) or y (1)."""
    return lambda s: {key: {"x": x + s * (way == 0), "y": y + s * (way == 1)}}


def slopes_of(brake: Brake, found: Sensitivity) -> list[Slope]:
    """All slopes that are printed of a brake."""
    table = [Slope("friction", found.friction, shifted("friction", brake.friction), brake.friction)]
    table += _of_drive(brake, found)
    ring = brake.ring
    if ring is not None and found.ring is not None and ring.material is not None:
        table.append(Slope("E of the ring", found.ring, scaled_moduli("drum.ring.", ring.material)))
    if (
        ring is not None
        and found.ring_bending_stiffness is not None
        and ring.bending_stiffness is not None
    ):
        EI = scaled("drum.ring.bending_stiffness", ring.bending_stiffness)
        table.append(Slope("bending_stiffness of the ring", found.ring_bending_stiffness, EI))
    for i in range(len(brake.shoes)):
        table += _of_shoe(brake, found, i)
    return table


def _of_drive(brake: Brake, found: Sensitivity) -> Iterator[Slope]:
    drive = brake.actuation
    if drive is None or found.drive is None:
        return
    for key in ("force", "pressure", "torque"):
        value = getattr(drive, key)
        if value is not None:
            yield Slope("actuation", found.drive, scaled(f"actuation.{key}", value))


def _of_shoe(brake: Brake, found: Sensitivity, i: int) -> Iterator[Slope]:
    shoe, own, key = brake.shoes[i], found.shoes[i], f"shoe[{i}]."
    lining, body, radius = shoe.lining, shoe.body, brake.size
    behind_strut = any(link.to == shoe.name for link in brake.links)
    if own.force is not None and own.torque and brake.actuation is None and not behind_strut:
        force = shoe.actuation.force
        yield Slope("force", own.force * force, scaled(f"{key}actuation.force", force))
    yield Slope(
        "E of the lining", own.moduli["lining"], scaled_moduli(f"{key}lining.", lining.material)
    )
    if "backing" in own.moduli and shoe.backing is not None:
        yield Slope(
            "E of the backing",
            own.moduli["backing"],
            scaled_moduli(f"{key}backing.", shoe.backing.material),
        )
    if "shoe" in own.moduli and body is not None and body.material is not None:
        yield Slope(
            "E of the body", own.moduli["shoe"], scaled_moduli(f"{key}body.", body.material)
        )
    if (
        own.bending_stiffness is not None
        and body is not None
        and isinstance(body.bending_stiffness, float)
    ):
        EI = scaled(f"{key}body.bending_stiffness", body.bending_stiffness)
        yield Slope("bending_stiffness of the body", own.bending_stiffness, EI)
    if isinstance(lining.clearance, float):
        force = abs(shoe.actuation.force) or max(abs(each.actuation.force) for each in brake.shoes)
        area = brake.scale_factor * (lining.end - lining.start) * lining.width
        squeezed = force / area * lining.thickness / lining.material.E_through
        yield Slope(
            "clearance",
            own.clearance,
            shifted(f"{key}lining.clearance", lining.clearance),
            squeezed,
        )
    for what, value in own.held.items():
        at: Any = brake.shoes[i]
        for name in what.split("."):
            at = getattr(at, name)
        if len(value) == 1:
            size = at if what.endswith("friction") else 1.0
            yield Slope(what, float(value[0]), shifted(f"{key}{what}", at), size)
            continue
        for way, axis in enumerate("xy"):
            yield Slope(
                f"{what} along {axis}",
                float(value[way]),
                moved(f"{key}{what}", at.x, at.y, way),
                radius,
            )


def difference(
    brake: Brake, slope: Slope, divided: Divided, base: TorqueOnDivision
) -> float | None:
    """The largest relative difference of a slope from the central differences over three steps.

    None where a step of each size changes the contact set, or the number of elements, so that there
    is no slope.
    """
    for factor in STEP_FACTORS:
        worst = 0.0
        for step in DIFFERENCE_STEPS:
            h = factor * step * slope.size
            try:
                up, down = (divided.solved(vary(brake, slope.changes(s))) for s in (h, -h))
            except (BadInput, NoAnswer):
                break
            if not (up.alike(base) and down.alike(base)):
                break
            near = (up.torque - down.torque) / (2 * h)
            least = SMALLEST_SLOPE * base.torque / slope.size
            worst = max(worst, abs(slope.exact - near) / max(abs(near), least))
        else:
            return worst
    return None


SLOPE_KINDS = (*random_brake.SHAPE_KINDS, *random_kinds.HOLDING_KINDS)
"""Kinds of both generators, in the order in which seeds draw them."""


def brake_of(seed: int) -> tuple[str, Brake]:
    """Kind and brake of a seed, with friction; every other one with a body or a ring has a bending
    stiffness."""
    kind = SLOPE_KINDS[seed % len(SLOPE_KINDS)]
    draw = (
        random_brake.random_brake if kind in random_brake.SHAPE_KINDS else random_kinds.random_kind
    )
    brake: Brake = draw(seed, kind)
    while brake.friction == 0:
        seed += 10**6
        brake = draw(seed, kind)
    return kind, brake if seed // len(SLOPE_KINDS) % 2 else _with_bending_stiffness(
        brake, np.random.default_rng(seed)
    )


def _with_bending_stiffness(brake: Brake, rng: np.random.Generator) -> Brake:
    """The brake with the bending stiffness of its first body and of its ring given, near to what
    each has."""
    changes: dict[str, Any] = {}
    body = brake.shoes[0].body
    if body is not None and not (isinstance(body, Bar) and body.table is not None):
        EI = body.plates["shoe"].bending_stiffness
        changes["shoe[0].body.bending_stiffness"] = EI * math.exp(rng.uniform(-0.2, 0.2))
    if brake.ring is not None:
        changes["drum.ring.bending_stiffness"] = brake.ring.EI * math.exp(rng.uniform(-0.2, 0.2))
    return vary(brake, changes)


def checks(seed: int, most: int | None = SLOPES_PER_BRAKE) -> list[Check]:
    """The printed slopes of the brake of a seed against differences of solves: some, or with most =
    None all."""
    kind, brake = brake_of(seed)
    columns = bool(seed // len(SLOPE_KINDS) // 2 % 2)
    divided = Divided(None if columns else SLOPE_MESH_ELEMENTS, Cache())
    name = f"{kind} {seed}, {'columns' if columns else 'mesh'}"
    try:
        base = divided.solved(brake)
    except NoAnswer as error:
        base, refusal = None, str(error)
    try:
        found = divided.slopes(brake)
    except NoAnswer as error:
        return [
            Check(
                "slopes",
                name,
                "all",
                math.inf,
                ALLOWED_SLOPE_DIFFERENCE,
                str(error),
                refused=base is None,
            )
        ]
    if base is None:
        return [Check("slopes", name, "all", math.inf, ALLOWED_SLOPE_DIFFERENCE, refusal)]
    table = slopes_of(brake, found)
    if most is not None:
        table = [table[k] for k in np.random.default_rng(seed).permutation(len(table))[:most]]
    rows = []
    for slope in table:
        apart = difference(brake, slope, divided, base)
        if apart is not None:
            rows.append(Check("slopes", name, slope.what, apart, ALLOWED_SLOPE_DIFFERENCE))
    return rows
