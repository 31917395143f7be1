"""Ranges in which plane stress is right to 1, 5 and 20 %, by comparison with shoes in 3D.

Two brakes are varied: a brake with shoes of one width, and a brake with shoes of T-section. Each
error is the difference between plane stress and shoes in 3D. The displacements of the shoes in 3D
are polynomials across the width, of the degree DEGREE_ACROSS_WIDTH_OF_LIMIT_STUDY.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from drumlin.base.errors import DrumlinError
from drumlin.brake.brake import Brake
from drumlin.brake.fields import Material
from drumlin.brake.file import vary
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.solve import solve
from drumlin.fem.width.error import relative_distance_of_plane_stress_from_width_solution
from drumlin.fem.width.ladder import (
    has_shoe_with_parts_of_different_widths,
    solve_cross_section_mesh_with_width_degree,
)

DEGREE_ACROSS_WIDTH_OF_LIMIT_STUDY = 3
"""Degree of the polynomials across the width of the shoes with which plane stress is compared."""
LIMITS_OF_PLANE_STRESS_ERROR = (0.01, 0.05, 0.20)
"""Limits of the relative error of plane stress. The study finds the range in which the error is
within each limit.
"""
NAMES_OF_LIMITED_QUANTITIES = {"pressure": "mean p over the width", "torque": "torque"}
"""Names of the compared quantities by their key in the error of plane stress."""


class VariedQuantityOfPlaneStressError(NamedTuple):
    """A quantity of a brake that the study varies.

    Attributes
    ----------
    name : name of the quantity
    values : its values
    value : function that returns the quantity's value for a brake
    brake_with_value : function that returns the brake with another value of the quantity
    needs_web : whether the quantity exists only on shoes whose parts have several widths
    """

    name: str
    values: tuple[float, ...]
    value: Callable[[Brake], float]
    brake_with_value: Callable[[Brake, float], Brake]
    needs_web: bool = False


def lining_width_over_thickness(brake: Brake) -> float:
    """The width of the first lining divided by its thickness."""
    lining = brake.shoes[0].lining
    return lining.width / lining.thickness


def brake_with_lining_width_over_thickness(brake: Brake, ratio: float) -> Brake:
    """The brake with linings whose width is `ratio` times their thickness.

    The width of the bodies is changed by the same factor. The thickness is that of the first
    lining.
    """
    shoe = brake.shoes[0]
    width = ratio * shoe.lining.thickness
    changes = {"shoe.lining.width": width}
    if shoe.body is not None:
        changes["shoe.body.width"] = width * web_width_over_lining_width(brake)
    return vary(brake, changes)


def web_width_over_lining_width(brake: Brake) -> float:
    """The width of the first web divided by the width of its lining."""
    shoe = brake.shoes[0]
    assert shoe.body is not None and shoe.body.width is not None
    return shoe.body.width / shoe.lining.width


def brake_with_web_width_over_lining_width(brake: Brake, ratio: float) -> Brake:
    """The brake whose webs are `ratio` times as wide as their linings."""
    return vary(brake, {"shoe.body.width": ratio * brake.shoes[0].lining.width})


def overhang_over_table_thickness(brake: Brake) -> float:
    """The distance from the web's side to the lining's side, divided by the table's thickness."""
    shoe = brake.shoes[0]
    assert shoe.backing is not None
    overhang = (1 - web_width_over_lining_width(brake)) * shoe.lining.width / 2
    return overhang / shoe.backing.thickness


def brake_with_overhang_over_table_thickness(brake: Brake, ratio: float) -> Brake:
    """The brake with another table thickness: 1/`ratio` of the lining's overhang beyond the web."""
    shoe = brake.shoes[0]
    assert shoe.backing is not None
    thickness = shoe.backing.thickness * overhang_over_table_thickness(brake) / ratio
    return vary(brake, {"shoe.backing.thickness": thickness})


def isotropic_lining_material(brake: Brake) -> Material:
    """The material of the first lining, which must be isotropic."""
    material = brake.shoes[0].lining.material
    assert isinstance(material, Material)
    return material


VARIED_QUANTITIES_OF_FIGURE_PANELS = (
    VariedQuantityOfPlaneStressError(
        "lining width / thickness",
        (1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0),
        lining_width_over_thickness,
        brake_with_lining_width_over_thickness,
    ),
    VariedQuantityOfPlaneStressError(
        "web width / lining width",
        (0.08, 0.125, 0.2, 0.3, 0.45, 0.7, 1.0),
        web_width_over_lining_width,
        brake_with_web_width_over_lining_width,
        needs_web=True,
    ),
    VariedQuantityOfPlaneStressError(
        "overhang / table thickness",
        (1.5, 2.0, 3.0, 4.5, 7.0, 10.0, 14.0),
        overhang_over_table_thickness,
        brake_with_overhang_over_table_thickness,
        needs_web=True,
    ),
    VariedQuantityOfPlaneStressError(
        "Poisson's ratio of the lining",
        (0.0, 0.1, 0.2, 0.25, 0.3, 0.4, 0.45),
        lambda brake: isotropic_lining_material(brake).nu,
        lambda brake, nu: vary(brake, {"shoe.lining.material.nu": nu}),
    ),
    VariedQuantityOfPlaneStressError(
        "modulus of the lining [MPa]",
        (30.0, 100.0, 300.0, 1000.0, 3000.0),
        lambda brake: 1e-6 * isotropic_lining_material(brake).E,
        lambda brake, modulus: vary(brake, {"shoe.lining.material.E": 1e6 * modulus}),
    ),
    VariedQuantityOfPlaneStressError(
        "friction",
        (0.05, 0.1, 0.2, 0.3, 0.4, 0.5),
        lambda brake: brake.friction,
        lambda brake, friction: vary(brake, {"friction": friction}),
    ),
)
"""The quantities in the panels of the figure. Each of them is varied alone."""


def errors_of_plane_stress_by_width_model(brake: Brake) -> dict[str, float]:
    """The relative errors of plane stress on a brake, by the keys of NAMES_OF_LIMITED_QUANTITIES.

    Raises
    ------
    NoAnswer
        where a model has no answer
    BadInput
        where the model of the width does not apply
    """
    plane = solve(brake)
    wide = solve_cross_section_mesh_with_width_degree(
        brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], DEGREE_ACROSS_WIDTH_OF_LIMIT_STUDY, plane
    ).response
    found = relative_distance_of_plane_stress_from_width_solution(brake, plane, wide).brake
    return {name: found[name] for name in NAMES_OF_LIMITED_QUANTITIES}


def rows_of_plane_stress_limits(
    brakes: Mapping[str, Brake],
    every: int = 1,
    say: Callable[[str], None] = lambda _: None,
) -> list[dict[str, Any]]:
    """A row for each varied quantity, brake and value: the errors of plane stress.

    A value without an answer has no row.

    Parameters
    ----------
    brakes : the brakes that are varied, by name
    every : 1 for all values of a quantity, 2 for every second value, beginning with the first, and
        so on
    say : is called with a line of text on the progress
    """
    rows = []
    for variation in VARIED_QUANTITIES_OF_FIGURE_PANELS:
        for name, brake in brakes.items():
            if variation.needs_web and not has_shoe_with_parts_of_different_widths(brake):
                continue
            say(f"{variation.name}: {name}")
            for value in variation.values[::every]:
                try:
                    errors = errors_of_plane_stress_by_width_model(
                        variation.brake_with_value(brake, value)
                    )
                except DrumlinError:
                    continue
                rows.append({"varied": variation.name, "brake": name, "value": value, **errors})
    return rows


class QuantityRangeWithinPlaneStressErrorLimit(NamedTuple):
    """The range of a varied quantity with which the error of plane stress is within a limit.

    `low` and `high` are the smallest and the largest of these values; None if no value is within
    the limit.
    """

    varied: str
    brake: str
    quantity: str
    limit: float
    low: float | None
    high: float | None


def parameter_ranges_within_error_limits(
    rows: Sequence[Mapping[str, Any]],
) -> list[QuantityRangeWithinPlaneStressErrorLimit]:
    """The ranges of the varied quantities in which plane stress is within each limit."""
    groups: dict[tuple[str, str], list[Mapping[str, Any]]] = {}
    for row in rows:
        groups.setdefault((row["varied"], row["brake"]), []).append(row)
    found = []
    for (varied, brake), own in groups.items():
        for quantity in NAMES_OF_LIMITED_QUANTITIES:
            for limit in LIMITS_OF_PLANE_STRESS_ERROR:
                within = [row["value"] for row in own if row[quantity] <= limit]
                ends = (min(within), max(within)) if within else (None, None)
                found.append(
                    QuantityRangeWithinPlaneStressErrorLimit(varied, brake, quantity, limit, *ends)
                )
    return found
