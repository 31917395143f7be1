"""The models that answer for a brake, by name. Each takes a brake and returns a Response."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, NamedTuple

from drumlin.brake.brake import Brake
from drumlin.brake.orthotropic import isotropic_only
from drumlin.errors import BadInput
from drumlin.laws import LAWS, flat, hinged, naming, pivoted, rigid
from drumlin.response.response import Response
from drumlin.texts import nearest


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
        from drumlin.wear.worn_in import solve as by_worn_in

        return by_worn_in(brake, **options)
    from drumlin.fem.solve import solve as by_elements

    return by_elements(brake, **options)


def _fem_why_not(brake: Brake) -> str | None:
    from drumlin.fem import assembly

    return assembly.why_not(brake)


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


def solve(brake: Brake, model: str = "fem", **options: Any) -> Response:
    """Solve a brake by one model.

    Parameters
    ----------
    brake : as `read_brake` gives it model : "fem", the finite elements, or a law: a name of MODELS
    options : those of the model; of "fem": `tolerance` (relative error of p and torque), or
    `elements` along each
        lining; `kind` of the elements; `penalty`, the contact stiffness as a multiple of E/t of the
        lining; `worn_in`, for linings that are worn in; `finite_width`, for linings' moduli
        corrected for the widths of the shoes. Of "solid": `elements`, `across` over half the
        lining's width, `penalty`. Of "foundation": `sections`, `lift`

    Returns
    -------
    the response: torque [N m], of each shoe p(theta) [Pa over rad], reactions [N], figures of
    merit, the load of the drum's bearings [N]

    Raises
    ------
    BadInput
        for an unknown model, one that does not apply to the brake, an option out of range
    NoAnswer
        for a brake without an answer: self-locking, no equilibrium, not converged
    """
    return pick(model, brake).solve(brake, **options)


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


def applicable(brake: Brake) -> tuple[Model, ...]:
    """The models that apply to a brake and answer at once."""
    return tuple(
        model for model in MODELS.values() if not model.by_name and model.why_not(brake) is None
    )


def refusals(brake: Brake) -> dict[str, str]:
    """Why each of the other models does not apply to a brake, by name."""
    reasons = {model.name: model.why_not(brake) for model in MODELS.values() if not model.by_name}
    return {name: reason for name, reason in reasons.items() if reason is not None}
