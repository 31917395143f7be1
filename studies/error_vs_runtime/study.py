"""Which model or mesh is enough for an accuracy, and how long a solve takes.

Errors stand against run times on every brake.
"""

import time
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any, NamedTuple

from studies.error_vs_runtime.brakes import (
    MAIN,
    brakes_from_stiff_to_soft,
    brakes_with_elements,
    brakes_with_omissions,
)
from studies.error_vs_runtime.figures import draw_error_over_time, draw_predicted_changes
from studies.error_vs_runtime.solid import compute_solid_comparisons, draw_error_against_solid

from drumlin.base.files import write_text
from drumlin.base.journal import JournalOfCaseResults
from drumlin.brake.brake import Brake
from drumlin.brake.file import read_brake
from drumlin.comparison import table_as_csv_text
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.preparation.meshes import DEFAULT_ELEMENTS_ALONG_LINING
from drumlin.fem.solve import solve
from drumlin.report.figures import (
    save_figure,
    save_figure_as_files,
    save_figure_for_page_and_column,
)
from drumlin.report.page import software_versions, write_html_page
from drumlin.verification import triangles
from drumlin.verification.reference import (
    MESHES_OF_PUBLISHED_REFERENCE_VALUES,
    MeshesOfReferenceValues,
    ResponsesBehindReferenceValues,
    compute_reference_values,
    solve_brake_for_reference_values,
)
from drumlin.verification.reference_file import (
    reference_values_as_json_data,
    rows_that_summarise_reference_values,
    write_reference_file,
)
from drumlin_studies.methods import list_solution_methods_to_compare
from drumlin_studies.omission_table import (
    predicted_over_true_changes_by_omission,
    row_of_largest_pressure_change_by_straight_edges,
    saved_time_ranges_by_omission,
    table_rows_for_each_part_omitted_from_brake,
)
from drumlin_studies.recommendation import (
    compare_times_with_peer_programs,
    fastest_solve_times_within_error,
    method_rows_of_brake_with_given_name,
    recommended_methods_by_brake_and_target,
    rows_of_fastest_methods_by_target,
)
from drumlin_studies.tables import rows_with_given_values, values_of_key_in_rows
from drumlin_studies.work_precision import (
    LEAST_REPEATS_OF_TIMING,
    PEER_KEYS_BY_NAME_IN_TABLES,
    SolutionMethodOfBrake,
    measure_drumlin_method_on_brake,
    measure_peer_program_on_brake,
    median_relative_scatter_of_timings,
    median_seconds_of_unit_workload,
    relative_uncertainties_of_reference_responses,
    wall_seconds_of_solve_command,
)

HERE = Path(__file__).parent
UNIT_ELEMENTS = 20
"""Elements along a lining of the solve whose time is the unit of all times."""
SHORT = ("double_shoe/brake", "laws/shigley_16_2")
"""Brakes of the short setting."""
WITH_PEERS = ("double_shoe/brake", "double_shoe/flexible")
"""Brakes that are solved by other programs as well."""
QUICK = MeshesOfReferenceValues(
    2,
    (REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1], REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[2]),
    triangles.TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE[:2],
)
"""Refinement of the references in the short setting."""

Row = dict[str, Any]


class Result(NamedTuple):
    """Everything that the report shows.

    Attributes
    ----------
    rows : list of dict
        A row for each method on each brake.
    floors, references : dict
        Uncertainty and values of the reference of each brake.
    refused : dict
        Why a brake is not in the study, by brake.
    left_out : list of dict
        Rows of omissions.
    solid : dict
        Rows of all models against solid shoes, and the uncertainty of this truth, by brake.
    unit : float
        The unit of time [s].
    seconds : float
        Run time of the study [s].
    """

    rows: list[Row]
    floors: dict[str, dict[str, float]]
    references: dict[str, dict[str, Any]]
    refused: dict[str, str]
    left_out: list[Row]
    solid: dict[str, Row]
    unit: float
    seconds: float


def study(
    *,
    short: bool = False,
    say: Callable[[str], None] = lambda _: None,
    journal: JournalOfCaseResults | None = None,
) -> Result:
    """Solve every brake by every method, each a case of the journal.

    short : whether two brakes, fewer sizes and coarser references are enough.
    """
    start = time.perf_counter()
    journal = journal or JournalOfCaseResults()
    paths, refused = brakes_with_elements()
    paths = {name: path for name, path in paths.items() if not short or name in SHORT}
    # The brakes with peers take longest and come first.
    order = sorted(paths, key=lambda name: name not in WITH_PEERS)
    paths = {name: paths[name] for name in order}
    # The unit is solved once before, so that loading of code is not timed.
    unit = partial(solve, read_brake(MAIN), elements=UNIT_ELEMENTS)
    unit()
    rows, floors, references = [], {}, {}
    for name, path in paths.items():
        brake = read_brake(path)
        # The reference is computed when a method first needs it.
        trio = cache(
            partial(
                solve_brake_for_reference_values,
                read_brake(path),
                QUICK if short else MESHES_OF_PUBLISHED_REFERENCE_VALUES,
            )
        )
        say(f"{name}: reference")
        known = journal.get_or_compute_case_result(
            {"brake": name, "reference": True}, partial(_reference_row, name, path, brake, trio)
        )
        floors[name], references[name] = known["floor"], known["values"]
        peers = name in WITH_PEERS and not short
        for method in list_solution_methods_to_compare(brake, peers=peers, short=short):
            say(f"{name}: {method.family}, {method.name}")
            row = journal.get_or_compute_case_result(
                {"brake": name, **method.journal_key_of_solve_method},
                partial(_method_row, brake, method, trio, unit),
            )
            # Beside the processes of the peers stands the process of a whole `drumlin solve`.
            if peers and method.family == "columns, error stated":
                case = {"brake": name, "process": row["tolerance"]}
                row = row | journal.get_or_compute_case_result(
                    case, partial(_process_row, path, row["tolerance"])
                )
            rows.append({"brake": name, **row})
    left = _omission_rows(journal, short, say)
    solid = compute_solid_comparisons(journal, say, short=short)
    return Result(
        rows,
        floors,
        references,
        refused,
        left,
        solid,
        median_seconds_of_unit_workload(rows),
        time.perf_counter() - start,
    )


def _reference_row(
    name: str, path: Path, brake: Brake, trio: Callable[[], ResponsesBehindReferenceValues]
) -> Row:
    """The reference of a brake: its floor and its values."""
    command = f"drumlin reference studies/{name}.toml"
    return {
        "floor": relative_uncertainties_of_reference_responses(brake, trio()),
        "values": reference_values_as_json_data(
            compute_reference_values(brake, path.read_text(), command, trio())
        ),
    }


def _method_row(
    brake: Brake,
    method: SolutionMethodOfBrake,
    trio: Callable[[], ResponsesBehindReferenceValues],
    unit: Callable[[], object],
) -> Row:
    """The row of a method on a brake. CalculiX takes long and runs only once."""
    if method.family in PEER_KEYS_BY_NAME_IN_TABLES:
        repeats = 1 if method.family == "CalculiX" else LEAST_REPEATS_OF_TIMING
        return measure_peer_program_on_brake(brake, method, trio().value, unit, repeats)
    return measure_drumlin_method_on_brake(brake, method, trio().value, unit)


def _process_row(path: Path, tolerance: float) -> Row:
    """Time of a whole `drumlin solve` of a brake file to a tolerance."""
    return {"process": wall_seconds_of_solve_command(path, "--tolerance", str(tolerance))}


def _write_solid_files(result: Result, folder: Path) -> dict[str, str]:
    """Write picture and table of each brake against solid shoes; returns the pictures' names."""
    pictures = {}
    for name, found in result.solid.items():
        stem = f"solid_{name.replace('/', '_')}"
        picture = draw_error_against_solid(found["rows"], found["uncertain"])
        save_figure_as_files(picture, folder / stem)
        write_text(folder / f"{stem}.csv", table_as_csv_text(found["rows"]))
        pictures[name] = f"{stem}.svg"
    return pictures


def _omission_rows(
    journal: JournalOfCaseResults, short: bool, say: Callable[[str], None]
) -> list[Row]:
    """The rows of omissions, each brake a case. Brakes from stiff to soft are not timed."""
    cases = [
        (name, brake, 1 if short else 5)
        for name, brake in brakes_with_omissions(short=short).items()
    ]
    cases += [(name, brake, 0) for name, brake in brakes_from_stiff_to_soft(short=short).items()]
    rows: list[Row] = []
    for name, brake, repeats in cases:
        say(f"left out: {name}")
        elements = 40 if short else DEFAULT_ELEMENTS_ALONG_LINING
        rows += journal.get_or_compute_case_result(
            {"left out": name, "short": short},
            lambda b=brake, n=name, e=elements, r=repeats: {
                "rows": table_rows_for_each_part_omitted_from_brake(b, n, elements=e, repeats=r)
            },  # type: ignore[misc]
        )["rows"]
    return rows


def _write_brake_files(result: Result, name: str, folder: Path) -> str:
    """Write figure and reference values of a brake; returns the name of the figure's file."""
    stem = name.replace("/", "_")
    title = result.references[name]["title"]
    own_rows = method_rows_of_brake_with_given_name(result.rows, name)
    save_figure_for_page_and_column(
        partial(draw_error_over_time, title, own_rows, result.floors[name]),
        folder / f"work_precision_{stem}",
    )
    write_reference_file(result.references[name], folder / "values" / f"{stem}.json")
    return f"work_precision_{stem}.svg"


def report(result: Result, folder: Path) -> Path:
    """Write page, figures, tables and reference values, and return the path of the page."""
    rows, floors, left_out = result.rows, result.floors, result.left_out
    best = rows_of_fastest_methods_by_target(rows, floors)
    write_text(folder / "results.csv", table_as_csv_text(rows))
    write_text(folder / "recommended.csv", table_as_csv_text(best))
    write_text(folder / "left_out.csv", table_as_csv_text(left_out))
    pictures = {}
    for name in floors:
        pictures[name] = _write_brake_files(result, name, folder)
    save_figure(draw_predicted_changes(left_out), folder / "left_out.svg")
    times = fastest_solve_times_within_error(rows, floors, 0.01)
    values: list[Row] = []
    for name, of_brake_ in result.references.items():
        values += rows_that_summarise_reference_values(of_brake_, name)
    by_law = rows_with_given_values(rows, status="converged", model="sine")
    ratios = {}
    for key in ("pressure", "shoes", "torque"):
        ratios[key] = predicted_over_true_changes_by_omission(left_out, key)
    failed = []
    for row in rows:
        if row["status"] != "converged":
            failed.append(row)
    peer_rows = []
    for row in rows:
        if row["family"] in PEER_KEYS_BY_NAME_IN_TABLES:
            peer_rows.append(row)
    timed = []
    for row in left_out:
        if "seconds" in row or row["status"] != "converged":
            timed.append(row)
    return write_html_page(
        HERE / "page.html",
        folder / "index.html",
        result=result,
        laws=values_of_key_in_rows(by_law, "torque_error"),
        times=times,
        matrices=recommended_methods_by_brake_and_target(best),
        figures=pictures,
        solid_figures=_write_solid_files(result, folder),
        first=next(iter(floors)),
        first_rows=method_rows_of_brake_with_given_name(rows, next(iter(floors))),
        failed=failed,
        peer_rows=peer_rows,
        peers=compare_times_with_peer_programs(rows, floors),
        timed=timed,
        ratios=ratios,
        saved=saved_time_ranges_by_omission(left_out, 0.2),
        straight=row_of_largest_pressure_change_by_straight_edges(left_out),
        values=values,
        spread=median_relative_scatter_of_timings(rows),
        repeats=LEAST_REPEATS_OF_TIMING,
        unit_elements=UNIT_ELEMENTS,
        versions_text="\n".join(
            f"{name}: {version}" for name, version in software_versions().items()
        ),
    )
