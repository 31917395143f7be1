"""The models that compute a brake, by name. Each takes a `Brake` and returns a `Response`."""

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
    """A model of a brake: finite elements, the foundation model or a law.

    Attributes
    ----------
    name : name in options and tables
    assumes : its assumptions in words
    why_not : function that returns why the model does not apply to a brake; None if it applies
    solve : function that solves a brake and returns its Response
    by_name : whether a comparison leaves it out unless its name is given, because it takes seconds
    """

    name: str
    assumes: str
    why_not: Callable[[Brake], str | None]
    solve: Callable[..., Response]
    by_name: bool = False


# The functions below import a model only when they are called, so that `drumlin --help` is fast.


def _fem(brake: Brake, *, worn_in: bool = False, **options: Any) -> Response:
    """Solve a brake by finite elements in plane stress.

    With `worn_in` the linings are worn until their pressure no longer changes.
    """
    if worn_in:
        from drumlin.lining_wear.worn_in import solve_worn_in_brake as by_worn_in

        return by_worn_in(brake, **options)
    from drumlin.fem.solve import solve as by_elements

    return by_elements(brake, **options)


def _fem_why_not(brake: Brake) -> str | None:
    """Why the finite elements do not apply to a brake; None if they apply."""
    from drumlin.fem.preparation.scene import reason_why_not_modelled

    return reason_why_not_modelled(brake)


def _foundation(brake: Brake, **options: Any) -> Response:
    """Solve a brake by the foundation model (a beam on springs)."""
    from drumlin.foundation import solve as on_springs

    return on_springs(brake, **options)


def _foundation_why_not(brake: Brake) -> str | None:
    """Why the foundation model does not apply to a brake; None if it applies."""
    from drumlin.foundation import why_not

    return why_not(brake)


def _solid(brake: Brake, **options: Any) -> Response:
    """Solve a brake by finite elements in three dimensions, with shoes of finite width."""
    from drumlin.fem.solid import model

    return model.solve(brake, **options)


def _solid_why_not(brake: Brake) -> str | None:
    """Why the model of solid shoes does not apply to a brake; None if it applies."""
    from drumlin.fem.solid import model

    return model.why_not(brake)


SHORT_SHOE_LAWS: Mapping[str, tuple[Any, Any]] = {
    "drum": (hinged, LAWS["short"]),
    "plane": (flat, flat.FLAT_SHORT),
}
"""The law of the short shoe for each kind of surface, "drum" or "plane".

The two values are the module with the functions `why_not` and `solve`, and the law itself.
"""


def _short_why_not(brake: Brake) -> str | None:
    """Why the law of the short shoe does not apply to a brake; None if it applies."""
    laws, law = SHORT_SHOE_LAWS[brake.surface.word]
    return laws.why_not(law, brake)


def _short(brake: Brake) -> Response:
    """Solve a brake by the law of the short shoe."""
    laws, law = SHORT_SHOE_LAWS[brake.surface.word]
    return laws.solve(law, brake)


def _hinged(name: str) -> Model:
    """Make the model of the law of hinged shoes that has this name."""
    law = LAWS[name]
    return _law(name, law.assumes, partial(hinged.why_not, law), partial(hinged.solve, law))


def _law(
    name: str, assumes: str, why_not: Callable[[Brake], str | None], solve: Callable[..., Response]
) -> Model:
    """Make the model of a closed-form law, which takes isotropic materials only.

    Parameters
    ----------
    name : name of the law
    assumes : its assumptions in words
    why_not : function that returns why the law does not apply to a brake, or None; it does not
        look at the materials
    solve : function that solves a brake
    """

    def isotropic_too(brake: Brake) -> str | None:
        """Why the law does not apply to a brake, or to its orthotropic materials; else None."""
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
        _law(
            "pivoted",
            pivoted.PIVOTED_ASSUMES,
            pivoted.why_not,
            partial(rigid.solve, name="pivoted"),
        ),
        _law(
            "linear",
            flat.LINEAR.assumes,
            partial(flat.why_not, flat.LINEAR),
            partial(rigid.solve, name="linear"),
        ),
        _law("rigid", rigid.RIGID_ASSUMES, naming.why_not, rigid.solve),
        Model(
            "solid",
            "solid shoes of finite width, contact and friction as fem",
            _solid_why_not,
            _solid,
            by_name=True,
        ),
    )
}
"""All models by name, in the order in which comparisons show them."""


def pick(name: str, brake: Brake) -> Model:
    """The model with this name.

    Raises BadInput if no model has this name, or if the model does not apply to the brake.
    """
    if name not in MODELS:
        raise BadInput(
            f"--model = {name!r}: unknown model{nearest(name, MODELS)}; "
            f"allowed: {', '.join(MODELS)}"
        )
    model = MODELS[name]
    # The message names the models that do apply, so that a user need not try them.
    reason = model.why_not(brake)
    if reason is not None:
        others = [other.name for other in MODELS.values() if other.why_not(brake) is None]
        allowed = ", ".join(others) or "none"
        raise BadInput(
            f"--model = {name!r}: does not apply to this brake: {reason}; allowed: {allowed}"
        )
    return model


def given_options(**options: Any) -> dict[str, Any]:
    """The options that the user has given, which are all that are neither None nor False.

    Raises BadInput if the number of `elements` is out of range.
    """
    elements = options.get("elements")
    # A number of elements out of range is refused before a model is loaded or solves.
    if elements is not None:
        from drumlin.fem.preparation.meshes import MOST_LINING_ELEMENTS

        if not 1 <= elements <= MOST_LINING_ELEMENTS:
            raise BadInput(f"--elements = {elements}: must be from 1 to {MOST_LINING_ELEMENTS}")
    return {
        name: value for name, value in options.items() if value is not None and value is not False
    }


OWN_OPTIONS: Mapping[str, tuple[str, ...]] = {
    "fem": ("elements", "kind", "penalty", "tolerance", "finite-width"),
    "solid": ("elements", "across", "penalty", "tolerance", "fields"),
    "foundation": ("sections", "lift"),
}
"""The names of the options of each model, as the command line spells them.

A model without an entry has no options.
"""


def check_options(model: str, given: Collection[str]) -> None:
    """Raise BadInput if a given option belongs to other models than the chosen one.

    `model` is the name of the chosen model, `given` are the names of the options in Python.
    """
    own = OWN_OPTIONS.get(model, ())
    # Models may share options. An option is refused only if the chosen model does not have it.
    for owner, names in OWN_OPTIONS.items():
        others = [f"--{name}" for name in names if name not in own]
        asked = any(option[2:].replace("-", "_") in given for option in others)
        # The message names all options of the other model that the chosen model does not have.
        if model != owner and asked:
            *some, last = others
            said = f"{', '.join(some)} and {last} belong" if some else f"{last} belongs"
            raise BadInput(f"{said} to --model {owner}, not to {model!r}")
    if "worn_in" in given and model != "fem":
        raise BadInput(f"worn_in belongs to --model fem, not to {model!r}")


def applicable(brake: Brake) -> tuple[Model, ...]:
    """The models that apply to a brake, except those that must be given by name (`by_name`)."""
    at_once = [model for model in MODELS.values() if not model.by_name]
    return tuple(model for model in at_once if model.why_not(brake) is None)


def refusals(brake: Brake) -> dict[str, str]:
    """Why models do not apply to a brake, by the name of the model.

    Models that apply are left out, and so are those that must be given by name (`by_name`).
    """
    reasons = {}
    for model in MODELS.values():
        reason = None if model.by_name else model.why_not(brake)
        if reason is not None:
            reasons[model.name] = reason
    return reasons
