"""A post brake by sine law, elastic foundation and finite elements: rows of tables, curves and maps
of errors.

What each simplification of the foundation model is worth, what clearances and friction do, where
the model's assumptions end, and how fast its grids converge.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from drumlin import foundation
from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.beam_axis import axis_of
from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.comparison import run as timed
from drumlin.fem.analysis.deflection import beam_deflection, rim_displacement
from drumlin.fem.model import respond
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.solve import solve
from drumlin.laws import sine
from drumlin.lining_wear.worn_in import worn_in_foundation
from drumlin.response.merit import with_merits
from drumlin.response.norms import relative
from drumlin.response.response import Merit, Response

ALL_LIFTS = ("all",)
Solver = Callable[[Brake], Response]
Offsets = dict[str, dict[str, list[tuple[float, float]]]]
Merits = dict[str, dict[str, list[tuple[float, Merit]]]]
Curve = tuple[Floats, Floats]  # x and y
POST_MODELS: dict[str, Solver] = {
    "foundation": foundation.solve,
    "lifted": partial(foundation.solve, lift=ALL_LIFTS),
    "sine": sine,
}
TILT_AND_MODELS: dict[str, Solver] = {
    "tilt": partial(foundation.solve, lift=("tilt",)),
    **POST_MODELS,
}
MATCHED_ASSUMPTIONS = {
    "drum.ring": None,
    "shoe.lining.material": {"E": 2e6, "nu": 0.0},
    "shoe.backing.material": {"E": 5e8, "nu": 0.0},
    "shoe.body.material.nu": 0.0,
}
COMPARED_MODELS = ("foundation", "tilt", "lifted", "sine")
MAPPED_MODELS = ("sine", "foundation", "lifted")
MODEL_NAMES = {
    "fem": "finite elements",
    "sine": "sine law",
    "foundation": "foundation, as printed",
    "lifted": "foundation, all lifted",
}


@dataclass(frozen=True)
class ErrorMap:
    """The error of a model over two groups: `x` (n,), `y` (m,), `error` (m, n) as fractions, nan
    where none.
    """

    title: str
    x: Floats
    y: Floats
    error: Floats


def torques(response: Response) -> Floats:
    """Torque of each shoe [N m] (shoes,)."""
    return np.array([shoe.torque for shoe in response.shoes])


def worst(response: Response, true: Response) -> float:
    """The error of the torque of the shoe that is farthest off."""
    errors = torques(response) / torques(true) - 1
    return float(errors[np.argmax(np.abs(errors))])


def lift_rows(brake: Brake, fem: Response) -> list[dict[str, Any]]:
    """The paper's model with its simplifications lifted one at a time and together, against finite
    elements.
    """
    rows = []
    for lift in ((), *((name,) for name in foundation.LIFTS), ALL_LIFTS):
        response = foundation.solve(brake, lift=lift)
        row = {"lift": ", ".join(lift) or "none (the paper)", "torque": response.torque}
        row |= {
            f"error_{shoe.name}": relative(shoe.torque, true.torque)
            for shoe, true in zip(response.shoes, fem.shoes, strict=True)
        }
        rows.append(row | {"error": relative(response.torque, fem.torque)})
    return rows


def gaps(brake: Brake, gap: Callable[[Floats], Floats]) -> Brake:
    """The brake with a clearance gap(theta) [m] on every lining, theta from the beam's normal."""
    changes = {}
    for i, shoe in enumerate(brake.shoes):
        theta = np.linspace(shoe.lining.start, shoe.lining.end, 181)
        axis = axis_of(shoe.pin.xy, shoe.actuation.point.xy)
        changes[f"shoe[{i}].lining.clearance"] = np.column_stack(
            [theta, gap(axis.angle(theta))]
        ).tolist()
    return vary(brake, changes)


def radius_gap(brake: Brake, larger: float) -> Brake:
    """Linings of a radius `larger` [m] than the drum's, touching at their middles (< 0: at their
    ends).
    """
    end = math.cos(0.5 * (brake.shoes[0].lining.end - brake.shoes[0].lining.start))
    return gaps(brake, lambda theta: larger * ((1.0 if larger > 0 else end) - np.cos(theta)))


def clearance_rows(brake: Brake, scene: PreparedModel) -> list[dict[str, Any]]:
    """What clearances do: a lining that fits, new ones, one set off, one worn in."""
    cases = {
        "fits": brake,
        "new lining, radius 1 mm larger": radius_gap(brake, 1e-3),
        "new lining, radius 1 mm smaller": radius_gap(brake, -1e-3),
        "set 1 mm towards the loaded end": gaps(
            brake, lambda theta: 1e-3 * (np.sin(theta) - np.sin(theta).min())
        ),
        "set 1 mm towards the hinge": gaps(
            brake, lambda theta: 1e-3 * (np.sin(theta).max() - np.sin(theta))
        ),
        "worn in": worn_in_foundation(brake, lift=ALL_LIFTS),
    }
    nominal, rows = sine(brake), []
    for case, varied in cases.items():
        answers = {"fem": respond(scene, varied), "lifted": POST_MODELS["lifted"](varied)}
        for model, response in answers.items():
            merits = with_merits(varied, response).merits
            for shoe, merit, law in zip(response.shoes, merits, nominal.shoes, strict=True):
                assert isinstance(merit, Merit)
                arcs = (
                    f"{math.degrees(a):.0f} to {math.degrees(b):.0f}" for a, b in shoe.contact_arcs
                )
                row = {
                    "case": case,
                    "model": MODEL_NAMES[model],
                    "shoe": shoe.name,
                    "torque": shoe.torque,
                }
                row |= {
                    "from_nominal": relative(shoe.torque, law.torque),
                    "peak": shoe.peak_pressure,
                }
                row |= {
                    "psi": merit.friction_radius,
                    "angle": merit.resultant_angle,
                    "S": merit.shoe_factor,
                }
                rows.append(row | {"contact": ", ".join(arcs)})
    return rows


def radius_errors(brake: Brake, scene: PreparedModel, errors: Floats) -> Offsets:
    """Shoe -> model -> (error of the lining's radius [m], torque over that of the sine law - 1).

    errors (n,) [m]: radius of the lining minus that of the drum.
    """
    nominal = torques(sine(brake))
    found: Offsets = {shoe.name: {} for shoe in brake.shoes}
    solvers: dict[str, Solver] = {name: POST_MODELS[name] for name in ("foundation", "lifted")}
    solvers["fem"] = partial(respond, scene)
    for larger in errors.tolist():
        varied = radius_gap(brake, larger)
        for name, solver in solvers.items():
            off = torques(solver(varied)) / nominal - 1
            for shoe, error in zip(brake.shoes, off.tolist(), strict=True):
                found[shoe.name].setdefault(name, []).append((larger, error))
    return found


def merits_over_friction(brake: Brake, scene: PreparedModel, friction: Floats) -> Merits:
    """Shoe -> model -> (mu, figures of merit); models stop where they lock."""
    found: Merits = {shoe.name: {} for shoe in brake.shoes}
    solvers: dict[str, Solver] = {**POST_MODELS, "fem": partial(respond, scene)}
    for name, solver in solvers.items():
        for mu in friction.tolist():
            varied = vary(brake, {"friction": mu})
            try:
                response = solver(varied)
            except NoAnswer:
                break
            for shoe, merit in zip(brake.shoes, with_merits(varied, response).merits, strict=True):
                assert isinstance(merit, Merit)
                found[shoe.name].setdefault(name, []).append((mu, merit))
    return found


def with_arc(brake: Brake, half: float) -> dict[str, float]:
    """Changes to linings of +- half [deg] about where each beam is nearest to the drum."""
    changes = {}
    for i, shoe in enumerate(brake.shoes):
        middle = 0.5 * (shoe.lining.start + shoe.lining.end)
        changes[f"shoe[{i}].lining.start"] = middle - math.radians(half)
        changes[f"shoe[{i}].lining.end"] = middle + math.radians(half)
    return changes


def assumption_rows(brake: Brake, elements: int) -> list[dict[str, Any]]:
    """From a brake that meets the model's assumptions, each left in turn: errors of the worst
    shoe's torque.
    """
    base = vary(brake, MATCHED_ASSUMPTIONS | with_arc(brake, 15))
    ring = brake.ring
    assert ring is not None
    cases: dict[str, dict[str, Any]] = {
        "all met: 30 deg of arc, E/t of lining 1/36 of the block's, nu = 0": {},
        "60 deg of arc": with_arc(brake, 30),
        "80 deg of arc": with_arc(brake, 40),
        "nu = 0.45 in lining and block": {
            "shoe.lining.material.nu": 0.45,
            "shoe.backing.material.nu": 0.45,
        },
        "lining 100 times stiffer: the block is the spring": {"shoe.lining.material.E": 2e8},
        "the same, 80 deg of arc": {"shoe.lining.material.E": 2e8} | with_arc(brake, 40),
        "beam 10 times softer": {"shoe.body.bending_stiffness": 4.5e7},
        "beam 10 times softer, 80 deg of arc": {"shoe.body.bending_stiffness": 4.5e7}
        | with_arc(brake, 40),
        "elastic ring": {"drum.ring": ring.model_dump()},
        "elastic ring, 80 deg of arc": {"drum.ring": ring.model_dump()} | with_arc(brake, 40),
        "the brake of this study": brake.model_dump(by_alias=True),
    }
    rows = []
    for case, changes in cases.items():
        varied = brake if case == "the brake of this study" else vary(base, changes)
        fem = solve(varied, elements=elements)
        rows.append(
            {"case": case}
            | {name: worst(TILT_AND_MODELS[name](varied), fem) for name in COMPARED_MODELS}
        )
    return rows


def groups(brake: Brake) -> tuple[float, float]:
    """k R^4/EI of the beam and of the ring, k the stiffness of the layers per length of arc."""
    shoe, ring, R = brake.shoes[0], brake.ring, brake.size
    assert shoe.backing is not None and shoe.body is not None and ring is not None
    lining = shoe.lining
    k = lining.width / (
        lining.thickness / lining.material.E_through
        + shoe.backing.thickness / shoe.backing.material.E_through
    )
    return k * R**4 / shoe.body.plates["shoe"].bending_stiffness, k * R**4 / ring.EI


def error_maps(
    brake: Brake, points: int, elements: int
) -> tuple[list[list[ErrorMap]], list[tuple[float, float]]]:
    """Rows of maps, for block stiff or soft against the lining; in each the worst shoe's torque
    error of each model.
    """
    x, y = np.geomspace(0.3, 300, points), np.geomspace(0.3, 300, points)
    rows, places = [], []
    for said, layers in (
        ("soft lining", {"shoe.lining.material.E": 5e6, "shoe.backing.material.E": 3e9}),
        ("wooden block", {}),
    ):
        soft = vary(brake, layers)
        beam, ring = groups(soft)
        body = soft.shoes[0].body
        assert soft.ring is not None and body is not None
        EI, EI_r = body.plates["shoe"].bending_stiffness * beam, soft.ring.EI * ring
        error = {name: np.full((points, points), np.nan) for name in POST_MODELS}
        for i, at_y in enumerate(y.tolist()):
            for j, at_x in enumerate(x.tolist()):
                varied = vary(
                    soft,
                    {
                        "shoe.body.bending_stiffness": EI / at_x,
                        "drum.ring.bending_stiffness": EI_r / at_y,
                    },
                )
                try:
                    fem = solve(varied, elements=elements)
                    for name, model in POST_MODELS.items():
                        error[name][i, j] = worst(model(varied), fem)
                except NoAnswer:
                    continue
        rows.append(
            [ErrorMap(f"{MODEL_NAMES[name]}, {said}", x, y, error[name]) for name in MAPPED_MODELS]
        )
        places.append((beam, ring))
    return rows, places


def grid_rows(brake: Brake, repeats: int) -> list[dict[str, Any]]:
    """Errors of the foundation model against a far finer grid, their ratios, steps and cost."""
    fixed = vary(
        brake,
        {
            "shoe.lining.material.E": 5e6,
            "shoe.body.bending_stiffness": 4e9,
            "drum.ring.bending_stiffness": 4e9,
            "shoe[0].lining.end": math.radians(35),
        },
    )

    def numbers(response: Response) -> Floats:
        merit = response.merits[0]
        assert isinstance(merit, Merit)
        return np.array(
            [response.torque, response.shoes[0].normal_force, merit.friction_radius or 0.0]
        )

    fine, rows, before = numbers(foundation.solve(fixed, sections=2880)), [], np.full(3, np.nan)
    for n in (45, 90, 180, 360, 720, 1440):
        errors = np.abs(numbers(foundation.solve(fixed, sections=n)) / fine - 1)
        outcome = timed("foundation", partial(foundation.solve, brake, sections=n), repeats)
        assert outcome.response is not None
        row: dict[str, Any] = {
            "n": n,
            "steps": outcome.response.iterations,
            "seconds": outcome.seconds,
        }
        if n <= 720:
            names = ("torque", "N", "psi")
            row |= dict(zip(names, errors.tolist(), strict=True))
            row |= {
                f"{name}_ratio": ratio
                for name, ratio in zip(names, (before / errors).tolist(), strict=True)
            }
        rows.append(row)
        before = errors
    return rows


def beam_curves(
    scene: PreparedModel, brake: Brake, responses: Mapping[str, Response]
) -> list[dict[str, Curve]]:
    """For each shoe, by each elastic model, the deformation r [m] along its beam [m], off the line
    through its ends.
    """
    made, fem = [], respond(scene, brake)
    for i in range(len(brake.shoes)):
        x, w = beam_deflection(scene, brake, fem, i)
        models: dict[str, Curve] = {"fem": (x, w - w[-1] * x / x[-1])}
        for name in ("foundation", "lifted"):
            deformation = responses[name].shoes[i].deformation
            assert deformation is not None
            models[name] = (deformation.x, deformation.relative)
        made.append(models)
    return made


def rim_curves(
    scene: PreparedModel, brake: Brake, responses: Mapping[str, Response]
) -> tuple[dict[str, Curve], dict[str, Curve]]:
    """The rim's displacement [m] over the angle [rad]: the paper's rim of each shoe, and the one
    rim of all shoes by the foundation with all lifted and by finite elements.
    """
    turn = np.linspace(0, 2 * np.pi, 400)
    printed = foundation.rim(brake, responses["foundation"], turn)
    lifted = foundation.rim(brake, responses["lifted"], turn, ALL_LIFTS).sum(axis=0)
    theta, z = rim_displacement(scene, brake, respond(scene, brake))
    fem = np.append(theta, theta[0]), np.append(z, z[0])
    own = {shoe.name: (turn, z) for shoe, z in zip(brake.shoes, printed, strict=True)}
    return own, {"lifted": (turn, lifted), "fem": fem}
