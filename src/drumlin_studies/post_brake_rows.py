"""Table rows, curves and maps: a post brake by sine law, foundation model and finite elements.

A post brake presses blocks on straight beams ("posts") against a drum. The results show the error
of each simplification of the foundation model, the effect of clearances and friction, brakes for
which the model's assumptions hold or do not hold, and the convergence of the model with finer
grids.
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
from drumlin.brake.beam_axis import make_beam_axis
from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.comparison import solve_and_time_model as timed
from drumlin.fem.analysis.deflection import (
    angles_and_inward_displacements_of_ring_surface,
    stations_and_deflections_of_beam,
)
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.solve import solve
from drumlin.laws import solve_brake_by_sine_law
from drumlin.lining_wear.worn_in import post_brake_with_worn_in_clearances
from drumlin.response.merit import response_with_figures_of_merit
from drumlin.response.norms import relative_error_of_number
from drumlin.response.response import FiguresOfMeritOnDrum, Response

LIFT_OPTION_WITH_ALL_EFFECTS = ("all",)
"""Value of the option `lift` with which the foundation model includes all effects that the
published model neglects.
"""
FunctionThatSolvesBrakeByModel = Callable[[Brake], Response]
"""A function that returns the response of a brake by one model."""
TorqueDifferencesOverRadiusOffset = dict[str, dict[str, list[tuple[float, float]]]]
"""For each shoe and model a list of pairs: radius of the lining minus radius of the drum [m], and
relative difference of the shoe's torque from its torque by the sine law.
"""
FiguresOfMeritOverFriction = dict[str, dict[str, list[tuple[float, FiguresOfMeritOnDrum]]]]
"""For each shoe and model a list of pairs: coefficient of friction, and the shoe's figures of merit
(`FiguresOfMeritOnDrum`).
"""
AbscissasAndOrdinatesOfCurve = tuple[Floats, Floats]
"""Abscissas (n,) and ordinates (n,) of a curve."""
POST_BRAKE_SOLVERS_BY_MODEL_NAME: dict[str, FunctionThatSolvesBrakeByModel] = {
    "foundation": foundation.solve_brake_by_foundation_model,
    "lifted": partial(
        foundation.solve_brake_by_foundation_model, lift=LIFT_OPTION_WITH_ALL_EFFECTS
    ),
    "sine": solve_brake_by_sine_law,
}
"""Solvers of a post brake by name. "foundation" is the foundation model as published. "lifted" is
the same model with all effects that the published model neglects.
"""
POST_BRAKE_SOLVERS_AND_TILT_SOLVER_BY_NAME: dict[str, FunctionThatSolvesBrakeByModel] = {
    "tilt": partial(foundation.solve_brake_by_foundation_model, lift=("tilt",)),
    **POST_BRAKE_SOLVERS_BY_MODEL_NAME,
}
"""Solvers of a post brake by name: POST_BRAKE_SOLVERS_BY_MODEL_NAME and "tilt".

"tilt" is the published foundation model with one more effect, the tilt of the beam's sections.
"""
CHANGES_TO_MEET_FOUNDATION_ASSUMPTIONS = {
    "drum.ring": None,
    "shoe.lining.material": {"E": 2e6, "nu": 0.0},
    "shoe.backing.material": {"E": 5e8, "nu": 0.0},
    "shoe.body.material.nu": 0.0,
}
"""Changes of a brake file after which the brake meets the assumptions of the foundation model.

The lining is soft, the block is stiff compared with the lining, the drum is rigid, and Poisson's
ratio is zero.
"""
NAMES_OF_MODELS_FOR_VIOLATED_ASSUMPTIONS = ("foundation", "tilt", "lifted", "sine")
"""The models in the table of brakes that violate assumptions of the foundation model. The names are
keys of POST_BRAKE_SOLVERS_AND_TILT_SOLVER_BY_NAME.
"""
NAMES_OF_MODELS_WITH_ERROR_MAPS = ("sine", "foundation", "lifted")
"""The models whose errors are shown as maps, by their names in POST_BRAKE_SOLVERS_BY_MODEL_NAME."""
WORDS_FOR_POST_BRAKE_MODELS_BY_KEY = {
    "fem": "finite elements",
    "sine": "sine law",
    "foundation": "foundation, as published",
    "lifted": "foundation, unsimplified",
}
"""Words for the models in tables and figures, by key."""


@dataclass(frozen=True)
class TorqueErrorMapOverStiffnessGroups:
    """Map of the relative error of a model's torque over two dimensionless groups.

    Attributes
    ----------
    title : str
        Title of the map.
    x, y : array (n,), array (m,)
        Values of the dimensionless group k R^4/EI, x for the beam and y for the ring: k is the
        stiffness of lining and block per length of the arc [N/m^2], R the drum's radius, and EI the
        bending stiffness of the beam or of the ring.
    error : array (m, n)
        Relative errors, nan where the model or the finite elements have no answer.
    """

    title: str
    x: Floats
    y: Floats
    error: Floats


def torques_of_all_shoes_of_response(response: Response) -> Floats:
    """The torques (shoes,) of all shoes of a response [N m]."""
    return np.array([shoe.torque for shoe in response.shoes])


def largest_relative_torque_error_of_shoes(response: Response, true: Response) -> float:
    """The largest relative error of a shoe's torque, with its sign.

    response : the response that is judged; true : the response that serves as the truth.
    """
    errors = torques_of_all_shoes_of_response(response) / torques_of_all_shoes_of_response(true) - 1
    return float(errors[np.argmax(np.abs(errors))])


def error_rows_of_foundation_model_effects(brake: Brake, fem: Response) -> list[dict[str, Any]]:
    """Rows with the relative errors of the foundation model's torque against finite elements.

    The first row belongs to the published model. In each further row the model includes one of the
    effects that the published model neglects. In the last row the model includes all of these
    effects.

    brake : the post brake; fem : its response by finite elements.
    """
    rows = []
    for lift in (
        (),
        *((name,) for name in foundation.INCLUDABLE_EFFECTS),
        LIFT_OPTION_WITH_ALL_EFFECTS,
    ):
        response = foundation.solve_brake_by_foundation_model(brake, lift=lift)
        row = {"lift": ", ".join(lift) or "none (the paper)", "torque": response.torque}
        for shoe, true in zip(response.shoes, fem.shoes, strict=True):
            row[f"error_{shoe.name}"] = relative_error_of_number(shoe.torque, true.torque)
        rows.append(row | {"error": relative_error_of_number(response.torque, fem.torque)})
    return rows


def brake_with_clearances_by_function_of_angle(
    brake: Brake, gap: Callable[[Floats], Floats]
) -> Brake:
    """The brake with a table of clearances on every lining.

    gap : returns the clearances [m] at angles [rad] from the normal of the beam.
    """
    # Each lining gets a table with 181 rows of an angle and a clearance.
    changes = {}
    for i, shoe in enumerate(brake.shoes):
        theta = np.linspace(shoe.lining.start, shoe.lining.end, 181)
        axis = make_beam_axis(shoe.pin.xy, shoe.actuation.point.xy)
        table = np.column_stack([theta, gap(axis.angle(theta))])
        changes[f"shoe[{i}].lining.clearance"] = table.tolist()
    return vary(brake, changes)


def brake_with_other_lining_radius(brake: Brake, larger: float) -> Brake:
    """The brake with linings whose radius differs from the drum's radius.

    An unloaded lining of larger radius touches the drum with its middle, a lining of smaller radius
    with its ends.

    larger : radius of the lining minus radius of the drum [m].
    """
    # The gap is zero in the middle of a lining of larger radius, and at the ends of a lining of
    # smaller radius.
    end = math.cos(0.5 * (brake.shoes[0].lining.end - brake.shoes[0].lining.start))
    zero_at = 1.0 if larger > 0 else end
    return brake_with_clearances_by_function_of_angle(
        brake, lambda theta: larger * (zero_at - np.cos(theta))
    )


def rows_of_post_brake_results_by_clearance(
    brake: Brake, scene: PreparedModel
) -> list[dict[str, Any]]:
    """A row for each clearance, model and shoe: torque, peak pressure, figures of merit, contact.

    In the cases of clearance the linings fit, have another radius, are displaced, or are worn in.

    brake : the post brake with linings that fit; scene : its prepared model by finite elements.
    """
    cases = {
        "fits": brake,
        "new lining, radius 1 mm larger": brake_with_other_lining_radius(brake, 1e-3),
        "new lining, radius 1 mm smaller": brake_with_other_lining_radius(brake, -1e-3),
        "set 1 mm towards the loaded end": brake_with_clearances_by_function_of_angle(
            brake, lambda theta: 1e-3 * (np.sin(theta) - np.sin(theta).min())
        ),
        "set 1 mm towards the hinge": brake_with_clearances_by_function_of_angle(
            brake, lambda theta: 1e-3 * (np.sin(theta).max() - np.sin(theta))
        ),
        "worn in": post_brake_with_worn_in_clearances(brake, lift=LIFT_OPTION_WITH_ALL_EFFECTS),
    }
    nominal, rows = solve_brake_by_sine_law(brake), []
    for case, varied in cases.items():
        answers = {
            "fem": solve_prepared_model(scene, varied),
            "lifted": POST_BRAKE_SOLVERS_BY_MODEL_NAME["lifted"](varied),
        }
        for model, response in answers.items():
            base = {"case": case, "model": WORDS_FOR_POST_BRAKE_MODELS_BY_KEY[model]}
            rows += [base | row for row in _shoe_rows_of_response(varied, response, nominal)]
    return rows


def _shoe_rows_of_response(brake: Brake, response: Response, law: Response) -> list[dict[str, Any]]:
    """A row for each shoe of a response.

    `from_nominal` is the relative difference of the torque from the torque by the sine law.

    brake : the brake with clearances; response : its response; law : the response by the sine law
    of the brake with linings that fit.
    """
    rows = []
    merits = response_with_figures_of_merit(brake, response).merits
    for shoe, merit, by_law in zip(response.shoes, merits, law.shoes, strict=True):
        assert isinstance(merit, FiguresOfMeritOnDrum)
        arcs = (f"{math.degrees(a):.0f} to {math.degrees(b):.0f}" for a, b in shoe.contact_arcs)
        row: dict[str, Any] = {
            "shoe": shoe.name,
            "torque": shoe.torque,
            "from_nominal": relative_error_of_number(shoe.torque, by_law.torque),
            "peak": shoe.peak_pressure,
            "psi": merit.friction_radius,
            "angle": merit.resultant_angle,
            "S": merit.shoe_factor,
            "contact": ", ".join(arcs),
        }
        rows.append(row)
    return rows


def torque_differences_from_sine_law_at_lining_radii(
    brake: Brake, scene: PreparedModel, errors: Floats
) -> TorqueDifferencesOverRadiusOffset:
    """Relative torque differences from the sine law, for linings of another radius.

    The result has a list of pairs (radius difference, torque difference) for each shoe and model.

    Parameters
    ----------
    brake : Brake
        The post brake.
    scene : PreparedModel
        The model of the brake that is prepared for finite elements.
    errors : array (n,)
        Radius of the lining minus radius of the drum [m].
    """
    nominal = torques_of_all_shoes_of_response(solve_brake_by_sine_law(brake))
    found: TorqueDifferencesOverRadiusOffset = {}
    # The sine law does not depend on clearances. Its torque is the reference of all models.
    solvers: dict[str, FunctionThatSolvesBrakeByModel] = {
        **POST_BRAKE_SOLVERS_BY_MODEL_NAME,
        "fem": partial(solve_prepared_model, scene),
    }
    del solvers["sine"]
    for larger in errors.tolist():
        varied = brake_with_other_lining_radius(brake, larger)
        for name, solver in solvers.items():
            off = torques_of_all_shoes_of_response(solver(varied)) / nominal - 1
            for shoe, error in zip(brake.shoes, off.tolist(), strict=True):
                of_shoe = found.setdefault(shoe.name, {})
                of_shoe.setdefault(name, []).append((larger, error))
    return found


def figures_of_merit_at_friction_coefficients(
    brake: Brake, scene: PreparedModel, friction: Floats
) -> FiguresOfMeritOverFriction:
    """Figures of merit of each shoe and model over the coefficient of friction.

    The list of a model ends before the first friction at which a shoe locks and the model has no
    answer.

    brake : the post brake; scene : its prepared model by finite elements; friction : coefficients
    (n,) in growing order.
    """
    found: FiguresOfMeritOverFriction = {}
    solvers: dict[str, FunctionThatSolvesBrakeByModel] = {
        **POST_BRAKE_SOLVERS_BY_MODEL_NAME,
        "fem": partial(solve_prepared_model, scene),
    }
    for name, solver in solvers.items():
        for mu in friction.tolist():
            varied = vary(brake, {"friction": mu})
            # NoAnswer means self-locking: at larger friction the model has no answer either.
            try:
                response = solver(varied)
            except NoAnswer:
                break
            for shoe, merit in zip(
                brake.shoes, response_with_figures_of_merit(varied, response).merits, strict=True
            ):
                assert isinstance(merit, FiguresOfMeritOnDrum)
                of_shoe = found.setdefault(shoe.name, {})
                of_shoe.setdefault(name, []).append((mu, merit))
    return found


def brake_changes_for_lining_arc(brake: Brake, half: float) -> dict[str, float]:
    """The changes of a brake file that give each lining an arc of +-`half` [deg] at its middle."""
    changes = {}
    for i, shoe in enumerate(brake.shoes):
        middle = 0.5 * (shoe.lining.start + shoe.lining.end)
        changes[f"shoe[{i}].lining.start"] = middle - math.radians(half)
        changes[f"shoe[{i}].lining.end"] = middle + math.radians(half)
    return changes


def error_rows_of_violated_assumptions(brake: Brake, elements: int) -> list[dict[str, Any]]:
    """A row for each of several brakes that violate assumptions of the foundation model.

    The first brake meets all assumptions, and the last one is the given brake itself. A row has the
    relative error of the torque by each of NAMES_OF_MODELS_FOR_VIOLATED_ASSUMPTIONS against finite
    elements, for the shoe with the largest error.

    brake : the post brake; elements : number of elements along each lining.
    """
    base = vary(
        brake, CHANGES_TO_MEET_FOUNDATION_ASSUMPTIONS | brake_changes_for_lining_arc(brake, 15)
    )
    ring = brake.ring
    assert ring is not None
    cases: dict[str, dict[str, Any]] = {
        "all met: 30 deg of arc, E/t of lining 1/36 of the block's, nu = 0": {},
        "60 deg of arc": brake_changes_for_lining_arc(brake, 30),
        "80 deg of arc": brake_changes_for_lining_arc(brake, 40),
        "nu = 0.45 in lining and block": {
            "shoe.lining.material.nu": 0.45,
            "shoe.backing.material.nu": 0.45,
        },
        "lining 100 times stiffer: the block is the spring": {"shoe.lining.material.E": 2e8},
        "the same, 80 deg of arc": {"shoe.lining.material.E": 2e8}
        | brake_changes_for_lining_arc(brake, 40),
        "beam 10 times softer": {"shoe.body.bending_stiffness": 4.5e7},
        "beam 10 times softer, 80 deg of arc": {"shoe.body.bending_stiffness": 4.5e7}
        | brake_changes_for_lining_arc(brake, 40),
        "elastic ring": {"drum.ring": ring.model_dump()},
        "elastic ring, 80 deg of arc": {"drum.ring": ring.model_dump()}
        | brake_changes_for_lining_arc(brake, 40),
        "the brake of this study": brake.model_dump(by_alias=True),
    }
    # Each brake is also solved by finite elements, which serve as the truth for the models.
    rows = []
    for case, changes in cases.items():
        varied = brake if case == "the brake of this study" else vary(base, changes)
        fem = solve(varied, elements=elements)
        row: dict[str, Any] = {"case": case}
        for name in NAMES_OF_MODELS_FOR_VIOLATED_ASSUMPTIONS:
            row[name] = largest_relative_torque_error_of_shoes(
                POST_BRAKE_SOLVERS_AND_TILT_SOLVER_BY_NAME[name](varied), fem
            )
        rows.append(row)
    return rows


def dimensionless_stiffnesses_of_beam_and_ring(brake: Brake) -> tuple[float, float]:
    """The dimensionless groups k R^4/EI of the beam and of the ring of a post brake.

    k is the stiffness of lining and block in series, per length of the arc [N/m^2]. R is the radius
    of the drum, and EI the bending stiffness of the beam or of the ring. k and the beam are those
    of the first shoe.
    """
    shoe, ring, R = brake.shoes[0], brake.ring, brake.size
    assert shoe.backing is not None and shoe.body is not None and ring is not None
    lining = shoe.lining
    k = lining.width / (
        lining.thickness / lining.material.E_through
        + shoe.backing.thickness / shoe.backing.material.E_through
    )
    return k * R**4 / shoe.body.plates["shoe"].bending_stiffness, k * R**4 / ring.EI


def torque_error_maps_of_models_and_groups_of_brake(
    brake: Brake, points: int, elements: int
) -> tuple[list[list[TorqueErrorMapOverStiffnessGroups]], list[tuple[float, float]]]:
    """Maps of the torque's error over the dimensionless groups of beam and ring, by model.

    The first result has two rows of maps, with a map in each row for each of
    NAMES_OF_MODELS_WITH_ERROR_MAPS. In the first row the lining is soft compared with its block. In
    the second row the block is of wood, as in the brake file. The error is against finite elements,
    for the shoe with the largest error. The second result has for each row the values of both
    groups with the brake's own beam and ring.

    Parameters
    ----------
    brake : Brake
        The post brake.
    points : int
        Number of values of each dimensionless group.
    elements : int
        Elements along a lining.
    """
    x, y = np.geomspace(0.3, 300, points), np.geomspace(0.3, 300, points)
    soft_lining = {"shoe.lining.material.E": 5e6, "shoe.backing.material.E": 3e9}
    rows, places = [], []
    for said, layers in (("soft lining", soft_lining), ("wooden block", {})):
        varied = vary(brake, layers)
        error = _torque_errors_at_dimensionless_stiffness_groups(varied, x, y, elements)
        maps = []
        for name in NAMES_OF_MODELS_WITH_ERROR_MAPS:
            maps.append(
                TorqueErrorMapOverStiffnessGroups(
                    f"{WORDS_FOR_POST_BRAKE_MODELS_BY_KEY[name]}, {said}", x, y, error[name]
                )
            )
        rows.append(maps)
        places.append(dimensionless_stiffnesses_of_beam_and_ring(varied))
    return rows, places


def _torque_errors_at_dimensionless_stiffness_groups(
    brake: Brake, x: Floats, y: Floats, elements: int
) -> dict[str, Floats]:
    """Maps (m, n) of the torque's relative error over two dimensionless groups, by model.

    An error is nan where a model or the finite elements have no answer.

    x, y : values (n,) of the group of the beam and (m,) of the group of the ring; elements : number
    of elements along each lining.
    """
    beam, ring = dimensionless_stiffnesses_of_beam_and_ring(brake)
    body = brake.shoes[0].body
    assert brake.ring is not None and body is not None
    # Bending stiffnesses [N m^2] of the beam and of the ring with which the dimensionless groups
    # are 1.
    EI, EI_r = body.plates["shoe"].bending_stiffness * beam, brake.ring.EI * ring
    error = {name: np.full((len(y), len(x)), np.nan) for name in POST_BRAKE_SOLVERS_BY_MODEL_NAME}
    for i, at_y in enumerate(y.tolist()):
        for j, at_x in enumerate(x.tolist()):
            stiffnesses = {
                "shoe.body.bending_stiffness": EI / at_x,
                "drum.ring.bending_stiffness": EI_r / at_y,
            }
            varied = vary(brake, stiffnesses)
            try:
                fem = solve(varied, elements=elements)
                for name, model in POST_BRAKE_SOLVERS_BY_MODEL_NAME.items():
                    error[name][i, j] = largest_relative_torque_error_of_shoes(model(varied), fem)
            except NoAnswer:
                continue
    return error


def convergence_rows_of_foundation_grids(brake: Brake, repeats: int) -> list[dict[str, Any]]:
    """A row for each of several grids of the foundation model: errors, iterations and time.

    The errors of torque, normal force and friction radius are against a grid of 2880 sections. The
    errors belong to a changed brake, whose linings touch the drum along their whole length.
    Iterations and time belong to the given brake.

    brake : the post brake; repeats : number of timings.
    """
    fixed = vary(
        brake,
        {
            "shoe.lining.material.E": 5e6,
            "shoe.body.bending_stiffness": 4e9,
            "drum.ring.bending_stiffness": 4e9,
            "shoe[0].lining.end": math.radians(35),
        },
    )
    fine = _torque_normal_force_and_friction_radius(fixed, 2880)
    rows, before = [], np.full(3, np.nan)
    for n in (45, 90, 180, 360, 720, 1440):
        errors = np.abs(_torque_normal_force_and_friction_radius(fixed, n) / fine - 1)
        outcome = timed(
            "foundation",
            partial(foundation.solve_brake_by_foundation_model, brake, sections=n),
            repeats,
        )
        assert outcome.response is not None
        row: dict[str, Any] = {
            "n": n,
            "steps": outcome.response.iterations,
            "seconds": outcome.seconds,
        }
        # The errors of 1440 sections are not shown, since the reference of 2880 sections has an
        # error of similar size.
        if n <= 720:
            names = ("torque", "N", "psi")
            row |= dict(zip(names, errors.tolist(), strict=True))
            for name, ratio in zip(names, (before / errors).tolist(), strict=True):
                row[f"{name}_ratio"] = ratio
        rows.append(row)
        before = errors
    return rows


def _torque_normal_force_and_friction_radius(brake: Brake, sections: int) -> Floats:
    """The torque of a brake, and the normal force and friction radius of its first shoe, as (3,).

    The solver is the foundation model with `sections` sections along each beam.
    """
    response = foundation.solve_brake_by_foundation_model(brake, sections=sections)
    merit = response.merits[0]
    assert isinstance(merit, FiguresOfMeritOnDrum)
    return np.array([response.torque, response.shoes[0].normal_force, merit.friction_radius or 0.0])


def beam_deflection_curves_of_shoes_by_model(
    scene: PreparedModel, brake: Brake, responses: Mapping[str, Response]
) -> list[dict[str, AbscissasAndOrdinatesOfCurve]]:
    """For each shoe and model the deflection of the beam [m] over the position along it [m].

    The deflection is measured from the straight line through both ends of the beam.

    Parameters
    ----------
    scene : PreparedModel
        The model of the brake that is prepared for finite elements.
    brake : Brake
        The post brake.
    responses : mapping
        Responses by the models "foundation" and "lifted".
    """
    # The line through both ends of the beam is subtracted from the deflection by finite elements.
    made, fem = [], solve_prepared_model(scene, brake)
    for i in range(len(brake.shoes)):
        x, w = stations_and_deflections_of_beam(scene, brake, fem, i)
        models: dict[str, AbscissasAndOrdinatesOfCurve] = {"fem": (x, w - w[-1] * x / x[-1])}
        for name in ("foundation", "lifted"):
            deformation = responses[name].shoes[i].deformation
            assert deformation is not None
            models[name] = (deformation.x, deformation.relative)
        made.append(models)
    return made


def drum_rim_displacement_curves_by_model(
    scene: PreparedModel, brake: Brake, responses: Mapping[str, Response]
) -> tuple[dict[str, AbscissasAndOrdinatesOfCurve], dict[str, AbscissasAndOrdinatesOfCurve]]:
    """Curves of the inward displacement [m] of the drum's friction surface over the angle [rad].

    The first result has for each shoe the displacement that this shoe alone causes, by the
    published foundation model. The second result has the displacement that all shoes cause
    together. It is computed by the foundation model with all effects that the published model
    neglects ("lifted"), and by finite elements ("fem").

    Parameters
    ----------
    scene : PreparedModel
        The model of the brake that is prepared for finite elements.
    brake : Brake
        The post brake.
    responses : mapping
        Responses by the models "foundation" and "lifted".
    """
    turn = np.linspace(0, 2 * np.pi, 400)
    printed = foundation.inward_ring_displacement_under_each_shoe(
        brake, responses["foundation"], turn
    )
    lifted = foundation.inward_ring_displacement_under_each_shoe(
        brake, responses["lifted"], turn, LIFT_OPTION_WITH_ALL_EFFECTS
    ).sum(axis=0)
    theta, z = angles_and_inward_displacements_of_ring_surface(
        scene, brake, solve_prepared_model(scene, brake)
    )
    # The first point of the curve by finite elements is repeated at its end, to close the curve.
    fem = np.append(theta, theta[0]), np.append(z, z[0])
    own = {shoe.name: (turn, z) for shoe, z in zip(brake.shoes, printed, strict=True)}
    return own, {"lifted": (turn, lifted), "fem": fem}
