"""Comparison of a user's pressure curves p(theta), read from a CSV file, with reference values."""

import csv
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.base.files import read_text
from drumlin.base.tables import (
    decimal_sign_of_table,
    number_in_table_cell,
    split_text_table_into_cell_rows,
)
from drumlin.base.texts import error_text_in_percent, number_as_text
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import first_key_in_which_two_brakes_differ
from drumlin.brake.plane_brake import read_drum_or_plane_brake
from drumlin.brake.surface import FRICTION_SURFACE_OF_DRUM, FrictionSurface
from drumlin.brake.units import LARGEST_ALLOWED_NUMBER_IN_SI, quantity_in_si
from drumlin.comparison import table_as_csv_text
from drumlin.response.response import Response
from drumlin.verification.reference import ReferenceValuesOfBrake, ReferenceValuesOfShoe
from drumlin.verification.reference_file import LARGEST_BYTES_OF_REFERENCE_FILE


def _heading_of_column_of_angles_or_places(surface: FrictionSurface) -> str:
    """The heading of the column of angles or places, with its unit: "theta [deg]" or "x [mm]"."""
    return f"{surface.coordinate_name} [{surface.shown_unit}]"


def _columns_allowed_in_pressure_table_as_text(surface: FrictionSurface) -> str:
    """The columns that a table of p(theta) may have, in words for messages."""
    place = _heading_of_column_of_angles_or_places(surface)
    return f"columns 'shoe', {place!r} and 'p [MPa]', or other units"


class PressureCurveOfShoe(NamedTuple):
    """The pressure of a shoe along its lining.

    Attributes
    ----------
    theta : growing angles (n,) [rad] along the lining; on a plane surface, places x (n,) [m]
    p : contact pressures (n,) [Pa] at these angles or places
    """

    theta: Floats
    p: Floats


class DeviationOfCurveFromReference(NamedTuple):
    """How far a pressure curve p(theta) of a shoe is from the reference values of this shoe.

    The pressures are compared at the angles that the reference lists, without angles in the edge
    zones at the lining's ends.

    Attributes
    ----------
    shoe : name of the shoe
    distance : L2 norm of the difference of p from the reference, relative to the L2 norm of the
        reference
    largest : largest difference of p, relative to the peak pressure of the reference
    at : angle or place of the largest difference, as text
    torque : torque [N m] that the curve gives by the trapezoidal rule, on a plane surface the
        braking force [N]; between the curve's last point and the lining's end p is constant
    torque_error : torque that the differences of p give by the trapezoidal rule, relative to the
        torque of the reference
    reference_pressure_uncertainty : relative uncertainty of the pressure curve in the reference
    reference_torque_uncertainty : relative uncertainty of the torque in the reference
    """

    shoe: str
    distance: float
    largest: float
    at: str
    torque: float
    torque_error: float
    reference_pressure_uncertainty: float
    reference_torque_uncertainty: float


def pressure_curves_as_csv(
    response: Response, surface: FrictionSurface = FRICTION_SURFACE_OF_DRUM
) -> str:
    """The pressures of all shoes as a CSV table, which `read_pressure_curves` can read."""
    heading = _heading_of_column_of_angles_or_places(surface)
    rows = []
    for shoe in response.shoes:
        places, p = shoe.curve()
        for x, mpa in zip(places * surface.si_to_shown_unit_factor, p * 1e-6, strict=True):
            rows.append({"shoe": shoe.name, heading: f"{x:.12g}", "p [MPa]": f"{mpa:.12g}"})
    return table_as_csv_text(rows)


def read_pressure_curves(path: Path, brake: Brake) -> dict[str, PressureCurveOfShoe]:
    """Read the pressure curve of each shoe, by its name, from a CSV file.

    A shoe that has no point in the table, such as one that was not measured, has no curve.

    Raises BadInput for a table that cannot be used. The message is one line, which names the file,
    the line and the allowed content.
    """
    text = read_text(path, LARGEST_BYTES_OF_REFERENCE_FILE, "a table of p(theta)")
    try:
        lines = split_text_table_into_cell_rows(text)
    except csv.Error as error:
        raise BadInput(f"{path}: is not a CSV file ({error})") from error
    surface = brake.surface
    wanted = {surface.coordinate_name: surface.coordinate_unit, "p": "Pa"}
    if not lines:
        raise BadInput(
            f"{path}: is empty; must have {_columns_allowed_in_pressure_table_as_text(surface)}"
        )
    columns = _columns_of_pressure_table_from_heading(path, lines[0], wanted, surface)
    names = [shoe.name for shoe in brake.shoes]
    if "shoe" not in columns and len(names) > 1:
        raise BadInput(f"{path}: line 1: no column 'shoe'; the brake has {', '.join(names)}")
    points: dict[str, list[list[float]]] = {name: [] for name in names}
    decimal_sign = _decimal_sign_of_pressure_table(path, lines[1:], columns, wanted)
    # Each line below the heading is one point (theta, p) of the curve of one shoe.
    for number, line in enumerate(lines[1:], 2):
        # An empty line is skipped, but it counts in the line numbers of the messages.
        if not "".join(line).strip():
            continue
        place = f"{path}: line {number}: "
        if len(line) != len(lines[0]):
            raise BadInput(
                f"{place}{len(line)} cells; must have {len(lines[0])} as the heading"
                f"{_hint_about_comma_between_cells(line, len(lines[0]))}"
            )
        name = line[columns["shoe"].position].strip() if "shoe" in columns else names[0]
        if name not in points:
            raise BadInput(f"{place}shoe = {name!r}: unknown; allowed: {', '.join(names)}")
        point = [
            _value_of_table_cell_in_si(place, line, key, columns[key], decimal_sign)
            for key in wanted
        ]
        points[name].append(point)
    measured = [shoe for shoe in brake.shoes if points[shoe.name]]
    if not measured:
        raise BadInput(f"{path}: has no points below its heading")
    return {shoe.name: _sorted_pressure_curve(path, shoe, points[shoe.name]) for shoe in measured}


class _PositionAndSiFactorOfColumn(NamedTuple):
    """A column of a table: its position, counted from 0, and the factor from its unit to SI."""

    position: int
    factor: float


def _columns_of_pressure_table_from_heading(
    path: Path, heading: Sequence[str], wanted: Mapping[str, str], surface: FrictionSurface
) -> dict[str, _PositionAndSiFactorOfColumn]:
    """The columns of a table of pressures by name, read from cells such as 'theta [deg]'.

    Parameters
    ----------
    path : path of the table, for messages
    heading : cells of the first line
    wanted : SI unit of each quantity that the table must hold, by name of its column
    surface : friction surface of the brake

    Raises
    ------
    BadInput
        for a missing column or an unknown unit
    """
    columns: dict[str, _PositionAndSiFactorOfColumn] = {}
    for position, cell in enumerate(heading):
        name, _, unit = cell.strip().removesuffix("]").partition("[")
        name = name.strip()
        if name == "shoe":
            columns[name] = _PositionAndSiFactorOfColumn(position, 1.0)
        if name in wanted:
            try:
                factor = quantity_in_si(f"1 {unit.strip()}", wanted[name], unit_required=True)
                columns[name] = _PositionAndSiFactorOfColumn(position, factor)
            except ValueError as error:
                raise BadInput(f"{path}: line 1: {cell.strip()!r}: {error}") from error
    for name in wanted:
        if name not in columns:
            raise BadInput(
                f"{path}: line 1: no column {name!r} with its unit; "
                f"must have {_columns_allowed_in_pressure_table_as_text(surface)}"
            )
    return columns


def _decimal_sign_of_pressure_table(
    path: Path,
    lines: Sequence[Sequence[str]],
    columns: Mapping[str, _PositionAndSiFactorOfColumn],
    wanted: Iterable[str],
) -> str:
    """The decimal sign of the numbers in a table: "," or "."; "" if all numbers are whole.

    Parameters
    ----------
    path : path of the table, for messages
    lines : cells of the lines below the heading
    columns : columns of the table by name
    wanted : names of the columns that hold numbers

    Raises
    ------
    BadInput
        for a table with decimal commas and decimal points
    """
    positions = [columns[key].position for key in wanted]
    cells = []
    for line in lines:
        cells += [line[position] for position in positions if position < len(line)]
    try:
        return decimal_sign_of_table(cells)
    except ValueError as error:
        raise BadInput(f"{path}: {error}") from error


def _hint_about_comma_between_cells(line: Sequence[str], columns: int) -> str:
    """A hint for a line that has too many cells, perhaps because of decimal commas; else ""."""
    if len(line) <= columns:
        return ""
    return "; with decimal commas the cells must be separated by semicolons or tabs"


def _value_of_table_cell_in_si(
    place: str,
    line: Sequence[str],
    key: str,
    column: _PositionAndSiFactorOfColumn,
    decimal_sign: str,
) -> float:
    """The number in a cell of a table, in SI.

    Parameters
    ----------
    place : file and number of the line, for messages
    line : cells of the line
    key : name of the quantity, for messages
    column : column of the cell
    decimal_sign : "," or "." if other numbers of the table have this sign, else ""

    Raises
    ------
    BadInput
        for a cell that holds no finite number
    """
    cell = line[column.position]
    # A text that is no number becomes NaN, which fails the comparison below.
    cause = ""
    try:
        value = number_in_table_cell(cell, decimal_sign) * column.factor
    except ValueError as error:
        value, cause = math.nan, f" ({error})" if "," in cell else ""
    if not abs(value) <= LARGEST_ALLOWED_NUMBER_IN_SI:
        raise BadInput(
            f"{place}{key} = {cell!r}: must be a finite number, "
            f"up to {LARGEST_ALLOWED_NUMBER_IN_SI:g} in SI units{cause}"
        )
    return value


def _sorted_pressure_curve(
    path: Path, shoe: Shoe, points: list[list[float]]
) -> PressureCurveOfShoe:
    """The pressure curve of a shoe from the points (theta, p) of a table, in any order.

    Raises BadInput for fewer than two points, and for two points at one place.
    """
    if len(points) < 2:
        raise BadInput(f"{path}: shoe {shoe.name!r}: {len(points)} points; must be 2 or more")
    theta, p = np.array(points).T
    if not shoe.is_on_plane:
        # 350 and -10 degrees are one angle: each angle is shifted by whole turns until it is
        # within 180 degrees of the lining's middle.
        middle = shoe.lining.middle
        theta = middle + (theta - middle + math.pi) % (2 * math.pi) - math.pi
    order = np.argsort(theta, kind="stable")
    theta, p = theta[order], p[order]
    # Two points at one angle would give the curve two pressures there.
    same = np.diff(theta) <= 0
    if same.any():
        place = _angle_or_place_in_words_with_unit(shoe, theta[:-1][same][0])
        raise BadInput(f"{path}: shoe {shoe.name!r}: {place} stands twice")
    return PressureCurveOfShoe(theta, p)


def _angle_or_place_in_words_with_unit(shoe: Shoe, at: float) -> str:
    """An angle [rad] on a shoe, or a place [m] on a flat shoe, in words with its unit."""
    return f"{shoe.surface.coordinate_name} = {shoe.surface.coordinate_as_text(at)}"


def compare_curves_with_reference(
    brake: Brake, known: ReferenceValuesOfBrake, curves: dict[str, PressureCurveOfShoe]
) -> list[DeviationOfCurveFromReference]:
    """Compare pressure curves, by the names of their shoes, with the reference values of a brake.

    Raises BadInput if the reference values belong to another brake, or if a curve ends before it
    reaches the edge zone at an end of its lining.
    """
    if [shoe.name for shoe in known.shoes] != [shoe.name for shoe in brake.shoes]:
        said = ", ".join(shoe.name for shoe in known.shoes)
        raise BadInput(f"the reference is of another brake, with the shoes {said}")
    # The reference keeps the text of its brake file, which is compared with this brake.
    key = first_key_in_which_two_brakes_differ(
        brake, read_drum_or_plane_brake(Path("brake_file"), known.text)
    )
    if key is not None:
        raise BadInput(f"the reference is of another brake: {key} is not the same")
    verdicts = []
    for spec, shoe in zip(brake.shoes, known.shoes, strict=True):
        if shoe.name in curves:
            verdicts.append(
                _deviation_of_pressure_curve_from_reference(brake, spec, shoe, curves[shoe.name])
            )
    return verdicts


def _deviation_of_pressure_curve_from_reference(
    brake: Brake, spec: Shoe, known: ReferenceValuesOfShoe, curve: PressureCurveOfShoe
) -> DeviationOfCurveFromReference:
    """How far the pressure curve of one shoe is from the reference values of the shoe.

    Parameters
    ----------
    brake : the brake
    spec : the shoe as the brake file gives it
    known : reference values of the shoe
    curve : pressure curve that is judged

    Raises
    ------
    BadInput
        for a curve that ends before it reaches the edge zones, or a lining that is shorter than
        its two edge zones
    """
    inside = known.mask_of_angles_outside_edge_zones
    theta, p = known.theta[inside], known.pressure[inside]
    if not len(theta):
        raise BadInput(
            f"shoe {known.name!r}: its lining is shorter than its edge zones; nothing to compare"
        )
    if curve.theta[0] > theta[0] + 1e-9 or curve.theta[-1] < theta[-1] - 1e-9:
        raise BadInput(
            f"shoe {known.name!r}: from {_angle_or_place_in_words_with_unit(spec, curve.theta[0])} "
            f"to {_angle_or_place_in_words_with_unit(spec, curve.theta[-1])}: must reach "
            f"from {_angle_or_place_in_words_with_unit(spec, theta[0])} "
            f"to {_angle_or_place_in_words_with_unit(spec, theta[-1])}"
        )
    # The curve is interpolated linearly to the angles of the reference.
    off = np.interp(theta, *curve) - p
    worst = int(np.abs(off).argmax())
    # The torque is b R^2 times the integral of the friction stress mu(p) p over theta; `lever` is
    # the factor b R^2.
    lever = spec.lining.width * brake.length_per_surface_coordinate**2
    stress_off = _friction_stress_of_shoe(brake, spec, p + off) - _friction_stress_of_shoe(
        brake, spec, p
    )
    pieces = _slices_of_angles_on_each_lining(spec, theta)
    force_off = math.fsum(float(np.trapezoid(stress_off[own], theta[own])) for own in pieces)
    torque_off, torque = abs(lever * force_off), known.torque.value
    stress = curve._replace(p=_friction_stress_of_shoe(brake, spec, curve.p))
    return DeviationOfCurveFromReference(
        shoe=known.name,
        distance=_difference_over_size_or_infinity(
            math.sqrt(float(off @ off)), math.sqrt(float(p @ p))
        ),
        largest=_difference_over_size_or_infinity(
            abs(float(off[worst])), known.peak_pressure.value
        ),
        at=_angle_or_place_in_words_with_unit(spec, float(theta[worst])),
        torque=lever * _integral_of_stress_over_theta_on_linings(spec, stress),
        torque_error=torque_off / torque if torque else 0.0,
        reference_pressure_uncertainty=known.distance,
        reference_torque_uncertainty=known.torque.relative_uncertainty,
    )


def _friction_stress_of_shoe(brake: Brake, shoe: Shoe, p: Floats) -> Floats:
    """The friction stress mu(p) p [Pa] of a sliding shoe at pressures p (n,) on its lining."""
    curve = brake.friction_coefficient_curve_of_shoe(shoe)
    return curve.friction_coefficients_at_pressures(p) * p


def _difference_over_size_or_infinity(difference: float, size: float) -> float:
    """A difference divided by a size; if the size is 0, the result is infinite, or 0 for 0/0."""
    return difference / size if size else math.inf if difference else 0.0


def _slices_of_angles_on_each_lining(shoe: Shoe, theta: Floats) -> list[slice]:
    """The slices of growing angles `theta` (n,) [rad] that are on each lining of a shoe."""
    slices = []
    for start, end in shoe.lining.arcs:
        first, last = np.searchsorted(theta, [start, end]).tolist()
        slices.append(slice(first, last))
    return slices


def _integral_of_stress_over_theta_on_linings(shoe: Shoe, curve: PressureCurveOfShoe) -> float:
    """The integral of a stress over theta along all linings [Pa rad], by the trapezoidal rule.

    `curve` has the friction stress in place of the pressure.

    The points of the rule are the curve's points inside each lining, and the two ends of the
    lining. At an end beside a slot the stress is that of the lining's nearest point. A lining
    without a point counts as a lining without stress.
    """
    total = 0.0
    slots = shoe.lining.slots
    slices = _slices_of_angles_on_each_lining(shoe, curve.theta)
    for k, ((start, end), own) in enumerate(zip(shoe.lining.arcs, slices, strict=True)):
        # Points beyond the outer ends of all linings help to interpolate the stress at the ends.
        near = slice(own.start if k else 0, own.stop if k < len(slots) else None)
        at, p = curve.theta[near], curve.p[near]
        if len(at):
            theta = np.concatenate([[start], curve.theta[own], [end]])
            total += float(np.trapezoid(np.interp(theta, at, p), theta))
    return total


def are_curve_deviations_within_tolerance(
    verdicts: Sequence[DeviationOfCurveFromReference], tolerance: float
) -> bool:
    """Whether the L2 distance of p and the torque error of each shoe are within a tolerance."""
    return all(max(each.distance, each.torque_error) <= tolerance for each in verdicts)


def text_lines_on_errors_of_pressure_table(
    verdicts: Sequence[DeviationOfCurveFromReference],
    tolerance: float,
    surface: FrictionSurface = FRICTION_SURFACE_OF_DRUM,
) -> list[str]:
    """The deviations as text: a line for each shoe, then whether all are within the tolerance.

    The friction surface of the brake, drum or plane, gives the name and the unit of the torque.
    """
    effect, unit = surface.word_for_torque_or_brake_force, surface.unit_of_torque_or_brake_force
    text = []
    for verdict in verdicts:
        text.append(
            f"shoe {verdict.shoe!r}: p off by {number_as_text(verdict.distance, '.2%')} in L2 "
            "(reference known to "
            f"{error_text_in_percent(verdict.reference_pressure_uncertainty)}), "
            f"at most by {number_as_text(verdict.largest, '.2%')} of the peak, at {verdict.at}; "
            f"that is {number_as_text(verdict.torque_error, '.2%')} of the {effect} "
            f"(known to {error_text_in_percent(verdict.reference_torque_uncertainty)}); "
            f"{effect} of its points {verdict.torque:.7g} {unit}"
        )
    is_within = (
        "within" if are_curve_deviations_within_tolerance(verdicts, tolerance) else "NOT within"
    )
    return [*text, f"{is_within} {number_as_text(100 * tolerance, '.3g')} % of the reference"]
