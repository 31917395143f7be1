"""Condensed bodies of shoes, coupled with the drum or the plane along their contact lines."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, Protocol

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Shoe
from drumlin.fem.substructure.body import CondensedBody
from drumlin.fem.substructure.interface import ContactLine, Coupling, radial, straight
from drumlin.fem.substructure.loads import ACTUATION, LoadColumns


class Actuated(Protocol):
    """A body that unit actuations act on, about their centre (2,) [m] in the shoe's frame."""

    @property
    def load_centre(self) -> Floats:
        """The centre of the unit actuations."""

    @property
    def columns(self) -> LoadColumns:
        """Which load column is which load."""


@dataclass(frozen=True)
class ShoeSubstructure:
    """One shoe with its lining, condensed, in its own frame (angle phi from the hinge).

    The frame is held, while the nodal forces -N^T (pressed) and T^T (dragged) and the l unit loads
    act. `columns` names the loads; those of the actuation are force x, force y and couple about
    `load_centre`. `closure_by_pressure`, `closure_by_friction` (n, n) and `closure_by_load` (n, l) are N
    times the contact displacements, by which the weighted gap closes. `load_motion_by_friction` (l, n) and
    `load_motion_by_load` (l, l) are the displacements that the unit loads work on. `held_*` (3, ...) are
    force x, y and moment that hold the frame meanwhile. The dragged ones are None where mu = 0.
    `rotation_mode` (2n,) is the contact displacement per turn [rad] about the pin.
    """

    mesh: Any
    basis: Any
    line: ContactLine
    coupling: Coupling
    condensed: CondensedBody
    load_centre: Floats
    rotation_mode: Floats
    closure_by_pressure: Floats
    closure_by_friction: Floats | None
    closure_by_load: Floats
    load_motion_by_friction: Floats | None
    load_motion_by_load: Floats
    reaction_to_pressure: Floats
    reaction_to_friction: Floats | None
    reaction_to_load: Floats

    @property
    def columns(self) -> LoadColumns:
        """Which of the load columns is which load."""
        return self.condensed.columns

    @property
    def unknowns(self) -> int:
        """Number of displacement unknowns of the mesh."""
        return int(2 * self.basis.N)

    @cached_property
    def rotation_closure(self) -> tuple[Floats, Floats]:
        """N u and T u (n, 1) of a turn by one radian."""
        return self.coupling.N @ self.rotation_mode[:, None], self.coupling.T @ self.rotation_mode[
            :, None
        ]

    @cached_property
    def forces(self) -> Floats:
        """Force x, y and moment about the centre (2, 3, n) of the nodal forces N^T and T^T."""
        (x, y), none, ones = (
            self.line.xy,
            np.zeros(self.line.xy.shape[1]),
            np.ones(self.line.xy.shape[1]),
        )
        rigid = np.array([[ones, none], [none, ones], [-y, x]]).transpose(0, 2, 1).reshape(3, -1)
        return np.array([rigid @ self.coupling.N.T, rigid @ self.coupling.T.T])


class BodyNodes(NamedTuple):
    """The nodes of a body: points `xy` (2, nodes) [m], and the force `load` (2, nodes) [1] on each
    per newton of the actuation, where this acts on the body itself; both in the shoe's frame."""

    xy: Floats
    load: Floats


def coupling_of(line: ContactLine, shoe: Shoe) -> Coupling:
    """The coupling of a shoe's contact line with the drum or the plane."""
    return line.couple(shoe.lining.width, straight if shoe.flat else radial(shoe.sign))


def coupled_shoe(
    made: Callable[..., ShoeSubstructure],
    shoe: Shoe,
    line: ContactLine,
    condensed: CondensedBody,
    centre: Floats,
    *,
    friction: bool,
) -> ShoeSubstructure:
    """The condensed body of a shoe, coupled with the drum along its contact line; `made` takes the
    rest of a Body.
    """
    n = len(line.nodes)
    coupling = coupling_of(line, shoe)
    forces = [-coupling.N.T, condensed.load_on_contact] + ([coupling.T.T] if friction else [])
    Y = condensed.half(np.concatenate(forces, axis=1))
    closing, holding = -Y[:, :n].T @ Y, condensed.L_fc @ Y
    beyond = n + condensed.columns.count
    pressed, loaded, dragged = slice(n), slice(n, beyond), slice(beyond, None)
    x, y = line.xy - shoe.own_pin[:, None]
    return made(
        coupling=coupling,
        condensed=condensed,
        load_centre=centre,
        rotation_mode=np.array([-y, x]).T.ravel(),
        closure_by_pressure=closing[:, pressed],
        closure_by_load=closing[:, loaded],
        closure_by_friction=closing[:, dragged] if friction else None,
        load_motion_by_friction=Y[:, loaded].T @ Y[:, dragged] if friction else None,
        load_motion_by_load=Y[:, loaded].T @ Y[:, loaded] + condensed.load_work,
        reaction_to_pressure=holding[:, pressed],
        reaction_to_load=holding[:, loaded] - condensed.load_on_frame,
        reaction_to_friction=holding[:, dragged] if friction else None,
    )


def actuation(body: Actuated, shoe: Shoe) -> tuple[Floats, float]:
    """Factors (l,) of all load columns of the body under its actuation, and the moment about the
    pin [m], per newton of force.

    In the shoe's frame; a negative force counts as one newton the other way. Columns of other loads
    than the actuation have the factor zero.
    """
    own, moment = load_on(body.load_centre, shoe)
    return body.columns.factors({ACTUATION: own}), moment


def load_on(centre: Floats, shoe: Shoe) -> tuple[Floats, float]:
    """Factors (3,) of force x, y and couple about a `centre` (2,) [m] in the shoe's frame, and the
    moment about the pin [m], per newton of the actuation.
    """
    direction = math.copysign(1.0, shoe.actuation.force) * shoe.actuation.direction_vector
    (fx, fy), (x, y) = (
        shoe.frame.to_shoe(direction).tolist(),
        shoe.own_points(shoe.actuation.point.xy).tolist(),
    )
    (centre_x, centre_y), (pin_x, pin_y) = centre.tolist(), shoe.own_pin.tolist()
    couple_ = (x - centre_x) * fy - (y - centre_y) * fx
    return np.array([fx, fy, couple_]), (x - pin_x) * fy - (y - pin_y) * fx


def held(body: ShoeSubstructure, p: Floats, drag: float, load: Floats) -> Floats:
    """Force x, y and moment about the pin (3,) that hold the frame, under p (n,), drag mu s and
    factors
    load (l,) of the load columns.
    """
    forces = body.reaction_to_pressure @ p + body.reaction_to_load @ load
    return (
        forces
        if body.reaction_to_friction is None
        else forces + drag * (body.reaction_to_friction @ p)
    )


def contact_stiffness(shoe: Shoe, penalty: float) -> float:
    """eps = penalty E/t of the lining, the contact's stiffness per area [Pa/m]; E through its
    thickness."""
    return penalty * shoe.lining.material.E_through / shoe.lining.thickness
