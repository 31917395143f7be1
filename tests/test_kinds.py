"""Every kind of brake in every use: it answers, or one line of a list says why it does not."""

import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import meshio
import numpy as np
import pytest

import command_line
import drumlin
from conftest import ROOT, partly
from drumlin import Brake, vary
from drumlin.base.errors import DrumlinError
from drumlin.brake.plane_brake import FlatBrake, read_drum_or_plane_brake
from drumlin.cli.commands import app
from drumlin.fem.analysis.holding import (
    find_drum_rotation_of_full_slip,
    turn_holding_brake_and_return_states_at_rotations,
)
from drumlin.fem.analysis.sensitivity import compute_torque_sensitivity
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.mesh.file import write_shoe_mesh_to_file
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.laws import solve_brake_by_its_rigid_shoe_law
from drumlin.lining_wear.archard import WearLaw
from drumlin.lining_wear.linings import wear_setup_by_finite_elements
from drumlin.lining_wear.run_in import (
    DEFAULT_WEAR_COEFFICIENT,
    compute_checks_of_wear_run,
    sliding_distance_of_e_fold_pressure_change,
    wear_brake_linings_until_worn_in,
)
from drumlin.models import model_with_name_that_applies_to_brake
from drumlin.response.balance import brake_with_forces_of_response
from drumlin.verification import triangles
from drumlin.verification.check import (
    are_curve_deviations_within_tolerance,
    compare_curves_with_reference,
    read_pressure_curves,
)
from drumlin.verification.reference import (
    MeshesOfReferenceValues,
    compute_reference_values,
    solve_brake_for_reference_values,
)
from drumlin.verification.reference_file import (
    read_reference_file,
    reference_values_as_json_data,
    write_reference_file,
)
from picking import keyed, picked
from shared_parts import modulus_slopes, solve_on_elements_of_files

FILES = keyed(sorted((ROOT / "studies" / "brakes").glob("*.toml")), "stem")
FILES["pad"] = ROOT / "studies" / "laws" / "pad.toml"
ELEMENTS = 10


class Posed(NamedTuple):
    """A brake, its file, and a folder to write into."""

    brake: Brake
    file: Path
    folder: Path

    def command(self, *words: str) -> None:
        # A refusal passes through the command as an exception, which the matrix of uses expects.
        with pytest.raises(SystemExit) as end:
            app([words[0], str(self.file), *words[1:]])
        assert end.value.code == 0


def balanced(response: Any) -> float:
    assert max(response.balance.force, response.balance.moment) < 1e-9
    assert response.effect > 0
    return response.effect


def solved(at: Posed) -> None:
    response = drumlin.solve(at.brake)
    balanced(response)
    # Struts act within the brake: pins, feet, forces from outside and the drum remain.
    whole = brake_with_forces_of_response(at.brake, response)
    # The strut between feet on anchors is part of the reactions of both, and cancels.
    links = [] if any(shoe.anchors for shoe in at.brake.shoes) else at.brake.links
    inside = set(picked(links, "to"))
    feet = set(picked(links, "source"))
    outer = [s.actuation.force_vector for s in whole.shoes if s.name not in inside]
    outer += [
        r.hinge_reaction
        for s, r in zip(whole.shoes, response.shoes, strict=True)
        if s.name not in feet
    ]
    if response.bearing_load is not None and not at.brake.surface.is_plane_and_not_drum:
        total = np.sum([*outer, -response.bearing_load], axis=0)
        assert np.linalg.norm(total) < 1e-9 * np.abs(outer).max()


def to_tolerance(at: Posed) -> None:
    rough, fine = drumlin.solve(at.brake, tolerance=0.01), drumlin.solve(at.brake, tolerance=1e-4)
    assert balanced(rough) == pytest.approx(balanced(fine), rel=0.01)


def with_clearance(at: Posed) -> None:
    gap = 2e-5
    even = drumlin.solve(vary(at.brake, {"shoe.lining.clearance": gap}), elements=ELEMENTS)
    assert abs(balanced(even) / drumlin.solve(at.brake, elements=ELEMENTS).effect - 1) < 0.3


def radius(brake: Brake) -> float:
    return 0.1 if brake.surface.is_plane_and_not_drum else brake.size


def with_misfit(at: Posed) -> None:
    # The guides of a pad take up every moment.
    if flat(at.brake):
        crowned = drumlin.solve(
            vary(at.brake, {"shoe.lining.misfit": {"radius": 100.0, "taper": 1e-5}})
        )
        balanced(crowned)
        assert (
            crowned.shoes[0].peak_pressure > 1.05 * drumlin.solve(at.brake).shoes[0].peak_pressure
        )
        return
    brake = vary(
        at.brake,
        {
            "shoe.lining.misfit": {"radius": 0.999 * radius(at.brake)},
            "drum.out_of_round": [{"order": 2, "amplitude": 1e-5, "phase": 0.3}],
        },
    )
    assert (
        abs(balanced(drumlin.solve(brake, elements=ELEMENTS)) / drumlin.solve(at.brake).effect - 1)
        > 1e-3
    )


def on_ring(at: Posed) -> None:
    R = radius(at.brake)
    ring = {
        "thickness": 0.1 * R,
        "width": 0.06,
        "material": {"E": 1.1e11, "nu": 0.25},
        "support": "fixed",
    }
    soft = balanced(drumlin.solve(vary(at.brake, {"drum.ring": ring}), elements=ELEMENTS))
    hard = ring | {"material": {"E": 1.1e17, "nu": 0.25}}
    stiff = balanced(drumlin.solve(vary(at.brake, {"drum.ring": hard}), elements=ELEMENTS))
    rigid = drumlin.solve(at.brake, elements=ELEMENTS).effect
    assert stiff == pytest.approx(rigid, rel=1e-4)
    assert soft != pytest.approx(rigid, rel=1e-5) or len(at.brake.shoes) == 1


def worn_in(at: Posed) -> None:
    assert drumlin.solve(at.brake, worn_in=True, elements=40).effect == pytest.approx(
        solve_brake_by_its_rigid_shoe_law(at.brake).effect, rel=1e-2
    )


def wears(at: Posed) -> None:
    own, rule = at.brake, WearLaw(DEFAULT_WEAR_COEFFICIENT)
    setup = wear_setup_by_finite_elements(make_prepared_model(own, elements=ELEMENTS), own)
    states = wear_brake_linings_until_worn_in(
        setup, rule, distance=0.3 * sliding_distance_of_e_fold_pressure_change(setup, rule)
    )
    found = compute_checks_of_wear_run(setup, states, rule)
    assert states[-1].removed > 0
    assert found.volume < 1e-9
    assert found.energy is not None
    assert found.energy < 0.02


def slopes(at: Posed) -> None:
    """Slopes under all forces grown alike, which scale the torque where linings fit.

    The forces of wheel cylinders and cams count too.
    """
    found = compute_torque_sensitivity(make_prepared_model(at.brake, elements=ELEMENTS), at.brake)
    forces = [
        (s.force or 0.0) * shoe.actuation.force
        for s, shoe in zip(found.shoes, at.brake.shoes, strict=True)
    ]
    drive = sum(forces) if found.drive is None else found.drive
    assert drive == pytest.approx(found.torque, rel=1e-9)
    moduli = modulus_slopes(found)
    assert sum(moduli) == pytest.approx(0.0, abs=1e-9 * abs(found.torque))


def held(at: Posed) -> None:
    """`hold` ends at full slip: friction holds the drum, or a line names a foot held elsewhere."""
    scene = make_prepared_model(at.brake, elements=ELEMENTS)
    states = turn_holding_brake_and_return_states_at_rotations(
        scene, at.brake, np.linspace(0, find_drum_rotation_of_full_slip(scene, at.brake), 4)
    )
    torque = drumlin.solve(at.brake, elements=ELEMENTS).effect
    agrees = states[-1].torque == pytest.approx(torque, rel=1e-6)
    assert agrees or "left the foot of shoe" in states[-1].notes[0]
    assert states[0].torque < states[-1].torque
    assert states[-1].dissipated > states[0].dissipated > 0


def own_meshes(at: Posed) -> None:
    scene = make_prepared_model(at.brake, elements=ELEMENTS)
    changes = {}
    for i, (shoe, body) in enumerate(zip(scene.brake.shoes, scene.bodies, strict=True)):
        path = at.folder / f"{shoe.name}.msh"
        write_shoe_mesh_to_file(path, body.mesh, shoe)
        changes[f"shoe[{i}].mesh"] = str(path)
    filed = vary(at.brake, changes)
    a, b = drumlin.solve(at.brake, elements=ELEMENTS), solve_on_elements_of_files(filed)
    assert balanced(b) == pytest.approx(balanced(a), rel=1e-9)
    for x, y in zip(a.shoes, b.shoes, strict=True):
        np.testing.assert_allclose(y.pressure, x.pressure, rtol=1e-5, atol=1e-8 * x.peak_pressure)
    # Higher degrees on the same elements state an error above their true one.
    found, known = drumlin.solve(filed), drumlin.solve(at.brake)
    stated = found.error["torque"] + known.error["torque"]
    assert abs(balanced(found) / balanced(known) - 1) < stated < 0.1


def swept(at: Posed) -> None:
    sweep, table = at.folder / "sweep.toml", at.folder / "table.csv"
    sweep.write_text(
        f'title = "t"\nbrake = "{at.file}"\n[model.fem]\nelements = 10\n[vary]\nfriction = '
        f"[0.1, 0.2]\n"
    )
    # A refusal passes through the command as an exception, which the matrix of uses expects.
    with pytest.raises(SystemExit) as end:
        app(["sweep", str(sweep), "--output", str(table)])
    assert end.value.code == 0
    rows = list(csv.DictReader(table.read_text().splitlines()))
    assert picked(rows, "friction") == ["0.1", "0.2"]
    assert not any(row.get("error") or row.get("reason") for row in rows)


def exported(at: Posed) -> None:
    at.command("export", "--to", "calculix", "--output", str(at.folder), "--elements", "10")
    assert list(at.folder.glob("*.inp"))


ROUGHLY = MeshesOfReferenceValues(
    2,
    REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1:3],
    triangles.TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE[:1],
)


def referred(at: Posed) -> None:
    """Reference values on coarser meshes than the cited ones.

    On a drum their second solver covers the brake.
    """
    trio = solve_brake_for_reference_values(at.brake, ROUGHLY)
    assert (trio.other is None) == flat(at.brake)
    found = compute_reference_values(at.brake, at.file.read_text(), "made here", trio)
    assert found.torque.value == pytest.approx(drumlin.solve(at.brake).effect, rel=1e-3)
    assert found.torque.uncertainty < 1e-3 * found.torque.value
    write_reference_file(reference_values_as_json_data(found), at.folder / "r.json")


def checked(at: Posed) -> None:
    referred(at)
    curves = at.folder / "p.csv"
    at.command("solve", "--pressure", str(curves))
    done = command_line.drumlin("check", at.file, curves, "--reference", at.folder / "r.json")
    assert done.returncode == 0
    known = read_reference_file(at.folder / "r.json")
    assert known.surface == at.brake.surface
    verdicts = compare_curves_with_reference(
        at.brake, known, read_pressure_curves(curves, at.brake)
    )
    assert are_curve_deviations_within_tolerance(verdicts, 5e-3)
    for verdict, shoe in zip(verdicts, drumlin.solve(at.brake).shoes, strict=True):
        own = shoe.torque or drumlin.solve(at.brake).effect
        assert verdict.torque == pytest.approx(own, rel=2e-2)


def compared(at: Posed) -> None:
    at.command("compare", "--output", str(at.folder / "report"), "--elements", "16")
    assert (at.folder / "report" / "index.html").stat().st_size > 1000


def viewed(at: Posed) -> None:
    at.command("view", "--output", str(at.folder / "v.svg"))
    assert (at.folder / "v.svg").stat().st_size > 1000


def costed(at: Posed) -> None:
    at.command("cost", "--elements", "8")


def offered(model: str) -> Callable[[Posed], None]:
    """Whether a model answers the brake, without its answer, which its own tests judge."""

    def use(at: Posed) -> None:
        model_with_name_that_applies_to_brake(model, at.brake)

    return use


QUICK: dict[str, Callable[[Posed], None]] = {
    "solve": solved,
    "clearance": with_clearance,
    "misfit": with_misfit,
    "ring": on_ring,
    "wear": wears,
    "sensitivity": slopes,
    "hold": held,
    "own mesh": own_meshes,
    "export": exported,
    "solid": offered("solid"),
    "foundation": offered("foundation"),
}
SLOW: dict[str, Callable[[Posed], None]] = {
    "tolerance": to_tolerance,
    "worn in": worn_in,
    "sweep": swept,
    "check": checked,
    "compare": compared,
    "view": viewed,
    "cost": costed,
}
USES = QUICK | SLOW


class Refusal(NamedTuple):
    """What refuses which brakes, by which words."""

    uses: set[str]
    where: Callable[[Brake], bool]
    words: str


def unmeshed(brake: Brake) -> bool:
    return any(shoe.lining.thickness is None for shoe in brake.shoes)


def flat(brake: Brake) -> bool:
    return isinstance(brake, FlatBrake)


def unhinged(brake: Brake) -> bool:
    return (
        not brake.surface.is_plane_and_not_drum
        and brake.reason_why_not_all_shoes_are_hinged() is not None
    )


HINGED = "takes shoes on hinges under forces of their own only: "
REFUSALS = [
    Refusal({"export"}, flat, "is a brake on a plane; .* takes brakes on a drum"),
    Refusal({"ring"}, flat, "unknown key 'drum'; allowed: title, friction, plane"),
    Refusal(
        set(USES) - {"compare", "view", "foundation"},
        unmeshed,
        "its lining has no thickness and material to mesh",
    ),
    Refusal({"export"}, unhinged, f"CalculiX {HINGED}"),
    Refusal({"foundation"}, lambda b: True, "does not apply to this brake: "),
]


def cell(name: str, use: str, folder: Path) -> None:
    brake = read_drum_or_plane_brake(FILES[name])
    refusal = next((one for one in REFUSALS if use in one.uses and one.where(brake)), None)
    at = Posed(brake, FILES[name], folder)
    if refusal is None:
        USES[use](at)
        return
    with pytest.raises(DrumlinError, match=refusal.words) as said:
        USES[use](at)
    assert "\n" not in str(said.value)


@pytest.mark.parametrize("use", QUICK)
@pytest.mark.parametrize("name", partly(FILES, {"pad"}))
def test_every_kind_in_every_use(name: str, use: str, tmp_path: Path) -> None:
    cell(name, use, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("use", SLOW)
@pytest.mark.parametrize("name", FILES)
def test_every_kind_in_every_slow_use(name: str, use: str, tmp_path: Path) -> None:
    cell(name, use, tmp_path)


def test_a_pad_on_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Its words and units: a braking force, slides in mm, a mesh where the shoe stands."""
    file = FILES["rail_clamp"]
    at = Posed(read_drum_or_plane_brake(file), file, tmp_path)
    at.command("sensitivity", "--elements", "10")
    at.command("hold", "--elements", "10", "--steps", "2", "--rotation", "0.2 mm")
    at.command("wear", "--elements", "10", "--distance", "0.1", "--torque", "5 kN")
    at.command("mesh", "--elements", "10", "--output", str(tmp_path))
    said = " ".join(capsys.readouterr().out.split())
    force = drumlin.solve(at.brake, elements=10).effect
    assert f"braking force {force:.6g} N, dF/dmu" in said
    assert "slide [mm] force [N]" in said
    assert f"0.200000 {force:.4f}" in said
    assert "worn in (law): braking force 5000 N" in said
    xy = meshio.read(tmp_path / "rail_clamp_pad.msh").points
    assert (xy[:, 0].min(), xy[:, 0].max()) == pytest.approx((-0.08, 0.08))
    assert (xy[:, 1].min(), xy[:, 1].max()) == pytest.approx((0.0, 0.03))
