"""The figures of the study of sweeps."""

from collections.abc import Mapping, Sequence
from operator import attrgetter

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from drumlin.report.figures import (
    MATPLOTLIB_SETTINGS_FOR_PRINT,
    draw_legend_below_figure,
    make_figure_for_print,
)
from drumlin.report.palette import BLUE, GREEN, INK, OCHRE
from drumlin_studies.throughput import MeasuredTimeOfSweep, torques_of_solved_sweep_cases

COLORS = {"processes": BLUE, "Dask workers": OCHRE, "Dask workers that keep memory": GREEN}


def draw_throughput(measured: Mapping[str, Sequence[MeasuredTimeOfSweep]]) -> Figure:
    """Cases a second as bars, a panel for each sweep."""
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(2.6)
        for axes, (name, those) in zip(figure.subplots(1, 2), measured.items(), strict=True):
            for place, one in enumerate(those):
                axes.bar(
                    place,
                    one.solved_sweep_cases_per_second,
                    color=COLORS[one.by],
                    width=0.62,
                    label=one.by if one.workers == 1 else None,
                )
                axes.annotate(
                    f"{one.solved_sweep_cases_per_second:.3g}",
                    (place, one.solved_sweep_cases_per_second),
                    ha="center",
                    va="bottom",
                    xytext=(0, 2),
                    textcoords="offset points",
                )
            axes.set_xticks(range(len(those)), list(map(str, map(attrgetter("workers"), those))))
            axes.set_xlabel("workers")
            axes.set_title(name)
            axes.set_ylabel("throughput [cases/s]")
            axes.set_ylim(0, 1.25 * max(map(attrgetter("solved_sweep_cases_per_second"), those)))
            axes.grid(visible=False, axis="x")
        draw_legend_below_figure(figure, figure.axes[0])
    return figure


def draw_torque_distributions(measured: Mapping[str, Sequence[MeasuredTimeOfSweep]]) -> Figure:
    """Distribution of the torque, a panel for each sweep.

    Lines show the median and the 2.5 and 97.5 percentiles.
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(2.6)
        panels = figure.subplots(1, 2, sharex=True)
        for axes, (name, those), color in zip(panels, measured.items(), (BLUE, GREEN), strict=True):
            drawn = torques_of_solved_sweep_cases(those[0].rows)
            axes.hist(drawn, bins="auto", color=color, alpha=0.75)
            for percent in (2.5, 50, 97.5):
                axes.axvline(
                    np.percentile(drawn, percent),
                    color=INK,
                    lw=1,
                    ls="-" if percent == 50 else "--",
                )
            axes.set_title(f"{name.partition(':')[0]}, {len(drawn)} cases")
            axes.set_xlabel("torque [N m]")
            axes.set_ylabel("cases")
    return figure
