"""Compare solid shoes of random brakes with CalculiX, which solves them by hexahedra.

    python -m drumlin_studies.solid_peer KIND FIRST LAST FILE [SECONDS]

solves the random brakes of the seeds FIRST to LAST - 1 by drumlin, to RELATIVE_TOLERANCE, and by
CalculiX on the meshes NUMBERS_OF_HEXAHEDRA_ALONG_LINING. It appends a line of JSON for each brake
to FILE, skips brakes that FILE already has, and prints a line for each new brake and a table on all
brakes of FILE. KIND is a name in `solid_error.FUNCTIONS_THAT_DRAW_BRAKES_BY_SOLID_KIND`. A brake is
given up after SECONDS of time by the clock (by default 300).

The two programs share only the brake: drumlin has polynomials on pieces of the width times hp
elements of the section, and its own contact. CalculiX has hexahedra C3D20R with 20 nodes, and a
face-to-face penalty contact. CalculiX does not state an error. The distance of its two finest
meshes stands for it: the distance of the finest mesh from the exact answer may be somewhat larger
or smaller. The programs agree on a quantity if they differ by at most the error that drumlin states
plus this distance.

On 16 brakes (twelve "built" from 510061 to 510081, four "free" from 510072 to 510079) the programs
agree on all pressures and on 15 torques. On "free" 510073 the torques differ by 4.0e-4, with 2.6e-4
stated and a last step of 1e-5. Other brakes of these seeds have clearances, which the decks do not
know, or took more than 150 s on a loaded machine.

On twelve further brakes (nine "built" from 510082 to 510095, three "free" from 510083 to 510091)
the programs agree on eleven pressures and nine torques. On most of these brakes the lining lifts
off, and the pressures of CalculiX's two finest meshes differ by 1 to 10 %, on "built" 510082 and
510083 by 26 and 47 %. On "built" 510083 the pressures differ by 59 %. The torques of "built" 510088
differ by 0.84, 0.67 and 0.53 % on CalculiX's three meshes, with 0.26 % stated and a last step of
0.13 %. The torques of "built" 510092 differ by 0.10 %, with 0.06 % stated and a last step of 0.02
%, and those of "free" 510088 by 4.9e-5, with 3.1e-5 stated and a last step of 4e-6.

Brakes without friction are not compared, because the decks have a drum that slips.
"""

import json
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from drumlin.base.errors import DrumlinError
from drumlin.base.threads import one_blas_thread_unless_user_set_number
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.adapt import TolerancesOfPressureAndTorque
from drumlin.fem.width.ladder import solve_brake_with_widths_to_tolerance
from drumlin.peers.deck import CalculixDeckParameters
from drumlin.peers.solid_deck import DRUM_ROTATION_IN_SOLID_DECK, solve_solid_by_calculix
from drumlin.response.norms import relative_distance_of_pressures, relative_error_of_number
from drumlin.response.response import Response
from drumlin_studies.solid_error import (
    FUNCTIONS_THAT_DRAW_BRAKES_BY_SOLID_KIND,
    NAMES_OF_ERRORS_BOUNDED_BY_TOLERANCE,
    limit_time_of_block,
    reason_why_brake_is_left_out,
)

RELATIVE_TOLERANCE = 0.01
"""Relative tolerance of drumlin's solves, for the pressure averaged over the width and the torque.
"""
NUMBERS_OF_HEXAHEDRA_ALONG_LINING = (10, 16, 24)
"""Numbers of CalculiX's hexahedra along a lining, from coarse to fine.

On brakes of both kinds the last mesh takes 3 to 13 s. The pressures of the last two meshes differ
by 0.1 to 4 %, and their torques by at most 2e-4.
"""
DRUM_ROTATION_OF_TORQUE_OVER_ROTATION_OF_PRESSURE = 8
"""Rotation of the drum in the decks that give CalculiX's torque, relative to the usual rotation.

Friction acts in the direction of slip. A pressed lining expands across its width, so that a small
part of the friction does so too. Where a shoe presses with a corner of its lining, the pressure and
this expansion are large, and with the usual rotation the torque is 0.3 to 0.7 % too small ("free"
510072 and "built" 510076). The loss falls about as the square of the rotation. With 24 elements
along the lining, 64 times the rotation changes these torques by less than 1e-4 of what 8 times the
rotation gives. The pressure comes from decks with the usual rotation. The drum's nodes move along
tangents, and the pressure departs in proportion to the rotation: on "built" 510062, with 16
elements, it differs from drumlin's by 0.2 % with the usual rotation, and by 3.5 % with 8 times the
rotation.
"""
EDGE_ZONE_OVER_LINING_THICKNESS = 0.5
"""Length of the zones at the ends of a lining that are left out of the distance of two pressures.

It is relative to the lining's thickness. There the pressure may be unbounded, and hexahedra do not
resolve it.
"""


@dataclass(frozen=True)
class SolidPeerRow:
    """How far drumlin and CalculiX are apart on a brake with solid shoes.

    The names of errors and distances are "torque" and "pressure". Distances are relative.

    Attributes
    ----------
    kind, seed : how the brake is drawn
    reason : why the programs are not compared; empty if they are
    stated : errors that drumlin states
    distances : distances of drumlin's answer from CalculiX's answers on
        NUMBERS_OF_HEXAHEDRA_ALONG_LINING, one mapping for each mesh
    steps : distances of CalculiX's answers from its answer on the next finer mesh
    seconds : processor time of drumlin's solve, with its error [s]
    peer_seconds : processor time of CalculiX's solve on each mesh, for the pressure alone [s]
    """

    kind: str
    seed: int
    reason: str = ""
    stated: dict[str, float] = field(default_factory=dict)
    distances: tuple[dict[str, float], ...] = ()
    steps: tuple[dict[str, float], ...] = ()
    seconds: float = 0.0
    peer_seconds: tuple[float, ...] = ()

    def do_programs_agree(self, name: str) -> bool:
        """Whether the programs differ by at most drumlin's stated error plus CalculiX's last step.

        `name` is "torque" or "pressure".
        """
        return self.distances[-1][name] <= self.stated[name] + self.steps[-1][name]


def relative_distances_of_two_responses(
    brake: Brake, one: Response, better: Response
) -> dict[str, float]:
    """Relative distances of torque and pressure of a response from those of a better response.

    The distance of pressures is the largest of all shoes. Zones at the ends of the linings are left
    out of it, see EDGE_ZONE_OVER_LINING_THICKNESS.
    """
    apart = []
    for shoe, own, other in zip(brake.shoes, one.shoes, better.shoes, strict=True):
        zone = EDGE_ZONE_OVER_LINING_THICKNESS * shoe.lining.thickness / brake.size
        apart.append(relative_distance_of_pressures(own, other, zone))
    return {
        "torque": abs(relative_error_of_number(one.torque, better.torque)),
        "pressure": max(apart),
    }


def compare_random_solid_brake_with_calculix(kind: str, seed: int, seconds: float) -> SolidPeerRow:
    """Solve a random brake with solid shoes by both programs.

    Parameters
    ----------
    kind : how the brake is drawn, a name in FUNCTIONS_THAT_DRAW_BRAKES_BY_SOLID_KIND
    seed : seed of the brake
    seconds : time [s] after which the brake is given up
    """
    row = SolidPeerRow(kind, seed)
    try:
        brake = FUNCTIONS_THAT_DRAW_BRAKES_BY_SOLID_KIND[kind](seed)
        row = replace(row, reason=reason_why_brake_is_left_out(brake, kind))
        if row.reason:
            return row
        with limit_time_of_block(seconds, by_clock=True):
            return _row_of_brake_solved_by_both(brake, row)
    except (DrumlinError, TimeoutError) as error:
        return replace(row, reason=str(error))


def _row_of_brake_solved_by_both(brake: Brake, row: SolidPeerRow) -> SolidPeerRow:
    """The row of a brake, with the distances of both programs' answers."""
    started = time.process_time()
    tolerance = TolerancesOfPressureAndTorque(RELATIVE_TOLERANCE, RELATIVE_TOLERANCE)
    mine = solve_brake_with_widths_to_tolerance(brake, tolerance, must=False)
    seconds, answers, peer_seconds = time.process_time() - started, [], []
    turning = CalculixDeckParameters(
        rotation=DRUM_ROTATION_OF_TORQUE_OVER_ROTATION_OF_PRESSURE * DRUM_ROTATION_IN_SOLID_DECK
    )
    for elements in NUMBERS_OF_HEXAHEDRA_ALONG_LINING:
        usual = solve_solid_by_calculix(brake, elements=elements)
        peer_seconds.append(usual.process_seconds)
        turned = solve_solid_by_calculix(brake, elements=elements, setting=turning).response
        torques = [shoe.torque for shoe in turned.shoes]
        shoes = [
            replace(s, torque=own) for s, own in zip(usual.response.shoes, torques, strict=True)
        ]
        answers.append(replace(usual.response, shoes=tuple(shoes)))
    return replace(
        row,
        stated={name: (mine.error or {})[name] for name in NAMES_OF_ERRORS_BOUNDED_BY_TOLERANCE},
        distances=tuple(relative_distances_of_two_responses(brake, each, mine) for each in answers),
        steps=tuple(
            relative_distances_of_two_responses(brake, coarse, fine)
            for coarse, fine in pairwise(answers)
        ),
        seconds=seconds,
        peer_seconds=tuple(peer_seconds),
    )


def read_solid_peer_rows(path: Path) -> list[SolidPeerRow]:
    """The rows in a file with a line of JSON for each row; an empty list without the file."""
    if not path.exists():
        return []
    found = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    tuples = ("distances", "steps", "peer_seconds")
    return [SolidPeerRow(**(row | {name: tuple(row[name]) for name in tuples})) for row in found]


def table_lines_of_distances_from_calculix(rows: Sequence[SolidPeerRow]) -> list[str]:
    """Table lines: on how many brakes the programs agree, how far they are apart, and their times.

    The quantiles belong to the distances of drumlin's answer from CalculiX's finest mesh, and to
    the distances of CalculiX's two finest meshes.
    """
    known = [row for row in rows if row.distances]
    lines = [f"{len(known)} of {len(rows)} brakes are solved by both programs"]
    if not known:
        return lines
    lines.append("quantity  agree  distance [%]: half  most  last step of CalculiX [%]: half  most")
    for name in NAMES_OF_ERRORS_BOUNDED_BY_TOLERANCE:
        agree = sum(row.do_programs_agree(name) for row in known)
        apart = 100 * np.array([row.distances[-1][name] for row in known])
        step = 100 * np.array([row.steps[-1][name] for row in known])
        lines.append(
            f"{name:8}  {agree:5}  {np.median(apart):18.3f}  {apart.max():4.2f}  "
            f"{np.median(step):31.3f}  {step.max():4.2f}"
        )
    slower = np.median([row.peer_seconds[-1] / row.seconds for row in known])
    lines.append(f"CalculiX's finest mesh takes {slower:.1f} times as long (median)")
    return lines


def text_line_of_solid_peer_row(row: SolidPeerRow) -> str:
    """A line of text on a brake: how far the programs are apart, or why they are not compared."""
    if row.reason:
        return f"{row.kind} {row.seed}: {row.reason}"
    parts = [
        f"{name} apart {row.distances[-1][name]:.1e}, stated {row.stated[name]:.1e}, "
        f"step of CalculiX {row.steps[-1][name]:.1e}"
        for name in NAMES_OF_ERRORS_BOUNDED_BY_TOLERANCE
    ]
    times = f"{row.seconds:.1f} s and {row.peer_seconds[-1]:.1f} s"
    return f"{row.kind} {row.seed}: {'; '.join(parts)}; {times}"


def main() -> None:
    """Compare the brakes of a kind, keep their rows in a file, and print the table of all rows."""
    kind, first, last, path = sys.argv[1], *map(int, sys.argv[2:4]), Path(sys.argv[4])
    seconds = float(sys.argv[5]) if len(sys.argv) > 5 else 300.0
    if kind not in FUNCTIONS_THAT_DRAW_BRAKES_BY_SOLID_KIND:
        allowed = ", ".join(FUNCTIONS_THAT_DRAW_BRAKES_BY_SOLID_KIND)
        sys.exit(f"KIND = {kind}; allowed: {allowed}")
    rows = [row for row in read_solid_peer_rows(path) if row.kind == kind]
    for seed in sorted({*range(first, last)} - {row.seed for row in rows}):
        with one_blas_thread_unless_user_set_number():
            rows.append(compare_random_solid_brake_with_calculix(kind, seed, seconds))
        with path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(asdict(rows[-1])) + "\n")
        sys.stdout.write(f"{text_line_of_solid_peer_row(rows[-1])}\n")
        sys.stdout.flush()
    sys.stdout.write("\n".join(table_lines_of_distances_from_calculix(rows)) + "\n")


if __name__ == "__main__":
    main()
