"""The brakes of the study: those that finite elements cover, and variants for omissions."""

from pathlib import Path
from typing import Any

from drumlin.base.errors import DrumlinError
from drumlin.brake.brake import Brake
from drumlin.brake.file import read_brake, vary
from drumlin.brake.plane_brake import read_drum_or_plane_brake
from drumlin.models import applicable_models, reasons_why_models_do_not_apply

STUDIES = Path(__file__).parents[1]
MAIN = STUDIES / "double_shoe" / "brake.toml"
IRON, LAYER = {"E": 1.2e11, "nu": 0.25}, {"E": 1e10, "nu": 0.3}
"""Materials of rings and backings in SI units."""


def brakes_with_elements() -> tuple[dict[str, Path], dict[str, str]]:
    """The brake files of studies/ that finite elements cover, and why others are left out.

    Both are by name of the brake.
    """
    found, refused = {}, {}
    for path in sorted(STUDIES.glob("*/*.toml")):
        name = f"{path.parent.name}/{path.stem}"
        try:
            brake = read_drum_or_plane_brake(path)
        except DrumlinError:
            # The file holds data of a study, not a brake.
            continue
        refusal = reasons_why_models_do_not_apply(brake).get("fem")
        unlike = (
            "its shoes press on a plane"
            if brake.surface.is_plane_and_not_drum
            else brake.reason_why_not_all_shoes_are_hinged()
        )
        if refusal is not None:
            models = ", ".join(model.name for model in applicable_models(brake))
            refused[name] = f"{refusal}; only {models}, and nothing to judge by"
        elif unlike is not None:
            refused[name] = f"{unlike}; what stands beside it is the study brakes"
        else:
            found[name] = path
    return found, refused


def _ring_changes(support: str, thickness: float = 0.015, E: float = 1.2e11) -> dict[str, Any]:
    """Changes that give a brake an elastic ring: thickness [m] and Young's modulus E [Pa]."""
    material = {**IRON, "E": E}
    return {
        "drum.ring": {
            "thickness": thickness,
            "width": 0.04,
            "material": material,
            "support": support,
        }
    }


def _backing_changes(thickness: float = 0.005, E: float = 1e10) -> dict[str, Any]:
    """Changes that give each shoe a backing: thickness [m] and Young's modulus E [Pa]."""
    return {"shoe.backing": {"thickness": thickness, "material": {**LAYER, "E": E}}}


def brakes_with_omissions(*, short: bool = False) -> dict[str, Brake]:
    """The brakes on which omissions are timed, by name."""
    main = read_brake(MAIN)
    found = {
        "double shoe": main,
        "double shoe, ring fixed": vary(main, _ring_changes("fixed")),
    }
    if short:
        return found
    return found | {
        "double shoe, ring free": vary(main, _ring_changes("free")),
        "double shoe, backing": vary(main, _backing_changes()),
        "double shoe, mu = 0": vary(main, {"friction": 0.0}),
        "flexible double shoe": read_brake(STUDIES / "double_shoe" / "flexible.toml"),
        "post brake": read_brake(STUDIES / "post_brake" / "brake.toml"),
    }


def brakes_from_stiff_to_soft(*, short: bool = False) -> dict[str, Brake]:
    """The brakes on which only the predictions of omissions are checked, by name."""
    main = read_brake(MAIN)
    shoes = {}
    for E in (2.1e12, 2.1e13, 2.1e14, 2.1e15):
        shoes[f"shoe E = {E:.0e} Pa"] = vary(main, {"shoe.body.material.E": E})
    if short:
        return dict(list(shoes.items())[::2])
    # Rings and layers from soft to nearly rigid.
    free = {}
    for E in (1e9, 1.2e11, 2e12, 2e13, 2e14):
        free[f"free ring, E = {E:.0e} Pa"] = vary(main, _ring_changes("free", 0.03, E))
    fixed = {}
    for E in (3e8, 1e9, 1e10, 1e13):
        fixed[f"fixed ring, E = {E:.0e} Pa"] = vary(main, _ring_changes("fixed", 0.015, E))
    layers = {}
    for E in (3e8, 3e9, 1e11):
        layers[f"backing E = {E:.0e} Pa"] = vary(main, _backing_changes(0.003, E))
    rigid = {}
    for E in (3e8, 3e9, 3e10):
        rigid[f"rigid shoe, backing E = {E:.0e} Pa"] = vary(
            main, {"shoe.body": None} | _backing_changes(0.003, E)
        )
    friction = {}
    for mu in (0.02, 0.5):
        friction[f"rigid shoe, mu = {mu:g}"] = vary(main, {"shoe.body": None, "friction": mu})
    return shoes | free | fixed | layers | rigid | friction
