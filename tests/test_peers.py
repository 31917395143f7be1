"""CalculiX and GetFEM: decks, reading back, refusals, and answers where they are installed."""

import shutil
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from drumlin import peers
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.file import read_brake, vary
from drumlin.brake.plane_brake import read_drum_or_plane_brake
from drumlin.cli.commands import app
from drumlin.comparison import length_of_uncompared_zone_at_lining_end
from drumlin.fem.solve import solve
from drumlin.peers import calculix, getfem
from drumlin.peers.deck import (
    PIN_SPRING_STIFFNESS_IN_N_PER_MM,
    CalculixDeckParameters,
    angles_of_drum_nodes,
    plane_stress_deck_text,
)
from drumlin.peers.peer import mesh_hinged_shoes_under_actuation
from drumlin.response.norms import relative_distance_of_pressures
from drumlin_studies.brake_kinds import brake_and_reversed_brake
from drumlin_studies.random_kinds import (
    FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND,
    draw_random_brake_of_support_kind,
)
from picking import picked

STUDIES = Path(__file__).parents[1] / "studies"
MAIN = read_brake(STUDIES / "double_shoe" / "brake.toml")
POST = vary(read_brake(STUDIES / "post_brake" / "brake.toml"), {"drum.ring": None})
RIGID = vary(MAIN, {"shoe.body": None})
BACKED = vary(
    MAIN,
    {
        "shoe.backing": {"thickness": 4e-3, "material": {"E": 1e10, "nu": 0.3}},
        "shoe.body.width": 0.05,
    },
)
CLEARANCE = vary(MAIN, {"shoe[0].lining.clearance": 1e-4, "rotation": "clockwise"})

needs_calculix = pytest.mark.skipif(
    peers.install_hint_if_missing("calculix") is not None,
    reason=peers.install_hint_if_missing("calculix") or "",
)
needs_getfem = pytest.mark.skipif(
    peers.install_hint_if_missing("getfem") is not None,
    reason=peers.install_hint_if_missing("getfem") or "",
)


class Parsed:
    """A CalculiX deck, read as a list of keywords with their data lines."""

    def __init__(self, text):
        self.sections = []
        for line in text.splitlines():
            # CalculiX reads no more of a line.
            assert len(line) <= 132
            if line.startswith("**"):
                continue
            words = [word.strip() for word in line.split(",")]
            if line.startswith("*"):
                options = dict(word.partition("=")[::2] for word in words[1:])
                self.sections.append((words[0][1:], options, []))
            else:
                self.sections[-1][2].append(words)
        self.nodes = {
            int(row[0]): np.array(list(map(float, row[1:3]))) for row in self.rows("NODE")
        }
        self.elements = {
            int(r[0]): list(map(int, r[1:])) for r in self.rows("ELEMENT") if len(r) > 2
        }

    def rows(self, keyword, **options):
        return [
            row
            for key, given, rows in self.sections
            if key == keyword and options.items() <= given.items()
            for row in rows
        ]

    def edge(self, element, face):
        """Ends and middle of a face, in the element's sense."""
        nodes = self.elements[element]
        corners = len(nodes) // 2
        return [self.nodes[nodes[i]] for i in (face - 1, face % corners, corners + face - 1)]


def outward(ends):
    along = ends[1] - ends[0]
    return np.array([along[1], -along[0]]) / np.hypot(*along)


@pytest.mark.parametrize(
    ("brake", "kind"),
    [
        (MAIN, "quad2"),
        (MAIN, "tri2"),
        (BACKED, "quad2"),
        (RIGID, "quad2"),
        (POST, "tri2"),
        (POST, "quad2"),
    ],
    ids=["arc", "triangles", "backing", "rigid", "post-triangles", "post"],
)
@pytest.mark.parametrize("index", [0, 1])
def test_deck_states_the_brake(brake, kind, index):
    """A CalculiX deck states the brake in mm, N and MPa: load, faces, hinge and rotation.

    Faces look towards each other on the friction surface.
    """
    setting = CalculixDeckParameters(rotation=2e-3, thickness=0.02)
    loaded = mesh_hinged_shoes_under_actuation(brake, 12, kind)[index]
    shoe, text = loaded.shoe, plane_stress_deck_text(brake, loaded, setting)
    assert text == plane_stress_deck_text(brake, loaded, setting)
    parsed, R = Parsed(text), brake.drum.radius * 1e3

    # Corners of all elements go counter-clockwise.
    for element in parsed.elements.values():
        x, y = np.array([parsed.nodes[n] for n in element[: len(element) // 2]]).T
        assert (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() > 0
    contact = [(int(e), int(face[1])) for e, face in parsed.rows("SURFACE", NAME="SLINING")]
    assert len(contact) == 12
    ((_, drum_face),) = parsed.rows("SURFACE", NAME="SDRUM")
    drum = [int(row[0]) for row in parsed.rows("ELEMENT", ELSET="DRUM")]
    # Faces lie on the friction surface and look out of their bodies.
    for faces, sign in (
        (contact, shoe.sign_internal_plus_external_minus),
        ([(e, int(drum_face[1])) for e in drum], -shoe.sign_internal_plus_external_minus),
    ):
        for number, face in faces:
            ends = parsed.edge(number, face)
            assert np.hypot(*np.array(ends).T) == pytest.approx(R, rel=1e-9)
            assert outward(ends) @ ends[2] / R == pytest.approx(sign, abs=1e-6)
    angles = angles_of_drum_nodes(loaded)
    assert angles[0] < shoe.lining.start - 0.02 and angles[-1] > shoe.lining.end + 0.02

    force, moment, pin = np.zeros(2), 0.0, shoe.hinge.xy * 1e3
    (turn_node,) = [int(row[0]) for row in parsed.rows("NODE", NSET="TURN")]
    # Loads on the turning node are moments; the others add up to the actuation.
    for node, component, value in parsed.rows("CLOAD"):
        if int(node) == turn_node:
            moment += float(value)
            continue
        f = np.eye(2)[int(component) - 1] * float(value)
        force += f
        arm = parsed.nodes[int(node)] - pin
        moment += arm[0] * f[1] - arm[1] * f[0]
    size = setting.thickness
    assert force == pytest.approx(
        size * shoe.actuation.force_vector, rel=1e-9, abs=1e-9 * abs(size * shoe.actuation.force)
    )
    assert moment == pytest.approx(
        size * 1e3 * shoe.actuation.moment_of_force_about_point(shoe.hinge), rel=1e-9
    )

    # Each constraint ties a node of the hinge to the rigid motion about the pin.
    for terms in [row for row in parsed.rows("EQUATION") if len(row) > 1]:
        node, component, own = int(terms[0]), int(terms[1]), float(terms[2])
        arm = parsed.nodes[node] - pin
        turned = np.array([-arm[1], arm[0]])[component - 1]
        # A turn of 1 about the pin satisfies the constraint.
        assert own * turned + float(terms[8]) == pytest.approx(0, abs=1e-9 * R)
        # A shift of 1 satisfies the constraint.
        assert own + float(terms[5]) == 0

    moved = {}
    # Rows with a value prescribe the drum's displacement.
    for row in parsed.rows("BOUNDARY"):
        if len(row) > 3:
            moved.setdefault(int(row[0]), np.zeros(2))[int(row[1]) - 1] = float(row[3])
    assert set(moved) == {n for e in drum for n in parsed.elements[e]}
    for node, u in moved.items():
        x = parsed.nodes[node]
        # The drum moves along its tangent.
        assert x @ u == pytest.approx(0, abs=1e-11 * (x @ x))
        assert (x[0] * u[1] - x[1] * u[0]) / (x @ x) == pytest.approx(
            brake.sign_of_motion * 2e-3, rel=1e-12
        )

    (modulus, nu) = map(float, parsed.rows("ELASTIC")[0])
    assert (modulus, nu) == pytest.approx((shoe.lining.material.E * 1e-6, shoe.lining.material.nu))
    names = [given["NAME"] for key, given, _ in parsed.sections if key == "MATERIAL"]
    (thickness,) = {float(row[0]) for row in parsed.rows("SOLID SECTION")}
    assert thickness == pytest.approx(0.02 * shoe.lining.width * 1e3)
    # A body wider than the lining is written as a stiffer one.
    if brake is BACKED:
        assert float(parsed.rows("ELASTIC")[names.index("SHOE")][0]) == pytest.approx(
            2.1e5 * 50 / 40
        )


def test_decks_that_calculix_does_not_get():
    with pytest.raises(BadInput, match="quad2, tri2"):
        plane_stress_deck_text(
            MAIN, mesh_hinged_shoes_under_actuation(MAIN, 8, "quad1")[0], CalculixDeckParameters()
        )
    open_ = vary(MAIN, {"shoe[0].lining.clearance": 1e-4})
    with pytest.raises(BadInput, match="clearance"):
        plane_stress_deck_text(
            open_, mesh_hinged_shoes_under_actuation(open_, 8)[0], CalculixDeckParameters()
        )
    for change, said in (
        ({"friction": 0.0}, "friction"),
        ({"drum.ring": {"bending_stiffness": 1e3}}, "ring"),
    ):
        with pytest.raises(BadInput, match=said):
            mesh_hinged_shoes_under_actuation(vary(MAIN, change))


def written(brake, loaded, setting, **changes) -> tuple[str, str, str, float]:
    """CalculiX's result files for a uniform pressure that balances the shoe, and the pressure.

    The pressure is in Pa.
    """
    shoe, R = loaded.shoe, brake.drum.radius
    theta = angles_of_drum_nodes(loaded)
    lining = (theta[:-2:2] >= shoe.lining.start - 1e-9) & (theta[2::2] <= shoe.lining.end + 1e-9)
    xi, w = np.polynomial.legendre.leggauss(8)
    psi = np.array([xi * (xi - 1) / 2, 1 - xi**2, xi * (xi + 1) / 2])
    slope = np.array([xi - 0.5, -2 * xi, xi + 0.5])
    nodal, torque = np.zeros((len(theta), 2)), 0.0
    # The traction -n + mu s e, times the width, acts on the element's edge per pascal.
    for k in np.flatnonzero(lining):
        on = slice(2 * k, 2 * k + 3)
        nodes = R * np.array([np.cos(theta[on]), np.sin(theta[on])])
        x, ds = nodes @ psi, np.hypot(*(nodes @ slope)) * w * shoe.lining.width
        drag = brake.friction * brake.sign_of_motion
        t = (
            -shoe.sign_internal_plus_external_minus * x + drag * np.array([-x[1], x[0]])
        ) / np.hypot(*x)
        nodal[on] += np.einsum("aq,cq,q->ac", psi, t, ds)
        torque += drag * np.hypot(*x) @ ds
    total = nodal.sum(axis=0)
    arm = shoe.hinge.xy
    pressure = shoe.actuation.moment_of_force_about_point(shoe.hinge) / (
        arm[0] * total[1] - arm[1] * total[0] - torque
    )
    pin = -(pressure * total + shoe.actuation.force_vector)
    size = setting.thickness
    nodal, pin = size * pressure * nodal, size * pin * changes.get("pin", 1.0)
    rows = np.zeros((2 * len(theta) + len(theta) // 2 + 1, 2))
    rows[: len(theta)] = nodal
    elements = np.repeat(np.arange(1, 1 + changes.get("touching", 20)), 6)
    shear = changes.get("shear", 1.0) * brake.friction
    when = changes.get("time", "0.1000000E+01")
    dat = [
        f" displacements (vx,vy,vz) for set PIN and time  {when}",
        "",
        f"  900 {-pin[0] / PIN_SPRING_STIFFNESS_IN_N_PER_MM:.6E} "
        f"{-pin[1] / PIN_SPRING_STIFFNESS_IN_N_PER_MM:.6E} 0.000000E+00",
        "",
        f" displacements (vx,vy,vz) for set TURN and time  {when}",
        "",
        "  901 1.000000E-04 0.000000E+00 0.000000E+00",
        "",
        f" forces (fx,fy,fz) for set NDRUM and time  {when}",
        "",
        *[f"  {902 + i} {f[0]:.6E} {f[1]:.6E} 0.000000E+00" for i, f in enumerate(rows)],
        "",
        " contact stress (slave element+face,press,tang1,tang2) for all contact elements and "
        "time 0.1000000E+01",
        "",
        *[f"  {e} 3 {pressure * 1e-6:.6E} {shear * pressure * 1e-6:.6E} 1.0E-09" for e in elements],
    ]
    sta = (
        "SUMMARY OF JOB INFORMATION\n  STEP INC ATT ITRS TOT\n     1   1   1   4  0.5\n     "
        "1   2   1   3  1.0\n"
    )
    return "\n".join(dat) + "\n", sta, " number of equations\n 1459\n", pressure


@pytest.mark.parametrize("index", [0, 1])
def test_results_are_read_as_written(index):
    setting, loaded = (
        CalculixDeckParameters(thickness=0.02),
        mesh_hinged_shoes_under_actuation(MAIN, 20)[index],
    )
    dat, sta, output, pressure = written(MAIN, loaded, setting)
    state = calculix.read_calculix_state(dat, sta, output, MAIN, loaded, setting)
    calculix.require_equilibrium_and_contact(loaded, state)
    assert (state.iterations, state.unknowns) == (7, 1459)
    assert (state.touching, state.points, state.sticking) == (20, 120, 0.0)
    shoe, balance = calculix.shoe_response_and_imbalance_of_calculix_state(loaded, state)
    # The jump at the ends leaves ripples in the elements next to them.
    edge = 0.5
    inside = (shoe.theta > shoe.theta[0] + edge) & (shoe.theta < shoe.theta[-1] - edge)
    assert shoe.pressure[inside] == pytest.approx(pressure, rel=1e-4)
    spec = MAIN.shoes[index].lining
    assert shoe.torque == pytest.approx(
        0.3 * 0.04 * 0.15**2 * (spec.end - spec.start) * pressure, rel=1e-4
    )
    assert shoe.turn == pytest.approx(1e-4)
    assert shoe.self_energising == (MAIN.shoes[index].name == "left")
    assert max(balance.force, balance.moment) < 1e-5


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"pin": 1.01}, "balance"),
        ({"touching": 1}, "contact points"),
        ({"time": "0.4E+00"}, "ended at 0.4"),
    ],
    ids=["unbalanced", "handful", "stopped"],
)
def test_states_that_are_none_are_refused(changes, said):
    setting, loaded = CalculixDeckParameters(), mesh_hinged_shoes_under_actuation(MAIN, 20)[0]
    dat, sta, output, _ = written(MAIN, loaded, setting, **changes)
    with pytest.raises(NoAnswer, match=said):
        calculix.require_equilibrium_and_contact(
            loaded, calculix.read_calculix_state(dat, sta, output, MAIN, loaded, setting)
        )
    assert (
        calculix.read_calculix_state(
            *written(MAIN, loaded, setting, shear=0.9)[:3], MAIN, loaded, setting
        ).sticking
        == 1
    )
    with pytest.raises(NoAnswer, match="wrote no contact state"):
        calculix.read_calculix_state("", "", "", MAIN, loaded, setting)


def test_the_drum_is_turned_further_until_the_lining_slips(monkeypatch):
    loaded, turned = mesh_hinged_shoes_under_actuation(MAIN, 20)[0], []

    def run(brake, loaded, setting, posed=None):
        turned.append(setting.rotation)
        shear = 1.0 if setting.rotation > limit else 0.5
        return calculix.read_calculix_state(
            *written(brake, loaded, setting, shear=shear)[:3], brake, loaded, setting
        )

    monkeypatch.setattr(calculix, "write_deck_of_shoe_and_run_calculix", run)
    limit = 3e-3
    state, rotation = calculix.run_calculix_to_state_and_rotation_of_full_slip(
        MAIN, loaded, CalculixDeckParameters(rotation=1e-3)
    )
    assert (state.sticking, rotation, turned) == (0.0, 4e-3, [1e-3, 2e-3, 4e-3])
    # No rotation is far enough now.
    limit = 1.0
    with pytest.raises(NoAnswer, match="do not slip"):
        calculix.run_calculix_to_state_and_rotation_of_full_slip(
            MAIN, loaded, CalculixDeckParameters(rotation=1e-3)
        )


def test_absent_peers_say_how_to_install_them(monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda _: None)
    for find in (calculix.calculix_version, getfem.path_of_python_with_getfem):
        find.cache_clear()
    try:
        for name, package in (("calculix", "calculix-ccx"), ("getfem", "python3-getfem++")):
            assert f"apt install {package}" in peers.install_hint_if_missing(name)
            with pytest.raises(peers.PeerMissing, match="is not installed") as fault:
                peers.solve_brake_by_calculix_or_getfem(name, MAIN, elements=8)
            assert fault.value.exit_status == 2
    finally:
        for find in (calculix.calculix_version, getfem.path_of_python_with_getfem):
            find.cache_clear()
    with pytest.raises(BadInput, match="allowed: calculix, getfem"):
        peers.solve_brake_by_calculix_or_getfem("abaqus", MAIN)


def test_export_command(tmp_path):
    away = (STUDIES / "double_shoe" / "brake.toml").read_text().replace('"2 kN"', '"-2 kN"', 1)
    (tmp_path / "my brake.toml").write_text(away)
    call = [
        "export",
        str(tmp_path / "my brake.toml"),
        "--output",
        str(tmp_path / "out"),
        "--elements",
        "8",
        "--to",
    ]
    result = CliRunner().invoke(app, [*call, "calculix"])
    assert result.exit_code == 0
    names = sorted(picked((tmp_path / "out").iterdir(), "name"))
    assert names == ["my_brake_left.inp"]
    assert "run: ccx my_brake_left " in (tmp_path / "out" / names[0]).read_text()
    assert "'right': no deck" in result.output
    with pytest.raises(BadInput, match="allowed: calculix"):
        CliRunner().invoke(app, [*call, "abaqus"], catch_exceptions=False)


@needs_getfem
@pytest.mark.parametrize(("formulation", "close"), [("full slip", 2e-6), ("coulomb", 4e-5)])
def test_getfem_agrees(formulation, close):
    """GetFEM agrees with drumlin on the same mesh and contact condition.

    GetFEM decides contact in the weak sense, drumlin node by node.
    """
    peer, own = (
        peers.solve_brake_by_calculix_or_getfem(
            "getfem", MAIN, elements=40, formulation=formulation
        ),
        solve(MAIN, elements=40),
    )
    assert peer.response.torque == pytest.approx(own.torque, rel=close)
    for a, b in zip(peer.response.shoes, own.shoes, strict=True):
        assert relative_distance_of_pressures(a, b) < 1e-3
        assert a.hinge_reaction == pytest.approx(b.hinge_reaction, rel=1e-3)
        assert (a.self_energising, np.sign(a.turn)) == (b.self_energising, np.sign(b.turn))
    assert peer.further_seconds < peer.process_seconds > peer.seconds > 0


def agree(brake, elements=16, close=2e-4, balanced=1e-9, **options):
    peer, own = (
        peers.solve_brake_by_calculix_or_getfem(
            "getfem", brake, elements=elements, **options
        ).response,
        solve(brake, elements=elements),
    )
    assert max(peer.balance.force, peer.balance.moment) < balanced
    for shoe, a, b in zip(brake.shoes, peer.shoes, own.shoes, strict=True):
        size = np.linalg.norm(b.hinge_reaction)
        assert peer.effects[own.shoes.index(b)] == pytest.approx(
            own.effects[own.shoes.index(b)], rel=close
        )
        assert a.hinge_reaction == pytest.approx(b.hinge_reaction, abs=close * size)
        assert (
            relative_distance_of_pressures(a, b, length_of_uncompared_zone_at_lining_end(brake))
            < 0.02
        )
        assert a.self_energising == b.self_energising
        if shoe.guide is not None:
            assert a.reaction_moment == pytest.approx(b.reaction_moment, rel=close)
    return peer, own


@needs_getfem
def test_getfem_takes_a_pivot_and_a_rough_abutment():
    """GetFEM takes a pivot and a rough abutment.

    The held edge moves by the rigid-body modes; the test modes lean with an abutment's friction.
    """
    agree(
        vary(read_drum_or_plane_brake(STUDIES / "brakes" / "crane.toml"), {"shoe.body": None}), 10
    )
    agree(
        vary(
            read_drum_or_plane_brake(STUDIES / "brakes" / "simplex_abutted.toml"),
            {"shoe.body": None},
        ),
        10,
    )


@needs_getfem
@pytest.mark.slow
def test_getfem_shares_a_cams_force_so_that_both_tips_go_alike():
    """GetFEM shares a cam's force so that both tips move alike.

    Where linings fit, tips move in proportion to the forces, which settle at once; otherwise the
    share is sought.
    """
    brake = read_drum_or_plane_brake(STUDIES / "brakes" / "s_cam.toml")
    wrong = {
        "shoe.body": None,
        "shoe[0].lining.clearance": 2e-5,
        "shoe[1].lining.misfit.taper": 2e-5,
    }
    for cam in (brake, vary(brake, wrong)):
        peer, own = agree(cam, 10)
        forces = picked(peer.shoes, "force")
        assert forces == pytest.approx(picked(own.shoes, "force"), rel=1e-4)
        assert sum(forces) == pytest.approx(
            cam.actuation.force_of_cylinder_or_sum_of_cam_forces, rel=1e-12
        )
        assert abs(forces[0] / forces[1] - 1) > 0.1


@needs_getfem
def test_getfems_own_contact_has_the_same_misfit():
    brake = vary(MAIN, {"shoe.lining.misfit": {"radius": 0.1497}})
    agree(brake, 24, close=3e-3, balanced=1e-6, formulation="coulomb")


@needs_getfem
@pytest.mark.slow
@pytest.mark.parametrize("file", sorted(picked((STUDIES / "brakes").glob("*.toml"), "stem")))
def test_getfem_takes_shoes_however_they_are_held(file):
    for brake in brake_and_reversed_brake(
        read_drum_or_plane_brake(STUDIES / "brakes" / f"{file}.toml")
    ):
        # GetFEM gets supports that also pull.
        if any(shoe.anchors for shoe in brake.shoes):
            with pytest.raises(BadInput, match="takes no shoes that can leave their supports"):
                agree(brake)
        else:
            agree(brake)


@needs_getfem
@pytest.mark.slow
@pytest.mark.parametrize("kind", FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND)
def test_getfem_on_random_brakes_of_every_kind(kind):
    """GetFEM agrees on random brakes of every kind.

    The mesh is fine enough for the ends of the contacts: on 16 elements both programs place them
    apart. Where GetFEM's steps go round in circles, another mesh is taken.
    """
    for seed in range(2):
        for elements in (48, 40, 56, 64, 72):
            with suppress(NoAnswer):
                agree(
                    draw_random_brake_of_support_kind(seed, kind),
                    elements=elements,
                    close=1e-3,
                    balanced=1e-8,
                )
                break
        else:
            pytest.fail(f"seed {seed}: no mesh on which GetFEM converges")


@needs_getfem
@pytest.mark.slow
def test_getfem_on_other_brakes():
    for brake in (POST, RIGID, BACKED, CLEARANCE):
        peer, own = (
            peers.solve_brake_by_calculix_or_getfem("getfem", brake, elements=24),
            solve(brake, elements=24),
        )
        assert peer.response.torque == pytest.approx(own.torque, rel=2e-4)
    locked = vary(MAIN, {"friction": 1.3})
    for formulation in getfem.NAMES_OF_GETFEM_CONTACT_FORMULATIONS:
        with pytest.raises(NoAnswer, match="GetFEM"):
            peers.solve_brake_by_calculix_or_getfem(
                "getfem", locked, elements=12, formulation=formulation
            )


@needs_calculix
@pytest.mark.slow
def test_calculix_agrees():
    """CalculiX's pressure is within 2 % of drumlin's in L2, away from the ends.

    One lining thickness at each end is left out. The torque is compared on another mesh, whose
    elements are free to swell across their thickness.
    """
    peer, own = (
        peers.solve_brake_by_calculix_or_getfem("calculix", MAIN, elements=20),
        solve(MAIN, elements=80),
    )
    assert peer.response.torque == pytest.approx(own.torque, rel=5e-4)
    for a, b in zip(peer.response.shoes, own.shoes, strict=True):
        assert relative_distance_of_pressures(a, b, 8 / 150) < 0.02
        assert a.hinge_reaction == pytest.approx(b.hinge_reaction, rel=2e-3)
    rigid = peers.solve_brake_by_calculix_or_getfem("calculix", RIGID, elements=12)
    assert rigid.response.torque == pytest.approx(solve(RIGID, elements=40).torque, rel=1e-3)


def torques(brake, elements, setting=None):
    """Relative difference of each shoe's torque by CalculiX and by drumlin, on equal meshes."""
    own = solve(
        brake,
        elements=elements,
        kind="quad2",
        penalty=(setting or CalculixDeckParameters()).penalty,
    )
    other = peers.solve_brake_by_calculix_or_getfem(
        "calculix", brake, elements=elements, setting=setting
    ).response
    return np.array([a.torque / b.torque - 1 for a, b in zip(other.shoes, own.shoes, strict=True)])


@pytest.mark.slow
@needs_calculix
def test_calculix_has_drumlins_torque_where_nothing_strains_across():
    """CalculiX has drumlin's torque if Poisson's ratio is zero.

    Its elements have a real thickness, which swells under pressure unless nu = 0.
    """
    even = vary(MAIN, {"shoe.lining.material.nu": 0.0, "shoe.body.material.nu": 0.0})
    assert np.abs(torques(even, 20)).max() < 4e-5
    assert np.abs(torques(even, 20, CalculixDeckParameters(thickness=0.1))).max() < 4e-5
    locked = np.abs(torques(MAIN, 20))
    assert (locked > 1e-4).all() and (locked < 5e-4).all()


@needs_calculix
@pytest.mark.slow
@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"rotation": "clockwise", "friction": 0.1},
        {"shoe.side": "external", "shoe.actuation.force": -2e3},
    ],
)
def test_calculix_comes_nearer_with_the_mesh(changes):
    """The difference from CalculiX falls with the element size, faster with nu = 0."""
    brake = vary(MAIN, changes)
    coarse, fine = np.abs(torques(brake, 10)), np.abs(torques(brake, 40))
    assert (coarse > 2.5 * fine).all() and (fine < 4e-4).all()
    even = vary(brake, {"shoe.lining.material.nu": 0.0, "shoe.body.material.nu": 0.0})
    coarse, fine = np.abs(torques(even, 10)), np.abs(torques(even, 40))
    assert (coarse > 16 * fine).all() and (fine < 1e-5).all()
