"""Make the contact problems of worn linings from a brake, for the wear steps of `archard`.

The contact problems come from finite elements or from the foundation model. All supports and
actuations of shoes are allowed.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from operator import attrgetter
from typing import NamedTuple, TypeVar

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.fields import rows_of
from drumlin.brake.file import vary
from drumlin.contact.active_set import Contact
from drumlin.contact.equations import ContactProblem
from drumlin.fem.equilibrium.group import ShoeGroup, divide_pressed_shoes_into_groups
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.foundation import model as foundation
from drumlin.foundation.post import shoe_angles
from drumlin.laws.hinged import pressing_moment
from drumlin.lining_wear.archard import Footing, WearInterface, contact_set_from_soft_linings

AnyBrake = TypeVar("AnyBrake", bound=Brake)


class WornLining(NamedTuple):
    """The lining of one shoe, and the place of its contact unknowns in a wear setup.

    An interface is a group of linings with one contact problem. The setup of a brake has one or
    more interfaces.

    Attributes
    ----------
    shoe : position of the shoe in the brake
    name : name of the shoe
    interface : position of the lining's interface in the setup
    part : slice of the lining's unknowns in the unknowns of all interfaces
    local : slice of the lining's unknowns in the unknowns of its interface
    theta : (n,) [rad], angles of the lining's unknowns
    forward : slice that puts the unknowns in the order of growing theta
    order : degree of the interpolation of pressure and depth between the nodes
    """

    shoe: int
    name: str
    interface: int
    part: slice
    local: slice
    theta: Floats
    forward: slice
    order: int

    def along(self, values: Floats) -> Floats:
        """The values (n,) of this lining in the order of growing theta.

        `values` holds those of all unknowns of the setup.
        """
        return values[self.part][self.forward]

    @property
    def angles(self) -> Floats:
        """The angles theta (n,) [rad] of the lining's contact unknowns in growing order."""
        return self.theta[self.forward]


class WearSetup(NamedTuple):
    """A brake with the contact problems of its linings, ready for steps of wear.

    Attributes
    ----------
    brake : the brake
    model : name of the model that the contact problems come from, "fem" or "foundation"
    interfaces : groups of coupled linings; each group is one contact problem
    surfaces : each lining with the place of its contact unknowns in the interfaces
    """

    brake: Brake
    model: str
    interfaces: tuple[WearInterface, ...]
    surfaces: tuple[WornLining, ...]

    @property
    def stiffness(self) -> float:
        """The stiffness K = E/t [Pa/m] of the first lining in contact: pressure per compression.

        E is the modulus through the lining's thickness t. With the wear coefficient k, 1/(k K) is
        the sliding distance over which wear changes the pressure by a factor e.
        """
        lining = self.brake.shoes[self.surfaces[0].shoe].lining
        return lining.material.E_through / lining.thickness


class _PlacedLining(NamedTuple):
    """A lining before the place of its contact unknowns in the wear setup is known.

    Attributes
    ----------
    shoe : position of the shoe in the brake
    theta : (n,) [rad], angles of the lining's contact unknowns
    order : degree of the interpolation of pressure and depth between the nodes
    """

    shoe: int
    theta: Floats
    order: int


def fem_wear_setup(scene: PreparedModel, brake: Brake, *, penalty: float = math.inf) -> WearSetup:
    """The wear setup of a brake from its finite elements.

    Parameters
    ----------
    scene : prepared finite elements of the brake
    brake : the brake
    penalty : factor alpha of the contact stiffness alpha E/t per area; inf for a rigid contact

    Raises
    ------
    NoAnswer
        if no shoe touches the drum
    """
    interfaces: list[WearInterface] = []
    surfaces: list[WornLining] = []
    for group in divide_pressed_shoes_into_groups(scene, brake, penalty):
        placed = []
        for i, body, shoe in zip(group.members, group.bodies, group.shoes, strict=True):
            theta = shoe.frame.theta(body.line.phi)
            placed.append(_PlacedLining(i, theta, body.line.order))
        surfaces += _worn_linings_of_interface(brake, surfaces, len(interfaces), placed)
        interfaces.append(_wear_interface_of_group(group))
    return _make_wear_setup(brake, "fem", interfaces, surfaces)


def _wear_interface_of_group(group: ShoeGroup) -> WearInterface:
    """The contact problem of a group of coupled shoes, for steps of wear.

    It has a footing for each way in which friction may act at the abutments of the shoes.
    """
    first, *others = group.groups_with_each_choice_of_senses()
    couplings = list(map(attrgetter("coupling"), group.bodies))
    gap = np.concatenate(group.initial_gaps)
    problem = _problem_in_newtons(first)
    return WearInterface(
        problem=problem,
        loaded=problem.q - group.gap_mass_matrix @ gap,
        weight=group.gap_mass_matrix,
        pressure=np.ones(len(gap)),
        area=np.concatenate(list(map(attrgetter("area"), couplings))),
        torque=group.brake.friction * np.concatenate(list(map(attrgetter("lever"), couplings))),
        stands=partial(_allows_abutment_friction, first),
        others=tuple(
            Footing(_problem_in_newtons(way), partial(_allows_abutment_friction, way))
            for way in others
        ),
        settle=partial(_settle_worn_linings, (first, *others)),
    )


def _settle_worn_linings(ways: Sequence[ShoeGroup], depth: Floats) -> tuple[int, Bools]:
    """Solve the contact of worn linings without a first guess.

    Returns the number of the footing, the way in which friction acts at the abutments, and the mask
    (n,) of the unknowns in contact.

    Parameters
    ----------
    ways : the group of shoes with each of its footings; the search starts from the first
    depth : worn depth (n,) [m] at the contact unknowns

    Raises
    ------
    NoAnswer
        if the worn linings have no equilibrium
    """
    worn = replace(ways[0], brake=_brake_of_group_with_wear(ways[0], depth))
    try:
        settled, contact = worn.solve_contact()
    except NoAnswer:
        # A search without a first guess may miss an equilibrium. The contact of ever stiffer
        # linings, from very soft ones on, gives a first guess.
        active = contact_set_from_soft_linings(worn.problem, worn.gap_mass_matrix)
        if active is None:
            raise
        settled, contact = worn.solve_contact(active)
    # The senses of the friction at the abutments tell to which of the `ways` the solution belongs.
    senses = list(map(attrgetter("known_friction_senses"), ways))
    return senses.index(settled.known_friction_senses), contact.active


def _brake_of_group_with_wear(group: ShoeGroup, depth: Floats) -> Brake:
    """The brake of a group of shoes with the linings of the group worn.

    `depth` (n,) [m] is the worn depth at the contact unknowns of the group.
    """
    depths = {}
    for k, part in enumerate(group.node_ranges):
        frame = group.shoes[k].frame
        forward = slice(None, None, frame.sense)
        theta = frame.theta(group.bodies[k].line.phi)
        depths[group.members[k]] = theta[forward], depth[part][forward]
    return add_worn_depths(group.brake, depths)


def add_worn_depths(brake: Brake, depths: Mapping[int, tuple[Floats, Floats]]) -> Brake:
    """The brake with worn linings: the worn depth is added to the clearance of each lining.

    `depths` holds for each worn lining, by the position of its shoe in the brake, growing angles
    (n,) [rad] and the worn depth (n,) [m] at these angles.
    """
    shoes = list(brake.shoes)
    for i, (theta, depth) in depths.items():
        lining = shoes[i].lining
        clearance = rows_of(theta, lining.clearance_at(theta) + depth)
        worn = lining.model_copy(update={"clearance": clearance})
        shoes[i] = shoes[i].model_copy(update={"lining": worn})
    return brake.model_copy(update={"shoes": tuple(shoes)})


def _problem_in_newtons(group: ShoeGroup) -> ContactProblem:
    """The contact problem of a group of shoes in newtons, in place of the group's unit of force."""
    size, problem = group.unit_force, group.problem
    return problem._replace(q=size * problem.q, h=size * problem.h)


def _allows_abutment_friction(group: ShoeGroup, contact: Contact) -> bool:
    """Whether a solution in newtons agrees with the friction at the abutments of a group of shoes.

    The friction agrees if it opposes the slide of each foot, or holds the foot.
    """
    unit = replace(contact, p=contact.p / group.unit_force, y=contact.y / group.unit_force)
    return all(group.is_foot_as_assumed(unit, k) for k in range(len(group.members)))


def foundation_wear_setup(
    brake: Brake, *, sections: int = foundation.RING_SECTIONS, lift: Iterable[str] = ()
) -> WearSetup:
    """The wear setup of a post brake from the foundation model.

    Parameters
    ----------
    brake : the brake
    sections : number of divisions of each shoe's beam
    lift : names in `foundation.LIFTS` of the effects that the model includes

    Raises
    ------
    BadInput
        if the model does not apply to the brake, and for an unknown name in `lift`
    NoAnswer
        if no shoe touches the drum
    """
    reason = foundation.why_not(brake)
    if reason is not None:
        raise BadInput(f"foundation does not apply to this brake: {reason}")
    names = foundation.included_effects(brake, lift)
    touching = [i for i, shoe in enumerate(brake.shoes) if pressing_moment(shoe) > 0]
    # Shoes influence each other only if the own pressure of each shoe loads an elastic ring.
    meet = brake.ring is not None and "own-pressure" in names
    groups = [touching] if meet and touching else [[i] for i in touching]
    interfaces: list[WearInterface] = []
    surfaces: list[WornLining] = []
    for group in groups:
        system = foundation.system(brake, group, sections, names)
        areas, gaps, placed = [], [], []
        for i, post in zip(group, system.posts, strict=True):
            shoe = brake.shoes[i]
            gaps.append(post.gap)
            areas.append(shoe.lining.width * brake.size * post.sector)
            placed.append(_PlacedLining(i, shoe_angles(post.axis, shoe, post.theta), 1))
        surfaces += _worn_linings_of_interface(brake, surfaces, len(interfaces), placed)
        area = np.concatenate(areas)
        # The contact unknowns are the normal forces [N] on the sectors of the linings.
        interfaces.append(
            WearInterface(
                problem=system.problem,
                loaded=system.problem.q - np.concatenate(gaps),
                weight=np.eye(len(area)),
                pressure=1 / area,
                area=area,
                torque=brake.friction * brake.size * area,
            )
        )
    return _make_wear_setup(brake, "foundation", interfaces, surfaces)


def put_shoes_on_guides(brake: AnyBrake) -> AnyBrake:
    """The brake with each shoe on a guide in place of its hinge, pivot or abutment.

    The guide lies along the middle radius of the lining, or on a plane along the plane's normal.
    """
    changes: dict[str, object] = {}
    for i, shoe in enumerate(brake.shoes):
        for key in ("hinge", "pivot", "abutment"):
            changes[f"shoe[{i}].{key}"] = None
        changes[f"shoe[{i}].guide"] = {"direction": shoe.closing}
    return vary(brake, changes)


def _worn_linings_of_interface(
    brake: Brake, before: Sequence[WornLining], interface: int, placed: Sequence[_PlacedLining]
) -> list[WornLining]:
    """The linings of one group with the places of their contact unknowns in the wear setup.

    Parameters
    ----------
    brake : the brake
    before : linings of the earlier groups
    interface : position of the group in the setup
    placed : linings of the group, in the order of its contact unknowns
    """
    offset = sum(len(surface.theta) for surface in before)
    first = 0
    surfaces = []
    for i, theta, order in placed:
        n = len(theta)
        surfaces.append(
            WornLining(
                shoe=i,
                name=brake.shoes[i].name,
                interface=interface,
                part=slice(offset + first, offset + first + n),
                local=slice(first, first + n),
                theta=theta,
                forward=slice(None, None, 1 if theta[-1] > theta[0] else -1),
                order=order,
            )
        )
        first += n
    return surfaces


def _make_wear_setup(
    brake: Brake, model: str, interfaces: list[WearInterface], surfaces: list[WornLining]
) -> WearSetup:
    """The wear setup from groups of linings. Raises NoAnswer if no shoe touches the drum.

    Parameters
    ----------
    brake : the brake
    model : name of the model, "fem" or "foundation"
    interfaces : groups of coupled linings; each group is one contact problem
    surfaces : each lining with the place of its contact unknowns
    """
    if not interfaces:
        raise NoAnswer("no contact: no shoe is turned towards the drum, so that nothing wears")
    return WearSetup(brake, model, tuple(interfaces), tuple(surfaces))
