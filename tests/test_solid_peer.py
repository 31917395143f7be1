"""Solid shoes as CalculiX decks: their contents, and CalculiX's answers where it is installed."""

import json
from dataclasses import asdict

import numpy as np
import pytest

from command_line import drumlin
from drumlin import peers
from drumlin.brake.file import vary
from drumlin.fem import solid as solid_shoes
from drumlin.peers import solid_deck
from drumlin.peers.deck import CalculixDeckParameters
from drumlin.response.norms import relative_distance_of_pressures, relative_error_of_number
from drumlin_studies import solid_peer
from picking import picked
from sections import t_section

needs_calculix = pytest.mark.skipif(
    peers.install_hint_if_missing("calculix") is not None,
    reason=peers.install_hint_if_missing("calculix") or "",
)


def volume(points, nodes):
    """Volume of a hexahedron with straight edges between its corners, by its six tetrahedra."""
    a, *others = points[nodes[:8]]
    around = [(1, 2, 6), (2, 3, 6), (3, 7, 6), (7, 4, 6), (4, 5, 6), (5, 1, 6)]
    return sum(np.linalg.det(np.array([others[i - 1] - a for i in three])) for three in around) / 6


class Parsed:
    """A solid's deck as its keywords with their rows of words.

    `nodes` (n, 3) by label; `elements` of 20 nodes, each on two lines.
    """

    def __init__(self, text):
        self.sections = []
        for line in text.splitlines():
            # CalculiX reads no more of a line.
            assert len(line) <= 132
            if line.startswith("*") and not line.startswith("**"):
                key, *words = (word.strip() for word in line[1:].split(","))
                self.sections.append((key, dict(word.partition("=")[::2] for word in words), []))
            elif not line.startswith("**"):
                self.sections[-1][2].append(
                    [word.strip() for word in line.split(",") if word.strip()]
                )
        rows = self.rows("NODE")
        self.points = np.full((max(int(row[0]) for row in rows) + 1, 3), np.nan)
        for label, *at in rows:
            self.points[int(label)] = list(map(float, at))
        self.elements, self.sets = {}, {}
        for key, given, rows in self.sections:
            if key == "ELEMENT" and given["TYPE"].startswith("C3D20"):
                for first, second in zip(rows[::2], rows[1::2], strict=True):
                    label, *nodes = map(int, first + second)
                    self.elements[label] = nodes
                    self.sets.setdefault(given["ELSET"], []).append(label)
        for nodes in self.elements.values():
            assert len(nodes) == 20

    def rows(self, keyword, **options):
        return [
            row
            for key, given, rows in self.sections
            if key == keyword and options.items() <= given.items()
            for row in rows
        ]


@pytest.fixture(scope="module", params=["one width", "T-section", "external"])
def posed(request, flexible):
    brake = t_section(flexible) if request.param == "T-section" else flexible
    if request.param == "external":
        brake = vary(flexible, {"shoe.side": "external", "shoe.body": None})
    loaded, solid = solid_deck._mesh_solid_shoes_under_actuation(brake, 8, 2)[1]
    return (
        brake,
        loaded,
        solid,
        Parsed(
            solid_deck.deck_text_of_half_solid_shoe(
                brake, loaded, solid, CalculixDeckParameters(thickness=0.5)
            )
        ),
    )


def test_all_elements_have_a_positive_volume_and_the_faces_lie_on_the_drum(posed):
    brake, _, _, parsed = posed
    points, elements = parsed.points, parsed.elements
    assert min(volume(points, nodes) for nodes in elements.values()) > 0
    lining = [(int(label), face) for label, face in parsed.rows("SURFACE", NAME="SLINING")]
    ((_, face),) = parsed.rows("SURFACE", NAME="SDRUM")
    drum = [(label, face) for label in parsed.sets["DRUM"]]
    assert len(lining) in {8 * 2, 8 * 3} and len(drum) == 8 + 4
    for label, face in lining + drum:
        corners = [elements[label][i] for i in solid_deck.HEXAHEDRON_FACES[int(face[1:]) - 1]]
        np.testing.assert_allclose(
            np.hypot(*points[corners][:, :2].T), brake.drum.radius * 1e3, rtol=1e-9
        )


def test_middles_of_edges_lie_between_their_ends(posed):
    """Middle nodes of a solid's edges lie between their ends.

    Each is nearer to both ends than these are to each other.
    """
    _, _, _, parsed = posed
    around = [
        (0, 1),
        (1, 2),
        (2, 3),
        (3, 0),
        (4, 5),
        (5, 6),
        (6, 7),
        (7, 4),
        (0, 4),
        (1, 5),
        (2, 6),
        (3, 7),
    ]
    for nodes in parsed.elements.values():
        x = parsed.points[nodes]
        for k, (i, j) in enumerate(around):
            assert np.linalg.norm(x[8 + k] - (x[i] + x[j]) / 2) < 0.05 * np.linalg.norm(x[i] - x[j])


def test_the_load_is_half_the_actuation(posed):
    _, loaded, _, parsed = posed
    total = np.zeros(2)
    for _, component, value in parsed.rows("CLOAD"):
        if int(component) <= 2:
            total[int(component) - 1] += float(value)
    if loaded.shoe.body is not None:
        np.testing.assert_allclose(total, loaded.shoe.actuation.force_vector / 2, atol=1e-6 * 2e3)


def test_the_command_writes_the_decks(root, tmp_path):
    file = root / "studies" / "double_shoe" / "flexible.toml"
    done = drumlin(
        "export",
        file,
        "--to",
        "calculix",
        "--model",
        "solid",
        "--elements",
        8,
        "--output",
        tmp_path,
    )
    assert done.returncode == 0, done.stderr
    assert sorted(picked(tmp_path.iterdir(), "name")) == [
        f"flexible_{name}_solid.inp" for name in ("left", "right")
    ]
    bad = drumlin("export", file, "--to", "calculix", "--model", "sine")
    assert bad.returncode == 2 and "allowed: fem, solid" in bad.stderr


@needs_calculix
@pytest.mark.slow
@pytest.mark.parametrize("section", ["one width", "T-section"])
def test_calculix_answers_alike(flexible, section):
    """CalculiX agrees on solid shoes: the torque to 5e-4, the mean pressure to 1.5 %.

    The programs share only the brake: drumlin has polynomials across the width, CalculiX has
    hexahedra C3D20R. On twice as many hexahedra these differences are as large, so that most of
    them is CalculiX's penalty and its own mesh. The ends of the lining are left out.
    """
    brake = t_section(flexible) if section == "T-section" else flexible
    mine = solid_shoes.solve(brake, across=3)
    other = solid_deck.solve_solid_by_calculix(brake, elements=14, across=3).response
    for a, b in zip(mine.shoes, other.shoes, strict=True):
        off = abs(relative_error_of_number(b.torque, a.torque))
        assert off < 5e-4 + a.error["torque"]
        assert off < 1e-3
        zone = brake.shoes[0].lining.thickness / brake.drum.radius / 2
        assert relative_distance_of_pressures(b, a, zone) < 0.015
        np.testing.assert_allclose(
            b.hinge_reaction, a.hinge_reaction, atol=2e-3 * np.linalg.norm(a.hinge_reaction)
        )


def row_of_both_programs(distance, step, reason=""):
    apart = {"torque": distance, "pressure": distance}
    return solid_peer.SolidPeerRow(
        "built",
        1,
        reason,
        stated={"torque": 1e-3, "pressure": 1e-2},
        distances=(apart,) if not reason else (),
        steps=({"torque": step, "pressure": step},),
        seconds=1.0,
        peer_seconds=(4.0,),
    )


def test_programs_agree_within_the_stated_error_and_the_last_step():
    rows = [
        row_of_both_programs(2e-3, 5e-4),
        row_of_both_programs(2e-3, 2e-3),
        row_of_both_programs(0.0, 0.0, "no answer"),
    ]
    assert [row.do_programs_agree("torque") for row in rows[:2]] == [False, True]
    assert all(row.do_programs_agree("pressure") for row in rows[:2])
    first, _, torque, pressure, last = solid_peer.table_lines_of_distances_from_calculix(rows)
    assert first == "2 of 3 brakes are solved by both programs"
    assert torque.split() == ["torque", "1", "0.200", "0.20", "0.125", "0.20"]
    assert pressure.split()[:2] == ["pressure", "2"] and "4.0 times" in last


@needs_calculix
@pytest.mark.slow
def test_calculix_agrees_on_a_random_shoe_with_table_and_web(tmp_path):
    row = solid_peer.compare_random_solid_brake_with_calculix("built", 510062, 300.0)
    assert not row.reason
    assert row.do_programs_agree("torque") and row.do_programs_agree("pressure")
    assert max(row.distances[-1].values()) < 5e-3
    path = tmp_path / "rows.jsonl"
    path.write_text(json.dumps(asdict(row)) + "\n", encoding="utf-8")
    assert solid_peer.read_solid_peer_rows(path) == [row]
    gone = solid_peer.compare_random_solid_brake_with_calculix("built", 510062, 0.1)
    assert gone.reason.startswith("given up after 0.1 s") and not gone.distances
