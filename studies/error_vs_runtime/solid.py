"""All models against solid shoes: the cases of the journal, the picture and the table."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drumlin.base.journal import JournalOfCaseResults
from drumlin.brake.file import read_brake
from drumlin.report.figures import (
    COLUMN_WIDTH,
    MATPLOTLIB_SETTINGS_FOR_PRINT,
    make_figure_for_print,
)
from drumlin.report.palette import (
    BLUE,
    COLOR_OF_SHADED_AREAS,
    GREEN,
    GREY,
    INK,
    OCHRE,
    PURPLE,
    RED,
    SKY,
)
from drumlin_studies.solid_work import (
    SettingsOfSolidComparisonSolves,
    measure_models_against_solid_shoes,
    relative_uncertainty_of_solid_shoe_reference,
    solve_fine_reference_of_solid_shoes,
)

STUDIES = Path(__file__).parents[1]
ONE_WIDTH = SettingsOfSolidComparisonSolves(3, 3, (2, 3, 4), (2e-2, 1e-2, 3e-3), (8, 16, 24))
"""Setting for a brake of one width, whose solves are fast."""
T_SECTION = SettingsOfSolidComparisonSolves(2, 2, (2, 3, 4), (5e-2, 2e-2), (8, 16, 24))
"""Setting for shoes with table and web. The second level takes seconds there."""
SHORT = SettingsOfSolidComparisonSolves(2, 1, (2,), (2e-2,), ())
"""Setting of the short study."""
BRAKES = {"double_shoe/brake": ONE_WIDTH, "plane_stress/brake": T_SECTION}
"""Brakes that are solved as solids, with their settings."""
FAMILIES = {
    "law": ("laws", GREY, "X", ""),
    "foundation": ("elastic foundation", GREEN, "P", ""),
    "degree 0": ("plane stress", BLUE, "o", "-"),
    "degree 2": ("solid, degree 2", OCHRE, "s", "-"),
    "degree 3": ("solid, degree 3", RED, "^", "-"),
    "degree 4": ("solid, degree 4", PURPLE, "v", "-"),
    "error stated": ("solid, error stated", INK, "*", ""),
    "CalculiX": ("CalculiX", SKY, "D", "--"),
}
"""Name in the key, colour, marker and line of each family of models."""
PANELS = {"plane": "compared with plane stress", "solid": "compared with the solid shoe"}
"""Title of the panel of each truth."""
ERROR_LABELS = {"pressure": "error of mean p (L2) [%]", "torque": "error of torque [%]"}
LOWEST = 0.5
"""Smallest error that is drawn, over the uncertainty of the solid truth."""

Row = dict[str, Any]


def compute_solid_comparisons(
    journal: JournalOfCaseResults, say: Callable[[str], None], *, short: bool
) -> dict[str, Row]:
    """The rows of all models and the uncertainty of the solid truth, by brake.

    Parameters
    ----------
    journal : finished cases
    say : is called with a line of text on the progress
    short : whether one brake and few solves are enough
    """
    found = {}
    for name, setting in BRAKES.items():
        if short and name != next(iter(BRAKES)):
            continue

        def compute(
            name: str = name, setting: SettingsOfSolidComparisonSolves = SHORT if short else setting
        ) -> Row:
            """The solid truth of the brake, and all models against it."""
            brake = read_brake(STUDIES / f"{name}.toml")
            say(f"{name}: solid truth")
            truth = solve_fine_reference_of_solid_shoes(brake, setting.truth)
            rows = measure_models_against_solid_shoes(brake, setting, truth.response, say)
            return {
                "title": brake.title,
                "uncertain": relative_uncertainty_of_solid_shoe_reference(brake, truth),
                "rows": [row._asdict() for row in rows],
            }

        found[name] = journal.get_or_compute_case_result(
            {"brake": name, "solid": True, "short": short}, compute
        )
    return found


def draw_error_against_solid(
    rows: Sequence[Mapping[str, Any]], uncertain: Mapping[str, float], key: str = "pressure"
) -> Figure:
    """Error of all models over run time: against plane stress above, against the solid below.

    The figure is as wide as a column of text.

    Parameters
    ----------
    rows : rows of `measure_models_against_solid_shoes`, as mappings
    uncertain : uncertainty of the solid truth
    key : "pressure" or "torque"
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(5.4, COLUMN_WIDTH)
        grid = figure.subplots(2, 1, sharex=True, sharey=True)
        for axes, (truth, title) in zip(grid, PANELS.items(), strict=True):
            lowest = 100 * LOWEST * uncertain[key] if truth == "solid" else 0.0
            _draw_errors_against_truth(axes, rows, f"{truth}_{key}", lowest)
            axes.set_title(title)
            axes.set_ylabel(ERROR_LABELS[key])
        grid[1].axhspan(
            50 * LOWEST * uncertain[key],
            100 * uncertain[key],
            color=COLOR_OF_SHADED_AREAS,
            alpha=0.7,
            lw=0,
            label="uncertainty of the solid",
        )
        grid[1].set_xlabel("run time of a cold solve [ms]")
        handles, labels = grid[1].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=2)
    return figure


def _draw_errors_against_truth(
    axes: Axes, rows: Sequence[Mapping[str, Any]], key: str, lowest: float
) -> None:
    """Draw the errors `key` of each family; errors below `lowest` [%] are drawn there."""
    for family, (name, color, marker, line) in FAMILIES.items():
        own = [row for row in rows if row["family"] == family]
        if not own:
            continue
        x = [1e3 * row["seconds"] for row in own]
        y = [max(100 * row[key], lowest) for row in own]
        axes.plot(x, y, marker=marker, ls=line, color=color, ms=4, lw=1.1, label=name)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.xaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.minorticks_off()
