"""Mesh files: every format and kind gives the written mesh's answer, every fault one line."""

import math
import random
import subprocess
import sys
import warnings

import meshio
import numpy as np
import pytest

from conftest import ROOT, partly
from drumlin.base.errors import BadInput, DrumlinError
from drumlin.brake.file import read_brake, vary
from drumlin.fem.mesh.arc import MESH_KINDS, parametric_mesh_of_shoe
from drumlin.fem.mesh.file import read_shoe_mesh_from_file, write_shoe_mesh_to_file
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import require_element_options_have_effect, solve
from drumlin.mesh_files.inp import read_mesh_from_inp_text
from drumlin.models import model_with_name_that_applies_to_brake
from drumlin.response.norms import relative_distance_of_pressures
from shared_parts import solve_on_elements_of_files

ELEMENTS = 16
WEB = ROOT / "meshes" / "web_shoe.toml"


def filed(brake, folder, kind, suffix):
    """The brake with its parametric meshes as files."""
    changes = {}
    for i, shoe in enumerate(brake.shoes):
        path = folder / f"{shoe.name}.{suffix}"
        write_shoe_mesh_to_file(
            path, parametric_mesh_of_shoe(shoe, brake.drum.radius, ELEMENTS, kind), shoe
        )
        changes[f"shoe[{i}].mesh"] = str(path)
    return vary(brake, changes)


@pytest.mark.parametrize("suffix", ["msh", "inp", "vtu"])
@pytest.mark.parametrize("kind", MESH_KINDS)
def test_every_format_gives_the_answer_of_the_mesh_that_was_written(tmp_path, brake, kind, suffix):
    written = filed(brake, tmp_path, kind, suffix)
    a, b = solve(brake, elements=ELEMENTS, kind=kind), solve_on_elements_of_files(written)
    # an .inp file lacks the centre nodes of quad2: they return a little off the arc between the
    # layers
    rel = 1e-6 if (kind, suffix) == ("quad2", "inp") else 1e-9
    assert b.torque == pytest.approx(a.torque, rel=rel)
    for x, y in zip(a.shoes, b.shoes, strict=True):
        assert y.order == x.order == int(kind[-1])
        assert y.pressure == pytest.approx(x.pressure, rel=1e-5, abs=10 * rel * x.pressure.max())


def test_what_no_part_is_divided_by_is_refused(tmp_path, brake):
    """Of shoes with mesh files a ring alone is divided, and has elements of one kind."""
    written = filed(brake, tmp_path, "quad2", "msh")
    ringed = vary(
        written,
        {"drum.ring": {"thickness": 0.01, "width": 0.04, "material": {"E": 1.2e11, "nu": 0.25}}},
    )
    partly = vary(brake, {"shoe[0].mesh": str(written.shoes[0].mesh)})
    for option in ({"elements": 8}, {"kind": "tri2"}):
        with pytest.raises(BadInput, match=r"--\w+ = \w+: all shoes have mesh files"):
            require_element_options_have_effect(written, **option)
        require_element_options_have_effect(partly, **option)
    require_element_options_have_effect(ringed, elements=8)
    coarse, fine = (make_prepared_model(ringed, elements=n).ring.mesh.nelements for n in (8, 16))
    assert coarse < fine
    with pytest.raises(BadInput, match="--kind = tri2"):
        require_element_options_have_effect(ringed, elements=8, kind="tri2")


@pytest.mark.parametrize("options", [("gmsh22", False), ("gmsh22", True)])
def test_gmsh_2_2_text_and_binary(tmp_path, brake, options):
    written = filed(brake, tmp_path, "tri2", "msh")
    for shoe in written.shoes:
        meshio.read(shoe.mesh).write(shoe.mesh, file_format=options[0], binary=options[1])
    assert solve_on_elements_of_files(written).torque == pytest.approx(
        solve(brake, elements=ELEMENTS, kind="tri2").torque, rel=1e-9
    )


@pytest.mark.parametrize("binary", [0, 1])
@pytest.mark.parametrize("version", [2.2, 4.1])
@pytest.mark.parametrize("kind", MESH_KINDS)
def test_files_that_gmsh_itself_writes(tmp_path, brake, kind, version, binary):
    gmsh = pytest.importorskip("gmsh")
    written = filed(brake, tmp_path, kind, "msh")
    gmsh.initialize(readConfigFiles=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.option.setNumber("Mesh.Binary", binary)
        for shoe in written.shoes:
            gmsh.open(str(shoe.mesh))
            gmsh.write(str(shoe.mesh))
    finally:
        gmsh.finalize()
    assert b"%g %d 8" % (version, binary) in written.shoes[0].mesh.read_bytes()[:40]
    assert solve_on_elements_of_files(written).torque == pytest.approx(
        solve(brake, elements=ELEMENTS, kind=kind).torque, rel=1e-9
    )


@pytest.mark.slow
def test_an_input_file_that_gmsh_writes_has_edges_as_elements(tmp_path):
    gmsh = pytest.importorskip("gmsh")
    web = read_brake(WEB)
    gmsh.initialize(readConfigFiles=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(WEB.with_suffix(".msh")))
        gmsh.write(str(tmp_path / "web.inp"))
    finally:
        gmsh.finalize()
    assert "T3D3" in (tmp_path / "web.inp").read_text()
    again = vary(web, {"shoe.mesh": str(tmp_path / "web.inp")})
    assert solve(again).torque == pytest.approx(solve(web).torque, rel=1e-9)


def test_an_input_file_as_people_write_it(tmp_path, brake):
    """An input file as people write it is read.

    Two element sections with their sets, sets of sets, ranges, long lines, small letters, foreign
    keywords.
    """
    (tmp_path / "m.inp").write_text(
        """*Heading
 a plate, and *not a keyword
** a comment
*Node, nset=all
 1, 0., 0.
 2, 1., 0., 0.
 3, 2., 0.
 11, 0., 1.
 12, 1., 1.
 13, 2., 1.
 99, 7., 7.
*Element, type=cps4r, elset=left
 7, 1, 2,
    12, 11
*ELEMENT, TYPE=CPS4, ELSET=Right
 8, 2, 3, 13, 12
*ELEMENT, TYPE=T2D2, ELSET=Edge
 20, 1, 2
*ELEMENT, TYPE=B32, ELSET=Curve
 21, 1, 2, 3
*Elset, elset=both
 left, right
*NSET, NSET=Bottom, GENERATE
 1, 3, 1
*Solid section, elset=both, material=steel
 1.
"""
    )
    mesh = read_mesh_from_inp_text((tmp_path / "m.inp").read_text())
    assert mesh.cells["quad"].tolist() == [[0, 1, 4, 3], [1, 2, 5, 4]]
    assert mesh.cell_groups["left"]["quad"].tolist() == [0]
    assert mesh.cell_groups["right"]["quad"].tolist() == [1]
    assert mesh.cell_groups["both"]["quad"].tolist() == [0, 1]
    assert mesh.cell_groups["edge"]["line"].tolist() == [0]
    # The file has end, middle, end; here the middle node is last.
    assert mesh.cells["line3"].tolist() == [[0, 2, 1]]
    assert mesh.node_groups["bottom"].tolist() == [0, 1, 2]
    assert len(mesh.node_groups["all"]) == 7


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("*NODE\n1, 0., 0.\n1, 1., 0.\n", "node 1 is defined twice"),
        (
            "*NODE\n1, 0., 0.\n*ELEMENT, TYPE=C3D8\n1, 1\n",
            "TYPE=C3D8 is not an element of a plane mesh",
        ),
        ("*NODE\n1, 0., 0.\n*ELEMENT, TYPE=CPS4\n1, 1, 1\n", "needs a label and 4 nodes"),
        ("*INCLUDE, INPUT=more.inp\n", "more.inp: there is no such file"),
        (
            "*NODE\n1, 0., 0.\n*ELEMENT, TYPE=CPS3\n1, 1, 2, 3\n",
            "element 1 has the node 2, which the file does not define",
        ),
        ("*NODE\n1, 0., zero\n", "node 1: 'zero' is not a number"),
        ("\n", "has no nodes"),
        ("", "is empty"),
    ],
)
def test_an_input_file_that_cannot_be_read_is_refused_in_one_line(tmp_path, brake, text, words):
    (tmp_path / "m.inp").write_text(text)
    with pytest.raises(BadInput) as refusal:
        read_shoe_mesh_from_file(tmp_path / "m.inp", brake.shoes[0], brake.drum.radius)
    assert words in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_counts_that_numpy_only_warns_of_are_refused(tmp_path, brake, monkeypatch):
    """numpy before 2.3 warns where newer ones raise; the numbers read so far would be taken."""
    written = filed(brake, tmp_path, "tri1", "msh")
    read = meshio.read

    def warned(*arguments):
        warnings.warn(
            "string or file could not be read to its end due to ...",
            DeprecationWarning,
            stacklevel=1,
        )
        return read(*arguments)

    monkeypatch.setattr(meshio, "read", warned)
    with pytest.raises(BadInput, match="is not a mesh that can be read"):
        read_shoe_mesh_from_file(written.shoes[0].mesh, written.shoes[0], brake.drum.radius)


def test_one_number_for_a_line_and_a_surface_is_no_confusion(tmp_path, brake):
    """Gmsh numbers physical lines and physical surfaces apart: both begin with 1."""
    written = filed(brake, tmp_path, "quad2", "msh")
    for shoe in written.shoes:
        mesh = meshio.read(shoe.mesh)
        first_line = min(tag for tag, dim in mesh.field_data.values() if dim == 1)
        for name, (tag, dim) in list(mesh.field_data.items()):
            mesh.field_data[name] = np.array([tag if dim == 2 else tag - first_line + 1, dim])
        for block, tags in zip(mesh.cells, mesh.cell_data["gmsh:physical"], strict=True):
            np.subtract(tags, first_line - 1 if block.dim == 1 else 0, out=tags)
        mesh.write(shoe.mesh, file_format="gmsh22", binary=False)
    assert solve_on_elements_of_files(written).torque == pytest.approx(
        solve(brake, elements=ELEMENTS).torque, rel=1e-9
    )


def rewrite(path, change):
    """Change a .vtu mesh as arrays: points, cells and 0/1 groups."""
    mesh = meshio.read(path)
    result = change(mesh)
    (mesh if result is None else result).write(path)


def cells_of(mesh):
    return mesh.cells[0].data


def unbonded(mesh):
    """The lining on nodes of its own: every node of its back stands twice."""
    inside = mesh.cell_data["lining"][0] > 0
    cells = cells_of(mesh).copy()
    mine = np.unique(cells[inside])
    twin = np.zeros(len(mesh.points), dtype=int)
    twin[mine] = len(mesh.points) + np.arange(len(mine))
    cells[inside] = twin[cells[inside]]
    return meshio.Mesh(
        np.vstack([mesh.points, mesh.points[mine]]),
        [(mesh.cells[0].type, cells)],
        cell_data=mesh.cell_data,
        point_data={
            name: np.concatenate([values, values[mine]]) for name, values in mesh.point_data.items()
        },
    )


def moved_apart(mesh):
    """The unbonded lining, and a shoe that stands 0.1 mm further in."""
    mesh = unbonded(mesh)
    shoe = np.unique(cells_of(mesh)[mesh.cell_data["shoe"][0] > 0])
    mesh.points[shoe] *= 0.999
    return mesh


def inverted(mesh):
    """Two corners of an inner element change places."""
    cell = cells_of(mesh)[40]
    mesh.points[cell[[0, 1]]] = mesh.points[cell[[1, 0]]]


def folded(mesh):
    """A node pulled over to the other side of its neighbours."""
    node = cells_of(mesh)[60][0]
    mesh.points[node] *= 1.0 - 0.012
    turn = 0.2
    mesh.points[node, :2] = mesh.points[node, :2] @ [
        [math.cos(turn), math.sin(turn)],
        [-math.sin(turn), math.cos(turn)],
    ]


def twice(mesh):
    """Elements away from all named nodes, and once more."""
    named = np.any([values > 0 for values in mesh.point_data.values()], axis=0)
    again = np.flatnonzero(~named[cells_of(mesh)].any(axis=1))[:4]
    return meshio.Mesh(
        mesh.points,
        [(mesh.cells[0].type, np.vstack([cells_of(mesh), cells_of(mesh)[again]]))],
        cell_data={
            name: [np.append(values[0], values[0][again])]
            for name, values in mesh.cell_data.items()
        },
        point_data=mesh.point_data,
    )


def tilted(mesh):
    mesh.points[:, 2] = 0.1 * mesh.points[:, 0]


def regrouped(name, rule):
    def change(mesh):
        mesh.point_data[name] = rule(mesh).astype(np.int32)

    return change


def cell_edges(mesh):
    """A Gmsh-like file whose contact runs along inner edges."""
    cells = cells_of(mesh)
    inside = mesh.cell_data["lining"][0] > 0
    groups = {
        name: [mesh.cell_data[name][0], np.zeros(5, dtype=np.int32)] for name in ("lining", "shoe")
    }
    groups["contact"] = [np.zeros(len(cells), dtype=np.int32), np.ones(5, dtype=np.int32)]
    edges = np.vstack([np.roll(cells[inside][:5, :3], k, axis=1)[:, :2] for k in range(3)])
    radius = np.hypot(*mesh.points[edges, :2].mean(axis=1).T)
    edges = edges[np.argsort(radius)][:5]
    del mesh.point_data["contact"]
    return meshio.Mesh(
        mesh.points, [*mesh.cells, ("line", edges)], cell_data=groups, point_data=mesh.point_data
    )


def strange_edges(mesh):
    result = cell_edges(mesh)
    result.cells[1].data[0] = [0, len(mesh.points) - 1]
    return result


FAULTS = {
    "doubled nodes": ("quad2", unbonded, "pairs of nodes stand in one place (the first at x = "),
    "parts apart": ("quad1", moved_apart, "consists of 2 parts that share no edge"),
    "inverted quadrilateral": ("quad1", inverted, "inverted or without area in a corner"),
    "inverted curved quadrilateral": ("quad2", inverted, "inverted or without area in a corner"),
    "folded triangles": ("tri1", folded, "folded over a neighbour"),
    "twice the same elements": ("tri1", twice, "more than two elements meet in an edge"),
    "one node twice": (
        "quad1",
        lambda m: cells_of(m).__setitem__((3, 0), cells_of(m)[3, 2]),
        "that a cell has twice",
    ),
    "middle not shared": (
        "tri2",
        lambda m: cells_of(m).__setitem__((3, 4), cells_of(m)[9, 4]),
        "not its middle node",
    ),
    "not plane": ("tri1", tilted, "is not plane"),
    "far away": ("tri1", lambda m: m.points.__setitem__((0, 0), 1e300), "e+299 m far"),
    "inner contact": ("tri1", cell_edges, "edges of the group contact are not on the boundary"),
    "strange contact": (
        "tri1",
        strange_edges,
        "group contact: 1 of its 5 edges are not edges of the cells",
    ),
    "no hinge": (
        "tri2",
        regrouped("hinge", lambda m: np.zeros(len(m.points))),
        "missing or empty: hinge",
    ),
    "one node as hinge": (
        "tri2",
        regrouped("hinge", lambda m: np.arange(len(m.points)) == 0),
        "or empty: hinge",
    ),
    "hinge on the lining": (
        "tri2",
        regrouped("hinge", lambda m: (m.point_data["hinge"] > 0) | (m.point_data["contact"] > 0)),
        "contact and hinge share a node",
    ),
    "contact in two pieces": (
        "quad2",
        regrouped(
            "contact", lambda m: (m.point_data["contact"] > 0) & (np.abs(m.points[:, 1]) > 0.015)
        ),
        "one line without gaps",
    ),
    "cells of no group": (
        "quad2",
        lambda m: m.cell_data["shoe"][0].__setitem__(-1, 0),
        "exactly one of the groups",
    ),
    "wrong frame": (
        "tri1",
        lambda m: m.points.__setitem__((..., 0), -m.points[:, 0]),
        "read in the brake's frame",
    ),
    "solid cells": (
        "tri1",
        lambda m: meshio.Mesh(
            m.points, [*m.cells, ("tetra", np.array([[0, 1, 2, 3]]))], point_data=m.point_data
        ),
        "has cells ['tetra']; allowed are triangles and quadrilaterals",
    ),
}


@pytest.mark.parametrize("case", FAULTS)
def test_a_fault_in_a_mesh_is_one_line_that_names_it(tmp_path, brake, case):
    kind, change, words = FAULTS[case]
    shoe = brake.shoes[0]
    path = tmp_path / "m.vtu"
    write_shoe_mesh_to_file(
        path, parametric_mesh_of_shoe(shoe, brake.drum.radius, ELEMENTS, kind), shoe
    )
    read_shoe_mesh_from_file(path, shoe, brake.drum.radius)
    rewrite(path, change)
    with pytest.raises(BadInput) as refusal:
        read_shoe_mesh_from_file(path, shoe, brake.drum.radius, "shoe 'right': mesh")
    assert words in str(refusal.value)
    assert str(path) in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("count", [15, pytest.param(60, marks=pytest.mark.slow)])
@pytest.mark.parametrize("suffix", partly(["msh", "inp", "vtu"], {"msh", "inp"}))
def test_a_damaged_file_is_solved_or_refused_in_one_line(tmp_path, brake, suffix, count):
    """Lines lost, doubled, exchanged, cut off, numbers overwritten: nothing else may come of it."""
    alone = vary(brake, {"shoe": [brake.shoes[0].model_dump()]})
    path = tmp_path / f"m.{suffix}"
    write_shoe_mesh_to_file(
        path, parametric_mesh_of_shoe(brake.shoes[0], brake.drum.radius, 6, "tri2"), brake.shoes[0]
    )
    whole = path.read_text().split("\n")
    rng = random.Random(7)
    solved = refused = 0
    for i in range(count):
        lines, at, other = list(whole), rng.randrange(len(whole)), rng.randrange(len(whole))
        words = lines[at].replace(",", " , ").split(" ")
        words[rng.randrange(len(words))] = rng.choice(
            ["-1", "0", "1e300", "nan", "99999", "7", "x", "12.5"]
        )
        overwritten = " ".join(words)
        damages = ([], [lines[at], lines[other]], [lines[other]], [overwritten], [overwritten])
        lines[at : at + 1] = damages[i % 5]
        path.write_text("\n".join(lines if i % 7 else lines[:at]))
        try:
            response = solve(vary(alone, {"shoe.mesh": str(path)}))
            assert max(response.balance.force, response.balance.moment) < 1e-8
            solved += 1
        except DrumlinError as refusal:
            assert "\n" not in str(refusal) and "SystemExit" not in str(refusal)
            refused += 1
    assert solved + refused == count
    assert refused > count / 6


def test_nodes_of_no_element_either_orientation_and_other_groups_do_not_matter(tmp_path, brake):
    written = filed(brake, tmp_path, "quad2", "vtu")

    def change(mesh):
        cells = cells_of(mesh).copy()
        # These cells are given clockwise.
        cells[::3] = cells[::3][:, [1, 0, 3, 2, 4, 7, 6, 5, 8]]
        order = np.random.default_rng(0).permutation(len(mesh.points))
        back = np.argsort(order)
        return meshio.Mesh(
            np.vstack([mesh.points[order], [[9.0, 9.0, 0.0]]]),
            [("quad9", back[cells])],
            cell_data={**mesh.cell_data, "spare": [np.ones(len(cells), dtype=np.int32)]},
            point_data={
                name: np.append(values[order], 0) for name, values in mesh.point_data.items()
            },
        )

    for shoe in written.shoes:
        rewrite(shoe.mesh, change)
    assert solve_on_elements_of_files(written).torque == pytest.approx(
        solve(brake, elements=ELEMENTS).torque, rel=1e-9
    )


def test_a_file_in_the_shoes_frame_serves_both_hands(tmp_path, brake):
    shoe = brake.shoes[0]
    path = tmp_path / "one.msh"
    write_shoe_mesh_to_file(path, parametric_mesh_of_shoe(shoe, brake.drum.radius, ELEMENTS), shoe)
    mesh = meshio.read(path)
    mesh.points[:, :2] = shoe.frame.convert_vectors_to_shoe_frame(mesh.points[:, :2]) * 1e3
    mesh.write(path, file_format="gmsh22", binary=False)
    one = vary(brake, {"shoe.mesh": str(path), "shoe.mesh_frame": "shoe", "shoe.mesh_unit": "mm"})
    assert solve_on_elements_of_files(one).torque == pytest.approx(
        solve(brake, elements=ELEMENTS).torque, rel=1e-9
    )
    scene = make_prepared_model(one)
    assert scene.bodies[0] is scene.bodies[1]


def test_kinds_and_formats_that_do_not_exist_are_refused_with_those_that_do(tmp_path, brake):
    with pytest.raises(BadInput, match=r"--kind = 'hex': .* quad2, quad1, tri2, tri1"):
        make_prepared_model(brake, kind="hex")
    shoe = brake.shoes[0]
    with pytest.raises(BadInput, match=r"--format = 'stl': .* msh, inp, vtu"):
        write_shoe_mesh_to_file(
            tmp_path / "m.stl", parametric_mesh_of_shoe(shoe, brake.drum.radius, 4), shoe
        )


def test_the_web_shoe_solves_balances_and_keeps_near_the_sine_law():
    web = read_brake(WEB)
    response = solve(web)
    assert max(response.balance.force, response.balance.moment) < 1e-9
    law = model_with_name_that_applies_to_brake("sine", web).solve(web)
    for a, b in zip(response.shoes, law.shoes, strict=True):
        assert a.torque == pytest.approx(b.torque, rel=0.15)
        assert a.self_energising == b.self_energising
    scene = make_prepared_model(web)
    assert scene.bodies[0] is scene.bodies[1]
    mesh = scene.bodies[0].mesh
    assert set(mesh.subdomains) == {"lining", "backing", "shoe"}
    euler = mesh.nvertices - mesh.nfacets + mesh.nelements
    # The web has five holes: one for the pin, three to save weight, one for a spring.
    assert 1 - euler == 5
    assert WEB.with_suffix(".msh").stat().st_size < 300_000


@pytest.mark.slow
def test_the_web_shoe_agrees_with_a_mesh_twice_as_fine(tmp_path):
    """meshes/web_shoe.py makes it; the committed mesh is half as fine."""
    pytest.importorskip("gmsh")
    fine = tmp_path / "fine.msh"
    script = [sys.executable, ROOT / "meshes" / "web_shoe.py"]
    subprocess.run([*script, "--refine", "2", "--output", fine], check=True, cwd=tmp_path)
    web = read_brake(WEB)
    a, b = (
        solve(web, penalty=math.inf),
        solve(vary(web, {"shoe.mesh": str(fine)}), penalty=math.inf),
    )
    assert a.torque == pytest.approx(b.torque, rel=1e-4)
    for x, y in zip(a.shoes, b.shoes, strict=True):
        assert relative_distance_of_pressures(x, y) < 0.02
