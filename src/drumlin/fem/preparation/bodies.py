"""Condensed bodies of shoes, coupled with the drum or the plane along their contact lines."""

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple, Protocol

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Shoe
from drumlin.fem.mesh.from_file import ShoeMesh
from drumlin.fem.substructure.body import CondensedBody
from drumlin.fem.substructure.interface import (
    ContactLine,
    Coupling,
    drum_directions,
    plane_directions,
)
from drumlin.fem.substructure.loads import ACTUATION, LoadColumns


class ActuatedBody(Protocol):
    """A body that unit actuations act on, about their centre (2,) [m] in the shoe's frame."""

    @property
    def load_centre(self) -> Floats:
        """The centre of the unit actuations."""

    @property
    def columns(self) -> LoadColumns:
        """The load columns of the body, by name."""


@dataclass(frozen=True)
class ShoeSubstructure:
    """One shoe with its lining as a substructure, in its own frame (angle phi from the hinge).

    The flexibility is that of the body whose frame is held. Three kinds of forces act on the body:
    the nodal forces -N^T of the pressure at the n contact nodes, the nodal forces T^T of its
    friction, and the l unit loads. An array about friction is None in a brake with mu = 0.

    Attributes
    ----------
    mesh, basis : the division of the body and its nodes
    line : the contact line
    coupling : the matrices that couple contact line and counterface
    condensed : the statically condensed body
    load_centre : (2,) point that the unit actuations (force x, force y, couple) act about [m]
    rotation_mode : (2n,) contact displacement per radian of a rotation about the pin [m]
    closure_by_pressure, closure_by_friction : (n, n) compliance blocks, N times the contact
        displacement, by which the weighted gap closes
    closure_by_load : (n, l) the same due to the unit loads
    load_motion_by_friction : (l, n) displacements of the unit loads' points due to friction
    load_motion_by_load : (l, l) the same due to the unit loads
    reaction_to_pressure, reaction_to_friction : (3, n) force x, force y and moment that hold the
        frame
    reaction_to_load : (3, l) the same due to the unit loads
    of_file : what was done to the mesh of a file
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
    of_file: ShoeMesh | None = field(default=None, kw_only=True)

    @property
    def columns(self) -> LoadColumns:
        """The load columns of the body, by name."""
        return self.condensed.columns

    @property
    def unknowns(self) -> int:
        """Number of degrees of freedom of the mesh."""
        return int(2 * self.basis.N)

    @cached_property
    def gap_closure_by_rotation(self) -> tuple[Floats, Floats]:
        """Weighted closure N u and slip T u (n, 1) due to a rotation of one radian about the pin.

        They are given per radian [m^3].
        """
        mode = self.rotation_mode[:, None]
        return self.coupling.N @ mode, self.coupling.T @ mode

    @cached_property
    def forces(self) -> Floats:
        """Force x, y and moment about the centre (2, 3, n) of the nodal forces N^T and T^T."""
        x, y = self.line.xy
        count = self.line.xy.shape[1]
        zeros = np.zeros(count)
        ones = np.ones(count)
        # The rigid-body modes of the contact nodes: their work is the resultant of nodal forces.
        modes = np.array([[ones, zeros], [zeros, ones], [-y, x]])
        modes = modes.transpose(0, 2, 1).reshape(3, -1)
        return np.array([modes @ self.coupling.N.T, modes @ self.coupling.T.T])


class DividedBody(NamedTuple):
    """The division of a shoe's body, as a `ShoeSubstructure` keeps it.

    `mesh` and `basis` are the division and its nodes, `line` is the contact line, and `of_file`
    tells what was done to the mesh of a file.
    """

    mesh: Any
    basis: Any
    line: ContactLine
    of_file: ShoeMesh | None = None


class BodyNodes(NamedTuple):
    """The nodes of a body and the actuation on them, in the shoe's frame.

    `xy` (2, nodes) [m] are their points. `load` (2, nodes) [1] is the force on each node per newton
    of an actuation that acts on the body itself, and zero where the actuation acts on the frame.
    """

    xy: Floats
    load: Floats


def couple_contact_line(line: ContactLine, shoe: Shoe) -> Coupling:
    """The coupling of a shoe's contact line with the drum or the plane."""
    directions = plane_directions if shoe.flat else drum_directions(shoe.sign)
    return line.couple_with_counterface(shoe.lining.width, directions)


def make_shoe_substructure(
    kind: type[ShoeSubstructure],
    shoe: Shoe,
    division: DividedBody,
    condensed: CondensedBody,
    centre: Floats,
    *,
    friction: bool,
) -> ShoeSubstructure:
    """The substructure of a shoe: its condensed body, coupled along the contact line.

    Parameters
    ----------
    kind : class of the substructure
    shoe : the shoe
    division : the division of its body
    condensed : its condensed body
    centre : (2,) centre of the unit actuations [m]
    friction : whether the brake has friction
    """
    line = division.line
    n = len(line.nodes)
    coupling = couple_contact_line(line, shoe)
    forces = [-coupling.N.T, condensed.load_on_contact]
    if friction:
        forces.append(coupling.T.T)

    # The columns of Y and of the blocks made from it: pressure, unit loads, friction.
    Y = condensed.half_flexibility(np.concatenate(forces, axis=1))
    first_friction = n + condensed.columns.count
    pressed, loaded, dragged = slice(n), slice(n, first_friction), slice(first_friction, None)
    closure = -Y[:, :n].T @ Y
    reaction = condensed.L_fc @ Y

    x, y = line.xy - shoe.own_pin[:, None]
    return kind(
        mesh=division.mesh,
        basis=division.basis,
        line=line,
        coupling=coupling,
        condensed=condensed,
        load_centre=centre,
        rotation_mode=np.array([-y, x]).T.ravel(),
        closure_by_pressure=closure[:, pressed],
        closure_by_load=closure[:, loaded],
        closure_by_friction=closure[:, dragged] if friction else None,
        load_motion_by_friction=Y[:, loaded].T @ Y[:, dragged] if friction else None,
        load_motion_by_load=Y[:, loaded].T @ Y[:, loaded] + condensed.load_work,
        reaction_to_pressure=reaction[:, pressed],
        reaction_to_load=reaction[:, loaded] - condensed.load_on_frame,
        reaction_to_friction=reaction[:, dragged] if friction else None,
        of_file=division.of_file,
    )


def acting_loads(body: ActuatedBody, shoe: Shoe, force: float) -> Floats:
    """Factors (l,) of all load columns of a body while its actuation has this `force` [N].

    Contact, reactions, fields and refinement take the loads of a shoe from here. A load that does
    not depend on the force, such as heat, adds its own factor under its own name.
    """
    factors, _ = actuation_load_factors(body, shoe)
    return abs(force) * factors


def actuation_load_factors(body: ActuatedBody, shoe: Shoe) -> tuple[Floats, float]:
    """Factors (l,) of the body's load columns under its actuation, and the moment about the pin.

    Both are given per newton of force, the moment in metres, in the shoe's frame. A negative force
    counts as one newton in the opposite direction. Columns of other loads have the factor zero.
    """
    own, moment = actuation_about_centre(body.load_centre, shoe)
    return body.columns.factors({ACTUATION: own}), moment


def actuation_about_centre(centre: Floats, shoe: Shoe) -> tuple[Floats, float]:
    """Factors (3,) of force x, force y and couple of a shoe's actuation, and its moment.

    The couple acts about the `centre` (2,) [m] in the shoe's frame, the moment [m] about the pin.
    Both are given per newton of the actuation.
    """
    direction = math.copysign(1.0, shoe.actuation.force) * shoe.actuation.direction_vector
    fx, fy = shoe.frame.to_shoe(direction).tolist()
    x, y = shoe.own_points(shoe.actuation.point.xy).tolist()
    centre_x, centre_y = centre.tolist()
    pin_x, pin_y = shoe.own_pin.tolist()
    couple = (x - centre_x) * fy - (y - centre_y) * fx
    moment = (x - pin_x) * fy - (y - pin_y) * fx
    return np.array([fx, fy, couple]), moment


def support_reaction(body: ShoeSubstructure, p: Floats, drag: float, load: Floats) -> Floats:
    """The support reaction (3,): force x, force y and moment about the pin that hold the frame.

    Parameters
    ----------
    body : the substructure
    p : (n,) pressure at the contact nodes [Pa]
    drag : friction coefficient mu times the sense s of sliding
    load : (l,) factors of the load columns
    """
    reaction = body.reaction_to_pressure @ p + body.reaction_to_load @ load
    if body.reaction_to_friction is None:
        return reaction
    return reaction + drag * (body.reaction_to_friction @ p)


def contact_stiffness(shoe: Shoe, penalty: float) -> float:
    """The penalty stiffness of the contact per area [Pa/m]: `penalty` times E/t of the lining.

    E is the modulus through the lining's thickness t.
    """
    return penalty * shoe.lining.material.E_through / shoe.lining.thickness
