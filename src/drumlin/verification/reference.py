"""Reference values of a brake that others can cite, and how far somebody's p(theta) is from them.

The value comes from columns of high degree on the finer of two divisions, with exact contact. Its
uncertainty is the larger of two distances: from the other division, of another degree and grading,
and from curved triangles, which share nothing with it but the brake.
"""

import importlib.metadata
import math
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

import drumlin
from drumlin.base.arrays import Bools, Floats
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake
from drumlin.brake.surface import DRUM, FrictionSurface
from drumlin.comparison import edge_of
from drumlin.fem.error_control.levels import steps
from drumlin.fem.error_control.places import places_of
from drumlin.fem.hp.division import Level
from drumlin.fem.model import respond
from drumlin.fem.preparation.prepare import prepare
from drumlin.response.balance import contact_resultant
from drumlin.response.norms import pressure_distance
from drumlin.response.response import Response, ShoeResponse, edge_zone, pressed_shoe
from drumlin.verification import triangles

PACKAGES = ("numpy", "scipy", "scikit-fem")
METHOD = (
    "2D plane stress, unilateral contact, full-slip Coulomb friction, exact contact; value: "
    "columns of elements of "
    "high degree; uncertainty: the larger of the distances from another division of them and "
    "from curved triangles "
    "with contact node by node"
)
ALONE = (
    "2D plane stress, unilateral contact, full-slip Coulomb friction, exact contact; value: "
    "columns of elements of "
    "high degree; uncertainty: the distance from another division of them"
)


class Refinement(NamedTuple):
    """How finely a reference is solved: two divisions into columns, the second one cited, after
    `first` levels that find the ends of the contact; the meshes of triangles, where there are any.
    """

    first: int
    levels: tuple[Level, Level]
    triangles: tuple[triangles.TriangleLevel, ...]


ONE_DEGREE = math.pi / 180
FINE = Refinement(
    3,
    (
        Level(7, 0.02, 0.01, 0.002, 0.45, 0.45, 15 * ONE_DEGREE, 0.01, 0.01, 0.3),
        Level(8, 0.01, 0.006, 0.001, 0.5, 0.5, 15 * ONE_DEGREE, 0.003, 0.01, 0.4),
    ),
    triangles.TRIANGLE_LEVELS,
)
"""Sizes that grow slowly towards the ends of the layers and the hinge, where the torque feels them;
thinner columns at the lining's ends would cost a stiff shoe more digits than they bring.
"""


class Trio(NamedTuple):
    """The responses of a reference: `value` is cited, `before` on the other division, `other` by
    triangles, None where these do not cover the brake.
    """

    value: Response
    before: Response
    other: Response | None

    @property
    def others(self) -> tuple[Response, ...]:
        """Those whose distances are the uncertainty."""
        return (self.before,) if self.other is None else (self.before, self.other)


def responses(brake: Brake, refinement: Refinement = FINE) -> Trio:
    """The fine responses of a brake. Raises BadInput where finite elements do not apply or a mesh
    is given by a file, NoAnswer where there is no equilibrium.
    """
    for shoe in brake.shoes:
        if shoe.mesh is not None:
            raise BadInput(
                f"shoe {shoe.name!r} has a mesh file, which is not refined: no reference values"
            )
    respond_ = partial(respond, penalty=math.inf)
    *_, last = islice((step.response for step in steps(brake, respond_)), refinement.first)
    found = []
    for level in refinement.levels:
        last = respond_(
            prepare(brake, level, places_of(brake, last, error=level.error)), brake, start=last
        )
        found.append(last)
    before, value = found
    return Trio(value, before, _by_triangles(brake, value, refinement))


def _by_triangles(brake: Brake, like: Response, refinement: Refinement) -> Response | None:
    """The finest solution by triangles in the form of `like`; None where they do not cover the
    brake, as on a plane.
    """
    if not refinement.triangles or brake.surface.straight:
        return None
    try:
        *_, solutions = triangles.sequence(brake, refinement.triangles)
    except BadInput:
        return None
    shoes = [
        pressed_shoe(
            shoe,
            brake.scale_factor,
            found.theta,
            found.pressure,
            order=found.order,
            torque=found.torque,
            normal_force=found.normal_force,
            self_energising=own.self_energising,
            hinge_reaction=found.hinge_reaction,
        )
        for shoe, found, own in zip(brake.shoes, solutions, like.shoes, strict=True)
    ]
    return replace(like, model="triangles", shoes=tuple(shoes))


def peak_away(response: ShoeResponse, edge: float, points: int = 2001) -> float:
    """Largest pressure [Pa] outside zones of `edge` [rad] at the lining's ends, at evenly spread
    angles.
    """
    start, end = response.theta[0] + edge, response.theta[-1] - edge
    return float(response.pressure_at(np.linspace(start, end, points)).max())


@dataclass(frozen=True)
class Sure:
    """A value, a number or an array, with its absolute uncertainty."""

    value: Any
    uncertainty: float

    @property
    def relative(self) -> float:
        """The uncertainty over the value's size; 0 where the uncertainty is."""
        size = float(np.linalg.norm(self.value))
        return self.uncertainty / size if size else math.inf if self.uncertainty else 0.0


@dataclass(frozen=True)
class ShoeReference:
    """What is known of one shoe.

    `contact_force` (2,) [N]: of the drum on the lining, friction included. `peak_pressure` [Pa]:
    outside the zones of `edge` [rad] at the lining's ends. `contact_arcs` (k, 2) [rad]. `theta`
    (n,) [rad], whole degrees; on a plane x [m] in place of angles, whole millimetres, and the
    braking force [N] in place of the torque. `pressure` and `uncertainty` (n,) [Pa]. `distance`:
    relative L2 distance of both pressures outside EDGE_ZONE at the ends.
    """

    name: str
    torque: Sure
    contact_force: Sure
    hinge_reaction: Sure
    peak_pressure: Sure
    contact_arcs: Sure
    ends: tuple[float, float]
    edge: float
    theta: Floats
    pressure: Floats
    uncertainty: Floats
    distance: float

    @property
    def inside(self) -> Bools:
        """Which angles are not in the edge zones."""
        return np.asarray(
            (self.theta > self.ends[0] + self.edge) & (self.theta < self.ends[1] - self.edge)
        )

    @property
    def pressure_uncertainty(self) -> float:
        """The largest uncertainty of p outside the edge zones, over the peak pressure."""
        peak = self.peak_pressure.value
        return float(self.uncertainty[self.inside].max() / peak) if peak else 0.0


@dataclass(frozen=True)
class Reference:
    """Reference values of a brake: `text` is its file, `command` makes them again.

    `surface`: on a plane the braking force [N] stands for torques, and places x [m] for angles.
    """

    title: str
    text: str
    command: str
    method: str
    versions: dict[str, str]
    torque: Sure
    shoes: tuple[ShoeReference, ...]
    surface: FrictionSurface = DRUM


def reference(brake: Brake, text: str, command: str, trio: Trio | None = None) -> Reference:
    """The reference values of a brake; `trio`: its fine responses, already there. Raises as
    responses.
    """
    brake.check_meshable()
    trio = trio or responses(brake)
    versions = {
        "drumlin": drumlin.__version__,
        **{name: importlib.metadata.version(name) for name in PACKAGES},
    }
    shoes = tuple(_shoe(brake, i, trio) for i in range(len(brake.shoes)))
    torque = Sure(
        trio.value.torque, math.fsum(shoe.torque.uncertainty for shoe in shoes)
    )  # shoes do not cancel
    method = ALONE if trio.other is None else METHOD
    return Reference(brake.title, text, command, method, versions, torque, shoes, brake.surface)


def _sure(value: Any, *others: Any) -> Sure:
    """A value whose uncertainty is its distance from the farthest of others; of arrays of another
    shape: infinite.
    """
    value = np.asarray(value, dtype=float)
    apart = 0.0
    for other in others:
        off = np.asarray(other, dtype=float)
        apart = max(
            apart, float(np.linalg.norm(value - off)) if value.shape == off.shape else math.inf
        )
    return Sure(value.tolist(), apart)


def _contact_force(brake: Brake, index: int, found: ShoeResponse) -> Floats:
    """Force (2,) [N] on the lining; on a plane the rest of reaction and actuation."""
    shoe = brake.shoes[index]
    if not shoe.flat:
        return contact_resultant(brake, index, found).force
    return (
        -found.hinge_reaction
        - (shoe if found.force is None else shoe.under(found.force)).actuation.vector
    )


def _shoe(brake: Brake, index: int, trio: Trio) -> ShoeReference:
    spec = brake.shoes[index]
    own = [response.shoes[index] for response in (trio.value, *trio.others)]
    a = own[0]
    edge = edge_zone(spec, brake.scale_factor)
    first, last = spec.lining.start, spec.lining.end
    step = 1e-3 if spec.flat else ONE_DEGREE  # whole millimetres, whole degrees
    theta = np.arange(math.ceil(first / step + 1e-6), last / step - 1e-6) * step
    pressure = a.pressure_at(theta)
    return ShoeReference(
        name=spec.name,
        torque=_sure(*(x.torque for x in own)),
        contact_force=_sure(*(_contact_force(brake, index, x) for x in own)),
        hinge_reaction=_sure(*(x.hinge_reaction for x in own)),
        peak_pressure=_sure(*(peak_away(x, edge) for x in own)),
        contact_arcs=_sure(*(np.reshape(x.contact_arcs, (-1, 2)) for x in own)),
        ends=(first, last),
        edge=edge,
        theta=theta,
        pressure=pressure,
        uncertainty=np.max([np.abs(x.pressure_at(theta) - pressure) for x in own[1:]], axis=0),
        distance=max(pressure_distance(x, a, edge_of(brake)) for x in own[1:])
        if a.pressure.any()
        else 0.0,
    )
