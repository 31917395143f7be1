"""The brake file that the interactive page saves is valid and describes the same brake."""

import os
import shutil
import threading
import tomllib
from http.client import HTTPConnection
from pathlib import Path

import pytest

from conftest import ROOT, STUDY
from drumlin.base.errors import BadInput
from drumlin.brake.plane_brake import read_drum_or_plane_brake
from drumlin.brake.writing import brake_file_text
from drumlin.explore.answers import SliderSolver
from drumlin.explore.page import http_reply_to_requested_address
from drumlin.explore.serve import _Server
from picking import picked

NAMES = [
    os.fsdecode(b"br\xffake"),
    "a\nb",
    "a\r\nb = 1",
    "a\x7fb",
    "a\u2028b",
    "a\x85b",
    'a"b',
    "x\\",
    "µ λ",
    "#",
    "-",
    "\x00",
    "a\n[[shoe]]\nname = 'x'",
    "n" * 200,
]


@pytest.fixture(scope="module")
def explorer():
    return SliderSolver(read_drum_or_plane_brake(STUDY / "brake.toml"))


def require_equal_up_to_rounding(found, meant):
    """Fail unless two brakes as plain data are equal; a saved point has nine digits."""
    if isinstance(meant, dict):
        assert found.keys() == meant.keys()
        found, meant = list(found.values()), list(meant.values())
    if isinstance(meant, list | tuple):
        for one, other in zip(found, meant, strict=True):
            require_equal_up_to_rounding(one, other)
    elif isinstance(meant, float):
        assert found == pytest.approx(meant, rel=5e-9, abs=1e-15)
    else:
        assert found == meant


@pytest.mark.parametrize("name", NAMES, ids=ascii)
def test_the_saved_file_is_the_same_brake_whatever_the_file_was_called(explorer, tmp_path, name):
    saved = http_reply_to_requested_address(explorer, "/brake.toml?friction=0.4", name)
    assert (
        saved.status == 200
        and saved.file_name.isprintable()
        and not set(saved.file_name) & set('/\\:*?"<>|')
    )
    data = saved.text.encode("utf-8", errors="strict")
    path = tmp_path / saved.file_name[-100:]
    path.write_bytes(data)
    assert set(tomllib.loads(data.decode())) == set(
        tomllib.loads((STUDY / "brake.toml").read_text())
    )
    meant = explorer.brake.model_copy(update={"friction_as_written": 0.4})
    require_equal_up_to_rounding(read_drum_or_plane_brake(path).model_dump(), meant.model_dump())


@pytest.mark.parametrize("name", NAMES)
def test_the_server_sends_it(name, explorer):
    server = _Server(explorer, name, 0)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    try:
        asked = HTTPConnection("127.0.0.1", server.server_port, timeout=20)
        asked.request(
            "GET",
            "/brake.toml?friction=0.4",
            headers={"Host": f"localhost:{server.server_port}"},
        )
        answer = asked.getresponse()
        assert answer.status == 200 and "_explored.toml" in answer.headers["Content-Disposition"]
        assert tomllib.loads(answer.read().decode())["friction"] == 0.4
        asked.close()
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


def copied(folder: Path) -> Path:
    """The path of a copy of the brake, with its mesh files, in a folder."""
    folder.mkdir()
    for file in ("double_shoe.toml", "double_shoe_left.msh", "double_shoe_right.msh"):
        shutil.copy(ROOT / "meshes" / file, folder)
    return folder / "double_shoe.toml"


@pytest.mark.parametrize("name", ["a\x7fb", "a b", "µ", 'a"b', "a\\b", "a\nb", "a\tb"], ids=ascii)
def test_mesh_files_are_found_from_any_folder(tmp_path, monkeypatch, name):
    copied(tmp_path / name)
    monkeypatch.chdir(tmp_path)
    brake = read_drum_or_plane_brake(Path(name) / "double_shoe.toml")
    saved = http_reply_to_requested_address(SliderSolver(brake), "/brake.toml", "b")
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / saved.file_name).write_text(saved.text, encoding="utf-8")
    monkeypatch.chdir("/")
    again = read_drum_or_plane_brake(tmp_path / "elsewhere" / saved.file_name)
    assert picked(again.shoes, "mesh") == [tmp_path / shoe.mesh for shoe in brake.shoes]
    shoes = tuple(
        shoe.model_copy(update={"mesh": mine.mesh})
        for shoe, mine in zip(again.shoes, brake.shoes, strict=True)
    )
    same = again.model_copy(update={"shoes": shoes})
    require_equal_up_to_rounding(same.model_dump(), brake.model_dump())


def test_a_mesh_that_no_brake_file_can_name_is_refused_in_a_line(tmp_path):
    brake = read_drum_or_plane_brake(copied(tmp_path / os.fsdecode(b"fol\xffder")))
    with pytest.raises(BadInput, match="has bytes that are no UTF-8"):
        brake_file_text(brake)
    saved = http_reply_to_requested_address(SliderSolver(brake), "/brake.toml", "b")
    assert saved.status == 422 and "no UTF-8" in saved.text and not saved.file_name
