"""The addresses of the page with sliders and the replies to them.

The replies are the page itself, data of a picture, the limit of self-locking, and a brake file.
"""

import json
import math
from collections.abc import Callable, Mapping
from functools import partial
from html import escape
from operator import attrgetter
from typing import Any, NamedTuple
from urllib.parse import parse_qsl, urlsplit

import jinja2
import numpy as np

from drumlin.base.errors import BadInput
from drumlin.base.round_numbers import four_round_numbers_around_value
from drumlin.base.texts import printable_single_line
from drumlin.brake import vary
from drumlin.brake.brake import Brake
from drumlin.brake.fields import PartOfInputFile, Point
from drumlin.brake.writing import brake_file_text
from drumlin.explore.answers import FemAndLawAnswerAtSliderSetting, SliderSolver
from drumlin.explore.geometry_knobs import geometry_sliders_for_brake
from drumlin.explore.knob import (
    BrakeSlider,
    linings_by_brake_file_key,
    rounded_brake_file_text_of_angle,
    value_with_all_numbers_rounded,
)
from drumlin.explore.knobs import (
    MAX_CHARACTERS_OF_EXPLORE_PAGE_LINK,
    SliderSetting,
    finite_element_models_offered_by_page,
    link_query_of_slider_setting,
    motion_key_of_brake_file,
    names_of_models_besides_fem,
    slider_setting_from_link_query,
)
from drumlin.explore.picture import (
    DRAWN_DISTANCE_OF_HIGHEST_PRESSURE_OF_SCALE,
    RESOLUTION_OF_CURVE_POSITIONS,
    RESOLUTION_OF_SENT_PRESSURES,
    centre_of_picture,
    drawing_lines_of_brake,
    error_of_finite_elements_as_html,
    half_side_length_of_picture,
    html_table_of_text_rows,
    lowest_and_highest_angle_or_position_of_linings,
    picture_of_brake_at_slider_setting,
    pressure_curve_as_whole_numbers,
    self_locking_as_html,
    svg_path_of_lines,
    torque_and_refusals_as_html,
)
from drumlin.report.figures import title_of_model_in_figures
from drumlin.report.palette import color_of_model

CHARACTERS_FORBIDDEN_IN_FILE_NAMES = frozenset('/\\:*?"<>|')
"""Letters that cannot stand in a file name on at least one operating system."""

HTML, JSON, TOML = "text/html; charset=utf-8", "application/json", "application/toml; charset=utf-8"
"""Media types of the replies: HTML for a page or message, JSON for data, TOML for a brake file."""

PAGE_TITLES_OF_FINITE_ELEMENT_MODELS = {"fem": "plane stress", "solid": "with their widths"}
"""The words of the page for the models of finite elements, by the name of the model."""

MAX_INTERVALS_BETWEEN_AXIS_TICKS = 9
"""Largest number of intervals between the ticks of an axis. Numbers of more ticks would overlap."""


class HttpReply(NamedTuple):
    """A reply of the server to a browser.

    Attributes
    ----------
    status : status code of HTTP
    media_type : media type of the text
    text : content of the reply
    file_name : name under which the browser saves the text; "" where the browser shows the text
    """

    status: int
    media_type: str
    text: str
    file_name: str = ""


class _HttpRequest(NamedTuple):
    """A request that a browser sends for the page or for its data.

    Attributes
    ----------
    explorer : solver that answers for the brake
    setting : positions of the sliders
    refusal_messages : messages about parts of the link that were refused
    name : beginning of the name of a file that the browser saves
    """

    explorer: SliderSolver
    setting: SliderSetting
    refusal_messages: tuple[str, ...]
    name: str


def http_reply_to_requested_address(explorer: SliderSolver, address: str, name: str) -> HttpReply:
    """The reply to an address, which consists of a path and a query.

    No address raises an error: unreadable parts are ignored, and the reply says so. `name` is the
    beginning of the name of a file that the browser saves.
    """
    path, query = path_and_query_of_address(address)
    setting, lines = slider_setting_from_link_query(explorer.knobs, explorer.brake, query)
    make = REPLY_FUNCTION_BY_PAGE_PATH.get(path)
    if make is None:
        return HttpReply(
            404, HTML, f"no such page; there are {', '.join(REPLY_FUNCTION_BY_PAGE_PATH)}"
        )
    return make(_HttpRequest(explorer, setting, lines, name))


def path_and_query_of_address(address: str) -> tuple[str, dict[str, str]]:
    """The path of an address and the values of its query by name.

    If a name occurs twice, its last value counts. An address that cannot be read gives "" and {}.
    """
    try:
        parts = urlsplit(address[: 2 * MAX_CHARACTERS_OF_EXPLORE_PAGE_LINK])
        return parts.path, dict(parse_qsl(parts.query, keep_blank_values=True, max_num_fields=100))
    except ValueError:
        return "", {}


def _reply_with_html_page(request: _HttpRequest) -> HttpReply:
    """The HTML page with its sliders and with the drawing of the brake as the file gives it."""
    setting, brake = request.setting, request.explorer.brake
    low, high = lowest_and_highest_angle_or_position_of_linings(brake)
    is_flat, size = brake.surface.is_plane_and_not_drum, brake.size * 1e3
    # Dashed lines show where the highest pressure of the scale is drawn: circles with these radii
    # [mm] on a drum, a straight line at this height [mm] on a plane.
    rings = [-DRAWN_DISTANCE_OF_HIGHEST_PRESSURE_OF_SCALE * size]
    if not is_flat:
        signs = set(map(attrgetter("sign_internal_plus_external_minus"), brake.shoes))
        rings = sorted(
            size * (1 + sign * DRAWN_DISTANCE_OF_HIGHEST_PRESSURE_OF_SCALE) for sign in signs
        )
    # The page shows the colour of each model and the title of each law.
    colors, laws = {"fem": color_of_model("fem")}, {}
    for law in names_of_models_besides_fem(brake):
        colors[law], laws[law] = color_of_model(law), title_of_model_in_figures(law)
    text = _jinja_template_of_html_page().render(
        title=brake.title,
        lines=request.refusal_messages,
        knobs=list(map(partial(_slider_data_for_html_page, setting), request.explorer.knobs)),
        motion=motion_key_of_brake_file(brake),
        senses=brake.directions,
        laws=laws,
        models={
            name: PAGE_TITLES_OF_FINITE_ELEMENT_MODELS[name]
            for name in finite_element_models_offered_by_page(brake)
        },
        setting=setting,
        colors=colors,
        fixed={
            key: svg_path_of_lines(lines) for key, lines in drawing_lines_of_brake(brake).items()
        },
        reach=half_side_length_of_picture(brake),
        centre=centre_of_picture(brake),
        flat=is_flat,
        size=size,
        petal=DRAWN_DISTANCE_OF_HIGHEST_PRESSURE_OF_SCALE,
        units=(RESOLUTION_OF_CURVE_POSITIONS, RESOLUTION_OF_SENT_PRESSURES),
        rings=rings,
        place=brake.surface.axis_label_in_explorer,
        low=low,
        high=high,
        ticks=_values_of_axis_ticks(low, high, brake.surface.shown_unit),
    )
    return HttpReply(200, HTML, text)


def _values_of_axis_ticks(low: float, high: float, unit: str) -> list[float]:
    """The values of the ticks of an axis that reaches from `low` to `high`, in "deg" or "mm"."""
    if unit == "deg":
        steps = np.array([5, 10, 15, 30, 45, 60, 90])
    else:
        steps = np.array(
            four_round_numbers_around_value((high - low) / MAX_INTERVALS_BETWEEN_AXIS_TICKS)
        )
    # The ticks have the finest step at which the numbers beside them do not overlap.
    step = steps[np.argmax((high - low) / steps <= MAX_INTERVALS_BETWEEN_AXIS_TICKS)]
    ticks = np.arange(math.ceil(low / step), math.floor(high / step) + 1) * step
    return list(ticks.tolist())


def _jinja_template_of_html_page() -> jinja2.Template:
    """The jinja template from which the HTML page is made."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("drumlin", "explore"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
    )
    return environment.get_template("page.html")


def _slider_data_for_html_page(setting: SliderSetting, knob: BrakeSlider) -> dict[str, Any]:
    """The data from which the page makes a slider.

    A slider that changes its value by factors is logarithmic.
    """

    def value_or_its_logarithm_on_slider(value: float) -> float:
        """The place of a value on the slider: the value itself or its decimal logarithm."""
        return math.log10(value) if knob.log else value

    value = setting.value(knob)
    return {
        "name": knob.name,
        "title": knob.title,
        "value": value,
        "file": knob.start,
        "changed": knob.name in setting.values,
        "low": value_or_its_logarithm_on_slider(knob.low),
        "high": value_or_its_logarithm_on_slider(knob.high),
        "step": knob.step,
        "start": value_or_its_logarithm_on_slider(knob.start),
        "place": value_or_its_logarithm_on_slider(value),
        "log": knob.log,
    }


def _reply_with_picture_data(request: _HttpRequest) -> HttpReply:
    """The data of the picture for a setting: pressure curves, contact, forces and texts."""
    explorer = request.explorer
    answer = explorer.fem_and_law_answer_at_slider_setting(request.setting)
    picture = picture_of_brake_at_slider_setting(answer, explorer.brake)
    # The limit of self-locking takes time to find: the picture shows it if it is known already.
    known = None
    if answer.brake is not None:
        known = explorer.self_locking_friction_if_already_computed(
            answer.brake, answer.setting.model
        )
    whole_numbers = partial(
        pressure_curve_as_whole_numbers, scale=picture.highest_pressure_of_scale
    )
    arcs = np.rint(np.array(picture.arcs) / RESOLUTION_OF_CURVE_POSITIONS).astype(int)
    # The texts of the reply are finished HTML, its curves are whole numbers.
    data = {
        "fem": list(map(whole_numbers, picture.fem)),
        "law": list(map(whole_numbers, picture.law)),
        "arcs": arcs.tolist(),
        "forces": svg_path_of_lines(picture.forces),
        "scale": picture.highest_pressure_of_scale,
        "motion": picture.motion,
        "head": torque_and_refusals_as_html(picture, request.refusal_messages),
        "table": html_table_of_text_rows(picture.rows),
        "locking": self_locking_as_html(answer, known),
        "error": error_of_finite_elements_as_html(answer, None, asked=False),
        "torque": None if answer.fem_response is None else answer.fem_response.effect,
        "shape": _drawing_of_changed_shape(request, answer.brake),
    }
    return HttpReply(200, JSON, json.dumps(data, allow_nan=False))


def _drawing_of_changed_shape(request: _HttpRequest, brake: Brake | None) -> dict[str, Any] | None:
    """The drawing of a brake whose shape differs from the file's; None for equal shapes."""
    names = {knob.name for knob in geometry_sliders_for_brake(request.explorer.brake)}
    if brake is None or not names & set(request.setting.values):
        return None
    lines = drawing_lines_of_brake(brake)
    hinges = [[float(x[0]), float(y[0])] for x, y in zip(*lines["hinges"], strict=True)]
    paths = {key: svg_path_of_lines(lines[key]) for key in ("bodies", "linings", "drum")}
    return {"size": brake.size * 1e3, "hinges": hinges, **paths}


def _reply_with_self_locking_limit_and_errors(request: _HttpRequest) -> HttpReply:
    """The limit of self-locking and the errors, which take long to compute, and the page's link.

    The page asks for these data when its sliders rest.
    """
    explorer = request.explorer
    answer = explorer.fem_and_law_answer_at_slider_setting(request.setting)
    locking = None
    if answer.brake is not None:
        locking = explorer.cached_self_locking_friction_of_shoe_groups(
            answer.brake, answer.setting.model
        )
    data = {
        "locking": self_locking_as_html(answer, locking),
        "error": error_of_finite_elements_as_html(
            answer, explorer.difference_from_accurate_answer(answer), asked=True
        ),
        "link": link_query_of_slider_setting(explorer.knobs, explorer.brake, request.setting),
    }
    return HttpReply(200, JSON, json.dumps(data, allow_nan=False))


def _reply_with_brake_file(request: _HttpRequest) -> HttpReply:
    """The brake file for a setting. Its clearances include the depth that wear has removed."""
    explorer, name = request.explorer, request.name
    answer = explorer.fem_and_law_answer_at_slider_setting(request.setting)
    if answer.brake is None or answer.failure:
        return HttpReply(422, HTML, escape(answer.failure))
    # A comment at the top of the file names the link of the page from which the file comes.
    link = link_query_of_slider_setting(explorer.knobs, explorer.brake, request.setting)
    head = f"# {printable_single_line(name)}, explored: {link or 'as it is'}\n"
    if answer.distance:
        head += "# Its clearances are tables of what wear has left.\n"
    try:
        rounded = _brake_with_rounded_worn_clearances(answer) if answer.distance else answer.brake
        rounded = _brake_with_absolute_mesh_paths(rounded)
        text = brake_file_text(_part_with_rounded_points(rounded))
    except BadInput as error:
        return HttpReply(422, HTML, escape(str(error)))
    return HttpReply(200, TOML, head + text, f"{_file_name_for_any_system(name)}_explored.toml")


def _brake_with_rounded_worn_clearances(answer: FemAndLawAnswerAtSliderSetting) -> Brake:
    """A copy of the worn brake whose tables of clearance have rounded angles and depths."""
    # The caller has made sure that the finite elements have an answer.
    assert answer.brake is not None
    tables = {}
    for key, lining in linings_by_brake_file_key(answer.brake).items():
        if isinstance(lining.clearance, tuple):
            tables[f"{key}.clearance"] = [
                [rounded_brake_file_text_of_angle(angle), f"{depth * 1e3:.6g} mm"]
                for angle, depth in lining.clearance
            ]
    return vary(answer.brake, tables) if tables else answer.brake


def _part_with_rounded_points(part: PartOfInputFile) -> PartOfInputFile:
    """A copy of a part of a brake in which all points have rounded coordinates.

    A point that the file gives by radius and angle has coordinates with all digits.
    """
    if isinstance(part, Point):
        return part.model_copy(
            update={
                "x": value_with_all_numbers_rounded(part.x),
                "y": value_with_all_numbers_rounded(part.y),
            }
        )

    def field_value_with_rounded_points(value: Any) -> Any:
        """The value of a part's field, in which all points have rounded coordinates."""
        if isinstance(value, PartOfInputFile):
            return _part_with_rounded_points(value)
        return (
            tuple(map(field_value_with_rounded_points, value))
            if isinstance(value, tuple)
            else value
        )

    fields = type(part).model_fields
    return part.model_copy(
        update={name: field_value_with_rounded_points(getattr(part, name)) for name in fields}
    )


def _brake_with_absolute_mesh_paths(brake: Brake) -> Brake:
    """A copy of the brake with absolute paths of its mesh files.

    The browser chooses the folder of the saved brake file, where relative paths would be wrong.
    """
    meshes = {}
    for i, shoe in enumerate(brake.shoes):
        if shoe.mesh is not None:
            meshes[f"shoe[{i}].mesh"] = shoe.mesh.absolute()
    return vary(brake, meshes) if meshes else brake


def _file_name_for_any_system(name: str) -> str:
    """The name with "_" in place of letters that a file name cannot have on some system."""

    def is_character_allowed_in_file_name(letter: str) -> bool:
        """Whether a file name can contain the letter on every operating system."""
        return letter not in CHARACTERS_FORBIDDEN_IN_FILE_NAMES and letter.isprintable()

    return "".join(letter if is_character_allowed_in_file_name(letter) else "_" for letter in name)


REPLY_FUNCTION_BY_PAGE_PATH: Mapping[str, Callable[[_HttpRequest], HttpReply]] = {
    "/": _reply_with_html_page,
    "/picture": _reply_with_picture_data,
    "/locking": _reply_with_self_locking_limit_and_errors,
    "/brake.toml": _reply_with_brake_file,
}
"""For each path of the page's addresses, the function that makes the reply."""
