"""Springs with a rate in the second solver: the stretch of the spring, by virtual work."""

from typing import Any

import numpy as np
import pytest

import drumlin
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import vary
from drumlin.brake.further_loads import brake_with_loads_assigned_to_shoes
from drumlin.verification.triangles import levels
from drumlin.verification.triangles.contact import (
    ContactForcesAndRigidMotions,
    forces_of_drum_on_lining_nodes,
)
from drumlin.verification.triangles.face import (
    ShoeCondensedToLiningFace,
    condense_shoe_to_lining_face,
)
from further_loads import BODY, PULL, brake_with, two_shoes

TO_FRAME = {
    "shoe": "shoe",
    "point": {"x": 0.095, "y": 0.03},
    "end": {"x": -0.02, "y": 0.02},
    "preload": 100.0,
}
RATE = 5e6
"""Rate [N/m] that changes the pull by more than 1 %."""


def spring_point_displacement(
    brake: Brake, shoe: Shoe, face: ShoeCondensedToLiningFace, found: Any, body: Any
) -> float:
    """The displacement [m] of the spring's point on a shoe along a pull of 1 N, by virtual work.

    By the theorem of Betti the work of the pull on the displacements due to the drum's forces is
    the work of the drum's forces on the displacements due to the pull. The work of the pull on the
    displacements due to the other loads follows from the strain energies under the pull alone,
    under the other loads alone, and under both.
    """
    (spring,) = brake.springs
    pull = spring.spring_or_lever_force_on_shoe(shoe.name, 1.0)
    assert pull is not None
    unloaded = vary(brake, {f"shoe.{shoe.name}.actuation.force": 1e-12})
    alone, with_pull = (
        brake_with_loads_assigned_to_shoes(of, [more])
        for of, more in ((unloaded, 1.0), (brake, spring.preload + 1.0))
    )
    index = [one.name for one in brake.shoes].index(shoe.name)
    by_pull, by_both = (
        condense_shoe_to_lining_face(of, of.shoes[index], body) for of in (alone, with_pull)
    )
    energies = by_both.elastic_actuation_work, by_pull.elastic_actuation_work
    other = 0.5 * (energies[0] - energies[1] - face.elastic_actuation_work)
    drum = forces_of_drum_on_lining_nodes(brake, shoe, face, found.force)
    rigid = shoe.rigid_body_modes_of_support(1).motions @ pull.resultant
    return float(by_pull.loaded @ drum.ravel() + other + rigid @ found.motions)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["between hinged shoes", "from an abutment to the frame"])
def test_the_second_solver_stretches_the_spring_as_much(kind: str, monkeypatch: Any) -> None:
    """Under drumlin's pull its elements and the triangles agree on torque and stretch."""
    if kind == "between hinged shoes":
        brake = two_shoes(True, spring=[PULL | {"rate": RATE}])
    else:
        brake = brake_with("abutment", body=BODY, brake={"spring": [TO_FRAME | {"rate": RATE}]})
    ours = drumlin.solve(brake, model_error=False)
    (pull,) = ours.spring_pulls
    steady = vary(brake, {"spring[0].rate": 0.0, "spring[0].preload": pull})
    bodies, solved = [], []

    def keep_body(of: Brake, shoe: Shoe, body: Any) -> ShoeCondensedToLiningFace:
        bodies.append(body)
        return condense_shoe_to_lining_face(of, shoe, body)

    def keep_solution(
        of: Brake,
        shoe: Shoe,
        face: ShoeCondensedToLiningFace,
        found: ContactForcesAndRigidMotions,
    ) -> Any:
        solved.append((shoe, face, found))
        return shoe_solution(of, shoe, face, found)

    shoe_solution = levels.shoe_solution_from_contact_forces
    monkeypatch.setattr(levels, "condense_shoe_to_lining_face", keep_body)
    monkeypatch.setattr(levels, "shoe_solution_from_contact_forces", keep_solution)
    fine = levels.solve_brake_on_one_triangle_mesh(
        steady, levels.TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE[0]
    )
    for a, b in zip(ours.shoes, fine, strict=True):
        assert a.torque == pytest.approx(b.torque, rel=1e-3)
    stretch = -sum(
        spring_point_displacement(steady, *of, body)
        for of, body in zip(solved, bodies, strict=True)
    )
    assert abs(pull / 100.0 - 1) > 0.01
    assert (pull - 100.0) / RATE == pytest.approx(stretch, rel=3e-3)
    np.testing.assert_array_less(0, [shoe.torque for shoe in fine])
