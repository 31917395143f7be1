"""Figures of the rigid-shoe laws.

They show merit over friction, equivalent friction, torque over speed, pressures and drawings.
"""

import math
from collections.abc import Mapping, Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from drumlin.brake.brake import Brake
from drumlin.laws.shapes import (
    SHORT_SHOE_LAW_ON_DRUM,
    ShoeAnglesAndRadii,
    ratio_of_equivalent_to_lining_friction,
)
from drumlin.laws.simscape import DoubleShoe
from drumlin.report.drawing import draw_brake
from drumlin.report.figures import (
    MATPLOTLIB_SETTINGS_FOR_PRINT,
    draw_legend_below_figure,
    make_figure_for_print,
    title_of_model_in_figures,
)
from drumlin.report.palette import (
    BLUE,
    COLOR_OF_AXES_AND_NOTES,
    GREEN,
    GREY,
    PURPLE,
    RED,
    color_and_line_style_of_model,
)
from drumlin.response.response import ShoeResponse

HIGHEST = 4.0  # of eta and S in a figure; both grow without bound towards locking


def draw_brakes_side_by_side(brakes: Sequence[tuple[str, Brake]]) -> Figure:
    """Brakes side by side, each under its title."""
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(3.4)
        for axes, (title, brake) in zip(
            figure.subplots(1, len(brakes), squeeze=False).flat, brakes, strict=True
        ):
            draw_brake(axes, brake)
            axes.set_title(title)
    return figure


def draw_short_shoe_merits(angles: Sequence[float], a_over_r: float, arc: float = 0.02) -> Figure:
    """eta and S of short shoes over mu, for self-energising shoes (dD = +1) and others (dD = -1).

    Each angle theta_m [rad] from the hinge has a line.
    """
    mu = np.linspace(1e-3, 1.2, 600)
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(3.0)
        panels = figure.subplots(1, 2)
        for angle, color in zip(angles, (BLUE, RED, GREEN, PURPLE), strict=False):
            # Full lines are self-energising shoes, dashed lines the others.
            for dD, style in ((1, "-"), (-1, "--")):
                shoe = ShoeAnglesAndRadii(angle - arc, angle + arc, 1.0, a_over_r, dD)
                label = (
                    rf"$\theta_\mathrm{{m}}$ = {math.degrees(angle):.0f}°, $\delta\Delta$ = {dD:+d}"
                )
                for axes, merit in zip(
                    panels,
                    (
                        SHORT_SHOE_LAW_ON_DRUM.torque_over_actuation_moment,
                        SHORT_SHOE_LAW_ON_DRUM.sensitivity_of_braking_effect_to_friction,
                    ),
                    strict=True,
                ):
                    axes.plot(mu, merit(mu, shoe), style, color=color, lw=1.8, label=label)
                # A dotted line marks the friction at which the shoe locks itself.
                mu_lock = float(SHORT_SHOE_LAW_ON_DRUM.self_locking_friction(shoe))
                if mu_lock < mu[-1]:
                    for axes in panels:
                        axes.axvline(mu_lock, color=color, lw=0.8, ls=":")
        for axes, title in zip(
            panels, ("mechanical advantage η = T/M", "sensitivity S = (μ/η) dη/dμ"), strict=True
        ):
            axes.set_title(title)
            axes.set_xlabel("friction coefficient μ")
            axes.set_ylim(0, HIGHEST)
            axes.set_xlim(0, mu[-1])
        draw_legend_below_figure(figure, panels[0])
    return figure


def draw_friction_over_arc() -> Figure:
    """mu'/mu over the arc of a block, for p = p_0 cos and for a uniform pressure."""
    half = np.radians(np.linspace(0.5, 90, 180))
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(3.4)
        axes = figure.subplots()
        axes.plot(
            np.degrees(2 * half),
            ratio_of_equivalent_to_lining_friction(half),
            **color_and_line_style_of_model("cosine"),
            lw=1.8,
            label=r"$p = p_0\,\cos\theta$",
        )
        axes.plot(
            np.degrees(2 * half),
            half / np.sin(half),
            **color_and_line_style_of_model("uniform"),
            lw=1.8,
            label="uniform pressure",
        )
        axes.set_xlabel(r"arc of the lining $2\theta_0$ [deg]")
        axes.set_ylabel(r"friction force $T/R$ over $\mu N$:  $\mu'/\mu$ [–]")
        axes.set_xlim(0, 180)
        axes.set_ylim(1, None)
        draw_legend_below_figure(figure, axes)
    return figure


def draw_torque_over_speed(block: DoubleShoe, forces: Sequence[float], viscous: float) -> Figure:
    """Torque of the double-shoe block over the speed, through zero.

    The dashed line has another coefficient of viscous friction.
    """
    omega = np.linspace(-4, 4, 801) * block.omega_threshold
    # The same block with another coefficient of viscous friction.
    sticky = DoubleShoe(**{**vars(block), "mu_visc": viscous})
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(3.4)
        axes = figure.subplots()
        for force, color in zip(forces, (GREY, GREEN, BLUE, RED), strict=False):
            axes.plot(
                omega, block.torque(force, omega), color=color, lw=1.8, label=f"F = {force:g} N"
            )
            axes.plot(omega, sticky.torque(force, omega), "--", color=color, lw=1.2)
        # Below the threshold of the speed the torque changes linearly.
        for side in (-1, 1):
            axes.axvline(
                side * block.omega_threshold, color=COLOR_OF_AXES_AND_NOTES, lw=0.8, ls=":"
            )
        axes.set_xlabel("speed ω [rad/s]; dotted: ± threshold")
        axes.set_ylabel("torque T [N m]")
        draw_legend_below_figure(
            figure, axes, title=rf"dashed: $\mu_\mathrm{{visc}}$ = {viscous:g} N m s/rad"
        )
    return figure


def draw_pressures_by_law(shoes: Mapping[str, ShoeResponse]) -> Figure:
    """Pressure by several laws over the angle, and its shape over the place along the lining.

    `shoes`: {law: response of one shoe}; the law "linear" of a plane is drawn only as a shape.
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(3.0)
        left, right = figure.subplots(1, 2)
        for law, shoe in shoes.items():
            look = {
                **color_and_line_style_of_model(law),
                "lw": 1.8,
                "label": title_of_model_in_figures(law),
            }
            theta, p = shoe.curve()
            # A plane has no angle, so that its law is drawn only as a shape.
            if law != "linear":
                left.plot(np.degrees(theta), p * 1e-6, **look)
            # The shape: p over its mean, against the place along the lining from 0 to 1.
            place = (theta - theta[0]) / np.ptp(theta)
            right.plot(place, p / np.trapezoid(p, place), **look)
        left.set_title("under the same force")
        left.set_xlabel("angle on the drum θ [deg]")
        left.set_ylabel("pressure p [MPa]")
        right.set_title("shapes: p over its mean")
        right.set_xlabel("place along the lining, 0 to 1")
        right.set_ylabel("p / mean [–]")
        for axes in (left, right):
            axes.set_ylim(0, None)
        draw_legend_below_figure(figure, right)
    return figure
