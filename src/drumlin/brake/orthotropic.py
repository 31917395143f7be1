"""Find parts of orthotropic material, for models that take isotropic materials only."""

from collections.abc import Iterator

from drumlin.brake.brake import Brake
from drumlin.brake.fields import Orthotropic


def orthotropic_parts(brake: Brake) -> Iterator[str]:
    """The parts of a brake whose material is orthotropic, as a refusal names them."""
    for shoe in brake.shoes:
        parts = {"lining": shoe.lining, "backing": shoe.backing, "body": shoe.body}
        for name, part in parts.items():
            if isinstance(getattr(part, "material", None), Orthotropic):
                yield f"shoe {shoe.name!r}: {name}.material"
    if brake.ring is not None and isinstance(brake.ring.material, Orthotropic):
        yield "drum.ring.material"


def isotropic_only(brake: Brake, model: str) -> str | None:
    """Reason why a `model` that takes isotropic materials only does not apply, or None."""
    part = next(orthotropic_parts(brake), None)
    if part is None:
        return None
    return f"{part} is orthotropic; {model} takes isotropic materials only"
