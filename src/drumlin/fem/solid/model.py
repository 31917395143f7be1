"""The solid model: brake -> scene of solid bodies -> response, by the contact of the plane model."""

from functools import partial
from pathlib import Path

from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.fields import Material
from drumlin.brake.orthotropic import isotropic_only
from drumlin.fem.model import PENALTY, check_penalty, respond
from drumlin.fem.preparation.bodies import ShoeSubstructure
from drumlin.fem.preparation.cache import Cache, bare_shoe, shape_of, size_of
from drumlin.fem.preparation.scene import PreparedModel, Seconds, lacking
from drumlin.fem.preparation.scene import why_not as plane_why_not
from drumlin.fem.solid import MOST_ACROSS, MOST_ELEMENTS
from drumlin.fem.solid.body import solid_body
from drumlin.response.merit import with_merits
from drumlin.response.response import Response

ELEMENTS = 48
"""Default number along a lining: a limit of time, as the work goes with its fourth power."""
STIFFNESS = 2500  # bytes of a row
SOFTEST = 0.499
"""Largest Poisson's ratio at which displacements alone describe a solid."""


def why_not(brake: Brake) -> str | None:
    """Why the solid model does not apply to a brake (None: it does)."""
    if brake.unmeshable() is not None:
        return brake.unmeshable()
    if brake.ring is not None:
        return "its drum is an elastic ring; solid shoes are pressed on a rigid drum"
    for shoe in brake.shoes:
        reason = _shoe_why_not(shoe)
        if reason is not None:
            return f"shoe {shoe.name!r}: {reason}"
    return isotropic_only(brake, "the solid model") or plane_why_not(brake)


def _shoe_why_not(shoe: Shoe) -> str | None:
    if shoe.mesh is not None:
        return "a mesh of its own is a section without widths"
    if shoe.body is not None and shoe.body.bending_stiffness is not None:
        return "its bending_stiffness is not that of a section of its thickness and width"
    for name, part in (("lining", shoe.lining), ("backing", shoe.backing), ("body", shoe.body)):
        material = getattr(part, "material", None)
        if isinstance(material, Material) and material.nu > SOFTEST:
            return f"{name}.material.nu = {material.nu:g} is all but incompressible; at most {SOFTEST:g}"
    return None


def across_of(shoe: Shoe, elements: int) -> int:
    """Elements over half the width of a lining with so many along it: the pressure is uneven over
    about its thickness from the sides, and smooth.
    """
    slender = shoe.lining.width / (2 * shoe.lining.thickness)
    return max(2, round(elements / ELEMENTS * min(2 + slender, 6)))


def prepare(
    brake: Brake, *, elements: int = ELEMENTS, across: int | None = None, cache: Cache | None = None
) -> PreparedModel:
    """Mesh and condense the solid shoes of a brake; shoes of one shape share one body.

    elements: number along each lining; across: over half its width; cache: bodies of earlier
    scenes, taken from there and put there. Raises BadInput.
    """
    reason = why_not(brake)
    if reason is not None:
        raise BadInput(f"solid does not apply to this brake: {reason}")
    for name, value, most in (
        ("elements", elements, MOST_ELEMENTS),
        ("across", across, MOST_ACROSS),
    ):
        if value is not None and not 1 <= value <= most:
            raise BadInput(f"--{name} = {value}: must be from 1 to {most}")
    seconds: Seconds = {}
    made: dict[tuple[object, ...], ShoeSubstructure] = {}
    cache = Cache() if cache is None else cache
    keys = [shape_of(brake, shoe) for shoe in brake.shoes]
    for key, shoe in zip(keys, brake.shoes, strict=True):
        if key not in made:
            counts = elements, across or across_of(shoe, elements)
            same = ("solid", bare_shoe(shoe), brake.size, brake.friction > 0, *counts)
            made[key] = cache.get(
                same, partial(solid_body, brake, shoe, *counts, seconds), _size_of
            )
    left_out = [
        "interior fields: recovered only for a picture",
        "the other half of each shoe: symmetric",
    ]
    if len(made) < len(keys):
        left_out.append(
            f"{len(keys) - len(made)} of {len(keys)} shoes: same shape as another, condensed once"
        )
    bodies = tuple(made[key] for key in keys)
    return PreparedModel(brake, bodies, None, seconds, (*left_out, *lacking(brake)), model="solid")


def _size_of(body: ShoeSubstructure) -> int:
    """What a condensed body keeps, about: its matrices, and the stiffness that fields are recovered
    with.
    """
    return size_of(body) + STIFFNESS * body.unknowns


def solve(
    brake: Brake,
    *,
    elements: int = ELEMENTS,
    across: int | None = None,
    penalty: float = PENALTY,
    fields: Path | None = None,
    cache: Cache | None = None,
) -> Response:
    """The response of a brake's solid shoes; options as of `prepare`. fields: a .vtu file to write
    what is inside them to; cache: bodies of earlier solves. Raises BadInput, NoAnswer.
    """
    check_penalty(penalty)
    if fields is not None and fields.suffix != ".vtu":
        raise BadInput(f"--fields = {str(fields)!r}: must end in .vtu")
    brake.check_meshable()
    scene = prepare(brake, elements=elements, across=across, cache=cache)
    response = respond(scene, brake, penalty=penalty)
    if fields is not None:
        from drumlin.fem.analysis.fields import write_vtu  # noqa: PLC0415  (only where it is asked for)
        from drumlin.fem.solid.fields import recover  # noqa: PLC0415

        write_vtu(fields, [recover(scene, brake, response, i) for i in range(len(brake.shoes))])
    return with_merits(brake, response)
