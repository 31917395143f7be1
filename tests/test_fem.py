"""The finite-element model: limits, laws of physics as properties, convergence, refusals."""

import math
from itertools import pairwise, starmap

import meshio
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from conftest import STUDY
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.file import make_drum_brake_from_data, read_brake, vary
from drumlin.comparison import solve_on_refined_meshes
from drumlin.contact import active_set
from drumlin.fem.analysis.fields import (
    stress_and_displacement_fields_of_shoe,
    stress_and_displacement_fields_of_shoes_and_ring,
    write_fields_to_vtu_file,
)
from drumlin.fem.equilibrium.group import ShoeGroup
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin.laws import self_locking_friction_of_hinged_shoe, solve_brake_by_sine_law
from drumlin.response.norms import relative_distance_of_pressures
from drumlin.verification.cost import (
    measure_time_and_memory_of_fem,
    table_lines_of_cost_by_number_of_unknowns,
)
from picking import picked, saying

ROTATIONS = ("counter-clockwise", "clockwise")
BRAKE = read_brake(STUDY / "brake.toml")
SCENE = make_prepared_model(BRAKE, elements=40)


def same(a, b, rel):
    """Two responses agree in every number, relative to the scale of each kind."""
    assert a.torque == pytest.approx(b.torque, rel=rel)
    for x, y in zip(a.shoes, b.shoes, strict=True):
        assert x.pressure == pytest.approx(y.pressure, rel=rel, abs=rel * y.pressure.max())
        assert x.hinge_reaction == pytest.approx(
            y.hinge_reaction, rel=rel, abs=rel * np.abs(y.hinge_reaction).max()
        )
        assert x.normal_force == pytest.approx(y.normal_force, rel=rel)
        assert x.self_energising == y.self_energising


@pytest.mark.parametrize("rotation", ROTATIONS)
def test_a_stiff_shoe_with_a_thin_lining_returns_to_the_sine_law(rotation):
    rigid = vary(
        BRAKE,
        {"rotation": rotation, "shoe.body.material.E": 2.1e15, "shoe.lining.thickness": 0.003},
    )
    law, fem = solve_brake_by_sine_law(rigid), solve(rigid, elements=120)
    assert fem.torque == pytest.approx(law.torque, rel=3e-3)
    for spec, a, b in zip(rigid.shoes, law.shoes, fem.shoes, strict=True):
        assert b.torque == pytest.approx(a.torque, rel=3e-3)
        assert b.self_energising == a.self_energising
        assert np.linalg.norm(b.hinge_reaction - a.hinge_reaction) < 5e-3 * np.linalg.norm(
            a.hinge_reaction
        )
        phi = spec.frame.phi_of_surface_coordinates(b.theta)
        inside = (phi > phi.min() + 0.1) & (phi < phi.max() - 0.1)
        ratio = b.pressure[inside] / np.sin(phi[inside])
        assert np.ptp(ratio) < 0.01 * ratio.mean()


def test_the_deviation_from_the_law_falls_with_the_lining(brake):
    """The torque of a rigid shoe tends to the sine law as its lining becomes thin.

    The lining's own shear and bulging alone are left, and they vanish with t/R.
    """
    deviations = []
    for thickness in (0.008, 0.004, 0.002):
        rigid = vary(brake, {"shoe.body": None, "shoe.lining.thickness": thickness})
        deviations.append(
            abs(solve(rigid, elements=80).torque / solve_brake_by_sine_law(rigid).torque - 1)
        )
    assert deviations[0] < 2e-3
    assert deviations[2] < deviations[1] < deviations[0]
    assert deviations[2] < 0.4 * deviations[0]


@pytest.mark.parametrize("penalty", (1e3, 1e6, math.inf))
def test_forces_and_moments_balance_and_contact_is_complementary(penalty, brake):
    response = solve_prepared_model(SCENE, BRAKE, penalty=penalty)
    assert response.converged
    assert max(response.balance.force, response.balance.moment) < 1e-9
    for index, (body, shoe) in enumerate(zip(SCENE.bodies, BRAKE.shoes, strict=True)):
        problem = ShoeGroup(SCENE, BRAKE, (index,), penalty).contact_problem_of_group
        found = active_set.solve_contact_problem(problem)
        w = problem.q + problem.A @ found.p + problem.B @ found.y
        area = body.coupling.areas_of_contact_nodes
        compression = found.p.max() * shoe.lining.thickness / shoe.lining.material.E
        assert found.p.min() >= 0
        # No node may penetrate the drum by more than p/eps.
        assert (w / area).min() > -1e-9 * compression
        assert np.abs(found.p * w / area).max() < 1e-9 * found.p.max() * compression


def test_a_clearance_opens_the_contact_and_stays_complementary():
    open_ = vary(BRAKE, {"shoe.lining.clearance": 1e-4})
    response = solve_prepared_model(SCENE, open_)
    assert max(response.balance.force, response.balance.moment) < 1e-9
    right = response.shoes[0]
    # The heel must stay off the drum, or the test would say nothing of an open end.
    assert right.contact_arcs[0][0] > math.radians(-40)
    assert right.pressure[0] == 0
    assert response.torque < solve_prepared_model(SCENE, BRAKE).torque


def test_torque_and_pressure_converge(brake):
    result = solve_on_refined_meshes(brake, (20, 40, 80, 160))
    limit = result.torque
    assert limit.uncertainty < 1e-5 * limit.value
    assert abs(result.responses[-1].torque / limit.value - 1) < 2e-6
    for shoe in (0, 1):
        steps = result.relative_pressure_distances_between_meshes(shoe)
        for a, b in pairwise(steps):
            assert b < a / 1.9
        order, error = result.pressure(shoe)
        assert order > 1.9
        assert error < 1e-3


# A kind has its number of elements, the errors of torque and of p (L2) on the finer mesh, and the
# least orders of convergence between the two meshes.
KINDS = {
    "quad2": ((20, 80), 1e-5, 3e-3, 2.0, 1.5),
    "tri2": ((20, 80), 1e-5, 8e-3, 2.0, 1.0),
    "quad1": ((20, 80), 1e-3, 7e-3, 1.5, 1.3),
    "tri1": ((20, 80), 5e-3, 3e-2, 1.2, 1.0),
}


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_mesh_converges_to_one_answer(kind, brake, fine):
    elements, *most, torque_order, pressure_order = KINDS[kind]
    errors = []
    for count in elements:
        response = solve(brake, elements=count, kind=kind, penalty=math.inf)
        assert max(response.balance.force, response.balance.moment) < 1e-9
        distances = list(
            starmap(relative_distance_of_pressures, zip(response.shoes, fine.shoes, strict=True))
        )
        errors.append([abs(response.torque / fine.torque - 1), max(distances)])
    # The order is of each number: lists compare by their first number alone.
    assert (np.array(errors[1]) < most).all()
    orders = np.log2(np.array(errors[0]) / errors[1]) / math.log2(elements[1] / elements[0])
    assert orders[0] > torque_order
    assert orders[1] > pressure_order


@pytest.fixture(scope="module")
def fine(brake):
    return solve(brake, elements=160, penalty=math.inf)


@pytest.mark.parametrize("kind", KINDS)
def test_the_fields_of_every_kind_agree(kind, brake, tmp_path):
    """Displacements of the loaded end within 5 %, and the .vtu file read back."""
    moved = []
    for chosen, elements in (("quad2", 80), (kind, 60)):
        scene = make_prepared_model(brake, elements=elements, kind=chosen)
        found = stress_and_displacement_fields_of_shoe(
            scene, brake, solve_prepared_model(scene, brake), 1
        )
        far = np.argmin(np.linalg.norm(found.points - brake.shoes[1].actuation.point.xy, axis=1))
        moved.append(found.displacement[far])
        assert np.isfinite(found.stress).all()
        assert len(np.unique(found.cells)) == len(found.points)
    assert np.linalg.norm(moved[1] - moved[0]) < 0.05 * np.linalg.norm(moved[0])
    write_fields_to_vtu_file(tmp_path / "f.vtu", [found])
    mesh = meshio.read(tmp_path / "f.vtu")
    assert picked(mesh.cells, "type") == [found.cell_type]
    assert mesh.point_data["von Mises [Pa]"] == pytest.approx(found.von_mises)


def test_shoes_of_one_shape_are_load_cases_of_one_solve(brake, monkeypatch):
    """The fields of all shoes are those of each shoe, and equal bodies are solved once."""
    scene = make_prepared_model(brake, elements=30)
    response = solve_prepared_model(scene, brake)
    apart = [stress_and_displacement_fields_of_shoe(scene, brake, response, i) for i in (0, 1)]
    assert scene.bodies[0] is scene.bodies[1]
    solved, kind = [], type(scene.bodies[0].condensed)
    solve_cases = kind.nodal_displacements_in_load_cases

    def noting_solve(*given):
        solved.append(given)
        return solve_cases(*given)

    monkeypatch.setattr(kind, "nodal_displacements_in_load_cases", noting_solve)
    together = stress_and_displacement_fields_of_shoes_and_ring(scene, brake, response)
    assert len(solved) == 1
    for one, other in zip(apart, together, strict=True):
        for name in ("displacement", "stress", "von_mises", "push"):
            value = getattr(one, name)
            assert np.abs(getattr(other, name) - value).max() <= 1e-12 * np.abs(value).max()
        assert np.array_equal(one.points, other.points)


@pytest.fixture(scope="module")
def open_heels(brake, flexible):
    """Brakes whose heels a clearance holds off, and their contact arcs on a fine mesh."""
    specs = [vary(spec, {"shoe.lining.clearance": 1e-4}) for spec in (brake, flexible)]
    return [(spec, picked(solve(spec, elements=200).shoes, "contact_arcs")) for spec in specs]


@pytest.mark.parametrize("kind", ["quad2", "tri2"])
@pytest.mark.slow
def test_contact_ends_are_located_inside_an_element(kind, open_heels):
    """Contact ends are located within a fifth of an inner element of those of a fine mesh.

    They are nearer to the true end than the last pressed node's neighbour.
    """
    errors, nodes = [], []
    for spec, true in open_heels:
        for count in (40, 50, 60, 80):
            for shoe, exact, part in zip(
                solve(spec, elements=count, kind=kind).shoes, true, spec.shoes, strict=True
            ):
                near, far = shoe.contact_arcs[0], exact[0]
                # The heel is the end of the lining next to the hinge.
                k = 0 if part.frame.sense > 0 else -1
                theta, p = shoe.theta, shoe.pressure
                first = np.flatnonzero(p > 0)[k]
                step = np.diff(theta[:: shoe.order]).max()
                errors.append((near[k] - far[k]) / step)
                nodes.append((theta[first + (-1 if k == 0 else 1)] - far[k]) / step)
                # This contact ends inside the lining.
                assert 0 < first < len(theta) - 1
    assert len(errors) == 16
    assert np.abs(errors).max() < 0.2
    assert np.linalg.norm(errors) < 0.5 * np.linalg.norm(nodes)


def test_without_friction_the_friction_path_equals_the_frictionless_one():
    still = vary(BRAKE, {"friction": 0})
    frictionless = make_prepared_model(still, elements=40)
    assert frictionless.bodies[0].flexibility.gap_closure_by_friction is None
    a, b = solve_prepared_model(SCENE, still), solve_prepared_model(frictionless, still)
    assert a.torque == b.torque == 0
    same(a, b, 1e-12)
    with pytest.raises(BadInput, match="without friction"):
        solve_prepared_model(frictionless, BRAKE)


@given(st.floats(1e-3, 1e3), st.floats(0, 0.6), st.sampled_from(ROTATIONS))
def test_times_the_force_is_times_everything(factor, friction, rotation):
    brake = vary(BRAKE, {"friction": friction, "rotation": rotation})
    more = vary(brake, {"shoe.actuation.force": BRAKE.shoes[0].actuation.force * factor})
    a, b = solve_prepared_model(SCENE, brake), solve_prepared_model(SCENE, more)
    assert b.torque == pytest.approx(factor * a.torque, rel=1e-10)
    for x, y in zip(a.shoes, b.shoes, strict=True):
        assert y.pressure == pytest.approx(
            factor * x.pressure, rel=1e-10, abs=1e-10 * factor * x.pressure.max()
        )
        assert y.hinge_reaction == pytest.approx(
            factor * x.hinge_reaction, rel=1e-10, abs=1e-7 * factor
        )
        assert y.turn == pytest.approx(factor * x.turn, rel=1e-10)


def mirrored(brake):
    """The mirror image about the y axis, rotation included."""
    shoes = []
    for shoe in brake.shoes:
        data = shoe.model_dump()
        for part in (data["lining"], data["body"]):
            part["start"], part["end"] = math.pi - part["end"], math.pi - part["start"]
        data["hinge"]["x"] *= -1
        data["actuation"]["point"]["x"] *= -1
        data["actuation"]["direction"] = math.pi - data["actuation"]["direction"]
        shoes.append(data)
    other = ROTATIONS[1 - ROTATIONS.index(brake.rotation)]
    return vary(brake, {"shoe": shoes, "rotation": other})


@settings(max_examples=10)
@given(st.floats(0, 0.6), st.floats(-0.3, 0.3), st.floats(0.02, 0.12), st.sampled_from(ROTATIONS))
def test_the_mirror_image_gives_the_mirrored_answer(friction, tilt, height, rotation):
    brake = vary(
        BRAKE,
        {
            "friction": friction,
            "rotation": rotation,
            "shoe[0].actuation.direction": tilt,
            "shoe[0].actuation.point.y": height,
        },
    )
    a, b = solve_prepared_model(SCENE, brake), solve(mirrored(brake), elements=40)
    assert b.torque == pytest.approx(a.torque, rel=1e-9)
    for x, y in zip(a.shoes, b.shoes, strict=True):
        assert y.theta == pytest.approx(math.pi - x.theta[::-1], abs=1e-9)
        assert y.pressure[::-1] == pytest.approx(x.pressure, rel=1e-8, abs=1e-9 * x.pressure.max())
        assert y.hinge_reaction * [-1, 1] == pytest.approx(x.hinge_reaction, rel=1e-8, abs=1e-5)
        assert y.turn == pytest.approx(-x.turn, rel=1e-8)
        assert y.self_energising == x.self_energising


def test_a_brake_in_mm_n_mpa_numbers_gives_the_same_numbers(brake):
    """A brake in numbers of mm, N and MPa has the same torque and pressures to round-off.

    The torque then is in N mm, the pressure in MPa.
    """
    data = brake.model_dump(by_alias=True)

    def scaled(value, key=None):
        if isinstance(value, dict):
            return {k: scaled(v, k) for k, v in value.items()}
        if isinstance(value, list | tuple):
            return [scaled(v, key) for v in value]
        lengths = {"radius", "thickness", "width", "x", "y"} if value is not None else set()
        return value * 1e3 if key in lengths else value * 1e-6 if key == "E" else value

    a, b = solve(brake, elements=40), solve(make_drum_brake_from_data(scaled(data)), elements=40)
    assert b.torque == pytest.approx(1e3 * a.torque, rel=1e-10)
    assert b.iterations == a.iterations
    for x, y in zip(a.shoes, b.shoes, strict=True):
        assert 1e6 * y.pressure == pytest.approx(x.pressure, rel=1e-9, abs=1e-9 * x.pressure.max())
        assert y.hinge_reaction == pytest.approx(x.hinge_reaction, rel=1e-9)


@pytest.mark.parametrize("name", ["brake", "flexible"])
@pytest.mark.slow
def test_the_contact_set_settles_in_15_steps_on_every_mesh_and_penalty(name, request):
    spec = request.getfixturevalue(name)
    most = ran = 0
    for elements in (10, 20, 40, 80, 160, 320):
        scene = make_prepared_model(spec, elements=elements)
        for case in (spec, vary(spec, {"shoe.lining.clearance": 5e-5})):
            torques = []
            for penalty in (1e1, 1e3, 1e6, 1e9, 1e12, math.inf):
                response = solve_prepared_model(scene, case, penalty=penalty)
                most, ran = max(most, response.iterations), ran + 1
                torques.append(response.torque)
            assert torques[2:] == pytest.approx([torques[-1]] * 4, rel=1e-6)
    assert ran == 72
    assert most <= 15


def test_the_softening_of_a_penalty_is_linear_in_it_and_as_stated():
    exact = solve_prepared_model(SCENE, BRAKE, penalty=math.inf).torque
    errors = [
        solve_prepared_model(SCENE, BRAKE, penalty=alpha).torque / exact - 1
        for alpha in (1e3, 1e4, 1e5)
    ]
    assert abs(errors[0]) < 1e-3
    assert errors[0] / errors[1] == pytest.approx(10, rel=0.02)
    assert errors[1] / errors[2] == pytest.approx(10, rel=0.02)
    for note, shoe, soft in zip(
        solve_prepared_model(SCENE, BRAKE, penalty=1e4).notes[: len(BRAKE.shoes)],
        solve_prepared_model(SCENE, BRAKE, penalty=math.inf).shoes,
        solve_prepared_model(SCENE, BRAKE, penalty=1e4).shoes,
        strict=True,
    ):
        stated = float(note.split("changes the torque by ")[1].split()[0]) / 100
        # the note gives -softening: its sign is that of the change from exact to soft
        assert stated == pytest.approx(soft.torque / shoe.torque - 1, rel=0.06)


@pytest.mark.parametrize("index", (0, 1))
def test_starts_agree(index):
    problem = ShoeGroup(
        SCENE, vary(BRAKE, {"shoe.lining.clearance": 1e-4}), (index,)
    ).contact_problem_of_group
    n = len(problem.q)
    rng = np.random.default_rng(5)
    starts = [None, np.zeros(n, bool), rng.random(n) < 0.5, rng.random(n) < 0.1]
    answers = [active_set.solve_contact_problem(problem, start) for start in starts]
    for found in answers[1:]:
        assert found.p == pytest.approx(answers[0].p, rel=1e-9, abs=1e-9 * answers[0].p.max())


def test_equal_shoes_are_condensed_once_and_it_is_said(brake):
    assert SCENE.bodies[0] is SCENE.bodies[1]
    assert saying(SCENE.left_out, "condensed once")
    other = make_prepared_model(vary(brake, {"shoe[1].lining.thickness": 0.007}), elements=10)
    assert other.bodies[0] is not other.bodies[1]


def test_a_scene_refuses_a_brake_of_other_shape(brake):
    with pytest.raises(BadInput, match="differs from the prepared scene"):
        solve_prepared_model(SCENE, vary(brake, {"shoe[0].lining.thickness": 0.007}))
    with pytest.raises(BadInput, match="elements"):
        make_prepared_model(brake, elements=0)
    for penalty in (0.0, -1.0, math.nan):
        with pytest.raises(BadInput, match="penalty"):
            solve_prepared_model(SCENE, BRAKE, penalty=penalty)


@pytest.mark.parametrize("force", [0.0, -2000.0])
def test_a_force_that_is_zero_or_pulls_the_shoe_off_is_an_answer(brake, force):
    free = vary(brake, {"shoe.actuation.force": force})
    for response in (solve_prepared_model(SCENE, free), solve_brake_by_sine_law(free)):
        assert response.torque == 0
        assert response.converged
        for shoe in response.shoes:
            assert not shoe.contact_arcs and not shoe.pressure.any()
        assert "no contact" in response.notes[0]
        assert response.shoes[0].hinge_reaction == pytest.approx(
            -free.shoes[0].actuation.force_vector
        )


@pytest.mark.parametrize("friction", [1.2, 1.5, 3.0, 20.0])
def test_a_self_locking_brake_is_refused_with_both_limits(friction):
    locked = vary(BRAKE, {"friction": friction})
    with pytest.raises(NoAnswer, match=rf"self-locking, friction {friction:g} .* mu_lock = 0.823"):
        solve_brake_by_sine_law(locked)
    with pytest.raises(
        NoAnswer, match=rf"self-locking.*friction {friction:g};.*mu_lock = .*rigid-shoe law"
    ):
        solve_prepared_model(SCENE, locked)


def test_a_rigid_shoe_locks_where_the_sine_law_does():
    rigid = vary(
        BRAKE, {"shoe.body.material.E": 2.1e15, "shoe.lining.thickness": 0.003, "friction": 0.9}
    )
    with pytest.raises(NoAnswer) as refusal:
        solve(rigid, elements=40)
    limit = float(str(refusal.value).split("mu_lock = ")[1].split()[0])
    assert limit == pytest.approx(
        self_locking_friction_of_hinged_shoe(rigid, rigid.shoes[1]), rel=5e-3
    )


def test_torque_grows_without_bound_towards_the_elastic_limit_of_self_locking():
    """The left shoe's torque grows with friction without bound towards the elastic limit.

    Beyond the limit there is no equilibrium.
    """
    torques = []
    for friction in np.arange(0.05, 3.0, 0.05):
        try:
            torques.append(
                solve_prepared_model(SCENE, vary(BRAKE, {"friction": friction})).shoes[1].torque
            )
        except NoAnswer:
            break
    assert 10 < len(torques) < 55
    assert (np.diff(torques) > 0).all()
    assert torques[-1] > 4 * torques[len(torques) // 2]


def test_a_shoe_that_turns_without_ever_touching_is_refused(brake):
    with pytest.raises(NoAnswer, match=r"turn by .* deg to touch"):
        solve_prepared_model(SCENE, vary(brake, {"shoe.lining.clearance": 0.1}))
    outside = vary(
        brake,
        {
            "shoe[0].hinge": {"x": 0.02, "y": 0.0},
            "shoe[0].lining.clearance": 0.045,
            "shoe[0].actuation.point.y": 0.1,
        },
    )
    with pytest.raises(NoAnswer, match="ever touching"):
        solve(outside, elements=20)


def test_cost_is_counted_from_the_same_run(brake):
    """Cost counts one run: ratios are finite, ordered and not absurd.

    Exact ratios are for the command `drumlin cost` to state.
    """
    c = measure_time_and_memory_of_fem(brake, elements=60, repeats=3)
    assert 1 < c.solve_time_over_sum_of_its_parts < 10
    assert 0 < c.further_solve_time_over_solve_time < 0.5


@pytest.mark.slow
def test_the_cost_table_has_a_row_a_size_and_the_exponent(brake):
    head, *rows, last = table_lines_of_cost_by_number_of_unknowns(brake, sizes=(2_000, 4_000))
    assert "memory [GiB]" in head
    # Meshes consist of whole layers of elements and meet a size only roughly.
    assert [float(row.split()[0]) for row in rows] == pytest.approx([2_000, 4_000], rel=0.4)
    # The memory is in GiB; Python and its libraries alone take 0.08.
    for row in rows:
        assert 0.05 < float(row.split()[-1]) < 2
    assert "solve ~ N^" in last


def test_an_earlier_response_is_a_start_and_not_an_answer():
    other = vary(BRAKE, {"friction": 0.1, "rotation": "clockwise"})
    same(
        solve_prepared_model(SCENE, BRAKE, start=solve_prepared_model(SCENE, other)),
        solve_prepared_model(SCENE, BRAKE),
        1e-11,
    )
    untouched = solve_prepared_model(SCENE, vary(BRAKE, {"shoe.actuation.force": 0.0}))
    same(
        solve_prepared_model(SCENE, BRAKE, start=untouched),
        solve_prepared_model(SCENE, BRAKE),
        1e-11,
    )


def test_external_shoes(brake):
    """An external brake: the law's counterpart, with the stiff limit as judge."""
    external = {
        "shoe.side": "external",
        "shoe[0].hinge": {"x": 0.045, "y": -0.168},
        "shoe[1].hinge": {"x": -0.045, "y": -0.168},
        "shoe[0].actuation.direction": math.pi,
        "shoe[1].actuation.direction": 0.0,
        "shoe.body.material.E": 2.1e15,
        "shoe.lining.thickness": 0.003,
    }
    for rotation in ROTATIONS:
        spec = vary(brake, {**external, "rotation": rotation})
        law, fem = solve_brake_by_sine_law(spec), solve(spec, elements=80)
        for a, b in zip(law.shoes, fem.shoes, strict=True):
            assert b.torque == pytest.approx(a.torque, rel=3e-3)
            assert b.self_energising == a.self_energising
            assert relative_distance_of_pressures(a, b, math.radians(6)) < 0.01
