"""Reference values of a brake, with their uncertainties, for others to cite.

A reference value comes from hp elements on the finer of two meshes, with exact contact. Its
uncertainty is the larger one of its distances from two other solutions. One of these is the
solution on the coarser hp mesh, which has another degree and grading. The other one comes from a
second solver, on curved triangles, which shares nothing with the hp elements but the brake. (hp
elements are finite elements of high polynomial degree whose sizes shrink towards singular points.)
"""

import importlib.metadata
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np

import drumlin
from drumlin.base.arrays import Bools, Floats
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.further_loads import brake_with_springs_of_constant_pull
from drumlin.brake.surface import FRICTION_SURFACE_OF_DRUM, FrictionSurface
from drumlin.comparison import length_of_uncompared_zone_at_lining_end
from drumlin.fem.error_control.levels import solve_brake_on_finer_and_finer_mesh_levels
from drumlin.fem.error_control.singular_points import singular_points_of_each_shoe_shape
from drumlin.fem.hp.division import RefinementLevel
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.response.balance import resultant_of_contact_on_shoe
from drumlin.response.norms import relative_distance_of_pressures
from drumlin.response.response import (
    Response,
    ShoeResponse,
    length_of_edge_zone_left_out_of_peak_search,
    response_of_pressed_elastic_shoe,
    which_angles_are_outside_end_zones,
)
from drumlin.response.resultants import BeginAndEndOfEachSlot
from drumlin.verification import triangles

PACKAGES_WITH_VERSION_IN_REFERENCE_VALUES = ("numpy", "scipy", "scikit-fem")
"""Packages whose versions are stored with reference values, beside drumlin's own version."""

FIRST_WORDS_OF_REFERENCE_METHOD_TEXT = (
    "2D plane stress, unilateral contact, full-slip Coulomb friction, exact contact; value: "
    "columns of elements of high degree; uncertainty: the "
)
"""First words of the description of the method that is stored with reference values."""

REFERENCE_METHOD_TEXT_WITH_TRIANGLES = FIRST_WORDS_OF_REFERENCE_METHOD_TEXT + (
    "larger of the distances from another division of them and "
    "from curved triangles with contact node by node"
)
"""Description of the method for a brake that the curved triangles have solved, too."""

REFERENCE_METHOD_TEXT_WITHOUT_TRIANGLES = (
    FIRST_WORDS_OF_REFERENCE_METHOD_TEXT + "distance from another division of them"
)
"""Description of the method for a brake that the curved triangles cannot solve."""


class MeshesOfReferenceValues(NamedTuple):
    """The meshes on which reference values are computed.

    Attributes
    ----------
    first : number of coarse meshes of hp elements that are solved first, to find the ends of the
        contact
    levels : degree and grading of two hp meshes; the second mesh gives the reference values
    triangles : degree and grading of meshes of curved triangles, from coarse to fine; empty if
        triangles shall not be used
    """

    first: int
    levels: tuple[RefinementLevel, RefinementLevel]
    triangles: tuple[triangles.DegreeAndGradingOfTriangleMesh, ...]


ONE_DEGREE_IN_RADIANS = math.pi / 180
"""One degree [rad]: the step of the angles at which reference values list the pressure."""

MESHES_OF_PUBLISHED_REFERENCE_VALUES = MeshesOfReferenceValues(
    3,
    (
        # The arguments of RefinementLevel are: degree, zone, edge, end, ratio, opening, largest,
        # back, hinge, through.
        RefinementLevel(
            7, 0.02, 0.01, 0.002, 0.45, 0.45, 15 * ONE_DEGREE_IN_RADIANS, 0.01, 0.01, 0.3
        ),
        RefinementLevel(
            8, 0.01, 0.006, 0.001, 0.5, 0.5, 15 * ONE_DEGREE_IN_RADIANS, 0.003, 0.01, 0.4
        ),
    ),
    triangles.TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE,
)
"""The meshes of the reference values that are published.

Element sizes grow slowly with the distance from the ends of lining, backing and body and from the
hinge, because the torque depends on the stresses there. Even smaller elements at the lining's ends
would not reduce the error: in a stiff shoe they would add more round-off error than they remove
discretisation error.
"""


class ResponsesBehindReferenceValues(NamedTuple):
    """The solutions of a brake from which its reference values and their uncertainty come.

    Attributes
    ----------
    value : response on the finer hp mesh, which gives the reference values
    before : response on the coarser hp mesh
    other : response by curved triangles; None if triangles cannot solve the brake
    """

    value: Response
    before: Response
    other: Response | None

    @property
    def responses_that_give_uncertainty(self) -> tuple[Response, ...]:
        """The responses whose distances from `value` give the uncertainty."""
        return (self.before,) if self.other is None else (self.before, self.other)


def solve_brake_for_reference_values(
    brake: Brake, refinement: MeshesOfReferenceValues = MESHES_OF_PUBLISHED_REFERENCE_VALUES
) -> ResponsesBehindReferenceValues:
    """Solve a brake for its reference values: on two hp meshes, and by curved triangles.

    Raises BadInput if finite elements cannot solve the brake or a shoe has a mesh file, and
    NoAnswer if the brake has no equilibrium.
    """
    for shoe in brake.shoes:
        if shoe.mesh is not None:
            raise BadInput(
                f"shoe {shoe.name!r} has a mesh file: no reference values, since both solvers "
                "divide shoes whose sides the brake file gives; drumlin solve states its errors"
            )
    solve_exactly = partial(solve_prepared_model, penalty=math.inf)
    # Coarse meshes find the ends of the contact. The two fine meshes have small elements there.
    for step in islice(
        solve_brake_on_finer_and_finer_mesh_levels(brake, solve_exactly), refinement.first
    ):
        last = step.response
    found = []
    for level in refinement.levels:
        singular_points = singular_points_of_each_shoe_shape(
            brake, last, error=level.pressure_error_due_to_column_size_ratio
        )
        last = solve_exactly(make_prepared_model(brake, level, singular_points), brake, start=last)
        found.append(last)
    before, value = found
    return ResponsesBehindReferenceValues(
        value, before, _brake_response_by_curved_triangle_elements(brake, value, refinement)
    )


def _brake_response_by_curved_triangle_elements(
    brake: Brake, like: Response, refinement: MeshesOfReferenceValues
) -> Response | None:
    """The response by the finest mesh of curved triangles, or None if they cannot solve the brake.

    Triangles cannot solve a brake on a plane surface or with some kinds of shoes. Results that the
    triangles do not give, such as whether a shoe is self-energising, are copied from `like`, the
    response by hp elements.
    """
    if not refinement.triangles or brake.surface.is_plane_and_not_drum:
        return None
    try:
        # The solver on triangles does not compute the pulls of springs. It uses the pulls that
        # `like` states, as constant forces.
        under = brake_with_springs_of_constant_pull(brake, like.spring_pulls)
        *_, solutions = triangles.solve_brake_on_sequence_of_triangle_meshes(
            under, refinement.triangles
        )
    except BadInput:
        return None
    shoes = []
    for shoe, solution, own in zip(brake.shoes, solutions, like.shoes, strict=True):
        response = response_of_pressed_elastic_shoe(
            shoe,
            brake.length_per_surface_coordinate,
            solution.theta,
            solution.pressure,
            order=solution.order,
            on_lining=_which_nodes_are_on_linings(shoe, solution.theta),
            torque=solution.torque,
            normal_force=solution.normal_force,
            self_energising=own.self_energising,
            hinge_reaction=solution.hinge_reaction,
        )
        shoes.append(response)
    return replace(like, model="triangles", shoes=tuple(shoes))


def _which_nodes_are_on_linings(shoe: Shoe, theta: Floats) -> Bools:
    """Whether the nodes at growing angles theta (n,) [rad] are on a lining, and not in a slot."""
    on_lining = np.ones(len(theta), dtype=bool)
    for start, end in shoe.lining.slots:
        # The last node on the lining before the slot and the first one behind it are on linings.
        before = int(np.abs(theta - start).argmin())
        behind = len(theta) - 1 - int(np.abs(theta[::-1] - end).argmin())
        on_lining[before + 1 : behind] = False
    return on_lining


def peak_pressure_between_edge_zones(
    response: ShoeResponse, edge: float, points: int = 2001
) -> float:
    """The largest pressure [Pa] of a shoe outside the edge zones at the ends of its linings.

    Each edge zone is `edge` [rad] long. The pressure is evaluated at `points` equidistant angles of
    each lining.
    """
    starts = [response.theta[0], *(end for _, end in response.slots)]
    ends = [*(start for start, _ in response.slots), response.theta[-1]]
    peaks = []
    for start, end in zip(starts, ends, strict=True):
        theta = np.linspace(start + edge, end - edge, points)
        peaks.append(float(response.pressure_at(theta).max()))
    return max(peaks)


@dataclass(frozen=True)
class UncertainValue:
    """A number or an array, with its absolute uncertainty in the same unit."""

    value: Any
    uncertainty: float

    @property
    def relative_uncertainty(self) -> float:
        """The uncertainty divided by the norm of the value; 0 if the uncertainty is 0."""
        size = float(np.linalg.norm(self.value))
        return self.uncertainty / size if size else math.inf if self.uncertainty else 0.0


@dataclass(frozen=True)
class ReferenceValuesOfShoe:
    """The reference values of one shoe.

    On a plane surface the angles are places x [m], and the torque is the braking force [N].

    Attributes
    ----------
    name : name of the shoe
    torque : torque of the shoe [N m]
    contact_force : force of the drum on the lining (2,) [N], friction included
    hinge_reaction : force of the hinge on the shoe (2,) [N]
    peak_pressure : largest pressure [Pa] outside the edge zones
    contact_arcs : first and last angle (k, 2) [rad] of each part of the lining in contact
    ends : angles [rad] of the lining's ends
    edge : length [rad] of the edge zone at each end of the lining
    theta : angles (n,) [rad] of the listed pressures: whole degrees, on a plane whole millimetres
    pressure : pressures (n,) [Pa] at these angles
    uncertainty : uncertainties (n,) [Pa] of these pressures
    distance : relative uncertainty of the pressure curve: the larger of its L2 distances from the
        pressures of the two other solutions, without the zones UNCOMPARED_EDGE_ZONE_IN_RADIANS at
        the lining's ends
    slots : first and last angle [rad] of each slot between two linings
    """

    name: str
    torque: UncertainValue
    contact_force: UncertainValue
    hinge_reaction: UncertainValue
    peak_pressure: UncertainValue
    contact_arcs: UncertainValue
    ends: tuple[float, float]
    edge: float
    theta: Floats
    pressure: Floats
    uncertainty: Floats
    distance: float
    slots: BeginAndEndOfEachSlot = ()

    @property
    def mask_of_angles_outside_edge_zones(self) -> Bools:
        """Whether each of the listed angles (n,) is on a lining and outside the edge zones."""
        return which_angles_are_outside_end_zones(self.theta, *self.ends, self.edge, self.slots)

    @property
    def relative_pressure_uncertainty_outside_edge_zones(self) -> float:
        """The largest uncertainty of p outside the edge zones, relative to the peak pressure."""
        peak = self.peak_pressure.value
        return (
            float(self.uncertainty[self.mask_of_angles_outside_edge_zones].max() / peak)
            if peak
            else 0.0
        )


@dataclass(frozen=True)
class ReferenceValuesOfBrake:
    """The reference values of a brake.

    Attributes
    ----------
    title : title of the brake
    text : text of the brake file
    command : shell command that computes these values again
    method : description of how the values and their uncertainties were computed
    versions : versions of the packages, by name
    torque : torque of the brake [N m], on a plane its braking force [N]
    shoes : reference values of each shoe
    surface : friction surface of the brake, a drum or a plane
    """

    title: str
    text: str
    command: str
    method: str
    versions: dict[str, str]
    torque: UncertainValue
    shoes: tuple[ReferenceValuesOfShoe, ...]
    surface: FrictionSurface = FRICTION_SURFACE_OF_DRUM

    def __repr__(self) -> str:
        """The title, the torque and the peak pressure of each shoe, with their uncertainties."""
        unit = self.surface.unit_of_torque_or_brake_force
        word = self.surface.word_for_torque_or_brake_force
        lines = [
            f"{shoe.name}: {word} {shoe.torque.value:.7g} +- {shoe.torque.uncertainty:.1g} {unit}, "
            f"peak pressure {1e-6 * shoe.peak_pressure.value:.5g} +- "
            f"{1e-6 * shoe.peak_pressure.uncertainty:.1g} MPa"
            for shoe in self.shoes
        ]
        whole = f"{word} {self.torque.value:.7g} +- {self.torque.uncertainty:.1g} {unit}"
        return "\n".join([f"{self.title}: {whole}", *lines])


def compute_reference_values(
    brake: Brake, text: str, command: str, trio: ResponsesBehindReferenceValues | None = None
) -> ReferenceValuesOfBrake:
    """Compute the reference values of a brake.

    Raises the errors of `solve_brake_for_reference_values`.

    Parameters
    ----------
    brake : the brake
    text : text of the brake file, which is stored with the values
    command : shell command that computes the values again; it is stored with the values
    trio : the three solutions of the brake (two hp meshes and triangles); if None, they are
        computed
    """
    brake.check_shoes_can_be_meshed()
    trio = trio or solve_brake_for_reference_values(brake)
    versions = {"drumlin": drumlin.__version__}
    for name in PACKAGES_WITH_VERSION_IN_REFERENCE_VALUES:
        versions[name] = importlib.metadata.version(name)
    shoes = tuple(_reference_values_of_shoe(brake, i, trio) for i in range(len(brake.shoes)))
    # The errors of the shoes may have the same sign. Therefore the uncertainties of their torques
    # are added.
    torque = UncertainValue(trio.value.torque, math.fsum(shoe.torque.uncertainty for shoe in shoes))
    method = (
        REFERENCE_METHOD_TEXT_WITHOUT_TRIANGLES
        if trio.other is None
        else REFERENCE_METHOD_TEXT_WITH_TRIANGLES
    )
    return ReferenceValuesOfBrake(
        brake.title, text, command, method, versions, torque, shoes, brake.surface
    )


def _value_with_largest_distance_as_uncertainty(values: Sequence[Any]) -> UncertainValue:
    """The first of `values`, with its largest distance from the other values as its uncertainty.

    The distance is infinite if the arrays have different shapes, for example if two solutions have
    different numbers of contact arcs.
    """
    cited, *others = (np.asarray(value, dtype=float) for value in values)
    distance = 0.0
    for other in others:
        same_shape = cited.shape == other.shape
        distance = max(distance, float(np.linalg.norm(cited - other)) if same_shape else math.inf)
    return UncertainValue(cited.tolist(), distance)


def _force_of_drum_or_plane_on_lining(brake: Brake, index: int, response: ShoeResponse) -> Floats:
    """The force (2,) [N] of the drum or the plane on the lining of the shoe number `index`."""
    shoe = brake.shoes[index]
    if not shoe.is_on_plane:
        return resultant_of_contact_on_shoe(brake, index, response).force
    # On a plane surface the contact force follows from equilibrium of the shoe: contact force,
    # hinge reaction and actuation add up to zero.
    pushed = (
        shoe if response.force is None else shoe.shoe_with_changed_actuation_force(response.force)
    )
    return -response.hinge_reaction - pushed.sum_of_forces_of_all_loads


def _reference_values_of_shoe(
    brake: Brake, index: int, trio: ResponsesBehindReferenceValues
) -> ReferenceValuesOfShoe:
    """The reference values of the shoe number `index` from the responses of the brake."""
    spec = brake.shoes[index]
    edge = length_of_edge_zone_left_out_of_peak_search(spec, brake.length_per_surface_coordinate)
    theta = _whole_degree_angles_or_millimetre_positions_on_lining(spec)
    answers = [
        response.shoes[index] for response in (trio.value, *trio.responses_that_give_uncertainty)
    ]
    cited, *others = answers
    pressure = cited.pressure_at(theta)
    differences = [np.abs(other.pressure_at(theta) - pressure) for other in others]

    def reference_quantity_of_shoe_with_uncertainty(
        quantity: Callable[[ShoeResponse], Any],
    ) -> UncertainValue:
        """A quantity of the shoe in the reference solution, with its uncertainty."""
        return _value_with_largest_distance_as_uncertainty([quantity(answer) for answer in answers])

    return ReferenceValuesOfShoe(
        name=spec.name,
        torque=reference_quantity_of_shoe_with_uncertainty(attrgetter("torque")),
        contact_force=reference_quantity_of_shoe_with_uncertainty(
            partial(_force_of_drum_or_plane_on_lining, brake, index)
        ),
        hinge_reaction=reference_quantity_of_shoe_with_uncertainty(attrgetter("hinge_reaction")),
        peak_pressure=reference_quantity_of_shoe_with_uncertainty(
            partial(peak_pressure_between_edge_zones, edge=edge)
        ),
        contact_arcs=reference_quantity_of_shoe_with_uncertainty(
            lambda answer: np.reshape(answer.contact_arcs, (-1, 2))
        ),
        ends=(spec.lining.start, spec.lining.end),
        edge=edge,
        theta=theta,
        pressure=pressure,
        uncertainty=np.max(differences, axis=0),
        distance=_largest_relative_distance_from_cited_pressure(brake, cited, others),
        slots=spec.lining.slots,
    )


def _whole_degree_angles_or_millimetre_positions_on_lining(shoe: Shoe) -> Floats:
    """The whole degrees (n,) [rad] on a lining, on a plane the whole millimetres [m]."""
    step = 1e-3 if shoe.is_on_plane else ONE_DEGREE_IN_RADIANS
    first, last = shoe.lining.start / step, shoe.lining.end / step
    return np.arange(math.ceil(first + 1e-6), last - 1e-6) * step


def _largest_relative_distance_from_cited_pressure(
    brake: Brake, cited: ShoeResponse, others: Sequence[ShoeResponse]
) -> float:
    """The largest relative L2 distance of the pressure curves `others` from the cited one.

    A shoe without any pressure has no relative distance; 0 is returned for it.
    """
    if not cited.pressure.any():
        return 0.0
    zone = length_of_uncompared_zone_at_lining_end(brake)
    return max([0.0, *(relative_distance_of_pressures(other, cited, zone) for other in others)])
