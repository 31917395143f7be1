"""Checks that derivatives of the torque agree with central differences, on random brakes.

`drumlin sensitivity` prints the derivatives, called slopes, of the torque by friction, forces,
moduli, bending stiffnesses, clearances and supports. Each slope must agree with the central
difference of two solves, for each of three step sizes. Each solve meshes the brake anew, by a
low-order mesh or by hp elements of a fixed level. The default solve cannot be used: it refines the
mesh until its error is small, so that two of its results may come from different meshes.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import ShoeBodyOfConstantSection
from drumlin.brake.fields import IsotropicOrOrthotropicMaterial
from drumlin.brake.file import vary
from drumlin.fem.analysis.sensitivity import (
    ShoeSensitivity,
    TorqueSensitivities,
    compute_torque_sensitivity,
)
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.cache import CacheOfCondensedBodies
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from drumlin_studies import random_brake, random_kinds
from drumlin_studies.consistency import TwoPathComparison
from drumlin_studies.random_kinds import draw_random_brake_of_kind

ELEMENTS_PER_LINING_OF_SLOPE_CHECK = 10
"""Number of elements along a lining of the low-order meshes.

Slopes are exact for the discretised brake, so that few elements are enough.
"""
HP_MESH_LEVEL_OF_SLOPE_CHECK = REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0]
"""Level of the hp meshes: the coarsest one, since slopes are exact for the discretised brake."""
RELATIVE_STEPS_OF_CENTRAL_DIFFERENCES = (1e-3, 3e-4, 1e-4)
"""Steps of the central differences, relative to the size of the varied quantity.

A larger step may change the contact set, and has a larger truncation error. A smaller step has a
larger error by round-off, which is some 1e-11 of the torque in a solve.
"""
FACTORS_THAT_SHRINK_DIFFERENCE_STEPS = (1.0, 0.1, 0.01)
"""Factors that shrink all RELATIVE_STEPS_OF_CENTRAL_DIFFERENCES. They are tried in turn until no
step changes the contact set.
"""
ALLOWED_SLOPE_DIFFERENCE = 0.01
"""Largest relative difference between a slope and a central difference that counts as agreement.

It is the accuracy that drumlin aims at for printed slopes.
"""
SLOPE_BELOW_WHICH_DIFFERENCES_ARE_ABSOLUTE = 1e-3
"""Slope below which differences are relative to SLOPE_BELOW_WHICH_DIFFERENCES_ARE_ABSOLUTE and not
to the slope itself.

It is relative to the torque divided by the size of the varied quantity. Central differences cannot
resolve smaller slopes: ALLOWED_SLOPE_DIFFERENCE of this slope is 1e-5 of the torque.
"""
COMPARED_SLOPES_PER_BRAKE = 3
"""Number of slopes of a brake that are compared; the seed decides which slopes.

All slopes of a large brake would take some ten seconds.
"""

FunctionFromStepToKeyValues = Callable[[float], dict[str, Any]]
"""A function of a step that returns new values of a brake file's keys, by the keys' paths."""


class PrintedTorqueSlope(NamedTuple):
    """A derivative of the torque that drumlin prints, and the brake file's keys to vary for it.

    Attributes
    ----------
    what : str
        Name of the quantity by which the torque is differentiated.
    exact : float
        Printed derivative [N m per unit of the quantity, on a plane N per unit].
    changes : function
        Function of a step of the quantity that returns new values of the brake file's keys.
    size : float
        Size of the quantity in its unit; 1 for a derivative by the logarithm of the quantity.
    """

    what: str
    exact: float
    changes: FunctionFromStepToKeyValues
    size: float = 1.0


class TorqueWithMeshAndContactSet(NamedTuple):
    """A torque, with data by which two solves are seen to share the mesh and the contact set.

    Attributes
    ----------
    torque : float
        Torque [N m], or on a plane the braking force [N].
    bodies : tuple of int
        Number of unknowns of each shoe and of the ring.
    touching : tuple of bytes
        For each shoe, whether each node of its lining is in contact, as bytes.
    """

    torque: float
    bodies: tuple[int, ...]
    touching: tuple[bytes, ...]

    def has_same_mesh_and_contact(self, other: "TorqueWithMeshAndContactSet") -> bool:
        """Whether both torques were computed with the same mesh size and the same contact set."""
        return self.bodies == other.bodies and self.touching == other.touching


@dataclass(frozen=True)
class MeshKindForSlopes:
    """The kind of mesh with which a brake is solved and its slopes are computed.

    Attributes
    ----------
    elements : int or None
        Number of elements along a lining of a low-order mesh; None for hp elements of
        HP_MESH_LEVEL_OF_SLOPE_CHECK.
    cache : CacheOfCondensedBodies
        Condensed shoes, which solves of shoes of equal shape share.
    """

    elements: int | None
    cache: CacheOfCondensedBodies

    def meshed_and_condensed_model_of_brake(self, own: Brake) -> PreparedModel:
        """The model of a brake that is meshed and condensed, ready to be solved."""
        if self.elements is None:
            return make_prepared_model(own, HP_MESH_LEVEL_OF_SLOPE_CHECK, cache=self.cache)
        return make_prepared_model(own, elements=self.elements, cache=self.cache)

    def solve_brake_for_torque(self, brake: Brake) -> "TorqueWithMeshAndContactSet":
        """Solve a brake and return its torque, mesh size and contact set. Raises like `solve`."""
        scene = self.meshed_and_condensed_model_of_brake(brake)
        response = solve_prepared_model(scene, brake)
        # Two meshes count as equal if their numbers of unknowns are equal.
        bodies = [body.unknowns for body in scene.bodies]
        if scene.ring:
            bodies.append(scene.ring.basis.N)
        touching = tuple((shoe.pressure > 0).tobytes() for shoe in response.shoes)
        return TorqueWithMeshAndContactSet(response.torque, tuple(bodies), touching)

    def compute_derivatives_of_brake_torque(self, brake: Brake) -> TorqueSensitivities:
        """The derivatives of a brake's torque. Raises like `compute_torque_sensitivity`."""
        return compute_torque_sensitivity(self.meshed_and_condensed_model_of_brake(brake), brake)


def make_function_that_scales_value_of_key(key: str, value: float) -> FunctionFromStepToKeyValues:
    """A function of a step s that returns the value of a key multiplied by 1 + s."""
    return lambda s: {key: value * (1 + s)}


def make_function_that_scales_material_moduli(
    key: str, material: IsotropicOrOrthotropicMaterial
) -> FunctionFromStepToKeyValues:
    """A function of a step s that returns all moduli of a material multiplied by 1 + s, by key.

    `key` is the path of the part in the brake file, with a dot at its end.
    """
    return lambda s: {
        f"{key}material.{name}": value * (1 + s) for name, value in material.moduli.items()
    }


def make_function_that_shifts_value_of_key(key: str, value: float) -> FunctionFromStepToKeyValues:
    """A function of a step s that returns the value of a key plus s."""
    return lambda s: {key: value + s}


def make_function_that_shifts_point(
    key: str, x: float, y: float, way: int
) -> FunctionFromStepToKeyValues:
    """A function of a step s that returns a point shifted by s along x (way 0) or y (way 1)."""
    return lambda s: {key: {"x": x + s * (way == 0), "y": y + s * (way == 1)}}


def all_torque_sensitivities_printed_for_brake(
    brake: Brake, found: TorqueSensitivities
) -> list[PrintedTorqueSlope]:
    """All derivatives of the torque that `drumlin sensitivity` prints for a brake."""
    table = [
        PrintedTorqueSlope(
            "friction",
            found.friction,
            make_function_that_shifts_value_of_key("friction", brake.friction),
            brake.friction,
        )
    ]
    table += _torque_slope_by_actuation_of_all_shoes(brake, found)
    table += _torque_slopes_by_ring_stiffness(brake, found)
    for i in range(len(brake.shoes)):
        table += _torque_slopes_by_shoe_quantities(brake, found, i)
    return table


def _torque_slopes_by_ring_stiffness(
    brake: Brake, found: TorqueSensitivities
) -> Iterator[PrintedTorqueSlope]:
    """Yield the torque's derivatives by the moduli and bending stiffness of the drum's ring."""
    ring = brake.ring
    if ring is None:
        return
    if found.ring is not None and ring.material is not None:
        yield PrintedTorqueSlope(
            "E of the ring",
            found.ring,
            make_function_that_scales_material_moduli("drum.ring.", ring.material),
        )
    # A bending stiffness that drumlin computes from the modulus is no key of the file, and has no
    # slope.
    if found.ring_bending_stiffness is not None and ring.bending_stiffness is not None:
        EI = make_function_that_scales_value_of_key(
            "drum.ring.bending_stiffness", ring.bending_stiffness
        )
        yield PrintedTorqueSlope("bending_stiffness of the ring", found.ring_bending_stiffness, EI)


def _torque_slope_by_actuation_of_all_shoes(
    brake: Brake, found: TorqueSensitivities
) -> Iterator[PrintedTorqueSlope]:
    """Yield the torque's derivative by the common force, pressure or torque of all shoes."""
    drive = brake.actuation
    if drive is None or found.drive is None:
        return
    for key in ("force", "pressure", "torque"):
        value = getattr(drive, key)
        if value is not None:
            yield PrintedTorqueSlope(
                "actuation",
                found.drive,
                make_function_that_scales_value_of_key(f"actuation.{key}", value),
            )


def _torque_slopes_by_shoe_quantities(
    brake: Brake, found: TorqueSensitivities, i: int
) -> Iterator[PrintedTorqueSlope]:
    """Yield the torque's derivatives by the force, stiffness, clearance and support of shoe i."""
    shoe, own, key = brake.shoes[i], found.shoes[i], f"shoe[{i}]."
    # The force on a shoe behind a strut is the reaction of another shoe, and is no key of a file.
    behind_strut = any(link.to == shoe.name for link in brake.links)
    if own.force is not None and own.torque and brake.actuation is None and not behind_strut:
        force = shoe.actuation.force
        yield PrintedTorqueSlope(
            "force",
            own.force * force,
            make_function_that_scales_value_of_key(f"{key}actuation.force", force),
        )
    yield from _torque_slopes_by_shoe_stiffness(shoe, own, key)
    clearance = shoe.lining.clearance
    if isinstance(clearance, float):
        changes = make_function_that_shifts_value_of_key(f"{key}lining.clearance", clearance)
        yield PrintedTorqueSlope(
            "clearance", own.clearance, changes, _lining_compression_under_actuation(brake, shoe)
        )
    for what, value in own.held.items():
        yield from _sensitivities_of_torque_to_shoe_support(brake, i, what, value)


def _torque_slopes_by_shoe_stiffness(
    shoe: Shoe, own: ShoeSensitivity, key: str
) -> Iterator[PrintedTorqueSlope]:
    """Yield the torque's derivatives by the moduli and the bending stiffness of a shoe.

    `key` is the path of the shoe in the brake file, with a dot at its end.
    """
    moduli, body = own.moduli, shoe.body
    lining = make_function_that_scales_material_moduli(f"{key}lining.", shoe.lining.material)
    yield PrintedTorqueSlope("E of the lining", moduli["lining"], lining)
    if "backing" in moduli and shoe.backing is not None:
        backing = make_function_that_scales_material_moduli(f"{key}backing.", shoe.backing.material)
        yield PrintedTorqueSlope("E of the backing", moduli["backing"], backing)
    if body is None:
        return
    if "shoe" in moduli and body.material is not None:
        changes = make_function_that_scales_material_moduli(f"{key}body.", body.material)
        yield PrintedTorqueSlope("E of the body", moduli["shoe"], changes)
    if own.bending_stiffness is not None and isinstance(body.bending_stiffness, float):
        EI = make_function_that_scales_value_of_key(
            f"{key}body.bending_stiffness", body.bending_stiffness
        )
        yield PrintedTorqueSlope("bending_stiffness of the body", own.bending_stiffness, EI)


def _lining_compression_under_actuation(brake: Brake, shoe: Shoe) -> float:
    """Compression of a lining [m] under the actuation force of its shoe.

    For a shoe without an actuation force, the largest force of all shoes is used.
    """
    lining = shoe.lining
    force = abs(shoe.actuation.force) or max(abs(each.actuation.force) for each in brake.shoes)
    area = brake.length_per_surface_coordinate * (lining.end - lining.start) * lining.width
    return force / area * lining.thickness / lining.material.E_through


def _sensitivities_of_torque_to_shoe_support(
    brake: Brake, i: int, what: str, value: Floats
) -> Iterator[PrintedTorqueSlope]:
    """Yield the torque's derivatives by a number or a point that defines the support of shoe i.

    `what` is the key path of this number or point, relative to the shoe in the brake file. `value`
    holds the slope by the number (1,) or the slopes by the coordinates of the point (2,).
    """
    at: Any = brake.shoes[i]
    for name in what.split("."):
        at = getattr(at, name)
    key = f"shoe[{i}].{what}"
    # A number of a support has one derivative; a point has one for each coordinate.
    if len(value) == 1:
        size = at if what.endswith("friction") else 1.0
        yield PrintedTorqueSlope(
            what, float(value[0]), make_function_that_shifts_value_of_key(key, at), size
        )
        return
    for way, axis in enumerate("xy"):
        changes = make_function_that_shifts_point(key, at.x, at.y, way)
        yield PrintedTorqueSlope(f"{what} along {axis}", float(value[way]), changes, brake.size)


def largest_relative_difference_from_central_differences(
    brake: Brake,
    slope: PrintedTorqueSlope,
    divided: MeshKindForSlopes,
    base: TorqueWithMeshAndContactSet,
) -> float | None:
    """The largest relative difference between a printed derivative and three central differences.

    Returns None if steps of all sizes change the contact set or the mesh, so that the torque has no
    derivative there.

    Parameters
    ----------
    brake : Brake
        The brake.
    slope : PrintedTorqueSlope
        The printed slope.
    divided : MeshKindForSlopes
        The kind of mesh.
    base : TorqueWithMeshAndContactSet
        The torque of the unchanged brake.
    """
    # The loop ends at the first factor at which all three steps keep the contact set.
    for factor in FACTORS_THAT_SHRINK_DIFFERENCE_STEPS:
        largest = 0.0
        for step in RELATIVE_STEPS_OF_CENTRAL_DIFFERENCES:
            apart = _torque_slope_error_by_central_difference(
                brake, slope, divided, base, factor * step * slope.size
            )
            if apart is None:
                break
            largest = max(largest, apart)
        else:
            return largest
    return None


def _torque_slope_error_by_central_difference(
    brake: Brake,
    slope: PrintedTorqueSlope,
    divided: MeshKindForSlopes,
    base: TorqueWithMeshAndContactSet,
    step: float,
) -> float | None:
    """The relative difference between a printed derivative and a central difference.

    The step has the unit of the varied quantity. Returns None if the step changes the contact set
    or the mesh.
    """
    try:
        up = divided.solve_brake_for_torque(vary(brake, slope.changes(step)))
        down = divided.solve_brake_for_torque(vary(brake, slope.changes(-step)))
    except (BadInput, NoAnswer):
        return None
    if not (up.has_same_mesh_and_contact(base) and down.has_same_mesh_and_contact(base)):
        return None
    central = (up.torque - down.torque) / (2 * step)
    smallest = SLOPE_BELOW_WHICH_DIFFERENCES_ARE_ABSOLUTE * base.torque / slope.size
    return abs(slope.exact - central) / max(abs(central), smallest)


KINDS_OF_RANDOM_BRAKES_FOR_SLOPE_CHECK = (
    *random_brake.FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND,
    *random_kinds.FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND,
)
"""The kinds of random brakes, in the order in which consecutive seeds draw them."""


def draw_random_brake_with_friction_and_name_of_kind(seed: int) -> tuple[str, Brake]:
    """The name of a kind of brakes, and the random brake with friction, that a seed gives.

    In half of the brakes the shoe's body and the ring have a bending stiffness given by number.
    """
    kind = KINDS_OF_RANDOM_BRAKES_FOR_SLOPE_CHECK[
        seed % len(KINDS_OF_RANDOM_BRAKES_FOR_SLOPE_CHECK)
    ]
    brake = draw_random_brake_of_kind(seed, kind)
    # Without friction a drum brake has no torque to which slopes could be relative.
    while brake.friction == 0:
        seed += 10**6
        brake = draw_random_brake_of_kind(seed, kind)
    if seed // len(KINDS_OF_RANDOM_BRAKES_FOR_SLOPE_CHECK) % 2:
        return kind, brake
    return kind, _brake_with_random_bending_stiffness(brake, np.random.default_rng(seed))


def _brake_with_random_bending_stiffness(brake: Brake, rng: np.random.Generator) -> Brake:
    """A copy of the brake whose first shoe and ring have a bending stiffness given by number.

    Each number is drawn near the bending stiffness that the part already has.
    """
    changes: dict[str, Any] = {}
    body = brake.shoes[0].body
    if body is not None and not (
        isinstance(body, ShoeBodyOfConstantSection) and body.table is not None
    ):
        EI = body.plates["shoe"].bending_stiffness
        changes["shoe[0].body.bending_stiffness"] = EI * math.exp(rng.uniform(-0.2, 0.2))
    if brake.ring is not None:
        changes["drum.ring.bending_stiffness"] = brake.ring.EI * math.exp(rng.uniform(-0.2, 0.2))
    return vary(brake, changes)


def rows_comparing_torque_slopes_of_random_brake(
    seed: int, most: int | None = COMPARED_SLOPES_PER_BRAKE
) -> list[TwoPathComparison]:
    """Compare the torque's printed derivatives with central differences, for a random brake.

    The seed gives the brake. Returns a row for each derivative. At most `most` derivatives are
    compared, or all if it is None.
    """
    kind, brake = draw_random_brake_with_friction_and_name_of_kind(seed)
    on_hp_elements = bool(seed // len(KINDS_OF_RANDOM_BRAKES_FOR_SLOPE_CHECK) // 2 % 2)
    divided = MeshKindForSlopes(
        None if on_hp_elements else ELEMENTS_PER_LINING_OF_SLOPE_CHECK, CacheOfCondensedBodies()
    )
    name = f"{kind} {seed}, {'columns' if on_hp_elements else 'mesh'}"
    no_slopes = TwoPathComparison("slopes", name, "all", math.inf, ALLOWED_SLOPE_DIFFERENCE)
    # If one of `solve` and `sensitivity` refuses the brake, the other one must refuse it, too.
    try:
        base = divided.solve_brake_for_torque(brake)
    except NoAnswer as error:
        base, refusal = None, str(error)
    try:
        found = divided.compute_derivatives_of_brake_torque(brake)
    except NoAnswer as error:
        return [no_slopes._replace(said=str(error), refused=base is None)]
    if base is None:
        return [no_slopes._replace(said=refusal)]
    table = all_torque_sensitivities_printed_for_brake(brake, found)
    if most is not None:
        table = [table[k] for k in np.random.default_rng(seed).permutation(len(table))[:most]]
    rows = []
    for slope in table:
        apart = largest_relative_difference_from_central_differences(brake, slope, divided, base)
        if apart is not None:
            rows.append(
                TwoPathComparison("slopes", name, slope.what, apart, ALLOWED_SLOPE_DIFFERENCE)
            )
    return rows
