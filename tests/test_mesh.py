"""Meshes: groups and layers of the parametric one, files written and read back, files refused."""

import meshio
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from conftest import ROOT, STUDY
from drumlin.base.errors import BadInput
from drumlin.brake.file import read_brake, vary
from drumlin.fem.mesh.arc import parametric_mesh_of_shoe
from drumlin.fem.mesh.file import read_shoe_mesh_from_file, write_shoe_mesh_to_file
from drumlin.fem.mesh.grading import points_graded_to_both_ends
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin_studies.stated_true import true_errors_of_response
from shared_parts import of_shoes, solve_on_elements_of_files


@given(st.integers(1, 300), st.floats(1e-3, 2), st.floats(1e-3, 1))
def test_graded_points_grow_from_both_ends_to_the_middle(count, zone, smallest):
    x = points_graded_to_both_ends(1.0, 3.0, count, zone, smallest)
    assert len(x) == count + 1
    assert (x[0], x[-1]) == (1.0, 3.0)
    steps = np.diff(x)
    assert (steps > 0).all()
    assert steps == pytest.approx(steps[::-1], rel=1e-6)
    assert (np.diff(steps[: (count + 1) // 2]) > -1e-9).all()


def test_groups_cover_the_mesh_and_its_ends(brake):
    backed = vary(brake, {"shoe.backing": {"thickness": 0.004, "material": {"E": 1e10, "nu": 0.3}}})
    for spec in (brake, backed):
        shoe = spec.shoes[0]
        mesh = parametric_mesh_of_shoe(shoe, spec.drum.radius, 20)
        members = np.concatenate(list(mesh.subdomains.values()))
        assert np.array_equal(np.sort(members), np.arange(mesh.nelements))
        assert set(mesh.subdomains) == {"lining", "shoe"} | ({"backing"} if shoe.backing else set())
        assert len(mesh.boundaries["contact"]) == 20
        radius = np.hypot(*mesh.p[:, np.unique(mesh.facets[:, mesh.boundaries["contact"]])])
        assert radius == pytest.approx(spec.drum.radius, rel=1e-13)
        hinge = mesh.p[:, np.unique(mesh.facets[:, mesh.boundaries["hinge"]])]
        # The axis of the mesh is the pin's ray.
        assert np.arctan2(hinge[1], hinge[0]) == pytest.approx(0, abs=1e-12)
        assert len(mesh.boundaries["actuation"]) > 0


@pytest.mark.parametrize("name", ["brake", "flexible"])
def test_a_mesh_is_as_exact_as_is_said(name):
    """By default p is within 0.2 % (L2) of a far finer answer, the torque within 1e-5."""
    brake = read_brake(STUDY / f"{name}.toml")
    found, true = (
        solve_prepared_model(make_prepared_model(brake), brake),
        solve(brake, tolerance=1e-5),
    )
    off = true_errors_of_response(brake, found.shoes, true.shoes)
    assert off["pressure"] < 2e-3 and off["torque"] < 1e-5


@pytest.fixture
def written(tmp_path, brake):
    """The parametric meshes of both shoes as files, and a brake that uses them."""
    paths = []
    for shoe in brake.shoes:
        paths.append(tmp_path / f"{shoe.name}.msh")
        write_shoe_mesh_to_file(
            paths[-1], parametric_mesh_of_shoe(shoe, brake.drum.radius, 30), shoe
        )
    return vary(brake, of_shoes("mesh", paths))


def test_a_mesh_file_gives_the_answer_of_the_parametric_mesh_it_came_from(brake, written):
    a, b = solve(brake, elements=30), solve_on_elements_of_files(written)
    assert b.torque == pytest.approx(a.torque, rel=1e-9)
    for x, y in zip(a.shoes, b.shoes, strict=True):
        assert y.pressure == pytest.approx(x.pressure, rel=1e-6, abs=1e-8 * x.pressure.max())
        assert y.hinge_reaction == pytest.approx(x.hinge_reaction, rel=1e-8)


def test_a_mesh_file_in_millimetres(tmp_path, brake, written):
    for name in ("right", "left"):
        mesh = meshio.read(tmp_path / f"{name}.msh")
        mesh.points *= 1e3
        mesh.write(tmp_path / f"{name}.msh", file_format="gmsh22", binary=False)
    with pytest.raises(BadInput, match="coordinates are read in m"):
        solve(written)
    in_mm = vary(written, {"shoe.mesh_unit": "mm"})
    assert solve_on_elements_of_files(in_mm).torque == pytest.approx(
        solve(brake, elements=30).torque, rel=1e-9
    )


def test_named_groups_are_in_the_file(written):
    mesh = meshio.read(written.shoes[0].mesh)
    assert set(mesh.field_data) == {"lining", "shoe", "contact", "hinge", "actuation"}


def rewritten(path, change):
    mesh = meshio.read(path)
    change(mesh)
    mesh.write(path, file_format="gmsh22", binary=False)


def top(mesh):
    """A node inside the contact line."""
    return mesh.cells_dict["line3"][
        np.flatnonzero(
            mesh.cell_data_dict["gmsh:physical"]["line3"] == mesh.field_data["contact"][0]
        )[5],
        0,
    ]


REFUSED = {
    "missing group": (
        lambda m: m.field_data.pop("contact"),
        "named groups missing or empty: contact",
    ),
    "missing subdomain": (
        lambda m: m.field_data.pop("lining"),
        "named groups missing or empty: lining",
    ),
    "not finite": (lambda m: m.points.__setitem__((3, 0), np.nan), "not finite"),
    "wrong radius": (lambda m: m.points.__imul__(1.2), "off the drum's radius"),
    "bump": (
        lambda m: m.points.__setitem__(top(m), 0.995 * m.points[top(m)]),
        "steeper than 0.1 against the drum",
    ),
    "wrong place": (
        lambda m: m.points.__setitem__((slice(None), slice(0, 2)), m.points[:, 1::-1]),
        "lining's arc",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_mesh_that_does_not_fit_is_refused_in_one_line(written, brake, case):
    change, words = REFUSED[case]
    path = written.shoes[0].mesh
    rewritten(path, change)
    with pytest.raises(BadInput) as refusal:
        read_shoe_mesh_from_file(path, written.shoes[0], brake.drum.radius)
    assert words in str(refusal.value)
    assert path.name in str(refusal.value)
    assert "\n" not in str(refusal.value)


# The two files have the formats 2.2 and 4.1. Only the reader of the first makes an array as long as
# the largest number; the second file is refused because its elements have the former number.
@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("double_shoe_left.msh", "numbers a node 999999999999; must be up to 10000000"),
        ("web_shoe.msh", "has the node 1, which the file does not define"),
    ],
)
def test_a_node_number_that_would_fill_the_memory_is_refused(tmp_path, brake, name, reason):
    text = (ROOT / "meshes" / name).read_text()
    start = text.index("\n", text.index("$Nodes\n") + 7) + 1
    if name.startswith("web"):
        start = text.index("\n", start) + 1
    end = text.index(" " if name.startswith("double") else "\n", start)
    (tmp_path / name).write_text(f"{text[:start]}999999999999{text[end:]}")
    with pytest.raises(BadInput, match=reason):
        read_shoe_mesh_from_file(tmp_path / name, brake.shoes[0], brake.drum.radius)


def test_files_that_are_no_mesh_are_refused(tmp_path, brake):
    shoe = brake.shoes[0]
    for name, content in {
        "a.msh": "nonsense",
        "b.xyz": "nonsense",
        "c.msh": "",
        "d.vtu": "<VTKFile>",
    }.items():
        (tmp_path / name).write_text(content)
        with pytest.raises(BadInput, match="not a mesh") as refusal:
            read_shoe_mesh_from_file(tmp_path / name, shoe, brake.drum.radius)
        assert "(Error" not in str(refusal.value)
    with pytest.raises(BadInput, match="no such file"):
        read_shoe_mesh_from_file(tmp_path / "none.msh", shoe, brake.drum.radius)


def test_the_committed_meshes_solve_as_the_brake_they_were_made_from(brake):
    """The committed meshes solve as the parametric brake they were made from.

    meshes/double_shoe.toml: the study's shoes at 24 elements, through their files.
    """
    filed = read_brake(ROOT / "meshes" / "double_shoe.toml")
    assert solve_on_elements_of_files(filed).torque == pytest.approx(
        solve(brake, elements=24).torque, rel=1e-9
    )
