"""CalculiX as a peer: write an input deck for each shoe, run `ccx` and check the results.

Each node of the drum moves in a straight line along the drum's tangent. The torque is the moment of
the nodal forces at the undisplaced positions of the nodes. The results are then proportional to
load and rotation, as in the theory of small displacements. If the nodes moved on circles, the
results would change by some 0.1 %. The moment that CalculiX prints is not used: it refers to the
displaced surface and is wrong by some 0.1 %, too.

CalculiX sometimes ends normally although its state is no equilibrium. A state is accepted only
under three conditions: forces and moments balance, enough of the lining touches the drum, and the
lining slips wherever it touches.
"""

import functools
import math
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.base.files import write_text
from drumlin.base.texts import number_as_text
from drumlin.brake.brake import Brake
from drumlin.fem.mesh.arc import DEFAULT_MESH_KIND
from drumlin.fem.preparation.meshes import DEFAULT_ELEMENTS_ALONG_LINING, Mesher
from drumlin.fem.substructure.interface import (
    ContactLine,
    coupling_matrices_of_contact_line,
    function_that_returns_drum_normals_and_tangents,
)
from drumlin.peers.deck import (
    DRUM_ELEMENTS_BEYOND_LINING,
    PIN_SPRING_STIFFNESS_IN_N_PER_MM,
    CalculixDeckParameters,
    angles_of_drum_nodes,
    plane_stress_deck_text,
)
from drumlin.peers.peer import (
    ForcesOnShoeByPeer,
    MeshedShoeUnderActuation,
    PeerMissing,
    PeerResult,
    brake_response_from_shoe_responses,
    mesh_hinged_shoes_under_actuation,
    run_command_of_peer_program,
    shoe_response_and_imbalance_from_peer_forces,
    zero_response_and_imbalance_of_shoe_turned_from_drum,
)
from drumlin.response.response import ForceAndMomentImbalance, ShoeResponse

CALCULIX_MISSING_MESSAGE = (
    "CalculiX is not installed (no ccx on the PATH); on Debian and Ubuntu: apt install calculix-ccx"
)
"""The error message if CalculiX is not installed."""

LARGEST_ACCEPTED_CALCULIX_IMBALANCE = 1e-3
"""Largest relative imbalance of forces or moments of a CalculiX state that is accepted.

The balance counts the contact forces at the undisplaced nodes of the drum. In CalculiX these forces
act on the lining at the displaced nodes, after a rotation of 1e-3 rad. The difference alone makes
an imbalance of about 1e-3.
"""

LEAST_TOUCHING_ELEMENT_FRACTION = 0.1
"""Smallest fraction of the lining's elements that must touch the drum in an accepted state.

CalculiX ended some runs with fewer elements in contact, and their states were no equilibria."""

LARGEST_SHEAR_RATIO_OF_STICKING_POINT = 0.99
"""Shear stress divided by mu p below which a contact point counts as sticking."""

LARGEST_STICKING_FRACTION_IN_FULL_SLIP = 0.02
"""Largest fraction of the contact points that may stick in a state that counts as full slip."""

MOST_DRUM_ROTATION_DOUBLINGS = 4
"""Largest number of times that the drum's rotation is doubled to make the whole lining slip."""

LONGEST_CALCULIX_SECONDS = 3600
"""Time [s] after which a run of CalculiX is stopped."""


class DeckWriterAndContactForceReader(NamedTuple):
    """Two functions: one writes a shoe as a CalculiX deck, one picks out the contact forces.

    Shoes in plane stress and three-dimensional shoes need different functions.

    Attributes
    ----------
    text : function that takes the parameters and the name of a deck, and returns its text
    along : function that takes the forces on all nodes of the drum, and returns the forces (n, 2)
        on the drum's nodes along the friction surface
    """

    text: Callable[[CalculixDeckParameters, str], str]
    along: Callable[[Floats], Floats]


class CalculixState(NamedTuple):
    """The results of a CalculiX run for one shoe, in the shoe's frame.

    Attributes
    ----------
    contact : forces (n, 2) [N] on the nodes of the drum's friction surface
    pin : force (2,) [N] of the pin on the shoe
    turn : rotation of the shoe about the pin [rad], counter-clockwise in the brake
    touching : number of elements of the lining that touch the drum
    points : number of contact points, the integration points in contact
    sticking : fraction of the contact points that stick
    iterations : number of iterations of all increments
    unknowns : number of equations
    seconds : processor time of the run [s]
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
def calculix_version() -> str:
    """The version of CalculiX, the `ccx` on the PATH. Raises PeerMissing if ccx is missing."""
    path = shutil.which("ccx")
    if path is None:
        raise PeerMissing(CALCULIX_MISSING_MESSAGE)
    output = subprocess.run([path, "-v"], capture_output=True, text=True, check=False).stdout
    found = re.search(r"Version\s+(\S+)", output)
    return found[1] if found else "unknown"


def export_calculix_deck_of_each_shoe(
    brake: Brake,
    folder: Path,
    stem: str,
    *,
    elements: int = DEFAULT_ELEMENTS_ALONG_LINING,
    kind: str = DEFAULT_MESH_KIND,
) -> tuple[list[Path], list[str]]:
    """Write the CalculiX decks with which `solve_brake_by_calculix` begins: one for each shoe.

    CalculiX need not be installed. Raises BadInput for a brake that `solve_brake_by_calculix`
    refuses.

    Parameters
    ----------
    brake : the brake
    folder : folder in which the decks are written
    stem : first part of the names of the deck files
    elements, kind : number of elements along each lining, and kind of the elements

    Returns
    -------
    the paths of the decks, and the names of the shoes without a deck; the actuation turns these
    shoes away from the drum
    """
    setting, decks = CalculixDeckParameters(), []
    for loaded in mesh_hinged_shoes_under_actuation(brake, elements, kind):
        decks.append(
            ShoeWithDeckText(loaded, partial(plane_stress_deck_text, brake, loaded, setting))
        )
    return write_decks_of_shoes_pressed_on_drum(decks, folder, stem)


class ShoeWithDeckText(NamedTuple):
    """A shoe under its actuation, and a function that writes its deck.

    The function takes the name of the deck and returns the text of the deck.
    """

    loaded: MeshedShoeUnderActuation
    text: Callable[[str], str]


def write_decks_of_shoes_pressed_on_drum(
    decks: Sequence[ShoeWithDeckText], folder: Path, stem: str, ending: str = ""
) -> tuple[list[Path], list[str]]:
    """Write a CalculiX deck for each shoe that its actuation presses on the drum.

    Parameters
    ----------
    decks : the shoes and the functions that return the texts of their decks
    folder : folder in which the decks are written
    stem, ending : first and last part of the names of the deck files

    Returns
    -------
    the paths of the decks, and the names of the shoes without a deck; the actuation turns these
    shoes away from the drum
    """
    paths, apart = [], []
    for loaded, text in decks:
        if not loaded.is_pressed_on_drum:
            apart.append(loaded.shoe.name)
            continue
        path = folder / f"{stem}_{loaded.shoe.name}{ending}.inp".replace(" ", "_")
        write_text(path, text(path.stem))
        paths.append(path)
    return paths, apart


def solve_brake_by_calculix(
    brake: Brake,
    *,
    elements: int = DEFAULT_ELEMENTS_ALONG_LINING,
    kind: str = DEFAULT_MESH_KIND,
    mesher: Mesher | None = None,
    setting: CalculixDeckParameters | None = None,
) -> PeerResult:
    """Solve a brake by CalculiX on drumlin's mesh.

    If a lining sticks somewhere, its run is repeated with twice the rotation of the drum.

    Parameters
    ----------
    brake : the brake
    elements, kind : number of elements along each lining, and kind of the elements
    mesher : function that meshes a shoe; None: drumlin's mesher with `elements` and `kind`
    setting : parameters of the decks; None: the usual ones

    Raises
    ------
    PeerMissing
        if CalculiX is not installed
    BadInput
        for a brake that `mesh_hinged_shoes_under_actuation` refuses, and for a clearance
    NoAnswer
        if CalculiX fails, or ends on a state that is no equilibrium
    """
    installed = calculix_version()
    tally = CollectedCalculixResults()
    points = []
    for loaded in mesh_hinged_shoes_under_actuation(brake, elements, kind, mesher):
        if not loaded.is_pressed_on_drum:
            tally.answers.append(zero_response_and_imbalance_of_shoe_turned_from_drum(loaded))
            continue
        state, rotation = run_calculix_to_state_and_rotation_of_full_slip(
            brake, loaded, setting or CalculixDeckParameters()
        )
        tally.add_results_and_costs_of_shoe(loaded, state)
        points.append(
            f"shoe {loaded.shoe.name!r}: "
            f"{state.points} contact points on {state.touching} elements, "
            f"drum turned by {rotation:g} rad"
        )
    notes = (
        f"CalculiX {installed}, face-to-face penalty",
        "a further load case is a new run: nothing is reused",
        *points,
    )
    return tally.result_of_brake_from_added_shoes(installed, notes)


class CollectedCalculixResults:
    """Collects the results and the costs of CalculiX's runs for the shoes of a brake."""

    def __init__(self) -> None:
        self.answers: list[tuple[ShoeResponse, ForceAndMomentImbalance]] = []
        self._iterations, self._unknowns, self._seconds = 0, 0, 0.0

    def add_results_and_costs_of_shoe(
        self, loaded: MeshedShoeUnderActuation, state: CalculixState
    ) -> None:
        """Add the results of a shoe, and the iterations, unknowns and time of its run."""
        self.answers.append(shoe_response_and_imbalance_of_calculix_state(loaded, state))
        self._iterations = max(self._iterations, state.iterations)
        self._unknowns += state.unknowns
        self._seconds += state.seconds

    def result_of_brake_from_added_shoes(
        self, installed: str, notes: tuple[str, ...]
    ) -> PeerResult:
        """The collected result for the whole brake; `installed` is the version of CalculiX."""
        seconds = self._seconds
        return PeerResult(
            name="calculix",
            version=installed,
            response=brake_response_from_shoe_responses(
                "calculix", self.answers, self._iterations, {"calculix": seconds}
            ),
            seconds=seconds,
            process_seconds=seconds,
            further_seconds=seconds,
            unknowns=self._unknowns,
            notes=notes,
        )


def plane_stress_deck_writer_and_force_reader(
    brake: Brake, loaded: MeshedShoeUnderActuation
) -> DeckWriterAndContactForceReader:
    """The functions that write a shoe in plane stress as a deck and pick out its contact forces."""
    count = len(angles_of_drum_nodes(loaded))
    # The deck lists the drum's nodes from the inner to the outer arc. The friction surface is the
    # inner arc for an internal shoe, the outer arc for an external shoe.
    arc = slice(count) if loaded.shoe.sign_internal_plus_external_minus > 0 else slice(-count, None)
    return DeckWriterAndContactForceReader(
        text=lambda setting, name: plane_stress_deck_text(brake, loaded, setting, name),
        along=lambda forces: forces[arc],
    )


def run_calculix_to_state_and_rotation_of_full_slip(
    brake: Brake,
    loaded: MeshedShoeUnderActuation,
    setting: CalculixDeckParameters,
    posed: DeckWriterAndContactForceReader | None = None,
) -> tuple[CalculixState, float]:
    """Run CalculiX with larger and larger rotations of the drum, until the whole lining slips.

    Returns the state of the last run and its rotation [rad]. The state holds the time of the last
    run, without the runs before.

    Parameters
    ----------
    brake : the brake
    loaded : the shoe under its actuation
    setting : parameters of the first deck
    posed : functions that write the shoe as a deck and pick out its contact forces; None: the
        functions for a shoe in plane stress

    Raises
    ------
    NoAnswer
        if CalculiX fails, or the lining sticks at the largest rotation
    """
    for _ in range(MOST_DRUM_ROTATION_DOUBLINGS + 1):
        state = write_deck_of_shoe_and_run_calculix(brake, loaded, setting, posed)
        require_equilibrium_and_contact(loaded, state)
        if state.sticking <= LARGEST_STICKING_FRACTION_IN_FULL_SLIP:
            return state, setting.rotation
        setting = setting._replace(rotation=2 * setting.rotation)
    raise NoAnswer(
        f"shoe {loaded.shoe.name!r}: CalculiX: "
        f"{number_as_text(state.sticking, '.0%')} of the contact points do not slip, "
        f"even where the drum turns by {setting.rotation / 2:g} rad"
    )


def write_deck_of_shoe_and_run_calculix(
    brake: Brake,
    loaded: MeshedShoeUnderActuation,
    setting: CalculixDeckParameters,
    posed: DeckWriterAndContactForceReader | None = None,
) -> CalculixState:
    """Write the deck of a shoe into a temporary folder, run `ccx` on one thread, read its results.

    Parameters
    ----------
    brake : the brake
    loaded : the shoe under its actuation
    setting : parameters of the deck
    posed : functions that write the shoe as a deck and pick out its contact forces; None: the
        functions for a shoe in plane stress

    Raises
    ------
    NoAnswer
        if CalculiX does not end normally
    """
    calculix_version()
    posed = posed or plane_stress_deck_writer_and_force_reader(brake, loaded)
    text = posed.text(setting, "shoe")
    with tempfile.TemporaryDirectory(prefix="drumlin-calculix-") as name:
        folder = Path(name)
        (folder / "shoe.inp").write_text(text, encoding="utf-8")
        ended = run_command_of_peer_program(["ccx", "shoe"], folder, LONGEST_CALCULIX_SECONDS)
        if ended.status or "Job finished" not in ended.output:
            reason = (
                _last_error_line(ended.output) or f"its process ended with status {ended.status}"
            )
            raise NoAnswer(f"shoe {loaded.shoe.name!r}: CalculiX: {reason[:200]}")
        dat, sta = (folder / "shoe.dat").read_text(), (folder / "shoe.sta").read_text()
        state = read_calculix_state(dat, sta, ended.output, brake, loaded, setting, posed)
        return state._replace(seconds=ended.seconds)


def _last_error_line(output: str) -> str:
    """The last line of CalculiX's output that names an error, or "" if no line does."""
    faults = ""
    for line in output.splitlines():
        if "*ERROR" in line or "diverge" in line:
            faults = line.strip()
    return faults


class _CalculixResultNumbers(NamedTuple):
    """The numbers in CalculiX's file of results (.dat).

    Attributes
    ----------
    drum : (n, 4), a row for each node of the drum: its label, and the force x, y, z on it [N]
    pin : displacement (2,) of the pin [mm]
    turn : rotation of the shoe about the pin [rad]
    stress : (points, 5), a row for each contact point: element, face of the element, pressure and
        two shear stresses [MPa]
    time : fraction of the load step that was reached, 1 at its end
    """

    drum: Floats
    pin: Floats
    turn: float
    stress: Floats
    time: float


def _read_numbers_of_results_file(dat: str) -> _CalculixResultNumbers:
    """Read the numbers in CalculiX's file of results.

    Raises LookupError or ValueError if numbers are missing.
    """
    blocks = _number_lines_below_each_heading(dat)
    return _CalculixResultNumbers(
        drum=_numbers_below_heading(blocks, "forces (fx,fy,fz) for set NDRUM"),
        pin=_numbers_below_heading(blocks, "displacements (vx,vy,vz) for set PIN")[0, 1:3],
        turn=float(_numbers_below_heading(blocks, "displacements (vx,vy,vz) for set TURN")[0, 1]),
        stress=_numbers_below_heading(blocks, "contact stress"),
        time=float(re.findall(r"for set TURN and time\s+(\S+)", dat)[-1]),
    )


def read_calculix_state(
    dat: str,
    sta: str,
    output: str,
    brake: Brake,
    loaded: MeshedShoeUnderActuation,
    setting: CalculixDeckParameters,
    posed: DeckWriterAndContactForceReader | None = None,
) -> CalculixState:
    """Read the state of a shoe from the files that CalculiX has written.

    Parameters
    ----------
    dat : text of the file of results (.dat)
    sta : text of the file of increments (.sta)
    output : text that CalculiX printed
    brake : the brake
    loaded : the shoe under its actuation
    setting : parameters of the deck
    posed : functions that write the shoe as a deck and pick out its contact forces; None: the
        functions for a shoe in plane stress

    Raises
    ------
    NoAnswer
        if the files hold no results at the end of the load step
    """
    shoe = loaded.shoe
    try:
        results = _read_numbers_of_results_file(dat)
    except (LookupError, ValueError) as error:
        raise NoAnswer(f"shoe {shoe.name!r}: CalculiX wrote no contact state ({error})") from error
    if abs(results.time - 1) > 1e-6:
        raise NoAnswer(f"shoe {shoe.name!r}: CalculiX ended at {results.time:g} of its step")
    # The deck models only a fraction of the lining's width, so that its forces are divided by this
    # fraction.
    size = setting.thickness
    along = (posed or plane_stress_deck_writer_and_force_reader(brake, loaded)).along
    stress = results.stress
    pressure, shear = stress[:, 2], np.hypot(stress[:, 3], stress[:, 4])
    # Contact points with hardly any pressure do not count in the fraction of sticking points.
    pressed = pressure > 1e-3 * pressure.max()
    sticks = (
        shear[pressed]
        < LARGEST_SHEAR_RATIO_OF_STICKING_POINT
        * brake.friction_coefficient_of_shoe_at_zero_pressure(shoe)
        * pressure[pressed]
    )
    # Each row of the .sta file is an increment; its fourth number counts the iterations.
    increments = [row.split() for row in sta.splitlines() if re.match(r"\s+\d", row)]
    equations = re.search(r"number of equations\s+(\d+)", output)
    return CalculixState(
        contact=shoe.frame.convert_vectors_to_shoe_frame(along(results.drum[:, 1:3])) / size,
        pin=shoe.frame.convert_vectors_to_shoe_frame(
            -PIN_SPRING_STIFFNESS_IN_N_PER_MM * results.pin
        )
        / size,
        turn=results.turn,
        touching=len(np.unique(stress[:, 0])),
        points=len(stress),
        sticking=float(np.mean(sticks)),
        iterations=sum(int(row[3]) for row in increments),
        unknowns=int(equations[1]) if equations else 0,
    )


def _number_lines_below_each_heading(dat: str) -> dict[str, str]:
    """The lines with numbers in CalculiX's file of results, by the heading above them.

    If a heading occurs several times, the lines below its last occurrence are returned.
    """
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


def _numbers_below_heading(blocks: dict[str, str], start: str) -> Floats:
    """The numbers (rows, columns) below the heading that begins with `start`.

    Raises LookupError if there is no such heading, or if no numbers are below it.
    """
    for heading, text in blocks.items():
        if heading.startswith(start) and text:
            rows = list(map(str.split, text.splitlines()))
            return np.array(rows).astype(float)
    raise LookupError(f"nothing under {start!r}")


def require_equilibrium_and_contact(loaded: MeshedShoeUnderActuation, state: CalculixState) -> None:
    """Raise NoAnswer if a shoe's state is no equilibrium or has too few elements in contact."""
    name, lining = loaded.shoe.name, len(loaded.parts.line.pieces[0])
    _, balance = shoe_response_and_imbalance_of_calculix_state(loaded, state)
    if not max(balance.force, balance.moment) < LARGEST_ACCEPTED_CALCULIX_IMBALANCE:
        raise NoAnswer(
            f"shoe {name!r}: CalculiX ended normally where forces balance only to "
            f"{balance.force:.1e} and moments to {balance.moment:.1e}"
        )
    if state.touching < LEAST_TOUCHING_ELEMENT_FRACTION * lining:
        raise NoAnswer(
            f"shoe {name!r}: CalculiX ended normally with {state.points} contact points on "
            f"{state.touching} of {lining} elements"
        )


def shoe_response_and_imbalance_of_calculix_state(
    loaded: MeshedShoeUnderActuation, state: CalculixState
) -> tuple[ShoeResponse, ForceAndMomentImbalance]:
    """The response of a shoe from CalculiX's results, and the relative imbalance of its forces.

    CalculiX gives nodal forces on the drum. Pressure and shear stress at the nodes follow from
    linear equations: their equivalent nodal forces equal CalculiX's nodal forces.
    """
    shoe, frame = loaded.shoe, loaded.shoe.frame
    # The nodes of the drum's arc in the order of growing phi, the angle in the shoe's frame.
    forces = state.contact[:: frame.sense]
    phi = frame.phi_of_surface_coordinates(angles_of_drum_nodes(loaded))[:: frame.sense]
    radius = float(np.hypot(*loaded.parts.line.xy).mean())
    xy = radius * np.array([np.cos(phi), np.sin(phi)])
    # Each quadratic edge of an element has three successive nodes; two edges share an end node.
    pieces = np.arange(3)[:, None] + np.arange(0, len(phi) - 2, 2)
    line = ContactLine(np.arange(len(phi)), xy, phi, pieces)
    coupling = coupling_matrices_of_contact_line(
        line,
        shoe.lining.width,
        function_that_returns_drum_normals_and_tangents(shoe.sign_internal_plus_external_minus),
    )
    # Column j of each matrix has the nodal forces of a unit pressure, or unit shear, at node j.
    pressing, dragging = -coupling.N.T, coupling.T.T
    both = np.hstack([pressing, dragging])
    pressure, shear = np.split(np.linalg.solve(both, forces.ravel()), 2)
    normal = (pressing @ pressure).reshape(-1, 2).sum(axis=0)
    friction = (dragging @ shear).reshape(-1, 2).sum(axis=0)
    torque = abs(float(xy[0] @ forces[:, 1] - xy[1] @ forces[:, 0]))
    held = np.array([*state.pin, 0.0])
    # The springs at the pin also carry an actuation that acts at the hinge. It is added to their
    # force, so that `held` is the force of the hinge on the shoe's body.
    if not loaded.does_actuation_act_on_body_end:
        held += [*loaded.force, loaded.couple]
    found = ForcesOnShoeByPeer(normal, friction, math.copysign(torque, loaded.drag), held, torque)
    lining = slice(2 * DRUM_ELEMENTS_BEYOND_LINING, len(phi) - 2 * DRUM_ELEMENTS_BEYOND_LINING)
    turn = np.array([state.turn])
    return shoe_response_and_imbalance_from_peer_forces(
        loaded, phi[lining], pressure[lining], 2, found, turn
    )
