"""Mesh files as people have them give the mesh that they mean, or a line that names the cause."""

import random

import numpy as np
import pytest

from decks import (
    DEFINITIONS,
    ELEMENTS,
    SAME,
    deck_of,
    every_fifth_cell_cut,
    moved_nodes,
    rounded,
    straightened,
    with_corners_in_sets_alone,
    with_drum,
)
from drumlin import BadInput, vary
from drumlin.cli.answer import print_brake_response
from drumlin.fem.error_control import degrees
from drumlin.fem.mesh.arc import parametric_mesh_of_shoe
from drumlin.fem.mesh.file import (
    read_shoe_mesh_from_file,
    read_shoe_mesh_with_notes,
    write_shoe_mesh_to_file,
)
from drumlin.fem.mesh.from_file import count_changes_between_rise_and_fall
from drumlin.fem.solve import solve
from drumlin.mesh_files.content import digest_of_mesh_file
from drumlin.mesh_files.content_of_file import largest_rounding_errors_of_coordinates
from drumlin.mesh_files.inp import read_mesh_from_inp_text
from drumlin.mesh_files.msh4 import read_mesh_in_gmsh_format_4
from picking import saying


def edge_counts(mesh):
    """How many edges each named boundary of a mesh has."""
    return {name: len(edges) for name, edges in mesh.boundaries.items()}


@pytest.fixture
def shoe(brake):
    return brake.shoes[0]


@pytest.mark.parametrize("case", SAME)
def test_a_deck_written_otherwise_is_the_same_mesh(tmp_path, brake, shoe, case):
    radius = brake.drum.radius
    text = deck_of(tmp_path, shoe, radius)
    plain = read_shoe_mesh_from_file(tmp_path / "plain.inp", shoe, radius)
    (tmp_path / "other.inp").write_text(SAME[case](text))
    other = read_shoe_mesh_from_file(tmp_path / "other.inp", shoe, radius)
    assert other.t.shape == plain.t.shape
    assert edge_counts(other) == edge_counts(plain)
    for name, facets in plain.boundaries.items():
        on = other.boundaries[name]
        ends = plain.p[:, plain.facets[:, facets]].mean(axis=(1, 2))
        assert other.p[:, other.facets[:, on]].mean(axis=(1, 2)) == pytest.approx(ends, abs=1e-12)
    # Decks may number their nodes in another order, so that points are compared sorted.
    order = [np.lexsort(np.round(plain.p, 9)), np.lexsort(np.round(other.p, 9))]
    assert other.p[:, order[1]] == pytest.approx(plain.p[:, order[0]], abs=1e-12)


REFUSED = {
    "*NGEN\n1, 3, 1\n": r"\*NGEN makes nodes",
    "*NFILL\nA, B, 3, 1\n": r"\*NFILL makes nodes",
    "*NCOPY, CHANGE NUMBER=100, OLD SET=A, SHIFT\n": r"\*NCOPY makes nodes",
    "*ELGEN\n1, 3\n": r"\*ELGEN makes nodes",
    "*IMPERFECTION, FILE=a\n": r"\*IMPERFECTION moves nodes",
    "*NODE, SYSTEM=S\n9999, 1., 2., 3.\n": "SYSTEM=S is not read",
    "*NODE, INPUT=more.txt\n": r"\*NODE, INPUT= reads",
    "*INCLUDE, INPUT=more.txt\n": "more.txt: there is no such file",
    "*ELEMENT, TYPE=CAX4\n9999, 1, 2, 3, 4\n": "TYPE=CAX4 is axisymmetric",
    "*ELEMENT, TYPE=CPS3\n9999, 1, 2, 88888\n": "element 9999 has the node 88888",
    "*NSET, NSET=CONTACT\n88888\n": "the set CONTACT names the node 88888",
    "*NSET, NSET=CONTACT\nNOSET\n": "the set CONTACT names 'noset'",
    "*NSET, NSET=CONTACT, ELSET=LINING\n": r"the set CONTACT: \*NSET, ELSET= names",
    "*SURFACE, NAME=CONTACT, COMBINE=UNION\nA, B\n": r"the surface CONTACT: \*SURFACE, COMBINE=",
}


@pytest.mark.parametrize("added", REFUSED)
def test_what_would_change_the_mesh_and_is_not_read_is_refused_by_name(
    tmp_path, brake, shoe, added
):
    path = tmp_path / "other.inp"
    path.write_text(deck_of(tmp_path, shoe, brake.drum.radius) + added)
    with pytest.raises(BadInput, match=REFUSED[added]) as refusal:
        read_shoe_mesh_from_file(path, shoe, brake.drum.radius)
    assert "\n" not in str(refusal.value)


def test_surfaces_of_elements_name_edges(tmp_path, brake, shoe):
    """Without a face an element stands for its edges on the outline, and a line for itself."""
    text = deck_of(tmp_path, shoe, brake.drum.radius)
    text += "*ELEMENT, TYPE=T2D2, ELSET=LINES\n9999, 1, 2\n"
    text += "*ELEMENT, TYPE=SPRINGA, ELSET=LINES\n10000, 1, 2\n"
    for name, lines in {
        "OUTSIDE": "LINING,\nSHOE,\n",
        "LINES": "LINES,\n",
        "FACE": "1, S2\n",
        "BEYOND": "1, S5\n",
        "UNKNOWN": "77777, S1\n",
        "CUT": "1, SPOS\n",
    }.items():
        text += f"*SURFACE, NAME={name}\n{lines}"
    found = read_mesh_from_inp_text(text + "*SURFACE, NAME=OTHER, TYPE=CYLINDER\n0., 0.\n")
    mesh = read_shoe_mesh_from_file(tmp_path / "plain.inp", shoe, brake.drum.radius)
    assert len(found.edge_groups["outside"]) == len(mesh.boundary_facets())
    assert found.edge_groups["lines"].tolist() == [[0, 1]]
    assert found.edge_groups["face"].tolist() == [found.cells["quad"][0, 1:3].tolist()]
    assert found.broken["beyond"] == (
        "the surface BEYOND: S5 is no edge of a plane element; must be S1 to S4"
    )
    assert found.broken["unknown"] == (
        "the surface UNKNOWN names the element 77777, which the file does not define"
    )
    assert "SPOS is no edge" in found.broken["cut"]
    assert found.broken["other"] == "the surface OTHER: TYPE=CYLINDER is not read"


def test_included_files_are_read_and_belong_to_the_content(tmp_path, brake, shoe):
    text = deck_of(tmp_path, shoe, brake.drum.radius)
    mesh = DEFINITIONS.match(text).group()
    (tmp_path / "nodes.txt").write_text(mesh)
    (tmp_path / "other.inp").write_text("*INCLUDE, INPUT=nodes.txt\n" + text[len(mesh) :])
    plain = read_shoe_mesh_from_file(tmp_path / "plain.inp", shoe, brake.drum.radius)
    other = read_shoe_mesh_from_file(tmp_path / "other.inp", shoe, brake.drum.radius)
    assert np.array_equal(other.p, plain.p)
    # A change of the included file alone must change the digest, by which sweeps know a mesh.
    before = digest_of_mesh_file(tmp_path / "other.inp")
    (tmp_path / "nodes.txt").write_text(mesh + "** changed\n")
    assert digest_of_mesh_file(tmp_path / "other.inp") != before


def test_unknown_keywords_and_plane_strain_are_said(tmp_path, brake, shoe):
    text = deck_of(tmp_path, shoe, brake.drum.radius).replace("CPS4", "CPE4")
    (tmp_path / "other.inp").write_text(text + "*TIE, NAME=T\nA, B\n")
    found = read_shoe_mesh_with_notes(tmp_path / "other.inp", shoe, brake.drum.radius)
    assert saying(found.notes, "passed over: *TIE")
    assert saying(found.notes, "CPE4 is plane strain")


@pytest.mark.parametrize("decimals", [3, pytest.param(2, marks=pytest.mark.slow)])
def test_rounded_coordinates_do_not_change_the_pressure(tmp_path, brake, shoe, decimals):
    alone = vary(brake, {"shoe": [shoe.model_dump()]})
    text = deck_of(tmp_path, shoe, brake.drum.radius, "quad2")
    path = tmp_path / "other.inp"
    path.write_text(rounded(text, decimals))
    right = solve(vary(alone, {"shoe.mesh": str(tmp_path / "plain.inp")}))
    found = solve(vary(alone, {"shoe.mesh": str(path), "shoe.mesh_unit": "mm"}))
    assert found.torque == pytest.approx(right.torque, rel=1e-3)
    assert found.shoes[0].peak_pressure == pytest.approx(right.shoes[0].peak_pressure, rel=5e-3)
    assert saying(found.notes, "were put on the drum")


def test_nodes_that_were_put_on_the_drum_are_no_gap(tmp_path, brake, shoe, monkeypatch):
    """Round-off of 1e-17 m in their distance once made every such file pay a further solve."""
    path = tmp_path / "rounded.inp"
    path.write_text(rounded(deck_of(tmp_path, shoe, brake.drum.radius, "quad2"), 3))
    causes = []
    monkeypatch.setattr(
        degrees, "_errors_by_change_of_shape", lambda *given: causes.append(given[-1]) or 0.0
    )
    keys = {"shoe.mesh": str(path), "shoe.mesh_unit": "mm"}
    assert solve(vary(vary(brake, {"shoe": [shoe.model_dump()]}), keys)).error is not None
    assert "without gaps below the rounding of coordinates" not in causes


def test_middle_nodes_of_straight_sides_are_put_on_the_drum(tmp_path, brake, shoe):
    radius = brake.drum.radius
    path = tmp_path / "other.inp"
    path.write_text(straightened(deck_of(tmp_path, shoe, radius, "quad2")))
    found = read_shoe_mesh_with_notes(path, shoe, radius)
    assert found.contact.straight == ELEMENTS
    on = found.mesh.dofs.facet_dofs[0, found.mesh.boundaries["contact"]]
    assert shoe.distances_from_friction_surface(found.mesh.doflocs[:, on], radius) == pytest.approx(
        0, abs=1e-12
    )


@pytest.mark.parametrize("depth", [3e-6, 20e-6])
def test_a_flat_in_rounded_coordinates_stays(tmp_path, brake, shoe, depth):
    """A lining worn over a quarter of its length, in coordinates of 0.001 mm."""
    radius = brake.drum.radius

    def worn(x, y):
        r, angle = np.hypot(x, y), np.arctan2(y, x)
        middle = shoe.frame.surface_coordinates_of_phi(np.array([sum(shoe.arc) / 2]))[0]
        # The difference of the angles is taken within half a turn.
        inside = abs(np.angle(np.exp(1j * (angle - middle)))) < 0.4 and r > radius * (1 - 1e-6)
        scale = 1e3 * (1 - inside * depth / r)
        return round(scale * x, 3), round(scale * y, 3)

    path = tmp_path / "worn.inp"
    path.write_text(moved_nodes(deck_of(tmp_path, shoe, radius, "quad2"), worn))
    in_mm = vary(brake, {"shoe[0].mesh": str(path), "shoe[0].mesh_unit": "mm"}).shoes[0]
    mesh = read_shoe_mesh_from_file(path, in_mm, radius)
    nodes = np.unique(mesh.facets[:, mesh.boundaries["contact"]])
    off = shoe.distances_from_friction_surface(mesh.p[:, nodes], radius)
    assert off.max() == pytest.approx(depth, abs=1e-6)
    assert np.count_nonzero(off > depth / 2) > 2


def test_a_zigzag_is_no_lining(tmp_path, brake, shoe):
    radius = brake.drum.radius
    alone = vary(brake, {"shoe": [shoe.model_dump()]})
    count = iter(range(10**6))

    def shaken(x, y):
        on = np.hypot(x, y) > radius * (1 - 1e-6)
        # Every other node of the contact line lies 3 um too deep.
        scale = 1 - on * (next(count) % 2) * 2e-5
        return scale * x, scale * y

    path = tmp_path / "shaken.inp"
    path.write_text(moved_nodes(deck_of(tmp_path, shoe, radius), shaken))
    with pytest.raises(BadInput, match="a zigzag or a polygon is no lining"):
        solve(vary(alone, {"shoe.mesh": str(path)}))


def test_digits_and_turns():
    assert largest_rounding_errors_of_coordinates(
        np.array([[1.25, 3.0], [0.07, 12.57]])
    ) == pytest.approx(0.005)
    assert (
        largest_rounding_errors_of_coordinates(np.random.default_rng(0).random((20, 2))).max()
        < 1e-11
    )
    assert count_changes_between_rise_and_fall(np.array([0.0, 1, 0, 1, 0.9, 1, 0]), 0.5) == 3
    # The last digit of a subnormal number has no place value in double precision.
    tiny = np.array([[0.12, 1e-320], [0.5, -5e-324]])
    assert largest_rounding_errors_of_coordinates(tiny)[:, 0] == pytest.approx(0.005)


@pytest.mark.parametrize("kind", ["tri1", "quad2"])
def test_groups_by_number_text_4_1_and_unnamed_entities(tmp_path, brake, shoe, kind):
    """Gmsh's own file without names of groups; edges of no group as Mesh.SaveAll writes them."""
    gmsh = pytest.importorskip("gmsh")
    radius = brake.drum.radius
    path = tmp_path / "named.msh"
    write_shoe_mesh_to_file(path, parametric_mesh_of_shoe(shoe, radius, ELEMENTS, kind), shoe)
    plain = read_shoe_mesh_from_file(path, shoe, radius)
    gmsh.initialize(readConfigFiles=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(path))
        numbers = {
            gmsh.model.getPhysicalName(dim, tag): tag for dim, tag in gmsh.model.getPhysicalGroups()
        }
        # Without its names the file has groups by number alone.
        for name in numbers:
            gmsh.model.removePhysicalName(name)
        gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
        gmsh.write(str(tmp_path / "numbers.msh"))
        gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
        gmsh.write(str(tmp_path / "numbers_2.msh"))
    finally:
        gmsh.finalize()
    # The refusal proposes the table of groups that the brake file needs.
    for file in ("numbers.msh", "numbers_2.msh"):
        with pytest.raises(BadInput, match=r"found: [\d, ]+ \(names .*groups = \{ "):
            read_shoe_mesh_from_file(tmp_path / file, shoe, radius)
    numbered = vary(
        brake, {"shoe[0].mesh": str(tmp_path / "numbers.msh"), "shoe[0].groups": numbers}
    )
    other = read_shoe_mesh_from_file(tmp_path / "numbers.msh", numbered.shoes[0], radius)
    assert other.nelements == plain.nelements
    assert edge_counts(other) == edge_counts(plain)


@pytest.mark.slow
def test_mixed_cells_become_quadratic_triangles(tmp_path, brake, shoe):
    radius = brake.drum.radius
    alone = vary(brake, {"shoe": [shoe.model_dump()]})
    text = deck_of(tmp_path, shoe, radius)
    path = tmp_path / "mixed.inp"
    path.write_text(every_fifth_cell_cut(text))
    found = solve(vary(alone, {"shoe.mesh": str(path)}))
    assert found.torque == pytest.approx(solve(alone).torque, rel=2e-3)
    assert saying(found.notes, "solved as")


def test_corners_of_edges_name_quadratic_edges(tmp_path, brake, shoe):
    text = deck_of(tmp_path, shoe, brake.drum.radius, "quad2")
    (tmp_path / "corners.inp").write_text(with_corners_in_sets_alone(text))
    plain = read_shoe_mesh_from_file(tmp_path / "plain.inp", shoe, brake.drum.radius)
    other = read_shoe_mesh_from_file(tmp_path / "corners.inp", shoe, brake.drum.radius)
    for name, facets in plain.boundaries.items():
        assert np.array_equal(other.boundaries[name], facets)


def test_decks_named_msh_and_inches(tmp_path, brake, shoe):
    radius = brake.drum.radius
    text = deck_of(tmp_path, shoe, radius)
    path = tmp_path / "all.msh"
    path.write_text(moved_nodes(text, lambda x, y: (x / 0.0254, y / 0.0254)))
    inches = vary(brake, {"shoe[0].mesh": str(path), "shoe[0].mesh_unit": "in"}).shoes[0]
    plain = read_shoe_mesh_from_file(tmp_path / "plain.inp", shoe, radius)
    assert read_shoe_mesh_from_file(path, inches, radius).p == pytest.approx(plain.p, abs=1e-12)


MSH = {
    "4.1": (
        "0 0 1 0\n7 0 0 0 1 1 0 2 5 6 0\n",
        "1 4 1 4\n2 7 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n",
        "2 3 1 3\n1 3 1 1\n1 1 2\n2 7 2 2\n2 1 2 3\n3 1 3 4\n",
    ),
    "4": (
        "0 0 1 0\n7 0 0 0 1 1 0 2 5 6 0\n",
        "1 4\n7 2 0 4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n",
        "2 3\n3 1 1 1\n1 1 2\n7 2 2 2\n2 1 2 3\n3 1 3 4\n",
    ),
}


@pytest.mark.parametrize("version", MSH)
def test_text_of_gmsh_4_with_an_entity_of_no_group_and_one_of_two(version):
    entities, nodes, elements = MSH[version]
    names = '1\n2 5 "Lining"\n'
    text = f"$MeshFormat\n{version} 0 8\n$EndMeshFormat\n"
    blocks = {"PhysicalNames": names, "Entities": entities, "Nodes": nodes, "Elements": elements}
    text += "".join(f"${name}\n{block}$End{name}\n" for name, block in blocks.items())
    found = read_mesh_in_gmsh_format_4(text)
    assert found.cells["triangle"].tolist() == [[0, 1, 2], [0, 2, 3]]
    assert found.cells["line"].tolist() == [[0, 1]]
    for name in ("lining", "5", "6"):
        assert found.cell_groups[name]["triangle"].tolist() == [0, 1]
    assert set(found.names_of_all_groups) == {"lining", "5", "6"}
    with pytest.raises(ValueError, match="has fewer lines than it says"):
        read_mesh_in_gmsh_format_4(text.replace("3 1 3 4\n", ""))


def test_damaged_decks_with_parts_are_read_or_refused_in_one_line(tmp_path, brake, shoe):
    radius = brake.drum.radius
    text = with_drum(deck_of(tmp_path, shoe, radius))
    words = ["-1", "0", "1e300", "nan", "99999", "x", "*NSET", "*END PART", "", "Shoe-1.7"]
    rng, path, refused = random.Random(3), tmp_path / "damaged.inp", 0
    for _ in range(60):
        lines = text.split("\n")
        at = rng.randrange(len(lines))
        row = lines[at].split(",")
        row[rng.randrange(len(row))] = rng.choice(words)
        # A line is lost, gets a wrong word, or stands twice.
        lines[at : at + 1] = rng.choice([[], [",".join(row)], [lines[at]] * 2])
        path.write_text("\n".join(lines))
        try:
            read_shoe_mesh_from_file(path, shoe, radius)
        except BadInput as refusal:
            refused += 1
            assert "\n" not in str(refusal)
    # Enough of the damage must matter, or the test would show nothing.
    assert refused > 10


@pytest.mark.parametrize("given", [-3.5, True, "", [1, 2.5], [True]])
def test_a_group_that_is_no_name_and_no_number_is_refused_in_words(brake, given):
    """Without the words of a reader, and never taken as the number 1."""
    with pytest.raises(BadInput) as refused:
        vary(brake, {"shoe[0].groups": {"contact": given}})
    key, _, allowed = str(refused.value).rpartition(": must be ")
    assert key.startswith("shoe[0].groups.contact")
    assert key.count("[") <= 2
    assert allowed == (
        "the name or the whole number of a group in the mesh file, or a list of these"
    )


@pytest.mark.slow
def test_what_was_moved_is_said_with_the_answer(tmp_path, brake, shoe, capsys):
    """Not with --verbose alone: who reads the torque must see that nodes were moved."""
    path = tmp_path / "straight.inp"
    path.write_text(straightened(deck_of(tmp_path, shoe, brake.size, "quad2")))
    alone = vary(brake, {"shoe": [shoe.model_dump()]})
    moved = vary(alone, {"shoe.mesh": str(path)})
    print_brake_response(moved, solve(moved))
    assert "middle nodes of the contact line were put on the drum" in " ".join(
        capsys.readouterr().out.split()
    )
