"""Find parts of orthotropic material in a brake, which some models cannot take.

These models, such as the closed-form laws, assume isotropic materials.
"""

from collections.abc import Iterator

from drumlin.brake.brake import Brake
from drumlin.brake.fields import OrthotropicMaterial


def names_of_orthotropic_parts(brake: Brake) -> Iterator[str]:
    """Yield a name for each part of a brake with orthotropic material, for an error message."""
    for shoe in brake.shoes:
        parts = {"lining": shoe.lining, "backing": shoe.backing, "body": shoe.body}
        for name, part in parts.items():
            if isinstance(getattr(part, "material", None), OrthotropicMaterial):
                yield f"shoe {shoe.name!r}: {name}.material"
    if brake.ring is not None and isinstance(brake.ring.material, OrthotropicMaterial):
        yield "drum.ring.material"


def reason_if_any_part_is_orthotropic(brake: Brake, model: str) -> str | None:
    """Why a model for isotropic materials does not apply to a brake; None if it applies.

    `model` is the name of the model in the text.
    """
    part = next(names_of_orthotropic_parts(brake), None)
    if part is None:
        return None
    return f"{part} is orthotropic; {model} takes isotropic materials only"
