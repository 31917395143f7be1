"""GetFEM as a peer: the brake goes to a script as numbers, another Python runs it, its answer comes
back.

The script, getfem_brake.py beside this module, needs a Python that imports getfem (a Debian
package, for the system's Python) and nothing of drumlin. Lengths go in drum radii, stresses in
moduli of the lining.
"""

import functools
import json
import math
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.fem.equilibrium.state import gap_at
from drumlin.fem.mesh.arc import DEFAULT_KIND
from drumlin.fem.mesh.edges import edge_nodes
from drumlin.fem.model import LARGEST_ANSWER_IMBALANCE
from drumlin.fem.preparation.meshes import ELEMENTS, Assembled, Mesher
from drumlin.fem.substructure.elasticity import layers_of, split
from drumlin.peers.peer import (
    Forces,
    Loaded,
    Peer,
    PeerMissing,
    brake_response,
    meshed_shoes,
    run_process,
    shoe_response,
    under_force,
    untouched_response,
)
from drumlin.response.response import Balance, ShoeResponse

SCRIPT = Path(__file__).with_name("getfem_brake.py")
INSTALL = "GetFEM is not installed; on Debian and Ubuntu: apt install python3-getfem++"
FORMULATIONS = ("full slip", "coulomb")
FURTHER = 0.9  # of the friction coefficient, in the further load case
SLIPPING = 0.99  # of mu p: less shear in all is not full slip
LONGEST = 1800  # s
ALIKE = 1e-10  # relative: two tips go the same way
MOST_PARTS = 12  # of the cam's force that are tried


@functools.cache
def python() -> str:
    """A Python that imports getfem: `python3` on the PATH, or the system's. Raises PeerMissing."""
    for name in ("python3", "/usr/bin/python3"):
        path = shutil.which(name)
        if (
            path
            and not subprocess.run(
                [path, "-c", "import getfem"], capture_output=True, check=False
            ).returncode
        ):
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
    """A brake by GetFEM on drumlin's mesh: `formulation` "full slip" or "coulomb" (its own brick of
    contact).

    Seconds are medians of `repeats` solves from the beginning in one process. Raises PeerMissing,
    BadInput for a brake with a ring or without friction, NoAnswer where it does not converge.
    """
    if formulation not in FORMULATIONS:
        raise BadInput(
            f"formulation = {formulation!r}: unknown; allowed: {', '.join(FORMULATIONS)}"
        )
    interpreter = python()
    meshed = meshed_shoes(brake, elements, kind, mesher)
    runs: list[_Run] = []

    def run(shoes: list[Loaded]) -> list[dict[str, Any]]:
        runs.append(_run(interpreter, _problem(brake, shoes, formulation, repeats)))
        return list(runs[-1].result["answers"][0])

    pushed = {link.to: link.source for link in brake.links}
    answers: dict[str, Stood] = {}
    if brake.actuation is not None and brake.actuation.is_cam:
        both = {i: shoe for i, shoe in enumerate(brake.shoes) if shoe.name not in pushed}
        answers |= _under_cam(
            brake.actuation.total, both, lambda shoes: _standing(brake, shoes, meshed, run)
        )
    while len(answers) < len(brake.shoes):  # along chains of struts, shoe by shoe
        ready = {}
        for i, shoe in enumerate(brake.shoes):
            if shoe.name in answers or pushed.get(shoe.name, shoe.name) not in {
                *answers,
                shoe.name,
            }:
                continue
            strut = pushed.get(shoe.name)
            force = (
                None if strut is None else float(np.hypot(*answers[strut].response.hinge_reaction))
            )
            ready[i] = shoe if force is None else shoe.under(force)
        answers |= _standing(brake, ready, meshed, run)
    each = [(answers[shoe.name].response, answers[shoe.name].balance) for shoe in brake.shoes]
    steps = max((answer["steps"] for ran in runs for answer in ran.result["answers"][0]), default=0)
    cold, warm = (
        math.fsum(median(times[k] for times in ran.result["seconds"]) for ran in runs)
        for k in (0, 1)
    )
    spent = math.fsum(ran.seconds - sum(map(sum, ran.result["seconds"])) for ran in runs)
    once = spent + cold  # the process of one solve, without the others in it
    response = brake_response("getfem", each, steps, {"getfem": cold})
    if not max(response.balance.force, response.balance.moment) < LARGEST_ANSWER_IMBALANCE:
        raise NoAnswer(f"GetFEM: forces balance only to {response.balance.force:.1e}, "
                       f"moments to {response.balance.moment:.1e}")  # fmt: skip
    version = runs[-1].result["version"] if runs else ""
    notes = (f"GetFEM {version}, {formulation}, {steps} Newton steps, MUMPS",)
    unknowns = max((ran.result["unknowns"] for ran in runs), default=0)
    return Peer("getfem", version, response, cold, once, warm, unknowns, notes)


class _Run(NamedTuple):
    """The script's result, and the seconds of its whole process."""

    result: dict[str, Any]
    seconds: float


class Stood(NamedTuple):
    """A shoe's answer, and how far the point of its force goes along it [m]."""

    response: ShoeResponse
    balance: Balance
    tip: float


def _under_cam(
    total: float, shoes: Mapping[int, Shoe], stood: Callable[[Mapping[int, Shoe]], dict[str, Stood]]
) -> dict[str, Stood]:
    """The answers of two shoes whose tips a cam moves alike by forces of the sum `total` [N], by
    name.

    Where linings fit the tips go in proportion to the forces, and the first step is the last.
    Raises NoAnswer.
    """
    one, other = shoes
    tried: list[
        tuple[float, float]
    ] = []  # the part of the one, and by how much farther its tip goes
    part = 0.5
    for _ in range(MOST_PARTS):
        pushed = {
            one: shoes[one].under(part * total),
            other: shoes[other].under((1 - part) * total),
        }
        found = stood(pushed)
        a, b = (found[shoe.name].tip for shoe in shoes.values())
        if not min(a, b) > 0:
            raise NoAnswer("GetFEM: a shoe is not pressed by the cam")
        if abs(a - b) <= ALIKE * max(a, b):
            return {
                shoe.name: found[shoe.name]._replace(
                    response=replace(found[shoe.name].response, force=shoe.actuation.force)
                )
                for shoe in pushed.values()
            }
        tried.append((part, a - b))
        if len(tried) == 1:
            part = part * b / (part * b + (1 - part) * a)
            continue
        (x, f), (y, g) = tried[-2:]
        part = min(max(y - g * (y - x) / (g - f), 0.5 * y), 0.5 * (1 + y))
    raise NoAnswer(f"GetFEM: the cam's forces did not settle in {MOST_PARTS} steps")


def _standing(
    brake: Brake,
    shoes: Mapping[int, Shoe],
    meshed: list[tuple[int, Assembled]],
    run: Callable[[list[Loaded]], list[dict[str, Any]]],
) -> dict[str, Stood]:
    """The shoes' answers by name, with the friction of abutments in the sense in which it stands.
    Raises NoAnswer.
    """
    answers = {}
    left = dict(shoes)
    for attempt in range(max(len(shoe.senses) for shoe in shoes.values())):
        tried = [
            under_force(brake, shoe, *meshed[i], shoe.senses[attempt]) for i, shoe in left.items()
        ]
        touching = [loaded for loaded in tried if loaded.approaches]
        found = iter(run(touching) if touching else ())
        for i, loaded in zip(list(left), tried, strict=True):
            if not loaded.approaches:
                answers[loaded.shoe.name] = Stood(*untouched_response(loaded), 0.0)
                del left[i]
                continue
            own, last = next(found), attempt == len(loaded.shoe.senses) - 1
            try:
                answer = _answer(brake, loaded, own)
            except NoAnswer:
                if last:
                    raise
                continue
            slide = own["amounts"][-1]
            if loaded.shoe.stands(
                answer.response.hinge_reaction, loaded.shoe.senses[attempt], slide
            ):
                answers[loaded.shoe.name] = answer
                del left[i]
            elif last:
                raise NoAnswer(f"shoe {loaded.shoe.name!r}: GetFEM: its foot leaves the abutment")
    return answers


def _problem(brake: Brake, shoes: list[Loaded], formulation: str, repeats: int) -> dict[str, Any]:
    """Everything that the script needs, as arrays; lengths in drum radii, stresses in moduli of the
    lining.
    """
    R = brake.size
    arrays: dict[str, Any] = {}
    listed = []
    for loaded in shoes:
        shoe, parts, k = loaded.shoe, loaded.parts, loaded.body
        lining, E = shoe.lining, shoe.lining.material.E_through
        basis, mesh = parts.basis, parts.mesh
        nodes = {
            name: np.unique(edge_nodes(basis, facets)) for name, facets in mesh.boundaries.items()
        }
        constants, straight = np.zeros((4, mesh.nelements)), np.zeros((2, mesh.nelements))
        for name, elements in mesh.subdomains.items():
            layer = layers_of(shoe)[name]
            constants[:, elements] = split(layer.stiffness)[:, None] / lining.width / E
            if layer.along is not None:
                straight[:, elements] = layer.along[:, None]
        arrays |= {f"points{k}": basis.doflocs.T / R, f"cells{k}": basis.element_dofs.T}
        arrays |= {f"constants{k}": constants, f"straight{k}": straight}
        arrays |= {
            f"{name}{k}": nodes[name] for name in ("contact", "hinge", "actuation") if name in nodes
        }
        force, couple = (
            loaded.force / (E * R * lining.width),
            loaded.couple / (E * R**2 * lining.width),
        )
        motions, tests, sizes = _in_radii(loaded, R)
        work = loaded.work * (not loaded.on_body) / sizes / (E * R**2 * lining.width)
        listed.append({
            "body": k, "side": shoe.sign, "flat": shoe.flat, "pin": (shoe.own_pin / R).tolist(),
            "motions": motions.tolist(), "tests": tests.tolist(), "work": work.tolist(), "on_body": loaded.on_body,
            "force": force.tolist(), "couple": couple, "centre": (parts.load_centre / R).tolist(),
            "drag_sense": math.copysign(1.0, loaded.drag), "middle": sum(shoe.arc) / 2,
            "phi": parts.line.phi.tolist(),
            "gap": (gap_at(parts.line.xy, parts.line.phi, brake, shoe) / R).tolist(),
            "clearance": (clearance.gap(brake, shoe, shoe.frame.theta(parts.line.phi)) / R).tolist(),
            "augment": R / lining.thickness,
        })  # fmt: skip
    data = {"shoes": listed, "formulation": formulation, "repeats": repeats,
            "friction": [brake.friction, FURTHER * brake.friction]}  # fmt: skip
    return arrays | {"data": json.dumps(data)}


def _in_radii(loaded: Loaded, R: float) -> tuple[Floats, Floats, Floats]:
    """Motions and tests (k, 3) of a shoe, in drum radii and of size 1, and the sizes (k,) of the
    tests.
    """
    unit = np.array([R, R, 1.0])
    sizes = [np.linalg.norm(of / unit, axis=1) for of in (loaded.motions, loaded.tests)]
    return (
        loaded.motions / unit / sizes[0][:, None],
        loaded.tests / unit / sizes[1][:, None],
        sizes[1],
    )


def _run(interpreter: str, problem: dict[str, Any]) -> _Run:
    """Run the script."""
    with tempfile.TemporaryDirectory(prefix="drumlin-getfem-") as folder:
        source, target = Path(folder) / "problem.npz", Path(folder) / "result.json"
        np.savez(source, **problem)
        script = shutil.copy(
            SCRIPT, folder
        )  # beside this module `import getfem` would find this module
        ended = run_process(
            [interpreter, str(script), str(source), str(target)], Path(folder), LONGEST
        )
        if ended.status or not target.is_file():
            said = (ended.output.strip() or "nothing").splitlines()[-1]
            raise NoAnswer(f"GetFEM: its process ended with status {ended.status}: {said[:200]}")
        return _Run(json.loads(target.read_text()), ended.seconds)


def _answer(brake: Brake, loaded: Loaded, found: dict[str, Any]) -> Stood:
    """A shoe's answer from the script's numbers."""
    shoe, R = loaded.shoe, brake.size
    if not found["converged"]:
        raise NoAnswer(f"shoe {shoe.name!r}: GetFEM did not converge in {found['steps']} steps")
    if not abs(found["slipping"] - 1) < 1 - SLIPPING:
        raise NoAnswer(
            f"shoe {shoe.name!r}: GetFEM: it sticks, its shear is {found['slipping']:.3g} times mu p"
        )
    E, b = shoe.lining.material.E_through, shoe.lining.width
    xy = np.array(found["xy"])
    phi = shoe.phi_of(xy, 1.0)
    order = np.argsort(phi)
    size = E * R * b
    torque = abs(found["torque"]) * size * brake.scale_factor
    forces = Forces(
        size * np.array(found["normal"]),
        size * np.array(found["tangential"]),
        size * R * found["moment"],
        size * np.array(found["hold"]) * [1, 1, R],
        torque,
    )
    unit = np.linalg.norm(loaded.motions / [R, R, 1.0], axis=1)
    pressure = E * np.array(found["pressure"])[order]
    amounts = np.array(found["amounts"]) / unit
    own = shoe_response(loaded, phi[order], pressure, loaded.parts.line.order, forces, amounts)
    tip = (
        size * R * found["load_work"] / abs(shoe.actuation.force)
        if loaded.on_body
        else float(loaded.tip @ amounts)
    )
    return Stood(*own, tip)
