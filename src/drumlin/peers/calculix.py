"""CalculiX as a peer: decks written, run by `ccx`, read back and checked.

The drum's nodes move along their tangents and the torque is the moment of the forces on them where
they were at first: the answer is then in proportion to load and rotation, as of small
displacements. A drum that turns on circles is off by some 1e-3, and so is the moment that CalculiX
prints, which is about the moved surface. A state is believed only where forces and moments balance,
where enough of the lining touches and where it slips everywhere that it touches; it is known to end
normally on states that are none.
"""

import functools
import math
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.base.files import write_text
from drumlin.base.texts import formatted
from drumlin.brake.brake import Brake
from drumlin.fem.mesh.arc import DEFAULT_KIND
from drumlin.fem.preparation.meshes import ELEMENTS, Mesher
from drumlin.fem.substructure.interface import ContactLine, couple, radial
from drumlin.peers.deck import BEARING, BEYOND_ELEMENTS, Setting, deck, drum_angles
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

INSTALL = (
    "CalculiX is not installed (no ccx on the PATH); on Debian and Ubuntu: apt install calculix-ccx"
)
LARGEST_IMBALANCE = 1e-3  # relative: the two sides of the contact are apart by the drum's rotation
LEAST_TOUCHING = 0.1  # of the lining's elements
STICKING = 0.99  # of mu p: less shear than that is not full slip ...
MOST_STICKING = 0.02  # ... and at most this part of the points may have less
MOST_DOUBLINGS = 4  # of the drum's rotation, until the lining slips everywhere
LONGEST = 3600  # s


class Posed(NamedTuple):
    """How a shoe is posed to CalculiX: `text(setting, name)`, its deck, and `along(forces)`: of the
    forces (n, 2) on all nodes of the drum those on the nodes of its arc.
    """

    text: Callable[[Setting, str], str]
    along: Callable[[Floats], Floats]


class State(NamedTuple):
    """What CalculiX found, in the shoe's frame: forces on the nodes of the drum's arc (n, 2) and of
    the pin on the shoe (2,) [N], turn about the pin [rad], counter-clockwise in the brake.

    `touching`: elements of the lining with contact points; `points`: their number; `sticking`: the
    part of them that does not slip. `iterations`; `unknowns`; `seconds` of its process.
    """

    contact: Floats
    pin: Floats
    turn: float
    touching: int
    points: int
    sticking: float
    iterations: int
    unknowns: int
    seconds: float = 0.0


@functools.cache
def version() -> str:
    """Version of the `ccx` on the PATH. Raises PeerMissing where there is none."""
    path = shutil.which("ccx")
    if path is None:
        raise PeerMissing(INSTALL)
    said = subprocess.run([path, "-v"], capture_output=True, text=True, check=False).stdout
    found = re.search(r"Version\s+(\S+)", said)
    return found[1] if found else "unknown"


def export(
    brake: Brake, folder: Path, stem: str, *, elements: int = ELEMENTS, kind: str = DEFAULT_KIND
) -> tuple[list[Path], list[str]]:
    """Write the decks of a brake, one for each shoe, as `solve` runs them at first.

    Returns the files, and the names of shoes without a deck because their force turns them away
    from the drum. Raises BadInput as `solve` does; needs no CalculiX.
    """
    paths, apart = [], []
    for loaded in loaded_shoes(brake, elements, kind):
        if not loaded.approaches:
            apart.append(loaded.shoe.name)
            continue
        path = folder / f"{stem}_{loaded.shoe.name}.inp".replace(" ", "_")
        write_text(path, deck(brake, loaded, Setting(), path.stem))
        paths.append(path)
    return paths, apart


def solve(
    brake: Brake,
    *,
    elements: int = ELEMENTS,
    kind: str = DEFAULT_KIND,
    mesher: Mesher | None = None,
    setting: Setting | None = None,
) -> Peer:
    """A brake by CalculiX on drumlin's mesh; where the lining does not slip everywhere the drum is
    turned twice as far.

    Raises PeerMissing; BadInput for a brake with a ring, without friction or with a clearance;
    NoAnswer where it fails or ends on a state that is none.
    """
    installed = version()
    shoes = loaded_shoes(brake, elements, kind, mesher)
    answers, iterations, unknowns, seconds, points = [], 0, 0, 0.0, []
    for loaded in shoes:
        if not loaded.approaches:
            answers.append(untouched_response(loaded))
            continue
        state, rotation = slipping(brake, loaded, setting or Setting())
        answers.append(response(loaded, state))
        iterations = max(iterations, state.iterations)
        unknowns += state.unknowns
        seconds += state.seconds
        points.append(
            f"shoe {loaded.shoe.name!r}: {state.points} contact points on {state.touching} elements, "
            f"drum turned by {rotation:g} rad"
        )
    found = brake_response("calculix", answers, iterations, {"calculix": seconds})
    notes = (
        f"CalculiX {installed}, face-to-face penalty",
        "a further load case is a new run: nothing is reused",
        *points,
    )
    return Peer("calculix", installed, found, seconds, seconds, seconds, unknowns, notes)


def plane_pose(brake: Brake, loaded: Loaded) -> Posed:
    """A shoe in plane stress."""
    count = len(drum_angles(loaded))
    arc = slice(count) if loaded.shoe.sign > 0 else slice(-count, None)
    return Posed(
        lambda setting, name: deck(brake, loaded, setting, name), lambda forces: forces[arc]
    )


def slipping(
    brake: Brake, loaded: Loaded, setting: Setting, posed: Posed | None = None
) -> tuple[State, float]:
    """The state of a shoe, the drum turned so far that the lining slips, and that rotation [rad].

    Only the run that is kept counts in its time. Raises NoAnswer.
    """
    for _ in range(MOST_DOUBLINGS + 1):
        state = run(brake, loaded, setting, posed)
        check(loaded, state)
        if state.sticking <= MOST_STICKING:
            return state, setting.rotation
        setting = setting._replace(rotation=2 * setting.rotation)
    raise NoAnswer(
        f"shoe {loaded.shoe.name!r}: CalculiX: {formatted(state.sticking, '.0%')} of the contact points do not slip, "
        f"even where the drum turns by {setting.rotation / 2:g} rad"
    )


def run(brake: Brake, loaded: Loaded, setting: Setting, posed: Posed | None = None) -> State:
    """Write a deck into a folder of its own, run `ccx` on one thread, and read its state.

    Raises NoAnswer where it does not end normally.
    """
    version()
    posed = posed or plane_pose(brake, loaded)
    text = posed.text(setting, "shoe")
    with tempfile.TemporaryDirectory(prefix="drumlin-calculix-") as folder:
        (Path(folder) / "shoe.inp").write_text(text, encoding="utf-8")
        ended = run_process(["ccx", "shoe"], Path(folder), LONGEST)
        if ended.status or "Job finished" not in ended.output:
            faults = [
                line.strip()
                for line in ended.output.splitlines()
                if "*ERROR" in line or "diverge" in line
            ]
            said = faults[-1] if faults else f"its process ended with status {ended.status}"
            raise NoAnswer(f"shoe {loaded.shoe.name!r}: CalculiX: {said[:200]}")
        dat, sta = ((Path(folder) / f"shoe.{suffix}").read_text() for suffix in ("dat", "sta"))
        state = read_state(dat, sta, ended.output, brake, loaded, setting, posed)
        return state._replace(seconds=ended.seconds)


def read_state(
    dat: str,
    sta: str,
    output: str,
    brake: Brake,
    loaded: Loaded,
    setting: Setting,
    posed: Posed | None = None,
) -> State:
    """The state in CalculiX's texts: results (.dat), increments (.sta), and what it printed. Raises
    NoAnswer.
    """
    blocks = _blocks(dat)
    try:
        drum = _block(blocks, "forces (fx,fy,fz) for set NDRUM")
        pin = _block(blocks, "displacements (vx,vy,vz) for set PIN")[0, 1:3]
        turn = float(_block(blocks, "displacements (vx,vy,vz) for set TURN")[0, 1])
        stress = _block(blocks, "contact stress")
        time_reached = float(re.findall(r"for set TURN and time\s+(\S+)", dat)[-1])
    except (LookupError, ValueError) as error:
        raise NoAnswer(
            f"shoe {loaded.shoe.name!r}: CalculiX wrote no contact state ({error})"
        ) from error
    if abs(time_reached - 1) > 1e-6:
        raise NoAnswer(f"shoe {loaded.shoe.name!r}: CalculiX ended at {time_reached:g} of its step")
    size = setting.thickness
    press, shear = stress[:, 2], np.hypot(stress[:, 3], stress[:, 4])
    pressed = press > 1e-3 * press.max()
    steps = [row.split() for row in sta.splitlines() if re.match(r"\s+\d", row)]
    equations = re.search(r"number of equations\s+(\d+)", output)
    return State(
        contact=loaded.shoe.frame.to_shoe((posed or plane_pose(brake, loaded)).along(drum[:, 1:3]))
        / size,
        pin=loaded.shoe.frame.to_shoe(-BEARING * pin) / size,
        turn=turn,
        touching=len(np.unique(stress[:, 0])),
        points=len(stress),
        sticking=float(np.mean(shear[pressed] < STICKING * brake.friction * press[pressed])),
        iterations=sum(int(row[3]) for row in steps),
        unknowns=int(equations[1]) if equations else 0,
    )


def _blocks(dat: str) -> dict[str, str]:
    """Heading -> lines of numbers under it, of the last time that it is printed."""
    found: dict[str, str] = {}
    heading = ""
    for line in dat.splitlines():
        words = line.split()
        if not words:
            continue
        if re.match(r"[-+]?[\d.]", words[0]):
            found[heading] += line + "\n"
        else:
            heading = line.strip()
            found[heading] = ""
    return found


def _block(blocks: dict[str, str], start: str) -> Floats:
    """The numbers (rows, columns) under the heading that starts so; raises LookupError."""
    for heading, text in blocks.items():
        if heading.startswith(start) and text:
            return np.array([[float(word) for word in line.split()] for line in text.splitlines()])
    raise LookupError(f"nothing under {start!r}")


def check(loaded: Loaded, state: State) -> None:
    """Raise NoAnswer where a state is none: forces or moments that do not balance, a handful of
    contact points.
    """
    name, lining = loaded.shoe.name, len(loaded.parts.line.pieces[0])
    _, balance = response(loaded, state)
    if not max(balance.force, balance.moment) < LARGEST_IMBALANCE:
        raise NoAnswer(f"shoe {name!r}: CalculiX ended normally where forces balance only to {balance.force:.1e} and "
                       f"moments to {balance.moment:.1e}")  # fmt: skip
    if state.touching < LEAST_TOUCHING * lining:
        raise NoAnswer(f"shoe {name!r}: CalculiX ended normally with {state.points} contact points on "
                       f"{state.touching} of {lining} elements")  # fmt: skip


def response(loaded: Loaded, state: State) -> tuple[ShoeResponse, Balance]:
    """The response to a state. Pressure and shear are those whose nodal forces are CalculiX's on
    the drum.
    """
    shoe, frame = loaded.shoe, loaded.shoe.frame
    theta = drum_angles(loaded)
    forces = state.contact[:: frame.sense]
    phi = frame.phi(theta)[:: frame.sense]
    radius = float(np.hypot(*loaded.parts.line.xy).mean())
    xy = radius * np.array([np.cos(phi), np.sin(phi)])
    pieces = np.arange(3)[:, None] + np.arange(0, len(phi) - 2, 2)
    line = ContactLine(np.arange(len(phi)), xy, phi, pieces)
    coupling = couple(line, shoe.lining.width, radial(shoe.sign))
    pressing, dragging = -coupling.N.T, coupling.T.T  # nodal forces of a pressure and of a shear
    pressure, shear = np.split(np.linalg.solve(np.hstack([pressing, dragging]), forces.ravel()), 2)
    normal, along = (
        (of @ values).reshape(-1, 2).sum(axis=0)
        for of, values in ((pressing, pressure), (dragging, shear))
    )
    torque = abs(float(xy[0] @ forces[:, 1] - xy[1] @ forces[:, 0]))
    on = slice(2 * BEYOND_ELEMENTS, len(phi) - 2 * BEYOND_ELEMENTS)
    held = np.array([*state.pin, 0.0])
    if not loaded.on_body:  # which the springs bear too
        held += [*loaded.force, loaded.couple]
    found = Forces(normal, along, math.copysign(torque, loaded.drag), held, torque)
    return shoe_response(loaded, phi[on], pressure[on], 2, found, np.array([state.turn]))
