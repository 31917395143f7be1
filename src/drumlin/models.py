"""The models that compute a brake, by name. Each takes a `Brake` and returns a `Response`."""

from collections.abc import Callable, Collection, Mapping
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from drumlin.base.errors import BadInput
from drumlin.base.files import require_fields_file_name_ends_in_vtu
from drumlin.base.texts import did_you_mean_hint
from drumlin.brake.brake import Brake
from drumlin.brake.orthotropic import reason_if_any_part_is_orthotropic
from drumlin.laws import LAWS_OF_HINGED_SHOES_BY_NAME, flat, hinged, naming, pivoted, rigid
from drumlin.laws.own import PressureShapeFunction, make_law_from_pressure_shape
from drumlin.laws.pressure_friction import (
    reason_why_law_cannot_take_pressure_dependent_friction,
    solve_brake_by_law_of_uniform_pressure,
)
from drumlin.response.response import Response


class Model(NamedTuple):
    """A model of a brake: finite elements, the foundation model or a law.

    Attributes
    ----------
    name : name in options and tables
    assumes : assumptions of the model, in words
    why_not : function that returns why the model does not apply to a brake; None if it applies
    solve : function that solves a brake and returns its Response
    by_name : whether comparisons leave the model out unless the user names it, as it takes seconds
    """

    name: str
    assumes: str
    why_not: Callable[[Brake], str | None]
    solve: Callable[..., Response]
    by_name: bool = False


# The functions below import a model only when they are called, so that `drumlin --help` is fast.


def _solve_by_finite_elements(
    brake: Brake, *, worn_in: bool = False, fields: Path | None = None, **options: Any
) -> Response:
    """Solve a brake by finite elements in plane stress.

    With `worn_in` the linings are worn until their pressure no longer changes. `fields` is the name
    of a .vtu file for the displacements and stresses inside the shoes and the ring.
    """
    require_fields_file_name_ends_in_vtu(fields)
    if worn_in:
        from drumlin.lining_wear.worn_in import solve_worn_in_brake as by_worn_in

        return by_worn_in(brake, **options)
    from drumlin.fem.solve import solve as by_elements

    if fields is None:
        return by_elements(brake, **options)
    from drumlin.fem.analysis.fields import write_fields_of_solved_model_to_vtu_file

    return by_elements(
        brake, use_model=partial(write_fields_of_solved_model_to_vtu_file, fields, brake), **options
    )


def _reason_why_finite_elements_do_not_apply(brake: Brake) -> str | None:
    """Why the finite elements do not apply to a brake; None if they apply."""
    from drumlin.fem.preparation.scene import reason_against_finite_element_model

    return reason_against_finite_element_model(brake)


def _solve_by_foundation_model(brake: Brake, **options: Any) -> Response:
    """Solve a brake by the foundation model (a beam on springs)."""
    from drumlin.foundation import solve_brake_by_foundation_model as on_springs

    return on_springs(brake, **options)


def _reason_why_foundation_model_does_not_apply(brake: Brake) -> str | None:
    """Why the foundation model does not apply to a brake; None if it applies."""
    from drumlin.foundation import reason_against_foundation_model

    return reason_against_foundation_model(brake)


def _solve_brake_with_shoes_in_three_dimensions(brake: Brake, **options: Any) -> Response:
    """Solve a brake by finite elements in three dimensions, with shoes of finite width."""
    from drumlin.fem import solid

    return solid.solve(brake, **options)


def _reason_why_solid_shoe_model_does_not_apply(brake: Brake) -> str | None:
    """Why the model of solid shoes does not apply to a brake; None if it applies."""
    from drumlin.fem.width.prepare import reason_why_width_model_does_not_apply

    return reason_why_width_model_does_not_apply(brake)


class ShortShoeLawOfSurface(NamedTuple):
    """The law of the short shoe on one kind of surface.

    Attributes
    ----------
    why_not : function that returns why the law does not apply to a brake; None if it applies
    solve : function that solves a brake by the law
    """

    why_not: Callable[[Brake], str | None]
    solve: Callable[[Brake], Response]


SHORT_SHOE_LAWS: Mapping[str, ShortShoeLawOfSurface] = {
    "drum": ShortShoeLawOfSurface(
        partial(hinged.reason_against_hinged_shoe_law, LAWS_OF_HINGED_SHOES_BY_NAME["short"]),
        partial(hinged.solve_brake_with_hinged_shoes_by_law, LAWS_OF_HINGED_SHOES_BY_NAME["short"]),
    ),
    "plane": ShortShoeLawOfSurface(
        partial(flat.reason_against_flat_law, flat.SHORT_SHOE_LAW_ON_PLANE),
        partial(flat.solve_brake_on_plane_by_law, flat.SHORT_SHOE_LAW_ON_PLANE),
    ),
}
"""The law of the short shoe for each kind of surface, "drum" or "plane"."""


def _reason_why_short_shoe_law_does_not_apply(brake: Brake) -> str | None:
    """Why the law of the short shoe does not apply to a brake; None if it applies."""
    return SHORT_SHOE_LAWS[brake.surface.name].why_not(brake)


def _solve_by_short_shoe_law(brake: Brake) -> Response:
    """Solve a brake by the law of the short shoe."""
    return SHORT_SHOE_LAWS[brake.surface.name].solve(brake)


def _make_model_of_hinged_law(name: str) -> Model:
    """Make the model of the law of hinged shoes that has this name."""
    law = LAWS_OF_HINGED_SHOES_BY_NAME[name]
    return _make_model_of_closed_form_law(
        name,
        law.assumes,
        partial(hinged.reason_against_hinged_shoe_law, law),
        partial(hinged.solve_brake_with_hinged_shoes_by_law, law),
    )


def _make_model_of_closed_form_law(
    name: str, assumes: str, why_not: Callable[[Brake], str | None], solve: Callable[..., Response]
) -> Model:
    """Make the model of a closed-form law, which takes isotropic materials only.

    Parameters
    ----------
    name : name of the law
    assumes : assumptions of the law, in words
    why_not : function that returns why the law does not apply to a brake, or None; it checks
        neither the materials nor whether friction depends on the pressure
    solve : function that solves a brake
    """

    def reason_why_law_does_not_apply(brake: Brake) -> str | None:
        """Why the law does not apply to a brake; None if it applies.

        Friction that depends on the pressure and the materials are checked as well.
        """
        return (
            why_not(brake)
            or reason_why_law_cannot_take_pressure_dependent_friction(name, brake)
            or reason_if_any_part_is_orthotropic(brake, "a closed-form law")
        )

    solver = partial(solve_brake_by_law_of_uniform_pressure, solve)
    return Model(name, assumes, reason_why_law_does_not_apply, solver)


MODELS: dict[str, Model] = {
    model.name: model
    for model in (
        Model(
            "fem",
            "2D plane stress, unilateral contact, full-slip Coulomb friction",
            _reason_why_finite_elements_do_not_apply,
            _solve_by_finite_elements,
        ),
        _make_model_of_hinged_law("sine"),
        Model(
            "foundation",
            "beam on springs against an elastic ring",
            _reason_why_foundation_model_does_not_apply,
            _solve_by_foundation_model,
        ),
        _make_model_of_hinged_law("cosine"),
        _make_model_of_hinged_law("block"),
        _make_model_of_hinged_law("uniform"),
        _make_model_of_closed_form_law(
            "short",
            LAWS_OF_HINGED_SHOES_BY_NAME["short"].assumes,
            _reason_why_short_shoe_law_does_not_apply,
            _solve_by_short_shoe_law,
        ),
        _make_model_of_closed_form_law(
            "pivoted",
            pivoted.PIVOTED_SHOE_LAW_ASSUMPTIONS,
            pivoted.reason_against_pivoted_shoe_law,
            partial(rigid.solve_brake_by_rigid_shoe_law, name="pivoted"),
        ),
        _make_model_of_closed_form_law(
            "linear",
            flat.LINEAR_PRESSURE_LAW.assumes,
            partial(flat.reason_against_flat_law, flat.LINEAR_PRESSURE_LAW),
            partial(rigid.solve_brake_by_rigid_shoe_law, name="linear"),
        ),
        _make_model_of_closed_form_law(
            "rigid",
            rigid.RIGID_SHOE_LAW_ASSUMPTIONS,
            naming.reason_why_brake_has_no_law_named_rigid,
            rigid.solve_brake_by_rigid_shoe_law,
        ),
        Model(
            "solid",
            "solid shoes of finite width, contact and friction as fem",
            _reason_why_solid_shoe_model_does_not_apply,
            _solve_brake_with_shoes_in_three_dimensions,
            by_name=True,
        ),
    )
}
"""All models by name, in the order in which comparisons show them.

`register_law_with_pressure_shape` adds the laws of the user.
"""

NAMES_OF_BUILT_IN_MODELS = frozenset(MODELS)
"""Names of drumlin's own models, which no law of the user may have."""


def require_allowed_name_for_law_of_user(name: object) -> None:
    """Raise BadInput for a name that is no word, or that a model of drumlin has."""
    if not isinstance(name, str) or not name.isidentifier() or name in NAMES_OF_BUILT_IN_MODELS:
        raise BadInput(
            f"name = {name!r}: must be a word of letters, digits and underscores that is none of "
            f"{', '.join(MODELS)}"
        )


def register_law_with_pressure_shape(name: str, assumes: str, shape: PressureShapeFunction) -> None:
    """Add a law of the user to MODELS, or replace an earlier law of the user with this name.

    Parameters
    ----------
    name : name of the law
    assumes : assumptions of the law, in words
    shape : function that returns the pressures at angles from the hinge, up to a factor

    Raises
    ------
    BadInput
        for a name that is no word, or that a model of drumlin has, and for a shape that is no
        function of two arguments
    """
    require_allowed_name_for_law_of_user(name)
    law = make_law_from_pressure_shape(name, assumes, shape)
    MODELS[name] = _make_model_of_closed_form_law(
        name,
        assumes,
        partial(hinged.reason_against_hinged_shoe_law, law),
        partial(hinged.solve_brake_with_hinged_shoes_by_law, law),
    )


def remove_law_of_user(name: str) -> None:
    """Remove a law of the user from MODELS.

    Raises BadInput if the user has registered no law with this name.
    """
    laws_of_user = [known for known in MODELS if known not in NAMES_OF_BUILT_IN_MODELS]
    if name not in laws_of_user:
        allowed = ", ".join(laws_of_user) or "none, as no law is registered"
        raise BadInput(f"name = {name!r}: no law of your own has this name; allowed: {allowed}")
    del MODELS[name]


def require_known_model(name: str, option: str) -> None:
    """Raise BadInput if no model has the name that the user gave by the option `option`."""
    if name not in MODELS:
        raise BadInput(
            f"{option} = {name!r}: unknown model{did_you_mean_hint(str(name), MODELS)}; "
            f"allowed: {', '.join(MODELS)}"
        )


def model_with_name_that_applies_to_brake(name: str, brake: Brake) -> Model:
    """The model with this name.

    Raises BadInput if no model has this name, or if the model does not apply to the brake.
    """
    require_known_model(name, "--model")
    model = MODELS[name]
    # The message names the models that do apply, so that the user need not try all of them.
    reason = model.why_not(brake)
    if reason is not None:
        others = [other.name for other in MODELS.values() if other.why_not(brake) is None]
        allowed = ", ".join(others) or "none"
        raise BadInput(
            f"--model = {name!r}: does not apply to this brake: {reason}; allowed: {allowed}"
        )
    return model


def model_options_given_by_user(**options: Any) -> dict[str, Any]:
    """The options that the user has given, by name: all whose value is neither None nor False.

    Raises BadInput if the number of `elements` is out of range.
    """
    elements = options.get("elements")
    # A number of elements out of range is refused before any model is loaded.
    if elements is not None:
        from drumlin.fem.preparation.meshes import MOST_ELEMENTS_ALONG_LINING

        if not 1 <= elements <= MOST_ELEMENTS_ALONG_LINING:
            raise BadInput(
                f"--elements = {elements}: must be from 1 to {MOST_ELEMENTS_ALONG_LINING}"
            )
    return {
        name: value for name, value in options.items() if value is not None and value is not False
    }


OPTIONS_OF_EACH_MODEL: Mapping[str, tuple[str, ...]] = {
    "fem": ("elements", "kind", "penalty", "tolerance", "finite-width", "fields"),
    "solid": ("across", "penalty", "tolerance", "fields"),
    "foundation": ("sections", "lift"),
}
"""The names of the options of each model, as the command line spells them.

A model without an entry has no options.
"""


def _other_models_with_given_options(model: str, owner: str, given: Collection[str]) -> str:
    """The end of a refusal that names further models with given options; "" if there is none.

    `model` is the chosen model and `owner` the model that the refusal names already.
    """
    ends = []
    for other, names in OPTIONS_OF_EACH_MODEL.items():
        shared = [f"--{name}" for name in names if name.replace("-", "_") in given]
        if other not in {model, owner} and shared:
            ends.append(f"; {' and '.join(shared)} also to --model {other}")
    return "".join(ends)


def check_options_belong_to_model(model: str, given: Collection[str]) -> None:
    """Raise BadInput if a given option belongs to other models than the chosen one.

    `model` is the name of the chosen model, `given` are the names of the options in Python.
    """
    own = OPTIONS_OF_EACH_MODEL.get(model, ())
    # Models may share options. An option is refused only if the chosen model does not have it.
    for owner, names in OPTIONS_OF_EACH_MODEL.items():
        others = [f"--{name}" for name in names if name not in own]
        asked = any(option[2:].replace("-", "_") in given for option in others)
        # The message names all options of the other model that the chosen model does not have.
        if model != owner and asked:
            *some, last = others
            said = f"{', '.join(some)} and {last} belong" if some else f"{last} belongs"
            also = _other_models_with_given_options(model, owner, given)
            raise BadInput(f"{said} to --model {owner}, not to {model!r}{also}")
    if "worn_in" in given and model != "fem":
        raise BadInput(f"worn_in belongs to --model fem, not to {model!r}")


def applicable_models(brake: Brake, names: Collection[str] = ()) -> tuple[Model, ...]:
    """The models that apply to a brake.

    Models that must be given by name (`by_name`) are left out unless `names` has their name.
    """
    asked = [model for model in MODELS.values() if not model.by_name or model.name in names]
    return tuple(model for model in asked if model.why_not(brake) is None)


def reasons_why_models_do_not_apply(brake: Brake, names: Collection[str] = ()) -> dict[str, str]:
    """Why models do not apply to a brake, by the name of the model.

    Models that apply are left out, and so are those that must be given by name (`by_name`) unless
    `names` has their name.
    """
    reasons = {}
    for model in MODELS.values():
        left_out = model.by_name and model.name not in names
        reason = None if left_out else model.why_not(brake)
        if reason is not None:
            reasons[model.name] = reason
    return reasons
