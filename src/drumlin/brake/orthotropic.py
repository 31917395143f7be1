"""Which part of a brake has a material with directions, for models that know isotropic ones
alone."""

from collections.abc import Iterator

from drumlin.brake.brake import Brake
from drumlin.brake.fields import Orthotropic


def orthotropic_parts(brake: Brake) -> Iterator[str]:
    """The parts of a brake whose material is orthotropic, as a refusal names them."""
    for shoe in brake.shoes:
        for name, part in (("lining", shoe.lining), ("backing", shoe.backing), ("body", shoe.body)):
            if isinstance(getattr(part, "material", None), Orthotropic):
                yield f"shoe {shoe.name!r}: {name}.material"
    if brake.ring is not None and isinstance(brake.ring.material, Orthotropic):
        yield "drum.ring.material"


def isotropic_only(brake: Brake, model: str) -> str | None:
    """Why a `model` that takes isotropic materials alone does not apply; None where it does."""
    part = next(orthotropic_parts(brake), None)
    return (
        None if part is None else f"{part} is orthotropic; {model} takes isotropic materials only"
    )
