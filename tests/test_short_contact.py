"""Contacts too short for elements: their length by the half-plane formula, against elements."""

import numpy as np
import pytest

import drumlin
from drumlin import Brake, vary
from drumlin.fem.error_control import levels, short_contact
from drumlin.fem.preparation.prepare import make_prepared_model
from picking import saying

MAIN = "studies/double_shoe/brake.toml"
CORNER = {"clearance": [["-70 deg", "1 mm"], ["54.8 deg", "1 mm"], ["55 deg", "0 mm"]]}
WEDGE = {"clearance": [["-70 deg", "1 mm"], ["-10 deg", "0 mm"], ["55 deg", "1 mm"]]}
CROWN = {"misfit": {"radius": "145 mm"}}


def pressing(lining: dict[str, object], force: str) -> Brake:
    """The main brake, whose right shoe has another lining and another force."""
    changes = {f"shoe[0].lining.{key}": value for key, value in lining.items()}
    return vary(drumlin.read_brake(MAIN), changes | {"shoe[0].actuation.force": force})


@pytest.mark.parametrize(("lining", "force"), [(CORNER, "50 N"), (WEDGE, "50 N"), (CROWN, "1 N")])
def test_the_formula_gives_the_length_that_elements_resolve(monkeypatch, lining, force):
    """At forces with some hundred times the shortest contact that elements resolve."""
    brake = pressing(lining, force)
    response = drumlin.solve(brake, model_error=False)
    assert response.shoes[0].error["pressure"] < 5e-3
    ((start, end),) = response.shoes[0].contact_arcs
    monkeypatch.setattr(short_contact, "MOST_PRESSED_NODES_OF_SHORT_CONTACT", np.inf)
    monkeypatch.setattr(short_contact, "SHORTEST_CONTACT_WITH_KNOWN_PRESSURE", np.inf)
    contact = short_contact.contact_too_short_by_formula(brake, brake.shoes[0], response.shoes[0])
    assert 0.9 < (contact.end - contact.start) / (end - start) < 1.45


def test_a_contact_a_little_longer_than_the_shortest_keeps_its_pressure():
    """Its length is 1.3 times the shortest with a known pressure."""
    response = drumlin.solve(pressing(CORNER, "5 N"), model_error=False)
    assert not saying(response.notes, "too short to know")
    assert response.shoes[0].error["pressure"] < 0.02


def noting_calls(noted, function):
    """The function, which adds the arguments of each call to the list `noted`."""

    def noting(*given, **options):
        noted.append(given)
        return function(*given, **options)

    return noting


SPRING_BESIDE_ACTUATION = {
    "shoe": "right",
    "point": {"x": "58 mm", "y": "50 mm"},
    "end": {"x": "0 mm", "y": "50 mm"},
    "preload": "1e-3 N",
}
SOFT_RING = {"thickness": "20 mm", "width": "40 mm", "material": {"E": "10 MPa", "nu": 0.25}}


@pytest.mark.parametrize(
    "changes", [{"drum.ring": SOFT_RING}, {"spring": [SPRING_BESIDE_ACTUATION]}]
)
def test_the_formula_is_not_used_where_the_gap_is_not_that_of_a_rigid_drum_and_shoe(changes):
    """A soft ring makes this contact 31 times as long; a spring bends the shoe."""
    brake = pressing(WEDGE, "2e-3 N")
    answer = drumlin.solve(brake, model_error=False).shoes[0]
    other = vary(brake, changes)
    assert short_contact.contact_too_short_by_formula(brake, brake.shoes[0], answer) is not None
    assert short_contact.contact_too_short_by_formula(other, other.shoes[0], answer) is None


def test_the_formula_is_not_used_on_the_mesh_of_a_file():
    """The mesh has no node where the force acts, so that it has to be split there further."""
    brake = pressing(WEDGE, "2e-3 N")
    answer = drumlin.solve(brake, model_error=False).shoes[0]
    shoe = brake.shoes[0]
    meshed = shoe.model_copy(update={"mesh": "shoe.msh"})
    assert short_contact.contact_too_short_by_formula(brake, shoe, answer) is not None
    assert short_contact.contact_too_short_by_formula(brake, meshed, answer) is None


@pytest.mark.parametrize(
    ("lining", "force"), [(CORNER, "0.2 N"), (WEDGE, "1e-4 N"), (CROWN, "1e-8 N")]
)
def test_the_torque_of_a_too_short_contact_is_that_of_graded_elements(monkeypatch, lining, force):
    """It needs one division a level. The touching place is sought once a level, and once before.

    The error of the torque needs the place once more.
    """
    divided, sought = [], []
    search = short_contact._gap_of_first_touching_rigid_shoe
    monkeypatch.setattr(levels, "make_prepared_model", noting_calls(divided, make_prepared_model))
    monkeypatch.setattr(
        short_contact, "_gap_of_first_touching_rigid_shoe", noting_calls(sought, search)
    )
    brake = pressing(lining, force)
    early = drumlin.solve(brake, model_error=False)
    assert len(divided) == 2
    assert [shoe.name for _, shoe, _ in sought] == 4 * ["right"]
    assert saying(early.notes, "too short to know its pressure")
    monkeypatch.setattr(short_contact, "contact_too_short_by_formula", lambda *_: None)
    monkeypatch.setattr(
        levels, "too_short_contacts_expected_of_rigid_shoes", lambda brake: [None, None]
    )
    graded = drumlin.solve(brake, model_error=False)
    for a, b in zip(early.shoes, graded.shoes, strict=True):
        for name in ("torque", "reaction"):
            value = "hinge_reaction" if name == "reaction" else name
            far = np.linalg.norm(np.subtract(getattr(a, value), getattr(b, value)))
            allowed = a.error[name] + b.error[name]
            assert far <= allowed * np.linalg.norm(getattr(b, value))


def test_no_touching_place_is_sought_under_a_usual_force(monkeypatch):
    sought = []
    search = short_contact._gap_of_first_touching_rigid_shoe
    monkeypatch.setattr(
        short_contact, "_gap_of_first_touching_rigid_shoe", noting_calls(sought, search)
    )
    drumlin.solve(pressing(CROWN, "2 kN"), model_error=False)
    assert not sought


def test_the_unknown_place_within_a_too_short_contact_is_part_of_the_torque_s_error():
    """The torque is that of a force at one end of the contact, or at the other end."""
    brake = pressing(CORNER, "1 N")
    response = drumlin.solve(brake, model_error=False)
    shoe, answer = brake.shoes[0], response.shoes[0]
    ((start, end),) = answer.contact_arcs
    by_place = short_contact.force_error_due_to_place_in_too_short_contact(brake, shoe, answer)
    assert by_place > 0.1 * (end - start)
    assert min(answer.error["torque"], answer.error["reaction"]) >= by_place
    assert response.error["torque"] >= by_place
