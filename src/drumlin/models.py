"""The models that answer for a brake, by name. Each takes a brake and returns a Response."""

from collections.abc import Callable, Collection, Mapping
from functools import partial
from typing import Any, NamedTuple

from drumlin.base.errors import BadInput
from drumlin.base.texts import nearest
from drumlin.brake.brake import Brake
from drumlin.brake.orthotropic import isotropic_only
from drumlin.laws import LAWS, flat, hinged, naming, pivoted, rigid
from drumlin.response.response import Response


class Model(NamedTuple):
    """A model: what it assumes, why it does not apply to a brake (None: it does), and its solver.

    `by_name`: it takes seconds, and answers only where it is asked for by its name.
    """

    name: str
    assumes: str
    why_not: Callable[[Brake], str | None]
    solve: Callable[..., Response]
    by_name: bool = False


def _fem(brake: Brake, *, worn_in: bool = False, **options: Any) -> Response:
    if worn_in:
        from drumlin.lining_wear.worn_in import solve as by_worn_in

        return by_worn_in(brake, **options)
    from drumlin.fem.solve import solve as by_elements

    return by_elements(brake, **options)


def _fem_why_not(brake: Brake) -> str | None:
    from drumlin.fem.preparation.scene import why_not

    return why_not(brake)


def _foundation(brake: Brake, **options: Any) -> Response:
    from drumlin.foundation import solve as on_springs

    return on_springs(brake, **options)


def _foundation_why_not(brake: Brake) -> str | None:
    from drumlin.foundation import why_not

    return why_not(brake)


def _solid(brake: Brake, **options: Any) -> Response:
    from drumlin.fem.solid import model

    return model.solve(brake, **options)


def _solid_why_not(brake: Brake) -> str | None:
    from drumlin.fem.solid import model

    return model.why_not(brake)


SHORT: Mapping[str, tuple[Any, Any]] = {
    "drum": (hinged, LAWS["short"]),
    "plane": (flat, flat.FLAT_SHORT),
}
"""The laws of the short shoe, by the word of the surface: the module with its functions, and the
law.
"""


def _short_why_not(brake: Brake) -> str | None:
    laws, law = SHORT[brake.surface.word]
    return laws.why_not(law, brake)


def _short(brake: Brake) -> Response:
    laws, law = SHORT[brake.surface.word]
    return laws.solve(law, brake)


def _hinged(name: str) -> Model:
    law = LAWS[name]
    return _law(name, law.assumes, partial(hinged.why_not, law), partial(hinged.solve, law))


def _law(
    name: str, assumes: str, why_not: Callable[[Brake], str | None], solve: Callable[..., Response]
) -> Model:
    """The model of a closed-form law, which knows isotropic materials alone."""

    def isotropic_too(brake: Brake) -> str | None:
        return why_not(brake) or isotropic_only(brake, "a closed-form law")

    return Model(name, assumes, isotropic_too, solve)


MODELS: Mapping[str, Model] = {
    model.name: model
    for model in (
        Model(
            "fem",
            "2D plane stress, unilateral contact, full-slip Coulomb friction",
            _fem_why_not,
            _fem,
        ),
        _hinged("sine"),
        Model(
            "foundation",
            "beam on springs against an elastic ring",
            _foundation_why_not,
            _foundation,
        ),
        _hinged("cosine"),
        _hinged("block"),
        _hinged("uniform"),
        _law("short", LAWS["short"].assumes, _short_why_not, _short),
        _law("pivoted", pivoted.ASSUMES, pivoted.why_not, partial(rigid.solve, name="pivoted")),
        _law(
            "linear",
            flat.LINEAR.assumes,
            partial(flat.why_not, flat.LINEAR),
            partial(rigid.solve, name="linear"),
        ),
        _law("rigid", rigid.ASSUMES, naming.why_not, rigid.solve),
        Model(
            "solid",
            "solid shoes of finite width, contact and friction as fem",
            _solid_why_not,
            _solid,
            by_name=True,
        ),
    )
}


def pick(name: str, brake: Brake) -> Model:
    """The model called `name`; raises BadInput where there is none, or where it does not apply to
    the brake.
    """
    if name not in MODELS:
        raise BadInput(
            f"--model = {name!r}: unknown model{nearest(name, MODELS)}; allowed: {', '.join(MODELS)}"
        )
    model = MODELS[name]
    reason = model.why_not(brake)
    if reason is not None:
        apply = (
            ", ".join(other.name for other in MODELS.values() if other.why_not(brake) is None)
            or "none"
        )
        raise BadInput(
            f"--model = {name!r}: does not apply to this brake: {reason}; allowed: {apply}"
        )
    return model


def given_options(**options: Any) -> dict[str, Any]:
    """The options that were given: all but None and False.

    Raises BadInput for `elements` out of range, whatever the model makes of them.
    """
    elements = options.get("elements")
    if elements is not None:
        from drumlin.fem.preparation.meshes import MOST_LINING_ELEMENTS

        if not 1 <= elements <= MOST_LINING_ELEMENTS:
            raise BadInput(f"--elements = {elements}: must be from 1 to {MOST_LINING_ELEMENTS}")
    return {
        name: value for name, value in options.items() if value is not None and value is not False
    }


OWN_OPTIONS: Mapping[str, tuple[str, ...]] = {
    "fem": ("elements", "kind", "penalty", "tolerance", "finite-width"),
    "solid": ("elements", "across", "penalty", "fields"),
    "foundation": ("sections", "lift"),
}
"""The options of the models that have some, as the command line spells them."""


def check_options(model: str, given: Collection[str]) -> None:
    """Raise BadInput where an option belongs to other models than the chosen one.

    given: names of the options, as Python spells them.
    """
    own = OWN_OPTIONS.get(model, ())
    for owner, names in OWN_OPTIONS.items():
        others = [f"--{name}" for name in names if name not in own]
        asked = any(option[2:].replace("-", "_") in given for option in others)
        if model != owner and asked:
            *some, last = others
            said = f"{', '.join(some)} and {last} belong" if some else f"{last} belongs"
            raise BadInput(f"{said} to --model {owner}, not to {model!r}")
    if "worn_in" in given and model != "fem":
        raise BadInput(f"worn_in belongs to --model fem, not to {model!r}")


def applicable(brake: Brake) -> tuple[Model, ...]:
    """The models that apply to a brake and answer at once."""
    return tuple(
        model for model in MODELS.values() if not model.by_name and model.why_not(brake) is None
    )


def refusals(brake: Brake) -> dict[str, str]:
    """Why each of the other models does not apply to a brake, by name."""
    reasons = {model.name: model.why_not(brake) for model in MODELS.values() if not model.by_name}
    return {name: reason for name, reason in reasons.items() if reason is not None}
