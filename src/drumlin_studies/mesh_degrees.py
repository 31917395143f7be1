"""Compare the errors that drumlin states for mesh files with true errors.

    make degrees              60 meshes
    make degrees ARGS="8 100" 8 meshes, from seed 100 on
    make degrees ARGS="8 100 rows.jsonl"

The third form also appends a row for each mesh to the file rows.jsonl. It skips seeds whose rows
the file already has, so that a long comparison can be made piece by piece.

Gmsh meshes random shoes with elements of a tenth to a hundredth of the drum's radius: triangles or
quadrilaterals recombined from them, of first to third order, with straight or curved sides, graded
or not, with all digits of the coordinates or rounded. drumlin solves each mesh file. It also solves
the same shoe without the file, in hp elements to a tolerance of 1e-4. The difference between the
two responses is the true error. The command prints a line for each mesh and the ratios of stated to
true errors.

On the seeds 553000 to 553399 three stated errors of 1137 are too small: 0.52 of the true error of a
peak, 0.80 and 0.94 of the true errors of two reactions. The medians of stated over true errors are
4.8 for p, 4.5 for its peak, 2.0 for the torque and 1.6 for the reaction. No torque is more than
0.5 % off. On the same seeds and 400 more, with small elements along the whole contact line in place
of its ends, six errors of 2185 were too small.
"""

import json
import math
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.components import ShoeBodyOfConstantSection
from drumlin.brake.file import make_drum_brake_from_data, vary
from drumlin.fem.error_control.estimate import (
    QUANTITIES_WITH_STATED_ERROR,
    relative_differences_of_responses_on_two_levels,
)
from drumlin.fem.solve import solve
from drumlin.response.response import Response

DEFAULT_NUMBER_OF_JUDGED_MESHES = 60
"""Number of meshes if the command line gives no number: eight or nine of each form in
ELEMENT_KINDS_AND_GRADINGS_OF_JUDGED_MESHES.
"""
TOLERANCE_OF_HP_TRUTH = 1e-4
"""Relative tolerance of the solution in hp elements that serves as the truth."""
LEAST_TRUE_ERROR_OVER_HP_STATED_ERROR = 3.0
"""Smallest true error with which a stated error is compared, relative to the stated error of the
solution in hp elements that serves as the truth.

A smaller true error may be an error of this solution instead.
"""
WIDTH_OF_EVERY_RANDOM_SHOE = 0.04
"""Width [m] of lining and body of every random shoe.

In plane stress the width has no influence on the ratios of stated to true errors.
"""


class ElementKindAndGradingOfGmshMesh(NamedTuple):
    """The form of a mesh by Gmsh: kind of its elements, grading, and digits of its coordinates.

    Attributes
    ----------
    order : order of the elements
    straight : whether Gmsh keeps the sides of elements of higher order straight
    recombined : whether triangles are recombined to quadrilaterals
    decimals : number of decimals to which coordinates in mm are rounded; None for all digits
    graded : whether elements at the ends of the contact line are smaller than others
    fine_contact : whether all elements along the contact line are smaller than others
    """

    order: int
    straight: bool
    recombined: bool
    decimals: int | None = None
    graded: bool = False
    fine_contact: bool = False


ELEMENT_KINDS_AND_GRADINGS_OF_JUDGED_MESHES = (
    ElementKindAndGradingOfGmshMesh(1, straight=True, recombined=False),
    ElementKindAndGradingOfGmshMesh(2, straight=False, recombined=False),
    ElementKindAndGradingOfGmshMesh(2, straight=True, recombined=False),
    ElementKindAndGradingOfGmshMesh(1, straight=True, recombined=True),
    ElementKindAndGradingOfGmshMesh(2, straight=False, recombined=True),
    ElementKindAndGradingOfGmshMesh(3, straight=False, recombined=False),
    ElementKindAndGradingOfGmshMesh(3, straight=False, recombined=True),
)
"""The forms of meshes: kinds of elements. The seed modulo the number of forms chooses a mesh's
form.
"""
NUMBERS_OF_COORDINATE_DECIMALS_TO_DRAW_FROM = (None, 2, 3, 4, 5, 6)
"""Numbers of decimals to draw from. For each mesh one number is drawn, to which the coordinates in
mm are rounded.

None stands for all digits.
"""
RANGE_OF_DRUM_RADIUS_OVER_ELEMENT_SIZE = (10.0, 100.0)
"""Smallest and largest ratio of the drum's radius to the size of the elements of a mesh."""
END_ELEMENT_SIZE_OVER_INNER_SIZE = 0.25
"""Size of the elements at both ends of the contact line in a graded mesh, relative to the size in
its middle and in the rest of the shoe.

Between these places Gmsh changes the size in proportion to the distance along a line. It may leave
out the node beside an end, so that the first element there is longer.
"""


class StatedAndTrueErrorsOfMesh(NamedTuple):
    """The stated and the true relative errors of a mesh, by QUANTITIES_WITH_STATED_ERROR.

    Attributes
    ----------
    seed : seed of the random shoe and its mesh
    form : form of the mesh
    size : drum's radius divided by the size of the elements
    stated : stated errors
    true : true errors; nan if uncertain
    """

    seed: int
    form: ElementKindAndGradingOfGmshMesh
    size: float
    stated: Mapping[str, float]
    true: Mapping[str, float]


def draw_random_brake_with_one_shoe(rng: np.random.Generator) -> Brake:
    """Draw a brake with one hinged shoe, whose body reaches a little beyond its lining."""
    R = float(rng.choice([0.1, 0.15, 0.2]))
    side = str(rng.choice(["internal", "internal", "external"]))
    sign = 1 if side == "internal" else -1
    start = -math.radians(rng.uniform(55, 75))
    end = start + math.radians(rng.uniform(50, 125))
    thickness, depth = R * rng.uniform(0.04, 0.1), R * rng.uniform(0.06, 0.2)
    before, behind = np.radians(rng.uniform(3, 8, size=2)).tolist()
    middle = R - sign * (thickness + depth / 2)
    closing = (start + end) / 2 + (0 if sign > 0 else math.pi)
    loaded = end + behind
    body: dict[str, Any] = {"start": start - before, "end": loaded, "thickness": depth}
    body["width"] = WIDTH_OF_EVERY_RANDOM_SHOE
    body["material"] = {"E": float(rng.choice([20e9, 100e9, 210e9])), "nu": 0.3}
    lining: dict[str, Any] = {
        "start": start,
        "end": end,
        "thickness": thickness,
        "width": WIDTH_OF_EVERY_RANDOM_SHOE,
    }
    lining["material"] = {"E": float(rng.choice([100e6, 300e6, 1e9])), "nu": 0.25}
    hinge = {
        "radius": middle * rng.uniform(0.9 if sign > 0 else 0.97, 1.05 if sign > 0 else 1.1),
        "angle": start - before - math.radians(rng.uniform(0, 8)),
    }
    actuation = {
        "force": 2000.0,
        "direction": closing + math.radians(rng.uniform(-20, 20)),
        "point": {"x": middle * math.cos(loaded), "y": middle * math.sin(loaded)},
    }
    shoe = {"name": "shoe", "side": side, "hinge": hinge, "lining": lining, "body": body}
    data = {
        "title": "random shoe for a mesh",
        "rotation": str(rng.choice(["clockwise", "counter-clockwise"])),
        "friction": float(rng.choice([0.2, 0.3, 0.4])),
        "drum": {"radius": R},
        "shoe": [shoe | {"actuation": actuation}],
    }
    return make_drum_brake_from_data(data)


def write_gmsh_mesh_of_shoe(
    brake: Brake, form: ElementKindAndGradingOfGmshMesh, size: float, path: Path
) -> None:
    """Mesh the only shoe of a drum brake with Gmsh, and write the mesh file with lengths in mm.

    The file has the named groups of elements that drumlin needs.

    Parameters
    ----------
    brake : the brake, whose shoe has lining and body
    form : form of the mesh
    size : size of the elements [m]
    path : path of the .msh file
    """
    import gmsh  # noqa: PLC0415

    gmsh.initialize(readConfigFiles=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.option.setNumber("Mesh.RecombineAll", form.recombined)
        gmsh.option.setNumber("Mesh.SecondOrderLinear", form.straight)
        _add_shoe_outline_to_gmsh_model(gmsh.model, brake, form, size)
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(form.order)
        tags, xyz, _ = gmsh.model.mesh.getNodes()
        for tag, place in zip(tags, 1e3 * xyz.reshape(-1, 3), strict=True):
            rounded = place if form.decimals is None else place.round(form.decimals)
            gmsh.model.mesh.setNode(tag, rounded, [])
        gmsh.write(str(path))
    finally:
        gmsh.finalize()


def _add_shoe_outline_to_gmsh_model(
    model: Any, brake: Brake, form: ElementKindAndGradingOfGmshMesh, size: float
) -> None:
    """Draw lining and body of a shoe in Gmsh's `model`, with the groups that drumlin needs.

    `size` is the size of most elements [m]. The form of the mesh tells where they are smaller.
    """
    (shoe,) = brake.shoes
    lining, body = shoe.lining, shoe.body
    assert isinstance(body, ShoeBodyOfConstantSection)
    geo = model.geo
    centre = geo.addPoint(0, 0, 0)
    points: dict[tuple[float, float], int] = {}

    def add_point_at_depth_and_angle(depth: float, angle: float) -> int:
        """The tag of the point at a depth [m] behind the friction surface and an angle [rad]."""
        r = brake.size - shoe.sign_internal_plus_external_minus * depth
        if (depth, angle) not in points:
            # A size of 0 leaves the size to Gmsh.
            is_end = depth == 0 and angle in (lining.start, lining.end)
            is_fine = is_end and (form.graded or form.fine_contact)
            own = END_ELEMENT_SIZE_OVER_INNER_SIZE * size if is_fine else 0
            points[depth, angle] = geo.addPoint(r * math.cos(angle), r * math.sin(angle), 0, own)
        return points[depth, angle]

    def add_arc_between_angles(depth: float, first: float, last: float) -> int:
        """Add the arc at a depth [m] between two angles [rad], and return its tag."""
        return int(
            geo.addCircleArc(
                add_point_at_depth_and_angle(depth, first),
                centre,
                add_point_at_depth_and_angle(depth, last),
            )
        )

    def add_radial_line_between_depths(angle: float, top: float, bottom: float) -> int:
        """Add the radial line at an angle [rad] between two depths [m], and return its tag."""
        return int(
            geo.addLine(
                add_point_at_depth_and_angle(top, angle),
                add_point_at_depth_and_angle(bottom, angle),
            )
        )

    behind, back = lining.thickness, lining.thickness + body.total_thickness
    # A graded contact line has a point in its middle. Gmsh would otherwise give the size of the
    # elements at the two ends to the whole line.
    angles = [lining.start, lining.end]
    if form.graded:
        angles.insert(1, (lining.start + lining.end) / 2)
    contact = [add_arc_between_angles(0.0, first, last) for first, last in pairwise(angles)]
    face = add_arc_between_angles(behind, lining.start, lining.end)
    sides = [
        add_radial_line_between_depths(angle, 0.0, behind) for angle in (lining.start, lining.end)
    ]
    near, far = (
        add_radial_line_between_depths(angle, behind, back) for angle in (body.start, body.end)
    )
    front = [
        add_arc_between_angles(behind, body.start, lining.start),
        face,
        add_arc_between_angles(behind, lining.end, body.end),
    ]
    rear = add_arc_between_angles(back, body.start, body.end)
    surfaces = {
        "lining": geo.addPlaneSurface([geo.addCurveLoop([*contact, sides[1], -face, -sides[0]])]),
        "shoe": geo.addPlaneSurface([geo.addCurveLoop([*front, far, -rear, -near])]),
    }
    geo.synchronize()
    for name, surface in surfaces.items():
        model.setPhysicalName(2, model.addPhysicalGroup(2, [surface]), name)
    for name, lines in {"contact": contact, "hinge": [near], "actuation": [far]}.items():
        model.setPhysicalName(1, model.addPhysicalGroup(1, lines), name)


def draw_random_mesh_size_decimals_and_grading(
    rng: np.random.Generator, form: ElementKindAndGradingOfGmshMesh
) -> tuple[float, ElementKindAndGradingOfGmshMesh]:
    """Draw the element size, the decimals and the grading of a mesh.

    Returns the drum's radius divided by the size of the elements, and the form with the drawn
    decimals and grading.
    """
    coarsest, finest = RANGE_OF_DRUM_RADIUS_OVER_ELEMENT_SIZE
    size = coarsest * (finest / coarsest) ** rng.random()
    decimals = NUMBERS_OF_COORDINATE_DECIMALS_TO_DRAW_FROM[
        rng.integers(len(NUMBERS_OF_COORDINATE_DECIMALS_TO_DRAW_FROM))
    ]
    return float(size), form._replace(decimals=decimals, graded=bool(rng.random() < 0.5))


def judge_mesh_of_random_shoe(seed: int) -> StatedAndTrueErrorsOfMesh | str:
    """The stated and true errors of the mesh of a seed, or the reason why there are none."""
    rng = np.random.default_rng([seed, 3])
    size, form = draw_random_mesh_size_decimals_and_grading(
        rng,
        ELEMENT_KINDS_AND_GRADINGS_OF_JUDGED_MESHES[
            seed % len(ELEMENT_KINDS_AND_GRADINGS_OF_JUDGED_MESHES)
        ],
    )
    try:
        brake = draw_random_brake_with_one_shoe(rng)
        known = solve(brake, tolerance=TOLERANCE_OF_HP_TRUTH)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "shoe.msh"
            write_gmsh_mesh_of_shoe(brake, form, brake.size / size, path)
            response = solve(vary(brake, {"shoe.mesh": str(path), "shoe.mesh_unit": "mm"}))
    except (BadInput, NoAnswer) as error:
        return f"{type(error).__name__}: {error}"
    return StatedAndTrueErrorsOfMesh(
        seed,
        form,
        size,
        dict(response.error or {}),
        _true_relative_errors_of_response(brake, response, known),
    )


def _true_relative_errors_of_response(
    brake: Brake, response: Response, known: Response
) -> dict[str, float]:
    """The true relative errors of a response: its differences from `known`, by quantity.

    An error is nan if it is at most LEAST_TRUE_ERROR_OVER_HP_STATED_ERROR times the stated error of
    `known`.
    """
    steps = relative_differences_of_responses_on_two_levels(brake, response, known).differences[1:]
    assert known.error is not None
    errors = dict(zip(QUANTITIES_WITH_STATED_ERROR, steps.tolist(), strict=True))
    return {
        name: error
        if error > LEAST_TRUE_ERROR_OVER_HP_STATED_ERROR * known.error[name]
        else math.nan
        for name, error in errors.items()
    }


def report_lines_on_judged_meshes(judged: Sequence[StatedAndTrueErrorsOfMesh]) -> Iterator[str]:
    """Yield a line of text for each quantity: its ratios of stated to true error."""
    for name in QUANTITIES_WITH_STATED_ERROR:
        ratios = np.array([mesh.stated[name] / mesh.true[name] for mesh in judged if mesh.stated])
        ratios = ratios[np.isfinite(ratios)]
        if not len(ratios):
            yield f"{name}: no error to judge"
            continue
        yield (
            f"{name}: stated over true error: least {ratios.min():.2f}, median "
            f"{np.median(ratios):.2f}, {np.count_nonzero(ratios < 1)} of {len(ratios)} too small"
        )


def write_row_of_judged_mesh(path: Path, seed: int, found: StatedAndTrueErrorsOfMesh | str) -> None:
    """Append the row of a seed to the file `path`, as a line of JSON.

    `found` is the judged mesh, or the reason why there is none.
    """
    if isinstance(found, str):
        row: dict[str, Any] = {"seed": seed, "reason": found}
    else:
        row = found._asdict() | {"form": found.form._asdict()}
    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps(row) + "\n")


def read_rows_of_judged_meshes(path: Path) -> dict[int, StatedAndTrueErrorsOfMesh | str]:
    """The judged meshes of the file `path` by their seeds, or the reasons why there are none.

    A file that does not exist has no rows.
    """
    rows: dict[int, StatedAndTrueErrorsOfMesh | str] = {}
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    for row in map(json.loads, lines):
        if "reason" in row:
            rows[row["seed"]] = row["reason"]
        else:
            rows[row["seed"]] = StatedAndTrueErrorsOfMesh(
                **row | {"form": ElementKindAndGradingOfGmshMesh(**row["form"])}
            )
    return rows


def report_line_of_judged_mesh(seed: int, found: StatedAndTrueErrorsOfMesh | str) -> str:
    """The line of text on the mesh of a seed, or on the reason why there is none."""
    if isinstance(found, str):
        return f"{seed}: {found}"
    errors = ", ".join(
        f"{name} {found.stated.get(name, math.nan):.1e} {found.true[name]:.1e}"
        for name in QUANTITIES_WITH_STATED_ERROR
    )
    return f"{seed}: R/{found.size:.0f}, {found.form}: {errors}"


def main(words: Sequence[str]) -> int:
    """Judge meshes and print their errors.

    The `words` are the number of meshes, the first seed and the file of rows. All are optional.
    """
    count, first = [int(word) for word in words[:2]] + [DEFAULT_NUMBER_OF_JUDGED_MESHES, 0][
        len(words[:2]) :
    ]
    path = Path(words[2]) if len(words) > 2 else None
    rows = {} if path is None else read_rows_of_judged_meshes(path)
    for seed in range(first, first + count):
        if seed in rows:
            continue
        rows[seed] = judge_mesh_of_random_shoe(seed)
        print(report_line_of_judged_mesh(seed, rows[seed]), flush=True)  # noqa: T201
        if path is not None:
            write_row_of_judged_mesh(path, seed, rows[seed])
    judged = [found for found in rows.values() if isinstance(found, StatedAndTrueErrorsOfMesh)]
    for line in report_lines_on_judged_meshes(judged):
        print(line, flush=True)  # noqa: T201
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
