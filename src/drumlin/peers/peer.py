"""What a peer answers, whichever it is, and what all of them need: shoes in their own frames,
responses.
"""

import math
import os
import resource
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.fem.equilibrium.modes import at_pin
from drumlin.fem.mesh.arc import DEFAULT_KIND, shoe_mesh
from drumlin.fem.preparation.bodies import actuation
from drumlin.fem.preparation.cache import shape_of
from drumlin.fem.preparation.meshes import ELEMENTS, Assembled, Mesher, assemble
from drumlin.fem.substructure.loads import ACTUATION
from drumlin.laws import rigid
from drumlin.response.balance import relative_balance, worst
from drumlin.response.response import Balance, Response, ShoeResponse, pressed_shoe, untouched
from drumlin.response.resultants import contact_arcs, cross

NOTHING = 1e-3  # of the peak pressure: what a peer leaves where its lining does not touch


class PeerMissing(BadInput):
    """A peer is not installed; the line says how to install it."""


class Peer(NamedTuple):
    """A peer's answer for a brake, and what it took, in seconds of processor time on one thread.

    `seconds`: its own computing, without the start of its process where it can be told apart;
    `process_seconds`: the whole process or processes, of one solve; `further_seconds`: a further
    load case, another friction coefficient, reusing what the peer can reuse. `unknowns`: of all its
    systems, equal shoes counted once where they share one.
    """

    name: str
    version: str
    response: Response
    seconds: float
    process_seconds: float
    further_seconds: float
    unknowns: int
    notes: tuple[str, ...]


@dataclass(frozen=True)
class Loaded:
    """A meshed shoe under its force, in its own frame: `force` (2,) [N] and `couple` [N m] about
    `parts.load_centre`.

    `drag`: mu times the sense in which the drum drags the lining, positive towards growing phi.
    `approaches`: whether the force presses the shoe on the drum anywhere; else it does not touch.
    What holds it moves by a sum of `motions` (k, 3), (dx, dy [m], turn) at the pin; on the `tests`
    (k, 3) the force works `work` (k,), its point goes along it by `tip` (k,) a motion, see
    `Held.freedoms`.
    """

    shoe: Shoe
    parts: Assembled
    body: int
    force: Floats
    couple: float
    drag: float
    approaches: bool
    motions: Floats
    tests: Floats
    work: Floats
    tip: Floats

    @property
    def on_body(self) -> bool:
        """Whether the force acts on the body's loaded end, not on what holds it."""
        return "actuation" in self.parts.mesh.boundaries and not self.shoe.gripped

    @property
    def radius(self) -> float:
        """The mean one of its lining's face [m]; on a plane what a length along it makes an angle
        by.
        """
        line = self.parts.line
        return float(
            np.ptp(line.xy[0]) / np.ptp(line.phi) if self.shoe.flat else np.hypot(*line.xy).mean()
        )


def meshed_shoes(
    brake: Brake, elements: int = ELEMENTS, kind: str = DEFAULT_KIND, mesher: Mesher | None = None
) -> list[tuple[int, Assembled]]:
    """The shoes of a brake as drumlin meshes them, with a number for each distinct shape.

    Raises BadInput for a brake with an elastic ring and without friction: peers get a rigid drum
    that slips.
    """
    if brake.ring is not None:
        raise BadInput("drum.ring: the peers get a rigid drum; leave out [drum.ring]")
    if brake.friction == 0:
        raise BadInput(
            "friction = 0: the peers are given a drum that slips; must be greater than 0"
        )
    mesher = mesher or partial(shoe_mesh, elements=elements, kind=kind)
    made: dict[tuple[object, ...], tuple[int, Assembled]] = {}
    found = []
    for shoe in brake.shoes:
        key = shape_of(brake, shoe)
        if key not in made:
            made[key] = (len(made), assemble(brake, shoe, mesher, {}))
        found.append(made[key])
    return found


def under_force(brake: Brake, shoe: Shoe, body: int, parts: Assembled, sense: int = 1) -> Loaded:
    """A meshed shoe under its actuation; sense: of an abutment's friction, see `Held.freedoms`."""
    factors, moment = actuation(parts, shoe)
    load = parts.columns.part(ACTUATION, factors)
    size, free = abs(shoe.actuation.force), shoe.freedoms(sense)
    if shoe.held_by == "hinge" and not shoe.flat:
        # The lining at (x, y) closes by -sign a y/r per turn about the pin at (a, 0).
        approaches = size > 0 and bool((-moment * shoe.sign * parts.line.xy[1] > 0).any())
    else:
        approaches = size > 0 and rigid.bears(brake, shoe) >= 0
    return Loaded(
        shoe, parts, body, size * load[:2], size * float(load[2]), brake.drag_on(shoe), approaches,
        at_pin(shoe, free.motions).T, at_pin(shoe, free.tests).T, free.work, free.tip,
    )  # fmt: skip


def loaded_shoes(
    brake: Brake, elements: int = ELEMENTS, kind: str = DEFAULT_KIND, mesher: Mesher | None = None
) -> list[Loaded]:
    """The shoes of a brake, meshed as drumlin meshes them, under forces of their own on hinges.

    Raises BadInput for others, and as `meshed_shoes`.
    """
    if brake.surface.straight:
        raise BadInput("CalculiX takes brakes on a drum: its shoes press on a plane")
    brake.check_hinged("CalculiX")
    meshed = meshed_shoes(brake, elements, kind, mesher)
    return [under_force(brake, shoe, *own) for shoe, own in zip(brake.shoes, meshed, strict=True)]


class Forces(NamedTuple):
    """What a peer found on one shoe, in the shoe's frame: forces of pressure and of friction (2,)
    [N] and the moment of both about the origin [N m]; `held` (3,): force and moment about the pin
    of what holds the shoe, on the shoe; the `torque` on the drum [N m], positive, on a plane the
    braking force [N].
    """

    normal: Floats
    friction: Floats
    moment: float
    held: Floats
    torque: float


def shoe_response(
    loaded: Loaded, phi: Floats, pressure: Floats, order: int, forces: Forces, amounts: Floats
) -> tuple[ShoeResponse, Balance]:
    """A shoe's response from a peer's pressure [Pa] at growing angles phi [rad], piecewise of
    degree `order`.

    amounts (k,): of its free motions. The balance is that of the peer's own forces on the shoe,
    their sum and their moment about the origin, and of those on what holds it, whose work on the
    free motions is that of its loads.
    """
    shoe, frame, pin, tests = loaded.shoe, loaded.shoe.frame, loaded.shoe.own_pin, loaded.tests
    arm = loaded.parts.load_centre - pin
    load = np.array(
        [*loaded.force, loaded.couple + float(cross(arm, loaded.force))]
    )  # about the pin
    push, reaction = (load, forces.held) if loaded.on_body else (np.zeros(3), forces.held - load)
    normal_force = float(np.linalg.norm(forces.normal))
    about = [float(cross(pin, of[:2])) for of in (forces.held, push)] + [
        float(forces.held[2]),
        float(push[2]),
    ]
    size = loaded.radius * normal_force
    balance = relative_balance(
        [forces.normal, forces.friction, forces.held[:2], push[:2]],
        [forces.moment, *about, size, -size],
    )
    work = loaded.work * (not loaded.on_body)
    left = np.abs(tests @ forces.held - work) / (
        np.hypot(*tests.T[:2]) + loaded.radius * np.abs(tests[:, 2])
    )
    drag = np.array([*forces.friction, -float(cross(pin, forces.friction))])
    if not shoe.flat:
        drag[2] += math.copysign(forces.torque, loaded.drag)
    response = pressed_shoe(
        shoe,
        loaded.radius / frame.unit,
        frame.theta(phi),
        pressure,
        order=order,
        torque=forces.torque,
        normal_force=normal_force,
        self_energising=float(tests[0] @ drag) * float(loaded.work[0]) > 0,
        hinge_reaction=frame.to_brake(reaction[:2]),
        turn=frame.sense * float(amounts @ loaded.motions[:, 2]),
        pivot_reaction=frame.to_brake(forces.held[:2]) if shoe.pivot is not None else None,
        reaction_moment=frame.sense * float(reaction[2]) if shoe.guide is not None else 0.0,
        located=False,  # what a peer leaves beside the contact has no ends to find
    )
    p = response.pressure
    arcs = contact_arcs(response.theta, np.where(p > NOTHING * p.max(), p, 0.0), order)
    return replace(response, contact_arcs=arcs), Balance(
        balance.force, max(balance.moment, float(left.max()) / normal_force)
    )


def untouched_response(loaded: Loaded) -> tuple[ShoeResponse, Balance]:
    """The response of a shoe that its force turns away from the drum."""
    return untouched(loaded.shoe, -loaded.shoe.actuation.vector), Balance(0.0, 0.0)


class Ended(NamedTuple):
    """How a process ended: status, what it printed, and its processor time [s]."""

    status: int
    output: str
    seconds: float


def run_process(command: Sequence[str], folder: Path, longest: float) -> Ended:
    """Run a peer in a folder, on one thread, away from this Python's paths. Raises NoAnswer after
    `longest` seconds.
    """
    outside = {
        key: value for key, value in os.environ.items() if key not in {"PYTHONPATH", "PYTHONHOME"}
    }
    threads = dict.fromkeys(
        ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "CCX_NPROC_EQUATION_SOLVER"), "1"
    )
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        done = subprocess.run(
            command, env=outside | threads, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            errors="replace", timeout=longest, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired as error:
        raise NoAnswer(f"{command[0]}: still running after {longest:g} s") from error
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Ended(done.returncode, done.stdout, spent)


def brake_response(
    model: str,
    answers: Sequence[tuple[ShoeResponse, Balance]],
    iterations: int,
    seconds: dict[str, float],
) -> Response:
    """The response of the whole brake."""
    return Response(
        model=model,
        shoes=tuple(response for response, _ in answers),
        balance=worst([balance for _, balance in answers]),
        iterations=iterations,
        seconds=seconds,
    )
