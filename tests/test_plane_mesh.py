"""Pads with a mesh of the user's own: parametric answers, mirror images, faults in one line."""

import random
from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

import command_line
import drumlin
from conftest import partly
from drumlin.base.errors import BadInput, DrumlinError
from drumlin.brake.file import vary
from drumlin.brake.plane_brake import FlatBrake, read_drum_or_plane_brake
from drumlin.brake.writing import brake_file_text
from drumlin.comparison import compare
from drumlin.fem.mesh.arc import parametric_mesh_of_shoe
from drumlin.fem.mesh.file import read_shoe_mesh_from_file, write_shoe_mesh_to_file
from drumlin.fem.mesh.grading import divide_lining_into_elements
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin_studies.random_kinds import mirror_turn_and_shift_brake
from flat_pads import BODY, KINDS, pad
from shared_parts import solve_on_elements_of_files

ELEMENTS = 16
QUICK = {("abutment", False), ("guide", False)}


def filed(
    brake: FlatBrake, path: Path, kind: str = "quad2", elements: int = ELEMENTS, **more: Any
) -> FlatBrake:
    """The pad with its parametric mesh as a file."""
    division = divide_lining_into_elements(brake.shoes[0], brake.size, elements)
    write_shoe_mesh_to_file(
        path, parametric_mesh_of_shoe(brake.shoes[0], brake.size, division, kind), brake.shoes[0]
    )
    return vary(
        brake, {"shoe.mesh": str(path)} | {f"shoe.{key}": value for key, value in more.items()}
    )


def test_every_format_gives_the_answer_of_the_mesh_that_was_written(tmp_path: Path) -> None:
    brake = pad("hinge", body=BODY)
    for kind in ("quad2", "tri1"):
        a = drumlin.solve(brake, elements=ELEMENTS, kind=kind).shoes[0]
        for suffix in ("msh", "inp", "vtu"):
            own = filed(brake, tmp_path / f"pad.{suffix}", kind)
            b = solve_on_elements_of_files(own).shoes[0]
            assert b.normal_force == pytest.approx(a.normal_force, rel=1e-9)
            np.testing.assert_allclose(b.pressure, a.pressure, atol=1e-7 * a.peak_pressure)


@pytest.mark.parametrize(("kind", "elastic"), partly(product(KINDS, [True, False]), QUICK))
def test_a_pad_of_every_holding_answers_as_the_parametric_one(
    kind: str, elastic: bool, tmp_path: Path
) -> None:
    """A meshed pad on every support answers as the parametric one.

    Each support holds the group hinge; triangles agree within the discretisation.
    """
    brake = pad(kind, "-x", **({"body": BODY} if elastic else {}))
    a, own = drumlin.solve(brake).shoes[0], filed(brake, tmp_path / "pad.msh", "tri2", 60)
    found = drumlin.solve(own)
    (b,) = found.shoes
    assert max(found.balance.force, found.balance.moment) < 1e-9
    assert b.normal_force == pytest.approx(a.normal_force, rel=2e-3)
    x = np.linspace(0.07, 0.17, 21)
    p, q = b.pressure_at(x), a.pressure_at(x)
    assert np.linalg.norm(p - q) < 2e-2 * np.linalg.norm(q)


@pytest.mark.slow
def test_units_frames_and_mirror_images_change_nothing(tmp_path: Path) -> None:
    """One file in the shoe's frame serves both hands, which share one body."""
    brake = pad("pivot", "-x", body=BODY)
    path, small = tmp_path / "pad.vtu", tmp_path / "mm.vtu"
    own = filed(brake, path)
    a = drumlin.solve(own).shoes[0]
    mesh = meshio.read(path)
    mesh.points *= 1e3
    mesh.write(small)
    (b,) = drumlin.solve(vary(own, {"shoe.mesh": str(small), "shoe.mesh_unit": "mm"})).shoes
    np.testing.assert_allclose(b.pressure, a.pressure, atol=1e-7 * a.peak_pressure)
    mesh.points *= 1e-3
    mesh.points[:, 0] -= brake.shoes[0].pin.x
    mesh.write(small)
    shared = vary(own, {"shoe.mesh": str(small), "shoe.mesh_frame": "shoe"})
    image = mirror_turn_and_shift_brake(shared, mirrored=True, shift=0.4)
    (c,), (d,) = drumlin.solve(shared).shoes, drumlin.solve(image).shoes
    np.testing.assert_allclose(c.pressure, a.pressure, atol=1e-7 * a.peak_pressure)
    np.testing.assert_allclose(
        d.pressure_at(0.4 - a.theta), a.pressure, atol=1e-7 * a.peak_pressure
    )
    second = image.shoes[0].model_copy(update={"name": "second"})
    both = shared.model_copy(update={"shoes": (shared.shoes[0], second)})
    bodies = make_prepared_model(both).bodies
    assert bodies[0] is bodies[1]


def test_a_crowned_mesh_is_a_crowned_pad(tmp_path: Path) -> None:
    """What its contact line is off the plane is gap, as a misfit is."""
    brake, path = pad("guide"), tmp_path / "pad.vtu"
    own = filed(brake, path, elements=60)
    mesh = meshio.read(path)
    x, y = mesh.points[:, 0] - 0.12, mesh.points[:, 1]
    mesh.points[:, 1] = np.where(y == 0, x**2 / (2 * 300.0), y)
    mesh.write(path)
    (a,) = drumlin.solve(vary(brake, {"shoe.lining.misfit.radius": 300.0}), elements=60).shoes
    (b,) = solve_on_elements_of_files(own).shoes
    assert a.contact_arcs[0][0] > 0.061
    np.testing.assert_allclose(b.pressure, a.pressure, atol=2e-2 * a.peak_pressure)


@pytest.mark.slow
def test_a_brake_file_names_its_mesh_from_its_folder(tmp_path: Path) -> None:
    own = vary(filed(pad("hinge", body=BODY), tmp_path / "pad.msh"), {"shoe.mesh": "pad.msh"})
    path = tmp_path / "pad.toml"
    path.write_text(brake_file_text(own))
    assert read_drum_or_plane_brake(path).shoes[0].mesh == tmp_path / "pad.msh"
    assert command_line.drumlin("view", path, "--output", tmp_path / "view.svg").returncode == 0
    done = command_line.drumlin("solve", path)
    assert done.returncode == 0
    assert (
        f"{drumlin.solve(read_drum_or_plane_brake(path)).merits[0].braking_force:.6g} N"
        in done.stdout
    )
    (tmp_path / "pad.msh").write_text("no mesh")
    with pytest.raises(BadInput, match=r"pad\.msh"):
        drumlin.solve(read_drum_or_plane_brake(path))


def raised(mesh: meshio.Mesh) -> None:
    mesh.points[:, 1] += 2e-3


def below(mesh: meshio.Mesh) -> None:
    mesh.points[:, 1] *= -1


def sunk(mesh: meshio.Mesh) -> None:
    mesh.points[:, 1] -= 2e-4


def shifted(mesh: meshio.Mesh) -> None:
    mesh.points[:, 0] += 0.01


def ramped(mesh: meshio.Mesh) -> None:
    mesh.points[:, 1] += 0.11 * np.clip(mesh.points[:, 0] - 0.06, 0.0, 0.01)


def far(mesh: meshio.Mesh) -> None:
    mesh.points[0, 0] = 1e200


def without(name: str) -> Callable[[meshio.Mesh], None]:
    def change(mesh: meshio.Mesh) -> None:
        del mesh.point_data[name]

    return change


def swapped(mesh: meshio.Mesh) -> None:
    data = mesh.point_data
    data["hinge"], data["actuation"] = data["actuation"], data["hinge"]


FAULTS: dict[str, tuple[Callable[[meshio.Mesh], None], str]] = {
    "off the plane": (
        raised,
        "the group contact lies up to 2 mm off the plane; must be within 1.2 mm of it",
    ),
    "under the plane": (
        below,
        "the lining's elements lie in the plane; must lie behind the group contact",
    ),
    "in the plane": (
        sunk,
        "lies up to 0.2 mm in the plane, over 0.1 of the lining's thickness of 1 mm; say "
        "mesh_inter",
    ),
    "elsewhere": (
        shifted,
        "runs from 70 mm to 190 mm; must be the lining's length, 60 mm to 180 mm, within "
        "4.18879 mm",
    ),
    "steep": (ramped, "with an edge of the contact that is steeper than 0.1 against the plane"),
    "far": (far, r"reaches 1e\+200 m far; must be a shoe on a plane, its lining 120 mm long"),
    "no contact": (without("contact"), "named groups missing or empty: contact"),
    "no hinge": (without("hinge"), "named groups missing or empty: hinge"),
    "swapped": (swapped, "must be the nearer one"),
}


@pytest.mark.parametrize("case", FAULTS)
def test_a_mesh_that_is_not_on_the_plane_is_refused_in_one_line(case: str, tmp_path: Path) -> None:
    change, said = FAULTS[case]
    own = filed(pad("hinge", body=BODY), tmp_path / "pad.vtu", "tri1")
    mesh = meshio.read(tmp_path / "pad.vtu")
    change(mesh)
    mesh.write(tmp_path / "pad.vtu")
    with pytest.raises(BadInput, match=said) as refusal:
        drumlin.solve(own)
    assert "\n" not in str(refusal.value)
    assert "shoe 'pad': mesh = " in str(refusal.value)


def test_a_damaged_mesh_is_solved_or_refused_in_one_line(tmp_path: Path) -> None:
    path = tmp_path / "pad.msh"
    own, rng, endings = filed(pad("hinge", body=BODY), path, "tri2", 4), random.Random(3), [0, 0]
    whole = path.read_text().split("\n")
    shoe, unit = own.shoes[0], own.size
    for i in range(60):
        lines, at, other = list(whole), rng.randrange(len(whole)), rng.randrange(len(whole))
        words = lines[at].split(" ")
        words[rng.randrange(len(words))] = rng.choice(
            ["-1", "0", "1e300", "nan", "99999", "7", "x", "0.125"]
        )
        lines[at : at + 1] = ([], [lines[at], lines[other]], [lines[other]], [" ".join(words)])[
            i % 4
        ]
        path.write_text("\n".join(lines if i % 7 else lines[:at]))
        try:
            read_shoe_mesh_from_file(path, shoe, unit)
            endings[0] += 1
        except DrumlinError as refusal:
            assert "\n" not in str(refusal)
            endings[1] += 1
    assert min(endings) > 1


@pytest.mark.slow
def test_compare_takes_a_pad_with_misfit_and_a_mesh_of_its_own(tmp_path: Path) -> None:
    """`compare` takes a pad with misfit and a mesh of its own.

    The laws assume a fitting lining; their errors are those against the finite elements of the
    misfit.
    """
    own = vary(
        filed(pad("hinge", body=BODY), tmp_path / "pad.msh"), {"shoe.lining.misfit.taper": 2e-5}
    )
    found = compare(own)
    assert set(found.responses) == {"fem", "short", "linear"}
    errors = {row["model"]: row.get("torque_error") for row in found.rows if row["shoe"] == "all"}
    fem, law = found.responses["fem"].merits[0], found.responses["linear"].merits[0]
    assert errors["linear"] == pytest.approx(law.braking_force / fem.braking_force - 1, rel=1e-9)
    assert errors["fem"] is None
