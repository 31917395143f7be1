"""A set of brakes with extreme parameters, as a test of drumlin's robustness.

A case starts from one internal shoe like the shoe of a car's rear brake and changes a few
parameters. The set varies each parameter over its whole range, combines extreme values of several
parameters, and adds a Latin hypercube sample of all parameters.
"""

import dataclasses
import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import make_drum_brake_from_data
from drumlin.fem.mesh.arc import parametric_mesh_of_shoe
from drumlin.fem.mesh.grading import LiningDivision, divide_lining_into_elements

SEED_OF_LATIN_HYPERCUBE_SAMPLE = 7
"""Seed of the random numbers of the Latin hypercube sample."""
MOST_ELEMENTS_PER_LINING_IN_SHORT_CASE_SET = 12
"""Largest number of elements along a lining in the short set of cases, which runs in little time.
"""
CASE_RADIUS, CASE_WIDTH = 0.15, 0.04  # m
"""Radius of the drum, and width of shoe and lining [m], of the case that all others change."""
HINGE_POLAR_COORDINATES_OF_DEFAULT_CASE = (0.125, math.radians(-75.0))  # radius [m], angle [rad]
"""Polar coordinates (radius [m], angle [rad]) of the hinge of the case that all others change."""
LINING_MODULUS_OF_DEFAULT_CASE = 3e8  # Pa
"""Young's modulus [Pa] of the lining of the case that all others change."""
LINING_CLEARANCE_TABLES_BY_NAME: dict[str, tuple[tuple[float, float], ...]] = {
    "toe": ((0, 3.0), (0.7, 1.0), (1, 0.0)),
    "heel": ((0, 0.0), (0.3, 1.0), (1, 6.0)),
    "split": ((0, 0.0), (0.4, 1.0), (0.6, 1.0), (1, 0.0)),
    "point": ((0, 4.0), (0.5, 0.0), (1, 4.0)),
    "waves": ((0, 0.0), (0.2, 0.05), (0.4, 0.0), (0.6, 0.05), (0.8, 0.0), (1, 0.05)),
}
"""Tables of clearance along the lining, by name.

A row is a fraction of the arc, from the heel (0) at the hinge to the toe (1) at the loaded end, and
the clearance there [mm].
"""


@dataclass(frozen=True)
class ExtremeCase:
    """A case of the set: the parameters of a brake and of its solve, in SI units (arc in degrees).

    Attributes
    ----------
    knob : str
        Name of the sweep to which the case belongs.
    shoes : int
        1, or 2 for a second shoe that is the mirror image of the first.
    assisted : bool
        Whether the shoe is self-energising.
    friction : float
        Coefficient of friction.
    shoe, ring : float or None
        Young's modulus of the shoe and of the drum's ring, divided by the lining's modulus; None
        for a rigid part.
    support : str
        Support of the ring, "fixed" or "free".
    penalty : float
        Penalty factor alpha of the contact stiffness alpha E/t; inf for exact contact.
    thickness : float
        Thickness of the lining, relative to the drum's radius.
    arc : float
        Arc of the lining [deg].
    clearance : float or str
        Clearance [m], or a name of LINING_CLEARANCE_TABLES_BY_NAME.
    force : float
        Actuating force [N].
    lever : float
        Distance of the line of force from the pin [m].
    nu : float
        Poisson's ratio of the lining.
    elements, kind : int, str
        Number of elements along a lining, and kind of the elements.
    aspect : float or None
        Length divided by height of the elements at the lining's surface next to the heel; None for
        the usual mesh.
    size, pressure : float
        Factors that multiply all lengths and all Young's moduli.
    """

    knob: str = "base"
    shoes: int = 1
    assisted: bool = True
    friction: float = 0.3
    shoe: float | None = 700.0
    ring: float | None = None
    support: str = "fixed"
    penalty: float = 1e6
    thickness: float = 8 / 150
    arc: float = 125.0
    clearance: float | str = 0.0
    force: float = 2000.0
    lever: float = 0.22
    nu: float = 0.25
    elements: int = 40
    kind: str = "quad2"
    aspect: float | None = None
    size: float = 1.0
    pressure: float = 1.0

    @property
    def parameters_changed_from_default_case(self) -> dict[str, Any]:
        """The parameters of the case that differ from the default values, by name."""
        base, own = dataclasses.asdict(ExtremeCase()), dataclasses.asdict(self)
        del own["knob"]
        return {key: value for key, value in own.items() if value != base[key]}

    def brake(self) -> Brake:
        """The brake of the case. Raises BadInput if the parameters give no valid brake."""
        title = ", ".join(
            f"{key} {value}" for key, value in self.parameters_changed_from_default_case.items()
        )
        data: dict[str, Any] = {
            "title": title[:80] or "base",
            "rotation": "counter-clockwise" if not self.assisted else "clockwise",
            "friction": self.friction,
            "drum": {"radius": CASE_RADIUS * self.size},
            "shoe": [self._data_of_left_or_right_shoe(1)]
            + ([self._data_of_left_or_right_shoe(-1)] if self.shoes > 1 else []),
        }
        if self.ring is not None:
            data["drum"]["ring"] = {
                "thickness": 0.015 * self.size,
                "width": CASE_WIDTH * self.size,
                "material": {
                    "E": LINING_MODULUS_OF_DEFAULT_CASE * self.ring * self.pressure,
                    "nu": 0.25,
                },
                "support": self.support,
            }
        return make_drum_brake_from_data(data)

    def _data_of_left_or_right_shoe(self, side: int) -> dict[str, Any]:
        """The data, as in a brake file, of the right shoe (side 1) or of its mirror image (-1)."""
        size = self.size
        start = HINGE_POLAR_COORDINATES_OF_DEFAULT_CASE[1] + math.radians(5.0)
        pin = (
            HINGE_POLAR_COORDINATES_OF_DEFAULT_CASE[0]
            * size
            * np.array(
                [
                    math.cos(HINGE_POLAR_COORDINATES_OF_DEFAULT_CASE[1]),
                    math.sin(HINGE_POLAR_COORDINATES_OF_DEFAULT_CASE[1]),
                ]
            )
        )

        def arc_ends_mirrored_for_left_shoe(a: float, b: float) -> dict[str, float]:
            """The start and the end of an arc from a to b [rad], mirrored for the left shoe."""
            return (
                {"start": a, "end": b} if side > 0 else {"start": math.pi - b, "end": math.pi - a}
            )

        arc = math.radians(self.arc)
        shoe: dict[str, Any] = {
            "name": "right" if side > 0 else "left",
            "side": "internal",
            "hinge": {"x": side * float(pin[0]), "y": float(pin[1])},
            "lining": {
                **arc_ends_mirrored_for_left_shoe(start, start + arc),
                "thickness": self.thickness * CASE_RADIUS * size,
                "width": CASE_WIDTH * size,
                "material": {"E": LINING_MODULUS_OF_DEFAULT_CASE * self.pressure, "nu": self.nu},
                "clearance": self._lining_clearance_of_left_or_right_shoe(side, start),
            },
            "actuation": {
                "force": self.force,
                "direction": 0.0 if side > 0 else math.pi,
                "point": {"x": side * 0.058 * size, "y": float(pin[1]) + self.lever * size},
            },
        }
        if self.shoe is not None:
            shoe["body"] = {
                **arc_ends_mirrored_for_left_shoe(
                    HINGE_POLAR_COORDINATES_OF_DEFAULT_CASE[1], start + arc + math.radians(5.0)
                ),
                "thickness": 0.024 * size,
                "width": CASE_WIDTH * size,
                "material": {
                    "E": LINING_MODULUS_OF_DEFAULT_CASE * self.shoe * self.pressure,
                    "nu": 0.3,
                },
            }
        return shoe

    def _lining_clearance_of_left_or_right_shoe(
        self, side: int, start: float
    ) -> float | list[tuple[float, float]]:
        """The clearance [m] of a lining, or the rows of its table: angle [rad] and clearance [m].

        The lining of the right shoe (side 1) starts at the angle `start`. The lining of the left
        shoe (-1) is its mirror image.
        """
        if not isinstance(self.clearance, str):
            return self.clearance * self.size
        arc = math.radians(self.arc)
        rows = [
            (start + part * arc, gap * 1e-3 * self.size)
            for part, gap in LINING_CLEARANCE_TABLES_BY_NAME[self.clearance]
        ]
        return rows if side > 0 else [(math.pi - a, gap) for a, gap in reversed(rows)]

    def function_that_meshes_shoe_with_aspect_ratio(self) -> Callable[[Shoe, float], Any] | None:
        """The function that meshes a shoe with the aspect ratio of the case; None without one."""
        return None if self.aspect is None else partial(_shoe_mesh_of_aspect_ratio, self)


def _shoe_mesh_of_aspect_ratio(case: ExtremeCase, shoe: Shoe, radius: float) -> Any:
    """The mesh of a shoe whose elements at the heel have the case's aspect ratio at the surface.

    Each further element is ten times as large as the element before. For ratios from 1 on the
    elements grow through the lining; for smaller ratios they grow along the lining, within the
    first element of the usual mesh.
    """
    # A ratio of 1 or more makes the elements at the surface flatter; a smaller ratio makes the
    # elements at the heel shorter.
    division = divide_lining_into_elements(shoe, radius, case.elements)
    start, end = shoe.arc
    step = (end - start) / case.elements
    assert case.aspect is not None
    if case.aspect >= 1:
        angles = np.linspace(start, end, case.elements + 1)
        depths = _points_with_tenfold_growing_distance(
            step * radius / case.aspect, shoe.lining.thickness
        )
    else:
        depths = np.array([0.0, shoe.lining.thickness])
        first = start + _points_with_tenfold_growing_distance(
            shoe.lining.thickness * case.aspect / radius, step
        )
        angles = np.concatenate([first, np.linspace(start, end, case.elements + 1)[2:]])
    return parametric_mesh_of_shoe(
        shoe, radius, LiningDivision(angles, depths, division.step), case.kind
    )


def _points_with_tenfold_growing_distance(first: float, whole: float) -> Floats:
    """Points at 0, at `first`, then each ten times as far from 0 as the last, and at `whole`."""
    steps = max(0, math.ceil(math.log10(whole / first) - 0.5)) if first < whole else 0
    return np.array([0.0, *(first * 10.0**k for k in range(steps)), whole])


def all_extreme_cases(*, short: bool = False) -> list[ExtremeCase]:
    """The set of all cases, or a short set of some of them with coarser meshes.

    The short set has the two ends and the middle of each sweep, and some tenth of the other cases.
    """
    sweeps = [
        _sweep_cases_from_changed_parameters(knob, settings)
        for knob, settings in _parameter_changes_of_all_sweeps().items()
    ]
    if not short:
        return [
            *itertools.chain(*sweeps),
            *_cases_with_combined_parameter_extremes(),
            *_cases_on_grids_of_two_parameters(),
            *_cases_of_latin_hypercube(100),
        ]
    ends: list[ExtremeCase] = []
    for sweep in sweeps:
        ends += [sweep[i] for i in sorted({0, len(sweep) // 2, len(sweep) - 1})]
    chosen = (
        ends
        + _cases_with_combined_parameter_extremes()[::8]
        + _cases_on_grids_of_two_parameters()[::12]
        + _cases_of_latin_hypercube(8)
    )
    coarse = (
        dataclasses.replace(
            case, elements=min(case.elements, MOST_ELEMENTS_PER_LINING_IN_SHORT_CASE_SET)
        )
        for case in chosen
    )
    return list(dict.fromkeys(coarse))


def _powers_of_ten(first: int, last: int, step: int = 1) -> list[float]:
    """The powers of ten from 10^first to 10^last, in steps of 10^step."""
    return [10.0**k for k in range(first, last + 1, step)]


def _parameter_changes_for_values_of_one_parameter(
    name: str, values: list[Any], **rest: Any
) -> list[dict[str, Any]]:
    """Dictionaries of changed parameters of a case, one for each value of the parameter `name`.

    `rest` are values of other parameters, the same in each dictionary.
    """
    return [{name: value, **rest} for value in values]


def _parameter_changes_of_all_sweeps() -> dict[str, list[dict[str, Any]]]:
    """For each sweep by name: the parameters that each of its cases changes, with their values."""
    return (
        _parameter_changes_of_stiffness_sweeps()
        | _parameter_changes_of_contact_sweeps()
        | _parameter_changes_of_mesh_and_size_sweeps()
    )


def _parameter_changes_of_stiffness_sweeps() -> dict[str, list[dict[str, Any]]]:
    """Changed parameters of each case of the sweeps over stiffness of shoe, ring and contact."""
    moduli = _powers_of_ten(-8, 8)
    return {
        "shoe over lining": _parameter_changes_for_values_of_one_parameter("shoe", moduli)
        + _parameter_changes_for_values_of_one_parameter("shoe", moduli, assisted=False)
        + [{"shoe": None}],
        "ring over lining": _parameter_changes_for_values_of_one_parameter(
            "ring", moduli[::2], shoes=2
        )
        + _parameter_changes_for_values_of_one_parameter(
            "ring", moduli[::2], shoes=2, support="free"
        ),
        "penalty": _parameter_changes_for_values_of_one_parameter(
            "penalty", [*_powers_of_ten(-2, 16), math.inf]
        )
        + _parameter_changes_for_values_of_one_parameter(
            "penalty",
            [*_powers_of_ten(-2, 6), 1e9, 1e12, math.inf],
            clearance=1e-4,
            assisted=False,
            shoe=70.0,
        ),
    }


def _parameter_changes_of_contact_sweeps() -> dict[str, list[dict[str, Any]]]:
    """Changed parameters of each case of the sweeps over friction, lining, gap and force."""
    # Values of the parameters in the units of ExtremeCase.
    arcs = [0.1, 0.3, 1.0, 5.0, 20.0, 60.0, 180.0, 240.0, 300.0, 340.0]
    gaps = [-1e-2, -1e-3, -1e-4, -1e-6, -1e-9, 1e-9, 1e-6, 1e-5, 1e-4, 1e-3, 3e-3, 1e-2, 3e-2]
    mu = [0.0, 1e-9, 0.05, 0.2, 0.5, 0.8, 1.0, 1.1, 1.15, 1.17, 1.18, 1.19, 1.2, 1.3, 1.5, 2.0]
    mu += [3.0, 5.0]
    return {
        "friction": _parameter_changes_for_values_of_one_parameter("friction", mu)
        + _parameter_changes_for_values_of_one_parameter("friction", mu[1:], assisted=False),
        "lining thickness": _parameter_changes_for_values_of_one_parameter(
            "thickness", [*(1 / t for t in (1e5, 1e4, 1e3, 100, 30, 10, 5, 3))]
        )
        + _parameter_changes_for_values_of_one_parameter(
            "thickness", [1e-5, 1e-3, 1 / 3], penalty=math.inf
        ),
        "arc": _parameter_changes_for_values_of_one_parameter("arc", arcs)
        + _parameter_changes_for_values_of_one_parameter("arc", arcs, assisted=False),
        "clearance": _parameter_changes_for_values_of_one_parameter("clearance", gaps),
        "force": _parameter_changes_for_values_of_one_parameter(
            "force", [*_powers_of_ten(-9, 12), 0.0, -2000.0], clearance=1e-4
        ),
        "contact": _parameter_changes_for_values_of_one_parameter(
            "clearance", list(LINING_CLEARANCE_TABLES_BY_NAME)
        )
        + _parameter_changes_for_values_of_one_parameter(
            "clearance", list(LINING_CLEARANCE_TABLES_BY_NAME), assisted=False, penalty=math.inf
        )
        + _parameter_changes_for_values_of_one_parameter(
            "clearance", list(LINING_CLEARANCE_TABLES_BY_NAME), elements=2
        ),
    }


def _parameter_changes_of_mesh_and_size_sweeps() -> dict[str, list[dict[str, Any]]]:
    """Changed parameters of each case of the sweeps over mesh, Poisson's ratio, lever and size."""
    return {
        "aspect": _parameter_changes_for_values_of_one_parameter(
            "aspect", [*_powers_of_ten(0, 4), *_powers_of_ten(-4, -1)]
        )
        + _parameter_changes_for_values_of_one_parameter("aspect", [1e4, 1e-4], kind="tri2"),
        "elements": [
            *_parameter_changes_for_values_of_one_parameter(
                "elements", [1, 2, 3, 5, 10, 20, 80, 160]
            ),
            *_parameter_changes_for_values_of_one_parameter("elements", [320, 640], shoe=None),
            *_parameter_changes_for_values_of_one_parameter(
                "elements", [1000, 2000], shoe=None, kind="quad1"
            ),
        ],
        "Poisson's ratio": _parameter_changes_for_values_of_one_parameter(
            "nu", [-0.99, -0.5, 0.0, 0.4, 0.45, 0.49, 0.499, 0.4999]
        ),
        "lever": _parameter_changes_for_values_of_one_parameter(
            "lever", [*_powers_of_ten(-12, -1), 0.0, -1e-6]
        ),
        "size": [
            {"size": 1e3, "pressure": 1e-6},
            {"size": 1e3, "pressure": 1e-6, "penalty": math.inf},
            {"size": 1e3, "pressure": 1e-6, "thickness": 1e-4},
            {"size": 1e3, "pressure": 1e-6, "shoes": 2, "ring": 400.0},
            {"size": 1e-6, "force": 2e-9},
            {"size": 1e3, "force": 2e9},
            {"size": 1e-3, "force": 2e-3, "kind": "tri2"},
        ],
        "kind": _parameter_changes_for_values_of_one_parameter("kind", ["quad1", "tri2", "tri1"])
        + _parameter_changes_for_values_of_one_parameter(
            "kind", ["quad1", "tri2", "tri1"], shoe=1e-4
        ),
    }


def _sweep_cases_from_changed_parameters(
    knob: str, settings: list[dict[str, Any]]
) -> list[ExtremeCase]:
    """The cases of the sweep named `knob`; `settings` are the changed parameters of each case."""
    return [ExtremeCase(knob=knob, **setting) for setting in settings]


def _cases_with_combined_parameter_extremes() -> list[ExtremeCase]:
    """The 32 cases in which each of five parameters has a small or a large value."""
    ends: dict[str, tuple[Any, Any]] = {
        "shoe": (1e-4, 1e6),
        "penalty": (1.0, math.inf),
        "thickness": (1e-4, 0.25),
        "clearance": (-1e-4, 1e-3),
        "friction": (0.01, 0.6),
    }
    combinations = itertools.product(*ends.values())
    settings = [dict(zip(ends, chosen, strict=True)) for chosen in combinations]
    return _sweep_cases_from_changed_parameters("corners", settings)


def _cases_on_grids_of_two_parameters() -> list[ExtremeCase]:
    """The cases of two grids; each grid covers the whole ranges of two parameters."""
    moduli, mu = _powers_of_ten(-8, 8, 2), [0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1.1, 1.5, 2.5, 5.0]
    thicknesses, penalties = (
        [1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1 / 3],
        [*_powers_of_ten(-2, 16, 3), math.inf],
    )
    result = []
    for E, friction in itertools.product(moduli, mu):
        result.append(ExtremeCase(knob="shoe × friction", shoe=E, friction=friction))
    for t, penalty in itertools.product(thicknesses, penalties):
        result.append(ExtremeCase(knob="thickness × penalty", thickness=t, penalty=penalty))
    return result


def _cases_of_latin_hypercube(count: int) -> list[ExtremeCase]:
    """A Latin hypercube sample of `count` cases: 13 parameters, most on logarithmic scales."""
    rng = np.random.default_rng(SEED_OF_LATIN_HYPERCUBE_SAMPLE)
    # Each of the 13 columns has one number in each of `count` equal intervals of [0, 1].
    strata = np.array([rng.permutation(count) for _ in range(13)]).T
    samples = (strata + rng.random(strata.shape)) / count
    return [_case_from_hypercube_sample(row.tolist()) for row in samples]


def _case_from_hypercube_sample(sample: list[float]) -> ExtremeCase:
    """A case of the Latin hypercube, from a sample of 13 numbers between 0 and 1."""
    u = iter(sample)

    def next_log_uniform_number(low: float, high: float) -> float:
        """The next number of the sample, scaled logarithmically to 10^low ... 10^high."""
        return float(f"{10 ** (low + (high - low) * next(u)):.3g}")

    # Each call takes the next number of the sample, so that the order of these lines matters.
    shoe = next_log_uniform_number(-8, 8)
    penalty = next_log_uniform_number(-2, 16)
    thickness = next_log_uniform_number(-5, math.log10(1 / 3))
    arc = next_log_uniform_number(-1, math.log10(340))
    force = next_log_uniform_number(-9, 12)
    lever = next_log_uniform_number(-6, math.log10(0.25))
    elements = round(next_log_uniform_number(math.log10(2), 2))
    gap = next_log_uniform_number(-8, -2)
    friction = round(5 * next(u) ** 2.5, 3)
    return ExtremeCase(
        knob="hypercube",
        shoe=shoe,
        penalty=penalty,
        thickness=thickness,
        arc=arc,
        force=force,
        lever=lever,
        elements=elements,
        clearance=gap if next(u) < 0.5 else -gap,
        friction=friction,
        assisted=next(u) < 0.5,
        nu=round(0.4999 * next(u), 4),
        kind=("quad2", "tri2", "quad1")[int(next(u) * 3)],
    )
