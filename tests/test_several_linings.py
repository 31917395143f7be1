"""Several linings on one shoe: laws, finite elements with their errors, files, and refusals."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import drumlin
from conftest import ROOT
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake
from drumlin.brake.components import Lining
from drumlin.brake.file import read_brake, values_of_brake_key, vary
from drumlin.brake.writing import brake_file_text
from drumlin.cli.commands import app
from drumlin.laws.rigid import UNUSED_KEYS_LINE_START, solve_brake_by_rigid_shoe_law
from drumlin.response.resultants import (
    LiningWithoutEndZones,
    polynomial_nodes_on_linings_and_slots,
    slots_from_nodes_and_lining_mask,
)
from drumlin.verification.triangles.levels import (
    TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE,
    solve_brake_on_sequence_of_triangle_meshes,
)
from several_linings import APART, BODY, brake_with, lining

EXAMPLE = ROOT / "studies" / "linings" / "linings_apart.toml"
DEG = math.pi / 180


def torque_of_shape(brake: Brake, shape: Any) -> tuple[float, float]:
    """Torque and peak pressure of p = a shape(theta) on the linings, by plain quadrature.

    The moment of pressure, friction and force about the pin vanishes.
    """
    (shoe,) = brake.shoes
    x, weight = np.polynomial.legendre.leggauss(60)
    theta, dtheta = [], []
    for start, end in shoe.lining.arcs:
        theta.append(0.5 * (start + end + (end - start) * x))
        dtheta.append(0.5 * (end - start) * weight)
    t, dt = np.concatenate(theta), np.concatenate(dtheta)
    R, width, drag = brake.size, shoe.lining.width, brake.friction * brake.sign_of_motion
    e_r = np.array([np.cos(t), np.sin(t)])
    traction = -e_r + drag * np.array([-e_r[1], e_r[0]])
    arm = R * e_r - shoe.pin.xy[:, None]
    moment = width * R * np.sum(shape(t) * dt * (arm[0] * traction[1] - arm[1] * traction[0]))
    a = -shoe.actuation.moment_of_force_about_point(shoe.pin) / moment
    ends = np.concatenate([np.linspace(*arc, 4001) for arc in shoe.lining.arcs])
    return (
        float(abs(drag) * width * R**2 * a * np.sum(shape(t) * dt)),
        float((a * shape(ends)).max()),
    )


@pytest.mark.parametrize("model", ["sine", "cosine", "uniform"])
def test_a_law_presses_on_the_linings_only(model: str) -> None:
    (shoe,) = APART.shoes
    shapes = {
        "sine": lambda t: np.sin(t - shoe.frame.origin),
        "cosine": lambda t: np.cos(t - shoe.lining.middle),
        "uniform": np.ones_like,
    }
    torque, peak = torque_of_shape(APART, shapes[model])
    response = drumlin.solve(APART, model)
    assert response.torque == pytest.approx(torque, rel=1e-11)
    assert response.shoes[0].peak_pressure == pytest.approx(peak, rel=1e-6)
    assert response.shoes[0].contact_arcs == shoe.lining.arcs
    assert not response.shoes[0].pressure_at(np.linspace(-4.99, 4.99, 21) * DEG).any()
    assert max(response.balance.force, response.balance.moment) < 1e-11
    if model == "sine":
        assert response.torque == pytest.approx(6416.91, abs=0.01)
        assert peak == pytest.approx(1.587e6, rel=3e-4)
        by_rigid = solve_brake_by_rigid_shoe_law(APART)
        assert by_rigid.torque == pytest.approx(torque, rel=1e-11)


@pytest.mark.parametrize("model", ["short", "solid"])
def test_a_model_of_one_lining_refuses_several(model: str) -> None:
    with pytest.raises(BadInput, match=r"'right': lining: 2 with slots between them; .* takes one"):
        drumlin.solve(APART, model)


def test_an_analysis_of_one_lining_refuses_several() -> None:
    with pytest.raises(BadInput, match=r"lining: 2 with slots between them; .* takes one"):
        drumlin.solve(APART, finite_width=True)


def test_finite_elements_of_thin_linings_are_the_law() -> None:
    """A thin layer on a rigid shoe is a linear foundation, whose law is the sine law."""
    off = []
    for thickness in ("2 mm", "0.5 mm"):
        thin = vary(APART, {"shoe.lining.thickness": thickness})
        law, found = drumlin.solve(thin, "sine"), drumlin.solve(thin, model_error=False)
        assert found.error is not None
        off.append(abs(found.torque / law.torque - 1))
    assert off[1] < 0.3 * off[0] < 3e-4


def test_linings_that_touch_are_one_lining() -> None:
    one, two = brake_with(lining(-56, 56)), brake_with([lining(-56, 3), lining(3, 56)])
    assert two.shoes[0].lining.slots == ()
    for model in ("sine", "short", "fem"):
        options: dict[str, Any] = {"model_error": False} if model == "fem" else {}
        a, b = (drumlin.solve(each, model, **options).torque for each in (one, two))
        assert a == b, model


def test_a_list_of_one_table_is_that_lining() -> None:
    a, b = (drumlin.solve(brake_with(t)).as_dict() for t in (lining(-56, 56), [lining(-56, 56)]))
    for found in (a, b):
        del found["seconds"]
    assert a == b


def test_the_stated_error_holds_and_pressure_is_in_balance() -> None:
    brake = brake_with([lining(-50, -20), lining(-10, 30, clearance="0.01 mm")])
    response = drumlin.solve(brake, model_error=False)
    fine = drumlin.solve(brake, tolerance=2e-4, model_error=False)
    assert response.error is not None
    assert abs(response.torque / fine.torque - 1) < response.error["torque"] < 1e-4
    (shoe,), (true,) = response.shoes, fine.shoes
    assert abs(shoe.peak_pressure / true.peak_pressure - 1) < response.error["peak"] < 5e-3
    # The torque of p(theta) is that of the answer. The curve has points in the slots.
    theta, p = fine.shoes[0].curve()
    assert np.all(np.diff(theta) > 0)
    lever = brake.friction * 0.18 * brake.size**2
    assert lever * np.trapezoid(p, theta) == pytest.approx(fine.torque, rel=1e-4)
    for start, end in brake.shoes[0].lining.slots:
        assert not shoe.pressure_at(np.linspace(start + 1e-6, end - 1e-6, 9)).any()
    # The first lining presses up to its edge at the slot, the second from inside its edge on.
    (first, second), (start, end) = shoe.contact_arcs, brake.shoes[0].lining.slots[0]
    assert first[1] == pytest.approx(start, abs=1e-11)
    assert end + 0.01 * DEG < second[0] < end + 3 * DEG


def test_no_peak_is_sought_beside_a_slot() -> None:
    """The pressure is 1, and 9 within 0.1 of each edge of the two linings."""
    parts = [np.linspace(0, 1, 101), np.linspace(2, 3, 101)]
    theta, on_lining = polynomial_nodes_on_linings_and_slots(parts, 1)
    slots = slots_from_nodes_and_lining_mask(theta, on_lining)
    assert slots == ((1.0, 2.0),)
    edge = np.min(np.abs(theta[:, None] - [0.0, 1.0, 2.0, 3.0]), axis=1)
    p = np.where(edge < 0.095, 9.0, 1.0) * on_lining
    assert LiningWithoutEndZones(theta, 1, 0.11, slots).largest_value_outside_end_zones(p) == 1.0
    assert LiningWithoutEndZones(theta, 1, 0.11).largest_value_outside_end_zones(p) == 9.0
    inner = LiningWithoutEndZones(theta, 1, 0.11, slots)
    whole, inside = inner.integration_weights_with_and_without_end_zones @ on_lining
    assert whole == pytest.approx(2.0, abs=1e-11)
    assert inside == pytest.approx(2 * (1 - 2 * 0.11), abs=1e-11)


@pytest.mark.slow
def test_a_mesh_file_may_have_a_contact_line_on_each_lining(tmp_path: Path) -> None:
    brake = brake_with([lining(-56, -5), lining(5, 56)], body=BODY)
    (tmp_path / "brake.toml").write_text(brake_file_text(brake))
    drawn, made = str(tmp_path / "brake.toml"), str(tmp_path / "of")
    words = ["mesh", drawn, "--kind", "quad2", "--elements", "24", "--output", made]
    ran = CliRunner().invoke(app, words)
    assert ran.exit_code == 0, ran.output
    text = brake_file_text(brake)
    side = 'side = "internal"'
    assert side in text
    (tmp_path / "own.toml").write_text(text.replace(side, f'{side}\nmesh = "of/brake_right.msh"'))
    own = drumlin.solve(tmp_path / "own.toml", model_error=False)
    # Columns at their default tolerance are less exact than the mesh file.
    columns = drumlin.solve(brake, model_error=False, tolerance=1e-5)
    assert own.error is not None and own.error["torque"] < 1e-3
    assert abs(own.torque / columns.torque - 1) < own.error["torque"]
    # A mesh with the contact of other linings is refused.
    moved = text.replace(side, f'{side}\nmesh = "of/brake_right.msh"').replace("-5 deg", "-15 deg")
    (tmp_path / "moved.toml").write_text(moved)
    with pytest.raises(BadInput, match="must be the lining's arc, -56 deg to -15 deg"):
        drumlin.solve(tmp_path / "moved.toml")


def test_a_file_with_several_linings_is_written_and_read(tmp_path: Path) -> None:
    brake = read_brake(EXAMPLE)
    path = tmp_path / "again.toml"
    path.write_text(brake_file_text(brake))
    assert read_brake(path) == brake
    assert values_of_brake_key(brake, "shoe[0].lining[1].start") == [pytest.approx(5 * DEG)]
    changed = vary(brake, {"shoe[0].lining[1].clearance": 1e-4, "shoe.lining.thickness": "9 mm"})
    parts = changed.shoes[0].lining.linings
    assert [part.clearance for part in parts] == [0.0, 1e-4]
    assert [part.thickness for part in parts] == pytest.approx([0.009, 0.009])
    assert isinstance(changed.shoes[0].lining, Lining)


@pytest.mark.parametrize(
    ("tables", "line"),
    [
        (
            [lining(-56, 6), lining(5, 56)],
            "lining[1].start = 5 deg: must not be less than lining[0].end = 6 deg",
        ),
        (
            [lining(-56, -5), lining(5, 56) | {"thickness": "9 mm"}],
            "lining[1].thickness = 9 mm: must be 18 mm, as of lining[0]",
        ),
        (
            [lining(-56, -5), lining(5, 56) | {"material": {"E": "1 GPa", "nu": 0.2}}],
            "linings of one shoe with unlike material are not computed",
        ),
        (
            [lining(-56, 5), lining(5, 56, clearance="1 mm")],
            "linings that touch are one lining, and must have the same clearance and no misfit",
        ),
        (
            [lining(-56, 5), lining(5.05, 56)],
            "the slot from 5 deg to 5.05 deg must be at least 0.0572958 deg wide",
        ),
        (
            [lining(-56, 5), lining(6, 56) | {"width": "-5 mm"}],
            "shoe[0].lining[1].width = '-5 mm': must be greater than 0",
        ),
        (
            [lining(-56, 5), lining(6, 56, misfit={"radius": "1 m"})],
            "shoe[0].lining[1].misfit.radius = 1000 mm: must be within",
        ),
    ],
)
def test_linings_that_do_not_fit_together_are_refused(tables: Any, line: str) -> None:
    with pytest.raises(BadInput) as refusal:
        brake_with(tables)
    assert line in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_a_law_names_the_keys_that_it_does_not_use(tmp_path: Path) -> None:
    brake = brake_with([lining(-56, -5, clearance="0.1 mm"), lining(5, 56)], body=BODY)
    (line,) = (
        x for x in drumlin.solve(brake, "sine").left_out if x.startswith(UNUSED_KEYS_LINE_START)
    )
    assert line == f"{UNUSED_KEYS_LINE_START}shoe.body, shoe.lining.clearance"
    # A change of a brake writes out all of its keys, which are not given for that.
    changed = vary(brake, {"friction": 0.25})
    assert line in drumlin.solve(changed, "sine").left_out
    assert not any(
        line.startswith(UNUSED_KEYS_LINE_START)
        for line in drumlin.solve(brake, elements=8, model_error=False).left_out
    )
    path = tmp_path / "brake.toml"
    path.write_text(brake_file_text(brake))
    ran = CliRunner().invoke(app, ["solve", str(path), "--model", "sine"], terminal_width=200)
    assert ran.output.count("shoe.lining.clearance") == 1


@pytest.mark.slow
def test_hold_ends_at_full_slip_and_slopes_are_those_of_differences() -> None:
    held = drumlin.hold(APART, steps=2)
    torque = drumlin.solve(APART).torque
    assert held.states[-1].torque == pytest.approx(torque, rel=1e-4)
    up, down = (drumlin.solve(vary(APART, {"friction": f})).torque for f in (0.3501, 0.3499))
    slopes = drumlin.sensitivity(APART)
    assert slopes.friction == pytest.approx((up - down) / 2e-4, rel=1e-3)


KINDS: dict[str, Brake] = {
    "body": brake_with([lining(-56, -5), lining(5, 56)], body=BODY),
    "three": brake_with(
        [lining(-60, -25), lining(-20, 10, clearance="0.02 mm"), lining(15, 60)],
        body=BODY | {"table": {"thickness": "6 mm", "width": "160 mm"}},
        backing={"thickness": "10 mm", "material": {"E": "10 GPa", "nu": 0.3}},
    ),
    "grip in the slot": brake_with([lining(-56, -5), lining(5, 56)], body=BODY | {"grip": "25 mm"}),
    "narrow slot": brake_with([lining(-56, -0.03), lining(0.03, 56)], body=BODY),
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_triangles_give_the_same_answer(kind: str) -> None:
    """The second solver shares only the brake with the first."""
    brake = KINDS[kind]
    response = drumlin.solve(brake, model_error=False)
    (true,) = solve_brake_on_sequence_of_triangle_meshes(
        brake, TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE[:2]
    )[-1]
    (shoe,) = response.shoes
    assert response.error is not None
    assert abs(shoe.torque / true.torque - 1) < response.error["torque"] < 2e-4
    off = np.hypot(*(shoe.hinge_reaction - true.hinge_reaction))
    assert off < response.error["reaction"] * np.hypot(*true.hinge_reaction)
    # The zones of 0.2 deg at the ends of the linings do not count.
    lining_ends = brake.shoes[0].lining.arcs
    theta = np.concatenate([np.linspace(a + 0.0036, b - 0.0036, 2001) for a, b in lining_ends])
    p, q = shoe.pressure_at(theta), true.pressure_at(theta)
    assert math.sqrt(np.sum((p - q) ** 2) / np.sum(q**2)) < response.error["pressure"] < 2e-3
