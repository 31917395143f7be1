"""What is done with a brake besides: every kind of shoe, or one plain line that says why not."""

import numpy as np
import pytest

import drumlin
from drumlin.brake.file import vary
from drumlin.errors import BadInput
from drumlin.fem.assembly import prepare
from drumlin.fem.holding import hold
from drumlin.models import refusals
from drumlin.verification.reference import responses
from test_freedoms_fem import BODY, brake_of
from test_sharing import cam_brake, servo


@pytest.mark.parametrize("make", [cam_brake, servo, lambda: brake_of("abutment", 1), lambda: brake_of("pivot", 1)])
def test_reference_values_are_refused_in_one_line(make) -> None:
    brake = make()
    with pytest.raises(BadInput, match="takes shoes on hinges under forces of their own only: ") as refusal:
        responses(brake)
    assert "\n" not in str(refusal.value)
    assert refusals(brake).keys() >= {"sine", "foundation"}


@pytest.mark.parametrize("kind", ["abutment", "pivot", "guide"])
def test_held_from_rest_to_full_slip_shoes_come_to_the_sliding_torque(kind: str) -> None:
    brake = vary(brake_of(kind, 1, body=BODY), {"shoe.lining.thickness": 0.005})
    scene = prepare(brake, elements=16)
    states = hold(scene, brake, np.geomspace(1e-6, 2e-3, 8))
    if kind != "pivot":  # whose lever drags the shoe along the drum, to full slip, as it presses it
        assert states[0].torque < states[-1].torque * (1 - 1e-3)
    assert states[-1].torque == pytest.approx(drumlin.solve(brake, elements=16).torque, rel=1e-3)


def test_clearance_and_misfit_act_on_every_kind_of_shoe() -> None:
    for kind in ("abutment", "pivot", "guide"):
        brake = vary(brake_of(kind, 1, body=BODY), {"shoe.lining.thickness": 0.005})
        ground = vary(brake, {"shoe.lining.misfit": {"radius": 0.1098}, "shoe.lining.clearance": 1e-5})
        response = drumlin.solve(ground)
        assert max(response.balance.force, response.balance.moment) < 1e-9
        assert abs(response.torque / drumlin.solve(brake).torque - 1) > 1e-3


def test_how_a_body_is_held_is_said_in_one_line() -> None:
    for kind, said in (
        ("abutment", "its foot holds the end face of its body, "),
        ("pivot", "its pivot grips 12 mm of the back of its body"),
        ("guide", "its guide grips 12 mm of the back of its body"),
    ):
        notes = drumlin.solve(brake_of(kind, 1, body=BODY), elements=20).notes
        assert sum(said in note for note in notes) == 1


@pytest.mark.parametrize("kind", ["pivot", "guide"])
def test_a_grip_is_met_by_any_mesh(kind: str) -> None:
    """Also where both its ends lie next to one line of the mesh, or between none."""
    brake = vary(brake_of(kind, -1, body=BODY), {"shoe.lining.thickness": 0.005})
    torque = drumlin.solve(brake, elements=24).torque
    for elements in (1, 2, 3, 5, 8, 10):
        assert drumlin.solve(brake, elements=elements).torque == pytest.approx(torque, rel=0.1 / elements)
