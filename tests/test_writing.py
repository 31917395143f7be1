"""A brake written as a file reads as the same brake."""

import tomllib

import pytest

from conftest import ROOT, partly
from drumlin.brake import read_drum_or_plane_brake, vary
from drumlin.brake.writing import brake_file_text, quoted_toml_text_of_quantity
from drumlin_studies.random_brake import draw_random_brake
from flat_pads import LINING, pad
from shared_forces import cam_brake, servo

FILES = [*ROOT.glob("studies/*/*.toml"), *ROOT.glob("meshes/*.toml")]
BRAKES = [path for path in FILES if "shoe" in tomllib.loads(path.read_text())]


@pytest.mark.parametrize("path", BRAKES, ids=lambda path: path.stem)
def test_every_example_reads_as_it_was_written(path):
    brake = read_drum_or_plane_brake(path)
    text = brake_file_text(brake)
    assert read_drum_or_plane_brake(path, text) == brake
    assert len(text) < 6000


@pytest.mark.parametrize("seed", partly(range(40), range(10)))
def test_a_random_brake_reads_as_it_was_written(seed, tmp_path):
    brake = draw_random_brake(seed)
    assert read_drum_or_plane_brake(tmp_path / "b.toml", brake_file_text(brake)) == brake


def test_tables_blocks_lobes_and_names(brake, tmp_path):
    changed = vary(
        brake,
        {
            "title": 'µ "quoted"',
            "shoe[0].lining.clearance": [["-70 deg", "0 mm"], ["55 deg", "0.1 mm"]],
            "shoe[1].lining.misfit": {
                "radius": 0.1499,
                "offset": {"x": 1e-5, "y": 0.0},
                "blocks": [[2.5, 1e-5]],
            },
            "drum.out_of_round": [{"order": 2, "amplitude": 2e-5, "phase": 0.1}],
        },
    )
    text = brake_file_text(changed)
    assert read_drum_or_plane_brake(tmp_path / "b.toml", text) == changed
    assert 'clearance = [["-70 deg", "0 mm"], ["55 deg", "0.1 mm"]]' in text


def test_tables_on_a_plane_have_lengths_for_places(tmp_path):
    rows = {"clearance": [[0.06, 0.0], [0.18, 1e-4]], "misfit": {"blocks": [[0.1, 1e-4]]}}
    brake = pad("hinge", lining=LINING | {"start": 0.06, "end": 0.18} | rows)
    text = brake_file_text(brake)
    assert read_drum_or_plane_brake(tmp_path / "b.toml", text) == brake
    assert 'clearance = [["60 mm", "0 mm"], ["180 mm", "0.1 mm"]]' in text
    assert 'blocks = [["100 mm", "0.1 mm"]]' in text


@pytest.mark.parametrize("brake", [cam_brake(), cam_brake(body=0.01), servo(), servo(body=0.01)])
def test_what_follows_from_a_cam_or_a_strut_is_not_repeated(brake, tmp_path):
    text = brake_file_text(brake)
    assert read_drum_or_plane_brake(tmp_path / "b.toml", text) == brake
    assert text.count("force = ") == 1


def test_a_shoe_without_force_says_so(brake, tmp_path):
    still = vary(brake, {"shoe.actuation.force": 0.0})
    assert read_drum_or_plane_brake(tmp_path / "b.toml", brake_file_text(still)) == still


def test_quantities_are_readable_and_exact():
    assert quoted_toml_text_of_quantity(0.15, "m") == '"150 mm"'
    assert quoted_toml_text_of_quantity(2000.0, "N") == '"2 kN"'
    assert quoted_toml_text_of_quantity(0.3, "") == "0.3"
    assert quoted_toml_text_of_quantity(0.1 + 0.2, "rad") == f'"{0.1 + 0.2!r} rad"'
