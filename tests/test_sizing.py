"""The question turned round: sized brakes against closed forms, and refusals with their reasons."""

import json
import math

import pytest
from typer.testing import CliRunner

import drumlin
from conftest import STUDY, partly
from drumlin import sizing
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.file import make_drum_brake_from_data, values_of_brake_key, vary
from drumlin.brake.plane_brake import make_drum_or_plane_brake_from_data
from drumlin.cli.commands import app
from drumlin.fem.analysis.sensitivity import compute_torque_sensitivity
from drumlin.fem.analysis.slope_by_key import exact_torque_slope_by_key
from drumlin.fem.solve import prepared_model_with_finest_elements, solve

FORCE = "shoe.actuation.force"
R, MU, PHI, F = 0.15, 0.3, math.radians(90), 2000.0
POINT = (0.03, 0.12)
LINING = {"thickness": 0.008, "width": 0.04, "material": {"E": 3e8, "nu": 0.25}}


@pytest.fixture
def short_shoe():
    """A single short shoe with its lining's middle on +x, 90 deg from the hinge, which leads."""
    shoe = {
        "name": "only",
        "side": "internal",
        "hinge": {"radius": 0.125, "angle": -PHI},
        "lining": LINING | {"start": math.radians(-10), "end": math.radians(10)},
        "actuation": {"force": F, "direction": 0.0, "point": {"x": POINT[0], "y": POINT[1]}},
    }
    return make_drum_brake_from_data(
        {
            "title": "short",
            "rotation": "clockwise",
            "friction": MU,
            "drum": {"radius": R},
            "shoe": [shoe],
        }
    )


@pytest.mark.parametrize("model", ["sine", "cosine", "uniform", "short", "block"])
def test_the_force_of_a_law_is_exact(brake, model):
    wanted = 400.0
    found = drumlin.size(brake, FORCE, torque="400 N m", model=model)
    exact = 2000 * wanted / drumlin.solve(brake, model).torque
    assert found.value == pytest.approx(exact, rel=1e-12)
    assert found.torque == pytest.approx(wanted, rel=1e-12)
    assert found.errors == {}
    # The peak pressure is linear in the force, too.
    peak = max(shoe.peak_pressure for shoe in drumlin.solve(brake, model).shoes)
    found = drumlin.size(brake, FORCE, peak_pressure="1 MPa", model=model)
    assert found.value == pytest.approx(2000 * 1e6 / peak, rel=1e-12)


@pytest.mark.parametrize("wanted", [60.0, 120.0, 300.0])
def test_the_hinge_of_a_short_shoe_in_closed_form(short_shoe, wanted):
    """Moments about a hinge at (0, -a): N a - s mu N R = F (y + a), where the drag counts by s.

    The normal force acts on +x at the radius R. The torque is mu N R.
    """
    senses = {"clockwise": -1, "counter-clockwise": 1}
    for rotation, sense in senses.items():
        brake = vary(short_shoe, {"rotation": rotation})
        # T (a + sense mu R) = mu R F (y + a), solved for a.
        a = (MU * R * F * POINT[1] - wanted * sense * MU * R) / (wanted - MU * R * F)
        if not 0.05 < a < 0.2:
            continue
        found = drumlin.size(
            brake, "shoe.hinge.radius", torque=wanted, model="short", low=0.04, high=0.22
        )
        torque = MU * R * F * (POINT[1] + a) / (a + sense * MU * R)
        assert torque == pytest.approx(wanted, rel=1e-12)
        assert found.value == pytest.approx(a, rel=1e-10)


def test_the_best_direction_is_square_to_the_lever(short_shoe):
    lever = math.atan2(POINT[1] + 0.125, POINT[0])
    found = drumlin.size(short_shoe, "shoe.actuation.direction", torque="largest", model="short")
    assert found.value == pytest.approx(lever - math.pi / 2, abs=1e-3)
    # At the largest torque the slope vanishes, so that no error of the value is stated.
    assert found.remark == "the torque is largest inside the range"
    assert found.slope is None
    assert found.errors == {}
    more = 1.01 * found.torque
    with pytest.raises(NoAnswer, match=r"largest torque is .* the torque is not monotonic") as info:
        drumlin.size(short_shoe, "shoe.actuation.direction", torque=more, model="short")
    assert "shoe.actuation.direction from -30 deg to 30 deg" in str(info.value)
    # Below the largest torque two directions give the same.
    both = drumlin.size(
        short_shoe, "shoe.actuation.direction", torque=0.95 * found.torque, model="short"
    )
    (other,) = both.others
    assert both.value + other == pytest.approx(2 * (lever - math.pi / 2), abs=1e-9)


@pytest.mark.parametrize(
    "key", partly(["friction", FORCE, "shoe.lining.width", "shoe.left.hinge.x"], {FORCE})
)
def test_solving_the_sized_brake_gives_the_torque_within_its_error(brake, key):
    wanted = 1.02 * drumlin.solve(brake, elements=8, model_error=False).torque
    found = drumlin.size(brake, key, torque=wanted, elements=8)
    assert drumlin.solve(found.brake, elements=8).torque == pytest.approx(wanted, rel=1e-9)
    assert found.value_of_file != found.value
    assert found.range[0] < found.value < found.range[1]


@pytest.mark.slow
def test_the_stated_error_of_the_value_holds_against_a_finer_solution(brake):
    near = {"low": 0.25, "high": 0.3}
    found = drumlin.size(brake, "friction", torque=400.0, **near)
    fine = drumlin.size(brake, "friction", torque=400.0, tolerance=1e-4, **near)
    assert 0 < abs(found.value - fine.value) < found.errors["elements"]
    slope = drumlin.sensitivity(found.brake).friction
    assert found.slope == pytest.approx(slope, rel=0.02)
    error = found.response.error["torque"] * 400 / found.slope
    assert found.errors["elements"] == pytest.approx(error, rel=1e-3)


@pytest.mark.slow
def test_the_force_of_an_elastic_brake_that_touches_as_before(brake):
    wanted = 300.0
    found = drumlin.size(brake, FORCE, torque=wanted, elements=8)
    before = drumlin.solve(brake, elements=8, model_error=False).torque
    assert found.value == pytest.approx(2000 * wanted / before, rel=1e-9)
    # A clearance changes the contact with the force, so that the torque is not linear.
    loose = vary(brake, {"shoe.lining.clearance": 2e-5})
    found = drumlin.size(loose, FORCE, torque=wanted, elements=8)
    before = drumlin.solve(loose, elements=8, model_error=False).torque
    assert found.torque == pytest.approx(wanted, rel=1e-9)
    assert abs(found.value * before / (2000 * wanted) - 1) > 1e-3


SLOPES = [
    ("friction", 1e-4),
    (FORCE, 1.0),
    ("shoe.left.actuation.force", 1.0),
    ("shoe.lining.material.E", 1e4),
    ("shoe.body.material.E", 1e7),
    ("shoe.left.hinge.radius", 1e-6),
    ("shoe.left.hinge.angle", 1e-5),
    ("shoe.right.hinge.y", 1e-6),
]


@pytest.mark.parametrize(("key", "step"), partly(SLOPES, {("shoe.left.hinge.angle", 1e-5)}))
def test_the_exact_slope_of_a_key_is_the_change_of_the_torque(brake, key, step):
    scene = prepared_model_with_finest_elements(brake, elements=8)
    slope = exact_torque_slope_by_key(brake, key, compute_torque_sensitivity(scene, brake))
    parts = values_of_brake_key(brake, key)
    up, down = (
        solve(vary(brake, {key: parts[0] + sign * step}), elements=8).torque for sign in (1, -1)
    )
    assert slope == pytest.approx((up - down) / (2 * step), rel=1e-4)


@pytest.mark.slow
def test_keys_without_an_exact_slope_have_none(brake):
    slopes = drumlin.sensitivity(brake, elements=8)
    for key in (
        "drum.radius",
        "shoe.lining.width",
        "shoe.lining.material.nu",
        "shoe.left.lining.end",
    ):
        assert exact_torque_slope_by_key(brake, key, slopes) is None
    # The slope by friction changes the friction of a lining in proportion, unlike the key.
    own = vary(brake, {"shoe.left.lining.friction": 0.4})
    assert exact_torque_slope_by_key(own, "friction", drumlin.sensitivity(own, elements=8)) is None


def count_solves(monkeypatch):
    """A list that grows by one for each solve of a question."""
    solved, before = [], sizing.SizingQuestion.response_at_key_value

    def counted(question, value):
        solved.append(value)
        return before(question, value)

    monkeypatch.setattr(sizing.SizingQuestion, "response_at_key_value", counted)
    return solved


@pytest.mark.parametrize(
    ("key", "wanted", "most"),
    partly(
        [(FORCE, 400.0, 2), ("friction", 400.0, 5), ("friction", 3e4, 12)], {("friction", 400.0, 5)}
    ),
)
def test_few_solves_lead_to_the_value(brake, monkeypatch, key, wanted, most):
    solved = count_solves(monkeypatch)
    found = drumlin.size(brake, key, torque=wanted, elements=8)
    assert len(solved) <= most
    assert found.torque == pytest.approx(wanted, rel=1e-9)


def test_a_torque_that_jumps_over_the_wanted_one_has_no_value(brake, monkeypatch):
    def jumping(question, value):
        return sizing.TriedKeyValue(
            value, 100.0 + value + 200.0 * (value > 2500.0), 1e6, {"torque": 0.0}
        )

    monkeypatch.setattr(sizing.SizingQuestion, "solve_trial_at_key_value", jumping)
    with pytest.raises(NoAnswer, match=r"because the torque jumps from 2600 N m to 2800 N m at 25"):
        drumlin.size(brake, FORCE, torque=2700.0, model="sine")


def test_self_locking_bounds_the_friction(brake):
    limit = drumlin.solve(brake, "sine").self_locking.law.friction
    found = drumlin.size(brake, "friction", torque=1e5, model="sine")
    assert 0.9 * limit < found.value < limit
    with pytest.raises(NoAnswer, match=r"friction from 0.03 to 3, because the largest torque"):
        drumlin.size(brake, "friction", torque=1e12, model="sine")
    with pytest.raises(NoAnswer, match="there is no answer: shoe 'left': self-locking"):
        drumlin.size(brake, "friction", torque=1e12, model="sine")


def test_the_end_of_the_range_is_named(brake):
    with pytest.raises(NoAnswer, match=r"from 200 N to 20000 N.*, at 20000 N, the end of the"):
        drumlin.size(brake, FORCE, torque=1e5, model="sine")
    with pytest.raises(NoAnswer, match=r"from 3000 N to 4000 N.*smallest torque is .* at 3000 N"):
        drumlin.size(brake, FORCE, torque=100.0, model="sine", low="3 kN", high="4 kN")


def test_a_geometry_that_is_not_allowed_bounds_the_search(brake):
    ends = {"low": "100 deg", "high": "300 deg"}
    with pytest.raises(NoAnswer, match=r"from 100 deg to 300 deg, .* no answer: .*end = 250 deg"):
        drumlin.size(brake, "shoe.left.lining.start", torque=1e6, model="sine", **ends)


def test_both_limits(brake):
    solved = drumlin.solve(brake, "sine")
    peak = max(shoe.peak_pressure for shoe in solved.shoes)
    wanted = 2 * solved.torque
    found = drumlin.size(brake, FORCE, torque=wanted, peak_pressure=2.1 * peak, model="sine")
    assert found.value == pytest.approx(4000, rel=1e-12)
    most = drumlin.size(brake, FORCE, torque="largest", peak_pressure=1.5 * peak, model="sine")
    assert most.value == pytest.approx(3000, rel=1e-12)
    assert most.remark == "the peak pressure bounds the torque"
    with pytest.raises(NoAnswer, match=r"the largest torque within the limit is .*, at 3000 N"):
        drumlin.size(brake, FORCE, torque=wanted, peak_pressure=1.5 * peak, model="sine")
    with pytest.raises(NoAnswer, match="the smallest peak pressure is"):
        drumlin.size(brake, FORCE, torque="largest", peak_pressure=0.01 * peak, model="sine")


def test_a_plane_asks_for_a_braking_force():
    pad = {
        "name": "pad",
        "hinge": {"x": 0.0, "y": 0.05},
        "lining": {"start": 0.1, "end": 0.2, "width": 0.05},
        "actuation": {"force": 1000.0, "direction": -math.pi / 2, "point": {"x": 0.3, "y": 0.05}},
    }
    brake = make_drum_or_plane_brake_from_data(
        {"title": "p", "friction": 0.3, "plane": {"sliding": "+x"}, "shoe": [pad]}
    )
    # N (0.15 + 0.3 0.05) = F 0.3 of a short pad, whose friction helps or hinders by its sense.
    solved = drumlin.solve(brake, "short")
    found = drumlin.size(brake, FORCE, torque="500 N", model="short")
    assert found.value == pytest.approx(1000 * 500 / solved.effect, rel=1e-12)
    with pytest.raises(BadInput, match=r"torque = '500 N m'"):
        drumlin.size(brake, FORCE, torque="500 N m", model="short")


@pytest.mark.parametrize(
    ("key", "wanted", "message"),
    [
        ("frictoin", {"torque": 1.0}, "unknown key"),
        ("title", {"torque": 1.0}, "title: must be a key of the brake with a number"),
        ("shoe.left.lining.friction", {"torque": 1.0}, "friction: has no value in the brake file"),
        ("friction", {}, "torque, peak_pressure: give at least one of both"),
        ("friction", {"torque": -1.0}, "torque = -1: must be greater than 0"),
        ("friction", {"peak_pressure": "0 MPa"}, "peak_pressure = 0: must be greater"),
        ("friction", {"torque": "400"}, "torque = '400'"),
        ("friction", {"torque": 1.0, "low": 0.4, "high": 0.3}, "low = 0.4: must be less than"),
        ("shoe.lining.clearance", {"torque": 1.0}, "give low and high"),
        (
            "shoe.hinge.x",
            {"torque": 1.0},
            "shoe.hinge.x: is 32.3524 mm, -32.3524 mm of the different shoes; name one",
        ),
        ("friction", {"torque": 1.0, "model": "none"}, "model = 'none'"),
        ("friction", {"torque": 1.0, "model": "sine", "elements": 12}, "elements"),
    ],
)
def test_bad_input_gets_no_number(brake, key, wanted, message):
    with pytest.raises(BadInput, match=message):
        drumlin.size(brake, key, **wanted)


def test_the_command_prints_writes_and_refuses(tmp_path):
    file, sized = str(STUDY / "brake.toml"), tmp_path / "sized.toml"
    command = ["size", file, "--vary", FORCE, "--model", "sine"]
    data = tmp_path / "sized.json"
    options = ["--torque", "400 N m", "--json", str(data), "--write", str(sized)]
    done = CliRunner().invoke(app, command + options)
    text = " ".join(done.output.split())
    assert done.exit_code == 0
    assert "shoe.actuation.force = 1838.17 N (2000 N in the file): torque 400 N m" in text
    assert "searched: 200 N to 20000 N" in text
    kept = json.loads(data.read_text(encoding="utf-8"))
    assert drumlin.solve(sized, "sine").torque == pytest.approx(400, rel=1e-12)
    assert kept["value"] == drumlin.read_brake(sized).shoes[0].actuation.force
    assert kept["response"]["torque"] == pytest.approx(400)
    # A brake file is not replaced, and the refusal comes before the brakes are solved.
    refused = CliRunner().invoke(app, [*command, "--torque", "1 N m", "--write", str(sized)])
    assert isinstance(refused.exception, BadInput)
    refused = CliRunner().invoke(app, [*command, "--torque", "1000 kN m"])
    assert isinstance(refused.exception, NoAnswer)


def test_a_hinge_is_searched_on_the_first_level_and_corrected_on_all_levels(brake):
    """Few solves on all levels are left, and the answer is that of the search on all levels."""
    wanted = 1.05 * drumlin.solve(brake, model_error=False).torque
    question = sizing.SizingQuestion(brake, "shoe.hinge.radius", "fem", {}, wanted, None)
    near = sizing._find_only_trial_with_wanted_torque_from_first_level(question, wanted)
    assert near is not None
    assert 2 <= len(question.trials) <= 3
    other = sizing.SizingQuestion(brake, "shoe.hinge.radius", "fem", {}, wanted, None)
    trials = sizing._solve_first_trial_values(other)
    (root,) = sizing._find_all_trials_with_wanted_quantity(other, trials, "torque")
    slope = (trials[-1].torque - trials[0].torque) / (trials[-1].value - trials[0].value)
    assert abs(near.value - root.value) < abs(near.errors["torque"] * wanted / slope)


def test_no_search_on_the_first_level_decides_near_its_own_error(brake):
    """A torque next to a trial's torque, and one out of reach, are left to all levels."""
    question = sizing.SizingQuestion(brake, "shoe.hinge.radius", "fem", {}, None, None)
    for wanted in (1.001 * drumlin.solve(brake, model_error=False).torque, 1e5):
        found = sizing._find_only_trial_with_wanted_torque_from_first_level(question, wanted)
        assert found is None
    assert not question.trials
