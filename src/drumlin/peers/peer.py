"""What a peer answers, whichever it is, and what all of them need: shoes in their own frames, responses."""

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

from drumlin.arrays import Floats
from drumlin.brake.drum_brake import Brake, Shoe
from drumlin.errors import BadInput, NoAnswer
from drumlin.fem.assembly import ELEMENTS, Assembled, Mesher, actuation, assemble, shape_of
from drumlin.fem.mesh.arc import DEFAULT_KIND, shoe_mesh
from drumlin.response.balance import relative_balance, worst
from drumlin.response.response import Balance, Response, ShoeResponse, pressed_shoe, untouched
from drumlin.response.resultants import contact_arcs, cross

NOTHING = 1e-3  # of the peak pressure: what a peer leaves where its lining does not touch


class PeerMissing(BadInput):
    """A peer is not installed; the line says how to install it."""


class Peer(NamedTuple):
    """A peer's answer for a brake, and what it took, in seconds of processor time on one thread.

    `seconds`: its own computing, without the start of its process where it can be told apart; `process_seconds`: the
    whole process or processes, of one solve; `further_seconds`: a further load case, another friction coefficient,
    reusing what the peer can reuse. `unknowns`: of all its systems, equal shoes counted once where they share one.
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
    """A meshed shoe under its force, in its own frame: `force` (2,) [N] and `couple` [N m] about `parts.load_centre`.

    `drag`: mu times the sense in which the drum drags the lining, positive towards growing phi. `approaches`: whether
    the force turns the shoe towards the drum anywhere; else it does not touch.
    """

    shoe: Shoe
    parts: Assembled
    body: int
    force: Floats
    couple: float
    drag: float
    approaches: bool


def loaded_shoes(
    brake: Brake, elements: int = ELEMENTS, kind: str = DEFAULT_KIND, mesher: Mesher | None = None
) -> list[Loaded]:
    """The shoes of a brake, meshed as drumlin meshes them; `body` numbers the distinct shapes.

    Raises BadInput for a brake with an elastic ring: both peers get a rigid drum.
    """
    brake.check_hinged("a peer")
    if brake.drum.ring is not None:
        raise BadInput("drum.ring: the peers get a rigid drum; leave out [drum.ring]")
    if brake.friction == 0:
        raise BadInput("friction = 0: the peers are given a drum that slips; must be greater than 0")
    mesher = mesher or partial(shoe_mesh, elements=elements, kind=kind)
    made: dict[tuple[object, ...], tuple[int, Assembled]] = {}
    shoes = []
    for shoe in brake.shoes:
        key = shape_of(brake, shoe)
        if key not in made:
            made[key] = (len(made), assemble(brake, shoe, mesher, {}))
        number, parts = made[key]
        load, moment = actuation(parts, shoe)
        size = abs(shoe.actuation.force)
        drag = brake.drag_on(shoe)
        # The lining at (x, y) closes by -sign a y/r per turn about the pin at (a, 0).
        approaches = size > 0 and bool((-moment * shoe.sign * parts.line.xy[1] > 0).any())
        shoes.append(Loaded(shoe, parts, number, size * load[:2], size * float(load[2]), drag, approaches))
    return shoes


class Forces(NamedTuple):
    """What a peer found on one shoe, in the shoe's frame: forces of pressure, of friction and of the pin (2,) [N], and
    the torque on the drum [N m], positive."""

    normal: Floats
    friction: Floats
    reaction: Floats
    torque: float


def shoe_response(
    loaded: Loaded, phi: Floats, pressure: Floats, order: int, forces: Forces, turn: float | None
) -> tuple[ShoeResponse, Balance]:
    """A shoe's response from a peer's pressure [Pa] at growing angles phi [rad], piecewise of degree `order`.

    The balance is that of the peer's own forces: their sum, and their moment about the drum's centre.
    """
    shoe, frame = loaded.shoe, loaded.shoe.frame
    pin, centre = shoe.own_pin, loaded.parts.load_centre
    sense = math.copysign(1.0, loaded.drag)
    moments = [sense * forces.torque, float(cross(pin, forces.reaction)), loaded.couple,
               float(cross(centre, loaded.force))]  # fmt: skip
    balance = relative_balance([forces.normal, forces.friction, forces.reaction, loaded.force], moments)
    friction_about_pin = sense * forces.torque - float(cross(pin, forces.friction))
    actuation_about_pin = loaded.couple + float(cross(centre - pin, loaded.force))
    response = pressed_shoe(
        shoe,
        float(np.hypot(*loaded.parts.line.xy).mean()),
        frame.theta(phi),
        pressure,
        order=order,
        torque=forces.torque,
        normal_force=float(np.linalg.norm(forces.normal)),
        self_energising=friction_about_pin * actuation_about_pin > 0,
        hinge_reaction=frame.to_brake(forces.reaction),
        turn=None if turn is None else frame.sense * turn,
        located=False,  # what a peer leaves beside the contact has no ends to find
    )
    p = response.pressure
    arcs = contact_arcs(response.theta, np.where(p > NOTHING * p.max(), p, 0.0), order)
    return replace(response, contact_arcs=arcs), balance


def untouched_response(loaded: Loaded) -> tuple[ShoeResponse, Balance]:
    """The response of a shoe that its force turns away from the drum."""
    return untouched(loaded.shoe, -loaded.shoe.actuation.vector), Balance(0.0, 0.0)


class Ended(NamedTuple):
    """How a process ended: status, what it printed, and its processor time [s]."""

    status: int
    output: str
    seconds: float


def run_process(command: Sequence[str], folder: Path, longest: float) -> Ended:
    """Run a peer in a folder, on one thread, away from this Python's paths. Raises NoAnswer after `longest` seconds."""
    outside = {key: value for key, value in os.environ.items() if key not in {"PYTHONPATH", "PYTHONHOME"}}
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "CCX_NPROC_EQUATION_SOLVER"), "1")
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
    model: str, answers: Sequence[tuple[ShoeResponse, Balance]], iterations: int, seconds: dict[str, float]
) -> Response:
    """The response of the whole brake."""
    return Response(
        model=model,
        shoes=tuple(response for response, _ in answers),
        balance=worst([balance for _, balance in answers]),
        iterations=iterations,
        seconds=seconds,
    )
