"""The displacements of all nodes of a shoe, recovered from the response of its brake."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake, Shoe
from drumlin.fem.preparation.bodies import (
    ShoeSubstructure,
    unit_load_factors_of_one_sided_support_push,
    unit_load_factors_under_all_loads,
)
from drumlin.response.response import Response, ShoeResponse


def nodal_contact_pressures_of_each_lining(brake: Brake, response: Response) -> list[Floats]:
    """For each shoe i, the pressures (n_i,) [Pa] at the contact nodes on all its linings.

    The nodes are in the order of their angle in the shoe's own frame.
    """
    pairs = zip(brake.shoes, response.shoes, strict=True)
    return [answer.nodal_pressures_on_linings[:: shoe.frame.sense] for shoe, answer in pairs]


def friction_stress_over_friction_coefficient_of_lining(
    brake: Brake, shoe: Shoe, answer: ShoeResponse, p: Floats
) -> Floats:
    """The friction stress (n,) [Pa] on a shoe's linings divided by the shoe's friction coefficient.

    The friction coefficient is the one at zero pressure. The result equals the pressures p (n,),
    unless the friction depends on the pressure.
    """
    if answer.friction_stress is None:
        return p
    stress = answer.nodal_values_on_linings(answer.friction_stress)[:: shoe.frame.sense]
    return np.asarray(stress / brake.friction_coefficient_of_shoe_at_zero_pressure(shoe))


def load_column_factors_and_frame_motion_in_response(
    body: ShoeSubstructure, brake: Brake, shoe: Shoe, answer: ShoeResponse
) -> tuple[Floats, Floats]:
    """The factors (l,) of a body's load columns and the motion (3,) of its frame in a response.

    The parameters are those of `nodal_displacements_of_shoe`.
    """
    load = unit_load_factors_under_all_loads(body, shoe, shoe.actuation.force)
    for support in answer.supports:
        load = load + unit_load_factors_of_one_sided_support_push(
            body, shoe, support.push, brake.size
        )
    motion = np.array(answer.motion or (0.0, 0.0, shoe.frame.sense * (answer.turn or 0.0)))
    return load, motion


def nodal_displacements_of_shoe(
    body: ShoeSubstructure, brake: Brake, shoe: Shoe, answer: ShoeResponse, p: Floats
) -> Floats:
    """The displacements (d nodes,) [m] of all nodes of a shoe in its own frame, d for each node.

    d is 2 in plane stress. In the model with widths it is the number of unknowns of a node.

    Parameters
    ----------
    body : the substructure of the shoe
    brake : the brake
    shoe : the shoe, with the actuation force of the response
    answer : the response of the shoe
    p : pressures (n,) [Pa] at the contact nodes on all linings of the shoe, in the order of their
        angle in the shoe's own frame
    """
    case = _load_case_of_shoe(body, brake, shoe, answer, p)
    return body.condensed.nodal_displacements_in_load_cases(*(part[:, None] for part in case))[:, 0]


def nodal_displacements_of_each_shoe(
    bodies: Sequence[ShoeSubstructure], brake: Brake, response: Response
) -> list[Floats]:
    """For each shoe the displacements (d nodes,) [m] that `nodal_displacements_of_shoe` gives.

    Shoes that share one substructure are its load cases, for which its equations are solved once.
    The brake has the actuation forces of the response.
    """
    pressures = nodal_contact_pressures_of_each_lining(brake, response)
    numbers_by_body: dict[int, list[int]] = {}
    for i, body in enumerate(bodies):
        numbers_by_body.setdefault(id(body), []).append(i)
    found: dict[int, Floats] = {}
    for numbers in numbers_by_body.values():
        body = bodies[numbers[0]]
        cases = [
            _load_case_of_shoe(body, brake, brake.shoes[i], response.shoes[i], pressures[i])
            for i in numbers
        ]
        columns = [np.column_stack(part) for part in zip(*cases, strict=True)]
        u = body.condensed.nodal_displacements_in_load_cases(*columns)
        found |= {i: u[:, column] for column, i in enumerate(numbers)}
    return [found[i] for i in range(len(bodies))]


class _LoadCaseOfShoe(NamedTuple):
    """What moves the nodes of a shoe in a response.

    Attributes
    ----------
    forces : nodal forces (2n,) [N] of pressure and friction on the contact nodes
    motion : motion (3,) of the body's frame
    load : factors (l,) of the body's load columns
    """

    forces: Floats
    motion: Floats
    load: Floats


def _load_case_of_shoe(
    body: ShoeSubstructure, brake: Brake, shoe: Shoe, answer: ShoeResponse, p: Floats
) -> _LoadCaseOfShoe:
    """The load case of a shoe in a response; parameters as in `nodal_displacements_of_shoe`."""
    load, motion = load_column_factors_and_frame_motion_in_response(body, brake, shoe, answer)
    # The pressures and friction stresses give the nodal forces on the contact nodes.
    dragging = friction_stress_over_friction_coefficient_of_lining(brake, shoe, answer, p)
    forces = (
        brake.signed_friction_stress_over_pressure_in_shoe_frame(shoe)
        * (body.coupling.T.T @ dragging)
        - body.coupling.N.T @ p
    )
    return _LoadCaseOfShoe(forces, motion, load)
