"""Condensed bodies of shoes, coupled with the drum or the plane along their contact lines."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple, Protocol

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Shoe
from drumlin.fem.mesh.from_file import ShoeMesh
from drumlin.fem.substructure.body import Condensed
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
class Body:
    """One shoe with its lining, condensed, in its own frame (angle phi from the hinge).

    The frame is held, while the nodal forces -N^T (pressed) and T^T (dragged) and the l unit loads
    act. `columns` names the loads; those of the actuation are force x, force y and couple about
    `load_centre`. `closing_pressed`, `closing_dragged` (n, n) and `closing_loaded` (n, l) are N
    times the contact displacements, by which the weighted gap closes. `tip_dragged` (l, n) and
    `tip_loaded` (l, l) are the displacements that the unit loads work on. `held_*` (3, ...) are
    force x, y and moment that hold the frame meanwhile. The dragged ones are None where mu = 0.
    `turned` (2n,) is the contact displacement per turn [rad] about the pin. `of_file`: what was done
    to the mesh of a file.
    """

    mesh: Any
    basis: Any
    line: ContactLine
    coupling: Coupling
    condensed: Condensed
    load_centre: Floats
    turned: Floats
    closing_pressed: Floats
    closing_dragged: Floats | None
    closing_loaded: Floats
    tip_dragged: Floats | None
    tip_loaded: Floats
    held_pressed: Floats
    held_dragged: Floats | None
    held_loaded: Floats
    of_file: ShoeMesh | None = field(default=None, kw_only=True)

    @property
    def columns(self) -> LoadColumns:
        """Which of the load columns is which load."""
        return self.condensed.columns

    @property
    def unknowns(self) -> int:
        """Number of displacement unknowns of the mesh."""
        return int(2 * self.basis.N)

    @cached_property
    def turning(self) -> tuple[Floats, Floats]:
        """N u and T u (n, 1) of a turn by one radian."""
        return self.coupling.N @ self.turned[:, None], self.coupling.T @ self.turned[:, None]

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


def coupled(
    made: Callable[..., Body],
    shoe: Shoe,
    line: ContactLine,
    condensed: Condensed,
    centre: Floats,
    *,
    friction: bool,
) -> Body:
    """The condensed body of a shoe, coupled with the drum along its contact line; `made` takes the
    rest of a Body.
    """
    n = len(line.nodes)
    coupling = coupling_of(line, shoe)
    forces = [-coupling.N.T, condensed.load_c] + ([coupling.T.T] if friction else [])
    Y = condensed.half(np.concatenate(forces, axis=1))
    closing, holding = -Y[:, :n].T @ Y, condensed.L_fc @ Y
    beyond = n + condensed.columns.count
    pressed, loaded, dragged = slice(n), slice(n, beyond), slice(beyond, None)
    x, y = line.xy - shoe.own_pin[:, None]
    return made(
        coupling=coupling,
        condensed=condensed,
        load_centre=centre,
        turned=np.array([-y, x]).T.ravel(),
        closing_pressed=closing[:, pressed],
        closing_loaded=closing[:, loaded],
        closing_dragged=closing[:, dragged] if friction else None,
        tip_dragged=Y[:, loaded].T @ Y[:, dragged] if friction else None,
        tip_loaded=Y[:, loaded].T @ Y[:, loaded] + condensed.load_work,
        held_pressed=holding[:, pressed],
        held_loaded=holding[:, loaded] - condensed.load_f,
        held_dragged=holding[:, dragged] if friction else None,
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


def held(body: Body, p: Floats, drag: float, load: Floats) -> Floats:
    """Force x, y and moment about the pin (3,) that hold the frame, under p (n,), drag mu s and
    factors
    load (l,) of the load columns.
    """
    forces = body.held_pressed @ p + body.held_loaded @ load
    return forces if body.held_dragged is None else forces + drag * (body.held_dragged @ p)


def contact_stiffness(shoe: Shoe, penalty: float) -> float:
    """eps = penalty E/t of the lining, the contact's stiffness per area [Pa/m]; E through its
    thickness."""
    return penalty * shoe.lining.material.E_through / shoe.lining.thickness
