"""Stored truths: solutions far finer than any answer of drumlin, kept as files for the tests.

A test must notice an error stated by drumlin that is too small or needlessly large. For this the
test needs the true error, and therefore a solution whose own uncertainty is much smaller than the
stated error. Such a solution takes ten seconds for each brake. The command

    python -m drumlin_studies.stored_truth FOLDER [NAME ...]

computes the solutions of some forty brakes of every kind once, and the tests read its files. A file
also holds the brake, so that the file does not depend on how random brakes are drawn.

Brakes on a drum are solved by the curved triangles of `drumlin.verification.triangles`, with one
mesh more than a study uses (`TRIANGLE_MESHES_OF_STORED_TRUTH`). This method shares only the brake
with the judged hp elements. The triangles do not cover brakes on a plane and some wheel cylinders.
These brakes are solved by hp elements of a higher degree with exact contact
(`HP_MESHES_OF_STORED_TRUTH`), which are smaller at every singular point than the elements on any
level of a solve. The last three meshes of a sequence give the uncertainty, which is stored with the
solution.
"""

import json
import math
import sys
import time
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.files import write_text
from drumlin.brake import clearance
from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.brake.plane_brake import make_drum_or_plane_brake_from_data
from drumlin.fem.error_control.levels import (
    DEGREE_IN_RADIANS,
    solve_brake_on_finer_and_finer_mesh_levels,
)
from drumlin.fem.hp.corner import (
    corners_with_unbounded_pressure,
    nodes_and_pressures_with_power_law_at_corner,
    remaining_pressure_error_at_lining_corners,
)
from drumlin.fem.hp.division import RefinementLevel
from drumlin.fem.model import solve_prepared_model
from drumlin.verification import triangles
from drumlin.verification.triangles.levels import TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE
from drumlin.verification.triangles.outline import DegreeAndGradingOfTriangleMesh
from drumlin.verification.triangles.solution import ShoeSolution
from drumlin_studies.random_brake import FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND as DRAWN_KINDS
from drumlin_studies.random_brake import draw_random_brake
from drumlin_studies.random_corners import WAYS_TO_DRAW_BRAKES_BY_CORNER_KIND as CORNERS
from drumlin_studies.random_corners import draw_random_brake_pressing_with_corner_or_kink
from drumlin_studies.random_kinds import draw_random_brake_of_support_kind
from drumlin_studies.stated_true import (
    FarFinerSolutionOfBrake,
    largest_round_off_errors_of_shoes,
    reference_from_last_three_meshes,
)
from drumlin_studies.stated_true import FarFinerSolutionOfShoe as Solved

TRIANGLE_MESHES_OF_STORED_TRUTH = (
    *TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE,
    DegreeAndGradingOfTriangleMesh(6, 17, 0.7, 0.8),
)
"""Meshes of curved triangles, coarse to fine.

The arguments are the attributes `degree`, `halvings`, `longest_over_corner_distance` and `size` of
DegreeAndGradingOfTriangleMesh. The last mesh is not used in the studies. It has a higher degree,
and its triangles are halved more often towards the singular points. On four brakes this mesh
lowered the uncertainty of the pressure from 1e-5 to 2e-6 and of the torque from 1e-10 to 1e-11. A
further mesh lowered neither.
"""

HP_MESHES_OF_STORED_TRUTH = (
    # The arguments are the attributes of `RefinementLevel` in their order, from `degree` to
    # `layer_size_ratio`.
    RefinementLevel(6, 0.02, 0.01, 0.0008, 0.42, 0.25, 15 * DEGREE_IN_RADIANS, 0.02, 0.012, 0.2),
    RefinementLevel(
        7, 0.006, 0.004, 0.0003, 0.45, 0.27, 13 * DEGREE_IN_RADIANS, 0.007, 0.004, 0.24
    ),
    RefinementLevel(
        8, 0.002, 0.0015, 0.0001, 0.48, 0.3, 11 * DEGREE_IN_RADIANS, 0.0025, 0.0014, 0.28
    ),
)
"""Meshes of hp elements, coarse to fine, finer than every level of a solve.

On 20 brakes the responses on these meshes were compared with the curved triangles. The relative
differences of the pressures are at most 2e-5, or 1e-4 if the lining presses with its corner. The
relative differences of the torques are at most 2e-7.
"""

TRIANGLE_MESHES_FOR_PRESSED_CORNER = (
    DegreeAndGradingOfTriangleMesh(4, 14, 0.7, 0.8),
    DegreeAndGradingOfTriangleMesh(5, 18, 0.7, 0.8),
    DegreeAndGradingOfTriangleMesh(6, 22, 0.7, 0.8),
)
"""Meshes of curved triangles for brakes that press only by a corner of the lining."""
TRIANGLE_MESHES_FOR_PRESSED_TIP = (
    DegreeAndGradingOfTriangleMesh(4, 16, 0.7, 0.8),
    DegreeAndGradingOfTriangleMesh(5, 21, 0.7, 0.8),
    DegreeAndGradingOfTriangleMesh(6, 26, 0.7, 0.8),
)
"""Meshes of curved triangles for brakes that press only by a tip, a kink that points to the drum.

The smallest triangles have sizes of 2e-7 (TRIANGLE_MESHES_FOR_PRESSED_CORNER) and 1e-8
(TRIANGLE_MESHES_FOR_PRESSED_TIP) of the lining's thickness. In some brakes round-off turns
triangles of TRIANGLE_MESHES_FOR_PRESSED_TIP inside out. Then TRIANGLE_MESHES_FOR_PRESSED_CORNER is
used for a tip as well. The uncertainty of the pressure is then 1e-4 to 6e-4, in place of 1e-5 to
2e-4.
"""

POWER_LAW_LENGTH_OVER_CONTACT_LENGTH = 2e-3
"""Length of the region next to a pressed corner, divided by the length of the contact. In this
region the power law of the corner's pressure replaces the computed pressure.

Some ten triangles lie in this region. A region with 14 triangles changed the pressure by 5e-6 and
4e-5 (relative) on two brakes.
"""

LEAST_USABLE_TRUE_ERROR_OVER_ITS_UNCERTAINTY = 4.0
"""Smallest ratio of a true error to its uncertainty. With a smaller ratio the true error is not
used to judge the stated error.

The difference between answer and truth may then be an error of the truth.
"""

SIGNIFICANT_DIGITS_OF_STORED_PRESSURES = 10
"""Significant digits with which pressures are stored. Their uncertainty is 1e-7 at best."""


class StoredTruth(NamedTuple):
    """A brake with its far finer solution, as a file stores both.

    Attributes
    ----------
    covers : the kind of brakes for which this brake is an example, in words
    brake : the brake
    by : the solver of the far finer solution, in words
    true : the far finer solution with its uncertainty
    """

    covers: str
    brake: Brake
    by: str
    true: FarFinerSolutionOfBrake


class KindSeedAndChangesOfStoredBrake(NamedTuple):
    """How a stored brake is drawn: kind and seed of a random brake, and changed values.

    Attributes
    ----------
    covers : the kind of brakes for which this brake is an example, in words
    kind, seed : kind and seed of a random brake
    changes : values of the brake file that replace values of the random brake, by key
    """

    covers: str
    kind: str
    seed: int
    changes: Mapping[str, Any] = {}

    def brake(self) -> Brake:
        """The random brake of `kind` and `seed`, with the values of `changes`."""
        drawn = (
            draw_random_brake
            if self.kind in DRAWN_KINDS
            else draw_random_brake_pressing_with_corner_or_kink
            if self.kind in CORNERS
            else draw_random_brake_of_support_kind
        )
        found = drawn(self.seed, self.kind)
        return vary(found, dict(self.changes)) if self.changes else found


FIRST_SEED_OF_STORED_BRAKES = 70_000
"""Seed of the first random brake of each kind.

The safety factors of the error estimate are fitted on brakes of other seeds, from
`calibration.FIRST_SEED` on. The stored brakes are therefore an independent test of these factors.
"""

CLEARANCE_TABLE_WITH_TIP = ((1.756715664026018, 1e-5), (2.3, 0.0), (3.440991216768881, 1.5e-5))
"""Clearance table with a tip, a kink that points to the drum, for the brake
`draw_random_brake_of_support_kind(FIRST_SEED_OF_STORED_BRAKES + 1, "hinge")`.

The rows are an angle theta [rad] and a clearance [m]. The tip is in the middle row. The gaps at the
ends are about as large as the lining's compression by the force. Therefore nearly the whole lining
presses on the drum.
"""

HOW_STORED_BRAKES_ARE_DRAWN_BY_FILE_NAME: dict[str, KindSeedAndChangesOfStoredBrake] = {
    "arc": KindSeedAndChangesOfStoredBrake(
        "elastic arc on a hinge, partial contact", "arc", FIRST_SEED_OF_STORED_BRAKES + 0
    ),
    "arc_second": KindSeedAndChangesOfStoredBrake(
        "elastic arc on a hinge", "arc", FIRST_SEED_OF_STORED_BRAKES + 1
    ),
    "arc_incompressible": KindSeedAndChangesOfStoredBrake(
        "Poisson's ratio 0.49",
        "arc",
        FIRST_SEED_OF_STORED_BRAKES + 2,
        {"shoe[0].lining.material.nu": 0.49},
    ),
    "arc_stiff_friction": KindSeedAndChangesOfStoredBrake(
        "elastic arc, much friction", "arc", FIRST_SEED_OF_STORED_BRAKES + 3
    ),
    "backed_corner": KindSeedAndChangesOfStoredBrake(
        "lining on a backing, pressed with its corner: unbounded p at the lining's end",
        "backed",
        FIRST_SEED_OF_STORED_BRAKES + 0,
    ),
    "backed": KindSeedAndChangesOfStoredBrake(
        "lining on a backing", "backed", FIRST_SEED_OF_STORED_BRAKES + 1
    ),
    "rigid": KindSeedAndChangesOfStoredBrake(
        "rigid shoe", "rigid", FIRST_SEED_OF_STORED_BRAKES + 0
    ),
    "rigid_second": KindSeedAndChangesOfStoredBrake(
        "rigid shoe", "rigid", FIRST_SEED_OF_STORED_BRAKES + 2
    ),
    "post": KindSeedAndChangesOfStoredBrake(
        "straight post with a block", "post", FIRST_SEED_OF_STORED_BRAKES + 0
    ),
    "post_second": KindSeedAndChangesOfStoredBrake(
        "straight post with a block", "post", FIRST_SEED_OF_STORED_BRAKES + 1
    ),
    "post_on_free_ring": KindSeedAndChangesOfStoredBrake(
        "post on an elastic ring with a free rim, no friction",
        "post on ring",
        FIRST_SEED_OF_STORED_BRAKES + 1,
    ),
    "post_on_fixed_ring": KindSeedAndChangesOfStoredBrake(
        "post on an elastic ring with a fixed rim", "post on ring", FIRST_SEED_OF_STORED_BRAKES + 2
    ),
    "arc_on_fixed_ring": KindSeedAndChangesOfStoredBrake(
        "arc on an elastic ring with a fixed rim", "arc on ring", FIRST_SEED_OF_STORED_BRAKES + 1
    ),
    "arc_on_free_ring": KindSeedAndChangesOfStoredBrake(
        "arc on an elastic ring with a free rim", "arc on ring", FIRST_SEED_OF_STORED_BRAKES + 2
    ),
    "linings_on_fixed_ring": KindSeedAndChangesOfStoredBrake(
        "two shoes on one elastic ring with a fixed rim",
        "linings on ring",
        FIRST_SEED_OF_STORED_BRAKES + 2,
    ),
    "linings_on_free_ring": KindSeedAndChangesOfStoredBrake(
        "two shoes on one elastic ring with a free rim",
        "linings on ring",
        FIRST_SEED_OF_STORED_BRAKES + 3,
    ),
    "blocks": KindSeedAndChangesOfStoredBrake(
        "lining of three blocks of unlike height on a post",
        "misfit",
        FIRST_SEED_OF_STORED_BRAKES + 0,
    ),
    "clearance_table": KindSeedAndChangesOfStoredBrake(
        "clearance given as a table of two rows", "misfit", FIRST_SEED_OF_STORED_BRAKES + 1
    ),
    "radius_without_friction": KindSeedAndChangesOfStoredBrake(
        "lining ground to another radius, no friction", "misfit", FIRST_SEED_OF_STORED_BRAKES + 2
    ),
    "clearance": KindSeedAndChangesOfStoredBrake(
        "even clearance under a post", "misfit", FIRST_SEED_OF_STORED_BRAKES + 3
    ),
    "clearance_arc": KindSeedAndChangesOfStoredBrake(
        "even clearance under an arc, much friction", "misfit", FIRST_SEED_OF_STORED_BRAKES + 4
    ),
    "radius": KindSeedAndChangesOfStoredBrake(
        "lining ground to another radius, on a post", "misfit", FIRST_SEED_OF_STORED_BRAKES + 5
    ),
    "out_of_round": KindSeedAndChangesOfStoredBrake(
        "drum out of round", "out of round", FIRST_SEED_OF_STORED_BRAKES + 0
    ),
    "out_of_round_second": KindSeedAndChangesOfStoredBrake(
        "drum out of round, an opening in the contact",
        "out of round",
        FIRST_SEED_OF_STORED_BRAKES + 1,
    ),
    "short_contact": KindSeedAndChangesOfStoredBrake(
        "short contact of a lining of another radius",
        "small contact",
        FIRST_SEED_OF_STORED_BRAKES + 0,
        {"friction": 0.2},
    ),
    "short_contact_second": KindSeedAndChangesOfStoredBrake(
        "short contact of a lining of another radius",
        "small contact",
        FIRST_SEED_OF_STORED_BRAKES + 3,
    ),
    "extreme": KindSeedAndChangesOfStoredBrake(
        "stiffnesses and thicknesses far apart",
        "extreme",
        FIRST_SEED_OF_STORED_BRAKES + 0,
        {"friction": 0.2},
    ),
    "hinge": KindSeedAndChangesOfStoredBrake(
        "drum brake shoe on a hinge", "hinge", FIRST_SEED_OF_STORED_BRAKES + 0
    ),
    "tip": KindSeedAndChangesOfStoredBrake(
        "tip of the gap towards the drum",
        "hinge",
        FIRST_SEED_OF_STORED_BRAKES + 1,
        {"shoe[0].lining.clearance": CLEARANCE_TABLE_WITH_TIP},
    ),
    "abutment": KindSeedAndChangesOfStoredBrake(
        "shoe that slides on an abutment", "abutment", FIRST_SEED_OF_STORED_BRAKES + 0
    ),
    "rough_abutment": KindSeedAndChangesOfStoredBrake(
        "shoe on an abutment with friction", "rough abutment", FIRST_SEED_OF_STORED_BRAKES + 2
    ),
    "pivot": KindSeedAndChangesOfStoredBrake(
        "shoe on a pivot of a lever", "pivot", FIRST_SEED_OF_STORED_BRAKES + 0
    ),
    "guide": KindSeedAndChangesOfStoredBrake(
        "shoe in a guide", "guide", FIRST_SEED_OF_STORED_BRAKES + 1
    ),
    "cylinder": KindSeedAndChangesOfStoredBrake(
        "two shoes under a wheel cylinder", "cylinder", FIRST_SEED_OF_STORED_BRAKES + 0
    ),
    "cam": KindSeedAndChangesOfStoredBrake(
        "two shoes under an S-cam", "cam", FIRST_SEED_OF_STORED_BRAKES + 0
    ),
    "cam_second": KindSeedAndChangesOfStoredBrake(
        "two shoes under an S-cam", "cam", FIRST_SEED_OF_STORED_BRAKES + 1
    ),
    "strut": KindSeedAndChangesOfStoredBrake(
        "two shoes joined by a strut", "strut", FIRST_SEED_OF_STORED_BRAKES + 0
    ),
    "pad_on_a_hinge": KindSeedAndChangesOfStoredBrake(
        "pad on a plane, on a hinge", "pad on a hinge", FIRST_SEED_OF_STORED_BRAKES + 1
    ),
    "pad_on_a_pivot": KindSeedAndChangesOfStoredBrake(
        "pad on a plane, on a pivot", "pad on a pivot", FIRST_SEED_OF_STORED_BRAKES + 1
    ),
    "pad_on_a_guide": KindSeedAndChangesOfStoredBrake(
        "pad on a plane, in a guide", "pad on a guide", FIRST_SEED_OF_STORED_BRAKES + 0
    ),
    "pad_on_an_abutment": KindSeedAndChangesOfStoredBrake(
        "pad on a plane, on an abutment", "pad on an abutment", FIRST_SEED_OF_STORED_BRAKES + 2
    ),
    "table": KindSeedAndChangesOfStoredBrake(
        "T-section: table and web", "table", FIRST_SEED_OF_STORED_BRAKES + 0
    ),
    "table_second": KindSeedAndChangesOfStoredBrake(
        "T-section: table and web", "table", FIRST_SEED_OF_STORED_BRAKES + 1
    ),
    "grip": KindSeedAndChangesOfStoredBrake(
        "body held over a length of its back", "grip", FIRST_SEED_OF_STORED_BRAKES + 0
    ),
    "chain": KindSeedAndChangesOfStoredBrake(
        "blocks linked by straps", "chain", FIRST_SEED_OF_STORED_BRAKES + 0
    ),
    "corner_little_friction": KindSeedAndChangesOfStoredBrake(
        "rigid shoe that presses with a corner",
        "corner of a rigid shoe",
        FIRST_SEED_OF_STORED_BRAKES + 0,
    ),
    "corner_dragged_inwards": KindSeedAndChangesOfStoredBrake(
        "corner that friction drags into the lining: p as x^-0.21",
        "corner of a rigid shoe",
        FIRST_SEED_OF_STORED_BRAKES + 1,
        {"friction": 0.2, "shoe[0].actuation.force": 708.0},
    ),
    "corner_dragged_outwards": KindSeedAndChangesOfStoredBrake(
        "elastic shoe that presses with its trailing corner",
        "corner",
        FIRST_SEED_OF_STORED_BRAKES + 3,
    ),
    "tip_short": KindSeedAndChangesOfStoredBrake(
        "short contact under a tip of the gap",
        "tip of a rigid shoe",
        FIRST_SEED_OF_STORED_BRAKES + 1,
    ),
}
"""The brakes whose far finer solutions are stored, by the name of the file without its suffix."""


def solve_stored_brake_on_far_finer_meshes(name: str) -> StoredTruth:
    """Solve a stored brake on far finer meshes than `solve` uses.

    A brake that presses only by a corner of the lining or by a kink that points to the drum is
    solved on the meshes TRIANGLE_MESHES_FOR_PRESSED_CORNER or TRIANGLE_MESHES_FOR_PRESSED_TIP.
    Other brakes are solved by triangles. If triangles do not apply or have no answer, the brakes
    are solved by finer hp elements. Raises NoAnswer where no solver has an answer.
    """
    drawn = HOW_STORED_BRAKES_ARE_DRAWN_BY_FILE_NAME[name]
    brake = drawn.brake()
    if drawn.kind in CORNERS:
        return StoredTruth(
            drawn.covers,
            brake,
            "deep triangles",
            solve_brake_on_corner_or_kink_by_fine_triangles(brake),
        )
    # Triangles are preferred, because their method shares no part with the hp elements that are
    # judged.
    try:
        if brake.surface.is_plane_and_not_drum:
            raise BadInput("triangles have no brakes on a plane")
        by, true = "triangles", solve_brake_by_fine_triangles(brake)
    except (BadInput, NoAnswer):
        by, true = "finer hp elements", solve_brake_by_finer_hp_meshes(brake)
    return StoredTruth(drawn.covers, brake, by, true)


def solve_brake_by_fine_triangles(brake: Brake) -> FarFinerSolutionOfBrake:
    """The far finer solution of a brake on a drum by the last three meshes of triangles.

    Raises BadInput if triangles cannot mesh the brake, and NoAnswer if the brake has no solution.
    """
    begin = time.process_time()
    return reference_from_last_three_meshes(
        brake,
        triangles.solve_brake_on_sequence_of_triangle_meshes(
            brake, TRIANGLE_MESHES_OF_STORED_TRUTH
        )[-3:],
        begin,
    )


def solve_brake_on_corner_or_kink_by_fine_triangles(brake: Brake) -> FarFinerSolutionOfBrake:
    """The far finer solution of a brake that presses only by a corner or a tip of the lining.

    A tip is a kink of the lining that points to the drum. The meshes are
    TRIANGLE_MESHES_FOR_PRESSED_TIP for a tip and TRIANGLE_MESHES_FOR_PRESSED_CORNER for a corner.
    Next to a corner in contact the pressure has no bound, and no triangle is small enough for it. A
    power law replaces the computed pressure next to the corner. The error of this power law is
    added to the uncertainty. Raises BadInput if triangles cannot mesh the brake, and NoAnswer if
    the brake has no solution.
    """
    begin = time.process_time()
    # An AssertionError means that round-off has turned triangles of TRIANGLE_MESHES_FOR_PRESSED_TIP
    # inside out.
    try:
        sharp = any(clearance.gap_kinks_that_point_to_drum(shoe.lining) for shoe in brake.shoes)
        meshes = triangles.solve_brake_on_sequence_of_triangle_meshes(
            brake, TRIANGLE_MESHES_FOR_PRESSED_TIP if sharp else TRIANGLE_MESHES_FOR_PRESSED_CORNER
        )
    except AssertionError:
        meshes = triangles.solve_brake_on_sequence_of_triangle_meshes(
            brake, TRIANGLE_MESHES_FOR_PRESSED_CORNER
        )
    found = []
    for solutions in meshes:
        corrected = [
            _shoe_solution_with_power_law_at_corner(brake, i, one)
            for i, one in enumerate(solutions)
        ]
        found.append(corrected)
    true = reference_from_last_three_meshes(brake, found, begin)
    left = max(
        remaining_pressure_error_at_lining_corners(brake, i, one) for i, one in enumerate(found[-1])
    )
    return replace(true, unsure={**true.unsure, "pressure": true.unsure["pressure"] + left})


def _shoe_solution_with_power_law_at_corner(
    brake: Brake, index: int, found: ShoeSolution
) -> ShoeSolution:
    """The solution of shoe `index`, with a power law in place of its pressure near each corner.

    Only corners with an unbounded pressure are changed.
    """
    # The power law replaces the pressure over a fixed fraction of the contact arc that ends at the
    # corner.
    for corner in corners_with_unbounded_pressure(brake, index, found):
        at_corner = found.theta[0 if corner.at_start else -1]
        arc = next((float(b - a) for a, b in found.arcs if at_corner in {a, b}), 0.0)
        theta, pressure = nodes_and_pressures_with_power_law_at_corner(
            found.theta,
            found.pressure,
            found.order,
            corner,
            reach=POWER_LAW_LENGTH_OVER_CONTACT_LENGTH * arc,
        )
        found = replace(found, theta=theta, pressure=pressure)
    return found


def solve_brake_by_finer_hp_meshes(brake: Brake) -> FarFinerSolutionOfBrake:
    """The far finer solution of a brake by HP_MESHES_OF_STORED_TRUTH, with exact contact.

    Raises NoAnswer where a mesh has no answer.
    """
    begin = time.process_time()
    answers = solve_brake_on_finer_and_finer_mesh_levels(
        brake, partial(solve_prepared_model, penalty=math.inf), levels=HP_MESHES_OF_STORED_TRUTH
    )
    found = [step.response.shoes for step in answers]
    if len(found) < len(HP_MESHES_OF_STORED_TRUTH):
        raise NoAnswer(
            f"only {len(found)} of {len(HP_MESHES_OF_STORED_TRUTH)} divisions have an answer"
        )
    return reference_from_last_three_meshes(
        brake, found, begin, largest_round_off_errors_of_shoes(found[-1])
    )


def stored_fine_solution_as_json(stored: StoredTruth) -> str:
    """A brake and its far finer solution as the text of a JSON file.

    Numbers are in SI units, pressures have SIGNIFICANT_DIGITS_OF_STORED_PRESSURES significant
    digits.
    """
    data = {
        "covers": stored.covers,
        "by": stored.by,
        "seconds": round(stored.true.seconds, 1),
        "uncertainty": {name: float(f"{value:.3g}") for name, value in stored.true.unsure.items()},
        "brake": stored.brake.model_dump(mode="json", by_alias=True, exclude_none=True),
        "shoes": [_shoe_solution_as_plain_data(shoe) for shoe in stored.true.shoes],
    }
    return json.dumps(data) + "\n"


def _shoe_solution_as_plain_data(shoe: Solved) -> dict[str, Any]:
    """The solution of a shoe as plain data for JSON."""
    return {
        "order": shoe.order,
        "torque": shoe.torque,
        "normal_force": shoe.normal_force,
        "hinge_reaction": [float(part) for part in shoe.hinge_reaction],
        "theta": [float(f"{angle:.17g}") for angle in shoe.theta],
        "pressure": [
            float(f"{p:.{SIGNIFICANT_DIGITS_OF_STORED_PRESSURES}g}") for p in shoe.pressure
        ],
    }


def read_stored_fine_solution(path: Path) -> StoredTruth:
    """The brake and its far finer solution in a file that `main` wrote."""
    data = json.loads(path.read_text(encoding="utf-8"))
    shoes = [_shoe_solution_from_plain_data(shoe) for shoe in data["shoes"]]
    true = FarFinerSolutionOfBrake(shoes, data["uncertainty"], data["seconds"])
    return StoredTruth(
        data["covers"], make_drum_or_plane_brake_from_data(data["brake"]), data["by"], true
    )


def _shoe_solution_from_plain_data(data: Mapping[str, Any]) -> ShoeSolution:
    """The solution of a shoe from the plain data that `_shoe_solution_as_plain_data` made.

    Contact arcs and number of unknowns are not stored.
    """
    return ShoeSolution(
        theta=np.array(data["theta"]),
        pressure=np.array(data["pressure"]),
        order=data["order"],
        torque=data["torque"],
        normal_force=data["normal_force"],
        hinge_reaction=np.array(data["hinge_reaction"]),
        arcs=np.zeros((0, 2)),
        unknowns=0,
    )


def main(folder: str, *names: str) -> None:
    """Solve stored brakes on far finer meshes than `solve` uses, and write their files.

    folder : folder of the files; names : names of the brakes, by default all of
        HOW_STORED_BRAKES_ARE_DRAWN_BY_FILE_NAME.
    """
    for name in names or HOW_STORED_BRAKES_ARE_DRAWN_BY_FILE_NAME:
        stored = solve_stored_brake_on_far_finer_meshes(name)
        write_text(Path(folder) / f"{name}.json", stored_fine_solution_as_json(stored))
        unsure = ", ".join(
            f"{quantity} {value:.1e}" for quantity, value in stored.true.unsure.items()
        )
        sys.stdout.write(
            f"{name}: by {stored.by} in {stored.true.seconds:.0f} s; uncertainty: {unsure}\n"
        )
        sys.stdout.flush()


if __name__ == "__main__":
    main(*sys.argv[1:])
