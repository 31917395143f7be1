"""What once gave a wrong number, or none where there is one: each case stays here."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

import drumlin
from drumlin import BadInput, NoAnswer, vary
from drumlin.brake.file import make_validated_brake_part
from drumlin.brake.plane_brake import FlatBrake, read_drum_or_plane_brake
from drumlin.fem import model as fem_model
from drumlin.fem.error_control import levels
from drumlin.fem.mesh.file import write_shoe_mesh_to_file
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.response.balance import largest_imbalance_among_shoes, relative_imbalance_of_shoe
from drumlin.response.norms import relative_distance_of_pressures
from drumlin.response.response import ForceAndMomentImbalance, Response, ShoeResponse
from drumlin.response.resultants import (
    LiningWithoutEndZones,
    gauss_lobatto_points,
    length_of_edge_zone_left_out_of_pressure_errors,
    planar_cross_product,
)
from drumlin_studies.fuzzing.endings import describe_fault_of_run, run_input_in_this_process
from drumlin_studies.fuzzing.inputs import FilesAndCommandLineOfBrokenInput, content_of_brake_file
from drumlin_studies.textbook_brakes import brake_with_one_hinged_shoe
from picking import picked, saying


def _pressing(pressure):
    """A response over 1 rad with these nodal pressures [Pa], linear between them."""
    theta = np.linspace(0, 1, len(pressure))
    arcs = ((0.0, 1.0),)
    return ShoeResponse(
        "s", 1.0, 1.0, False, 1.0, np.zeros(2), arcs, theta, np.array(pressure, float), order=1
    )


def test_a_distance_of_pressures_is_never_nan():
    nothing, even, spike = _pressing([0] * 1001), _pressing([1] * 1001), _pressing([1] + [0] * 1000)
    assert relative_distance_of_pressures(nothing, nothing) == 0
    assert relative_distance_of_pressures(even, nothing) == math.inf
    assert relative_distance_of_pressures(nothing, even) == pytest.approx(1)
    # The spike lies in the zone that is left out: then the whole lining counts. Int (1 - spike)^2
    # over Int spike^2.
    h = 1e-3
    assert relative_distance_of_pressures(even, spike) == pytest.approx(
        math.sqrt((h / 3 + 1 - h) / (h / 3)), rel=1e-9
    )


def test_an_answer_that_is_not_finite_is_none():
    with pytest.raises(NoAnswer, match="not finite"):
        Response("fem", (_pressing([1, math.nan, 1]),), ForceAndMomentImbalance(0.0, 0.0))


def test_a_contact_within_the_lining_s_end_has_a_peak_pressure(brake):
    """Of 50 N on a lining whose clearance leaves only its last 0.02 deg."""
    gap = [["-70 deg", "1 mm"], ["54.98 deg", "1 mm"], ["55 deg", "0 mm"]]
    response = drumlin.solve(
        vary(brake, {"shoe[0].lining.clearance": gap, "shoe.actuation.force": "50 N"}), elements=40
    )
    assert response.shoes[0].peak_pressure == response.shoes[0].pressure.max() > 1e7
    assert saying(response.notes, "the lining is strained")


def corner(gap, force):
    """The main brake whose right shoe presses at its lining's end alone, and mu N R [N m].

    The shoe stands off by `gap` 0.2 deg before this end.
    """
    brake = drumlin.read_brake("studies/double_shoe/brake.toml")
    table = [["-70 deg", "1 mm"], ["54.8 deg", gap], ["55 deg", "0 mm"]]
    brake = vary(brake, {"shoe[0].lining.clearance": table, "shoe[0].actuation.force": force})
    shoe, R = brake.shoes[0], brake.size
    out = np.array([math.cos(shoe.lining.end), math.sin(shoe.lining.end)])
    per_normal = planar_cross_product(
        R * out - shoe.pin.xy, brake.friction * np.array([-out[1], out[0]]) - out
    )
    normal = (
        -planar_cross_product(shoe.actuation.point.xy - shoe.pin.xy, shoe.actuation.force_vector)
        / per_normal
    )
    return brake, brake.friction * float(normal) * R


SHORT = pytest.mark.parametrize(
    ("gap", "force", "length"), [("20 um", "5 N", 0.02), ("100 um", "50 N", 0.04)]
)


@SHORT
@pytest.mark.slow
def test_a_contact_within_some_hundredths_of_a_degree_of_the_end_is_known(gap, force, length):
    """Strained by 2 and 8 %; errors were 10 and 4 %. The moment about the pin gives the torque."""
    brake, torque = corner(gap, force)
    response = drumlin.solve(brake)
    ((start, end),) = np.degrees(response.shoes[0].contact_arcs)
    assert 0.5 * length < end - start < length
    assert response.shoes[0].torque == pytest.approx(torque, rel=math.radians(length))
    assert not saying(response.notes, "not reached")
    assert response.shoes[0].error["pressure"] < 5e-3 and response.shoes[0].error["peak"] < 5e-3


@pytest.mark.slow
@SHORT
def test_such_a_contact_is_known_as_well_as_it_says(gap, force, length):
    brake, _ = corner(gap, force)
    with pytest.raises(NoAnswer, match=r"the penalty makes .* of it; a larger penalty"):
        drumlin.solve(brake, tolerance=1e-3, penalty=1e5)
    one, finer = (drumlin.solve(brake, tolerance=tolerance).shoes[0] for tolerance in (5e-3, 1e-3))
    assert relative_distance_of_pressures(one, finer) < one.error["pressure"] < 5e-3
    assert abs(one.peak_pressure / finer.peak_pressure - 1) < one.error["peak"]


@pytest.mark.parametrize(("force", "um"), [("5 N", "0.1"), ("0.2 N", "0.004")])
def test_of_a_contact_too_short_to_be_seen_the_torque_is_known_and_the_pressure_is_not(
    monkeypatch, force, um
):
    """The error of its pressure is all of it, whatever two meshes agree on.

    No work is spent on this pressure: no division looks for the ends of the contact again, and the
    full system is not refined for the digits that round-off takes from p.
    """
    divided = []

    def counted(*given, **options):
        divided.append(given)
        return make_prepared_model(*given, **options)

    monkeypatch.setattr(levels, "make_prepared_model", counted)
    monkeypatch.setattr(fem_model, "solve_full_system_of_group_by_refinement", None)
    brake, torque = corner("10 mm", force)
    response = drumlin.solve(brake, model_error=False)
    assert len(divided) == 2
    assert response.shoes[0].torque == pytest.approx(torque, rel=1e-5)
    error = response.shoes[0].error
    assert error["torque"] < 1e-3 and error["reaction"] < 1e-2
    assert min(error["pressure"], error["peak"]) >= 1
    assert saying(
        response.notes,
        f"shoe 'right': its contact is {um} um long, too short to know its pressure",
    )
    with pytest.raises(NoAnswer, match="too short to know its pressure"):
        drumlin.solve(brake, tolerance=1e-2)


def test_a_short_contact_in_the_middle_of_a_lining_is_not_said_to_be_at_its_end():
    crowned = {"shoe.lining.misfit": {"radius": "165 mm"}, "shoe.actuation.force": "1e-8 N"}
    response = drumlin.solve(
        vary(drumlin.read_brake("studies/brakes/block_on_lever.toml"), crowned)
    )
    (warning,) = saying(response.notes, "warning")
    assert "too short to know its pressure" in warning and "unbounded" not in warning
    # Nor do other elements with widths know it, so that they are not tried.
    unknown = response.plane_stress_error.unknown
    assert "too short to know its pressure" in unknown and "section" not in unknown


def test_a_zone_at_the_ends_is_left_out_where_it_bears_less_than_half():
    for inner, zone in ((0.01, 0.0), (1.0, 0.1)):
        shoe = _pressing([1.0, 1.0] + [inner] * 18 + [1.0, 1.0])
        assert (
            length_of_edge_zone_left_out_of_pressure_errors(shoe.theta, shoe.pressure, 1, 0.1)
            == zone
        )
    spiked, even = _pressing([1000] + [1e-3] * 1000), _pressing([999] + [1e-3] * 1000)
    # The distance is not that of the rest of the lining, which is 0.
    assert relative_distance_of_pressures(even, spiked) == pytest.approx(1e-3, rel=1e-2)


@pytest.mark.parametrize("turned", [False, True])
def test_what_differs_within_a_zone_at_either_end_alone_is_no_distance(turned):
    # The two pressures differ in their first twentieth alone.
    a, b = [9.0] + [1.0] * 20, [1.0] * 21
    one, other = _pressing(a[::-1] if turned else a), _pressing(b[::-1] if turned else b)
    assert relative_distance_of_pressures(one, other, 0.05) == pytest.approx(0.0, abs=1e-12)
    assert relative_distance_of_pressures(one, other, 0.04) > 0.01


@pytest.mark.parametrize("zone", [0.0, 0.1, 0.3, 0.4, 0.95, 1.2])
def test_the_force_between_the_zones_is_that_of_the_polynomial_wherever_they_end(zone):
    ends = ((0.0, 0.3), (0.3, 1.0), (1.0, 2.0))
    theta = np.concatenate(
        [[0.0], *(a + (b - a) * (gauss_lobatto_points(3)[1:] + 1) / 2 for a, b in ends)]
    )
    exact = max(((2 - zone) ** 4 - zone**4) / 16, 0.0)
    assert LiningWithoutEndZones(theta, 3, zone).fraction_of_integral_outside_end_zones(
        theta**3
    ) == pytest.approx(exact, abs=1e-14)


THIN = """
title = "thin flexible shoe that presses at its very end"
rotation = "clockwise"
friction = 0.0
drum = { radius = "17 mm" }
[[shoe]]
name = "s"
side = "internal"
hinge = { radius = "12.5 mm", angle = "116 deg" }
[shoe.actuation]
force = "218 N"
direction = "-5 deg"
point = { radius = "12.8 mm", angle = "37 deg" }
[shoe.lining]
start = "40 deg"
end = "96 deg"
thickness = "0.87 mm"
width = "25 mm"
material = { E = "2 GPa", nu = 0.37 }
[shoe.body]
thickness = "0.47 mm"
width = "2 mm"
start = "36 deg"
end = "97 deg"
material = { E = "340 GPa", nu = 0.23 }
"""


def test_a_shoe_is_not_taken_as_rigid_where_that_cannot_be_judged(tmp_path):
    """A shoe is not taken as rigid where its rigidity cannot be judged.

    The contact is a tenth of a degree long; taken as rigid the shoe pressed by 47.5 N, in truth by
    38.6 N.
    """
    file = tmp_path / "thin.toml"
    file.write_text(THIN)
    response = drumlin.solve(drumlin.read_brake(file), tolerance=1e-2)
    assert response.shoes[0].normal_force == pytest.approx(38.6, abs=0.1)
    for value in response.error.values():
        assert math.isfinite(value)
    json.dumps(response.as_dict(), allow_nan=False)


@pytest.mark.parametrize("model", ["fem", "sine", "foundation"])
@pytest.mark.parametrize("friction", [1e-320, 1e-30, 1e-12])
def test_next_to_no_friction_leaves_numbers(model, friction):
    name = "post_brake" if model == "foundation" else "double_shoe"
    brake = vary(drumlin.read_brake(f"studies/{name}/brake.toml"), {"friction": friction})
    response = drumlin.solve(brake, model)
    json.dumps(response.as_dict(), allow_nan=False)
    per_friction = drumlin.solve(vary(brake, {"friction": 1e-9}), model).torque / 1e-9
    # Friction below this value counts as none.
    expected = friction * per_friction if friction >= 1e-30 else 0.0
    assert response.torque == pytest.approx(expected, rel=1e-7, abs=0.0)


WORN = (
    ("--exponent", "2", "--distance", "0.1"),
    ("--exponent", "0.999999", "--distance", "0.1"),
    ("--coefficient", "0 1/Pa", "--distance", "1 km"),
    ("--elements", "3", "--distance", "1 km"),
)


@pytest.mark.parametrize("words", WORN, ids=" ".join)
def test_running_in_says_no_number_that_is_not_finite(tmp_path, words):
    """What has no value, an energy balance for another exponent, is left out."""
    more = [] if "--elements" in words else ["--elements", "6"]
    given = FilesAndCommandLineOfBrokenInput(
        "wear",
        {"b.toml": content_of_brake_file("double_shoe/brake")},
        ["wear", "b.toml", "--json", "r.json", *words],
    )
    given.words.extend(more)
    end = run_input_in_this_process(given)
    assert (
        end.status == 0 and "balance: volume" in end.out and describe_fault_of_run(given, end) == ""
    )
    assert ("energy" in end.out) == ("--exponent" not in words)


@pytest.mark.parametrize(
    ("start", "end"), [("100 deg", "250 deg"), ("200 deg", "300 deg"), ("150 deg", "200 deg")]
)
@pytest.mark.parametrize("rotation", ["clockwise", "counter-clockwise"])
@pytest.mark.parametrize("direction", ["90 deg", "-90 deg"])
def test_eta_is_its_own_formula_wherever_the_lining_lies(start, end, rotation, direction):
    """The figure of merit eta = T/M = 1/(m - dD n) follows its formula wherever the lining lies.

    UWA notes, eq. 6, also where the lining reaches beyond half a turn from the hinge.
    """
    changes = {"rotation": rotation, "shoe[0].actuation.direction": direction}
    changes |= {"shoe[0].lining.start": start, "shoe[0].lining.end": end}
    brake = vary(
        brake_with_one_hinged_shoe(R=0.15, a=0.1, arc=(3.5, 5.2), moment=300.0, mu=0.08), changes
    )
    merit = drumlin.solve(brake, elements=20).merits[0]
    if merit.m is not None:
        assert merit.mechanical_advantage == pytest.approx(
            1 / (merit.m - merit.double_delta * merit.n), rel=1e-5
        )


def test_shoes_that_lie_in_each_other_are_said(brake):
    changes = {"shoe[1].lining.start": "40 deg", "shoe[1].lining.end": "165 deg"}
    changes |= {"shoe[1].body.start": "35 deg", "shoe[1].body.end": "170 deg", "friction": 0.1}
    for model in ("fem", "cosine"):
        assert not saying(drumlin.solve(brake, model).notes, "lie in each other")
        found = saying(drumlin.solve(vary(brake, changes), model).notes, "lie in each other")
        assert len(found) == 1
        assert "'right' and 'left'" in found[0]
        assert "from 40 deg to 55 deg" in found[0]


def test_pads_are_warned_of_as_shoes_on_a_drum_are():
    """Strains beyond small ones, and pads that lie in each other, in millimetres."""
    clamp = read_drum_or_plane_brake("studies/brakes/rail_clamp.toml")
    data = vary(clamp, {"shoe.actuation.force": "250 kN"}).model_dump(by_alias=True)
    shoe = data["shoe"][0]
    other = {
        "shoe.name": "other",
        "shoe.hinge.x": -0.095,
        "shoe.pivot.x": 0.125,
        "shoe.actuation.point.x": 0.325,
        "shoe.body.start": 0.045,
        "shoe.body.end": 0.205,
        "shoe.lining.start": 0.05,
        "shoe.lining.end": 0.2,
    }
    second = vary(clamp, other).model_dump(by_alias=True)["shoe"][0]
    two = make_validated_brake_part(FlatBrake, data | {"shoe": [shoe, second]})
    for model in ("fem", "rigid"):
        assert not saying(drumlin.solve(clamp, model).notes, "warning")
        found = saying(drumlin.solve(two, model).notes, "warning")
        # A shoe's own notes come first.
        assert [("'pad'" in note, "strained" in note) for note in found[:1]] == [(True, True)]
        assert "'pad' and 'other'" in found[-1] and "from 50 mm to 75 mm" in found[-1]
    bare = make_validated_brake_part(
        FlatBrake,
        data | {"shoe": [shoe | {"body": None, "lining": {**shoe["lining"], "material": None}}]},
    )
    # This lining has no modulus that could be exceeded.
    assert drumlin.solve(bare, "rigid").notes == ()


def test_a_pad_that_must_turn_too_far_to_touch_is_refused():
    """A pad that must turn by more than 11.5 deg to touch is refused.

    A clearance c at x from the pin takes a turn of some c/x; small displacements hold up to 11.5
    deg.
    """
    clamp, pad = (
        read_drum_or_plane_brake("studies/brakes/rail_clamp.toml"),
        read_drum_or_plane_brake("studies/laws/pad.toml"),
    )
    lining = {"thickness": 0.01, "material": {"E": 1e9, "nu": 0.3}}
    hinged = vary(pad, {f"shoe.lining.{key}": value for key, value in lining.items()})
    for brake, x, far in ((hinged, 0.18, 1.0), (clamp, 0.22, 0.5)):
        with pytest.raises(
            NoAnswer, match=f"turn by {math.degrees(far / x):.3g} deg to touch the plane; small"
        ):
            drumlin.solve(vary(brake, {"shoe.lining.clearance": far}))
        drumlin.solve(vary(brake, {"shoe.lining.clearance": 0.03}))
    with pytest.raises(NoAnswer, match="deg to touch the drum"):
        drumlin.solve(
            vary(
                drumlin.read_brake("studies/brakes/crane.toml"), {"shoe.lining.clearance": "0.2 m"}
            )
        )


@pytest.mark.parametrize(("slope", "refused"), [(0.1, False), (0.25, True), (0.5, True)])
def test_a_pad_on_a_pivot_that_must_tilt_too_far_is_refused(slope, refused):
    """A pad on a pivot that must tilt by more than 0.2 rad is refused.

    Its lining stands off in a wedge, which the lever's turn and the tilt about the pivot close
    together; small displacements hold up to 0.2 rad.
    """
    clamp = read_drum_or_plane_brake("studies/brakes/rail_clamp.toml")
    assert isinstance(clamp, FlatBrake) and set(picked(clamp.shoes, "kind_of_support")) == {"pivot"}
    wedge = {}
    for i, shoe in enumerate(clamp.shoes):
        start, end = shoe.lining.start, shoe.lining.end
        rows = [(start, 0.001), (end, 0.001 + slope * (end - start))]
        wedge[f"shoe[{i}].lining.clearance"] = rows
    if refused:
        with pytest.raises(
            NoAnswer, match=f"turn by {math.degrees(slope):.3g} deg to touch the plane; small"
        ):
            drumlin.solve(vary(clamp, wedge))
    else:
        drumlin.solve(vary(clamp, wedge))


def test_a_lining_pressed_in_too_far_is_said_and_then_refused(brake):
    """A lining pressed in too far is reported, and further in is refused.

    p/E of 5 % at the peak is beyond small strains. Ten times the lining's thickness in the mean is
    no answer; a higher peak may only be a corner's.
    """
    small, E = drumlin.solve(brake, elements=20), 300e6
    shoe = small.shoes[1]
    ((start, end),) = shoe.contact_arcs
    # The mean counts, not the resultant: opposite sides do not relieve each other.
    strain = shoe.peak_pressure / E
    mean = np.trapezoid(shoe.pressure, shoe.theta) / (E * (end - start))
    assert not saying(small.notes, "strained")

    def said(factor):
        return drumlin.solve(
            vary(brake, {"shoe.actuation.force": 2000 * factor}), elements=20
        ).notes

    assert any(
        note.startswith("warning: shoe 'left': the lining is strained by up to 6 %")
        for note in said(0.06 / strain)
    )
    assert 9.5 * strain > 10.5 * mean
    most = f"the lining is strained by up to {100 * 9.5 * strain / mean:.2g} %"
    assert saying(said(9.5 / mean), most)
    with pytest.raises(NoAnswer, match="pressed in by 11 times its thickness"):
        said(11 / mean)


def _meshed(tmp_path, change):
    """The main brake's right shoe with a mesh of its own, whose groups or nodes are changed."""
    brake = drumlin.read_brake("studies/double_shoe/brake.toml")
    brake = brake.model_copy(update={"shoes": brake.shoes[:1]})
    mesh = change(make_prepared_model(brake, elements=20).bodies[0].mesh)
    path = tmp_path / "shoe.msh"
    write_shoe_mesh_to_file(path, mesh, brake.shoes[0])
    return vary(brake, {"shoe[0].mesh": path})


def test_a_mesh_with_hinge_and_actuation_swapped_is_refused(tmp_path):
    def swapped(mesh):
        names = {"hinge": "actuation", "actuation": "hinge"}
        return replace(
            mesh,
            _boundaries={names.get(name, name): where for name, where in mesh.boundaries.items()},
        )

    with pytest.raises(BadInput, match="swapped"):
        drumlin.solve(_meshed(tmp_path, swapped))


@pytest.mark.parametrize(
    ("depth", "outcome"),
    [
        pytest.param(0.0, "fine", marks=pytest.mark.slow),
        (0.2e-3, "warning"),
        pytest.param(1.0e-3, "refused", marks=pytest.mark.slow),
    ],
)
def test_a_mesh_that_lies_in_the_drum_is_said_and_then_refused(tmp_path, depth, outcome):
    """The lining is 8 mm thick: a hundredth of that is said, a tenth must be meant."""

    def pressed(mesh):
        r = np.hypot(*mesh.doflocs)
        return replace(mesh, doflocs=mesh.doflocs * (1 + depth / 0.150 * (r / 0.150) ** 40))

    brake = _meshed(tmp_path, pressed)
    if outcome == "refused":
        with pytest.raises(BadInput, match="mesh_interference"):
            drumlin.solve(brake)
        brake = vary(brake, {"shoe[0].mesh_interference": True})
    notes = drumlin.solve(brake).notes
    assert bool(saying(notes, "in the drum")) == (outcome != "fine")


def test_the_sine_law_refuses_a_lining_that_reaches_past_its_hinge_on_one_side(brake):
    # The right hinge of this brake lies at -75 deg.
    changes = {"shoe[0].lining.start": "-80 deg", "shoe[0].body.start": "-85 deg"}
    with pytest.raises(BadInput, match="within 0 to 180 deg of the hinge"):
        drumlin.solve(vary(brake, changes), "sine")


def test_a_force_that_lifts_a_pad_is_borne_by_its_hinge():
    brake = drumlin.read_brake("studies/laws/pad.toml")
    lifted = vary(brake, {"shoe[0].actuation.force": -brake.shoes[0].actuation.force})
    for model in ("linear", "short"):
        shoe = drumlin.solve(lifted, model).shoes[0]
        assert shoe.normal_force == 0
        np.testing.assert_allclose(
            shoe.hinge_reaction, -lifted.shoes[0].actuation.force_vector, rtol=1e-14
        )


def test_the_balance_of_the_printed_pressure_is_said_where_it_is_the_worse(brake):
    """On quadratic arcs integrals of p(theta) over the round drum differ from nodal forces."""
    for options in ({}, {"elements": 12}):
        response = drumlin.solve(brake, **options)
        curve = largest_imbalance_among_shoes(
            [relative_imbalance_of_shoe(brake, i, shoe) for i, shoe in enumerate(response.shoes)]
        )
        said = saying(response.notes, "p(theta) on the round drum balances")
        assert bool(said) == (curve.force > 1e-8) == bool(options)
        assert (
            not said
            or f"{100 * curve.force:.2g} % (force) and {100 * curve.moment:.2g} % (moment)"
            in said[0]
        )
    assert response.balance.force < 1e-12 < curve.force
