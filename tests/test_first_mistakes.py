"""First mistakes: lines of the terminal that say what to do, and their rows of troubleshooting."""

import re

import pytest

import drumlin
from command_line import drumlin as command
from conftest import ROOT, STUDY
from drumlin.cli.terminal import _text_folded_to_width

WEB = {"shoe.body.width": "5 mm"}
HINT_ON_SWEEPS = "(a key of sweep files; `drumlin sweep` takes a sweep file)"
HINT_ON_BRAKES = "(a key of brake files; the key 'brake' of a sweep file names the brake file)"


def test_a_number_and_its_unit_stay_on_one_line():
    text = "peak pressure 0.14 %, torque 447.6 N m, arm 5 mm, range 0.6 MPa to 60 MPa, 12 models"
    number, units = r"[0-9.]+", ("%", "N m", "mm", "MPa")
    for width in range(12, len(text) + 1):
        folded = _text_folded_to_width(text, width)
        assert " ".join(folded.split()) == text
        assert len(re.findall(rf"{number} (?:{'|'.join(units)})", folded)) == 5
    # Only a unit is kept beside its number.
    assert "12\nmodels" in _text_folded_to_width(text, len(text) - 3)


def test_a_large_error_of_plane_stress_names_the_options_with_a_smaller_one(tmp_path):
    brake = drumlin.vary(drumlin.example("double_shoe"), WEB)
    drumlin.write_brake(brake, tmp_path / "web.toml")
    both = "smaller errors: --finite-width corrects the answer for the widths; --model solid"
    said = " ".join(command("solve", tmp_path / "web.toml").stdout.split())
    assert both in said
    corrected = command("solve", tmp_path / "web.toml", "--finite-width").stdout
    assert "smaller errors: --model solid" in " ".join(corrected.split())
    # On shoes of one width the error is small, and an answer names no option.
    assert "smaller errors" not in command("solve", STUDY / "brake.toml").stdout


def test_a_brake_file_and_a_sweep_file_that_change_places_are_told_apart(tmp_path):
    sweep = tmp_path / "sweep.toml"
    sweep.write_text(f'brake = "{(STUDY / "brake.toml").as_posix()}"\n[vary]\nfriction = [0.3]\n')
    for words, hint in (
        (("solve", sweep), HINT_ON_SWEEPS),
        (("sweep", STUDY / "brake.toml"), HINT_ON_BRAKES),
    ):
        done = command(*words)
        assert done.returncode == 2
        assert hint in done.stderr


def test_a_distance_without_a_unit_is_told_in_kilometres():
    quick = ("--elements", 10, "--tolerance", 0.1)
    said = command("wear", STUDY / "brake.toml", "--distance", "0.5", *quick).stdout
    first = said.splitlines()[0]
    unit = float(re.search(r"1/\(k K\) = ([0-9.]+) km", " ".join(said.split()))[1])
    assert first.startswith("--distance 0.5 has no unit: 0.5 times 1/(k K), ")
    assert float(re.search(r"([0-9.e-]+) km$", first)[1]) == pytest.approx(0.5 * unit, rel=1e-4)
    there_and_back = ("--distance", "0.1 km", "--reverse", "0.2", *quick)
    named = command("wear", STUDY / "brake.toml", *there_and_back).stdout
    assert "--distance 0.1 km has no unit" not in named
    (line,) = (line for line in named.splitlines() if "has no unit" in line)
    assert line.startswith("--reverse 0.2 has no unit: 0.2 times 1/(k K), ")
    assert float(re.search(r"([0-9.e-]+) km$", line)[1]) == pytest.approx(0.2 * unit, rel=1e-4)


def test_the_sweeps_of_init_say_where_the_own_brake_goes():
    for name in ("sweep_grid", "sweep_loads", "sweep_tolerances"):
        text = command("init", name).stdout
        (line,) = re.findall(r"(?m)^brake = .*$", text)
        assert line.endswith("# or your own brake file; a path counts from this file")
        # No comment names a file of the checkout.
        assert "studies/sweeps" not in re.sub(r'"[^"]*"', "", text)


TROUBLESHOOTING = ROOT / "studies" / "manual" / "pages" / "troubleshooting.md"
# Words of the double-shoe brake's file, and what a person may write in their place.
WRONG_FILES = {
    "quotation mark": ('"150 mm"', '"150 mm'),
    "misspelt table": ("[drum]", "[drm]"),
    "no unit": ('radius = "150 mm"', "radius = 150"),
    "wrong unit": ('radius = "150 mm"', 'radius = "150 s"'),
    "high friction": ("friction = 0.3", "friction = 1.3"),
    "no friction": ("friction = 0.3\n", ""),
    "short lining": ('end = "55 deg"', 'end = "-80 deg"'),
    "short body": ('end = "60 deg"', 'end = "40 deg"'),
    "negative width": ('width = "40 mm"', 'width = "-40 mm"'),
    "wide gap": ("[shoe.lining]", '[shoe.lining]\nclearance = "50 mm"'),
    "no hinge": ('hinge = { radius = "125 mm", angle = "-75 deg" }', ""),
}
WRONG_WORDS = {
    "example": ("init", "doubleshoe"),
    "file": ("solve", "no_such_file.toml"),
    "model": ("solve", "BRAKE", "--model", "abaqus"),
    "model of another brake": ("solve", "BRAKE", "--model", "foundation"),
    "option of another model": ("solve", "BRAKE", "--model", "sine", "--elements", 10),
    "no elements": ("solve", "BRAKE", "--elements", 0),
    "fields": ("solve", "BRAKE", "--fields", "x.png"),
    "torque without unit": ("size", "BRAKE", "--vary", "friction", "--torque", 400),
    "no question": ("size", "BRAKE", "--vary", "friction"),
    "out of reach": ("size", "BRAKE", "--vary", "friction", "--model", "sine", "--torque", "9 N m"),
    "far": ("wear", "BRAKE", "--elements", 10, "--distance", "9000 km"),
    "brake for sweep": ("sweep", "BRAKE"),
    "steps": ("hold", "BRAKE", "--steps", 0),
}


# The row of the page, by the mistake.
ROW_OF_MISTAKE = {
    "quotation mark": "is not TOML",
    "misspelt table": "unknown key",
    "no unit": "has no unit",
    "wrong unit": " such as '",
    "high friction": "self-locking, ",
    "no friction": "is missing",
    "short lining": "must be greater than",
    "short body": "must lie within",
    "negative width": "must be greater than",
    "wide gap": "it would have to turn by",
    "no hinge": "is held by one of",
    "example": "no such example",
    "file": "cannot be read",
    "model": "unknown model",
    "model of another brake": "does not apply to this brake",
    "option of another model": " to --model ",
    "no elements": "must be from",
    "fields": "must end in .vtu",
    "torque without unit": "has no unit",
    "no question": "give at least one of both",
    "out of reach": "not possible with",
    "far": "is worn through",
    "brake for sweep": "a key of brake files",
    "steps": "must be from",
}


def check_troubleshooting_has_row(which, line):
    """The page on troubleshooting has the row for a mistake, and the error message its words."""
    rows = re.findall(r"(?m)^\| `(.*?)` \|", TROUBLESHOOTING.read_text(encoding="utf-8"))
    assert ROW_OF_MISTAKE[which] in rows
    assert ROW_OF_MISTAKE[which] in line


@pytest.mark.parametrize("which", WRONG_FILES)
def test_troubleshooting_has_a_row_for_a_wrong_brake_file(which, tmp_path):
    right = (STUDY / "brake.toml").read_text()
    wrong = right.replace(*WRONG_FILES[which], 1)
    assert wrong != right
    (tmp_path / "my.toml").write_text(wrong)
    done = command("solve", tmp_path / "my.toml")
    assert done.returncode in {2, 3}
    check_troubleshooting_has_row(which, done.stderr)


@pytest.mark.parametrize("which", WRONG_WORDS)
def test_troubleshooting_has_a_row_for_a_wrong_command(which, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = [STUDY / "brake.toml" if word == "BRAKE" else word for word in WRONG_WORDS[which]]
    done = command(*words)
    assert done.returncode in {2, 3}
    check_troubleshooting_has_row(which, done.stderr)
    assert list(tmp_path.iterdir()) == []
