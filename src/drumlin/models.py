"""The models that answer for a brake, by name. Each takes a Brake and returns a Response."""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from drumlin import laws
from drumlin.brake import Brake
from drumlin.errors import BadInput
from drumlin.response import Response


class Model(NamedTuple):
    """A model: what it assumes, why it does not apply to a brake (None: it does), and its solver."""

    name: str
    assumes: str
    why_not: Callable[[Brake], str | None]
    solve: Callable[..., Response]


def _fem(brake: Brake, **options: Any) -> Response:
    from drumlin.fem import model

    return model.solve(brake, **options)


def _fem_why_not(brake: Brake) -> str | None:
    from drumlin.fem import scene

    return scene.why_not(brake)


MODELS: Mapping[str, Model] = {
    model.name: model
    for model in (
        Model("fem", "2D plane stress, unilateral contact, full-slip Coulomb friction", _fem_why_not, _fem),
        Model(
            "sine",
            "rigid shoe turning about its hinge, rigid drum, lining that fits",
            laws.sine_why_not,
            laws.sine,
        ),
    )
}


def pick(name: str, brake: Brake) -> Model:
    """The model called `name`; raises BadInput where there is none, or where it does not apply to the brake."""
    if name not in MODELS:
        raise BadInput(f"--model = {name!r}: unknown model; allowed: {', '.join(MODELS)}")
    model = MODELS[name]
    reason = model.why_not(brake)
    if reason is not None:
        raise BadInput(f"--model = {name!r}: does not apply to this brake: {reason}")
    return model


def applicable(brake: Brake) -> tuple[Model, ...]:
    """The models that apply to a brake."""
    return tuple(model for model in MODELS.values() if model.why_not(brake) is None)
