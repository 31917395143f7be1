"""Every answer tells how far the friction is from the limit of self-locking, and warns near it."""

import json
import math

import pytest
from scipy.integrate import quad
from typer.testing import CliRunner

import drumlin
from conftest import STUDY
from drumlin.brake.file import vary
from drumlin.cli.commands import app
from drumlin.fem.solve import solve


@pytest.fixture(scope="module")
def rigid_limit(brake):
    """mu_lock of the leading shoe by moments of the pressure sin(phi) about the pin."""
    R, a = 0.150, 0.125
    ends = math.radians(5), math.radians(130)
    closing = quad(lambda phi: a * math.sin(phi) ** 2, *ends)[0]
    dragging = quad(lambda phi: math.sin(phi) * (R - a * math.cos(phi)), *ends)[0]
    return closing / dragging


@pytest.fixture(scope="module")
def elastic_limit(brake):
    """mu_lock of the elastic brake, followed from zero friction."""
    limits = drumlin.self_locking(brake, elements=12, most=2.0, penalty=1e8)
    return min(limit.friction for limit in limits)


def test_every_answer_states_the_law_s_limit(brake, rigid_limit):
    for model in ("fem", "sine", "foundation", "short"):
        options = {"elements": 12, "model_error": False} if model == "fem" else {}
        if model == "foundation" and drumlin.models.MODELS[model].why_not(brake):
            continue
        response = drumlin.solve(brake, model, **options)
        assert response.self_locking.law.shoes == ("left",)
        assert response.self_locking.law.friction == pytest.approx(rigid_limit, rel=1e-6)
        assert response.as_dict()["self_locking"]["law"] == response.self_locking.law.friction
        assert not [note for note in response.notes if "mu_lock" in note]
    # A single solve within a sweep does not ask for it.
    assert solve(brake, elements=12).self_locking is None


@pytest.mark.parametrize("share", [0.3, 0.6, 0.7, 0.99])
def test_the_elastic_limit_is_stated_where_friction_is_near(
    brake, rigid_limit, elastic_limit, share
):
    mu = share * elastic_limit
    response = drumlin.solve(
        vary(brake, {"friction": mu}), elements=12, model_error=False, penalty=1e8
    )
    locking = response.self_locking
    near = mu > 0.5 * rigid_limit
    stated = elastic_limit if near else math.inf
    assert locking.elastic.friction == pytest.approx(stated, rel=1e-6)
    # The other shoe does not lock below the limit of the first.
    assert locking.sought == pytest.approx(elastic_limit if near else 1.5 * mu, rel=1e-6)
    warned = [note for note in response.notes if "towards which the torque grows" in note]
    assert len(warned) == (share > 2 / 3)
    above = [note for note in response.notes if "of the rigid-shoe law, by which" in note]
    assert len(above) == (mu > rigid_limit)


def test_an_opposed_shoe_and_no_friction_have_no_limit(brake):
    trailing = brake.model_copy(update={"shoes": brake.shoes[:1]})
    found = drumlin.solve(trailing, elements=12, model_error=False).self_locking
    assert found.as_dict() == {
        "friction": 0.3,
        "law": None,
        "elastic": None,
        "elastic_sought_up_to": pytest.approx(0.45, rel=1e-12),
    }
    line = (
        "no friction locks the brake by the rigid-shoe law; mu_lock of the elastic brake is above "
        "0.45 = 1.5 mu, where the search ends"
    )
    assert line in found.line()
    still = drumlin.solve(vary(brake, {"friction": 0}), elements=12, model_error=False)
    assert still.self_locking.elastic is None
    assert "friction 0 is 0 % of mu_lock" in still.self_locking.line()


def _brake_at_friction(name: str, reverse: bool, friction: float) -> drumlin.Brake:
    """A brake of the studies with another friction, and with its other sense if `reverse`."""
    brake = drumlin.read_brake(STUDY.parent / "brakes" / f"{name}.toml")
    if reverse:
        brake = brake.brake_with_reversed_motion()
    return vary(brake, {"friction": friction})


@pytest.mark.parametrize(
    ("name", "reverse", "friction", "bounded"),
    [
        ("duo_servo", False, 0.6, False),
        ("duo_servo", True, 0.35, False),
        ("s_cam", False, 0.7, True),
        ("simplex_abutted", False, 0.7, True),
    ],
)
def test_anchors_struts_and_cams_have_their_elastic_limit_in_the_answer(
    name, reverse, friction, bounded
):
    brake = _brake_at_friction(name, reverse, friction)
    limits = drumlin.self_locking(brake, elements=8, penalty=1e8)
    limit = min(limits, key=lambda limit: limit.friction)
    answer = drumlin.solve(brake, elements=8, model_error=False, penalty=1e8)
    stated = answer.self_locking.elastic
    assert stated.friction == pytest.approx(limit.friction, rel=1e-3)
    assert (stated.shoes, stated.pressure_stays_finite) == (limit.shoes, bounded)
    assert answer.as_dict()["self_locking"]["elastic"] == stated.friction
    assert f"mu_lock = {stated.friction:.4g} for the elastic brake" in answer.self_locking.line()
    # The warning tells a torque without bound from an equilibrium that ends.
    warned = " ".join(note for note in answer.notes if "for the elastic brake" in note)
    near = friction > 2 / 3 * stated.friction
    assert ("torque grows without bound" in warned) == (near and not bounded)
    assert ("ends while the torque is finite" in warned) == (near and bounded)


def test_feet_on_abutments_are_sought_up_to_the_warning():
    brake = drumlin.example("duplex")
    found = drumlin.solve(brake, elements=8, model_error=False).self_locking
    assert found.elastic is not None and found.sought >= 1.5 * brake.friction


def test_the_command_prints_the_line_and_the_warnings(tmp_path):
    text = (STUDY / "brake.toml").read_text()
    path, json_file = tmp_path / "b.toml", tmp_path / "r.json"
    path.write_text(text.replace("friction = 0.3", "friction = 1.17"))
    words = ["solve", str(path), "--elements", "12", "--no-model-error", "--json", str(json_file)]
    ran = CliRunner().invoke(app, words)
    printed = " ".join(ran.stdout.split())
    assert ran.exit_code == 0
    assert "self-locking: friction 1.17 is 99 % of mu_lock = 1.18" in printed
    assert "warning: shoe 'left': friction 1.17 is 99 % of mu_lock" in printed
    assert "friction 1.17 is above mu_lock = 0.8231 of the rigid-shoe law" in printed
    written = json.loads(json_file.read_text())
    assert written["self_locking"]["elastic"] == pytest.approx(1.18, rel=0.02)
    assert sum("mu_lock" in note for note in written["notes"]) == 2
