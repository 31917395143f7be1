"""Rows, curves and maps on a post brake by sine law, foundation model and finite elements.

They show the error of each simplification of the foundation model, the effect of clearances and
friction, the range of the model's assumptions, and the convergence of its grids.
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
from drumlin.fem.analysis.deflection import deflection_along_beam, inward_displacement_of_rim
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.solve import solve
from drumlin.laws import sine
from drumlin.lining_wear.worn_in import worn_in_foundation_brake
from drumlin.response.merit import with_merits
from drumlin.response.norms import relative
from drumlin.response.response import Merit, Response

ALL_LIFTS = ("all",)
"""The option that lifts all simplifications of the foundation model."""
Solver = Callable[[Brake], Response]
Offsets = dict[str, dict[str, list[tuple[float, float]]]]
"""By shoe and model: error of the lining's radius [m], and relative change of the torque."""
Merits = dict[str, dict[str, list[tuple[float, Merit]]]]
"""By shoe and model: friction, and figures of merit."""
Curve = tuple[Floats, Floats]
"""Abscissas (n,) and ordinates (n,) of a curve."""
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
"""Changes by which a brake meets the assumptions of the foundation model.

The lining is soft, the block stiff against it, the drum rigid, and nothing contracts laterally.
"""
COMPARED_MODELS = ("foundation", "tilt", "lifted", "sine")
"""The models in the table of violated assumptions, names of TILT_AND_MODELS."""
MAPPED_MODELS = ("sine", "foundation", "lifted")
"""The models with a map of their errors, names of POST_MODELS."""
MODEL_NAMES = {
    "fem": "finite elements",
    "sine": "sine law",
    "foundation": "foundation, as printed",
    "lifted": "foundation, all lifted",
}
"""Names of the models in tables and figures."""


@dataclass(frozen=True)
class ErrorMap:
    """The relative error of a model over two dimensionless groups.

    Attributes
    ----------
    title : str
        Title of the map.
    x, y : array (n,), array (m,)
        Values of the groups k R^4/EI of beam and ring.
    error : array (m, n)
        Relative errors, nan where a model has no answer.
    """

    title: str
    x: Floats
    y: Floats
    error: Floats


def shoe_torques(response: Response) -> Floats:
    """Torque of each shoe (shoes,) [N m]."""
    return np.array([shoe.torque for shoe in response.shoes])


def largest_torque_error(response: Response, true: Response) -> float:
    """The relative error of largest size among the torques of the shoes."""
    errors = shoe_torques(response) / shoe_torques(true) - 1
    return float(errors[np.argmax(np.abs(errors))])


def lift_rows(brake: Brake, fem: Response) -> list[dict[str, Any]]:
    """Rows of the paper's model against finite elements.

    The simplifications of the model are lifted one at a time, and all together in the last row.
    """
    rows = []
    for lift in ((), *((name,) for name in foundation.LIFTS), ALL_LIFTS):
        response = foundation.solve(brake, lift=lift)
        row = {"lift": ", ".join(lift) or "none (the paper)", "torque": response.torque}
        for shoe, true in zip(response.shoes, fem.shoes, strict=True):
            row[f"error_{shoe.name}"] = relative(shoe.torque, true.torque)
        rows.append(row | {"error": relative(response.torque, fem.torque)})
    return rows


def brake_with_clearance(brake: Brake, gap: Callable[[Floats], Floats]) -> Brake:
    """The brake with a clearance on every lining.

    gap : clearance [m] over the angle from the beam's normal [rad].
    """
    changes = {}
    for i, shoe in enumerate(brake.shoes):
        theta = np.linspace(shoe.lining.start, shoe.lining.end, 181)
        axis = axis_of(shoe.pin.xy, shoe.actuation.point.xy)
        table = np.column_stack([theta, gap(axis.angle(theta))])
        changes[f"shoe[{i}].lining.clearance"] = table.tolist()
    return vary(brake, changes)


def brake_with_other_lining_radius(brake: Brake, larger: float) -> Brake:
    """The brake with linings of another radius, which touch the drum in one place.

    larger : radius of the lining less that of the drum [m]. A larger lining touches with its
    middle, a smaller one with its ends.
    """
    end = math.cos(0.5 * (brake.shoes[0].lining.end - brake.shoes[0].lining.start))
    zero_at = 1.0 if larger > 0 else end
    return brake_with_clearance(brake, lambda theta: larger * (zero_at - np.cos(theta)))


def clearance_rows(brake: Brake, scene: PreparedModel) -> list[dict[str, Any]]:
    """Rows on clearances: linings that fit, of another radius, displaced, and worn in."""
    cases = {
        "fits": brake,
        "new lining, radius 1 mm larger": brake_with_other_lining_radius(brake, 1e-3),
        "new lining, radius 1 mm smaller": brake_with_other_lining_radius(brake, -1e-3),
        "set 1 mm towards the loaded end": brake_with_clearance(
            brake, lambda theta: 1e-3 * (np.sin(theta) - np.sin(theta).min())
        ),
        "set 1 mm towards the hinge": brake_with_clearance(
            brake, lambda theta: 1e-3 * (np.sin(theta).max() - np.sin(theta))
        ),
        "worn in": worn_in_foundation_brake(brake, lift=ALL_LIFTS),
    }
    nominal, rows = sine(brake), []
    for case, varied in cases.items():
        answers = {
            "fem": solve_prepared_model(scene, varied),
            "lifted": POST_MODELS["lifted"](varied),
        }
        for model, response in answers.items():
            base = {"case": case, "model": MODEL_NAMES[model]}
            rows += [base | row for row in _shoe_rows_of_clearance(varied, response, nominal)]
    return rows


def _shoe_rows_of_clearance(
    brake: Brake, response: Response, law: Response
) -> list[dict[str, Any]]:
    """A row for each shoe of a response, against the sine law of the brake that fits."""
    rows = []
    merits = with_merits(brake, response).merits
    for shoe, merit, by_law in zip(response.shoes, merits, law.shoes, strict=True):
        assert isinstance(merit, Merit)
        arcs = (f"{math.degrees(a):.0f} to {math.degrees(b):.0f}" for a, b in shoe.contact_arcs)
        row: dict[str, Any] = {
            "shoe": shoe.name,
            "torque": shoe.torque,
            "from_nominal": relative(shoe.torque, by_law.torque),
            "peak": shoe.peak_pressure,
            "psi": merit.friction_radius,
            "angle": merit.resultant_angle,
            "S": merit.shoe_factor,
            "contact": ", ".join(arcs),
        }
        rows.append(row)
    return rows


def torque_over_radius_error(brake: Brake, scene: PreparedModel, errors: Floats) -> Offsets:
    """Torques over the radius of the lining, relative to the sine law, minus 1.

    errors : radius of the lining less that of the drum (n,) [m].
    """
    nominal = shoe_torques(sine(brake))
    found: Offsets = {}
    # The sine law knows no clearance and is the measure here.
    solvers: dict[str, Solver] = {**POST_MODELS, "fem": partial(solve_prepared_model, scene)}
    del solvers["sine"]
    for larger in errors.tolist():
        varied = brake_with_other_lining_radius(brake, larger)
        for name, solver in solvers.items():
            off = shoe_torques(solver(varied)) / nominal - 1
            for shoe, error in zip(brake.shoes, off.tolist(), strict=True):
                of_shoe = found.setdefault(shoe.name, {})
                of_shoe.setdefault(name, []).append((larger, error))
    return found


def merits_over_friction(brake: Brake, scene: PreparedModel, friction: Floats) -> Merits:
    """Figures of merit over friction (n,). The values of a model end where it locks."""
    found: Merits = {}
    solvers: dict[str, Solver] = {**POST_MODELS, "fem": partial(solve_prepared_model, scene)}
    for name, solver in solvers.items():
        for mu in friction.tolist():
            varied = vary(brake, {"friction": mu})
            try:
                response = solver(varied)
            except NoAnswer:
                break
            for shoe, merit in zip(brake.shoes, with_merits(varied, response).merits, strict=True):
                assert isinstance(merit, Merit)
                of_shoe = found.setdefault(shoe.name, {})
                of_shoe.setdefault(name, []).append((mu, merit))
    return found


def lining_arc_changes(brake: Brake, half: float) -> dict[str, float]:
    """Changes by which each lining has an arc of +-half [deg] about its middle."""
    changes = {}
    for i, shoe in enumerate(brake.shoes):
        middle = 0.5 * (shoe.lining.start + shoe.lining.end)
        changes[f"shoe[{i}].lining.start"] = middle - math.radians(half)
        changes[f"shoe[{i}].lining.end"] = middle + math.radians(half)
    return changes


def assumption_rows(brake: Brake, elements: int) -> list[dict[str, Any]]:
    """Rows of brakes that violate the assumptions of the model one by one.

    The first brake meets all assumptions. Each row has the relative errors of the torque by
    COMPARED_MODELS, of the shoe with the largest error.
    """
    base = vary(brake, MATCHED_ASSUMPTIONS | lining_arc_changes(brake, 15))
    ring = brake.ring
    assert ring is not None
    cases: dict[str, dict[str, Any]] = {
        "all met: 30 deg of arc, E/t of lining 1/36 of the block's, nu = 0": {},
        "60 deg of arc": lining_arc_changes(brake, 30),
        "80 deg of arc": lining_arc_changes(brake, 40),
        "nu = 0.45 in lining and block": {
            "shoe.lining.material.nu": 0.45,
            "shoe.backing.material.nu": 0.45,
        },
        "lining 100 times stiffer: the block is the spring": {"shoe.lining.material.E": 2e8},
        "the same, 80 deg of arc": {"shoe.lining.material.E": 2e8} | lining_arc_changes(brake, 40),
        "beam 10 times softer": {"shoe.body.bending_stiffness": 4.5e7},
        "beam 10 times softer, 80 deg of arc": {"shoe.body.bending_stiffness": 4.5e7}
        | lining_arc_changes(brake, 40),
        "elastic ring": {"drum.ring": ring.model_dump()},
        "elastic ring, 80 deg of arc": {"drum.ring": ring.model_dump()}
        | lining_arc_changes(brake, 40),
        "the brake of this study": brake.model_dump(by_alias=True),
    }
    rows = []
    for case, changes in cases.items():
        varied = brake if case == "the brake of this study" else vary(base, changes)
        fem = solve(varied, elements=elements)
        row: dict[str, Any] = {"case": case}
        for name in COMPARED_MODELS:
            row[name] = largest_torque_error(TILT_AND_MODELS[name](varied), fem)
        rows.append(row)
    return rows


def dimensionless_groups(brake: Brake) -> tuple[float, float]:
    """The groups k R^4/EI of beam and ring, where k is the layers' stiffness per length of arc."""
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
    """Maps of the error of each model, and the groups of the brake itself.

    A row of maps is for a lining that is soft against its block, another for a wooden block. The
    error is that of the torque, of the shoe with the largest error.

    Parameters
    ----------
    brake : Brake
        The post brake.
    points : int
        Number of values of each group.
    elements : int
        Elements along a lining.
    """
    x, y = np.geomspace(0.3, 300, points), np.geomspace(0.3, 300, points)
    soft_lining = {"shoe.lining.material.E": 5e6, "shoe.backing.material.E": 3e9}
    rows, places = [], []
    for said, layers in (("soft lining", soft_lining), ("wooden block", {})):
        varied = vary(brake, layers)
        error = _errors_over_groups(varied, x, y, elements)
        maps = []
        for name in MAPPED_MODELS:
            maps.append(ErrorMap(f"{MODEL_NAMES[name]}, {said}", x, y, error[name]))
        rows.append(maps)
        places.append(dimensionless_groups(varied))
    return rows, places


def _errors_over_groups(brake: Brake, x: Floats, y: Floats, elements: int) -> dict[str, Floats]:
    """Errors (m, n) of each model over the groups of the beam (n,) and of the ring (m,).

    An error is nan where a model has no answer.
    """
    beam, ring = dimensionless_groups(brake)
    body = brake.shoes[0].body
    assert brake.ring is not None and body is not None
    # Bending stiffnesses [N m^2] of the beam and of the ring for which the groups are 1.
    EI, EI_r = body.plates["shoe"].bending_stiffness * beam, brake.ring.EI * ring
    error = {name: np.full((len(y), len(x)), np.nan) for name in POST_MODELS}
    for i, at_y in enumerate(y.tolist()):
        for j, at_x in enumerate(x.tolist()):
            stiffnesses = {
                "shoe.body.bending_stiffness": EI / at_x,
                "drum.ring.bending_stiffness": EI_r / at_y,
            }
            varied = vary(brake, stiffnesses)
            try:
                fem = solve(varied, elements=elements)
                for name, model in POST_MODELS.items():
                    error[name][i, j] = largest_torque_error(model(varied), fem)
            except NoAnswer:
                continue
    return error


def grid_rows(brake: Brake, repeats: int) -> list[dict[str, Any]]:
    """Rows of grids of the foundation model: errors against a far finer grid, steps and time."""
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
        """Torque, normal force and friction radius of the first shoe."""
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
        # The grid of 1440 is too near to the reference of 2880 for an error.
        if n <= 720:
            names = ("torque", "N", "psi")
            row |= dict(zip(names, errors.tolist(), strict=True))
            for name, ratio in zip(names, (before / errors).tolist(), strict=True):
                row[f"{name}_ratio"] = ratio
        rows.append(row)
        before = errors
    return rows


def beam_deflections(
    scene: PreparedModel, brake: Brake, responses: Mapping[str, Response]
) -> list[dict[str, Curve]]:
    """Deflection [m] along the beam [m] of each shoe, by model.

    It is taken from the line through both ends of the beam.
    """
    made, fem = [], solve_prepared_model(scene, brake)
    for i in range(len(brake.shoes)):
        x, w = deflection_along_beam(scene, brake, fem, i)
        models: dict[str, Curve] = {"fem": (x, w - w[-1] * x / x[-1])}
        for name in ("foundation", "lifted"):
            deformation = responses[name].shoes[i].deformation
            assert deformation is not None
            models[name] = (deformation.x, deformation.relative)
        made.append(models)
    return made


def rim_displacements(
    scene: PreparedModel, brake: Brake, responses: Mapping[str, Response]
) -> tuple[dict[str, Curve], dict[str, Curve]]:
    """Radial displacement [m] of the rim over the angle [rad].

    The first result has a rim for each shoe, as in the paper. The second has the rim under all
    shoes, by the foundation model with all simplifications lifted and by finite elements.
    """
    turn = np.linspace(0, 2 * np.pi, 400)
    printed = foundation.rim(brake, responses["foundation"], turn)
    lifted = foundation.rim(brake, responses["lifted"], turn, ALL_LIFTS).sum(axis=0)
    theta, z = inward_displacement_of_rim(scene, brake, solve_prepared_model(scene, brake))
    # The curve by finite elements is closed by its first point.
    fem = np.append(theta, theta[0]), np.append(z, z[0])
    own = {shoe.name: (turn, z) for shoe, z in zip(brake.shoes, printed, strict=True)}
    return own, {"lifted": (turn, lifted), "fem": fem}
