"""Change of a brake's torque by misfit and tolerances, before and after running in."""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from studies.misfit import figures
from studies.misfit.tolerances import assumed_tolerances, nominal_brake

from drumlin.base.arrays import Floats
from drumlin.base.files import write_text
from drumlin.base.journal import JournalOfCaseResults
from drumlin.brake.brake import Brake
from drumlin.brake.clearance import (
    lining_circle_offsets_towards_hinge_by_key,
    lining_radii_by_key_for_radius_mismatch,
)
from drumlin.brake.file import read_brake, vary
from drumlin.comparison import table_as_csv_text
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.laws import solve_brake_by_sine_law
from drumlin.lining_wear.run_in import DEFAULT_WEAR_COEFFICIENT
from drumlin.lining_wear.worn_in import brake_with_worn_in_clearances
from drumlin.report import figures as drawing
from drumlin.report.page import write_html_page
from drumlin.response.response import Response
from drumlin.sweeps import cases as sweep
from drumlin.sweeps.cases import CaseResultsByName, SweepCase
from drumlin.sweeps.table import table_lines_of_cases, write_table_file
from drumlin.sweeps.tolerances import (
    FirstAndTotalSobolIndexOfTolerance,
    ManufacturingTolerance,
    cases_with_random_deviations,
    draw_deviations_for_all_sobol_samples,
    sobol_indices_of_tolerances,
    torque_and_peak_during_run_in,
    values_of_named_result_in_all_cases,
)
from drumlin.sweeps.workers import provide_workers_for_cases_of_sweep
from drumlin_studies import misfit_rows
from drumlin_studies.misfit_rows import (
    LINING_STATES_OF_RANDOM_BRAKES,
    QUANTITIES_SHOWN_OVER_RANDOM_BRAKES,
    ResultsOfRandomBrakesWithTolerances,
)
from drumlin_studies.tables import values_of_key_in_rows

HERE = Path(__file__).parent
BRAKE = HERE.parent / "double_shoe" / "brake.toml"
AMPLITUDE = 20e-6
"""Amplitude of the drum's lobes in the figure of one turn [m]."""
FAMILY = (-100.0, -50.0, -20.0, 0.0, 20.0, 50.0, 100.0)
"""Radius of the lining less that of the drum in the figure of pressures [um]."""
SIDES = 150e-6, 100e-6
"""Largest difference of the radii, and largest offset of the lining, in the maps [m]."""
DISTANCES = (
    0.0,
    0.1,
    0.2,
    0.5,
    1.0,
    2.0,
    5.0,
    10.0,
    20.0,
    50.0,
    100.0,
    200.0,
)
"""Sliding distances of running in [1/(k K)]."""
HEALED = 0.02
"""Percentiles count as settled if they differ from the last by less than this fraction.
"""
SEED = 20
"""Seed of the draws from the tolerances."""


@dataclass(frozen=True)
class Setting:
    """How fine the meshes are, and how many brakes are solved.

    Attributes
    ----------
    elements, fine : int
        Elements along a lining, of drawn brakes and of single brakes.
    draws : int
        Size of each sample, a power of 2.
    wide, high : int
        Points of the maps over both quantities.
    angles : int
        Angles of one turn of the drum.
    healed : int
        Number of brakes that run in.
    jobs : int or None
        Number of processes; None for one a core.
    """

    elements: int
    fine: int
    draws: int
    wide: int
    high: int
    angles: int
    healed: int
    jobs: int | None


FULL, SHORT = Setting(40, 160, 512, 31, 21, 96, 192, None), Setting(24, 24, 8, 7, 5, 24, 6, 1)


@dataclass(frozen=True)
class Result:
    """All results that the report of this study shows."""

    brake: Brake
    law: Response
    single: list[dict[str, Any]]
    family: dict[float, Response]
    sides: tuple[Floats, Floats]
    ratios: dict[str, Floats]
    angles: Floats
    turns: dict[str, dict[str, Floats]]
    tolerances: tuple[ManufacturingTolerance, ...]
    deviates: Floats
    rows: dict[str, list[CaseResultsByName]]
    shares: dict[str, dict[str, list[FirstAndTotalSobolIndexOfTolerance]]]
    healed: dict[str, Floats]
    unit: float
    seconds: float

    @property
    def drawn(self) -> ResultsOfRandomBrakesWithTolerances:
        """The brakes that are drawn from the tolerances."""
        return ResultsOfRandomBrakesWithTolerances(self.rows, self.deviates.shape[1])


def study(
    *,
    short: bool = False,
    say: Callable[[str], None] = lambda _: None,
    journal: JournalOfCaseResults | None = None,
) -> Result:
    """Compute single misfits, maps, a turn of the drum, tolerances and running in.

    short : trial run with coarser meshes and fewer brakes.
    """
    start = time.perf_counter()
    setting = SHORT if short else FULL
    journal = JournalOfCaseResults() if journal is None else journal
    elements = setting.elements
    brake = nominal_brake(read_brake(BRAKE))
    law = solve_brake_by_sine_law(brake)
    scene = make_prepared_model(brake, elements=setting.fine)
    say("single misfits")
    single = misfit_rows.table_rows_of_changes_due_to_each_misfit_alone(
        brake, law, lambda changed: solve_prepared_model(scene, changed)
    )
    family = {}
    for dr in FAMILY:
        family[dr] = solve_prepared_model(
            scene, vary(brake, lining_radii_by_key_for_radius_mismatch(brake, dr * 1e-6))
        )
    # Torque over one turn of a drum with lobes, with new and with worn-in linings.
    angles = np.linspace(0, 2 * math.pi, setting.angles, endpoint=False)
    turns = {
        state: misfit_rows.torques_at_angles_of_lobed_drum(
            stood, lambda turned: solve_prepared_model(scene, turned), AMPLITUDE, angles.tolist()
        )
        for state, stood in (
            ("new", brake),
            ("worn in", brake_with_worn_in_clearances(scene, brake)),
        )
    }
    tolerances = assumed_tolerances(brake)
    deviates = draw_deviations_for_all_sobol_samples(tolerances, setting.draws, SEED)
    # The axes of the maps.
    sides = (
        np.linspace(-SIDES[0], SIDES[0], setting.wide),
        np.linspace(-SIDES[1], SIDES[1], setting.high),
    )
    with provide_workers_for_cases_of_sweep(setting.jobs) as (pool, workers):

        def solve(what: str, several: Sequence[SweepCase]) -> list[CaseResultsByName]:
            """The rows of some cases, solved by the workers and kept in the journal."""
            return sweep.solve_all_cases_of_sweep(
                several,
                executor=pool,
                workers=workers,
                journal=journal,
                done=lambda finished, of: say(f"{what}: {finished} of {of}"),
            )

        found = solve("radius and offset", _cases_of_map(brake, sides, elements))
        rows = _rows_of_drawn_brakes(brake, tolerances, deviates, elements, solve)
    # The sliding distance 1/(k K), with the stiffness K of the lining.
    lining = brake.shoes[0].lining
    unit = 1 / (DEFAULT_WEAR_COEFFICIENT * (lining.material.E_through / lining.thickness))
    run_in_cases = cases_with_random_deviations(brake, tolerances, deviates[0, : setting.healed])
    healed = _run_in_brakes(run_in_cases, unit, elements, journal, say)
    return Result(
        brake=brake,
        law=law,
        single=single,
        family=family,
        sides=sides,
        ratios=misfit_rows.maps_of_relative_deviation_from_law(
            found, brake, law, (setting.high, setting.wide)
        ),
        angles=angles,
        turns=turns,
        tolerances=tolerances,
        deviates=deviates,
        rows=rows,
        shares=_sobol_indices_by_state(tolerances, rows),
        healed=healed,
        unit=unit,
        seconds=time.perf_counter() - start,
    )


def _cases_of_map(brake: Brake, sides: tuple[Floats, Floats], elements: int) -> list[SweepCase]:
    """The brakes of the maps: an offset of the linings in each row, a radius in each column.

    Parameters
    ----------
    brake : the nominal brake
    sides : differences of the radii, and offsets of the linings [m]
    elements : along each lining
    """
    cases = []
    for offset in sides[1]:
        for radius in sides[0]:
            changes = lining_radii_by_key_for_radius_mismatch(
                brake, radius
            ) | lining_circle_offsets_towards_hinge_by_key(brake, offset)
            cases.append(SweepCase(brake, changes, options={"elements": elements}))
    return cases


def _rows_of_drawn_brakes(
    brake: Brake,
    tolerances: tuple[ManufacturingTolerance, ...],
    deviates: Floats,
    elements: int,
    solve: Callable[[str, Sequence[SweepCase]], list[CaseResultsByName]],
) -> dict[str, list[CaseResultsByName]]:
    """The rows of the brakes drawn from the tolerances: new, worn in, and by the sine law.

    Parameters
    ----------
    brake : the nominal brake
    tolerances : the tolerances of its manufacture
    deviates : samples of the deviates, as from `draw_deviations_for_all_sobol_samples`
    elements : along each lining
    solve : solves cases under a name that the progress shows
    """
    new = cases_with_random_deviations(brake, tolerances, deviates, elements=elements)
    worn = cases_with_random_deviations(
        brake, tolerances, deviates, elements=elements, worn_in=True
    )
    # The law needs only the two independent samples: it has no Sobol indices.
    by_law = cases_with_random_deviations(brake, tolerances, deviates[:2], "sine")
    return {
        "new": solve("new brakes", new),
        "worn in": solve("worn-in brakes", worn),
        "law": solve("sine law", by_law),
    }


def _run_in_brakes(
    cases: Sequence[SweepCase],
    unit: float,
    elements: int,
    journal: JournalOfCaseResults,
    say: Callable[[str], None],
) -> dict[str, Floats]:
    """Torque [N m] and peak pressure [Pa] (brakes, distances) of brakes that run in.

    Parameters
    ----------
    cases : the brakes as cases of a sweep
    unit : sliding distance 1/(k K) [m], whose multiples are DISTANCES
    elements : along each lining
    journal : keeps the row of each brake
    say : told the progress in a line
    """
    rows = []
    for i, case in enumerate(cases):
        say(f"run-in: {i} of {len(cases)}")

        def wear(case: SweepCase = case) -> dict[str, Any]:
            """Torque and peak pressure of one brake at all DISTANCES."""
            brake = vary(case.brake, case.changes)
            distances = []
            for s in DISTANCES:
                distances.append(s * unit)
            return torque_and_peak_during_run_in(brake, distances, elements=elements)

        key = {"healing": dict(case.changes), "elements": elements}
        rows.append(journal.get_or_compute_case_result(key, wear))
    healed = {}
    for name in ("torque", "peak_pressure"):
        healed[name] = np.array(values_of_key_in_rows(rows, name))
    return healed


def _sobol_indices_by_state(
    tolerances: tuple[ManufacturingTolerance, ...], rows: dict[str, list[CaseResultsByName]]
) -> dict[str, dict[str, list[FirstAndTotalSobolIndexOfTolerance]]]:
    """The Sobol indices of each quantity, for new and for worn-in brakes."""
    indices: dict[str, dict[str, list[FirstAndTotalSobolIndexOfTolerance]]] = {}
    for state in LINING_STATES_OF_RANDOM_BRAKES:
        indices[state] = {}
        for name in QUANTITIES_SHOWN_OVER_RANDOM_BRAKES:
            # One row for each of the samples A, B and AB_1 to AB_d.
            values = values_of_named_result_in_all_cases(rows[state], name).reshape(
                len(tolerances) + 2, -1
            )
            indices[state][name] = sobol_indices_of_tolerances(tolerances, values, seed=SEED)
    return indices


def report(result: Result, folder: Path) -> Path:
    """Write page, figures and tables, and return the path of the page."""
    drawn, nominal_values = (
        result.drawn,
        misfit_rows.quantities_of_nominal_brake_by_law(result.brake, result.law),
    )
    made = {
        "pressure": figures.draw_pressures_of_radii(result.law, result.family),
        "map": figures.draw_ratio_maps(result.sides, result.ratios),
        "turn": figures.draw_torque_over_turn(result.angles, result.turns, result.law.torque),
        "shares": figures.draw_sobol_indices(result.shares),
        "run_in": figures.draw_percentiles_over_distance(
            np.array(DISTANCES), result.healed, nominal_values
        ),
    }
    for name, figure in made.items():
        endings = ("svg", "png") if name == "map" else ("svg",)
        drawing.save_figure_as_files(figure, folder / name, endings)
    drawing.save_figure_for_page_and_column(
        partial(figures.draw_histograms, drawn, nominal_values), folder / "distribution"
    )
    spreads = misfit_rows.rows_with_mean_and_percentiles_of_quantities(drawn)
    ranked = misfit_rows.rows_of_sobol_indices_by_tolerance(result.tolerances, result.shares)
    for name, lines in (("single", result.single), ("spread", spreads), ("shares", ranked)):
        write_text(folder / f"{name}.csv", table_as_csv_text(lines))
    for state, rows in result.rows.items():
        several = cases_with_random_deviations(
            result.brake, result.tolerances, result.deviates[: len(rows) // drawn.n]
        )
        write_table_file(
            table_lines_of_cases(several, rows), folder / f"cases_{state.replace(' ', '_')}.csv"
        )
    return write_html_page(
        HERE / "page.html",
        folder / "index.html",
        result=result,
        drawn=drawn,
        peaks=drawn.mean_and_95th_percentile_of_relative_peak_pressure(
            nominal_values["peak_pressure"]
        ),
        healed_after=misfit_rows.sliding_distance_until_torque_settles(
            DISTANCES, result.healed["torque"], HEALED
        ),
        healed_within=HEALED,
        spreads=spreads,
        ranked=ranked,
        valleys={
            state: misfit_rows.torque_ranges_over_mean_torque(series)
            for state, series in result.turns.items()
        },
        amplitude=AMPLITUDE,
    )
