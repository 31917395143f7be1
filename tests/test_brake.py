"""Brake files: what is read, what is refused and how, and the shoe's own frame."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from conftest import STUDY
from drumlin.base.errors import BadInput
from drumlin.brake import units
from drumlin.brake.brake import ShoeFrame
from drumlin.brake.file import make_drum_brake_from_data, read_brake, vary
from drumlin.brake.units import quantity_in_si
from picking import picked

TEXT = (STUDY / "brake.toml").read_text()


def read(tmp_path, text):
    path = tmp_path / "b.toml"
    path.write_text(text)
    return read_brake(path)


@pytest.mark.parametrize("name", ["links", "Backe 2 (auf)", "левая", "左", "a-b_c.d+e"])
def test_names_of_many_kinds_are_taken(tmp_path, name):
    assert read(tmp_path, TEXT.replace('name = "left"', f'name = "{name}"')).shoes[1].name == name


def test_the_study_brake_has_the_source_geometry(brake):
    """The study's brake has Simscape's default geometry.

    The pin lies 125 mm out at 15 deg from the axis, the line of force 100 mm out, and the lining
    covers 5 to 130 deg.
    """
    assert brake.drum.radius == pytest.approx(0.150, rel=1e-15)
    for shoe in brake.shoes:
        assert shoe.hinge.radius == pytest.approx(0.125, rel=1e-12)
        assert np.degrees(shoe.arc) == pytest.approx((5, 130), rel=1e-12)
        arm = abs(shoe.actuation.moment_of_force_about_point(shoe.hinge)) / shoe.actuation.force
        assert arm == pytest.approx(0.1 + 0.125 * math.cos(math.radians(15)), rel=1e-12)


REFUSED = [
    # what is replaced, by what, what the line must say
    ('radius = "150 mm"', 'radius = "150 kg"', ["drum.radius = '150 kg'", "a length"]),
    ('radius = "150 mm"', "radius = 150", ["drum.radius = 150", "unit"]),
    ('radius = "150 mm"', 'radius = "-150 mm"', ["drum.radius", "greater than 0"]),
    ('radius = "150 mm"', 'radius = "0 mm"', ["drum.radius", "greater than 0"]),
    ('radius = "150 mm"', 'radius = "1e999 mm"', ["drum.radius", "1e999"]),
    ('radius = "150 mm"', 'radius = "9**9**9 mm"', ["drum.radius", "a number and its unit"]),
    ('radius = "150 mm"', 'radius = "150 m^9^9^9^9"', ["drum.radius", "a number and its unit"]),
    ('radius = "150 mm"', 'radius = "150 furbles"', ["drum.radius", "unknown unit 'furbles'"]),
    ('radius = "150 mm"', "radius = nan", ["drum.radius = nan"]),
    ("friction = 0.3", "friction = nan", ["friction = nan", "finite"]),
    ("friction = 0.3", "friction = -0.3", ["friction = -0.3", "greater than or equal to 0"]),
    ("friction = 0.3", 'friction = "high"', ["friction = 'high'", "number"]),
    ("friction = 0.3", "", ["friction: is missing"]),
    (
        "friction = 0.3",
        "friction = 0.3\nfrction = 1",
        ["unknown key 'frction'", "did you mean 'friction'"],
    ),
    ('"counter-clockwise"', '"widdershins"', ["rotation = 'widdershins'", "clockwise"]),
    (
        'thickness = "8 mm" ',
        'thickness = "-8 mm" ',
        ["shoe[0].lining.thickness = '-8 mm'", "greater than 0"],
    ),
    (
        'thickness = "8 mm" ',
        'thicknes = "8 mm" ',
        ["shoe[0].lining", "'thicknes'", "did you mean 'thickness'"],
    ),
    ('thickness = "8 mm" ', 'thickness = "140 mm" ', ["shoe[0]", "less than drum.radius"]),
    ('end = "55 deg"', 'end = "65 deg"', ["shoe[0].lining", "within the body"]),
    ('end = "55 deg"', 'end = "-80 deg"', ["shoe[0].lining", "greater than start"]),
    ('end = "55 deg"', 'end = "55 mm"', ["shoe[0].lining.end = '55 mm'", "an angle"]),
    ('end = "55 deg"', 'end = "55 percent"', ["shoe[0].lining.end", "an angle"]),
    (
        "nu = 0.25 }       # assumed",
        "nu = 0.5 }       # assumed",
        ["material.nu = 0.5", "less than 0.5"],
    ),
    (
        'E = "300 MPa", nu = 0.25 }       #',
        'E = "0 MPa", nu = 0.25 }       #',
        ["material.E", "greater than 0"],
    ),
    (
        '{ radius = "125 mm", angle = "-75 deg" }',
        '{ radius = "0 mm", angle = "0 deg" }',
        ["hinge", "drum's centre"],
    ),
    (
        '{ radius = "125 mm", angle = "-75 deg" }',
        '{ radius = "125 mm" }',
        ["shoe[0].hinge", "radius = ..., angle"],
    ),
    (
        '{ radius = "125 mm", angle = "-75 deg" }',
        '{ radius = "-1 mm", angle = "0 deg" }',
        ["hinge", "negative"],
    ),
    (
        '{ radius = "125 mm", angle = "-75 deg" }',
        "3",
        ["shoe[0].hinge = 3", "table with keys of x, y"],
    ),
    (
        'rotation = "counter-clockwise"',
        'rotation = "counter-clockwise"\nlink = 3',
        ["link = 3", "tables, each under [[link]]"],
    ),
    ('title = "internal double-shoe brake"', "title = 3", ["title = 3", "must be a text"]),
    ("friction = 0.3", 'friction = "much"', ["friction = 'much'", "must be a number"]),
    (
        'side = "internal"',
        'side = "internal"\nmesh_unit = "mm"',
        ["shoe[0]", "mesh_unit = 'mm'", "mesh is missing"],
    ),
    ('side = "internal"', 'side = "internal"\nmesh = 3', ["shoe[0].mesh = 3", "name of a file"]),
    (
        'side = "internal"',
        'side = "internal"\nmesh_interference = 3',
        ["mesh_interference = 3", "true or false"],
    ),
    ('name = "left"', 'name = "right"', ["names must differ"]),
    # On some machines these two names would be the same file.
    ('name = "left"', 'name = "Right"', ["names must differ"]),
    ('name = "left"', 'name = "../left"', ["shoe[1].name = '../left'", "letters, digits"]),
    ('name = "left"', 'name = "$left"', ["shoe[1].name", "letters, digits"]),
    ('name = "left"', 'name = "all"', ["shoe[1].name = 'all'", "not 'all'"]),
    ('title = "internal', 'title = "$x_$ internal', ["title = '$x_$", "without $"]),
    ('title = "internal', 'title = "two\\nlines, internal', ["title", "one line"]),
    ('side = "internal"', 'side = "inner"', ["side = 'inner'", "'internal' or 'external'"]),
    ("[drum]", "[drum", ["not TOML"]),
    ("[drum]", "[[drum]]", ["drum", "table with keys of radius"]),
]


@pytest.mark.parametrize(
    ("old", "new", "words"), REFUSED, ids=[f"{i}" for i in range(len(REFUSED))]
)
def test_wrong_input_is_refused_in_one_line_with_key_value_and_what_is_allowed(
    tmp_path, old, new, words
):
    assert old in TEXT
    with pytest.raises(BadInput) as refusal:
        read(tmp_path, TEXT.replace(old, new, 1))
    line = str(refusal.value)
    assert "\n" not in line
    for word in words:
        assert word in line


def test_unreadable_files_are_refused(tmp_path):
    with pytest.raises(BadInput, match="cannot be read"):
        read_brake(tmp_path / "none.toml")
    (tmp_path / "b.toml").write_bytes(b"\xfftitle")
    with pytest.raises(BadInput, match="no UTF-8 text"):
        read_brake(tmp_path / "b.toml")
    (tmp_path / "b.toml").write_text("# " + "x" * 1_100_000)
    with pytest.raises(BadInput, match="larger than"):
        read_brake(tmp_path / "b.toml")


def test_units_do_not_matter(tmp_path, brake):
    text = TEXT.replace('radius = "150 mm"', 'radius = "0.15 m"').replace('"2 kN"', '"2000 N"')
    text = (
        text.replace('"300 MPa"', '"300 N/mm^2"')
        .replace('"8 mm"', '"0.8 cm"')
        .replace('"0 deg"', '"0 rad"')
    )
    for a, b in zip(read(tmp_path, text).shoes, brake.shoes, strict=True):
        assert a.lining.thickness == pytest.approx(b.lining.thickness, rel=1e-14)
        assert pytest.approx(b.lining.material.E, rel=1e-14) == a.lining.material.E
        assert a.actuation.force_vector == pytest.approx(b.actuation.force_vector, rel=1e-14)


def test_a_clearance_table_is_read_and_interpolated(tmp_path):
    table = (
        'end = "55 deg"\nclearance = [["-70 deg", "0 mm"], ["0 deg", "0.2 mm"], ["55 deg", '
        '"0.1 mm"]]'
    )
    lining = read(tmp_path, TEXT.replace('end = "55 deg"', table, 1)).shoes[0].lining
    assert lining.clearances_at_surface_coordinates(
        np.radians([-70, -35, 0, 27.5])
    ) == pytest.approx([0, 1e-4, 2e-4, 1.5e-4], abs=1e-18)
    for bad, words in [
        ('[["0 deg", "0 mm"]]', "at least two rows"),
        ('[["9 deg", "0 mm"], ["0 deg", "0 mm"]]', "growing angles, not '0 deg' after '9 deg'"),
        ('[["0 deg"], ["9 deg", "0 mm"]]', "rows like"),
        ('[["0 deg", 3], ["9 deg", "0 mm"]]', "clearance = 3 has no unit"),
    ]:
        with pytest.raises(BadInput, match=r"shoe\[0\].lining.clearance") as refusal:
            read(tmp_path, TEXT.replace('end = "55 deg"', f'end = "55 deg"\nclearance = {bad}', 1))
        assert words in str(refusal.value)


def test_vary_changes_one_key_or_the_key_of_every_shoe_and_validates(brake):
    assert vary(brake, {"friction": 0.4}).friction == 0.4
    changed = vary(brake, {"shoe.lining.thickness": "9 mm", "shoe[1].name": "other"})
    assert picked(changed.shoes, "lining.thickness") == pytest.approx([0.009, 0.009], rel=1e-14)
    assert picked(changed.shoes, "name") == ["right", "other"]
    for key, value in {
        "shoe.lining.thikness": 1.0,
        "drum.radius": -1.0,
        "dram.radius": 1.0,
        "friction.x": 1,
    }.items():
        with pytest.raises(BadInput):
            vary(brake, {key: value})


def test_numbers_in_python_are_si(brake):
    data = brake.model_dump(by_alias=True)
    assert make_drum_brake_from_data(data) == brake
    with pytest.raises(BadInput, match="unit"):
        make_drum_brake_from_data(data, unit_required=True)


def test_a_changed_copy_of_a_shoe_has_a_frame_of_its_own(brake):
    shoe = brake.shoes[0]
    before = shoe.frame, shoe.arc
    lining = shoe.lining.model_copy(update={"start": shoe.lining.start + 0.1})
    other = shoe.model_copy(update={"lining": lining, "hinge": brake.shoes[1].hinge})
    assert (other.frame, other.arc) != before == (shoe.frame, shoe.arc)
    fresh = type(shoe).model_validate(other.model_dump())
    assert (
        (other.frame, other.arc) == (fresh.frame, fresh.arc)
        and other == fresh
        and hash(other) == hash(fresh)
    )


@given(st.floats(-4, 4), st.sampled_from([-1, 1]), st.floats(-9, 9), st.floats(-9, 9))
def test_the_frame_of_a_shoe_and_back_is_the_identity_and_keeps_lengths(origin, sense, x, y):
    frame = ShoeFrame(origin, sense)
    v = np.array([x, y])
    assert frame.convert_vectors_to_shoe_frame(
        frame.convert_vectors_from_shoe_to_brake_frame(v)
    ) == pytest.approx(v, abs=1e-12)
    assert np.linalg.norm(frame.convert_vectors_from_shoe_to_brake_frame(v)) == pytest.approx(
        np.linalg.norm(v), rel=1e-12
    )
    # The ray phi = 0.3 lies at theta = origin + sense 0.3.
    ray = np.array([math.cos(0.3), math.sin(0.3)])
    theta = float(frame.surface_coordinates_of_phi(np.array(0.3)))
    assert frame.convert_vectors_from_shoe_to_brake_frame(ray) == pytest.approx(
        [math.cos(theta), math.sin(theta)], abs=1e-12
    )


@given(st.floats(1e-6, 1e6))
def test_a_quantity_is_its_number_times_its_unit(number):
    assert quantity_in_si(f"{number!r} mm", "m", unit_required=True) == pytest.approx(
        number * 1e-3, rel=1e-14
    )
    assert quantity_in_si(f"{number!r} deg", "rad", unit_required=True) == pytest.approx(
        math.radians(number), rel=1e-14
    )


def test_varying_inside_a_table_that_was_given_leaves_that_table_alone(brake):
    ring = {"thickness": 0.015, "width": 0.04, "material": {"E": 1e11, "nu": 0.25}}
    assert (
        vary(brake, {"drum.ring": ring, "drum.ring.material.E": 2e11}).drum.ring.material.E == 2e11
    )
    assert ring["material"]["E"] == 1e11


def test_common_units_are_those_of_pint():
    for si, factors in units.FACTORS_OF_COMMON_UNITS_BY_SI_UNIT.items():
        for unit, factor in factors.items():
            assert factor == pytest.approx(units._si_factor_of_unit_by_pint(unit, si), rel=1e-15)
            assert units.quantity_in_si(f"2 {unit}", si, unit_required=True) == 2 * factor
