"""Meshes of VTK, Nastran, MED and universal files are the meshes that were written, or one line."""

import random
import re
import sys

import numpy as np
import pytest

from conftest import partly
from drumlin import BadInput, solve, vary
from drumlin.fem.mesh.arc import MESH_KINDS, parametric_mesh_of_shoe
from drumlin.fem.mesh.file import (
    read_shoe_mesh_from_file,
    read_shoe_mesh_with_notes,
    write_shoe_mesh_to_file,
)
from drumlin.mesh_files.labelled_mesh import MOST_MEMBERS_OF_GROUP_RANGES
from drumlin.mesh_files.nastran import read_mesh_in_nastran_bulk_data
from drumlin.mesh_files.nastran_cards import NastranBulkCard, split_bulk_data_into_cards
from drumlin.mesh_files.reading import read_content_of_mesh_file
from drumlin.mesh_files.unv import read_mesh_in_universal_file
from drumlin.mesh_files.vtk import check_vtk_file_is_unstructured_and_fits_memory
from drumlin_studies.fuzzing.broken_meshes import (
    GROUPS_IN_NASTRAN_FILE,
    mesh_parts_in_brake_frame,
)
from drumlin_studies.fuzzing.faults import bytes_with_random_noise
from drumlin_studies.fuzzing.foreign_meshes import (
    mesh_as_nastran_text,
    mesh_as_universal_text,
    mesh_as_vtk_text,
    write_mesh_as_med_file,
)
from picking import saying

ELEMENTS = 12
# The answers of the right shoe alone on hp elements, whose stated errors are 0.0004 % and 0.2 %.
TORQUE, PEAK = 126.158, 0.6861e6
FORMS = {"free.bdf": "free", "small.nas": "small", "large.dat": "large"}
FILES = [*FORMS, "a.vtk", "a.unv", "a.med"]


@pytest.fixture
def alone(brake):
    """The brake with its right shoe alone, whose answers are TORQUE and PEAK."""
    (right,) = [shoe for shoe in brake.shoes if shoe.name == "right"]
    return vary(brake, {"shoe": [right.model_dump()]})


def written(alone, folder, name, kind):
    """The brake with the parametric mesh of its shoe in a file of millimetres."""
    shoe, path = alone.shoes[0], folder / name
    mesh = parametric_mesh_of_shoe(shoe, alone.drum.radius, ELEMENTS, kind)
    parts = mesh_parts_in_brake_frame(mesh, shoe)
    parts = parts._replace(xy=1e3 * parts.xy)
    changes: dict[str, object] = {"shoe[0].mesh": str(path), "shoe[0].mesh_unit": "mm"}
    if name in FORMS:
        changes["shoe[0].groups"] = GROUPS_IN_NASTRAN_FILE
        path.write_text(mesh_as_nastran_text(*parts, FORMS[name]))
    elif name.endswith("med"):
        pytest.importorskip("h5py")
        write_mesh_as_med_file(path, *parts)
    else:
        text = mesh_as_vtk_text if name.endswith("vtk") else mesh_as_universal_text
        path.write_text(text(*parts))
    return vary(alone, changes), mesh


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("kind", MESH_KINDS)
def test_a_file_is_the_mesh_that_was_written(tmp_path, alone, name, kind):
    brake, mesh = written(alone, tmp_path, name, kind)
    found = read_shoe_mesh_from_file(tmp_path / name, brake.shoes[0], alone.drum.radius)
    # Eight characters leave 0.001 mm of -137.163, and universal files lack centre nodes.
    middle = 1e-5 if kind == "quad2" and name == "a.unv" else 1e-12
    far = 8e-7 if name == "small.nas" else middle
    assert found.doflocs == pytest.approx(mesh.doflocs, abs=far)
    assert np.array_equal(found.t, mesh.t)
    for group in GROUPS_IN_NASTRAN_FILE:
        assert np.array_equal(np.sort(found.boundaries[group]), np.sort(mesh.boundaries[group]))
    for group in ("lining", "shoe"):
        assert np.array_equal(np.sort(found.subdomains[group]), np.sort(mesh.subdomains[group]))


@pytest.mark.parametrize("name", partly(FILES, {"small.nas"}))
def test_a_file_gives_the_known_answer_within_the_stated_error(tmp_path, alone, name):
    brake, _ = written(alone, tmp_path, name, "tri2")
    found = solve(brake)
    assert found.torque == pytest.approx(TORQUE, rel=found.error["torque"] + 4e-6)
    peak = found.shoes[0].peak_pressure
    assert peak == pytest.approx(PEAK, rel=found.error["peak"] + 2e-3)
    assert found.error["torque"] < 1e-3 and found.error["peak"] < 0.01


def in_order(points):
    """The points (2, n) sorted by their coordinates."""
    return points[:, np.lexsort(np.round(points, 6))]


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 2])
def test_files_that_gmsh_writes_are_the_mesh_of_its_own_format(tmp_path, alone, order):
    """Another program writes the files, so that the orders of nodes are not drumlin's own."""
    gmsh = pytest.importorskip("gmsh")
    shoe, radius = alone.shoes[0], alone.drum.radius
    path = tmp_path / "own.msh"
    write_shoe_mesh_to_file(
        path, parametric_mesh_of_shoe(shoe, radius, ELEMENTS, f"tri{order}"), shoe
    )
    plain = read_shoe_mesh_from_file(path, shoe, radius)
    gmsh.initialize()
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(path))
        numbers = {
            gmsh.model.getPhysicalName(*group): group[1] for group in gmsh.model.getPhysicalGroups()
        }
        # The tag of an element is its physical group, and its fields have 16 characters.
        gmsh.option.setNumber("Mesh.SaveElementTagType", 2)
        gmsh.option.setNumber("Mesh.BdfFieldFormat", 2)
        for suffix in ("bdf", "med", "unv", "vtk"):
            gmsh.write(str(tmp_path / f"gmsh.{suffix}"))
    finally:
        gmsh.finalize()
    keys = {"shoe[0].mesh": str(path), "shoe[0].groups": numbers}
    numbered = vary(alone, keys).shoes[0]
    for suffix in ("bdf", "med", "unv", "vtk"):
        if suffix == "med":
            pytest.importorskip("h5py")
        named = numbered if suffix in ("bdf", "vtk") else shoe
        found = read_shoe_mesh_from_file(tmp_path / f"gmsh.{suffix}", named, radius)
        # Gmsh numbers nodes and elements anew, so that places are compared in sorted order.
        assert in_order(found.doflocs) == pytest.approx(in_order(plain.doflocs), abs=1e-8)
        for group, facets in plain.boundaries.items():
            middles = found.p[:, found.facets[:, found.boundaries[group]]].mean(axis=1)
            expected = in_order(plain.p[:, plain.facets[:, facets]].mean(axis=1))
            assert in_order(middles) == pytest.approx(expected, abs=1e-8)
        for group, elements in plain.subdomains.items():
            middles = found.p[:, found.t[:, found.subdomains[group]]].mean(axis=1)
            expected = in_order(plain.p[:, plain.t[:, elements]].mean(axis=1))
            assert in_order(middles) == pytest.approx(expected, abs=1e-8)


SQUARE = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,1.,0.\nGRID,4,,0.,1.,0.\n"
PLACES = {
    "rectangular": (
        "CORD2R,5,0,10.,0.,0.,10.,0.,1.\n+,10.,1.,0.\nGRID,9,5,2.,3.,0.\n",
        [7.0, 2.0, 0.0],
    ),
    "in another one": (
        "CORD2R,6,5,1.,0.,0.,1.,0.,1.\n+,2.,0.,0.\n"
        "CORD2R,5,0,10.,0.,0.,10.,0.,1.\n+,10.,1.,0.\nGRID,9,6,2.,3.,0.\n",
        [7.0, 3.0, 0.0],
    ),
    "cylindrical": (
        "CORD2C,5,,0.,0.,0.,0.,0.,1.\n+,1.,0.,0.\nGRID,9,5,2.,90.,0.\n",
        [0.0, 2.0, 0.0],
    ),
    "of grid points": (
        "GRID,7,,1.,0.,1.\nCORD1R,5,2,7,3\nGRID,9,5,2.,3.,0.\n",
        [-2.0, 2.0, 0.0],
    ),
    "two on a card": (
        "GRID,7,,1.,0.,1.\nCORD1R,4,1,2,3,5,2,7,3\nGRID,9,5,2.,3.,0.\n",
        [-2.0, 2.0, 0.0],
    ),
    "the default": (
        "GRDSET,,5\nCORD2C,5,0,0.,0.,0.,0.,0.,1.\n+,1.,0.,0.\nGRID,9,,2.,180.,0.\n",
        [-2.0, 0.0, 0.0],
    ),
    "columns of eight": (
        "CORD2R         5       0     10.      0.      0.     10.      0.      1.+A\n"
        "+A           10.      1.      0.\n"
        "GRID           9       5      2.    3.+0      0.\n",
        [7.0, 2.0, 0.0],
    ),
}


@pytest.mark.parametrize("case", PLACES)
def test_grid_points_stand_where_their_system_puts_them(case):
    cards, place = PLACES[case]
    found = read_mesh_in_nastran_bulk_data(
        SQUARE.replace(",,", ",0,") + cards + "CQUAD4,1,1,1,2,3,4\n"
    )
    assert found.points[-1] == pytest.approx(place, abs=1e-12)
    assert found.turned and found.points[2] == pytest.approx([1.0, 1.0, 0.0])


NOT_READ = {
    "GRID,9,5,1.,1.,0.\n": "GRID 9: the coordinate system 5 is not defined",
    "CORD2S,5,0,0.,0.,0.,0.,0.,1.\n+,1.,0.,0.\nGRID,9,5,1.,1.,0.\n": "CORD2S 5 is not read",
    "CORD2R,5,5,0.,0.,0.,0.,0.,1.\n+,1.,0.,0.\nGRID,9,5,1.,1.,0.\n": "CORD2R 5: .* in itself",
    "CORD1R,5,1,2,9\nGRID,9,5,1.,1.,0.\n": "CORD1R 5: the system is defined in itself",
    "CORD1R,5,1,2,8\nGRID,9,5,1.,1.,0.\n": "the grid point 8, which is not defined",
    "CORD2R,5,0,0.,0.,0.,0.,0.,1.\n+,0.,0.,3.\nGRID,9,5,1.,1.,0.\n": "lie on one line",
    "INCLUDE 'more.bdf'\n": "INCLUDE 'more.bdf': included files are not read",
    "=,*(1),=,*(1.)\n": "copies or deletes other cards",
    "/,1\n": "copies or deletes other cards",
    "CQUAD8,9,1,1,2,3,4,1,2,+B\n+A,3,4\n": "'.A,3,4' continues no card",
    "GRID,1,,0.,0.,0.\n": "GRID 1 is defined twice",
    "CTRIAX6,1,1,1,2,3\n": "CTRIAX6 1 is axisymmetric",
    "CTETRA,1,1,1,2,3,4\n": "CTETRA 1 is a solid element",
    "CQUAD4,1,1,1,2,3,4\n": "element 1 is defined twice",
    "CTRIA6,9,1,1,2,3,4\n": "CTRIA6 9 has some of its 6 nodes",
    "CTRIA3,9,1,1,2,8\n": "element 9 has the node 8, which the file does not define",
    "CTRIA3,9,1,1,2,x\n": "CTRIA3 9: field 6 = 'x' must be a whole number",
    "GRID,9,,1.0e,0.,0.\n": "GRID 9: field 4 = '1.0e' must be a number",
    "SET1,3,1,THRU,9999999999\n": f"SET1 3 has the range .* {MOST_MEMBERS_OF_GROUP_RANGES} labels",
    "SET1,3,4,THRU,2\n": "SET1 3 has the range 4 THRU 2, whose end is before its start",
    "GRID,8,,0.,0.,0.,,,,,9\n": "more than 8 fields",
    "GRDSET,,1\nGRDSET,,2\n": "GRDSET: there are two cards",
    "CTRIA7,9,1,1,2,3\n": "CTRIA7 9 is not read; the elements of a plane mesh",
    "EGRID,1\n": "EGRID 1 makes or moves grid points",
}


@pytest.mark.parametrize("added", NOT_READ)
def test_what_nastran_moves_or_makes_and_is_not_read_is_refused_by_name(tmp_path, added):
    path = tmp_path / "a.bdf"
    path.write_text(f"BEGIN BULK\n{SQUARE}CQUAD4,1,1,1,2,3,4\n{added}ENDDATA\n")
    with pytest.raises(BadInput, match=NOT_READ[added]) as refusal:
        read_content_of_mesh_file(path, "mesh")
    assert "\n" not in str(refusal.value)


def test_cards_of_nastran_in_every_form_of_their_lines():
    text = (
        f"{'GRID*':8}{1:16}{0:16}{'1.5-3':>16}{'-2.D+1':>16}*A\n"
        f"{'*A':8}{'.25':>16}\n"
        "$ a comment\n"
        "CQUAD8         1       7       1       2       3       4       5       6\n"
        "               7       8      .1      .1      .1      .1     30.\n"
        "SET1\t4\t1\tTHRU\t3 $ tabs\n"
        "GRID*,2,,1.,2.,*\n*,3.\n"
    )
    first, quad, points, free = split_bulk_data_into_cards(text)
    assert [first.real_of_field(i) for i in (2, 3, 4)] == [0.0015, -20.0, 0.25]
    assert quad.fields[:10] == ["1", "7", *"12345678"] and quad.fields[14] == "30."
    assert points == NastranBulkCard("SET1", ["4", "1", "THRU", "3", "", "", "", ""])
    assert [free.real_of_field(i) for i in (2, 3, 4)] == [1.0, 2.0, 3.0]


def test_groups_of_nastran_have_numbers_and_the_names_of_preprocessors():
    text = (
        f'{SQUARE}$HMNAME PROP          3"Lining" 4\nPSHELL,3,1,8.\n$ Femap Property 4 : Pin line\n'
        "CQUAD4,1,3,1,2,3,4,0.,0.\nCBAR,2,4,1,2,0.,0.,1.\nSET1,4,1,2\nSPC1,8,123,1,THRU,3\n"
        "RBE2,9,4,123,1,3,1.2-5\nFORCE,11,2,0,1.,1.,0.,0.\nSET3,12,ELEM,1\nSPC,13,1,12,0.,4,12,0.\n"
        "UNKNOWN,1\nMAT1,1,1.\n"
    )
    found = read_mesh_in_nastran_bulk_data(text)
    assert set(found.cell_groups) == {"lining", "3", "pid=3", "pin line", "4", "pid=4"}
    assert found.cell_groups["4"]["line"].tolist() == [0]
    # Property 4 and set 4 are two groups, so that "4" is the property.
    groups = {"set=4": [0, 1], "spc=8": [0, 1, 2], "8": [0, 1, 2], "rbe2=9": [0, 2], "9": [0, 2]}
    groups |= {"force=11": [1], "11": [1], "spc=13": [0, 3], "13": [0, 3]}
    assert {name: members.tolist() for name, members in found.node_groups.items()} == groups
    assert found.notes == ("passed over: UNKNOWN",)


def test_a_field_of_eight_characters_rounds_large_coordinates_more():
    text = "GRID,1,,124.1235,-.123456,0.\nGRID,2,,-24.1235,5.,0.\nGRID,3,,99.,.1234567,0.\n"
    found = read_mesh_in_nastran_bulk_data(text + "CTRIA3,1,1,1,2,3\n")
    assert found.rounding == pytest.approx(
        np.array([[5e-5, 5e-7], [5e-5, 0.5], [0.5, 5e-8]]), rel=1e-9
    )


def test_a_nastran_file_that_was_cut_off_or_has_superelements_says_so():
    for text, line in {
        f"BEGIN BULK\n{SQUARE}CQUAD4,1,1,1,2,3,4\n": "no ENDDATA: the file was cut off",
        f"BEGIN BULK\n{SQUARE}BEGIN SUPER=1\nENDDATA\n": "superelements",
        "MAT1,1,1.\n": "has no GRID card",
    }.items():
        with pytest.raises(ValueError, match=line):
            read_mesh_in_nastran_bulk_data(text)


def dataset(number, lines):
    """The text of a dataset of a universal file."""
    return "\n".join(["    -1", f"{number:6d}", *lines, "    -1", ""])


def unv(elements, *more, system=1):
    """A universal file with six nodes on two quadrilaterals."""
    nodes = []
    for label in range(1, 7):
        nodes.append(f"{label:10d}{system:10d}         1        11")
        nodes.append(f"   {(label - 1) % 3}.0D+00   {(label - 1) // 3}.0D+00   0.0D+00")
    return "".join([dataset(2411, nodes), dataset(2412, elements), *more])


QUADS = ["1 94 3 2 7 4", "1 2 5 4", "2 54 3 2 7 4", "2 3 6 5"]


def test_elements_and_groups_of_a_universal_file():
    beam = ["3 24 5 2 7 3", "0 0 0", "1 2 3", "4 136 1 1 7 2", "1 2"]
    beam += ["5 11 5 2 7 2", "4 5", "6 21 5 2 7 2", "0 0 0", "5 6"]
    groups = ["7 0 0 0 0 0 0 3", "Contact", "8 3 0 0 7 1 0 0", "8 4 0 0"]
    units = dataset(164, ["1 mm", "1.0D+03 1. 1.", "273.15"])
    found = read_mesh_in_universal_file(unv(QUADS + beam, dataset(2467, groups), units))
    assert found.cells["quad"].tolist() == [[0, 1, 4, 3], [1, 2, 5, 4]]
    assert found.cells["line3"].tolist() == [[0, 2, 1]]
    assert found.cells["line"].tolist() == [[3, 4], [4, 5]]
    assert found.cell_groups["contact"]["line3"].tolist() == [0]
    assert found.node_groups["contact"].tolist() == found.node_groups["7"].tolist() == [0]
    assert found.cell_groups["property=3"]["quad"].tolist() == [0, 1]
    assert saying(found.notes, "plane strain") and saying(found.notes, "a metre is 1000 of its")


def test_a_universal_file_goes_round_its_parabolic_elements():
    nodes = [f"{label} 1 1 11\n{label}. {label**2}. 0." for label in range(1, 9)]
    elements = ["1 95 1 1 7 8", "1 5 2 6 3 7 4 8", "2 92 1 1 7 6", "1 5 2 6 3 7"]
    found = read_mesh_in_universal_file(dataset(2411, nodes) + dataset(2412, elements))
    assert found.cells["quad8"].tolist() == [[0, 1, 2, 3, 4, 5, 6, 7]]
    assert found.cells["triangle6"].tolist() == [[0, 1, 2, 4, 5, 6]]


def test_coordinate_systems_of_a_universal_file_are_global_or_refused():
    def placed(label, kind, x):
        head = ["1", "part", f"{label} {kind} 8", "system"]
        return dataset(2420, [*head, "1. 0. 0.", "0. 1. 0.", "0. 0. 1.", f"{x} 0. 0."])

    plain = read_mesh_in_universal_file(unv(QUADS))
    for other in (placed(1, 0, 0.0), placed(2, 0, 3.0)):
        assert np.array_equal(read_mesh_in_universal_file(unv(QUADS, other)).points, plain.points)
    for other in (placed(1, 0, 3.0), placed(1, 1, 0.0), dataset(18, ["1 0 0 8 1", "a", "0", "0"])):
        with pytest.raises(ValueError, match="node 1 lies in the coordinate system 1"):
            read_mesh_in_universal_file(unv(QUADS, other))


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (unv(["1 84 3 2 7 4", "1 2 5 4"]), "element 1 of type 84 is axisymmetric"),
        (unv(["1 111 3 2 7 4", "1 2 5 4"]), "element 1 of type 111 is solid"),
        (unv(["1 46 3 2 7 12", "1 2 5 4 1 2 3 4", "1 2 3 4"]), "not read with 12 nodes"),
        (unv(["1 94 3 2 7 4", "1 2 5"]), "dataset 2412 has 3 numbers on a line in place of 4"),
        (unv(["1 94 3 2 7 4"]), "dataset 2412 ends in the middle"),
        (unv(["1 94 3 2 7 4", "1 2 5 9"]), "element 1 has the node 9"),
        (unv([*QUADS, *QUADS]), "element 1 is defined twice"),
        (unv(QUADS)[:-8], "dataset 2412 does not end with -1"),
        (unv(QUADS, dataset(15, [])), "dataset 15 has nodes in an old form"),
        (unv(QUADS, dataset(2467, ["7 0 0 0 0 0 0 9", "G", "8 3 0 0"])), "ends in the middle"),
        (unv(QUADS, dataset(2467, ["7 0 0 0 0 0 0 1", "G", "8 1 0 0 8 2 0 0"])), "than it says"),
        (unv(QUADS, dataset(164, ["1 SI"])), "dataset 164 has no factor"),
        ("", "has no nodes in a dataset 2411"),
    ],
)
def test_what_a_universal_file_has_and_is_not_read_is_refused(text, line):
    with pytest.raises(ValueError, match=line):
        read_mesh_in_universal_file(text)


def test_a_vtk_file_of_another_kind_or_with_false_counts_is_refused():
    head = b"# vtk DataFile Version 3.0\nx\nASCII\nDATASET "
    for text, line in {
        b"solid": "has no line DATASET",
        head + b"POLYDATA\n": "DATASET POLYDATA is not read",
        head + b"UNSTRUCTURED_GRID\nPOINTS 99999999999999999999999 double\n": "states 9999",
    }.items():
        with pytest.raises(ValueError, match=line):
            check_vtk_file_is_unstructured_and_fits_memory(text)


def test_scalars_of_a_vtk_file_are_numbers_of_groups(tmp_path):
    """Gmsh writes its groups as one column of whole numbers."""
    (tmp_path / "a.vtk").write_text(
        "# vtk DataFile Version 2.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n"
        "0 0 0\n1 0 0\n1 1 0\n0 1 0\nCELLS 3 11\n2 0 1\n3 0 1 2\n3 0 2 3\n"
        "CELL_TYPES 3\n3\n5\n5\nCELL_DATA 3\nSCALARS Part int 1\nLOOKUP_TABLE default\n11\n7\n8\n"
    )
    found = read_content_of_mesh_file(tmp_path / "a.vtk", "mesh").cell_groups
    assert found["11"]["line"].tolist() == found["7"]["triangle"].tolist() == [0]
    assert found["part=8"]["triangle"].tolist() == [1]


def test_without_h5py_a_med_file_names_the_extra(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "h5py", None)
    path = tmp_path / "a.med"
    path.write_bytes(b"\x89HDF")
    line = "mesh: needs h5py to be read: pip install 'drumlin[med]'"
    with pytest.raises(BadInput, match=re.escape(line) + "$"):
        read_content_of_mesh_file(path, "mesh")


def spoiled_med(alone, folder, change):
    """The content of a .med file after a change of its HDF5 file."""
    h5py = pytest.importorskip("h5py")
    written(alone, folder, "a.med", "tri1")
    with h5py.File(folder / "a.med", "r+") as file:
        (step,) = file["ENS_MAA/shoe"].values()
        change(file, step)
    return read_content_of_mesh_file(folder / "a.med", "mesh")


def test_families_of_a_med_file_may_have_no_group_and_any_letters(tmp_path, alone):
    def change(file, step):
        nodes = file.create_group("FAS/shoe/NOEUD/FAM_1")
        nodes.attrs["NUM"] = 1
        names = [name.ljust(80, b"\0") for name in ("Beläge".encode(), "Beläge2".encode("latin-1"))]
        nodes["GRO/NOM"] = np.frombuffer(b"".join(names), dtype=np.int8).reshape(2, 80)
        file.create_group("FAS/shoe/NOEUD/FAM_2").attrs["NUM"] = 2
        step["NOE/FAM"][:3] = [1, 2, 1]

    found = spoiled_med(alone, tmp_path, change)
    assert found.node_groups["beläge"].tolist() == found.node_groups["beläge2"].tolist() == [0, 2]
    assert set(found.cell_groups) == {"lining", "shoe", *GROUPS_IN_NASTRAN_FILE}


def replaced(name, value):
    """A change of a .med file that replaces an array of its step."""

    def change(file, step):
        del step[name]
        step[name] = value

    return change


SPOILED = {
    "has cylindrical or spherical": lambda file, step: file["ENS_MAA/shoe"].attrs.modify("REP", 1),
    "has 2 meshes": lambda file, step: file.create_group("ENS_MAA/other"),
    "has 2 steps": lambda file, step: file.create_group("ENS_MAA/shoe/later"),
    "elements of type TE4": lambda file, step: step.create_group("MAI/TE4"),
    "array of 5 numbers for 2 columns": replaced("NOE/COO", np.zeros(5)),
    "gives 5 families to": replaced("MAI/TR3/FAM", np.zeros(5, dtype=int)),
}


@pytest.mark.parametrize("line", SPOILED)
def test_what_a_med_file_has_and_is_not_read_is_refused(tmp_path, alone, line):
    with pytest.raises(BadInput, match=line):
        spoiled_med(alone, tmp_path, SPOILED[line])


@pytest.mark.parametrize("name", FILES)
def test_damaged_files_give_one_line(tmp_path, alone, name):
    """Cut off, with other numbers or other bytes: a mesh that passes all checks, or a line."""
    brake, _ = written(alone, tmp_path, name, "tri1")
    path, rng = tmp_path / name, random.Random(41)
    data, refused = path.read_bytes(), 0
    numbers = list(re.finditer(rb"(?<=[\s,])[-+]?\d[\d.]*", data))
    for _ in range(12):
        at = rng.choice(numbers)
        for spoiled in (
            data[: rng.randrange(3 * len(data) // 4)],
            data[: at.start()] + rng.choice([b"-1", b"1e9", b"nan", b"x"]) + data[at.end() :],
            bytes_with_random_noise(rng, data, ["99999999999"]),
        ):
            path.write_bytes(spoiled)
            try:
                read_shoe_mesh_with_notes(path, brake.shoes[0], alone.drum.radius)
            except BadInput as error:
                refused += 1
                assert "\n" not in str(error) and "Traceback" not in str(error)
    assert refused >= 12
