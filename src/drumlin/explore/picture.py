"""The picture of the page: pressure curves, forces, a table and a drawing of the brake, as data.

A pressure curve has a pressure for each place on the friction surface. A place is an angle [deg] on
a drum and a length [mm] on a plane.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.round_numbers import four_round_numbers_around_value
from drumlin.base.texts import error_text_in_percent, number_as_text
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import BeamBody, ShoeBodyOfConstantSection
from drumlin.explore.answers import (
    HIGHEST_SOUGHT_LOCKING_FRICTION,
    PRESSURE_ERROR_OF_ONE_WEAR_INCREMENT,
    TOLERANCE_OF_ACCURATE_SOLID_SOLUTION,
    DifferenceFromAccurateAnswer,
    FemAndLawAnswerAtSliderSetting,
    LockingFrictionByShoeGroup,
)
from drumlin.explore.geometry_knobs import (
    LARGEST_LINING_END_SHIFT_BY_SLIDER,
    LARGEST_RELATIVE_RADIUS_CHANGE_BY_SLIDER,
)
from drumlin.report.figures import evenly_spaced_pressure_curve_of_shoe, title_of_model_in_figures
from drumlin.response import Response
from drumlin.response.balance import brake_with_forces_of_response
from drumlin.response.merit import brake_factor
from drumlin.response.show import text_of_contact_arcs

PAGE_MM, PAGE_MPA = 1e3, 1e-6
"""Millimetres in a metre and megapascals in a pascal: the page shows mm and MPa."""

POINTS_PER_DRAWN_PRESSURE_CURVE = 160
"""Number of points of a pressure curve; the lines between them are some 3 pixels long."""

DRAWN_LENGTH_OF_LARGEST_FORCE_ARROW = 0.45
"""Length of the arrow of the largest force.

It is relative to the drum's radius, on a plane to the length of the first lining.
"""

DRAWN_DISTANCE_OF_HIGHEST_PRESSURE_OF_SCALE = 0.45
"""Distance from the friction surface at which the highest pressure of the scale is drawn.

It is relative to the drum's radius, on a plane to the length of the first lining.
"""

SMALLEST_SHOWN_ERROR = 1e-6
"""Relative error below which the page writes "less than 0.0001 %" in place of the number."""

RESOLUTION_OF_CURVE_POSITIONS = 1e-3
"""Resolution [deg, on a plane mm] of the places of a pressure curve.

The places are sent to the page as whole numbers, in units of this step.
"""

RESOLUTION_OF_SENT_PRESSURES = 1e-4
"""Resolution of pressures, which are sent to the page as whole numbers.

It is relative to the highest pressure of the scale.
"""


class DrawnPressureCurve(NamedTuple):
    """The contact pressure along a shoe as the page draws it.

    Attributes
    ----------
    positions : angles (n,) [deg] on the drum, on a plane lengths [mm]
    p : pressures (n,) [MPa] at these places
    sign : +1 for a shoe inside the drum, -1 for a shoe outside
    """

    positions: Floats
    p: Floats
    sign: int


class LinesToDraw(NamedTuple):
    """Several lines or outlines to draw: the coordinates x (n,) and y (n,) [mm] of their points."""

    xs: list[Floats]
    ys: list[Floats]

    @classmethod
    def lines_from_point_arrays(cls, outlines: Sequence[Floats]) -> "LinesToDraw":
        """Make lines from arrays (2, n) [mm], each with the x and y of one line's points."""
        return cls([x for x, _ in outlines], [y for _, y in outlines])


@dataclass(frozen=True)
class PictureOfAnswer:
    """The parts of an answer that the page shows.

    Attributes
    ----------
    fem, law : pressure curves, by finite elements and by the law, of the shoes that touch
    arcs : first and last place [deg, on a plane mm] of each arc in contact, by finite elements
    forces : arrows of the actuation forces [mm]
    highest_pressure_of_scale : highest pressure of the scale [MPa], the same for all curves
    motion : arrow character for the motion of the drum or of the sliding body
    torque_line_as_html : torque, brake factor and torque by the law, as one line of HTML
    rows : rows of the table, its headings first
    failures : reasons why finite elements or the law have no answer
    """

    fem: tuple[DrawnPressureCurve, ...]
    law: tuple[DrawnPressureCurve, ...]
    arcs: tuple[tuple[float, float], ...]
    forces: LinesToDraw
    highest_pressure_of_scale: float
    motion: str
    torque_line_as_html: str
    rows: tuple[tuple[str, ...], ...]
    failures: tuple[str, ...]


def picture_of_brake_at_slider_setting(
    answer: FemAndLawAnswerAtSliderSetting, brake: Brake
) -> PictureOfAnswer:
    """The picture that the page shows for an answer.

    `brake` is the brake of the file. The picture shows this brake if the sliders' values give parts
    that do not fit together.
    """
    shown = answer.brake or brake
    unit = shown.surface.si_to_shown_unit_factor
    # Finite elements and law share one scale of pressure, so that their curves can be compared.
    peaks: list[float] = []
    for response in (answer.fem_response, answer.law_response):
        if response is not None:
            peaks += map(attrgetter("peak_pressure"), response.shoes)
    # Ends of the pressed arcs of all shoes, in the unit of the page.
    arcs: list[tuple[float, float]] = []
    for shoe in answer.fem_response.shoes if answer.fem_response else ():
        for start, end in shoe.contact_arcs:
            arcs.append((start * unit, end * unit))
    # If finite elements and law fail for the same reason, the page shows the reason once.
    failures = (answer.failure, answer.law_failure)
    return PictureOfAnswer(
        fem=_pressure_curves_of_touching_shoes(answer.fem_response, shown),
        law=_pressure_curves_of_touching_shoes(answer.law_response, shown),
        arcs=tuple(arcs),
        forces=_lines_of_force_arrows(
            shown
            if answer.fem_response is None
            else brake_with_forces_of_response(shown, answer.fem_response)
        ),
        highest_pressure_of_scale=highest_pressure_of_picture_scale(
            max(peaks, default=0.0) * PAGE_MPA
        ),
        motion=_arrow_character_of_motion(shown),
        torque_line_as_html=torque_line_as_html(answer),
        rows=table_rows_by_shoe_and_model(answer, shown),
        failures=tuple(dict.fromkeys(filter(None, failures))),
    )


def _arrow_character_of_motion(brake: Brake) -> str:
    """The arrow character for the motion of the drum, or of the sliding body on a plane."""
    if brake.surface.is_plane_and_not_drum:
        return "→" if brake.sign_of_motion > 0 else "←"
    return "↺" if brake.sign_of_motion > 0 else "↻"


def pressure_curve_as_whole_numbers(curve: DrawnPressureCurve, scale: float) -> dict[str, Any]:
    """A pressure curve as whole numbers, which are short to send and fast to read.

    Places are in units of RESOLUTION_OF_CURVE_POSITIONS. Pressures are in units of
    RESOLUTION_OF_SENT_PRESSURES times `scale` [MPa], the highest pressure of the scale.
    """
    at, p = (
        np.rint(curve.positions / RESOLUTION_OF_CURVE_POSITIONS),
        np.rint(curve.p / scale / RESOLUTION_OF_SENT_PRESSURES),
    )
    return {"at": at.astype(int).tolist(), "p": p.astype(int).tolist(), "sign": curve.sign}


def highest_pressure_of_picture_scale(peak: float) -> float:
    """The highest pressure [MPa] of the picture's scale, for curves with a highest `peak` [MPa].

    It is the smallest number not below the peak that is 1, 2 or 5 times a power of ten, so that the
    scale seldom changes as a slider moves. Without a positive peak it is 1 MPa.
    """
    if not peak > 0:
        return 1.0
    return next(number for number in four_round_numbers_around_value(peak) if number >= peak)


def _pressure_curves_of_touching_shoes(
    response: Response | None, brake: Brake
) -> tuple[DrawnPressureCurve, ...]:
    """The pressure curves of all shoes that touch the drum or plane, by the model of a response."""
    if response is None:
        return ()
    unit, curves = brake.surface.si_to_shown_unit_factor, []
    for shoe, part in zip(response.shoes, brake.shoes, strict=True):
        if shoe.contact_arcs:
            theta, p = evenly_spaced_pressure_curve_of_shoe(shoe, POINTS_PER_DRAWN_PRESSURE_CURVE)
            curves.append(
                DrawnPressureCurve(
                    theta * unit, p * PAGE_MPA, part.sign_internal_plus_external_minus
                )
            )
    return tuple(curves)


def _lines_of_force_arrows(brake: Brake) -> LinesToDraw:
    """The lines [mm] of an arrow for each actuation force: the shaft and the head of the arrow."""
    lines = []
    for shoe in brake.shoes:
        arrow = _tail_and_tip_of_force_arrow(brake, shoe)
        along = arrow.tip - arrow.tail
        across = np.array([-along[1], along[0]])
        # The arrowhead is a quarter as long as the arrow, and as wide as it is long.
        left = arrow.tip + 0.25 * (0.5 * across - along)
        right = arrow.tip + 0.25 * (-0.5 * across - along)
        shaft, head = np.array([arrow.tail, arrow.tip]), np.array([left, arrow.tip, right])
        lines += [shaft.T * PAGE_MM, head.T * PAGE_MM]
    return LinesToDraw.lines_from_point_arrays(lines)


class _ForceArrow(NamedTuple):
    """The points (2,) [m] of an arrow's tail and tip."""

    tail: Floats
    tip: Floats


def _tail_and_tip_of_force_arrow(brake: Brake, shoe: Shoe) -> _ForceArrow:
    """Tail and tip [m] of the arrow of the force on a shoe.

    The length is proportional to the force; the arrow of the largest force of the brake has the
    length DRAWN_LENGTH_OF_LARGEST_FORCE_ARROW.
    """
    largest = max(abs(shoe.actuation.force) for shoe in brake.shoes) or 1.0
    tip = _point_of_force_arrow_tip(shoe)
    return _ForceArrow(
        tip
        - DRAWN_LENGTH_OF_LARGEST_FORCE_ARROW * brake.size * shoe.actuation.force_vector / largest,
        tip,
    )


def _point_of_force_arrow_tip(shoe: Shoe) -> Floats:
    """The point (2,) [m] at which the arrow of the force on a shoe ends.

    For a shoe inside a drum it is the point on the line of action that is nearest to the lining's
    end away from the hinge. For other shoes it is the point of the force in the brake file.
    """
    along, point = shoe.actuation.unit_vector_of_force, shoe.actuation.point.xy
    # Shoes on a plane and external shoes keep the point of the file.
    if shoe.is_on_plane or shoe.sign_internal_plus_external_minus < 0:
        return point
    size = float(np.linalg.norm(point))
    angles = shoe.lining.start, shoe.lining.end
    ends = size * np.array([(math.cos(angle), math.sin(angle)) for angle in angles])
    far = ends[np.argmax(np.linalg.norm(ends - shoe.pin.xy, axis=1))]
    return np.asarray(point + ((far - point) @ along) * along)


# The functions below write the answer in words and as a table.


def torque_line_as_html(answer: FemAndLawAnswerAtSliderSetting) -> str:
    """A line of HTML with torque and brake factor by finite elements, and the torque by the law."""
    if answer.fem_response is None or answer.brake is None:
        return "no answer"
    surface = answer.brake.surface
    unit = surface.unit_of_torque_or_brake_force
    effect, factor = answer.fem_response.effect, brake_factor(answer.brake, answer.fem_response)
    words = [f"{surface.word_for_torque_or_brake_force} <b>{effect:.6g} {unit}</b>"]
    if factor is not None:
        formula = f"<span>{surface.brake_factor_formula}</span>"
        words.append(f"brake factor {formula} <b>{factor:.4g}</b>")
    if answer.law_response is not None:
        by_law = answer.law_response.effect
        off = f" ({number_as_text(by_law / effect - 1, '+.1%')})" if effect else ""
        law_title = escape(title_of_model_in_figures(answer.law_response.model))
        words.append(f"{law_title} {by_law:.6g} {unit}{off}")
    if answer.distance:
        words.append(f"worn over {answer.distance * 1e-3:.4g} km at k = 1e-5 mm³/(N m)")
    return " · ".join(words)


def torque_and_refusals_as_html(picture: PictureOfAnswer, refused: Sequence[str] = ()) -> str:
    """The line with the torque as HTML, followed by a line for each refusal.

    Refusals are the given messages on parts of the link, and reasons why a model has no answer.
    """
    html = f'<p class="answer">{picture.torque_line_as_html}</p>'
    for line in (*refused, *picture.failures):
        html += f'<p class="refused">{escape(line)}</p>'
    return html


def self_locking_as_html(
    answer: FemAndLawAnswerAtSliderSetting, locking: LockingFrictionByShoeGroup | None
) -> str:
    """A line of HTML with the friction at which the brake locks itself.

    The line also gives the difference between this friction and the friction of the brake.
    `locking` holds the friction coefficient at which each group of shoes locks, by finite elements;
    None where it is not known yet.
    """
    if answer.brake is None:
        return ""
    friction, words = answer.brake.friction, "…"
    if locking is not None:
        limit = min(locking.values(), default=math.inf)
        words = f"at friction <b>{limit:.4g}</b>, {limit - friction:+.4g} from {friction:.4g}"
        if math.isinf(limit):
            words = f"none up to friction {HIGHEST_SOUGHT_LOCKING_FRICTION:g}"
    law = answer.locking_friction_by_law
    if law is not None:
        name = escape(title_of_model_in_figures(answer.law_name or ""))
        words += f"; by the {name} " + ("never" if math.isinf(law) else f"at {law:.4g}")
    return f"<p>self-locking {words}</p>"


def error_of_finite_elements_as_html(
    answer: FemAndLawAnswerAtSliderSetting,
    stated: DifferenceFromAccurateAnswer | None,
    *,
    asked: bool,
) -> str:
    """Lines of HTML on the errors of the finite elements and of plane stress.

    `stated` is the difference from the accurate answer of `drumlin.solve`; None if it is not known.
    `asked` tells whether the page has already asked for the accurate answer. Without `stated` the
    text is empty if `asked` is True. It says that the error follows if `asked` is False.
    """
    if answer.fem_response is None or answer.brake is None or (asked and stated is None):
        return ""
    if stated is None:
        return "<p>quick answer; its error follows when the sliders rest</p>"
    effect = answer.brake.surface.word_for_torque_or_brake_force
    torque, pressure = map(_relative_error_as_text, stated[:2])
    lines = [f"this quick answer is off by {torque} ({effect}) and {pressure} (pressure)"]
    command = "drumlin solve"
    if answer.fem_response.model == "solid":
        command += f" --model solid --tolerance {TOLERANCE_OF_ACCURATE_SOLID_SOLUTION:g}"
    if stated.errors_stated_by_accurate_answer is not None:
        own = [stated.errors_stated_by_accurate_answer[key] for key in ("torque", "pressure")]
        torque, pressure = map(_relative_error_as_text, own)
        lines[0] += f"; {command} on the saved file is off by {torque} and {pressure} at most"
    plane = stated.plane_stress
    if plane is not None and not plane.unknown:
        texts = [
            f"{_relative_error_as_text(plane.brake[key])} ({word})"
            for key, word in (
                ("torque", effect),
                ("pressure", "mean pressure over the width"),
                ("reaction", "load on the pin"),
            )
        ]
        lines.append(f"error because the shoes are computed as flat plates: {', '.join(texts)}")
    elif plane is not None:
        lines.append(
            f"error because the shoes are computed as flat plates: not known, {plane.unknown}"
        )
    if answer.distance:
        by_wear = _relative_error_as_text(PRESSURE_ERROR_OF_ONE_WEAR_INCREMENT)
        lines[0] += f"; wear adds some {by_wear} of the pressure"
    return "".join(f"<p>{escape(line)}</p>" for line in lines)


def _relative_error_as_text(error: float) -> str:
    """A relative error in per cent, or "less than 0.0001 %" below SMALLEST_SHOWN_ERROR."""
    if error < SMALLEST_SHOWN_ERROR:
        return f"less than {SMALLEST_SHOWN_ERROR * 100:.4f} %"
    return error_text_in_percent(error)


def table_rows_by_shoe_and_model(
    answer: FemAndLawAnswerAtSliderSetting, brake: Brake
) -> tuple[tuple[str, ...], ...]:
    """The rows of the table below the picture: headings, then a row for each shoe and model."""
    surface = brake.surface
    head = (
        "shoe",
        "by",
        f"{surface.word_for_torque_or_brake_force} [{surface.unit_of_torque_or_brake_force}]",
        surface.brake_factor_formula,
        "peak p [MPa]",
        f"contact [{brake.surface.shown_unit}]",
        "self-energising",
    )
    rows = []
    for i in range(len(brake.shoes)):
        for response in (answer.fem_response, answer.law_response):
            if response is not None:
                rows.append(_page_table_row_of_shoe(brake, response, i))
    return (head, *rows)


def _page_table_row_of_shoe(brake: Brake, response: Response, i: int) -> tuple[str, ...]:
    """The row of the page's table for shoe number `i` of a response: the texts of its cells."""
    shoe, effect = response.shoes[i], response.effects[i]
    # The shoe factor is torque / (F R), on a plane braking force / F, with the actuation force F.
    force = abs(brake_with_forces_of_response(brake, response).shoes[i].actuation.force)
    force *= brake.length_per_surface_coordinate
    return (
        shoe.name,
        title_of_model_in_figures(response.model),
        f"{effect:.6g}",
        f"{effect / force:.4g}" if force else "–",
        f"{shoe.peak_pressure * PAGE_MPA:.4g}",
        text_of_contact_arcs(shoe, brake.surface),
        "yes" if shoe.self_energising else "no",
    )


def html_table_of_text_rows(rows: Sequence[Sequence[str]]) -> str:
    """The rows of a table as HTML. The first row holds the headings."""
    lines = ""
    for number, row in enumerate(rows):
        tag = "td" if number else "th"
        cells = "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in row)
        lines += f"<tr>{cells}</tr>"
    return f"<table>{lines}</table>"


# The functions below draw the brake. Only the sliders of its shape change this drawing.


def drawing_lines_of_brake(brake: Brake) -> Mapping[str, LinesToDraw]:
    """The drawing of the brake as lines [mm], by the kind of part.

    The drum or plane is a line. Linings and bodies are outlines. Hinges are single points.
    """
    linings, bodies = [], []
    for shoe in brake.shoes:
        # Depths are measured from the friction surface into the shoe.
        lining, depth = shoe.lining, shoe.lining.thickness or 0.0
        for ends in lining.arcs:
            linings.append(_outline_of_shoe_layer(shoe, brake.size, ends, (0.0, depth)))
        if shoe.mesh is None and isinstance(shoe.body, ShoeBodyOfConstantSection):
            depth += shoe.backing.thickness if shoe.backing else 0.0
            ends = shoe.body.start, shoe.body.end
            bodies.append(
                _outline_of_shoe_layer(
                    shoe, brake.size, ends, (depth, depth + shoe.body.total_thickness)
                )
            )
        if isinstance(shoe.body, BeamBody):
            bodies.append(_outline_of_straight_beam(shoe, brake.size))
    # Each hinge is drawn as a line of a single point. A shoe on a guide has no hinge.
    hinges = [shoe.pin.xy[:, None] * PAGE_MM for shoe in brake.shoes if shoe.guide is None]
    return {
        "drum": _drawing_line_of_drum_or_plane(brake),
        "linings": LinesToDraw.lines_from_point_arrays(linings),
        "bodies": LinesToDraw.lines_from_point_arrays(bodies),
        "hinges": LinesToDraw.lines_from_point_arrays(hinges),
    }


def _drawing_line_of_drum_or_plane(brake: Brake) -> LinesToDraw:
    """The drum's circle, or the plane as a straight line, in mm."""
    if brake.surface.is_plane_and_not_drum:
        (x, _), reach = centre_of_picture(brake), half_side_length_of_picture(brake)
        return LinesToDraw([np.array([x - reach, x + reach])], [np.zeros(2)])
    R, circle = brake.size * PAGE_MM, np.linspace(0, 2 * math.pi, 361)
    return LinesToDraw([R * np.cos(circle)], [R * np.sin(circle)])


def svg_path_of_lines(lines: LinesToDraw) -> str:
    """Lines [mm] as the path of an SVG picture."""
    path = ""
    for x, y in zip(lines.xs, lines.ys, strict=True):
        path += "M" + "L".join(map("{:.5g},{:.5g}".format, x.tolist(), y.tolist()))
    return path


def _angles_or_positions_of_lining_ends(brake: Brake) -> Floats:
    """The ends (2 * shoes,) of all shoes' linings: angles [rad], on a plane coordinates x [m]."""
    ends = [(shoe.lining.start, shoe.lining.end) for shoe in brake.shoes]
    return np.ravel(ends)


def lowest_and_highest_angle_or_position_of_linings(brake: Brake) -> tuple[float, float]:
    """The lowest and highest angle [deg], on a plane length [mm], of all linings, with a margin."""
    ends = _angles_or_positions_of_lining_ends(brake) * brake.surface.si_to_shown_unit_factor
    room = (
        0.04 * brake.size * PAGE_MM
        if brake.surface.is_plane_and_not_drum
        else 2.0 + LARGEST_LINING_END_SHIFT_BY_SLIDER
    )
    return float(ends.min()) - room, float(ends.max()) + room


def centre_of_picture(brake: Brake) -> tuple[float, float]:
    """The point (x, y) [mm] at the middle of the picture.

    It is the drum's centre, or the middle of a brake on a plane.
    """
    if not brake.surface.is_plane_and_not_drum:
        return 0.0, 0.0
    xy = _points_that_plane_picture_must_hold(brake)
    x, y = 0.5 * (xy.min(axis=0) + xy.max(axis=0)) * PAGE_MM
    return float(x), float(y)


def _points_of_pins_and_force_arrows(brake: Brake) -> Floats:
    """The points (n, 2) [m] of all pins, and of the tails and tips of all force arrows."""
    points: list[Floats] = []
    for shoe in brake.shoes:
        points += [shoe.pin.xy, *_tail_and_tip_of_force_arrow(brake, shoe)]
    return np.array(points)


def _points_that_plane_picture_must_hold(brake: Brake) -> Floats:
    """Points (n, 2) [m] that the picture of a brake on a plane must contain.

    They are the lowest points of the pressure curves, the pins and the force arrows.
    """
    below = -1.2 * DRAWN_DISTANCE_OF_HIGHEST_PRESSURE_OF_SCALE * brake.size
    ends = _angles_or_positions_of_lining_ends(brake)
    return np.vstack(
        [
            np.column_stack([ends, np.full(len(ends), below)]),
            _points_of_pins_and_force_arrows(brake),
        ]
    )


def half_side_length_of_picture(brake: Brake) -> float:
    """Half the side [mm] of the picture, which is a square around the point `centre_of_picture`.

    The square holds shoes, hinges, pressure curves and force arrows.
    """
    if brake.surface.is_plane_and_not_drum:
        xy = _points_that_plane_picture_must_hold(brake)
        return float(0.55 * np.ptp(xy, axis=0).max()) * PAGE_MM
    # A slider can enlarge the drum, and the picture keeps its scale. The picture therefore has
    # room for the largest drum.
    R = (1 + LARGEST_RELATIVE_RADIUS_CHANGE_BY_SLIDER) * brake.size
    room = []
    for shoe in brake.shoes:
        # Pressure curves of internal shoes are drawn outside the drum, and pressure curves of
        # external shoes inside it.
        room.append(
            1.12 * (1 + DRAWN_DISTANCE_OF_HIGHEST_PRESSURE_OF_SCALE) * R
            if shoe.sign_internal_plus_external_minus > 0
            else 1.05 * R + shoe.total_thickness
        )
    room.append(float(np.abs(_points_of_pins_and_force_arrows(brake)).max()) + 0.1 * R)
    return max(room) * PAGE_MM


def _outline_of_shoe_layer(
    shoe: Shoe, size: float, ends: tuple[float, float], depths: tuple[float, float]
) -> Floats:
    """The outline (2, n) [mm] of a layer of a shoe.

    Parameters
    ----------
    shoe : the shoe
    size : radius of the drum, on a plane length of the first lining [m]
    ends : places of the layer's two ends [rad, on a plane m]
    depths : distances [m] of the layer's front and back from the friction surface
    """
    # The outline runs along the front, returns along the back, and closes at its first point.
    there = np.linspace(*ends, 2 if shoe.is_on_plane else 90)
    places = np.concatenate([there, there[::-1], there[:1]])
    front, back = depths
    at = np.repeat([front, back, front], [len(there), len(there), 1])
    return (
        shoe.convert_points_to_brake_frame(
            shoe.points_at_depth_and_coordinate_phi(
                at, shoe.frame.phi_of_surface_coordinates(places), size
            )
        )
        * PAGE_MM
    )


def _outline_of_straight_beam(shoe: Shoe, R: float) -> Floats:
    """The four corners (2, 4) [mm] of a straight beam from the hinge to the force.

    A beam without a thickness in the brake file is drawn a tenth of the drum's radius R [m] thick.
    """
    assert isinstance(shoe.body, BeamBody)
    hinge, along = shoe.pin.xy, shoe.actuation.point.xy - shoe.pin.xy
    half = 0.5 * (shoe.body.thickness or 0.1 * R)
    across = half * np.array([-along[1], along[0]]) / np.linalg.norm(along)
    end = hinge + along
    # The beam runs from the hinge to the point of the force. Its corners lie half the thickness to
    # each side of this axis.
    corners = np.array([hinge - across, end - across, end + across, hinge + across])
    return corners.T * PAGE_MM
