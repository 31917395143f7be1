"""GetFEM as a peer: write the brake as arrays, and solve it by a script in another Python.

The script is getfem_brake.py beside this module. It imports getfem, which Debian provides only for
the Python of the system, and does not import drumlin. In the script lengths are divided by the
drum's radius, and stresses by Young's modulus of the lining.
"""

import functools
import json
import math
import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import replace
from operator import itemgetter
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.further_loads import reason_if_loads_besides_actuation_act
from drumlin.fem.equilibrium.state import unloaded_lining_gaps_at_points
from drumlin.fem.mesh.arc import DEFAULT_MESH_KIND
from drumlin.fem.mesh.edges import nodes_along_element_edges
from drumlin.fem.model import LARGEST_ACCEPTED_FORCE_IMBALANCE_OF_SHOE
from drumlin.fem.preparation.meshes import DEFAULT_ELEMENTS_ALONG_LINING, Mesher
from drumlin.fem.substructure.elasticity import (
    elastic_layers_of_shoe,
    isotropic_and_orthotropic_elastic_constants,
)
from drumlin.peers.peer import (
    ForcesOnShoeByPeer,
    MeshedShoe,
    MeshedShoeUnderActuation,
    PeerMissing,
    PeerResult,
    brake_response_from_shoe_responses,
    mesh_shoes_for_peer_program,
    meshed_shoe_with_actuation_and_support,
    run_command_of_peer_program,
    shoe_response_and_imbalance_from_peer_forces,
    zero_response_and_imbalance_of_shoe_turned_from_drum,
)
from drumlin.response.response import ForceAndMomentImbalance, ShoeResponse

PATH_OF_GETFEM_SCRIPT = Path(__file__).with_name("getfem_brake.py")
"""Path of the script that solves a brake by GetFEM in another Python."""

GETFEM_MISSING_MESSAGE = (
    "GetFEM is not installed; on Debian and Ubuntu: apt install python3-getfem++"
)
"""The error message if GetFEM is not installed."""

NAMES_OF_GETFEM_CONTACT_FORMULATIONS = ("full slip", "coulomb")
"""The two formulations of contact with friction, which getfem_brake.py describes."""

FRICTION_RATIO_OF_TIMED_LOAD_CASE = 0.9
"""Friction of the second load case, whose time is measured, relative to the brake's friction."""

LEAST_SLIPPING_SHEAR_RATIO = 0.99
"""Ratio of the shear force on a lining to its full friction, below which the lining sticks.

The ratio is the torque of the shear stress divided by the torque of mu p. A state with sticking is
refused."""

LONGEST_GETFEM_SECONDS = 1800
"""Time [s] after which a run of GetFEM is stopped."""

LOADED_END_DISPLACEMENT_TOLERANCE = 1e-10
"""Relative difference below which the displacements of two shoes' loaded ends count as equal.

A cam moves the loaded ends of both shoes by the same displacement."""

MOST_CAM_FORCE_TRIALS = 12
"""Largest number of trials to divide a cam's total force between its two shoes.

Shoes whose linings fit the drum need two trials, because their displacements are proportional to
their forces."""


@functools.cache
def path_of_python_with_getfem() -> str:
    """Path of a Python that can import getfem: `python3` on the PATH, or /usr/bin/python3.

    Raises PeerMissing if neither can.
    """
    for name in ("python3", "/usr/bin/python3"):
        path = shutil.which(name)
        if path is None:
            continue
        command = [path, "-c", "import getfem"]
        if not subprocess.run(command, capture_output=True, check=False).returncode:
            return path
    raise PeerMissing(GETFEM_MISSING_MESSAGE)


def solve_brake_in_getfem_process(
    brake: Brake,
    *,
    elements: int = DEFAULT_ELEMENTS_ALONG_LINING,
    kind: str = DEFAULT_MESH_KIND,
    mesher: Mesher | None = None,
    formulation: str = "full slip",
    repeats: int = 1,
) -> PeerResult:
    """Solve a brake by GetFEM on drumlin's mesh.

    Parameters
    ----------
    brake : the brake
    elements, kind : number of elements along each lining, and kind of the elements
    mesher : function that meshes a shoe; None: drumlin's mesher with `elements` and `kind`
    formulation : "full slip", or "coulomb" for GetFEM's own contact with friction
    repeats : number of times that the brake is solved; the times are medians

    Raises
    ------
    PeerMissing
        if GetFEM is not installed
    BadInput
        for a brake with a ring or without friction
    NoAnswer
        if GetFEM does not converge
    """
    if formulation not in NAMES_OF_GETFEM_CONTACT_FORMULATIONS:
        raise BadInput(
            f"formulation = {formulation!r}: unknown; allowed: "
            f"{', '.join(NAMES_OF_GETFEM_CONTACT_FORMULATIONS)}"
        )
    interpreter = path_of_python_with_getfem()
    meshed = mesh_shoes_for_peer_program(brake, elements, kind, mesher)
    solver = _GetfemScriptRunner(interpreter, brake, meshed, formulation, repeats)
    answers = _solve_shoes_and_return_results_by_name(brake, solver)
    each = [answers[shoe.name][:2] for shoe in brake.shoes]
    costs = solver.steps_times_and_unknowns_of_all_runs()
    response = brake_response_from_shoe_responses(
        "getfem", each, costs.steps, {"getfem": costs.seconds_of_first_solve}
    )
    balance = response.balance
    if not max(balance.force, balance.moment) < LARGEST_ACCEPTED_FORCE_IMBALANCE_OF_SHOE:
        raise NoAnswer(
            f"GetFEM: forces balance only to {balance.force:.1e}, moments to {balance.moment:.1e}"
        )
    return PeerResult(
        name="getfem",
        version=costs.version,
        response=response,
        seconds=costs.seconds_of_first_solve,
        process_seconds=costs.process,
        further_seconds=costs.seconds_of_further_load_case,
        unknowns=costs.unknowns,
        notes=(f"GetFEM {costs.version}, {formulation}, {costs.steps} Newton steps, MUMPS",),
    )


class _GetfemScriptRun(NamedTuple):
    """The result of a run of the GetFEM script, and the processor time [s] of its process."""

    result: dict[str, Any]
    seconds: float


class _GetfemCosts(NamedTuple):
    """The costs of all runs of the GetFEM script for a brake.

    Attributes
    ----------
    steps : largest number of Newton steps of a shoe
    seconds_of_first_solve : processor time [s] of a solve from the beginning
    seconds_of_further_load_case : processor time [s] of the second load case, which reuses mesh and
        stiffness of the first
    process : processor time [s] of one solve with the start of its processes
    unknowns : largest number of unknowns of a run
    version : version of GetFEM; "" if no shoe is pressed on the drum
    """

    steps: int
    seconds_of_first_solve: float
    seconds_of_further_load_case: float
    process: float
    unknowns: int
    version: str


class _GetfemScriptRunner:
    """Runs the GetFEM script for shoes of one brake, and keeps the results and times of all runs.

    Parameters
    ----------
    interpreter : path of the Python that runs the script
    brake : the brake
    meshed : meshed shoes of the brake
    formulation, repeats : the arguments of `solve_brake_in_getfem_process`
    """

    def __init__(
        self,
        interpreter: str,
        brake: Brake,
        meshed: list[MeshedShoe],
        formulation: str,
        repeats: int,
    ) -> None:
        self._interpreter = interpreter
        self.brake, self.meshed = brake, meshed
        self._formulation, self._repeats = formulation, repeats
        self._runs: list[_GetfemScriptRun] = []

    def run_getfem_script_for_shoes(
        self, shoes: list[MeshedShoeUnderActuation]
    ) -> list[dict[str, Any]]:
        """Run the script for some shoes; returns its results, a dictionary for each shoe."""
        problem = _brake_data_for_getfem_script(self.brake, shoes, self._formulation, self._repeats)
        self._runs.append(_run_getfem_script(self._interpreter, problem))
        return list(self._runs[-1].result["answers"][0])

    def steps_times_and_unknowns_of_all_runs(self) -> _GetfemCosts:
        """The number of Newton steps, the times and the number of unknowns of all runs so far."""
        steps, unknowns, rests = [0], [0], []
        for ran in self._runs:
            steps += map(itemgetter("steps"), ran.result["answers"][0])
            unknowns.append(ran.result["unknowns"])
            # A process repeats its solves. Its time without all solves is the time of its start,
            # which counts once.
            rests.append(ran.seconds - sum(map(sum, ran.result["seconds"])))
        seconds_of_first_solve = self._median_seconds_summed_over_all_runs(0)
        return _GetfemCosts(
            steps=max(steps),
            seconds_of_first_solve=seconds_of_first_solve,
            seconds_of_further_load_case=self._median_seconds_summed_over_all_runs(1),
            process=math.fsum(rests) + seconds_of_first_solve,
            unknowns=max(unknowns),
            version=self._runs[-1].result["version"] if self._runs else "",
        )

    def _median_seconds_summed_over_all_runs(self, case: int) -> float:
        """The time [s] of a load case: the median of the repeats, summed over all runs.

        `case` is 0 for the brake itself, and 1 for the second load case with less friction.
        """
        medians = []
        for ran in self._runs:
            medians.append(median(map(itemgetter(case), ran.result["seconds"])))
        return math.fsum(medians)


class GetfemShoeResult(NamedTuple):
    """GetFEM's result for one shoe.

    Attributes
    ----------
    response : response of the shoe
    balance : relative imbalance of GetFEM's forces on the shoe
    tip : displacement [m] of the point where the actuation force acts, along this force
    """

    response: ShoeResponse
    balance: ForceAndMomentImbalance
    tip: float


def _solve_shoes_and_return_results_by_name(
    brake: Brake, solver: _GetfemScriptRunner
) -> dict[str, GetfemShoeResult]:
    """Solve all shoes of a brake; returns their results by name.

    A shoe that pushes another shoe by a strut is solved before the other shoe.
    """
    pushed_by = {link.to: link.source for link in brake.links}
    answers: dict[str, GetfemShoeResult] = {}
    if brake.actuation is not None and brake.actuation.is_cam_or_wedge:
        refusal = reason_if_loads_besides_actuation_act(brake, "a cam in GetFEM")
        if refusal is not None:
            raise BadInput(refusal)
        both = {i: shoe for i, shoe in enumerate(brake.shoes) if shoe.name not in pushed_by}
        answers |= _find_cam_forces_and_return_shoe_results(
            brake.actuation.force_of_cylinder_or_sum_of_cam_forces, both, solver
        )
    # A shoe can be solved when its force is known: from the brake file, or as the support reaction
    # of the shoe that pushes it by a strut.
    while len(answers) < len(brake.shoes):
        ready = {}
        for i, shoe in enumerate(brake.shoes):
            if shoe.name in answers:
                continue
            source = pushed_by.get(shoe.name)
            if source is None:
                ready[i] = shoe
            elif source in answers:
                reaction = answers[source].response.hinge_reaction
                ready[i] = shoe.shoe_with_changed_actuation_force(float(np.hypot(*reaction)))
        answers |= _solve_shoes_trying_abutment_friction_senses(ready, solver)
    return answers


def _find_cam_forces_and_return_shoe_results(
    total: float, shoes: Mapping[int, Shoe], solver: _GetfemScriptRunner
) -> dict[str, GetfemShoeResult]:
    """Find the forces of a cam that moves the loaded ends of two shoes by the same displacement.

    Returns the results of the two shoes by name. If both linings fit the drum, the displacements
    are proportional to the forces, and the second trial is exact.

    Parameters
    ----------
    total : sum of the two forces of the cam [N]
    shoes : the two shoes, by their number in the brake
    solver : runner of the GetFEM script for the brake

    Raises
    ------
    NoAnswer
        if the cam does not press a shoe, or the forces do not converge
    """
    one, other = shoes
    # Each trial is a pair: the fraction of the total force that acts on the first shoe, and the
    # difference of the displacements of both loaded ends.
    tried: list[tuple[float, float]] = []
    part = 0.5
    for _ in range(MOST_CAM_FORCE_TRIALS):
        pushed = {
            one: shoes[one].shoe_with_changed_actuation_force(part * total),
            other: shoes[other].shoe_with_changed_actuation_force((1 - part) * total),
        }
        answers = _solve_shoes_trying_abutment_friction_senses(pushed, solver)
        a, b = (answers[shoe.name].tip for shoe in shoes.values())
        if not min(a, b) > 0:
            raise NoAnswer("GetFEM: a shoe is not pressed by the cam")
        if abs(a - b) <= LOADED_END_DISPLACEMENT_TOLERANCE * max(a, b):
            return {
                shoe.name: _result_with_actuation_force(answers[shoe.name], shoe)
                for shoe in pushed.values()
            }
        tried.append((part, a - b))
        if len(tried) == 1:
            # If each displacement is proportional to its force, both are equal at this fraction.
            part = part * b / (part * b + (1 - part) * a)
            continue
        # The secant method finds the next fraction. It goes at most half of the way to 0 or 1, so
        # that both shoes stay pressed.
        (x, f), (y, g) = tried[-2:]
        part = min(max(y - g * (y - x) / (g - f), 0.5 * y), 0.5 * (1 + y))
    raise NoAnswer(f"GetFEM: the cam's forces did not settle in {MOST_CAM_FORCE_TRIALS} steps")


def _result_with_actuation_force(answer: GetfemShoeResult, shoe: Shoe) -> GetfemShoeResult:
    """A copy of the result of a shoe that also holds the actuation force on this shoe."""
    return answer._replace(response=replace(answer.response, force=shoe.actuation.force))


def _solve_shoes_trying_abutment_friction_senses(
    shoes: Mapping[int, Shoe], solver: _GetfemScriptRunner
) -> dict[str, GetfemShoeResult]:
    """Solve some shoes; returns their results by name.

    The friction at an abutment may act in several senses, which are tried in turn. A sense is right
    if the abutment pushes the foot of the shoe, and if the friction on the foot opposes the slide
    of the foot or holds the foot. The keys of `shoes` are the numbers of the shoes in the brake.
    Raises NoAnswer if no sense is right.
    """
    answers: dict[str, GetfemShoeResult] = {}
    left = dict(shoes)
    # `left` has the shoes without a result. They are tried again with another sense of the friction
    # at the abutment.
    for attempt in range(
        max(len(shoe.senses_of_abutment_friction_to_try) for shoe in shoes.values())
    ):
        tried = {}
        for i, shoe in left.items():
            sense = shoe.senses_of_abutment_friction_to_try[attempt]
            tried[i] = meshed_shoe_with_actuation_and_support(
                solver.brake, shoe, solver.meshed[i], sense
            )
        # One process solves all shoes that are pressed on the drum.
        touching = [loaded for loaded in tried.values() if loaded.is_pressed_on_drum]
        found = iter(solver.run_getfem_script_for_shoes(touching) if touching else ())
        for i, loaded in tried.items():
            if loaded.is_pressed_on_drum:
                answer = _shoe_result_if_abutment_friction_sense_fits(
                    solver.brake, loaded, attempt, next(found)
                )
            else:
                answer = GetfemShoeResult(
                    *zero_response_and_imbalance_of_shoe_turned_from_drum(loaded), 0.0
                )
            if answer is not None:
                answers[loaded.shoe.name] = answer
                del left[i]
    return answers


def _shoe_result_if_abutment_friction_sense_fits(
    brake: Brake, loaded: MeshedShoeUnderActuation, attempt: int, found: dict[str, Any]
) -> GetfemShoeResult | None:
    """A shoe's result, or None if another sense of the friction at its abutment must be tried.

    The result is right if the abutment pushes the foot and the friction on the foot opposes its
    slide, or holds it.

    Parameters
    ----------
    brake : the brake
    loaded : the shoe under its actuation
    attempt : index of the tried sense in `Shoe.senses_of_abutment_friction_to_try`
    found : the script's result for the shoe

    Raises
    ------
    NoAnswer
        if the last sense gives no right result either
    """
    shoe = loaded.shoe
    is_last = attempt == len(shoe.senses_of_abutment_friction_to_try) - 1
    try:
        answer = _shoe_result_in_si_units(brake, loaded, found)
    except NoAnswer:
        if is_last:
            raise
        return None
    slide = found["amounts"][-1]
    if shoe.can_abutment_exert_reaction_on_shoe(
        answer.response.hinge_reaction, shoe.senses_of_abutment_friction_to_try[attempt], slide
    ):
        return answer
    if is_last:
        raise NoAnswer(f"shoe {shoe.name!r}: GetFEM: its foot leaves the abutment")
    return None


def _brake_data_for_getfem_script(
    brake: Brake, shoes: Sequence[MeshedShoeUnderActuation], formulation: str, repeats: int
) -> dict[str, Any]:
    """The input of the GetFEM script: arrays by name, and under "data" all other data as JSON text.

    The unit of length is the drum's radius, the unit of stress Young's modulus of the lining.

    Parameters
    ----------
    brake : the brake
    shoes : the shoes to solve
    formulation, repeats : the arguments of `solve_brake_in_getfem_process`
    """
    arrays: dict[str, Any] = {}
    for loaded in shoes:
        arrays |= _mesh_and_material_arrays(brake, loaded)
    data = {
        "shoes": [_shoe_data_for_getfem_script(brake, loaded) for loaded in shoes],
        "formulation": formulation,
        "repeats": repeats,
        "friction": [brake.friction, FRICTION_RATIO_OF_TIMED_LOAD_CASE * brake.friction],
    }
    return arrays | {"data": json.dumps(data)}


def _mesh_and_material_arrays(brake: Brake, loaded: MeshedShoeUnderActuation) -> dict[str, Any]:
    """The arrays of a shoe's mesh and elastic constants, by name.

    The names end in the number of the shoe's shape, since shoes of equal shape share the arrays.
    """
    shoe, k = loaded.shoe, loaded.body
    basis, mesh = loaded.parts.basis, loaded.parts.mesh
    E, width = shoe.lining.material.E_through, shoe.lining.width
    # `constants` (4, cells) are the elastic constants of each cell. `straight` (2, cells) is the
    # direction along the cell's layer, or 0 in a curved layer.
    constants, straight = np.zeros((4, mesh.nelements)), np.zeros((2, mesh.nelements))
    for name, elements in mesh.subdomains.items():
        layer = elastic_layers_of_shoe(shoe)[name]
        constants[:, elements] = (
            isotropic_and_orthotropic_elastic_constants(layer.elasticity_times_width)[:, None]
            / width
            / E
        )
        if layer.along is not None:
            straight[:, elements] = layer.along[:, None]
    arrays = {
        f"points{k}": basis.doflocs.T / brake.size,
        f"cells{k}": basis.element_dofs.T,
        f"constants{k}": constants,
        f"straight{k}": straight,
    }
    for name in ("contact", "hinge", "actuation"):
        if name in mesh.boundaries:
            arrays[f"{name}{k}"] = np.unique(
                nodes_along_element_edges(basis, mesh.boundaries[name])
            )
    return arrays


def _shoe_data_for_getfem_script(brake: Brake, loaded: MeshedShoeUnderActuation) -> dict[str, Any]:
    """The support, the load and the gap of a shoe, as plain numbers for the GetFEM script."""
    shoe, parts, R = loaded.shoe, loaded.parts, brake.size
    E, width = shoe.lining.material.E_through, shoe.lining.width
    line = parts.line
    modes = _rigid_body_modes_scaled_by_drum_radius(loaded, R)
    work = loaded.virtual_work_of_loads_on_rigid_holder / modes.test_sizes / (E * R**2 * width)
    gap = unloaded_lining_gaps_at_points(line.xy, line.phi, brake, shoe) / R
    open_by = (
        clearance.gaps_between_unloaded_lining_and_surface(
            brake, shoe, shoe.frame.surface_coordinates_of_phi(line.phi)
        )
        / R
    )
    return {
        "body": loaded.body,
        "side": shoe.sign_internal_plus_external_minus,
        "flat": shoe.is_on_plane,
        "pin": (shoe.pin_position_in_shoe_frame / R).tolist(),
        "motions": modes.motions.tolist(),
        "tests": modes.tests.tolist(),
        "work": work.tolist(),
        "on_body": loaded.does_actuation_act_on_body_end,
        "force": (loaded.force / (E * R * width)).tolist(),
        "couple": loaded.couple / (E * R**2 * width),
        "centre": (parts.application_point_of_actuation_loads / R).tolist(),
        "at_places": (loaded.at_places / (E * R * width)).tolist(),
        "drag_sense": math.copysign(brake.shoe_friction_over_brake_friction(shoe), loaded.drag),
        "middle": sum(shoe.arc) / 2,
        "phi": line.phi.tolist(),
        "gap": gap.tolist(),
        "clearance": open_by.tolist(),
        "augment": R / shoe.lining.thickness,
    }


class _ScaledRigidBodyAndTestModes(NamedTuple):
    """The rigid-body modes and test modes of a shoe, scaled to the norm 1.

    Displacements are divided by the drum's radius. On a test mode the support reactions do no work.

    Attributes
    ----------
    motions : rigid-body modes (k, 3): displacements along x and y, and rotation
    tests : test modes (k, 3), in the same form
    test_sizes : norms (k,) of the test modes before they were scaled
    """

    motions: Floats
    tests: Floats
    test_sizes: Floats


def _rigid_body_modes_scaled_by_drum_radius(
    loaded: MeshedShoeUnderActuation, R: float
) -> _ScaledRigidBodyAndTestModes:
    """Scale a shoe's modes to norm 1, with displacements divided by the drum's radius R [m]."""
    unit = np.array([R, R, 1.0])
    motion_sizes = np.linalg.norm(loaded.motions / unit, axis=1)
    test_sizes = np.linalg.norm(loaded.tests / unit, axis=1)
    return _ScaledRigidBodyAndTestModes(
        motions=loaded.motions / unit / motion_sizes[:, None],
        tests=loaded.tests / unit / test_sizes[:, None],
        test_sizes=test_sizes,
    )


def _run_getfem_script(interpreter: str, problem: dict[str, Any]) -> _GetfemScriptRun:
    """Run the GetFEM script on a problem. Raises NoAnswer if its process fails."""
    with tempfile.TemporaryDirectory(prefix="drumlin-getfem-") as name:
        folder = Path(name)
        source, target = folder / "problem.npz", folder / "result.json"
        np.savez(source, **problem)
        # Python first looks for modules beside the script. There `import getfem` would find this
        # module getfem.py in place of GetFEM, so that the script is copied into another folder.
        script = shutil.copy(PATH_OF_GETFEM_SCRIPT, folder)
        command = [interpreter, str(script), str(source), str(target)]
        ended = run_command_of_peer_program(command, folder, LONGEST_GETFEM_SECONDS)
        if ended.status or not target.is_file():
            reason = (ended.output.strip() or "nothing").splitlines()[-1]
            raise NoAnswer(f"GetFEM: its process ended with status {ended.status}: {reason[:200]}")
        return _GetfemScriptRun(json.loads(target.read_text()), ended.seconds)


def _shoe_result_in_si_units(
    brake: Brake, loaded: MeshedShoeUnderActuation, found: dict[str, Any]
) -> GetfemShoeResult:
    """The result of a shoe in SI units, from the numbers of the GetFEM script.

    Raises NoAnswer if the script did not converge, or if the lining sticks.
    """
    shoe, R = loaded.shoe, brake.size
    if not found["converged"]:
        raise NoAnswer(f"shoe {shoe.name!r}: GetFEM did not converge in {found['steps']} steps")
    if not abs(found["slipping"] - 1) < 1 - LEAST_SLIPPING_SHEAR_RATIO:
        raise NoAnswer(
            f"shoe {shoe.name!r}: GetFEM: it sticks, "
            f"its shear is {found['slipping']:.3g} times mu p"
        )
    E = shoe.lining.material.E_through
    phi = shoe.surface_coordinates_of_points_in_shoe_frame(np.array(found["xy"]), 1.0)
    order = np.argsort(phi)
    # The script's unit of force, in newtons.
    size = E * R * shoe.lining.width
    forces = ForcesOnShoeByPeer(
        normal=size * np.array(found["normal"]),
        friction=size * np.array(found["tangential"]),
        moment=size * R * found["moment"],
        held=size * np.array(found["hold"]) * [1, 1, R],
        torque=abs(found["torque"]) * size * brake.length_per_surface_coordinate,
    )
    # The script scales each rigid-body mode to the norm 1, with displacements divided by the drum's
    # radius. Its coordinates are therefore divided by the norms of the modes before scaling.
    mode_sizes = np.linalg.norm(loaded.motions / [R, R, 1.0], axis=1)
    amounts = np.array(found["amounts"]) / mode_sizes
    pressure = E * np.array(found["pressure"])[order]
    degree = loaded.parts.line.interpolation_degree_along_contact_line
    answer = shoe_response_and_imbalance_from_peer_forces(
        loaded, phi[order], pressure, degree, forces, amounts
    )
    tip = float(loaded.tip @ amounts)
    if loaded.does_actuation_act_on_body_end:
        tip = size * R * found["load_work"] / (abs(shoe.actuation.force) or 1.0)
    return GetfemShoeResult(*answer, tip)
