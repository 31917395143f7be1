"""The page's addresses and what they answer: the page itself, pictures, the limit of self-locking, the brake file."""

import json
import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple
from urllib.parse import parse_qsl, urlsplit

import jinja2

from drumlin.brake.writing import brake_text
from drumlin.explore.answers import Explorer
from drumlin.explore.knobs import LONGEST_LINK, ROTATIONS, Knob, Setting, laws_of, link_of, setting_from
from drumlin.explore.picture import (
    PETAL,
    brake_extent,
    drawing_of,
    head_html,
    locking_html,
    path_of,
    picture_of,
    reach_of,
    table_html,
)
from drumlin.report.figures import name_of
from drumlin.report.palette import color_of

HTML, JSON, TOML = "text/html; charset=utf-8", "application/json", "application/toml; charset=utf-8"


class Reply(NamedTuple):
    """What is sent: HTTP status, media type, text, and the name of a file that is saved ("": none)."""

    status: int
    media: str
    text: str
    file: str = ""


def reply(explorer: Explorer, address: str, name: str) -> Reply:
    """The reply to an address, path and query. `name`: first words of a file that is saved. Raises nothing for any
    address: what cannot be read of it is left out and said."""
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
    every = next(step for step in (5, 10, 15, 30, 45, 60, 90) if (high - low) / step <= 9)
    first = math.ceil(low / every) * every
    text = _template().render(
        title=brake.title,
        lines=lines,
        knobs=[_slider(knob, setting) for knob in explorer.knobs],
        rotations=ROTATIONS,
        laws={law: name_of(law) for law in laws_of(brake)},
        setting=setting,
        colors={model: color_of(model) for model in ("fem", *laws_of(brake))},
        fixed={key: path_of(found) for key, found in drawing_of(brake).items()},
        reach=reach_of(brake),
        R=brake.drum.radius * 1e3,
        rings=sorted({brake.drum.radius * 1e3 * (1 + shoe.sign * PETAL) for shoe in brake.shoes}),
        low=low,
        high=high,
        ticks=[angle for angle in range(first, math.floor(high) + 1, every)],
    )
    return Reply(200, HTML, text)


def _template() -> jinja2.Template:
    loader = jinja2.PackageLoader("drumlin", "explore")
    return jinja2.Environment(loader=loader, autoescape=True, undefined=jinja2.StrictUndefined).get_template(
        "page.html"
    )


def _slider(knob: Knob, setting: Setting) -> dict[str, Any]:
    """A slider as the page makes it: places are logarithms where it moves by factors."""
    value = setting.value(knob)
    low, high, start, now = (math.log10(x) if knob.log else x for x in (knob.low, knob.high, knob.start, value))
    place = {"low": low, "high": high, "step": knob.step, "start": start, "place": now, "log": knob.log}
    return {"name": knob.name, "title": knob.title, "value": value, "changed": knob.name in setting.values, **place}


def _picture(explorer: Explorer, setting: Setting, lines: tuple[str, ...], name: str) -> Reply:
    answer = explorer.answer(setting)
    picture = picture_of(answer, explorer.brake)
    known = explorer.known_locking(answer.brake) if answer.brake is not None else None
    data = {
        "paths": {key: path_of(found) for key, found in picture.lines.items()},
        "forces": path_of(picture.forces),
        "scale": picture.scale,
        "motion": picture.motion,
        "head": head_html(picture, lines),
        "table": table_html(picture.rows),
        "locking": locking_html(answer, known),
        "torque": None if answer.found is None else answer.found.torque,
    }
    return Reply(200, JSON, json.dumps(data, allow_nan=False))


def _locking(explorer: Explorer, setting: Setting, lines: tuple[str, ...], name: str) -> Reply:
    answer = explorer.answer(setting)
    found = explorer.locking(answer.brake) if answer.brake is not None else None
    link = link_of(explorer.knobs, explorer.brake, setting)
    return Reply(200, JSON, json.dumps({"locking": locking_html(answer, found), "link": link}))


def _brake(explorer: Explorer, setting: Setting, lines: tuple[str, ...], name: str) -> Reply:
    """The brake as it is solved, with the clearance of worn linings."""
    answer = explorer.answer(setting)
    if answer.brake is None or answer.failure:
        return Reply(422, HTML, answer.failure)
    said = f"# {name}, explored: {link_of(explorer.knobs, explorer.brake, setting) or 'as it is'}\n"
    if answer.distance:
        said += "# Its clearances are tables of what wear has left.\n"
    return Reply(200, TOML, said + brake_text(answer.brake), f"{name}_explored.toml")


PATHS: Mapping[str, Callable[[Explorer, Setting, tuple[str, ...], str], Reply]] = {
    "/": _page,
    "/picture": _picture,
    "/locking": _locking,
    "/brake.toml": _brake,
}
