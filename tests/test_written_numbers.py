"""Numbers, units, tables and files as people write them: read where certain, else refused."""

import math
import re

import pytest

from conftest import STUDY
from drumlin.base.errors import BadInput
from drumlin.base.written_numbers import number_from_text_as_people_write_it
from drumlin.brake.drum_brake import DrumBrake
from drumlin.brake.file import make_drum_brake_from_data, read_brake, vary
from drumlin.brake.schema import PATTERN_OF_QUANTITY_TEXT
from drumlin.brake.units import quantity_in_si, quantity_with_usual_unit
from drumlin.sweeps.file import sweep_from_file_data
from drumlin.verification.check import read_pressure_curves

TEXT = (STUDY / "brake.toml").read_text()
INCH, POUND_FORCE, KILOPOND = 0.0254, 4.4482216152605, 9.80665

# Texts by the unit that is wanted, and their value in SI from the definitions of the units.
WRITTEN = [
    ("N m", "976 Nm", 976),
    ("N m", "2 kNm", 2000),
    ("N m", "3 daNm", 30),
    ("N m", "4 Nmm", 0.004),
    ("N m", "5 N·m", 5),
    ("N m", "5 N*m", 5),
    ("N m", "5 N.m", 5),
    ("N m", "5 N-m", 5),
    ("N m", "100 in lb", 100 * INCH * POUND_FORCE),
    ("N m", "100 in-lb", 100 * INCH * POUND_FORCE),
    ("N m", "100 in.-lbs", 100 * INCH * POUND_FORCE),
    ("N m", "100 ft-lb", 1200 * INCH * POUND_FORCE),
    ("N m", "100 ft lb", 1200 * INCH * POUND_FORCE),
    ("N m", "100 lbf ft", 1200 * INCH * POUND_FORCE),
    ("N m", "5 kgf·m", 5 * KILOPOND),
    ("N", "500 lbf", 500 * POUND_FORCE),
    ("N", "500 lb", 500 * POUND_FORCE),
    ("N", "2 kp", 2 * KILOPOND),
    ("N", "2 kilopond", 2 * KILOPOND),
    ("Pa", "300 N/mm²", 3e8),
    ("Pa", "300 N/mm2", 3e8),
    ("Pa", "30 kgf/cm²", 30e4 * KILOPOND),
    ("Pa", "30 psi", 30 * POUND_FORCE / INCH**2),
    ("Pa", "30 lb/in²", 30 * POUND_FORCE / INCH**2),
    ("N m^2", "12 kNm²", 12e3),
    ("N m^2", "12 MN m^2", 12e6),
    ("1/Pa", "1e-5 mm³/Nm", 1e-14),
    ("1/Pa", "1e-5 mm³/N·m", 1e-14),
    ("1/Pa", "1e-5 mm^3/(N m)", 1e-14),
    ("rad", "55º", math.radians(55)),
    ("rad", "55°", math.radians(55)),
    ("rad", "−70 deg", math.radians(-70)),
    ("m", "− 5 mm", -0.005),
    ("m", "150\u00a0mm", 0.15),
    ("m", "150\u2009mm", 0.15),
    ("m", "150\u202fmm", 0.15),
    ("m", "150,0 mm", 0.15),
    ("m", "0,125 mm", 0.000125),
    ("m", "1234,567 mm", 1.234567),
    ("m", "1 500 mm", 1.5),
    ("m", "1\u202f500,250 mm", 1.50025),
    ("m", "1.500,25 mm", 1.50025),
    ("m", "1,500.25 mm", 1.50025),
    ("m", "1,500,000 mm", 1500),
    ("m", "1.500 mm", 0.0015),
    ("m", "1,5e3 mm", 1.5),
    ("m", "3/4 in", 0.75 * INCH),
    ("m", "8 1/4 in", 8.25 * INCH),
    ("m", '6"', 6 * INCH),
    ("m", "6′", 72 * INCH),
    ("m", "8 in.", 8 * INCH),
    ("m", "20 mils", 0.02 * INCH),
]


@pytest.mark.parametrize(("si", "text", "value"), WRITTEN)
def test_quantities_are_read_as_people_write_them(si, text, value):
    assert quantity_in_si(text, si, unit_required=True) == pytest.approx(value, rel=1e-14)
    # An editor that checks the file by its schema marks no text that is read.
    assert re.search(PATTERN_OF_QUANTITY_TEXT, text)


@pytest.mark.parametrize(
    ("si", "text", "words"),
    [
        ("m", "1,500 mm", "1,500 may be 1.500 or 1500"),
        ("m", "1,2,3 mm", "must be a number with a decimal point"),
        ("m", "1 50 mm", "must be a number with a decimal point"),
        ("m", "1.2.3 mm", "must be a number with a decimal point"),
        ("m", "3/0 mm", "denominator 0"),
        ("Pa", "3e8", "has no unit; write a stress such as '300 MPa'"),
        ("Pa", "3 Mpa", "did you mean 'MPa'?"),
        ("N", "3 KN", "did you mean 'kN'?"),
        ("N", "200 kg", "kg is a mass, kgf the weight"),
        ("Pa", "2 kg/cm^2", "kg is a mass, kgf the weight"),
        ("rad", '6"', "unknown unit"),
        ("rad", "55 grad", "'grad' may be degrees or gons; write 'deg' or 'gon'"),
        ("rad", "55 Grad", "'Grad' may be degrees or gons; write 'deg' or 'gon'"),
        ("m", "2 Nm", "must be a length"),
        ("N m", "2 N/m", "must be a torque"),
        ("rad/s", "10 1/s", "must be an angular speed such as '1500 rpm'"),
    ],
)
def test_quantities_in_doubt_are_refused_with_their_cause(si, text, words):
    with pytest.raises(ValueError, match=re.escape(words)):
        quantity_in_si(text, si, unit_required=True)


@pytest.mark.parametrize(
    "text", ["600 1/min", "600 1 / min", "600 min^-1", "600 min⁻¹", "600 U/min", "10 Hz", "600 rpm"]
)
def test_rotational_speeds_are_read_as_revolutions(text):
    speed = quantity_in_si(text, "rad/s", unit_required=True)
    assert speed == pytest.approx(2 * math.pi * 10, rel=1e-15)


def test_spring_rates_are_printed_in_the_unit_of_brake_files():
    assert quantity_with_usual_unit(20e3, "N/m") == "20 N/mm"


def test_pure_numbers_are_read_as_text_and_in_per_cent(brake):
    assert vary(brake, {"friction": "30 %"}) == vary(brake, {"friction": "0,3"}) == brake
    assert vary(brake, {"shoe.lining.material.nu": "0,2"}).shoes[1].lining.material.nu == 0.2
    with pytest.raises(BadInput, match=r"friction = '1,500': .*may be 1\.500 or 1500"):
        vary(brake, {"friction": "1,500"})
    for wrong in ("30 mm", "%", "much"):
        with pytest.raises(BadInput, match=r"friction = .* must be a number"):
            vary(brake, {"friction": wrong})


def test_sweeps_take_numbers_as_text_and_in_per_cent():
    data = {
        "brake": str(STUDY / "brake.toml"),
        "vary": {"friction": ["0,3", "35 %"], "drum.radius": {"from": "150,0 mm", "to": "0,2 m"}},
    }
    sweep = sweep_from_file_data(data)
    values = [tuple(case.changes.values()) for case in sweep.cases]
    assert values == [(0.3, 0.15), (0.3, 0.2), (0.35, 0.15), (0.35, 0.2)]


ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "utf-32")


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_a_brake_file_is_read_in_the_encodings_of_windows(tmp_path, brake, encoding):
    """PowerShell 5 writes `drumlin init double_shoe > my.toml` in UTF-16 with a mark."""
    path = tmp_path / "b.toml"
    path.write_bytes(TEXT.replace("\n", "\r\n").encode(encoding))
    assert read_brake(path) == brake


def test_other_encodings_are_refused_with_what_to_do(tmp_path):
    path = tmp_path / "b.toml"
    for content in (TEXT.encode("utf-16-le"), '"55°"'.encode("cp1252")):
        path.write_bytes(content)
        with pytest.raises(BadInput, match=r"no UTF-8 text .*; save it as UTF-8"):
            read_brake(path)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("friction = 0.3", "friction = 0,3", "a decimal point, not a comma"),
        ('radius = "150 mm"', "radius = 150 mm", 'in quotes, as "8 mm"'),
        ('radius = "150 mm"', "radius = “150 mm”", 'write quotes as "'),
        ('radius = "150 mm"', 'radius =\u00a0"150 mm"', "only looks like a plain one"),
        ("[[shoe]]", "[shoe]", r"write \[\[shoe\]\]"),
    ],
)
def test_a_line_that_is_no_toml_is_refused_with_what_to_write(tmp_path, old, new, words):
    path = tmp_path / "b.toml"
    path.write_text(TEXT.replace(old, new), encoding="utf-8")
    with pytest.raises(BadInput, match=words):
        read_brake(path)


@pytest.mark.parametrize(
    ("start", "end", "words"),
    [
        ("290 deg", "55 deg", "did you mean -70 deg to 55 deg?"),
        ("290 deg", "415 deg", "did you mean -70 deg to 55 deg?"),
        ("-70 deg", "-80 deg", "greater than start = -70 deg, by less than 360 deg"),
    ],
)
def test_angles_from_0_to_360_deg_are_refused_with_the_angles_that_are_meant(
    brake, start, end, words
):
    with pytest.raises(BadInput) as refusal:
        vary(brake, {"shoe[0].lining.start": start, "shoe[0].lining.end": end})
    assert str(refusal.value).endswith(f"({words})" if "mean" in words else words)


# tables

TABLE = [("right", -70.0, 0.1), ("right", -30.5, 0.25), ("right", 55.0, 0.0)]


def table_text(separator, comma, heading="shoe,theta [deg],p [MPa]"):
    lines = [heading.replace(",", separator)]
    for name, theta, p in TABLE:
        lines.append(separator.join([name, f"{theta:.3f}", f"{p:.4f}"]))
    text = "\n".join(lines) + "\n"
    return text.replace(".", ",") if comma else text


@pytest.fixture(scope="module")
def one_shoe(brake) -> DrumBrake:
    return brake.model_copy(update={"shoes": brake.shoes[:1]})


@pytest.mark.parametrize("encoding", ("utf-8", "utf-16"))
@pytest.mark.parametrize(
    ("separator", "comma"), [(",", False), (";", False), (";", True), ("\t", False), ("\t", True)]
)
def test_tables_of_spreadsheets_are_read(tmp_path, one_shoe, separator, comma, encoding):
    """Three digits after a comma are in doubt alone, but four in another cell prove the comma."""
    path = tmp_path / "p.csv"
    path.write_text(table_text(separator, comma), encoding=encoding)
    curve = read_pressure_curves(path, one_shoe)["right"]
    assert curve.theta == pytest.approx([math.radians(theta) for _, theta, _ in TABLE], rel=1e-14)
    assert curve.p == pytest.approx([1e6 * p for *_, p in TABLE], rel=1e-14)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (table_text(",", False).replace("0.2500", "0,2500"), "line 3: 4 cells.*decimal commas"),
        (table_text(";", False).replace("0.2500", "0,2500"), "decimal commas .*decimal points"),
        ("theta [deg];p [MPa]\n-70;1,000\n55;2,125\n", r"1,000 may be 1\.000 or 1000"),
    ],
)
def test_tables_in_doubt_are_refused_with_their_cause(tmp_path, one_shoe, text, words):
    path = tmp_path / "p.csv"
    path.write_text(text)
    with pytest.raises(BadInput, match=words):
        read_pressure_curves(path, one_shoe)


def test_a_known_decimal_sign_tells_what_a_comma_means():
    assert number_from_text_as_people_write_it("59,447", ",") == 59.447
    assert number_from_text_as_people_write_it("59,447", ".") == 59447
    with pytest.raises(ValueError, match="must be a number"):
        number_from_text_as_people_write_it("59,4471", ".")


def test_a_second_actuation_is_refused_with_the_key_of_further_forces(brake):
    data = brake.model_dump(by_alias=True)
    data["shoe"][0]["actuation"] = [data["shoe"][0]["actuation"]] * 2
    with pytest.raises(BadInput, match=r"force, direction, point; .* are \[\[shoe\.force\]\]"):
        make_drum_brake_from_data(data)
    # A value that is no table at all has no second force.
    data["shoe"][0]["actuation"] = "2 kN"
    with pytest.raises(BadInput, match=r"keys of force, direction, point$"):
        make_drum_brake_from_data(data)
