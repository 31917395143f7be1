"""Brakes of all ways to hold and push shoes, for the model of the width."""

from pathlib import Path

from drumlin.brake.file import read_brake, vary
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from flat_pads import pad
from held_shoes import BODY, brake_of
from sections import t_section

ROOT = Path(__file__).resolve().parents[1]
STEEL_BACK = {"thickness": 0.004, "material": {"E": 2.1e11, "nu": 0.3}}
FLAT_BODY = {
    "thickness": 0.02,
    "width": 0.04,
    "start": 0.05,
    "end": 0.19,
    "material": {"E": 2.1e11, "nu": 0.3},
}


def post():
    """A post brake of straight beams on a rigid drum, of one width."""
    brake = read_brake(ROOT / "studies" / "post_brake" / "brake.toml")
    width = brake.shoes[0].lining.width
    own = {"shoe.body.width": width, "shoe.body.bending_stiffness": None}
    return vary(brake, {"drum.ring": None, **own})


HELD = {
    "double shoe": lambda: read_brake(ROOT / "studies" / "double_shoe" / "brake.toml"),
    "T-section": lambda: t_section(read_brake(ROOT / "studies" / "double_shoe" / "flexible.toml")),
    "rigid": lambda: brake_of("pivot", 1),
    "rigid with a backing": lambda: brake_of("guide", 1, backing=STEEL_BACK),
    "abutment": lambda: brake_of("rough abutment", -1, body=BODY),
    "grip": lambda: brake_of("pivot", 1, body=BODY),
    "narrow body in a grip": lambda: brake_of("guide", 1, body=BODY | {"width": 0.015}),
    "wide body": lambda: brake_of("abutment", 1, body=BODY | {"width": 0.06}),
    "post": post,
    "pad": lambda: pad("hinge", body=FLAT_BODY),
    "pad in a grip": lambda: pad("pivot", body=FLAT_BODY),
    "rigid pad": lambda: pad("hinge"),
}
"""Brakes of all ways to hold and push shoes."""


def plane(brake, level=REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0]):
    return solve_prepared_model(make_prepared_model(brake, level), brake)
