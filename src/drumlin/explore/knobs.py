"""The sliders of the page for friction, loads, clearance, misfit, wear and moduli.

The positions of all sliders, called a setting, are turned into a changed brake and into a link.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple
from urllib.parse import urlencode

import numpy as np

from drumlin.base.round_numbers import four_round_numbers_around_value
from drumlin.base.texts import printable_single_line
from drumlin.brake import vary
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import BeamBody
from drumlin.brake.drive import DriveOfAllShoes
from drumlin.explore.geometry_knobs import geometry_sliders_for_brake
from drumlin.explore.knob import (
    BrakeSlider,
    NewValuesByBrakeFileKey,
    linings_by_brake_file_key,
    nearest_1_2_or_5_times_power_of_ten,
    rounded_brake_file_text_of_angle,
    value_with_all_numbers_rounded,
)
from drumlin.fem.width.functions import has_parts_of_different_widths
from drumlin.fem.width.prepare import reason_why_width_model_does_not_apply
from drumlin.lining_wear.run_in import DEFAULT_WEAR_COEFFICIENT
from drumlin.models import applicable_models

SMALLEST_RELATIVE_REACH_OF_WEAR_SLIDER = 50.0
"""Sliding distance that the slider of wear reaches at least, as a multiple of 1/(k K).

k is the wear coefficient, and K = E/t the stiffness of the lining in the brake file. After some 46
times 1/(k K) the pressure of a stiff brake no longer changes. The slider ends at the next round
number of kilometres.
"""

SMALLEST_STEP_OF_FRICTION_SLIDER = 0.005
"""Smallest change of friction by its slider; at usual friction a step changes the torque by 2 %."""

MAX_CHARACTERS_OF_EXPLORE_PAGE_LINK = 2000
"""Largest number of characters of a link that the server reads; all sliders take some 170."""


class _DriveSliderLabelAndUnit(NamedTuple):
    """The label of a slider for a cylinder or cam, its unit on the page, and one unit in SI."""

    label: str
    unit: str
    factor: float


CYLINDER_AND_CAM_SLIDER_LABELS_AND_UNITS = {
    "pressure": _DriveSliderLabelAndUnit("pressure of the cylinder", "MPa", 1e6),
    "force": _DriveSliderLabelAndUnit("force of the cam", "kN", 1e3),
    "torque": _DriveSliderLabelAndUnit("torque of the cam", "N m", 1.0),
    "chamber.pressure": _DriveSliderLabelAndUnit("pressure in the chamber", "bar", 1e5),
}
"""Label and unit of the slider of a cylinder or cam.

The keys of this table are the keys by which a brake file gives the actuation, such as "pressure".
"""


@dataclass(frozen=True)
class SliderSetting:
    """A setting of the page: slider positions, sense of motion, model of the elements, and law.

    Attributes
    ----------
    sense : sense of the motion, one of `Brake.directions`
    law : name of the law shown beside the finite elements; None: no law
    values : value of each slider that is not at the brake file's value, by the slider's name
    model : "fem" for plane stress, "solid" for shoes with their widths
    """

    sense: str
    law: str | None
    values: Mapping[str, float] = field(default_factory=dict)
    model: str = "fem"

    def value(self, knob: BrakeSlider) -> float:
        """The value of a slider in its unit; the brake file's value if the slider is not moved."""
        return self.values.get(knob.name, knob.start)

    def setting_with_slider_moved(self, knob: BrakeSlider, value: float) -> "SliderSetting":
        """A copy of the setting with one slider moved to a value [unit of the slider]."""
        values = dict(self.values)
        values.pop(knob.name, None)
        # A slider at the value of the brake file has no entry, so that the link stays short.
        if abs(value - knob.start) > 1e-9 * abs(knob.start or knob.high):
            values[knob.name] = value
        return replace(self, values=values)


def motion_key_of_brake_file(brake: Brake) -> str:
    """The name of the key that gives the sense of motion in a brake file, such as "rotation"."""
    return brake.direction_key.rpartition(".")[2]


def names_of_models_besides_fem(brake: Brake) -> tuple[str, ...]:
    """The names of all models that apply to the brake, other than the finite elements."""
    return tuple(model.name for model in applicable_models(brake) if model.name != "fem")


def finite_element_models_offered_by_page(brake: Brake) -> tuple[str, ...]:
    """The names of the models of finite elements that the page offers for a brake.

    Solid shoes are among them if all parts of each shoe have the same width. Shoes whose parts
    differ in width take seconds to solve, and the page would lag behind its sliders.
    """
    refused = reason_why_width_model_does_not_apply(brake) is not None
    if refused or any(has_parts_of_different_widths(shoe) for shoe in brake.shoes):
        return ("fem",)
    return ("fem", "solid")


def slider_setting_at_brake_file_values(brake: Brake) -> SliderSetting:
    """The setting with all sliders at the brake file's values and the first law that applies."""
    return SliderSetting(brake.direction, next(iter(names_of_models_besides_fem(brake)), None))


def sliders_for_brake(brake: Brake) -> tuple[BrakeSlider, ...]:
    """The sliders for a brake, in the order of the page.

    Where forces or moduli differ between the shoes, the slider shows the largest value, and all
    other values change in proportion. Where clearances or radii differ, the slider shows a length
    that is added to all of them.
    """
    R = brake.size * 1e3  # mm
    # Clearance and misfit change in steps of about 1e-5 of the drum's radius.
    fine = nearest_1_2_or_5_times_power_of_ten(R * 1e-5)
    is_flat = brake.surface.is_plane_and_not_drum
    knobs = [
        _friction_coefficient_slider(brake),
        _actuation_force_slider(brake),
        _line_of_action_shift_slider(brake, R),
        _line_of_action_angle_slider(brake),
        _lining_clearance_slider(brake, fine),
        # On a plane there are no sliders of misfit and wear: a flat lining has no radius, and the
        # page computes no wear.
        None if is_flat else _lining_radius_misfit_slider(brake, fine),
        None if is_flat else _wear_distance_slider(brake),
        _youngs_modulus_slider(brake, "lining", "lining modulus", "MPa", 1e6),
        _youngs_modulus_slider(brake, "shoe", "shoe modulus", "GPa", 1e9),
        *geometry_sliders_for_brake(brake),
    ]
    return tuple(knob for knob in knobs if knob is not None)


def _friction_coefficient_slider(brake: Brake) -> BrakeSlider:
    """The slider of the friction coefficient between lining and drum."""
    own = brake.first_key_that_gives_lining_its_own_friction() is not None

    def new_friction_coefficients_at_slider_value(value: float) -> NewValuesByBrakeFileKey:
        """New friction of the brake, `value`; linings' own frictions change in proportion."""
        changes: dict[str, Any] = {"friction": value}
        for i, shoe in enumerate(brake.shoes):
            if shoe.lining.friction is not None:
                ratio = brake.shoe_friction_over_brake_friction(shoe)
                changes[f"shoe[{i}].lining.friction"] = ratio * value
        return changes

    return BrakeSlider(
        name="friction",
        label="friction µ (others in proportion)" if own else "friction µ",
        unit="",
        low=SMALLEST_STEP_OF_FRICTION_SLIDER if own else 0.0,
        high=max(1.0, 2 * brake.friction),
        step=SMALLEST_STEP_OF_FRICTION_SLIDER,
        start=brake.friction,
        changes=new_friction_coefficients_at_slider_value,
    )


def _actuation_force_slider(brake: Brake) -> BrakeSlider | None:
    """The slider of the actuation, a force, pressure or torque; None where all forces are 0."""
    if brake.actuation is not None:
        return _cylinder_or_cam_slider(brake.actuation)
    forces = [shoe.actuation.force for shoe in brake.shoes]
    largest = max(forces, key=abs)
    if largest == 0:
        return None
    low, high = sorted([0.0, 3 * largest * 1e-3])

    def new_actuation_forces_at_slider_value(value: float) -> NewValuesByBrakeFileKey:
        """New forces on the shoes, in the brake file's proportion; the largest is `value` [kN]."""
        made: NewValuesByBrakeFileKey = {}
        for i, force in enumerate(forces):
            # A strut pushes a shoe without force; the force of this shoe is no key to vary.
            if force:
                made[f"shoe[{i}].actuation.force"] = value * 1e3 * (force / largest)
        return made

    # The label says whether all shoes have the same force.
    label = "force on each shoe" if len(forces) > 1 else "force"
    if len(set(forces)) > 1:
        label = "largest force"
    step = nearest_1_2_or_5_times_power_of_ten(abs(largest) * 1e-5)
    return BrakeSlider(
        "force", label, "kN", low, high, step, largest * 1e-3, new_actuation_forces_at_slider_value
    )


def _cylinder_or_cam_slider(drive: DriveOfAllShoes) -> BrakeSlider:
    """The slider of an actuation of all shoes: pressure of a cylinder, force or torque of a cam."""
    # A brake file gives one of the keys pressure, force and torque, or the pressure of a chamber.
    if drive.chamber is not None:
        key, value = "chamber.pressure", drive.chamber.pressure
    else:
        keys = ("pressure", "force", "torque")
        key = next(key for key in keys if getattr(drive, key) is not None)
        value = getattr(drive, key)
    label, unit, factor = CYLINDER_AND_CAM_SLIDER_LABELS_AND_UNITS[key]
    start = value / factor
    # A brake with an actuation must push its shoes, so that a slider of pressure begins slightly
    # above the pressure at which the shoes are not pushed.
    low, high = sorted([lower_slider_end_over_brake_file_value(drive, key) * start, 3 * start])

    def new_drive_pressure_force_or_torque_at_slider_value(value: float) -> NewValuesByBrakeFileKey:
        """New pressure of the cylinder, or force or torque of the cam; `value` in slider's unit."""
        return {f"actuation.{key}": value * factor}

    return BrakeSlider(
        "force",
        label,
        unit,
        low,
        high,
        nearest_1_2_or_5_times_power_of_ten(abs(start) * 1e-2),
        start,
        new_drive_pressure_force_or_torque_at_slider_value,
    )


def lower_slider_end_over_brake_file_value(drive: DriveOfAllShoes, key: str) -> float:
    """The lower end of an actuation's slider, as a fraction of the brake file's value.

    A cylinder pushes above its threshold pressure, and a chamber above the pressure that its return
    spring takes up. The slider begins above this pressure by 1 % of the file's value. For the force
    or torque of a cam it begins at 0.
    """
    if key == "pressure" and drive.pressure is not None:
        return 0.01 + (drive.threshold or 0.0) / drive.pressure
    if drive.chamber is not None:
        return 0.01 + 1 - drive.chamber.rod_force / (drive.chamber.pressure * drive.chamber.area)
    return 0.0


def _line_of_action_shift_slider(brake: Brake, R: float) -> BrakeSlider:
    """The slider that moves the lines of action of all forces away from the hinges, in mm.

    R [mm] is the drum's radius, on a plane the length of the first lining.
    """
    return BrakeSlider(
        name="shift",
        label="line of the force, moved away from the hinge",
        unit="mm",
        low=-nearest_1_2_or_5_times_power_of_ten(R / 5),
        high=nearest_1_2_or_5_times_power_of_ten(R / 5),
        step=nearest_1_2_or_5_times_power_of_ten(R / 400),
        start=0.0,
        changes=lambda value: _new_points_of_shifted_forces(brake, value * 1e-3),
    )


def _new_points_of_shifted_forces(brake: Brake, by: float) -> NewValuesByBrakeFileKey:
    """New points of all forces, each moved across its line of action by the length `by` [m].

    A positive length moves the line of action away from the shoe's hinge.
    """
    changes: NewValuesByBrakeFileKey = {}
    for i, shoe in enumerate(brake.shoes):
        along, point = shoe.actuation.unit_vector_of_force, shoe.actuation.point
        arm = point.xy - shoe.pin.xy
        # The sign of the force's moment about the hinge tells the side on which the hinge lies.
        moment = float(arm[0] * along[1] - arm[1] * along[0])
        moved = point.xy + math.copysign(by, moment) * np.array([along[1], -along[0]])
        changes[f"shoe[{i}].actuation.point"] = {"x": float(moved[0]), "y": float(moved[1])}
    return changes


def _line_of_action_angle_slider(brake: Brake) -> BrakeSlider:
    """The slider that turns the lines of action of all forces, in degrees."""
    return BrakeSlider(
        name="turn",
        label="line of the force, turned",
        unit="deg",
        low=-30.0,
        high=30.0,
        step=0.5,
        start=0.0,
        changes=lambda value: _new_directions_of_turned_forces(brake, math.radians(value)),
    )


def _new_directions_of_turned_forces(brake: Brake, by: float) -> NewValuesByBrakeFileKey:
    """New directions of all forces, turned by `by` [rad], on mirrored shoes the other way round."""
    changes: NewValuesByBrakeFileKey = {}
    for i, shoe in enumerate(brake.shoes):
        direction = shoe.actuation.direction + shoe.frame.sense * by
        changes[f"shoe[{i}].actuation.direction"] = rounded_brake_file_text_of_angle(direction)
    return changes


def _lining_clearance_slider(brake: Brake, step: float) -> BrakeSlider:
    """The slider of the clearance between linings and drum, with a smallest change `step` [mm].

    Where the shoes have different clearances, or tables of clearance, the slider's value is added
    to the clearances of the brake file.
    """
    linings = linings_by_brake_file_key(brake)
    given = [lining.clearance for lining in linings.values()]
    same = len(set(given)) == 1 and isinstance(given[0], float | int)
    start = float(given[0]) * 1e3 if same and not isinstance(given[0], tuple) else 0.0

    def new_lining_clearances_at_slider_value(value: float) -> NewValuesByBrakeFileKey:
        """New clearances of all linings for the slider at `value` [mm]; all change equally."""
        more = (value - start) * 1e-3
        made: NewValuesByBrakeFileKey = {}
        for lining, old in zip(linings, given, strict=True):
            key = f"{lining}.clearance"
            if isinstance(old, tuple):
                made[key] = np.add(old, [0.0, more]).tolist()
            else:
                made[key] = old + more
        return made

    # The slider reaches twice as far into clearance as into interference.
    reach = max(100 * step, 2 * abs(start))
    label = "gap between lining and drum" if same else "gap, added to the file's"
    return BrakeSlider(
        "clearance",
        label,
        "mm",
        -reach,
        2 * reach,
        step,
        start,
        new_lining_clearances_at_slider_value,
    )


def _lining_radius_misfit_slider(brake: Brake, step: float) -> BrakeSlider:
    """The slider of the misfit: radius of the linings minus radius of the drum [mm].

    Where the linings have different radii, the slider's value is added to all of them. `step` [mm]
    is the smallest change.
    """
    R = brake.size
    given = []
    linings = linings_by_brake_file_key(brake)
    for lining in linings.values():
        radius = lining.misfit.radius
        given.append(0.0 if radius is None else radius - R)
    same = len(set(given)) == 1
    start = given[0] * 1e3 if same else 0.0

    def new_lining_radii_at_slider_value(value: float) -> NewValuesByBrakeFileKey:
        """New radii of all linings for the slider at `value` [mm]; all change equally."""
        more = (value - start) * 1e-3
        made: NewValuesByBrakeFileKey = {}
        for lining, old in zip(linings, given, strict=True):
            made[f"{lining}.misfit.radius"] = R + old + more
        return made

    reach = max(200 * step, 2 * abs(start))
    label = "lining radius minus drum radius" + ("" if same else ", added to the file's")
    return BrakeSlider(
        "misfit", label, "mm", -reach, reach, step, start, new_lining_radii_at_slider_value
    )


def _wear_distance_slider(brake: Brake) -> BrakeSlider | None:
    """The slider for the wear of the linings: a sliding distance in kilometres.

    The slider changes no key of the brake file. All other sliders are applied first, and then the
    linings of the changed brake are worn over the slider's distance. The result is None where the
    file has no modulus of a lining.
    """
    units = []
    for lining in linings_by_brake_file_key(brake).values():
        if lining.material is not None and lining.thickness:
            K = lining.material.E_through / lining.thickness
            units.append(1e-3 / (DEFAULT_WEAR_COEFFICIENT * K))
    if not units:
        return None
    least = SMALLEST_RELATIVE_REACH_OF_WEAR_SLIDER * max(units)
    high = next(number for number in four_round_numbers_around_value(least) if number >= least)
    return BrakeSlider(
        name="wear",
        label="distance slid since new",
        unit="km",
        low=0.0,
        high=high,
        step=high / 200,
        start=0.0,
        changes=lambda value: {},
    )


def _youngs_modulus_slider(
    brake: Brake, part: str, label: str, unit: str, factor: float
) -> BrakeSlider | None:
    """The slider of Young's modulus of linings or shoes; None where the file has no modulus.

    The slider reaches from a hundredth to a hundred times the modulus of the brake file. All moduli
    of an orthotropic material change in proportion.

    Parameters
    ----------
    brake : the brake
    part : "lining" or "shoe"
    label : text beside the slider on the page
    unit : unit of the slider's values
    factor : this unit in Pa
    """
    # The dictionary holds the moduli [Pa] that the file gives; its keys are indices of shoes.
    moduli: dict[int, float] = {}
    for i, shoe in enumerate(brake.shoes):
        modulus = _modulus_shown_by_slider(shoe, part)
        if modulus is not None:
            moduli[i] = modulus
    if not moduli:
        return None
    largest = max(moduli.values())

    def new_elastic_moduli_at_slider_value(value: float) -> NewValuesByBrakeFileKey:
        """Changes that scale the moduli of all linings or shoes, so that the largest is `value`.

        `value` has the unit of the slider.
        """
        times = value * factor / largest
        made: NewValuesByBrakeFileKey = {}
        for i in moduli:
            made |= _scaled_part_moduli_by_brake_key(brake.shoes[i], i, part, times)
        return made

    start = largest / factor
    label += "" if len(set(moduli.values())) == 1 else ", the largest"
    return BrakeSlider(
        part,
        label,
        unit,
        start / 100,
        start * 100,
        0.01,
        start,
        new_elastic_moduli_at_slider_value,
        log=True,
    )


def _modulus_shown_by_slider(shoe: Shoe, part: str) -> float | None:
    """The modulus [Pa] that the slider shows: through a lining's thickness or along a shoe's body.

    Of the moduli of an orthotropic material, this modulus influences the contact pressure most. The
    result is None if the part has no material.
    """
    if part == "lining":
        return None if shoe.lining.material is None else shoe.lining.material.E_through
    if shoe.body is None or shoe.body.material is None:
        return None
    return shoe.body.material.E_along


def _scaled_part_moduli_by_brake_key(
    shoe: Shoe, i: int, part: str, times: float
) -> NewValuesByBrakeFileKey:
    """New values, by key of the brake file, of a part's moduli and bending stiffness.

    Each value is the value of the brake file multiplied by the factor `times`.

    Parameters
    ----------
    shoe : the shoe
    i : index of the shoe in the brake
    part : "lining" or "shoe"
    times : the factor
    """
    owner = shoe.lining if part == "lining" else shoe.body
    key = "lining" if part == "lining" else "body"
    # The caller has made sure that the part has a material.
    assert owner is not None and owner.material is not None
    material = owner.material
    changes: NewValuesByBrakeFileKey = {}
    for name, E in material.moduli.items():
        changes[f"shoe[{i}].{key}.material.{name}"] = E * times
    if part == "lining" or not isinstance(shoe.body, BeamBody):
        return changes
    # A bending stiffness in the brake file overrules modulus times second moment of area, so that
    # it has to be scaled, too.
    EI = shoe.body.bending_stiffness
    if EI is not None:
        is_table = isinstance(EI, tuple)
        stiffer = np.multiply(EI, [1.0, times] if is_table else times).tolist()
        changes[f"shoe[{i}].body.bending_stiffness"] = stiffer
    return changes


def brake_at_slider_setting(
    brake: Brake, knobs: Sequence[BrakeSlider], setting: SliderSetting
) -> Brake:
    """The brake of the file, changed by the sliders and the sense of motion of a setting.

    The slider of wear changes nothing here. Raises BadInput where the parts of the changed brake do
    not fit together.
    """
    changes: NewValuesByBrakeFileKey = {}
    if setting.sense != brake.direction:
        changes[brake.direction_key] = setting.sense
    for knob in knobs:
        if knob.name in setting.values:
            changes |= knob.changes(setting.values[knob.name])
    # Linings with a radius of their own follow the radius of the drum, so that their misfit stays.
    growth = changes.get("drum.radius", brake.size) - brake.size
    for key, lining in linings_by_brake_file_key(brake).items() if growth else ():
        radius = changes.get(f"{key}.misfit.radius", lining.misfit.radius)
        if radius is not None:
            changes[f"{key}.misfit.radius"] = radius + growth
    return vary(brake, value_with_all_numbers_rounded(changes)) if changes else brake


def link_query_of_slider_setting(
    knobs: Sequence[BrakeSlider], brake: Brake, setting: SliderSetting
) -> str:
    """The query of the page's address ("friction=0.3&law=sine") for a setting.

    The query names each slider and each choice that differs from the brake file.
    """
    start = slider_setting_at_brake_file_values(brake)
    query = {}
    for knob in knobs:
        if knob.name in setting.values:
            query[knob.name] = f"{setting.values[knob.name]:.12g}"
    if setting.sense != start.sense:
        query[motion_key_of_brake_file(brake)] = setting.sense
    if setting.law is not None and setting.law != start.law:
        query["law"] = setting.law
    if setting.model != start.model:
        query["model"] = setting.model
    return urlencode(query)


def slider_setting_from_link_query(
    knobs: Sequence[BrakeSlider], brake: Brake, query: Mapping[str, str]
) -> tuple[SliderSetting, tuple[str, ...]]:
    """The setting that a link names, and a line of text for each refused part of the link.

    Unknown parts of the link are ignored. Values beyond a slider's range are moved to its end.
    `query` holds the values of the link's query by name.
    """
    # Begin at the brake file's values. Each entry of the link moves a slider, or chooses the sense
    # of motion, the law or the model.
    setting, lines = slider_setting_at_brake_file_values(brake), list[str]()
    knob_of = {knob.name: knob for knob in knobs}
    words = {
        motion_key_of_brake_file(brake): brake.directions,
        "law": names_of_models_besides_fem(brake),
        "model": finite_element_models_offered_by_page(brake),
    }
    for name, text in query.items():
        if name in knob_of:
            setting, line = _setting_and_message_after_slider_is_moved_by_link_text(
                knob_of[name], text, setting
            )
            lines += [line] if line else []
        elif name in words and text in words[name]:
            setting = _setting_with_law_model_or_motion_from_link(name, text, setting)
        elif name in words:
            allowed = ", ".join(words[name]) or "none"
            lines.append(
                printable_single_line(f"link: {name} = {text!r}: left out; allowed: {allowed}", 200)
            )
        else:
            allowed = ", ".join([*knob_of, *words])
            lines.append(
                printable_single_line(f"link: unknown name {name!r}; allowed: {allowed}", 300)
            )
    return setting, tuple(lines)


def _setting_with_law_model_or_motion_from_link(
    name: str, text: str, setting: SliderSetting
) -> SliderSetting:
    """A copy of the setting with the law, the model or the sense of motion that a link names.

    `name` is the name in the link, and `text` one of the allowed words.
    """
    if name == "law":
        return replace(setting, law=text)
    return replace(setting, model=text) if name == "model" else replace(setting, sense=text)


def _setting_and_message_after_slider_is_moved_by_link_text(
    knob: BrakeSlider, text: str, setting: SliderSetting
) -> tuple[SliderSetting, str]:
    """A copy of the setting with a slider moved to the value `text` of a link, and a message.

    The message says why the value was refused or moved. It is empty where the value is a number
    within the range of the slider.
    """
    try:
        value = float(text[:MAX_CHARACTERS_OF_EXPLORE_PAGE_LINK])
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        return setting, printable_single_line(
            f"link: {knob.name} = {text!r}: left out; must be a number", 200
        )
    inside = knob.nearest_value_in_range(value)
    moved = (
        f"link: {knob.name} = {value:g}: moved to {inside:g}; "
        f"allowed: {knob.low:g} to {knob.high:g} {knob.unit}"
    )
    return setting.setting_with_slider_moved(
        knob, inside
    ), "" if inside == value else moved.rstrip()
