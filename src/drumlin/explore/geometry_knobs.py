"""The sliders of the page for the shape of a brake on a drum: radius, arc, hinges, thicknesses.

Each slider starts at the brake of the file. The sliders of arc and hinges change all shoes by the
same angle or length. The sliders of thicknesses change all shoes in proportion.
"""

import math
from collections.abc import Callable

import numpy as np

from drumlin.brake.brake import Brake
from drumlin.brake.components import ShoeBodyOfConstantSection
from drumlin.explore.knob import (
    BrakeSlider,
    NewValuesByBrakeFileKey,
    linings_by_brake_file_key,
    nearest_1_2_or_5_times_power_of_ten,
    rounded_brake_file_text_of_angle,
)

LARGEST_LINING_END_SHIFT_BY_SLIDER = 10.0
"""Largest angle [deg] by which a slider moves each end of a lining.

The horizontal axis of the pressure curves on the page has room for linings that are longer by this
angle.
"""

LARGEST_RELATIVE_RADIUS_CHANGE_BY_SLIDER = 0.1
"""Largest change of the drum's radius by its slider, relative to the radius of the file.

The picture of the brake keeps its scale, and has room for a drum that is larger by this fraction.
"""


def geometry_sliders_for_brake(brake: Brake) -> tuple[BrakeSlider, ...]:
    """The sliders for the shape of a brake; none on a plane or with mesh files of shoes."""
    if brake.surface.is_plane_and_not_drum or any(shoe.mesh for shoe in brake.shoes):
        return ()
    linings, bodies = {}, {}
    for key, lining in linings_by_brake_file_key(brake).items():
        if lining.thickness:
            linings[f"{key}.thickness"] = lining.thickness
    for i, shoe in enumerate(brake.shoes):
        if isinstance(shoe.body, ShoeBodyOfConstantSection):
            bodies[f"shoe[{i}].body.thickness"] = shoe.body.thickness
    knobs = (
        _drum_radius_slider(brake),
        _lining_arc_slider(brake),
        _hinge_radius_slider(brake),
        _thickness_slider("lining-thickness", "thickness of the lining", linings),
        _thickness_slider("shoe-thickness", "thickness of the shoe", bodies),
    )
    return tuple(knob for knob in knobs if knob is not None)


def _drum_radius_slider(brake: Brake) -> BrakeSlider:
    """The slider of the drum's radius [mm]; linings and shoes move with the drum, hinges stay."""
    R = brake.size * 1e3

    def new_drum_radius_at_slider_value(value: float) -> NewValuesByBrakeFileKey:
        """The change of the drum's radius [m] to `value` [mm].

        `brake_at_slider_setting` changes the radii of the linings by the same length.
        """
        return {"drum.radius": value * 1e-3}

    return BrakeSlider(
        name="radius",
        label="radius of the drum",
        unit="mm",
        low=(1 - LARGEST_RELATIVE_RADIUS_CHANGE_BY_SLIDER) * R,
        high=(1 + LARGEST_RELATIVE_RADIUS_CHANGE_BY_SLIDER) * R,
        step=nearest_1_2_or_5_times_power_of_ten(R / 1000),
        start=R,
        changes=new_drum_radius_at_slider_value,
    )


def _lining_arc_slider(brake: Brake) -> BrakeSlider:
    """The slider that lengthens the lining of each shoe by the same angle [deg] at both ends."""

    def new_lining_end_angles_at_slider_value(value: float) -> NewValuesByBrakeFileKey:
        """New end angles of all shoes' linings, which become longer by `value` [deg] at both ends.

        Where a shoe has several linings, only the outermost ends move: the gaps between them stay.
        """
        made: NewValuesByBrakeFileKey = {}
        for i, shoe in enumerate(brake.shoes):
            parts = shoe.lining.linings
            last = len(parts) - 1
            first_key, last_key = (
                (f"shoe[{i}].lining[0]", f"shoe[{i}].lining[{last}]")
                if last
                else (f"shoe[{i}].lining",) * 2
            )
            by = math.radians(value)
            made[f"{first_key}.start"] = rounded_brake_file_text_of_angle(parts[0].start - by)
            made[f"{last_key}.end"] = rounded_brake_file_text_of_angle(parts[last].end + by)
        return made

    return BrakeSlider(
        name="arc",
        label="lining longer at each end by",
        unit="deg",
        low=-LARGEST_LINING_END_SHIFT_BY_SLIDER,
        high=LARGEST_LINING_END_SHIFT_BY_SLIDER,
        step=0.5,
        start=0.0,
        changes=new_lining_end_angles_at_slider_value,
    )


def _hinge_radius_slider(brake: Brake) -> BrakeSlider | None:
    """The slider that moves all hinges away from the drum's centre [mm]; None without hinges."""
    hinges = {
        f"shoe[{i}].hinge": shoe.hinge.xy
        for i, shoe in enumerate(brake.shoes)
        if shoe.hinge is not None and np.linalg.norm(shoe.hinge.xy) > 0
    }
    if not hinges:
        return None
    reach = nearest_1_2_or_5_times_power_of_ten(brake.size * 1e3 / 5)

    def new_hinge_points_at_slider_value(value: float) -> NewValuesByBrakeFileKey:
        """New points of all hinges, moved away from the drum's centre by `value` [mm]."""
        made: NewValuesByBrakeFileKey = {}
        for key, xy in hinges.items():
            x, y = xy * (1 + value * 1e-3 / np.linalg.norm(xy))
            made[key] = {"x": float(x), "y": float(y)}
        return made

    return BrakeSlider(
        name="hinge",
        label="hinge farther from the centre by",
        unit="mm",
        low=-reach,
        high=reach,
        step=reach / 50,
        start=0.0,
        changes=new_hinge_points_at_slider_value,
    )


def _thickness_slider(name: str, label: str, given: dict[str, float]) -> BrakeSlider | None:
    """The slider of a thickness [mm], from half to twice the thickness in the brake file.

    `given` holds the thicknesses [m] in the file by their keys. If `given` is empty, the result is
    None. Where the thicknesses differ, the slider shows the largest, and all change in proportion.
    """
    if not given:
        return None
    start = max(given.values()) * 1e3
    proportional: Callable[[float], NewValuesByBrakeFileKey] = lambda value: {  # noqa: E731
        key: thickness * value / start for key, thickness in given.items()
    }
    return BrakeSlider(
        name=name,
        label=label if len(set(given.values())) == 1 else f"{label}, the largest",
        unit="mm",
        low=0.5 * start,
        high=2 * start,
        step=nearest_1_2_or_5_times_power_of_ten(start / 200),
        start=start,
        changes=proportional,
    )
