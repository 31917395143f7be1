"""`drumlin mesh --check` draws a mesh as it was read and says what will be solved."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgba

from command_line import drumlin
from drumlin import BadInput, vary
from drumlin.brake.file import read_brake
from drumlin.brake.writing import brake_file_text
from drumlin.fem.mesh.arc import parametric_mesh_of_shoe
from drumlin.fem.mesh.file import write_shoe_mesh_to_file
from drumlin.report.mesh_check import (
    MESH_GROUP_COLORS,
    draw_checked_meshes,
    mean_lining_compression_under_actuation_force,
    read_mesh_files_of_brake,
    text_lines_about_mesh_to_be_solved,
)

ELEMENTS = 12
GAP = 20e-6


@pytest.fixture
def standing_off(tmp_path, brake):
    """The brake with one shoe, whose mesh is GAP away from the drum at all contact nodes."""
    shoe = brake.shoes[0]
    mesh = parametric_mesh_of_shoe(shoe, brake.size, ELEMENTS, "tri1")
    on_drum = np.unique(mesh.facets[:, mesh.boundaries["contact"]])
    mesh.p[:, on_drum] *= 1 - shoe.sign_internal_plus_external_minus * GAP / brake.size
    write_shoe_mesh_to_file(tmp_path / "off.msh", mesh, shoe)
    alone = vary(brake, {"shoe": [shoe.model_dump()]})
    return vary(alone, {"shoe[0].mesh": str(tmp_path / "off.msh")})


def test_the_picture_shows_groups_and_the_contact_line(standing_off):
    checked = read_mesh_files_of_brake(standing_off)
    figure = draw_checked_meshes(standing_off, checked)
    groups, offsets = figure.axes
    mesh = checked[0].read.mesh
    # Every element and every named side is drawn, in the colour of its group.
    drawn = {}
    for part in groups.collections:
        if isinstance(part, PolyCollection):
            drawn[tuple(part.get_facecolor()[0])] = len(part.get_paths())
        elif isinstance(part, LineCollection):
            drawn[tuple(part.get_edgecolor()[0])] = len(part.get_paths())
    named = {**mesh.subdomains, **mesh.boundaries}
    assert drawn == {to_rgba(MESH_GROUP_COLORS[name]): len(of) for name, of in named.items()}
    # The contact line stands 20 um off the drum, over the arc of the lining.
    (curve,) = (line for line in offsets.get_lines() if "in the file" in line.get_label())
    assert curve.get_ydata() == pytest.approx(20, rel=1e-6)
    lining = standing_off.shoes[0].lining
    assert curve.get_xdata()[[0, -1]] == pytest.approx(np.degrees([lining.start, lining.end]))
    assert offsets.get_ylim()[1] > 20
    assert (groups.get_xlabel(), offsets.get_ylabel()[-4:]) == ("x [mm]", "[\u00b5m]")


def test_three_lines_say_what_will_be_solved(standing_off):
    (checked,) = read_mesh_files_of_brake(standing_off)
    elements, contact, held = text_lines_about_mesh_to_be_solved(standing_off, checked)
    mesh = checked.read.mesh
    assert f"{mesh.nelements} linear triangles (lining {len(mesh.subdomains['lining'])}" in elements
    sides = len(mesh.boundaries["contact"])
    assert (
        f"contact line of {sides} sides from -70 deg to 55 deg, in the file up to 20 um" in contact
    )
    assert "2 kN at 0 deg act on the" in held


def test_the_compression_is_that_of_a_layer_under_an_even_pressure(brake):
    shoe = brake.shoes[0]
    # 2 kN on 40 mm times 125 deg of an arc of 150 mm, through 8 mm of 300 MPa.
    pressure = 2000 / (0.04 * np.radians(125) * 0.15)
    assert mean_lining_compression_under_actuation_force(brake, shoe) == pytest.approx(
        pressure * 0.008 / 300e6
    )


def test_a_brake_without_mesh_file_is_refused(brake):
    with pytest.raises(BadInput, match="no shoe has a mesh file"):
        read_mesh_files_of_brake(brake)


@pytest.mark.slow
def test_a_picture_that_stands_there_is_replaced_only_by_name(tmp_path, standing_off):
    file = tmp_path / "own.toml"
    file.write_text(brake_file_text(standing_off))
    assert read_brake(file).shoes[0].mesh is not None
    first = drumlin("mesh", file, "--check")
    assert first.returncode == 0
    picture = tmp_path / "own_mesh.png"
    assert picture.read_bytes()[:4] == b"\x89PNG"
    picture.write_text("mine")
    second = drumlin("mesh", file, "--check")
    assert (second.returncode, picture.read_text()) == (2, "mine")
    assert f"exists already; --output {picture} replaces it" in second.stderr
    named = drumlin("mesh", file, "--check", "--output", picture)
    assert (named.returncode, picture.read_bytes()[:4]) == (0, b"\x89PNG")
    other = drumlin("mesh", file, "--check", "--kind", "tri2")
    assert (other.returncode, "--kind = tri2: does not belong" in other.stderr) == (2, True)
