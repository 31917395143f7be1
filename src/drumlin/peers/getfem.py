"""GetFEM as a peer: the brake goes to a script as numbers, another Python runs it, its answer comes back.

The script, getfem_brake.py beside this module, needs a Python that imports getfem (a Debian package, for the
system's Python) and nothing of drumlin. Lengths go in drum radii, stresses in moduli of the lining.
"""

import functools
import json
import math
import shutil
import subprocess
import tempfile
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from drumlin.arrays import Floats
from drumlin.brake.drum_brake import Brake
from drumlin.errors import BadInput, NoAnswer
from drumlin.fem.assembly import ELEMENTS, Mesher, materials_of
from drumlin.fem.group import gap_at
from drumlin.fem.interface import edge_nodes
from drumlin.fem.mesh.arc import DEFAULT_KIND
from drumlin.fem.model import LARGEST_IMBALANCE
from drumlin.peers.peer import (
    Forces,
    Loaded,
    Peer,
    PeerMissing,
    brake_response,
    loaded_shoes,
    run_process,
    shoe_response,
    untouched_response,
)
from drumlin.response.response import Balance, ShoeResponse
from drumlin.response.resultants import angle_near

SCRIPT = Path(__file__).with_name("getfem_brake.py")
INSTALL = "GetFEM is not installed; on Debian and Ubuntu: apt install python3-getfem++"
FORMULATIONS = ("full slip", "coulomb")
FURTHER = 0.9  # of the friction coefficient, in the further load case
SLIPPING = 0.99  # of mu p: less shear in all is not full slip
LONGEST = 1800  # s


@functools.cache
def python() -> str:
    """A Python that imports getfem: `python3` on the PATH, or the system's. Raises PeerMissing."""
    for name in ("python3", "/usr/bin/python3"):
        path = shutil.which(name)
        if path and not subprocess.run([path, "-c", "import getfem"], capture_output=True, check=False).returncode:
            return path
    raise PeerMissing(INSTALL)


def solve(
    brake: Brake,
    *,
    elements: int = ELEMENTS,
    kind: str = DEFAULT_KIND,
    mesher: Mesher | None = None,
    formulation: str = "full slip",
    repeats: int = 1,
) -> Peer:
    """A brake by GetFEM on drumlin's mesh: `formulation` "full slip" or "coulomb" (its own brick of contact).

    Seconds are medians of `repeats` solves from the beginning in one process. Raises PeerMissing, BadInput for a brake
    with a ring or without friction, NoAnswer where it does not converge.
    """
    if formulation not in FORMULATIONS:
        raise BadInput(f"formulation = {formulation!r}: unknown; allowed: {', '.join(FORMULATIONS)}")
    interpreter = python()
    shoes = loaded_shoes(brake, elements, kind, mesher)
    touching = [loaded for loaded in shoes if loaded.approaches]
    result, spent = _run(interpreter, _problem(brake, touching, formulation, repeats))
    found = iter(result["answers"][0])
    answers = [_answer(brake, loaded, next(found)) if loaded.approaches else untouched_response(loaded)
               for loaded in shoes]  # fmt: skip
    steps = max((answer["steps"] for answer in result["answers"][0]), default=0)
    cold, warm = (median(run[k] for run in result["seconds"]) for k in (0, 1))
    once = spent - sum(map(sum, result["seconds"])) + cold  # the process of one solve, without the others in it
    response = brake_response("getfem", answers, steps, {"getfem": cold})
    if not max(response.balance.force, response.balance.moment) < LARGEST_IMBALANCE:
        raise NoAnswer(f"GetFEM: forces balance only to {response.balance.force:.1e}, "
                       f"moments to {response.balance.moment:.1e}")  # fmt: skip
    notes = (f"GetFEM {result['version']}, {formulation}, {steps} Newton steps, MUMPS",)
    return Peer("getfem", result["version"], response, cold, once, warm, result["unknowns"], notes)


def _problem(brake: Brake, shoes: list[Loaded], formulation: str, repeats: int) -> dict[str, Any]:
    """Everything that the script needs, as arrays; lengths in drum radii, stresses in moduli of the lining."""
    R = brake.drum.radius
    arrays: dict[str, Any] = {}
    listed = []
    for loaded in shoes:
        shoe, parts, k = loaded.shoe, loaded.parts, loaded.body
        lining, E = shoe.lining, shoe.lining.material.E
        basis, mesh = parts.basis, parts.mesh
        nodes = {name: np.unique(edge_nodes(basis, facets)) for name, facets in mesh.boundaries.items()}
        lame = np.zeros((2, mesh.nelements))
        for name, elements in mesh.subdomains.items():
            material, width = materials_of(shoe)[name]
            G = material.E / (2 * (1 + material.nu))  # plane stress: lambda* = 2 G nu / (1 - nu)
            lame[:, elements] = np.array([[2 * G * material.nu / (1 - material.nu)], [G]]) * width / lining.width / E
        arrays |= {f"points{k}": basis.doflocs.T / R, f"cells{k}": basis.element_dofs.T, f"lame{k}": lame}
        arrays |= {f"{name}{k}": nodes[name] for name in ("contact", "hinge", "actuation") if name in nodes}
        force, couple = loaded.force / (E * R * lining.width), loaded.couple / (E * R**2 * lining.width)
        listed.append({
            "body": k, "side": shoe.sign, "pin": (shoe.own_pin / R).tolist(),
            "force": force.tolist(), "couple": couple, "centre": (parts.load_centre / R).tolist(),
            "drag_sense": math.copysign(1.0, loaded.drag), "middle": sum(shoe.arc) / 2,
            "phi": parts.line.phi.tolist(),
            "gap": (gap_at(parts.line.xy, parts.line.phi, brake, shoe) / R).tolist(),
            "clearance": (lining.clearance_at(shoe.frame.theta(parts.line.phi)) / R).tolist(),
            "augment": R / lining.thickness,
        })  # fmt: skip
    data = {"shoes": listed, "formulation": formulation, "repeats": repeats,
            "friction": [brake.friction, FURTHER * brake.friction]}  # fmt: skip
    return arrays | {"data": json.dumps(data)}


def _run(interpreter: str, problem: dict[str, Any]) -> tuple[dict[str, Any], float]:
    """The script's result, and the seconds of its whole process."""
    with tempfile.TemporaryDirectory(prefix="drumlin-getfem-") as folder:
        source, target = Path(folder) / "problem.npz", Path(folder) / "result.json"
        np.savez(source, **problem)
        script = shutil.copy(SCRIPT, folder)  # beside this module `import getfem` would find this module
        ended = run_process([interpreter, str(script), str(source), str(target)], Path(folder), LONGEST)
        if ended.status or not target.is_file():
            said = (ended.output.strip() or "nothing").splitlines()[-1]
            raise NoAnswer(f"GetFEM: its process ended with status {ended.status}: {said[:200]}")
        return json.loads(target.read_text()), ended.seconds


def _answer(brake: Brake, loaded: Loaded, found: dict[str, Any]) -> tuple[ShoeResponse, Balance]:
    """A shoe's response from the script's numbers."""
    shoe, R = loaded.shoe, brake.drum.radius
    if not found["converged"]:
        raise NoAnswer(f"shoe {shoe.name!r}: GetFEM did not converge in {found['steps']} steps")
    if not abs(found["slipping"] - 1) < 1 - SLIPPING:
        raise NoAnswer(f"shoe {shoe.name!r}: GetFEM: it sticks, its shear is {found['slipping']:.3g} times mu p")
    E, b = shoe.lining.material.E, shoe.lining.width
    x, y = np.array(found["xy"])
    middle = sum(shoe.arc) / 2
    phi = angle_near(middle, np.array([x, y]))
    order = np.argsort(phi)
    size = E * R * b

    def force(name: str) -> Floats:
        return size * np.array(found[name])

    held = force("hold") - (0 if "actuation" in loaded.parts.mesh.boundaries else loaded.force)
    torque = abs(found["torque"]) * size * R
    forces = Forces(force("normal"), force("tangential"), held, torque)
    pressure = E * np.array(found["pressure"])[order]
    return shoe_response(loaded, phi[order], pressure, loaded.parts.line.order, forces, found["turn"])
