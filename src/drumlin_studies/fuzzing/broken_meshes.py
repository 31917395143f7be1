"""Mesh files that are broken on purpose: cut off, mislabelled, torn, folded or without groups."""

import math
import random
import tempfile
import tomllib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import meshio
import numpy as np

from drumlin.brake.file import brake_from
from drumlin.fem.mesh.file import FORMATS, write_mesh
from drumlin.fem.preparation.prepare import prepare
from drumlin_studies.fuzzing.inputs import SOUND_BRAKES, BrokenInput, brake_text, data_as_toml

MESH_SUFFIXES = (".msh", ".inp", ".vtu")


@cache
def sound_mesh_files() -> dict[str, bytes]:
    """Small sound meshes of a shoe, by suffix, and under "brake" the brake file of this shoe."""
    data = tomllib.loads(brake_text(SOUND_BRAKES[0]).decode())
    data["shoe"] = data["shoe"][:1]
    brake = brake_from(data, unit_required=True)
    mesh = prepare(brake, elements=6, kind="tri2").bodies[0].mesh
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder) / f"shoe{suffix}" for suffix in FORMATS]
        for path in paths:
            write_mesh(path, mesh, brake.shoes[0])
        return {path.suffix: path.read_bytes() for path in paths} | {"brake": data_as_toml(data)}


def brake_file_with_mesh(brake_file: bytes, name: str) -> bytes:
    """The brake file whose first shoe is meshed by the file `name`."""
    data = tomllib.loads(brake_file.decode())
    data["shoe"][0]["mesh"] = name
    return data_as_toml(data)


def solve_of_meshed_brake(
    kind: str, mesh: bytes, suffix: str, *, must_fail: bool = True
) -> BrokenInput:
    """A solve of the brake with a mesh.

    Parameters
    ----------
    kind : str
        What kind of input it is.
    mesh : bytes
        The mesh file.
    suffix : str
        Suffix of the mesh file.
    must_fail : bool
        Whether no model may answer the input.
    """
    name = f"m{suffix}"
    files = {"b.toml": brake_file_with_mesh(sound_mesh_files()["brake"], name), name: mesh}
    words = ["solve", "b.toml", "--json", "r.json"]
    return BrokenInput(kind, files, words, must_fail=must_fail)


def make_impossible_mesh(rng: random.Random) -> BrokenInput:
    """A solve with a mesh that is cut off, mislabelled, has wrong counts, or is no valid shoe."""
    (maker,) = rng.choices(
        [_cut_off_mesh, _mislabelled_mesh, _mesh_with_wrong_counts, _invalid_shoe_mesh],
        [3, 1, 1, 6],
    )
    return maker(rng)


def _cut_off_mesh(rng: random.Random) -> BrokenInput:
    """A mesh file of which less than three quarters are left."""
    suffix = rng.choice(MESH_SUFFIXES)
    text = sound_mesh_files()[suffix]
    left = text[: rng.randrange(3 * len(text) // 4)]
    return solve_of_meshed_brake(f"mesh {suffix}: cut off", left, suffix)


def _mislabelled_mesh(rng: random.Random) -> BrokenInput:
    """A mesh under the suffix of another format, or a file that is no mesh at all."""
    suffix, other = rng.sample(MESH_SUFFIXES, 2)
    noise = bytes(rng.randrange(256) for _ in range(99))
    text = rng.choice([sound_mesh_files()[other], brake_text(rng.choice(SOUND_BRAKES)), b"", noise])
    return solve_of_meshed_brake(f"mesh {suffix}: another format", text, suffix)


def _mesh_with_wrong_counts(rng: random.Random) -> BrokenInput:
    """A mesh file with wrong counts, up to more than any memory holds."""
    text = sound_mesh_files()[".msh"].decode()
    keyword = rng.choice(["$Nodes\n", "$Elements\n", "$PhysicalNames\n"])
    start = text.index(keyword) + len(keyword)
    count = rng.choice(["-1", "0", "1", "999999", "99999999999999", "1e9", "nan"])
    false = text[:start] + count + text[text.index("\n", start) :]
    return solve_of_meshed_brake("mesh .msh: false counts", false.encode(), ".msh")


def _invalid_shoe_mesh(rng: random.Random) -> BrokenInput:
    """A well-formed mesh file that is no valid shoe: torn, folded, doubled, or without groups."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "shoe.vtu"
        path.write_bytes(sound_mesh_files()[".vtu"])
        mesh = meshio.read(path)
        name, spoil = rng.choice(list(SPOILS.items()))
        points, cells = mesh.points.copy(), mesh.cells[0].data.copy()
        cell_data = {key: values[0].copy() for key, values in mesh.cell_data.items()}
        point_data = {key: values.copy() for key, values in mesh.point_data.items()}
        points, cells, cell_data, point_data = spoil(rng, points, cells, cell_data, point_data)
        meshio.Mesh(
            points,
            [(mesh.cells[0].type, cells)],
            cell_data={key: [values] for key, values in cell_data.items()},
            point_data=point_data,
        ).write(path, file_format="vtu")
        return solve_of_meshed_brake(f"mesh: {name}", path.read_bytes(), ".vtu")


Spoiled = tuple[Any, Any, dict[str, Any], dict[str, Any]]
"""Points, cells, data of cells and data of points of a mesh.

The functions below take the same four: `at` are the data of cells, `on` those of points.
"""


def _mesh_with_inverted_element(
    rng: random.Random, points: Any, cells: Any, at: Any, on: Any
) -> Spoiled:
    """A mesh with two corners of an element exchanged."""
    i = rng.randrange(len(cells))
    cells[i, [0, 1]] = cells[i, [1, 0]]
    return points, cells, at, on


def _mesh_torn_in_two(rng: random.Random, points: Any, cells: Any, at: Any, on: Any) -> Spoiled:
    """A mesh without a strip of its elements: two parts are left."""
    theta = np.arctan2(points[:, 1], points[:, 0])[cells[:, :3]]
    cut = rng.uniform(-0.6, 0.5)
    keep = (theta.max(axis=1) < cut) | (theta.min(axis=1) > cut)
    return points, cells[keep], {key: values[keep] for key, values in at.items()}, on


def _mesh_with_doubled_node(
    rng: random.Random, points: Any, cells: Any, at: Any, on: Any
) -> Spoiled:
    """A mesh in which an element does not share a corner with its neighbours."""
    i, k = rng.randrange(len(cells)), rng.randrange(3)
    points = np.vstack([points, points[cells[i, k]]])
    on = {key: np.append(values, values[cells[i, k]]) for key, values in on.items()}
    # A corner that belongs to one element only can be doubled without harm.
    if np.count_nonzero(cells == cells[i, k]) == 1:
        return _mesh_with_inverted_element(rng, points, cells, at, on)
    cells[i, k] = len(points) - 1
    return points, cells, at, on


def _mesh_with_infinite_coordinate(
    rng: random.Random, points: Any, cells: Any, at: Any, on: Any
) -> Spoiled:
    """A mesh with a coordinate that is not finite."""
    points[cells[rng.randrange(len(cells)), rng.randrange(3)], rng.randrange(2)] = rng.choice(
        [math.nan, math.inf]
    )
    return points, cells, at, on


def _mesh_with_folded_corner(
    rng: random.Random, points: Any, cells: Any, at: Any, on: Any
) -> Spoiled:
    """A mesh with a corner moved far across its neighbours."""
    points[cells[rng.randrange(len(cells)), rng.randrange(3)], :2] += rng.choice([-1, 1]) * 0.3
    return points, cells, at, on


def _mesh_with_doubled_element(
    rng: random.Random, points: Any, cells: Any, at: Any, on: Any
) -> Spoiled:
    """A mesh that has an element twice."""
    i = rng.randrange(len(cells))
    return (
        points,
        np.vstack([cells, cells[i : i + 1]]),
        {k: np.append(v, v[i]) for k, v in at.items()},
        on,
    )


def _mesh_without_group(rng: random.Random, points: Any, cells: Any, at: Any, on: Any) -> Spoiled:
    """A mesh without one of its groups, or with an empty group."""
    data, name = rng.choice(
        [(at, "lining"), (at, "shoe"), (on, "contact"), (on, "hinge"), (on, "actuation")]
    )
    if rng.random() < 0.5:
        del data[name]
    else:
        data[name][:] = 0
    return points, cells, at, on


def _mesh_with_wrong_groups(
    rng: random.Random, points: Any, cells: Any, at: Any, on: Any
) -> Spoiled:
    """A mesh with an element that belongs to no group of elements, or to all of them."""
    i, value = rng.randrange(len(cells)), rng.randrange(2)
    for values in at.values():
        values[i] = value
    return points, cells, at, on


def _mesh_in_other_unit(rng: random.Random, points: Any, cells: Any, at: Any, on: Any) -> Spoiled:
    """A mesh in another unit of length."""
    return points * rng.choice([1e3, 1e-3, 25.4]), cells, at, on


def _mesh_off_plane(rng: random.Random, points: Any, cells: Any, at: Any, on: Any) -> Spoiled:
    """A mesh with a point off the plane."""
    points[rng.randrange(len(points)), 2] = 0.01
    return points, cells, at, on


def _mesh_with_missing_node(
    rng: random.Random, points: Any, cells: Any, at: Any, on: Any
) -> Spoiled:
    """A mesh with an element on a node that does not exist."""
    cells[rng.randrange(len(cells)), rng.randrange(cells.shape[1])] = rng.choice(
        [-1, len(points), 2**40]
    )
    return points, cells, at, on


def _mesh_with_far_middle_node(
    rng: random.Random, points: Any, cells: Any, at: Any, on: Any
) -> Spoiled:
    """A mesh with the middle node of an edge far from the edge, so that an element folds over."""
    points[cells[rng.randrange(len(cells)), rng.randrange(3, 6)], :2] += 0.2
    return points, cells, at, on


SPOILS: dict[str, Callable[..., Spoiled]] = {
    "inverted element": _mesh_with_inverted_element,
    "disconnected parts": _mesh_torn_in_two,
    "doubled node": _mesh_with_doubled_node,
    "NaN or infinity": _mesh_with_infinite_coordinate,
    "folded": _mesh_with_folded_corner,
    "doubled element": _mesh_with_doubled_element,
    "group missing": _mesh_without_group,
    "element in no group or in two": _mesh_with_wrong_groups,
    "another unit": _mesh_in_other_unit,
    "not plane": _mesh_off_plane,
    "undefined node": _mesh_with_missing_node,
    "middle node far off": _mesh_with_far_middle_node,
}
"""The function that spoils a mesh, by what is then wrong with it."""
