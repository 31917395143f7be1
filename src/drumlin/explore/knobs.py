"""What can be turned on the page: knobs with ranges, a setting of them, the brake and the link that
belong to it.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple
from urllib.parse import urlencode

import numpy as np

from drumlin.base.texts import one_line
from drumlin.brake import vary
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Beam
from drumlin.brake.drive import Drive
from drumlin.models import applicable

Changes = dict[str, Any]
LARGEST_WEAR = 50.0  # of 1/(k K); a stiff brake is worn in after some 46
DRIVES = {
    "pressure": ("pressure of the cylinder", "MPa", 1e6),
    "force": ("force of the cam", "kN", 1e3),
    "torque": ("torque of the cam", "N m", 1.0),
}
LONGEST_LINK = 2000  # characters of a link's query that are read


class Knob(NamedTuple):
    """A slider: its name in the link, words, unit, and range in that unit; `log`: moved by factors.

    `start`: where the brake file stands; `changes`: what a value [unit] changes, as `vary` takes
    it.
    """

    name: str
    label: str
    unit: str
    low: float
    high: float
    step: float
    start: float
    changes: Callable[[float], Changes]
    log: bool = False

    @property
    def title(self) -> str:
        """The words with their unit."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label

    def clamped(self, value: float) -> float:
        """The nearest value within the range."""
        return min(max(value, self.low), self.high)


WEAR = Knob(
    "wear", "wear: sliding distance", "1/(k K)", 0.0, LARGEST_WEAR, 0.25, 0.0, lambda value: {}
)


@dataclass(frozen=True)
class Setting:
    """Where the knobs stand: values by name, of those that are away from the brake file; `sense` of
    the motion, one of `Brake.directions`; the law beside.
    """

    sense: str
    law: str | None
    values: Mapping[str, float] = field(default_factory=dict)

    def value(self, knob: Knob) -> float:
        """The value of a knob [its unit]."""
        return self.values.get(knob.name, knob.start)

    def turned(self, knob: Knob, value: float) -> "Setting":
        """The setting with one knob turned."""
        values = {name: old for name, old in self.values.items() if name != knob.name}
        if abs(value - knob.start) > 1e-9 * abs(knob.start or knob.high):
            values[knob.name] = value
        return replace(self, values=values)


def motion_of(brake: Brake) -> str:
    """What a file calls the direction of the motion."""
    return brake.direction_key.rpartition(".")[2]


def laws_of(brake: Brake) -> tuple[str, ...]:
    """Names of the models that can stand beside the finite elements."""
    return tuple(model.name for model in applicable(brake) if model.name != "fem")


def start_of(brake: Brake) -> Setting:
    """The setting that is the brake file itself."""
    return Setting(brake.direction, next(iter(laws_of(brake)), None))


def knobs_of(brake: Brake) -> tuple[Knob, ...]:
    """The knobs that a brake has, in the page's order.

    A quantity that differs from shoe to shoe is shown as that of the shoe with the largest; the
    others go in proportion (forces, moduli) or by the same difference (clearance, misfit).
    """
    R = brake.size * 1e3
    fine = nice(R * 1e-5)
    flat = brake.surface.straight  # where a lining that fits has no radius
    found = [
        Knob("friction", "friction µ", "", 0.0, max(1.0, 2 * brake.friction), 0.005, brake.friction, _friction),
        _force(brake),
        Knob("shift", "line of action, moved out", "mm", -nice(R / 5), nice(R / 5), nice(R / 400), 0.0,
             lambda value: _shifted(brake, value * 1e-3)),
        Knob("turn", "line of action, turned", "deg", -30.0, 30.0, 0.5, 0.0,
             lambda value: _turned(brake, math.radians(value))),
        _clearance(brake, fine),
        None if flat else _misfit(brake, fine),
        None if flat else WEAR,
        _modulus(brake, "lining", "lining modulus", "MPa", 1e6),
        _modulus(brake, "shoe", "shoe modulus", "GPa", 1e9),
    ]  # fmt: skip
    return tuple(knob for knob in found if knob is not None)


def nice(value: float) -> float:
    """The nearest of 1, 2, 5 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(value))
    return float(min((1, 2, 5, 10), key=lambda digit: abs(math.log(value / power / digit))) * power)


def _friction(value: float) -> Changes:
    return {"friction": value}


def _force(brake: Brake) -> Knob | None:
    if brake.actuation is not None:
        return _drive(brake.actuation)
    forces = [shoe.actuation.force for shoe in brake.shoes]
    largest = max(forces, key=abs)
    if largest == 0:
        return None
    low, high = sorted([0.0, 3 * largest * 1e-3])
    differ = len(set(forces)) > 1

    def changes(value: float) -> Changes:
        shares = (force / largest for force in forces)
        return {f"shoe[{i}].actuation.force": value * 1e3 * share for i, share in enumerate(shares)}

    label = "largest force" if differ else "force on each shoe" if len(forces) > 1 else "force"
    return Knob("force", label, "kN", low, high, nice(abs(largest) * 1e-5), largest * 1e-3, changes)


def _drive(drive: Drive) -> Knob:
    """What pushes all shoes at once: the pressure of a cylinder, the force or the torque of a cam."""
    given = {key: value for key in DRIVES if (value := getattr(drive, key)) is not None}
    key, value = next(iter(given.items()))
    label, unit, factor = DRIVES[key]
    start = value / factor
    low, high = sorted([0.0 if key != "pressure" else 0.01 * start, 3 * start])

    def changes(value: float) -> Changes:
        return {f"actuation.{key}": value * factor}

    return Knob("force", label, unit, low, high, nice(abs(start) * 1e-2), start, changes)


def _shifted(brake: Brake, by: float) -> Changes:
    """Every line of action moved by a length [m] across itself, away from its hinge for a positive
    one.
    """
    changes: Changes = {}
    for i, shoe in enumerate(brake.shoes):
        along, point = shoe.actuation.direction_vector, shoe.actuation.point
        arm = point.xy - shoe.pin.xy
        outwards = math.copysign(by, float(arm[0] * along[1] - arm[1] * along[0])) * np.array(
            [along[1], -along[0]]
        )
        moved = point.xy + outwards
        changes[f"shoe[{i}].actuation.point"] = {"x": float(moved[0]), "y": float(moved[1])}
    return changes


def _turned(brake: Brake, by: float) -> Changes:
    """Every force turned by an angle [rad], mirrored on shoes that are."""
    return {
        f"shoe[{i}].actuation.direction": shoe.actuation.direction + shoe.frame.sense * by
        for i, shoe in enumerate(brake.shoes)
    }


def _clearance(brake: Brake, step: float) -> Knob:
    """One clearance; where the file has tables, or values that differ, what is added to them."""
    given = [shoe.lining.clearance for shoe in brake.shoes]
    same = len(set(given)) == 1 and isinstance(given[0], float | int)
    start = float(given[0]) * 1e3 if same and not isinstance(given[0], tuple) else 0.0

    def changes(value: float) -> Changes:
        more = (value - start) * 1e-3
        return {
            f"shoe[{i}].lining.clearance": [[at, c + more] for at, c in old]
            if isinstance(old, tuple)
            else old + more
            for i, old in enumerate(given)
        }

    reach = max(100 * step, 2 * abs(start))
    label = "clearance" if same else "clearance, added to the file's"
    return Knob("clearance", label, "mm", -reach, 2 * reach, step, start, changes)


def _misfit(brake: Brake, step: float) -> Knob:
    """The linings' radius over the drum's; where they differ, what is added to them."""
    R = brake.size
    given = [
        0.0 if shoe.lining.misfit.radius is None else shoe.lining.misfit.radius - R
        for shoe in brake.shoes
    ]
    same = len(set(given)) == 1
    start = given[0] * 1e3 if same else 0.0

    def changes(value: float) -> Changes:
        more = (value - start) * 1e-3
        return {f"shoe[{i}].lining.misfit.radius": R + old + more for i, old in enumerate(given)}

    reach = max(200 * step, 2 * abs(start))
    label = "misfit: radius over the drum's" + ("" if same else ", added to the file's")
    return Knob("misfit", label, "mm", -reach, reach, step, start, changes)


def _modulus(brake: Brake, part: str, label: str, unit: str, factor: float) -> Knob | None:
    """Young's modulus of the linings or the shoes, from a hundredth to a hundred times that of the
    file.

    All moduli of an orthotropic material go in proportion.
    """
    moduli = {i: E for i, shoe in enumerate(brake.shoes) if (E := _E(shoe, part)) is not None}
    if not moduli:
        return None
    largest = max(moduli.values())

    def changes(value: float) -> Changes:
        times = value * factor / largest
        return {
            key: new
            for i in moduli
            for key, new in _stiffer(brake.shoes[i], i, part, times).items()
        }

    start = largest / factor
    label += "" if len(set(moduli.values())) == 1 else ", the largest"
    return Knob(part, label, unit, start / 100, start * 100, 0.01, start, changes, log=True)


def _E(shoe: Shoe, part: str) -> float | None:
    """The modulus that a part answers the contact with: through a lining, along a body."""
    if part == "lining":
        return None if shoe.lining.material is None else shoe.lining.material.E_through
    return (
        shoe.body.material.E_along
        if shoe.body is not None and shoe.body.material is not None
        else None
    )


def _stiffer(shoe: Shoe, i: int, part: str, times: float) -> Changes:
    """All moduli of a part, and its bending stiffness, so many times as large."""
    material = (
        shoe.lining.material
        if part == "lining"
        else None
        if shoe.body is None
        else shoe.body.material
    )
    assert material is not None  # _modulus
    key = "lining" if part == "lining" else "body"
    changes: Changes = {
        f"shoe[{i}].{key}.material.{name}": E * times for name, E in material.moduli.items()
    }
    if part == "lining":
        return changes
    if (
        isinstance(shoe.body, Beam) and shoe.body.bending_stiffness is not None
    ):  # it overrules that of the section
        EI = shoe.body.bending_stiffness
        changes[f"shoe[{i}].body.bending_stiffness"] = (
            [[at, value * times] for at, value in EI] if isinstance(EI, tuple) else EI * times
        )
    return changes


def brake_of(brake: Brake, knobs: Sequence[Knob], setting: Setting) -> Brake:
    """The brake at a setting, unworn; raises BadInput where its parts do not fit together."""
    changes: Changes = {}
    if setting.sense != brake.direction:
        changes[brake.direction_key] = setting.sense
    for knob in knobs:
        if knob.name in setting.values:
            changes |= knob.changes(setting.values[knob.name])
    return vary(brake, changes) if changes else brake


def link_of(knobs: Sequence[Knob], brake: Brake, setting: Setting) -> str:
    """The query of the page's address that stands for a setting: what is away from the brake file."""
    start = start_of(brake)
    said = {
        knob.name: f"{setting.values[knob.name]:.12g}"
        for knob in knobs
        if knob.name in setting.values
    }
    if setting.sense != start.sense:
        said[motion_of(brake)] = setting.sense
    if setting.law is not None and setting.law != start.law:
        said["law"] = setting.law
    return urlencode(said)


def setting_from(
    knobs: Sequence[Knob], brake: Brake, query: Mapping[str, str]
) -> tuple[Setting, tuple[str, ...]]:
    """The setting of a link, and a line for each part of it that was refused or moved into its
    range.
    """
    setting, lines = start_of(brake), list[str]()
    known = {knob.name: knob for knob in knobs}
    motion = motion_of(brake)
    words = {motion: brake.directions, "law": laws_of(brake)}
    for name, text in query.items():
        if name in known:
            setting, line = _read(known[name], text, setting)
            lines += [line] if line else []
        elif name in words and text in words[name]:
            setting = replace(setting, law=text) if name == "law" else replace(setting, sense=text)
        elif name in words:
            allowed = ", ".join(words[name]) or "none"
            lines.append(one_line(f"link: {name} = {text!r}: left out; allowed: {allowed}", 200))
        else:
            lines.append(
                one_line(
                    f"link: unknown name {name!r}; allowed: {', '.join([*known, *words])}", 300
                )
            )
    return setting, tuple(lines)


def _read(knob: Knob, text: str, setting: Setting) -> tuple[Setting, str]:
    try:
        value = float(text[:LONGEST_LINK])
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        return setting, one_line(f"link: {knob.name} = {text!r}: left out; must be a number", 200)
    inside = knob.clamped(value)
    moved = f"link: {knob.name} = {value:g}: moved to {inside:g}; allowed: {knob.low:g} to {knob.high:g} {knob.unit}"
    return setting.turned(knob, inside), "" if inside == value else moved.rstrip()
