"""Keys as a brake file writes them: polar coordinates, and shoes by their names."""

import math

import pytest

import drumlin
from conftest import STUDY
from drumlin.base.errors import BadInput
from drumlin.brake.file import si_unit_of_brake_key, values_of_brake_key, vary
from drumlin.sweeps.file import sweep_from_file_data


def test_a_point_is_varied_in_polar_coordinates(brake):
    pin = brake.shoes[0].hinge
    turned = vary(brake, {"shoe[0].hinge.angle": "-70 deg"}).shoes[0].hinge
    assert turned.angle == pytest.approx(math.radians(-70), rel=1e-14)
    assert turned.radius == pytest.approx(pin.radius, rel=1e-14)
    moved = vary(brake, {"shoe[0].hinge.radius": "120 mm"}).shoes[0].hinge
    assert moved.radius == pytest.approx(0.12, rel=1e-14)
    assert moved.angle == pytest.approx(pin.angle, rel=1e-14)
    both = {"shoe[0].hinge.radius": "120 mm", "shoe[0].hinge.angle": "-70 deg"}
    assert vary(brake, both).shoes[0].hinge.xy == pytest.approx(
        [0.12 * math.cos(math.radians(-70)), 0.12 * math.sin(math.radians(-70))], rel=1e-14
    )
    # A table in polar coordinates may be followed by a Cartesian key, and the other way round.
    polar = {"shoe[0].hinge": {"radius": "100 mm", "angle": "-90 deg"}, "shoe[0].hinge.x": "9 mm"}
    assert vary(brake, polar).shoes[0].hinge.xy == pytest.approx([0.009, -0.1], rel=1e-14)


def test_a_shoe_is_varied_by_its_name(brake):
    changed = vary(brake, {"shoe.left.lining.thickness": 0.009, "shoe.left.hinge.radius": 0.12})
    assert changed.shoes[0] == brake.shoes[0]
    assert (
        changed.shoes[1]
        == vary(brake, {"shoe[1].lining.thickness": 0.009, "shoe[1].hinge.radius": 0.12}).shoes[1]
    )
    assert values_of_brake_key(changed, "shoe.left.lining.thickness") == [0.009]
    assert vary(brake, {"shoe.name": "x", "shoe[1].name": "y"}).shoes[1].name == "y"
    with pytest.raises(BadInput, match="unknown key 'middle'"):
        vary(brake, {"shoe.middle.hinge.radius": 0.12})


def test_a_key_of_a_shoe_precedes_a_name_that_is_the_same_word(brake):
    named = vary(brake, {"shoe[1].name": "lining"})
    changed = vary(named, {"shoe.lining.thickness": 0.009})
    assert [shoe.lining.thickness for shoe in changed.shoes] == [0.009, 0.009]
    assert values_of_brake_key(changed, "shoe.lining.thickness") == [0.009, 0.009]


def test_keys_of_points_have_units_and_values(brake):
    assert si_unit_of_brake_key(brake, "shoe.left.hinge.angle") == "rad"
    assert si_unit_of_brake_key(brake, "shoe.hinge.radius") == "m"
    assert values_of_brake_key(brake, "shoe.hinge.radius") == pytest.approx([0.125] * 2, rel=1e-14)
    with pytest.raises(BadInput, match="unknown key 'r'; allowed: x, y, radius, angle"):
        si_unit_of_brake_key(brake, "shoe.hinge.r")


@pytest.mark.parametrize(
    ("key", "meant"),
    [
        ("force", "'shoe.actuation.force'"),
        ("actuation.force", "'shoe.actuation.force'"),
        ("hinge.angle", "'shoe.hinge.angle'"),
        ("thickness", "'shoe.lining.thickness' or 'shoe.body.thickness'"),
        ("radius", "'drum.radius' or 'shoe.hinge.radius' or .*"),
    ],
)
def test_the_end_of_a_key_is_refused_with_the_whole_key(brake, key, meant):
    said = rf"^{key}: unknown key '{key.partition('.')[0]}' \(did you mean {meant}\?\); allowed: "
    for use in (lambda: vary(brake, {key: 1.0}), lambda: values_of_brake_key(brake, key)):
        with pytest.raises(BadInput, match=said):
            use()


def test_a_key_that_ends_no_other_key_keeps_its_message(brake):
    with pytest.raises(BadInput, match=r"^hinge.r: unknown key 'hinge'; allowed: title, "):
        values_of_brake_key(brake, "hinge.r")
    # A single word is the table of a drive, which the brake does not have.
    with pytest.raises(BadInput, match=r"^actuation = 5: must be a table"):
        vary(brake, {"actuation": 5})


def test_sweeps_take_such_keys_as_lists_ranges_and_distributions():
    sweep = sweep_from_file_data(
        {
            "brake": str(STUDY / "brake.toml"),
            "cases": 3,
            "vary": {
                "shoe.left.hinge.angle": {"from": "-106 deg", "to": "-104 deg", "count": 2},
                "shoe.right.hinge.radius": ["124 mm", "126 mm"],
                "shoe.hinge.angle": {"distribution": "normal", "deviation": "1 deg"}
                | {"each_shoe": True, "mean": "-75 deg"},
            }
            | {"shoe.left.actuation.force": {"distribution": "normal", "deviation": "5 %"}},
        }
    )
    assert len(sweep.cases) == 12
    assert sweep.units["shoe.left.hinge.angle"] == "rad"
    first = vary(sweep.brake, {k: v for k, v in sweep.cases[0].changes.items() if "left" in k})
    assert first.shoes[1].hinge.angle == pytest.approx(math.radians(-106), rel=1e-12)


def test_the_last_word_of_a_key_alone_is_answered_with_the_whole_key():
    brake = drumlin.example("double_shoe")
    for word, words in (
        ("force", r"\(did you mean 'shoe\.actuation\.force'\?\)"),
        ("width", r"\(did you mean 'shoe\.lining\.width' or 'shoe\.body\.width'\?\)"),
        ("preload", r"'preload'; allowed: title"),
    ):
        with pytest.raises(BadInput, match=f"^{word}: unknown key .*{words}"):
            values_of_brake_key(brake, word)
