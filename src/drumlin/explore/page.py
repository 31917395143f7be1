"""The page's addresses and what they answer: the page itself, pictures, the limit of self-locking,
the brake file.
"""

import json
import math
from collections.abc import Callable, Mapping
from html import escape
from typing import Any, NamedTuple
from urllib.parse import parse_qsl, urlsplit

import jinja2

from drumlin.base.errors import BadInput
from drumlin.base.texts import one_line
from drumlin.brake import vary
from drumlin.brake.brake import Brake
from drumlin.brake.writing import brake_text
from drumlin.explore.answers import Explorer
from drumlin.explore.knobs import (
    LONGEST_LINK,
    Knob,
    Setting,
    laws_of,
    link_of,
    motion_of,
    setting_from,
)
from drumlin.explore.picture import (
    PETAL,
    PLACE,
    PRESSURE,
    brake_extent,
    centre_of,
    drawing_of,
    error_html,
    head_html,
    locking_html,
    numbers_of,
    path_of,
    picture_of,
    reach_of,
    table_html,
)
from drumlin.report.figures import name_of
from drumlin.report.palette import color_of

NO_NAMES = frozenset('/\\:*?"<>|')
"""Letters that no file's name can have on one system or another."""
HTML, JSON, TOML = "text/html; charset=utf-8", "application/json", "application/toml; charset=utf-8"


class Reply(NamedTuple):
    """What is sent: HTTP status, media type, text, and the name of a file that is saved ("": none)."""

    status: int
    media: str
    text: str
    file: str = ""


def reply(explorer: Explorer, address: str, name: str) -> Reply:
    """The reply to an address, path and query. `name`: first words of a file that is saved. Raises
    nothing for any address: what cannot be read of it is left out and said.
    """
    path, query = split(address)
    setting, lines = setting_from(explorer.knobs, explorer.brake, query)
    found = PATHS.get(path)
    if found is None:
        return Reply(404, HTML, f"no such page; there are {', '.join(PATHS)}")
    return found(explorer, setting, lines, name)


def split(address: str) -> tuple[str, dict[str, str]]:
    """Path and query of an address; of a name that occurs twice the last value."""
    try:
        parts = urlsplit(address[: 2 * LONGEST_LINK])
        return parts.path, dict(parse_qsl(parts.query, keep_blank_values=True, max_num_fields=100))
    except ValueError:
        return "", {}


def _page(explorer: Explorer, setting: Setting, lines: tuple[str, ...], name: str) -> Reply:
    brake = explorer.brake
    low, high = brake_extent(brake)
    motion, size, flat = motion_of(brake), brake.size * 1e3, brake.surface.straight
    signs = {shoe.sign for shoe in brake.shoes}
    text = _template().render(
        title=brake.title,
        lines=lines,
        knobs=[_slider(knob, setting) for knob in explorer.knobs],
        motion=motion,
        senses=brake.directions,
        laws={law: name_of(law) for law in laws_of(brake)},
        setting=setting,
        colors={model: color_of(model) for model in ("fem", *laws_of(brake))},
        fixed={key: path_of(found) for key, found in drawing_of(brake).items()},
        reach=reach_of(brake),
        centre=centre_of(brake),
        flat=flat,
        size=size,
        petal=PETAL,
        units=(PLACE, PRESSURE),
        rings=[-PETAL * size] if flat else sorted(size * (1 + sign * PETAL) for sign in signs),
        place=brake.surface.page_axis,
        low=low,
        high=high,
        ticks=_ticks(low, high, brake.surface.shown_unit),
    )
    return Reply(200, HTML, text)


def _ticks(low: float, high: float, unit: str) -> list[float]:
    """Round places between two others."""
    power = 10.0 ** math.floor(math.log10((high - low) / 9))
    steps = (
        (5, 10, 15, 30, 45, 60, 90) if unit == "deg" else [digit * power for digit in (1, 2, 5, 10)]
    )
    every = next(step for step in steps if (high - low) / step <= 9)
    return [every * k for k in range(math.ceil(low / every), math.floor(high / every) + 1)]


def _template() -> jinja2.Template:
    loader = jinja2.PackageLoader("drumlin", "explore")
    return jinja2.Environment(
        loader=loader, autoescape=True, undefined=jinja2.StrictUndefined
    ).get_template("page.html")


def _slider(knob: Knob, setting: Setting) -> dict[str, Any]:
    """A slider as the page makes it: places are logarithms where it moves by factors."""
    value = setting.value(knob)
    low, high, start, now = (
        math.log10(x) if knob.log else x for x in (knob.low, knob.high, knob.start, value)
    )
    place = {
        "low": low,
        "high": high,
        "step": knob.step,
        "start": start,
        "place": now,
        "log": knob.log,
    }
    return {
        "name": knob.name,
        "title": knob.title,
        "value": value,
        "changed": knob.name in setting.values,
        **place,
    }


def _picture(explorer: Explorer, setting: Setting, lines: tuple[str, ...], name: str) -> Reply:
    answer = explorer.answer(setting)
    picture = picture_of(answer, explorer.brake)
    known = explorer.known_locking(answer.brake) if answer.brake is not None else None
    data = {
        "fem": [numbers_of(curve, picture.scale) for curve in picture.fem],
        "law": [numbers_of(curve, picture.scale) for curve in picture.law],
        "arcs": [[round(end / PLACE) for end in arc] for arc in picture.arcs],
        "forces": path_of(picture.forces),
        "scale": picture.scale,
        "motion": picture.motion,
        "head": head_html(picture, lines),
        "table": table_html(picture.rows),
        "locking": locking_html(answer, known),
        "error": error_html(answer, None, asked=False),
        "torque": None if answer.found is None else answer.found.effect,
    }
    return Reply(200, JSON, json.dumps(data, allow_nan=False))


def _locking(explorer: Explorer, setting: Setting, lines: tuple[str, ...], name: str) -> Reply:
    answer = explorer.answer(setting)
    found = explorer.locking(answer.brake) if answer.brake is not None else None
    data = {
        "locking": locking_html(answer, found),
        "error": error_html(answer, explorer.stated(answer), asked=True),
        "link": link_of(explorer.knobs, explorer.brake, setting),
    }
    return Reply(200, JSON, json.dumps(data, allow_nan=False))


def _brake(explorer: Explorer, setting: Setting, lines: tuple[str, ...], name: str) -> Reply:
    """The brake as it is solved, with the clearance of worn linings."""
    answer = explorer.answer(setting)
    if answer.brake is None or answer.failure:
        return Reply(422, HTML, escape(answer.failure))
    said = f"# {one_line(name)}, explored: {link_of(explorer.knobs, explorer.brake, setting) or 'as it is'}\n"
    if answer.distance:
        said += "# Its clearances are tables of what wear has left.\n"
    try:
        text = brake_text(_found_from_anywhere(answer.brake))
    except BadInput as error:
        return Reply(422, HTML, escape(str(error)))
    return Reply(200, TOML, said + text, f"{_file_name(name)}_explored.toml")


def _found_from_anywhere(brake: Brake) -> Brake:
    """The brake with absolute paths of its mesh files: the browser chooses the folder that the file
    is saved in.
    """
    meshes = {
        f"shoe[{i}].mesh": shoe.mesh.absolute()
        for i, shoe in enumerate(brake.shoes)
        if shoe.mesh is not None
    }
    return vary(brake, meshes) if meshes else brake


def _file_name(name: str) -> str:
    """A name that every file system takes: what is not printable, or parts folders or options, is
    written as "_".
    """
    return "".join(
        "_" if letter in NO_NAMES or not letter.isprintable() else letter for letter in name
    )


PATHS: Mapping[str, Callable[[Explorer, Setting, tuple[str, ...], str], Reply]] = {
    "/": _page,
    "/picture": _picture,
    "/locking": _locking,
    "/brake.toml": _brake,
}
