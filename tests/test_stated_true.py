"""Stated against true errors: what counts, and that a response that lies is seen."""

import math
from dataclasses import replace
from itertools import islice
from types import MappingProxyType

import numpy as np
import pytest

from conftest import partly
from drumlin import NoAnswer, vary
from drumlin.fem.error_control.adapt import (
    TolerancesOfPressureAndTorque,
    errors_with_singular_points_and_text_on_short_contacts,
    solve_brake_to_tolerance,
)
from drumlin.fem.error_control.estimate import (
    SAFETY_FACTOR_OF_PENALTY_ERROR,
    SAFETY_FACTORS_OF_ERROR_ESTIMATE,
    EstimatedErrors,
    estimate_errors_from_two_mesh_levels,
    sum_of_penalty_and_round_off_errors,
)
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE as COLUMNS
from drumlin.fem.error_control.levels import SolvedLevel, solve_brake_on_finer_and_finer_mesh_levels
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin.response.norms import relative_distance_of_pressures
from drumlin.response.response import (
    ZERO_CHANGES_OF_SHOE_RESULTS,
    RelativeChangesOfShoeResults,
    reference_force_of_reaction_errors,
)
from drumlin.response.resultants import integral_of_piecewise_polynomial, planar_cross_product
from drumlin.verification.triangles import (
    DegreeAndGradingOfTriangleMesh,
    solve_brake_on_sequence_of_triangle_meshes,
)
from drumlin_studies import stated_true
from drumlin_studies.calibration import draw_random_calibration_brake_and_name_of_kind
from drumlin_studies.random_brake import (
    FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND,
    draw_random_brake,
)
from drumlin_studies.stated_true import (
    QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED,
    SMALLEST_RELEVANT_TRUE_ERROR,
    FarFinerSolutionOfBrake,
    estimate_distance_of_last_value_from_limit,
    row_of_stated_and_true_errors,
    solve_fine_reference_by_hp_elements,
    stated_over_true_error_of_row,
    summary_rows_of_stated_errors,
    true_errors_of_response,
)
from drumlin_studies.stored_truth import solve_brake_by_finer_hp_meshes
from picking import keyed, picked
from shared_parts import scaled_pressures

LEVELS = (
    DegreeAndGradingOfTriangleMesh(3, 5, 1.4, 1.0),
    DegreeAndGradingOfTriangleMesh(4, 7, 1.2, 1.0),
)


@pytest.fixture(scope="module")
def truth(brake):
    before, last = solve_brake_on_sequence_of_triangle_meshes(brake, LEVELS)
    return FarFinerSolutionOfBrake(
        last, MappingProxyType(true_errors_of_response(brake, before, last)), 0.0
    )


@pytest.mark.parametrize(
    "kind",
    partly(FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND, {"linings on ring", "post on ring"}),
)
def test_a_brake_of_each_kind_is_drawn_again_by_its_seed(kind):
    brake = draw_random_brake(5, kind)
    assert brake == draw_random_brake(5, kind)
    assert brake != draw_random_brake(6, kind)
    assert (brake.ring is not None) == ("ring" in kind)
    for shoe in solve(brake, elements=12).shoes:
        assert shoe.contact_arcs


def test_the_kinds_follow_each_other_by_seed():
    assert [draw_random_brake(seed).title for seed in range(3)] == [
        f"random {kind} {i}" for i, kind in enumerate(FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND)
    ][:3]


def test_what_a_response_states_is_held_against_the_truth(brake, truth):
    coarse = solve(brake, elements=12)
    stated = dict.fromkeys(QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED, 1e-2)
    seen = row_of_stated_and_true_errors(
        brake, 1e-2, lambda brake, tolerance: replace(coarse, error=stated), truth
    )
    assert seen["outcome"] == "reached"
    off = true_errors_of_response(brake, coarse.shoes, truth.shoes)
    assert {name: seen[f"true_{name}"] for name in QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED} == off
    torque = sum(picked(truth.shoes, "torque"))
    assert off["torque"] == pytest.approx(abs(coarse.torque - torque) / torque)
    assert 1e-3 < off["pressure"] < 0.1
    liar = row_of_stated_and_true_errors(
        brake,
        1e-2,
        lambda brake, tolerance: replace(
            coarse, error=dict.fromkeys(QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED, 1e-9)
        ),
        truth,
    )
    assert stated_over_true_error_of_row(liar, "pressure") < 1e-5
    table = keyed(summary_rows_of_stated_errors([seen, liar]), "quantity")
    assert table["pressure"]["above"] == pytest.approx(0.5 + 0.5 * (off["pressure"] > 1e-2))
    assert table["pressure"]["judged"] == 2 and table["pressure"][
        "smallest"
    ] == stated_over_true_error_of_row(liar, "pressure")


def test_the_relevant_median_leaves_out_errors_that_nobody_asks_for():
    def judged(true):
        quantities = {"pressure": 1e-3, "torque": true, "peak": 1e-3, "reaction": 1e-3}
        return {"tolerance": 1e-2, "outcome": "reached"} | {
            f"{what}_{name}": value
            for name, value in quantities.items()
            for what, value in (("stated", 4e-6), ("true", value), ("unsure", 0.0))
        }

    rows = [
        judged(true)
        for true in (
            2 * SMALLEST_RELEVANT_TRUE_ERROR,
            SMALLEST_RELEVANT_TRUE_ERROR,
            0.01 * SMALLEST_RELEVANT_TRUE_ERROR,
            0.01 * SMALLEST_RELEVANT_TRUE_ERROR,
        )
    ]
    torque = keyed(summary_rows_of_stated_errors(rows), "quantity")["torque"]
    assert torque["median_relevant"] == pytest.approx(3.0)
    assert torque["median"] == pytest.approx(202.0)


def test_a_known_shift_of_the_pressure_is_the_error(brake, truth):
    shifted = scaled_pressures(truth.shoes, 1.01)
    off = true_errors_of_response(brake, shifted, truth.shoes)
    assert off["pressure"] == pytest.approx(0.01, rel=1e-9)
    assert off["peak"] == pytest.approx(0.01, rel=1e-9)
    assert off["torque"] == off["reaction"] == 0


def test_what_fails_stays_in_the_table(brake, truth):
    def refuse(brake, tolerance):
        raise NoAnswer("tolerance 0.01 not reached")

    def stumble(brake, tolerance):
        raise ValueError("no")

    rows = [
        row_of_stated_and_true_errors(brake, 1e-2, refuse, truth),
        row_of_stated_and_true_errors(brake, 1e-2, stumble, truth),
    ]
    assert picked(rows, "outcome") == ["not reached", "failed"]
    rows.append(
        row_of_stated_and_true_errors(
            brake, 1e-2, lambda brake, tolerance: solve(brake, elements=12), None, "singular"
        )
    )
    assert rows[-1]["outcome"] == "no truth" and rows[-1]["reason"] == "singular"
    assert set(picked(summary_rows_of_stated_errors(rows), ("brakes", "reached", "judged"))) == {
        (2, 0.0, 0)
    }


def test_uncertainty_of_a_sequence():
    assert estimate_distance_of_last_value_from_limit(4.0, 1.0) == pytest.approx(1 / 3)
    assert estimate_distance_of_last_value_from_limit(100.0, 1.0) == pytest.approx(1 / 3)
    assert estimate_distance_of_last_value_from_limit(1.0, 1.0) == 1.0
    assert estimate_distance_of_last_value_from_limit(1.0, 0.0) == 0.0
    assert math.isnan(
        stated_over_true_error_of_row(
            {"stated_torque": math.nan, "true_torque": 1.0, "unsure_torque": 0.0}, "torque"
        )
    )
    assert np.isinf(
        stated_over_true_error_of_row(
            {"stated_torque": 1e-3, "true_torque": 1e-6, "unsure_torque": 2e-6}, "torque"
        )
    )


def test_an_estimate_is_a_factor_of_the_last_step_and_what_lies_beside_it(brake):
    response = solve(brake, elements=10)

    def with_torque(part, **more):
        beside = {
            "softness": ZERO_CHANGES_OF_SHOE_RESULTS,
            "lost": ZERO_CHANGES_OF_SHOE_RESULTS,
        } | more
        shoes = (replace(shoe, torque=shoe.torque * part, **beside) for shoe in response.shoes)
        return replace(response, shoes=tuple(shoes))

    def stated(**more):
        return estimate_errors_from_two_mesh_levels(
            brake, with_torque(1.001), with_torque(1.0, **more)
        ).brake

    step = SAFETY_FACTORS_OF_ERROR_ESTIMATE.force * 1e-3
    assert stated()["torque"] == pytest.approx(step)
    assert stated()["pressure"] == 0.0
    yielding = stated(softness=RelativeChangesOfShoeResults(1.0, 1e-3, 1.0))
    assert yielding["torque"] == pytest.approx(step + SAFETY_FACTOR_OF_PENALTY_ERROR * 1e-3)
    # This part of the answer does not differ at all.
    assert yielding["pressure"] == 0.0
    rounded = stated(lost=RelativeChangesOfShoeResults(1.0, 1e-3, 1.0))
    assert rounded["torque"] == pytest.approx(step + 1e-3)


@pytest.fixture(scope="module")
def level(brake):
    return solve_prepared_model(make_prepared_model(brake, COLUMNS[0]), brake, penalty=math.inf)


def shifted(response, by):
    """The response with the pressures of its shoes changed by parts of them, and nothing else."""
    shoes = [replace(shoe, pressure=(1 + by(shoe)) * shoe.pressure) for shoe in response.shoes]
    return replace(response, shoes=tuple(shoes))


def test_forces_that_agree_by_chance_are_as_uncertain_as_the_columns_of_the_pressure(brake, level):
    """Forces that agree by chance are as uncertain as the columns of the pressure.

    Torques and reactions of two levels are equal though each column of p changes them, up and down
    in turn.
    """

    def turns(shoe):
        column, inside = np.divmod(np.arange(len(shoe.theta)), shoe.order)
        return 1e-2 * (inside > 0) * (-1.0) ** column

    before, parts = shifted(level, turns), []
    found = estimate_errors_from_two_mesh_levels(brake, before, level)
    for a, b, own in zip(before.shoes, level.shoes, found.shoes, strict=True):
        column = np.arange(len(b.theta)) // b.order
        off = [
            integral_of_piecewise_polynomial(
                b.theta, np.where(column == k, a.pressure - b.pressure, 0.0), b.order
            )
            for k in set(column)
        ]
        least = (
            SAFETY_FACTORS_OF_ERROR_ESTIMATE.cancelled
            * math.hypot(*off)
            / integral_of_piecewise_polynomial(b.theta, b.pressure, b.order)
        )
        assert own["torque"] == pytest.approx(least, rel=1e-3) and least > 1e-6
        assert own["reaction"] == pytest.approx(
            least * b.normal_force / math.hypot(*b.hinge_reaction), rel=1e-3
        )
        parts.append(least * b.torque / level.torque)
    assert found.brake["torque"] == pytest.approx(sum(parts), rel=1e-3)


def test_a_peak_that_agrees_by_chance_is_as_uncertain_as_the_pressure_near_it(brake, level):
    """A peak that agrees by chance is as uncertain as the pressure near it.

    Its error is the mean of this uncertainty and of the distance in L2; columns away from the peak
    do not matter.
    """

    def heights(shoe):
        column, inside = np.divmod(np.arange(len(shoe.theta)), shoe.order)
        return np.array([shoe.pressure[column == k].max() for k in range(column[-1] + 1)])[
            column
        ], inside

    def high(shoe):
        highest, _ = heights(shoe)
        return 1e-3 * (highest == highest.max())

    def low(shoe):
        highest, inside = heights(shoe)
        return 1e-3 * (highest < highest.max()) * (inside > 0)

    middle = level.shoes[0]
    # The peak lies inside the lining and not at its end.
    assert middle.pressure.max() == pytest.approx(middle.peak_pressure, rel=0.05)
    for by, near in ((high, 1e-3), (low, 0.0)):
        before = shifted(level, by)
        own = estimate_errors_from_two_mesh_levels(brake, before, level).shoes[0]
        p = relative_distance_of_pressures(before.shoes[0], middle)
        assert p > 1e-6
        assert own["peak"] == pytest.approx(
            SAFETY_FACTORS_OF_ERROR_ESTIMATE.peak * math.sqrt(p * near), rel=0.1
        )


def test_the_shortest_contact_of_a_shoe_counts(brake):
    """Of two levels whose one torque moves by 1e-3; one contact of two is a nanometre long."""
    made = make_prepared_model(brake, COLUMNS[0])
    found = solve_prepared_model(made, brake, penalty=math.inf)
    one, other = found.shoes
    before = replace(found, shoes=(replace(one, torque=1.001 * one.torque), other))
    last = one.theta[one.pressure > 0][-1]
    arcs = (one.theta[0], last - 0.1), (last - 1e-8, last)

    def error(last):
        along = [SolvedLevel(made, before), SolvedLevel(made, last)]
        return solve_brake_to_tolerance(
            brake,
            TolerancesOfPressureAndTorque(0.5, 0.5),
            solve_prepared_model,
            must=False,
            levels=along,
        ).response.error

    assert error(found)["torque"] == pytest.approx(
        SAFETY_FACTORS_OF_ERROR_ESTIMATE.force * 1e-3 * one.torque / found.torque, rel=1e-3
    )
    assert error(found)["pressure"] < 1e-3
    assert error(replace(found, shoes=(replace(one, contact_arcs=arcs), other)))["pressure"] >= 1


def test_errors_of_two_shoes_torques_do_not_cancel(brake):
    """Errors of two shoes' torques do not cancel.

    One loses what the other gains, so that the brake's torque does not move: the next level may
    undo the balance.
    """
    last = solve(brake, elements=10)
    gained = [
        replace(shoe, torque=shoe.torque + off)
        for shoe, off in zip(last.shoes, (5.0, -5.0), strict=True)
    ]
    before = replace(last, shoes=tuple(gained))
    assert before.torque == pytest.approx(last.torque)
    for series in ([before, last], [last, before]):
        assert estimate_errors_from_two_mesh_levels(brake, *series).brake[
            "torque"
        ] == pytest.approx(SAFETY_FACTORS_OF_ERROR_ESTIMATE.force * 10.0 / last.torque, rel=1e-4)


@pytest.mark.slow
def test_a_peak_in_the_column_at_a_pressed_end_is_not_known():
    """A peak in the column at a pressed end is unknown.

    A post presses with its lining's end: p grows there without bound from level to level, beside
    the last node.
    """
    brake = draw_random_brake(488)
    found = list(islice(solve_brake_on_finer_and_finer_mesh_levels(brake, solve_prepared_model), 3))
    peaks = [step.response.shoes[0].peak_pressure for step in found]
    assert peaks[0] < 0.96 * peaks[1] < 0.96**2 * peaks[2]
    for some in (found[:2], found):
        assert not math.isclose(some[-1].response.shoes[0].pressure[-1], peaks[len(some) - 1])
        stated = solve_brake_to_tolerance(
            brake,
            TolerancesOfPressureAndTorque(1e-9, 1e-9),
            solve_prepared_model,
            must=False,
            levels=some,
        ).response
        assert stated.shoes[0].error["peak"] == stated.error["peak"] == 1.0


@pytest.mark.parametrize("index", range(2))
def test_the_penalty_changes_torque_and_pressure_as_a_response_says(brake, index):
    # On one division: columns that follow the contact of each would change p as well.
    level = make_prepared_model(brake, COLUMNS[2])
    firm, soft = (
        solve_prepared_model(level, brake, penalty=each).shoes[index] for each in (math.inf, 1e3)
    )
    assert abs(soft.torque / firm.torque - 1) == pytest.approx(soft.softness.torque, rel=0.02)
    assert relative_distance_of_pressures(soft, firm) == pytest.approx(
        soft.softness.pressure, rel=0.05
    )
    assert soft.softness.torque > 1e-9 and firm.softness == ZERO_CHANGES_OF_SHOE_RESULTS


@pytest.mark.parametrize("penalty", [30.0, 1.0, 0.1, 1e-3])
def test_what_a_soft_contact_changes_is_stated(brake, penalty):
    """The error of a soft contact is stated, down to a thousandth of the lining's stiffness.

    The pressure of the softest contact hardly depends on it any more.
    """
    level = make_prepared_model(brake, COLUMNS[2])
    firm, soft = (
        solve_prepared_model(level, brake, penalty=each).shoes for each in (math.inf, penalty)
    )
    for a, b in zip(soft, firm, strict=True):
        reaction = float(
            np.hypot(*(a.hinge_reaction - b.hinge_reaction)) / np.hypot(*b.hinge_reaction)
        )
        true = relative_distance_of_pressures(a, b), abs(a.torque / b.torque - 1), reaction
        if penalty == 30:
            np.testing.assert_allclose(a.softness[:3], true, rtol=0.1)
        assert (
            true[0] < SAFETY_FACTOR_OF_PENALTY_ERROR * a.softness.pressure
            and true[2] < SAFETY_FACTOR_OF_PENALTY_ERROR * a.softness.reaction
        )


def test_what_a_soft_contact_changes_of_a_post_is_stated_too():
    """Of its pressure it changes a third more than to first order."""
    brake = draw_random_brake(300_501, "post")
    level = make_prepared_model(brake, COLUMNS[1])
    firm, soft = (
        solve_prepared_model(level, brake, penalty=math.inf),
        solve_prepared_model(level, brake, penalty=10.0),
    )
    true = relative_distance_of_pressures(soft.shoes[0], firm.shoes[0])
    assert true > 1e-2
    assert sum_of_penalty_and_round_off_errors(soft.shoes)[1] > true


def test_a_shoe_without_reaction_has_a_torque(brake):
    """A shoe without a reaction has a torque of the usual certainty.

    Its actuation aims along the resultant of the contact, so that the pin bears no load.
    """
    single = vary(brake.model_copy(update={"shoes": brake.shoes[:1]}), {"shoe.body": None})
    for _ in range(4):
        found = solve(single, penalty=math.inf)
        (shoe,), pin, at = single.shoes, single.shoes[0].pin.xy, single.shoes[0].actuation.point.xy
        force, reaction = shoe.actuation.force_vector, found.shoes[0].hinge_reaction
        contact = -(force + reaction)
        moment = -(planar_cross_product(at, force) + planar_cross_product(pin, reaction))
        point = moment * np.array([contact[1], -contact[0]]) / (contact @ contact)
        aim = -contact / np.hypot(*contact)
        place = {"x": point[0], "y": point[1]}
        new = {"direction": math.atan2(aim[1], aim[0]), "point": place, "force": 1e3}
        single = vary(single, {"shoe[0].actuation": new})
    assert np.hypot(*reaction) < 1e-6 * found.shoes[0].normal_force
    assert found.notes[-1].startswith("solved on 2 meshes")
    fine = solve(single, penalty=math.inf, tolerance=1e-4)
    assert abs(found.torque / fine.torque - 1) < found.error["torque"] <= 1e-4
    assert found.error["torque"] == found.shoes[0].error["torque"]


def test_columns_are_a_truth_that_triangles_share(brake, truth):
    """Columns and triangles agree on the truth to twice their uncertainties.

    Both see the error of a coarse answer.
    """
    finer = solve_fine_reference_by_hp_elements(brake, 1e-2)
    apart = true_errors_of_response(brake, finer.shoes, truth.shoes)
    for name in QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED:
        assert apart[name] <= 2 * (finer.unsure[name] + truth.unsure[name])
    coarse = solve(brake, elements=12)
    one, other = (
        true_errors_of_response(brake, coarse.shoes, true.shoes)["pressure"]
        for true in (finer, truth)
    )
    assert one == pytest.approx(other, rel=0.1)


def test_columns_that_lost_digits_are_no_truth_beyond_them(brake, monkeypatch):
    """Neighbouring levels may agree by chance where both have lost more."""

    def losing(brake, respond):
        for made, found in solve_brake_on_finer_and_finer_mesh_levels(brake, respond):
            shoes = tuple(
                replace(shoe, lost=RelativeChangesOfShoeResults(1e-4, 2e-4, 3e-4))
                for shoe in found.shoes
            )
            yield SolvedLevel(made, replace(found, shoes=shoes))

    sure = solve_fine_reference_by_hp_elements(brake, 1e-2).unsure
    monkeypatch.setattr(stated_true, "solve_brake_on_finer_and_finer_mesh_levels", losing)
    lost = {"pressure": 1e-4, "torque": 2e-4, "peak": 1e-4, "reaction": 3e-4}
    for name, value in solve_fine_reference_by_hp_elements(brake, 1e-2).unsure.items():
        assert value == pytest.approx(sure[name] + lost[name], rel=1e-4)


@pytest.mark.slow
def test_a_level_that_moves_away_again_is_no_truth(brake, monkeypatch):
    """A level that moves away again is no truth.

    The finest columns of a post with a ring lose digits, and p gets a spike where the lining is
    open. On a small contact one level moves p as far as the level before, and the next ones bring
    it back.
    """

    def straying(last):
        def some(brake, respond):
            for k, (made, found) in enumerate(
                solve_brake_on_finer_and_finer_mesh_levels(brake, respond)
            ):
                shoes = scaled_pressures(found.shoes, 1.1 ** (k - 2))
                yield SolvedLevel(made, replace(found, shoes=shoes) if 3 <= k <= last else found)

        return some

    before, sure = (
        solve_fine_reference_by_hp_elements(brake, 1e-2),
        solve_fine_reference_by_hp_elements(brake, 1e-5),
    )
    monkeypatch.setattr(stated_true, "solve_brake_on_finer_and_finer_mesh_levels", straying(9))
    for own, other in zip(
        solve_fine_reference_by_hp_elements(brake, 1e-5).shoes, before.shoes, strict=True
    ):
        np.testing.assert_array_equal(own.pressure, other.pressure)
    monkeypatch.setattr(stated_true, "solve_brake_on_finer_and_finer_mesh_levels", straying(3))
    home = solve_fine_reference_by_hp_elements(brake, 1e-5)
    assert (
        true_errors_of_response(brake, home.shoes, sure.shoes)["pressure"]
        < 2 * sure.unsure["pressure"]
    )


def test_a_peak_at_an_end_of_the_lining_is_unbounded_and_so_is_its_error():
    """A lining that bears at its ends alone: finer columns raise the peak there without end."""
    (shoe,) = solve(draw_random_brake(1)).shoes
    assert shoe.peak_pressure == pytest.approx(max(shoe.pressure[0], shoe.pressure[-1]), rel=1e-9)
    assert shoe.error["peak"] == 1.0 and shoe.error["pressure"] < 5e-3


@pytest.mark.slow
@pytest.mark.parametrize("tip", [True, False])
def test_a_peak_under_a_tip_of_the_gap_is_unbounded_and_so_is_its_error(brake, tip):
    """A peak under a tip of the gap is unbounded and so is its error.

    Where a table of clearances has a kink towards the drum p grows as under a wedge: as the
    logarithm of the columns' size.
    """
    (shoe, *_), gap = brake.shoes, 1e-4
    middle, ends = shoe.lining.middle, (shoe.lining.start, shoe.lining.end)
    rows = ((ends[0], gap), (middle, 0.0 if tip else gap), (ends[1], gap))
    kinked = vary(brake, {"shoe[0].lining.clearance": rows})
    rough, fine = solve(kinked, tolerance=1e-2).shoes[0], solve(kinked, tolerance=1e-3).shoes[0]
    if tip:
        assert fine.peak_pressure > 1.02 * rough.peak_pressure
        assert rough.error["peak"] == fine.error["peak"] == 1.0 and rough.error["pressure"] < 1e-2
        with pytest.raises(
            NoAnswer,
            match=r"not reached on 3 .* p is unbounded at .* or a tip of the gap of '\w+'$",
        ):
            solve_brake_to_tolerance(
                kinked,
                TolerancesOfPressureAndTorque(1e-6, 1e-6),
                solve_prepared_model,
                levels=list(
                    islice(
                        solve_brake_on_finer_and_finer_mesh_levels(kinked, solve_prepared_model), 3
                    )
                ),
            )
    else:
        assert abs(fine.peak_pressure / rough.peak_pressure - 1) < rough.error["peak"] < 0.1


@pytest.mark.parametrize(("part", "unknown"), [(0.6, 1.0), (0.4, 0.0)])
def test_a_peak_that_finer_columns_may_find_at_an_end_is_unknown_before(part, unknown):
    """A peak that finer columns may find at a pressed end is unknown before they do.

    At such an end p grows from level to level: it will be the largest once it is over half of the
    largest now.
    """
    brake = draw_random_brake(4334, "arc")
    *_, last = islice(solve_brake_on_finer_and_finer_mesh_levels(brake, solve_prepared_model), 2)
    (shoe,) = last.response.shoes
    at_start = shoe.pressure[0] > shoe.pressure[-1]
    first, last_column = slice(0, shoe.order + 1), slice(-shoe.order - 1, None)
    lower = shoe.pressure.copy()
    lower[first] = lower[last_column] = 0.0
    highest = float(lower.max())
    lower[first if at_start else last_column] = part * highest
    lowered = replace(shoe, pressure=lower, peak_pressure=highest)
    nothing = EstimatedErrors.brake_errors_from_torque_and_shoe_errors(
        0.0, [dict.fromkeys(QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED, 0.0)]
    )
    error, _ = errors_with_singular_points_and_text_on_short_contacts(
        nothing, brake, replace(last.response, shoes=(lowered,))
    )
    assert error.brake["peak"] == unknown


def test_errors_of_a_reaction_that_vanishes_are_parts_of_the_force_of_the_contact():
    assert reference_force_of_reaction_errors(np.array([3.0, 4.0]), 1e3) == 5.0
    assert reference_force_of_reaction_errors(np.array([3e-9, 4e-9]), 1e3) == pytest.approx(1e-3)
    assert reference_force_of_reaction_errors(np.zeros(2), 0.0) == 1.0


def test_a_shoe_that_loses_its_contact_moves_the_torque_by_all_of_it(brake, level):
    one, other = level.shoes
    lifted = replace(other, torque=0.0, pressure=0.0 * other.pressure, contact_arcs=())
    stated = estimate_errors_from_two_mesh_levels(brake, level, replace(level, shoes=(one, lifted)))
    assert stated.brake["torque"] == pytest.approx(
        SAFETY_FACTORS_OF_ERROR_ESTIMATE.force * other.torque / one.torque, rel=1e-9
    )


def test_p_near_its_peak_beside_a_tip_of_the_gap_leaves_the_peak_unknown(brake):
    """Coarse levels find the peak elsewhere, finer ones under the tip, and higher."""
    (start, end), g = (brake.shoes[0].lining.start, brake.shoes[0].lining.end), 2.7e-5
    table = [(start, g), (start + 0.3 * (end - start), 0.0), (end, 0.7 * g / 0.3)]
    tipped = vary(brake, {"shoe[0].lining.clearance": table})
    rough, fine = solve(tipped, tolerance=1e-2).shoes[0], solve(tipped, tolerance=1e-3).shoes[0]
    assert rough.error["peak"] == fine.error["peak"] == 1.0
    assert rough.pressure_at(np.array([table[1][0]])) < 0.99 * rough.peak_pressure
    assert fine.peak_pressure > 1.02 * rough.peak_pressure


@pytest.mark.parametrize(
    ("where", "height", "known"),
    partly([(0.15, 1e-5, False), (0.3, 1e-5, True), (0.5, 2e-5, True)], {(0.15, 1e-5, False)}),
)
def test_the_peak_is_known_where_no_column_under_a_tip_could_bear_more(brake, where, height, known):
    """At 0.15 of the lining p under the tip is 0.67 of the peak on the second level and 0.79 on the
    third, with no end. Where the peak is known, answers that are far finer have the same.
    """
    start, end = brake.shoes[0].lining.start, brake.shoes[0].lining.end
    tip = start + where * (end - start)
    table = [(start, height), (tip, 0.0), (end, (1 - where) * height / where)]
    tipped = vary(brake, {"shoe[0].lining.clearance": table})
    found = solve(tipped).shoes[0]
    assert (found.error["peak"] < 0.01) == known
    if known:
        fine = solve(tipped, tolerance=1e-4).shoes[0]
        off = abs(found.peak_pressure / fine.peak_pressure - 1)
        assert off < found.error["peak"] and fine.error["peak"] < 1e-4


def test_a_table_of_clearances_that_ends_with_the_lining_has_no_tip_there(brake):
    """Its gap rises from the lining's end on, which bears; the peak away from there is known."""
    shoe = brake.shoes[0].lining
    table = [(shoe.start, 0.0), (shoe.start + 0.3, 2e-5), (shoe.end, 2e-5)]
    found = solve(vary(brake, {"shoe[0].lining.clearance": table})).shoes[0]
    assert found.pressure[0] > found.peak_pressure and found.error["peak"] < 0.05


@pytest.mark.slow
def test_a_reaction_that_two_levels_share_by_accident_is_not_stated_as_sure():
    """The reaction moves from the first to the second level by less than it is off.

    Most of its stated error is the fraction `cancelled` of what chance signs would move it by.
    """
    _, hinged = draw_random_calibration_brake_and_name_of_kind(300_259)
    truth = solve_brake_by_finer_hp_meshes(hinged)
    off = true_errors_of_response(hinged, solve(hinged).shoes, truth.shoes)["reaction"]
    before, last = (
        step.response
        for step in islice(
            solve_brake_on_finer_and_finer_mesh_levels(hinged, solve_prepared_model), 2
        )
    )
    stated = estimate_errors_from_two_mesh_levels(hinged, before, last)
    by_step = estimate_errors_from_two_mesh_levels(
        hinged, before, last, SAFETY_FACTORS_OF_ERROR_ESTIMATE._replace(cancelled=0.0)
    )
    assert by_step.brake["reaction"] < 0.5 * off
    assert stated.brake["reaction"] > off - truth.unsure["reaction"]
