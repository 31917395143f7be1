"""A brake as linings that wear: the contact problems of `archard` that belong to a brake.

They come from the finite elements or from the foundation model, for every way in which shoes may be
held and pushed.
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
    """The lining of one shoe, with its place among the contact unknowns of a wear setup.

    Attributes
    ----------
    shoe : position of the shoe in the brake
    name : name of the shoe
    interface : position of the lining's interface in the setup
    part : place of the lining's unknowns among the unknowns of all interfaces
    local : place of the lining's unknowns among the unknowns of its interface
    theta : angles (n,) [rad] of the unknowns
    forward : slice that sorts the unknowns by growing theta
    order : degree of the interpolation between the nodes
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
        """The values (n,) of this lining by growing theta, taken from values at all unknowns."""
        return values[self.part][self.forward]

    @property
    def angles(self) -> Floats:
        """The angles theta (n,) [rad] of the lining's unknowns in growing order."""
        return self.theta[self.forward]


class WearSetup(NamedTuple):
    """A brake ready to be worn.

    Attributes
    ----------
    brake : the brake
    model : the model that its contact problems come from, "fem" or "foundation"
    interfaces : linings that bear together, each a contact problem
    surfaces : the place of each lining in the interfaces
    """

    brake: Brake
    model: str
    interfaces: tuple[WearInterface, ...]
    surfaces: tuple[WornLining, ...]

    @property
    def stiffness(self) -> float:
        """Stiffness K = E/t [Pa/m] of the first lining that touches, with E through its thickness.

        The unit of sliding distance is 1/(k K).
        """
        lining = self.brake.shoes[self.surfaces[0].shoe].lining
        return lining.material.E_through / lining.thickness


class _PlacedLining(NamedTuple):
    """A lining whose place among the unknowns is not known yet.

    Attributes
    ----------
    shoe : position of the shoe in the brake
    theta : angles (n,) [rad] of the lining's unknowns
    order : degree of the interpolation between the nodes
    """

    shoe: int
    theta: Floats
    order: int


def fem_wear_setup(scene: PreparedModel, brake: Brake, *, penalty: float = math.inf) -> WearSetup:
    """The setup of a brake on a prepared model of finite elements.

    Raises NoAnswer where no shoe touches the drum.
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
    """The linings of a group of shoes, with all their footings."""
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
    """The number of the footing and the contact set (n,) of linings worn by a depth (n,) [m].

    The first of the `ways`, a group with each of its footings, begins.
    """
    worn = replace(ways[0], brake=_brake_of_group_with_wear(ways[0], depth))
    try:
        settled, contact = worn.solve_contact()
    except NoAnswer:
        # A search without a first guess may miss an equilibrium. Softer linings lead to a guess.
        active = contact_set_from_soft_linings(worn.problem, worn.gap_mass_matrix)
        if active is None:
            raise
        settled, contact = worn.solve_contact(active)
    # The senses of friction tell which footing has been found.
    senses = list(map(attrgetter("known_friction_senses"), ways))
    return senses.index(settled.known_friction_senses), contact.active


def _brake_of_group_with_wear(group: ShoeGroup, depth: Floats) -> Brake:
    """The brake of a group with its linings worn by a depth (n,) [m] at their unknowns."""
    depths = {}
    for k, part in enumerate(group.node_ranges):
        frame = group.shoes[k].frame
        forward = slice(None, None, frame.sense)
        theta = frame.theta(group.bodies[k].line.phi)
        depths[group.members[k]] = theta[forward], depth[part][forward]
    return add_worn_depths(group.brake, depths)


def add_worn_depths(brake: Brake, depths: Mapping[int, tuple[Floats, Floats]]) -> Brake:
    """The brake with the depth worn off added to the clearance of its linings.

    `depths` holds for each worn lining, by the position of its shoe, growing angles (n,) [rad] and
    the depth (n,) [m] at these angles.
    """
    shoes = list(brake.shoes)
    for i, (theta, depth) in depths.items():
        lining = shoes[i].lining
        clearance = rows_of(theta, lining.clearance_at(theta) + depth)
        worn = lining.model_copy(update={"clearance": clearance})
        shoes[i] = shoes[i].model_copy(update={"lining": worn})
    return brake.model_copy(update={"shoes": tuple(shoes)})


def _problem_in_newtons(group: ShoeGroup) -> ContactProblem:
    """The contact problem of a group of shoes, scaled from unit forces to newtons."""
    size, problem = group.unit_force, group.problem
    return problem._replace(q=size * problem.q, h=size * problem.h)


def _allows_abutment_friction(group: ShoeGroup, contact: Contact) -> bool:
    """Whether an answer in newtons allows the friction at the abutments of a group of shoes."""
    unit = replace(contact, p=contact.p / group.unit_force, y=contact.y / group.unit_force)
    return all(group.is_foot_as_assumed(unit, k) for k in range(len(group.members)))


def foundation_wear_setup(
    brake: Brake, *, sections: int = foundation.RING_SECTIONS, lift: Iterable[str] = ()
) -> WearSetup:
    """The setup of a post brake on the foundation model.

    Parameters
    ----------
    brake : the brake
    sections : along each lining
    lift : simplifications that the model includes after all, as of foundation.solve

    Raises
    ------
    BadInput
        where the model does not apply to the brake, and for unknown simplifications
    NoAnswer
        where no shoe touches the drum
    """
    reason = foundation.why_not(brake)
    if reason is not None:
        raise BadInput(f"foundation does not apply to this brake: {reason}")
    names = foundation.included_effects(brake, lift)
    touching = [i for i, shoe in enumerate(brake.shoes) if pressing_moment(shoe) > 0]
    # Shoes influence each other through an elastic ring that each shoe's own pressure deforms.
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
        # The unknowns are normal forces of the sections.
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
    """The brake with its shoes on guides in place of hinges, pivots and abutments.

    A guide lies along the middle radius of the lining, on a plane along its normal.
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
    """The linings of an interface with their places among the unknowns.

    Parameters
    ----------
    brake : the brake
    before : linings of the earlier interfaces
    interface : position of the interface in the setup
    placed : linings of the interface, in the order of its unknowns
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
    """The wear setup of interfaces and linings. Raises NoAnswer where no shoe touches the drum."""
    if not interfaces:
        raise NoAnswer("no contact: no shoe is turned towards the drum, so that nothing wears")
    return WearSetup(brake, model, tuple(interfaces), tuple(surfaces))
