"""The pages of the example brakes: a gallery of all, and the examples of each kind of brake."""

import io
import re
import tomllib
from collections.abc import Callable
from contextlib import redirect_stdout
from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt

import drumlin
from drumlin.cli.answer import print_brake_response
from drumlin.models import applicable_models
from drumlin.report.drawing import draw_brake
from drumlin.report.figures import save_figure
from drumlin.studies import paths_of_example_brakes

PICTURE_WIDTH = 4.5
"""Width and height of a picture of a brake [inch]: a column of a page on a telephone."""


class Shown(NamedTuple):
    """The page of an example, and what the example shows in words."""

    kind: str
    shows: str


EXAMPLES: dict[str, Shown] = {
    "simplex_hinged": Shown("simplex", "a leading and a trailing shoe under one cylinder"),
    "simplex_abutted": Shown("simplex", "shoes that slide on an abutment in place of a pin"),
    "double_shoe": Shown("simplex", "the example of most pages: how wrong the sine law is"),
    "double_shoe_flexible": Shown("simplex", "the same brake with shoes that bend"),
    "double_shoe_meshes": Shown("simplex", "the same brake with a mesh file for each shoe"),
    "web_shoe": Shown("simplex", "a mesh of your own: a shoe with holes in its web"),
    "plane_stress": Shown("simplex", "shoes of T-section, for which plane stress is not enough"),
    "heat": Shown("simplex", "temperature rises that change clearances and torque"),
    "fading_friction": Shown("simplex", "friction that falls with pressure and speed"),
    "linings_apart": Shown("simplex", "two linings on one shoe"),
    "bhandari_12_8": Shown("simplex", "a worked example in print"),
    "shigley_16_2": Shown("simplex", "a worked example in print"),
    "shigley_p16_1": Shown("simplex", "a worked example in print"),
    "duplex": Shown("duplex", "two leading shoes"),
    "duo_servo": Shown("servo", "two shoes on an adjuster, boosted in both senses of rotation"),
    "duo_servo_by_hand": Shown("servo", "a torque that follows by hand"),
    "uni_servo": Shown("servo", "a shoe that pushes the next one, in one sense of rotation"),
    "s_cam": Shown("s_cam", "a cam that moves both shoes alike and divides its force"),
    "air_chamber": Shown("s_cam", "a chamber and a slack adjuster that turn the cam"),
    "parking_lever": Shown("parking", "a lever in the drum with a cable and a strut"),
    "post_brake": Shown("post", "long posts that bend, with a block on each"),
    "block": Shown("block", "the lever of textbooks with a long block"),
    "short_block": Shown("block", "the lever of textbooks with a short block"),
    "pivoted_block": Shown("block", "a block on a pivot, which turns until it fits the drum"),
    "block_on_lever": Shown("block", "an elastic block that is bolted to its lever"),
    "double_block": Shown("block", "two blocks whose normal forces nearly cancel"),
    "crane": Shown("block", "external shoes on pivots of two levers"),
    "double_shoe_external": Shown("block", "external shoes on pins"),
    "band": Shown("block", "a band of blocks: each block pulls the next"),
    "pad": Shown("plane", "a flat pad on a body that slides"),
    "rail_clamp": Shown("plane", "a pad on a pivot that clamps a rail"),
    "centrifugal_clutch": Shown("clutch", "masses that the rotation presses outwards"),
}
"""The kind of brake that each example belongs to. Each kind has a page in pages/kinds."""


def example_pages(say: Callable[[str], None] = lambda _: None) -> dict[str, str]:
    """The texts that follow the hand-written pages on kinds of brakes, and that of the gallery."""
    pages = {"gallery.md": _gallery_text()}
    for name, path in paths_of_example_brakes().items():
        say(f"the example {name}")
        page = f"kinds/{EXAMPLES[name].kind}.md"
        pages[page] = pages.get(page, "") + _section_of_example(name, path)
    return pages


def draw_examples(folder: Path) -> None:
    """Draw each example brake into a file NAME.png of `folder`."""
    for name in paths_of_example_brakes():
        figure, axes = plt.subplots(figsize=(PICTURE_WIDTH, PICTURE_WIDTH), layout="constrained")
        draw_brake(axes, drumlin.example(name))
        save_figure(figure, folder / f"{name}.png")
        plt.close(figure)


def _gallery_text() -> str:
    """A thumbnail of each example, with a link to its place on the page of its kind."""
    cards = []
    for name, path in paths_of_example_brakes().items():
        title = tomllib.loads(path.read_text(encoding="utf-8"))["title"]
        kind, shows = EXAMPLES[name]
        cards.append(
            f"- [![{title}](pictures/{name}.png)<br>**{title}**](kinds/{kind}.md#{name})\n"
            f"  {shows}\n"
        )
    return "\n:::{container} gallery\n" + "\n".join(cards) + ":::\n"


def _section_of_example(name: str, path: Path) -> str:
    """What an example is and shows, its picture, the commands that solve it, and their output."""
    text = path.read_text(encoding="utf-8")
    title = tomllib.loads(text)["title"]
    about = " ".join(re.findall(r"(?m)^# (.*)$", text.partition("title")[0]))
    model = _model_of_example(name)
    brake = drumlin.example(name)
    printed = io.StringIO()
    with redirect_stdout(printed):
        print_brake_response(brake, drumlin.solve(brake, model))
    option = "" if model == "fem" else f" --model {model}"
    return (
        f"\n({name})=\n\n## {title[0].upper() + title[1:]}\n\nIt shows {EXAMPLES[name].shows}.\n\n"
        f":::{{container}} brake-picture\n![{title}](../pictures/{name}.png)\n:::\n\n{about}\n\n"
        f"```sh\ndrumlin init {name} > my.toml\ndrumlin solve my.toml{option}\n```\n\n"
        f"```text\n{printed.getvalue().rstrip()}\n```\n"
    )


def _model_of_example(name: str) -> str:
    """Finite elements if they apply to an example, else the first model that applies."""
    names = [model.name for model in applicable_models(drumlin.example(name))]
    return "fem" if "fem" in names else names[0]
